"""Whether the flanks of a side are worn throughout: the gear as made against the gear as worn, by one cost.

What all flanks of a side have in common may have been made so or worn so. Made is what the catalogue has for it, or a profile that the flanks
of a side, or of both, share: a grinding wheel dressed for one side gives it a form of its own. Worn is a loss of the shape that wear has, in which every tooth may have its own
share; against a profile of one side, any loss that is least at the pitch point, where it differs from tooth to tooth or its form is larger than flanks of the gear's
class are cut with: a smaller one that all teeth have alike is as likely made. Profiles and losses alike pay for what they need of their freedom. Each is fitted to the same cells, and no cell is left out for
what it shows: one that a fit cannot explain costs a fixed price, under every hypothesis the same. A mask that follows the fit would let each
hypothesis leave out what speaks against it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from scipy.special import chdtri

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.columns import CellColumns, cuts_among
from gearwear.diagnose.covariance import estimate_covariance
from gearwear.diagnose.dictionary import Dictionary
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.few_cells import leaves_teeth_out, on_few_cells
from gearwear.diagnose.fit import Fit, Model, design_unit
from gearwear.diagnose.flank_columns import (
    any_profile,
    any_wear_columns,
    laws_of_wear,
    loss_by_tooth,
    made_profiles,
    on_each_side,
    on_worn,
    wear_columns,
)
from gearwear.diagnose.flank_forms import FlankForms, SideLoss, WornCost, least_of
from gearwear.diagnose.flanks_differ import differ_more
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.masks import tell_of_wear
from gearwear.diagnose.pitch_point import likeliest
from gearwear.diagnose.robust_fit import SETTLED, Robust, Shares, robust_fit
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Around, Problem, exchange, free_penalty
from gearwear.diagnose.side_costs import NO_SIDE, SideCosts, by_reliefs
from gearwear.processors import each

REMEMBERED = 8
"""Models whose columns are kept; numerical."""

_Law = tuple[frozenset[Side], Floats, Ints]
"""Sides that are worn, losses that they may have, (m, k), and the side of each of these, (k,)."""


def side_costs(
    fit: Fit,
    problem: Problem,
    model: Model,
    noise: float,
    ruled_out: frozenset[frozenset[Side]] = frozenset(),
    look: bool = False,
) -> SideCosts:
    """What it costs that no side, the left, the right or both are worn throughout.

    Parameters
    ----------
    fit, problem : Fit, Problem
        As the search without wear left them: their cells, correlation and unit are those of all hypotheses, so that none is favoured by its own
        noise.
    model : Model
        What that search chose.
    noise : float
        Scatter of points, mm.
    ruled_out : frozenset of frozenset of Side
        Hypotheses that are not asked about.
    look : bool
        Whether it is a first look, of few teeth, and asked again where it leaves a doubt.

    Returns
    -------
    SideCosts
        A hypothesis under which the loss has no shape of wear, or is no more than chance, is left out.
    """
    model = problem.with_offsets(model)
    teeth_left_out = leaves_teeth_out(fit, look)
    fit, sound = on_few_cells(fit, tell_of_wear(fit.cells, problem.context, noise), noise, problem.context, look)
    if teeth_left_out:  # what each tooth has of its own pays for the teeth that are left
        problem = fit.problem(problem.unit, problem.context, problem.always)
    scan = _Scan.of(fit, problem, model, noise, sound)
    shared, price = made_profiles(fit.cells)
    by_side = on_each_side(fit.cells, shared), np.tile(price, len(Side))
    profiles = (shared[:, :0], price[:0]), (shared, price), by_side
    answers = [sides for sides in (frozenset({Side.LEFT}), frozenset({Side.RIGHT}), frozenset(Side)) if sides not in ruled_out]
    # What was lost by a law is asked beside what was made: it does not depend on that.
    made_calls, laws = [partial(scan.made, model, *profile) for profile in profiles], scan.laws(answers)
    found: list[Any] = each([*made_calls, *scan.asked(model, laws)])
    (plain, alike, apart), lost = found[: len(profiles)], _of_sides(laws, found[len(profiles) :])
    made = min(plain.cost, alike.cost)
    unworn = min(made, apart.cost + scan.forms.forms_apart(apart.profile))
    beside = dict[Side, tuple[Floats, float]]()
    for side in Side if apart.cost < made else ():
        if frozenset({side}) in ruled_out:
            continue
        others = apart.needed[apart.needed // shared.shape[1] == side.opposite.index]
        if len(others):
            of_others = np.where(fit.cells.points.side == int(side), 0.0, apart.profile)
            beside[side] = by_side[0][:, others], _price(by_side[1][others]) + scan.forms.forms_apart(of_others)
    tenable = scan.tenable(model, lost, apart.cost < made, unworn, beside)
    other, pitch = scan.pitch_point(model), dict[frozenset[Side], float]()
    if other is not None:
        roll, paid = other
        there = scan.at_pitch(roll)
        laws = there.laws(answers)
        lost = _of_sides(laws, each(there.asked(model, laws)))
        for sides, least in there.tenable(model, lost, apart.cost < made, unworn, beside).items():
            if sides not in tenable or least.cost + paid < tenable[sides].cost:
                tenable[sides], pitch[sides] = replace(least, cost=least.cost + paid), roll
    uncommon = max(tenable[frozenset(Side)].uncommon, by_reliefs(model, problem)) if frozenset(Side) in tenable else 0.0
    return SideCosts({NO_SIDE: unworn} | {sides: least.cost for sides, least in tenable.items()}, made, uncommon, pitch)


@dataclass(frozen=True, slots=True)
class _Made:
    """The cost of flanks that were made so, which of the columns of profiles that were free are needed, (k,), and the profile they make, (m,) mm."""

    cost: float
    needed: Ints
    profile: Floats


@dataclass(frozen=True)
class _Scan:
    """The cells, and the search over them; what several hypotheses come to is worked out once."""

    fit: Fit
    problem: Problem
    sound: Bools

    @cached_property
    def _unworn(self) -> dict[tuple[int, ...], float]:
        """Cost of models without any loss."""
        return {}

    @cached_property
    def _taken(self) -> dict[tuple[int, ...], Floats]:
        """Columns of the last models that were asked for."""
        return {}

    @cached_property
    def _worn(self) -> dict[tuple[tuple[int, ...], bytes], list[SideLoss]]:
        """Losses of given shapes beside given models."""
        return {}

    @classmethod
    def of(cls, fit: Fit, problem: Problem, model: Model, noise: float, sound: Bools) -> _Scan:
        """With the correlation that the richest of all hypotheses leaves: what a poorer one cannot explain is not its noise (Mallows 1973)."""
        cells = fit.cells
        scan = cls(fit, problem, sound)
        free = on_each_side(cells, any_profile(cells))[scan.rows]
        columns = np.hstack([scan.columns(model), free])
        for _ in range(2):
            # Which cells are in at all moves the correlation: these fits go through all passes.
            fitted = scan.robust(columns, settled=0.0)
            by_tooth = scan.shares(free @ fitted.amplitudes[-free.shape[1] :])
            fitted = scan.robust(columns, by_tooth, settled=0.0)
            made, own = np.split(fitted.amplitudes, [columns.shape[1]])
            residual = scan.on_all(fit.target[scan.rows] - columns @ made - by_tooth.times(own))
            use = scan.on_all(fitted.weight) > 0.0
            covariance = estimate_covariance(cells, residual, use, noise)
            unit = design_unit(fit.dictionary, use, covariance)
            scan = cls(replace(fit, covariance=covariance), replace(problem, unit=unit), sound)
        return scan

    @cached_property
    def rows(self) -> Ints:
        """The cells that a fit may use."""
        return np.flatnonzero(self.sound)

    @cached_property
    def forms(self) -> FlankForms:
        """Those of the flanks, on these cells."""
        return FlankForms(self.fit.cells, self.rows, self.problem.context.pitch_roll)

    @cached_property
    def _seen(self) -> Bools:
        """Columns of the dictionary that are not zero on all cells that a fit may use."""
        return self.fit.dictionary.seen(self.sound)

    @cached_property
    def _cuts(self) -> Ints:
        return cuts_among(self.fit.dictionary.first.cuts, self.rows)

    def columns(self, model: Model) -> Floats:
        """Columns of the pose and of a model, on the cells that a fit may use; without those of teeth that have none of these."""
        key = _columns_of(model)
        if key not in self._taken:
            which = np.concatenate([self.fit.dictionary.pose, *(c.columns for c in model)]).astype(np.int64)
            self._taken[key] = self.fit.dictionary.take(which[self._seen[which]], self.rows)
            for old in list(self._taken)[:-REMEMBERED]:
                del self._taken[old]
        return self._taken[key]

    def robust(
        self,
        columns: Floats,
        shares: Shares | None = None,
        losses: int = 0,
        settled: float = SETTLED,
        first: Floats | None = None,
    ) -> Robust:
        """`robust_fit` on the cells that a fit may use."""
        known = self.fit.covariance.weight[self.rows]
        return robust_fit(self.fit.target[self.rows], known, columns, shares, losses, settled, first, self._cuts)

    def shares(self, loss: Floats) -> Shares:
        """A loss (n,) with a share of its own on every flank."""
        points = self.fit.cells.points
        return Shares.of(loss, (points.tooth.astype(np.int64) * 2 + (points.side > 0))[self.rows])

    def on_all(self, values: Floats) -> Floats:
        """Values (n,) of the cells that a fit may use, and 0 on the others, (m,)."""
        result = np.zeros(len(self.sound))
        result[self.rows] = values
        return result

    def laws(self, answers: Sequence[frozenset[Side]]) -> list[_Law]:
        """What some sides, each of `answers`, may have lost by the laws of wear."""
        return [(worn, *law) for worn in answers for law in laws_of_wear(self.fit.cells, self.problem.context, worn)]

    def asked(self, model: Model, laws: Sequence[_Law]) -> list[Callable[[], list[SideLoss]]]:
        """Calls for the losses of some shapes, begun with a model."""
        return [partial(self.losses, model, *law) for law in laws]

    def tenable(
        self,
        model: Model,
        lost: Mapping[frozenset[Side], list[SideLoss]],
        any_shape: bool,
        unworn: float,
        beside: Mapping[Side, tuple[Floats, float]],
    ) -> dict[frozenset[Side], WornCost]:
        """The least cost of each hypothesis that is tenable: sides worn, by what they `lost` by a law or, on one side, in any shape; and one side worn
        beside a form of the other (columns (m, k), and its price)."""
        # As free as the profile that it may have been made with, but for what wear never does.
        alone, any_wear = [worn for worn in lost if len(worn) == 1 and any_shape], partial(any_wear_columns, self.fit.cells)
        free = [(worn, *law) for worn in alone for law in any_wear(self.problem.context, worn)]
        # Or one side worn, and the other cut to a profile of its own.
        slid = [partial(self.beside(made).slid_cost, model, side, unworn, paid) for side, (made, paid) in beside.items()]
        found: list[Any] = each([*self.asked(model, free), *slid])
        of_no_shape = _of_sides(free, found[: len(free)])
        answers = [
            (worn, self.forms.least_worn(worn, losses, of_no_shape.get(worn, []), unworn)) for worn, losses in lost.items()
        ]
        answers += [(frozenset({side}), least) for side, least in zip(beside, found[len(free) :], strict=True)]
        tenable = dict[frozenset[Side], WornCost]()
        for sides, least in answers:
            if least is not None and (sides not in tenable or least.cost < tenable[sides].cost):
                tenable[sides] = least
        return tenable

    def at_pitch(self, roll: float) -> _Scan:
        """The scan with the pitch point at a roll, mm."""
        return replace(self, problem=replace(self.problem, context=self.problem.context.with_pitch(roll)))

    def pitch_point(self, model: Model) -> tuple[float, float] | None:
        """`likeliest` of the pitch points that a gear without a mate may have, beside a model."""
        context, points = self.problem.context, self.fit.cells.points
        if context.mate is not None or context.pitch is not None:
            return None
        made, free = self.columns(model), on_each_side(self.fit.cells, any_profile(self.fit.cells))[self.rows]
        weight = self.robust(np.hstack([made, free])).weight
        flank = points.surface == FLANK
        roll, side = np.nan_to_num(points.roll)[self.rows], np.where(flank, points.side, 0)[self.rows]
        return likeliest(context, roll, side, self.fit.target[self.rows], weight, made, self.problem.unit)

    def beside(self, made: Floats) -> _Scan:
        """The scan with some columns (m, k) that flanks were made with in every fit, as the pose is."""
        wide = self.fit.dictionary.with_columns(made)
        added = np.arange(self.fit.dictionary.count, wide.count)
        fit = replace(self.fit, dictionary=replace(wide, pose=np.concatenate([wide.pose, added])))
        known = self.problem
        return _Scan(fit, fit.problem(known.unit, known.context, known.always), self.sound)

    def made(self, model: Model, free: Floats, price: Floats) -> _Made:
        """The best model beside what is needed of some columns (m, k) that flanks were made with, at the price (k,) of each."""
        seen = free[self.rows]
        fitted = self.robust(np.hstack([self.columns(model), seen]))
        (wide, gram), added = self._beside(free, fitted.weight), self.fit.dictionary.count + np.arange(free.shape[1])
        if len(added):
            model = exchange(self._problem(wide, gram, added), model)  # what stood in for it need not stay
        needed = self._needed(model, seen, price, fitted.weight)
        model = exchange(self._problem(wide, gram, added[needed]), model)
        needed = self._needed(model, seen, price, fitted.weight)
        own = self.columns(model)
        fitted = self.robust(np.hstack([own, seen[:, needed]]))
        profile = free[:, needed] @ fitted.amplitudes[own.shape[1] :]
        return _Made(fitted.square / self.problem.unit + self._named(model) + _price(price[needed]), needed, profile)

    def _needed(self, model: Model, free: Floats, price: Floats, weight: Floats) -> Ints:
        """Which of some columns gain more beside a model than they cost, one after the other."""
        own, count = self.columns(model), free.shape[1]
        gram = Gram.whole(np.hstack([own, free]), self.fit.target[self.rows], weight)
        at = own.shape[1] + np.arange(count)
        beside = gram.beside(np.arange(own.shape[1]), list(at[:, None]))
        chosen, rest = np.zeros(0, np.int64), np.arange(count)
        while len(rest):
            worth = beside.tried(at[chosen][None])[1][0][rest] / self.problem.unit - price[rest]
            best = int(np.argmax(worth))
            if worth[best] <= 0.0:
                break
            chosen, rest = np.append(chosen, rest[best]), np.delete(rest, best)
        return chosen

    def slid_cost(self, model: Model, side: Side, unworn: float, paid: float) -> WornCost | None:
        """Of the best model beside wear on a side as sliding leaves it, with what is `paid` for a form of the other; None where it has none of that."""
        law, on = wear_columns(self.fit.cells, self.problem.context, frozenset({side}))
        losses = self.losses(model, frozenset({side}), law, on)
        return least_of([self.forms.or_as_cut(lost, side, lost.cost + paid, unworn) for lost in losses])

    def losses(self, model: Model, worn: frozenset[Side], law: Floats, sides: Ints) -> list[SideLoss]:
        """The losses of some shapes on some sides, each beside the best model; none where what these have in common is none of them.

        The search begins with what it chose without wear, with what of that the scanner did, and with nothing: what stood in for wear may be
        hard to get rid of, and what the scanner did hard to find from nothing beside it.
        """
        by_scanner = tuple(candidate for candidate in model if candidate.effect.kind is Kind.MEASUREMENT)
        fewer = {_columns_of(start): start for start in (self._known(by_scanner), self._known(()))}
        # One set of weights tells all of them which cells to believe: those that the richest ends with.
        wide, gram = self._beside(law, self._losses(model, law, sides)[2].weight)
        added, tried, losses = np.arange(wide.count - law.shape[1], wide.count), dict[bytes, Around](), list[SideLoss]()
        for start in [model, *(start for start in fewer.values() if len(start) < len(model))]:
            beside = self.problem.columns(start)
            kept = gram.solve_non_negative(beside, added)[len(beside) :] > 0.0
            if _lost_on(sides[kept]) != worn:
                continue
            if kept.tobytes() not in tried:
                tried[kept.tobytes()] = Around(self._problem(wide, gram, added[kept]), {}, {}, {})
            around = tried[kept.tobytes()]
            searched, least = exchange(around.problem, start, around), np.ascontiguousarray(law[:, kept])
            # Shapes that are richer than what is lost end at the same columns.
            key = _columns_of(searched), hashlib.sha256(least.tobytes()).digest() + sides[kept].tobytes()
            if key not in self._worn:
                self._worn[key] = self._losses_beside(searched, worn, least, sides[kept])
            losses += self._worn[key]
        return losses

    def _losses_beside(self, searched: Model, worn: frozenset[Side], law: Floats, sides: Ints) -> list[SideLoss]:
        """Losses of some shapes beside a model: the same on all teeth, and with a share of it on each."""
        law, sides, fitted = self._losses(searched, law, sides)
        if _lost_on(sides) != worn:
            return []
        price = sum(free_penalty(int(count)) for count in np.unique(sides, return_counts=True)[1])
        common = fitted.square / self.problem.unit + price + self._named(searched)
        # As the scan would be explained by the same effects without any loss: what is no more than chance is no wear.
        if self.unworn_cost(searched) - common < rules().close:
            return []
        # Every tooth may have lost more or less of the same, but hardly any nothing.
        loss = law @ fitted.amplitudes[-law.shape[1] :]
        by_tooth = self.shares(loss[self.rows])
        alone = self.robust(self.columns(searched), by_tooth, first=fitted.weight)
        beside = self._searched(searched, loss_by_tooth(self.fit.cells, loss, self.fit.dictionary.first.cuts), alone.weight)
        if set(_columns_of(beside)) != set(_columns_of(searched)):  # what stood in for the shares would hide what they gain
            fitted = self._alike(beside, loss, worn, fitted.weight)
        searched = beside
        alone = self.robust(self.columns(searched), by_tooth, first=alone.weight)
        last = slice(len(alone.amplitudes) - by_tooth.count, None)
        share = alone.amplitudes[last]
        if float((share <= 0.0).mean()) > rules().blank_flanks:
            return []
        more, gain = by_tooth.count - len(worn), (fitted.square - alone.square) / self.problem.unit
        by_chance = float(chdtri(more, rules().significance))
        uneven = gain > by_chance and float(share.std()) > rules().alike_teeth * float(share.mean())
        if uneven and len(worn) == 1:
            (side,), made = worn, self.columns(searched) @ alone.amplitudes[: -by_tooth.count]
            uneven = self._differ_more(self.on_all(self.fit.target[self.rows] - made), self.on_all(alone.weight), loss, side)
        losses = [SideLoss(common, loss, uneven)]
        if share.min() >= 0.0:
            paid = price + rules().parameter_penalty * more + self._named(searched)
            losses.append(SideLoss(alone.square / self.problem.unit + paid, loss, uneven))
        return losses

    def _alike(self, model: Model, loss: Floats, worn: frozenset[Side], first: Floats) -> Robust:
        """The fit of a model with as much of a loss (m,) on all flanks of each side; `first` as in `robust_fit`."""
        law, _ = on_worn(self.fit.cells, -loss[:, None], worn)
        return self.robust(np.hstack([self.columns(model), law[self.rows]]), losses=law.shape[1], first=first)

    def _differ_more(self, left: Floats, weight: Floats, loss: Floats, side: Side) -> bool:
        """`differ_more` of the flanks of a side in the shape of a loss (m,), in what effects leave (m,), against those of the other side, who wore it not."""
        shape, teeth = self.fit.cells.grid.flank_shape, self.fit.cells.grid.gear.teeth
        lost = shape(loss)[:, side.index].reshape(teeth, -1)
        typical = lost.sum(axis=0) / np.maximum((lost != 0.0).sum(axis=0), 1)
        seen, believed = (shape(values).reshape(teeth, len(Side), -1) for values in (left, weight))
        return differ_more(seen, believed, typical, side)

    def _known(self, model: Model) -> Model:
        """A model with what is in every one, to begin with."""
        return self.problem.with_offsets(self.problem.with_known(model))

    def unworn_cost(self, model: Model) -> float:
        """Of the effects of a model without any loss."""
        key = _columns_of(model)
        if key not in self._unworn:
            self._unworn[key] = self.robust(self.columns(model)).square / self.problem.unit + self._named(model)
        return self._unworn[key]

    def _named(self, model: Model) -> float:
        """What the effects of a model cost."""
        return sum(self.problem.penalty(c) for c in model)

    def _losses(self, model: Model, law: Floats, sides: Ints) -> tuple[Floats, Ints, Robust]:
        """The columns that take metal away beside a model, their sides, and the fit with them."""
        beside = self.columns(model)
        fitted = self.robust(np.hstack([beside, law[self.rows]]), losses=law.shape[1])
        kept = fitted.amplitudes[beside.shape[1] :] > 0.0
        amplitudes = fitted.amplitudes[np.concatenate([np.ones(beside.shape[1], dtype=np.bool_), kept])]
        return law[:, kept], sides[kept], replace(fitted, amplitudes=amplitudes)

    def _searched(self, model: Model, law: Floats | CellColumns, weight: Floats) -> Model:
        """The model after exchange beside the law."""
        wide, gram = self._beside(law, weight)
        return exchange(self._problem(wide, gram, np.arange(self.fit.dictionary.count, wide.count)), model)

    def _beside(self, law: Floats | CellColumns, weight: Floats) -> tuple[Dictionary, Gram]:
        """The dictionary with a law behind it, and the sums of both at some weights (n,)."""
        wide = self.fit.dictionary.with_columns(law)
        return wide, Gram.of(wide.blocks, self.fit.target, self.on_all(weight), np.zeros(len(self.sound), np.int64), 1)

    def _problem(self, wide: Dictionary, gram: Gram, lost: Ints) -> Problem:
        """The search beside some columns of a law, which are in every fit as the pose is."""
        with_law = replace(wide, pose=np.concatenate([wide.pose, lost]))
        return Problem(with_law, gram, self.problem.unit, self.problem.context, self.problem.always)


def _of_sides(laws: Sequence[_Law], found: Sequence[list[SideLoss]]) -> dict[frozenset[Side], list[SideLoss]]:
    """The losses found by some laws, by the sides that are worn."""
    lost = dict[frozenset[Side], list[SideLoss]]()
    for (worn, _, _), losses in zip(laws, found, strict=True):
        lost.setdefault(worn, []).extend(losses)
    return lost


def _price(columns: Floats) -> float:
    """Of a form that flanks were made with, from those of its columns (k,); none of none."""
    return rules().effect_penalty + float(columns.sum()) if len(columns) else 0.0


def _columns_of(model: Model) -> tuple[int, ...]:
    """Tells models apart, by the first column of each of their effects."""
    return tuple(candidate.first for candidate in model)


def _lost_on(sides: Ints) -> frozenset[Side]:
    """The sides that columns of these belong to; 0 is both."""
    return frozenset(side for side in Side if np.isin(sides, (0, int(side))).any())
