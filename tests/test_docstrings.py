"""Docstrings name the parameters that there are, and say None where it may be given."""

import pytest

from tests.docstrings import untrue
from tests.layers import modules
from tests.test_layers import PACKAGE


def test_docstrings_name_what_is_taken():
    assert [line for module, _, source in modules(PACKAGE) for line in untrue(source, module)] == []


SAID = '"""Something.\n\n    Parameters\n    ----------\n    {}\n        What it is.\n    """'


@pytest.mark.parametrize(
    ("taken", "said", "true"),
    [
        ("a, b", "a, b : int", True),
        ("a, b", "b, a : int", False),
        ("a, b", "a : int", False),
        ("a", "own : int", False),
        ("*a: int, b: int = 0", "*a, b : int", True),
        ("a: int | None", "a : int or None", True),
        ("a: int | None", "a : int", False),
        ("a: int", "a : int or None", False),
        ("a: tuple[int | None, ...]", "a : tuple of int or None", True),
        ("a: int | None", "a", True),
    ],
)
def test_the_checker_sees_what_is_untrue(taken, said, true):
    assert (untrue(f"def f({taken}):\n    {SAID.format(said)}", "m") == []) is true


def test_a_class_may_say_its_fields_in_another_order():
    assert untrue(f"class A:\n    {SAID.format('b, a : int')}\n    a: int\n    b: int", "m") == []
    assert untrue(f"class A:\n    {SAID.format('b : int')}\n    a: int\n    b: int", "m") != []
