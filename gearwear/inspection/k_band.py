"""K bands: limits of the user's own that a profile or helix trace must run between (K chart).

The band may be shifted along the deviation to where it suits the trace best; it is not turned. A band as wide as F_α all along the
evaluation range asks for what the total deviation asks for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.quantity import as_given
from gearwear.errors import InputError
from gearwear.inspection.estimate import RESOLVABLE_SHARE, Estimate
from gearwear.inspection.ranges import Range


class BandVerdict(StrEnum):
    """Whether a trace runs inside its band."""

    INSIDE = "inside"
    OUTSIDE = "outside"
    NOT_RESOLVABLE = "not resolvable"
    NOT_SEEN = "not seen"


@dataclass(frozen=True, slots=True)
class KBand:
    """Limits a trace must run between, wherever it lies as a whole.

    Parameters
    ----------
    station : tuple of float
        Places along the profile (`ranges.profile_place`) or z of the corners, mm, rising. Outside of them the trace is free.
    lower, upper : tuple of float
        Limits there, mm, + is more material; straight lines between the corners.

    Examples
    --------
    >>> KBand((3.0, 8.0, 26.0), (-0.03, -0.01, -0.01), (0.0, 0.01, 0.01)).width
    0.02
    """

    station: tuple[float, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def __post_init__(self) -> None:
        if not len(self.station) == len(self.lower) == len(self.upper) >= 2:
            raise InputError(
                f"a K band of {len(self.station)} places, {len(self.lower)} lower and {len(self.upper)} upper limits: as many of each, at least two"
            )
        for before, after in zip(self.station[:-1], self.station[1:], strict=True):
            if not after > before:
                raise InputError(f"a K band's places must rise: {as_given(before)} mm is followed by {as_given(after)} mm")
        for place, low, high in zip(self.station, self.lower, self.upper, strict=True):
            if not high > low:
                raise InputError(
                    f"a K band's upper limit must be above the lower one: {as_given(1e3 * high)} and {as_given(1e3 * low)} µm at {as_given(place)} mm"
                )

    @classmethod
    def straight(cls, where: Range, tolerance: float) -> KBand:
        """A band as wide as the total tolerance (mm) over the evaluation range."""
        return cls(where.ends, (-0.5 * tolerance,) * 2, (0.5 * tolerance,) * 2)

    @property
    def width(self) -> float:
        """Its least width, mm."""
        return min(round(high - low, 9) for low, high in zip(self.lower, self.upper, strict=True))

    def covers(self, station: Floats) -> Bools:
        """Which of the stations (n,) the band limits."""
        return np.asarray((station >= self.station[0] - 1e-9) & (station <= self.station[-1] + 1e-9))

    def place(self, station: Floats, trace: Floats) -> tuple[Floats, Floats]:
        """Where the band suits traces best.

        Parameters
        ----------
        station : (n,) float
            All inside the band, mm.
        trace : (..., n) float
            Deviations, mm.

        Returns
        -------
        shift : (...) float
            Of the band, mm.
        excess : (...) float
            How far the trace still leaves it on either side, mm; − is the room that is left.

        Notes
        -----
        ``excess = (max(δ − upper) + max(lower − δ)) / 2``: the least that any shift can reach.
        """
        above = (trace - np.interp(station, self.station, self.upper)).max(axis=-1)
        below = (np.interp(station, self.station, self.lower) - trace).max(axis=-1)
        return np.asarray(0.5 * (above - below)), np.asarray(0.5 * (above + below))


def fit_band(band: KBand, station: Floats, trace: Floats, noise: Floats) -> tuple[Floats, Estimate]:
    """Shift of the band to where it suits a trace best, and how far the trace leaves it, both of shape ().

    Parameters
    ----------
    band : KBand
    station, trace : (n,) float
        The trace where the band limits it, mm.
    noise : (draws, n) float
        Simulated errors of it, mm.
    """
    shift, excess = band.place(station, trace)
    again = band.place(station, trace + noise)[1]
    # What noise adds at most is what a straight trace would show in a straight band.
    return shift, Estimate(excess, np.array(again.std()), np.array(0.5 * np.ptp(noise, axis=-1).mean()))


@dataclass(frozen=True, slots=True)
class KBands:
    """What a drawing asks of profiles and helices; the left flanks' band and the right ones', None for no band.

    `source` says where the bands are from.
    """

    profile: tuple[KBand | None, KBand | None] = (None, None)
    helix: tuple[KBand | None, KBand | None] = (None, None)
    source: str = ""


@dataclass(frozen=True, slots=True)
class KFit:
    """How the traces of all flanks lie in their bands; side 0 left, 1 right.

    Parameters
    ----------
    bands : (KBand or None, KBand or None)
        Of the left and of the right flanks.
    shift : (teeth, 2) float
        Of the band to where it suits the trace best, mm.
    excess : Estimate
        (teeth, 2) how far the trace leaves the band then, mm; − is the room that is left; nan where not seen, or no band.
    """

    bands: tuple[KBand | None, KBand | None]
    shift: Floats
    excess: Estimate

    def verdict(self, tooth: int, side: int) -> BandVerdict | None:
        """Inside or outside; None where there is no band.

        "Not resolvable" where U is over 30 % of the band's width and the trace is neither inside nor outside by more than U.
        """
        band = self.bands[side]
        if band is None:
            return None
        value, expanded = float(self.excess.value[tooth, side]), float(self.excess.expanded[tooth, side])
        if math.isnan(value):
            return BandVerdict.NOT_SEEN
        if expanded > RESOLVABLE_SHARE * band.width and abs(value) <= expanded:
            return BandVerdict.NOT_RESOLVABLE
        return BandVerdict.OUTSIDE if value > 0.0 else BandVerdict.INSIDE

    def count(self, side: int) -> dict[BandVerdict, int]:
        """How many flanks of a side have each verdict; empty without a band."""
        verdicts = [self.verdict(tooth, side) for tooth in range(len(self.shift))]
        return {verdict: verdicts.count(verdict) for verdict in BandVerdict if verdict in verdicts}
