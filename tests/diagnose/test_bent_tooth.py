from dataclasses import replace

import numpy as np
import pytest

from gearwear.diagnose.bent_teeth import Bent
from gearwear.diagnose.effects.bent_tooth import EFFECT
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from tests.diagnose.sample import BORED, ODD, Example, context, feet


def example(tip, middle, form, tooth, gear):
    told = {"tip_um": tip, "middle_um": middle, "foot_um": form, "number": float(tooth)}
    return Example(told, (1e-3 * tip, 1e-3 * middle, 1e-3 * form), (float(tooth),), gear)


EXAMPLES = [example(60.0, 24.0, 9.0, 5, BORED), example(-45.0, -30.0, 4.0, 17, ODD)]


def displace(sample, parameters, shape):
    """Both flanks of one tooth, counted from 1, along the base tangent the same way round: what three numbers say, and a parabola between."""
    moved = 1e-3 * np.array([parameters["tip_um"], parameters["middle_um"], parameters["foot_um"]])
    parabola = np.polyfit([1.0, 0.0, -1.0], moved, 2)
    there = sample.flank & (sample.tooth == parameters["number"] - 1)
    return sample.along_base(np.where(there, sample.side * np.polyval(parabola, sample.u), 0.0))


def test_a_tooth_that_turns_about_its_root_is_as_thick_as_it_was():
    """What a flank of the tooth gains at a place the other lacks there."""
    about, points = context(), feet()
    moved = EFFECT.basis(points, about, (5.0,))
    left, right = ((points.tooth == 4) & (points.side == side) & np.isfinite(points.roll) for side in (1, -1))
    np.testing.assert_allclose(moved[left].sum(axis=0), -moved[right].sum(axis=0), rtol=1e-6)
    assert not moved[points.tooth != 4].any()


@pytest.mark.parametrize("moved", [(0.03, 0.01, 0.0), (-0.04, -0.03, -0.02)])
def test_teeth_that_a_first_look_found_are_asked_and_have_no_index_of_their_own(moved):
    about, points = replace(context(), bent=(Bent(4, moved),)), feet()
    assert EFFECT.applies(about) and EFFECT.shapes(about) == [(5.0,)]
    assert not EFFECT.applies(context())
    np.testing.assert_allclose(EFFECT.first_look(points, about), EFFECT.basis(points, about, (5.0,)) @ moved)
    assert PITCH.teeth(about) == [tooth for tooth in range(12) if tooth != 4]
    assert not PITCH.basis(points, about, (1.0,))[points.tooth == 4].any()
