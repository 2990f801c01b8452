"""What a measured gear is said to have lost: of what is drawn, whatever that modifies and wherever the reference circle is."""

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.modification import FlankModification
from gearwear.design.pair import Design
from gearwear.design.spec import GearSpec, PairSpec

MODIFIED = FlankModification(helix_crowning=0.02, tip_relief=0.015, tip_relief_length=3.0)


def pair(shift: float = 0.0, teeth: int = 20, **drawn: FlankModification) -> Design:
    spec = GearSpec("pinion", teeth, 3.0, 20.0, profile_shift=shift, **drawn)
    gears = {"pinion": gw.Gear.from_spec(spec), "gear": gw.Gear.from_spec(GearSpec("gear", 40, 3.0, 20.0, profile_shift=-shift))}
    return Design(gears, PairSpec(None))


@pytest.fixture(autouse=True)
def few_positions(monkeypatch):
    monkeypatch.setattr("gearwear.meshing.study.POSITIONS", 3)


@pytest.mark.parametrize("drawn", [{}, pytest.param({"left": MODIFIED, "right": MODIFIED}, marks=pytest.mark.long)])
def test_an_unworn_gear_has_lost_nothing(drawn):
    design = pair(**drawn)
    found = gw.study_meshing(design, gw.nominal_profiles(design.gears["pinion"]))
    assert found.worn.loss == 0.0 and found.worn.tooth is None and found.shafts is None


@pytest.mark.parametrize("shift", [0.0, 1.3])
def test_a_loss_of_the_flank_is_found_where_the_reference_circle_lies_within_the_root(shift):
    """Turned by d / r_b the flank is thinner by d r / r_b of arc, also of a gear whose root circle lies outside its reference circle."""
    design = pair(shift, 40)
    gear = design.gears["pinion"]
    assert (gear.root_radius > gear.reference_radius) == (shift > 1.25)
    new = gw.nominal_profiles(gear, np.union1d(np.linspace(gear.root_radius, gear.tip_radius, 150), gear.form_radius))
    worn = new.half_angle.copy()
    worn[4, 0][:, new.radius >= gear.form_radius] -= 0.03 / gear.base_radius
    found = gw.study_meshing(design, replace(new, half_angle=worn), cycle="revolution").worn
    assert found.tooth == 4
    assert found.loss == pytest.approx(0.03 * gear.reference_radius / gear.base_radius, rel=1e-9)


def test_a_thickness_beyond_what_is_known_is_refused():
    profiles = gw.nominal_profiles(pair(1.3, 40).gears["pinion"])
    with pytest.raises(gw.InputError, match=r"radius 60 mm: the profiles are known from 60\.15"):
        profiles.thickness(60.0)
