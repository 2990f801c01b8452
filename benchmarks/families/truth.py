"""What is true of a part, by integration: worn volume of every flank, thickness of every tooth, volume broken off; mm.

In the plane the points of a worn layer are (L, t): the foot's roll length and the depth under the involute. They cover the area
(L − t)/rb dL dt, because an involute's radius of curvature is L and that of its parallel L − t. The layer ends at the tip circle, where L − t
is the roll length of the tip; so feet beyond the tip take part in it too, from t = L − L_tip on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.families.breakage import Cut
from benchmarks.families.gear import Array
from benchmarks.families.part import Part


def layer_area(part: Part, roll: Array, made: Array, total: Array) -> Array:
    """Area per unit of roll length between the surface as made and as it is, within the tip circle."""
    inside = roll - part.gear.tip_roll  # deviations above −inside lie outside the tip circle
    high, low = np.minimum(made, -inside), np.minimum(total, -inside)
    # ∫ (L + δ)/rb dδ from low to high
    return (high - low) * (roll + 0.5 * (high + low)) / part.gear.base_radius


def flank_volume(part: Part, tooth: int, side: int, step: float = 0.03) -> tuple[float, float]:
    """Worn volume of a flank (mm³) and its greatest depth (mm), on a grid of about `step` modules."""
    f = part.frame
    h = step * part.gear.module
    top = f.tip + 0.25 * part.gear.module
    rolls = np.linspace(f.form, top, max(int((top - f.form) / h), 60) + 1)
    heights = (np.arange(max(int(f.width / h), 60)) + 0.5) * (f.width / max(int(f.width / h), 60))
    roll, z = (a.ravel() for a in np.meshgrid(rolls, heights, indexing="ij"))
    k, s = np.full(len(roll), float(tooth)), np.full(len(roll), float(side))
    loss = part.loss(k, s, roll, z)
    if not loss.any():
        return 0.0, 0.0
    made = part.as_made(k, s, roll, z)
    area = layer_area(part, roll, made, made + loss).reshape(len(rolls), -1)
    volume = float(np.trapezoid(area.sum(axis=1) * f.width / len(heights), rolls))
    return volume, float(-np.min(loss, where=roll + made + loss <= f.tip, initial=0.0))


def deepest_mean(part: Part, tooth: int, side: int, window: float = 0.5, steps: int = 10) -> float:
    """Greatest mean loss over `window` × `window` mm of a flank as it is reached by a probe, form to tip circle, end to end, mm."""
    f, rb = part.frame, part.gear.base_radius
    h = window / steps
    low, high = 0.5 * f.form**2 / rb, 0.5 * f.tip**2 / rb  # arc of an involute: L² / 2 rb
    across, along = (max(int(length / h), steps) for length in (high - low, f.width))
    arc = low + (np.arange(across) + 0.5) * (high - low) / across
    z = (np.arange(along) + 0.5) * f.width / along
    roll, height = (a.ravel() for a in np.meshgrid(np.sqrt(2.0 * rb * arc), z, indexing="ij"))
    k, s = np.full(len(roll), float(tooth)), np.full(len(roll), float(side))
    loss = part.loss(k, s, roll, height).reshape(across, along)
    total = np.zeros((across + 1, along + 1))
    total[1:, 1:] = loss.cumsum(axis=0).cumsum(axis=1)
    n, m = (min(steps, length) for length in loss.shape)
    sums = total[n:, m:] - total[:-n, m:] - total[n:, :-m] + total[:-n, :-m]
    return float(-sums.min() / (n * m))


def thickness(part: Part, number: int = 120) -> dict[str, Array]:
    """Arc of every tooth at the reference circle as it is: mean and least over the face width, and as made; nan where broken off.

    The least is that of means over 1/20 of the face width, too: `least_mean`.
    """
    gear, f = part.gear, part.frame
    # Both ends besides: where they are relieved, the least is there.
    z = np.concatenate([[0.0], (np.arange(number) + 0.5) / number * f.width, [f.width]])
    tooth = np.repeat(np.arange(gear.teeth, dtype=float), number + 2)
    height = np.tile(z, gear.teeth)
    arc = np.full(len(tooth), gear.thickness)
    made = arc.copy()
    for side in (1.0, -1.0):
        s = np.full(len(tooth), side)
        foot = part.foot(tooth, s, np.full(len(tooth), f.reference), height)
        arc = arc + gear.reference_radius * part.deviation(tooth, s, foot, height) / gear.base_radius
        made = made + gear.reference_radius * part.as_made(tooth, s, foot, height) / gear.base_radius
    for cut in part.cuts:
        for side in (1.0, -1.0):
            theta = tooth * gear.pitch_angle + side * 0.5 * gear.thickness / gear.reference_radius
            at = gear.reference_radius * np.column_stack([np.cos(theta), np.sin(theta), height / gear.reference_radius])
            arc = np.where((tooth == cut.tooth) & (cut.beyond(at) > 0.0), np.nan, arc)
    every: Array = arc.reshape(gear.teeth, -1)
    by_tooth = every[:, 1:-1]
    width = number // 20
    window = np.stack([by_tooth[:, i : number - width + 1 + i] for i in range(width)]).mean(axis=0)
    broken = np.asarray(np.isnan(by_tooth).any(axis=1))
    by_tooth = np.where(broken[:, None], np.nan, by_tooth)
    return {
        "mean": by_tooth.mean(axis=1),
        "least": np.where(broken, np.nan, every.min(axis=1)),
        "least_mean": np.where(broken, np.nan, np.nan_to_num(window, nan=np.inf).min(axis=1)),
        "made": made.reshape(gear.teeth, -1)[:, 1:-1].mean(axis=1),
    }


def broken_volume(part: Part, cut: Cut, number: int = 90) -> float:
    """Volume of one piece broken off (mm³): cells of a grid in (radius, share of the half angle, height) that lie beyond it."""
    gear, sec = part.gear, part.section
    low, high, width = sec.root_radius[0], gear.tip_radius, gear.face_width
    if cut.radius > 0.0:
        rho0 = math.hypot(cut.point[0], cut.point[1])
        low, high = max(low, rho0 - 1.1 * cut.radius), min(high, rho0 + 1.1 * cut.radius)
    rho = low + (np.arange(number) + 0.5) / number * (high - low)
    z0, z1 = (
        (0.0, width)
        if not cut.radius
        else (max(0.0, cut.point[2] - 1.1 * cut.radius), min(width, cut.point[2] + 1.1 * cut.radius))
    )
    z = z0 + (np.arange(number) + 0.5) / number * (z1 - z0)
    share = ((np.arange(2 * number) + 0.5) / number - 1.0)[:, None]
    total = 0.0
    for r in rho:
        half = float(sec.half_angle(np.array([r]))[0])
        theta = cut.tooth * gear.pitch_angle + share * half
        xyz = np.stack(np.broadcast_arrays(r * np.cos(theta), r * np.sin(theta), z[None, :]), axis=-1).reshape(-1, 3)
        gone = cut.beyond(xyz) > 0.0
        for other in part.cuts:
            if other is cut:
                break
            if other.tooth == cut.tooth:
                gone &= other.beyond(xyz) <= 0.0
        total += gone.mean() * 2.0 * half * r
    return float(total * (rho[1] - rho[0]) * (z1 - z0))


@dataclass(frozen=True, eq=False)
class Truth:
    """Numbers of a part.

    Parameters
    ----------
    flanks : list of dict
        One per worn flank: tooth (from 0), side, volume_mm3, depth_mm, depth_mean_mm (see `deepest_mean`).
    thickness : dict of (teeth,) float
        See `thickness`.
    broken : list of dict
        tooth, kind, volume_mm3.
    """

    flanks: list[dict[str, Any]]
    thickness: dict[str, Array]
    broken: list[dict[str, Any]]

    @property
    def volume(self) -> float:
        """Worn, without what is broken off, mm³."""
        return float(sum(flank["volume_mm3"] for flank in self.flanks))

    @property
    def broken_volume(self) -> float:
        return float(sum(piece["volume_mm3"] for piece in self.broken))


def truth(part: Part, fine: bool = False) -> Truth:
    """Integrate; `fine` where pits or grooves need a finer grid."""
    flanks = []
    if part.wear:
        for tooth in range(part.gear.teeth):
            for side in (1, -1):
                volume, depth = flank_volume(part, tooth, side, 0.008 if fine and _worn(part, tooth, side) else 0.03)
                if volume > 0.0:
                    mean = deepest_mean(part, tooth, side)
                    flanks.append({"tooth": tooth, "side": side, "volume_mm3": volume, "depth_mm": depth, "depth_mean_mm": mean})
    broken = [{"tooth": cut.tooth, "kind": cut.kind, "volume_mm3": broken_volume(part, cut)} for cut in part.cuts]
    return Truth(flanks, thickness(part), broken)


def _worn(part: Part, tooth: int, side: int) -> bool:
    """Whether anything small is on a flank."""
    rows = [row for one in part.wear for row in getattr(one, "rows", ())]
    return any(row[0] == tooth and row[1] == side for row in rows)
