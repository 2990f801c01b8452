"""`report.json` against the schema in the package: what is written is valid, and a key that is lost or of another kind is not."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import gearwear as gw
from gearwear.design.load import LoadSpec
from gearwear.loaded.study import study_load
from gearwear.report.files.writing import finite
from gearwear.report.records.comparison import SCHEMA, document
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.study import CyclesToLimit, WearStudy
from tests.report.fake import bare_results, changed, fake_results, real_results

MAY_BE_MISSING = {
    "closed_loop.texture_um", "closed_loop.candidates_tried", "closed_loop.unexplained.patterns", "closed_loop.unexplained.treatment",
    "wear.solid", "meshing.loaded", "meshing.wear_law", "meshing.wear_law.across_face", "meshing.wear_law.forecast", "meshing.take_up",
}  # fmt: skip
"""Keys of a comparison with loop, mate and wear that another comparison does not have."""
MAPS = ("closed_loop.effects.parameters", "closed_loop.changes", "scan.rejected", "scan.coverage", "wear.laws.parameters")
"""Objects whose keys are names, not of the format."""


def validator() -> Draft202012Validator:
    schema = json.loads(files("gearwear.report").joinpath("schema/report.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


VALIDATOR = validator()


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


def with_load() -> Any:
    """The same with the pair under load, and wear that leans across the face."""
    load = study_load(gw.read_design(gw.example()), load=LoadSpec(load_per_width=100.0, misalignment=0.01))
    results = changed(with_forecast(), "pair.loaded", load)
    z = np.linspace(1.0, 14.0, 5)
    across = AcrossFace(z, 0.02 + 1e-3 * z, np.full(5, 1e-4), 0.015, 1e-3, 0.0, 1e-3)
    return changed(results, "pair.law.across", across)


MADE = {
    "real": real_results,
    "one gear, planar, no loop": bare_results,
    "known numbers": fake_results,
    "forecast": with_forecast,
    "load": with_load,
    "no inspection": lambda: changed(real_results(), "inspection", None),
    "no spread": lambda: changed(real_results(), "pair.spread", None),
}


@pytest.mark.parametrize("made", MADE)
def test_what_is_written_is_valid(made):
    report = finite(document(MADE[made](), ["report.json"]))
    assert [f"{list(error.absolute_path)}: {error.message[:200]}" for error in VALIDATOR.iter_errors(report)] == []
    assert report["schema"] == SCHEMA == VALIDATOR.schema["properties"]["schema"]["const"]


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


def test_a_key_that_is_lost_or_of_another_kind_is_seen():
    whole = short(finite(document(with_load(), ["report.json"])))
    assert VALIDATOR.is_valid(whole)
    every = list(paths(whole))
    assert len(every) > 300
    for path in every:
        report = copy.deepcopy(whole)
        node = report
        for part in path[:-1]:
            node = node[part]
        key, named = path[-1], ".".join(part for part in path if isinstance(part, str))
        old = node.pop(key)
        optional = named in MAY_BE_MISSING or (named.startswith("meshing.worn.backlash.") and named.endswith("_std"))
        optional |= key == "noise"
        assert optional or not VALIDATOR.is_valid(report), f"{named} is lost"
        # of what is null here it is not known which kind it would be, but it is not any
        others = (
            ("of another kind",)
            if isinstance(old, dict)
            else ({"of": "another kind"}, *(("of another kind",) if old is None else ()))
        )
        assert not all(VALIDATOR.is_valid(put(report, node, key, other)) for other in others), f"{named} is of another kind"


def put(report: Any, node: Any, key: str | int, value: Any) -> Any:
    node[key] = value
    return report
