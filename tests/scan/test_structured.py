"""Structured cases, a bounded part: every reader and side input gives a result or one line. `benchmarks/hostile.py` runs them by the ten thousand."""

from __future__ import annotations

import random
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from gearwear.design import Gear, GearSpec, read_design
from gearwear.design.files.profiles import read_profiles
from gearwear.design.files.traces import read_traces
from gearwear.errors import InputError
from gearwear.fleet.manifest import read_manifest
from gearwear.inspection import read_k_bands
from gearwear.report.logo import read_logo
from gearwear.scan import read_one
from tests.hostile import structured

CASES = {"a.laz": 2, "a.xyz.gz": 15}
"""How many where not 40: what starts processes or unpacks takes longer."""


def outcomes(path: Path, make: Callable[[random.Random], bytes], read: Callable[[Path], object]) -> tuple[int, int]:
    """How many cases were read and how many refused."""
    done = refused = 0
    for number in range(CASES.get(path.name, 40)):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of zipfile, on archives that are made wrong
            path.write_bytes(make(random.Random(f"{path.name} 0 {number}")))
        try:
            read(path)
            done += 1
        except InputError as error:
            assert "\n" not in str(error) and str(path) in str(error), number
            refused += 1
    return done, refused


@pytest.mark.parametrize("name", structured.SCANS)
def test_scans(tmp_path, name):
    done, refused = outcomes(tmp_path / name, structured.SCANS[name], read_one)
    assert refused > 0 and (done > 0 or name in ("rich.ply", "a.laz"))


@pytest.mark.parametrize("name", structured.DESIGNS)
def test_designs(tmp_path, name):
    assert outcomes(tmp_path / name, structured.DESIGNS[name], read_design)[1] > 0


def test_side_inputs(tmp_path):
    (tmp_path / "pair.toml").write_bytes(structured.PAIR)
    design = read_design(tmp_path / "pair.toml")
    gear = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    assert min(outcomes(tmp_path / "band.toml", structured.band, lambda file: read_k_bands(file, gear))) > 0
    assert outcomes(tmp_path / "worn_profiles.npz", structured.profiles, lambda file: read_profiles(file, design))[1] > 0
    assert min(outcomes(tmp_path / "traces.csv", structured.traces, lambda file: read_traces(file, design))) > 0
    assert min(outcomes(tmp_path / "fleet.csv", structured.manifest, read_manifest)) > 0


@pytest.mark.parametrize("name", structured.LOGOS)
def test_logos(tmp_path, name):
    assert min(outcomes(tmp_path / name, structured.LOGOS[name], read_logo)) > 0


@pytest.mark.long
@pytest.mark.parametrize("name", structured.STORES)
def test_stores_of_fleets(tmp_path, name):
    (tmp_path / name).parent.mkdir(exist_ok=True)
    assert min(outcomes(tmp_path / name, structured.STORES[name], structured.read_store)) > 0


def test_what_the_cases_are_made_from_is_right(tmp_path):
    """Else every case would be refused for the same reason."""
    for name, data in (
        ("a.toml", structured.PAIR),
        ("stated.toml", structured.STATED),
        ("ring.toml", structured.RING),
        ("double.toml", structured.DOUBLE),
        ("table.csv", structured.TABLE),
        ("a.rexs", structured.REXS),
    ):
        (tmp_path / name).write_bytes(data)
        assert read_design(tmp_path / name).pair is not None
    (tmp_path / "broached.toml").write_bytes(structured.BROACHED)
    assert not read_design(tmp_path / "broached.toml").warnings
    (tmp_path / "band.toml").write_bytes(structured.BAND)
    assert None not in read_k_bands(tmp_path / "band.toml", Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))).profile
    (tmp_path / "traces.csv").write_bytes(structured.TRACES)
    assert read_traces(tmp_path / "traces.csv", read_design(tmp_path / "a.toml"))[0] == "pinion"
    (tmp_path / "fleet.csv").write_bytes(structured.MANIFEST)
    assert len(read_manifest(tmp_path / "fleet.csv")) == 3
    assert structured.mended(structured._whole("a.e57")) == structured._whole("a.e57")
