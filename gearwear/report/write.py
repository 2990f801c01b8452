"""All files of a comparison, written at once or not at all."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.results import PairResult, Results
from gearwear.design.files.profiles import write_profiles
from gearwear.design.surface import FILLET, ROOT, TIP
from gearwear.processors import each
from gearwear.report.figures.arrays import ReportArrays, meshing_curves
from gearwear.report.files.extras import EXTRAS
from gearwear.report.files.solids import write_3mf, write_stl
from gearwear.report.files.tables import write_sections_csv, write_sections_dxf, write_thickness_csv
from gearwear.report.files.writing import check_heights, output_folder, write_json
from gearwear.report.records.comparison import document
from gearwear.threads import on_one_thread
from gearwear.wear.section_sums import stations


@on_one_thread
def write_results(
    results: Results,
    out: Path,
    heights: list[float] | None = None,
    also: frozenset[str] = frozenset(),
    *,
    page: bool = True,
    pdf: bool = False,
    command: str = "",
) -> list[str]:
    """Write report, page and solids, and what else was asked for.

    Parameters
    ----------
    results : Results
    out : Path
        Folder; files of the same names are replaced.
    heights : list of float or None
        Heights of section curves in mm, on the face; an empty list: every 0.2 mm; None: no curves.
    also : frozenset of str
        What else to write, by the words of `gearwear.report.files.extras.EXTRAS`.
    page, pdf : bool
        Whether to write ``report.html`` and ``report.pdf``.
    command : str
        How it was asked for; empty from Python.

    Returns
    -------
    list of str
        Their names.

    Raises
    ------
    InputError
        If a height lies off the face, the folder cannot be written to, or a package that a file needs is not installed.
    """
    if heights is not None:
        check_heights(f"sections {', '.join(map(str, heights))}", heights, results.gear.face_width)
    with output_folder(out) as stage:
        files = ["report.json", *["report.html"] * page, *["report.pdf"] * pdf, "thickness.csv", "worn_profiles.npz"]
        writers: list[Callable[[], object]] = [
            partial(write_thickness_csv, stage / "thickness.csv", results.wear.thickness),
            partial(write_profiles, stage / "worn_profiles.npz", results.wear.present, results.part),
        ]
        solids = results.wear.solids
        if solids is not None:
            bodies = solids.bodies
            names = [f"worn volume {i}" for i in range(1, len(bodies) + 1)]
            writers += [
                partial(write_stl, stage / "worn_volume.stl", bodies, "worn volume"),
                partial(write_3mf, stage / "worn_volume.3mf", bodies, names),
                partial(write_stl, stage / "worn_gear.stl", [solids.worn], "worn gear"),
            ]
            files += ["worn_volume.stl", "worn_volume.3mf", "worn_gear.stl"]
        if heights is not None:
            every = heights or stations(results.gear.face_width).tolist()
            writers.append(partial(write_sections_csv, stage / "sections.csv", results.wear.worn, every))
            writers.append(partial(write_sections_dxf, stage / "sections.dxf", results.wear.worn, every))
            files += ["sections.csv", "sections.dxf"]
        for name, write in EXTRAS.items():
            if name in also:
                files += write(results, stage)
        writers.append(partial(_write_report, stage / "report.json", results, files, command))
        if not page:
            each(writers)
        if page or pdf:
            from gearwear.report.page.view import view_of, write_html

            view = view_of(results, report_arrays(results), files, command)
            if page:
                write_html(stage / "report.html", view, writers)
            if pdf:
                from gearwear.report.pdf import write_pdf

                write_pdf(stage / "report.pdf", view)
    return files


def _write_report(path: Path, results: Results, files: list[str], command: str) -> None:
    write_json(path, document(results, files, command))


def report_arrays(results: Results) -> ReportArrays:
    """The arrays behind the figures."""
    cells, loop, pair = results.measured.cells, results.loop, results.pair
    grid, measured = cells.grid, cells.points
    before = after = None
    if loop is not None:
        outside = np.where(loop.use, 1.0, np.nan)
        before = 1e3 * grid.flank_shape(loop.residual_before * outside)
        after = 1e3 * grid.flank_shape(loop.residual_after * outside)
    lands = np.isin(measured.surface, (FILLET, ROOT, TIP)) & cells.seen
    out, elsewhere_out = None, None
    if loop is not None and (results.effects or loop.patterns):
        as_made = results.measured.as_made.points
        out, elsewhere_out = 1e3 * grid.flank_shape(as_made.deviation), as_made.take(lands)
    return ReportArrays(
        gear=results.gear,
        roll_mm=grid.column_middles,
        z_mm=grid.row_middles,
        deviation_um=1e3 * grid.flank_shape(measured.deviation),
        wear_depth_um=1e3 * results.wear.found.depth[..., grid.fillet :],
        worn=results.wear.worn,
        residual_before_um=before,
        residual_after_um=after,
        effects_out_um=out,
        elsewhere=measured.take(lands),
        elsewhere_effects_out=elsewhere_out,
        meshing=None if pair is None else meshing_curves(pair.contact, pair.design),
        contact_share=None if pair is None else contact_share(pair, results.part),
        inspection=results.inspection,
        halves=results.halves,
    )


def contact_share(pair: PairResult, part: str) -> Floats:
    """Contact pattern of the scanned gear on its carrying side, from the form circle to the tip; nan on the other side."""
    pattern = pair.contact.driver_pattern if part == "pinion" else pair.contact.driven_pattern
    gear = pair.contact.driver if part == "pinion" else pair.contact.driven
    low, high = sorted((gear.form_roll, np.inf if gear.orientation > 0 else gear.tip_roll))
    inside = (pattern.roll_edges[1:] > low) & (pattern.roll_edges[:-1] < high)
    share = pattern.share[..., inside][..., :: gear.orientation]  # root to tip
    if gear.twist != 0.0 or pair.contact.driver.face_width != pair.contact.driven.face_width:
        share = _on_even_heights(share, pattern.z - 0.5 * gear.face_width, gear.face_width)
    of_sides = np.full((len(share), 2, *share.shape[1:]), np.nan)
    of_sides[:, pair.drive_side.index] = share
    return of_sides


def _on_even_heights(share: Floats, height: Floats, width: float) -> Floats:
    """As many rows at even distances over a face, of slices at heights from mid-face (mm); 0 beyond the face that both gears have."""
    even = width * ((np.arange(len(height)) + 0.5) / len(height) - 0.5)
    row = np.abs(even[:, None] - height).argmin(axis=1)
    common = np.abs(even) <= np.abs(height).max()
    return np.where(common[None, :, None], share[:, row], 0.0)
