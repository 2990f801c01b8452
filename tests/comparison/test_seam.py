"""The tooth that the seam of a drift goes through, told as pitch errors: how thick it is, as far as the scan tells."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.comparison.seam import with_seam
from gearwear.comparison.thick import corrected_thickness
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.wear.thickness import SectionThickness
from tests.diagnose.plain import plain_effects
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, make_scan

CLOSURE_DEG = 0.05
TOOTH = 3
INDEX = 0.006
"""mm, standard deviation of the pitch errors."""


@cache
def found_with(start: float, closure: float = CLOSURE_DEG) -> MeasuredGear:
    """A new gear whose pitch varies a little, scanned with a drift that begins so many pitches on, and taken for pitch errors all."""
    gear = designed()
    index = np.random.default_rng(1).normal(0.0, 1e3 * INDEX, gear.teeth)
    drift = Effect("scan_drift", {"closure_deg": closure, "start_deg": start * 360.0 / gear.teeth})
    effects = (Effect("pitch", {"index_um": tuple(index - index.mean())}), drift)
    scan = make_scan(Recipe(jitter=1.0, noise_um=5.0, pose="none", effects=effects).of_size(20_000), 3)
    with plain_effects("scan_drift"):
        found = gw.find_effects(gw.register(Design({"gear": gear}), gw.as_scan(scan.points)))
    assert "scan_drift" in next(one for one in found.loop.effects if one.name == "pitch").alternatives
    return found


def told(start: float, closure: float = CLOSURE_DEG) -> tuple[Gear, SectionThickness, SectionThickness]:
    """Gear and thickness, before and after it is asked for the seam."""
    found = found_with(start, closure)
    thickness = corrected_thickness(found, found.sections)
    return found.gear, thickness, with_seam(found, thickness)


@pytest.mark.parametrize(
    "closure", [CLOSURE_DEG, pytest.param(-CLOSURE_DEG, marks=pytest.mark.long)], ids=["told thin", "told thick"]
)
def test_the_interval_holds_the_tooth_that_the_seam_goes_through(closure):
    gear, told_so, either = told(TOOTH, closure)
    # Errors of pitch leave every tooth as thick as it is drawn; the flanks of this one are apart by the closure.
    by = math.radians(closure) * gear.reference_radius
    assert either.seam is not None and either.seam.tooth == TOOTH
    # A straight line through errors of that size round the gear closes to within √(12 / z) of it.
    assert abs(either.seam.thicker - by) < 3.0 * math.sqrt(12.0 / gear.teeth) * INDEX
    alone, both = told_so.thinnest(), either.thinnest()
    assert both.low < gear.tooth_thickness < both.high
    assert (both.tooth, both.value, both.std) == (alone.tooth, alone.value, alone.std) and both.low <= alone.low
    if closure > 0.0:
        assert alone.high < gear.tooth_thickness - 0.25 * by
    else:  # with the closure taken off it is the thinnest, and known no better than that; of 12 errors the scatter is known to √(1 / 20)
        thinner = told_so.arc + either.seam.thicker * (np.arange(gear.teeth) == TOOTH)[:, None]
        own = replace(told_so, arc=thinner).thinnest()
        share = (own.low - either.seam.low) / (1.96 * math.sqrt(12.0 / gear.teeth) * INDEX)
        assert own.tooth == TOOTH and abs(share - 1.0) < 3.0 * math.sqrt(1.0 / 20.0)
    assert np.array_equal(told_so.arc, either.arc, equal_nan=True) and told_so.teeth() == either.teeth()


@pytest.mark.long
def test_a_seam_in_a_gap_makes_no_tooth_thinner():
    gear, told_so, either = told(TOOTH + 0.5)
    assert either is told_so
    # Nor where another one is the thinnest; of the two beside the gap a thin one may have the seam in it.
    for tooth in {*range(gear.teeth)} - {TOOTH, TOOTH + 1}:
        worn = replace(told_so, arc=told_so.arc - 0.1 * (np.arange(gear.teeth) == tooth)[:, None])
        assert with_seam(found_with(TOOTH + 0.5), worn) is worn
    assert told_so.thinnest().low < gear.tooth_thickness < told_so.thinnest().high


def test_a_seam_in_a_tooth_that_is_not_the_thinnest_changes_no_interval():
    """Of another tooth 0.1 mm is gone: it is the thinnest, drift or not."""
    gear, told_so, _ = told(TOOTH)
    worn = replace(told_so, arc=told_so.arc - 0.1 * (np.arange(gear.teeth) == TOOTH + 4)[:, None])
    either = with_seam(found_with(TOOTH), worn)
    assert either.thinnest() == worn.thinnest() and either.teeth() == worn.teeth()
    assert either.seam.tooth == TOOTH and not either.seam.of_thinnest
