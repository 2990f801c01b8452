"""The paper reproduced: the reference's numbers row by row, and that nothing is typed in."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearwear.commands.paper import as_json, as_table, main
from gearwear.paper import as_markdown, chapters, rows
from gearwear.paper.explain import Cause, Inputs, changed, cut, explain, quantised, rounded
from gearwear.paper.inputs import PAPER
from gearwear.paper.points import point_pair, rounding_uncertainty, sum_of_uniforms

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "paper.md"
ROWS = {row.item: row for row in rows()}


def row(start):
    (found,) = (r for item, r in ROWS.items() if item.startswith(start))
    return found


# item, printed, recomputed by the reference (section A), half a unit of its last digit
REFERENCE = [
    ("pinion tip diameter", 89, 88.9, 1e-9),
    ("pinion base diameter", 71.60, 71.604578, 5e-7),
    ("gear base diameter", 143.2, 143.209155, 5e-7),
    ("pinion root diameter", 60.325, 60.325, 1e-9),
    ("gear root diameter", 136.525, 136.525, 1e-9),
    ("circular pitch", 19.949, 19.939, 5e-4),
    ("radius of point A", 38.1, 40.5177, 5e-5),
    ("radius of point B", 38.1, 40.8824, 5e-5),
    ("thickness loss B′, the chord", 1.992, 1.992486, 5e-7),
    ("recommended backlash", 0.2286, 0.2286, 1e-12),
    ("backlash B", 1.7634, 1.7634, 1e-12),
    ("centre distance change Δc, as the play", -2.422, -2.42245, 5e-6),
    ("centre distance after wear", 116.722, 116.72245, 5e-6),
    ("pressure angle after wear", 23.04, 23.0456, 5e-5),
    ("pinion pitch radius after wear", 38.90, 38.9073, 5e-5),
    ("gear pitch radius after wear", 77.81, 77.8147, 5e-5),
    ("contact length as designed", 28.51, 28.327550, 5e-7),
    ("contact length after wear", 21.92, 21.728108, 5e-7),
    ("slices analysed", 65, 65, 1e-9),
    ("points before wear", 453645, 393900, 1e-9),
    ("points after wear", 452742, 393900, 1e-9),
    ("points per tooth", 505, 504.05, 5e-3),
]


@pytest.mark.parametrize(("item", "printed", "recomputed", "digits"), REFERENCE)
def test_recomputed_as_in_the_reference(item, printed, recomputed, digits):
    found = row(item)

    assert found.printed == printed
    assert found.recomputed == pytest.approx(recomputed, abs=digits)
    assert found.residual == pytest.approx(recomputed - printed, abs=digits)


@pytest.mark.parametrize(
    ("item", "right", "digits"),
    [
        ("circular pitch", 19.9491, 5e-5),
        ("thickness loss B′, counter-clockwise", 2.0185, 5e-5),
        ("thickness loss B′, clockwise", 1.6493, 5e-5),
        ("backlash B", 2.2206, 1e-12),
        ("centre distance change Δc, as the play", 114.3 - 116.5231, 5e-5),
        ("centre distance change Δc, if it is to take the wear up", 2.683, 5e-4),
        ("centre distance after wear", 116.5231, 5e-5),
        ("backlash of unworn gears", 1.935, 5e-4),
        ("pressure angle after wear", 22.815, 5e-4),
        ("pinion pitch radius after wear", 38.841, 5e-4),
        ("gear pitch radius after wear", 77.682, 5e-4),
        ("contact length as designed", 23.516, 5e-4),
        ("contact length after wear", 22.239, 5e-4),
        ("face width", 15.0, 1e-9),
        ("slices analysed", 75.0, 1e-9),
    ],
)
def test_right_as_in_the_reference(item, right, digits):
    assert row(item).right == pytest.approx(right, abs=digits)


@pytest.mark.parametrize(
    ("item", "where", "value", "digits"),
    [
        ("thickness loss B′, the chord", "along the normal, counter-clockwise", 1.8967, 5e-5),
        ("thickness loss B′, the chord", "along the normal, clockwise", 1.5498, 5e-5),
        ("recommended backlash", "least by ISO/TR 10064-2, on the normal", 0.2051, 5e-5),
        ("recommended backlash", "classical range for assembly, from", 0.007 * 25.4, 1e-12),
        ("backlash B", "loss measured from a drawing", 1.7634, 1e-12),
        ("centre distance after wear", "B measured on the reference circles", 116.5638, 5e-5),
        ("centre distance after wear", "all the play", 117.110, 5e-4),
        ("centre distance after wear", "eq. 7 with the loss in t₁", 111.878, 5e-4),
        ("centre distance after wear", "shafts closed until", 111.617, 5e-4),
        ("centre distance after wear", "the same, until they have no backlash", 111.213, 5e-4),
        ("centre distance after wear", "tips bottom", 112.7125, 1e-9),
        ("centre distance after wear", "shafts in a housing", 114.3, 1e-12),
        ("centre distance change Δc, if it is to take the wear up", "first order", 2.4224, 6e-5),
        ("centre distance change Δc, if it is to take the wear up", "exact, down to no backlash", 3.087, 5e-4),
        ("backlash of unworn gears", "along the normal", 1.780441, 5e-7),
        ("pressure angle after wear", "B measured on the reference circles", 22.862, 5e-4),
        ("pressure angle after wear", "all the play", 23.49, 5e-3),
        ("pressure angle after wear", "eq. 7 with the loss in t₁", 16.25, 5e-3),
        ("pressure angle after wear", "shafts closed until", 15.79, 5e-3),
        ("pressure angle after wear", "the same, until they have no backlash", 15.03, 5e-3),
        ("pressure angle after wear", "shafts in a housing", 20.0, 1e-12),
        ("pinion pitch radius", "shafts in a housing", 38.1, 1e-12),
        ("gear pitch radius", "shafts in a housing", 76.2, 1e-12),
        ("contact length as designed", "rack tip radius 0.25", 23.286, 5e-4),
        ("contact length as designed", "rack tip radius 0.38", 23.893, 5e-4),
        ("contact length as designed", "never more", 26.344, 5e-4),
        ("contact length after wear", "at the printed c′", 21.728, 5e-4),
        ("reduction of the contact length", "rack tip radius 0.25", 6.7, 5e-2),
        ("reduction of the contact length", "rack tip radius 0.38", 9.1, 5e-2),
        ("reduction of the contact length", "the paper's formula without", 23.3, 5e-2),
    ],
)
def test_right_where_something_else_holds(item, where, value, digits):
    (case,) = (c for c in row(item).cases if c.where.startswith(where))

    assert case.value == pytest.approx(value, abs=digits)


@pytest.mark.long
@pytest.mark.parametrize(
    "words",
    [
        "| 0.1 | 20.1372 | 0.073098 | 0.068629 | 0.072794 | −0.4 % |",
        "| 0.5 | 20.6747 | 0.371508 | 0.347582 | 0.363970 | −2.0 % |",
        "| 1 | 21.3234 | 0.757847 | 0.705967 | 0.727940 | −3.9 % |",
        "| 2 | 22.5519 | 1.573719 | 1.453381 | 1.455881 | −7.5 % |",
        "| 2.4225 | 23.0461 | 1.935288 | 1.780832 | 1.763436 | −8.9 % |",
        "| 3 | 23.7004 | 2.445317 | 2.239078 | 2.183821 | −10.7 % |",
        "by 1.984 mm",
        "1.242 to 1.275",
        "in place of 1.511",
        "contact ratio 1.159 at the printed c′",
        "± 0.08 mm".replace(" ", " "),
        "0.2981 modules",
        "0.199 mm too far",
        "74.86 slices",
        "0.077 mm apart",
    ],
)
def test_the_page_says_what_the_reference_says(words):
    """Reference A2, A4 to A6: table and statements, to their digits."""
    assert words in as_markdown()


def test_the_cause_of_the_contact_lengths_found_step_by_step():
    design, worn = row("contact length as designed"), row("contact length after wear")

    assert design.residual == pytest.approx(28.327550 - 28.51, abs=5e-7)
    assert design.steps[0].residual == pytest.approx(28.512218 - 28.51, abs=5e-7)
    assert worn.residual == pytest.approx(21.728108 - 21.92, abs=5e-7)
    assert worn.steps[0].residual == pytest.approx(21.912776 - 21.92, abs=5e-7)
    assert worn.steps[1].residual == pytest.approx(21.923203 - 21.92, abs=5e-7)
    assert max(abs(design.steps[0].residual), abs(worn.steps[1].residual)) <= 0.0035


@pytest.mark.parametrize(
    ("item", "effect", "length"),
    [
        ("contact length as designed", "only the pinion's tip radius rounded", 28.412),
        ("contact length as designed", "base diameters 71.60 and 143.2", 28.339),
        ("contact length as designed", "base diameters 71.60 and 143.2, tip radii rounded", 28.523),
        ("contact length after wear", "only the pinion's tip radius rounded", 21.812),
        ("contact length after wear", "base diameters 71.60 and 143.2, tip radii rounded, θ′ 23.04°", 21.934),
        ("contact length after wear", "base diameters 71.60 and 143.2, θ′ 23.04°", 21.750),
        ("contact length after wear", "tip radii rounded, θ′ rounded to 23.05°", 21.904),
    ],
)
def test_alternatives_that_do_not_work(item, effect, length):
    found = row(item)
    (tried,) = (a for a in found.alternatives if a.effect == effect)

    assert found.printed + tried.residual == pytest.approx(length, abs=6e-4)
    assert abs(tried.residual) > 3.5 * abs(found.steps[-2].residual)


def test_every_residual_but_those_of_wrong_statements_is_explained():
    unexplained = {item for item, r in ROWS.items() if abs(r.left) > 1e-9}

    assert unexplained == {row(s).item for s in ("radius of point A", "radius of point B", "points before wear", "points after")}


def test_points_counted_in_whole_slices_miss_a_fifth_of_a_percent():
    before, after = row("points before wear"), row("points after wear")

    assert before.left / before.printed == pytest.approx(0.0019, abs=5e-5)
    assert after.left / after.printed == pytest.approx(0.0019, abs=5e-5)


def test_points_a_and_b():
    pair = point_pair(PAPER)
    base, r = PAPER.base_radii[0], 38.1

    assert math.degrees(pair.turn) == pytest.approx(209.4494 - 206.6915, abs=1e-4)
    assert pair.turn * pair.mean_radius == pytest.approx(1.959, abs=5e-4)
    assert pair.turn * r == pytest.approx(1.834, abs=5e-4)
    assert math.degrees(pair.involute_turn) == pytest.approx(0.27759, abs=5e-6)
    assert [pair.loss_angle(hand) * r for hand in (1, -1)] == pytest.approx([2.0185, 1.6493], abs=5e-5)
    assert [pair.loss_angle(hand) * base for hand in (1, -1)] == pytest.approx([1.8967, 1.5498], abs=5e-5)


def test_the_turn_is_found_between_two_real_involutes(pinion):
    """Points put on a flank and on the same flank turned; either hand, at the paper's radii."""
    for hand in (1, -1):
        radii = np.array([40.5177, 40.8824])
        psi = pinion.half_angle(radii)
        turn = 0.05
        angle_a = math.pi + 0.4 + hand * psi[0]
        angle_b = math.pi + 0.4 + hand * psi[1] + turn
        points = [tuple(r * np.array([math.cos(a), math.sin(a)])) for r, a in zip(radii, (angle_a, angle_b), strict=True)]
        inputs = replace(PAPER, point_a=points[0], point_b=points[1])

        assert point_pair(inputs).loss_angle(hand) == pytest.approx(turn, abs=1e-12)


def test_uncertainty_of_the_chord_from_the_rounding():
    found = row("thickness loss B′, the chord").uncertainty

    assert found.std == pytest.approx(0.041, abs=5e-4)
    assert (found.low, found.high) == (pytest.approx(1.915, abs=5e-4), pytest.approx(2.071, abs=5e-4))


@pytest.mark.parametrize("what", ["chord", "clockwise", "counter-clockwise"])
def test_uncertainty_agrees_with_drawn_coordinates(what):
    rng = np.random.default_rng(1)
    a, b = (np.array(p) + rng.uniform(-0.05, 0.05, (400_000, 2)) for p in (PAPER.point_a, PAPER.point_b))
    if what == "chord":
        drawn, value = np.hypot(*(b - a).T), lambda p: point_pair(p).chord
    else:  # another way to the loss: polar angles and the involute's own, written out
        hand = -1 if what == "clockwise" else 1
        ra, rb = np.hypot(*a.T), np.hypot(*b.T)
        alpha_a, alpha_b = (np.arccos(PAPER.base_radii[0] / r) for r in (ra, rb))
        turn = np.arctan2(b[:, 1], b[:, 0]) - np.arctan2(a[:, 1], a[:, 0])
        drawn = 38.1 * (turn + hand * ((np.tan(alpha_b) - alpha_b) - (np.tan(alpha_a) - alpha_a)))
        value = lambda p: 38.1 * point_pair(p).loss_angle(hand)  # noqa: E731
    found = rounding_uncertainty(PAPER, value)

    # Density at the ends ≥ 1.2 / mm: a quantile of 400,000 draws has a standard deviation of 2e-4.
    assert np.quantile(drawn, [0.025, 0.975]) == pytest.approx([found.low, found.high], abs=8e-4)
    assert drawn.std() == pytest.approx(found.std, rel=0.01)


def test_metal_can_only_go(pinion):
    """B counter-clockwise of A: on a clockwise flank A is outside the worn tooth, on a counter-clockwise one B is."""
    pair = point_pair(PAPER)
    angle_a, angle_b = (math.atan2(y, x) for x, y in (PAPER.point_a, PAPER.point_b))
    for hand, (new, old) in ((-1, (angle_a, angle_b)), (1, (angle_b, angle_a))):
        new_radius, old_radius = (pair.radius_a, pair.radius_b) if hand < 0 else (pair.radius_b, pair.radius_a)
        centre = new - hand * float(pinion.half_angle(new_radius))
        left = float(pinion.half_angle(old_radius)) - hand * (old - centre)

        assert left == pytest.approx(pair.loss_angle(hand), abs=1e-12)
        assert left > 0.0


def test_law_of_a_sum_of_even_errors():
    assert sum_of_uniforms(0.0, [0.3, 0.1, 0.2]) == pytest.approx(0.5, abs=1e-12)
    assert sum_of_uniforms(0.6, [0.3, 0.1, 0.2]) == pytest.approx(1.0, abs=1e-12)
    assert sum_of_uniforms(-1.0, [1.0, 1.0]) == pytest.approx(1 / 8, abs=1e-12)  # a triangle of half width 2


def test_steps_run_the_formula_again():
    """Change what the formula starts from, and the step's residual follows."""
    found = explain(
        "test",
        "mm",
        "1.20",
        lambda p: p.module * p.slices,
        [changed("a", module=0.5), changed("b", slices=3), cut(1)],
        [Cause("alone", change=lambda p: replace(p, slices=0))],
        right=None,
        why="",
    )

    assert found.recomputed == Inputs().module * 65
    assert [s.residual for s in found.steps] == pytest.approx([0.5 * 65 - 1.2, 0.5 * 3 - 1.2, 1.5 - 1.2], abs=1e-12)
    assert found.alternatives[0].residual == pytest.approx(-1.2, abs=1e-12)
    assert (found.as_printed, found.printed) == ("1.20", 1.2)


def test_writing_works_on_decimals_and_towards_zero():
    assert [cut(2).write(v) for v in (38.9073, -2.429, 0.29)] == [38.90, -2.42, 0.29]
    assert [rounded(1).write(v) for v in (44.45, 82.55, 82.5499)] == [44.5, 82.6, 82.5]
    assert quantised(1e-12, 3, "ROUND_DOWN") == 0.0


def test_json_has_the_contracts_keys(capsys):
    assert main(["--json"]) == 0
    listed = json.loads(capsys.readouterr().out)

    assert len(listed) == len(ROWS) >= 18
    for entry in listed:
        assert {"item", "printed", "recomputed", "residual", "steps", "right", "why"} <= entry.keys()
        assert isinstance(entry["printed"], float)
        assert entry["residual"] == entry["recomputed"] - entry["printed"]
        assert entry["right"] is None or isinstance(entry["right"], float)
        assert entry["right"] is not None or len(entry["why"]) > 20
        assert all(step.keys() == {"effect", "residual"} for step in entry["steps"])
        assert entry["why"].endswith(".")
    assert json.loads(as_json()) == listed


@pytest.mark.parametrize("width", [100, 120])
def test_table_fits_and_shows_before_and_after(width):
    lines = as_table(width).splitlines()

    assert max(len(line) for line in lines) <= width
    assert not any("\x1b" in line for line in lines)
    start = next(i for i, line in enumerate(lines) if "contact length after wear l′" in line)
    assert [word in lines[start] for word in ("21.92", "21.7281", "-0.1919", "22.2387")] == [True] * 4
    assert "tip radii rounded up to 44.5 and 82.6" in lines[start + 1]
    assert lines[start + 1].endswith("-0.0072")
    assert lines[start + 2].endswith("+0.0032")


def test_table_is_what_the_command_prints(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")
    assert main([]) == 0
    assert capsys.readouterr().out == as_table(120)


def test_the_committed_page_is_the_current_one(capsys):
    assert main(["--markdown"]) == 0
    assert capsys.readouterr().out == as_markdown() == PAGE.read_text(encoding="utf-8")


def test_every_row_stands_in_table_and_page():
    assert [r for chapter in chapters().values() for r in chapter] == list(rows())
    page = as_markdown()
    for r in rows():
        assert f"printed {r.as_printed}" in page
        assert r.why in page


@pytest.mark.parametrize("argv", [["--xml"], ["--json", "--markdown"], ["table"]])
def test_wrong_arguments_are_one_line_and_status_2(argv, capsys):
    assert main(argv) == 2
    captured = capsys.readouterr()

    assert captured.out == ""
    assert captured.err.startswith("gearwear: ")
    assert captured.err.count("\n") == 1


def test_the_module_runs():
    done = subprocess.run(
        [sys.executable, "-m", "gearwear.paper", "--json"], capture_output=True, text=True, encoding="utf-8", cwd=ROOT
    )

    assert done.returncode == 0
    assert json.loads(done.stdout)[0]["item"] == "pinion tip diameter"


def test_nothing_heavy_is_imported():
    code = "import sys, gearwear.paper; print(sorted({'rich', 'matplotlib', 'scipy', 'OCP', 'trimesh'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)

    assert done.stdout.strip() == "[]"
