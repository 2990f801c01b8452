"""Where the gear lies: poses put in and asked back, and whether the stated standard deviations are true."""

import itertools
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.surface import BORE, END_HIGH, END_LOW, TIP, Bands, locate
from gearwear.errors import InputError
from gearwear.placing import registration
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.datum import choose_datum
from gearwear.placing.pose import Pose
from gearwear.placing.registration import Registration, _known, fit_cells, register
from tests.placing.placing import designed, motion_off, refined, true_pose
from tests.synthetic import (
    PINION,
    WHEEL,
    AbrasiveWear,
    GearNumbers,
    Patch,
    PoseError,
    Recipe,
    Rigid,
    SlidingWear,
    SyntheticScan,
    make_scan,
    pose_error,
    rotation_about,
)

GEAR = designed()
RB = GEAR.base_radius
PLAIN = Recipe(pose="any", jitter=1.0)
SURE = 5.0
"""Standard deviations a single motion may be off: of a t distribution with the 23 degrees of freedom of 24 flanks, 5 in 100,000 are further."""
SETTLED = 2e-5
"""mm at the base circle; where the iteration stops, two ways to the same scan may differ by this much."""


def error(scan: SyntheticScan, found: Registration) -> PoseError:
    return pose_error(found.pose.rotation, found.pose.translation, scan.truth.pose, scan.truth.outline)


def pulls(scan: SyntheticScan, found: Registration, gear=GEAR) -> np.ndarray:
    """Errors in their stated standard deviations, of the motions that were observed."""
    std = np.sqrt(np.diag(found.covariance))
    return (motion_off(found.pose, scan.truth.pose, gear) / np.where(found.observed, std, np.inf))[found.observed]


@cache
def plain(points: int = 8_000, seed: int = 1) -> SyntheticScan:
    return make_scan(PLAIN.of_size(points), seed)


class TestAcceptance:
    """Points with 10 µm of noise and strays, from no guess at all."""

    @pytest.mark.long
    def test_a_worn_patch_turns_the_gear_by_less_than_a_tenth_of_a_micrometre(self):
        wear = (Patch(3, 1, 400.0, (37.0, 43.0), (2.0, 11.0)),)
        scan = make_scan(Recipe(pose="any", wear=wear, outliers=0.0005, lost=0.02).of_size(450_000), 1)
        found = register(scan.points, GEAR)
        assert found.converged
        assert (found.datum.worn_side, found.notes) == (None, ())
        assert abs(error(scan, found).turn) * RB < 1e-4
        assert (np.abs(pulls(scan, found)) < SURE).all()

    @pytest.mark.long
    def test_drive_flanks_worn_throughout_turn_it_by_less_than_a_micrometre_and_are_named(self):
        scan = make_scan(Recipe(pose="any", wear=(SlidingWear(100.0, 1),), outliers=0.0005, lost=0.02).of_size(100_000), 2)
        found = register(scan.points, GEAR)
        assert found.converged
        off = error(scan, found)
        assert abs(off.turn) * RB < 1e-3
        worn = -1 if off.flipped else 1  # upside down left is right
        assert found.datum.worn_side == worn
        assert ("right flanks (coast)" if worn > 0 else "left flanks (coast)") in found.datum.surfaces
        assert any("assumed unworn" in note for note in found.notes)


class TestStatedStandardDeviations:
    """Errors over many scans against what each scan said of itself."""

    SCANS = 30

    @pytest.mark.long
    @pytest.mark.parametrize(
        "recipe",
        [PLAIN, Recipe(pose="any", jitter=1.0, wear=(SlidingWear(100.0, 1),)), Recipe(pose="any", jitter=1.0, ends="none")],
        ids=["unworn", "drive flanks worn", "no end faces"],
    )
    def test_pulls_have_the_spread_of_the_t_distribution(self, recipe):
        """Each motion's sum of squares, two-sided, at a false alarm of 1 in 1,000; a standard deviation 1.5 times too small is seen."""
        found = np.array([pulls(scan, refined(scan, GEAR)) for scan in map(self.scan(recipe), range(self.SCANS))])
        low, high = self.limits()
        squares = (found**2).sum(axis=0)
        assert (squares > low).all(), squares
        assert (squares < high).all(), squares

    @staticmethod
    def scan(recipe):
        return lambda seed: make_scan(recipe.of_size(8_000), 100 + seed)

    @classmethod
    def limits(cls):
        """Of the sum of squares of as many values of t with the degrees of freedom of 11 flanks, fewer than any fit here rests on."""
        drawn = (np.random.default_rng(0).standard_t(11, (40_000, cls.SCANS)) ** 2).sum(axis=1)
        return np.quantile(drawn, [0.0005, 0.9995])

    @pytest.mark.long
    def test_a_thousand_points_are_enough(self):
        for seed in range(8):
            scan = make_scan(PLAIN.of_size(1_000), seed)
            found = register(scan.points, GEAR)
            assert found.converged, seed
            assert (np.abs(pulls(scan, found)) < SURE).all(), seed
            # 10 µm of noise on some 440 flank points; the coast of half a micrometre is of that order.
            assert abs(error(scan, found).turn) * RB < SURE * 0.010 / math.sqrt(400), seed


AXES = [(0, 0, 0), (math.pi, 0, 0), (math.pi / 2, 0, 0), (0, math.pi / 2, 0), (0, 0, math.pi), (1.0, 2.0, -1.5), (-2.0, 0.3, 2.2)]


@pytest.mark.long
@pytest.mark.parametrize("about", AXES, ids=str)
def test_any_orientation_gives_the_same_place_and_the_least_turn(about):
    """As scanned, upside down, on its side, half round: the same gear in the same place, numbered from the scan's own x."""
    scan = plain()
    moved = Rigid(rotation_about(np.array(about)), np.array([30.0, -80.0, 12.0]))
    points = moved.apply(true_pose(scan).apply(scan.points))
    found = register(points, GEAR)
    off = pose_error(found.pose.rotation, found.pose.translation, moved, scan.truth.outline)
    turn, shift, tilt = self_errors()
    assert abs(abs(off.turn) - turn) * RB < SETTLED
    assert abs(off.tilt - tilt) * GEAR.tip_radius < SETTLED
    assert abs(np.linalg.norm(off.shift) - shift) < SETTLED

    own = Rigid(found.pose.rotation, found.pose.translation)
    pitch = 2.0 * math.pi / 12
    angles = []
    for teeth, upside in itertools.product(range(12), (False, True)):
        turned = Rigid(rotation_about(np.array([0.0, 0.0, teeth * pitch])), np.zeros(3))
        flipped = Rigid(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 15.0])) if upside else Rigid(np.eye(3), np.zeros(3))
        angles.append(turned.after(flipped).after(own).angle)
    assert own.angle <= min(angles) + 1e-9


@cache
def self_errors() -> tuple[float, float, float]:
    """Turn, shift and tilt left where the search starts at the truth."""
    off = error(plain(), refined(plain(), GEAR))
    return abs(off.turn), float(np.linalg.norm(off.shift)), off.tilt


@pytest.mark.long
def test_a_face_seen_from_the_other_side_is_the_other_end():
    """One end face only, once towards +z and once away from it: the height comes from that face."""
    names = set()
    for seed in (1, 2, 3):
        scan = make_scan(Recipe(pose="any", jitter=1.0, ends="upper").of_size(8_000), seed)
        found = register(scan.points, GEAR)
        seen = "lower end" if error(scan, found).flipped else "upper end"
        names.add(seen)
        assert {"lower end", "upper end"} & set(found.datum.surfaces) == {seen}
        assert found.observed.all()
        assert (np.abs(pulls(scan, found)) < SURE).all()
    assert len(names) == 2


def test_without_end_faces_the_height_is_centred_and_said_to_be_unknown(monkeypatch):
    """And whether it is of this gear is asked of the height that it has then, not of the first as well."""
    asked = []
    monkeypatch.setattr(registration, "_check_fit", lambda *given: asked.append(given) or 1.0)
    scan = make_scan(Recipe(pose="any", jitter=1.0, ends="none").of_size(8_000), 4)
    points = scan.points[true_pose(scan).apply(scan.points)[:, 2] < 9.0]
    found = register(points, GEAR)
    assert len(asked) == 1
    np.testing.assert_array_equal(found.observed, [True, True, False, True, True, True])
    assert any("height is centred" in note for note in found.notes)
    z = found.pose.apply(points)[:, 2]
    assert 0.5 * (z.min() + z.max()) == pytest.approx(7.5, abs=0.1)
    turn, tilt = pulls(scan, found)[[4, 2]]
    assert max(abs(turn), abs(tilt)) < SURE


@pytest.mark.parametrize("kind", ["outward", "inward", "some missing", "all zero", "of nothing"])
def test_normals_of_the_file_may_point_either_way_or_be_wrong(kind):
    scan = plain()
    outward = locate(true_pose(scan).apply(scan.points), GEAR).normal @ scan.truth.pose.rotation.T
    drawn = np.random.default_rng(1).normal(size=outward.shape)
    normals = {
        "outward": outward,
        "inward": -outward,
        "some missing": np.where(drawn[:, :1] > 0.5, 0.0, outward),
        "all zero": 0.0 * outward,
        "of nothing": drawn / np.linalg.norm(drawn, axis=1, keepdims=True),
    }
    off = error(scan, register(scan.points, GEAR, normals[kind]))
    turn, shift, _ = self_errors()
    assert abs(abs(off.turn) - turn) * RB < SETTLED
    assert abs(np.linalg.norm(off.shift) - shift) < SETTLED


@pytest.mark.long
@pytest.mark.parametrize("factor", [pytest.param(0.99, marks=pytest.mark.long), 1.01])
def test_a_scan_of_another_size_is_laid_on_the_design_and_not_shrunk_to_it(factor):
    """Rigid: what a scale adds must still be there afterwards, at the tips and between the end faces."""
    scan = plain(20_000)
    found = register(factor * scan.points, GEAR)
    np.testing.assert_allclose(found.pose.rotation @ found.pose.rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(found.pose.rotation) == pytest.approx(1.0)
    placed = locate(found.pose.apply(factor * scan.points), GEAR, found.bands)
    tips = placed.deviation[placed.surface == TIP]
    assert len(tips) > 1000
    assert np.median(tips) == pytest.approx((factor - 1.0) * GEAR.tip_radius, abs=SURE * 1.25 * 0.010 / math.sqrt(len(tips)))
    ends = [placed.deviation[placed.surface == end] for end in (END_LOW, END_HIGH)]
    grown = np.median(ends[0]) + np.median(ends[1])
    assert grown == pytest.approx((factor - 1.0) * 15.0, abs=SURE * 1.25 * 0.010 * math.sqrt(2.0 / min(map(len, ends))))


class TestUniformLoss:
    """The same loss on every flank of one side is a rotation of thinner teeth."""

    @pytest.mark.long
    def test_it_is_said_and_the_doubt_covers_the_error(self):
        scan = make_scan(Recipe(pose="any", jitter=1.0, wear=(AbrasiveWear(60.0, 1),)).of_size(20_000), 1)
        found = register(scan.points, GEAR)
        assert found.datum.worn_side is None
        (note,) = (note for note in found.notes if "cannot tell" in note)
        doubt = float(re.search(r"off by up to ([\d.]+) µm", note)[1])
        assert 1e3 * abs(error(scan, found).turn) * RB < doubt
        assert doubt == pytest.approx(30.0, abs=1.0)  # half the loss

    def test_where_nothing_is_seen_but_flanks_that_is_said_too(self):
        scan = make_scan(Recipe(pose="mild", jitter=1.0, ends="none").of_size(20_000), 1)
        roll = scan.truth.labels.roll
        found = register(
            scan.points[(roll > 5.0) & (roll < 25.0)], GEAR
        )  # away from the corners: not a point of a fillet or a tip
        assert any("only flanks were seen" in note for note in found.notes)

    def test_an_unworn_gear_raises_no_doubt(self):
        assert register(plain(20_000).points, GEAR).notes == ()


@pytest.mark.parametrize(
    ("in_scan", "in_design"),
    [
        (True, True),
        (True, False),
        pytest.param(False, True, marks=pytest.mark.long),
        pytest.param(False, False, marks=pytest.mark.long),
    ],
)
def test_a_bore_in_the_scan_or_in_the_design(in_scan, in_design):
    """Where the design has none its points are left out, and say so by the share that fits; nothing else moves."""
    numbers, bored = PINION, GearNumbers(bore_diameter=30.0)
    scan = make_scan(Recipe(bored if in_scan else numbers, pose="any", jitter=1.0, end_inner_radius=16.0).of_size(12_000), 1)
    gear = designed(bored if in_design else numbers)
    found = register(scan.points, gear)
    assert (np.abs(pulls(scan, found, gear)) < SURE).all()
    on_bore = scan.truth.labels.surface == 6
    placed = locate(found.pose.apply(scan.points), gear, found.bands)
    if in_scan and in_design:
        assert np.mean(placed.surface[on_bore] == BORE) > 0.99  # the noise takes those at its edges over the end faces' planes
        assert np.abs(np.median(placed.deviation[placed.surface == BORE])) < SURE * 1.25 * 0.010 / math.sqrt(on_bore.sum())
    else:
        assert not (placed.surface == BORE).any()
    if not in_design:
        assert found.fitting == pytest.approx(1.0 - on_bore.mean(), abs=0.005)


@pytest.mark.parametrize("degrees", [pytest.param(180, marks=pytest.mark.long), 90, 40])
def test_a_part_of_the_gear_is_enough(degrees):
    """Down to a tooth and a bit; what is less well known is said to be."""
    scan = plain(40_000)
    design = true_pose(scan).apply(scan.points)
    points = scan.points[np.abs(np.arctan2(design[:, 1], design[:, 0]) - 0.3) < math.radians(0.5 * degrees)]
    found = register(points, GEAR)
    assert (np.abs(pulls(scan, found)) < SURE).all()
    whole = refined(scan, GEAR)
    assert (np.diag(found.covariance) > np.diag(whole.covariance)).all()


@pytest.mark.parametrize(
    "numbers",
    [WHEEL, GearNumbers(75, 0.8, 6.0), GearNumbers(23, 2.0, 18.0, 25.0, 0.4, rack_tip_radius=0.2)],
    ids=["24", "75", "23"],
)
def test_other_gears(numbers):
    scan = make_scan(Recipe(numbers, pose="any", jitter=1.0, outliers=0.01, lost=0.05).of_size(15_000), 3)
    gear = designed(numbers)
    assert (np.abs(pulls(scan, register(scan.points, gear), gear)) < SURE).all()


@pytest.mark.parametrize("numbers", [GearNumbers(35, 2.5, 30.0), GearNumbers(57, 3.0, 36.0)], ids=["35", "57"])
def test_lines_of_points_far_from_each_other(numbers):
    """Neighbours of a point lie on its own line then, and normals are those of the lines."""
    scan = make_scan(Recipe(numbers, pose="any", noise_um=6.0).of_size(6_000), 5)
    gear = designed(numbers)
    assert (np.abs(pulls(scan, register(scan.points, gear), gear)) < SURE).all()


@pytest.mark.parametrize(("module", "noise_um"), [(0.28, 2.0), (6.35, 10.0)])
def test_a_last_step_that_is_nothing_beside_what_the_pose_is_known_to_is_settled(module, noise_um):
    """0.07 µm were much for teeth of module 0.28, whose pose was known to 2 µm."""
    gear = designed(GearNumbers(13, module, 3.0 * module))
    scan = make_scan(Recipe(GearNumbers(13, module, 3.0 * module), pose="none", jitter=1.0, noise_um=noise_um).of_size(20_000), 6)
    located = locate(scan.points, gear)
    cells = bin_points(located, CellGrid.for_scan(gear, len(located)), clip=0.04 * module)
    datum, free = choose_datum(cells, 1e-3 * noise_um), np.ones(6, dtype=bool)
    fit = fit_cells(cells, datum, free)
    std = np.sqrt(np.diag(fit.covariance))
    known = math.hypot(*std[:3]) + gear.tip_radius * math.hypot(*std[3:])  # of a point of the tip circle
    least = max(0.1 * known, 2e-4 * module)
    for share in (0.95, 1.05):
        found = _known(Pose.identity(), cells, datum, free, replace(fit, step=share * least), Bands.wide(gear), 1.0)
        assert found.converged is (share < 1.0)
        assert any("did not settle" in note for note in found.notes) is (share > 1.0)


NOT_THIS_GEAR = {
    "11 teeth": GearNumbers(11),
    "17 teeth of module 4.5": GearNumbers(17, 4.5),
    "24 teeth": WHEEL,
}


@pytest.mark.parametrize("name", ["a ball", *NOT_THIS_GEAR])
def test_what_is_not_this_gear_is_refused_or_does_not_settle_and_says_so(name):
    if name in NOT_THIS_GEAR:
        points = make_scan(Recipe(NOT_THIS_GEAR[name], pose="any").of_size(8_000), 1).points
    else:
        points = np.random.default_rng(1).normal(size=(5_000, 3))
        points *= 40.0 / np.linalg.norm(points, axis=1, keepdims=True)
    try:
        found = register(points, GEAR)
    except InputError as refusal:
        assert re.search(r"does not fit the design: \d+ % of its points lie on it", str(refusal))
    else:
        assert not found.converged
        assert found.fitting < 0.8
        assert any("of the points lie on the design" in note for note in found.notes)
        assert any("did not settle" in note for note in found.notes)
