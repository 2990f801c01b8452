"""The page that tells what was found, family by family."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

from benchmarks.kinds.draws import FAMILIES
from benchmarks.loop_study.intervals import Rate

Json = dict[str, Any]
RIGHT = ("name", "alternative", "group")

HEAD = """\
# The loop on other kinds of gears

Written by `python -m benchmarks.kinds run --scans {scans} --seed {seed} --points {points}` and `page`, gearwear {version}.

Scans of helical gears (8 to 30°, both hands, 15 to 45 teeth), of rings (36 to 80 teeth, spur and up to 25°,
fillet known or not) and of double helical gears, modules 1.5 to 4, by generators of `tests/synthetic` that
share nothing with the fit. Each has up to three worn flanks, 15 to 60 µm deep per mm of module, noise of 4 to
10 µm, 0.3 % of strays, and in three of four one error of 6 to 25 µm: a coat, an angle of the table that is read
wrong one to four times a revolution, or radii that read too large. The design is the one that was made. Rates
have exact (Clopper-Pearson) 95 % intervals: with so few scans they are wide.

"""


def page(lines: Sequence[Json]) -> str:
    """Markdown."""
    scans = max(sum(line["family"] == family for line in lines) for family in FAMILIES)
    first = lines[0]
    text = HEAD.format(scans=scans, seed=first["study_seed"], points=first["study_points"], version=first["version"])
    by_family = {family: [line for line in lines if line["family"] == family] for family in FAMILIES}
    rows = [
        ("scans", lambda own: str(len(own))),
        ("no result", lambda own: str(Rate(sum("score" not in line for line in own), len(own)))),
        ("effects put in: named, or right among the alternatives or their group", _right),
        ("scans with a false name", lambda own: _rate(own, lambda s: bool(s["names"]["false"]))),
        ("scans with an unexplained pattern", lambda own: _rate(own, lambda s: s["names"]["unexplained"])),
        ("scans with an error put in that was not named", _missed),
        ("worn flanks found", _flanks),
        ("scans with wear where there is none", lambda own: _rate(own, lambda s: s["regions_false"] > 0)),
        ("scans with breakage where there is none", lambda own: _rate(own, lambda s: s["broken_false"] > 0)),
        ("95 % interval of the volume holds the truth", lambda own: _rate(own, lambda s: s["volume"]["covered"])),
        (
            "— of scans with wear",
            lambda own: _rate([one for one in own if one["volume_mm3"] > 0.0], lambda s: s["volume"]["covered"]),
        ),
        ("volume, median of (found − true) / true", _volume_error),
        ("teeth with a thickness", _teeth),
        (
            "95 % interval of the thinnest of them holds the truth",
            lambda own: _rate([o for o in own if _arc(o)], lambda s: s["thinnest"]["covered"]),
        ),
        ("95 % intervals of the least thickness of each tooth that hold it", _each),
        ("thinnest tooth, median error and half interval", _thickness_error),
        ("processor time, median", lambda own: f"{median(line['seconds'] for line in own):.1f} s"),
    ]
    table = [["", *FAMILIES.values()], ["---"] * (1 + len(FAMILIES))]
    table += [[label, *(tell(own) if own else "none" for own in by_family.values())] for label, tell in rows]
    text += "\n".join(f"| {' | '.join(row)} |" for row in table) + "\n\n" + _reading(lines) + "## What went wrong\n\n"
    return text + "\n".join(_wrong(lines) or ["Nothing."]) + "\n"


def _reading(lines: Sequence[Json]) -> str:
    """Which way the intervals of the thinnest tooth that miss the truth do so."""
    missed = [one["thinnest"] for one in _scores(lines) if one["thinnest"] and not one["thinnest"]["covered"]]
    thick = sum(one["value"] > one["true"] for one in missed)
    if not missed:
        return ""
    return f"Of the {len(missed)} intervals of the thinnest tooth that miss it {thick} read too thick.\n\n"


def _scores(own: Sequence[Json]) -> list[Json]:
    return [line["score"] for line in own if "score" in line]


def _rate(own: Sequence[Json], holds: Any) -> str:
    scores = _scores(own)
    return str(Rate(sum(bool(holds(one)) for one in scores), len(scores)))


def _right(own: Sequence[Json]) -> str:
    told = [one["match"] in RIGHT for score in _scores(own) for one in score["names"]["true"]]
    return str(Rate(sum(told), len(told)))


def _missed(own: Sequence[Json]) -> str:
    put_in = [line for line in own if line["what"] != "none"]
    return _rate(put_in, lambda s: any(one["match"] == "missed" for one in s["names"]["true"]))


def _flanks(own: Sequence[Json]) -> str:
    scores = _scores(own)
    return str(Rate(sum(one["worn_found"] for one in scores), sum(one["worn"] for one in scores)))


def _volume_error(own: Sequence[Json]) -> str:
    errors = [
        100.0 * (one["volume"]["value"] / one["volume"]["true"] - 1.0) for one in _scores(own) if one["volume"]["true"] > 0.0
    ]
    return f"{median(errors):+.1f} %" if errors else "none"


def _thickness_error(own: Sequence[Json]) -> str:
    arcs = [one["thinnest"] for one in _scores(own) if one["thinnest"]]
    return f"{1e3 * median(a['value'] - a['true'] for a in arcs):+.1f} ± {1e3 * median(a['half'] for a in arcs):.1f} µm"


def _arc(line: Json) -> bool:
    """Whether any tooth has a thickness."""
    return bool(line.get("score", {}).get("thinnest"))


def _teeth(own: Sequence[Json]) -> str:
    scores = _scores(own)
    return str(Rate(sum((one["thinnest"] or {"teeth": 0})["teeth"] for one in scores), sum(one["teeth"] for one in scores)))


def _each(own: Sequence[Json]) -> str:
    told = [tooth["covered"] for one in _scores(own) if one["thinnest"] for tooth in one["thinnest"]["each"]]
    return str(Rate(sum(told), len(told)))


def _wrong(lines: Sequence[Json]) -> list[str]:
    """A line for each scan that something was wrong in."""
    said = []
    for line in lines:
        if "score" not in line:
            said.append(f"- {line['label']} ({line['what']}): {line['failed']}")
            continue
        score, wrong = line["score"], []
        wrong += [f"{name} named" for name in score["names"]["false"]]
        wrong += [
            f"{one['name']} of {line['size_um']:.1f} µm missed" for one in score["names"]["true"] if one["match"] == "missed"
        ]
        wrong += ["an unexplained pattern"] if score["names"]["unexplained"] else []
        wrong += [f"{score['regions_false']} flanks worn that are not"] if score["regions_false"] else []
        wrong += [f"{score['broken_false']} teeth broken that are not"] if score["broken_false"] else []
        for what, unit in (("volume", "mm³"), ("thinnest", "mm")):
            one = score[what]
            if one and not one["covered"]:
                wrong.append(f"{what} {one['low']:.4g} … {one['high']:.4g} {unit}, true {one['true']:.4g}")
        if wrong:
            said.append(f"- {line['label']} ({line['what']}): {'; '.join(wrong)}")
    return said
