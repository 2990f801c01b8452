"""What proves nothing: doubtful reports, flanks that were not seen, and the limits of backlash and transmission error."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from datetime import datetime, timedelta

import pytest

from gearwear.design.conformity import Conformity
from gearwear.fleet.doubts import Doubts
from gearwear.fleet.quantities import DOUBT, GEAR, TOOTH, quantities
from gearwear.fleet.trend import Reading, gear_trend, with_significance
from tests.commands.doors import run
from tests.fleet.fleets import report, row, store_of

DAY, DEPTH, VOLUME, PLAY = datetime(2026, 1, 1), "wear_depth_mm", "wear_volume_mm3", "backlash_mm"
DOUBTFUL = Doubts(grave=("the registration did not settle",))
HALF = Doubts(unseen=("12 of 24 flanks were not seen",))


def readings(values, std=0.001, quantity=DEPTH):
    """Inspections every 60 days."""
    return [
        Reading(gear_id="A", quantity=quantity, value=value, std=std, inspected=DAY + timedelta(60 * i), cycles=1e6 * (i + 1))
        for i, value in enumerate(values)
    ]


def flanks(shares, limit=None, teeth=10):
    """Flanks of a report: so many say nothing, of each that share was seen; the others were seen whole."""
    every = [(tooth, side) for tooth in range(1, teeth + 1) for side in ("left", "right")]
    seen = [*shares, *[1.0] * (len(every) - len(shares))]
    return [
        {"tooth": tooth, "flank": side, "detection_limit_um": limit if i < len(shares) else 7.0, "seen": share}
        for i, ((tooth, side), share) in enumerate(zip(every, seen, strict=True))
    ]


def doubts_of(given):
    return [one.name for one in quantities(given) if one.scope == DOUBT]


@pytest.mark.parametrize("value", [0.01, 0.3])
def test_a_doubtful_result_proves_neither(value):
    """Whether its number lies far below the limit or far above: 0.1."""
    (sure,) = readings([value])
    for doubts, state in (
        (DOUBTFUL, Conformity.NEITHER),
        (HALF, Conformity.NEITHER if value < 0.1 else Conformity.NOT_CONFORMING),
    ):
        gear = gear_trend("A", [replace(sure, doubts=doubts)], {DEPTH: 0.1})
        assert gear.conformity is gear.trends[DEPTH].conformity is state
        assert gear.notes[0].startswith(doubts.words[0])
    assert gear_trend("A", [sure], {DEPTH: 0.1}).conformity is not Conformity.NEITHER


def test_one_doubtful_scan_of_an_inspection_is_enough_and_an_older_one_is_not():
    first, last = readings([0.02, 0.03])
    limits = {DEPTH: 0.1}
    assert gear_trend("A", [first, last, replace(last, doubts=DOUBTFUL)], limits).conformity is Conformity.NEITHER
    gear = gear_trend("A", [replace(first, doubts=DOUBTFUL), last], limits)
    assert gear.conformity is Conformity.CONFORMING and gear.notes == ("1 of 2 inspections are doubtful, and in no rate",)


def test_a_doubtful_inspection_is_in_no_rate_and_its_changes_are_not_significant():
    """0.01 mm in 10⁶ cycles, and a doubtful 0.5 mm between."""
    given = readings([0.01, 0.5, 0.03, 0.04])
    given[1] = replace(given[1], doubts=DOUBTFUL)
    (gear,) = with_significance([gear_trend("A", given, {})])
    trend = gear.trends[DEPTH]
    assert trend.line.slope == pytest.approx(1e-8) and len(trend.points) == 4
    assert [step.significant for step in trend.steps] == [False, False, True]
    assert not any("fell" in note for note in gear.notes)
    last = gear_trend("A", [*given[::2], replace(given[3], doubts=DOUBTFUL)], {DEPTH: 1.0}).trends[DEPTH]
    assert last.line is not None and last.left is None  # no day on which it reaches the limit


@pytest.mark.parametrize(
    ("shares", "told"),
    [
        ([], None),
        ([0.4], None),  # a thin flank or two of twenty are in every scan
        ([0.4, 0.26], None),
        ([0.24], "1 of 20 flanks were not seen"),
        ([0.4] * 3, "3 of 20 flanks say nothing of their wear"),
        ([0.0] * 10, "10 of 20 flanks were not seen"),
        ([0.75] * 20, "20 of 20 flanks say nothing of their wear"),
    ],
)
def test_which_part_of_a_gear_says_nothing(shares, told):
    given = report()
    given["wear"] |= {"regions": [], "flanks": flanks(shares)}
    assert doubts_of(given) == ([] if told is None else [f"unseen: {told}"])


def test_flanks_that_are_worn_or_broken_off_were_seen():
    given = report()
    given["wear"]["flanks"] = flanks([0.1] * 2)
    given["wear"]["regions"] = [given["wear"]["regions"][0] | {"tooth": 1, "flank": side} for side in ("left", "right")]
    assert doubts_of(given) == []
    given["wear"]["regions"] = []
    for seen, told in ((True, []), (False, ["unseen: 2 of 20 flanks were not seen"])):
        given["broken"] = [{"tooth": 1, "flank": "both", "kind": "tooth", "seen": seen}]
        assert doubts_of(given) == told


def test_where_nothing_could_have_shown_the_wear_is_not_known_and_not_nothing():
    """Of a gear compared with a design without its profile shift: "worn volume none seen, below 0 mm³"."""
    given = report()
    nothing = {"value": 0.0, "std": 0.0}
    blind = {"regions": [], "flanks": flanks([0.75] * 20), "detection_limit_um": None, "detection_area_mm2": None}
    given["wear"] |= blind | {"volume_mm3": nothing, "lost_volume_mm3": nothing}
    names = {one.name for one in quantities(given) if one.scope in (GEAR, TOOTH)}
    assert not names & {VOLUME, DEPTH, "lost_volume_mm3"}
    assert gear_trend("A", [replace(readings([0.0])[0], std=math.nan, low=0.0)], {DEPTH: 0.1}).conformity is Conformity.NEITHER


def doubtful_store(folder, limits):
    """P under the wrong design, S half seen, and T, both with no wear found."""
    reports = {}
    for name in "PST":
        given = reports[name] = report(loss=(0.001, 0.001))
        nothing = {"value": 0.0, "std": 0.0}
        given["wear"] |= {"regions": [], "volume_mm3": nothing, "flanks": flanks([])}
    reports["P"]["doubtful"] = ["tips and roots lie off"]
    reports["P"]["wear"] |= {"detection_limit_um": None, "detection_area_mm2": None, "flanks": flanks([0.75] * 20)}
    reports["S"]["doubtful"] = ["only 50 % of the flanks was seen"]
    reports["S"]["wear"]["flanks"] = flanks([0.0] * 10)
    return store_of(folder, [(row(name, DAY), given) for name, given in reports.items()], limits)


def test_the_doubt_stands_in_the_row_the_table_and_the_page(tmp_path):
    store = doubtful_store(tmp_path / "store", {VOLUME: 2.0, DEPTH: 0.1})
    said = run("trend", store.folder)
    text = " ".join(said.out.split())
    assert said.status == 3 and "3 gears: 2 undecided, 1 within all limits." in text
    assert "P undecided: deepest wear and worn volume not known" in text and "below 0 mm³" not in text
    assert "! doubtful: tips and roots lie off" in text and "! doubtful: only 50 % of the flanks was seen" in text
    assert "S undecided: worn volume on what was seen none, below 0.360 mm³ of 2.00" in text
    with (store.folder / "trend" / "trend.csv").open(encoding="utf-8", newline="") as stream:
        rows = {(one["gear_id"], one["quantity"]): one for one in csv.DictReader(stream)}
    half = rows["S", VOLUME]
    assert (half["doubtful"], half["unseen"], half["conformity"]) == (
        "only 50 % of the flanks was seen", "10 of 20 flanks were not seen", "neither",
    )  # fmt: skip
    assert ("P", VOLUME) not in rows and rows["P", "thickness_loss_mm"]["doubtful"] == "tips and roots lie off"
    assert (rows["T", VOLUME]["doubtful"], rows["T", VOLUME]["conformity"]) == ("", "conforming")
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    assert "! doubtful: tips and roots lie off" in page


def test_a_scan_without_any_number_is_told_with_its_doubt(tmp_path):
    given = report() | {"thickness": [], "doubtful": ["tips and roots lie off"]}
    blind = {"regions": [], "flanks": flanks([0.75] * 20), "detection_limit_um": None, "detection_area_mm2": None}
    given["wear"] |= blind
    given["meshing"] = {"worn": {"centre_distance_mm": 100.0}}
    given["inspection"] = {"findings": [{"quantity": "runout", "value_um": 9.0, "expanded_um": 2.0}]}
    said = run("trend", store_of(tmp_path / "store", [(row("A", DAY), given)], {DEPTH: 0.1}).folder)
    assert said.status == 3 and "no result" in said.out and "! doubtful: tips and roots lie off" in said.out


def meshing(value, low=None, high=None, std=0.0006):
    """A report with this backlash, mm, and a transmission error of a thousand times that in µm."""
    ends = {} if low is None else {"low": low, "high": high}
    play = {"circumferential_mm": value, "circumferential_mm_std": std} | {
        f"circumferential_mm_{end}": x for end, x in ends.items()
    }
    error = {"transmission_error_um": 1e3 * value, "transmission_error_um_std": 1e3 * std}
    error |= {f"transmission_error_um_{end}": 1e3 * x for end, x in ends.items()}
    return report() | {"meshing": {"worn": {"backlash": play, **error}}}


def test_the_limits_of_the_contact_decide(tmp_path):
    """0.0275 ± 0.0006 of 0.040, which may be up to 0.050."""
    for given, status in ((meshing(0.0275), 0), (meshing(0.0275, 0.026, 0.050), 3)):
        store = store_of(tmp_path / f"store{status}", [(row("A", DAY), given)], {PLAY: 0.040})
        assert run("trend", store.folder).status == status
    rows = {one.name: one for one in quantities(meshing(0.0275, 0.026, 0.050))}
    assert (rows[PLAY].low, rows[PLAY].high, rows["transmission_error_um"].high) == (0.026, 0.050, pytest.approx(50.0))


def test_repeats_within_the_limits_of_the_contact_contradict_nothing(tmp_path):
    """0.027 and 0.033, each anywhere between 0.026 and 0.050: ten standard deviations apart without that."""
    for name, ends, said in (("bare", (None, None), "backlash"), ("open", (0.026, 0.050), "none")):
        scans = [
            (row(gear, DAY, operator="a", repeat=str(i)), meshing(value, *ends))
            for gear in "GH"
            for i, value in enumerate((0.027, 0.033))
        ]
        told = " ".join(run("gauge", store_of(tmp_path / name, scans).folder).out.split())
        assert told.split("Repeats contradict the stated ± of ")[1].split(".")[0].find(said) >= 0


def test_what_wear_only_makes_larger_is_asked_about_where_it_falls():
    play = readings([0.20, 0.15], std=0.002, quantity=PLAY)
    (note,) = gear_trend("A", play, {}).notes
    assert note == "what wear only makes larger fell: backlash_mm from 0.200 to 0.150: is it the same gear, and the same design?"
    assert gear_trend("A", readings([0.20, 0.195], std=0.002, quantity=PLAY), {}).notes == ()
    assert gear_trend("A", readings([20.0, 15.0], std=0.2, quantity="transmission_error_um"), {}).notes == ()  # that may


def test_the_gauge_says_why_a_quantity_has_no_repeatability(tmp_path):
    """Of two gears one was found without wear three times of four."""
    scans = []
    for gear in "GH":
        for i in range(2):
            given = meshing(0.03 + 0.0003 * i)
            if gear == "H" and i:
                given["wear"] |= {"regions": [], "volume_mm3": {"value": 0.0, "std": 0.0}}
            scans.append((row(gear, DAY, operator="a", repeat=str(i)), given))
    text = " ".join(run("gauge", store_of(tmp_path / "store", scans).folder).out.split())
    assert (
        "! Of worn volume and deepest wear there is one gear alone; of the scans 1 that found no wear and 1 without a match are left out."
        in text
    )
