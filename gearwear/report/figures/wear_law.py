"""The wear law and its forecast, drawn from `meshing` → `wear_law` of the report."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearwear.report.figures.arrays import Report
from gearwear.report.figures.colours import BLUE, LOST, MUTED, ORANGE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BAND = 1.96
"""Standard deviations of a 95 % band."""


def worn_profile(axis: Axes, law: Report) -> Axes:
    """Mean depth of the worn flanks along the profile, and the law fitted to it; metal is lost downwards."""
    profile = {name: np.asarray(values, dtype=np.float64) for name, values in law["profile"].items()}
    roll, depth, std = profile["roll_mm"], profile["depth_um"], profile["std_um"]
    axis.axhline(0.0, color=MUTED, ls=(0, (5, 2)), lw=1.0)
    axis.errorbar(roll, depth, BAND * std, fmt="o", ms=2.5, lw=0.8, color=BLUE, label="measured, mean flank")
    axis.plot(law["law_over_path"]["roll_mm"], law["law_over_path"]["depth_um"], color=ORANGE, label="law", zorder=3)
    for border in law.get("single_contact_mm") or []:
        axis.axvline(border, color=MUTED, ls=":", lw=1.0)
    axis.set(xlabel="length of roll, mm", ylabel="depth, µm")
    axis.invert_yaxis()
    axis.grid()
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    return axis


def greatest_depth(axis: Axes, forecast: Report) -> Axes:
    """Greatest depth of the mean flank against cycles with its band, and limits with the cycles that reach them."""
    at = forecast["at"]
    cycles = np.array([row["cycles"] for row in at])
    size, name = next((one for one in ((1e6, "millions"), (1e3, "thousands")) if cycles[-1] >= one[0]), (1.0, ""))
    cycles = cycles / size
    value, low, high = (np.array([row["greatest_depth_um"][name] for row in at]) for name in ("value", "low", "high"))
    axis.fill_between(cycles, low, high, color=BLUE, alpha=0.2, lw=0.0)
    axis.plot(cycles, value, color=BLUE, label="forecast", marker="o", ms=4)
    axis.errorbar(cycles[:1], value[:1], [value[:1] - low[:1], high[:1] - value[:1]], fmt="o", ms=5, color=MUTED, label="now")
    for one in forecast.get("cycles_left") or []:
        if one["quantity"] != "depth":
            continue
        limit, run = one["limit_um"], forecast["cycles_run"]
        axis.axhline(limit, color=LOST, ls=(0, (5, 2)), lw=1.0, label="limit")
        ends = [
            (run + one[side]) / size if one[side] is not None and np.isfinite(one[side]) else None
            for side in ("low", "value", "high")
        ]
        soon, reached, late = ends
        if reached is not None and soon is not None:
            axis.plot([cycles[0], reached], [value[0], limit], color=BLUE, lw=1.0, ls=(0, (5, 2)))
            axis.plot([soon, reached if late is None else late], [limit, limit], color=LOST, lw=3.0, alpha=0.55)
            axis.plot(reached, limit, "v", color=LOST, ms=5)
    axis.set(xlabel=f"mesh cycles since new, {name}".rstrip(", "), ylabel="greatest depth, µm")
    axis.set_ylim(bottom=min(0.0, float(low.min())))
    axis.grid()
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)
    return axis
