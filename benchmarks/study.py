"""The study of the closed loop: scans with known truth, the table of what was found.

python -m benchmarks.study --scans 200 --nulls 200 --seed 1 --workers 2 --out docs/study.md

One scan again, with its truth beside what was found: --only 37 (n37: a null scan).
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

# A worker's linear algebra is small: threads of its own would only get in the others' way. Set before numpy is imported.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"


def main(arguments: list[str] | None = None) -> None:
    options = _parser().parse_args(arguments)
    if options.only:
        from benchmarks.loop_study.show import show

        show(options.only, options.seed, options.points)
        return
    labels = [str(i) for i in range(options.scans)] + [f"n{i}" for i in range(options.nulls)]
    begun, scores = time.perf_counter(), []
    with multiprocessing.get_context("spawn").Pool(options.workers) as pool:
        tasks = [(label, options.seed, options.points) for label in labels]
        for score in kept(pool.imap(_run, tasks), options.details):
            scores.append(score)
            if sys.stderr.isatty():
                print(f"\r{len(scores)} of {len(labels)}", end="", file=sys.stderr, flush=True)
    print(f"\r{len(scores)} scans in {time.perf_counter() - begun:.0f} s", file=sys.stderr)

    from benchmarks.loop_study.table import markdown
    from gearwear import __version__

    command = f"python -m benchmarks.study --scans {options.scans} --nulls {options.nulls} --seed {options.seed} --points {options.points}"
    page = markdown(scores, command, __version__)
    if options.out:
        Path(options.out).write_text(page)
    else:
        print(page)


def kept(scores: Iterable[dict[str, Any]], file: str | None) -> Iterator[dict[str, Any]]:
    """The scores, each written as a line of JSON as it comes, where there is a file: a study that is killed keeps what it had."""
    if not file:
        yield from scores
        return
    with open(file, "w", encoding="utf-8") as lines:
        for score in scores:
            lines.write(json.dumps(score) + "\n")
            lines.flush()
            yield score


def _run(task: tuple[str, int, int]) -> dict[str, Any]:
    from benchmarks.loop_study.run import run

    try:
        return run(*task)
    except Exception as error:  # one scan that breaks the fit is a result, not the end of the study
        return {"label": task[0], "refused": f"{type(error).__name__}: {error}"}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study", description=__doc__.splitlines()[0])
    parser.add_argument("--scans", type=int, default=200, help="scans with one to three effects (default: %(default)s)")
    parser.add_argument("--nulls", type=int, default=200, help="scans without (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the whole study (default: %(default)s)")
    parser.add_argument("--points", type=int, default=40_000, help="of each scan, about (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=2, help="processes (default: %(default)s)")
    parser.add_argument("--out", metavar="FILE", help="where the page is written (default: the terminal)")
    parser.add_argument("--details", metavar="FILE", help="where a JSON line for each scan is written as it comes")
    parser.add_argument("--only", metavar="N", help="one scan by its number, truth against found: 37, or n37 for a null scan")
    return parser


if __name__ == "__main__":
    main()
