"""The unknowns of a standard gear, and what measured dimensions tell of them: small linear fits, and what each costs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Floats

SHIFT_WIDTH, THINNING_WIDTH, SHORTENING_WIDTH = 0.4, 0.05, 0.1
"""Profile shift, thinning (and wear), and tip shortening of shifted pairs: standard deviations of those in use, in modules."""
COAT_WIDTH = 0.02
"""Coat of a scanned gear (spray, or a scanner's zero), standard deviation in mm."""
THICKENED = 6.0
"""Rarity of a tooth that is thicker than its rack makes it (negative thinning)."""
SHIFT, THINNING, SHORTENING, COAT, SCALE = range(5)
"""The unknowns by their places."""
ROUND_SHIFTS = 8
"""How many tenths of a module the profile shift of a gear may well be."""
ROUND_GAIN = 4.0
"""Cost above that of any shift up to which a scan's shift is taken for a round one: two standard deviations."""

Row = tuple[float, tuple[float, ...], float]
"""Of one dimension: measured − proposed with all unknowns 0, mm; its slope with each unknown; its standard deviation, mm."""
Fitted = tuple[tuple[float, float, float, float, float], tuple[float, ...], float]
"""The five unknowns, residuals in mm, and cost."""


class Solved(NamedTuple):
    """The five unknowns; measured − proposed without them and its slope with them; what is left, with their own squares; log of their room."""

    value: Floats
    offset: Floats
    slope: Floats
    square: float
    room: float


def solved(rows: Sequence[Row], module: float, free: tuple[int, ...], scale_doubt: float, shift: float = 0.0) -> Solved:
    """The five unknowns with some of them free, the others 0, and the shift as given if it is not free."""
    offset, std = np.array([row[0] for row in rows]), np.array([row[2] for row in rows])
    slope = np.array([row[1] for row in rows]).reshape(len(rows), 5)
    offset = offset - shift * slope[:, SHIFT]
    width = np.array([SHIFT_WIDTH, THINNING_WIDTH * module, SHORTENING_WIDTH, COAT_WIDTH, scale_doubt])
    value = np.zeros(5)
    square = room = 0.0
    if free:
        picked = list(free)
        columns = slope[:, picked] / std[:, None]
        information = columns.T @ columns + np.diag(width[picked] ** -2.0)
        value[picked] = np.linalg.solve(information, columns.T @ (offset / std))
        room = float(np.log(np.linalg.det(information * np.outer(width[picked], width[picked]))))
        square = float(((value[picked] / width[picked]) ** 2).sum())
    square += float((((offset - slope @ value) / std) ** 2).sum())
    return Solved(value, offset, slope, square, room)


def fit(rows: Sequence[Row], module: float, free: tuple[int, ...], scale_doubt: float, shift: float = 0.0) -> Fitted | None:
    """The five unknowns as drawn, residuals (mm) and cost of one choice of those that are free; None: impossible."""
    value, offset, slope, square, room = solved(rows, module, free, scale_doubt, shift)
    cost = square + room
    if value[THINNING] < 0.0:
        cost += THICKENED
    if value[SHORTENING] < 0.0 or value[COAT] < 0.0:  # no tip is lengthened, no coat takes away
        return None
    # As a drawing would have it: 0.001 modules, 1 µm; the scale to 10 ppm. What that leaves is in the residuals.
    value = np.array([round(v, digits) for v, digits in zip(value.tolist(), (3, 3, 3, 3, 5), strict=True)])
    residual = offset - slope @ value
    free_shift, thinning, shortening, coat, scale = value.tolist()
    return (shift + free_shift, thinning, shortening, coat, scale), tuple(residual.tolist()), cost


def shift_std(rows: Sequence[Row], module: float) -> float:
    """Standard deviation of the profile shift beside thinning and shortening of the usual size, in modules."""
    columns = np.array([np.array(row[1][:3]) / row[2] for row in rows]).reshape(-1, 3)  # of no dimension too
    prior = np.diag(np.array([SHIFT_WIDTH, THINNING_WIDTH * module, SHORTENING_WIDTH]) ** -2.0)
    return math.sqrt(float(np.linalg.inv(columns.T @ columns + prior)[SHIFT, SHIFT]))


def with_round_shift(rows: Sequence[Row], module: float, free: tuple[int, ...], scale_doubt: float, fitted: Fitted) -> Fitted:
    """The fit, or the one with the profile shift to a tenth of a module, as most drawings have it, or to a quarter, where that is as likely."""
    best, least = fitted, fitted[2] + ROUND_GAIN
    rest = tuple(unknown for unknown in free if unknown != SHIFT)
    for parts, towards in itertools.product((10, 4), (math.floor, math.ceil)):
        shift = towards(parts * fitted[0][SHIFT]) / parts
        held = fit(rows, module, rest, scale_doubt, shift)
        if held is not None:
            cost = held[2] + 2.0 * math.log(ROUND_SHIFTS * (1 if parts == 10 else 2)) + (shift / SHIFT_WIDTH) ** 2
            if cost < least:
                best, least = (*held[:2], min(cost, fitted[2])), cost
    return best


def round_price(shift: float) -> float:
    """What a profile shift costs that is held to a tenth of a module or to a quarter; 0 without one, and of one that is not."""
    for parts, many in ((10, ROUND_SHIFTS), (4, 2 * ROUND_SHIFTS)):
        if shift != 0.0 and shift == round(parts * shift) / parts:
            return 2.0 * math.log(many) + (shift / SHIFT_WIDTH) ** 2
    return 0.0
