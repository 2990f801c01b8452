"""How often the true value lies within U, on thin scans of simulated gears: ``python benchmarks/thin_scans.py [--scans N]``.

The gears are written down from the involute's own equations; slopes, forms, pitches are known. A scan is scattered points or rows, with noise, moved by a
small motion drawn from a covariance that is handed on as the registration's. Nothing of the evaluation is shared but the gear's numbers. Families:
`plain` (slopes, pitch and noise), `form` (each flank has 1.5 waves of its own beside that of its side), `texture` of several lengths, `uneven` (density 1 to 10 along
the flank), `half` (half of each third flank is missing, along the face).
"""

from __future__ import annotations

import argparse

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points, locate
from gearwear.inspection import Settings, inspect
from gearwear.inspection.pitch import measuring_roll
from gearwear.inspection.ranges import helix_range, profile_range

FAMILIES = ("plain", "form", "texture", "uneven", "half")
COUNTS, NOISES_UM = (20, 60, 300), (0.5, 10.0)
UM = 1e-3
HAND = np.array([1.0, -1.0])


def filtered(x: np.ndarray, traces: np.ndarray, cutoff: float) -> np.ndarray:
    """Gauss filter of evenly spaced traces, about a local line at the ends, as the deviations are defined on the filtered trace."""
    distance = x[None] - x[:, None]
    weight = np.exp(-np.pi * (distance / (np.sqrt(np.log(2.0) / np.pi) * cutoff)) ** 2)
    out = np.empty_like(traces)
    for k in range(len(x)):
        basis = np.stack([np.ones(len(x)), distance[k]])
        out[..., k] = traces @ (weight[k] * np.linalg.solve((basis * weight[k]) @ basis.T, basis)[0])
    return out


def waves(
    rng: np.random.Generator,
    gear: Gear,
    roll: np.ndarray,
    z: np.ndarray,
    flank: np.ndarray,
    lengths: tuple[float, ...],
    size: float,
) -> np.ndarray:
    """Texture: plane waves of these lengths in any direction, of its own on every flank."""
    out = np.zeros(len(roll))
    for length in lengths:
        for _ in range(4):
            turn, phase = rng.uniform(0.0, 2 * np.pi, (2, 2 * gear.teeth))
            out += (
                size
                * np.sqrt(0.5)
                * np.cos(2 * np.pi / length * (roll * np.cos(turn)[flank] + z * np.sin(turn)[flank]) + phase[flank])
            )
    return out


def one(gear: Gear, family: str, count: int, noise: float, seed: int) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Value, truth and U of every quantity of one scan, mm."""
    rng = np.random.default_rng(seed)
    z_n, b = gear.teeth, gear.face_width
    nominal, face = profile_range(gear), helix_range(gear)
    slope, helix = rng.normal(0.0, 4 * UM, (2, z_n, 2))
    index = rng.normal(0.0, 3 * UM, (z_n, 2))
    common, own = (3 * UM, 0.5 * UM) if family == "form" else (0.0, 0.0)
    phase = rng.uniform(0.0, 2 * np.pi, (z_n, 2))

    def shape(tooth: np.ndarray, side: np.ndarray, roll: np.ndarray, z: np.ndarray) -> np.ndarray:
        u, v = (roll - nominal.middle) / nominal.length, (z - 0.5 * b) / face.length
        wave = common * np.sin(3 * np.pi * u) + own * np.sin(3 * np.pi * u + phase[tooth, side])
        return HAND[side] * index[tooth, side] + slope[tooth, side] * u + HAND[side] * helix[tooth, side] * v + wave

    n = count * 2 * z_n
    flank = np.repeat(np.arange(2 * z_n), count)
    tooth, side = flank // 2, flank % 2
    u = rng.random(n)
    if family == "uneven":
        u = np.sqrt(0.01 + 0.99 * u)  # ten times denser at the tip than at the root
    roll, z = gear.form_roll + u * (gear.tip_roll - gear.form_roll), rng.random(n) * b
    deviation = shape(tooth, side, roll, z) + rng.normal(0.0, noise, n)
    if family == "texture":
        deviation += waves(rng, gear, roll, z, flank, (0.02 * b, 0.05 * b, 0.12 * b), 0.3 * noise)
    if family == "half":
        keep = (flank % 3 > 0) | (z < 0.5 * b)
        tooth, side, roll, z, deviation = (values[keep] for values in (tooth, side, roll, z, deviation))
    feet = flank_points(gear, tooth, np.array([1, -1])[side], roll, z)
    points = feet.position + deviation[:, None] * feet.normal
    sigma = np.array([1.0, 1.0, 1.0, 1.0 / b, 1.0 / b, 1.0 / gear.tip_radius]) * (0.3 * UM + noise / np.sqrt(0.5 * len(points)))
    motion = rng.normal(0.0, 1.0, 6) * sigma
    points = points + motion[:3] + np.cross(motion[3:], points)
    found = inspect(locate(points, gear, workers=1), gear, Settings(noise=noise, pose_covariance=np.diag(sigma**2)))

    where = found.profile.range  # it says where it begins
    line = np.linspace(where.start, gear.tip_roll, 400)  # the filter also sees what lies beyond the range
    grid = np.stack(np.meshgrid(np.arange(z_n), [0, 1], indexing="ij"), -1).reshape(-1, 2)
    trace = np.array([shape(np.full(400, t), np.full(400, s), line, np.full(400, 0.5 * b)) for t, s in grid]).reshape(z_n, 2, 400)
    trace = filtered(line, trace, where.cutoff)[..., line <= where.end]
    line = line[line <= where.end]
    unit = (line - where.middle) / where.length
    fit = np.polynomial.polynomial.polyfit(unit, trace.reshape(-1, len(unit)).T, 1)[1].reshape(z_n, 2)
    arc = HAND / np.cos(gear.transverse_pressure_angle)

    def at(circle: float) -> np.ndarray:
        return np.array(
            [shape(np.array([t]), np.array([s]), np.array([circle]), np.array([0.5 * b]))[0] for t, s in grid]
        ).reshape(z_n, 2)

    steps = at(measuring_roll(gear)) * arc
    steps -= np.nanmean(np.where(np.isfinite(found.pitch.index.value), steps, np.nan), axis=0)
    single = steps - np.roll(steps, 1, axis=0)
    rest = trace - trace.mean(axis=-1, keepdims=True) - fit[..., None] * unit
    thick = gear.tooth_thickness + at(gear.reference_roll).sum(axis=1) / np.cos(gear.transverse_pressure_angle)
    pairs = {
        "f_Hα": (found.profile.slope, fit),
        "f_fα": (found.profile.form, np.ptp(rest, axis=-1)),
        "f_Hβ": (found.helix.slope, helix),
        "index": (found.pitch.index, steps),
        "f_p": (found.pitch.single_greatest, np.abs(single).max(axis=0)),
        "F_p": (found.pitch.cumulative, np.ptp(steps, axis=0)),
        "thickness": (found.dimensions.thickness, thick),
    }
    if found.runout is not None:
        balls = found.runout
        delta = at(balls.pins.roll)
        radial = (delta[:, 0] + np.roll(delta[:, 1], -1)) / (2 * np.sin(balls.pins.centre_angle))
        pairs["F_r"] = (balls.runout, np.array(np.ptp(radial)))
    return {name: (np.ravel(part.value), np.ravel(true), np.ravel(part.expanded)) for name, (part, true) in pairs.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scans", type=int, default=4, help="of each family, number of points and noise")
    arguments = parser.parse_args()
    gear = Gear.from_spec(GearSpec("gear", 13, 0.28, 0.84, profile_shift=0.4, dedendum=1.15))
    print(f"{arguments.scans} scans each of {gear.teeth} teeth; % within U, (median U in µm), [% with a value]")
    for family in FAMILIES:
        for count in COUNTS:
            for noise in NOISES_UM:
                pooled: dict[str, list[tuple[np.ndarray, ...]]] = {}
                for seed in range(arguments.scans):
                    for name, values in one(gear, family, count, noise * UM, seed).items():
                        pooled.setdefault(name, []).append(values)
                cells = []
                for name, parts in pooled.items():
                    value, true, expanded = (np.concatenate(column) for column in zip(*parts, strict=True))
                    seen = np.isfinite(value)
                    inside = np.abs(value - true)[seen] <= expanded[seen]
                    cells.append(
                        f"{name} {100 * inside.mean():.0f} ({1e3 * np.median(expanded[seen]):.1f}) [{100 * seen.mean():.0f}]"
                        if seen.any()
                        else f"{name} – [0]"
                    )
                print(f"{family:8} n {count:4} noise {noise:4.1f}: " + "  ".join(cells), flush=True)


if __name__ == "__main__":
    main()
