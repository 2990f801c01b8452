"""The thinnest of worn teeth that few sections measured, by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.wear.flank_arcs import FlankArcs, WornArcs
from gearwear.wear.unmeasured import FEWEST_TEETH, unmeasured_teeth

TEETH, N, TURN = 9, 24, 1.1
Z = np.linspace(0.25, 11.75, N)


def arcs_of(curves, stds=0.0, seen=None):
    """Of (tooth, side): what each flank's arc differs by from as made, (n_z,) or a number, mm; drawn evenly either way."""
    both, worn = {}, np.zeros((TEETH, 2), dtype=bool)
    for (tooth, side), curve in curves.items():
        draws = np.broadcast_to(curve, (6, 2, N)) + stds * np.array([1.0, -1.0])[:, None]
        both[tooth, side], worn[tooth, side.index] = FlankArcs.of(draws, np.eye(N)), True
    return WornArcs(both, np.ones((TEETH, 2, N), dtype=bool) if seen is None else seen, worn)


def found(arcs, measured=None, region_std=0.01, arc=6.0):
    """Of teeth made 6 mm thick; `measured` are their arcs in sections by tooth."""
    section = np.full((TEETH, N), np.nan)
    for tooth, value in (measured or {}).items():
        section[tooth] = value
    regions = [SimpleNamespace(tooth=tooth, side=side, max_depth_std=region_std) for tooth, side in arcs.of]
    thickness = SimpleNamespace(
        arc=section, as_made=np.full((TEETH, N), 6.0), z=Z, turn=TURN, nominal=6.0, drawn=None, common_std=0.0
    )
    return unmeasured_teeth(thickness, SimpleNamespace(regions=regions), arcs)


def test_it_is_as_made_with_both_flanks_where_they_are_lowest():
    dip = -0.1 * np.exp(-((Z - 5.0) ** 2))
    told = found(arcs_of({(1, Side.LEFT): dip, (1, Side.RIGHT): np.full(N, -0.05)}))
    assert told.teeth == (told.least,)
    assert told.least.tooth == 1 and told.least.value == pytest.approx(6.0 - 0.05 - np.abs(dip).max())
    assert abs(told.least.at_z - 5.0) < 0.5
    assert told.least.std == pytest.approx(TURN * 0.01 * math.sqrt(2.0))


def test_where_nobody_saw_the_flank_its_surface_is_no_thickness():
    """It runs down to 0.1 mm beyond the last points."""
    curve, seen = np.where(Z > 8.0, -0.1, -0.02), np.ones((TEETH, 2, N), dtype=bool)
    seen[1, Side.LEFT.index] = Z < 8.0
    one = {(1, Side.LEFT): curve}
    assert found(arcs_of(one)).least.value == pytest.approx(5.9)
    assert found(arcs_of(one, seen=seen)).least.value == pytest.approx(5.98)
    seen[1, Side.LEFT.index] = False
    assert found(arcs_of(one, seen=seen)) is None


def test_the_least_of_surfaces_that_are_drawn_is_lower_by_their_luck():
    """Of a flank that is even along the face and known to 5 µm in each section by itself: some 10 µm; it is told where it is expected."""
    draws = 0.005 * np.random.default_rng(4).standard_normal((6, 400, N))
    draws += -0.05 - draws.mean(axis=1, keepdims=True)
    worn = np.zeros((TEETH, 2), dtype=bool)
    worn[1, Side.LEFT.index] = True
    arcs = WornArcs({(1, Side.LEFT): FlankArcs.of(draws, np.eye(N))}, np.ones((TEETH, 2, N), dtype=bool), worn)
    told = found(arcs, region_std=0.002).least
    assert told.value == pytest.approx(5.95)
    assert told.std == pytest.approx(math.hypot(TURN * 0.002, 0.005), rel=0.1)


def test_how_high_surfaces_lie_is_known_from_teeth_that_sections_measured():
    """These lie 20 µm above theirs at one end and 40 at the other, give or take 3; one was chipped and counts for nothing."""
    curves = {(tooth, side): np.zeros(N) for tooth in range(FEWEST_TEETH + 2) for side in Side}
    rise = 0.02 + 0.02 * (Z - Z[0]) / (Z[-1] - Z[0])
    apart = 0.003 * np.linspace(-1.0, 1.0, FEWEST_TEETH)
    measured = {tooth: 6.0 + rise + apart[tooth] for tooth in range(FEWEST_TEETH)} | {FEWEST_TEETH: 5.0 + 0.0 * rise}
    told = found(arcs_of(curves, stds=0.001), measured, region_std=1.0)
    (tooth,) = told.teeth
    assert tooth.tooth == FEWEST_TEETH + 1
    assert tooth.value == pytest.approx(6.02, abs=0.002) and tooth.at_z < 1.0
    assert 0.001 < tooth.std < 0.006
    few = {tooth: measured[tooth] for tooth in range(FEWEST_TEETH - 1)}
    assert found(arcs_of(curves), few, region_std=1.0).teeth[0].std > 1.0


def test_any_of_them_may_be_the_thinnest_and_none_is_for_having_looked():
    """Of eight alike that are known to 10 µm the lowest is low by its luck."""
    values = 6.0 - 0.2 + 0.01 * np.random.default_rng(3).standard_normal(8)
    told = found(arcs_of({(tooth, Side.LEFT): values[tooth] - 6.0 for tooth in range(8)}), region_std=0.01 / TURN)
    assert told.least.tooth == values.argmin()
    assert values.min() + 0.005 < told.least.value < values.mean() + 0.005
    assert told.least.low < 5.8 < told.least.high


@pytest.mark.parametrize("measured", [(1,), (0, 1, 2, 3)])
def test_of_teeth_that_sections_measured_nothing_is_said(measured):
    assert found(arcs_of({(1, Side.LEFT): -0.1}), dict.fromkeys(measured, 6.0)) is None


def test_no_more_is_said_than_is_known():
    assert found(arcs_of({(1, Side.LEFT): -0.1}), region_std=math.nan) is None
    assert found(arcs_of({})) is None
    assert found(arcs_of({(1, Side.LEFT): -0.001})).least.high == 6.0  # no thicker than it was made
