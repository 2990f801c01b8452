"""The console command: ``gearwear compare``, ``gearwear models``, … Nothing heavy is imported before a command is known."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module

COMMANDS = {
    "compare": ("gearwear.commands.compare", "compare a scan with its design: the main job"),
    "inspect": ("gearwear.commands.inspect", "ISO 1328-1 deviations of a scanned gear, worn or new"),
    "meshing": ("gearwear.commands.meshing", "what a pair does in mesh, as designed and worn"),
    "design": ("gearwear.commands.design", "write a design file from a few dimensions, or from the scan"),
    "models": ("gearwear.commands.models", "the nominal gears and the pair as STEP models"),
    "batch": ("gearwear.commands.batch", "compare many scans, on all processors or a Dask cluster"),
    "trend": ("gearwear.commands.trend", "what changed on each gear of a fleet, and when a limit is reached"),
    "gauge": ("gearwear.commands.gauge", "how far repeated scans scatter, and whether as stated"),
    "paper": ("gearwear.commands.paper", "the published calculation, number by number"),
}
"""Module and purpose of every command; the module has `main` and `parser`."""


def usage() -> str:
    """What ``gearwear --help`` prints."""
    lines = ["usage: gearwear COMMAND [ARGUMENTS]", "", "commands:"]
    lines += [f"  {name:<9}{what}" for name, (_, what) in COMMANDS.items()]
    lines += ["", "gearwear COMMAND --help tells more; gearwear --version prints the version"]
    return "\n".join(lines) + "\n"


def main(argv: Sequence[str] | None = None) -> int:
    """Run the named command; 0 done, 2 an input or argument is wrong."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    name, rest = (arguments[0], arguments[1:]) if arguments else ("--help", [])
    if argv is None:
        from gearwear.commands.arguments import alone

        alone()
    if name in COMMANDS:
        result: int = import_module(COMMANDS[name][0]).main(rest)
        return result
    from gearwear.commands.arguments import commands_page, refuse, say

    if name in ("-h", "--help"):
        return say(usage())
    if name == "--version":
        from gearwear import __version__, compiled

        return say(f"gearwear {__version__}{', with compiled loops' if compiled.available() else ''}\n")
    if name == "--markdown":  # for docs/commands.md
        return say(commands_page(import_module(module).parser() for module, _ in COMMANDS.values()))
    return refuse(f"{name!r} is no command; {', '.join(COMMANDS)} would be right")
