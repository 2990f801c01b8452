"""What pooled sections hide: hollows of known depth in thin scans, and flanks that have none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints, flank_points
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.wear.by_surfaces import surface_teeth
from gearwear.wear.flank_arcs import ACROSS, FlankArcs, _as_they_scatter, worn_arcs
from gearwear.wear.hollows import _within, find_hollows, pitted
from gearwear.wear.regions import find_wear
from gearwear.wear.section_sums import SectionBand, SectionSums
from gearwear.wear.thickness import SectionThickness
from tests.placing.placing import designed
from tests.wear.sections import section_thickness

GEAR = designed()
NOISE = 0.006
POINTS = 22_000
TOOTH = 7
NOMINAL = float(GEAR.thickness(GEAR.reference_radius))
TURN = GEAR.reference_radius / GEAR.normal_lever


def scanned(seed: int, depth: float, wide: float, middle: float, everywhere: float = 0.0) -> SurfacePoints:
    """Points at random per unit of area. The left flank of a tooth has a raised cosine, `wide` mm along the face and 14 mm of roll, at the reference
    circle; every left flank a loss in proportion to the way from the pitch point and to the height, `everywhere` mm at the tip."""
    random = np.random.default_rng(seed)
    tooth, side = random.integers(GEAR.teeth, size=POINTS), random.choice([1, -1], POINTS)
    roll = np.sqrt(random.uniform(GEAR.form_roll**2, GEAR.tip_roll**2, POINTS))
    height = random.uniform(0.0, GEAR.face_width, POINTS)
    far = np.clip(np.hypot((roll - GEAR.reference_roll) / 7.0, (height - middle) / (0.5 * wide)), 0.0, 1.0)
    lost = depth * 0.5 * (1.0 + np.cos(np.pi * far)) * (tooth == TOOTH)
    slid = np.abs(roll - GEAR.reference_roll) / (GEAR.tip_roll - GEAR.reference_roll)
    lost = (lost + everywhere * slid * height / GEAR.face_width) * (side == 1)
    return flank_points(GEAR, tooth, side, roll, height).with_deviation(NOISE * random.standard_normal(POINTS) - lost)


def measured(points: SurfacePoints, worn: frozenset[Side] = frozenset()) -> tuple[SectionThickness, SectionThickness]:
    """Thickness by the sections alone, and with what they hide."""
    cells = bin_points(points, CellGrid.for_scan(GEAR, POINTS))
    wear = find_wear(cells, NOISE, worn)
    alone = section_thickness(points, GEAR, NOISE)
    sections = SectionSums.of(points, SectionBand.of(GEAR))
    arcs = worn_arcs(cells, wear.mask, worn, sections.band, NOISE, None)
    if arcs is None:
        return alone, alone
    hollows = find_hollows(arcs, pitted(cells), worn, alone.widths, sections, alone.as_made)
    surfaces = surface_teeth(alone.arc, alone.as_made, arcs, worn, pitted(cells))
    return alone, replace(alone, hollows=hollows, surfaces=surfaces)


@pytest.mark.long
@pytest.mark.parametrize(("wide", "depth"), [(8.0, 0.02), (8.0, 0.08), (12.0, 0.15)])
def test_the_bottom_of_a_hollow_is_not_averaged_away(wide, depth):
    """Of 20 scans each: squared errors in standard deviations below the 0.999 quantile of χ², where those of sections alone are above, and 95 %
    intervals that hold."""
    least, errors, stds, held, before = NOMINAL - TURN * depth, [], [], [], []
    for seed in range(20):
        alone, found = measured(scanned(seed, depth, wide, 6.0 + 0.1 * seed))
        assert alone.pooled > 5
        assert TOOTH in found.hollows.teeth
        told = found.thinnest()
        errors.append(told.value - least)
        stds.append(told.std)
        held.append(told.low <= least <= told.high)
        before.append((alone.thinnest().value - least) / alone.thinnest().std)
    pulls = np.array(errors) / stds
    assert np.sum(pulls**2) < stats.chi2.ppf(0.999, 20) < np.sum(np.square(before))
    assert sum(held) >= 18
    assert np.mean(stds) < 0.009


def test_a_side_worn_more_and_more_along_the_face_has_no_hollow_where_nothing_slides():
    """No smooth surface follows the ridge there; by how much it lies below it follows the wear, and is no hollow."""
    alone, found = measured(scanned(3, 0.0, 1.0, 6.0, everywhere=0.3), frozenset({Side.LEFT}))
    assert len(found.hollows.teeth) == GEAR.teeth
    assert abs(found.thinnest().value - NOMINAL) < 2.0 * found.thinnest().std
    assert abs(found.thinnest().value - alone.thinnest().value) < 0.005


def test_an_unworn_gear_is_asked_for_no_hollow():
    alone, found = measured(scanned(1, 0.0, 1.0, 6.0))
    assert found.hollows is None
    assert found.thinnest() == alone.thinnest()


def test_steep_wear_that_is_alike_along_the_face_has_no_hollow():
    """It bends within cells, most of all by the form circle: where their few points happen to lie is no form. By its formula the flank runs straight
    along the face."""
    points = scanned(6, 0.0, 1.0, 6.0)
    roll, band = points.own_roll(GEAR), SectionBand.of(GEAR)
    slope, turn_over = 0.02, GEAR.reference_roll + 1.5 * band.half
    lost = (slope * np.maximum(turn_over - roll, 0.0) + 0.6 * np.exp((GEAR.form_roll - roll) / 0.8)) * (points.side == 1)
    _, found = measured(points.with_deviation(points.deviation - lost), frozenset({Side.LEFT}))
    true = NOMINAL - TURN * slope * 1.5 * band.half
    off = np.array([tooth.least for tooth in found.teeth()]) - true
    assert len(found.hollows.teeth) == GEAR.teeth
    of_median = 1.253 * np.median([tooth.least_std for tooth in found.teeth()]) / np.sqrt(GEAR.teeth)
    assert abs(np.median(off)) < 3.0 * of_median
    assert found.thinnest().low <= true <= found.thinnest().high


ALIKE = np.ones((2, 41))


def within(flanks, number, made, width, seen=None):
    """Of sections that were all seen, where nothing else is said."""
    return _within(flanks, number, made, width, np.ones(len(made), dtype=bool) if seen is None else seen)


def test_cells_are_as_sure_as_they_scatter_along_the_face_on_the_side_that_is_worn():
    """Means that scatter three times their deviation on left flanks have nine times the variance; those that scatter by it, and right flanks, keep theirs."""
    shape = (12, 2, 40, 6)
    scatter = np.where(np.arange(shape[3]) < 3, 3.0, 1.0) * 0.002
    means = SimpleNamespace(
        variance=np.full(shape, 0.002**2),
        held=np.ones(shape, dtype=bool),
        deviation=scatter * np.random.default_rng(2).normal(size=shape),
        offset=np.zeros((2, *shape)),
    )
    worn = np.zeros(shape, dtype=bool)
    worn[:6, 0] = True
    variance = _as_they_scatter(means, slice(0, None), worn) / means.variance
    assert variance[:6, 0, :, :3] == pytest.approx(9.0, rel=0.3)
    assert variance[:6, 0, :, 3:] == pytest.approx(1.0, rel=0.3)
    assert (variance[6:] == 1.0).all() and (variance[:, 1] == 1.0).all()
    few = np.zeros(shape, dtype=bool)
    few[:2, 0] = True  # of two flanks of twelve it may be their form
    assert _as_they_scatter(means, slice(0, None), few) == pytest.approx(means.variance)


def test_a_bottom_that_nobody_saw_is_none():
    """A surface that runs on downwards from what was seen: the least is that of what was seen."""
    a, half, n = 0.001, 4, 41
    slope = -a * np.arange(n)
    curve = np.tile(slope, (1 + len(ACROSS), 8, 1))
    flanks, flat = [in_sections(curve), in_sections(0.0 * curve)], np.zeros(n)
    seen = np.arange(n) <= 20
    assert within(flanks, ALIKE, flat, 9)[0][20] == pytest.approx(a * (half + 2))
    assert within(flanks, ALIKE, flat, 9, seen)[0][20] == pytest.approx(0.0)
    assert within(flanks, ALIKE, flat, 9, seen)[0][18] == pytest.approx(a * 2)
    assert within(flanks, ALIKE, flat, 9, seen)[0][35] == 0.0


def in_sections(values):
    """Arcs of which each coefficient is that of a section."""
    return FlankArcs.of(values, np.eye(values.shape[-1]))


def test_within_a_window_a_parabola_hides_what_its_mean_says():
    """Of a k², k = −h … h: the mean is a h (h + 1) / 3, the least 0; two flanks alike hide twice that."""
    a, half, n = 0.001, 4, 41
    parabola, flat = a * (np.arange(n) - 20.0) ** 2, np.zeros(n)
    curve = np.tile(parabola, (1 + len(ACROSS), 8, 1))
    depth, std, spread = within([in_sections(curve)] * 2, ALIKE, flat, 2 * half + 1)
    assert depth[20] == pytest.approx(2.0 * a * half * (half + 1) / 3.0)
    assert spread[:, 20] == pytest.approx([(a * np.arange(-half, half + 1) ** 2).std()] * 2)
    assert std == pytest.approx(flat, abs=1e-12)
    # The same as it was made with spreads nothing that a scan of few points could miss.
    by_make = within([in_sections(0.0 * curve)] * 2, ALIKE, 2.0 * parabola, 2 * half + 1)
    assert by_make[0] == pytest.approx(depth)
    assert by_make[2] == pytest.approx(np.zeros((2, n)), abs=1e-12)
    # Cut off at the end of the face; the least is looked for half a window beyond its own.
    assert depth[0] == pytest.approx(2.0 * (parabola[: half + 1].mean() - parabola[half + 2]))
    # The band lies 5 µm above the radius itself.
    above = curve + 0.005 * (np.arange(len(curve)) > 0)[:, None, None]
    assert within([in_sections(above), in_sections(curve)], ALIKE, flat, 2 * half + 1)[0] == pytest.approx(depth + 0.005)


def test_a_flank_that_is_even_along_the_face_has_no_hollow_but_by_chance():
    """Sections that are known to 1 µm each, and all alike: the least of nine and more lies below their mean by chance, in every window; about half of
    these are no lower than chance has it, and what is left is less than half. Of a hollow of 10 µm squares take a twentieth at most."""
    random, number, half = np.random.default_rng(2), 400, 4
    flat, none = np.zeros(number), np.zeros((1 + len(ACROSS), 200, number))
    expected, draws = 0.001 * random.standard_normal(number), 0.001 * random.standard_normal((200, number))
    even = in_sections(none + expected + draws)
    depth, _, _ = within([even, in_sections(none)], np.ones((2, number)), flat, 2 * half + 1)
    by_chance = [
        expected[i - half : i + half + 1].mean() - expected[i - half : i + half + 1].min() for i in range(half, number - half)
    ]
    assert 0.3 < (depth == 0.0).mean() < 0.7
    assert depth.mean() < 0.5 * np.mean(by_chance)
    hollow = expected + np.where(np.arange(number) == 200, -0.01, 0.0)
    deep, _, _ = within([in_sections(none + hollow + draws), in_sections(none)], np.ones((2, number)), flat, 2 * half + 1)
    plain = (none + hollow + draws).mean(axis=1)[0]
    assert deep[200] == pytest.approx(plain[196:205].mean() - plain[200], rel=0.05)


def test_arcs_by_few_coefficients_are_those_in_all_sections():
    """Less what flanks have in common, too: surfaces are kept by what is along the face, however many sections lie across it."""
    rng = np.random.default_rng(4)
    few, at, shared = rng.normal(size=(6, 40, 9)), rng.uniform(size=(41, 9)), rng.normal(size=(6, 41))
    by_few = [FlankArcs.of(values, at).without(shared) for values in (few, few + 1.0)]
    in_all = [in_sections(values @ at.T - shared[:, None]) for values in (few, few + 1.0)]
    for one, other in zip(*(within(flanks, ALIKE, np.zeros(41), 5) for flanks in (by_few, in_all)), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)
    assert by_few[0].at_radius.size == 40 * 9


def test_the_mean_of_a_section_is_that_of_its_points():
    """All of them at one place, three sections off the bottom, on one flank; at the bottom on the other."""
    a, n = 0.001, 41
    parabola = a * (np.arange(n) - 20.0) ** 2
    curve, number = np.tile(parabola, (1 + len(ACROSS), 8, 1)), np.zeros((2, n))
    number[0, 23], number[1, 20] = 12.0, 12.0
    depth, _, spread = within([in_sections(curve)] * 2, number, np.zeros(n), 9)
    assert depth[20] == pytest.approx(a * 3.0**2, rel=1e-5)
    assert spread[:, 20] == pytest.approx([0.0, 0.0], abs=1e-5)


def test_a_lean_across_the_band_hides_nothing_and_spreads_nothing():
    """Sections have the straight line through their points."""
    curve = np.zeros((1 + len(ACROSS), 8, 41))
    curve[1:] += 0.05 * ACROSS[:, None, None]
    for values in within([in_sections(curve), in_sections(0.0 * curve)], ALIKE, np.zeros(41), 5):
        assert values == pytest.approx(np.zeros(values.shape), abs=1e-12)


def test_where_points_scatter_more_than_the_surface_says_its_bottom_is_doubted():
    """One of the sections that are pooled with the least scatters by 40 µm more than noise and surface: a pit may be there."""
    _, found = measured(scanned(1, 0.08, 8.0, 6.1))
    tooth = found.teeth()[TOOTH]
    beside = int(np.argmin(np.abs(found.z - tooth.at_z))) + found.widths[TOOTH] // 2
    (known,) = found.hollows.spread[found.hollows.teeth == TOOTH]
    for extra, doubted in ((0.0, False), (0.04, True)):
        scatter = found.scatter.copy()
        scatter[TOOTH] = NOISE**2  # no more than noise, but there
        scatter[TOOTH, 0, beside] += (known[0, beside] / TURN) ** 2 + extra**2
        told = replace(found, scatter=scatter).teeth()[TOOTH]
        assert (told.least_std > 0.04) == doubted
        assert told.at_z == tooth.at_z
