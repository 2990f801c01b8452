"""What views leave open goes with what is found of the whole scan."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.comparison.placed_notes import beside_views
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.placing.accord import OFFSET, OWN, ViewAccord
from gearwear.placing.together import Taken
from gearwear.placing.views import PlacedScan, View
from tests.report.fake import real_results

MEASURED = real_results().measured
LOOP = MEASURED.loop
NOISE = MEASURED.noise


def views(told: bool = True, shares: np.ndarray | None = None, std: float = 0.0) -> PlacedScan:
    """The scan as if of two views, of the second of which an offset known to `std` was taken out."""
    covariance = np.zeros((OWN, OWN))
    covariance[OFFSET, OFFSET] = std**2
    both = tuple(
        View(MEASURED.placed.registration, 9, 9, 0.0, 0.0, ViewAccord(shared=500, scale_std=1e-5), taken)
        for taken in (Taken(), Taken(offset=0.01, covariance=covariance))
    )
    return replace(MEASURED.placed, views=both, told=told, shares=shares)


def test_effects_of_a_scan_whose_views_do_not_tell_may_be_a_views():
    """A coat or an error of the table may be half of what two views differ by; a form that every tooth has may not."""
    measured = {"coating", "turntable_angle", "scale", "pitch", "axis_offset_lateral"}
    effects = beside_views(LOOP, views(told=False), MEASURED.first, NOISE).effects
    assert {effect.name for effect in effects} & measured
    for effect in effects:
        assert ("view_registration" in effect.alternatives) == (effect.name in measured)
    assert beside_views(LOOP, views(), MEASURED.first, NOISE) is LOOP


def test_what_was_taken_out_is_no_better_known_than_the_overlaps_tell():
    """An offset known to 2 µm, of a view that has a fourth of the points of each flank: 0.5 µm on every cell of flanks, and on their level."""
    shares = np.full((2, MEASURED.gear.teeth, 2), 0.25)
    loop = beside_views(LOOP, views(shares=shares, std=2e-3), MEASURED.first, NOISE)
    flank = MEASURED.first.seen & (MEASURED.first.points.surface == FLANK)
    before = 0.0 if LOOP.hidden is None else (LOOP.hidden**2).sum(axis=1)
    assert np.sqrt((loop.hidden**2).sum(axis=1) - before)[flank] == pytest.approx(np.full(flank.sum(), 5e-4))
    for side in Side:
        assert loop.level_std[side.index] == pytest.approx(math.hypot(LOOP.level_std[side.index], 5e-4))
