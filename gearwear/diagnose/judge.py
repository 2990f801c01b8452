"""Whether an effect that the search chose may be named: corrected evidence, left-out teeth, size; and what could stand in its place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc, stdtrit

from gearwear.arrays import Bools, Floats, Ints
from gearwear.diagnose.covariance import CellCovariance, effective_number
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem, penalty


@dataclass(frozen=True, slots=True)
class Evidence:
    """Why an effect was accepted or not.

    Parameters
    ----------
    statistic : float
        F of its amplitudes under the correlated covariance.
    degrees : (float, float)
        Of freedom.
    effective_number : float
        Independent observations its own pattern amounts to.
    p_value : float
        Corrected for all candidates tried.
    held_out_gain, held_out_error : float
        Mean fall of the left-out mean square per fold in µm², and its standard error.
    shown, shown_error : float
        How much of what the others predict of the effect the left-out show: 1 where it is there, and its standard error.
    contribution : float
        Root mean square of what it explains that the others of the model cannot, mm.
    size : float
        Root mean square of the effect itself, mm, less what a pose takes up.
    accepted : bool
    faint : bool
        Whether it is told, but too small or not surely enough to be named; of a freedom, tooth by tooth or of the drawing, never.
    taken_back : bool
        Whether other effects of the model take back most of it.
    """

    statistic: float
    degrees: tuple[float, float]
    effective_number: float
    p_value: float
    held_out_gain: float
    held_out_error: float
    shown: float
    shown_error: float
    contribution: float
    size: float
    accepted: bool
    faint: bool = False
    taken_back: bool = False


def sandwich(columns: Floats, use: Bools, covariance: CellCovariance, inverse: Floats) -> Floats:
    """Covariance of fitted amplitudes: A⁻¹ XᵀWΣWX A⁻¹, with Σ the correlated covariance of the cells."""
    weighted = np.where(use[:, None], columns * covariance.weight[:, None], 0.0)
    meat = weighted.T @ covariance.apply(weighted)
    return np.asarray(inverse @ meat @ inverse, dtype=np.float64)


def judge(
    problem: Problem,
    chosen: tuple[Candidate, ...],
    index: int,
    use: Bools,
    covariance: CellCovariance,
    folded: Gram,
    noise: float,
    by_teeth: tuple[float, float] | None = None,
) -> Evidence:
    """Judge one of the chosen effects with all the others in place.

    Parameters
    ----------
    problem : Problem
        Dictionary and statistics.
    chosen : tuple of Candidate
        The model.
    index : int
        Which of them.
    use : (m,) bool
        Cells in the fit.
    covariance : CellCovariance
        Estimated with the effect in the model (else it would count as its own noise).
    folded : Gram
        Statistics of the model's columns alone, by folds: teeth; staggered blocks where the model holds an effect that a left-out
        tooth cannot predict.
    noise : float
        Scatter of points, mm.
    by_teeth : (float, float) or None
        Standard error of its size, in that size, from what teeth differ in it, and on how many that rests (`Fit.apart_by_teeth`); None where `folded` tells, by teeth, or each tooth has
        an amount of its own.
    """
    candidate = chosen[index]
    rest = chosen[:index] + chosen[index + 1 :]
    which, without = problem.columns(chosen), problem.columns(rest)
    amplitudes, inverse = problem.gram.solve(which)
    spread = sandwich(problem.dictionary.take(which), use, covariance, inverse)
    at = _positions(problem, chosen, index)
    own = amplitudes[at]
    q = len(at) + len(candidate.shape)
    wald = float(own @ np.linalg.pinv(spread[np.ix_(at, at)]) @ own)
    pattern = problem.dictionary.take(candidate.columns) @ own
    number = effective_number(pattern, covariance, use)
    freedom = max(number - len(which), 1.0)
    tried = len(problem.dictionary.candidates)
    p_value = min(1.0, tried * float(fdtrc(q, freedom, max(wald / q, 0.0))))
    left_out = _left_out(folded, at)
    error, units = (left_out.share_error / max(left_out.share, 1e-12), left_out.number) if by_teeth is None else by_teeth
    fall = problem.gram.residual_square(without) - problem.gram.residual_square(which)
    contribution = math.sqrt(max(fall, 0.0) / float(problem.gram.weight.sum()))
    least = rules().least_share * noise
    # Once others are gone it may have turned into what it cannot be: a relief that adds metal.
    allowed = candidate.effect.allowed(own, candidate.shape, problem.context)
    second_order = contribution <= rules().least_of_largest * _largest(problem, chosen)
    # At half of it the left-out are explained no better with the effect than without.
    likely = left_out.share > 0.5 and allowed and not second_order
    told = likely and p_value < rules().significance and beyond_chance(units, 1) * error < 1.0
    sure = likely and p_value < rules().significance_of_names and beyond_chance(units, tried) * error < 1.0
    accepted = sure and contribution > least
    freedom_of_many = candidate.effect.tooth_specific or candidate.effect.kind is Kind.FORM
    return Evidence(
        statistic=wald / q,
        degrees=(q, freedom),
        effective_number=number,
        p_value=p_value,
        held_out_gain=left_out.gain,
        held_out_error=left_out.gain_error,
        shown=left_out.share,
        shown_error=left_out.share_error,
        contribution=contribution,
        size=_size(problem, candidate, own),
        accepted=accepted,
        faint=told and not accepted and not freedom_of_many,
    )


@dataclass(frozen=True, slots=True)
class _LeftOut:
    """What left-out folds show of an effect: as `Evidence`."""

    gain: float
    gain_error: float
    share: float
    share_error: float
    number: int


def beyond_chance(number: float, asked: int) -> float:
    """Standard errors, told by what so many units differ in, that a mean of theirs exceeds by chance in one of `asked` questions (Student, Bonferroni)."""
    return float(stdtrit(max(number - 1.0, 0.5), 1.0 - min(rules().significance / asked, 0.5)))


def of_units(parts: Floats, number: float) -> float:
    """Standard error of a sum from its parts by so many independent units, of which the expected sum is taken off."""
    return math.sqrt(number / max(number - 1.0, 0.5) * float(parts @ parts))


def _left_out(folded: Gram, own: Ints) -> _LeftOut:
    """What left-out folds show of the effect that has some of the model's columns for its own.

    Notes
    -----
    The other folds predict a field of the effect on each, f; s is what that fold's residual without the effect has along it, ``f · r / f · f``. The mean
    weighted by f · f is the share shown. Its standard error comes from what the folds differ in s: an effect that is large on some teeth and
    small on others, as a drift is on both hands of its jump, is no worse known for that; of one bad tooth that the rest say nothing of, s is 0.
    """
    every = np.arange(folded.moment.shape[1])
    rest = np.setdiff1d(every, own)
    predicted, along = (np.zeros(len(folded.square)) for _ in range(2))
    for fold in range(len(folded.square)):
        step, without = folded.solve(every, without=fold)[0], folded.solve(rest, without=fold)[0]
        step[rest] -= without
        information = folded.information[fold]
        predicted[fold] = step @ information @ step
        along[fold] = step @ (folded.moment[fold] - information[:, rest] @ without)
    seen = folded.weight > 0.0
    predicted, along, weight = predicted[seen], along[seen], folded.weight[seen]
    number, total = len(weight), max(float(predicted.sum()), 1e-300)
    share = float(along.sum()) / total
    error = of_units(along - share * predicted, number) / total
    mean = 1e6 * predicted / weight
    gain = float((1e6 * (2.0 * along - predicted) / weight).mean())
    return _LeftOut(gain, 2.0 * error * float(mean.mean()), share, error, number)


def _largest(problem: Problem, chosen: tuple[Candidate, ...]) -> float:
    """Root mean square of what the whole model explains, mm: no less than its largest effect."""
    pose = problem.gram.residual_square(problem.columns(()))
    whole = problem.gram.residual_square(problem.columns(chosen))
    return math.sqrt(max(pose - whole, 0.0) / float(problem.gram.weight.sum()))


def _size(problem: Problem, candidate: Candidate, amplitudes: Floats) -> float:
    """Root mean square of an effect on the cells, mm, pose refitted."""
    pose, own = problem.dictionary.pose, candidate.columns
    information = problem.gram.information.sum(axis=0)
    _, inverse = problem.gram.solve(pose)
    cross = information[np.ix_(own, pose)]
    left = information[np.ix_(own, own)] - cross @ inverse @ cross.T
    return math.sqrt(max(float(amplitudes @ left @ amplitudes), 0.0) / float(problem.gram.weight.sum()))


def _positions(problem: Problem, chosen: tuple[Candidate, ...], index: int) -> Ints:
    """Where the amplitudes of one chosen effect stand among those of the fit."""
    start = len(problem.dictionary.pose) + sum(len(c.columns) for c in chosen[:index])
    return np.arange(start, start + len(chosen[index].columns))


def alternatives(problem: Problem, chosen: tuple[Candidate, ...], index: int) -> tuple[str, ...]:
    """Names of effects that would explain the same about as well in this one's place.

    As well is: at no more than `close` of cost, with whatever levels the drawing leaves open put in that help; or at least `same` of what
    it explains. With them in its place the effect itself has less than half left to explain: anything cheap would else stand beside an effect
    that hardly pays for its parameters, as pitch errors tooth by tooth.
    """
    found = {candidate.name for candidate, _ in replacements(problem, chosen, index)}
    others = alike(problem, chosen, index) + smooth_parts(problem, chosen, index) + by_tooth(problem, chosen, index)
    return tuple(sorted(found | {candidate.name for candidate in others}))


def alike(problem: Problem, chosen: tuple[Candidate, ...], index: int) -> list[Candidate]:
    """Candidates that explain at least `same` of what this one does in its place, and need not many parameters more."""
    rest, own = chosen[:index] + chosen[index + 1 :], chosen[index]
    names = {c.name for c in chosen}
    others = [c for c in problem.dictionary.candidates if c.name not in names and c.effect.kind is not Kind.FORM]
    gains = problem.gram.gains(problem.columns(rest), [own.columns] + [c.columns for c in others])
    found = []
    for gain, candidate in zip(gains[1:], others, strict=True):
        extra = len(candidate.columns) + len(candidate.shape) - len(own.columns) - len(own.shape)
        # Many parameters can imitate anything: an alternative must not need more than a few beyond the named effect's.
        enough = gain >= rules().same * gains[0] and extra <= rules().more_parameters
        if enough and math.isfinite(problem.cost((*rest, candidate))) and _takes(problem, (*rest, candidate), own, gains[0]):
            found.append(candidate)
    return found


def smooth_parts(problem: Problem, chosen: tuple[Candidate, ...], index: int) -> list[Candidate]:
    """Measurement effects of few parameters that most of an effect tooth by tooth may be: a wave round the revolution is the table's, or the gear's.

    Beside the effect they explain nothing; in its place at least half of what it does, and by more than the same number of directions taken by chance
    would: of q among m by F = (t / q) / ((g − t) / (m − q)), where t is what they take of its gain g.
    """
    own = chosen[index]
    if not own.effect.tooth_specific:
        return []
    rest, names, most = chosen[:index] + chosen[index + 1 :], {c.name for c in chosen}, len(own.columns)
    others = [
        c
        for c in problem.dictionary.candidates
        if c.name not in names and c.effect.kind is Kind.MEASUREMENT and len(c.columns) + len(c.shape) < most
    ]
    columns = [c.columns for c in others]
    whole, *alone = problem.gram.gains(problem.columns(rest), [own.columns, *columns])
    found = []
    for candidate, gain, beside in zip(others, alone, problem.gram.gains(problem.columns(chosen), columns), strict=True):
        taken, free = min(float(gain - beside), float(whole)), len(candidate.columns)
        ratio = taken / free / max((whole - taken) / (most - free), 1e-300)
        by_chance = len(others) * float(fdtrc(free, most - free, max(ratio, 0.0)))
        enough = taken > (1.0 - rules().stands_in) * whole and by_chance < rules().significance
        if enough and math.isfinite(problem.cost((*rest, candidate))):
            found.append(candidate)
    return found


def by_tooth(problem: Problem, chosen: tuple[Candidate, ...], index: int) -> list[Candidate]:
    """What the maker may have left on each tooth that explains what a measurement effect does, and all as well: but for what so many parameters explain by
    chance, no more than `close` is lost. A table that is off turns the flanks within a tooth too, and only that tells it from the gear's own index."""
    own = chosen[index]
    if own.effect.tooth_specific or own.effect.kind is not Kind.MEASUREMENT:
        return []
    names = {c.name for c in chosen}
    others = [
        c
        for c in problem.dictionary.candidates
        if c.effect.tooth_specific and c.effect.kind is Kind.MANUFACTURE and c.name not in names
    ]
    rest = chosen[:index] + chosen[index + 1 :]
    gain, *gains = problem.gram.gains(problem.columns(rest), [own.columns, *(c.columns for c in others)])
    found = []
    for candidate, one in zip(others, gains, strict=True):
        lost, instead = float(gain - one) / problem.unit + len(candidate.columns), (*rest, candidate)
        if lost < rules().close and math.isfinite(problem.cost(instead)) and _takes(problem, instead, own, gain):
            found.append(candidate)
    return found


def _takes(problem: Problem, model: tuple[Candidate, ...], effect: Candidate, gain: float) -> bool:
    """Whether a model leaves an effect less than half of what it explains where nothing stands in its place, `gain`."""
    return float(problem.gram.gains(problem.columns(model), [effect.columns])[0]) < rules().stands_in * gain


def replacements(problem: Problem, chosen: tuple[Candidate, ...], index: int) -> list[tuple[Candidate, tuple[Candidate, ...]]]:
    """Candidates that could stand in one's place at about the same cost, each with the model that has it; the cheapest first.

    What a drawing leaves open may come in with it, where the amount is within the tolerance.
    """
    rest = chosen[:index] + chosen[index + 1 :]
    names = {c.name for c in chosen}
    levels = tuple(c for c in problem.dictionary.levels if c.name not in names)
    others = [c for c in problem.dictionary.candidates if c.name not in names and c not in levels]
    wide = (*rest, *levels)
    gains = problem.gram.gains(problem.columns(wide), [chosen[index].columns, *(c.columns for c in others)])
    least, (whole,) = problem.cost(chosen), problem.gram.gains(problem.columns(rest), [chosen[index].columns])
    best: dict[str, tuple[float, Candidate, tuple[Candidate, ...]]] = {}
    near = [
        c
        for c, gain in zip(others, gains[1:], strict=True)
        if (gains[0] - gain) / problem.unit < rules().close + penalty(chosen[index], problem.seen)
    ]
    for candidate in [*near, *levels]:
        model = with_levels(problem, (*rest, candidate), [c for c in levels if c is not candidate])
        cost = problem.cost(model)
        cheaper = cost - least < rules().close and cost < best.get(candidate.name, (math.inf,))[0]
        without = tuple(c for c in model if c is not candidate)  # what the levels alone take is none of the candidate's
        if cheaper and _takes(problem, model, chosen[index], whole) and not _takes(problem, without, chosen[index], whole):
            best[candidate.name] = (cost, candidate, model)
    return [(candidate, model) for _, candidate, model in sorted(best.values(), key=lambda one: one[0])]


def with_levels(problem: Problem, model: tuple[Candidate, ...], levels: list[Candidate]) -> tuple[Candidate, ...]:
    """The model with those levels of the drawing that lower its cost, and lie within the tolerance."""
    cost = problem.cost(model)
    while levels:
        tried = [(problem.cost((*model, one)), i) for i, one in enumerate(levels)]
        least, at = min(tried)
        if not least < cost or not problem.within_tolerance((*model, levels[at])):
            break
        model, cost = (*model, levels[at]), least
        levels = levels[:at] + levels[at + 1 :]
    return model
