"""All candidates as columns over the cells: the pose first, then every effect at every shape it offers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.effects.base import Context, Effect, Shape
from gearwear.measure.cells import Cells


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
    columns : (m, p) float
        Deviation in mm per unit amplitude, per cell; 0 on cells nobody saw.
    pose : (6,) or (3,) int
        Columns of the small motion.
    motion : (k,) int
        Which of (tx, ty, tz, wx, wy, wz) they are.
    candidates : tuple of Candidate
    """

    columns: Floats
    pose: Ints
    motion: Ints
    candidates: tuple[Candidate, ...]

    def with_candidate(self, effect: Effect, shape: Shape, basis: Floats) -> tuple[Dictionary, Candidate]:
        """The dictionary with one more candidate (a refined shape)."""
        start = self.columns.shape[1]
        added = Candidate(effect, shape, np.arange(start, start + basis.shape[1]))
        columns = np.hstack([self.columns, basis])
        return Dictionary(columns, self.pose, self.motion, (*self.candidates, added)), added


def build_dictionary(cells: Cells, effects: tuple[Effect, ...], context: Context) -> Dictionary:
    """Evaluate every effect that applies at every shape it offers, on the cells' mean feet."""
    motion = np.array([0, 1, 5]) if context.planar else np.arange(6)
    seen = cells.seen
    blocks = [np.where(seen[:, None], cells.motion[:, motion], 0.0)]
    points = cells.points.take(seen)
    candidates, start = [], len(motion)
    for effect in effects:
        if not effect.applies(context):
            continue
        for shape in effect.shapes(context):
            basis = np.zeros((len(seen), 0))
            values = effect.basis(points, context, shape)
            basis = np.zeros((len(seen), values.shape[1]))
            basis[seen] = values
            candidates.append(Candidate(effect, shape, np.arange(start, start + values.shape[1])))
            blocks.append(basis)
            start += values.shape[1]
    return Dictionary(np.hstack(blocks), np.arange(len(motion)), motion, tuple(candidates))
