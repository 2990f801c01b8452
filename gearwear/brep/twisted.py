"""Solids with a twist: the outline carried along a screw, or two of them, face by face, neighbours sharing edge and vertex.

Built by hand, not sewn: every edge is made once, with the line it is in the parameter plane of either face, so that
nothing is projected, fitted or searched for.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface, Geom_Circle, Geom_CylindricalSurface, Geom_Surface
from OCP.Geom2d import Geom2d_BezierCurve, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pln, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire

from gearwear.arrays import Floats
from gearwear.brep.curves import Spline, arc_spline
from gearwear.brep.outline import Arc, Edge, Line, rotation
from gearwear.brep.screw import Sweep
from gearwear.design.side import Side

CONFUSION = 1e-7
"""Tolerance of edges and vertices, mm: the kernel's own."""

ONCE_ROUND = 6.0
"""rad; a face of a cylinder that goes further round meets its own seam."""

UP = gp_Dir(0.0, 0.0, 1.0)
RIGHT, UPWARD = gp_Dir2d(1.0, 0.0), gp_Dir2d(0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Walls:
    """The faces round a toothed disc, and the two closed loops of edges they end in, counter-clockwise."""

    faces: list[TopoDS_Face]
    low: list[TopoDS_Edge]
    high: list[TopoDS_Edge]
    corners: list[TopoDS_Vertex]
    """Of the high loop."""


def twisted_solid(
    edges: Sequence[Edge],
    teeth: int,
    pieces: Sequence[Mapping[Side, Sweep]],
    bore: float,
    groove: float = 0.0,
    orientation: int = 1,
) -> TopoDS_Solid:
    """The solid that an outline sweeps along a screw, each tooth side along its own if they differ, or along one screw after the other.

    Parameters
    ----------
    edges : sequence of Edge
        Of one tooth and the space after it, counter-clockwise; the outline is this, turned by each multiple of 2π/z.
    teeth : int
        z.
    pieces : sequence of mapping of Side to Sweep
        One above the other, from one end face to the other: where two touch, their faces meet in an edge; else there is a groove between.
    bore : float
        Radius of the bore, of a ring that of its outside, mm; 0 is none.
    groove : float
        Radius of the groove from the end of a screw to the start of the next, mm.
    orientation : int
        +1; −1 of a ring, whose metal lies outside the outline.

    Returns
    -------
    OCP.TopoDS.TopoDS_Solid
        Flanks and fillets are B-spline surfaces, tips and bottom lands cylinders (B-spline surfaces where one goes more than
        once round the axis), ends planes.
    """
    parts: list[Walls] = []
    for i, sweeps in enumerate(pieces):
        touching = i > 0 and pieces[i - 1][Side.LEFT].high == sweeps[Side.LEFT].low
        parts.append(_walls(edges, teeth, sweeps, parts[-1] if touching else None))
    faces = [face for walls in parts for face in walls.faces]
    bottom, top = pieces[0][Side.LEFT].low, pieces[-1][Side.LEFT].high
    low, high = None, None
    if bore > 0.0:
        wall, low, high = _tube(bore, bottom, top)
        faces.append(wall)
    outlines = _loop(parts[0].low), _loop(parts[-1].high)
    if orientation < 0:  # all that is round looks the other way, and the outline is the hole
        if low is None or high is None:
            raise ValueError("a ring needs the radius of its outside")
        faces = [face.Reversed() for face in faces]
        faces += [_end(low, bottom, outlines[0]).Reversed(), _end(high, top, outlines[1])]
    else:
        faces += [_end(outlines[0], bottom, low).Reversed(), _end(outlines[1], top, high)]
    for (below, above), (first, second) in zip(pairwise(parts), pairwise(pieces), strict=True):
        start_z, stop_z = first[Side.LEFT].high, second[Side.LEFT].low
        if start_z == stop_z:
            continue
        wall, start, stop = _tube(groove, start_z, stop_z)
        faces += [
            wall.Reversed(),
            _end(_loop(below.high), start_z, start),
            _end(_loop(above.low), stop_z, stop).Reversed(),
        ]
    shell, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    shell.Closed(True)
    solid = TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def _walls(edges: Sequence[Edge], teeth: int, screws: Mapping[Side, Sweep], below: Walls | None) -> Walls:
    turns = [rotation(2.0 * math.pi * k / teeth) for k in range(teeth)]
    starts = np.concatenate([np.array([edge.start for edge in edges]) @ turn for turn in turns])
    of_walls = [screws[edge.side] for edge in edges] * teeth
    floor = below.corners if below is not None else [None] * len(starts)
    corners = [_Corner.at(point, screw, low) for point, screw, low in zip(starts, of_walls, floor, strict=True)]
    walls = Walls([], [], [], [corner.high for corner in corners])
    for index, corner in enumerate(corners):
        tooth, number = divmod(index, len(edges))
        after = (index + 1) % len(corners)
        ends = starts[index], starts[after]
        strip = _strip(edges[number].shape, turns[tooth], ends, (of_walls[index], of_walls[after]))
        if below is None:
            low = BRepBuilderAPI_MakeEdge(strip.low, corner.low, corners[after].low, *strip.span_low).Edge()
        else:
            low = below.high[index]
        high = BRepBuilderAPI_MakeEdge(strip.high, corner.high, corners[after].high, *strip.span_high).Edge()
        walls.faces.append(_face(strip, low, corners[after].helix, high, corner.helix))
        walls.low.append(low)
        walls.high.append(high)
    return walls


@dataclass(frozen=True, slots=True)
class _Corner:
    """A corner of the outline along the screw: its helix and the vertices at its ends."""

    low: TopoDS_Vertex
    high: TopoDS_Vertex
    helix: TopoDS_Edge

    @classmethod
    def at(cls, point: Floats, screw: Sweep, low: TopoDS_Vertex | None) -> _Corner:
        poles = screw.helix(point)
        bottom, high = (BRepBuilderAPI_MakeVertex(gp_Pnt(*map(float, pole))).Vertex() for pole in (poles[0], poles[-1]))
        low = low or bottom
        return cls(low, high, BRepBuilderAPI_MakeEdge(bspline(screw.turning, poles), low, high).Edge())


@dataclass(frozen=True, slots=True)
class _Strip:
    """One surface with what bounds it, counter-clockwise from the low edge; a curve in its parameter plane for each."""

    surface: Geom_Surface
    low: Geom_BSplineCurve | Geom_Circle
    high: Geom_BSplineCurve | Geom_Circle
    span_low: tuple[float, float]
    span_high: tuple[float, float]
    """Parameters of the low and of the high edge."""
    plane: tuple[Geom2d_Curve, Geom2d_Curve, Geom2d_Curve, Geom2d_Curve]


def _strip(shape: Spline | Arc | Line, turn: Floats, ends: tuple[Floats, Floats], screws: tuple[Sweep, Sweep]) -> _Strip:
    """The surface from one corner's helix to the next; only an arc's two corners may move apart."""
    screw = screws[0]
    match shape:
        case Spline():
            return _product(shape, shape.poles @ turn, screw)
        case Line():
            straight = Spline(1, np.array([0.0, 0.0, 1.0, 1.0]), np.array(ends), 0.0)
            return _product(straight, straight.poles, screw)
        case Arc():
            first, last = (math.atan2(y, x) for x, y in ends)
            sweep = (last - first) % (2.0 * math.pi)
            if screws[0] is not screws[1] or sweep + abs(screw.angle(screw.high) - screw.angle(screw.low)) < ONCE_ROUND:
                return _cylinder(shape.radius, first, sweep, screws)
            arc = arc_spline(shape.radius, first, sweep)
            return _product(arc, arc.poles, screw)


def _product(curve: Spline, poles: Floats, screw: Sweep) -> _Strip:
    """The screw of a curve of the section: the products of the poles."""
    surface = screw.surface(poles)
    grid = TColgp_Array2OfPnt(1, surface.shape[0], 1, surface.shape[1])
    for i, row in enumerate(surface):
        for j, pole in enumerate(row):
            grid.SetValue(i + 1, j + 1, gp_Pnt(*map(float, pole)))
    (u, u_counts), (v, v_counts) = _knots(curve), _knots(screw.turning)
    sides = (
        Geom2d_Line(gp_Pnt2d(0.0, 0.0), RIGHT),
        Geom2d_Line(gp_Pnt2d(1.0, 0.0), UPWARD),
        Geom2d_Line(gp_Pnt2d(0.0, 1.0), RIGHT),
        Geom2d_Line(gp_Pnt2d(0.0, 0.0), UPWARD),
    )
    return _Strip(
        Geom_BSplineSurface(grid, u, v, u_counts, v_counts, curve.degree, screw.turning.degree),
        bspline(curve, surface[:, 0]),
        bspline(curve, surface[:, -1]),
        (0.0, 1.0),
        (0.0, 1.0),
        sides,
    )


def _cylinder(radius: float, first: float, sweep: float, screws: tuple[Sweep, Sweep]) -> _Strip:
    """The arc about the axis from the angle `first` counter-clockwise over `sweep` (rad), its two ends carried along their screws."""
    z = (screws[0].low, 0.5 * (screws[0].low + screws[0].high), screws[0].high)
    start, end = (
        [angle + screw.angle(height) for height in z] for angle, screw in zip((first, first + sweep), screws, strict=True)
    )
    # The seam goes opposite the middle of the face, so that the face does not run through it.
    seam = 0.25 * (start[0] + end[0] + start[2] + end[2]) - math.pi
    axes = gp_Ax3(gp_Pnt(0.0, 0.0, 0.0), UP, gp_Dir(math.cos(seam), math.sin(seam), 0.0))

    def circle(height: float, angle: float) -> Geom_Circle:
        return Geom_Circle(gp_Ax2(gp_Pnt(0.0, 0.0, height), UP, gp_Dir(math.cos(angle), math.sin(angle), 0.0)), radius)

    sides = (
        Geom2d_Line(gp_Pnt2d(start[0] - seam, z[0]), RIGHT),
        _helix(screws[1], [angle - seam for angle in end], z),
        Geom2d_Line(gp_Pnt2d(start[2] - seam, z[2]), RIGHT),
        _helix(screws[0], [angle - seam for angle in start], z),
    )
    surface, low, high = Geom_CylindricalSurface(axes, radius), circle(z[0], start[0]), circle(z[2], start[2])
    return _Strip(surface, low, high, (0.0, end[0] - start[0]), (0.0, end[2] - start[2]), sides)


def _helix(screw: Sweep, angles: Sequence[float], z: Sequence[float]) -> Geom2d_BezierCurve:
    """A corner's way in the cylinder's plane of angle and height: a line, or a parabola through three places."""
    low, middle, high = angles
    straight = screw.bow == (0.0, 0.0, 0.0)
    inner = [] if straight else [(2.0 * middle - 0.5 * (low + high), z[1])]
    poles = [(low, z[0]), *inner, (high, z[2])]
    points = TColgp_Array1OfPnt2d(1, len(poles))
    for i, pole in enumerate(poles):
        points.SetValue(i + 1, gp_Pnt2d(*pole))
    return Geom2d_BezierCurve(points)


def _face(strip: _Strip, low: TopoDS_Edge, after: TopoDS_Edge, high: TopoDS_Edge, before: TopoDS_Edge) -> TopoDS_Face:
    """Low edge and the helix after it forwards, high edge and the helix before it backwards: outward is the surface's own normal."""
    face, wire, builder = TopoDS_Face(), TopoDS_Wire(), BRep_Builder()
    builder.MakeFace(face, strip.surface, TopLoc_Location(), CONFUSION)
    builder.MakeWire(wire)
    for edge, line in zip((low, after, high, before), strip.plane, strict=True):
        builder.UpdateEdge(edge, line, face, CONFUSION)
    for part in (low, after, high.Reversed(), before.Reversed()):
        builder.Add(wire, part)
    wire.Closed(True)
    builder.Add(face, wire)
    return face


def _loop(edges: list[TopoDS_Edge]) -> TopoDS_Wire:
    """The wire of a closed loop of edges."""
    wire, builder = TopoDS_Wire(), BRep_Builder()
    builder.MakeWire(wire)
    for edge in edges:
        builder.Add(wire, edge)
    wire.Closed(True)
    return wire


def _end(loop: TopoDS_Wire, z: float, hole: TopoDS_Wire | None) -> TopoDS_Face:
    """Plane inside a loop, less a hole; outward upwards."""
    face = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0.0, 0.0, z), UP), loop, True)
    if hole is not None:
        face.Add(TopoDS.Wire_s(hole.Reversed()))
    return face.Face()


def _tube(radius: float, low: float, high: float) -> tuple[TopoDS_Face, TopoDS_Wire, TopoDS_Wire]:
    """A cylinder, its normal towards the axis, and its circles at the low and the high end."""
    circle = BRepBuilderAPI_MakeEdge(Geom_Circle(gp_Ax2(gp_Pnt(0.0, 0.0, low), UP), radius)).Edge()
    prism = BRepPrimAPI_MakePrism(circle, gp_Vec(0.0, 0.0, high - low))
    first, last = (BRepBuilderAPI_MakeWire(TopoDS.Edge_s(edge)).Wire() for edge in (prism.FirstShape(), prism.LastShape()))
    return TopoDS.Face_s(prism.Shape()), first, last


def bspline(spline: Spline, poles: Floats) -> Geom_BSplineCurve:
    """A curve with the knots of `spline` and the poles (n, 3)."""
    values = TColgp_Array1OfPnt(1, len(poles))
    for i, pole in enumerate(poles):
        values.SetValue(i + 1, gp_Pnt(*map(float, pole)))
    return Geom_BSplineCurve(values, *_knots(spline), spline.degree)


def _knots(spline: Spline) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    knots, repetitions = np.unique(spline.knots, return_counts=True)
    values, counts = TColStd_Array1OfReal(1, len(knots)), TColStd_Array1OfInteger(1, len(knots))
    for i, (knot, repeated) in enumerate(zip(knots, repetitions, strict=True)):
        values.SetValue(i + 1, float(knot))
        counts.SetValue(i + 1, int(repeated))
    return values, counts
