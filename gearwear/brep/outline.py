"""The transverse outline of a gear as edges: arcs where it is round, lines where it is straight, splines elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.brep.curves import SHORTEST, Spline, drawn_turn, fillet_curve, flank_curves, has_bottom_land, rounding_curve
from gearwear.design.gear import Gear
from gearwear.design.rack import protuberance_angle, undercut_angle
from gearwear.design.root import ToothSection
from gearwear.design.side import Side
from gearwear.design.tip_edge import TipArc
from gearwear.errors import InputError

SHORTEST_EDGE = 1e-5
"""mm; the kernel takes points closer than 1e-7 for one, so a shorter edge is refused."""


@dataclass(frozen=True, slots=True)
class Arc:
    """Arc about the gear axis, counter-clockwise; radius in mm."""

    radius: float


@dataclass(frozen=True, slots=True)
class Line:
    """Straight edge."""


@dataclass(frozen=True, slots=True)
class Edge:
    """One edge of the outline.

    Parameters
    ----------
    name : str
        "fillet", "flank", "rounding", "chamfer", "tip" or "root".
    start : (2,) float
        First point, mm; the last is the next edge's first.
    shape : Spline or Arc or Line
        What it is.
    side : Side
        Tooth side its first point belongs to: what is modified along the face moves the two sides apart.
    """

    name: str
    start: Floats
    shape: Spline | Arc | Line
    side: Side


def rotation(angle: float) -> Floats:
    """(2, 2) matrix that turns row vectors counter-clockwise: ``points @ rotation(angle)``."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, sin], [-sin, cos]])


def tooth_edges(gear: Gear) -> tuple[Edge, ...]:
    """Edges of the tooth on +x and of the bottom land after it, counter-clockwise.

    Parameters
    ----------
    gear : Gear
        The gear; bore and end chamfers are no part of the outline.

    Returns
    -------
    tuple of Edge
        From the foot of the right fillet on; the outline is this, turned by each multiple of the pitch angle.

    Raises
    ------
    InputError
        If an edge is too short for a B-rep, or a curve cannot be drawn.
    """
    right, left = (_side_edges(gear, side) for side in (Side.RIGHT, Side.LEFT))
    mirror = np.array([1.0, -1.0])
    starts = [right[0][1].poles[0], *(curve.poles[-1] for _, curve in right[:-1])]
    edges = [Edge(name, start * mirror, curve.mirrored(), Side.RIGHT) for start, (name, curve) in zip(starts, right, strict=True)]
    tip, ends = Arc(gear.tip_radius), (right[-1][1].poles[-1] * mirror, left[-1][1].poles[-1])
    if gear.spec.tip_chamfer > 0.0:
        corners = [_top_corner(gear, Side.RIGHT) * mirror, _top_corner(gear, Side.LEFT)]
        edges.append(Edge("chamfer", ends[0], Line(), Side.RIGHT))
        edges += [Edge("tip", corners[0], tip, Side.RIGHT), Edge("chamfer", corners[1], Line(), Side.LEFT)]
    else:
        edges.append(Edge("tip", ends[0], tip, Side.RIGHT))
    edges += [Edge(name, curve.poles[-1], curve.reversed(), Side.LEFT) for name, curve in left[::-1]]
    if has_bottom_land(gear):
        edges.append(Edge("root", left[0][1].poles[0], Arc(gear.root_radius), Side.LEFT))
    _refuse_short(gear, edges)
    return tuple(edges)


def _side_edges(gear: Gear, side: Side) -> list[tuple[str, Spline]]:
    """Fillet, flank and what is rounded of one side from the bottom land up, drawn on the left of +x."""
    rounding = rounding_curve(gear, side)
    flank = [("flank", curve) for curve in flank_curves(gear, side)]
    return [("fillet", fillet_curve(gear, side)), *flank, *([] if rounding is None else [("rounding", rounding)])]


def _top_corner(gear: Gear, side: Side) -> Floats:
    """Where a tip chamfer meets the tip circle, drawn on the left of +x."""
    half = gear.tip_half_angle + drawn_turn(gear, side, gear.tip_roll)
    return gear.tip_radius * np.array([math.cos(half), math.sin(half)])


def _refuse_short(gear: Gear, edges: list[Edge]) -> None:
    starts = np.array([edge.start for edge in edges] + [edges[0].start @ rotation(gear.pitch_angle)])
    for edge, length in zip(edges, np.linalg.norm(np.diff(starts, axis=0), axis=1), strict=True):
        if length < (2.0 * SHORTEST if edge.name == "root" else SHORTEST_EDGE):
            raise InputError(
                f"[{gear.spec.name}] the {edge.name} would be an edge of {length:.1e} mm, too short for a solid model; at least {SHORTEST_EDGE:g} mm is needed"
            )


def inset(gear: Gear, depth: float) -> Gear:
    """The gear whose outline is the inner parallel of `gear`'s, at `depth` mm: the end face of a gear with end chamfers.

    Parameters
    ----------
    gear : Gear
        The gear.
    depth : float
        Distance of the two outlines along the normal, mm.

    Returns
    -------
    Gear
        Its `spec` is the old one but for tip chamfer and rounding; only the derived geometry has moved.

    Raises
    ------
    InputError
        If the parallel outline does not exist: the chamfers of two flanks meet, or a tip chamfer is used up.

    Notes
    -----
    The parallel of an involute is the same involute turned by depth / r_b; that of the trochoid belongs to a
    rack with the same arc centre and the tip radius ρ + depth. Where the flank is too short for its
    parallel the two cross, as in undercut, and the same solver finds where. A straight tip chamfer keeps
    45° if its legs lose (2 − √2) depth; the rest of the parallel is exact.
    """
    spec = gear.spec
    chamfer = spec.tip_chamfer - (2.0 - math.sqrt(2.0)) * depth if spec.tip_chamfer > 0.0 else 0.0
    rack = replace(gear.rack, tip_radius=gear.rack.tip_radius + depth)
    psi_b = gear.base_half_angle - depth / gear.base_radius
    tip = gear.tip_radius - depth
    limit = f"[{spec.name}] end_chamfer = {depth:g} mm:"
    rounding = spec.tip_rounding - depth if spec.tip_rounding > 0.0 else 0.0
    if rounding < 0.0 or (spec.tip_rounding > 0.0 and rounding == 0.0):
        raise InputError(f"{limit} uses up the tip rounding; less than {spec.tip_rounding:g} mm would be right beside it")
    if chamfer < 0.0:
        raise InputError(f"{limit} uses up the tip chamfer; at most {spec.tip_chamfer / (2.0 - math.sqrt(2.0)):.4g} mm beside it")
    flank_end = tip - chamfer
    if rounding > 0.0:
        flank_end = TipArc(rounding, tip, gear.base_radius, psi_b, gear.orientation).flank_end_radius
    if flank_end <= gear.form_radius:
        raise InputError(f"{limit} leaves no flank on the end face; a smaller one would")
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
    result = replace(
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
    if result.form_radius >= result.flank_end_radius or result.tip_half_angle * tip < SHORTEST_EDGE:
        raise InputError(f"{limit} leaves no tip land on the end face; a smaller one would")
    if 0.5 * spec.bore_diameter >= result.root_radius:
        raise InputError(f"{limit} reaches the bore; below {gear.root_radius - 0.5 * spec.bore_diameter:.4g} mm it would not")
    return result
