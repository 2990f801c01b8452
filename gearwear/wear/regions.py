"""Where metal is missing beyond what the scan's own scatter can explain, and how much.

A region is all the wear of one tooth side. It is found on means over 3 × 3 cells, judged against the spread those means
have on the better half of the gear, corrected for the number of places looked at. Its volume is the signed sum of depth over the
region and a rim round it (signed sums are unbiased; one-sided ones collect noise), its standard deviation what the same sum comes to on
tooth sides without wear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats
from gearwear.card import Card, Row, counted, few, measured
from gearwear.design.profiles import SIGN
from gearwear.measure.cells import Cells
from gearwear.measure.sheet import Sheets, infill, make_sheets, rim, window_mean, worn_cells

RIM = 0.2
"""Width, in modules, of the rim that is summed with a region: its mask follows the noise, and a wide rim gives back what that picked."""
LEAST_VOLUME = 5.0
"""Least volume of a region in its own standard deviations."""
LEAST_VOLUME_ON_WORN_SIDE = 2.0
"""The same on a side that is known to be worn throughout: there a flank need not prove it by itself."""


FLANK = {1: "left", -1: "right"}
"""Name of a side."""


@dataclass(frozen=True, slots=True, repr=False)
class WearRegion(Card):
    """The wear of one tooth side.

    Parameters
    ----------
    tooth : int
        0-based.
    side : int
        +1 left, −1 right.
    volume, volume_std : float
        mm³ (mm² for a planar section).
    max_depth : float
        Largest mean over about 0.5 × 0.5 mm, mm.
    mean_depth, area : float
        mm, mm².
    centroid : (3,) float
        Depth-weighted, in the design frame, mm.
    patches : int
        Number of pieces.
    """

    tooth: int
    side: int
    volume: float
    volume_std: float
    max_depth: float
    mean_depth: float
    area: float
    centroid: Floats
    patches: int

    def headline(self) -> str:
        return f"tooth {self.tooth + 1} {FLANK[self.side]}, {measured(self.volume, self.volume_std, 'mm³')}"

    def rows(self) -> list[Row]:
        x, y, z = self.centroid
        return [
            ("depth", f"{1e3 * self.max_depth:.1f} µm at most, {1e3 * self.mean_depth:.1f} µm on average"),
            ("area", f"{self.area:.1f} mm² in {counted(self.patches, 'piece')}"),
            ("centre", f"x {x:.2f}, y {y:.2f}, z {z:.2f} mm"),
        ]


@dataclass(frozen=True, slots=True, repr=False)
class Wear(Card):
    """All wear of a scan.

    Parameters
    ----------
    regions : tuple of WearRegion
        Largest volume first.
    volume, volume_std : float
        Their sum, mm³, and its standard deviation.
    sheets : Sheets
        The deviations it was found on.
    mask : (teeth, 2, rows, columns) bool
        Cells of the regions.
    depth : (teeth, 2, rows, columns) float
        Missing depth in the regions with holes filled, mm; 0 elsewhere.
    spread : float
        Standard deviation of 3 × 3 cell means where there is no wear, mm.
    limit : float
        Mean depth over 3 × 3 cells from which wear is seen, mm.
    """

    regions: tuple[WearRegion, ...]
    volume: float
    volume_std: float
    sheets: Sheets
    mask: Bools
    depth: Floats
    spread: float
    limit: float

    def headline(self) -> str:
        size = measured(self.volume, self.volume_std, "mm³")
        return f"{size} in {counted(len(self.regions), 'region')}, seen from {1e3 * self.limit:.1f} µm on"

    def rows(self) -> list[Row]:
        return few(
            [
                (
                    f"tooth {one.tooth + 1} {FLANK[one.side]}",
                    f"{measured(one.volume, one.volume_std, 'mm³')}, {1e3 * one.max_depth:.1f} µm deep",
                )
                for one in self.regions
            ]
        )


def find_wear(cells: Cells, noise: float, worn_side: int = 0, level_std: tuple[float, float] = (0.0, 0.0)) -> Wear:
    """Find the worn regions of a scan.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    noise : float
        Scatter of points, mm.
    worn_side : int
        Side (+1 left, −1 right) whose flanks are known to be worn throughout, 0 for none: there a region is the whole flank, else what
        lies below the limit near the pitch point would be lost (2 % of sliding wear).
    level_std : (float, float)
        Standard deviation of the level of all left and of all right flanks, mm, from pose and effects (`Loop.level_std`).
    """
    sheets = make_sheets(cells)
    local, number = window_mean(sheets)
    mask, spread, limit = worn_cells(local, number, noise)
    if worn_side:
        half = SIGN.index(worn_side)
        mask[:, half, :, sheets.fillet :] = True
    filled = infill(sheets)
    sums = _volumes(
        sheets, filled, mask, noise, max(1, round(RIM * cells.grid.gear.transverse_module / cells.grid.size)), level_std
    )
    # A place may be low by texture alone: what the same cells come to on sides without wear decides.
    least = np.full(sums.shape[:2], LEAST_VOLUME)
    if worn_side:
        least[:, SIGN.index(worn_side)] = LEAST_VOLUME_ON_WORN_SIDE
    mask &= (sums[..., 0] > least * sums[..., 1])[..., None, None]
    sums[~mask.any(axis=(2, 3))] = 0.0
    regions = []
    for tooth, half in np.argwhere(mask.any(axis=(2, 3))):
        volume, std, _ = sums[tooth, half]
        regions.append(_region(sheets, filled, mask, int(tooth), int(half), float(volume), float(std), cells.grid.size))
    regions.sort(key=lambda region: -region.volume)
    depth = np.where(mask, -filled, 0.0)
    total = sum(region.volume for region in regions)
    # Scatter is each side's own; what is left of pose and offset is shared by all and adds up in full.
    own = sum(region.volume_std**2 for region in regions)
    std = math.sqrt(own + float(sums[..., 2].sum()) ** 2)
    return Wear(tuple(regions), total, std, sheets, mask, depth, spread, limit)


def _volumes(sheets: Sheets, filled: Floats, mask: Bools, noise: float, rim_cells: int, level_std: tuple[float, float]) -> Floats:
    """(teeth, 2, 3) volume of every side, its standard deviation, and the part of it that all sides share."""
    wide = rim(mask, rim_cells)
    missing = -filled * sheets.area
    volume = np.where(wide, missing, 0.0).sum(axis=(2, 3))
    sound = ~mask.any(axis=(2, 3)) & (sheets.seen.mean(axis=(2, 3)) > 0.5)
    unworn = np.where(wide, np.nan, missing)
    result = np.stack([volume, np.zeros_like(volume), np.zeros_like(volume)], axis=-1)
    for tooth, half in np.argwhere(mask.any(axis=(2, 3))):
        own = wide[tooth, half]
        number = np.maximum(sheets.count[tooth, half], 1.0)
        white = noise * math.sqrt(float((sheets.area**2 / number * own).sum()))
        # The same cells on sides without wear; failing those, the unworn cells of all sides.
        placebo = missing[sound][:, own].sum(axis=1)
        if len(placebo) < 5:
            free = own & np.isfinite(unworn)
            share = free.sum(axis=(2, 3))
            total = np.where(free, np.nan_to_num(unworn), 0.0).sum(axis=(2, 3))
            placebo = total[share > 0] / share[share > 0] * own.sum()
        scatter = float(np.sqrt(np.mean(placebo**2))) if len(placebo) >= 3 else 0.0
        level = level_std[half] * float((own * sheets.area).sum())
        result[tooth, half, 1] = math.hypot(max(scatter, white), level)
        shared = float(np.mean(placebo)) if len(placebo) >= 3 else 0.0
        result[tooth, half, 2] = math.hypot(shared, level)
    return result


def _region(
    sheets: Sheets, filled: Floats, mask: Bools, tooth: int, half: int, volume: float, std: float, size: float
) -> WearRegion:
    own = mask[tooth, half]
    depth = np.where(own, -filled[tooth, half], 0.0)
    window = max(1, round(0.5 / size))
    rows = min(window, depth.shape[0])
    deepest = float(ndimage.uniform_filter(depth, (rows, window), mode="nearest")[own].max())
    weight = np.where(own & sheets.seen[tooth, half], np.maximum(depth, 0.0) * sheets.area, 0.0)
    position = np.nan_to_num(sheets.position[tooth, half])
    centroid = (position * weight[..., None]).sum(axis=(0, 1)) / max(float(weight.sum()), 1e-300)
    area = float((own * sheets.area).sum())
    patches = int(ndimage.label(own, np.ones((3, 3)))[1])
    return WearRegion(tooth, SIGN[half], volume, std, deepest, float((depth * sheets.area).sum()) / area, area, centroid, patches)
