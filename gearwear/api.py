"""The stages of a comparison as functions, for Python and notebooks: what ``import gearwear as gw`` offers under these names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib import resources
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearwear.arrays import Floats
from gearwear.comparison.bore import filled_in
from gearwear.comparison.measured_gear import MeasuredGear, Progress
from gearwear.design.files.toml import read_design
from gearwear.design.given import check_choice, check_number, check_several, real_array
from gearwear.design.pair import Design
from gearwear.design.quantity import shown
from gearwear.errors import InputError, NotThisGear, check_kind
from gearwear.inspection.halves import Half, inspect_half
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.settings import Settings
from gearwear.meshing.study import PairStudy
from gearwear.scan.clean import clean
from gearwear.scan.contents import Contents
from gearwear.scan.reading import read_scan as read_files
from gearwear.scan.types import Scan, ScanKind
from gearwear.scan.views import views_of
from gearwear.wear.regions import Wear
from gearwear.wear.regions import find_wear as find_in_cells

if TYPE_CHECKING:
    from gearwear.comparison.results import Results
    from gearwear.identify.candidates import Candidates
    from gearwear.loaded.study import LoadedStudy
    from gearwear.report.figures.arrays import ReportArrays
    from gearwear.wear_law.study import Ahead, WearStudy

Name = str | PathLike[str]
"""A file."""
MEASURED = "what gw.register or gw.find_effects returns"
ONE_FRAME = 0.75
"""Share of the points on the gear, of that of the best view, that a view in the same frame has at least."""


def example(file: str = "design.toml") -> Path:
    """A file of the bundled example: "design.toml", "scan.ply.gz" or "truth.json".

    >>> example("scan.ply.gz").name
    'scan.ply.gz'

    Raises
    ------
    InputError
        If there is no such file.
    """
    folder = Path(str(resources.files("gearwear") / "example"))
    if not isinstance(file, str) or not (folder / file).is_file():
        raise InputError(
            f"{file if isinstance(file, str) else shown(file)}: the bundled example has {', '.join(sorted(one.name for one in folder.iterdir() if one.is_file()))}"
        )
    return folder / file


def read_scan(*files: Name, units: str = "mm") -> tuple[Scan, ...]:
    """Read a scan, or several views of one gear.

    Parameters
    ----------
    files : path
        One per view; every format of `gearwear.scan.reading.READERS`.
    units : str
        "mm", "cm", "m", "um" or "in".

    Returns
    -------
    tuple of Scan
        Each in its own axes, mm.

    Raises
    ------
    InputError
        If a file is missing, damaged or of no known format.
    """
    return tuple(read_files(files, units))


def as_scan(points: ArrayLike, normals: ArrayLike | None = None, name: str = "array") -> Scan:
    """Points from anywhere as a scan.

    Parameters
    ----------
    points : (n, 3) or (n, 2) float
        mm; two columns are a planar section.
    normals : (n, 3) float or None
        Outward, where they are known.
    name : str
        What the report calls it.

    Returns
    -------
    Scan

    Raises
    ------
    InputError
        If these are no points, or the normals are not one for each.

    Examples
    --------
    >>> import numpy as np
    >>> angle = np.linspace(0.0, 6.28, 500)
    >>> as_scan(np.column_stack([np.cos(angle), np.sin(angle)]), name="a circle").kind
    'section'
    """
    given = real_array("points", points)
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise InputError(f"points of shape {given.shape}: (n, 3), or (n, 2) for a planar section, would be right")
    outward = None if normals is None else real_array("normals", normals)
    if outward is not None and outward.shape != (len(given), 3):
        raise InputError(f"normals of shape {outward.shape}: ({len(given)}, 3), one for each point, would be right")
    if given.shape[1] == 2:
        given = np.column_stack([given, np.zeros(len(given))])
    cleaned, kind = clean(Contents(given, outward))
    view = np.zeros(len(cleaned.points), np.int8)
    return Scan(
        points=np.ascontiguousarray(cleaned.points), normals=cleaned.normals, triangles=None, kind=cast(ScanKind, kind),
        files=(name,), rejected=cleaned.rejected, view=view,
    )  # fmt: skip


def find_wear(measured: MeasuredGear) -> Wear:
    """Where metal is missing beyond what the scan's scatter explains.

    Parameters
    ----------
    measured : MeasuredGear
        After `find_effects`; without it, what scanner and maker added is taken for wear or hides it.

    Returns
    -------
    Wear
    """
    check_kind(measured, MeasuredGear, "measured", MEASURED)
    return find_in_cells(measured.as_made, measured.noise, measured.worn_sides, measured.loop, gone=measured.gone)


def inspect(measured: MeasuredGear, settings: Settings | None = None, half: str | None = None) -> Inspection:
    """ISO 1328-1 deviations of a gear; what the scanner added is taken out where the loop was closed.

    Parameters
    ----------
    measured : MeasuredGear
    settings : Settings or None
        Class, bands, gauges, axis. What they leave out comes from the measured gear: noise, pose and scale are as unsure as the scan and the
        design say, and the axis is that of the design's ``[datum]``. None: the defaults, and what is not graded (`laboratory`).
    half : {"lower", "upper"} or None
        Of a double helical gear, whose halves are inspected one by one; the lower one begins at z = 0. None: the lower.

    Returns
    -------
    Inspection

    Raises
    ------
    InputError
        If a setting cannot be met, the datum was not seen, or the gear has no halves.
    """
    if half is not None and not (isinstance(half, str) and half in tuple(Half)):
        raise InputError(f"half = {shown(half)}: lower or upper would be right, of a double helical gear")
    check_kind(measured, MeasuredGear, "measured", MEASURED)
    check_kind(settings, Settings | None, "settings", "a gw.Settings, or None for the defaults,")
    which = Half(half or Half.LOWER) if half is not None or measured.gear.spec.gap > 0.0 else None
    flanks, chosen = filled_in(measured, settings or Settings(laboratory=True))
    return inspect_half(flanks, measured.gear, which, chosen)


def compare(
    design: Design | Name,
    scans: Name | Scan | Floats | Sequence[Name | Scan | Floats],
    part: str | None = None,
    before: Name | Scan | Floats | Sequence[Name | Scan | Floats] = (),
    units: str = "mm",
    loop: bool = True,
    inspection: bool = True,
    ahead: Ahead | None = None,
    progress: Progress = lambda station: None,
    stream: bool | None = None,
) -> Results:
    """The whole comparison: scan against design, wear, thickness, meshing, inspection.

    Parameters
    ----------
    design : Design or path
    scans : path, Scan, (n, 3) float or sequence of these
        One scan, or several views of one gear: files, what `read_scan` and `as_scan` give, or points in mm.
    part : {"pinion", "gear"} or None
        Which one was scanned; None: the one that fits.
    before : path, Scan, (n, 3) float or sequence of these
        Scan of the same gear unworn, or its views.
    units : str
        Unit of the files; a `Scan` is in mm.
    loop, inspection : bool
        Whether to look for effects beyond registration; whether to inspect.
    ahead : Ahead or None
        What to forecast.
    progress : callable
        Told each station.
    stream : bool or None
        Whether to go through the scan chunk by chunk and hold only a sample of its points in memory; None: from 5 million points on, and
        where it needs more memory than is allowed.

    Returns
    -------
    Results

    Raises
    ------
    InputError
        If a file or a value is wrong, or the scan is of something else: then with what it looks like by itself.
    """
    from gearwear.comparison.stations import compare as run
    from gearwear.comparison.which_gear import check_part
    from gearwear.wear_law.study import Ahead

    check_kind(ahead, Ahead | None, "ahead", "a gw.Ahead, or None,")
    for name, value in (("loop", loop), ("inspection", inspection)):
        check_kind(value, bool | np.bool_, name, "True or False")
    if not callable(progress):
        raise InputError(
            f"progress of type {type(progress).__name__}: a function that takes the name of a station would be right"
        )
    drawn = design if isinstance(design, Design) else read_design(cast(Path, design))
    check_part(drawn, part)
    try:
        return run(drawn, _each(scans), part, _each(before), units, loop, inspection, ahead, progress, stream)
    except NotThisGear as error:
        from gearwear.identify.survey import seems

        raise InputError(f"{error}{seems(error.points, error.planar)}") from None


def _each(given: Name | Scan | Floats | Sequence[Name | Scan | Floats]) -> list[Any]:
    """One or several as a list, points (n, 3) as scans; what is none of these is refused where it is read."""
    several = list(given) if isinstance(given, Iterable) and not isinstance(given, str | np.ndarray) else [given]
    return [as_scan(one) if isinstance(one, np.ndarray) else one for one in several]


def write(
    result: Results | PairStudy,
    folder: Name,
    also: Sequence[str] = (),
    sections: Sequence[float] | None = None,
    loaded: LoadedStudy | None = None,
    law: WearStudy | None = None,
    *,
    page: bool = True,
    pdf: bool = False,
) -> dict[str, Any]:
    """Write report, page and solids of a comparison as ``gearwear compare`` does, or a pair in mesh as ``gearwear meshing`` does.

    Parameters
    ----------
    result : Results or PairStudy
    folder : path
        Made where it is missing; files of the same names are replaced.
    also : sequence of str
        Of a comparison: "ply", "npz", "parquet", "topography", "glb".
    sections : sequence of float or None
        Of a comparison: heights of section curves in mm, on the face; an empty one: every 0.2 mm; None: no curves.
    loaded : LoadedStudy or None
        Of a pair in mesh: the same pair under load, of `study_load`.
    law : WearStudy or None
        With a `PairStudy`: the wear law on measured traces.
    page, pdf : bool
        Of a comparison: whether to write ``report.html`` and ``report.pdf``.

    Returns
    -------
    dict
        What `report.json` or `meshing.json` holds.

    Raises
    ------
    InputError
        If it is no result of these, the folder cannot be written to, a word of `also` is unknown, or a height lies off the face.
    """
    from gearwear.comparison.results import Results
    from gearwear.loaded.study import LoadedStudy
    from gearwear.report.files.extras import EXTRAS
    from gearwear.report.files.meshing import write_study
    from gearwear.report.files.writing import output_folder
    from gearwear.report.records.meshing import study_record
    from gearwear.report.write import write_results
    from gearwear.wear_law.study import WearStudy

    check_kind(folder, str | PathLike, "folder", "the name of a folder")
    if isinstance(result, PairStudy):
        check_kind(loaded, LoadedStudy | None, "loaded", "what gw.study_load returns, or None,")
        check_kind(law, WearStudy | None, "law", "a wear law such as results.pair.law, or None,")
        with output_folder(Path(folder)) as stage:
            files = write_study(stage, result, loaded, law)
        return {**study_record(result, loaded, law), "files": files}
    if not isinstance(result, Results):
        raise InputError(f"result = {type(result).__name__}: one of compare or study_meshing would be right")
    for name in check_several("also", also, "names"):
        if not (isinstance(name, str) and name in EXTRAS):
            raise InputError(f"also = {shown(name)}: one of {', '.join(EXTRAS)} would be right")
    heights = None if sections is None else check_several("sections", sections, "heights in mm")
    files = write_results(result, Path(folder), heights, frozenset(also), page=page, pdf=pdf)
    return {**as_dict(result), "files": files}


def as_dict(result: Results | Inspection | PairStudy) -> dict[str, Any]:
    """A result as plain numbers, strings and lists, units in the keys.

    Parameters
    ----------
    result : Results, Inspection or PairStudy
        Of `compare`, `inspect` or `study_meshing`.

    Returns
    -------
    dict
        What `report.json`, the key `inspection` of `inspection.json`, or `meshing.json` holds.

    Raises
    ------
    InputError
        If it is no result of these.
    """
    from gearwear.comparison.results import Results
    from gearwear.report.records.comparison import document
    from gearwear.report.records.inspection import as_dict as inspection_record
    from gearwear.report.records.meshing import study_record

    if isinstance(result, Inspection):
        return inspection_record(result)
    if isinstance(result, PairStudy):
        return study_record(result)
    if not isinstance(result, Results):
        raise InputError(f"result = {type(result).__name__}: one of compare, inspect or study_meshing would be right")
    return document(result)


def as_columns(inspection: Inspection, rows: Literal["findings", "flanks", "teeth"] = "flanks") -> dict[str, NDArray[Any]]:
    """An inspection as columns of equal length, ready for a data frame: ``pandas.DataFrame(gw.as_columns(found))``.

    Parameters
    ----------
    inspection : Inspection
    rows : {"findings", "flanks", "teeth"}
        A row for the worst of every deviation (``symbol``, ``quantity``, ``flank``, ``tooth`` from 1, ``value_um``, ``U_um``, …,
        ``verdict``); for every flank, each of its deviations with U (``profile_slope_um``, ``profile_slope_U_um``, …; signs as in
        `Evaluation` and `PitchDeviations`); or for every tooth its thickness, chords, span, over pins and ball radius with U, mm (a span starts
        on its tooth; a ball, and the first of two pins, lie in the space after it, counter-clockwise). nan where not seen.

    Raises
    ------
    InputError
        If `rows` is something else.
    """
    from gearwear.report.files import inspection_columns

    check_kind(inspection, Inspection, "inspection", "what gw.inspect returns")
    tables = {
        "findings": inspection_columns.finding_columns,
        "flanks": inspection_columns.flank_columns,
        "teeth": inspection_columns.tooth_columns,
    }
    check_choice("rows", rows, tables)
    return tables[rows](inspection)


def report_arrays(results: Results) -> ReportArrays:
    """The arrays of a comparison that `gearwear.figures` draws."""
    from gearwear.comparison.results import Results
    from gearwear.report.write import report_arrays as arrays

    check_kind(results, Results, "results", "what gw.compare returns")
    return arrays(results)


def propose_design(
    scan: Scan | Sequence[Scan],
    module: float | None = None,
    pressure_angle: float | None = None,
    face_width: float | None = None,
) -> Candidates:
    """Gears that a scan could be of, where no design is at hand: axis, teeth and dimensions from the scan itself.

    Parameters
    ----------
    scan : Scan or sequence of Scan
        What `read_scan` or `as_scan` gives. Several views must lie in one frame: without a design nothing aligns them.
    module, pressure_angle, face_width : float or None
        mm, rad and mm, where they are known.

    Returns
    -------
    Candidates
        Best first; `ranked[0].gear` is the best.

    Raises
    ------
    InputError
        If no gear is seen, or the views do not lie in one frame.
    """
    for name, known, unit in (
        ("module", module, "mm"),
        ("pressure_angle", pressure_angle, "rad"),
        ("face_width", face_width, "mm"),
    ):
        if known is not None:
            check_number(name, known, unit)
    from gearwear.identify.candidates import find_candidates, share_on

    views = views_of(scan)
    normals = [view.normals for view in views if view.normals is not None]
    points = np.concatenate([view.points for view in views])
    try:
        found = find_candidates(
            points,
            np.concatenate(normals) if len(normals) == len(views) else None,
            views[0].planar,
            module,
            pressure_angle,
            None,
            face_width,
        )
    except InputError as error:
        raise (
            error
            if len(views) == 1
            else InputError(f"{error}; {len(views)} views must lie in one frame, else one alone would be right")
        ) from None
    if len(views) > 1:
        shares = [share_on(found.ranked[0], view.points) for view in views]
        for view, share in zip(views, shares, strict=True):
            if not share > ONE_FRAME * np.nanmax(shares):
                raise InputError(
                    f"{', '.join(view.files)}: only {100 * share:.0f} % of its points lie on the gear that the views show together; views in one frame,"
                    " or one of them alone, would be right"
                )
    return found
