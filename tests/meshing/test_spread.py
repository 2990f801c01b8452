"""How far the numbers of a contact are known, on variants whose numbers are known."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.meshing.contact_result import ContactVariant
from gearwear.meshing.spread import contact_spread

SIZE, LEVEL = 0.7, 0.4
NORMAL = np.random.default_rng(1).normal(size=(4000, 3))


def variants(off: np.ndarray) -> list[ContactVariant]:
    """Contact at three places: a rise of 10 above nothing, a backlash of 5, 1 and 3, each off by a share of its own."""
    return [ContactVariant(np.array([10.0 + own[0], 0.0]), np.array([5.0 + own[0], 1.0 + own[1], 3.0])) for own in off]


def test_what_one_place_decides_is_known_as_that_place_is():
    found = contact_spread(variants(SIZE * 0.1 * NORMAL), variants(SIZE * 0.1 * (NORMAL + NORMAL[::-1])), LEVEL)
    rms = SIZE * 0.1 * float(np.sqrt(np.mean(NORMAL[:, 0] ** 2)))
    assert found.transmission_error == pytest.approx(rms)
    assert found.backlash_greatest == pytest.approx(np.hypot(rms, LEVEL))
    assert found.backlash_least == pytest.approx(np.hypot(0.1 * SIZE * np.sqrt(np.mean(NORMAL[:, 1] ** 2)), LEVEL))


def test_of_places_that_compete_the_shift_counts():
    """The greatest of three alike that scatter by σ is 0.846 σ above them, and does so itself by 0.748 σ (order statistics of three)."""

    def alike(off: np.ndarray) -> list[ContactVariant]:
        return [ContactVariant(np.append(20.0 + own, 0.0), 5.0 + own) for own in off]

    found = contact_spread(alike(np.zeros((4000, 3))), alike(SIZE * NORMAL), 0.0)
    assert found.transmission_error == pytest.approx(SIZE * np.hypot(0.846, 0.748), rel=0.03)
    assert found.transmission_error == found.backlash_greatest


def test_nothing_drawn():
    found = contact_spread([], [], LEVEL)
    assert (found.transmission_error, found.backlash_mean) == (0.0, LEVEL)
