"""How the outcome of the diagnosis depends on each of its thresholds: every one at half, at double and off, one at a time.

python -m benchmarks.sensitivity            varies all rules, writes docs/rules.json and docs/rules.md
python -m benchmarks.sensitivity --only close,same
python -m benchmarks.sensitivity --missing  tries what the file does not hold yet
python -m benchmarks.sensitivity --page     writes docs/rules.md from docs/rules.json
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import warnings
from dataclasses import Field, fields, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from benchmarks.loop_study.fitting import designed, registered
from benchmarks.loop_study.scenario import draw
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import MeasuredGear, register
from gearwear.design.files.toml import read_design
from gearwear.diagnose.rules import RULES, Rules, in_force
from gearwear.scan.reading import read_scan
from tests.synthetic import PINION, Effect, GearNumbers, Patch, Recipe, SlidingWear, Texture, make_scan

ROOT = Path(__file__).parents[1]
STUDY, PAGE = ROOT / "docs" / "rules.json", ROOT / "docs" / "rules.md"
POINTS = 5_000
SEED = 20
DRAWN = ("0", "3", "4", "13", "18", "n0")
"""Numbers of scans of the loop study: effects, waves and ripples that no effect makes, a worn side, null scans with texture."""
BUSH = Recipe(noise_um=8.0, texture=Texture(2.0, 1.0), jitter=1.0, pose="any", ends="upper").of_size(POINTS)
EVEN = (1.0,) * PINION.teeth
MADE: dict[str, tuple[Recipe, GearNumbers]] = {
    "both sides worn": (
        replace(BUSH, wear=(SlidingWear(80.0, 1, EVEN, "linear"), SlidingWear(50.0, -1, EVEN, "linear"))),
        PINION,
    ),
    "wrong drawing": (
        replace(
            BUSH, gear=replace(PINION, thinning=0.12, profile_shift=0.03), wear=(Patch(2, 1, 250.0, (37.0, 43.0), (3.0, 12.0)),)
        ),
        PINION,
    ),
    "strong scale": (
        replace(BUSH, effects=(Effect("scale_anisotropic", {"difference_ppm": 6000.0, "direction_deg": 40.0}),)),
        PINION,
    ),
}
"""Recipes, and the drawing that the fit is given."""


class Recording(Rules):
    """Rules that remember which of them were asked for."""

    __slots__ = ()
    asked: ClassVar[set[str]] = set()

    def __getattribute__(self, name: str) -> Any:
        Recording.asked.add(name)
        return super().__getattribute__(name)


def scans() -> dict[str, MeasuredGear]:
    """The fixed set, registered and binned."""
    found = {}
    for label in DRAWN:
        drawn = draw(label, SEED, POINTS)
        found[label] = registered(make_scan(drawn.recipe, drawn.seed).points, designed(drawn.recipe.gear), drawn.mate)
    for label, (recipe, numbers) in MADE.items():
        found[label] = registered(make_scan(recipe, SEED).points, designed(numbers))
    folder = ROOT / "gearwear" / "example"
    scan = read_scan([folder / "scan.ply.gz"])[0]
    normals = None if scan.normals is None else scan.normals[::30]
    thinned = replace(scan, points=scan.points[::30], normals=normals, view=scan.view[::30])
    found["example"] = register(read_design(folder / "design.toml"), thinned)
    return found


def outcome(measured: MeasuredGear) -> dict[str, Any]:
    """What a reader of the report would notice."""
    loop = find_effects(measured).loop
    assert loop is not None
    spread = {
        f"{effect.name}.{name}": one.std
        for effect in (*loop.effects, *loop.form)
        for name, one in effect.parameters.items()
        if isinstance(one.std, float)
    }
    return {
        "names": sorted(effect.name for effect in (*loop.effects, *loop.form)),
        "alternatives": sorted((effect.name, effect.alternatives) for effect in loop.effects),
        "unexplained": sorted((p.order, p.sides, round(2.0 * p.waves_z), round(2.0 * p.waves_profile)) for p in loop.patterns),
        "worn": (sorted(loop.worn_sides), [sorted(one) for one in loop.undecided]),
        "rms": loop.rms_after,
        "±": spread,
    }


def changes(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """What differs between two outcomes: RMS by more than 1 %, ± by more than 10 %."""
    found = [key for key in ("names", "alternatives", "unexplained", "worn") if one[key] != other[key]]
    if abs(one["rms"] - other["rms"]) > 0.01 * one["rms"]:
        found.append("rms")
    if one["names"] == other["names"]:
        pairs = [(value, other["±"].get(key, math.nan)) for key, value in one["±"].items()]
        if any(abs(a - b) > 0.1 * abs(a) for a, b in pairs):
            found.append("±")
    return found


def variations(one: Field[Any]) -> dict[str, Any]:
    """Values to try: "half", "double", "off". A p-value goes by tens, a share near 1 by its distance from 1."""
    value, off = one.default, one.metadata["off"]
    if isinstance(value, tuple):
        tried = {"half": tuple(0.5 * v for v in value), "double": tuple(2.0 * v for v in value)}
    elif isinstance(value, int):
        tried = {"half": max(value // 2, 1), "double": 2 * value}
    elif one.metadata["unit"] == "p":
        tried = {"half": 0.1 * value, "double": 10.0 * value}
    elif 0.75 <= value < 1.0:
        tried = {"half": 1.0 - 2.0 * (1.0 - value), "double": 1.0 - 0.5 * (1.0 - value)}
    else:
        tried = {"half": 0.5 * value, "double": 2.0 * value}
    return tried if off is None else tried | {"off": off}


def study(only: set[str], missing: bool = False) -> dict[str, dict[str, dict[str, list[str]]]]:
    """By rule and variation: the scans that change, and what of them."""
    every, before = scans(), known() if missing else {}
    usual, asked = {}, {}
    for label, measured in every.items():
        Recording.asked.clear()
        with in_force(Recording()):
            usual[label] = outcome(measured)
        asked[label] = set(Recording.asked)
        print(label, usual[label]["names"], usual[label]["unexplained"], usual[label]["worn"], flush=True)
    result: dict[str, dict[str, dict[str, list[str]]]] = {}
    for how in ("half", "double", "off"):
        for one in fields(RULES):
            tried = variations(one)
            if how not in tried or (only and one.name not in only) or how in before.get(one.name, {}):
                continue
            found = result.setdefault(one.name, {}).setdefault(how, {})
            for label, measured in every.items():
                if one.name not in asked[label]:
                    continue  # it cannot matter
                try:
                    with in_force(replace(RULES, **{one.name: tried[how]})):
                        differ = changes(usual[label], outcome(measured))
                except (ValueError, IndexError, ZeroDivisionError, np.linalg.LinAlgError) as error:
                    differ = [type(error).__name__]
                if differ:
                    found[label] = differ
            print(how, one.name, {label: " ".join(own) for label, own in found.items()}, flush=True)
            write(result)
    return result


def known() -> dict[str, dict[str, dict[str, list[str]]]]:
    """What the file of results holds."""
    return json.loads(STUDY.read_text(encoding="utf-8")) if STUDY.exists() else {}


def write(result: dict[str, dict[str, dict[str, list[str]]]]) -> None:
    """Into the file of results, beside what is known of other rules and values."""
    before = known()
    every = {one.name: before.get(one.name, {}) | result.get(one.name, {}) for one in fields(RULES)}
    STUDY.write_text(json.dumps(every, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def shown(value: Any) -> str:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else f"{value:g}"


def summed(found: dict[str, list[str]] | None) -> str:
    """One cell of the table."""
    if found is None:
        return ""
    kinds = sorted({kind for own in found.values() for kind in own})
    return f"{len(found)}: {', '.join(kinds)}" if found else "–"


def page(result: dict[str, dict[str, dict[str, list[str]]]]) -> str:
    """The table of all rules, as Markdown."""
    count = len(DRAWN) + len(MADE) + 1
    lines = [
        "# The rules of the diagnosis",
        "",
        "Every threshold of [the closed loop](loop.md), as `gearwear.diagnose.rules.Rules` has it. Numbers of a numerical method (steps of a",
        "golden section, of a derivative) are not among them. `python -m benchmarks.sensitivity` writes this page: it closes the loop on",
        f"{count} scans ({len(DRAWN)} of the study's, thinned; both sides worn; a wrong drawing; a strong scale; the bundled example) with one",
        "rule at half, at double and, where it can be, off. p-values go by tens, shares near 1 by their distance from 1. The columns say on",
        "how many scans something changes, and what: names, alternatives, what is unexplained, worn sides, RMS after by more than 1 %, a",
        "standard deviation by more than 10 %. – : nothing, so the value may lie anywhere between as far as the set tells; · : it cannot be",
        "off; empty: not tried.",
        "",
        "| rule | value | unit | is | origin | half | double | off |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for one in fields(RULES):
        own = result.get(one.name, {})
        tried = variations(one)
        cells = [summed(own.get(how)) if how in tried else "·" for how in ("half", "double", "off")]
        about = one.metadata
        lines.append(
            f"| `{one.name}` | {shown(one.default)} | {about['unit']} | {about['why']} | {about['origin']} | {' | '.join(cells)} |"
        )
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="rules to vary, with commas; the others keep what is known of them")
    parser.add_argument("--missing", action="store_true", help="try only what the file of results does not hold")
    parser.add_argument("--page", action="store_true", help="write the page only")
    options = parser.parse_args(arguments)
    if not options.page:
        warnings.simplefilter("ignore")
        study(set(filter(None, options.only.split(","))), options.missing)
    PAGE.write_text(page(known()), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
