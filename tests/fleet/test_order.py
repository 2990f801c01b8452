"""In what order inspections were, and which may be the last."""

from __future__ import annotations

from datetime import datetime
from itertools import permutations, product

import pytest

from gearwear.fleet.order import Occasion, order_of

MARCH, APRIL, MAY = (datetime(2026, month, 1) for month in (3, 4, 5))


def surely_before(one: Occasion, other: Occasion, by_cycles: bool) -> bool:
    """The rule by itself, pair by pair."""
    dated = one.inspected is not None and other.inspected is not None and one.inspected < other.inspected
    return dated or (by_cycles and one.cycles is not None and other.cycles is not None and one.cycles < other.cycles)


def contradict(one: Occasion, other: Occasion) -> bool:
    return surely_before(one, other, False) and one.cycles is not None and other.cycles is not None and one.cycles > other.cycles


def test_any_three_inspections():
    """Of every three with or without dates and cycles: the same whatever their order in the list; the last are those that are before no
    other; and where the order is known no one stands behind one that it is before."""
    kinds = [Occasion(*one) for one in product((None, MARCH, APRIL), (None, 0.0, 1e6, 2e6))]
    for three in product(kinds, repeat=3):
        order = order_of(three)
        assert all(order_of(other) == order for other in permutations(three))
        by_cycles = not any(contradict(*pair) for pair in permutations(three, 2))
        assert order.last == {one for one in three if not any(surely_before(one, other, by_cycles) for other in three)}
        assert set(order.inspections[-len(order.last) :]) == order.last
        assert (order.note == "") <= (len(order.last) == 1 and order.known)
        if order.known:
            behind = [(one, other) for i, other in enumerate(order.inspections) for one in order.inspections[i + 1 :]]
            assert not any(surely_before(one, other, by_cycles) for one, other in behind)


@pytest.mark.parametrize(("given", "known"), [
    ([(None, 0.0), (MARCH, 1e6)], True),
    ([(MARCH, None), (APRIL, 1e6)], True),
    ([(MARCH, 1e6), (APRIL, 1e6)], True),
    ([(MARCH, None), (None, 1e6)], False),
    ([(None, None), (None, 1e6)], False),
    ([(None, None)], True),
])  # fmt: skip
def test_cycles_or_dates_of_all_give_the_order(given, known):
    order = order_of(Occasion(*one) for one in given)
    assert order.known is known
    if known:
        assert order.inspections == tuple(Occasion(*one) for one in given)
        assert order.last == {order.inspections[-1]} and not order.note


def test_cycles_that_contradict_the_dates_give_no_order():
    falling = [Occasion(MARCH, 2e6), Occasion(APRIL, 1e6)]
    order = order_of(reversed(falling))
    assert (order.inspections, order.last, order.known) == (tuple(falling), {falling[1]}, True)
    assert order.note == "cycles_run falls from a date to a later one: the order is that of the dates"
    undated = Occasion(None, 0.0)  # its few cycles say nothing any more
    assert order_of([*falling, undated]).last == {falling[1], undated}
    assert "1 of 3 without inspected, cycles_run falls" in order_of([*falling, undated]).note


def test_those_with_neither_are_told_apart():
    order = order_of([Occasion(), Occasion(which=1), Occasion(MAY, 1.0)])
    assert len(order.last) == 3
    assert order.note.startswith("which of 3 inspections is the last is not known, the worst counts: 2 of 3 without inspected")
