"""`report.json`, `inspection.json` and `meshing.json` against their schemas in the package: what is written is valid, and a key that is
lost or of another kind is not."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from referencing import Registry, Resource

import gearwear as gw
from gearwear.design.load import LoadSpec
from gearwear.design.weighing import WeighingSpec
from gearwear.inspection.settings import Settings
from gearwear.loaded.study import study_load
from gearwear.report.files.inspection import inspection_record
from gearwear.report.files.writing import finite
from gearwear.report.records.comparison import SCHEMA, document
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.study import CyclesToLimit, WearStudy
from tests.report.fake import bare_results, changed, fake_results, open_contact, real_results

MAY_BE_MISSING = {
    "closed_loop.texture_um", "closed_loop.candidates_tried", "closed_loop.unexplained.patterns", "closed_loop.unexplained.treatment",
    "wear.solid", "meshing.loaded", "meshing.wear_law", "meshing.wear_law.across_face", "meshing.wear_law.forecast", "meshing.take_up",
}  # fmt: skip
"""Keys of a comparison with loop, mate and wear that another comparison does not have."""
MAPS = ("closed_loop.effects.parameters", "closed_loop.changes", "scan.rejected", "scan.coverage", "wear.laws.parameters")
"""Objects whose keys are names, not of the format."""


def schema(name: str) -> Any:
    return json.loads(files("gearwear.report").joinpath(f"schema/{name}.schema.json").read_text(encoding="utf-8"))


@cache
def validator(name: str) -> Draft202012Validator:
    Draft202012Validator.check_schema(schema(name))
    report = Resource.from_contents(schema("report"))
    return Draft202012Validator(schema(name), registry=report @ Registry())


@cache
def with_forecast() -> Any:
    """A pair whose wear law was fitted, with a forecast and limits."""
    design = gw.read_design(gw.example())
    pair = design.gears["pinion"], design.gears["gear"], 114.3
    roll = np.linspace(3.2, 26.2, 80)
    fits = gw.fit_wear_law(*pair, roll, 0.004 + 0.008 * np.abs(1.0 - (39.09290238 - roll) / (2.0 * roll)), np.full(80, 2e-4))
    left = tuple(
        CyclesToLimit(name, limit, gw.cycles_left(fits, 1e6, limit, name))
        for name, limit in (("depth", 0.08), ("backlash", 0.02))
    )
    forecast = gw.forecast_wear(fits, 1e6, np.array([1e6, 2e6]))
    return changed(fake_results(), "pair.law", WearStudy(gw.Side.LEFT, (0, 2, 3), (1,), fits, "", forecast, left, 0.44))


@cache
def with_load() -> Any:
    """The same with the pair under load, and wear that leans across the face."""
    load = study_load(gw.read_design(gw.example()), load=LoadSpec(load_per_width=100.0, misalignment=0.01))
    results = changed(with_forecast(), "pair.loaded", load)
    z = np.linspace(1.0, 14.0, 5)
    across = AcrossFace(z, 0.02 + 1e-3 * z, np.full(5, 1e-4), 0.015, 1e-3, 0.0, 1e-3)
    return changed(results, "pair.law.across", across)


def weighed() -> Any:
    """The same with what the gear weighed."""
    results = real_results()
    weighing = WeighingSpec(before=812.403, after=812.144, std=0.002, density=7.85)
    return changed(results, "measured.design", replace(results.design, weighing=weighing))


MADE = {
    "real": real_results,
    "one gear, planar, no loop": bare_results,
    "known numbers": fake_results,
    "forecast": with_forecast,
    "load": with_load,
    "weighed": weighed,
    "no inspection": lambda: changed(real_results(), "inspection", None),
    "halves": lambda: changed(changed(real_results(), "halves", (real_results().inspection,) * 2), "inspection", None),
    "open contact": open_contact,
    "no spread": lambda: changed(real_results(), "pair.spread", None),
}


@pytest.mark.parametrize("made", MADE)
def test_what_is_written_is_valid(made):
    report = finite(document(MADE[made](), ["report.json"]))
    assert [f"{list(error.absolute_path)}: {error.message[:200]}" for error in validator("report").iter_errors(report)] == []
    assert report["schema"] == SCHEMA == validator("report").schema["properties"]["schema"]["const"]


def test_what_the_weighing_says_is_a_note():
    notes = document(weighed(), ["report.json"])["notes"]
    assert [note for note in notes if "by weighing" in note and "than the scan says" in note]
    assert not [note for note in document(real_results(), ["report.json"])["notes"] if "weighing" in note]


def paths(node: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Every key below a node; of a list its first item."""
    named = ".".join(part for part in path if isinstance(part, str))
    if isinstance(node, dict) and named not in MAPS:
        for key, value in node.items():
            yield (*path, key)
            yield from paths(value, (*path, key))
    elif isinstance(node, list) and node:
        yield from paths(node[0], (*path, 0))


SHORT = 12
"""Length up to which a list of numbers may be one of fixed length."""


def short(node: Any) -> Any:
    """The same with the first item of every list of objects alone, and the first two of every long list of numbers."""
    if isinstance(node, dict):
        return {key: short(value) for key, value in node.items()}
    if isinstance(node, list):
        kept = 1 if node and isinstance(node[0], dict) else 2 if len(node) > SHORT else len(node)
        return [short(item) for item in node[:kept]]
    return node


def seen_to_be_wrong(validator: Draft202012Validator, whole: Any, may_be_missing: Callable[[str, str | int], bool]) -> int:
    """Take away each key, and give it a value of another kind, one at a time; how many there were."""
    assert validator.is_valid(whole)

    def is_valid(path: tuple[str | int, ...]) -> bool:
        """Of the whole; the innermost part that was changed is looked at first, then that round it: mostly it tells, and sooner."""
        part, within, parts = validator.schema, whole, [(validator.schema, whole)]
        for key in path[:-1]:
            part, within = part.get("items" if isinstance(key, int) else "properties", {}), within[key]
            part = part if isinstance(key, int) else part.get(key, {})
            if not isinstance(part, dict):
                break
            parts.append((part, within))
        return all(validator.evolve(schema=part).is_valid(within) for part, within in reversed(parts))

    every = list(paths(whole))
    for path in every:
        node = whole
        for part in path[:-1]:
            node = node[part]
        key, named = path[-1], ".".join(part for part in path if isinstance(part, str))
        old = node.pop(key)
        assert may_be_missing(named, key) or not is_valid(path), f"{named} is lost"
        # of what is null here it is not known which kind it would be, but it is not any
        others = (
            ("of another kind",)
            if isinstance(old, dict)
            else ({"of": "another kind"}, *(("of another kind",) if old is None else ()))
        )
        seen = []
        for other in others:
            node[key] = other
            seen.append(not is_valid(path))
        assert any(seen), f"{named} is of another kind"
        node[key] = old
    return len(every)


def test_a_key_that_is_lost_or_of_another_kind_is_seen():
    def optional(named: str, key: str | int) -> bool:
        play = named.startswith("meshing.worn.backlash.") and named.endswith("_std")
        return named in MAY_BE_MISSING or play or key == "noise"

    whole = short(finite(document(with_load(), ["report.json"])))
    assert seen_to_be_wrong(validator("report"), whole, optional) > 300


def inspected(loop: bool = True, **settings: Any) -> Any:
    results = real_results()
    measured = results.measured
    found = gw.inspect(measured, Settings(noise=0.005, **settings)) if settings else results.inspection
    record = inspection_record(
        results.design,
        "pinion",
        measured.scans,
        measured.placed.registration,
        measured.loop if loop else None,
        ["a note"],
        "gearwear inspect",
    )
    return finite({**record, "inspection": gw.as_dict(found), "files": ["inspection.json"]})


@pytest.mark.parametrize("settings", [{}, {"loop": False}, {"required_class": 6}])
def test_an_inspection_is_valid(settings):
    record = inspected(**settings)
    assert [f"{list(error.absolute_path)}: {error.message[:200]}" for error in validator("inspection").iter_errors(record)] == []


def test_a_key_of_an_inspection_that_is_lost_or_of_another_kind_is_seen():
    whole = short(inspected())
    deeper = {"inspection", "taken_out"}  # those of report.json, which its own test goes through
    whole = {key: value for key, value in whole.items() if key not in deeper}
    shallow = schema("inspection") | {"required": [key for key in schema("inspection")["required"] if key not in deeper]}
    own = Draft202012Validator(shallow, registry=Resource.from_contents(schema("report")) @ Registry())
    assert seen_to_be_wrong(own, whole, lambda named, key: False) > 25


@pytest.mark.parametrize("loss", [None, 0.3])
def test_a_study_of_a_pair_is_valid_and_a_lost_key_is_seen(loss):
    design = gw.read_design(gw.example())
    study = gw.study_meshing(design, loss=loss)
    record = finite({**gw.as_dict(study), "files": ["meshing.json"]})
    own = validator("meshing")
    assert [f"{list(error.absolute_path)}: {error.message[:200]}" for error in own.iter_errors(record)] == []
    assert ("take_up" in record) is (loss is not None)
    assert seen_to_be_wrong(own, short(record), lambda named, key: named == "take_up") > 100
