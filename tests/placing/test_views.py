"""Several views, each in a frame of its own, brought together."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.surface import FLANK, OTHER
from gearwear.errors import InputError
from gearwear.placing.together import said_of_views
from gearwear.placing.views import PlacedScan, place
from tests.placing.placing import designed, motion_off
from tests.synthetic import Effect, Patch, Recipe, Surface, SyntheticScan, Views, make_scan, pose_error

GEAR = designed()
NOISE = 8.0
RECIPE = Recipe(pose="any", jitter=1.0, noise_um=NOISE)


def said_of(placed: PlacedScan) -> list[str]:
    """What is said of the views of a scan."""
    views = placed.views
    scatters = [view.registration.noise for view in views]
    return said_of_views([view.accord for view in views], [view.taken for view in views], placed.told, 1e-3 * NOISE, scatters)


@cache
def seen(count: int, overlap: float) -> tuple[SyntheticScan, PlacedScan]:
    scan = make_scan(replace(RECIPE, views=Views(count, overlap)).of_size(40_000), count)
    return scan, place(scan.views, GEAR, [None] * count)


@pytest.mark.parametrize(("count", "overlap"), [(3, 0.5), pytest.param(4, 0.7, marks=pytest.mark.long)])
class TestPartialViews:
    @pytest.mark.long
    def test_every_view_is_where_it_was(self, count, overlap):
        """A view of five to seven teeth rests on as many flanks a side: its pulls follow a t distribution of some 9 degrees of freedom.

        All motions of all views together, at a false alarm of 1 in 1,000.
        """
        scan, placed = seen(count, overlap)
        pulls = np.array(
            [
                motion_off(view.registration.pose, pose, GEAR) / np.sqrt(np.diag(view.registration.covariance))
                for view, pose in zip(placed.views, scan.truth.poses, strict=True)
            ]
        )
        drawn = (np.random.default_rng(0).standard_t(9, (20_000, pulls.size)) ** 2).sum(axis=1)
        assert (pulls**2).sum() < np.quantile(drawn, 0.999)

    def test_all_views_are_turned_by_the_same_teeth(self, count, overlap):
        scan, placed = seen(count, overlap)
        poses = [view.registration.pose for view in placed.views]
        errors = [
            pose_error(p.rotation, p.translation, t, scan.truth.outline) for p, t in zip(poses, scan.truth.poses, strict=True)
        ]
        assert len({(error.teeth, error.flipped) for error in errors}) == 1

    def test_views_that_agree_stand_proud_of_none(self, count, overlap):
        """Some 10,000 points a view overlap; what poses known to 0.2 µm leave comes on top."""
        _, placed = seen(count, overlap)
        assert max(abs(view.offset) for view in placed.views) < 5.0 * math.hypot(1.25e-3 * NOISE / math.sqrt(10_000), 2e-4)

    def test_overlaps_are_thinned_to_what_one_view_sees(self, count, overlap):
        """As many points as the part has, seen once; noise that carries points over the edges of cells adds a few."""
        scan, placed = seen(count, overlap)
        once = (
            make_scan(replace(scan.truth.recipe, views=None), count).truth.labels.surface != Surface.END_LOW
        )  # no view saw that
        assert placed.thinned == len(scan.points) - len(placed.located)
        assert sum(view.kept for view in placed.views) == len(placed.located)
        assert [view.points for view in placed.views] == [len(points) for points in scan.views]
        assert 1.0 < len(placed.located) / once.sum() < 1.05
        flanks = placed.located.tooth[placed.located.surface == FLANK]
        per_tooth = np.bincount(flanks, minlength=12)
        # Even round the gear, whether one view or two saw a tooth.
        assert np.ptp(per_tooth) / per_tooth.mean() < 0.05


@pytest.mark.long
def test_a_view_that_stands_proud_does_so_by_what_was_put_on_it():
    """Two whole scans, one with a coat of 12 µm: each is 6 µm off their mean, and each knows its own coat."""
    plain = make_scan(replace(RECIPE, pose="none").of_size(20_000), 1)
    coat = (Effect("coating", {"thickness_um": 12.0}),)
    coated = make_scan(replace(RECIPE, pose="mild", effects=coat).of_size(20_000), 2)
    placed = place([plain.points, coated.points], GEAR, [None, None])
    error = 5.0 * 1.25e-3 * NOISE * math.sqrt(2.0 / 18_000)
    assert [view.offset for view in placed.views] == pytest.approx([-0.006, 0.006], abs=error)
    assert [view.registration.offset for view in placed.views] == pytest.approx([0.0, 0.012], abs=error)
    assert all(view.mismatch > 0.006 for view in placed.views)
    assert len(placed.located) < 0.75 * (len(plain.points) + len(coated.points))
    # Each is brought to their middle, and which of both is right is not told.
    assert [view.taken.offset for view in placed.views] == pytest.approx([-0.006, 0.006], abs=error)
    assert not placed.told and "do not tell" in said_of(placed)[-1]


def test_wear_seen_by_one_view_only_is_kept():
    """Where views do not overlap nothing is thinned, and a worn place pulls no view off the others."""
    wear = (Patch(0, 1, 300.0, (37.0, 43.0), (2.0, 12.0)),)
    scan = make_scan(replace(RECIPE, views=Views(3, 0.1), wear=wear).of_size(40_000), 5)
    placed = place(scan.views, GEAR, [None] * 3)
    for view, pose in zip(placed.views, scan.truth.poses, strict=True):
        std = np.sqrt(np.diag(view.registration.covariance))
        assert (np.abs(motion_off(view.registration.pose, pose, GEAR)) < 6.0 * std).all()
    worn = placed.located.deviation[placed.located.deviation < -0.15]
    assert len(worn) == pytest.approx((scan.truth.labels.depth > 0.15).sum(), rel=0.1)


def test_a_single_scan_is_left_as_it_is():
    scan = make_scan(RECIPE.of_size(8_000), 1)
    placed = place([scan.points], GEAR, [None])
    assert (placed.views, placed.thinned) == ((), 0)
    known = placed.located.surface != OTHER
    np.testing.assert_allclose(placed.measured[known], placed.registration.pose.apply(scan.points)[known], rtol=0.0, atol=1e-10)


def test_a_view_of_something_else_is_refused():
    scan = make_scan(RECIPE.of_size(8_000), 1)
    ball = np.random.default_rng(1).normal(size=(2_000, 3))
    ball *= 40.0 / np.linalg.norm(ball, axis=1, keepdims=True)
    with pytest.raises(InputError, match="does not fit the design"):
        place([scan.points, ball], GEAR, [None, None])


@pytest.mark.parametrize("count", [3, pytest.param(4, marks=pytest.mark.long)])
def test_views_of_one_gear_agree(count):
    """Scales and offsets of good views lie within their own ±, at a false alarm of 1 in 1,000; nothing is taken out of them, nor said."""
    _, placed = seen(count, 0.5 if count == 3 else 0.7)
    accords = [view.accord for view in placed.views]
    pulls = [one.scale / one.scale_std for one in accords] + [one.offset / one.offset_std for one in accords]
    assert max(map(abs, pulls)) < 4.0
    assert not any(view.taken.any for view in placed.views) and placed.shares is None
    assert not said_of(placed)


@pytest.mark.long
def test_the_order_of_the_points_changes_nothing():
    scan, placed = seen(3, 0.5)
    shuffled = [np.random.default_rng(4).permutation(points) for points in scan.views]
    again = place(shuffled, GEAR, [None] * len(shuffled))
    assert again.thinned == pytest.approx(placed.thinned, abs=2)
    assert again.registration.noise == pytest.approx(placed.registration.noise, rel=1e-4)
    assert again.registration.rotation_std == pytest.approx(placed.registration.rotation_std, rel=1e-3)
