"""Fits of the wear law and of runs to a wear map, on some or all of its places, by one cost.

The errors of a place are those of the map (noise, texture, pose, effects), and what no model has: a share of the depth that is alike over a stretch of
the profile and all across the face, and one that is alike over a part of the face. So models of the profile may be wrong by a tenth
without anything being named for it, while a lean across the face is judged by the errors of the map.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.running.conditions import Conditions, Runs
from gearwear.running.effects.base import RunEffect, conditions_of
from gearwear.running.wear_map import WearMap

MODEL_SHARE, SHARE_ACROSS = 0.10, 0.10
"""What no model has of a depth: standard deviation as a share of it, alike all across the face; and alike over a part of it."""
MODEL_FLOOR = 0.0007
"""mm; the same of a depth of nothing: runs are rough from cell to cell by about as much."""
MODEL_LENGTH_MODULES, LENGTH_ACROSS = 0.3, 0.3
"""Over which lengths it is alike: of roll in modules, of the face as a share of it."""
USUAL = Conditions()


def doubted(usual: Conditions) -> tuple[Conditions, ...]:
    """Compliances and loads that there may as well be, a quarter off, a longer coupling, and the other kind of tip corner: what they move a
    size by is part of its ±."""
    return replace(usual, softness=1.25), replace(usual, coupling_modules=1.4), replace(usual, corners=not usual.corners)


def whole_errors(place: WearMap) -> Floats:
    """Covariance of the mean depths of a map with what no model has, (m, m) mm²."""
    roll, zeta = place.roll, place.height
    depth = np.maximum(place.mean, 0.0)
    # Of a depth smoothed over the face and its neighbours, so that a share of noise is no share of wear.
    near = np.exp(
        -0.5 * ((roll[:, None] - roll) / (0.1 * place.gear.transverse_module)) ** 2 - 0.5 * ((zeta[:, None] - zeta) / 0.2) ** 2
    )
    smooth = near @ depth / near.sum(axis=1)
    along = np.exp(-np.abs(roll[:, None] - roll) / (MODEL_LENGTH_MODULES * place.gear.transverse_module))
    across = np.exp(-np.abs(zeta[:, None] - zeta) / LENGTH_ACROSS)
    all_over, part = np.hypot(MODEL_SHARE * smooth, MODEL_FLOOR), SHARE_ACROSS * smooth
    model = all_over[:, None] * along * all_over + part[:, None] * along * across * part
    return np.asarray(place.errors + model, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class MapFit:
    """A model on a map.

    Parameters
    ----------
    sizes : (p,) float
        Of its effects.
    amount : float
        k w N, mm: what single contact loses at K = 1.
    cost : float
        χ² on the places that were fitted.
    depth : (m,) float
        What it says of all places, mm.
    """

    sizes: tuple[float, ...]
    amount: float
    cost: float
    depth: Floats


class MapModel(Protocol):
    """Whatever can be fitted to a map."""

    def fit(self, depth: Floats, errors: Floats, on: Bools) -> MapFit:
        """Fit mean depths (m,) with their errors (m, m) on some places (m,)."""
        ...


@dataclass(frozen=True, slots=True)
class LawModel:
    """The closed-form law, alike across the face.

    Parameters
    ----------
    basis : (m, 3) float
        Its terms at coefficient 1.
    """

    basis: Floats

    def fit(self, depth: Floats, errors: Floats, on: Bools) -> MapFit:
        from scipy.optimize import nnls

        white = np.linalg.inv(np.linalg.cholesky(errors[np.ix_(on, on)]))
        _, left = nnls(white @ self.basis[on], white @ depth[on])
        # Its depths are the nearest that it has: where wear leans, the likeliest may be none at all, and say nothing of the law.
        size, _ = nnls(self.basis[on], depth[on])
        return MapFit((), float(size[0]), float(left**2), self.basis @ size)


@dataclass(frozen=True, slots=True)
class RunModel:
    """Elastic teeth that wear, with some effects.

    Parameters
    ----------
    runs : Runs
    effects : tuple of RunEffect
        Those with a size.
    near : tuple of int
        Steps of their sizes about which to look first.
    usual : Conditions
        To which they are added.
    """

    runs: Runs
    effects: tuple[RunEffect, ...] = ()
    near: tuple[int, ...] = ()
    usual: Conditions = USUAL

    def fit(self, depth: Floats, errors: Floats, on: Bools) -> MapFit:
        white = np.linalg.inv(np.linalg.cholesky(errors[np.ix_(on, on)]))
        wanted = white @ depth[on]

        def judged(history: Floats) -> tuple[float, float]:
            return _nearest(history[:, on] @ white.T, wanted)

        at = self.near or (0,) * len(self.effects)
        best = judged(self._node(at))[0]
        while True:
            costs = {step: judged(self._node(step))[0] for step in self._beside(at)}
            step = min(costs, key=lambda step: costs[step], default=at)
            if step == at or not costs[step] < best:
                break
            at, best = step, costs[step]
        offset = self._refined(at, judged)
        history = self._between(at, offset)
        cost, place = judged(history)
        sizes = tuple((i + v) * effect.step for i, v, effect in zip(at, offset, self.effects, strict=True))
        amount = place * self.runs.longest / (len(history) - 1) * self.runs.load_per_width
        return MapFit(sizes, amount, cost, _at(history, place))

    def covariance(self, fit: MapFit, errors: Floats, unnamed: Sequence[RunEffect] = ()) -> Floats:
        """(p + u, p + u) of the sizes and of those of effects that were not named.

        Notes
        -----
        First order about the fit: the sizes err by J⁺ e, J⁺ = (JᵀΣ⁻¹J + P⁻¹)⁻¹ JᵀΣ⁻¹, with e the errors, or the depth of a run of another
        compliance less that of the one that counts. P holds what is known beforehand of the sizes of effects that were not named
        (`RunEffect.doubt`): they may be there all the same.
        """
        steps = [effect.step for effect in self.effects]
        at = tuple(round(size / step) for size, step in zip(fit.sizes, steps, strict=True))
        offset = [size / step - i for size, step, i in zip(fit.sizes, steps, at, strict=True)]
        history = self._between(at, offset)
        place = fit.amount / self.runs.load_per_width / self.runs.longest * (len(history) - 1)
        columns = [_at(history, min(place + 0.5, len(history) - 1)) - _at(history, max(place - 0.5, 0.0))]
        for axis in range(len(self.effects)):
            step = 1 if self._allowed((*at[:axis], at[axis] + 1, *at[axis + 1 :])) else -1
            if offset[axis] < 0.0 and self._allowed((*at[:axis], at[axis] - 1, *at[axis + 1 :])):
                step = -1
            beside = self._node((*at[:axis], at[axis] + step, *at[axis + 1 :]))
            columns.append((_at(beside, place) - _at(self._node(at), place)) / (step * steps[axis]))
        for effect in unnamed:
            with_it = replace(self, effects=(*self.effects, effect))
            columns.append((_at(with_it._node((*at, 1)), place) - _at(self._node(at), place)) / effect.step)
        matrix = np.column_stack(columns)
        known = np.diag([0.0] * (1 + len(self.effects)) + [effect.doubt**-2 for effect in unnamed])
        inverse = np.linalg.pinv(matrix.T @ np.linalg.solve(errors, matrix) + known)
        back = inverse @ np.linalg.solve(errors, matrix).T
        total = inverse
        sizes = tuple(i * step for i, step in zip(at, steps, strict=True))
        usual = conditions_of(self.effects, sizes, self.usual)
        for other in doubted(usual):
            moved = back @ (_at(self.runs.of(other), place) - _at(self.runs.of(usual), place))
            total = total + np.outer(moved, moved)
        return np.asarray(total[1:, 1:], dtype=np.float64)

    def _node(self, at: tuple[int, ...]) -> Floats:
        sizes = tuple(i * effect.step for i, effect in zip(at, self.effects, strict=True))
        return self.runs.of(conditions_of(self.effects, sizes, self.usual))

    def _allowed(self, at: tuple[int, ...]) -> bool:
        return all(effect.least <= i * effect.step <= effect.most for i, effect in zip(at, self.effects, strict=True))

    def _beside(self, at: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Nodes beside one, across corners too: a gap and a mate that wears it away lie in a valley along the diagonal."""
        places = [tuple(np.add(at, way).tolist()) for way in itertools.product((0, 1, -1), repeat=len(at)) if any(way)]
        return [place for place in places if self._allowed(place)]

    def _between(self, at: tuple[int, ...], offset: list[float]) -> Floats:
        """Depths beside a node, linear in each size, up to one step off; offsets in steps."""
        ways = [1 if value > 0.0 else -1 for value in offset]
        whole = np.zeros_like(self._node(at))
        for corner in itertools.product((0, 1), repeat=len(at)):
            share = math.prod(abs(v) if c else 1.0 - abs(v) for v, c in zip(offset, corner, strict=True))
            if share > 0.0:
                whole += share * self._node(tuple(i + c * way for i, c, way in zip(at, corner, ways, strict=True)))
        return whole

    def _refined(self, at: tuple[int, ...], judged: Callable[[Floats], tuple[float, float]]) -> list[float]:
        """Offsets from a node, in steps, at which the cost is least."""
        from scipy.optimize import minimize

        if not at:
            return []
        bounds = [
            (0.0 if i * e.step <= e.least else -1.0, 0.0 if i * e.step >= e.most else 1.0)
            for i, e in zip(at, self.effects, strict=True)
        ]
        solved = minimize(
            lambda v: judged(self._between(at, v.tolist()))[0],
            np.zeros(len(at)), method="Powell", bounds=bounds, options={"xtol": 0.01, "ftol": 1e-4},
        )  # fmt: skip
        return [float(v) for v in np.atleast_1d(solved.x)]


def _nearest(history: Floats, wanted: Floats) -> tuple[float, float]:
    """Least square of the distance of a course (t, m) from a point (m,), and where on it that is, in steps; linear between."""
    start, way = history[:-1], np.diff(history, axis=0)
    off = wanted - start
    part = np.clip((off * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-300), 0.0, 1.0)
    square = ((off - part[:, None] * way) ** 2).sum(axis=1)
    i = int(square.argmin())
    return float(square[i]), i + float(part[i])


def _at(history: Floats, place: float) -> Floats:
    """A course (t, m) at a place in steps."""
    i = min(int(place), len(history) - 2)
    return np.asarray(history[i] + (place - i) * (history[i + 1] - history[i]), dtype=np.float64)
