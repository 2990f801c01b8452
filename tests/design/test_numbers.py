"""The pair of Kumar, Jain & Pathak (ICPME 2014), m = 6.35, z = 12/24, computed independently to the digits shown."""

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec


def _gear(teeth: int, rack_tip_radius: float) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, 6.35, 15.0, rack_tip_radius=rack_tip_radius))


def _shown(value: float, printed: str) -> None:
    """`value` agrees with a printed number to half a unit of its last digit."""
    digits = len(printed.partition(".")[2])
    assert abs(value - float(printed)) <= 0.5 * 10.0**-digits * (1 + 1e-6), f"{value} is not {printed}"


TOP = [
    ("reference diameter", lambda g: 2 * g.reference_radius, "76.2", "152.4"),
    ("base diameter", lambda g: 2 * g.base_radius, "71.604578", "143.209155"),
    ("tip diameter", lambda g: 2 * g.tip_radius, "88.9", "165.1"),
    ("root diameter", lambda g: 2 * g.root_radius, "60.325", "136.525"),
    ("arc thickness", lambda g: g.tooth_thickness, "9.974557", "9.974557"),
    ("half angle at the reference circle", lambda g: math.degrees(g.half_angle(g.reference_radius)), "7.5", "3.75"),
    ("half angle at the base circle", lambda g: math.degrees(g.base_half_angle), "8.353958", "4.603958"),
    ("half angle at the tip", lambda g: math.degrees(g.half_angle(g.tip_radius)), "2.541061", "1.576847"),
    ("angle at the tip", lambda g: math.degrees(math.acos(g.base_radius / g.tip_radius)), "36.346184", "29.841119"),
    ("roll length at the reference circle", lambda g: g.reference_roll, "13.030967", "26.061935"),
    ("roll length at the tip", lambda g: g.tip_roll, "26.343853", "41.076599"),
    ("roll angle at the tip", lambda g: math.degrees(g.tip_roll / g.base_radius), "42.15908", "32.86823"),
    ("top land", lambda g: float(g.thickness(g.tip_radius)), "3.942704", "4.543745"),
    ("base pitch", lambda g: g.base_pitch, "18.746035", "18.746035"),
    ("pitch", lambda g: g.pitch_angle * g.reference_radius, "19.949113", "19.949113"),
    ("base thickness", lambda g: 2 * g.base_radius * g.base_half_angle, "10.4402", "11.5075"),
]


@pytest.mark.parametrize(("name", "value", "pinion_number", "wheel_number"), TOP, ids=[row[0] for row in TOP])
def test_exact_nominal_values(name, value, pinion_number, wheel_number, pinion, wheel):
    _shown(value(pinion), pinion_number)
    _shown(value(wheel), wheel_number)


def test_pointed_radius_is_where_the_half_angle_ends(pinion, wheel):
    for gear, radius in ((pinion, 47.0049), (wheel, 86.2756)):
        around = gear.half_angle([radius - 5e-5, radius + 5e-5])
        assert around[0] > 0.0 > around[1]


@pytest.mark.parametrize(("rho", "offset"), [(0.25, "0.98669"), (0.30, "0.76437"), (0.38, "0.40866")])
def test_centre_offset_of_the_rack_tip_arc(rho, offset):
    _shown(_gear(12, rho).rack.centre_offset, offset)


@pytest.mark.parametrize(
    ("rho", "x", "radius", "roll", "roll_degrees"),
    [
        (0.25, "16.38556", "35.93260", "3.05745", "4.893"),
        (0.30, "15.68266", "35.91383", "2.82832", "4.526"),
        (0.38, "14.53082", "35.88608", "2.45087", "3.922"),
    ],
)
def test_undercut_junction_of_the_pinion(rho, x, radius, roll, roll_degrees):
    gear = _gear(12, rho)
    assert gear.undercut
    _shown(gear.rack.centre_depth * math.tan(gear.fillet_end), x)
    _shown(gear.form_radius, radius)
    _shown(gear.form_roll, roll)
    _shown(math.degrees(gear.form_roll / gear.base_radius), roll_degrees)


@pytest.mark.parametrize(("rho", "radius"), [(0.25, "71.84792"), (0.30, "71.90072"), (0.38, "71.99591")])
def test_tangent_form_radius_of_the_wheel(rho, radius):
    gear = _gear(24, rho)
    assert not gear.undercut
    _shown(gear.form_radius, radius)
    assert gear.rack.polar(np.array(gear.fillet_end))[0] == pytest.approx(gear.form_radius, rel=1e-14)


def test_space_angle_at_the_junction(pinion):
    _shown(0.5 * pinion.pitch_angle - float(pinion.half_angle(pinion.form_radius)), "0.1162020")


@pytest.mark.parametrize(("rho", "waist", "radius"), [(0.25, "9.59", "33.33"), (0.38, "9.76", "33.60")])
def test_waist_of_the_root(rho, waist, radius):
    """Narrowest chord of the tooth."""
    gear = _gear(12, rho)
    r = np.linspace(gear.root_radius, gear.form_radius, 20001)
    chord = 2 * r * np.sin(gear.half_angle(r))
    _shown(chord.min(), waist)
    _shown(r[chord.argmin()], radius)


@pytest.mark.parametrize(("rho", "least"), [(0.25, 18.56), (0.30, 18.0), (0.38, 17.10)])
def test_least_number_of_teeth_without_undercut(rho, least):
    for teeth in range(12, 25):
        assert _gear(teeth, rho).undercut == (teeth < least)


def test_least_shift_without_undercut():
    """x ≥ 1 − 12 sin² 20° / 2 = 0.2981 where the rack's straight flank is 1 m deep below the reference line."""
    rho = 0.25 / (1.0 - math.sin(math.radians(20.0)))  # makes h_F = 1 m of a dedendum of 1.25
    for shift, undercut in ((0.2981 - 1e-4, True), (0.2981 + 1e-4, False)):
        assert Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0, profile_shift=shift, rack_tip_radius=rho)).undercut is undercut


@pytest.mark.parametrize(
    ("teeth", "rho", "area"), [(12, 0.30, "4408.899"), (12, 0.38, "4420.320296"), (24, 0.38, "18018.224144")]
)
def test_section_area(teeth, rho, area):
    _shown(_gear(teeth, rho).section_area(), area)


@pytest.mark.parametrize(("teeth", "chord", "addendum"), [(12, "9.946096", "6.675951"), (24, "9.967437", "6.513150")])
def test_chordal_thickness_at_the_reference_circle(teeth, chord, addendum):
    gear = _gear(teeth, 0.25)
    half = float(gear.half_angle(gear.reference_radius))
    _shown(2 * gear.reference_radius * math.sin(half), chord)
    _shown(gear.tip_radius - gear.reference_radius * math.cos(half), addendum)


@pytest.mark.parametrize(
    ("teeth", "span_teeth", "span", "contact"), [(12, 2, "29.186274", "38.662"), (24, 3, "48.999531", "75.680")]
)
def test_span_over_teeth_is_a_sum_of_roll_lengths(teeth, span_teeth, span, contact):
    """W_k = (k − 1) p_b + s_b: the common normal of opposite flanks touches the base circle."""
    gear = _gear(teeth, 0.25)
    width = (span_teeth - 1) * gear.base_pitch + 2 * gear.base_radius * gear.base_half_angle
    _shown(width, span)
    _shown(math.hypot(gear.base_radius, width / 2), contact)


class TestPublished:
    """Worked examples of others."""

    def test_profile_shifted_pair(self):
        """bolsover.com, "Profile shifted external spur gears": m = 3, z = 12/24, x = 0.6/0.36, a = 56.5."""
        y_minus_sum = (56.5 - 54.0) / 3.0 - 0.960056
        for teeth, shift, d, db, da, df in (
            (12, 0.6, 36.0, "33.8289", "44.840", "32.100"),
            (24, 0.36, 72.0, "67.6579", "79.400", "66.660"),
        ):
            # the page shortens both addenda by the part of the shift that the centre distance does not take
            gear = Gear.from_spec(GearSpec("gear", teeth, 3.0, 10.0, profile_shift=shift, addendum=1.0 + y_minus_sum))
            assert 2 * gear.reference_radius == pytest.approx(d, rel=1e-15)
            _shown(2 * gear.base_radius, db)
            assert 2 * gear.tip_radius == pytest.approx(
                float(da), abs=1.1e-3
            )  # ha printed to 0.01 is rounded before it is doubled
            _shown(2 * gear.root_radius, df)

    def test_chordal_thickness_of_a_shifted_gear(self):
        """SDP/SI T-81, table 10-1: m = 10, z = 12, x = 0.3."""
        gear = Gear.from_spec(GearSpec("gear", 12, 10.0, 10.0, profile_shift=0.3))
        half = float(gear.half_angle(gear.reference_radius))
        _shown(gear.tooth_thickness, "17.8918")
        _shown(math.degrees(half), "8.54270")
        _shown(2 * gear.reference_radius * math.sin(half), "17.8256")
        _shown(gear.tip_radius - gear.reference_radius * math.cos(half), "13.6657")

    def test_span_of_a_standard_gear(self):
        """machinecalcs.com: m = 2, z = 20, k = 3."""
        gear = Gear.from_spec(GearSpec("gear", 20, 2.0, 10.0))
        _shown(2 * gear.base_pitch + 2 * gear.base_radius * gear.base_half_angle, "15.321")
        _shown(gear.base_pitch, "5.904")
