from dataclasses import replace

import numpy as np
import pytest

from benchmarks.loop_study.run import study
from benchmarks.loop_study.scenario import Scenario
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from gearwear.diagnose.effects.thickness_variation import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet
from tests.synthetic import Effect, Recipe


def example(gear, follow):
    thicker = 30.0 * np.cos(2.3 * np.arange(gear.teeth))
    thicker -= thicker.mean()
    return Example({"thickness_um": tuple(thicker.tolist())}, tuple((1e-3 * thicker[:-1]).tolist()), (follow,), gear)


EXAMPLES = [example(BORED, 1.0), example(ODD, 0.0)]


def displace(sample, parameters, shape):
    """Both sides of each tooth turned away from its middle by half its arc at the reference circle."""
    thicker = 1e-3 * np.array(parameters["thickness_um"])[sample.tooth]
    return sample.cut(0.5 * sample.side * thicker / sample.outline.reference_radius, fillets=shape[0])


def test_pitch_and_thickness_are_the_index_of_left_and_of_right_flanks():
    """F_left = F + s / 2 and F_right = F − s / 2, whatever these are: their span is that of an arc for each flank."""
    points, about = feet(), context()
    both = np.hstack([PITCH.basis(points, about, (0.0,)), EFFECT.basis(points, about, (0.0,))])
    flank = points.surface == 0
    rng = np.random.default_rng(1)
    index = rng.normal(size=(2, 12))
    index -= index.mean(axis=1, keepdims=True)
    side = np.where(points.side > 0, 0, 1)
    arc = about.gear.base_radius / about.gear.reference_radius
    moved = np.where(flank, arc * points.side * index[side, points.tooth], 0.0)
    left = moved - both @ np.linalg.lstsq(both[flank], moved[flank], rcond=None)[0]
    assert np.abs(left[flank]).max() < 1e-9


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.long), pytest.param(5, marks=pytest.mark.long)])
def test_left_and_right_pitch_of_their_own_are_no_error_of_the_table(seed):
    """They were a wave of the table, a view that turned and a drift, and taken out of the pitch."""
    rng = np.random.default_rng(seed)
    amounts = {name: rng.normal(0.0, 4.0, 12) for name in ("index_um", "thickness_um")}
    index, thicker = (tuple((values - values.mean()).tolist()) for values in amounts.values())
    made = (Effect("pitch", {"index_um": index}), Effect("thickness_variation", {"thickness_um": thicker}))
    recipe = replace(Recipe(noise_um=3.0, jitter=1.0, pose="any", effects=made).of_size(20_000))
    told = study(Scenario("test", recipe, seed, mate=False))[0]
    assert {found["name"] for found in told["found"]} == {"pitch", "thickness_variation"}
    assert told["wear"]["after"] == 0.0 and told["patterns"] == []
    for true in told["true"]:
        for error in true["errors"].values():
            assert np.all(np.abs(error["error"]) < 4.5 * np.array(error["std"]))  # of 24 amounts


def test_thin_teeth_whose_fillets_are_as_drawn_may_have_worn_evenly():
    amounts = np.zeros(context().gear.teeth - 1)
    assert EFFECT.like_even_wear(amounts, (0.0,), context())
    assert not EFFECT.like_even_wear(amounts, (1.0,), context())  # cut so, fillets and all
    assert not EFFECT.like_even_wear(amounts, (0.0,), replace(context(), fillets_told=False))
