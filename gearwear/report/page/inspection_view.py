"""An inspection as a report: what `report.pdf` of ``gearwear inspect`` holds."""

from __future__ import annotations

from collections.abc import Sequence

from gearwear.design.pair import Design
from gearwear.design.quantity import sentence
from gearwear.inspection.grading import Verdict
from gearwear.inspection.inspection import Inspection
from gearwear.report.page import sections
from gearwear.report.page.blocks import Heading, Items, Section
from gearwear.report.page.view import PageView, address
from gearwear.report.words.verdict import KeyFigure
from gearwear.scan.types import Scan

NO_CLASS = "not told: not every deviation is resolved, or was seen"
"""What stands for the class of the gear where no class is met for certain."""


def inspection_view(
    design: Design,
    scans: Sequence[Scan],
    inspection: Inspection,
    subject: str,
    notes: Sequence[str],
    dimensions: Sequence[str],
    files: Sequence[str],
    command: str = "",
) -> PageView:
    """What stands in the report of an inspection.

    Parameters
    ----------
    design : Design
    scans : sequence of Scan
    inspection : Inspection
    subject : str
        What was measured, on one line.
    notes : sequence of str
        Doubts and assumptions, each a sentence.
    dimensions : sequence of str
        Thickness, span and over pins, a line each: 20 columns of name, and what was found.
    files : sequence of str
        What was written beside it.
    command : str
        How it was asked for; empty from Python.
    """
    asked = inspection.settings.required_class
    found = {finding.grade.verdict for finding in inspection.findings}
    none = NO_CLASS
    if Verdict.EXCEEDS in found:
        none = f"not class {asked}: a deviation exceeds its tolerance"
    elif Verdict.COARSER in found:
        none = str(Verdict.COARSER)
    graded = KeyFigure(
        "Class of the gear", none if inspection.iso_class is None else str(inspection.iso_class), str(inspection.settings.edition)
    )
    required = [] if asked is None else [KeyFigure("Class required", str(asked), _decided(found))]
    return PageView(
        title="Gear inspection report",
        subject=subject,
        details=design.report.told,
        logo=address(design.report.logo),
        verdict="",
        doubtful=False,
        doubts=[sentence(note) for note in notes],
        figures=[graded, *required],
        still=lambda: "",
        still_words="",
        under="",
        scene=None,
        scripts=(),
        sections=[
            Section(
                "dimensions",
                "Dimensions",
                "Dimensions",
                [Items([f"{line[:20].strip()}: {line[20:].strip()}" for line in dimensions])],
            ),
            sections.inspected(inspection),
            Section("doubts", "Notes", "Notes", [Items([sentence(note) for note in notes] or ["None."])]),
            Section("made", "Made from", "Scan and design", sections.made_of(design, scans, (), command)),
            Section("files", "Files", "Files written", [Heading("Beside this report"), Items(files)]),
        ],
        footer="",
    )


def _decided(found: set[Verdict]) -> str:
    """Whether all deviations keep the required class, in words."""
    if Verdict.EXCEEDS in found:
        return "not kept (ISO 14253-1)"
    open_ = {Verdict.NEITHER, Verdict.NOT_RESOLVABLE, Verdict.NOT_SEEN} & found
    return "neither proven (ISO 14253-1)" if open_ else "kept (ISO 14253-1)"
