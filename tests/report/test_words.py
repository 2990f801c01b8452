"""Numbers and effects in words, and the verdict: what is said follows what is in the report."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwear.comparison.open_volume import Open
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.quantity import MISSING, SPACE, number, teeth_words, with_std
from gearwear.design.side import Side
from gearwear.diagnose.correlations import Correlation
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.parameter import ParameterEstimate
from gearwear.diagnose.pattern import Pattern
from gearwear.placing.accord import ViewAccord
from gearwear.placing.refusal import SeenRadii
from gearwear.placing.views import View
from gearwear.report.words.consequences import change_line, said_changes
from gearwear.report.words.effects import effect_words
from gearwear.report.words.lost import QUESTIONS
from gearwear.report.words.numbers import effect_title, quantity, which_flanks
from gearwear.report.words.other_design import other_angles, wrong_design
from gearwear.report.words.verdict import (
    alike_words,
    deepest_range,
    doubts,
    key_figures,
    loop_words,
    thinnest_words,
    verdict,
)
from gearwear.wear.limits import FlankLimit
from gearwear.wear.tooth_summary import ThinnestTooth
from tests.report.fake import bare_results, changed, fake_regions, fake_results, fake_thickness, solids_of


def spoken(text: str) -> str:
    return text.replace(SPACE, " ")


@given(st.floats(-1e6, 1e6), st.integers(0, 6))
def test_a_printed_number_reads_back_within_half_a_digit(value, digits):
    text = number(value, digits).replace(SPACE, "").replace("−", "-")
    assert abs(float(text) - value) <= 0.5 * 10.0**-digits * (1 + 1e-9) + 1e-9
    assert not (text.startswith("-") and float(text) == 0.0)


@given(st.floats(-1e4, 1e4), st.floats(1e-4, 1e4))
def test_value_and_deviation_are_printed_to_the_same_digit_and_keep_the_deviation_to_a_twentieth(value, std):
    first, second = spoken(with_std(value, std)).replace("−", "-").split(" ± ")
    decimals = [len(part.partition(".")[2]) for part in (first, second)]
    assert decimals[0] == decimals[1]
    assert abs(float(second.replace(" ", "")) - std) <= max(0.05 * std, 0.5)


@pytest.mark.parametrize("value", [math.nan, math.inf, (), (math.nan,)])
def test_what_is_not_known_is_a_dash(value):
    assert quantity(ParameterEstimate(value, 1.0, "mm")) == MISSING


def parameters_of(effect):
    return {one.name: ParameterEstimate(2.0, 0.1, one.unit) for one in effect.parameters}


@pytest.mark.parametrize("effect", catalogue(), ids=lambda effect: effect.name)
def test_every_effect_of_the_catalogue_has_words_that_hold_its_size(effect):
    text = spoken(effect_words(effect.name, parameters_of(effect)))
    assert "2.00 ± 0.10" in text
    assert "_" not in text


@pytest.mark.parametrize("effect", [one for one in catalogue() if one.phrase_below], ids=lambda effect: effect.name)
def test_words_of_a_signed_effect_follow_its_sign(effect):
    parameter = effect.parameters[0]
    others = {} if effect.phrase_of_sides else parameters_of(effect)
    size = {sign: others | {parameter.name: ParameterEstimate(sign * 5.0, 1.0, parameter.unit)} for sign in (1, -1)}
    words = {sign: spoken(effect_words(effect.name, item)) for sign, item in size.items()}
    assert words[1] != words[-1]
    assert all("5 ± 1" in text or "5.0 ± 1.0" in text for text in words.values())
    assert "−" not in words[-1]


def test_sides_of_their_own_are_told_in_place_of_their_mean():
    """The mean of a bulge and a hollow says nothing."""
    sides = {"crowning_um": 1.0, "left_um": 6.0, "right_um": -4.0}
    text = spoken(effect_words("helix_crowning", {name: ParameterEstimate(value, 1.0, "um") for name, value in sides.items()}))
    assert text == "flanks crowned lengthwise by 6.0 ± 1.0 µm on the left and −4.0 ± 1.0 µm on the right"


def test_an_unknown_effect_is_named_as_it_is():
    assert (
        spoken(effect_words("thermal_bow", {"bow_um": ParameterEstimate(3.0, 0.2, "um")})) == "thermal bow (bow 3.00 ± 0.20 µm)"
    )


@pytest.mark.parametrize(
    ("order", "often"), [(1.0, "once a revolution"), (2.0, "twice a revolution"), (11.0, "11 times a revolution")]
)
def test_a_wave_of_the_table_goes_round_once_or_so_many_times(order, often):
    found = {
        "order": ParameterEstimate(order, 0.0, ""),
        "amplitude_deg": ParameterEstimate(0.02, 0.001, "deg"),
        "phase_deg": ParameterEstimate(40.0, 1.0, "deg"),
    }
    assert spoken(effect_words("turntable_angle", found)).endswith(f", {often}")


def test_flanks_in_few_words():
    one, two, three = fake_regions()
    assert which_flanks([one]) == "the left flank of tooth 2"
    assert which_flanks([one, two, three]) == "3 left flanks"
    three_seen = SimpleNamespace(flanks_seen=lambda side: 3, side_maps=SimpleNamespace(count=np.zeros((3, 2, 1, 1))))
    twelve_teeth = SimpleNamespace(flanks_seen=lambda side: 3, side_maps=SimpleNamespace(count=np.zeros((12, 2, 1, 1))))
    assert which_flanks([one, two, three], three_seen) == "all 3 left flanks"
    assert which_flanks([one, two, three], twelve_teeth) == "all 3 left flanks that were seen"
    assert which_flanks([one, two], twelve_teeth) == "2 left flanks"
    assert which_flanks([one, replace(two, side=Side.RIGHT)]) == "2 flanks of 2 teeth"
    assert which_flanks([one, replace(one, side=Side.RIGHT)]) == "2 flanks of 1 tooth"


def test_the_verdict_says_how_much_where_and_how_thin():
    text = spoken(verdict(fake_results()))
    assert "90.80 ± 0.51 mm³" in text
    assert "the left flank of tooth 2" in text
    assert "1.55 mm" in text
    assert "1.58 mm (16 %) thinner" in text
    assert text.count(". ") == 0, "one sentence"


def test_a_loss_within_its_own_doubt_is_not_gone():
    """How high a side stood as it was made may leave open all of what it seems to have lost."""
    known = fake_results()
    doubted = changed(known, "wear.found.volume_std", 0.6 * known.wear.volume)
    assert "of metal is gone from" in verdict(known)
    text = spoken(verdict(doubted))
    assert "is gone from" not in text and "3 left flanks may be worn" in text and "which may be none" in text


def test_a_thinning_below_its_own_doubt_is_no_finding():
    results = changed(fake_results(), "wear.thickness", fake_thickness(dict.fromkeys(range(1, 13), 0.0003)))
    thinnest, nominal = results.wear.thinnest, results.gear.tooth_thickness
    assert thinnest.low < thinnest.value < nominal < thinnest.high
    assert "thinner" not in verdict(results)


def test_a_tooth_that_is_drawn_thinner_at_its_ends_is_not_thinner_than_designed():
    """Helices crowned by 40 µm make the ends of every tooth 85 µm thinner than its middle, as the drawing has it."""
    results = changed(fake_results(), "wear.thickness", fake_thickness(dict.fromkeys(range(1, 13), 0.0003)))
    crowned = FlankModification(helix_crowning=0.04)
    gear = Gear.from_spec(replace(results.gear.spec, left=crowned, right=crowned))
    thickness = results.wear.thickness
    drawn = gear.reference_radius * gear.half_angles(np.array([gear.reference_radius]), thickness.z).sum(axis=0)[:, 0]
    made = np.broadcast_to(drawn, thickness.arc.shape)
    as_drawn = replace(thickness, arc=made - 0.0003, as_made=made, drawn=made, pooled=1)
    results = changed(changed(results, "wear.thickness", as_drawn), "measured.root.gear", gear)
    assert results.wear.thinnest.value < results.gear.tooth_thickness - 0.05
    assert "thinner" not in verdict(results)
    told = next(figure for figure in key_figures(results) if figure.name == "Thinnest tooth")
    assert f"design {number(float(drawn.min()), 3)}" in told.note


def test_an_unworn_gear_is_called_so_with_what_would_have_shown():
    results = bare_results()
    text = spoken(verdict(results))
    assert text.startswith("No wear was found")
    worst = results.wear.found.would_have_shown
    assert worst is None or f"{1e3 * worst.depth:.1f} µm" in text
    assert "would have shown" in text


def test_flanks_that_say_nothing_are_told():
    limits = [FlankLimit(tooth, side, 0.008, 9.0, 1.0) for tooth in range(3) for side in Side]
    plain = changed(bare_results(), "wear.found.flanks", tuple(limits))
    thin = changed(plain, "wear.found.flanks", (*limits[1:], replace(limits[0], depth=math.nan)))
    assert "; wear of 8.0 µm would have shown on every flank; with wear too shallow" in spoken(verdict(plain))
    assert "on all but 1 flank, seen too thinly to say; with wear too shallow" in spoken(verdict(thin))


def seen_only(results, shares):
    """With so much of the left and of the right flanks seen."""
    cells = results.measured.cells
    count = cells.count.copy()
    start, size = cells.grid.blocks[0]
    for side, share in zip(Side, shares, strict=True):
        own = start + np.flatnonzero(cells.points.side[start : start + size] == side)
        count[own] = 1.0
        count[own[round(share * len(own)) :]] = 0.0
    return changed(results, "measured.final.cells.count", count)


def with_views(results, *converged):
    registration = results.measured.placed.registration
    views = tuple(View(replace(registration, converged=one), 9, 9, 0.0, 0.0, ViewAccord(shared=0)) for one in converged)
    return changed(results, "measured.placed.views", views)


DOUBTFUL = {
    "the registration did not settle": lambda r: changed(r, "measured.placed.registration.converged", False),
    "only 31 % of the flanks was seen": lambda r: seen_only(r, (0.31, 0.31)),
    "only 48 % of the flanks was seen, of the right ones next to nothing": lambda r: seen_only(r, (0.96, 0.0)),
    "outside the wear the scan is 962 µm off the design": lambda r: changed(r, "measured.loop.rms_after", 0.962),
    "the flanks are those of another gear or out of scale: their base circle is some": lambda r: changed(
        r, "seen.base", 1.024 * r.gear.base_radius
    ),
    "flanks and tips are both 0.6 % smaller than drawn, as those of module 6.31 would be": lambda r: changed(
        changed(r, "seen.base", 0.994 * r.gear.base_radius), "seen.tip", 0.9945 * r.gear.tip_radius
    ),
    "view 2 could not be placed": lambda r: with_views(r, True, False),
}


@pytest.mark.parametrize("said", DOUBTFUL)
def test_a_doubtful_result_is_hedged_in_the_verdict_and_listed(said):
    results = DOUBTFUL[said](fake_results())
    assert spoken(verdict(results)).startswith(f"Doubtful, because {said}")
    assert any(said in spoken(doubt) for doubt in doubts(results))


@pytest.mark.parametrize(("base", "tip"), [(0.994, 1.0), (0.994, 1.006), (1.0, 0.9945), (0.9985, 0.9985)])
def test_flanks_or_tips_alone_are_of_no_other_module(base, tip):
    results = changed(fake_results(), "seen.base", base * fake_results().gear.base_radius)
    results = changed(results, "seen.tip", tip * results.gear.tip_radius)
    assert "module" not in verdict(results)


def test_what_a_scale_found_makes_larger_is_no_other_module():
    gear = fake_results().gear
    assert wrong_design(gear, SeenRadii(1.006 * gear.base_radius, 1.006 * gear.tip_radius, gear.root_radius), scale=0.006) is None
    assert "6.39" in wrong_design(gear, SeenRadii(1.006 * gear.base_radius, 1.006 * gear.tip_radius, gear.root_radius))


@pytest.mark.parametrize(("base", "tip", "module"), [(0.9967, 0.995, "6.32"), (0.995, 0.9967, "6.32"), (0.9968, 0.9941, None)])
def test_worn_flanks_lean_and_are_of_another_module_all_the_same(base, tip, module):
    """Those of a gear of module 4.00 under a design of 4.02 were 0.33 % off, its tips 0.5 %; where one is nearly twice as far off as the other it is no module."""
    gear = fake_results().gear
    said = wrong_design(gear, SeenRadii(base * gear.base_radius, tip * gear.tip_radius, gear.root_radius))
    assert module in said if module else said is None or "module" not in said


class TestWhatTheDrawingShouldSay:
    """Circles of gears that differ from the design's in one value; what is told is that value."""

    GEAR = fake_results().gear

    def other(self, **changes):
        return Gear.from_spec(replace(self.GEAR.spec, **changes))

    def seen(self, gear):
        return SeenRadii(gear.base_radius, gear.tip_radius, gear.root_radius)

    @pytest.mark.parametrize("shift", [-0.2, 0.35])
    def test_profile_shift(self, shift):
        seen = self.seen(self.other(profile_shift=shift))
        assert f"of a profile shift of {number(shift, 2)} would" in wrong_design(self.GEAR, seen)
        # the root that was seen is in the gear, and not on the drawing
        fitted = self.other(dedendum=self.GEAR.spec.dedendum - shift)
        assert f"of a profile shift of {number(shift, 2)} would" in wrong_design(fitted, seen, drawn=self.GEAR)

    @pytest.mark.parametrize(("helix", "shift"), [(0.0, 0.3), (20.0, 0.2)])
    def test_profile_shift_under_tip_and_root_as_measured(self, helix, shift):
        """Where tip and root are stated only the teeth are thicker: by 2 x m tan α, less what the gear has already."""
        drawn = self.other(helix_angle=math.radians(helix))
        cut = self.other(helix_angle=math.radians(helix), profile_shift=shift, addendum=1.0 - shift, dedendum=1.25 + shift)
        arc = (cut.tooth_thickness - drawn.tooth_thickness) * math.cos(cut.helix_angle)
        said = wrong_design(drawn, replace(self.seen(drawn), thicker=arc))
        assert f"{number(arc, 2)} mm thicker than drawn, as those of a profile shift of {number(shift, 2)} would be" in spoken(
            said
        )
        for thicker in (-arc, 0.05 * drawn.spec.normal_module):  # worn or thinned, or within what coat and tolerance may do
            assert wrong_design(drawn, replace(self.seen(drawn), thicker=thicker)) is None

    def test_another_tip_alone_is_no_shift(self):
        for other in (
            {"addendum": 1.3},
            {"addendum": 1.3, "dedendum": self.GEAR.spec.dedendum - 0.2},
        ):  # nor one further out than the root
            assert "shift" not in wrong_design(self.GEAR, self.seen(self.other(**other)))

    @pytest.mark.parametrize("degrees", [19.5, 20.5])
    def test_pressure_angle(self, degrees):
        gear = self.other(normal_pressure_angle=math.radians(degrees))
        (said,) = other_angles(self.GEAR, self.seen(gear), ())
        assert f"a pressure angle of {degrees:.2f}° and not of 20.00°" in said
        assert other_angles(self.GEAR, self.seen(self.other(normal_pressure_angle=math.radians(0.1 + 19.8))), ()) == []

    def test_flanks_and_tips_alike_are_of_no_other_angle(self):
        both = SeenRadii(0.996 * self.GEAR.base_radius, 0.996 * self.GEAR.tip_radius, self.GEAR.root_radius)
        assert other_angles(self.GEAR, both, ()) == []

    @pytest.mark.parametrize("degrees", [18.5, 19.0])
    def test_helix_angle(self, degrees):
        """Two flanks through the same point at mid-face, one of each angle: what lies between them at the ends, along the normal in space."""
        drawn = self.other(helix_angle=math.radians(18.0), face_width=40.0)
        turn = 40.0 * (math.tan(math.radians(degrees)) / drawn.reference_radius - drawn.twist)
        slope = turn * drawn.base_radius * drawn.base_helix_cosine
        effect = SimpleNamespace(name="helix_slope", amplitudes=np.array([slope]))
        (said,) = other_angles(drawn, self.seen(drawn), (effect,))
        assert f"lean by {degrees:.2f}° and not by 18.00°" in said
        small = SimpleNamespace(name="helix_slope", amplitudes=np.array([0.03]))
        assert other_angles(drawn, self.seen(drawn), (small,)) == []


def test_flanks_seen_too_thinly_beside_wear_are_told_once():
    """Those on which wear was found are none of them; without any wear the verdict tells of them."""
    results = fake_results()
    worn = {(region.tooth, region.side) for region in results.wear.regions}
    flanks = tuple(
        FlankLimit(tooth, side, math.nan if tooth in (2, 3, 4, 7) and side == Side.LEFT else 0.01, 5.0, 0.9)
        for tooth in range(12)
        for side in Side
    )
    silent = [flank.tooth + 1 for flank in flanks if not flank.says and (flank.tooth, flank.side) not in worn]
    thin = changed(results, "wear.found.flanks", flanks)
    said = [doubt for doubt in doubts(thin) if "too thinly" in doubt]
    assert len(said) == 1 and said[0].startswith(f"{len(silent)} left flanks, on {teeth_words(silent)}, ")
    both = changed(thin, "wear.found.flanks", (*flanks[:-1], replace(flanks[-1], depth=math.nan)))
    (said,) = [doubt for doubt in doubts(both) if "too thinly" in doubt]
    assert said.startswith(f"{len(silent) + 1} of 24 flanks, on {teeth_words([*silent, 12])}, ")
    assert not any("too thinly" in doubt for doubt in doubts(changed(thin, "wear.found.regions", ())))


def test_of_another_gear_no_wear_is_claimed():
    text = spoken(verdict(changed(fake_results(), "seen.base", 0.976 * fake_results().gear.base_radius)))
    assert text.endswith("check module and pressure angle. What is said of wear holds only if the design is right.")
    assert "gone" not in text


def test_tips_and_roots_elsewhere_than_the_designs_come_first():
    results = fake_results()
    tip, root = results.gear.tip_radius, results.gear.root_radius
    text = spoken(verdict(replace(results, seen=replace(results.seen, tip=tip - 0.6, root=root - 0.9))))
    assert text.startswith(
        f"Doubtful, because the tips lie at a diameter of {2 * tip - 1.2:.1f} mm and the design's at {2 * tip:.1f} mm"
    )
    assert f"roots lie at a diameter of {2 * root - 1.8:.1f} mm" in text and "check tip and root diameter" in text
    assert "Doubtful" not in verdict(replace(results, seen=replace(results.seen, tip=tip - 0.1, root=math.nan)))


def test_a_base_circle_that_is_a_little_off_is_no_other_gear():
    assert "Doubtful" not in verdict(changed(fake_results(), "seen.base", 0.993 * fake_results().gear.base_radius))


def test_what_is_unexplained_is_said_so_and_never_named():
    pattern = Pattern(5, "both", 0.0, 0.0, 0.0042, 0.009, 1e-9, np.zeros(1))
    loop = replace(fake_results().loop, effects=(), patterns=(pattern,))
    text = spoken(loop_words(changed(fake_results(), "measured.loop", loop)))
    assert "no known effect" in text
    assert "Unexplained: a pattern of 4.20 µm RMS" in text
    assert pattern.describe(15.0) in text


def test_the_loop_tells_what_it_cannot_tell_apart():
    known = fake_results()
    assert "cannot tell scale from axis offset radial" in loop_words(known)
    # What is not told from the same is one sentence.
    alike = tuple(replace(effect, alternatives=("sliding_wear",)) for effect in known.loop.effects[:2])
    text = loop_words(changed(known, "measured.loop", replace(known.loop, effects=alike)))
    first, other = (effect_title(effect.name) for effect in alike)
    assert f"The data cannot tell {first} or {other} from sliding wear." in text and text.count("cannot tell") == 1


@pytest.mark.parametrize(("value", "known"), [(-0.97, "sum"), (0.97, "difference"), (0.6, None)])
def test_sizes_that_are_known_only_together_are_said_so(value, known):
    """Var(a ± b) = 2 σ² (1 ± r): at r = −0.97 the sum is known 8 times better than the difference."""
    found = (Correlation(("coating", "scale"), ("thickness_um", "relative_ppm"), value),)
    text = loop_words(changed(fake_results(), "measured.loop.correlations", found))
    assert (f"sizes of coating and scale are correlated by {number(value, 2)}: their {known} is known" in text) == (
        known is not None
    )


def test_sizes_of_effects_that_are_not_named_are_not_said_to_be_alike():
    """Forms that the drawing leaves open are taken out without a name: "root form and tip relief" would be news to the reader."""
    pairs = (("root_form", "tip_relief"), ("coating", "root_form"), ("coating", "scale"))
    found = tuple(Correlation(pair, ("level_um", "amount_um"), -0.95) for pair in pairs)
    results = changed(fake_results(), "measured.loop.correlations", found)
    (said,) = alike_words(results)
    assert said.startswith("the sizes of coating and scale")
    assert "root form" not in loop_words(results)


def test_a_loop_that_named_nothing_claims_no_gain():
    one = key_figures(changed(fake_results(), "measured.loop.effects", ()))[-1]
    assert "→" not in one.value
    assert one.note.startswith("no effect is named")


def test_nothing_was_left_in_where_nothing_was_taken_out():
    assert change_line(said_changes(fake_results()), 200).startswith("If left in: 83.1")
    plain = changed(fake_results(), "measured.loop.effects", ())
    assert plain.changes and said_changes(plain) == ()


def test_an_error_far_above_the_noise_is_not_called_nothing():
    assert "Nothing significant is left unexplained." in loop_words(fake_results())
    text = loop_words(changed(fake_results(), "measured.loop.noise", 0.1 * fake_results().loop.rms_after))
    assert "Nothing" not in text and "has no pattern that stands out" in text


def test_no_loop_is_no_finding():
    assert "No effect of measurement or manufacture was looked for" in loop_words(bare_results())
    assert "No effect" in loop_words(changed(fake_results(), "measured.loop", None))


def test_warnings_of_the_drawing_are_not_doubts_about_the_result():
    results = fake_results()
    assert len(doubts(results)) == 1
    assert doubts(changed(results, "measured.design.warnings", results.notes)) == []


@pytest.mark.parametrize(
    ("off", "told"), [(1.9, ""), (-1.9, ""), (2.1, "91.87 mm³, 1.1 mm³ more"), (-2.1, "89.73 mm³, 1.1 mm³ less")]
)
def test_a_solid_of_another_volume_than_stated_is_told(off, told):
    """By how many standard deviations, 0.51 mm³, its volume is off: 95 % lie within 1.96."""
    results = fake_results()
    said = spoken(" ".join(doubts(changed(results, "wear.solids", solids_of(results, 90.80 + off * 0.51)))))
    assert (f"worn_volume.stl, holds {told} than the 90.80 ± 0.51 mm³ of the scan" in said) == bool(told)
    assert ("worn_volume" in said) == bool(told)
    assert "worn_volume" not in " ".join(doubts(changed(results, "wear.found.regions", ())))


def test_the_thinnest_tooth_is_the_one_with_the_least_left():
    wear = fake_results().wear
    assert wear.thinnest.tooth == wear.lost_most.tooth == 1
    unseen = changed(wear, "thickness.arc", np.full((12, 7), np.nan))
    assert unseen.thinnest is None and unseen.lost_most is None


def test_teeth_made_too_thick_are_not_called_thin_for_what_they_lost():
    """Made 0.05 mm too thick and worn by 0.02 mm: 0.03 mm above the design, and nothing is thinner than that."""
    worn = fake_thickness({tooth: -0.03 if tooth == 5 else -0.05 for tooth in range(1, 13)})
    results = changed(fake_results(), "wear.thickness", worn)
    figures = {one.name: spoken(one.value) for one in key_figures(results)}
    value, _, std, unit = figures["Thinnest tooth"].split()
    assert abs(float(value) - results.gear.tooth_thickness - 0.03) < 0.2 * float(std) and unit == "mm"
    assert "thinner" not in verdict(results)


def test_key_figures_carry_their_uncertainty_and_leave_out_what_is_not_there():
    full = {one.name: spoken(one.value) for one in key_figures(fake_results())}
    assert full["Metal lost"] == "90.80 ± 0.51 mm³"
    assert {"Backlash, greatest", "Transmission error", "Thinnest tooth"} <= set(full)
    bare = {one.name for one in key_figures(bare_results())}
    assert bare == {"Section lost", "Thinnest tooth", "Error outside wear, RMS"}


@pytest.mark.parametrize(
    ("low", "high", "told"),
    [(9.650, 9.669, "9.6611 ± 0.0040 mm"), (9.640, 9.669, "9.640 to 9.669 mm"), (9.650, 9.699, "9.650 to 9.699 mm")],
    ids=["about even", "far below", "far above"],
)
def test_the_thinnest_tooth_is_an_interval_where_that_reaches_far_to_one_hand(low, high, told):
    assert thinnest_words(ThinnestTooth(1, 9.66111, 0.00402, low, high, 3.2, 9.975)).replace(SPACE, " ") == told


@pytest.mark.parametrize(("pit", "because"), [(8.0, "pits may be deeper"), (math.inf, ""), (8.394, "")])
def test_the_thinnest_tooth_as_an_interval_has_its_reason(pit, because):
    """Tooth 2 is 9.9746 mm less 1.58 thick: pits that go down to 8 mm say more of it than its standard deviation, to 8.394 mm they do not."""
    results = changed(fake_results(), "wear.thickness.pit_bottom", pit)
    (figure,) = (one for one in key_figures(results) if one.name == "Thinnest tooth")
    assert ((" to " in spoken(figure.value)), because in figure.note) == (bool(because), True)
    assert spoken(figure.note).startswith(f"tooth 2; {because}; at z" if because else "tooth 2 at z")


@pytest.mark.parametrize(("limits", "told"), [(None, ""), ((0.1159, 0.2591), "116 to 259 µm"), ((0.0, 0.259), "0 to 259 µm")])
def test_the_deepest_place_is_an_interval_where_more_than_its_deviation_is_open(limits, told):
    (region,) = fake_regions()[:1]
    results = SimpleNamespace(open_volume=SimpleNamespace(depth_limits=lambda one: limits if one is region else None))
    assert deepest_range(results, region).replace(SPACE, " ") == told


def test_every_cause_of_an_open_volume_has_words():
    """Wear too faint to be found alone is told otherwise."""
    assert set(QUESTIONS) == set(Open) - {Open.FAINT}
