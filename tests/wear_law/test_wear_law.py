"""The wear law against its table, its own data, its claimed intervals, and exact contact."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.path import path_of_contact
from gearwear.wear_law.archard import LoadSharing, load_share
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.forecast import cycles_left, forecast_wear
from tests.meshing.worn import design, roll_of, wear
from tests.wear_law.per_cycle import wear_per_cycle

C = 114.3
ROLL = np.linspace(3.06, 26.34, 90)
TRUE = np.array([0.008, 0.004, 0.003])  # mm


def law(pinion, wheel, coefficients, sharing, roll=ROLL):
    """Depth by the formula as the reference writes it: K = 1 − L2/(2 L1), single contact from 7.598 to 21.803 mm."""
    slide = np.abs(1.0 - (39.0929018 - roll) / (2.0 * roll))
    single = (roll > 7.598) & (roll < 21.803)
    share = {"none": 1.0, "halves": np.where(single, 1.0, 0.5)}[sharing]
    return coefficients[0] * share * slide + coefficients[1] + coefficients[2] * single


def test_depth_per_cycle_is_the_table_of_w_times_K(pinion, wheel):
    own = np.array([3.06, 5.0, 7.6, 10.0, 13.03, 16.0, 19.0, 21.8, 24.0, 26.3])
    table = [(489, 83), (241, 71), (107, 52), (45, 31), (0, 0), (28, 39), (47, 89), (60, 152), (69, 218), (76, 311)]
    one = wear_per_cycle(pinion, wheel, C, own, 1.0, 100.0)
    two = wear_per_cycle(wheel, pinion, C, C * np.sin(np.radians(20.0)) - own, 1.0, 100.0)
    np.testing.assert_allclose(np.column_stack([one, two]), table, atol=0.51)


def test_one_depth_in_numbers(pinion, wheel):
    """k = 1e-16 m²/N and 100 N/mm take 0.049 mm in a million cycles off the start of the pinion's active flank."""
    assert 1e6 * wear_per_cycle(pinion, wheel, C, np.array([3.06]), 1e-10, 100.0)[0] == pytest.approx(0.049, abs=5e-4)


@pytest.mark.parametrize("sharing", [LoadSharing.HALVES, LoadSharing.THIRDS])
def test_pairs_in_contact_share_the_whole_load(pinion, wheel, sharing):
    path = path_of_contact(pinion, wheel, C)
    first = np.linspace(path.start_pinion + 1e-6, path.start_pinion + path.base_pitch - 1e-6, 400)
    shares = [load_share(pinion, wheel, C, first + j * path.base_pitch, sharing) for j in range(2)]
    np.testing.assert_allclose(sum(shares), 1.0, atol=1e-12)
    low, high = path.single_contact_pinion
    assert (low, high) == (pytest.approx(7.598, abs=5e-4), pytest.approx(21.803, abs=5e-4))
    inside = load_share(pinion, wheel, C, np.array([low + 1e-6, high - 1e-6]), sharing)
    np.testing.assert_array_equal(inside, 1.0)


def test_thirds_run_from_one_third_to_two_thirds(pinion, wheel):
    path = path_of_contact(pinion, wheel, C)
    low, high = path.single_contact_pinion
    ends = np.array([path.start_pinion, path.end_pinion, low - 1e-9, high + 1e-9])
    np.testing.assert_allclose(load_share(pinion, wheel, C, ends, LoadSharing.THIRDS), [1 / 3, 1 / 3, 2 / 3, 2 / 3], atol=1e-8)
    assert (load_share(pinion, wheel, C, np.array([3.0, 26.4]), LoadSharing.THIRDS) == 0.0).all()


@pytest.mark.parametrize("sharing", ["none", "halves"])
@pytest.mark.parametrize("true", [TRUE, TRUE * [1, 0, 0], TRUE * [0, 1, 0], TRUE * [1, 0, 1]])
def test_its_own_profile_gives_the_coefficients_back(pinion, wheel, sharing, true):
    fits = fit_wear_law(pinion, wheel, C, ROLL, law(pinion, wheel, true, sharing), np.full(90, 1e-3))
    right = next(fit for fit in fits if fit.sharing == sharing)
    np.testing.assert_allclose(right.coefficients, true, atol=1e-8)  # 20° and C to nine digits
    np.testing.assert_allclose(right.fitted, right.depth, atol=1e-8)
    assert right.explained[0] == pytest.approx(1.0, abs=1e-3)  # a micrometre of errors is taken off a square of some hundred
    assert right.unexplained_depth < 1e-6
    assert sum(value for value, _ in right.parts.values()) == pytest.approx(1.0)
    if true[0] and true[1]:
        assert fits[0].sharing == sharing
        assert right.explained_variation[0] == pytest.approx(1.0, abs=1e-3)


def test_no_term_is_ever_negative(pinion, wheel):
    """More at the pitch line and less at the ends than none: the opposite of sliding wear."""
    fit = fit_wear_law(pinion, wheel, C, ROLL, 0.02 - law(pinion, wheel, TRUE * [1, 0, 0], "none"), np.full(90, 1e-3))[0]
    assert (fit.coefficients >= 0.0).all()
    assert (fit.interval() >= 0.0).all()


def test_the_wheels_flank_is_fitted_alike(pinion, wheel):
    roll = np.linspace(12.8, 36.0, 80)
    depth = wear_per_cycle(wheel, pinion, C, roll, 1e-10, 100.0, LoadSharing.THIRDS) * 1e6 + 0.002
    fit = fit_wear_law(wheel, pinion, C, roll, depth, np.full(80, 1e-4))[0]
    assert fit.sharing is LoadSharing.THIRDS
    np.testing.assert_allclose(fit.coefficients, [0.01, 0.002, 0.0], atol=1e-12)
    assert fit.wear_coefficient(1e6, 100.0)[0] == pytest.approx(1e-10)


@pytest.mark.parametrize("correlation", [0.0, pytest.param(3.0, marks=pytest.mark.long)])
def test_intervals_cover_the_truth_as_often_as_they_say(pinion, wheel, correlation):
    random, sd, runs = np.random.default_rng(5), 0.002, 400
    clean = law(pinion, wheel, TRUE * [2.0, 2.0, 2.0], "none")
    like = np.eye(90) if correlation == 0.0 else np.exp(-np.abs(ROLL[:, None] - ROLL) / correlation)
    factor = sd * np.linalg.cholesky(like)
    hits = np.zeros(3)
    for _ in range(runs):
        depth = clean + factor @ random.normal(size=90)
        fit = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, sd), LoadSharing.NONE, correlation)[0]
        low, high = fit.interval(0.9).T
        hits += (low <= 2.0 * TRUE) & (high >= 2.0 * TRUE)
    # Three standard errors of a binomial; χ² above 1, half the time, widens them to 92 % at most.
    assert (hits / runs > 0.9 - 3 * np.sqrt(0.09 / runs)).all()
    assert (hits / runs < 0.92 + 3 * np.sqrt(0.0736 / runs)).all()


@pytest.mark.parametrize("absent", [pytest.param(0, marks=pytest.mark.long), pytest.param(1, marks=pytest.mark.long), 2])
def test_intervals_are_rather_wide_where_a_term_is_absent(pinion, wheel, absent):
    random, runs = np.random.default_rng(6), 300
    true = np.where(np.arange(3) == absent, 0.0, 2.0 * TRUE)
    hits = np.zeros(3)
    for _ in range(runs):
        depth = law(pinion, wheel, true, "none") + 0.002 * random.normal(size=90)
        low, high = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 0.002), LoadSharing.NONE)[0].interval(0.9).T
        hits += (low <= true) & (high >= true)
    assert (hits / runs > 0.9 - 3 * np.sqrt(0.09 / runs)).all()


def test_texture_taken_for_noise_claims_too_much(pinion, wheel):
    depth = law(pinion, wheel, TRUE, "none")
    alone, alike = (fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 0.002), None, length)[0] for length in (0.0, 3.0))
    assert alike.covariance[1, 1] > 4.0 * alone.covariance[1, 1]


def test_points_off_the_path_and_holes_are_left_out(pinion, wheel):
    roll = np.linspace(0.0, 30.0, 200)
    depth = law(pinion, wheel, TRUE, "none", np.maximum(roll, 1e-3))
    depth[(roll < 3.0) | (roll > 26.4)] = 5.0
    depth[100:110] = np.nan
    fit = fit_wear_law(pinion, wheel, C, roll, depth, np.full(200, 1e-3), LoadSharing.NONE)[0]
    np.testing.assert_allclose(fit.coefficients, TRUE, atol=1e-8)


def test_words_name_no_mechanism_and_warn_of_depth(pinion, wheel):
    shallow = fit_wear_law(pinion, wheel, C, ROLL, 0.1 * law(pinion, wheel, TRUE, "none"), np.full(90, 1e-4))[0]
    deep = fit_wear_law(pinion, wheel, C, ROLL, 100.0 * law(pinion, wheel, TRUE, "none"), np.full(90, 1e-2))[0]
    assert "consistent with sliding wear" in shallow.words and "mild wear" not in shallow.words
    assert "mild wear" in deep.words


def fitted(pinion, wheel, noise=0.0):
    depth = law(pinion, wheel, TRUE, "none") + noise * np.random.default_rng(1).normal(size=90)
    return fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, max(noise, 1e-4)), LoadSharing.NONE)[0]


def test_forecast_starts_at_the_measured_and_grows_at_the_fitted_rate(pinion, wheel):
    fit = fitted(pinion, wheel)
    found = forecast_wear(fit, 1e6, np.array([1e6, 2e6, 5e6]))
    away = np.min(np.abs(found.roll[:, None] - [7.598, 21.803]), axis=1) > 1e-3
    expected = np.outer([1, 2, 5], law(pinion, wheel, TRUE, "none", found.roll))
    np.testing.assert_allclose(found.depth.value[:, away], expected[:, away], atol=2e-7)
    # Now it is known a little better than a point of it: the law and its neighbours say something too.
    band = found.depth.high[0] - found.depth.value[0]
    assert (band < 1.959964 * 1e-4).all() and (band > 0.15 * 1.959964 * 1e-4).all()
    # At the operating pitch point there is no sliding: what is uniform and the step are left.
    expected = np.array([1, 2, 5]) * (TRUE[1] + TRUE[2]) / np.cos(np.radians(20.0))
    np.testing.assert_allclose(found.thickness_loss.value, expected, rtol=0.002)  # interpolated over the kink at K = 0


def test_forecast_never_falls_and_its_band_never_narrows(pinion, wheel):
    found = forecast_wear(fitted(pinion, wheel, 0.003), 1e6, np.linspace(1e6, 2e7, 40))
    for band in (found.depth, found.greatest_depth, found.thickness_loss, found.backlash_increase):
        for values in (band.low, band.value, band.high):
            assert (np.diff(values, axis=0) >= 0.0).all()
        assert (np.diff(band.high - band.low, axis=0) >= -1e-15).all()
        assert (band.low <= band.value).all() and (band.value <= band.high).all()


@pytest.mark.long
def test_forecast_backlash_comes_to_what_exact_contact_finds_and_is_never_less(pinion, wheel):
    """All teeth worn by the forecast profile, run in rigid contact; corners that carry fade with the depth."""
    short = []
    for factor in (0.1, 0.01, 0.001):
        depth = law(pinion, wheel, factor * TRUE * [1, 1, 0], "none")
        fit = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 1e-4), LoadSharing.NONE)[0]
        expected = float(forecast_wear(fit, 1e6, np.array([1e6])).backlash_increase.value[0])
        own = design(pinion, 400)
        worn = wear(own, np.interp(roll_of(own), fit.roll, fit.depth), range(12))
        exact = mesh_contact(worn, design(wheel), C).backlash_max.value
        short.append(1.0 - exact / expected)
    assert all(0.0 <= part < 0.05 for part in short)
    assert short == sorted(short, reverse=True) and short[-1] < 0.002


@pytest.mark.parametrize(("quantity", "limit"), [("depth", 0.2), ("thickness", 0.05), ("backlash", 0.06)])
def test_cycles_left_end_at_the_limit(pinion, wheel, quantity, limit):
    fit = fitted(pinion, wheel, 0.001)
    left = cycles_left(fit, 1e6, limit, quantity)
    assert 0.0 < left.low < left.value < left.high
    found = forecast_wear(fit, 1e6, 1e6 + np.array([left.low, left.value]))
    band = {"depth": found.greatest_depth, "thickness": found.thickness_loss, "backlash": found.backlash_increase}[quantity]
    assert band.value[1] == pytest.approx(limit, rel=1e-9)
    assert band.high[0] == pytest.approx(limit, rel=1e-9)


def test_a_limit_passed_and_a_limit_never_reached(pinion, wheel):
    fit = fitted(pinion, wheel)
    assert cycles_left(fit, 1e6, 0.001, "depth").value == 0.0
    none = replace(fit, coefficients=np.zeros(3), covariance=np.zeros((3, 3)))
    assert cycles_left(none, 1e6, 1.0, "depth").value == np.inf


def test_bad_input_is_named(pinion, wheel):
    with pytest.raises(InputError, match="3 points on the path of contact"):
        fit_wear_law(pinion, wheel, C, ROLL[:3], ROLL[:3], ROLL[:3])
    with pytest.raises(InputError, match="standard deviations must be above 0"):
        fit_wear_law(pinion, wheel, C, ROLL, 0.01 * ROLL, np.zeros(90))
    fit = fitted(pinion, wheel)
    with pytest.raises(InputError, match="cycles_run = 0"):
        forecast_wear(fit, 0.0, np.array([1.0]))
    with pytest.raises(InputError, match="cycles 5: must not be below the cycles run, 10"):
        forecast_wear(fit, 10.0, np.array([5.0]))
    with pytest.raises(InputError, match="limit = 0"):
        cycles_left(fit, 10.0, 0.0, "depth")
    with pytest.raises(InputError, match=r"radius 35\.8\d* mm"):
        cycles_left(fit, 10.0, 0.1, "thickness", radius=35.81)
    fine = [
        Gear.from_spec(GearSpec(n, 60, 2.0, 10.0, addendum=1.3, dedendum=1.55, rack_tip_radius=0.2)) for n in ("pinion", "gear")
    ]
    with pytest.raises(InputError, match=r"contact ratio 2\.\d+: load sharing is modelled below 2 only"):
        load_share(*fine, 120.0, np.array([20.0]), LoadSharing.HALVES)
