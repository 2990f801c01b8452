"""Where points lie in the nominal teeth: on which, how deep below the surface, how far across."""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.twist import from_end, section_angle

BOUNDS = 256
"""Rings of a tooth between whose ends half angles are bounded; numerical."""


def depth_inside(points: Floats, gear: Gear) -> tuple[Ints, Floats, Floats]:
    """Tooth (0-based), depth below the nearest nominal surface of the tooth (mm, negative outside), and place across its thickness (−1 … 1).

    Below the form circle the flank goes on towards the fillet as the fillet's own half angle says; the root land is no surface of a tooth. Ends that the
    drawing rounds are taken for chamfered, which takes more away.
    """
    radius, tooth, within = in_section(points, gear)
    half = np.maximum(half_angle_at(gear, radius, gear.root_radius), 1e-9)
    flank, ends = _below_flank(gear, half, within), _below_ends(points, radius, gear)
    depth = np.minimum(flank, ends)
    if gear.spec.end_edge > 0.0:
        outline = np.minimum(flank, -above_circle(gear, radius, gear.tip_radius))
        low, high = map(max, gear.spec.end_edges)
        from_edge = np.minimum(points[:, 2] - low, gear.face_width - points[:, 2] - high)
        depth = np.minimum(depth, math.sqrt(0.5) * (outline + from_edge))
    depth = np.where(above_circle(gear, radius, gear.root_radius) > 0.0, depth, -1.0)
    return tooth, depth, within / half


def in_section(points: Floats, gear: Gear) -> tuple[Floats, Ints, Floats]:
    """Radius, mm, tooth (0-based), and angle from its middle, rad."""
    angle = section_angle(gear, *points.T)
    index = np.rint(angle / gear.pitch_angle)
    return np.hypot(points[:, 0], points[:, 1]), index.astype(np.int64) % gear.teeth, angle - index * gear.pitch_angle


def _below_flank(gear: Gear, half: Floats, within: Floats) -> Floats:
    """Depth below the nearer flank of a tooth whose half angle is `half` there, mm.

    Normal to an involute is r_b of arc, in space cos β_b of it; the fillet is taken alike.
    """
    return np.asarray(gear.normal_lever * (half - np.abs(within)), dtype=np.float64)


def _below_ends(points: Floats, radius: Floats, gear: Gear) -> Floats:
    """Depth below the tip and the ends of the face, mm."""
    depth = np.minimum.reduce([gear.orientation * (gear.tip_radius - radius), points[:, 2], gear.face_width - points[:, 2]])
    return np.minimum(depth, from_end(gear, points[:, 2])) if gear.spec.gap > 0.0 else depth


def perhaps_inside(points: Floats, gear: Gear, least: float) -> tuple[Ints, Ints]:
    """The tooth of each point, and which of them may be deeper inside it than `least`, mm.

    Of most points a bound on the half angle tells as much as the half angle itself, which on a fillet takes long.
    """
    radius, tooth, within = in_section(points, gear)
    low, high = sorted((gear.root_radius, gear.flank_end_radius))
    half = half_angle_at(gear, np.linspace(low, high, BOUNDS + 1), gear.root_radius)
    at = np.clip((BOUNDS * (radius - low) / (high - low)).astype(np.int64), 0, BOUNDS - 1)
    bound = np.maximum(half[:-1], half[1:])[at]
    inside = (_below_flank(gear, bound, within) > least) & (_below_ends(points, radius, gear) > least)
    return tooth, np.flatnonzero(inside & (above_circle(gear, radius, gear.root_radius) > 0.0))


def above_circle(gear: Gear, radius: Floats, circle: float) -> Floats:
    """How far radii lie above a circle, towards the tip, mm."""
    return gear.orientation * (radius - circle)


def half_angle_at(gear: Gear, radius: Floats, root: float) -> Floats:
    """Half angles of a tooth at radii, rad: of a chamfered or rounded tip edge on the straight line from flank to land; beyond the tooth those of its ends."""
    low, high = sorted((root, gear.flank_end_radius))
    half = gear.half_angle(np.clip(radius, low, high))
    edge = abs(gear.tip_radius - gear.flank_end_radius)
    if edge == 0.0:
        return half
    share = np.clip(above_circle(gear, radius, gear.flank_end_radius) / edge, 0.0, 1.0)
    return np.asarray(half - share * (float(gear.half_angle(gear.flank_end_radius)) - gear.tip_half_angle), dtype=np.float64)
