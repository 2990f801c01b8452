"""Waves of the gear's own beside an effect of one order: against closed forms, and the coverage of amplitudes on drawn gears."""

import numpy as np
import pytest

from gearwear.diagnose.own_waves import beyond_texture, neighbouring_waves, order_of
from tests.diagnose.core.toy import TEETH, Toy, fit_of, grid, sides_of

NOISE, COUNT = 0.005, 20.0
EFFECT = Toy("oval")


def angle(at):
    """Of each tooth, on its cells."""
    return 2.0 * np.pi * at.tooth / TEETH


def oval(at):
    return [(EFFECT, np.stack([np.cos(2.0 * angle(at)), np.sin(2.0 * angle(at))], axis=-1))]


def test_a_wave_is_turned_into_one_of_the_order_asked_with_its_height_and_place():
    one = grid()
    at = sides_of(one)
    shape = 0.003 * (1.0 + at.z) * np.where(at.left, 1.0, -0.5)
    field = one.on_cells(shape * np.cos(3.0 * angle(at) - 0.4))
    everywhere = np.ones(one.count, dtype=bool)
    assert (order_of(one, field), order_of(one, one.on_cells(shape))) == (3, 0)
    waves = neighbouring_waves(one, field, everywhere, 2)  # from orders 3 and 4
    expected = np.column_stack([one.on_cells(shape * np.cos(2.0 * angle(at) - 0.4 + turned)) for turned in (0.0, np.pi / 2.0)])
    np.testing.assert_allclose(waves[:, :2], expected, atol=1e-15)
    np.testing.assert_allclose(waves[:, 2:], 0.0, atol=1e-15)
    without = one.on_cells((at.tooth != 5).astype(float)) > 0.0
    assert neighbouring_waves(one, field, without, 2).shape == (one.count, 0)


def test_what_texture_makes_by_chance_adds_nothing_and_more_adds_what_is_beyond_it():
    rng, spread = np.random.default_rng(1), np.array([[4.0, 1.0], [1.0, 2.0]])
    root = np.linalg.cholesky(spread)
    added = [np.trace(beyond_texture(root @ rng.normal(size=(2, 4)), spread)) for _ in range(2000)]
    assert (
        0.0 < np.mean(np.array(added) > 0.0) < 0.02
    )  # p = 0.01 of χ² with 4 freedoms, of which two pulls each have twice as many
    pulls = 10.0 * root @ np.array([[1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, -1.0]])
    np.testing.assert_allclose(beyond_texture(pulls, spread), (1.0 - 1.0 / 50.0) * 100.0 * spread)


@pytest.mark.long
@pytest.mark.parametrize(("height", "least"), [pytest.param(0.0, 0.9, marks=pytest.mark.long), (0.01, 0.9)])
def test_the_size_of_an_effect_holds_the_truth_on_gears_with_waves_of_their_own(height, least):
    """Waves of orders 2 to 5, alike in the mean, by chance in size and place on each side; without them the texture's ± alone."""
    one, rng = grid(), np.random.default_rng(7)
    at, blocks = sides_of(one), oval(sides_of(one))
    fit = fit_of(one, np.zeros(at.z.shape), blocks, NOISE, COUNT)
    model, held, texture_alone = fit.dictionary.candidates, 0, 0
    for _ in range(120):
        waves = np.zeros(at.z.shape)
        for order in (2, 3, 4, 5):
            for side in (at.left, ~at.left):
                cosine, sine = height * rng.normal(size=2)
                waves += side * (cosine * np.cos(order * angle(at)) + sine * np.sin(order * angle(at)))
        value = 0.1 * blocks[0][1][..., 0] + waves + NOISE / np.sqrt(COUNT) * rng.normal(size=at.z.shape)
        drawn = fit_of(one, value, blocks, NOISE, COUNT)
        columns, weight = drawn.columns(model), drawn.weight
        inverse = np.linalg.inv(columns.T @ (columns * weight[:, None]))
        amplitudes = inverse @ (columns.T @ (weight * drawn.target))
        spread, (places,) = drawn.joint_uncertainty(model, amplitudes, None, 0.0)
        off = abs(amplitudes[places[0]] - 0.1)
        held += off < 1.96 * np.sqrt(spread[places[0], places[0]])
        texture_alone += off < 1.96 * np.sqrt(inverse[places[0], places[0]])
    assert held / 120 > least
    assert (texture_alone / 120 > 0.9) == (height == 0.0)
