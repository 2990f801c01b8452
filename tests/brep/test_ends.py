"""Ends that the kernel rounds: what is lost, where the rounding lies, and that flanks stay what they were."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from build123d import GeomType, import_step

from gearwear.brep.outline import inset
from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Gear, GearSpec
from gearwear.design.modification import FlankModification
from gearwear.design.surface import FLANK, locate
from gearwear.errors import InputError
from tests.brep.measuring import face_points, measure_faces, tooth_faces

ROUND, WIDTH = 0.4, 12.0
SPUR = GearSpec("gear", 12, 4.0, WIDTH, end_rounding=ROUND)


def lost_by_rounding(gear: Gear, radius: float) -> float:
    """Both ends, mm³, by the trapezium rule over heights that crowd at the face: at z the section is the parallel at r − √(r² − (r − z)²)."""
    z = radius * np.linspace(0.0, 1.0, 60) ** 2
    depth = radius - np.sqrt(np.maximum(radius**2 - (radius - z) ** 2, 0.0))
    lost = [gear.section_area() - inset(gear, max(float(t), 1e-9)).section_area() for t in depth]
    return 2.0 * float(np.trapezoid(lost, z))


@pytest.mark.parametrize("extra", [{}, {"bore_diameter": 16.0}, {"tip_rounding": 0.6}], ids=["plain", "bore", "rounding"])
def test_a_rounding_takes_away_what_the_parallel_outlines_say(extra, tmp_path):
    gear = Gear.from_spec(replace(SPUR, **extra))
    solid = gear_solid(gear)
    write_step(solid, tmp_path / "gear.step")
    for shape in (solid, import_step(tmp_path / "gear.step")):
        assert shape.is_valid and len(shape.solids()) == 1
        assert gear.volume - shape.volume == pytest.approx(lost_by_rounding(gear, ROUND), rel=3e-3)
    assert solid.label == "gear"


def test_the_rounding_is_a_ball_s_and_flanks_between_are_untouched():
    solid, plain = gear_solid(Gear.from_spec(SPUR)), Gear.from_spec(replace(SPUR, end_rounding=0.0))
    middle = [face for face in tooth_faces(solid) if abs(face.center().Z - 0.5 * WIDTH) < 1e-3]
    assert len(middle) == 4 * 12
    found = measure_faces(middle, plain)
    assert found.flank < 1e-9 and found.fillet < 1e-8
    faces = [face for face in solid.faces() if face.center().Z < ROUND and face.geom_type != GeomType.PLANE]
    points = np.concatenate([face_points(face, 9) for face in faces])
    at = locate(points * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.5 * WIDTH], plain)
    radius, low = np.hypot(*points[:, :2].T), ROUND - points[:, 2]
    inside = (radius > plain.form_radius + 2.0 * ROUND) & (radius < plain.tip_radius - 2.0 * ROUND)
    on = inside & (at.surface == FLANK) & (low >= 0.0)
    assert on.sum() > 200
    depth = ROUND - np.sqrt(np.maximum(ROUND**2 - low**2, 0.0))
    np.testing.assert_allclose(at.deviation[on], -depth[on], atol=1e-4)


@pytest.mark.parametrize(
    "extra",
    [{"end_rounding": 2.5}, {"end_rounding": 5.5}, {"tip_chamfer": 0.5, "end_rounding": 0.2}],
    ids=["2.5", "5.5", "chamfer"],
)
def test_what_the_kernel_makes_no_sound_solid_of_is_refused_by_name(extra):
    """Of the last it makes one that it calls valid, with a volume that no such gear has."""
    said = rf"\[gear\] end_rounding = {extra['end_rounding']:g} mm: no sound solid .* a smaller one, or 0"
    with pytest.raises(InputError, match=said):
        gear_solid(Gear.from_spec(replace(SPUR, **extra)))


@pytest.mark.parametrize(
    "extra",
    [
        {"helix_angle": math.radians(15.0)},
        {"internal": True, "teeth": 40, "addendum": 0.7, "rim_diameter": 190.0},
        {"left": FlankModification(helix_crowning=0.02)},
    ],
    ids=["helical", "ring", "modified"],
)
def test_other_gears_are_refused_by_name(extra):
    said = r"end_rounding = 0\.4 mm: solid models of rings, of helical and of modified gears"
    with pytest.raises(InputError, match=said):
        gear_solid(Gear.from_spec(replace(SPUR, **extra)))
