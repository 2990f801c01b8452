"""The paper's thickness loss: the chord between two points A and B of a tooth, read off to 0.1 mm."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from gearwear.arrays import Floats
from gearwear.paper.explain import Uncertainty
from gearwear.paper.inputs import Inputs

ROUNDING = 0.05
"""mm; the coordinates are printed to 0.1 mm."""
CONFIDENCE = 0.95
"""Of the intervals."""


@dataclass(frozen=True, slots=True)
class PointPair:
    """Points A and B about the pinion's axis, the flank before and after wear in one order or the other; mm and rad.

    Parameters
    ----------
    radius_a, radius_b : float
    turn : float
        Polar angle from A to B.
    chord : float
        Their distance, the paper's B′.
    involute_turn : float
        How much further the design's involute turns between the two radii: inv α at B less inv α at A.
    """

    radius_a: float
    radius_b: float
    turn: float
    chord: float
    involute_turn: float

    @property
    def mean_radius(self) -> float:
        return 0.5 * (self.radius_a + self.radius_b)

    def loss_angle(self, hand: int) -> float:
        """Turn between two involutes of one hand through A and B; rad.

        Parameters
        ----------
        hand : int
            +1: the worn flank is the counter-clockwise flank of its tooth; −1: the clockwise one.

        Notes
        -----
        B lies counter-clockwise of A. Metal can only go, so a clockwise flank was in A before and is in B after wear, a
        counter-clockwise flank the other way round.

        The offset of an involute is the same involute turned by offset / r_b, so this angle is the same at every radius:
        times r it is the arc lost there, times r_b the depth along the normal.
        """
        return self.turn + hand * self.involute_turn


def point_pair(inputs: Inputs) -> PointPair:
    """Polar coordinates of the two points and what the involute does between them."""
    (xa, ya), (xb, yb) = inputs.point_a, inputs.point_b
    ra, rb = math.hypot(xa, ya), math.hypot(xb, yb)
    base = inputs.base_radii[0]
    roll_a, roll_b = (math.sqrt(r * r - base * base) / base for r in (ra, rb))
    return PointPair(
        radius_a=ra,
        radius_b=rb,
        turn=math.atan2(yb, xb) - math.atan2(ya, xa),
        chord=math.hypot(xb - xa, yb - ya),
        involute_turn=(roll_b - math.atan(roll_b)) - (roll_a - math.atan(roll_a)),
    )


def rounding_uncertainty(inputs: Inputs, value: Callable[[Inputs], float]) -> Uncertainty:
    """Spread of a number made of A and B when each of their four coordinates is known to ±0.05 mm, evenly.

    Parameters
    ----------
    inputs : Inputs
        Where the points are.
    value : callable
        The number, from inputs.

    Notes
    -----
    To first order the error is a sum of four even distributions whose widths are 0.05 mm times the derivatives; its law is exact
    (`sum_of_uniforms`). To second order the middle moves by half the sum of second derivatives times 0.05²/3.
    """
    coordinates = np.array([*inputs.point_a, *inputs.point_b])

    def at(moved: Floats) -> float:
        xa, ya, xb, yb = moved.tolist()
        return value(replace(inputs, point_a=(xa, ya), point_b=(xb, yb)))

    step = 1e-3
    middle = at(coordinates)
    ends = [(at(coordinates - e), at(coordinates + e)) for e in step * np.eye(4)]
    widths = [ROUNDING * abs(after - before) / (2.0 * step) for before, after in ends]
    shift = sum(before - 2.0 * middle + after for before, after in ends) / step**2 * ROUNDING**2 / 6.0
    low, high = 0.0, sum(widths)
    while high - low > 1e-12:
        half = 0.5 * (low + high)
        low, high = (half, high) if sum_of_uniforms(half, widths) < 0.5 + 0.5 * CONFIDENCE else (low, half)
    std = math.sqrt(sum(w * w for w in widths) / 3.0)
    return Uncertainty(std, middle + shift - high, middle + shift + high, CONFIDENCE)


def sum_of_uniforms(value: float, half_widths: list[float]) -> float:
    """Probability that independent errors, each even within ± its half width, add up to `value` or less.

    ``F(t) = Σ_σ (Π σ_i) (t + Σ σ_i a_i)₊ⁿ / (n! Π 2 a_i)`` over all signs σ (Irwin-Hall with unequal widths).

    >>> sum_of_uniforms(0.25, [0.5])
    0.75
    """
    total = sum(
        math.prod(signs) * max(value + sum(s * a for s, a in zip(signs, half_widths, strict=True)), 0.0) ** len(half_widths)
        for signs in product((1, -1), repeat=len(half_widths))
    )
    return total / (math.factorial(len(half_widths)) * math.prod(2.0 * a for a in half_widths))
