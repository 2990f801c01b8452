"""The tooth's thickness as most drawings state it: a span over teeth, or a dimension over pins."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.conformity import Conformity, conformity, worst
from gearwear.design.involute import involute_function
from gearwear.design.quantity import as_given, outside
from gearwear.design.standards import MM_PER_INCH
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.design.spec import GearSpec

USUAL_THINNING = (-0.02, 0.1)
"""Modules by which teeth are cut thinner for backlash; what lies outside of it is rather another profile shift."""

KEPT = {Conformity.CONFORMING: "kept", Conformity.NOT_CONFORMING: "not kept", Conformity.NEITHER: "neither proven"}
"""Of the limits of a drawing, in words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnGauge:
    """A span over teeth or a dimension over pins of a drawing, from one limit to the other.

    Parameters
    ----------
    low, high : float
        Its limits, mm; alike where the drawing gives one value.
    teeth : int or None
        Teeth spanned, k; None of pins.
    pin_diameter : float or None
        Of the pins, or the balls of a helical gear, mm; None of a span.
    """

    low: float
    high: float
    teeth: int | None = None
    pin_diameter: float | None = None

    @property
    def words(self) -> str:
        """As a message writes it."""
        limits = as_given(self.low) if self.low == self.high else f"[{as_given(self.low)}, {as_given(self.high)}]"
        if self.pin_diameter is None:
            return f"span = {limits} mm over {self.teeth} teeth"
        return f"over_pins = {limits} mm with pins of {as_given(self.pin_diameter)} mm"

    def kept(self, values: Floats, expanded: Floats) -> str:
        """Whether measured dimensions keep the limits (ISO 14253-1).

        Parameters
        ----------
        values, expanded : (n,) float
            Dimensions round the gear and their U, mm; nan where not seen.

        Returns
        -------
        str
            "kept" where all lie within the limits with their U, "not kept" where one lies outside by more than that, else "neither proven"; "" where
            the drawing has one value, or nothing was seen.
        """
        if self.low == self.high:
            return ""
        seen = np.isfinite(values + expanded)
        state = worst(
            each
            for low, high in zip((values - expanded)[seen].tolist(), (values + expanded)[seen].tolist(), strict=True)
            for each in (conformity(low, high, self.high), conformity(-high, -low, -self.low))
        )
        return "" if state is None else KEPT[state]

    def thinning(self, spec: GearSpec) -> tuple[float, float]:
        """Thinning that the drawing means, and half of what its limits leave of it.

        Parameters
        ----------
        spec : GearSpec
            Of the gear; its own thinning does not count.

        Returns
        -------
        thinning, tolerance : float
            Of the normal arc at the reference circle, mm.

        Raises
        ------
        InputError
            If no tooth of this gear has such a dimension.

        Notes
        -----
        Of flanks without modifications, ``W_k = m_n cos α_n (π (k − ½) + z inv α_t) + 2 x m_n sin α_n − E cos α_n``. Over pins
        ``M = 2 R cos(90° / z) + ι D``, with the cosine for odd z alone and ι = −1 of a ring; ``cos α_M = r_b / R`` and ``ι inv α_M = D / (2 r_b cos β_b) + ψ_b − π / z``. From the
        half angle ψ_b at the base circle the thickness at the reference circle is ``s_t = 2 r (ψ_b − ι inv α_t)``, and
        ``E = π m_n / 2 + 2 x m_n tan α_n − s_t cos β`` (ISO 21771).
        """
        if self.pin_diameter is None and not 0 < (self.teeth or 0) < spec.teeth:
            raise InputError(f"[{spec.name}] span_teeth = {self.teeth}: a whole number from 1 to {spec.teeth - 1} would be right")
        arcs = [self._thinning(length, spec) for length in (self.low, self.high)]
        middle, half = 0.5 * (arcs[0] + arcs[1]), 0.5 * abs(arcs[1] - arcs[0])
        if not abs(middle) <= spec.normal_module:
            raise InputError(f"[{spec.name}] {self.words}: {self._fault(middle, spec)}")
        return middle, half

    def _thinning(self, length: float, spec: GearSpec) -> float:
        """E of one value (mm), mm; nan where no pin of a tooth has it."""
        m, angle, z, side = spec.normal_module, spec.normal_pressure_angle, spec.teeth, spec.orientation
        transverse = math.atan(math.tan(angle) / math.cos(spec.helix_angle))
        involute = involute_function(transverse)
        plain = 0.5 * math.pi * m + 2.0 * spec.profile_shift * m * math.tan(angle)
        if self.pin_diameter is None:
            return ((self.teeth or 0) - 1) * math.pi * m + plain + z * m * involute - length / math.cos(angle)
        radius = 0.5 * m * z / math.cos(spec.helix_angle)
        base = radius * math.cos(transverse)
        lean = math.cos(math.asin(math.sin(spec.helix_angle) * math.cos(angle)))  # cos β_b
        odd = math.cos(0.5 * math.pi / z) if z % 2 else 1.0
        centre = (length - side * self.pin_diameter) / (2.0 * odd)
        if not centre >= base:
            return math.nan
        half = side * involute_function(math.acos(base / centre)) - self.pin_diameter / (2.0 * base * lean) + math.pi / z
        return plain - 2.0 * radius * (half - side * involute) * math.cos(spec.helix_angle)

    def _fault(self, thinning: float, spec: GearSpec) -> str:
        """That no tooth has this dimension, and what would be right: another number of teeth, or inches."""
        middle = 0.5 * (self.low + self.high)
        for length in (middle, MM_PER_INCH * middle):
            for k in range(1, spec.teeth) if self.pin_diameter is None else (None,):
                if _is_usual(replace(self, teeth=k)._thinning(length, spec), spec):
                    fits = f"{length:.6g} mm" if k is None else f"{length:.6g} mm over {k} teeth"
                    return f"cannot be that of this gear; {'in inches, ' if length != middle else ''}{fits} could"
        off = (
            "no tooth has it"
            if math.isnan(thinning)
            else f"thinning = {outside(thinning / spec.normal_module, -1.0, 1.0)} modules: must lie from -1 to 1"
        )
        return f"{off}; check module, teeth and profile_shift too"


def shift_instead(spec: GearSpec) -> str:
    """That the thinning by a drawn gauge is rather another profile shift; nothing where it is a usual one."""
    if spec.gauge is None or _is_usual(spec.thinning, spec):
        return ""
    right = f"{shift_of(spec, -spec.thinning):.3f}".replace("-", "−")
    stated = f"{spec.profile_shift:.6g}".replace("-", "−")
    return (
        f"the {spec.name}'s {spec.gauge.words} means teeth {abs(spec.thinning):.3f} mm {'thinner' if spec.thinning > 0.0 else 'thicker'} than profile_shift = "
        f"{stated} makes them; is it a profile shift of {right}? Tip and root would lie elsewhere"
    )


def shift_of(spec: GearSpec, thicker: float) -> float:
    """The profile shift that makes teeth thicker by so much (mm of normal arc at the reference circle): by 2 Δx m_n tan α_n."""
    return spec.profile_shift + thicker / (2.0 * spec.normal_module * math.tan(spec.normal_pressure_angle))


def _is_usual(thinning: float, spec: GearSpec) -> bool:
    """Whether teeth are cut thinner by that much (mm) for backlash; False for nan."""
    least, most = USUAL_THINNING
    return least * spec.normal_module <= thinning <= most * spec.normal_module
