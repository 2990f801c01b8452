"""Closing the loop: the residual, the effects the model lacks, the error before and after."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.covariance import CellCovariance, estimate_covariance
from gearwear.diagnose.dictionary import build_dictionary
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context, Effect, Kind
from gearwear.diagnose.fit import Fit, Model, design_unit
from gearwear.diagnose.found import FoundEffect, Loop, account
from gearwear.diagnose.judge import Evidence, judge
from gearwear.diagnose.masks import folds, not_stray, sound_cells, worn_mask
from gearwear.diagnose.pattern import Pattern, find_patterns, order_share
from gearwear.diagnose.search import Problem, exchange, forward
from gearwear.diagnose.shapes import polish, refine_shapes
from gearwear.measure.cells import Cells
from gearwear.measure.datum import flank_profile

CAUTION = (3.0, 1.5, 1.0, 1.0)
"""Factor on the wear limit, round by round: effects explain first, what is left may then be wear."""
MAKESHIFT = 2.0
"""An effect that explains less than so many times a left-over pattern of its own order is a piece of that pattern."""
MAKESHIFT_BY_TOOTH = 8.0
"""The same for an effect with a freedom for every tooth, which can follow any order round the gear."""
UNEVEN = 0.4
"""Difference of an effect's relative size between two halves of the gear from which it is a piece of something else."""
PROUD = 0.3
"""A side that rises above the gear by this share of what it falls below it is not worn, or not only."""
FIRST_UNIT = 3.0
"""Expected gain of a column that explains nothing, before the scan's own correlation is known."""


def close_loop(
    cells: Cells,
    noise: float,
    context: Context,
    worn_side: int = 0,
    effects: tuple[Effect, ...] | None = None,
    one_sided: bool = False,
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
    one_sided : bool
        True where it is known that no side is worn throughout.

    Returns
    -------
    Loop
    """
    dictionary = build_dictionary(cells, _searched() if effects is None else effects, context)
    target = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0)
    sound = sound_cells(cells, worn_side)
    white = CellCovariance(cells.grid, noise**2 / np.maximum(cells.count, 1.0), (0.3 * noise) ** 2, 0.3, 0.3)
    fit = Fit(cells, target, dictionary, sound, white)
    fit, problem, model = _search(fit, fit.pose_residual(), noise, context)
    by_tooth, by_block = folds(cells)
    while True:
        fold = by_block if any(c.effect.tooth_specific for c in model) else by_tooth
        folded = fit.folded(model, fold)
        evidence = [judge(problem, model, i, fit.use, fit.covariance, folded, noise) for i in range(len(model))]
        patterns: tuple[Pattern, ...] = ()
        worst = _worst(evidence)
        if worst is None:
            worst = _most_uneven(fit, problem, model)
        if worst is None:
            patterns = find_patterns(cells.grid, fit.residual(model), fit.use, noise)
            worst = _makeshift(fit, problem, model, evidence, patterns)
        if worst is None:
            break
        model = model[:worst] + model[worst + 1 :]
    worn = [c.shape[-1] for c in model if c.effect.kind is Kind.WEAR]
    if worn and worn_side == 0 and not one_sided:  # a side worn throughout may bend no other effect: once more without its flanks
        return close_loop(cells, noise, context, int(worn[0]), effects)
    found = account(fit, problem, model, evidence, fold, patterns, noise, worn_side)
    if worn_side and _stands_proud(fit, found, worn_side):
        # What rises as far as it falls is no wear: the side is judged with the others, and nothing may be blamed on wear.
        plain = tuple(e for e in (_searched() if effects is None else effects) if e.kind is not Kind.WEAR)
        return close_loop(cells, noise, context, 0, plain, one_sided=True)
    return found


def _search(fit: Fit, residual: Floats, noise: float, context: Context) -> tuple[Fit, Problem, Model]:
    """Forward to the floor and exchange, with mask, shapes and covariance renewed round by round."""
    sound, unit = fit.use, FIRST_UNIT
    model: Model = ()
    for round_, caution in enumerate(CAUTION):
        use = sound & ~worn_mask(fit.cells, residual, noise, caution) & not_stray(residual, sound)
        fit = Fit(fit.cells, fit.target, fit.dictionary, use, fit.covariance)
        before = [(c.name, c.shape) for c in model]
        problem = fit.problem(unit, context)
        model = exchange(problem, forward(problem, model) if round_ < 2 else model)
        dictionary, model = refine_shapes(problem, model, fit.cells, fit.target, use, fit.covariance)
        if round_ >= 1:
            refined = Fit(fit.cells, fit.target, dictionary, use, fit.covariance).problem(unit, context)
            dictionary, model = polish(refined, model, fit.cells, fit.target, use, fit.covariance)
        fit = Fit(fit.cells, fit.target, dictionary, use, fit.covariance)
        residual = fit.residual(model)
        covariance = estimate_covariance(fit.cells, residual, use, noise)
        unit = design_unit(dictionary, use, covariance)
        fit = Fit(fit.cells, fit.target, dictionary, use, covariance)
        if round_ >= 2 and [(c.name, c.shape) for c in model] == before:
            break
    return fit, fit.problem(unit, context), model


def _searched() -> tuple[Effect, ...]:
    """The catalogue less what only a fit that asks for it by name may use."""
    return tuple(effect for effect in catalogue() if effect.searched)


def _worst(evidence: list[Evidence]) -> int | None:
    """The effect that fails most clearly; None where all stand."""
    failed = [i for i, e in enumerate(evidence) if not e.accepted]
    if not failed:
        return None
    return max(failed, key=lambda i: evidence[i].p_value + (1.0 if evidence[i].held_out_gain <= 0.0 else 0.0))


def _stands_proud(fit: Fit, found: Loop, side: int) -> bool:
    """Whether the flanks of a side taken for worn rise above the as-made gear about as much as they fall below it."""
    profile = flank_profile(fit.cells.with_deviation(found.residual_after), side)
    error = 2.0 * np.sqrt(found.covariance.texture + found.noise**2 / max(float(np.median(fit.cells.count)), 1.0))
    error /= np.sqrt(fit.cells.grid.gear.teeth)
    high, low = float(np.nanmax(profile)), float(-np.nanmin(profile))
    return high > error and high > PROUD * low


def _most_uneven(fit: Fit, problem: Problem, model: Model) -> int | None:
    """The effect whose size differs most between halves of the gear; None where all are about even."""
    amplitudes, _ = problem.gram.solve(problem.columns(model))
    uneven = [
        0.0 if c.effect.tooth_specific or c.effect.kind is Kind.WEAR else fit.uneven(model, i, amplitudes[part])
        for i, (c, part) in enumerate(zip(model, fit.parts(model), strict=True))
    ]
    worst = int(np.argmax(uneven)) if uneven else 0
    return worst if uneven and uneven[worst] > UNEVEN else None


def _makeshift(fit: Fit, problem: Problem, model: Model, evidence: list[Evidence], patterns: tuple[Pattern, ...]) -> int | None:
    """The weakest effect that stands in for a structure no effect explains; None where there is none.

    Where a pattern of some order is left, an effect of the same order that explains less than `MAKESHIFT` times as much is a piece of that
    pattern under a wrong name.
    """
    columns = fit.columns(model)
    amplitudes, _ = problem.gram.solve(problem.columns(model))
    suspects = []
    for i, part in enumerate(fit.parts(model)):
        field = np.where(fit.cells.seen, columns[:, part] @ amplitudes[part], np.nan)
        factor = MAKESHIFT_BY_TOOTH if model[i].effect.tooth_specific else MAKESHIFT
        for pattern in patterns:
            small = evidence[i].contribution < factor * pattern.rms
            if small and order_share(fit.cells.grid, field, pattern.order) > 0.5:
                suspects.append(i)
    return min(suspects, key=lambda i: evidence[i].contribution) if suspects else None


def make_context(cells: Cells, scan_axes: Floats, planar: bool, mate: tuple[float, float] | None = None) -> Context:
    """What the effects may need to know of a scan; see `Context`."""
    seen = cells.points.surface[cells.seen]
    present = frozenset(code for code in (FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE) if (seen == code).sum() >= 3)
    rows = 0.0 if planar else cells.grid.gear.face_width / cells.grid.rows
    return Context(cells.grid.gear, present, scan_axes, planar, mate, rows)


__all__ = ["FoundEffect", "Loop", "close_loop", "make_context"]
