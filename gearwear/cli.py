"""The console command: ``gearwear compare``, ``gearwear models``, … Nothing heavy is imported before a command is known."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module

COMMANDS = {
    "compare": ("gearwear.compare", "compare a scan with its design: the main job"),
    "models": ("gearwear.models", "write the nominal STEP models of a design"),
    "inspect": ("gearwear.inspect", "ISO 1328-1 deviations of a scanned gear, worn or new"),
    "paper": ("gearwear.paper", "the published calculation, number by number"),
}


def usage() -> str:
    """What ``gearwear --help`` prints."""
    lines = ["usage: gearwear COMMAND [ARGUMENTS]", "", "commands:"]
    lines += [f"  {name:<9}{what}" for name, (_, what) in COMMANDS.items()]
    lines += ["", "gearwear COMMAND --help tells more; gearwear --version prints the version"]
    return "\n".join(lines)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the named command; 0 done, 2 an input or argument is wrong."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if not arguments or arguments[0] in ("-h", "--help"):
        print(usage())  # noqa: T201
        return 0
    if arguments[0] == "--version":
        from gearwear import __version__

        print(f"gearwear {__version__}")  # noqa: T201
        return 0
    name, rest = arguments[0], arguments[1:]
    if name not in COMMANDS:
        print(f"gearwear: {name!r} is no command; {', '.join(COMMANDS)} would be right", file=sys.stderr)  # noqa: T201
        return 2
    result: int = import_module(COMMANDS[name][0]).main(rest)
    return result
