"""Design to solid: one outline of shared vertices and exact edges, extruded, or carried along the screw of a helical gear."""

from __future__ import annotations

import math

import numpy as np
from build123d import Solid
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.Geom import Geom_Circle
from OCP.gp import gp_Ax2, gp_Dir, gp_Pln, gp_Pnt, gp_Vec
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Shape, TopoDS_Vertex, TopoDS_Wire

from gearwear.arrays import Floats
from gearwear.brep.curves import Spline
from gearwear.brep.ends import end_bands
from gearwear.brep.outline import Arc, Line, rotation, tooth_edges
from gearwear.brep.paths import has_bottom_land
from gearwear.brep.screw import screws
from gearwear.brep.twisted import band_layer, bspline, swept_layer, toothed_solid
from gearwear.design.gear import Gear
from gearwear.errors import InputError

UP = gp_Dir(0.0, 0.0, 1.0)


def gear_solid(gear: Gear) -> Solid:
    """The nominal gear as an exact solid.

    Parameters
    ----------
    gear : Gear
        The gear; bore, tip chamfer or rounding, and end chamfers or roundings are made if it has them. A ring needs its rim diameter.

    Returns
    -------
    build123d.Solid
        Axis along +z, z from 0 to the face width, a tooth centre on +x (at mid-face, or at the middle of either half of a double helical
        gear); its `label` is the part's name.

    Raises
    ------
    InputError
        If the gear has an edge too short for a solid model, an end chamfer or rounding that does not fit, or a ring has no rim diameter.

    Notes
    -----
    Flanks are drawn within 1e-10 mm of the involute and fillets of the trochoid (1e-9 and 1e-8 are guaranteed, also
    after a STEP file); tips and bottom lands are cylinders. Modified flanks have an edge at each knee; where the modification varies along
    the face, each tooth side is carried by a turn of its own, as exactly, and the fillet with it. Of a helical gear flanks and fillets are
    products of poles (`screw`), exact to the same 1e-10 mm. Chamfers and roundings of the ends interpolate exact inner parallels of the
    outline (`ends`), within 1e-7 mm; the edges of the bore, of a ring's outside and of a groove stay sharp.
    """
    solids = Solid(_shape(gear)).solids()
    if len(solids) != 1 or not BRepCheck_Analyzer(solids[0].wrapped).IsValid():
        chamfers = f"tip_chamfer = {gear.spec.tip_chamfer:g} mm, end_chamfer = {gear.spec.end_chamfer:g} mm"
        raise InputError(f"[{gear.spec.name}] {chamfers}: no valid solid comes out of this design; smaller chamfers would help")
    solids[0].label = gear.spec.name
    return solids[0]


def _shape(gear: Gear) -> TopoDS_Shape:
    spec, bore, width = gear.spec, gear.body_radius, gear.face_width
    if spec.internal and bore == 0.0:
        raise InputError(f"[{spec.name}] rim_diameter is missing: mm; a solid model of a ring ends there")
    if gear.twist == 0.0 and not gear.modified_along_face and spec.end_edge == 0.0:
        return _extruded(gear, bore, width)
    if gear.modified_along_face and not has_bottom_land(gear):
        raise InputError(
            f"[{spec.name}] the root has no bottom land, and what is modified along the face moves its two fillets apart: no solid of "
            "that yet; a smaller rack_tip_radius leaves a land"
        )
    edges = tooth_edges(gear)
    low, high = (tuple(band_layer(band, gear.teeth) for band in bands) for bands in end_bands(gear, edges))
    body = (swept_layer(edges, gear.teeth, sweeps) for sweeps in screws(gear))
    groove = gear.groove_radius if spec.gap > 0.0 else 0.0
    return toothed_solid((*low, *body, *high), bore, groove, gear.orientation)


def _extruded(gear: Gear, bore: float, width: float) -> TopoDS_Shape:
    loops = [_wire(gear)]
    if bore > 0.0:
        circle = BRepBuilderAPI_MakeEdge(Geom_Circle(gp_Ax2(), bore)).Edge()
        loops.append(BRepBuilderAPI_MakeWire(circle).Wire())
    outer, *holes = loops[:: gear.orientation]  # of a ring the outline is the hole
    face = BRepBuilderAPI_MakeFace(gp_Pln(), outer, True)
    for hole in holes:
        face.Add(TopoDS.Wire_s(hole.Reversed()))
    return BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0.0, 0.0, width)).Shape()


def _wire(gear: Gear) -> TopoDS_Wire:
    """The whole outline at z = 0, neighbours sharing their vertex."""
    edges = tooth_edges(gear)
    turns = [rotation(k * gear.pitch_angle) for k in range(gear.teeth)]
    starts = np.concatenate([np.array([edge.start for edge in edges]) @ turn for turn in turns])
    vertices = [BRepBuilderAPI_MakeVertex(gp_Pnt(float(x), float(y), 0.0)).Vertex() for x, y in starts]
    wire = BRepBuilderAPI_MakeWire()
    for index, (x, y) in enumerate(starts):
        shape = edges[index % len(edges)].shape
        ends = vertices[index], vertices[(index + 1) % len(vertices)]
        match shape:
            case Spline():
                wire.Add(_spline_edge(shape, turns[index // len(edges)], *ends))
            case Arc():
                wire.Add(_arc_edge(shape, math.atan2(y, x), starts[(index + 1) % len(vertices)], *ends))
            case Line():
                wire.Add(BRepBuilderAPI_MakeEdge(*ends).Edge())
    return wire.Wire()


def _spline_edge(spline: Spline, turn: Floats, first: TopoDS_Vertex, last: TopoDS_Vertex) -> TopoDS_Edge:
    poles = np.column_stack([spline.poles @ turn, np.zeros(len(spline.poles))])
    return BRepBuilderAPI_MakeEdge(bspline(spline, poles), first, last).Edge()


def _arc_edge(arc: Arc, start: float, end: Floats, first: TopoDS_Vertex, last: TopoDS_Vertex) -> TopoDS_Edge:
    """Each arc starts at parameter 0 of a circle of its own, so that none runs through a seam."""
    axes = gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), UP, gp_Dir(math.cos(start), math.sin(start), 0.0))
    sweep = (math.atan2(end[1], end[0]) - start) % (2.0 * math.pi)
    return BRepBuilderAPI_MakeEdge(Geom_Circle(axes, arc.radius), first, last, 0.0, sweep).Edge()
