"""Where a drift began, found by trying every place: the errors against what is said of them."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from gearwear.design.surface import FILLET, FLANK, ROOT, TIP, locate
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import build_dictionary
from gearwear.diagnose.effects.coating import EFFECT as COATING
from gearwear.diagnose.effects.scan_drift import ScanDrift
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.jumps import jump_deviations
from gearwear.diagnose.loop import make_context
from gearwear.placing.cells import CellGrid, bin_points
from tests.placing.placing import designed
from tests.synthetic import Recipe, make_scan

GEAR = designed()
NOISE = 0.006
ON_FLANK = float(GEAR.half_angle(GEAR.reference_radius))


@dataclass(frozen=True)
class DriftFrom(ScanDrift):
    """A drift that began at one place."""

    start: float = 0.0

    def shapes(self, context):
        return [(self.start,)]


@cache
def clean():
    """Cells of a gear as drawn, and what is known of them."""
    scan = make_scan(Recipe(jitter=1.0, noise_um=1e3 * NOISE, pose="none").of_size(8_000), 5)
    located = locate(scan.points, GEAR)
    cells = bin_points(
        located.take(np.isin(located.surface, (FLANK, FILLET, ROOT, TIP))), CellGrid.for_scan(GEAR, len(located)), clip=0.3
    )
    return cells, make_context(cells, np.eye(3), False)


def sawtooth(start: float, closure: float) -> np.ndarray:
    """What a drift does to the cells, mm: the turn at their own angle, times their way round the axis along the normal."""
    points = clean()[0].points
    x, y, _ = points.position.T
    share = np.mod(np.arctan2(y, x) - start, 2.0 * np.pi) / (2.0 * np.pi)
    return closure * (share - 0.5) * (x * points.normal[:, 1] - y * points.normal[:, 0])


def found(start: float, closure: float, seed: int) -> tuple[float, float]:
    """Error of the place that explains most, rad, and the standard deviation that is told."""
    cells, context = clean()
    white = NOISE**2 / np.maximum(cells.count, 1.0)
    noise = np.sqrt(white) * np.random.default_rng(seed).normal(size=len(white))
    target = np.where(cells.seen, np.nan_to_num(sawtooth(start, closure)) + noise, 0.0)
    pose = cells.motion[cells.seen] / np.sqrt(white[cells.seen])[:, None]
    base = np.linalg.qr(np.nan_to_num(pose))[0]

    def left(values: np.ndarray) -> np.ndarray:
        scaled = values[cells.seen] / np.sqrt(white[cells.seen])
        return scaled - base @ (base.T @ scaled)

    aim, places = left(target), start + GEAR.pitch_angle * np.linspace(-1.5, 1.5, 73)
    columns = [left(np.nan_to_num(sawtooth(place, 1.0))) for place in places]
    best = float(places[np.argmax([(column @ aim) ** 2 / (column @ column) for column in columns])])
    fit = Fit(
        cells, target, build_dictionary(cells, (DriftFrom(start=best), COATING), context), cells.seen, CellCovariance(cells.grid, white, 0.0, 0.5, 0.5)
    )  # fmt: skip
    (told,) = jump_deviations(fit, fit.dictionary.candidates[:1], 0, 1.0, context)
    return best - start, float(told)


@pytest.mark.long
@pytest.mark.parametrize("closure", [pytest.param(4e-4, marks=pytest.mark.long), 1.5e-4], ids=["sure", "less sure"])
def test_the_place_of_a_seam_is_known_as_well_as_it_is_said(closure):
    """Begun anywhere: the errors in their own standard deviations are 1, within what 40 of them tell."""
    starts = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 40)
    errors, told = np.transpose([found(float(start), closure, seed) for seed, start in enumerate(starts)])
    assert 0.6 < np.sqrt(np.mean((errors / told) ** 2)) < 1.3
    assert np.abs(errors / told).max() < 4.0
    assert np.median(told) < 0.25 * GEAR.pitch_angle


def test_where_no_surface_shows_it_a_seam_may_be_anywhere():
    """Points of a tip land do not move when they turn: a jump among them leaves no trace; nearly uniform over the land."""
    land = 2.0 * float(GEAR.half_angle(GEAR.tip_radius))
    error, told = found(0.25 * land, 2e-3, 1)
    assert abs(error) < land
    assert land / math.sqrt(12.0) < told < land / math.sqrt(2.0)
    assert found(ON_FLANK, 2e-3, 1)[1] < 0.5 * told


def test_what_does_not_jump_has_no_such_place():
    cells, context = clean()
    fit = Fit(
        cells,
        np.zeros(len(cells.seen)),
        build_dictionary(cells, (COATING,), context),
        cells.seen,
        CellCovariance(cells.grid, np.ones(len(cells.seen)), 0.0, 0.5, 0.5),
    )
    assert jump_deviations(fit, fit.dictionary.candidates, 0, 1.0, context) is None
