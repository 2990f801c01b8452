"""Solids of modified flanks, measured on the STEP file read back against the drawing's own words."""

import math
from dataclasses import replace

import numpy as np
import pytest
from build123d import Solid, import_step
from OCP.BRepCheck import BRepCheck_Analyzer

from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.errors import InputError
from tests.brep.measuring import face_points, tooth_faces
from tests.design.drawn import ALL, HELICAL, OTHER, PLAIN, gear_with, offset_by_hand

FULL = (math.pi / 4.0 - 1.25 * math.tan(PLAIN.normal_pressure_angle)) / math.tan(
    math.pi / 4.0 - PLAIN.normal_pressure_angle / 2.0
)
"""Tip radius, in modules, of a rack round from flank to flank: tan(π/4 − α/2) = (1 − sin α) / cos α."""

SPREAD = {
    "spur, bored, chamfered tips": replace(PLAIN, tip_chamfer=0.2, bore_diameter=20.0),
    "helical": HELICAL,
}


@pytest.fixture(
    scope="module", params=[pytest.param(name, id=name, marks=[pytest.mark.long] * (name != "helical")) for name in SPREAD]
)
def made(request, tmp_path_factory) -> tuple[Gear, Solid]:
    gear = gear_with(ALL, OTHER, SPREAD[request.param])
    path = tmp_path_factory.mktemp("step") / "gear.step"
    write_step(gear_solid(gear), path)
    return gear, import_step(path)


def test_flanks_are_the_drawing_s(made):
    gear, solid = made
    faces = tooth_faces(solid)
    points = np.concatenate([face_points(faces[i], 7) for i in np.random.default_rng(8).permutation(len(faces))[:70]])
    radius = np.hypot(points[:, 0], points[:, 1])
    points = points[(radius > gear.form_radius + 1e-9) & (radius < gear.flank_end_radius - 1e-9)]
    radius, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    angle = np.arctan2(points[:, 1], points[:, 0]) - math.tan(gear.spec.helix_angle) / gear.reference_radius * (z - 10.0)
    angle -= np.rint(angle / gear.pitch_angle) * gear.pitch_angle
    roll = np.sqrt(radius**2 - gear.base_radius**2)
    side = np.where(angle > 0.0, 1, -1)
    along = gear.base_radius * (
        np.abs(angle) - gear.base_half_angle + roll / gear.base_radius - np.arctan(roll / gear.base_radius)
    )
    drawn = [offset_by_hand(gear, int(s), float(a), float(c)) for s, a, c in zip(side, roll, z, strict=True)]
    assert min((side > 0).sum(), (side < 0).sum()) > 300
    assert np.abs(along - drawn).max() < 1e-9


@pytest.mark.long
def test_a_valid_solid_of_the_exact_volume(made):
    gear, solid = made
    assert len(solid.solids()) == 1
    assert BRepCheck_Analyzer(solid.wrapped).IsValid()
    assert solid.volume == pytest.approx(gear.volume, rel=1e-10)


@pytest.mark.long
def test_relief_on_one_side_takes_off_what_it_says():
    """A profile slope of f on the left alone adds ∫ ½ f u · L dL / r_b a tooth: f (tip − form)² / 12 r_b by hand, and what the turned fillet loses."""
    f = 0.03
    plain, sloped = Gear.from_spec(PLAIN), gear_with(FlankModification(profile_slope=f), FlankModification(), PLAIN)
    flank = f * (plain.tip_roll - plain.form_roll) ** 2 / (12.0 * plain.base_radius)
    fillet = -0.5 * f / plain.base_radius * 0.5 * (plain.form_radius**2 - plain.root_radius**2)
    added = gear_solid(sloped).volume - gear_solid(plain).volume
    assert added == pytest.approx(25 * 20.0 * (flank + fillet), rel=1e-6)


def test_knees_are_edges():
    """Tip relief on both sides: one more flank face a side than without."""
    plain, relieved = Gear.from_spec(PLAIN), gear_with(FlankModification(tip_relief=0.02, tip_relief_length=2.0))
    assert len(gear_solid(relieved).faces()) == len(gear_solid(plain).faces()) + 2 * 25


def test_modified_along_the_face_without_a_bottom_land_is_refused_by_name():
    with pytest.raises(InputError, match="no bottom land"):
        gear_solid(gear_with(ALL, ALL, replace(PLAIN, rack_tip_radius=FULL)))
