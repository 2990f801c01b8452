"""What the solids guarantee, measured on the shape and on the STEP file read back."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from build123d import GeomType, Solid, import_step
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepCheck import BRepCheck_Analyzer
from scipy.optimize import brentq

from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Gear, GearSpec
from tests.brep.measuring import circles, measure

FLANK, FILLET, VOLUME = 1e-9, 1e-8, 1e-9  # mm, mm, relative: the guarantees

#        teeth, module, degrees, shift, rack tip, dedendum
SPREAD = {
    "paper pinion": (12, 6.35, 20.0, 0.0, 0.30, 1.25),
    "paper gear": (24, 6.35, 20.0, 0.0, 0.30, 1.25),
    "six teeth": (6, 2.0, 20.0, 0.3, 0.20, 1.25),
    "six teeth, large": (6, 50.0, 20.0, 0.3, 0.20, 1.25),
    "just not undercut": (18, 6.35, 20.0, 0.0, 0.30, 1.25),
    "sharp rack": (17, 3.0, 20.0, 0.0, 0.0, 1.25),
    "full-radius rack": (22, 4.0, 20.0, 0.0, 0.47189, 1.25),
    "30 degrees": (8, 1.0, 30.0, 0.1, 0.10, 1.25),
    "14.5 degrees": (32, 10.0, 14.5, 0.0, 0.20, 1.157),
    "fine module": (26, 0.2, 25.0, -0.2, 0.25, 1.25),
    "large shift": (40, 5.0, 22.5, 0.8, 0.20, 1.4),
    "two hundred teeth": (200, 2.0, 14.5, 0.0, 0.30, 1.25),
}
LONG = ("paper gear", "six teeth, large", "just not undercut", "14.5 degrees", "large shift", "two hundred teeth")
"""Of many faces, or of another size: what the others show again."""


@pytest.fixture(
    scope="module",
    params=[pytest.param(name, id=name, marks=[pytest.mark.long] * (name in LONG)) for name in SPREAD],
)
def made(request, tmp_path_factory) -> tuple[Gear, Solid, Solid]:
    """A gear, its solid, and that solid from its STEP file."""
    teeth, module, degrees, shift, tip, dedendum = SPREAD[request.param]
    alpha = math.radians(degrees)
    gear = Gear.from_spec(
        GearSpec("gear", teeth, module, 10.0, alpha, profile_shift=shift, rack_tip_radius=tip, dedendum=dedendum)
    )
    solid = gear_solid(gear)
    path = tmp_path_factory.mktemp("step") / "gear.step"
    write_step(solid, path)
    return gear, solid, import_step(path)


def test_flanks_are_involutes_and_roots_trochoids(made):
    gear, *shapes = made
    for shape in shapes:
        found = measure(shape, gear, along=17, every=(gear.teeth // 6) | 1)  # odd: all four kinds of face
        assert found.flank < FLANK
        assert found.fillet < FILLET


def test_tips_and_bottom_lands_are_arcs_about_the_axis(made):
    gear, *shapes = made
    for shape in shapes:
        found = circles(shape)
        np.testing.assert_allclose(found[:, 1:3], 0.0, atol=1e-12)
        for radius in (gear.tip_radius, gear.root_radius):
            assert (np.abs(found[:, 0] - radius) < 1e-11 * radius).sum() == 2 * gear.teeth
        assert len(found) == 4 * gear.teeth
        assert len(shape.faces().filter_by(GeomType.CYLINDER)) == 2 * gear.teeth


def test_the_thickness_at_the_reference_circle_is_exact(made):
    gear, *shapes = made
    module, z = gear.transverse_module, gear.teeth
    thickness = module * (math.pi / 2 + 2 * gear.spec.profile_shift * math.tan(gear.transverse_pressure_angle))
    for shape in shapes:
        angles = reference_crossings(shape, 0.5 * module * z, math.pi / z)
        np.testing.assert_allclose(
            0.5 * module * z * (angles[-1] - angles[0]), thickness, rtol=0, atol=1e-11 * max(1.0, z * module)
        )


def reference_crossings(shape: Solid, radius: float, reach: float) -> list[float]:
    """Angles at which edges of the tooth on +x cross a radius, rising; each crossing found to rounding."""
    found = []
    for edge in shape.edges().filter_by(GeomType.BSPLINE):
        curve = BRepAdaptor_Curve(edge.wrapped)
        start, end = curve.FirstParameter(), curve.LastParameter()
        middle = curve.Value(0.5 * (start + end))
        if middle.Z() > 0.0 or abs(math.atan2(middle.Y(), middle.X())) > reach:
            continue

        def excess(t: float, curve: BRepAdaptor_Curve = curve) -> float:
            point = curve.Value(t)
            return math.hypot(point.X(), point.Y()) - radius

        if excess(start) * excess(end) < 0.0:
            point = curve.Value(brentq(excess, start, end, xtol=1e-15, rtol=1e-15))
            found.append(math.atan2(point.Y(), point.X()))
    return sorted(found)


def test_one_valid_solid_with_the_exact_volume(made):
    gear, *shapes = made
    for shape in shapes:
        assert len(shape.solids()) == 1
        assert BRepCheck_Analyzer(shape.wrapped).IsValid()
        assert len(shape.faces()) == 6 * gear.teeth + 2
        assert shape.volume == pytest.approx(gear.section_area() * gear.face_width, rel=VOLUME)


def test_the_area_of_the_reference():
    # peers.md, computed there independently: z = 12 and 24, rack tip radius 0.38 m.
    for teeth, area in ((12, 4420.320296), (24, 18018.224144)):
        gear = Gear.from_spec(GearSpec("gear", teeth, 6.35, 15.0, rack_tip_radius=0.38))
        assert gear_solid(gear).volume / 15.0 == pytest.approx(area, abs=1e-6)


def test_a_rack_that_leaves_no_bottom_land(tmp_path):
    alpha = math.radians(20.0)
    full = (math.pi / 4 - 1.25 * math.tan(alpha)) * math.cos(alpha) / (1.0 - math.sin(alpha))
    for share in (1.0 - 1e-15, 1.0 - 1e-7):  # none at all, and one too short to be an edge
        gear = Gear.from_spec(GearSpec("gear", 14, 5.0, 10.0, rack_tip_radius=share * full))
        solid = gear_solid(gear)
        write_step(solid, tmp_path / "gear.step")
        for shape in (solid, import_step(tmp_path / "gear.step")):
            assert shape.is_valid
            assert measure(shape, gear).fillet < FILLET
            assert shape.volume == pytest.approx(gear.section_area() * 10.0, rel=VOLUME)


def test_bore_and_tip_chamfer(pinion):
    gear = Gear.from_spec(replace(pinion.spec, bore_diameter=30.0, tip_chamfer=0.8))
    solid = gear_solid(gear)
    assert solid.volume == pytest.approx(gear.section_area() * 15.0, rel=VOLUME)
    assert (circles(solid)[:, 0] == 15.0).sum() == 2
    assert len(solid.faces()) == 8 * 12 + 3
    assert measure(solid, gear).flank < FLANK


def test_the_label_is_the_part_s_name(pinion):
    assert gear_solid(pinion).label == "pinion"
