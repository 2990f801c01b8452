"""A weighted fit of chosen candidates to the cells, with everything that is asked of it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.columns import CellColumns
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate, Dictionary
from gearwear.diagnose.effects.base import Context, Kind
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.judge import beyond_chance, of_units, sandwich
from gearwear.diagnose.own_waves import beyond_texture, neighbouring_waves, order_of
from gearwear.diagnose.pattern import runs_along_face
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem
from gearwear.diagnose.shapes import shape_columns
from gearwear.diagnose.taken_back import beside_pose
from gearwear.placing.cells import Cells
from gearwear.robust import median_scale, tukey_weight

Model = tuple[Candidate, ...]


@dataclass(frozen=True, slots=True)
class Fit:
    """Cells, candidates and weights.

    Parameters
    ----------
    cells : Cells
        The binned scan.
    target : (m,) float
        Mean deviations, mm; 0 where nothing was seen.
    dictionary : Dictionary
        Columns of the pose and of all candidates.
    use : (m,) bool
        Cells in the fit.
    covariance : CellCovariance
        Of the cell means.
    """

    cells: Cells
    target: Floats
    dictionary: Dictionary
    use: Bools
    covariance: CellCovariance

    @property
    def weight(self) -> Floats:
        """(m,) 1 / mm²; 0 outside the fit."""
        return np.where(self.use, self.covariance.weight, 0.0)

    def problem(self, unit: float, context: Context, always: frozenset[str] = frozenset(), known: Gram | None = None) -> Problem:
        """The search problem over all candidates; `known` are the statistics of this fit with fewer columns."""
        columns = self.dictionary.blocks
        gram = self.statistics(columns) if known is None else known.widened(columns, self.target, self.weight)
        return Problem(self.dictionary, gram, unit, context, always)

    def columns(self, model: Model) -> Floats:
        """Columns of the pose and of the model, (m, p)."""
        which = np.concatenate([self.dictionary.pose, *(c.columns for c in model)]).astype(np.int64)
        return self.dictionary.take(which)

    def statistics(self, columns: Floats | tuple[CellColumns, ...]) -> Gram:
        """Statistics of some columns, all cells together."""
        return Gram.of(columns, self.target, self.weight, np.zeros(len(self.target), np.int64), 1)

    def folded(self, model: Model, fold: Ints) -> Gram:
        """Statistics of the model's own columns, fold by fold."""
        return Gram.of(self.columns(model), self.target, self.weight, fold, int(fold.max()) + 1)

    def residual(self, model: Model) -> Floats:
        """Target minus the refitted model, mm, (m,)."""
        columns = self.columns(model)
        gram = self.statistics(columns)
        return np.asarray(self.target - columns @ gram.solve(np.arange(columns.shape[1]))[0], dtype=np.float64)

    def pose_residual(self) -> Floats:
        """Residual of the pose and the offsets that a drawing leaves open, refitted robustly beside a common offset that stays in it."""
        offsets = self.dictionary.offsets
        columns = np.hstack([self.columns(offsets), np.ones((len(self.target), 1))])
        residual = self.target - np.median(self.target[self.use])
        for surface in columns[:, len(self.dictionary.pose) : -1].T != 0.0:  # one that lies off as a whole is not torn
            if (surface & self.use).any():
                residual[surface] = self.target[surface] - np.median(self.target[surface & self.use])
        amplitudes = np.zeros(columns.shape[1])
        for _ in range(4):
            scale = max(median_scale(residual[self.use])[1], 1e-9)
            weight = self.weight * tukey_weight(residual, scale)
            gram = Gram.of(columns, self.target, weight, np.zeros(len(self.target), np.int64), 1)
            amplitudes, _ = gram.solve(np.arange(columns.shape[1]))
            residual = self.target - columns @ amplitudes
        return np.asarray(residual + amplitudes[-1], dtype=np.float64)

    def errors(self, model: Model, fold: Ints) -> tuple[float, float]:
        """RMS over the points in use on the teeth, in sample and left out, mm: cell residuals and the scatter inside the cells."""
        residual = self.residual(model)
        on_teeth = self.use & np.isin(self.cells.points.surface, (FLANK, FILLET, ROOT, TIP))
        count = self.cells.count[on_teeth]
        inside = np.nan_to_num(self.cells.scatter[on_teeth]) ** 2 * np.maximum(count - 1.0, 0.0)
        total = float(count.sum())
        between = float((residual[on_teeth] ** 2 * count).sum()) / total
        inner = between + float(inside.sum()) / total
        # Left out: the cells' part grows by the ratio of left-out to in-sample weighted squares.
        folded = self.folded(model, fold)
        every = np.arange(len(folded.moment[0]))
        ratio = float(folded.held_out(every).sum()) / max(folded.residual_square(every), 1e-300)
        return float(np.sqrt(inner)), float(np.sqrt(max(inner + between * (ratio - 1.0), 0.0)))

    def _too_small(self, model: Model, columns: Floats, inverse: Floats, noise: float) -> list[tuple[Floats, Floats]]:
        """Effects too small to be found: of each plain candidate that was not chosen its column, with a size of `hidden` of the least
        contribution, and the amplitudes with which `columns` follow it."""
        weight = self.weight
        total = float(weight.sum())
        names = {c.name for c in model}
        result = []
        for candidate in self.dictionary.candidates:
            if (
                candidate.name in names
                or candidate.shape
                or candidate.effect.tooth_specific
                or candidate.effect.kind is Kind.FORM
            ):
                continue
            own = self.dictionary.take(candidate.columns)
            pull = inverse @ (columns.T @ (weight[:, None] * own))
            rest = own - columns @ pull
            # Along what is left of it in directions square to each other: a wave round the gear is the same wave from any tooth on.
            left, mixed = np.linalg.eigh(rest.T @ (weight[:, None] * rest))
            whole = ((own @ mixed) ** 2 * weight[:, None]).sum(axis=0)
            for i in np.flatnonzero(left > rules().spanned * whole):
                size = rules().hidden * rules().least_share * noise * np.sqrt(total / left[i])
                result.append((own @ mixed[:, i] * size, pull @ mixed[:, i] * size))
        return result

    def hidden(self, model: Model, noise: float) -> Floats:
        """(m, k) what effects too small to be found leave in each cell beside the model, mm: one of them is there, any of them alike, so
        the columns' outer products add up to the covariance."""
        columns = self.columns(model)
        gram = self.statistics(columns)
        _, inverse = gram.solve(np.arange(columns.shape[1]))
        fields = [own - columns @ pull for own, pull in self._too_small(model, columns, inverse, noise)]
        return np.column_stack(fields) / np.sqrt(len(fields)) if fields else np.zeros((len(self.target), 0))

    def apart_by_teeth(self, model: Model) -> list[tuple[float, float]]:
        """How far teeth differ in each effect of the model: standard error of its size, in that size, from what each tooth has it larger or smaller beside
        the other effects, and on how many teeth that rests, less what the effect may adapt to them.

        Notes
        -----
        With h what the others leave of the effect's field, the size that a tooth adds is ``Σ w h e / Σ w h²``, e what the model leaves; teeth count as many as
        evenly shared ``Σ w h²`` would be (Satterthwaite 1946). An effect on a few teeth is told by few.
        """
        columns = self.columns(model)
        gram = self.statistics(columns)
        amplitudes, inverse = gram.solve(np.arange(columns.shape[1]))
        weight, left = self.weight, self.target - columns @ amplitudes
        teeth = self.use & (self.cells.points.surface <= TIP)
        tooth, result = self.cells.points.tooth[teeth], []
        for candidate, part in zip(model, self.parts(model), strict=True):
            own = amplitudes[part]
            field = columns @ (inverse[:, part] @ (np.linalg.pinv(inverse[part, part]) @ own))
            told = np.bincount(tooth, (weight * field**2)[teeth])
            number = float(told.sum() ** 2 / max(float(told @ told), 1e-300)) - len(own) - len(candidate.shape) + 1.0
            size: Floats = np.bincount(tooth, (weight * field * left)[teeth]) / max(float(told.sum()), 1e-300)
            result.append((of_units(size, max(number, 1.5)), max(number, 1.5)))
        return result

    def level_std(self, model: Model, hidden: Floats) -> tuple[float, float]:
        """Standard deviation of the model's mean over all left and over all right flanks, mm; `hidden` as that function gives it."""
        columns = self.columns(model)
        gram = self.statistics(columns)
        _, inverse = gram.solve(np.arange(columns.shape[1]))
        spread = sandwich(columns, self.use, self.covariance, inverse)
        points = self.cells.points
        result = []
        for side in (1, -1):
            own = (points.surface == FLANK) & (points.side == side) & self.cells.seen
            if not own.any():
                result.append(0.0)
                continue
            mean = columns[own].mean(axis=0)
            known = np.diag(gram.information[0]) > 0.0
            own_std = np.sqrt(max(mean[known] @ spread[np.ix_(known, known)] @ mean[known], 0.0))
            result.append(float(np.hypot(own_std, np.linalg.norm(hidden[own].mean(axis=0)))))
        return result[0], result[1]

    def parts(self, model: Model) -> list[slice]:
        """Where each effect's amplitudes stand in the fit."""
        ends = len(self.dictionary.pose) + np.cumsum([0, *(len(c.columns) for c in model)])
        return [slice(low, high) for low, high in pairwise(ends.tolist())]

    def fields(self, model: Model, amplitudes: Floats, which: Iterable[int]) -> Floats:
        """What some effects of a model do to the deviation of cells beside the pose, (m, k) mm."""
        parts = self.parts(model)
        fields = np.column_stack([self.dictionary.take(model[i].columns) @ amplitudes[parts[i]] for i in which])
        return beside_pose(fields, self.dictionary.take(self.dictionary.pose), self.weight)

    def uneven(self, model: Model, amplitudes: Floats, index: int) -> float:
        """How differently two halves of the gear show an effect of the model: greatest difference of their relative size
        between low and high z, left and right flanks, lower and upper profile, opposite halves round the gear; 0 where no difference is
        beyond `errors` standard deviations, and beyond what teeth differ in it, by Student's t, corrected for all that is asked.

        A right effect has one size everywhere. A piece of something else that it stands in for has not.
        """
        parts = self.parts(model)
        columns = self.columns(model)
        field = columns[:, parts[index]] @ amplitudes[parts[index]]
        points, gear = self.cells.points, self.cells.grid.gear
        height, roll = points.position[:, 2], np.nan_to_num(points.roll)
        teeth, flank = points.surface <= TIP, points.surface == FLANK
        middle = 0.5 * (gear.form_roll + gear.tip_roll)
        halves = (
            (teeth & (height < 0.5 * gear.face_width), teeth & (height >= 0.5 * gear.face_width)),
            (points.side > 0, points.side < 0),
            (flank & (roll < middle), flank & (roll >= middle)),
            (points.position[:, 0] < 0.0, points.position[:, 0] >= 0.0),
            (points.position[:, 1] < 0.0, points.position[:, 1] >= 0.0),
        )
        greatest, number = 0.0, len(np.unique(points.tooth[self.use & teeth]))
        asked = beyond_chance(number, 2 * len(halves) * len(model))  # either way
        as_cut = self.is_cut_along_face(model[index], field)
        split = 0.5 * np.column_stack([np.where(one, 1.0, 0.0) - np.where(other, 1.0, 0.0) for one, other in halves])
        of_sides = flank[:, None] & (points.side[:, None] == np.array([int(side) for side in Side]))
        levels = (split[:, :, None] * of_sides[:, None]).reshape(len(field), -1)
        every = np.hstack([columns, levels, split * field[:, None]])
        gram = self.statistics(every)
        own, of_half, apart = np.split(np.arange(every.shape[1]), [columns.shape[1], columns.shape[1] + levels.shape[1]])
        for at, beside in zip(apart, of_half.reshape(len(halves), -1), strict=True):
            alone = float(gram.information[0, at, at])
            # What a half has as a level of its own speaks against nothing that the maker cut along the face.
            for which in (*([np.array([*own, *beside, at])] if as_cut else []), np.array([*own, at])):
                size, inverse = gram.solve(which)
                free = 1.0 / max(float(inverse[-1, -1]), 1e-300) >= rules().free_share * alone
                if free:
                    break
            # The other effects of the model, or its own size where one half hardly shows it, can take the difference up.
            if not free:
                continue
            pull = every[:, which] @ inverse[-1] * self.weight
            variance = float(pull @ self.covariance.apply(pull[:, None])[:, 0])
            of_cells = (self.target - every[:, which] @ size) * pull
            of_teeth: Floats = np.bincount(points.tooth, np.where(teeth, of_cells, 0.0)).astype(np.float64)
            if abs(size[-1]) > max(rules().errors * math.sqrt(max(variance, 0.0)), asked * of_units(of_teeth, number)):
                greatest = max(greatest, abs(float(size[-1])))
        return greatest

    def is_cut_along_face(self, candidate: Candidate, field: Floats) -> bool:
        """Whether an effect, with its field (m,), is what the maker cut along the face alone: a lead, or a crowning."""
        return candidate.effect.kind is Kind.MANUFACTURE and runs_along_face(self.cells.grid, field)

    def uncertainty(self, model: Model, amplitudes: Floats, context: Context, noise: float) -> list[Floats]:
        """Covariance of each effect's amplitudes and continuous shape values, all of them and the pose fitted together.

        nan for an amplitude that no cell speaks of.
        """
        spread, places = self.joint_uncertainty(model, amplitudes, context, noise)
        return [spread[np.ix_(at, at)] for at in places]

    def joint_uncertainty(self, model: Model, amplitudes: Floats, context: Context, noise: float) -> tuple[Floats, list[Ints]]:
        """Covariance of the pose and all effects together, and where each effect's amplitudes and shape values stand in it."""
        parts = self.parts(model)
        own = self.columns(model)
        extra = [shape_columns(c, amplitudes[part], self.cells, context) for c, part in zip(model, parts, strict=True)]
        columns = np.hstack([own, *extra])
        gram = self.statistics(columns)
        _, inverse = gram.solve(np.arange(columns.shape[1]))
        spread = sandwich(columns, self.use, self.covariance, inverse)
        pulls = [pull for _, pull in self._too_small(model, columns, inverse, noise)]
        spread += np.sum([np.outer(pull, pull) for pull in pulls], axis=0) / max(len(pulls), 1)
        unseen = np.diag(gram.information[0]) == 0.0
        spread[unseen, unseen] = np.nan
        ends = own.shape[1] + np.cumsum([0, *(block.shape[1] for block in extra)])
        places = [
            np.concatenate([np.arange(part.start, part.stop), np.arange(low, high)])
            for part, (low, high) in zip(parts, pairwise(ends.tolist()), strict=True)
        ]
        residual = self.residual(model)
        for candidate, part, at in zip(model, parts, places, strict=True):
            if candidate.effect.tooth_specific or candidate.effect.kind is Kind.FORM:
                continue
            order = order_of(self.cells.grid, own[:, part] @ amplitudes[part])
            if order > 0:
                waves = neighbouring_waves(self.cells.grid, residual, self.use, order)
                pulls = inverse[at] @ (columns.T @ (self.weight[:, None] * waves))
                spread[np.ix_(at, at)] += beyond_texture(pulls, spread[np.ix_(at, at)])
        return spread, places


def design_unit(dictionary: Dictionary, use: Bools, covariance: CellCovariance) -> float:
    """Expected gain of a column that explains nothing: median over the candidates of bᵀWΣWb / bᵀWb; at least 1."""
    picks = [c.columns[0] for c in dictionary.candidates]
    picks = picks[:: max(1, len(picks) // rules().unit_picks)]
    columns = dictionary.take(np.array(picks))
    columns[~use] = 0.0
    weighted = columns * covariance.weight[:, None]
    top = (weighted * covariance.apply(weighted)).sum(axis=0)
    bottom = (weighted * columns).sum(axis=0)
    good = bottom > 0.0
    return max(1.0, float(np.median(top[good] / bottom[good]))) if good.any() else 1.0
