"""Waves that points were carried by in space, asked back; and what is the gear's own, or chance, where there is none."""

from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import gearwear.diagnose.loop as loop_module
from gearwear.api import as_scan
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design.pair import Design
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, locate
from gearwear.diagnose.pattern import Pattern
from gearwear.diagnose.space_waves import SpaceWave, _transformed, find_space_waves
from gearwear.placing.cells import CellGrid, bin_points
from tests.diagnose.plain import PLAIN_AND_ALL, plain_effects
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, make_scan
from tests.synthetic.removal import SlidingWear
from tests.synthetic.texture import Texture

NOISE = 0.006
QUIET = Recipe(noise_um=1e3 * NOISE, jitter=1.0, pose="none").of_size(60_000)
ALONG = np.array([0.6, -0.64, 0.48])
"""A unit vector."""


def cells_of(points):
    gear = designed()
    return bin_points(locate(points, gear), CellGrid.for_scan(gear, len(points)))


@cache
def quiet():
    """A gear as drawn."""
    return make_scan(QUIET, 3).points


def carried(points, wavelength, height, way, along=ALONG):
    """Points carried along `way` by a wave that goes along another: of the instrument, it knows of no gear."""
    return points + height * np.cos(2.0 * np.pi * points @ along / wavelength + 0.7)[:, None] * np.asarray(way)


@pytest.mark.parametrize(
    ("wavelength", "height"), [(14.0, 0.006), pytest.param(8.0, 0.004, marks=pytest.mark.long), (5.0, 0.004)]
)
def test_a_wave_comes_back(wavelength, height):
    way = np.array([0.8, 0.6, 0.0])
    (found,) = find_space_waves(cells_of(carried(quiet(), wavelength, height, way)), NOISE)
    sign = np.sign(found.vector @ ALONG)
    assert found.vector * sign == pytest.approx(ALONG / wavelength, abs=0.001)
    assert found.wavelength == pytest.approx(wavelength, rel=0.02)
    assert found.amplitude == pytest.approx(height, rel=0.1)
    assert found.cosine[:2] == pytest.approx(height * np.cos(0.7) * way[:2], abs=0.15 * height)
    assert sign * found.sine[:2] == pytest.approx(-height * np.sin(0.7) * way[:2], abs=0.15 * height)
    assert found.p_value < 0.01


def test_what_it_does_to_a_point_is_its_displacement_along_the_normal():
    cells = cells_of(quiet())
    points = cells.points.take(cells.seen)
    wave = SpaceWave(ALONG / 7.0, np.array([0.003, 0.0, 0.001]), np.array([0.0, -0.002, 0.0]), 0.0)
    phase = 2.0 * np.pi * points.position @ ALONG / 7.0
    moved = np.cos(phase)[:, None] * [0.003, 0.0, 0.001] + np.sin(phase)[:, None] * [0.0, -0.002, 0.0]
    assert wave.deviation(points) == pytest.approx((moved * points.normal).sum(axis=1), abs=1e-15)
    assert wave.wavelength == pytest.approx(7.0) and wave.direction == pytest.approx(ALONG)
    assert wave.amplitude == pytest.approx(np.hypot(0.003, 0.001))


@pytest.mark.parametrize("seed", range(4))
def test_noise_and_texture_are_no_wave(seed):
    recipe = Recipe(noise_um=1e3 * NOISE, jitter=1.0, pose="none", texture=Texture(3.0, 1.5)).of_size(30_000)
    assert find_space_waves(cells_of(make_scan(recipe, seed).points), NOISE) == ()


def test_what_is_the_gears_own_is_no_wave():
    """Places of teeth, forms of all teeth, slopes that go round, a pose that is off, an ellipse: none of them stands in space."""
    cells, rng = cells_of(make_scan(QUIET, 4).points), np.random.default_rng(4)
    points = cells.points
    flank, angle = points.surface == FLANK, 2.0 * np.pi * points.tooth / 12
    depth = np.nan_to_num((points.roll - np.nanmin(points.roll[flank])) / np.ptp(points.roll[flank]))
    own = np.where(flank, points.side * (0.02 * rng.normal(size=12)[points.tooth] + 0.01 * np.cos(angle)), 0.0)
    own += np.where(
        flank, 0.006 * np.cos(6.0 * np.pi * depth) + 0.008 * np.cos(2.0 * angle) * (points.position[:, 2] / 15.0 - 0.5), 0.0
    )
    x, y, _ = points.position.T
    own += points.normal @ [0.05, -0.03, 0.01] + 4e-3 * (x * points.normal[:, 0] - y * points.normal[:, 1])
    own += points.normal[:, 0] * 0.2 * (points.position[:, 2] / 15.0 - 0.5) ** 2
    assert find_space_waves(cells.with_deviation(points.deviation + own), NOISE) == ()


@pytest.mark.parametrize("reach", [14.0, 40.0, 75.0, 110.0])
def test_few_teeth_tell_of_no_wave_that_is_not_there(reach):
    """One tooth to eight of twelve: too few to tell one another, and none where they are enough. A warning would be an error here."""
    points = quiet()
    assert find_space_waves(cells_of(points[np.abs(np.degrees(np.arctan2(points[:, 1], points[:, 0]))) < reach]), NOISE) == ()


def test_a_wave_on_two_thirds_of_the_teeth_comes_back():
    points = quiet()
    seen = points[np.abs(np.degrees(np.arctan2(points[:, 1], points[:, 0]))) < 120.0]
    (found,) = find_space_waves(cells_of(carried(seen, 9.0, 0.006, [0.8, 0.6, 0.0])), NOISE)
    assert found.wavelength == pytest.approx(9.0, rel=0.02) and found.amplitude == pytest.approx(0.006, rel=0.1)


def test_a_wear_of_one_tooth_is_no_wave():
    cells = cells_of(make_scan(QUIET, 5).points)
    points = cells.points
    near = np.linalg.norm(points.position - points.position[np.flatnonzero(points.surface == FLANK)[200]], axis=1)
    worn = np.where(points.surface == FLANK, -0.08 * np.exp(-((near / 3.0) ** 2)), 0.0)
    assert find_space_waves(cells.with_deviation(points.deviation + worn), NOISE) == ()


@pytest.mark.long
def test_a_bowed_axis_does_not_hide_the_rest():
    """It goes round the gear once, and has no name: pitch errors and the worn side show beside it."""
    index = np.cumsum(np.random.default_rng(6).normal(0.0, 3.0, 12))
    index -= np.linspace(0.0, index[-1], 12)
    pitch = Effect("pitch", {"index_um": tuple(index - index.mean())})
    recipe = Recipe(noise_um=8.0, jitter=1.0, pose="none", effects=(pitch,), wear=(SlidingWear(40.0, side=-1),)).of_size(25_000)
    points = make_scan(recipe, 6).points
    points[:, 0] += 0.02 * (4.0 * (points[:, 2] / 15.0 - 0.5) ** 2 - 1.0 / 3.0)
    loop = find_effects(register(Design({"gear": designed()}), as_scan(points))).loop
    assert loop.worn_sides == frozenset({Side.RIGHT}) and [effect.name for effect in loop.effects] == ["pitch"]
    assert [pattern.order for pattern in loop.patterns] == [1]


@PLAIN_AND_ALL
def test_wear_is_measured_beside_fringes_that_have_no_name(effects):
    """Fringes as high as the noise are told, as unexplained; no effect is made of them, and which side is worn is not lost."""
    recipe = Recipe(noise_um=8.0, jitter=1.0, pose="none", wear=(SlidingWear(50.0, side=-1),)).of_size(25_000)
    fringed = carried(make_scan(recipe, 8).points, 9.0, 0.008, [0.8, 0.6, 0.0])
    with plain_effects() if effects else nullcontext():
        loop = find_effects(register(Design({"gear": designed()}), as_scan(fringed))).loop
    (wave,) = loop.in_space
    assert wave.wavelength == pytest.approx(9.0, rel=0.02) and wave.amplitude == pytest.approx(0.008, rel=0.1)
    assert loop.worn_sides == frozenset({Side.RIGHT}) and loop.effects == ()
    (pattern,) = loop.patterns
    assert pattern.order is None and pattern.known_everywhere and "stands in space" in pattern.describe(15.0)


@pytest.mark.parametrize(("form", "times"), [(0.5 * NOISE, 2), (1.5 * NOISE, 1)])
def test_sides_are_asked_again_without_what_goes_round_but_not_beside_a_large_form(form, times, monkeypatch):
    """A form of all teeth larger than the noise decides which sides are worn, and waves beside it do not hide that."""
    cells = cells_of(make_scan(replace(QUIET, noise_um=1.0).of_size(5_000), 1).points)
    field, told, finished = np.zeros(len(cells.count)), [], []
    round_, all_teeth = (Pattern(order, "alike", 0.0, 1.0, size, size, 0.0, field) for order, size in ((1, NOISE), (0, form)))

    def closed(*parameters):
        told.append(parameters[-1])
        finished.append(0)
        loop = SimpleNamespace(
            residual_after=field, patterns=(round_, all_teeth), form=(), effects=(), context=SimpleNamespace(bent=())
        )
        number = len(told)

        def whole():
            finished[number - 1] += 1
            return loop

        return loop, whole

    monkeypatch.setattr(loop_module, "_closed", closed)
    loop_module.close_loop(cells, NOISE, None, in_space=())
    assert told == [(), (round_,)][:times]
    assert finished == [0] * (times - 1) + [1]  # what else the scan does not exclude is asked once, at the last


def test_some_lines_of_a_spectrum_are_those_of_the_whole_of_it():
    """Values that fill a corner of a box, and of each axis the lines to either side of 0 up to a third of all."""
    values, shape = np.random.default_rng(5).normal(size=(4, 5, 3)), [9, 10, 8]
    lines = [np.r_[: n // 3 + 1, n - n // 3 : n] for n in shape]
    whole = np.zeros(shape)
    whole[:4, :5, :3] = values
    np.testing.assert_allclose(_transformed(values, shape, lines), np.fft.fftn(whole)[np.ix_(*lines)], rtol=0.0, atol=1e-12)
