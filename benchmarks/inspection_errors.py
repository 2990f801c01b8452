"""Evaluation of known gears, in the manner of PTB's tests of evaluation software: error per parameter beside its U.

Gears with known deviations of every kind at once are written down from the involute's equations (`tests/inspection/test_known_gears.py`, which
shares nothing with the evaluation), scattered as a scanner does, moved by a registration's error and scaled by an instrument's. What comes out
is compared with what went in, and U with the errors.

    python -m benchmarks.inspection_errors --gears 12 --seed 1
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import locate
from gearwear.inspection import Inspection, Settings, inspect
from tests.inspection.test_known_gears import GEARS, Known, cut, known, parabola_form, parabola_total, profile_width, ranges

UM = 1e-3
HAND = np.array([1.0, -1.0])
POSE_STD = np.array([1e-3, 1e-3, 1e-3, 2e-5, 2e-5, 1e-5])
"""Of the registration: mm and rad."""


@dataclass(frozen=True)
class Condition:
    """How a gear is seen."""

    name: str
    noise: float
    moved: bool
    scale_std: float


CONDITIONS = (
    Condition("exact points", 0.0, False, 0.0),
    Condition("3 µm of scatter", 3 * UM, False, 0.0),
    Condition("10 µm of scatter", 10 * UM, False, 0.0),
    Condition("5 µm, registration 1 µm and 20 µrad, scale 50 ppm", 5 * UM, True, 50e-6),
)


def _index(put: Known, gear: Gear, roll: float) -> Floats:
    """Index deviation at a circle: where the flanks are, by what was put in, less the mean of the side."""
    first, last, _, _ = ranges(gear)
    u = (roll - 0.5 * (first + last)) / (last - first)
    at = put.profile_slope * u - put.profile_crown * (2 * u) ** 2 - put.helix_crown / 3.0
    index = put.index + HAND * at / math.cos(gear.spec.normal_pressure_angle)
    return np.asarray(index - index.mean(axis=0))


def _single(put: Known, gear: Gear, roll: float) -> Floats:
    index = _index(put, gear, roll)
    return np.asarray(index - np.roll(index, 1, axis=0))


Truth = Callable[[Known, Gear, Inspection], Floats]
PARAMETERS: dict[str, tuple[str, str, Truth]] = {
    "f_Hα": ("profile", "slope", lambda put, gear, found: put.profile_slope),
    "C_α": ("profile", "crowning", lambda put, gear, found: put.profile_crown),
    "f_fα": ("profile", "form", lambda put, gear, found: profile_width(put, 1.0)),
    "F_α": ("profile", "total", lambda put, gear, found: profile_width(put, 0.0)),
    "f_Hβ": ("helix", "slope", lambda put, gear, found: put.helix_slope),
    "C_β": ("helix", "crowning", lambda put, gear, found: put.helix_crown),
    "f_fβ": ("helix", "form", lambda put, gear, found: parabola_form(put.helix_crown)),
    "F_β": ("helix", "total", lambda put, gear, found: parabola_total(HAND * put.helix_slope, put.helix_crown)),
    "index": ("pitch", "index", lambda put, gear, found: _index(put, gear, found.pitch.roll)),
    "f_p, each": ("pitch", "single", lambda put, gear, found: _single(put, gear, found.pitch.roll)),
    "F_p": ("pitch", "cumulative", lambda put, gear, found: np.ptp(_index(put, gear, found.pitch.roll), axis=0)),
}
"""Where each stands in an inspection, and what was put in."""


def seen(condition: Condition, gear: Gear, put: Known, rng: np.random.Generator) -> Inspection:
    """The inspection of one gear as a condition shows it."""
    points = cut(gear, put)
    middle = np.array([0.0, 0.0, 0.5 * gear.face_width])
    points = (points - middle) * (1.0 + condition.scale_std * rng.normal()) + middle
    if condition.moved:
        motion = POSE_STD * rng.normal(size=6)
        points = points + motion[:3] + np.cross(motion[3:], points)
    points = points + rng.normal(0.0, 1.0, points.shape) * condition.noise
    covariance = np.diag(POSE_STD**2) if condition.moved else None
    settings = Settings(noise=condition.noise or None, pose_covariance=covariance, scale_std=condition.scale_std)
    return inspect(locate(points, gear, workers=1), gear, settings)


def table(gears: int, seed: int) -> str:
    """The table of errors, a row a parameter and condition, in Markdown."""
    lines = [
        "| how seen | parameter | values | mean error, µm | RMS error, µm | largest, µm | mean U, µm | within U |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for condition in CONDITIONS:
        errors: dict[str, list[Floats]] = {name: [] for name in PARAMETERS}
        expanded: dict[str, list[Floats]] = {name: [] for name in PARAMETERS}
        for number in range(gears):
            gear = Gear.from_spec(GEARS[number % len(GEARS)])
            rng = np.random.default_rng([seed, number])
            put = known(gear.teeth, 1000 * seed + number)
            found = seen(condition, gear, put, rng)
            for name, (part, attribute, truth) in PARAMETERS.items():
                one = getattr(getattr(found, part), attribute)
                errors[name].append(np.ravel(one.value - truth(put, gear, found)))
                expanded[name].append(np.ravel(one.expanded))
        for name in PARAMETERS:
            off, most = 1e3 * np.concatenate(errors[name]), 1e3 * np.concatenate(expanded[name])
            within = 100.0 * float(np.mean(np.abs(off) <= most))
            sizes = (f"{value:.2f}" for value in (off.mean(), np.sqrt(np.mean(off**2)), np.abs(off).max(), most.mean()))
            share = "–" if condition.noise == 0.0 else f"{within:.1f} %"
            lines.append(f"| {condition.name} | {name} | {len(off)} | {' | '.join(sizes)} | {share} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gears", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(table(given.gears, given.seed))


if __name__ == "__main__":
    main()
