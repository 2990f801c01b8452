"""Grades of F_i″ and f_i″ by ISO 1328-2:1997: against another program, and against F_r, which lies between the two."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.inspection import Settings, inspect
from gearwear.inspection.grading import Verdict
from gearwear.inspection.radial import GRADES, TOOTH_TO_TOOTH, TOTAL, radial_tolerance
from gearwear.inspection.tolerances import Edition, Size, tolerances
from tests.inspection.synthetic import flanks

# What a public port of MITCalc's sheet gives (StandardTables.calcISO1328Tolerances; not in this repository): d, m_n, grade, F_i″, f_i″.
PORT = (
    (76.2, 6.35, 5, 40.0, 24.0),
    (76.2, 6.35, 8, 114.0, 67.0),
    (50.0, 2.5, 7, 37.0, 13.0),
    (300.0, 4.0, 6, 52.0, 15.0),
    (12.0, 0.5, 9, 42.0, 7.0),
    (999.0, 10.0, 12, 665.0, 272.0),
    (5.5, 0.25, 4, 7.5, 1.2),
)


@pytest.mark.parametrize(("d", "m", "grade", "total", "tooth"), PORT)
def test_tolerances_are_those_of_another_program(d, m, grade, total, tooth):
    size = Size(d, m, 20.0, round(d / m))
    given = [1e3 * radial_tolerance(quantity, size, grade) for quantity in (TOTAL, TOOTH_TO_TOOTH)]
    assert given == pytest.approx([total, tooth])


@pytest.mark.parametrize(("d", "m"), [(80.0, 8.0), (240.0, 6.5), (900.0, 10.0)])
@pytest.mark.parametrize("grade", [4, 9, 12])
def test_their_difference_is_the_runout_of_the_same_years(d, m, grade):
    """``F_i″ − f_i″ = 0.8 F_p``, which is held to printed values: where both parts have the same range of the module."""
    size = Size(d, m, 20.0, round(d / m))
    total, tooth = (radial_tolerance(quantity, size, grade, rounded=False) for quantity in (TOTAL, TOOTH_TO_TOOTH))
    assert total - tooth == pytest.approx(tolerances(size, grade, Edition.ISO_1995, rounded=False).runout, rel=1e-12)


def test_a_gear_beyond_the_ranges_has_no_tolerance():
    for size in (Size(1001.0, 5.0, 20.0, 200), Size(120.0, 10.5, 20.0, 12), Size(4.9, 0.5, 5.0, 10), Size(10.0, 0.19, 5.0, 52)):
        with pytest.raises(InputError, match=r"ISO 1328-2:1997: .* is outside its range"):
            radial_tolerance(TOTAL, size, 8)


def inspected(gear: Gear, eccentricity: float, **settings):
    """An eccentric gear without any noise, about its bore."""
    points = flanks(gear, 60, 12)
    towards = np.array([math.cos(0.7), math.sin(0.7), 0.0])
    return inspect(
        points.with_deviation(eccentricity * points.normal @ towards), gear, Settings(noise=1e-5, laboratory=True, **settings)
    )


@pytest.mark.long
@pytest.mark.parametrize("required", [None, 5])
def test_an_eccentric_gear_is_graded_by_twice_its_eccentricity(required):
    """d 60, m 3: F_i″ of 2e = 60 µm. Grade 5 is 3.2 √10 + 1.01 √√6250 + 6.4 = 25.5 µm, so 7 is 51 and 8 is 72. A required class is of part 1."""
    gear = Gear.from_spec(GearSpec("gear", 20, 3.0, 20.0))
    found = inspected(gear, 0.030, required_class=required)
    total, tooth = found.radial
    assert (total.symbol, tooth.symbol) == ("F_i″", "f_i″")
    assert total.value == pytest.approx(0.060, rel=5e-3) and tooth.value == pytest.approx(
        0.060 * math.sin(math.pi / 20), rel=2e-2
    )
    assert (total.grade.verdict, total.grade.iso_class, total.grade.tolerance) == (Verdict.GRADED, 8, pytest.approx(0.072))
    five = (2.96 * math.sqrt(10.0) + 0.01 * 6250**0.25 + 0.8) * 1e-3
    least = next(grade for grade in GRADES if tooth.value <= five * math.sqrt(2.0) ** (grade - 5))
    assert tooth.grade.iso_class == least
    assert not {finding.quantity for finding in found.findings} & {TOTAL, TOOTH_TO_TOOTH}


def test_too_large_a_module_is_measured_and_not_graded():
    gear = Gear.from_spec(GearSpec("gear", 20, 12.0, 40.0))
    total, _ = inspected(gear, 0.030).radial
    assert total.value == pytest.approx(0.060, rel=5e-3) and total.grade.verdict is Verdict.NO_TOLERANCE
