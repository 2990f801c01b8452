"""The wear law from scan to forecast: amplitudes put into simulated scans and asked back with the certainty claimed.

The scans are made by code that shares nothing with the fit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.meshing.path import path_of_contact
from gearwear.wear.regions import Wear
from gearwear.wear_law.across import across_words
from gearwear.wear_law.sides import FittedLaw, fit_laws
from gearwear.wear_law.study import Ahead, WearStudy, as_made_points, study_wear
from tests.synthetic import WHEEL, AbrasiveWear, Effect, Patch, Recipe, SlidingWear, Texture, make_scan

pytestmark = pytest.mark.long

DESIGN = gw.read_design(gw.example("design.toml"))
PINION, GEAR = DESIGN.gears["pinion"], DESIGN.gears["gear"]
AHEAD = Ahead(1e6, (2e6, 5e6), (("depth", 0.2),))
PLAIN = Recipe(noise_um=10.0, jitter=1.0, texture=Texture(2.0, 1.0))
COATED = replace(PLAIN, effects=(Effect("coating", {"thickness_um": 18.0}),))


@dataclass(frozen=True, slots=True)
class Alone:
    """More loss where one pair carries alone; a wear shape of the generator's kind."""

    depth_um: float

    def depth(self, outline: Any, tooth: Any, side: Any, roll: Any, z: Any) -> Any:
        base_pitch = 2.0 * math.pi * outline.base_radius / outline.teeth
        within = (roll > outline.tip_roll - base_pitch) & (roll < outline.form_roll + base_pitch)
        return 1e-3 * self.depth_um * within * (side == 1)

    def breaks(self, outline: Any) -> tuple[list[float], list[float]]:
        return [], []


def measure(
    recipe: Recipe, seed: int, part: str = "pinion", points: int = 20_000, worn: frozenset[Side] | None = frozenset({Side.LEFT})
) -> tuple[MeasuredGear, Wear]:
    """Which side is `worn` throughout is another test's question, but for one that is asked all of it (None)."""
    scan = make_scan(recipe.of_size(points), seed)
    measured = gw.find_effects(gw.register(DESIGN, gw.as_scan(scan.points), part), worn)
    return measured, gw.find_wear(measured)


def flanks_of(measured: MeasuredGear) -> SurfacePoints:
    return as_made_points(measured.located, measured.final.lying.cell, measured.cells, measured.as_made, measured.loop)


def law_of(measured: MeasuredGear, wear: Wear, side: int = 1, ahead: Ahead | None = None) -> WearStudy:
    mate, centre = DESIGN.mate_of(measured.part), DESIGN.centre_distance
    assert mate is not None
    return study_wear(wear, flanks_of(measured), measured.as_made, Side(side), mate, centre, measured.loop, measured.noise, ahead)


def study(
    recipe: Recipe,
    seed: int,
    part: str = "pinion",
    side: int = 1,
    points: int = 20_000,
    ahead: Ahead | None = None,
    worn: frozenset[Side] | None = frozenset({Side.LEFT}),
) -> WearStudy:
    return law_of(*measure(recipe, seed, part, points, worn), side, ahead)


def sliding_at(gear: gw.Gear, mate: gw.Gear) -> float:
    """|K| at the form circle, where the generator states the depth."""
    line = math.sqrt(114.3**2 - (gear.base_radius + mate.base_radius) ** 2)
    return abs(1.0 - (line - gear.form_roll) * gear.teeth / (mate.teeth * gear.form_roll))


def asked_back(found: WearStudy, put_in: tuple[float, float, float]) -> None:
    """All three coefficients in mm within three standard deviations, and those are worth something."""
    fit = found.fits[0]
    std = np.sqrt(np.diag(fit.covariance))
    assert (np.abs(fit.coefficients - put_in) < 3.0 * std).all()
    assert std[0] < 0.15 * put_in[0] and (std[1:] < 0.001).all()
    share, error = fit.explained
    assert abs(share - 1.0) < 3.0 * error + 0.001


def test_sliding_wear_of_unlike_teeth_under_a_coat():
    factors = tuple(float(x) for x in np.random.default_rng(1).normal(1.0, 0.1, 12))
    found = study(replace(COATED, wear=(SlidingWear(75.0, 1, factors, "archard"),)), 1)
    asked_back(found, (0.075 * float(np.mean(factors)) / sliding_at(PINION, GEAR), 0.0, 0.0))
    assert (found.teeth, found.left_out, found.fits[0].sharing) == (tuple(range(12)), (), "none")


@pytest.fixture(scope="module")
def even() -> WearStudy:
    """Of all left flanks alike, 150 µm at the form circle; points enough for three cells beside it."""
    return study(replace(COATED, wear=(SlidingWear(150.0, 1, (), "archard"),)), 9, points=45_000, ahead=AHEAD, worn=None)


def test_near_the_form_circle_it_reads_no_less(even):
    """Sliding doubles there within a cell of the size in use, and few points lie there."""
    fit = even.fits[0]
    low = fit.roll < 6.0
    law = 0.150 / sliding_at(PINION, GEAR) * np.abs(1.0 - (39.09290238 - fit.roll[low]) / (2.0 * fit.roll[low]))
    assert low.sum() >= 3 and fit.roll[0] < PINION.form_roll + 1.5
    off = fit.depth[low] - law
    assert np.abs(off).max() < 3.0 * fit.std[low].max()
    assert abs(off.mean()) < 3.0 * np.sqrt(fit.errors[np.ix_(low, low)].mean())


@pytest.fixture(scope="module")
def three() -> tuple[WearStudy, dict[str, FittedLaw]]:
    """The law, and those of the catalogue, of flanks that slid, were ground down and lost more in single contact."""
    sliding = (SlidingWear(160.0, 1, (), "archard"), AbrasiveWear(5.0, 1), Alone(6.0))
    measured, wear = measure(replace(PLAIN, wear=sliding), 4)
    law = law_of(measured, wear)
    laws = fit_laws(wear, flanks_of(measured), measured.as_made, measured.context, measured.loop, measured.noise, law)
    return law, {one.name: one for one in laws}


def test_all_three_terms_are_told_apart(three):
    asked_back(three[0], (0.160 / sliding_at(PINION, GEAR), 0.005, 0.006))


def test_the_wheels_right_flanks():
    """Sliding of the wheel is least near its tip, where the undercut pinion has no involute to meet it."""
    recipe = replace(PLAIN, gear=WHEEL, wear=(SlidingWear(50.0, -1, (), "archard"),))
    found = study(recipe, 5, "gear", -1, worn=frozenset({Side.RIGHT}))
    asked_back(found, (0.050 / sliding_at(GEAR, PINION), 0.0, 0.0))
    assert (found.side, len(found.teeth)) == (-1, 24)
    assert found.fits[0].roll[-1] <= path_of_contact(GEAR, PINION, 114.3).end_pinion < GEAR.tip_roll - 2.0


def test_a_tooth_with_a_patch_is_left_out_and_its_volume_is_not_the_laws():
    wear = (SlidingWear(75.0, 1, (), "archard"), Patch(1, 1, 600.0, (36.1, 44.6), (-4.0, 10.0)))
    found = study(replace(COATED, wear=wear), 6)
    assert found.left_out == (1,)
    asked_back(found, (0.075 / sliding_at(PINION, GEAR), 0.0, 0.0))
    assert 0.3 < found.volume_share < 0.6


def test_the_laws_of_the_catalogue_are_the_same_fit(three):
    """Both in `wear.laws` and in `meshing.wear_law`: one says at the form circle what the other says per |K|."""
    law, laws = three
    fit = law.fits[0]
    assert set(laws) == {"sliding_wear", "abrasive_wear"}
    assert laws["sliding_wear"].depth == pytest.approx(fit.coefficients[0] * sliding_at(PINION, GEAR))
    assert (laws["abrasive_wear"].depth, laws["abrasive_wear"].side) == (fit.coefficients[1], 1)
    for name, depth in (("sliding_wear", 0.160), ("abrasive_wear", 0.005)):
        assert laws[name].depth == pytest.approx(depth, abs=3.0 * laws[name].std)
    assert laws["sliding_wear"].rms_before > 3.0 * laws["sliding_wear"].rms_after


def test_the_forecast_is_the_law_put_in(even):
    depth = even.forecast.greatest_depth
    for i, times in enumerate((1.0, 2.0, 5.0)):
        assert depth.low[i] < times * 0.150 < depth.high[i]
    # Deepest is where two pairs share the load, and how they will is not known; in single contact the rate is.
    band, at = (
        even.forecast.depth,
        int(np.argmin(np.abs(even.forecast.roll - 10.5))),
    )  # single contact begins at 7.6, an early pair may carry to 10.4
    assert depth.low[-1] < 1.1 * 0.150
    rate = 0.150 / sliding_at(PINION, GEAR) * abs(1.0 - (39.09290238 - even.forecast.roll[at]) / (2.0 * even.forecast.roll[at]))
    for i, times in enumerate((1.0, 2.0, 5.0)):
        assert band.low[i, at] < times * rate < band.high[i, at]
    assert band.high[-1, at] - band.low[-1, at] < 0.25 * band.value[-1, at]
    (one,) = even.left
    assert one.left.low < 1e6 * (0.2 / 0.150 - 1.0) < one.left.high
    across = even.across
    assert across is not None and not across.uneven and across_words(across) == ""
    assert abs(across.lean) < 3.0 * across.lean_std + 1e-6


def test_wear_that_leans_across_the_face_is_said_with_its_amount():
    @dataclass(frozen=True, slots=True)
    class Leaning:
        """Sliding wear, 30 µm deeper at one end of the face than at the other, wherever on the flank."""

        def depth(self, outline: Any, tooth: Any, side: Any, roll: Any, z: Any) -> Any:
            sliding = np.abs(1.0 - (39.09290238 - roll) / (2.0 * np.maximum(roll, 2.0)))
            return (0.020 * sliding + 0.030 * np.asarray(z) / 15.0) * (side == 1)

        def breaks(self, outline: Any) -> tuple[list[float], list[float]]:
            return [], []

    found = study(replace(PLAIN, wear=(Leaning(),)), 3)
    assert found.across is not None
    assert abs(found.across.lean - 0.030) < 3.0 * found.across.lean_std < 0.006
    assert "uneven across the face: " in across_words(found.across) and "deeper at the upper end" in across_words(found.across)


def test_what_the_law_does_not_explain_is_not_forecast():
    """Hollows across the middle of the flanks, where nothing slides."""
    wear = tuple(Patch(tooth, 1, 150.0, (37.2, 40.0), (-8.0, 23.0)) for tooth in range(5))
    found = study(replace(PLAIN, wear=wear), 7, ahead=AHEAD, worn=frozenset())
    assert found.fits and found.forecast is None and found.left == ()
    assert found.fits[0].explained[0] < 0.5
    assert "no forecast: the law explains" in found.why_not and "half is the least" in found.why_not


def test_two_worn_teeth_are_no_law():
    wear = tuple(Patch(tooth, 1, 150.0, (37.2, 40.0), (-8.0, 23.0)) for tooth in (2, 7))
    found = study(replace(PLAIN, wear=wear), 8, ahead=AHEAD, worn=frozenset())
    assert (found.fits, found.forecast, found.left) == ((), None, ())
    assert found.why_not == "wear on 2 teeth of one side; a law is fitted from 3 worn teeth on"


def test_three_teeth_worn_unlike_are_no_law_either():
    wear = tuple(Patch(tooth, 1, depth, (36.1, 44.6), (-8.0, 23.0)) for tooth, depth in ((1, 1500.0), (0, 200.0), (2, 150.0)))
    found = study(replace(PLAIN, wear=wear), 9, ahead=AHEAD, worn=frozenset())
    assert (found.fits, found.forecast, found.left_out) == ((), None, (1,))
    assert found.why_not == "3 flanks of one side are worn, but 2 of them alike; a law is fitted from 3 on"
