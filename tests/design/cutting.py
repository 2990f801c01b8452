"""A rack rolled past a blank: whether it cuts a point, from nothing but the rack's own straight-line and arc profile."""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats
from gearwear.design import GearSpec

STEPS = 1501


def cut_depth(spec: GearSpec, radius: Floats, angle: Floats) -> Floats:
    """How deep the rack ever gets over points of the blank.

    Parameters
    ----------
    spec : GearSpec
        The gear; its rack is drawn from it.
    radius, angle : (n,) float
        Polar coordinates of the points, the angle from the centre line of a space; mm, rad.

    Returns
    -------
    (n,) float
        Greatest depth inside the rack's tooth over the whole roll, mm; positive where the point is cut away.
    """
    reach = 10.0 * spec.normal_module / (0.5 * spec.normal_module * spec.teeth)
    turn = np.linspace(-reach, reach, STEPS) + np.zeros((len(radius), 1))
    for _ in range(2):  # the deepest moment, then closer round it
        depth = _depth(spec, radius[:, None], angle[:, None], turn)
        deepest = np.take_along_axis(turn, depth.argmax(axis=1)[:, None], axis=1)
        turn = deepest + (turn[:, 1] - turn[:, 0])[:, None] * np.linspace(-1.0, 1.0, STEPS)
    return np.asarray(_depth(spec, radius[:, None], angle[:, None], turn).max(axis=1), dtype=np.float64)


def _depth(spec: GearSpec, radius: Floats, angle: Floats, turn: Floats) -> Floats:
    """Depth inside the rack's tooth when the gear has turned by `turn` and the rack moved along."""
    r = 0.5 * spec.normal_module * spec.teeth
    below = r - radius * np.cos(angle + turn)
    across = np.abs(radius * np.sin(angle + turn) - r * turn)
    return _inside(spec, below, across)


def _inside(spec: GearSpec, below: Floats, across: Floats) -> Floats:
    """Depth inside the rack's tooth, + within, of points below the pitch line and to the side of its centre line, mm."""
    m, alpha = spec.normal_module, spec.normal_pressure_angle
    rho = spec.rack_tip_radius * m
    tip = (spec.dedendum - spec.profile_shift) * m  # below the pitch line
    half_width = 0.25 * math.pi * m + 0.5 * spec.thinning  # on the rack's reference line, x m above the pitch line
    flank = (half_width - (below + spec.profile_shift * m) * math.tan(alpha) - across) * math.cos(alpha)
    depth = np.minimum(flank, tip - below)
    notch = spec.protuberance - spec.grinding_stock
    centre_below = tip - rho
    centre_across = half_width - (centre_below + spec.profile_shift * m) * math.tan(alpha) + (notch - rho) / math.cos(alpha)
    disc = rho - np.hypot(across - centre_across, below - centre_below)
    if notch > 0.0:  # the finished flank down to within the tip, the whole disc of the tip, and what lies between two of them
        ground = np.minimum(flank, centre_below - below)
        between = np.minimum(tip - below, centre_across - across)
        return np.asarray(np.maximum(np.maximum(ground, disc), between), dtype=np.float64)
    direction = np.arctan2(across - centre_across, below - centre_below)
    in_corner = (direction > 0.0) & (direction < 0.5 * math.pi - alpha)
    return np.asarray(np.where(in_corner, np.minimum(depth, disc), depth), dtype=np.float64)


def cut_depth_in_space(spec: GearSpec, points: Floats) -> Floats:
    """How deep the rack of a helical gear ever gets over points in space, mm, + cut away; (n, 3) points, near the space beside tooth 1.

    The rack tooth is a prism along (sin β, cos β) in the pitch plane; its profile is that of the normal section.
    """
    m, beta = spec.normal_module, spec.helix_angle
    r = 0.5 * m * spec.teeth / math.cos(beta)
    radius, angle = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    height = points[:, 2] - 0.5 * spec.face_width
    # Angle from the space centre at mid-face, where the rack tooth stands when the gear has not turned.
    angle = angle - math.pi / spec.teeth
    around = height * math.tan(beta) / r
    reach = 10.0 * m / r
    turn = -around[:, None] + np.linspace(-reach, reach, STEPS)
    for _ in range(3):
        depth = _prism_depth(spec, r, radius[:, None], angle[:, None], height[:, None], turn)
        deepest = np.take_along_axis(turn, depth.argmax(axis=1)[:, None], axis=1)
        turn = deepest + (turn[:, 1] - turn[:, 0])[:, None] * np.linspace(-1.0, 1.0, STEPS)
    return np.asarray(_prism_depth(spec, r, radius[:, None], angle[:, None], height[:, None], turn).max(axis=1))


def _prism_depth(spec: GearSpec, r: float, radius: Floats, angle: Floats, height: Floats, turn: Floats) -> Floats:
    beta = spec.helix_angle
    below = r - radius * np.cos(angle + turn)
    across = np.abs((radius * np.sin(angle + turn) - r * turn) * math.cos(beta) - height * math.sin(beta))
    return _inside(spec, below, across)
