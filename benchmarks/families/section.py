"""The transverse section of a gear: its root by brute force, its flank the exact involute, its tip turned."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from benchmarks.families.gear import Array, GearNumbers
from benchmarks.families.rack import Tool, space_half_angle

SAME = 1e-10
"""How far (mm) the enveloped flank may be from the involute where it counts as involute."""


@dataclass(frozen=True, eq=False)
class Section:
    """Half a space and half a tooth.

    Parameters
    ----------
    gear : GearNumbers
    form_radius : float
        Where the involute begins.
    root_angle, root_radius : (n,) float
        From the middle of the space to the form circle: angle from the **tooth's** centre line, radius.
    root_length : (n,) float
        Length along it, from 0.
    """

    gear: GearNumbers
    form_radius: float
    root_angle: Array
    root_radius: Array
    root_length: Array

    @property
    def form_roll(self) -> float:
        return self.gear.roll(self.form_radius)

    def root_at(self, length: Array) -> tuple[Array, Array, Array, Array]:
        """Radius and half angle at a length along the root, and its outward normal (radial, away from the tooth's middle)."""
        radius = np.interp(length, self.root_length, self.root_radius)
        angle = np.interp(length, self.root_length, self.root_angle)
        step = 1e-3 * self.root_length[-1]
        low, high = np.clip(length - step, 0.0, None), np.clip(length + step, None, self.root_length[-1])
        dr = np.interp(high, self.root_length, self.root_radius) - np.interp(low, self.root_length, self.root_radius)
        dt = radius * (np.interp(high, self.root_length, self.root_angle) - np.interp(low, self.root_length, self.root_angle))
        size = np.hypot(dr, dt) + 1e-300
        return radius, angle, -dt / size, dr / size  # climbing (dr > 0) the root turns its face away from the tooth's middle

    def half_angle(self, radius: Array) -> Array:
        """Half the angle of the nominal tooth at a radius: π/z within the root circle, −1 outside the tip."""
        rho = np.asarray(radius, dtype=np.float64)
        gear = self.gear
        roll = np.sqrt(np.maximum(rho**2 - gear.base_radius**2, 0.0))
        turned = self.root_radius > self.root_radius[0] + 1e-12
        first = max(int(np.argmax(turned)) - 1, 0)
        root = np.interp(rho, self.root_radius[first:], self.root_angle[first:])
        angle = np.where(rho >= self.form_radius, gear.half_angle(roll), root)
        angle = np.where(rho < self.root_radius[0], math.pi / gear.teeth, angle)
        return np.where(rho > gear.tip_radius, -1.0, angle)

    def area(self) -> float:
        """Of the whole section without a bore, by the trapezium rule over the radius, mm²."""
        low, high = self.root_radius[0], self.gear.tip_radius
        share = np.linspace(0.0, 1.0, 20001)
        rho = low + (high - low) * share**2  # the root leaves its circle like a square root
        width = 2.0 * self.gear.teeth * self.half_angle(np.minimum(rho, high)) * rho
        width[0] = 2.0 * self.gear.teeth * self.half_angle(np.array([low + 1e-9]))[0] * low
        return float(math.pi * low**2 + np.trapezoid(width, rho))


@lru_cache(maxsize=16)
def section(gear: GearNumbers, tools: tuple[Tool, ...]) -> Section:
    """Section of a gear that `tools` cut; one of them must reach the gear's own flank.

    Parameters
    ----------
    gear : GearNumbers
    tools : tuple of Tool

    Raises
    ------
    ValueError
        If no involute is left.
    """
    deepest = max(tool.depth for tool in tools)
    root = gear.reference_radius + gear.module * (gear.profile_shift - deepest)
    top = gear.tip_radius
    share = np.linspace(0.0, 1.0, 1500)[1:]
    radii = root + (top - root) * share**2
    radii = np.concatenate([root + (top - root) * np.geomspace(1e-8, share[0] ** 2, 40)[:-1], radii])
    angle = math.pi / gear.teeth - space_half_angle(gear, tools, radii)
    involute = radii >= gear.base_radius
    exact = gear.half_angle(np.sqrt(np.maximum(radii**2 - gear.base_radius**2, 0.0)))
    away = ~involute | (np.abs(angle - exact) * radii > SAME)
    away[radii > top - 1e-9] = False
    if not away.any() or away[-2]:
        raise ValueError("no tool reaches the gear's flank, or no involute is left")
    last = int(np.nonzero(away)[0][-1])
    form = _bisect(gear, tools, radii[last], radii[last + 1])
    below = radii[: last + 1]
    flat = np.linspace(math.pi / gear.teeth, angle[0], 60)
    angles = np.concatenate([flat, angle[: last + 1], gear.half_angle(np.array([gear.roll(form)]))])
    rs = np.concatenate([np.full(60, root), below, [form]])
    step = np.hypot(np.diff(rs), 0.5 * (rs[1:] + rs[:-1]) * np.diff(angles))
    return Section(gear, form, angles, rs, np.concatenate([[0.0], np.cumsum(step)]))


def _bisect(gear: GearNumbers, tools: tuple[Tool, ...], low: float, high: float) -> float:
    for _ in range(24):
        middle = 0.5 * (low + high)
        angle = math.pi / gear.teeth - space_half_angle(gear, tools, np.array([middle]))[0]
        exact = float(gear.half_angle(gear.roll(middle)))
        if middle < gear.base_radius or abs(angle - exact) * middle > SAME:
            low = middle
        else:
            high = middle
    return high
