"""What the effects do to the tooth sides: put back on the design, on the cells or on the sections, with what the pose takes up of them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, SurfacePoints, flank_points, locate
from gearwear.design.twist import twisted
from gearwear.diagnose.effects.base import MADE, MEASURED, Context, Kind
from gearwear.diagnose.loop import FoundEffect, Loop
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.pose import motion_columns
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.regions import Wear

UNEXPLAINED = "unexplained"
"""Name under which structure without a name stands among the causes of a change."""


@dataclass(frozen=True, slots=True)
class PutBack:
    """An effect as the raw scan shows it.

    Parameters
    ----------
    effect : FoundEffect
    context : Context
    motion : (6,) float
        Small motion (mm, rad) by which registration takes up part of the effect; 0 where the scan is looked at about a datum.
    relative_std : float
        Standard deviation of its size over its size, on the cells in use.
    """

    effect: FoundEffect
    context: Context
    motion: Floats
    relative_std: float = 0.0

    @property
    def name(self) -> str:
        return self.effect.name

    @property
    def kind(self) -> Kind:
        return self.effect.kind

    def alone(self, points: SurfacePoints) -> Floats:
        """What the effect itself does to the deviation of points, mm, (n,)."""
        candidate = self.effect.candidate
        basis = candidate.effect.basis(points, self.context, candidate.shape)
        return np.asarray(basis @ self.effect.amplitudes, dtype=np.float64)

    def shown(self, points: SurfacePoints) -> Floats:
        """The same, less what the pose takes up of it."""
        return np.asarray(self.alone(points) + motion_columns(points.position, points.normal) @ self.motion, dtype=np.float64)


def put_back(measured: MeasuredGear) -> tuple[PutBack, ...]:
    """The effects found, but for wear."""
    loop, cells = measured.loop, measured.first
    if loop is None:
        return ()
    use = loop.use & cells.seen
    weight = np.sqrt(cells.count[use])[:, None]
    # Registration fits a common offset beside the pose.
    columns, points = np.column_stack([cells.motion[use], np.ones(use.sum())]) * weight, cells.points.take(use)
    result = []
    for effect in loop.effects:
        basis = effect.candidate.effect.basis(points, loop.context, effect.candidate.shape) * weight
        spread = relative_std(basis, effect.amplitudes, effect.covariance)
        contribution = PutBack(effect, loop.context, np.zeros(6), spread)
        if not about_datum(loop):
            taken_up = np.linalg.lstsq(columns, basis @ effect.amplitudes, rcond=None)[0][:6]
            contribution = replace(contribution, motion=-np.asarray(taken_up, dtype=np.float64))
        result.append(contribution)
    return tuple(contribution for contribution in result if contribution.kind is not Kind.WEAR)


def about_datum(loop: Loop) -> bool:
    """Whether there is a datum that the teeth are out of: then the raw scan is looked at about that."""
    return any(effect.kind is Kind.MOUNTING for effect in loop.effects)


def by_name(effects: Iterable[PutBack], points: SurfacePoints) -> dict[str, Floats]:
    """What each of the effects shows at some points, mm, (n,); those of one name together."""
    fields: dict[str, Floats] = {}
    for effect in effects:
        fields[effect.name] = fields.get(effect.name, 0.0) + effect.shown(points)
    return fields


def cell_fields(measured: MeasuredGear, effects: Iterable[PutBack], cells: Cells) -> dict[str, Floats]:
    """By name, what each effect and the unexplained show in every cell, (m,) mm; 0 in unseen ones."""
    fields = {}
    for name, field in by_name(effects, cells.points.take(cells.seen)).items():
        fields[name] = np.zeros(len(cells.count))
        fields[name][cells.seen] = field
    if measured.loop is not None and measured.loop.patterns:
        fields[UNEXPLAINED] = _pattern(measured.loop)
    return fields


def band_points(gear: Gear, z: Floats) -> tuple[SurfacePoints, SurfacePoints]:
    """Points of the left and of the right flanks where thickness is measured, tooth by tooth at heights `z` (mm)."""
    tooth, height = np.repeat(np.arange(gear.teeth), len(z)), np.tile(z, gear.teeth)
    roll = np.full(len(tooth), gear.thickness_roll)
    left, right = (flank_points(gear, tooth, np.full(len(tooth), side), roll, height) for side in Side)
    return left, right


def arc_fields(measured: MeasuredGear, effects: Iterable[PutBack], z: Floats) -> dict[str, Floats]:
    """By name, what each effect adds to the arc of a tooth in sections, (teeth, n_z) mm."""
    gear = measured.gear
    left, right = (by_name(effects, points) for points in band_points(gear, z))
    return {name: (gear.arc_per_depth * (left[name] + right[name])).reshape(gear.teeth, -1) for name in left}


@dataclass(frozen=True, slots=True)
class SideFields:
    """What was found does to the tooth sides, cell by cell, seen or not; arrays are (teeth, 2, rows, fillet + flank), mm.

    Parameters
    ----------
    made : array
        Manufacture effects together.
    taken : dict of str to array
        By name: every effect of measurement and mounting as the raw scan shows it, and what is unexplained.
    raw : array
        All of these themselves, and the small motion between the pose of registration and the final one; about the datum, without that
        motion, where there is a mounting effect.
    unsure : tuple of array
        One standard deviation of the size of each effect.
    """

    made: Floats
    taken: dict[str, Floats]
    raw: Floats
    unsure: tuple[Floats, ...] = ()


def side_fields(measured: MeasuredGear, effects: Iterable[PutBack], wear: Wear | None = None) -> SideFields:
    """The effects on the tooth sides of the design, and with the `wear` found the levels that it counts from; nothing where there is none."""
    loop, grid = measured.loop, measured.cells.grid
    points = side_points(grid)
    shape = grid.side_shape
    made, raw, taken, unsure = np.zeros(shape), np.zeros(shape), dict[str, Floats](), list[Floats]()
    if loop is None:
        return SideFields(made, taken, raw)
    if wear is not None:
        made = made + grid.sides(grid.on_flanks(_counted_from(measured, wear)))
    if not (loop.effects or loop.patterns or loop.form):
        return SideFields(made, taken, raw)
    made = made + loop.deviation(points, MADE).reshape(shape)  # with what is no finding: the wear does not hold it either
    for effect in effects:
        alone = effect.alone(points).reshape(shape)
        shown = alone if effect.kind in MADE else effect.shown(points).reshape(shape)
        unsure.append(effect.relative_std * shown)
        if effect.kind in MEASURED:
            raw = raw + alone
            taken[effect.name] = taken.get(effect.name, 0.0) + shown
    if loop.patterns:
        taken[UNEXPLAINED] = grid.sides(_pattern(loop))
        raw = raw + taken[UNEXPLAINED]
    if not about_datum(loop):
        raw = raw + (motion_columns(points.position, points.normal) @ loop.motion).reshape(shape)
    return SideFields(made, taken, raw, tuple(unsure))


def _counted_from(measured: MeasuredGear, wear: Wear) -> Floats:
    """How high flanks stood as made, (teeth, 2) mm, from where the wear is counted, beyond effects and patterns: what their teeth were told to be thicker by,
    and what stands proud of the design."""
    loop, grid = measured.loop, measured.cells.grid
    levels = flank_levels(make_side_maps(measured.as_made).deviation - wear.side_maps.deviation, grid.fillet)
    if loop is None or loop.untold is None:
        return levels
    return levels + loop.untold.level


def flank_levels(heights: Floats, fillet: int) -> Floats:
    """Median of each flank, (teeth, 2), of heights (teeth, 2, rows, fillet + flank); 0 where none is known."""
    flank = heights[..., fillet:].reshape(*heights.shape[:2], -1)
    known = np.isfinite(flank).any(axis=2)
    levels = np.zeros(known.shape)
    levels[known] = np.nanmedian(flank[known], axis=1)
    return levels


def pattern_fields(measured: MeasuredGear) -> tuple[Floats, Floats]:
    """The patterns that no effect explains on the tooth sides, (teeth, 2, rows, fillet + flank) mm: those that are known under wear as well, and those that
    are drawn on from beside it."""
    loop, grid = measured.loop, measured.cells.grid
    patterns = () if loop is None else loop.patterns

    def summed(known: bool) -> Floats:
        fields = [np.nan_to_num(pattern.field) for pattern in patterns if pattern.known_everywhere is known]
        return grid.sides(np.sum([np.zeros(grid.count), *fields], axis=0))

    return summed(True), summed(False)


def _pattern(loop: Loop) -> Floats:
    """The unexplained in every cell, mm; 0 in unseen ones."""
    return np.asarray(np.nan_to_num(np.sum([pattern.field for pattern in loop.patterns], axis=0)), dtype=np.float64)


def relative_std(basis: Floats, amplitudes: Floats, covariance: Floats) -> float:
    """Standard deviation of an effect's size, the root mean square of its field, over that size; 0 where it has none.

    Parameters
    ----------
    basis : (n, p) float
        Field of each amplitude, times the square root of the places' weights.
    amplitudes : (p,) float
    covariance : (p, p) float
        Of the amplitudes; nan where one is not known, which then adds nothing.

    Notes
    -----
    First order: with f = B a, √(gᵀ C g) / fᵀ f where g = Bᵀ f. A change of the amplitudes' units changes nothing; for columns that are
    orthogonal and of one length it is √(aᵀ C a) / aᵀ a.
    """
    field = basis @ amplitudes
    square, pull = float(field @ field), basis.T @ field
    variance = float(pull @ np.nan_to_num(covariance) @ pull)
    return math.sqrt(max(variance, 0.0)) / square if square > 0.0 else 0.0


def side_points(grid: CellGrid) -> SurfacePoints:
    """Centres of all fillet and flank cells on the nominal gear, in the order of the side maps."""
    gear = grid.gear
    tooth, half, row, column = (a.ravel() for a in np.indices(grid.side_shape))
    side, z = np.array(Side)[half], grid.row_middles[row]
    roll = np.append(np.full(grid.fillet, gear.form_roll), grid.column_middles)[column]
    points = flank_points(gear, tooth, side, roll, z)
    on_fillet = np.flatnonzero(column < grid.fillet)
    radius = grid.fillet_middles[column[on_fillet]]
    angle = tooth[on_fillet] * gear.pitch_angle + side[on_fillet] * gear.half_angle(radius)
    fillet = locate(twisted(gear, np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z[on_fillet]])), gear)
    points.surface[on_fillet], points.roll[on_fillet] = FILLET, np.nan
    points.position[on_fillet], points.normal[on_fillet] = fillet.position, fillet.normal
    return points
