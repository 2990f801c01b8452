"""K bands from a small TOML file."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearwear.design.files.toml import parse_toml, read_small
from gearwear.design.gear import Gear
from gearwear.design.quantity import as_given, at_least
from gearwear.errors import InputError, readable
from gearwear.inspection.k_band import KBand, KBands
from gearwear.inspection.ranges import helix_range, profile_ends, profile_place, profile_range
from gearwear.inspection.tolerances import Edition, Size, tolerances

LIMITS = ("lower_um", "upper_um")
FARTHEST = 1e6
"""No place (mm, °) and no limit (µm) of a band lies beyond it."""
PLACES = {"profile": ("diameter_mm", "roll_mm", "roll_angle_deg"), "helix": ("z_mm",)}
"""Keys a band's places may be given under."""


def read_k_bands(path: str | Path, gear: Gear) -> KBands:
    """Read the K bands of a drawing.

    Parameters
    ----------
    path : path
        TOML with ``[profile]``, ``[helix]`` or both. Each holds as many ``lower_um`` and ``upper_um`` as places: ``diameter_mm``,
        ``roll_mm`` or ``roll_angle_deg`` of a profile, ``z_mm`` of a helix; rising, of a ring's profile from the root or from the tip. ``[profile.left]``, ``[profile.right]`` and so on where the sides differ.
    gear : Gear
        Whose flanks the places are on.

    Returns
    -------
    KBands

    Raises
    ------
    InputError
        If the file cannot be read, or a band is none, or does not lie on the flank.

    Examples
    --------
    >>> import tempfile
    >>> from gearwear.design import GearSpec
    >>> file = Path(tempfile.mkdtemp()) / "bands.toml"
    >>> _ = file.write_text("[helix]\\nz_mm = [1, 14]\\nlower_um = [-10, -10]\\nupper_um = [10, 10]")
    >>> read_k_bands(file, Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))).helix[0]
    KBand(station=(1.0, 14.0), lower=(-0.01, -0.01), upper=(0.01, 0.01))
    """
    file = Path(path)
    text = read_small(file, "a TOML file of K bands with [profile] or [helix]")
    try:
        data = parse_toml(text)
        unknown = next((name for name in data if name not in PLACES), None)
        if unknown is not None or not data:
            raise InputError(f"{f'[{unknown}]' if data else 'nothing in it'}: [profile], [helix] or both hold the K bands")
        bands = {name: _sides(name, data[name], gear) if name in data else (None, None) for name in PLACES}
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    return KBands(bands["profile"], bands["helix"], readable(path))


def class_k_bands(
    gear: Gear,
    iso_class: int,
    edition: Edition = Edition.ISO_2013,
    start: float | None = None,
    end: float | None = None,
    between: tuple[float, float] | None = None,
) -> KBands:
    """Straight bands as wide as the total tolerances F_α and F_β of a class over the evaluation ranges.

    Parameters
    ----------
    gear : Gear
    iso_class : int
    edition : Edition
    start, end : float or None
        L of the profile control circle and of the evaluation's end, mm, as `Settings.control_roll` and `Settings.profile_end`.
    between : (float, float) or None
        z to z of the helix evaluation, mm, as `Settings.helix_between`.
    """
    limits = tolerances(Size.of(gear), iso_class, edition)
    first, last = (None if roll is None else profile_place(gear, roll) for roll in (start, end))
    profile = KBand.straight(profile_range(gear, edition, first, last), limits.profile_total)
    helix = KBand.straight(helix_range(gear, between), limits.helix_total)
    return KBands((profile, profile), (helix, helix), f"Fα and Fβ of {edition}, class {iso_class}")


def _sides(name: str, table: Any, gear: Gear) -> tuple[KBand | None, KBand | None]:
    """The bands of the left and of the right flanks."""
    if not isinstance(table, dict):
        raise InputError(f"{name} must be a table, written [{name}]")
    apart = [side for side in ("left", "right") if side in table]
    if not apart:
        band = _band(name, f"[{name}]", table, gear)
        return band, band
    other = next((key for key in table if key not in apart), None)
    if other is not None:
        raise InputError(f"[{name}] {other}: with [{name}.left] or [{name}.right] it belongs into these")
    left, right = (_band(name, f"[{name}.{side}]", table[side], gear) if side in apart else None for side in ("left", "right"))
    return left, right


def _band(name: str, where: str, table: Any, gear: Gear) -> KBand:
    known = (*PLACES[name], *LIMITS)
    if not isinstance(table, dict):
        raise InputError(f"{where} must be a table")
    for key in table:
        if key not in known:
            raise InputError(f"{where} {key}: unknown; there are {', '.join(known)}")
    given = [key for key in PLACES[name] if key in table]
    if len(given) != 1:
        raise InputError(f"{where} needs its places once, as {' or '.join(PLACES[name])}")
    place = [TO_STATION[given[0]](value, gear, where) for value in _numbers(where, given[0], table)]
    lower, upper = ([1e-3 * value for value in _numbers(where, key, table)] for key in LIMITS)
    low, high = (0.0, gear.face_width) if name == "helix" else profile_ends(gear)
    slack = 1e-3 * (high - low)  # a drawing rounds the ends of its flank
    for value, shown in zip(place, table[given[0]], strict=True):
        if not low - slack <= value <= high + slack:
            ends = " to ".join(FROM_STATION[given[0]](end, gear) for end in (low, high))
            raise InputError(f"{where} {given[0]} = {shown:g} is not on the flank, which has {ends}")
    if name == "profile" and gear.orientation < 0 and place[0] > place[-1]:  # written from the tip on
        place, lower, upper = place[::-1], lower[::-1], upper[::-1]
    try:
        return KBand(tuple(place), tuple(lower), tuple(upper))
    except InputError as error:
        raise InputError(f"{where} {error}") from None


def _numbers(where: str, key: str, table: dict[str, Any]) -> list[float]:
    values = table.get(key)
    if not isinstance(values, list) or not all(
        isinstance(v, int | float) and not isinstance(v, bool) and -FARTHEST <= v <= FARTHEST for v in values
    ):
        raise InputError(f"{where} {key} must be a list of numbers from {-FARTHEST:g} to {FARTHEST:g}, such as {key} = [1, 2]")
    return [float(v) for v in values]


def _from_diameter(value: float, gear: Gear, where: str) -> float:
    radius = 0.5 * value
    if radius < gear.base_radius:
        raise InputError(
            f"{where} diameter_mm = {as_given(value)} lies inside the base circle, {at_least(2 * gear.base_radius, 3)} mm"
        )
    return profile_place(gear, float(gear.roll_length(radius)))


TO_STATION: dict[str, Callable[[float, Gear, str], float]] = {
    "diameter_mm": _from_diameter,
    "roll_mm": lambda value, gear, where: profile_place(gear, value),
    "roll_angle_deg": lambda value, gear, where: profile_place(gear, gear.base_radius * math.radians(value)),
    "z_mm": lambda value, gear, where: value,
}
FROM_STATION: dict[str, Callable[[float, Gear], str]] = {
    "diameter_mm": lambda station, gear: f"{2 * math.hypot(gear.base_radius, station):.3f} mm",
    "roll_mm": lambda station, gear: f"{abs(station):.3f} mm",
    "roll_angle_deg": lambda station, gear: f"{math.degrees(abs(station) / gear.base_radius):.3f}°",
    "z_mm": lambda station, gear: f"{station:g} mm",
}
