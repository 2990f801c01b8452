import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.rack import RackTip, bisect
from tests.design.cutting import cut_depth
from tests.design.gears import SPREAD

EACH = pytest.mark.parametrize("gear", SPREAD.values(), ids=SPREAD.keys())


@EACH
def test_the_outline_is_what_a_rolling_rack_leaves(gear):
    """A hair towards the space is cut, a hair towards the tooth is not, from root to tip."""
    height = gear.tip_radius - gear.root_radius
    radius = np.linspace(gear.root_radius + 0.01 * height, gear.tip_radius, 40)
    hair = 1e-6 * gear.transverse_module / radius
    outline = 0.5 * gear.pitch_angle - gear.half_angle(radius)
    assert (cut_depth(gear.spec, radius, outline - hair) > 0.0).all()
    assert (cut_depth(gear.spec, radius, outline + hair) < 0.0).all()


@EACH
def test_the_rack_reaches_the_root_circle_over_the_bottom_land(gear):
    angle = np.linspace(0.0, gear.root_half_angle, 9)
    hair = 1e-6 * gear.transverse_module
    for above, cut in ((hair, True), (-hair, False)):
        depth = cut_depth(gear.spec, np.full(9, gear.root_radius + above), angle)
        assert ((depth > 0.0) == cut).all()


@pytest.mark.parametrize("name", [name for name, gear in SPREAD.items() if gear.rack.centre_depth > 1e-6])
def test_trochoid_in_its_classical_parameter(name):
    """R = r − h_c (1 + ρ/Q), T = X (1 + ρ/Q), Q = √(X² + h_c²), angle atan2(T, R) − (X − x_c)/r."""
    gear = SPREAD[name]
    rack = gear.rack
    phi = np.linspace(0.0, 0.5 * math.pi - gear.transverse_pressure_angle, 201)
    x = rack.centre_depth * np.tan(phi)
    stretch = 1.0 + rack.tip_radius / np.hypot(x, rack.centre_depth)
    inward, along = rack.reference_radius - rack.centre_depth * stretch, x * stretch
    radius, angle = rack.polar(phi)
    np.testing.assert_allclose(radius, np.hypot(inward, along), rtol=1e-14)
    expected = np.arctan2(along, inward) - (x - rack.centre_offset) / rack.reference_radius
    np.testing.assert_allclose(angle, expected, rtol=0, atol=1e-14)


@EACH
def test_trochoid_starts_at_the_end_of_the_bottom_land(gear):
    radius, angle = gear.rack.polar(np.array([0.0]))
    assert radius[0] == pytest.approx(gear.root_radius, rel=1e-15)
    assert angle[0] == pytest.approx(gear.root_half_angle, rel=1e-12, abs=1e-15)


@EACH
def test_normals_of_the_trochoid_pass_through_the_pitch_point(gear):
    """Camus' theorem, with the tangent by central difference."""
    phi = np.linspace(0.01, gear.fillet_end - 1e-3, 50)
    step = 1e-5

    def point(at):
        radius, angle = gear.rack.polar(at)
        return radius * np.exp(1j * angle)

    tangent = point(phi + step) - point(phi - step)
    turn = gear.rack.contact(phi)[2]
    pitch_point = gear.reference_radius * np.exp(-1j * turn)
    to_pitch_point = pitch_point - point(phi)
    cosine = (tangent * to_pitch_point.conj()).real / (np.abs(tangent) * np.abs(to_pitch_point))
    # The central difference is off by step² times a third derivative, a few hundred at the steepest end; and where the arc's
    # centre rolls on the pitch line the pitch point comes as near as ρ.
    np.testing.assert_allclose(cosine, 0.0, rtol=0, atol=3e-7)


@EACH
def test_half_angle_is_continuous_at_the_form_circle(gear):
    """The two formulas meet; on a tangent root also their slopes do."""
    form, step = gear.form_radius, 1e-7 * gear.transverse_module
    below, at, above = gear.half_angle([form - step, form, form + step])
    assert at == pytest.approx(float(gear.half_angle(np.nextafter(form, 0.0))), abs=1e-9)
    if not gear.undercut and gear.form_roll > 0.1 * gear.transverse_module:
        # slope of the involute: −tan α / r; both sides within the second derivative's share of the step
        slope = -gear.form_roll / gear.base_radius / form
        assert (above - at) / step == pytest.approx(slope, rel=1e-4)
        assert (at - below) / step == pytest.approx(slope, rel=1e-4)


@pytest.mark.parametrize("name", [name for name, gear in SPREAD.items() if gear.undercut])
def test_undercut_junction_lies_on_both_curves(name):
    gear = SPREAD[name]
    radius, angle = gear.rack.polar(np.array(gear.fillet_end))
    xi = gear.form_roll / gear.base_radius
    involute = 0.5 * gear.pitch_angle - (gear.base_half_angle - (xi - math.atan(xi)))
    assert radius == gear.form_radius
    assert abs(angle - involute) < 1e-14


def test_undercut_leaves_a_corner():
    """The trochoid still widens the tooth where the involute begins to narrow it."""
    gear = SPREAD["paper_pinion_025"]
    below, at, above = gear.half_angle(gear.form_radius + np.array([-1e-4, 0.0, 1e-4]))
    assert below < at > above


class TestNormalAngle:
    """Newton's method through the pitch point, from the start values that `locate` uses."""

    @EACH
    def test_converges_within_half_a_tip_radius(self, gear):
        rng = np.random.default_rng(1)
        rack = gear.rack
        phi = rng.uniform(0.0, gear.fillet_end, 4000)  # to the very corner of an undercut root
        offset = rng.uniform(-0.5, 0.5, 4000) * rack.tip_radius
        radius, angle, table = self._offset(gear, phi, offset)
        found = rack.normal_angle(radius, angle, np.interp(radius, *table), gear.fillet_end)
        # The start is at the foot of a radius; rounding of the point is ε r against the root's own curvature radius ρ or more.
        rounding = 16 * np.finfo(float).eps * gear.reference_radius / (0.5 * max(rack.tip_radius, rack.centre_depth))
        np.testing.assert_allclose(found, phi, rtol=0, atol=1e-12 + rounding)
        np.testing.assert_allclose(rack.deviation(radius, angle, found), offset, rtol=0, atol=1e-12 * gear.reference_radius)

    def test_sharp_rack_converges_within_a_tenth_of_a_module(self):
        """Tip radius 0: the trochoid of a point, whose own curvature is gentle as long as the point lies well below the pitch line."""
        gear = SPREAD["sharp_rack"]
        rng = np.random.default_rng(2)
        phi = rng.uniform(0.0, gear.fillet_end, 4000)
        offset = rng.uniform(-0.1, 0.1, 4000) * gear.transverse_module
        radius, angle, table = self._offset(gear, phi, offset)
        found = gear.rack.normal_angle(radius, angle, np.interp(radius, *table), gear.fillet_end)
        np.testing.assert_allclose(found, phi, rtol=0, atol=1e-12)

    @staticmethod
    def _offset(gear, phi, offset):
        radius, angle = gear.rack.polar(phi)
        normal = np.exp(-1j * (phi + gear.rack.contact(phi)[2]))
        point = radius * np.exp(1j * angle) + offset * normal
        table = np.linspace(0.0, gear.fillet_end, 65)
        return np.abs(point), np.angle(point), (gear.rack.polar(table)[0], table)


@EACH
def test_fillet_angle_of_a_radius(gear):
    """Within 1e-13 of itself and what rounding of the radius allows: δφ = δr / (dr/dφ)."""
    phi = np.linspace(0.0, gear.fillet_end, 2001)[1:]
    radius = gear.rack.polar(phi)[0]
    found = gear.fillet_phi(radius)
    slope = np.gradient(radius, phi)
    away = radius > gear.root_radius + 1e-9
    error = np.abs(found - phi)
    assert (error <= 1e-13 + 16 * np.finfo(float).eps * radius / slope)[away].all()


@EACH
def test_sector_area_of_the_trochoid(gear):
    """The same integral by parts of the dense curve: half the sum of cross products, error h² of the chord."""
    phi = np.linspace(0.0, gear.fillet_end, 200001)
    radius, angle = gear.rack.polar(phi)
    chords = 0.5 * np.sum(radius[:-1] * radius[1:] * np.sin(np.diff(angle)))
    assert gear.rack.sector_area(gear.fillet_end) == pytest.approx(chords, rel=1e-9)


@EACH
def test_sector_area_has_converged_at_64_nodes(gear, monkeypatch):
    coarse = gear.rack.sector_area(gear.fillet_end)
    leggauss = np.polynomial.legendre.leggauss
    monkeypatch.setattr(np.polynomial.legendre, "leggauss", lambda n: leggauss(2 * n))
    scale = gear.root_radius**2 * gear.pitch_angle  # the sector itself may be thin
    assert abs(gear.rack.sector_area(gear.fillet_end) - coarse) < 1e-13 * scale


def test_reference_number_of_x_at_the_tangent():
    """X ends at h_c / tan α where the arc runs into the straight flank."""
    rack = RackTip(76.2, 1.5875, 6.35, 0.98669)
    end = 0.5 * math.pi - math.radians(20.0)
    assert rack.centre_depth * math.tan(end) == pytest.approx(6.35 / math.tan(math.radians(20.0)), rel=1e-14)


def test_bisect_finds_a_root_to_the_last_bit():
    root = bisect(lambda x: x * x - 2.0, 0.0, 2.0)
    assert abs(root - math.sqrt(2.0)) <= np.spacing(root)
    assert bisect(lambda x: 2.0 - x * x, 0.0, 2.0) == root


def test_root_that_ends_exactly_on_the_base_circle():
    """h_F = r sin² α with a sharp rack: rounding once left the form radius below the base radius."""
    gear = Gear.from_spec(GearSpec("gear", 10, 1.0, 5.0, math.radians(30.0), rack_tip_radius=0.0))
    assert gear.form_radius == pytest.approx(gear.base_radius, rel=1e-15)
    assert 0.0 <= gear.form_roll < 1e-7
