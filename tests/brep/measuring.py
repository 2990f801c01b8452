"""A B-rep measured against the closed forms: what the tests of this folder share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from build123d import Face, GeomType, Shape
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepGProp import BRepGProp
from OCP.BRepTools import BRepTools
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS
from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import FILLET, FLANK, OTHER, locate

INSIDE = np.array([1e-3, 0.37, 1.0 - 1e-3])
"""Where across the face width a face is sampled: the ends belong to the end faces."""


@dataclass(frozen=True, slots=True)
class Deviations:
    """Greatest deviations found, mm."""

    flank: float
    fillet: float
    points: int


def face_points(face: Face, along: int) -> Floats:
    """(n, 3) points on a face, `along` of them (denser at its ends) in its first parameter times three in its second."""
    surface = BRep_Tool.Surface_s(face.wrapped)
    u0, u1, v0, v1 = BRepTools.UVBounds_s(face.wrapped)
    share = 0.5 * (1.0 - np.cos(np.pi * (np.arange(along) + 0.5) / along))
    points = [surface.Value(float(u), float(v)) for u in u0 + (u1 - u0) * share for v in v0 + (v1 - v0) * INSIDE]
    return np.array([[p.X(), p.Y(), p.Z()] for p in points])


def tooth_faces(shape: Shape) -> list[Face]:
    """The faces of flanks and fillets: all that is neither plane nor round."""
    return [face for face in shape.faces() if face.geom_type not in (GeomType.PLANE, GeomType.CYLINDER, GeomType.CONE)]


def measure(shape: Shape, gear: Gear, along: int = 33, every: int = 1) -> Deviations:
    """Deviation of the surfaces of flanks and fillets from involute and trochoid, every `every`-th face."""
    return measure_faces(tooth_faces(shape)[::every], gear, along)


def measure_faces(faces: list[Face], gear: Gear, along: int = 33) -> Deviations:
    """The same of the given faces."""
    points = np.concatenate([face_points(face, along) for face in faces])
    found = locate(points, gear, workers=1)
    assert not (found.surface == OTHER).any()
    size = np.abs(found.deviation)
    return Deviations(
        float(size[found.surface == FLANK].max()), float(size[found.surface == FILLET].max(initial=0.0)), len(points)
    )


def circles(shape: Shape) -> Floats:
    """(n, 4): radius, and centre x, y, z of every circular edge, mm."""
    rows = []
    for edge in shape.edges().filter_by(GeomType.CIRCLE):
        circle = BRepAdaptor_Curve(edge.wrapped).Circle()
        centre = circle.Location()
        rows.append((circle.Radius(), centre.X(), centre.Y(), centre.Z()))
    return np.array(rows)


def outline_points(shape: Shape, along: int) -> Floats:
    """(n, 2) points on the edges of the face at z = 0, ends included, mm."""
    bottom = min(shape.faces().filter_by(GeomType.PLANE), key=lambda face: face.center().Z)
    rows = []
    for edge in bottom.outer_wire().edges():
        curve = BRepAdaptor_Curve(edge.wrapped)
        first, last = curve.FirstParameter(), curve.LastParameter()
        rows += [curve.Value(float(t)) for t in first + (last - first) * np.linspace(0.0, 1.0, along)]
    return np.array([[p.X(), p.Y()] for p in rows])


def volume(shape: Shape) -> float:
    """mm³, by the kernel's adaptive rule: its fixed one is off by 1e-8 of a whole ring."""
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape.wrapped, found, 1e-9, True)
    return found.Mass()


def closed(shape: Shape) -> bool:
    """Whether each edge that has a length belongs to two faces."""
    faces = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape.wrapped, TopAbs_EDGE, TopAbs_FACE, faces)
    edges = (i for i in range(1, faces.Extent() + 1) if not BRep_Tool.Degenerated_s(TopoDS.Edge_s(faces.FindKey(i))))
    return all(faces.FindFromIndex(i).Extent() == 2 for i in edges)
