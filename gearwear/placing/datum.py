"""Which surfaces the pose may rest on: those that show no one-sided wear."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP
from gearwear.placing.cells import Cells
from gearwear.robust import median_scale

WORN_RATIO = 2.0
"""A side is worn where its flanks are this many times rougher in shape than the other side's."""
SURE = 4.0
"""And by so many standard deviations of the noise."""
LEAST_BEND = 1e-4
"""mm; a bend that says nothing of wear however small the noise."""
MEDIANS_ERROR = 0.5 * math.pi
"""Standard error of a median over teeth of medians over the face, in that of a mean: sqrt(π / 2) for each."""
LOW = 0.002
"""mm by which flanks must lie low against fillets and tips for it to be said that thin teeth may be worn ones."""


@dataclass(frozen=True, slots=True)
class Datum:
    """What the pose rests on.

    Parameters
    ----------
    mask : (m,) bool
        Cells in use.
    worn_side : Side or None
        Where all flanks of that side look worn and are left out.
    surfaces : tuple of str
        Names for the report.
    doubtful : tuple of Side
        Where no side is called worn, those that may be: that the scan does not show their flanks to be straight.
    low : float or None
        How far smooth flanks lie low against fillets and tips, mm: thin teeth, or worn ones. 0 where they do not, None where nothing else was seen.
    borne_out : str or None
        What is said of the side left out once it is known how it is worn; None: as it looks.
    """

    mask: Bools
    worn_side: Side | None
    surfaces: tuple[str, ...]
    doubtful: tuple[Side, ...] = ()
    low: float | None = 0.0
    borne_out: str | None = None

    @property
    def notes(self) -> tuple[str, ...]:
        """What the choice assumes and what it cannot tell, each a sentence."""
        if self.worn_side is not None:
            said = bends_otherwise(self.worn_side) if self.borne_out is None else self.borne_out
            return (said,) if said else ()
        if self.low is None:
            return (
                "only flanks were seen: a uniform loss of all flanks of one side could not be told from a rotation of thinner teeth",
            )
        if self.low > 0.0:
            return (
                f"both flank sides are smooth but {1e3 * self.low:.1f} µm low against fillets and tips: thinner teeth, or the same loss on every flank "
                f"of one side and a rotation; the flanks alone cannot tell, and the rotation may be off by up to {1e3 * self.low:.1f} µm at the base circle",
            )
        return ()


def flank_shapes(cells: Cells) -> Floats:
    """Typical profile of each side, mm, (2, columns): median over the teeth of each flank's profile about its own middle.

    Medians, so that single worn teeth drop out; about its own middle, so that pitch errors do.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # columns nobody saw
        flank = np.nanmedian(cells.grid.flank_shape(cells.points.deviation), axis=2)
        return np.asarray(np.nanmedian(flank - np.nanmedian(flank, axis=2, keepdims=True), axis=0))


def choose_datum(cells: Cells, noise: float, ignore: frozenset[int] = frozenset()) -> Datum:
    """Choose the datum surfaces.

    A rotation shifts a side's flanks by a constant, so it cannot hide a worn **shape**: the side whose mean profile bends more
    than `WORN_RATIO` times the other's, and more than the noise allows, is worn and left out. What the noise itself bends a profile by is taken off
    first: the same wear is seen in a coarser scan as far as it can be. A side whose bend the noise may hide is doubtful.

    Parameters
    ----------
    cells : Cells
        The scan on the design.
    noise : float
        Scatter inside cells, mm.
    ignore : frozenset of int
        Codes of surfaces that are no datum.
    """
    shape = flank_shapes(cells)
    inner = slice(1, -1) if shape.shape[1] > 4 else slice(None)  # the cells at the corners see edges
    columns = shape[:, inner].shape[1]
    per_side = cells.grid.flank_shape(cells.count).sum(axis=(0, 2, 3))
    error = MEDIANS_ERROR * noise / np.sqrt(np.maximum(per_side / shape.shape[1], 1.0))
    square = np.array([median_bend(profile[inner]) for profile in shape]) ** 2 - error**2
    worn, doubtful = None, []
    if np.isfinite(square).all():
        bend = np.sqrt(np.maximum(square, 0.0))
        unseen = SURE * error / math.sqrt(columns)
        rough = int(np.argmax(bend))
        if bend[rough] > WORN_RATIO * bend[1 - rough] + float(unseen[rough]) + LEAST_BEND:
            worn = tuple(Side)[rough]
        else:
            doubtful = [side for side in Side if bend[side.index] + float(unseen[side.index]) > LEAST_BEND]
    p = cells.points
    mask = (p.surface != FLANK) | (p.side != worn) if worn is not None else np.ones(len(p), dtype=bool)
    mask = mask & ~np.isin(p.surface, list(ignore))
    surfaces = []
    names = {FLANK: "flanks", FILLET: "fillets", ROOT: "roots", TIP: "tips", END_LOW: "lower end", END_HIGH: "upper end"}
    for code, name in names.items():
        if code not in ignore and (cells.seen & (p.surface == code)).any():
            if code == FLANK and worn is not None:
                name = f"{worn.opposite} flanks (coast)"
            surfaces.append(name)
    low = 0.0 if worn is not None else _low(cells, noise, ignore)
    return Datum(mask, worn, tuple(surfaces), tuple(doubtful), low)


def median_bend(profile: Floats) -> float:
    """Root mean square of a profile about its own median, mm; nan where little was seen."""
    finite = profile[np.isfinite(profile)]
    if len(finite) < 3:
        return float("nan")
    return float(np.sqrt(np.mean((finite - np.median(finite)) ** 2)))


def bends_otherwise(side: Side, seen: str = "", others: int = 0) -> str:
    """That a side is left out for its shape, what was `seen` of wear on it and on how many `others` opposite, and what that assumes."""
    how = f"bend otherwise than the {side.opposite} ones" + ("" if seen else ", as worn ones do,")
    seen = f"{seen}, and " if seen else ""
    return f"the {side} flanks {how} and are not used as datum; {seen}{taken_for_unworn(side.opposite, others)}"


def taken_for_unworn(side: Side, worn: int = 0) -> str:
    """That the flanks of a side are assumed unworn, but for so many on which wear was found."""
    which = f"all {side} flanks but {worn}" if worn else f"the {side} (coast) flanks"
    return f"{which} are assumed unworn"


def _low(cells: Cells, noise: float, ignore: frozenset[int]) -> float | None:
    """How far the flanks of both sides lie low against fillets and tips, beyond what noise and their own differences make, mm; 0 where they do not, None
    where only flanks were seen."""
    p = cells.points
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # flanks nobody saw
        flank = np.nanmedian(p.deviation[p.surface == FLANK].reshape(2 * cells.grid.gear.teeth, -1), axis=1)
    other = [median_scale(p.deviation[p.surface == code])[0] for code in (FILLET, TIP) if code not in ignore]
    other = [value for value in other if np.isfinite(value)]
    flank = flank[np.isfinite(flank)]
    if not other or not len(flank):
        return None
    low = min(other) - float(np.median(flank))  # against each of them: tips alone may be higher than drawn
    # Flanks differ from one another by more than noise (pitch, table): their own spread says how well their middle is known.
    error = np.hypot(
        1.25 * median_scale(flank)[1] / np.sqrt(len(flank)), noise / np.sqrt(np.median(cells.count[cells.seen]) * len(flank))
    )
    return low if low > max(4.0 * error, LOW) else 0.0
