"""The bundled example is what its truth file says, and what its script would write."""

import gzip
import json
from pathlib import Path

import numpy as np
import pytest

from tests.synthetic import Outline, Rigid, removed_volume
from tests.synthetic.make_example import RECIPE, ply_bytes

FOLDER = Path(__file__).resolve().parents[2] / "gearwear" / "example"


def test_example_and_truth_belong_together():
    packed = (FOLDER / "scan.ply.gz").read_bytes()
    assert len(packed) < 1_600_000
    rows = gzip.decompress(packed).split(b"end_header\n")[1].split()
    points = np.array(rows, dtype=np.float64).reshape(-1, 3)
    truth = json.loads((FOLDER / "truth.json").read_text())
    assert len(points) == truth["points"] == sum(truth["counts"].values())
    assert ply_bytes(points) == gzip.decompress(packed)

    (pose,) = (Rigid(np.array(p["R"]), np.array(p["t"])) for p in truth["poses"])
    design = pose.inverse().apply(points)
    radius = np.hypot(design[:, 0], design[:, 1])
    tip = np.abs(radius - 44.468) < 0.05  # the coated tip circle; the flank's few points in the band widen it
    assert np.median(radius[tip]) == pytest.approx(44.468, abs=0.001)
    high = (np.abs(design[:, 2] - 15.018) < 0.05) & (radius < 30.0)
    scatter = 1.4826 * np.median(np.abs(design[high, 2] - np.median(design[high, 2])))
    assert scatter == pytest.approx(np.hypot(0.010, 0.002), rel=0.05)  # 5 000 points

    outline = Outline.of(RECIPE.gear)
    for flank in truth["flanks"]:
        volume = removed_volume(RECIPE.wear, outline, flank["tooth"], flank["side"])
        assert flank["volume_mm3"] == pytest.approx(volume, rel=1e-9)
    assert truth["volume_mm3"] == pytest.approx(sum(f["volume_mm3"] for f in truth["flanks"]))
    assert [e["name"] for e in truth["effects"]] == [e.name for e in RECIPE.effects]
