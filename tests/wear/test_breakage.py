"""Breakage: the volume of a known cut, and no breakage where there is none."""

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.surface import flank_points, locate
from gearwear.placing.cells import CellGrid
from gearwear.wear.breakage import broken_sentences, find_fractures, measure_broken, with_borders, without_broken
from gearwear.wear.inside_tooth import depth_inside
from tests.placing.placing import designed, true_pose
from tests.synthetic import Patch, Recipe, make_scan

GEAR: Gear = designed()
RANDOM = np.random.default_rng(1)


def cut(point: np.ndarray, normal: np.ndarray, points: int = 60_000) -> tuple[np.ndarray, np.ndarray]:
    """A scan of which tooth 0 lost what lies beyond a plane, with the fracture's points; and places in that tooth that are gone, for the volume."""
    scan = make_scan(Recipe(jitter=1.0, pose="none", noise_um=5.0).of_size(points), 2)
    at = true_pose(scan).apply(scan.points)
    index, _, _ = depth_inside(at, GEAR)
    radius = np.hypot(at[:, 0], at[:, 1])
    at = at[~((index == 0) & (radius > GEAR.root_radius + 1e-3) & ((at - point) @ normal > 0.0))]
    across = np.linalg.svd(normal[None, :])[2][1:]
    plane = point + RANDOM.uniform(-20.0, 20.0, (40_000, 2)) @ across
    tooth, depth, _ = depth_inside(plane, GEAR)
    fracture = plane[(tooth == 0) & (depth > 0.0)]
    return np.vstack([at, fracture + 0.005 * RANDOM.normal(size=fracture.shape)]), fracture


def true_volume(point: np.ndarray, normal: np.ndarray) -> float:
    """Of the nominal tooth beyond the plane, by the angles of its section: a fine sum over r, θ, z."""
    r = np.linspace(GEAR.root_radius, GEAR.tip_radius, 401)
    r = 0.5 * (r[1:] + r[:-1])
    half = GEAR.half_angle(np.clip(r, GEAR.root_radius, GEAR.flank_end_radius))
    u, z = (np.arange(200) + 0.5) / 200, (np.arange(200) + 0.5) / 200 * GEAR.face_width
    total = 0.0
    for radius, width in zip(r, half, strict=True):
        angle = (2.0 * u - 1.0) * width
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        beyond = ((x - point[0]) * normal[0] + (y - point[1]) * normal[1])[:, None] + (z - point[2]) * normal[2] > 0.0
        total += beyond.mean() * 2.0 * width * radius
    return total * (GEAR.tip_radius - GEAR.root_radius) / 400 * GEAR.face_width


MIDDLE = np.array([GEAR.root_radius + 4.0, 0.0, 7.5])
CORNER = np.array([GEAR.tip_radius - 6.0, 0.0, 0.0])
CUTS = {
    "missing tooth": (MIDDLE, np.array([1.0, 0.1, 0.03])),
    "broken corner": (CORNER, np.array([1.0 / 6.0, 0.01, -1.0 / 7.0])),
}


@pytest.mark.parametrize("kind", CUTS)
def test_a_cut_is_named_with_its_volume(kind):
    point, normal = CUTS[kind]
    normal = normal / np.linalg.norm(normal)
    points, fracture = cut(point, normal)
    grid = CellGrid.for_scan(GEAR, len(points))
    fractures = find_fractures(points, GEAR)
    border = with_borders(points, fractures, GEAR, 0.005)
    (broken,) = measure_broken(points, grid.index(locate(points, GEAR)), fractures, border, grid, 0.005)
    assert (broken.tooth, broken.kind) == (0, kind)
    assert abs(broken.volume - true_volume(point, normal)) < 3.0 * broken.std
    assert broken.std < 0.05 * broken.volume
    # The points of the fracture are taken out, all but those at its border.
    assert border[-len(fracture) :].mean() > 0.95
    depth = without_broken(np.zeros((12, 2, grid.rows, grid.fillet + grid.flank)), (broken,), grid)
    assert not depth[1:].any()
    assert depth[0, :, :, -1].any()


def test_deep_wear_is_no_breakage():
    """1.5 mm on a module of 6.35, and 400 µm over an edge of 0.4 mm."""
    wear = (Patch(4, 1, 1500.0, (37.0, 43.0), (2.0, 11.0)), Patch(8, -1, 400.0, (40.0, 48.0), (3.0, 12.0), 0.4))
    scan = make_scan(Recipe(jitter=1.0, pose="none", outliers=0.002, wear=wear).of_size(60_000), 3)
    assert find_fractures(true_pose(scan).apply(scan.points), GEAR) == []


@pytest.mark.parametrize("unseen", [(4,), (1, 2, 3, 4, 5, 6, 7, 9)])
def test_teeth_that_were_not_seen_are_not_called_missing(unseen):
    """One of twelve, and eight of them: a scan of a third of the gear."""
    scan = make_scan(Recipe(jitter=1.0, pose="none").of_size(30_000), 4)
    points = true_pose(scan).apply(scan.points)
    tooth = np.round(np.arctan2(points[:, 1], points[:, 0]) / GEAR.pitch_angle).astype(int) % GEAR.spec.teeth
    points = points[~(np.isin(tooth, unseen) & (np.hypot(*points[:, :2].T) > GEAR.root_radius))]
    grid = CellGrid.for_scan(GEAR, len(points))
    fractures = find_fractures(points, GEAR)
    broken = measure_broken(points, grid.index(locate(points, GEAR)), fractures, np.zeros(len(points), dtype=bool), grid, 0.01)
    assert tuple(piece.tooth for piece in broken) == unseen
    for piece in broken:
        assert (piece.kind, piece.flank) == ("not seen", "tooth")
        assert math.isnan(piece.volume) and not piece.flank_gone.any()
    (said,) = broken_sentences(broken)
    assert said.startswith("tooth 5 was not seen" if len(unseen) == 1 else "teeth 2 to 8 and 10 were not seen")


def test_an_end_chamfer_that_is_not_drawn_is_no_fracture_where_few_points_of_each_tooth_show_it():
    """0.8 mm at 45 degrees all round: of eleven teeth six points lie there, of the other eight, each to 0.4 mm inside the drawn tooth."""
    scan = make_scan(Recipe(jitter=1.0, pose="none").of_size(20_000), 5)
    points = true_pose(scan).apply(scan.points)
    points = points[points[:, 2] > 0.8]

    def chamfer(tooth, number):
        height = np.linspace(0.36, 0.44, number)
        roll = np.linspace(12.0, 12.3, number)
        flank = flank_points(GEAR, np.full(number, tooth), np.ones(number, dtype=int), roll, np.full(number, 5.0))
        at = flank.position - (0.8 - height)[:, None] * flank.normal
        at[:, 2] = height
        return at

    eight, six = chamfer(0, 8), [chamfer(tooth, 6) for tooth in range(1, 12)]
    alone = find_fractures(np.vstack([points, eight]), GEAR)
    assert [(tooth, len(index)) for tooth, index in alone] == [(0, 8)]
    assert find_fractures(np.vstack([points, eight, *six]), GEAR) == []


def test_a_root_land_that_lies_high_is_no_fracture():
    """40 µm above the drawn one, near an end and near a fillet, it is 0.1 mm and more below the fillet that runs out into it."""
    scan = make_scan(Recipe(jitter=1.0, pose="none", noise_um=5.0).of_size(60_000), 2)
    points = true_pose(scan).apply(scan.points)
    radius = GEAR.root_radius + 0.06
    half = float(GEAR.half_angle(np.array([radius]))[0])
    high = np.array(
        [
            [radius * math.cos(share * half), radius * math.sin(share * half), z]
            for share in np.linspace(0.93, 0.965, 4)
            for z in np.linspace(0.4, 1.3, 10)
        ]
    )
    _, depth, _ = depth_inside(high, GEAR)
    assert (depth > 0.03 * GEAR.transverse_module).all() and depth.max() > 0.05 * GEAR.transverse_module
    assert find_fractures(np.vstack([points, high]), GEAR) == []
