"""The wear law of rings, of pinions in them and of double helical gears: flanks worn by Archard's law from drawing data alone, the coefficient asked back."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.worn_pair import beside_mate
from gearwear.design import Gear, GearSpec
from gearwear.design.pair import Design, PairSpec
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.path import path_of_contact, sliding
from gearwear.wear_law.archard import LoadSharing, load_share
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.forecast import cycles_left
from gearwear.wear_law.study import Ahead, as_made_points, study_wear
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.helical import Helical, scan
from tests.synthetic.ring import Ring, ring_scan
from tests.synthetic.test_double_helical import designed as double_designed
from tests.synthetic.test_ring import designed as ring_designed

RING, INSIDE = Ring(shift=0.0, addendum=0.8), Helical(teeth=17, module=2.5, helix=0.0, width=14.0, shift=0.0)
DOUBLE = Double()
LOST = 0.016
"""k w N, mm: depth where |K| is 1 and one pair carries."""


def pair(helix: float = 0.0) -> tuple[Gear, Gear, float]:
    """A pinion and its ring."""
    beta = math.radians(helix)
    pinion = Gear.from_spec(GearSpec("pinion", 17, 2.5, 14.0, helix_angle=beta))
    ring = Gear.from_spec(GearSpec("gear", 42, 2.5, 14.0, addendum=0.8, helix_angle=beta, internal=True, fillet_radius=0.5))
    return pinion, ring, ring.reference_radius - pinion.reference_radius


def worn_by(own: int, mate: int, other, low: float, high: float, cosine: float = 1.0):
    """Archard's wear of left flanks as a deviation along the base tangent, mm: its depth along the normal is `LOST` |K| on the path from `low` to `high`.

    K by the speeds of both flanks along their common tangent, ω L with ω as 1 / z; `other` is the mate's length of roll there, `cosine` cos β_b.
    """

    def depth(side, roll, z):
        slid = np.abs(roll / own - other(roll) / mate) / (roll / own)
        return np.where(side > 0, -LOST / cosine * slid * ((roll > low) & (roll < high)), 0.0)

    return depth


@pytest.mark.parametrize("helix", [0.0, -20.0])
def test_a_ring_first_is_the_same_path_from_its_side(helix):
    """L_2 − L_1 = a sin α_w whoever stands first: ends, pitch point, single contact and sliding are those of the pair the other way round."""
    pinion, ring, centre = pair(helix)
    one, other = path_of_contact(pinion, ring, centre), path_of_contact(ring, pinion, centre)
    line = centre * math.sin(pinion.transverse_pressure_angle)
    assert (other.start_pinion, other.end_pinion) == pytest.approx((one.start_pinion + line, one.end_pinion + line), rel=1e-12)
    assert (other.start_pinion, other.end_pinion) == pytest.approx((one.end_gear, one.start_gear), rel=1e-12)
    assert (other.limit_pinion, other.limit_gear) == (one.limit_gear, one.limit_pinion)
    assert sorted(other.single_contact_pinion) == pytest.approx(sorted(one.roll_gear(one.single_contact_pinion)), rel=1e-12)
    assert sorted(other.roll_gear(other.single_contact_pinion)) == pytest.approx(sorted(one.single_contact_pinion), rel=1e-12)
    roll = np.linspace(one.start_pinion + 1e-6, one.end_pinion - 1e-6, 50)
    first, second = sliding(pinion, ring, centre, roll), sliding(ring, pinion, centre, roll + line)
    assert second.specific_pinion == pytest.approx(first.specific_gear, rel=1e-9)
    assert second.specific_gear == pytest.approx(first.specific_pinion, rel=1e-9)
    assert second.equivalent_radius == pytest.approx(first.equivalent_radius, rel=1e-9)
    assert second.velocity == pytest.approx(-ring.teeth / pinion.teeth * first.velocity, rel=1e-9)  # per turn of the ring
    for sharing in LoadSharing.of(pinion):
        shares = [
            load_share(*gears, centre, at, sharing) for gears, at in (((pinion, ring), roll), ((ring, pinion), roll + line))
        ]
        assert shares[0] == pytest.approx(shares[1], rel=1e-6)


@pytest.mark.parametrize("first", ["pinion", "ring"])
def test_a_law_put_on_a_profile_comes_back_and_goes_on(first):
    pinion, ring, centre = pair(-20.0)
    gears = (pinion, ring, centre) if first == "pinion" else (ring, pinion, centre)
    path = path_of_contact(*gears)
    roll = path.start_pinion + path.length * (np.arange(80) + 0.5) / 80
    line = centre * math.sin(pinion.transverse_pressure_angle)
    other = roll + line if first == "pinion" else roll - line
    slid = np.abs(1.0 - gears[0].teeth * other / (gears[1].teeth * roll))
    fit = next(
        one for one in fit_wear_law(*gears, roll, LOST * slid + 0.003, np.full(80, 1e-5)) if one.sharing is LoadSharing.NONE
    )
    assert fit.coefficients[:2] == pytest.approx([LOST, 0.003], rel=1e-6)
    # An even loss: the backlash grows by it, the arc r / (r_b cos β_b) as fast.
    fits = fit_wear_law(*gears, roll, np.full(80, 0.005), np.full(80, 1e-5))
    assert cycles_left(fits, 1e6, 0.020, "backlash").value == pytest.approx(3e6, rel=1e-3)
    assert cycles_left(fits, 1e6, 0.020 * gears[0].arc_per_depth, "thickness").value == pytest.approx(3e6, rel=1e-3)


def ring_worn():
    """All left flanks of a helical ring: its design, the mate, which part it is, and the scan; so of the others."""
    ring = replace(RING, helix=-20.0)
    mate = replace(INSIDE, helix=-20.0)
    line, top = (ring.reference - mate.reference) * math.sin(ring.transverse), math.sqrt(mate.tip**2 - mate.base**2)
    low = math.sqrt(ring.tip**2 - ring.base**2)
    law = worn_by(42, 17, lambda roll: roll - line, low, top + line, ring.base_cos)
    cloud = ring_scan(ring, 25_000, seed=2, noise=0.005, added=law)
    return {"gear": ring_designed(ring)}, external(mate, "pinion", 0.05), "gear", cloud


def pinion_worn_in_a_ring():
    line, low = (RING.reference - INSIDE.reference) * math.sin(RING.transverse), math.sqrt(RING.tip**2 - RING.base**2)
    law = worn_by(17, 42, lambda roll: roll + line, low - line, math.sqrt(INSIDE.tip**2 - INSIDE.base**2))
    cloud = scan(INSIDE, 20_000, seed=1, noise=0.005, added=law)
    return (
        {"pinion": external(INSIDE, "pinion")},
        Gear.from_spec(replace(ring_designed(RING).spec, thinning=0.05)),
        "pinion",
        cloud,
    )


def double_worn():
    gear, half = double_designed(DOUBLE), DOUBLE.lower
    mate = Gear.from_spec(replace(gear.spec, teeth=29, helix_angle=-gear.helix_angle, profile_shift=-0.1, thinning=0.05))
    line = (gear.reference_radius + mate.reference_radius) * math.sin(half.transverse)
    low, top = line - math.sqrt(mate.tip_radius**2 - mate.base_radius**2), math.sqrt(half.tip**2 - half.base**2)
    law = worn_by(17, 29, lambda roll: line - roll, low, top, half.base_cos)
    return {"pinion": gear}, mate, "pinion", double_scan(DOUBLE, 40_000, seed=1, noise=0.005, added=law)


def external(gear: Helical, name: str, thinning: float = 0.0) -> Gear:
    spec = GearSpec(name, gear.teeth, gear.module, gear.width, profile_shift=gear.shift, thinning=thinning)
    return Gear.from_spec(replace(spec, helix_angle=math.radians(gear.helix)))


@pytest.mark.long
@pytest.mark.parametrize("worn", [ring_worn, pinion_worn_in_a_ring, double_worn])
def test_flanks_worn_by_archard_tell_the_coefficient(worn):
    gears, mate, part, cloud = worn()
    likeliest = gw.find_effects(gw.register(Design(gears), gw.as_scan(cloud.points)))
    # So light a loss, alike on all teeth, may be told as one answer of two: worn, or made so.
    measured = next(answer for answer in (likeliest, *likeliest.undecided) if answer.worn_sides == {Side.LEFT})
    wear, gear = gw.find_wear(measured), measured.gear
    points = as_made_points(measured.located, measured.final.lying.cell, measured.cells, measured.as_made, measured.loop)
    centre = abs(gear.orientation * gear.reference_radius + mate.orientation * mate.reference_radius)
    found = study_wear(wear, points, measured.as_made, Side.LEFT, mate, centre, measured.loop, measured.noise, Ahead(1e6, (2e6,)))
    assert found.why_not == "" and found.best is not None and len(found.teeth) >= gear.teeth - 2
    assert found.best.sharing is LoadSharing.NONE
    sliding_depth, even = found.best.coefficients[:2]
    std = np.sqrt(np.diag(found.best.covariance))
    assert abs(sliding_depth - LOST) < 2.5 * std[0] and std[0] < 0.05 * LOST
    assert even < 3.0 * std[1]
    # Twice the cycles, twice the depth, place by place.
    one, two = found.forecast.depth.value
    assert np.median(two / np.maximum(one, 1e-4)) == pytest.approx(2.0, abs=0.25)
    assert found.across is not None and not found.across.uneven
    if part == "pinion":  # and in mesh with the mate, whose radii run the other way where it is a ring
        pair = Design({**gears, "gear": mate}, PairSpec(centre + 0.2 * mate.orientation))
        profiles = beside_mate(pair, measured)(nominal_profiles(gear))
        contact = mesh_contact(*profiles, pair.centre_distance, Side.LEFT, positions_per_pitch=6)
        assert np.ptp(contact.transmission_error) < 1e-6
