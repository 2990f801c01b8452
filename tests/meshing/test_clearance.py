"""Tip clearance and interference: the reference's numbers, and the outlines of the two gears laid over each other."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwear.design import Gear, GearSpec
from gearwear.design.pair import tip_clearances
from gearwear.meshing.clearance import (
    bottoming_centre_distance,
    interference,
    interference_free_centre_distance,
    tip_penetration,
)

C = 114.3


def test_tip_clearance_both_ways(pinion, wheel):
    assert tip_clearances(pinion, wheel, C) == (pytest.approx(1.5875, abs=1e-12), pytest.approx(1.5875, abs=1e-12))
    assert bottoming_centre_distance(pinion, wheel) == pytest.approx(112.7125, abs=1e-12)
    assert tip_clearances(pinion, wheel, 111.878)[1] == pytest.approx(111.878 - 112.7125, abs=1e-12)


def test_each_clearance_belongs_to_its_own_tip():
    tall = Gear.from_spec(GearSpec("pinion", 20, 2.0, 10.0, addendum=1.2))
    deep = Gear.from_spec(GearSpec("gear", 30, 2.0, 10.0, dedendum=1.4))

    assert tip_clearances(tall, deep, 50.0) == (pytest.approx(0.4, abs=1e-12), pytest.approx(0.5, abs=1e-12))
    assert bottoming_centre_distance(tall, deep) == pytest.approx(49.6, abs=1e-12)


def test_the_gears_tip_passes_the_pinions_interference_point(pinion, wheel):
    found = interference(pinion, wheel, C)

    assert found.overrun == pytest.approx(1.984, abs=5e-4)
    # Cross-check by Pythagoras in the triangle of the gear's axis, its base tangent point and the pinion's (N1).
    assert found.largest_mate_tip_radius**2 == pytest.approx(
        wheel.base_radius**2 + (C * math.sin(math.radians(20))) ** 2, rel=1e-14
    )
    assert found.below_form == pytest.approx(found.overrun + 3.05745, abs=5e-6)
    assert interference_free_centre_distance(pinion, wheel) == pytest.approx(114.9936, abs=5e-5)
    assert interference(pinion, wheel, interference_free_centre_distance(pinion, wheel)).overrun == pytest.approx(0, abs=1e-12)


def test_the_pinions_tip_is_safe(pinion, wheel):
    found = interference(wheel, pinion, C)

    assert found.overrun == pytest.approx(-12.75, abs=5e-3)
    assert found.penetration == 0.0


def test_a_hobbed_root_lets_the_mate_pass(pinion, wheel):
    """The rack that generated it reaches deeper than any gear of addendum 1 (reference A5: no error at any phase)."""
    assert interference(pinion, wheel, C).penetration == 0.0


def deep_tip():
    """A pair whose gear was given a taller tip than the rack that cut the pinion allows for."""
    pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.38))
    gear = Gear.from_spec(GearSpec("gear", 60, 6.35, 15.0, addendum=1.2))
    return pinion, gear, pinion.reference_radius + gear.reference_radius


def test_a_tip_too_tall_digs_into_the_fillet():
    pinion, gear, at = deep_tip()

    assert min(tip_clearances(pinion, gear, at)) > 0.0
    assert interference(pinion, gear, at).penetration > 0.0


def outline(gear, turn):
    """Closed outline (n, 2) of all teeth with a tooth centre at the angle `turn`, by the public half angle alone."""
    radius = gear.root_radius + (gear.tip_radius - gear.root_radius) * np.linspace(0.0, 1.0, 1500) ** 2
    psi = gear.half_angle(radius)
    tooth_radius = np.concatenate([radius, radius[::-1]])
    tooth_angle = np.concatenate([-psi, psi[::-1]])
    angle = (turn + gear.pitch_angle * np.arange(gear.teeth)[:, None] + tooth_angle).ravel()
    reach = np.tile(tooth_radius, gear.teeth)
    return np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=1)


def deepest_corner(pinion, gear, centre_distance):
    """Deepest the gear's tip corners lie in the pinion's polygon, turned through a pitch with the drive flanks touching."""
    alpha = math.acos((pinion.base_radius + gear.base_radius) / centre_distance)
    line = centre_distance * math.sin(alpha)
    deepest = 0.0
    for roll in np.linspace(0.0, pinion.base_pitch, 120):
        turn = -alpha - pinion.base_half_angle + roll / pinion.base_radius
        mate_turn = math.pi - alpha - gear.base_half_angle + (line - roll) / gear.base_radius
        polygon = outline(pinion, turn)
        corners = outline(gear, mate_turn)
        corners = corners[np.hypot(*corners.T) > gear.tip_radius - 1e-9] + [centre_distance, 0.0]
        radius, angle = np.hypot(*corners.T), np.arctan2(corners[:, 1], corners[:, 0])
        near = radius < pinion.tip_radius
        rim, rim_angle = np.hypot(*polygon.T), np.unwrap(np.arctan2(polygon[:, 1], polygon[:, 0]))
        for r, a in zip(radius[near], angle[near], strict=True):
            # Flank crossings at this radius: the corner is inside a tooth if it lies between a right and a left flank.
            cross = np.flatnonzero((rim[:-1] - r) * (rim[1:] - r) < 0)
            share = (r - rim[cross]) / (rim[cross + 1] - rim[cross])
            at = rim_angle[cross] + share * (rim_angle[cross + 1] - rim_angle[cross])
            right, left = at[0::2], at[1::2]
            for k in (-1, 0, 1):
                inside = np.minimum(a + 2 * math.pi * k - right, left - a - 2 * math.pi * k)
                deepest = max(deepest, r * float(inside.max()))
    return deepest


@pytest.mark.long
def test_penetration_is_what_the_outlines_show():
    """Outlines are of whole gears, so both flanks of every tooth are in it; backlash keeps the coast flanks apart."""
    pinion, gear, at = deep_tip()
    at += 0.05 * 6.35
    expected = deepest_corner(pinion, gear, at)

    assert expected > 0.01
    assert interference(pinion, gear, at).penetration == pytest.approx(expected, rel=0.01)


def test_a_corner_digs_as_soon_as_it_is_below_the_fillet():
    """Three micrometres are three micrometres: what is not told is what rounding makes of a corner that follows a flank."""
    pinion, gear, at = deep_tip()
    where = brentq(lambda distance: tip_penetration(pinion, gear, distance) - 0.003, at, at + 6.35)
    assert interference(pinion, gear, where).penetration == pytest.approx(0.003, abs=1e-6)
