"""Scans of helical gears, rings and double helical gears with known truth, by generators that share nothing with the package."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.synthetic.double_helical import Double, WornHalf, double_scan
from tests.synthetic.helical import Floats, Helical, Patch
from tests.synthetic.helical import scan as helical_scan
from tests.synthetic.ring import Ring, ring_scan

FAMILIES = {"helical": "helical gears", "ring": "rings, spur and helical", "double": "double helical gears"}
EFFECTS = ("none", "coating", "turntable_angle", "axis_offset_radial")
STRAYS = 0.003
"""Share of points that belong to nothing."""
PLACES = 400
"""Heights of a flank that its least thickness is looked for at."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A scan and what is true of it: keys as the families of spur gears have them (`benchmarks.families.scoring`)."""

    points: Floats
    design: dict[str, Any]
    truth: dict[str, Any]


def draw(family: str, number: int, seed: int, count: int) -> Drawn:
    """A scan of a family by its number; it depends on nothing else.

    Parameters
    ----------
    family : str
        Of `FAMILIES`.
    number, seed : int
        Of the scan and of the study.
    count : int
        Points, about.
    """
    rng = np.random.default_rng([seed, sorted(FAMILIES).index(family), number])
    gear = _gear(family, rng)
    half = gear.lower if isinstance(gear, Double) else gear
    worn = _wear(gear, half, rng)
    effect = str(rng.choice(EFFECTS))
    size = 1e-3 * float(np.exp(rng.uniform(math.log(6.0), math.log(25.0))))
    noise = 1e-3 * float(rng.uniform(4.0, 10.0))
    coat = size if effect == "coating" else 0.0
    made = {"count": count, "noise": 0.0, "seed": int(rng.integers(2**31)), "coat": coat}
    if isinstance(gear, Double):
        cloud = double_scan(gear, wear=tuple(WornHalf(upper, patch) for upper, patch in worn), **made)
    else:
        maker: Any = ring_scan if isinstance(gear, Ring) else helical_scan
        cloud = maker(gear, wear=tuple(patch for _, patch in worn), **made)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    order = int(rng.integers(1, 5))
    points = _instrument(points, effect, size, order, half, rng) + rng.normal(0.0, noise, points.shape)
    stray = rng.random(len(points)) < STRAYS
    points[stray] += rng.normal(0.0, 0.3 * half.module, (int(stray.sum()), 3))
    volumes = [half.volume(patch) for _, patch in worn]
    truth = {
        "label": f"{family} {number}", "family": family, "what": effect,
        "size_um": 1e3 * size, "order": order if effect == "turntable_angle" else None, "noise_um": 1e3 * noise,
        "declared": [] if effect == "none" else [{"name": effect, "parameters": {}}],
        # A first order of a table's angle is an eccentricity of the gear on it.
        "may_name": ["eccentricity"] if effect == "turntable_angle" and order == 1 else [],
        "near": [], "outside": "", "wear_fields": [],
        "volume_mm3": float(sum(volumes)), "flanks": sorted({(patch.tooth, patch.side) for _, patch in worn}),
        "gear": {"teeth": half.teeth}, "broken": [], "unseen_teeth": [], "thickness": _thickness(gear, half, worn),
        "poses": [{"R": cloud.rotation.tolist()}],
    }  # fmt: skip
    return Drawn(points @ cloud.rotation.T + cloud.translation, _design(gear, half, rng), truth)


def _gear(family: str, rng: np.random.Generator) -> Helical | Ring | Double:
    hand = float(rng.choice([-1.0, 1.0]))
    angle = round(float(rng.uniform(8.0, 30.0)), 1)
    module = float(rng.choice([1.5, 2.0, 2.5, 3.0, 4.0]))
    shift = float(rng.choice([-0.1, 0.0, 0.1, 0.2]))
    if family == "helical":
        width = round(module * float(rng.uniform(4.0, 8.0)), 1)
        return Helical(int(rng.integers(15, 45)), module, hand * angle, width, 20.0, shift)
    if family == "double":
        width = round(module * float(rng.uniform(3.5, 6.0)), 1)
        lower = Helical(int(rng.integers(15, 35)), module, hand * angle, width, 20.0, shift)
        return Double(lower, gap=round(module * float(rng.uniform(1.0, 2.5)), 1))
    teeth, helix = int(rng.integers(36, 80)), float(rng.choice([0.0, hand * min(angle, 25.0)]))
    rim = 0.5 * module * teeth / math.cos(math.radians(helix)) + 4.0 * module
    width = round(module * float(rng.uniform(4.0, 8.0)), 1)
    return Ring(
        teeth, module, helix, width, shift=shift, fillet_radius=round(module * float(rng.uniform(0.2, 0.3)), 3), rim=round(rim, 1)
    )


def _rolls(half: Helical | Ring) -> tuple[float, float]:
    """Lengths of roll between which the flank is an involute, the smaller first."""
    tip = math.sqrt(half.tip**2 - half.base**2)
    if isinstance(half, Ring):
        return tip, half.touch[0]
    return math.sqrt(max(float(half.fillet()[0][-1]) ** 2 - half.base**2, 0.0)), tip


def _wear(gear: Helical | Ring | Double, half: Helical | Ring, rng: np.random.Generator) -> list[tuple[bool, Patch]]:
    """Up to three worn flanks, each with its half."""
    (low, high), worn = _rolls(half), []
    span = high - low
    places = rng.permutation(2 * half.teeth)[: int(rng.integers(0, 4))]
    for place in places:
        depth = 0.001 * half.module * float(np.exp(rng.uniform(math.log(15.0), math.log(60.0))))
        u, v = np.sort(rng.uniform(0.05, 0.35, 2)), np.sort(rng.uniform(0.05, 0.3, 2))
        roll = (low + float(u[0]) * span, high - float(u[1]) * span)
        z = (float(v[0]) * half.width, (1.0 - float(v[1])) * half.width)
        upper = isinstance(gear, Double) and bool(rng.random() < 0.5)
        worn.append((upper, Patch(int(place) // 2, 1 if place % 2 else -1, depth, roll, z)))
    return worn


def _instrument(points: Floats, effect: str, size: float, order: int, half: Helical | Ring, rng: np.random.Generator) -> Floats:
    """Points as a scanner with an error of a size (mm) shows them."""
    radius, angle = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    if effect == "turntable_angle":
        angle = angle + size / half.base * np.cos(order * angle + phase)
    elif effect == "axis_offset_radial":
        radius = radius + size
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), points[:, 2]])


def _thickness(gear: Helical | Ring | Double, half: Helical | Ring, worn: list[tuple[bool, Patch]]) -> dict[str, list[float]]:
    """Least and mean transverse arc of each tooth at the reference circle, of both halves where there are two, mm."""
    arc = (0.5 * math.pi + 2 * half.shift * math.tan(math.radians(half.pressure))) * half.module / half.cos
    way = -1.0 if isinstance(half, Ring) else 1.0
    roll = math.sqrt(half.reference**2 - half.base**2)
    z = (np.arange(PLACES) + 0.5) / PLACES * half.width
    lost: dict[tuple[bool, int], Floats] = {}
    for upper, patch in worn:
        depth = np.zeros(PLACES)
        for _ in range(6):  # the plumb foot of the worn point at the reference circle lies deeper in a tooth
            depth = patch.at(roll + way * half.base_cos * depth, z)
        key = (upper, patch.tooth)
        lost[key] = lost.get(key, np.zeros(PLACES)) + depth * half.reference / (half.base * half.base_cos)
    halves = (False, True) if isinstance(gear, Double) else (False,)
    teeth = [np.concatenate([arc - lost.get((upper, k), np.zeros(PLACES)) for upper in halves]) for k in range(half.teeth)]
    return {"least": [float(one.min()) for one in teeth], "mean": [float(one.mean()) for one in teeth]}


def _design(gear: Helical | Ring | Double, half: Helical | Ring, rng: np.random.Generator) -> dict[str, Any]:
    """The design as a user gives it; of half of the rings nobody knows the fillet."""
    design: dict[str, Any] = {
        "teeth": half.teeth, "module": half.module, "helix_angle": half.helix, "profile_shift": half.shift, "addendum": half.addendum,
        "dedendum": half.dedendum, "face_width": gear.width,
    }  # fmt: skip
    if isinstance(gear, Double):
        design["gap"] = gear.gap
    if isinstance(gear, Ring):
        design |= {"internal": True, "rim_diameter": 2.0 * gear.rim}
        if rng.random() < 0.5:
            design["fillet_radius"] = gear.fillet_radius
    return design
