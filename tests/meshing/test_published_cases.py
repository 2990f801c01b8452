"""Every worked example of others that an external spur pair can be held against, to its printed digits.

Helical examples are fed in their transverse section, where a helical pair is an exact spur pair.
"""

import math

import pytest

from gearwear.design import Gear, GearSpec
from gearwear.inspection.dimensions import chordal, over_pins, span
from gearwear.meshing.backlash import (
    operating_pitch_radii,
    working_pressure_angle,
    zero_backlash_centre_distance,
)
from gearwear.meshing.path import path_of_contact
from tests.meshing.shift_sum import profile_shift_sum

TWENTY = math.radians(20.0)


def inv(angle):
    return math.tan(angle) - angle


def shown(value, printed, last=0.5):
    """`value` agrees with a printed number to half a unit of its last digit (or `last` units)."""
    digits = len(printed.partition(".")[2])
    assert abs(value - float(printed)) <= last * 10.0**-digits * (1 + 1e-6), f"{value} is not {printed}"


def pair(teeth, module, shifts, addenda=(1.0, 1.0), angle=TWENTY):
    return [
        Gear.from_spec(GearSpec(name, z, module, 20.0, angle, profile_shift=x, addendum=ha))
        for name, z, x, ha in zip(("pinion", "gear"), teeth, shifts, addenda, strict=True)
    ]


class TestR1:
    """bolsover.com, profile-shifted external spur gears: m = 3, z = 12/24, a = 56.5, x = 0.6/0.36."""

    addenda = tuple(4.42 / 3.0 - 0.6 if x == 0.6 else 3.70 / 3.0 - 0.36 for x in (0.6, 0.36))
    pinion, gear = pair((12, 24), 3.0, (0.6, 0.36), addenda)

    def test_standard_and_working_distance(self):
        standard = self.pinion.reference_radius + self.gear.reference_radius
        shown(standard, "54.000")
        shown(inv(self.pinion.transverse_pressure_angle), "0.014904")
        working = working_pressure_angle(self.pinion, self.gear, 56.5)
        shown(inv(working), "0.034317")
        shown(math.degrees(working), "26.0888")
        shown((56.5 - standard) / 3.0, "0.83333")
        shown(profile_shift_sum(self.pinion, self.gear, 56.5), "0.960")
        for radius, printed in zip(operating_pitch_radii(self.pinion, self.gear, 56.5), ("37.667", "75.333"), strict=True):
            shown(2 * radius, printed)

    def test_from_the_sum_of_shifts(self):
        """The other way: x = 0.96 given, the distance follows."""
        at = zero_backlash_centre_distance(self.pinion, self.gear)
        shown(at, "56.499870")
        working = working_pressure_angle(self.pinion, self.gear, at)
        shown(math.degrees(working), "26.088563")
        shown(inv(working), "0.03431613")
        shown(at / 3.0 - 18.0, "0.833290")

    def test_diameters_and_tooth_heights(self):
        for gear, (d, base, tip, root, above, below) in zip(
            (self.pinion, self.gear),
            [
                ("36.000", "33.8289", "44.840", "32.100", "4.420", "1.950"),
                ("72.000", "67.6579", "79.400", "66.660", "3.700", "2.670"),
            ],
            strict=True,
        ):
            shown(2 * gear.reference_radius, d)
            shown(2 * gear.base_radius, base, last=0.6)  # 67.65787: the page doubles the rounded 33.82893
            shown(2 * gear.tip_radius, tip)
            shown(2 * gear.root_radius, root)
            shown(gear.tip_radius - gear.reference_radius, above)
            shown(gear.reference_radius - gear.root_radius, below)
            shown(gear.tip_radius - gear.root_radius, "6.370")

    def test_contact_ratio(self):
        shown(path_of_contact(self.pinion, self.gear, 56.5).contact_ratio, "1.202")


class TestR2:
    """SDP/SI, Elements of Metric Gear Technology, tables 10-1 to 10-4: chordal thickness."""

    def test_spur(self):
        gear = Gear.from_spec(GearSpec("gear", 12, 10.0, 50.0, profile_shift=0.3))
        shown(gear.tip_radius - gear.reference_radius, "13.000")
        shown(gear.tooth_thickness, "17.8918")
        shown(math.degrees(gear.tooth_thickness / (2 * gear.reference_radius)), "8.54270")
        shown(chordal(gear).thickness, "17.8256")
        shown(chordal(gear).height, "13.6657")

    def test_rack(self):
        """The limit of many teeth."""
        gear = Gear.from_spec(GearSpec("gear", 10_000, 3.0, 50.0))
        shown(chordal(gear).thickness, "4.7124")
        shown(chordal(gear).height, "3.0000", last=2.0)  # an arc of 15 m radius still rises by 0.2 µm

    @pytest.mark.parametrize(
        ("normal", "module", "degrees", "teeth", "shift", "addendum", "thickness", "virtual", "half", "chord", "height"),
        [
            (True, 5.0, 25.0, 16, 0.2, 6.0, "8.5819", "21.4928", "4.57556", "8.5728", "6.1712"),
            (False, 4.0, 22.5, 20, 0.3, 4.7184, "6.6119", "25.3620", "4.04196", None, None),
        ],
        ids=["R2c normal system", "R2d transverse system"],
    )
    def test_helical_in_its_transverse_section(
        self, normal, module, degrees, teeth, shift, addendum, thickness, virtual, half, chord, height
    ):
        beta = math.radians(degrees)
        cos = math.cos(beta)
        transverse = math.atan(math.tan(TWENTY) / cos) if normal else TWENTY
        m_t, x_t = (module / cos, shift * cos) if normal else (module, shift)
        gear = Gear.from_spec(
            GearSpec("gear", teeth, m_t, 30.0, transverse, profile_shift=x_t, addendum=0.5, rack_tip_radius=0.1)
        )
        across = gear.tooth_thickness * cos
        shown(across, thickness)
        shown(teeth / cos**3, virtual)
        radius = gear.reference_radius / cos**2  # of the virtual spur gear
        shown(math.degrees(across / (2 * radius)), half)
        if chord:
            shown(2 * radius * math.sin(across / (2 * radius)), chord)
            shown(addendum + radius * (1 - math.cos(across / (2 * radius))), height)


@pytest.mark.parametrize(
    ("teeth", "module", "shifts", "y", "degrees", "involute", "radians", "distance"),
    [
        pytest.param((30, 78), 16.0, (0.0, 0.05), "0.04982703", "20.1446", "0.01524139", "0.35158992", "864.7972", id="R3"),
        pytest.param((22, 118), 8.0, (0.0, 0.5), "0.48748796", "21.0617", "0.01750417", "0.36759661", "563.8999", id="R4"),
    ],
)
def test_centre_distance_of_shifted_gears(teeth, module, shifts, y, degrees, involute, radians, distance):
    """scribd.com/doc/92821234 and /210760271."""
    gears = pair(teeth, module, shifts)
    at = zero_backlash_centre_distance(*gears)
    working = working_pressure_angle(*gears, at)
    shown(inv(gears[0].transverse_pressure_angle), "0.01490438")
    shown(at, distance)
    shown(at / module - sum(teeth) / 2, y)
    shown(math.degrees(working), degrees)
    shown(inv(working), involute)
    shown(working, radians)


def test_r6_helical_pair_by_iso_21771():
    """scribd.com/document/376176518: z = 31/30, m_n = 3.5, β = 21°, a = 116.5."""
    beta = math.radians(21.0)
    angle = math.atan(math.tan(TWENTY) / math.cos(beta))
    gears = pair((31, 30), 3.5 / math.cos(beta), (0.0, 0.0), angle=angle)
    shown(math.degrees(angle), "21.2990642859")
    shown(gears[0].reference_radius + gears[1].reference_radius, "114.3447280708")
    working = working_pressure_angle(*gears, 116.5)
    shown(math.degrees(working), "23.8707609654", last=1.0)
    shown(inv(working), "0.0259052382")
    shown(inv(angle), "0.0181260949")
    shown(profile_shift_sum(*gears, 116.5) / math.cos(beta), "0.6518771312")  # in normal modules


def test_r7_span():
    """machinecalcs.com: m = 2, z = 20, k = 3."""
    gear = Gear.from_spec(GearSpec("gear", 20, 2.0, 20.0))
    gauge = span(gear, 3)
    shown(gauge.length, "15.321")
    shown(gear.base_pitch, "5.904")
    shown(2 * gauge.radius, "40.59")
    for radius, printed in ((gear.reference_radius, "40.00"), (gear.base_radius, "37.59"), (gear.tip_radius, "44.00")):
        shown(2 * radius, printed)


def test_r7_span_with_shift():
    """The formula recomputed in the list of cases: m = 3, z = 24, x = 0.4, k = 4."""
    shown(span(Gear.from_spec(GearSpec("gear", 24, 3.0, 20.0, profile_shift=0.4)), 4).length, "32.826627")


def test_r8_over_pins_of_an_odd_gear():
    """45 teeth, diametral pitch 8, t = 0.2124 in, pin 0.2160 in: 5.963727 in; the 5.4380 of the source is wrong."""
    m = 25.4 / 8.0
    gear = Gear.from_spec(GearSpec("gear", 45, m, 20.0, thinning=0.5 * math.pi * m - 0.2124 * 25.4))
    shown(over_pins(gear, 0.2160 * 25.4).length / 25.4, "5.963727")
