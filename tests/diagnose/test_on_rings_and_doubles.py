"""Effects on internal and double helical gears: what really displaced points measure, to second order; and shapes along a ring's profile.

Points are those of the generators, which share nothing with the package; displacements are in space and written without the effect.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, OTHER, ROOT, TIP, locate
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.ring import Ring, ring_scan
from tests.synthetic.test_double_helical import designed as double_designed
from tests.synthetic.test_ring import designed as ring_designed

KINDS = {"double": Double(), "ring": Ring(), "helical ring": Ring(helix=-20.0)}
EFFECTS = {effect.name: effect for effect in catalogue()}


@cache
def sample(kind: str):
    """Gear, feet and points away from edges, which are not carried over them."""
    spec = KINDS[kind]
    double = isinstance(spec, Double)
    gear = double_designed(spec) if double else ring_designed(spec)
    cloud = double_scan(spec, 20_000, noise=0.0) if double else ring_scan(spec, 20_000, noise=0.0)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    feet = locate(points, gear)
    known = feet.surface != OTHER
    return gear, feet.take(known), points[known]


def context(kind: str) -> Context:
    gear, feet, _ = sample(kind)
    edges = np.linspace(gear.root_radius, gear.form_radius, 4)
    return Context(gear=gear, surfaces=frozenset(feet.surface.tolist()), scan_axes=np.eye(3), fillet_edges=tuple(edges.tolist()))


def turned(points, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = points.T
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, z])


def outwards(points, much):
    radius = np.hypot(points[:, 0], points[:, 1])
    return points * np.column_stack([1.0 + much / radius, 1.0 + much / radius, np.ones(len(points))])


MOVES = {
    "scale": (8e-4, (), lambda p, a: p * (1.0 + a)),
    "height_scale": (8e-4, (), lambda p, a: p * [1.0, 1.0, 1.0 + a]),
    "axis_offset_radial": (0.02, (), outwards),
    "axis_offset_lateral": (0.02, (), lambda p, a: turned(p, a / np.hypot(p[:, 0], p[:, 1]))),
    "turntable_angle": (4e-4, (3.0,), lambda p, a: turned(p, a * np.cos(3.0 * np.arctan2(p[:, 1], p[:, 0])))),
}
"""Amplitude, shape, and what it does to points; by the name of the effect."""


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.parametrize("name", list(MOVES))
def test_basis_is_what_displaced_points_measure_to_second_order(kind, name):
    gear, feet, points = sample(kind)
    amplitude, shape, move = MOVES[name]
    basis = EFFECTS[name].basis(feet, context(kind), shape)[:, 0] * amplitude
    assert np.abs(basis[feet.surface == FLANK]).max() > 1e-3 or name == "height_scale"
    errors = []
    for factor in (1.0, 0.5):
        moved = locate(move(points, factor * amplitude), gear)
        same = (moved.surface == feet.surface) & (moved.tooth == feet.tooth) & (moved.side == feet.side)
        assert same.mean() > 0.9
        errors.append(np.quantile(np.abs(moved.deviation - factor * basis)[same], 0.999))
    assert errors[0] < 0.05 * np.abs(basis).max()
    # The generator's fillets are known to 2e-5 mm.
    assert errors[1] < 0.3 * errors[0] + 2e-5


def test_halves_shifted_along_the_axis_differ_by_hand_and_side():
    """δ = −s sin β_b e_z with the sign of the hand: odd in both, so no rotation stands in for it."""
    gear, feet, points = sample("double")
    moved = locate(points + np.array([0.0, 0.0, 0.01]), gear)
    flank = (feet.surface == FLANK) & (moved.surface == FLANK)
    hand = np.where(points[:, 2] > 0.5 * gear.face_width, -1.0, 1.0)
    expected = -0.01 * feet.side * hand * math.sin(gear.base_helix_angle)
    assert moved.deviation[flank] == pytest.approx(expected[flank], abs=1e-6)


def test_helix_slope_and_crowning_of_a_double_helical_gear_are_of_each_half():
    gear, feet, _ = sample("double")
    half, z = KINDS["double"].lower.width, feet.position[:, 2]
    upper = z > 0.5 * gear.face_width
    zeta = np.where(upper, z - (gear.face_width - 0.5 * half), z - 0.5 * half) / half
    flank = feet.surface == FLANK
    cosine = gear.base_helix_cosine
    slope = EFFECTS["helix_slope"].basis(feet, context("double"), (0.0,))[flank, 0]
    assert slope == pytest.approx((np.where(upper, -1.0, 1.0) * feet.side * cosine * zeta)[flank], abs=1e-9)
    crowned = EFFECTS["helix_crowning"].basis(feet, context("double"), (0.0,))[flank, 0]
    assert crowned == pytest.approx((-cosine * (2.0 * zeta) ** 2)[flank], abs=1e-9)


def test_what_a_double_helical_gear_is_not_searched_for():
    left_out = {effect.name for effect in catalogue() if not effect.applies(context("double"))}
    assert {"taper", "twist", "feed_marks"} <= left_out
    assert not {"helix_slope", "helix_crowning", "height_scale", "scale", "coating"} & left_out


@pytest.mark.parametrize("kind", ["ring", "helical ring"])
def test_along_the_profile_of_a_ring_tip_and_root_are_where_they_are(kind):
    gear, feet, _ = sample(kind)
    given, flank = context(kind), feet.surface == FLANK
    form, tip, roll = gear.form_roll, gear.tip_roll, feet.roll[flank]
    to_tip, cosine = (form - roll) / (form - tip), gear.base_helix_cosine
    start = form - 0.6 * (form - tip)
    relief = EFFECTS["tip_relief"].basis(feet, given, (start,))[flank, 0]
    assert relief == pytest.approx(-cosine * np.maximum((to_tip - 0.6) / 0.4, 0.0), abs=1e-9)
    root = EFFECTS["root_relief"].basis(feet, given, (start,))[flank, 0]
    assert root == pytest.approx(-cosine * np.maximum((0.6 - to_tip) / 0.6, 0.0), abs=1e-9)
    slope = EFFECTS["profile_slope"].basis(feet, given, (0.0,))[flank]
    assert slope.sum(axis=1) == pytest.approx(cosine * (to_tip - 0.5), abs=1e-9)
    hidden = EFFECTS["occlusion"].basis(feet, given, (1.0, 1.0))[flank, 0]
    assert hidden == pytest.approx(np.exp(-(form - roll)), abs=1e-9)
    for effect, shape in (("tip_relief", (start,)), ("root_relief", (start,))):
        ((low, high),) = EFFECTS[effect].bracket(shape, given)
        assert tip < low < start < high < form
    sliding = EFFECTS["sliding_wear"].basis(feet, given, (1.0,))[flank, 0]
    left = feet.side[flank] > 0
    reference = gear.reference_roll
    most = abs(1.0 - reference / form)
    assert sliding[left] == pytest.approx(-np.abs(1.0 - reference / roll[left]) / most, rel=1e-9)


@pytest.mark.parametrize("kind", ["ring", "helical ring"])
def test_diameters_and_shift_of_a_ring(kind):
    gear, feet, _ = sample(kind)
    given, surface = context(kind), feet.surface
    assert EFFECTS["tip_diameter"].basis(feet, given, ())[surface == TIP, 0] == pytest.approx(-0.5)
    assert EFFECTS["rim_diameter"].basis(feet, given, ())[surface == BORE, 0] == pytest.approx(0.5)
    more = 0.008
    spec = replace(KINDS[kind], shift=KINDS[kind].shift + more, addendum=KINDS[kind].addendum - more)
    cloud = ring_scan(spec, 20_000, 0.0)  # of the ring with more shift, on the design; its tips stay
    found = locate((cloud.points - cloud.translation) @ cloud.rotation, gear)
    basis = EFFECTS["profile_shift"].basis(found, given, ())[:, 0] * more * gear.normal_module
    flat = (found.surface == FLANK) | (found.surface == ROOT) | (found.surface == TIP)
    off = np.abs(found.deviation - basis)
    assert np.quantile(off[flat], 0.99) < 1e-4  # of points at a corner another surface may be the nearer one
    fillet = found.surface == FILLET
    assert np.median(off[fillet]) < 0.2 * more * gear.normal_module  # the arc moves with root circle and flank


def test_ends_of_the_halves_are_edges_too():
    _, feet, _ = sample("double")
    rounding = EFFECTS["edge_rounding"].basis(feet, context("double"), (0.6,))[:, 0]
    z, half = feet.position[:, 2], KINDS["double"].lower.width
    inner = (feet.surface == FLANK) & (np.abs(z - half) < 0.05)
    outer = (feet.surface == FLANK) & (z < 0.05)
    assert rounding[inner].mean() == pytest.approx(rounding[outer].mean(), rel=0.05)
    assert rounding[inner].mean() < -0.8
    assert not np.isin(feet.surface, (END_LOW, END_HIGH))[inner].any()
