"""How the pair ran, asked back of maps that another model of elastic teeth has worn."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.running.conditions import Conditions
from gearwear.running.effects import running_effects
from gearwear.running.effects.base import OtherSideEffect, RoundEffect, RunEffect
from gearwear.running.fit import RunModel, doubted, whole_errors
from gearwear.running.forecast import shown_gap
from gearwear.running.found import SecondLoop
from gearwear.running.search import _grown
from tests.running.maps import LOAD, SINGLE_UM, map_of, on_map, shared_runs, traced
from tests.synthetic.ran import RanWear

EFFECTS = {effect.name: effect for effect in running_effects()}
SHARED = RanWear(single_um=SINGLE_UM, load=LOAD)


@cache
def askew(gap_um: float) -> SecondLoop:
    return traced(replace(SHARED, gap_um=gap_um, softness=0.9, coupling=1.0), seed=3)


@pytest.mark.long
def test_misalignment_is_named_with_its_size_and_the_end_that_is_open():
    gap = 30.0
    found = askew(gap).effect("misalignment")
    assert found is not None
    size = found.parameters["gap_um"]
    assert isinstance(size.value, float) and isinstance(size.std, float)
    assert abs(size.value - gap) < min(10.0, 3.0 * size.std)
    assert found.alternatives[:1] == ("helix_slope",)  # it can never be told from that of either gear as made


@pytest.mark.long
def test_the_error_falls_on_what_the_fit_never_saw():
    found = askew(30.0)
    for before, after in zip(_held_out(found, "before"), _held_out(found, "after"), strict=True):
        assert after < 0.4 * before


def _held_out(found: SecondLoop, when: str) -> tuple[float, float, float]:
    errors = getattr(found, when)
    return errors.teeth, errors.face, errors.double_contact


@pytest.mark.parametrize("seed", [1, 2])
def test_nothing_askew_is_named_where_the_pair_ran_aligned(seed: int):
    found = traced(replace(SHARED, softness=1.0 + 0.15 * (-1) ** seed, coupling=0.9 + 0.2 * seed), seed)
    assert {one.name for one in found.effects} <= {"elastic_sharing"}


@pytest.mark.long
def test_a_mate_that_wears_too_is_told_where_its_wear_takes_the_gap_away():
    """Both flanks of an askew pair wear into each other; an aligned pair hardly tells."""
    found = traced(replace(SHARED, gap_um=30.0, mate_rate=1.0), seed=4)
    wore, askew_too = found.effect("mate_wear"), found.effect("misalignment")
    assert wore is not None and askew_too is not None
    rate, gap = wore.parameters["rate"], askew_too.parameters["gap_um"]
    assert abs(rate.value - 1.0) < 3.0 * rate.std  # type: ignore[operator]
    assert abs(gap.value - 30.0) < min(10.0, 3.0 * gap.std)  # type: ignore[operator,type-var]


@pytest.mark.long
def test_the_forecast_runs_with_the_gap_that_shows_though_the_mates_wear_does_not_stand_out():
    """Put in: 20 µm and a mate 0.8 times as soft, of which these flanks wear 11 µm off."""
    found = traced(replace(SHARED, gap_um=20.0, mate_rate=0.8), seed=1)
    assert found.effect("mate_wear") is None and found.conditions.mate_rate > 0.0
    assert 1e3 * shown_gap(found) == pytest.approx(20.0 / 1.8, abs=3.0)


@pytest.mark.long
def test_tips_of_the_mate_that_come_in_early_are_told_with_how_much():
    """The generator's mate has a base pitch by so much the greater: no tip corner, no finite element and no run is in it."""
    early = 20.0
    found = traced(replace(SHARED, early_um=early, softness=0.9, bridged=True), seed=5).effect("premature_tip_contact")
    assert found is not None and "profile_slope" in found.alternatives
    size = found.parameters["amount_um"]
    assert abs(size.value - early) < 3.0 * size.std < early  # type: ignore[operator]


@pytest.mark.parametrize(
    "other",
    [pytest.param({"early_um": -20.0}, marks=pytest.mark.long), {"mate_rate": 1.0}, {"softness": 1.2}],
    ids=["late", "mate", "soft"],
)
def test_what_else_changes_the_load_at_the_ends_is_no_premature_contact(other: dict[str, float]):
    """Tips that come in late, as relieved ones do; a mate that wears; teeth that bend more, or a greater load."""
    assert traced(replace(SHARED, bridged=True, **other), seed=6).effect("premature_tip_contact") is None  # type: ignore[arg-type]


@pytest.mark.parametrize("drawn", [0.0, 0.004])
def test_a_mate_made_ahead_has_a_base_pitch_by_so_much_the_greater(drawn: float):
    """Of its flanks as made, along the base tangent a base pitch apart; what is drawn stays, and the tip is drawn no other relief."""
    runs, ahead = shared_runs(), 0.02
    spec = runs.mate.spec
    sloped = Gear.from_spec(
        replace(spec, left=replace(spec.left, profile_slope=drawn), right=replace(spec.right, profile_slope=drawn))
    )
    roll = runs.mate.tip_roll - np.array([0.5, 0.5 + runs.mate.base_pitch])
    radius = np.hypot(runs.mate.base_radius, roll)
    made = replace(runs, mate=sloped)._made(Conditions(mate_ahead=ahead))
    for side in Side:
        at = [gear.half_angles(radius, np.array([7.5]))[side.index, 0] for gear in (made, sloped)]
        grown = runs.mate.base_radius * (at[0] - at[1])
        assert grown[0] - grown[1] == pytest.approx(ahead, rel=1e-6)


@pytest.mark.long
def test_teeth_that_lost_more_once_round_are_told_and_a_lean_that_only_goes_with_them_is_not():
    """Depths as 1 + 0.3 cos(θ − 60°): every tooth leans in proportion, which is no bent shaft."""
    angle = np.arange(12) * np.pi / 6.0
    factors = tuple((1.0 + 0.3 * np.cos(angle - np.pi / 3.0)).tolist())
    found = traced(replace(SHARED, gap_um=30.0, factors=factors), seed=5)
    turned = found.effect("eccentric_running")
    assert turned is not None and found.effect("bent_shaft") is None
    mean = 1e3 * found.map.mean.mean()
    assert turned.parameters["amplitude_um"].value == pytest.approx(0.3 * mean, rel=0.1)
    assert turned.parameters["direction_deg"].value == pytest.approx(60.0, abs=5.0)


def test_a_gap_the_other_way_wears_the_flank_the_other_way_up():
    """The face has no upper end of its own: a mirrored map has the opposite gap and the same error."""
    place = map_of(replace(SHARED, gap_um=30.0), seed=6)
    mirrored = replace(place, depth=place.depth[:, ::-1])
    up, down = (on_map(one).effect("misalignment") for one in (place, mirrored))
    assert up is not None and down is not None
    assert down.parameters["gap_um"].value == pytest.approx(-float(up.parameters["gap_um"].value), abs=0.1)  # type: ignore[arg-type]
    assert down.after.all == pytest.approx(up.after.all, rel=1e-3)


@pytest.mark.long
def test_between_runs_depths_are_linear_to_some_tenths_of_a_micrometre():
    runs, effect = shared_runs(), EFFECTS["misalignment"]
    assert isinstance(effect, RunEffect)
    model = RunModel(runs, (effect,), (2,))
    halfway = model._between((2,), [0.5])
    exact = runs.of(Conditions(misalignment=2.5 * effect.step))
    assert np.abs(halfway - exact).max() < 0.0015
    assert np.sqrt(np.mean((halfway - exact) ** 2)) < 0.0003


def test_the_stated_deviation_is_that_of_repeated_measurements(monkeypatch: pytest.MonkeyPatch):
    """Depths of a run with errors drawn from what the fit holds them to be: the sizes scatter as stated, without what other compliances add."""
    place = map_of(SHARED)
    runs, effect = shared_runs(), EFFECTS["misalignment"]
    assert isinstance(effect, RunEffect)
    model, errors = RunModel(runs, (effect,), (2,)), whole_errors(place)
    true = runs.of(Conditions(misalignment=2.0 * effect.step))[6]
    root, random = np.linalg.cholesky(errors), np.random.default_rng(8)
    every = np.ones(len(true), dtype=bool)
    fits = [model.fit(true + root @ random.normal(size=len(true)), errors, every) for _ in range(25)]
    scatter = float(np.std([fit.sizes[0] for fit in fits]))
    assert np.mean([fit.sizes[0] for fit in fits]) == pytest.approx(2.0 * effect.step, abs=3.0 * scatter / np.sqrt(25))
    with_others = float(np.sqrt(model.covariance(fits[0], errors)[0, 0]))
    monkeypatch.setattr("gearwear.running.fit.doubted", lambda usual: ())
    by_errors = float(np.sqrt(model.covariance(fits[0], errors)[0, 0]))
    assert 0.7 * scatter < by_errors < 1.5 * scatter  # of 25
    assert with_others > by_errors


def test_each_doubt_moves_the_size_by_what_a_fit_of_it_is_off(monkeypatch: pytest.MonkeyPatch):
    """Depths of another compliance, coupling and corner, fitted with the usual ones: the size is off by what the ± allows for, to first order."""
    runs, effect = shared_runs(), EFFECTS["misalignment"]
    assert isinstance(effect, RunEffect)
    model, errors = RunModel(runs, (effect,), (2,)), whole_errors(map_of(SHARED))
    true, every = Conditions(misalignment=2.0 * effect.step), np.ones(errors.shape[0], dtype=bool)
    fit, amount = model.fit(runs.of(true)[6], errors, every), 6
    several = doubted(true)
    assert [one for one in several if one != true] == list(several) and len(several) == 3
    for one in several:
        monkeypatch.setattr("gearwear.running.fit.doubted", lambda usual: ())
        plain = model.covariance(fit, errors)[0, 0]
        monkeypatch.setattr("gearwear.running.fit.doubted", lambda usual, one=one: (one,))
        allowed = np.sqrt(model.covariance(fit, errors)[0, 0] - plain)
        off = abs(model.fit(runs.of(one)[amount], errors, every).sizes[0] - true.misalignment)
        assert off == pytest.approx(allowed, abs=0.0007)


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_an_effect_says_all_of_itself(name: str):
    effect = EFFECTS[name]
    told = effect.phrase.format(**{one.name: "5" for one in effect.parameters})
    assert "{" not in told and effect.tells_apart.endswith(".")
    if isinstance(effect, RunEffect):
        assert len(effect.parameters) == (effect.step > 0.0)
        assert effect.applied(Conditions(), 0.0) == Conditions()
        assert effect.least <= 0.0 <= effect.most
    elif isinstance(effect, OtherSideEffect):
        assert [one.name for one in effect.parameters] == ["share"]
    else:
        assert isinstance(effect, RoundEffect)
        assert [one.name for one in effect.parameters] == ["amplitude_um", "direction_deg"]


def test_what_was_not_named_may_be_there_all_the_same():
    """The ± with a mate that may wear is the greater one; as nothing is held possible of it, it is the fit's own."""
    runs, effect, mate = shared_runs(), EFFECTS["misalignment"], EFFECTS["mate_wear"]
    assert isinstance(effect, RunEffect) and isinstance(mate, RunEffect)
    model, errors = RunModel(runs, (effect,), (2,)), whole_errors(map_of(SHARED))
    fit = model.fit(runs.of(Conditions(misalignment=0.03))[6], errors, np.ones(errors.shape[0], dtype=bool))
    plain = model.covariance(fit, errors)
    whole = model.covariance(fit, errors, [mate])
    assert plain.shape == (1, 1) and whole.shape == (2, 2)
    assert whole[0, 0] > plain[0, 0] and 0.05**2 < whole[1, 1] < mate.doubt**2

    class Impossible(type(mate)):
        doubt = 1e-6

    assert model.covariance(fit, errors, [Impossible()])[:1, :1] == pytest.approx(plain, rel=1e-6)


@pytest.mark.parametrize("corners", [True, False])
def test_of_sharp_corners_and_none_the_one_that_fits_is_run_with(corners: bool):
    runs = shared_runs()
    depth = runs.of(Conditions(corners=corners))[6]
    place = replace(map_of(SHARED), depth=np.broadcast_to(depth.reshape(5, 12), (12, 5, 12)).copy())
    sized = [effect for effect in running_effects() if isinstance(effect, RunEffect) and effect.step > 0.0]
    errors, every = place.errors, np.ones(len(depth), dtype=bool)
    (first, *_) = _grown(
        replace(runs, map=place), sized[:0], lambda model: model.fit(depth, errors, every), lambda _, fit: fit.cost
    )
    assert first.model.usual.corners is corners and first.fit.cost < 1e-6
