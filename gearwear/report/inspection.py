"""An inspection as files and on the terminal: JSON, CSV, charts as PDF and PNG, one screen of text."""

from __future__ import annotations

import csv
import math
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwear.design.pair import Design
from gearwear.design.profiles import LEFT, RIGHT
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.loop import Loop
from gearwear.measure.inspection.estimate import RESOLVABLE_SHARE, Estimate
from gearwear.measure.inspection.grading import Finding, Verdict
from gearwear.measure.inspection.inspection import Inspection
from gearwear.measure.registration import Registration
from gearwear.report.charts.sheet import mean_seen
from gearwear.report.document import effect_record
from gearwear.report.words import MISSING, SPACE, number, sentence, significant
from gearwear.report.writing import write_json
from gearwear.scan.types import Scan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "gearwear.inspection/1"
SIDES = ("left", "right")
CHARTS = ("profile", "helix", "pitch", "topography")
DPI = 150
Json = dict[str, Any]


def worst_tooth(inspection: Inspection) -> int:
    """The tooth (0-based) whose profile or helix runs out most; 0 where nothing was seen."""
    size = np.nan_to_num(np.stack([inspection.profile.total.value, inspection.helix.total.value])).max(axis=(0, 2))
    return int(np.argmax(size))


def inspection_record(
    design: Design, part: str, scans: Sequence[Scan], registration: Registration, loop: Loop | None, notes: Sequence[str]
) -> Json:
    """What stands in ``inspection.json`` beside the inspection itself: of what, from what, and what was taken out first."""
    gear = design.gears[part]
    spec = gear.spec
    return {
        "schema": SCHEMA,
        "design": {
            "source": design.source, "part": part, "teeth": gear.teeth, "module_mm": spec.normal_module,
            "pressure_angle_deg": math.degrees(spec.normal_pressure_angle), "profile_shift": spec.profile_shift,
            "face_width_mm": gear.face_width,
        },
        "scan": {
            "file": scans[0].files[0], "files": [file for scan in scans for file in scan.files],
            "points": sum(len(scan) + sum(scan.rejected.values()) for scan in scans), "kind": scans[0].kind,
        },
        "registration": {
            "converged": registration.converged, "datum": list(registration.datum.surfaces),
        },
        "taken_out": None if loop is None else [
            effect_record(effect) for effect in loop.effects if effect.kind in (Kind.MEASUREMENT, Kind.MOUNTING)
        ],
        "notes": list(notes),
    }  # fmt: skip


def write_inspection(folder: Path, record: Json, inspection: Inspection, teeth: Sequence[int]) -> list[str]:
    """Write everything but the JSON file's list of files.

    Parameters
    ----------
    folder : Path
        Where to.
    record : dict
        What stands in ``inspection.json`` beside the inspection itself; gets the names of the files.
    inspection : Inspection
        What was found.
    teeth : sequence of int
        0-based teeth whose topography is drawn; the first one also as PNG.

    Returns
    -------
    list of str
        Names of the files.
    """
    write_findings(folder / "inspection.csv", inspection)
    write_flanks(folder / "inspection_flanks.csv", inspection)
    write_teeth(folder / "inspection_teeth.csv", inspection)
    names = write_charts(folder, inspection, teeth)
    files = ["inspection.json", "inspection.csv", "inspection_flanks.csv", "inspection_teeth.csv", *names]
    write_json(folder / "inspection.json", {**record, "inspection": inspection.as_dict(), "files": files})
    return files


def write_findings(path: Path, inspection: Inspection) -> None:
    """The worst of every deviation with its class, as CSV."""
    head = ["symbol", "quantity", "flank", "tooth", "value_um", "U_um", "noise_um", "tolerance_um", "class", "resolvable_class",
            "met_class", "verdict", "statement", "seen"]  # fmt: skip
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for one in inspection.findings:
            mark = one.grade
            writer.writerow([
                one.symbol, one.quantity, "" if one.side is None else SIDES[one.side], "" if one.tooth is None else one.tooth + 1,
                _um(one.value), _um(one.expanded), _um(one.noise), _um(mark.tolerance), _known(mark.iso_class),
                _known(mark.resolvable_class), _known(mark.met_class), mark.verdict, one.statement, one.seen,
            ])  # fmt: skip


def write_flanks(path: Path, inspection: Inspection) -> None:
    """Every deviation of every flank with its U, as CSV; empty where it was not seen."""
    parts: dict[str, Estimate] = {
        f"{name}_{part}": getattr(evaluation, part)
        for name, evaluation in (("profile", inspection.profile), ("helix", inspection.helix))
        for part in ("slope", "form", "total", "crowning")
    }
    parts |= {"index": inspection.pitch.index, "single_pitch": inspection.pitch.single}
    banded = {name: one.k for name, one in (("profile", inspection.profile), ("helix", inspection.helix)) if one.k is not None}
    parts |= {f"{name}_k_excess": k.excess for name, k in banded.items()}
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        columns = [*(f"{name}_{what}" for name in parts for what in ("um", "U_um")), *(f"{name}_k_verdict" for name in banded)]
        writer.writerow(["tooth", "flank", "coverage", *columns])
        for tooth, side in np.ndindex(*inspection.coverage.shape):
            values = [_um(float(v)) for part in parts.values() for v in (part.value[tooth, side], part.expanded[tooth, side])]
            verdicts = [_known(k.verdict(tooth, side)) for k in banded.values()]
            writer.writerow([tooth + 1, SIDES[side], f"{inspection.coverage[tooth, side]:.3f}", *values, *verdicts])


def write_teeth(path: Path, inspection: Inspection) -> None:
    """Thickness, chords, span, dimension over pins and ball radius tooth by tooth with their U, as CSV; empty where not seen.

    A span starts on its tooth; a ball, and the first of two pins, lie in the space after it, counter-clockwise.
    """
    found = inspection.dimensions
    parts: dict[str, Estimate] = {
        "thickness_mm": found.thickness, "chordal_thickness_mm": found.chord_thickness,
        "constant_chord_mm": found.constant_chord_thickness, "span_mm": found.span_lengths, "over_pins_mm": found.pin_lengths,
    }  # fmt: skip
    if inspection.runout is not None:
        parts["ball_radius_less_nominal_mm"] = inspection.runout.radial
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["tooth", *(column for name in parts for column in (name, f"{name.removesuffix('_mm')}_U_mm"))])
        for tooth in range(inspection.gear.teeth):
            row: list[object] = [tooth + 1]
            for part in parts.values():
                seen = tooth < len(part.value) and np.isfinite(part.value[tooth])
                row += [f"{part.value[tooth]:.5f}", f"{part.expanded[tooth]:.5f}"] if seen else ["", ""]
            writer.writerow(row)


def _um(value: float) -> str:
    return f"{1e3 * value:.3f}" if np.isfinite(value) else ""


def _known(value: object) -> object:
    return "" if value is None else value


def write_charts(folder: Path, inspection: Inspection, teeth: Sequence[int]) -> list[str]:
    """Write ``inspection.pdf`` (pages of A4), and each kind of chart as PNG; a planar section has neither helix nor topography."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_pdf import PdfPages

    from gearwear.report.figures import STYLE

    names = ["inspection.pdf"]
    # No dates: the same inspection gives the same bytes.
    with (
        rc_context(STYLE),
        PdfPages(folder / "inspection.pdf", metadata={"CreationDate": None, "Title": "Gear inspection"}) as pages,
    ):
        for kind, whole, parts in _charts(inspection, teeth):
            for figure in parts:
                pages.savefig(figure)
            name = f"chart_{kind}.png"
            if name not in names:
                whole.savefig(folder / name, dpi=DPI, metadata={"Software": None})
                names.append(name)
    return names


def _charts(inspection: Inspection, teeth: Sequence[int]) -> Iterator[tuple[str, Figure, Iterator[Figure]]]:
    """Every kind of chart: its name, the whole on one sheet, and the same on pages."""
    from matplotlib.figure import Figure

    from gearwear.report.charts import helix_chart, pitch_chart, profile_chart, rows_of, topography_chart

    rows = rows_of(range(inspection.gear.teeth))
    section = not np.isfinite(inspection.helix.slope.value).any()
    for kind, draw in (("profile", profile_chart), ("helix", helix_chart)):
        if kind == "profile" or not section:
            whole = draw(Figure(), inspection)
            yield kind, whole, iter([whole]) if len(rows) == 1 else (draw(Figure(), inspection, row) for row in rows)
    pitch = pitch_chart(Figure(), inspection)
    yield "pitch", pitch, iter([pitch])
    if not section:
        for tooth in teeth:
            figure = topography_chart(Figure(), inspection, tooth)
            yield "topography", figure, iter([figure])


def lines(inspection: Inspection, subject: str, doubts: Sequence[str] = ()) -> list[tuple[str, str]]:
    """The inspection on one screen: at most 22 lines of at most 80 columns, each with its rich style.

    Parameters
    ----------
    inspection : Inspection
        What was found.
    subject : str
        What was measured, on one line.
    doubts : sequence of str
        What to warn of.
    """
    settings = inspection.settings
    asked = f"class {settings.required_class} required" if settings.required_class is not None else "class by value, tol. of it"
    said = [(subject, "dim"), (f"{settings.edition}, {asked}; worst flanks in µm, U with k = 2", "dim")]
    heads = "".join(f"{'value':>8}{'U':>6}{'tol.':>7}  {'class':<8}" for _ in SIDES)
    said.append((f"{'':18}{'left flanks':^31}{'right flanks':^31}".rstrip(), "bold"))
    said.append((f"{'':18}{heads}".rstrip(), ""))
    rows: dict[str, dict[int | None, Finding]] = {}
    for one in inspection.findings:
        rows.setdefault(one.quantity, {})[one.side] = one
    for quantity, found in rows.items():
        first = next(iter(found.values()))
        cells = "".join(_cells(found.get(side)) for side in (LEFT, RIGHT)) if None not in found else _cells(found[None])
        style = "yellow" if any(one.grade.verdict in (Verdict.EXCEEDS, Verdict.COARSER) for one in found.values()) else ""
        said.append(
            (
                f"{first.symbol:<5}{quantity.replace('_', ' ').replace(' pitch', ' p.', len(quantity) > 13):<13}{cells}".rstrip(),
                style,
            )
        )
    said += [(text, "") for text in (*_means(inspection), *_k_bands(inspection), *_dimensions(inspection))]
    whole = inspection.iso_class
    if whole is not None and settings.required_class is None:
        said.append((f"class of the gear: {whole}", "bold"))
    if any(one.grade.verdict is Verdict.NOT_RESOLVABLE for one in inspection.findings):
        share = f"{100 * RESOLVABLE_SHARE:.0f}{SPACE}%"
        said.append((f"n.r.: not resolvable, U is over {share} of the tolerance; ≤: class met for certain", "dim"))
    warned = " ".join(map(sentence, doubts)).replace(SPACE, "\u00a0")
    room = 2 if inspection.settings.k_bands is None else 1
    return said + [(text, "yellow") for text in textwrap.wrap(f"! {warned}", 80, max_lines=room, placeholder=" …") if doubts]


def _means(inspection: Inspection) -> list[str]:
    """Mean of all flanks of a side, as laboratories print it."""
    said = []
    for symbol, found in (("f_Hα", inspection.profile), ("f_Hβ", inspection.helix)):
        means = [mean_seen(found.slope.value[:, side]) for side in (LEFT, RIGHT)]
        if np.isfinite(means).any():
            left, right = (significant_um(value) if math.isfinite(value) else MISSING for value in means)
            said.append(f"{symbol} {left} left, {right} right")
    return [f"{'mean slope, µm':<20}{';  '.join(said)}"] if said else [""]


def _k_bands(inspection: Inspection) -> list[str]:
    """How many flanks lie in their K bands."""
    said = []
    for name, found in (("profile", inspection.profile), ("helix", inspection.helix)):
        for side in (LEFT, RIGHT):
            count = {} if found.k is None else found.k.count(side)
            words = ", ".join(f"{n} {verdict.replace('not resolvable', 'n.r.')}" for verdict, n in count.items())
            said += [f"{name} {SIDES[side]} {words}"] if count else []
    return textwrap.wrap("; ".join(said), 80, initial_indent=f"{'K band':<20}", subsequent_indent=" " * 20) if said else []


def _cells(one: Finding | None) -> str:
    if one is None:
        return " " * 31
    value, expanded, limit = (
        MISSING if not np.isfinite(v) else significant_um(v) for v in (one.value, one.expanded, one.grade.tolerance)
    )
    return f"{value:>8}{expanded:>6}{limit:>7}  {_class(one):<8}"


def significant_um(value: float) -> str:
    """µm without more digits than mean something.

    >>> significant_um(0.00123), significant_um(-0.0567), significant_um(1.234)
    ('1.2', '−57', '1234')
    """
    um = 1e3 * value
    return f"{um:.0f}".replace("-", "−") if abs(um) >= 20.0 else number(um, 1)


def _class(one: Finding) -> str:
    mark = one.grade
    if mark.verdict is Verdict.NOT_RESOLVABLE:
        return f"n.r. ≤{mark.met_class}" if mark.met_class is not None else "n.r."
    if mark.verdict is Verdict.NOT_SEEN and one.seen:
        return "too few"
    short = {
        Verdict.GRADED: str(mark.iso_class), Verdict.WITHIN: "within", Verdict.EXCEEDS: "exceeds", Verdict.COARSER: "coarser",
        Verdict.NOT_SEEN: "not seen", Verdict.NO_TOLERANCE: MISSING,
    }  # fmt: skip
    return short[mark.verdict]


def _dimensions(inspection: Inspection) -> list[str]:
    found, gear = inspection.dimensions, inspection.gear
    rows = [("tooth thickness", found.thickness, gear.tooth_thickness)]
    if found.span is not None:
        rows.append((f"span over {found.span.teeth} teeth", found.span_lengths, found.span.length))
    if found.pins is not None:
        rows.append((f"over pins of {significant(found.pins.diameter)}", found.pin_lengths, found.pins.length))
    said = []
    for name, part, nominal in rows:
        seen = np.isfinite(part.value)
        if seen.any():
            least, most = float(part.value[seen].min()), float(part.value[seen].max())
            expanded = float(np.median(part.expanded[seen]))
            said.append(f"{name:<20}{least:.3f} … {most:.3f} mm, U {expanded:.3f}; design {nominal:.3f}")
        else:
            said.append(f"{name:<20}not seen; design {nominal:.3f} mm")
    return said
