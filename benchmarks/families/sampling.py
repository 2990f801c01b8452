"""Points at random per unit of area on every surface of a part; no grid, no sections."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.families.gear import Array, Bools, Ints, flank_point
from benchmarks.families.part import Part

ROOT, FLANK, TIP, END, BORE, BROKEN = range(6)


@dataclass(frozen=True, eq=False)
class Points:
    """Points of a surface, design frame, mm.

    Parameters
    ----------
    xyz, normal : (n, 3) float
    kind : (n,) int
        ROOT … BROKEN.
    tooth, side : (n,) int
        Of flanks, roots and tips; the tooth of an end face's point is the nearest.
    edge : (n,) float
        Distance to the nearest sharp edge, mm.
    """

    xyz: Array
    normal: Array
    kind: Ints
    tooth: Ints
    side: Ints
    edge: Array

    def take(self, which: Bools | Ints) -> Points:
        return Points(*(getattr(self, name)[which] for name in ("xyz", "normal", "kind", "tooth", "side", "edge")))

    def __len__(self) -> int:
        return len(self.xyz)

    @classmethod
    def join(cls, parts: list[Points]) -> Points:
        return cls(
            *(np.concatenate([getattr(p, name) for p in parts]) for name in ("xyz", "normal", "kind", "tooth", "side", "edge"))
        )


def sample(part: Part, number: int, rng: np.random.Generator, ends: float = 0.35, hub: float = 1.2) -> Points:
    """About `number` points, by area.

    Parameters
    ----------
    part : Part
    number : int
        Drawn; fewer come back, where a surface is not there.
    rng : numpy.random.Generator
    ends : float
        Density on the end faces over that on the teeth.
    hub : float
        How far within the root circle the end faces are seen, modules.
    """
    gear, sec = part.gear, part.section
    b, z = gear.face_width, gear.teeth
    deepest = 0.05 * gear.module if part.wear else 0.0
    for field in part.wear:
        deepest = max(deepest, 2.0 * float(getattr(field, "depth", 0.0)))
    top = gear.tip_roll + deepest + 0.02 * gear.module
    arc = (top**2 - sec.form_roll**2) / (2.0 * gear.base_radius)
    land = gear.tip_radius * (float(gear.half_angle(gear.tip_roll)) + 0.02)
    inner = 0.5 * gear.bore if gear.bore else max(sec.root_radius[0] - hub * gear.module, 0.3 * gear.tip_radius)
    reach = 2.0 * (gear.tip_radius - sec.root_radius[0]) + b
    areas = np.array([
        2 * z * sec.root_length[-1] * b, 2 * z * arc * b, 2 * z * land * b,
        2.0 * ends * math.pi * (gear.tip_radius**2 - inner**2), math.pi * gear.bore * b,
        *(cut.size(reach) for cut in part.cuts),
    ])  # fmt: skip
    counts = rng.multinomial(number, areas / areas.sum())
    parts = [
        _root(part, counts[0], rng),
        _flank(part, counts[1], top, rng),
        _tip(part, counts[2], land, rng),
        _ends(part, counts[3], inner, rng),
    ]
    if gear.bore:
        parts.append(_bore(part, counts[4], rng))
    parts += [_broken(part, i, counts[5 + i], reach, rng) for i in range(len(part.cuts))]
    points = Points.join(parts)
    keep = np.ones(len(points), dtype=bool)
    if part.cuts:
        rho = np.hypot(points.xyz[:, 0], points.xyz[:, 1])
        for cut in part.cuts:
            of = (points.tooth == cut.tooth) & np.isin(points.kind, (ROOT, FLANK, TIP, END)) & (rho > sec.root_radius[0] + 1e-6)
            keep[of] &= cut.beyond(points.xyz[of]) <= 0.0
    return points.take(keep)


def _of_teeth(part: Part, number: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    tooth = rng.integers(part.gear.teeth, size=number).astype(float)
    return tooth, rng.choice([-1.0, 1.0], number), rng.uniform(0.0, part.gear.face_width, number)


def _ends_edge(part: Part, z: Array) -> Array:
    return np.minimum(z, part.gear.face_width - z)


def _pack(xy: Array, normal: Array, z: Array, kind: int, tooth: Array, side: Array, edge: Array) -> Points:
    n = len(z)
    return Points(
        np.column_stack([xy, z]),
        np.column_stack([normal, np.zeros(n)]),
        np.full(n, kind),
        tooth.astype(int),
        side.astype(int),
        edge,
    )


def _root(part: Part, number: int, rng: np.random.Generator) -> Points:
    tooth, side, z = _of_teeth(part, number, rng)
    sec, gear = part.section, part.gear
    rho, angle, radial, around = sec.root_at(rng.uniform(0.0, sec.root_length[-1], number))
    # A flank as made takes its fillet along: by the same turn about the axis, which leaves the bottom where it is.
    turn = part.as_made(tooth, side, np.full(number, part.frame.form), z) / gear.base_radius
    shift = turn * rho * around
    theta = tooth * gear.pitch_angle + side * angle
    e, t = np.column_stack([np.cos(theta), np.sin(theta)]), np.column_stack([-np.sin(theta), np.cos(theta)]) * side[:, None]
    normal = radial[:, None] * e + around[:, None] * t
    return _pack(rho[:, None] * e + shift[:, None] * normal, normal, z, ROOT, tooth, side, _ends_edge(part, z))


def _flank(part: Part, number: int, top: float, rng: np.random.Generator) -> Points:
    tooth, side, z = _of_teeth(part, number, rng)
    roll = np.sqrt(rng.uniform(part.frame.form**2, top**2, number))  # the arc of an involute is L² / 2 rb
    delta = part.deviation(tooth, side, roll, z)
    there = roll + delta <= part.gear.tip_roll
    tooth, side, z, roll, delta = (a[there] for a in (tooth, side, z, roll, delta))
    xy, normal = flank_point(part.gear, tooth, side, roll, delta)
    corner = (part.gear.tip_roll - roll - delta) * roll / part.gear.base_radius
    return _pack(xy, normal, z, FLANK, tooth, side, np.minimum(corner, _ends_edge(part, z)))


def _tip(part: Part, number: int, land: float, rng: np.random.Generator) -> Points:
    tooth, side, z = _of_teeth(part, number, rng)
    gear, ra = part.gear, part.gear.tip_radius
    angle = rng.uniform(0.0, land / ra, number)
    limit = part.half_angle(tooth, side, np.full(number, ra - 1e-12), z)
    other = part.half_angle(tooth, -side, np.full(number, ra - 1e-12), z)
    there = (angle < limit) & (-angle < other)
    tooth, side, z, angle, limit = (a[there] for a in (tooth, side, z, angle, limit))
    theta = tooth * gear.pitch_angle + side * angle
    normal = np.column_stack([np.cos(theta), np.sin(theta)])
    return _pack(ra * normal, normal, z, TIP, tooth, side, np.minimum(ra * (limit - angle), _ends_edge(part, z)))


def _ends(part: Part, number: int, inner: float, rng: np.random.Generator) -> Points:
    gear = part.gear
    rho = np.sqrt(rng.uniform(inner**2, gear.tip_radius**2, number))
    theta = rng.uniform(-math.pi, math.pi, number)
    upper = rng.random(number) < 0.5
    xyz = np.column_stack([rho * np.cos(theta), rho * np.sin(theta), np.where(upper, gear.face_width, 0.0)])
    tooth, angle, _ = part.angle_in_tooth(xyz)
    side = np.where(angle >= 0.0, 1.0, -1.0)
    limit = part.half_angle(tooth, side, rho, xyz[:, 2])
    there = (np.abs(angle) < limit) | (rho < part.section.root_radius[0])
    toothed = rho > part.section.root_radius[0]
    edge = np.where(toothed, np.minimum(rho * (limit - np.abs(angle)), gear.tip_radius - rho), np.inf)
    edge = np.where(toothed, edge, part.section.root_radius[0] - rho + 0.05 * gear.module)
    normal = np.column_stack([np.zeros(number), np.zeros(number), np.where(upper, 1.0, -1.0)])
    points = Points(xyz, normal, np.full(number, END), tooth.astype(int), np.zeros(number, dtype=int), edge)
    return points.take(there)


def _bore(part: Part, number: int, rng: np.random.Generator) -> Points:
    theta, z = rng.uniform(-math.pi, math.pi, number), rng.uniform(0.0, part.gear.face_width, number)
    normal = -np.column_stack([np.cos(theta), np.sin(theta)])
    nothing = np.zeros(number)
    return _pack(-0.5 * part.gear.bore * normal, normal, z, BORE, nothing - 1, nothing, _ends_edge(part, z))


def _broken(part: Part, which: int, number: int, reach: float, rng: np.random.Generator) -> Points:
    cut = part.cuts[which]
    xyz, normal = cut.surface(number, reach, rng)
    tooth, angle, rho = part.angle_in_tooth(xyz)
    side = np.where(angle >= 0.0, 1.0, -1.0)
    there = (np.abs(angle) < part.half_angle(tooth, side, rho, xyz[:, 2])) & (tooth == cut.tooth)
    there &= (xyz[:, 2] > 0.0) & (xyz[:, 2] < part.gear.face_width) & (rho > part.section.root_radius[0])
    for i, other in enumerate(part.cuts):
        if i != which and other.tooth == cut.tooth:
            there &= other.beyond(xyz) <= 0.0
    points = Points(xyz, normal, np.full(number, BROKEN), tooth.astype(int), np.zeros(number, dtype=int), np.full(number, np.inf))
    return points.take(there)
