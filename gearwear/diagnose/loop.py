"""Closing the loop: the residual, the effects the model lacks, the error before and after."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP, SurfacePoints
from gearwear.diagnose.covariance import CellCovariance, estimate_covariance
from gearwear.diagnose.dictionary import Candidate, Dictionary, build_dictionary
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context, Effect, Estimate, Kind
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.judge import Evidence, alternatives, judge, sandwich
from gearwear.diagnose.pattern import Pattern, find_patterns
from gearwear.diagnose.search import Problem, exchange, forward
from gearwear.diagnose.shapes import refine_shapes, shape_columns
from gearwear.measure.cells import Cells
from gearwear.measure.robust import median_scale, tukey_weight
from gearwear.measure.sheet import make_sheets, rim, window_mean, worn_cells

EDGE = 0.12
"""Modules of roll length above the form circle left out: there dL = (r / L) dr turns a radial error into millimetres of roll."""
CAUTION = (3.0, 1.5, 1.0, 1.0)
"""Factor on the wear limit, round by round: effects explain first, what is left may then be wear."""


@dataclass(frozen=True, slots=True)
class FoundEffect:
    """An effect that was added to the model.

    Parameters
    ----------
    candidate : Candidate
        Effect and shape.
    amplitudes : (p,) float
        Inner units.
    parameters : dict of str to Estimate
        As the contract names them.
    alternatives : tuple of str
        What the data cannot tell from it.
    evidence : Evidence
    rms_before, rms_after, held_out_before, held_out_after : float
        mm, over points outside the wear; each before is the last after.
    """

    candidate: Candidate
    amplitudes: Floats
    parameters: dict[str, Estimate]
    alternatives: tuple[str, ...]
    evidence: Evidence
    rms_before: float
    rms_after: float
    held_out_before: float
    held_out_after: float

    @property
    def name(self) -> str:
        return self.candidate.name

    @property
    def kind(self) -> Kind:
        return self.candidate.effect.kind


@dataclass(frozen=True, slots=True)
class Loop:
    """The closed loop.

    Parameters
    ----------
    effects : tuple of FoundEffect
        In the order added.
    motion : (6,) float
        Small motion (mm, rad) of the scan that goes with them: deviations of the motion and the effects add.
    rms_before, rms_after, held_out_before, held_out_after : float
        mm, over points outside the wear.
    noise : float
        Scatter of points inside cells, mm.
    residual_before, residual_after : (m,) float
        Cell means minus the model (pose only; all), mm.
    use : (m,) bool
        Cells outside wear and edges.
    covariance : CellCovariance
        Of what is left.
    worn_side : int
        Side left out altogether, 0 for none.
    context : Context
    tried : int
        Candidates tried.
    patterns : tuple of Pattern
        What no effect explains; taken out of `residual_after` without a name.
    """

    effects: tuple[FoundEffect, ...]
    motion: Floats
    rms_before: float
    rms_after: float
    held_out_before: float
    held_out_after: float
    noise: float
    residual_before: Floats
    residual_after: Floats
    use: Bools
    covariance: CellCovariance
    worn_side: int
    context: Context
    tried: int
    patterns: tuple[Pattern, ...]

    def deviation(self, points: SurfacePoints, kinds: frozenset[Kind]) -> Floats:
        """What the effects of some kinds do to the deviation of points, mm, (n,)."""
        total = np.zeros(len(points))
        for effect in self.effects:
            if effect.kind in kinds:
                total += effect.candidate.effect.basis(points, self.context, effect.candidate.shape) @ effect.amplitudes
        return total


def close_loop(
    cells: Cells, noise: float, context: Context, worn_side: int = 0, effects: tuple[Effect, ...] | None = None
) -> Loop:
    """Find the effects that explain a scan.

    Parameters
    ----------
    cells : Cells
        The registered scan, binned.
    noise : float
        Scatter of points inside cells, mm.
    context : Context
        Gear, surfaces seen, the scan's axes.
    worn_side : int
        Side whose flanks registration found worn throughout; not used here.
    effects : tuple of Effect or None
        None: the whole catalogue.

    Returns
    -------
    Loop
    """
    dictionary = build_dictionary(cells, catalogue() if effects is None else effects, context)
    target = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0)
    sound = sound_cells(cells, worn_side)
    covariance = CellCovariance(cells.grid, noise**2 / np.maximum(cells.count, 1.0), (0.3 * noise) ** 2, 0.3, 0.3)
    tooth_fold, block_fold = folds(cells)
    chosen: tuple[Candidate, ...] = ()
    residual = _pose_residual(dictionary, target, sound, covariance)
    use, unit = sound, 3.0
    problem = Problem(dictionary, _gram(dictionary, target, use, covariance), unit, context)
    for round_, caution in enumerate(CAUTION):
        use = sound & ~worn_mask(cells, residual, noise, caution) & _not_stray(residual, sound)
        problem = Problem(dictionary, _gram(dictionary, target, use, covariance), unit, context)
        before = tuple((c.name, c.shape) for c in chosen)
        chosen = forward(problem, chosen) if round_ < 2 else chosen
        chosen = exchange(problem, chosen)
        dictionary, chosen = refine_shapes(problem, chosen, cells, target, use, covariance)
        residual = _residual(dictionary, chosen, target, use, covariance)
        covariance = estimate_covariance(cells, residual, use, noise)
        unit = design_unit(dictionary, use, covariance)
        if round_ >= 2 and tuple((c.name, c.shape) for c in chosen) == before:
            break
    problem = Problem(dictionary, _gram(dictionary, target, use, covariance), unit, context)
    while True:
        fold = block_fold if any(c.effect.tooth_specific for c in chosen) else tooth_fold
        folded = _folded(problem, chosen, target, use, covariance, fold)
        evidence = [judge(problem, chosen, i, use, covariance, folded, noise) for i in range(len(chosen))]
        failed = [i for i, e in enumerate(evidence) if not e.accepted]
        if not failed:
            break
        worst = max(failed, key=lambda i: evidence[i].p_value + (1.0 if evidence[i].held_out_gain <= 0.0 else 0.0))
        chosen = chosen[:worst] + chosen[worst + 1 :]
    return _report(problem, chosen, evidence, cells, target, use, covariance, noise, worn_side, fold)


def sound_cells(cells: Cells, worn_side: int) -> Bools:
    """Cells fit for a fit: enough points, away from the form circle's edge, not on a side worn throughout."""
    gear, p = cells.grid.gear, cells.points
    seen = cells.seen
    enough = cells.count >= max(2.0, 0.25 * float(np.median(cells.count[seen])))
    away = (p.surface != FLANK) | (np.nan_to_num(p.roll) > gear.form_roll + EDGE * gear.transverse_module)
    return np.asarray(seen & enough & away & ((p.surface != FLANK) | (p.side != worn_side) | (worn_side == 0)))


def worn_mask(cells: Cells, residual: Floats, noise: float, caution: float) -> Bools:
    """Cells that look worn against the current model, with a rim of one cell, (m,)."""
    sheets = make_sheets(cells.with_deviation(residual))
    local, number = window_mean(sheets)
    mask = (
        rim(worn_cells(local / caution, number, noise)[0] & (local < 0.0))
        if caution > 1.0
        else rim(worn_cells(local, number, noise)[0])
    )
    grid = cells.grid
    result = np.zeros(grid.count, dtype=bool)
    for surface, part in ((FILLET, mask[..., : grid.fillet]), (FLANK, mask[..., grid.fillet :])):
        start, size = grid.blocks[surface]
        result[start : start + size] = part.reshape(-1)
    return result


def _not_stray(residual: Floats, sound: Bools) -> Bools:
    """Cells within reach of the rest: what single torn cells (edges, chips) do not belong to."""
    centre, scale = median_scale(residual[sound])
    return np.asarray(tukey_weight(residual - centre, max(2.0 * scale, 1e-9)) > 0.0)


def folds(cells: Cells) -> tuple[Ints, Ints]:
    """Fold of every cell: by teeth (each by itself up to 16, else 12 groups), and by staggered blocks along z or the profile."""
    teeth = cells.grid.gear.teeth
    by_tooth = cells.points.tooth % (teeth if teeth <= 16 else 12)
    position, gear = np.nan_to_num(cells.points.position), cells.grid.gear
    if cells.grid.rows > 1:
        share = position[:, 2] / gear.face_width
    else:  # a planar section has no height: blocks along the profile
        share = (np.hypot(position[:, 0], position[:, 1]) - gear.root_radius) / (gear.tip_radius - gear.root_radius)
    block = np.clip((share * 6).astype(np.int64), 0, 5)
    # Staggered from tooth to tooth: every tooth, and every block of some tooth, is always in what is fitted.
    return by_tooth.astype(np.int64), (block + cells.points.tooth) % 6


def _gram(dictionary: Dictionary, target: Floats, use: Bools, covariance: CellCovariance) -> Gram:
    """Statistics of all candidates, one fold."""
    return Gram.of(dictionary.columns, target, np.where(use, covariance.weight, 0.0), np.zeros(len(target), np.int64), 1)


def _folded(
    problem: Problem, chosen: tuple[Candidate, ...], target: Floats, use: Bools, covariance: CellCovariance, fold: Ints
) -> Gram:
    """Statistics of the model's own columns, fold by fold."""
    columns = problem.dictionary.columns[:, problem.columns(chosen)]
    return Gram.of(columns, target, np.where(use, covariance.weight, 0.0), fold, int(fold.max()) + 1)


def _pose_residual(dictionary: Dictionary, target: Floats, use: Bools, covariance: CellCovariance) -> Floats:
    """Residual of the pose alone, refitted robustly."""
    columns = dictionary.columns[:, dictionary.pose]
    weight = np.where(use, covariance.weight, 0.0)
    residual = target - np.median(target[use])
    for _ in range(4):
        scale = max(median_scale(residual[use])[1], 1e-9)
        w = weight * tukey_weight(residual, scale)
        gram = Gram.of(np.hstack([columns, np.ones((len(target), 1))]), target, w, np.zeros(len(target), np.int64), 1)
        amplitudes, _ = gram.solve(np.arange(columns.shape[1] + 1))
        residual = target - columns @ amplitudes[:-1] - amplitudes[-1]
    return np.asarray(target - columns @ amplitudes[:-1], dtype=np.float64)


def _residual(
    dictionary: Dictionary, chosen: tuple[Candidate, ...], target: Floats, use: Bools, covariance: CellCovariance
) -> Floats:
    which = np.concatenate([dictionary.pose, *(c.columns for c in chosen)]).astype(np.int64)
    columns = dictionary.columns[:, which]
    gram = Gram.of(columns, target, np.where(use, covariance.weight, 0.0), np.zeros(len(target), np.int64), 1)
    return np.asarray(target - columns @ gram.solve(np.arange(len(which)))[0], dtype=np.float64)


def design_unit(dictionary: Dictionary, use: Bools, covariance: CellCovariance) -> float:
    """Expected gain of a column that explains nothing: median over the candidates of bᵀWΣWb / bᵀWb; at least 1."""
    picks = [c.columns[0] for c in dictionary.candidates]
    picks = picks[:: max(1, len(picks) // 40)]
    columns = np.where(use[:, None], dictionary.columns[:, picks], 0.0)
    weighted = columns * covariance.weight[:, None]
    top = (weighted * covariance.apply(weighted)).sum(axis=0)
    bottom = (weighted * columns).sum(axis=0)
    good = bottom > 0.0
    return max(1.0, float(np.median(top[good] / bottom[good]))) if good.any() else 1.0


def _report(
    problem: Problem, chosen: tuple[Candidate, ...], evidence: list[Evidence], cells: Cells, target: Floats, use: Bools,
    covariance: CellCovariance, noise: float, worn_side: int, fold: Ints,
) -> Loop:  # fmt: skip
    """Order the effects by gain, and follow the error from step to step."""
    left = list(range(len(chosen)))
    order: list[int] = []
    while left:
        base = problem.columns(tuple(chosen[i] for i in order))
        gains = problem.gram.gains(base, [chosen[i].columns for i in left])
        order.append(left.pop(int(np.argmax(gains))))
    chosen = tuple(chosen[i] for i in order)
    evidence = [evidence[i] for i in order]
    steps = [_errors(problem, chosen[:n], cells, target, use, covariance, fold) for n in range(len(chosen) + 1)]
    which = problem.columns(chosen)
    amplitudes, _ = problem.gram.solve(which)
    parts = _parts(problem, chosen)
    extra = [shape_columns(c, amplitudes[part], cells, problem.context) for c, part in zip(chosen, parts, strict=True)]
    spread, at_shape = _covariance(problem, which, extra, target, use, covariance)
    found = []
    for i, (candidate, part) in enumerate(zip(chosen, parts, strict=True)):
        own = np.concatenate([np.arange(part.start, part.stop), at_shape[i]])
        parameters = candidate.effect.estimates(amplitudes[part], spread[np.ix_(own, own)], candidate.shape, problem.context)
        found.append(
            FoundEffect(
                candidate, amplitudes[part], parameters, alternatives(problem, chosen, i), evidence[i],
                steps[i][0], steps[i + 1][0], steps[i][1], steps[i + 1][1],
            )
        )  # fmt: skip
    motion = np.zeros(6)
    motion[problem.dictionary.motion] = amplitudes[: len(problem.dictionary.pose)]
    before = _residual(problem.dictionary, (), target, use, covariance)
    after = _residual(problem.dictionary, chosen, target, use, covariance)
    return Loop(
        tuple(found), motion, steps[0][0], steps[-1][0], steps[0][1], steps[-1][1], noise, before, after, use, covariance,
        worn_side, problem.context, len(problem.dictionary.candidates), find_patterns(cells.grid, after, use, noise),
    )  # fmt: skip


def _parts(problem: Problem, chosen: tuple[Candidate, ...]) -> list[slice]:
    """Where each effect's amplitudes stand in the fit."""
    ends = len(problem.dictionary.pose) + np.cumsum([0, *(len(c.columns) for c in chosen)])
    return [slice(low, high) for low, high in pairwise(ends.tolist())]


def _covariance(
    problem: Problem, which: Ints, extra: list[Floats], target: Floats, use: Bools, covariance: CellCovariance
) -> tuple[Floats, list[Ints]]:
    """Covariance of amplitudes and continuous shape values together, and where each effect's shape values stand in it."""
    columns = np.hstack([problem.dictionary.columns[:, which], *extra])
    ends = len(which) + np.cumsum([0, *(block.shape[1] for block in extra)])
    gram = Gram.of(columns, target, np.where(use, covariance.weight, 0.0), np.zeros(len(target), np.int64), 1)
    _, inverse = gram.solve(np.arange(columns.shape[1]))
    places = [np.arange(low, high) for low, high in pairwise(ends.tolist())]
    return sandwich(columns, use, covariance, inverse), places


def _errors(
    problem: Problem,
    chosen: tuple[Candidate, ...],
    cells: Cells,
    target: Floats,
    use: Bools,
    covariance: CellCovariance,
    fold: Ints,
) -> tuple[float, float]:
    """RMS over the points in use, in sample and left out, mm: cell residuals and the scatter inside the cells."""
    residual = _residual(problem.dictionary, chosen, target, use, covariance)
    on_teeth = use & np.isin(cells.points.surface, (FLANK, FILLET, ROOT, TIP))
    count = cells.count[on_teeth]
    inside = np.nan_to_num(cells.scatter[on_teeth]) ** 2 * np.maximum(count - 1.0, 0.0)
    total = float(count.sum())
    inner = float((residual[on_teeth] ** 2 * count + inside).sum()) / total
    # Left out: the cells' part grows by the ratio of left-out to in-sample weighted squares.
    folded = _folded(problem, chosen, target, use, covariance, fold)
    every = np.arange(len(problem.columns(chosen)))
    ratio = float(folded.held_out(every).sum()) / max(folded.residual_square(every), 1e-300)
    between = float((residual[on_teeth] ** 2 * count).sum()) / total
    outer = inner + between * (ratio - 1.0)
    return float(np.sqrt(inner)), float(np.sqrt(max(outer, 0.0)))


def make_context(cells: Cells, scan_axes: Floats, planar: bool, mate: tuple[float, float] | None = None) -> Context:
    """What the effects may need to know of a scan; see `Context`."""
    seen = cells.points.surface[cells.seen]
    present = frozenset(code for code in (FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE) if (seen == code).sum() >= 3)
    return Context(cells.grid.gear, present, scan_axes, planar, mate)


__all__ = ["FoundEffect", "Loop", "close_loop", "make_context", "replace"]
