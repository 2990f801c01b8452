"""Estimates, flanks and effects in words: what the page, the terminal and the verdict share."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from gearwear.design.gear import Gear
from gearwear.design.quantity import MISSING, SPACE, counted, listed, number, pretty_unit, significant, with_std
from gearwear.diagnose.effects.base import ParameterEstimate
from gearwear.wear.regions import Wear, WearRegion


def thickness_place(gear: Gear) -> str:
    """Where the thickness of teeth is measured, as words behind it.

    >>> from gearwear.design.spec import GearSpec
    >>> thickness_place(Gear.from_spec(GearSpec("gear", 30, 3.0, 14.0, profile_shift=-1.05))).replace(SPACE, " ")
    'at ⌀ 89.10 mm'
    """
    if gear.thickness_radius == gear.reference_radius:
        return "at the reference circle"
    return f"at ⌀{SPACE}{number(2.0 * gear.thickness_radius, 2)}{SPACE}mm"


def quantity(estimate: ParameterEstimate) -> str:
    """A parameter of an effect in words: value ± standard deviation, or the range of a list; what nobody saw is said to be assumed.

    >>> quantity(ParameterEstimate(3.0, math.nan, "1")), quantity(ParameterEstimate((-2.0, 4.0), (0.1, 0.1), "um")).replace(SPACE, " ")
    ('3', '−2.00 … 4.00 µm')
    >>> quantity(ParameterEstimate(-12000.0, 150.0, "ppm")).replace(SPACE, " ")
    '−1.200 ± 0.015 %'
    >>> quantity(ParameterEstimate(15.0, math.nan, "um")).replace(SPACE, " ")
    '15.0 µm (assumed)'
    """
    value, std, unit = estimate.value, estimate.std, pretty_unit(estimate.unit)
    if isinstance(value, tuple):
        values = [v for v in value if math.isfinite(v)]
        return f"{significant(min(values))} … {significant(max(values))}{SPACE}{unit}".rstrip(SPACE) if values else MISSING
    known = None if isinstance(std, tuple) or not math.isfinite(std) else std
    if not unit and value.is_integer() and not known:
        return number(value, 0)  # an order, a count
    if unit == "ppm" and abs(value) >= 1e4:
        value, known, unit = 1e-4 * value, None if known is None else 1e-4 * known, "%"
    return with_std(value, known, unit) + (" (assumed)" if unit and isinstance(std, float) and math.isnan(std) else "")


def named(parameters: Mapping[str, ParameterEstimate]) -> list[str]:
    """Parameters of an effect with their names, the unit after the number instead of in the name.

    >>> named({"order": ParameterEstimate(3.0, math.nan, "1"), "amplitude_um": ParameterEstimate(5.0, 0.1, "um")})[1].replace(SPACE, " ")
    'amplitude 5.00 ± 0.10 µm'
    """
    return [
        f"{name.removesuffix(f'_{estimate.unit}').replace('_', ' ')} {quantity(estimate)}"
        for name, estimate in parameters.items()
    ]


def between(limits: tuple[float, float], digits: int, unit: str = "") -> str:
    """Limits in so many digits, with their unit.

    >>> between((0.0, 16.77), 1, "µm").replace(SPACE, " ")
    '0.0 to 16.8 µm'
    """
    return f"{number(limits[0], digits)} to {number(limits[1], digits)}" + (f"{SPACE}{unit}" if unit else "")


def row(values: Iterable[float], digits: int) -> str:
    """A vector on one line.

    >>> row([1.0, math.nan, -2.25], 1)
    '1.0, –, −2.2'
    """
    return ", ".join(number(value, digits) for value in values)


def which_flanks(regions: Iterable[WearRegion], wear: Wear | None = None, scanned: str = "that were seen") -> str:
    """Which flanks some regions of wear lie on, in few words: "the left flank of tooth 2", "all 3 left flanks"; of a scan of some teeth alone
    "all 3 left flanks that were seen", or another word for what was `scanned`. `wear` is all that was found, None for "3 left flanks"."""
    flanks = {(region.tooth + 1, region.side) for region in regions}
    sides = {side for _, side in flanks}
    if len(flanks) == 1:
        ((tooth, side),) = flanks
        return f"the {side} flank of tooth {tooth}"
    if len(sides) == 1:
        side = sides.pop()
        which = f"{len(flanks)} {side} flanks"
        if wear is None or len(flanks) != wear.flanks_seen(side):
            return which
        return f"all {which}" if len(flanks) == len(wear.side_maps.count) else f"all {which} {scanned}"
    numbers = {tooth for tooth, _ in flanks}
    return f"{len(flanks)} flanks of {counted(len(numbers), 'tooth', 'teeth')}"


def or_words(alternatives: Iterable[str]) -> str:
    """What an effect cannot be told from, in brackets behind it; "" where it is certain.

    >>> or_words(["scale", "tip_relief"]), or_words([])
    (' (or scale or tip relief)', '')
    """
    names = listed(map(effect_title, alternatives), "or")
    return f" (or {names})" if names else ""


def effect_title(name: str) -> str:
    """An effect's name as a person writes it.

    >>> effect_title("axis_offset_radial")
    'axis offset radial'
    """
    return name.replace("_", " ")
