"""What is said of the thickness of a tooth, and of the thinnest and the most worn of the gear."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum


class Wider(StrEnum):
    """What makes the interval of the least thickness wider than its standard deviation says, in words beside a number, without a comma."""

    HOLLOW = "a hollow may be deeper"
    PITS = "pits may be deeper"
    FEW = "teeth measured in few sections"
    EITHER = "made so or scanned so"
    SEAM = "pitch errors or a drift of the scan"


@dataclass(frozen=True, slots=True)
class ToothSummary:
    """Thickness of one tooth.

    Parameters
    ----------
    tooth : int
        0-based.
    nominal, mean, least : float
        Arc in mm; nan where the tooth was not seen on both sides.
    greatest_loss : float
        As-made − measured where it is greatest, mm.
    at_z : float
        Height of the least, mm.
    std : float
        Standard deviation of one section's arc, mm.
    least_std, loss_std : float
        Standard deviations of the least and of the greatest loss, mm.
    """

    tooth: int
    nominal: float
    mean: float
    least: float
    greatest_loss: float
    at_z: float
    std: float
    least_std: float = math.nan
    loss_std: float = math.nan

    @property
    def seen(self) -> bool:
        return math.isfinite(self.mean)


@dataclass(frozen=True, slots=True)
class ThinnestTooth:
    """The least thickness of the gear.

    Parameters
    ----------
    tooth : int
        0-based; the likeliest where several are about as thin.
    value, std : float
        Least true arc of all teeth, mm. Looking for the least of many noisy values finds one that is too small: that bias is taken off.
    low, high : float
        95 % interval, mm.
    at_z : float
        Height on that tooth, mm.
    nominal : float
        Arc as drawn there, mm.
    wider : Wider or None
        What makes the interval most wider than `std` says; None: nothing.
    """

    tooth: int
    value: float
    std: float
    low: float
    high: float
    at_z: float
    nominal: float
    wider: Wider | None = None


@dataclass(frozen=True, slots=True)
class UnmeasuredTeeth:
    """Teeth that few sections measured.

    Parameters
    ----------
    teeth : tuple of ThinnestTooth
        Each where it is thinnest.
    least : ThinnestTooth
        The thinnest of them.
    """

    teeth: tuple[ThinnestTooth, ...]
    least: ThinnestTooth


@dataclass(frozen=True, slots=True)
class DriftSeam:
    """The tooth that the seam of a drift goes through, where what is told as pitch errors may be a drift of the scan.

    Parameters
    ----------
    tooth : int
        0-based.
    thicker : float
        By how much it is thicker then than it is told, mm of arc; − thinner.
    low, high : float
        95 % interval of the least thickness of the gear then, mm; ∞ and −∞ where another tooth is the thinnest either way.
    """

    tooth: int
    thicker: float
    low: float = math.inf
    high: float = -math.inf

    @property
    def of_thinnest(self) -> bool:
        """Whether the least thickness of the gear depends on it."""
        return self.low <= self.high


@dataclass(frozen=True, slots=True)
class MostLost:
    """The greatest loss of thickness of the gear, without the bias of having looked for it among many noisy ones.

    Parameters
    ----------
    tooth : int
        0-based; the likeliest where several have lost about as much.
    value, std : float
        As-made − measured arc, mm.
    at_z : float
        Height on that tooth, mm.
    """

    tooth: int
    value: float
    std: float
    at_z: float
