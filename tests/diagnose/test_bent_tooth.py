from dataclasses import replace

import numpy as np
import pytest

from gearwear.diagnose.bent_teeth import Bent
from gearwear.diagnose.effects.bent_tooth import EFFECT
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from tests.diagnose.sample import BORED, ODD, Example, context, feet

MOVED = ("tip_um", "middle_um", "foot_um")
LEAN = (0.01, 0.004, -0.002)
LEANS = ("tip_lean_um", "middle_lean_um", "foot_lean_um")


def example(moved, lean, tooth, gear):
    told = dict(zip(MOVED + LEANS, moved + lean, strict=True)) | {"number": float(tooth)}
    return Example(told, tuple(1e-3 * one for one in moved + lean), (float(tooth),), gear)


EXAMPLES = [
    example((60.0, 24.0, 9.0), (0.0, 0.0, 0.0), 5, BORED),
    example((-45.0, -30.0, 4.0), (-30.0, -12.0, 5.0), 17, ODD),
]


def displace(sample, parameters, shape):
    """Both flanks of one tooth, counted from 1, along the base tangent the same way round: what three numbers say, and a parabola between; three more say by how
    much it is more at the upper end than at the lower."""
    moved, lean = (np.polyfit([1.0, 0.0, -1.0], [1e-3 * parameters[name] for name in names], 2) for names in (MOVED, LEANS))
    there = sample.flank & (sample.tooth == parameters["number"] - 1)
    along = np.polyval(moved, sample.u) + (sample.z / sample.gear.face_width - 0.5) * np.polyval(lean, sample.u)
    return sample.along_base(np.where(there, sample.side * along, 0.0))


def test_a_tooth_that_turns_about_its_root_is_as_thick_as_it_was():
    """What a flank of the tooth gains at a place the other lacks there."""
    about, points = context(), feet()
    moved = EFFECT.basis(points, about, (5.0,))
    left, right = ((points.tooth == 4) & (points.side == side) & np.isfinite(points.roll) for side in (1, -1))
    np.testing.assert_allclose(moved[left].sum(axis=0), -moved[right].sum(axis=0), atol=1e-9)
    assert not moved[points.tooth != 4].any()


@pytest.mark.parametrize("moved", [(0.03, 0.01, 0.0), (-0.04, -0.03, -0.02)])
def test_teeth_that_a_first_look_found_are_asked_and_have_no_index_of_their_own(moved):
    about, points = replace(context(), bent=(Bent(4, moved, LEAN),)), feet()
    assert EFFECT.applies(about) and EFFECT.shapes(about) == [(5.0,)]
    assert not EFFECT.applies(context())
    np.testing.assert_allclose(EFFECT.first_look(points, about), EFFECT.basis(points, about, (5.0,)) @ np.array([*moved, *LEAN]))
    assert PITCH.teeth(about) == [tooth for tooth in range(12) if tooth != 4]
    assert not PITCH.basis(points, about, (1.0,))[points.tooth == 4].any()
