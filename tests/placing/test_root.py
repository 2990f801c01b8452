"""The root that a scan shows: a known rack is asked back, whatever the design says, and effects of scanner and maker are no other root."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.measured_gear import register
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.surface import locate
from gearwear.placing.root import BINS, SAMPLE, fit_root
from tests.placing.placing import designed
from tests.synthetic import Effect, GearNumbers, Recipe, make_scan

WHEEL = GearNumbers(teeth=24, module=4.0, face_width=12.0, rack_tip_radius=0.38)


def scanned(*effects: Effect):
    return as_scan(make_scan(Recipe(gear=WHEEL, effects=effects, noise_um=8.0).of_size(25_000), 3).views[0])


def laid_on(drawn: GearNumbers, scan):
    return register(Design({"gear": designed(drawn)}, None), scan)


plain = cache(scanned)


@cache
def measured(drawn: GearNumbers = WHEEL):
    """The wheel as it is, laid on a drawing."""
    return laid_on(drawn, plain())


@pytest.mark.parametrize("stated", [pytest.param(0.25, marks=pytest.mark.long), pytest.param(0.30, marks=pytest.mark.long), 0.38])
def test_the_racks_tip_radius_is_found_whatever_the_design_says(stated):
    root = measured(replace(WHEEL, rack_tip_radius=stated)).root
    assert root.seen and not root.free
    assert root.rack_tip_radius == pytest.approx(0.38, abs=0.015)
    assert root.fits_design == (stated == 0.38)
    assert ("a rack tip radius of 0.3" in root.words()) != root.fits_design


@pytest.mark.long
def test_a_wrong_dedendum_is_found_too():
    root = measured(replace(WHEEL, dedendum=1.30)).root
    assert not root.fits_design
    assert root.dedendum == pytest.approx(1.25, abs=0.005)


@pytest.mark.long
@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(Effect("coating", {"thickness_um": 25.0}), marks=pytest.mark.long),
        pytest.param(Effect("tooth_thickness", {"thickness_um": 40.0}), marks=pytest.mark.long),
        Effect("scale", {"relative_ppm": 400.0}),
        pytest.param(Effect("profile_slope", {"left_um": 25.0, "right_um": 20.0}), marks=pytest.mark.long),
        pytest.param(Effect("turntable_angle", {"order": 2, "amplitude_deg": 0.03, "phase_deg": 40.0}), marks=pytest.mark.long),
    ],
    ids=lambda e: e.name,
)
def test_what_scanner_and_maker_add_is_no_other_root(effect):
    root = laid_on(WHEEL, scanned(effect)).root
    assert root.fits_design, root


@pytest.mark.long
def test_a_root_that_no_round_rack_tip_makes_is_free():
    """Half the fillet filled up by a fifth of a millimetre, as a protuberance or grinding leaves it, on every tooth alike."""
    gear, located = designed(WHEEL), measured().located
    radius = np.hypot(located.position[:, 0], located.position[:, 1])
    low, high = gear.root_radius, gear.form_radius
    share = np.clip((radius - low) / (high - low), 0.0, 1.0)
    step = 0.2 * np.sin(np.pi * share) ** 8 * np.isin(located.surface, (1, 2))
    root = fit_root(located.with_deviation(located.deviation + step), gear)
    assert root.free and "no datum" in root.words()


def test_noise_is_no_shape_of_the_root():
    """Points on the very root of the design that err by 20 µm: what all teeth have in common is what medians of some 2 × 300 of them leave."""
    gear, located = designed(WHEEL), measured().located
    noise = np.random.default_rng(5).normal(0.0, 0.020, len(located))
    root = fit_root(located.with_deviation(noise), gear)
    points_of_a_side = SAMPLE / BINS / 2.0
    assert root.misfit < 2.0 * 1.2533 * 0.020 / np.sqrt(2.0 * points_of_a_side)
    assert root.fits_design


def test_chamfered_ends_are_no_part_of_the_root():
    """A chamfer of 1 mm on the drawing takes the points next to the ends away: those between them show the root they showed without it."""
    points = measured().located
    position = points.position + points.normal * np.nan_to_num(points.deviation)[:, None]
    chamfered = Gear.from_spec(replace(designed(WHEEL).spec, end_chamfer=1.0))
    root = fit_root(locate(position, chamfered), chamfered)
    assert root.fits_design and not root.free
    assert root.misfit == pytest.approx(measured().root.misfit, abs=0.0015)


def test_a_few_strays_are_no_other_side_of_the_spaces():
    """Of a scan of one side of all spaces, with four points in a thousand on the other, half a millimetre off: the root is the one of the design all the same."""
    gear, located = designed(WHEEL), measured().located
    random = np.random.default_rng(7)
    stray = (located.side != 1) & (random.random(len(located)) < 0.004)
    kept = located.take((located.side == 1) | stray)
    off = np.where(kept.side == 1, kept.deviation, kept.deviation - 0.5)
    whole, root = measured().root, fit_root(kept.with_deviation(off), gear)
    assert root.seen and root.fits_design
    assert root.misfit < 2.0 * whole.misfit


@pytest.mark.parametrize("below", [-0.2, 0.0, 0.2])
def test_a_scan_without_roots_says_nothing_of_them(below):
    """Nor where it ends with the flanks, or a little further: of a root that begins higher these points would be, and fit."""
    gear, located = designed(replace(WHEEL, rack_tip_radius=0.25)), measured().located
    on = located.position + located.normal * np.nan_to_num(located.deviation)[:, None]
    root = fit_root(locate(on[np.hypot(*on[:, :2].T) > gear.form_radius - below], gear), gear)
    assert not root.seen and root.gear is gear and root.words() == ""


def test_refitting_keeps_the_other_dimensions():
    root = measured(replace(WHEEL, rack_tip_radius=0.25)).root
    drawn, fitted = designed(replace(WHEEL, rack_tip_radius=0.25)), root.gear
    assert isinstance(fitted, Gear)
    assert (fitted.tip_radius, fitted.base_radius, fitted.tooth_thickness, fitted.face_width) == (
        drawn.tip_radius, drawn.base_radius, drawn.tooth_thickness, drawn.face_width,
    )  # fmt: skip
