"""Truth against report for one scan; plain data in, plain data out. Nothing is imported from the program that is judged.

A true effect is matched by its name, by a found effect's `alternatives`, or by its documented group (reference: effects that a scan
of flanks cannot tell apart); a found effect is a false name where it matches nothing, is not among what may be named, and has none
of these among its alternatives. Names close to what is in the scan but not of its shape (`near`) are counted by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Json = dict[str, Any]
GROUPS = {
    "G1": {"coating", "tooth_thickness", "profile_shift"},
    "G2": {"scale", "profile_slope", "axis_offset_radial"},
    "G3": {"axis_offset_lateral", "abrasive_wear"},
    "G4": {"eccentricity", "turntable_angle"},
    "G6": {"wobble"},
}
"""Names that data of flanks alone cannot tell apart."""
SIDED = {"axis_offset_lateral", "taper", "twist"}
"""Effects whose sign turns where the ends are taken the other way round."""
WITHIN = 1.959964
LAWS = {"Sliding"}


@dataclass(frozen=True)
class Placement:
    """How the found frame lies to the true one: tooth found = ± tooth + teeth."""

    flipped: bool
    teeth: int
    turn: float
    tilt: float

    @classmethod
    def of(cls, found: Json, truth: Json) -> Placement:
        pose = (found.get("views") or [found])[0]
        turn = np.array(pose["rotation"]) @ np.array(truth["poses"][0]["R"])
        angle = math.atan2(turn[1, 0], turn[0, 0])
        pitch = 2.0 * math.pi / truth["gear"]["teeth"]
        teeth = round(angle / pitch)
        return cls(bool(turn[2, 2] < 0.0), teeth, angle - teeth * pitch, math.acos(min(abs(turn[2, 2]), 1.0)))

    def flank(self, tooth: int, side: int, teeth: int) -> tuple[int, int]:
        """Tooth (from 0) and side as found."""
        return ((-tooth if self.flipped else tooth) + self.teeth) % teeth, -side if self.flipped else side


def score(line: Json) -> Json:
    """Score of one line of a study.

    Returns
    -------
    dict
        `ended` is "ok", "refused" or "failed"; the rest stands only where it is "ok".
    """
    truth = line["truth"]
    head = {
        "label": line["label"],
        "family": line["family"],
        "what": truth["what"],
        "seconds": line.get("processor_seconds") or line.get("seconds"),
        "peak_mb": line.get("peak_mb"),
    }
    for end in ("refused", "failed"):
        if end in line:
            return head | {"ended": end, "said": line[end]}
    found = line["found"]
    placement = Placement.of(found["registration"], truth)
    gear = truth["gear"]
    base = 0.5 * gear["module"] * gear["teeth"] * math.cos(math.radians(gear["pressure_angle"]))
    lost = abs(placement.turn) * base > 0.1 * gear["module"] or placement.tilt > 0.03
    return head | {
        "ended": "ok",
        "misplaced": bool(lost),
        "converged": found["registration"].get("converged"),
        "turn_um": 1e3 * placement.turn * base,
        **names(found, truth, placement),
        "volume": interval(_volume(found["wear"]), truth["volume_mm3"]),
        "flanks": flanks(found["wear"], truth, placement),
        "thinnest": thinnest(found["thickness"], found.get("thinnest"), truth, placement),
        "broken": broken(found, truth, placement),
        "notes": len(found.get("notes", ())),
    }


# Names --------------------------------------------------------------------------------------------------------------


def names(found: Json, truth: Json, placement: Placement) -> Json:
    """What of the effects was named, and what else was."""
    loop = found["closed_loop"]
    effects, declared = loop["effects"], truth["declared"]
    how: list[str] = ["missed"] * len(declared)
    by: list[int | None] = [None] * len(declared)
    free = set(range(len(effects)))
    rules: dict[str, Callable[[str, Json], bool]] = {
        "name": lambda name, e: e["name"] == name,
        "alternative": lambda name, e: name in _alternatives(e),
        "group": lambda name, e: _group(name) is not None and _group(name) == _group(e["name"]),
    }
    for rule, same in rules.items():
        for i, one in enumerate(declared):
            if how[i] == "missed":
                j = next((j for j in sorted(free) if same(one["name"], effects[j])), None)
                if j is not None:
                    how[i], by[i] = rule, j
                    free.discard(j)
    has_law = any(one["field"] in LAWS for one in truth["wear_fields"])
    # "A relief, or wear of the sides" is right where it is wear.
    right = {one["name"] for one in declared} | set(truth["may_name"]) | ({"sliding_wear"} if has_law else set())
    near, false, allowed = [], [], []
    for j in sorted(free):
        told = {effects[j]["name"], *_alternatives(effects[j])}
        if told & right:
            allowed.append(effects[j]["name"])
        elif told & set(truth["near"]):
            near.append(effects[j]["name"])
        else:
            false.append(effects[j]["name"])
    laws = [law["name"] for law in found["wear"].get("laws", ())]
    return {
        "true": [
            {"name": one["name"], "match": how[i], **({"parameters": parameters(one, effects[by[i]], placement)} if how[i] == "name" else {})}
            for i, one in enumerate(declared)
        ],
        "false": false,
        "near": near,
        "allowed": allowed,
        "outside": truth["outside"],
        "unexplained": bool(loop["unexplained"]["found"]),
        "laws": laws,
        "false_laws": [] if has_law else laws,
    }  # fmt: skip


def _alternatives(effect: Json) -> set[str]:
    return {one if isinstance(one, str) else one.get("name", "") for one in effect.get("alternatives") or ()}


def _group(name: str) -> str | None:
    return next((group for group, members in GROUPS.items() if name in members), None)


def parameters(true: Json, effect: Json, placement: Placement) -> Json:
    """For each parameter a perfect report would have: (found − true) and its standard deviation, in the reported unit."""
    result: Json = {}
    values = dict(true["parameters"])
    if true["name"] in SIDED and placement.flipped:
        values = {key: -value for key, value in values.items()}
    for key, right in values.items():
        got = effect["parameters"].get(key)
        if got is None or isinstance(right, list) or got["value"] is None or isinstance(got["value"], list):
            continue
        result[key] = {"true": right, "error": got["value"] - right, "std": got["std"]}
    return result


# Numbers ------------------------------------------------------------------------------------------------------------


def _volume(wear: Json) -> Json:
    got = wear["volume_mm3"]
    return got if isinstance(got, dict) else {"value": got, "std": None}


def interval(got: Json, true: float) -> Json:
    """A value with its 95 % interval: value ± 1.96 std, widened to `low` … `high` where a range is given."""
    value, std = got.get("value"), got.get("std")
    if value is None:
        return {"true": true, "value": None, "std": None, "covered": False, "half": None}
    low, high = value - WITHIN * (std or 0.0), value + WITHIN * (std or 0.0)
    if got.get("low") is not None:
        low = min(low, got["low"])
    if got.get("high") is not None:
        high = max(high, got["high"])
    slack = 1e-9 * max(abs(true), 1.0)
    return {
        "true": true, "value": value, "std": std, "low": low, "high": high, "half": 0.5 * (high - low),
        "covered": bool(low - slack <= true <= high + slack),
    }  # fmt: skip


def flanks(wear: Json, truth: Json, placement: Placement) -> Json:
    """Worn flanks found and missed, and wear where there is none; a flank is to be found where it is deeper than the limit told."""
    z = truth["gear"]["teeth"]
    where = {placement.flank(f["tooth"], f["side"], z): f for f in truth["wear"]}
    found = {(r["tooth"] - 1, 1 if r["flank"] == "left" else -1): r for r in wear["regions"]}
    gone = {placement.flank(t, s, z) for t in [p["tooth"] for p in truth["broken"]] for s in (1, -1)}
    limit = wear.get("detection_limit_um")
    rows = []
    for at, flank in where.items():
        region = found.get(at)
        row = {"true": flank["volume_mm3"], "depth_um": 1e3 * flank["depth_mm"], "found": region is not None}
        row["deeper_than_limit"] = limit is not None and row["depth_um"] > limit
        if region is not None:
            row |= {key: value for key, value in interval(_volume(region), flank["volume_mm3"]).items() if key != "true"}
            told = {"value": region.get("max_depth_um"), "std": region.get("max_depth_std_um")}
            if flank.get("depth_mean_mm") is not None and told["std"] is not None:
                row["deepest"] = interval(told, 1e3 * flank["depth_mean_mm"])
        rows.append(row)
    false = [_volume(r)["value"] for at, r in found.items() if at not in where and at not in gone]
    return {
        "worn": len(where), "found": sum(r["found"] for r in rows), "covered": sum(bool(r.get("covered")) for r in rows),
        "false": len(false), "false_mm3": sum(v for v in false if v), "limit_um": limit,
        "deepest": [r["deepest"] for r in rows if "deepest" in r],
        "deep_missed": sum(r["deeper_than_limit"] and not r["found"] for r in rows),
    }  # fmt: skip


def thinnest(teeth: list[Json], told: Json | None, truth: Json, placement: Placement) -> Json | None:
    """Thinnest tooth among those that have a number and are whole; and how far the teeth's means are off, µm.

    Where the report has an answer of its own to that, `told`, it is judged by it, unless the tooth it names is not whole; else by the tooth's own least.
    """
    z = truth["gear"]["teeth"]
    rows = {row["tooth"] - 1: row for row in teeth if row.get("min_mm") is not None}
    pairs = []
    for tooth in range(z):
        row = rows.get(placement.flank(tooth, 1, z)[0])
        least, mean = truth["thickness"]["least"][tooth], truth["thickness"]["mean"][tooth]
        if row is not None and least is not None and tooth not in truth["unseen_teeth"]:
            pairs.append((row, least, mean))
    if not pairs:
        return None
    row = min((p[0] for p in pairs), key=lambda r: r["min_mm"])
    if told is not None and any(p[0]["tooth"] == told["tooth"] for p in pairs):
        row = {"min_mm": told["value_mm"], "min_std_mm": told["std_mm"]} | told
    true = min(p[1] for p in pairs)
    each = [interval({"value": r["min_mm"], "std": r.get("min_std_mm")}, least) for r, least, _ in pairs]
    std = row.get("min_std_mm")
    got = {"value": row["min_mm"], "std": std, "low": row.get("low_mm"), "high": row.get("high_mm")}
    errors = [1e3 * (r["mean_mm"] - mean) for r, _, mean in pairs if r.get("mean_mm") is not None]
    return interval(got, true) | {
        "error_um": 1e3 * (row["min_mm"] - true), "std_um": None if std is None else 1e3 * std, "teeth": len(pairs), "each": each,
        "mean_error_um": float(np.median(np.abs(errors))) if errors else None,
    }  # fmt: skip


def broken(found: Json, truth: Json, placement: Placement) -> Json | None:
    """Pieces broken off: whether the tooth is named, and their volume."""
    told = found.get("broken") or found["wear"].get("broken") or []
    if not truth["broken"]:
        return {"true": 0.0, "named": None, "false": len(told)} if told else None
    z = truth["gear"]["teeth"]
    where = {placement.flank(p["tooth"], 1, z)[0] for p in truth["broken"]}
    pieces = [p for p in told if p.get("tooth") is not None and p["tooth"] - 1 in where]
    values = [_volume(p) for p in pieces if p.get("volume_mm3") is not None]
    total = {"value": sum(v["value"] or 0.0 for v in values), "std": math.sqrt(sum((v.get("std") or 0.0) ** 2 for v in values))}
    if values and all(v.get("low") is not None and v.get("high") is not None for v in values):
        total |= {"low": sum(v["low"] for v in values), "high": sum(v["high"] for v in values)}
    lost = found.get("lost_volume_mm3") or found["wear"].get("lost_volume_mm3")
    whole = None if lost is None else interval(_volume({"volume_mm3": lost}), truth["volume_mm3"] + truth["broken_volume_mm3"])
    return interval(total, truth["broken_volume_mm3"]) | {"named": bool(pieces), "false": len(told) - len(pieces), "lost": whole}
