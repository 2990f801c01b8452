"""How the wear came about and how it goes on: the wear law on the mean worn profile of one side, and the forecast from it."""

from __future__ import annotations

import math

import numpy as np
from scipy import ndimage

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.profiles import SIGN
from gearwear.diagnose.covariance import CellCovariance
from gearwear.errors import InputError
from gearwear.measure.cells import CellGrid
from gearwear.meshing.wear_forecast import Quantity, cycles_left, forecast_wear
from gearwear.meshing.wear_law import WearFit, fit_wear_law
from gearwear.report.results import Ahead, CyclesToLimit, WearStudy
from gearwear.wear.laws import LEAST_TEETH, alike_teeth, worn_teeth
from gearwear.wear.regions import Wear


def study_wear(
    wear: Wear,
    grid: CellGrid,
    side: int,
    mate: Gear,
    centre_distance: float,
    covariance: CellCovariance | None,
    noise: float,
    ahead: Ahead | None = None,
) -> WearStudy:
    """Fit the wear law to the mean profile of the worn flanks of one side, and forecast from it.

    Parameters
    ----------
    wear : Wear
        The wear found.
    grid : CellGrid
        The cells it was found on.
    side : int
        +1 left, −1 right.
    mate : Gear
        The gear it runs with.
    centre_distance : float
        mm.
    covariance : CellCovariance or None
        Of what the closed loop leaves: how far errors along the profile are alike. None: not known, taken as independent.
    noise : float
        Scatter of points, mm.
    ahead : Ahead or None
        What to forecast.

    Returns
    -------
    WearStudy
        Without a fit, and so without a forecast, where fewer than 3 teeth are worn on that side; `why_not` says so.
    """
    half = SIGN.index(side)
    worn = worn_teeth(wear, half)
    if len(worn) < LEAST_TEETH:
        return WearStudy(
            side,
            (),
            (),
            (),
            f"worn on {len(worn)} {'tooth' if len(worn) == 1 else 'teeth'} of one side; a law is fitted from {LEAST_TEETH} on",
        )
    kept = alike_teeth(wear, half)
    left_out = tuple(int(tooth) for tooth in worn if tooth not in kept)
    teeth = tuple(int(tooth) for tooth in kept)
    try:
        roll, depth, std = mean_profile(wear, grid, half, kept, noise)
        length = correlation_length(grid, covariance)
        fits = fit_wear_law(grid.gear, mate, centre_distance, roll, depth, std, correlation_length=length)
    except InputError as error:
        return WearStudy(side, teeth, left_out, (), str(error))
    if ahead is None:
        return WearStudy(side, teeth, left_out, fits, "")
    return _forecast(WearStudy(side, teeth, left_out, fits, ""), fits[0], ahead)


def mean_profile(wear: Wear, grid: CellGrid, half: int, teeth: Ints, noise: float) -> tuple[Floats, Floats, Floats]:
    """Mean depth of some flanks along the profile.

    Parameters
    ----------
    wear : Wear
        The wear found; depth is taken in and outside its regions, so that the mean is not cut off at what is significant.
    grid : CellGrid
        Its cells.
    half : int
        0 left, 1 right.
    teeth : (k,) int
        0-based.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    roll, depth, std : (n,) float
        Length of roll of the foot points, mean depth over the face width and the teeth, and its standard deviation from
        tooth to tooth (a running mean along the profile), not below what the noise of the points makes; mm.
    """
    sheets = wear.sheets
    seen = sheets.seen[teeth, half][..., sheets.fillet :]
    depth = np.where(seen, -sheets.deviation[teeth, half][..., sheets.fillet :], np.nan)
    usable = seen.mean(axis=1) >= 0.5  # else another place on the face would stand for the whole of it
    own = np.where(usable, np.nansum(depth, axis=1) / np.maximum(seen.sum(axis=1), 1), np.nan)
    number = usable.sum(axis=0)
    columns = number >= LEAST_TEETH
    own, number = own[:, columns], number[columns]
    mean = np.nanmean(own, axis=0)
    scatter = np.nanvar(own, axis=0, ddof=1) / number
    if len(scatter):
        scatter = ndimage.uniform_filter1d(scatter, max(3, len(scatter) // 8), mode="nearest")
    points = sheets.count[teeth, half][..., sheets.fillet :].sum(axis=(0, 1))[columns]
    std = np.sqrt(np.maximum(scatter, noise**2 / np.maximum(points, 1.0)))
    # Sliding is linear in 1 / L, and points lie evenly in L²: its mean over a cell is its value midway between the edges.
    edges = grid.roll_edges
    at = 0.5 * (edges[1:] + edges[:-1])[columns]
    return at + mean, mean, std  # the foot of a point d below the flank has d more roll than the point itself


def correlation_length(grid: CellGrid, covariance: CellCovariance | None) -> float:
    """Length of roll, mm, over which errors of cell means fall to 1 / e of their correlation; 0 where they are independent."""
    if covariance is None or covariance.texture <= 0.0 or not 0.0 < covariance.column_step < 1.0:
        return 0.0
    cell = (grid.gear.tip_roll - grid.gear.form_roll) / grid.flank
    return -cell / math.log(covariance.column_step)


def _forecast(study: WearStudy, fit: WearFit, ahead: Ahead) -> WearStudy:
    try:
        cycles = np.array([ahead.cycles_run, *ahead.cycles])
        forecast = forecast_wear(fit, ahead.cycles_run, cycles)
        left = tuple(_left(fit, ahead.cycles_run, quantity, limit) for quantity, limit in ahead.limits)
    except InputError as error:
        return WearStudy(study.side, study.teeth, study.left_out, study.fits, f"no forecast: {error}")
    return WearStudy(study.side, study.teeth, study.left_out, study.fits, "", forecast, left)


def _left(fit: WearFit, cycles_run: float, quantity: Quantity, limit: float) -> CyclesToLimit:
    return CyclesToLimit(quantity, limit, cycles_left(fit, cycles_run, limit, quantity))
