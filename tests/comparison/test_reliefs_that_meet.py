"""A tip and a root relief on all flanks: of a profile that was cut, or of one that slid on both sides down from the pitch point."""

from __future__ import annotations

import pytest

from gearwear.comparison.stations import compare
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from tests.commands.doors import ALONE, scan_file
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, SlidingWear

AMOUNT = 50.0


def missing(gear: Gear, tip: float, root: float) -> float:
    """Metal between the design's flanks and those with both reliefs, mm³, by strips of equal roll: dA = L dL / r_b."""
    rolls = [gear.form_roll + (i + 0.5) / 4000 * (gear.tip_roll - gear.form_roll) for i in range(4000)]
    strip = (gear.tip_roll - gear.form_roll) / 4000
    depth = [
        1e-3 * AMOUNT * (max(0.0, roll - tip) / (gear.tip_roll - tip) + max(0.0, root - roll) / (root - gear.form_roll))
        for roll in rolls
    ]
    return (
        2 * gear.teeth * gear.face_width * sum(d * roll / gear.base_radius * strip for d, roll in zip(depth, rolls, strict=True))
    )


@pytest.mark.long
@pytest.mark.parametrize(("tip", "root", "meet"), [(13.0, 13.0, True), (18.5, 8.0, False)])
def test_the_loss_is_not_excluded_where_nothing_is_left_between_them(tmp_path, tip, root, meet):
    gear = designed()
    made = tuple(
        Effect(f"{end}_relief", {"amount_um": AMOUNT, "start_mm": start}) for end, start in (("tip", tip), ("root", root))
    )
    file, _ = scan_file(tmp_path, "scan", Recipe(jitter=1.0, noise_um=5.0, effects=made).of_size(40_000), 3)
    results = compare(ALONE, file, inspection=False)
    found = {effect.name: effect for effect in results.effects}
    assert {"tip_relief", "root_relief"} <= found.keys()
    high = 0.0 if results.volume_range is None else results.volume_range[1]
    lost = missing(gear, tip, root)
    assert (high > lost) == meet and high < 1.5 * lost
    assert all(("sliding_wear" in found[name].alternatives) == meet for name in ("tip_relief", "root_relief"))


@pytest.mark.long
def test_nor_is_that_of_the_other_side_of_one_that_is_worn(tmp_path):
    """Both sides lack 50 µm at either end, and the left ones slid deeper: what both lack alike is told as reliefs, and may be wear."""
    gear = designed()
    made = tuple(Effect(f"{end}_relief", {"amount_um": AMOUNT, "start_mm": 13.0}) for end in ("tip", "root"))
    recipe = Recipe(jitter=1.0, noise_um=5.0, effects=made, wear=(SlidingWear(120.0, 1),))
    file, scan = scan_file(tmp_path, "scan", recipe.of_size(40_000), 3)
    results = compare(ALONE, file, inspection=False)
    assert {"tip_relief", "root_relief"} <= {effect.name for effect in results.effects}
    assert results.measured.worn_sides == {Side.LEFT}
    assert results.volume_range is not None and results.volume_range[1] > missing(gear, 13.0, 13.0) + 0.9 * scan.truth.volume_mm3
