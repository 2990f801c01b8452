"""Solids face by face, neighbours sharing edge and vertex: the outline carried along a screw, or two of them, and what ends it.

Built by hand, not sewn: every edge is made once, with the line it is in the parameter plane of either face, so that
nothing is projected, fitted or searched for.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
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
from OCP.Geom2d import Geom2d_BezierCurve, Geom2d_BSplineCurve, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pln, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire

from gearwear.arrays import Floats
from gearwear.brep.curves import Spline, arc_spline
from gearwear.brep.ends import Basis, EndBand, Patch, Ring
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


def toothed_solid(layers: Sequence[Layer], bore: float, groove: float = 0.0, orientation: int = 1) -> TopoDS_Solid:
    """The solid of layers of faces round the axis, each on the one below.

    Parameters
    ----------
    layers : sequence of Layer
        One above the other, from one end face to the other: where two touch, their faces meet in an edge; else there is a groove between.
    bore : float
        Radius of the bore, of a ring that of its outside, mm; 0 is none.
    groove : float
        Radius of the groove from the end of a layer to the start of the next, mm.
    orientation : int
        +1; −1 of a ring, whose metal lies outside the outline.

    Returns
    -------
    OCP.TopoDS.TopoDS_Solid
        Flanks and fillets are B-spline surfaces, tips and bottom lands cylinders (B-spline surfaces where one goes more than
        once round the axis), chamfers and roundings B-spline surfaces, ends planes.
    """
    parts: list[Walls] = []
    for i, layer in enumerate(layers):
        touching = i > 0 and layers[i - 1].high == layer.low
        parts.append(_walls(layer, parts[-1] if touching else None))
    faces = [face for walls in parts for face in walls.faces]
    bottom, top = layers[0].low, layers[-1].high
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
    for (below, above), (first, second) in zip(pairwise(parts), pairwise(layers), strict=True):
        if first.high == second.low:
            continue
        wall, start, stop = _tube(groove, first.high, second.low)
        faces += [
            wall.Reversed(),
            _end(_loop(below.high), first.high, start),
            _end(_loop(above.low), second.low, stop).Reversed(),
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


def swept_layer(edges: Sequence[Edge], teeth: int, sweeps: Mapping[Side, Sweep]) -> Layer:
    """The surfaces that an outline sweeps along a screw, each tooth side along its own if they differ.

    Parameters
    ----------
    edges : sequence of Edge
        Of one tooth and the space after it, counter-clockwise; the outline is this, turned by each multiple of 2π/z.
    teeth : int
        z.
    sweeps : mapping of Side to Sweep
        From one height to another.
    """
    turns = [rotation(2.0 * math.pi * k / teeth) for k in range(teeth)]
    starts = np.concatenate([np.array([edge.start for edge in edges]) @ turn for turn in turns])
    of_walls = [sweeps[edge.side] for edge in edges] * teeth
    risers = [bspline(sweep.turning, sweep.helix(point)) for point, sweep in zip(starts, of_walls, strict=True)]
    strips = []
    for index in range(len(starts)):
        tooth, number = divmod(index, len(edges))
        after = (index + 1) % len(starts)
        ends = starts[index], starts[after]
        strips.append(_strip(edges[number].shape, turns[tooth], ends, (of_walls[index], of_walls[after])))
    return Layer(sweeps[Side.LEFT].low, sweeps[Side.LEFT].high, strips, risers)


def band_layer(band: EndBand, teeth: int) -> Layer:
    """The faces of a chamfer or a rounding, round all teeth."""
    strips, risers = [], []
    for k in range(teeth):
        angle = 2.0 * math.pi * k / teeth
        turn = np.eye(3)
        turn[:2, :2] = rotation(angle)
        for patch in band.patches:
            poles = patch.poles @ turn
            strips.append(_patch(patch, poles, band.upwards, angle))
            risers.append(bspline(band.upwards, poles[0]))
    return Layer(band.low, band.high, strips, risers)


def _walls(layer: Layer, below: Walls | None) -> Walls:
    """The faces of a layer; edges and corners that it shares with the one below are taken from there."""
    count = len(layer.strips)
    floor = below.corners if below is not None else [_vertex(riser.StartPoint()) for riser in layer.risers]
    corners = [_vertex(riser.EndPoint()) for riser in layer.risers]
    risers = [BRepBuilderAPI_MakeEdge(*ends).Edge() for ends in zip(layer.risers, floor, corners, strict=True)]
    walls = Walls([], [], [], corners)
    for index, strip in enumerate(layer.strips):
        after = (index + 1) % count
        if below is None:
            low = BRepBuilderAPI_MakeEdge(strip.low, floor[index], floor[after], *strip.span_low).Edge()
        else:
            low = below.high[index]
        high = BRepBuilderAPI_MakeEdge(strip.high, corners[index], corners[after], *strip.span_high).Edge()
        walls.faces.append(_face(strip, low, risers[after], high, risers[index]))
        walls.low.append(low)
        walls.high.append(high)
    return walls


def _vertex(point: gp_Pnt) -> TopoDS_Vertex:
    return BRepBuilderAPI_MakeVertex(point).Vertex()


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


@dataclass(frozen=True, slots=True)
class Layer:
    """All surfaces from one height to another (mm), counter-clockwise, and the curve up to the start of each."""

    low: float
    high: float
    strips: list[_Strip]
    risers: list[Geom_BSplineCurve]


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
            rings = [Ring(shape.radius, z, first + screw.angle(z), sweep) for z in (screw.low, screw.high)]
            return _grid(arc, screw.turning, screw.surface(arc.poles), (rings[0], rings[1]))


def _product(curve: Spline, poles: Floats, screw: Sweep) -> _Strip:
    """The screw of a curve of the section: the products of the poles."""
    return _grid(curve, screw.turning, screw.surface(poles))


def _patch(patch: Patch, poles: Floats, upwards: Basis, turn: float) -> _Strip:
    """A face of a chamfer or rounding, turned by an angle (rad)."""
    low, high = patch.rings or (None, None)
    rings = (
        None if low is None or high is None else (replace(low, first=low.first + turn), replace(high, first=high.first + turn))
    )
    return _grid(patch.along, upwards, poles, rings)


def _grid(along: Spline | Basis, upwards: Spline | Basis, poles: Floats, rings: tuple[Ring, Ring] | None = None) -> _Strip:
    """The surface of poles (n, m, 3); its low and high edge are its own, or circles."""
    grid = TColgp_Array2OfPnt(1, poles.shape[0], 1, poles.shape[1])
    for i, row in enumerate(poles):
        for j, pole in enumerate(row):
            grid.SetValue(i + 1, j + 1, gp_Pnt(*map(float, pole)))
    (u, u_counts), (v, v_counts) = _knots(along), _knots(upwards)
    surface = Geom_BSplineSurface(grid, u, v, u_counts, v_counts, along.degree, upwards.degree)
    before, after = Geom2d_Line(gp_Pnt2d(0.0, 0.0), UPWARD), Geom2d_Line(gp_Pnt2d(1.0, 0.0), UPWARD)
    if rings is None:
        sides = Geom2d_Line(gp_Pnt2d(0.0, 0.0), RIGHT), after, Geom2d_Line(gp_Pnt2d(0.0, 1.0), RIGHT), before
        return _Strip(surface, bspline(along, poles[:, 0]), bspline(along, poles[:, -1]), (0.0, 1.0), (0.0, 1.0), sides)
    span_low, span_high = ((0.0, ring.sweep) for ring in rings)
    low, high = (_circle(ring.radius, ring.height, ring.first) for ring in rings)
    return _Strip(surface, low, high, span_low, span_high, (_level(span_low, 0.0), after, _level(span_high, 1.0), before))


def _level(span: tuple[float, float], height: float) -> Geom2d_BSplineCurve:
    """The line across a parameter plane at a height, run through while the parameter goes over `span`."""
    poles, knots, counts = TColgp_Array1OfPnt2d(1, 2), TColStd_Array1OfReal(1, 2), TColStd_Array1OfInteger(1, 2)
    for i, at in enumerate(span):
        poles.SetValue(i + 1, gp_Pnt2d(float(i), height))
        knots.SetValue(i + 1, at)
        counts.SetValue(i + 1, 2)
    return Geom2d_BSplineCurve(poles, knots, counts, 1)


def _circle(radius: float, height: float, angle: float) -> Geom_Circle:
    """About the axis, its parameter 0 at an angle (rad)."""
    return Geom_Circle(gp_Ax2(gp_Pnt(0.0, 0.0, height), UP, gp_Dir(math.cos(angle), math.sin(angle), 0.0)), radius)


def _cylinder(radius: float, first: float, sweep: float, screws: tuple[Sweep, Sweep]) -> _Strip:
    """The arc about the axis from the angle `first` counter-clockwise over `sweep` (rad), its two ends carried along their screws."""
    z = (screws[0].low, 0.5 * (screws[0].low + screws[0].high), screws[0].high)
    start, end = (
        [angle + screw.angle(height) for height in z] for angle, screw in zip((first, first + sweep), screws, strict=True)
    )
    # The seam goes opposite the middle of the face, so that the face does not run through it.
    seam = 0.25 * (start[0] + end[0] + start[2] + end[2]) - math.pi
    axes = gp_Ax3(gp_Pnt(0.0, 0.0, 0.0), UP, gp_Dir(math.cos(seam), math.sin(seam), 0.0))

    sides = (
        Geom2d_Line(gp_Pnt2d(start[0] - seam, z[0]), RIGHT),
        _helix(screws[1], [angle - seam for angle in end], z),
        Geom2d_Line(gp_Pnt2d(start[2] - seam, z[2]), RIGHT),
        _helix(screws[0], [angle - seam for angle in start], z),
    )
    surface, low, high = (
        Geom_CylindricalSurface(axes, radius),
        _circle(radius, z[0], start[0]),
        _circle(radius, z[2], start[2]),
    )
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


def bspline(spline: Spline | Basis, poles: Floats) -> Geom_BSplineCurve:
    """A curve with the knots of `spline` and the poles (n, 3)."""
    values = TColgp_Array1OfPnt(1, len(poles))
    for i, pole in enumerate(poles):
        values.SetValue(i + 1, gp_Pnt(*map(float, pole)))
    return Geom_BSplineCurve(values, *_knots(spline), spline.degree)


def _knots(spline: Spline | Basis) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    knots, repetitions = np.unique(spline.knots, return_counts=True)
    values, counts = TColStd_Array1OfReal(1, len(knots)), TColStd_Array1OfInteger(1, len(knots))
    for i, (knot, repeated) in enumerate(zip(knots, repetitions, strict=True)):
        values.SetValue(i + 1, float(knot))
        counts.SetValue(i + 1, int(repeated))
    return values, counts
