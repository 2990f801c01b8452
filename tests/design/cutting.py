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
    m, alpha = spec.normal_module, spec.normal_pressure_angle
    r = 0.5 * m * spec.teeth
    rho = spec.rack_tip_radius * m
    tip = (spec.dedendum - spec.profile_shift) * m  # below the pitch line
    half_width = 0.25 * math.pi * m + 0.5 * spec.thinning  # on the rack's reference line, x m above the pitch line

    below = r - radius * np.cos(angle + turn)
    across = np.abs(radius * np.sin(angle + turn) - r * turn)
    flank = (half_width - (below + spec.profile_shift * m) * math.tan(alpha) - across) * math.cos(alpha)
    depth = np.minimum(flank, tip - below)
    centre_below = tip - rho
    centre_across = half_width - (centre_below + spec.profile_shift * m) * math.tan(alpha) - rho / math.cos(alpha)
    direction = np.arctan2(across - centre_across, below - centre_below)
    in_corner = (direction > 0.0) & (direction < 0.5 * math.pi - alpha)
    rounded = np.minimum(depth, rho - np.hypot(across - centre_across, below - centre_below))
    return np.asarray(np.where(in_corner, rounded, depth), dtype=np.float64)
