"""A drawing has tolerances and a root is seldom known: what is wrong on it is neither wear nor a cause, and wear does not follow it.

The scan is the bundled example, made by a generator of its own: 33.24 mm³ of wear, 18 µm of spray, a table off by 0.02° twice a turn.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.closing import measure
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design import parse_design
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.wear.regions import find_wear
from tests.commands.doors import thinner_example
from tests.placing.placing import designed
from tests.synthetic import PINION, Recipe, Texture, make_scan
from tests.synthetic.removal import SlidingWear

pytestmark = pytest.mark.long

TRUTH = json.loads(gw.example("truth.json").read_text(encoding="utf-8"))["volume_mm3"]
DRAWN = {"teeth": 12, "module": 6.35, "face_width": 15.0, "rack_tip_radius": 0.3}
DRAWINGS = {
    "dimensions within tolerance": {"face_width": 14.90, "tip_diameter": 88.82, "dedendum": 1.26},
    "another hob": {"rack_tip_radius": 0.38},
    "a sharper hob": {"rack_tip_radius": 0.25},
}


@pytest.fixture(scope="module")
def against(tmp_path_factory) -> Callable[[str], MeasuredGear]:
    """The scan against one of the drawings, or the right one by the name of none; each is measured once."""
    file = thinner_example(tmp_path_factory.mktemp("scan"), 8)
    return cache(lambda name: measure(parse_design({"pinion": {**DRAWN, **DRAWINGS.get(name, {})}}), [file]))


@pytest.fixture(params=DRAWINGS)
def gear(request, against) -> MeasuredGear:
    return against(request.param)


def test_wear_does_not_follow_the_drawing(gear):
    wear = find_wear(gear.as_made, gear.noise, gear.worn_sides, gear.loop)
    assert abs(wear.volume - TRUTH) < 2.0 * wear.volume_std
    assert {region.side for region in wear.regions} == {Side.LEFT} and len(wear.regions) == 12


def test_what_is_named_is_in_the_scan(gear):
    names = {effect.name: set(effect.alternatives) for effect in gear.loop.effects}
    assert set(names) == {"coating", "turntable_angle"}
    assert names["turntable_angle"] == set()
    (coat,) = (effect for effect in gear.loop.effects if effect.name == "coating")
    value, std = coat.parameters["thickness_um"].value, coat.parameters["thickness_um"].std
    assert abs(value - 18.0) < 3.0 * std


def test_a_coat_is_told_from_thicker_teeth_only_where_the_drawing_tells(against):
    """With tips, ends and roots off the drawing, each by its own amount, nothing is left to tell a coat from thicker teeth."""
    wrong, right = against("dimensions within tolerance"), against("right")
    of = {"wrong": wrong, "right": right}
    coats = {name: next(e for e in one.loop.effects if e.name == "coating") for name, one in of.items()}
    assert "tooth_thickness" in coats["wrong"].alternatives
    assert coats["right"].alternatives == ()
    levels = {level.name: level.parameters for level in wrong.loop.form}
    assert {"tip_diameter", "face_width", "root_form"} <= set(levels)
    # The gear is 88.9 mm over the tips and 15 mm wide; its coat is taken off.
    assert levels["tip_diameter"]["diameter_um"].value == pytest.approx(80.0, abs=5.0)
    assert levels["face_width"]["width_um"].value == pytest.approx(100.0, abs=8.0)


@pytest.mark.parametrize(
    ("table", "line"),
    [
        ({"tolerance": 0.1}, "must be a table"),
        ({"tolerance": {"tip": 0.1}}, "tip_diameter"),
        ({"tolerance": {"face_width": -0.1}}, "from 0 to 10"),
        ({"tolerance": {"flank_class": 13}}, "from 1 to 12"),
        ({"tolerance": {"flank_class": 7.5}}, "whole number"),
        ({"tolerance": {"flank_class": True}}, "flank_class"),
    ],
)
def test_a_wrong_tolerance_is_refused(table, line):
    with pytest.raises(InputError, match=line):
        parse_design({"gear": {**DRAWN, **table}})


def test_stated_tolerances_are_taken_and_the_rest_is_usual():
    gear = parse_design({"gear": {**DRAWN, "tolerance": {"face_width": 0.02}}}).gears["gear"]
    assert gear.tolerance.face_width == 0.02
    assert 0.1 < gear.tolerance.tip_diameter < 0.3
    assert gear.tolerance.flank_class == 8
    assert parse_design({"gear": {**DRAWN, "tolerance": {"flank_class": 5}}}).gears["gear"].tolerance.flank_class == 5


@pytest.mark.parametrize("factors", [(), tuple(np.linspace(0.5, 1.5, 20))], ids=["alike", "each otherwise"])
def test_both_sides_worn_by_a_reversing_drive(factors, tmp_path):
    """80 and 50 µm at the form circle; Archard's law, which no fit here assumes of the other side."""
    wear = (SlidingWear(80.0, 1, factors, "archard"), SlidingWear(50.0, -1, factors, "archard"))
    recipe = Recipe(gear=replace(PINION, teeth=20, module=4.0), wear=wear, noise_um=6.0, texture=Texture(1.0, 1.0))
    scan = make_scan(recipe.of_size(20_000), 11)
    file = tmp_path / "scan.npy.xyz"
    np.savetxt(file, scan.views[0], fmt="%.5f")
    design = {"teeth": 20, "module": 4.0, "face_width": 15.0, "rack_tip_radius": 0.3}
    found = measure(parse_design({"gear": design}), [file])
    assert designed(recipe.gear).teeth == found.gear.teeth
    assert found.worn_sides == frozenset(Side)
    assert not found.loop.effects
    volume = find_wear(found.as_made, found.noise, found.worn_sides, found.loop)
    assert abs(volume.volume - scan.truth.volume_mm3) < 3.0 * volume.volume_std + 0.03 * scan.truth.volume_mm3
