"""Flanks of an unknown gear: base circle, tooth thickness, centre and phase from the points, without a module or pressure angle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.side import Side
from gearwear.robust import median_scale, tukey_weight

FLANK = (0.45, 0.88)
"""Part of the tooth height, from the root up, that is taken for involute whatever the tool and the tip."""
WORN_RATIO = 1.4
"""A side this much rougher than the other is worn throughout."""


@dataclass(frozen=True, slots=True)
class FreeInvolute:
    """The involute that fits all flanks.

    Parameters
    ----------
    centre : (2,) float
        At height 0, mm.
    lean : (2,) float
        How far the axis moves in x and y per mm of height: 0 where it is square to the plane.
    phase : float
        Polar angle of a tooth's centre line, rad.
    base_radius, base_half_angle : float
        r_b in mm, and the half angle ψ_b of a tooth at the base circle in rad.
    covariance : (2, 2) float
        Of base_radius and base_half_angle.
    middle : float
        Mean radius of the points used, mm: where the thickness is best known.
    roll : float
        Length of roll that the points used cover, mm: a profile slope over it looks like another base circle.
    scatter : float
        Robust standard deviation of the points, mm; of the better side where the other is worn.
    worn_side : Side or None
        Where the flanks of that side are so much rougher that only their place was used.
    worn_scatter : float
        Robust standard deviation of the points of that side, mm: about as much it may have lost on average; 0 without one.
    twist : float
        Turn of the teeth per height, rad/mm: positive for a right hand; 0 where it was not sought.
    twist_std : float
        Its standard deviation, from how the teeth differ.
    """

    centre: Floats
    lean: Floats
    phase: float
    base_radius: float
    base_half_angle: float
    covariance: Floats
    middle: float
    roll: float
    scatter: float
    worn_side: Side | None
    twist: float = 0.0
    twist_std: float = 0.0
    worn_scatter: float = 0.0

    @property
    def base_helix_angle(self) -> float:
        """β_b = atan(twist · r_b), rad: positive for a right hand."""
        return math.atan(self.twist * self.base_radius)

    @property
    def base_helix_std(self) -> float:
        """Standard deviation of the base helix angle, rad."""
        return self.twist_std * self.base_radius * math.cos(self.base_helix_angle) ** 2

    def thickness(self, radius: float) -> float:
        """Arc thickness of a tooth at `radius`, mm."""
        angle = math.acos(min(self.base_radius / radius, 1.0))
        return 2.0 * radius * (self.base_half_angle - math.tan(angle) + angle)


def fit_involute(
    points: Floats,
    height: Floats | None,
    centre: Floats,
    teeth: int,
    phase: float,
    root: float,
    tip: float,
    twist: float | None = None,
) -> FreeInvolute | None:
    """Fit an involute to the flanks of a gear.

    Parameters
    ----------
    points : (n, 2) float
        Points in the plane of rotation, mm.
    height : (n,) float or None
        Along the axis, mm; None for a planar section: then the axis does not lean.
    centre : (2,) float
        About right, mm.
    teeth : int
        z.
    phase : float
        Polar angle of a tooth, about right, rad.
    root, tip : float
        Ends of the teeth, mm.
    twist : float or None
        Turn of the teeth per height, about right, rad/mm; None: of spur gears, where it is 0.

    Returns
    -------
    FreeInvolute or None
        None where there are too few flank points or no involute passes through them.

    Notes
    -----
    Deviation as in `gearwear.design.surface.locate`; its derivative with the base radius is −L / r_b, with the half angle −r_b.
    Gauss-Newton with Tukey weights, from the median half angle in rings. Where the flanks of one side are much rougher than the
    other's (worn throughout), the shape is taken from the better side and only the thickness from both.
    """
    pitch = 2.0 * math.pi / teeth
    low, high = (root + share * (tip - root) for share in FLANK)
    flat = np.zeros(len(points)) if height is None else height
    start = _start(points - centre, phase + (twist or 0.0) * flat, pitch, low, high)
    if start is None:
        return None
    state = np.array([*centre, phase, *start, 0.0, 0.0, twist or 0.0])
    free = [0, 1, 2, 3, 4] if height is None else [0, 1, 2, 3, 4, 5, 6] if twist is None else [*range(8)]
    fitted = _iterate(points, flat, state, free, 0, pitch, low, high, tip)
    if fitted is None:
        return None
    state, covariance, scatter = fitted
    used, side, deviation, _ = _deviations(points, flat, state, pitch, low, high)
    rough = [median_scale(deviation[side == sign])[1] for sign in Side]
    worn: Side | None = None
    if max(rough) > WORN_RATIO * min(rough):
        worn = Side.LEFT if rough[0] > rough[1] else Side.RIGHT
        # One side cannot tell phase from thickness: the half angle stays, then the other side's middle sets both.
        fitted = _iterate(points, flat, state, [i for i in free if i != 4], worn.opposite, pitch, low, high, tip)
        if fitted is None:
            return None
        state, covariance, scatter = fitted
        used, side, deviation, _ = _deviations(points, flat, state, pitch, low, high)
        half = 0.5 * median_scale(deviation[side == worn])[0] / state[3]
        state[4] += half
        state[2] += worn * half
    radius = np.hypot(*(points[used] - state[:2]).T)
    low, high = np.quantile(radius, [0.02, 0.98])
    roll = math.sqrt(max(high**2 - state[3] ** 2, 0.0)) - math.sqrt(max(low**2 - state[3] ** 2, 0.0))
    spread = math.nan
    if twist is not None:
        spread = _twist_std(points[used] - state[:2], flat[used], side, deviation, state, pitch)
    return FreeInvolute(
        centre=state[:2],
        lean=state[5:7],
        phase=float(state[2]),
        base_radius=float(state[3]),
        base_half_angle=float(state[4]),
        covariance=covariance,
        middle=float(np.mean(radius)),
        roll=roll,
        scatter=scatter,
        worn_side=worn,
        twist=float(state[7]),
        twist_std=spread,
        worn_scatter=0.0 if worn is None else median_scale(deviation[side == worn])[1],
    )


def _twist_std(offset: Floats, height: Floats, side: Floats, deviation: Floats, state: Floats, pitch: float) -> float:
    """Standard deviation of the twist, rad/mm: of the mean of what the flanks one by one would add to it; nan where there are under three."""
    angle = np.arctan2(offset[:, 1], offset[:, 0]) - state[2] - state[7] * height
    flank = np.rint(angle / pitch).astype(np.int64) * 2 + (side > 0.0)
    near = np.abs(deviation) < 4.0 * median_scale(deviation)[1]
    _, index = np.unique(flank[near], return_inverse=True)
    z, d = height[near], side[near] * deviation[near]
    n, sz, sd, szz, szd = (np.bincount(index, w) for w in (np.ones(len(z)), z, d, z * z, z * d))
    enough = n >= 20
    if enough.sum() < 3:
        return math.nan
    slope = ((n * szd - sz * sd)[enough] / (n * szz - sz * sz)[enough]) / state[3]
    return median_scale(slope)[1] * math.sqrt(0.5 * math.pi / len(slope))


def _deviations(
    points: Floats, height: Floats, state: Floats, pitch: float, low: float, high: float
) -> tuple[Ints, Floats, Floats, Floats]:
    """Points used, their side (±1), deviation (mm) in the plane of rotation, and its derivatives with the eight numbers of the state."""
    x, y, phase, rb, psi, *lean, twist = state
    offset = points - [x, y] - np.outer(height, lean)
    r = np.hypot(offset[:, 0], offset[:, 1])
    used = np.flatnonzero((r > max(low, 1.0005 * rb)) & (r < high))
    offset, z = offset[used], height[used]
    r, angle = r[used], np.arctan2(offset[:, 1], offset[:, 0])
    # About a leaning axis the height changes too, which turns the teeth of a helical gear.
    within = np.mod(angle - phase - twist * (z + offset @ lean) + 0.5 * pitch, pitch) - 0.5 * pitch
    side = np.where(within < 0.0, -1.0, 1.0)
    roll = np.sqrt(r * r - rb * rb)
    deviation = rb * (np.abs(within) - psi) + roll - rb * np.arccos(rb / r)
    nx = (roll * np.cos(angle) - side * rb * np.sin(angle)) / r
    ny = (roll * np.sin(angle) + side * rb * np.cos(angle)) / r
    turning = side * rb
    climb = (twist * turning)[:, None] * offset
    columns = -np.column_stack(
        [nx, ny, turning, roll / rb, np.full_like(r, rb), nx * z + climb[:, 0], ny * z + climb[:, 1], turning * z]
    )
    return used, side, deviation, columns


def _iterate(
    points: Floats, height: Floats, state: Floats, free: list[int], only: int, pitch: float, low: float, high: float, tip: float
) -> tuple[Floats, Floats, float] | None:
    """State, covariance of (r_b, ψ_b) and scatter after a robust fit of some of the state to both sides or `only` one; None: lost."""
    state = state.copy()
    far = np.abs(height).max()
    reach = np.array([1.0, 1.0, tip, 1.0, tip, far, far, tip * far])  # mm at the tip, per unit
    for _ in range(40):
        _, side, deviation, columns = _deviations(points, height, state, pitch, low, high)
        if only:
            deviation, columns = deviation[side == only], columns[side == only]
        if len(deviation) < 50:
            return None
        columns = columns[:, free]
        scale = max(median_scale(deviation)[1], 1e-9)
        weight = tukey_weight(deviation, scale)
        information = columns.T @ (columns * weight[:, None])
        if not np.linalg.cond(information) < 1e14:
            return None
        step = np.linalg.solve(information, -columns.T @ (weight * deviation))
        # Far from the flank a step is a guess: never more than a good part of the flank.
        size = float(np.abs(step * reach[free]).max())
        state[free] += step * min(1.0, 0.4 * (high - low) / max(size, 1e-300))
        if not 0.3 * tip < state[3] < 0.999 * high:
            return None
        if size < 1e-7 * tip:
            break
    spread = np.zeros((8, 8))
    spread[np.ix_(free, free)] = scale**2 * np.linalg.inv(information)
    return state, spread[3:5, 3:5], scale


def _start(offset: Floats, phase: Floats, pitch: float, low: float, high: float) -> tuple[float, float] | None:
    """Base radius and half angle that pass best through the median half angle of rings."""
    r = np.hypot(offset[:, 0], offset[:, 1])
    within = np.abs(np.mod(np.arctan2(offset[:, 1], offset[:, 0]) - phase + 0.5 * pitch, pitch) - 0.5 * pitch)
    edges = np.linspace(low, high, 13)
    rings = [(0.5 * (a + b), np.median(within[at])) for a, b in pairwise(edges) if (at := (r > a) & (r < b)).sum() >= 5]
    if len(rings) < 4:
        return None
    middle, half = np.array(rings).T
    best, chosen = math.inf, None
    for base in np.linspace(0.75, 0.999, 250) * middle[0]:
        angle = np.arccos(base / middle)
        at_base = half + np.tan(angle) - angle
        miss = float(np.var(at_base))
        if miss < best:
            best, chosen = miss, (float(base), float(at_base.mean()))
    return chosen
