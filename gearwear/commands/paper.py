"""The rows as a table for the terminal and as JSON, and the command."""

from __future__ import annotations

import json
import shutil
import sys
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import asdict
from io import StringIO

from gearwear.commands.arguments import Parser, answer
from gearwear.paper.page import SOURCE, as_markdown, right, shown, shown_residual
from gearwear.paper.rows import chapters, rows

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
    """A table for the terminal: a line per number, under it its steps (+), what was tried instead (?) and what is right
    where something else holds (=); reasons below.

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
    console.print(
        Text(
            f"{SOURCE}\nresidual = recomputed − printed;  + effect added in turn;  ? tried alone instead;  = right under another condition",
            "dim",
        )
    )
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
                str(number), name, row.as_printed, shown(row, row.recomputed), shown_residual(row, row.residual), right(row)
            )
            for step in row.steps:
                table.add_row("", Padding(f"+ {step.effect}", (0, 0, 0, 2)), "", "", shown_residual(row, step.residual), "")
            for step in row.alternatives:
                tried = Padding(Text(f"? {step.effect}", "dim"), (0, 0, 0, 2))
                table.add_row("", tried, "", "", Text(shown_residual(row, step.residual), "dim"), "")
            for case in row.cases:
                where = Padding(Text(f"= {case.where}", "dim"), (0, 0, 0, 2))
                table.add_row("", where, "", "", "", Text(shown(row, case.value), "dim"))
    console.print(table)
    notes = Table.grid(padding=(0, 2), expand=True)
    notes.add_column(justify="right", style="dim")
    notes.add_column(ratio=1)
    for number, row in enumerate(rows(), start=1):
        notes.add_row(str(number), row.why)
    console.print(notes)
    return "\n".join(line.rstrip() for line in written.getvalue().splitlines()) + "\n"
