"""Impossible gears are refused by name and number; the bound that the message gives is the real one."""

import math
import re

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from tests.design.cutting import cut_depth


def _build(teeth: int = 20, **values: float) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, **{"normal_module": 2.0, "face_width": 10.0, **values}))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"teeth": 4}, "teeth = 4: must be a whole number from 5 to 10000"),
        ({"teeth": 10_001}, "teeth = 10001: must be a whole number from 5 to 10000"),
        ({"teeth": 20.0}, "teeth = 20.0: must be a whole number"),
        ({"teeth": "20"}, "teeth = '20': must be a whole number"),
        ({"teeth": True}, "teeth = True"),
        ({"teeth": 10**5000}, "teeth = a number of thousands of digits"),
        ({"normal_module": 0.0}, "module = 0 mm: must lie from 0.001 to 1000"),
        ({"normal_module": math.nan}, "module = nan mm"),
        ({"normal_module": -2.0}, "module = -2 mm"),
        ({"face_width": 0.0}, "face_width = 0 mm"),
        ({"normal_pressure_angle": math.radians(60.0)}, "pressure_angle = 60 degrees: must lie from 5 to 45"),
        ({"normal_pressure_angle": math.radians(0.349)}, "must lie from 5 to 45; 0.349 radians would be 20 degrees"),
        ({"profile_shift": 3.5}, "profile_shift = 3.5 modules"),
        ({"addendum": math.inf}, "addendum = inf modules"),
        ({"dedendum": -0.1}, "dedendum = -0.1 modules"),
        ({"rack_tip_radius": -0.1}, "rack_tip_radius = -0.1 modules"),
        ({"thinning": 2.5}, "thinning = 2.5 mm: must lie from -2 to 2"),
        ({"bore_diameter": -1.0}, "bore_diameter = -1 mm"),
        ({"tip_chamfer": -0.1}, "tip_chamfer = -0.1 mm"),
        ({"end_chamfer": -0.1}, "end_chamfer = -0.1 mm"),
        ({"addendum": -1.5}, "tip diameter 34.0000 mm and root diameter 35.0000 mm"),
        ({"teeth": 5, "dedendum": 3.0}, "root diameter -2.0000 mm"),
        ({"teeth": 12, "addendum": -0.5, "profile_shift": -0.3}, "lies inside the base circle"),
        ({"addendum": 1.9, "profile_shift": 0.5}, "the tooth is pointed"),
        ({"tip_chamfer": 1.6}, "the tooth is pointed: at tip diameter 44.0000 mm the top land is -0.0872 mm"),
        ({"teeth": 6, "profile_shift": 0.6, "addendum": 0.8, "tip_chamfer": 0.1}, "more than the 45° of the chamfer"),
        ({"rack_tip_radius": 0.6}, "too large for dedendum 1.25 and 20°, at most 0.4719"),
        ({"teeth": 8, "addendum": -0.2}, "reaches the flank's end 15.2000 mm: no involute is left"),
        ({"teeth": 8, "profile_shift": -1.0, "dedendum": 0.9, "rack_tip_radius": 0.0, "thinning": 2.0}, "no tooth is left"),
        ({"profile_shift": 1.25, "rack_tip_radius": 0.0, "addendum": 0.3}, "folds back on itself"),
        ({"bore_diameter": 35.0}, "bore_diameter = 35 mm: must be below the root diameter 35.0000 mm"),
        ({"end_chamfer": 5.0}, "end_chamfer = 5 mm: must be below half the face width 10 mm"),
    ],
)
def test_impossible_gears_are_refused_by_name_and_number(values, message):
    with pytest.raises(InputError, match=re.escape(message)) as refused:
        _build(**values)
    assert str(refused.value).startswith("[gear] ")
    assert "\n" not in str(refused.value)


def test_teeth_counted_by_numpy_are_those_of_the_same_gear():
    counted = GearSpec("gear", np.int64(12), 2.0, 10.0)
    assert counted == GearSpec("gear", 12, 2.0, 10.0)
    assert type(counted.teeth) is int


def test_greatest_rack_tip_radius_is_the_full_radius_of_the_rack():
    """0.4719 m for a dedendum of 1.25 m at 20°: the two arcs meet on the rack tooth's centre line."""
    assert _build(rack_tip_radius=0.4719).rack.centre_offset == pytest.approx(0.0, abs=2e-4)
    with pytest.raises(InputError, match="rack_tip_radius"):
        _build(rack_tip_radius=0.4720)


def test_pointed_diameter_of_the_message_is_where_the_flanks_meet():
    with pytest.raises(InputError, match="pointed") as refused:
        _build(teeth=12, normal_module=6.35, addendum=1.5)
    diameter = re.search(r"flanks meet at diameter ([\d.]+)", str(refused.value))
    assert diameter is not None
    assert abs(0.5 * float(diameter[1]) - 47.0049) <= 1e-4  # the reference's pointed radius of this pinion


def test_a_tooth_cut_off_at_its_root():
    """The rack itself, rolled past, cuts the tooth's centre line."""
    spec = GearSpec("gear", 7, 2.0, 10.0, profile_shift=-0.9)
    with pytest.raises(InputError, match="cuts the tooth off at its root"):
        Gear.from_spec(spec)
    radius = np.linspace(3.0, 7.0, 81)
    assert (cut_depth(spec, radius, np.full(81, math.pi / 7)) > 0.0).any()
    thick = GearSpec("gear", 7, 2.0, 10.0, profile_shift=-0.5)
    Gear.from_spec(thick)
    assert (cut_depth(thick, radius, np.full(81, math.pi / 7)) < 0.0).all()
