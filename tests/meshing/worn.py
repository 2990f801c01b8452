"""Gears with wear that is known in closed form, for the contact tests."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles, nominal_profiles


def design(gear: Gear, radii: int = 120, slices: int = 1, extra: Iterable[float] = ()) -> ToothProfiles:
    """The nominal gear on even radii (and some more)."""
    radius = np.unique(np.concatenate([np.linspace(gear.root_radius, gear.tip_radius, radii), list(extra)]))
    z = (np.arange(slices) + 0.5) * gear.face_width / slices
    return nominal_profiles(gear, radius, z)


def roll_of(profiles: ToothProfiles) -> Floats:
    """Length of roll of each radius, 0 below the base circle."""
    rb = profiles.gear.base_radius
    return np.sqrt(np.maximum(profiles.radius**2 - rb**2, 0.0))


def wear(
    profiles: ToothProfiles, depth: float | Floats | Callable[[Floats], Floats], teeth: Iterable[int], side: int = 0
) -> ToothProfiles:
    """Normal depth (mm) off one side of some teeth, root zone included: a number, per radius, or a function of L."""
    lost = depth(roll_of(profiles)) if callable(depth) else depth
    half_angle = profiles.half_angle.copy()
    half_angle[list(teeth), side] -= lost / profiles.gear.base_radius
    return replace(profiles, half_angle=half_angle)


def sliding_like(roll: Floats) -> Floats:
    """0.1 mm at the form circle, 0 at the pitch point: the reference's wear in proportion to |L − L_C|."""
    return 0.1 * np.abs(roll - 13.03) / 9.97


def rough(profiles: ToothProfiles, seed: int, size: float = 0.03) -> ToothProfiles:
    """Correlated random deviations of every flank, mm: scan-like, different on every tooth, side and slice."""
    random = np.random.default_rng(seed)
    *lead, n = profiles.half_angle.shape
    kernel = np.exp(-0.5 * (np.arange(-6, 7) / 2.0) ** 2)
    noise = random.normal(size=(*lead, n + 12))
    smooth = np.apply_along_axis(lambda row: np.convolve(row, kernel / np.sqrt((kernel**2).sum()), "valid"), -1, noise)
    return replace(profiles, half_angle=profiles.half_angle + size * smooth / profiles.gear.base_radius)
