"""A misalignment that the design states: what the search starts from, and what the forecast runs with."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.arrays import Bools, Floats
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.loaded.contact import loaded_contact
from gearwear.loaded.pair_compliance import PairCompliance
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import tooth_compliance
from gearwear.report.words.running import running_words
from gearwear.running import study
from gearwear.running.conditions import Runs
from gearwear.running.forecast import shown_gap
from gearwear.running.found import SecondLoop
from gearwear.running.search import find_running
from gearwear.running.wear_map import WearMap
from gearwear.wear_law.archard import specific_sliding
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.study import WearStudy
from tests.running.maps import CENTRE, LOAD, PAIR, SINGLE_UM, SLICES, law_basis_and_alone, map_of, shared_runs
from tests.synthetic.ran import RanWear


def traced(gap_um: float, stated_um: float) -> SecondLoop:
    """How a pair is said to have run that ran with one gap and was stated to have another, µm."""
    place = map_of(RanWear(single_um=SINGLE_UM, load=LOAD, gap_um=gap_um), seed=3)
    return find_running(place, *law_basis_and_alone(place, replace(shared_runs(), map=place, stated=1e-3 * stated_um)))


@pytest.mark.long
def test_a_gap_that_is_there_as_stated_is_no_finding_and_is_run_on_with():
    found = traced(30.0, 30.0)
    assert found.effect("misalignment") is None and found.effect("elastic_sharing") is not None
    assert shown_gap(found) == pytest.approx(0.030 / (1.0 + found.conditions.mate_rate), rel=1e-12)
    assert found.after.all < 0.0015


@pytest.mark.long
@pytest.mark.parametrize(("gap", "stated"), [(30.0, 15.0), (30.0, -20.0), (0.0, 30.0)])
def test_a_gap_that_is_stated_wrong_is_told_as_large_as_it_is(gap: float, stated: float):
    """The same within a micrometre as where none is stated."""
    found = traced(gap, stated)
    askew = found.effect("misalignment")
    assert askew is not None
    size = askew.parameters["gap_um"]
    assert isinstance(size.value, float) and isinstance(size.std, float)
    assert abs(size.value - gap) < min(10.0, 3.0 * size.std)
    plain = traced(gap, 0.0).effect("misalignment")
    told = 0.0 if plain is None else float(np.asarray(plain.parameters["gap_um"].value))
    assert size.value == pytest.approx(told, abs=1.5)
    assert f"where {abs(stated):.0f}\u202fµm towards z = {'b' if stated > 0.0 else '0'} are stated" in running_words(found)


@pytest.mark.parametrize("side", Side)
def test_a_gap_as_stated_wears_the_end_that_the_loaded_contact_of_the_design_loads(side: Side, monkeypatch: pytest.MonkeyPatch):
    """On left flanks + opens towards z = b; on right ones it closes there."""
    asked: list[Runs] = []

    def keep(place: WearMap, _: Floats, of: Runs, __: Bools) -> SecondLoop:
        asked.append(of)
        raise InputError("that was to be seen")

    monkeypatch.setattr(study, "wear_map", lambda *_: replace(map_of(RanWear(single_um=SINGLE_UM, load=LOAD)), side=side))
    monkeypatch.setattr(study, "find_running", keep)
    roll = np.linspace(6.0, 26.0, 60)
    fits = fit_wear_law(*PAIR, CENTRE, roll, 0.005 * specific_sliding(*PAIR, CENTRE, roll), np.full(60, 1e-4))
    law, cells = WearStudy(side, (0, 1, 2), (), fits, ""), SimpleNamespace(grid=SimpleNamespace(gear=PAIR[0]))
    study.trace_running(law, cells, PAIR[1], CENTRE, LOAD, Material(), None, 0.001, None, 0.030)  # type: ignore[arg-type]
    lost = asked[0].of(asked[0].usual)[-1].reshape(SLICES, -1).mean(axis=1)
    compliance = PairCompliance((tooth_compliance(PAIR[0], Material()), tooth_compliance(PAIR[1], Material())), Material(), 0.0)
    contact = loaded_contact(
        *map(nominal_profiles, PAIR), CENTRE, LOAD * 15.0, compliance, side, misalignment=0.030, slices=SLICES, cycle="pitch"
    )
    along = contact.force.sum(axis=(0, 1))
    assert (lost[0] > 2.0 * lost[-1], along[0] > 2.0 * along[-1]) == (side is Side.LEFT, side is Side.LEFT)
    assert (lost[-1] > 2.0 * lost[0], along[-1] > 2.0 * along[0]) == (side is Side.RIGHT, side is Side.RIGHT)
