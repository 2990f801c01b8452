"""Scans of flanks and nothing else, of both sides or one, that slid on the left: what was lost is in the range that is told."""

from __future__ import annotations

import pytest

import gearwear as gw
from gearwear.comparison.open_volume import Open
from gearwear.design.pair import Design
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, locate
from gearwear.errors import InputError
from gearwear.report.words.verdict import verdict
from tests.diagnose.plain import plain_effects
from tests.placing.placing import designed
from tests.synthetic import Recipe, SlidingWear, make_scan

GEAR = designed()
ALONE = Design({"gear": GEAR})
SLID = (SlidingWear(60.0, 1),)


def flanks(*sides, wear=SLID, seed=3):
    """Points on the flanks of some sides as a scan, and the volume lost of them."""
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear).of_size(20_000), seed)
    located = locate(scan.points, GEAR)
    seen = (located.surface == FLANK) & [Side.of(side) in sides if side else False for side in located.side.tolist()]
    return gw.as_scan(scan.points[seen]), scan.truth.volume_mm3


@pytest.mark.parametrize("sides", [(Side.LEFT,), tuple(Side)], ids=["one side", "both"])
def test_what_was_lost_is_in_the_range(sides):
    scan, truth = flanks(*sides)
    with plain_effects():
        results = gw.compare(ALONE, scan, inspection=False)
    low, high, _ = results.volume_range
    assert low <= truth <= high
    assert "worn throughout or were made so" in verdict(results)
    if len(sides) == 1:
        assert results.open_volume.widest is Open.BARE
        assert any("without the left flanks nothing holds the gear" in note for note in results.notes)


def test_sides_without_which_nothing_was_seen_are_refused():
    measured = gw.register(ALONE, flanks(*Side)[0])
    with pytest.raises(InputError, match="without the left and right flanks nothing was seen that holds the gear"):
        gw.find_effects(measured, worn=frozenset(Side))


@pytest.mark.long
def test_with_a_scan_before_wear_it_is_the_difference():
    """Of both sides, which slid: without them the worn scan has nothing that holds it, and stands as it does."""
    worn, truth = flanks(*Side, wear=(*SLID, SlidingWear(60.0, -1)))
    before, _ = flanks(*Side, wear=(), seed=4)
    with plain_effects():
        results = gw.compare(ALONE, worn, before=before, inspection=False)
    assert {region.side for region in results.wear.regions} == set(Side)
    assert abs(results.wear.volume - truth) < 3.0 * results.wear.volume_std
