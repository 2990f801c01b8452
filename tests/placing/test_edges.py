"""Edges of flanks against faces that lean: what falls off within a short way, and steeper than the face does."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.placing.edges import at_either_end, typical_fall

ROWS = 20
MIDDLE = (np.arange(ROWS) + 0.5) / ROWS
"""Heights of the rows, in face widths."""


def flanks(field):
    """(9 teeth, 2 sides, rows, 3 columns) of a field along the face, each flank at its own level."""
    level = np.linspace(-0.02, 0.02, 18).reshape(9, 2, 1, 1)
    return level + np.broadcast_to(np.asarray(field)[:, None], (9, 2, ROWS, 3))


@pytest.mark.parametrize("taper", [0.05, -0.08])
def test_a_face_that_leans_as_a_whole_has_no_low_end(taper):
    fall = typical_fall(flanks(taper * (MIDDLE - 0.5)))
    assert fall.min() > -1e-12
    assert typical_fall(flanks(taper * (MIDDLE - 0.5))[:, :, ::-1]) == pytest.approx(fall[:, ::-1], abs=1e-12)


@pytest.mark.parametrize("taper", [0.0, 0.05, -0.08])
def test_what_is_rounded_off_a_leaning_face_is_as_low_as_it_was_made(taper):
    rounding = -0.1 * (np.maximum(1.0 - MIDDLE / 0.15, 0.0) ** 2 + np.maximum(1.0 - (1.0 - MIDDLE) / 0.15, 0.0) ** 2)
    fall = typical_fall(flanks(taper * (MIDDLE - 0.5) + rounding))
    thin = slice(0, 5) if taper >= 0.0 else slice(15, None)
    assert fall[:, thin] == pytest.approx(np.broadcast_to(rounding[thin][:, None], fall[:, thin].shape), abs=1e-12)


@pytest.mark.parametrize("worn", [(0.3, 1.1), (-0.1, 0.55)])
def test_where_the_middle_alone_leans_ends_that_are_level_are_none(worn):
    """Worn from within the middle half on: the line through it runs below the end that is not."""
    field = np.where((worn[0] < MIDDLE) & (worn[1] > MIDDLE), -0.2, 0.0)
    low = typical_fall(flanks(field)) < -0.02
    for edge in at_either_end(low.all(axis=0)):
        assert not edge[field == 0.0].any()


def test_a_face_of_which_a_part_was_seen_says_what_it_says():
    field = flanks(0.05 * (MIDDLE - 0.5))
    field[:, :, 12:] = np.nan
    fall = typical_fall(field)
    assert np.nanmin(fall) > -1e-12 and np.isnan(fall[:, 12:]).all()


@pytest.mark.parametrize("rows", range(3, 9))
def test_of_few_rows_the_first_and_the_last_may_be_edges_and_no_more(rows):
    low = np.zeros(rows, dtype=bool)
    low[[0, -1]] = True
    from_low, from_high = at_either_end(low)
    np.testing.assert_array_equal(from_low | from_high, low)
    low[1] = True  # further in than a quarter of the face
    assert not at_either_end(low)[0].any()
