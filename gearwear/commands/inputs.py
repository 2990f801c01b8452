"""Which design and which scans a command was given."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser
from gearwear.errors import InputError
from gearwear.memory import DEFAULT

if TYPE_CHECKING:
    from gearwear.design.pair import Design


def add_scan_arguments(parser: Parser) -> None:
    """The inputs of a command that reads scans, and the options on how to take them."""
    parser.add_argument("design", nargs="?", type=Path, metavar="DESIGN.toml", help="the design: one gear or a pair")
    parser.add_argument("scan", nargs="*", type=Path, metavar="SCAN", help="the scan, or several views of one gear")
    parser.add_argument("--part", choices=["pinion", "gear"], help="which one of a pair was scanned; left out: the one that fits")
    parser.add_argument(
        "--units", choices=["mm", "cm", "m", "um", "in"], default="mm", help="unit of the scan, default %(default)s"
    )
    add_memory_argument(parser)


def add_stream_argument(parser: Parser) -> None:
    """Whether a scan is held in memory."""
    parser.add_argument(
        "--stream", action="store_true", default=None,
        help="go through the scan chunk by chunk and hold only a sample of its points in memory; from 5 million points on, and where the scan "
        "needs more than --memory, that is done by itself",
    )  # fmt: skip


def add_memory_argument(parser: Parser) -> None:
    """How much memory a file may need; `gearwear.commands.arguments.answer` sees to it."""
    parser.add_argument(
        "--memory", type=float, default=DEFAULT, metavar="GB",
        help="refuse a file that would need more memory, by what it holds and before it is read; default %(default)g",
    )  # fmt: skip


def add_output_arguments(parser: Parser) -> None:
    """Where to write, and how much to say."""
    parser.add_argument(
        "--out", type=Path, default=Path("gearwear-out"), metavar="DIR",
        help="folder to write to, default %(default)s in the current one; files of the same names are replaced, others stay",
    )  # fmt: skip
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def add_report_arguments(parser: Parser) -> None:
    """What stands at the head of a report; each goes before what ``[report]`` of the design says."""
    for name, words in (
        ("part-number", "of the gear"), ("serial", "serial number of the gear"), ("customer", "for whom"),
        ("operator", "who measured"), ("instrument", "with what"), ("date", "when, as it is to be written"), ("remarks", "of any kind"),
        ("logo", "PNG or JPEG"),
    ):  # fmt: skip
        parser.add_argument(
            f"--{name}", default=None, metavar="FILE" if name == "logo" else "TEXT", help=f"at the head of the report: {words}"
        )
    parser.add_argument(
        "--pdf", action="store_true", help="also write report.pdf: the report on pages of A4, to be signed and sent"
    )


def with_details(design: Design, arguments: Namespace) -> Design:
    """The design with what the options say for the head of the report.

    Raises
    ------
    InputError
        If a text cannot be printed or the logo cannot be read: said before the work, not after it.
    """
    from gearwear.report.logo import read_logo

    asked = {field.name: getattr(arguments, field.name) for field in fields(design.report)}
    details = replace(design.report, **{name: text.strip() for name, text in asked.items() if text is not None})
    if details.logo:
        read_logo(details.logo)
    return replace(design, report=details)


@contextmanager
def bundled_example() -> Iterator[Path]:
    """The folder of the bundled example."""
    with resources.as_file(resources.files("gearwear") / "example") as folder:
        yield folder


def design_alone(arguments: Namespace) -> Design:
    """The design that was named, or that of the bundled example."""
    from gearwear.design.files.toml import read_design

    with bundled_example() as example:
        return read_design(arguments.design or example / "design.toml")


@contextmanager
def design_and_scans(arguments: Namespace) -> Iterator[tuple[Path, list[Path]]]:
    """The design file and the scans that were named, or the bundled example.

    Raises
    ------
    InputError
        If there is a design and no scan, or they stand in the wrong order.
    """
    design, scans = arguments.design, arguments.scan
    if design is None:
        with bundled_example() as example:
            yield example / "design.toml", [example / "scan.ply.gz"]
        return
    if not scans:
        raise InputError(
            f"no scan is given beside {design}: DESIGN.toml SCAN [SCAN …], or nothing at all for the bundled example"
        )
    named = [path for path in scans if path.suffix.lower() == ".toml"]
    if named:
        raise InputError(f"{named[0]} stands among the scans: the design comes first and once, DESIGN.toml SCAN [SCAN …]")
    yield design, scans
