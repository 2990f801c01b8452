"""What of a pair is worn, for a meshing study: a uniform loss, or one or both gears as they were measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from numbers import Integral
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.files.profiles import read_profiles
from gearwear.design.files.traces import read_traces
from gearwear.design.gear import Gear
from gearwear.design.given import check_number
from gearwear.design.pair import Design
from gearwear.design.profiles import SectionLoss, ToothProfiles
from gearwear.design.quantity import as_given, at_most, shown, teeth_words
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.slices import on_face_of

Measured = Path | str | ToothProfiles
"""A gear as it is: the folder that `compare` wrote to, its ``worn_profiles.npz``, traces of a measuring machine as CSV, or profiles."""


@dataclass(frozen=True, slots=True)
class WornGear:
    """What of the pair is worn, for a meshing study.

    Parameters
    ----------
    part : str or None
        "pinion" or "gear"; None where both are as designed.
    source : str
        The file, or what was assumed, in words.
    loss : float
        Greatest loss of tooth thickness from what is drawn, mm of arc at the reference circle; turned there from the flank's nearest end where
        that circle lies off the flank.
    tooth : int or None
        The tooth that has it, counted from 0; None where none has, or all that are worn have it.
    z : float or None
        Height at which it has it, mm; None likewise.
    """

    part: str | None
    source: str
    loss: float
    tooth: int | None = None
    z: float | None = None


def each_measured(wear: Measured | Sequence[Measured] | None) -> tuple[Measured, ...]:
    """What was given as measured: none, one, or both gears; InputError for what is neither a path nor profiles."""
    if wear is None:
        return ()
    each = (wear,) if isinstance(wear, Path | str | ToothProfiles) or not isinstance(wear, Iterable) else tuple(wear)
    for given in each:
        if not isinstance(given, Path | str | ToothProfiles):
            raise InputError(f"wear = {shown(given)}: a path or profiles, or one of either gear, would be right")
    return each


def as_measured(design: Design, wear: Sequence[Measured]) -> list[tuple[WornGear, ToothProfiles]]:
    """The measured gears of a pair, in the order given.

    Raises
    ------
    InputError
        If one cannot be read, is of no gear of the design, or two are of the same gear.
    """
    gears = [_read(design, measured) for measured in wear]
    parts = [worn.part for worn, _ in gears]
    for at, (worn, _) in enumerate(gears):
        if worn.part in parts[:at]:
            raise InputError(
                f"{worn.source.partition(', ')[2]}: is the {worn.part}, and so is what was given before it; one of each gear would be right"
            )
    return gears


def in_same_slices(pinion: ToothProfiles, gear: ToothProfiles) -> ToothProfiles:
    """The pinion of a spur pair in the sections of whichever gear has more: contact is looked for in the pinion's."""
    if pinion.gear.twist != 0.0 or len(pinion.z) >= len(gear.z):
        return pinion
    z = on_face_of(pinion.gear, gear.z, gear.gear)
    return replace(pinion, z=z, half_angle=pinion.at_heights(z))


def uniform_loss(
    nominal: ToothProfiles, part: str, loss: float, teeth: int | Sequence[int] | None, side: Side
) -> tuple[WornGear, ToothProfiles]:
    """A uniform loss on some teeth, counted from 1, or on all where None is given, and the profiles with it."""
    gear = nominal.gear
    check_number("loss", loss, "mm")
    if not 0.0 < loss < math.inf:
        raise InputError(f"loss {loss:g} mm: must be above 0")
    some = range(1, gear.teeth + 1) if teeth is None else teeth
    asked = list(some) if isinstance(some, Iterable) else [some]
    if not asked or not all(is_tooth(tooth, gear) for tooth in asked):
        which = ", ".join(map(str, asked)) or "that are none"
        raise InputError(f"teeth {which}: the {part} has teeth from 1 to {gear.teeth}, and whole numbers of them would be right")
    chosen = sorted({int(tooth) for tooth in asked})
    half_angle = nominal.half_angle.copy()
    half_angle[np.array(chosen) - 1, side.index] -= loss / gear.normal_lever
    if not (half_angle.sum(axis=1) > 0.0).all():
        land = gear.base_radius * gear.base_helix_cosine * float(nominal.half_angle.sum(axis=1).min())
        raise InputError(
            f"loss {as_given(loss)} mm: must be below {at_most(land)} mm, what the tooth has to lose at its tip before it gets shorter"
        )
    words = f"{loss:g} mm off the {side} flank of {teeth_words(chosen, gear.teeth)} of the {part}"
    arc = loss * gear.reference_radius / gear.normal_lever
    return WornGear(part, words, arc), replace(nominal, half_angle=half_angle)


def is_tooth(tooth: object, gear: Gear) -> bool:
    """Whether it is the number of a tooth of a gear, counted from 1."""
    return isinstance(tooth, Integral) and not isinstance(tooth, bool) and 1 <= int(tooth) <= gear.teeth


def _read(design: Design, wear: Measured) -> tuple[WornGear, ToothProfiles]:
    """A measured gear and its profiles."""
    if isinstance(wear, ToothProfiles):
        named = [name for name, gear in design.gears.items() if gear == wear.gear]
        if not named:
            raise InputError(f"the profiles are of a gear of {wear.gear.teeth} teeth that the design does not have")
        part, profiles, source = named[0], wear, "profiles given"
    else:
        reader = read_traces if Path(wear).suffix.lower() == ".csv" else read_profiles
        part, profiles = reader(Path(wear), design)
        source = str(wear)
    words, most = f"{part} as measured, {source}", _most_lost(profiles) if profiles.lost is None else profiles.lost
    if most.value <= 0.0:
        return WornGear(part, words, 0.0), profiles
    return WornGear(part, words, most.value, most.tooth, most.z), profiles


def _most_lost(profiles: ToothProfiles) -> SectionLoss:
    """Where the profiles themselves have lost most thickness."""
    lost = _lost_thickness(profiles)
    tooth, slice_ = np.unravel_index(int(lost.argmax()), lost.shape)
    return SectionLoss(float(lost.max()), int(tooth), float(profiles.z[slice_]))


def _lost_thickness(profiles: ToothProfiles) -> Floats:
    """(teeth, n_z) what teeth are thinner than drawn in each section, mm of arc at the reference circle."""
    gear, known = profiles.gear, profiles.radius
    low, high = sorted((gear.form_radius, gear.flank_end_radius))
    radius = float(np.clip(gear.reference_radius, max(low, known[0]), min(high, known[-1])))
    drawn = replace(profiles, half_angle=gear.half_angles(known, profiles.z)[None])  # between the same radii
    return (drawn.thickness(radius) - profiles.thickness(radius)) * (gear.reference_radius / radius)
