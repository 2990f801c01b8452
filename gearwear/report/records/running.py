"""How the pair ran as plain numbers: `closed_loop` → `second` of `report.json`."""

from __future__ import annotations

import math

from gearwear.comparison.results import PairResult
from gearwear.report.records.numbers import Json, parameters_record
from gearwear.running.found import Errors, FoundRunning


def running_record(pair: PairResult | None) -> Json:
    """``second``, entries as in ``effects``, and ``second_errors``; or ``second_why_not``."""
    loop = None if pair is None else pair.second_loop
    if loop is None:
        why = "the design has one gear" if pair is None else str(pair.running)
        return {"second": [], "second_why_not": why}
    return {
        "second": [_effect(effect) for effect in loop.effects],
        "second_why_not": None,
        "second_errors": {
            "flank": str(loop.map.side),
            "teeth": [int(tooth) + 1 for tooth in loop.map.teeth],
            "single_contact_um": 1e3 * loop.amount,
            "before": _errors(loop.before),
            "after": _errors(loop.after),
        },
    }


def _effect(effect: FoundRunning) -> Json:
    return {
        "name": effect.name,
        "kind": "running",
        "parameters": parameters_record(effect.parameters),
        "alternatives": list(effect.alternatives),
        "tells_apart": effect.effect.tells_apart if effect.alternatives else None,
        "rms_before_um": 1e3 * effect.before.all,
        "rms_after_um": 1e3 * effect.after.all,
        "heldout_rms_before_um": 1e3 * effect.before.teeth,
        "heldout_rms_after_um": 1e3 * effect.after.teeth,
        "heldout": {"before": _errors(effect.before), "after": _errors(effect.after)},
        "evidence": {
            "statistic": "fall of chi-square, or for an order round the gear 2 F",
            "value": effect.gain,
            "degrees_of_freedom": [effect.degrees[0], effect.degrees[1] if math.isfinite(effect.degrees[1]) else None],
            "p_value": effect.p_value,
        },
    }


def _errors(errors: Errors) -> Json:
    in_mm = {
        "rms_um": errors.all,
        "heldout_teeth_rms_um": errors.teeth,
        "heldout_face_rms_um": errors.face,
        "heldout_double_contact_rms_um": errors.double_contact,
    }
    return {name: 1e3 * value if math.isfinite(value) else None for name, value in in_mm.items()}
