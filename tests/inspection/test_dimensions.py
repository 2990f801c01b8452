"""Span, pins, chords: printed numbers, published cases, and gears really cut thinner."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from gearwear.design.files.toml import parse_design
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.surface import locate
from gearwear.errors import InputError
from gearwear.inspection import Settings, inspect
from gearwear.inspection.dimensions import chordal, constant_chord, measured_over_pins, measured_span, over_pins, span
from gearwear.inspection.estimate import Estimate
from gearwear.report.files.inspection import dimension_lines, lines
from tests.inspection.synthetic import displaced, flanks


def test_the_reference_pair(pinion, wheel):
    two, three = span(pinion), span(wheel)
    assert (two.teeth, round(two.length, 6), round(two.radius, 3)) == (2, 29.186274, 38.662)
    assert (three.teeth, round(three.length, 6), round(three.radius, 3)) == (3, 48.999531, 75.680)
    small, large = over_pins(pinion), over_pins(wheel)
    assert small.diameter == pytest.approx(10.9728)
    assert (round(small.length, 6), round(small.radius, 3)) == (91.171770, 37.946)
    assert (round(large.length, 6), round(large.radius, 3)) == (167.637997, 76.273)
    assert [round(chordal(g).thickness, 6) for g in (pinion, wheel)] == [9.946096, 9.967437]
    assert [round(chordal(g).height, 6) for g in (pinion, wheel)] == [6.675951, 6.513150]
    for gear in (pinion, wheel):
        chord = constant_chord(gear)
        assert (round(chord.thickness, 6), round(chord.height, 6)) == (8.807755, 4.747120)


def test_in_units_of_one_diametral_pitch():
    gear = Gear.from_spec(GearSpec("gear", 12, 25.4, 60.0, rack_tip_radius=0.25))
    assert round(over_pins(gear).length / 25.4, 4) == 14.3578


def test_published_case_r2_chordal_thickness_with_shift():
    """SDP/SI Elements of Metric Gear Technology, table 10-1."""
    gear = Gear.from_spec(GearSpec("gear", 12, 10.0, 50.0, profile_shift=0.3))
    assert round(gear.tooth_thickness, 4) == 17.8918
    assert round(math.degrees(gear.tooth_thickness / (2 * gear.reference_radius)), 5) == 8.54270
    assert round(chordal(gear).thickness, 4) == 17.8256
    assert round(chordal(gear).height, 4) == 13.6657


def test_published_case_r7_span():
    """machinecalcs.com, span measurement over teeth."""
    gear = Gear.from_spec(GearSpec("gear", 20, 2.0, 20.0))
    found = span(gear, 3)
    assert round(found.length, 6) == 15.320879
    assert round(2.0 * found.radius, 4) == 40.5902
    assert round(gear.base_pitch, 6) == 5.904263


def test_published_case_r8_odd_teeth_over_pins():
    """45 teeth, 8 diametral pitch, t = 0.2124 in, pin 0.2160 in; the source prints 5.4380 in error, recomputed 5.963727."""
    inch = 25.4
    m = inch / 8.0
    gear = Gear.from_spec(GearSpec("gear", 45, m, 20.0, thinning=0.5 * math.pi * m - 0.2124 * inch))
    assert gear.tooth_thickness / inch == pytest.approx(0.2124)
    assert round(over_pins(gear, 0.2160 * inch).length / inch, 6) == 5.963727


def test_span_with_shift_and_thinning_in_the_published_form():
    m, z, k, x, thinning = 3.0, 24, 4, 0.4, 0.12
    gear = Gear.from_spec(GearSpec("gear", z, m, 30.0, profile_shift=x, thinning=thinning))
    alpha = math.radians(20.0)
    inv = math.tan(alpha) - alpha
    expected = m * math.cos(alpha) * (math.pi * (k - 0.5) + z * inv) + 2 * x * m * math.sin(alpha) - thinning * math.cos(alpha)
    assert span(gear, k).length == pytest.approx(expected, abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    z=st.integers(9, 150),
    m=st.floats(0.8, 12.0),
    x=st.floats(0.0, 0.5),
    alpha=st.floats(math.radians(18.0), math.radians(25.0)),
)
def test_pins_and_plates_touch_the_involute_where_they_say(z, m, x, alpha):
    """Geometry itself is the oracle: distances from the gauge to the flank's own points."""
    gear = Gear.from_spec(
        GearSpec("gear", z, m, 10.0, alpha, profile_shift=max(x, 0.6 - 0.03 * z), addendum=0.9, rack_tip_radius=0.25)
    )
    pins = over_pins(gear)
    roll = np.linspace(gear.form_roll, gear.tip_roll, 4001)
    radius = np.hypot(gear.base_radius, roll)
    angle = gear.pitch_angle - gear.half_angle(radius)  # right flank of the tooth after space 0
    flank = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    centre = pins.centre_radius * np.array([math.cos(0.5 * gear.pitch_angle), math.sin(0.5 * gear.pitch_angle)])
    distance = np.hypot(*(flank - centre).T)
    near = int(np.argmin(distance))
    step = roll[1] - roll[0]
    assert distance[near] == pytest.approx(0.5 * pins.diameter, abs=step**2)
    assert roll[near] == pytest.approx(pins.roll, abs=2.0 * step)
    gauge = span(gear)
    assert gear.form_roll <= gauge.roll <= gear.tip_roll


@pytest.mark.parametrize(("teeth", "shift", "helix", "k"), [(15, -0.53, 0.0, 2), (7, -0.34, 28.6, 2)])
def test_a_span_is_chosen_wherever_one_can_be_taken(teeth, shift, helix, k):
    """Much negative shift: over the number nearest to the reference circle the plates would touch below the form circle."""
    gear = Gear.from_spec(GearSpec("pinion", teeth, 2.0, 60.0, profile_shift=shift, helix_angle=math.radians(helix)))
    assert span(gear).teeth == k == min(n for n in range(1, teeth) if gear.form_roll <= _touching(gear, n))


def _touching(gear, k):
    """L where the plates of a span over k teeth touch: half of a normal that leans by the base helix angle, in the section."""
    normal = ((k - 1) * gear.base_pitch + 2.0 * gear.base_radius * gear.base_half_angle) * gear.base_helix_cosine
    return 0.5 * normal * gear.base_helix_cosine


def test_odd_teeth_by_the_triangle_of_the_pin_centres():
    gear = Gear.from_spec(GearSpec("gear", 25, 2.0, 20.0))
    pins = over_pins(gear)
    ends = [pins.centre_radius * np.exp(1j * (k + 0.5) * gear.pitch_angle) for k in (0, 12)]
    assert pins.length == pytest.approx(abs(ends[0] - ends[1]) + pins.diameter, abs=1e-12)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda g: span(g, 5), "span over 5 teeth touches .* 1 to 3 teeth can be spanned"),
        (lambda g: over_pins(g, 30.0), "touches at a roll length"),
        (lambda g: over_pins(g, 2.0), "falls through to the root"),
    ],
)
def test_refuses_a_gauge_that_does_not_fit(pinion, call, words):
    with pytest.raises(InputError, match=words):
        call(pinion)


def test_one_worn_flank_in_the_span(pinion):
    """0.1 mm of arc lost on one flank inside the span takes 0.09397 off it, and only off the two spans it is in."""
    delta = np.zeros((12, 2))
    delta[4, 0] = -0.1 * math.cos(pinion.transverse_pressure_angle)  # left flank of tooth 4
    change = measured_span(Estimate.plain(delta, np.zeros_like(delta)), pinion, span(pinion)).value - span(pinion).length
    assert round(change[3], 5) == -0.09397  # over teeth 3 and 4: right flank of 3, left flank of 4
    np.testing.assert_array_equal(np.delete(change, 3), 0.0)


@pytest.mark.parametrize("teeth", [12, 25])
def test_a_thinner_gear_measures_as_one(teeth):
    """Points of a gear cut with thinning, located on the design without: all dimensions are those of the thin gear."""
    spec = {"normal_module": 6.35, "face_width": 15.0, "rack_tip_radius": 0.25}
    design = Gear.from_spec(GearSpec("gear", teeth, **spec))
    thin = Gear.from_spec(GearSpec("gear", teeth, thinning=0.3, **spec))
    points = flanks(thin, 80, 12)
    found = inspect(locate(points.position, design, workers=1), design).dimensions
    np.testing.assert_allclose(found.thickness.value, thin.tooth_thickness, atol=1e-9)
    np.testing.assert_allclose(found.span_lengths.value, span(thin).length, atol=1e-9)
    np.testing.assert_allclose(found.pin_lengths.value, over_pins(thin, found.pins.diameter).length, atol=1e-9)
    np.testing.assert_allclose(found.chord_thickness.value, chordal(thin).thickness, atol=1e-9)
    np.testing.assert_allclose(found.constant_chord_thickness.value, constant_chord(thin).thickness, atol=1e-9)
    assert len(found.pin_lengths.value) == (teeth if teeth % 2 else teeth // 2)


def test_change_over_pins_per_thickness(pinion, wheel):
    """dM/ds = cos α / sin α_M: 2.086 and 2.318 in the reference."""
    for gear, printed in ((pinion, 2.086), (wheel, 2.318)):
        pins = over_pins(gear)
        ds = 1e-4
        delta = np.full((gear.teeth, 2), 0.5 * ds * math.cos(gear.transverse_pressure_angle))
        change = measured_over_pins(Estimate.plain(delta, 0.0 * delta), gear, pins).value - pins.length
        np.testing.assert_allclose(change / ds, printed, atol=1.5e-3)


def test_thickness_of_a_tooth_worn_on_one_side(pinion):
    points = flanks(pinion, 80, 12)
    worn = displaced(points, np.where((points.tooth == 7) & (points.side == -1), -0.25, 0.0), pinion)
    loss = pinion.tooth_thickness - inspect(worn, pinion).dimensions.thickness.value
    expected = np.zeros(12)
    expected[7] = 0.25 / math.cos(pinion.transverse_pressure_angle)
    np.testing.assert_allclose(loss, expected, atol=1e-9)


def drawn(**modification):
    both = FlankModification(**modification)
    return Gear.from_spec(GearSpec("gear", 30, 3.0, 20.0, left=both, right=both))


@pytest.mark.parametrize(
    "modification", [pytest.param({"profile_slope": 0.04}, marks=pytest.mark.long), pytest.param({"profile_crowning": 0.04}, marks=pytest.mark.long), {"tip_relief": 0.03, "tip_relief_length": 9.0}, pytest.param({"helix_crowning": 0.04}, marks=pytest.mark.long)]
)  # fmt: skip
def test_gauges_read_modified_flanks_as_they_are(modification):
    """A gear made as drawn, and gauges laid on its outline by their definitions: a plate is a tangent, a pin touches a circle."""
    gear = drawn(**modification)
    rb, tau = gear.base_radius, gear.pitch_angle
    roll = np.linspace(gear.form_roll, gear.tip_roll, 200001)
    outset = gear.drawn(Side.LEFT).offset(roll, 0.5 * gear.face_width)
    radius, half = np.hypot(rb, roll), gear.base_half_angle - (roll / rb - np.arctan(roll / rb)) + outset / rb
    found = inspect(flanks(gear, 60, 12), gear, Settings(laboratory=False)).dimensions
    arc = 2.0 * gear.reference_radius * np.interp(gear.reference_roll, roll, half)
    assert found.thickness.value == pytest.approx(arc, abs=5e-5)
    assert gear.drawn_tooth_thickness == pytest.approx(arc, abs=1e-9)

    def lean(at):
        """Of a flank from the involute, near L = `at`, rad."""
        return np.abs(np.gradient(outset, roll))[np.abs(roll - at) < 1.0].max() * rb / at

    # Gauges roll on where a flank leans; the square of that is not in the program's: ½ lean² over the curvatures' sum, on each flank.
    rocked = lean(found.span.roll) ** 2 * found.span.roll
    plates = 2.0 * (radius * np.sin(0.5 * (found.span.teeth - 1) * tau + half)).max()
    assert found.span_lengths.value == pytest.approx(plates - rocked, abs=rocked + 5e-5)
    assert found.span.length == pytest.approx(found.span_lengths.value[0], abs=5e-5)

    def room(centre):
        return np.hypot(
            radius * np.cos(half) - centre * np.cos(0.5 * tau), radius * np.sin(half) - centre * np.sin(0.5 * tau)
        ).min()

    centre = brentq(lambda at: room(at) - 0.5 * found.pins.diameter, gear.reference_radius, gear.tip_radius + 5.0, xtol=1e-12)
    over = 2.0 * centre + found.pins.diameter
    pins = found.pins
    rolled = lean(pins.roll) ** 2 / (1.0 / pins.roll + 2.0 / pins.diameter) / math.sin(pins.centre_angle)
    assert found.pin_lengths.value == pytest.approx(over - rolled, abs=rolled + 5e-5)
    assert pins.length == pytest.approx(found.pin_lengths.value[0], abs=5e-5)


def test_plates_touch_crowned_helices_off_mid_face():
    spec = GearSpec("gear", 30, 3.0, 40.0, helix_angle=math.radians(15.0))
    crowned = FlankModification(helix_crowning=0.05)
    plain, gear = Gear.from_spec(spec), Gear.from_spec(replace(spec, left=crowned, right=crowned))
    gauge = span(gear)
    falls = 0.05 * (gauge.rise / 40.0) ** 2
    assert gauge.length == pytest.approx(span(plain).length - 2.0 * falls * gear.base_helix_cosine, abs=1e-9)
    measured = inspect(flanks(gear, 60, 24), gear, Settings(laboratory=False)).dimensions
    assert measured.span_lengths.value == pytest.approx(gauge.length, abs=1e-4)
    assert measured.thickness.value == pytest.approx(plain.tooth_thickness, abs=1e-4)


def test_the_gauge_of_the_drawing_is_measured_and_judged():
    """A gear cut as the design without thinning says: its span lies 0.1 mm off limits that ask for 0.1 to 0.2 mm less, and within those about it."""
    table = {"teeth": 25, "module": 3.0, "face_width": 15.0}
    cut = parse_design({"gear": table}).gears["gear"]
    points = flanks(cut, 80, 12)
    length = span(cut, 4).length
    for low, high, kept in ((-0.2, -0.1, "not kept"), (-0.01, 0.01, "kept")):
        gear = parse_design({"gear": {**table, "span": [length + low, length + high], "span_teeth": 4}}).gears["gear"]
        found = inspect(locate(points.position, gear, workers=1), gear).dimensions
        assert found.span.teeth == 4  # 3 without the drawing's
        assert found.drawn(gear) == (gear.spec.gauge, kept)
    pin = over_pins(cut, 5.3)
    gear = parse_design({"gear": {**table, "over_pins": [pin.length - 0.01, pin.length + 0.01], "pin_diameter": 5.3}}).gears[
        "gear"
    ]
    found = inspect(locate(points.position, gear, workers=1), gear)
    assert found.dimensions.pins.diameter == 5.3
    assert found.dimensions.drawn(gear)[1] == "kept"
    assert inspect(locate(points.position, gear, workers=1), gear, Settings(span_teeth=4)).dimensions.drawn(gear) is not None
    assert f"limits of the pins {pin.length - 0.01:.3f} … {pin.length + 0.01:.3f} mm: kept" in dimension_lines(found)


def test_why_nothing_is_graded_stands_under_the_table():
    gear = Gear.from_spec(GearSpec("gear", 19, 0.28, 1.0))
    found = inspect(flanks(gear, 40, 12), gear)
    said = [text for text, _ in lines(found, "a dental pinion")]
    assert "ISO 1328-1:2013: module 0.28 mm is outside its range, 0.5 to 70 mm: no class" in said
    assert max(map(len, said)) <= 80
