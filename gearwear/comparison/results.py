"""Everything a comparison found, in one frozen bundle: what the report is written from."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.arrays import Floats
from gearwear.comparison.consequences import Change
from gearwear.design.card import Card, Row, counted, measured
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.diagnose.loop import Loop
from gearwear.inspection.inspection import Inspection
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.published import PublishedMeshing
from gearwear.meshing.shafts import TakeUp
from gearwear.meshing.spread import ContactSpread
from gearwear.placing.cells import Cells
from gearwear.placing.pose import Pose
from gearwear.placing.views import PlacedScan
from gearwear.scan.types import Scan
from gearwear.wear.breakage import Broken
from gearwear.wear.regions import Wear
from gearwear.wear.solid import PlainBoolean, Solids
from gearwear.wear.thickness import SectionThickness
from gearwear.wear_law.study import WearStudy
from gearwear.wear_law.teeth import FittedLaw


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
    drive_side : Side
        Side that carries.
    law : WearStudy or None
        The wear law on that side of the scanned gear.
    spread : ContactSpread or None
        Standard deviations of the contact's numbers; None where nothing is known of them.
    """

    design: ExactMeshing
    published: PublishedMeshing
    contact: ContactResult
    shafts: TakeUp | None
    drive_side: Side
    law: WearStudy | None = None
    spread: ContactSpread | None = None


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
    broken : tuple of Broken
        What is broken off, and teeth that were not seen.
    fracture_points : int
        Points of fracture surfaces, left out of all else.
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
    broken: tuple[Broken, ...] = ()
    fracture_points: int = 0

    @property
    def lost_volume(self) -> tuple[float, float]:
        """Metal that is gone, worn off or broken off, mm³, and its standard deviation."""
        pieces = [one for one in self.broken if one.seen]
        std = math.hypot(self.wear.volume_std, *(one.std for one in pieces))
        return self.wear.volume + sum(one.volume for one in pieces), std

    @property
    def planar(self) -> bool:
        """True for a planar section."""
        return self.scans[0].kind == "section"

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
