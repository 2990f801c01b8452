"""Figures of a pair in mesh, as gear people draw them: the line of action with its points, and the sliding along it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.path import PathOfContact, Sliding
from gearwear.report.figures.colours import BLUE, INK, MUTED, ORANGE, RULE, TEAL
from gearwear.report.figures.given import check_axis, check_drawn
from gearwear.report.figures.legend import legend_above

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEEPEST = 8.0
"""Specific sliding beyond which the axis is cut off: near a base circle it has no bound."""


def pair_in_mesh(axis: Axes, pinion: Gear, gear: Gear, exact: ExactMeshing) -> Axes:
    """The transverse section round the mesh, to scale: both gears, line of action, path of contact with its points.

    Parameters
    ----------
    axis : Axes
        Where to draw. The pinion is below, its axis at the origin, and turns counter-clockwise.
    pinion, gear : Gear
        The pair as designed.
    exact : ExactMeshing
        Its relations at the centre distance to draw.

    Returns
    -------
    Axes
    """
    check_axis(axis)
    check_drawn(Gear, pinion=pinion, gear=gear)
    check_drawn(ExactMeshing, exact=exact)
    from matplotlib.patheffects import withStroke

    alpha, path, centre = exact.working_pressure_angle, exact.path, exact.centre_distance
    orientation = gear.orientation
    roll = min(max(path.pitch_pinion, path.start_pinion), path.end_pinion)  # touching in C, or as near to it as the path goes
    turns = (
        -alpha - pinion.base_half_angle + roll / pinion.base_radius,
        (math.pi if orientation > 0 else 0.0)
        - alpha
        - orientation * (gear.base_half_angle - (path.line - roll) / gear.base_radius),
    )

    def upright(points: Floats) -> Floats:
        """The line of centres, +x in the formulas, is drawn upwards."""
        return np.column_stack([-points[:, 1], points[:, 0]])

    def on_line(rolls: Sequence[float]) -> Floats:
        start = pinion.base_radius * np.array([math.cos(alpha), -math.sin(alpha)])
        return upright(start + np.asarray(rolls)[:, None] * [math.sin(alpha), math.cos(alpha)])

    angle = np.linspace(-math.pi, math.pi, 3601)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    for member, turn, shift, fill, pitch in (
        (pinion, turns[0], 0.0, "#e3ecf4", exact.pitch_radius_pinion),
        (gear, turns[1], orientation * centre, "#f4ece0", exact.pitch_radius_gear),
    ):
        origin, layer = np.array([shift, 0.0]), 1.0
        if member.orientation < 0:  # metal up to its outside, the space in it left white, under the pinion
            outside, fill, layer = member.rim_radius, "white", 0.9
            axis.fill(*upright(outside * ring + origin).T, facecolor="#f4ece0", edgecolor=INK, linewidth=0.9, zorder=0.8)
        axis.fill(*upright(_outline(member, turn) + origin).T, facecolor=fill, edgecolor=INK, linewidth=0.9, zorder=layer)
        circles = ((member.base_radius, (0, (1, 1.5)), 0.9), (pitch, (0, (6, 2, 1, 2)), 0.7))
        for radius, dashes, width in circles:
            axis.plot(*upright(radius * ring + origin).T, color=MUTED, linestyle=dashes, linewidth=width, zorder=2)
    for label, dashes, width in (("base circles", (0, (1, 1.5)), 0.9), ("operating pitch circles", (0, (6, 2, 1, 2)), 0.7)):
        axis.plot([], [], color=MUTED, linestyle=dashes, linewidth=width, label=label)
    axis.plot(*on_line([0.0, path.line]).T, color=ORANGE, linewidth=0.9, label="line of action", zorder=4)
    ends = on_line([0.0, path.line])
    axis.plot(*ends.T, "o", color=ORANGE, markerfacecolor="white", markersize=4, zorder=5)
    axis.plot(*on_line([path.start_pinion, path.end_pinion]).T, color=ORANGE, linewidth=3.0, label="path of contact", zorder=4)
    points = path.named_points
    at = on_line(list(points.values()))
    axis.plot(*at.T, "o", color=INK, markersize=3.2, zorder=6)
    reach = 0.035 * float(np.ptp(at, axis=0).max() + 3.0 * pinion.transverse_module)
    across = reach * np.array([math.sin(alpha), math.cos(alpha)])  # beside the line, towards the gear
    for name, place in [*zip(points, at, strict=True), ("T₁", ends[0]), ("T₂", ends[1])]:
        colour = ORANGE if name.startswith("T") else INK
        x, y = (place + across).tolist()
        halo = [withStroke(linewidth=2.2, foreground="white")]
        axis.text(x, y, name, ha="center", va="center", color=colour, fontsize=9, zorder=7, clip_on=True, path_effects=halo)
    margin = 1.3 * pinion.transverse_module
    low, high = at.min(axis=0) - margin, at.max(axis=0) + margin
    half = 0.5 * float((high - low).max())
    middle = 0.5 * (low + high)
    axis.set(aspect="equal", xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    axis.set(xlabel="across the line of centres, mm", ylabel="from the pinion's axis, mm")
    legend_above(axis, 2)
    return axis


def _outline(gear: Gear, turn: float) -> Floats:
    """Closed outline with a tooth centre at the polar angle `turn`, mm; it starts in the middle of the space before that tooth."""
    radius = gear.root_radius + (gear.flank_end_radius - gear.root_radius) * np.linspace(0.0, 1.0, 160) ** 2
    psi = gear.half_angle(radius)
    land = np.linspace(-gear.tip_half_angle, gear.tip_half_angle, 9)
    bottom = 0.5 * gear.pitch_angle - np.linspace(0.0, gear.root_half_angle, 9)
    angle = np.concatenate([-bottom, -psi, land, psi[::-1], bottom[::-1]])
    root, tip = np.full(len(bottom), gear.root_radius), np.full(len(land), gear.tip_radius)
    reach = np.concatenate([root, radius, tip, radius[::-1], root])
    whole = turn + gear.pitch_angle * np.arange(gear.teeth)[:, None] + angle
    polar = np.exp(1j * whole.ravel()) * np.tile(reach, gear.teeth)
    return np.column_stack([polar.real, polar.imag])


def specific_sliding(axis: Axes, slid: Sliding, path: PathOfContact) -> Axes:
    """Specific sliding of both flanks along the path of contact.

    Parameters
    ----------
    axis : Axes
        Where to draw.
    slid : Sliding
        Along the path, as `PairStudy.sliding` has it.
    path : PathOfContact

    Returns
    -------
    Axes
    """
    check_axis(axis)
    check_drawn(Sliding, slid=slid)
    check_drawn(PathOfContact, path=path)
    axis.plot(slid.roll_pinion, slid.specific_pinion, color=BLUE, label="pinion")
    axis.plot(slid.roll_pinion, slid.specific_gear, color=ORANGE, linestyle=(0, (6, 2)), label="gear")
    lowest = min(slid.specific_pinion.min(), slid.specific_gear.min())
    axis.set_ylim(max(1.12 * lowest, -STEEPEST), 1.0 - 0.22 * max(lowest, -STEEPEST))
    axis.set_ylabel("specific sliding")
    return _along(axis, path)


def sliding_velocity(axis: Axes, slid: Sliding, path: PathOfContact) -> Axes:
    """Sliding velocity along the path of contact, at 1 rad/s of the pinion; arguments as `specific_sliding`."""
    check_axis(axis)
    check_drawn(Sliding, slid=slid)
    check_drawn(PathOfContact, path=path)
    axis.plot(slid.roll_pinion, slid.velocity, color=TEAL, label="gear over pinion, + towards the pinion's tip")
    axis.set_ylim(1.15 * min(slid.velocity[0], 0.0) - 0.5, 1.3 * max(slid.velocity[-1], 0.0) + 0.5)
    axis.set_ylabel("sliding velocity at\n1 rad/s of the pinion, mm/s")
    return _along(axis, path)


def _along(axis: Axes, path: PathOfContact) -> Axes:
    """The path as abscissa: named points, and where one pair carries alone."""
    axis.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)
    alone = path.alone_pinion
    if alone is not None:
        axis.axvspan(*alone, color="#e6eaed", linewidth=0, zorder=0, label="one pair alone")
    for name, roll in path.named_points.items():
        axis.axvline(roll, color=RULE, linewidth=0.8, zorder=1)
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8}
        axis.text(roll, 0.985, name, transform=axis.get_xaxis_transform(), ha="center", va="top", bbox=box)
    space = 0.03 * path.length
    axis.set_xlim(path.start_pinion - space, path.end_pinion + space)
    axis.set_xlabel("roll length on the pinion, mm (A start, E end of contact)")
    axis.grid(axis="y")
    legend_above(axis, 3)
    return axis
