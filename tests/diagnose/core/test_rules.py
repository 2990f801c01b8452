"""The thresholds: each is told of, and other ones hold inside a `with` only."""

from dataclasses import fields, replace

import pytest

from gearwear.diagnose.rules import RULES, in_force, rules
from tests.diagnose.core.test_elimination import U, stood
from tests.diagnose.core.toy import Toy


@pytest.mark.parametrize("one", fields(RULES), ids=lambda one: one.name)
def test_a_rule_says_its_unit_its_origin_and_why(one):
    about = one.metadata
    assert about["unit"] and about["why"]
    assert about["origin"].split(",")[0].split(":")[0] in {"derived", "literature", "numerical", "tuned"}


def test_models_that_cannot_be_told_apart_differ_by_the_square_of_the_errors():
    assert replace(RULES, errors=2.0).close == 4.0


def test_other_rules_are_in_force_inside_only_and_change_what_is_named():
    there = 0.01 * U
    with pytest.raises(ZeroDivisionError), in_force(replace(RULES, least_share=10.0)):
        assert rules().least_share == 10.0
        assert stood(there, (Toy("there"), U))[0] == set()
        raise ZeroDivisionError
    assert rules() is RULES
    assert stood(there, (Toy("there"), U))[0] == {"there"}
