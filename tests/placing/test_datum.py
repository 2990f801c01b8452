"""Which flanks the pose may rest on: bends put in by hand, just on either side of each limit."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.placing.datum import choose_datum
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

CELLS = every_cell(designed(), 0.5)


def bent(left: float, right: float):
    """Flanks of either side that run from − to + so many mm along the profile."""
    flank = flanks_of(CELLS)
    ramp = np.linspace(-1.0, 1.0, flank.shape[-1])
    flank[:, Side.LEFT.index], flank[:, Side.RIGHT.index] = left * ramp, right * ramp
    return with_flanks(CELLS, flank)


@pytest.mark.parametrize(
    ("left", "right", "worn"),
    [(0.19, 0.1, None), (0.21, 0.1, Side.LEFT), (0.1, 0.21, Side.RIGHT), (0.1, 0.19, None), (-0.21, 0.1, Side.LEFT), (0.1, 0.1, None)],
)  # fmt: skip
def test_a_side_is_worn_that_bends_more_than_twice_as_much_as_the_other(left, right, worn):
    assert choose_datum(bent(left, right), 0.0).worn_side == worn


@pytest.mark.parametrize(("errors", "worn"), [(3.6, None), (4.4, Side.LEFT)])
def test_a_bend_must_be_four_of_its_standard_errors(errors, worn):
    """Of a column of the median (over the teeth, of those over the face) e = π/2 σ / √n, n its points on all teeth; of the bend over m of them e / √m, its e² taken off. The
    flanks of the other side are straight."""
    cells = bent(0.1, 0.0)
    columns = cells.grid.flank
    ramp = np.linspace(-0.1, 0.1, columns)[1:-1]
    square, number = np.mean(ramp**2), 12 * cells.grid.rows * 4
    column = np.sqrt(square / (1.0 + errors**2 / len(ramp)))
    assert choose_datum(cells, 2.0 / np.pi * column * np.sqrt(number)).worn_side == worn


BOTH = (Side.LEFT, Side.RIGHT)


@pytest.mark.parametrize(
    ("left", "right", "noise", "doubtful"),
    [
        (0.21, 0.1, 0.0, ()),
        (0.19, 0.1, 0.0, BOTH),
        (0.0, 0.0, 0.0, ()),
        (0.19, 0.0, 3.0, BOTH),
        (0.0, 0.0, 0.01, BOTH),
        (1e-4, 0.0, 0.0, ()),
    ],
    ids=["worn", "not by enough", "straight", "below the noise", "as straight as the noise shows", "less than says anything"],
)
def test_a_side_is_doubtful_that_is_not_seen_to_be_straight(left, right, noise, doubtful):
    """Not only one that is seen to bend: the noise hides bends as well."""
    assert choose_datum(bent(left, right), noise).doubtful == doubtful


@pytest.mark.parametrize(("low", "spread", "told"), [(0.0019, 0.0, False), (0.0021, 0.0, True), (0.01, 0.0062, True), (0.01, 0.0071, False)])  # fmt: skip
def test_flanks_low_on_both_sides_are_told_from_what_flanks_differ_by(low, spread, told):
    """From 2 µm, and from four standard errors of a median of 24 flanks, 1.25 · 1.4826 · spread / √24 = 0.378 spread."""
    flank = flanks_of(CELLS) - low
    flank[::2] += spread
    flank[1::2] -= spread
    notes = choose_datum(with_flanks(CELLS, flank), 1e-6).notes
    assert any("low against fillets and tips" in note for note in notes) == told
