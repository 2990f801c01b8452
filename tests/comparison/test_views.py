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


def views(told: bool = True, shares: np.ndarray | None = None, std: float = 0.0) -> PlacedScan:
    """The scan as if of two views, of the second of which an offset known to `std` was taken out."""
    placed, covariance = real_results().measured.placed, np.zeros((OWN, OWN))
    covariance[OFFSET, OFFSET] = std**2
    both = tuple(
        View(placed.registration, 9, 9, 0.0, 0.0, ViewAccord(shared=500, scale_std=1e-5), taken)
        for taken in (Taken(), Taken(offset=0.01, covariance=covariance))
    )
    return replace(placed, views=both, told=told, shares=shares)


def test_effects_of_a_scan_whose_views_do_not_tell_may_be_a_views():
    """A coat or an error of the table may be half of what two views differ by; a form that every tooth has may not."""
    scanners = {"coating", "turntable_angle", "scale", "pitch", "axis_offset_lateral"}
    measured = real_results().measured
    effects = beside_views(measured.loop, views(told=False), measured.first, measured.noise).effects
    assert {effect.name for effect in effects} & scanners
    for effect in effects:
        assert ("view_registration" in effect.alternatives) == (effect.name in scanners)
    assert beside_views(measured.loop, views(), measured.first, measured.noise) is measured.loop


def test_what_was_taken_out_is_no_better_known_than_the_overlaps_tell():
    """An offset known to 2 µm, of a view that has a fourth of the points of each flank: 0.5 µm on every cell of flanks, and on their level."""
    measured = real_results().measured
    was = measured.loop
    shares = np.full((2, measured.gear.teeth, 2), 0.25)
    loop = beside_views(was, views(shares=shares, std=2e-3), measured.first, measured.noise)
    flank = measured.first.seen & (measured.first.points.surface == FLANK)
    before = 0.0 if was.hidden is None else (was.hidden**2).sum(axis=1)
    assert np.sqrt((loop.hidden**2).sum(axis=1) - before)[flank] == pytest.approx(np.full(flank.sum(), 5e-4))
    for side in Side:
        assert loop.level_std[side.index] == pytest.approx(math.hypot(was.level_std[side.index], 5e-4))
