"""Planar sections: two coordinates, one row of cells, areas in place of volumes."""

import math
from functools import cache

import numpy as np
import pytest

from gearwear.design.side import sides_of
from gearwear.design.surface import END_LOW
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.registration import stray_limit
from gearwear.placing.views import PlacedScan, place
from gearwear.wear.regions import find_wear
from tests.placing.placing import designed, motion_off, true_pose
from tests.synthetic import AbrasiveWear, Patch, Recipe, Rigid, SyntheticScan, make_scan, rotation_about
from tests.wear.sections import section_thickness

GEAR = designed()
NOISE = 5.0
MOVED = Rigid(rotation_about(np.array([0.0, 0.0, 0.2])), np.array([3.0, -7.0, 0.0]))
ALL_Z = (-20.0, 35.0)


def section(seed: int, wear=(), points: int = 10_000) -> SyntheticScan:
    return make_scan(Recipe(noise_um=NOISE, ends="none", jitter=1.0, wear=wear).of_size(points), seed)


def flat(scan: SyntheticScan) -> np.ndarray:
    """All slices laid into one plane, turned by 0.2 rad and moved."""
    points = true_pose(scan).apply(scan.points)
    points[:, 2] = 0.0
    return MOVED.apply(points)


@cache
def placed(seed: int = 1, worn: bool = False) -> tuple[SyntheticScan, PlacedScan]:
    scan = section(seed, (Patch(3, 1, 300.0, (37.5, 43.0), ALL_Z, 1.0),) if worn else ())
    return scan, place([flat(scan)], GEAR, [None], planar=True)


@pytest.mark.long
@pytest.mark.parametrize("scans", [4, pytest.param(16, marks=pytest.mark.long)])
def test_three_motions_are_found_within_their_standard_deviations_and_no_more_are_claimed(scans):
    pulls = []
    for seed in range(scans):
        _, own = placed(seed, worn=seed % 2 == 1)
        found = own.registration
        np.testing.assert_array_equal(found.observed, [True, True, False, False, False, True])
        assert found.notes == ()
        assert not found.covariance[~found.observed].any()
        pulls.append(motion_off(found.pose, MOVED, GEAR)[found.observed] / np.sqrt(np.diag(found.covariance))[found.observed])
    squares = (np.array(pulls) ** 2).sum(axis=0)
    drawn = (np.random.default_rng(0).standard_t(23, (40_000, scans)) ** 2).sum(axis=1)  # 24 flanks
    low, high = np.quantile(drawn, [0.0005, 0.9995])
    assert ((squares > low) & (squares < high)).all(), squares


def test_a_section_lies_at_mid_face_and_no_point_is_taken_for_an_end_face():
    scan, own = placed()
    np.testing.assert_allclose(own.registration.pose.apply(flat(scan))[:, 2], 7.5, rtol=0.0, atol=1e-12)
    assert not (own.located.surface >= END_LOW).any()


def find(own: PlacedScan):
    grid = CellGrid.for_scan(GEAR, len(own.located), planar=True)
    cells = bin_points(own.located, grid, clip=stray_limit(own.located))
    return find_wear(cells, own.registration.noise, sides_of(own.registration.datum.worn_side))


@pytest.mark.parametrize("seed", [1, 3, 5])
def test_worn_area_is_the_integral_across_the_flank(seed):
    scan, own = placed(seed, worn=True)
    (truth,) = scan.truth.flanks
    (region,) = find(own).regions
    assert (region.tooth, region.side) == (3, 1)
    area = truth.volume_mm3 / GEAR.face_width
    assert region.volume == pytest.approx(area, rel=0.01)
    assert abs(region.volume - area) < 3.0 * region.volume_std
    assert region.max_depth == pytest.approx(0.3, rel=0.1)


@pytest.mark.parametrize("seed", [0, 2, 4, 6])
def test_an_unworn_section_shows_no_region(seed):
    assert find(placed(seed)[1]).regions == ()


def test_thickness_of_a_section_takes_all_points():
    """120 µm off both flanks of two teeth: the arc at r loses 0.12 (r / r_b) a flank, at the reference circle and elsewhere."""
    wear = AbrasiveWear(120.0, 0, (2, 7))
    own = place([flat(section(9, (wear,)))], GEAR, [None], planar=True)
    for radius in (GEAR.reference_radius, 40.0):
        measured = section_thickness(own.located, GEAR, own.registration.noise, radius, np.array([7.5]))
        lost = measured.lost[:, 0]
        expected = np.where(np.isin(np.arange(12), (2, 7)), 2.0 * 0.120 * radius / GEAR.base_radius, 0.0)
        std = np.array([tooth.std for tooth in measured.teeth()])
        assert std.max() < 1.5e-3 * NOISE
        # The straight line through the points costs up to twice the mean's standard deviation at the edge of its window.
        assert (np.abs(lost - expected) < 5.0 * std).all()
        assert math.isclose(measured.nominal, GEAR.thickness(radius))
