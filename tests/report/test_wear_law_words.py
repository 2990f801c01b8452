"""The wear law in the report: what is recorded, said and drawn, from a fit of known numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

import gearwear as gw
from gearwear.design.side import Side
from gearwear.meshing.path import path_of_contact
from gearwear.report import figures
from gearwear.report.records.wear_law import wear_law_record
from gearwear.report.words.clauses import to_a_clause
from gearwear.report.words.wear_law import far_words, forecast_rows, forecast_words, law_words, left_words
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.study import CyclesToLimit, WearStudy
from tests.report.fake import fake_regions

DESIGN = gw.read_design(gw.example("design.toml"))
PAIR = (DESIGN.gears["pinion"], DESIGN.gears["gear"], 114.3)
ROLL = np.linspace(3.2, 26.2, 80)
LIMITS = {"depth": 0.08, "thickness": 0.5, "backlash": 0.02}


def study(b: float = 0.004, a: float = 0.008, cycles: tuple[float, ...] = (1e6, 2e6, 5e6), **limits: float) -> WearStudy:
    depth = a * np.abs(1.0 - (39.09290238 - ROLL) / (2.0 * ROLL)) + b
    fits = gw.fit_wear_law(*PAIR, ROLL, depth, np.full(80, 2e-4))
    left = tuple(CyclesToLimit(name, limit, gw.cycles_left(fits, 1e6, limit, name)) for name, limit in limits.items())
    forecast = gw.forecast_wear(fits, 1e6, np.array(cycles))
    return WearStudy(Side.LEFT, (0, 2, 3), (1,), fits, "", forecast, left, 0.44)


def test_the_record_holds_fit_profile_and_forecast():
    law = wear_law_record(study(**LIMITS))
    assert (law["teeth"], law["left_out"], law["share_of_volume"]) == ([1, 3, 4], [2], 0.44)
    low, high = law["terms"]["sliding"]["interval_um"]
    assert low < 8.0 < high and law["terms"]["sliding"]["coefficient_um"]["value"] == pytest.approx(8.0, abs=1e-3)
    assert law["explained_share"]["value"] + law["unexplained_share"]["value"] == pytest.approx(1.0)
    assert len({len(values) for values in law["profile"].values()}) == 1
    path = path_of_contact(*PAIR)
    over = law["law_over_path"]["roll_mm"]
    assert (over[0], over[-1]) == (pytest.approx(path.start_pinion), pytest.approx(path.end_pinion))
    forecast = law["forecast"]
    assert [row["far"] for row in forecast["at"]] == [False, False, True]
    assert forecast["rate_mm_per_cycle"]["value"] == pytest.approx(8e-9, rel=1e-3)
    assert [one["quantity"] for one in forecast["cycles_left"]] == ["depth", "thickness", "backlash"]


def test_words_say_who_is_in_it_and_how_far_it_reaches():
    law = study(**LIMITS)
    said = law_words(law)
    assert said.startswith("Wear law, fitted to the mean of 3 left flanks: the law explains ")
    assert "share the load is assumed, not known. Of its mean depth" in said and "8.0 ± 0.1 µm by single contact alone" in said
    assert "is consistent with sliding wear" in said
    assert "Tooth 2 lost much more or less than the others and is not in it." in said
    assert "lost 44\u202f% of the worn volume" in said
    depth, thickness, _ = left_words(law)
    assert (
        depth.startswith("The greatest depth of the mean flank reaches its limit of 80.0\u202fµm in ")
        and "times the cycles run" not in depth
    )
    assert "times the cycles run" in thickness
    assert "Beyond 2 times the cycles run a forecast is a guess" in far_words(law)
    assert far_words(study(cycles=(1e6, 2e6), depth=0.08)) == ""
    assert len(forecast_words(law)) < 400
    assert [row[0] for row in forecast_rows(law)] == ["1.00 million", "2.00 million", "5.00 million"]


def test_limits_passed_and_never_reached_are_said_so():
    law = study(depth=0.001)
    assert left_words(law) == ["The limit of 1.00\u202fµm on the greatest depth of the mean flank is reached already."]
    assert "none to depth" in forecast_words(law)
    never = study(a=0.0, b=0.0, thickness=0.5)
    (one,) = never.left
    assert one.never and math.isinf(one.left.value) and math.isfinite(one.left.low)
    (said,) = left_words(never)
    assert "never reaches its limit of 0.500\u202fmm by this law; at the upper side of its band it does in " in said


def test_a_tooth_past_the_limit_is_named_where_the_mean_flank_has_cycles_left():
    law = study(**LIMITS)
    deep = replace(fake_regions()[0], tooth=1, max_depth=0.601)
    others = [replace(deep, tooth=0, max_depth=0.05), replace(deep, tooth=4, side=Side.RIGHT)]
    assert left_words(law, [deep, *others])[0].endswith("; tooth 2 is past it by itself.")
    assert "past it" not in " ".join(left_words(law, others))
    assert "to depth 80.0\u202fµm, teeth 2 and 7 are past it; " in forecast_words(law, [replace(deep, tooth=6), deep])


def test_models_that_fit_alike_are_told():
    law = study(a=0.0)
    assert "With load sharing " in law_words(law) and " it fits as well." in law_words(law)


def test_no_fit_gives_a_reason_and_no_number():
    why = "wear on 2 teeth of one side; a law is fitted from 3 worn teeth on"
    law = WearStudy(Side.RIGHT, (), (), (), why)
    assert wear_law_record(law) == {"fitted": False, "flank": "right", "why_not": why}
    assert law_words(law) == f"No wear law was fitted: {why}."
    assert forecast_words(law) == forecast_words(None) == far_words(law) == "" and left_words(law) == forecast_rows(law) == []


def test_figures_draw_the_law_and_the_forecast():
    law = study(**LIMITS)
    left, right = Figure().subplots(1, 2)
    assert figures.worn_profile(left, law) is left
    assert left.yaxis_inverted()  # metal is lost downwards
    lines = {line.get_label(): line for line in left.lines}
    roll = lines["law"].get_xdata()
    np.testing.assert_allclose(
        np.interp(10.0, roll, lines["law"].get_ydata()), 8.0 * abs(1.0 - 29.09290238 / 20.0) + 4.0, rtol=1e-3
    )
    assert figures.greatest_depth(right, law) is right
    assert right.get_ylim()[0] <= 0.0
    labels = [line.get_label() for line in right.lines]
    assert "forecast" in labels and "limit" in labels


@pytest.mark.parametrize(
    ("lean", "end"), [(0.0288, "29\u202fµm deeper at the upper end"), (-0.0288, "29\u202fµm deeper at the lower end"), (0.0, "")]
)
def test_cycles_left_of_wear_that_leans_are_said_to_be_of_the_mean_over_the_face(lean, end):
    across = AcrossFace(np.arange(3.0), np.full(3, 0.02), np.full(3, 1e-3), lean, 0.001, 0.0, 0.001)
    said = forecast_words(replace(study(depth=0.08), across=across))
    assert said.startswith(f"Cycles left, mean flank (mean over the face; {end}): " if end else "Cycles left, mean flank: ")


def test_the_forecast_on_the_terminal_is_not_cut_within_a_number():
    """What has no room goes by whole clauses, so that every bracket is closed."""
    words = forecast_words(study(depth=0.08, thickness=0.5))
    for width in range(30, 80):
        shown = " ".join(to_a_clause(words, width, 3))
        assert shown.count("(") == shown.count(")")
