"""Flanks whose drawing modifies them along the face, and how a pair with them ran."""

from __future__ import annotations

from dataclasses import replace

import pytest

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.side import Side
from gearwear.loaded.steel import Material
from gearwear.meshing.path import path_of_contact
from gearwear.running.conditions import Conditions, Runs
from gearwear.running.found import SecondLoop
from gearwear.running.search import find_running
from gearwear.running.study import law_basis
from gearwear.wear_law.archard import LoadSharing
from tests.running.maps import CENTRE, LOAD, PAIR, SINGLE_UM, SLICES, map_of
from tests.synthetic.ran import RanWear

LEAN = 0.03
WORN = map_of(RanWear(single_um=SINGLE_UM, load=LOAD, gap_um=-1e3 * LEAN), seed=3)
"""A pinion's left flanks that stood askew to their mates'."""


def runs(side: Side = Side.LEFT, *, gear: FlankModification | None = None, mate: FlankModification | None = None) -> Runs:
    drawn = [replace(body.spec, left=how, right=how) if how else body.spec for body, how in zip(PAIR, (gear, mate), strict=True)]
    own, other = map(Gear.from_spec, drawn)
    return Runs(replace(WORN, gear=own, side=side), other, CENTRE, LOAD, Material(), 1.5e-3 * SINGLE_UM / LOAD)


def lost(of: Runs, gap: float) -> Floats:
    """(slices,) mean depth at the end of a run, mm."""
    return of.of(Conditions(misalignment=gap))[-1].reshape(SLICES, -1).mean(axis=1)


@pytest.mark.long
@pytest.mark.parametrize("side", [Side.LEFT, Side.RIGHT])
def test_a_lean_that_the_mates_drawing_has_is_a_gap_that_closes_on_its_left_flanks(side: Side):
    plain, leaning = runs(side), runs(side, mate=FlankModification(helix_slope=LEAN))
    for gap in (0.0, side * LEAN):
        assert lost(leaning, gap) == pytest.approx(lost(plain, gap - side * LEAN), abs=1e-8)
    # The other way it is a gap twice as wide, and not the wear of the first one mirrored.
    assert lost(leaning, -side * LEAN)[:: int(side)][:2].max() < 1e-4


def test_flanks_crowned_lengthwise_carry_in_the_middle_without_a_gap_as_beside_none():
    crowned = runs(gear=FlankModification(helix_crowning=LEAN))
    assert lost(crowned, 0.0) == pytest.approx(lost(crowned, 1e-9), abs=1e-8)
    assert lost(crowned, 0.0)[SLICES // 2] > 10.0 * lost(crowned, 0.0)[0]


def traced(of: Runs) -> SecondLoop:
    low, high = path_of_contact(*PAIR, CENTRE).single_contact_pinion
    basis = law_basis(of.map, of.mate, CENTRE, LoadSharing.NONE)
    return find_running(of.map, basis, of, (of.map.roll > low) & (of.map.roll < high))


@pytest.mark.long
def test_a_gap_that_the_drawing_has_is_no_misalignment():
    leaning = traced(runs(mate=FlankModification(helix_slope=LEAN)))
    assert {effect.name for effect in leaning.effects} <= {"elastic_sharing"}
    assert leaning.after.all < 1e-3
