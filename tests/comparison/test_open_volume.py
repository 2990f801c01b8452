"""What leaves a worn volume open, as a depth: by hand, of flanks of a known area."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.comparison.open_volume import Open, OpenVolume
from gearwear.design.side import Side
from gearwear.wear.tooth_summary import DriftSeam
from tests.placing.placing import designed

TEETH, ROWS, ROW = 20, 10, 2.0
"""A row of a flank is 2 mm², so all flanks of a side are 20 · 10 · 2 = 400 mm²."""


def opened(undecided, volume=30.0, std=0.5, **found):
    """Volume of a gear without a loop, with other answers (volume, std) that are not excluded."""
    grid = SimpleNamespace(toothed=np.ones(ROWS, dtype=bool), gear=SimpleNamespace(teeth=TEETH))
    gear = SimpleNamespace(spec=SimpleNamespace(tolerance=SimpleNamespace(thickness=None)))
    measured = SimpleNamespace(
        cells=SimpleNamespace(grid=grid), gear=gear, loop=None, layered=np.zeros(TEETH, dtype=bool), worn_sides=frozenset()
    )
    known = SimpleNamespace(
        volume=volume, volume_std=std, regions=(), hidden_pits=0.0, unseen=0.0, level_open=(0.0, 0.0), faint=0.0, unsure=0.0,
        side_maps=SimpleNamespace(flank_row=ROW),
    )  # fmt: skip
    return OpenVolume(measured, SimpleNamespace(**{**vars(known), **found}), tuple(undecided))


def test_evenly_over_a_side_it_is_the_range_over_its_area():
    """22 to 50 mm³ about 30 over 400 mm²: 20 µm less, 50 µm more."""
    below, above = opened([(22.0 + 1.96, 1.0), (50.0 - 1.96, 1.0)]).evenly
    assert (below, above) == (pytest.approx(0.020, rel=1e-3), pytest.approx(0.050, rel=1e-3))


WORN = [
    SimpleNamespace(tooth=4, side=Side.LEFT, volume=2.0, area=20.0),
    SimpleNamespace(tooth=7, side=Side.LEFT, volume=28.0, area=20.0),
]
"""2 and 28 mm³ on two flanks of 20 mm²: 0.1 and 1.4 mm deep."""


@pytest.mark.parametrize(
    ("tooth", "depth", "before", "range_"),
    [
        (4, 0.06, False, (30.0 - 0.98 - 1.2, 30.98)),  # a part of its depth
        (4, 0.20, False, (30.0 - 0.98 - 2.0, 30.98)),  # all of it: no more than was found
        (7, -0.06, False, (29.02, 30.0 + 0.98 + 1.2)),  # told too thick, it has lost more
        (4, 0.02, False, None),  # 0.4 mm³ is within 0.5
        (5, 0.20, False, None),  # of a tooth that is not worn nothing is open
        (4, 0.20, True, None),  # before wear its pitch stepped there as well
    ],
)
def test_of_a_worn_tooth_in_which_the_scan_may_have_begun_the_closure_is_open(tooth, depth, before, range_):
    """A closure that is so deep on one flank, along its normal; of a spur gear at the reference circle depth is arc times cos α."""
    gear = designed()
    open_ = opened([], regions=WORN)
    open_.measured.gear = gear
    seam = DriftSeam(tooth, depth / math.cos(math.radians(20.0)))
    open_ = OpenVolume(open_.measured, open_.found, (), before, seam)
    assert (None if open_.of_such_teeth is None else open_.of_such_teeth[:2]) == (range_ and pytest.approx(range_, abs=1e-9))
    assert [part.what for part in open_.causes] == ([Open.SEAM] if range_ else [])


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


@pytest.mark.parametrize(
    ("undecided", "found", "range_", "widest"),
    [
        ([], {}, None, None),
        ([(22.0 + 1.96, 1.0)], {}, (22.0, 30.98), Open.SIDES),
        ([(22.0 + 1.96, 1.0)], {"unseen": 20.0}, (22.0, 50.0), Open.UNSEEN),
        ([(22.0 + 1.96, 1.0)], {"unseen": 3.0}, (22.0, 33.0), Open.SIDES),
        ([], {"hidden_pits": 0.1}, (29.02, 30.98), None),  # within its own 95 %
        ([], {"hidden_pits": 5.0}, (29.02, 35.0), Open.PITS),
        ([], {"faint": 5.0}, (29.02, 35.0), Open.FAINT),
        ([], {"faint": 5.0, "hidden_pits": 2.0}, (29.02, 37.0), Open.PITS),  # of faint wear only where nothing else is open
        ([], {"level_open": (0.02, 0.01)}, (22.0, 34.0), Open.RIDGE),
    ],
)
def test_what_leaves_most_open_is_what_is_asked(undecided, found, range_, widest):
    """30 ± 0.5 mm³ over flanks of 400 mm²; each part adds to its own end, and the 95 % interval, 29.02 to 30.98 mm³, is in it."""
    open_ = opened(undecided, **found)
    assert open_.widest is widest
    if range_ is None:
        assert open_.of_such_teeth is None
    else:
        assert open_.of_such_teeth[:2] == pytest.approx(range_, abs=1e-4)
        assert open_.of_such_teeth[2].split("; ") == [str(part.what) for part in open_.causes]
