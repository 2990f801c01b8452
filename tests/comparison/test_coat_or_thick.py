"""Thick teeth or a coat, on flanks alone: what is said of the thinnest tooth holds for both."""

from __future__ import annotations

import pytest

import gearwear as gw
from gearwear.comparison.thick import corrected_thickness
from gearwear.design.pair import Design
from gearwear.design.surface import FLANK, locate
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, make_scan

THICK = 0.040
"""mm of arc; a coat of half of that over cos α on either side looks the same."""


@pytest.mark.parametrize(
    ("effect", "thicker"),
    [
        (Effect("coating", {"thickness_um": 20.0}), 0.0),
        pytest.param(Effect("tooth_thickness", {"thickness_um": 1e3 * THICK}), THICK, marks=pytest.mark.long),
    ],
    ids=["coat", "thick teeth"],
)
def test_the_thinnest_tooth_is_known_no_better_than_what_made_it_so(effect, thicker):
    gear = designed()
    scan = make_scan(Recipe(jitter=1.0, noise_um=5.0, pose="none", effects=(effect,)).of_size(20_000), 3)
    flanks = scan.points[locate(scan.points, gear).surface == FLANK]
    found = gw.find_effects(gw.register(Design({"gear": gear}), gw.as_scan(flanks)))
    (either,) = found.loop.either
    thinnest = corrected_thickness(found, found.sections).thinnest()
    assert thinnest.low < gear.tooth_thickness + thicker < thinnest.high
    # Its own interval alone does not hold both.
    assert 2.0 * 1.96 * thinnest.std < THICK < thinnest.high - thinnest.low < 1.5 * THICK
    assert {either.name, *either.alternatives} & {"coating", "tooth_thickness"}
