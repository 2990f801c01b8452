"""Solids of rings, measured on the STEP file read back against the cutter that would shape them, rolled past every point."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import GeomType, Solid, import_step
from OCP.BRepCheck import BRepCheck_Analyzer

from gearwear.brep.pair import gear_pair
from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Gear, GearSpec, parse_design
from gearwear.design.surface import FILLET as ROOT_FILLET
from gearwear.design.surface import FLANK as ON_FLANK
from gearwear.design.surface import locate
from gearwear.errors import InputError
from gearwear.meshing.backlash import normal_backlash
from tests.brep.measuring import circles, face_points, tooth_faces
from tests.design.shaping import Cutter

FLANK, FILLET, VOLUME = 1e-9, 1e-8, 1e-10  # mm, mm, relative: the guarantees

SPREAD = {
    "spur, chamfered tips": {"teeth": 36, "addendum": 0.7, "tip_chamfer": 0.2},
    "left 20": {"teeth": 40, "addendum": 0.7, "helix_angle": math.radians(-20.0), "profile_shift": 0.1, "thinning": 0.05},
}


def ring(**values: float) -> Gear:
    given = {"normal_module": 2.0, "face_width": 12.0, "cutter_teeth": 18, "cutter_tip_radius": 0.2, "rim_diameter": 110.0}
    return Gear.from_spec(GearSpec("gear", internal=True, **{**given, **values}))


@pytest.fixture(
    scope="module", params=[pytest.param(name, id=name, marks=[pytest.mark.long] * (name == "left 20")) for name in SPREAD]
)
def made(request, tmp_path_factory) -> tuple[Gear, Solid]:
    """A ring, and its solid from the STEP file."""
    gear = ring(**SPREAD[request.param])
    path = tmp_path_factory.mktemp("step") / "gear.step"
    write_step(gear_solid(gear), path)
    return gear, import_step(path)


@pytest.mark.long
def test_flanks_and_roots_are_what_the_cutter_leaves(made):
    gear, solid = made
    spec = gear.spec
    points = np.concatenate([face_points(face, 9) for face in tooth_faces(solid)[::9]])
    radius = np.hypot(points[:, 0], points[:, 1])
    points, radius = points[radius > gear.flank_end_radius + 1e-6], radius[radius > gear.flank_end_radius + 1e-6]
    lead = math.tan(spec.helix_angle) / (0.5 * spec.teeth * spec.normal_module / math.cos(spec.helix_angle))
    angle = np.arctan2(points[:, 1], points[:, 0]) - lead * (points[:, 2] - 0.5 * spec.face_width)
    pitch = 2.0 * math.pi / spec.teeth
    from_space = (angle % pitch) - 0.5 * pitch
    # Distance in the transverse section, not below that in space.
    off = np.abs(Cutter(spec, 18, 0.2 * spec.normal_module).cut_depth(radius, from_space))
    on_flank = radius < gear.form_radius
    assert min(on_flank.sum(), (~on_flank).sum()) > 40
    assert off[on_flank].max() < FLANK
    assert off[~on_flank].max() < FILLET


def test_a_valid_solid_of_the_exact_volume(made):
    gear, solid = made
    assert len(solid.solids()) == 1
    assert BRepCheck_Analyzer(solid.wrapped).IsValid()
    assert solid.volume == pytest.approx(gear.section_area() * gear.face_width, rel=VOLUME)


def test_tips_lands_and_rim_are_cylinders_between_planes(made):
    gear, solid = made
    assert len(solid.faces().filter_by(GeomType.CYLINDER)) == 2 * gear.teeth + 1
    found = circles(solid)
    np.testing.assert_allclose(found[:, 1:3], 0.0, atol=1e-12)
    for radius in (gear.tip_radius, gear.root_radius):
        assert (np.abs(found[:, 0] - radius) < 1e-11 * radius).sum() == 2 * gear.teeth
    assert (np.abs(found[:, 0] - 55.0) < 1e-9).sum() == 2
    ends = sorted(face.center().Z for face in solid.faces().filter_by(GeomType.PLANE) if abs(face.normal_at().Z) > 0.5)
    assert ends == pytest.approx([0.0, gear.face_width], abs=1e-12)


def test_normals_of_faces_look_out_of_the_metal(made):
    """Of the rim away from the axis, of tips and bottom lands towards it."""
    gear, solid = made
    for face in solid.faces().filter_by(GeomType.CYLINDER):
        at, normal = face.position_at(0.5, 0.5), face.normal_at(face.position_at(0.5, 0.5))
        outside = math.hypot(at.X, at.Y) > gear.root_radius + 1.0
        assert (normal.X * at.X + normal.Y * at.Y > 0.0) == outside


def test_a_ring_without_a_rim_is_refused_by_name():
    with pytest.raises(InputError, match="rim_diameter is missing"):
        gear_solid(ring(teeth=36, addendum=0.7, rim_diameter=0.0))


@pytest.mark.parametrize("degrees", [0.0, -20.0])
def test_a_pair_stands_in_mesh_with_half_the_backlash_on_either_side(degrees):
    """The pinion's flanks, as its solid is placed, held against the ring by the distance of points."""
    both = {"module": 2.0, "face_width": 8.0, "thinning": 0.1, "addendum": 0.7}
    design = parse_design(
        {
            "pinion": {"teeth": 14, "helix_angle": degrees, **both, "profile_shift": 0.2},
            "gear": {"teeth": 36, "internal": True, **both, "profile_shift": -0.2, "rim_diameter": 110.0, "face_width": 12.0},
        }
    )
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    placed = {child.label: child for child in gear_pair(design).children}
    where = placed["gear"].location
    assert tuple(where.position)[:2] == pytest.approx((-design.centre_distance, 0.0))
    points = np.concatenate([face_points(face, 25) for face in tooth_faces(placed["pinion"])])
    turn = math.radians(where.orientation.Z)
    x, y = points[:, 0] + design.centre_distance, points[:, 1]
    in_ring = np.column_stack(
        [math.cos(turn) * x + math.sin(turn) * y, math.cos(turn) * y - math.sin(turn) * x, points[:, 2] - where.position.Z]
    )
    found = locate(in_ring, gear, workers=1)
    half = 0.5 * normal_backlash(pinion, gear, design.centre_distance)
    for side in (-1, 1):
        near = found.deviation[(found.surface == ON_FLANK) & (found.side == side)]
        assert near.min() == pytest.approx(half, abs=2e-3)  # by the points' own step
        assert near.min() > half - 1e-9
    assert not ((found.deviation < 0.0) & np.isin(found.surface, (ON_FLANK, ROOT_FILLET))).any()
