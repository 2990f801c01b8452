"""The scan that all measurements use: half a million points of a used pinion, made by the generator of the tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.synthetic import Recipe, SyntheticScan, make_scan
from tests.synthetic.make_example import RECIPE, SEED

POINTS = 488_000
DESIGN = Path(__file__).resolve().parents[2] / "gearwear" / "example" / "design.toml"


def used_pinion(points: int = POINTS) -> SyntheticScan:
    """Drive flanks worn by sliding, one of them in a deep patch too; 10 µm noise, texture, outliers, a hole; an unknown pose.

    The scanner makes no systematic error: peers have nothing against one, so this is the scan on which they are compared.
    """
    return _scan(replace(RECIPE, effects=()), points)


def coated_pinion(points: int = POINTS) -> SyntheticScan:
    """The same under a coat of spray on a turntable whose angle is off: what the closed loop is for."""
    return _scan(RECIPE, points)


def _scan(recipe: Recipe, points: int) -> SyntheticScan:
    return make_scan(recipe.of_size(round(points / (1.0 - recipe.lost))), SEED)


def write_ply(path: Path, points: NDArray[np.floating]) -> Path:
    """Binary PLY in single precision, as scanners write it."""
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path.write_bytes(head.encode() + points.astype("<f4").tobytes())
    return path


def write_stl(path: Path, vertices: NDArray[np.floating], faces: NDArray[np.integer]) -> Path:
    """Binary STL."""
    data = np.zeros(len(faces), [("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("attribute", "<u2")])
    data["corner"] = vertices[faces]
    path.write_bytes(bytes(80) + np.uint32(len(faces)).tobytes() + data.tobytes())
    return path
