"""Which teeth stand where, position by position: the bookkeeping of two gears in mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal, get_args

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.given import check_choice
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.design.twist import turn_at
from gearwear.errors import InputError
from gearwear.meshing.backlash import working_pressure_angle
from gearwear.meshing.tooth_pair import NODES, SAMPLES, Flanks, PairContact, ToothPairs, place_among, tip_corner

Cycle = Literal["pitch", "revolution", "driven", "hunting"]
"""How long to turn: one pitch of teeth that are all alike, one revolution of the driver or of the driven gear, or until the same teeth meet again."""
CYCLES: tuple[Cycle, ...] = get_args(Cycle)
_BLOCK_BYTES = 80e6
"""Memory for the tables and results of the passes worked on at a time."""


def pitches(cycle: Cycle, driver: Gear, driven: Gear) -> int:
    """How many teeth of each gear pass in a cycle; InputError if it is none.

    >>> from gearwear.design import Gear, GearSpec
    >>> pinion, gear = (Gear.from_spec(GearSpec("", z, 2.0, 10.0)) for z in (18, 24))
    >>> [pitches(cycle, pinion, gear) for cycle in ("pitch", "revolution", "driven", "hunting")]
    [1, 18, 24, 72]
    """
    check_choice("cycle", cycle, CYCLES)
    of = {"pitch": 1, "revolution": driver.teeth, "driven": driven.teeth, "hunting": math.lcm(driver.teeth, driven.teeth)}
    return of[cycle]


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

    @classmethod
    def joined(cls, blocks: Sequence[Positions]) -> Positions:
        """Blocks of positions one after the other."""
        return cls(**{f.name: np.concatenate([getattr(block, f.name) for block in blocks]) for f in fields(cls)})


@dataclass(frozen=True, slots=True)
class PassBlock:
    """Some passes: `tooth` (t,) and `angles` (a,) at which contact is worked out, and the tooth `near` in each position and column, (p, m)."""

    tooth: Ints
    angles: Floats
    near: Ints
    slices: int

    @property
    def passes(self) -> int:
        return len(self.tooth) - int(self.near.shape[1]) + 1

    def by_position(self, values: Floats) -> Floats:
        """(angles, teeth · slices) to (positions, columns, slices)."""
        positions, m = self.near.shape
        n, passes = len(self.angles) // m, self.passes
        cube = values.reshape(m * n, len(self.tooth), self.slices)
        picked = [cube[c * n : (c + 1) * n, m - 1 - c : m - 1 - c + passes] for c in range(m)]
        return np.stack(picked, axis=2).swapaxes(0, 1).reshape(positions, m, self.slices)

    def picked(self) -> tuple[Ints, Ints] | None:
        """Of the rows teeth · slices, the first that `by_position` picks at each angle, and the one behind the last, (angles,): in few passes most are not."""
        m = self.near.shape[1]
        first = self.slices * np.repeat(np.arange(m)[::-1], len(self.angles) // m)
        return first, first + self.slices * self.passes

    @property
    def parts(self) -> int:
        """Equal parts of the rows that stand at angles of their own: one, all teeth go through the same."""
        return 1


@dataclass(frozen=True, slots=True)
class PassPlaces:
    """Positions anywhere, as a `PassBlock` of which all is picked: for each position and column (p · m) a tooth, and one angle at which it stands."""

    tooth: Ints
    angles: Floats
    near: Ints
    slices: int

    def by_position(self, values: Floats) -> Floats:
        """(1, teeth · slices) to (positions, columns, slices)."""
        return values.reshape(*self.near.shape, self.slices)

    def picked(self) -> None:
        """All rows."""

    @property
    def parts(self) -> int:
        return len(self.tooth)


@dataclass(frozen=True, slots=True)
class Passes:
    """How positions, teeth and angles go together.

    In pass p the tooth ``k = side (column − p)`` of the driver stands ``(column + i/n)`` pitches past the line of centres
    in the i-th position, whatever p is. So contact is worked out once for every angle and every pair of teeth that
    meet, and a position picks its pairs from that.

    A slice of a helical gear is that of mid-face, turned by its `phase`: the two gears of a slice stay in step, as their base pitches
    and base helix angles agree, so its advance is that of a spur pair at another angle. Of double helical gears one is taken to float
    along its axis until both halves touch, as they are mounted: the advance is the mean of those of the two.
    """

    driver: ToothProfiles
    driven: ToothProfiles
    """Both in the same slices."""
    phase: Floats
    """(n_z,) angle by which the driver's slices are ahead of mid-face, counter-clockwise, rad; 0 for a spur gear."""
    half: Ints
    """(n_z,) half that the slices belong to: 0, and 1 for the upper one of a double helical gear."""
    centre: float
    side: Side
    """Sign of the driver's flank that carries."""
    n: int
    """Positions per pitch."""
    start: int
    """Tooth of the driven gear that the driver's tooth 0 touches with its left flank."""

    @classmethod
    def of(cls, driver: ToothProfiles, driven: ToothProfiles, centre: float, side: Side, n: int, start: int) -> Passes:
        """Of gears in the same slices (`Slices.cut`)."""
        gear = driver.gear
        half = np.asarray((driver.z > 0.5 * gear.face_width) & (gear.spec.gap > 0.0), dtype=np.int64)
        return cls(driver, driven, turn_at(gear, driver.z), half, centre, side, n, start)

    def roll_at(self, angle: Floats) -> Floats:
        """Length of roll, mm, at which a flank of the driver is touched on the line of action: ``L = r_b (θ + ψ_b + α_w)``, its tooth θ rad past
        the line of centres in the sense in which it faces."""
        gear = self.driver.gear
        working = working_pressure_angle(gear, self.driven.gear, self.centre)
        return np.asarray(gear.base_radius * (angle + gear.base_half_angle + working), dtype=np.float64)

    def columns(self) -> Ints:
        """Teeth, counted from the line of centres, that can reach into the driven tip circle with either flank."""
        r, tip, centre = self.driver.radius, tip_corner(self.driven), self.driven.gear.orientation * self.centre
        lens = np.arccos(np.clip((centre**2 + r**2 - tip**2) / (2.0 * centre * r), -1.0, 1.0))
        reach = float((lens + np.abs(self.driver.half_angle).max(axis=(0, 1, 2))).max()) + float(np.abs(self.phase).max())
        reach /= self.driver.gear.pitch_angle
        return np.arange(math.floor(-reach), math.floor(reach) + 1)

    def block(self, first: int, stop: int) -> PassBlock:
        """Passes `first` to `stop`."""
        n, columns = self.n, self.columns()
        return PassBlock(
            self.tooth(np.arange(first - columns[-1], stop - columns[0]), 0),
            (columns[0] + np.arange(len(columns) * n) / n) * self.driver.gear.pitch_angle,
            self.tooth(np.repeat(np.arange(first, stop), n)[:, None], columns[None, :]),
            len(self.driver.z),
        )

    def places(self, at: Floats) -> PassPlaces:
        """Positions `at` (p,), pitches from the start of the cycle."""
        passing, columns = at.astype(np.int64), self.columns()
        near = self.tooth(passing[:, None], columns[None, :])
        angles = (columns[0] + (at - passing)[:, None] + np.arange(len(columns))) * self.driver.gear.pitch_angle
        return PassPlaces(near.ravel(), angles.reshape(1, -1), near, len(self.driver.z))

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
        orientation = self.driven.gear.orientation
        return np.asarray(self.start + orientation * (((side or self.side) < 0) - tooth), dtype=np.int64)

    def mate_side(self, side: Side) -> Side:
        """Flank of the driven gear that the driver's flank `side` touches: the same, of a ring the other."""
        return side if self.driven.gear.orientation > 0 else side.opposite

    def flanks(self, side: Side, tooth: Ints) -> tuple[Flanks, Flanks]:
        """Flanks `side` of the driver's teeth and those of their mates, a row for each tooth and slice."""
        driver, driven, index = self.driver, self.driven, side.index
        excess = driver.half_angle[tooth % driver.gear.teeth, index] - driver.gear.half_angle(driver.radius)
        facing = self.mate_side(side).index
        other = driven.half_angle[self.mate(tooth, side) % driven.gear.teeth, facing] - driven.gear.half_angle(driven.radius)
        rows = len(tooth) * len(driver.z), -1
        return Flanks(driver.gear, driver.radius, excess.reshape(rows)), Flanks(driven.gear, driven.radius, other.reshape(rows))

    def contact(self, side: Side, block: PassBlock | PassPlaces) -> PairContact:
        """Where flanks `side` touch, the driver's teeth at the angles of the block at mid-face."""
        ahead = side * self.phase if self.phase.any() else None
        angles = block.angles if side == self.side else -block.angles  # in the sense in which the flank faces
        return ToothPairs.of(*self.flanks(side, block.tooth), self.centre, ahead, block.parts).contact(angles, block.picked())

    def searches_at_a_time(self) -> int:
        """PassPlaces about which both sides' tables fit in the memory set aside."""
        row = 8.0 * (2 * (SAMPLES + len(self.driver.radius)) + NODES)
        return max(1, int(_BLOCK_BYTES / (2 * row * len(self.columns()) * len(self.driver.z))))

    def advances_near(self, passing: Ints, sides: Sequence[Side]) -> Callable[[Floats], Floats]:
        """Advances (mm) in or next to passes (k,), through a side in each, as a function of the places in them, (n, k) pitches."""
        gear, columns = self.driver.gear, self.columns()
        turn = np.array([1 if side == self.side else -1 for side in sides]) * gear.pitch_angle
        flanks = [self.flanks(side, self.tooth(at, columns)) for at, side in zip(passing, sides, strict=True)]
        driving, mate = (replace(f[0], excess=np.concatenate([one.excess for one in f])) for f in zip(*flanks, strict=True))
        # The angles of columns and slices go into the half angles, so that one angle serves all of a pass.
        ahead = np.repeat(np.outer(turn, columns), len(self.driver.z))
        ahead += np.concatenate([np.tile(side * self.phase, len(columns)) for side in sides])
        driving = replace(driving, excess=driving.excess + ahead[:, None])
        pairs = ToothPairs.of(driving, mate, self.centre, parts=len(sides) * len(columns))

        def advances(places: Floats) -> Floats:
            each = pairs.contact(np.repeat(turn * places, len(columns), axis=1)).advance - gear.base_radius * ahead
            mean: Floats = self.furthest(each.reshape(places.size, len(columns), -1)).mean(axis=0)
            return mean.reshape(places.shape)

        return advances

    def furthest(self, advance: Floats) -> Floats:
        """Greatest advance of each half, (halves, positions), of advances (positions, columns, slices), mm."""
        halves = np.unique(self.half)
        own = [advance] if len(halves) == 1 else [advance[:, :, self.half == half] for half in halves]  # a choice is a copy
        return np.stack([one.max(axis=(1, 2)) for one in own])

    def shifts(self, variants: Sequence[Passes], side: Side, tooth: Ints, contact: PairContact) -> Iterator[Floats]:
        """What the advances of `contact` change by where the flanks are those of each variant, (angles, rows) mm.

        An advance is the greatest value along a flank, so to first order it changes by what the flanks change where they touch.
        """
        touching = np.flatnonzero(np.isfinite(contact.advance))
        of_row = touching % contact.advance.shape[1]
        row, places = np.arange(len(self.driver.z)), []
        for base, number, flank, radius in (
            (self.driver, tooth, side, contact.radius),
            (self.driven, self.mate(tooth, side), self.mate_side(side), contact.mate_radius),
        ):
            knot, part = place_among(base.radius, radius.ravel()[touching])
            teeth, sides, rows, knots = base.half_angle.shape
            start = ((number[:, None] % teeth * sides + flank.index) * rows + row).ravel()[of_row] * knots + knot
            was = base.half_angle.ravel()
            places.append((part, [(at, was.take(at)) for at in (start, start + 1)]))
        for variant in variants:
            change, everywhere = np.zeros(len(touching)), np.zeros_like(contact.advance)
            for base, other, (part, ends) in zip(
                (self.driver, self.driven), (variant.driver, variant.driven), places, strict=True
            ):
                if other.half_angle is not base.half_angle:
                    now = other.half_angle.ravel()
                    low, high = (now.take(at) - was for at, was in ends)
                    change += base.gear.base_radius * ((1.0 - part) * low + part * high)
            everywhere.ravel()[touching] = change
            yield everywhere

    def positions(
        self, block: PassBlock | PassPlaces, tolerance: float, variants: Sequence[Passes] = ()
    ) -> tuple[Positions, tuple[tuple[Ints, Ints, Floats], ...]]:
        """The positions of the block; for both gears tooth, slice and radius of every point within `tolerance` (mm)."""
        drive, coast = self.contact(self.side, block), self.contact(self.side.opposite, block)
        advance, radius, mate_radius = map(block.by_position, (drive.advance, drive.radius, drive.mate_radius))
        each_half = self.furthest(advance)
        ahead, behind = each_half.mean(axis=0), self.furthest(block.by_position(coast.advance)).mean(axis=0)
        if not np.isfinite(ahead + behind).all():
            raise InputError(
                f"centre distance {self.centre:g} mm: in some positions no tooth reaches the mate; it must be smaller"
            )
        also = np.empty((2, len(ahead), len(variants)))
        for way, (side, contact) in enumerate(((self.side, drive), (self.side.opposite, coast))):
            for v, shift in enumerate(self.shifts(variants, side, block.tooth, contact)):
                also[way, :, v] = self.furthest(block.by_position(contact.advance + shift)).mean(axis=0)
        gap = each_half[self.half].T[:, None, :] - advance
        near, at = block.near, np.arange(len(ahead))
        column, height = np.divmod(gap.reshape(len(ahead), -1).argmin(axis=1), block.slices)
        positions = Positions(
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
        points = (touching, touched, radius[position, which, touched])
        other = (self.mate(touching), touched, mate_radius[position, which, touched])
        return positions, (points, other)
