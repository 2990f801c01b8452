"""Archard's law on helical teeth: the load is spread over lines that lean over the flank."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.meshing.path import path_of_contact
from gearwear.wear_law.archard import LoadSharing, law_terms, load_share
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.forecast import cycles_left
from tests.running.helical_maps import gears as helical_gears
from tests.running.helical_maps import ran


def pair(degrees: float, width: float) -> tuple[Gear, Gear, float]:
    beta = math.radians(degrees)
    pinion = Gear.from_spec(GearSpec("pinion", 17, 3.0, width, helix_angle=beta))
    gear = Gear.from_spec(GearSpec("gear", 31, 3.0, width, helix_angle=-beta))
    return pinion, gear, pinion.reference_radius + gear.reference_radius


def inside(pinion: Gear, gear: Gear, centre: float, count: int = 4001) -> np.ndarray:
    path = path_of_contact(pinion, gear, centre)
    return path.start_pinion + path.length * (np.arange(count) + 0.5) / count


@pytest.mark.parametrize("degrees", [8.0, 20.0, 35.0])
def test_over_the_path_the_shares_add_up_to_one_base_pitch(degrees):
    """At every moment the lines carry all of the load; averaged over a pitch, ∫ share dL = p_bt, whatever the overlap."""
    gears = pair(degrees, 14.0)
    roll, path = inside(*gears), path_of_contact(*gears)
    share = load_share(*gears, roll, LoadSharing.LINES)
    assert share.mean() * path.length == pytest.approx(path.base_pitch, rel=2e-3)


def test_with_an_overlap_of_one_pitch_the_lines_are_of_one_length():
    beta = math.radians(20.0)
    gears = pair(20.0, math.pi * 3.0 / math.sin(beta))  # b = p_x = π m_n / sin β
    path = path_of_contact(*gears)
    assert path.overlap_ratio == pytest.approx(1.0, rel=1e-12)
    share = load_share(*gears, inside(*gears, 50), LoadSharing.LINES)
    assert share == pytest.approx(np.full(50, 1.0 / path.contact_ratio), rel=1e-12)


def test_without_overlap_it_is_the_spur_pairs_halves():
    spur, nearly = pair(0.0, 14.0), pair(1e-4, 14.0)
    path = path_of_contact(*spur)
    roll = inside(*spur, 300)
    border = min(path.single_contact_pinion)
    roll = roll[np.abs(roll - border) > 0.01]
    roll = roll[np.abs(roll - max(path.single_contact_pinion)) > 0.01]
    assert load_share(*nearly, roll, LoadSharing.LINES) == pytest.approx(load_share(*spur, roll, LoadSharing.HALVES))


def test_models_are_those_of_the_kind_of_teeth_and_a_law_comes_back():
    gears = pair(25.0, 10.0)
    assert LoadSharing.of(gears[0]) == (LoadSharing.NONE, LoadSharing.LINES)
    assert LoadSharing.of(pair(0.0, 10.0)[0]) == (LoadSharing.NONE, LoadSharing.HALVES, LoadSharing.THIRDS)
    roll = inside(*gears, 80)
    terms = law_terms(*gears, roll, LoadSharing.LINES)
    assert not terms[:, 2].any()  # no place of a profile is in single contact
    depth = terms @ [0.020, 0.003, 0.0]
    best = fit_wear_law(*gears, roll, depth, np.full(80, 1e-5))[0]
    assert best.sharing is LoadSharing.LINES
    assert best.coefficients[:2] == pytest.approx([0.020, 0.003], rel=1e-6)


@pytest.mark.parametrize("single", [0.006, 0.024])
def test_how_much_slid_is_told_also_where_the_lines_have_worn_even(single):
    """k w N put into a generator of springs, whose lines share the load by what they have lost: it moves wear, and makes none."""
    wear = ran(load=66.0, single_um=1e3 * single, softness=1.1, bridged=True)
    roll, _, depth = wear.table
    gears = helical_gears(wear)
    fit = fit_wear_law(*gears, sum(gear.reference_radius for gear in gears), roll, depth.mean(axis=1), np.full(len(roll), 3e-4))[
        0
    ]
    assert 2.0 / 3.0 * single < fit.amount < 1.1 * single  # wear evens out the most where sliding is fast
    if single == 0.024:  # the even term has taken the place of sliding
        assert fit.coefficients[0] < 0.3 * single and fit.coefficients[1] > 0.002


def test_an_even_loss_alone_is_no_sliding():
    gears = pair(25.0, 10.0)
    fits = fit_wear_law(*gears, inside(*gears, 60), np.full(60, 0.005), np.full(60, 1e-5))
    assert {fit.sharing for fit in fits} == {LoadSharing.NONE, LoadSharing.LINES}
    for fit in fits:
        assert fit.amount == pytest.approx(0.0, abs=1e-9)


def test_an_even_loss_opens_the_backlash_by_itself_along_the_normal():
    """5 µm everywhere in a million cycles: the arc is lost r / (r_b cos β_b) times as fast, the normal backlash as fast."""
    gears = pair(25.0, 10.0)
    fits = fit_wear_law(*gears, inside(*gears, 60), np.full(60, 0.005), np.full(60, 1e-5))
    assert cycles_left(fits, 1e6, 0.020, "backlash").value == pytest.approx(3e6, rel=1e-3)
    arc = 0.020 * gears[0].arc_per_depth
    assert cycles_left(fits, 1e6, arc, "thickness").value == pytest.approx(3e6, rel=1e-3)
