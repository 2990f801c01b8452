"""Pinion and gear in mesh: they touch where they should and overlap nowhere, over a whole pitch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from build123d import Axis, Compound

from gearwear.arrays import Floats
from gearwear.brep.outline import rotation
from gearwear.brep.pair import gear_pair, mesh_turn
from gearwear.design import Design, Gear, GearSpec, PairSpec
from gearwear.design.pair import check_pair
from tests.brep.measuring import outline_points

PHASES = np.linspace(-0.5, 0.5, 33)
"""Shares of a pitch."""

Profile = Callable[[Floats], Floats]


def design(pinion: GearSpec, gear: GearSpec, centre: float | None = None) -> Design:
    gears = {"pinion": Gear.from_spec(pinion), "gear": Gear.from_spec(gear)}
    pair = PairSpec(centre)
    return Design(gears, pair, check_pair(gears["pinion"], gears["gear"], pair))


PAPER = (GearSpec("pinion", 12, 6.35, 15.0), GearSpec("gear", 24, 6.35, 15.0))
ALLOWANCE = 0.2286
THINNED = tuple(replace(spec, thinning=0.5 * ALLOWANCE) for spec in PAPER)
SHIFTED = (GearSpec("pinion", 12, 3.0, 10.0, profile_shift=0.6), GearSpec("gear", 24, 3.0, 10.0, profile_shift=0.36))


def clearance(points: Floats, gear: Gear, profile: Profile) -> float:
    """Least of r_b (angle from the flank) over points in the gear's own frame; negative is overlap.

    It is the way along the line of action that the points' owner could still turn, mm.
    """
    radius = np.hypot(points[:, 0], points[:, 1])
    near = radius < gear.tip_radius
    angle = np.arctan2(points[near, 1], points[near, 0])
    within = np.abs(angle - gear.pitch_angle * np.rint(angle / gear.pitch_angle))
    gap = gear.base_radius * (within - profile(radius[near]))
    return float(gap.min(initial=np.inf))


def least_clearance(
    case: Design, pair: Compound, turned: float = 0.0, pinion_profile: Profile | None = None, phases: Floats = PHASES
) -> float:
    """Least clearance in both directions over one pitch; the gear turned by `turned` rad more."""
    pinion, gear = case.gears["pinion"], case.gears["gear"]
    placed = {child.label: outline_points(child, 270) for child in pair.children}
    axis = np.array([case.centre_distance, 0.0])
    left = placed["pinion"][placed["pinion"][:, 0] > case.centre_distance - gear.tip_radius - 2.0]
    right = placed["gear"][placed["gear"][:, 0] < pinion.tip_radius + 2.0] - axis
    least = np.inf
    for phase in phases:
        own = phase * pinion.pitch_angle
        other = turned - own * pinion.teeth / gear.teeth
        in_pinion = (right @ rotation(other) + axis) @ rotation(-own)
        in_gear = (left @ rotation(own) - axis) @ rotation(-other - mesh_turn(gear))
        least = min(least, clearance(in_pinion, pinion, pinion_profile or pinion.half_angle))
        if pinion_profile is None:
            least = min(least, clearance(in_gear, gear, gear.half_angle))
    return least


@pytest.fixture(scope="module")
def paper() -> tuple[Design, Compound]:
    case = design(*PAPER)
    return case, gear_pair(case)


@pytest.fixture(scope="module")
def thinned() -> tuple[Design, Compound]:
    case = design(*THINNED)
    return case, gear_pair(case)


# Between two samples 0.03 mm apart a flank of 8 mm radius strays this far, mm: how near to contact a sample may miss it.
BETWEEN = 0.03**2 / (2 * 8.0)


def test_without_backlash_the_flanks_touch_and_nothing_overlaps(paper):
    assert -1e-9 <= least_clearance(*paper) <= BETWEEN


def test_the_backlash_of_the_design_is_shared_by_both_sides(thinned):
    assert 0.0 <= least_clearance(*thinned) - 0.5 * ALLOWANCE * math.cos(math.radians(20.0)) <= BETWEEN


def test_a_shifted_pair_at_its_own_centre_distance():
    # cases.md R1: m = 3, z = 12/24, x = 0.6/0.36, a = 56.5: published backlash none; the shifts' sum is rounded.
    case = design(*SHIFTED, centre=56.5)
    working = math.acos(54.0 * math.cos(math.radians(20.0)) / 56.5)
    involutes = [math.tan(a) - a for a in (working, math.radians(20.0))]
    play = math.cos(math.radians(20.0)) * (
        2 * 54.0 * (involutes[0] - involutes[1]) - 4 * 0.48 * 3.0 * math.tan(math.radians(20.0))
    )
    assert 0.0 <= least_clearance(case, gear_pair(case)) - 0.5 * play <= BETWEEN


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_turn_of_a_hundredth_of_a_millimetre_is_seen(paper, sign):
    case, pair = paper
    found = least_clearance(case, pair, turned=sign * 0.01 / case.gears["gear"].reference_radius)
    assert found == pytest.approx(-0.01 * math.cos(math.radians(20.0)), abs=BETWEEN)


def test_a_tooth_with_a_radial_root_collides(paper):
    # reference.md G: the rigid pair is pushed 12.2 µm apart by a pinion drawn as involute to the base circle, radial below.
    case, pair = paper
    pinion = case.gears["pinion"]

    def radial_root(radius: Floats) -> Floats:
        roll = np.sqrt(np.maximum(radius**2 - pinion.base_radius**2, 0.0)) / pinion.base_radius
        return pinion.base_half_angle - (roll - np.arctan(roll))

    found = least_clearance(case, pair, pinion_profile=radial_root, phases=np.linspace(-0.5, 0.5, 401))
    assert found == pytest.approx(-0.0122, abs=5e-5)


def test_the_solids_themselves_do_not_intersect_until_turned_past_the_backlash(thinned):
    case, pair = thinned
    pinion, gear = pair.children
    free = pinion & gear
    assert free is None or free.volume == 0.0

    axis = Axis((case.centre_distance, 0.0, 0.0), (0.0, 0.0, 1.0))
    turn = 0.5 * ALLOWANCE + 0.02  # mm at the pitch circle: 0.02 mm of overlap
    jammed = pinion & gear.rotate(axis, math.degrees(turn / case.gears["gear"].reference_radius))
    assert jammed.volume > 0.0


def test_gears_of_different_width_share_their_mid_plane():
    narrow = replace(PAPER[1], face_width=10.0)
    pair = gear_pair(design(PAPER[0], narrow))
    assert [child.label for child in pair.children] == ["pinion", "gear"]
    middles = [child.center().Z for child in pair.children]
    assert middles == pytest.approx([7.5, 7.5], abs=1e-12)
    low = pair.children[1].bounding_box().min.Z
    assert low == pytest.approx(2.5, abs=2e-7)  # boxes are widened by 1e-7
