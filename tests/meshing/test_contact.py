"""Rigid contact against the reference numbers, closed forms and invariances."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.meshing.backlash import centre_distance_for_backlash, normal_backlash
from gearwear.meshing.contact import _contact_ratio, mesh_contact
from gearwear.meshing.path import path_of_contact
from tests.meshing.worn import design, roll_of, rough, sliding_like, wear

C = 114.3
EXACT = 1e-9  # mm: rounding of angles near 1 rad times a radius of 100 mm, and the end of the search


@pytest.fixture(scope="module")
def mate(wheel):
    return design(wheel)


@pytest.fixture(scope="module")
def own(pinion):
    return design(pinion)


@pytest.fixture(scope="module")
def rough_contact(own, mate):
    """Flanks like scanned ones, no two alike, over a revolution."""
    return mesh_contact(rough(own, 4), rough(mate, 5), C, tolerances=(0.0, 0.001, 0.010))


@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize(("centre", "backlash"), [(C, 0.0), (116.722, 1.780441)])
def test_perfect_pair_has_no_error_at_any_phase(own, mate, centre, backlash, side):
    for driver, driven in ((own, mate), (mate, own)):
        result = mesh_contact(driver, driven, centre, side)
        np.testing.assert_allclose(result.transmission_error, 0.0, atol=EXACT)
        np.testing.assert_allclose(result.backlash, backlash, atol=5e-7)
        assert result.peak_to_peak_um < 1e-5
        np.testing.assert_allclose(result.angular_backlash_driver, backlash / driver.gear.base_radius, atol=1e-8)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_the_deepest_of_many_cusps_is_found_between_few_positions(own, mate, seed):
    """Each tooth worn a little more or less than its neighbours: 5 positions to a pitch find what 200 do."""
    worn = own
    for tooth, factor in enumerate(1.0 + 0.3 * np.random.default_rng(seed).random(12)):
        worn = wear(worn, lambda roll, factor=factor: factor * sliding_like(roll), [tooth])
    few, many = (mesh_contact(worn, mate, C, positions_per_pitch=n) for n in (5, 200))
    assert few.transmission_error_min.value == pytest.approx(many.transmission_error_min.value, abs=1e-6)
    assert few.backlash_max.value == pytest.approx(many.backlash_max.value, abs=1e-6)
    assert few.backlash_max.rotation == pytest.approx(many.backlash_max.rotation, abs=1e-4)


def test_shifted_and_thinned_pair_has_the_closed_form_backlash():
    pinion = Gear.from_spec(GearSpec("pinion", 17, 3.0, 20.0, profile_shift=0.4, thinning=0.05, rack_tip_radius=0.38))
    gear = Gear.from_spec(GearSpec("gear", 41, 3.0, 20.0, profile_shift=-0.1, thinning=0.1, rack_tip_radius=0.38))
    for centre in (87.9, 88.2, 88.6):
        result = mesh_contact(design(pinion), design(gear), centre)
        np.testing.assert_allclose(result.transmission_error, 0.0, atol=EXACT)
        np.testing.assert_allclose(result.backlash, normal_backlash(pinion, gear, centre), atol=2 * EXACT)


@pytest.mark.parametrize(
    ("depth", "pitches", "low", "high"), [(0.01, 0.526, 36.73, 40.05), (0.1, 0.359, 37.01, 39.21), (0.5, 0.186, 37.48, 38.62)]
)
def test_uniform_wear_of_one_tooth_is_the_lag_while_that_tooth_leads(own, mate, depth, pitches, low, high):
    n = 100
    result = mesh_contact(wear(own, depth, [0]), mate, C, positions_per_pitch=n)
    assert result.transmission_error_min.value == pytest.approx(-depth, abs=EXACT)
    assert result.transmission_error_max.value == pytest.approx(0.0, abs=EXACT)
    assert result.backlash_max.value == pytest.approx(depth, abs=EXACT)
    assert result.backlash_min.value == pytest.approx(0.0, abs=EXACT)
    leads = result.driver_tooth == 0
    step = 0.19 * 18.7 / n  # mm of radius per position, at most: dr = (L/r) dL
    assert leads.sum() / n == pytest.approx(pitches, abs=1.0 / n)
    assert result.driver_radius[leads].min() == pytest.approx(low, abs=3 * step)
    assert result.driver_radius[leads].max() == pytest.approx(high, abs=3 * step)


@pytest.mark.parametrize(
    ("depth", "n"),
    [(1.872, 17), pytest.param(1.872, 60, marks=pytest.mark.long), pytest.param(1.4, 17, marks=pytest.mark.long), (1.4, 60)],
)
def test_a_tooth_worn_more_than_its_neighbours_can_do_without_never_touches(own, mate, depth, n):
    result = mesh_contact(wear(own, depth, [0]), mate, C, positions_per_pitch=n)
    assert result.transmission_error_min.value == pytest.approx(-1.328, abs=0.002)
    assert np.degrees(result.transmission_error_min.rotation) - 360.0 == pytest.approx(-6.15, abs=0.01)
    assert not (result.driver_tooth == 0).any()


def test_three_worn_neighbours_reach_the_full_depth(own, mate):
    result = mesh_contact(wear(own, 1.872, [11, 0, 1]), mate, C)
    assert result.transmission_error_min.value == pytest.approx(-1.872, abs=EXACT)


def test_equal_wear_of_all_teeth_is_constant_and_leaves_path_and_ratio(own, mate):
    before, after = (
        mesh_contact(one, mate, C, positions_per_pitch=120, cycle="pitch") for one in (own, wear(own, 1.872, range(12)))
    )
    np.testing.assert_allclose(after.transmission_error, -1.872, atol=EXACT)
    assert after.peak_to_peak_um < 1e-5
    for (_, new), (_, old) in zip(after.contact_ratio, before.contact_ratio, strict=True):
        assert new == pytest.approx(old, abs=1.0 / 120)


@pytest.mark.parametrize(
    ("factor", "teeth", "lag", "within_1", "within_10", "low", "high"),
    [
        (0.0, range(12), 0.0, 1.300, 1.473, 35.93, 44.45),
        (1.0, range(12), 87.0, 1.007, 1.06, 36.20, 41.76),
        pytest.param(0.1, range(12), 9.3, 1.057, 1.40, None, None, marks=pytest.mark.long),
        pytest.param(1.0, [0], 38.3, None, None, 37.09, 39.20, marks=pytest.mark.long),
    ],
)
def test_sliding_like_wear_takes_contact_to_the_pitch_point(pinion, mate, factor, teeth, lag, within_1, within_10, low, high):
    ridge = np.hypot(pinion.base_radius, 13.03)  # the unworn line is a knot, else it is cut off
    own = wear(design(pinion, extra=[ridge]), lambda roll: factor * sliding_like(roll), teeth)
    result = mesh_contact(own, mate, C, positions_per_pitch=200, cycle="pitch" if len(teeth) == 12 else "revolution")
    # The reference sampled the phases; the cusp between them is up to 0.2 µm deeper.
    assert -1e3 * result.transmission_error_min.value == pytest.approx(lag, abs=0.25)
    assert result.peak_to_peak_um == pytest.approx(lag, abs=0.25)
    if within_1:
        assert result.contact_ratio[0][1] == pytest.approx(within_1, abs=0.005)
        assert result.contact_ratio[1][1] == pytest.approx(within_10, abs=0.005)
    if low:
        carried = result.driver_radius[np.isin(result.driver_tooth, list(teeth))]
        assert carried.min() == pytest.approx(low, abs=0.02)
        assert carried.max() == pytest.approx(high, abs=0.02)


def test_a_root_drawn_radial_below_the_base_circle_collides(pinion, mate):
    radius = np.unique(
        np.append(np.linspace(pinion.root_radius, pinion.tip_radius, 300), [pinion.base_radius, pinion.form_radius])
    )
    xi = np.sqrt(np.maximum(radius**2 / pinion.base_radius**2 - 1.0, 0.0))
    psi = pinion.base_half_angle - (xi - np.arctan(xi))
    drawn = ToothProfiles(pinion, radius, np.array([7.5]), np.tile(psi, (12, 2, 1, 1)))
    result = mesh_contact(drawn, mate, C, cycle="pitch")
    assert 1e3 * result.transmission_error_max.value == pytest.approx(12.2, abs=0.05)
    assert 1e3 * result.backlash_min.value == pytest.approx(-23.4, abs=0.15)
    far = mesh_contact(drawn, mate, 115.0, cycle="pitch")
    assert far.transmission_error_max.value == pytest.approx(0.0, abs=2e-5)


@pytest.mark.parametrize(
    ("teeth", "lag", "margin"), [([0], 0.542, 0.003), pytest.param(range(12), 0.812, 0.013, marks=pytest.mark.long)]
)
def test_wear_that_stops_at_the_form_circle_leaves_a_ledge_for_the_mates_tip(pinion, mate, teeth, lag, margin):
    # A ledge one grid step (0.01 mm) lower lowers the numbers by 0.005 and 0.010 mm: that is the reference's margin.
    edge = [pinion.form_radius - 1e-6, pinion.form_radius]
    own = design(pinion, extra=edge)
    worn = wear(own, np.where(own.radius >= pinion.form_radius, 1.872, 0.0), teeth)
    result = mesh_contact(worn, mate, C)
    assert -result.transmission_error_min.value == pytest.approx(lag, abs=margin)


def test_either_gear_may_be_the_worn_one_and_either_may_drive(own, mate):
    for driver, driven in ((own, wear(mate, 0.1, [3])), (wear(mate, 0.1, [3]), own)):
        result = mesh_contact(driver, driven, C, cycle="hunting")
        assert result.transmission_error_min.value == pytest.approx(-0.1, abs=EXACT)
        assert result.backlash_max.value == pytest.approx(0.1, abs=EXACT)


def test_the_same_flanks_touch_whoever_drives(own, mate):
    """Left flanks on left flanks: the set of positions is one and the same."""
    worn = wear(own, sliding_like, [0])
    forth, back = mesh_contact(worn, mate, C), mesh_contact(mate, worn, C)
    assert forth.backlash_max.value == pytest.approx(back.backlash_max.value, abs=1e-6)
    assert forth.transmission_error_min.value == pytest.approx(back.transmission_error_min.value, abs=1e-6)


def test_seen_in_a_mirror_nothing_changes(own, mate):
    one, two = rough(own, 1), rough(mate, 2)
    result = mesh_contact(one, two, C, Side.LEFT, positions_per_pitch=5)

    def mirrored(profiles):
        return replace(profiles, half_angle=np.roll(profiles.half_angle[::-1, ::-1], 1, axis=0))

    other = mesh_contact(mirrored(one), mirrored(two), C, Side.RIGHT, positions_per_pitch=5, start_tooth=-1)
    np.testing.assert_allclose(other.transmission_error, result.transmission_error, atol=1e-12)
    np.testing.assert_allclose(other.backlash, result.backlash, atol=1e-12)
    np.testing.assert_array_equal(other.driver_tooth, -result.driver_tooth % 12)
    np.testing.assert_array_equal(other.driven_tooth, -result.driven_tooth % 24)


def test_start_tooth_is_a_matter_of_numbering(own, mate):
    two = rough(mate, 2)
    shifted = replace(two, half_angle=np.roll(two.half_angle, 5, axis=0))
    result, other = (
        mesh_contact(own, two, C, positions_per_pitch=5),
        mesh_contact(own, shifted, C, positions_per_pitch=5, start_tooth=5),
    )
    np.testing.assert_array_equal(other.transmission_error, result.transmission_error)
    np.testing.assert_array_equal(other.driven_tooth, (result.driven_tooth + 5) % 24)


def test_rigid_bodies_touch_where_most_is_left(pinion, mate):
    own = design(pinion, slices=5)
    deep = own.half_angle.copy()
    deep[:, 0, [0, 1, 2, 4]] -= 0.05 / pinion.base_radius
    result = mesh_contact(replace(own, half_angle=deep), mate, C)
    np.testing.assert_allclose(result.transmission_error, 0.0, atol=EXACT)
    assert (result.z == own.z[3]).all()
    assert result.driver_pattern.count[:, [0, 1, 2, 4]].sum() == 0
    assert result.driver_pattern.count[:, 3].sum() > 0


def test_a_driven_gear_on_other_heights_is_interpolated(pinion, wheel, own):
    """Deviation linear in z on the driven gear: the highest place of the driver's slices carries."""
    z = np.array([0.0, 15.0])
    taper = nominal_profiles(wheel, np.linspace(wheel.root_radius, wheel.tip_radius, 80), z)
    psi = taper.half_angle.copy()
    psi[:, 0, 1] -= 0.06 / wheel.base_radius
    driver = nominal_profiles(pinion, own.radius, np.array([5.0, 10.0, 12.0]))
    result = mesh_contact(driver, replace(taper, half_angle=psi), C)
    np.testing.assert_allclose(result.transmission_error, -0.06 * 5.0 / 15.0, atol=EXACT)
    assert (result.z == 5.0).all()


def test_over_the_hunting_cycle_two_worn_teeth_meet_once(pinion):
    gear = Gear.from_spec(GearSpec("gear", 25, 6.35, 15.0, rack_tip_radius=0.25))
    centre = pinion.reference_radius + gear.reference_radius
    one, two = wear(design(pinion), 0.1, [2]), wear(design(gear), 0.1, [7])
    result = mesh_contact(one, two, centre, cycle="hunting")
    assert len(result.rotation) == 17 * 12 * 25
    full = np.flatnonzero(result.transmission_error < -0.2 + EXACT)
    assert len(full) and np.ptp(full) < 17  # within one pitch, in all the cycle
    assert (result.driver_tooth[full] == 2).all() and (result.driven_tooth[full] == 7).all()
    # Left flank of driver tooth k touches driven tooth −k, both numbered without end.
    passing = full[0] // 17
    candidates = [-k for k in range(passing - 3, passing + 4)]
    assert any(k % 12 == 2 and -k % 25 == 7 for k in candidates)
    assert (result.driver_pattern.passes == 25).all() and (result.driven_pattern.passes == 12).all()


def test_pattern_of_a_perfect_pair_is_the_path_of_contact(pinion, wheel, own, mate):
    result = mesh_contact(own, mate, C, positions_per_pitch=100, cycle="hunting", tolerances=(0.0005,))
    path = path_of_contact(pinion, wheel, C)
    limits = ((path.start_pinion, path.end_pinion), (path.start_gear, path.end_gear))
    for pattern, (start, end) in zip((result.driver_pattern, result.driven_pattern), limits, strict=True):
        low, high = pattern.roll_edges[:-1], pattern.roll_edges[1:]
        np.testing.assert_array_equal(pattern.share[:, :, (low > start) & (high < end)], 1.0)
        np.testing.assert_array_equal(pattern.share[:, :, (high < start) | (low > end)], 0.0)


def test_pairs_as_near_as_the_largest_tolerance_count_as_touching(own, mate):
    """A tooth worn evenly by 8 µm stands so far off while its neighbour carries as well: within 10 µm, and not within 7."""
    worn = wear(own, 0.008, [3])
    near, far = (
        mesh_contact(worn, mate, C, tolerances=(0.001, least)).driver_pattern.count.sum(axis=(1, 2)) for least in (0.010, 0.007)
    )
    assert near[3] > 0.9 * near[9]
    assert far[3] < 0.7 * far[9]


def test_the_pair_that_carries_has_no_gap_and_pairs_are_counted(rough_contact):
    result = rough_contact
    np.testing.assert_array_equal(result.pair_gap.min(axis=1), 0.0)
    first = result.pair_gap.argmin(axis=1)
    at = np.arange(len(first))
    np.testing.assert_array_equal(result.pair_driver_tooth[at, first], result.driver_tooth)
    np.testing.assert_array_equal(result.pair_driven_tooth[at, first], result.driven_tooth)
    assert ((result.pair_gap == 0.0).sum(axis=1) == 1).all()


def test_some_pair_is_always_in_contact(rough_contact):
    ratios = [ratio for _, ratio in rough_contact.contact_ratio]
    assert ratios[0] >= 1.0 and ratios == sorted(ratios)


def test_blocks_of_passes_do_not_show(own, mate, monkeypatch):
    one, two = rough(own, 6), rough(mate, 7)
    whole = mesh_contact(one, two, C, positions_per_pitch=5)
    monkeypatch.setattr("gearwear.meshing.passes._BLOCK_BYTES", 1.0)
    pieces = mesh_contact(one, two, C, positions_per_pitch=5)
    np.testing.assert_array_equal(pieces.transmission_error, whole.transmission_error)
    np.testing.assert_array_equal(pieces.driver_pattern.count, whole.driver_pattern.count)
    assert pieces.contact_ratio == whole.contact_ratio
    for name in ("transmission_error_min", "transmission_error_max", "backlash_min", "backlash_max"):
        assert getattr(pieces, name) == getattr(whole, name)  # searched for one by one, and side by side


def off_axis(profiles, size, direction=0.7):
    """Every flank moved by a translation: δ = e · n, n = s (−sin τ, cos τ), τ = θ_k + s (ψ_b − L / r_b)."""
    gear, half_angle = profiles.gear, profiles.half_angle.copy()
    for tooth in range(gear.teeth):
        for half, s in enumerate((1, -1)):
            tau = tooth * gear.pitch_angle + s * (gear.base_half_angle - roll_of(profiles) / gear.base_radius)
            half_angle[tooth, half] += size * s * np.sin(direction - tau) / gear.base_radius
    return replace(profiles, half_angle=half_angle)


def test_a_coat_in_a_variant_takes_play_and_adds_no_error(own, mate):
    thickness = 0.025
    coated = wear(wear(own, -thickness, range(12)), -thickness, range(12), side=1)
    (found,) = mesh_contact(own, mate, C, variants=[(coated, mate)]).variants
    np.testing.assert_allclose(found.backlash, -2.0 * thickness, atol=0.01 * thickness)
    assert found.peak_to_peak_um < 0.01 * 1e3 * thickness


@pytest.mark.parametrize("side", list(Side))
def test_a_variant_off_its_axis_runs_out_by_twice_that(own, mate, side):
    pairs = [(off_axis(own, 0.05), mate), (own, off_axis(mate, 0.05))]
    pinion, gear = mesh_contact(own, mate, C, side, cycle="hunting", variants=pairs).variants
    assert pinion.peak_to_peak_um == pytest.approx(100.0, rel=0.01)
    assert gear.peak_to_peak_um == pytest.approx(100.0, rel=0.01)


@pytest.mark.parametrize(("size", "depth"), [pytest.param(0.01, 0.1, marks=pytest.mark.long), (0.04, 1.0)])
def test_a_variant_is_near_contact_worked_out_anew(own, mate, size, depth):
    """On flanks that sliding took far off the involute, so that tip corners carry at each hand-over."""
    worn = wear(own, lambda roll: depth * sliding_like(roll), range(12))
    other = off_axis(worn, size)
    (found,) = mesh_contact(worn, mate, C, variants=[(other, mate)]).variants
    exact = mesh_contact(other, mate, C)
    for curve, anew in ((found.transmission_error, exact.transmission_error), (found.backlash, exact.backlash)):
        off = np.abs(curve[: len(anew)] - anew)
        assert off.mean() < 0.01 * size
        assert off.max() < 0.02 * size


def test_variants_know_of_the_extremes_between_the_positions(own, mate):
    """One tooth worn by 0.28 mm carries only between two positions of many: the same wear 4 µm deeper lags 4 µm more at most."""
    worn, deeper = (wear(own, depth, [3]) for depth in (0.28, 0.284))
    result, anew = (mesh_contact(one, mate, C, variants=[(deeper, mate)]) for one in (worn, deeper))
    assert result.itself.peak_to_peak_um == pytest.approx(result.peak_to_peak_um, abs=1e-4)
    grown = result.variants[0].peak_to_peak_um - result.itself.peak_to_peak_um
    assert grown == pytest.approx(4.0, abs=0.2)
    assert anew.peak_to_peak_um - result.peak_to_peak_um == pytest.approx(4.0, abs=0.2)
    rotation, error, backlash = result.curves
    assert (np.diff(rotation) >= 0.0).all()
    assert error.min() == pytest.approx(result.transmission_error_min.value, abs=1e-9)
    assert backlash.max() == pytest.approx(result.backlash_max.value, abs=1e-9)


def test_a_variant_does_not_touch_the_result(own, mate):
    worn = rough(own, 4)
    alone, beside = (mesh_contact(worn, mate, C, positions_per_pitch=5, variants=more) for more in ((), [(worn, mate)]))
    np.testing.assert_array_equal(beside.transmission_error, alone.transmission_error)
    np.testing.assert_array_equal(beside.variants[0].transmission_error, alone.itself.transmission_error)
    np.testing.assert_array_equal(beside.variants[0].backlash, alone.itself.backlash)
    with pytest.raises(InputError, match="a variant has other radii or heights"):
        mesh_contact(own, mate, C, variants=[(design(own.gear, radii=50), mate)])


def test_contact_ratio_of_perfect_flanks_is_that_of_the_path(pinion, wheel, own, mate):
    path = path_of_contact(pinion, wheel, C)
    result = mesh_contact(own, mate, C, positions_per_pitch=34, cycle="pitch")
    assert result.contact_ratio[0][1] > path.contact_ratio + 0.03, "a tolerance counts pairs that have parted"
    assert result.contact_ratio_on(path) == path.contact_ratio
    worn = mesh_contact(wear(own, sliding_like, range(12)), mate, C, positions_per_pitch=34, cycle="pitch")
    assert worn.contact_ratio_on(path) == worn.contact_ratio[0][1] < path.contact_ratio


def named_distance(doubt):
    return float(re.search(r"at (?:least|most) ([0-9.]+) mm would be right", doubt)[1])


@pytest.mark.parametrize("worn", [0.0, 0.002])
def test_teeth_that_overlap_are_told_with_the_distance_at_which_they_do_not(own, mate, worn):
    """The overlap told is the design's negative backlash less the wear, and there is none at the distance told, however little closer there is."""
    driver, closer = wear(own, worn, range(12)), C - 0.01
    found = mesh_contact(driver, mate, closer, cycle="pitch")
    least = normal_backlash(own.gear, mate.gear, closer) + worn
    assert f"the teeth overlap by {-least:.4f} mm (normal backlash) at a centre distance of {closer:g} mm" in found.doubt
    assert ("doubt", found.doubt[0].upper() + found.doubt[1:] + ".") in found.rows()
    room = named_distance(found.doubt)
    assert room == pytest.approx(
        centre_distance_for_backlash(own.gear, mate.gear, 0.0, "normal", worn / math.cos(own.gear.transverse_pressure_angle)),
        abs=1e-4,
    )
    assert mesh_contact(driver, mate, room, cycle="pitch").doubt == ""
    assert mesh_contact(driver, mate, room - 2e-4, cycle="pitch").doubt != ""


def test_a_ring_without_room_is_told_to_come_closer():
    """Inside a ring backlash falls as the shafts part."""
    parts = GearSpec("pinion", 20, 3.0, 20.0, addendum=0.8), GearSpec("gear", 60, 3.0, 20.0, addendum=0.8, internal=True)
    pinion, ring = (nominal_profiles(Gear.from_spec(spec)) for spec in parts)
    doubt = mesh_contact(pinion, ring, 60.02, cycle="pitch").doubt
    assert "at most 60.0000 mm would be right" in doubt
    assert mesh_contact(pinion, ring, named_distance(doubt), cycle="pitch").doubt == ""


def test_bad_input_is_named(own, mate, wheel):
    gap = own.half_angle.copy()
    gap[3, 0, 0, 7:9] = np.nan
    with pytest.raises(InputError, match="driver: 2 half angles are not finite"):
        mesh_contact(replace(own, half_angle=gap), mate, C)
    with pytest.raises(InputError, match=r"centre distance 112 mm: tips meet roots; it must be above 112\.7125 mm"):
        mesh_contact(own, mate, 112.0)
    with pytest.raises(InputError, match="no tooth reaches the mate"):
        mesh_contact(own, mate, 126.9)
    with pytest.raises(InputError, match="driven gear: radius must rise"):
        mesh_contact(own, replace(mate, radius=mate.radius[::-1]), C)
    other = Gear.from_spec(GearSpec("gear", 24, 6.0, 15.0))
    with pytest.raises(InputError, match="base pitches"):
        mesh_contact(own, design(other), C)


def test_every_tooth_of_the_driven_gear_passes_in_a_revolution_of_its_own(own, mate):
    """In one of the pinion half of the 24 do: a worn tooth among the others is then not seen."""
    least = {
        cycle: [
            mesh_contact(own, wear(mate, 0.1, [tooth]), C, cycle=cycle).transmission_error_min.value for tooth in (2, 8, 14, 20)
        ]
        for cycle in ("driven", "revolution")
    }
    assert least["driven"] == pytest.approx([-0.1] * 4, abs=EXACT)
    assert sorted(least["revolution"]) == pytest.approx([-0.1, -0.1, 0.0, 0.0], abs=EXACT)


def test_pairs_are_counted_between_positions_too():
    """A pair that comes up by 10 µm from one position to the next is within 1 µm for the last tenth of the way: 1.1 pairs to 1/32."""
    advance = np.array([[0.0, -0.010], [0.0, 0.0]])
    assert _contact_ratio(advance, 10, 0.001) == pytest.approx(1.1, abs=1.0 / 32.0)
