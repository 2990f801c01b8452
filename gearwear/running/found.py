"""What the second closed loop found, with the error before and after each effect."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow, measured
from gearwear.design.quantity import pretty_unit
from gearwear.diagnose.parameter import ParameterEstimate
from gearwear.running.conditions import Conditions
from gearwear.running.effects.base import RunningEffect
from gearwear.running.wear_map import WearMap


@dataclass(frozen=True, slots=True)
class Errors:
    """Root mean square of what a model leaves of the mean depths of a map, mm; nan where it could not be asked.

    Parameters
    ----------
    all : float
        On all places, fitted to all.
    teeth : float
        On the teeth of one half, fitted to those of the other, both ways.
    face : float
        On each third of the face, fitted to the other two.
    double_contact : float
        Where two pairs touch, fitted to where one does.
    """

    all: float
    teeth: float
    face: float
    double_contact: float

    @property
    def held_out(self) -> float:
        """Of all three kinds of leaving out together, as far as they could be asked, mm."""
        known = [error**2 for error in (self.teeth, self.face, self.double_contact) if math.isfinite(error)]
        return math.sqrt(sum(known) / len(known)) if known else math.nan


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class FoundRunning(Card):
    """An effect of running that was added.

    Parameters
    ----------
    effect : RunningEffect
    parameters : dict of str to ParameterEstimate
    alternatives : tuple of str
        What the data cannot tell from it.
    before, after : Errors
        Of an effect round the gear: of the teeth's mean depths or leans; held out is one tooth at a time.
    gain : float
        How much less χ² is.
    degrees : (int, float)
        Degrees of freedom: of the effect; of what it is compared with, inf where that is known.
    p_value : float
    """

    effect: RunningEffect
    parameters: dict[str, ParameterEstimate]
    alternatives: tuple[str, ...]
    before: Errors
    after: Errors
    gain: float
    degrees: tuple[int, float]
    p_value: float

    @property
    def name(self) -> str:
        return self.effect.name

    def headline(self) -> str:
        return f"{self.name}, RMS {1e3 * self.before.all:.2f} → {1e3 * self.after.all:.2f} µm, on teeth left out {1e3 * self.before.teeth:.2f} → {1e3 * self.after.teeth:.2f} µm"

    def rows(self) -> list[CardRow]:
        rows: list[CardRow] = []
        for name, item in self.parameters.items():
            if isinstance(item.value, float) and isinstance(item.std, float):
                rows.append((name.removesuffix(f"_{item.unit}"), measured(item.value, item.std, pretty_unit(item.unit))))
        return rows + ([("not told from", ", ".join(self.alternatives))] if self.alternatives else [])


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class SecondLoop(Card):
    """From the pattern of the wear to how the pair ran.

    Parameters
    ----------
    map : WearMap
        What was explained.
    effects : tuple of FoundRunning
        In the order added; empty where the law alone does as well.
    before, after : Errors
        Of the law alone, and with all effects of a run.
    law, depth : (m,) float
        Depths at the places of the map by the law, and with all effects, mm.
    amount : float
        k w N, mm.
    chi_square : float
        Of what is left, by all errors.
    conditions : Conditions
        As fitted, with effects too whose size does not stand out and which are not named; the usual ones where the law stands.
    """

    map: WearMap
    effects: tuple[FoundRunning, ...]
    before: Errors
    after: Errors
    law: Floats
    depth: Floats
    amount: float
    chi_square: float
    conditions: Conditions

    def effect(self, name: str) -> FoundRunning | None:
        """One of the effects by its name."""
        return next((effect for effect in self.effects if effect.name == name), None)

    def headline(self) -> str:
        names = ", ".join(effect.name for effect in self.effects) or "no effect beside the law"
        return f"{names}; RMS {1e3 * self.before.all:.2f} → {1e3 * self.after.all:.2f} µm on {len(self.map.teeth)} {self.map.side} flanks"

    def rows(self) -> list[CardRow]:
        return [(effect.name, effect.headline()) for effect in self.effects]
