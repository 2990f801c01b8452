"""Fit and forecast of the wear law as a statistician would try them: what is put in is asked back, with the certainty claimed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import stdtrit

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.path import path_of_contact, sliding
from gearwear.wear_law.archard import LoadSharing
from gearwear.wear_law.fit import _covariances, alike_fits, fit_wear_law
from gearwear.wear_law.forecast import cycles_left, forecast_wear
from gearwear.wear_law.non_negative import _greater
from gearwear.wear_law.running import forecast_by_running
from gearwear.wear_law.study import Ahead, WearStudy, _forecast
from tests.meshing.worn import design, roll_of, wear
from tests.wear_law.per_cycle import wear_per_cycle

C = 114.3
LINE = 39.09290238
ROLL = np.linspace(3.06, 26.34, 90)
A, B, STEP = TRUE = (0.008, 0.004, 0.003)  # mm


def law(roll, a=A, b=B, step=STEP, sharing="none"):
    """By the formula of the reference: K = 1 − L2 / (2 L1), single contact from 7.598 to 21.803 mm."""
    single = (roll > 7.598) & (roll < 21.803)
    share = 1.0 if sharing == "none" else np.where(single, 1.0, 0.5)
    return a * share * np.abs(1.0 - (LINE - roll) / (2.0 * roll)) + b + step * single


def alike(length):
    return np.exp(-np.abs(ROLL[:, None] - ROLL) / length)


def test_mean_pressure_times_distance_slid_is_load_times_specific_sliding(pinion, wheel):
    """Hertz on the equivalent cylinder, steel, 100 N/mm: the width cancels (reference D3)."""
    w, modulus = 100.0, 206_000.0 / (2.0 * (1.0 - 0.3**2))
    moving = sliding(pinion, wheel, C, ROLL)
    radius = moving.equivalent_radius
    half_width, pressure = np.sqrt(4.0 * w * radius / (math.pi * modulus)), np.sqrt(w * modulus / (math.pi * radius))
    own, other = ROLL, (LINE - ROLL) / 2.0  # rolling velocities at 1 rad/s of the pinion, which turns twice as fast
    for gear, mate, first, second, roll in ((pinion, wheel, own, other, ROLL), (wheel, pinion, other, own, LINE - ROLL)):
        slid = 2.0 * half_width * np.abs(1.0 - second / first)
        np.testing.assert_allclose(
            wear_per_cycle(gear, mate, C, roll, 1e-10, w), 1e-10 * 0.25 * math.pi * pressure * slid, rtol=1e-6, atol=1e-15
        )


@pytest.mark.parametrize("places", [14, 25])
def test_means_over_cells_give_the_law_of_the_points(pinion, wheel, places):
    """Cells of equal arc, coarse as those of a small scan: K doubles in the first, and a border lies within another."""
    edges = np.sqrt(np.linspace(3.06**2, 26.34**2, places + 1))
    fine = np.sqrt(np.linspace(edges[:-1] ** 2, edges[1:] ** 2, 2001)[:-1] + 0.0)
    depth = law(fine).mean(axis=0)
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    errors = np.full(places, 1e-4)
    wide = fit_wear_law(pinion, wheel, C, middle, depth, errors, LoadSharing.NONE, width=width)[0]
    point = fit_wear_law(pinion, wheel, C, middle, depth, errors, LoadSharing.NONE)[0]
    assert np.abs(wide.coefficients - TRUE).max() < 0.2e-3  # an eighth of a cell at the borders
    assert np.abs(wide.fitted - depth).max() < 0.5 * np.abs(point.fitted - depth).max()


@pytest.mark.parametrize("length", [pytest.param(0.0, marks=pytest.mark.long), 1.5])
def test_one_profile_without_errors_says_how_sure_it_is_by_what_it_leaves(pinion, wheel, length):
    random, sd, runs = np.random.default_rng(8), 0.0007, 300
    factor = np.linalg.cholesky(np.eye(90) if length == 0.0 else alike(length))
    hits = np.zeros(3)
    for _ in range(runs):
        depth = law(ROLL) + sd * factor @ random.normal(size=90)
        fit = fit_wear_law(pinion, wheel, C, ROLL, depth, sharing=LoadSharing.NONE, correlation_length=length)[0]
        low, high = fit.interval(0.9).T
        hits += (low <= TRUE) & (high >= TRUE)
        assert not fit.known
    assert (np.abs(hits / runs - 0.9) < 3 * np.sqrt(0.09 / runs)).all()


@pytest.mark.parametrize("teeth", [3, 12])
def test_teeth_worn_unlike_count_as_such(pinion, wheel, teeth):
    """Teeth that differ by 10 % and textured errors nobody told of: the intervals hold the law behind the teeth all the same."""
    random, runs = np.random.default_rng(9), 300
    factor = 0.002 * np.linalg.cholesky(alike(2.0))
    hits = np.zeros(3)
    for _ in range(runs):
        own = 1.0 + 0.1 * random.normal(size=(teeth, 1))
        depth = own * law(ROLL) + (factor @ random.normal(size=(90, teeth))).T
        fit = fit_wear_law(pinion, wheel, C, ROLL, depth, sharing=LoadSharing.NONE)[0]
        low, high = fit.interval(0.9).T
        hits += (low <= TRUE) & (high >= TRUE)
    assert (hits / runs > 0.9 - 3 * np.sqrt(0.09 / runs)).all()
    assert (hits / runs < 0.985).all()


def test_errors_told_as_covariance_are_those_of_length_and_deviation(pinion, wheel):
    depth = law(ROLL) + 0.001 * np.random.default_rng(2).normal(size=90)
    told = fit_wear_law(pinion, wheel, C, ROLL, depth, 0.001**2 * alike(2.0), LoadSharing.NONE)[0]
    same = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 0.001), LoadSharing.NONE, 2.0)[0]
    np.testing.assert_allclose(told.covariance, same.covariance)
    np.testing.assert_allclose(told.coefficients, same.coefficients)


def test_errors_told_too_small_are_as_large_as_what_is_left_says(pinion, wheel):
    """Then only their shape counts, whatever size was told; errors told larger than the scatter stay as they were told."""
    depth = law(ROLL) + 0.002 * np.random.default_rng(3).normal(size=90)
    stds = {}
    for told in (0.0002, 0.0004, 0.02, 0.04):
        stds[told] = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, told), LoadSharing.NONE)[0].coefficient_stds
    np.testing.assert_allclose(stds[0.0002], stds[0.0004])
    np.testing.assert_allclose(2.0 * stds[0.02], stds[0.04])


def test_a_variance_of_few_teeth_beside_a_known_one_has_the_freedom_of_satterthwaite():
    """ν_eff = (Σ s²)² / (Σ s⁴ / ν): the greater variance of a direction is the scatter's, with its ν = 5, or known, with infinitely many."""
    whole, freedom = _greater(np.eye(2), np.diag([4.0, 0.5]), 5)
    np.testing.assert_allclose(whole, np.diag([4.0, 1.0]))
    assert freedom[0] == pytest.approx(5.0) and freedom[1] > 1e6
    turned = np.array([[0.6, -0.8], [0.8, 0.6]])
    whole, freedom = _greater(np.eye(2), turned @ np.diag([4.0, 0.5]) @ turned.T, 5)
    np.testing.assert_allclose(whole, turned @ np.diag([4.0, 1.0]) @ turned.T)
    scattered = 4.0 * np.array([0.6**2, 0.8**2])  # of which the rest of either variance is known
    np.testing.assert_allclose(freedom, 5.0 * (np.diag(whole) / scattered) ** 2)


@pytest.mark.parametrize("more", [1.0, 4.0])
def test_intervals_hold_the_truth_where_few_teeth_scatter_about_as_much_as_points_err(more):
    """The mean of four teeth errs by 1 for its points and by √`more` for what teeth are unlike: by 3 / share² degrees of freedom of what the scatter
    adds to the errors 95 % intervals held 91.9 and 90.1 %. That the greater of two is taken costs half a percent, with three teeth two."""
    rng, draws = np.random.default_rng(2), 4000
    teeth = rng.normal(0.0, 2.0 * math.sqrt(1.0 + more), (draws, 4))
    held = 0
    for each in teeth:
        whole, freedom = _greater(np.eye(1), np.atleast_2d(each.var(ddof=1) / 4.0), 3)
        held += abs(each.mean()) <= stdtrit(min(freedom[0], 1e6), 0.975) * math.sqrt(whole[0, 0])
    assert held / draws > 0.95 - 0.01 - 3.0 * math.sqrt(0.95 * 0.05 / draws)


def test_the_variance_of_a_sum_of_squares_of_noise_is_that_of_chi_square():
    """2 n of n standard normal ones; of two forms that share none of them the covariance is 0."""
    first, second = np.diag([1.0, 1.0, 1.0, 0.0, 0.0]), np.diag([0.0, 0.0, 0.0, 1.0, 1.0])
    np.testing.assert_allclose(_covariances([first, second], np.zeros(5), np.eye(5)), [[6.0, 0.0], [0.0, 4.0]])


@pytest.mark.parametrize(("best", "limit"), [(60.0, 4.0), (174.0, 8.0)])
def test_models_that_cannot_be_told_apart_differ_by_less_than_four(pinion, wheel, best, limit):
    """e² times as likely is Δχ² = 4; where the best leaves twice what its 87 degrees of freedom allow, twice as much."""
    fit = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4), LoadSharing.NONE)[0]
    assert fit.degrees_of_freedom == 87
    fits = [replace(fit, chi_square=best + more) for more in (0.0, 0.98 * limit, 1.02 * limit)]
    assert alike_fits(fits) == tuple(fits[:2])


def test_what_is_worn_off_the_path_of_contact_is_not_the_laws(pinion, wheel):
    """The outer 2.39 mm of roll of the wheel meet no involute of the undercut pinion."""
    path = path_of_contact(wheel, pinion, C)
    roll = np.linspace(wheel.form_roll, wheel.tip_roll, 150)
    off = (roll < path.start_pinion) | (roll > path.end_pinion)
    assert wheel.tip_roll - path.end_pinion > 2.0
    depth = np.where(off, 0.5, 0.006 * np.abs(1.0 - 2.0 * (LINE - roll) / roll) + 0.002)
    fit = fit_wear_law(wheel, pinion, C, roll, depth, np.full(150, 1e-4), LoadSharing.NONE)[0]
    np.testing.assert_allclose(fit.coefficients, [0.006, 0.002, 0.0], atol=1e-8)
    assert path.start_pinion <= fit.roll[0] and fit.roll[-1] <= path.end_pinion
    assert (wear_per_cycle(wheel, pinion, C, np.array([path.end_pinion + 0.1]), 1e-10, 100.0) == 0.0).all()


class TestExplained:
    def test_it_is_the_share_without_the_errors(self, pinion, wheel):
        """A wave the law cannot follow, with errors as large: the plain share would put them on the law's account."""
        random, runs, sd, wave = np.random.default_rng(4), 200, 0.002, 0.003 * np.sin(2.0 * np.pi * ROLL / 2.7)
        clean = law(ROLL)
        weight = np.gradient(ROLL)
        true = 1.0 - (weight @ wave**2) / (weight @ (clean + wave) ** 2)
        values = []
        hits = 0
        for _ in range(runs):
            depth = clean + wave + sd * random.normal(size=90)
            fit = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, sd), LoadSharing.NONE)[0]
            share, std = fit.explained
            values.append(share)
            hits += abs(share - true) < 1.96 * std
        assert np.mean(values) == pytest.approx(true, abs=0.003)  # the wave lies a little way along the law's own terms
        assert 0.9 < hits / runs <= 1.0
        plain = 1.0 - np.sum((fit.depth - fit.fitted) ** 2) / np.sum(fit.depth**2)
        assert true - plain > 0.01
        assert fit.unexplained_depth == pytest.approx(0.003 / math.sqrt(2.0), rel=0.25)

    @pytest.mark.parametrize("share", [0.2, 0.45, 0.55, 0.9])
    def test_half_is_the_least_to_go_on_with(self, pinion, wheel, share):
        """Beside the law a wave on its profile, at right angles to all its terms: of the mean square the law has the share put in."""
        weight = np.gradient(ROLL)
        terms = np.column_stack([law(ROLL, *one, "none") for one in np.eye(3)])
        root = np.sqrt(weight)
        wave = np.sin(2.0 * np.pi * ROLL / 2.7)
        wave -= terms @ np.linalg.lstsq(root[:, None] * terms, root * wave)[0]
        wave *= math.sqrt((1.0 / share - 1.0) * (weight @ law(ROLL) ** 2) / (weight @ wave**2))
        fits = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL) + wave, np.full(90, 1e-6), LoadSharing.NONE)
        assert fits[0].explained[0] == pytest.approx(share, abs=0.02)
        study = _forecast(WearStudy(Side.LEFT, (0, 1, 2), (), fits, ""), Ahead(1e6, (2e6,)))
        assert (study.forecast is None) == ("half is the least to go on with" in study.why_not) == (share < 0.5)

    def test_a_right_law_explains_all(self, pinion, wheel):
        random, runs, sd = np.random.default_rng(5), 200, 0.002
        hits = 0
        for _ in range(runs):
            depth = law(ROLL) + sd * random.normal(size=90)
            share, std = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, sd), LoadSharing.NONE)[0].explained
            hits += abs(share - 1.0) < 1.96 * std
        assert hits / runs > 0.95 - 3 * np.sqrt(0.0475 / runs)

    def test_of_noise_there_is_nothing_to_explain(self, pinion, wheel):
        depth = 0.002 * np.random.default_rng(6).normal(size=90)
        fit = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 0.002))[0]
        assert math.isnan(fit.explained[0])
        assert "nothing for a law to explain" in fit.words

    def test_an_even_loss_has_no_shape_to_explain(self, pinion, wheel):
        depth = 0.01 + 0.001 * np.random.default_rng(7).normal(size=90)
        fit = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 0.001), LoadSharing.NONE)[0]
        assert fit.explained[0] == pytest.approx(1.0, abs=3.0 * fit.explained[1])
        assert math.isnan(fit.explained_variation[0])

    def test_parts_are_of_the_laws_depth(self, pinion, wheel):
        fit = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4), LoadSharing.NONE)[0]
        weight = np.gradient(ROLL)
        for name, alone in (("sliding", law(ROLL, b=0, step=0)), ("uniform", law(ROLL, 0, B, 0)), ("step", law(ROLL, 0, 0))):
            assert fit.parts[name][0] == pytest.approx(weight @ alone / (weight @ law(ROLL)), abs=1e-5)
        only = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL, b=0, step=0), np.full(90, 1e-4), LoadSharing.NONE)[0]
        assert only.parts["sliding"][0] == pytest.approx(1.0)


class TestForecast:
    @pytest.mark.long
    def test_its_band_holds_what_comes(self, pinion, wheel):
        """Wear that follows the law, seen with textured errors: three times the cycles lie in the 95 % band."""
        random, runs, sd = np.random.default_rng(10), 150, 0.0015
        factor = sd * np.linalg.cholesky(alike(1.5))
        path = path_of_contact(pinion, wheel, C)
        places = np.linspace(path.start_pinion + 1e-9, path.end_pinion - 1e-9, 3001)
        true = 3.0 * law(places)
        pitch = 3.0 * (B + STEP) / math.cos(math.radians(20.0))
        hits = np.zeros(2)
        for _ in range(runs):
            fits = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL) + factor @ random.normal(size=90), np.full(90, sd), None, 1.5)
            found = forecast_wear(fits, 1e6, np.array([3e6]))
            for i, (band, value) in enumerate(((found.greatest_depth, true.max()), (found.thickness_loss, pitch))):
                hits[i] += band.low[0] <= value <= band.high[0]
        assert (hits / runs > 0.95 - 3.0 * math.sqrt(0.0475 / runs)).all()

    def test_its_band_holds_whatever_wear_makes_of_load_sharing(self, pinion, wheel):
        """Pairs share the load by another rule from now on: the truth is the law with that rule, added to what is gone."""
        now = law(ROLL, b=0.0, step=0.0)
        fit = fit_wear_law(pinion, wheel, C, ROLL, now, np.full(90, 1e-4))[0]
        band = forecast_wear(fit, 1e6, np.array([3e6])).depth
        for share in (0.0, 0.2, 0.5, 1.0):
            path = path_of_contact(pinion, wheel, C)
            low, high = path.single_contact_pinion
            later = now + 2.0 * np.where((low < ROLL) & (high > ROLL), 1.0, share) * now
            forecast = [np.interp(ROLL, forecast_wear(fit, 1e6, np.array([3e6])).roll, row[0]) for row in (band.low, band.high)]
            inside = np.min(np.abs(ROLL[:, None] - [low, high]), axis=1) > 0.1
            assert ((forecast[0] <= later + 1e-6) & (later <= forecast[1] + 1e-6))[inside].all()

    def test_its_band_holds_the_models_that_fit_alike(self, pinion, wheel):
        roll = np.linspace(8.0, 21.0, 60)  # single contact only: load sharing shows nowhere
        fits = fit_wear_law(pinion, wheel, C, roll, law(roll, step=0.0), np.full(60, 1e-4))
        assert len(alike_fits(fits)) == 3
        found = forecast_wear(fits, 1e6, np.array([1e6, 4e6]))
        single = [forecast_wear(fit, 1e6, np.array([1e6, 4e6])) for fit in fits]
        assert found.models == 3
        np.testing.assert_allclose(found.greatest_depth.low, np.min([one.greatest_depth.low for one in single], axis=0))
        np.testing.assert_allclose(found.greatest_depth.high, np.max([one.greatest_depth.high for one in single], axis=0))
        value = [one.greatest_depth.value[1] for one in single]
        assert found.greatest_depth.low[1] < min(value) < max(value) < found.greatest_depth.high[1]
        left, alone = cycles_left(fits, 1e6, 0.15, "depth"), [cycles_left(fit, 1e6, 0.15, "depth") for fit in fits]
        assert (left.low, left.high) == (min(one.low for one in alone), max(one.high for one in alone))

    def test_models_that_fit_worse_are_not_in_it(self, pinion, wheel):
        fits = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL, step=0.0), np.full(90, 1e-4))
        assert [fit.sharing for fit in alike_fits(fits)] == [LoadSharing.NONE]

    def test_an_even_loss_adds_itself_to_the_normal_backlash(self, pinion, wheel):
        """Exactly: the same pair with the pinion cut thinner by as much."""
        fit = fit_wear_law(pinion, wheel, C, ROLL, np.full(90, 0.02), np.full(90, 1e-5))[0]
        found = forecast_wear(fit, 1e6, np.array([1e6, 5e6])).backlash_increase.value
        for grown, depth in zip(found, (0.02, 0.1), strict=True):
            thinner = Gear.from_spec(replace(pinion.spec, thinning=depth / math.cos(math.radians(20.0))))
            exact = exact_meshing(thinner, wheel, C).backlash.normal - exact_meshing(pinion, wheel, C).backlash.normal
            assert grown == pytest.approx(exact, abs=1e-6)

    def test_the_backlash_of_deep_sliding_wear_is_an_upper_bound(self, pinion, wheel):
        """75 µm at the start of the active profile, all teeth: corners carry past the ends of the path, and contact gives less."""
        own = design(pinion, 300)
        path = path_of_contact(pinion, wheel, C)
        roll = np.clip(roll_of(own), path.start_pinion, path.end_pinion)
        exact = mesh_contact(wear(own, law(roll, 0.0154, 0.0, 0.0), range(12)), design(wheel), C).backlash_max.value
        fit = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL, 0.0154, 0.0, 0.0), np.full(90, 1e-4))
        bound = forecast_wear(fit, 1e6, np.array([1e6])).backlash_increase.value[0]
        assert 0.8 < exact / bound < 1.0

    def test_it_reaches_to_the_start_of_the_active_profile(self, pinion, wheel):
        """Points begin well above it; the greatest depth is that of the law where sliding is greatest."""
        roll = ROLL[ROLL > 4.0]
        fit = fit_wear_law(pinion, wheel, C, roll, law(roll), np.full(len(roll), 1e-4), LoadSharing.NONE)[0]
        start = path_of_contact(pinion, wheel, C).start_pinion
        assert forecast_wear(fit, 1e6, np.array([1e6])).greatest_depth.value[0] == pytest.approx(law(start + 1e-9), rel=1e-3)

    def test_far_is_beyond_twice_the_cycles_run(self, pinion, wheel):
        fit = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4))[0]
        assert forecast_wear(fit, 1e6, np.array([1e6, 2e6, 2.1e6])).far.tolist() == [False, False, True]

    def test_no_wear_by_the_law_never_reaches_a_limit_but_may_by_its_upper_side(self, pinion, wheel):
        depth = np.maximum(0.0, 0.001 - law(ROLL, b=0, step=0))
        fit = fit_wear_law(pinion, wheel, C, ROLL, -depth, np.full(90, 1e-3))[0]
        assert (fit.coefficients == 0.0).all()
        left = cycles_left(fit, 1e6, 0.1, "depth")
        assert (left.value, left.high) == (math.inf, math.inf)
        assert 0.0 < left.low < math.inf

    def test_there_is_none_without_a_fit(self):
        with pytest.raises(InputError, match="there is no fit"):
            forecast_wear((), 1e6, np.array([2e6]))
        with pytest.raises(InputError, match="there is no fit"):
            cycles_left((), 1e6, 0.1, "depth")


def test_what_does_not_match_is_named(pinion, wheel):
    flat = np.full(90, 1e-3)
    with pytest.raises(InputError, match="must match"):
        fit_wear_law(pinion, wheel, C, ROLL, flat[:80], flat)
    with pytest.raises(InputError, match="must match"):
        fit_wear_law(pinion, wheel, C, ROLL, flat, flat[:80])
    with pytest.raises(InputError, match="positive definite"):
        fit_wear_law(pinion, wheel, C, ROLL, flat, np.ones((90, 90)))
    with pytest.raises(InputError, match="correlation_length = -1"):
        fit_wear_law(pinion, wheel, C, ROLL, flat, flat, correlation_length=-1.0)
    fit = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), flat)[0]
    with pytest.raises(InputError, match="quantity = 'width': one of depth, thickness, backlash"):
        cycles_left(fit, 1e6, 0.1, "width")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="limit = inf"):
        cycles_left(fit, 1e6, math.inf, "depth")
    with pytest.raises(InputError, match="cycles nan"):
        forecast_wear(fit, 1e6, np.array([math.nan]))
    with pytest.raises(InputError, match="load per face width 0"):
        fit.wear_coefficient(1e6, 0.0)


@pytest.mark.parametrize("confidence", [1.0, 1.0 - 1e-16, 0.0, -0.5, 2.0, math.nan])
def test_a_confidence_that_no_interval_has_is_refused(pinion, wheel, confidence):
    fits = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4))
    for ask in (
        lambda: forecast_wear(fits, 1e6, np.array([2e6]), confidence=confidence),
        lambda: forecast_by_running(fits[0], 1e6, np.array([2e6]), 100.0, confidence=confidence),
        lambda: cycles_left(fits, 1e6, 0.1, "depth", confidence=confidence),
        lambda: fits[0].interval(confidence),
    ):
        with pytest.raises(InputError, match="above 0 and below 1 would be right"):
            ask()


def test_results_show_themselves_in_few_lines(pinion, wheel):
    fits = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4))
    forecast = forecast_wear(fits, 1e6, np.linspace(1e6, 3e6, 30))
    left = cycles_left(fits, 1e6, 0.1, "depth")
    never = cycles_left(replace(fits[0], coefficients=np.zeros(3), covariance=np.zeros((3, 3))), 1e6, 1.0, "depth")
    assert "A 8.000 ± " in repr(fits[0]) and "B 4.000 ± " in repr(fits[0])
    assert "3e+06 cycles" not in repr(forecast) and "20 more" in repr(forecast)
    assert repr(left).endswith("more mesh cycles") and "no end" in repr(never)
    assert "reached already" in repr(cycles_left(fits, 1e6, 0.001, "depth"))
    for shown in map(repr, (*fits, forecast, left)):
        assert len(shown.splitlines()) < 14 and "array(" not in shown and max(map(len, shown.splitlines())) < 200


@pytest.mark.parametrize("sharing", [LoadSharing.NONE, LoadSharing.HALVES, LoadSharing.THIRDS])
def test_load_sharing_by_its_word_is_that_load_sharing(pinion, wheel, sharing):
    """Every word was fitted as thirds: A of a profile without sharing came out at twice what it is."""
    depth = wear_per_cycle(pinion, wheel, C, ROLL, 1e-10, 100.0, sharing) * 1e6 + B
    fit = fit_wear_law(pinion, wheel, C, ROLL, depth, np.full(90, 1e-4), sharing.value)[0]
    assert fit.sharing is sharing
    assert fit.coefficients == pytest.approx([0.01, B, 0.0], abs=1e-9)


@pytest.mark.parametrize("word", ["thirds of it", LoadSharing.LINES, 1])
def test_load_sharing_that_such_gears_do_not_have_is_refused(pinion, wheel, word):
    """Contact lines of spur teeth do not lean: their length over no width was no number, and all of the wear an even loss."""
    with pytest.raises(InputError, match=r"sharing = .*: one of none, halves, thirds would be right"):
        fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4), word)


def test_single_contact_is_as_sure_as_teeth_are_alike(pinion, wheel):
    """Five teeth of 80 to 120 % of A: their mean is known to A √0.5 / 10, and was said to be to what the points err by, 1 %.

    That the load was shared by halves where none is assumed shows all the same: it does on every tooth.
    """
    shares = np.array([0.8, 0.9, 1.0, 1.1, 1.2])
    fit = fit_wear_law(pinion, wheel, C, ROLL, shares[:, None] * law(ROLL, b=0.0, step=0.0), np.full(90, 1e-4), "none")[0]
    there = fit.single_contact
    assert there.sliding == pytest.approx(A, rel=1e-9)
    assert there.sliding_std == pytest.approx(0.1 * A / 2**0.5, rel=0.02)
    assert there.sliding_std == pytest.approx(fit.coefficient_stds[0], rel=0.02)
    assert "apart" not in fit.words
    halves = fit_wear_law(
        pinion, wheel, C, ROLL, shares[:, None] * law(ROLL, b=0.0, step=0.0, sharing="halves"), np.full(90, 1e-4), "none"
    )[0]
    assert halves.single_contact.sliding == pytest.approx(A, rel=1e-9)
    assert "apart, so pairs did not share the load as assumed" in halves.words


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda pair, fit: fit_wear_law(*pair, "114.3", ROLL, law(ROLL)), "centre_distance = '114.3': a number, in mm, would be right"),
        (lambda pair, fit: fit_wear_law(*pair, C, 4.0, law(ROLL)), "must match"),
        (lambda pair, fit: fit_wear_law(*pair, C, ROLL, 1e3 * law(ROLL)), "is beyond the middle of a tooth 9.975 mm thick: mm, not µm,"),
        (lambda pair, fit: fit_wear_law(*pair, C, ROLL, law(ROLL), correlation_length="2"), "correlation_length = '2': a number from 0 up, in mm,"),
        (lambda pair, fit: fit_wear_law(*pair, C, ROLL, law(ROLL), width=np.ones(3)), "width must be a number of mm of roll, or one for each"),
        (lambda pair, fit: fit_wear_law(*pair, C, ROLL, law(ROLL), width=math.nan), "width must be a number of mm of roll, or one for each"),
        (lambda pair, fit: forecast_wear(fit, "1e6", [2e6]), "cycles_run = '1e6': a number above 0"),
        (lambda pair, fit: forecast_wear(fit, 1e6, [2e6], radius="38"), "radius = '38': a number, in mm, would be right"),
        (lambda pair, fit: forecast_wear(fit, 1e6, [2e6], confidence="0.9"), "confidence = '0.9': a number would be right"),
        (lambda pair, fit: cycles_left(fit, 1e6, "0.1", "depth"), "limit = '0.1': a number above 0, in mm, would be right"),
    ],
)  # fmt: skip
def test_what_is_no_number_is_refused_by_its_name(pinion, wheel, call, named):
    fit = fit_wear_law(pinion, wheel, C, ROLL, law(ROLL), np.full(90, 1e-4))
    with pytest.raises(InputError) as refused:
        call((pinion, wheel), fit)
    assert named in str(refused.value)
