"""A pinion inside a ring: published cases, closed forms, and contact in space by the distance of points to a surface."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec, PairSpec, parse_design
from gearwear.design.files.profiles import write_profiles
from gearwear.design.pair import check_pair, tip_clearances, tip_penetration
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, TIP, flank_points, locate
from gearwear.errors import InputError
from gearwear.meshing.backlash import (
    backlash,
    centre_distance_for_backlash,
    operating_pitch_radii,
    transverse_backlash,
    working_pressure_angle,
    zero_backlash_centre_distance,
)
from gearwear.meshing.clearance import bottoming_centre_distance, interference, interference_free_centre_distance
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.linear import linear_contact
from gearwear.meshing.path import path_of_contact, sliding
from gearwear.meshing.study import study_meshing
from tests.meshing.shift_sum import profile_shift_sum


def pair(degrees: float = 0.0, teeth: tuple[int, int] = (20, 72), **more: float) -> tuple[Gear, Gear]:
    both = {"normal_module": 2.0, "face_width": 15.0, "helix_angle": math.radians(degrees), "thinning": 0.05, **more}
    pinion = Gear.from_spec(GearSpec("pinion", teeth[0], addendum=0.9, rack_tip_radius=0.2, **both))
    ring = Gear.from_spec(GearSpec("gear", teeth[1], addendum=0.8, internal=True, rim_diameter=180.0, **both))
    return pinion, ring


SPUR, HELICAL = pair(), pair(-20.0)
every_pair = pytest.mark.parametrize(("pinion", "ring"), [SPUR, HELICAL], ids=["spur", "left 20"])
spur_first = pytest.mark.parametrize(
    ("pinion", "ring"), [SPUR, pytest.param(*HELICAL, marks=pytest.mark.long)], ids=["spur", "left 20"]
)


def standard(pinion: Gear, ring: Gear) -> float:
    return ring.reference_radius - pinion.reference_radius


def test_published_internal_pair():
    """KHK, Technical Reference, internal gears: m 3, z 16/24, x 0 and 0.5 by their sign: α_w 31.0937°, a 13.1683, d_w 52.673 and 79.010, d_a2 69, d_f2 82.5."""
    pinion = Gear.from_spec(GearSpec("pinion", 16, 3.0, 20.0))
    ring = Gear.from_spec(GearSpec("gear", 24, 3.0, 20.0, profile_shift=-0.5, internal=True))
    centre = zero_backlash_centre_distance(pinion, ring)
    assert centre == pytest.approx(13.1683, abs=6e-5)
    assert math.degrees(working_pressure_angle(pinion, ring, centre)) == pytest.approx(31.0937, abs=2e-4)
    assert [2 * r for r in operating_pitch_radii(pinion, ring, centre)] == pytest.approx([52.673, 79.010], abs=6e-4)
    assert profile_shift_sum(pinion, ring, centre) == pytest.approx(-0.5, abs=1e-12)
    # The ring's tip lies 0.03 mm of roll beyond the pinion's interference point.
    assert interference(pinion, ring, centre).overrun == pytest.approx(0.03, abs=5e-3)


def test_published_internal_pair_of_large_module():
    """cases.md R5: z 17/96, m 14, x 0.20 and 0.50 by their sign: inv α_w 0.01766871, α_w 21.1251°, a 557.0887."""
    pinion = Gear.from_spec(GearSpec("pinion", 17, 14.0, 100.0, profile_shift=0.2))
    ring = Gear.from_spec(GearSpec("gear", 96, 14.0, 100.0, profile_shift=-0.5, internal=True))
    centre = zero_backlash_centre_distance(pinion, ring)
    assert centre == pytest.approx(557.088742, abs=6e-6)
    working = working_pressure_angle(pinion, ring, centre)
    assert math.tan(working) - working == pytest.approx(0.01766871, abs=6e-9)
    assert math.degrees(working) == pytest.approx(21.125096, abs=1e-6)


@every_pair
def test_backlash_is_the_arc_that_is_left_on_the_working_circles(pinion, ring):
    """Pitch less both tooth thicknesses there, measured on the gears themselves: the pinion's, and the ring's."""
    for centre in (standard(pinion, ring), standard(pinion, ring) - 0.3):
        radii = operating_pitch_radii(pinion, ring, centre)
        assert radii[1] - radii[0] == pytest.approx(centre, rel=1e-14)
        left = radii[0] * pinion.pitch_angle - float(pinion.thickness(radii[0])) - float(ring.thickness(radii[1]))
        found = backlash(pinion, ring, centre)
        assert found.circumferential == pytest.approx(left, abs=1e-12)
        alpha = working_pressure_angle(pinion, ring, centre)
        assert found.transverse == pytest.approx(left * math.cos(alpha), abs=1e-12)
        assert found.normal == pytest.approx(found.transverse * pinion.base_helix_cosine, abs=1e-15)
        if pinion.twist:
            assert found.axial == pytest.approx(left / (radii[0] * abs(pinion.twist)), rel=1e-12)
        closed = transverse_backlash(pinion, ring, centre + found.radial_closing)
        assert closed == pytest.approx(0.0, abs=1e-11)  # with a ring the shafts part until it is gone


@every_pair
@pytest.mark.parametrize("kind", ["reference", "operating", "normal"])
def test_centre_distance_for_a_wanted_backlash(pinion, ring, kind):
    centre = centre_distance_for_backlash(pinion, ring, 0.12, kind)
    found = backlash(pinion, ring, centre)
    of_kind = {"reference": found.circumferential_reference, "operating": found.circumferential, "normal": found.normal}[kind]
    assert of_kind == pytest.approx(0.12, abs=1e-11)
    assert centre < zero_backlash_centre_distance(pinion, ring)


def test_standard_sizes_of_a_pair():
    path = path_of_contact(*SPUR, 52.0)
    line = 52.0 * math.sin(math.radians(20.0))
    assert (path.start_pinion, path.end_pinion) == pytest.approx((SPUR[1].tip_roll - line, SPUR[0].tip_roll), abs=1e-12)
    assert (path.end_gear, path.start_gear) == pytest.approx((SPUR[1].tip_roll, SPUR[0].tip_roll + line), abs=1e-12)
    assert path.pitch_gear - path.pitch_pinion == pytest.approx(line, rel=1e-14)
    assert path.alone_gear == pytest.approx([roll + line for roll in path.alone_pinion], rel=1e-12)
    assert tip_clearances(*SPUR, 52.0) == pytest.approx((74.5 - 52.0 - 21.8, 70.4 - 52.0 - 17.5), abs=1e-12)
    assert bottoming_centre_distance(*SPUR) == pytest.approx(min(74.5 - 21.8, 70.4 - 17.5), abs=1e-12)
    free = interference_free_centre_distance(*SPUR)
    assert free * math.sin(working_pressure_angle(*SPUR, free)) == pytest.approx(SPUR[1].tip_roll, rel=1e-12)


@every_pair
def test_sliding_is_the_difference_of_the_two_speeds_in_the_plane(pinion, ring):
    """Both flanks turn in one sense; at the contact their speeds differ along the tangent alone."""
    centre = standard(pinion, ring)
    path, alpha = path_of_contact(pinion, ring, centre), working_pressure_angle(pinion, ring, centre)
    roll = np.linspace(path.start_pinion, path.end_pinion, 9)
    found = sliding(pinion, ring, centre, roll)
    # Ring at the origin, pinion at (a, 0); the normal stands at −α_w, its foot on the pinion's base circle.
    tau = -alpha
    radial, along = np.array([math.cos(tau), math.sin(tau)]), np.array([-math.sin(tau), math.cos(tau)])
    point = np.array([centre, 0.0]) + pinion.base_radius * radial + roll[:, None] * along
    assert np.hypot(*point.T) == pytest.approx(np.hypot(ring.base_radius, found.roll_gear), rel=1e-12)
    ratio = pinion.teeth / ring.teeth
    from_pinion = point - np.array([centre, 0.0])
    difference = np.column_stack([-from_pinion[:, 1], from_pinion[:, 0]]) - ratio * np.column_stack([-point[:, 1], point[:, 0]])
    assert difference @ along == pytest.approx(np.zeros(9), abs=1e-12)
    assert np.abs(difference @ radial) == pytest.approx(np.abs(found.velocity), abs=1e-12)


def in_pinion(pinion: Gear, ring: Gear, centre: float, points: np.ndarray, turn: float, own: float) -> np.ndarray:
    """Points of the ring, turned by `turn` about its axis, in the frame of the pinion at (centre, 0), turned by `own`; mid-faces level."""

    def turned(xy: np.ndarray, angle: float) -> np.ndarray:
        cos, sin = math.cos(angle), math.sin(angle)
        return xy @ np.array([[cos, sin], [-sin, cos]])

    xy = turned(turned(points[:, :2], turn) - [centre, 0.0], -own)
    return np.column_stack([xy, points[:, 2] - 0.5 * (ring.face_width - pinion.face_width)])


@every_pair
@pytest.mark.parametrize("closer", [pytest.param(0.0, marks=pytest.mark.long), 0.3])
def test_flanks_touch_in_space_and_the_others_are_the_backlash_apart(pinion, ring, closer):
    """All flank points of the ring, held against the pinion's surface by its distance; the ring stands where the contact says."""
    centre = standard(pinion, ring) - closer
    result = mesh_contact(nominal_profiles(pinion), nominal_profiles(ring), centre, Side.LEFT, positions_per_pitch=3)
    assert result.peak_to_peak_um < 1e-6
    play = backlash(pinion, ring, centre)
    for own in (0.0, 0.31 * pinion.pitch_angle):
        centred = 0.5 * ring.pitch_angle + own * pinion.teeth / ring.teeth
        tooth, side, roll, z = (
            part.ravel()
            for part in np.meshgrid(
                np.arange(-6, 7) % ring.teeth,
                [-1, 1],
                np.linspace(ring.tip_roll, ring.form_roll, 400),
                np.linspace(0.02, 0.98, 25) * ring.face_width,
                indexing="ij",
            )
        )
        least = {}
        for way, sign in (("behind", -1.0), ("ahead", 1.0)):
            at = centred + sign * 0.5 * play.transverse / ring.base_radius
            points = in_pinion(pinion, ring, centre, flank_points(ring, tooth, side, roll, z).position, at, own)
            found = locate(points, pinion, workers=1)
            on_flank = found.surface == FLANK
            least[way] = {s: np.nanmin(np.where(on_flank & (side == s), found.deviation, np.nan)) for s in (-1, 1)}
        # Behind the middle, the ring's right flanks touch the pinion's left ones, which push it on; its left ones are j_bn away.
        assert least["behind"][-1] == pytest.approx(0.0, abs=2e-5)  # by the grid's own step
        assert least["behind"][1] == pytest.approx(play.normal, abs=2e-5)
        assert least["ahead"][1] == pytest.approx(0.0, abs=2e-5)
        assert least["ahead"][-1] == pytest.approx(play.normal, abs=2e-5)


@spur_first
def test_a_perfect_pair_runs_without_error(pinion, ring):
    centre = standard(pinion, ring) - 0.1
    for side in Side:
        result = mesh_contact(
            nominal_profiles(pinion), nominal_profiles(ring), centre, side, positions_per_pitch=7, cycle="pitch"
        )
        assert result.peak_to_peak_um < 1e-6
        normal = backlash(pinion, ring, centre).normal
        assert (result.backlash_min.value, result.backlash_max.value) == pytest.approx((normal, normal), abs=1e-9)


@spur_first
def test_ten_micrometres_off_the_flanks_that_carry(pinion, ring):
    """−10 µm along the normal is −10 / cos β_b on the transverse line of action, on the pinion's left or the ring's right flanks alike."""
    centre = standard(pinion, ring)
    for gear, index in ((pinion, 0), (ring, 1)):
        flanks = {one.spec.name: nominal_profiles(one) for one in (pinion, ring)}
        flanks[gear.spec.name].half_angle[:, index] -= 0.010 / (gear.base_radius * gear.base_helix_cosine)
        left, right = (
            mesh_contact(flanks["pinion"], flanks["gear"], centre, side, 3, "pitch").transmission_error_um for side in Side
        )
        assert left == pytest.approx(np.full_like(left, -10.0 / pinion.base_helix_cosine), abs=1e-6)
        assert right == pytest.approx(np.zeros_like(right), abs=1e-6)


def test_one_worn_tooth_is_felt_where_it_meshes():
    """The spur pair: the ring lags by 10 µm while its worn tooth carries alone. Turning on, the pinion brings teeth of falling number."""
    worn = nominal_profiles(SPUR[1])
    worn.half_angle[72 - 5, 1] -= 0.010 / SPUR[1].base_radius
    result = mesh_contact(nominal_profiles(SPUR[0]), worn, 52.0, Side.LEFT, positions_per_pitch=9, start_tooth=0)
    lagging = result.transmission_error_um < -9.99
    assert lagging.any()
    assert (result.driven_tooth[lagging] == 72 - 5).all()
    assert (result.driver_tooth[lagging] == 20 - 5).all()  # both count the same way round
    linear = linear_contact(nominal_profiles(SPUR[0]), worn, 52.0, Side.LEFT, 9)
    # The linear model has no contact off the line of action, where a step is passed by corners.
    assert np.abs(1e3 * linear.transmission_error - result.transmission_error_um)[lagging].max() < 1e-6


@pytest.mark.parametrize(
    ("teeth", "tip"),
    [
        pytest.param((20, 72), 1.0, marks=pytest.mark.long),
        pytest.param((17, 60), 1.0, marks=pytest.mark.long),
        ((17, 60), 0.8),
        pytest.param((16, 48), 1.0, marks=pytest.mark.long),
    ],
)
def test_tips_that_dig_into_fillets(teeth, tip):
    """The ring's tips, rolled past the pinion and held against its surface by the distance of points."""
    pinion = Gear.from_spec(GearSpec("pinion", teeth[0], 2.0, 15.0))
    ring = Gear.from_spec(GearSpec("gear", teeth[1], 2.0, 15.0, addendum=tip, internal=True, thinning=0.1))
    centre = standard(pinion, ring)
    claimed = tip_penetration(pinion, ring, centre)
    half, play = float(ring.half_angle(ring.tip_radius)), transverse_backlash(pinion, ring, centre)
    deepest = 0.0
    for own in np.linspace(-0.9, 0.9, 1201) * math.pi / 2:
        at = 0.5 * ring.pitch_angle + own * teeth[0] / teeth[1] - 0.5 * play / ring.base_radius
        angle = at + ring.pitch_angle * np.arange(-8, 9) - half  # right corners, which face the pinion's left flanks
        corner = np.column_stack([ring.tip_radius * np.cos(angle), ring.tip_radius * np.sin(angle), np.full(17, 7.5)])
        found = locate(in_pinion(pinion, ring, centre, corner, 0.0, own), pinion, workers=1)
        inside = np.isin(found.surface, (FLANK, FILLET)) & (found.side == 1)
        deepest = max(deepest, float(np.max(-found.deviation[inside], initial=0.0)))
    # The claim is an arc about the axis, the distance is along the normal.
    assert (claimed > 1e-6) == (deepest > 1e-6)
    assert deepest <= claimed + 1e-9
    assert deepest >= 0.25 * claimed - 1e-6
    assert TIP not in found.surface


DESIGN = {
    "pinion": {"teeth": 20, "module": 2.0, "face_width": 15.0, "helix_angle": 15.0, "addendum": 0.8},
    "gear": {"teeth": 72, "internal": True, "addendum": 0.8, "rim_diameter": 180.0},
}


def test_the_ring_of_a_design_has_the_hand_of_its_pinion():
    design = parse_design(DESIGN)
    assert design.gears["gear"].helix_angle == design.gears["pinion"].helix_angle
    assert design.centre_distance == pytest.approx(52.0 / math.cos(math.radians(15.0)), rel=1e-14)


@pytest.mark.parametrize(
    ("part", "more", "said"),
    [
        ("gear", {"helix_angle": -15.0}, "the same hand and angle inside a ring would be right, 15°"),
        ("gear", {"teeth": 20, "addendum": 0.2}, "a ring needs more teeth than the pinion"),
        ("pinion", {"teeth": 67}, "tips foul the ring's where they leave each other, by 0"),
        ("pair", {"centre_distance": 54.9}, "digs .* into its mate's root; at most"),
        ("pair", {"centre_distance": 50.1}, "above the difference of the base radii"),
        ("pair", {"centre_distance": 54.0}, "teeth jam, .* a smaller centre distance"),
        ("pinion", {"internal": True, "addendum": 0.2}, "the ring of a pair is its .gear."),
    ],
)
def test_pairs_that_cannot_be_are_refused_by_name(part, more, said):
    with pytest.raises(InputError, match=said):
        parse_design({**DESIGN, part: {**DESIGN.get(part, {}), **more}})


def test_an_assumed_fillet_is_no_reason_to_refuse_a_pair():
    """A pinion tip that reaches far out: a stated fillet refuses the pair, an assumed one says that it is assumed."""
    table = {**DESIGN, "pinion": {**DESIGN["pinion"], "addendum": 1.2}, "gear": {**DESIGN["gear"], "root_diameter": 153.9}}
    assert any("as that is assumed" in said for said in parse_design(table).warnings)
    table["gear"] = {**table["gear"], "cutter_teeth": 25, "cutter_tip_radius": 0.2}
    with pytest.raises(InputError, match=r"digs .* into the gear's root fillet; a smaller addendum of the mate"):
        parse_design(table)


def test_a_ring_that_can_only_be_put_on_along_the_axis_is_said():
    pinion, ring = pair(teeth=(50, 60))
    assert any("cannot be put into the ring radially" in said for said in check_pair(pinion, ring, PairSpec()))
    assert not any("radially" in said for said in check_pair(*SPUR, PairSpec()))


def test_a_ring_that_drives_is_refused_by_name():
    with pytest.raises(InputError, match="contact with the ring as the driver"):
        mesh_contact(nominal_profiles(SPUR[1]), nominal_profiles(SPUR[0]), 52.0)


@pytest.mark.long
def test_a_measured_ring_is_read_back_and_meshed(tmp_path):
    """One right flank of the ring 20 µm off, through the file that compare writes: 20 µm of lag; the pinion's left flanks carry by themselves."""
    design = parse_design({**DESIGN, "pinion": {**DESIGN["pinion"], "helix_angle": 0.0}})
    worn = nominal_profiles(design.gears["gear"], z=np.linspace(0.0, 15.0, 3))
    worn.half_angle[-7, 1] -= 0.020 / design.gears["gear"].base_radius
    write_profiles(tmp_path / "worn_profiles.npz", worn, "gear")
    study = study_meshing(design, tmp_path)
    assert study.drive_side is Side.LEFT
    assert study.contact.peak_to_peak_um == pytest.approx(20.0, abs=1e-3)
    assert study.contact.backlash_max.value - study.contact.backlash_min.value == pytest.approx(0.020, abs=1e-6)


@pytest.mark.long
def test_a_loss_on_the_ring_is_on_its_flanks_that_carry():
    """A uniform loss lags by itself whichever gear has it, and no shaft is said to move."""
    design = parse_design({**DESIGN, "pinion": {**DESIGN["pinion"], "helix_angle": 0.0}})
    for part in ("pinion", "gear"):
        study = study_meshing(design, loss=0.03, part=part, drive="right")
        assert study.contact.transmission_error_um.mean() == pytest.approx(-30.0, abs=1e-6)
        assert study.shafts is None
