"""All candidates as columns over the cells: the pose first, then every effect at every shape it offers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.design.twist import has_screw
from gearwear.diagnose.effects.base import Context, Effect, Kind, Shape
from gearwear.placing.cells import CellGrid, Cells


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect at one shape, and where its columns stand."""

    effect: Effect
    shape: Shape
    columns: Ints

    @property
    def name(self) -> str:
        return self.effect.name


@dataclass(frozen=True, slots=True)
class Dictionary:
    """Columns of the pose and of all candidates.

    Parameters
    ----------
    first : (m, p) float
        Columns as they were built: deviation in mm per unit amplitude, per cell; 0 on cells nobody saw.
    pose : (k,) int
        Columns of the small motion.
    motion : (k,) int
        Which of (tx, ty, tz, wx, wy, wz) they are.
    candidates : tuple of Candidate
    more : tuple of (m, q) float
        Columns that came later; they stand behind the others, and nothing is copied for them.
    """

    first: Floats
    pose: Ints
    motion: Ints
    candidates: tuple[Candidate, ...]
    more: tuple[Floats, ...] = ()

    @property
    def blocks(self) -> tuple[Floats, ...]:
        """(m, q) each, side by side: all columns, and nothing copied."""
        return self.first, *self.more

    @property
    def columns(self) -> Floats:
        """(m, p) all of them."""
        return np.hstack(self.blocks) if self.more else self.first

    @property
    def count(self) -> int:
        """How many columns there are."""
        return sum(block.shape[1] for block in self.blocks)

    def take(self, which: Ints, rows: Ints | slice = slice(None)) -> Floats:
        """Some columns, of all cells or some, (rows, len(which))."""
        which = np.asarray(which, dtype=np.int64)
        ends = np.cumsum([block.shape[1] for block in self.blocks])
        block_of = np.searchsorted(ends, which, side="right")
        runs = np.split(np.arange(len(which)), np.flatnonzero(np.diff(block_of)) + 1)
        pieces = []
        for run in runs:
            number = int(block_of[run[0]]) if len(run) else 0
            block = self.blocks[number]
            pieces.append(np.take(block, which[run] - (ends[number] - block.shape[1]), axis=1)[rows])
        return pieces[0] if len(pieces) == 1 else np.hstack(pieces)

    def with_columns(self, block: Floats) -> Dictionary:
        """The dictionary with columns behind its own."""
        return replace(self, more=(*self.more, block))

    @property
    def levels(self) -> tuple[Candidate, ...]:
        """What a drawing leaves open: the candidates of kind FORM."""
        return tuple(c for c in self.candidates if c.effect.kind is Kind.FORM)

    def with_candidate(self, effect: Effect, shape: Shape, basis: Floats) -> tuple[Dictionary, Candidate]:
        """The dictionary with one more candidate (a refined shape)."""
        added = Candidate(effect, shape, np.arange(self.count, self.count + basis.shape[1]))
        return replace(self.with_columns(basis), candidates=(*self.candidates, added)), added


def build_dictionary(cells: Cells, effects: tuple[Effect, ...], context: Context) -> Dictionary:
    """Evaluate every effect that applies at every shape it offers, on the cells' mean feet."""
    motion = np.array([0, 1, 5]) if context.planar else np.arange(6)
    if has_screw(context.gear) and not context.surfaces & {END_LOW, END_HIGH}:
        motion = motion[motion != 2]  # the screw along the teeth is not seen: the height stays as registration holds it
    seen = cells.seen
    blocks = [np.where(seen[:, None], cells.motion[:, motion], 0.0)]
    points = cells.points.take(seen)
    candidates, start = [], len(motion)
    for effect in effects:
        if not effect.applies(context):
            continue
        for shape in effect.shapes(context):
            values = cell_basis(effect, points, context, shape, cells.grid)
            basis = np.zeros((len(seen), values.shape[1]))
            basis[seen] = values
            candidates.append(Candidate(effect, shape, np.arange(start, start + values.shape[1])))
            blocks.append(basis)
            start += values.shape[1]
    return Dictionary(np.hstack(blocks), np.arange(len(motion)), motion, tuple(candidates))


def cell_basis(effect: Effect, points: SurfacePoints, context: Context, shape: Shape, grid: CellGrid) -> Floats:
    """An effect's basis averaged over cells whose mean feet are `points`.

    At the mean foot itself, which is exact where the basis is linear across a cell; an effect that waves or bends within a few cells
    is averaged over them along z or along the profile (three Gauss points): a wave of 2.7 mm would else read a fifth too small on
    rows of 1 mm.
    """
    gear = context.gear
    direct = effect.basis(points, context, shape)
    if effect.averaged == "z" and grid.rows > 1:
        reach = 0.5 * grid.row_height * math.sqrt(0.6)
        moved = [replace(points, position=points.position + np.array([0.0, 0.0, step])) for step in (-reach, reach)]
    elif effect.averaged == "roll":
        width = (gear.tip_roll**2 - gear.form_roll**2) / (2.0 * grid.flank * np.maximum(points.roll, 0.1 * gear.tip_roll))
        moved = [replace(points, roll=points.roll + step * math.sqrt(0.6) * width) for step in (-0.5, 0.5)]
    else:
        return direct
    below, above = (effect.basis(shifted, context, shape) for shifted in moved)
    return np.asarray((8.0 * direct + 5.0 * (below + above)) / 18.0, dtype=np.float64)
