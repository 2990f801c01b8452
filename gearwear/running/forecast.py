"""The forecast of a gear whose running is known: run on as it ran, in place of the law at the rate so far."""

from __future__ import annotations

from dataclasses import replace

from gearwear.errors import InputError
from gearwear.loaded.steel import Material
from gearwear.running.effects.base import RunEffect
from gearwear.running.found import FoundRunning, SecondLoop
from gearwear.wear_law.running import forecast_by_running
from gearwear.wear_law.study import WearStudy

MOST_CYCLES_RATIO = 3.0
"""Cycles asked for over cycles run up to which is run on: beyond, no band was measured against a truth, and the law's wide one stands."""


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
        Cycles to a limit stay those of the law: its rate is the greater, so they come out too few rather than too many.
    """
    forecast, fit = study.forecast, study.best
    within = forecast is not None and forecast.cycles_run < forecast.cycles.max() <= MOST_CYCLES_RATIO * forecast.cycles_run
    ran = any(isinstance(one.effect, RunEffect) for one in second.effects)
    if forecast is None or fit is None or not (ran and within):
        return study
    try:
        by_running = forecast_by_running(
            fit, forecast.cycles_run, forecast.cycles, load_per_width, material, misalignment=shown_gap(second)
        )
    except InputError:  # no sliding wear to run on from: the law's stands
        return study
    return replace(study, forecast=by_running)


def shown_gap(second: SecondLoop) -> float:
    """The gap that this gear's own flanks show, mm; what a mate that wears takes of the whole is not in it."""
    gap, rate = (_size(second.effect(name), key) for name, key in (("misalignment", "gap_um"), ("mate_wear", "rate")))
    return 1e-3 * gap / (1.0 + rate)


def _size(found: FoundRunning | None, name: str) -> float:
    value = 0.0 if found is None else found.parameters[name].value
    return float(value) if isinstance(value, float) else 0.0
