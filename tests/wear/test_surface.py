"""The surface between the points: hollows of known volume, points thrown on them at random, and the ± of what is found."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from scipy import fft, stats

from gearwear.wear.stiffness import (
    APART,
    STIFFNESS,
    TENSION,
    Stiffness,
    likeliest,
    likeliest_of_cosines,
    penalised,
    shares_of_likelihood,
)
from gearwear.wear.surface import (
    SideSurface,
    _at_points,
    _differences,
    _from_other_end,
    _information,
    _numbers,
    _over_cells,
    _over_windows,
    _precision,
)

NOISE = 0.004
SHAPE = (13, 8)


def hollow(z, x, shape, depth, middle):
    """cos² to nothing at 0.36 of the rows and of the columns from its middle, mm; places in cells."""
    far = np.hypot((z - middle[0]) / (0.36 * shape[0]), (x - middle[1]) / (0.36 * shape[1]))
    return np.where(far < 1.0, -depth * np.cos(0.5 * math.pi * np.minimum(far, 1.0)) ** 2, 0.0)


def hollow_volume(shape, depth):
    """∫ cos²(π r / 2) over the unit circle is π / 2 − 2 / π."""
    return depth * 0.36**2 * shape[0] * shape[1] * (0.5 * math.pi - 2.0 / math.pi)


def cells_of(random, shape, density, surface, without=None):
    """Means, counts and offsets of points at random on a sheet of cells; `without` takes points away."""
    number = random.poisson(density * shape[0] * shape[1])
    z, x = random.uniform(0.0, shape[0], number), random.uniform(0.0, shape[1], number)
    if without is not None:
        z, x = z[~without(z, x)], x[~without(z, x)]
    y = surface(z, x) + NOISE * random.standard_normal(len(z))
    cell = z.astype(int) * shape[1] + x.astype(int)
    count = np.bincount(cell, minlength=shape[0] * shape[1]).reshape(shape).astype(float)

    def mean(values):
        with np.errstate(invalid="ignore"):
            return np.bincount(cell, values, minlength=count.size).reshape(shape) / count

    row, column = np.indices(shape)
    return mean(y), count, np.stack([mean(z) - row - 0.5, mean(x) - column - 0.5])


def found(mean, count, offset, worn):
    with np.errstate(divide="ignore"):
        return SideSurface.of(mean, count, NOISE**2 / np.maximum(count, 1.0), offset, worn)


@pytest.mark.parametrize(
    ("shape", "density", "depth", "hole"),
    [(SHAPE, 2.5, 0.05, 0.0), (SHAPE, 2.5, 0.2, 0.0), (SHAPE, 2.5, 0.05, 1.5), ((26, 14), 4.0, 0.05, 2.5)],
    ids=["thin", "thin and deep", "with a hole", "dense, with a hole"],
)
def test_the_volume_of_a_hollow_lies_within_its_deviation(shape, density, depth, hole):
    """The sum of squared pulls of forty scans between the 0.0001 and the 0.9999 quantile of χ², their mean within four of its own; and the ± is a tenth
    at most where nothing is hidden."""
    random, pulls = np.random.default_rng(5), []
    true = hollow_volume(shape, depth)
    for _ in range(40):
        middle = np.array(shape) * random.uniform(0.44, 0.56, 2)
        glare = np.array(shape) * random.uniform(0.0, 1.0, 2)
        mean, count, offset = cells_of(
            random, shape, density, lambda z, x, m=middle: hollow(z, x, shape, depth, m),
            lambda z, x, g=glare: np.hypot(z - g[0], x - g[1]) < hole,
        )  # fmt: skip
        row, column = np.indices(shape) + 0.5
        surface = found(mean, count, offset, np.hypot((row - middle[0]) / shape[0], (column - middle[1]) / shape[1]) < 0.42)
        weights, hidden = surface.shares(np.ones(shape))
        noise = float((weights**2 * NOISE**2 / np.maximum(count, 1.0)).sum())
        pulls.append((-surface.value.sum() - true) / math.sqrt(noise + hidden))
        assert hole > 0.0 or math.sqrt(noise + hidden) < 0.15 * true
    low, high = stats.chi2.ppf([0.0001, 0.9999], 40)
    assert low < np.sum(np.square(pulls)) < high
    assert abs(np.mean(pulls)) < 4.0 / math.sqrt(40.0)


@pytest.mark.parametrize("density", [0.1, 0.15, 0.25])
def test_of_a_few_points_the_volume_lies_within_its_deviation(density):
    """Some 10 to 25 points on a flank, one of them in the deeper half of the hollow: the mean square of a hundred pulls is that of a Gauss at most, as far
    as that many tell (χ², 0.999), and at least nine in ten are no more than 1.96."""
    random, pulls = np.random.default_rng(9), []
    while len(pulls) < 100:
        middle = np.array(SHAPE) * random.uniform(0.4, 0.6, 2)
        mean, count, offset = cells_of(random, SHAPE, density, lambda z, x, m=middle: hollow(z, x, SHAPE, 0.2, m))
        if (surface := found(mean, count, offset, count > 0)) is None or np.nanmin(mean) > -0.1:
            continue
        weights, hidden = surface.shares(np.ones(SHAPE))
        noise = float((weights**2 * NOISE**2 / np.maximum(count, 1.0)).sum())
        pulls.append((-surface.value.sum() - hollow_volume(SHAPE, 0.2)) / math.sqrt(noise + hidden))
    assert np.sum(np.square(pulls)) < stats.chi2.ppf(0.999, 100)
    assert np.mean(np.abs(pulls) < 1.96) > 0.9


def test_each_stiffness_counts_with_its_share_of_the_likelihood():
    """−2 log likelihoods that are told: exp of minus half of them, over their sum, without what is below a hundredth of the greatest."""
    cost = {Stiffness(-1.0, -1.0, 0.1): 2.0, Stiffness(2.0, 2.0, 1.0): 4.0}
    shares = shares_of_likelihood(lambda stiffness: cost.get(stiffness, 19.0))
    assert list(shares.values()) == pytest.approx([1.0 / (1.0 + math.exp(-1.0)), 1.0 / (1.0 + math.e)])
    assert list(shares) == list(cost)


def test_surfaces_are_drawn_of_every_stiffness_that_a_few_cells_leave_open():
    """Their integral scatters as it is said to: by what the points and the surface leave open at each stiffness, and by which it is."""
    random = np.random.default_rng(9)
    mean, count, offset = cells_of(random, SHAPE, 0.1, lambda z, x: hollow(z, x, SHAPE, 0.2, (6.0, 4.0)))
    surface, area = found(mean, count, offset, count > 0), _over_cells(SHAPE).T @ np.ones(count.size)
    share = np.array([way.share for way in surface.ways])
    assert share.sum() == pytest.approx(1.0)
    whole = np.array([area @ way.solve(area) for way in surface.ways])
    by_points = np.array([(surface.weight * (surface.at @ way.solve(area)) ** 2).sum() for way in surface.ways])
    expected = np.array([area @ way.expected for way in surface.ways])
    apart = share @ (expected - share @ expected) ** 2
    hidden = surface.shares(np.ones(SHAPE))[1]
    assert hidden == pytest.approx(share @ (whole - by_points) + apart, rel=1e-9)
    assert apart > 0.1 * hidden
    integrals = (_over_cells(SHAPE) @ surface._drawn(SHAPE)).sum(axis=0)
    assert integrals.var() == pytest.approx(share @ whole + apart, rel=4.0 * math.sqrt(2.0 / len(integrals)))


def test_weights_are_those_of_the_volume_and_keep_a_level():
    """The integral is the weighted sum of the cells' means, and one of all of them by 1 moves it by the area."""
    random = np.random.default_rng(6)
    mean, count, offset = cells_of(random, SHAPE, 1.5, lambda z, x: hollow(z, x, SHAPE, 0.1, (6.0, 4.0)))
    area = random.uniform(0.5, 1.0, SHAPE) * (np.indices(SHAPE)[0] > 3)
    surface = found(mean, count, offset, np.ones(SHAPE, dtype=bool))
    weights, hidden = surface.shares(area)
    assert not weights[count == 0].any()
    assert hidden > 0.0
    assert weights.sum() == pytest.approx(area.sum(), rel=1e-6)
    assert (weights * np.nan_to_num(mean)).sum() == pytest.approx((surface.value * area).sum(), rel=1e-6)


def test_the_curve_of_a_planar_section():
    """One row: a raised cosine over half of it, of which every third cell is not seen."""
    columns, depth = 60, 0.05
    place = np.arange(columns) + 0.5
    true = -0.5 * depth * (1.0 + np.cos(2.0 * math.pi * np.clip((place - 30.0) / 30.0, -0.5, 0.5)))
    random = np.random.default_rng(7)
    count = np.where(np.arange(columns) % 3, 4.0, 0.0)[None]
    noise = 0.5 * NOISE * random.standard_normal(columns)
    mean = np.where(count > 0, true + noise, np.nan)
    surface = found(mean, count, np.zeros((2, 1, columns)), np.ones((1, columns), dtype=bool))
    weights, hidden = surface.shares(np.ones((1, columns)))
    std = math.sqrt(float((weights**2 * NOISE**2 / 4.0).sum()) + hidden)
    assert abs(-surface.value.sum() - 15.0 * depth) < 4.0 * std
    assert std < 0.05 * 15.0 * depth


def test_a_side_of_a_few_cells_says_nothing():
    mean = np.full(SHAPE, np.nan)
    mean[2, :3] = 0.0
    assert found(mean, np.nan_to_num(mean + 3.0), np.zeros((2, *SHAPE)), np.ones(SHAPE, dtype=bool)) is None


def test_what_is_hidden_is_what_the_surface_may_be_beside_the_expected_one():
    """uᵀQu by matrices written out, Q all of A that is no data."""
    random = np.random.default_rng(8)
    mean, count, offset = cells_of(random, SHAPE, 1.5, lambda z, x: hollow(z, x, SHAPE, 0.1, (6.0, 4.0)))
    surface = found(mean, count, offset, np.ones(SHAPE, dtype=bool))
    (only,) = surface.ways
    number = only.factor.shape[1]
    triangle = np.zeros((number, number))
    for below, band in enumerate(only.factor):
        triangle[np.arange(below, number), np.arange(number - below)] = band[: number - below]
    whole = triangle @ triangle.T
    u = np.linalg.solve(whole, _over_cells(SHAPE).T @ np.ones(count.size))
    assert surface.shares(np.ones(SHAPE))[1] == pytest.approx(
        u @ (whole - (surface.at.T * surface.weight @ surface.at).toarray()) @ u, rel=1e-6
    )


def test_the_mean_of_a_full_cell_is_that_of_the_cell_and_of_one_point_the_spline_there():
    seen = np.ones((5, 6), dtype=bool)
    middle = np.zeros((2, 5, 6))
    full = _at_points(seen, middle, np.full(seen.shape, 1e12)).toarray()
    assert full == pytest.approx(_over_cells((5, 6)).toarray(), abs=1e-9)
    alone = _at_points(seen, middle, np.ones(seen.shape)).toarray()
    assert np.sort(alone[0])[-9:] == pytest.approx(np.sort(np.outer([0.125, 0.75, 0.125], [0.125, 0.75, 0.125]).ravel()))


@pytest.mark.parametrize("wide", [0.4, 1.0, 2.7, 9.0])
def test_windows_take_the_mean_of_a_straight_line_at_their_middles(wide):
    """A quadratic spline of coefficients that rise evenly is that line; every window lies on the sheet."""
    cells, mean = _over_windows(9, wide)
    np.testing.assert_allclose(mean.sum(axis=1), 1.0, atol=1e-14)
    middle = mean @ (np.arange(11) - 0.5)
    np.testing.assert_allclose([middle[0], middle[-1]], [0.5 * wide, 9.0 - 0.5 * wide], atol=1e-12)
    assert (cells[0] == np.minimum(np.floor(middle + 1e-9), 8)).all()
    assert (cells[1] == 8 - cells[0][::-1]).all()  # from the other end


@pytest.mark.parametrize(("density", "depth"), [(2.5, 0.05), (6.0, 0.05)])
def test_the_deepest_mean_of_a_hollow_lies_within_its_deviation(density, depth):
    """Over 1.5 × 1.5 cells at its middle; the squared pulls of forty scans below the 0.9999 quantile of χ². A surface that is as stiff everywhere reads
    a peak shallow, by less than its deviation."""
    z, x = np.meshgrid(*[middle + np.linspace(-0.75, 0.75, 301) for middle in (6.6, 3.9)], indexing="ij")
    random, pulls = np.random.default_rng(6), []
    true = hollow(z, x, SHAPE, depth, (6.6, 3.9)).mean()
    inside = np.ones(SHAPE, dtype=bool)
    for _ in range(40):
        cells = cells_of(random, SHAPE, density, lambda z, x: hollow(z, x, SHAPE, depth, (6.6, 3.9)))
        surface = found(*cells, inside)
        value, std = surface.deepest((1.5, 1.5), inside)
        pulls.append((value - true) / std)
    assert np.sum(np.square(pulls)) < stats.chi2.ppf(0.9999, 40)
    assert abs(np.mean(pulls)) < 1.0


@pytest.mark.parametrize("shape", [(13, 8), (8, 13)])
@pytest.mark.parametrize("lean", [0.0, 0.05])
def test_the_deepest_mean_is_the_least_of_all_windows_of_all_draws(shape, lean):
    """By every window of every draw written out: alike along the profile, where any may be the least, and so steep that few columns can."""
    random, edge = np.random.default_rng(10), np.indices(shape)[0] > 2
    cells = cells_of(random, shape, 4.0, lambda z, x: lean * x)
    surface = found(*cells, np.ones(shape, dtype=bool))
    (rows, along), (columns, across) = (_over_windows(count, wide) for count, wide in zip(shape, (1.5, 2.0), strict=True))
    means = np.kron(along, across) @ surface._drawn(shape)[_numbers(shape).ravel()]
    there = np.any([edge[np.ix_(row, column)] for row, column in product(rows, columns)], axis=0).ravel()
    least = means[there].min(axis=0) + surface.level
    assert surface.deepest((1.5, 2.0), edge) == pytest.approx((least.mean(), least.std()), rel=1e-9)


def test_where_nothing_is_worn_the_deepest_place_is_not_what_chance_makes_of_it():
    """The least of so many cells lies two of their deviations low, that of the surface much less."""
    random, inside = np.random.default_rng(7), np.ones(SHAPE, dtype=bool)
    values = []
    for _ in range(20):
        cells = cells_of(random, SHAPE, 6.0, lambda z, x: np.zeros_like(z))
        values.append(found(*cells, inside).deepest((1.0, 1.0), inside)[0])
    assert -0.7 * NOISE / math.sqrt(6.0) < np.mean(values) <= 0.0


def test_a_strip_at_the_edge_where_no_window_has_its_middle_says_nothing_of_the_deepest_place():
    random, edge = np.random.default_rng(8), np.zeros(SHAPE, dtype=bool)
    edge[0] = True
    cells = cells_of(random, SHAPE, 6.0, lambda z, x: np.zeros_like(z))
    assert np.isnan(found(*cells, np.ones(SHAPE, dtype=bool)).deepest((5.0, 1.0), edge)).all()


@pytest.mark.parametrize("seed", range(6))
def test_of_cells_seen_alike_the_likeliest_stiffness_is_that_of_the_whole_grid(seed):
    """Waves of two sizes and noise, every stiffness tried: none has a likelihood twice as large as what the search ends at, or what the cosines say."""
    random, shape = np.random.default_rng(seed), (17, 12)
    row, column = np.indices(shape) + 0.5
    size, phase = random.uniform(3.0, 20.0, 3), random.uniform(0.0, 6.0, 3)
    value = 0.02 * np.sin(column / size[0] + phase[0]) * np.cos(row / size[1] + phase[1]) + 0.01 * np.sin(
        row / size[2] + phase[2]
    )
    value += NOISE * random.standard_normal(shape)
    square = (fft.dctn(value, norm="ortho") / NOISE).ravel()[1:] ** 2
    along, across = (2.0 - 2.0 * np.cos(math.pi * np.arange(count) / count) for count in shape)
    asked = []

    def cost(stiffness):
        asked.append(stiffness)
        variance = 1.0 + 1.0 / penalised((along, across), stiffness)
        return float((np.log(variance) + square / variance).sum())

    grid = [
        Stiffness(0.5 * a, 0.5 * b, tension)
        for a, b, tension in product(range(2 * STIFFNESS[0], 2 * STIFFNESS[-1] + 1), range(2 * STIFFNESS[0], 2 * STIFFNESS[-1] + 1), TENSION)
        if abs(a - b) <= 2 * APART
    ]  # fmt: skip
    least = min(map(cost, grid))
    assert cost(likeliest_of_cosines(np.ones(shape, dtype=bool), value.ravel(), NOISE**-2)) < least + 2.0 * math.log(2.0)
    asked.clear()
    assert cost(likeliest(cost, Stiffness(0.0, 0.0, 0.1))) < least + 2.0 * math.log(2.0)
    # Each is a factorization, and a comparison has hundreds of surfaces: nothing twice.
    assert len(asked) - 1 == len(set(asked)) < 0.05 * len(grid)


def test_the_deepest_mean_is_the_same_from_either_end_of_the_face():
    random, worn = np.random.default_rng(3), np.ones(SHAPE, dtype=bool)
    mean, count, offset = cells_of(random, SHAPE, 2.5, lambda z, x: hollow(z, x, SHAPE, 0.05, (8.0, 4.0)))
    turned = offset[:, ::-1] * np.array([-1.0, 1.0])[:, None, None]
    way = found(mean, count, offset, worn).deepest((1.5, 1.5), worn)
    assert way == pytest.approx(found(mean[::-1], count[::-1], turned, worn).deepest((1.5, 1.5), worn), rel=1e-9)


def written_out(bands):
    """A symmetric matrix, (n, n), of its lower bands."""
    size = bands.shape[1]
    matrix = np.zeros((size, size))
    for below, band in enumerate(bands):
        matrix[np.arange(below, size), np.arange(size - below)] = band[: size - below]
        matrix[np.arange(size - below), np.arange(below, size)] = band[: size - below]
    return matrix


@pytest.mark.parametrize("shape", [(13, 8), (8, 13), (1, 12), (4, 2)])
@pytest.mark.parametrize("turned", [False, True])
def test_what_the_cells_tell_is_the_product_of_what_they_see(shape, turned):
    """BᵀWB, of dense matrices; cells here and there hold no points, one weighs nothing."""
    random = np.random.default_rng(4)
    seen = random.random(shape) < 0.8
    at = _at_points(seen, random.uniform(-0.4, 0.4, (2, *shape)), np.full(shape, 3.0))
    weight = random.uniform(0.5, 2.0, int(seen.sum())) * (np.arange(int(seen.sum())) > 0)
    b, n = at.toarray(), at.shape[1]
    expected, order = b.T @ (weight[:, None] * b), None
    if turned:
        order = _from_other_end(shape)
        expected = expected[np.ix_(np.argsort(order), np.argsort(order))]
    bands = _information(at, weight, min(2 * min(count + 2 if count > 1 else 1 for count in shape) + 3, n), order)
    np.testing.assert_allclose(written_out(bands), expected, rtol=1e-12, atol=1e-14)


def test_a_surface_is_as_stiff_as_it_is_told(monkeypatch):
    """Told what it found itself it is the same to the last digit, and no likelihood is asked; told to be stiff it is flat."""
    random = np.random.default_rng(9)
    mean, count, offset = cells_of(random, SHAPE, 4.0, lambda z, x: hollow(z, x, SHAPE, 0.05, (6.0, 4.0)))
    arguments = mean, count, NOISE**2 / np.maximum(count, 1.0), offset, np.ones(SHAPE, dtype=bool)
    own = SideSurface.of(*arguments)
    monkeypatch.setattr("gearwear.wear.surface.likeliest", None)
    np.testing.assert_array_equal(SideSurface.of(*arguments, as_stiff=own.as_stiff).value, own.value)
    stiff = SideSurface.of(*arguments, as_stiff={Stiffness(7.0, 7.0, 1.0): 1.0})
    assert np.ptp(stiff.value) < 1e-3 * np.ptp(own.value)


@pytest.mark.parametrize("shape", [(13, 8), (8, 13), (9, 9)])
@pytest.mark.parametrize(("along", "across"), [(-3.0, 1.0), (2.0, 0.5)])
def test_bending_costs_along_the_face_and_along_the_profile_what_the_stiffness_says(shape, along, across):
    """Without tension a wave along one way alone costs its own stiffness times the squares of its second differences; eigenvalues of the matrix written
    out."""

    def dense(tension):
        nothing = np.zeros((2 * min(shape) + 7, math.prod(count + 2 for count in shape)))
        return written_out(_precision(nothing, shape, 1.0, Stiffness(along, across, tension)))

    eigenvalues = np.sort(penalised(_differences(shape)[2], Stiffness(along, across, 0.1)))
    np.testing.assert_allclose(np.linalg.eigvalsh(dense(0.1))[1:], eigenvalues, rtol=1e-6, atol=1e-9)
    number = _numbers(shape)
    for axis, decade in enumerate((along, across)):
        wave = np.empty(number.size)
        wave[number] = np.cos(math.pi * (np.indices(number.shape)[axis] + 0.5) / number.shape[axis])
        bent = (2.0 - 2.0 * math.cos(math.pi / number.shape[axis])) ** 2 * wave @ wave
        assert wave @ dense(0.0) @ wave == pytest.approx(10.0**decade * bent)


@pytest.mark.parametrize(("way", "least", "most"), [("along", 4.0, 99.0), ("round", 0.5, 2.0), ("across", 0.0, 0.25)])
def test_a_groove_is_smoothed_along_itself(way, least, most):
    """A groove along the face or the profile, and a round hollow, cells of noise 2 µm: which way they are long is found, and a groove is told nearly as well
    as by the means of whole lines along it, which nobody who does not know that it is a groove would dare to take."""
    shape, random = (30, 18), np.random.default_rng(4)

    def form(z, x):
        if way == "round":
            return hollow(z / 30.0 * 18.0, x, (18, 18), 0.1, (9.0, 9.0))
        return -0.05 * np.exp(-0.5 * (((x if way == "along" else z) - 8.0) / 1.3) ** 2)

    row, column = np.indices((4 * shape[0], 4 * shape[1])) / 4.0 + 0.125
    true = form(row, column).reshape(shape[0], 4, shape[1], 4).mean(axis=(1, 3))
    cells = cells_of(random, shape, 4.0, form)
    surface = found(*cells, np.ones(shape, dtype=bool))
    assert least <= surface.ways[0].stiffness.stretch <= most
    off = float(np.sqrt(np.mean((surface.value - true) ** 2)))
    lines = {"along": shape[0], "across": shape[1], "round": 1}[way]
    assert off < 1.5 * 0.5 * NOISE / math.sqrt(lines)


def test_the_surface_of_a_sheet_laid_across_is_the_same_laid_across():
    random, shape = np.random.default_rng(5), (20, 13)
    mean, count, offset = cells_of(random, shape, 2.5, lambda z, x: -0.05 * np.exp(-0.5 * ((x - 6.0) / 1.5) ** 2))
    worn = np.ones(shape, dtype=bool)
    way, across = found(mean, count, offset, worn), found(mean.T, count.T, offset[::-1].swapaxes(1, 2), worn.T)
    assert across.ways[0].stiffness.stretch == pytest.approx(1.0 / way.ways[0].stiffness.stretch)
    np.testing.assert_allclose(across.value.T, way.value, atol=1e-12)
