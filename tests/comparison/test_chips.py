"""Chips of edges: all that are alike are told alike, and no metal is counted as broken off and as worn."""

from __future__ import annotations

import pytest

import gearwear as gw
from gearwear.design.pair import Design
from tests.placing.placing import designed
from tests.synthetic import Patch, Recipe, make_scan

CHIPS = {
    "broken corner": tuple(Patch(tooth, 1, 420.0, (39.0, 50.0), (-0.9, 0.9), 0.4) for tooth in (0, 3, 4, 7, 8, 10)),
    "chipped edge": tuple(Patch(tooth, 1, 420.0, (43.4, 50.0), (-20.0, 40.0), 0.2) for tooth in (4, 9)),
}


@pytest.mark.long
@pytest.mark.parametrize("kind", CHIPS)
def test_a_chip_is_told_once_and_one_way(kind):
    scan = make_scan(Recipe(jitter=1.0, noise_um=5.0, wear=CHIPS[kind]).of_size(60_000), 5)
    measured = gw.find_effects(gw.register(Design({"gear": designed()}), gw.as_scan(scan.points)), frozenset())
    wear = gw.find_wear(measured)
    assert [(one.kind, one.flank) for one in measured.broken] == [(kind, "left")] * len(CHIPS[kind])
    assert not wear.regions and not wear.edges
    std = sum(one.std**2 for one in measured.broken) ** 0.5
    assert sum(one.volume for one in measured.broken) == pytest.approx(scan.truth.volume_mm3, abs=3.0 * std)
    assert max(one.depth for one in wear.flanks if one.says) < 0.05
