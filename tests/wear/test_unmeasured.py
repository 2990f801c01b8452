"""The thinnest of worn teeth that few sections measured, by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.wear.unmeasured import thinnest_unmeasured

ROWS, FILLET, FLANK, TURN = 12, 3, 9, 1.1
ROLL = FILLET + 4
"""Where thickness is measured: in the fifth column of the flank."""


def worn(depths, measured=(), stds=0.01):
    """The thinnest of four teeth 6 mm thick, some of them worn by so much (mm) on one side or both over rows 4 to 8, of which some have sections."""
    grid = SimpleNamespace(fillet=FILLET, flank_column=lambda roll: 4, row_middles=np.linspace(0.5, 11.5, ROWS))
    depth, regions = np.zeros((4, 2, ROWS, FILLET + FLANK)), []
    for (tooth, side), deep in depths.items():
        depth[tooth, side.index, 4:8, FILLET:] = deep
        regions.append(SimpleNamespace(tooth=tooth, side=side, max_depth_std=stds))
    arc = np.full((4, 24), np.nan)
    arc[list(measured)] = 6.0
    thickness = SimpleNamespace(arc=arc, as_made=np.full((4, 24), 6.0), z=np.linspace(0.25, 11.75, 24), turn=TURN)
    return thinnest_unmeasured(thickness, SimpleNamespace(depth=depth, regions=regions), grid, ROLL)


def test_it_is_as_made_less_the_wear_of_both_flanks():
    least = worn({(1, Side.LEFT): 0.10, (1, Side.RIGHT): 0.05, (2, Side.LEFT): 0.12})
    assert least.tooth == 1 and least.value == pytest.approx(6.0 - TURN * 0.15)
    assert least.std == pytest.approx(TURN * 0.01 * math.sqrt(2.0))
    assert 4.0 < least.at_z < 8.0 and least.nominal == 6.0


def test_any_of_them_may_be_the_thinnest():
    one, two = worn({(1, Side.LEFT): 0.10}), worn({(2, Side.LEFT): 0.09}, stds=0.05)
    both = worn({(1, Side.LEFT): 0.10, (2, Side.LEFT): 0.09}, stds=0.05)
    assert both.tooth == 1 and both.low == pytest.approx(one.value - 1.96 * TURN * 0.05, rel=1e-4)
    assert both.high <= two.high


@pytest.mark.parametrize("measured", [(1,), (0, 1, 2, 3)])
def test_of_teeth_that_sections_measured_nothing_is_said(measured):
    assert worn({(1, Side.LEFT): 0.10}, measured) is None


def test_no_more_is_said_than_is_known():
    assert worn({(1, Side.LEFT): 0.10}, stds=math.nan) is None
    assert worn({}) is None
    assert worn({(1, Side.LEFT): 0.01}).high == 6.0  # no thicker than it was made
