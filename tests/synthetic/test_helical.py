"""The helical generator against the design room: two routes to one surface."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import OTHER, locate
from tests.synthetic.helical import Helical, scan
from tests.synthetic.tooth import Patch

GEARS = (Helical(), Helical(teeth=11, helix=-12.0, shift=0.0), Helical(teeth=21, helix=33.0, width=25.0, tip_radius=0.2))


def designed(gear: Helical) -> Gear:
    return Gear.from_spec(
        GearSpec(
            "gear", gear.teeth, gear.module, gear.width, math.radians(gear.pressure), gear.shift, gear.addendum, gear.dedendum,
            gear.tip_radius, helix_angle=math.radians(gear.helix),
        )
    )  # fmt: skip


@pytest.mark.parametrize("gear", GEARS)
def test_every_point_lies_on_the_design(gear):
    cloud = scan(gear, 6000, noise=0.0)
    found = locate((cloud.points - cloud.translation) @ cloud.rotation, designed(gear))
    assert (found.surface != OTHER).all()
    assert np.abs(found.deviation).max() < 2e-5  # chords of the root's table
    assert np.abs(found.deviation[found.surface == 0]).max() < 1e-11


@pytest.mark.parametrize("gear", GEARS)
def test_wear_and_coat_are_along_the_normal(gear):
    cloud = scan(gear, 6000, noise=0.0, coat=0.02)
    found = locate((cloud.points - cloud.translation) @ cloud.rotation, designed(gear))
    known = found.surface != OTHER
    assert known.mean() > 0.97  # at edges a coat stands beside the surfaces
    assert found.deviation[known] == pytest.approx(0.02, abs=3e-5)


def test_volume_of_a_patch_is_that_of_the_triangles_between_its_surfaces():
    """By the divergence theorem on a fine grid of both skins; they meet at the patch's edge."""
    gear = Helical()
    patch = Patch(0, 1, 0.4, (5.0, 11.0), (3.0, 11.0))
    roll, z = np.meshgrid(np.linspace(*patch.roll, 400), np.linspace(*patch.z, 400), indexing="ij")

    def skin(depth):
        tau = gear.turn * (z - 0.5 * gear.width) + gear.flank_half(roll) - np.arctan(roll / gear.base)
        along = np.stack([-np.sin(tau), np.cos(tau), 0 * tau], -1)
        up = math.tan(math.radians(gear.helix)) * math.cos(gear.transverse)  # tan β_b
        normal = gear.base_cos * (along - up * np.array([0.0, 0.0, 1.0]))
        return (
            np.stack([gear.base * np.cos(tau), gear.base * np.sin(tau), z], -1)
            + roll[..., None] * along
            - depth[..., None] * normal
        )

    def flux(surface):
        a, b, c, d = surface[:-1, :-1], surface[1:, :-1], surface[1:, 1:], surface[:-1, 1:]
        return sum(np.einsum("ijk,ijk->", p, np.cross(q, r)) for p, q, r in ((a, b, c), (a, c, d))) / 6

    between = abs(flux(skin(0 * roll)) - flux(skin(patch.at(roll, z))))
    assert gear.volume(patch) == pytest.approx(between, rel=2e-4)
