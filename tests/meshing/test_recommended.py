"""Recommended backlash: the tables of the reference (B8), entry by entry where a range begins and ends."""

import math

import pytest

from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from gearwear.meshing.recommended import recommended_backlash


def found(pitch, inches):
    return recommended_backlash(Gear.from_spec(GearSpec("pinion", 24, 25.4 / pitch, 20.0)), 25.4 * inches)


def test_the_papers_pair(pinion):
    """No entry for diametral pitch 4 at 4.5 in; the middle of the classical range is the paper's 0.009 in."""
    there = recommended_backlash(pinion, 114.3)

    assert there.least_normal == pytest.approx(0.2051, abs=5e-5)
    assert there.coarse_pitch is None
    assert sum(there.assembly) / 2 == pytest.approx(0.2286, abs=1e-12)
    # Shared by both gears, as arc: E_sns of the reference.
    assert -there.least_normal / 2 / math.cos(math.radians(20)) == pytest.approx(-0.1091, abs=5e-5)


@pytest.mark.parametrize(
    ("pitch", "inches", "thousandths"),
    [
        (10, 4.5, (5, 15)), (19.99, 5, (5, 15)), (6, 7, (10, 20)), (12, 10, (10, 20)), (4, 15, (20, 30)), (9.99, 20, (15, 25)),
        (2, 25, (30, 40)), (5.99, 30, (25, 30)), (8, 21, (20, 30)), (1, 35, (40, 60)), (3.49, 40, (35, 45)), (3.5, 31, (30, 40)),
        (6, 39, (25, 35)), (0.5, 41, (50, 70)), (3, 50, (40, 55)), (4, 45, (35, 50)), (7, 50, (30, 40)), (1.99, 60, (60, 80)),
        (2, 80, (45, 65)), (5, 51, (40, 60)), (1, 100, (70, 95)), (3, 81, (50, 80)), (1, 120, (80, 110)),
    ],
)  # fmt: skip
def test_the_coarse_pitch_table(pitch, inches, thousandths):
    assert found(pitch, inches).coarse_pitch == pytest.approx([0.0254 * value for value in thousandths])


@pytest.mark.parametrize(("pitch", "inches"), [(4, 4.5), (9, 4), (20, 8), (0.4, 35), (12, 25), (3, 110), (1, 121)])
def test_where_the_coarse_pitch_table_is_empty(pitch, inches):
    assert found(pitch, inches).coarse_pitch is None


@pytest.mark.parametrize(
    ("pitch", "thousandths"),
    [
        (1, (25, 40)), (2, (14, 20)), (2.5, (11, 16)), (3, (9, 14)), (4, (7, 11)), (5, (6, 9)), (6, (5, 8)), (7, (4, 7)),
        (8, (4, 6)), (9, (4, 6)), (10, (3, 5)), (13, (3, 5)), (14, (2, 4)), (32, (2, 4)),
    ],
)  # fmt: skip
def test_the_range_for_assembly(pitch, thousandths):
    assert found(pitch, 10).assembly == pytest.approx([0.0254 * value for value in thousandths])


def test_a_pitch_between_the_lines_has_no_entry():
    assert found(3.5, 10).assembly is None


def test_a_distance_that_cannot_be(pinion):
    with pytest.raises(InputError, match="must be above 0"):
        recommended_backlash(pinion, math.nan)
