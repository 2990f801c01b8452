"""Chamfered and rounded ends of every toothing: the depth of their faces, what they take away, and that flanks stay what they were."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from build123d import GeomType, Solid, import_step

from gearwear.brep.ends import end_bands
from gearwear.brep.outline import tooth_edges
from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Gear, GearSpec
from gearwear.design.modification import FlankModification
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, locate
from gearwear.errors import InputError
from tests.brep.measuring import closed, face_points, tooth_faces, volume
from tests.brep.parallels import inset, lost_volume, outline_distance, profile
from tests.design.drawn import ALL, HELICAL, OTHER, PLAIN

RING = GearSpec(
    "gear",
    36,
    2.0,
    12.0,
    internal=True,
    addendum=0.7,
    cutter_teeth=18,
    cutter_tip_radius=0.2,
    rim_diameter=110.0,
    tip_chamfer=0.2,
)
ARC = replace(RING, cutter_teeth=None, cutter_tip_radius=None, fillet_radius=0.5, tip_chamfer=0.0, tip_rounding=0.3)
SPREAD = {
    "spur, folds at its base circle": GearSpec("gear", 10, 2.0, 10.0, profile_shift=0.5, end_chamfer=0.35),
    "the same unshifted": GearSpec("gear", 19, 2.0, 10.0, end_chamfer=0.5),
    "undercut, rounded tips": GearSpec("gear", 12, 4.0, 12.0, tip_rounding=0.6, end_rounding=0.4, bore_diameter=16.0),
    "helical, chamfered tips": GearSpec(
        "gear", 24, 2.0, 20.0, helix_angle=0.35, tip_chamfer=0.3, end_chamfer=0.4, bore_diameter=20.0
    ),
    "left hand, rounding": GearSpec("gear", 15, 3.0, 18.0, helix_angle=-0.45, profile_shift=0.3, end_rounding=0.5),
    "protuberance": GearSpec("gear", 25, 3.0, 20.0, dedendum=1.4, protuberance=0.15, grinding_stock=0.1, end_rounding=0.6),
    "ring": replace(RING, end_chamfer=0.3),
    "helical ring": replace(ARC, helix_angle=-0.3, end_rounding=0.25),
    "profile modified": replace(
        PLAIN, end_chamfer=0.4, tip_chamfer=0.4, left=FlankModification(tip_relief=0.02, tip_relief_length=2.5)
    ),
    "helical, all modified": replace(HELICAL, end_rounding=0.4, tip_rounding=0.6, left=ALL, right=OTHER),
    "ring, all modified": replace(RING, end_chamfer=0.25, left=ALL),
    "relief shorter than the chamfer": replace(
        PLAIN, end_chamfer=0.6, left=FlankModification(end_relief=0.01, end_relief_length=0.3), right=OTHER
    ),
}


@pytest.fixture(
    scope="module",
    params=[pytest.param(name, id=name, marks=[] if place < 1 else pytest.mark.long) for place, name in enumerate(SPREAD)],
)
def made(request, tmp_path_factory) -> tuple[Gear, Solid, Solid]:
    """A gear, its solid, and that solid from its STEP file."""
    gear = Gear.from_spec(SPREAD[request.param])
    solid = gear_solid(gear)
    path = tmp_path_factory.mktemp("step") / "gear.step"
    write_step(solid, path)
    return gear, solid, import_step(path)


def plain(gear: Gear) -> Gear:
    """With sharp ends."""
    return Gear.from_spec(replace(gear.spec, end_chamfer=0.0, end_rounding=0.0))


def between(faces, low: float, high: float):
    """Faces that lie between two heights, ends included, by their corners: edges rise from end to end."""
    heights = [(face, [corner.Z for corner in face.vertices()]) for face in faces]
    return [face for face, z in heights if low - 1e-3 < min(z) and max(z) < high + 1e-3 and max(z) - min(z) > 1e-3]


def test_a_valid_closed_solid_without_what_the_parallels_say(made):
    gear, *shapes = made
    lost = lost_volume(gear)
    for shape in shapes:
        assert shape.is_valid and closed(shape) and len(shape.solids()) == 1
        assert gear.volume - volume(shape) == pytest.approx(lost, rel=3e-6)  # by the polygon's chords


@pytest.mark.parametrize("upper", [pytest.param(False, marks=pytest.mark.long), True], ids=["low", "high"])
def test_each_point_lies_at_its_depth_below_the_outline_at_its_height(made, upper):
    gear, _, solid = made
    size, width = gear.spec.end_edge, gear.face_width
    faces = between(solid.faces(), width - size, width) if upper else between(solid.faces(), 0.0, size)
    chosen = np.random.default_rng(4).permutation(len(faces))[:10]
    points = np.concatenate([face_points(faces[i], 4) for i in chosen])
    height = width - points[:, 2] if upper else points[:, 2]
    depth = size - height if gear.spec.end_chamfer > 0.0 else size - np.sqrt(np.maximum(size**2 - (size - height) ** 2, 0.0))
    off = outline_distance(gear, points) - depth
    assert np.abs(off).max() < 1e-6


def test_flanks_and_roots_between_are_untouched(made):
    gear, _, solid = made
    size, width = gear.spec.end_edge, gear.face_width
    faces = [face for face in tooth_faces(solid) if size - 1e-3 < face.center().Z < width - size + 1e-3]
    faces = between(faces, size, width - size)
    points = np.concatenate([face_points(faces[i], 7) for i in np.random.default_rng(8).permutation(len(faces))[:60]])
    found = locate(points, plain(gear), workers=1)
    off = np.abs(found.deviation)
    assert min((found.surface == FLANK).sum(), (found.surface == FILLET).sum()) > 100
    assert off[found.surface == FLANK].max() < 1e-9
    assert off[found.surface == FILLET].max() < 1e-8


@pytest.mark.long
@pytest.mark.parametrize("teeth", [12, 17, 18, 19, 60])
@pytest.mark.parametrize("ends", [{"end_chamfer": 0.6}, {"end_rounding": 0.5}], ids=["chamfer", "rounding"])
def test_of_a_spur_gear_they_take_away_what_closed_forms_say(teeth, ends):
    gear = Gear.from_spec(GearSpec("gear", teeth, 6.35, 15.0, **ends))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    depth, _, rate = profile(gear, 0.5 * (nodes + 1.0))
    lost = [gear.section_area() - inset(gear, float(one)).section_area() for one in depth]
    taken = gear.volume - volume(gear_solid(gear))
    assert taken == pytest.approx(float(np.dot(weights * rate, lost)), rel=3e-6)


@pytest.mark.long
def test_double_helical_gears_have_them_at_both_ends_and_sharp_grooves(tmp_path):
    spec = GearSpec("gear", 13, 2.0, 26.0, helix_angle=0.5, profile_shift=0.2, bore_diameter=8.0, gap=4.0, end_chamfer=0.3)
    gear = Gear.from_spec(spec)
    write_step(gear_solid(gear), tmp_path / "gear.step")
    solid = import_step(tmp_path / "gear.step")
    assert solid.is_valid and closed(solid) and len(solid.solids()) == 1
    lost = lost_volume(Gear.from_spec(replace(spec, gap=0.0)))  # sections of either hand are the same, turned
    assert gear.volume - volume(solid) == pytest.approx(lost, rel=3e-6)
    heights = sorted({round(vertex.Z, 9) for vertex in solid.vertices()})
    assert heights == [0.0, 0.3, 11.0, 15.0, 25.7, 26.0]


def test_end_faces_are_planes_and_tips_circles(made):
    gear, solid, _ = made
    planes = [face for face in solid.faces().filter_by(GeomType.PLANE) if abs(face.normal_at().Z) > 0.5]
    assert sorted(face.center().Z for face in planes) == pytest.approx([0.0, gear.face_width], abs=1e-12)
    low = min(planes, key=lambda face: face.center().Z)
    radii = [edge.radius for edge in low.edges().filter_by(GeomType.CIRCLE)]
    least = gear.tip_radius - gear.orientation * gear.spec.end_edge
    assert sum(abs(radius - least) < 1e-9 for radius in radii) == gear.teeth


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"end_chamfer": 4.0}, "end_chamfer = 4 mm: leaves no tip on the end face; below"),
        ({"end_rounding": 4.0}, "end_rounding = 4 mm: leaves no tip on the end face; below"),
        ({"end_rounding": 4.0, "helix_angle": 0.3}, "end_rounding = 4 mm: leaves no tip on the end face; below"),
        (
            {"end_chamfer": 0.8, "tip_chamfer": 0.3, "teeth": 20, "normal_module": 2.0},
            "leaves no chamfer on the end face; below 0\\.[0-9]+ mm",
        ),
        ({"end_chamfer": 0.7, "tip_rounding": 0.6}, "leaves no rounding on the end face; below 0\\.5999 mm it would"),
        ({"end_chamfer": 1.0, "bore_diameter": 59.0}, "end_chamfer = 1 mm: reaches the bore; below 0\\.6625 mm it would not"),
        ({"end_chamfer": 7.0, "helix_angle": 0.3, "gap": 2.0}, "reaches the groove; below 6\\.5000 mm it would not"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(changed, words):
    with pytest.raises(InputError, match=words):
        gear_solid(Gear.from_spec(replace(GearSpec("pinion", 12, 6.35, 15.0), **changed)))


@pytest.mark.parametrize(
    ("how", "amount"),
    [("profile_slope", 0.01), ("profile_slope", -0.01), ("profile_crowning", 0.01), ("root_relief", 0.02)],
)
def test_flanks_bent_where_they_leave_the_base_circle_are_refused_with_what_would_be_right(how, amount):
    """Of 17 teeth the involute begins at L = 0.25 mm: a slope δ′ over L is a bend of δ′ r_b / L, to first order."""
    more = {"root_relief_length": 3.0} if how == "root_relief" else {}
    flank = FlankModification(**{how: amount}, **more)
    gear = Gear.from_spec(GearSpec("pinion", 17, 3.0, 20.0, end_chamfer=0.2, left=flank, right=flank))
    with pytest.raises(InputError, match=r"end_chamfer = 0\.2 mm: cannot be drawn .* sharp ends, or") as caught:
        end_bands(gear, tooth_edges(gear))
    told = float(str(caught.value).split("bend of ")[1].split("°")[0])
    ends = np.array([0.0, 1e-6]) + gear.form_roll
    slope = float(np.diff(gear.drawn(Side.LEFT).offset(ends, 10.0))[0]) / 1e-6
    rise = slope * gear.base_radius / gear.form_roll
    assert told == pytest.approx(math.degrees(math.atan(abs(rise))), rel=0.06)  # told to two digits
    assert gear_solid(Gear.from_spec(replace(gear.spec, end_chamfer=0.0))).is_valid


@pytest.mark.long
def test_what_would_fit_is_right():
    said = "leaves no tip"
    spec = GearSpec("pinion", 24, 2.0, 10.0, helix_angle=0.3, end_chamfer=1.5)
    with pytest.raises(InputError, match=said) as caught:
        gear_solid(Gear.from_spec(spec))
    limit = float(str(caught.value).split("below ")[1].split(" mm")[0])
    assert math.isclose(limit, 1.5, rel_tol=0.7)
    assert gear_solid(Gear.from_spec(replace(spec, end_chamfer=0.99 * limit))).is_valid
    with pytest.raises(InputError, match=said):
        gear_solid(Gear.from_spec(replace(spec, end_chamfer=1.01 * limit)))
