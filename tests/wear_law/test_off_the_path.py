"""Forecasts of a flank whose reference circle the mate never touches: the thickness there is not known, all else is."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.spec import GearSpec
from gearwear.meshing.backlash import zero_backlash_centre_distance
from gearwear.meshing.path import path_of_contact
from gearwear.report.records.wear_law import wear_law_record
from gearwear.report.words.wear_law import forecast_rows, law_words, left_words
from gearwear.wear_law.forecast import cycles_left, forecast_wear
from gearwear.wear_law.running import forecast_by_running
from gearwear.wear_law.study import WearStudy, _forecast

EVEN = 0.005


@pytest.fixture(scope="module")
def fits():
    """5 µm off the gear of a pair with x = 0.9 on both, z 16 / 60, m 3: its path begins above its reference circle."""
    pinion, gear = (
        gw.Gear.from_spec(GearSpec(part, z, 3.0, 20.0, profile_shift=0.9)) for part, z in (("pinion", 16), ("gear", 60))
    )
    centre = zero_backlash_centre_distance(pinion, gear) + 0.05
    path = path_of_contact(gear, pinion, centre)
    assert path.start_pinion > gear.reference_roll
    roll = np.linspace(path.start_pinion + 0.1, path.end_pinion - 0.1, 60)
    return gw.fit_wear_law(gear, pinion, centre, roll, np.full(60, EVEN), np.full(60, 1e-4))


def test_depth_and_backlash_go_on_and_the_thickness_is_not_known(fits):
    found = forecast_wear(fits, 1e6, np.array([1e6, 2e6]))
    np.testing.assert_allclose(found.greatest_depth.value, [EVEN, 2.0 * EVEN], rtol=1e-6)
    np.testing.assert_allclose(found.backlash_increase.value, [EVEN, 2.0 * EVEN], rtol=1e-6)
    assert np.isnan([found.thickness_loss.value, found.thickness_loss.low, found.thickness_loss.high]).all()
    assert "thickness" not in str(found) and "backlash" in str(found)


def test_a_study_tells_the_limits_on_depth_and_why_there_is_none_on_thickness(fits):
    study = WearStudy(side=gw.Side.LEFT, teeth=(0, 1, 2), left_out=(), fits=fits, why_not="")
    found = _forecast(study, gw.Ahead(1e6, (2e6,), (("depth", 0.02), ("thickness", 0.02))))
    assert found.why_not == "" and [limit.quantity for limit in found.left] == ["depth"]
    assert found.left[0].left.value == pytest.approx(3e6, rel=1e-6)  # 5 µm in a million cycles: 20 in three more
    assert "nothing is forecast of the thickness" in found.note
    assert all(row[2] == "–" for row in forecast_rows(found)) and len(left_words(found)) == 1
    assert "nothing is forecast of the thickness" in law_words(found).lower()
    at = wear_law_record(found)["forecast"]["at"][1]
    assert math.isnan(at["thickness_loss_mm"]["value"]) and at["greatest_depth_um"]["value"] == pytest.approx(10.0)


def test_a_radius_that_is_asked_for_is_refused_off_the_path(fits):
    with pytest.raises(gw.InputError, match="the path of contact runs from"):
        forecast_wear(fits, 1e6, np.array([2e6]), radius=fits[0].gear.reference_radius)
    with pytest.raises(gw.InputError, match="the path of contact runs from"):
        cycles_left(fits, 1e6, 0.02, "thickness")


@pytest.mark.long
def test_a_run_goes_on_likewise(fits, monkeypatch):
    for name, few in (("MATE_RATES", (0.5,)), ("STIFFNESSES", (1.0,)), ("_POSITIONS", 24)):
        monkeypatch.setattr(f"gearwear.wear_law.running.{name}", few)
    sliding = replace(fits[0], coefficients=np.array([EVEN, 0.0, 0.0]))
    found = forecast_by_running(sliding, 1e6, np.array([1e6, 2e6]), 100.0)
    assert np.isnan(found.thickness_loss.value).all() and np.isfinite(found.backlash_increase.value).all()
