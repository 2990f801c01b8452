"""All candidates as columns over the cells: the pose first, then every effect at every shape it offers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.design.twist import has_screw
from gearwear.diagnose.columns import CellColumns, between, cuts_of
from gearwear.diagnose.effects.base import Context, Effect, Kind, Shape
from gearwear.diagnose.effects.root_form import ROOT_FORM
from gearwear.placing.cells import CellGrid, Cells


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect at one shape, and where its columns stand; the first of them tells candidates of a dictionary apart."""

    effect: Effect
    shape: Shape
    columns: Ints
    first: int = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "first", int(self.columns[0]) if len(self.columns) else -1)

    @property
    def name(self) -> str:
        return self.effect.name


@dataclass(frozen=True, slots=True)
class Dictionary:
    """Columns of the pose and of all candidates.

    Parameters
    ----------
    first : CellColumns
        As they were built, (m, p): deviation in mm per unit amplitude, per cell; 0 on cells nobody saw.
    pose : (k,) int
        Columns of the small motion.
    motion : (k,) int
        Which of (tx, ty, tz, wx, wy, wz) they are.
    candidates : tuple of Candidate
    more : tuple of CellColumns
        Columns that came later, (m, q); they stand behind the others, and nothing is copied for them.
    """

    first: CellColumns
    pose: Ints
    motion: Ints
    candidates: tuple[Candidate, ...]
    more: tuple[CellColumns, ...] = ()

    @property
    def blocks(self) -> tuple[CellColumns, ...]:
        """(m, q) each, side by side: all columns, and nothing copied."""
        return self.first, *self.more

    @property
    def columns(self) -> Floats:
        """(m, p) all of them."""
        return self.take(np.arange(self.count))

    @property
    def count(self) -> int:
        """How many columns there are."""
        return sum(block.count for block in self.blocks)

    def take(self, which: Ints, rows: Ints | slice = slice(None)) -> Floats:
        """Some columns, of all cells or some, (rows, len(which))."""
        place = np.full(self.count, -1)
        place[np.asarray(which, dtype=np.int64)] = np.arange(len(which))
        result, start = np.zeros((self.first.rows, len(which))), 0
        for block in self.blocks:
            block.put(place[start : start + block.count], result)
            start += block.count
        return result[rows]

    def seen(self, cells: Bools) -> Bools:
        """(p,) which columns are not zero on all of some cells (m,)."""
        return np.concatenate([block.seen(cells) for block in self.blocks])

    def with_columns(self, block: Floats | CellColumns) -> Dictionary:
        """The dictionary with columns (m, q) behind its own."""
        columns = block if isinstance(block, CellColumns) else CellColumns.of(block, self.first.cuts)
        return replace(self, more=(*self.more, columns))

    @property
    def levels(self) -> tuple[Candidate, ...]:
        """What a drawing leaves open: the candidates of kind FORM."""
        return tuple(c for c in self.candidates if c.effect.kind is Kind.FORM)

    @property
    def offsets(self) -> tuple[Candidate, ...]:
        """Levels of whole surfaces: how far tips, ends and bore lie off the drawn ones, or flanks of each side. A fit without them takes a whole surface for torn."""
        return tuple(c for c in self.levels if c.name != ROOT_FORM)

    def with_candidate(self, effect: Effect, shape: Shape, basis: Floats) -> tuple[Dictionary, Candidate]:
        """The dictionary with one more candidate (a refined shape)."""
        added = Candidate(effect, shape, np.arange(self.count, self.count + basis.shape[1]))
        return replace(self.with_columns(basis), candidates=(*self.candidates, added)), added


def build_dictionary(cells: Cells, effects: tuple[Effect, ...], context: Context) -> Dictionary:
    """Evaluate every effect that applies at every shape it offers, on the cells' mean feet."""
    motion = np.array([0, 1, 5]) if context.planar else np.arange(6)
    if has_screw(context.gear) and not context.surfaces & {END_LOW, END_HIGH}:
        motion = motion[motion != 2]  # the screw along the teeth is not seen: the height stays as registration holds it
    seen, cuts = cells.seen, cuts_of(cells.grid)
    whole = seen, cells.points.take(seen)
    pieces = [(seen[rows], cells.points.take(rows.start + np.flatnonzero(seen[rows]))) for rows in between(cuts, len(seen))]
    candidates = list[Candidate]()

    def blocks() -> Iterator[Floats | CellColumns]:
        yield np.where(seen[:, None], cells.motion[:, motion], 0.0)
        start = len(motion)
        for effect in effects:
            if not effect.applies(context):
                continue
            for shape in effect.shapes(context):
                # Each column of a freedom for every tooth is zero on nearly all cells: in full they are held on a stretch at a time.
                block: Floats | CellColumns = (
                    CellColumns.of_pieces(columns_on(*piece, effect, shape, context, cells.grid) for piece in pieces)
                    if effect.tooth_specific
                    else columns_on(*whole, effect, shape, context, cells.grid)
                )
                count = block.count if isinstance(block, CellColumns) else block.shape[1]
                candidates.append(Candidate(effect, shape, np.arange(start, start + count)))
                start += count
                yield block

    columns = CellColumns.gathered(blocks(), cuts)
    return Dictionary(columns, np.arange(len(motion)), motion, tuple(candidates))


def with_worn(dictionary: Dictionary, cells: Cells, context: Context) -> Dictionary:
    """The dictionary of the same scan with other sides worn: few effects have other columns then (`Effect.by_worn`), and these stand behind all others."""
    seen, points = cells.seen, cells.points.take(cells.seen)
    for place, candidate in enumerate(dictionary.candidates):
        if candidate.effect.by_worn:
            basis = columns_on(seen, points, candidate.effect, candidate.shape, context, cells.grid)
            columns = np.arange(dictionary.count, dictionary.count + basis.shape[1])
            candidates = list(dictionary.candidates)
            candidates[place] = replace(candidate, columns=columns)
            dictionary = replace(dictionary.with_columns(basis), candidates=tuple(candidates))
    return dictionary


def columns_on(seen: Bools, points: SurfacePoints, effect: Effect, shape: Shape, context: Context, grid: CellGrid) -> Floats:
    """(m, p) an effect's columns on cells, of which those `seen` (m,) have the mean feet `points`, by `cell_basis`; 0 on the others."""
    values = cell_basis(effect, points, context, shape, grid)
    columns = np.zeros((len(seen), values.shape[1]))
    columns[seen] = values
    return columns


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
