"""Notes that change what the numbers mean come before those that say how they came about: a terminal shows the first few."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from types import SimpleNamespace

import numpy as np

import gearwear as gw
from gearwear.comparison.notes import off_the_drawing, or_worn, proud_notes, seam_note, take_each_other_back
from gearwear.comparison.placed_notes import beside_smoothing, was_smoothed
from gearwear.comparison.results import Results
from gearwear.comparison.stations import compare
from gearwear.design.side import Side
from gearwear.diagnose.effects.tip_diameter import EFFECT as TIP_DIAMETER
from gearwear.diagnose.parameter import ParameterEstimate
from gearwear.report.words.terminal import lines
from gearwear.report.words.verdict import doubts
from gearwear.wear.tooth_summary import DriftSeam
from tests.placing.test_smoothing import flanks, form, smoothed
from tests.report.fake import fake_effect, fake_results
from tests.synthetic import Recipe, make_scan

DESIGN = """[pinion]
teeth = 12
module = 6.35
face_width = 14.0

[datum]
axis = "ends"

[scanner]
noise_um = 900
"""
"""The scan is of a gear 15 mm wide, and scatters by 5 µm."""


@cache
def results() -> Results:
    folder = Path(mkdtemp())
    (folder / "design.toml").write_text(DESIGN)
    np.savetxt(folder / "scan.xyz", make_scan(Recipe(pose="mild", noise_um=5.0).of_size(20_000), 3).points, fmt="%.6f")
    return compare(gw.read_design(folder / "design.toml"), [folder / "scan.xyz"], loop=False, inspection=False)


def place(notes, words):
    return next(i for i, note in enumerate(notes) if words in note)


def test_what_changes_the_meaning_of_numbers_comes_first():
    for notes in (results().notes, doubts(results())):
        width, scatter, alone = (place(notes, words) for words in ("taken as seen", "the scanner by", "he design has one gear"))
        assert width == 0 and width < scatter < alone


def test_the_terminal_shows_it():
    shown = " ".join(line for line, _ in lines(results()))
    assert "face_width is 14 mm: taken as seen" in shown.replace("\u00a0", " ")


def test_a_dimension_beyond_its_tolerance_is_told():
    """A blank turned 0.42 mm too small where the drawing allows 0.19, as it is fitted; not one within that, nor one that is not known to lie beyond."""

    def told(value, std):
        size = ParameterEstimate(1e3 * value, 1e3 * std, "um")
        effect = SimpleNamespace(
            name="tip_diameter", candidate=SimpleNamespace(effect=TIP_DIAMETER), parameters={"diameter_um": size}
        )
        context = SimpleNamespace(gear=SimpleNamespace(tolerance=SimpleNamespace(tip_diameter=0.19)))
        return off_the_drawing(SimpleNamespace(form=(effect,), context=context))

    (note,) = told(-0.42, 0.001)
    assert note == "the tip diameter is 0.42 mm less than the drawing's, whose tolerance is ± 0.19 mm: taken as seen"
    assert "0.25 mm more" in told(0.25, 0.001)[0]
    assert told(0.18, 0.001) == told(0.25, 0.05) == off_the_drawing(None) == ()


def test_effects_that_take_each_other_back_are_told_as_no_finding():
    def effect(name, back):
        return SimpleNamespace(name=name, evidence=SimpleNamespace(taken_back=back))

    form = (effect("tip_relief", True), effect("root_form", False), effect("profile_slope", True))
    (note,) = take_each_other_back(SimpleNamespace(form=form))
    assert note.startswith("profile slope and tip relief fit best together, but of each the others take back most: no finding")
    assert take_each_other_back(SimpleNamespace(form=form[1:2])) == take_each_other_back(None) == ()


def test_flanks_alone_that_stand_proud_may_wear_a_coat():
    (note,) = proud_notes((0.032, 0.0), {"flank": 1.0, "tip": 0.9})
    assert note == (
        "the worn left flanks stand 32 µm proud of the design where they are highest: the teeth were cut thicker than drawn,"
        " and what is lost is counted from there"
    )
    (alone,) = proud_notes((0.0, 0.032), {"flank": 1.0, "fillet": 0.07})
    assert "the worn right flanks" in alone and "cut thicker than drawn or wear a coat, and" in alone
    assert proud_notes((0.0, 0.0), {}) == []


def test_a_tooth_that_may_be_told_wrong_for_where_the_scan_began_is_named():
    thin, thick = (seam_note(DriftSeam(7, by, 9.9, 10.0)) for by in (0.0711, -0.0711))
    assert thin.startswith("tooth 8 is told 71 µm thinner than it is if") and thin.endswith("it has lost less")
    assert thick.startswith("tooth 8 is told 71 µm thicker than it is if") and thick.endswith("it has lost more")


def test_other_sides_that_may_be_worn_are_one_sentence():
    left, both = frozenset({Side.LEFT}), frozenset(Side)
    assert or_worn((left, both)) == [
        "the left flanks or the flanks of both sides may be worn throughout, or all made so: the scan cannot tell"
    ]
    assert or_worn((frozenset(),)) == ["what the worn flanks have in common may be how they were made: the scan cannot tell"]
    assert or_worn(()) == []


def test_no_note_is_lost_or_said_twice():
    measured = results().measured
    assert set(measured.notes) <= set(results().notes)
    assert len(set(results().notes)) == len(results().notes)
    assert measured.notes == (*measured.doubts, *measured.remarks)


def test_a_scan_is_smoothed_where_its_points_share_their_errors_and_not_where_flanks_are_stepped():
    points, errors = flanks()
    stepped = points.with_deviation(0.006 * errors + form(points))
    assert not was_smoothed(stepped, 1)
    means = points.with_deviation(smoothed(points, 0.006 * errors, 6) + form(points))
    assert was_smoothed(means, 1) and not was_smoothed(means, 2)


def test_forms_of_a_smoothed_scan_may_be_its_rounded_edges_and_slopes_and_levels_may_not():
    """A mean over neighbours bends what ends, and leaves a plane as it is."""
    real = fake_results()
    cells, context, effects = real.measured.first, real.loop.context, []
    for name in ("tip_relief", "helix_crowning", "profile_slope", "helix_slope", "coating"):
        effect = fake_effect(name, {})
        shape = effect.candidate.effect.shapes(context)[0]
        each = effect.candidate.effect.basis(cells.points.take(cells.seen), context, shape).shape[1]
        effects.append(replace(effect, candidate=replace(effect.candidate, shape=shape), amplitudes=np.full(each, 0.01)))
    sharp = replace(real.loop, effects=tuple(effects), form=())
    loop = replace(sharp, context=replace(context, smoothed=True))
    doubted = beside_smoothing((loop,), cells)[0].effects
    assert [bool(effect.alternatives) for effect in doubted] == [True, True, False, False, False]
    assert set(doubted[0].alternatives) == {"edge_rounding"}
    assert beside_smoothing((sharp,), cells)[0] is sharp
