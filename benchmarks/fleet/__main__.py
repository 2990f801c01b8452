"""``python -m benchmarks.fleet make FOLDER [--gears N …]``: a fleet; ``check FOLDER STORE``: what trend and gauge say, beside the truth."""

from __future__ import annotations

import argparse
from pathlib import Path


def main() -> None:
    """Run a command."""
    p = argparse.ArgumentParser(prog="python -m benchmarks.fleet")
    commands = p.add_subparsers(dest="command", required=True)
    make = commands.add_parser("make")
    make.add_argument("folder", type=Path)
    for name, value in (
        ("gears", 30),
        ("inspections", 5),
        ("parts", 6),
        ("operators", 3),
        ("repeats", 3),
        ("points", 20_000),
        ("seed", 1),
    ):
        make.add_argument(f"--{name}", type=int, default=value)
    make.add_argument("--planar", action="store_true")
    check = commands.add_parser("check")
    check.add_argument("folder", type=Path)
    check.add_argument("store", type=Path)
    a = p.parse_args()
    if a.command == "make":
        from benchmarks.fleet.make import make_fleet

        print(make_fleet(a.folder, a.gears, a.inspections, a.parts, a.operators, a.repeats, a.points, a.seed, a.planar))
    else:
        from benchmarks.fleet.check import check_fleet

        check_fleet(a.folder, a.store)


if __name__ == "__main__":
    main()
