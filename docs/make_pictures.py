"""The pictures of the pages, from the bundled example: ``python docs/make_pictures.py [FOLDER]``, default ``docs/pictures``."""

from __future__ import annotations

import io
import math
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image
from scipy.ndimage import zoom

from gearwear.arrays import Floats
from gearwear.commands.inputs import bundled_example
from gearwear.comparison.closing import measure
from gearwear.comparison.results import Results
from gearwear.comparison.stations import compare
from gearwear.design import Gear
from gearwear.design.files.toml import read_design
from gearwear.diagnose.found import Loop
from gearwear.inspection import Settings, inspect, read_k_bands
from gearwear.meshing.exact import exact_meshing
from gearwear.paper.inputs import PAPER, gears
from gearwear.paper.points import point_pair
from gearwear.report import figures
from gearwear.report.charts import areal_chart, profile_chart
from gearwear.report.figures.arrays import ReportArrays
from gearwear.report.figures.colours import ALARM, BLUE, INK, LOST, ColourScale, colour_scale
from gearwear.report.figures.scene import still
from gearwear.report.figures.surfaces import SurfaceTriangles, gear_surfaces, section
from gearwear.report.write import report_arrays

FONT = {"font.family": ["DejaVu Sans"], "font.size": 9.0}
FINER = 3
"""Times the map of the wear is refined, so that its cells do not show."""
DEEP_UM = ColourScale(600.0, 15.0)
"""Blue of lost depth: pale from a few µm, dark at 0.6 mm."""


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with bundled_example() as example:
        results = compare(read_design(example / "design.toml"), [example / "scan.ply.gz"])
        chart, surfaces = k_chart(example), surfaces_chart(example)
    arrays = report_arrays(results)
    pictures = {
        "worn_gear": worn_gear(results, arrays),
        "deviation_map": deviation_map(arrays),
        "waterfall": waterfall(results.loop),
    }
    pictures["paper"] = paper()
    pictures["k_chart"], pictures["surfaces"] = chart, surfaces
    for name, picture in pictures.items():
        picture.save(folder / f"{name}.png", optimize=True)


def k_chart(example: Path) -> Image.Image:
    """Profile chart with the K band that the page of inspection shows."""
    page = (Path(__file__).resolve().parent / "inspection.md").read_text(encoding="utf-8")
    measured = measure(read_design(example / "design.toml"), [example / "scan.ply.gz"])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "k-chart.toml"
        file.write_text(page.split("```toml\n", 1)[1].split("```", 1)[0], encoding="utf-8")
        bands = replace(read_k_bands(file, measured.gear), source=file.name)
    found = inspect(measured.flanks, measured.gear, Settings(noise=measured.noise, k_bands=bands))
    with rc_context({**figures.STYLE, **FONT}):
        figure = profile_chart(Figure(dpi=210), found)
    return _image(figure, smaller=2).quantize(200, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)


def surfaces_chart(example: Path) -> Image.Image:
    """What the page of inspection shows of the flanks as surfaces."""
    measured = measure(read_design(example / "design.toml"), [example / "scan.ply.gz"])
    found = inspect(measured.flanks, measured.gear, Settings(noise=measured.noise, laboratory=True))
    assert found.laboratory is not None
    with rc_context({**figures.STYLE, **FONT}):
        figure = areal_chart(Figure(dpi=210), found, found.laboratory)
    return _image(figure, smaller=2).quantize(200, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)


def worn_gear(results: Results, arrays: ReportArrays) -> Image.Image:
    """The worn gear, the bluer the deeper, its worn end up; and a section of the tooth that lost most."""
    tooth = results.wear.regions[0].tooth + 1
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


def paper() -> Image.Image:
    """Points A and B of the paper on the tooth in both readings; what its formula counts on the line of action."""
    pinion, gear = gears()
    with rc_context({**figures.STYLE, **FONT}):
        figure = Figure(figsize=(11.0, 4.3), dpi=300)
        for left, hand in ((0.05, -1), (0.335, 1)):
            _reading(figure.add_axes((left, 0.12, 0.25, 0.72)), pinion, hand)
        axis = figure.add_axes((0.67, 0.12, 0.32, 0.72))
        exact = exact_meshing(pinion, gear, PAPER.centre_distance)
        figures.pair_in_mesh(axis, pinion, gear, exact)
        line, alpha = exact.path.line, exact.working_pressure_angle
        rolls = np.array([line - gear.tip_roll, exact.path.start_pinion])  # counted by the formula, and not there
        start = pinion.base_radius * np.array([math.cos(alpha), -math.sin(alpha)])
        points = start + rolls[:, None] * [math.sin(alpha), math.cos(alpha)]
        axis.plot(-points[:, 1], points[:, 0], color=ALARM, lw=3.0, ls=(0, (1.2, 0.6)), zorder=4, label="counted, but not there")
        at = np.array([4.0, 36.5])
        axis.set(xlim=at[0] + np.array([-14.0, 14.0]), ylim=at[1] + np.array([-14.0, 14.0]))
        axis.legend(loc="lower left", bbox_to_anchor=(-0.1, 1.0), ncols=2, borderaxespad=0.1, columnspacing=1.0, fontsize=7.5)
    return _image(figure, smaller=3)


def _reading(axis: Axes, pinion: Gear, hand: int) -> None:
    """The tooth with A and B on its flank, +1 counter-clockwise, −1 clockwise; the tooth upright."""
    pair = point_pair(PAPER)
    radii, angles = np.array([pair.radius_a, pair.radius_b]), np.array([0.0, pair.turn])
    before = 0 if hand < 0 else 1  # metal can only go
    centre = angles[before] - hand * float(pinion.half_angle(radii[before]))
    radius = np.linspace(pinion.root_radius, pinion.tip_radius, 300)
    half = pinion.half_angle(radius)
    loss = pair.loss_angle(hand)

    def upright(r: Floats, angle: Floats) -> Floats:
        return np.stack([-r * np.sin(angle), r * np.cos(angle)])

    lost = np.concatenate([upright(radius, hand * half), upright(radius, hand * (half - loss))[:, ::-1]], axis=1)
    whole = np.concatenate([upright(radius, half), upright(radius, -half)[:, ::-1]], axis=1)
    axis.fill(*whole, color="#e3ecf4", lw=0)
    axis.fill(*lost, color=LOST, alpha=0.3, lw=0, label="lost")
    axis.plot(*whole, color=INK, lw=0.9)
    axis.plot(*upright(radius, hand * (half - loss)), color=LOST, lw=1.3)
    around = np.linspace(-0.3, 0.3, 100)
    axis.plot(*upright(np.full(100, pinion.reference_radius), around), color=BLUE, ls=":", lw=1.1, label="pitch circle")
    places = upright(radii, angles - centre)
    axis.plot(*places, color=INK, lw=1.1, label=f"chord, {pair.chord:.3f} mm")
    axis.plot(*places, "o", color=INK, ms=3.5)
    for i, (name, place) in enumerate(zip("AB", places.T, strict=True)):
        beside = (-0.7 * hand, 0.0) if i == before else (0.5 * hand, 0.55)  # outside the tooth, or within it
        axis.text(place[0] + beside[0], place[1] + beside[1], name, ha="center", va="center")
    flank = "clockwise" if hand < 0 else "counter-clockwise"
    first, second = "AB" if hand < 0 else "BA"
    axis.set_title(
        f"{flank} flank: {first} before, {second} after\n{loss * pinion.reference_radius:.2f} mm at the pitch circle",
        fontsize=8.5,
    )
    axis.set(aspect="equal", xlim=(-7.0, 7.0), ylim=(29.5, 45.5), xlabel="across the tooth, mm")
    if hand < 0:
        axis.set_ylabel("from the gear axis, mm")
    axis.legend(loc="lower center", ncols=1, fontsize=7.5)


def _lost_depth(arrays: ReportArrays) -> list[SurfaceTriangles]:
    """The worn gear turned over about the x axis, its flanks coloured by the depth lost."""
    depth = zoom(np.maximum(arrays.wear_depth_um, 0.0), (1, 1, FINER, FINER), order=1)
    finer = [np.interp(np.linspace(0, len(v) - 1, FINER * len(v)), np.arange(len(v)), v) for v in (arrays.roll_mm, arrays.z_mm)]
    deep = replace(arrays, deviation_um=-depth, roll_mm=finer[0], z_mm=finer[1], elsewhere=None)
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


def waterfall(loop: Loop) -> Image.Image:
    """The residual, effect by effect."""
    with rc_context({**figures.STYLE, **FONT}):
        figure = Figure(figsize=(8.0, 2.2), dpi=110)
        figures.waterfall(figure.add_axes((0.16, 0.2, 0.81, 0.64)), loop)
    return _image(figure)


def _image(figure: Figure, smaller: int = 1) -> Image.Image:
    """Drawn, and reduced in size by a whole factor, which smooths edges."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png")
    image = Image.open(drawn).convert("RGB")
    return image.resize((image.width // smaller, image.height // smaller), Image.Resampling.LANCZOS)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent / "pictures")
