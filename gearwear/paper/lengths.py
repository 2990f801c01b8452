"""The contact lengths."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import ROUND_HALF_UP

from gearwear.meshing.backlash import centre_distance_for_backlash
from gearwear.meshing.path import path_of_contact
from gearwear.meshing.published import contact_length
from gearwear.paper.explain import Row, changed, cut, explain, quantised, rounded
from gearwear.paper.inputs import PAPER, Inputs, gears


def _length(p: Inputs) -> float:
    return contact_length(*p.tip_radii, *p.base_radii, p.centre_distance, p.pressure_angle)


def _worn_length(p: Inputs) -> float:
    return contact_length(*p.tip_radii, *p.base_radii, p.worn_centre_distance, p.worn_pressure_angle)


def contact_lengths() -> tuple[Row, ...]:
    pinion, gear = gears()
    C, base_pitch = PAPER.centre_distance, pinion.base_pitch
    sharp, usual, full = (path_of_contact(*gears(tip), C) for tip in (0.25, 0.30, 0.38))
    printed = path_of_contact(pinion, gear, PAPER.worn_centre_distance)
    exact = path_of_contact(pinion, gear, centre_distance_for_backlash(pinion, gear, PAPER.backlash, "operating"))
    up = tuple(_half_up(r) for r in PAPER.tip_radii)
    radii = changed(f"tip radii rounded up to {up[0]:g} and {up[1]:g}", tip_radii=up)
    angle = changed("θ′ cut off to 23.04°", worn_pressure_angle=math.radians(23.04))
    bases = (35.80, 71.6)
    elsewhere = [
        changed("only the pinion's tip radius rounded", tip_radii=(up[0], PAPER.tip_radii[1])),
        changed("base diameters 71.60 and 143.2", base_radii=bases),
        changed("base diameters 71.60 and 143.2, tip radii rounded", base_radii=bases, tip_radii=up),
    ]
    bases_and_angle = changed(
        "base diameters 71.60 and 143.2, θ′ 23.04°", base_radii=bases, worn_pressure_angle=math.radians(23.04)
    )
    angle_up = changed("tip radii rounded, θ′ rounded to 23.05°", tip_radii=up, worn_pressure_angle=math.radians(23.05))
    all_rounded = changed(
        "base diameters 71.60 and 143.2, tip radii rounded, θ′ 23.04°",
        base_radii=bases,
        tip_radii=up,
        worn_pressure_angle=math.radians(23.04),
    )
    overrun = gear.tip_roll - sharp.line
    reduction = [100 * (1 - printed.length / path.length) for path in (sharp, usual, full)]
    return (
        explain(
            "contact length as designed l",
            "mm",
            "28.51",
            _length,
            [radii, cut(2)],
            elsewhere,
            right=usual.length,
            why=f"The gear's tip passes the pinion's interference point by {overrun:.3f} mm: the formula counts involute that the undercut "
            "has taken away. The true path begins where the rack's tip left an involute. The contact ratio is "
            f"{sharp.contact_ratio:.3f} to {full.contact_ratio:.3f} for rack tip radii of 0.25 to 0.38 modules, in place of {_length(PAPER) / base_pitch:.3f}.",
            cases={
                "rack tip radius 0.25 modules (0.30 above)": sharp.length,
                "rack tip radius 0.38 modules": full.length,
                "never more: from the interference point to the pinion's tip": pinion.tip_roll,
            },
        ),
        explain(
            "contact length after wear l′",
            "mm",
            "21.92",
            _worn_length,
            [radii, angle, cut(2)],
            [replace(angle, name="only θ′ cut off to 23.04°"), *elsewhere, bases_and_angle, all_rounded, angle_up],
            right=exact.length,
            why="Both roundings are needed, and θ′ was 23.04°, not 23.05°; rounded base diameters would do in its place here, but then l would be "
            "28.52. At c′ the gear's tip no longer reaches below the pinion's form circle, and the formula holds: contact ratio "
            f"{printed.contact_ratio:.3f} at the printed c′. In a housing the path of the involutes does not change; what the worn flanks do is a "
            "matter of their shape.",
            cases={"at the printed c′": printed.length, "shafts in a housing, which do not move": usual.length},
        ),
        explain(
            "reduction of the contact length",
            "%",
            "23",
            lambda p: 100 * (1 - p.contact_lengths[1] / p.contact_lengths[0]),
            [rounded(0)],
            right=reduction[1],
            why="From the true path as designed to that at the printed c′.",
            cases={
                "rack tip radius 0.25 modules (0.30 above)": reduction[0],
                "rack tip radius 0.38 modules": reduction[2],
                "the paper's formula without its roundings": 100 * (1 - _worn_length(PAPER) / _length(PAPER)),
                "shafts in a housing, which do not move": 0.0,
            },
        ),
    )


def _half_up(value: float) -> float:
    return quantised(value, 1, ROUND_HALF_UP)
