"""Everything a comparison found, in frozen bundles: what the report is written from."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.consequences import Change
from gearwear.comparison.contact_readings import ContactLimits
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.comparison.open_sizes import size_limits
from gearwear.comparison.open_volume import Open, OpenVolume
from gearwear.comparison.same_teeth import SameTeeth, TeethPattern
from gearwear.comparison.weighed import WeighedLoss, weighed_loss
from gearwear.design.card import Card, CardRow, measured
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.design.quantity import counted, significant
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import MEASURED, Kind
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
from gearwear.placing.in_cells import InCells
from gearwear.placing.pose import motion_columns
from gearwear.placing.refusal import SeenRadii
from gearwear.placing.registration import stray_limit
from gearwear.running.found import SecondLoop
from gearwear.wear.breakage import Broken
from gearwear.wear.regions import UNIT, Wear, WearRegion
from gearwear.wear.solid import PlainBoolean, Solids
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.tooth_summary import ThinnestTooth, ToothSummary
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
    limits : ContactLimits or None
        Within what limits the contact's numbers lie where more is open of them than their standard deviations; None where nothing is.
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
    limits: ContactLimits | None = None

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
        return self._path_of(self.contact_ratio)

    @property
    def open_backlash(self) -> tuple[tuple[Backlash, Backlash], tuple[Backlash, Backlash]] | None:
        """Lowest and highest of `greatest_backlash`, and of `least_backlash`, where they are open."""
        if self.limits is None:
            return None
        low, high = self.limits.low, self.limits.high
        greatest = self._backlash(low.backlash_greatest), self._backlash(high.backlash_greatest)
        return greatest, (self._backlash(low.backlash_least), self._backlash(high.backlash_least))

    @property
    def open_greatest(self) -> tuple[float, float] | None:
        """Lowest and highest of the greatest circumferential backlash, mm, where it is open."""
        open_ = self.open_backlash
        return None if open_ is None else (open_[0][0].circumferential, open_[0][1].circumferential)

    @property
    def open_error_um(self) -> tuple[float, float] | None:
        """Lowest and highest of the transmission error, peak to peak, µm, where it is open."""
        if self.limits is None:
            return None
        return 1e3 * self.limits.low.transmission_error, 1e3 * self.limits.high.transmission_error

    @property
    def open_ratio(self) -> tuple[float, float] | None:
        """Lowest and highest of `contact_ratio`, where it is open."""
        return None if self.limits is None else (self.limits.low.contact_ratio, self.limits.high.contact_ratio)

    @property
    def open_path(self) -> tuple[float, float] | None:
        """Lowest and highest of `path_length`, mm, where it is open."""
        if self.limits is None:
            return None
        return self._path_of(self.limits.low.contact_ratio), self._path_of(self.limits.high.contact_ratio)

    def _path_of(self, contact_ratio: float) -> float:
        path = self.design.path
        return max(contact_ratio - path.overlap_ratio, 0.0) * path.base_pitch

    def _backlash(self, normal: float) -> Backlash:
        return backlash_from_normal(self.contact.driver, self.contact.driven, self.design.centre_distance, normal)


@dataclass(frozen=True, kw_only=True, repr=False)
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

    @cached_property
    def open_volume(self) -> OpenVolume:
        """What leaves the worn volume open."""
        return OpenVolume(self.measured, self.wear.found, self.wear.undecided, bool(self.before_files), self.wear.thickness.seam)

    @property
    def volume_range(self) -> tuple[float, float, str] | None:
        """Within what limits the worn volume lies, and why; see `OpenVolume.limits`."""
        return self.open_volume.limits

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

    def open_sizes(self, effect: FoundEffect) -> dict[str, tuple[float, float]]:
        """Within what limits sizes of an effect lie where it hangs on which sides are worn throughout; see `size_limits`."""
        return {} if self.loop is None or self.before_files else size_limits(self.loop, effect)

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
        return ~InCells.of(located, grid, stray_limit(located)).means()[1]

    def headline(self) -> str:
        open_, limits, unit = "", self.volume_range, UNIT[self.planar]
        if limits is not None and self.open_volume.widest not in (None, Open.FAINT):
            open_ = f" ({significant(limits[0], 2)} to {significant(limits[1], 2)} {unit} are not excluded)"
        if not self.wear.regions:
            return f"{self.part} of {self.gear.teeth} teeth, no wear found{open_}"
        size = measured(self.wear.volume, self.wear.volume_std, unit)
        return f"{self.part} of {self.gear.teeth} teeth, {size} worn off in {counted(len(self.wear.regions), 'region')}{open_}"

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
