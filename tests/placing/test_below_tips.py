"""Points that are taken off the surfaces stay where they lie: they are located again once the scan is known to be distorted."""

from contextlib import nullcontext

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design.pair import Design
from gearwear.design.surface import FLANK, OTHER, locate
from gearwear.placing.low_tips import below_tips
from tests.diagnose.plain import plain_effects
from tests.placing.placing import designed, true_pose
from tests.synthetic import Effect, GearNumbers, Recipe, Texture, make_scan

SMALL = GearNumbers(21, 3.0, 14.5, bore_diameter=22.0)
TOO_SMALL_PPM = -3281.0
FORMS = ("scale", "scale_anisotropic", "tip_relief", "root_relief", "profile_shift", "tip_diameter")
"""What a search beside the plain effects may take for one another here."""


@pytest.fixture(scope="module")
def shrunk():
    """A scan that is a third of a per cent too small, of a gear with pitch errors."""
    index = Effect("pitch", {"index_um": tuple(20.0 * np.cos(np.arange(21.0) ** 2))})
    scale, texture = Effect("scale", {"relative_ppm": TOO_SMALL_PPM}), Texture(6.6, 0.64, "exponential")
    recipe = Recipe(SMALL, effects=(scale, index), texture=texture, pose="mild", noise_um=11.0, ends="none", lost=0.044)
    return make_scan(recipe.of_size(20_000), 1)


def test_points_higher_than_the_tips_stay_where_they_lie(shrunk):
    gear, points = designed(SMALL), true_pose(shrunk).apply(shrunk.points)
    located = locate(points, gear)
    off = below_tips(located, gear, 0.011)
    taken = (located.surface == FLANK) & (off.surface == OTHER)
    assert taken.sum() > 100
    np.testing.assert_allclose(off.measured, points, atol=1e-12)
    np.testing.assert_array_equal(off.position[taken], off.measured[taken])
    assert np.isnan(off.deviation[taken]).all() and np.isnan(off.roll[taken]).all() and not off.side[taken].any()


@pytest.mark.parametrize("effects", [FORMS, pytest.param(None, marks=pytest.mark.long)], ids=["plain", "all"])
def test_a_scan_too_small_is_that_and_has_no_form(shrunk, effects):
    """The lands next to the corners were laid on the drawn flanks, and the root fitted first to the fillets of a smaller gear: a relief, a crowning and another
    relief in place of the scale."""
    with plain_effects(*effects) if effects else nullcontext():
        loop = find_effects(register(Design({"gear": designed(SMALL)}), as_scan(shrunk.points)), frozenset()).loop
    named = {effect.name: effect for effect in loop.effects}
    assert set(named) == {"scale", "pitch"}
    known = named["scale"].parameters["relative_ppm"]
    assert abs(known.value - TOO_SMALL_PPM) < 4.0 * known.std
