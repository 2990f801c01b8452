"""Closing the loop: the residual, the effects the model lacks, the error before and after.

What a side that is worn on all its teeth does to the pose and to effects that all teeth share cannot be undone by leaving cells out. So it
is decided first, on all cells (`worn_sides`); then the scan is explained without the flanks of the sides that are worn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side, sides_of
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP, SurfacePoints
from gearwear.diagnose.active_face import active_faces
from gearwear.diagnose.bent_teeth import bent_teeth
from gearwear.diagnose.covariance import CellCovariance, estimate_covariance
from gearwear.diagnose.dictionary import Candidate, Dictionary, build_dictionary, with_worn
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.abrasive_wear import ABRASIVE_WEAR
from gearwear.diagnose.effects.base import SCALE_LIMIT, Context, Effect, Kind
from gearwear.diagnose.effects.bent_tooth import BENT_TOOTH
from gearwear.diagnose.effects.bent_tooth import EFFECT as BEND
from gearwear.diagnose.effects.edge_rounding import EDGE_ROUNDING
from gearwear.diagnose.effects.face_level import FACE_LEVEL
from gearwear.diagnose.effects.root_form import ROOT_FORM
from gearwear.diagnose.effects.sliding_wear import SLIDING_WEAR
from gearwear.diagnose.elimination import eliminate
from gearwear.diagnose.fit import Fit, Model, design_unit
from gearwear.diagnose.found import FoundEffect, Loop, account
from gearwear.diagnose.masks import not_stray, sound_cells, whole_flanks, worn_mask
from gearwear.diagnose.no_datum import HYPOTHESES, not_to_be_asked, or_worn, sides_seen, without_a_datum
from gearwear.diagnose.of_the_part import left_in_the_part, of_the_form, or_of_the_form
from gearwear.diagnose.pattern import Pattern
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem, exchange, forward
from gearwear.diagnose.shapes import polish, refine_shapes
from gearwear.diagnose.side_costs import NO_SIDE, SideCosts, reliefs_meet
from gearwear.diagnose.space_waves import SpaceWave, find_space_waves
from gearwear.diagnose.told_by_wear import told_by_wear
from gearwear.diagnose.untold import with_untold
from gearwear.diagnose.worn_flanks import worn_flanks
from gearwear.diagnose.worn_sides import side_costs
from gearwear.placing.cells import Cells
from gearwear.placing.datum import choose_datum
from gearwear.placing.edges import rounded_ends

NO_EVIDENCE = 1e6
"""By how much the variance of a cell is raised that is fitted and tells nothing; numerical."""
LEVEL_GROUP, FORM_GROUP = "G1", "G7"
"""Identifiability groups (reference): how far flanks stand out as a whole, and how they bend."""
MOST_ROUNDS = 10
"""Rounds of mask, search and covariance, at most; numerical."""
SETTLED = 0.002
"""Share of the cells by which the mask may still change from one round to the next; numerical."""
STILL = 0.01
"""Part of the range of a shape value by which it may still move from one round to the next: each is refined anew about where it stands, and never comes
out the same to the last digit; numerical."""


@dataclass(frozen=True, slots=True)
class Searched:
    """What the search chose, without the flanks of some sides.

    Parameters
    ----------
    sound : (m,) bool
        Cells that a fit may use.
    fit, problem : Fit, Problem
        As the search left them.
    model : Model
    """

    sound: Bools
    fit: Fit
    problem: Problem
    model: Model


def close_loop(
    cells: Cells,
    noise: float,
    context: Context,
    effects: tuple[Effect, ...] | None = None,
    root_free: bool = False,
    worn: frozenset[Side] | None = None,
    out: Bools | None = None,
    begun: Loop | None = None,
    ruled_out: frozenset[frozenset[Side]] = frozenset(),
    look: bool = False,
    in_space: tuple[SpaceWave, ...] | None = None,
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
    effects : tuple of Effect or None
        None: the whole catalogue.
    root_free : bool
        True where the root is not the design's: it is whatever it is then, and no evidence.
    worn : frozenset of Side or None
        Sides that are known to be worn throughout; None: the scan decides.
    out : (m,) bool or None
        Cells that a look at fewer cells left out because they look worn (`left_out`): the search begins without them.
    begun : Loop or None
        What was found before the scan was located again: the search begins with its effects as well as with none.
    ruled_out : frozenset of frozenset of Side
        Sides that a first look showed not to be worn throughout together (`Loop.sides_ruled_out`).
    look : bool
        Whether this is a first look.
    in_space : tuple of SpaceWave or None
        Waves in space that are known; None: they are looked for in what the effects leave, and where there are some, the effects once more without them.

    Returns
    -------
    Loop
        Of the cheapest hypothesis; `others` are those that cost no more than chance beyond it.
    """
    closed = partial(_closed, cells, noise, context, effects, root_free, worn, out, begun, ruled_out, look)
    known = _of_waves(in_space or (), cells)
    loop, finished = closed(known)
    if in_space is None:
        known = _of_waves(find_space_waves(cells.with_deviation(loop.residual_after), noise), cells)
        loop, finished = closed(known) if known else (loop, finished)
    for _ in range(rules().most_patterns):
        # What goes round the gear drowns which sides are worn: once more without it. Not where a form of all teeth larger than the noise decides that.
        waves = _unlike(loop.patterns)
        if len(waves) == len(known) or any(pattern.is_form(noise) for pattern in loop.patterns):
            break
        known, (loop, finished) = waves, closed(waves)
    result = finished()
    told = {round(one.candidate.shape[0]) - 1 for one in (*result.form, *result.effects) if one.name == BENT_TOOTH}
    bent = tuple(one for one in result.context.bent if one.tooth in told)
    if bent == result.context.bent:
        return result
    # A tooth that is none of these has an index like the others, and its flanks may be worn.
    return close_loop(cells, noise, replace(context, bent=bent), effects, root_free, worn, out, begun, ruled_out, look, in_space)


def _closed(
    cells: Cells,
    noise: float,
    context: Context,
    effects: tuple[Effect, ...] | None,
    root_free: bool,
    worn: frozenset[Side] | None,
    out: Bools | None,
    begun: Loop | None,
    ruled_out: frozenset[frozenset[Side]],
    look: bool,
    waves: tuple[Pattern, ...],
) -> tuple[Loop, Callable[[], Loop]]:
    """`close_loop` beside patterns that are known: the cheapest hypothesis, and what makes of it the loop with all that the scan does not exclude. Of a
    loop that is closed again without what it shows, nobody asks for those."""
    every = tuple(effect for effect in catalogue() if effect.searched) if effects is None else effects
    made = tuple(effect for effect in every if effect.kind is not Kind.WEAR)
    always = frozenset({ROOT_FORM}) if root_free else frozenset[str]()
    if context.bent and all(effect.name != BENT_TOOTH for effect in made):
        context = replace(context, bent=())
    if context.bent:
        always |= {BENT_TOOTH}

    apart = np.zeros(len(cells.count), dtype=np.bool_)

    context, alone = _with_margins(context, cells, worn)
    if context.faces:
        always |= {FACE_LEVEL}
    if len(context.faces) == len(Side):  # how thick the teeth were cut is in these levels, and fillets tell no more of it
        always |= {ROOT_FORM}
        made = tuple(effect for effect in made if effect.group != LEVEL_GROUP or effect.kind is not Kind.MANUFACTURE)

    every_candidate = build_dictionary(cells, made, context)

    def searched_without(sides: frozenset[Side]) -> Searched:
        without = replace(context, worn=sides, pitch=costs.pitch.get(sides, context.pitch))
        dictionary = with_worn(every_candidate, cells, without) if sides else every_candidate
        return _first_search(cells, noise, without, dictionary, always, out, apart, begun, waves)

    costs, ran = SideCosts({alone: 0.0}), context.ran
    bare, unheld = without_a_datum(cells, context), NO_SIDE
    plain = searched_without(alone)
    low = worn_flanks(plain.fit, plain.model, plain.sound, noise)
    if _still_in(plain, low):
        apart = cells.grid.on_flanks(low)
        plain = searched_without(alone)
    if worn is None and len(ran) < len(Side):  # whether a side is worn throughout the others tell
        told = cells.grid.on_flanks(low)
        for face in context.faces:
            told |= (cells.points.surface <= FILLET) & face.worn(cells.points, cells.grid.row_height)
        others_alone = replace(plain.fit, cells=cells.without(told)) if told.any() else plain.fit
        silent = not_to_be_asked(cells, bare)
        if silent != HYPOTHESES:
            costs = side_costs(others_alone, plain.problem, plain.model, noise, ruled_out | silent, look).beside(ran)
        costs = replace(costs, bends=sides_of(choose_datum(cells, noise).worn_side))
        unheld = frozenset().union(*(bare & {*silent, costs.chosen, *costs.not_excluded})) & sides_seen(cells)

    def explained(sides: frozenset[Side]) -> Loop:
        loop = _explained(plain if sides == alone else searched_without(sides), noise, always, waves)
        return with_untold(replace(loop, worn_flanks=low if apart.any() else None), cells)

    tenable = costs.without(bare)
    taken = explained(tenable.chosen)
    flanks = cells.points.take(cells.seen & (cells.points.surface == FLANK))
    refuted = worn is None and not ran and _refuted(taken, cells, flanks)
    if refuted and frozenset(Side) in bare:
        refuted, unheld = False, frozenset(Side)
    if refuted:
        taken = explained(frozenset(Side))
    unheld -= taken.worn_sides

    def finished() -> Loop:
        not_excluded = tenable.not_excluded
        both = frozenset(Side)
        # Reliefs that meet are none of a worn side's other: it may have lost as much.
        if len(taken.worn_sides) == 1 and both in tenable.by_sides and both not in not_excluded:
            meet = reliefs_meet(tuple(effect.candidate for effect in (*taken.effects, *taken.form)), context.gear)
            not_excluded += (both,) if meet else ()
        others = () if refuted else tuple(explained(sides) for sides in not_excluded)
        named = tuple(_or_wear(effect, taken, others, flanks) for effect in taken.effects)
        named = or_worn(named, unheld, cells, taken.context)
        if any(effect.name == EDGE_ROUNDING and max(effect.candidate.shape) > cells.grid.size for effect in named):
            named = tuple(or_smoothing(effect) for effect in named)
        whole = replace(taken, effects=named, others=others, no_datum=unheld)
        if refuted or unheld or apart.any():
            return whole
        return replace(whole, sides_sure=costs.beyond_doubt, sides_ruled_out=costs.ruled_out)

    return taken, finished


def _with_margins(context: Context, cells: Cells, worn: frozenset[Side] | None) -> tuple[Context, frozenset[Side]]:
    """What of the sides `worn`, or that show where their mate ran, the cells show beside it; and the sides that are left out all over."""
    faces = tuple(face for face in context.faces if worn is None or face.side in worn)
    shown = tuple(face for face in faces if face.margins(cells).any())
    sides = frozenset(face.side for face in faces) | (worn or NO_SIDE)
    return replace(context, faces=shown), sides - {face.side for face in shown}


def or_smoothing(effect: FoundEffect) -> FoundEffect:
    """The effect, of a scan that software smoothed, as is told by edges rounded over more than a cell, which no spot does: it bent the flanks with them.
    Level, scale and what every tooth has of its own are told all the same; a form is not."""
    known = effect.candidate.effect
    form = known.group == FORM_GROUP or (known.kind is Kind.MANUFACTURE and known.group != LEVEL_GROUP)
    if not form or known.tooth_specific:
        return effect
    return effect.or_one_of({EDGE_ROUNDING})


def _refuted(loop: Loop, cells: Cells, flanks: SurfacePoints) -> bool:
    """Whether the side that is worn stands proud of the thin teeth that the other side shows: at the pitch point, where nothing slides.

    Metal does not come back: then the other side has lost it alone, and both are worn.
    """
    if len(loop.worn_sides) != 1:
        return False
    (side,) = loop.worn_sides
    grid, left = cells.grid, np.where(cells.seen, loop.residual_after, np.nan)
    at_pitch_point = grid.flank_shape(left)[:, side.index, :, int(grid.flank_column(loop.context.pitch_roll))]
    if not np.isfinite(at_pitch_point).any():
        return False
    proud, thinner = float(np.nanmedian(at_pitch_point)), loop.thinner_by(flanks)
    return thinner > 0.0 and proud > max(rules().proud * thinner, rules().errors * loop.level_std[side.index])


def _or_wear(effect: FoundEffect, taken: Loop, others: tuple[Loop, ...], flanks: SurfacePoints) -> FoundEffect:
    """The effect, with wear among its alternatives: where it is not needed once more sides are worn, and that is not excluded, or it looks as the wear of
    coast flanks does beside a worn side; and an even loss where it lowers all flanks."""
    worn = set()
    if len(taken.worn_sides) == 1 and effect.candidate.effect.like_coast_wear:
        worn.add(SLIDING_WEAR)
    if effect.kind is not Kind.FORM:
        for other in others:
            if other.worn_sides > taken.worn_sides and effect.name not in (named.name for named in other.effects):
                worn.add(SLIDING_WEAR)
    like_wear = effect.candidate.effect.like_even_wear(effect.amplitudes, effect.candidate.shape, taken.context)
    lowers = effect.lowers_by(flanks, taken.context) > 0.0 and not taken.context.faces  # what no mate touched is as low
    if effect.kind is Kind.MANUFACTURE and (like_wear or lowers):
        worn.add(ABRASIVE_WEAR)
    return effect.or_one_of(worn)


def _still_in(searched: Searched, flanks: Bools) -> bool:
    """Whether a search rests on more than half of one of some flanks, (teeth, 2)."""
    grid = searched.fit.cells.grid
    sound, used = (grid.flank_shape(which).sum(axis=(2, 3)) for which in (searched.sound, searched.sound & searched.fit.use))
    return bool((flanks & (2 * used > sound)).any())


def _first_search(
    cells: Cells,
    noise: float,
    context: Context,
    dictionary: Dictionary,
    always: frozenset[str],
    out: Bools | None,
    apart: Bools,
    begun: Loop | None,
    waves: tuple[Pattern, ...],
) -> Searched:
    """The search from nothing, in what is left beside `waves`; the flanks of sides worn throughout are left out, and those `apart`."""
    target = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0) - _sum(waves, len(cells.count))
    sound = sound_cells(cells, context.worn, context.fillets_told, context.faces) & ~rounded_ends(cells, noise) & ~apart
    step, texture = rules().first_correlation, (rules().first_correlation * noise) ** 2
    white = CellCovariance(cells.grid, noise**2 / np.maximum(cells.count, 1.0), texture, step, step)
    fit = Fit(cells, target, dictionary, sound, white)
    first = fit if out is None else replace(fit, use=sound & ~out)
    return Searched(sound, *_search(fit, _unexplained(first, context), noise, context, always, out, begun))


def _of_waves(waves: tuple[SpaceWave, ...], cells: Cells) -> tuple[Pattern, ...]:
    return tuple(Pattern.of_wave(cells, wave) for wave in waves)


def _sum(patterns: tuple[Pattern, ...], cells: int) -> Floats:
    """Of their fields, (cells,) mm."""
    return np.asarray(sum((pattern.field for pattern in patterns), np.zeros(cells)), dtype=np.float64)


def _unlike(patterns: tuple[Pattern, ...]) -> tuple[Pattern, ...]:
    """Those that are another on every tooth."""
    return tuple(pattern for pattern in patterns if not pattern.of_all_teeth)


def _explained(searched: Searched, noise: float, always: frozenset[str], known: tuple[Pattern, ...]) -> Loop:
    """What of a search may be named, beside patterns that are known and not in its target."""
    fit, problem, model, context = searched.fit, searched.problem, searched.model, searched.problem.context
    target = fit.target
    stood = eliminate(fit, problem, model, noise, known)
    waves = _unlike(stood.patterns)
    if len(waves) > len(known):
        # A wave round the gear drowns what is left out tooth by tooth: once more without it.
        new = _sum(waves, len(target)) - _sum(known, len(target))
        fit = replace(fit, target=np.where(fit.cells.seen, target - new, 0.0), use=searched.sound)
        fit, problem, model = _search(fit, _unexplained(fit, context), noise, context, always)
        stood = eliminate(fit, problem, model, noise, waves)
        fit = replace(fit, target=target)
    # Where a form of all teeth is left that is larger than the noise, it decides between effects that are nearly alike, and not they themselves.
    form = any(pattern.is_form(noise) for pattern in stood.patterns)
    kept = left_in_the_part(problem, stood.model, form)
    if form:
        kept, instead = of_the_form(fit, problem, kept)
    else:
        instead = or_of_the_form(fit, problem, kept) if context.worn else {}
    kept = told_by_wear(fit, problem, kept)
    if kept != stood.model:
        stood = eliminate(fit, problem, kept, noise, _unlike(stood.patterns))
    if not context.fillets_told:
        fit = _with_fillets(fit, sound_cells(fit.cells, context.worn, faces=context.faces))
        problem = fit.problem(problem.unit, context, always)
    whole = replace(fit, target=fit.target + _sum(known, len(target)))
    loop = account(whole, problem, stood.model, list(stood.evidence), stood.fold, stood.patterns, noise)
    unsized = {effect.name for effect in loop.effects if not effect.is_sized}
    if unsized:  # with all that its ± holds it may be nothing: no cause
        still = tuple(c for c in stood.model if c.name not in unsized)
        stood = eliminate(fit, problem, still, noise, _unlike(stood.patterns))
        loop = account(whole, problem, stood.model, list(stood.evidence), stood.fold, stood.patterns, noise)
    loop = replace(loop, effects=tuple(effect.or_one_of(instead.get(effect.name, ())) for effect in loop.effects))
    # What all teeth share is known from the others, and no texture under the wear of one of them.
    return replace(loop, covariance=estimate_covariance(fit.cells, loop.left, loop.use, noise)) if loop.patterns else loop


def _unexplained(fit: Fit, context: Context) -> Floats:
    """What the pose leaves, without what the teeth bent show at a first look: no flank of theirs is worn nor torn for that."""
    if not context.bent:
        return fit.pose_residual()
    seen, moved = fit.cells.seen, np.zeros(len(fit.target))
    moved[seen] = BEND.first_look(fit.cells.points.take(seen), context)
    return replace(fit, target=fit.target - moved).pose_residual()


def _with_fillets(fit: Fit, sound: Bools) -> Fit:
    """The fit with the fillets that were left out as no evidence, at a weight that moves nothing else: how they stand is still to be told."""
    fillets = sound & (fit.cells.points.surface == FILLET)
    known = fit.covariance
    white = np.where(fillets, NO_EVIDENCE * (known.white + known.texture), known.white)
    return replace(fit, use=fit.use | fillets, covariance=replace(known, white=white))


def _search(
    fit: Fit,
    residual: Floats,
    noise: float,
    context: Context,
    always: frozenset[str],
    out: Bools | None = None,
    begun: Loop | None = None,
) -> tuple[Fit, Problem, Model]:
    """Forward to the floor and exchange, with mask, shapes and covariance renewed round by round."""
    sound, unit, plain = fit.use, rules().first_unit, residual
    model: Model = ()
    polished: tuple[Model, Bools] | None = None  # what no exchange was found for, and on which cells
    for round_ in range(MOST_ROUNDS):
        caution, last = rules().caution[min(round_, len(rules().caution) - 1)], fit.use
        worn = worn_mask(fit.cells, residual, noise, caution)
        if round_ == 0 and out is not None:
            worn |= out
        for face in context.faces:  # no mate touched them: where they stand is what is to be found
            worn &= ~face.margins(fit.cells)
        if any(candidate.effect.tooth_specific for candidate in model):
            worn |= whole_flanks(fit.cells, plain, worn & sound, sound)
        use = sound & ~worn & not_stray(residual, sound)
        fit = Fit(fit.cells, fit.target, fit.dictionary, use, fit.covariance)
        before = model
        problem = fit.problem(unit, context, always)
        model = problem.with_known(model)
        if round_ < 2:
            model = _searched(problem, model, _as_begun(problem, begun) if round_ == 0 else ())
        else:
            model = exchange(problem, model)
        dictionary, model = refine_shapes(problem, model, fit.cells, fit.target, use, fit.covariance)
        alike = polished is not None and _same(model, polished[0], context) and _settled(use, polished[1], sound)
        if round_ >= 1 and not alike:
            if dictionary is not fit.dictionary:
                problem = replace(fit, dictionary=dictionary).problem(unit, context, always, problem.gram)
            start = model
            dictionary, model = polish(problem, model, fit.cells, fit.target, use, fit.covariance)
            polished = (model, use) if model is start else None
        fit = Fit(fit.cells, fit.target, dictionary, use, fit.covariance)
        residual = fit.residual(model)
        covariance = estimate_covariance(fit.cells, residual, use, noise)
        unit = design_unit(dictionary, use, covariance)
        fit = Fit(fit.cells, fit.target, dictionary, use, covariance)
        # A freedom for every tooth takes its share of a worn flank until all of that is masked.
        if round_ >= 2 and _settled(use, last, sound) and _same(model, before, context):
            break
    return fit, fit.problem(unit, context, always), model


def _settled(use: Bools, last: Bools, sound: Bools) -> bool:
    """Whether the mask has hardly changed."""
    return float((use != last).sum()) < SETTLED * float(sound.sum())


def _same(model: Model, before: Model, context: Context) -> bool:
    """Whether two models have the same effects, at shapes that are the same but for a small part of the range in which each is refined."""
    if [c.name for c in model] != [c.name for c in before]:
        return False
    for new, old in zip(model, before, strict=True):
        ranges = old.effect.bracket(old.shape, context)
        nearly = [abs(a - b) <= STILL * (high - low) for a, b, (low, high) in zip(new.shape, old.shape, ranges, strict=False)]
        if not all(nearly) or new.shape[len(ranges) :] != old.shape[len(ranges) :]:
            return False
    return True


def _searched(problem: Problem, model: Model, begun: Model = ()) -> Model:
    """Forward and exchange from a model, and from that with every surface's own offset: a scale, once it is in for two of these, is hard to get rid
    of. And from what was found before. The cheapest of these."""
    wide = problem.with_offsets(model)
    starts = [model, *(start for start in (wide, begun) if len(start) > len(model))]
    return min((exchange(problem, forward(problem, start)) for start in starts), key=problem.cost)


def _as_begun(problem: Problem, begun: Loop | None) -> Model:
    """The effects that were found before, each at the shape next to the one it had, and what is known to be there."""
    model = list[Candidate]()
    for one in (*begun.form, *begun.effects) if begun is not None else ():
        alike = [candidate for candidate in problem.dictionary.candidates if candidate.name == one.name]
        if alike:
            model.append(min(alike, key=lambda candidate: _apart(candidate, one.candidate, problem.context)))
    return problem.with_known(tuple(model)) if model else ()


def _apart(one: Candidate, two: Candidate, context: Context) -> float:
    """How far the shapes of two candidates of an effect lie apart, in the ranges in which each is refined; what is no range is the same or not."""
    ranges = one.effect.bracket(one.shape, context)
    steps = [abs(a - b) / max(high - low, 1e-12) for a, b, (low, high) in zip(one.shape, two.shape, ranges, strict=False)]
    return sum(steps) + sum(a != b for a, b in zip(one.shape[len(ranges) :], two.shape[len(ranges) :], strict=False))


def make_context(
    cells: Cells, scan_axes: Floats, planar: bool, mate: tuple[float, float] | None = None, scale_limit: float | None = None
) -> Context:
    """What the effects may need to know of a scan; see `Context`."""
    seen = cells.points.surface[cells.seen]
    present = frozenset(code for code in (FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE) if (seen == code).sum() >= 3)
    rows = 0.0 if planar else cells.grid.row_height
    limit = SCALE_LIMIT if scale_limit is None else scale_limit
    edges = tuple(cells.fillet_edges.tolist())
    tips = cells.points.deviation[cells.seen & (cells.points.surface == TIP)]
    shift = min(float(np.median(tips)), 0.0) if len(tips) else 0.0
    return Context(
        gear=cells.grid.gear, surfaces=present, scan_axes=scan_axes, planar=planar, mate=mate, row_height=rows, scale_limit=limit,
        fillet_edges=edges, tip_shift=shift, faces=active_faces(cells), bent=bent_teeth(cells),
    )  # fmt: skip


__all__ = ["FoundEffect", "Loop", "close_loop", "make_context", "or_smoothing"]
