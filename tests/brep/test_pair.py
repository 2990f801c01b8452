"""Pinion and gear in mesh: they touch where they should and overlap nowhere, over a whole pitch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from build123d import Axis, Compound, import_step

from gearwear.arrays import Floats
from gearwear.brep.outline import rotation
from gearwear.brep.pair import gear_pair, mesh_turn
from gearwear.brep.step import write_step
from gearwear.design import Design, Gear, GearSpec, PairSpec
from gearwear.design.pair import check_pair
from tests.brep.measuring import face_points, outline_points, tooth_faces

pytestmark = pytest.mark.long

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


def helical(centre: float | None = None, **extra: float) -> Design:
    beta = math.radians(25.0)
    pinion = GearSpec("pinion", 17, 2.5, 12.0, helix_angle=beta, profile_shift=0.2, **extra)
    return design(pinion, replace(pinion, name="gear", teeth=31, face_width=9.0, helix_angle=-beta, profile_shift=-0.2), centre)


def clearance_in_space(points: Floats, gear: Gear) -> float:
    """As `clearance`, of points at any height: turned back by tan β / r times the height over mid-face."""
    spec = gear.spec
    reference = 0.5 * spec.normal_module * spec.teeth / math.cos(spec.helix_angle)
    back = -math.tan(spec.helix_angle) / reference * (points[:, 2] - 0.5 * spec.face_width)
    cos, sin = np.cos(back), np.sin(back)
    x, y = points[:, 0], points[:, 1]
    return clearance(np.column_stack([cos * x - sin * y, sin * x + cos * y]), gear, gear.half_angle)


def test_a_helical_pair_read_back_meshes_in_space(tmp_path):
    case = helical(helical().centre_distance + 0.3, thinning=0.05)
    write_step(gear_pair(case), tmp_path / "pair.step")
    placed = {child.label: child for child in import_step(tmp_path / "pair.step").children}
    pinion, gear = case.gears["pinion"], case.gears["gear"]
    axis = np.array([case.centre_distance, 0.0, 0.5 * (pinion.face_width - gear.face_width)])
    points = {}
    for label, middle in (("pinion", 0.0), ("gear", case.centre_distance)):
        faces = [face for face in tooth_faces(placed[label]) if abs(face.center().X - middle) > 0.6 * abs(face.center().Y)]
        points[label] = np.concatenate([face_points(face, 200) for face in faces])

    def turned(rows: Floats, angle: float) -> Floats:
        return np.column_stack([rows[:, :2] @ rotation(angle), rows[:, 2]])

    least = np.inf
    for phase in np.linspace(-0.5, 0.5, 5):
        own, other = phase * pinion.pitch_angle, -phase * gear.pitch_angle
        in_pinion = turned(turned(points["gear"] - axis, other) + axis, -own)
        in_gear = turned(turned(points["pinion"], own) - axis, -other - mesh_turn(gear))
        least = min(least, clearance_in_space(in_pinion, pinion), clearance_in_space(in_gear, gear))
    # j_bt from the base circles: ISO 21771; what both sides share.
    working = math.acos((pinion.base_radius + gear.base_radius) / case.centre_distance)
    bases = pinion.base_radius * (math.tan(working) - working - pinion.base_half_angle)
    bases += gear.base_radius * (math.tan(working) - working - gear.base_half_angle)
    play = 2.0 * bases + pinion.base_pitch
    assert play > 0.05
    assert 0.0 <= least - 0.5 * play + 1e-9 <= 2e-4  # as BETWEEN, where the smaller flank has a radius of 3 mm
