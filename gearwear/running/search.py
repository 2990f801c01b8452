"""The search: which effects of running explain what the wear law leaves of a measured map."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.parameter import Role
from gearwear.running.conditions import Runs
from gearwear.running.effects import running_effects
from gearwear.running.effects.base import RoundEffect, RunEffect, conditions_of
from gearwear.running.effects.elastic_sharing import ElasticSharing
from gearwear.running.fit import LawModel, MapFit, MapModel, RunModel, whole_errors
from gearwear.running.found import Errors, FoundRunning, SecondLoop
from gearwear.running.wear_map import WearMap
from gearwear.threads import on_one_thread

PARAMETER_PRICE = 4.0
"""χ² that a number must be worth: two standard deviations."""
ALIKE = 4.0
"""Difference of cost below which two effects cannot be told apart."""
SURE_STDS = 3.0
"""Standard deviations from which on a size is a finding."""
LEAST_FALL = 0.97
"""Error on what was left out, after over before, from which down an effect is kept."""
MOST_SIZES = 2
"""Effects with a size, at most: what a pattern of wear can carry."""
ROUND_SIGNIFICANCE = 0.005
"""Greatest p of a first order among the scatter of the teeth."""
LEAST_ROUND_SHARE = 0.05
"""Least amplitude of a first order, as a share of the mean depth."""
FEWEST_TEETH_ROUND = 7
"""Teeth from which on a first order is looked for."""


@on_one_thread
def find_running(place: WearMap, law_basis: Floats, runs: Runs, alone: Bools) -> SecondLoop:
    """Trace a wear map to how the pair ran.

    Parameters
    ----------
    place : WearMap
    law_basis : (m, 3) float
        The terms of the closed-form law at the places of the map.
    runs : Runs
        Of the same map.
    alone : (m,) bool
        Where one pair carries alone.

    Returns
    -------
    SecondLoop

    Notes
    -----
    Forward search by one cost, χ² + `PARAMETER_PRICE` a number + 2 ln(number of effects) an effect. An effect is kept only if it also lowers the error
    on what was left out of the fit: teeth, parts of the face, double contact. The law stands where no run does better.
    """
    errors, depth = whole_errors(place), place.mean
    every = np.ones(len(depth), dtype=np.bool_)
    tried = [effect for effect in running_effects() if isinstance(effect, RunEffect) and effect.applies(runs)]
    sized = [effect for effect in tried if effect.step > 0.0]
    price = _price(len(tried))

    def fitted(model: MapModel) -> MapFit:
        return model.fit(depth, errors, every)

    def dear(effects: Sequence[RunEffect], fit: MapFit) -> float:
        return fit.cost + price * (1 + len(effects))

    law = LawModel(law_basis)
    by_law = fitted(law)
    law_cost = by_law.cost + PARAMETER_PRICE * float(np.count_nonzero(np.abs(law_basis).max(axis=0)))
    steps = _grown(runs, sized, fitted, dear)
    names = {effect.name: effect for effect in tried}
    before = _errors(law, by_law, place, errors, alone)
    traced, last, last_cost = list[FoundRunning](), before, law_cost
    best = steps[-1]
    kept: RunModel | None = None
    named: list[RunEffect] = []
    alike = {step.effects[-1].name: step.alike for step in steps if step.effects}
    if dear(best.effects, best.fit) < law_cost:
        for step in steps:
            cost = dear(step.effects, step.fit)
            left = _errors(step.model, step.fit, place, errors, alone)
            if not _worth(cost - last_cost, last, left):
                continue
            # Effects of steps that were not worth it by themselves come in with the one that makes them so.
            new = [effect for effect in step.effects if effect not in named] or [names[ElasticSharing.name]]
            named += new
            traced += [
                FoundRunning(
                    effect=effect, parameters={}, alternatives=(*effect.alternatives, *alike.get(effect.name, ())),
                    before=last, after=left, gain=last_cost - cost, degrees=(len(new), math.inf),
                    p_value=_chance(last_cost - cost + price * len(new), len(new)),
                )
                for effect in new
            ]  # fmt: skip
            kept, last, last_cost, best = step.model, left, cost, step
        traced = _sized(traced, best, errors, [effect for effect in sized if effect not in best.effects and effect.doubt > 0.0])
    rounds = [effect for effect in running_effects() if isinstance(effect, RoundEffect)]
    traced += [effect for effect in (_round(effect, place) for effect in rounds) if effect is not None]
    after = by_law if kept is None else best.fit
    ran = runs.usual if kept is None else conditions_of(best.effects, best.fit.sizes, best.model.usual)
    return SecondLoop(
        map=place, effects=tuple(traced), before=before, after=last, law=by_law.depth, depth=after.depth,
        amount=after.amount, chi_square=after.cost, conditions=ran,
    )  # fmt: skip


def _price(tried: int) -> float:
    """χ² that an effect must be worth, chosen among so many."""
    return PARAMETER_PRICE + 2.0 * math.log(max(tried, 2))


def _worth(dearer: float, before: Errors, after: Errors) -> bool:
    """Whether an effect is kept: the cost falls, and the error on what was left out."""
    return dearer < 0.0 and after.held_out < LEAST_FALL * before.held_out


@dataclass(frozen=True, slots=True)
class _Step:
    model: RunModel
    fit: MapFit
    alike: tuple[str, ...]

    @property
    def effects(self) -> tuple[RunEffect, ...]:
        return self.model.effects


def _grown(
    runs: Runs, sized: list[RunEffect], fitted: Callable[[MapModel], MapFit], dear: Callable[[Sequence[RunEffect], MapFit], float]
) -> list[_Step]:
    """Runs with ever more effects, each step the best that can be added, as far as the cost falls."""
    # Sharp corners or none: nobody knows, so that the better of the two counts and the other is part of every ±.
    both = [RunModel(runs, usual=replace(runs.usual, corners=there)) for there in (True, False)]
    first = min((_Step(model, fitted(model), ()) for model in both), key=lambda step: step.fit.cost)
    steps = [first]
    while len(steps) <= MOST_SIZES:
        last = steps[-1]
        near = tuple(round(size / effect.step) for size, effect in zip(last.fit.sizes, last.effects, strict=True))
        starts = [(effect, start) for effect in sized if effect not in last.effects for start in effect.starts(runs.usual)]
        more = [effect for effect, _ in starts]
        models = [replace(last.model, effects=(*last.effects, effect), near=(*near, start)) for effect, start in starts]
        fits = [fitted(model) for model in models]
        if not fits:
            break
        costs = [dear(model.effects, fit) for model, fit in zip(models, fits, strict=True)]
        i = int(np.argmin(costs))
        if not costs[i] < dear(last.effects, last.fit):
            break
        near_best = [effect.name for effect, cost in zip(more, costs, strict=True) if cost < costs[i] + ALIKE]
        alike = tuple(name for name in dict.fromkeys(near_best) if name != more[i].name)
        steps.append(_Step(models[i], fits[i], alike))
    return steps


def _sized(traced: list[FoundRunning], best: _Step, errors: Floats, unnamed: Sequence[RunEffect]) -> list[FoundRunning]:
    """The effects with their sizes, all of them as fitted together in the end; without those that do not stand out from their ±, or from what
    the design states.

    What stands out is judged by the errors and the effects that were named; the ± that is told also holds what effects that were not named
    may do to a size.
    """
    if not best.effects:
        return traced
    covariance = best.model.covariance(best.fit, errors)
    whole = best.model.covariance(best.fit, errors, unnamed)
    result = []
    for named in traced:
        if named.effect not in best.effects or not isinstance(named.effect, RunEffect):
            result.append(named)
            continue
        value, slope = _reported(named.effect, best, ())
        _, slope_of_all = _reported(named.effect, best, unnamed)
        as_stated = named.effect.reported(best.model.usual)
        if abs(value - as_stated) > SURE_STDS * math.sqrt(float(slope @ covariance @ slope)):
            (parameter,) = named.effect.parameters
            spread = math.sqrt(float(slope_of_all @ whole @ slope_of_all))
            result.append(replace(named, parameters={parameter.name: parameter.estimate(value, spread)}))
    return result


def _reported(effect: RunEffect, best: _Step, unnamed: Sequence[RunEffect]) -> tuple[float, Floats]:
    """The size of an effect as it is reported, and how it hangs on the sizes that were searched for and on those of effects not named, (p + u,)."""
    effects = (*best.effects, *unnamed)
    sizes, steps = np.array([*best.fit.sizes, *(0.0 for _ in unnamed)]), np.array([effect.step for effect in effects])

    def at(values: Floats) -> float:
        return effect.reported(conditions_of(effects, tuple(values.tolist()), best.model.usual))

    slope = [(at(sizes + way) - at(sizes - way)) / (2.0 * way.sum()) for way in np.diag(0.01 * steps)]
    return at(sizes), np.array(slope)


def _chance(chi_square: float, degrees: int) -> float:
    from scipy.special import chdtrc

    return float(chdtrc(float(degrees), max(chi_square, 0.0)))


def _errors(model: MapModel, fit: MapFit, place: WearMap, errors: Floats, alone: Bools) -> Errors:
    """What a model leaves, fitted to all, and to a part, of what was left out of it."""
    depth, count = place.mean, len(place.teeth)
    every = np.ones(len(depth), dtype=np.bool_)
    half = np.arange(count) % 2 == 0
    squares = (
        [(model.fit(place.mean_of(a), errors, every).depth - place.mean_of(~a)) ** 2 for a in (half, ~half)] if count > 1 else []
    )
    third = np.minimum(((place.height + 0.5) * 3.0).astype(np.int64), 2)
    across = [(model.fit(depth, errors, third != i).depth - depth)[third == i] ** 2 for i in range(3) if (third == i).any()]
    apart = alone.any() and not alone.all()
    double = model.fit(depth, errors, alone).depth[~alone] - depth[~alone] if apart else np.full(1, np.nan)
    return Errors(
        all=_rms((fit.depth - depth) ** 2),
        teeth=_rms(np.concatenate(squares)) if squares else math.nan,
        face=_rms(np.concatenate(across)),
        double_contact=_rms(double**2),
    )


def _rms(squares: Floats) -> float:
    return math.sqrt(float(np.mean(squares)))


def _round(effect: RoundEffect, place: WearMap) -> FoundRunning | None:
    """A first order round the gear in the teeth's mean depths or leans, against what they scatter by; None where it does not stand out."""
    from scipy.special import fdtrc

    means, leans = place.tooth_means()
    count = len(place.teeth)
    if count < FEWEST_TEETH_ROUND:
        return None
    # A tooth that lost more leans more: only what its depth does not say of its lean is its own.
    values = leans - means * float(leans @ means) / float(means @ means) if effect.leans else means
    angle = place.teeth * place.gear.pitch_angle
    basis = np.column_stack([np.ones(count), np.cos(angle), np.sin(angle)])
    if np.linalg.cond(basis) > 10.0:  # the worn teeth stand side by side
        return None
    inverse = np.linalg.inv(basis.T @ basis)
    size = inverse @ basis.T @ values
    left = values - basis @ size
    freedom = count - 3
    scatter = float(left @ left) / freedom
    about = values - values.mean()
    ratio = (float(about @ about) - float(left @ left)) / 2.0 / max(scatter, 1e-300)
    p_value = float(fdtrc(2.0, freedom, ratio))
    amplitude, direction = math.hypot(size[1], size[2]), math.atan2(size[2], size[1])
    if p_value > ROUND_SIGNIFICANCE or amplitude < LEAST_ROUND_SHARE * float(means.mean()):
        return None
    along = size[1:] / amplitude
    covariance = scatter * inverse[1:, 1:]
    std, across = (math.sqrt(float(v @ covariance @ v)) for v in (along, np.array([-along[1], along[0]])))
    of = {
        parameter.name: parameter.estimate(
            *((amplitude, std) if parameter.role is Role.SIZE else (direction, across / amplitude))
        )
        for parameter in effect.parameters
    }
    leverage = 1.0 - np.einsum("ij,jk,ik->i", basis, inverse, basis)
    nan = math.nan
    return FoundRunning(
        effect=effect, parameters=of, alternatives=effect.alternatives,
        before=Errors(_rms(about**2), _rms((about * count / (count - 1)) ** 2), nan, nan),
        after=Errors(_rms(left**2), _rms((left / leverage) ** 2), nan, nan),
        gain=2.0 * ratio, degrees=(2, float(freedom)), p_value=p_value,
    )  # fmt: skip
