"""The gear as it is, as a file: `worn_profiles.npz`, written by `compare` and read by `meshing`."""

from __future__ import annotations

import zipfile
import zlib
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.errors import InputError

NAME = "worn_profiles.npz"
KEYS = ("radius", "z", "half_angle", "part")
DAMAGED = (
    OSError, ValueError, TypeError, AttributeError, EOFError, KeyError, NotImplementedError, RuntimeError, zlib.error, zipfile.BadZipFile,
)  # fmt: skip
"""What numpy and zipfile raise on a file that is no good."""
ON_CIRCLE = 1e-6
"""mm; how near the ends of the profiles must lie to the design's root and tip circle."""


def write_profiles(path: Path, profiles: ToothProfiles, part: str) -> None:
    """Write tooth profiles.

    Parameters
    ----------
    path : Path
        Arrays `radius` (n_r,) mm, `z` (n_z,) mm, `half_angle` (teeth, 2, n_z, n_r) rad with side 0 left and 1 right, and `part`.
    profiles : ToothProfiles
        The gear as it is: manufacture and wear.
    part : str
        "pinion" or "gear".
    """
    np.savez_compressed(path, radius=profiles.radius, z=profiles.z, half_angle=profiles.half_angle, part=np.array(part))


def read_profiles(path: Path, design: Design) -> tuple[str, ToothProfiles]:
    """Read what `write_profiles` wrote.

    Parameters
    ----------
    path : Path
        The file, or the folder that `compare` wrote it to.
    design : Design
        The pair that it belongs to.

    Returns
    -------
    part : str
    profiles : ToothProfiles

    Raises
    ------
    InputError
        If it cannot be read, or is of a gear that this design does not have.
    """
    file = path
    try:
        file = path / NAME if path.is_dir() else path
        if file.exists() and not zipfile.is_zipfile(file):
            raise InputError(f"{file}: is no NPZ file; the {NAME} that gearwear compare writes would be right")
        with np.load(file, allow_pickle=False) as data:
            missing = [key for key in KEYS if key not in data]
            if missing:
                raise InputError(f"{file}: has no {', '.join(missing)}; the {NAME} that gearwear compare writes would be right")
            part = str(data["part"])
            radius, z, half_angle = (np.asarray(data[key], dtype=np.float64) for key in KEYS[:3])
    except FileNotFoundError:
        raise InputError(f"{file}: no such file; the folder that gearwear compare wrote to would be right") from None
    except InputError:
        raise
    except DAMAGED as error:
        reason = next(iter(str(error).strip().splitlines()), type(error).__name__)[:120]
        raise InputError(f"{file}: cannot be read ({reason}); the {NAME} that gearwear compare writes would be right") from None
    if part not in design.gears:
        raise InputError(f"{file}: is of a {part!r}, which the design does not have")
    gear = design.gears[part]
    _check(file, gear.teeth, (gear.root_radius, gear.flank_end_radius), radius, z, half_angle)
    return part, ToothProfiles(gear, radius, z, half_angle)


def _check(file: Path, teeth: int, ends: tuple[float, float], radius: Floats, z: Floats, half_angle: Floats) -> None:
    for name, values, least in (("radius", radius, 2), ("z", z, 1)):
        if values.ndim != 1 or len(values) < least or not np.isfinite(values).all() or not (np.diff(values) > 0.0).all():
            raise InputError(f"{file}: {name} must be a rising row of numbers")
    if half_angle.shape[1:] != (2, len(z), len(radius)) or not np.isfinite(half_angle).all():
        raise InputError(f"{file}: half_angle must be finite and of shape (teeth, 2, {len(z)}, {len(radius)})")
    if len(half_angle) != teeth or max(abs(radius[0] - ends[0]), abs(radius[-1] - ends[1])) > ON_CIRCLE:
        raise InputError(
            f"{file}: is of a gear with {len(half_angle)} teeth from r = {radius[0]:.4f} to {radius[-1]:.4f} mm, the design has {teeth} from "
            f"{ends[0]:.4f} to {ends[1]:.4f} mm"
        )
