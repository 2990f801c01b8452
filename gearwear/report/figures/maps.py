"""The figures: each function draws on an axis and returns it. Deviations in µm, + is too much material."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.given import check_whole, check_within
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.found import Loop
from gearwear.report.figures.arrays import MeshingCurves
from gearwear.report.figures.colours import ALARM, BLUE, DIVERGING, INK, LOST, MUTED, ORANGE, RULE, TEAL, UNSEEN, ColourScale
from gearwear.report.figures.given import check_above_zero, check_arrays, check_axis, check_colour, check_drawn
from gearwear.report.figures.legend import legend_above
from gearwear.report.words.numbers import effect_title
from gearwear.wear.thickness import SectionThickness

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap

STYLE: dict[Any, Any] = {
    "font.family": ["sans-serif"], "font.size": 8.5, "svg.fonttype": "none", "svg.hashsalt": "gearwear", "pdf.fonttype": 42,
    "axes.edgecolor": MUTED, "axes.labelcolor": INK, "axes.linewidth": 0.6, "axes.titlesize": 8.5, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.titley": 1.0, "axes.spines.top": False, "axes.spines.right": False,
    "xtick.color": MUTED, "ytick.color": MUTED, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6, "grid.color": RULE, "grid.linewidth": 0.5,
    "legend.frameon": False, "legend.fontsize": 8.0, "hatch.linewidth": 0.6, "hatch.color": "#8d949b", "lines.linewidth": 1.2,
}  # fmt: skip
"""matplotlib settings for all figures of the report (`matplotlib.rc_context(STYLE)`). Titles have their height: to search for one takes as long as to draw them."""


SHADES = 256
"""Colours of a bar."""

WHISKER = 2.0
"""Standard deviations that a whisker of the least thickness reaches."""


def teeth_in_a_row(teeth: int, most: int = 16) -> int:
    """Teeth side by side in an unrolled map: rows of even length, none longer than `most`.

    >>> [teeth_in_a_row(z) for z in (12, 24, 37)]
    [12, 12, 13]
    """
    check_whole("teeth", teeth, 1)
    check_whole("most", most, 1)
    return math.ceil(teeth / math.ceil(teeth / most))


def thinned(values: Floats, most: int = 120_000) -> Floats:
    """The same maps with fewer cells, by means over blocks of what was seen, where there are more than `most` in all."""
    check_arrays(values=(values, ("teeth", 2, "n_z", "n_L")))
    check_whole("most", most, 1)
    factor = math.ceil(math.sqrt(values.size / most))
    if factor == 1:
        return values
    seen = np.isfinite(values)
    parts = [np.where(seen, values, 0.0), seen.astype(np.float64)]
    for axis in (2, 3):
        parts = [np.add.reduceat(part, np.arange(0, part.shape[axis], factor), axis=axis) for part in parts]
    return np.where(parts[1] > 0.0, parts[0] / np.maximum(parts[1], 1.0), np.nan)


def flank_map(axis: Axes, values_um: Floats, scale: ColourScale, across: int | None = None) -> Axes:
    """All flanks unrolled: a picture per flank, root left and tip right, z upwards; unseen cells hatched.

    Parameters
    ----------
    axis : Axes
        Where to draw.
    values_um : (teeth, 2, n_z, n_L) float
        Deviation; nan is drawn as unseen.
    scale : ColourScale
        The signed scale.
    across : int or None
        Teeth in a row; None: `teeth_in_a_row`.

    Returns
    -------
    Axes
        Its image runs from −1 to 1 on the scale.
    """
    check_axis(axis)
    check_arrays(values_um=(values_um, ("teeth", 2, "n_z", "n_L")))
    check_drawn(ColourScale, scale=scale)
    if across is not None:
        check_whole("across", across, 1)
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    values_um = thinned(values_um)
    teeth, _, rows, columns = values_um.shape
    across = across or teeth_in_a_row(teeth)
    blocks = math.ceil(teeth / across)
    gap_x, gap_y = max(1, round(0.10 * columns)), max(1, round(0.08 * rows))
    step_x, step_y = columns + gap_x, rows + gap_y
    tall = 2 * step_y + gap_y * 2  # a row of teeth: left above right, and air below
    canvas, frames = np.full((blocks * tall, across * step_x), np.nan), []
    for tooth in range(teeth):
        block, place = divmod(tooth, across)
        for side in (0, 1):
            bottom, left = (blocks - 1 - block) * tall + (1 - side) * step_y + gap_y, place * step_x
            right, top = left + columns, bottom + rows
            frames.append(Path([(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)], closed=True))
            canvas[bottom : bottom + rows, left : left + columns] = scale.fraction(values_um[tooth, side])
        axis.text(left + 0.5 * columns, bottom + 2 * step_y, str(tooth + 1), ha="center", va="center", fontsize=8, color=INK)
    # One artist for all grounds and one for all frames: hundreds of patches take longer than the picture itself.
    outlines = Path.make_compound_path(*frames)
    axis.add_patch(PathPatch(outlines, facecolor="#e4e7ea", linewidth=0.0, hatch="////", zorder=0.5))
    axis.add_patch(PathPatch(outlines, facecolor="none", edgecolor=MUTED, linewidth=0.4, zorder=3))
    high, wide = canvas.shape
    axis.imshow(
        np.ma.masked_invalid(canvas), cmap=colours(), vmin=-1.0, vmax=1.0, origin="lower", extent=(0, wide, 0, high),
        interpolation="none", aspect="auto", zorder=1,
    )  # fmt: skip
    axis.set(xlim=(-0.5 * gap_x, wide), ylim=(0, high + 2.2 * gap_y))
    axis.set_xticks([])
    middles = [
        (blocks - 1 - block) * tall + (1 - side) * step_y + gap_y + 0.5 * rows for block in range(blocks) for side in (0, 1)
    ]
    axis.set_yticks(middles, ["left", "right"] * blocks)
    axis.tick_params(length=0)
    axis.set_xlabel("tooth (number above); each picture: roll length, root → tip")
    axis.set_ylabel("flank; each picture: z, 0 → face width")
    for spine in axis.spines.values():
        spine.set_visible(False)
    return axis


def colours() -> Colormap:
    """The diverging map of the scale."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("deviation", list(DIVERGING))


def shade_bar(axis: Axes, shades: str | Colormap, low: float, high: float, label: str) -> Axes:
    """Draw a scale of colours upright on `axis`, its ticks on the right.

    A picture of one column: a bar of matplotlib's draws each of its colours by itself, in ten times as long.
    """
    axis.imshow(
        np.linspace(0.0, 1.0, SHADES)[:, None], cmap=shades, origin="lower", extent=(0.0, 1.0, low, high), interpolation="none", aspect="auto"
    )  # fmt: skip
    axis.set_xticks([])
    axis.set_ylabel(label)
    axis.tick_params(length=2, labelsize=8, left=False, right=True, labelleft=False, labelright=True)
    axis.yaxis.set_label_position("right")
    axis.spines[:].set_visible(True)
    return axis


def colour_bar(axis: Axes, scale: ColourScale, label: str = "deviation, µm (+ too much, − missing)", high: float = 1.0) -> Axes:
    """Draw the legend of the signed scale on `axis`, up to `high` on it; 0: of depths, which have no sign."""
    check_axis(axis)
    check_drawn(ColourScale, scale=scale)
    check_within("high", high, 0.0, 1.0, "a number from 0, of depths, to 1")
    shade_bar(axis, colours(), -1.0, 1.0, label)
    ticks = [
        (at, text)
        for at, text in zip(scale.fraction(np.array(scale.ticks_um)).tolist(), scale.tick_labels, strict=True)
        if at <= high
    ]
    axis.set_yticks([at for at, _ in ticks], [text if high > 0.0 else text.lstrip("−") for _, text in ticks])
    axis.set_ylim(-1.0, high)
    axis.spines[:].set_visible(False)
    return axis


def contact_map(axis: Axes, share: Floats) -> Axes:
    """Contact pattern: dark where a cell is touched at every passing, white where never (arrays as `flank_map`, 0 … 1)."""
    check_arrays(share=(share, ("teeth", 2, "n_z", "n_L")))
    flank_map(axis, share, ColourScale(1.0))
    axis.images[-1].set(cmap="Blues", clim=(0.0, 1.0))
    return axis


def waterfall(axis: Axes, loop: Loop) -> Axes:
    """RMS from before to after, effect by effect; diamonds are the same on teeth or blocks left out of the fit.

    Parameters
    ----------
    axis : Axes
        Where to draw.
    loop : Loop
        What was found besides wear.

    Returns
    -------
    Axes
    """
    check_axis(axis)
    check_drawn(Loop, loop=loop)
    effects = [effect for effect in loop.effects if effect.kind is not Kind.WEAR]
    bars = [("after registration", 0.0, 1e3 * loop.rms_before, 1e3 * loop.held_out_before, MUTED)]
    for effect in effects:
        low, high, held_out = (1e3 * rms for rms in (effect.rms_after, effect.rms_before, effect.held_out_after))
        bars.append((effect_title(effect.name), low, high, held_out, BLUE))
    if effects:
        bars.append(("what is left", 0.0, 1e3 * loop.rms_after, 1e3 * loop.held_out_after, TEAL))
    most = max([high for _, _, high, _, _ in bars if high], default=1.0)
    held = []
    for row, (_, low, high, heldout, colour) in enumerate(bars):
        axis.barh(row, high - low, left=low, height=0.62, color=colour, zorder=2)
        inner = row > 0 and colour == BLUE
        text = (f"−{high - low:.2f}" if high >= low else f"+{low - high:.2f}") if inner else f"{high:.2f}"
        axis.text(
            max(low, high, heldout if math.isfinite(heldout) else 0.0) + 0.025 * most,
            row,
            text,
            va="center",
            ha="left",
            color=INK,
            fontsize=8,
        )
        if row + 1 < len(bars):
            edge = high if row == 0 else low
            axis.plot([edge, edge], [row + 0.31, row + 0.69], color=MUTED, lw=0.7, zorder=1)
        if math.isfinite(heldout):
            held.append((heldout, row))
    if held:
        x, y = zip(*held, strict=True)
        axis.plot(x, y, "D", ms=4, mfc="white", mec=INK, mew=0.9, zorder=4, label="on teeth left out of the fit")
    noise = 1e3 * loop.noise
    if noise:
        axis.axvline(noise, color=ORANGE, ls=(0, (4, 2)), lw=1.1, zorder=3, label=f"the scan's own noise, {noise:.2f} µm")
    axis.set_yticks(range(len(bars)), [bar[0] for bar in bars])
    axis.tick_params(axis="y", length=0)
    axis.invert_yaxis()
    axis.set(xlim=(0, 1.18 * most), xlabel="RMS of the residual outside wear, µm")
    axis.grid(axis="x", zorder=0)
    if held or noise:
        legend_above(axis, 2)
    return axis


def tooth_section(axis: Axes, nominal_xy: Floats, worn_xy: Floats, reference_radius_mm: float, magnify: float = 1.0) -> Axes:
    """A tooth worn against nominal, lost metal filled.

    Parameters
    ----------
    axis : Axes
        Where to draw.
    nominal_xy, worn_xy : (n, 2) float
        Outlines in mm, point by point, tooth upright with the gear axis at the origin.
    reference_radius_mm : float
        Drawn as a dotted arc.
    magnify : float
        Factor on the difference; 1 is true scale.

    Returns
    -------
    Axes
    """
    check_axis(axis)
    check_arrays(nominal_xy=(nominal_xy, ("n", 2)), worn_xy=(worn_xy, ("n", 2)))
    check_above_zero(reference_radius_mm=reference_radius_mm, magnify=magnify)
    shown = nominal_xy + magnify * (worn_xy - nominal_xy)
    axis.fill(
        np.concatenate([nominal_xy[:, 0], shown[::-1, 0]]), np.concatenate([nominal_xy[:, 1], shown[::-1, 1]]),
        color=LOST, alpha=0.85, lw=0, label="metal lost" if magnify == 1.0 else f"metal lost, × {magnify:g}",
    )  # fmt: skip
    axis.fill(*shown.T, color="#e9edf0", lw=0, zorder=0)
    axis.plot(*nominal_xy.T, color=MUTED, lw=0.9, ls=(0, (5, 2)), label="design")
    axis.plot(*shown.T, color=INK, lw=1.2, label="worn")
    half = float(np.abs(nominal_xy[:, 0]).max())
    angle = np.linspace(-1.15, 1.15, 40) * half / reference_radius_mm
    axis.plot(
        reference_radius_mm * np.sin(angle),
        reference_radius_mm * np.cos(angle),
        ":",
        color=BLUE,
        lw=0.9,
        label="reference circle",
    )
    axis.set(aspect="equal", xlabel="across the tooth, mm", ylabel="from the gear axis, mm")
    axis.locator_params(axis="x", nbins=5)
    return axis


def magnification(nominal_xy: Floats, worn_xy: Floats, share: float = 0.06) -> float:
    """Round factor that makes the greatest difference about `share` of the tooth's height; 1 if it already is.

    >>> import numpy as np
    >>> line = np.array([[0.0, 0.0], [0.0, 10.0]])
    >>> magnification(line, line + [0.01, 0.0])
    50.0
    """
    check_arrays(nominal_xy=(nominal_xy, ("n", 2)), worn_xy=(worn_xy, ("n", 2)))
    check_above_zero(share=share)
    worst = float(np.hypot(*(worn_xy - nominal_xy).T).max(initial=0.0))
    wanted = share * float(np.ptp(nominal_xy[:, 1])) / max(worst, 1e-9)
    return max((f for f in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0) if f <= wanted), default=1.0)


def usual_range(values: Floats) -> tuple[float, float]:
    """Least and greatest of what lies near the many: within six times the middle half's width of it, so that one pit sets no scale.

    >>> usual_range(np.array([1.0, 1.1, 1.2, 1.3, 9.0]))
    (1.0, 1.3)
    """
    first, last = np.quantile(values, [0.25, 0.75])
    room = 6.0 * max(float(last - first), 1e-3)
    near = values[(values >= first - room) & (values <= last + room)]
    return float(near.min()), float(near.max())


def thickness_per_tooth(axis: Axes, thickness: SectionThickness, place: str = "at the reference circle") -> Axes:
    """Arc thickness, `place` says where: the mean over the face and the least, tooth by tooth, against the design."""
    check_axis(axis)
    check_drawn(SectionThickness, thickness=thickness)
    teeth = thickness.teeth()
    tooth = np.array([tooth.tooth + 1.0 for tooth in teeth])
    names = ("mean", "least", "nominal", "least_std")
    mean, least, nominal, std = (np.array([getattr(tooth, name) for tooth in teeth]) for name in names)
    whisker = WHISKER * np.nan_to_num(std)
    axis.plot(tooth, nominal, color=MUTED, ls=(0, (5, 2)), lw=1.0, label="design")
    many = np.concatenate([least - whisker, least + whisker, mean, nominal])
    low, high = usual_range(many[np.isfinite(many)])
    below = least < low  # they are drawn to the edge, with their value beside
    axis.vlines(tooth, np.maximum(least, low), np.maximum(mean, low), color=LOST, lw=3.0, alpha=0.55)
    axis.plot(tooth, mean, "o", color=INK, ms=4.5, label="mean over the face width")
    axis.vlines(tooth[~below], (least - whisker)[~below], (least + whisker)[~below], color=LOST, lw=0.9)
    axis.plot(tooth, np.where(below, np.nan, least), "v", color=LOST, ms=5, label="least, any z")
    margin = max(0.08 * (high - low), 0.002)
    for x, y in zip(tooth[below], least[below], strict=True):
        axis.plot(x, low - 0.4 * margin, "v", color=LOST, ms=5, mfc="white")
        axis.annotate(f"{y:.3f}", (x, low), (4, -2), textcoords="offset points", color=LOST, fontsize=8)
    axis.set(xlabel="tooth", ylabel=f"thickness {place}, mm", xlim=(tooth.min() - 0.6, tooth.max() + 0.6))
    axis.set_ylim(low - margin, high + margin)
    axis.ticklabel_format(axis="y", useOffset=False)
    if len(tooth) <= 36:
        axis.set_xticks(tooth, [f"{t:g}" for t in tooth])
    axis.grid(axis="y")
    legend_above(axis, 3)
    return axis


def transmission_error(axis: Axes, curves: MeshingCurves, label: str = "worn") -> Axes:
    """Transmission error of the worn gear over one revolution; the design's is zero."""
    check_axis(axis)
    check_drawn(MeshingCurves, curves=curves)
    axis.axhline(0.0, color=MUTED, ls=(0, (5, 2)), lw=1.0, label="design")
    axis.plot(curves.rotation_deg, curves.transmission_error_um, color=BLUE, label=label)
    axis.set(xlabel="rotation of the pinion, °", ylabel="transmission error on\nthe line of action, µm")
    low, high = axis.get_ylim()
    if high - low < 1.0:  # rounding is to look flat
        axis.set_ylim(0.5 * (low + high) - 0.5, 0.5 * (low + high) + 0.5)
    return _over_a_turn(axis, curves)


def backlash(axis: Axes, curves: MeshingCurves, label: str = "worn") -> Axes:
    """Circumferential backlash over one revolution, design against worn."""
    check_axis(axis)
    check_drawn(MeshingCurves, curves=curves)
    axis.plot(curves.rotation_deg, 1e-3 * curves.backlash_design_um, color=MUTED, ls=(0, (5, 2)), lw=1.0, label="design")
    axis.plot(curves.rotation_deg, 1e-3 * curves.backlash_worn_um, color=ORANGE, label=label)
    axis.set(xlabel="rotation of the pinion, °", ylabel="circumferential\nbacklash, mm")
    low, high = axis.get_ylim()
    # Of a play that is the same all round only rounding makes a range: its line lay on the frame.
    high = max(high, 1.05e-3 * float(max(curves.backlash_design_um.max(), curves.backlash_worn_um.max())), 0.01)
    axis.set_ylim(low if low < -0.05 * high else -0.05 * high, high)
    return _over_a_turn(axis, curves)


def _over_a_turn(axis: Axes, curves: MeshingCurves) -> Axes:
    end = float(curves.rotation_deg[-1])
    axis.set_xlim(curves.rotation_deg[0], end)
    axis.set_xticks(np.arange(0.0, end + 1.0, 30.0 if end <= 360.0 else 90.0 * math.ceil(end / 1080.0)))
    axis.grid()
    legend_above(axis, 2)
    return axis


def traces(axis: Axes, along_mm: Floats, deviation_um: Floats, um_per_tooth: float, colour: str) -> Axes:
    """Gear chart: a trace per tooth, side by side, to the right is too much material.

    Parameters
    ----------
    axis : Axes
        Where to draw.
    along_mm : (n,) float
        Roll length (profile) or z (helix).
    deviation_um : (teeth, n) float
        Deviation; nan was not seen.
    um_per_tooth : float
        Deviation that reaches to the next tooth's line; larger ones are cut off there.
    colour : str
        Of the traces.

    Returns
    -------
    Axes
    """
    check_axis(axis)
    check_arrays(along_mm=(along_mm, ("n",)), deviation_um=(deviation_um, ("teeth", "n")))
    check_above_zero(um_per_tooth=um_per_tooth)
    check_colour(colour)
    teeth = len(deviation_um)
    number = np.arange(1, teeth + 1)
    axis.vlines(number, along_mm[0], along_mm[-1], color=RULE, lw=0.8, zorder=1)
    shifted = number[:, None] + np.clip(deviation_um / um_per_tooth, -0.95, 0.95)
    axis.plot(shifted.T, along_mm, color=colour, lw=1.0, zorder=2)
    cut = (np.abs(deviation_um) > 0.95 * um_per_tooth).any(axis=1)
    axis.plot(number[cut], np.full(cut.sum(), along_mm[-1]), "v", color=ALARM, ms=4, clip_on=False, zorder=3)
    axis.set_xlim(0.0, teeth + 1.0)
    axis.set_xticks(number[:: -(-teeth // 16)])
    axis.set_xlabel(f"tooth; one tooth further is {um_per_tooth:g} µm")
    return axis


def outline(axis: Axes, nominal_xy: Floats, worn_xy: Floats, deviation_um: Floats, scale: ColourScale) -> Axes:
    """The whole gear as one section, coloured by deviation: the picture of a planar scan.

    Parameters
    ----------
    axis : Axes
        Where to draw.
    nominal_xy, worn_xy : (n, 2) float
        Closed outlines, mm.
    deviation_um : (n,) float
        At the points of `worn_xy`; nan is drawn grey.
    scale : ColourScale
        The signed scale.

    Returns
    -------
    Axes
    """
    check_axis(axis)
    check_arrays(nominal_xy=(nominal_xy, ("m", 2)), worn_xy=(worn_xy, ("n", 2)), deviation_um=(deviation_um, ("n",)))
    check_drawn(ColourScale, scale=scale)
    from matplotlib.collections import LineCollection

    axis.fill(*nominal_xy.T, color="#eef1f3", lw=0)
    axis.plot(*nominal_xy.T, color=MUTED, lw=0.5)
    pieces = np.stack([worn_xy[:-1], worn_xy[1:]], axis=1)
    middle = 0.5 * (deviation_um[:-1] + deviation_um[1:])
    seen = np.isfinite(middle)
    axis.add_collection(LineCollection(list(pieces[~seen]), colors=UNSEEN, linewidths=1.5))
    lines = LineCollection(list(pieces[seen]), cmap=colours(), linewidths=3.0, capstyle="round")
    lines.set_array(scale.fraction(middle[seen]))
    lines.set_clim(-1.0, 1.0)
    axis.add_collection(lines)
    axis.set(aspect="equal", xlabel="x, mm", ylabel="y, mm")
    return axis
