"""The double helical generator against the design room: both halves, their roots, and the groove that is on neither."""

from __future__ import annotations

import math

import numpy as np

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import END_LOW, FLANK, OTHER, locate
from tests.synthetic.double_helical import Double, double_scan


def designed(gear: Double) -> Gear:
    half = gear.lower
    return Gear.from_spec(
        GearSpec(
            "gear", half.teeth, half.module, gear.width, math.radians(half.pressure), half.shift, half.addendum, half.dedendum,
            half.tip_radius, helix_angle=math.radians(half.helix), gap=gear.gap,
        )
    )  # fmt: skip


def test_every_point_lies_on_the_design_and_the_groove_on_nothing():
    gear = Double()
    cloud = double_scan(gear, 8000, noise=0.0)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    found = locate(points, designed(gear))
    z, half = points[:, 2], gear.lower.width
    groove = (z > half - 1e-9) & (z < half + gear.gap + 1e-9)
    assert (found.surface[groove] == OTHER).all()
    assert (found.surface[~groove] != OTHER).all()
    assert np.abs(found.deviation[~groove]).max() < 2e-5  # chords of the root's table
    flank = found.surface == FLANK
    assert np.abs(found.deviation[flank]).max() < 1e-11
    assert (found.surface < END_LOW)[flank].all() and (z[flank] > half).mean() > 0.45


def test_a_coat_lies_along_the_normals_of_either_hand():
    gear = Double()
    cloud = double_scan(gear, 8000, noise=0.0, coat=0.02)
    found = locate((cloud.points - cloud.translation) @ cloud.rotation, designed(gear))
    flank = found.surface == FLANK
    assert np.abs(found.deviation[flank] - 0.02).max() < 1e-9
