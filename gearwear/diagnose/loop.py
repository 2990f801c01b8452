"""Closing the loop: the residual, the effects the model lacks, the error before and after.

What a side that is worn on all its teeth does to the pose and to effects that all teeth share cannot be undone by leaving cells out, so it
is a hypothesis: no side is worn throughout, the left, the right, or both. Each is explained by itself, without the flanks that it takes
for worn, and one cost decides between them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side, sides_of
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.covariance import CellCovariance, estimate_covariance
from gearwear.diagnose.dictionary import build_dictionary
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import SCALE_LIMIT, Context, Effect, Kind
from gearwear.diagnose.elimination import Stood, eliminate
from gearwear.diagnose.fit import Fit, Model, design_unit
from gearwear.diagnose.found import FoundEffect, Loop, account
from gearwear.diagnose.judge import replacements
from gearwear.diagnose.masks import not_stray, sound_cells, worn_mask
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem, exchange, forward, free_penalty
from gearwear.diagnose.shapes import polish, refine_shapes
from gearwear.placing.cells import Cells
from gearwear.placing.datum import flank_profile

ROOT_FORM = "root_form"
"""The effect that leaves the root free."""
NO_SIDE: frozenset[Side] = frozenset()


@dataclass(frozen=True, slots=True)
class Explained:
    """One hypothesis, explained.

    Parameters
    ----------
    worn : frozenset of Side
        Sides it takes for worn throughout.
    fit, problem : Fit, Problem
        As the search left them.
    model : tuple of Candidate
        What the search chose.
    stood : Stood
        What of it may be named.
    """

    worn: frozenset[Side]
    fit: Fit
    problem: Problem
    model: Model
    stood: Stood

    @property
    def wear_chosen(self) -> frozenset[Side]:
        """Sides that the search put wear on: elimination may drop it for what its law does not say, and take effects with it."""
        shapes = [c.shape[-1] for c in (*self.stood.model, *self.model) if c.effect.kind is Kind.WEAR]
        return frozenset(side for side in Side for shape in shapes if shape in (side, 0.0))


def close_loop(
    cells: Cells,
    noise: float,
    context: Context,
    hint: Side | None = None,
    effects: tuple[Effect, ...] | None = None,
    root_free: bool = False,
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
    hint : Side or None
        Side whose flanks registration found worn throughout.
    effects : tuple of Effect or None
        None: the whole catalogue.
    root_free : bool
        True where the root is not the design's: it is whatever it is then, and no evidence.

    Returns
    -------
    Loop
        Of the cheapest hypothesis; `undecided` are the sides of those that cost no more than chance beyond it.
    """
    every = tuple(effect for effect in catalogue() if effect.searched) if effects is None else effects
    always = frozenset({ROOT_FORM}) if root_free else frozenset[str]()

    def explained(worn: frozenset[Side], these: tuple[Effect, ...]) -> Explained:
        return _explain(cells, noise, context, worn, these, always)

    def holds(one: Explained) -> bool:
        return all(_looks_worn(one, side, noise) for side in one.worn)

    # A side whose shape registration found bent, and that keeps the shape of wear beside every effect: no effect bends one side alone so.
    first = explained(sides_of(hint), every)
    if hint is not None and holds(first):
        return _account(first, noise)
    free = explained(NO_SIDE, every) if hint is not None else first
    if not free.wear_chosen:
        return _account(free, noise)
    worn = explained(free.wear_chosen, every)
    # Nothing may be blamed on wear where no side is worn.
    plain = explained(NO_SIDE, tuple(effect for effect in every if effect.kind is not Kind.WEAR))
    if not holds(worn):
        return _account(plain, noise)
    hypotheses = [plain, worn]
    costs = _costs(hypotheses)
    best = int(np.argmin(costs))
    undecided = tuple(one.worn for one, cost in zip(hypotheses, costs, strict=True) if 0.0 < cost - costs[best] < rules().close)
    return replace(_account(hypotheses[best], noise), undecided=undecided)


def _account(one: Explained, noise: float) -> Loop:
    stood = one.stood
    return account(one.fit, one.problem, stood.model, list(stood.evidence), stood.fold, stood.patterns, noise, one.worn)


def _explain(
    cells: Cells,
    noise: float,
    context: Context,
    worn: frozenset[Side],
    effects: tuple[Effect, ...],
    always: frozenset[str],
) -> Explained:
    """The effects under one hypothesis; the flanks of sides worn throughout are left out."""
    dictionary = build_dictionary(cells, effects, context)
    target = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0)
    sound = sound_cells(cells, worn)
    step, texture = rules().first_correlation, (rules().first_correlation * noise) ** 2
    white = CellCovariance(cells.grid, noise**2 / np.maximum(cells.count, 1.0), texture, step, step)
    fit = Fit(cells, target, dictionary, sound, white)
    fit, problem, model = _search(fit, fit.pose_residual(), noise, context, always)
    stood = eliminate(fit, problem, model, noise)
    waves = tuple(pattern for pattern in stood.patterns if pattern.order > 0)
    if waves:
        # A wave round the gear drowns what is left out tooth by tooth: once more without it.
        field = np.sum([pattern.field for pattern in waves], axis=0)
        fit = replace(fit, target=np.where(cells.seen, target - field, 0.0), use=sound)
        fit, problem, model = _search(fit, fit.pose_residual(), noise, context, always)
        stood = eliminate(fit, problem, model, noise, waves)
        fit = replace(fit, target=target)
    kept = _left_in_the_part(problem, stood.model)
    if kept != stood.model:
        known = tuple(pattern for pattern in stood.patterns if pattern.order > 0)
        stood = eliminate(fit, problem, kept, noise, known)
    return Explained(worn, fit, problem, model, stood)


def _left_in_the_part(problem: Problem, model: Model) -> Model:
    """The model with the maker's effect in place of a scanner's that cannot be told from it: what may be the part's own stays measured."""
    for index, candidate in enumerate(model):
        effect = candidate.effect
        if effect.kind is not Kind.MEASUREMENT or effect.usual or candidate.name in problem.always:
            continue
        for other, replaced in replacements(problem, model, index):
            if other.effect.kind is Kind.MANUFACTURE:
                return _left_in_the_part(problem, replaced)
    return model


def _search(fit: Fit, residual: Floats, noise: float, context: Context, always: frozenset[str]) -> tuple[Fit, Problem, Model]:
    """Forward to the floor and exchange, with mask, shapes and covariance renewed round by round."""
    sound, unit = fit.use, rules().first_unit
    model: Model = ()
    for round_, caution in enumerate(rules().caution):
        use = sound & ~worn_mask(fit.cells, residual, noise, caution) & not_stray(residual, sound)
        fit = Fit(fit.cells, fit.target, fit.dictionary, use, fit.covariance)
        before = [(c.name, c.shape) for c in model]
        problem = fit.problem(unit, context, always)
        model = problem.with_known(model)
        model = exchange(problem, forward(problem, model) if round_ < 2 else model)
        dictionary, model = refine_shapes(problem, model, fit.cells, fit.target, use, fit.covariance)
        if round_ >= 1:
            refined = Fit(fit.cells, fit.target, dictionary, use, fit.covariance).problem(unit, context, always)
            dictionary, model = polish(refined, model, fit.cells, fit.target, use, fit.covariance)
        fit = Fit(fit.cells, fit.target, dictionary, use, fit.covariance)
        residual = fit.residual(model)
        covariance = estimate_covariance(fit.cells, residual, use, noise)
        unit = design_unit(dictionary, use, covariance)
        fit = Fit(fit.cells, fit.target, dictionary, use, covariance)
        if round_ >= 2 and [(c.name, c.shape) for c in model] == before:
            break
    return fit, fit.problem(unit, context, always), model


def _costs(hypotheses: list[Explained]) -> list[float]:
    """Corrected sum of squares and penalties of every hypothesis on the same cells.

    The flanks of a side that is taken for worn get a profile of their own there, which costs a column for every column of cells; correlation
    is that of the hypothesis that leaves most, so that none is favoured by its own noise.
    """
    first = hypotheses[0].fit
    cells = first.cells
    use = np.ones(len(cells.count), dtype=bool)
    for one in hypotheses:
        use &= one.fit.use | _flanks(cells, one.worn)
    reference = max(hypotheses, key=lambda one: one.problem.unit)
    weight = np.where(use, reference.fit.covariance.weight, 0.0)
    costs = []
    for one in hypotheses:
        columns = np.hstack([one.fit.columns(one.stood.model), *(_free_profile(cells, side) for side in one.worn)])
        root = np.sqrt(weight)[:, None]
        scaled, target = columns * root, one.fit.target * root[:, 0]
        left = target - scaled @ np.linalg.lstsq(scaled, target, rcond=1e-10)[0]
        named = sum(one.problem.penalty(c) for c in one.stood.model)
        costs.append(float(left @ left) / reference.problem.unit + named + len(one.worn) * free_penalty(cells.grid.flank))
    return costs


def _flanks(cells: Cells, sides: frozenset[Side]) -> Bools:
    """Cells on the flanks of some sides that were seen, away from the form circle."""
    which = np.array([int(side) for side in sides])
    return np.asarray(sound_cells(cells, NO_SIDE) & (cells.points.surface == FLANK) & np.isin(cells.points.side, which))


def _free_profile(cells: Cells, side: Side) -> Floats:
    """A column for every column of cells on a side's flanks, all teeth and rows alike, (m, flank)."""
    shape = np.zeros((cells.grid.gear.teeth, 2, cells.grid.rows, cells.grid.fillet + cells.grid.flank))
    columns = []
    for column in range(cells.grid.flank):
        own = shape.copy()
        own[:, side.index, :, cells.grid.fillet + column] = 1.0
        columns.append(cells.grid.on_cells(own))
    return np.column_stack(columns)


def _looks_worn(explained: Explained, side: Side, noise: float) -> bool:
    """Whether a side's flanks lie below the as-made gear and have the shape of wear: what all teeth share may as well have been made so."""
    cells, fit = explained.fit.cells, explained.fit
    seen = cells.seen  # of a part of a gear most cells are not
    residual = np.where(seen, fit.residual(explained.stood.model), np.nan)
    profile = flank_profile(cells.with_deviation(residual), side)
    error = rules().errors * np.sqrt(fit.covariance.texture + noise**2 / float(np.median(cells.count[seen])))
    error /= np.sqrt(cells.grid.gear.teeth)
    return float(-np.nanmin(profile)) > error and _like_wear(explained, profile)


def _like_wear(explained: Explained, profile: Floats) -> bool:
    """Whether a loss that grows away from the pitch point explains a profile, and explains it better than a slope does.

    The loss may follow the sliding or grow evenly, faster on one side of the pitch point than on the other (`wear_shapes`). A slope is the
    maker's as well; where only one side of the pitch point was seen, wear is hardly more than that, and no side is called worn for it.
    """
    context, cells = explained.problem.context, explained.fit.cells
    roll = cells.grid.rolls(2)[1::2][1:-1]
    known = np.isfinite(profile)
    roll, lost = roll[known], -profile[known]
    shapes = wear_shapes(context, roll)
    if len(lost) <= shapes.shape[1]:
        return False  # as many unknowns as columns
    lost = lost - lost.mean()
    floor = explained.fit.covariance.texture / cells.grid.gear.teeth * float(known.sum())
    whole = float((lost**2).sum())
    if whole <= floor:
        return True
    law = max(float(nnls(shapes - shapes.mean(axis=0), lost)[1]) ** 2, floor)
    line = np.polynomial.polynomial.polyfit(roll, lost, 1)
    slope = max(float(((lost - np.polynomial.polynomial.polyval(roll, line)) ** 2).sum()), floor)
    return bool(law < (1.0 - rules().wear_likeness) * whole + floor and law < rules().better_than_slope * slope)


def wear_shapes(context: Context, roll: Floats) -> Floats:
    """Losses along the profile that wear may have, (n, 3): with the sliding, and in proportion below and above the pitch point."""
    pitch = context.pitch_roll
    return np.column_stack([np.abs(context.sliding(roll)), np.maximum(pitch - roll, 0.0), np.maximum(roll - pitch, 0.0)])


def make_context(
    cells: Cells, scan_axes: Floats, planar: bool, mate: tuple[float, float] | None = None, scale_limit: float | None = None
) -> Context:
    """What the effects may need to know of a scan; see `Context`."""
    seen = cells.points.surface[cells.seen]
    present = frozenset(code for code in (FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE) if (seen == code).sum() >= 3)
    rows = 0.0 if planar else cells.grid.gear.face_width / cells.grid.rows
    limit = SCALE_LIMIT if scale_limit is None else scale_limit
    edges = tuple(cells.grid.fillet_radius.tolist())
    return Context(cells.grid.gear, present, scan_axes, planar, mate, rows, limit, edges)


__all__ = ["FoundEffect", "Loop", "close_loop", "make_context"]
