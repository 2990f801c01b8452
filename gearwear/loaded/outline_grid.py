"""Quadrilaterals over the transverse section of a whole gear, from its generated outline down to the bore.

Each tooth with half of the spaces beside it is one sector. Below the section of the 30° tangent to the fillet lie columns from the bore
to the root, the fillet and the foot of the tooth; above it lie rows from one flank to the other. All in polar coordinates, the tooth's
centre line at θ = 0, so that the middle column of nodes lies on it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.twist import wrapped_angle

_ROOT_TANGENT = math.radians(30.0)
"""Angle between the fillet's tangent and the tooth's centre line at the foot of the rows (the root section of ISO 6336-3)."""
_NODES = 400
"""Points on the fillet among which that section is looked for."""
_GROWTH = 1.25
"""Ratio of the heights of neighbouring elements in the body, growing inwards."""
_STRAIGHT = 0.7
"""How far the columns of the body end at even angles on the bore: 0 none, they are radial; 1 quite."""
_SAME = 1e-7
"""mm; nodes of neighbouring sectors nearer than this are one."""


class Fineness(NamedTuple):
    """Elements of a sector: along half the root land, each fillet, across the tooth (even), up the tooth, and down the body."""

    land: int
    fillet: int
    across: int
    height: int
    body: int


FINE = Fineness(3, 10, 10, 14, 10)
"""A loaded tooth; four times the elements move its compliance by less than 0.3 %."""
COARSE = Fineness(1, 2, 2, 2, 10)
"""A tooth that is only carried along; twice as fine moves the compliance of a loaded one by less than 0.1 %."""


@dataclass(frozen=True, slots=True)
class OutlineGrid:
    """Elements of a whole gear.

    Parameters
    ----------
    nodes : (n, 2) float
        mm; the centre line of tooth 0 along +x.
    elements : (m, 4) int
        Corners, counter-clockwise or all clockwise.
    centre_lines : tuple of (k,) int
        Nodes on the centre lines of tooth 0 and of its neighbours counter-clockwise, from the foot of the rows to the tip.
    flank : (k,) int
        Nodes on the left flank of tooth 0 at the radii asked for.
    """

    nodes: Floats
    elements: Ints
    centre_lines: tuple[Ints, ...]
    flank: Ints


def outline_grid(
    gear: Gear, bore_radius: float, radii: Floats, fine: Fineness = FINE, coarse: Fineness = COARSE, neighbours: int = 1
) -> OutlineGrid:
    """Elements over the section of a gear, fine on tooth 0 and some neighbours counter-clockwise.

    Parameters
    ----------
    gear : Gear
        Its generated outline counts; chamfers are left out.
    bore_radius : float
        mm, above 0 and below the root circle.
    radii : (k,) float
        mm, rising; places on the flank of tooth 0 where a node is wanted, between the foot of the rows and the tip.
    fine, coarse : Fineness
        Of loaded teeth, and of the others.
    neighbours : int
        Teeth beside tooth 0 that are fine too.
    """
    count, pitch = gear.teeth, gear.pitch_angle
    points, elements, offset = [], [], 0
    for tooth in range(count):
        on = tooth <= neighbours
        polar, quads, levels = _sector(gear, fine if on else coarse, bore_radius, radii if on else np.zeros(0))
        angle = polar[:, 1] + tooth * pitch
        points.append(polar[:, :1] * np.column_stack([np.cos(angle), np.sin(angle)]))
        elements.append(quads + offset)
        offset += len(polar)
        if tooth == 0:
            foot = float(levels[0])
    everything = np.concatenate(points)
    # Sectors share the nodes of their borders; rounding decides nothing, as others lie far apart.
    _, first, merged = np.unique(np.round(everything / _SAME), axis=0, return_index=True, return_inverse=True)
    nodes = everything[first]
    radius, angle = np.hypot(nodes[:, 0], nodes[:, 1]), np.arctan2(nodes[:, 1], nodes[:, 0])
    lines = []
    for tooth in range(neighbours + 1):
        away = np.abs(wrapped_angle(angle - tooth * pitch))
        line = np.flatnonzero((away * radius < _SAME) & (radius > foot - _SAME))
        lines.append(line[np.argsort(radius[line])])
    psi = gear.half_angle(radii)
    wanted = radii[:, None] * np.column_stack([np.cos(psi), np.sin(psi)])
    flank = np.array([int(np.hypot(*(nodes - point).T).argmin()) for point in wanted])
    return OutlineGrid(nodes, merged.ravel()[np.concatenate(elements)], tuple(lines), flank)


def root_section(gear: Gear) -> float:
    """Rack-tip angle φ of the 30° tangent to the fillet: the foot of the tooth."""
    phi = np.linspace(0.0, gear.fillet_end, _NODES)
    radius, angle = gear.rack.polar(phi)
    theta = 0.5 * gear.pitch_angle - angle
    x, y = radius * np.cos(theta), radius * np.sin(theta)
    tangent = np.arctan2(-np.gradient(y), np.gradient(x))
    steep = np.flatnonzero(tangent < _ROOT_TANGENT)
    return float(phi[max(int(steep[0]), 1)] if len(steep) else phi[-1])


def _sector(gear: Gear, fineness: Fineness, bore_radius: float, radii: Floats) -> tuple[Floats, Ints, Floats]:
    """Nodes (r, θ), elements, and the radii of the rows of one tooth."""
    half, across = 0.5 * gear.pitch_angle, fineness.across
    fillet_radius, fillet_angle = gear.rack.polar(_even_arcs(gear, root_section(gear), fineness.fillet))
    land = np.linspace(0.0, gear.root_half_angle, fineness.land + 1)[:-1]
    side_radius = np.concatenate([np.full(fineness.land, gear.root_radius), fillet_radius])
    side_angle = half - np.concatenate([land, fillet_angle])
    foot, foot_angle = float(side_radius[-1]), float(side_angle[-1])
    ways = np.linspace(-1.0, 1.0, across + 1)
    theta = np.concatenate([-side_angle, foot_angle * ways[1:-1], side_angle[::-1]])
    top = np.concatenate([side_radius, np.full(across - 1, foot), side_radius[::-1]])
    columns = len(theta)
    at_bore = (1.0 - _STRAIGHT) * theta + _STRAIGHT * np.linspace(-half, half, columns)
    height = np.concatenate([[0.0], np.cumsum(_GROWTH ** np.arange(fineness.body)[::-1])])
    height = (height / height[-1])[:, None]
    body = np.stack([bore_radius + (top - bore_radius) * height, at_bore + (theta - at_bore) * height], axis=-1)

    levels = _levels(np.array([foot, *radii, gear.flank_end_radius]), fineness.height)
    psi = gear.half_angle(levels)
    psi[0] = foot_angle
    rows = np.stack([np.broadcast_to(levels[:, None], (len(levels), across + 1)), psi[:, None] * ways], axis=-1)
    elements = [_quads(fineness.body, columns - 1), _quads(len(levels) - 1, across) + body.shape[0] * columns]
    return np.concatenate([body.reshape(-1, 2), rows.reshape(-1, 2)]), np.concatenate(elements), levels


def _levels(wanted: Floats, parts: int) -> Floats:
    """Radii from the first to the last, all of those wanted among them, no two farther apart than in so many equal parts."""
    step = (wanted[-1] - wanted[0]) / parts
    between = [np.linspace(low, high, max(math.ceil((high - low) / step - 1e-9), 1) + 1)[:-1] for low, high in pairwise(wanted)]
    return np.concatenate([*between, wanted[-1:]])


def _even_arcs(gear: Gear, end: float, parts: int) -> Floats:
    """φ at the ends of parts of the fillet of equal length, from the root land to `end`."""
    phi = np.linspace(0.0, end, _NODES)
    radius, angle = gear.rack.polar(phi)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(radius), radius[1:] * np.diff(angle)))])
    return np.interp(np.linspace(0.0, way[-1], parts + 1), way, phi)


def _quads(rows: int, columns: int) -> Ints:
    """Corners of a grid of elements, row by row."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    return np.column_stack([first, first + 1, first + columns + 2, first + columns + 1])
