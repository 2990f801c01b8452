"""Which end of a gear is up, where its drawing modifies the flanks of one side otherwise than those of the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.arrays import Floats
from gearwear.design import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.pair import Design
from gearwear.design.side import Side
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed

RELIEF = FlankModification(tip_relief=0.03, tip_relief_length=3.0)
NOISE = 0.005
LAYS = {"as drawn": (1.0, 1.0, 1.0), "over x": (1.0, -1.0, -1.0), "over y": (-1.0, 1.0, -1.0)}


def registered(lay: str, helix: float, relieved: Side, worn: float) -> Floats:
    """Profiles of the flanks, (2, columns), mm, of a gear relieved on one side and worn along all of its left flanks; it lies so on the table."""
    numbers = Helical(teeth=17, helix=helix, width=16.0)
    gear = Gear.from_spec(replace(designed(numbers).spec, **{str(relieved): RELIEF}))

    def added(side: Floats, roll: Floats, _: Floats) -> Floats:
        off = np.where(side == relieved, gear.drawn(relieved).along_profile(roll), 0.0)
        return np.asarray(off - np.where(side > 0, worn * np.abs(roll / gear.reference_roll - 1.0), 0.0))

    cloud = scan(numbers, 20_000, noise=NOISE, seed=5, added=added)
    points = (cloud.points - cloud.translation) @ cloud.rotation * LAYS[lay]
    cells = gw.register(Design({"gear": gear}), gw.as_scan(points)).cells
    return np.asarray(np.nanmean(cells.grid.flank_shape(cells.points.deviation), axis=(0, 2)))


@pytest.mark.parametrize(("lay", "helix"), [pytest.param("over x", 0.0, marks=pytest.mark.long), ("over y", 12.0)])
def test_upside_down_a_flank_is_still_the_one_that_is_drawn_relieved(lay: str, helix: float):
    assert np.abs(registered(lay, helix, Side.LEFT, 0.0)).max() < 0.002


@pytest.mark.long
@pytest.mark.parametrize("relieved", list(Side))
@pytest.mark.parametrize("lay", LAYS)
def test_wear_of_the_other_side_or_of_the_same_does_not_hide_which_is_drawn_relieved(lay: str, relieved: Side):
    upright, laid = registered("as drawn", 12.0, relieved, 0.06), registered(lay, 12.0, relieved, 0.06)
    assert laid == pytest.approx(upright, abs=1e-4)
    assert np.ptp(laid[Side.RIGHT.index]) < 0.003 < 0.02 < np.ptp(laid[Side.LEFT.index])
