"""From a printed number to its cause: a formula, its inputs, and effects put in one after the other.

Nothing is typed in that can be computed: an effect changes the inputs or the way the result is written, the formula runs
again, and what is left over is the step's residual.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_DOWN, ROUND_HALF_UP, Decimal

from gearwear.paper.inputs import Inputs


def _same_inputs(inputs: Inputs) -> Inputs:
    return inputs


def _same_value(value: float) -> float:
    return value


@dataclass(frozen=True, slots=True)
class Cause:
    """One possible cause: it changes what the formula starts from, or how its result is written down."""

    name: str
    change: Callable[[Inputs], Inputs] = _same_inputs
    write: Callable[[float], float] = _same_value


@dataclass(frozen=True, slots=True)
class Step:
    """An effect and what it leaves: recomputed − printed with it in."""

    effect: str
    residual: float


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Spread of a recomputed number that comes from the rounding of what it is made of; same unit."""

    std: float
    low: float
    high: float
    confidence: float


@dataclass(frozen=True, slots=True)
class Case:
    """A right number, and what has to hold for it."""

    where: str
    value: float


@dataclass(frozen=True, slots=True)
class Row:
    """One printed number.

    Parameters
    ----------
    item : str
        What it is.
    unit : str
        Of every number in the row; "" is none.
    as_printed : str
        The paper's digits.
    printed, recomputed, residual : float
        As printed; by the paper's own formula and inputs; recomputed − printed.
    steps : tuple of Step
        Effects put in one after the other.
    alternatives : tuple of Step
        Other causes, each tried alone on the bare formula.
    right : float or None
        What a physically right calculation gives; None where that is no single number, and `why` says so.
    why : str
    uncertainty : Uncertainty or None
        Of `right` where there is one, else of `recomputed`.
    cases : tuple of Case
        What is right where something else holds, in the row's unit.
    """

    item: str
    unit: str
    as_printed: str
    printed: float
    recomputed: float
    residual: float
    steps: tuple[Step, ...]
    alternatives: tuple[Step, ...]
    right: float | None
    why: str
    uncertainty: Uncertainty | None = None
    cases: tuple[Case, ...] = ()

    @property
    def left(self) -> float:
        """Residual after the last step."""
        return self.steps[-1].residual if self.steps else self.residual


def explain(
    item: str,
    unit: str,
    printed: str,
    formula: Callable[[Inputs], float],
    effects: Sequence[Cause] = (),
    alternatives: Sequence[Cause] = (),
    *,
    right: float | None,
    why: str,
    uncertainty: Uncertainty | None = None,
    cases: Mapping[str, float] | None = None,
) -> Row:
    """Run a formula bare, with each effect added in turn, and with each alternative alone.

    Examples
    --------
    >>> row = explain(
    ...     "root diameter over 7", "mm", "8.61", lambda paper: (12 - 2.5) * paper.module / 7, [cut(2)], right=None, why="an example"
    ... )
    >>> round(row.residual, 4), [round(step.residual, 4) for step in row.steps]
    (0.0079, [0.0])
    """
    recomputed, target = formula(Inputs()), float(printed)
    steps, inputs, writers = [], Inputs(), []
    for effect in effects:
        inputs = effect.change(inputs)
        writers.append(effect.write)
        value = formula(inputs)
        for write in writers:
            value = write(value)
        steps.append(Step(effect.name, value - target))
    tried = tuple(Step(e.name, e.write(formula(e.change(Inputs()))) - target) for e in alternatives)
    held = tuple(Case(where, value) for where, value in (cases or {}).items())
    return Row(
        item, unit, as_printed=printed, printed=target, recomputed=recomputed, residual=recomputed - target, steps=tuple(steps),
        alternatives=tried, right=right, why=why, uncertainty=uncertainty, cases=held,
    )  # fmt: skip


def cut(decimals: int) -> Cause:
    """Digits after `decimals` left off, towards zero."""
    return Cause(f"cut off after {_places(decimals)}", write=lambda value: quantised(value, decimals, ROUND_DOWN))


def rounded(decimals: int) -> Cause:
    """Rounded, halves up."""
    return Cause(f"rounded to {_places(decimals)}", write=lambda value: quantised(value, decimals, ROUND_HALF_UP))


def changed(name: str, **values: object) -> Cause:
    """An effect that puts other values into `Inputs`."""
    return Cause(name, change=lambda inputs: replace(inputs, **values))  # type: ignore[arg-type]


def quantised(value: float, decimals: int, rounding: str) -> float:
    """`value` with so many decimals; the float's own noise is taken off first, so that 44.45 counts as 44.45.

    >>> quantised(44.45, 1, ROUND_HALF_UP)
    44.5
    """
    return float(Decimal(repr(round(value, 9))).quantize(Decimal(1).scaleb(-decimals), rounding=rounding))


def _places(decimals: int) -> str:
    return {0: "a whole number", 1: "one decimal"}.get(decimals, f"{decimals} decimals")
