"""The scan: slices and points."""

from __future__ import annotations

import math

import numpy as np

from gearwear.design import Gear
from gearwear.paper.explain import Cause, Row, changed, explain
from gearwear.paper.inputs import PAPER, Inputs, gears


def _grid(p: Inputs) -> float:
    return p.slices * p.teeth[0] * p.points_per_tooth


def scan() -> tuple[Row, ...]:
    whole = changed("75 slices, the whole face of 15 mm", slices=75)
    fewer = changed("one point less on every tooth of every slice", points_per_tooth=504)
    sharp, full = (_contour_length(gears(tip)[0]) for tip in (0.25, 0.38))
    slices = PAPER.points / PAPER.points_per_tooth / PAPER.teeth[0]
    return (
        explain(
            "face width",
            "mm",
            "15",
            lambda p: p.points / p.points_per_tooth / p.teeth[0] * p.slice_step,
            [Cause("a whole number of slices", write=lambda width: math.ceil(width / PAPER.slice_step) * PAPER.slice_step)],
            right=15.0,
            why=f"From the number of points: {slices:.2f} slices of 0.2 mm. The scan covered the whole face.",
        ),
        explain(
            "slices analysed, z = 0 to 12.8 mm in steps of 0.2",
            "",
            "65",
            lambda p: 12.8 / p.slice_step + 1,
            right=75.0,
            why="The scan has 75; the last 2 mm of the face were left out.",
        ),
        explain(
            "points before wear",
            "",
            "453645",
            _grid,
            [whole],
            right=None,
            cases={"a whole grid of 75 slices": 75.0 * 12 * 505},
            why=f"A count has no right value. It is that of 75 slices less {100 * (1 - 453645 / (75 * 12 * 505)):.2f} %.",
        ),
        explain(
            "points after wear",
            "",
            "452742",
            _grid,
            [whole, fewer],
            right=None,
            cases={"a whole grid of 75 slices with 504 points per tooth": 75.0 * 12 * 504},
            why=f"The two scans differ by {PAPER.points - 452742} points on {75 * 12} tooth slices: one point less on every tooth of every slice, worn or not. "
            "Counts of points say nothing about wear.",
        ),
        explain(
            "points per tooth and slice",
            "",
            "505",
            lambda p: p.points / (75 * p.teeth[0]),
            [Cause("made up to a whole number", write=lambda count: float(math.ceil(count)))],
            right=None,
            why=f"A count has no right value. A tooth's contour is {full:.1f} to {sharp:.1f} mm long (rack tip radius 0.38 to 0.25 "
            f"modules), so points lie {0.5 * (full + sharp) / 505:.3f} mm apart, closer than the 0.2 mm of the slices: overlapping views "
            "or interpolation.",
        ),
        explain(
            "section at which the wear is read",
            "mm",
            "1",
            lambda p: 5 * p.slice_step,
            right=None,
            why="One slice of 75, in the zone of edge chamfer, edge effect and occlusion. Every slice has to be used, and their spread said.",
        ),
    )


def _contour_length(gear: Gear) -> float:
    """Outline of one tooth and its space, mm; closed form but for the trochoid, a polyline exact to 1e-6."""
    radius, angle = gear.rack.polar(np.linspace(0.0, gear.fillet_end, 5001))
    fillet = float(np.hypot(np.diff(radius * np.cos(angle)), np.diff(radius * np.sin(angle))).sum())
    flank = (gear.tip_roll**2 - gear.form_roll**2) / (2.0 * gear.base_radius)
    return 2.0 * (gear.root_radius * gear.root_half_angle + fillet + flank + gear.tip_radius * gear.tip_half_angle)
