"""Rows of numbers from a report."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.conformity import Conformity, conformity
from gearwear.fleet.quantities import GEAR, TOOTH, quantities
from tests.fleet.fleets import report


def rows(given, scope=GEAR):
    return {
        (one.name, one.tooth, one.flank) if scope == TOOTH else one.name: one for one in quantities(given) if one.scope == scope
    }


def test_the_worst_of_the_gear_and_each_tooth():
    given = report(volume=(2.0, 0.1), depth=(80.0, 5.0), loss=(0.07, 0.004))
    gear, teeth = rows(given), rows(given, TOOTH)
    assert (gear["wear_volume_mm3"].value, gear["wear_volume_mm3"].std) == (2.0, 0.1)
    assert (gear["wear_depth_mm"].value, gear["wear_depth_mm"].std, gear["wear_depth_mm"].tooth) == (
        pytest.approx(0.08),
        pytest.approx(0.005),
        3,
    )
    assert (gear["thickness_loss_mm"].value, gear["thickness_loss_mm"].tooth) == (0.07, 3)
    assert gear["wear_depth_mm"].flank == ""  # whichever it is: else one quantity would be two
    assert teeth["thickness_loss_mm", 1, ""].value == 0.001
    assert teeth["wear_depth_mm", 3, "left"].value == pytest.approx(0.08)


def test_where_nothing_was_found_stands_what_might_be_there():
    given = report()
    given["wear"]["regions"] = []
    gear = rows(given)
    assert (gear["wear_depth_mm"].value, gear["wear_depth_mm"].high) == (0.0, pytest.approx(2 * 0.02))
    assert gear["wear_volume_mm3"].high == pytest.approx(2 * 0.02 * 9.0)
    assert math.isnan(gear["wear_depth_mm"].std)


def test_what_the_scan_leaves_open_stands_where_nothing_was_found():
    """Whole sides that may be worn or made so: far more than a patch too shallow to be seen, and no proof that a limit is kept."""
    given = report()
    given["wear"]["regions"] = []
    given["wear"]["volume_mm3"] = {"value": 0.0, "std": 0.0, "low": 0.0, "high": 120.0, "range_from": "…"}
    volume = rows(given)["wear_volume_mm3"]
    assert (volume.value, volume.high) == (0.0, 120.0)
    assert conformity(volume.low, volume.high, 50.0) is Conformity.NEITHER


def test_a_range_of_the_report_is_kept():
    given = report()
    given["wear"]["volume_mm3"] |= {"low": 0.5, "high": 3.0}
    assert (rows(given)["wear_volume_mm3"].low, rows(given)["wear_volume_mm3"].high) == (0.5, 3.0)


def test_a_depth_that_may_be_thinner_teeth_has_a_lower_end():
    given = report(depth=(60.0, 2.0))
    assert math.isnan(rows(given)["wear_depth_mm"].low)
    given["wear"]["regions"][0] |= {"max_depth_low_um": 15.0, "max_depth_high_um": 64.0}
    for scope, key in ((GEAR, "wear_depth_mm"), (TOOTH, ("wear_depth_mm", 3, "left"))):
        depth = rows(given, scope)[key]
        assert (depth.value, depth.low, depth.high) == (pytest.approx(0.06), pytest.approx(0.015), pytest.approx(0.064))


def test_the_deepest_of_a_gear_is_as_deep_as_each_flank_is_for_sure():
    """60 µm, of which 52 may be made so, beside 55 ± 0.5 on the other side: 54 at least, not 8; and 70 where another may have that."""
    given = report(depth=(60.0, 1.0))
    first = given["wear"]["regions"][0] | {"max_depth_low_um": 8.0, "max_depth_high_um": 62.0}
    sure = first | {"flank": "right", "max_depth_um": 55.0, "max_depth_std_um": 0.5}
    sure = {key: value for key, value in sure.items() if "low" not in key and "high" not in key}
    wide = sure | {"tooth": 7, "max_depth_um": 20.0, "max_depth_low_um": 1.0, "max_depth_high_um": 70.0}
    for regions, low, high in (
        ([first], 8.0, 62.0),
        ([first, sure], 55.0 - 1.96 * 0.5, 62.0),
        ([wide, sure, first], 55.0 - 1.96 * 0.5, 70.0),
    ):
        given["wear"]["regions"] = regions
        depth = rows(given)["wear_depth_mm"]
        assert (depth.value, depth.tooth, depth.flank) == (0.06, 3, "")
        assert (depth.low, depth.high) == (pytest.approx(1e-3 * low, rel=1e-4), pytest.approx(1e-3 * high))
    given["wear"]["regions"] = [sure]
    assert math.isnan(rows(given)["wear_depth_mm"].low) and math.isnan(rows(given)["wear_depth_mm"].high)


def open_report(below, above, **more):
    """A volume whose range comes to so much evenly over one side, µm."""
    given = report(**more)
    given["design"] |= {"base_radius_mm": 18.0, "reference_radius_mm": 20.0}
    given["wear"]["evenly_um"] = {"below": below, "above": above}
    return given


def test_what_is_open_of_the_volume_is_open_of_the_thickness():
    """50 µm along the normal are 20/18 of it as arc at the reference circle."""
    loss = rows(open_report(20.0, 50.0, loss=(0.07, 0.004)))["thickness_loss_mm"]
    assert (loss.low, loss.high) == (pytest.approx(0.07 - 0.02 / 0.9), pytest.approx(0.07 + 0.05 / 0.9))
    narrow = rows(open_report(0.0, 0.0))["thickness_loss_mm"]
    assert math.isnan(narrow.low) and math.isnan(narrow.high)


def test_open_thickness_is_that_where_it_is_measured():
    """Arc for each mm along the normal: r / (r_b cos β_b), of helical teeth and where the reference circle lies off the involute."""
    spec = GearSpec("gear", 20, 2.0, 10.0, helix_angle=math.radians(25.0))
    for gear in (Gear.from_spec(spec), Gear.from_spec(replace(spec, profile_shift=1.2))):
        given = open_report(20.0, 50.0, loss=(0.07, 0.004))
        given["design"] |= {
            "base_radius_mm": gear.base_radius, "reference_radius_mm": gear.reference_radius,
            "thickness_radius_mm": gear.thickness_radius, "base_helix_angle_deg": math.degrees(gear.base_helix_angle),
        }  # fmt: skip
        loss = rows(given)["thickness_loss_mm"]
        assert loss.low == pytest.approx(0.07 - 0.02 * gear.arc_per_depth)
        assert loss.high == pytest.approx(0.07 + 0.05 * gear.arc_per_depth)


def test_none_seen_is_as_deep_as_the_volume_leaves_open():
    """A gear worn by 38 µm of which the report said that it may be 160 mm³ conformed to 20 µm: none seen, below 14."""
    given = open_report(0.0, 100.0)
    given["wear"] |= {"regions": [], "flanks": [{"tooth": 2, "flank": "left", "detection_limit_um": 7.0}]}
    assert rows(given)["wear_depth_mm"].high == pytest.approx(2 * 0.1)
    assert rows(given, TOOTH)["wear_depth_mm", 2, "left"].high == pytest.approx(2 * 0.1)
    given["wear"]["evenly_um"]["above"] = 1.0
    assert rows(given)["wear_depth_mm"].high == pytest.approx(2 * 0.02)  # its own limit


def test_meshing_and_inspection():
    given = report() | {
        "meshing": {
            "worn": {"backlash": {"circumferential_mm": 0.15, "circumferential_mm_std": 0.002}, "transmission_error_um": 12.0, "transmission_error_um_std": None},
            "wear_law": {"flank": "left", "terms": {"sliding": {"greatest_depth_um": {"value": 40.0, "std": 2.0}}}},
        },
        "inspection": {
            "coverage_factor": 2.0,
            "findings": [{"quantity": "single_pitch", "flank": "left", "tooth": 4, "value_um": -8.0, "expanded_um": 3.0}, {"quantity": "runout", "flank": None, "tooth": None, "value_um": None, "expanded_um": None}],
        },
    }  # fmt: skip
    gear = rows(given)
    assert (gear["backlash_mm"].value, gear["backlash_mm"].std) == (0.15, 0.002)
    assert math.isnan(gear["transmission_error_um"].std)
    assert (gear["law_sliding_depth_um"].value, gear["law_sliding_depth_um"].flank) == (40.0, "")
    assert (gear["single_pitch_um"].value, gear["single_pitch_um"].std, gear["single_pitch_um"].flank) == (8.0, 1.5, "left")
    assert "runout_um" not in gear


def test_a_tooth_whose_thickness_is_not_known_has_no_row():
    """Of a tooth that was not seen, or is broken off, the report has null; a whole batch failed on it."""
    seen, unseen = {"tooth": 1, "thickness_mm": {"value": 9.9, "expanded": 0.02}}, {"tooth": 2, "thickness_mm": None}
    dimensions = {"tooth_thickness": {"teeth": [seen, unseen]}}
    given = report() | {"inspection": {"coverage_factor": 2.0, "findings": [], "dimensions": dimensions}}
    told = {tooth: row for (name, tooth, _), row in rows(given, TOOTH).items() if name == "tooth_thickness_mm"}
    assert list(told) == [1] and (told[1].value, told[1].std) == (9.9, 0.01)


def test_a_report_without_anything_has_no_rows():
    assert quantities({}) == []
