"""K bands: known traces in known bands, the verdict with its uncertainty, and the file they are read from."""

import math
from pathlib import Path

import numpy as np
import pytest

from gearwear.errors import InputError
from gearwear.inspection import KBand, KBands, Settings, class_k_bands, inspect, read_k_bands
from gearwear.inspection.evaluation import evaluate
from gearwear.inspection.k_band import BandVerdict
from gearwear.inspection.ranges import Range, profile_range
from gearwear.inspection.tolerances import tolerances
from gearwear.report.records.inspection import as_dict
from tests.inspection.synthetic import displaced, flanks, hand_traces

WHERE = Range(2.0, 22.0, 22.0, 0.8)
STATION = np.linspace(0.0, 24.0, 241)


def fit(deviation, band, error=1e-7):
    """One trace in one band."""
    traces = hand_traces(STATION, np.asarray(deviation)[None, None], np.array(error))
    return evaluate(traces, WHERE, bands=(band, band)).k


@pytest.mark.parametrize("offset", [0.0, 5.0, -0.3])
def test_a_line_in_a_straight_band_needs_its_own_rise(offset):
    """In closed form: a rise of f over the range leaves a band of width w by (f − w) / 2 on either side."""
    for rise in (0.004, 0.010, 0.014):
        found = fit(offset + rise * (STATION - 12.0) / 20.0, KBand.straight(WHERE, 0.010))
        assert found.excess.value[0, 0] == pytest.approx(0.5 * (rise - 0.010), abs=1e-9)
        assert found.shift[0, 0] == pytest.approx(offset, abs=1e-9)
        if rise != 0.010:
            assert found.verdict(0, 0) is (BandVerdict.OUTSIDE if rise > 0.010 else BandVerdict.INSIDE)


def test_relief_at_the_tip_is_allowed_where_the_band_opens():
    relief = np.where(STATION > 16.0, -0.002 * (STATION - 16.0), 0.0)  # 12 µm at the end
    open_band = KBand((2.0, 16.0, 22.0), (-0.003, -0.003, -0.015), (0.003, 0.003, 0.003))
    assert fit(relief, open_band).verdict(0, 0) is BandVerdict.INSIDE
    assert fit(relief, KBand.straight(WHERE, 0.006)).verdict(0, 0) is BandVerdict.OUTSIDE
    assert fit(-relief, open_band).verdict(0, 0) is BandVerdict.OUTSIDE  # + at the tip is not relief


def test_outside_its_corners_the_band_asks_nothing():
    hump = np.where(STATION > 20.5, 0.1 * (STATION - 20.5), 0.0)
    assert fit(hump, KBand((4.0, 20.0), (-0.001, -0.001), (0.001, 0.001))).verdict(0, 0) is BandVerdict.INSIDE


def test_the_total_deviation_is_what_a_straight_band_asks(pinion):
    """Two ways to one number: a straight band as wide as F_α is left exactly where F_α exceeds it."""
    points = flanks(pinion, 80, 12)
    wave = 0.01 * np.cos(0.7 * points.roll + points.tooth) * (points.roll < 24.0)  # none in the tip's last 5 %
    bands = class_k_bands(pinion, 8)
    found = inspect(displaced(points, wave, pinion), pinion, Settings(k_bands=bands, noise=1e-6))
    limit = tolerances(found.size, 8).profile_total
    np.testing.assert_allclose(found.profile.k.excess.value, 0.5 * (found.profile.total.value - limit), atol=2e-4)
    assert bands.profile[0].width == pytest.approx(limit)
    assert found.helix.k.count(0) == {BandVerdict.INSIDE: 12}


@pytest.mark.long
def test_noise_makes_it_unresolvable_and_never_wrong():
    band = KBand.straight(WHERE, 0.010)
    quiet = 0.004 * (STATION - 12.0) / 20.0
    assert fit(quiet, band, error=0.004).verdict(0, 0) is BandVerdict.NOT_RESOLVABLE
    rng = np.random.default_rng(3)
    noisy = quiet + 0.001 * rng.normal(size=(100, 2, len(STATION)))
    found = evaluate(hand_traces(STATION, noisy, np.array(0.001)), WHERE, bands=(band, band)).k
    truth = fit(quiet, band).excess.value[0, 0]
    covered = np.abs(found.excess.value - truth) <= found.excess.expanded
    assert covered.mean() >= 0.95 - 2.0 * math.sqrt(0.05 * 0.95 / covered.size)


def test_a_flank_hardly_seen_has_no_verdict_and_a_side_without_band_none():
    band = KBand.straight(WHERE, 0.010)
    traces = hand_traces(STATION, np.zeros((1, 2, len(STATION))), np.array(1e-4))
    traces.count[0, 0, STATION > 12.0] = 0
    found = evaluate(traces, WHERE, bands=(band, None)).k
    assert found.verdict(0, 0) is BandVerdict.NOT_SEEN
    assert found.verdict(0, 1) is None
    assert found.count(1) == {}


def write(folder: Path, text: str) -> Path:
    file = folder / "bands.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_a_file_with_places_in_any_way_of_a_drawing(tmp_path, pinion):
    limits = "lower_um = [-20, -8]\nupper_um = [0, 8]"
    roll = (5.0, 20.0)
    diameters = [2.0 * math.hypot(pinion.base_radius, v) for v in roll]
    angles = [math.degrees(v / pinion.base_radius) for v in roll]
    for name, values in (("roll_mm", roll), ("diameter_mm", diameters), ("roll_angle_deg", angles)):
        found = read_k_bands(write(tmp_path, f"[profile]\n{name} = {list(values)}\n{limits}"), pinion)
        left, right = found.profile
        assert left == right
        np.testing.assert_allclose(left.station, roll, atol=1e-9)
        np.testing.assert_allclose((left.lower, left.upper), [[-0.020, -0.008], [0.0, 0.008]])
        assert found.helix == (None, None)


def test_a_file_with_the_sides_apart(tmp_path, pinion):
    found = read_k_bands(write(tmp_path, "[helix.left]\nz_mm = [1, 14]\nlower_um = [-5, -5]\nupper_um = [5, 5]\n"), pinion)
    assert found.helix == (KBand((1.0, 14.0), (-0.005, -0.005), (0.005, 0.005)), None)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "nothing in it"),
        ("[flank]\n", r"\[flank\]: \[profile\], \[helix\] or both"),
        ("profile = 3", "profile must be a table"),
        ("[profile]\nz_mm = [1, 2]\n", r"\[profile\] z_mm: unknown; there are diameter_mm, roll_mm"),
        ("[profile]\nlower_um = [1]\nupper_um = [2]", "needs its places once, as diameter_mm or roll_mm or roll_angle_deg"),
        ("[helix]\nz_mm = [1, 2]\nlower_um = [1, 1]", "upper_um must be a list of numbers"),
        ("[helix]\nz_mm = [1, 2]\nlower_um = [1]\nupper_um = [2, 2]", "2 places, 1 lower and 2 upper limits"),
        ("[helix]\nz_mm = [2, 1]\nlower_um = [0, 0]\nupper_um = [2, 2]", "places must rise: 2 mm is followed by 1 mm"),
        ("[helix]\nz_mm = [1, 2]\nlower_um = [0, 3]\nupper_um = [2, 2]", "above the lower one: 2 and 3 µm at 2 mm"),
        ("[helix]\nz_mm = [1, 16]\nlower_um = [0, 0]\nupper_um = [2, 2]", "z_mm = 16 is not on the flank, which has 0 mm to 15 mm"),
        ("[profile]\ndiameter_mm = [70, 80]\nlower_um = [0, 0]\nupper_um = [2, 2]", "70 lies inside the base circle, 71.605 mm"),
        ("[profile]\ndiameter_mm = [75, 95]\nlower_um = [0, 0]\nupper_um = [2, 2]", "95 is not on the flank, which has .* to 88.900 mm"),
        ("[profile]\nroll_mm = [5, 9]\nleft = {}", r"\[profile\] roll_mm: with \[profile.left\]"),
        ("[profile\n", "is not TOML"),
    ],
)  # fmt: skip
def test_refuses_a_file_that_is_no_band(tmp_path, pinion, text, words):
    file = write(tmp_path, text)
    with pytest.raises(InputError, match=words) as caught:
        read_k_bands(file, pinion)
    assert str(caught.value).startswith(str(file))


def test_refuses_a_file_that_is_not_there(tmp_path, pinion):
    with pytest.raises(InputError, match="no such file"):
        read_k_bands(tmp_path / "none.toml", pinion)


def test_no_bands_no_verdicts(pinion):
    found = inspect(flanks(pinion, 40, 10), pinion)
    assert found.profile.k is None
    assert as_dict(found)["k_bands"] is None


def test_the_record_holds_band_and_verdicts(pinion):
    band = KBand.straight(profile_range(pinion), 0.010)
    points = flanks(pinion, 60, 12)
    tilt = np.where(points.tooth == 3, 0.02, 0.0) * (points.roll - 14.5) / 23.0
    found = inspect(points.with_deviation(tilt), pinion, Settings(k_bands=KBands(profile=(band, None), source="drawing 7")))
    record = as_dict(found)
    assert record["k_bands"] == "drawing 7"
    profile = record["profile"]
    assert profile["k_bands"]["left"]["upper_um"] == [5.0, 5.0]
    assert profile["k_bands"]["left"]["flanks"] == {"inside": 11, "outside": 1}
    assert "right" not in profile["k_bands"]
    rows = {(row["tooth"], row["flank"]): row.get("k_band") for row in profile["flanks"]}
    assert rows[4, "left"]["verdict"] == "outside"
    assert rows[5, "left"]["verdict"] == "inside"
    assert rows[4, "right"] is None
