"""The study of the closed loop in small: scans whose outcome is clear, and the scoring itself.

The whole of it: `python -m benchmarks.study`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.loop_study.detection import Cover, Rule, true_cover, visibility
from benchmarks.loop_study.fitting import designed
from benchmarks.loop_study.intervals import Rate
from benchmarks.loop_study.run import study
from benchmarks.loop_study.scenario import NAMES, Scenario, draw, effect
from benchmarks.loop_study.scoring import Found, match, parameter_errors
from benchmarks.loop_study.table import markdown, summary
from benchmarks.loop_study.truth import Placement, as_found, turn_error
from gearwear.design.surface import FLANK, locate
from gearwear.diagnose.effects.base import ParameterEstimate
from gearwear.placing.cells import CellGrid, bin_points
from tests.synthetic import PINION, Effect, Outline, Patch, PoseError, Recipe, Texture, make_scan, pose_error
from tests.synthetic.pose import Rigid, rotation_about
from tests.synthetic.texture import sample_texture

pytestmark = pytest.mark.long

POINTS = 20_000
OUTLINE = Outline.of(PINION)
WORN = Recipe(
    noise_um=8.0,
    texture=Texture(2.0, 1.0),
    outliers=0.0005,
    lost=0.03,
    jitter=1.0,
    wear=(Patch(2, 1, 250.0, (37.0, 43.0), (3.0, 12.0)),),
    pose="any",
).of_size(POINTS)


def scored(effects: tuple[Effect, ...], seed: int) -> dict:
    return study(Scenario("test", replace(WORN, effects=effects), seed, mate=False))[0]


@pytest.mark.parametrize("name", ["coating", "scale", "turntable_angle", "helix_slope", "pitch"])
def test_a_strong_effect_alone_is_named_and_nothing_else(name):
    # 15 µm of it, 20 times what the scan could show
    one = scored((effect(name, 15.0, OUTLINE, POINTS, np.random.default_rng(3)),), seed=11)
    (true,) = one["true"]
    assert true["limit"] < 0.2
    assert true["match"] == "name"
    assert [f["name"] for f in one["found"]] == [name]
    assert one["patterns"] == []
    for parameter in true["errors"].values():
        # an error four times its own standard deviation: one in 16,000 of a right one; the few here are drawn once
        assert not abs(parameter["error"]) > 4.0 * parameter["std"]


@pytest.fixture(scope="module")
def null() -> dict:
    """Texture and wear alone."""
    return scored((), seed=12)


def test_texture_and_wear_alone_get_no_name(null):
    assert null["found"] == []
    assert null["patterns"] == []
    (flank,) = null["wear"]["flanks"]
    assert flank["found"] == pytest.approx(flank["true"], rel=0.05)
    assert null["wear"]["false_flanks"] == []


def test_a_wave_that_no_effect_makes_is_called_unexplained():
    one = scored((Effect("wave_growing", {"order": 5, "amplitude_um": 20.0, "phase_deg": 30.0}),), seed=13)
    assert one["outside"]["detectable"]
    assert one["patterns"]
    assert not any(f["false"] for f in one["found"])


def test_a_scan_depends_on_its_own_number_only():
    one, again, other = draw("7", 1, POINTS), draw("7", 1, POINTS), draw("8", 1, POINTS)
    assert one == again
    assert one.recipe != other.recipe
    assert draw("n7", 1, POINTS).recipe.effects == ()
    assert draw("7", 2, POINTS) != one


def test_every_effect_of_the_study_moves_flanks_by_about_the_size_asked_for():
    clean = replace(WORN, noise_um=0.0, texture=None, outliers=0.0, wear=(), pose="none")
    gear = designed(PINION)
    for name in NAMES:
        made = effect(name, 10.0, OUTLINE, POINTS, np.random.default_rng(1))
        located = locate(make_scan(replace(clean, effects=(made,)), 1).points, gear)
        high = 1e3 * np.quantile(np.abs(located.deviation[located.surface == FLANK]), 0.98)
        # a height scale moves end faces only; a lateral offset is mostly a rotation, and drawn eight times as large
        low, most = {"height_scale": (0.0, 0.1), "axis_offset_lateral": (60.0, 80.0)}.get(name, (5.0, 25.0))
        assert low <= high <= most, name


# names


def test_names_match_one_to_one_and_the_best_first():
    found = [Found("scale", ("axis_offset_radial",)), Found("profile_slope", ()), Found("pitch", ())]
    matches, false = match(["axis_offset_radial", "scale", "taper"], found)
    # the found scale is the true scale's; the radial offset shares the documented group of scale and profile slope
    assert matches == [("group", 1), ("name", 0), ("missed", None)]
    assert false == [False, False, True]


def test_a_true_name_among_the_alternatives_is_right_and_no_false_name():
    matches, false = match(["profile_crowning"], [Found("tip_relief", ("profile_crowning", "root_relief"))])
    assert matches == [("alternative", 0)]
    assert false == [False]
    assert match([], [Found("tip_relief", ("profile_crowning",))]) == ([], [True])


def test_errors_go_the_short_way_round_and_a_list_is_judged_by_one_tooth():
    assert turn_error("phase_deg", 359.0, 2.0) == pytest.approx(-3.0)
    assert turn_error("direction_deg", 179.0, 1.0) == pytest.approx(-2.0)
    assert turn_error("offset_um", 359.0, 2.0) == pytest.approx(357.0)
    found = {
        "index_um": ParameterEstimate((1.0, 2.0, -3.0), (0.1, 0.2, 0.3), "um"),
        "start_mm": ParameterEstimate(5.0, math.nan, "mm"),
        "exponent": ParameterEstimate(1.0, math.nan, "1"),
    }
    errors = parameter_errors(found, {"index_um": (1.0, 1.5, -2.5), "start_mm": 4.0}, tooth=2)
    assert errors["index_um"] == {"true": -2.5, "error": pytest.approx(-0.5), "std": 0.3}
    assert errors["start_mm"]["error"] == pytest.approx(1.0)
    assert math.isnan(errors["start_mm"]["std"])
    assert set(errors) == {"index_um", "start_mm"}


# the truth in the found frame


@pytest.mark.parametrize(("teeth", "flipped"), [(0, False), (5, False), (0, True), (4, True)])
@pytest.mark.parametrize("name", [n for n in NAMES if n != "height_scale"])
def test_the_truth_said_in_the_found_frame_makes_the_same_points(name, teeth, flipped):
    # A gear with the effect, turned and turned over, is the gear with the effect's parameters as found, as it lies.
    placement = Placement(teeth, flipped)
    made = effect(name, 12.0, OUTLINE, POINTS, np.random.default_rng(9))
    b, turn = OUTLINE.face_width, teeth * OUTLINE.pitch_angle
    over = Rigid(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, b])) if flipped else Rigid(np.eye(3), np.zeros(3))
    found_frame = Rigid(rotation_about(np.array([0.0, 0.0, turn])), np.zeros(3)).after(over)
    # no end faces: a scale about the lower end leaves that one where it is, turned over the other
    clean = replace(
        WORN, noise_um=0.0, texture=None, outliers=0.0, lost=0.0, wear=(), jitter=0.0, fillets_follow=False, ends="none"
    )
    clean = clean.of_size(8000)
    # the scan's own axes are the true design frame's: only then has a direction in them a meaning whatever the gear's lie
    scan = make_scan(replace(clean, effects=(made,), pose="none"), 1)
    said = Effect(name, as_found(made, placement, OUTLINE, Rigid(np.eye(3), np.zeros(3)), found_frame.rotation))
    twin = make_scan(replace(clean, effects=(said,), pose=Rigid(found_frame.rotation.T, np.zeros(3))), 1)
    twin_points = twin.points @ found_frame.rotation.T
    gear = designed(PINION)
    grid = CellGrid.for_scan(gear, 8000)
    here, there = (
        bin_points(locate(points, gear), grid, clip=0.1).points.deviation
        for points in (found_frame.apply(scan.points), twin_points)
    )
    # cells hold other points of the lattice after the turn over; far below the 12 µm put in
    both = np.isfinite(here) & np.isfinite(there)
    assert both.sum() > 0.98 * np.isfinite(here).sum()
    assert np.sqrt(np.mean((here[both] - there[both]) ** 2)) < 0.06 * np.sqrt(np.mean(there[both] ** 2))


def test_the_placement_comes_from_the_poses():
    error = PoseError(0.0, 0.0, 0.0, np.zeros(3), 3, True)
    placement = Placement.of(error)
    assert placement.flank(1, 1, 12) == (2, -1)
    assert Placement(3, False).flank(10, 1, 12) == (1, 1)
    true = Rigid(np.eye(3), np.zeros(3))
    turned = pose_error(rotation_about(np.array([0.0, 0.0, 3 * OUTLINE.pitch_angle])), np.zeros(3), true, OUTLINE)
    assert Placement.of(turned) == Placement(3, False)


# what a scan can show


def test_visibility_is_that_of_a_mean_of_independent_cells():
    rng = np.random.default_rng(2)
    n, sigma = 400, 0.01
    field = rng.standard_normal(n) * 0.002
    pose = rng.standard_normal((n, 6))
    weight = np.full(n, sigma**-2)
    seen = visibility([field], 0, pose, weight, Cover(np.full(n, sigma**2), ()), Rule(0.01, 1, 0.0006))
    rest = field - pose @ np.linalg.lstsq(pose, field, rcond=None)[0]
    assert seen.snr == pytest.approx(np.linalg.norm(rest) / sigma)
    assert seen.contribution == pytest.approx(np.sqrt(np.mean(rest**2)))
    # an effect that another one or the pose makes as well is not to be seen
    assert not visibility([field, 2.0 * field], 0, pose, weight, Cover(np.full(n, sigma**2), ()), Rule(0.01, 1, 0.0)).detectable
    assert not visibility([pose[:, 2]], 0, pose, weight, Cover(np.full(n, sigma**2), ()), Rule(0.01, 1, 0.0)).detectable


def test_the_limit_is_where_the_power_is_95_per_cent():
    rule = Rule(1e-4, 1, 0.0)
    # one-parameter normal test: |x| > 3.8906, power 95 % at 3.8906 + 1.6449
    at = rule.judge(1.0, 5.5355)
    assert at.power == pytest.approx(0.95, abs=1e-4)
    assert at.limit == pytest.approx(1.0, abs=1e-4)
    assert rule.judge(1.0, 11.071).limit == pytest.approx(0.5, abs=1e-4)
    # the least contribution counts too, two standard errors above
    assert Rule(1e-4, 1, 0.5).judge(1.0, 40.0).limit == pytest.approx(0.55)


def test_the_true_covariance_is_that_of_cell_means_of_the_texture():
    texture = Texture(6.0, 1.5)
    recipe = replace(WORN, noise_um=0.0, texture=None, wear=(), outliers=0.0, lost=0.0, pose="none")
    gear, scan = designed(PINION), make_scan(recipe, 1)
    located = locate(scan.points, gear)
    grid = CellGrid.for_scan(gear, POINTS)
    cells = bin_points(located, grid)
    index, labels = grid.index(located), scan.truth.labels
    flank = (located.surface == FLANK) & (located.tooth == 0) & (located.side == 1)
    weights = np.where(
        (cells.points.surface == FLANK) & (cells.points.tooth == 0) & (cells.points.side == 1) & cells.seen, 1.0, 0.0
    )
    weights /= weights.sum()
    rng = np.random.default_rng(4)
    arc = (OUTLINE.tip_roll**2 - labels.roll[flank] ** 2) / (2.0 * OUTLINE.base_radius)
    means = []
    for _ in range(150):
        value = sample_texture(texture, 40.0, 15.0, arc, labels.z[flank], rng)
        total = np.bincount(index[flank], value, minlength=grid.count) / np.maximum(cells.count, 1.0)
        means.append(float(weights @ total))
    expected = math.sqrt(true_cover(cells, 0.0, texture).variance(weights))
    # standard deviation of 150 draws is known to 6 %
    assert np.std(means) == pytest.approx(expected, rel=0.2)


# the table


def test_rates_have_exact_intervals():
    # Clopper-Pearson: 0 of n has the upper bound 1 - 0.025^(1/n)
    assert Rate(0, 200).high == pytest.approx(1.0 - 0.025 ** (1.0 / 200.0))
    assert Rate(200, 200).low == pytest.approx(0.025 ** (1.0 / 200.0))
    assert Rate(5, 10).low == pytest.approx(1.0 - Rate(5, 10).high)
    assert math.isnan(Rate(0, 0).value)


def test_the_page_counts_what_the_scores_say(null):
    good = scored((Effect("coating", {"thickness_um": 20.0}),), seed=11)
    null = null | {"label": "n0"}
    wrong = good | {"label": "1", "found": [good["found"][0] | {"false": True}]}
    refused = {"label": "2", "refused": "does not fit"}
    numbers = summary([good | {"label": "0"}, wrong, refused, null])
    assert numbers["named"] == Rate(2, 2)
    assert numbers["false_known"] == Rate(1, 2)
    assert numbers["false_null"] == Rate(0, 1)
    assert numbers["refused"] == Rate(1, 4)
    page = markdown([good | {"label": "0"}, wrong, refused, null], "python -m benchmarks.study", "0")
    assert "| `coating` | 2 | 2 | 2 | 0 | 0 | 0 |" in page
    assert "| `coating` | 1 | 1 |" in page


def test_a_wave_that_no_effect_makes_does_not_hide_a_coat():
    """A coat of a seventh of the noise, under a wave of twice its size: the wave drowns it in every tooth left out."""
    recipe = Recipe(
        noise_um=5.0, jitter=1.0, pose="mild", ends="upper",
        effects=(Effect("coating", {"thickness_um": 0.73}), Effect("wave_growing", {"order": 3, "amplitude_um": 4.7, "phase_deg": 235.0})),
    ).of_size(2 * POINTS)  # fmt: skip
    one = study(Scenario("test", recipe, 43, mate=False))[0]
    assert [f["name"] for f in one["found"]] == ["coating"]
    assert any("3 waves round the gear" in pattern for pattern in one["patterns"])
