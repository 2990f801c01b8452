"""The whole inspection on synthetic scans: what is said, what is left unsaid, and how sure it is."""

import json
import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.surface import FLANK, OTHER, SurfacePoints, flank_points
from gearwear.errors import InputError
from gearwear.inspection import Edition, Settings, inspect
from gearwear.inspection.grading import Verdict, grade
from gearwear.inspection.ranges import profile_range
from gearwear.inspection.tolerances import FOOTNOTE, SYMBOLS, Size, tolerances
from gearwear.inspection.traces import flank_samples
from gearwear.report.files.inspection_columns import finding_columns, flank_columns, tooth_columns
from gearwear.report.records.inspection import as_dict
from tests.inspection.synthetic import displaced, flanks

NOISE = 0.010


@pytest.fixture(scope="module")
def noisy(pinion):
    """A perfect gear with 10 µm of scan noise, 86,000 points."""
    points = flanks(pinion)
    return displaced(points, np.random.default_rng(0).normal(0.0, NOISE, len(points)), pinion)


@pytest.fixture(scope="module")
def found(noisy, pinion):
    return inspect(noisy, pinion)


def test_noise_of_the_scan_is_found(found):
    assert found.noise == pytest.approx(NOISE, rel=0.03)
    assert found.stray < 1e-3 * found.points
    assert found.coverage.min() > 0.95


@pytest.mark.long
def test_uncertainties_of_slopes_and_positions_are_calibrated(pinion):
    """Pulls over 24 flanks and 8 scans with other noise and other points."""
    truth = 0.006
    where = profile_range(pinion)
    pulls: dict[str, list[float]] = {"slope": [], "crowning": [], "helix": [], "thickness": [], "span": []}
    for seed in range(8):
        points = flanks(pinion, 60, 20, seed)
        shape = truth * (points.roll - where.middle) / where.length
        deviation = shape + np.random.default_rng(100 + seed).normal(0.0, NOISE, len(points))
        one = inspect(points.with_deviation(deviation), pinion)
        pulls["slope"] += list(((one.profile.slope.value - truth) / one.profile.slope.standard).ravel())
        pulls["crowning"] += list((one.profile.crowning.value / one.profile.crowning.standard).ravel())
        pulls["helix"] += list((one.helix.slope.value / one.helix.slope.standard).ravel())
        for name, part, roll, nominal in (
            ("thickness", one.dimensions.thickness, pinion.reference_roll, pinion.tooth_thickness),
            ("span", one.dimensions.span_lengths, one.dimensions.span.roll, one.dimensions.span.length),
        ):
            factor = 1.0 / math.cos(pinion.transverse_pressure_angle) if name == "thickness" else 1.0
            exact = nominal + 2.0 * factor * truth * (roll - where.middle) / where.length
            pulls[name] += list((part.value - exact) / part.standard)
    for name, values in pulls.items():
        pull = np.array(values)
        assert abs(pull.mean()) < 4.0 / math.sqrt(pull.size), name
        assert abs(pull.std() - 1.0) < 4.0 / math.sqrt(2.0 * pull.size) + 0.05, name  # 0.05: the noise is estimated too


def test_a_perfect_gear_is_not_graded_finer_than_its_scan_allows(found):
    for finding in found.findings:
        u, limit = finding.expanded, finding.grade.tolerance
        assert (finding.grade.verdict is Verdict.NOT_RESOLVABLE) == (u > 0.3 * limit)
        assert finding.value <= u + 3e-3  # nothing but noise
        if finding.grade.verdict is Verdict.NOT_RESOLVABLE and finding.grade.resolvable_class is not None:
            assert finding.statement == f"not resolvable; meets class {finding.grade.resolvable_class}"
    assert found.iso_class is None
    assert {f.quantity for f in found.findings} == set(SYMBOLS)


def test_grades_of_the_same_gear_when_a_coarse_class_is_asked(noisy, pinion):
    found = inspect(noisy, pinion, Settings(required_class=10))
    assert {f.grade.verdict for f in found.findings} == {Verdict.WITHIN}
    assert found.iso_class is not None


def test_verdicts(pinion):
    size = Size.of(pinion)
    limit = tolerances(size, 8).profile_slope  # 19 µm
    cases = [
        (0.9 * limit, 0.09 * limit, Verdict.WITHIN),
        (0.9 * limit, 0.11 * limit, Verdict.NEITHER),  # ISO 14253-1
        (-1.1 * limit, 0.11 * limit, Verdict.NEITHER),
        (1.1 * limit, 0.09 * limit, Verdict.EXCEEDS),
        (0.9 * limit, 0.31 * limit, Verdict.NOT_RESOLVABLE),
        (1.1 * limit, 0.31 * limit, Verdict.NOT_RESOLVABLE),
        (-1.5 * limit, 0.45 * limit, Verdict.EXCEEDS),  # beyond doubt all the same
        (math.nan, math.nan, Verdict.NOT_SEEN),
    ]
    for value, expanded, verdict in cases:
        assert grade("profile_slope", value, expanded, size, required=8).verdict is verdict
    far = 2.0 * tolerances(size, 11).profile_slope
    assert grade("profile_slope", far, 0.001, size).verdict is Verdict.COARSER
    assert grade("adjacent_pitch", 0.01, 0.001, size, Edition.ISO_1995).verdict is Verdict.NO_TOLERANCE


def test_correlated_errors_widen_everything_by_the_root_of_the_factor(noisy, found, pinion):
    wide = inspect(noisy, pinion, Settings(sample_factor=9.0))
    for name in ("profile", "helix"):
        one, three = getattr(found, name), getattr(wide, name)
        for part in ("slope", "form", "total", "crowning"):
            a, b = getattr(one, part), getattr(three, part)
            np.testing.assert_array_equal(a.value, b.value)
            # simulated errors meet another trace: the spread of its extremes is not exactly three times
            np.testing.assert_allclose(b.standard, 3.0 * a.standard, rtol=1e-9 if part in ("slope", "crowning") else 0.5)
    np.testing.assert_allclose(wide.dimensions.thickness.standard, 3.0 * found.dimensions.thickness.standard)


@pytest.mark.long
def test_a_scan_with_every_point_four_times_knows_no_more(noisy, found, pinion):
    fourfold = inspect(noisy.take(np.tile(np.arange(len(noisy)), 4)), pinion, Settings(noise=NOISE, sample_factor=4.0))
    once = inspect(noisy, pinion, Settings(noise=NOISE))
    np.testing.assert_allclose(fourfold.profile.filtered, once.profile.filtered, atol=1e-12)
    np.testing.assert_allclose(fourfold.profile.slope.standard, once.profile.slope.standard, rtol=1e-9)
    np.testing.assert_allclose(fourfold.pitch.cumulative.expanded, once.pitch.cumulative.expanded, rtol=1e-9)


def test_given_noise_is_used(noisy, found, pinion):
    doubled = inspect(noisy, pinion, Settings(noise=2.0 * NOISE))
    np.testing.assert_allclose(doubled.profile.slope.standard, 2.0 * found.profile.slope.standard, rtol=0.1)


def test_order_of_the_points_does_not_matter(noisy, found, pinion):
    shuffled = inspect(noisy.take(np.random.default_rng(3).permutation(len(noisy))), pinion)
    np.testing.assert_allclose(shuffled.profile.filtered, found.profile.filtered, atol=1e-12)
    np.testing.assert_allclose(shuffled.pitch.index.value, found.pitch.index.value, atol=1e-12)
    assert [f.grade for f in shuffled.findings] == [f.grade for f in found.findings]


def test_a_flank_hardly_seen_is_not_seen(noisy, pinion):
    flank = (noisy.tooth == 3) & (noisy.side == 1)
    found = inspect(noisy.take(~(flank & (noisy.position[:, 2] > 5.0))), pinion)
    assert found.coverage[3, 0] < 0.5
    for part in (found.profile.slope, found.profile.form, found.helix.slope, found.pitch.index):
        assert np.isnan(part.value[3, 0])
        assert np.isnan(part.value).sum() == 1
    assert np.isnan(found.dimensions.thickness.value[3])
    (missing,) = (note for note in found.notes if "Not seen" in note)
    assert "tooth 4 left" in missing and missing in found.foremost
    by = {(f.quantity, f.side): f for f in found.findings}
    assert by["cumulative_pitch", Side.LEFT].grade.verdict is Verdict.NOT_SEEN
    assert by["cumulative_pitch", Side.RIGHT].grade.verdict is not Verdict.NOT_SEEN
    assert by["runout", None].grade.verdict is Verdict.NOT_SEEN
    assert by["profile_slope", Side.LEFT].seen == 11


def test_seen_over_part_of_the_face_helix_is_not_judged_but_profile_is(noisy, pinion):
    found = inspect(noisy.take(noisy.position[:, 2] < 9.5), pinion)
    assert np.isnan(found.helix.slope.value).all()
    assert np.isfinite(found.profile.slope.value).all()
    assert any("helix evaluation range" in note for note in found.notes)


def test_a_planar_section_has_a_profile_and_pitch_but_no_helix(pinion):
    points = flanks(pinion, 200, 1)
    points.position[:, 2] = 7.5
    where = profile_range(pinion)
    found = inspect(displaced(points, 0.02 * (points.roll - where.middle) / where.length, pinion), pinion)
    np.testing.assert_allclose(found.profile.slope.value, 0.02, atol=1e-7)
    assert np.isfinite(found.dimensions.thickness.value).all()
    assert np.isnan(found.helix.slope.value).all()
    assert any("planar section" in note for note in found.notes) and found.foremost == ()
    assert not any("helix evaluation range" in note for note in found.notes)


def test_a_scan_thinner_than_the_filter_says_so_and_keeps_slopes(pinion):
    """Slices 0.6 mm apart under a cut-off of 0.45 mm, as a triangle export has them."""
    tooth, side, roll, z = (
        a.ravel()
        for a in np.meshgrid(np.arange(12), [1, -1], np.linspace(3.1, 26.3, 60), np.arange(0.0, 15.1, 0.6), indexing="ij")
    )
    points = flank_points(pinion, tooth, side, roll, z)
    noise = np.random.default_rng(7).normal(0.0, 0.004, len(points))
    found = inspect(points.with_deviation(0.01 * points.side * (points.position[:, 2] / 15.0 - 0.5) + noise), pinion)
    slope = found.helix.slope
    assert (np.abs(slope.value - 0.009) < 4.0 * slope.standard).all()  # 13.5 of 15 mm
    assert found.helix.cutoff == pytest.approx(1.2)
    assert any(
        "too thin for the standard's filter: in places the cut-off of the helix is 1.20 mm" in note for note in found.notes
    )
    assert any("too thin" in note for note in found.foremost)
    assert np.nanmax(found.helix.standard) < 4.0 * np.nanmin(found.helix.standard)


def test_a_part_of_the_range_that_was_not_seen_does_not_stand_first(noisy, pinion):
    """A tenth of the profile of one flank: its deviations are those of the rest, and no number is read wrongly."""
    roll = pinion.form_roll + 0.5 * (pinion.tip_roll - pinion.form_roll)
    gap = (noisy.tooth == 3) & (noisy.side == 1) & (np.abs(noisy.roll - roll) < 0.05 * (pinion.tip_roll - pinion.form_roll))
    found = inspect(noisy.take(~gap), pinion)
    (partly,) = (note for note in found.notes if note.startswith("Of the profile evaluation range"))
    assert partly not in found.foremost


def test_nothing_seen_at_all(noisy, pinion):
    found = inspect(noisy.take(np.zeros(len(noisy), bool)), pinion)
    assert {f.grade.verdict for f in found.findings} == {Verdict.NOT_SEEN}
    json.dumps(as_dict(found), allow_nan=False)


def test_stray_points_are_left_out_and_a_pit_is_not(noisy, pinion):
    rng = np.random.default_rng(9)
    stray = rng.choice(len(noisy), 80, replace=False)
    deviation = noisy.deviation.copy()
    deviation[stray] += rng.choice([-1.0, 1.0], 80) * rng.uniform(0.15, 2.0, 80)
    pit = (noisy.tooth == 2) & (noisy.side == -1) & (np.hypot(noisy.roll - 12.0, noisy.position[:, 2] - 7.0) < 1.5)
    pit[stray] = False
    deviation[pit] -= 0.3
    samples = flank_samples(noisy.with_deviation(deviation), pinion)
    assert 80 <= samples.stray < 80 + 0.001 * len(noisy)
    assert (samples.deviation < -0.2).sum() >= 0.95 * pit.sum()
    clean = flank_samples(noisy, pinion)
    assert samples.noise == pytest.approx(clean.noise, rel=0.02)


def test_other_surfaces_and_unknown_points_do_not_enter(noisy, found, pinion):
    extra = noisy.take(np.arange(500))
    other = SurfacePoints(
        np.full(500, OTHER, np.int8), extra.tooth, extra.side, extra.roll, extra.position, extra.normal, np.full(500, np.nan)
    )
    unknown = SurfacePoints(
        np.full(500, FLANK, np.int8), extra.tooth, extra.side, extra.roll, extra.position, extra.normal, np.full(500, np.nan)
    )
    both = SurfacePoints(
        *(
            np.concatenate([getattr(part, name) for part in (noisy, other, unknown)])
            for name in ("surface", "tooth", "side", "roll", "position", "normal", "deviation")
        )
    )
    again = inspect(both, pinion)
    np.testing.assert_array_equal(again.profile.filtered, found.profile.filtered)


def test_record_is_plain_and_has_units(found, pinion):
    record = json.loads(json.dumps(as_dict(found), allow_nan=False))
    assert record["standard"] == "ISO 1328-1:2013"
    assert record["footnote"] == FOOTNOTE
    assert FOOTNOTE not in record["notes"]
    assert len(record["profile"]["flanks"]) == 24
    assert [record["profile"]["flanks"][i]["tooth"] for i in (0, 1, 23)] == [1, 1, 12]
    first = record["helix"]["flanks"][3]
    assert (first["tooth"], first["flank"]) == (2, "right")
    assert first["slope_um"]["value"] == pytest.approx(1e3 * found.helix.slope.value[1, 1], abs=0.006)
    assert first["slope_um"]["expanded"] == pytest.approx(2e3 * found.helix.slope.standard[1, 1], abs=0.006)
    assert record["dimensions"]["span"]["nominal_mm"] == 29.186274
    assert record["dimensions"]["over_pins"]["nominal_mm"] == 91.17177
    assert record["dimensions"]["chordal"]["nominal_mm"] == 9.946096
    assert len(record["dimensions"]["over_pins"]["after_tooth"]) == 6


def test_columns_are_of_equal_length_and_hold_the_values(found, pinion):
    for columns, rows in ((finding_columns(found), 21), (flank_columns(found), 24), (tooth_columns(found), 12)):
        assert {len(column) for column in columns.values()} == {rows}
        assert {column.ndim for column in columns.values()} == {1}
    flanks_ = flank_columns(found)
    here = np.flatnonzero((flanks_["tooth"] == 4) & (flanks_["flank"] == "right"))
    assert flanks_["helix_slope_um"][here] == 1e3 * found.helix.slope.value[3, 1]
    assert flanks_["helix_slope_U_um"][here] == 1e3 * found.helix.slope.expanded[3, 1]
    teeth = tooth_columns(found)
    np.testing.assert_array_equal(teeth["over_pins_mm"][:6], found.dimensions.pin_lengths.value)
    assert np.isnan(teeth["over_pins_mm"][6:]).all()
    assert list(finding_columns(found)["symbol"][[0, -1]]) == ["f_Hα", "F_r"]


def test_worst_single_pitch_has_its_sign_and_tooth(pinion):
    points = flanks(pinion, 60, 12)
    back = np.where(points.tooth == 6, -0.03 * points.side, 0.0)  # tooth 7 lies clockwise of its place
    found = inspect(points.with_deviation(back), pinion, Settings(noise=0.001))
    for one in (f for f in found.findings if f.quantity == "single_pitch"):
        arc = 0.03 / math.cos(pinion.transverse_pressure_angle)
        assert one.tooth in (6, 7)
        assert one.value == pytest.approx(-arc if one.tooth == 6 else arc, abs=1e-6)


@pytest.mark.parametrize(("value", "expanded"), [(0.0042, 0.0019), (0.0001, 0.004), (0.010, 0.0045), (0.0131, 0.0055)])
def test_a_class_met_for_certain_holds_the_whole_interval(pinion, value, expanded):
    size = Size.of(pinion)
    mark = grade("profile_slope", value, expanded, size)
    limits = {c: tolerances(size, c).profile_slope for c in range(1, 12)}
    expected = [c for c, limit in limits.items() if value + expanded <= limit and expanded <= 0.3 * limit]
    assert mark.met_class == min(expected)


def test_a_gear_outside_the_standard_is_measured_without_a_class():
    gear = Gear.from_spec(GearSpec("gear", 20, 1.0, 3.0))  # b = 3 mm, the standard begins at 4
    found = inspect(flanks(gear, 60, 15), gear)
    assert {f.grade.verdict for f in found.findings} == {Verdict.NO_TOLERANCE}
    assert np.isfinite([f.value for f in found.findings]).all()
    assert any("face width 3 mm is outside" in note for note in found.notes)


def test_1995_takes_its_own_range(noisy, pinion):
    found = inspect(noisy, pinion, Settings(edition=Edition.ISO_1995))
    assert round(found.profile.range.length, 2) == 21.42
    assert as_dict(found)["standard"] == "ISO 1328-1:1995"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (Settings(required_class=14), "class 14 does not exist"),
        (Settings(span_teeth=6), "span over 6 teeth"),
        (Settings(pin_diameter=1.0), "pin of 1"),
        (Settings(profile_band=(19.0, 24.0)), "band of the profile traces from 19 to 24 mm of height: the face goes from"),
    ],
)
def test_refuses_settings_that_cannot_be_met(noisy, pinion, settings, words):
    with pytest.raises(InputError, match=words):
        inspect(noisy, pinion, settings)
