"""Which tooth is which: a known turn put in and asked back, and a doubt where the gear has nothing to tell by."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.measured_gear import laid, register
from gearwear.comparison.same_teeth import SURE, TeethPattern, match_teeth, same_teeth
from gearwear.design import parse_design
from tests.synthetic import PINION, Effect, Patch, Recipe, Rigid, Texture, make_scan, rotation_about

ONE = {"gear": {"teeth": 12, "module": 6.35, "face_width": 15.0}}
DESIGN = parse_design(ONE)
PLAIN = replace(Recipe(PINION, noise_um=6.0), pose="none", end_points=4000).of_size(25_000)
INDEX = (4.0, -7.0, 9.0, 2.0, -5.0, 8.0, -9.0, 1.0, 6.0, -8.0, 3.0, -4.0)
PITCH = Effect("pitch", {"index_um": INDEX})
TEXTURE = Texture(4.0, 3.0)
WORN = (Patch(1, 1, 120.0, (36.1, 44.0), (2.0, 12.0)), Patch(2, 1, 60.0, (36.1, 44.0), (2.0, 12.0)))


def pose(teeth: int, over: bool) -> Rigid:
    """The gear turned by some teeth, and a little more; or laid on its other end, about x."""
    turn = rotation_about(np.array([0.0, 0.0, teeth * math.tau / 12 + 0.02]))
    upside = np.diag([1.0, -1.0, -1.0]) if over else np.eye(3)
    return Rigid(turn @ upside, np.array([1.0, -2.0, 15.0 if over else 0.5]))


def scanned(recipe: Recipe, seed: int, design=DESIGN):
    return register(design, as_scan(make_scan(recipe, seed).points))


@pytest.fixture(scope="module")
def worn():
    return scanned(replace(PLAIN, effects=(PITCH,), texture=TEXTURE, texture_seed=3, wear=WORN), 1)


@pytest.mark.long
@pytest.mark.parametrize(("teeth", "over"), [(0, False), (5, False), (3, True)])
def test_the_turn_put_in_comes_back(worn, teeth, over):
    before = scanned(replace(PLAIN, effects=(PITCH,), texture=TEXTURE, texture_seed=3, pose=pose(teeth, over)), 2)
    same = same_teeth(worn, before)
    assert same.probability > 0.999 and same.sure
    there = laid(before, same.motion(before.gear)).pose
    # Both poses take the part to the same place on the design: only registration's own error is between them.
    part = pose(teeth, over).apply(make_scan(PLAIN, 5).points[::50])
    np.testing.assert_allclose(there.apply(part), worn.pose.apply(make_scan(PLAIN, 5).points[::50]), atol=0.02)
    if over:
        assert same.flipped
    assert same.as_it_lay == (teeth == 0 and not over)


def test_without_anything_of_its_own_the_doubt_is_said(worn):
    plain = replace(PLAIN, texture=None)
    same = same_teeth(scanned(plain, 3), scanned(replace(plain, pose=pose(4, False)), 4))
    assert same.as_it_lay and not same.sure and same.probability < 0.5
    assert "nothing on the gear tells" in same.sentence("the gear before wear")


@pytest.mark.long
def test_a_mark_on_one_flank_is_enough():
    nick = (Patch(7, -1, 300.0, (39.0, 43.0), (3.0, 8.0)),)
    first = scanned(replace(PLAIN, wear=(*WORN, *nick)), 6)
    same = same_teeth(first, scanned(replace(PLAIN, wear=nick, pose=pose(9, True)), 7))
    assert same.sure and same.told_by == ("form and marks",)
    other = scanned(replace(PLAIN, wear=nick, pose=pose(9, True)), 7)
    there = laid(other, same.motion(other.gear)).first
    low = there.grid.flank_shape(there.points.deviation) < -0.15
    assert np.argwhere(low.any(axis=(2, 3))).tolist() == [[7, 1]]


def test_the_stated_tooth_is_tooth_1():
    design = parse_design({**ONE, "datum": {"tooth_1_deg": 5 * 30.0 + 1.0}})
    first = scanned(replace(PLAIN, wear=(Patch(5, 1, 200.0, (37.0, 44.0), (3.0, 12.0)),)), 8, design)
    low = first.first.grid.flank_shape(first.first.points.deviation) < -0.1
    assert np.argwhere(low.any(axis=(2, 3))).tolist() == [[0, 0]]


def test_laying_is_what_turning_the_gear_does():
    """Upside down about x, tooth t becomes −t, left becomes right and low becomes high."""
    values = np.arange(5 * 2 * 3.0).reshape(5, 2, 3, 1)
    laid_ = TeethPattern("any", values).laid(2, True)
    for tooth in range(5):
        np.testing.assert_array_equal(laid_[(2 - tooth) % 5, 0], values[tooth, 1, ::-1])
    np.testing.assert_array_equal(TeethPattern("any", values).laid(1, False)[1], values[0])


@pytest.mark.long
def test_how_sure_it_says_is_how_often_it_is_right():
    """Patterns that share some of their scatter: of those said to be p sure, p are right, and of those without nearly none is sure."""
    rng = np.random.default_rng(0)
    said, right, false = 0.0, 0, 0
    for _ in range(300):
        own, share = rng.normal(size=(12, 2, 1, 1)), rng.choice([0.3, 0.6, 0.9])
        first, other = (np.sqrt(share) * own + np.sqrt(1.0 - share) * rng.normal(size=own.shape) for _ in range(2))
        same = match_teeth([TeethPattern("pitch", first)], [TeethPattern("pitch", np.roll(other, -5, axis=0))])
        taken = same.probability >= 0.5
        said += same.probability * taken
        right += taken and (same.turned, same.flipped) == (5, False)
        strange = match_teeth([TeethPattern("pitch", rng.normal(size=own.shape))], [TeethPattern("pitch", other)])
        false += strange.probability > SURE
    assert right > 60 and abs(right - said) < 3.0 * math.sqrt(said)
    assert false <= 0.05 * 300
