"""From what the search chose to what may be named: one effect after the other is dropped until all that remain stand."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Ints
from gearwear.design.surface import TIP
from gearwear.diagnose.among_orders import hidden_among_orders
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.judge import Evidence, judge, with_levels
from gearwear.diagnose.masks import folds
from gearwear.diagnose.pattern import Pattern, along_face, find_patterns, joined, order_share
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem


@dataclass(frozen=True, slots=True)
class Stood:
    """What remained.

    Parameters
    ----------
    model : Model
        The effects that are told; those that are `Evidence.faint` may not be named.
    evidence : tuple of Evidence
        One per effect.
    fold : (m,) int
        Folds they were judged by.
    patterns : tuple of Pattern
        What no effect explains, known before and found now.
    """

    model: Model
    evidence: tuple[Evidence, ...]
    fold: Ints
    patterns: tuple[Pattern, ...]


ORDERS_OF_A_PART = 2
"""Waves round the gear that a half or a quarter of it, alone, mostly consists of: order 1 has 0.64 and 0.45 of its height, order 3 0.21 and 0.15."""


def eliminate(fit: Fit, problem: Problem, model: Model, noise: float, known: tuple[Pattern, ...] = ()) -> Stood:
    """Drop the effects that do not stand, the weakest first, and judge the others again each time.

    Parameters
    ----------
    fit, problem : Fit, Problem
        As the search left them.
    model : Model
        The effects it chose.
    noise : float
        Scatter of points, mm.
    known : tuple of Pattern
        What was found before and is no longer in the target of `fit`.
    """
    by_tooth, by_block = folds(fit.cells)
    # A view out of scale is a scale and waves of the lowest orders; more waves round the gear belong to no part of it.
    pieces = [pattern.field for pattern in known if pattern.order is not None and pattern.order <= ORDERS_OF_A_PART]
    whole = replace(fit, target=fit.target + np.sum(pieces, axis=0)) if pieces else fit
    forms = [pattern.field for pattern in known if pattern.order is not None]
    waves = replace(fit, target=fit.target + np.sum(forms, axis=0)) if forms else fit
    pieces_of: tuple[Pattern, ...] | None = None
    while True:
        specific = any(c.effect.tooth_specific for c in model)
        fold, apart = (by_block, _apart_by_teeth(fit, model)) if specific else (by_tooth, [None for _ in model])
        folded = fit.folded(model, fold)
        evidence = [judge(problem, model, i, fit.use, fit.covariance, folded, noise, apart[i]) for i in range(len(model))]
        kept = [c.name in problem.always for c in model]
        worst = _worst(evidence, kept)
        if worst is None and pieces_of is None:
            cancelled = _without_cancelled(problem, model, evidence, kept)
            if cancelled is not None:
                model = cancelled
                continue
            worst = _taken_back_by_teeth(fit, problem, model, evidence, kept)
            worst = _most_uneven(whole, problem, model) if worst is None else worst
            worst = hidden_among_orders(waves, problem, model) if worst is None else worst
        if worst is None:
            patterns = joined(fit.cells.grid, known + find_patterns(fit.cells.grid, fit.residual(model), fit.use, noise))
            # What the whole model leaves: an effect that is dropped as a piece of that makes it larger, which speaks against no other.
            pieces_of = patterns if pieces_of is None else pieces_of
            worst = _makeshift(fit, problem, model, evidence, kept, pieces_of)
        if worst is None:
            return Stood(model, tuple(evidence), fold, patterns)
        model = model[:worst] + model[worst + 1 :]


def _apart_by_teeth(fit: Fit, model: Model) -> list[tuple[float, float] | None]:
    """How far teeth differ in each effect that all have in common; None of the others, and where few teeth were seen."""
    seen = np.unique(fit.cells.points.tooth[fit.use & (fit.cells.points.surface <= TIP)])
    told = len(seen) >= rules().folds_of_teeth // 2
    return [
        one if told and not c.effect.tooth_specific else None for one, c in zip(fit.apart_by_teeth(model), model, strict=True)
    ]


def _worst(evidence: list[Evidence], kept: list[bool]) -> int | None:
    """The effect that fails most clearly; None where all stand."""
    failed = [i for i, e in enumerate(evidence) if not (e.accepted or e.faint or kept[i])]
    if not failed:
        return None
    return max(failed, key=lambda i: evidence[i].p_value + (1.0 if evidence[i].held_out_gain <= 0.0 else 0.0))


def _without_cancelled(problem: Problem, model: Model, evidence: list[Evidence], kept: list[bool]) -> Model | None:
    """The model without the effect of which others take most back; None where every one explains a fair part of its own size.

    A ripple of one or two waves along the profile comes out as slope, crowning and reliefs of many times its size; tips and ends that lie off the
    drawing, as a coat and the teeth that are thin under it. Levels of the drawing that stand for an effect, within its tolerance, take its place.
    """
    share = np.array([1.0 if known else e.contribution / max(e.size, 1e-12) for e, known in zip(evidence, kept, strict=True)])
    if (share < rules().bent).sum() >= rules().several or (share < rules().cancelled).any():
        worst = int(np.argmin(share))
        return model[:worst] + model[worst + 1 :]
    levels, weight = [c for c in problem.dictionary.offsets if c not in model], float(problem.gram.weight.sum())
    left = [(1.0, model)]
    for i, candidate in enumerate(model):
        if kept[i] or candidate.effect.kind is Kind.FORM:
            continue
        without = with_levels(problem, model[:i] + model[i + 1 :], levels)
        if problem.cost(without) - problem.cost(model) > rules().close:
            continue  # tips, roots and ends that all lie off by the same are a coat, and no chance
        beside = problem.columns(without)
        gain = float(problem.gram.gains(beside, [candidate.columns])[0])
        left.append((math.sqrt(max(gain, 0.0) / weight) / max(evidence[i].size, 1e-12), without))
    least, without = min(left, key=lambda one: one[0])
    return without if least < rules().cancelled else None


def _taken_back_by_teeth(fit: Fit, problem: Problem, model: Model, evidence: list[Evidence], kept: list[bool]) -> int | None:
    """Of an effect and amounts of each tooth that take each other back the one that explains less of its size; None where there are no such.

    Amounts of each tooth give back on its sides whatever goes round the gear, as views out of place, and leave of both a small form that is neither.
    """
    specific = np.array([one.effect.tooth_specific for one in model], dtype=np.bool_)
    shared = ~specific & np.array([one.effect.kind is not Kind.FORM for one in model], dtype=np.bool_)
    if not (specific.any() and shared.any()):
        return None
    amplitudes, _ = problem.gram.solve(problem.columns(model))
    fields = fit.fields(model, amplitudes, range(len(model)))
    product = fields.T @ (fit.weight[:, None] * fields)
    given = product < (rules().left_of_it - 1.0) * np.diag(product)  # [i, j]: of j by i
    pairs = given & given.T & specific[:, None] & shared
    back = pairs.any(axis=0) | pairs.any(axis=1)
    among = [i for i in np.flatnonzero(back).tolist() if not kept[i]]
    return min(among, key=lambda i: evidence[i].contribution / evidence[i].size, default=None)


def _most_uneven(fit: Fit, problem: Problem, model: Model) -> int | None:
    """The effect whose size differs most between halves of the gear; None where all are about even."""
    amplitudes, _ = problem.gram.solve(problem.columns(model))
    shared = [i for i, c in enumerate(model) if not c.effect.tooth_specific and c.effect.kind not in (Kind.WEAR, Kind.FORM)]
    uneven, worst = max(((fit.uneven(model, amplitudes, i), i) for i in shared), default=(0.0, 0))
    return worst if uneven > rules().uneven else None


def _makeshift(
    fit: Fit, problem: Problem, model: Model, evidence: list[Evidence], kept: list[bool], patterns: tuple[Pattern, ...]
) -> int | None:
    """The weakest effect that stands in for a structure no effect explains; None where there is none.

    Where a pattern of some order is left, an effect of the same order that explains less than `makeshift` times as much is a piece of that
    pattern under a wrong name. What the maker cut along the face, a lead or a crowning, is no piece of a form of the profile.
    """
    columns = fit.columns(model)
    amplitudes, _ = problem.gram.solve(problem.columns(model))
    suspects = []
    for i, part in enumerate(fit.parts(model)):
        field = np.where(fit.cells.seen, columns[:, part] @ amplitudes[part], np.nan)
        as_cut = fit.is_cut_along_face(model[i], field)
        for pattern in patterns:
            left = along_face(fit.cells.grid, pattern) if as_cut else pattern.rms
            small = not kept[i] and evidence[i].contribution < rules().makeshift * left
            if small and pattern.order is not None and order_share(fit.cells.grid, field, pattern.order) > rules().own_order:
                suspects.append(i)
    return min(suspects, key=lambda i: evidence[i].contribution) if suspects else None
