"""Truth against found, for one scan. The result is plain data, one JSON line a scan.

Names are matched one to one, the best first:

name         a found effect has the name of a true one
alternative  the true name is among the found effect's `alternatives`
group        both stand in the same documented identifiability group (reference E, G1 … G7)
missed       none of these

A found effect is a **false name** if it matches no true effect and has no true name among its alternatives.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.loop_study.detection import Visibility
from benchmarks.loop_study.fitting import Fitted
from benchmarks.loop_study.scenario import Scenario
from benchmarks.loop_study.truth import Placement, as_found, turn_error
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import ParameterEstimate
from gearwear.diagnose.loop import FoundEffect
from tests.synthetic import AbrasiveWear, SlidingWear, SyntheticScan, pose_error

GROUPS: Mapping[str, str] = {e.name: e.group for e in catalogue() if e.group}
LAWS = ("sliding_wear", "abrasive_wear")


@dataclass(frozen=True, slots=True)
class Found:
    """What matters of a found effect for its name."""

    name: str
    alternatives: tuple[str, ...]


def match(true: Sequence[str], found: Sequence[Found]) -> tuple[list[tuple[str, int | None]], list[bool]]:
    """Match true names with found effects, one to one.

    Parameters
    ----------
    true : sequence of str
    found : sequence of Found

    Returns
    -------
    matches : list of (how, index)
        For each true effect: "name", "alternative", "group" or "missed", and which found effect it was.
    false : list of bool
        For each found effect: whether its name is false.
    """
    result: list[tuple[str, int | None]] = [("missed", None)] * len(true)
    free = set(range(len(found)))
    rules: dict[str, Callable[[str, Found], bool]] = {
        "name": lambda name, f: f.name == name,
        "alternative": lambda name, f: name in f.alternatives,
        "group": lambda name, f: bool(GROUPS.get(name)) and GROUPS.get(name) == GROUPS.get(f.name),
    }
    for how, same in rules.items():
        for i, name in enumerate(true):
            if result[i][0] == "missed":
                j = next((j for j in sorted(free) if same(name, found[j])), None)
                if j is not None:
                    result[i] = (how, j)
                    free.discard(j)
    false = [j in free and not any(name in f.alternatives for name in true) for j, f in enumerate(found)]
    return result, false


def parameter_errors(found: Mapping[str, ParameterEstimate], true: Mapping[str, Any], tooth: int) -> dict[str, dict[str, float]]:
    """Error and standard deviation of every parameter that the truth has too (the exponent of a relief it has not: all are straight); of a list
    (pitch) the entry of one tooth stands for all.

    Parameters
    ----------
    found : dict of ParameterEstimate
    true : dict
        As `as_found` gives it.
    tooth : int
        Which entry of a list.
    """
    result = {}
    for name, estimate in found.items():
        if name not in true:
            continue
        value, std, right = estimate.value, estimate.std, true[name]
        if isinstance(value, tuple):
            assert isinstance(std, tuple)
            value, std, right = value[tooth], std[tooth], right[tooth]
        assert isinstance(std, float)
        error = turn_error(name, value, float(right))
        result[name] = {"true": float(right), "error": error, "std": std if math.isfinite(std) and std > 0.0 else math.nan}
    return result


def score(scenario: Scenario, scan: SyntheticScan, fitted: Fitted, seen: Mapping[str, Visibility]) -> dict[str, Any]:
    """Everything the table needs of one scan.

    Parameters
    ----------
    scenario : Scenario
    scan : SyntheticScan
    fitted : Fitted
    seen : dict of Visibility
        From `detection.visibilities`.
    """
    loop, recipe, truth = fitted.loop, scenario.recipe, scan.truth
    registration = fitted.placed.registration
    error = pose_error(registration.pose.rotation, registration.pose.translation, truth.pose, truth.outline)
    placement = Placement.of(error)
    laws = _true_laws(scenario)
    named = [e for e in loop.effects if not (e.name in LAWS and laws)]  # a wear law where there is one is no false name
    matches, false = match([e.name for e in scenario.declared], [Found(e.name, e.alternatives) for e in named])
    draw = int(scenario.seed)
    true = []
    for effect, (how, index) in zip(scenario.declared, matches, strict=True):
        entry: dict[str, Any] = {"name": effect.name, "parameters": _plain(effect.parameters), "match": how} | _seen(
            seen[effect.name]
        )
        if index is not None:
            entry["found"] = named[index].name
        if how == "name" and index is not None:
            right = as_found(effect, placement, truth.outline, truth.pose, registration.pose.rotation)
            entry["errors"] = parameter_errors(named[index].parameters, right, draw % recipe.gear.teeth)
        true.append(entry)
    outside = scenario.outside
    noise, texture = recipe.noise_um, 0.0 if recipe.texture is None else recipe.texture.sd_um
    worn = {(r.tooth, r.side): r for r in fitted.wear.regions}
    where = {placement.flank(f.tooth, f.side, recipe.gear.teeth): f for f in truth.flanks}
    return {
        "label": scenario.label,
        "scan": _describe(scenario) | {"points": len(scan.points)},
        "true": true,
        "outside": None if outside is None else {"name": outside.name, "parameters": _plain(outside.parameters)} | _seen(seen[outside.name]),
        "found": [_found(e) | {"false": wrong} for e, wrong in zip(named, false, strict=True)],
        "laws_found": [e.name for e in loop.effects if e not in named],
        "patterns": [p.describe(recipe.gear.face_width) for p in loop.patterns],
        "noise_um": {"true": noise, "texture": texture, "found": 1e3 * loop.noise},
        "rms_um": {
            "put_in": math.hypot(noise, texture), "before": 1e3 * loop.rms_before, "after": 1e3 * loop.rms_after,
            "held_out_before": 1e3 * loop.held_out_before, "held_out_after": 1e3 * loop.held_out_after,
        },
        "pose": {
            "turn_um": 1e3 * truth.outline.base_radius * error.turn, "tilt_um": 1e3 * truth.outline.tip_radius * error.tilt,
            "flipped": placement.flipped, "teeth": placement.teeth,
        },
        "wear": {
            "true": truth.volume_mm3, "true_found": sum(f.volume_mm3 for at, f in where.items() if at in worn),
            "after": fitted.wear.volume, "std": fitted.wear.volume_std, "before": fitted.wear_before.volume,
            "limits": list(fitted.limits), "std_before": fitted.wear_before.volume_std, "worn_side": [int(side) for side in fitted.worn_sides],
            "flanks": [
                {"true": f.volume_mm3, "depth_um": f.max_depth_um, "found": worn[at].volume if at in worn else None,
                 "std": worn[at].volume_std if at in worn else None}
                for at, f in where.items()
            ],
            "false_flanks": [{"volume": r.volume, "std": r.volume_std, "depth_um": 1e3 * r.max_depth} for at, r in worn.items() if at not in where],
        },
        "texture": {"found_um": 1e3 * math.sqrt(max(loop.covariance.texture, 0.0)), "use": float(np.mean(loop.use[fitted.first.seen]))},
        "seconds": {"registration": fitted.registration_seconds, "loop": fitted.loop_seconds},
    }  # fmt: skip


def _true_laws(scenario: Scenario) -> bool:
    return any(isinstance(w, SlidingWear | AbrasiveWear) for w in scenario.recipe.wear)


def _seen(v: Visibility) -> dict[str, Any]:
    return {"contribution_um": 1e3 * v.contribution, "snr": v.snr, "power": v.power, "detectable": v.detectable, "limit": v.limit}


def _found(e: FoundEffect) -> dict[str, Any]:
    return {
        "name": e.name,
        "alternatives": list(e.alternatives),
        "parameters": {k: {"value": x.value, "std": x.std, "unit": x.unit} for k, x in e.parameters.items()},
        "p": e.evidence.p_value,
        "contribution_um": 1e3 * e.evidence.contribution,
        "n_eff": e.evidence.effective_number,
        "gain_in_errors": e.evidence.held_out_gain / max(e.evidence.held_out_error, 1e-300),
    }


def _plain(parameters: Mapping[str, Any]) -> dict[str, Any]:
    return {k: list(v) if isinstance(v, tuple) else v for k, v in parameters.items()}


def _describe(scenario: Scenario) -> dict[str, Any]:
    r = scenario.recipe
    texture = None if r.texture is None else {"sd_um": r.texture.sd_um, "length_mm": r.texture.length_mm, "kind": r.texture.kind}
    return {
        "teeth": r.gear.teeth, "module": r.gear.module, "face_width": r.gear.face_width, "bore": r.gear.bore_diameter, "ends": r.ends,
        "noise_um": r.noise_um, "texture": texture, "jitter": r.jitter, "outliers": r.outliers, "lost": r.lost, "holes": len(r.holes),
        "fillets_follow": r.fillets_follow, "pose": r.pose, "wear": [_wear(w) for w in r.wear],
    }  # fmt: skip


def _wear(w: Any) -> str:
    if isinstance(w, SlidingWear):
        return f"sliding ({w.law}) {w.depth_um:.0f} µm, side {w.side:+d}"
    return (
        f"patch {w.depth_um:.0f} µm on tooth {w.tooth} side {w.side:+d}, r {w.r[0]:.1f}…{w.r[1]:.1f}, z {w.z[0]:.1f}…{w.z[1]:.1f}"
    )
