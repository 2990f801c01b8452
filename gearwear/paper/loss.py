"""The loss of thickness, from points A and B."""

from __future__ import annotations

import math

from gearwear.paper.explain import Cause, Row, changed, cut, explain
from gearwear.paper.inputs import PAPER, Inputs, gears
from gearwear.paper.points import point_pair, rounding_uncertainty


def thickness_loss() -> tuple[Row, ...]:
    pair, base = point_pair(PAPER), PAPER.base_radii[0]
    pinion, _ = gears()
    r = pinion.reference_radius
    ahead, behind = (pair.loss_angle(hand) for hand in (1, -1))
    spread = rounding_uncertainty(PAPER, lambda p: point_pair(p).chord)
    spread_ahead, spread_behind = (
        rounding_uncertainty(PAPER, lambda p, hand=hand: r * point_pair(p).loss_angle(hand))  # type: ignore[misc]
        for hand in (1, -1)
    )
    nominal = [float(pinion.thickness(radius)) for radius in (pair.radius_a, pair.radius_b)]
    closest = [Cause("coordinates 0.05 mm nearer, all their rounding allows", change=_nearest_to_the_axis)]
    off = (
        f"A and B lie {pair.radius_a - r:.2f} and {pair.radius_b - r:.2f} mm outside the pitch circle, near mid-addendum, "
        f"and {pair.radius_b - pair.radius_a:.2f} mm apart in radius: what is between them is no pitch-circle thickness."
    )
    definition = (
        f"Between the two radii the involute itself turns by {math.degrees(pair.involute_turn):.4f}°; with that allowed for, what "
        "is left is the turn of the flank, the same at every radius"
    )
    land_angle = 2.0 * pinion.tip_half_angle - ahead
    return (
        explain(
            "radius of point A, taken for the pitch circle's",
            "mm",
            "38.1",
            lambda p: point_pair(p).radius_a,
            alternatives=closest,
            right=r,
            why=off,
        ),
        explain(
            "radius of point B, taken for the pitch circle's",
            "mm",
            "38.1",
            lambda p: point_pair(p).radius_b,
            alternatives=closest,
            right=r,
            why=f"B lies {pair.radius_b - r:.2f} mm outside the pitch circle, {pair.radius_b - pair.radius_a:.2f} mm farther out than A.",
        ),
        explain(
            "thickness loss B′, the chord from A to B",
            "mm",
            "1.992",
            lambda p: point_pair(p).chord,
            [cut(3)],
            [
                Cause("only its part along the circle", write=lambda _: 2 * pair.mean_radius * math.sin(pair.turn / 2)),
                Cause("its turn about the axis, as arc on the pitch circle", write=lambda _: pair.turn * r),
                Cause("turn of a counter-clockwise flank, as arc there", write=lambda _: ahead * r),
                Cause("turn of a clockwise flank, as arc there", write=lambda _: behind * r),
            ],
            right=None,
            why=f"No single number: {behind * r:.2f} or {ahead * r:.2f} mm of arc at the pitch circle, by which flank is worn, "
            f"which the paper does not say. {off} Coordinates to 0.1 mm leave the chord {spread.low:.3f} to {spread.high:.3f} mm "
            f"(95 %; standard deviation {spread.std:.3f}).",
            uncertainty=spread,
            cases={
                "arc at the pitch circle, clockwise flank": behind * r,
                "arc at the pitch circle, counter-clockwise flank": ahead * r,
                "along the normal, clockwise flank": behind * base,
                "along the normal, counter-clockwise flank": ahead * base,
            },
        ),
        explain(
            "thickness loss B′, clockwise flank worn",
            "mm",
            "1.992",
            lambda p: point_pair(p).chord,
            [cut(3)],
            right=behind * r,
            why=f"{definition}: here {math.degrees(behind):.3f}°, as arc at the pitch circle (95 %: {spread_behind.low:.2f} to "
            f"{spread_behind.high:.2f} mm, from the rounding of the coordinates). B lies counter-clockwise of A and metal can only go, so this "
            "is the reading in which A was taken before wear and B after. The chord is "
            f"{100 * PAPER.thickness_loss / (0.5 * sum(nominal)):.0f} % of the thickness at A and B ({nominal[0]:.2f} and {nominal[1]:.2f} mm).",
            uncertainty=spread_behind,
            cases={"along the normal; so much does the normal backlash grow, once and not twice": behind * base},
        ),
        explain(
            "thickness loss B′, counter-clockwise flank worn",
            "mm",
            "1.992",
            lambda p: point_pair(p).chord,
            [cut(3)],
            right=ahead * r,
            why=f"{definition}: here {math.degrees(ahead):.3f}°, as arc at the pitch circle (95 %: {spread_ahead.low:.2f} to "
            f"{spread_ahead.high:.2f} mm, from the rounding), {100 * ahead * r / pinion.tooth_thickness:.0f} % of the tooth. It needs B before wear "
            f"and A after. It is more than half the tip ({math.degrees(pinion.tip_half_angle):.2f}°): the worn flank would pass the tooth's centre line "
            f"there and leave a land of {land_angle * pinion.tip_radius:.2f} mm.",
            uncertainty=spread_ahead,
            cases={"along the normal; so much does the normal backlash grow, once and not twice": ahead * base},
        ),
    )


def _nearest_to_the_axis(inputs: Inputs) -> Inputs:
    """Both points 0.05 mm nearer in both coordinates: as close to the pitch circle as their rounding lets them be."""
    near_a, near_b = ((x + 0.05, y + 0.05) for x, y in (inputs.point_a, inputs.point_b))  # all four are negative
    return changed("", point_a=near_a, point_b=near_b).change(inputs)
