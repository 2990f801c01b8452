"""`locate` undoes a known displacement along a known normal, on every surface."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import KDTree

from gearwear.design import Gear, GearSpec, surface
from gearwear.design.surface import (
    BORE,
    CHUNK,
    END_HIGH,
    END_LOW,
    FILLET,
    FLANK,
    OTHER,
    ROOT,
    SURFACE_NAMES,
    TIP,
    Bands,
    SurfacePoints,
    flank_points,
    locate,
)
from tests.design.gears import SPREAD

N = 2000
EACH = pytest.mark.parametrize("gear", SPREAD.values(), ids=SPREAD.keys())
EPS = np.finfo(float).eps


def random_flank(gear: Gear, rng: np.random.Generator) -> SurfacePoints:
    return flank_points(
        gear,
        rng.integers(0, gear.teeth, N),
        rng.choice([-1, 1], N),
        rng.uniform(gear.form_roll, gear.tip_roll, N),
        rng.uniform(0.2, 0.8, N) * gear.face_width,
    )


def rounding(gear: Gear, roll: np.ndarray | float = math.inf) -> np.ndarray | float:
    """What double precision leaves of a length on this gear, mm; near the base circle L = √(r² − r_b²) magnifies it by r / L."""
    return 32 * EPS * gear.tip_radius * (1.0 + gear.tip_radius / np.maximum(roll, 1e-300))


@EACH
def test_flank_points_hang_on_their_string(gear):
    """P · n = L, |P|² = r_b² + L², (r × n)_z = s r_b, and the polar angle is that of the half angle."""
    p = random_flank(gear, np.random.default_rng(1))
    x, y = p.position[:, 0], p.position[:, 1]
    nx, ny = p.normal[:, 0], p.normal[:, 1]
    length = rounding(gear)
    np.testing.assert_allclose(x * nx + y * ny, p.roll, rtol=0, atol=length)
    np.testing.assert_allclose(x * ny - y * nx, p.side * gear.base_radius, rtol=0, atol=length)
    np.testing.assert_allclose(np.hypot(x, y), np.hypot(gear.base_radius, p.roll), rtol=0, atol=length)
    # a radius a hair inside the form circle would be the trochoid's
    radius = np.maximum(np.hypot(x, y), gear.form_radius)
    expected = p.tooth * gear.pitch_angle + p.side * gear.half_angle(radius)
    off = np.angle(np.exp(1j * (np.arctan2(y, x) - expected)))
    np.testing.assert_allclose(gear.base_radius * off, 0.0, rtol=0, atol=length)


@EACH
def test_flank_normals_are_perpendicular_to_tangents(gear):
    """Tangents by central difference in L and in z; the difference is exact to h² (third derivative 1 / r_b²)."""
    rng = np.random.default_rng(2)
    p = random_flank(gear, rng)
    h = 1e-3 * gear.transverse_module
    ahead, behind = (flank_points(gear, p.tooth, p.side, p.roll + step, p.position[:, 2]) for step in (h, -h))
    tangent = (ahead.position - behind.position) / (2 * h)
    np.testing.assert_allclose(np.sum(tangent * p.normal, axis=1), 0.0, rtol=0, atol=(h / gear.base_radius) ** 2 + 1e-11)
    assert (p.normal[:, 2] == 0.0).all()
    # |dP/dL| = L / r_b, and metal lies behind the normal: going along it leads away from the tooth's centre line
    speed = np.linalg.norm(tangent, axis=1)
    np.testing.assert_allclose(speed, p.roll / gear.base_radius, rtol=0, atol=(h / gear.base_radius) ** 2 + 1e-11)
    centre = p.tooth * gear.pitch_angle
    across = p.side * (-np.sin(centre) * p.normal[:, 0] + np.cos(centre) * p.normal[:, 1])
    assert (across > 0.0).all()


@EACH
def test_flank_displacement_comes_back_exactly(gear):
    """From 1.5 mm of wear on a module of 6.35 to 0.05 mm too much: foot, roll length, normal and deviation."""
    rng = np.random.default_rng(3)
    m = gear.transverse_module / 6.35
    p = random_flank(gear, rng)
    deviation = rng.uniform(-1.5 * m, 0.05 * m, N)
    moved = p.position + deviation[:, None] * p.normal
    found = locate(moved, gear, workers=1)

    radius = np.hypot(moved[:, 0], moved[:, 1])
    bands = Bands.wide(gear)
    centre = p.tooth * gear.pitch_angle
    beyond_centre_line = p.side * np.angle((moved[:, 0] + 1j * moved[:, 1]) * np.exp(-1j * centre)) <= 0.0
    on_flank = (
        (radius >= gear.form_radius)  # below, the fillet owns the metal
        & (p.roll + deviation > 0.0)  # deeper, the parallel has passed its cusp
        & ~beyond_centre_line
        & (radius - gear.tip_radius < np.maximum(deviation, bands.tip[0]))  # nearer the tip land
        & (deviation >= bands.flank[0])
    )
    assert on_flank.sum() > N / 4
    p, found, deviation = p.take(on_flank), found.take(on_flank), deviation[on_flank]
    assert (found.surface == FLANK).all()
    np.testing.assert_array_equal(found.tooth, p.tooth)
    np.testing.assert_array_equal(found.side, p.side)
    reach = p.roll + deviation
    np.testing.assert_allclose(found.deviation, deviation, rtol=0, atol=rounding(gear))
    assert (np.abs(found.roll - p.roll) <= rounding(gear, reach)).all()
    assert (np.abs(found.position - p.position).max(axis=1) <= rounding(gear, reach)).all()
    assert (np.abs(found.normal - p.normal).max(axis=1) * gear.base_radius <= rounding(gear, reach)).all()


@EACH
def test_fillet_displacement_comes_back_exactly(gear):
    rng = np.random.default_rng(4)
    rack = gear.rack
    phi = rng.uniform(0.02, 0.98, N) * gear.fillet_end
    reach = 0.5 * rack.tip_radius if rack.tip_radius > 0.0 else 0.05 * gear.transverse_module
    deviation = rng.uniform(-reach, min(reach, 0.15 * gear.transverse_module), N)
    tooth, side = rng.integers(0, gear.teeth, N), rng.choice([-1, 1], N)
    radius, angle = rack.polar(phi)

    def place(at):  # from the frame of a space's centre line, angles counted towards the tooth, to the tooth and side
        in_tooth = np.exp(1j * 0.5 * gear.pitch_angle) * at.conj()
        return np.where(side > 0, in_tooth, in_tooth.conj()) * np.exp(1j * tooth * gear.pitch_angle)

    foot = place(radius * np.exp(1j * angle))
    normal = place(np.exp(-1j * (phi + rack.contact(phi)[2])))
    moved = foot + deviation * normal
    z = np.full(N, 0.5 * gear.face_width)
    found = locate(np.column_stack([moved.real, moved.imag, z]), gear, workers=1)

    within = np.abs(np.angle(moved * np.exp(-1j * tooth * gear.pitch_angle)))
    below = (
        (np.abs(moved) < gear.form_radius)
        & (0.5 * gear.pitch_angle - within > gear.root_half_angle)
        & (within < 0.5 * gear.pitch_angle)
        & (np.abs(moved) > gear.root_radius - 0.1 * gear.transverse_module)
    )
    assert below.sum() > N / 4
    found = found.take(below)
    assert (found.surface == FILLET).all()
    np.testing.assert_array_equal(found.tooth, tooth[below])
    np.testing.assert_array_equal(found.side, side[below])
    assert np.isnan(found.roll).all()
    length = 1e-12 * gear.tip_radius
    np.testing.assert_allclose(found.deviation, deviation[below], rtol=0, atol=length)
    np.testing.assert_allclose(found.position[:, 0] + 1j * found.position[:, 1], foot[below], rtol=0, atol=10 * length)
    np.testing.assert_allclose(found.normal[:, 0] + 1j * found.normal[:, 1], normal[below], rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", ["paper_pinion_030", "paper_wheel", "thinned", "hundred_teeth"])
def test_lands_bore_and_ends_come_back_exactly(name):
    plain = SPREAD[name].spec
    spec = GearSpec(
        "gear",
        plain.teeth,
        plain.normal_module,
        plain.face_width,
        thinning=plain.thinning,
        bore_diameter=plain.normal_module * 3.0,
    )
    gear = Gear.from_spec(spec)
    rng = np.random.default_rng(5)
    m, b = gear.transverse_module, gear.face_width
    deviation = rng.uniform(-0.05 * m, 0.05 * m, N)
    tooth = rng.integers(0, gear.teeth, N)
    z = rng.uniform(0.3, 0.7, N) * b
    land = 0.9 * rng.uniform(-1.0, 1.0, N)

    for code, radius, angle, outward in (
        (TIP, gear.tip_radius, land * gear.tip_half_angle, 1.0),
        (ROOT, gear.root_radius, 0.5 * gear.pitch_angle + land * gear.root_half_angle, 1.0),
        (BORE, 1.5 * m, land * math.pi, -1.0),
    ):
        theta = tooth * gear.pitch_angle + angle
        ray = np.column_stack([np.cos(theta), np.sin(theta), np.zeros(N)])
        foot = radius * ray + np.column_stack([np.zeros(N), np.zeros(N), z])
        found = locate(foot + (outward * deviation)[:, None] * ray, gear, workers=1)
        _same(found, code, foot, outward * ray, deviation, gear)

    for code, height, up in ((END_LOW, 0.0, -1.0), (END_HIGH, b, 1.0)):
        radius, theta = rng.uniform(2.0 * m, gear.root_radius - 0.2 * m, N), rng.uniform(-math.pi, math.pi, N)
        foot = np.column_stack([radius * np.cos(theta), radius * np.sin(theta), np.full(N, height)])
        normal = np.tile([0.0, 0.0, up], (N, 1))
        _same(locate(foot + deviation[:, None] * normal, gear, workers=1), code, foot, normal, deviation, gear)


def _same(found, code, foot, normal, deviation, gear):
    assert {SURFACE_NAMES[c] for c in found.surface} == {SURFACE_NAMES[code]}
    assert (found.side == 0).all()
    assert np.isnan(found.roll).all()
    np.testing.assert_allclose(found.deviation, deviation, rtol=0, atol=rounding(gear))
    np.testing.assert_allclose(found.position, foot, rtol=0, atol=rounding(gear))
    np.testing.assert_allclose(found.normal, normal, rtol=0, atol=1e-14)


@EACH
def test_deviation_is_the_distance_to_the_outline(gear):
    """|δ| against the nearest of many points of the outline, away from its corners; the sign says which side."""
    m = gear.transverse_module
    rng = np.random.default_rng(6)
    radius = gear.root_radius + (gear.flank_end_radius - gear.root_radius) * np.linspace(0.0, 1.0, 40001) ** 2
    side = radius * np.exp(1j * gear.half_angle(radius))
    tip = gear.tip_radius * np.exp(1j * np.linspace(0.0, gear.tip_half_angle, 8001))
    root = gear.root_radius * np.exp(
        1j * np.linspace(0.5 * gear.pitch_angle - gear.root_half_angle, 0.5 * gear.pitch_angle, 8001)
    )
    outline = np.concatenate([tip, side[::-1], root])
    spacing = np.abs(np.diff(outline)).max()

    here = outline[rng.integers(0, len(outline), N)]
    point = here + 0.03 * m * (rng.uniform(-1, 1, N) + 1j * rng.uniform(-1, 1, N))
    corners = np.array([tip[-1], gear.form_radius * np.exp(1j * gear.half_angle(gear.form_radius))])
    clear = (np.abs(point[:, None] - corners) > 0.1 * m).all(axis=1)
    clear &= (np.angle(point) > 1e-3) & (np.angle(point) < 0.5 * gear.pitch_angle - 1e-3)
    point = point[clear]
    nearest = KDTree(np.column_stack([outline.real, outline.imag])).query(np.column_stack([point.real, point.imag]))[0]
    found = locate(np.column_stack([point.real, point.imag, np.full(len(point), 0.5 * gear.face_width)]), gear, workers=1)
    far = nearest > 2.0 * spacing
    assert far.sum() > N / 4
    # the outline's points are up to half a spacing off the foot: √(d² + (h/2)²) − d ≤ h² / 8d
    error = nearest[far] - np.abs(found.deviation[far])
    allowed = spacing**2 / (8.0 * nearest[far]) + 1e-3 * spacing
    assert (np.abs(error) <= allowed).all(), f"{np.abs(error / allowed).max()}"
    metal = np.abs(np.angle(point)) < gear.half_angle(np.clip(np.abs(point), gear.root_radius, gear.tip_radius))
    metal = ((metal | (np.abs(point) < gear.root_radius)) & (np.abs(point) < gear.tip_radius))[far]
    assert ((found.deviation[far] < 0.0) == metal).all()


class TestSymmetry:
    @staticmethod
    def _cloud(gear: Gear) -> np.ndarray:
        """Points all round and through the gear, on no surface in particular."""
        rng = np.random.default_rng(7)
        radius = rng.uniform(0.9 * gear.root_radius, 1.02 * gear.tip_radius, 4 * N)
        angle = rng.uniform(-math.pi, math.pi, 4 * N)
        # where two teeth or two sides are equally near, either answer is right
        share = np.mod(angle / gear.pitch_angle, 0.5)
        keep = (share > 1e-6) & (share < 0.5 - 1e-6)
        z = rng.uniform(-0.05, 1.05, 4 * N) * gear.face_width
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])[keep]

    @EACH
    def test_turning_by_a_pitch_counts_one_tooth_on(self, gear):
        points = self._cloud(gear)
        cos, sin = math.cos(gear.pitch_angle), math.sin(gear.pitch_angle)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        before, after = locate(points, gear, workers=1), locate(points @ turn.T, gear, workers=1)
        self._close(before, after, gear, tooth=(before.tooth + 1) % gear.teeth, side=before.side)
        np.testing.assert_allclose(after.normal, before.normal @ turn.T, rtol=0, atol=1e-6)

    @EACH
    def test_mirrored_in_x_the_sides_change(self, gear):
        points = self._cloud(gear)
        mirror = np.diag([1.0, -1.0, 1.0])
        before, after = locate(points, gear, workers=1), locate(points @ mirror, gear, workers=1)
        self._close(before, after, gear, tooth=-before.tooth % gear.teeth, side=-before.side)
        np.testing.assert_allclose(after.normal, before.normal @ mirror, rtol=0, atol=1e-6)

    @EACH
    def test_mirrored_in_height_the_ends_change(self, gear):
        points = self._cloud(gear)
        flipped = points * [1.0, 1.0, -1.0] + [0.0, 0.0, gear.face_width]
        before, after = locate(points, gear, workers=1), locate(flipped, gear, workers=1)
        swap = np.array([FLANK, FILLET, ROOT, TIP, END_HIGH, END_LOW, BORE, OTHER])
        self._close(before, after, gear, tooth=before.tooth, side=before.side, codes=swap[before.surface])

    @staticmethod
    def _close(before, after, gear, tooth, side, codes=None):
        # a point within rounding of a border between surfaces may change hands; none of the cloud is that near
        np.testing.assert_array_equal(after.surface, before.surface if codes is None else codes)
        known = before.surface != OTHER
        np.testing.assert_array_equal(after.tooth[known], tooth[known])
        np.testing.assert_array_equal(after.side, side)
        length = 1e-11 * gear.tip_radius
        np.testing.assert_allclose(after.deviation, before.deviation, rtol=0, atol=length)
        reach = np.nan_to_num(before.roll + before.deviation, nan=1.0)
        assert (np.nan_to_num(np.abs(after.roll - before.roll)) <= length * (1.0 + gear.tip_radius / reach)).all()


def test_threads_and_chunks_do_not_change_the_answer(monkeypatch, pinion):
    rng = np.random.default_rng(8)
    n = 3 * CHUNK + 17
    radius, angle = rng.uniform(28.0, 45.0, n), rng.uniform(-math.pi, math.pi, n)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(-0.5, 15.5, n)])
    whole = locate(points, pinion, workers=1)
    threads = locate(points, pinion, workers=3)
    monkeypatch.setattr(surface, "CHUNK", 1000)
    small = locate(points, pinion, workers=1)
    for field in ("surface", "tooth", "side", "roll", "position", "normal", "deviation"):
        np.testing.assert_array_equal(getattr(threads, field), getattr(whole, field))
        # Newton's method on the fillet stops for a chunk together: one step more or less, below 1e-16 of it
        np.testing.assert_allclose(getattr(small, field), getattr(whole, field), rtol=0, atol=1e-12)


def test_no_points_are_no_trouble(pinion):
    assert len(locate(np.empty((0, 3)), pinion)) == 0


def test_the_input_is_left_alone(pinion):
    points = np.array([[38.1, 3.0, 7.0], [0.0, 0.0, 7.0]])
    kept = points.copy()
    locate(points, pinion)
    np.testing.assert_array_equal(points, kept)


@pytest.mark.parametrize("bore", [0.0, 20.0])
def test_what_the_design_does_not_describe_is_other(bore):
    gear = Gear.from_spec(GearSpec("gear", 24, 2.0, 10.0, bore_diameter=bore))
    strays = {
        "on the axis": (0.0, 0.0, 5.0),
        "in the web": (15.0, 3.0, 5.0),
        "far away": (300.0, -50.0, 5.0),
        "beside the tip": (27.0, 0.0, 5.0),
        "in the space": (25.0 * math.cos(math.pi / 24), 25.0 * math.sin(math.pi / 24), 5.0),
        "a hub above the end": (15.0, 0.0, 12.0),
        "a foot below the end": (15.0, 0.0, -2.0),
        "deep in the root": (20.0, 20.0 * math.tan(math.pi / 24), 5.0),
    }
    found = locate(np.array(list(strays.values())), gear)
    assert dict(zip(strays, (SURFACE_NAMES[c] for c in found.surface), strict=True)) == dict.fromkeys(strays, "other")
    assert np.isnan(found.deviation).all()
    assert np.isnan(found.roll).all()
    np.testing.assert_array_equal(found.position, list(strays.values()))


def test_bands_decide_how_far_a_surface_reaches(pinion):
    """The same point on the way from the tip land into the tooth: tip within the band, flank below it."""
    angle = float(pinion.half_angle(44.0)) - 0.3 / 44.0
    point = np.array([[44.0 * math.cos(angle), 44.0 * math.sin(angle), 7.0]])  # 0.45 below the land
    wide = Bands.wide(pinion)
    bands = [Bands((low, 0.5), wide.root, wide.end_low, wide.end_high, wide.bore, wide.flank) for low in (-0.5, -0.4)]
    assert [SURFACE_NAMES[locate(point, pinion, b).surface[0]] for b in bands] == ["flank", "flank"]  # 0.26 of flank is nearer
    deeper = np.array([[44.0, 0.0, 7.0]])
    assert [SURFACE_NAMES[locate(deeper, pinion, b).surface[0]] for b in bands] == ["tip", "flank"]


class TestChamfers:
    gear = Gear.from_spec(GearSpec("gear", 20, 2.0, 10.0, tip_chamfer=0.3, end_chamfer=0.5))

    def test_points_on_the_tip_chamfer_are_other(self):
        gear, share = self.gear, np.linspace(0.05, 0.95, 19)
        low = gear.flank_end_radius * np.exp(1j * float(gear.half_angle(gear.flank_end_radius)))
        high = gear.tip_radius * np.exp(1j * gear.tip_half_angle)
        for turn, mirrored in ((0.0, False), (3.0, True)):
            line = low + share * (high - low)
            line = (line.conj() if mirrored else line) * np.exp(1j * turn * gear.pitch_angle)
            found = locate(np.column_stack([line.real, line.imag, np.full(19, 5.0)]), gear)
            assert (found.surface == OTHER).all()

    def test_flank_below_and_land_between_remain(self):
        gear = self.gear
        roll = np.linspace(gear.form_roll + 0.01, gear.tip_roll - 0.01, 9)
        flank = flank_points(gear, np.full(9, 4), np.full(9, -1), roll, np.full(9, 5.0))
        assert (locate(flank.position, gear).surface == FLANK).all()
        land = gear.tip_radius * np.exp(1j * gear.tip_half_angle * np.linspace(-0.95, 0.95, 9))
        found = locate(np.column_stack([land.real, land.imag, np.full(9, 5.0)]), gear)
        assert (found.surface == TIP).all()
        np.testing.assert_allclose(found.deviation, 0.0, atol=1e-14)

    def test_the_two_legs_of_the_chamfer_are_equal(self):
        gear = self.gear
        along = gear.tip_radius * (float(gear.half_angle(gear.flank_end_radius)) - gear.tip_half_angle)
        assert along == pytest.approx(0.3, rel=1e-12)
        assert gear.tip_radius - gear.flank_end_radius == pytest.approx(0.3, rel=1e-12)

    @pytest.mark.parametrize("end", [0, 1])
    def test_points_on_the_end_chamfer_are_other_and_the_rest_is_not(self, end):
        gear, n = self.gear, 15
        rng = np.random.default_rng(9)
        tooth, side = rng.integers(0, 20, n), rng.choice([-1, 1], n)
        roll = rng.uniform(gear.form_roll + 1.0, gear.tip_roll - 0.1, n)
        share = np.linspace(0.05, 0.95, n)
        height = np.abs(10.0 * end - 0.5 * share)  # z on the chamfer, which takes 0.5 − its height off the flank
        flank = flank_points(gear, tooth, side, roll, height)
        chamfer = flank.position - (0.5 * (1.0 - share))[:, None] * flank.normal
        assert (locate(chamfer, gear).surface == OTHER).all()
        inside = flank_points(gear, tooth, side, roll, np.full(n, 5.0))
        assert (locate(inside.position, gear).surface == FLANK).all()
        disc = np.column_stack([np.full(n, 12.0), np.linspace(-5.0, 5.0, n), np.full(n, 10.0 * end)])
        assert (locate(disc, gear).surface == (END_LOW, END_HIGH)[end]).all()

    @pytest.mark.parametrize("end", [0, 1])
    def test_points_far_below_an_end_chamfer_are_other_too(self, end):
        """Of all points beside a chamfer those alone that lie deeper would be the flank's: strays, and wear where there is none."""
        gear, n = self.gear, 15
        bands = replace(Bands.wide(gear), end_low=(-0.05, 0.05), end_high=(-0.05, 0.05))
        roll, side = np.linspace(gear.form_roll + 1.5, gear.tip_roll - 0.1, n), np.arange(n) % 2 * 2 - 1
        for height, expected in ((0.3, OTHER), (0.7, FLANK)):
            flank = flank_points(gear, np.arange(n), side, roll, np.full(n, abs(10.0 * end - height)))
            assert (locate(flank.position - 0.7 * flank.normal, gear, bands).surface == expected).all()

    def test_far_from_the_ends_flanks_remain_where_no_end_was_seen(self):
        """Bands of an end that takes no points are infinite; all points were of nothing."""
        never = (np.inf, np.inf)
        roll = np.linspace(self.gear.form_roll + 0.1, self.gear.tip_roll - 0.1, 9)
        flank = flank_points(self.gear, np.arange(9), np.full(9, 1), roll, np.linspace(1.0, 9.0, 9))
        found = locate(flank.position, self.gear, replace(Bands.wide(self.gear), end_low=never, end_high=never))
        assert (found.surface == FLANK).all()


def test_surface_points_are_picked_by_mask_and_by_index(pinion):
    p = flank_points(pinion, np.arange(6), np.array([1, -1] * 3), np.linspace(5.0, 20.0, 6), np.full(6, 3.0))
    by_mask, by_index = p.take(p.side > 0), p.take(np.array([0, 2, 4]))
    np.testing.assert_array_equal(by_mask.position, by_index.position)
    np.testing.assert_array_equal(by_mask.tooth, [0, 2, 4])
    moved = p.with_deviation(np.full(6, 0.1))
    np.testing.assert_array_equal(moved.deviation, 0.1)
    np.testing.assert_array_equal(moved.position, p.position)
    np.testing.assert_array_equal(p.deviation, 0.0)
