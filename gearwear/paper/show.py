"""The rows as a table, as JSON and as a page."""

from __future__ import annotations

import json
import shutil
import sys
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import asdict
from io import StringIO

from gearwear.arguments import Parser, answer
from gearwear.paper.explain import Row
from gearwear.paper.rows import chapters, rows

SOURCE = "Kumar, Jain and Pathak, ICPME'2014, pp. 57-61, doi 10.15242/IAE.IAE1214203"
NARROWEST, WIDEST = 100, 120


def parser() -> Parser:
    """The command's arguments."""
    p = Parser(
        "paper",
        "",
        """\
The calculation of Kumar, Jain and Pathak (2014), number by number: as printed,
recomputed, what is behind the difference, and what is right.""",
    )
    form = p.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="the rows as JSON, with all digits")
    form.add_argument("--markdown", action="store_true", help="the rows as the page docs/paper.md")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Print the paper's numbers reproduced; 0 done, 2 an argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    if arguments.json:
        text = as_json()
    elif arguments.markdown:
        text = as_markdown()
    else:
        columns = shutil.get_terminal_size((WIDEST, 24)).columns
        text = as_table(min(max(columns, NARROWEST), WIDEST), colour=sys.stdout.isatty())
    sys.stdout.write(text)


def as_json() -> str:
    """The rows as a JSON list; numbers unrounded."""
    listed = []
    for row in rows():
        entry = asdict(row)
        del entry["as_printed"]
        listed.append(entry)
    return json.dumps(listed, ensure_ascii=False, indent=1) + "\n"


def as_table(width: int = WIDEST, *, colour: bool = False) -> str:
    """A table for the terminal: a line per number, its steps (+) and what was tried instead (?) under it, reasons below.

    Parameters
    ----------
    width : int
        Columns.
    colour : bool
        With terminal colours.
    """
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    written = StringIO()
    console = Console(file=written, width=width, force_terminal=colour, highlight=False, emoji=False, markup=False)
    console.print(Text("The paper, number by number", "bold"))
    console.print(Text(f"{SOURCE}\nresidual = recomputed − printed;  + effect added in turn;  ? tried alone instead", "dim"))
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1), expand=True)
    table.add_column("", justify="right", style="dim", no_wrap=True)
    table.add_column("", ratio=1)
    for name in ("printed", "recomputed", "residual", "right"):
        table.add_column(name, justify="right", no_wrap=True)
    number = 0
    for title, chapter in chapters().items():
        table.add_row("", Text(title, "bold"))
        for row in chapter:
            number += 1
            name = f"{row.item}, {row.unit}" if row.unit else row.item
            table.add_row(
                str(number), name, row.as_printed, _value(row, row.recomputed), _residual(row, row.residual), _right(row)
            )
            for step in row.steps:
                table.add_row("", Padding(f"+ {step.effect}", (0, 0, 0, 2)), "", "", _residual(row, step.residual), "")
            for step in row.alternatives:
                tried = Padding(Text(f"? {step.effect}", "dim"), (0, 0, 0, 2))
                table.add_row("", tried, "", "", Text(_residual(row, step.residual), "dim"), "")
    console.print(table)
    notes = Table.grid(padding=(0, 2), expand=True)
    notes.add_column(justify="right", style="dim")
    notes.add_column(ratio=1)
    for number, row in enumerate(rows(), start=1):
        notes.add_row(str(number), row.why)
    console.print(notes)
    return "\n".join(line.rstrip() for line in written.getvalue().splitlines()) + "\n"


def as_markdown() -> str:
    """The page ``docs/paper.md``."""
    lines = [
        "# The paper, number by number",
        "",
        f"{SOURCE}: wear of a 12-tooth pinion (module 6.35, 20°, mate of 24 teeth) from two laser scans.",
        "",
        "*Recomputed* is the paper's own formula with its own inputs at full precision, *residual* is recomputed − printed. Then causes are "
        "put into the calculation one after the other, each with the residual that is left. *Right* is what a physically right "
        "calculation gives; – where that is no single number. This page is written by `python -m gearwear.paper --markdown`; "
        "`--json` gives the same with all digits. Statements marked [from memory] were not read again in their source.",
        "",
        "| number | printed | recomputed | residual | after the last step | right |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for row in rows():
        name = f"{row.item}, {row.unit}" if row.unit else row.item
        values = (
            row.as_printed,
            _value(row, row.recomputed),
            _residual(row, row.residual),
            _residual(row, row.left),
            _right(row),
        )
        lines.append(f"| {name} | {' | '.join(value or '–' for value in values)} |")
    for title, chapter in chapters().items():
        lines += ["", f"## {title}"]
        for row in chapter:
            lines += ["", f"**{row.item[0].upper()}{row.item[1:]}** – printed {row.as_printed}{_unit(row)}. {row.why}", ""]
            lines += _steps(row)
    while not lines[-1]:
        lines.pop()
    return "\n".join(lines).replace("\n\n\n", "\n\n") + "\n"


def _steps(row: Row) -> list[str]:
    if not (row.steps or row.alternatives):
        return []
    lines = ["| effect | residual |", "|---|--:|", f"| the bare formula | {_residual(row, row.residual)} |"]
    lines += [f"| + {step.effect} | {_residual(row, step.residual)} |" for step in row.steps]
    lines += [f"| *tried alone: {step.effect}* | *{_residual(row, step.residual)}* |" for step in row.alternatives]
    return lines


def _unit(row: Row) -> str:
    return "" if not row.unit else row.unit if row.unit == "°" else f" {row.unit}"


def _decimals(row: Row) -> int:
    """Four for lengths and angles, two where the paper counts."""
    return 4 if row.unit in ("mm", "°") else 2


def _value(row: Row, value: float) -> str:
    return f"{value:.{_decimals(row)}f}".removesuffix(".00")


def _residual(row: Row, value: float) -> str:
    text = f"{value:+.{_decimals(row)}f}"
    return "0" if float(text) == 0.0 else text.removesuffix(".00")


def _right(row: Row) -> str:
    return "" if row.right is None else _value(row, row.right)
