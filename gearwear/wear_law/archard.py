"""Archard's wear law along a flank.

A point of the flank is watched while the mate's contact passes over it (single point observation: Andersson; Flodin
& Andersson, Wear 1997 and 2000). In one cycle it loses k · p̄ · s, with the mean pressure p̄ and the distance s slid
over it; the Hertzian width cancels, and what is left is exactly ::

    depth per cycle = k · w · |K|

with the load per face width w (N/mm) and the specific sliding K of that flank. On helical teeth the load per length of line is less by
cos β_b and the way along the profile across the Hertzian band longer by as much: with the normal tooth force it is the same. The coefficient k of lubricated steel
gears spans four decades and scatters by half in one rig, so there is no default: nothing is predicted from it, it is
only fitted (`fit`). Where no pair touches, off the path of contact, nothing slides and the law has no wear.
"""

from __future__ import annotations

import math
from enum import StrEnum

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.quantity import at_least
from gearwear.errors import InputError
from gearwear.meshing.path import PathOfContact, path_of_contact, sliding

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
    LINES = "lines"
    """Of helical teeth: evenly over the length of all contact lines, averaged over the face; without overlap it would be `HALVES`."""

    @classmethod
    def of(cls, gear: Gear) -> tuple[LoadSharing, ...]:
        """The models for a gear: contact lines of helical teeth lean over the flank, and no place of a profile is in single contact."""
        return (cls.NONE, cls.LINES) if gear.twist != 0.0 else (cls.NONE, cls.HALVES, cls.THIRDS)


_NODES = 8
"""Places at which the law is averaged over a stretch of the profile."""
LINE_STEPS = 200
"""Places across the face at which the length of the contact lines is taken."""


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
        From 0 (outside the path of contact) to 1; shares of the pairs in contact add up to 1, but for NONE. Of helical teeth the load per
        length of line over the load per face width, both in the transverse section.

    Raises
    ------
    InputError
        If the contact ratio of spur gears is 2 or more: these models know one and two pairs.
    """
    path = path_of_contact(gear, mate, centre_distance)
    if sharing is LoadSharing.LINES:
        return _over_lines(path, roll)
    if path.overlap_ratio == 0.0 and path.contact_ratio >= 2.0:
        raise InputError(f"contact ratio {at_least(path.contact_ratio, 3)}: load sharing is modelled below 2 only")
    start, end, pitch = path.start_pinion, path.end_pinion, path.base_pitch
    touched = (roll >= start) & (roll <= end)
    if sharing is LoadSharing.NONE:
        return touched.astype(np.float64)
    # Way into double contact, 0 at the border of single contact and 1 at the end of the path.
    double = max(end - start - pitch, 0.0)
    into = np.maximum(start + double - roll, roll - (end - double)) / max(double, 1e-300)
    shared = 0.5 if sharing is LoadSharing.HALVES else (2.0 - into) / 3.0
    return np.where(touched, np.where(into > 0.0, shared, 1.0), 0.0)


def _over_lines(path: PathOfContact, roll: Floats) -> Floats:
    """Face width over the length of all contact lines while one of them passes a place, averaged over the face.

    A line that crosses one end face at L crosses the other at L + ε_β p_bt; the lines lie p_bt apart. So their length, in face widths, is the
    share of such windows that lies on the path.
    """
    start, end, pitch, wide = path.start_pinion, path.end_pinion, path.base_pitch, path.overlap_ratio * path.base_pitch
    across = wide * (np.arange(LINE_STEPS) + 0.5) / LINE_STEPS
    first = np.atleast_1d(roll)[:, None] - across  # where the line through the place crosses the end face
    others = np.arange(math.floor(-(end - start + wide) / pitch), math.ceil((end - start + wide) / pitch) + 1) * pitch
    low = np.clip(first[..., None] + others, start, end)
    high = np.clip(first[..., None] + others + wide, start, end)
    length = (high - low).sum(axis=-1) / wide
    touched = (roll >= start) & (roll <= end)
    share = np.where(length > 0.0, 1.0 / np.maximum(length, 1e-12), 0.0).mean(axis=1)
    return np.where(touched, share, 0.0)


def specific_sliding(gear: Gear, mate: Gear, centre_distance: float, roll: Floats) -> Floats:
    """|K| on the flank of `gear` at lengths of roll in mm: the distance slid over what the contact rolls on over its flank."""
    return np.abs(sliding(gear, mate, centre_distance, roll).specific_pinion)


def law_terms(gear: Gear, mate: Gear, centre_distance: float, roll: Floats, sharing: LoadSharing) -> Floats:
    """The terms of ``A · share · |K| + B + C · [one pair carries alone]`` at coefficient 1, (n, 3), in the order of `TERMS`."""
    path = path_of_contact(gear, mate, centre_distance)
    low, high = path.single_contact_pinion if path.overlap_ratio == 0.0 else (math.inf, -math.inf)
    share = load_share(gear, mate, centre_distance, roll, sharing)
    alone = (roll > low) & (roll < high)
    return np.column_stack([share * specific_sliding(gear, mate, centre_distance, roll), np.ones_like(roll), alone])


def law_over(gear: Gear, mate: Gear, centre_distance: float, edges: Floats, sharing: LoadSharing) -> Floats:
    """`law_terms` in the mean over stretches of the profile between lengths of roll, (n, 2) mm: (n, 3).

    Equal arcs are equal steps of L². By the midpoint rule: sliding and sharing have kinks.
    """
    squares = edges**2
    places = np.sqrt(squares[:, :1] + np.diff(squares, axis=1) * (np.arange(_NODES) + 0.5) / _NODES)
    terms = law_terms(gear, mate, centre_distance, places.ravel(), sharing)
    return np.asarray(terms.reshape(*places.shape, len(TERMS)).mean(axis=1), dtype=np.float64)
