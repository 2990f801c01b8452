"""The decision rule of ISO 14253-1 on both sides of each of its edges."""

from __future__ import annotations

import math

import pytest

from gearwear.design.conformity import Conformity, conformity, exit_status, worst
from gearwear.fleet.trend import Point

YES, NO, NEITHER = Conformity.CONFORMING, Conformity.NOT_CONFORMING, Conformity.NEITHER


def point(value, std, low=math.nan, high=math.nan):
    return Point(inspected=None, cycles=None, value=value, std=std, low=low, high=high, scans=1)


@pytest.mark.parametrize(("value", "found"), [
    (0.0799, YES), (0.0801, NEITHER), (0.1, NEITHER), (0.1199, NEITHER), (0.1201, NO),
])  # fmt: skip
def test_between_the_zones_neither_is_proven(value, found):
    assert conformity(*point(value, 0.01).ends, 0.1) is found


@pytest.mark.parametrize(("value", "std", "low", "high", "found"), [
    (0.0, math.nan, 0.0, 0.02, YES),  # none found, and none that could reach the limit hides
    (0.0, math.nan, 0.0, 0.2, NEITHER),
    (0.05, 0.001, 0.01, 0.12, NEITHER),  # open beyond the limit
    (0.05, 0.001, 0.01, 0.099, NEITHER),  # and the scatter beyond what is open
    (0.05, 0.001, 0.01, 0.097, YES),
    (0.08, 0.0099, 0.08 - 1.96 * 0.0099, 0.08 + 1.96 * 0.0099, YES),  # a range that says no more than the scatter does
    (0.3, 0.001, 0.05, 0.4, NEITHER),  # open down to below it
    (0.3, 0.001, 0.101, 0.4, NEITHER),
    (0.3, 0.001, 0.2, 0.4, NO),
    (0.01, math.nan, math.nan, math.nan, NEITHER),  # nothing is stated: nothing is proven
    (math.nan, 0.01, math.nan, math.nan, NEITHER),
])  # fmt: skip
def test_what_is_open_counts(value, std, low, high, found):
    assert conformity(*point(value, std, low, high).ends, 0.1) is found


def test_the_worst_decides_for_scripts():
    assert worst([YES, NO, NEITHER]) is NO
    assert worst([]) is None
    assert [exit_status(found) for found in ([], [YES], [YES, NEITHER], [NEITHER, NO])] == [0, 0, 3, 1]
