"""The terminal: it fits the screen, and it is plain where nobody sees colours."""

from __future__ import annotations

import io
import math
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from gearwear.commands import progress
from gearwear.comparison.notes import worn_notes
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.diagnose.pattern import Pattern
from gearwear.report.words.clauses import to_a_clause
from gearwear.report.words.terminal import ASCII, lines, print_summary, written
from gearwear.report.words.verdict import doubts, key_figures, loop_words, subject, verdict
from gearwear.wear.breakage import Broken
from tests.report.fake import bare_results, changed, fake_results, real_results

ROOT = Path(__file__).resolve().parents[2]


FILES = ("report.json", "report.html", "worn_volume.stl", "worn_volume.3mf", "worn_gear.stl")


def crowded():
    """Everything there can be too much of."""
    results = fake_results()
    scan = results.measured.scans[0]
    scans = tuple(replace(scan, files=(f"a/very/long/path/of/view/number/{'x' * 90}{i}.ply",)) for i in range(9))
    pattern = Pattern(5, "waves " * 60, 0.0, 0.0, 0.003, 0.009, 1e-9, np.zeros(1))
    loop = replace(results.loop, effects=4 * results.loop.effects, patterns=(pattern,))
    measured = replace(results.measured, scans=scans, loop=loop)
    notes = tuple(f"warning {i}: {'words ' * 40}" for i in range(12))
    return changed(replace(results, measured=measured, notes=notes), "measured.placed.registration.converged", False)


MADE = {"usual": fake_results, "bare": bare_results, "crowded": crowded}


@pytest.mark.parametrize("made", MADE)
@pytest.mark.parametrize("width", [80, 100, 200])
def test_the_summary_fits_the_screen(made, width):
    out = io.StringIO()
    files = [f"file_number_{i}.stl" for i in range(60)] if made == "crowded" else FILES
    print_summary(MADE[made](), files, "gearwear-out", Console(file=out, width=width, highlight=False))
    shown = out.getvalue().splitlines()
    assert len(shown) <= 23, "a prompt must fit below, on 24 lines"
    assert max(map(len, shown)) <= min(width, 100)


def test_the_summary_has_the_verdict_the_figures_and_the_folder():
    out = io.StringIO()
    print_summary(fake_results(), FILES, "out", Console(file=out, width=80, highlight=False))
    text = out.getvalue().replace("\u00a0", " ")
    for part in (
        "90.80 ± 0.51 mm³",
        "Thinnest tooth",
        "8.39",
        "a coat 20.10 ± 0.20 µm",
        "interference point",
        "Written to out",
    ):
        assert part in text


def test_the_only_worn_flank_is_named_beside_the_lost_volume():
    """It read "from the right flank of tooth…"."""
    results = changed(fake_results(), "wear.found.regions", fake_results().wear.regions[:1])
    (line,) = (line for line, _ in lines(results, 80) if line.startswith("  Metal lost"))
    assert line.replace("\u202f", " ").replace("\u00a0", " ").rstrip().endswith("tooth 2, left flank")


@pytest.mark.parametrize("width", [80, 100])
def test_what_was_found_besides_wear_ends_with_its_sentence(width):
    """An effect cut off in its size, or before what it cannot be told from, tells less than the number of those left out."""
    said = " ".join(line for line, _ in lines(crowded(), width))
    found = said[said.index("Unexplained") : said.index("If left in")].strip().replace("\u00a0", " ")
    assert found.endswith(".") and "…" not in found
    assert "besides wear: a coat 20.10 ± 0.20 µm" in found.lower()


def test_of_a_gear_without_wear_nothing_is_besides_wear():
    unworn = changed(changed(fake_results(), "wear.found.regions", ()), "wear.found.volume", 0.0)
    said = " ".join(line for line, _ in lines(unworn, 80)).replace("\u00a0", " ")
    assert "The scan shows: a coat 20.10 ± 0.20 µm" in said
    none = " ".join(line for line, _ in lines(changed(unworn, "measured.loop.effects", ()), 80))
    assert "No effect stands out." in none
    for text in (said, none, loop_words(unworn)):
        assert "besides wear" not in text.lower()


def test_effects_that_have_no_room_for_their_numbers_are_named_all_the_same():
    """Who reads "and 1 more" does not know whether it bears on the wear."""
    effects = fake_results().loop.effects
    results = changed(
        fake_results(), "measured.loop.effects", (*effects[:2], replace(effects[2], alternatives=("wobble", "taper") * 4))
    )
    said = " ".join(line for line, _ in lines(results, 80)).replace("\u00a0", " ")
    assert effects[2].name.replace("_", " ") in said
    assert "more." not in said


def test_limits_of_the_volume_hold_its_own_95_percent():
    """Whether flanks are worn throughout is open: 2 ± 0.1 mm³ is the other answer, and this one's 90.8 ± 0.51 mm³ ends at 91.8."""
    results = changed(fake_results(), "wear.undecided", ((2.0, 0.1),))
    assert results.wear.volume == pytest.approx(90.8, abs=0.01)
    assert results.volume_range[1] == pytest.approx(
        results.wear.volume + 1.96 * results.wear.volume_std, rel=1e-4
    )  # as the words have it
    # So wide a range comes first: 90.8 ± 0.51 mm³ would be read as how well it is known.
    said = verdict(results).replace("\u202f", " ").replace("\u00a0", " ")
    # What may be worn besides is none of the flanks that stand out.
    assert (
        said.startswith("1.8 to 92 mm³ of metal is gone; what stands out are ")
        and "on flanks that stand out it is 90.80 ± 0.51 mm³" in said
    )
    assert key_figures(results)[0].value.replace("\u202f", " ") == "1.8 to 92 mm³"
    assert key_figures(results)[0].note.replace("\u202f", " ").startswith("90.80 ± 0.51 mm³ stands out; worn or made so")
    # Of a side that is worn throughout it is all that is likely to be gone.
    results = changed(results, "measured.loop.worn_sides", frozenset({Side.LEFT}))
    assert "the likeliest is 90.80 ± 0.51 mm³" in verdict(results).replace("\u202f", " ").replace("\u00a0", " ")


def test_the_headline_tells_the_range_too():
    """For who works from Python it is the verdict."""
    assert "not excluded" not in fake_results().headline()
    results = changed(fake_results(), "wear.undecided", ((2.0, 0.1),))
    assert results.headline().endswith("in 3 regions (1.8 to 92 mm³ are not excluded)")
    none = changed(results, "wear.found.regions", ())
    assert "no wear found (" in changed(none, "wear.found.volume", 0.0).headline()


def test_a_range_hardly_wider_than_the_deviation_says_comes_after_it():
    results = changed(fake_results(), "wear.undecided", ((89.8, 0.5),))
    said = verdict(results).replace("\u202f", " ").replace("\u00a0", " ")
    assert said.startswith("90.80 ± 0.51 mm³ of metal is gone") and "the loss may be 89 to 92 mm³" in said


OPENED = {
    "worn flanks not seen whole": (lambda r: changed(r, "wear.found.unseen", 50.0), "90 to 141", "where it was seen it is"),
    "cut thinner within the tolerance or worn evenly": (lambda r: worn_within(r, 0.2), "36 to 145", "the likeliest is"),
    "pits on other flanks": (lambda r: changed(r, "wear.found.hidden_pits", 50.0), "90 to 141", "the likeliest is"),
}


def worn_within(results, tolerance):
    """With a tolerance of the tooth thickness, mm, and the left side worn throughout."""
    spec = replace(results.gear.spec, tolerance=replace(results.gear.spec.tolerance, thickness=tolerance))
    results = changed(results, "measured.root.gear", Gear.from_spec(spec))
    return changed(results, "measured.loop.worn_sides", frozenset({Side.LEFT}))


@pytest.mark.parametrize("reason", OPENED)
def test_whatever_opens_the_range_is_told_with_it(reason):
    """On flanks of 3 × 96.4 mm² a tolerance of 0.2 mm of arc is 0.2 mm · cos 20° · 289.2 mm² = 54 mm³; the value alone, 90.80 ± 0.51 mm³, would
    be read as how well it is known."""
    put_in, range_, likeliest = OPENED[reason]
    results = put_in(fake_results())
    low, high, _ = results.volume_range
    assert [low, high] == pytest.approx([float(x) for x in range_.split(" to ")], abs=0.5)
    said, figure = verdict(results).replace("\u202f", " ").replace("\u00a0", " "), key_figures(results)[0]
    other = reason == "pits on other flanks"  # nothing more is gone from these three
    assert said.startswith(f"{range_} mm³ of metal is gone{'; what stands out are' if other else ' from'} 3 left flanks")
    assert "the scan does not decide " in said and f": {likeliest} 90.80 ± 0.51 mm³" in said
    assert figure.value.replace("\u202f", " ") == f"{range_} mm³" and reason in figure.note


def test_the_tolerance_is_told_by_what_it_opens():
    """0.2 mm · cos 20° · 289.2 mm² = 54 mm³; with 50 mm³ unseen the verdict has 90.8 + 54 + 50. Told as limits, it stood beside wider ones."""
    results = changed(worn_within(fake_results(), 0.2), "wear.found.unseen", 50.0)
    (note,) = [note for note in worn_notes(results.measured, results.wear.found) if "tolerance" in note]
    assert "an even loss of whole flanks open: 54 mm³ less or more" in note
    assert "between" not in note and verdict(results).startswith("36 to 195")
    none = changed(results, "wear.found.regions", ())
    assert not any("tolerance" in note for note in worn_notes(none.measured, none.wear.found))


def test_limits_down_to_nothing_are_no_nought_where_the_deepest_place_is_surely_low():
    """Nothing worn throughout would be 0 ± 1 mm³: "0 to 92 mm³ is gone; deepest, by 36 to 92 µm" said both that nothing is gone and that it is."""
    results = changed(fake_results(), "wear.undecided", ((0.0, 1.0),))
    assert results.volume_range[0] == 0.0
    worst = results.wear.deepest
    for depth, none in ((worst.max_depth, False), (0.01, True)):
        regions = tuple(replace(one, max_depth=min(one.max_depth, depth), max_depth_std=0.001) for one in results.wear.regions)
        opened = changed(results, "wear.found.regions", regions)
        assert (opened.open_volume.depth_limits(opened.wear.deepest)[0] <= 0.0) == none
        said = verdict(opened).replace("\u202f", " ").replace("\u00a0", " ")
        assert key_figures(opened)[0].value.replace("\u202f", " ") == "up to 92 mm³"
        assert said.startswith("Up to 92 mm³ of metal is gone; what stands out are 3 left flanks") != none
        assert said.startswith("3 left flanks may be worn: up to 92 mm³ of metal is missing there, which may be none") == none


def test_what_faint_wear_may_come_to_is_told_of_a_gear_without_any():
    results = changed(changed(fake_results(), "wear.found.regions", ()), "wear.found.volume", 0.0)
    results = changed(changed(results, "wear.found.volume_std", 0.0), "wear.found.faint", 3.1)
    assert results.volume_range[1] == pytest.approx(3.1)
    for text in (verdict(results), key_figures(results)[0].note):
        assert "with wear too shallow to be found the loss may be up to 3.1 mm³" in text.replace("\u202f", " ")


def test_faint_wear_is_not_told_to_come_to_less_than_the_value_may_be():
    """3.767 ± 0.022 reaches 3.810 by itself: "up to 3.8" of a limit of 3.826 said less than the ± beside it."""
    results = changed(changed(fake_results(), "wear.found.volume", 3.767), "wear.found.volume_std", 0.0218)
    results = changed(results, "wear.found.faint", 0.059)
    assert results.volume_range[1] == pytest.approx(3.826)
    assert "the loss may be up to 3.83 mm³" in verdict(results).replace("\u202f", " ").replace("\u00a0", " ")


def test_without_a_region_the_limits_stand_beside_the_nought():
    results = changed(fake_results(), "wear.found.regions", ())
    results = changed(results, "wear.undecided", ((110.0, 5.0),))
    row = next(line for line, _ in lines(results, 80) if "Metal lost" in line).replace("\u00a0", " ")
    assert "0 to 120 mm³" in row and "not excluded" in row


def test_the_module_is_that_of_the_drawing():
    spec = replace(fake_results().gear.spec, normal_module=3.175)
    head = subject("pinion", replace(fake_results().gear, spec=spec), fake_results().measured.scans).replace("\u202f", " ")
    assert "m = 3.175 mm, α = 20.0°" in head


def test_the_head_of_a_double_helical_gear_keeps_its_file_and_its_points():
    """It read "right and left · d…z, 35 323 po…"."""
    gear = Gear.from_spec(GearSpec("gear", 22, 2.0, 30.0, helix_angle=math.radians(25.0), gap=5.0))
    scan = replace(fake_results().measured.scans[0], files=("in/dh.xyz",))
    head = subject("gear", gear, [scan], 80)
    assert "z=22, m=2.00" in head and " · dh.xyz, " in head and head.endswith(" points") and len(head) <= 80
    assert subject("gear", gear, [scan]).startswith("gear, z = 22, m = 2.00")


def test_what_the_effects_would_have_cost_is_one_line():
    def said(width, results):
        return [
            line.replace("\u202f", " ").replace("\u00a0", " ")
            for line, _ in lines(results, width)
            if line.startswith("If left in")
        ]

    assert said(110, fake_results()) == [
        "If left in: 83.1 mm³ lost, backlash 1.603 mm, transmission error 1 562.1 µm, deepest wear 1 531.2 µm."
    ]
    assert said(80, fake_results()) == ["If left in: 83.1 mm³ lost, backlash 1.603 mm, transmission error 1 562.1 µm."]
    hidden = {"worn_volume_mm3": 0.0, "deepest_wear_um": 0.0}
    none = replace(
        fake_results(), changes=tuple(replace(one, before=hidden.get(one.name, one.before)) for one in fake_results().changes)
    )
    assert said(110, none) == ["If left in: no wear found, backlash 1.603 mm, transmission error 1 562.1 µm."]
    unseen = replace(fake_results(), changes=tuple(replace(one, std=1e9) for one in fake_results().changes))
    assert said(80, unseen) == said(80, bare_results()) == []


def test_colours_only_on_a_terminal_and_never_with_no_color(monkeypatch):
    def printed(terminal):
        out = io.StringIO()
        print_summary(fake_results(), (), "", Console(file=out, width=80, force_terminal=terminal, highlight=False))
        return out.getvalue()

    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[" not in printed(False)
    assert "\x1b[33m" in printed(True), "warnings are yellow"
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b[33m" not in printed(True)


def test_a_terminal_without_unicode_gets_plain_letters():
    for made in MADE.values():
        for line, _ in lines(made(), 80):
            line.translate(ASCII).encode("ascii")


def test_piped_progress_is_silent_and_verbose_progress_tells_times(capsys):
    with progress.stations() as tell:
        tell("reading")
    assert capsys.readouterr() == ("", "")
    with progress.stations(verbose=True) as tell:
        tell("reading")
        tell("registration")
    told = capsys.readouterr().err.splitlines()
    assert [line.split()[0] for line in told] == ["reading", "registration"]
    with progress.stations(quiet=True, verbose=True) as tell:
        tell("reading")
    assert capsys.readouterr() == ("", "")


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="needs a pseudo-terminal")
def test_progress_on_a_terminal_appears_only_when_it_takes_long(monkeypatch):
    def seen(patience):
        master, slave = os.openpty()
        with os.fdopen(slave, "w") as terminal:
            monkeypatch.setattr(sys, "stderr", terminal)
            monkeypatch.setattr(progress, "PATIENCE", patience)
            monkeypatch.setenv("TERM", "xterm")
            with progress.stations() as tell:
                tell("registration")
                time.sleep(0.25)
            monkeypatch.undo()
            terminal.flush()
        os.set_blocking(master, False)
        try:
            return os.read(master, 1 << 16).decode()
        except OSError:  # nothing was ever written
            return ""
        finally:
            os.close(master)

    assert "registration" in seen(0.0)
    assert "registration" not in seen(30.0)


def test_the_words_cost_no_plotting_package():
    code = (
        "import sys; import gearwear.report.words.terminal, gearwear.report.page.view, gearwear.commands.progress, gearwear.report.files.writing;"
        "print([m for m in ('matplotlib', 'reportlab', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("width", [80, 100])
@pytest.mark.parametrize("letters", [1, 30, 60, 200])
def test_the_first_line_cuts_the_files_name_and_no_number(width, letters):
    results = fake_results()
    name = "begin_" + letters * "x" + "_end.ply"
    scan = replace(results.measured.scans[0], files=(f"folder/{name}", "other.ply"))
    results = changed(results, "measured.scans", (scan,))
    first = lines(results, width)[0][0].replace("\u00a0", " ")
    count = f"{len(scan) + sum(scan.rejected.values()):,}".replace(",", " ")
    assert len(first) <= width and first.endswith(f" and 1 more, {count} points".replace("\u202f", " "))
    shown = first.partition("· ")[2].partition(" and 1 more")[0]
    begin, _, end = shown.partition("…")
    assert name.startswith(begin) and len(begin) >= 4 and (end or ".ply").endswith(".ply") and (shown == name or end == ".ply")
    if len(first) < width:
        assert shown == name


@pytest.mark.parametrize(
    ("kinds", "said"),
    [
        (((9, "missing tooth"),), "Tooth 10 is broken off, 3.00 ± 0.50"),
        (((3, "broken corner"), (3, "broken corner"), (6, "chipped edge")), "2 corners of tooth 4 and an edge of tooth 7 are broken off, 9.00 ± 0.87"),
    ],
)  # fmt: skip
def test_the_verdict_begins_with_what_is_broken_off(kinds, said):
    """Its volume is the sum, with the root of the sum of squares; the terminal does not say it again among the doubts."""
    pieces = tuple(Broken(tooth, kind, Side.LEFT, 3.0, 0.5, np.zeros((0, 3)), np.zeros((2, 1, 1), bool)) for tooth, kind in kinds)
    results = changed(real_results(), "measured.broken", pieces)
    assert verdict(results).replace("\u202f", " ").replace("\u00a0", " ").startswith(said)
    assert not any(line.startswith("! Tooth") for line, _ in lines(results, 80))
    unworn = changed(results, "wear.found.regions", ())
    assert "nothing else on the flanks" in verdict(unworn)
    assert "broken" not in verdict(real_results())


@pytest.mark.parametrize(("std", "said"), [(30.0, "known to ± 33 % only"), (88.0, "known to ± 97 % only"), (1.0, None)])
def test_an_uncertain_volume_is_not_called_known_to_97_per_cent(std, said):
    """88 of 90.8 mm³ are 97 %: "known to 97 % only" reads as if three per cent were open."""
    told = " ".join(doubts(changed(fake_results(), "wear.found.volume_std", std))).replace("\u202f", " ")
    assert said in told if said else "% only" not in told


def test_no_wear_is_told_against_what_is_left_of_the_scan_where_that_is_more_than_its_noise():
    """The scan scatters by 2 µm and is 30 µm off all that was fitted to it: wear of 20 µm does not stand out, "of a scatter of 2 µm" or not."""
    results = changed(changed(bare_results(), "wear.found.regions", ()), "measured.loop", fake_results().loop)
    for left, said in ((0.030, "the 30 µm RMS by which the scan is off the design"), (0.003, "the scan's scatter of 2.0 µm")):
        loop = replace(results.loop, noise=0.002, rms_after=left)
        assert said in verdict(changed(results, "measured.loop", loop)).replace("\u202f", " ")


def test_the_first_warning_is_told_whole():
    """A warning that ends "…, and an even loss of both sides could …" broke off before what it warns of."""
    whole = f"{'where the teeth stand rests on tips, roots and fillets, and ' * 3}all may be thinner."
    results = replace(fake_results(), notes=(whole, "a second one.", "a third one."))
    said = " ".join(line for line, _ in lines(results, 80)).replace("\u00a0", " ")
    assert whole[0].upper() + whole[1:] in said and "! and 2 more, in the report" in said


def test_warnings_get_the_lines_that_the_rest_leaves():
    """Of a gear alone three of four warnings stood behind "and 3 more" on a screen that had room for them."""
    results = bare_results()
    few, many = (replace(results, notes=tuple(f"warning {i}." for i in range(n))) for n in (6, 60))
    said = [line for line, _ in lines(few, 80)]
    assert [line for line in said if line.startswith("! Warning")] == [f"! Warning {i}." for i in range(6)]
    assert not any("in the report" in line for line in said)
    crowd = [line for line, _ in lines(many, 80)]
    assert len(crowd) == 21 and crowd[-1].endswith(" more, in the report")


@pytest.mark.parametrize("number", [1, 9, 60])
def test_files_that_have_no_room_are_counted(number):
    """A list that ends "sections.dxf, …" did not say whether the coloured bodies that were asked for are there."""
    names = [f"file_number_{i}.stl" for i in range(number)]
    said = " ".join(line for line, _ in written("out", names, 80)).replace("\u00a0", " ")
    told = said.count(".stl")
    assert "…" not in said and said.startswith("Written to out: file_number_0.stl")
    assert said.endswith(f"and {number - told} more" if told < number else names[-1])
    assert len(written("out", names, 80)) <= 2


@pytest.mark.parametrize("most", [1, 2, 3, 4])
def test_what_has_no_room_is_left_out_from_the_end_of_a_clause_on(most):
    """A verdict that ends "on flanks that stand out it is …" said neither what it is nor that the report does."""
    clauses = [
        "the flanks are smooth but low against the tips (thinner teeth, or the same loss, of all of them)",
        "they cannot tell",
        "it may be off",
    ]
    text = f"{clauses[0]}: {clauses[1]}, and {clauses[2]}; {' and so on' * 20}."
    said = to_a_clause(text, 80, most)
    joined = " ".join(said).replace("\u00a0", " ")
    assert len(said) <= most
    if most == 1:  # not even the first clause has room
        assert joined.endswith("…")
    else:
        kept = joined.removesuffix(" (more in the report).")
        assert kept in (clauses[0], f"{clauses[0]}: {clauses[1]}", f"{clauses[0]}: {clauses[1]}, and {clauses[2]}")
        assert joined != kept
    assert to_a_clause("All of it.", 80, 1) == ["All of it."]
