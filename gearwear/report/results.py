"""Everything a comparison found, in one frozen bundle: what the report is written from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gearwear.arrays import Floats
from gearwear.card import Card, Row, counted, measured
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.diagnose.loop import Loop
from gearwear.measure.cells import Cells
from gearwear.measure.inspection.inspection import Inspection
from gearwear.measure.pose import Pose
from gearwear.measure.thickness import SectionThickness
from gearwear.measure.views import PlacedScan
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.published import PublishedMeshing
from gearwear.meshing.shafts import TakeUp
from gearwear.meshing.spread import ContactSpread
from gearwear.meshing.wear_fit import WearFit
from gearwear.meshing.wear_forecast import CyclesLeft, Quantity, WearForecast
from gearwear.scan.types import Scan
from gearwear.wear.laws import FittedLaw
from gearwear.wear.regions import Wear
from gearwear.wear.solid import Triangles

if TYPE_CHECKING:
    from gearwear.report.arrays import ReportArrays


@dataclass(frozen=True, slots=True)
class Ahead:
    """What to forecast from the wear law.

    Parameters
    ----------
    cycles_run : float
        Mesh cycles of the gear so far: its own revolutions, for one mate.
    cycles : tuple of float
        Cycles since new for which to forecast, none below `cycles_run`.
    limits : tuple of (quantity, float)
        Limits in mm: greatest "depth" on the flank, loss of "thickness" (arc at the reference circle), growth of the normal "backlash".
    """

    cycles_run: float
    cycles: tuple[float, ...] = ()
    limits: tuple[tuple[Quantity, float], ...] = ()


@dataclass(frozen=True, slots=True)
class CyclesToLimit:
    """Cycles from now until `quantity` reaches `limit` (mm), with its band."""

    quantity: Quantity
    limit: float
    left: CyclesLeft


@dataclass(frozen=True, slots=True)
class WearStudy:
    """The wear law on the mean profile of one side, and what it says of the time ahead.

    Parameters
    ----------
    side : int
        +1 left, −1 right.
    teeth, left_out : tuple of int
        0-based: in the mean; worn too, but unlike the others.
    fits : tuple of WearFit
        The best first; empty where none was possible.
    why_not : str
        What kept the law from being fitted, or the forecast from being made; "" where nothing did.
    forecast : WearForecast or None
        At the cycles run and those asked for; None where none was asked for, or possible.
    left : tuple of CyclesToLimit
        One per limit asked for.
    volume_share : float
        Part of all the volume lost that the flanks in the mean lost.
    """

    side: int
    teeth: tuple[int, ...]
    left_out: tuple[int, ...]
    fits: tuple[WearFit, ...]
    why_not: str
    forecast: WearForecast | None = None
    left: tuple[CyclesToLimit, ...] = ()
    volume_share: float = 0.0


@dataclass(frozen=True, slots=True)
class MeshingStudy:
    """The pair on the design and on the worn model, housing fixed.

    Parameters
    ----------
    design : ExactMeshing
        Involute relations at the design's centre distance.
    published : PublishedMeshing
        The paper's calculation from the largest loss of thickness.
    contact : ContactResult
        Worn flanks in rigid contact over one revolution of the pinion; the mate is nominal.
    shafts : TakeUp or None
        How far the shafts can and would have to move to take the wear up; None where there is no loss.
    drive_side : int
        Side that carries: +1 left, −1 right.
    law : WearStudy or None
        The wear law on that side of the scanned gear.
    spread : ContactSpread or None
        Standard deviations of the contact's numbers; None where nothing is known of them.
    """

    design: ExactMeshing
    published: PublishedMeshing
    contact: ContactResult
    shafts: TakeUp | None
    drive_side: int
    law: WearStudy | None = None
    spread: ContactSpread | None = None


UNEXPLAINED = "unexplained"
"""Name under which structure without a name stands among the causes of a change."""


@dataclass(frozen=True, slots=True)
class Change:
    """One number of the result, with the effects left in and taken out.

    Parameters
    ----------
    name : str
        What it is, with its unit at the end, as in the report.
    before, after : float
        As the raw scan gives it; with the effects taken out.
    as_made : float
        Of the gear as it was made; nan where that is not known.
    std : float
        Standard deviation of the difference.
    causes : tuple of (str, float)
        Effects behind the difference, and what each would change by itself; the largest first.
    """

    name: str
    before: float
    after: float
    as_made: float
    std: float
    causes: tuple[tuple[str, float], ...]

    @property
    def difference(self) -> float:
        """after − before."""
        return self.after - self.before

    @property
    def matters(self) -> bool:
        """Whether the difference is more than its standard deviation."""
        return abs(self.difference) > self.std


@dataclass(frozen=True, slots=True)
class Solids:
    """The worn gear and what is missing from it, as closed triangles.

    Parameters
    ----------
    worn : Triangles
        The worn gear (bore left out).
    bodies : tuple of Triangles
        The worn volume: closed bodies, largest first.
    """

    worn: Triangles
    bodies: tuple[Triangles, ...]

    @property
    def volume(self) -> float:
        """Sum over the bodies, mm³."""
        return sum(body.volume for body in self.bodies)


@dataclass(frozen=True, slots=True)
class PlainBoolean:
    """Nominal minus the user's own watertight triangles, with no decision on what is wear.

    Parameters
    ----------
    removed : float
        mm³, one-sided: scan noise adds to it.
    signed : float
        Difference of the two volumes, mm³, free of that bias.
    pieces : int
        Closed pieces.
    """

    removed: float
    signed: float
    pieces: int


@dataclass(frozen=True, slots=True, repr=False)
class Results(Card):
    """A finished comparison.

    Parameters
    ----------
    design : Design
    part : str
        "pinion" or "gear".
    gear : Gear
        The scanned gear's design.
    scans : tuple of Scan
        As read.
    placed : PlacedScan
        On the design, before the loop.
    pose : Pose
        Final: design = rotation · scan + translation.
    loop : Loop or None
        None where it was left out.
    raw, corrected, as_made : Cells
        Final pose: as measured; measurement effects taken out; also manufacture and what is unexplained taken out.
    wear, wear_before : Wear
        Against the as-made gear; and what it would have been without the loop.
    laws : tuple of FittedLaw
    thickness : SectionThickness
    worn : ToothProfiles
        The worn model.
    solids : Solids or None
        None for a planar section.
    meshing : MeshingStudy or None
        None without a mate.
    inspection : Inspection or None
    boolean : PlainBoolean or None
        Where the scan is watertight triangles.
    notes : tuple of str
        Doubts, each a sentence.
    before_files : tuple of str
        Scans of the unworn gear the wear was measured against.
    manufacture : (teeth, 2, rows, columns) float
        Deviation of the as-made gear on the wear sheets, mm.
    present : ToothProfiles
        The gear as it is: manufacture and wear; what was run in mesh.
    changes : tuple of Change
        What taking the effects out changed; empty where there was nothing to take out.
    """

    design: Design
    part: str
    gear: Gear
    scans: tuple[Scan, ...]
    placed: PlacedScan
    pose: Pose
    loop: Loop | None
    raw: Cells
    corrected: Cells
    as_made: Cells
    wear: Wear
    wear_before: Wear
    laws: tuple[FittedLaw, ...]
    thickness: SectionThickness
    worn: ToothProfiles
    solids: Solids | None
    meshing: MeshingStudy | None
    inspection: Inspection | None
    boolean: PlainBoolean | None
    notes: tuple[str, ...]
    before_files: tuple[str, ...]
    manufacture: Floats
    present: ToothProfiles
    changes: tuple[Change, ...] = ()

    @property
    def planar(self) -> bool:
        """True for a planar section."""
        return self.scans[0].kind == "section"

    def to_dict(self) -> dict[str, Any]:
        """What is written as `report.json`; see `gearwear.report.document`."""
        from gearwear.report.document import document

        return document(self, [])

    def arrays(self) -> ReportArrays:
        """The arrays that `gearwear.report.figures` draws."""
        from gearwear.report.outputs import report_arrays

        return report_arrays(self)

    def headline(self) -> str:
        size = measured(self.wear.volume, self.wear.volume_std, "mm²" if self.planar else "mm³")
        return f"{self.part} of {self.gear.teeth} teeth, {size} worn off in {counted(len(self.wear.regions), 'region')}"

    def rows(self) -> list[Row]:
        rows = [("registration", self.placed.registration.headline())]
        if self.loop is not None:
            rows += [("loop", self.loop.headline()), ("effects", ", ".join(one.name for one in self.loop.effects) or "none")]
        rows += [("wear", self.wear.headline()), ("thickness", self.thickness.headline())]
        if self.meshing is not None:
            rows.append(("meshing", self.meshing.contact.headline()))
        if self.inspection is not None:
            rows.append(("inspection", self.inspection.headline()))
        return rows + [("note", note) for note in self.notes]
