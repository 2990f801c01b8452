"""Which teeth lost about as much as one another."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.wear_law.teeth import alike_teeth


def wear_of(depths: list[float]):
    """Left flanks worn evenly by so much, in any unit; fillets, which do not count, by another depth."""
    shape = (len(depths), 2, 4, 6)
    deviation = np.zeros(shape)
    deviation[:, 0] = -np.array(depths)[:, None, None]
    deviation[:, 0, :, :2] = -7.0
    mask = np.zeros(shape, dtype=bool)
    mask[:, 0] = True
    maps = SimpleNamespace(deviation=deviation, seen=np.ones(shape, dtype=bool), fillet=2)
    return SimpleNamespace(mask=mask, side_maps=maps)


@pytest.mark.parametrize(
    ("depths", "left_out"),
    [
        # alike to the last digit: a tenth of the median stands for their scatter, and 3.5 of that is the limit
        ([1.0] * 11 + [1.34], False), ([1.0] * 11 + [1.36], True), ([1.0] * 11 + [0.66], False), ([1.0] * 11 + [0.64], True),
        # most of them 0.2 off the median: 3.5 · 1.4826 · 0.2 = 1.038
        ([0.8] * 5 + [1.0] + [1.2] * 4 + [2.03], False), ([0.8] * 5 + [1.0] + [1.2] * 4 + [2.05], True),
        # three teeth are enough to tell, two are not
        ([1.0, 1.0, 2.0], True), ([1.0, 2.0], False),
    ],
)  # fmt: skip
def test_a_tooth_that_lost_much_more_or_less_than_most_is_left_out(depths, left_out):
    kept = alike_teeth(wear_of(depths), 0)
    assert kept.tolist() == list(range(len(depths) - left_out))


def test_a_side_without_wear_has_none():
    assert alike_teeth(wear_of([1.0] * 5), 1).size == 0
