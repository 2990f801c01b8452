"""What a scan is made of: noise, texture, holes, views, poses; and the practice scans of another generator."""

import dataclasses
import json
import math

import numpy as np
import pytest

from tests.synthetic import (
    PINION,
    WHEEL,
    AbrasiveWear,
    Effect,
    Hole,
    Outline,
    Patch,
    Recipe,
    Rigid,
    Surface,
    Texture,
    Views,
    make_scan,
    pose_error,
    rotation_about,
)
from tests.synthetic.test_outline import shoelace

SMALL = Recipe(slices=12, points_per_tooth=131, end_points=3000)


def deviation_of_ends(scan):
    """Height of the end faces' points over their planes, in the design frame."""
    design = scan.truth.pose.inverse().apply(scan.points)
    surface = scan.truth.labels.surface
    up = design[:, 2] - np.where(surface == Surface.END_HIGH, scan.truth.outline.face_width, 0.0)
    return up[(surface == Surface.END_HIGH) | (surface == Surface.END_LOW)]


def test_same_seed_same_scan_other_seed_other_scan():
    recipe = dataclasses.replace(SMALL, texture=Texture(2.0), outliers=1e-3, lost=0.01)
    assert np.array_equal(make_scan(recipe, 7).points, make_scan(recipe, 7).points)
    assert make_scan(recipe, 7).points[0, 0] != make_scan(recipe, 8).points[0, 0]


@pytest.mark.parametrize("pose", ["none", "mild", "any"])
@pytest.mark.parametrize("gear", [PINION, WHEEL])
def test_the_pose_takes_the_scan_back_to_the_design(gear, pose):
    scan = make_scan(dataclasses.replace(SMALL, gear=gear, pose=pose, noise_um=0.0), 3)
    design = scan.truth.pose.inverse().apply(scan.points)
    tip = scan.truth.labels.surface == Surface.TIP
    root = scan.truth.labels.surface == Surface.ROOT
    outline = scan.truth.outline
    assert np.hypot(*design[tip, :2].T) == pytest.approx(outline.tip_radius, abs=1e-11)
    assert np.hypot(*design[root, :2].T) == pytest.approx(outline.root_radius, abs=1e-11)
    assert np.abs(deviation_of_ends(scan)).max() < 1e-11
    theta = np.arctan2(design[tip, 1], design[tip, 0])
    assert np.array_equal(np.mod(np.rint(theta / outline.pitch_angle), gear.teeth), scan.truth.labels.tooth[tip])
    assert np.linalg.det(scan.truth.pose.rotation) == pytest.approx(1.0)


def test_a_mild_pose_leaves_tooth_one_nearest_the_scans_own_x():
    for seed in range(20):
        pose = make_scan(dataclasses.replace(SMALL, gear=WHEEL, slices=5, points_per_tooth=20), seed).truth.pose
        assert abs(math.atan2(pose.rotation[1, 0], pose.rotation[0, 0])) < 0.5 * math.pi / 12


def test_pose_error_takes_out_the_gears_symmetry_and_keeps_the_rest():
    outline = Outline.of(PINION)
    true = Rigid(rotation_about(np.array([0.3, -1.2, 2.0])), np.array([4.0, -7.0, 11.0]))
    wrong = Rigid(rotation_about(np.array([1e-4, 0.0, -2e-4])), np.array([0.01, 0.0, 0.02]))
    for flipped in (False, True):
        for teeth in (0, 5, 11):
            flip = Rigid(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 15.0])) if flipped else Rigid(np.eye(3), np.zeros(3))
            turn = Rigid(rotation_about(np.array([0.0, 0.0, teeth * outline.pitch_angle])), np.zeros(3))
            found = turn.after(flip).after(wrong).after(true.inverse())
            error = pose_error(found.rotation, found.translation, true, outline)
            assert (error.teeth, error.flipped) == (teeth, flipped)
            assert error.angle == pytest.approx(math.hypot(1e-4, 2e-4), rel=1e-6)
            assert abs(error.turn) == pytest.approx(2e-4, rel=1e-3)
            assert error.tilt == pytest.approx(1e-4, rel=1e-3)
            middle = wrong.apply(np.array([[0.0, 0.0, 7.5]]))[0] - [0.0, 0.0, 7.5]
            assert np.linalg.norm(error.shift) == pytest.approx(np.linalg.norm(middle), rel=1e-6)


def test_noise_has_its_standard_deviation_on_every_axis():
    scan = make_scan(dataclasses.replace(SMALL, noise_um=12.0, end_points=40_000), 5)
    n = 40_000
    assert np.std(deviation_of_ends(scan)) == pytest.approx(0.012, rel=4.0 / math.sqrt(2 * n))
    still = make_scan(dataclasses.replace(SMALL, noise_um=0.0, end_points=40_000), 5)
    noise = scan.points - still.points
    assert noise.std(axis=0) == pytest.approx(0.012, rel=4.0 / math.sqrt(2 * len(noise)))
    assert np.abs(np.corrcoef(noise.T) - np.eye(3)).max() < 4.0 / math.sqrt(len(noise))


@pytest.mark.parametrize("kind", ["gauss", pytest.param("exponential", marks=pytest.mark.long)])
def test_texture_has_its_deviation_and_correlation_length(kind):
    length, spacing = 0.8, 0.2
    recipe = Recipe(
        WHEEL, slices=75, points_per_tooth=85, ends="none", noise_um=0.0, pose="none", texture=Texture(5.0, length, kind)
    )
    products, variances = [], []
    for seed in range(4):
        scan, still = make_scan(recipe, seed), make_scan(dataclasses.replace(recipe, texture=None), seed)
        on = scan.truth.labels.surface == Surface.TIP
        rise = np.hypot(*scan.points[on, :2].T) - np.hypot(*still.points[on, :2].T)
        grid = rise.reshape(75, -1)  # slice by slice
        variances.append(np.mean(grid**2))
        products.append(np.mean(grid[:-4] * grid[4:]))
    # tips are 24 × 4.5 mm by 15 mm, four scans: about 24 · 4.5 · 15 · 4 / (π l²) independent patches
    share = 1.0 / math.sqrt(24 * 4.5 * 15 * 4 / (2.0 * math.pi * length**2))
    assert np.mean(variances) == pytest.approx(25e-6, rel=4.0 * share * math.sqrt(2.0))
    assert 4 * spacing == pytest.approx(length)
    assert np.mean(products) / np.mean(variances) == pytest.approx(math.exp(-1.0), abs=4.0 * share)


def test_texture_stays_with_the_part_from_scan_to_scan_when_asked():
    recipe = dataclasses.replace(SMALL, texture=Texture(5.0), texture_seed=9, noise_um=0.0, pose="none", ends="none")
    assert np.array_equal(make_scan(recipe, 1).points, make_scan(recipe, 2).points)


def test_texture_runs_on_without_a_step_round_the_gear():
    """Neighbouring points differ by what the correlation says, from tooth to tooth too."""
    recipe = Recipe(slices=30, points_per_tooth=505, ends="none", noise_um=0.0, pose="none", texture=Texture(5.0, 2.0))
    scan, still = make_scan(recipe, 2), make_scan(dataclasses.replace(recipe, texture=None), 2)
    root = still.truth.labels.surface == Surface.ROOT
    grid = np.where(root, np.hypot(*scan.points[:, :2].T) - np.hypot(*still.points[:, :2].T), 0.0).reshape(30, 12, 505)
    step = grid[:, :, 0] - np.roll(grid[:, :, -1], 1, axis=1)  # first of a tooth against the last of the one before
    spacing = still.truth.outline.length / 505
    expected = 0.005 * math.sqrt(2.0 * (1.0 - math.exp(-((spacing / 2.0) ** 2))))
    assert np.sqrt(np.mean(step**2)) < 1.5 * expected


def test_outliers_and_lost_points_come_in_their_shares():
    recipe = Recipe(slices=40, points_per_tooth=200, end_points=4000, outliers=0.002, lost=0.05)
    scan = make_scan(recipe, 11)
    whole = 40 * 200 * 12 + 4000
    assert len(scan.points) == pytest.approx(0.95 * whole, abs=4 * math.sqrt(whole * 0.05 * 0.95))
    assert scan.truth.labels.outlier.sum() == pytest.approx(0.002 * len(scan.points), abs=4 * math.sqrt(0.002 * whole))
    off = np.linalg.norm(scan.truth.pose.inverse().apply(scan.points)[scan.truth.labels.outlier], axis=1)
    assert len(off) > 0


def test_a_hole_is_empty_and_only_it():
    hole = Hole(4, -1, 40.0, 6.0, 2.0)
    recipe = dataclasses.replace(SMALL, slices=40, noise_um=0.0, pose="none")
    whole, scan = make_scan(recipe, 1), make_scan(dataclasses.replace(recipe, holes=(hole,)), 1)
    missing = len(whole.points) - len(scan.points)
    spacing = whole.truth.outline.length / 131 * 15.0 / 40
    assert missing == pytest.approx(math.pi * 4.0 / spacing, rel=0.1)
    labels = whole.truth.labels
    flank = (labels.surface == Surface.FLANK) & (labels.tooth == 4) & (labels.side == -1)
    left = scan.truth.labels
    assert flank.sum() - ((left.surface == Surface.FLANK) & (left.tooth == 4) & (left.side == -1)).sum() == missing


def test_views_see_their_sectors_in_frames_of_their_own_and_cover_the_gear():
    recipe = dataclasses.replace(SMALL, noise_um=0.0, views=Views(4, overlap=0.7))
    scan = make_scan(recipe, 2)
    assert len(scan.views) == len(scan.truth.poses) == 4
    assert np.array_equal(np.concatenate(scan.views), scan.points)
    start, covered = 0, np.zeros(360, bool)
    for view, pose in zip(scan.views, scan.truth.poses, strict=True):
        design = pose.inverse().apply(view)
        labels = scan.truth.labels.take(np.arange(start, start + len(view)))
        start += len(view)
        tip = labels.surface == Surface.TIP
        assert np.hypot(*design[tip, :2].T) == pytest.approx(44.45, abs=1e-11)
        assert not (labels.surface == Surface.END_LOW).any()
        degrees = np.unique(np.floor(np.degrees(np.arctan2(design[:, 1], design[:, 0]))).astype(int) % 360)
        assert len(degrees) == pytest.approx(90 * 1.7, abs=3)
        covered[degrees] = True
    assert covered.all()


def test_jitter_moves_points_within_the_surface():
    scan = make_scan(dataclasses.replace(SMALL, jitter=1.0, noise_um=0.0, pose="none"), 2)
    labels = scan.truth.labels
    tip = labels.surface == Surface.TIP
    assert np.hypot(*scan.points[tip, :2].T) == pytest.approx(44.45, abs=1e-11)
    sides = labels.surface <= Surface.TIP
    assert len(np.unique(np.round(scan.points[sides, 2], 9))) > 0.99 * sides.sum()
    assert scan.points[sides, 2].min() > 0.0
    assert scan.points[sides, 2].max() < 15.0


@pytest.mark.parametrize("size", [20_000, 60_000, 250_000])
def test_of_size_gives_about_that_many_points(size):
    recipe = Recipe(noise_um=0.0).of_size(size)
    assert len(make_scan(recipe, 1).points) == pytest.approx(size, rel=0.03)


def test_coating_lies_on_the_worn_surface_along_its_own_normal():
    """On a steep wall a coat along the design's normal would be thinner by the cosine of the slope."""
    wear = (Patch(1, 1, 1500.0, (37.0, 43.0), (2.0, 13.0)),)
    recipe = Recipe(slices=61, points_per_tooth=301, ends="none", noise_um=0.0, pose="none", wear=wear)
    bare = make_scan(recipe, 1)
    coated = make_scan(dataclasses.replace(recipe, effects=(Effect("coating", {"thickness_um": 50.0}),)), 1)
    labels = bare.truth.labels
    on = (labels.tooth == 1) & (labels.side == 1) & (labels.depth > 0.0)
    order = np.lexsort((labels.roll[on], labels.z[on]))
    slices = len(np.unique(labels.z[on]))
    worn, shift = (a[on][order].reshape(slices, -1, 3) for a in (bare.points, coated.points - bare.points))
    assert np.linalg.norm(shift, axis=2) == pytest.approx(np.full(shift.shape[:2], 0.05), abs=1e-12)
    # across the chords between neighbours, along the profile and along the face: tangents to h² / 6 of the third derivative
    for chord, move in ((worn[:, 2:] - worn[:, :-2], shift[:, 1:-1]), (worn[2:] - worn[:-2], shift[1:-1])):
        along = chord / np.linalg.norm(chord, axis=2, keepdims=True)
        assert np.abs((along * move).sum(axis=2)).max() < 0.05 * 0.01
    plain = bare.truth.outline.flank(labels.roll[on][order])[1]  # normals of the unworn flank of tooth 0
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    cosine = (shift.reshape(-1, 3)[:, :2] * (plain @ np.array([[c, s], [-s, c]]))).sum(axis=1) / 0.05
    assert cosine.min() < 0.9  # the walls are steep enough for the difference to show


def test_truth_as_dict_is_plain_json():
    recipe = dataclasses.replace(
        SMALL,
        texture=Texture(2.0),
        holes=(Hole(1, 1, 40.0, 5.0, 1.0),),
        wear=(AbrasiveWear(20.0, 1), Patch(3, 1, 300.0, (37.0, 44.0), (2.0, 9.0))),
        effects=(Effect("coating", {"thickness_um": 18.0}),),
    )
    truth = json.loads(json.dumps(make_scan(recipe, 1).truth.as_dict()))
    assert truth["effects"] == [{"name": "coating", "parameters": {"thickness_um": 18.0}}]
    assert truth["volume_mm3"] == pytest.approx(sum(f["volume_mm3"] for f in truth["flanks"]))
    assert len(truth["flanks"]) == 12
    assert len(truth["wear"]) == 2


# --- against the practice scans, made by other code -------------------------------------------------------------------


def read_practice(path):
    data = path.read_bytes()
    start = data.index(b"end_header\n") + 11
    return np.frombuffer(data[start:], "<f4").reshape(-1, 3).astype(np.float64)


@pytest.mark.shared
def test_practice_scan_lies_on_our_outline_and_has_our_counts(shared):
    truth = json.loads((shared / "scans" / "open_unworn.truth.json").read_text())
    pose = Rigid(np.array(truth["pose"]["R"]), np.array(truth["pose"]["t"]))
    coat, noise = truth["effects"][0]["thickness_mm"], truth["noise_mm"]
    practice = pose.inverse().apply(read_practice(shared / "scans" / "open_unworn.ply"))
    recipe = Recipe(noise_um=1e3 * noise, outliers=truth["outliers"], effects=(Effect("coating", {"thickness_um": 1e3 * coat}),))
    ours = make_scan(recipe, 1)
    ours_design = ours.truth.pose.inverse().apply(ours.points)
    outline = ours.truth.outline
    kept = len(practice) / len(ours_design)
    assert 0.95 < kept <= 1.0

    def shares(points):
        """Counts by place alone: ends, tip band, rings of radius."""
        radius = np.hypot(points[:, 0], points[:, 1])
        end = (np.abs(points[:, 2] - 15.0 - coat) < 0.05) | (np.abs(points[:, 2] + coat) < 0.05)
        edges = [30.0, 30.3, 32.0, 34.0, 36.0, 38.0, 40.0, 42.0, 44.2, 44.7]
        return np.array([end.sum(), *np.histogram(radius[~end], edges)[0]])

    found, made = shares(practice), kept * shares(ours_design)
    # the practice scan has lost points in holes too: each ring agrees to 2 % and 4 standard deviations of counting
    assert (np.abs(found - made) < 0.02 * made + 4.0 * np.sqrt(made)).all(), (found, made)

    # a middle slice: points in the file's order, the coat a band of its width round the section
    radius = np.hypot(practice[:, 0], practice[:, 1])
    middle = np.flatnonzero((np.abs(practice[:, 2] - 7.5) < 0.1) & (radius > 30.0) & (radius < 44.6))
    middle = middle[np.abs(middle - np.median(middle)) < 6060]  # strays of other slices are elsewhere in the file
    slice_points = practice[middle, :2]
    assert 5700 < len(slice_points) <= 6060
    # the teeth follow each other counter-clockwise, the points of a tooth clockwise
    step = np.angle(np.exp(1j * np.diff(np.arctan2(slice_points[:, 1], slice_points[:, 0]))))
    teeth = np.split(slice_points, np.flatnonzero(step > 0.35) + 1)
    assert len(teeth) == 12
    slice_points = np.concatenate([tooth[::-1] for tooth in teeth])
    perimeter = 12 * outline.length
    expected = 4408.899 + coat * perimeter
    scatter = noise * perimeter / math.sqrt(len(slice_points))
    assert shoelace(slice_points) == pytest.approx(expected, abs=5.0 * scatter)
