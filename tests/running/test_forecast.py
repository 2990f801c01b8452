"""Whether a gear is run on as it ran: what is told to the run, and when the law's forecast stands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.loaded.steel import Material
from gearwear.running import forecast
from gearwear.running.conditions import Conditions
from gearwear.running.effects import running_effects
from gearwear.running.forecast import reached, run_on, shown_gap
from gearwear.running.found import Errors, FoundRunning, SecondLoop
from gearwear.wear_law.archard import specific_sliding
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.forecast import cycles_left, forecast_wear
from gearwear.wear_law.study import CyclesToLimit, WearStudy
from tests.running.maps import CENTRE, PAIR, map_of
from tests.synthetic.ran import RanWear

EFFECTS = {effect.name: effect for effect in running_effects()}
NOTHING = Errors(1.0, 1.0, 1.0, 1.0)


def found(name: str, **sizes: float) -> FoundRunning:
    effect = EFFECTS[name]
    parameters = {one.name: replace(one.estimate(0.001, 0.001), value=sizes[one.name]) for one in effect.parameters}
    return FoundRunning(
        effect=effect, parameters=parameters, alternatives=(), before=NOTHING, after=NOTHING, gain=10.0, degrees=(1, 1.0), p_value=0.01
    )  # fmt: skip


def second(*effects: FoundRunning, mate_rate: float = 0.0) -> SecondLoop:
    place = map_of(RanWear(single_um=6.0))
    return SecondLoop(
        map=place, effects=effects, before=NOTHING, after=NOTHING, law=place.mean, depth=place.mean, amount=0.006, chi_square=1.0,
        conditions=Conditions(mate_rate=mate_rate),
    )  # fmt: skip


@pytest.fixture(scope="module")
def study() -> WearStudy:
    roll = np.linspace(6.0, 26.0, 60)
    fits = fit_wear_law(*PAIR, CENTRE, roll, 0.005 * specific_sliding(*PAIR, CENTRE, roll), np.full(60, 1e-4))
    ahead = forecast_wear(fits, 1e6, np.array([1e6, 2e6]))
    return WearStudy(side=Side.LEFT, teeth=(0, 1, 2), left_out=(), fits=fits, why_not="", forecast=ahead)


def test_the_gap_that_shows_is_what_a_mate_that_wears_leaves_of_it():
    assert shown_gap(second()) == 0.0
    assert shown_gap(second(found("misalignment", gap_um=-30.0))) == pytest.approx(-0.030)
    for named in ((), (found("mate_wear", rate=1.0),)):
        both = second(found("misalignment", gap_um=60.0), *named, mate_rate=1.0)
        assert shown_gap(both) == pytest.approx(0.030)


def test_what_was_found_is_what_is_run_with(study: WearStudy, monkeypatch: pytest.MonkeyPatch):
    asked = []
    monkeypatch.setattr(forecast, "forecast_by_running", lambda *given, **more: asked.append((given, more)) or study.forecast)
    run_on(study, second(found("misalignment", gap_um=20.0)), 150.0, Material(70e3))
    ((given, more),) = asked
    assert given[1] == 1e6 and given[2].tolist() == [1e6, 2e6] and given[3:] == (150.0, Material(70e3))
    assert more == {"misalignment": pytest.approx(0.020), "side": Side.LEFT}


def test_the_laws_forecast_stands_where_no_run_explains_the_wear_or_none_was_measured_so_far(study: WearStudy, monkeypatch):
    monkeypatch.setattr(forecast, "forecast_by_running", lambda *_, **__: pytest.fail("nothing is to be run"))
    ran = second(found("elastic_sharing"))
    round_only = second(found("eccentric_running", amplitude_um=5.0, direction_deg=10.0))
    far = replace(study, forecast=forecast_wear(study.fits, 1e6, np.array([1e6, 3.1e6])))
    for one, how in ((study, second()), (study, round_only), (replace(study, forecast=None), ran), (far, ran)):
        assert run_on(one, how, 150.0, Material()) is one


def test_without_sliding_wear_to_run_on_from_the_laws_forecast_stands(study: WearStudy, monkeypatch):
    def refuse(*_: object, **__: object) -> None:
        raise InputError("forecast: no sliding wear is seen to run on from")

    monkeypatch.setattr(forecast, "forecast_by_running", refuse)
    assert run_on(study, second(found("elastic_sharing")), 150.0, Material()) is study


def test_a_limit_is_reached_on_the_straight_way_between_two_cycles_and_beyond_the_last_as_in_the_last_step():
    """Growth with √N: 10 µm at N = 1, 20 µm at N = 4."""
    cycles = np.linspace(1.0, 4.0, 301)
    grown = 0.010 * np.sqrt(cycles)
    assert reached(cycles, grown, 0.015) == pytest.approx(2.25, abs=1e-3)
    assert reached(cycles, grown, 0.009) == 1.0
    assert reached(cycles, grown, 0.030) == pytest.approx(4.0 + 0.010 / 0.0025, rel=0.01)  # the slope at 4, where √ would need 9
    assert reached(cycles, np.full(301, 0.01), 0.02) == np.inf


@pytest.mark.long
def test_cycles_left_are_those_at_which_the_forecast_is_at_the_limit(study: WearStudy):
    """The limit is what the run says of twice the cycles: it is reached after as many again, and sooner at the upper side of the band."""
    ran = second(found("elastic_sharing"))
    plain = run_on(study, ran, 150.0, Material())
    assert plain.forecast is not None and plain.forecast.by_running
    now, then = plain.forecast.greatest_depth.value
    asked = CyclesToLimit("depth", float(then), cycles_left(study.fits, 1e6, float(then), "depth"))
    limited = run_on(replace(study, left=(asked,)), ran, 150.0, Material())
    np.testing.assert_array_equal(limited.forecast.greatest_depth.value, plain.forecast.greatest_depth.value)
    (limit,) = limited.left
    assert now < then and limit.left.value == pytest.approx(1e6, rel=0.01)
    assert limit.left.low < limit.left.value < limit.left.high


def test_a_forecast_by_running_says_so(study: WearStudy):
    from gearwear.report.records.wear_law import wear_law_record
    from gearwear.report.words.wear_law import forecast_caption, forecast_words

    assert study.forecast is not None
    run = replace(study, forecast=replace(study.forecast, by_running=True))
    told, law = (wear_law_record(one)["forecast"] for one in (run, study))
    assert (told["by"], law["by"]) == ("running", "law") and told["band"] != law["band"]
    assert forecast_words(run).startswith("Forecast, run on") and "run on as the pattern" in forecast_caption(run)
    assert gw.forecast_wear(study.fits, 1e6, np.array([1e6])).by_running is False
