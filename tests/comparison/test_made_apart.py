"""A gear worn on both sides of which teeth were cut apart: what each tooth lost is known no better than how thick it was."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.comparison.stations import compare
from tests.commands.doors import ALONE, scan_file
from tests.synthetic import Effect, Recipe, SlidingWear


@pytest.mark.long
def test_the_loss_of_a_tooth_is_known_as_well_as_how_it_was_made(tmp_path):
    random = np.random.default_rng(3)
    shares = [tuple(random.uniform(0.8, 1.2, 12)) for _ in range(2)]
    wear = (SlidingWear(70.0, 1, shares[0]), SlidingWear(45.0, -1, shares[1]))
    index, thickness = (tuple(random.normal(0.0, 8.0, 12)) for _ in range(2))
    effects = (Effect("pitch", {"index_um": index}), Effect("thickness_variation", {"thickness_um": thickness}))
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=effects, fillets_follow=False)
    files, scan = scan_file(tmp_path, "both", recipe.of_size(30_000), 3)
    results = compare(ALONE, files, inspection=False)
    assert len(results.measured.worn_sides) == 2
    lost = dict.fromkeys(range(12), 0.0)
    for flank in scan.truth.flanks:
        lost[flank.tooth] += flank.thickness_loss_mm
    teeth = results.wear.thickness.teeth()
    off = np.array([(tooth.greatest_loss - lost[tooth.tooth]) / tooth.loss_std for tooth in teeth])
    assert (np.abs(off) < 2.0).sum() >= 9
    assert np.median([tooth.loss_std for tooth in teeth]) > 1.5 * np.median([tooth.least_std for tooth in teeth])
