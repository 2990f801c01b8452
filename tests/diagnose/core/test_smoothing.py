"""A scan that software smoothed: what its forms may be as well."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.surface import flank_points
from gearwear.diagnose.loop import or_smoothing
from gearwear.diagnose.parameter import ParameterEstimate
from tests.report.fake import fake_effect, fake_results


@pytest.mark.parametrize(
    ("name", "doubted"),
    [
        ("tip_relief", True), ("end_relief", True), ("helix_crowning", True), ("profile_slope", True), ("incidence_bias", True),
        ("coating", False), ("tooth_thickness", False), ("scale", False), ("turntable_angle", False), ("pitch", False),
    ],
)  # fmt: skip
def test_in_a_scan_that_software_smoothed_forms_are_doubted_and_levels_are_not(name, doubted):
    effect = fake_effect(name, {}, others=("taper",))
    assert or_smoothing(effect).alternatives == (("edge_rounding", "taper") if doubted else ("taper",))


@pytest.mark.parametrize(
    ("others", "sure"), [((), True), (("taper",), True), (("edge_rounding",), False), (("scale", "taper"), False)]
)
def test_what_the_scanner_may_have_done_is_not_surely_made(others, sure):
    """A profile shift of 1 mm moves a flank by sin α along its normal."""
    loop = replace(fake_results().loop, effects=(fake_effect("profile_shift", {}, others=others),), form=())
    gear = loop.context.gear
    feet = flank_points(gear, np.arange(12), np.ones(12, dtype=np.int64), np.full(12, gear.reference_roll), np.full(12, 5.0))
    np.testing.assert_allclose(loop.surely_made(feet), np.sin(np.radians(20.0)) if sure else 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "parameters", "sized"),
    [
        ("coating", {"thickness_um": (20.0, 1.0)}, True),
        ("coating", {"thickness_um": (20.0, 11.0)}, False),
        ("scan_drift", {"closure_deg": (-0.031, 0.019), "start_deg": (357.0, 17.0)}, False),  # where it began is no size
        ("profile_slope", {"left_um": (0.5, 2.0), "right_um": (-9.0, 2.0)}, True),
        ("pitch", {"index_um": ((0.5, -1.0, np.nan), (2.0, 2.0, np.nan))}, False),
        ("pitch", {"index_um": ((0.5, -9.0, np.nan), (2.0, 2.0, np.nan))}, True),
    ],
)
def test_an_effect_has_a_size_where_one_of_its_intervals_leaves_out_nothing(name, parameters, sized):
    known = {parameter: ParameterEstimate(value, std, parameter.split("_")[-1]) for parameter, (value, std) in parameters.items()}
    assert fake_effect(name, known).is_sized is sized
