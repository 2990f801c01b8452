"""How the wear came about and how it goes on: the wear law on the worn flanks of one side, and the forecast from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.given import check_choice, check_several, check_within
from gearwear.design.quantity import as_given, shown
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.found import Loop
from gearwear.errors import InputError
from gearwear.meshing.path import PathOfContact
from gearwear.placing.cells import Cells
from gearwear.placing.registration import stray_limit
from gearwear.placing.strays import near_centre
from gearwear.wear.regions import Wear
from gearwear.wear.uncertainty import noise_covariance
from gearwear.wear_law.across import AcrossFace, wear_across_face
from gearwear.wear_law.fit import WearFit, alike_fits, fit_wear_law
from gearwear.wear_law.forecast import FAR_CYCLES_RATIO, CyclesLeft, Quantity, WearForecast, cycles_left, forecast_wear
from gearwear.wear_law.teeth import LEAST_TEETH, alike_teeth, in_proportion, worn_teeth

FORM_MARGIN_MODULES = 0.06
"""Length of roll, in modules, next to the form circle that is left out: dL = (r / L) dr carries points a long way there."""
TIP_MARGIN_MODULES = 0.02
"""The same next to the tip: scanners round the corner."""
DEEP_QUANTILE = 0.99
"""Share of the points that are less deep than what is taken for the greatest depth."""
MAX_PLACES_PER_COLUMN = 6
"""Most places in a column of cells: sliding is steep near the form circle and has a kink at the pitch point."""
POINTS_PER_PLACE = 6
"""Points of each tooth wanted at a place."""
PLACES = 121
"""Places at which the law is given from end to end of the path of contact."""
LEAST_EXPLAINED = 0.5
"""Least share of the mean square depth that the law must explain for a forecast."""

OFF_PATH_NOTE = "nothing is forecast of the thickness: the reference circle lies off the path of contact"


@dataclass(frozen=True, slots=True)
class Ahead:
    """What to forecast from the wear law.

    Parameters
    ----------
    cycles_run : float
        Mesh cycles of the gear so far: its own revolutions, for one mate.
    cycles : tuple of float
        Cycles since new for which to forecast, none below `cycles_run`.
    limits : tuple of (quantity, float)
        Limits in mm: greatest "depth" on the flank, loss of "thickness" (arc at the reference circle), growth of the normal "backlash".

    Raises
    ------
    InputError
        If cycles or a limit are no number above 0, cycles lie before now, or a limit is of something else.
    """

    cycles_run: float
    cycles: tuple[float, ...] = ()
    limits: tuple[tuple[Quantity, float], ...] = ()

    def __post_init__(self) -> None:
        least = math.ulp(0.0)
        check_within("cycles_run", self.cycles_run, least, math.inf, "a number above 0, the cycles in which the wear came about,")
        for cycles in check_several("cycles", self.cycles, "cycles since new"):
            check_within(
                "cycles", cycles, self.cycles_run, math.inf, f"a number from cycles_run, {as_given(self.cycles_run)}, up"
            )
        for pair in check_several("limits", self.limits, "pairs such as ('depth', 0.2)"):
            if not (isinstance(pair, Sequence) and not isinstance(pair, str) and len(pair) == 2):
                raise InputError(f"limits = {shown(pair)}: pairs such as ('depth', 0.2), in mm, would be right")
            check_choice("what limits are of", pair[0], get_args(Quantity))
            check_within(f"limit of the {pair[0]}", pair[1], least, math.inf, "a number above 0, in mm,")


@dataclass(frozen=True, slots=True)
class CyclesToLimit:
    """Cycles from now until `quantity` reaches `limit` (mm), with its band."""

    quantity: Quantity
    limit: float
    left: CyclesLeft

    @property
    def never(self) -> bool:
        """Whether the law never reaches the limit."""
        return math.isinf(self.left.value)

    def far(self, cycles_run: float) -> bool:
        """Whether the limit lies beyond `FAR_CYCLES_RATIO` times the cycles run."""
        return cycles_run + self.left.value > FAR_CYCLES_RATIO * cycles_run


@dataclass(frozen=True, slots=True)
class WearStudy:
    """The wear law on the mean profile of one side, and what it says of the time ahead.

    Parameters
    ----------
    side : Side
    teeth, left_out : tuple of int
        0-based: in the mean; worn too, but unlike the others.
    fits : tuple of WearFit
        The best first; empty where none was possible.
    why_not : str
        What kept the law from being fitted, or the forecast from being made; "" where nothing did.
    forecast : WearForecast or None
        At the cycles run and those asked for; None where none was asked for, or possible.
    left : tuple of CyclesToLimit
        One per limit asked for.
    volume_share : float
        Part of all the volume lost that the flanks in the mean lost; nan where that was not measured.
    across : AcrossFace or None
        How even their wear is across the face; None where that was not seen.
    note : str
        What a reader of the fit must know; "" for nothing.
    """

    side: Side
    teeth: tuple[int, ...]
    left_out: tuple[int, ...]
    fits: tuple[WearFit, ...]
    why_not: str
    forecast: WearForecast | None = None
    left: tuple[CyclesToLimit, ...] = ()
    volume_share: float = 0.0
    across: AcrossFace | None = None
    note: str = ""

    @property
    def best(self) -> WearFit | None:
        """The best fit; None where none was possible."""
        return self.fits[0] if self.fits else None

    @property
    def sharing_alike(self) -> tuple[str, ...]:
        """Other load sharing models that fit as well."""
        return tuple(fit.sharing.value for fit in alike_fits(self.fits)[1:]) if self.fits else ()

    @property
    def path(self) -> PathOfContact | None:
        """Path of contact of the worn gear and its mate, the worn one first; None without a fit."""
        fit = self.best
        return None if fit is None else fit.path

    @property
    def over_path(self) -> tuple[Floats, Floats]:
        """Length of roll and depth by the law, mm, from end to end of the path of contact, beyond the points it was fitted to."""
        fit, path = self.best, self.path
        if fit is None or path is None:
            return np.zeros(0), np.zeros(0)
        edge = 1e-9 * path.length
        borders = [x + side * edge for x in path.single_contact_pinion for side in (-1.0, 1.0)]
        roll = np.unique([*np.linspace(path.start_pinion, path.end_pinion, PLACES), *borders, path.pitch_pinion])
        return roll, fit.terms(roll) @ fit.coefficients


def study_wear(
    wear: Wear,
    points: SurfacePoints,
    cells: Cells,
    side: Side,
    mate: Gear,
    centre_distance: float,
    loop: Loop | None,
    noise: float,
    ahead: Ahead | None = None,
) -> WearStudy:
    """Fit the wear law to the worn flanks of one side, and forecast from it.

    Parameters
    ----------
    wear : Wear
        The wear found.
    points : SurfacePoints
        Flank points; `deviation` is from the as-made gear.
    cells : Cells
        The cells the wear was found on.
    side : Side
    mate : Gear
        The gear it runs with.
    centre_distance : float
        mm.
    loop : Loop or None
        Where the as-made gear comes from: texture, and how well pose and effects are known. None: points err by themselves.
    noise : float
        Scatter of points, mm.
    ahead : Ahead or None
        What to forecast.

    Returns
    -------
    WearStudy
        Without a fit, and so without a forecast, where fewer than 3 teeth are worn on that side; `why_not` says so.
    """
    half = side.index
    worn = worn_teeth(wear, half)
    if len(worn) < LEAST_TEETH:
        seen = f"wear on {len(worn)} {'tooth' if len(worn) == 1 else 'teeth'} of one side" if len(worn) else "no wear was found"
        why = f"{seen}; a law is fitted from {LEAST_TEETH} worn teeth on"
        return WearStudy(side=side, teeth=(), left_out=(), fits=(), why_not=why)
    kept = alike_teeth(wear, half)
    lost = sum(region.volume for region in wear.regions if region.side == side and region.tooth in kept)
    study = WearStudy(
        side=side,
        teeth=tuple(int(tooth) for tooth in kept),
        left_out=tuple(int(tooth) for tooth in worn if tooth not in kept),
        fits=(),
        why_not="",
        volume_share=lost / wear.volume if wear.volume > 0.0 else 0.0,
    )
    if len(kept) < LEAST_TEETH:
        why = f"{len(worn)} flanks of one side are worn, but {len(kept)} of them alike; a law is fitted from {LEAST_TEETH} on"
        return replace(study, why_not=why)
    study = replace(study, across=wear_across_face(cells, half, kept, loop, noise))
    try:
        roll, width, depth, errors = tooth_profiles(points, cells, half, kept, loop, noise)
        fits = fit_wear_law(cells.grid.gear, mate, centre_distance, roll, depth, errors, width=width)
    except InputError as error:
        return replace(study, why_not=str(error))
    study = replace(study, fits=fits)
    return study if ahead is None else _forecast(study, ahead)


def tooth_profiles(
    points: SurfacePoints, cells: Cells, half: int, teeth: Ints, loop: Loop | None, noise: float
) -> tuple[Floats, Floats, Floats, Floats]:
    """Depth of some flanks along the profile, each the mean over its face width.

    Parameters
    ----------
    points : SurfacePoints
        Flank points; `deviation` is from the as-made gear. In and outside the regions of wear, so that the profile is not cut off at
        what is significant.
    cells : Cells
        The same in cells: where a flank was seen over half its width.
    half : int
        0 left, 1 right.
    teeth : (k,) int
        0-based.
    loop : Loop or None
        Where the as-made gear comes from.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    roll : (n,) float
        Length of roll of the foot points, mm. Sliding is linear in 1 / L, so it is the harmonic mean.
    width : (n,) float
        Length of roll over which the depth is a mean, mm.
    depth : (k, n) float
        Mean depth, mm. Where a tooth was not seen it is taken to be worn as the others in its own proportion; nan where hardly any was.
    errors : (n, n) float
        Covariance of the mean over the teeth, mm²: noise of the points, texture, and what both leave uncertain of pose and effects.
    """
    grid, count = cells.grid, len(teeth)
    gear, orientation = grid.gear, grid.gear.orientation
    place = np.full(gear.teeth, -1)
    place[teeth] = np.arange(count)
    on = np.flatnonzero((points.side == tuple(Side)[half]) & (place[points.tooth] >= 0))
    # Next to the form circle lie the feet of points that the wear has carried over it.
    carried = gear.base_helix_cosine * max(float(np.quantile(-points.deviation[on], DEEP_QUANTILE)), 0.0)
    near_form = gear.form_roll + orientation * FORM_MARGIN_MODULES * gear.transverse_module + orientation * carried
    near_tip = gear.tip_roll - orientation * TIP_MARGIN_MODULES * gear.transverse_module
    lowest, highest = sorted((near_form, near_tip))
    on = on[(points.roll[on] >= lowest) & (points.roll[on] <= highest)]
    tooth, roll, lost = place[points.tooth[on]], points.roll[on], -points.deviation[on]
    finer = int(np.clip(len(on) / (count * grid.flank * POINTS_PER_PLACE), 1, MAX_PLACES_PER_COLUMN))
    edges = np.sqrt(np.linspace(lowest**2, highest**2, finer * grid.flank + 1))
    bins = np.clip(np.searchsorted(edges, roll) - 1, 0, len(edges) - 2)
    shape = (count, len(edges) - 1)
    index = tooth * shape[1] + bins
    number = np.bincount(index, minlength=count * shape[1]).reshape(shape).astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        depth = np.bincount(index, lost, minlength=number.size).reshape(shape) / number
        at = number.sum(axis=0) / np.bincount(bins, 1.0 / roll, minlength=shape[1])
    column = grid.flank_column(0.5 * (edges[1:] + edges[:-1]))
    seen = np.stack([grid.flank_shape(cells.seen.astype(np.float64))[k, half] for k in teeth])
    depth[(seen.mean(axis=1)[:, column] < 0.5) | (number < 1.0)] = np.nan
    depth = np.where(np.isfinite(depth).sum(axis=0) >= LEAST_TEETH, in_proportion(depth), np.nan)
    used = np.isfinite(depth).all(axis=0) & np.isfinite(at)
    white = (noise**2 / np.maximum(number, 1.0)).sum(axis=0) / count**2
    errors = _column_errors(cells, half, teeth, seen, loop, noise)[np.ix_(column, column)] + np.diag(white)
    return at[used], np.diff(edges)[used], depth[:, used], errors[np.ix_(used, used)]


def _column_errors(cells: Cells, half: int, teeth: Ints, seen: Floats, loop: Loop | None, noise: float) -> Floats:
    """Covariance, mm², of mean depths over columns of cells by all that neighbouring places share: not the noise of the points."""
    grid = cells.grid
    weights = np.zeros((grid.flank, *grid.side_shape))
    share = seen / np.maximum(seen.sum(axis=(0, 1)), 1.0)
    for column in range(grid.flank):
        weights[column, teeth, half, :, grid.fillet + column] = share[..., column]
    whole = noise_covariance(cells, noise, loop, weights)
    count = np.stack([grid.flank_shape(cells.count)[tooth, half] for tooth in teeth])
    return np.asarray(whole - np.diag((share**2 * noise**2 / np.maximum(count, 1.0)).sum(axis=(0, 1))), dtype=np.float64)


def as_made_points(points: SurfacePoints, cell: Ints, measured: Cells, as_made: Cells, loop: Loop | None) -> SurfacePoints:
    """Flank points with their deviation from the as-made gear, without strays.

    Parameters
    ----------
    points : SurfacePoints
        As measured, n points.
    cell : (n,) int
        Cell of each point; −1: none.
    measured, as_made : Cells
        The same in cells, and what is left of them against the as-made gear. What the effects of the loop do not say of the difference
        (unexplained patterns, a scan before wear) is taken off each point as off its cell's mean.
    loop : Loop or None
        Where the as-made gear comes from.
    """
    on = (points.surface == FLANK) & (cell >= 0) & near_centre(points.deviation, cell, measured.grid, stray_limit(points))
    flank, cell = points.take(on), cell[on]
    taken = as_made.points.deviation - measured.points.deviation
    if loop is not None:
        seen, every = measured.seen, frozenset(Kind) - {Kind.WEAR}
        taken[seen] += loop.deviation(measured.points.take(seen), every)
        flank = flank.with_deviation(flank.deviation - loop.deviation(flank, every))
    rest = flank.deviation + taken[cell]
    return flank.with_deviation(rest).take(np.isfinite(rest))


def _forecast(study: WearStudy, ahead: Ahead) -> WearStudy:
    share = study.fits[0].explained[0]
    if not share >= LEAST_EXPLAINED:
        said = f"{100 * max(share, 0.0):.0f} %" if np.isfinite(share) else "nothing"
        return replace(
            study, why_not=f"no forecast: the law explains {said} of the measured wear, and half is the least to go on with"
        )
    try:
        forecast = forecast_wear(study.fits, ahead.cycles_run, np.array([ahead.cycles_run, *ahead.cycles]))
        thick = math.isfinite(forecast.thickness_loss.value[0])
        asked = [(quantity, limit) for quantity, limit in ahead.limits if thick or quantity != "thickness"]
        left = tuple(_left(study.fits, ahead.cycles_run, quantity, limit) for quantity, limit in asked)
    except InputError as error:
        return replace(study, why_not=f"no forecast: {error}")
    return replace(study, forecast=forecast, left=left, note=study.note if thick else OFF_PATH_NOTE)


def _left(fits: tuple[WearFit, ...], cycles_run: float, quantity: Quantity, limit: float) -> CyclesToLimit:
    return CyclesToLimit(quantity, limit, cycles_left(fits, cycles_run, limit, quantity))
