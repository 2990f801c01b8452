"""Wear that runs on helical gears, against Archard's law on lines of constant length, conservation, mirrors, and the spur gear."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.loaded.contact import loaded_contact, pair_compliance
from gearwear.loaded.pair_compliance import PairCompliance
from gearwear.loaded.wearing import WearMember, WornPair, run_wear, run_wear_ensemble
from gearwear.meshing.path import path_of_contact
from gearwear.wear_law.archard import specific_sliding
from tests.loaded.test_helical_contact import BETA, MODULE, ONCE, bed

LOAD = 100.0
Gears = tuple[Gear, Gear]


def gears(beta: float = BETA, face: float = ONCE, **more: float) -> Gears:
    one, two = (Gear.from_spec(GearSpec(f"z{z}", z, MODULE, face, helix_angle=w * beta, **more)) for z, w in ((17, 1), (31, -1)))
    return one, two


def run(pair: Gears, elastic: PairCompliance, amount: float, **more) -> WornPair:
    """k w N in mm."""
    force = LOAD * (pair[0].face_width - pair[0].spec.gap)
    (found,) = run_wear(*pair, pair[0].reference_radius + pair[1].reference_radius, force, elastic, [amount / LOAD], **more)
    return found


@pytest.fixture(scope="module")
def elastic() -> PairCompliance:
    one, two = gears()
    return pair_compliance(nominal_profiles(one), nominal_profiles(two))


@pytest.mark.long
def test_lines_of_constant_length_wear_as_archards_law_says():
    """Whole overlap on an even bed: every line carries F / (ε_α b), so the normal depth is k N F / (ε_α b) |K|."""
    pair = gears()
    centre = pair[0].reference_radius + pair[1].reference_radius
    path = path_of_contact(*pair, centre)
    found = run(pair, bed(tuple(map(nominal_profiles, pair)), 5e-5), 1e-4, slices=50, positions_per_pitch=48, corners=False)
    law = 1e-4 / path.contact_ratio * specific_sliding(*pair, centre, found.roll)
    inside = (found.roll > path.start_pinion + 0.5) & (found.roll < path.end_pinion - 0.5)
    inside &= np.abs(found.roll - path.pitch_pinion) > 0.5  # where K is 0 the contact's width smears it
    assert inside.sum() > 80
    np.testing.assert_allclose(found.depth.mean(axis=0)[inside], law[inside], rtol=0.02)


@pytest.mark.parametrize("gap", [0.0, 4.0])
def test_the_volume_is_that_of_force_and_way_slid(elastic, gap):
    """V = k ∫ F_n ds; an element of the flank is ds dz / cos β_b. Double helical gears too."""
    pair = gears(face=ONCE + gap, gap=gap)
    amount, slices = 2e-4, 12
    found = run(pair, elastic, amount, slices=slices, positions_per_pitch=32)
    gear, turn = pair[0], found.contact
    fresh = loaded_contact(
        *map(nominal_profiles, pair),
        turn.centre_distance,
        turn.total,
        elastic,
        slices=slices,
        positions_per_pitch=32,
        cycle="pitch",
    )
    ratio = pair[1].teeth / pair[0].teeth
    way = np.abs(fresh.roll - fresh.mate_roll / ratio) * gear.pitch_angle / 32
    wanted = amount / LOAD * float((fresh.force / gear.base_helix_cosine * way).sum())
    arc = np.gradient(found.roll**2 / (2.0 * gear.base_radius))
    lost = float((found.depth * arc * fresh.widths[:, None]).sum()) / gear.base_helix_cosine
    assert lost == pytest.approx(wanted, rel=0.01)


@pytest.mark.long
def test_the_other_hand_on_the_other_side_is_the_mirror_image(elastic):
    other = gears(-BETA)
    mirrored = pair_compliance(*map(nominal_profiles, other))
    left = run(gears(), elastic, 4e-3, misalignment=0.02, slices=4, positions_per_pitch=20)
    right = run(other, mirrored, 4e-3, side=Side.RIGHT, misalignment=0.02, slices=4, positions_per_pitch=20)
    np.testing.assert_allclose(left.depth, right.depth, atol=1e-9)
    assert left.depth[0].mean() > 1.5 * left.depth[-1].mean()  # + opens towards the upper end, which carries less


@pytest.mark.long
def test_a_hardly_helical_pair_wears_as_a_spur_pair():
    """At 0.01° the phase over the face is 0.0004 of a pitch; depths differ by as little, but for cells that a corner just reaches."""
    spur, hardly = gears(0.0, 18.0), gears(math.radians(0.01), 18.0)
    elastic = pair_compliance(*map(nominal_profiles, spur))
    straight, helical = (run(pair, elastic, 4e-3, slices=3, positions_per_pitch=30) for pair in (spur, hardly))
    assert np.abs(straight.depth - helical.depth).mean() < 0.01 * straight.depth.mean()


@pytest.mark.long
def test_depths_do_not_hang_on_the_number_of_slices(elastic):
    """In strips a twelfth of the flank wide, as the second loop has them, mean over the face, 6 slices against 24: 3 % of the mean depth."""
    coarse, fine = (run(gears(), elastic, 8e-3, slices=n, positions_per_pitch=32).depth.mean(axis=0) for n in (6, 24))
    strips = (coarse - fine).reshape(12, -1).mean(axis=1)
    assert math.sqrt(np.mean(strips**2)) < 0.05 * fine.mean()
    assert coarse.mean() == pytest.approx(fine.mean(), rel=0.02)


def test_slices_that_stand_for_runs_are_of_spur_gears(elastic):
    with pytest.raises(InputError, match="spur gears"):
        run_wear_ensemble(*gears(), 64.0, LOAD, [WearMember(elastic, 0.0)], np.array([0.0, 1e-6]))
