"""Removed volume: published patches, closed forms, and the difference of polygons of the scan's own points."""

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
    GearNumbers,
    Outline,
    Patch,
    Recipe,
    SlidingWear,
    Surface,
    make_scan,
    removed_volume,
)
from tests.synthetic.removal import depth_below
from tests.synthetic.test_outline import shoelace


@pytest.mark.shared
@pytest.mark.parametrize("scan", ["open_tooth_b", "open_turntable", "open_triangles", "open_views"])
def test_raised_cosine_patches_of_the_practice_scans(shared, scan):
    """Their generator is not ours; its volumes agree to all printed digits but the quadrature's last."""
    truth = json.loads((shared / "scans" / f"{scan}.truth.json").read_text())
    names = {"teeth", "module", "pressure_angle", "face_width", "rack_tip_radius"}
    gear = {k: v for k, v in truth["gear"].items() if k in names}
    gear["pressure_angle_deg"] = gear.pop("pressure_angle")
    outline = Outline.of(GearNumbers(**gear))
    assert truth["wear"]
    for one in truth["wear"]:
        patch = Patch(one["tooth"], one["side"], 1e3 * one["depth_mm"], tuple(one["r"]), tuple(one["z"]))
        assert removed_volume((patch,), outline, one["tooth"], one["side"]) == pytest.approx(one["volume_mm3"], rel=2e-4)


def test_uniform_loss_of_a_flank_with_a_tangent_root_in_closed_form():
    """Own roll l from L_form − h to L_tip at each depth h: ∫ (L_tip² − (L_form − h)²) / 2 dh / r_b."""
    outline = Outline.of(WHEEL)
    d, tip, form = 0.3, outline.tip_roll, outline.form_roll
    area = (tip**2 * d - (form**3 - (form - d) ** 3) / 3.0) / (2.0 * outline.base_radius)
    volume = removed_volume((AbrasiveWear(1e3 * d),), outline, 5, -1)
    assert volume == pytest.approx(area * 15.0, rel=1e-6)


def test_flat_patch_inside_the_flank_in_closed_form():
    outline = Outline.of(PINION)
    patch = Patch(0, 1, 1550.0, (38.0, 42.0), (2.0, 7.0), edge_mm=0.0)
    low, high = (math.sqrt(r * r - outline.base_radius**2) for r in (38.0, 42.0))
    area = (1.55 * 0.5 * (high**2 - low**2) - 0.5 * 1.55**2 * (high - low)) / outline.base_radius
    assert removed_volume((patch,), outline, 0, 1) == pytest.approx(5.0 * area, rel=1e-12)


def test_wears_on_one_flank_add_in_depth_not_in_volume():
    outline = Outline.of(PINION)
    two = (AbrasiveWear(100.0, teeth=(2,)), AbrasiveWear(200.0, teeth=(2,)))
    assert removed_volume(two, outline, 2, 1) == pytest.approx(removed_volume((AbrasiveWear(300.0),), outline, 2, 1))


FULL = (-20.0, 35.0)
SECTIONS = {
    "sliding, undercut root": (PINION, (SlidingWear(90.0),), ()),
    "sliding by Archard": (PINION, (SlidingWear(90.0, law="archard"),), ()),
    "sliding, tangent root": (WHEEL, (SlidingWear(90.0, side=-1),), ()),
    "uniform, thin": (PINION, (AbrasiveWear(15.0),), ()),
    "uniform, deep": (PINION, (AbrasiveWear(400.0, side=1),), ()),
    "deep on sliding": (PINION, (SlidingWear(60.0), Patch(2, 1, 1200.0, (36.2, 46.0), FULL, edge_mm=1.5)), ()),
    "as-made profile": (
        PINION,
        (Patch(2, 1, 500.0, (36.5, 44.0), FULL, edge_mm=1.0),),
        (
            Effect("profile_slope", {"left_um": 150.0, "right_um": 0.0}),
            Effect("tooth_thickness", {"thickness_um": -80.0}),
        ),
    ),
}


def bare(numbers, wear, effects=(), slices=1, points_per_tooth=8001):
    """A scan without noise or pose."""
    recipe = Recipe(
        numbers, slices=slices, points_per_tooth=points_per_tooth, ends="none", noise_um=0.0, pose="none", effects=effects
    )
    return make_scan(dataclasses.replace(recipe, wear=wear), 1)


def section_areas(scan):
    """Area of each slice, its points put in order round the gear: up a right side, over the tip, down the left."""
    labels, outline = scan.truth.labels, scan.truth.outline
    rank = np.array([1, 2, 3, 0])[labels.surface]  # flank, fillet, root, tip in the order of `Surface`
    x, y, z = scan.points.T
    across = np.angle(np.exp(1j * (np.arctan2(y, x) - labels.tooth * outline.pitch_angle)))
    land = (rank == 0) | (rank == 3)
    side = np.where(land, np.sign(across), labels.side)
    down = np.where(land, np.abs(across), 1.0 - np.hypot(x, y) / 100.0)
    order = np.lexsort((side * (1.0 + rank + 0.5 * down), labels.tooth, z))
    return np.array([shoelace(part) for part in np.split(scan.points[order, :2], np.flatnonzero(np.diff(z[order])) + 1)])


@pytest.mark.parametrize("name", SECTIONS)
def test_volume_is_the_difference_of_two_sections(name):
    numbers, wear, effects = SECTIONS[name]
    worn = bare(numbers, wear, effects)
    removed = section_areas(bare(numbers, (), effects))[0] - section_areas(worn)[0]
    # a polygon cuts each of a side's three new corners by a triangle of the wear's depth and half a spacing (2.5 µm)
    slack = sum(3.0 * 0.5 * 0.0025 * 1e-3 * flank.max_depth_um for flank in worn.truth.flanks) + 1e-5
    assert removed == pytest.approx(worn.truth.volume_mm3 / 15.0, abs=slack)


def test_volume_of_a_patch_that_varies_along_the_face():
    wear = (Patch(3, -1, 1500.0, (36.3, 44.3), (2.0, 13.0)),)
    worn = bare(PINION, wear, slices=45, points_per_tooth=1501)
    removed = (section_areas(bare(PINION, (), points_per_tooth=1501))[0] - section_areas(worn)).sum() * 15.0 / 45
    # chords of a concave bottom: spacing² / 12 of curvature, far below 1e-4; mid-points in z are exact for a cosine
    assert removed == pytest.approx(worn.truth.volume_mm3, rel=1e-4)


def test_nothing_of_the_scan_is_left_in_removed_metal():
    wear = (SlidingWear(80.0), Patch(2, 1, 1200.0, (36.2, 46.0), (-5.0, 9.0), edge_mm=1.5))
    recipe = Recipe(noise_um=0.0, pose="none", wear=wear).of_size(100_000)
    scan = make_scan(recipe, 4)
    labels, outline = scan.truth.labels, scan.truth.outline
    radius = np.hypot(*scan.points[:, :2].T)
    near = (radius > outline.base_radius) & (labels.surface != Surface.FLANK)
    x, y, z = scan.points[near].T
    across = np.angle(np.exp(1j * (np.arctan2(y, x) - labels.tooth[near] * outline.pitch_angle)))
    own = np.sqrt(radius[near] ** 2 - outline.base_radius**2)
    tangent = own / outline.base_radius
    under = outline.base_radius * (outline.base_half_angle - tangent + np.arctan(tangent) - across)  # left flanks
    depth = np.zeros(len(z))
    for tooth in range(12):
        here = labels.tooth[near] == tooth
        depth[here] = depth_below(wear, outline, tooth, 1, own[here], z[here])
    assert (under > depth - 1e-6).all()
    assert ((labels.surface == Surface.TIP) & (labels.tooth == 2)).sum() < (
        (labels.surface == Surface.TIP) & (labels.tooth == 3)
    ).sum()


def test_a_flank_worn_to_the_tip_reaches_the_tip_circle():
    """No gap under the tip land: the worn flank goes up to the tip circle within a spacing and a half."""
    scan = bare(PINION, (AbrasiveWear(600.0, side=1),), points_per_tooth=505)
    labels = scan.truth.labels
    left = (labels.surface == Surface.FLANK) & (labels.side > 0)
    spacing = scan.truth.outline.length / 505
    for tooth in range(12):
        highest = np.hypot(*scan.points[left & (labels.tooth == tooth), :2].T).max()
        assert 44.45 - 1.5 * spacing < highest <= 44.45 + 1e-9


def test_thickness_loss_is_the_arc_between_the_flanks_at_the_reference_circle():
    scan = bare(PINION, (Patch(1, 1, 1550.0, (36.2, 44.45), (-6.0, 21.0)),), slices=3)
    labels, points = scan.truth.labels, scan.points
    radius, theta = np.hypot(*points[:, :2].T), np.arctan2(points[:, 1], points[:, 0])
    worn = (labels.surface == Surface.FLANK) & (labels.side > 0) & (labels.tooth == 1) & (points[:, 2] == 7.5)
    order = np.argsort(radius[worn])
    at = np.interp(38.1, radius[worn][order], theta[worn][order])
    loss = (scan.truth.outline.pitch_angle + math.pi / 24.0 - at) * 38.1  # half a tooth is π / (2 z)
    assert scan.truth.flanks[0].thickness_loss_mm == pytest.approx(loss, abs=1e-6)


def test_wear_through_the_tooth_is_refused():
    with pytest.raises(ValueError, match="through the tooth"):
        bare(PINION, (Patch(1, 1, 12_000.0, (36.2, 44.45), (-6.0, 21.0)),), points_per_tooth=505)
