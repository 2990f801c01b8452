"""A relief at the root of coast flanks, beside drive flanks that are worn: cut so, or worn too."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from gearwear.design.side import Side
from gearwear.diagnose.effects.profile_slope import EFFECT as PROFILE_SLOPE
from gearwear.diagnose.effects.root_relief import EFFECT as ROOT_RELIEF
from gearwear.diagnose.loop import _or_wear

LEFT, BOTH = frozenset({Side.LEFT}), frozenset(Side)


def alternatives(effect, worn_sides):
    """The names that `_or_wear` adds to an effect of one amplitude, where nothing else is open."""
    found = SimpleNamespace(
        name=effect.name, kind=effect.kind, candidate=SimpleNamespace(effect=effect, shape=(12.0,)), amplitudes=[0.04],
        lowers_by=lambda flanks, context: 0.0, or_one_of=lambda names: set(names),
    )  # fmt: skip
    taken = SimpleNamespace(worn_sides=worn_sides, context=SimpleNamespace(faces=()))
    return _or_wear(found, taken, (), None)


@pytest.mark.parametrize(
    ("effect", "worn_sides", "told"),
    [
        (ROOT_RELIEF, LEFT, {"sliding_wear"}),
        (ROOT_RELIEF, frozenset(), set()),
        (ROOT_RELIEF, BOTH, set()),
        (PROFILE_SLOPE, LEFT, set()),
    ],
    ids=["beside a worn side", "of a gear without", "of one worn on both", "another effect"],
)
def test_a_root_relief_beside_a_worn_side_may_be_wear_of_the_coast_flanks(effect, worn_sides, told):
    assert alternatives(effect, worn_sides) == told
