"""One scan from its number to its score."""

from __future__ import annotations

from typing import Any

from benchmarks.loop_study.detection import visibilities
from benchmarks.loop_study.fitting import Fitted, designed, fit
from benchmarks.loop_study.scenario import Scenario, draw
from benchmarks.loop_study.scoring import score
from gearwear.errors import InputError
from tests.synthetic import SyntheticScan, make_scan


def run(label: str, seed: int, points: int) -> dict[str, Any]:
    """Make, fit and score a scan; a refusal by registration is a score of its own.

    Parameters
    ----------
    label : str
        "37", or "n37" for a null scan.
    seed : int
        Of the study.
    points : int
        Of the scan, about.
    """
    return study(draw(label, seed, points))[0]


def study(scenario: Scenario) -> tuple[dict[str, Any], SyntheticScan, Fitted | None]:
    """Score, scan and fit of a scenario."""
    scan = make_scan(scenario.recipe, scenario.seed)
    gear = designed(scenario.recipe.gear)
    try:
        fitted = fit(scan.points, gear, scenario.mate)
    except InputError as refusal:
        return {"label": scenario.label, "refused": str(refusal)}, scan, None
    return score(scenario, scan, fitted, visibilities(scenario, scan, fitted, gear)), scan, fitted
