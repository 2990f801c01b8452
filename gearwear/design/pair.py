"""A design: one gear, or a pinion and a gear in mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.gear import Gear
from gearwear.design.spec import PairSpec
from gearwear.errors import InputError


@dataclass(frozen=True, slots=True)
class Design:
    """What was drawn: a gear alone, or a pair.

    Parameters
    ----------
    gears : dict of str to Gear
        By part name: "pinion", "gear" or both.
    pair : PairSpec or None
        None where there is no mate.
    warnings : tuple of str
        What is legal but worth knowing, each with its numbers.
    source : str
        File the design was read from.
    """

    gears: dict[str, Gear]
    pair: PairSpec | None = None
    warnings: tuple[str, ...] = ()
    source: str = ""

    @property
    def centre_distance(self) -> float:
        """Working centre distance in mm; the standard one where none is given."""
        if self.pair is None:
            raise ValueError("a design of one gear has no centre distance")
        if self.pair.centre_distance is not None:
            return self.pair.centre_distance
        return sum(gear.reference_radius for gear in self.gears.values())

    def mate_of(self, part: str) -> Gear | None:
        """The other gear of the pair, or None."""
        return next((gear for name, gear in self.gears.items() if name != part), None)


def check_pair(pinion: Gear, gear: Gear, pair: PairSpec) -> tuple[str, ...]:
    """Refuse a pair that cannot be mounted; return what is legal but worth knowing.

    Parameters
    ----------
    pinion, gear : Gear
        The two gears.
    pair : PairSpec
        How they are mounted.

    Returns
    -------
    tuple of str
        Warnings, each with its numbers.

    Raises
    ------
    InputError
        If the base pitches differ, the base circles meet, tips bottom out, teeth jam, or the path of contact
        is empty.
    """
    p, g = pinion.spec, gear.spec
    if abs(pinion.base_pitch - gear.base_pitch) > 1e-9 * pinion.base_pitch:
        raise InputError(
            f"[gear] module {g.normal_module:g} mm and pressure angle {math.degrees(g.normal_pressure_angle):g}° do not mesh with the pinion's {p.normal_module:g} mm and {math.degrees(p.normal_pressure_angle):g}°: base pitches {gear.base_pitch:.6f} and {pinion.base_pitch:.6f} mm must be equal"
        )
    standard = pinion.reference_radius + gear.reference_radius
    centre = standard if pair.centre_distance is None else pair.centre_distance
    bases = pinion.base_radius + gear.base_radius
    if not centre > bases:
        raise InputError(f"[pair] centre_distance = {centre:g} mm: must be above the sum of the base radii, {bases:.4f} mm")
    for part, tip, root in (("pinion", pinion.tip_radius, gear.root_radius), ("gear", gear.tip_radius, pinion.root_radius)):
        clearance = centre - tip - root
        if clearance < 0.0:
            raise InputError(
                f"[pair] centre_distance = {centre:g} mm: the {part}'s tip digs {-clearance:.4f} mm into its mate's root; at least {tip + root:.4f} mm is needed"
            )

    working = math.acos(min(1.0, bases / centre))
    line = centre * math.sin(working)
    play = (
        centre
        / standard
        * (
            math.pi * 2 * standard / (pinion.teeth + gear.teeth)
            - pinion.tooth_thickness
            - gear.tooth_thickness
            + 2
            * standard
            * ((math.tan(working) - working) - (math.tan(pinion.transverse_pressure_angle) - pinion.transverse_pressure_angle))
        )
    )
    if play < -1e-9 * standard:
        raise InputError(
            f"[pair] centre_distance = {centre:g} mm: the teeth jam, backlash would be {play:.4f} mm; a larger centre distance, less profile_shift or more thinning is needed"
        )
    start = max(pinion.form_roll, line - gear.tip_roll)
    end = min(pinion.tip_roll, line - gear.form_roll)
    if end <= start:
        raise InputError(
            f"[pair] centre_distance = {centre:g} mm: the gears do not reach each other, the path of contact is empty"
        )

    warnings = []
    ratio = (end - start) / pinion.base_pitch
    if ratio < 1.0:
        warnings.append(f"contact ratio {ratio:.3f} is below 1: the drive is not continuous")
    for part, own, mate in (("pinion", pinion, gear), ("gear", gear, pinion)):
        past = mate.tip_roll - line
        if past > 0.0:
            largest = math.hypot(mate.base_radius, line)
            if not own.undercut:
                raise InputError(
                    f"[pair] interference: the mate's tip (radius {mate.tip_radius:.4f} mm) passes the {part}'s interference point by {past:.4f} mm of roll and the {part} is not undercut; tip radius at most {largest:.4f} mm"
                )
            warnings.append(
                f"the mate's tip passes the {part}'s interference point by {past:.3f} mm of roll (no interference up to tip radius {largest:.3f} mm); the {part} is undercut and clears it, but the path of contact ends at its form circle"
            )
        elif line - mate.tip_roll < own.form_roll - 1e-9:
            warnings.append(
                f"the mate's tip reaches below the {part}'s form circle (radius {own.form_radius:.4f} mm): contact there is not conjugate"
            )
    return tuple(warnings)
