"""An inspection as files and on the terminal: JSON, CSV, charts as PDF and PNG, one screen of text."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import gearwear
from gearwear.design.pair import Design
from gearwear.design.quantity import MISSING, SPACE, number, sentence
from gearwear.design.side import Side
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.loop import Loop
from gearwear.inspection.estimate import RESOLVABLE_SHARE
from gearwear.inspection.grading import Finding, Verdict
from gearwear.inspection.inspection import NO_CLASS, Inspection
from gearwear.inspection.k_band import BandVerdict
from gearwear.inspection.radial import STANDARD as RADIAL_STANDARD
from gearwear.placing.registration import Registration
from gearwear.report.charts.sheet import mean_seen
from gearwear.report.files.inspection_columns import finding_columns, flank_columns, tooth_columns, trace_columns
from gearwear.report.files.writing import write_csv, write_json
from gearwear.report.records.comparison import details_record, effect_record
from gearwear.report.records.inspection import about_axis_record, as_dict
from gearwear.report.records.numbers import Json
from gearwear.report.words.clauses import to_a_clause, wrapped
from gearwear.scan.types import Scan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "gearwear.inspection/1"
FINE = 1e-3
"""mm below which U has a decimal more."""
DPI = 150


def worst_tooth(inspection: Inspection) -> int:
    """The tooth (0-based) whose profile or helix runs out most; 0 where nothing was seen."""
    size = np.nan_to_num(np.stack([inspection.profile.total.value, inspection.helix.total.value])).max(axis=(0, 2))
    return int(np.argmax(size))


def inspection_record(
    design: Design,
    part: str,
    scans: Sequence[Scan],
    registration: Registration,
    loop: Loop | None,
    notes: Sequence[str],
    command: str = "",
    about_teeth: Inspection | None = None,
) -> Json:
    """What stands in ``inspection.json`` beside the inspection itself: of what, from what, and what was taken out first; where it is about the
    bore, pitch and runout about the teeth as well."""
    gear = design.gears[part]
    spec = gear.spec
    return {
        "schema": SCHEMA, "version": gearwear.__version__, "command": command or None, "report": details_record(design.report),
        "design": {
            "source": design.source, "sha256": design.sha256 or None, "part": part, "teeth": gear.teeth, "module_mm": spec.normal_module,
            "pressure_angle_deg": math.degrees(spec.normal_pressure_angle), "profile_shift": spec.profile_shift, "helix_angle_deg": math.degrees(spec.helix_angle), "hand": spec.hand,
            "face_width_mm": gear.face_width, **({"gap_mm": spec.gap} if spec.gap > 0.0 else {}), **({"internal": True} if spec.internal else {}),
        },
        "scan": {
            "file": scans[0].files[0], "files": [file for scan in scans for file in scan.files],
            "sha256": [digest for scan in scans for digest in scan.sha256],
            "points": sum(scan.read for scan in scans), "kind": scans[0].kind,
        },
        "registration": {
            "converged": registration.converged, "datum": list(registration.datum.surfaces),
            "translation_std_um": [
                1e3 * float(std) if seen else None
                for std, seen in zip(np.sqrt(np.diag(registration.covariance))[:3], registration.observed[:3], strict=True)
            ],
        },
        "taken_out": None if loop is None else [
            effect_record(effect) for effect in loop.effects if effect.kind in (Kind.MEASUREMENT, Kind.MOUNTING)
        ],
        "notes": list(notes), "about_teeth": None if about_teeth is None else about_axis_record(about_teeth),
    }  # fmt: skip


def write_inspection(
    folder: Path,
    record: Json,
    inspection: Inspection,
    teeth: Sequence[int],
    pdf: Callable[[Path, Sequence[str]], None] | None = None,
) -> list[str]:
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
    pdf : callable or None
        Writes ``report.pdf``, given its path and the names of the files; None: there is none.

    Returns
    -------
    list of str
        Names of the files.
    """
    write_columns(folder / "inspection.csv", finding_columns(inspection))
    write_columns(folder / "inspection_flanks.csv", flank_columns(inspection))
    write_columns(folder / "inspection_teeth.csv", tooth_columns(inspection))
    write_columns(folder / "inspection_traces.csv", trace_columns(inspection))
    names = write_charts(folder, inspection, teeth)
    report = [] if pdf is None else ["report.pdf"]
    files = [
        "inspection.json",
        *report,
        "inspection.csv",
        "inspection_flanks.csv",
        "inspection_teeth.csv",
        "inspection_traces.csv",
        *names,
    ]
    if pdf is not None:
        pdf(folder / "report.pdf", files)
    write_json(folder / "inspection.json", {**record, "inspection": as_dict(inspection), "files": files})
    return files


def write_columns(path: Path, columns: Mapping[str, NDArray[Any]]) -> None:
    """Columns of equal length as CSV, empty where not seen."""
    digits = {"_mm": 5, "_um": 3, "age": 3}
    cells = [_written(column, digits.get(name[-3:], 0)) for name, column in columns.items()]
    write_csv(path, columns, zip(*cells, strict=True))


def _written(column: NDArray[Any], digits: int) -> list[str]:
    if column.dtype == np.float64:
        rounded = (np.round(column, digits) + 0.0).tolist()  # no −0
        return [f"{value:.{digits}f}" if math.isfinite(value) else "" for value in rounded]
    return [str(value) for value in column]


def write_charts(folder: Path, inspection: Inspection, teeth: Sequence[int]) -> list[str]:
    """Write ``inspection.pdf`` (pages of A4), and each kind of chart as PNG; a planar section has neither helix nor topography."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_pdf import PdfPages

    from gearwear.report.figures.maps import STYLE

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


def _charts(inspection: Inspection, teeth: Sequence[int]) -> Iterator[tuple[str, Figure, Iterable[Figure]]]:
    """Every kind of chart: its name, the whole on one sheet, and the same on pages."""
    from matplotlib.figure import Figure

    from gearwear.report.charts import charts_of, topography_chart

    charts = charts_of(inspection)
    for kind, chart in charts.items():
        whole = chart.whole()
        yield kind, whole, chart.pages() if chart.several else [whole]
    if "helix" in charts:
        for tooth in teeth:
            figure = topography_chart(Figure(), inspection, tooth)
            yield "topography", figure, [figure]


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
    said = [(subject, "dim"), (f"{settings.edition}, {asked}; worst in µm, U (k = 2); axis: {settings.axis or 'teeth'}", "dim")]
    heads = "".join(f"{f'{side} value':>14}{'U':>6}{'tol.':>7}  {'class':<2}" for side in Side)
    said.append((f"{'':12}{heads}".rstrip(), "bold"))
    rows: dict[str, dict[Side | None, Finding]] = {}
    for finding in inspection.findings:
        rows.setdefault(finding.quantity, {})[finding.side] = finding
    for quantity, by_side in rows.items():
        first = next(iter(by_side.values()))
        cells = "".join(_cells(by_side.get(side)) for side in Side) if None not in by_side else _cells(by_side[None])
        style = (
            "yellow" if any(finding.grade.verdict in (Verdict.EXCEEDS, Verdict.COARSER) for finding in by_side.values()) else ""
        )
        said.append(
            (
                f"{first.symbol:<5}{quantity.replace('_', ' ').replace(' pitch', ' p.', len(quantity) > 13):<13}{cells}".rstrip(),
                style,
            )
        )
    said += [
        (text, "")
        for text in (*_means(inspection), *_laboratory(inspection), *_k_bands(inspection), *dimension_lines(inspection))
    ]
    whole = inspection.iso_class
    if whole is not None and settings.required_class is None:
        said.append((f"class of the gear: {whole}", "bold"))
    said += [(text, "dim") for text in _legend(inspection)]
    return said + [(text, "yellow") for text in _warned(doubts, 2 if inspection.settings.k_bands is None else 1)]


def _legend(inspection: Inspection) -> list[str]:
    """What the short verdicts mean, or why there are none, on one line."""
    found = {finding.grade.verdict for finding in inspection.findings}
    if Verdict.NOT_RESOLVABLE not in found:
        return [note for note in inspection.notes if note.endswith(NO_CLASS)]
    share = f"{100 * RESOLVABLE_SHARE:.0f}{SPACE}%"
    if Verdict.NEITHER in found:
        return [f"n.r.: U over {share} of the tolerance; ≤: class met; unproven: it lies within U"]
    return [f"n.r.: not resolvable, U is over {share} of the tolerance; ≤: class met for certain"]


def _warned(doubts: Sequence[str], room: int) -> list[str]:
    """As many warnings as so many lines hold, each whole, and how many more there are; the first, where it alone is too long, to the end of a clause."""
    for kept in range(len(doubts), 0, -1):
        more = f" And {len(doubts) - kept} more, in inspection.json." if kept < len(doubts) else ""
        lines = wrapped(f"! {' '.join(map(sentence, doubts[:kept]))}{more}", 80, room + 1)
        if len(lines) <= room:
            return lines
    return to_a_clause(f"! {sentence(doubts[0])}", 80, room) if doubts else []


def _means(inspection: Inspection) -> list[str]:
    """Mean of all flanks of a side, as laboratories print it."""
    said = []
    for symbol, evaluation in (("f_Hα", inspection.profile), ("f_Hβ", inspection.helix)):
        means = [mean_seen(evaluation.slope.value[:, side.index]) for side in Side]
        if np.isfinite(means).any():
            left, right = (significant_um(value) if math.isfinite(value) else MISSING for value in means)
            said.append(f"{symbol} {left} left, {right} right")
    return [f"{'mean slope, µm':<20}{';  '.join(said)}"] if said else [""]


def _laboratory(inspection: Inspection) -> list[str]:
    """Twist, the deepest place and rolling with a master on one line; a ghost order on another."""
    examined, parts = inspection.laboratory, []
    if examined is None or inspection.settings.k_bands is not None:  # one screen
        return []
    twist, lowest = examined.areal.flanks.twist.value, examined.areal.lowest.value
    if np.isfinite(twist).any():
        tooth, side = np.unravel_index(int(np.nanargmin(lowest)), lowest.shape)
        least, most, deepest = (
            significant_um(float(value)) for value in (np.nanmin(twist), np.nanmax(twist), lowest[tooth, side])
        )
        parts += [f"twist {least}…{most}", f"lowest {deepest} ({tooth + 1} {tuple(Side)[side]})"]
    if examined.composite is not None:
        left, right = (significant_um(float(examined.composite.single_total.value[side.index])) for side in Side)
        parts += [f"F_i′ {left}, {right}"]
    ghosts = [
        f"{number(1e3 * wave.amplitude, 2)} of order {wave.order} {side}"
        for side in Side
        for wave in examined.waviness.waves[side.index]
        if examined.waviness.is_ghost(wave)
    ]
    said = [f"{'not graded, µm':<20}{'; '.join(parts)}"] if parts else []
    rolled = [
        f"{finding.symbol} {significant_um(finding.value)}, U {significant_um(finding.expanded)}: {_class(finding)}"
        for finding in inspection.radial
    ]
    said += [f"{RADIAL_STANDARD:<20}{';  '.join(rolled)}"] if rolled else []
    return said + ([f"{'ghost orders, µm':<20}{',  '.join(ghosts[:2])}"] if ghosts else [])


def _k_bands(inspection: Inspection) -> list[str]:
    """How many flanks lie in their K bands."""
    said = []
    for name, evaluation in (("profile", inspection.profile), ("helix", inspection.helix)):
        for side in Side:
            count = {} if evaluation.k is None else evaluation.k.count(side.index)
            words = ", ".join(f"{n} {verdict.replace('not resolvable', 'n.r.')}" for verdict, n in count.items())
            said += [f"{name} {side} {words}"] if count and [*count] != [BandVerdict.NOT_SEEN] else []
    return textwrap.wrap("; ".join(said), 80, initial_indent=f"{'K band':<20}", subsequent_indent=" " * 20) if said else []


def _cells(finding: Finding | None) -> str:
    if finding is None:
        return " " * 31
    value, expanded, limit = (
        MISSING if not np.isfinite(v) else significant_um(v) for v in (finding.value, finding.expanded, finding.grade.tolerance)
    )
    return f"{value:>8}{expanded:>6}{limit:>7}  {_class(finding):<8}"


def significant_um(value: float) -> str:
    """µm without more digits than mean something.

    >>> significant_um(0.00123), significant_um(-0.0567), significant_um(1.234)
    ('1.2', '−57', '1234')
    """
    um = 1e3 * value
    return f"{um:.0f}".replace("-", "−") if abs(um) >= 20.0 else number(um, 1)


def _class(finding: Finding) -> str:
    mark = finding.grade
    if mark.verdict is Verdict.NOT_RESOLVABLE:
        return f"n.r. ≤{mark.met_class}" if mark.met_class is not None else "n.r."
    if mark.verdict is Verdict.NOT_SEEN and finding.seen:
        return "too few"
    short = {
        Verdict.GRADED: str(mark.iso_class), Verdict.WITHIN: "within", Verdict.EXCEEDS: "exceeds", Verdict.COARSER: "coarser",
        Verdict.NEITHER: "unproven", Verdict.NOT_SEEN: "not seen", Verdict.NO_TOLERANCE: MISSING,
    }  # fmt: skip
    return short[mark.verdict]


def dimension_lines(inspection: Inspection) -> list[str]:
    """Tooth thickness, span and over pins: what was found and the design's, a line each."""
    dimensions, gear = inspection.dimensions, inspection.gear
    rows = [("tooth thickness", dimensions.thickness, gear.drawn_tooth_thickness)]
    if dimensions.span is not None:
        rows.append((f"span over {dimensions.span.teeth} teeth", dimensions.span_lengths, dimensions.span.length))
    if dimensions.pins is not None:
        gauge = "pins" if gear.twist == 0.0 else "balls"
        rows.append(
            (
                f"{'between' if gear.spec.internal else 'over'} {gauge} of {number(dimensions.pins.diameter, 3)}",
                dimensions.pin_lengths,
                dimensions.pins.length,
            )
        )
    said = []
    for name, part, nominal in rows:
        seen = np.isfinite(part.value)
        if seen.any():
            least, most = float(part.value[seen].min()), float(part.value[seen].max())
            expanded = float(np.median(part.expanded[seen]))
            decimals = 3 if expanded >= FINE else 4
            said.append(f"{name:<19} {least:.3f} … {most:.3f} mm, U {expanded:.{decimals}f}; design {nominal:.3f}")
        else:
            said.append(f"{name:<20}not seen; design {nominal:.3f} mm")
    drawn = dimensions.drawn(gear)
    if drawn is not None:
        limits, kept = drawn
        what = "span" if limits.pin_diameter is None else "pins"
        said.append(f"limits of the {what} {limits.low:.3f} … {limits.high:.3f} mm: {kept}")
    return said
