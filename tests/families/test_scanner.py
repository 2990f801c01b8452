"""What the scanner does to points: told sizes come out, what hides is hidden, poses lead back."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.families.fields import Frame
from benchmarks.families.gear import GearNumbers, flank_point
from benchmarks.families.instrument import AlongAxis, OneSide, RoundGear, Sector, Stretch, Turntable, Unseen
from benchmarks.families.part import Part
from benchmarks.families.rack import Tool
from benchmarks.families.sampling import FLANK, sample
from benchmarks.families.scanner import Scan, Scanner, ViewError, scan
from benchmarks.families.texture import Texture
from benchmarks.families.views import Views, clear, seen

GEAR = GearNumbers(18, 4.0, 12.0)
PART = Part(GEAR, (Tool(1.25, 0.30),))
QUIET = Scanner(points=20_000, noise=0.0)


def back(made: Scan, which: int = 0) -> np.ndarray:
    """Points of a file in the design frame."""
    rotation, translation = made.poses[which]
    return (made.files[which] - translation) @ rotation


def flank_deviation(made: Scan) -> np.ndarray:
    """Deviation of the first file's flank points by the closed form δ = rb (s (θ − θ_k) − (ψ_b − inv α_r)) of ISO 21771's involute."""
    xyz = back(made)[made.surface[: len(made.files[0])] == FLANK]
    xyz = xyz[np.hypot(xyz[:, 0], xyz[:, 1]) > GEAR.base_radius + 0.3]
    _, angle, rho = PART.angle_in_tooth(xyz)
    roll = np.sqrt(rho**2 - GEAR.base_radius**2)
    inv = roll / GEAR.base_radius - np.arctan(roll / GEAR.base_radius)
    return GEAR.base_radius * (np.abs(angle) - (GEAR.base_half_angle - inv))


def test_without_errors_flank_points_lie_on_the_involute():
    assert np.abs(flank_deviation(scan(PART, QUIET, 1))).max() < 2e-5  # float32 of coordinates up to 100 mm: 4e-6


def test_noise_and_texture_have_the_size_that_is_told():
    made = scan(PART, replace(QUIET, noise=0.006, texture=Texture((0.002, 0.001), (0.5, 2.0))), 2)
    assert np.std(flank_deviation(made)) == pytest.approx(made.spread, rel=0.03)
    assert 0.006 < made.spread < 0.012


@pytest.mark.long
def test_texture_has_its_rms_and_is_rougher_at_short_lengths():
    texture = Texture((0.003,), (1.0,), 400)
    line = np.column_stack([np.linspace(0.0, 400.0, 80_000), np.zeros(80_000), np.zeros(80_000)])
    height = texture.at(line, 3)
    assert height.std() == pytest.approx(0.003, rel=0.1)
    apart = [np.std(height[n:] - height[:-n]) for n in (10, 40, 200)]  # 0.05, 0.2, 1 mm
    assert apart[0] < apart[1] < apart[2]
    assert (texture.at(line[:5], 3) == height[:5]).all()


def test_nothing_is_seen_at_a_grazing_angle_or_through_metal():
    rng = np.random.default_rng(4)
    points, views = sample(PART, 20_000, rng), Views()
    kept, view, cosine = seen(PART, points, views, rng)
    ways = views.directions()[view]
    assert (cosine >= views.grazing).all()
    assert (points.normal[kept] * ways).sum(axis=1) == pytest.approx(cosine)
    chosen = rng.permutation(len(kept))[:150]
    at = points.xyz[kept[chosen]] + 0.05 * points.normal[kept[chosen]]
    steps = np.arange(0.0, 30.0, 0.05)  # a ray walked in other steps, against the solid itself
    ray = at[:, None, :] + steps[None, :, None] * ways[chosen][:, None, :]
    hidden = PART.solid(ray.reshape(-1, 3)).reshape(len(chosen), -1).sum(axis=1) * 0.05
    assert (hidden < 0.4).mean() > 0.98  # what the coarse walk may miss: less than its step through metal


def test_a_root_is_not_seen_from_the_side():
    space = PART.gear.pitch_angle * 0.5
    bottom = (PART.section.root_radius[0] + 0.02) * np.array([[math.cos(space), math.sin(space), 0.0]]) + [[0.0, 0.0, 6.0]]
    out = np.array([[math.cos(space), math.sin(space), 0.0]])
    beside = np.array([[math.cos(space + 1.2), math.sin(space + 1.2), 0.0]])
    assert clear(PART, bottom, out).all()
    assert not clear(PART, bottom, beside).any()


@pytest.mark.parametrize("depth", [0.05, 0.4])
def test_a_hollow_does_not_hide_itself(depth):
    """The metal that is gone is in nobody's way: in a hollow as many points are seen as in its place without wear."""
    f = PART.frame
    rng = np.random.default_rng(6)
    tooth = np.full(4000, 2.0)
    roll, z = rng.uniform(f.reference, 0.8 * f.tip + 0.2 * f.reference, 4000), rng.uniform(4.0, 8.0, 4000)
    clearance = []
    for lost in (0.0, depth):
        xy, normal = flank_point(GEAR, tooth, np.ones(4000), roll, np.full(4000, -lost))
        way = np.column_stack([normal, np.full(4000, 0.3)])
        at = np.column_stack([xy + 0.004 * GEAR.module * normal, z])
        clearance.append(clear(PART, at, way / np.linalg.norm(way, axis=1)[:, None]).mean())
    assert clearance[0] > 0.9
    assert clearance[1] >= clearance[0]


def test_density_and_coverage():
    points = sample(PART, 60_000, np.random.default_rng(5))
    theta = np.arctan2(points.xyz[:, 1], points.xyz[:, 0])
    once = RoundGear(10.0, 0.3, True)(PART, points)
    assert set(np.round(once, 9)) == {1.0, 0.1}
    gradual = RoundGear(10.0, 0.3)(PART, points)
    assert gradual[np.argmin(np.abs(theta - 0.3))] == pytest.approx(1.0, abs=1e-3)
    assert gradual.min() == pytest.approx(0.1, rel=0.01)
    assert AlongAxis(30.0)(PART, points).min() == pytest.approx(1 / 30)
    flank = points.take(points.kind == FLANK)
    assert set(flank.tooth[Sector(16, 6)(PART, flank) > 0]) == {16, 17, 0, 1, 2, 3}
    assert set(flank.side[OneSide(-1)(PART, flank) > 0]) == {-1}
    assert set(flank.tooth[Unseen(7)(PART, flank) > 0]) == set(range(18)) - {7}


def test_smoothing_averages_noise():
    """A mean of 6 leaves 1/√6 of the noise, and moves a surface of radius L by (distance)²/4L of its neighbours besides."""
    noise, dense = 0.03, 60_000
    rough = scan(PART, replace(QUIET, noise=noise, points=dense), 6)
    smooth = scan(PART, replace(QUIET, noise=noise, points=dense, smoothing=6), 6)
    inner = [flank_deviation(one) for one in (rough, smooth)]
    spread = [np.median(np.abs(one - np.median(one))) for one in inner]
    assert spread[1] / spread[0] == pytest.approx(1.0 / math.sqrt(6.0), abs=0.08)


def test_thinning_leaves_as_many_points_as_told():
    for how in ("random", "voxel", "curvature"):
        left = np.round(back(scan(PART, replace(QUIET, pose="mild", thinning=how, left=8000), 7)), 4)
        assert len(left) == pytest.approx(8000, rel=0.01)
        assert len(left) == len(np.unique(left, axis=0))


def test_files_have_poses_of_their_own_and_share_the_part():
    made = scan(PART, replace(QUIET, files=4, points=30_000), 8)
    assert len(made.files) == 4
    assert sum(map(len, made.files)) == len(made.surface) == 30_000
    for i in range(4):
        z = back(made, i)[:, 2]
        assert z.min() > -1e-4
        assert z.max() < 12.0 + 1e-4
    assert np.abs(made.poses[0][0] - made.poses[1][0]).max() > 1e-3


def test_a_view_out_of_scale_moves_its_sector_only():
    views = Views()
    sector = views.sector(1, 4)
    assert sorted(v for i in range(4) for v in views.sector(i, 4)) == list(range(len(views.directions())))
    made = scan(PART, replace(QUIET, views=views, view_errors=(ViewError(sector, scale=1e-3),)), 9)
    xyz, plain = back(made), back(scan(PART, replace(QUIET, views=views), 9))
    moved = np.linalg.norm(xyz - plain, axis=1)
    expected = 1e-3 * np.linalg.norm(plain - [0.0, 0.0, 6.0], axis=1)
    share = (moved > 1e-3).mean()
    assert 0.1 < share < 0.45
    assert moved[moved > 1e-3] == pytest.approx(expected[moved > 1e-3], abs=3e-5)


def test_an_offset_of_a_view_lifts_its_sector_off_the_metal():
    views = Views()
    plain = back(scan(PART, replace(QUIET, views=views), 9))
    lifted = back(scan(PART, replace(QUIET, views=views, view_errors=(ViewError(views.sector(1, 4), offset=0.02),)), 9)) - plain
    size = np.linalg.norm(lifted, axis=1)
    here = size > 1e-3
    assert 0.1 < here.mean() < 0.45
    assert size[here] == pytest.approx(np.full(here.sum(), 0.02), abs=3e-5)
    end = here & (np.abs(plain[:, 2] - 12.0) < 1e-3) & (np.abs(lifted[:, 2]) > 0.019)
    assert end.sum() > 20 and (lifted[end, 2] > 0.0).all()  # outwards


def test_fringes_move_along_the_line_of_sight():
    views = Views()
    wrong = ViewError((), amplitude=0.005, wavelength=3.0)
    plain = back(scan(PART, replace(QUIET, views=views), 10))
    moved = back(scan(PART, replace(QUIET, views=views, view_errors=(wrong,)), 10)) - plain
    size = np.linalg.norm(moved, axis=1)
    assert size.max() == pytest.approx(0.005, rel=0.02)
    way = moved[size > 0.003] / size[size > 0.003, None]
    assert np.abs(way @ views.directions().T).max(axis=1) == pytest.approx(np.ones(len(way)), abs=1e-3)


def test_strays_are_as_many_as_told_and_off_the_part():
    made = scan(PART, replace(QUIET, strays=0.01), 11)
    assert (made.surface == -1).sum() == 200


def test_effects_of_the_instrument_move_points_as_the_contract_says():
    xyz = np.array([[30.0, 0.0, 4.0], [0.0, 20.0, 8.0]])
    normal = np.zeros((2, 3))
    assert Stretch(1e-3, 2e-3)(PART, xyz, normal) == pytest.approx(xyz * [1.001, 1.001, 1.002])
    turned = Turntable(2.0, 0.01, 0.0)(PART, xyz, normal)
    assert np.arctan2(turned[:, 1], turned[:, 0]) == pytest.approx([0.01, math.pi / 2 - 0.01])
    assert Frame.of(GEAR, PART.section.form_roll).base == pytest.approx(GEAR.base_radius)
