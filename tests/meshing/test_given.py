"""What a Python caller gives a meshing study: one tooth is as good as a list of it, and what cannot be is refused by its name."""

import math

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.spec import GearSpec
from gearwear.loaded.contact import loaded_contact, pair_compliance
from gearwear.meshing.clearance import interference, interference_free_centre_distance
from gearwear.meshing.contact import mesh_contact

DESIGN = gw.read_design(gw.example())
PAIR = tuple(DESIGN.gears.values())
NEW = tuple(gw.nominal_profiles(gear) for gear in DESIGN.gears.values())


@pytest.fixture(autouse=True)
def few_positions(monkeypatch):
    monkeypatch.setattr("gearwear.meshing.study.POSITIONS", 3)


@pytest.mark.long
def test_one_tooth_may_be_a_number():
    one, listed, other = (gw.study_meshing(DESIGN, loss=0.05, teeth=teeth) for teeth in (3, [3], np.int64(3)))
    assert one.worn == listed.worn == other.worn and one.worn.source.endswith("of tooth 3 of the pinion")
    np.testing.assert_array_equal(one.contact.backlash, listed.contact.backlash)


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: gw.study_meshing(DESIGN, loss="0.05"), "loss = '0.05': a number, in mm, would be right"),
        (lambda: gw.study_meshing(DESIGN, loss=True), "loss = True: a number, in mm, would be right"),
        (lambda: gw.study_meshing(DESIGN, centre_distance="114.3"), "centre_distance = '114.3': a number, in mm"),
        (lambda: gw.study_meshing(DESIGN, wear=3), "wear = 3: a path or profiles, or one of either gear, would be right"),
        (lambda: gw.study_meshing(DESIGN, wear=[NEW[0], 3]), "wear = 3: a path"),
        (lambda: gw.study_meshing(DESIGN, loss=0.05, teeth=2.5), "teeth 2.5: the pinion has teeth from 1 to 12"),
        (
            lambda: gw.study_load(DESIGN, load=gw.LoadSpec(load_per_width=9.0), centre_distance="114.3"),
            "centre_distance = '114.3'",
        ),
        (lambda: gw.LoadSpec(torque="5"), "torque = '5': a number, in N mm, would be right"),
        (lambda: gw.LoadSpec(torque=5e3, poisson="0.3"), "poisson = '0.3': a number would be right"),
        (lambda: mesh_contact(*NEW, "114.3"), "centre_distance = '114.3'"),
        (lambda: mesh_contact(*NEW, 114.3, variants=[NEW[:1]]), "variants: 1 given; pairs (driver, driven) of profiles would"),
        (lambda: gw.study_load(DESIGN, iter(NEW[:1])), "flanks: 1 given; profiles (pinion, gear) would be right"),
        (lambda: gw.study_load(DESIGN, drawn=NEW), "drawn = "),
        (lambda: gw.study_load(DESIGN, drawn=[(NEW[0], 3)]), "one of drawn of type int: what gw.nominal_profiles returns would"),
        (lambda: mesh_contact(*NEW, math.inf), "centre distance inf mm: a finite one would be right"),
        (lambda: mesh_contact(*NEW, 114.3, tolerances=0.001), "tolerances 0.001: a sequence of one or more would be right"),
        (
            lambda: mesh_contact(*NEW, 114.3, tolerances=(0.001, math.nan)),
            "tolerances = nan: numbers from 0 up, in mm, would be right",
        ),
        (lambda: gw.exact_meshing(*PAIR, "114.3"), "centre_distance = '114.3': a number, in mm, would be right"),
        (lambda: gw.exact_meshing(*PAIR, np.array([114.3, 115.0])), "centre_distance = array([114.3, 115. ]): a number, in mm"),
        (lambda: gw.shaft_movement(*PAIR, 114.3, "1.9"), "thickness_loss = '1.9': a number, in mm, would be right"),
        (lambda: gw.shaft_movement(*PAIR, 114.3, 1.9, None), "backlash = None: a number, in mm, would be right"),
        (lambda: loaded_contact(*NEW, 114.3, "100", pair_compliance(*NEW)), "force = '100': a number, in N,"),
        (lambda: gw.as_dict(DESIGN), "result = Design: one of compare, inspect or study_meshing would be right"),
    ],
)
def test_what_cannot_be_is_refused_by_its_name(call, named):
    with pytest.raises(gw.InputError) as refused:
        call()
    assert named in str(refused.value)


@pytest.mark.parametrize(
    ("loss", "said"), [(None, ["as designed"]), (0.03, ["as they are", "as designed"]), (0.1, ["as designed"])]
)
def test_a_pair_too_close_is_told_so_as_designed_and_as_it_is(loss, said):
    """0.1 mm closer than without backlash takes 0.068 mm of it: 0.03 mm of wear leave an overlap, 0.1 mm leave none."""
    notes = [note for note in gw.study_meshing(DESIGN, loss=loss, centre_distance=114.2).notes if "the teeth overlap by" in note]
    assert [note.split(" the teeth")[0] for note in notes] == said
    assert "at least 114.3000 mm would be right" in notes[-1]
    assert not any("overlap" in note for note in gw.study_meshing(DESIGN, loss=loss).notes)


def test_a_pair_too_close_is_told_so_under_load(monkeypatch):
    monkeypatch.setattr("gearwear.loaded.study.SLICES", 1)
    load = gw.LoadSpec(load_per_width=9.0)
    close, apart = (gw.study_load(DESIGN, load=load, centre_distance=a, cycle="pitch").notes for a in (114.2, 114.3))
    assert any("at least 114.3000 mm would be right" in note for note in close) and not any("overlap" in note for note in apart)


def test_numbers_of_numpy_are_numbers():
    found = gw.study_meshing(DESIGN, loss=np.float64(0.05), centre_distance=np.float32(114.5))
    assert found.worn.loss > 0.0 and gw.LoadSpec(torque=np.float64(5e3)).torque == 5e3


def test_interference_free_is_the_distance_of_the_interference_point_not_of_the_form_circle():
    """What `CentreDistances.interference_free` tells: there the deeper tip ends on the line of action, below the mate's form circle."""
    pinion, gear = (gw.Gear.from_spec(GearSpec(part, z, 3.0, 20.0)) for part, z in (("pinion", 20), ("gear", 40)))
    at = interference_free_centre_distance(pinion, gear)
    found = interference(pinion, gear, at)
    assert found.overrun == pytest.approx(0.0, abs=1e-9) and found.below_form > 0.1
