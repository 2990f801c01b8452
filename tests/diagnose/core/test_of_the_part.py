"""A form that all teeth have, under which the scanner cannot be told from the part: put in on the cells by closed forms."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.design.tolerance import GearTolerance, profile_form_tolerance
from gearwear.diagnose.effects.axis_offset_lateral import EFFECT as LATERAL
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.of_the_part import left_in_the_part
from gearwear.placing.cells import noise
from tests.diagnose.core.test_worn_sides import FROM_TOOTH_TO_TOOTH, LEFT, NO_SIDE, PINION, binned, explained
from tests.diagnose.core.toy import Toy, problem
from tests.diagnose.plain import PLAIN, PLAIN_AND_ALL
from tests.synthetic import Effect, SlidingWear


@pytest.fixture(scope="module")
def unworn():
    return binned((), points=10_000)


def along(cells):
    """Length of roll, 0 at the form circle and 1 at the tip."""
    first, last = cells.grid.roll_edges[[0, -1]]
    return np.clip((np.nan_to_num(cells.points.roll) - first) / (last - first), 0.0, 1.0)


def with_form(cells, form, sides=frozenset(Side)):
    """The cells with a form (m,) on the flanks of some sides."""
    flanks = cells.seen & (cells.points.surface == FLANK) & np.isin(cells.points.side, [int(side) for side in sides])
    return cells.with_deviation(cells.points.deviation + np.where(flanks, form, 0.0))


def wave(cells, left, right):
    """One wave and a half along the profile, on left and right flanks of another height: what no effect is."""
    return np.sin(3.0 * np.pi * along(cells)) * np.where(cells.points.side == int(Side.LEFT), left, right)


@pytest.mark.long
def test_under_a_form_of_all_teeth_a_range_bias_is_not_told_from_a_profile(unworn):
    """Flanks cut as a bias of range would show them, by 1 − L / r, and tips as drawn; where the root is free nothing else speaks for a bias."""
    points = unworn.points
    slanting = 1.0 - np.nan_to_num(points.roll) / np.hypot(points.position[:, 0], points.position[:, 1])
    cells = with_form(unworn, wave(unworn, 0.025, -0.02) - 0.06 * slanting)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), root_free=True)
    assert {effect.kind for effect in loop.effects} == {Kind.MANUFACTURE}
    assert any("incidence_bias" in effect.alternatives for effect in loop.effects)
    assert any(pattern.is_form(loop.noise) for pattern in loop.patterns)


@dataclass(frozen=True)
class Often(Toy):
    """What scanners do often."""

    usual = True


@dataclass(frozen=True)
class Seldom(Toy):
    usual = False


@pytest.mark.parametrize(("what", "form", "left"), [(Seldom, False, True), (Often, False, False), (Often, True, True)])
def test_what_a_maker_may_have_left_as_well_is_left_in_the_part(what, form, left):
    """Thin teeth explain 98 % of a range bias of 34 µm: a thousand cells tell the rest, and no scan tells of which kind that is."""
    rng = np.random.default_rng(2)
    bias, thin = np.linalg.qr(rng.normal(size=(1000, 2)))[0].T
    thin = np.sqrt(0.98) * bias + np.sqrt(0.02) * thin
    one = problem(
        np.zeros((1000, 0)), [(what("bias", kind=Kind.MEASUREMENT), bias[:, None]), (Toy("thin"), thin[:, None])], 100.0 * bias
    )
    (kept,) = left_in_the_part(one, one.dictionary.candidates[:1], form)
    assert kept.name == ("thin" if left else "bias")


@pytest.mark.long
def test_a_coat_on_roots_and_tips_is_told_whatever_the_flanks_are_like():
    cells = binned((), (Effect("coating", {"thickness_um": 15.0}),))
    loop = explained(with_form(cells, wave(cells, 0.04, 0.02)))
    assert any(pattern.is_form(loop.noise) for pattern in loop.patterns)
    assert [effect.name for effect in loop.effects if effect.kind is Kind.MEASUREMENT] == ["coating"]


@PLAIN_AND_ALL
@pytest.mark.parametrize(
    ("flank_class", "varies", "sides"),
    [(8, 0.0, NO_SIDE), pytest.param(3, 0.0, LEFT, marks=pytest.mark.long), (8, 0.4, LEFT)],
    ids=["cut", "rougher than its class", "worn"],
)
def test_a_hollow_form_of_one_side_within_the_class_that_teeth_have_alike_is_as_likely_cut(
    unworn, flank_class, varies, sides, effects
):
    """Nothing at the pitch point, 20 µm beside it, and not the shape of sliding: f_fαT is 24 µm in class 8 and 4.2 in class 3."""
    first, last = unworn.grid.roll_edges[[0, -1]]
    pitch_point = make_context(unworn, np.eye(3), False).pitch_roll
    hollow = -0.02 * np.sin(2.0 * np.pi * (np.nan_to_num(unworn.points.roll) - pitch_point) / (last - first)) ** 2
    gear = Gear.from_spec(replace(PINION.spec, tolerance=GearTolerance(flank_class=flank_class)))
    share = 1.0 + varies * np.sin(unworn.points.tooth.astype(float) ** 2)
    cells = with_form(replace(unworn, grid=replace(unworn.grid, gear=gear)), share * hollow, LEFT)
    assert (np.ptp(hollow) < profile_form_tolerance(gear.normal_module, flank_class)) == (flank_class == 8)
    loop = explained(cells, effects)
    assert {loop.worn_sides, *loop.undecided} >= {LEFT} and loop.worn_sides == sides


@pytest.mark.long
def test_flanks_that_differ_on_both_sides_were_cut_so(unworn):
    """As in the case that is worn, but right flanks have as much of the same shape, up or down by chance."""
    first, last = unworn.grid.roll_edges[[0, -1]]
    pitch_point, tooth = make_context(unworn, np.eye(3), False).pitch_roll, unworn.points.tooth.astype(float)
    hollow = -0.02 * np.sin(2.0 * np.pi * (np.nan_to_num(unworn.points.roll) - pitch_point) / (last - first)) ** 2
    gear = Gear.from_spec(replace(PINION.spec, tolerance=GearTolerance(flank_class=8)))
    cells = with_form(replace(unworn, grid=replace(unworn.grid, gear=gear)), (1.0 + 0.4 * np.sin(tooth**2)) * hollow, LEFT)
    loop = explained(with_form(cells, 0.4 * np.cos(tooth**2) * hollow, frozenset({Side.RIGHT})))
    assert loop.worn_sides == NO_SIDE


@pytest.mark.parametrize(
    ("form", "effects"),
    [
        (lambda way: (2.0 * way - 1.0) ** 2, PLAIN),
        pytest.param(lambda way: (2.0 * way - 1.0) ** 2, None, marks=pytest.mark.long),
        pytest.param(lambda way: np.clip(1.0 - 2.0 * way, 0.0, 1.0), None, marks=pytest.mark.long),
        pytest.param(lambda way: np.clip(4.0 * np.abs(way - 0.5) - 1.0, 0.0, 1.0), None, marks=pytest.mark.long),
    ],
    ids=["crowned", "crowned, of all effects", "relieved at the root", "relieved at both ends"],
)
def test_a_side_is_worn_whatever_the_other_was_cut_to(form, effects):
    """Left flanks slid by 60 µm, each tooth by its own share, right ones cut otherwise by 25 µm: neither made so, nor worn on both sides."""
    worn = binned((SlidingWear(60.0, 1, FROM_TOOTH_TO_TOOTH, "archard"),), points=14_000)
    loop = explained(with_form(worn, -0.025 * form(along(worn)), frozenset({Side.RIGHT})), effects)
    assert (loop.worn_sides, loop.others) == (LEFT, ())


@pytest.mark.parametrize(
    ("wear", "sides", "effects"),
    [
        pytest.param((), NO_SIDE, None, marks=pytest.mark.long, id="both sound"),
        pytest.param((SlidingWear(60.0, 1, FROM_TOOTH_TO_TOOTH, "archard"),), LEFT, (*PLAIN, LATERAL), id="left worn"),
        pytest.param((SlidingWear(60.0, 1, FROM_TOOTH_TO_TOOTH, "archard"),), LEFT, None, marks=pytest.mark.long, id="of all"),
    ],
)
def test_a_laser_beside_the_axis_may_be_a_slope_of_the_sound_side_where_the_other_is_worn(wear, sides, effects):
    """It turns flanks of both sides against each other, which no slope does; those of one side alone it turns as a slope and another level of theirs."""
    loop = explained(binned(wear, (Effect("axis_offset_lateral", {"offset_um": 60.0}),)), effects)
    (effect,) = loop.effects
    assert (loop.worn_sides, effect.name) == (sides, "axis_offset_lateral")
    assert ("profile_slope" in effect.alternatives) == bool(sides)
