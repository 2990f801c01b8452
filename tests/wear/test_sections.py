"""The surface at one radius from the points of neighbouring sections, against what was put in and dense least squares."""

import numpy as np
import pytest

from gearwear.wear.sections import BENT_POINTS, SectionSurface, surface_in_sections

SECTIONS, HALF = 60, 0.8


def surface(x: np.ndarray, y: np.ndarray, row: np.ndarray) -> SectionSurface:
    """Of the left flank of one tooth; the right one has the same points."""
    cell = np.concatenate([row, SECTIONS + row])
    return surface_in_sections(np.tile(x, 2), np.tile(y, 2), cell, (1, 2, SECTIONS), HALF, [slice(0, SECTIONS)], True)


def thin(seed: int, number: int = 100) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return random.uniform(-HALF, HALF, number), random.integers(0, SECTIONS, number)


def test_a_parabola_along_the_face_and_a_slope_along_the_profile_come_back():
    x, row = thin(1)
    found = surface(x, 0.02 - 0.003 * row + 0.0001 * row**2 + 0.05 * x, row)
    assert found.pooled > 1
    known = found.count[0, 0] >= BENT_POINTS
    z = np.arange(SECTIONS)[known]
    assert known.sum() > 0.9 * SECTIONS
    np.testing.assert_allclose(found.value[0, 0, known], 0.02 - 0.003 * z + 0.0001 * z**2, atol=1e-9)
    np.testing.assert_allclose(found.scatter[0, 0, known], 0.0, atol=1e-12)


@pytest.mark.parametrize("section", [12, 30, 50])
def test_value_and_variance_are_those_of_least_squares(section):
    x, row = thin(2)
    y = np.random.default_rng(3).normal(0.0, 0.01, len(x))
    found = surface(x, y, row)
    own = np.abs(row - section) <= found.pooled // 2
    t = row[own] - section
    matrix = np.column_stack([np.ones(own.sum()), t, t**2, x[own]])
    fitted, square, _, _ = np.linalg.lstsq(matrix, y[own], rcond=None)
    assert found.value[0, 0, section] == pytest.approx(fitted[0], rel=1e-6)
    assert found.variance[0, 0, section] == pytest.approx(np.linalg.inv(matrix.T @ matrix)[0, 0], rel=1e-6)
    assert found.free[0, 0, section] == own.sum() - 4
    assert found.scatter[0, 0, section] == pytest.approx(square[0] / (own.sum() - 4), rel=1e-6)


def test_values_half_a_width_apart_have_nothing_in_common():
    """Of parabolas through windows full of points the correlation at half a width is −1 / 48 in closed form: the least is looked for among these as
    among independent ones."""
    random, number, kept = np.random.default_rng(4), 24, []
    row = np.repeat(np.arange(SECTIONS), 2)[::3]
    x = random.uniform(-HALF, HALF, len(row))
    for _ in range(400):
        found = surface(x, random.normal(size=len(row)), row)
        kept.append(found.value[0, 0, [number, number + found.pooled // 2]])
    assert found.pooled > 5
    # Four standard deviations of a correlation of 400 pairs, and what windows of few sections add.
    assert abs(np.corrcoef(np.transpose(kept))[0, 1]) < 4.0 / np.sqrt(400)


def test_what_the_parabola_changes_is_what_a_mean_hides():
    """One point in every section, as high as it is long: of c j² the mean over 2 k + 1 sections is c k (k + 1) / 3 above its middle."""
    row, curvature = np.arange(SECTIONS), 0.0001
    found = surface(np.zeros(SECTIONS), curvature * (row - 30.0) ** 2, row)
    reach = found.pooled // 2
    assert reach > 3
    assert found.bend[0, 0, 30] == pytest.approx(-curvature * reach * (reach + 1) / 3.0)
