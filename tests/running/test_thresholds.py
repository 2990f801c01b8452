"""When something is named: each threshold of the second loop from both of its sides, on numbers that are exact."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import f as fisher

from gearwear.running import search
from gearwear.running.conditions import Conditions
from gearwear.running.effects import running_effects
from gearwear.running.effects.base import RoundEffect, RunEffect
from gearwear.running.fit import MapFit, RunModel, doubted, whole_errors
from gearwear.running.found import Errors
from gearwear.running.other_side import on_the_other_side
from gearwear.running.search import _grown, _price, _round, _sized, _Step, _worth
from tests.running.maps import law_basis_and_alone, map_of, shared_runs
from tests.running.test_forecast import found
from tests.synthetic.ran import RanWear

EFFECTS = {effect.name: effect for effect in running_effects()}
GAP, MATE, RELIEF = (EFFECTS[name] for name in ("misalignment", "mate_wear", "mate_tip_relief"))
PLAIN = RanWear(single_um=6.0)


def errors(held_out: float) -> Errors:
    return Errors(1.0, held_out, held_out, held_out)


def test_an_effect_must_be_worth_two_standard_deviations_and_its_choice_and_lower_what_was_left_out():
    assert _price(4) == pytest.approx(4.0 + 2.0 * math.log(4.0)) and _price(1) == _price(2)
    assert _worth(-0.1, errors(1.0), errors(0.96)) and not _worth(-0.1, errors(1.0), errors(0.98))
    assert not _worth(0.1, errors(1.0), errors(0.5))


@dataclass(frozen=True)
class Stub:
    """A model whose sizes have a covariance that is known."""

    with_unnamed: float

    def covariance(self, fit: MapFit, errors: Any, unnamed: tuple[RunEffect, ...] = ()) -> Any:
        return np.diag([0.001**2, *(self.with_unnamed**2 for _ in unnamed)])

    effects = (GAP,)
    usual = Conditions()


@pytest.mark.parametrize(("stds", "named"), [(2.9, False), (3.1, True), (-3.1, True)])
def test_a_size_is_a_finding_from_three_standard_deviations_on(stds: float, named: bool):
    step: Any = _Step(Stub(0.5), MapFit((0.001 * stds,), 0.006, 1.0, np.zeros(1)), ())  # type: ignore[arg-type]
    kept = _sized([found("misalignment", gap_um=1.0), found("elastic_sharing")], step, np.zeros((1, 1)), [])
    assert [one.name for one in kept] == (["misalignment"] if named else []) + ["elastic_sharing"]


def test_the_deviation_told_holds_what_a_mate_that_was_not_named_takes_of_the_gap():
    """Gap told = gap shown (1 + rate): 30 µm and a rate of 0 ± 0.5 make ± 15 µm beside the fit's own 1 µm. What is a finding is not judged by it."""
    step: Any = _Step(Stub(0.5), MapFit((0.030,), 0.006, 1.0, np.zeros(1)), ())  # type: ignore[arg-type]
    (one,) = _sized([found("misalignment", gap_um=1.0)], step, np.zeros((1, 1)), [MATE])  # type: ignore[list-item]
    assert one.parameters["gap_um"].value == pytest.approx(30.0)
    assert one.parameters["gap_um"].std == pytest.approx(math.hypot(1.0, 15.0), rel=1e-6)


def grown(costs: dict[tuple[str, ...], float]) -> list[_Step]:
    """The search over effects whose costs are given by their names; 100 for others."""
    sized = [GAP, MATE, RELIEF]

    def fitted(model: RunModel) -> MapFit:
        return MapFit(
            (0.0,) * len(model.effects), 0.006, costs.get(tuple(sorted(one.name for one in model.effects)), 100.0), np.zeros(1)
        )

    return _grown(shared_runs(), sized, fitted, lambda effects, fit: fit.cost)  # type: ignore[arg-type]


@pytest.mark.parametrize(("apart", "alike"), [(3.9, ("mate_wear",)), (4.1, ())])
def test_effects_that_cost_about_the_same_are_not_told_apart(apart: float, alike: tuple[str, ...]):
    steps = grown({(): 90.0, ("misalignment",): 50.0, ("mate_wear",): 50.0 + apart})
    assert steps[1].alike == alike


def test_two_sizes_at_most():
    pairs = {("mate_wear", "misalignment"): 40.0, ("mate_tip_relief", "mate_wear", "misalignment"): 30.0}
    assert [len(step.effects) for step in grown({(): 90.0, ("misalignment",): 50.0, **pairs})] == [0, 1, 2]


@pytest.mark.parametrize(
    ("held_out", "named"),
    [
        ((7.0, 9.0, 8.0, 4.0), [GAP.name, MATE.name]),  # worth it only together
        ((7.0, 9.0, 5.0, 4.0), [GAP.name, MATE.name]),
        ((7.0, 6.0, 5.0, 4.0), ["elastic_sharing", GAP.name, MATE.name]),
        ((7.0, 6.0, 8.0, 4.0), ["elastic_sharing", GAP.name, MATE.name]),
        ((7.0, 6.0, 5.0, 6.0), ["elastic_sharing", GAP.name]),
    ],
)
def test_what_is_in_the_run_that_is_kept_is_named(held_out: tuple[float, ...], named: list[str], monkeypatch: pytest.MonkeyPatch):
    """Errors on what was left out of the law, of a run, of one with a gap and of one with a mate that wears too."""
    place = map_of(PLAIN)
    basis, runs, alone = law_basis_and_alone(place, shared_runs())
    nothing = np.zeros(len(place.mean))
    sizes: list[tuple[RunEffect, ...]] = [(), (GAP,), (GAP, MATE)]  # type: ignore[list-item]
    steps = [
        _Step(RunModel(runs, some), MapFit((0.02,) * len(some), 0.006, 9.0 - 8.0 * len(some) - 1e4, nothing), ())
        for some in sizes
    ]
    told = iter(map(errors, held_out))
    monkeypatch.setattr(search, "_grown", lambda *_: steps)
    monkeypatch.setattr(search, "_errors", lambda *_: next(told))
    monkeypatch.setattr(search, "_sized", lambda traced, *_: traced)
    found = search.find_running(place, basis, runs, alone)
    assert [one.name for one in found.effects] == named
    together = found.effects[-1]
    assert together.degrees[0] == (2 if held_out[2] == 8.0 else 1)


@pytest.mark.parametrize(
    ("p", "share", "teeth", "named"),
    [(0.004, 0.06, 12, True), (0.006, 0.06, 12, False), (0.001, 0.052, 12, True), (0.001, 0.048, 12, False), (0.001, 0.06, 6, False), (0.001, 0.06, 7, True)],
)  # fmt: skip
def test_a_first_order_is_named_from_its_chance_its_share_and_teeth_enough_on(p: float, share: float, teeth: int, named: bool):
    """Teeth that rise by a first order and scatter by a second: F = (a² / 2) / (b² / (n − 3)), its chance in closed form."""
    angle = 2.0 * np.pi * np.arange(teeth) / teeth
    pitch = replace(map_of(PLAIN).gear.spec, teeth=teeth)
    b = share / math.sqrt(2.0 * float(fisher.isf(p, 2, teeth - 3)) / (teeth - 3))
    means = 0.02 * (1.0 + share * np.cos(angle) + b * np.cos(2.0 * angle))
    gear = SimpleNamespace(pitch_angle=2.0 * np.pi / pitch.teeth)
    place: Any = SimpleNamespace(teeth=np.arange(teeth), gear=gear, tooth_means=lambda: (means, 0.1 * means))
    effect = EFFECTS["eccentric_running"]
    assert isinstance(effect, RoundEffect)
    got = _round(effect, place)
    assert (got is not None) is named
    if got is not None:
        assert got.p_value == pytest.approx(p, rel=1e-6) and got.parameters["amplitude_um"].value == pytest.approx(20.0 * share)


def test_what_no_model_has_is_a_tenth_alike_over_the_face_a_tenth_in_part_of_it_and_a_floor():
    """Of an even depth d, in closed form: place by place, and between places a strip, and a slice, apart."""
    depth, blank = 0.02, map_of(PLAIN)
    place = replace(blank, depth=np.full_like(blank.depth, depth))
    extra = whole_errors(place) - place.errors
    all_over, part = (0.1 * depth) ** 2 + 0.0007**2, (0.1 * depth) ** 2
    assert np.diag(extra) == pytest.approx(all_over + part)
    strips = len(place.roll) // place.slices
    along = math.exp(-abs(place.roll[1] - place.roll[0]) / (0.3 * 6.35))
    across = math.exp(-abs(place.height[strips] - place.height[0]) / 0.3)
    assert extra[0, 1] == pytest.approx((all_over + part) * along)
    assert extra[0, strips] == pytest.approx(all_over + part * across)


def test_doubted_are_teeth_a_quarter_softer_a_longer_coupling_and_the_other_corner():
    usual = Conditions(misalignment=0.02)
    softer, longer, corner = doubted(usual)
    assert softer.softness == 1.25 * usual.softness and longer.coupling_modules == 1.4 and corner.corners is not usual.corners
    assert all(one.misalignment == 0.02 for one in (softer, longer, corner))


def side(sliding: float, std: float = 0.001, explained: float = 0.9) -> Any:
    contact = SimpleNamespace(sliding=sliding, sliding_std=std)
    return SimpleNamespace(single_contact=contact, explained=(explained, 0.1), depth=np.full(4, 0.01), unexplained_depth=0.001)


@pytest.mark.parametrize(
    ("sliding", "other", "named"),
    [
        (0.030, side(0.0031), True), (0.030, side(0.0029), False),  # three standard deviations
        (0.060, side(0.0031, 1e-4), True), (0.060, side(0.0029, 1e-4), False),  # a twentieth
        (0.060, side(0.01, explained=0.51), True), (0.060, side(0.01, explained=0.49), False),
        (0.060, side(math.nan), False), (0.060, side(0.01, 0.0), False), (0.0, side(0.01), False),
    ],
)  # fmt: skip
def test_a_reversing_drive_is_named_from_three_deviations_a_twentieth_and_half_explained_on(
    sliding: float, other: Any, named: bool
):
    assert bool(on_the_other_side(side(sliding), other)) is named


def test_the_share_of_a_reversing_drive_has_the_relative_errors_of_both_sides():
    (one,) = on_the_other_side(side(0.060, 0.006), side(0.030, 0.002))
    share = one.parameters["share"]
    assert share.value == pytest.approx(0.5) and share.std == pytest.approx(0.5 * math.hypot(0.1, 1.0 / 15.0))
    assert one.p_value == pytest.approx(math.erfc(15.0 / math.sqrt(2.0)))
