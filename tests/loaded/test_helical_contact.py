"""Helical pairs under load against rigid contact, closed forms, mirrors, and what a torque is in space."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from gearwear.design.files.toml import parse_design
from gearwear.design.gear import Gear
from gearwear.design.load import LoadSpec
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.loaded.contact import loaded_contact, pair_compliance
from gearwear.loaded.hertz import contact_compliance
from gearwear.loaded.pair_compliance import PairCompliance, centre_depth
from gearwear.loaded.result import LoadedContact
from gearwear.loaded.steel import Material
from gearwear.loaded.study import QUANTITIES, numbers, study_load
from gearwear.loaded.tooth_compliance import ToothCompliance
from gearwear.loaded.wearing import run_wear
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.path import path_of_contact

BETA, MODULE = math.radians(20.0), 2.5
ONCE = math.pi * MODULE / math.sin(BETA)
"""Face width of an overlap ratio of 1, mm."""
STEEL = Material()
Pair = tuple[ToothProfiles, ToothProfiles]


def pair(beta: float = BETA, face: float = ONCE, **more: float) -> Pair:
    pinion, gear = (GearSpec(f"z{z}", z, MODULE, face, helix_angle=way * beta, **more) for z, way in ((17, 1), (31, -1)))
    return nominal_profiles(Gear.from_spec(pinion)), nominal_profiles(Gear.from_spec(gear))


def centre(of: Pair) -> float:
    return of[0].gear.reference_radius + of[1].gear.reference_radius


def turned(of: Pair, w: float, elastic: PairCompliance, **more) -> LoadedContact:
    width = of[0].gear.face_width - of[0].gear.spec.gap
    return loaded_contact(*of, centre(of), w * width, elastic, cycle=more.pop("cycle", "pitch"), **more)


def worn(flanks: ToothProfiles, depth: np.ndarray, z: np.ndarray, side: Side = Side.LEFT) -> ToothProfiles:
    """With a transverse loss (n_z,) of all flanks of one side, mm."""
    psi = np.repeat(flanks.half_angle[:, :, :1], len(z), axis=2)
    psi[:, side.index] -= depth[:, None] / flanks.gear.base_radius
    return ToothProfiles(flanks.gear, flanks.radius, z, psi)


@pytest.fixture(scope="module")
def helical() -> Pair:
    return pair()


@pytest.fixture(scope="module")
def elastic(helical) -> PairCompliance:
    return pair_compliance(*helical)


def bed(of: Pair, q: float) -> PairCompliance:
    """Every tooth as soft at all heights, nothing shared, slices alone, no flattening."""
    teeth = [ToothCompliance(flanks.gear, 1.0, np.linspace(0.0, 50.0, 4), np.full(4, 0.5 * q), 0.0) for flanks in of]
    return PairCompliance((teeth[0], teeth[1]), STEEL, 0.0, hertz=False)


@pytest.mark.long
def test_without_load_it_is_rigid_contact(elastic):
    """On flanks of which no two are alike, in slices that rigid contact looks at too: short faces, whose ends are well worn."""
    pinion, gear = short = pair(face=8.0)
    random = np.random.default_rng(1)
    z = (np.arange(15) + 0.5) * 8.0 / 15
    psi = np.repeat(pinion.half_angle, 15, axis=2) - random.uniform(0.0, 0.02, (17, 2, 15, 1)) / pinion.gear.base_radius
    psi[:, :, [0, -1]] -= 0.1 / pinion.gear.base_radius
    scanned = ToothProfiles(pinion.gear, pinion.radius, z, psi)
    rigid = mesh_contact(scanned, gear, centre(short), positions_per_pitch=9)
    for force in (0.0, 1e-7):
        turn = loaded_contact(scanned, gear, centre(short), force, elastic, positions_per_pitch=9)
        assert np.abs(turn.transmission_error - rigid.transmission_error).max() < 1e-9
    assert rigid.peak_to_peak_um > 1.0


def test_the_difference_from_rigid_vanishes_with_the_load(helical, elastic):
    lags = [turned(helical, w, elastic).lag.max() for w in (10.0, 1.0, 0.1, 0.01)]
    assert all(6.0 < more / less < 10.0 for more, less in pairwise(lags))  # ln in Hertz: a little under 10


def test_the_contact_lines_carry_the_torque(helical, elastic):
    """Each slice pushes along the normal in space, from the foot of its line of action on the base cylinder; no flank pulls."""
    turn = turned(helical, 120.0, elastic)
    gear = helical[0].gear
    normal = turn.force / gear.base_helix_cosine
    lever = gear.base_radius * gear.base_helix_cosine  # (r × n)_z
    np.testing.assert_allclose((normal * lever).sum(axis=(1, 2)), turn.total * gear.base_radius, rtol=1e-9)
    assert (turn.force >= 0.0).all() and (turn.lag > 0.0).all()
    matrix = elastic.matrix((turn.roll, turn.mate_roll), turn.widths)
    np.testing.assert_allclose(matrix, matrix.swapaxes(1, 2), rtol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > 0.0


@pytest.mark.parametrize("overlap", [1, 2])
def test_lines_of_constant_length_on_an_even_bed_make_no_error(overlap):
    """Whole overlap ratios: contact lines are ε_α b / cos β_b long at all times, so the pair gives way by q F / (ε_α b)."""
    of = pair(face=overlap * ONCE)
    q, w = 5e-5, 100.0
    turn = turned(of, w, bed(of, q), slices=50 * overlap, corners=False, positions_per_pitch=7)
    ratio = path_of_contact(of[0].gear, of[1].gear, centre(of)).contact_ratio
    np.testing.assert_allclose(turn.lag, q * w / ratio, rtol=0.02)  # a slice in fifty
    np.testing.assert_allclose(turn.load[turn.force > 0.0], w / ratio, rtol=0.02)


def test_half_an_overlap_is_not_so_quiet():
    """The face sees half a pitch of the path at a time: the lines' length goes with how much of that has two pairs."""
    of = pair(face=0.5 * ONCE)
    turn = turned(of, 100.0, bed(of, 5e-5), slices=60, corners=False, positions_per_pitch=25)
    ratio = path_of_contact(of[0].gear, of[1].gear, centre(of)).contact_ratio
    double = np.clip([ratio - 1.0, ratio - 1.5], 0.0, 0.5) / 0.5
    wanted = 5e-5 * 100.0 / (1.0 + double)
    assert (turn.lag.min(), turn.lag.max()) == pytest.approx(tuple(wanted), rel=0.03)


def test_one_narrow_slice_gives_way_by_its_compliances(elastic):
    """Teeth and bodies by transverse forces; flattening along the normal, with ρ_n = ρ_t / cos β_b, over cos β_b."""
    narrow = pair(face=0.5)
    turn = turned(narrow, 200.0, elastic, slices=1)
    gear, mate = narrow[0].gear, narrow[1].gear
    lean = math.cos(math.asin(math.sin(BETA) * math.cos(math.radians(20.0))))
    alone = np.flatnonzero(turn.pairs_in_contact == 1)
    assert len(alone) > 10
    for at in alone:
        number = int(turn.force[at, :, 0].argmax())
        roll, other = turn.roll[at, number], turn.mate_roll[at, number]
        flat, _ = contact_compliance(
            np.array([200.0]), roll * other / (roll + other) / lean, (centre_depth(gear, roll), centre_depth(mate, other)), STEEL
        )
        teeth = sum(float(body.at(x)[0]) + body.shared for body, x in zip(elastic.teeth, (roll, other), strict=True))
        assert turn.lag[at] == pytest.approx(200.0 * (teeth + float(flat[0]) / lean), abs=1e-9)


def test_pressure_is_that_of_the_normal_force_on_the_contact_line(helical, elastic):
    turn = turned(helical, 150.0, elastic)
    known = np.isfinite(turn.pressure) & (turn.force > 0.0)
    lean = helical[0].gear.base_helix_cosine
    per_length = turn.force / lean / (turn.widths / lean)
    roll, other = turn.roll[known], turn.mate_roll[known]
    wanted = np.sqrt(per_length[known] * 206_000.0 / (2.0 * 0.91 * math.pi * roll * other / (roll + other) / lean))
    np.testing.assert_allclose(turn.pressure[known], wanted, rtol=1e-9)
    assert known.sum() > 500


@pytest.mark.long
def test_the_other_hand_is_the_mirror_image(elastic):
    """Mirrored in z: hand and heights change, sides stay."""
    right, left = pair(), pair(-BETA)
    z = np.linspace(0.0, ONCE, 31)
    loss = 0.03 * (z / ONCE) ** 2
    one = turned((worn(right[0], loss, z), right[1]), 100.0, elastic, misalignment=0.01)
    other = turned((worn(left[0], loss[::-1], z), left[1]), 100.0, pair_compliance(*left), misalignment=-0.01)
    assert np.abs(one.transmission_error - other.transmission_error).max() < 1e-9
    np.testing.assert_allclose(one.force.sum(axis=1), other.force.sum(axis=1)[:, ::-1], atol=1e-6 * one.total)
    assert one.face_load_factor == pytest.approx(other.face_load_factor) and one.face_load_factor > 1.3


def test_a_pair_turned_end_for_end_carries_the_same(elastic):
    """Half a turn about x: the same hand, the other side carries, heights run the other way."""
    of = pair()
    z = np.linspace(0.0, ONCE, 31)
    loss = 0.03 * (z / ONCE) ** 2
    one = turned((worn(of[0], loss, z), of[1]), 100.0, elastic)
    other = turned((worn(of[0], loss[::-1], z, Side.RIGHT), of[1]), 100.0, elastic, drive_side=Side.RIGHT)
    assert np.abs(one.transmission_error - other.transmission_error).max() < 1e-9
    np.testing.assert_allclose(one.force.sum(axis=1), other.force.sum(axis=1)[:, ::-1], atol=1e-6 * one.total)


def test_misalignment_is_a_taper_of_the_mate_along_the_transverse_line_of_action(helical, elastic):
    """A loss of the driven gear's flanks that grows to 20 µm at the upper end, against a gap of 20 µm over the face."""
    z = np.linspace(0.0, ONCE, 16)
    taper = worn(helical[1], 0.02 * z / ONCE, z)
    one = turned((helical[0], taper), 100.0, elastic)
    other = turned(helical, 100.0, elastic, misalignment=0.02)
    assert np.abs(one.transmission_error - other.transmission_error + 0.01).max() < 1e-8
    np.testing.assert_allclose(one.force.sum(axis=1), other.force.sum(axis=1), atol=1e-6 * one.total)


def test_the_tangent_is_the_slope_of_the_lag(helical, elastic):
    less, middle, more = (turned(helical, w, elastic) for w in (199.99, 200.0, 200.01))
    np.testing.assert_allclose(middle.compliance, (more.lag - less.lag) / (0.02 * ONCE), rtol=1e-4)


def test_slices_twice_as_narrow_change_the_error_by_little(helical, elastic):
    """0.2 µm, and 0.3 % of the lag: contact lines end somewhere within a slice."""
    usual, fine = (turned(helical, 100.0, elastic, slices=count) for count in (15, 30))
    assert np.abs(usual.transmission_error - fine.transmission_error).max() < 2e-4
    assert usual.mean_lag == pytest.approx(fine.mean_lag, rel=0.003)


def test_slices_are_coupled_over_a_length_along_the_tooth(elastic):
    """1.2 normal modules of it, which lies at β to the axis; a spur tooth's is that along the axis."""
    assert elastic.coupling / math.cos(BETA) == pytest.approx(1.2 * MODULE)


def test_the_spread_holds_how_wide_the_slices_are(helical, elastic):
    gears = {"pinion": {"teeth": 17, "module": MODULE, "face_width": ONCE, "helix_angle": 20.0}, "gear": {"teeth": 31}}
    study = study_load(parse_design(gears), load=LoadSpec(load_per_width=100.0), cycle="pitch")
    fine = turned(helical, 100.0, elastic, slices=30)
    for name, narrow, usual in zip(QUANTITIES, numbers(fine), numbers(study.design), strict=True):
        assert study.design_spread.std(name) >= abs(narrow - usual) > 0.0
    assert study.present.peak_to_peak == pytest.approx(study.design.peak_to_peak) and study.present.z.size == 15


@pytest.mark.long
def test_stiffness_by_iso_6336():
    """c_γ = c' (0.75 ε_α + 0.25) with c' = 0.8 c'_th C_B cos β of virtual teeth, method B of ISO 6336-1; good to some 15 %."""
    beta = math.radians(30.0)
    of = pair(beta, math.pi * MODULE / math.sin(beta))
    turn = turned(of, 300.0, pair_compliance(*of))
    virtual = [flanks.gear.teeth / (flanks.gear.base_helix_cosine**2 * math.cos(beta)) for flanks in of]
    softness = 0.04723 + 0.15551 / virtual[0] + 0.25791 / virtual[1]
    single = 0.8 / softness * (1.0 + 0.5 * (1.2 - 1.25)) * math.cos(beta)
    ratio = path_of_contact(of[0].gear, of[1].gear, centre(of)).contact_ratio
    assert turn.stiffness.mean() == pytest.approx(single * (0.75 * ratio + 0.25), rel=0.15)


def test_a_double_helical_pair_is_two_helical_ones(helical, elastic):
    """Each half carries half of it; one gear floats, so 20 µm off one half's flanks lets the mate fall back by 10 µm, and nothing else."""
    double, half = pair(face=2.0 * ONCE + 4.0, gap=4.0), helical
    alone, both = (turned(of, 100.0, elastic) for of in (half, double))
    assert np.abs(alone.transmission_error - both.transmission_error).max() < 1e-9
    np.testing.assert_allclose(alone.compliance, 2.0 * both.compliance, rtol=1e-6)
    z = np.array([0.0, ONCE + 1.9, ONCE + 2.1, 2.0 * ONCE + 4.0])
    slack = worn(double[1], np.array([0.0, 0.0, 0.02, 0.02]), z)
    lower = turned((double[0], slack), 100.0, elastic)
    assert np.abs(lower.transmission_error - both.transmission_error + 0.01).max() < 1e-9
    np.testing.assert_allclose(lower.force[:, :, :15].sum(axis=(1, 2)), 0.5 * lower.total, rtol=1e-9)


def test_rings_are_refused_by_name(helical, elastic):
    ring = Gear.from_spec(GearSpec("ring", 48, MODULE, 10.0, internal=True, rim_diameter=150.0))
    with pytest.raises(InputError, match="contact under load of internal gears is out of scope"):
        loaded_contact(helical[0], nominal_profiles(ring), 50.0, 1.0, elastic)
    with pytest.raises(InputError, match="wear that runs of internal gears is out of scope"):
        run_wear(helical[0].gear, ring, 50.0, 100.0, elastic, [0.0])
