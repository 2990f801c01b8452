"""Evaluation ranges and cut-off wavelengths of ISO 1328-1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.inspection.tolerances import Edition

LEAST_CUTOFF = 0.25
"""Least cut-off wavelength, mm (unconfirmed: docs/limits.md)."""

BINS_PER_CUTOFF = 8
"""Bins of a trace per cut-off wavelength; their width takes 2.6 % off a wave at the cut-off."""


@dataclass(frozen=True, slots=True)
class Range:
    """Where a trace is evaluated and how it is filtered, mm.

    Parameters
    ----------
    start, end : float
        Evaluation range: places of a profile (`profile_place`), z of a helix.
    outer : float
        Between `end` and here only too much material counts (profile: the end of the flank at the tip); `end` where there is
        no such zone.
    cutoff : float
        Cut-off wavelength λ of the Gauss filter.
    over : float or None
        Length that the slope is stated over; None: that of the range.
    """

    start: float
    end: float
    outer: float
    cutoff: float
    over: float | None = None

    def __post_init__(self) -> None:
        if not self.end > self.start:
            raise InputError(f"the evaluation range from {self.start:g} to {self.end:g} mm is empty: a higher end would be right")

    @property
    def stated(self) -> float:
        """Length that the slope is stated over, mm."""
        return self.length if self.over is None else self.over

    @property
    def length(self) -> float:
        return self.end - self.start

    @property
    def ends(self) -> tuple[float, float]:
        return self.start, self.end

    @property
    def middle(self) -> float:
        return 0.5 * (self.start + self.end)

    def from_middle(self, places: Floats) -> Floats:
        """How far places lie from the middle: −1 at the start, 1 at the end."""
        return np.asarray(2.0 * (places - self.middle) / self.length, dtype=np.float64)

    @property
    def bin_width(self) -> float:
        """Width of a trace's bins, mm, as near as whole bins fit."""
        return self.cutoff / BINS_PER_CUTOFF

    @property
    def gap(self) -> float:
        """A hole wider than this, mm, is never bridged: the cut-off or 5 % of the range, whichever is more (see also `THIN`)."""
        return max(self.cutoff, 0.05 * self.length)


def profile_place(gear: Gear, roll: float) -> float:
    """Place of a roll length L (mm) along a profile: L, on a ring −L, so that places rise from root to tip on either."""
    return gear.orientation * roll


def profile_ends(gear: Gear) -> tuple[float, float]:
    """Places of form circle and flank's end along a profile, mm."""
    return profile_place(gear, gear.form_roll), profile_place(gear, gear.tip_roll)


def profile_places(gear: Gear, rolls: tuple[float, float] | None) -> tuple[float, float] | None:
    """Places along the profile of a stretch from L to L, the lower first."""
    if rolls is None:
        return None
    first, last = sorted(profile_place(gear, roll) for roll in rolls)
    return first, last


def profile_range(
    gear: Gear,
    edition: Edition = Edition.ISO_2013,
    start: float | None = None,
    end: float | None = None,
    cutoff: float | None = None,
    over: float | None = None,
) -> Range:
    """Evaluation range of the profile.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    edition : Edition
        2013: L_α is 95 % of the roll length from the profile control circle to the end of the flank, cut-off L_α / 30, at least
        0.25 mm. 1995: 92 %; it names no filter, the same rule is used. (Unconfirmed: docs/limits.md.)
    start : float or None
        Place (`profile_place`) of the profile control circle, mm; None: the form circle. In a pair, the start of active profile.
    end : float or None
        Place where the evaluation ends, mm; None: by the edition. Beyond a stated end nothing counts.
    cutoff, over : float or None
        Cut-off, and length the slope is stated over, mm; None: by the edition, and the evaluation range.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.25))
    >>> r = profile_range(pinion)
    >>> round(r.length, 2), round(r.cutoff, 3)
    (22.12, 0.737)
    """
    form, tip = profile_ends(gear)
    first = form if start is None else start
    length = (0.95 if edition is Edition.ISO_2013 else 0.92) * (tip - first)
    last, outer = (first + length, tip) if end is None else (end, end)
    return Range(first, last, outer, cutoff or max(LEAST_CUTOFF, (last - first) / 30.0), over)


def helix_range(gear: Gear, between: tuple[float, float] | None = None, cutoff: float | None = None) -> Range:
    """Evaluation range of the helix: the face between its chamfers or roundings less 5 % of its width or one module, whichever is less, at
    each end (both editions; the 5 % agree with a published measurement); cut-off L_β / 30, at least 0.25 mm. (The module and the
    cut-off are unconfirmed: docs/limits.md.) Or `between` these z, with
    this `cutoff`, mm.

    >>> from gearwear.design import GearSpec
    >>> r = helix_range(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0)))
    >>> round(r.length, 6), round(r.cutoff, 3)
    (13.5, 0.45)
    """
    low, high = map(max, gear.spec.end_edges)
    less = min(0.05 * (gear.face_width - (low + high)), gear.normal_module)
    start, end = between or (low + less, gear.face_width - (high + less))
    return Range(start, end, end, cutoff or max(LEAST_CUTOFF, (end - start) / 30.0))
