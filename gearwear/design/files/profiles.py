"""The gear as it is, as a file: `worn_profiles.npz`, written by `compare` and read by `meshing`."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import SectionLoss, ToothProfiles
from gearwear.design.quantity import apart, as_given, at_most
from gearwear.design.spec import MOST_TEETH
from gearwear.errors import InputError
from gearwear.memory import check_memory

NAME = "worn_profiles.npz"
PARTS = ("pinion", "gear")
KEYS = ("radius", "z", "half_angle", "part")
LOST = "lost"
"""Of files since 0.30.0, where a thickness was measured: `SectionLoss` as three numbers."""
WIDEST = 256
"""Bytes of one entry of an array: a number has 8, the word for the part 24."""
PER_ANGLE = 200
"""Bytes of memory that a half angle takes in rigid contact."""
SLACK = 0.1
"""Share of a pitch by which a tooth side may lie beyond the centre line of the space beside it, either way."""
ON_CIRCLE = 1e-6
"""mm; how near the ends of the profiles must lie to the design's root and tip circle."""


def write_profiles(path: Path, profiles: ToothProfiles, part: str) -> None:
    """Write tooth profiles.

    Parameters
    ----------
    path : Path
        Arrays `radius` (n_r,) mm, `z` (n_z,) mm, `half_angle` (teeth, 2, n_z, n_r) rad with side 0 left and 1 right, and `part`; where it is known
        `lost` (3,): how much thinner than drawn a tooth is at most, mm of arc, which one (from 0), and at which height, mm.
    profiles : ToothProfiles
        The gear as it is: manufacture and wear.
    part : str
        "pinion" or "gear".
    """
    arrays: dict[str, Any] = {
        "radius": profiles.radius,
        "z": profiles.z,
        "half_angle": profiles.half_angle,
        "part": np.array(part),
    }
    if profiles.lost is not None:
        arrays[LOST] = np.array([profiles.lost.value, profiles.lost.tooth, profiles.lost.z], dtype=np.float64)
    np.savez_compressed(path, **arrays)


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
        with zipfile.ZipFile(file) as archive:
            missing = [key for key in KEYS if f"{key}.npy" not in archive.namelist()]
            if missing:
                raise InputError(f"{file}: has no {', '.join(missing)}; the {NAME} that gearwear compare writes would be right")
            known = f"{LOST}.npy" in archive.namelist()
            if known and _shape(archive, LOST) != (3,):
                raise InputError(f"{file}: {LOST} must be three numbers: mm, tooth, mm")
            _check_shapes(file, {key: _shape(archive, key) for key in KEYS}, max(gear.teeth for gear in design.gears.values()))
        with np.load(file, allow_pickle=False) as data:
            part = str(data["part"])
            radius, z, half_angle = (np.asarray(data[key], dtype=np.float64) for key in KEYS[:3])
            lost = np.asarray(data[LOST], dtype=np.float64) if known else None
    except FileNotFoundError:
        raise InputError(f"{file}: no such file; the folder that gearwear compare wrote to would be right") from None
    except InputError:
        raise
    except Exception as error:  # what numpy, zipfile and the tokenizer raise on a file that is no good has no end
        reason = next(iter(str(error).strip().splitlines()), type(error).__name__)[:120]
        raise InputError(f"{file}: cannot be read ({reason}); the {NAME} that gearwear compare writes would be right") from None
    # A gear that was compared by itself may be called otherwise there: its teeth and circles say which of the pair it is.
    fitting = [name for name, gear in design.gears.items() if _fits(gear, radius, half_angle)]
    if part in PARTS and part not in fitting and fitting:
        part = fitting[0]
    if part not in design.gears:
        raise InputError(f"{file}: is of a {part!r}, which the design does not have")
    gear = design.gears[part]
    _check(file, gear, radius, z, half_angle)
    return part, ToothProfiles(gear, radius, z, half_angle, lost=None if lost is None else _lost(file, gear, lost))


def _lost(file: Path, gear: Gear, lost: Floats) -> SectionLoss:
    value, tooth, z = (float(one) for one in lost)
    if not (
        abs(value) < gear.reference_radius * gear.pitch_angle and tooth in range(gear.teeth) and abs(z) <= 2.0 * gear.face_width
    ):
        raise InputError(
            f"{file}: {LOST} must be mm of arc below a pitch, a tooth from 0 to {gear.teeth - 1} and a height on the face in mm"
        )
    return SectionLoss(value, int(tooth), z)


def _shape(archive: zipfile.ZipFile, key: str) -> tuple[int, ...]:
    """Shape of an array as its header says it; nothing of the array is read."""
    with archive.open(f"{key}.npy") as stream:
        version = np.lib.format.read_magic(stream)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, kind = read(stream, max_header_size=1000)
    if kind.hasobject or kind.itemsize > WIDEST or (key != KEYS[-1] and kind.kind not in "fiu"):
        raise ValueError(f"{key} holds {str(kind)[:40]}")
    return tuple(int(length) for length in shape)


def _check_shapes(file: Path, shapes: dict[str, tuple[int, ...]], teeth: int) -> None:
    """Refuse shapes that do not belong together, and more than there is memory for, before anything is read."""
    angles = shapes["half_angle"]
    n_z, n_r = (shapes[key][0] if len(shapes[key]) == 1 else -1 for key in ("z", "radius"))
    if shapes["part"] != () or n_z < 1 or n_r < 2:
        raise InputError(f"{file}: radius and z must be rising rows of numbers and part one word")
    if angles[1:] != (2, n_z, n_r) or len(angles) != 4:
        raise InputError(f"{file}: half_angle must be finite and of shape (teeth, 2, {n_z}, {n_r})")
    if not 0 < angles[0] <= max(teeth, MOST_TEETH):
        raise InputError(f"{file}: is of a gear with {angles[0]:,} teeth, the design has {teeth}")
    try:
        check_memory(other=PER_ANGLE * math.prod(angles))
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def _fits(gear: Gear, radius: Floats, half_angle: Floats) -> bool:
    """Whether teeth and circles are those of a gear."""
    low, high = sorted((gear.root_radius, gear.flank_end_radius))
    return len(half_angle) == gear.teeth and bool(max(abs(radius[0] - low), abs(radius[-1] - high)) <= ON_CIRCLE)


def _check(file: Path, gear: Gear, radius: Floats, z: Floats, half_angle: Floats) -> None:
    for name, values in (("radius", radius), ("z", z)):
        if not np.isfinite(values).all() or not (np.diff(values) > 0.0).all():
            raise InputError(f"{file}: {name} must be a rising row of numbers")
    if not np.isfinite(half_angle).all():
        raise InputError(f"{file}: half_angle must be finite and of shape (teeth, 2, {len(z)}, {len(radius)})")
    ends, root = sorted((gear.root_radius, gear.flank_end_radius)), 0 if gear.orientation > 0 else -1
    if not _fits(gear, radius, half_angle):
        low, first, last, high = apart(radius[0], ends[0], ends[1], radius[-1])
        raise InputError(
            f"{file}: is of a gear with {len(half_angle)} teeth from r = {low} to {high} mm, the design has {gear.teeth} from "
            f"{first} to {last} mm"
        )
    if not (z[0] >= -gear.face_width and z[-1] <= 2.0 * gear.face_width):
        raise InputError(
            f"{file}: z goes from {as_given(z[0])} to {as_given(z[-1])} mm and the face from 0 to {as_given(gear.face_width)} mm"
        )
    most = (0.5 + SLACK) * gear.pitch_angle
    if not (np.abs(half_angle).max() <= most and (half_angle[..., root].sum(axis=1) > 0.0).all()):
        raise InputError(
            f"{file}: half_angle goes from {as_given(half_angle.min())} to {as_given(half_angle.max())} rad: teeth whole at the root and apart from each other would be right, "
            f"within ±{at_most(most)} rad"
        )
