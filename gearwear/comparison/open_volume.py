"""What leaves the worn volume open: limits beside the value and its standard deviation, and their causes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.design.twist import normal_loss
from gearwear.diagnose.no_datum import most_lost
from gearwear.wear.limits import common_loss, even_depth, even_part
from gearwear.wear.regions import Wear, WearRegion
from gearwear.wear.tooth_summary import DriftSeam

HOLLOW = 2.0
"""How deep a hollow is in its mean depth."""


class Open(StrEnum):
    """What leaves the worn volume open, as the report has it."""

    SIDES = "the scan does not decide which sides are worn throughout"
    VIEWS = "views that were put together in one file and lie apart on some teeth: what is missing there may be that"
    PITS = "pits or grooves on other flanks, too few there to be told from strays"
    SEAM = "pitch errors that step in a worn tooth may be a drift of the scan that began there: its flanks are then further apart, or nearer, than they look"
    UNSEEN = "worn flanks of which no tooth was seen whole: what is missing where nothing was seen is not in the value"
    RIDGE = "worn flanks that stand proud of the design at the pitch line: cut thicker, or raised there by plastic flow, the scan does not tell"
    FAINT = "wear shallower than the limits of detection of its flanks"
    UNSURE = "flanks of sides that look worn throughout: how high they stood as made is not known well enough"
    FORM = "a form that all teeth have and no effect explains: cut or worn, the scan does not tell"
    BARE = "flanks of which all have a form, and without which the scan has nothing that holds the gear: cut or worn, it does not tell"
    THIN = "teeth thinner than drawn: cut so, or worn evenly, the scan does not tell"
    EVEN = "the same loss all over the flanks of a worn side: worn evenly, or cut thinner, the scan does not tell"
    TOLERANCE = "tolerance of the tooth thickness: an even loss of whole flanks cannot be told from it"


@dataclass(frozen=True, slots=True)
class OpenPart:
    """One of these.

    Parameters
    ----------
    what : Open
    below, above : float
        How much less and more the volume may be by it, mm³.
    """

    what: Open
    below: float
    above: float


@dataclass(frozen=True)
class OpenVolume:
    """The wear of a scan and what else it may be.

    Parameters
    ----------
    measured : MeasuredGear
    found : Wear
    undecided : tuple of (float, float)
        Worn volume and its standard deviation, mm³, with other sides worn throughout that the scan does not exclude.
    unworn_seen : bool
        Whether a scan of the gear before wear shows what was made so.
    seam : DriftSeam or None
        The tooth that is told too thin or too thick were pitch errors a drift of the scan.
    """

    measured: MeasuredGear
    found: Wear
    undecided: tuple[tuple[float, float], ...]
    unworn_seen: bool = False
    seam: DriftSeam | None = None

    @cached_property
    def limits(self) -> tuple[float, float, str] | None:
        """`of_such_teeth`, and beyond them what the teeth would have lost were it wear that made them as thin as they were measured."""
        known, thin = self.of_such_teeth, self.measured_thinning
        if thin == 0.0:
            return known
        value, own = self.found.volume, NORMAL_95 * self.found.volume_std
        low, high, causes = known or (max(value - own, 0.0), value + own, "")
        why = "the thinning of the design was measured on a gear that may be worn: cut so, or worn evenly, the scan does not tell"
        return low, high + thin, "; ".join(filter(None, (causes, why)))

    @cached_property
    def of_such_teeth(self) -> tuple[float, float, str] | None:
        """Within what limits the worn volume lies, mm³, its own 95 % interval with them, and what leaves it open (`causes`). None where nothing does."""
        if not self.causes:
            return None
        value, own = self.found.volume, NORMAL_95 * self.found.volume_std
        low = value - max(sum(cause.below for cause in self.causes), own)
        high = value + max(sum(cause.above for cause in self.causes), own)
        return max(low, 0.0), high, "; ".join(str(cause.what) for cause in self.causes)

    @cached_property
    def causes(self) -> tuple[OpenPart, ...]:
        """What leaves the volume open: a stated tolerance, an even loss; a scan that does not decide which sides are worn throughout, what each answer would
        be (95 %); teeth on which views lie apart; a worn tooth where the scan may have begun; pits too few to be told from strays; where it may be more than the 95 % interval, wear too faint to be
        found; and where they may be more than the standard deviation, flanks not seen whole, sides worn throughout whose loss is not sure, a form of all
        teeth that nothing explains, any form of flanks that are no datum, teeth thinner than drawn, and what may be thicker teeth or a ridge at the pitch line."""
        value, std = self.found.volume, self.found.volume_std
        causes = list[OpenPart]()
        below = above = 0.0
        if self.undecided:
            below = max(0.0, *(value - other + NORMAL_95 * its for other, its in self.undecided))
            above = max(0.0, *(other + NORMAL_95 * its - value for other, its in self.undecided))
            causes.append(OpenPart(Open.SIDES, below, above))
        if self.layered > 0.0:  # another answer, and not one beside the others; nor is a form of flanks that are no datum
            causes.append(OpenPart(Open.VIEWS, max(self.layered - below, 0.0), 0.0))
        if any(self.at_seam):
            causes.append(OpenPart(Open.SEAM, *self.at_seam))
        if self.found.hidden_pits > 0.0:
            causes.append(OpenPart(Open.PITS, 0.0, self.found.hidden_pits))
        if self.found.unseen > std:
            causes.append(OpenPart(Open.UNSEEN, 0.0, self.found.unseen))
        if any(self.ridge_or_thick):
            causes.append(OpenPart(Open.RIDGE, *self.ridge_or_thick))
        for why, more in (
            (Open.FAINT, self.too_faint), (Open.UNSURE, self.unsure_or_worn), (Open.FORM, self.form_or_wear),
            (Open.BARE, max(self.bare_or_worn - above, 0.0)), (Open.THIN, self.thin_or_worn),
        ):  # fmt: skip
            if more > 0.0:
                causes.append(OpenPart(why, 0.0, more))
        if self.even_or_thin > 0.0:
            causes.append(OpenPart(Open.EVEN, self.even_or_thin, 0.0))
        open_ = even_loss(self.measured, self.found)
        if open_ is not None and not self.unworn_seen:
            causes.append(OpenPart(Open.TOLERANCE, open_, open_))
        return tuple(causes)

    @cached_property
    def widest(self) -> Open | None:
        """What leaves most of the volume open; wear too faint to be found only where nothing else does. None where the limits are no more than its own
        95 % interval."""
        limits, own = self.of_such_teeth, NORMAL_95 * self.found.volume_std * (1.0 + 1e-9)
        if limits is None or max(self.found.volume - limits[0], limits[1] - self.found.volume) <= own:
            return None
        open_ = [cause for cause in self.causes if cause.below + cause.above > 0.0]
        return max(open_, key=lambda cause: (cause.what is not Open.FAINT, cause.below + cause.above)).what

    @property
    def layered(self) -> float:
        """What of the volume lies on teeth on which views lie apart, mm³."""
        apart = self.measured.layered
        return sum(region.volume for region in self.found.regions if apart[region.tooth])

    @property
    def at_seam(self) -> tuple[float, float]:
        """By how much less and more the worn flanks of the tooth have lost in which a drift of the scan may have begun, mm³: as much of their depth as the tooth is
        told too thin, no more than was found, or too thick, and the 95 % interval of what is left; 0 where that is within the volume's standard deviation."""
        if self.seam is None or self.unworn_seen:
            return 0.0, 0.0
        own = [region for region in self.found.regions if region.tooth == self.seam.tooth]
        depth = normal_loss(self.measured.gear, abs(self.seam.thicker))
        thin = self.seam.thicker > 0.0
        # Both flanks together stand apart by that depth: what one has of it the other has not.
        by = max((min(region.volume, depth * region.area) if thin else depth * region.area for region in own), default=0.0)
        std = self.found.volume_std
        far = by + NORMAL_95 * std if by > std else 0.0
        return (far, 0.0) if thin else (0.0, far)

    @property
    def ridge_or_thick(self) -> tuple[float, float]:
        """By how much less and more the worn sides may have lost, mm³, as what stands proud at the pitch line may be a ridge or thicker teeth; 0 where that
        is within the volume's standard deviation."""
        less, more = (depth * self._side_area for depth in self.found.level_open)
        std = self.found.volume_std
        return less if less > std else 0.0, more if more > std else 0.0

    @property
    def too_faint(self) -> float:
        """What wear too faint to be found may come to, mm³; 0 where that is within the volume's 95 % interval, or where more is open of the same flanks."""
        faint = self.found.faint
        return faint if faint > NORMAL_95 * self.found.volume_std and self.unsure_or_worn == 0.0 else 0.0

    @property
    def form_or_wear(self) -> float:
        """What a form that all teeth have and no effect explains, or only effects that take each other back, would come to were it wear, mm³; 0 where
        that is within the volume's standard deviation, and where a scan of the gear unworn shows what was made so."""
        loop, grid = self.measured.loop, self.measured.cells.grid
        if loop is None or self.unworn_seen:
            return 0.0
        known = self.measured.worn_sides | loop.no_datum  # of these all that they share is open
        lost = common_loss(self.found.side_maps, grid.sides(loop.without_a_name), grid.toothed, known)
        if lost <= self.found.volume_std:
            return 0.0
        # How high the sides stand that did not wear is known to that of their level.
        return lost + NORMAL_95 * self._side_area * max(loop.level_std)

    @cached_property
    def bare_or_worn(self) -> float:
        """What all flanks of a side have in common that is no datum and may be worn throughout would come to were it wear, whatever name it has, mm³; 0 where
        that is within the volume's standard deviation, and where a scan of the gear unworn shows what was made so."""
        loop, cells = self.measured.loop, self.measured.cells
        if loop is None or self.unworn_seen or not loop.no_datum:
            return 0.0
        grid, sheets = cells.grid, self.found.side_maps
        depth = np.nan_to_num(most_lost(loop, cells)[[side.index for side in loop.no_datum]][:, grid.toothed])
        lost = float((depth * sheets.area[sheets.fillet :]).sum()) * grid.gear.teeth
        # How high the side stands as a whole has no part in it: that is a turn of the gear.
        return lost if lost > self.found.volume_std else 0.0

    @property
    def unsure_or_worn(self) -> float:
        """What flanks of sides worn throughout may have lost whose loss is not in the volume, mm³; 0 where that is within its standard deviation, or
        no more than wear too faint to be found."""
        found = self.found
        return found.unsure if found.unsure > max(found.volume_std, found.faint) else 0.0

    @property
    def thin_or_worn(self) -> float:
        """What the teeth would have lost were they worn evenly to where they are, and not cut thinner than drawn, mm³; 0 where that is within the
        volume's standard deviation, and where a scan of the gear unworn shows what was made so."""
        if self.measured.loop is None or self.unworn_seen or self.measured.faces:  # what no mate touched is as thin
            return 0.0
        cells = self.measured.cells
        depth = self.measured.loop.thinner_by(cells.points.take(cells.seen & (cells.points.surface == FLANK)))
        lost = depth * len(Side) * self._side_area
        return lost if lost > self.found.volume_std else 0.0

    @cached_property
    def measured_thinning(self) -> float:
        """What the teeth would have lost were the thinning of the design an even loss, mm³, with 1.96 standard deviations of how high their flanks stand;
        0 where that is not open (`thinning_open`)."""
        loop, gear = self.measured.loop, self.measured.gear
        if not thinning_open(self.measured, self.unworn_seen):
            return 0.0
        unsure = 0.0 if loop is None else NORMAL_95 * sum(loop.level_std)
        return (normal_loss(gear, gear.spec.thinning) + unsure) * self._side_area

    @cached_property
    def even_or_thin(self) -> float:
        """What of the volume the sides worn throughout have lost all over alike, mm³; 0 where that is within the volume's standard deviation, where
        the tolerance of the thickness is stated, and where a scan of the gear unworn shows what was made so."""
        stated = self.measured.gear.spec.tolerance.thickness is not None
        if self.measured.loop is None or self.unworn_seen or stated or not level_open(self.measured):
            return 0.0
        lost = even_part(self.found.side_maps, level_open(self.measured), self.measured.cells.grid, self.measured.loop)
        return lost if lost > self.found.volume_std else 0.0

    def even_depth(self, side: Side) -> float:
        """How much of the depth of a worn flank its side has lost all over alike, mm, where that may be thinner teeth; 0 where it is none of that."""
        return self._even_depths.get(side, 0.0) if self.even_or_thin > 0.0 else 0.0

    @cached_property
    def _even_depths(self) -> dict[Side, float]:
        grid, loop = self.measured.cells.grid, self.measured.loop
        assert loop is not None
        return {side: even_depth(self.found.side_maps, side, grid, loop) for side in level_open(self.measured)}

    @property
    def evenly(self) -> tuple[float, float]:
        """What the limits of teeth as thin as the design's come to below and above the volume evenly over all flanks of one side, mm; 0 where that is no more
        than its own 95 % interval."""
        limits, own = self.of_such_teeth, NORMAL_95 * self.found.volume_std * (1.0 + 1e-9)
        if limits is None:
            return 0.0, 0.0
        down, up = (
            far / self._side_area if far > own else 0.0 for far in (self.found.volume - limits[0], limits[1] - self.found.volume)
        )
        return down, up

    def depth_limits(self, region: WearRegion) -> tuple[float, float] | None:
        """Within what limits the deepest place of a worn flank lies, mm, its own 95 % interval with them; None where no more than that is open.

        What its side may have been made like is known (`even_depth`), or is open of the volume: a hollow is up to twice as deep as on average.
        """
        (down, up), even = self.evenly, self.even_depth(region.side)
        below, above = even if even > 0.0 else HOLLOW * down, HOLLOW * up
        own = NORMAL_95 * region.max_depth_std if math.isfinite(region.max_depth_std) else 0.0
        if below <= own and above <= own:
            return None
        return max(region.max_depth - below - own, 0.0), region.max_depth + above + own

    @property
    def _side_area(self) -> float:
        """Of all flanks of one side, mm²."""
        grid = self.measured.cells.grid
        return self.found.side_maps.flank_row * grid.gear.teeth * int(grid.toothed.sum())


def level_open(measured: MeasuredGear) -> frozenset[Side]:
    """Sides worn throughout of which no flank shows beside where its mate ran how high it was made."""
    return measured.worn_sides - {face.side for face in measured.faces}


def thinning_open(measured: MeasuredGear, unworn_seen: bool) -> bool:
    """Whether the design's thinning may be an even loss: it was measured on a gear, and neither flanks that no mate touched nor a scan of the gear unworn are as thin."""
    spec = measured.gear.spec
    return spec.thinning_measured and spec.thinning > 0.0 and not unworn_seen and not measured.faces


def even_loss(measured: MeasuredGear, wear: Wear) -> float | None:
    """What the stated tolerance of the tooth thickness leaves open of the volume, mm³; None where none is stated or no side is worn throughout.

    Teeth that are thinner by it at the reference circle may have lost all of that on the flanks of one side.
    """
    tolerance = measured.gear.spec.tolerance.thickness
    if tolerance is None or not level_open(measured):
        return None
    area = sum(region.area for region in wear.regions if region.side in level_open(measured))
    return normal_loss(measured.gear, tolerance) * area
