"""A worn gear whose root a hob with protuberance left: points by rolling the tools past the blank, nothing of the fit's formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearwear as gw
from gearwear.arrays import Floats
from gearwear.design import Gear, GearSpec
from gearwear.design.pair import Design
from tests.design.cutting import cut_depth

SPEC = GearSpec(
    "gear", 20, 4.0, 12.0, dedendum=1.4, rack_tip_radius=0.3, protuberance=0.25, grinding_stock=0.1, bore_diameter=30.0
)
WORN = 0.05
"""mm off the left flanks of teeth 4 to 7, along the normal."""


def _outline(radius: Floats) -> Floats:
    """Angle of the outline from the space's centre line, by bisection between cut and not cut."""
    low, high = np.zeros_like(radius), np.full_like(radius, math.pi / SPEC.teeth)
    for _ in range(22):
        middle = 0.5 * (low + high)
        cut = cut_depth(SPEC, radius, middle) > 0.0
        low, high = np.where(cut, middle, low), np.where(cut, high, middle)
    return 0.5 * (low + high)


@pytest.fixture(scope="module")
def scan() -> tuple[Floats, float]:
    """45,000 points with 4 µm of scatter and the metal taken off, mm³."""
    rng = np.random.default_rng(12)
    m, z, b = SPEC.normal_module, SPEC.teeth, SPEC.face_width
    r, tip, root = 0.5 * m * z, 0.5 * m * (z + 2), 0.5 * m * (z - 2.8)
    base = r * math.cos(SPEC.normal_pressure_angle)
    table = root + (tip - root) * np.linspace(0.0, 1.0, 160) ** 1.7
    angle = _outline(table)
    rough = np.hypot(np.diff(table), table[1:] * np.diff(angle))
    along = np.concatenate([[0.0], np.cumsum(rough)])
    n = 30_000
    place = rng.uniform(0.0, along[-1], n)
    radius, space = np.interp(place, along, table), np.interp(place, along, angle)
    tooth, side, height = rng.integers(0, z, n), rng.choice([1, -1], n), rng.uniform(0.0, b, n)
    form = table[np.argmax(angle - (math.pi / z - _involute(r, base, table)) < 2e-6)]
    turn = np.where((side == 1) & (tooth >= 3) & (tooth <= 6) & (radius > form), WORN / base, 0.0)
    theta = tooth * 2.0 * math.pi / z + side * (math.pi / z - space - turn)
    sides = np.column_stack([radius * np.cos(theta), radius * np.sin(theta), height])
    top = float(math.pi / z - angle[-1])
    theta = rng.integers(0, z, 3000) * 2.0 * math.pi / z + rng.uniform(-top, top, 3000)
    lands = np.column_stack([tip * np.cos(theta), tip * np.sin(theta), rng.uniform(0.0, b, 3000)])
    far, theta = np.sqrt(rng.uniform(17.0**2, (root - 1.0) ** 2, 8000)), rng.uniform(0.0, 2.0 * math.pi, 8000)
    ends = np.column_stack([far * np.cos(theta), far * np.sin(theta), rng.choice([0.0, b], 8000)])
    theta = rng.uniform(0.0, 2.0 * math.pi, 4000)
    bore = np.column_stack([15.0 * np.cos(theta), 15.0 * np.sin(theta), rng.uniform(0.0, b, 4000)])
    points = np.concatenate([sides, lands, ends, bore]) + rng.normal(0.0, 0.004, (n + 15_000, 3))
    lost = 4.0 * b * WORN / base * 0.5 * (tip**2 - form**2)
    return points, lost


def _involute(r: float, base: float, radius: Floats) -> Floats:
    """Half angle of the unshifted tooth's involute."""
    alpha = np.arccos(np.minimum(base / radius, 1.0))
    at_r = math.acos(base / r)
    return math.pi / (2.0 * SPEC.teeth) + math.tan(at_r) - at_r - (np.tan(alpha) - alpha)


@pytest.mark.long
def test_wear_is_measured_from_the_ground_flank(scan, tmp_path):
    points, lost = scan
    file = tmp_path / "scan.xyz"
    np.savetxt(file, points, fmt="%.5f")
    report = gw.as_dict(gw.compare(Design({"gear": Gear.from_spec(SPEC)}, None), file, inspection=False))
    assert report["root"]["fits_design"]
    assert report["closed_loop"]["effects"] == []
    wear = report["wear"]
    assert wear["volume_mm3"]["value"] == pytest.approx(lost, abs=3.0 * wear["volume_mm3"]["std"])
    assert sorted((one["tooth"], one["flank"]) for one in wear["regions"]) == [(tooth, "left") for tooth in (4, 5, 6, 7)]
