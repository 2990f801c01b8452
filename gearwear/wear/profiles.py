"""The worn gear as tooth profiles: nodes at cell centres and at the edges, nominal wherever no wear was found."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.profiles import ToothProfiles
from gearwear.measure.cells import CellGrid

LEDGE = 0.002
"""Modules below the form circle at which a worn flank ends in a step: a slope over half a fillet column would be 4 % more volume."""
LEAST_LEVER = 0.35
"""Least |n · e_θ| of a fillet column that is moved: nearer the root a turn would not move the surface along its normal."""


def node_radii(grid: CellGrid) -> Floats:
    """Radii of the profile nodes, mm: root, fillet column centres, just below the form circle, form circle, flank column centres, tip."""
    gear = grid.gear
    fillet = 0.5 * (grid.fillet_radius[1:] + grid.fillet_radius[:-1])
    square = np.linspace(gear.form_roll**2, gear.tip_roll**2, 2 * grid.flank + 1)[1::2]
    flank = np.sqrt(square + gear.base_radius**2)
    ledge = gear.form_radius - LEDGE * gear.transverse_module
    return np.concatenate([[gear.root_radius], fillet, [ledge, gear.form_radius], flank, [gear.flank_end_radius]])


def node_heights(grid: CellGrid) -> Floats:
    """Heights of the profile nodes, mm: 0, row centres, face width."""
    edges = grid.z_edges
    return np.concatenate([[0.0], 0.5 * (edges[1:] + edges[:-1]), [grid.gear.face_width]])


def worn_profiles(grid: CellGrid, depth: Floats) -> ToothProfiles:
    """Profiles of the worn gear.

    Parameters
    ----------
    grid : CellGrid
        The grid the wear was found on.
    depth : (teeth, 2, rows, fillet + flank) float
        Missing depth along the normal, mm; 0 where there is no wear.

    Returns
    -------
    ToothProfiles
        Half angles at `node_radii` × `node_heights`; depth is continued linearly to the edges of the face, and from the outermost
        columns to form circle and tip. Below the form circle, where the mate does not reach, the fillet has its own.
    """
    gear = grid.gear
    radius, heights = node_radii(grid), node_heights(grid)
    fillet, flank = depth[..., : grid.fillet], depth[..., grid.fillet :]
    # Turn of the surface per depth: 1 / r_b on the involute, 1 / (r |n · e_θ|) on the trochoid.
    phi = gear.fillet_phi(radius[1 : grid.fillet + 1])
    _, angle = gear.rack.polar(phi)
    lever = np.abs(np.sin(phi + gear.rack.contact(phi)[2] + angle))
    per_depth = np.where(lever > LEAST_LEVER, 1.0 / (radius[1 : grid.fillet + 1] * np.maximum(lever, LEAST_LEVER)), 0.0)
    turn = np.zeros((*depth.shape[:3], len(radius)))
    turn[..., 1 : grid.fillet + 1] = fillet * per_depth
    turn[..., grid.fillet + 1] = turn[..., grid.fillet]
    first = grid.fillet + 3
    turn[..., first : first + grid.flank] = flank / gear.base_radius
    square = radius**2
    turn[..., first - 1] = _continued(turn[..., first], turn[..., first + 1], square[first - 1], square[first], square[first + 1])
    turn[..., -1] = _continued(turn[..., -2], turn[..., -3], square[-1], square[-2], square[-3])
    if grid.rows > 1:
        low = _continued(turn[:, :, 0], turn[:, :, 1], -0.5, 0.0, 1.0)
        high = _continued(turn[:, :, -1], turn[:, :, -2], -0.5, 0.0, 1.0)
    else:
        low = high = turn[:, :, 0]
    turn = np.concatenate([low[:, :, None], turn, high[:, :, None]], axis=2)
    half_angle = gear.half_angle(radius) - turn
    return ToothProfiles(gear, radius, heights, _kept_apart(half_angle))


def without_added_metal(depth: Floats, area: Floats) -> Floats:
    """The nearest depth that adds no metal and removes as much as the measured one, tooth side by tooth side.

    Parameters
    ----------
    depth : (teeth, 2, rows, columns) float
        Measured depth with its noise, mm; 0 where there is no wear.
    area : (columns,) float
        Area of a cell, mm².

    Returns
    -------
    (teeth, 2, rows, columns) float
        Not negative.

    Notes
    -----
    Cutting negative depths off would keep the noise that deepens and drop the noise that fills: 5 % of the volume where whole flanks are
    worn little. The nearest field, in least squares weighted by area, of the same integral and without negative values is
    ``max(depth − t, 0)`` with one threshold t for the side.
    """
    result = np.zeros_like(depth)
    weight = np.broadcast_to(area, depth.shape[2:]).ravel()
    for side in np.ndindex(*depth.shape[:2]):
        own = depth[side].ravel()
        volume = float(own @ weight)
        if volume <= 0.0:
            continue
        order = np.argsort(own)[::-1]
        # With the k deepest cells kept, t = (Σ a d − V) / Σ a; the right k is the last whose shallowest cell is above it.
        threshold = (np.cumsum((own * weight)[order]) - volume) / np.cumsum(weight[order])
        kept = int(np.flatnonzero(own[order] > threshold)[-1])
        result[side] = np.maximum(depth[side] - threshold[kept], 0.0)
    return result


def _continued(near: Floats, next_: Floats, at: float, near_at: float, next_at: float) -> Floats:
    """Linear continuation from two columns to a third; never past zero, and flat where the nearest shows no wear."""
    value = near + (near - next_) * (at - near_at) / (near_at - next_at)
    return np.where(near > 0.0, np.clip(value, 0.0, 2.0 * near), np.where(near < 0.0, near, 0.0))


def _kept_apart(half_angle: Floats) -> Floats:
    """Both sides of a tooth with at least a micrometre-like land left between them, where wear from both sides meets."""
    least = 1e-5
    gap = half_angle.sum(axis=1) - least
    short = np.minimum(gap, 0.0)[:, None]
    return np.asarray(half_angle - 0.5 * short, dtype=np.float64)
