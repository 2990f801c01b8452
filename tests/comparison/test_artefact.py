"""Artefacts of known size: a known scale and layer put in and asked back."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.artefact import calibrated, see
from gearwear.design import parse_design
from gearwear.design.spec import Artefact
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


@pytest.mark.parametrize("kind", SIZES)
def test_a_scale_comes_back_from_one_artefact(kind):
    design, pulls = _design({kind: SIZES[kind]}), []
    for seed in range(6):
        scans, after = calibrated([_scan({kind: SIZES[kind]}, 8e-4, 0.0, seed)], design)
        assert len(scans[0]) >= 5000 and scans[0].rejected["artefact"] >= 3000
        assert after.scanner.scale_limit is not None
        std = after.scanner.scale_limit / 3.0
        box = np.abs(
            scans[0].points[:5000] if kind != "sphere" else scans[0].points
        ).max()  # the cube of 15 mm that is no artefact
        assert box < 15.1 or kind == "sphere"
        measured = see([_scan({kind: SIZES[kind]}, 8e-4, 0.0, seed)], design.datum.artefacts[0])
        pulls.append((measured.diameter / SIZES[kind] - 1.0008) / std)
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
