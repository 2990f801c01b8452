"""Span and balls on helical teeth: printed numbers, geometry in space, and gears that are really thinner or steeper."""

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points, locate
from gearwear.errors import InputError
from gearwear.inspection import inspect
from gearwear.inspection.dimensions import over_pins, pins_touching, span
from tests.inspection.synthetic import flanks

INCH = 25.4


def helical(teeth=23, module=2.5, width=30.0, degrees=25.0, **extra) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, module, width, helix_angle=math.radians(degrees), **extra))


def test_published_span_in_the_normal_system():
    """KHK, Calculation of gear dimensions: m_n 3, 20°, z 24, β 25°, x_n 0.4, k 5: α_t 21.88023°, W 42.0085."""
    gear = helical(24, 3.0, 40.0, 25.0, profile_shift=0.4)
    assert round(math.degrees(gear.transverse_pressure_angle), 5) == 21.88023
    assert round(span(gear).length, 4) == 42.0085
    assert span(gear).teeth == 5


def test_published_span_in_the_transverse_system():
    """KHK: m_t 3, α_t 20°, z 24, β 22.5°, x_t 0.4, k 4: α_n 18.58597°, W 30.5910."""
    beta = math.radians(22.5)
    alpha = math.atan(math.tan(math.radians(20.0)) * math.cos(beta))
    assert round(math.degrees(alpha), 5) == 18.58597
    spec = GearSpec("gear", 24, 3.0 * math.cos(beta), 30.0, alpha, profile_shift=0.4 / math.cos(beta), helix_angle=beta)
    assert round(span(Gear.from_spec(spec), 4).length, 4) == 30.5910


@pytest.mark.parametrize(("degrees", "printed"), [(10.5, 10.967750), (5.0, 10.827894)])
def test_published_case_r8_cylinders_over_an_odd_helical_gear(degrees, printed):
    """127 teeth, 12 normal diametral pitch, t_n = 0.130900 in, pin 0.144 in; AGMA reference prints 10.967749, ZakGear 10.827894."""
    module = INCH / 12.0
    gear = helical(127, module, 30.0, degrees, thinning=0.5 * math.pi * module - 0.1309 * INCH)
    pins = over_pins(gear, 0.144 * INCH)
    assert pins.over_cylinders / INCH == pytest.approx(printed, abs=6e-7)
    assert pins.length < pins.over_cylinders  # balls at one height lie in spaces that are not quite opposite


@pytest.mark.parametrize("degrees", [25.0, -25.0, 8.0])
def test_the_plates_are_a_span_apart_along_one_normal(degrees):
    gear = helical(degrees=degrees, profile_shift=0.2)
    gauge = span(gear)
    z = 0.5 * gear.face_width + 0.5 * np.array([gauge.rise, -gauge.rise])
    at = flank_points(gear, np.array([0, gauge.teeth - 1]), np.array([-1, 1]), np.full(2, gauge.roll), z)
    way = at.position[1] - at.position[0]
    assert np.linalg.norm(way) == pytest.approx(gauge.length, abs=1e-12)
    np.testing.assert_allclose(way / gauge.length, at.normal[1], atol=1e-12)
    np.testing.assert_allclose(at.normal[0], -at.normal[1], atol=1e-12)


@pytest.mark.parametrize("degrees", [25.0, -35.0])
def test_the_ball_touches_in_space(degrees):
    gear = helical(degrees=degrees, profile_shift=0.2)
    pins = over_pins(gear)
    assert pins.diameter == pytest.approx(1.728 * 2.5)
    # The centre of the space after tooth 0, at mid-face; the right flank of tooth 1, in steps of 3 µm along L and z about where it touches.
    middle = 0.5 * gear.pitch_angle
    centre = np.array([pins.centre_radius * math.cos(middle), pins.centre_radius * math.sin(middle), 0.5 * gear.face_width])
    z = 0.5 * gear.face_width + np.linspace(-2.0, 2.0, 801)
    roll, height = (a.ravel() for a in np.meshgrid(pins.roll + np.linspace(-0.4, 0.4, 81), z, indexing="ij"))
    surface = flank_points(gear, np.ones(len(roll), int), -np.ones(len(roll), int), roll, height).position
    distance = np.linalg.norm(surface - centre, axis=1)
    nearest = int(distance.argmin())
    assert distance[nearest] == pytest.approx(0.5 * pins.diameter, abs=1e-5)  # (5 µm)² / (2 · 2 mm) and rounding of the grid
    assert roll[nearest] == pytest.approx(pins.roll, abs=0.02)


@pytest.mark.parametrize("roll", [6.0, 9.0])
def test_a_ball_made_to_touch_somewhere_does(roll):
    gear = helical()
    pins = pins_touching(gear, gear.form_roll + roll / 9.0 * 0.8 * (gear.tip_roll - gear.form_roll))
    assert pins is not None
    again = over_pins(gear, pins.diameter)
    assert again.roll == pytest.approx(gear.form_roll + roll / 9.0 * 0.8 * (gear.tip_roll - gear.form_roll), abs=1e-9)


def test_a_narrow_face_cannot_be_spanned():
    # Over 3 teeth W = 19.5 mm, sin β_b = 0.397: 7.7 mm and 3 mm to hold.
    with pytest.raises(InputError, match=r"span over 3 teeth cannot be measured: .* face width of 1\d\.\d\d mm, there are 10 mm"):
        span(helical(width=10.0), 3)
    # Where none is asked for, fewer teeth are spanned, if their flanks reach down there.
    assert (span(helical(width=30.0)).teeth, span(helical(width=12.0)).teeth) == (4, 3)


@pytest.mark.parametrize("width", [30.0, 14.0])
def test_a_thinner_gear_measures_as_one(width):
    """On a face of 14 mm the plates over four teeth stand 1.7 mm from its ends, outside the range that helices are evaluated over."""
    design, thin = helical(width=width), helical(width=width, thinning=0.2)
    points = flanks(thin, 60, 12)
    found = inspect(locate(points.position, design, workers=1), design).dimensions
    np.testing.assert_allclose(found.thickness.value, thin.tooth_thickness, atol=1e-9)
    np.testing.assert_allclose(found.span_lengths.value, span(thin, found.span.teeth).length, atol=1e-9)
    np.testing.assert_allclose(found.pin_lengths.value, over_pins(thin, found.pins.diameter).length, atol=1e-9)


def test_a_steeper_helix_makes_the_span_shorter():
    """The same section on a steeper screw: W cos β_b' / cos β_b, seen only where the plates stand, on either side of mid-face."""
    design = helical()
    steeper = 1.004
    points = flanks(design, 60, 40)
    position = points.position.copy()
    position[:, 2] = 15.0 + (position[:, 2] - 15.0) / steeper
    found = inspect(locate(position, design, workers=1), design).dimensions
    tangent = math.tan(design.base_helix_angle)
    there = span(design).length * math.cos(math.atan(steeper * tangent)) / math.cos(math.atan(tangent))
    assert span(design).length - there > 0.01
    # To first order in the change: W (Δβ_b)² / 2 = 3e-5 mm. Points lie at random in their cells of 0.75 mm, on a slope of 2 µm/mm.
    assert found.span_lengths.value.mean() == pytest.approx(there, abs=1e-4)
    np.testing.assert_allclose(found.span_lengths.value, there, atol=1e-3)


def test_a_spur_gear_has_no_rise(pinion):
    assert span(pinion).rise == 0.0
    assert over_pins(pinion).over_cylinders == pytest.approx(over_pins(pinion).length)
