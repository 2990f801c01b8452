"""The figures as they stand on the page: laid out, with title and a caption that says what to see."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwear.arrays import Floats
from gearwear.design.quantity import number, significant
from gearwear.design.side import Side
from gearwear.diagnose.found import FoundEffect, Loop
from gearwear.inspection.inspection import Inspection
from gearwear.loaded.study import LoadedStudy
from gearwear.report import figures
from gearwear.report.figures.arrays import MeshingCurves, ReportArrays
from gearwear.report.figures.colours import BLUE, TEAL, ColourScale, colour_scale
from gearwear.report.figures.maps import shade_bar
from gearwear.report.figures.surfaces import section
from gearwear.report.page.blocks import Picture
from gearwear.report.page.svg import FULL
from gearwear.running.found import SecondLoop
from gearwear.wear.regions import WearRegion
from gearwear.wear.thickness import SectionThickness
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.study import WearStudy

SHARE_OF_ROWS = 1.6
"""Height in inches of a row of teeth in a map over the whole width."""


def wear_map(arrays: ReportArrays) -> Picture | None:
    """Depth of wear on all flanks, on a scale of its own; None without wear and for a planar section."""
    if arrays.planar or not (arrays.wear_depth_um > 0.0).any():
        return None
    depth = arrays.wear_shown_um
    scale = colour_scale(depth[depth < 0.0])

    def draw() -> Figure:
        figure, axis, bar = _wide(arrays.gear.teeth)
        figures.flank_map(axis, depth, scale)
        figures.colour_bar(bar, scale, "wear depth, µm", 0.0)
        return figure

    return Picture(
        draw, "wear-map", "Depth of wear, all flanks unrolled",
        "Wear alone, with the effects of scanner and maker taken out: the bluer the deeper, near-white is none that stands out of the scatter."
        f" Hatched: not seen. {scale.depth_words}",
    )  # fmt: skip


def deviation_map(arrays: ReportArrays, scale: ColourScale) -> Picture:
    """All flanks unrolled; traces for a planar section."""
    if arrays.planar:
        return gear_charts(arrays, "deviation", arrays.deviation_um)

    def draw() -> Figure:
        figure, axis, bar = _wide(arrays.gear.teeth)
        figures.flank_map(axis, arrays.deviation_um, scale)
        figures.colour_bar(bar, scale)
        return figure

    return Picture(
        draw, "map", "Deviation from the design, all flanks unrolled",
        "As measured. Blue is missing metal, red too much; a worn flank is blue among pale ones, and what all flanks share is not wear."
        f" Hatched: not seen. {scale.words}",
    )  # fmt: skip


def _wide(teeth: int) -> tuple[Figure, Axes, Axes]:
    """A figure with an axis for a map and one for its colour bar."""
    figure = Figure(figsize=(FULL, 0.8 + SHARE_OF_ROWS * -(-teeth // figures.teeth_in_a_row(teeth))))
    return figure, figure.add_axes((0.0, 0.0, 0.93, 1.0)), figure.add_axes((0.95, 0.08, 0.012, 0.8))


def _beside(
    size: tuple[float, float],
    drawn: Sequence[Callable[[Axes], object]],
    left: float = 0.07,
    wspace: float = 0.24,
    width_ratios: Sequence[float] | None = None,
) -> Figure:
    """A figure of so many inches with one axis for each drawing, side by side."""
    figure = Figure(figsize=size)
    axes = figure.subplots(1, len(drawn), squeeze=False, width_ratios=width_ratios)[0]
    figure.subplots_adjust(left=left, right=0.99, wspace=wspace)
    for axis, draw in zip(axes, drawn, strict=True):
        draw(axis)
    return figure


def worst_sections(regions: Sequence[WearRegion], arrays: ReportArrays) -> Picture | None:
    """Sections of the worst three teeth, each where its wear is deepest; None without wear."""
    shown = list(dict.fromkeys(region.tooth + 1 for region in regions))[:3]
    if not shown:
        return None

    def draw() -> Figure:
        figure = Figure(figsize=(FULL, 3.6))
        axes = figure.subplots(1, 3, squeeze=False)[0]
        figure.subplots_adjust(left=0.05, right=0.99, wspace=0.1)
        for axis in axes[len(shown) :]:
            axis.remove()
        for axis, tooth in zip(axes, shown, strict=False):
            depth = np.nan_to_num(arrays.wear_depth_um[tooth - 1])
            z = float(arrays.z_mm[depth.max(axis=(0, 2)).argmax()])
            nominal, worn = section(arrays, tooth, z)
            factor = figures.magnification(nominal, worn)
            figures.tooth_section(axis, nominal, worn, arrays.gear.reference_radius, factor)
            axis.set_title(f"tooth {tooth}, z = {number(z, 1)} mm" + (f", loss × {factor:g}" if factor > 1.0 else ", true scale"))
            # Below the words of the axis, which are as far under a wide tooth, drawn low, as under a slender one.
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, borderaxespad=4.5)
            if axis is not axes[0]:
                axis.set_ylabel("")
        return figure

    return Picture(
        draw, "sections", f"Worn against design: the worst {'tooth' if len(shown) == 1 else f'{len(shown)} teeth'}",
        "Each tooth upright in its own frame, left flank on the left, at the height where its wear is deepest. The filled strip is the lost"
        " metal, magnified by the factor in the title where it would not show at true scale.",
    )  # fmt: skip


def waterfall(loop: Loop, effects: Sequence[FoundEffect]) -> Picture:
    """RMS from before to after, effect by effect."""

    def draw() -> Figure:
        figure = Figure(figsize=(0.78 * FULL, 0.75 + 0.34 * (len(effects) + 2)))
        figures.waterfall(figure.add_axes((0.2, 0.0, 0.8, 1.0)), loop)
        return figure

    return Picture(
        draw, "waterfall", "Residual error, effect by effect",
        "Each bar is what one effect takes away, on the same points throughout. The loop has closed where the last bar meets the scan's own"
        " noise; the diamonds show whether the gain is as large on data the fit never saw.",
    )  # fmt: skip


def residual_maps(arrays: ReportArrays) -> list[Picture]:
    """Residual before and after side by side on one scale; nothing where the loop was left out."""
    before, after = arrays.residual_before_um, arrays.residual_after_um
    if before is None or after is None:
        return []
    if arrays.planar:
        return [gear_charts(arrays, "residual before", before), gear_charts(arrays, "residual after", after)]
    scale = colour_scale(before, after)

    def draw() -> Figure:
        teeth = arrays.gear.teeth
        across = figures.teeth_in_a_row(teeth, 8)
        figure = Figure(figsize=(FULL, 0.7 + 1.25 * -(-teeth // across)))
        left, right = figure.add_axes((0.0, 0.0, 0.435, 1.0)), figure.add_axes((0.49, 0.0, 0.435, 1.0))
        for axis, values, title in ((left, before, "before"), (right, after, "after")):
            figures.flank_map(axis, values, scale, across)
            seen = values[np.isfinite(values)]
            rms = float(np.sqrt(np.square(seen).mean())) if seen.size else float("nan")
            axis.set_title(f"{title}: RMS of the cells {significant(rms)} µm")
            axis.set_xlabel("tooth; each picture root → tip")
        right.set_ylabel("")
        figures.colour_bar(figure.add_axes((0.95, 0.08, 0.012, 0.8)), scale, "residual, µm")
        return figure

    return [Picture(
        draw, "residual", "Residual before and after the loop, same points, one scale",
        "Structure on the left is what the model lacked; on the right only speckle should be left. Cells are means over points, so their RMS"
        f" is below that of the points. Hatched: worn, or not seen. {scale.words}",
    )]  # fmt: skip


def thickness(section: SectionThickness, place: str) -> Picture:
    """Thickness tooth by tooth; `place` says where, in words."""

    def draw() -> Figure:
        figure = Figure(figsize=(FULL, 2.7))
        figures.thickness_per_tooth(figure.add_axes((0.06, 0.1, 0.92, 0.8)), section, place)
        return figure

    return Picture(
        draw, "thick", "Thickness tooth by tooth",
        "The bar runs from the mean to the least, with a whisker of ± 2 standard deviations of the least. Unless the maker left the teeth too thick"
        " or thin, a tooth looks worn there where the whole whisker lies below the dashed line; of many teeth one may do so by chance. An open"
        " triangle is off the scale, its value beside it.",
    )  # fmt: skip


def meshing_curves(curves: MeshingCurves) -> Picture:
    """Backlash and transmission error over a revolution."""

    draw = partial(
        _beside, (FULL, 2.5), [partial(figures.backlash, curves=curves), partial(figures.transmission_error, curves=curves)]
    )
    return Picture(
        draw, "curves", "Backlash and transmission error over a revolution of the scanned gear",
        "Backlash grows while a worn flank carries, and the transmission error drops by the depth the mate sinks in. Where a neighbour still"
        " carries, a single worn tooth does not show in full.",
    )  # fmt: skip


def contact_pattern(share: Floats) -> Picture:
    """Where the flanks are touched."""

    def draw() -> Figure:
        figure, axis, bar = _wide(share.shape[0])
        figures.contact_map(axis, share)
        shade_bar(bar, "Blues", 0.0, 1.0, "share of passings with contact").set_yticks(
            [0.0, 0.5, 1.0], ["never", "half", "always"]
        )
        return figure

    return Picture(
        draw, "contact", "Contact pattern",
        "Dark: the unloaded flank touches its nominal mate at every passing; white: never, as where metal is missing or out of its mate's"
        " reach. Hatched: flanks that do not carry in this direction.",
    )  # fmt: skip


def wear_law(law: WearStudy) -> Picture:
    """The mean worn profile with the law fitted to it, and the forecast where there is one."""
    ahead = law.forecast is not None

    drawn = [partial(figures.worn_profile, law=law), *([partial(figures.greatest_depth, law=law)] if ahead else [])]
    draw = partial(_beside, (FULL if ahead else 0.62 * FULL, 2.7), drawn)
    caption = (
        f"{'Left: m' if ahead else 'M'}ean depth of the worn flanks along the profile, root to tip, with 95 % of its uncertainty, and the law"
        " fitted to it; below the first point, where contact starts, the depth is the law's. Sliding takes nothing at the pitch point and most"
        " at the root; between the dotted lines one pair carries alone."
    )
    caption += " Right: the greatest depth of that mean flank against cycles, with the band of the forecast." if ahead else ""
    return Picture(draw, "wear-law", "Wear law" + (" and forecast" if ahead else ""), caption)


def how_it_ran(running: SecondLoop) -> Picture:
    """The wear of the flanks as measured, by the law, and with the effects of running."""

    def draw() -> Figure:
        number = 3 if running.effects else 2  # without effects the third would be the second again
        figure = Figure(figsize=(FULL * (0.1 + 0.3 * number), 2.3))
        axes = figure.subplots(1, number, sharey=True)
        figure.subplots_adjust(left=0.06, right=0.88, wspace=0.12)
        figures.wear_maps(list(axes), running)
        return figure

    caption = (
        f"Mean depth of {len(running.map.teeth)} {running.map.side} flanks, root at the left: measured; by the wear law alone, which is alike across"
        f" the face{'; and of elastic teeth that wear, with the effects found' if running.effects else ''}. One scale."
    )
    return Picture(draw, "how-it-ran", "How the pair ran", caption)


def loaded_pair(study: LoadedStudy) -> list[Picture]:
    """Transmission error under load with its spectrum, and the load over the flank."""

    error = [partial(figures.loaded_transmission_error, study=study), partial(figures.mesh_spectrum, study=study)]
    shown = Picture(
        partial(_beside, (FULL, 2.6), error, wspace=0.22, width_ratios=[1.6, 1.0]), "loaded-error", "Transmission error under load",
        "Below zero the gear lags. Where two pairs share the load it lags less: a perfect pair has a transmission error under load too, and wear"
        " changes it otherwise than it changes the rigid one.",
    )  # fmt: skip

    return [shown, Picture(
        partial(_beside, (0.62 * FULL, 2.6), [partial(figures.load_map, study=study)], left=0.11), "load-map", "Load over the flank of the pinion",
        "Greatest load per width that each place carries, the mean of all teeth. A load that leans along z is misalignment or uneven wear; at"
        " the ends of the path tip corners carry.",
    )]  # fmt: skip


def across_face(across: AcrossFace) -> Picture:
    """How evenly the flanks are worn across the face."""

    draw = partial(_beside, (0.62 * FULL, 2.2), [partial(figures.across_face, across=across)], left=0.11)
    caption = (
        "Mean depth of the worn flanks across the face, each row the mean over the flank's height, with 95 % of its uncertainty."
    )
    return Picture(draw, "across-face", "Wear across the face", caption)


LINES = "As a stylus takes it, from the points beside the line."
CHARTS = {
    "profile": ("Profile", "A trace per tooth about its own mean line, tip up, more material to the right; the table under each trace is in µm."),
    "helix": ("Helix", "As above along the face width; a worn band shows as a step or a hollow, a helix slope as a lean that all traces share."),
    "pitch": ("Pitch and runout", "A worn flank shows as one tooth out of step; whiskers are U (k = 2)."),
    "profile_middle": ("Profile, along a line", LINES),
    "helix_middle": ("Helix, along a line", LINES),
    "surfaces": (
        "Surfaces", "Mean flanks, slopes and twist of each, waves round the gear, and the tight centre distance with a master gear."
    ),
}  # fmt: skip
"""Names and captions of an inspection's charts in the order of the page."""


def inspection_charts(inspection: Inspection, half: str = "") -> list[Picture]:
    """Charts of the evaluated traces as a measuring machine prints them, and where lines and surfaces were asked for, those; `half` of a double
    helical gear tells their names from those of the other one."""
    from gearwear.report.charts import charts_of

    charts, ident = charts_of(inspection), half and f"-{half}"
    told = [(charts[kind], name, words) for kind, (name, words) in CHARTS.items() if kind in charts]
    return [
        Picture(chart.whole, f"chart{i}{ident}", f"{name} chart", words, False, chart.pages if chart.several else None)
        for i, (chart, name, words) in enumerate(told)
    ]


def gear_charts(arrays: ReportArrays, quantity: str, values: Floats) -> Picture:
    """Profile traces (mean of the middle half of the face) and helix traces (mean of the middle half of the roll)."""
    rows, columns = values.shape[2:]
    profile = _mean(values[:, :, rows // 4 : max(rows - rows // 4, rows // 4 + 1)], 2)
    kinds: list[tuple[str, Floats, Floats, str]] = [("profile", arrays.roll_mm, profile, "roll length, mm")]
    if not arrays.planar:
        helix = _mean(values[..., columns // 4 : columns - columns // 4], 3)
        kinds.append(("helix", arrays.z_mm, helix, "z, mm"))
    bulk = np.abs(profile[np.isfinite(profile)])
    step = 2.0 * colour_scale(np.array([np.quantile(bulk, 0.75) if bulk.size else 1.0])).limit_um

    def draw() -> Figure:
        figure = Figure(figsize=(FULL, 1.0 + 2.2 * len(kinds)))
        axes = figure.subplots(len(kinds), 2, squeeze=False)
        figure.subplots_adjust(left=0.06, right=0.99, wspace=0.1, hspace=0.5)
        for (name, along, data, label), pair in zip(kinds, axes, strict=True):
            for side, colour in zip(Side, (BLUE, TEAL), strict=True):
                figures.traces(pair[side.index], along, data[:, side.index], step, colour)
                pair[side.index].set_title(f"{name}, {side} flanks")
            pair[0].set_ylabel(label)
        return figure

    return Picture(
        draw, "charts-" + quantity.replace(" ", "-"), f"{quantity.capitalize()} as gear charts",
        "A trace per tooth on its own line; to the right of the line is too much material, to the left missing."
        + ("" if arrays.planar else " Profile: mean over the middle half of the face; helix: over the middle half of the roll.")
        + " A triangle marks traces cut off at the neighbour's line.",
    )  # fmt: skip


def _mean(values: Floats, axis: int) -> Floats:
    """Mean of what was seen; nan where nothing was."""
    seen = np.isfinite(values)
    count = seen.sum(axis=axis)
    return np.where(count > 0, np.where(seen, values, 0.0).sum(axis=axis) / np.maximum(count, 1), np.nan)
