"""A logo from anywhere: its picture and nothing else, or one line."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from gearwear.errors import InputError
from gearwear.report.logo import SHOWN, read_logo


def png(size=(40, 20), **more):
    out = io.BytesIO()
    Image.new("RGB", size, (11, 92, 156)).save(out, format="PNG", **more)
    return out.getvalue()


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_the_picture_is_kept_and_told_by_its_bytes(tmp_path, kind):
    out = io.BytesIO()
    Image.new("RGB", (1440, 100), (11, 92, 156)).save(out, format=kind)
    (tmp_path / "logo.svg").write_bytes(out.getvalue())
    logo = read_logo(tmp_path / "logo.svg")
    assert (logo.width, logo.height) == (720, 50) and logo.width <= SHOWN[0]
    pixels = np.asarray(Image.open(io.BytesIO(logo.png)).convert("RGB")).reshape(-1, 3)
    np.testing.assert_allclose(pixels.mean(axis=0), (11, 92, 156), atol=2.0)


def test_nothing_beside_the_pixels_is_left(tmp_path):
    note = PngImagePlugin.PngInfo()
    note.add_text("Comment", "<script>alert(1)</script>")
    (tmp_path / "logo.png").write_bytes(png(pnginfo=note) + b"<script>alert(2)</script>")
    assert b"script" not in read_logo(tmp_path / "logo.png").png


HUGE = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 6000, 6000, 8, 2, 0, 0, 0))
HOSTILE = {
    "no such file": None,
    "neither PNG nor JPEG": b"<svg xmlns='http://www.w3.org/2000/svg'><script>alert(1)</script></svg>",
    "is damaged": png()[:60],
    "6000 × 6000 pixels": HUGE + chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b""),
    "is larger than 2 MB": png() + bytes(2_000_000),
}


@pytest.mark.parametrize("words", HOSTILE)
def test_what_is_no_logo_is_refused_in_one_line(tmp_path, words):
    if HOSTILE[words] is not None:
        (tmp_path / "logo.png").write_bytes(HOSTILE[words])
    with pytest.raises(InputError) as caught:
        read_logo(tmp_path / "logo.png")
    assert words in str(caught.value) and "would be right" in str(caught.value) and "\n" not in str(caught.value)
