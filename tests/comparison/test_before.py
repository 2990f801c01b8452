"""Wear against a scan of the gear before it ran: nothing is left open of what was made and what was worn."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.comparison import before as before_wear
from gearwear.comparison.before import told_by_both, unworn_gear
from gearwear.comparison.closing import measure
from gearwear.comparison.stations import compare
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK
from gearwear.placing.pose import motion_columns
from tests.commands.doors import ALONE, scan_file
from tests.diagnose.plain import plain_effects
from tests.report.fake import fake_results
from tests.synthetic import AbrasiveWear, Effect, Recipe, SlidingWear

PITCH = Effect("pitch", {"index_um": tuple(8.0 * np.sin(np.arange(12) ** 2))})
NEW = Recipe(jitter=1.0, noise_um=5.0, effects=(PITCH,)).of_size(20_000)
COATED = replace(NEW, effects=(PITCH, Effect("coating", {"thickness_um": 15.0})))


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    return scan_file(tmp_path_factory.mktemp("scans"), "before", NEW, 3)[0]


@pytest.mark.long
@pytest.mark.parametrize(
    "wear",
    [(AbrasiveWear(12.0),), (SlidingWear(40.0, 1), AbrasiveWear(8.0, -1))],
    ids=["even on both sides", "sliding on one, even on the other"],
)
def test_an_even_loss_of_a_side_is_wear_and_no_thinner_tooth(tmp_path, before, wear):
    after, scan = scan_file(tmp_path, "after", replace(NEW, wear=wear), 4)
    results = compare(ALONE, after, before=before, inspection=False)
    assert results.measured.worn_sides == frozenset(Side)
    assert abs(results.wear.volume - scan.truth.volume_mm3) < 3.0 * results.wear.volume_std < 0.1 * scan.truth.volume_mm3
    assert results.volume_range is None
    assert not {"tooth_thickness", "profile_shift"} & {effect.name for effect in results.effects}
    assert not any("thinner teeth" in note for note in results.notes)


@pytest.mark.long
def test_scans_the_wrong_way_round_are_told(tmp_path, before):
    """All left flanks are worn, by the sliding."""
    worn, scan = scan_file(tmp_path, "worn", replace(NEW, wear=(SlidingWear(30.0, 1),)), 6)
    with plain_effects():
        told, other = (
            compare(ALONE, later, before=first, inspection=False).notes for later, first in ((before, worn), (worn, before))
        )
    (said,) = [note for note in told if "the wrong way round?" in note]
    assert "on 12 flanks" in said
    assert float(said.split("some ")[1].split(" mm³")[0]) == pytest.approx(scan.truth.volume_mm3, rel=0.15)
    assert not any("wrong way round" in note for note in other)


def test_a_coat_of_the_later_scan_is_no_loss_of_a_side(tmp_path, before):
    with plain_effects():
        after = measure(ALONE, scan_file(tmp_path, "after", COATED, 5)[0])
        measured, sides = told_by_both(after, unworn_gear(ALONE, after, before, "mm", loop=True)[0])
    assert sides == measured.worn_sides == frozenset()


@pytest.mark.parametrize(
    ("alone", "change", "sides"),
    [
        ({Side.LEFT}, -9.9, {Side.LEFT}),  # 2.8 standard deviations: not proven by the difference, but what the worn scan tells
        (set(), -9.9, set()),
        ({Side.LEFT}, -2.0, set()),  # what looked worn was made so
        (set(), -14.0, {Side.LEFT}),
    ],
)
def test_a_difference_that_proves_little_does_not_take_back_what_the_worn_scan_tells(monkeypatch, alone, change, sides):
    """The left flanks, 10 µm low in the worn scan, changed by so much, µm; the level of each scan is known to 2.5 µm."""

    def of(left):
        deviation = np.zeros((12, 2, 3, 4))
        deviation[:, Side.LEFT.index] = 1e-3 * left
        return SimpleNamespace(points=SimpleNamespace(deviation=deviation))

    grid = SimpleNamespace(flank_shape=lambda values: values)
    after = SimpleNamespace(
        noise=0.005, cells=SimpleNamespace(grid=grid), as_made=of(-10.0), level_std=(0.0025, 0.0025), worn_sides=frozenset(alone)
    )
    unworn = SimpleNamespace(noise=0.005, level_std=(0.0025, 0.0025))
    monkeypatch.setattr(before_wear, "what_changed", lambda *_: of(change))
    assert before_wear.sides_that_changed(after, unworn) == frozenset(sides)


def scans_of(lost, worn, noise=0.004):
    """Two scans of one gear of the bundled example's cells, as `what_changed` asks for them: the later moved, coated and larger, `lost` mm lower on its flanks;
    the cells."""
    cells = fake_results().measured.first
    on = cells.points
    rng = np.random.default_rng(5)
    made = 0.01 * rng.standard_normal(len(cells.count))  # of no shape: it cancels
    turned = motion_columns(on.position, on.normal) @ np.array([3e-3, -5e-3, 4e-3, 2e-5, -3e-5, 1e-4])
    measured = turned + 0.006 + 2e-4 * (on.position * on.normal).sum(axis=1)

    def seen(deviation):
        scatter = noise * rng.standard_normal(len(made)) / np.sqrt(np.maximum(cells.count, 1.0))
        corrected = cells.with_deviation(np.where(cells.seen, deviation + scatter, np.nan))
        return SimpleNamespace(
            corrected=corrected, cells=cells, noise=noise, worn_sides=frozenset(worn), as_made=corrected, loop=None
        )

    return seen(made + measured - lost(on)), seen(made), cells


@pytest.mark.parametrize(
    ("lost", "worn"),
    [
        (lambda on: 0.03 * ((on.surface == FLANK) & (on.side > 0)), {Side.LEFT}),
        (lambda on: 0.012 * (on.surface == FLANK), set()),  # of both sides, and neither is known to be worn
        (lambda on: 0.1 * ((on.surface == FLANK) & (on.tooth == 3) & (on.position[:, 2] > 9.0)), set()),
        (
            lambda on: 0.3 * ((on.surface == FLANK) & (on.side > 0) & (on.tooth < 4)),
            set(),
        ),  # a third of a side that is none worn throughout
        (lambda on: np.zeros(len(on)), set()),
    ],
    ids=["one side", "both sides evenly", "part of a tooth", "four flanks", "nothing"],
)
def test_of_a_difference_is_left_what_is_lost_and_not_how_it_was_placed_and_measured(lost, worn):
    """A motion, a coat and a scale are put in; what is taken out hangs on thousands of cells that scatter by 3 µm."""
    after, unworn, cells = scans_of(lost, worn)
    found = before_wear.what_changed(after, unworn).points.deviation
    flank = cells.seen & (cells.points.surface == FLANK)
    truth = -np.where(flank, np.nan_to_num(lost(cells.points)), 0.0)
    left = (found - truth)[flank]
    for side in Side:
        own = left[cells.points.side[flank] == side]
        assert abs(own.mean()) < 5e-4
    assert abs(left.std() - np.sqrt(np.mean(2.0 * 0.004**2 / cells.count[flank]))) < 5e-4


def test_without_tips_roots_and_bore_no_coat_is_taken_out():
    """On flanks alone one of 6 µm is thicker teeth."""
    after, unworn, cells = scans_of(lambda on: np.where(np.isin(on.surface, (FLANK, FILLET)), 0.0, np.nan), set())
    found = before_wear.what_changed(after, unworn).points.deviation
    flank = cells.seen & (cells.points.surface == FLANK)
    scale = 2e-4 * (cells.points.position * cells.points.normal).sum(axis=1)
    assert np.mean((found - scale)[flank]) == pytest.approx(0.006, abs=5e-4)
