"""Dictionaries, effects and cells made by hand: nothing of the catalogue's own columns is in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.contributions import side_points
from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.columns import CellColumns
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate, Dictionary
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.parameter import Parameter
from gearwear.diagnose.search import Problem
from gearwear.placing.cells import CellGrid, Cells, _labels

TEETH, WIDTH = 12, 15.0


@dataclass(frozen=True)
class Toy:
    """An effect that is a name and its bounds."""

    name: str
    low: float = -math.inf
    high: float = math.inf
    tooth_specific: bool = False
    kind: Kind = Kind.MANUFACTURE
    limit: float | None = None
    parameters: tuple[Parameter, ...] = ()

    def tolerance(self, context):
        return self.limit

    def allowed(self, amplitudes, shape, context):
        return bool(np.all((amplitudes >= self.low) & (amplitudes <= self.high)))

    def bracket(self, shape, context):
        return []


def dictionary(pose: Floats, blocks: list[tuple[Toy, Floats]]) -> Dictionary:
    """Candidates in order, each with its own columns; two of one toy are two shapes of it."""
    candidates, start = [], pose.shape[1]
    for number, (toy, columns) in enumerate(blocks):
        shape = (float(number),) if sum(other is toy for other, _ in blocks) > 1 else ()
        candidates.append(Candidate(toy, shape, np.arange(start, start + columns.shape[1])))
        start += columns.shape[1]
    every = np.hstack([pose, *(columns for _, columns in blocks)])
    return Dictionary(
        CellColumns.of(every, np.arange(0, len(every), 100)),
        np.arange(pose.shape[1]),
        np.arange(pose.shape[1]),
        tuple(candidates),
    )


def problem(pose: Floats, blocks: list[tuple[Toy, Floats]], target: Floats, unit: float = 1.0) -> Problem:
    """All rows of weight 1."""
    book = dictionary(pose, blocks)
    return Problem(book, Gram.of(book.columns, target, np.ones(len(target)), np.zeros(len(target), int), 1), unit, None)


def left(columns: Floats, target: Floats) -> float:
    """Sum of squares that a dense least-squares fit leaves."""
    if columns.shape[1] == 0:
        return float(target @ target)
    return float(np.sum((target - columns @ np.linalg.lstsq(columns, target, rcond=None)[0]) ** 2))


@cache
def grid(size: float = 1.6) -> CellGrid:
    gear = Gear.from_spec(GearSpec("pinion", TEETH, 6.35, WIDTH, math.radians(20.0)))
    return CellGrid.for_scan(gear, 0, size)


@dataclass(frozen=True)
class Sides:
    """Where the cells of the tooth sides are, (teeth, 2, rows, columns) each."""

    tooth: Floats
    left: Bools
    z: Floats
    across: Floats
    """0 at the root, 1 at the tip."""


def sides_of(one: CellGrid) -> Sides:
    shape = (TEETH, 2, one.rows, one.fillet + one.flank)
    tooth, half, row, column = np.indices(shape)
    return Sides(tooth, half == 0, (row + 0.5) / one.rows, (column + 0.5) / shape[-1])


def cells_of(one: CellGrid, deviation: Floats, count: float = 20.0, scatter: float = 0.005) -> Cells:
    """Cells of the tooth sides with deviations (teeth, 2, rows, columns); all other surfaces unseen."""
    at, shape = side_points(one), deviation.shape
    surface, tooth, side = _labels(one)
    seen = one.on_cells(np.ones(shape, dtype=bool))

    def spread(values: Floats) -> Floats:
        return np.where(seen, one.on_cells(np.asarray(values, dtype=np.float64).reshape(shape)), np.nan)

    position, normal = (np.column_stack([spread(part[:, i]) for i in range(3)]) for part in (at.position, at.normal))
    points = SurfacePoints(surface, tooth, side, spread(at.roll), position, normal, spread(deviation))
    return Cells(one, np.where(seen, count, 0.0), points, np.cross(position, normal), np.where(seen, scatter, np.nan))


def fit_of(
    one: CellGrid, deviation: Floats, blocks: list[tuple[Toy, Floats]], noise: float, count: float = 20.0, turns: bool = False
) -> Fit:
    """A fit of sheets (teeth, 2, rows, columns, p) to sheets of deviations; the pose is a constant and, where it `turns`, a rotation."""
    cells = cells_of(one, deviation, count, noise)
    use = cells.seen

    def flat(columns: Floats) -> Floats:
        return np.column_stack([one.on_cells(columns[..., i]) for i in range(columns.shape[-1])])

    pose = use[:, None].astype(float)
    if turns:
        pose = np.hstack([pose, pose * cells.points.side[:, None]])
    book = dictionary(pose, [(toy, flat(columns)) for toy, columns in blocks])
    covariance = CellCovariance(one, np.where(use, noise**2 / count, 1.0), 0.0, 0.0, 0.0)
    return Fit(cells, np.where(use, np.nan_to_num(cells.points.deviation), 0.0), book, use, covariance)
