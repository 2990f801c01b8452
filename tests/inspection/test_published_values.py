"""Values that others published, named by where they stand; docs/inspection.md says which of our formulas each holds."""

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.inspection.dimensions import over_pins, span
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.pitch import pitch_deviations
from gearwear.inspection.ranges import helix_range
from gearwear.inspection.tolerances import Edition, Size, round_micrometres, sector_teeth, tolerances

# gfsReboucas/Drivetrain, @NREL_5MW/stage_01.rtf, stage_02.rtf, stage_03.rtf: reports of KISSsoft 03/2017, grade 6 of ISO 1328-1:1995.
# Reference diameter, module, face width in mm, teeth; then µm in the order of KISSSOFT.
KISSSOFT = (
    "single_pitch", "sector_pitch", "profile_form", "profile_slope", "profile_total",
    "helix_form", "helix_slope", "helix_total", "cumulative_pitch", "runout",
)  # fmt: skip
REPORTS = [
    ((855.0, 45.0, 491.0, 19), (33, 49, 33, 27, 42, 21, 21, 30, 81, 65)),
    ((765.0, 45.0, 491.0, 17), (33, 49, 33, 27, 42, 21, 21, 30, 81, 65)),
    ((2520.0, 45.0, 491.0, 56), (38, 78, 40, 32, 51, 24, 24, 34, 132, 105)),
    ((378.0, 21.0, 550.0, 18), (18, 28, 21, 17, 27, 21, 21, 29, 54, 43)),
    ((756.0, 21.0, 550.0, 36), (19, 36, 23, 19, 30, 21, 21, 30, 67, 53)),
    ((1953.0, 21.0, 550.0, 93), (22, 54, 27, 22, 35, 23, 23, 32, 97, 78)),
    ((341.183, 14.0, 360.0, 24), (14, 26, 18, 15, 23, 18, 18, 25, 50, 40)),
    ((1350.517, 14.0, 360.0, 95), (17, 43, 22, 18, 28, 19, 19, 27, 78, 63)),
]

# tkuhn39/semesterthesis, 20_code/10_gearcore/src/gearcore/data/measurement/fixtures, wheel_97340-neu: a wheel of 52 teeth and module 1,
# measured by a Klingelnberg P40. Index of every tooth in µm, and what the machine printed for it.
INDEX = {
    "left": (
        0.662, -0.611, 0.904, 3.406, 5.132, 9.497, 12.249, 9.595, 5.858, 9.518, 16.402, 11.884, 7.905, 9.273, 12.672, 15.374, 13.444,
        5.368, 5.184, 5.142, -1.895, -3.612, -0.855, 2.454, 0.911, -6.625, 0.662, -1.590, -7.735, -4.803, 0.994, 5.520, 2.931, -4.692,
        -8.608, -6.743, -9.890, -15.165, -11.154, -5.623, -2.982, -8.243, -9.063, -10.355, -12.578, -11.181, -10.245, -12.341, -6.378,
        -1.130, -0.130, 0.000,
    ),
    "right": (
        2.254, 1.076, 1.858, 0.744, 2.671, 7.408, 15.166, 15.246, 12.353, 14.587, 8.317, 8.111, 3.785, 7.024, 8.309, 11.646, 13.876,
        8.098, 13.497, 9.928, 4.156, 2.299, 8.640, 8.561, 7.060, -0.604, 4.123, 3.147, 0.421, -3.978, -1.097, 3.753, -1.828, -9.071,
        -8.564, -8.292, -11.152, -15.557, -17.972, -13.130, -7.168, -9.415, -9.854, -5.643, -5.902, -7.396, -6.554, -8.403, -3.379,
        -1.687, 1.153, 0.000,
    ),
}  # fmt: skip
PRINTED = {  # µm: f_p, f_u, F_p, F_pz/8
    "left": (8.1, 14.8, 31.6, 16.7),
    "right": (7.8, 12.4, 33.2, 21.7),
}


@pytest.fixture(scope="module")
def wheel_52() -> Gear:
    return Gear.from_spec(GearSpec("gear", 52, 1.0, 15.0, profile_shift=0.011))


@pytest.mark.parametrize(("size", "printed"), REPORTS)
def test_tolerances_of_1995_as_kisssoft_prints_them(size, printed):
    found = tolerances(Size(*size), 6, Edition.ISO_1995)
    assert [round(1e3 * getattr(found, name), 6) for name in KISSSOFT] == list(printed)


def test_tolerances_of_2013_as_a_test_of_another_program_holds_them():
    """bedizoymak/DAYANERA.ai, test of its rule for module 3, 40 teeth, face 30, class 6."""
    found = tolerances(Size(120.0, 3.0, 30.0, 40), 6)
    assert [round(1e3 * v, 6) for v in (found.single_pitch, found.cumulative_pitch, found.profile_total)] == [9.0, 29.0, 12.0]
    exact = tolerances(Size(120.0, 3.0, 30.0, 40), 6, rounded=False)
    assert [round(1e3 * v, 2) for v in (exact.single_pitch, exact.cumulative_pitch)] == [8.94, 28.80]


@pytest.mark.parametrize(("diameter", "share"), [(51.0, 0.05), (1000.0, 1.0), (15000.0, 15.0)])
def test_profile_slope_of_2013_holds_the_diameter(diameter, share):
    """tkuhn39/semesterthesis, consistency_audit_2026-08-18.md, NRM-09: by so much, µm, a program without the diameter was wrong."""
    found = tolerances(Size(diameter, 1.0, 15.0, 51), 5, rounded=False).profile_slope
    assert 1e3 * found - (0.4 * 1.0 + 4.0) == pytest.approx(share, abs=0.005)


@pytest.mark.parametrize(("value", "rounded"), [(12.49, 12.0), (10.4, 10.0), (7.3, 7.5), (7.2, 7.0), (4.96, 5.0), (4.94, 4.9)])
def test_rounding_as_another_program_rounds(value, rounded):
    """bedizoymak/DAYANERA.ai, test of ISO 1328-1:2013, 5.2.3."""
    assert round_micrometres(value) == rounded


def test_sector_pitches_as_another_program_counts_them():
    """tkuhn39/semesterthesis, gearcore/measurement/gina.py, annex D.2: 7 pitches of 52 teeth, 6 of 51."""
    assert (sector_teeth(52), sector_teeth(51)) == (7, 6)


@pytest.mark.parametrize("side", ["left", "right"])
def test_pitch_as_a_gear_measuring_machine_prints_it(wheel_52, side):
    index = 1e-3 * np.array(INDEX[side])
    delta = np.full((52, 2), np.nan)
    delta[:, 0] = index * math.cos(wheel_52.transverse_pressure_angle)
    found = pitch_deviations(Estimate.plain(delta, np.zeros_like(delta)), wheel_52, 8.0, 7, edition=Edition.ISO_1995)
    values = (found.single_greatest, found.adjacent, found.cumulative, found.sector_greatest)
    np.testing.assert_allclose(
        [1e3 * v.value[0] for v in values], PRINTED[side], atol=0.0511
    )  # a digit, and the table's own rounding


@pytest.mark.parametrize("side", ["left", "right"])
def test_sector_of_2013_is_the_range_within_it(wheel_52, side):
    """Annex D.2: max − min among k + 1 neighbours; never less than the change from the first to the last, or than f_p."""
    index = 1e-3 * np.array(INDEX[side])
    delta = np.full((52, 2), np.nan)
    delta[:, 0] = index * math.cos(wheel_52.transverse_pressure_angle)
    found = pitch_deviations(Estimate.plain(delta, np.zeros_like(delta)), wheel_52, 8.0)
    twice = np.concatenate([index, index])
    expected = max(np.ptp(twice[i : i + 8]) for i in range(52))
    assert found.sector == 7
    assert found.sector_greatest.value[0] == pytest.approx(expected, abs=1e-12)
    assert 1e3 * expected > PRINTED[side][3] + (0.5 if side == "left" else -0.05)  # on the left the two definitions differ


def test_sector_of_a_saw():
    """tkuhn39/semesterthesis, tests/test_measurement_gina.py: F_pk of a saw of period 4 is 3 over 3 and over 4 pitches,
    and from the first to the last of 4 it is 0."""
    gear = Gear.from_spec(GearSpec("gear", 16, 1.0, 15.0))
    saw = np.tile([0.0, 1.0, 2.0, 3.0], 4)
    delta = np.column_stack([saw, -saw]) * math.cos(gear.transverse_pressure_angle)
    exact = Estimate.plain(delta, np.zeros_like(delta))
    for k, last in ((3, 3.0), (4, 0.0)):
        for edition, value in ((Edition.ISO_2013, 3.0), (Edition.ISO_1995, last)):
            found = pitch_deviations(exact, gear, 5.0, k, edition=edition)
            np.testing.assert_allclose(found.sector_greatest.value, value, atol=1e-12)


def test_helix_range_and_span_as_the_machine_took_them(wheel_52):
    """The same measurement: evaluated from 0.75 to 14.25 mm of 15; nominal span over 6 teeth 16.973 mm."""
    where = helix_range(wheel_52)
    assert (where.start, where.end) == (pytest.approx(0.75), pytest.approx(14.25))
    assert span(wheel_52, 6).length == pytest.approx(16.973, abs=0.0005)


def test_span_as_another_program_has_it():
    """hakangunes258/mekanika, Tests/GearFactorTests.cs: 20 teeth of module 1 over 3."""
    gear = Gear.from_spec(GearSpec("gear", 20, 1.0, 10.0))
    assert round(span(gear, 3).length, 4) == 7.6604


def test_over_pins_as_a_handbook_has_it():
    """ashokagears.net/gear-size.html: 32 teeth of one diametral pitch, 20°, pins of 1.728: 34.4130 in."""
    gear = Gear.from_spec(GearSpec("gear", 32, 25.4, 60.0))
    found = over_pins(gear)
    assert found.diameter == pytest.approx(1.728 * 25.4)
    assert round(found.length / 25.4, 4) == 34.4130
