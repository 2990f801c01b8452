"""The result on the terminal: one screen, read in ten seconds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.comparison.results import Results
from gearwear.design.quantity import listed, sentence, unbroken
from gearwear.report.words.clauses import to_a_clause, wrapped
from gearwear.report.words.consequences import change_line, said_changes
from gearwear.report.words.effects import found_words
from gearwear.report.words.numbers import effect_title, or_words
from gearwear.report.words.running import running_words
from gearwear.report.words.verdict import (
    alike_words,
    broken_words,
    doubts,
    grave_doubts,
    key_figures,
    subject,
    unexplained_words,
    verdict,
)
from gearwear.report.words.wear_law import forecast_words

if TYPE_CHECKING:
    from rich.console import Console

WIDEST = 100
MOST_LINES = 21
"""Lines of the summary, without those that name the files: with these and a prompt it fits a terminal of 24 lines. Warnings get what the rest leaves."""
ASCII = str.maketrans({
    "−": "-", "µ": "u", "→": "->", "±": "+/-", "³": "3", "²": "2", "·": "-", "…": "...", "α": "alpha", "–": "-", "°": " deg",
    "×": "x", "\u00a0": " ", "’": "'",
})  # fmt: skip


def print_lines(said: Iterable[tuple[str, str]], console: Console | None = None) -> None:
    """Print lines, each with its rich style, cut at the width of the terminal; in ASCII where it knows no more.

    Without a console: standard output. Colours only on a terminal, none where NO_COLOR is set (rich sees to both).
    """
    from rich.console import Console
    from rich.text import Text

    out = console or Console(highlight=False)
    width = min(out.width, WIDEST)
    for text, style in said:
        shown = text if (out.encoding or "utf-8").lower().startswith("utf") else text.translate(ASCII)
        out.print(Text(shown, style=style), width=width, no_wrap=True, overflow="ellipsis", crop=True)


def print_summary(results: Results, files: Sequence[str] = (), folder: Path | str = "", console: Console | None = None) -> None:
    """Print the verdict, the key figures, what the loop found, doubts and files.

    Parameters
    ----------
    results : Results
    files : sequence of str
        What was written.
    folder : path
        Where it is.
    console : rich.console.Console or None
        As for `print_lines`.
    """
    from rich.console import Console

    out = console or Console(highlight=False)
    print_lines([*lines(results, min(out.width, WIDEST)), *written(folder, files, min(out.width, WIDEST))], out)


def lines(results: Results, width: int = 80) -> list[tuple[str, str]]:
    """The summary as lines no wider than `width`, with the rich style of each; at most `MOST_LINES` of them, the last of which warn."""
    said = [(_cut(subject(results.part, results.gear, results.measured.scans, width), width), "dim"), ("", "")]
    grave, broken = grave_doubts(results), broken_words(results)
    said += [
        (line, "bold yellow" if grave else "bold") for line in to_a_clause(verdict(results), width, 5 if grave or broken else 4)
    ]
    said.append(("", ""))
    figures = [(figure.name, unbroken(figure.value), figure.note) for figure in key_figures(results)]
    wide = [max((len(row[i]) for row in figures), default=0) for i in (0, 1)]
    room = width - 6 - sum(wide)
    said += [
        (_cut(f"  {name:<{wide[0]}}  {value:<{wide[1]}}  {_clauses(note, room)}", width), "") for name, value, note in figures
    ]
    said.append(("", ""))
    cost = unbroken(change_line(said_changes(results), width))
    said += [(line, "") for line in [*_loop(results, width, 3 if cost else 4), *([cost] if cost else [])]]
    law = None if results.pair is None else results.pair.law
    said += [(line, "") for line in to_a_clause(forecast_words(law, results.wear.regions), width, 3)]
    second = None if results.pair is None else results.pair.second_loop
    if second is not None and second.effects:
        said += [(line, "") for line in wrapped(running_words(second), width, 3)]
    said_above = {sentence(piece.sentence) for piece in results.pieces}
    warned = [text for text in doubts(results) if not text.startswith(("Unexplained", "Doubtful")) and text not in said_above]
    room = max(3 if grave or broken else 4, MOST_LINES - len(said))
    for i, text in enumerate(warned):
        free = room - (i + 1 < len(warned))  # a line for how many more there are
        warning = to_a_clause(f"! {text}", width, max(free, 1) if i == 0 else len(text))
        if len(warning) > free:
            said.append((f"! and {len(warned) - i} more, in the report" if i else _cut(f"! {text}", width), "yellow"))
            break
        said += [(line, "yellow") for line in warning]
        room -= len(warning)
    return said


def written(folder: Path | str, names: Sequence[str], width: int = 80) -> list[tuple[str, str]]:
    """Where the files are, as lines with their style."""
    if not names:
        return []
    place = f"Written to {folder}: " if str(folder) else "Written: "
    for kept in range(len(names), -1, -1):
        more = f" and {len(names) - kept} more" if kept < len(names) else ""
        said = wrapped(place + ", ".join(names[:kept]) + more, width, 3)
        if len(said) <= 2:
            break
    return [(line, "dim") for line in said[:2]]


def _loop(results: Results, width: int, most: int) -> list[str]:
    """What was found besides wear, in at most so many lines: as fully as there is room for, and no sentence without its end."""
    for where, correlated, effects, named in (
        (True, True, 3, True), (True, False, 3, True), (False, False, 3, True), (False, False, 2, True), (False, False, 1, True),
        (False, False, 2, False),
    ):  # fmt: skip
        said = wrapped(_found(results, where, correlated, effects, named), width, most + 1)
        if len(said) <= most:
            return said
    return wrapped(_found(results, False, False, 1, False), width, most)


def _found(results: Results, where: bool, correlated: bool, most: int, named: bool) -> str:
    """What was found besides wear: with the places of what is unexplained, what is correlated, so many effects with their numbers at most, and
    the others by name, with what they cannot be told from, or counted."""
    loop, effects = results.loop, results.effects
    if loop is None:
        return "No effect of measurement or manufacture was looked for."
    worn = bool(results.wear.regions)
    text = sentence(f"{'besides wear ' if worn else ''}no {'known ' if loop.patterns else ''}effect stands out")
    if effects:
        said = [found_words(effect, results.open_sizes(effect)) + or_words(effect.alternatives) for effect in effects[:most]]
        rest = effects[most:]
        more = (
            [effect_title(effect.name) + or_words(effect.alternatives) for effect in rest]
            if named or not rest
            else [f"{len(rest)} more"]
        )
        text = sentence(f"{'besides wear' if worn else 'the scan shows'}: {listed([*said, *more])}")
        text = " ".join([text, *(map(sentence, alike_words(results)) if correlated else ())])
    return f"{sentence(unexplained_words(loop, results.gear, where))} {text}" if loop.patterns else text


def _clauses(note: str, room: int) -> str:
    """As many of its clauses as there is room for."""
    if len(note) <= room:
        return note
    ends = [i for i, c in enumerate(note) if c in ",;" and i <= room]
    return note[: ends[-1]] if ends else note


def _cut(text: str, width: int) -> str:
    text = unbroken(text).rstrip()
    return text if len(text) <= width else text[: width - 1].rstrip() + "…"
