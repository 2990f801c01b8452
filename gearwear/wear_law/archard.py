"""Archard's wear law along a flank.

A point of the flank is watched while the mate's contact passes over it (single point observation: Andersson; Flodin
& Andersson, Wear 1997 and 2000). In one cycle it loses k · p̄ · s, with the mean pressure p̄ and the distance s slid
over it; the Hertzian width cancels, and what is left is exactly ::

    depth per cycle = k · w · |K|

with the load per face width w (N/mm) and the specific sliding K of that flank. The coefficient k of lubricated steel
gears spans four decades and scatters by half in one rig, so there is no default: nothing is predicted from it, it is
only fitted (`wear_fit`). Where no pair touches, off the path of contact, nothing slides and the law has no wear.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.meshing.path import path_of_contact, sliding

TERMS = ("sliding", "uniform", "step")
"""Terms of the law, in the order of the coefficients."""


class LoadSharing(StrEnum):
    """Share of the load that a pair carries while two pairs are in contact."""

    NONE = "none"
    """1: as if each pair carried all."""
    HALVES = "halves"
    """1/2; in single contact 1."""
    THIRDS = "thirds"
    """From 1/3 at the ends of the path to 2/3 at the border of single contact; there 1."""


def load_share(gear: Gear, mate: Gear, centre_distance: float, roll: Floats, sharing: LoadSharing) -> Floats:
    """Share of the load on the flank of `gear` at each length of roll.

    Parameters
    ----------
    gear, mate : Gear
        The pair; `gear` is the one whose flank is looked at.
    centre_distance : float
        mm.
    roll : (n,) float
        Length of roll on `gear`, mm.
    sharing : LoadSharing
        The model; rigid teeth have none of their own.

    Returns
    -------
    (n,) float
        From 0 (outside the path of contact) to 1; shares of the pairs in contact add up to 1, but for NONE.

    Raises
    ------
    InputError
        If the contact ratio is 2 or more: these models know one and two pairs.
    """
    path = path_of_contact(gear, mate, centre_distance)
    if path.contact_ratio >= 2.0:
        raise InputError(f"contact ratio {path.contact_ratio:.3f}: load sharing is modelled below 2 only")
    start, end, pitch = path.start_pinion, path.end_pinion, path.base_pitch
    touched = (roll >= start) & (roll <= end)
    if sharing is LoadSharing.NONE:
        return touched.astype(np.float64)
    # Way into double contact, 0 at the border of single contact and 1 at the end of the path.
    double = max(end - start - pitch, 0.0)
    into = np.maximum(start + double - roll, roll - (end - double)) / max(double, 1e-300)
    shared = 0.5 if sharing is LoadSharing.HALVES else (2.0 - into) / 3.0
    return np.where(touched, np.where(into > 0.0, shared, 1.0), 0.0)


def wear_per_cycle(
    gear: Gear,
    mate: Gear,
    centre_distance: float,
    roll: Floats,
    wear_coefficient: float,
    unit_load: float,
    sharing: LoadSharing = LoadSharing.NONE,
) -> Floats:
    """Depth lost per mesh cycle of `gear`: k w |K|, mm.

    Parameters
    ----------
    gear, mate, centre_distance, roll, sharing
        As for `load_share`.
    wear_coefficient : float
        k in mm²/N (1 m²/N is 1e6 mm²/N).
    unit_load : float
        Tooth force on all pairs per face width, N/mm.

    Returns
    -------
    (n,) float

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> [round(float(d), 10) for d in wear_per_cycle(pinion, gear, 114.3, np.array([5.0, 10.0, 16.0]), 1e-10, 100.0)]
    [2.41e-08, 4.5e-09, 2.8e-09]
    """
    share = load_share(gear, mate, centre_distance, roll, sharing)
    return wear_coefficient * unit_load * share * specific_sliding(gear, mate, centre_distance, roll)


def specific_sliding(gear: Gear, mate: Gear, centre_distance: float, roll: Floats) -> Floats:
    """|K| on the flank of `gear` at lengths of roll in mm: the distance slid over what the contact rolls on over its flank."""
    return np.abs(sliding(gear, mate, centre_distance, roll).specific_pinion)


def law_terms(gear: Gear, mate: Gear, centre_distance: float, roll: Floats, sharing: LoadSharing) -> Floats:
    """The terms of ``A · share · |K| + B + C · [one pair carries alone]`` at coefficient 1, (n, 3), in the order of `TERMS`."""
    low, high = path_of_contact(gear, mate, centre_distance).single_contact_pinion
    share = load_share(gear, mate, centre_distance, roll, sharing)
    alone = (roll > low) & (roll < high)
    return np.column_stack([share * specific_sliding(gear, mate, centre_distance, roll), np.ones_like(roll), alone])
