"""What a worn gear does in contact if the scan is read otherwise: with what it leaves open put on the flanks, each by itself, and run once more.

The geometry of the gear is what was measured, whether its teeth were cut thin or wore. So an even loss that may be thin teeth is open of the volume and of
nothing here; what is open here is what of the measured shape is the gear's, and which shape the flanks have that tell where it lies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import partial

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.contributions import flank_levels, pattern_fields, side_fields, side_points
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.comparison.worn_pair import ToothSides, beside_mate, mesh_of_scanned
from gearwear.design.pair import Design
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.diagnose.effects.base import MEASURED
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.path import PathOfContact
from gearwear.meshing.spread import ContactSpread
from gearwear.processors import each
from gearwear.wear.breakage import without_broken
from gearwear.wear.regions import Wear


class ReadOtherwise(StrEnum):
    """What leaves open what the gear does in contact, as the report has it."""

    SIDES = "the scan does not decide which sides are worn throughout"
    PATTERN = "a form that no effect explains: whether it is the gear's or the scanner's, the scan does not tell"
    CARRIED = "a form of one side that no effect explains: whether the worn side has it too, the scan does not tell"
    EITHER = "an effect of the maker that may be the scanner's, or the other way round"
    TOGETHER = "effects that take each other back: whether those of the scanner among them are the gear's, the scan does not tell"
    UNSURE = "flanks of sides that look worn throughout: how much they have lost is not known well enough"
    VIEWS = "views that were put together in one file and lie apart on some teeth"


SAME = 1e-9
"""mm, by which rounding lets two contacts differ."""
ON_BACKLASH = np.array([0.0, 1.0, 1.0, 0.0])
"""Of `ContactNumbers`, what the level of both flanks together moves."""


@dataclass(frozen=True, slots=True)
class ContactNumbers:
    """What is told of a contact.

    Parameters
    ----------
    transmission_error : float
        Peak to peak, mm.
    backlash_greatest, backlash_least : float
        Normal, mm.
    contact_ratio : float
    """

    transmission_error: float
    backlash_greatest: float
    backlash_least: float
    contact_ratio: float

    @classmethod
    def of(cls, contact: ContactResult, path: PathOfContact) -> ContactNumbers:
        """Those of a contact, on the path of the design."""
        te = 1e-3 * contact.peak_to_peak_um
        return cls(te, contact.backlash_max.value, contact.backlash_min.value, contact.contact_ratio_on(path))

    @property
    def values(self) -> Floats:
        """In this order."""
        return np.array([self.transmission_error, self.backlash_greatest, self.backlash_least, self.contact_ratio])


Ways = tuple[tuple[ReadOtherwise, tuple[ContactNumbers, ...]], ...]
"""What is open of a reading of the scan, and the contact with it taken the other way, or ways."""


@dataclass(frozen=True, slots=True)
class ContactReading:
    """The scan with other sides worn throughout.

    Parameters
    ----------
    itself : ContactNumbers
    level : float
        Standard deviation of how far its drive and coast flanks may be off together, mm.
    ways : Ways
    """

    itself: ContactNumbers
    level: float
    ways: Ways


@dataclass(frozen=True, slots=True)
class OtherReadings:
    """How else the scan may be read.

    Parameters
    ----------
    ways : Ways
        With the sides that are told to be worn throughout.
    others : tuple of ContactReading
        With other sides.
    """

    ways: Ways = ()
    others: tuple[ContactReading, ...] = ()


@dataclass(frozen=True, slots=True)
class ContactLimits:
    """Within what limits the numbers of a contact lie, their own 95 % intervals with them.

    Parameters
    ----------
    low, high : ContactNumbers
    why : tuple of ReadOtherwise
        What leaves them open.
    """

    low: ContactNumbers
    high: ContactNumbers
    why: tuple[ReadOtherwise, ...]


def contact_limits(told: ContactNumbers, read: OtherReadings, spread: ContactSpread | None) -> ContactLimits | None:
    """Within what limits the numbers of a contact lie; None where that is no more than their own 95 % intervals.

    Parameters
    ----------
    told : ContactNumbers
    read : OtherReadings
    spread : ContactSpread or None
        Standard deviations of what is told; those of other readings are taken to be as large, but for the level of their flanks.

    Notes
    -----
    What is open of one reading may be so or not, each by itself: what takes away adds up to one limit, what adds to the other. Of the readings one is true.
    """
    own = np.zeros(4) if spread is None else np.array([*spread_of(spread), 0.0])
    within = NORMAL_95 * own + SAME
    below, above = _beside(told, read.ways)
    ends = [(told.values - below - NORMAL_95 * own, told.values + above + NORMAL_95 * own)]
    why = []
    for reading in read.others:
        below, above = _beside(reading.itself, reading.ways)
        reach = NORMAL_95 * np.hypot(own, reading.level * ON_BACKLASH)
        ends.append((reading.itself.values - below - reach, reading.itself.values + above + reach))
        if (np.abs(reading.itself.values - told.values) > within).any():
            why.append(ReadOtherwise.SIDES)
    for what, numbers in read.ways:
        if any((np.abs(way.values - told.values) > within).any() for way in numbers):
            why.append(what)
    if not why:
        return None
    low, high = np.min([one for one, _ in ends], axis=0), np.max([one for _, one in ends], axis=0)
    low = np.where(ON_BACKLASH > 0.0, low, np.maximum(low, 0.0))
    return ContactLimits(ContactNumbers(*low.tolist()), ContactNumbers(*high.tolist()), tuple(dict.fromkeys(why)))


def spread_of(spread: ContactSpread) -> tuple[float, float, float]:
    """Standard deviations in the order of `ContactNumbers`; that of a contact ratio is not known."""
    return spread.transmission_error, spread.backlash_greatest, spread.backlash_least


def _beside(told: ContactNumbers, ways: Ways) -> tuple[Floats, Floats]:
    """By how much less and more each number may be by what is open of a reading."""
    below = above = np.zeros(4)
    for _, numbers in ways:
        change = np.array([way.values for way in numbers]) - told.values
        below, above = below + np.maximum(-change.min(axis=0), 0.0), above + np.maximum(change.max(axis=0), 0.0)
    return below, above


@dataclass(frozen=True, slots=True)
class ReadGear:
    """The scanned gear by one reading of the scan.

    Parameters
    ----------
    measured : MeasuredGear
    wear : Wear
    depth : (teeth, 2, rows, fillet + flank) float
        What is missing, smooth, mm.
    unworn_seen : bool
        Whether the wear is counted from a scan of the gear unworn.
    """

    measured: MeasuredGear
    wear: Wear
    depth: Floats
    unworn_seen: bool = False

    def sides(self) -> ToothSides:
        """Its tooth sides, less what is broken off them."""
        grid = self.measured.cells.grid
        made = side_fields(self.measured, (), None if self.unworn_seen else self.wear).made
        return ToothSides.of(grid, without_broken(self.depth, self.measured.broken, grid), self.wear.side_maps.area, made)


def other_readings(design: Design, told: ReadGear, others: Sequence[ReadGear], path: PathOfContact) -> OtherReadings:
    """What the scan leaves open of the contact; nothing is run where it leaves nothing open.

    Parameters
    ----------
    design : Design
    told : ReadGear
        The flanks that carry are those of it.
    others : sequence of ReadGear
        With other sides worn throughout that the scan does not exclude.
    path : PathOfContact
        Of the design.
    """
    calls, of = list[partial[ContactNumbers]](), list[tuple[int, ReadOtherwise | None]]()
    for number, one in enumerate((told, *others)):
        fields = list[tuple[ReadOtherwise | None, Floats | float]](ways_to_read(one.measured, one.wear))
        if number:
            fields.append((None, 0.0))
        if not fields:
            continue
        sides = one.sides()
        for what, field in fields:
            calls.append(partial(numbers_with, design, one.measured, sides, field, told.wear.drive_side, path))
            of.append((number, what))
    found = dict[tuple[int, ReadOtherwise | None], tuple[ContactNumbers, ...]]()
    for which, numbers in zip(of, each(calls), strict=True):
        found[which] = (*found.get(which, ()), numbers)

    def ways(number: int) -> Ways:
        return tuple((what, numbers) for (gear, what), numbers in found.items() if gear == number and what is not None)

    readings = (
        ContactReading(found[number, None][0], sum(other.measured.level_std), ways(number))
        for number, other in enumerate(others, start=1)
    )
    return OtherReadings(ways(0), tuple(readings))


def numbers_with(
    design: Design, gear: MeasuredGear, sides: ToothSides, field: Floats | float, side: Side, path: PathOfContact
) -> ContactNumbers:
    """Of the scanned gear with so much more metal on its tooth sides, mm, of which `side` carries."""
    in_order = beside_mate(design, gear)
    return ContactNumbers.of(mesh_of_scanned(design, gear, in_order(sides.profiles(field)), side), path)


def ways_to_read(measured: MeasuredGear, wear: Wear) -> list[tuple[ReadOtherwise, Floats]]:
    """What is open, and by how much the tooth sides then stand higher, (teeth, 2, rows, fillet + flank) mm."""
    loop, grid = measured.loop, measured.cells.grid
    if loop is None:
        return []
    ways = list[tuple[ReadOtherwise, Floats]]()
    if loop.patterns:
        everywhere, beside = pattern_fields(measured)
        ways.append((ReadOtherwise.PATTERN, everywhere + beside))
        if beside.any() and measured.worn_sides:
            worn = [side.index for side in measured.worn_sides]
            carried = np.zeros_like(beside)
            carried[:, worn] = beside[:, [1 - index for index in worn]]
            ways += [(ReadOtherwise.CARRIED, sign * carried) for sign in (1.0, -1.0)]
    scanners = [effect for effect in loop.form if effect.evidence.taken_back and loop.stands_as(effect) in MEASURED]
    if scanners or loop.either:
        points = side_points(grid)
    if scanners:
        fields = [loop.as_other(effect, points) for effect in scanners]
        ways.append((ReadOtherwise.TOGETHER, np.sum(fields, axis=0).reshape(grid.side_shape)))
    if loop.either:
        ways += [(ReadOtherwise.EITHER, loop.as_other(effect, points).reshape(grid.side_shape)) for effect in loop.either]
    if wear.unsure > wear.volume_std:
        ways.append((ReadOtherwise.UNSURE, _as_they_lie(measured, wear)))
    if (apart := measured.layered).any() and wear.mask[apart].any():
        ways.append((ReadOtherwise.VIEWS, np.where(apart[:, None, None, None], np.where(wear.mask, wear.depth, 0.0), 0.0)))
    return ways


def _as_they_lie(measured: MeasuredGear, wear: Wear) -> Floats:
    """How high the flanks of sides worn throughout lie whose loss is not told, each in its median; (teeth, 2, rows, fillet + flank) mm."""
    grid, sheets = measured.cells.grid, wear.side_maps
    untold: Bools = np.asarray(~wear.mask.any(axis=(2, 3)), dtype=np.bool_)
    untold[:, [side.index for side in Side if side not in measured.worn_sides]] = False
    return grid.sides(grid.on_flanks(np.where(untold, flank_levels(sheets.deviation, sheets.fillet), 0.0)))
