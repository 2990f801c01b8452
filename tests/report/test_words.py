"""Numbers and effects in words, and the verdict: what is said follows what is in the report."""

from __future__ import annotations

import copy

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwear.design.quantity import MISSING, SPACE, number, with_std
from gearwear.diagnose.effects import catalogue
from gearwear.report.words.effects import PLAIN, SIGNED, effect_words
from gearwear.report.words.numbers import quantity
from gearwear.report.words.verdict import doubts, key_figures, loop_words, lost_most, thinnest, verdict
from tests.report.fake import bare_report, fake_report


def spoken(text: str) -> str:
    return text.replace(SPACE, " ")


@given(st.floats(-1e6, 1e6), st.integers(0, 6))
def test_a_printed_number_reads_back_within_half_a_digit(value, digits):
    text = number(value, digits).replace(SPACE, "").replace("−", "-")
    assert abs(float(text) - value) <= 0.5 * 10.0**-digits * (1 + 1e-9) + 1e-9
    assert not (text.startswith("-") and float(text) == 0.0)


@given(st.floats(-1e4, 1e4), st.floats(1e-4, 1e4))
def test_value_and_deviation_are_printed_to_the_same_digit_and_keep_the_deviation_to_a_quarter(value, std):
    first, second = spoken(with_std(value, std)).replace("−", "-").split(" ± ")
    decimals = [len(part.partition(".")[2]) for part in (first, second)]
    assert decimals[0] == decimals[1]
    assert abs(float(second.replace(" ", "")) - std) <= max(0.25 * std, 0.5)


@pytest.mark.parametrize("item", [None, float("nan"), {"value": None, "std": 1.0}, []])
def test_what_is_not_known_is_a_dash(item):
    assert quantity(item, "mm") == MISSING


def parameters_of(effect):
    return {name: {"value": 2.0, "std": 0.1, "unit": name.rpartition("_")[2]} for name in effect.parameters}


@pytest.mark.parametrize("effect", catalogue(), ids=lambda effect: effect.name)
def test_every_effect_of_the_catalogue_has_words_that_hold_its_size(effect):
    assert (effect.name in SIGNED) != (effect.name in PLAIN)
    text = spoken(effect_words({"name": effect.name, "parameters": parameters_of(effect)}))
    assert "2.00 ± 0.10" in text
    assert "_" not in text


@pytest.mark.parametrize("name", sorted(SIGNED))
def test_words_of_a_signed_effect_follow_its_sign(name):
    key, more, less = SIGNED[name]
    assert more != less
    words = {sign: effect_words({"name": name, "parameters": {key: {"value": sign * 5.0, "std": 1.0}}}) for sign in (1, -1)}
    assert words[1] != words[-1]
    assert "−" not in words[-1]


def test_an_unknown_effect_is_named_as_it_is():
    assert spoken(effect_words({"name": "thermal_bow", "parameters": {"bow_um": {"value": 3.0, "std": 0.2, "unit": "um"}}})) == (
        "thermal bow (bow 3.0 ± 0.2 µm)"
    )


def test_the_verdict_says_how_much_where_and_how_thin():
    text = spoken(verdict(fake_report()))
    assert "90.8 ± 0.5 mm³" in text
    assert "the left flank of tooth 2" in text
    assert "1.55 mm" in text
    assert "1.58 mm (16 %) thinner" in text
    assert text.count(". ") == 0, "one sentence"


def test_an_unworn_gear_is_called_so_with_what_would_have_shown():
    report = bare_report()
    report["wear"]["detection_limit_um"] = 4.8
    text = spoken(verdict(report))
    assert text.startswith("No wear was found")
    assert "4.8 µm" in text


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda r: r["registration"].update(converged=False), "the registration did not settle"),
        (lambda r: r["scan"]["coverage"].update(flank=0.31), "only 31 % of the flanks was seen"),
        (
            lambda r: r["scan"]["coverage"].update(flank=0.48, flank_left=0.96, flank_right=0.0),
            "only 48 % of the flanks was seen, of the right ones next to nothing",
        ),
        (lambda r: r["closed_loop"]["after"].update(rms_um=962.0), "outside the wear the scan is 962 µm off the design"),
        (
            lambda r: r["registration"].update(flank_base_radius_mm=1.024 * r["design"]["base_radius_mm"]),
            "the flanks are those of another gear or out of scale: their base circle is some",
        ),
        (lambda r: r["registration"].update(views=[{"converged": True}, {"converged": False}]), "view 2 could not be placed"),
    ],
)
def test_a_doubtful_result_is_hedged_in_the_verdict_and_listed(change, said):
    report = fake_report()
    change(report)
    assert spoken(verdict(report)).startswith(f"Doubtful, because {said}")
    assert any(said in spoken(doubt) for doubt in doubts(report))


def test_of_another_gear_no_wear_is_claimed():
    report = fake_report()
    report["registration"]["flank_base_radius_mm"] = 0.976 * report["design"]["base_radius_mm"]
    text = spoken(verdict(report))
    assert text.endswith("check module and pressure angle. What is said of wear holds only if the design is right.")
    assert "gone" not in text


def test_tips_and_roots_elsewhere_than_the_designs_come_first():
    report = fake_report()
    tip, root = (report["design"][f"{rim}_radius_mm"] for rim in ("tip", "root"))
    report["registration"] |= {"tip_radius_mm": tip - 0.6, "root_radius_mm": root - 0.9}
    text = spoken(verdict(report))
    assert text.startswith(
        f"Doubtful, because the tips lie at a diameter of {2 * tip - 1.2:.1f} mm and the design's at {2 * tip:.1f} mm"
    )
    assert f"roots lie at a diameter of {2 * root - 1.8:.1f} mm" in text and "check tip and root diameter" in text
    report["registration"] |= {"tip_radius_mm": tip - 0.1, "root_radius_mm": None}
    assert "Doubtful" not in verdict(report)


def test_a_base_circle_that_is_a_little_off_is_no_other_gear():
    report = fake_report()
    report["registration"]["flank_base_radius_mm"] = 0.993 * report["design"]["base_radius_mm"]
    assert "Doubtful" not in verdict(report)


def test_what_is_unexplained_is_said_so_and_never_named():
    report = fake_report()
    report["closed_loop"]["effects"] = []
    report["closed_loop"]["unexplained"] = {"found": True, "rms_um": 4.2, "pattern": "5 waves round the gear"}
    text = spoken(loop_words(report))
    assert "no known effect" in text
    assert "Unexplained: a pattern of 4.20 µm RMS" in text
    assert "5 waves round the gear" in text


def test_the_loop_tells_what_it_cannot_tell_apart():
    assert "cannot tell scale from axis offset radial" in loop_words(fake_report())


def test_a_loop_that_named_nothing_claims_no_gain():
    report = fake_report()
    report["closed_loop"] |= {"effects": [], "after": report["closed_loop"]["before"]}
    _, value, note = key_figures(report)[-1]
    assert "→" not in value
    assert note.startswith("no effect is named")


def test_an_error_far_above_the_noise_is_not_called_nothing():
    report = fake_report()
    report["closed_loop"] |= {"unexplained": {"found": False, "rms_um": 0.0, "pattern": None}}
    assert "Nothing significant is left unexplained." in loop_words(report)
    report["closed_loop"] |= {"noise_um": 0.1 * report["closed_loop"]["after"]["rms_um"]}
    assert "Nothing" not in loop_words(report) and "has no pattern that stands out" in loop_words(report)


def test_no_loop_is_no_finding():
    assert "No effect of measurement or manufacture was looked for" in loop_words(bare_report())
    report = fake_report()
    report["closed_loop"]["sought"] = False
    assert "No effect" in loop_words(report)


def test_warnings_of_the_drawing_are_not_doubts_about_the_result():
    report = fake_report()
    report["design"]["warnings"] = report["warnings"]
    assert doubts(report) == []


def test_the_thinnest_tooth_is_the_one_with_the_least_left():
    assert thinnest(fake_report())["tooth"] == lost_most(fake_report())["tooth"] == 2
    assert thinnest(bare_report()) is None and lost_most(bare_report()) is None


def test_teeth_made_too_thick_are_not_called_thin_for_what_they_lost():
    """Made 0.05 mm too thick and worn by 0.02 mm: 0.03 mm above the design, and nothing is thinner than that."""
    report = fake_report()
    for row in report["thickness"]:
        row |= {"min_mm": row["nominal_mm"] + 0.05, "loss_max_mm": 0.0, "std_mm": 0.001}
    report["thickness"][4] |= {"min_mm": report["thickness"][4]["nominal_mm"] + 0.03, "loss_max_mm": 0.02}
    figures = {name: spoken(value) for name, value, _ in key_figures(report)}
    assert figures["Thinnest tooth"] == f"{report['thickness'][4]['nominal_mm'] + 0.03:.4f} ± 0.0010 mm"
    assert "thinner" not in verdict(report)


def test_key_figures_carry_their_uncertainty_and_leave_out_what_is_not_there():
    full = {name: spoken(value) for name, value, _ in key_figures(fake_report())}
    assert full["Metal lost"] == "90.8 ± 0.5 mm³"
    assert {"Backlash, greatest", "Transmission error", "Thinnest tooth"} <= set(full)
    bare = {name for name, _, _ in key_figures(bare_report())}
    assert bare == {"Section lost", "Error outside wear, RMS"}


@pytest.mark.parametrize(
    "key", ["design", "scan", "registration", "closed_loop", "wear", "thickness", "meshing", "files", "warnings"]
)
def test_a_missing_part_never_breaks_the_words(key):
    for value in (None, "absent"):
        report = copy.deepcopy(fake_report())
        report.pop(key)
        if value is None:
            report[key] = None
        for words in (verdict, loop_words, doubts, key_figures):
            assert words(report) is not None
