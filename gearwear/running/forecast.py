"""The forecast of a gear whose running is known: run on as it ran, in place of the law at the rate so far."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.loaded.steel import Material
from gearwear.running.effects.base import RunEffect
from gearwear.running.found import SecondLoop
from gearwear.wear_law.forecast import Band, CyclesLeft, WearForecast
from gearwear.wear_law.running import forecast_by_running
from gearwear.wear_law.study import CyclesToLimit, WearStudy

MOST_CYCLES_RATIO = 3.0
"""Cycles asked for over cycles run up to which is run on: beyond, no band was measured against a truth, and the law's wide one stands."""
STEPS = 12
"""Equal steps of the run ahead between which cycles to a limit are interpolated; numerical."""


def run_on(study: WearStudy, second: SecondLoop, load_per_width: float, material: Material) -> WearStudy:
    """A wear study with its forecast by running, where the second loop explains the wear by a run.

    Parameters
    ----------
    study : WearStudy
        With a forecast by the law.
    second : SecondLoop
        How the pair ran.
    load_per_width : float
        N/mm.
    material : Material

    Returns
    -------
    WearStudy
        The same where none was asked for beyond the cycles run, the law does as well as any run, or more than `MOST_CYCLES_RATIO` times the cycles are asked for.
        Cycles to a limit are those of the same run; beyond the cycles asked for it goes on at its last rate, which is no slower than it will be.
    """
    forecast, fit = study.forecast, study.best
    within = forecast is not None and forecast.cycles_run < forecast.cycles.max() <= MOST_CYCLES_RATIO * forecast.cycles_run
    ran = any(isinstance(effect.effect, RunEffect) for effect in second.effects)
    if forecast is None or fit is None or not (ran and within):
        return study
    asked, between = forecast.cycles, np.linspace(forecast.cycles_run, forecast.cycles.max(), STEPS + 1)
    every = np.concatenate([asked, between if study.left else []])
    try:
        run = forecast_by_running(
            fit, forecast.cycles_run, every, load_per_width, material, misalignment=shown_gap(second), side=study.side
        )
    except InputError:  # no sliding wear to run on from: the law's stands
        return study
    beyond = _rows(run, slice(len(asked), None))
    return replace(study, forecast=_rows(run, slice(len(asked))), left=tuple(_left(beyond, limit) for limit in study.left))


def _rows(forecast: WearForecast, rows: slice) -> WearForecast:
    """The forecast at some of its cycles."""
    depth, greatest, thickness, backlash = (
        Band(band.value[rows], band.low[rows], band.high[rows])
        for band in (forecast.depth, forecast.greatest_depth, forecast.thickness_loss, forecast.backlash_increase)
    )
    return replace(
        forecast,
        cycles=forecast.cycles[rows],
        depth=depth,
        greatest_depth=greatest,
        thickness_loss=thickness,
        backlash_increase=backlash,
    )


def _left(run: WearForecast, limit: CyclesToLimit) -> CyclesToLimit:
    """The cycles until the run reaches a limit; the band of the run at its upper side reaches it first."""
    band = {"depth": run.greatest_depth, "thickness": run.thickness_loss, "backlash": run.backlash_increase}[limit.quantity]
    value, low, high = (reached(run.cycles, grown, limit.limit) - run.cycles_run for grown in (band.value, band.high, band.low))
    return replace(limit, left=CyclesLeft(max(value, 0.0), max(low, 0.0), max(high, 0.0)))


def reached(cycles: Floats, grown: Floats, limit: float) -> float:
    """Cycles at which what has grown to `grown` (m,) at `cycles` (m,) is at a limit: straight between them, and beyond the last as in the last step."""
    there = np.flatnonzero(grown >= limit)
    if len(there) and there[0] == 0:
        return float(cycles[0])
    after = int(there[0]) if len(there) else len(cycles) - 1
    rate = float((grown[after] - grown[after - 1]) / (cycles[after] - cycles[after - 1]))
    return float(cycles[after - 1]) + (limit - float(grown[after - 1])) / rate if rate > 0.0 else math.inf


def shown_gap(second: SecondLoop) -> float:
    """The gap that this gear's own flanks show, mm; what a mate that wears takes of the whole is not in it."""
    askew = second.effect("misalignment")
    whole = second.conditions.stated if askew is None else 1e-3 * float(np.asarray(askew.parameters["gap_um"].value))
    # The gap was fitted beside this rate, whether or not that was named.
    return whole / (1.0 + second.conditions.mate_rate)
