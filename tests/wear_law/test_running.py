"""The forecast that runs on: what a run put in is asked back, and its growth with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.errors import InputError
from gearwear.wear_law import running
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.running import WearHistory, forecast_by_running, run_histories

DESIGN = gw.read_design(gw.example("design.toml"))
PAIR = DESIGN.gears["pinion"], DESIGN.gears["gear"], DESIGN.centre_distance
LOAD, SINGLE = 120.0, 0.015
"""N/mm; k w N after a million cycles, mm."""


@pytest.fixture(scope="module")
def histories() -> tuple[WearHistory, ...]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(running, "MATE_RATES", (0.0, 1.0))
        patch.setattr(running, "STIFFNESSES", (1.0,))
        return run_histories(*PAIR, LOAD, 6.0 * SINGLE / LOAD)


@pytest.mark.long
def test_a_run_put_in_is_run_on(histories, monkeypatch):
    """Growth to twice the cycles is that of the run itself, not of its rate so far."""
    monkeypatch.setattr(running, "run_histories", lambda *_: histories)
    now, later = (histories[0].at(np.array([n * SINGLE / LOAD]), histories[0].roll)[0] for n in (1.0, 2.0))
    fits = fit_wear_law(*PAIR, histories[0].roll, now, np.full(len(now), 3e-4))
    found = forecast_by_running(fits[0], 1e6, np.array([1e6, 2e6]), LOAD)
    assert found.by_running
    assert found.greatest_depth.value[0] == pytest.approx(now.max(), abs=1e-3)
    assert found.greatest_depth.low[1] < later.max() < found.greatest_depth.high[1]
    assert found.greatest_depth.value[1] == pytest.approx(later.max(), rel=0.06)
    # The law at a constant rate says half as much again.
    law = gw.forecast_wear(fits, 1e6, np.array([2e6])).greatest_depth.value[0]
    assert law > 1.2 * later.max()
    for band in (found.depth, found.greatest_depth, found.thickness_loss, found.backlash_increase):
        assert (band.low <= band.value).all() and (band.value <= band.high).all()
        assert (np.diff(band.value, axis=0) >= -1e-9).all()


def test_it_is_looked_further_where_the_likeliest_amount_is_the_most_looked_at(histories, monkeypatch):
    """A law that says a third of what was lost: the second look goes to 0.93 of it, the third finds it; an amount in reach is found at once."""
    asked = []

    def run(*given: object) -> tuple[WearHistory, ...]:
        asked.append(given[4])
        return histories[:1]

    monkeypatch.setattr(running, "run_histories", run)
    now = histories[0].at(np.array([SINGLE / LOAD]), histories[0].roll)[0]
    fit = fit_wear_law(*PAIR, histories[0].roll, now, np.full(len(now), 3e-4))[0]
    cycles = np.array([2e6])
    plain = forecast_by_running(fit, 1e6, cycles, LOAD).greatest_depth
    assert len(asked) == 1
    monkeypatch.setattr(type(fit), "amount", SINGLE / 3.0)
    far = forecast_by_running(fit, 1e6, cycles, LOAD).greatest_depth
    assert np.array(asked[1:]) / asked[1] == pytest.approx([1.0, 2.0, 4.0])
    assert far.value == pytest.approx(plain.value, rel=0.03)


def test_the_band_holds_a_tenth_of_what_is_still_to_come(histories, monkeypatch):
    """Of one run, whose profile is known to 0.3 µm, it is ± 1.96 × 10 % of the growth where points are."""
    monkeypatch.setattr(running, "run_histories", lambda *_: histories[:1])
    now = histories[0].at(np.array([SINGLE / LOAD]), histories[0].roll)[0]
    fit = fit_wear_law(*PAIR, histories[0].roll, now, np.full(len(now), 3e-4))[0]
    found = forecast_by_running(fit, 1e6, np.array([1e6, 3e6]), LOAD)
    place = int(np.searchsorted(found.roll, fit.roll[1]))
    value, low, high = (band[:, place] for band in (found.depth.value, found.depth.low, found.depth.high))
    growth = value[1] - value[0]
    assert growth > 0.01
    # the amount so far is open too, so that it is somewhat more
    assert 1.8 * 0.1 * growth < 0.5 * (high[1] - low[1]) < 2.6 * 0.1 * growth


def test_beyond_the_points_the_depth_is_known_the_less_the_farther_they_are(histories, monkeypatch):
    """A tenth of the depth and 0.7 µm, alike over 2 mm: 1 mm beyond the last point √(1 − e⁻¹) of it is left, at once; at the points nothing is."""
    monkeypatch.setattr(running, "run_histories", lambda *_: histories[:1])
    monkeypatch.setattr(running, "_weighed", lambda *_: (np.array([SINGLE / LOAD]), np.ones((1, 1))))
    run, start = histories[0], histories[0].roll[0]
    roll = np.linspace(start + 1.0, run.roll[-1], 80)
    fit = fit_wear_law(*PAIR, roll, run.at(np.array([SINGLE / LOAD]), roll)[0], np.full(80, 1e-5))[0]
    found = forecast_by_running(fit, 1e6, np.array([1e6]), LOAD)
    half = 0.5 * (found.depth.high - found.depth.low)[0]
    at = int(np.abs(found.roll - (fit.roll[0] - 1.0)).argmin())
    away = fit.roll[0] - found.roll[at]
    assert away > 0.7
    wanted = 1.96 * np.hypot(0.1 * found.depth.value[0, at], 0.0007) * np.sqrt(1.0 - np.exp(-away))
    assert half[at] == pytest.approx(wanted, rel=0.12)  # of 600 draws
    assert half[np.searchsorted(found.roll, fit.roll[3])] < 0.1 * wanted


def test_the_mate_shows_in_the_profile(histories):
    """Weights tell a mate that wears as fast from a hard one, where the profile does."""
    for index, history in enumerate(histories):
        depth = history.at(np.array([2.0 * SINGLE / LOAD]), history.roll)[0]
        fit = fit_wear_law(*PAIR, history.roll, depth, np.full(len(depth), 2e-4))[0]
        _, weights = running._weighed(fit, histories, 3.0 * SINGLE / LOAD)
        assert weights.sum() == pytest.approx(1.0)
        assert int(weights.sum(axis=1).argmax()) == index
        other = [one.mate_rate != history.mate_rate for one in histories]
        assert weights[other].sum() >= 0.1 / 1.1 - 1e-9  # what the profile says of the mate is never taken for sure


@pytest.mark.long
def test_a_misaligned_pair_is_run_on_as_its_mean_over_the_face(monkeypatch):
    """Which end is open makes no difference to the mean; nor does misalignment where one pair carries alone: the force is the same."""
    monkeypatch.setattr(running, "MATE_RATES", (0.0,))
    monkeypatch.setattr(running, "STIFFNESSES", (1.0,))
    monkeypatch.setattr(running, "_MOMENTS", 3)
    longest = 0.4 * SINGLE / LOAD
    up, down, aligned = (run_histories(*PAIR, LOAD, longest, misalignment=gap) for gap in (0.03, -0.03, 0.0))
    alone = (up[0].roll > 10.0) & (up[0].roll < 16.0)
    for one, other, even in zip(up, down, aligned, strict=True):
        assert one.depth == pytest.approx(other.depth, abs=1e-9)
        assert one.corners is even.corners
        mean = even.depth[-1][alone]
        assert one.depth[-1][alone] == pytest.approx(mean, abs=0.03 * mean.max())


def test_corners_that_dig_and_such_that_do_not_are_both_run(histories):
    """Early contact takes some of the load off the first places of single contact."""
    sharp, blunt = (next(h for h in histories if h.corners is c and h.mate_rate == 0.0) for c in (True, False))
    first = [one.at(np.array([0.1 * SINGLE / LOAD]), np.array([8.0]))[0, 0] for one in (sharp, blunt)]
    assert first[1] > 1.05 * first[0]


def test_bad_input_is_named(histories):
    depth = histories[0].at(np.array([SINGLE / LOAD]), histories[0].roll)[0]
    fit = fit_wear_law(*PAIR, histories[0].roll, depth, np.full(len(depth), 3e-4))[0]
    with pytest.raises(InputError, match="load and cycles run above 0"):
        forecast_by_running(fit, 1e6, np.array([2e6]), 0.0)
    with pytest.raises(InputError, match="cycles not below those run"):
        forecast_by_running(fit, 1e6, np.array([5e5]), LOAD)


def test_what_the_drawing_modifies_along_the_face_is_run_with(monkeypatch):
    """A lean of the mate is a gap: the mean over the face is that of a plain pair askew by as much."""
    monkeypatch.setattr(running, "MATE_RATES", (0.0,))
    monkeypatch.setattr(running, "STIFFNESSES", (1.0,))
    monkeypatch.setattr(running, "_MOMENTS", 3)
    pinion, gear, centre = PAIR
    lean = FlankModification(helix_slope=0.03)
    leaning = Gear.from_spec(replace(gear.spec, left=lean, right=lean))
    longest = 0.4 * SINGLE / LOAD
    askew = run_histories(*PAIR, LOAD, longest, misalignment=0.03)
    for as_drawn, plain in zip(run_histories(pinion, leaning, centre, LOAD, longest), askew, strict=True):
        assert as_drawn.depth == pytest.approx(plain.depth, abs=1e-8)
