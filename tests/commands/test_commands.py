"""Every command answers alike: help at once, errors in one line, options in any order, a page that describes them."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from importlib import import_module

import pytest

from gearwear.cli import COMMANDS
from gearwear.commands.arguments import Parser, answer, command_line, commands_page
from gearwear.errors import InputError
from tests.commands.doors import ROOT, run

PARSERS = {name: import_module(module).parser() for name, (module, _) in COMMANDS.items()}


def test_the_page_of_commands_is_in_step():
    said = run("--markdown")
    page = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    assert said.out == page == commands_page(PARSERS.values()), "python -m gearwear --markdown > docs/commands.md"


def test_every_option_has_words_of_its_own():
    for parser in PARSERS.values():
        assert parser.description
        helps = [action.help for action in parser._actions]
        assert all(helps) and len(set(helps)) == len(helps), parser.prog


@pytest.mark.parametrize("name", COMMANDS)
def test_help_is_printed_and_no_line_is_too_long_for_a_terminal(name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "90")
    said = run(name, "--help")
    assert (said.status, said.err) == (0, "")
    assert said.out.startswith(f"usage: {PARSERS[name].synopsis} [options]\n")
    assert max(map(len, said.out.splitlines())) <= 90


def test_bare_and_help_list_the_commands():
    assert run() == run("--help") == run("-h")
    assert all(f"\n  {name} " in run().out for name in COMMANDS)
    assert run("--version").out.startswith("gearwear ")


@pytest.mark.parametrize("words", [[], *([name] for name in COMMANDS)], ids=" ".join)
def test_help_costs_no_more_than_numpy(words):
    """Not by the clock, which depends on the machine: by what is loaded."""
    code = (
        f"import runpy, sys; sys.argv = {['gearwear', *words, '--help']!r}\n"
        "try: runpy.run_module('gearwear', run_name='__main__', alter_sys=False)\n"
        "except SystemExit as left: assert not left.code, left.code\n"
        "ours = {name.split('.')[0] for name in sys.modules} - set(sys.stdlib_module_names)\n"
        "sys.stderr.write(' '.join(sorted(name for name in ours if not name.startswith('_'))))"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-S", "-c", code], capture_output=True, text=True, env=_with_packages(environment), check=True
    )
    assert set(done.stderr.split()) <= {"gearwear", "numpy"}
    assert done.stdout.startswith("usage: gearwear")


def _with_packages(environment: dict[str, str]) -> dict[str, str]:
    """Packages on the path without the site module, which may load some of its own."""
    import numpy

    site = str(os.path.dirname(os.path.dirname(numpy.__file__)))
    return {**environment, "PYTHONPATH": os.pathsep.join([str(ROOT), site])}


WRONG = [(name, arguments) for name in COMMANDS for arguments in (["--bogus"], ["--out"], ["--bogus=1", "x"])] + [
    ("compare", ["--part", "wheel"]),
    ("compare", ["--units", "furlong"]),
    ("compare", ["--points", "ply"]),
    ("compare", ["--no-lo"]),  # no abbreviations
    ("inspect", ["--class", "eight"]),
    ("inspect", ["--edition", "2020"]),
    ("meshing", ["--cycle", "week"]),
    ("meshing", ["--drive", "up"]),
    ("meshing", ["a.toml", "b.toml"]),
    ("paper", ["--json", "--markdown"]),
]


@pytest.mark.parametrize(("name", "arguments"), WRONG)
def test_wrong_arguments_are_one_line_and_status_2(name, arguments):
    said = run(name, *arguments)
    assert (said.status, said.out) == (2, "")
    assert said.err.startswith("gearwear: ") and said.err.count("\n") == 1
    assert f"gearwear {name} --help says what is right" in said.err


def test_no_such_command():
    said = run("compear")
    assert said.status == 2 and "'compear' is no command; compare, " in said.err and said.err.count("\n") == 1


@pytest.mark.parametrize("entry", [["-m", "gearwear", "compare"], ["-m", "gearwear.compare"]])
def test_a_process_leaves_with_the_status(entry, tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, *entry, "no.toml", "no.ply"], capture_output=True, text=True, env=environment, cwd=tmp_path, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "gearwear: no.toml: no such file; a design in TOML is needed\n"
    assert list(tmp_path.iterdir()) == []


class TestAnswer:
    parser = Parser("test", "[A]", "For a test.")
    parser.add_argument("a", nargs="?")
    parser.add_argument("b", nargs="*")
    parser.add_argument("--c")

    def test_inputs_and_options_in_any_order(self):
        seen: list[argparse.Namespace] = []
        for line in (
            ["x", "y", "z", "--c", "1"],
            ["--c", "1", "x", "y", "z"],
            ["x", "--c", "1", "y", "z"],
            ["x", "y", "--c=1", "z"],
        ):
            assert answer(self.parser, seen.append, line) == 0
        found = [{key: value for key, value in vars(one).items() if key != "command"} for one in seen]
        assert all(one == {"a": "x", "b": ["y", "z"], "c": "1"} for one in found) and len(seen) == 4

    def test_an_input_error_is_one_line_whatever_it_holds(self, capsys):
        def refuse(arguments: argparse.Namespace) -> None:
            raise InputError("odd\nname\x1b[31m\udcff.ply: is wrong")

        assert answer(self.parser, refuse, []) == 2
        assert capsys.readouterr().err == "gearwear: odd\\nname\\x1b[31m\\udcff.ply: is wrong\n"

    def test_an_interrupt_is_no_traceback(self, capsys):
        def interrupt(arguments: argparse.Namespace) -> None:
            raise KeyboardInterrupt

        assert answer(self.parser, interrupt, []) == 130
        assert capsys.readouterr().err == "gearwear: stopped\n"

    def test_a_bug_is_not_hidden(self):
        def broken(arguments: argparse.Namespace) -> None:
            raise ZeroDivisionError

        with pytest.raises(ZeroDivisionError):
            answer(self.parser, broken, [])


def test_a_reader_that_has_seen_enough_is_no_error():
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = f"{sys.executable} -m gearwear.paper --json | head -c 10; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, env=environment, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_terminal_without_greek_gets_question_marks():
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    command = [sys.executable, "-m", "gearwear", "meshing", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "--teeth TOOTH[,TOOTH?]|all" in done.stdout


@pytest.mark.parametrize(
    ("argv", "told"),
    [
        (["a b.toml", "s.ply", "--part", "gear"], "gearwear compare 'a b.toml' s.ply --part gear"),
        (
            ["--out", "x", "d.toml", "--quiet", "s.ply", "--pdf", "--out=y", "--no-page", "--verbose"],
            "gearwear compare d.toml s.ply",
        ),
        (["--no-loop", "--memory", "2"], "gearwear compare --no-loop"),
        (["d.toml", "m\udcff.ply"], "gearwear compare d.toml 'm\\xff.ply'"),
    ],
)
def test_the_command_that_is_told_leaves_out_what_changes_no_number(argv, told):
    assert command_line("gearwear compare", argv) == told
