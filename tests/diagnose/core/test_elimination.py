"""What `eliminate` keeps and drops: for each rule a case that needs it, and one beside it that must not trigger it.

The cells are the tooth sides of a pinion; the effects are toy fields of height, place along the profile, side and tooth.
"""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.elimination import eliminate
from tests.diagnose.core.toy import TEETH, Toy, fit_of, grid, sides_of

NOISE, COUNT = 0.005, 20.0
AT = sides_of(grid())
U, ZETA = 2.0 * AT.across - 1.0, 2.0 * AT.z - 1.0
SIGN = np.where(AT.left, 1.0, -1.0)
ANGLE = 2.0 * np.pi * AT.tooth / TEETH


def named(found):
    """The effects that may be named."""
    return [candidate for candidate, one in zip(found.model, found.evidence, strict=True) if not one.faint]


def stood(true, *blocks, seed=1, unit=1.0):
    """Names of the effects that stand, and the orders of the patterns, for a field in mm and toys with their sheets (…, p)."""
    rng = np.random.default_rng(seed)
    deviation = true + NOISE / np.sqrt(COUNT) * rng.normal(size=AT.z.shape)
    sheets = [(toy, field if field.ndim == 5 else field[..., None]) for toy, field in blocks]
    fit = fit_of(grid(), deviation, sheets, NOISE, COUNT, turns=True)
    found = eliminate(fit, fit.problem(unit, None), fit.dictionary.candidates, NOISE)
    return {candidate.name for candidate in named(found)}, [pattern.order for pattern in found.patterns]


# What fails its own evidence.


def test_what_explains_only_noise_falls_and_what_is_there_stands():
    assert stood(0.01 * U, (Toy("there"), U), (Toy("not there"), ZETA), (Toy("nor this"), U * ZETA)) == ({"there"}, [])


@pytest.mark.long
def test_of_nothing_nothing_stands():
    kept = [stood(0.0 * U, (Toy("a"), U), (Toy("b"), ZETA), (Toy("c"), SIGN * U), seed=seed)[0] for seed in range(20)]
    assert sum(map(len, kept)) == 0


def test_what_some_teeth_alone_have_falls_beside_what_each_has_of_its_own_too():
    """Left out are blocks of every tooth then, and the rest of a worn tooth shows what is in its blocks: 20 µm on 6 of 21 flanks was a slope and a relief."""
    own = np.stack([np.where(AT.tooth == tooth, SIGN, 0.0) for tooth in range(TEETH)], axis=-1)
    index = 0.01 * np.random.default_rng(3).normal(size=TEETH)[AT.tooth] * SIGN
    toys = (Toy("shared"), U * ZETA), (Toy("own", tooth_specific=True), own)
    some = np.where(np.isin(AT.tooth, (1, 4, 9)), 0.004 * U * ZETA, 0.0)
    assert stood(index + some, *toys)[0] == {"own"}
    assert stood(index + 0.001 * U * ZETA, *toys)[0] == {"shared", "own"}  # as much, on all teeth


def test_an_effect_too_small_for_the_scan_is_not_named_though_it_is_told():
    """A hundredth of the noise of a point is below what a scan may name, however many points there are; the gear has it all the same."""
    small = 0.01 * NOISE * U / np.sqrt(np.mean(U**2))
    scatter = 1e-4 * NOISE * np.random.default_rng(1).normal(size=U.shape)
    for factor, count in ((1.0, 0), (20.0, 1)):
        fit = fit_of(grid(), factor * small + scatter, [(Toy("small"), U[..., None])], NOISE, 1e8)
        found = eliminate(fit, fit.problem(1.0, None), fit.dictionary.candidates, NOISE)
        assert len(found.model) == 1
        assert len(named(found)) == count


def test_what_is_too_small_to_be_named_makes_no_other_uneven():
    """A lead of both sides, and a bulge over it: without the lead the bulge is larger at one end than at the other."""
    bulge, lead = 1.0 - ZETA**2, 0.1 * NOISE * ZETA
    scatter = 1e-4 * NOISE * np.random.default_rng(2).normal(size=U.shape)
    toys = [(Toy("bulge"), bulge[..., None]), (Toy("lead"), ZETA[..., None])]
    fit = fit_of(grid(), 0.22 * NOISE * bulge + lead + scatter, toys, NOISE, 1e8)
    found = eliminate(fit, fit.problem(1.0, None), fit.dictionary.candidates, NOISE)
    assert {c.name for c in named(found)} == {"bulge"}
    assert {c.name for c, one in zip(found.model, found.evidence, strict=True) if one.faint} == {"lead"}


def test_what_left_out_teeth_do_not_confirm_falls():
    """One torn tooth draws an effect that all teeth should share."""
    torn = np.where(AT.tooth == 3, 0.03 * U * ZETA, 0.0)
    assert stood(torn, (Toy("shared"), U * ZETA))[0] == set()
    assert stood(0.0025 * U * ZETA, (Toy("shared"), U * ZETA))[0] == {"shared"}  # as much, on all teeth


def test_the_one_that_is_not_there_goes_first_and_gives_its_share_back():
    """Beside a twin of its own the true effect looks weak; once the twin is gone it stands."""
    twin = U + 0.2 * ZETA * U
    assert stood(0.01 * U, (Toy("true"), U), (Toy("twin"), twin))[0] == {"true"}


# Effects of which others take most back.


def test_two_that_cancel_but_for_a_small_rest_are_not_both_named():
    rest = U**3 - 0.6 * U
    pair = [(Toy("one"), U), (Toy("other"), U + 0.05 * rest)]
    kept, _ = stood(0.004 * rest, *pair)
    assert len(kept) < 2


@pytest.mark.parametrize(("tolerance", "named"), [(0.05, {"end"}), (0.02, {"coat", "thin"})])
def test_what_the_drawing_leaves_open_is_no_coat_on_thin_teeth(tolerance, named):
    """The upper third leans by 30 µm: by itself, as far as the drawing allows that, or as a coat on teeth that are thin by as much."""
    upper = AT.z > 2.0 / 3.0
    end, rest = np.where(upper, U, 0.0), np.where(upper, 0.0, U)
    blocks = [(Toy("coat"), end + rest), (Toy("thin"), -rest), (Toy("end", kind=Kind.FORM, limit=tolerance), end)]
    rng = np.random.default_rng(2)
    deviation = 0.03 * end + NOISE / np.sqrt(COUNT) * rng.normal(size=end.shape)
    fit = fit_of(grid(), deviation, [(toy, field[..., None]) for toy, field in blocks], NOISE, COUNT)
    problem = fit.problem(1.0, None)
    found = eliminate(fit, problem, fit.dictionary.candidates[:2], NOISE)
    assert {candidate.name for candidate in found.model} == named


@pytest.mark.parametrize(
    ("second", "named"), [(0.030, {"coat", "thin"}), (0.036, {"tip", "end", "bottom"})], ids=["alike", "not alike"]
)
def test_what_lies_off_by_the_same_everywhere_is_a_coat_though_the_drawing_leaves_it_open(second, named):
    """Three surfaces off by the same amount, each within its tolerance: one cause beside thin teeth, where three chances would have to agree."""
    third = np.minimum((3.0 * AT.z).astype(int), 2)
    tip, end, bottom = (np.where(third == number, np.abs(U), 0.0) for number in range(3))
    flank = np.broadcast_to(np.where(AT.across > 0.5, 1.0, 0.0), U.shape)
    outside = [field * (1.0 - flank) for field in (tip, end, bottom)]
    coat = sum(outside) + flank
    levels = [
        (Toy(name, kind=Kind.FORM, limit=0.05), field) for name, field in zip(("tip", "end", "bottom"), outside, strict=True)
    ]
    blocks = [(Toy("coat"), coat), (Toy("thin"), -flank), *levels]
    rng = np.random.default_rng(2)
    deviation = 0.03 * outside[0] + second * outside[1] + 0.03 * outside[2] + NOISE / np.sqrt(COUNT) * rng.normal(size=U.shape)
    fit = fit_of(grid(), deviation, [(toy, field[..., None]) for toy, field in blocks], NOISE, COUNT)
    found = eliminate(fit, fit.problem(1.0, None), fit.dictionary.candidates[:2], NOISE)
    assert {candidate.name for candidate in found.model} == named


@pytest.mark.parametrize("specific", [True, False])
def test_amounts_of_each_tooth_and_what_they_take_back_do_not_both_stand(specific):
    """A wave of two round the gear, as two steps each twice its size one against the other: of each, two fifths are its own."""
    step = np.where(AT.tooth < TEETH // 2, 1.0, -1.0) + 0.0 * U
    wave = np.cos(2.0 * ANGLE) + 0.0 * U
    pair = (Toy("view"), step), (Toy("each", tooth_specific=specific), step + 0.45 * np.sqrt(2.0) * wave)
    assert (len(stood(0.004 * wave, *pair)[0]) < 2) == specific
    assert len(stood(0.004 * (step + pair[1][1]), *pair)[0]) == 2  # the same two, one way round


def test_two_that_add_both_stand():
    rest = U**3 - 0.6 * U
    assert stood(0.01 * U + 0.004 * rest, (Toy("one"), U), (Toy("other"), rest))[0] == {"one", "other"}


def test_a_small_correction_of_a_large_effect_may_lean_on_it():
    """A tenth of a large field in its direction: the correction explains most of its own size, and both are there."""
    other = U * ZETA + 0.5 * U
    assert stood(0.02 * U + 0.004 * other, (Toy("large"), U), (Toy("correction"), other))[0] == {"large", "correction"}


def test_three_that_draw_a_curve_between_them_that_none_of_them_is_do_not_all_stand():
    """A ripple of one and a half waves along the profile, as slopes and bows of many times its size."""
    ripple = np.cos(3.0 * np.pi * AT.across)
    powers = [(Toy(f"power {k}"), np.maximum(AT.across - start, 0.0)) for k, start in enumerate((-0.001, 0.2, 0.4, 0.6, 0.8))]
    kept, orders = stood(0.005 * ripple, *powers)
    assert len(kept) < 3
    assert 0 in orders  # and what they leave is said to be unexplained


# Effects that one half of the gear shows and the other does not.


@pytest.mark.parametrize(
    "half", [lambda: AT.z < 0.5, lambda: AT.left, lambda: AT.across > 0.55], ids=["height", "side", "profile"]
)
def test_an_effect_of_another_size_on_one_half_falls(half):
    wave = np.cos(3.0 * ANGLE)
    for other, stands in ((0.0, set()), (0.5, set()), (0.85, {"wave"})):
        assert stood(np.where(half(), 1.0, other) * 0.015 * wave, (Toy("wave"), wave))[0] == stands
    assert stood(0.015 * wave, (Toy("wave"), wave)) == ({"wave"}, [])


def test_an_effect_that_has_its_own_size_on_each_side_is_not_uneven():
    wave = np.cos(3.0 * ANGLE)
    both = np.stack([np.where(AT.left, wave, 0.0), np.where(AT.left, 0.0, wave)], axis=-1)
    assert stood(np.where(AT.left, 0.015, 0.006) * wave, (Toy("sides"), both)) == ({"sides"}, [])


def test_wear_of_one_side_may_be_uneven():
    loss = np.where(AT.left, -((1.0 - AT.across) ** 4), 0.0)
    more_below = 0.04 * loss * np.where(AT.z < 0.5, 1.0, 0.62)
    assert stood(more_below, (Toy("wear", kind=Kind.WEAR), loss))[0] == {"wear"}
    assert stood(more_below, (Toy("made", kind=Kind.MANUFACTURE), loss))[0] == set()


# Effects that are a piece of a pattern that no effect explains.


def bands():
    """Bands along the face that have no mean on either half of it."""
    wave, low = np.cos(4.0 * np.pi * AT.z), AT.z < 0.5
    return wave - np.where(low, wave[low].mean(), wave[~low].mean())


def test_a_wave_beside_a_larger_pattern_of_its_order_falls():
    wave = np.cos(4.0 * ANGLE)
    pattern = 0.006 * wave * bands()
    kept, orders = stood(pattern + 0.003 * wave, (Toy("wave"), wave))
    assert kept == set() and orders[0] == 4


def test_a_wave_much_larger_than_the_pattern_of_its_order_stands():
    wave = np.cos(4.0 * ANGLE)
    pattern = 0.003 * wave * bands()
    kept, orders = stood(pattern + 0.03 * wave, (Toy("wave"), wave))
    assert kept == {"wave"} and 4 in orders


def test_what_falls_as_a_piece_of_a_pattern_speaks_against_no_other():
    """A slope along the profile, and two smaller effects of all teeth beside a ripple that none of them is: these are dropped as pieces of it, and what
    they leave makes it larger than half of the slope; what the whole model left is not."""
    ripple = 0.004 * np.cos(3.5 * np.pi * AT.across)
    small = [(Toy("bow"), U**2 - np.mean(U**2)), (Toy("twist"), U * ZETA)]
    made = 0.011 * U + 0.006 * small[0][1] + 0.004 * U * ZETA
    kept, orders = stood(made + ripple, (Toy("slope"), U), *small)
    assert kept == {"slope"} and orders == [0]


def test_a_lead_is_no_piece_of_a_ripple_along_the_profile_but_of_steps_along_the_face():
    """Of what the maker does; what only looks like a lead, of an instrument, falls beside either."""
    lead = (Toy("lead", kind=Kind.MANUFACTURE), ZETA)
    ripple, steps = 0.004 * np.cos(3.5 * np.pi * AT.across), 0.006 * np.sign(np.sin(4.0 * np.pi * AT.z))
    assert stood(0.004 * ZETA + ripple, lead) == ({"lead"}, [0])
    assert stood(0.004 * ZETA + steps, lead) == (set(), [0])
    assert stood(0.004 * ZETA + ripple, (Toy("askew", kind=Kind.MOUNTING), ZETA)) == (set(), [0])


def test_a_pattern_of_another_order_harms_no_effect():
    pattern = 0.006 * np.cos(4.0 * ANGLE) * np.cos(3.0 * np.pi * AT.z)
    wave = np.cos(2.0 * ANGLE)
    kept, orders = stood(pattern + 0.004 * wave, (Toy("wave"), wave))
    assert kept == {"wave"} and orders == [4]


def teeth():
    """A freedom for each tooth but the last, mean 0."""
    own = (AT.tooth[..., None] == np.arange(TEETH)).astype(float) * SIGN[..., None]
    return own[..., :-1] - own[..., -1:]


def test_a_freedom_for_every_tooth_stands_where_the_teeth_differ_and_falls_where_a_wave_grows_up_them():
    offsets = np.random.default_rng(5).normal(size=TEETH)
    pitch = Toy("pitch", tooth_specific=True)
    assert stood(0.01 * SIGN * (offsets - offsets.mean())[AT.tooth], (pitch, teeth()))[0] == {"pitch"}
    growing = 0.004 * SIGN * np.cos(3.0 * ANGLE) * (1.0 + 2.0 * U)
    kept, orders = stood(growing, (pitch, teeth()))
    assert kept == set() and orders[0] == 3


# Bookkeeping.


def test_the_order_of_the_effects_does_not_matter():
    blocks = [(Toy("a"), U), (Toy("b"), ZETA), (Toy("c"), U * ZETA), (Toy("none"), ZETA**2)]
    true = 0.01 * U - 0.004 * ZETA + 0.006 * U * ZETA
    assert stood(true, *blocks) == stood(true, *blocks[::-1]) == ({"a", "b", "c"}, [])


def test_what_was_known_before_is_handed_on():
    noise = NOISE / np.sqrt(COUNT) * np.random.default_rng(6).normal(size=U.shape)
    fit = fit_of(grid(), 0.005 * np.cos(2.0 * ANGLE) + noise, [(Toy("a"), U[..., None])], NOISE, COUNT)
    first = eliminate(fit, fit.problem(1.0, None), (), NOISE)
    rest = replace(fit, target=fit.target - first.patterns[0].field)
    again = eliminate(rest, rest.problem(1.0, None), (), NOISE, first.patterns)
    assert [pattern.order for pattern in first.patterns] == [2]
    assert again.patterns[0] is first.patterns[0]
