"""What the documents promise: commands in one line, every key and format named, examples that work."""

import importlib.util
import math
import os
import re
import subprocess
import sys
import tomllib
from dataclasses import fields
from fnmatch import fnmatch
from pathlib import Path
from typing import ClassVar

import pytest

from gearwear.cli import COMMANDS
from gearwear.design import GearSpec, PairSpec, parse_design
from gearwear.design.files.sections import PAIR_KEYS, SCANNER_KEYS
from gearwear.design.files.toml import GEAR_KEYS, TOLERANCE_KEYS
from gearwear.errors import InputError
from gearwear.scan.reading import READERS
from tests.layers import BELOW, MAY_IMPORT

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def fenced(document: str, language: str) -> list[str]:
    """Code blocks of one language, without their fences."""
    return re.findall(rf"^```{language}\n(.*?)^```", document, flags=re.MULTILINE | re.DOTALL)


def rows(document: str, heading: str) -> dict[str, list[str]]:
    """Table rows below a heading by the key in their first column."""
    section = document.split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("| `")]
    return {row[0].strip("`"): row[1:] for row in cells}


class TestCommands:
    commands: ClassVar = [block.strip() for block in fenced(text("README.md"), "sh") if "-m venv" in block]

    def test_two_commands_of_one_line_each(self):
        assert len(self.commands) == 2
        assert all("\n" not in command for command in self.commands)

    def test_each_makes_and_uses_an_environment_of_its_own(self):
        folders = []
        for command in self.commands:
            make, install, run = command.split(" && ")
            made = re.fullmatch(r"python3 -m venv (\.venv[\w-]*)", make)
            assert made is not None
            folder = made[1]
            assert install.startswith(f"{folder}/bin/pip install ")
            assert run.startswith(f"{folder}/bin/python -m ")
            folders.append(folder)
        assert len(set(folders)) == 2

    def test_the_first_runs_the_main_job_on_the_bundled_example(self):
        _, install, run = self.commands[0].split(" && ")
        assert install.endswith("/pip install .")
        assert run.endswith("/python -m gearwear.compare")

    def test_the_second_installs_the_tests_and_passes_them(self):
        _, install, run = self.commands[1].split(" && ")
        assert install.endswith('/pip install ".[test]"')
        assert run.endswith("/python -m pytest")

    def test_the_checks_run_the_same(self):
        script = text(".ci/run")
        assert re.findall(r"pip\" install (?:--quiet )?(\S+)", script) == ['".[test]"']
        assert script.endswith("\ncheck pytest\nexit $status\n")

    def test_environments_are_not_committed(self):
        ignored = text(".gitignore").split()
        for command in self.commands:
            folder = command.split(" && ")[0].split()[-1]
            assert any(fnmatch(f"{folder}/", pattern) for pattern in ignored)


class TestDesignKeys:
    document: ClassVar = text("docs/design.md")
    every: ClassVar = rows(document, "`[pinion]` and `[gear]`")
    gear: ClassVar = {key: row for key, row in every.items() if len(row) == 4}
    drawn: ClassVar = {one.strip("` ") for key, row in every.items() if len(row) == 2 for one in key.split(",")}
    """Keys of flanks as drawn, of which a row has several, without defaults and ranges."""

    def test_every_key_is_documented_and_no_other(self):
        sides = {side for side in ("left", "right") if f"[gear.{side}]" in self.document}
        assert set(self.gear) | self.drawn | sides == set(GEAR_KEYS)
        assert set(rows(self.document, "`[pair]`")) == set(PAIR_KEYS)
        assert set(rows(self.document, "`[scanner]`")) == set(SCANNER_KEYS)
        assert set(rows(self.document, "`[gear.tolerance]`")) == set(TOLERANCE_KEYS)

    def test_defaults_are_those_of_the_program(self):
        defaults = {field.name: field.default for field in fields(GearSpec)}
        for key, (_, default, *_) in self.gear.items():
            if key in defaults and isinstance(defaults[key], float):
                assert float(default) == defaults[key], key
        assert self.gear["pressure_angle"][1] == "the mate's, else 20"
        assert math.degrees(GearSpec("gear", 20, 2.0, 10.0).normal_pressure_angle) == pytest.approx(20.0)
        assert rows(self.document, "`[pair]`")["baseline"][1] == f'`"{PairSpec().baseline}"`'

    @pytest.mark.parametrize("key", [key for key, row in gear.items() if re.fullmatch(r"[−\d.]+ … [\d.]+", row[2])])
    def test_ranges_are_those_of_the_program(self, key):
        low, high = (float(end.replace("−", "-")) for end in self.gear[key][2].split(" … "))
        table = {"teeth": 20, "module": 2.0, "face_width": 10.0}
        step = 1 if key == "teeth" else 1e-6
        for value in (low - step, high + step):
            given = round(value) if key == "teeth" else value
            with pytest.raises(InputError, match=rf"\[gear\] {key} = .*from {low:g} to {high:g}"):
                parse_design({"gear": {**table, key: given}})


@pytest.mark.parametrize("name", ["README.md", "docs/design.md"])
def test_designs_in_the_documents_are_legal(name):
    examples = fenced(text(name), "toml")
    assert examples
    gear = {"gear": {"teeth": 20, "module": 2.0, "face_width": 10.0}}
    for example in examples:
        tables = tomllib.loads(example)
        alone = not tables.keys() & {"pinion", "gear"}  # shown by itself, of any gear
        assert parse_design({**(gear if alone else {}), **tables}).gears


WRITTEN = {"paper.md", "rules.md", "study.md"}
"""Pages that a program writes, paragraph by paragraph."""


@pytest.mark.parametrize("path", [path for path in DOCUMENTS if path.name not in WRITTEN], ids=lambda path: path.name)
def test_lines_can_be_read_side_by_side(path):
    """Under 120 characters; tables, pictures and what stands in a block as code or output have the width they need."""
    prose = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    assert [line for line in prose.splitlines() if len(line) >= 120 and not line.startswith(("|", "!["))] == []


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)#]+)", path.read_text(encoding="utf-8")):
        if not target.startswith("http"):
            assert (path.parent / target).exists(), target


def test_the_tree_of_rooms_is_that_of_the_layers():
    """Each room with the rooms it imports, in an order in which none comes before one of these."""
    section = text("README.md").split("\n## How it is built up\n", 1)[1].split("\n## ", 1)[0]
    lines = re.findall(r"^  (\w+)/ +(.*?)  +(\S.*)$", fenced(section, "")[0], flags=re.MULTILINE)
    told = {room: frozenset(names.split()) & set(MAY_IMPORT) for room, _, names in lines}
    assert (
        set(told)
        == {room for room in MAY_IMPORT if room != "api"}
        == {path.name for path in (ROOT / "gearwear").iterdir() if (path / "__init__.py").exists()}
    )
    order = list(told)
    for room, names in BELOW.items():
        assert told[room] == names, room
        assert all(order.index(one) < order.index(room) for one in names)
    table = section.split("| you want to change | room |", 1)[1]
    assert set(re.findall(r"\| `(\w+)", table)) == set(MAY_IMPORT)


def test_every_format_is_named():
    inputs = text("README.md").split("## What goes in", 1)[1].split("\n## ", 1)[0]
    for ending in READERS:
        assert re.search(rf"\b{ending[1:].upper()}\b", inputs), ending


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_there_and_described(name):
    assert importlib.util.find_spec(COMMANDS[name][0]) is not None
    assert f"`gearwear {name}" in text("README.md")
    assert f"\n## `gearwear {name}" in text("docs/commands.md")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_is_described_and_no_other(name):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"}
    command = [sys.executable, "-m", "gearwear", name, "--help"]
    shown = subprocess.run(command, capture_output=True, text=True, env=environment, check=True).stdout
    section = text("docs/commands.md").split(f"\n## `gearwear {name}", 1)[1].split("\n## ", 1)[0]
    option = r"(?<![\w-])--[a-z][a-z-]*"
    assert set(re.findall(option, section)) == set(re.findall(option, shown)) - {"--help"}
