"""How a helical pair ran, from a whole scan: worn by a model of elastic teeth that shares nothing with the package, under a coat."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.comparison.stations import compare
from gearwear.design import Design, PairSpec
from gearwear.design.load import LoadSpec
from gearwear.design.pair import check_pair
from tests.running.helical_maps import LOAD, gears, ran
from tests.synthetic.helical import scan

GAP, COAT = 30.0, 0.010


@pytest.mark.long
def test_the_gap_put_in_is_asked_back_beside_the_coat(tmp_path):
    wear = ran(gap_um=GAP)
    points = scan(
        wear.gear, 50_000, noise=0.006, seed=3, coat=COAT,
        added=lambda side, roll, z: -wear.depth(side, roll, z) / wear.gear.base_cos,
    ).points  # fmt: skip
    np.savetxt(tmp_path / "scan.xyz", points, fmt="%.5f")
    pinion, gear = gears(wear)
    pair = PairSpec(pinion.reference_radius + gear.reference_radius)
    design = Design({"pinion": pinion, "gear": gear}, pair, check_pair(pinion, gear, pair), load=LoadSpec(load_per_width=LOAD))
    found = compare(design, [tmp_path / "scan.xyz"], part="pinion", inspection=False)
    assert [effect.name for effect in found.measured.loop.effects] == ["coating"]
    second = found.pair.second_loop
    assert second is not None, found.pair.running
    named = second.effect("misalignment")
    assert named is not None and {effect.name for effect in second.effects} <= {"misalignment", "elastic_sharing"}
    size = named.parameters["gap_um"]
    assert abs(size.value - GAP) < min(10.0, 2.0 * size.std)
