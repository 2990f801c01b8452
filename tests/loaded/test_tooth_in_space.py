"""A helical tooth as a section that its screw carries along, against finite elements of the tooth in space.

One sector of the gear, held on the bore and on its sides, pressed evenly along the face by forces normal to its flank at one radius: away from the
ends of a wide face the section says all. Both have the same elements of the section, so that they are alike coarse.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, ElementHex2, ElementVector, MeshHex, MeshQuad
from skfem.models.elasticity import lame_parameters
from skfem.refdom import RefHex

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.loaded.outline_grid import Fineness, outline_grid
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import section_stiffness

STEEL = Material()
COARSE = Fineness(1, 2, 2, 3, 3)
MODULE, WIDTH, LAYERS = 3.0, 24.0, 10


class Sector(NamedTuple):
    """Nodes and elements of the section of tooth 0, nodes on its centre line and where it is pressed; the bore's radius."""

    nodes: np.ndarray
    elements: np.ndarray
    line: np.ndarray
    flank: np.ndarray
    bore: float


def sector(gear: Gear, roll: np.ndarray) -> Sector:
    bore = gear.root_radius - 2.0 * MODULE
    grid = outline_grid(gear, bore, np.hypot(gear.base_radius, roll), COARSE, COARSE, neighbours=0)
    middle = grid.nodes[grid.elements].mean(axis=1)
    elements = grid.elements[np.abs(np.arctan2(middle[:, 1], middle[:, 0])) < 0.5 * gear.pitch_angle]
    used = np.unique(elements)
    new = np.full(len(grid.nodes), -1)
    new[used] = np.arange(len(used))
    return Sector(grid.nodes[used], new[elements], new[grid.centre_lines[0]], new[grid.flank], bore)


def free_of(gear: Gear, of: Sector, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    # Nodes between corners lie on chords.
    held = (np.hypot(x, y) < of.bore * 1.01) | (np.abs(np.arctan2(y, x)) > 0.5 * gear.pitch_angle * (1.0 - 2e-3))
    return np.flatnonzero(~held)


def normal(gear: Gear, tilt: float, height: float) -> np.ndarray:
    """Into a left flank that is tilted so against the tooth's centre line, transverse part 1, at a height over mid-face."""
    turn = gear.twist * height
    across = np.array([math.sin(tilt), -math.cos(tilt)])
    cos, sin = math.cos(turn), math.sin(turn)
    return np.array([*(np.array([[cos, -sin], [sin, cos]]) @ across), math.tan(gear.base_helix_angle)])


def where(gear: Gear, roll: float) -> tuple[float, float, float]:
    """On the normal from the flank at mid-face to the tooth's centre surface: height, radius, and turn of that section."""
    beta, r = gear.base_helix_angle, gear.base_radius
    foot = np.array([r * math.cos(gear.base_half_angle - roll / r), r * math.sin(gear.base_half_angle - roll / r)])
    tilt = gear.base_half_angle - roll / r
    push = np.array([math.sin(tilt), -math.cos(tilt)])
    flank = foot - roll * push

    def off(depth: float) -> float:
        x, y = flank + depth * math.cos(beta) * push
        return math.atan2(y, x) - gear.twist * depth * math.sin(beta)

    low, high = 0.0, 2.0 * MODULE
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if off(middle) > 0.0 else (low, middle)
    x, y = flank + low * math.cos(beta) * push
    return low * math.sin(beta), math.hypot(x, y), gear.twist * low * math.sin(beta)


def by_section(gear: Gear, of: Sector, roll: np.ndarray) -> np.ndarray:
    basis, stiffness = section_stiffness(gear, STEEL, MeshQuad(of.nodes.T.copy(), of.elements.T.copy()))
    free, components = free_of(gear, of, *basis.doflocs), len(basis.nodal_dofs)
    answer = []
    for length, node in zip(roll, of.flank, strict=True):
        tilt = gear.base_half_angle - length / gear.base_radius
        force = np.zeros(stiffness.shape[0])
        force[basis.nodal_dofs[:, node]] = normal(gear, tilt, 0.0)[:components]
        moved = np.zeros_like(force)
        moved[free] = splu(stiffness[free][:, free].tocsc()).solve(force[free])
        height, radius, _ = where(gear, length)
        there = CubicSpline(np.hypot(*of.nodes[of.line].T), moved[basis.nodal_dofs[:, of.line]], axis=1)(radius)
        answer.append(float(normal(gear, tilt, -height)[:components] @ there))
    return np.array(answer)


def in_space(gear: Gear, of: Sector, roll: np.ndarray) -> np.ndarray:
    """(rolls, heights): deflection under a load of 1 N/mm all along the face, at the heights of the nodes."""
    heights, count = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, LAYERS + 1), len(of.nodes)
    turn = gear.twist * heights[:, None]
    x, y = of.nodes.T
    points = np.stack(
        [
            np.cos(turn) * x - np.sin(turn) * y,
            np.sin(turn) * x + np.cos(turn) * y,
            np.broadcast_to(heights[:, None], (LAYERS + 1, count)),
        ]
    )
    corner = {(0, 0): 0, (1, 0): 1, (1, 1): 2, (0, 1): 3}
    local = [(corner[int(a), int(b)], int(c)) for a, b, c in RefHex.p.T]
    bricks = [np.column_stack([of.elements[:, quad] + (layer + up) * count for quad, up in local]) for layer in range(LAYERS)]
    basis = Basis(MeshHex(points.reshape(3, -1), np.concatenate(bricks).T.copy()), ElementVector(ElementHex2()), intorder=4)
    first, shear = lame_parameters(STEEL.elastic_modulus, STEEL.poisson)
    law = np.diag([2.0 * shear] * 3 + [shear] * 3)
    law[:3, :3] += first
    strains = []
    for shape, *_ in basis.basis:
        g = shape.grad
        strains.append(np.stack([g[0, 0], g[1, 1], g[2, 2], g[0, 1] + g[1, 0], g[0, 2] + g[2, 0], g[1, 2] + g[2, 1]]))
    strain = np.moveaxis(np.array(strains), (0, 1), (2, 3))  # elements, points, shapes, 6
    values = ((strain @ law) * basis.dx[:, :, None, None]) @ strain.swapaxes(2, 3)
    dofs = basis.element_dofs.T
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    stiffness = coo_matrix((values.sum(axis=1).ravel(), (rows.ravel(), columns.ravel())), shape=(basis.N, basis.N)).tocsc()
    x, y, z = basis.doflocs
    back = np.cos(gear.twist * z), np.sin(gear.twist * z)
    free = free_of(gear, of, back[0] * x + back[1] * y, back[0] * y - back[1] * x)
    force = np.zeros((basis.N, len(roll)))
    ends = np.sort(basis.mesh.edges, axis=0)
    tilts = gear.base_half_angle - roll / gear.base_radius
    for place, (node, tilt) in enumerate(zip(of.flank, tilts, strict=True)):
        corners = node + count * np.arange(LAYERS + 1)
        for layer, height in enumerate(heights):  # Simpson's rule, as quadratic elements take an even load
            share = (1.0 if layer in (0, LAYERS) else 2.0) / 6.0
            force[basis.nodal_dofs[:, corners[layer]], place] = share * WIDTH / LAYERS * normal(gear, tilt, height)
        for low, high, height in zip(corners[:-1], corners[1:], 0.5 * (heights[1:] + heights[:-1]), strict=True):
            edge = int(np.flatnonzero((ends[0] == low) & (ends[1] == high))[0])
            force[basis.edge_dofs[:, edge], place] = 4.0 / 6.0 * WIDTH / LAYERS * normal(gear, tilt, height)
    moved = np.zeros_like(force)
    solver = splu(stiffness[free][:, free], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    moved[free] = solver.solve(force[free])
    answer = []
    for place, (length, tilt) in enumerate(zip(roll, tilts, strict=True)):
        further, radius, _ = where(gear, length)
        layers = []
        for layer, height in enumerate(heights):
            there = CubicSpline(
                np.hypot(*of.nodes[of.line].T), moved[basis.nodal_dofs[:, of.line + layer * count], place], axis=1
            )(radius)
            layers.append(normal(gear, tilt, height - further) @ there)
        answer.append(CubicSpline(heights, layers)(np.clip(heights + further, heights[0], heights[-1])))
    return np.array(answer)


@pytest.fixture(scope="module")
def deflections() -> dict[float, tuple[np.ndarray, np.ndarray]]:
    both = {}
    for degrees in (0.0, 25.0):
        gear = Gear.from_spec(GearSpec("gear", 24, MODULE, WIDTH, helix_angle=math.radians(degrees)))
        roll = np.linspace(gear.form_roll + 1.0, gear.tip_roll - 1.0, 3)
        of = sector(gear, roll)
        both[degrees] = by_section(gear, of, roll), in_space(gear, of, roll)
    return both


@pytest.mark.parametrize("degrees", [0.0, 25.0])
def test_away_from_the_ends_the_section_says_all(deflections, degrees):
    section, space = deflections[degrees]
    np.testing.assert_allclose(space[:, LAYERS // 2], section, rtol=0.03)


def test_the_ends_are_left_out_and_those_of_a_pair_make_up_for_each_other(deflections):
    """The acute end is softer, the obtuse one stiffer; a pair has one of each, and is up to a quarter softer there."""
    _, spur = deflections[0.0]
    _, helical = deflections[25.0]
    np.testing.assert_allclose(spur, spur[:, ::-1], rtol=1e-6)
    ends = helical[:, [0, -1]] / helical[:, [LAYERS // 2]]
    assert (ends.min(axis=1) < 0.95).all() and (ends.max(axis=1) > 1.3).all()
    assert (np.abs(ends.mean(axis=1) - 1.0) < 0.3).all()
