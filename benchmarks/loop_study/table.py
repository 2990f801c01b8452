"""The study's table: from the scores of all scans to Markdown."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from benchmarks.loop_study.intervals import Rate
from benchmarks.loop_study.scenario import NAMES, NULL

Score = dict[str, Any]
FOUND = ("name", "alternative", "group")
SIZES = (0.0, 1.0, 2.0, 4.0, 10.0, math.inf)
"""Bounds of size over limit."""
UNITS = {"um": "µm", "ppm": "ppm", "deg": "°", "mm": "mm"}


def summary(scores: Sequence[Score]) -> dict[str, Any]:
    """The numbers the goals are set on, as rates and quantiles.

    Parameters
    ----------
    scores : sequence of dict
        From `scoring.score`.
    """
    kept = [s for s in scores if "refused" not in s]
    nulls = [s for s in kept if s["label"].startswith(NULL)]
    scans = [s for s in kept if not s["label"].startswith(NULL)]
    known, outside = [s for s in scans if s["outside"] is None], [s for s in scans if s["outside"] is not None]
    shown = [t for s in known for t in s["true"] if t["detectable"]]
    by_name = [t for t in shown if t["match"] == "name"]
    covered = [
        abs(e["error"]) < 1.96 * e["std"] for t in by_name for e in t.get("errors", {}).values() if math.isfinite(e["std"])
    ]
    visible = [s for s in outside if s["outside"]["detectable"]]
    rms = np.array([s["rms_um"]["after"] / s["rms_um"]["put_in"] for s in [*known, *nulls]])
    return {
        "refused": Rate(len(scores) - len(kept), len(scores)),
        "named": _rate(shown, lambda t: t["match"] == "name"),
        "named_or_alternative": _rate(shown, lambda t: t["match"] in ("name", "alternative")),
        "named_or_group": _rate(shown, lambda t: t["match"] in FOUND),
        "below": _rate(
            [t for s in known for t in s["true"] if not t["detectable"]], lambda t: t["match"] in ("name", "alternative")
        ),
        "false_null": _rate(nulls, lambda s: any(f["false"] for f in s["found"])),
        "pattern_null": _rate(nulls, lambda s: bool(s["patterns"])),
        "false_known": _rate(known, lambda s: any(f["false"] for f in s["found"])),
        "pattern_known": _rate(known, lambda s: bool(s["patterns"])),
        "unexplained": _rate(visible, _called_unexplained),
        "pattern_outside": _rate(visible, lambda s: bool(s["patterns"])),
        "no_false_outside": _rate(visible, lambda s: not any(f["false"] for f in s["found"])),
        "coverage": Rate(sum(covered), len(covered)),
        "rms_ratio": _quantiles(rms),
        "rms_within": Rate(int((rms <= 1.05).sum()), len(rms)),
    }


def _called_unexplained(s: Score) -> bool:
    """A pattern is shown and no false name stands for it; a groove in one tooth is wear, and may be shown as that."""
    shown = bool(s["patterns"])
    if s["outside"]["name"] == "helical_scratch":
        shown = shown or bool(s["wear"]["false_flanks"])
    return shown and not any(f["false"] for f in s["found"])


def markdown(scores: Sequence[Score], command: str, version: str) -> str:
    """The page.

    Parameters
    ----------
    scores : sequence of dict
    command : str
        That made them.
    version : str
        Of the package.
    """
    kept = [s for s in scores if "refused" not in s]
    nulls = [s for s in kept if s["label"].startswith(NULL)]
    scans = [s for s in kept if not s["label"].startswith(NULL)]
    parts = [
        "# The closed loop on scans whose truth is known",
        f"Written by `{command}`, gearwear {version}. The same command writes the same page.",
        INTRODUCTION.format(scans=len(scans), nulls=len(nulls)),
        "## Against the goals",
        _goals(summary(scores)),
        "## Effect by effect",
        "Detectable effects of scans without one from outside the catalogue. Error: median of abs(found − true) over the true value (angles: "
        "degrees). Coverage: share of the 95 % intervals that hold the truth. Limit: median size at the limit of detection, in the unit of the "
        "effect's first amplitude.",
        _effects(scans),
        "## Size against the limit",
        _sizes(scans),
        "## Outside the catalogue",
        _outside(scans),
        "## False names",
        _false_names(kept),
        "## Error left",
        _errors(scans, nulls),
        "## Wear",
        _wear(scans, nulls),
    ]
    return "\n\n".join(parts) + "\n"


INTRODUCTION = """{scans} scans with effects and {nulls} without (wear, texture, noise, holes and outliers in both). A generator that shares no code
with the fit moves the points as the machine tool and the scanner would (`tests/synthetic`); the fit runs the functions of `compare`
and is told the drawing and nothing else. What a scan is made of is drawn in `benchmarks/loop_study/scenario.py`.

An effect counts as **detectable** by the truth alone (`detection.py`): its field on the cells, less what pose, levels that
the drawing leaves open and the scan's other effects can take up, against the true noise and texture with their true correlation; found with 95 % power by a test that knew all but the
amplitude, at the loop's own family-wise level, and above the loop's least contribution (0.06 of the point noise). An effect from
outside must show against every cell of the spectrum, and be 0.1 of the noise.

A name is right, **among the alternatives** that the report lists, or in the **documented group** of effects that flanks cannot tell
apart; matched one to one (`scoring.py`). Rates have exact (Clopper-Pearson) 95 % intervals."""


def _goals(s: dict[str, Any]) -> str:
    rows = [
        ("detectable effects named, or right among the alternatives", "≥ 95 %", s["named_or_alternative"]),
        ("— by their own name", "", s["named"]),
        ("— or by one of their documented group", "", s["named_or_group"]),
        ("effects below the limit found all the same", "", s["below"]),
        ("null scans with a false name", "≤ 5 %", s["false_null"]),
        ("null scans with an unexplained pattern", "", s["pattern_null"]),
        ("scans with effects and a false name besides", "", s["false_known"]),
        ("scans with effects and a needless unexplained pattern", "", s["pattern_known"]),
        ("out-of-catalogue effects called unexplained, and no false name", "≥ 90 %", s["unexplained"]),
        ("— pattern shown", "", s["pattern_outside"]),
        ("— no false name", "", s["no_false_outside"]),
        ("95 % intervals that hold the truth", "92 … 98 %", s["coverage"]),
        ("RMS after over what was put in: median, 90 %, greatest", "≤ 1.05", s["rms_ratio"]),
        ("— within 1.05", "", s["rms_within"]),
        ("scans refused", "", s["refused"]),
    ]
    return _lines(("what", "goal", "result"), rows)


def _effects(scans: Sequence[Score]) -> str:
    rows = []
    for name in NAMES:
        drawn = [t for s in scans if s["outside"] is None for t in s["true"] if t["name"] == name]
        shown = [t for t in drawn if t["detectable"]]
        how = [sum(t["match"] == kind for t in shown) for kind in (*FOUND, "missed")]
        own = [t for t in shown if t["match"] == "name"]
        errors, covered = [], []
        for parameter in own[0].get("errors", {}) if own else ():
            entries = [t["errors"][parameter] for t in own]
            typical = [
                abs(e["error"]) if parameter.endswith("_deg") else abs(e["error"] / e["true"]) for e in entries if e["true"]
            ]
            if typical:
                middle = float(np.median(typical))
                errors.append(f"{parameter} {middle:.2g}°" if parameter.endswith("_deg") else f"{parameter} {100 * middle:.1f} %")
            covered += [abs(e["error"]) < 1.96 * e["std"] for e in entries if math.isfinite(e["std"])]
        limit = [abs(_leading(t)[1]) * t["limit"] for t in drawn if math.isfinite(t["limit"])]
        unit = UNITS.get(_leading(drawn[0])[0].rsplit("_", 1)[-1], "") if drawn else ""
        rows.append(
            (
                f"`{name}`", len(drawn), len(shown), *how, "; ".join(errors),
                f"{sum(covered)} of {len(covered)}" if covered else "", f"{np.median(limit):.2g} {unit}" if limit else "",
            )
        )  # fmt: skip
    return _lines(("effect", "drawn", "detectable", "name", "alternative", "group", "missed", "error", "coverage", "limit"), rows)


def _leading(entry: dict[str, Any]) -> tuple[str, float]:
    """First amplitude of a true effect; of a list the root mean square, of two slopes the greater."""
    parameters = {k: v for k, v in entry["parameters"].items() if k != "order"}
    if "left_um" in parameters:
        return "left_um", max(abs(parameters["left_um"]), abs(parameters["right_um"]))
    name, value = next(iter(parameters.items()))
    return name, float(np.sqrt(np.mean(np.square(value)))) if isinstance(value, list) else float(value)


def _sizes(scans: Sequence[Score]) -> str:
    rows = []
    every = [t for s in scans if s["outside"] is None for t in s["true"] if math.isfinite(t["limit"])]
    rows.append(("below", _rate([t for t in every if t["limit"] > 1.0], lambda t: t["match"] in ("name", "alternative"))))
    for low, high in pairwise(SIZES[1:]):
        part = [t for t in every if low <= 1.0 / t["limit"] < high]
        label = f"{low:g} … {high:g} times" if math.isfinite(high) else f"over {low:g} times"
        rows.append((label, _rate(part, lambda t: t["match"] in ("name", "alternative"))))
    return _lines(("size over limit", "named or among the alternatives"), rows)


def _outside(scans: Sequence[Score]) -> str:
    rows = []
    for name in sorted({s["outside"]["name"] for s in scans if s["outside"]}):
        own = [s for s in scans if s["outside"] and s["outside"]["name"] == name]
        shown = [s for s in own if s["outside"]["detectable"]]
        row = (f"`{name}`", len(own), len(shown), _rate(shown, _called_unexplained), _rate(shown, lambda s: bool(s["patterns"])))
        rows.append((*row, _rate(shown, lambda s: any(f["false"] for f in s["found"]))))
    return _lines(("effect", "drawn", "detectable", "called unexplained", "pattern shown", "false name"), rows)


def _false_names(kept: Sequence[Score]) -> str:
    found = [(f["name"], s) for s in kept for f in s["found"] if f["false"]]
    rows = [
        (f"`{name}`", sum(n == name for n, _ in found), ", ".join(s["label"] for n, s in found if n == name)) for name in sorted({n for n, _ in found})
    ]  # fmt: skip
    return _lines(("name", "times", "scans"), rows) if rows else "None."


def _errors(scans: Sequence[Score], nulls: Sequence[Score]) -> str:
    rows = []
    groups = {
        "effects of the catalogue": [s for s in scans if s["outside"] is None],
        "with one from outside": [s for s in scans if s["outside"] is not None],
        "null": nulls,
    }
    for label, part in groups.items():
        if part:
            get = {key: np.array([s["rms_um"][key] / s["rms_um"]["put_in"] for s in part]) for key in part[0]["rms_um"]}
            rows.append(
                (label, len(part), *(_quantiles(get[k]) for k in ("before", "after", "held_out_before", "held_out_after")))
            )
    head = ("scans", "number", "RMS before", "RMS after", "held out before", "held out after")
    return "Over the noise put in (white and texture): median, 90 % quantile, greatest.\n\n" + _lines(head, rows)


def _wear(scans: Sequence[Score], nulls: Sequence[Score]) -> str:
    rows: list[tuple[Any, ...]] = []
    for label, part in (("with effects", scans), ("null", nulls)):
        part = [s for s in part if not _grooved(s)]
        for kind, whole in (("patches", False), ("a whole side", True)):
            worn = [s["wear"] for s in part if s["wear"]["true"] > 0.0 and _whole_side(s) == whole]
            if not worn:
                continue
            errors = (_volume_errors(worn, "before"), _volume_errors(worn, "after"))
            rows.append(
                (
                    label,
                    kind,
                    len(worn),
                    *errors,
                    _covered(worn, "true"),
                    _covered(worn, "true_found"),
                    _within(worn),
                    _pulls(worn),
                )
            )
    every = [s for s in [*scans, *nulls] if not _grooved(s)]
    unworn = [s for s in every if not s["wear"]["true"]]
    flanks = [f for s in every for f in s["wear"]["flanks"]]
    more: list[tuple[str, Rate]] = [
        ("worn flanks found", _rate(flanks, lambda f: f["found"] is not None)),
        ("scans with wear on a flank that has none", _rate(every, lambda s: bool(s["wear"]["false_flanks"]))),
        ("unworn scans with wear, before the loop", _rate(unworn, lambda s: s["wear"]["before"] > 0.0)),
        ("unworn scans with wear, after the loop", _rate(unworn, lambda s: s["wear"]["after"] > 0.0)),
    ]
    text = (
        "Error of the volume of a scan: median, 90 % quantile, and in brackets the sum of all errors over the sum of all volumes. Scans with a "
        "groove in one tooth are left out: it may well be called wear. The intervals are those of scans on which wear was found; they speak of "
        "the flanks it was found on, so the column after leaves out what was lost on others, too shallow to be seen. What the report states is the interval, "
        "widened to its `low` and `high`; of all scans with wear, found or not. A pull is the error of a volume in its standard deviation."
    )
    head = (
        "scans",
        "wear",
        "number",
        "error before the loop",
        "after",
        "95 % intervals that hold the truth",
        "of the flanks found",
        "truth within what the report states",
        "pull on the flanks found: mean, RMS",
    )
    return text + "\n\n" + _lines(head, rows) + "\n\n" + _lines(("what", "rate"), more)


def _covered(worn: Sequence[dict[str, Any]], truth: str) -> Rate:
    pull = [abs(w["after"] - w[truth]) / w["std"] for w in worn if w["std"]]
    return Rate(sum(p < 1.96 for p in pull), len(pull))


def _within(worn: Sequence[dict[str, Any]]) -> Rate:
    """Of all scans with wear, whether the truth lies within the limits that the report gives."""
    return _rate(worn, lambda w: w["limits"][0] <= w["true"] <= w["limits"][1])


def _pulls(worn: Sequence[dict[str, Any]]) -> str:
    pull = np.array([(w["after"] - w["true_found"]) / w["std"] for w in worn if w["std"]])
    return f"{pull.mean():.2f}, {math.sqrt(float((pull**2).mean())):.2f}" if len(pull) else "none"


def _grooved(s: Score) -> bool:
    return bool(s["outside"]) and s["outside"]["name"] == "helical_scratch"


def _whole_side(s: Score) -> bool:
    return any(w.startswith("sliding") for w in s["scan"]["wear"])


def _volume_errors(worn: Sequence[dict[str, Any]], key: str) -> str:
    off = [abs(w[key] - w["true"]) for w in worn]
    total = sum(off) / sum(w["true"] for w in worn)
    return f"{_percent([x / w['true'] for x, w in zip(off, worn, strict=True)])} ({100 * total:.1f} %)"


def _percent(values: Iterable[float]) -> str:
    middle, high = np.quantile(list(values), [0.5, 0.9])
    return f"{100 * middle:.1f} %, {100 * high:.0f} %"


def _quantiles(values: Any) -> str:
    return ", ".join(f"{x:.3f}" for x in np.quantile(values, [0.5, 0.9, 1.0])) if len(values) else "none"


def _rate(items: Sequence[Any], test: Callable[[Any], bool]) -> Rate:
    return Rate(sum(bool(test(item)) for item in items), len(items))


def _lines(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in lines)
