"""What the page draws of a helical pair in contact."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.exact import exact_meshing
from gearwear.report.figures.arrays import meshing_curves
from gearwear.report.write import contact_share

BETA = math.radians(20.0)


@pytest.fixture(scope="module")
def pair():
    """A wide pinion and a narrow gear, thinned."""
    pinion = Gear.from_spec(GearSpec("pinion", 13, 2.0, 20.0, helix_angle=BETA, profile_shift=0.2, thinning=0.05))
    gear = Gear.from_spec(GearSpec("gear", 16, 2.0, 10.0, helix_angle=-BETA, profile_shift=-0.2, thinning=0.05))
    centre = pinion.reference_radius + gear.reference_radius
    flanks = [nominal_profiles(one, np.linspace(one.root_radius, one.tip_radius, 40)) for one in (pinion, gear)]
    contact = mesh_contact(*flanks, centre, positions_per_pitch=17)
    return SimpleNamespace(contact=contact, design=exact_meshing(pinion, gear, centre), drive_side=Side.LEFT)


def test_the_curve_of_a_perfect_pair_is_the_design_s(pair):
    curves = meshing_curves(pair.contact, pair.design)
    play = (
        2 * 0.05 / math.cos(BETA)
    )  # two normal arcs, as arcs of the transverse section; reference and operating circles are one
    np.testing.assert_allclose(1e-3 * curves.backlash_worn_um, play, atol=1e-9)
    np.testing.assert_allclose(1e-3 * curves.backlash_design_um, play, atol=1e-9)


def test_the_pattern_ends_where_the_mate_does(pair):
    share = contact_share(pair, "pinion")[:, 0]
    height = 20.0 * ((np.arange(share.shape[1]) + 0.5) / share.shape[1] - 0.5)
    touched = share.max(axis=(0, 2)) > 0.5
    np.testing.assert_array_equal(touched, np.abs(height) <= 5.0)
    assert (contact_share(pair, "gear")[:, 0].max(axis=(0, 2)) > 0.5).all()
    assert np.isnan(contact_share(pair, "gear")[:, 1]).all()
