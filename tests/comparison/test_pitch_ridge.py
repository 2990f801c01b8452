"""A driven gear on which metal flowed to the pitch line: what it lost is counted as if the ridge were not there to be counted from."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.comparison.notes import worn_notes
from gearwear.comparison.stations import compare
from gearwear.design import read_design
from gearwear.design.side import Side
from tests.commands.doors import scan_file
from tests.synthetic import Effect, GearNumbers, Recipe, SlidingWear
from tests.synthetic.outline import Outline

GEAR = GearNumbers(teeth=28, module=3.0, face_width=20.0)
DESIGN = "[gear]\nteeth = 28\nmodule = 3\nface_width = 20\nrack_tip_radius = 0.3\n"
WIDTH = 0.6
"""mm."""


def below_nominal(depth_um: float, height_um: float, width: float = WIDTH) -> float:
    """What lies below the flanks as drawn, mm³: ∫ d / r_b L dL on each, d what sliding took less the ridge, where that is above 0."""
    outline = Outline.of(GEAR)
    roll = np.linspace(outline.form_roll, outline.tip_roll, 20001)
    pitch, form = outline.reference_roll, outline.form_roll
    lost = depth_um * np.abs(roll - pitch) / (pitch - form) * form / roll
    ridge = height_um * np.exp(-0.5 * ((roll - pitch) / width) ** 2)
    missing = 1e-3 * np.maximum(lost - ridge, 0.0) * roll / outline.base_radius
    return float(np.trapezoid(missing, roll)) * GEAR.face_width * GEAR.teeth


@pytest.mark.long  # tests/wear/test_ridge.py has the rule on flanks laid flat
@pytest.mark.parametrize(("depth", "height"), [(50.0, 15.0), (25.0, 25.0)])
def test_a_ridge_is_no_thicker_tooth(tmp_path, depth, height):
    wear = (SlidingWear(depth, law="archard"),)
    effects = (Effect("pitch_ridge", {"height_um": height, "width_mm": WIDTH}),)
    recipe = Recipe(gear=GEAR, jitter=1.0, noise_um=5.0, pose="none", wear=wear, effects=effects)
    files, _ = scan_file(tmp_path, "ridge", recipe.of_size(100_000), 3)
    design = tmp_path / "design.toml"
    design.write_text(DESIGN)
    results = compare(read_design(design), files, inspection=False)
    truth, found = below_nominal(depth, height), results.wear.found
    assert abs(found.volume - truth) <= 2.0 * found.volume_std
    low, high, why = results.volume_range
    # Were all of it thicker teeth, every flank would have lost the ridge's height, in its column's mean.
    assert low <= truth <= high < truth + 0.5 * below_nominal(0.0, -height, math.inf)
    assert "plastic flow" in why
    (ridge,) = found.ridges
    assert ridge.side is Side.LEFT
    assert abs(ridge.height - 1e-3 * height) < 3.0 * ridge.std < 0.7e-3 * height
    assert found.proud == (0.0, 0.0)
    assert any("ridge" in note for note in worn_notes(results.measured, found))
