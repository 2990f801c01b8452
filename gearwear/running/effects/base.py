"""What an effect of running is: how a pair ran that the wear law does not know of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter
from gearwear.running.conditions import Conditions, Runs


class RunningEffect(ABC):
    """Everything about one effect of running.

    Attributes
    ----------
    name : str
        As reported.
    phrase : str
        Of the verdict, with the parameters in braces; "" where it is told otherwise.
    alternatives : tuple of str
        What the worn flanks of one gear can never tell it from.
    tells_apart : str
        The measurement that would.
    parameters : tuple of Parameter
    """

    name: ClassVar[str]
    phrase: ClassVar[str]
    alternatives: ClassVar[tuple[str, ...]] = ()
    tells_apart: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]] = ()


@dataclass(frozen=True)
class RunEffect(RunningEffect):
    """An effect that a run of elastic teeth is made with, of at most one size.

    Attributes
    ----------
    step : float
        Of its size, in inner units, between runs; in between, depths are linear. 0 for an effect without a size.
    least, most : float
        Bounds of its size.
    doubt : float
        Standard deviation of its size where it is not named: it may be there all the same, as far as the data let it.
    """

    step: ClassVar[float] = 0.0
    least: ClassVar[float] = 0.0
    most: ClassVar[float] = 0.0
    doubt: ClassVar[float] = 0.0

    def applies(self, runs: Runs) -> bool:
        """Whether this pair could have run so."""
        return True

    def starts(self, usual: Conditions) -> tuple[int, ...]:
        """Steps of its size from which to look for the best."""
        return (0,)

    @abstractmethod
    def applied(self, conditions: Conditions, size: float) -> Conditions:
        """The conditions with an effect of a size, as it is searched for."""

    def reported(self, conditions: Conditions) -> float:
        """Its size, as it is reported, in inner units."""
        raise NotImplementedError(f"{self.name} has no size")


@dataclass(frozen=True)
class RoundEffect(RunningEffect):
    """An effect of first order round the gear.

    Attributes
    ----------
    leans : bool
        Whether it is the lean of the wear across the face that goes round, and not its mean.
    """

    leans: ClassVar[bool] = False


@dataclass(frozen=True)
class OtherSideEffect(RunningEffect):
    """An effect that shows on the flanks of the other side: sliding wear there too (`gearwear.running.other_side`)."""


def conditions_of(effects: tuple[RunEffect, ...], sizes: tuple[float, ...], usual: Conditions | None = None) -> Conditions:
    """The conditions with some effects, each of its size, added to the usual ones."""
    result = Conditions() if usual is None else usual
    for effect, size in zip(effects, sizes, strict=True):
        result = effect.applied(result, size)
    return result
