"""The root of a hob with protuberance and the flank ground afterwards."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from gearwear.brep.outline import tooth_edges
from gearwear.brep.solid import gear_solid
from gearwear.design import Gear, GearSpec
from gearwear.design.files.toml import parse_design, parse_toml
from gearwear.design.files.writing import design_text
from gearwear.design.surface import FILLET, locate
from gearwear.errors import InputError
from tests.brep.measuring import measure
from tests.design.cutting import cut_depth, cut_depth_in_space


def _spec(teeth: int = 25, **values: float) -> GearSpec:
    usual = {"dedendum": 1.4, "rack_tip_radius": 0.3, "protuberance": 0.15, "grinding_stock": 0.1}
    return GearSpec("gear", teeth, 3.0, 20.0, **{**usual, **values})


SPREAD = {
    "usual": _spec(),
    "shifted": _spec(profile_shift=0.3, protuberance=0.3),
    "few teeth": _spec(14, protuberance=0.2, grinding_stock=0.05),
    "undercut": _spec(9, protuberance=0.2),
    "many teeth": _spec(120, protuberance=0.12),
    "not ground": _spec(40, protuberance=0.06, grinding_stock=0.0),
    "thinned": _spec(30, thinning=0.1),
}
EACH = pytest.mark.parametrize("spec", SPREAD.values(), ids=SPREAD.keys())


@EACH
def test_the_outline_is_what_hob_and_grinding_leave(spec):
    gear = Gear.from_spec(spec)
    height = gear.tip_radius - gear.root_radius
    radius = np.union1d(
        np.linspace(gear.root_radius + 0.01 * height, gear.tip_radius, 40), gear.form_radius + np.array([-1e-3, 1e-3])
    )
    hair = 1e-6 * gear.transverse_module / radius
    outline = 0.5 * gear.pitch_angle - gear.half_angle(radius)
    assert (cut_depth(spec, radius, outline - hair) > 0.0).all()
    assert (cut_depth(spec, radius, outline + hair) < 0.0).all()


@pytest.mark.parametrize("degrees", [-25.0, 15.0])
def test_helical_roots_are_what_the_rack_leaves_in_space(degrees):
    spec = _spec(24, helix_angle=math.radians(degrees))
    gear = Gear.from_spec(spec)
    radius = np.linspace(gear.root_radius + 0.03, gear.form_radius + 0.5, 24)
    z = np.linspace(6.0, 14.0, 24)
    outline = 0.5 * gear.pitch_angle - gear.half_angle(radius)
    for shift, cut in ((-1.0, True), (1.0, False)):
        angle = gear.pitch_angle * 0.5 + outline + shift * 2e-6 / radius + gear.twist * (z - 10.0)
        points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])
        assert ((cut_depth_in_space(spec, points) > 0.0) == cut).all()


@EACH
def test_the_notch_is_as_deep_as_the_protuberance_beyond_the_stock(spec):
    """Where the tip's tangent is parallel to the flank its trochoid is tangent to the parallel of the flank at p_r − q."""
    gear = Gear.from_spec(spec)
    at = np.array([0.5 * math.pi - spec.normal_pressure_angle])
    radius, angle = gear.rack.polar(at)
    if gear.rack.centre_depth > 0.0 and gear.reference_roll > gear.rack.centre_depth / math.sin(gear.transverse_pressure_angle):
        xi = math.sqrt(radius[0] ** 2 - gear.base_radius**2) / gear.base_radius
        flank = gear.base_half_angle - (xi - math.atan(xi))
        gap = gear.base_radius * (flank - (0.5 * gear.pitch_angle - angle[0]))
        assert gap == pytest.approx(spec.protuberance - spec.grinding_stock, abs=1e-12)


def test_the_centre_of_the_tip_arc_is_that_of_iso_6336_3():
    """ISO 6336-3, auxiliary value E = π m/4 − h tan α + s_pr/cos α − (1 − sin α) ρ/cos α."""
    spec = _spec()
    m, alpha, h, rho = 3.0, math.radians(20.0), 1.4 * 3.0, 0.9
    auxiliary = (
        0.25 * math.pi * m - h * math.tan(alpha) + 0.05 / math.cos(alpha) - (1.0 - math.sin(alpha)) * rho / math.cos(alpha)
    )
    assert Gear.from_spec(spec).rack.centre_offset == pytest.approx(auxiliary, rel=1e-14)


@EACH
def test_without_a_notch_it_is_the_plain_root(spec):
    """As the protuberance falls to the stock, the form circle goes over into that of the plain rack."""
    plain = Gear.from_spec(replace(spec, protuberance=0.0, grinding_stock=0.0))
    near = Gear.from_spec(replace(spec, protuberance=1e-9, grinding_stock=0.0))
    assert near.form_radius == pytest.approx(plain.form_radius, abs=2e-3)
    assert near.section_area() == pytest.approx(plain.section_area(), rel=1e-8)


def test_area_by_the_outline_itself():
    gear = Gear.from_spec(_spec())
    radius = np.concatenate([
        np.linspace(gear.root_radius, gear.form_radius, 200_001), np.linspace(gear.form_radius, gear.tip_radius, 100_001)[1:],
    ])  # fmt: skip
    # ∫ 2 ψ r dr, plus the disc within the root circle
    psi = gear.half_angle(radius)
    psi[0] = 0.5 * gear.pitch_angle - gear.root_half_angle
    area = gear.teeth * np.trapezoid(2.0 * psi * radius, radius) + math.pi * gear.root_radius**2
    assert gear.section_area() == pytest.approx(area, rel=1e-7)


@EACH
def test_points_moved_along_normals_come_back(spec):
    gear = Gear.from_spec(spec)
    phi = np.linspace(0.05, gear.fillet_end - 1e-3, 40)
    radius, angle = gear.rack.polar(phi)
    step = 1e-6
    ahead, behind = gear.rack.polar(phi + step), gear.rack.polar(phi - step)
    tangent = ahead[0] * np.exp(1j * ahead[1]) - behind[0] * np.exp(1j * behind[1])
    normal = -1j * tangent / np.abs(tangent)  # upwards the space lies to the right of the curve
    point = radius * np.exp(1j * angle)
    for moved in (-0.01, 0.01):
        at = (point + moved * normal) * np.exp(-1j * (0.5 * gear.pitch_angle))
        points = np.column_stack([at.real, at.imag, np.full(len(at), 10.0)])
        inside = np.abs(at) < gear.form_radius
        found = locate(points[inside], gear)
        assert (found.surface == FILLET).all()
        np.testing.assert_allclose(found.deviation, moved, atol=2e-8)


@pytest.mark.parametrize("name", ["usual", "few teeth", pytest.param("many teeth", marks=pytest.mark.long)])
def test_the_solid_is_the_design(name, tmp_path):
    gear = Gear.from_spec(SPREAD[name])
    solid = gear_solid(gear)
    size = measure(solid, gear, along=21, every=max(1, gear.teeth // 4))
    assert size.flank < 1e-9 and size.fillet < 1e-8
    assert solid.volume == pytest.approx(gear.volume, rel=1e-9)


@pytest.mark.long
def test_end_chamfers_go_with_it():
    gear = Gear.from_spec(_spec(end_chamfer=0.3))
    assert gear_solid(gear).is_valid
    assert len(tooth_edges(gear)) == 6


def test_it_reads_back_what_it_wrote():
    spec = _spec(protuberance_angle=math.radians(10.0))
    text = design_text(spec)
    assert "protuberance = 0.15" in text and "grinding_stock = 0.1 " in text and "protuberance_angle = 10 " in text
    assert parse_design(parse_toml(text.encode())).gears["gear"].spec == spec


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"protuberance": 2.0}, "protuberance = 2 mm: must lie from 0 to 1.5"),
        ({"grinding_stock": 0.15}, "grinding_stock = 0.15 mm: must be below the protuberance, 0.15 mm"),
        ({"protuberance": 0.0, "grinding_stock": 0.0, "protuberance_angle": 0.1}, "protuberance_angle without protuberance"),
        ({"protuberance_angle": math.radians(19.0)}, "protuberance_angle = 19 degrees: the round tip must reach the flank, which it does below 17.4"),
        ({"profile_shift": 1.2, "addendum": 0.5, "teeth": 60}, "the centre of the rack's tip arc lies outside the pitch line"),
        ({"internal": True, "dedendum": 1.25}, "protuberance = 0.15 mm: no rack cuts a ring"),
    ],
)  # fmt: skip
def test_impossible_tools_are_refused_by_name_and_number(values, message):
    with pytest.raises(InputError, match=re.escape(message)):
        Gear.from_spec(_spec(**values))
