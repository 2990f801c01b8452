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


@pytest.mark.parametrize("seed", range(4))
def test_pitch_by_its_definitions(wheel_52, seed):
    """Pitch as differences of the index, written out; the sector of 1995 from end to end, of 2013 (annex D.2) the range within it."""
    index = 1e-3 * np.random.default_rng(seed).normal(0.0, 5.0, 52)
    delta = np.full((52, 2), np.nan)
    delta[:, 0] = index * math.cos(wheel_52.transverse_pressure_angle)
    exact = Estimate.plain(delta, np.zeros_like(delta))
    twice = np.concatenate([index, index])
    pitch = [twice[i + 1] - twice[i] for i in range(52)]
    adjacent = max(abs(pitch[i] - pitch[i - 1]) for i in range(52))
    ends = max(abs(twice[i + 7] - twice[i]) for i in range(52))
    within = max(np.ptp(twice[i : i + 8]) for i in range(52))
    assert within > ends + 1e-4  # the two definitions differ here
    for edition, sector in ((Edition.ISO_1995, ends), (Edition.ISO_2013, within)):
        found = pitch_deviations(exact, wheel_52, 8.0, 7, edition=edition)
        values = (found.single_greatest, found.adjacent, found.cumulative, found.sector_greatest)
        expected = (max(map(abs, pitch)), adjacent, np.ptp(index), sector)
        np.testing.assert_allclose([v.value[0] for v in values], expected, atol=1e-12)


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
    """tkuhn39/semesterthesis, header of a wheel (52 teeth, module 1) measured on a Klingelnberg P40: evaluated from 0.75 to 14.25 mm of 15; nominal span over 6 teeth 16.973 mm."""
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
