"""How the pair ran as plain numbers: `closed_loop` → `second` of `report.json`."""

from __future__ import annotations

import math

from gearwear.comparison.results import PairResult
from gearwear.report.records.numbers import Json, parameters_record
from gearwear.running.found import Errors, FoundRunning


def running_record(pair: PairResult | None) -> Json:
    """``second``, entries as in ``effects``, and ``second_errors``; or ``second_why_not``."""
    found = None if pair is None else pair.second_loop
    if found is None:
        why = "the design has one gear" if pair is None else str(pair.running)
        return {"second": [], "second_why_not": why}
    return {
        "second": [_effect(one) for one in found.effects],
        "second_why_not": None,
        "second_errors": {
            "flank": str(found.map.side),
            "teeth": [int(tooth) + 1 for tooth in found.map.teeth],
            "single_contact_um": 1e3 * found.amount,
            "before": _errors(found.before),
            "after": _errors(found.after),
        },
    }


def _effect(one: FoundRunning) -> Json:
    return {
        "name": one.name,
        "kind": "running",
        "parameters": parameters_record(one.parameters),
        "alternatives": list(one.alternatives),
        "tells_apart": one.effect.tells_apart if one.alternatives else None,
        "rms_before_um": 1e3 * one.before.all,
        "rms_after_um": 1e3 * one.after.all,
        "heldout_rms_before_um": 1e3 * one.before.teeth,
        "heldout_rms_after_um": 1e3 * one.after.teeth,
        "heldout": {"before": _errors(one.before), "after": _errors(one.after)},
        "evidence": {
            "statistic": "fall of chi-square, or for an order round the gear 2 F",
            "value": one.gain,
            "degrees_of_freedom": [one.degrees[0], one.degrees[1] if math.isfinite(one.degrees[1]) else None],
            "p_value": one.p_value,
        },
    }


def _errors(errors: Errors) -> Json:
    told = {
        "rms_um": errors.all,
        "heldout_teeth_rms_um": errors.teeth,
        "heldout_face_rms_um": errors.face,
        "heldout_double_contact_rms_um": errors.double_contact,
    }
    return {name: 1e3 * value if math.isfinite(value) else None for name, value in told.items()}
