"""Make scans, have a checkout compare each in a process of its own, keep one JSON line a scan."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from benchmarks.families.families import case
from benchmarks.families.files import write_case

ROOT = Path(__file__).resolve().parents[2]
ONE = Path(__file__).with_name("compare_one.py")


def run(
    labels: Sequence[tuple[str, int]],
    seed: int,
    points: int,
    out: Path,
    checkout: Path = ROOT,
    jobs: int = 1,
    limit: float = 300.0,
) -> None:
    """Compare every scan that `out` has no line of yet.

    Parameters
    ----------
    labels : sequence of (family, number)
    seed, points : int
        Of the study.
    out : Path
        JSON lines; appended to.
    checkout : Path
        Folder that holds the `gearwear` to be judged.
    jobs : int
        Processes at a time.
    limit : float
        Seconds after which a comparison is ended.
    """
    have = {(line["label"], line["study_seed"], line["study_points"]) for line in read(out)} if out.exists() else set()
    todo = [label for label in labels if (f"{label[0]}{label[1]}", seed, points) not in have]
    out.parent.mkdir(parents=True, exist_ok=True)
    begun = time.perf_counter()
    with ThreadPoolExecutor(jobs) as pool, out.open("a") as file:
        lines = pool.map(lambda label: one(label, seed, points, checkout, limit), todo)
        for done, line in enumerate(lines, 1):
            file.write(json.dumps(line) + "\n")
            file.flush()
            said = line.get("refused") or line.get("failed") or f"{line['seconds']:.1f} s, {line['peak_mb']:.0f} MB"
            print(f"{done} of {len(todo)}  {line['label']:>5}  {line['truth']['what']}: {said}", file=sys.stderr, flush=True)
    print(f"{len(todo)} scans in {time.perf_counter() - begun:.0f} s, {len(labels) - len(todo)} were there", file=sys.stderr)


def one(label: tuple[str, int], seed: int, points: int, checkout: Path, limit: float) -> dict[str, Any]:
    """Make one scan and have it compared."""
    drawn = case(label[0], label[1], seed, points)
    with tempfile.TemporaryDirectory(prefix="families-") as name:
        folder = Path(name)
        design, scans, truth = write_case(drawn, folder)
        line: dict[str, Any] = {
            "label": drawn.label,
            "family": label[0],
            "study_seed": seed,
            "study_points": points,
            "truth": truth,
        }
        answer = folder / "answer.json"
        command = [sys.executable, str(ONE), str(answer), str(design), "pinion" if drawn.mate else "-", *map(str, scans)]
        alone = {"PYTHONPATH": str(checkout), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
        try:
            done = subprocess.run(
                command, env={**os.environ, **alone}, capture_output=True, text=True, timeout=limit, check=False, cwd=folder
            )
        except subprocess.TimeoutExpired:
            return line | {"failed": f"no answer in {limit:.0f} s", "seconds": limit, "peak_mb": None}
        if not answer.exists():
            said = (done.stderr.strip().splitlines() or ["no word"])[-1]
            return line | {"failed": f"exit {done.returncode}: {said}", "seconds": None, "peak_mb": None}
        told: dict[str, Any] = json.loads(answer.read_text())
        return line | told


def read(path: Path) -> Iterator[dict[str, Any]]:
    """Lines of a study."""
    with path.open() as file:
        for text in file:
            if text.strip():
                yield json.loads(text)
