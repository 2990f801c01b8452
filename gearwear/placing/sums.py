"""Sums over the cells of a grid, chunk by chunk: what means, scatter and extremes of any number of points follow from."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from gearwear import compiled
from gearwear.arrays import Floats, Ints
from gearwear.design.surface import SurfacePoints


@dataclass(frozen=True, slots=True, kw_only=True)
class CellSums:
    """Sums over the points of each of m cells.

    Parameters
    ----------
    count : (m,) float
        Points.
    position, normal, lever : (m, 3) float
        Of the feet (mm), the normals, and position × normal.
    roll, deviation : (m,) float
        mm.
    squares : (m,) float
        Of what the deviations differ from their cell's mean, mm².
    highest : (m,) float
        Greatest deviation, mm; −inf in an empty cell.
    """

    count: Floats
    position: Floats
    normal: Floats
    lever: Floats
    roll: Floats
    deviation: Floats
    squares: Floats
    highest: Floats

    @classmethod
    def empty(cls, size: int) -> CellSums:
        """Of no points in `size` cells."""
        wide = {name: np.zeros((size, 3)) for name in ("position", "normal", "lever")}
        return cls(
            **wide, **{name: np.zeros(size) for name in ("count", "roll", "deviation", "squares")}, highest=np.full(size, -np.inf)
        )

    @classmethod
    def of(cls, points: SurfacePoints, cell: Ints, size: int) -> CellSums:
        """Of points.

        Parameters
        ----------
        points : SurfacePoints
            n of them.
        cell : (n,) int
            Of each; −1: none.
        size : int
            Number of cells.
        """
        if compiled.pays(len(points)):
            sums = cls.empty(size)
            sums.add(points, cell)
            return sums
        used = np.flatnonzero(cell >= 0)
        cells, part = cell[used], points.take(used)

        def total(values: Floats) -> Floats:
            return np.asarray(np.bincount(cells, values, minlength=size), dtype=np.float64)

        p, n = part.position, part.normal
        count = np.bincount(cells, minlength=size).astype(np.float64)
        deviation = total(part.deviation)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = deviation * (1.0 / count)
        highest = np.full(size, -np.inf)
        np.maximum.at(highest, cells, part.deviation)
        return cls(
            count=count,
            position=np.column_stack([total(p[:, i]) for i in range(3)]),
            normal=np.column_stack([total(n[:, i]) for i in range(3)]),
            lever=np.column_stack([
                total(p[:, 1] * n[:, 2] - p[:, 2] * n[:, 1]),
                total(p[:, 2] * n[:, 0] - p[:, 0] * n[:, 2]),
                total(p[:, 0] * n[:, 1] - p[:, 1] * n[:, 0]),
            ]),
            roll=total(part.roll),
            deviation=deviation,
            squares=total((part.deviation - mean[cells]) ** 2),
            highest=highest,
        )  # fmt: skip

    def add(self, points: SurfacePoints, cell: Ints) -> None:
        """Add a chunk of points to these sums, in place; parameters as `of`.

        Only the cells that the chunk touches are worked on: a gear may have millions, a chunk comes from one place.

        Notes
        -----
        Squares about the common mean (Chan, Golub and LeVeque 1983): ``S = S₁ + S₂ + (n₁ n₂ / (n₁ + n₂)) (d̄₁ − d̄₂)²``; no sum of large
        squares whose difference would be rounded away.
        """
        if compiled.pays(len(points)):
            self._add_compiled(points, cell)
            return
        inside = np.zeros(len(self.count), dtype=bool)
        inside[cell[cell >= 0]] = True
        touched = np.flatnonzero(inside)
        number = np.zeros(len(self.count), dtype=np.int64)
        number[touched] = np.arange(len(touched))
        part = CellSums.of(points, np.where(cell >= 0, number[cell], -1), len(touched))
        before = self.count[touched]
        apart = self.deviation[touched] / np.maximum(before, 1.0) - part.deviation / part.count
        self.squares[touched] += part.squares + before * part.count / (before + part.count) * apart**2
        for name in ("count", "position", "normal", "lever", "roll", "deviation"):
            getattr(self, name)[touched] += getattr(part, name)
        self.highest[touched] = np.maximum(self.highest[touched], part.highest)

    def _add_compiled(self, points: SurfacePoints, cell: Ints) -> None:
        from gearwear.placing.compiled_index import columns_of
        from gearwear.placing.kernel import add

        add(
            np.ascontiguousarray(cell, np.int64), *columns_of(points)[3:],
            self.count, self.position, self.normal, self.lever, self.roll, self.deviation, self.squares, self.highest,
        )  # fmt: skip

    def gathered(self, into: Ints, size: int) -> CellSums:
        """The same points in other cells.

        Parameters
        ----------
        into : (m,) int
            Which of the other cells each of these goes to; −1: none.
        size : int
            Number of the other cells.
        """
        used = np.flatnonzero((into >= 0) & (self.count > 0.0))
        at = into[used]

        def total(values: Floats) -> Floats:
            if values.ndim > 1:
                return np.column_stack([total(column) for column in values.T])
            return np.asarray(np.bincount(at, values[used], minlength=size), dtype=np.float64)

        whole = {f.name: total(getattr(self, f.name)) for f in fields(self) if f.name != "highest"}
        mean = whole["deviation"] / np.maximum(whole["count"], 1.0)
        off = self.deviation[used] / self.count[used] - mean[at]
        whole["squares"] += np.bincount(at, self.count[used] * off**2, minlength=size)
        highest = np.full(size, -np.inf)
        np.maximum.at(highest, at, self.highest[used])
        return CellSums(**whole, highest=highest)
