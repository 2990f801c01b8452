"""Which teeth an overload has bent: both of their flanks moved the same way round the gear, the farther the nearer to the tip.

Metal does not come back. Where a flank stands proud, growing to the tip, and the other flank of its tooth lies as low there, the metal was moved and none of
it is gone. As cut, flanks lean too (f_Hα), each tooth otherwise: a flank that leans tells of a bend where it leans by more than flanks of its side do by
chance, of which a few may be worn or bent (the generalised extreme Studentised deviate, Rosner 1983).
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells, noise


@dataclass(frozen=True, slots=True)
class Bent:
    """A tooth that was bent.

    Parameters
    ----------
    tooth : int
        0-based.
    moved : (float, float, float)
        By how much its flanks moved at the tip, in the middle and at the form circle, mm, + counter-clockwise: as the flank that stands proud has it, at a
        first look.
    lean : (float, float, float)
        By how much more, at each of these, at the upper end of the face than at the lower, mm.
    """

    tooth: int
    moved: tuple[float, float, float]
    lean: tuple[float, float, float] = (0.0, 0.0, 0.0)


def bent_teeth(cells: Cells) -> tuple[Bent, ...]:
    """Teeth of which both flanks moved the same way round the gear.

    Parameters
    ----------
    cells : Cells
        As registered.

    Notes
    -----
    Heights are about those that flanks of the side have in the median, and a flank's profile the median of its rows: wear in one place moves neither, and a
    single column not the slope, that of the median pair of columns (Theil 1950, Sen 1968) on the lower three quarters: a ridge that flowed to the tip is above.
    A tooth is bent where

    - one flank rises to the tip by more than chance, and by more than points scatter,
    - its upper half stands proud by more than half of that: a flank worn at its foot rises to where it was,
    - and the other flank falls by more than half of it: metal that one flank has more of than others, as cut, the other does not miss.
    """
    heights, along, up = _heights(cells)
    profile = _medians(heights, axis=2)
    below = up < 0.75
    rise = _slopes(profile[..., below], up[below])
    known = np.isfinite(rise).all(axis=1)
    if known.sum() < rules().folds_of_teeth // 2:
        return ()
    upper = up > 0.5
    there = float(up[upper].mean())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # flanks nobody saw
        height = np.nanmean(profile[..., upper], axis=2)
    far, share = noise(cells), rules().stands_in
    found = list[Bent]()
    for side in Side:
        own, other = (rise[:, one.index] for one in (side, side.opposite))
        beyond = np.zeros(len(rise), dtype=np.bool_)
        beyond[known] = _outlying(own[known])
        proud = (own > far) & (height[:, side.index] > share * there * own)
        bent = beyond & proud & (-other > share * own)
        for tooth in np.flatnonzero(bent).tolist():
            flank = heights[tooth, side.index]
            lean = _slopes(flank.T, along) if len(along) > 1 else np.zeros(len(up))
            middle = _medians(flank - (along[:, None] - 0.5) * lean, axis=0)
            found.append(Bent(tooth, _along_profile(up, int(side) * middle), _along_profile(up, int(side) * lean)))
    return tuple(sorted(found, key=lambda one: one.tooth))


def _heights(cells: Cells) -> tuple[Floats, Floats, Floats]:
    """Height of each flank about what its side has, (teeth, 2, rows, columns) mm, nan where it was not seen, or most of the flank was not; how far along
    the face, from its lower end (0) to the upper (1), the rows lie, and how far up from the form circle (0) to the tip (1) the columns."""
    grid, gear = cells.grid, cells.grid.gear
    seen = grid.flank_shape(cells.seen)
    heights = np.where(seen, grid.flank_shape(cells.points.deviation), np.nan)
    often = seen.mean(axis=(2, 3)) > rules().known_flank
    up = (grid.column_middles - gear.form_roll) / (gear.tip_roll - gear.form_roll)
    off = heights - _medians(heights, axis=0)
    return np.where(often[:, :, None, None], off, np.nan), grid.row_middles / gear.face_width, up


def _medians(values: Floats, axis: int) -> Floats:
    """Medians along an axis of what is known, nan where nothing is."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # places nobody saw
        return np.asarray(np.nanmedian(values, axis=axis))


def _along_profile(up: Floats, values: Floats) -> tuple[float, float, float]:
    """What the parabola through values (columns,) has at the tip, in the middle and at the form circle."""
    at = np.isfinite(values)
    curve = np.polynomial.Polynomial.fit(up[at], values[at], 2)
    return float(curve(1.0)), float(curve(0.5)), float(curve(0.0))


def _slopes(profile: Floats, up: Floats) -> Floats:
    """Rise of each profile (…, columns) from the form circle to the tip, mm: the median over the pairs of its columns; nan where none are known."""
    first, second = np.triu_indices(len(up), 1)
    return _medians((profile[..., second] - profile[..., first]) / (up[second] - up[first]), axis=-1)


def _outlying(values: Floats) -> Bools:
    """Which of (n,) lie off the others by more than chance, a quarter of them at most (Rosner 1983, both sides of a gear asked)."""
    left = np.arange(len(values))
    gone, number = list[int](), 0
    for step in range(len(values) // 4):
        kept = values[left]
        off = np.abs(kept - kept.mean())
        farthest, n = int(off.argmax()), len(kept)
        t = float(stdtrit(n - 2, 1.0 - rules().significance / len(Side) / (2.0 * n)))
        gone.append(int(left[farthest]))
        if off[farthest] > kept.std(ddof=1) * (n - 1) * t / math.sqrt(n * (n - 2 + t**2)):
            number = step + 1
        left = np.delete(left, farthest)
    result = np.zeros(len(values), dtype=np.bool_)
    result[gone[:number]] = True
    return result
