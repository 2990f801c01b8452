"""Loaded contact against what is true for other reasons: rigid contact, closed forms, conservation, finite elements of another program."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.loaded.contact import loaded_contact, pair_compliance
from gearwear.loaded.formulas import beam_on_half_plane
from gearwear.loaded.hertz import contact_compliance, greatest_pressure, half_width
from gearwear.loaded.pair_compliance import PairCompliance, centre_depth, coupling_matrix, curvature_radius
from gearwear.loaded.result import LoadedContact
from gearwear.loaded.steel import Material
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.path import path_of_contact

C = 114.3
FACE = 15.0


def worn(gear: ToothProfiles, depth: np.ndarray | float, z: np.ndarray | None = None) -> ToothProfiles:
    """With a loss normal to all left flanks, mm, that may go along the face and the radius: (n_z, n_r) or less."""
    at = gear.z if z is None else z
    psi = np.broadcast_to(gear.half_angle[:, :, :1], (*gear.half_angle.shape[:2], len(at), gear.half_angle.shape[3])).copy()
    psi[:, 0] -= np.broadcast_to(depth, psi.shape[2:]) / gear.gear.base_radius
    return ToothProfiles(gear.gear, gear.radius, at, psi)


def one_pitch(driver: ToothProfiles, driven: ToothProfiles, w: float, elastic: PairCompliance, **more) -> LoadedContact:
    return loaded_contact(driver, driven, C, w * FACE, elastic, cycle="pitch", **more)


def test_without_load_it_is_rigid_contact(pinion, wheel, elastic):
    """Oracle a, on flanks of which no two are alike."""
    random = np.random.default_rng(1)
    z = np.linspace(0.5, 14.5, 15)
    psi = np.repeat(pinion.half_angle, 15, axis=2) - random.uniform(0.0, 0.02, (12, 2, 15, 1)) / pinion.gear.base_radius
    own = ToothProfiles(pinion.gear, pinion.radius, z, psi)
    rigid = mesh_contact(own, wheel, C, positions_per_pitch=9)
    for force in (0.0, 1e-7):
        found = loaded_contact(own, wheel, C, force, elastic, positions_per_pitch=9)
        assert np.abs(found.transmission_error - rigid.transmission_error).max() < 1e-9
    assert np.array_equal(found.rigid_transmission_error, rigid.transmission_error)


def test_the_difference_from_rigid_vanishes_with_the_load(pinion, wheel, elastic):
    lags = [one_pitch(pinion, wheel, w, elastic, slices=3).lag.max() for w in (10.0, 1.0, 0.1, 0.01)]
    assert all(6.0 < one / other < 10.0 for one, other in pairwise(lags))  # ln in Hertz: a little under 10


def test_a_uniform_loss_of_the_driven_gear_shifts_it_by_exactly_that(pinion, wheel, elastic):
    """Oracle b: the worn flanks are the design's, turned; corners too."""
    new, old = (one_pitch(pinion, one, 150.0, elastic, slices=2) for one in (wheel, worn(wheel, 0.05)))
    assert np.abs(old.transmission_error - new.transmission_error + 0.05).max() < 1e-9
    np.testing.assert_allclose(old.force, new.force, atol=1e-6 * 150.0 * FACE)


def test_a_uniform_loss_of_the_driver_is_a_turn_of_it(pinion, wheel, elastic):
    """The same flanks come 0.05 / r_b1 later: half a step of 0.05 mm and 0.05 mm less."""
    count = round(pinion.gear.base_pitch / 0.05)
    loss = pinion.gear.base_pitch / count  # as far as from one position to the next
    new, old = (
        one_pitch(one, wheel, 150.0, elastic, slices=1, positions_per_pitch=count) for one in (pinion, worn(pinion, loss))
    )
    assert np.abs(old.transmission_error - np.roll(new.transmission_error, 1) + loss).max() < 1e-9


def test_a_single_pair_gives_way_by_the_sum_of_its_compliances(pinion, wheel, elastic):
    """Oracle c."""
    found = one_pitch(pinion, wheel, 200.0, elastic, slices=1)
    alone = np.flatnonzero(found.pairs_in_contact == 1)
    assert len(alone) > 10
    for at in alone:
        pair = int(found.force[at, :, 0].argmax())
        roll, mate = found.roll[at, pair, 0], found.mate_roll[at, pair, 0]
        depths = centre_depth(pinion.gear, np.array([roll])), centre_depth(wheel.gear, np.array([mate]))
        hertz = contact_compliance(
            np.array([200.0]), curvature_radius(np.array([roll]), np.array([mate]), 1.0), depths, Material()
        )[0]
        teeth = sum(float(one.at(np.array([x]))[0]) + one.shared for one, x in zip(elastic.teeth, (roll, mate), strict=True))
        assert found.lag[at] == pytest.approx(200.0 * (teeth + float(hertz[0])), abs=1e-9)


def test_force_is_conserved_and_flanks_do_not_overlap(pinion, wheel, elastic):
    """Oracle d."""
    z = np.linspace(0.5, 14.5, 15)
    own = worn(pinion, 0.02 * (z[:, None] / FACE) ** 2, z)
    found = one_pitch(own, wheel, 120.0, elastic, misalignment=0.03)
    np.testing.assert_allclose(found.force.sum(axis=(1, 2)), found.total, rtol=1e-6)
    assert (found.force >= 0.0).all()
    np.testing.assert_allclose(found.load_share.sum(axis=1), 1.0, rtol=1e-9)
    matrix = elastic.matrix((found.roll, found.mate_roll), found.widths)
    np.testing.assert_allclose(matrix, matrix.swapaxes(1, 2), rtol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > 0.0


def test_slices_alike_are_one_slice(pinion, wheel, elastic):
    """Oracle e: an even load is not changed by how slices are coupled."""
    whole = one_pitch(pinion, wheel, 130.0, elastic, slices=1)
    for length in (0.0, elastic.coupling, 30.0):
        parts = one_pitch(pinion, wheel, 130.0, replace(elastic, coupling=length), slices=15)
        assert np.abs(parts.transmission_error - whole.transmission_error).max() < 1e-9
        np.testing.assert_allclose(parts.load.sum(axis=1), np.broadcast_to(whole.load.sum(axis=1), (34, 15)), rtol=1e-7)


def test_coupling_is_that_of_a_free_beam():
    """1ᵀ-even in, even out; and far from a point load the deflection dies off as exp(−z/ℓ)."""
    widths = np.full(400, 0.1)
    matrix = coupling_matrix(widths, 2.0)
    np.testing.assert_allclose(matrix @ widths, 1.0, rtol=1e-9)
    middle = matrix[200]
    assert middle[220] / middle[200] == pytest.approx(math.exp(-1.0), rel=0.01)
    assert middle[200] == pytest.approx(1.0 / (2.0 * 2.0), rel=0.01)  # of (1 − ℓ² d²/dz²) u = δ


@pytest.mark.parametrize("gap", [0.06, -0.06])
def test_a_misaligned_pair_is_a_wedge_on_a_soft_bed(pinion, wheel, elastic, gap):
    """Oracle h: independent slices, no flattening, nothing shared: contact length sqrt(2 F b q / f), greatest load 2 F / it."""
    bed = replace(elastic, coupling=0.0, shared=False, hertz=False)
    found = one_pitch(pinion, wheel, 100.0, bed, misalignment=gap, slices=150, positions_per_pitch=12)
    alone = np.flatnonzero(found.pairs_in_contact == 1)
    assert 1 <= len(alone) <= 8  # of 12: without load 2 − 1.254 of a pitch, the contact ratio of the pair, and less with it
    for at in alone:
        pair = int(found.force[at].sum(axis=1).argmax())
        q = sum(float(one.at(x[at, pair, :1])[0]) for one, x in zip(elastic.teeth, (found.roll, found.mate_roll), strict=True))
        length = math.sqrt(2.0 * found.total * FACE * q / abs(gap))
        assert length < FACE
        assert found.load[at, pair].max() == pytest.approx(2.0 * found.total / length, rel=0.02)
        touched = found.z[found.load[at, pair] > 0.0]
        assert np.ptp(touched) + found.widths[0] == pytest.approx(length, abs=2.0 * found.widths[0])
        assert (touched.mean() < 0.5 * FACE) == (gap > 0.0)  # + opens towards the upper end


def test_misalignment_of_the_right_flanks_opens_the_other_way(pinion, wheel, elastic):
    left, right = (
        one_pitch(pinion, wheel, 100.0, elastic, drive_side=side, misalignment=0.03) for side in (Side.LEFT, Side.RIGHT)
    )
    np.testing.assert_allclose(left.force.sum(axis=(0, 1)), right.force.sum(axis=(0, 1))[::-1], rtol=1e-6)


def test_a_misaligned_pair_by_another_program(pinion, wheel, elastic):
    """30 µm over the face at 200 N/mm with the formulas it used: greatest load per width, the mean of all positions, and peak to peak."""
    teeth = tuple(beam_on_half_plane(one.gear, elastic.material, one.roll) for one in elastic.teeth)
    for modules, load, ripple in ((0.0, 342.0, 7.0), (0.6, 451.0, 7.5), (1.2, 552.0, 8.2), (2.4, 622.0, 8.5)):
        model = PairCompliance((teeth[0], teeth[1]), elastic.material, modules * 6.35)
        found = one_pitch(pinion, wheel, 200.0, model, misalignment=0.03)
        assert found.load.max(axis=(1, 2)).mean() == pytest.approx(load, rel=0.015)
        assert 1e3 * found.peak_to_peak == pytest.approx(ripple, rel=0.025)


@pytest.mark.parametrize(
    ("w", "lag", "ripple", "stiffness", "double"),
    [(100.0, 8.89, 3.07, (10.1, 12.2, 14.4), 0.47), (300.0, 25.0, 8.65, (10.5, 13.0, 14.8), 0.57)],
)
def test_the_published_pair_by_other_finite_elements(pinion, wheel, elastic, w, lag, ripple, stiffness, double):
    """Mean lag, peak to peak, tangent stiffness and share of double contact of a program that shares nothing with this one."""
    found = one_pitch(pinion, wheel, w, elastic, slices=1, positions_per_pitch=102)
    assert 1e3 * found.mean_lag == pytest.approx(lag, rel=0.02)
    assert 1e3 * found.peak_to_peak == pytest.approx(ripple, rel=0.04)
    assert (found.stiffness.min(), found.stiffness.mean(), found.stiffness.max()) == pytest.approx(stiffness, rel=0.02)
    assert (found.pairs_in_contact >= 2).mean() == pytest.approx(double, abs=0.03)


def test_stiffness_by_iso_6336(pinion, wheel, elastic):
    """Oracle g: c' 11.00 and c_γ 13.09 N/(mm µm) by method B of ISO 6336-1, good to some 15 %."""
    found = one_pitch(pinion, wheel, 300.0, elastic, slices=1)
    assert found.stiffness.min() == pytest.approx(11.0, rel=0.15)
    assert found.stiffness.mean() == pytest.approx(13.09, rel=0.15)


def test_the_tangent_is_the_slope_of_the_lag(pinion, wheel, elastic):
    less, more = (one_pitch(pinion, wheel, w, elastic, slices=1) for w in (199.99, 200.01))
    middle = one_pitch(pinion, wheel, 200.0, elastic, slices=1)
    slope = (more.lag - less.lag) / (0.02 * FACE)
    np.testing.assert_allclose(middle.compliance, slope, rtol=1e-4)


def test_more_pairs_carry_under_load_than_without(pinion, wheel, elastic):
    """The contact ratio grows from that of the involutes, 1.254."""
    ratios = [one_pitch(pinion, wheel, w, elastic, slices=1, positions_per_pitch=200).contact_ratio for w in (0.5, 50.0, 200.0)]
    assert ratios == sorted(ratios)
    assert ratios[0] == pytest.approx(path_of_contact(pinion.gear, wheel.gear, C).contact_ratio, abs=0.06)


def test_a_revolution_is_so_many_pitches_and_its_spectrum_that_of_the_mesh(pinion, wheel, elastic):
    pitch = one_pitch(pinion, wheel, 100.0, elastic, slices=1)
    turn = loaded_contact(pinion, wheel, C, 1500.0, elastic, slices=1)
    np.testing.assert_allclose(turn.transmission_error, np.tile(pitch.transmission_error, 12), atol=1e-9)
    np.testing.assert_allclose(turn.harmonics(), pitch.harmonics(), atol=1e-9)
    # Parseval over all harmonics of the mesh.
    every = pitch.harmonics(17)
    assert 0.5 * (every[:-1] ** 2).sum() + every[-1] ** 2 == pytest.approx(pitch.transmission_error.var(), rel=1e-9)


@pytest.mark.parametrize("order", [1, 5, 17])
def test_harmonics_of_a_cosine_are_its_amplitude(pinion, wheel, elastic, order):
    """Also at half the positions of a pitch (Nyquist); what is beyond is 0."""
    found = one_pitch(pinion, wheel, 100.0, elastic, slices=1)
    wave = 3e-3 * np.cos(2.0 * np.pi * order * np.arange(found.per_pitch) / found.per_pitch)
    assert found.per_pitch == 34
    amplitudes = replace(found, transmission_error=wave).harmonics(20)
    np.testing.assert_allclose(amplitudes, np.where(np.arange(1, 21) == order, 3e-3, 0.0), atol=1e-17)


def test_hertz_by_hand():
    """A steel cylinder of 10 mm on a plane at 100 N/mm (Johnson 1985): p_max = 2 w / (π a)."""
    load, radius = np.array([100.0]), np.array([10.0])
    a, pressure = half_width(load, radius, Material()), greatest_pressure(load, radius, Material())
    assert float(a[0]) == pytest.approx(math.sqrt(8.0 * 100.0 * 10.0 * 0.91 / (math.pi * 206000.0)), rel=1e-12)
    assert float(pressure[0]) == pytest.approx(2.0 * 100.0 / (math.pi * float(a[0])), rel=1e-12)


def test_pressure_of_the_pair_at_the_pitch_point(pinion, wheel, elastic):
    found = one_pitch(pinion, wheel, 200.0, elastic, slices=1, positions_per_pitch=200)
    path = path_of_contact(pinion.gear, wheel.gear, C)
    off = np.abs(found.roll - path.pitch_pinion)
    at = np.unravel_index(int(off.argmin()), off.shape)
    radius = path.pitch_pinion * path.pitch_gear / path.line
    wanted = math.sqrt(200.0 * 206000.0 / (2.0 * 0.91 * math.pi * radius))
    assert found.pressure[at] == pytest.approx(wanted, rel=0.002)


def test_no_pressure_is_told_of_corners(pinion, wheel, elastic):
    found = one_pitch(pinion, wheel, 400.0, elastic, slices=1)
    assert found.edge_load > 0.1  # the premature contact of the mate's tip
    assert np.isnan(found.pressure[found.on_edge]).all() and math.isfinite(found.greatest_pressure)


def test_either_gear_may_be_worn_and_wider():
    narrow = nominal_profiles(Gear.from_spec(GearSpec("pinion", 12, 6.35, 10.0)))
    wide = nominal_profiles(Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0)))
    elastic = pair_compliance(narrow, wide)
    z = np.linspace(0.0, 15.0, 31)
    # Wear only beyond the pinion's face, from 2.5 to 12.5 mm beside the gear's, changes nothing.
    beyond = worn(wide, np.where(np.abs(z - 7.5) > 5.5, 0.1, 0.0)[:, None], z)
    plain, other = (loaded_contact(narrow, one, C, 1000.0, elastic, cycle="pitch", slices=5) for one in (wide, beyond))
    np.testing.assert_allclose(plain.transmission_error, other.transmission_error, atol=1e-12)
    assert plain.load_per_width == pytest.approx(100.0)


def test_bad_input_is_named(pinion, wheel, elastic):
    with pytest.raises(InputError, match="force = -1 N: must be 0 or above"):
        loaded_contact(pinion, wheel, C, -1.0, elastic)
    with pytest.raises(InputError, match="in some positions no tooth reaches the mate"):
        loaded_contact(pinion, wheel, 125.0, 100.0, elastic, cycle="pitch", slices=1)


@pytest.mark.parametrize("distance", [112.7, 108.0, 0.0, -114.3, math.nan, math.inf])
def test_a_centre_distance_at_which_rigid_gears_cannot_turn_is_refused_alike(pinion, wheel, elastic, distance):
    """At 112 mm tips dig 0.7 mm into roots: a transmission error of 2268 µm was found under a load of 10 N/mm."""
    said = []
    for contact in (
        lambda: mesh_contact(pinion, wheel, distance),
        lambda: loaded_contact(pinion, wheel, distance, 100.0, elastic),
    ):
        with pytest.raises(InputError) as refused:
            contact()
        said.append(str(refused.value))
    assert said[0] == said[1] and f"centre distance {distance:g} mm" in said[0]


def test_without_corners_a_pair_begins_and_ends_with_the_path(pinion, wheel, elastic):
    """No load off the line of action, all of it on it, and as many pairs as the contact ratio says to a position or two."""
    free = loaded_contact(pinion, wheel, 114.3, 1500.0, elastic, cycle="pitch", slices=1, positions_per_pitch=200, corners=False)
    sharp = loaded_contact(pinion, wheel, 114.3, 1500.0, elastic, cycle="pitch", slices=1, positions_per_pitch=200)
    path = path_of_contact(pinion.gear, wheel.gear, 114.3)
    assert free.force.sum(axis=(1, 2)) == pytest.approx(1500.0)
    assert free.contact_ratio == pytest.approx(path.contact_ratio, abs=1.0 / 200)
    on_path = free.roll[free.force > 0.0]
    assert on_path.min() > path.start_pinion - 0.01 and on_path.max() < path.end_pinion + 0.01
    assert free.contact_ratio < sharp.contact_ratio


def test_without_corners_a_position_that_only_corners_reach_keeps_them(pinion, wheel, elastic):
    """Gears so far apart that the path is shorter than a base pitch are driven by their corners in between."""
    apart = 114.3 + 5.0
    assert path_of_contact(pinion.gear, wheel.gear, apart).contact_ratio < 1.0
    found = loaded_contact(pinion, wheel, apart, 1500.0, elastic, cycle="pitch", slices=1, corners=False)
    assert found.force.sum(axis=(1, 2)) == pytest.approx(1500.0) and found.edge_load == pytest.approx(1.0)


def test_a_corner_is_the_last_fiftieth_of_a_module_and_what_lies_below_the_form_circle(pinion, wheel, elastic):
    found = loaded_contact(pinion, wheel, 114.3, 1500.0, elastic, cycle="pitch", slices=1, positions_per_pitch=4)
    tip, mate_tip, module = pinion.gear.tip_roll, wheel.gear.tip_roll, 6.35

    def edge(roll: float, mate_roll: float) -> bool:
        there = replace(found, roll=np.full_like(found.roll, roll), mate_roll=np.full_like(found.roll, mate_roll))
        return bool(there.on_edge.all())

    inside = 0.5 * mate_tip
    assert edge(tip - 0.019 * module, inside) and not edge(tip - 0.021 * module, inside)
    assert edge(0.5 * tip, mate_tip - 0.019 * module) and not edge(0.5 * tip, mate_tip - 0.021 * module)
    assert edge(0.99 * pinion.gear.form_roll, inside) and edge(0.5 * tip, 0.99 * wheel.gear.form_roll)
