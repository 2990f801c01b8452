"""One encoding of left and right: what the flanks, the wear and the contact mean by a side is the same."""

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side, sides_given
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points
from gearwear.errors import InputError
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.linear import linear_contact

PINION, WHEEL = (Gear.from_spec(GearSpec(name, z, 6.35, 15.0)) for name, z in (("pinion", 12), ("gear", 24)))


@pytest.mark.parametrize("side", list(Side))
def test_the_left_flank_lies_counter_clockwise_of_its_tooth(side):
    point = flank_points(PINION, np.array([0]), np.array([side]), np.array([PINION.reference_roll]), np.array([7.5]))
    angle = float(np.arctan2(point.position[0, 1], point.position[0, 0]))
    assert np.sign(angle) == (1 if side is Side.LEFT else -1)
    assert (Side.LEFT.index, Side.RIGHT.index) == (0, 1)
    assert side.opposite == -side


@pytest.mark.parametrize("given", [Side.RIGHT, -1, "right"])
def test_a_side_by_its_sign_and_by_its_name(given):
    assert Side.of(given) is Side(given) is Side.RIGHT
    assert PINION.drawn(given).side is Side.RIGHT


@pytest.mark.parametrize("given", [0, 2, "", "Left", True, None, 1.5])
def test_anything_else_is_refused(given):
    with pytest.raises(InputError, match="would be right"):
        Side.of(given)
    with pytest.raises(InputError, match="would be right"):
        mesh_contact(nominal_profiles(PINION), nominal_profiles(WHEEL), 114.3, given)
    with pytest.raises(InputError, match="would be right"):
        PINION.drawn(given)
    if given is not True:  # which equals 1, and to Python is that member
        with pytest.raises(InputError, match=f"^side {given!r}: gw.Side.LEFT or gw.Side.RIGHT"):
            Side(given)


@pytest.mark.parametrize("given", ["left", Side.LEFT, 1, {"up"}, [0]])
def test_sides_are_a_set_of_sides(given):
    assert sides_given({"left", Side.RIGHT}, "worn") == frozenset(Side) and sides_given((), "worn") == frozenset()
    with pytest.raises(InputError, match=r"^(worn|side) .*gw\.Side\.LEFT.* would be right"):
        sides_given(given, "worn")


@pytest.mark.parametrize("contact", [mesh_contact, linear_contact])
@pytest.mark.parametrize(("worn", "drives"), [(a, b) for a in Side for b in Side])
def test_only_the_flank_that_carries_lags_by_its_loss(contact, worn, drives):
    """0.1 mm off all flanks of one side: carried by them the mate lags by that, by the others not at all; the play is the same."""
    own = nominal_profiles(PINION, np.linspace(PINION.root_radius, PINION.tip_radius, 60))
    own.half_angle[:, worn.index] -= 0.1 / PINION.base_radius
    found = contact(own, nominal_profiles(WHEEL), 114.3, drives)
    assert np.allclose(found.transmission_error, -0.1 if worn is drives else 0.0, atol=2e-5)
    assert np.allclose(found.backlash, 0.1, atol=2e-5)
