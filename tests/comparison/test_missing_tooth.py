"""A tooth broken off near its root says nothing of the root that the others share, and neither it nor its stump is worn."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.pair import Design
from tests.diagnose.plain import plain_effects
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch

GEAR = Helical(teeth=16, module=4.0, helix=0.0, width=14.0, shift=0.0)
WORN = Patch(5, 1, 0.1, (8.0, 18.0), (2.0, 12.0))
NOISE = 0.005


def broken(height: float, seen: bool = True):
    """A scan of which tooth 0 ends `height` mm above the root, in a wavy fracture."""
    cloud, rng = scan(GEAR, 25_000, noise=NOISE, seed=7, wear=(WORN,)), np.random.default_rng(8)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    radius, angle = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    points = points[(np.abs(angle) > np.pi / GEAR.teeth) | (radius < GEAR.root + height)]
    foot, half = GEAR.fillet()
    wide = float(np.interp(GEAR.root + height, foot, half))
    if seen:
        z, theta = rng.uniform(0.0, GEAR.width, 1500), rng.uniform(-wide, wide, 1500)
        r = GEAR.root + height - 0.1 * np.abs(np.sin(2.0 * z + 40.0 * theta))
        surface = np.column_stack([r * np.cos(theta), r * np.sin(theta), z])
        points = np.vstack([points, surface + rng.normal(0.0, NOISE, surface.shape)])
    return points @ cloud.rotation.T + cloud.translation


@cache
def found(height: float, seen: bool = True):
    with plain_effects():
        return gw.find_effects(gw.register(Design({"gear": designed(GEAR)}), gw.as_scan(broken(height, seen))), frozenset())


@pytest.mark.parametrize("height", [pytest.param(0.7, marks=pytest.mark.long), 1.8])
def test_a_fracture_is_no_root_and_a_stump_no_flank(height):
    measured = found(height)
    (piece,) = measured.broken
    assert (piece.tooth, piece.kind) == (0, "missing tooth")
    assert measured.root.fits_design and measured.root.misfit < 3.0 * NOISE
    wear = gw.find_wear(measured)
    (region,) = wear.regions
    assert (region.tooth, int(region.side)) == (WORN.tooth, WORN.side)
    assert region.volume == pytest.approx(GEAR.volume(WORN), abs=3.0 * region.volume_std)
    # The missing tooth has no limit of detection, and takes nothing from those of the others.
    said = {one.tooth: one.depth for one in wear.flanks if one.says}
    assert set(said) == set(range(1, GEAR.teeth))
    assert max(said.values()) < 10.0 * NOISE


def test_a_tooth_of_which_the_fillets_alone_are_seen_is_not_seen():
    (piece,) = found(1.2, seen=False).broken
    assert (piece.tooth, piece.kind) == (0, "not seen")
