"""What an option is given and cannot be is said in the user's words: no name of the program's own is in it."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

import pytest

from gearwear.cli import COMMANDS
from tests.commands.doors import PAIR, run

PLAIN = (None, float, int, Path)
"""argparse names these itself: "invalid float value"."""


@pytest.mark.parametrize("name", COMMANDS)
def test_every_type_of_a_command_is_plain_or_says_itself_what_would_be_right(name):
    for action in import_module(COMMANDS[name][0]).parser()._actions:
        if action.type in PLAIN:
            continue
        for wrong in ("", "x", "1", "1,", "1,2,3", "2,1", "nan,1"):
            with pytest.raises(argparse.ArgumentTypeError, match="would be right"):
                action.type(wrong)


@pytest.mark.parametrize("given", ["80,60", "80", "80,nan", "a,b", "1,inf"])
def test_two_diameters_the_wrong_way_round(given):
    said = run("inspect", PAIR, "scan.xyz", "--profile-diameters-mm", given)
    assert said.status == 2
    assert f"--profile-diameters-mm: {given}: two numbers in mm" in said.err and "the smaller one first" in said.err
    assert "_interval" not in said.err
