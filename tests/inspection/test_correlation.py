"""Points that hang together: the factor against its closed form, and U that keeps its promise."""

import math

import numpy as np
import pytest

from gearwear.inspection import Settings, inspect
from gearwear.inspection.correlation import points_per_independent
from gearwear.inspection.traces import flank_samples
from tests.inspection.synthetic import flanks

NOISE = 0.010
ROLL, Z = 96, 48


def blocks(points, gear, size, deviation, seed):
    """The same random deviation for all points of a block of size × size of the cells that `flanks` filled one by one."""
    i = ((points.roll - gear.form_roll) / (gear.tip_roll - gear.form_roll) * ROLL).astype(int)
    j = (points.position[:, 2] / gear.face_width * Z).astype(int)
    flank = 2 * points.tooth + (points.side < 0)
    block = (flank * ROLL + i // size) * Z + j // size
    return deviation * np.random.default_rng(seed).normal(size=block.max() + 1)[block]


def scan(gear, size, deviation, seed):
    points = flanks(gear, ROLL, Z, seed)
    white = np.random.default_rng(100 + seed).normal(0.0, NOISE, len(points))
    return points.with_deviation(white + blocks(points, gear, size, deviation, 200 + seed))


@pytest.mark.parametrize(("size", "deviation"), [(2, 0.005), (3, 0.003), (4, 0.003), (4, 0.006)])
def test_factor_of_blocks_is_that_of_cluster_sampling(pinion, size, deviation):
    """n points with a common error of variance c² beside their own σ²: 1 + n c² / σ², up to what the scatter takes of c for its own."""
    found = np.mean([points_per_independent(flank_samples(scan(pinion, size, deviation, k), pinion), NOISE) for k in range(4)])
    assert found == pytest.approx(1.0 + size**2 * (deviation / NOISE) ** 2, rel=0.15)


def test_white_noise_form_and_wear_are_no_correlation(pinion):
    points = flanks(pinion, ROLL, Z)
    noise = np.random.default_rng(1).normal(0.0, NOISE, len(points))
    shape = 0.005 * np.cos(points.roll) + 0.005 * np.cos(2.0 * points.position[:, 2])
    shape += 0.001 * (points.roll - 14.0) * (points.position[:, 2] - 7.5)  # form along either way, and a twist
    hollow = np.exp(-(((points.roll - 8.0) / 4.0) ** 2) - ((points.position[:, 2] - 5.0) / 3.0) ** 2)
    worn = np.where(points.side > 0, -0.3 * hollow, 0.0)
    for deviation in (noise, noise + shape, noise + shape + worn):
        assert points_per_independent(flank_samples(points.with_deviation(deviation), pinion), NOISE) == 1.0


def test_a_section_says_nothing_on_it(pinion):
    points = flanks(pinion, 200, 1)
    points.position[:, 2] = 7.5
    assert points_per_independent(flank_samples(points, pinion), NOISE) == 1.0


@pytest.mark.long
def test_stated_uncertainty_covers_correlated_errors_and_says_so(pinion):
    """Blocks of 1 mm: without the factor two thirds of the values lie within U, with it about 95 %; and a note tells."""
    inside: dict[str, list[float]] = {"found": [], "one": []}
    for seed in range(8):
        points = scan(pinion, 4, 0.005, seed)
        for name, factor in (("found", None), ("one", 1.0)):
            found = inspect(points, pinion, Settings(noise=NOISE, sample_factor=factor))
            for part in (found.profile.slope, found.profile.crowning, found.helix.slope, found.helix.crowning, found.pitch.index):
                inside[name] += list((np.abs(part.value) <= part.expanded).ravel())
            said = [note for note in found.notes if "worth one independent point" in note]
            assert bool(said) == (name == "found")
            assert found.settings.sample_factor == pytest.approx(5.0 if factor is None else 1.0, rel=0.3)
    assert np.mean(inside["one"]) < 0.75
    count = len(inside["found"]) / 4.0  # slope, crowning and index of a flank are not independent of each other
    assert abs(np.mean(inside["found"]) - 0.954) < 0.03 + 2.0 * math.sqrt(0.05 * 0.95 / count)
