"""Teeth with worn places by the surfaces of their flanks, by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.wear.by_surfaces import WIDER, SurfaceTeeth, surface_teeth
from gearwear.wear.flank_arcs import FlankArcs, WornArcs, worn_arcs
from gearwear.wear.regions import find_wear
from gearwear.wear.section_sums import SectionBand
from gearwear.wear.thickness import SectionThickness

TEETH, N = 9, 24
Z = np.linspace(0.25, 11.75, N)
MADE, NONE, NO_PITS = np.full((TEETH, N), 6.0), frozenset(), np.zeros(TEETH, dtype=bool)
DIP = -0.1 * np.exp(-((Z - 5.0) ** 2))
BOTH = {(1, Side.LEFT): DIP, (1, Side.RIGHT): np.full(N, -0.01)}


def arcs_of(curves, worn=None, seen=None):
    """Of (tooth, side): what each flank's arc differs by from as made, (n_z,) mm; `worn` are those with wear, else all."""
    arcs, which = {}, np.zeros((TEETH, 2), dtype=bool)
    for (tooth, side), curve in curves.items():
        arcs[tooth, side] = FlankArcs.of(np.broadcast_to(curve, (6, 8, N)), np.eye(N))
    for tooth, side in curves if worn is None else worn:
        which[tooth, side.index] = True
    return WornArcs(arcs, np.ones((TEETH, 2, N), dtype=bool) if seen is None else seen, which)


def found(arcs, section=MADE, worn=NONE, pits=NO_PITS):
    return surface_teeth(section, MADE, arcs, worn, pits)


def test_it_is_as_made_with_both_flanks_of_the_teeth_that_are_worn():
    told = found(arcs_of(BOTH))
    assert list(told.teeth) == [1]
    assert told.arc[0] == pytest.approx(6.0 + DIP - 0.01)
    assert told.std == pytest.approx(0.0) and told.luck == pytest.approx(0.0)
    assert found(arcs_of({})) is None


def test_what_a_smooth_surface_does_not_follow_it_does_not_tell():
    """Pits; the ridge that all flanks of a side worn throughout have; what is broken off; and where a worn flank was not seen."""
    assert found(arcs_of(BOTH), pits=np.arange(TEETH) == 1) is None
    assert found(arcs_of(BOTH, worn=[(1, Side.LEFT)]), worn=frozenset({Side.LEFT})) is None
    assert found(arcs_of(BOTH, worn=[(1, Side.LEFT)]), worn=frozenset({Side.RIGHT})) is not None
    assert found(arcs_of({(1, Side.LEFT): DIP})) is None
    gone = np.where(abs(Z - 5.0) < 2.0, np.nan, MADE)
    assert np.nanmin(found(arcs_of(BOTH), section=gone).arc) > 5.97
    assert found(arcs_of(BOTH), section=np.full_like(MADE, np.nan)) is None
    seen = np.ones((TEETH, 2, N), dtype=bool)
    seen[1, Side.LEFT.index] = Z > 8.0
    assert np.nanmin(found(arcs_of(BOTH, seen=seen)).arc) > 5.97


def test_the_least_lies_between_that_of_what_is_expected_and_those_that_are_drawn():
    """Flanks even along the face and known to 5 µm in each section by itself: the sum's least of 24 is expected 1.95 √2 σ lower; half of that is told, and is in the ±."""
    random, flat = np.random.default_rng(4), {}
    for side in Side:
        draws = 0.005 * random.standard_normal((6, 400, N))
        flat[1, side] = FlankArcs.of(draws - draws.mean(axis=1, keepdims=True), np.eye(N))
    worn = np.zeros((TEETH, 2), dtype=bool)
    worn[1] = True
    told = found(WornArcs(flat, np.ones((TEETH, 2, N), dtype=bool), worn))
    (value,), (std,), _ = told.least(0.003)
    sigma = 0.005 * math.sqrt(2.0)
    assert value == pytest.approx(6.0 - 0.5 * 1.95 * sigma, abs=0.0006)
    assert std == pytest.approx(math.hypot(sigma, 0.5 * 1.95 * sigma, 0.003), rel=0.1)


def test_surfaces_go_with_teeth_that_are_thicker():
    """Where that is not known of a section, as on average."""
    surfaces = found(arcs_of(BOTH | {(2, side): DIP for side in Side}))
    by = np.arange(TEETH)[:, None] * 0.01 + np.zeros(N)
    by[1, 3] = np.nan
    assert surfaces.shifted(by).arc == pytest.approx(surfaces.arc + np.array([[0.01], [0.02]]))


@pytest.mark.parametrize("internal", [False, True], ids=["spur", "ring"])
def test_a_surface_is_read_at_the_radius_where_thickness_is_measured(internal):
    """A ramp along the profile, none at one end of it and 60 µm at the other: what it is there, on a ring too, whose roll falls from form circle to tip."""
    gear, number, random = Gear.from_spec(GearSpec("", 40, 3.0, 12.0, internal=internal)), 40_000, np.random.default_rng(3)
    tooth, side = random.integers(gear.teeth, size=number), random.choice([1, -1], number)
    roll = np.sqrt(random.uniform(*sorted((gear.form_roll**2, gear.tip_roll**2)), number))
    share = (roll - gear.form_roll) / (gear.tip_roll - gear.form_roll)
    lost = np.where((tooth == 5) & (side == 1), 0.06 * share, 0.0)
    height, scatter = random.uniform(0.0, 12.0, number), 0.002 * random.standard_normal(number)
    points = flank_points(gear, tooth, side, roll, height).with_deviation(scatter - lost)
    cells, band = bin_points(points, CellGrid.for_scan(gear, number)), SectionBand.of(gear)
    arcs = worn_arcs(cells, find_wear(cells, 0.002, NONE).mask, NONE, band, 0.002, None)
    there = (band.reach - gear.form_roll) / (gear.tip_roll - gear.form_roll)
    assert np.median(arcs.of[5, Side.LEFT].expected[0]) == pytest.approx(-gear.arc_per_depth * 0.06 * there, rel=0.06)


def sections(least, std, surface, its, others=6.0):
    """Of teeth 6 mm thick, known to 1 µm, but for one that is even along the face: `least` by its sections, known to `std`, and `surface` by its surfaces, known to `its`."""
    arc, stds = np.full((TEETH, N), others), np.full((TEETH, N), 1e-3)
    arc[1], stds[1] = least, std
    surfaces = SurfaceTeeth(np.array([1]), np.full((1, N), surface), np.full((1, N), its), np.zeros(1))
    return SectionThickness(
        radius=40.0, z=Z, nominal=6.0, arc=arc, flank=np.zeros((TEETH, 2, N)), count=np.full((TEETH, 2, N), 12.0), std=stds,
        noise=1e-3, as_made=MADE, surfaces=surfaces,
    )  # fmt: skip


def test_sections_and_surfaces_count_as_well_as_each_is_known_and_what_they_differ_is_in_the_deviation():
    both = sections(5.9, 0.004, 5.88, 0.002)
    alone = replace(both, surfaces=None)
    section, told = alone.teeth()[1], both.teeth()[1]
    share = section.least_std**2 / (section.least_std**2 + 0.002**2)
    assert told.least == pytest.approx(section.least + share * (5.88 - section.least))
    assert told.least_std == pytest.approx(math.hypot(math.sqrt(share) * WIDER * 0.002, 0.5 * (section.least - 5.88)))
    assert told.greatest_loss == pytest.approx(6.0 - told.least, abs=1e-4)
    assert both.thinnest().tooth == 1 and both.thinnest().value == pytest.approx(told.least, abs=1e-3)
    assert both.teeth()[2] == alone.teeth()[2]


def test_the_interval_goes_down_to_what_surfaces_alone_say():
    """They lie 20 µm lower and are known five times worse."""
    told = sections(5.9, 0.002, 5.88, 0.01).thinnest()
    assert told.value > 5.89
    assert told.low == pytest.approx(5.88 - 1.96 * WIDER * 0.01, abs=1e-4)


def test_the_others_compete_with_them():
    assert sections(5.99, 0.002, 5.98, 0.002, others=5.9).thinnest().tooth != 1
    assert sections(5.99, 0.002, 5.98, 0.002).thinnest().tooth == 1
