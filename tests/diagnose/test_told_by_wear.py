"""Taper or helix slope, where fillets do not turn with the flanks and one side is worn: the worn side tells, by how it would have to be worn."""

from contextlib import nullcontext

import numpy as np
import pytest

from benchmarks.loop_study.run import study
from benchmarks.loop_study.scenario import Scenario
from gearwear.api import as_scan
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design.pair import Design
from gearwear.design.side import Side
from gearwear.diagnose.told_by_wear import _likelier, told_by_wear
from tests.diagnose.plain import PLAIN_AND_ALL, plain_effects
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, make_scan
from tests.synthetic.removal import SlidingWear


def one(effect, searched):
    recipe = Recipe(
        noise_um=8.0, jitter=1.0, pose="any", fillets_follow=False, effects=(effect,), wear=(SlidingWear(50.0, side=-1),)
    )
    with plain_effects() if searched else nullcontext():
        return study(Scenario("test", recipe.of_size(20_000), 5, mate=False))[0]


@PLAIN_AND_ALL
@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(Effect("taper", {"taper_um": 30.0}), marks=pytest.mark.long),
        Effect("helix_slope", {"slope_um": 30.0}),
        pytest.param(Effect("taper", {"taper_um": -60.0}), marks=pytest.mark.long),
        pytest.param(Effect("helix_slope", {"slope_um": -60.0}), marks=pytest.mark.long),
    ],
    ids=lambda effect: f"{effect.name} {next(iter(effect.parameters.values())):g}",
)
def test_the_worn_side_tells_what_the_sound_one_cannot(effect, effects):
    told = one(effect, effects)

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


def test_a_worn_side_that_hardly_any_tooth_shows_tells_nothing():
    """A third of the teeth, as one view sees them: the choice stays the search's, and nothing fails."""
    recipe = Recipe(
        noise_um=8.0, jitter=1.0, pose="none", fillets_follow=False, effects=(Effect("taper", {"taper_um": 30.0}),),
        wear=(SlidingWear(50.0, side=-1),),
    ).of_size(30_000)  # fmt: skip
    points = make_scan(recipe, 5).points
    seen = np.abs(np.arctan2(points[:, 1], points[:, 0])) < np.pi / 3.0
    measured = find_effects(register(Design({"gear": designed()}), as_scan(points[seen])), worn=frozenset({Side.RIGHT}))
    assert {effect.name for effect in measured.loop.effects} & {"taper", "helix_slope"}


@pytest.mark.parametrize("scale", [1.0, 300.0])
def test_that_less_is_left_tells_by_what_is_left_of_each_cell(scale):
    """Wear that has not the shape it is asked for leaves 300 times the noise: 50 of 15,000 are no evidence, where 50 of 100 are, 15,000 of 45,000 too."""
    assert _likelier([(150.0 * scale, 100.0), (100.0 * scale, 100.0)]) == 1
    assert _likelier([(100.0 * scale + 50.0, 100.0), (100.0 * scale, 100.0)]) == (1 if scale == 1.0 else None)
    assert _likelier([(100.0 * scale, 100.0), (150.0 * scale, 100.0)]) is None
    assert _likelier([(60.0, 100.0), (45.0, 100.0)]) == 1  # less than noise is no reason to believe more
    assert _likelier([(0.0, 0.0), (0.0, 0.0)]) is None
