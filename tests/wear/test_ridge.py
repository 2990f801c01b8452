"""A ridge at the pitch line of a worn side, and thicker teeth: what was put on the flanks is asked back."""

from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.diagnose.made_height import MadeHeight
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.own_level import highest_strip, standing_proud
from gearwear.wear.places import lay_flat
from gearwear.wear.regions import find_wear
from gearwear.wear.ridge import worn_level
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

GEAR = designed()
PITCH = GEAR.reference_roll
NOISE = 0.003
"""mm, of a cell; of a column on all flanks 0.2 µm."""
AS_KNOWN = 0.0003
"""mm; how well the level of the side as made is known."""
LEFT = frozenset({Side.LEFT})
PARTS = 200
"""Parts of a column over which what is put on is averaged."""
WIDTH = 0.2 * GEAR.transverse_module


def loop():
    context = SimpleNamespace(pitch_roll=PITCH, sliding=lambda roll: 1.0 - PITCH / roll, faces=())
    return SimpleNamespace(as_made_std=(AS_KNOWN, AS_KNOWN), made=MadeHeight(), context=context)


def put_on(thick=0.0, ridge=0.0, lost=0.06, power=1.0, size=0.9, seed=1):
    """Cells of a gear whose left flanks were cut `thick` too thick (mm), slid by `lost` at most and carry a ridge; and the mean profile that was put on."""
    cells = every_cell(GEAR, size)
    rolls = cells.grid.rolls(2 * PARTS)[1::2]
    way, hump = np.abs(rolls - PITCH) ** power, np.exp(-0.5 * ((rolls - PITCH) / WIDTH) ** 2)
    profile = (thick - lost * way / way.max() + ridge * hump).reshape(-1, PARTS).mean(axis=1)
    flank = flanks_of(cells)
    flank[:, 0] += profile
    flank += NOISE * np.random.default_rng(seed).standard_normal(flank.shape)
    return with_flanks(cells, flank), profile


def told(cells):
    sheets = make_side_maps(cells)
    return worn_level(sheets, cells.grid, loop(), Side.LEFT, standing_proud(sheets, loop(), LEFT)[0])


@pytest.mark.parametrize("size", [0.7, 0.9, 1.1])
@pytest.mark.parametrize("ridge", [0.012, 0.03])
def test_a_ridge_raises_no_level(ridge, size):
    """Of teeth cut as drawn, whether they have lost anything or not."""
    for lost in (0.06, 0.0):
        level = told(put_on(0.0, ridge, lost, size=size)[0])
        assert level.ridge is not None and level.ridge.side is Side.LEFT
        assert abs(level.ridge.height - ridge) < 4.0 * level.ridge.std
        assert level.ridge.std < 0.25 * ridge
        assert (level.height, level.low) == (0.0, 0.0)
        assert level.high < 0.3 * ridge


@pytest.mark.parametrize("size", [0.7, 0.9])
def test_thicker_teeth_are_told_beside_a_ridge(size):
    level = told(put_on(0.02, 0.02, size=size)[0])
    assert level.ridge is not None
    assert level.low < 0.02 < level.high
    assert level.height == pytest.approx(0.02, abs=0.001)


@pytest.mark.parametrize("power", [0.5, 0.75, 1.0])
@pytest.mark.parametrize("size", [0.7, 0.9, 1.4])
def test_what_comes_to_a_tip_where_nothing_slides_is_no_ridge(size, power):
    """The level is that of the highest strip; the teeth as they were cut are higher than its mean, and within what the level may be."""
    cells, profile = put_on(0.03, power=power, size=size)
    level = told(cells)
    assert level.ridge is None and not level.proud.any()
    assert level.height == standing_proud(make_side_maps(cells), loop(), LEFT)[0]
    assert level.height == pytest.approx(profile.max(), abs=0.001)
    if size < 1.0:
        assert 0.65 * level.height < level.low <= level.height
        assert 0.03 < level.high < 0.034


@pytest.mark.parametrize("size", [1.4, 1.8])
def test_of_few_columns_nothing_is_told_and_all_is_open(size):
    """Of seven columns, or five, next to none is left over to tell how well any profile fits."""
    cells, profile = put_on(0.0, 0.02, size=size)
    assert cells.grid.flank <= 7
    level = told(cells)
    assert level.ridge is None
    assert level.low == 0.0 and level.high >= level.height
    assert level.height == pytest.approx(profile.max(), abs=0.001)


def test_rows_are_not_taken_for_high_by_a_ridge():
    """All rows hold the ridge, and in their mean a share of it."""
    cells, profile = put_on(0.0, 0.03, 0.0, size=0.9)
    sheets = make_side_maps(cells)
    assert profile.mean() > 10.0 * AS_KNOWN
    assert highest_strip(np.tile(profile, (cells.grid.rows, 1))) == pytest.approx(profile.max())
    assert standing_proud(sheets, loop(), LEFT)[0] == pytest.approx(profile.max(), abs=0.001)
    assert told(cells).height == 0.0


@pytest.mark.parametrize(("thick", "ridge"), [(0.0, 0.02), (0.02, 0.02), (0.02, 0.0)])
def test_what_is_missing_is_counted_from_the_level_as_cut_and_no_ridge_off_it(thick, ridge, monkeypatch):
    """The sum of what lies below the teeth as they were cut, column by column; the ridge above that is none of it."""
    cells, profile = put_on(thick, ridge, size=0.9)
    monkeypatch.setattr("gearwear.wear.places.within_ends", lambda cells, *_: cells)
    monkeypatch.setattr("gearwear.wear.places.at_own_level", lambda cells, *_: (cells, 0.0))
    laid = lay_flat(cells, NOISE, loop(), LEFT)
    found = -laid.sheets.deviation[:, 0, :, laid.sheets.fillet :].mean(axis=(0, 1))
    missing = np.maximum((thick if ridge else profile.max()) - profile, 0.0)
    assert found.sum() == pytest.approx(missing.sum(), abs=0.0008 * len(profile))
    assert bool(laid.ridges) == (ridge > 0.0)
    assert find_wear(cells, NOISE, LEFT).ridges == ()  # no loop, no level of the side
