"""Structured cases by the ten thousand: every reader and side input, each case read or refused in one line, its time and memory measured.

python -m benchmarks.hostile --cases 100000 --seed 1 --out benchmarks/hostile.md

One case again: --only "a.glb 1 4711" prints what became of it and leaves the file.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import random
import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gearwear.cli import main as gearwear
from gearwear.design import read_design
from gearwear.design.files.profiles import read_profiles
from gearwear.design.files.traces import read_traces
from gearwear.errors import InputError
from gearwear.fleet.manifest import read_manifest
from gearwear.inspection import read_k_bands
from gearwear.report.logo import read_logo
from gearwear.scan import read_one
from tests.hostile import structured

EXAMPLE = Path(structured.__file__).parents[2] / "gearwear" / "example" / "design.toml"
PAIR = read_design(EXAMPLE)
BATCH, WHOLE = 40, 500
"""Cases of one process; every so many one goes through a whole command."""
SLOW = {"a.laz": 100, "a.xyz.gz": 5, "a.3mf": 5, "manifests/listed.csv": 5, "g1_1.parquet": 5}
"""So many times fewer cases of what takes longer; of LAZ every one starts a process."""
PARTS = 50
MOST_SECONDS, MOST_BYTES = 300, 8_000_000_000
"""Processor time and addresses of a batch, beyond which the system ends it."""


@dataclass
class Row:
    """What became of the cases of one kind."""

    cases: int = 0
    done: int = 0
    refused: int = 0
    slowest: float = 0.0
    megabytes: float = 0.0
    other: list[str] = field(default_factory=list)


Kind = tuple[Callable[[random.Random], bytes], Callable[[Path], Any], Callable[[Path], list[str]]]


def kinds() -> dict[str, Kind]:
    """By name: how a file is made, how it is read, and the command that takes it."""
    found: dict[str, Kind] = {}
    for name, make in structured.SCANS.items():
        found[name] = make, read_one, lambda file: ["compare", str(EXAMPLE), str(file), "--part", "pinion"]
    for name, make in structured.DESIGNS.items():
        found[name] = make, read_design, lambda file: ["meshing", str(file)]
    pinion = PAIR.gears["pinion"]
    found["band.toml"] = (
        structured.band,
        lambda file: read_k_bands(file, pinion),
        lambda file: ["inspect", str(EXAMPLE), "no.ply", "--k-band", str(file)],
    )
    found["worn_profiles.npz"] = (
        structured.profiles,
        lambda file: read_profiles(file, PAIR),
        lambda file: ["meshing", "--wear", str(file)],
    )
    found["traces.csv"] = (
        structured.traces,
        lambda file: read_traces(file, PAIR),
        lambda file: ["meshing", "--wear", str(file)],
    )
    found["fleet.csv"] = structured.manifest, read_manifest, lambda file: ["batch", str(file)]
    for name, make in structured.STORES.items():
        found[name] = make, structured.read_store, lambda file: ["trend", str(structured.store_with(file))]
    for name, make in structured.LOGOS.items():
        found[name] = make, read_logo, lambda file: ["meshing", "--logo", str(file)]
    return found


def one(name: str, seed: int, number: int, folder: Path) -> tuple[str, float]:
    """What became of one case, and how long it took."""
    make, read, command = kinds()[name]
    file = folder / name
    file.parent.mkdir(exist_ok=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file.write_bytes(make(random.Random(f"{name} {seed} {number}")))
    begun = time.perf_counter()
    if number % WHOLE == 0:
        outcome = _command([*command(file), "--out", str(folder / "out"), "--quiet"])
    else:
        try:
            read(file)
            outcome = "done"
        except InputError as error:
            outcome = "refused" if "\n" not in str(error) else "a message of several lines"
        except BaseException as error:
            outcome = f"{type(error).__name__}: {str(error)[:100]}"
    return outcome, time.perf_counter() - begun


def _command(words: list[str]) -> str:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = gearwear(words)
        except BaseException as error:
            return f"{words[0]}: {type(error).__name__}: {str(error)[:100]}"
    if status == 0 and not err.getvalue():
        return "done"
    return (
        "refused" if status == 2 and err.getvalue().count("\n") == 1 else f"{words[0]}: status {status}, {err.getvalue()[:100]!r}"
    )


def batch(name: str, seed: int, numbers: list[int], row: Row) -> None:
    """Cases in a process of their own, one by one again where it is ended."""
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "told.json"
        child = os.fork()
        if child == 0:
            resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))
            resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
            try:
                told.write_text(json.dumps([one(name, seed, number, Path(folder)) for number in numbers]))
                os._exit(0)
            finally:
                os._exit(1)
        _, status, used = os.wait4(child, 0)
        outcomes = json.loads(told.read_text()) if status == 0 else None
    row.megabytes = max(row.megabytes, used.ru_maxrss / 1000.0)
    if outcomes is None and len(numbers) > 1:
        for number in numbers:
            batch(name, seed, [number], row)
        return
    for number, (outcome, seconds) in zip(numbers, outcomes or [(f"ended, status {status}", 0.0)], strict=True):
        row.cases += 1
        row.done += outcome == "done"
        row.refused += outcome == "refused"
        row.slowest = max(row.slowest, seconds)
        if outcome not in ("done", "refused"):
            row.other.append(f"{name} {seed} {number}: {outcome}")


def table(rows: dict[str, Row]) -> str:
    """The rows and their sum as Markdown."""
    lines = [
        "| file | cases | read, or status 0 | one line, status 2 | anything else | slowest, s | peak, MB |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, row in rows.items():
        lines.append(
            f"| {name} | {row.cases:,} | {row.done:,} | {row.refused:,} | {len(row.other)} | {row.slowest:.2f} | {row.megabytes:.0f} |"
        )
    every = list(rows.values())
    lines.append(
        f"| **all** | {sum(r.cases for r in every):,} | {sum(r.done for r in every):,} | {sum(r.refused for r in every):,} | "
        f"{sum(len(r.other) for r in every)} | {max(r.slowest for r in every):.2f} | {max(r.megabytes for r in every):.0f} |"
    )
    others = [line for row in every for line in row.other]
    return "\n".join([*lines, "", *(f"- {line}" for line in others)]).strip() + "\n"


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    options.add_argument("--cases", type=int, default=100_000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--out", type=Path)
    options.add_argument("--only", metavar="'FILE SEED NUMBER'")
    given = options.parse_args()
    if given.only:
        name, seed, number = given.only.split()
        folder = Path(tempfile.mkdtemp())
        print(one(name, int(seed), int(number), folder), folder / name)
        return
    names = list(kinds())
    share = given.cases / sum(1.0 / SLOW.get(name, 1) for name in names)
    rows = {name: Row() for name in names}
    begun = time.monotonic()
    for part in range(PARTS):  # all kinds a little at a time: what is there when it is stopped is a run of its own
        for name in names:
            most = round(share / SLOW.get(name, 1))
            numbers = list(range(1 + most * part // PARTS, 1 + most * (part + 1) // PARTS))
            for start in range(0, len(numbers), BATCH):
                batch(name, given.seed, numbers[start : start + BATCH], rows[name])
        text = (
            f"# Structured cases: what became of them\n\n`python -m benchmarks.hostile --cases {given.cases} --seed {given.seed}`"
            f"{'' if part == PARTS - 1 else f', stopped after {part + 1} of {PARTS} parts'}, {time.monotonic() - begun:.0f} s. "
            f"Every {WHOLE}th case goes through a whole command.\n\n{table(rows)}"
        )
        if given.out:
            given.out.write_text(text, encoding="utf-8")
        print(f"{part + 1} of {PARTS} parts, {time.monotonic() - begun:.0f} s", file=sys.stderr, flush=True)
    if not given.out:
        print(text)


if __name__ == "__main__":
    main()
