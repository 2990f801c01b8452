"""A tooth that an overload bent: the flank that lies low for that lost nothing, and what was lost besides is what was taken."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.stations import compare
from gearwear.design.pair import Design
from gearwear.diagnose import loop
from gearwear.diagnose.bent_teeth import Bent
from gearwear.report.records.comparison import document
from gearwear.report.words.effects import found_words
from tests.commands.doors import ALONE, scan_file
from tests.diagnose.plain import plain_effects
from tests.synthetic import Effect, Patch, Recipe, SlidingWear
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch as HelicalPatch

TOOTH = 4
LOW = Patch(TOOTH, -1, 80.0, (37.0, 43.0), (2.0, 12.0))
"""On the flank that lies low once its tooth is bent counter-clockwise."""


def bent(tip_um, power=1.5):
    return Effect("bend", {"tooth": TOOTH, "tip_um": tip_um, "power": power})


def results(folder, *effects, wear=(), seed=3, plain=True, before=None):
    recipe = Recipe(jitter=1.0, noise_um=8.0, pose="none", wear=wear, effects=effects).of_size(40_000)
    files, made = scan_file(folder, "worn", recipe, seed)
    earlier = [] if before is None else scan_file(folder, "unworn", before, seed + 1)[0]
    with plain_effects("bent_tooth") if plain else nullcontext():
        return compare(ALONE, files, inspection=False, before=earlier), made.truth


@pytest.mark.parametrize("plain", [True, pytest.param(False, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(bent(30.0, 1.0), marks=pytest.mark.long, id="straight"),
        pytest.param(Effect("hinge", {"tooth": TOOTH, "tip_um": -100.0}), id="hinge"),
    ],
)
def test_by_itself_it_is_named_and_nothing_is_worn(tmp_path, effect, plain):
    """A hinge moves the tooth at its form circle too: that is no pitch error of the gear."""
    found, _ = results(tmp_path, effect, plain=plain)
    (one,) = found.measured.loop.effects
    assert one.name == "bent_tooth" and one.parameters["number"].value == TOOTH + 1.0
    tip = one.parameters["tip_um"]
    assert abs(tip.value - effect["tip_um"]) < 3.0 * tip.std < 3.0
    hand = "counter-clockwise" if effect["tip_um"] > 0.0 else "clockwise"
    assert found_words(one).startswith(f"tooth {TOOTH + 1} bent {hand}, by ")
    (told,) = document(found)["closed_loop"]["effects"]
    assert told["name"] == "bent_tooth" and told["parameters"]["tip_um"]["value"] == pytest.approx(tip.value, rel=1e-3)
    assert found.wear.regions == () and found.wear.found.volume == 0.0
    # As thick as it was: thinner than the others by no more than chance.
    tooth = found.wear.thickness.teeth()[TOOTH]
    assert abs(tooth.greatest_loss) < 3.0 * tooth.loss_std


@pytest.mark.long
def test_two_beside_each_other_are_both_told(tmp_path):
    two = [Effect("bend", {"tooth": TOOTH + i, "tip_um": tip, "power": 1.5}) for i, tip in enumerate((40.0, 60.0))]
    found, _ = results(tmp_path, *two, plain=False)
    told = {int(one.parameters["number"].value): one.parameters["tip_um"] for one in found.measured.loop.effects}
    assert set(told) == {TOOTH + 1, TOOTH + 2}
    for number, true in ((TOOTH + 1, 40.0), (TOOTH + 2, 60.0)):
        assert abs(told[number].value - true) < 3.0 * told[number].std < 6.0
    assert found.wear.regions == ()


def test_one_that_a_first_look_takes_for_bent_and_the_loop_does_not_has_an_index_like_the_others(tmp_path, monkeypatch):
    monkeypatch.setattr(loop, "bent_teeth", lambda cells: (Bent(TOOTH, (0.03, 0.02, 0.0)),))
    index = [0.0, 12.0, -8.0, 15.0, 0.0, -11.0, 3.0, 15.0, 9.0, -14.0, -6.0, -15.0]
    files, _ = scan_file(
        tmp_path,
        "cut",
        Recipe(jitter=1.0, noise_um=8.0, pose="none", effects=(Effect("pitch", {"index_um": index}),)).of_size(40_000),
        3,
    )
    with plain_effects("bent_tooth", "pitch"):
        found = compare(ALONE, files, inspection=False)
    assert found.measured.loop.context.bent == ()
    (one,) = found.measured.loop.effects
    assert one.name == "pitch"
    told = one.parameters["index_um"]
    assert abs(told.value[TOOTH] - index[TOOTH]) < 3.0 * told.std[TOOTH] < 3.0


@pytest.mark.parametrize("plain", [True, pytest.param(False, marks=pytest.mark.long)])
def test_one_that_bent_more_at_one_end_lost_nothing_there(tmp_path, plain):
    """Sixty micrometres at the upper end and none at the lower."""
    found, _ = results(tmp_path, Effect("bend_at_end", {"tooth": TOOTH, "tip_um": 30.0, "power": 1.0}), plain=plain)
    (one,) = found.measured.loop.effects
    assert one.name == "bent_tooth"
    tip, lean = one.parameters["tip_um"], one.parameters["tip_lean_um"]
    assert abs(tip.value - 30.0) < 3.0 * tip.std < 3.0
    assert abs(lean.value - 60.0) < 3.0 * lean.std < 9.0
    assert found.wear.regions == () and found.wear.found.volume == 0.0


@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.long), pytest.param(5, marks=pytest.mark.long)])
def test_wear_of_the_flank_that_lies_low_is_what_was_taken(tmp_path, seed):
    found, truth = results(tmp_path, bent(40.0), wear=(LOW,), seed=seed)
    assert [effect.name for effect in found.measured.loop.effects] == ["bent_tooth"]
    (region,) = found.wear.regions
    assert (region.tooth, int(region.side)) == (TOOTH, -1)
    assert abs(region.volume - truth.volume_mm3) < 3.0 * region.volume_std < 0.25 * truth.volume_mm3
    assert abs(region.max_depth - 0.080) < 0.015


@pytest.mark.long
def test_a_side_worn_throughout_beside_it_is_what_was_taken(tmp_path):
    found, truth = results(tmp_path, bent(40.0), wear=(SlidingWear(100.0, law="archard"),), plain=False)
    assert [effect.name for effect in found.measured.loop.effects] == ["bent_tooth"]
    assert abs(found.wear.found.volume - truth.volume_mm3) < 3.0 * found.wear.found.volume_std
    assert {region.side for region in found.wear.regions} == {gw.Side.LEFT}


@pytest.mark.long
@pytest.mark.parametrize("plain", [True, False])
def test_wear_of_one_flank_alone_is_no_bend(tmp_path, plain):
    """All over the flank, to the tip."""
    wear = (Patch(TOOTH, -1, 60.0, (34.0, 44.0), (-1.0, 16.0)),)
    found, truth = results(tmp_path, wear=wear, plain=plain)
    assert found.measured.loop.effects == ()
    (region,) = found.wear.regions
    assert abs(region.volume - truth.volume_mm3) < 3.0 * region.volume_std


@pytest.mark.long
def test_what_bent_since_a_scan_of_the_unworn_gear_is_no_wear_either(tmp_path):
    before = Recipe(jitter=1.0, noise_um=8.0, pose="none").of_size(40_000)
    found, truth = results(tmp_path, bent(40.0), wear=(LOW,), plain=False, before=before)
    (region,) = found.wear.regions
    assert (region.tooth, int(region.side)) == (TOOTH, -1)
    assert abs(region.volume - truth.volume_mm3) < 3.0 * region.volume_std


@pytest.mark.parametrize("tip", [0.04, pytest.param(-0.06, marks=pytest.mark.long)])
def test_on_a_helical_gear(tip):
    gear = Helical(teeth=17, helix=-18.0, width=12.0)
    patch = HelicalPatch(TOOTH, -1 if tip > 0.0 else 1, 0.15, (4.0, 14.0), (0.5, 11.5))
    cloud = scan(gear, 40_000, noise=0.006, seed=5, wear=(patch,), bent={TOOTH: tip})
    with plain_effects("bent_tooth"):
        measured = gw.find_effects(gw.register(Design({"gear": designed(gear)}), gw.as_scan(cloud.points)))
    (effect,) = measured.loop.effects
    assert effect.name == "bent_tooth"
    moved = effect.parameters["tip_um"]
    assert moved.value == pytest.approx(1e3 * tip, abs=3.0 * moved.std) and moved.std < 3.0
    assert effect.parameters["number"].value == TOOTH + 1.0
    wear = gw.find_wear(measured)
    (region,) = wear.regions
    assert (region.tooth, int(region.side)) == (TOOTH, patch.side)
    assert region.volume == pytest.approx(gear.volume(patch), abs=3.0 * region.volume_std)
    assert np.isfinite(wear.volume)
