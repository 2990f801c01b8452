"""A scan of either gear of an internal pair: the sliding it is looked at with, and what is left out."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearwear as gw
from gearwear.design import Gear, GearSpec
from gearwear.design.pair import Design
from gearwear.design.spec import PairSpec
from tests.synthetic.ring import Ring, ring_scan
from tests.synthetic.test_ring import designed

RING = Ring()


def pair() -> Design:
    pinion = Gear.from_spec(GearSpec("pinion", 18, RING.module, RING.width, profile_shift=RING.shift, thinning=0.1))
    return Design({"pinion": pinion, "gear": designed(RING)}, PairSpec())


@pytest.mark.long
def test_sliding_is_nothing_at_the_pitch_point_and_that_of_the_velocities_beside_it():
    """K1 = 1 − v2 / v1: the ends of the rolls move along the common normal's square with ω L, both the same way round."""
    design = pair()
    measured = gw.register(design, gw.as_scan(ring_scan(RING, 20_000, seed=3).points), part="gear")
    context, ring, pinion = measured.context, design.gears["gear"], design.gears["pinion"]
    working = math.acos((ring.base_radius - pinion.base_radius) / design.centre_distance)
    assert context.pitch_roll == pytest.approx(ring.base_radius * math.tan(working))
    roll = np.linspace(ring.tip_roll, ring.form_roll, 9)
    mate = roll - design.centre_distance * math.sin(working)
    velocity, other = roll / ring.teeth, mate / pinion.teeth
    assert context.sliding(roll) == pytest.approx(1.0 - other / velocity)
