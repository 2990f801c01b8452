"""Flanks of an unknown gear: base circle, tooth thickness, centre and phase from the points, without a module or pressure angle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Floats
from gearwear.measure.robust import median_scale, tukey_weight

FLANK = (0.45, 0.88)
"""Part of the tooth height, from the root up, that is taken for involute whatever the tool and the tip."""


@dataclass(frozen=True, slots=True)
class FreeInvolute:
    """The involute that fits all flanks.

    Parameters
    ----------
    centre : (2,) float
        mm.
    phase : float
        Polar angle of a tooth's centre line, rad.
    base_radius, base_half_angle : float
        r_b in mm, and the half angle ψ_b of a tooth at the base circle in rad.
    covariance : (2, 2) float
        Of base_radius and base_half_angle.
    middle : float
        Mean radius of the points used, mm: where the thickness is best known.
    scatter : float
        Robust standard deviation of the points, mm.
    """

    centre: Floats
    phase: float
    base_radius: float
    base_half_angle: float
    covariance: Floats
    middle: float
    scatter: float

    def thickness(self, radius: float) -> float:
        """Arc thickness of a tooth at `radius`, mm."""
        angle = math.acos(self.base_radius / radius)
        return 2.0 * radius * (self.base_half_angle - math.tan(angle) + angle)


def fit_involute(points: Floats, centre: Floats, teeth: int, phase: float, root: float, tip: float) -> FreeInvolute | None:
    """Fit an involute to the flanks of a gear.

    Parameters
    ----------
    points : (n, 2) float
        Points in the plane of rotation, mm.
    centre : (2,) float
        About right, mm.
    teeth : int
        z.
    phase : float
        Polar angle of a tooth, about right, rad.
    root, tip : float
        Ends of the teeth, mm.

    Returns
    -------
    FreeInvolute or None
        None where there are too few flank points or no involute passes through them.

    Notes
    -----
    Deviation as in `gearwear.design.surface.locate`; its derivative with the base radius is −L / r_b, with the half angle −r_b.
    Gauss-Newton with Tukey weights, from the median half angle in rings.
    """
    pitch = 2.0 * math.pi / teeth
    low, high = (root + share * (tip - root) for share in FLANK)
    start = _start(points - centre, phase, pitch, low, high)
    if start is None:
        return None
    rb, psi = start
    centre = centre.copy()
    for _ in range(40):
        offset = points - centre
        r = np.hypot(offset[:, 0], offset[:, 1])
        used = (r > max(low, 1.0005 * rb)) & (r < high)
        if used.sum() < 50:
            return None
        r, angle = r[used], np.arctan2(offset[used, 1], offset[used, 0])
        within = np.mod(angle - phase + 0.5 * pitch, pitch) - 0.5 * pitch
        side = np.where(within < 0.0, -1.0, 1.0)
        roll = np.sqrt(r * r - rb * rb)
        deviation = rb * (np.abs(within) - psi) + roll - rb * np.arccos(rb / r)
        nx = (roll * np.cos(angle) - side * rb * np.sin(angle)) / r
        ny = (roll * np.sin(angle) + side * rb * np.cos(angle)) / r
        columns = -np.column_stack([nx, ny, side * rb, roll / rb, np.full_like(r, rb)])
        scale = max(median_scale(deviation)[1], 1e-9)
        weight = tukey_weight(deviation, scale)
        information = columns.T @ (columns * weight[:, None])
        if np.linalg.cond(information) > 1e14:
            return None
        step = np.linalg.solve(information, -columns.T @ (weight * deviation))
        # Far from the flank a step is a guess: never more than a fifth of the tooth height at the tip.
        size = np.abs(step * [1.0, 1.0, tip, 1.0, rb]).max()
        step *= min(1.0, 0.2 * (tip - root) / max(size, 1e-300))
        centre, phase, rb, psi = centre + step[:2], phase + step[2], rb + step[3], psi + step[4]
        if not 0.3 * tip < rb < 0.999 * high:
            return None
        if size < 1e-7 * tip:
            break
    covariance: Floats = np.asarray(scale**2 * np.linalg.inv(information)[3:, 3:], dtype=np.float64)
    return FreeInvolute(centre, phase, float(rb), float(psi), covariance, float(np.mean(r)), scale)


def _start(offset: Floats, phase: float, pitch: float, low: float, high: float) -> tuple[float, float] | None:
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
        own = half + np.tan(angle) - angle
        miss = float(np.var(own))
        if miss < best:
            best, chosen = miss, (float(base), float(own.mean()))
    return chosen
