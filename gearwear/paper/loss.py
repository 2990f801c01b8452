"""The loss of thickness, from points A and B."""

from __future__ import annotations

import math
from collections.abc import Callable

from gearwear.design.gear import Gear
from gearwear.paper.explain import Cause, Row, changed, cut, explain
from gearwear.paper.inputs import PAPER, Inputs, gears
from gearwear.paper.points import PointPair, point_pair, rounding_uncertainty


def thickness_loss() -> tuple[Row, ...]:
    pair, base = point_pair(PAPER), PAPER.base_radii[0]
    pinion, _ = gears()
    r = pinion.reference_radius
    ahead, behind = (pair.loss_angle(hand) for hand in (1, -1))
    spread = rounding_uncertainty(PAPER, lambda p: point_pair(p).chord)
    apart = f"{pair.radius_b - pair.radius_a:.2f} mm"
    off = (
        f"A and B lie {pair.radius_a - r:.2f} and {pair.radius_b - r:.2f} mm outside the pitch circle, near mid-addendum, "
        f"and {apart} apart in radius: what is between them is no pitch-circle thickness."
    )
    chord = explain(
        "thickness loss B′, the chord from A to B",
        "mm",
        "1.992",
        _chord,
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
    )
    return (
        _radius("A", lambda p: point_pair(p).radius_a, r, off),
        _radius(
            "B", lambda p: point_pair(p).radius_b, r,
            f"B lies {pair.radius_b - r:.2f} mm outside the pitch circle, {apart} farther out than A.",
        ),
        chord,
        *_by_flank(pair, pinion),
    )  # fmt: skip


def _chord(inputs: Inputs) -> float:
    """The paper's B′."""
    return point_pair(inputs).chord


def _radius(point: str, of: Callable[[Inputs], float], pitch_radius: float, why: str) -> Row:
    """The radius of a point, which the paper takes for that of the pitch circle."""
    nearest = Cause("coordinates 0.05 mm nearer, all their rounding allows", change=_nearest_to_the_axis)
    item = f"radius of point {point}, taken for the pitch circle's"
    return explain(item, "mm", "38.1", of, alternatives=[nearest], right=pitch_radius, why=why)


def _by_flank(pair: PointPair, pinion: Gear) -> tuple[Row, Row]:
    """What the chord says of the thickness, were a clockwise flank worn or a counter-clockwise one."""
    r, base = pinion.reference_radius, PAPER.base_radii[0]
    nominal = [float(pinion.thickness(radius)) for radius in (pair.radius_a, pair.radius_b)]
    ahead = pair.loss_angle(1)
    land_angle = 2.0 * pinion.tip_half_angle - ahead

    def row(hand: int, flank: str, rest: str) -> Row:
        angle = pair.loss_angle(hand)
        spread = rounding_uncertainty(PAPER, lambda p: r * point_pair(p).loss_angle(hand))
        return explain(
            f"thickness loss B′, {flank} flank worn",
            "mm",
            "1.992",
            _chord,
            [cut(3)],
            right=angle * r,
            why=f"Between the two radii the involute itself turns by {math.degrees(pair.involute_turn):.4f}°; with that allowed for, what "
            f"is left is the turn of the flank, the same at every radius: here {math.degrees(angle):.3f}°, as arc at the pitch circle "
            f"(95 %: {spread.low:.2f} to {spread.high:.2f} mm, from the rounding{rest}",
            uncertainty=spread,
            cases={"along the normal; so much does the normal backlash grow, once and not twice": angle * base},
        )

    return (
        row(
            -1, "clockwise",
            " of the coordinates). B lies counter-clockwise of A and metal can only go, so this is the reading in which A was taken before wear and B after. "
            f"The chord is {100 * PAPER.thickness_loss / (0.5 * sum(nominal)):.0f} % of the thickness at A and B ({nominal[0]:.2f} and {nominal[1]:.2f} mm).",
        ),
        row(
            1, "counter-clockwise",
            f"), {100 * ahead * r / pinion.tooth_thickness:.0f} % of the tooth. It needs B before wear and A after. It is more than half the tip "
            f"({math.degrees(pinion.tip_half_angle):.2f}°): the worn flank would pass the tooth's centre line there and leave a land of "
            f"{land_angle * pinion.tip_radius:.2f} mm.",
        ),
    )  # fmt: skip


def _nearest_to_the_axis(inputs: Inputs) -> Inputs:
    """Both points 0.05 mm nearer in both coordinates: as close to the pitch circle as their rounding lets them be."""
    near_a, near_b = ((x + 0.05, y + 0.05) for x, y in (inputs.point_a, inputs.point_b))  # all four are negative
    return changed("", point_a=near_a, point_b=near_b).change(inputs)
