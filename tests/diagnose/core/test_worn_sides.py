"""Which sides are worn throughout: on scans whose wear is put in by code that shares nothing with the fit."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import END_HIGH, END_LOW, FLANK, locate
from gearwear.diagnose.columns import cuts_of
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate, build_dictionary
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.effects.face_width import EFFECT as FACE_WIDTH
from gearwear.diagnose.effects.root_relief import EFFECT as ROOT_RELIEF
from gearwear.diagnose.effects.thickness_variation import EFFECT as THICKNESS_VARIATION
from gearwear.diagnose.effects.tip_relief import EFFECT as TIP_RELIEF
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.flank_columns import loss_by_tooth, wear_columns
from gearwear.diagnose.flank_forms import FlankForms, SideLoss
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.masks import not_stray
from gearwear.diagnose.pitch_point import as_slid
from gearwear.diagnose.side_costs import NO_SIDE, SideCosts, by_reliefs
from gearwear.diagnose.worn_sides import _Scan
from gearwear.placing.cells import CellGrid, bin_points, noise
from tests.diagnose.plain import PLAIN, PLAIN_AND_ALL
from tests.placing.placing import designed
from tests.synthetic import AbrasiveWear, Effect, GearNumbers, Patch, Recipe, SlidingWear, make_scan

PINION = designed()
LEFT, RIGHT, BOTH = frozenset({Side.LEFT}), frozenset({Side.RIGHT}), frozenset(Side)
FROM_TOOTH_TO_TOOTH = tuple((1.0 + 0.3 * np.sin(np.arange(12) ** 2)).tolist())
PATCHES = (Patch(1, 1, 80.0, (36.5, 42.5), (2.0, 11.0)), Patch(7, -1, 150.0, (36.5, 42.5), (2.0, 11.0)))


def binned(wear, effects=(), seed=3, points=20_000):
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=effects).of_size(points), seed)
    located = locate(scan.points, PINION)
    return bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=0.3)


def explained(cells, searched=None):
    return close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), searched)


def closed(wear, effects=(), seed=3):
    return explained(binned(wear, effects, seed))


@PLAIN_AND_ALL
@pytest.mark.parametrize(
    ("wear", "sides"),
    [
        pytest.param((SlidingWear(60.0, 1, law="archard"),), LEFT, marks=pytest.mark.long),
        ((SlidingWear(60.0, 1, law="archard"), SlidingWear(35.0, -1, law="archard")), BOTH),
        pytest.param(PATCHES, NO_SIDE, marks=pytest.mark.long),
    ],
    ids=["left", "both", "patches"],
)
def test_the_sides_that_were_worn_are_the_sides_called_worn(wear, sides, effects):
    assert explained(binned(wear), effects).worn_sides == sides


@pytest.mark.long
@pytest.mark.parametrize(
    ("other", "effects", "sides", "names"),
    [
        ((AbrasiveWear(15.0, -1),), (), BOTH, []),
        ((), (Effect("tooth_thickness", {"thickness_um": -30.0}),), LEFT, ["tooth_thickness"]),
    ],
    ids=["the coast side evenly worn", "teeth cut thin"],
)
def test_a_worn_side_that_stands_proud_of_thin_teeth_tells_that_they_are_not_thin(other, effects, sides, names):
    """Either way the coast flanks are low alike. Where the worn side touches the drawing at the pitch point, they have lost it alone."""
    loop = closed((SlidingWear(60.0, 1, FROM_TOOTH_TO_TOOTH, "archard"), *other), effects)
    assert (loop.worn_sides, [effect.name for effect in loop.effects], loop.others) == (sides, names, ())


@pytest.mark.long
def test_an_even_loss_of_one_side_is_a_side_worn_and_no_line_off_its_axis():
    """Against fillets and tips it is none of both sides, as thin teeth are; what a grinder took off one side alone is the same."""
    loop = closed((AbrasiveWear(40.0, 1),), (Effect("coating", {"thickness_um": 15.0}),))
    (worn,) = (answer for answer in (loop, *loop.others) if answer.worn_sides == LEFT)
    (coat,) = worn.effects
    thickness = coat.parameters["thickness_um"]
    assert (coat.name, abs(thickness.value - 15.0) < 3.0 * thickness.std) == ("coating", True)


@pytest.mark.long
def test_a_few_flanks_worn_all_over_are_no_errors_of_pitch():
    """Half of what an index does to a tooth is what wear does to its left flank: what the mask leaves of that flank must not tell of it."""
    numbers, worn = GearNumbers(22, 4.0, 20.0, profile_shift=0.15), {2: 1.3, 3: 1.0, 4: 1.0, 9: 2.3, 10: 1.25, 15: 1.0}
    wear = SlidingWear(40.0, 1, tuple(worn.get(tooth, 0.0) for tooth in range(22)), "archard")
    table = Effect("turntable_angle", {"amplitude_deg": 0.01, "order": 1, "phase_deg": 40.0})
    recipe = Recipe(
        numbers, jitter=1.0, noise_um=5.0, pose="none", wear=(wear,), effects=(Effect("coating", {"thickness_um": 20.0}), table)
    )
    located = locate(make_scan(recipe.of_size(30_000), 4).points, gear := designed(numbers))
    loop = explained(bin_points(located, CellGrid.for_scan(gear, len(located)), clip=0.3))
    assert (loop.worn_sides, {effect.name for effect in loop.effects}) == (NO_SIDE, {"coating", "turntable_angle"})


def test_a_surface_that_lies_off_the_drawing_throughout_is_not_torn():
    """A face drawn 0.2 mm too narrow, within its tolerance: ends that a first fit leaves out would leave the height, and a coat, to the tips."""
    drawn = Gear.from_spec(replace(PINION.spec, face_width=14.8))
    located = locate(make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none").of_size(20_000), 3).points - [0.0, 0.0, 0.1], drawn)
    cells = bin_points(located, CellGrid.for_scan(drawn, len(located)), clip=0.3)
    target = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0)
    dictionary = build_dictionary(cells, (FACE_WIDTH,), make_context(cells, np.eye(3), False))
    white = CellCovariance(cells.grid, noise(cells) ** 2 / np.maximum(cells.count, 1.0), 1e-6, 0.3, 0.3)
    ends = cells.seen & np.isin(cells.points.surface, (END_LOW, END_HIGH))
    assert np.median(target[ends]) == pytest.approx(0.1, abs=0.005)
    left = Fit(cells, target, dictionary, cells.seen, white).pose_residual()
    assert abs(np.median(left[ends])) < 0.002  # a fiftieth
    assert not_stray(left, cells.seen)[ends].mean() > 0.95


@pytest.mark.long
def test_one_flank_that_has_gained_does_not_clear_the_others_of_wear():
    """A flank that stands proud by 20 µm, as one does that was built up or never touched its mate: all teeth alike may be made so, and are not told not to be worn.

    A thicker tooth and its pitch explain that flank too, so that the two answers come out at one cost (by 6 for wear without it).
    """
    cells = binned((SlidingWear(50.0, 1, law="archard"),))
    points = cells.points
    proud = (points.surface == FLANK) & (points.side == int(Side.LEFT)) & (points.tooth == 5)
    loss = np.where(proud, np.nanmedian(points.deviation[proud]), 0.0)
    loop = explained(cells.with_deviation(points.deviation + np.where(proud, 0.02, 0.0) - loss))
    assert LEFT in (loop.worn_sides, *loop.undecided)


@pytest.mark.parametrize("thickness_um", [-30.0, 30.0])
def test_thin_teeth_may_be_evenly_worn_and_thick_ones_not(thickness_um):
    """Half of the arc turned to either side: δ = ½ s cos α on every flank."""
    cells = binned((), (Effect("tooth_thickness", {"thickness_um": thickness_um}),))
    loop = explained(cells, PLAIN)
    (thin,) = [effect for effect in loop.effects if effect.name == "tooth_thickness"]
    flanks = cells.points.take(cells.seen & (cells.points.surface == FLANK))
    depth = max(-0.5e-3 * thickness_um * np.cos(PINION.transverse_pressure_angle), 0.0)
    assert ("abrasive_wear" in thin.alternatives) == (thickness_um < 0.0)
    assert loop.thinner_by(flanks) == pytest.approx(depth, abs=0.001)


@pytest.mark.long
@pytest.mark.parametrize(
    "effect",
    [
        Effect("tip_relief", {"amount_um": 25.0, "start_mm": 20.0}),
        Effect("profile_crowning", {"crowning_um": 20.0}),
        Effect("profile_slope", {"left_um": 20.0, "right_um": -15.0}),
    ],
    ids=lambda effect: effect.name,
)
def test_what_was_made_alike_on_all_teeth_is_not_called_wear(effect):
    assert closed(PATCHES, (effect,)).worn_sides == NO_SIDE


def test_the_cheapest_is_taken_and_what_costs_no_more_than_chance_beyond_it_is_not_excluded():
    costs = SideCosts({NO_SIDE: 100.0, LEFT: 92.0, RIGHT: 104.0, BOTH: 98.0})
    assert costs.chosen == LEFT
    assert costs.not_excluded == (NO_SIDE, BOTH)
    assert SideCosts({NO_SIDE: 100.0, LEFT: 40.0, RIGHT: 48.0, BOTH: 50.0}).not_excluded == (RIGHT,)
    assert SideCosts({NO_SIDE: 100.0, LEFT: 90.5}).not_excluded == ()
    assert SideCosts({NO_SIDE: 100.0}).chosen == NO_SIDE


def test_an_answer_is_beyond_doubt_where_all_others_cost_a_twentieth_more_and_more_than_chance():
    assert SideCosts({NO_SIDE: 2000.0, LEFT: 1000.0, BOTH: 1051.0}).beyond_doubt
    assert not SideCosts({NO_SIDE: 2000.0, LEFT: 1000.0, BOTH: 1049.0}).beyond_doubt
    assert not SideCosts({NO_SIDE: 100.0, LEFT: 40.0, RIGHT: 48.0}).beyond_doubt
    assert not SideCosts(
        {NO_SIDE: 100.0, LEFT: 99.0, BOTH: 95.0}, alike=96.0
    ).beyond_doubt  # no side is taken, and two are cheaper
    assert SideCosts({NO_SIDE: 100.0}).beyond_doubt
    assert SideCosts({NO_SIDE: 1051.0, LEFT: 1000.0, RIGHT: 1200.0, BOTH: 1049.0}).ruled_out == {NO_SIDE, RIGHT}


@pytest.mark.parametrize(("alike", "worn"), [(100.0, NO_SIDE), (103.9, NO_SIDE), (104.1, BOTH)])
def test_both_sides_are_worn_only_where_that_beats_a_form_of_both_by_more_than_chance(alike, worn):
    """What both sides have alike was made more often than both were worn to it; the other answer is told. Two forms are another matter."""
    costs = SideCosts({NO_SIDE: 100.0, LEFT: 99.0, BOTH: 95.0}, alike)
    assert costs.chosen == worn
    assert costs.not_excluded == ((LEFT, BOTH) if worn == NO_SIDE else (NO_SIDE, LEFT))


@pytest.mark.parametrize(("alike", "told"), [(100.0, ()), (110.9, ()), (111.1, (LEFT,)), (181.1, (LEFT,))])
def test_forms_of_the_two_sides_apart_do_not_exclude_wear_of_the_side_that_bends(alike, told):
    """A form of its own explains whatever a side has lost, and better by 20 than any shape of wear; the others are excluded all the same."""
    costs = SideCosts({NO_SIDE: 100.0, LEFT: 120.0, BOTH: 140.0, RIGHT: 190.0}, alike, bends=LEFT)
    assert (costs.chosen, costs.not_excluded) == (NO_SIDE, told)
    assert costs.ruled_out == {LEFT, BOTH, RIGHT} - set(told)
    assert replace(costs, bends=NO_SIDE).not_excluded == ()
    assert (
        SideCosts({NO_SIDE: 100.0, LEFT: 90.0, RIGHT: 80.0}, alike, bends=LEFT).not_excluded == ()
    )  # a side is worn, whatever the other costs


@pytest.mark.parametrize(("uncommon", "told"), [(0.0, ()), (2.9, ()), (3.1, (BOTH,))])
def test_what_flanks_of_their_class_are_hardly_made_with_both_sides_may_have_lost(uncommon, told):
    """It fits better by 12 that they were made so; where they hardly are, wear is not excluded, and of one side nothing is said by that."""
    assert SideCosts({NO_SIDE: 100.0, BOTH: 112.0, LEFT: 112.0}, 100.0, uncommon).not_excluded == told
    assert SideCosts({NO_SIDE: 112.0, BOTH: 112.0, LEFT: 100.0}, 112.0, uncommon).not_excluded == ()


@pytest.mark.parametrize(("size", "squared"), [(0.0, 0.0), (1.0, 1.0), (2.0, 4.0)])
def test_a_form_is_as_uncommon_as_its_square_in_that_of_which_five_in_a_hundred_flanks_have_more(size, squared):
    """Minus twice the logarithm of a normal density falls with the square, and the side that has less of it counts."""
    gear = Gear.from_spec(replace(PINION.spec, tolerance=replace(PINION.spec.tolerance, flank_class=5)))
    cells = binned(())
    cells = replace(cells, grid=replace(cells.grid, gear=gear))
    points, edges = cells.points, cells.grid.roll_edges
    flank = points.surface == FLANK
    way = 2.0 * (np.nan_to_num(points.roll, nan=edges[0]) - edges[0]) / np.ptp(edges) - 1.0
    # 1 − x² off its chord, as wide as the form tolerance of class 5: 0.55 m + 5 µm. A slope on top is no form.
    hollow = 1e-3 * (0.55 * 6.35 + 5.0) * size * (1.0 - way**2)
    loss = np.where(flank, -(hollow + 0.05 * way) * np.where(points.side == int(Side.LEFT), 1.0, 1.5), 0.0)
    forms = FlankForms(cells, np.flatnonzero(flank & cells.seen), PINION.reference_roll)
    assert forms.uncommon(SideLoss(0.0, loss, False)) == pytest.approx(1.96**2 * squared, rel=0.2)


@pytest.mark.long
def test_a_profile_that_one_side_was_made_with_is_not_called_wear():
    """One and a half waves along the profile, alike on all left flanks, as a wheel dressed for that side leaves them."""
    cells = binned(PATCHES)
    points, roll = cells.points, cells.grid.roll_edges
    way = (np.nan_to_num(points.roll, nan=roll[0]) - roll[0]) / np.ptp(roll)
    left = (points.surface == FLANK) & (points.side == int(Side.LEFT))
    made = np.where(left, 0.012 * np.sin(3.0 * np.pi * way), 0.0)
    assert explained(cells.with_deviation(points.deviation + made)).worn_sides == NO_SIDE


@pytest.mark.long
def test_both_sides_lightly_worn_or_a_relief_of_both_is_left_open_and_so_are_the_names():
    """A slope and a relief can draw what the sliding of both sides does: one of the two explanations, and the other beside it."""
    loop = closed((SlidingWear(12.0, 1, law="archard"), SlidingWear(12.0, -1, law="archard")))
    answers = {loop.worn_sides, *loop.undecided}
    assert BOTH in answers
    named = [effect for effect in loop.effects if effect.kind is not Kind.FORM]
    assert all("sliding_wear" in effect.alternatives for effect in named if not loop.worn_sides)


def test_the_share_of_a_flank_is_the_loss_on_that_flank_and_nothing_elsewhere():
    cells = binned(())
    points = cells.points
    loss = np.where(cells.seen & (points.surface == FLANK) & (points.tooth != 4), -np.hypot(*points.position[:, :2].T), 0.0)
    shares = loss_by_tooth(cells, loss, cuts_of(cells.grid))
    columns = np.column_stack([shares.times(share) for share in np.eye(shares.count)])
    flanks = [(tooth, side) for tooth in range(PINION.teeth) if tooth != 4 for side in (-1, 1)]
    expected = [np.where((points.tooth == tooth) & (points.side == side), loss, 0.0) for tooth, side in flanks]
    np.testing.assert_array_equal(columns, np.column_stack(expected))


AMOUNTS = np.sin(np.arange(12) ** 2)


@pytest.mark.parametrize(
    ("factors", "effects", "other", "uneven"),
    [
        (1.0 + 0.2 * AMOUNTS, (), 0.0, True),
        (1.0 + 0.2 * AMOUNTS, (), 0.4, False),
        ((), (Effect("thickness_variation", {"thickness_um": tuple((5.0 * (AMOUNTS - AMOUNTS.mean())).tolist())}),), 0.0, False),
    ],
    ids=["worn more and less", "the other side as unlike", "thick and thin, and worn alike"],
)
def test_an_amount_for_every_tooth_does_not_hide_that_teeth_lost_more_and_less(factors, effects, other, uneven):
    """Thickness that varies takes half of that off both flanks of a tooth: beside the shares it is not needed, and what they gain is counted without it.

    Where right flanks, which no wear touched, have the shape of the loss as well, up and down from tooth to tooth by twice as much, left ones may have been
    cut no more alike.
    """
    cells = binned((SlidingWear(25.0, 1, tuple(factors), "archard"),), effects)
    points = cells.points
    right = cells.seen & (points.surface == FLANK) & (points.side == int(Side.RIGHT))
    sliding = np.where(right, np.abs(1.0 - PINION.reference_roll / np.where(right, points.roll, 1.0)), 0.0)
    amounts = other * (-1.0) ** points.tooth
    cells = cells.with_deviation(points.deviation + 0.025 * amounts * sliding / sliding.max())
    context = make_context(cells, np.eye(3), False)
    target = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0)
    dictionary = build_dictionary(cells, (THICKNESS_VARIATION,), context)
    white = CellCovariance(cells.grid, noise(cells) ** 2 / np.maximum(cells.count, 1.0), 1e-6, 0.3, 0.3)
    fit = Fit(cells, target, dictionary, cells.seen, white)
    model = dictionary.candidates[:1]
    scan = _Scan.of(fit, fit.problem(1.0, context, frozenset()), model, noise(cells), cells.seen)
    losses = scan._losses_beside(model, LEFT, *wear_columns(cells, context, LEFT))
    assert [one.uneven for one in losses] == [uneven, uneven]


WAY = np.linspace(1.6, 24.8, 24) - 13.0
"""From the form circle of the paper's pinion to its tip, along the line of action from the pitch point, mm."""
SLIDING = np.abs(1.5 * WAY / (WAY + 13.0))
"""Specific sliding with a mate of twice its teeth: 1.5 (1 − L_pitch / L)."""
TWO_PAIRS = np.where((WAY > -5.0) & (WAY < 5.0), 1.0, 1.0 / 3.0)
MADE = 0.008
RIPPLE = 0.02 * np.cos(2.0 * np.pi * WAY / 12.4)


@pytest.mark.parametrize(
    ("lost", "slid"),
    [
        (0.03 * SLIDING, True),
        (0.03 * SLIDING * TWO_PAIRS, True),
        (0.1 * SLIDING * TWO_PAIRS + 0.05, True),  # and an even loss
        (0.03 * np.abs(WAY) / 12.0, True),
        (0.1 * np.abs(WAY) / 12.0 * TWO_PAIRS, True),
        (0.03 * SLIDING * (WAY < 0.0), True),
        (0.02 + RIPPLE, False),
        (0.02 - RIPPLE, False),
        (0.1 * np.abs(WAY) / 12.0 * np.where(np.abs(WAY - 8.0) < 2.0, 0.0, 1.0), False),  # spared between places that carried
        (0.05 * np.exp(-(((WAY - 5.0) / 2.0) ** 2)), False),  # and a hollow of which nothing is beyond
    ],
    ids=[
        "sliding",
        "shared",
        "shared, even",
        "way",
        "way, shared",
        "dedendum",
        "ripple",
        "ripple the other way",
        "spared",
        "hollow",
    ],
)
def test_a_loss_that_follows_load_times_sliding_spares_nothing_beyond(lost, slid):
    """Where two pairs mesh each carries a third at least; a ripple of more than a wave does not come from it."""
    assert as_slid(lost, WAY, MADE) is slid
    assert as_slid(lost + 0.0005 * np.cos(1e3 * WAY), WAY, MADE) is slid
    assert as_slid(lost[::-1], WAY[::-1], MADE) is slid


@pytest.mark.parametrize(("flank_class", "tolerance_um"), [(8, 24.02), (5, 8.49)])
def test_forms_of_left_and_right_cost_what_their_difference_is_rare(flank_class, tolerance_um):
    """Columns of cells high and low by turns about a straight line, c = 20 µm from peak to peak; f_fα = (0.55 m_n + 5) µm of class 5, √2 a class. Difference of two normal forms of which 95 % keep
    the tolerance: (1.96 c / T)² / 2. The same on both sides, or a slope of one, costs nothing."""
    cells = binned(())
    gear = Gear.from_spec(replace(PINION.spec, tolerance=replace(PINION.spec.tolerance, flank_class=flank_class)))
    cells = replace(cells, grid=replace(cells.grid, gear=gear))
    points, edges = cells.points, cells.grid.roll_edges
    flank = cells.seen & (points.surface == FLANK)
    roll = np.where(flank, np.nan_to_num(points.roll), edges[0])
    middles, turns = 0.5 * (edges[:-1] + edges[1:]), (-1.0) ** np.arange(cells.grid.flank)
    off_line = turns - np.polyval(np.polyfit(middles, turns, 1), middles)
    by_turns = np.where(flank, 0.02 * (off_line / np.ptp(off_line))[cells.grid.flank_column(roll)], 0.0)
    left = flank & (points.side == int(Side.LEFT))
    forms = FlankForms(cells, np.flatnonzero(flank), PINION.reference_roll)
    rare = 0.5 * (1.96 * 20.0 / tolerance_um) ** 2
    assert forms.forms_apart(np.where(left, by_turns, 0.0)) == pytest.approx(rare, rel=1e-3)
    assert forms.forms_apart(np.where(left, 0.5, -0.5) * by_turns) == pytest.approx(rare, rel=1e-3)
    assert forms.forms_apart(by_turns) == pytest.approx(0.0, abs=1e-9)
    assert forms.forms_apart(np.where(left, 0.002 * roll, 0.0)) < 0.05 * rare


@pytest.mark.parametrize(
    ("tip", "root", "meet"), [(14.0, 14.0, True), (14.0, 14.9, True), (16.3, 14.0, True), (16.5, 14.0, False)]
)
def test_reliefs_that_leave_nothing_between_them_are_never_cut(tip, root, meet):
    """The flank of the pinion has 23.5 mm of roll, a tenth of which reliefs leave between them; both sides worn are not excluded however well they fit."""
    assert 23.4 < PINION.tip_roll - PINION.form_roll < 23.6
    model = (Candidate(TIP_RELIEF, (tip,), np.array([0])), Candidate(ROOT_RELIEF, (root,), np.array([1])))
    problem = SimpleNamespace(context=SimpleNamespace(gear=PINION))
    uncommon = by_reliefs(model, problem)
    assert uncommon == (np.inf if meet else 0.0) and by_reliefs(model[:1], problem) == by_reliefs(model[1:], problem) == 0.0
    costs = SideCosts({NO_SIDE: 100.0, RIGHT: 111.0, BOTH: 110.0}, 100.0, uncommon)
    assert costs.chosen == NO_SIDE and costs.not_excluded == ((BOTH,) if meet else ())
