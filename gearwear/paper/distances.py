"""From the loss to backlash, centre distance, pressure angle and pitch radii."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design import Baseline
from gearwear.meshing.backlash import backlash, centre_distance_for_backlash, operating_pitch_radii, working_pressure_angle
from gearwear.meshing.published import backlash_from_loss, centre_distance_change
from gearwear.meshing.recommended import MM_PER_INCH, recommended_backlash
from gearwear.meshing.shafts import ShaftMovement, shaft_movement
from gearwear.paper.explain import Cause, Row, changed, cut, explain, rounded
from gearwear.paper.inputs import PAPER, Inputs, gears


def _change(p: Inputs) -> float:
    pitch = math.pi * p.module
    return centre_distance_change(pitch, *p.thicknesses, p.backlash, p.pressure_angle)


HOUSING = "shafts in a housing, which do not move"
TO_ALLOWANCE = "shafts closed until the worn teeth have the allowance, were there room"
TO_NOTHING = "the same, until they have no backlash"
"""Where shafts may stand after wear, in the words of the page."""


@dataclass(frozen=True, slots=True)
class ExactDistances:
    """What exact meshing gives in place of the paper's first order, mm.

    Parameters
    ----------
    on_operating, on_reference : float
        Centre distance at which unworn gears have the paper's backlash, measured on the operating circles or the reference circles.
    total : float
        Backlash with the allowance, as for a loss from a scan before wear.
    at_total : float
        Centre distance at which unworn gears have that, on the reference circles.
    taken_up, to_nothing : ShaftMovement
        Shafts closed until worn teeth have the allowance, or no backlash.
    """

    on_operating: float
    on_reference: float
    total: float
    at_total: float
    taken_up: ShaftMovement
    to_nothing: ShaftMovement

    @property
    def by_formula(self) -> float:
        """Centre distance down to the allowance, to first order."""
        return PAPER.centre_distance + self.taken_up.movement_linear

    @property
    def ends(self) -> tuple[float, float]:
        """Centre distance down to the allowance and down to no backlash; NaN where it cannot be."""
        return self.taken_up.centre_distance or math.nan, self.to_nothing.centre_distance or math.nan


def distances() -> tuple[Row, ...]:
    """Backlash, how centre distance would change with it, and what goes with that distance."""
    exact = _exact()
    return (*_backlash(exact), *_change_of_distance(exact), *_distance_after_wear(exact), *_at_that_distance(exact))


def _exact() -> ExactDistances:
    pinion, gear = gears()
    total = backlash_from_loss(PAPER.thickness_loss, PAPER.allowance, Baseline.PRE_WEAR_SCAN)
    return ExactDistances(
        on_operating=centre_distance_for_backlash(pinion, gear, PAPER.backlash, "operating"),
        on_reference=centre_distance_for_backlash(pinion, gear, PAPER.backlash, "reference"),
        total=total,
        at_total=centre_distance_for_backlash(pinion, gear, total, "reference"),
        taken_up=shaft_movement(pinion, gear, PAPER.centre_distance, PAPER.thickness_loss, PAPER.allowance),
        to_nothing=shaft_movement(pinion, gear, PAPER.centre_distance, PAPER.thickness_loss),
    )


def _backlash(exact: ExactDistances) -> tuple[Row, ...]:
    advised = recommended_backlash(gears()[0], PAPER.centre_distance)
    least, classical = advised.least_normal, advised.assembly or (math.nan, math.nan)
    return (
        explain(
            "recommended backlash",
            "mm",
            "0.2286",
            lambda p: 0.009 * MM_PER_INCH,
            right=0.009 * MM_PER_INCH,
            why="0.009 in, exactly; a recommendation, which no calculation gives. It is the middle of the classical range for a "
            "diametral pitch of 4 [not read again], and hardly above the least that ISO/TR 10064-2 asks for.",
            cases={
                "classical range for assembly, from 0.007 in": classical[0],
                "classical range for assembly, to 0.011 in": classical[1],
                "least by ISO/TR 10064-2, on the normal": least,
                "least by ISO/TR 10064-2, as arc": least / math.cos(PAPER.pressure_angle),
            },
        ),
        explain(
            "backlash B",
            "mm",
            "1.7634",
            lambda p: backlash_from_loss(p.thickness_loss, p.allowance, Baseline.ZERO_BACKLASH),
            alternatives=[
                Cause(
                    "allowance added, as for a loss from a scan before wear",
                    write=lambda _: backlash_from_loss(PAPER.thickness_loss, PAPER.allowance, Baseline.PRE_WEAR_SCAN),
                )
            ],
            right=exact.total,
            why="B′ compares scans before and after wear, so the design's backlash was there already and comes on top. Subtracting is "
            f"right only for a loss measured from a drawing without backlash (`baseline`). The difference is twice the allowance, "
            f"{2 * PAPER.allowance:.3f} mm.",
            cases={"loss measured from a drawing without backlash": PAPER.thickness_loss - PAPER.allowance},
        ),
    )


def _change_of_distance(exact: ExactDistances) -> tuple[Row, ...]:
    linear_take_up = changed(
        "eq. 7 with the loss in t1, the allowance as wanted backlash",
        thicknesses=(PAPER.thicknesses[0] - PAPER.thickness_loss, PAPER.thicknesses[1]),
        backlash=PAPER.allowance,
    )
    return (
        explain(
            "centre distance change Δc, as the play of unworn gears",
            "mm",
            "-2.422",
            _change,
            [cut(3)],
            right=PAPER.centre_distance - exact.on_operating,
            why="First order: racks in place of teeth. The exact inverse of the same B, measured on the operating circles, is smaller. Both "
            "only say where unworn gears would have this play; nobody wants to take them there.",
            cases={
                "the same, B measured on the reference circles": PAPER.centre_distance - exact.on_reference,
                "all the play, 2.2206 mm, on the reference circles": PAPER.centre_distance - exact.at_total,
                HOUSING: 0.0,
            },
        ),
        explain(
            "centre distance change Δc, if it is to take the wear up",
            "mm",
            "-2.422",
            _change,
            [cut(3)],
            [linear_take_up],
            right=-(exact.taken_up.movement or 0.0),
            why="The shafts would have to close, not part: the paper's t₁ is a half pitch although wear is a loss of t₁, and with the wear put "
            "there eq. 7 itself changes its sign. That cannot be done: tips bottom at "
            f"{exact.taken_up.bottoming_centre_distance:.4f} mm, with {exact.to_nothing.bottoming_loss:.2f} mm of lost thickness taken up (tip corners meet fillets even "
            f"before, at {exact.to_nothing.closest_centre_distance:.2f} mm and {exact.to_nothing.takeable_loss:.2f} mm for a rack tip radius of 0.30 modules); and "
            "only the worn teeth have play, the others would jam at once.",
            cases={
                "first order, down to the allowance": -exact.taken_up.movement_linear,
                "exact, down to no backlash": -(exact.to_nothing.movement or math.nan),
                "as far as tips let it": PAPER.centre_distance - exact.taken_up.bottoming_centre_distance,
                "while any tooth is not worn": 0.0,
            },
        ),
    )


def _distance_after_wear(exact: ExactDistances) -> tuple[Row, ...]:
    at_printed = backlash(*gears(), PAPER.worn_centre_distance)
    return (
        explain(
            "centre distance after wear c′",
            "mm",
            "116.722",
            lambda p: p.centre_distance - _change(p),
            [cut(3)],
            right=exact.on_operating,
            why="The exact inverse of the same B, taken on the operating circles: the first-order one is "
            f"{PAPER.worn_centre_distance - exact.on_operating:.3f} mm too far (on the reference circles {PAPER.worn_centre_distance - exact.on_reference:.3f} mm).",
            cases={
                "B measured on the reference circles": exact.on_reference,
                "all the play, 2.2206 mm, on the reference circles": exact.at_total,
                "eq. 7 with the loss in t₁, down to the allowance": exact.by_formula,
                TO_ALLOWANCE: exact.ends[0],
                TO_NOTHING: exact.ends[1],
                "tips bottom": exact.taken_up.bottoming_centre_distance,
                HOUSING: PAPER.centre_distance,
            },
        ),
        explain(
            "backlash of unworn gears at that c′",
            "mm",
            "1.7634",
            lambda p: 2 * (p.worn_centre_distance - p.centre_distance) * math.tan(p.pressure_angle),
            [Cause("c′ before it was cut off", change=lambda p: _with_full_distance(p))],
            right=at_printed.circumferential,
            why=f"The first-order formula gives {100 * (1 - PAPER.backlash / at_printed.circumferential):.1f} % too little; the error grows with the distance: "
            "0.4 % at 0.1 mm, 10.7 % at 3 mm.",
            cases={"along the normal": at_printed.normal},
        ),
    )


def _at_that_distance(exact: ExactDistances) -> tuple[Row, ...]:
    pinion, gear = gears()
    radii = operating_pitch_radii(pinion, gear, exact.on_operating)

    def angle_at(distance: float) -> float:
        return math.degrees(working_pressure_angle(pinion, gear, distance))

    return (
        explain(
            "pressure angle after wear θ′",
            "°",
            "23.04",
            lambda p: math.degrees(math.acos(sum(p.base_radii) / p.worn_centre_distance)),
            [cut(2)],
            [
                rounded(2),
                Cause(
                    "cos 20° = 0.9397, then cut off after 2 decimals",
                    change=lambda p: changed("", base_radii=(0.9397 * 6 * p.module, 0.9397 * 12 * p.module)).change(p),
                    write=cut(2).write,
                ),
            ],
            right=angle_at(exact.on_operating),
            why="At the exact centre distance. Whether the printed angle was cut off or made with a cosine of four digits does not show in it.",
            cases={
                "B measured on the reference circles": angle_at(exact.on_reference),
                "all the play, 2.2206 mm, on the reference circles": angle_at(exact.at_total),
                "eq. 7 with the loss in t₁, down to the allowance": angle_at(exact.by_formula),
                TO_ALLOWANCE: angle_at(exact.ends[0]),
                TO_NOTHING: angle_at(exact.ends[1]),
                HOUSING: math.degrees(PAPER.pressure_angle),
            },
        ),
        explain(
            "pinion pitch radius after wear",
            "mm",
            "38.90",
            lambda p: p.worn_centre_distance * p.teeth[0] / sum(p.teeth),
            [cut(2)],
            [rounded(2)],
            right=radii[0],
            why="This is the operating pitch radius at c′; the reference circle is no property that wear changes.",
            cases={HOUSING: pinion.reference_radius},
        ),
        explain(
            "gear pitch radius after wear",
            "mm",
            "77.81",
            lambda p: p.worn_centre_distance * p.teeth[1] / sum(p.teeth),
            [cut(2)],
            right=radii[1],
            why="The operating pitch radius, as for the pinion.",
            cases={HOUSING: gear.reference_radius},
        ),
    )


def _with_full_distance(p: Inputs) -> Inputs:
    return changed("", worn_centre_distance=p.centre_distance - _change(p)).change(p)
