"""Wear laws fitted to worn flanks: amplitudes put in and asked back, by closed form and with the generator's flanks."""

import math

import numpy as np
import pytest

from gearwear.design.side import Side, sides_of
from gearwear.design.surface import SurfacePoints, flank_points, locate
from gearwear.diagnose.loop import make_context
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.registration import Registration
from gearwear.wear.regions import find_wear
from gearwear.wear_law.sides import fit_laws
from gearwear.wear_law.study import as_made_points
from gearwear.wear_law.teeth import FittedLaw
from tests.placing.placing import binned, designed, refined
from tests.synthetic import WHEEL, AbrasiveWear, Patch, Recipe, SlidingWear, SyntheticScan, make_scan

GEAR = designed()
CENTRE_LINE = math.sqrt(114.3**2 - (GEAR.base_radius + designed(WHEEL).base_radius) ** 2)
MATE = (2.0, CENTRE_LINE)
"""Gear ratio and C sin α of the paper's pair."""
NOISE = 0.005


def sliding(roll, law: str) -> np.ndarray:
    """Depth in units of that at the form circle: |L − L_p| without a mate, |K_1| ∝ |L − L_p| / L with one (reference B7, D3)."""
    pitch, form = GEAR.reference_roll, GEAR.form_roll
    share = np.abs(roll - pitch) / (pitch - form)
    return share * form / roll if law == "archard" else share


def worn(depth) -> SurfacePoints:
    """All flanks, some 2,500 points each at random, worn by depth(tooth, side, roll), mm at the foot, and with noise.

    The worn flank reaches on to the tip circle, from feet past the end of the involute, and ends at the form circle.
    """
    rng = np.random.default_rng(3)
    n = 24 * 2500
    tooth, side = rng.integers(0, 12, n), rng.choice([-1, 1], n)
    roll = np.sqrt(rng.uniform(GEAR.form_roll**2, (GEAR.tip_roll + 0.3) ** 2, n))
    lost = depth(tooth, side, roll)
    own = roll - lost
    on = (own > GEAR.form_roll) & (own < GEAR.tip_roll)
    points = flank_points(GEAR, tooth, side, roll, rng.uniform(0.0, 15.0, n)).with_deviation(rng.normal(0.0, NOISE, n) - lost)
    return points.take(on)


def laws(points: SurfacePoints, mate=None, worn_side: Side | None = Side.LEFT, fine: int = 1) -> dict[str, FittedLaw]:
    cells = bin_points(points, CellGrid.for_scan(GEAR, fine * len(points)))
    found = fit_laws(
        find_wear(cells, NOISE, sides_of(worn_side)), points, cells, make_context(cells, np.eye(3), False, mate), None, NOISE
    )
    assert len({(law.name, law.side) for law in found}) == len(found)
    return {law.name: law for law in found}


def placed_laws(scan: SyntheticScan, registration: Registration, worn_side: Side | None = None) -> tuple[FittedLaw, ...]:
    """Of a registered scan, without a loop and without a mate."""
    cells = binned(scan.points, GEAR, registration)
    located = locate(registration.pose.apply(scan.points), GEAR, registration.bands)
    points, wear = (
        as_made_points(located, cells.grid.index(located), cells, cells, None),
        find_wear(cells, registration.noise, sides_of(worn_side)),
    )
    return fit_laws(wear, points, cells, make_context(cells, np.eye(3), False), None, registration.noise)


def error_of_a_mean(amplitudes: int) -> float:
    """About what noise leaves of an amplitude: its own share of σ / √n, a fifth of the points carrying it."""
    return NOISE / math.sqrt(12 * 2500 / (5 * amplitudes))


def test_specific_sliding_is_the_references():
    """B7: K_1 of the paper's pair."""
    cells = bin_points(worn(lambda tooth, side, roll: 0.0 * roll), CellGrid.for_scan(GEAR, 60_000))
    found = make_context(cells, np.eye(3), False, MATE).sliding(
        np.array([3.06, 5.64, 8.0, GEAR.reference_roll, 18.0, 21.8, 26.344])
    )
    np.testing.assert_allclose(found, [-4.89, -1.97, -0.943, 0.0, 0.414, 0.603, 0.758], rtol=0.0, atol=0.006)


@pytest.mark.long
@pytest.mark.parametrize("depth_um", [pytest.param(40.0, marks=pytest.mark.long), 150.0])
def test_sliding_wear_without_a_mate_is_known_but_for_a_factor(depth_um):
    found = laws(worn(lambda tooth, side, roll: 1e-3 * depth_um * (side > 0) * sliding(roll, "archard")))
    assert set(found) == {"sliding_wear"}
    law = found["sliding_wear"]
    assert law.side == 1
    beside = laws(worn(lambda tooth, side, roll: 1e-3 * depth_um * (side > 0) * sliding(roll, "archard")), MATE)["sliding_wear"]
    assert law.depth == pytest.approx(beside.depth, rel=1e-9)
    assert law.depth == pytest.approx(1e-3 * depth_um, abs=5.0 * law.std)
    assert law.rms_after < NOISE  # of the means of cells
    # ∫ K² L dL over the flank, as the depth goes with equal weight in L².
    roll = np.sqrt(np.linspace(GEAR.form_roll**2, GEAR.tip_roll**2, 100_001))
    assert law.rms_before == pytest.approx(
        1e-3 * depth_um * math.sqrt(np.mean(sliding(roll, "archard") ** 2)), rel=0.1
    )  # feet move with the wear


@pytest.mark.long
def test_cells_nobody_saw_say_nothing_of_a_law():
    """Two points a cell leave a tenth of them empty; filled from round them they would pass for uniform loss."""
    found = laws(worn(lambda tooth, side, roll: 0.150 * (side > 0) * sliding(roll, "archard")), fine=2)
    assert set(found) == {"sliding_wear"}
    assert found["sliding_wear"].depth == pytest.approx(0.150, abs=5.0 * found["sliding_wear"].std)


def test_sliding_wear_with_a_mate_follows_specific_sliding():
    """Near the form circle K doubles within a cell; a fit of the law at the cells' middles would be 5 % off."""
    law = laws(worn(lambda tooth, side, roll: 0.100 * (side > 0) * sliding(roll, "archard")), MATE)["sliding_wear"]
    assert law.side == 1
    assert law.depth == pytest.approx(0.100, rel=0.02)


def test_shallow_sliding_is_seen_through_the_noise_and_no_uniform_loss_is_read_into_it():
    """Over the flank 7 µm on average, under 5 µm of noise a point: what cells scatter is no argument against a law."""
    found = laws(worn(lambda tooth, side, roll: 0.020 * (side > 0) * sliding(roll, "archard")), MATE)
    assert set(found) == {"sliding_wear"}
    assert found["sliding_wear"].depth == pytest.approx(0.020, abs=3.0 * found["sliding_wear"].std)


def test_uniform_loss_is_abrasive_wear():
    teeth = [0, 2, 3, 6, 8, 10]
    found = laws(worn(lambda tooth, side, roll: 0.040 * ((side < 0) & np.isin(tooth, teeth))), worn_side=None)
    assert set(found) == {"abrasive_wear"}
    law = found["abrasive_wear"]
    assert law.side == -1
    assert law.depth == pytest.approx(0.040, abs=5.0 * math.sqrt(2.0) * error_of_a_mean(1))
    assert law.rms_before == pytest.approx(0.040, rel=0.02)


def test_both_at_once_are_told_apart():
    found = laws(worn(lambda tooth, side, roll: (side > 0) * (0.100 * sliding(roll, "archard") + 0.030)))
    assert set(found) == {"sliding_wear", "abrasive_wear"}
    for name, depth in (("sliding_wear", 0.100), ("abrasive_wear", 0.030)):
        assert found[name].depth == pytest.approx(depth, abs=5.0 * found[name].std), name
    assert found["sliding_wear"].rms_after == found["abrasive_wear"].rms_after


def test_teeth_worn_unlike_give_their_mean_and_its_standard_deviation():
    """Amplitudes of 80 to 120 µm: mean, and standard deviation over √12, of the teeth themselves."""
    factor = 1.0 + 0.2 * np.sin(2.0 * np.arange(12))
    law = laws(worn(lambda tooth, side, roll: 0.100 * (side > 0) * factor[tooth] * sliding(roll, "archard")))["sliding_wear"]
    assert law.depth == pytest.approx(0.100 * factor.mean(), abs=5.0 * 0.00057)
    assert law.std == pytest.approx(0.100 * factor.std(ddof=1) / math.sqrt(12.0), rel=0.05)


@pytest.mark.parametrize("teeth", [(4,), (4, 9)])
def test_a_tooth_or_two_follow_no_law(teeth):
    assert laws(worn(lambda tooth, side, roll: 0.060 * ((side > 0) & np.isin(tooth, teeth))), worn_side=None) == {}


def test_an_unworn_gear_follows_none():
    assert laws(worn(lambda tooth, side, roll: 0.0 * roll), worn_side=None) == {}


@pytest.mark.long
def test_the_generators_flanks_give_their_amplitude_back():
    """A whole scan, registered, its flanks running on below the form circle; an unlike tooth beside them."""
    wear = (SlidingWear(100.0, -1, (), "archard"), Patch(5, -1, 250.0, (37.0, 43.5), (-9.0, 24.0), 2.0))
    scan = make_scan(Recipe(jitter=1.0, noise_um=1e3 * NOISE, wear=wear).of_size(60_000), 2)
    registration = refined(scan, GEAR)
    law = {one.name: one for one in placed_laws(scan, registration, registration.datum.worn_side)}["sliding_wear"]
    assert law.side == -1
    assert law.depth == pytest.approx(0.100, rel=0.02)


@pytest.mark.long
def test_both_sides_are_fitted_each_by_itself():
    wear = (AbrasiveWear(50.0, 1, (0, 1, 2, 3)), AbrasiveWear(30.0, -1, (6, 7, 8, 9)))
    scan = make_scan(Recipe(jitter=1.0, noise_um=1e3 * NOISE, wear=wear).of_size(60_000), 3)
    registration = refined(scan, GEAR)
    found = placed_laws(scan, registration)
    assert [(law.name, law.side) for law in found] == [("abrasive_wear", 1), ("abrasive_wear", -1)]
    assert [law.depth for law in found] == pytest.approx([0.050, 0.030], abs=5.0 * NOISE / math.sqrt(4 * 1500))
