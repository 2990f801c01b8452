"""New gears as they are ground: a form of one side alone, rounded ends and a nicked corner are no wear, and no instrument's error."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.pair import Design
from gearwear.diagnose.effects.base import Kind
from gearwear.placing.edges import rounded_ends
from gearwear.wear.edges import at_ends_only, end_strip
from tests.diagnose.plain import plain_effects
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch

GEAR = Helical(teeth=17, helix=10.0, width=12.0)
ROUNDING = 0.7
"""Height over which the ends fall off, mm: more than the strip that a helix evaluation leaves out."""


def form(side, roll, z):
    """What wheels dressed for each side grind: slopes of 30 and 8 µm and waves of 10 and 3 µm along the profile, alike on all teeth."""
    share = (roll - roll.min()) / np.ptp(roll)
    left = 0.030 * (share - 0.5) + 0.010 * np.sin(3.0 * np.pi * share)
    return np.where(side > 0, left, 0.008 * (share - 0.5) + 0.003 * np.sin(3.0 * np.pi * share + 1.0))


def rounded(side, roll, z):
    """Ends broken on both sides, as by a brush."""
    inside = np.minimum(z, GEAR.width - z)
    return -0.15 * np.maximum(1.0 - inside / ROUNDING, 0.0) ** 2


@cache
def measured(*added, wear=()):
    gear = Design({"gear": designed(GEAR)})
    cloud = scan(
        GEAR, 25_000, noise=0.002, seed=3, wear=wear, added=lambda *at: sum((one(*at) for one in added), np.zeros(len(at[0])))
    )
    return gw.find_effects(gw.register(gear, gw.as_scan(cloud.points)))


@pytest.mark.long
def test_a_form_of_one_side_is_how_it_was_ground():
    """With a profile that both sides must share as the only other answer, 17 flanks were called worn."""
    found = measured(form)
    assert not found.loop.worn_sides
    assert not [effect for effect in found.loop.effects if effect.kind is not Kind.MANUFACTURE]
    assert not gw.find_wear(found).regions


@pytest.mark.long
def test_rounded_ends_are_no_wear_and_hide_none():
    patch = Patch(4, 1, 0.08, (4.0, 14.0), (3.0, 9.0))
    assert not gw.find_wear(measured(rounded)).regions
    (region,) = gw.find_wear(measured(rounded, wear=(patch,))).regions
    assert (region.tooth, region.side) == (4, 1)
    assert region.volume == pytest.approx(GEAR.volume(patch), abs=3.0 * region.volume_std)


@pytest.mark.long
def test_where_ends_are_rounded_is_seen():
    found = measured(rounded)
    edges = found.cells.grid.flank_shape(rounded_ends(found.first, found.noise))
    rows = edges.any(axis=(0, 1, 3))
    height = (np.arange(len(rows)) + 0.5) / len(rows) * GEAR.width
    inside = np.minimum(height, GEAR.width - height)
    assert rows[inside < 0.4 * ROUNDING].all() and not rows[inside > 1.3 * ROUNDING].any()
    assert not rounded_ends(measured(form).first, found.noise).any()


def test_a_nick_at_an_end_is_an_edge():
    nick = Patch(6, -1, 0.06, (5.0, 20.0), (-0.9, 0.9))
    with plain_effects():
        wear = gw.find_wear(measured(wear=(nick,)))
    assert not wear.regions and wear.edges == 1 and wear.edge_depth > 0.01


def test_only_what_lies_in_the_zone_alone_is_an_edge():
    mask, zone = np.zeros((3, 2, 6, 4), dtype=bool), np.zeros((2, 6, 4), dtype=bool)
    zone[:, :2] = True
    mask[0, 0, :2] = mask[1, 1, 1:3] = True
    assert np.argwhere(at_ends_only(mask, zone)).tolist() == [[0, 0]]
    assert end_strip(designed(GEAR)) == pytest.approx(0.05 * GEAR.width)
