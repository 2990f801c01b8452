"""Files beside the report, each written when it is asked for: what other programs open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.results import Results
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, OTHER, SURFACE_NAMES, SurfacePoints
from gearwear.errors import InputError
from gearwear.report.figures.colours import colour_scale, paint
from gearwear.report.files.glb import grey_ends, painted, write_glb
from gearwear.report.files.tables import write_points_npz, write_points_ply
from gearwear.report.files.writing import write_csv
from gearwear.wear.solid import on_outline

NO_PYARROW = "parquet needs the package pyarrow: pip install pyarrow, or leave parquet out"


def write_ply(results: Results, folder: Path) -> list[str]:
    """``points.ply``: the deviation of every point, for CloudCompare; not of a streamed scan."""
    located, cells = results.measured.placed.located, results.measured.cells
    colour = paint(1e3 * located.deviation, colour_scale(1e3 * cells.grid.flank_shape(cells.points.deviation)))
    write_points_ply(folder / "points.ply", located, results.corrected_deviation, results.strays, colour)
    return ["points.ply"]


def write_npz(results: Results, folder: Path) -> list[str]:
    """``points.npz``: the deviation of every point, for numpy; not of a streamed scan."""
    write_points_npz(folder / "points.npz", results.measured.placed.located, results.corrected_deviation)
    return ["points.npz"]


def write_parquet(results: Results, folder: Path) -> list[str]:
    """``points.parquet``: the deviation of every point, for pandas, polars, DuckDB, R; needs pyarrow.

    Raises
    ------
    InputError
        If pyarrow is not installed.
    """
    try:
        pa, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
    except ImportError:
        raise InputError(NO_PYARROW) from None
    about = {
        "gearwear": "design frame: axis on z, tooth 1 on +x; deviation along the outward normal, + is too much material; "
        "corrected: measurement effects taken out",
    }
    writer = None
    try:
        for located in results.located_chunks():
            table = _as_table(pa, located, results.corrected(located)).replace_schema_metadata(about)
            if writer is None:
                writer = parquet.ParquetWriter(folder / "points.parquet", table.schema, compression="zstd")
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()
    return ["points.parquet"]


def _as_table(pa: Any, located: SurfacePoints, corrected: Floats) -> Any:
    """Points as a table of pyarrow."""
    measured = located.measured
    on_side = (located.surface == FLANK) | (located.surface == FILLET)
    known = located.surface != OTHER

    def number(values: Floats) -> Any:
        return pa.array(values.astype(np.float32), from_pandas=True)  # nan is null

    columns = {f"{axis}_mm": pa.array(measured[:, i].astype(np.float32)) for i, axis in enumerate("xyz")}
    columns |= {f"n{axis}": pa.array(located.normal[:, i].astype(np.float32)) for i, axis in enumerate("xyz")}
    columns["surface"] = pa.DictionaryArray.from_arrays(pa.array(located.surface.astype(np.int8)), list(SURFACE_NAMES))
    columns["tooth"] = pa.array((located.tooth + 1).astype(np.int16), mask=~known)
    side = pa.array(np.where(located.side > 0, 0, 1).astype(np.int8), mask=~on_side)
    columns["flank"] = pa.DictionaryArray.from_arrays(side, [str(side) for side in Side])
    columns["roll_mm"] = number(located.roll)
    columns["deviation_um"] = number(1e3 * located.deviation)
    columns["corrected_um"] = number(1e3 * corrected)
    return pa.table(columns)


def write_topography(results: Results, folder: Path) -> list[str]:
    """``topography.csv``: every flank as a grid of cells, with the number of points behind each."""
    raw, grid = results.measured.cells, results.measured.cells.grid
    roll, height = grid.column_middles, grid.row_middles
    radius = np.hypot(roll, results.gear.base_radius)
    maps = [
        1e3 * grid.flank_shape(raw.points.deviation),
        1e3 * grid.flank_shape(results.measured.corrected.points.deviation),
        1e3 * results.wear.found.depth[..., grid.fillet :],
        grid.flank_shape(raw.count),
    ]
    head = ("tooth", "flank", "roll_mm", "radius_mm", "z_mm", "deviation_um", "corrected_um", "wear_depth_um", "points")

    def rows() -> Iterator[tuple[object, ...]]:
        for tooth, side, row, column in np.ndindex(*maps[0].shape):
            deviation, corrected, depth, count = (float(values[tooth, side, row, column]) for values in maps)
            seen = [f"{value:z.3f}" if np.isfinite(value) else "" for value in (deviation, corrected)]
            place = (f"{roll[column]:.4f}", f"{radius[column]:.4f}", f"{height[row]:.4f}")
            yield tooth + 1, str(tuple(Side)[side]), *place, *seen, f"{depth:z.3f}", int(count)

    write_csv(folder / "topography.csv", head, rows())
    return ["topography.csv"]


def write_glbs(results: Results, folder: Path) -> list[str]:
    """``worn_gear.glb`` and ``worn_volume.glb``: coloured by what is missing; nothing for a planar section."""
    solids, worn = results.wear.solids, results.wear.worn
    if solids is None:
        return []
    lost = 1e3 * worn.loss
    scale = colour_scale(lost)
    gear = painted("worn gear", solids.worn, on_outline(worn, -lost), scale)
    write_glb(folder / "worn_gear.glb", [grey_ends(gear)])
    if not solids.bodies:
        return ["worn_gear.glb"]
    bodies = [
        painted(f"worn volume {i}", body, np.full(len(body.vertices), -scale.limit_um), scale)
        for i, body in enumerate(solids.bodies, start=1)
    ]
    write_glb(folder / "worn_volume.glb", bodies)
    return ["worn_gear.glb", "worn_volume.glb"]


EXTRAS: dict[str, Callable[[Results, Path], list[str]]] = {
    "ply": write_ply,
    "npz": write_npz,
    "parquet": write_parquet,
    "topography": write_topography,
    "glb": write_glbs,
}
"""Writers by the word that asks for them; each gives the names of what it wrote."""
