"""The commands and snippets of the pages: found, run, and their shown output compared or renewed.

``python docs/run_blocks.py`` runs every page and tells what differs; ``--write`` puts what the program prints now in its place.
tests/test_docs.py does the same without writing.

In a page, a fenced block of ``sh`` or ``python`` is run, in the order of the page; a ``text`` block right behind it is its output. A line
with nothing but … in an output stands for lines left out. An HTML comment before a block says what is special about it:
``<!-- not run: why -->``, or ``<!-- file: NAME -->`` for a block that is saved under that name.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))

_FENCE = re.compile(
    r"^(?:<!-- (?P<how>not run|file): (?P<what>.+?) -->\n+)?```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S
)
_NUMBER = re.compile(r"([-+−]?\d+(?:\.\d+)?(?:e[-+−]?\d+)?)")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page.

    Parameters
    ----------
    page : Path
    line : int
        Of its fence.
    language : str
        "sh", "python", "toml", "text", "json" or "".
    text : str
        Without the fences.
    not_run, file : str
        From the comment before it: why it is not run; the name it is saved under.
    output : Block or None
        The ``text`` block right behind it.
    """

    page: Path
    line: int
    language: str
    text: str
    not_run: str = ""
    file: str = ""
    output: Block | None = None

    @property
    def place(self) -> str:
        """For messages."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    @property
    def commands(self) -> list[str]:
        """Lines of a ``sh`` block, continuations joined, comments left out."""
        lines = self.text.replace("\\\n", " ").splitlines()
        return [line.strip() for line in lines if line.strip() and not line.lstrip().startswith("#")]


def blocks(page: Path) -> list[Block]:
    """All blocks of a page, each output with what printed it."""
    text = page.read_text(encoding="utf-8")
    found: list[tuple[Block, int, int]] = []
    for match in _FENCE.finditer(text):
        how, what = match["how"], match["what"] or ""
        line = text.count("\n", 0, match.start("language")) + 1
        block = Block(page, line, match["language"], match["text"], what * (how == "not run"), what * (how == "file"))
        if block.language == "text" and found and found[-1][0].language in ("sh", "python"):
            before, start, end = found[-1]
            if not text[end : match.start()].strip():
                found[-1] = (
                    Block(page, before.line, before.language, before.text, before.not_run, before.file, block),
                    start,
                    end,
                )
                continue
        found.append((block, match.start(), match.end()))
    return [block for block, _, _ in found]


@dataclass
class Runner:
    """Runs the blocks of pages in one folder, which looks like a fresh clone.

    Parameters
    ----------
    folder : Path
        An empty folder.
    """

    folder: Path
    done: dict[str, str] = field(default_factory=dict)
    names: dict[Path, dict[str, object]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("gearwear", "models", "docs"):
            (self.folder / name).symlink_to(ROOT / name)
        self._a_scan_of_ones_own()

    def _a_scan_of_ones_own(self) -> None:
        """``scan.ply``: what the pages call the reader's scan is a fifth of the bundled one."""
        import numpy as np

        from gearwear.scan.reading import read_scan

        points = read_scan([ROOT / "gearwear" / "example" / "scan.ply.gz"], "mm")[0].points
        kept = points[np.random.default_rng(0).choice(len(points), 30_000, replace=False)]
        head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(kept)}"]
        head += [f"property float {axis}" for axis in "xyz"]
        data = kept.astype("<f4").tobytes()
        (self.folder / "scan.ply").write_bytes("\n".join([*head, "end_header\n"]).encode() + data)

    def run(self, block: Block) -> str:
        """Run a block in the folder; what it printed, errors included. The example's report is there for every page."""
        with contextlib.chdir(self.folder), _plain_terminal():
            self._command("gearwear compare")
            if block.file:
                Path(block.file).write_text(block.text, encoding="utf-8")
                return ""
            if block.language == "python":
                space = self.names.setdefault(block.page, {"__name__": "__main__"})
                with _printed() as printed, _importable(self.folder):
                    exec(compile("\n" * block.line + block.text, str(block.page), "exec"), space)
                return printed.getvalue()
            return "".join(map(self._command, block.commands))

    def _command(self, line: str) -> str:
        """One command; what an earlier page ran already is not run again."""
        line = _after_installing(line)
        if line not in self.done:
            words = shlex.split(line)
            if not words:
                self.done[line] = ""
            elif words[0] == "gearwear" and not {"|", ">"} & set(words):
                from gearwear.cli import main

                with _printed() as printed:
                    main(words[1:])
                self.done[line] = printed.getvalue()
            else:
                run = subprocess.run(["sh", "-ec", line], capture_output=True, text=True, timeout=60, check=False)
                if run.returncode:
                    raise RuntimeError(f"{line}: {run.stderr}")
                self.done[line] = run.stdout + run.stderr
        return self.done[line]


def _after_installing(line: str) -> str:
    """What a command does once gearwear is there: an environment is not made again, and no tests are run from a test."""
    last = line.rsplit(" && ", 1)[-1] if "-m venv" in line else line
    last = re.sub(r"^\.venv/bin/(gearwear|python -m gearwear\.)", "gearwear ", last)
    return "" if last.endswith(" -m pytest") else re.sub(" +", " ", last)


@contextlib.contextmanager
def _printed() -> Iterator[io.StringIO]:
    """Standard output and error in one text."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
        yield text


@contextlib.contextmanager
def _importable(folder: Path) -> Iterator[None]:
    """A module that a page saved can be imported by it."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))


@contextlib.contextmanager
def _plain_terminal() -> Iterator[None]:
    """Eighty columns, no colours."""
    kept = {name: os.environ.get(name) for name in ("COLUMNS", "NO_COLOR")}
    os.environ.update(COLUMNS="80", NO_COLOR="1")
    try:
        yield
    finally:
        for name, value in kept.items():
            os.environ.pop(name, None) if value is None else os.environ.update({name: value})


def difference(shown: str, printed: str) -> str:
    """What differs between an output as shown and as printed; "" where nothing does.

    Line breaks do not count. Numbers may differ by 2 % or two units of the last place shown: another processor rounds
    otherwise. The parts between lines of … must come in their order.
    """
    words = printed.split()
    at = 0
    for part in re.split(r"^…$", shown, flags=re.M):
        wanted = part.split()
        for start in range(at, len(words) - len(wanted) + 1):
            if all(map(_alike, wanted, words[start : start + len(wanted)])):
                at = start + len(wanted)
                break
        else:
            near = next((i for i in range(len(wanted)) if not any(_alike(wanted[i], word) for word in words[at:])), 0)
            return f"not printed: {' '.join(wanted[max(near - 3, 0) : near + 8])!r}; printed: {printed!r}"
    left_out = re.search(r"^…$", shown, flags=re.M)
    return "" if left_out or at == len(words) else f"printed too: {' '.join(words[at:])!r}"


def _alike(shown: str, printed: str) -> bool:
    one, other = _NUMBER.split(shown), _NUMBER.split(printed)
    return len(one) == len(other) and all(
        a == b if i % 2 == 0 else _close(a, b) for i, (a, b) in enumerate(zip(one, other, strict=True))
    )


def _close(shown: str, printed: str) -> bool:
    a, b = (float(text.replace("−", "-")) for text in (shown, printed))
    digits = re.search(r"\.(\d+)", shown)
    last = 10.0 ** -len(digits[1]) if digits else 1.0
    return abs(a - b) <= max(0.02 * abs(a), 2.0 * last * (digits is not None)) + 1e-12


def renewed(page: Path, outputs: dict[int, str]) -> str:
    """The page with the outputs at these lines replaced."""
    lines = page.read_text(encoding="utf-8").splitlines(keepends=True)
    for line in sorted(outputs, reverse=True):
        end = next(i for i in range(line, len(lines)) if lines[i].rstrip() == "```")
        lines[line:end] = [f"{text}\n" for text in outputs[line].rstrip().splitlines()]
    return "".join(lines)


def main() -> int:
    """Run the pages named on the command line, all of them where none is."""
    write = "--write" in sys.argv
    named = [Path(name).resolve() for name in sys.argv[1:] if not name.startswith("-")]
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(Path(folder))
        for page in named or PAGES:
            outputs = {}
            for block in blocks(page):
                if block.not_run or not (block.language in ("sh", "python") or block.file):
                    continue
                printed = runner.run(block)
                told = difference(block.output.text, printed) if block.output else ""
                if block.output and told:
                    wrong += 1
                    sys.stdout.write(f"{block.output.place}: {told}\n")
                    if not re.search("^…$", block.output.text, re.M):
                        outputs[block.output.line] = printed
            if write and outputs:
                page.write_text(renewed(page, outputs), encoding="utf-8")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    raise SystemExit(main())
