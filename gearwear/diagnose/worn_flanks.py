"""Whether some flanks are worn all over: the levels of all flanks explained with them apart, and without, by one cost.

How far a flank stands out as a whole is one number, its level. The maker and the scanner move the two flanks of a tooth together, in the same sense
or in opposite ones; wear lowers one of them and leaves the other, and metal does not come back. So levels are what the effects of the catalogue make
them, with a scatter from tooth to tooth in which both flanks go together as they like, and some lie below that. What no effect explains may also be a
wave round the gear without a cause: it is tried at the same cost, and pays for having none.

The cost is that of `worn_sides`: misfit and the price of what is in the model. The scatter of the teeth is not known, so the misfit is minus twice the
logarithm of the likelihood with the scatter that fits best.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from scipy.special import gammaln

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import free_penalty, penalty

OF_MEAN = 0.5 * math.pi
"""Variance of a median of many values in that of their mean, for normal scatter."""
ROUNDS = 6
"""Times that flanks and effects are chosen in turn, at most; numerical."""
REWEIGHTED = 3
"""Fits with the scatter of the last one, at most; numerical."""
SHOWN = 1e-3
"""Share of its square that a column must have beside pose and common levels; numerical."""
FEWEST_FREE = 2.0
"""Teeth beyond half of the parameters, at least; numerical."""
RIDGE = 1e-9
"""Part by which the diagonal of a fit is raised: columns may be the same; numerical."""
TOGETHER = 32
"""Candidates whose columns are held with their zeros at a time; numerical."""
TRIED = 6
"""Terms of greatest gain that are fitted in full; numerical."""


@dataclass(frozen=True, eq=False)
class Term:
    """What may move the levels of flanks: an effect, or a wave without a name.

    Parameters
    ----------
    columns : (w n, q) float
        Levels for one unit of each amplitude, as `Levels.value`.
    price : float
        What it must be worth.
    """

    columns: Floats
    price: float


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of the flanks of the teeth that were seen on both sides.

    Parameters
    ----------
    teeth : (n,) int
        Of so many `around`.
    around : int
    value : (w n,) float
        Of each tooth in turn left and right flank, and with four left and right fillet, each in the standard deviation that its points' noise gives it.
    base : (w n, p) float
        What is free: the common level of each of these, and the pose.
    terms : tuple of Term
        Effects of the catalogue.
    nameless : tuple of Term
        Waves without a cause: what may be there in place of worn flanks, not beside them.
    wide : int
        w: 2, or 4 with fillets, which an error of the scanner moves with their flanks, and wear does not.
    """

    teeth: Ints
    around: int
    value: Floats
    base: Floats
    terms: tuple[Term, ...]
    nameless: tuple[Term, ...]
    wide: int = 2

    @property
    def count(self) -> int:
        return len(self.teeth)

    @property
    def weight(self) -> float:
        """Teeth that a covariance of what is left counts as: of few teeth it follows the one that lies off, and a likelihood ratio is too large by as
        much (Bartlett 1938)."""
        return float(self.count - (self.base.shape[1] + 0.5 * self.wide**2) / self.wide)

    @cached_property
    def _explained(self) -> dict[tuple[tuple[int, ...], tuple[int, ...]], Explained]:
        return {}

    def explained(self, terms: tuple[int, ...] = (), low: tuple[int, ...] = ()) -> Explained:
        """With some terms and some flanks, sorted, that lie below. Searches from other starts come by the same: each is worked out once."""
        return self._explained.setdefault((terms, low), Explained(self, terms, low))

    @cached_property
    def value_and_terms(self) -> Floats:
        """The levels and the columns of all terms side by side, (w n, 1 + …)."""
        return np.hstack([self.value[:, None], *(term.columns for term in self.terms)])


@dataclass(frozen=True)
class Explained:
    """Levels with some terms, and some flanks that lie below.

    Parameters
    ----------
    levels : Levels
    terms : tuple of int
        Of `levels.terms`.
    low : tuple of int
        Flanks, sorted: places in `levels.value`.
    """

    levels: Levels
    terms: tuple[int, ...] = ()
    low: tuple[int, ...] = ()

    def with_low(self, low: Iterable[int]) -> Explained:
        """With these flanks below."""
        return self.levels.explained(self.terms, tuple(sorted(low)))

    def with_term(self, term: int) -> Explained:
        return self.levels.explained((*self.terms, term), self.low)

    def without_term(self, term: int) -> Explained:
        return self.levels.explained(tuple(i for i in self.terms if i != term), self.low)

    @cached_property
    def _with_own(self) -> FittedLevels:
        """With a depth of its own on every one of the low flanks."""
        return _fitted(self.levels, self._columns, self.low)

    @property
    def _own(self) -> Floats:
        own = np.zeros((len(self.levels.value), len(self.low)))
        own[list(self.low), np.arange(len(self.low))] = -1.0
        return own

    @property
    def _columns(self) -> Floats:
        return np.hstack([self.levels.base, *(self.levels.terms[i].columns for i in self.terms)])

    @cached_property
    def cost(self) -> float:
        """Misfit and prices."""
        priced = sum(self.levels.terms[i].price for i in self.terms)
        if not self.low:
            return self._with_own.misfit + priced
        sides = np.zeros((len(self.levels.value), 2))
        halves = np.array(self.low) % self.levels.wide
        sides[list(self.low), halves] = -1.0
        numbers = np.bincount(halves, minlength=2)
        same = _fitted(self.levels, np.hstack([self._columns, sides[:, numbers > 0]]))
        own_cost = self._with_own.misfit + free_penalty(len(self.low))
        kinds = int((numbers > 0).sum())
        same_cost = same.misfit + free_penalty(kinds)
        which = sum(
            _choice(self.levels, np.array(self.low)[halves == half] // self.levels.wide) for half in np.flatnonzero(numbers)
        )
        return min(own_cost, same_cost if min(same.amplitudes[-kinds:]) > 0.0 else math.inf) + which + priced

    @property
    def possible(self) -> bool:
        """Whether no flank has gained metal."""
        amplitudes = self._with_own.amplitudes
        return min(amplitudes[len(amplitudes) - len(self.low) :], default=1.0) > 0.0

    @property
    def below(self) -> Floats:
        """(n, 2) how far each flank lies above what its tooth's other one lets expect."""
        fitted, wide = self._with_own, self.levels.wide
        rest, scatter = fitted.rest.reshape(-1, wide)[:, :2], fitted.scatter
        low = np.zeros(len(fitted.rest), dtype=np.bool_)
        low[list(self.low)] = True
        other = np.where(low.reshape(-1, wide)[:, 1::-1], 0.0, rest[:, ::-1])  # a worn flank tells nothing of the other
        # A tooth that is off its place, or thick, has moved both of its flanks by as much, and no more.
        pull = np.clip(scatter[0, 1] / np.diag(scatter)[1::-1], -1.0, 1.0)
        return np.asarray(rest - pull * other, dtype=np.float64)

    @cached_property
    def gains(self) -> Floats:
        """About what each term would lower the misfit by, less its price; -inf for those that are in."""
        fitted, levels = self._with_own, self.levels
        basis = np.linalg.qr(_white(np.hstack([self._columns, self._own]), fitted.root))[0]
        every = _white(levels.value_and_terms, fitted.root)
        every = every - basis @ (basis.T @ every)
        rest = every[:, 0]
        scattered = _scattered(levels, rest[:, None])
        result = np.full(len(levels.terms), -math.inf)
        sizes = np.array([term.columns.shape[1] for term in levels.terms], dtype=np.int64)
        starts = 1 + np.cumsum(sizes) - sizes
        free = np.setdiff1d(np.arange(len(sizes)), self.terms)
        for size in np.unique(sizes[free]):
            some = free[sizes[free] == size]
            columns = every[:, starts[some][:, None] + np.arange(size)]
            gram = np.einsum("nti,ntj->tij", columns, columns)
            moment = np.einsum("nti,n->ti", columns, rest)
            gram += (RIDGE * np.trace(gram, axis1=1, axis2=2)[:, None, None] + 1e-300) * np.eye(size)
            solved = np.linalg.solve(gram, moment[..., None])[..., 0]
            left = rest[:, None] - np.einsum("nti,ti->nt", columns, solved)
            result[some] = scattered - _scattered(levels, left) - np.array([levels.terms[i].price for i in some])
        return result


@dataclass(frozen=True)
class FittedLevels:
    """A fit of levels with the scatter of the teeth that it leaves.

    Parameters
    ----------
    misfit : float
        −2 ln of the likelihood, up to a constant.
    amplitudes : tuple of float
        Of the columns, and depths of the flanks that have one of their own.
    rest : (w n,) float
        Levels less the columns.
    scatter, root : (w, w) float
        Covariance of the levels of a tooth, and what makes of them numbers of variance 1 that are independent.
    """

    misfit: float
    amplitudes: tuple[float, ...]
    rest: Floats
    scatter: Floats
    root: Floats


def _white(columns: Floats, root: Floats) -> Floats:
    return np.asarray(root @ columns.reshape(-1, len(root), columns.shape[1])).reshape(columns.shape)


def _scattered(levels: Levels, rest: Floats) -> Floats:
    """Misfit by the determinant of the covariance of what is left, (w n, t): (t,)."""
    by_tooth = rest.reshape(-1, levels.wide, rest.shape[1])
    moments = np.einsum("nit,njt->tij", by_tooth, by_tooth) / len(by_tooth) + SHOWN * np.eye(levels.wide)
    return np.asarray(levels.weight * np.linalg.slogdet(moments)[1])


def _fitted(levels: Levels, columns: Floats, low: tuple[int, ...] = ()) -> FittedLevels:
    """Least squares with the covariance of the levels of a tooth that is left over, not below what noise makes of them; some flanks have a depth of
    their own. What such a flank adds to the sums is of its tooth alone."""
    number, wide, shared, own = levels.count, levels.wide, columns.shape[1], np.array(low, dtype=np.int64)
    every = np.column_stack([columns, levels.value])
    tooth, half = np.divmod(own, wide)
    of_one = tooth[:, None] == tooth
    count = shared + len(own)
    free = number - 0.5 * count
    scatter, root, misfit = np.eye(wide), np.eye(wide), math.inf
    gram, solved = np.empty((count, count)), np.zeros(count)
    for _ in range(REWEIGHTED if free >= FEWEST_FREE else 0):
        precision = root.T @ root
        weighted = (precision @ every.reshape(number, wide, -1)).reshape(every.shape)
        sums = every.T @ weighted
        gram[:shared, :shared] = sums[:-1, :-1]
        gram[shared:, :shared] = -weighted[own, :-1]
        gram[:shared, shared:] = gram[shared:, :shared].T
        gram[shared:, shared:] = precision[half[:, None], half] * of_one
        gram.flat[:: count + 1] *= 1.0 + RIDGE
        solved = np.linalg.solve(gram, np.concatenate([sums[:-1, -1], -weighted[own, -1]]))
        left = levels.value - columns @ solved[:shared]
        left[own] += solved[shared:]
        by_tooth = left.reshape(-1, wide)
        variance, axes = np.linalg.eigh(by_tooth.T @ by_tooth / free)
        kept = np.maximum(variance, 1.0)
        scatter, root = (axes * kept) @ axes.T, (axes / np.sqrt(kept)).T
        misfit = levels.weight * float((np.log(kept) + variance / kept).sum())
    return FittedLevels(misfit, tuple(solved.tolist()), levels.value - columns @ solved[:shared], scatter, root)


def _choice(levels: Levels, places: Ints) -> float:
    """What it costs which flanks of a side they are: 2 ln of the ways to choose as many; or step and start, where it is every so many of all, as where a
    mate whose count has a factor in common meets them."""
    number, count = len(places), levels.count
    any_of_them = 2.0 * float(gammaln(count + 1) - gammaln(number + 1) - gammaln(count - number + 1))
    steps = np.diff(levels.teeth[places], append=levels.teeth[places[0]] + levels.around)
    return min(any_of_them, 2.0 * _shape_price()) if (steps == steps[0]).all() else any_of_them


def _shape_price() -> float:
    return rules().parameter_penalty * rules().shape_price


def worn_flanks(fit: Fit, model: Model, sound: Bools, noise: float) -> Bools:
    """Flanks that are worn all over, (teeth, 2).

    Parameters
    ----------
    fit : Fit
        As a search with all flanks left it.
    model : Model
        What that search chose.
    sound : (m,) bool
        Cells that a fit may use.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    (teeth, 2) bool
        None of them where the levels are explained as well without, by effects of the catalogue or by waves round the gear.
    """
    found = np.zeros((fit.cells.grid.gear.teeth, 2), dtype=np.bool_)
    levels = _levels(fit, model, sound, noise)
    places = np.array(low_flanks(levels), dtype=np.int64)
    found[levels.teeth[places // levels.wide], places % levels.wide] = True
    return found


def low_flanks(levels: Levels) -> tuple[int, ...]:
    """Places in `levels.value` of the flanks that lie below what explains the others; none where all are explained as well without."""
    if levels.count < rules().pattern_teeth:
        return ()
    every = replace(levels, terms=(*levels.terms, *levels.nameless))
    without, beside = _cheapest(every, flanks=False), _cheapest(levels, flanks=True)
    for side in Side:  # chance makes some of a side the lowest
        other = beside.with_low(i for i in beside.low if i % levels.wide != side.index)
        beside = other if other.cost < beside.cost + rules().close else beside
    return beside.low if beside.cost < without.cost - rules().close else ()


def _cheapest(levels: Levels, flanks: bool) -> Explained:
    """Flanks and terms chosen in turn, until neither lowers the cost."""
    plain = levels.explained()
    starts = [plain, _with_terms(plain)]
    if flanks:
        starts += [_trimmed(levels, sides) for sides in ((Side.LEFT,), (Side.RIGHT,), tuple(Side))]
    return min((_settled(start, flanks) for start in starts), key=lambda option: option.cost)


def _settled(one: Explained, flanks: bool) -> Explained:
    for _ in range(ROUNDS):
        before = one.cost
        one = _with_terms(_with_flanks(one) if flanks else one)
        if not one.cost < before:
            break
    return one


def _trimmed(levels: Levels, sides: tuple[Side, ...]) -> Explained:
    """The terms that explain the upper flanks of some sides best: the lower ones, as many as may be worn, tell nothing (least trimmed squares,
    Rousseeuw 1984)."""
    one = levels.explained()
    for _ in range(ROUNDS):
        again = _with_terms(one.with_low(i for side in sides for i in _lowest(one, side)))
        if again == one:
            break
        one = again
    return one


def _lowest(one: Explained, side: Side) -> list[int]:
    """The lowest flanks of a side, as many as may be worn, the lowest first."""
    order = np.argsort(one.below[:, side.index], kind="stable")[: int(rules().most_worn * one.levels.count)]
    most: list[int] = (order * one.levels.wide + side.index).tolist()
    return most


def _least(options: Iterable[Explained], one: Explained) -> Explained:
    return min((one, *options), key=lambda option: option.cost)


def _with_flanks(one: Explained) -> Explained:
    """The lowest flanks of a side apart, as many as cost least; of either side in turn."""
    for _ in range(ROUNDS):
        before = one
        for side in Side:
            lowest, others = _lowest(one, side), [i for i in one.low if i % one.levels.wide != side.index]
            options = (one.with_low([*others, *lowest[:k]]) for k in range(len(lowest) + 1))
            likely = [option for option in options if option.possible]
            one = _least(likely, one) if one.possible else min(likely, key=lambda option: option.cost, default=one)
        if one is before:
            break
    return one


def _with_terms(one: Explained) -> Explained:
    """Terms added and dropped as long as that lowers the cost."""
    while True:
        gains = one.gains
        near = [int(i) for i in np.argsort(gains)[::-1][:TRIED] if gains[i] > 0.0]
        options = [one.with_term(i) for i in near]
        options += [one.without_term(i) for i in one.terms]
        options += [option.without_term(i) for option in options[: len(near)] for i in one.terms]
        best = _least(options, one)
        if best is one:
            return one
        one = best


def _levels(fit: Fit, model: Model, sound: Bools, noise: float) -> Levels:
    """The levels of the flanks, with fillets where they are those of the design, and what may move them."""
    grid, dictionary = fit.cells.grid, fit.dictionary
    shapes = [grid.flank_shape, grid.fillet_shape]
    number = [shape(sound).sum(axis=(2, 3)) for shape in shapes]
    known = [(of > 0) & (of >= rules().known_flank * np.median(of)) for of in number]
    fillets = known[1].all(axis=1)
    seen = known[0].all(axis=1)
    with_fillets = int((seen & fillets).sum()) >= max(rules().pattern_teeth, rules().most_worn * len(seen))
    seen, shapes = np.flatnonzero(seen & fillets if with_fillets else seen), shapes[: 1 + with_fillets]
    wide = 2 * len(shapes)
    if len(seen) < rules().pattern_teeth:
        return Levels(seen, grid.gear.teeth, np.zeros(0), np.zeros((0, 0)), (), (), wide)
    use = [shape(sound)[seen] for shape in shapes]
    points = [np.where(one, shape(fit.cells.count)[seen], 0.0).sum(axis=(2, 3)) for one, shape in zip(use, shapes, strict=True)]
    std = np.repeat([math.sqrt(OF_MEAN / max(float(np.median(one)), 1.0)) * noise for one in points], 2)
    every = np.tile(std, len(seen))

    def means(columns: Floats) -> Floats:
        """Of the cells of each flank and fillet, (w n, q), in the standard deviation of a level."""
        result = np.zeros((len(seen), wide, columns.shape[1]))
        for i, column in enumerate(columns.T):
            for j, (one, shape) in enumerate(zip(use, shapes, strict=True)):
                result[:, 2 * j : 2 * j + 2, i] = np.where(one, shape(column)[seen], 0.0).sum(axis=(2, 3)) / one.sum(axis=(2, 3))
        return np.asarray(result.reshape(len(every), -1) / every[:, None])

    columns = fit.columns(model)
    weight = np.sqrt(fit.weight)
    amplitudes = np.linalg.lstsq(columns * weight[:, None], fit.target * weight, rcond=1e-9)[0]
    rest = fit.target - columns @ amplitudes
    medians = [
        np.nanmedian(np.where(one, shape(rest)[seen], np.nan), axis=(2, 3)) for one, shape in zip(use, shapes, strict=True)
    ]
    value = np.hstack(medians).ravel() / every + means(columns) @ amplitudes
    base = np.hstack([np.tile(np.eye(wide), (len(seen), 1)), means(dictionary.take(dictionary.pose))])
    basis, size, _ = np.linalg.svd(base / np.maximum(np.linalg.norm(base, axis=0), 1e-300), full_matrices=False)
    base = basis[:, size > SHOWN * size[0]]
    shared = [c for c in dictionary.candidates if not c.effect.tooth_specific and c.effect.kind not in (Kind.WEAR, Kind.FORM)]
    terms = []
    for start in range(0, len(shared), TOGETHER):
        some = shared[start : start + TOGETHER]
        levels = means(dictionary.take(np.concatenate([c.columns for c in some])))
        for candidate, own in zip(some, np.split(levels, np.cumsum([len(c.columns) for c in some])[:-1], axis=1), strict=True):
            left = own - base @ (base.T @ own)
            if float((left**2).sum()) > SHOWN * float((own**2).sum()):
                terms.append(Term(own, penalty(candidate)))
    return Levels(seen, grid.gear.teeth, value, base, tuple(terms), tuple(waves(seen, grid.gear.teeth, std)), wide)


def waves(teeth: Ints, count: int, std: Floats) -> list[Term]:
    """Waves round the gear (n teeth of so many) of every order, on both sides in the same or in the opposite sense, by the angle of the tooth or of its
    flanks; or two of them, as high on either side, and where, as they like, on one side alone too. Fillets with them or not; in units of `std`, (w,)."""
    terms, pitch, wide = list[Term](), 2.0 * np.pi / count, len(std)
    for order, follow in product(range(1, count // 2 + 1), (0.0, 1.0)[: wide // 2]):
        place = np.array([1.0, 1.0, follow, follow])[:wide, None] / std[:, None] * std[0]

        def wave(turn: float, order: int = order, place: Floats = place) -> Floats:
            """(n, w, q) of flanks that are a quarter of a pitch off the middle of their tooth, or not."""
            angle = order * pitch * (teeth[:, None] + turn * np.array([1.0, -1.0, 1.0, -1.0])[:wide])
            both = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
            return np.asarray(place * (both[..., :1] if 2 * order == count and not turn else both))

        sides = np.tile([[1.0], [-1.0]], (wide // 2, 1))
        # What goes by the angle of the flanks, an index or an encoder, moves the fillets with them.
        turns = (0.0, 0.25, -0.25) if follow or wide == 2 else (0.0,)
        terms += [_wave_term(sense * wave(turn), 1) for sense in (1.0, sides) for turn in turns]
        still = wave(0.0)
        terms.append(_wave_term(np.concatenate([still * (sides > 0.0), still * (sides < 0.0)], axis=-1), 2))
    return terms


def _wave_term(wave: Floats, number: int) -> Term:
    """So many waves of one order, (n, w, q): each lacks a cause."""
    more = (number - 1) * rules().effect_penalty + number * rules().close
    return Term(wave.reshape(-1, wave.shape[-1]), free_penalty(wave.shape[-1]) + _shape_price() + more)
