"""What leaves a worn volume open, as a depth: by hand, of flanks of a known area."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.comparison.open_volume import OpenVolume
from gearwear.design.side import Side

TEETH, ROWS, ROW = 20, 10, 2.0
"""A row of a flank is 2 mm², so all flanks of a side are 20 · 10 · 2 = 400 mm²."""


def opened(undecided, volume=30.0, std=0.5):
    """Volume of a gear without a loop, with other answers (volume, std) that are not excluded."""
    grid = SimpleNamespace(toothed=np.ones(ROWS, dtype=bool), gear=SimpleNamespace(teeth=TEETH))
    gear = SimpleNamespace(spec=SimpleNamespace(tolerance=SimpleNamespace(thickness=None)))
    measured = SimpleNamespace(
        cells=SimpleNamespace(grid=grid), gear=gear, loop=None, layered=np.zeros(TEETH, dtype=bool), worn_sides=frozenset()
    )
    found = SimpleNamespace(
        volume=volume, volume_std=std, regions=(), hidden_pits=0.0, unseen=0.0, level_open=(0.0, 0.0), faint=0.0, unsure=0.0,
        side_maps=SimpleNamespace(flank_row=ROW),
    )  # fmt: skip
    return OpenVolume(measured, found, tuple(undecided))


def test_evenly_over_a_side_it_is_the_range_over_its_area():
    """22 to 50 mm³ about 30 over 400 mm²: 20 µm less, 50 µm more."""
    below, above = opened([(22.0 + 1.96, 1.0), (50.0 - 1.96, 1.0)]).evenly
    assert (below, above) == (pytest.approx(0.020, rel=1e-3), pytest.approx(0.050, rel=1e-3))


@pytest.mark.parametrize("undecided", [(), [(30.2, 0.2)]])
def test_what_is_within_its_own_deviation_is_none(undecided):
    assert opened(undecided).evenly == (0.0, 0.0)
    region = SimpleNamespace(side=Side.LEFT, max_depth=0.06, max_depth_std=0.002)
    assert opened(undecided).depth_limits(region) is None


def test_the_deepest_place_has_up_to_twice_as_much():
    region = SimpleNamespace(side=Side.LEFT, max_depth=0.09, max_depth_std=0.002)
    low, high = opened([(22.0, 0.0), (50.0, 0.0)]).depth_limits(region)
    own = 1.96 * 0.002
    assert (low, high) == (pytest.approx(0.09 - 0.04 - own, rel=1e-3), pytest.approx(0.09 + 0.10 + own, rel=1e-3))
    unknown = SimpleNamespace(side=Side.LEFT, max_depth=0.01, max_depth_std=math.nan)
    assert opened([(22.0, 0.0), (50.0, 0.0)]).depth_limits(unknown) == (0.0, pytest.approx(0.11))
