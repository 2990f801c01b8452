"""The wear law and its forecast."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearwear.design.quantity import NORMAL_95
from gearwear.errors import InputError
from gearwear.report.figures.colours import ALARM, BLUE, MUTED, ORANGE
from gearwear.report.figures.given import check_axis, check_drawn
from gearwear.report.figures.legend import legend_above
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.study import WearStudy

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def worn_profile(axis: Axes, law: WearStudy) -> Axes:
    """Mean depth of the worn flanks along the profile, and the law fitted to it; metal is lost downwards."""
    check_axis(axis)
    check_drawn(WearStudy, law=law)
    fit, path, (roll, depth) = law.best, law.path, law.over_path
    if fit is None or path is None:
        raise InputError(f"nothing to draw: {law.why_not}")
    axis.axhline(0.0, color=MUTED, ls=(0, (5, 2)), lw=1.0)
    error = 1e3 * NORMAL_95 * fit.std
    axis.errorbar(fit.roll, 1e3 * fit.depth, error, fmt="o", ms=2.5, lw=0.8, color=BLUE, label="measured, mean flank")
    axis.plot(roll, 1e3 * depth, color=ORANGE, label="law", zorder=3)
    for border in path.single_contact_pinion if path.overlap_ratio == 0.0 else ():
        axis.axvline(border, color=MUTED, ls=":", lw=1.0)
    axis.set(xlabel="length of roll, mm", ylabel="depth, µm")
    axis.invert_yaxis()
    axis.grid()
    legend_above(axis, 2)
    return axis


def greatest_depth(axis: Axes, law: WearStudy) -> Axes:
    """Greatest depth of the mean flank against cycles with its band, and limits with the cycles that reach them."""
    check_axis(axis)
    check_drawn(WearStudy, law=law)
    forecast = law.forecast
    if forecast is None:
        raise InputError("nothing to draw: no forecast; one of ahead=gw.Ahead(cycles_run, cycles) would be right")
    size, name = next((scale for scale in ((1e6, "millions"), (1e3, "thousands")) if forecast.cycles[-1] >= scale[0]), (1.0, ""))
    cycles = forecast.cycles / size
    value, low, high = (1e3 * getattr(forecast.greatest_depth, part) for part in ("value", "low", "high"))
    axis.fill_between(cycles, low, high, color=BLUE, alpha=0.2, lw=0.0)
    axis.plot(cycles, value, color=BLUE, label="forecast", marker="o", ms=4)
    axis.errorbar(cycles[:1], value[:1], [value[:1] - low[:1], high[:1] - value[:1]], fmt="o", ms=5, color=MUTED, label="now")
    for mark in law.left:
        if mark.quantity != "depth":
            continue
        limit = 1e3 * mark.limit
        axis.axhline(limit, color=ALARM, ls=(0, (5, 2)), lw=1.0, label="limit")
        soon, reached, late = ((forecast.cycles_run + left) / size for left in (mark.left.low, mark.left.value, mark.left.high))
        if np.isfinite([soon, reached]).all():
            axis.plot([cycles[0], reached], [value[0], limit], color=BLUE, lw=1.0, ls=(0, (5, 2)))
            axis.plot([soon, late if np.isfinite(late) else reached], [limit, limit], color=ALARM, lw=3.0, alpha=0.55)
            axis.plot(reached, limit, "v", color=ALARM, ms=5)
    axis.set(xlabel=f"mesh cycles since new, {name}".rstrip(", "), ylabel="greatest depth, µm")
    axis.set_ylim(bottom=min(0.0, float(low.min())))
    axis.grid()
    legend_above(axis, 3)
    return axis


def across_face(axis: Axes, across: AcrossFace) -> Axes:
    """Mean depth of the worn flanks across the face; metal is lost downwards."""
    check_axis(axis)
    check_drawn(AcrossFace, across=across)
    axis.axhline(1e3 * across.mean, color=MUTED, ls=(0, (5, 2)), lw=1.0, label="mean")
    error = 1e3 * NORMAL_95 * across.std
    axis.errorbar(across.z, 1e3 * across.depth, error, fmt="o", ms=2.5, lw=0.8, color=BLUE, label="measured, row by row")
    axis.set(xlabel="z, mm", ylabel="depth, µm")
    axis.invert_yaxis()
    axis.grid()
    legend_above(axis, 2)
    return axis
