"""What the public dataclasses of ``import gearwear as gw`` take: whatever else a caller gives is refused in words, and never in another error."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import fields

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.modification import FlankModification
from gearwear.design.spec import PairSpec
from gearwear.design.tolerance import GearTolerance

GEAR = {"name": "pinion", "teeth": 20, "normal_module": 2.0, "face_width": 10.0}
BASES = {
    gw.Settings: {},
    gw.LoadSpec: {"torque": 5e3},
    gw.GearSpec: GEAR,
    gw.Ahead: {"cycles_run": 1e6},
    PairSpec: {},
    GearTolerance: {},
}
FIELDS = [(kind, field.name) for kind in BASES for field in fields(kind)]
NEVER_RIGHT = {
    "complex": 1j, "bytes": b"x", "object": object(), "function": len, "two words": ("a", "b"), "infinite": math.inf, "not a number": math.nan,
    "an array of one": np.array([3.0]), "an array of no axis": np.array(3.0), "three": (1.0, 2.0, 3.0), "thousands of digits": -(10**4000),
}  # fmt: skip
"""Right for no field."""
SELDOM_RIGHT = {
    "none": None,
    "a word": "left",
    "true": True,
    "two": (2.0, 1.0),
    "two in an array": np.array([1.0, 2.0]),
    "below 0": -1.0,
    "none in it": (),
    "a table": np.ones((2, 2)),
}
"""Right for some."""


@pytest.mark.parametrize(("kind", "name"), FIELDS)
def test_no_field_takes_what_is_wrong_for_all_nor_ends_in_another_error(kind, name):
    base = {} if name == "load_per_width" else BASES[kind]
    for odd, value in NEVER_RIGHT.items():
        with pytest.raises(gw.InputError, match=r"^[^\n]*\b(right|must|needed)\b[^\n]*$"):
            kind(**{**base, name: value})
            pytest.fail(f"{odd} was taken")
    for value in SELDOM_RIGHT.values():
        with suppress(gw.InputError):
            kind(**{**base, name: value})


@pytest.mark.parametrize("name", [field.name for field in fields(FlankModification)])
def test_nor_does_a_modification_which_the_gear_looks_at(name):
    for odd, value in NEVER_RIGHT.items():
        with pytest.raises(gw.InputError):
            gw.GearSpec(**GEAR, left=FlankModification(**{name: value}))
            pytest.fail(f"{odd} was taken")
    for value in SELDOM_RIGHT.values():
        with suppress(gw.InputError):
            gw.GearSpec(**GEAR, left=FlankModification(**{name: value}))


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: gw.GearSpec("pinion", 20, "2", 10.0), "[pinion] module = '2': a number, in mm, would be right"),
        (lambda: gw.GearSpec("pinion", 20, np.array([2.0]), 10.0), "[pinion] module = array([2.]): a number, in mm, would be right"),
        (lambda: gw.GearSpec("pinion", 20, True, 10.0), "[pinion] module = True: a number, in mm, would be right"),
        (lambda: gw.GearSpec("pinion", 20, 2.0, 10.0, None), "[pinion] normal_pressure_angle = None: a number, in rad, would be right"),
        (lambda: gw.GearSpec(**GEAR, helix_angle="15"), "[pinion] helix_angle = '15': a number, in rad, would be right"),
        (lambda: gw.GearSpec(20, 20, 2.0, 10.0), 'name of type int: "pinion" or "gear" would be right'),
        (lambda: gw.GearSpec(**GEAR, internal="no"), "[pinion] internal of type str: True or False would be right"),
        (lambda: gw.GearSpec(**GEAR, left=0.02), "[pinion] left of type float: a FlankModification would be right"),
        (lambda: gw.GearSpec(**GEAR, cutter_teeth=""), "[pinion] cutter_teeth = '': a number would be right"),
        (lambda: gw.GearSpec(**GEAR, modified_between=3.0), "[pinion] modified_between = 3.0: two lengths in mm would be right"),
        (
            lambda: gw.GearSpec(**GEAR, left=FlankModification(tip_relief=0.02, tip_relief_length=1.0, tip_relief_form="round")),
            "[pinion] tip_relief_form = 'round': one of ",
        ),
        (lambda: gw.GearSpec(**GEAR, left=FlankModification(tip_relief="0.02")), "[pinion] tip_relief = '0.02': a number, in mm,"),
        (lambda: PairSpec(baseline="design"), "[pair] baseline = 'design': one of zero_backlash, with_allowance, pre_wear_scan would"),
        (lambda: GearTolerance(flank_class=True), "[gear.tolerance] flank_class = True: a whole number would be right"),
        (lambda: GearTolerance(thickness="0.02"), "[gear.tolerance] thickness = '0.02': a number, in mm, would be right"),
        (lambda: gw.Settings(edition=np.array([1.0, 2.0])), "edition = array([1., 2.]): one of "),
        (lambda: gw.Settings(axis=np.array([0.0, 0.0, 1.0])), "axis = array([0., 0., 1.]): one of teeth, bore"),
        (lambda: gw.Settings(k_bands="k.csv"), "k_bands of type str: a KBands, or None, would be right"),
        (lambda: gw.Settings(laboratory="yes"), "laboratory of type str: True or False would be right"),
        (lambda: gw.Settings(profile_band=(12.0, 1.5)), "profile_band = 12 to 1.5 mm: from the lower z to the higher one would be right"),
        (lambda: gw.LoadSpec(torque=10**400), "torque = 1000000"),
        (lambda: gw.Ahead(None), "cycles_run = None: a number above 0, the cycles in which the wear came about, would be right"),
        (lambda: gw.Ahead(0.0), "cycles_run = 0.0: a number above 0"),
        (lambda: gw.Ahead(1e6, 2e6), "cycles = 2000000.0: a list of cycles since new would be right"),
        (lambda: gw.Ahead(1e6, (5e5,)), "cycles = 500000.0: a number from cycles_run, 1000000, up would be right"),
        (lambda: gw.Ahead(1e6, limits=("depth", 0.2)), "limits = 'depth': pairs such as ('depth', 0.2), in mm, would be right"),
        (lambda: gw.Ahead(1e6, limits=((0.2, "depth"),)), "what limits are of = 0.2: one of depth, thickness, backlash would be right"),
        (lambda: gw.Ahead(1e6, limits=(("depth", -0.2),)), "limit of the depth = -0.2: a number above 0, in mm, would be right"),
    ],
)  # fmt: skip
def test_a_refusal_says_what_where_and_what_would_be_right(call, said):
    with pytest.raises(gw.InputError) as refused:
        call()
    assert said in str(refused.value)


def test_what_numpy_has_is_as_good():
    assert gw.GearSpec("pinion", np.int64(20), np.float32(2.0), np.int64(10), internal=np.bool_(False)).teeth == 20
    assert gw.Ahead(np.int64(10**6), np.array([2e6, 5e6]), [["depth", np.float64(0.2)]]).cycles_run == 1e6
    assert gw.Settings(profile_band=np.array([1.0, 9.0]), laboratory=np.bool_(True)).laboratory
