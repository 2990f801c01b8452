"""Edges of flanks, at tips and at the ends of the face, cut from a finished scan by straight bevels; nothing here comes from `gearwear`.

In a tooth's own plane, its centre line up, metal beyond a line from the flank to the land is gone: points there lie on the line instead.
"""

from __future__ import annotations

import numpy as np

from tests.synthetic.outline import Bools, Floats, GearNumbers, Outline


def bevelled(points: Floats, numbers: GearNumbers, along_flank: float, along_land: float, which: Bools | None = None) -> Floats:
    """Points (n, 3) of a spur gear in the design's frame, with bevels that take so much of flank and land, mm, lengths along each.

    Parameters
    ----------
    which : (teeth, 2) bool or None
        The edges, left and right of each tooth; None: all.
    """
    outline = Outline.of(numbers)
    pitch = 2.0 * np.pi / numbers.teeth
    angle = np.arctan2(points[:, 1], points[:, 0])
    tooth = np.rint(angle / pitch)
    within = angle - tooth * pitch
    radius, side = np.hypot(points[:, 0], points[:, 1]), np.where(within < 0.0, -1.0, 1.0)
    across, up = radius * np.sin(np.abs(within)), radius * np.cos(within)
    low, high = _ends(outline, along_flank, along_land)
    line = (high - low) / np.hypot(*(high - low))
    outwards = np.array([line[1], -line[0]])
    beyond = (across - low[0]) * outwards[0] + (up - low[1]) * outwards[1]
    cut = beyond > 0.0
    if which is not None:
        cut &= which[tooth.astype(int) % numbers.teeth, (side < 0.0).astype(int)]
    across, up = np.where(cut, across - beyond * outwards[0], across), np.where(cut, up - beyond * outwards[1], up)
    turned = tooth * pitch + side * np.arctan2(across, up)
    return np.column_stack([np.hypot(across, up) * np.cos(turned), np.hypot(across, up) * np.sin(turned), points[:, 2]])


def bevelled_ends(
    points: Floats, numbers: GearNumbers, along_face: Floats, below_flank: Floats, which: Bools | None = None
) -> Floats:
    """Points (n, 3) of a spur gear in the design's frame, with bevels at the ends of the face that begin so far from these and reach so far below the flank,
    mm, (2, 2) each: at the low and the high end, on left and right flanks; 0 for none.

    A turn by δ / r_b moves a point by δ along the base tangent, which is the normal of the involute.

    Parameters
    ----------
    which : (teeth,) bool or None
        The teeth that have them; None: all.
    """
    outline = Outline.of(numbers)
    pitch, result = 2.0 * np.pi / numbers.teeth, points.copy()
    angle, radius = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
    tooth = np.rint(angle / pitch)
    within = angle - tooth * pitch
    roll = np.sqrt(np.maximum(radius**2 - outline.base_radius**2, 0.0))
    half = outline.base_half_angle - (roll / outline.base_radius - np.arctan2(roll, outline.base_radius))
    for end, height in enumerate((points[:, 2], numbers.face_width - points[:, 2])):
        for index, side in enumerate((1.0, -1.0)):
            reach, depth = along_face[end, index], below_flank[end, index]
            if reach == 0.0:
                continue
            allowed = half - depth * (1.0 - height / reach) / outline.base_radius
            cut = (height < reach) & (side * within > allowed)
            if which is not None:
                cut &= which[tooth.astype(int) % numbers.teeth]
            turned = tooth[cut] * pitch + side * allowed[cut]
            result[cut, 0], result[cut, 1] = radius[cut] * np.cos(turned), radius[cut] * np.sin(turned)
    return result


def height_of(numbers: GearNumbers, along_flank: float) -> float:
    """How far below the tip a length along the flank from the tip corner ends, mm: its arc length is (L_a² − L²) / 2 r_b."""
    outline = Outline.of(numbers)
    roll = np.sqrt(outline.tip_roll**2 - 2.0 * outline.base_radius * along_flank)
    return float(outline.tip_radius - np.hypot(roll, outline.base_radius))


def _ends(outline: Outline, along_flank: float, along_land: float) -> tuple[Floats, Floats]:
    """Ends of the bevel on flank and land, (across, up) mm."""
    radius = outline.tip_radius - height_of(outline.numbers, along_flank)
    roll = np.sqrt(radius**2 - outline.base_radius**2)
    half = outline.base_half_angle - (roll / outline.base_radius - np.arctan2(roll, outline.base_radius))
    land = outline.tip_half_angle - along_land / outline.tip_radius
    return (
        radius * np.array([np.sin(half), np.cos(half)]),
        outline.tip_radius * np.array([np.sin(land), np.cos(land)]),
    )
