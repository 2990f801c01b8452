"""Errors go from one process to another as they are."""

from __future__ import annotations

import pickle
from importlib import import_module

import numpy as np
import pytest

from gearwear.errors import InputError, NotEnoughMemory, NotThisGear

import_module("gearwear.brep.parallel")

MADE = {
    "InputError": InputError("a.ply: is empty"),
    "NotEnoughMemory": NotEnoughMemory("a.ply: needs 5 GB"),
    "NotThisGear": NotThisGear(np.arange(6.0).reshape(2, 3), True, "a.ply: is of another gear"),
    "UsedUp": import_module("gearwear.brep.parallel").UsedUp("no room"),
}


def below(kind: type) -> set[str]:
    """Names of a class and all those made of it."""
    return {kind.__name__}.union(*(below(one) for one in kind.__subclasses__()))


def test_every_kind_is_tried():
    assert below(InputError) == set(MADE)


@pytest.mark.parametrize("name", MADE)
def test_an_error_comes_back_from_another_process(name):
    given = MADE[name]
    back = pickle.loads(pickle.dumps(given))
    assert (type(back), str(back)) == (type(given), str(given))
    if isinstance(given, NotThisGear):
        np.testing.assert_array_equal(back.points, given.points)
        assert back.planar is True
