"""Taper or helix slope, where fillets do not turn with the flanks and one side is worn: the worn side tells, by how it would have to be worn."""

import pytest

from benchmarks.loop_study.run import study
from benchmarks.loop_study.scenario import Scenario
from gearwear.diagnose.told_by_wear import told_by_wear
from tests.synthetic import Effect, Recipe
from tests.synthetic.removal import SlidingWear


def one(effect):
    recipe = Recipe(
        noise_um=8.0, jitter=1.0, pose="any", fillets_follow=False, effects=(effect,), wear=(SlidingWear(50.0, side=-1),)
    )
    return study(Scenario("test", recipe.of_size(20_000), 5, mate=False))[0]


@pytest.mark.parametrize(
    "effect",
    [
        Effect("taper", {"taper_um": 30.0}),
        Effect("helix_slope", {"slope_um": 30.0}),
        pytest.param(Effect("taper", {"taper_um": -60.0}), marks=pytest.mark.long),
        pytest.param(Effect("helix_slope", {"slope_um": -60.0}), marks=pytest.mark.long),
    ],
    ids=lambda effect: f"{effect.name} {next(iter(effect.parameters.values())):g}",
)
def test_the_worn_side_tells_what_the_sound_one_cannot(effect):
    told = one(effect)

    assert [found["name"] for found in told["found"]] == [effect.name]
    (found,) = told["found"]
    assert set(found["alternatives"]) == {"taper", "helix_slope"} - {effect.name}  # which rests on wear, and is said to
    assert abs(told["wear"]["after"] - told["wear"]["true"]) < 0.05 * told["wear"]["true"]


def test_without_a_worn_side_nothing_is_asked():
    class NoneWorn:
        class context:
            worn = frozenset()

    model = (object(),)
    assert told_by_wear(None, NoneWorn, model) is model
