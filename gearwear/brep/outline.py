"""The transverse outline of a gear as edges: arcs where it is round, lines where it is straight, splines elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.brep.curves import FILLET_TOLERANCE, FLANK_TOLERANCE, Spline, drawn
from gearwear.brep.paths import (
    MIRROR,
    SHORTEST,
    Path,
    drawn_turn,
    fillet_path,
    flank_paths,
    has_bottom_land,
    rounding_path,
    straight_path,
)
from gearwear.design.gear import Gear
from gearwear.design.side import Side
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
    path : Path or None
        The curve itself, with the parameter of a spline; None of an arc.
    """

    name: str
    start: Floats
    shape: Spline | Arc | Line
    side: Side
    path: Path | None = None


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
    starts = [right[0][1].poles[0], *(curve.poles[-1] for _, curve, _ in right[:-1])]
    edges = [
        Edge(name, start * MIRROR, curve.mirrored(), Side.RIGHT, path.mirrored())
        for start, (name, curve, path) in zip(starts, right, strict=True)
    ]
    tip, ends = Arc(gear.tip_radius), (right[-1][1].poles[-1] * MIRROR, left[-1][1].poles[-1])
    if gear.spec.tip_chamfer > 0.0:
        corners = [_top_corner(gear, Side.RIGHT) * MIRROR, _top_corner(gear, Side.LEFT)]
        down, up = (straight_path(*line, gear.orientation) for line in ((corners[1], ends[1]), (ends[0], corners[0])))
        edges.append(Edge("chamfer", ends[0], Line(), Side.RIGHT, up))
        edges += [Edge("tip", corners[0], tip, Side.RIGHT), Edge("chamfer", corners[1], Line(), Side.LEFT, down)]
    else:
        edges.append(Edge("tip", ends[0], tip, Side.RIGHT))
    edges += [Edge(name, curve.poles[-1], curve.reversed(), Side.LEFT, path.reversed()) for name, curve, path in left[::-1]]
    if has_bottom_land(gear):
        edges.append(Edge("root", left[0][1].poles[0], Arc(gear.root_radius), Side.LEFT))
    _refuse_short(gear, edges)
    return tuple(edges)


def _side_edges(gear: Gear, side: Side) -> list[tuple[str, Spline, Path]]:
    """Fillet, flank and what is rounded of one side from the bottom land up, drawn on the left of +x."""
    paths = [("fillet", fillet_path(gear, side)), *(("flank", path) for path in flank_paths(gear, side))]
    rounding = rounding_path(gear, side)
    paths += [] if rounding is None else [("rounding", rounding)]
    limits = {"fillet": FILLET_TOLERANCE}
    return [(name, drawn(gear, path, limits.get(name, FLANK_TOLERANCE)), path) for name, path in paths]


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
