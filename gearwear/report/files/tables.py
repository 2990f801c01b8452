"""Curves and points as files: sections (CSV, DXF), thickness (CSV), deviation per point (PLY, NPZ)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.design.surface import SURFACE_NAMES, SurfacePoints
from gearwear.design.twist import turn_at
from gearwear.report.files.writing import write_csv
from gearwear.wear.solid import nominal_like, outlines
from gearwear.wear.thickness import SectionThickness

CHANNELS = ("red", "green", "blue")


def section_outlines(profiles: ToothProfiles, heights: Sequence[float]) -> Floats:
    """Outline of the whole gear at some heights (mm), linear between the profiles' own, (heights, n, 2) mm, to be closed."""
    z = np.asarray(heights, dtype=np.float64)
    return outlines(replace(profiles, z=z, half_angle=profiles.at_heights(z)))


def write_sections_csv(path: Path, worn: ToothProfiles, heights: Sequence[float]) -> None:
    """Section curves of the nominal and the worn teeth: z, tooth (from 1), flank, radius, and x and y of both, mm."""
    head = ("z_mm", "tooth", "flank", "radius_mm", "nominal_x_mm", "nominal_y_mm", "worn_x_mm", "worn_y_mm", "depth_um")
    gear, r = worn.gear, worn.radius
    z = np.asarray(heights, dtype=np.float64)
    nominal_half, worn_half = nominal_like(worn).at_heights(z), worn.at_heights(z)

    def rows() -> Iterator[tuple[object, ...]]:
        for (i, z), tooth, side in product(enumerate(heights), range(gear.teeth), Side):
            nominal, present = nominal_half[tooth, side.index, i], worn_half[tooth, side.index, i]
            centre = tooth * gear.pitch_angle + float(turn_at(gear, np.array(z)))
            a, b = centre + side * nominal, centre + side * present
            depth = 1e3 * gear.base_radius * gear.base_helix_cosine * (nominal - present)
            for *places, lost in np.column_stack([r, r * np.cos(a), r * np.sin(a), r * np.cos(b), r * np.sin(b), depth]):
                yield f"{z:z.4f}", tooth + 1, str(side), *(f"{value:z.6f}" for value in places), f"{lost:z.3f}"

    write_csv(path, head, rows())


def write_sections_dxf(path: Path, worn: ToothProfiles, heights: Sequence[float]) -> None:
    """Closed outlines of the whole gear as DXF polylines at their heights, on the layers NOMINAL and WORN; units mm."""
    from ezdxf import units
    from ezdxf.filemanagement import new

    drawing = new("R2010", setup=False)
    drawing.units = units.MM
    drawing.layers.add("NOMINAL", color=8)
    drawing.layers.add("WORN", color=1)
    space = drawing.modelspace()
    for layer, profiles in (("NOMINAL", nominal_like(worn)), ("WORN", worn)):
        for z, outline in zip(heights, section_outlines(profiles, heights), strict=True):
            space.add_polyline3d([(x, y, z) for x, y in outline.tolist()], close=True, dxfattribs={"layer": layer})
    drawing.saveas(path)


def write_thickness_csv(path: Path, thickness: SectionThickness) -> None:
    """Arc, chord and loss of every tooth in every section, mm."""
    head = ("tooth", "z_mm", "radius_mm", "nominal_arc_mm", "arc_mm", "chord_mm", "lost_arc_mm")
    columns = (thickness.arc, thickness.chord, thickness.lost)

    def rows() -> Iterator[tuple[object, ...]]:
        for tooth, section in np.ndindex(*thickness.arc.shape):
            shown = [f"{value:z.6f}" if np.isfinite(value) else "" for value in (column[tooth, section] for column in columns)]
            yield tooth + 1, f"{thickness.z[section]:.4f}", f"{thickness.radius:.6f}", f"{thickness.nominal:.6f}", *shown

    write_csv(path, head, rows())


def write_points_ply(path: Path, points: SurfacePoints, corrected: Floats, stray: Bools, colour: Floats) -> None:
    """Every point in the design frame with its deviation as a scalar field (binary PLY; CloudCompare opens it coloured).

    Parameters
    ----------
    path : Path
    points : SurfacePoints
        The located scan.
    corrected : (n,) float
        Deviation with measurement effects taken out, mm; nan where the surface is OTHER.
    stray : (n,) bool
        Points whose scalar fields stay empty: a few of them, millimetres off, would take a viewer's whole range of colours.
    colour : (n, 3) float
        Red, green, blue, 0 … 1, for viewers that know no scalar fields.
    """
    names = ("scalar_deviation_um", "scalar_corrected_um", "scalar_roll_mm")
    record = np.dtype(
        [(axis, "<f4") for axis in "xyz"]
        + [(channel, "u1") for channel in CHANNELS]
        + [(name, "<f4") for name in names]
        + [("surface", "u1"), ("tooth", "<u2"), ("side", "i1")]
    )
    data = np.zeros(len(points), record)
    measured = points.measured
    for i, axis in enumerate("xyz"):
        data[axis] = measured[:, i]
    for name, values in zip(names, (1e3 * points.deviation, 1e3 * corrected, points.roll), strict=True):
        data[name] = np.where(stray, np.nan, values)
    for channel, values in zip(CHANNELS, np.rint(255.0 * colour).T, strict=True):
        data[channel] = values
    data["surface"], data["tooth"], data["side"] = points.surface, points.tooth + 1, points.side
    kinds = {"f": "float", "u1": "uchar", "u2": "ushort", "i1": "char"}
    lines = ["ply", "format binary_little_endian 1.0", "comment written by gearwear; surface codes: " + ", ".join(
        f"{code} {name}" for code, name in enumerate(SURFACE_NAMES)
    ), f"element vertex {len(data)}"]  # fmt: skip
    for name in record.names or ():
        kind = record[name]
        lines.append(f"property {kinds['f'] if kind.kind == 'f' else kinds[kind.str[1:]]} {name}")
    lines.append("end_header\n")
    path.write_bytes("\n".join(lines).encode("ascii") + data.tobytes())


def write_points_npz(path: Path, points: SurfacePoints, corrected: Floats) -> None:
    """The located scan as arrays, mm: `position` as placed in the design frame, `foot` of each point on the design, the other fields of `SurfacePoints`, and
    the corrected deviation."""
    np.savez_compressed(
        path, surface=points.surface, tooth=points.tooth, side=points.side, roll=points.roll, position=points.measured, foot=points.position,
        normal=points.normal, deviation=points.deviation, corrected=corrected,
    )  # fmt: skip
