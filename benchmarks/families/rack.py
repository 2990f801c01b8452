"""The root of a generated gear by brute force: how far any point of the tools gets, at any position of the generating roll.

No equation of meshing is solved and no trochoid is written down. A point of a rack-shaped tool at the height y above the
pitch line and x beside the middle of its tooth passes the radius ρ of the rolling blank twice, where x + s = ±√(ρ² − (r + y)²);
the angle it has there in the blank is ±acos((r + y)/ρ) − s/r. The space of the gear at ρ reaches as far as the farthest of all
points of all tools.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.families.gear import Array, GearNumbers


@dataclass(frozen=True)
class Tool:
    """A rack-shaped tool: the teeth of a hob, or of a grinding wheel's reference profile.

    Parameters
    ----------
    depth : float
        From the reference line to the tip of the tool's tooth, modules.
    tip_radius : float
        Modules; `math.inf`: as large as there is room for (full fillet).
    stock : float
        Left on every flank for a finishing tool, mm along the normal.
    protuberance : float
        The tool's flank near its tip stands out by it, mm along the normal.
    """

    depth: float = 1.25
    tip_radius: float = 0.30
    stock: float = 0.0
    protuberance: float = 0.0

    def outline(self, gear: GearNumbers, number: int = 2400) -> tuple[Array, Array]:
        """Half a tooth of the tool from the middle of its tip outwards: (x, y), y from the gear's pitch line outwards, mm."""
        m, alpha = gear.module, gear.alpha
        tan, cos = math.tan(alpha), math.cos(alpha)
        depth, wide = self.depth * m, 0.25 * math.pi * m + 0.5 * gear.thinning
        flank = wide - self.stock / cos  # half width on the reference line
        tip = flank + self.protuberance / cos
        room = (tip - depth * tan) / (1.0 / cos - tan)  # of the greatest tip radius
        radius = min(self.tip_radius * m, room)
        centre = tip - (depth - radius) * tan - radius / cos
        start = -depth + radius * (1.0 - math.sin(alpha))  # height where the tip arc ends
        turn = np.linspace(0.0, 0.5 * math.pi - alpha, number // 3)
        parts = [np.column_stack([np.linspace(0.0, centre, 200), np.full(200, -depth)])]
        parts.append(np.column_stack([centre + radius * np.sin(turn), -depth + radius * (1.0 - np.cos(turn))]))
        top = gear.tip_radius - gear.reference_radius - gear.profile_shift * m + 0.2 * m
        if self.protuberance > 0.0:
            end = start + 0.10 * m
            ramp = end + self.protuberance / math.tan(math.radians(10.0))
            y = np.linspace(start, end, number // 8)
            parts.append(np.column_stack([tip + y * tan, y]))
            share = np.linspace(0.0, 1.0, number // 8)
            y = end + share * (ramp - end)
            parts.append(np.column_stack([tip - share * self.protuberance / cos + y * tan, y]))
            start = ramp
        y = np.linspace(start, top, number)
        parts.append(np.column_stack([flank + y * tan, y]))
        points = np.concatenate(parts)
        points = points[np.r_[True, np.hypot(*np.diff(points, axis=0).T) > 1e-12 * m]]  # where parts meet
        return points[:, 0], points[:, 1] + gear.profile_shift * m


def space_half_angle(gear: GearNumbers, tools: tuple[Tool, ...], radii: Array) -> Array:
    """Half the angle of the space that the tools cut, at each radius; 0 where no tool gets to.

    Parameters
    ----------
    gear : GearNumbers
    tools : tuple of Tool
        The space is what all of them take together.
    radii : (n,) float
        mm.
    """
    best = np.zeros(len(radii))
    for tool in tools:
        x, y = tool.outline(gear)
        for start in range(0, len(radii), 100):
            part = slice(start, start + 100)
            best[part] = np.maximum(best[part], _farthest(gear.reference_radius, x, y, radii[part]))
    return best


def _farthest(pitch: float, x: Array, y: Array, radii: Array) -> Array:
    """The greatest angle over all points of an outline: among its corners, then ever closer round the best of them."""
    best = np.maximum(
        np.interp(radii - pitch, y, x, left=-np.inf) / pitch, 0.0
    )  # what only just reaches a radius, on the middle line
    for sign in (1.0, -1.0):
        shape = (len(radii), len(x))
        low, high = np.zeros(len(radii)), np.full(len(radii), len(x) - 1.0)
        at, gx, gy = np.arange(len(x), dtype=np.float64), np.broadcast_to(x, shape), np.broadcast_to(y, shape)
        place = np.broadcast_to(at, shape)
        for _ in range(9):
            angle = _angle(pitch, gx, gy, radii[:, None], sign)
            i = np.argmax(angle, axis=1)
            rows = np.arange(len(radii))
            best = np.maximum(best, angle[rows, i])
            low = place[rows, np.maximum(i - 1, 0)]
            high = place[rows, np.minimum(i + 1, place.shape[1] - 1)]
            place = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, 41)
            gx, gy = np.interp(place, at, x), np.interp(place, at, y)
    return best


def _angle(pitch: float, x: Array, y: Array, rho: Array, sign: float) -> Array:
    """Angle in the blank where points of the tool pass the radius ρ, coming (−) or going (+); −∞ where they do not reach it."""
    centre = pitch + y
    reached = rho >= centre
    half = np.sqrt(np.where(reached, rho**2 - centre**2, 0.0))
    psi = np.arctan2(half, centre)
    return np.where(reached, sign * psi - (sign * half - x) / pitch, -np.inf)
