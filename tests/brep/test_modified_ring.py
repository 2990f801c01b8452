"""Modified flanks of rings: the nominal surface and the solid read back from STEP, against the drawing's own words."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import import_step
from OCP.BRepCheck import BRepCheck_Analyzer

from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Gear, GearSpec
from gearwear.design.modification import FlankModification
from gearwear.design.profiles import nominal_profiles
from gearwear.design.surface import FLANK, flank_points, locate
from gearwear.errors import InputError
from tests.brep.measuring import face_points, tooth_faces

LEFT = FlankModification(
    tip_relief=0.02, tip_relief_length=2.5, tip_relief_form="parabolic", root_relief=0.012, root_relief_length=2.0,
    profile_crowning=0.004, helix_crowning=0.01, profile_slope=0.006, helix_slope=-0.012, end_relief=0.015, end_relief_length=3.0,
)  # fmt: skip
RIGHT = FlankModification(tip_relief=0.03, tip_relief_start=109.0, helix_slope=0.02)


def ring(degrees: float, left: FlankModification = LEFT, right: FlankModification = RIGHT) -> Gear:
    return Gear.from_spec(
        GearSpec(
            "gear", 42, 2.5, 14.0, addendum=0.8, helix_angle=math.radians(degrees), internal=True, fillet_radius=0.5,
            rim_diameter=130.0, left=left, right=right,
        )
    )  # fmt: skip


def by_hand(gear: Gear, side: int, roll: float, z: float) -> float:
    """δ₀ in mm; lengths of roll fall from the form circle to the tip."""
    form, tip, b = gear.form_roll, gear.tip_roll, gear.face_width
    zeta, to_tip = z / b - 0.5, form - roll
    u = 2.0 * to_tip / (form - tip) - 1.0
    if side > 0:
        offset = -0.02 * (max(2.5 - (roll - tip), 0.0) / 2.5) ** 2 - 0.012 * max(2.0 - to_tip, 0.0) / 2.0
        return (
            offset + 0.003 * u - 0.004 * u**2 - 0.01 * 4.0 * zeta**2 - 0.012 * zeta - 0.015 * max(1.0 - min(z, b - z) / 3.0, 0.0)
        )
    start = math.sqrt(54.5**2 - gear.base_radius**2)
    return -0.03 * max(start - roll, 0.0) / (start - tip) - 0.02 * zeta


def half_angle(gear: Gear, side: int, roll: float, z: float) -> float:
    """Of the flank at a radius: as generated, which grows outwards, and δ₀ of arc at the base circle more."""
    angle = math.atan(roll / gear.base_radius)
    return gear.base_half_angle + roll / gear.base_radius - angle + by_hand(gear, side, roll, z) / gear.base_radius


@pytest.mark.parametrize("degrees", [0.0, -20.0])
def test_points_off_the_drawn_flank_are_off_by_as_much(degrees):
    """A point moved along the surface's normal, taken from the surface by hand: exact but for the square of the flank's slope against the involute."""
    gear, rng = ring(degrees), np.random.default_rng(1)
    n, h = 300, 1e-5
    side, tooth = rng.choice([-1, 1], n), rng.integers(0, 42, n)
    roll, z = rng.uniform(gear.tip_roll + 0.1, gear.form_roll - 0.1, n), rng.uniform(0.1, 13.9, n)

    def surface(s, k, at, height):
        radius = math.hypot(gear.base_radius, at)
        theta = s * half_angle(gear, s, at, height) + 2.0 * math.pi * k / 42 + gear.twist * (height - 7.0)
        return np.array([radius * math.cos(theta), radius * math.sin(theta), height])

    points, moved = [], rng.uniform(-0.05, 0.05, n)
    for s, k, at, height, d in zip(side, tooth, roll, z, moved, strict=True):
        across = surface(s, k, at + h, height) - surface(s, k, at - h, height)
        normal = np.cross(across, surface(s, k, at, height + h) - surface(s, k, at, height - h))
        normal /= np.linalg.norm(normal)
        tangent = np.array([-surface(s, k, at, height)[1], surface(s, k, at, height)[0], 0.0])
        points.append(surface(s, k, at, height) + d * normal * math.copysign(1.0, s * float(normal @ tangent)))
    found = locate(np.array(points), gear, workers=1)
    assert (found.surface == FLANK).all() and (found.tooth == tooth).all() and (found.side == side).all()

    def slope(s, at, height):
        """Of δ₀ over the flank's own length, L / r_b of the roll; the steepest round a place, as a knee may lie near it."""
        per = [
            (by_hand(gear, s, at + d + h, height) - by_hand(gear, s, at + d - h, height)) / (2 * h) * gear.base_radius / at
            for d in (-0.08, 0.0, 0.08)
        ]
        along = [
            (by_hand(gear, s, at, height + d + h) - by_hand(gear, s, at, height + d - h)) / (2 * h) for d in (-0.08, 0.0, 0.08)
        ]
        return math.hypot(max(map(abs, per)), max(map(abs, along)))

    steep = np.array([slope(s, at, height) for s, at, height in zip(side, roll, z, strict=True)])
    assert (np.abs(found.deviation - moved) <= np.abs(moved) * steep**2 + 1e-7).all()
    on = locate(np.array([surface(*one) for one in zip(side, tooth, roll, z, strict=True)]), gear, workers=1)
    assert np.abs(on.deviation).max() < 1e-9
    exact = flank_points(gear, tooth, side, roll, z)
    there = np.array([surface(*one) for one in zip(side, tooth, roll, z, strict=True)])
    # At the length of roll stated the point lies δ₀ of it further on along the involute: the same surface.
    assert np.abs(locate(exact.position, gear, workers=1).deviation).max() < 1e-4
    assert np.abs(exact.position - there).max() < 0.05


def test_profiles_for_contact_are_the_drawn_ones():
    gear = ring(-20.0)
    radius, z = np.linspace(gear.tip_radius, gear.form_radius, 40), np.array([1.0, 7.0, 12.0])
    profiles = nominal_profiles(gear, radius, z)
    roll = np.sqrt(radius**2 - gear.base_radius**2)
    for s, index in ((1, 0), (-1, 1)):
        truth = [[half_angle(gear, s, float(at), float(height)) for at in roll] for height in z]
        assert profiles.half_angle[3, index] == pytest.approx(np.array(truth), abs=1e-12)


def test_a_spur_ring_modified_along_the_profile_alone_has_the_exact_volume():
    gear = ring(0.0, FlankModification(tip_relief=0.02, tip_relief_length=2.5, profile_crowning=0.01), FlankModification())
    assert gear_solid(gear).volume == pytest.approx(gear.volume, rel=1e-10)


@pytest.mark.long
def test_the_solid_read_back_is_the_drawn_one(tmp_path):
    gear = ring(-20.0)
    write_step(gear_solid(gear), tmp_path / "gear.step")
    solid = import_step(tmp_path / "gear.step")
    assert len(solid.solids()) == 1 and BRepCheck_Analyzer(solid.wrapped).IsValid()
    assert solid.volume == pytest.approx(gear.volume, rel=1e-10)
    faces = tooth_faces(solid)
    points = np.concatenate([face_points(faces[i], 7) for i in np.random.default_rng(8).permutation(len(faces))[:70]])
    radius = np.hypot(points[:, 0], points[:, 1])
    points = points[(radius < gear.form_radius - 1e-9) & (radius > gear.flank_end_radius + 1e-9)]
    angle = np.arctan2(points[:, 1], points[:, 0]) - gear.twist * (points[:, 2] - 7.0)
    angle -= np.rint(angle / gear.pitch_angle) * gear.pitch_angle
    roll = np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 - gear.base_radius**2)
    side = np.where(angle > 0.0, 1, -1)
    drawn = [half_angle(gear, int(s), float(a), float(c)) for s, a, c in zip(side, roll, points[:, 2], strict=True)]
    assert min((side > 0).sum(), (side < 0).sum()) > 200
    assert gear.base_radius * np.abs(np.abs(angle) - drawn).max() < 1e-9


def test_a_relief_that_begins_off_the_flank_is_refused_by_name():
    with pytest.raises(InputError, match=r"tip_relief_start = 140 mm: the relief must begin on the flank, between the diameters"):
        ring(0.0, FlankModification(tip_relief=0.02, tip_relief_start=140.0), RIGHT)
