from dataclasses import replace

import numpy as np

from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.effects.face_level import EFFECT
from tests.diagnose.sample import Example, context, feet

LEVELS = (12.0, -7.0, 4.0, -9.0)
"""Level, lead and crowning of the left flanks, which stand as made at both ends; the level of the right ones, which do at one."""
EXAMPLES = [Example({"level_um": LEVELS}, tuple(1e-3 * level for level in LEVELS))]


def displace(sample, parameters, shape):
    """Left flanks pushed to a parabola along the face, right ones by the same all over."""
    level, lead, bow, right = 1e-3 * np.array(parameters["level_um"])
    up = 2.0 * sample.zeta
    pushed = np.where(sample.side > 0, level + up * (lead + up * bow), right)
    return sample.pushed(np.where(sample.flank, pushed, 0.0))


def test_flanks_alone_have_it():
    points = feet()
    assert not EFFECT.basis(points, context(), ())[points.surface != FLANK].any()


def test_where_no_side_shows_where_its_mate_ran_there_is_none():
    assert EFFECT.applies(context())
    assert not EFFECT.applies(replace(context(), faces=()))


def test_open_are_sides_worn_all_over_and_those_that_stand_as_made_at_one_end_alone():
    """Lead and crowning of a flank are three numbers with its level: one end tells none of them, both tell them in between."""
    where = context()
    columns = [len(EFFECT.basis(feet(), replace(where, faces=(face,)), ()).T) for face in where.faces]
    assert {face.side for face, count in zip(where.faces, columns, strict=True) if count == 1} == where.open_sides == {Side.RIGHT}
    assert replace(where, worn=frozenset({Side.LEFT})).open_sides == set(Side)
    assert replace(where, faces=()).open_sides == set()
