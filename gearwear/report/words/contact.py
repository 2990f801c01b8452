"""The numbers of the contact, by design and worn, and within what limits they lie where the scan leaves them open, in words."""

from __future__ import annotations

import math
from collections.abc import Callable

from gearwear.comparison.contact_readings import ReadOtherwise
from gearwear.comparison.results import PairResult
from gearwear.design.quantity import NORMAL_95, number
from gearwear.meshing.backlash import Backlash
from gearwear.report.words.numbers import between

SHORT = {
    ReadOtherwise.SIDES: "worn or made so",
    ReadOtherwise.PATTERN: "a form that may be the scanner's",
    ReadOtherwise.CARRIED: "a form that the worn side may have too",
    ReadOtherwise.EITHER: "made so or scanned so",
    ReadOtherwise.TOGETHER: "effects that take each other back",
    ReadOtherwise.UNSURE: "loss of flanks that look worn",
    ReadOtherwise.VIEWS: "views that lie apart",
}
"""What leaves them open, beside a number, without a comma, at which a terminal may cut it."""


def reaches_beyond(value: float, std: float, limits: tuple[float, float] | None, digits: int) -> bool:
    """Whether limits go beyond the value's own 95 % interval by what can be seen in so many digits."""
    if limits is None:
        return False
    return max(value - limits[0], limits[1] - value) > NORMAL_95 * std + 0.5 * 10.0**-digits


def why_open(pair: PairResult) -> str:
    """What leaves the contact open, in few words; "" where nothing does."""
    return "" if pair.limits is None else SHORT[pair.limits.why[0]]


def contact_rows(pair: PairResult) -> list[tuple[str, str, str, str]]:
    """What the contact is by design and worn, and the change, line by line."""
    exact, angle = pair.design, math.degrees(pair.design.working_pressure_angle)
    least, most, std = pair.least_backlash, pair.greatest_backlash, pair.greatest_backlash_std
    plays: tuple[tuple[str, Callable[[Backlash], float]], ...] = (
        ("circumferential backlash, mm", lambda play: play.circumferential),
        ("normal backlash, mm", lambda play: play.normal),
        ("radial backlash, mm", lambda play: play.radial),
        ("angular backlash of the pinion, °", lambda play: math.degrees(play.angular_pinion)),
        ("angular backlash of the gear, °", lambda play: math.degrees(play.angular_gear)),
    )
    if exact.backlash.axial is not None:
        plays += (("axial backlash, mm", lambda play: play.axial or 0.0),)
    te_std = 0.0 if pair.spread is None else 1e3 * pair.spread.transmission_error
    open_ = None if pair.open_backlash is None else pair.open_backlash[0]
    return [
        _compared("centre distance, mm", exact.centre_distance, exact.centre_distance, 3),
        _compared("working pressure angle, °", angle, angle, 3),
        *(
            _compared(
                name, of(exact.backlash), of(most), 4, of(least), 0.0 if std is None else of(std),
                None if open_ is None else (of(open_[0]), of(open_[1])),
            )
            for name, of in plays
        ),
        _compared("path of contact, mm", exact.path.length, pair.path_length, 3, limits=pair.open_path),
        _compared("contact ratio", exact.path.total_contact_ratio, pair.contact_ratio, 3, limits=pair.open_ratio),
        _compared(
            "transmission error, peak to peak, µm", 0.0, pair.contact.peak_to_peak_um, 1, std=te_std, limits=pair.open_error_um
        ),
    ]  # fmt: skip


def _compared(
    name: str, design: float, worn: float, digits: int, least: float | None = None, std: float = 0.0,
    limits: tuple[float, float] | None = None,
) -> tuple[str, str, str, str]:  # fmt: skip
    shown = number(worn, digits) if least is None else f"{number(least, digits)} … {number(worn, digits)}"
    shown += f" ± {number(std, digits)}" if round(std, digits) > 0.0 else ""
    shown += f" ({between(limits, digits)})" if limits is not None and reaches_beyond(worn, std, limits, digits) else ""
    change = number(worn - design, digits)
    return (
        name,
        number(design, digits),
        shown,
        f"+{change}" if worn > design and any(d in change for d in "123456789") else change,
    )
