"""What an inspection refuses to be asked: values that are impossible by themselves, and those that lie off the gear."""

import math
import re

import numpy as np
import pytest

from gearwear.design import GearSpec
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.inspection import Edition, Settings
from gearwear.inspection.prepared import check_settings
from gearwear.inspection.ranges import profile_range
from gearwear.inspection.settings import LONGEST
from tests.inspection.test_rings import RING

IMPOSSIBLE = [
    ({"sector": -1}, "sector = -1: a whole number from 1 up"),
    ({"sector": 2.5}, "sector = 2.5: a whole number"),
    ({"sector": True}, "sector = True: a whole number"),
    ({"span_teeth": 0}, "span_teeth = 0"),
    ({"required_class": 8.5}, "required_class = 8.5"),
    ({"helix_between": (12.0, 2.0)}, "helix_between = 12 to 2 mm: from the lower z to the higher one"),
    ({"pitch_band": (2.0, 2.0)}, "pitch_band = (2.0, 2.0): two lengths in mm"),
    ({"profile_band": (1.0, 2.0, 3.0)}, "profile_band = (1.0, 2.0, 3.0): two lengths"),
    ({"profile_band": 4.0}, "profile_band = 4.0: two lengths"),
    ({"helix_band": (math.nan, 3.0)}, "helix_band = (nan, 3.0)"),
    ({"control_roll": 7.0, "profile_end": 7.0}, "control_roll and profile_end are both 7 mm"),
    ({"control_roll": -1.0}, "control_roll = -1.0: a length of roll"),
    ({"pitch_roll": math.nan}, "pitch_roll = nan"),
    ({"profile_cutoff": -1.0}, "profile_cutoff = -1.0: a length above 0"),
    ({"profile_cutoff": math.inf}, "profile_cutoff = inf"),
    ({"helix_cutoff": 0.0}, "helix_cutoff = 0.0"),
    ({"slope_length": math.inf}, "slope_length = inf"),
    ({"pin_diameter": "11"}, "pin_diameter = '11'"),
    ({"stylus_radius": math.nan}, "stylus_radius = nan"),
    ({"sample_factor": 0.0}, "sample_factor = 0.0: a number from 1 up"),
    ({"sample_factor": math.inf}, "sample_factor = inf"),
    ({"scale_std": -1e-4}, "scale_std = -0.0001: a number from 0 to 1"),
    ({"noise": -1.0}, "noise = -1.0: 0 to"),
    ({"edition": "x"}, "edition = 'x': one of ISO 1328-1:2013, ISO 1328-1:1995"),
    ({"axis": "hub"}, "axis = 'hub': one of teeth, bore, bands, ends"),
    ({"pose_covariance": np.eye(3)}, "pose_covariance of shape (3, 3): (6, 6)"),
    ({"pose_covariance": np.full((6, 6), np.nan)}, "pose_covariance of shape (6, 6): (6, 6) finite numbers"),
    ({"pose_covariance": -np.eye(6)}, "pose_covariance has negative variances"),
]


@pytest.mark.parametrize(("values", "words"), IMPOSSIBLE, ids=[next(iter(values)) for values, _ in IMPOSSIBLE])
def test_an_impossible_value_is_refused_by_name(values, words):
    with pytest.raises(InputError, match=re.escape(words)) as error:
        Settings(**values)
    assert "would be right" in str(error.value) and "\n" not in str(error.value)


def test_possible_values_are_kept():
    one = Settings(
        sector=np.int64(3),
        noise=0.0,
        pose_covariance=np.zeros((6, 6)),
        helix_band=(9.0, 5.0),
        edition="ISO 1328-1:1995",
        scale_std=0.0,
    )
    assert (one.sector, one.noise, one.helix_band) == (3, 0.0, (9.0, 5.0))
    assert one.edition is Edition.ISO_1995  # a plain word is compared by what it says


OFF_THE_GEAR = [
    ({"control_roll": 20.0, "profile_end": 10.0}, "from 20 to 10 mm of roll is empty"),
    ({"control_roll": 40.0}, "from 40 to 26.3439 mm of roll is empty"),
    ({"profile_end": 1.0}, "from 3.05745 to 1 mm of roll is empty"),
    ({"control_roll": 40.0, "profile_end": 50.0}, "the involute goes from 3.058 to 26.343 mm"),
    ({"helix_between": (-5.0, 100.0)}, "helix evaluation from -5 to 100 mm of height: the face goes from 0.000 to 15.000 mm"),
    ({"helix_between": (20.0, 30.0)}, "helix evaluation from 20 to 30 mm of height: the face goes from 0.000 to 15.000 mm"),
    ({"profile_band": (-2.0, -1.0)}, "band of the profile traces from -2 to -1 mm"),
    ({"pitch_band": (15.0, 16.0)}, "band of the pitch from 15 to 16 mm"),
    ({"helix_band": (27.0, 30.0)}, "band of the helix traces from 27 to 30 mm of roll: the involute goes from"),
    ({"pitch_roll": 27.0}, "the circle of the pitch at 27 mm of roll"),
    ({"sector": 12}, "sector of 12 pitches: 1 to 11 would be right for 12 teeth"),
    ({"slope_length": 300.0}, "slope stated over 300 mm: at most 232 mm"),
    ({"profile_cutoff": 1e-9}, "cut-off of the profile's filter, 1e-09 mm: 0.0443 to 22.1220 mm"),
    ({"profile_cutoff": LONGEST}, "cut-off of the profile's filter, 100000 mm"),
    ({"helix_cutoff": 0.02}, "cut-off of the helix's filter, 0.02 mm: 0.0270 to 13.5000 mm"),
]


@pytest.mark.parametrize(("values", "words"), OFF_THE_GEAR, ids=[next(iter(values)) for values, _ in OFF_THE_GEAR])
def test_what_lies_off_the_gear_is_refused_with_what_it_has(pinion, values, words):
    with pytest.raises(InputError, match=re.escape(words)):
        check_settings(Settings(**values), pinion)


def test_the_ends_of_the_ranges_are_on_the_gear(pinion):
    where = profile_range(pinion)
    for values in (
        {"pitch_roll": pinion.form_roll - 1e-9}, {"pitch_roll": pinion.tip_roll}, {"helix_between": (0.0, 15.0)},
        {"control_roll": pinion.form_roll, "profile_end": pinion.tip_roll}, {"profile_cutoff": where.length}, {"sector": 11},
    ):  # fmt: skip
        check_settings(Settings(**values), pinion)


def test_on_a_ring_roll_falls_from_root_to_tip():
    root, tip = RING.form_roll, RING.tip_roll
    check_settings(Settings(control_roll=root - 1.0, profile_end=tip + 1.0), RING)
    with pytest.raises(InputError, match="from root to tip would be right"):
        check_settings(Settings(control_roll=tip + 1.0, profile_end=root - 1.0), RING)


def test_the_bounds_of_a_filter_go_with_the_gear():
    """0.02 mm is fine for a module of 0.2 mm, whose profile is 0.7 mm long."""
    check_settings(Settings(profile_cutoff=0.02), Gear.from_spec(GearSpec("gear", 20, 0.2, 2.0)))
