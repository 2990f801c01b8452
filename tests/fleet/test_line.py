"""The line through inspections, and when it reaches a limit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.fleet.line import FittedLine, fit_line, line_from_new, reaches

X = np.array([1.0, 2.0, 4.0, 5.0])


def test_points_on_a_line_give_it_back_with_the_textbook_variance():
    std = np.full(4, 0.3)
    line = fit_line(X, 2.0 + 0.5 * X, std)
    assert line.slope == pytest.approx(0.5, abs=1e-12)
    assert line.at(0.0)[0] == pytest.approx(2.0, abs=1e-12)
    assert line.slope_std == pytest.approx(0.3 / math.sqrt(((X - 3.0) ** 2).sum()))
    assert line.at(3.0)[1] == pytest.approx(0.3 / 2.0)
    assert not line.bends


def test_a_point_without_weight_moves_nothing():
    with_it = fit_line(np.append(X, 3.0), np.append(2.0 + 0.5 * X, 99.0), np.append(np.full(4, 0.3), 1e9))
    assert with_it.slope == pytest.approx(0.5, abs=1e-6)


def test_points_off_the_line_widen_it_by_birges_ratio():
    y = np.array([0.0, 1.0, 0.0, 1.0])
    line = fit_line(X, y, np.full(4, 0.01))
    residual = y - np.polyval(np.polyfit(X, y, 1), X)
    assert line.bends
    assert line.misfit == pytest.approx((residual**2).sum() / 0.01**2 / 2)
    scatter = math.sqrt((residual**2).sum() / 2)  # as ordinary least squares has it, which knows of no stated scatter
    assert line.slope_std == pytest.approx(scatter / math.sqrt(((X - 3.0) ** 2).sum()))
    assert line.degrees == 2


def test_no_line_without_two_places():
    assert fit_line(np.array([1.0]), np.array([1.0]), np.array([1.0])) is None
    assert fit_line(np.array([1.0, 1.0]), np.array([1.0, 2.0]), np.array([1.0, 1.0])) is None


def test_the_interval_ends_where_the_band_meets_the_limit():
    line = FittedLine(middle=3.0, level=1.0, slope=0.5, level_std=0.05, slope_std=0.03)
    found = reaches(line, 4.0, 5.0)
    k = line.factor
    assert line.at(5.0 + found.value)[0] == pytest.approx(4.0)
    (upper, std), (lower, other) = line.at(5.0 + found.low), line.at(5.0 + found.high)
    assert upper + k * std == pytest.approx(4.0)
    assert lower - k * other == pytest.approx(4.0)
    assert found.low < found.value < found.high


def test_a_rate_that_may_be_nothing_has_no_end():
    found = reaches(FittedLine(middle=3.0, level=1.0, slope=0.05, level_std=0.05, slope_std=0.1), 4.0, 5.0)
    assert (found.value, found.high) == (pytest.approx(58.0), math.inf)
    assert 0.0 < found.low < found.value


@pytest.mark.parametrize(("slope", "level", "expected"), [
    (-0.5, 1.0, (math.inf, math.inf, math.inf)),  # it falls
    (0.5, 9.0, (0.0, 0.0, 0.0)),  # beyond it long ago
])  # fmt: skip
def test_never_and_already(slope, level, expected):
    found = reaches(FittedLine(middle=3.0, level=level, slope=slope, level_std=0.01, slope_std=0.01), 4.0, 5.0)
    assert (found.value, found.low, found.high) == expected


def test_at_the_limit_it_may_be_reached_or_not():
    found = reaches(FittedLine(middle=3.0, level=3.0, slope=0.5, level_std=0.1, slope_std=0.05), 4.02, 5.0)
    assert found.low == 0.0 < found.value < found.high < math.inf


def test_a_band_that_clears_the_limit_for_a_moment_has_no_end_there():
    """It rises over it just beyond the middle, and with a rate that may be nothing it falls below again."""
    line = FittedLine(middle=3.0, level=4.0019, slope=0.05, level_std=0.001, slope_std=0.1)
    assert reaches(line, 4.0, 3.0).high == math.inf
    cleared = [line.at(x)[0] - line.factor * line.at(x)[1] >= 4.0 for x in np.linspace(3.0, 3.02, 2001)]
    assert any(cleared) and not cleared[0] and not cleared[-1]


def test_from_new_through_one_point():
    line = line_from_new(2e6, 0.05, 0.004)
    assert line.slope == pytest.approx(0.025e-6)
    assert line.slope_std / line.slope == pytest.approx(0.004 / 0.05)
    found = reaches(line, 0.1, 2e6)
    assert found.value == pytest.approx(2e6)
    assert found.low == pytest.approx(0.1 / (line.slope + line.factor * line.slope_std) - 2e6)
    assert found.high == pytest.approx(0.1 / (line.slope - line.factor * line.slope_std) - 2e6)


def test_the_interval_holds_the_truth_as_often_as_it_says():
    """2000 draws of four inspections: 95 % within 3.5 standard errors."""
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(2000):
        line = fit_line(X, 0.2 * X + 0.05 * rng.standard_normal(4), np.full(4, 0.05))
        plain = FittedLine(
            middle=line.middle, level=line.level, slope=line.slope, level_std=0.05 / 2, slope_std=0.05 / math.sqrt(10.0)
        )
        found = reaches(plain, 2.0, 5.0)
        held += found.low <= 5.0 <= found.high
    assert held / 2000 == pytest.approx(0.95, abs=3.5 * math.sqrt(0.05 * 0.95 / 2000))
