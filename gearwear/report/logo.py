"""A logo that somebody else brings: read within bounds, and written anew so that nothing but its picture is left."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from pathlib import Path

from gearwear.errors import InputError

MOST_BYTES, MOST_PIXELS = 2_000_000, 5000
"""Bytes of the file, and pixels in either direction."""
SHOWN = (720, 180)
"""Pixels that it is brought down to."""
BEGINNINGS = {"PNG": b"\x89PNG\r\n\x1a\n", "JPEG": b"\xff\xd8\xff"}


@dataclass(frozen=True, slots=True)
class Logo:
    """A small picture.

    Parameters
    ----------
    png : bytes
        As PNG, without anything beside its pixels.
    width, height : int
        Pixels.
    """

    png: bytes
    width: int
    height: int


def read_logo(path: str | Path) -> Logo:
    """Read a logo.

    Parameters
    ----------
    path : path
        PNG or JPEG, told by its beginning and not by its name.

    Raises
    ------
    InputError
        If it is missing, too large, of another format or damaged.
    """
    from PIL import Image

    file, right = Path(path), f"a PNG or JPEG of at most {MOST_PIXELS} × {MOST_PIXELS} pixels and 2 MB would be right"
    try:
        if not file.is_file():
            raise InputError(f"logo {file}: no such file; {right}")
        with file.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise InputError(f"logo {file}: cannot be read ({error.strerror}); {right}") from None
    kind = next((name for name, start in BEGINNINGS.items() if data.startswith(start)), None)
    if kind is None or len(data) > MOST_BYTES:
        raise InputError(f"logo {file}: {'is larger than 2 MB' if kind else 'is neither PNG nor JPEG'}; {right}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            picture = Image.open(io.BytesIO(data), formats=[kind])
            if max(picture.size) > MOST_PIXELS:  # before it is unpacked
                raise InputError(f"logo {file}: has {picture.width} × {picture.height} pixels; {right}")
            picture.draft("RGB", SHOWN)
            plain = picture.convert("RGBA")
    except InputError:
        raise
    except Exception as error:  # a decoder says in many ways that it cannot go on
        raise InputError(f"logo {file}: is damaged ({type(error).__name__}); {right}") from None
    plain.thumbnail(SHOWN)
    new = Image.new("RGBA", plain.size)
    new.paste(plain)
    out = io.BytesIO()
    new.save(out, format="PNG")
    return Logo(out.getvalue(), *plain.size)
