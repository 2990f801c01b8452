"""Artefacts of known size: a known scale and layer put in and asked back."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison import before
from gearwear.comparison.artefact import calibrated, see
from gearwear.design import parse_design
from gearwear.design.scan_spec import Artefact
from gearwear.errors import InputError

GEAR = {"gear": {"teeth": 20, "module": 2.0, "face_width": 10.0}}
PLACES = {"sphere": (80.0, 5.0, 12.0), "cylinder": (-80.0, 0.0, 10.0), "ring": (0.0, 90.0, 10.0)}


def _surface(kind: str, diameter: float, n: int, rng: np.random.Generator, layer: float = 0.0) -> np.ndarray:
    """Points at the nominal place: of the sphere what lies above its stand, of the others the whole mantle, leaning by 3°."""
    turn = rng.uniform(0.0, 2.0 * math.pi, n)
    if kind == "sphere":
        height = rng.uniform(-0.5, 1.0, n)
        ring = np.sqrt(1.0 - height**2)
        way = np.column_stack([ring * np.cos(turn), ring * np.sin(turn), height])
        return np.array(PLACES[kind]) + (0.5 * diameter + layer) * way
    radius = 0.5 * diameter + (-layer if kind == "ring" else layer)
    z = rng.uniform(-0.3, 0.3, n) * diameter
    local = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])
    lean = math.radians(3.0)
    local[:, 1], local[:, 2] = (
        local[:, 1] * math.cos(lean) - local[:, 2] * math.sin(lean), local[:, 1] * math.sin(lean) + local[:, 2] * math.cos(lean),
    )  # fmt: skip
    return np.array(PLACES[kind]) + local


def _scan(kinds: dict[str, float], scale: float, layer: float, seed: int, noise: float = 0.005):
    rng = np.random.default_rng(seed)
    parts = [_surface(kind, diameter, 3000, rng, layer) for kind, diameter in kinds.items()]
    stand = np.array(PLACES["sphere"]) + np.column_stack([rng.uniform(-3, 3, (60, 2)), np.full(60, -14.0)])
    parts += [rng.uniform(-15.0, 15.0, (5000, 3)), stand]
    points = np.concatenate(parts) * (1.0 + scale)
    return gw.as_scan(points + rng.normal(0.0, noise, points.shape))


def _design(kinds: dict[str, float], std: float = 0.0):
    design = parse_design(GEAR)
    artefacts = tuple(Artefact(kind, diameter, PLACES[kind], std) for kind, diameter in kinds.items())
    return replace(design, datum=replace(design.datum, artefacts=artefacts))


SIZES = {"sphere": 25.4, "cylinder": 40.0, "ring": 30.0}


@pytest.mark.long
@pytest.mark.parametrize("kind", SIZES)
def test_a_scale_comes_back_from_one_artefact(kind):
    design, pulls = _design({kind: SIZES[kind]}), []
    for seed in range(6):
        scan = _scan({kind: SIZES[kind]}, 8e-4, 0.0, seed)
        scans, after = calibrated([scan], design)
        assert len(scans[0]) >= 5000 and scans[0].rejected["artefact"] >= 3000
        cube, left = scan.points[3000:8000], scans[0].points[:5000]  # what is no artefact
        assert np.abs(left).max() < 15.1
        found = float(np.linalg.norm(cube) / np.linalg.norm(left))
        assert after.scanner.scale_limit is not None
        pulls.append((found - 1.0008) / (after.scanner.scale_limit / 3.0))
    assert np.abs(pulls).max() < 4.0
    assert 0.2 < float(np.std(pulls)) < 2.5


def test_two_kinds_tell_scale_and_layer_apart():
    kinds = {"sphere": 25.4, "ring": 30.0}
    _, after = calibrated([_scan(kinds, -5e-4, 0.02, 1)], _design(kinds))
    said = after.datum.words[0]
    scale, layer = re.search(r"([+−]\d+) ± \d+ ppm", said), re.search(r"layer of ([+−][\d.]+) ±", said)
    assert scale is not None and layer is not None
    assert float(scale[1].replace("−", "-")) == pytest.approx(500.0, abs=40.0)
    assert float(layer[1].replace("−", "-")) == pytest.approx(20.0, abs=0.6)


@pytest.mark.parametrize("second", [25.0, 25.02, 25.2, 30.0])
def test_two_of_nearly_one_size_tell_the_scale_as_one_does(second):
    """σ / √(d₁² + d₂²) of one scale; a layer fitted beside it would make that √2 σ / (d₂ − d₁)."""
    rng, sizes, centres = np.random.default_rng(0), (25.0, second), ((80.0, 5.0, 12.0), (-80.0, 5.0, 12.0))
    parts = []
    for size, centre in zip(sizes, centres, strict=True):
        way = rng.normal(size=(3000, 3))
        parts.append(np.array(centre) + 0.5 * size * way / np.linalg.norm(way, axis=1)[:, None])
    points = np.concatenate(parts) * 1.0005 + rng.normal(0.0, 0.003, (6000, 3))
    design = _design({})
    artefacts = tuple(Artefact("sphere", size, centre, 5e-4) for size, centre in zip(sizes, centres, strict=True))
    scans, after = calibrated([gw.as_scan(points)], replace(design, datum=replace(design.datum, artefacts=artefacts)))
    assert len(scans[0]) == 0
    assert after.scanner.scale_std == pytest.approx(5e-4 / math.hypot(*sizes), rel=0.1)
    said = re.search(r"([+−]\d+) ± \d+ ppm", after.datum.words[0])
    assert said is not None
    assert float(said[1].replace("−", "-")) == pytest.approx(-500.0, abs=4e6 * after.scanner.scale_std)
    assert "too alike in size" in after.datum.words[0]


@pytest.mark.parametrize("stated", [25.0, 20.0])
def test_an_artefact_of_another_size_is_refused(stated):
    scan, design = _scan({"sphere": 25.4}, 0.0, 0.0, 1), _design({"sphere": stated})
    with pytest.raises(InputError, match=r"is seen as 25\.[34]\d+ mm, \d+ ppm off .* check diameter_mm") as refused:
        calibrated([scan], design)
    assert "\n" not in str(refused.value)
    wide = replace(design, scanner=replace(design.scanner, scale_limit=0.1))  # of whom states such a scanner, it is taken
    if stated == 25.0:
        assert "−1599" in calibrated([scan], wide)[1].datum.words[0]


def test_an_artefact_that_tells_no_scale_is_refused():
    with pytest.raises(InputError, match=r"tells the scale to ± .* a smaller std_um"):
        calibrated([_scan({"sphere": 25.4}, 0.0, 0.0, 1)], _design({"sphere": 25.4}, std=0.5))


def test_the_scan_before_wear_knows_of_its_scale_what_was_stated(monkeypatch):
    """It has no artefact: what the worn gear's tells is not known of it."""
    stated = _design({"sphere": 25.4})
    stated = replace(stated, scanner=replace(stated.scanner, scale_limit=0.003, scale_std=0.001))
    _, after = calibrated([_scan({"sphere": 25.4}, 1e-3, 0.0, 1)], stated)
    assert after.scanner.scale_limit is not None and after.scanner.scale_limit < 1e-4
    taken = []

    def registered(design, *_, **__):
        taken.append(design)
        raise InputError("far enough")

    monkeypatch.setattr(before, "register", registered)
    monkeypatch.setattr(before, "read_scan", lambda *_: ())
    worn = SimpleNamespace(design=after, part="gear", scans=(), cells=SimpleNamespace(grid=None))
    with pytest.raises(InputError, match="far enough"):
        before.unworn_gear(stated, worn, ["before.ply"], "mm", True)
    assert taken[0].scanner == stated.scanner
    assert taken[0].datum.artefacts == ()


def test_without_artefacts_nothing_changes():
    design, scan = parse_design(GEAR), _scan({"sphere": 25.4}, 1e-3, 0.0, 2)
    assert calibrated([scan], design) == ((scan,), design)


@pytest.mark.parametrize(
    ("artefact", "message"),
    [
        (Artefact("sphere", 25.4, (300.0, 0.0, 0.0)), "0 points lie there, at least 200 are needed"),
        (Artefact("sphere", 25.4, (0.0, 0.0, 0.0)), "what lies there is no sphere"),
    ],
)
def test_what_is_not_there_is_refused(artefact, message):
    with pytest.raises(InputError, match=message):
        see([_scan({"sphere": 25.4}, 0.0, 0.0, 3)], artefact)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"kind": "cube", "diameter_mm": 20.0, "centre_mm": [0, 0, 0]}, "kind = 'cube': one of sphere, cylinder, ring"),
        ({"kind": "sphere", "centre_mm": [0, 0, 0]}, "diameter_mm is missing"),
        ({"kind": "sphere", "diameter_mm": 20.0, "centre_mm": [0, 0]}, "centre_mm = [0, 0]: three numbers"),
        ({"kind": "sphere", "diameter_mm": -1.0, "centre_mm": [0, 0, 0]}, "artefact diameter_mm = -1 mm"),
        ({"kind": "sphere", "diameter_mm": 20.0, "centre_mm": [0, 0, 10**400]}, "must be a finite number"),
        ({"kind": "sphere", "diameter_mm": 20.0, "centre_mm": [0, 0, 0], "size": 1}, "artefact size is unknown"),
    ],
)
def test_wrong_tables_are_refused(table, message):
    with pytest.raises(InputError, match=re.escape(message)) as refused:
        parse_design({**GEAR, "datum": {"artefact": [table]}})
    assert "\n" not in str(refused.value)


def test_more_than_tables_are_needed():
    with pytest.raises(InputError, match=re.escape("up to 20 tables, written [[datum.artefact]]")):
        parse_design({**GEAR, "datum": {"artefact": 3}})
