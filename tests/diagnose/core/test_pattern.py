"""Structures put on the tooth sides and asked back, and noise in which there is none."""

import numpy as np
import pytest

from gearwear.diagnose.pattern import Pattern, _gain_on_left_out_teeth, _order_map, find_patterns, joined, order_share
from tests.diagnose.core.toy import TEETH, grid, sides_of

NOISE, COUNT = 0.005, 9.0


def noisy(one, rng, shape):
    return NOISE / np.sqrt(COUNT) * rng.normal(size=shape)


def search(one, sheets):
    use = one.on_cells(np.isfinite(sheets))
    return find_patterns(one, one.on_cells(np.nan_to_num(sheets)), use, NOISE)


@pytest.mark.parametrize("order", [0, 1, 2, 5, 6])
@pytest.mark.parametrize(("sides", "sign"), [("alike", 1.0), ("opposite", -1.0), ("left only", 0.0)])
def test_order_parity_and_size_come_back(order, sides, sign):
    one, rng = grid(), np.random.default_rng(order)
    at = sides_of(one)
    wave = np.cos(2.0 * np.pi * (order * at.tooth / TEETH + at.across) + 0.4) * np.where(at.left, 1.0, sign)
    (found,) = search(one, 0.004 * wave + noisy(one, rng, wave.shape))
    assert (found.order, found.sides) == (order, sides)
    assert found.waves_profile == pytest.approx(1.0, abs=0.5)
    assert found.rms == pytest.approx(0.004 * np.sqrt(np.mean(wave**2)), rel=0.1)
    off = one.sides(found.field) - 0.004 * wave
    # One amplitude pair of twelve teeth: at most two twelfths of the noise's variance; smoothing takes some form.
    assert np.sqrt(np.mean(off**2)) < NOISE / np.sqrt(COUNT) * np.sqrt(2.0 / TEETH) + 0.1 * 0.004


@pytest.mark.parametrize("waves", [0.0, 1.0, 2.0, 3.0])
def test_waves_along_the_face_come_back(waves):
    one, rng = grid(0.8), np.random.default_rng(2)
    at = sides_of(one)
    sheets = 0.004 * np.cos(2.0 * np.pi * (waves * at.z + 3.0 * at.tooth / TEETH))
    (found,) = search(one, sheets + noisy(one, rng, sheets.shape))
    assert found.order == 3
    assert found.waves_z == pytest.approx(waves, abs=0.3)
    assert found.waves_profile < 0.5
    assert found.p_value < 1e-6


@pytest.mark.parametrize(("waves", "course"), [(None, "sloping or bowed"), (0.0, "even"), (2.0, "wavelength 7.5 mm")])
def test_what_has_no_wave_on_a_flank_is_called_none(waves, course):
    one, rng = grid(0.8), np.random.default_rng(2)
    at = sides_of(one)
    along = 2.0 * at.z - 1.0 if waves is None else np.cos(2.0 * np.pi * waves * at.z)
    sheets = 0.004 * along * np.cos(2.0 * np.pi * 3.0 * at.tooth / TEETH)
    (found,) = search(one, sheets + noisy(one, rng, sheets.shape))
    assert f", {course} along z, even along the profile, " in found.describe(15.0)


@pytest.mark.parametrize(
    ("order", "said"), [(0, "the same on every tooth"), (1, "1 wave round the gear"), (5, "5 waves round the gear")]
)
def test_waves_round_the_gear_are_counted_in_words(order, said):
    pattern = Pattern(order, "alike", 0.0, 0.0, 0.002, 0.004, 1e-9, np.zeros(3))
    assert pattern.describe(15.0).startswith(f"{said}, flanks alike, ")


def test_two_orders_are_told_apart_the_stronger_first():
    one, rng = grid(), np.random.default_rng(3)
    at = sides_of(one)
    first = 0.006 * np.cos(2.0 * np.pi * (2.0 * at.tooth / TEETH + at.across))
    second = 0.003 * np.cos(2.0 * np.pi * (5.0 * at.tooth / TEETH + at.z))
    found = search(one, first + second + noisy(one, rng, first.shape))
    assert sorted(pattern.order for pattern in found) == [2, 5]
    for pattern in found:
        true = first if pattern.order == 2 else second
        assert np.corrcoef(one.sides(pattern.field).ravel(), true.ravel())[0, 1] > 0.95


def test_cells_out_of_use_do_not_hide_a_pattern():
    one, rng = grid(), np.random.default_rng(4)
    at = sides_of(one)
    sheets = 0.005 * np.cos(2.0 * np.pi * 2.0 * at.tooth / TEETH) + noisy(one, rng, at.z.shape)
    sheets[3, 0, 2:6] = np.nan
    (found,) = search(one, sheets)
    assert found.order == 2


def test_in_exact_data_the_pattern_is_all_there_is():
    one = grid()
    wave = 0.004 * np.cos(2.0 * np.pi * 2.0 * sides_of(one).tooth / TEETH)
    (found,) = search(one, wave)
    assert (found.order, found.rms) == (2, pytest.approx(0.004 * np.sqrt(0.5), rel=1e-3))
    assert search(one, 0.0 * wave) == ()


def false_patterns(draw, draws=200, size=2.5):
    """Scans of noise alone in which a pattern is found."""
    one, rng = grid(size), np.random.default_rng(5)
    shape = (TEETH, 2, one.rows, one.fillet + one.flank)
    return sum(bool(search(one, draw(one, rng, shape))) for _ in range(draws))


def textured(one, rng, shape):
    """Every side its own field that hangs together over a few cells, twice as strong as the noise of a cell."""
    field = rng.normal(size=shape)
    for axis, step in ((2, 0.6), (3, 0.6)):
        field = np.moveaxis(field, axis, 0)
        for i in range(1, len(field)):
            field[i] = step * field[i - 1] + np.sqrt(1.0 - step**2) * field[i]
        field = np.moveaxis(field, 0, axis)
    return 2.0 * NOISE / np.sqrt(COUNT) * field + noisy(one, rng, shape)


@pytest.mark.long
@pytest.mark.parametrize("draw", [noisy, textured], ids=["white", "textured"])
def test_noise_has_a_pattern_in_one_scan_of_a_hundred_at_most(draw):
    # At 1 %, 200 scans give 2 on average and more than 6 in one case of 200.
    assert false_patterns(draw) <= 6


def test_too_few_repetitions_are_not_judged():
    one = grid()
    planar = np.zeros((TEETH, 2, 2, one.fillet + one.flank))
    assert planar.shape[2] < 3
    two_rows = type(one)(one.gear, one.size, 2, one.flank, one.fillet, one.tip, one.root, one.ring, one.fillet_radius)
    assert find_patterns(two_rows, np.ones(two_rows.count), np.ones(two_rows.count, bool), NOISE) == ()


def test_the_share_of_an_order_is_parsevals():
    one = grid()
    at = sides_of(one)
    angle = 2.0 * np.pi * at.tooth / TEETH
    field = one.on_cells(3.0 * np.cos(2.0 * angle) + 4.0 * np.sin(5.0 * angle) + 0.0 * at.z)
    assert order_share(one, field, 2) == pytest.approx(9.0 / 25.0, rel=1e-3)
    assert order_share(one, field, 5) == pytest.approx(16.0 / 25.0, rel=1e-3)
    assert order_share(one, field, 3) == pytest.approx(0.0, abs=1e-9)


def test_what_was_found_of_one_order_in_two_steps_is_one_structure():
    """Two waves of an order, a sixth of a wave apart, are one wave of √3 of their height; another order stays what it is."""
    one = grid()
    at = sides_of(one)
    first, second = (0.004 * np.cos(2.0 * np.pi * (2.0 * at.tooth / TEETH + shift)) for shift in (0.0, 1.0 / 6.0))
    other = 0.002 * np.cos(2.0 * np.pi * 5.0 * at.tooth / TEETH)
    parts = [(first, 2, 1e-9), (other, 5, 1e-5), (second, 2, 1e-12)]
    whole = joined(one, tuple(Pattern.of(one, one.on_cells(field), order, p) for field, order, p in parts))
    assert [pattern.order for pattern in whole] == [2, 5]
    assert whole[0].rms == pytest.approx(0.004 * np.sqrt(3.0) / np.sqrt(2.0), rel=1e-9)
    assert whole[0].p_value == 1e-12
    assert whole[1].rms == pytest.approx(0.002 / np.sqrt(2.0), rel=1e-9)
    np.testing.assert_allclose(one.sides(whole[0].field), first + second, atol=1e-15)


@pytest.mark.parametrize("order", [0, 2, 6])
def test_a_tooth_is_left_out_of_the_sums(order):
    """As where none of its cells was seen: it takes no part in the pattern that it is held against."""
    one, rng = grid(), np.random.default_rng(order)
    sheets = rng.normal(size=sides_of(one).tooth.shape)
    sheets[rng.random(sheets.shape) < 0.1] = np.nan
    gains = []
    for tooth in range(TEETH):
        without = sheets.copy()
        without[tooth] = np.nan
        gains.append(np.nanmean(sheets[tooth] ** 2 - (sheets[tooth] - _order_map(without, order, 1.0)[tooth]) ** 2))
    mean, errors = _gain_on_left_out_teeth(sheets, order, 1.0)
    assert mean == pytest.approx(np.mean(gains), rel=1e-9)
    assert errors == pytest.approx(np.mean(gains) / np.std(gains, ddof=1) * np.sqrt(TEETH), rel=1e-9)
