"""Oracles for what end chamfers and roundings leave: inner parallels of sections that are drawn from the half angles alone.

In closed form for unmodified external spur gears (`inset`); for every other gear as Clipper2 offsets a fine polygon, and as the distance of a point
from the section's outline in its own plane. Nothing of the brep room.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
from manifold3d import CrossSection, JoinType
from scipy.optimize import minimize_scalar

from gearwear.arrays import Floats
from gearwear.design import Gear
from gearwear.design.rack import protuberance_angle, undercut_angle
from gearwear.design.root import ToothSection
from gearwear.design.side import Side
from gearwear.design.tip_edge import TipArc


def inset(gear: Gear, depth: float) -> Gear:
    """The gear whose outline is the inner parallel of an external spur gear's, at `depth` mm; only its derived geometry has moved.

    The parallel of an involute is the same involute turned by depth / r_b; that of the trochoid belongs to a rack with the same arc centre and
    the tip radius ρ + depth. Where the flank is too short for its parallel the two cross, as in undercut, and the same solver finds where. A
    straight tip chamfer keeps 45° if its legs lose (2 − √2) depth.
    """
    spec = gear.spec
    chamfer = spec.tip_chamfer - (2.0 - math.sqrt(2.0)) * depth if spec.tip_chamfer > 0.0 else 0.0
    rack = replace(gear.rack, tip_radius=gear.rack.tip_radius + depth)
    psi_b = gear.base_half_angle - depth / gear.base_radius
    tip = gear.tip_radius - depth
    rounding = spec.tip_rounding - depth if spec.tip_rounding > 0.0 else 0.0
    flank_end = tip - chamfer
    if rounding > 0.0:
        flank_end = TipArc(rounding, tip, gear.base_radius, psi_b, gear.orientation).flank_end_radius
    undercut = gear.undercut or gear.form_roll < depth
    if spec.protuberance > 0.0:
        flank = ToothSection(
            gear.reference_radius,
            gear.base_radius,
            tip,
            gear.root_radius - depth,
            tip - chamfer,
            gear.transverse_pressure_angle,
            psi_b,
        )
        fillet_end = protuberance_angle(rack, flank, spec.normal_pressure_angle, gear.pitch_angle)
        form = float(rack.polar(np.array(fillet_end))[0])
    elif undercut:
        alpha = gear.transverse_pressure_angle
        fillet_end = undercut_angle(rack, alpha, gear.base_radius, psi_b, gear.pitch_angle)
        form = float(rack.polar(np.array(fillet_end))[0])
    else:
        fillet_end = gear.fillet_end
        form = math.hypot(gear.base_radius, gear.form_roll - depth)
    return replace(
        gear,
        spec=replace(spec, tip_chamfer=chamfer, tip_rounding=rounding),
        tip_radius=tip,
        root_radius=gear.root_radius - depth,
        tooth_thickness=gear.tooth_thickness - 2.0 * depth / math.cos(gear.transverse_pressure_angle),
        base_half_angle=psi_b,
        root_curve=rack,
        fillet_end=fillet_end,
        form_radius=form,
        undercut=undercut,
        flank_end_radius=flank_end,
    )


def side_curve(gear: Gear, side: Side, z: float, count: int) -> Floats:
    """(n, 2) points of a tooth side in the section at height z, tooth on +x at mid-face: fillet, flank and the edge at the tip, upwards."""
    turn = gear.twist * (z - 0.5 * gear.face_width)
    crowded = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, count)))
    fillet = gear.root_radius + (gear.form_radius - gear.root_radius) * crowded**1.5
    knees = [gear.form_roll, *gear.drawn(side).profile_knees, gear.tip_roll]
    rolls = np.concatenate([low + (high - low) * crowded[1:] for low, high in pairwise(knees)])
    radius = np.concatenate([fillet, np.hypot(gear.base_radius, rolls)])
    angle = gear.half_angles(radius, np.array([z]))[side.index, 0]
    top = angle[-1] - float(gear.half_angle(gear.flank_end_radius))  # what the drawing turns the tip's edge by
    if gear.tip_arc is not None:
        arc = gear.tip_arc.points(np.linspace(0.0, 1.0, count))[1:]
        radius, angle = np.append(radius, np.hypot(*arc.T)), np.append(angle, np.arctan2(arc[:, 1], arc[:, 0]) + top)
    elif gear.spec.tip_chamfer > 0.0:
        radius, angle = np.append(radius, gear.tip_radius), np.append(angle, gear.tip_half_angle + top)
    return np.column_stack([radius * np.cos(side * angle + turn), radius * np.sin(side * angle + turn)])


def section(gear: Gear, z: float, count: int = 200) -> Floats:
    """(n, 2) the whole outline in the section at height z as a fine polygon, counter-clockwise."""
    right, left = (side_curve(gear, side, z, count) for side in (Side.RIGHT, Side.LEFT))
    tooth = np.concatenate([right, _arc(right[-1], left[-1], count), left[::-1]])
    pitch = gear.pitch_angle
    after = right[0] @ np.array([[math.cos(pitch), math.sin(pitch)], [-math.sin(pitch), math.cos(pitch)]])
    tooth = np.concatenate([tooth, _arc(left[0], after, count)])
    turns = np.exp(1j * pitch * np.arange(gear.teeth))
    whole = np.multiply.outer(turns, tooth[:, 0] + 1j * tooth[:, 1]).ravel()
    return np.column_stack([whole.real, whole.imag])


def _arc(first: Floats, last: Floats, count: int) -> Floats:
    """Between two points on a circle about the axis, without them."""
    start, end = (math.atan2(y, x) for x, y in (first, last))
    sweep = (end - start + math.pi) % (2.0 * math.pi) - math.pi
    angle = start + sweep * np.linspace(0.0, 1.0, count)[1:-1]
    return np.hypot(*first) * np.column_stack([np.cos(angle), np.sin(angle)])


def lost_area(gear: Gear, z: float, depth: float) -> float:
    """Between the outline at height z and its inner parallel, mm²."""
    whole = CrossSection([section(gear, z)])
    moved = whole.offset(-gear.orientation * depth, JoinType.Miter, 10.0)
    return gear.orientation * (whole.area() - moved.area())


def profile(gear: Gear, share: Floats) -> tuple[Floats, Floats, Floats]:
    """Depth, height above the end face, and what of the height a step of `share` is worth, mm: from the body (0) to the end face (1)."""
    chamfer, rounding = gear.spec.end_chamfer, gear.spec.end_rounding
    if chamfer > 0.0:
        return chamfer * share, chamfer * (1.0 - share), np.full_like(share, chamfer)
    angle = 0.5 * math.pi * share
    return rounding * (1.0 - np.cos(angle)), rounding * (1.0 - np.sin(angle)), 0.5 * math.pi * rounding * np.cos(angle)


def lost_volume(gear: Gear, nodes: int = 5) -> float:
    """What chamfers or roundings take off both ends, mm³, by Gauss's rule over the parallels' areas."""
    share, weights = np.polynomial.legendre.leggauss(nodes)
    depth, height, rate = profile(gear, 0.5 * (share + 1.0))
    ends = 2 if gear.modified else 1  # else all sections are the same, turned
    lost = [[lost_area(gear, z, d) for z in (h, gear.face_width - h)[:ends]] for d, h in zip(depth, height, strict=True)]
    return float(np.dot(0.5 * weights * rate, np.sum(lost, axis=1))) * 2.0 / ends


def outline_distance(gear: Gear, points: Floats) -> Floats:
    """(n,) distance in mm of points (n, 3) from the outline of the section at their own height, in its plane; of either side of the outline."""
    return np.array([_from_outline(gear, *point) for point in points])


def _from_outline(gear: Gear, x: float, y: float, z: float) -> float:
    turn = gear.twist * (z - 0.5 * gear.face_width)
    tooth = round((math.atan2(y, x) - turn) / gear.pitch_angle)
    sides = []
    for near in (tooth - 1, tooth, tooth + 1):
        angle = -near * gear.pitch_angle
        p = np.array([x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)])
        sides += [FromSide(gear, side, z, turn, p) for side in Side]
    least = np.inf
    for side in sorted(sides, key=lambda side: side.least):
        if side.least < least:
            least = min(least, side.distance())
    radius = math.hypot(x, y)
    within = abs(math.atan2(y, x) - turn - tooth * gear.pitch_angle)
    ends = np.array([gear.form_radius, gear.flank_end_radius])  # where the drawing turns the lands' own ends to
    foot, drawn = np.abs(gear.half_angles(ends, np.array([z]))[:, 0] - gear.half_angle(ends)).max(axis=0)
    if within < gear.tip_half_angle + drawn:
        least = min(least, abs(radius - gear.tip_radius))
    if 0.5 * gear.pitch_angle - within < gear.root_half_angle + foot:
        least = min(least, abs(radius - gear.root_radius))
    return least


class FromSide:
    """Distance of a point from a tooth side: from a polygon, then from the curve next to its nearest corner and from the edge at the tip."""

    def __init__(self, gear: Gear, side: Side, z: float, turn: float, point: Floats) -> None:
        self.gear, self.side, self.z, self.turn, self.point = gear, side, z, turn, point
        self.share = np.linspace(0.0, 1.0, 120)
        corners = self.curve(self.share)
        away = np.hypot(*(corners - point).T)
        self.nearest = int(away.argmin())
        self.away = float(away[self.nearest])
        # No place of the side lies further from a corner than half a step, nor of its edge than the legs of that are long.
        step = 0.5 * float(np.hypot(*np.diff(corners, axis=0).T).max())
        self.least = self.away - max(1.01 * step, 2.0 * gear.spec.tip_chamfer, 2.0 * gear.spec.tip_rounding)

    def curve(self, share: Floats) -> Floats:
        # even at the bottom of the fillet, where it runs along the root circle
        r = self.gear.root_radius + (self.gear.flank_end_radius - self.gear.root_radius) * share**2
        angle = self.side * self.gear.half_angles(r, np.array([self.z]))[self.side.index, 0] + self.turn
        return np.column_stack([r * np.cos(angle), r * np.sin(angle)])

    def distance(self) -> float:
        fine = minimize_scalar(
            lambda r: float(np.hypot(*(self.curve(np.array([r]))[0] - self.point))),
            bounds=(self.share[max(self.nearest - 1, 0)], self.share[min(self.nearest + 1, 119)]),
            method="bounded", options={"xatol": 1e-9},
        )  # fmt: skip
        return min(float(fine.fun), self.away, self.from_edge())

    def from_edge(self) -> float:
        """From the rounding or chamfer of the tip, where there is one."""
        spec, point = self.gear.spec, self.point
        if self.gear.tip_arc is None and spec.tip_chamfer == 0.0:
            return np.inf
        edge = side_curve(self.gear, self.side, self.z, 60)[-60 if self.gear.tip_arc is not None else -2 :]
        if self.gear.tip_arc is None:
            way = edge[1] - edge[0]
            along = float(np.clip((point - edge[0]) @ way / (way @ way), 0.0, 1.0))
            return float(np.hypot(*(point - edge[0] - along * way)))
        first, last, third = edge[0], edge[-1], edge[30]
        centre = _centre(first, third, last)
        ways = [math.atan2(*(p - centre)[::-1]) for p in (first, last, point)]
        span, at = ((way - ways[0] + math.pi) % (2.0 * math.pi) - math.pi for way in ways[1:])
        return abs(float(np.hypot(*(point - centre))) - spec.tip_rounding) if 0.0 <= at / span <= 1.0 else np.inf


def _centre(a: Floats, b: Floats, c: Floats) -> Floats:
    """Of the circle through three points."""
    rows = 2.0 * np.array([b - a, c - a])
    return np.asarray(np.linalg.solve(rows, [b @ b - a @ a, c @ c - a @ a]))
