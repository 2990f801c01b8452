"""A root is asked again once a scale is known: a scan that is too large shows another root than the gear has."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from tests.placing.placing import designed
from tests.synthetic import PINION, Effect, Recipe, make_scan

TOO_LARGE_PPM = 4500.0
AS_CUT = PINION.rack_tip_radius


@pytest.mark.parametrize(
    "drawn", [AS_CUT, pytest.param(AS_CUT - 0.1, marks=pytest.mark.long)], ids=["drawing right", "drawing wrong"]
)
def test_a_scale_bends_no_root(drawn):
    gear = Gear.from_spec(replace(designed().spec, rack_tip_radius=drawn))
    recipe = Recipe(noise_um=6.0, jitter=1.0, pose="any", effects=(Effect("scale", {"relative_ppm": TOO_LARGE_PPM}),))
    placed = register(Design({"gear": gear}), as_scan(make_scan(recipe.of_size(20_000), 13).points))
    # told from the scan as it is: the radius grows with the scale, and with how far the flanks below it moved
    assert not placed.root.fits_design
    assert abs(placed.root.rack_tip_radius - AS_CUT) > 0.015

    measured = find_effects(placed)

    assert [effect.name for effect in measured.loop.effects] == ["scale"]
    assert measured.loop.effects[0].amplitudes[0] == pytest.approx(1e-6 * TOO_LARGE_PPM, abs=4e-6)
    assert measured.root.rack_tip_radius == pytest.approx(AS_CUT, abs=0.003)
    assert measured.root.fits_design == (drawn == AS_CUT)
    root = [form.amplitudes for form in measured.loop.form if form.name == "root_form"]
    assert all(np.abs(levels).max() < 2e-3 for levels in root)  # 0.1 mm where the root was taken for another one
