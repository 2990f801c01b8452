"""From the loss to backlash, centre distance, pressure angle and pitch radii."""

from __future__ import annotations

import math

from gearwear.design import Baseline
from gearwear.meshing.backlash import backlash, centre_distance_for_backlash, operating_pitch_radii, working_pressure_angle
from gearwear.meshing.published import backlash_from_loss, centre_distance_change
from gearwear.meshing.shafts import shaft_movement
from gearwear.paper.explain import Effect, Row, changed, cut, explain, rounded
from gearwear.paper.inputs import MODULE, PAPER, Inputs, gears

MM_PER_INCH = 25.4


def _change(p: Inputs) -> float:
    pitch = math.pi * p.module
    return centre_distance_change(pitch, *p.thicknesses, p.backlash, p.pressure_angle)


def distances() -> tuple[Row, ...]:
    pinion, gear = gears()
    C = PAPER.centre_distance
    on_operating = centre_distance_for_backlash(pinion, gear, PAPER.backlash, "operating")
    on_reference = centre_distance_for_backlash(pinion, gear, PAPER.backlash, "reference")
    total = backlash_from_loss(PAPER.thickness_loss, PAPER.allowance, Baseline.PRE_WEAR_SCAN)
    at_total = centre_distance_for_backlash(pinion, gear, total, "reference")
    taken_up = shaft_movement(pinion, gear, C, PAPER.thickness_loss, PAPER.allowance)
    there = backlash(pinion, gear, PAPER.worn_centre_distance)
    angles = [math.degrees(working_pressure_angle(pinion, gear, at)) for at in (on_operating, on_reference)]
    radii = operating_pitch_radii(pinion, gear, on_operating)
    least = 2 / 3 * (0.06 + 0.0005 * C + 0.03 * MODULE)  # ISO/TR 10064-2 [from memory of the standard]
    linear_take_up = changed(
        "eq. 7 with the loss in t1, the allowance as wanted backlash",
        thicknesses=(PAPER.thicknesses[0] - PAPER.thickness_loss, PAPER.thicknesses[1]),
        backlash=PAPER.allowance,
    )
    fixed = "Shafts in a housing do not move: there it stays {}."
    return (
        explain(
            "recommended backlash",
            "mm",
            "0.2286",
            lambda p: 0.009 * MM_PER_INCH,
            right=None,
            why="A recommendation, no calculation gives it. 0.009 in is the middle of the classical 0.007 to 0.011 in for a diametral "
            f"pitch of 4 [from memory]; the least by ISO/TR 10064-2 [from memory] is {least:.4f} mm on the normal, "
            f"{least / math.cos(PAPER.pressure_angle):.4f} mm of arc.",
        ),
        explain(
            "backlash B",
            "mm",
            "1.7634",
            lambda p: backlash_from_loss(p.thickness_loss, p.allowance, Baseline.ZERO_BACKLASH),
            alternatives=[
                Effect(
                    "allowance added, as for a loss from a scan before wear",
                    write=lambda _: backlash_from_loss(PAPER.thickness_loss, PAPER.allowance, Baseline.PRE_WEAR_SCAN),
                )
            ],
            right=total,
            why="B′ compares scans before and after wear, so the design's backlash was there already and comes on top. Subtracting is "
            f"right only for a loss measured from a drawing without backlash (`baseline`). The difference is {2 * PAPER.allowance:.3f} mm; unworn "
            f"gears have the total play at a centre distance of {at_total:.3f} mm.",
        ),
        explain(
            "centre distance change Δc, as the play of unworn gears",
            "mm",
            "-2.422",
            _change,
            [cut(3)],
            right=C - on_operating,
            why="First order: racks in place of teeth. The exact inverse of the same B, measured on the operating circles, is smaller. Both "
            f"only say where unworn gears would have this play. {fixed.format('0')}",
        ),
        explain(
            "centre distance change Δc, if it is to take the wear up",
            "mm",
            "-2.422",
            _change,
            [cut(3)],
            [linear_take_up],
            right=-(taken_up.movement or 0.0),
            why="The shafts would have to close, not part. To the allowance of 0.2286 mm it is c′ = "
            f"{taken_up.centre_distance:.3f} mm, and that cannot be: tips bottom at {taken_up.bottoming_centre_distance:.4f} mm, so at most "
            f"{taken_up.takeable_loss:.2f} mm of lost thickness can be taken up; and teeth less worn would jam before.",
        ),
        explain(
            "centre distance after wear c′",
            "mm",
            "116.722",
            lambda p: p.centre_distance - _change(p),
            [cut(3)],
            right=on_operating,
            why=f"The exact inverse of the same B is {on_operating:.4f} mm with B on the operating circles, {on_reference:.4f} mm with B on "
            f"the reference circles. {fixed.format(f'{C:g} mm')}",
        ),
        explain(
            "backlash of unworn gears at that c′",
            "mm",
            "1.7634",
            lambda p: 2 * (p.worn_centre_distance - p.centre_distance) * math.tan(p.pressure_angle),
            [Effect("c′ before it was cut off", change=lambda p: _with_full_distance(p))],
            right=there.circumferential,
            why=f"Exact, on the operating circles; {there.normal:.4f} mm on the normal. The first-order formula gives "
            f"{1 - PAPER.backlash / there.circumferential:.1%} too little.",
        ),
        explain(
            "pressure angle after wear θ′",
            "°",
            "23.04",
            lambda p: math.degrees(math.acos(sum(p.base_radii) / p.worn_centre_distance)),
            [cut(2)],
            [
                rounded(2),
                Effect(
                    "cos 20° = 0.9397, then cut off after 2 decimals",
                    change=lambda p: changed("", base_radii=(0.9397 * 6 * p.module, 0.9397 * 12 * p.module)).change(p),
                    write=cut(2).write,
                ),
            ],
            right=angles[0],
            why=f"At the exact centre distances: {angles[0]:.3f}° and {angles[1]:.3f}°. Whether it was cut off or made with a cosine of four "
            f"digits the print does not tell. {fixed.format('20°')}",
        ),
        explain(
            "pinion pitch radius after wear",
            "mm",
            "38.90",
            lambda p: p.worn_centre_distance * p.teeth[0] / sum(p.teeth),
            [cut(2)],
            [rounded(2)],
            right=radii[0],
            why=f"This is the operating pitch radius; the reference circle does not wear. {fixed.format('38.1 mm')}",
        ),
        explain(
            "gear pitch radius after wear",
            "mm",
            "77.81",
            lambda p: p.worn_centre_distance * p.teeth[1] / sum(p.teeth),
            [cut(2)],
            right=radii[1],
            why=f"The operating pitch radius, as for the pinion. {fixed.format('76.2 mm')}",
        ),
    )


def _with_full_distance(p: Inputs) -> Inputs:
    return changed("", worn_centre_distance=p.centre_distance - _change(p)).change(p)
