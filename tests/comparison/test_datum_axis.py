"""Axes from stated bands and from end faces: a known offset and tilt put in and asked back."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.comparison.bore import band_axis, datum_axis, end_axis
from gearwear.design import parse_design
from gearwear.design.scan_spec import DatumBand
from gearwear.design.surface import END_HIGH, END_LOW, OTHER, SurfacePoints
from gearwear.errors import InputError

DESIGN = parse_design({"gear": {"teeth": 20, "module": 3.0, "face_width": 24.0}})
GEAR = DESIGN.gears["gear"]
BANDS = (DatumBand(25.0, -30.0, -18.0), DatumBand(30.0, 33.0, 45.0))
OFFSET, TILT = np.array([0.040, -0.025, 0.0]), np.array([4e-4, -6e-4, 0.0])


def _measured(points: SurfacePoints, bands: tuple[DatumBand, ...] = BANDS):
    design = replace(DESIGN, datum=replace(DESIGN.datum, bands=bands))
    return SimpleNamespace(design=design, gear=GEAR, loop=None, located=points)


def _moved(points: np.ndarray) -> np.ndarray:
    """By the offset and the tilt about z = 0."""
    return points + OFFSET + np.cross(TILT, points)


def _seats(seed: int = 1, keyway: bool = False) -> SurfacePoints:
    rng = np.random.default_rng(seed)
    parts = []
    for band in BANDS:
        turn, z = rng.uniform(0.0, 2.0 * math.pi, 2000), rng.uniform(band.low - 4.0, band.high + 4.0, 2000)
        radius = np.full(2000, 0.5 * band.diameter + 0.006)
        if keyway:
            radius -= np.where((turn > 1.0) & (turn < 1.4), 0.3, 0.0)
        parts.append(np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z]))
    points = _moved(np.concatenate(parts)) + rng.normal(0.0, 0.004, (4000, 3))
    n = len(points)
    return SurfacePoints(
        np.full(n, OTHER, np.int8), np.zeros(n, np.int32), np.zeros(n, np.int8), np.full(n, np.nan), points, np.zeros((n, 3)), np.full(n, np.nan)
    )  # fmt: skip


@pytest.mark.parametrize("keyway", [False, True])
def test_bands_tell_offset_and_tilt(keyway):
    axis = band_axis(_measured(_seats(keyway=keyway)))
    error = axis.motion - np.concatenate([OFFSET, TILT])
    std = np.sqrt(np.diag(axis.covariance))
    for at in (0, 1, 3, 4):
        assert abs(error[at]) < 4.0 * std[at] + 1e-6, at  # a tilt is of first order: 1e-7 of 40 mm
    assert axis.smaller == pytest.approx(0.006, abs=5e-4)
    assert std[0] < 1e-3 and std[3] < 3e-5


def _ends(seed: int = 2) -> SurfacePoints:
    rng = np.random.default_rng(seed)
    turn, radius = rng.uniform(0.0, 2.0 * math.pi, 3000), rng.uniform(6.0, 24.0, 3000)
    high = rng.random(3000) < 0.5
    up = np.where(high, 1.0, -1.0)
    foot = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.where(high, 24.0, 0.0)])
    normal = np.column_stack([np.zeros((3000, 2)), up])
    deviation = (_moved(foot) - foot)[:, 2] * up + 0.01 + rng.normal(0.0, 0.004, 3000)
    surface = np.where(high, END_HIGH, END_LOW).astype(np.int8)
    nothing = np.zeros(3000, np.int32)
    return SurfacePoints(surface, nothing, nothing.astype(np.int8), np.full(3000, np.nan), foot, normal, deviation)


def test_ends_tell_the_tilt_and_leave_the_middle_of_the_teeth():
    axis = end_axis(_measured(_ends()))
    std = np.sqrt(np.diag(axis.covariance))
    np.testing.assert_array_less(np.abs(axis.motion[3:5] - TILT[:2]), 4.0 * std[3:5])
    middle = np.array([0.0, 0.0, 12.0])
    np.testing.assert_allclose((axis.motion[:3] + np.cross(axis.motion[3:], middle))[:2], 0.0, atol=1e-12)
    assert axis.freedoms == (3, 4)


def _thin() -> SurfacePoints:
    """A seat of which 1 mm of height was seen, and one stray far off."""
    seats = _seats()
    z = seats.position[:, 2]
    return seats.take((np.abs(z + 24.0) < 0.5) | (np.arange(len(z)) == int(np.argmin(np.abs(z + 19.0)))))


@pytest.mark.parametrize(
    ("axis", "points", "bands", "message"),
    [
        ("bands", _seats(), (), "the design names none"),
        ("bands", _seats(), (DatumBand(60.0, 0.0, 9.0),), "0 points in 0 of 12 sectors"),
        ("bands", _seats(), (DatumBand(25.0, -30.0, -28.0),), "they were seen over 1.9"),
        ("bands", _thin(), (DatumBand(25.0, -30.0, 45.0),), "mm of height, whatever was stated; at least 3 mm tell a tilt"),
        ("ends", _seats(), (), "neither was seen all round"),
    ],
)
def test_what_was_not_seen_is_no_axis(axis, points, bands, message):
    with pytest.raises(InputError, match=re.escape(message)):
        datum_axis(_measured(points, bands), axis)


@pytest.mark.parametrize(
    ("datum", "message"),
    [
        ({"axis": "hub"}, "axis = 'hub': one of teeth, bore, bands, ends"),
        ({"band": [{"diameter_mm": 25.0, "z_mm": [3, 1]}]}, "band z_mm = [3, 1]: from the lower z"),
        ({"band": [{"diameter_mm": 25.0}]}, "band: z_mm is missing"),
        ({"band": [{"diameter_mm": 0.0, "z_mm": [0, 1]}]}, "band diameter_mm = 0 mm"),
        ({"band": {}}, "written [[datum.band]]"),
    ],
)
def test_wrong_tables_are_refused(datum, message):
    with pytest.raises(InputError, match=re.escape(message)):
        parse_design({"gear": {"teeth": 20, "module": 3.0, "face_width": 24.0}, "datum": datum})
