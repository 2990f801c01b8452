"""Views that are wrong are brought to the others by what they overlap: known faults put in and asked back."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.surface import FLANK, OTHER, SurfacePoints, locate
from gearwear.placing.accord import OFFSET, OWN, SCALE, view_accords
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.pose import small_motion
from gearwear.placing.together import Taken, doubtful, odd_ones_out, remedy, said_of_views, spread_columns, summed
from gearwear.placing.views import PlacedScan, place
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, SyntheticScan, Views, make_scan

GEAR = designed()
NOISE = 6.0
RECIPE = replace(Recipe(pose="mild", jitter=1.0, noise_um=NOISE), views=Views(3, 0.7)).of_size(22_000)
COAT = 9.0


@cache
def good(count: int = 3) -> SyntheticScan:
    return make_scan(replace(RECIPE, views=Views(count, 0.7)), 3)


@cache
def coated() -> SyntheticScan:
    """The same scan with a coat."""
    return make_scan(replace(RECIPE, effects=(Effect("coating", {"thickness_um": COAT}),)), 3)


@cache
def without_fault() -> PlacedScan:
    return place(good().views, GEAR, [None] * 3)


def with_fault(number: int, points) -> PlacedScan:
    views = [points if i == number else view for i, view in enumerate(good().views)]
    return place(views, GEAR, [None] * len(views))


def said(placed: PlacedScan) -> str:
    views = placed.views
    scatters = [view.registration.noise for view in views]
    return "; ".join(
        said_of_views([view.accord for view in views], [view.taken for view in views], placed.told, 1e-3 * NOISE, scatters)
    )


def same_metal(one: PlacedScan, other: PlacedScan) -> float:
    """Mean difference of the flanks of two placed scans, in what chance makes of it."""
    means = []
    for placed in (one, other):
        flank = placed.located.take(placed.located.surface == FLANK)
        means.append(float(np.median(flank.deviation)))
    return (means[0] - means[1]) / (1.25e-3 * NOISE * math.sqrt(2.0 / 8_000))


@pytest.mark.parametrize(("number", "ppm"), [pytest.param(0, 800.0, marks=pytest.mark.long), (1, -2500.0)])
def test_a_scale_is_taken_out_of_the_view_that_has_it(number, ppm):
    placed = with_fault(number, good().views[number] * (1.0 + 1e-6 * ppm))
    taken = [view.taken for view in placed.views]
    std = math.sqrt(taken[number].covariance[SCALE, SCALE])
    assert abs(taken[number].scale - 1e-6 * ppm) < 4.0 * std < 1e-4
    assert not any(one.any for i, one in enumerate(taken) if i != number)
    assert placed.told and f"view {number + 1} is out of scale" in said(placed) and said(placed).count("view") == 1
    # What is left between the views is what good ones leave, and the metal lies where it lies without the fault.
    assert placed.views[number].left == pytest.approx(without_fault().views[number].left, rel=0.05)
    assert placed.views[number].mismatch > 2.0 * placed.views[number].left
    assert abs(same_metal(placed, without_fault())) < 5.0


@pytest.mark.long
def test_the_pose_of_a_scaled_view_holds_for_its_points_without_the_scale():
    """A view far from its own origin: what is reported takes its points to where they lie without the fault, to what a pose is known."""
    far = good().views[1] + np.array([300.0, -200.0, 100.0])
    placed = with_fault(1, 1.002 * far)
    off = placed.views[1].apply(1.002 * far) - without_fault().views[1].apply(good().views[1])
    taken = placed.views[1].taken
    assert np.sqrt((off**2).sum(axis=1).mean()) < 1e-3 + 4.0 * math.sqrt(taken.covariance[SCALE, SCALE]) * 45.0


def test_an_offset_is_taken_out_of_the_view_that_has_it():
    placed = with_fault(2, coated().views[2])
    taken = [view.taken for view in placed.views]
    std = math.sqrt(taken[2].covariance[OFFSET, OFFSET])
    assert abs(taken[2].offset - 1e-3 * COAT) < 4.0 * std < 2e-3
    assert [one.any for one in taken] == [False, False, True] and placed.told
    assert "view 3 stands" in said(placed) and "above the others" in said(placed)
    assert abs(same_metal(placed, without_fault())) < 5.0 + std / 3.0 / 1e-4


def test_of_two_views_the_difference_is_taken_out_and_which_is_wrong_is_not_told():
    views = [good(4).views[0], good(4).views[1] * 1.002]
    placed = place(views, GEAR, [None] * 2)
    low, high = (view.taken.scale for view in placed.views)
    assert high - low == pytest.approx(2e-3, abs=1e-4)
    assert high == pytest.approx(-low, rel=0.05)
    assert not placed.told and "which views are right the overlaps do not tell" in said(placed)
    accords, scatters = [view.accord for view in placed.views], [view.registration.noise for view in placed.views]
    assert doubtful(accords, placed.told, 1e-3 * NOISE, scatters)


def test_views_that_hardly_overlap_are_judged_by_their_own_fits():
    """Nothing is taken out then: the third may be out of scale, or the gear of a slightly other profile there."""
    scan = make_scan(replace(RECIPE, views=Views(3, 0.0)), 3)
    plain = place(scan.views, GEAR, [None] * 3)
    wrong = place([*scan.views[:2], scan.views[2] * 1.003], GEAR, [None] * 3)
    assert not np.any(odd_ones_out([view.accord for view in plain.views], 1e-3 * NOISE)) and not said(plain)
    assert odd_ones_out([view.accord for view in wrong.views], 1e-3 * NOISE)[0].tolist() == [False, False, True]
    assert not any(view.taken.any for view in wrong.views)
    accord = wrong.views[2].accord
    assert abs(accord.own_scale - 3e-3) < 5.0 * accord.own_scale_std + 1e-4
    assert "view 3 overlaps the others too little" in said(wrong)
    lifted = make_scan(replace(RECIPE, views=Views(3, 0.0), effects=(Effect("coating", {"thickness_um": COAT}),)), 3)
    proud = place([lifted.views[0], *scan.views[1:]], GEAR, [None] * 3)
    assert np.array(odd_ones_out([view.accord for view in proud.views], 1e-3 * NOISE)).tolist() == [
        [False] * 3,
        [True, False, False],
    ]
    accord = proud.views[0].accord
    assert abs(accord.own_offset - 1e-3 * COAT) < 5.0 * accord.own_offset_std


def test_a_view_stitched_of_two_pieces_is_doubted():
    points = good().views[0].copy()
    points[::2] += np.array([0.03, 0.0, 0.0])
    placed = with_fault(0, points)
    assert "view 1" in said(placed) and "badly stitched within itself" in said(placed)
    scatters = [view.registration.noise for view in placed.views]
    assert doubtful([view.accord for view in placed.views], placed.told, 1e-3 * NOISE, scatters)


def binned_views(motion: np.ndarray) -> list:
    """Cells of the good views where they truly lie, the first one moved."""
    placed, cells = without_fault(), []
    grid = CellGrid.for_scan(GEAR, 11_000)
    for i, (points, view) in enumerate(zip(good().views, placed.views, strict=True)):
        here = view.apply(points)
        located = locate(small_motion(motion).apply(here) if i == 0 else here, GEAR, view.registration.bands)
        cells.append(bin_points(located, grid, clip=0.3))
    return cells


def test_a_place_is_taken_out_as_far_as_overlaps_tell_it():
    """A view moved by 15 and −10 µm and turned by 0.02°: the views are moved back against each other by that, their mean by nothing."""
    motion = np.array([0.015, -0.01, 0.0, 0.0, 0.0, math.radians(0.02)])
    spreads = [np.diag([2e-3, 2e-3, 2e-3, 1e-4, 1e-4, 1e-4]) ** 2] * 3
    accords = view_accords(binned_views(motion), 1e-3 * NOISE)
    found = remedy(accords, 1e-3 * NOISE, spreads, [Taken()] * 3)
    moved = np.array([one.motion for one in found.taken])
    std = np.sqrt([np.diag(one.covariance)[:6] for one in found.taken])
    others = moved[1:].mean(axis=0)
    assert (np.abs(moved[0] - others + motion) < 4.0 * np.hypot(std[0], std[1]) + 1e-9).all()
    assert np.abs(moved.sum(axis=0)).max() < 0.2 * np.abs(motion).max()
    assert all(one.scale == 0.0 and one.offset == 0.0 for one in found.taken)
    quiet = view_accords(binned_views(np.zeros(6)), 1e-3 * NOISE)
    assert not remedy(quiet, 1e-3 * NOISE, spreads, [Taken()] * 3).any


def test_what_taking_out_leaves_uncertain():
    """Of a scale known to 20 ppm: 20 ppm of how far the tangent plane lies from the origin; summed up with an offset, both."""
    one, two = np.zeros((OWN, OWN)), np.zeros((OWN, OWN))
    one[SCALE, SCALE], two[OFFSET, OFFSET] = 20e-6**2, 5e-4**2
    normal = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    points = SurfacePoints(
        np.array([FLANK, OTHER], np.int8),
        np.zeros(2, np.int32),
        np.ones(2, np.int8),
        np.zeros(2),
        30.0 * normal,
        normal,
        np.zeros(2),
    )
    both = summed(Taken(scale=1e-3, covariance=one), Taken(offset=2e-3, covariance=two))
    assert (both.scale, both.offset) == (pytest.approx(1e-3), pytest.approx(2e-3))
    columns = spread_columns(both, points)
    assert np.linalg.norm(columns, axis=1) == pytest.approx([math.hypot(30.0 * 20e-6, 5e-4)] * 2)
