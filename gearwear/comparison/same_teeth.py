"""Which tooth of one scan is which of another of the same gear, and which end is up: by what is the gear's own.

A gear has as many symmetries as teeth, twice. What breaks them is its pitch and runout, the form of each flank, marks and damage. Each of the
2 z ways to lay one scan on the other is judged by how well such patterns agree. How well they agree by chance is told by the ways that are wrong.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import logsumexp

from gearwear.arrays import Floats
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.gear import Gear
from gearwear.design.quantity import counted, listed
from gearwear.design.surface import FLANK
from gearwear.placing.cells import Cells
from gearwear.placing.pose import Pose, about_z, flip
from gearwear.placing.side_maps import in_blocks
from gearwear.robust import median_scale, tukey_weight

SURE = 0.95
"""Chance from which on tooth numbers are said to be the same without doubt."""
TOLD = math.log(20.0)
"""Log of the odds, against no agreement at all, from which on a pattern is said to have told."""
CORRELATIONS = np.linspace(0.0, 1.0, 201)[1:-1]
"""Values that the true correlation of two scans of the same gear may have, alike likely."""
STEPS = 8
"""Reweighted fits of the motion between a scan and its gear."""


@dataclass(frozen=True, slots=True)
class TeethPattern:
    """Something that differs from flank to flank.

    Parameters
    ----------
    name : str
        What it is, in words.
    values : (teeth, 2, rows, columns) float
        Scalars that a rotation of the gear does not change, such as deviations along the normal; nan where not seen. Sides left, right; rows
        along z.
    """

    name: str
    values: Floats

    def laid(self, turned: int, flipped: bool) -> Floats:
        """The values with the gear laid otherwise, same shape: upside down about the x axis first, then turned by so many teeth."""
        values = self.values
        if flipped:
            teeth = len(values)
            values = values[(-np.arange(teeth)) % teeth][:, ::-1, ::-1]
        return np.roll(values, turned, axis=0)

    def compressed(self) -> TeethPattern:
        """Each side by itself as `_compressed`; the same however the gear lies."""
        sides = [_compressed(self.values[:, side]) for side in range(self.values.shape[1])]
        return TeethPattern(self.name, np.stack(sides, axis=1))


class Marked(Protocol):
    """What is known of a mark that a scan was numbered by, as of `SeenMark`; angles in rad."""

    @property
    def off(self) -> float: ...

    @property
    def std(self) -> float: ...

    @property
    def end_told(self) -> bool: ...


@dataclass(frozen=True, slots=True)
class SameTeeth:
    """How the teeth of another scan go with those of a first.

    Parameters
    ----------
    turned : int
        Teeth by which the other scan, as it lay, is turned to go with the first: its tooth t (upside down first, where `flipped`: its tooth −t,
        counted from 0) is tooth t + turned.
    flipped : bool
        Whether its other end is up.
    probability : float
        That it is so, by what both scans show of the gear; where nothing tells, 1 / (2 z). 1 where a mark was stated.
    told_by : tuple of str
        The patterns that told.
    stated : bool
        Whether a stated mark says so.
    """

    turned: int
    flipped: bool
    probability: float
    told_by: tuple[str, ...] = ()
    stated: bool = False

    @property
    def sure(self) -> bool:
        return self.probability >= SURE

    @property
    def as_it_lay(self) -> bool:
        """Whether nothing is to be turned."""
        return self.turned == 0 and not self.flipped

    def motion(self, gear: Gear) -> Pose:
        """Of the other scan on its design, so that its teeth have the numbers of the first."""
        turn = about_z(self.turned * gear.pitch_angle)
        return flip(gear.face_width).then(turn) if self.flipped else turn

    def sentence(self, other: str) -> str:
        """How the teeth of `other` were told."""
        if self.stated:
            return f"tooth 1 of {other} is where the design states it"
        lay = "lies as the scan does"
        if not self.as_it_lay:
            turned = f"turned by {counted(self.turned, 'tooth', 'teeth')}" if self.turned else ""
            lay = " and ".join(filter(None, [turned, "upside down" if self.flipped else ""])) + " against the scan"
        if self.sure:
            return f"{other} {lay}, by {listed(self.told_by)} of the gear itself ({100.0 * self.probability:.4g} % sure)"
        if self.told_by:
            return (
                f"which tooth of {other} is which is doubtful: {lay} is taken, and what both scans show of the gear makes that"
                f" {100.0 * self.probability:.2g} % sure"
            )
        return (
            f"nothing on the gear tells which tooth of {other} is which: it is taken to lie as the scan does; a marked tooth"
            " ([datum] tooth_1_deg, or [datum.mark]) would tell"
        )


def match_teeth(
    first: Sequence[TeethPattern],
    other: Sequence[TeethPattern],
    ends_alike: bool = True,
    marked: Mapping[tuple[int, bool], float] | None = None,
) -> SameTeeth:
    """Find how another scan of the same gear lies against a first.

    Parameters
    ----------
    first, other : sequence of TeethPattern
        The same kinds in the same order and shape.
    ends_alike : bool
        Whether the other scan may lie upside down: not where the hands of a double helical gear tell its ends.
    marked : mapping of (int, bool) to float, or None
        The ways (`SameTeeth.turned`, `flipped`) that put a mark of the gear where the first scan has it, and the logs of their likelihoods; None: no mark.

    Returns
    -------
    SameTeeth
        The likeliest of the 2 z ways (z, where the ends are told) where it is likelier than all others together; else as it lay.

    Notes
    -----
    Of every pattern and side the correlation r is taken in each way. Against no correlation, a true one of ρ makes r likelier by
    ``(1 − ρ²)^(n/2) / (1 − ρ r)^(n − ½)`` (the likelihood of a correlation, Fisher 1915, first order), here averaged over ρ. The number n of
    independent values is what the ways that are wrong show: r of unlike patterns scatters by 1/√n. Pattern and side tell by themselves, and as
    likely as not say nothing.
    """
    teeth = len(first[0].values)
    ways = [(turned, flipped) for flipped in ((False, True) if ends_alike else (False,)) for turned in range(teeth)]
    total, by_name = np.zeros(len(ways)), dict[str, Floats]()
    for pattern, again in zip(first, other, strict=True):
        ours, theirs = pattern.compressed(), again.compressed()
        laid = [theirs.laid(*way) for way in ways]
        for side in range(ours.values.shape[1]):
            odds = _log_odds(ours.values[:, side], [values[:, side] for values in laid])
            total += odds
            by_name[ours.name] = by_name.get(ours.name, np.zeros(len(ways))) + odds
    mark: tuple[str, ...] = ()
    if marked is not None:
        mark, total = ("the mark",), total + np.array([marked.get(way, -math.inf) for way in ways])
    chance = np.exp(total - total.max())
    chance /= chance.sum()
    best = int(np.argmax(chance))
    if chance[best] < 0.5:
        telling = tuple(name for name, odds in by_name.items() if odds.max() > TOLD)
        return SameTeeth(0, False, float(chance[0]), telling)
    telling = (*mark, *(name for name, odds in by_name.items() if odds[best] > TOLD))
    return SameTeeth(*ways[best], float(chance[best]), telling)


def _log_odds(first: Floats, laid: Sequence[Floats]) -> Floats:
    """Log of the odds of each way against no agreement, (ways,); of compressed values."""
    r, number = np.zeros(len(laid)), 0
    for way, values in enumerate(laid):
        known = np.isfinite(first) & np.isfinite(values)
        a, b = first[known], values[known]
        size = float(np.sqrt((a @ a) * (b @ b)))
        r[way] = float(a @ b) / size if size > 0.0 else 0.0
        number = max(number, len(a))
    wrong = np.delete(r, int(np.argmax(r)))
    scatter = float(np.mean(wrong**2))
    if scatter == 0.0:
        return np.zeros(len(laid))
    n = min(1.0 / scatter, float(number))
    agree = 0.5 * n * np.log1p(-(CORRELATIONS**2)) - (n - 0.5) * np.log1p(-CORRELATIONS * np.minimum(r, 0.999)[:, None])
    return np.asarray(np.logaddexp(0.0, logsumexp(agree, axis=1) - math.log(len(CORRELATIONS))) - math.log(2.0))


def _compressed(values: Floats) -> Floats:
    """Values in their own scatter, without what all teeth share; what stands out counts by its logarithm, so that no one place decides."""
    differences = values - _middle(values, 0)
    known = differences[np.isfinite(differences)]
    if not len(known):
        return differences
    scale = median_scale(known)[1] or float(np.sqrt(np.mean(known**2)))
    return np.asarray(np.arcsinh(differences / scale) if scale > 0.0 else differences)


def _middle(values: Floats, axis: int | tuple[int, ...]) -> Floats:
    """Median over axes, which stay; nan where nobody saw anything."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmedian(values, axis=axis, keepdims=True), dtype=np.float64)


def gear_patterns(cells: Cells, measured: MeasuredGear) -> tuple[TeethPattern, ...]:
    """What a scan shows of its gear alone, flank by flank: where the flanks stand, their form with its marks, and what is broken off.

    Parameters
    ----------
    cells : Cells
        Of the scan, with what measurement added taken out where that is known.
    measured : MeasuredGear
        For what is broken off it.
    """
    grid = cells.grid
    flanks = grid.flank_shape(_without_motion(cells))
    flanks = flanks - _middle(flanks, 0)
    place = _middle(flanks, (2, 3))
    broken = np.zeros((grid.gear.teeth, 2, 1, 1))
    for piece in measured.broken:
        if piece.seen:
            broken[piece.tooth] += piece.volume
    return (
        TeethPattern("pitch and runout", place),
        TeethPattern("form and marks", flanks - place),
        TeethPattern("damage", broken),
    )


def coarse(pattern: TeethPattern, blocks: int = 3) -> TeethPattern:
    """A pattern in so many blocks along z and along the profile: enough to know a gear again by, and small enough to keep."""
    teeth, sides, rows, columns = pattern.values.shape
    ways = [in_blocks(number, min(blocks, number)) for number in (rows, columns)]
    parts = [[np.flatnonzero(way == block) for block in range(way[-1] + 1)] for way in ways]
    values = np.empty((teeth, sides, len(parts[0]), len(parts[1])))
    for i, along in enumerate(parts[0]):
        for j, beside in enumerate(parts[1]):
            values[:, :, i, j] = _middle(pattern.values[:, :, along][..., beside], (2, 3))[..., 0, 0]
    return TeethPattern(pattern.name, values)


def kept_patterns(measured: MeasuredGear) -> tuple[TeethPattern, ...]:
    """What a report keeps of a gear to know its teeth again by."""
    return tuple(coarse(pattern) for pattern in gear_patterns(measured.corrected, measured))


def _without_motion(cells: Cells) -> Floats:
    """Deviations of the flanks without what a small motion of the gear does to them, (m,) mm: that is the registration's."""
    index = np.flatnonzero(cells.seen & (cells.points.surface == FLANK))
    side = cells.points.side[index] > 0
    columns = np.column_stack([cells.motion[index], side, ~side])
    target, weight = cells.points.deviation[index], np.ones(len(index))
    size = np.sqrt((columns**2).sum(axis=0))
    size[size == 0.0] = 1.0
    columns = columns / size
    solution = np.zeros(columns.shape[1])
    for _ in range(STEPS):
        root = np.sqrt(weight)[:, None]
        solution = np.linalg.lstsq(columns * root, target * root[:, 0], rcond=1e-9)[0]
        residual = target - columns @ solution
        weight = tukey_weight(residual, max(median_scale(residual)[1], 1e-9))
    rest = np.full(len(cells.count), np.nan)
    rest[index] = target - columns[:, :6] @ solution[:6]
    return rest


def same_teeth(first: MeasuredGear, other: MeasuredGear) -> SameTeeth:
    """How another scan of the same gear lies against a first, both in the same grid of cells; see `match_teeth`."""
    patterns = gear_patterns(first.corrected, first), gear_patterns(other.corrected, other)
    marks, drawn = (first.mark, other.mark), first.design.datum.mark
    marked = None
    if drawn is not None and marks[0] is not None and marks[1] is not None:
        marked = marked_ways(marks[0], marks[1], drawn.angle, first.gear.teeth)
    return match_teeth(*patterns, ends_alike=first.gear.spec.gap == 0.0, marked=marked)


def marked_ways(first: Marked, other: Marked, angle: float, number: int) -> dict[tuple[int, bool], float]:
    """The ways to lay another scan that put its mark where a first has it, with the logs of their likelihoods.

    Parameters
    ----------
    first, other : Marked
        In scans that were numbered by them.
    angle : float
        Where the design has the mark, rad.
    number : int
        Of teeth.

    Notes
    -----
    As it lies the mark of the other is where the first's is, but for their errors. Upside down about x it stands at −(angle + off), from where whole
    teeth bring it near: how near, tells the ends of a mark that stands skew to the teeth, even one that goes right through.
    """
    std, ways = math.hypot(first.std, other.std), dict[tuple[int, bool], float]()
    there, pitch = angle + first.off, 2.0 * math.pi / number
    for flipped in (False,) if first.end_told and other.end_told else (False, True):
        turn = there + (angle + other.off if flipped else -angle - other.off)
        teeth = round(turn / pitch)
        ways[teeth % number, flipped] = -0.5 * ((turn - teeth * pitch) / std) ** 2
    return ways
