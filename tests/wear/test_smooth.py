"""The worn surface without the noise of its cells: what it must leave alone, what it takes away, and how far it is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from gearwear.diagnose.covariance import CellCovariance
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.regions import Wear
from gearwear.wear.smooth import second_differences, smooth_surface
from tests.synthetic.double_helical import Double
from tests.synthetic.helical import Helical
from tests.synthetic.test_double_helical import designed as designed_double

NOISE, COUNT = 0.010, 4.0


@dataclass
class Flanks:
    """Left flanks of a pinion worn as told, in cells."""

    grid: CellGrid
    true: np.ndarray
    wear: Wear

    @classmethod
    def of(cls, gear, depth, seed=None, texture=0.0):
        """`depth(tooth, row, 1 / L)` in mm; `seed` None: without noise. Texture: in mm, hanging together over 2 cells."""
        grid = CellGrid.for_scan(gear, 200_000)
        edges = grid.roll_edges
        tooth, row, inverse = np.meshgrid(
            np.arange(gear.teeth), np.arange(grid.rows), 2.0 / (edges[1:] + edges[:-1]), indexing="ij"
        )
        true = np.zeros((gear.teeth, 2, grid.rows, grid.fillet + grid.flank))
        true[:, 0, :, grid.fillet :] = depth(tooth, row, inverse)
        measured = true.copy()
        if seed is not None:
            random = np.random.default_rng(seed)
            measured += random.normal(0.0, NOISE / np.sqrt(COUNT), true.shape)
            if texture:
                chains = [np.linalg.cholesky(_chain(n)) for n in true.shape[2:]]
                measured += texture * np.einsum("ij,tsjk,lk->tsil", chains[0], random.normal(size=true.shape), chains[1])
        mask = np.zeros(true.shape, dtype=bool)
        mask[:, 0, :, grid.fillet :] = True
        empty = make_side_maps(bin_points(_no_points(gear), grid))
        side_maps = type(empty)(
            -measured, np.full(true.shape, COUNT), empty.position, empty.area, grid.fillet, empty.offset, empty.torn
        )
        depth_found = np.where(mask, measured, 0.0)
        return cls(grid, true, Wear((), 0.0, 0.0, side_maps, mask, depth_found, 0.0, 0.0))

    def smooth(self, covariance=None, draws=0):
        return smooth_surface(self.wear, self.grid, NOISE, covariance, draws)


def _chain(n):
    return np.exp(-np.abs(np.subtract.outer(np.arange(n), np.arange(n))) / 2.0)


def _no_points(gear):
    from gearwear.design.surface import flank_points

    return flank_points(gear, np.zeros(1, int), np.ones(1, int), np.array([gear.reference_roll]), np.array([1.0])).with_deviation(
        np.zeros(1)
    )


def sliding(tooth, row, inverse):
    return 0.1 * np.abs(1.0 - 13.03 * inverse)


def test_second_differences_are_the_usual_ones_on_even_places_and_leave_lines():
    np.testing.assert_allclose(second_differences(np.arange(4.0)), [[1.0, -2.0, 1.0, 0.0], [0.0, 1.0, -2.0, 1.0]])
    place = np.sort(np.random.default_rng(0).random(9))
    np.testing.assert_allclose(second_differences(place) @ (3.0 - 7.0 * place), 0.0, atol=1e-12)
    assert second_differences(np.arange(2.0)).shape == (0, 2)


def test_what_no_penalty_sees_stays_as_it_is(pinion):
    """An even loss, and one as 1 / L, each with a slope along z: exactly, with the stiffness found."""
    flanks = Flanks.of(pinion, lambda tooth, row, inverse: (0.02 + 0.3 * inverse) * (1.0 + 0.05 * row))
    np.testing.assert_allclose(flanks.smooth().depth, flanks.true, atol=1e-12)


@pytest.mark.parametrize("seed", [1, 2])
def test_noise_goes_and_the_mean_stays(pinion, seed):
    """White noise of 5 µm a cell on sliding wear alike along z: a column has 30 cells, so less than a third can be left of it."""
    flanks = Flanks.of(pinion, sliding, seed)
    found = flanks.smooth().depth
    worn = flanks.wear.mask
    before, after = (np.sqrt(np.mean((one - flanks.true)[worn] ** 2)) for one in (flanks.wear.depth, found))
    assert after < before / 3.0
    # What flanks lost on average, one and all, is kept to the scatter of the mean of so many cells.
    mean = (found - flanks.wear.depth)[worn].reshape(12, -1).mean(axis=1)
    assert np.abs(mean).max() < 4.0 * NOISE / np.sqrt(COUNT * worn[0].sum())
    assert abs(mean.mean()) < NOISE / np.sqrt(COUNT * worn.sum())


def off(gear, depth, worn, seed=8):
    """RMS of the smoothed surface against the truth, mm, where so many flanks are worn."""
    flanks = Flanks.of(gear, depth, seed)
    flanks.wear.mask[worn:] = False
    return np.sqrt(np.mean((flanks.smooth().depth - flanks.true)[flanks.wear.mask] ** 2))


def test_flanks_that_are_alike_say_it_together(pinion):
    """Three are taken one by one. Twelve alike have the scatter of a median of twelve, √(π / 24) = 0.36 of it, and what of theirs is taken for their own."""
    assert off(pinion, sliding, 12) < 0.6 * off(pinion, sliding, 3)


def test_flanks_that_are_not_alike_stay_so(pinion):
    """Each with a slope and a level of its own, many times its noise: no farther off than one by one."""

    def depth(tooth, row, inverse):
        return 0.02 + 0.004 * tooth + 0.0002 * row * (tooth % 3) + 0.05 * inverse * (tooth % 4)

    assert off(pinion, depth, 12) < 1.1 * off(pinion, depth, 3)


def test_draws_scatter_as_far_as_the_surface_is_off(pinion):
    """Errors in units of the posterior's own standard deviation: 1 within a fifth, over 24 flanks of two scans."""
    square = []
    for seed in (3, 4):
        flanks = Flanks.of(pinion, sliding, seed)
        found = flanks.smooth(draws=60)
        worn = flanks.wear.mask
        std = found.draws.std(axis=0, ddof=1)[worn]
        square.append(np.mean(((found.depth - flanks.true)[worn] / std) ** 2))
    assert np.sqrt(np.mean(square)) == pytest.approx(1.0, abs=0.2)
    np.testing.assert_allclose(found.draws.mean(axis=0)[worn], found.depth[worn], atol=5.0 * std.max() / np.sqrt(60))


def test_what_one_half_of_a_double_helical_gear_lost_says_nothing_of_the_other():
    """The lower half's surface is the same to the last digit whatever the upper half lost, and no less smooth than a gear of that face."""
    gear, lower = designed_double(Double(Helical(teeth=17, helix=24.0, width=11.0), gap=6.0)), []
    for deep in (0.0, 0.1):
        flanks = Flanks.of(gear, lambda tooth, row, inverse, deep=deep: 0.02 + deep * (row > 33), seed=1)
        rows = flanks.grid.zones[0][0]
        flanks.wear.mask[:, :, ~flanks.grid.toothed] = False
        assert flanks.grid.zones[1][0].start > 33 > rows.stop
        lower.append(flanks.smooth(draws=1))
    for one, other in zip(*((found.depth, found.draws) for found in lower), strict=True):
        np.testing.assert_array_equal(one[..., rows, :], other[..., rows, :])
    error = (lower[-1].depth - flanks.true)[:, 0, rows, flanks.grid.fillet :]
    assert np.sqrt(np.mean(error**2)) < NOISE / np.sqrt(COUNT) / 3.0


def errors_about_a_patch(pinion, deep, rows):
    """RMS of the smoothed surface against the truth, mm, with a patch on one tooth: on the rest of its flank, on other flanks, in the patch."""

    def depth(tooth, row, inverse):
        inside = (tooth == 3) & (row >= 1) & (row <= rows) & (inverse > 0.05) & (inverse < 0.1)
        return sliding(tooth, row, inverse) + deep * inside

    flanks = Flanks.of(pinion, depth, 5)
    error = flanks.smooth().depth - flanks.true
    patch = (flanks.true[3] - flanks.true[4])[0, :, flanks.grid.fillet :] > 0.5 * deep
    near = np.zeros_like(patch)
    rows, columns = np.nonzero(patch)
    near[max(rows.min() - 3, 0) : rows.max() + 4, max(columns.min() - 3, 0) : columns.max() + 4] = True
    own, others = error[3, 0, :, flanks.grid.fillet :], error[4:, 0, :, flanks.grid.fillet :]
    return (np.sqrt(np.mean(square**2)) for square in (own[~near], others, own[patch]))


@pytest.mark.parametrize("rows", [9, 19])
def test_a_patch_on_one_tooth_leaves_the_rest_of_its_flank_smooth(pinion, rows):
    """Also where it takes two thirds of the face."""
    rest, others, inside = errors_about_a_patch(pinion, 0.4, rows)
    assert rest < 1.5 * others
    # In the patch the flank's own stiffness holds: no more than the noise of its cells.
    assert inside < NOISE / np.sqrt(COUNT)


def test_so_does_a_patch_ten_times_as_deep_as_cells_scatter(pinion):
    rest, others, _ = errors_about_a_patch(pinion, 10.0 * NOISE / np.sqrt(COUNT), 9)
    assert rest < 1.5 * others


def test_texture_is_no_wear(pinion):
    """Correlated scatter of 4 µm: known of, it is taken away; unknown, some of it is followed."""
    flanks = Flanks.of(pinion, sliding, 6, texture=0.004)
    step = float(np.exp(-0.5))
    covariance = CellCovariance(flanks.grid, np.full(flanks.grid.count, NOISE**2 / COUNT), 0.004**2, step, step)
    worn = flanks.wear.mask
    known, unknown = (np.sqrt(np.mean((flanks.smooth(one).depth - flanks.true)[worn] ** 2)) for one in (covariance, None))
    assert known < 0.8 * unknown


def test_nothing_worn_is_left_alone(pinion):
    flanks = Flanks.of(pinion, lambda tooth, row, inverse: np.zeros(tooth.shape), 7)
    flanks.wear.mask[:] = False
    found = flanks.smooth(draws=2)
    assert not found.depth.any() and not found.draws.any()
