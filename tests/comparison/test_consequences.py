"""What the effects change, held to what is known of them: a coat, a gear off its axis, nothing at all."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearwear.comparison.consequences import Change, unshared_std
from gearwear.comparison.contributions import put_back, side_fields, side_points
from gearwear.comparison.notes import scanner_notes
from gearwear.comparison.results import Results
from gearwear.comparison.stations import compare
from gearwear.design import parse_design, read_design
from gearwear.design.scan_spec import ScannerSpec
from gearwear.design.surface import locate
from gearwear.report.records.comparison import document
from gearwear.wear.tooth_summary import ThinnestTooth
from tests.commands.doors import ALONE, PAIR, scan_file
from tests.synthetic import PINION, Effect, Hole, Patch, Recipe

pytestmark = pytest.mark.long

COSINE = math.cos(math.radians(20.0))
COAT_UM = 25.0
COAT = Effect("coating", {"thickness_um": COAT_UM})
PATCH = Patch(1, 1, 400.0, (36.6, 43.4), (1.0, 12.0))
THIN = Recipe(jitter=1.0, wear=(PATCH,)).of_size(20_000)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scans")


@pytest.fixture(scope="module")
def coated(folder) -> Results:
    hole = Hole(5, 1, 40.0, 7.5, 2.0)
    return compare(
        read_design(PAIR), scan_file(folder, "coated", replace(THIN, effects=(COAT,), holes=(hole,)))[0], inspection=False
    )


@pytest.fixture(scope="module")
def plain(folder) -> Results:
    return compare(ALONE, scan_file(folder, "plain", THIN)[0], inspection=False)


def by_name(results: Results) -> dict[str, Change]:
    return {change.name: change for change in results.changes}


def holds(change: Change, difference: float) -> bool:
    """Whether the truth lies within three standard deviations."""
    return abs(change.difference - difference) < 3.0 * change.std


class TestCoat:
    def test_teeth_are_thinner_by_what_it_added_to_both_flanks(self, coated):
        changes = by_name(coated)
        for name in ("tooth_thickness_mean_mm", "tooth_thickness_least_mm"):
            assert holds(changes[name], -2e-3 * COAT_UM / COSINE) or name.endswith("least_mm")
            assert changes[name].causes[0][0] == "coating"
            assert changes[name].as_made == pytest.approx(coated.gear.tooth_thickness, abs=1e-9)
        # The thinnest section is found anew under the scatter: 10 µm a point, about 12 points a side.
        assert changes["tooth_thickness_least_mm"].difference == pytest.approx(-2e-3 * COAT_UM / COSINE, abs=0.006)

    def test_backlash_comes_back(self, coated):
        changes = by_name(coated)
        for name in ("backlash_mean_mm", "backlash_greatest_mm"):
            assert holds(changes[name], 2e-3 * COAT_UM / COSINE)
            assert [cause for cause, _ in changes[name].causes] == ["coating"]
            assert changes[name].before < 0.0, "coated teeth of a pair without play jam"
            assert changes[name].as_made == pytest.approx(0.0, abs=1e-9)

    def test_the_transmission_error_is_none_of_it(self, coated):
        change = by_name(coated)["transmission_error_um"]
        assert not change.matters and change.causes == ()
        assert abs(change.difference) < 0.02 * COAT_UM

    def test_it_hid_wear(self, coated):
        """A third of it; what is told with the coat left in has the levels of its flanks in its ±, and holds the truth."""
        changes = by_name(coated)
        volume, deepest = changes["worn_volume_mm3"], changes["deepest_wear_um"]
        assert 0.0 < volume.before < 0.75 * volume.after and volume.after == coated.wear.volume
        assert volume.difference < 2.0 * volume.std
        assert deepest.after == pytest.approx(PATCH.depth_um, abs=3.0 * deepest.std)
        assert deepest.matters and [name for name, _ in deepest.causes] == ["coating"]

    def test_what_comes_after_is_what_the_report_says_elsewhere(self, coated):
        report = document(coated, [])
        changes = report["closed_loop"]["changes"]
        assert list(changes) == list(by_name(coated))
        worn = report["meshing"]["worn"]
        assert changes["transmission_error_um"]["after"] == pytest.approx(worn["transmission_error_um"], abs=1e-9)
        assert changes["backlash_greatest_mm"]["after"] == pytest.approx(worn["backlash"]["circumferential_mm"], abs=1e-12)
        assert changes["worn_volume_mm3"]["after"] == report["wear"]["volume_mm3"]["value"]
        assert changes["worn_volume_mm3"]["before"] == report["wear"]["before_loop"]["volume_mm3"]["value"]
        assert changes["tooth_thickness_least_mm"]["after"] == report["thinnest"]["value_mm"]
        assert changes["deepest_wear_um"]["after"] == max(row["max_depth_um"] for row in report["wear"]["regions"])

    def test_before_is_what_no_loop_gives(self, coated, folder):
        """The raw scan's own answer, from a run of its own."""
        raw = compare(ALONE, [folder / "coated_0.ply"], loop=False, inspection=False)
        changes = by_name(coated)
        assert changes["worn_volume_mm3"].before == raw.wear.volume
        assert changes["tooth_thickness_mean_mm"].before == pytest.approx(float(np.nanmean(raw.wear.thickness.arc)), abs=1e-12)
        assert raw.changes == ()


def test_an_unworn_coated_gear_has_lost_nothing_before_or_after(folder):
    files, _ = scan_file(folder, "unworn", replace(THIN, wear=(), effects=(COAT,)))
    changes = by_name(compare(ALONE, files, inspection=False))
    volume = changes["worn_volume_mm3"]
    assert (volume.before, volume.after, volume.matters) == (0.0, 0.0, False)
    assert holds(changes["tooth_thickness_mean_mm"], -2e-3 * COAT_UM / COSINE)


def test_a_gear_off_the_axis_of_its_bore_runs_out_by_twice_that(folder):
    """A translation e moves every flank by e (n · e), and n is the line of action where they touch: TE = e cos(rotation + …)."""
    off = Effect("eccentricity", {"amplitude_um": 60.0, "direction_deg": 40.0})
    files, _ = scan_file(folder, "off", replace(THIN, gear=replace(PINION, bore_diameter=30.0), effects=(off,)))
    gear = {"teeth": 12, "module": 6.35, "face_width": 15.0, "rack_tip_radius": 0.3}
    design = parse_design({"pinion": {**gear, "bore_diameter": 30.0}, "gear": {**gear, "teeth": 24}})
    changes = by_name(compare(design, files, "pinion", inspection=False))
    error = changes["transmission_error_um"]
    assert holds(error, -2.0 * 60.0) and error.after < 0.1
    assert [name for name, _ in error.causes] == ["eccentricity"]
    assert not changes["tooth_thickness_mean_mm"].matters and not changes["worn_volume_mm3"].matters


def test_a_least_thickness_that_has_gone_elsewhere_is_not_known_better_than_either():
    """A table off by 0.01° moved no arc by more than 1 µm, and the least went from one tooth to another: −13.6 ± 0.9 µm was told."""
    here = ThinnestTooth(1, 5.482, 0.012, 5.46, 5.51, 15.2, 5.6)
    for there, std in (
        (replace(here, value=5.490), 0.0),
        (replace(here, at_z=15.5), 0.0),
        (replace(here, at_z=4.0, std=0.005), 0.013),
        (replace(here, tooth=9, std=0.009), 0.015),
        (None, 0.0),
    ):
        assert unshared_std(here, there, 0.4) == pytest.approx(std, rel=1e-12)
        assert unshared_std(there, here, 0.4) == pytest.approx(std, rel=1e-12)


def test_where_nothing_is_taken_out_nothing_changes(plain):
    assert plain.loop.effects == () and plain.changes == ()
    assert document(plain, [])["closed_loop"]["changes"] == {}


THINNER = replace(THIN, effects=(Effect("tooth_thickness", {"thickness_um": -60.0}),), holes=(Hole(5, 1, 40.0, 7.5, 2.0),))


@pytest.fixture(scope="module")
def thinner(folder) -> Results:
    return compare(read_design(PAIR), scan_file(folder, "thin", THINNER)[0], inspection=False)


def test_a_manufacture_effect_is_of_the_gear_and_changes_the_wear_only(thinner):
    """Thinner teeth: as made, not worn; thickness and backlash keep them."""
    changes = by_name(thinner)
    for name in ("tooth_thickness_mean_mm", "backlash_mean_mm", "transmission_error_um"):
        assert not changes[name].matters, name
    arc = changes["tooth_thickness_mean_mm"].as_made
    assert arc == pytest.approx(thinner.gear.tooth_thickness - 0.060, abs=0.001)
    assert changes["backlash_mean_mm"].as_made == pytest.approx(0.060, abs=0.001)
    assert changes["worn_volume_mm3"].matters


def test_an_effect_lies_on_every_cell_seen_or_not(thinner):
    """δ = ½ s cos α on both flanks, in a hole of the scan too: else the gear in mesh would have a boss there."""
    measured = thinner.measured
    grid, (effect,) = measured.cells.grid, put_back(measured)
    assert not grid.flank_shape(measured.cells.seen)[5, 0].all(), "there is a hole"
    size = 1e-3 * effect.effect.parameters["thickness_um"].value
    fields = side_fields(measured, [effect])
    np.testing.assert_allclose(fields.made[..., grid.fillet :], 0.5 * size * COSINE, rtol=1e-9)
    assert fields.taken == {}


def test_a_wave_that_registration_takes_up_is_not_counted_twice(folder):
    """A turntable off once a revolution looks like a gear off its axis: what each effect changes alone adds up to the difference."""
    table = Effect("turntable_angle", {"order": 1, "amplitude_deg": 0.05, "phase_deg": 40.0})
    files, _ = scan_file(folder, "table", replace(THIN, effects=(table,)))
    changes = by_name(compare(read_design(PAIR), files, inspection=False))
    for name in ("transmission_error_um", "backlash_greatest_mm"):
        ((cause, alone),) = changes[name].causes
        assert cause == "turntable_angle" and alone == pytest.approx(changes[name].difference, rel=0.1), name


@pytest.mark.parametrize(
    ("stated_um", "said"),
    [(10.0, None), (30.0, "smoothed"), (3.0, "glare"), (19.9, None), (20.1, "smoothed"), (5.1, None), (4.9, "glare")],
)
def test_the_noise_stated_of_the_scanner_is_held_against_the_scans(stated_um, said):
    """10 µm were found: a factor of two either way is let pass."""
    notes = scanner_notes(ScannerSpec(noise=1e-3 * stated_um), 0.010)
    assert (notes == ()) if said is None else (len(notes) == 1 and "as stated" in notes[0] and said in notes[0])


def test_what_is_stated_of_the_scanner_changes_no_number(folder, plain):
    data = {"pinion": tomllib.loads(PAIR.read_text())["pinion"], "scanner": {"noise_um": 30.0, "axis_offset_mm": 1.5}}
    results = compare(parse_design(data), [folder / "plain_0.ply"], inspection=False)
    assert document(results, [])["closed_loop"]["noise_stated_um"] == pytest.approx(30.0)
    assert [note for note in results.notes if "axis_offset_mm = 1.5 is not used" in note]
    assert len([note for note in results.notes if "as stated" in note]) == 1  # the scan has 10 µm
    assert results.wear.volume == plain.wear.volume
    assert "noise_stated_um" not in document(plain, [])["closed_loop"]


def test_the_points_of_the_cells_lie_on_the_gear(plain):
    grid = plain.measured.cells.grid
    points = side_points(grid)
    found = locate(points.position, grid.gear)
    np.testing.assert_allclose(found.deviation, 0.0, atol=1e-9)
    for name in ("surface", "tooth", "side"):
        np.testing.assert_array_equal(getattr(found, name), getattr(points, name))
    np.testing.assert_allclose(found.normal, points.normal, atol=1e-9)
    on_sheet = points.tooth.reshape(grid.gear.teeth, 2, grid.rows, -1)
    assert (on_sheet == np.arange(grid.gear.teeth)[:, None, None, None]).all()
