"""A scan that software smoothed: what its forms may be as well."""

import pytest

from gearwear.diagnose.loop import _or_smoothing
from tests.report.fake import fake_effect


@pytest.mark.parametrize(
    ("name", "doubted"),
    [
        ("tip_relief", True), ("end_relief", True), ("helix_crowning", True), ("profile_slope", True), ("incidence_bias", True),
        ("coating", False), ("tooth_thickness", False), ("scale", False), ("turntable_angle", False), ("pitch", False),
    ],
)  # fmt: skip
def test_in_a_scan_that_software_smoothed_forms_are_doubted_and_levels_are_not(name, doubted):
    effect = fake_effect(name, {}, others=("taper",))
    assert _or_smoothing(effect).alternatives == (("edge_rounding", "taper") if doubted else ("taper",))
