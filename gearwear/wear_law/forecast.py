"""What more cycles would do to a worn flank, from a fitted wear law: depth, tooth thickness, backlash.

There is no forecast without a fit. It holds for the same load, speed, lubricant and alignment. Wear changes how pairs share
the load, from about half of the elastic deflection on; how, this law does not know. So the value goes on at the fitted rate,
and the band holds every load sharing that there can be: where two pairs touch, from none of the load to all of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.card import Card, CardRow, few
from gearwear.design.given import check_choice, check_number, check_several, check_within, real_array
from gearwear.design.quantity import as_given, at_least, at_most, outside
from gearwear.errors import InputError, check_kind
from gearwear.meshing.path import PathOfContact
from gearwear.threads import on_one_thread
from gearwear.wear_law.archard import specific_sliding
from gearwear.wear_law.fit import WearFit, alike_fits, check_confidence

Quantity = Literal["depth", "thickness", "backlash"]
"""Greatest depth on the path of contact (mm, normal), loss of tooth thickness (mm, arc), growth of the normal backlash (mm)."""

FITS = "what gw.fit_wear_law returns"
FAR_CYCLES_RATIO = 2.0
"""Times the cycles run, from which on a forecast is far: as much again is lost, and the contact is not what the rate was found on."""
EARLY_CONTACT_PITCHES = 0.15
"""Base pitches at each end of single contact in which load may bring a second pair in: at 300 N/mm the contact ratio of the published pair
grows from 1.25 to 1.59 (`gearwear.loaded`)."""
_PLACES = 401
"""Places on the path of contact at which the depth is reckoned, besides the borders of single contact."""
_ACROSS = 33
"""Places across the face of helical teeth at which the depth under a contact line is reckoned."""
_SMOOTHING_SHARE = 0.05
"""Share of the path of contact over which what the law leaves is smoothed (standard deviation of the weights)."""

_MAX_CYCLES_RATIO = 1e9
"""Times the cycles run; what takes longer is said to be never."""


@dataclass(frozen=True, slots=True)
class Band:
    """A forecast with the limits of its band; (m,) per number of cycles, or (m, n) along the flank too; mm."""

    value: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True, repr=False)
class WearForecast(Card):
    """Wear against cycles.

    Parameters
    ----------
    cycles : (m,) float
        Mesh cycles of the gear since it was new.
    roll : (n,) float
        Length of roll over the path of contact, mm.
    depth : Band
        (m, n) depth along the flank.
    greatest_depth, thickness_loss, backlash_increase : Band
        (m,) see `forecast_wear`; the thickness nan where the reference circle lies off the path of contact.
    models : int
        Models that the band holds: of load sharing, those the profile cannot tell apart; or runs.
    cycles_run : float
        Mesh cycles of the gear so far.
    by_running : bool
        Whether it was run on with elastic teeth (`gearwear.wear_law.running`), not by the law.
    """

    cycles: Floats
    roll: Floats
    depth: Band
    greatest_depth: Band
    thickness_loss: Band
    backlash_increase: Band
    models: int
    cycles_run: float
    by_running: bool = False

    @property
    def far(self) -> Bools:
        """(m,) which of the cycles are more than twice the cycles run."""
        return np.asarray(self.cycles > FAR_CYCLES_RATIO * self.cycles_run, dtype=np.bool_)

    def headline(self) -> str:
        return f"from {self.cycles_run:.3g} mesh cycles on, for the same load, speed, lubricant and alignment"

    def rows(self) -> list[CardRow]:
        bands = ((self.greatest_depth, "deepest"), (self.thickness_loss, "thickness"), (self.backlash_increase, "backlash"))
        rows = []
        for i, cycles in enumerate(self.cycles):
            text = ", ".join(
                f"{name} {1e3 * b.value[i]:.1f} µm ({1e3 * b.low[i]:.1f} … {1e3 * b.high[i]:.1f})"
                for b, name in bands
                if math.isfinite(b.value[i])
            )
            rows.append((f"{cycles:.3g} cycles", text + ("; beyond twice the cycles run" if self.far[i] else "")))
        return few(rows)


@dataclass(frozen=True, slots=True, repr=False)
class CyclesLeft(Card):
    """Cycles from now until a limit is reached, and the limits of the band; 0 is reached already, inf is never."""

    value: float
    low: float
    high: float

    def headline(self) -> str:
        if self.value == 0.0:
            return "none, the limit is reached already"
        said, low, high = ("no end" if math.isinf(x) else f"{x:.3g}" for x in (self.value, self.low, self.high))
        return f"{said} ({low} … {high}) more mesh cycles"


@on_one_thread
def forecast_wear(
    fits: WearFit | Sequence[WearFit], cycles_run: float, cycles: Floats, radius: float | None = None, confidence: float = 0.95
) -> WearForecast:
    """Forecast the wear of a flank.

    Parameters
    ----------
    fits : WearFit or sequence of WearFit
        The law fitted to the flank as it is now, as `fit_wear_law` gives it: the best counts, and the band holds all that
        cannot be told from it (`alike_fits`).
    cycles_run : float
        Mesh cycles of the gear so far (its own revolutions, for one mate).
    cycles : (m,) float
        Cycles since new for which to forecast, not below `cycles_run`.
    radius : float or None
        Where the loss of thickness is asked, mm; None: the reference circle, and nan where that lies off the path of contact.
    confidence : float
        Of the band, above 0 and below 1.

    Returns
    -------
    WearForecast

    Raises
    ------
    InputError
        If there is no fit, the confidence is none, the cycles are not positive or lie before now, or a radius that is given lies off the path of
        contact.

    Notes
    -----
    ``depth(N) = measured + (N/N_run − 1) · fitted``: what the law does not explain stays as it is. ``measured`` is the law and what
    it leaves, smoothed, so that it reaches to the ends of the path, where points are few and sliding is greatest. Its standard
    deviation is ``σ_measured + (N/N_run − 1) σ_fitted``, as if both were wrong in the same sense: an upper bound. Where load sharing
    models cannot be told apart, the band reaches from the lowest to the highest of theirs.

    Load sharing changes as flanks wear. In single contact it cannot: the rate stays, but for `EARLY_CONTACT_PITCHES` at its ends. Where two pairs touch, the band reaches from the
    even loss alone, as if the pair carried nothing more, to all of the load at the coefficient of single contact (`WearFit.single_contact`)
    or of the fit, whichever is greater.

    Thickness loss is that of one flank, ``r · depth(L(r)) / (r_b cos β_b)`` of transverse arc at `radius`. The backlash grows by the greatest
    over the mesh of the least depth of the pairs in contact: all teeth of the gear alike, the mate as it is, deviations
    added on the line of action (`linear`). That is an upper bound. Rigid contact never gives more; past the ends of the path corners
    carry, and where sliding wear is steep there it gives less: 2 % less at 3 µm of greatest depth, 15 % at 75 µm. Measured flanks carry
    on their highest places, and their backlash grows by less still.
    """
    check_confidence(confidence)
    fits = _alike(fits)
    asked = np.atleast_1d(real_array("cycles", cycles))
    ahead = asked / _positive(cycles_run) - 1.0
    if not ((ahead >= -1e-12) & np.isfinite(ahead)).all():
        raise InputError(f"cycles {float(np.min(asked)):g}: must not be below the cycles run, {cycles_run:g}")
    states = [FlankState.of(fit) for fit in fits]
    measures = [forecast_by(states[0], quantity, radius) for quantity in ("depth", "thickness", "backlash")]
    value = np.array([states[0].depth(g, 0.0) for g in ahead])
    sides = [[np.array([s.depth(g, sign * s.reach(confidence)) for g in ahead]) for s in states] for sign in (-1.0, 1.0)]
    low, high = np.min(sides[0], axis=0), np.max(sides[1], axis=0)
    depth, thickness, backlash = (
        Band(*(np.array([measure(row) for row in rows]) for rows in (value, low, high))) for measure in measures
    )
    return WearForecast(
        cycles=asked,
        roll=states[0].roll,
        depth=Band(value, low, high),
        greatest_depth=depth,
        thickness_loss=thickness,
        backlash_increase=backlash,
        models=len(fits),
        cycles_run=cycles_run,
    )


@on_one_thread
def cycles_left(
    fits: WearFit | Sequence[WearFit],
    cycles_run: float,
    limit: float,
    quantity: Quantity,
    radius: float | None = None,
    confidence: float = 0.95,
) -> CyclesLeft:
    """Cycles until a limit is reached.

    Parameters
    ----------
    fits, cycles_run
        As for `forecast_wear`.
    limit : float
        mm of `quantity`; there is no default.
    quantity : {"depth", "thickness", "backlash"}
        What the limit is for.
    radius, confidence
        As for `forecast_wear`.

    Returns
    -------
    CyclesLeft

    Raises
    ------
    InputError
        If there is no fit, the limit or the cycles run are not positive, the confidence is none, or a thickness is asked for off the path of contact.

    Examples
    --------
    A flank that lost 5 µm everywhere in a million cycles, known to 0.1 µm, loses 20 µm in three million more:

    >>> from gearwear.design import Gear, GearSpec
    >>> from gearwear.wear_law.fit import fit_wear_law
    >>> pinion, gear = (Gear.from_spec(GearSpec(name, z, 6.35, 15.0)) for name, z in (("pinion", 12), ("gear", 24)))
    >>> roll = np.linspace(4.0, 26.0, 60)
    >>> fits = fit_wear_law(pinion, gear, 114.3, roll, np.full(60, 0.005), np.full(60, 1e-4))
    >>> left = cycles_left(fits, 1e6, 0.020, "backlash")
    >>> [round(n / 1e6, 2) for n in (left.low, left.value, left.high)]
    [2.95, 3.0, 3.03]
    """
    check_confidence(confidence)
    check_within("limit", limit, math.ulp(0.0), math.inf, "a number above 0, in mm,")
    check_choice("quantity", quantity, get_args(Quantity))
    run, states = _positive(cycles_run), [FlankState.of(fit) for fit in _alike(fits)]
    measure = measured_by(states[0], quantity, radius)

    def reached(sign: float, some: list[FlankState]) -> list[float]:
        return [run * _until(lambda ahead: measure(s.depth(ahead, sign * s.reach(confidence))), limit) for s in some]  # noqa: B023

    return CyclesLeft(reached(0.0, states[:1])[0], min(reached(1.0, states)), max(reached(-1.0, states)))


def _alike(fits: WearFit | Sequence[WearFit]) -> tuple[WearFit, ...]:
    each = [fits] if isinstance(fits, WearFit) else check_several("fits", fits, FITS)
    for fit in each:
        check_kind(fit, WearFit, "one of fits", FITS)
    if not each:
        raise InputError("forecast: there is no fit of the wear law, and without one there is no forecast")
    return alike_fits(tuple(each))


def _positive(cycles_run: float) -> float:
    check_within("cycles_run", cycles_run, math.ulp(0.0), math.inf, "a number above 0, the cycles in which the wear came about,")
    return cycles_run


@dataclass(frozen=True, slots=True)
class FlankState:
    """A flank over the whole path of contact, (n,) each, mm: depth now, depth by the law, and their standard deviations; and what may be lost
    in as many cycles more with the least and with the most of the load, and how far that may be off."""

    fit: WearFit
    path: PathOfContact
    roll: Floats
    now: Floats
    now_std: Floats
    law: Floats
    least: Floats
    most: Floats
    least_std: Floats
    most_std: Floats
    near: Floats
    """(n, points) weights by which each place takes what a curve leaves round it."""

    @classmethod
    def of(cls, fit: WearFit) -> FlankState:
        path = fit.path
        low, high = path.single_contact_pinion
        special = [
            path.pitch_pinion,
            *(x + side * 1e-9 for x in (low, high) for side in (-1.0, 1.0)),
        ]  # the law has a kink, and may step
        special = [x for x in special if path.start_pinion < x < path.end_pinion]
        roll = np.unique([*np.linspace(path.start_pinion, path.end_pinion, _PLACES), *special])
        basis = fit.terms(roll)
        # Each place takes what the law leaves round it.
        near = np.exp(-0.5 * ((roll[:, None] - fit.roll) / (_SMOOTHING_SHARE * path.length)) ** 2) / fit.std**2 + 1e-300
        near /= near.sum(axis=1, keepdims=True)
        state = basis @ fit.estimator + near @ (np.eye(len(fit.roll)) - fit.basis @ fit.estimator)
        now_std = np.sqrt(np.einsum("ij,jk,ik->i", state, fit.errors, state))
        law_std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", basis, fit.covariance, basis), 0.0))
        law = basis @ fit.coefficients
        margin = EARLY_CONTACT_PITCHES * path.base_pitch
        alone = (roll > low + margin) & (roll < high - margin)
        least, most = _limits(fit, roll, alone, law, law_std)
        return cls(
            fit=fit,
            path=path,
            roll=roll,
            now=state @ fit.depth,
            now_std=now_std,
            law=law,
            least=least[0],
            most=most[0],
            least_std=least[1],
            most_std=most[1],
            near=near,
        )

    def reach(self, confidence: float) -> float:
        """Standard deviations to the limits of the band."""
        return float(self.fit.reach(confidence).max())

    def depth(self, ahead: float, times: float) -> Floats:
        """Depth after `ahead` times the cycles run more, plus so many standard deviations."""
        now = self.now + times * self.now_std
        if times < 0.0:  # wear does not heal: a band may widen, but what is gone is gone
            return now + ahead * np.maximum(self.least + times * self.least_std, 0.0)
        if times > 0.0:
            return now + ahead * (self.most + times * self.most_std)
        return now + ahead * self.law


def _limits(
    fit: WearFit, roll: Floats, alone: Bools, law: Floats, law_std: Floats
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Least and most that the flank can lose in as many cycles more, with standard deviations, (n,) mm; `law` in single contact."""
    there, std = fit.single_contact, fit.coefficient_stds
    sliding = specific_sliding(fit.gear, fit.mate, fit.centre_distance, roll)
    full = [(fit.coefficients[:2], std[:2])]
    if math.isfinite(there.sliding):
        full.append((np.array([there.sliding, there.uniform]), np.array([there.sliding_std, there.uniform_std])))
    losses = [(a * sliding + b, np.hypot(sa * sliding, sb)) for (a, b), (sa, sb) in full]
    upper = [(law, law_std), *losses]
    which = np.argmax([loss for loss, _ in upper], axis=0)
    most, most_std = (np.choose(which, [bounds[i] for bounds in upper]) for i in (0, 1))
    even, even_std = min((float(b), float(sb)) for (_, b), (_, sb) in full)
    least, least_std = np.minimum(law, even), np.full_like(law, even_std)
    return (np.where(alone, law, least), np.where(alone, law_std, least_std)), (
        np.where(alone, law, most),
        np.where(alone, law_std, most_std),
    )


def measured_by(state: FlankState, quantity: Quantity, radius: float | None) -> Callable[[Floats], float]:
    """The quantity as a function of the depth along the flank; never falls when the depth rises anywhere."""
    if quantity == "depth":
        return lambda depth: float(depth.max())
    gear, roll, path = state.fit.gear, state.roll, state.path
    if quantity == "thickness":
        r = gear.reference_radius if radius is None else radius
        check_number("radius", r, "mm")
        at = math.sqrt(max(r * r - gear.base_radius**2, 0.0))
        if not _on_path(state, at):
            raise InputError(
                f"radius {as_given(r)} mm (L = {outside(at, roll[0], roll[-1], 5)} mm): the path of contact runs from L = {at_least(roll[0], 3)} to {at_most(roll[-1], 3)} mm"
            )
        return lambda depth: r / gear.normal_lever * float(np.interp(at, roll, depth))
    pairs = roll + _beside(path)[:, None]
    # Without the ends themselves: at the border of single contact the lone pair's depth counts.
    touching = (pairs > path.start_pinion) & (pairs < path.end_pinion)
    if path.overlap_ratio == 0.0:
        touching[1] = True
    else:
        touching[:, ~touching.any(axis=0)] = True
    return lambda depth: float(np.where(touching, np.interp(pairs, roll, depth), np.inf).min(axis=0).max())


def forecast_by(state: FlankState, quantity: Quantity, radius: float | None) -> Callable[[Floats], float]:
    """As `measured_by`; nan for a thickness at the reference circle where no radius is asked for and that circle lies off the path."""
    gear = state.fit.gear
    if quantity == "thickness" and radius is None and not _on_path(state, gear.reference_roll):
        return lambda depth: math.nan
    return measured_by(state, quantity, radius)


def _on_path(state: FlankState, roll: float) -> bool:
    return bool(state.roll[0] <= roll <= state.roll[-1])


def _beside(path: PathOfContact) -> Floats:
    """Rolls at which teeth touch besides one place, mm: a base pitch away; of helical teeth all along the lines across the face."""
    if path.overlap_ratio == 0.0:
        return path.base_pitch * np.array([-1.0, 0.0, 1.0])
    wide = path.overlap_ratio * path.base_pitch
    many = math.ceil((path.length + wide) / path.base_pitch)
    across = np.linspace(0.0, wide, _ACROSS)
    return np.asarray((path.base_pitch * np.arange(-many, many + 1)[:, None] + across).ravel(), dtype=np.float64)


def _until(grown: Callable[[float], float], limit: float) -> float:
    """Least factor g ≥ 0 with grown(g) ≥ limit, by bisection; inf where there is none."""
    if grown(0.0) >= limit:
        return 0.0
    high = 1.0
    while grown(high) < limit:
        high *= 2.0
        if high > _MAX_CYCLES_RATIO:
            return math.inf
    low = 0.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if grown(middle) >= limit else (middle, high)
    return high
