"""What all commands share: a parser whose errors are one line, the exit status, and the page that describes them."""

from __future__ import annotations

import argparse
import gc
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import NoReturn, TextIO

from gearwear.errors import InputError, NotThisGear

DONE, WRONG, STOPPED = 0, 2, 130
"""Exit status: done; an input or an argument is wrong; interrupted (128 + SIGINT)."""


class Parser(argparse.ArgumentParser):
    """An argument parser that raises `InputError` where argparse would print its usage and leave.

    Parameters
    ----------
    name : str
        The command, such as ``compare``.
    inputs : str
        What stands behind it, such as ``[DESIGN.toml SCAN [SCAN …]]``; may be empty.
    description : str
        Paragraphs, for ``--help`` and the page of commands.
    """

    def __init__(self, name: str, inputs: str, description: str) -> None:
        # No abbreviated options: a script that uses one breaks when the next option is added.
        super().__init__(
            prog=f"gearwear {name}",
            usage=" ".join(filter(None, (f"gearwear {name}", inputs, "[options]"))),
            description=description,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        self.synopsis = f"gearwear {name} {inputs}".rstrip()

    def error(self, message: str) -> NoReturn:
        """Refuse the arguments."""
        raise InputError(f"{message}; {self.prog} --help says what is right")


def answer(parser: Parser, command: Callable[[argparse.Namespace], None], argv: Sequence[str] | None) -> int:
    """Parse the arguments, run a command, and turn what is wrong into one line.

    Parameters
    ----------
    parser : Parser
        The command's arguments; options and inputs may come in any order.
    command : callable
        Given the parsed arguments.
    argv : sequence of str or None
        None: those of the command line.

    Returns
    -------
    int
        Exit status: 0 done; 2 an input or an argument is wrong, said in one line on standard error; 130 interrupted.
    """
    for stream in (sys.stdout, sys.stderr):
        _never_fails(stream)
    # Before numpy is loaded: its matrices here are narrow, and BLAS threads would mostly wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        with _uncollected():
            command(parser.parse_intermixed_args(argv))
        sys.stdout.flush()
    except NotThisGear as error:
        from gearwear.identify.survey import seems

        return refuse(f"{error}{seems(error.points, error.planar)}")
    except InputError as error:
        return refuse(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("gearwear: stopped\n")
        return STOPPED
    except BrokenPipeError:  # whoever reads has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return DONE


def refuse(message: str) -> int:
    """Say in one line on standard error what is wrong; the exit status for it.

    A line break in a file's name is written as one writes it in Python.
    """
    line = "".join(c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in message)
    sys.stderr.write(f"gearwear: {line}\n")
    return WRONG


@contextmanager
def _uncollected() -> Iterator[None]:
    """Reference cycles are left alone: a command ends before they matter, and looking for them takes a fifteenth of its time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _never_fails(stream: TextIO) -> None:
    """A terminal that has no µ gets a question mark, not a traceback."""
    if hasattr(stream, "reconfigure"):
        stream.reconfigure(errors="backslashreplace" if stream is sys.stderr else "replace")


def commands_page(parsers: Iterable[Parser]) -> str:
    """The page ``docs/commands.md``.

    Parameters
    ----------
    parsers : iterable of Parser
        One per command.
    """
    lines = [INTRODUCTION.strip()]
    for parser in parsers:
        lines += ["", f"## `{parser.synopsis}`", "", (parser.description or "").strip()]
        options = [action for action in parser._actions if action.option_strings and action.dest != "help"]
        if options:
            lines += ["", "| option | is |", "|---|---|"]
            lines += [f"| `{_escaped(_signature(action))}` | {_escaped(_meaning(action))} |" for action in options]
    return "\n".join(lines) + "\n"


INTRODUCTION = """
# The commands

`gearwear NAME …` and `python -m gearwear NAME …` are the same; so are `python -m gearwear.compare`, `gearwear.models` and `gearwear.paper`. Options and inputs may come in any order. `--help` is answered at once, nothing heavy is loaded for it.

Exit status: 0 done; 2 an input or an argument is wrong: one line on standard error with the file, line or value, what is wrong and what would be right. Then nothing is left
half-written in the output folder. A result that is doubtful is said to be so on the terminal and in the report.

The keys of a design file are in [design.md](design.md). This page is written by `python -m gearwear --markdown`.
"""


def _signature(action: argparse.Action) -> str:
    """``--before SCAN [SCAN …]``, ``--part pinion|gear``."""
    name = action.option_strings[-1]
    if action.nargs == 0:
        return name
    if isinstance(action.metavar, tuple):
        return " ".join([name, *action.metavar])
    value = "|".join(map(str, action.choices)) if action.choices is not None else str(action.metavar or action.dest.upper())
    return f"{name} {value} [{value} …]" if action.nargs == "+" else f"{name} {value}"


def _meaning(action: argparse.Action) -> str:
    return (action.help or "") % {"default": action.default}


def _escaped(text: str) -> str:
    return text.replace("|", r"\|")
