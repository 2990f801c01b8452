"""Closing the loop: the residual, the effects the model lacks, the error before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.covariance import CellCovariance, estimate_covariance
from gearwear.diagnose.dictionary import build_dictionary
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context, Effect, Kind
from gearwear.diagnose.elimination import eliminate
from gearwear.diagnose.fit import Fit, Model, design_unit
from gearwear.diagnose.found import FoundEffect, Loop, account
from gearwear.diagnose.masks import not_stray, sound_cells, worn_mask
from gearwear.diagnose.search import Problem, exchange, forward
from gearwear.diagnose.shapes import polish, refine_shapes
from gearwear.placing.cells import Cells
from gearwear.placing.datum import flank_profile

CAUTION = (3.0, 1.5, 1.0, 1.0)
"""Factor on the wear limit, round by round: effects explain first, what is left may then be wear."""
PROUD = 0.3
"""A side that rises above the gear by this share of what it falls below it is not worn, or not only."""
FIRST_UNIT = 3.0
"""Expected gain of a column that explains nothing, before the scan's own correlation is known."""


def close_loop(
    cells: Cells,
    noise: float,
    context: Context,
    worn_side: Side | None = None,
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
    worn_side : Side or None
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
    stood = eliminate(fit, problem, model, noise)
    patterns = stood.patterns
    if any(pattern.order > 0 for pattern in patterns):
        # A wave round the gear drowns what is left out tooth by tooth: once more without it.
        waves = np.sum([pattern.field for pattern in patterns if pattern.order > 0], axis=0)
        fit = replace(fit, target=np.where(cells.seen, target - waves, 0.0), use=sound)
        fit, problem, model = _search(fit, fit.pose_residual(), noise, context)
        stood = eliminate(fit, problem, model, noise, tuple(pattern for pattern in patterns if pattern.order > 0))
        fit = replace(fit, target=target)
    # Wear that the search chose may fall for what its law does not say of it, and take effects with it: the side is looked at all the same.
    worn = [c.shape[-1] for c in (*stood.model, *model) if c.effect.kind is Kind.WEAR]
    model = stood.model
    lost = Side(int(worn[0])) if worn and not one_sided else None
    found = account(fit, problem, model, list(stood.evidence), stood.fold, stood.patterns, noise, worn_side or lost)
    if lost is not None and worn_side is None:  # a side worn throughout may bend no other effect: once more without its flanks
        without = close_loop(cells, noise, context, lost, effects)
        if without.worn_side == lost:
            return without
        # Flanks that are made differently left and right: what leaves less unexplained.
        return min(found, without, key=lambda one: (len(one.patterns), one.rms_after))
    if worn_side is not None and not _looks_worn(fit, found, worn_side):
        # The side is judged with the others, and nothing may be blamed on wear.
        plain = tuple(e for e in (_searched() if effects is None else effects) if e.kind is not Kind.WEAR)
        return close_loop(cells, noise, context, None, plain, one_sided=True)
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


def _looks_worn(fit: Fit, found: Loop, side: Side) -> bool:
    """Whether the flanks of a side taken for worn lie below the as-made gear, and do not rise above it about as much."""
    seen = fit.cells.seen  # of a part of a gear most cells are not
    profile = flank_profile(fit.cells.with_deviation(np.where(seen, found.residual_after, np.nan)), side)
    error = 2.0 * np.sqrt(found.covariance.texture + found.noise**2 / float(np.median(fit.cells.count[seen])))
    error /= np.sqrt(fit.cells.grid.gear.teeth)
    high, low = float(np.nanmax(profile)), float(-np.nanmin(profile))
    return low > error and not (high > error and high > PROUD * low)


def make_context(cells: Cells, scan_axes: Floats, planar: bool, mate: tuple[float, float] | None = None) -> Context:
    """What the effects may need to know of a scan; see `Context`."""
    seen = cells.points.surface[cells.seen]
    present = frozenset(code for code in (FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE) if (seen == code).sum() >= 3)
    rows = 0.0 if planar else cells.grid.gear.face_width / cells.grid.rows
    return Context(cells.grid.gear, present, scan_axes, planar, mate, rows)


__all__ = ["FoundEffect", "Loop", "close_loop", "make_context"]
