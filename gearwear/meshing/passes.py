"""Which teeth stand where, position by position: the bookkeeping of two gears in mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.tooth_pair import NODES, SAMPLES, Flanks, PairContact, ToothPairs

_BLOCK_BYTES = 80e6
"""Memory for the tables and results of the passes worked on at a time."""


@dataclass(frozen=True, slots=True)
class Positions:
    """n positions: advance and lag of the driven gear (mm), and the pairs; teeth of the driver are numbered without end.

    `ahead_of` and `behind_of`, (n, v): the same for v variants of the pair.
    """

    ahead: Floats
    behind: Floats
    ahead_of: Floats
    behind_of: Floats
    tooth: Ints
    gap: Floats
    carrying: Ints
    z: Floats
    radius: Floats
    mate_radius: Floats


@dataclass(frozen=True, slots=True)
class Passes:
    """How positions, teeth and angles go together.

    In pass p the tooth ``k = side (column − p)`` of the driver stands ``(column + i/n)`` pitches past the line of centres
    in the i-th position, whatever p is. So contact is worked out once for every angle and every pair of teeth that
    meet, and a position picks its pairs from that.
    """

    driver: ToothProfiles
    driven: ToothProfiles
    mate_half_angle: Floats
    """(teeth, 2, n_z, n_r) of the driven gear at the driver's heights, rad."""
    centre: float
    side: Side
    """Sign of the driver's flank that carries."""
    n: int
    """Positions per pitch."""
    start: int
    """Tooth of the driven gear that the driver's tooth 0 touches with its left flank."""

    @classmethod
    def of(cls, driver: ToothProfiles, driven: ToothProfiles, centre: float, side: Side, n: int, start: int) -> Passes:
        """Bring the driven gear to the driver's heights."""
        return cls(driver, driven, _at_heights(driven, driver.z), centre, side, n, start)

    def columns(self) -> Ints:
        """Teeth, counted from the line of centres, that can reach into the driven tip circle with either flank."""
        r, tip = self.driver.radius, self.driven.radius[-1]
        lens = np.arccos(np.clip((self.centre**2 + r**2 - tip**2) / (2.0 * self.centre * r), -1.0, 1.0))
        reach = float((lens + np.abs(self.driver.half_angle).max(axis=(0, 1, 2))).max()) / self.driver.gear.pitch_angle
        return np.arange(math.floor(-reach), math.floor(reach) + 1)

    def passes_at_a_time(self) -> int:
        """Passes whose tables and results fit in the memory set aside."""
        angles = len(self.columns()) * self.n
        row = 8.0 * (3 * (SAMPLES + len(self.driver.radius)) + 3 * NODES + 20 * angles)
        return max(1, int(_BLOCK_BYTES / (row * len(self.driver.z))))

    def tooth(self, passing: Ints, column: Ints | int) -> Ints:
        """Tooth of the driver, numbered without end."""
        return np.asarray(self.side * (column - passing), dtype=np.int64)

    def mate(self, tooth: Ints, side: Side | None = None) -> Ints:
        """Tooth of the driven gear that `tooth` touches with its flank `side` (None: the one that drives)."""
        return np.asarray(self.start - tooth + ((side or self.side) < 0), dtype=np.int64)

    def flanks(self, side: Side, tooth: Ints) -> tuple[Flanks, Flanks]:
        """Flanks `side` of the driver's teeth and those of their mates, a row for each tooth and slice."""
        one, two, index = self.driver, self.driven, side.index
        own = one.half_angle[tooth % one.gear.teeth, index] - one.gear.half_angle(one.radius)
        other = self.mate_half_angle[self.mate(tooth, side) % two.gear.teeth, index] - two.gear.half_angle(two.radius)
        rows = len(tooth) * len(one.z)
        return Flanks(one.gear, one.radius, own.reshape(rows, -1)), Flanks(two.gear, two.radius, other.reshape(rows, -1))

    def pairs(self, side: Side, tooth: Ints) -> ToothPairs:
        """The same, ready for contact."""
        return ToothPairs.of(*self.flanks(side, tooth), self.centre)

    def advance_near(self, passing: int, side: Side) -> Callable[[Floats], Floats]:
        """Advance (mm) through one side as a function of the place in or next to a pass, in pitches."""
        gear, columns = self.driver.gear, self.columns()
        turn = (1 if side == self.side else -1) * gear.pitch_angle
        own, mate = self.flanks(side, self.tooth(np.array(passing), columns))
        # The columns' angles go into the half angles, so that one look serves them all.
        ahead = np.repeat(turn * columns, len(self.driver.z))
        pairs = ToothPairs.of(replace(own, excess=own.excess + ahead[:, None]), mate, self.centre)

        def advance(place: Floats) -> Floats:
            each = pairs.contact(turn * place).advance - gear.base_radius * ahead
            return np.asarray(each.max(axis=1), dtype=np.float64)

        return advance

    def shift(self, variant: Passes, side: Side, tooth: Ints, contact: PairContact) -> Floats:
        """What the advances of `contact` change by where the flanks are those of `variant`, (angles, rows) mm.

        A advance is the greatest value along a flank, so to first order it changes by what the flanks change where they touch.
        """
        row = np.arange(len(tooth) * len(self.driver.z))
        change = np.zeros_like(contact.advance)
        radii = (contact.radius, contact.mate_radius)
        for base, other, radius in zip(self.flanks(side, tooth), variant.flanks(side, tooth), radii, strict=True):
            excess = other.excess - base.excess
            if excess.any():
                change += base.gear.base_radius * Flanks(base.gear, base.radius, excess).excess_at(row, radius)
        return np.where(np.isfinite(contact.advance), change, 0.0)

    def positions(
        self, first: int, stop: int, tolerance: float, variants: Sequence[Passes] = (), start: float = 0.0
    ) -> tuple[Positions, tuple[tuple[Ints, Ints, Floats], ...]]:
        """Passes `first` to `stop`; for both gears tooth, slice and radius of every point within `tolerance` (mm).

        The first position of a pass is `start` pitches after its beginning.
        """
        n, columns, slices = self.n, self.columns(), len(self.driver.z)
        m, passing = len(columns), np.arange(first, stop)
        angles = (columns[0] + start + np.arange(m * n) / n) * self.driver.gear.pitch_angle
        tooth = self.tooth(np.arange(first - columns[-1], stop - columns[0]), 0)

        def by_position(values: Floats) -> Floats:
            """(angles, teeth · slices) to (positions, columns, slices)."""
            cube = values.reshape(m * n, len(tooth), slices)
            picked = [cube[c * n : (c + 1) * n, m - 1 - c : m - 1 - c + len(passing)] for c in range(m)]
            return np.stack(picked, axis=2).swapaxes(0, 1).reshape(len(passing) * n, m, slices)

        drive = self.pairs(self.side, tooth).contact(angles)
        coast = self.pairs(self.side.opposite, tooth).contact(-angles)
        advance, radius, mate_radius = (by_position(values) for values in (drive.advance, drive.radius, drive.mate_radius))
        ahead, behind = advance.max(axis=(1, 2)), by_position(coast.advance).max(axis=(1, 2))
        if not np.isfinite(ahead + behind).all():
            raise InputError(
                f"centre distance {self.centre:g} mm: in some positions no tooth reaches the mate; it must be smaller"
            )
        also = np.empty((2, len(ahead), len(variants)))
        for v, variant in enumerate(variants):
            for way, (side, contact) in enumerate(((self.side, drive), (self.side.opposite, coast))):
                advances = contact.advance + self.shift(variant, side, tooth, contact)
                also[way, :, v] = by_position(advances).max(axis=(1, 2))
        gap = ahead[:, None, None] - advance
        near = self.tooth(np.repeat(passing, n)[:, None], columns[None, :])
        at = np.arange(len(ahead))
        column, height = np.divmod(gap.reshape(len(ahead), -1).argmin(axis=1), slices)
        found = Positions(
            ahead=ahead,
            behind=behind,
            ahead_of=also[0],
            behind_of=also[1],
            tooth=near,
            gap=gap.min(axis=2),
            carrying=near[at, column],
            z=self.driver.z[height],
            radius=radius[at, column, height],
            mate_radius=mate_radius[at, column, height],
        )
        position, which, touched = np.nonzero(gap <= tolerance)
        touching = near[position, which]
        own = (touching, touched, radius[position, which, touched])
        other = (self.mate(touching), touched, mate_radius[position, which, touched])
        return found, (own, other)


def _at_heights(profiles: ToothProfiles, z: Floats) -> Floats:
    """Half angles at other heights: (teeth, 2, len(z), n_r); linear in z, constant beyond the ends."""
    psi, own = profiles.half_angle, profiles.z
    if len(own) == 1:
        return np.broadcast_to(psi, (*psi.shape[:2], len(z), psi.shape[3]))
    if np.array_equal(own, z):
        return psi
    low = np.clip(np.searchsorted(own, z, side="right") - 1, 0, len(own) - 2)
    part = np.clip((z - own[low]) / (own[low + 1] - own[low]), 0.0, 1.0)[:, None]
    return np.asarray((1.0 - part) * psi[:, :, low] + part * psi[:, :, low + 1], dtype=np.float64)
