"""The pictures of the pages, from the bundled example: ``python docs/make_pictures.py [FOLDER]``, default ``docs/pictures``."""

from __future__ import annotations

import io
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from PIL import Image
from scipy.ndimage import zoom

from gearwear.arrays import Floats
from gearwear.design.reading import read_design
from gearwear.inputs import bundled_example
from gearwear.pipeline import compare
from gearwear.report import figures
from gearwear.report.arrays import Report, ReportArrays
from gearwear.report.colours import ColourScale, colour_scale
from gearwear.report.document import document
from gearwear.report.outputs import report_arrays
from gearwear.report.scene import still
from gearwear.report.surfaces import SurfaceTriangles, gear_surfaces, section

FONT = {"font.family": ["DejaVu Sans"], "font.size": 9.0}
FINER = 3
"""Times the map of the wear is refined, so that its cells do not show."""
DEEP_UM = ColourScale(600.0, 15.0)
"""Red of lost depth: pale from a few µm, dark at 0.6 mm."""


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with bundled_example() as example:
        results = compare(read_design(example / "design.toml"), [example / "scan.ply.gz"])
    report, arrays = document(results, []), report_arrays(results)
    pictures = {"worn_gear": worn_gear(report, arrays), "deviation_map": deviation_map(arrays), "waterfall": waterfall(report)}
    for name, picture in pictures.items():
        picture.save(folder / f"{name}.png", optimize=True)


def worn_gear(report: Report, arrays: ReportArrays) -> Image.Image:
    """The worn gear, the redder the deeper, its worn end up; and a section of the tooth that lost most."""
    worst = report["wear"]["regions"][0]
    tooth = int(worst["tooth"])
    with rc_context({**figures.STYLE, **FONT}):
        figure = Figure(figsize=(11.0, 5.0), dpi=300)
        gear = figure.add_axes((0.0, 0.0, 0.68, 1.0))
        still(gear, _lost_depth(arrays), DEEP_UM, _eye(-math.degrees((tooth - 1) * arrays.gear.pitch_angle) - 52.0, 36.0))
        gear.collections[0].set(antialiased=False, linewidth=0.4)
        beside = figure.add_axes((0.735, 0.12, 0.255, 0.76))
        z = float(arrays.z_mm[np.nan_to_num(arrays.wear_depth_um[tooth - 1]).max(axis=(0, 2)).argmax()])
        figures.tooth_section(beside, *section(arrays, tooth, z), arrays.gear.reference_radius)
        beside.set_title(f"tooth {tooth}, section at z = {z:.1f} mm")
    return _image(figure, smaller=3)


def _lost_depth(arrays: ReportArrays) -> list[SurfaceTriangles]:
    """The worn gear turned over about the x axis, its flanks coloured by the depth lost."""
    depth = zoom(np.maximum(arrays.wear_depth_um, 0.0), (1, 1, FINER, FINER), order=1)
    finer = [np.interp(np.linspace(0, len(v) - 1, FINER * len(v)), np.arange(len(v)), v) for v in (arrays.roll_mm, arrays.z_mm)]
    deep = replace(arrays, deviation_um=depth, roll_mm=finer[0], z_mm=finer[1], elsewhere=None)
    lost = {f"{region} flank" for i, region in enumerate(("left", "right")) if depth[:, i].max() > 0.0}
    return [
        replace(
            piece, vertices=piece.vertices * [1.0, -1.0, -1.0], deviation_um=piece.deviation_um if piece.name in lost else None
        )
        for piece in gear_surfaces(deep, worn=True, budget=10**6)
    ]


def _eye(azimuth_deg: float, elevation_deg: float) -> Floats:
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation)])


def deviation_map(arrays: ReportArrays) -> Image.Image:
    """All flanks unrolled, as measured."""
    scale = colour_scale(arrays.deviation_um)
    with rc_context({**figures.STYLE, **FONT}):
        figure = Figure(figsize=(10.2, 3.4), dpi=110)
        figures.flank_map(figure.add_axes((0.06, 0.08, 0.85, 0.9)), arrays.deviation_um, scale)
        figures.colour_bar(figure.add_axes((0.925, 0.14, 0.012, 0.74)), scale, "deviation, µm")
    return _image(figure)


def waterfall(report: Report) -> Image.Image:
    """The residual, effect by effect."""
    with rc_context({**figures.STYLE, **FONT}):
        figure = Figure(figsize=(8.0, 2.2), dpi=110)
        figures.waterfall(figure.add_axes((0.16, 0.2, 0.81, 0.64)), report["closed_loop"])
    return _image(figure)


def _image(figure: Figure, smaller: int = 1) -> Image.Image:
    """Drawn, and reduced in size by a whole factor, which smooths edges."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png")
    image = Image.open(drawn).convert("RGB")
    return image.resize((image.width // smaller, image.height // smaller), Image.Resampling.LANCZOS)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent / "pictures")
