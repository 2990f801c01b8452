"""What all commands share: a parser whose errors are one line, the exit status, and the page that describes them."""

from __future__ import annotations

import argparse
import atexit
import errno
import gc
import io
import os
import shlex
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, NoReturn, TextIO, cast

from gearwear.errors import InputError, NotThisGear, readable
from gearwear.memory import DEFAULT, allowing

if TYPE_CHECKING:
    from _typeshed import SupportsWrite

DONE, WRONG, STOPPED = 0, 2, 128
"""Exit status: done; an input or an argument is wrong; stopped by a signal, which is added (130: interrupted, 143: terminated)."""
STOPPING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
"""Signals that end a command in order, where the system has them."""
WHERE, HOW = ("--out", "--memory"), ("--quiet", "--verbose", "--pdf", "--no-page")
"""Options with a value and without that say nothing of a result itself."""
LONGEST = 6000
"""Letters of the one line that says what is wrong; a path may have 4096."""


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

    def print_help(self, file: SupportsWrite[str] | None = None) -> None:
        """Print the help; argparse would say nothing where that fails."""
        (file or sys.stdout).write(self.format_help())

    def error(self, message: str) -> NoReturn:
        """Refuse the arguments."""
        if message.endswith("expected one argument"):  # argparse takes -5,30 for another option
            message += ", joined with = where it begins with a minus sign"
        raise InputError(f"{message}; {self.prog} --help says what is right")


def store_parser(name: str, description: str) -> Parser:
    """The arguments of a command that studies what ``gearwear batch`` wrote, and by itself writes into a folder of its name there."""
    p = Parser(name, "STORE", description)
    p.add_argument("store", type=Path, metavar="STORE", help="folder that gearwear batch wrote to")
    p.add_argument("--out", type=Path, metavar="DIR", help=f"folder to write to; left out: {name} in the store")
    p.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return p


def answer(parser: Parser, command: Callable[[argparse.Namespace], int | None], argv: Sequence[str] | None) -> int:
    """Parse the arguments, run a command, and turn what is wrong into one line.

    Parameters
    ----------
    parser : Parser
        The command's arguments; options and inputs may come in any order.
    command : callable
        Given the parsed arguments; what it returns is the exit status, None is 0.
    argv : sequence of str or None
        None: those of the command line.

    Returns
    -------
    int
        Exit status: 0 done; 2 an input or an argument is wrong, said in one line on standard error; 130, 143 … stopped by a signal.
    """
    if argv is None:
        alone()
    _standard_streams()
    status = DONE
    try:
        with _uncollected(), _stoppable():
            with suppress(SystemExit):  # --help; rich, where whoever reads has seen enough
                arguments = parser.parse_intermixed_args(argv)
                arguments.command = command_line(parser.prog, sys.argv[1:] if argv is None else argv)
                with allowing(getattr(arguments, "memory", DEFAULT)):
                    status = command(arguments) or DONE
            sys.stdout.flush()
    except NotThisGear as error:
        from gearwear.identify.survey import seems

        return refuse(f"{error}{seems(error.points, error.planar)}")
    except InputError as error:
        return refuse(str(error))
    except MemoryError:
        return refuse("the memory of this machine is not enough: a thinner scan, or a machine with more memory, would be right")
    except KeyboardInterrupt as stop:
        with suppress(OSError, ValueError):
            sys.stderr.write("gearwear: stopped\n")
        return STOPPED + (stop.args[0] if stop.args else signal.SIGINT)
    except OSError as error:
        reason = _unwritable_output()
        if reason is None:
            raise
        if isinstance(error, BrokenPipeError):  # whoever reads has seen enough
            return status
        return refuse(
            f"standard output cannot be written to ({reason}): free space there, or --out and --quiet where there are these, would be right"
        )
    return status


def command_line(name: str, argv: Sequence[str]) -> str:
    """How a result was asked for, as one types it: without where it goes and how much is said of it, which change nothing in it."""
    kept, words = [], iter(argv)
    for word in words:
        if word in WHERE:
            next(words, None)
        elif word not in HOW and not word.startswith(tuple(f"{option}=" for option in WHERE)):
            kept.append(word)
    return readable(shlex.join([*name.split(), *kept]))


def say(text: str) -> int:
    """Print what was asked for and nothing else, such as ``--version``; the exit status."""

    def write(_: argparse.Namespace) -> None:
        sys.stdout.write(text)

    return answer(Parser("", "", ""), write, [])


def refuse(message: str) -> int:
    """Say in one line on standard error what is wrong; the exit status for it.

    A line break in a file's name is written as one writes it in Python; what is far longer than a line loses its middle.
    """
    line = "".join(c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in message)
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} … {line[-LONGEST // 2 :]}"
    with suppress(OSError, ValueError):  # nobody is there to be told
        sys.stderr.write(f"gearwear: {line}\n")
    return WRONG


class _Closed(io.TextIOBase):
    """Stands where standard output was closed by whoever started this: nothing goes there, and that is an error."""

    def write(self, text: str) -> int:
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))


def _standard_streams() -> None:
    """Streams that fail in order: a terminal that has no µ gets a question mark, a closed one is never another file's place."""
    for name, number in (("stdin", 0), ("stdout", 1), ("stderr", 2)):
        stream = getattr(sys, name)
        if stream is None:
            with suppress(OSError):  # else the next file that is opened would get its number, and what libraries in C print
                if not _is_open(number):
                    place = os.open(os.devnull, os.O_RDWR)
                    if place != number:
                        os.dup2(place, number)
                        os.close(place)
            if name == "stdout":
                sys.stdout = cast(TextIO, _Closed())
            elif name == "stderr":
                sys.stderr = io.StringIO()
        elif hasattr(stream, "reconfigure") and name != "stdin":
            stream.reconfigure(errors="backslashreplace" if name == "stderr" else "replace")


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


def _unwritable_output() -> str | None:
    """Why standard output cannot be written to, None if it can; what waits to be written is then dropped."""
    try:
        sys.stdout.write("")
        sys.stdout.flush()
    except OSError as error:
        with suppress(OSError, ValueError):  # else Python would try once more when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return error.strerror or str(error)
    return None


class _Stopped(KeyboardInterrupt):
    """A signal came, whose number it holds. Of a `KeyboardInterrupt` itself that goes through an `exec` Python remembers, and ends as by SIGINT."""


@contextmanager
def _stoppable() -> Iterator[None]:
    """Signals that end a process end the command in order: what it has begun is taken away."""

    def stop(number: int, _: FrameType | None) -> None:
        for later in numbers:  # once is enough: cleaning up is not interrupted
            signal.signal(later, signal.SIG_IGN)
        raise _Stopped(number)

    numbers = [getattr(signal, name) for name in STOPPING if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():  # only there can Python handle signals
        yield
        return
    before = {number: signal.getsignal(number) for number in numbers}
    numbers = [number for number in numbers if before[number] is not signal.SIG_IGN]  # nohup stays nohup
    for number in numbers:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, before[number])


def alone() -> None:
    """The process ends with the command: cycles are not looked for when it is done either, nor as the interpreter ends."""
    gc.disable()
    atexit.register(gc.freeze)


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

`gearwear NAME …` and `python -m gearwear NAME …` are the same; so are `python -m gearwear.compare`, `gearwear.models`
and `gearwear.paper`. Options and inputs may come in any order. `--help` is answered at once, nothing heavy is loaded.

Exit status: 0 done; 2 an input or an argument is wrong: one line on standard error with the file, line or value, what
is wrong and what would be right; 128 and the number of the signal where it was stopped (130, 143). Then nothing is
left half-written in the output folder. A result that is doubtful is said to be so on the terminal and in the report.

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
