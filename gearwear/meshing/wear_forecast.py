"""What more cycles would do to a worn flank, from a fitted wear law: depth, tooth thickness, backlash.

There is no forecast without a fit. It holds for the same load, speed, lubricant and alignment, and while the shape of
the contact stays what it was: the law's rate is taken as constant.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.meshing.path import path_of_contact
from gearwear.meshing.wear_law import WearFit

Quantity = Literal["depth", "thickness", "backlash"]
"""Greatest depth on the flank (mm, normal), loss of tooth thickness (mm, arc), growth of the normal backlash (mm)."""

_PLACES = 1001
"""Places on the path of contact where the pairs in contact are compared."""

_LONGEST = 1e9
"""Times the cycles run; what takes longer is said to be never."""


@dataclass(frozen=True, slots=True)
class Band:
    """A forecast with the limits of its band; (m,) per number of cycles, or (m, n) along the flank too; mm."""

    value: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True)
class WearForecast:
    """Wear against cycles.

    Parameters
    ----------
    cycles : (m,) float
        Mesh cycles of the gear since it was new.
    roll : (n,) float
        Length of roll, mm.
    depth : Band
        (m, n) depth along the flank.
    greatest_depth, thickness_loss, backlash_increase : Band
        (m,) see `forecast_wear`.
    """

    cycles: Floats
    roll: Floats
    depth: Band
    greatest_depth: Band
    thickness_loss: Band
    backlash_increase: Band


@dataclass(frozen=True, slots=True)
class CyclesLeft:
    """Cycles from now until a limit is reached, and the limits of the band; 0 is reached already, inf is never."""

    value: float
    low: float
    high: float


def forecast_wear(
    fit: WearFit, cycles_run: float, cycles: Floats, radius: float | None = None, confidence: float = 0.95
) -> WearForecast:
    """Forecast the wear of a flank.

    Parameters
    ----------
    fit : WearFit
        The law fitted to the flank as it is now.
    cycles_run : float
        Mesh cycles of the gear so far (its own revolutions, for one mate).
    cycles : (m,) float
        Cycles since new for which to forecast, not below `cycles_run`.
    radius : float or None
        Where the loss of thickness is asked, mm; None: the reference circle.
    confidence : float
        Of the band.

    Returns
    -------
    WearForecast

    Raises
    ------
    InputError
        If the cycles are not positive or lie before now, or the radius lies outside the fitted profile.

    Notes
    -----
    ``depth(N) = measured + (N/N_run − 1) · fitted``: what the law does not explain stays as it is. Its standard
    deviation is ``σ_measured + (N/N_run − 1) σ_fitted``, as if both were wrong in the same sense: an upper bound.

    Thickness loss is that of one flank, ``r · depth(L(r)) / r_b`` of arc at `radius`. The backlash grows by the greatest
    over the mesh of the least depth of the pairs in contact: all teeth of the gear alike, the mate as it is, deviations
    added on the line of action (`linear`). Rigid contact never gives more; near a hand-over corners carry, and it gives
    up to a tenth less where some µm of sliding wear end at the path's ends.
    """
    ahead = np.asarray(cycles, dtype=np.float64) / _positive(cycles_run) - 1.0
    if not (ahead >= -1e-12).all():
        raise InputError(f"cycles {float(np.min(cycles)):g}: must not be below the cycles run, {cycles_run:g}")
    measures = [_measure(fit, what, radius) for what in ("depth", "thickness", "backlash")]
    profiles = [np.array([_profile(fit, g, times) for g in ahead]) for times in _sides(confidence)]
    results = [Band(*(np.array([measure(row) for row in rows]) for rows in profiles)) for measure in measures]
    return WearForecast((1.0 + ahead) * cycles_run, fit.roll, Band(*profiles), *results)


def cycles_left(
    fit: WearFit, cycles_run: float, limit: float, quantity: Quantity, radius: float | None = None, confidence: float = 0.95
) -> CyclesLeft:
    """Cycles until a limit is reached.

    Parameters
    ----------
    fit, cycles_run, radius, confidence
        As for `forecast_wear`.
    limit : float
        mm of `quantity`; there is no default.
    quantity : {"depth", "thickness", "backlash"}
        What the limit is for.

    Returns
    -------
    CyclesLeft

    Raises
    ------
    InputError
        If the limit or the cycles run are not positive.

    Examples
    --------
    A flank that lost 5 µm everywhere in a million cycles, known to 0.1 µm, loses 20 µm in three million more:

    >>> from gearwear.design import Gear, GearSpec
    >>> from gearwear.meshing.wear_law import fit_wear_law
    >>> pinion, gear = (Gear.from_spec(GearSpec(name, z, 6.35, 15.0)) for name, z in (("pinion", 12), ("gear", 24)))
    >>> roll = np.linspace(4.0, 26.0, 60)
    >>> fit = fit_wear_law(pinion, gear, 114.3, roll, np.full(60, 0.005), np.full(60, 1e-4))[0]
    >>> left = cycles_left(fit, 1e6, 0.020, "depth")
    >>> [round(n / 1e6, 2) for n in (left.low, left.value, left.high)]
    [2.9, 3.0, 3.06]
    """
    if not limit > 0.0:
        raise InputError(f"limit {limit:g} mm: must be above 0")
    run, measure = _positive(cycles_run), _measure(fit, quantity, radius)

    def reached(times: float) -> float:
        return run * _until(lambda ahead: measure(_profile(fit, ahead, times)), limit)

    value, late, soon = (reached(times) for times in _sides(confidence))
    return CyclesLeft(value, soon, late)


def _positive(cycles_run: float) -> float:
    if not 0.0 < cycles_run < math.inf:
        raise InputError(f"cycles run {cycles_run:g}: must be above 0; a rate needs the cycles in which the wear came about")
    return cycles_run


def _sides(confidence: float) -> tuple[float, float, float]:
    """Standard deviations to add for the value, the low and the high side."""
    reach = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    return 0.0, -reach, reach


def _profile(fit: WearFit, ahead: float, times: float) -> Floats:
    """Depth along the flank after `ahead` times the cycles run more, plus so many standard deviations; mm."""
    depth = fit.depth + ahead * fit.fitted + times * (fit.std + ahead * fit.fitted_std)
    if times < 0.0:  # wear does not heal: a band may widen, but what is gone is gone
        depth = np.maximum(depth, fit.depth + times * fit.std)
    return depth


def _measure(fit: WearFit, quantity: Quantity, radius: float | None) -> Callable[[Floats], float]:
    """The quantity as a function of the depth along the flank; never falls when the depth rises anywhere."""
    if quantity == "depth":
        return lambda depth: float(depth.max())
    gear, roll = fit.gear, fit.roll
    if quantity == "thickness":
        r = gear.reference_radius if radius is None else radius
        at = math.sqrt(max(r * r - gear.base_radius**2, 0.0))
        if not roll[0] <= at <= roll[-1]:
            raise InputError(
                f"radius {r:g} mm (L = {at:.3f} mm): the fitted profile runs from L = {roll[0]:.3f} to {roll[-1]:.3f} mm"
            )
        return lambda depth: r / gear.base_radius * float(np.interp(at, roll, depth))
    path = path_of_contact(gear, fit.mate, fit.centre_distance)
    places = np.concatenate([np.linspace(path.start_pinion, path.end_pinion, _PLACES), path.single_contact_pinion])
    pairs = places + path.base_pitch * np.array([-1.0, 0.0, 1.0])[:, None]
    # Without the ends themselves: at the border of single contact the lone pair's depth counts.
    touching = (pairs > path.start_pinion) & (pairs < path.end_pinion)
    touching[1] = True
    return lambda depth: float(np.where(touching, np.interp(pairs, roll, depth), np.inf).min(axis=0).max())


def _until(grown: Callable[[float], float], limit: float) -> float:
    """Least factor g ≥ 0 with grown(g) ≥ limit, by bisection; inf where there is none."""
    if grown(0.0) >= limit:
        return 0.0
    high = 1.0
    while grown(high) < limit:
        high *= 2.0
        if high > _LONGEST:
            return math.inf
    low = 0.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if grown(middle) >= limit else (middle, high)
    return high
