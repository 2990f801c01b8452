"""Which points a scanner sees: from several directions, at no grazing angle, nothing in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.families.gear import Array, Bools, Ints
from benchmarks.families.part import Part
from benchmarks.families.sampling import Points

STEPS = 28
DEEPEST = 0.4
"""Modules by which a flank may be worn without hiding itself; what lies deeper is the surface of a fracture."""


@dataclass(frozen=True)
class Views:
    """Directions of sight: `azimuths` of them round the gear on each of the `elevations` (degrees).

    Parameters
    ----------
    azimuths : int
    elevations : tuple of float
    grazing : float
        Least cosine of the angle of incidence that is seen.
    turn : float
        Of the first direction, degrees.
    """

    azimuths: int = 14
    elevations: tuple[float, ...] = (-40.0, 0.0, 40.0)
    grazing: float = 0.17
    turn: float = 0.0

    def sector(self, which: int, of: int) -> tuple[int, ...]:
        """Numbers of the views in one of several equal sectors round the gear."""
        return tuple(v for v in range(self.azimuths * len(self.elevations)) if (v % self.azimuths) * of // self.azimuths == which)

    def directions(self) -> Array:
        """From the gear to the scanner, (views, 3)."""
        ways = [
            (math.radians(self.turn + 360.0 * (i + 0.5 * j) / self.azimuths), math.radians(up))
            for j, up in enumerate(self.elevations)
            for i in range(self.azimuths)
        ]
        return np.array([[math.cos(up) * math.cos(a), math.cos(up) * math.sin(a), math.sin(up)] for a, up in ways])


def seen(part: Part, points: Points, views: Views, rng: np.random.Generator) -> tuple[Ints, Ints, Array]:
    """Give each point a view, and keep it where that view sees it.

    Returns
    -------
    kept : (k,) int
        Indices of the points.
    view : (k,) int
    cosine : (k,) float
        Of the angle of incidence.
    """
    ways = views.directions()
    cosine = points.normal @ ways.T
    cosine[cosine < views.grazing] = 0.0
    total = np.cumsum(cosine, axis=1)
    drawn = rng.random(len(points)) * np.maximum(total[:, -1], 1.0)  # where few see it, points are few
    view = (total < drawn[:, None]).sum(axis=1)
    kept = np.nonzero(view < len(ways))[0]
    view = view[kept]
    own = cosine[kept, view]
    free = clear(part, points.xyz[kept] + 0.004 * part.gear.module * points.normal[kept], ways[view])
    return kept[free], view[free], own[free]


def clear(part: Part, points: Array, ways: Array) -> Bools:
    """Whether nothing of the gear as cut lies on the ray from each point; what is worn there or broken off hides nothing.

    A point in a hollow lies inside the gear as cut, by as much as was lost: by so much its own tooth is taken to be thinner on its ray.
    """
    gear, sec = part.gear, part.section
    reach = 2.2 * math.pi * gear.module + (gear.tip_radius - sec.root_radius[0])
    free = np.ones(len(points), dtype=bool)
    rows = np.linspace(sec.root_radius[0], gear.tip_radius, 400)
    table = sec.half_angle(rows)

    def inside(at: Array) -> tuple[Array, Array]:
        """Tooth, and angle (rad) to the nearest flank of the gear as cut: positive in metal."""
        rho, theta = np.hypot(at[:, 0], at[:, 1]), np.arctan2(at[:, 1], at[:, 0])
        tooth = np.round(theta / gear.pitch_angle)
        metal = np.interp(rho, rows, table, left=math.pi) - np.abs(theta - tooth * gear.pitch_angle)
        return tooth, np.where(rho < gear.tip_radius, metal, -math.pi)

    first, worn = inside(points)
    worn = np.clip(worn, 0.0, DEEPEST * gear.module / gear.reference_radius)
    for step in reach * (np.arange(1, STEPS + 1) / STEPS) ** 1.5:
        at = points + step * ways
        rho = np.hypot(at[:, 0], at[:, 1])
        tooth, metal = inside(at)
        blocked = metal > np.where(tooth == first, worn, 0.0)
        blocked &= (at[:, 2] > 0.0) & (at[:, 2] < gear.face_width)
        for cut in part.cuts:
            near = np.nonzero(blocked & (np.mod(tooth, gear.teeth) == cut.tooth) & (rho > sec.root_radius[0]))[0]
            blocked[near] = cut.beyond(at[near]) <= 0.0
        free &= ~blocked
    return free
