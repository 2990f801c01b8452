"""Everything a comparison found, in frozen bundles: what the report is written from."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.consequences import Change
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.comparison.relocated import MEASURED
from gearwear.comparison.same_teeth import SameTeeth, TeethPattern
from gearwear.comparison.weighed import WeighedLoss, weighed_loss
from gearwear.design.card import Card, CardRow, counted, measured
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.found import FoundEffect, Loop
from gearwear.inspection.halves import Half
from gearwear.inspection.inspection import Inspection
from gearwear.loaded.study import LoadedStudy
from gearwear.meshing.backlash import Backlash, backlash_from_normal
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.published import PublishedMeshing
from gearwear.meshing.shafts import TakeUp
from gearwear.meshing.spread import ContactSpread
from gearwear.meshing.study import transmission_error_as_drawn
from gearwear.placing.pits import find_far_points
from gearwear.placing.pose import motion_columns
from gearwear.placing.refusal import SeenRadii
from gearwear.placing.registration import stray_limit
from gearwear.placing.strays import near_centre
from gearwear.running.found import SecondLoop
from gearwear.wear.breakage import Broken
from gearwear.wear.limits import common_loss, even_part
from gearwear.wear.regions import Wear, WearRegion
from gearwear.wear.solid import PlainBoolean, Solids
from gearwear.wear.thickness import SectionThickness, ThinnestTooth, ToothSummary
from gearwear.wear_law.study import WearStudy
from gearwear.wear_law.teeth import FittedLaw


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class WearResult(Card):
    """What is gone from the gear.

    Parameters
    ----------
    found : Wear
        Against the as-made gear.
    before_loop : Wear
        What it would have been without the loop.
    laws : tuple of FittedLaw
    thickness : SectionThickness
    worn : ToothProfiles
        The worn model: the design less the wear.
    present : ToothProfiles
        The gear as it is: manufacture and wear; what was run in mesh.
    solids : Solids or None
        None for a planar section.
    boolean : PlainBoolean or None
        Where the scan is watertight triangles.
    undecided : tuple of (float, float)
        Volume and its standard deviation, mm³, with other sides worn throughout, as far as the scan does not exclude them.
    """

    found: Wear
    before_loop: Wear
    laws: tuple[FittedLaw, ...]
    thickness: SectionThickness
    worn: ToothProfiles
    present: ToothProfiles
    solids: Solids | None
    boolean: PlainBoolean | None
    undecided: tuple[tuple[float, float], ...] = ()

    @property
    def regions(self) -> tuple[WearRegion, ...]:
        """Worn flanks, the largest first."""
        return self.found.regions

    @property
    def volume(self) -> float:
        """mm³; of a planar section the area, mm²."""
        return self.found.volume

    @property
    def volume_std(self) -> float:
        """Its standard deviation."""
        return self.found.volume_std

    @property
    def deepest(self) -> WearRegion | None:
        """The region that goes deepest; None without wear."""
        return max(self.regions, key=lambda region: region.max_depth, default=None)

    @property
    def thinnest(self) -> ThinnestTooth | None:
        """The least thickness of the gear; None where no tooth was seen on both sides."""
        return self.thickness.thinnest()

    @property
    def lost_most(self) -> ToothSummary | None:
        """The tooth that lost most against the as-made gear; None where none was seen."""
        seen = (t for t in self.thickness.teeth() if math.isfinite(t.greatest_loss))
        return max(seen, key=lambda t: t.greatest_loss, default=None)

    def headline(self) -> str:
        return self.found.headline()

    def rows(self) -> list[CardRow]:
        return [*self.found.rows(), ("thickness", self.thickness.headline())]


@dataclass(frozen=True, slots=True, kw_only=True)
class PairResult:
    """The pair on the design and on the worn model, housing fixed.

    Parameters
    ----------
    design : ExactMeshing
        Involute relations at the design's centre distance.
    published : PublishedMeshing or None
        The paper's calculation from the largest loss of thickness; None with a ring, which it does not know.
    contact : ContactResult
        Worn flanks in rigid contact over one revolution of the scanned gear; the mate is nominal.
    spread : ContactSpread or None
        Standard deviations of the contact's numbers; None where nothing is known of them.
    shafts : TakeUp or None
        How far the shafts can and would have to move to take the wear up; None where there is no loss.
    drive_side : Side
        Side that carries.
    law : WearStudy or None
        The wear law on that side of the scanned gear.
    loaded : LoadedStudy or None
        The same flanks under the design's load; None where it states none.
    running : SecondLoop or str
        How the pair ran, by the pattern of the wear; or why that was not looked for.
    """

    design: ExactMeshing
    published: PublishedMeshing | None
    contact: ContactResult
    spread: ContactSpread | None
    shafts: TakeUp | None
    drive_side: Side
    law: WearStudy | None
    loaded: LoadedStudy | None = None
    running: SecondLoop | str = ""

    @property
    def second_loop(self) -> SecondLoop | None:
        """How the pair ran; None where it was not looked for."""
        return None if isinstance(self.running, str) else self.running

    @property
    def greatest_backlash(self) -> Backlash:
        """Over the revolution."""
        return self._backlash(self.contact.backlash_max.value)

    @property
    def least_backlash(self) -> Backlash:
        """Over the revolution."""
        return self._backlash(self.contact.backlash_min.value)

    @property
    def greatest_backlash_std(self) -> Backlash | None:
        """Standard deviations of `greatest_backlash`; None where they are not known."""
        return None if self.spread is None else self._backlash(self.spread.backlash_greatest)

    @property
    def least_backlash_std(self) -> Backlash | None:
        """Standard deviations of `least_backlash`; None where they are not known."""
        return None if self.spread is None else self._backlash(self.spread.backlash_least)

    @property
    def transmission_error_as_drawn(self) -> float:
        """Of the pair as designed, mm peak to peak: 0 but for what the drawing modifies."""
        return transmission_error_as_drawn(self.contact.driver, self.contact.driven, self.design.centre_distance, self.drive_side)

    @property
    def contact_ratio(self) -> float:
        """Of the worn flanks."""
        return self.contact.contact_ratio_on(self.design.path)

    @property
    def path_length(self) -> float:
        """Length of contact of the worn flanks along the line of action, mm: contact ratio, less the overlap's, times base pitch."""
        path = self.design.path
        return max(self.contact_ratio - path.overlap_ratio, 0.0) * path.base_pitch

    def _backlash(self, normal: float) -> Backlash:
        return backlash_from_normal(self.contact.driver, self.contact.driven, self.design.centre_distance, normal)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Results(Card):
    """A finished comparison.

    Parameters
    ----------
    measured : MeasuredGear
        The scan on its design, with what scanner and maker added.
    seen : SeenRadii
        What the scan itself shows of the gear's size.
    wear : WearResult
    pair : PairResult or None
        None without a mate.
    inspection : Inspection or None
        None of a planar section, and of a double helical gear.
    halves : tuple of Inspection
        Of a double helical gear the inspections of the lower and the upper half; else empty.
    changes : tuple of Change
        What taking the effects out changed; empty where there was nothing to take out.
    notes : tuple of str
        Doubts, each a sentence.
    before_files : tuple of str
        Scans of the unworn gear the wear was measured against.
    before_sha256 : tuple of str
        Of these files.
    same_teeth : SameTeeth or None
        How the teeth of the unworn gear's scan were told; None without one.
    patterns : tuple of TeethPattern
        What the gear's teeth can be known again by.
    """

    measured: MeasuredGear
    seen: SeenRadii
    wear: WearResult
    pair: PairResult | None
    inspection: Inspection | None
    changes: tuple[Change, ...]
    notes: tuple[str, ...]
    before_files: tuple[str, ...]
    before_sha256: tuple[str, ...] = ()
    same_teeth: SameTeeth | None = None
    patterns: tuple[TeethPattern, ...] = ()
    halves: tuple[Inspection, ...] = ()

    @property
    def design(self) -> Design:
        return self.measured.design

    @property
    def part(self) -> str:
        """Which one was scanned, "pinion" or "gear"."""
        return self.measured.part

    @property
    def gear(self) -> Gear:
        """The scanned gear's design."""
        return self.measured.gear

    @property
    def loop(self) -> Loop | None:
        """What scanner, mounting and maker added; None where it was not looked for."""
        return self.measured.loop

    @property
    def volume_range(self) -> tuple[float, float, str] | None:
        """Within what limits the worn volume lies, mm³, and what leaves it open: a stated tolerance, an even loss; a scan that does not decide
        which sides are worn throughout, what each answer would be (95 %); pits too few to be told from strays; and where they may be more than the
        standard deviation, flanks not seen whole, wear too faint to be found, sides worn throughout whose loss is not sure, a form of all teeth that nothing explains, and teeth thinner than drawn.
        None where nothing does."""
        low = high = self.wear.volume
        causes = []
        if self.wear.undecided:
            low = min(low, *(value - NORMAL_95 * std for value, std in self.wear.undecided))
            high = max(high, *(value + NORMAL_95 * std for value, std in self.wear.undecided))
            causes.append("the scan does not decide which sides are worn throughout")
        if self.wear.found.hidden_pits > 0.0:
            high += self.wear.found.hidden_pits
            causes.append("pits or grooves on other flanks, too few there to be told from strays")
        if self.wear.found.unseen > self.wear.volume_std:
            high += self.wear.found.unseen
            causes.append(
                "worn flanks of which no tooth was seen whole: what is missing where nothing was seen is not in the value"
            )
        if self.wear.found.faint > self.wear.volume_std and self.unsure_or_worn == 0.0:
            high += self.wear.found.faint
            causes.append("wear shallower than the limits of detection of its flanks")
        if (unsure := self.unsure_or_worn) > 0.0:
            high += unsure
            causes.append("flanks of sides that look worn throughout: how high they stood as made is not known well enough")
        if (form := self.form_or_wear) > 0.0:
            high += form
            causes.append("a form that all teeth have and no effect explains: cut or worn, the scan does not tell")
        if (thin := self.thin_or_worn) > 0.0:
            high += thin
            causes.append("teeth thinner than drawn: cut so, or worn evenly, the scan does not tell")
        if (even := self.even_or_thin) > 0.0:
            low -= even
            causes.append("the same loss all over the flanks of a worn side: worn evenly, or cut thinner, the scan does not tell")
        open_ = even_loss(self.measured, self.wear.found)
        if open_ is not None and not self.before_files:
            low, high = low - open_, high + open_
            causes.append("tolerance of the tooth thickness: an even loss of whole flanks cannot be told from it")
        return (max(low, 0.0), high, "; ".join(causes)) if causes else None

    @property
    def form_or_wear(self) -> float:
        """What a form that all teeth have and no effect explains would come to were it wear, mm³; 0 where that is within the volume's standard
        deviation, and where a scan of the gear unworn shows what was made so."""
        if self.loop is None or self.before_files:
            return 0.0
        grid = self.measured.cells.grid
        maps = self.wear.found.side_maps
        lost = common_loss(maps, grid.sides(self.loop.form_of_all), grid.toothed, self.measured.worn_sides)
        if lost <= self.wear.volume_std:
            return 0.0
        # How high the sides stand that did not wear is known to that of their level.
        return lost + NORMAL_95 * self._side_area * max(self.loop.level_std)

    @property
    def unsure_or_worn(self) -> float:
        """What flanks of sides worn throughout may have lost whose loss is not in the volume, mm³; 0 where that is within its standard deviation, or
        no more than wear too faint to be found."""
        found = self.wear.found
        return found.unsure if found.unsure > max(self.wear.volume_std, found.faint) else 0.0

    @property
    def thin_or_worn(self) -> float:
        """What the teeth would have lost were they worn evenly to where they are, and not cut thinner than drawn, mm³; 0 where that is within the
        volume's standard deviation, and where a scan of the gear unworn shows what was made so."""
        if self.loop is None or self.before_files:
            return 0.0
        cells = self.measured.cells
        depth = self.loop.thinner_by(cells.points.take(cells.seen & (cells.points.surface == FLANK)))
        lost = depth * len(Side) * self._side_area
        return lost if lost > self.wear.volume_std else 0.0

    @property
    def even_or_thin(self) -> float:
        """What of the volume the sides worn throughout have lost all over alike, mm³; 0 where that is within the volume's standard deviation, where
        the tolerance of the thickness is stated, and where a scan of the gear unworn shows what was made so."""
        stated = self.gear.spec.tolerance.thickness is not None
        if self.loop is None or self.before_files or stated or not self.measured.worn_sides:
            return 0.0
        toothed = self.measured.cells.grid.toothed
        lost = even_part(self.wear.found.side_maps, self.measured.worn_sides, self.loop.as_made_std, toothed)
        return lost if lost > self.wear.volume_std else 0.0

    @property
    def _side_area(self) -> float:
        """Of all flanks of one side, mm²."""
        grid = self.measured.cells.grid
        return self.wear.found.side_maps.flank_row * grid.gear.teeth * int(grid.toothed.sum())

    @property
    def pieces(self) -> tuple[Broken, ...]:
        """What is broken off."""
        return tuple(piece for piece in self.measured.broken if piece.seen)

    @property
    def broken_volume(self) -> tuple[float, float]:
        """Metal that is broken off, mm³, and its standard deviation."""
        return sum(piece.volume for piece in self.pieces), math.hypot(*(piece.std for piece in self.pieces))

    @property
    def lost_volume(self) -> tuple[float, float]:
        """Metal that is gone, worn off or broken off, mm³, and its standard deviation."""
        volume, std = self.broken_volume
        return self.wear.volume + volume, math.hypot(self.wear.volume_std, std)

    @property
    def weighed(self) -> WeighedLoss | None:
        """The weighed loss beside the scanned one; None where nothing was weighed, and for a planar section."""
        if self.design.weighing is None or self.planar:
            return None
        open_ = self.volume_range
        broken = self.broken_volume[0]
        limits = None if open_ is None else (open_[0] + broken, open_[1] + broken)
        return weighed_loss(self.design.weighing, self.lost_volume, limits)

    @property
    def planar(self) -> bool:
        """True for a planar section."""
        return self.measured.planar

    @property
    def effects(self) -> tuple[FoundEffect, ...]:
        """Effects found besides wear, in the order added."""
        return () if self.loop is None else tuple(effect for effect in self.loop.effects if effect.kind is not Kind.WEAR)

    @property
    def rms_left(self) -> float:
        """RMS outside the wear with all that was found taken out, mm; as it was, where nothing was looked for."""
        return self.plain_rms if self.loop is None else self.loop.rms_after

    @property
    def plain_rms(self) -> float:
        """RMS of cell means and scatter outside the wear, mm: what the loop would call before."""
        cells = self.measured.cells
        outside = ~self.wear.found.mask
        parts = [cells.grid.sides(values)[outside] for values in (cells.points.deviation, cells.scatter, cells.count)]
        deviation, scatter, count = (np.nan_to_num(part) for part in parts)
        return math.sqrt(float(((deviation**2 + scatter**2) * count).sum()) / max(float(count.sum()), 1.0))

    @property
    def corrected_deviation(self) -> Floats:
        """Deviation of every located point with the measurement effects, and the motion that goes with them, taken out, (n,) mm."""
        return self.corrected(self.measured.placed.located)

    def corrected(self, located: SurfacePoints) -> Floats:
        """The same of other points of the scan, located before the motion that the loop found."""
        if self.loop is None:
            return located.deviation.copy()
        moved = motion_columns(located.position, located.normal) @ self.loop.motion
        return np.asarray(located.deviation - self.loop.deviation(located, MEASURED) - moved, dtype=np.float64)

    def located_chunks(self) -> Iterator[SurfacePoints]:
        """All points of the scan as `corrected` takes them: at once, or of a streamed scan chunk by chunk."""
        streamed = self.measured.streamed
        return iter((self.measured.placed.located,)) if streamed is None else streamed.located()

    @property
    def strays(self) -> Bools:
        """Which of the located points lie too far from their neighbours to be of the gear, (n,); those of small pits do not."""
        located, grid = self.measured.placed.located, self.measured.cells.grid
        near = near_centre(located.deviation, grid.index(located), grid, stray_limit(located))
        return ~(near | find_far_points(located, grid)[1])

    def headline(self) -> str:
        size = measured(self.wear.volume, self.wear.volume_std, "mm²" if self.planar else "mm³")
        return f"{self.part} of {self.gear.teeth} teeth, {size} worn off in {counted(len(self.wear.regions), 'region')}"

    def rows(self) -> list[CardRow]:
        rows = [("registration", self.measured.placed.registration.headline())]
        if self.loop is not None:
            names = ", ".join(effect.name for effect in self.loop.effects)
            rows += [("loop", self.loop.headline()), ("effects", names or "none")]
        rows += [("wear", self.wear.headline()), ("thickness", self.wear.thickness.headline())]
        if self.pair is not None:
            rows.append(("meshing", self.pair.contact.headline()))
        if self.inspection is not None:
            rows.append(("inspection", self.inspection.headline()))
        rows += [(f"{half} half", inspection.headline()) for half, inspection in zip(Half, self.halves, strict=False)]
        return rows + [("note", note) for note in self.notes]


def even_loss(measured: MeasuredGear, wear: Wear) -> float | None:
    """What the stated tolerance of the tooth thickness leaves open of the volume, mm³; None where none is stated or no side is worn throughout.

    Teeth that are thinner by T at the reference circle, all of it on one side, have lost ``T r_b / r · cos β_b / cos β`` along the normal all over its flanks.
    """
    tolerance = measured.gear.spec.tolerance.thickness
    if tolerance is None or not measured.worn_sides:
        return None
    gear = measured.gear
    area = sum(region.area for region in wear.regions if region.side in measured.worn_sides)
    per_arc = gear.base_helix_cosine / math.cos(gear.helix_angle)  # the tolerance is of the normal arc
    return tolerance * gear.base_radius / gear.reference_radius * per_arc * area
