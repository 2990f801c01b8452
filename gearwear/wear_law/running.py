"""The forecast that runs on: wear with elastic teeth, fitted to the measured profile and continued.

A run hangs on k N alone, not on k and N: one run for each mate and each compliance model tells every amount of wear there was. Each
moment of each run is weighed by how well it fits the measured profile; the forecast is what all of them come to when they run on as long again
as was asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.loaded.pair_compliance import COUPLING_MODULES, PairCompliance, coupling_length
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import tooth_compliance
from gearwear.loaded.wearing import WearMember, run_wear, run_wear_ensemble
from gearwear.meshing.slices import common_width, uneven_across_face
from gearwear.threads import on_one_thread
from gearwear.wear_law.fit import WearFit, check_confidence
from gearwear.wear_law.forecast import Band, FlankState, Quantity, WearForecast, forecast_by

MATE_RATES = (0.0, 0.5, 1.5)
"""Wear coefficients of the mate over that of the gear that are tried: hard, as the gear about, softer."""
STIFFNESSES = (0.85, 1.0, 1.15)
"""Factors on the compliance that are tried: how far models and a stated load may be off."""
MODEL_SHARE = 0.10
"""What no run has of a depth, as a share of it: standard deviation, the same over `MODEL_LENGTH`."""
MODEL_FLOOR = 0.0007
"""mm; the same of a depth of nothing: a run is rough from cell to cell by about as much."""
MODEL_LENGTH = 2.0
"""mm of roll over which that is alike."""
LEAST_MATE_SHARE = 0.1
"""Least weight that each mate keeps: on an aligned pair a mate that wears looks like another load sharing, and the profile takes it for a hard one."""
DRAWS = 600
"""Moments drawn from all runs."""
MOST_APART = 2.0
"""Factor by which a place may wear faster or slower than a run says; numerical, for places where hardly anything is lost."""
_MOMENTS = 41
"""Times at which a run is kept; linear between."""
_PLACES = 200
"""Amounts of wear so far that are weighed in each run."""
_POSITIONS, _POSITIONS_UNEVEN, _SLICES, _SLICES_HELICAL = 72, 32, 5, 6
"""Positions a pitch of a pair alike across its face and of others, askew, helical or modified along it, and slices of these."""
_SMOOTHING_CELLS = 2.0
"""Cells along the flank over which a run is smoothed: finite steps leave it rough, and a contact is wider than a cell."""
_REACH = 1.4
"""Amount of wear so far up to which is looked, as a multiple of what the law says."""
_MOST_LOOKS = 3
"""Times it is looked for the amount of wear so far, each time up to twice as far."""


@dataclass(frozen=True, slots=True)
class WearHistory:
    """One run.

    Parameters
    ----------
    mate_rate, softness : float
        Of the mate's wear, and of the compliance.
    corners : bool
        Whether tip corners touch.
    time : (m,) float
        k N, mm²/N, rising from 0.
    roll : (n,) float
        mm.
    depth : (m, n) float
        mm.
    """

    mate_rate: float
    softness: float
    corners: bool
    time: Floats
    roll: Floats
    depth: Floats

    def at(self, time: Floats, roll: Floats) -> Floats:
        """Depth (len(time), len(roll)), mm; linear in time and along the flank."""
        place = np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2)
        part = ((time - self.time[place]) / (self.time[place + 1] - self.time[place]))[:, None]
        along = np.array([np.interp(roll, self.roll, row) for row in self.depth])
        return np.asarray((1.0 - part) * along[place] + part * along[place + 1], dtype=np.float64)


@on_one_thread
def run_histories(
    gear: Gear,
    mate: Gear,
    centre_distance: float,
    load_per_width: float,
    longest: float,
    material: Material | None = None,
    misalignment: float = 0.0,
    side: Side = Side.LEFT,
) -> tuple[WearHistory, ...]:
    """Runs of a worn gear with mates of several rates, teeth of several compliances, and tip corners that dig or do not touch.

    Parameters
    ----------
    gear, mate : Gear
        The worn one first; which of them drives makes no difference here.
    centre_distance : float
        mm.
    load_per_width : float
        Transverse force on all pairs per face width, N/mm.
    longest : float
        k N up to which to run, mm²/N.
    material : Material or None
        None: steel.
    misalignment : float
        Gap over the face that this gear's flanks show, mm; a mate that wears takes as much more of it as it wears faster.
    side : Side
        Flanks of the gear that carry.

    Returns
    -------
    tuple of WearHistory
        The middle compliance is that of plane finite elements; the depth of a pair that is misaligned, helical or modified along the face is the mean over it.
    """
    from scipy.ndimage import gaussian_filter1d

    steel = Material() if material is None else material
    teeth, times = (tooth_compliance(gear, steel), tooth_compliance(mate, steel)), np.linspace(0.0, longest, _MOMENTS)
    as_drawn = uneven_across_face(gear, mate)
    uneven = as_drawn or misalignment != 0.0
    best = PairCompliance(teeth, steel, coupling_length(gear, COUPLING_MODULES) if uneven else 0.0)
    scales = sorted({STIFFNESSES[0], STIFFNESSES[-1]}) if uneven else STIFFNESSES
    members = [WearMember(replace(best, scale=scale), rate) for scale in scales for rate in MATE_RATES]
    histories = []
    for corners in (True, False):
        if uneven:
            force = load_per_width * common_width(gear, mate)
            gap = (
                misalignment if as_drawn else abs(misalignment)
            )  # a plain spur flank is worn the other way up, alike in the mean
            runs = [
                run_wear(
                    gear, mate, centre_distance, force, member.compliance, times.tolist(), member.mate_rate, side,
                    misalignment=gap * (1.0 + member.mate_rate), slices=_SLICES_HELICAL if gear.twist != 0.0 else _SLICES,
                    positions_per_pitch=_POSITIONS_UNEVEN, corners=corners,
                )
                for member in members
            ]  # fmt: skip
            roll, rough = runs[0][0].roll, np.array([[state.depth.mean(axis=0) for state in states] for states in runs])
        else:
            roll, rough = run_wear_ensemble(
                gear, mate, centre_distance, load_per_width, members, times, _POSITIONS, corners=corners
            )
        depth = gaussian_filter1d(rough, _SMOOTHING_CELLS, axis=-1, mode="nearest")
        histories += [
            WearHistory(member.mate_rate, member.compliance.scale, corners, times, roll, each)
            for member, each in zip(members, depth, strict=True)
        ]
    return tuple(histories)


@on_one_thread
def forecast_by_running(
    fit: WearFit,
    cycles_run: float,
    cycles: Floats,
    load_per_width: float,
    material: Material | None = None,
    confidence: float = 0.95,
    misalignment: float = 0.0,
    side: Side = Side.LEFT,
) -> WearForecast:
    """Forecast the wear of a flank by running it on with elastic teeth.

    Parameters
    ----------
    fit : WearFit
        Holds the measured profile with its covariance; of the law itself only single contact is used, for where to look.
    cycles_run : float
        Mesh cycles of the gear so far.
    cycles : (m,) float
        Cycles since new for which to forecast, not below `cycles_run`.
    load_per_width : float
        Transverse force on all pairs per face width, N/mm.
    material : Material or None
    confidence : float
        Of the band.
    misalignment, side
        As for `run_histories`.

    Returns
    -------
    WearForecast
        The value is the median.

    Raises
    ------
    InputError
        If cycles or force are not positive, cycles lie before now, the confidence is none, or no wear is seen.

    Notes
    -----
    ``depth(N) = measured + (run(k N) − run(k N_run)) · measured / run(k N_run)``: a place that lost more than a run says carried more, or slid more, and
    goes on so; up to `MOST_APART`, with what is measured smoothed where no point is. Weights are ``exp(−χ²/2)`` with the covariance of the profile and, for what no run has,
    `MODEL_SHARE` of the depth. From the draws come median and quantiles; the error of the measured depth, and `MODEL_SHARE` of what is still to
    come, are drawn with them. A distance Δ beyond the points measured a depth errs by ``MODEL_SHARE √(1 − exp(−2 Δ / MODEL_LENGTH))`` of it as well: what is
    left of an error with covariance ``exp(−Δ / MODEL_LENGTH)`` where it is known at the last point.
    """
    check_confidence(confidence)
    asked = np.atleast_1d(np.asarray(cycles, dtype=np.float64))
    if not (
        cycles_run > 0.0 and load_per_width > 0.0 and (asked >= cycles_run * (1.0 - 1e-12)).all() and np.isfinite(asked).all()
    ):
        raise InputError("forecast: load and cycles run above 0, and cycles not below those run, are needed")
    ratio = asked / cycles_run
    runs = _likely_runs(fit, load_per_width, max(float(ratio.max()), 1.0), material, misalignment, side)
    state = FlankState.of(fit)
    depth = _drawn_depths(fit, state, runs, ratio)
    tail = 0.5 * (1.0 - confidence)

    def band(values: Floats) -> Band:
        low, value, high = np.quantile(values, [tail, 0.5, 1.0 - tail], axis=1)
        return Band(value, low, high)

    def band_of(quantity: Quantity) -> Band:
        of = forecast_by(state, quantity, None)
        return band(np.array([[of(row) for row in rows] for rows in depth]))

    return WearForecast(
        cycles=asked,
        roll=state.roll,
        depth=band(depth),
        greatest_depth=band_of("depth"),
        thickness_loss=band_of("thickness"),
        backlash_increase=band_of("backlash"),
        models=len(runs.histories),
        cycles_run=cycles_run,
        by_running=True,
    )


@dataclass(frozen=True, slots=True)
class _LikelyRuns:
    """Runs (k of them), amounts of wear so far (n,), mm²/N, and the weight of each amount in each run (k, n), 1 in all."""

    histories: tuple[WearHistory, ...]
    moments: Floats
    weights: Floats


def _likely_runs(
    fit: WearFit, load_per_width: float, longest: float, material: Material | None, misalignment: float, side: Side
) -> _LikelyRuns:
    """Runs up to `longest` times the wear so far, with how likely they are by the measured profile."""
    start = fit.amount / load_per_width
    if not start > 0.0:
        raise InputError("forecast: no sliding wear is seen to run on from")
    for _ in range(_MOST_LOOKS):
        most = _REACH * start
        histories = run_histories(
            fit.gear, fit.mate, fit.centre_distance, load_per_width, most * longest, material, misalignment, side
        )  # fmt: skip
        moments, weights = _weighed(fit, histories, most)
        if int(weights.sum(axis=0).argmax()) < len(moments) - 1:
            break
        start *= 2.0  # the likeliest is the most that was looked at: more may be likelier
    return _LikelyRuns(histories, moments, weights)


def _drawn_depths(fit: WearFit, state: FlankState, runs: _LikelyRuns, ratio: Floats) -> Floats:
    """Depths after each multiple of the cycles run, (ratios, draws, n) mm, drawn from what is known of runs, profile and model."""
    random = np.random.default_rng(len(fit.roll))
    picked = random.choice(runs.weights.size, DRAWS, p=runs.weights.ravel())
    which, moment = np.divmod(picked, len(runs.moments))
    depth = np.empty((len(ratio), DRAWS, len(state.roll)))
    # What a run leaves of the measured profile stays as it is, smoothed; beyond the points that were measured the run alone speaks.
    near = state.near
    error = random.normal(size=(DRAWS, 1)) * np.sqrt(np.einsum("ij,jk,ik->i", near, fit.errors, near))
    more = 1.0 + MODEL_SHARE * random.normal(size=(DRAWS, 1))
    # What no run has is alike over a length: of places beyond the points, at either end, the nearest of these says so much the less.
    beyond = np.maximum(np.maximum(fit.roll[0] - state.roll, state.roll - fit.roll[-1]), 0.0)
    loose = random.normal(size=(DRAWS, 2))[:, (state.roll > fit.roll[-1]).astype(int)] * np.sqrt(
        -np.expm1(-2.0 * beyond / MODEL_LENGTH)
    )
    for index, history in enumerate(runs.histories):
        on = which == index
        if not on.any():
            continue
        time = runs.moments[moment[on]]
        before = history.at(time, state.roll)
        left = (fit.depth - history.at(time, fit.roll)) @ near.T
        now = before + left
        now = np.maximum(now + error[on] + loose[on] * np.hypot(MODEL_SHARE * np.maximum(now, 0.0), MODEL_FLOOR), 0.0)
        # Where more is lost than a run says, more load was carried or more slid, and goes on so.
        share = np.clip(now / np.maximum(before, MODEL_FLOOR), 1.0 / MOST_APART, MOST_APART)
        for i, times in enumerate(ratio):
            grown = share * np.maximum(history.at(np.minimum(times * time, history.time[-1]), state.roll) - before, 0.0)
            depth[i, on] = now + grown * more[on]
    return depth


def _weighed(fit: WearFit, histories: Sequence[WearHistory], most: float) -> tuple[Floats, Floats]:
    """Amounts of wear so far (n,), mm²/N, and the weight of each in each run (k, n), 1 in all."""
    moments = np.linspace(0.0, most, _PLACES + 1)[1:]
    # Of the smoothed depth, so that a share of noise is not taken for a share of wear.
    model_error = np.hypot(MODEL_SHARE * np.maximum(fit.fitted, 0.0), MODEL_FLOOR)
    alike = np.exp(-np.abs(fit.roll[:, None] - fit.roll) / MODEL_LENGTH)
    white = np.linalg.inv(np.linalg.cholesky(fit.errors + model_error[:, None] * alike * model_error))
    chi_square = np.array([(((history.at(moments, fit.roll) - fit.depth) @ white.T) ** 2).sum(axis=1) for history in histories])
    # Where even the best leaves more than its errors allow, differences count for less.
    freedom = max(len(fit.roll) - 2, 1)
    unit = max(1.0, float(chi_square.min()) / freedom)
    weights = np.zeros_like(chi_square)
    rates = np.array([history.mate_rate for history in histories])
    likely = np.exp(-0.5 * (chi_square - chi_square.min()) / unit)
    for rate in np.unique(rates):
        on = rates == rate
        within = np.exp(-0.5 * (chi_square[on] - chi_square[on].min()) / unit)
        share = max(float(likely[on].sum() / likely.sum()), LEAST_MATE_SHARE)
        weights[on] = share * within / within.sum()
    return moments, np.asarray(weights / weights.sum(), dtype=np.float64)
