"""Helical solids, measured on the STEP file read back against the rack that would cut them, swept in space."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from build123d import GeomType, Solid, import_step
from OCP.BRepCheck import BRepCheck_Analyzer

from gearwear.brep.screw import Sweep
from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Gear, GearSpec
from gearwear.design.twist import Segment
from tests.brep.measuring import circles, face_points, tooth_faces
from tests.brep.rack_in_space import cut_depth

FLANK, FILLET, VOLUME = 1e-9, 1e-8, 1e-10  # mm, mm, relative: the guarantees

#        teeth, normal module, face width, β in degrees, further values
SPREAD = {
    "undercut, right hand": (12, 3.0, 20.0, 15.0, {}),
    "left hand, bored, chamfered tips": (19, 2.5, 18.0, -25.0, {"bore_diameter": 20.0, "tip_chamfer": 0.3, "profile_shift": 0.2}),
    "far round the axis": (11, 2.0, 30.0, 35.0, {"profile_shift": 0.3, "thinning": 0.1}),
}


@pytest.fixture(
    scope="module", params=[pytest.param(name, id=name, marks=[pytest.mark.long] * ("left hand" in name)) for name in SPREAD]
)
def made(request, tmp_path_factory) -> tuple[Gear, Solid]:
    """A gear, and its solid from the STEP file."""
    teeth, module, width, degrees, extra = SPREAD[request.param]
    gear = Gear.from_spec(GearSpec("gear", teeth, module, width, helix_angle=math.radians(degrees), **extra))
    path = tmp_path_factory.mktemp("step") / "gear.step"
    write_step(gear_solid(gear), path)
    return gear, import_step(path)


def test_flanks_and_roots_are_what_the_rack_leaves(made):
    gear, solid = made
    points = np.concatenate([face_points(face, 13) for face in tooth_faces(solid)[::5]])  # 4 or 6 kinds of face: all are met
    radius = np.hypot(points[:, 0], points[:, 1])
    points = points[radius < gear.flank_end_radius - 1e-6]  # without the tip chamfers
    radius = np.hypot(points[:, 0], points[:, 1])
    off = np.abs(cut_depth(gear.spec, points))
    on_flank = radius > gear.form_radius
    assert on_flank.sum() > 100
    assert (~on_flank).sum() > 100
    assert off[on_flank].max() < FLANK
    assert off[~on_flank].max() < FILLET


def test_every_tooth_is_there(made):
    """One point in the middle of every flank face: as many on left as on right flanks of each tooth."""
    gear, solid = made
    middles = np.array([[*face.position_at(0.5, 0.5)] for face in tooth_faces(solid)])
    radius = np.hypot(middles[:, 0], middles[:, 1])
    flanks = middles[(radius > gear.form_radius) & (radius < gear.flank_end_radius)]
    assert np.abs(cut_depth(gear.spec, flanks)).max() < FLANK
    angle = np.arctan2(flanks[:, 1], flanks[:, 0]) - gear.twist * (flanks[:, 2] - 0.5 * gear.face_width)
    tooth = np.rint(angle / gear.pitch_angle).astype(int) % gear.teeth
    assert (np.bincount(tooth) == 2).all()


def test_a_valid_solid_of_the_exact_volume(made):
    gear, solid = made
    assert len(solid.solids()) == 1
    assert BRepCheck_Analyzer(solid.wrapped).IsValid()
    assert solid.volume == pytest.approx(gear.section_area() * gear.face_width, rel=VOLUME)


def test_tips_and_bottom_lands_are_cylinders_between_planes(made):
    gear, solid = made
    bored = gear.spec.bore_diameter > 0.0
    assert len(solid.faces().filter_by(GeomType.CYLINDER)) == 2 * gear.teeth + bored
    found = circles(solid)
    np.testing.assert_allclose(found[:, 1:3], 0.0, atol=1e-12)
    for radius in (gear.tip_radius, gear.root_radius):
        assert (np.abs(found[:, 0] - radius) < 1e-11 * radius).sum() == 2 * gear.teeth
    ends = sorted(face.center().Z for face in solid.faces().filter_by(GeomType.PLANE))
    assert ends == pytest.approx([0.0, gear.face_width], abs=1e-12)


def test_a_worm_like_gear_goes_more_than_once_round(tmp_path):
    # κ b = 2π: every tooth goes once round the axis; a cylinder's own parameters no longer serve for a tip.
    spec = GearSpec("gear", 6, 1.0, 1.0, helix_angle=math.radians(45.0), profile_shift=0.3)
    lead = math.pi * 6.0 * 1.0 / math.sin(spec.helix_angle)
    gear = Gear.from_spec(replace(spec, face_width=1.05 * lead))
    write_step(gear_solid(gear), tmp_path / "gear.step")
    solid = import_step(tmp_path / "gear.step")
    assert solid.is_valid
    assert solid.volume == pytest.approx(gear.section_area() * gear.face_width, rel=VOLUME)


def test_the_screw_turns_evenly_from_mid_face():
    # Against cos and sin themselves, at the tip of a gear whose section turns by 1.5 rad.
    screw = Sweep.of(Segment(0.0, 50.0, 0.03), 40.0)
    share = np.linspace(0.0, 1.0, 1001)
    angle = 0.03 * (50.0 * share - 25.0)
    off = screw.turning.points(share) - np.column_stack([np.cos(angle), np.sin(angle)])
    assert 40.0 * np.abs(off).max() < 1e-10
    assert screw.heights[[0, -1]] == pytest.approx([0.0, 50.0], abs=1e-14)


def test_a_spur_gear_is_extruded_as_ever(pinion):
    kinds = {face.geom_type for face in tooth_faces(gear_solid(pinion))}
    assert kinds == {GeomType.EXTRUSION}
