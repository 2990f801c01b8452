"""The hob's rack in space, rolled past a helical blank: how far a point is from what the rack leaves, from the rack's own planes and arc.

Shares nothing with the design room: the rack is drawn in its normal section, leans by β, and is swept; the distance to it is measured in
that section, which is square to its teeth.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats
from gearwear.design import GearSpec

STEPS, ROUNDS = 401, 5


def cut_depth(spec: GearSpec, points: Floats) -> Floats:
    """How deep the rack ever gets over points (n, 3) of the design frame, mm; 0 on the surface it leaves, + where it cuts away.

    A tooth of the gear stands on +x at mid-face; θ grows with z on a right hand (β > 0).
    """
    r = 0.5 * spec.normal_module * spec.teeth / math.cos(spec.helix_angle)
    radius, angle = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    angle = angle - math.tan(spec.helix_angle) / r * (
        points[:, 2] - 0.5 * spec.face_width
    )  # the rack's lean, seen from the blank
    space = 2.0 * math.pi / spec.teeth
    angle = np.abs(angle - space * np.floor(angle / space) - 0.5 * space)
    reach = 8.0 * spec.normal_module / r
    turn = np.linspace(-reach, reach, STEPS) + np.zeros((len(radius), 1))
    for _ in range(ROUNDS):  # the deepest moment, each time closer round it
        depth = _depth(spec, r, radius[:, None], angle[:, None], turn)
        deepest = np.take_along_axis(turn, depth.argmax(axis=1)[:, None], axis=1)
        turn = deepest + 2.0 * (turn[:, 1] - turn[:, 0])[:, None] * np.linspace(-1.0, 1.0, STEPS)
    return np.asarray(_depth(spec, r, radius[:, None], angle[:, None], turn).max(axis=1), dtype=np.float64)


def _depth(spec: GearSpec, r: float, radius: Floats, angle: Floats, turn: Floats) -> Floats:
    m, alpha = spec.normal_module, spec.normal_pressure_angle
    rho, tip = spec.rack_tip_radius * m, (spec.dedendum - spec.profile_shift) * m
    half_width = 0.25 * math.pi * m + 0.5 * spec.thinning  # normal, on the line x m above the pitch line
    below = r - radius * np.cos(angle + turn)
    across = np.abs(radius * np.sin(angle + turn) - r * turn) * math.cos(spec.helix_angle)  # square to the rack's teeth
    flank = (half_width - (below + spec.profile_shift * m) * math.tan(alpha) - across) * math.cos(alpha)
    centre_below = tip - rho
    centre_across = half_width - (centre_below + spec.profile_shift * m) * math.tan(alpha) - rho / math.cos(alpha)
    direction = np.arctan2(across - centre_across, below - centre_below)
    in_corner = (direction > 0.0) & (direction < 0.5 * math.pi - alpha)
    depth = np.minimum(flank, tip - below)
    rounded = np.minimum(depth, rho - np.hypot(across - centre_across, below - centre_below))
    return np.asarray(np.where(in_corner, rounded, depth), dtype=np.float64)
