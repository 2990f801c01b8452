"""Ends of a spur gear rounded by the kernel, as a ball rolls along the outline, and held to what that must take away."""

from __future__ import annotations

import math

import numpy as np
from build123d import Solid
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from gearwear.brep.outline import inset
from gearwear.design.gear import Gear
from gearwear.errors import InputError

IN_PLANE = 1e-7
"""mm; the kernel's own precision, within which an edge lies in an end face or on the bore."""
NODES = 8
"""Of the integral over a rounding."""
OFF = 0.02
"""Share of what a rounding takes away by which the kernel's may differ: it also makes solids that it calls valid and that are none."""


def rounded_ends(shape: TopoDS_Shape, gear: Gear) -> TopoDS_Shape:
    """The solid of an unmodified spur gear with the outline's edges rounded at both ends; the bore's stay sharp.

    Parameters
    ----------
    shape : TopoDS_Shape
        The gear with sharp ends.
    gear : Gear
        Its spec has the radius, `end_rounding`.

    Raises
    ------
    InputError
        If the radius does not fit, or the kernel makes no sound solid with it.

    Notes
    -----
    A rolling ball's surface is no product of polynomials, the kernel's is near it to 1e-4 mm. Flanks and fillets stay the surfaces they were, trimmed.
    """
    radius, name = gear.spec.end_rounding, gear.spec.name
    refusal = InputError(
        f"[{name}] end_rounding = {radius:g} mm: no sound solid comes out of this design; a smaller one, or 0, would help"
    )
    try:
        lost = taken_by_rounding(gear)
    except InputError as error:
        raise refusal from error
    maker = BRepFilletAPI_MakeFillet(shape)
    for edge in _end_edges(shape, gear):
        maker.Add(radius, edge)
    try:
        maker.Build()
        rounded = maker.Shape()
    except Exception as error:
        raise refusal from error
    if not BRepCheck_Analyzer(rounded).IsValid() or abs(Solid(shape).volume - Solid(rounded).volume - lost) > OFF * lost:
        raise refusal
    return rounded


def taken_by_rounding(gear: Gear) -> float:
    """Volume that the roundings of both ends take off a spur gear, mm³.

    Notes
    -----
    At the height r (1 − sin θ) the section is the parallel of the outline at r (1 − cos θ); the integral over θ by Gauss's rule.
    """
    radius = gear.spec.end_rounding
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    angle, area = 0.25 * math.pi * (nodes + 1.0), gear.section_area()
    lost = [area - inset(gear, radius * (1.0 - math.cos(turn))).section_area() for turn in angle]
    return 2.0 * 0.25 * math.pi * radius * float(np.dot(weights, np.array(lost) * np.cos(angle)))


def _end_edges(shape: TopoDS_Shape, gear: Gear) -> list[TopoDS_Edge]:
    """Of the outline, in the planes of both ends."""
    edges = []
    for edge in Solid(shape).edges():
        points = [edge.position_at(share) for share in (0.0, 0.5, 1.0)]
        in_plane = any(all(abs(point.Z - z) < IN_PLANE for point in points) for z in (0.0, gear.face_width))
        on_bore = all(abs(math.hypot(point.X, point.Y) - gear.body_radius) < IN_PLANE for point in points)
        if in_plane and not on_bore:
            edges.append(edge.wrapped)
    return edges
