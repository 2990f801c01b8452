"""Compliance of a gear's teeth by finite elements of the whole gear's transverse section on its bore.

A tooth is loaded by a unit force per face width along the line of action. What counts is how far the point where that line meets the
tooth's centre line gives way along it: what lies between it and the surface belongs to the Hertzian contact (Weber & Banaschek 1953),
and the singularity under a line load is not in it. Linear. A spur gear is in plane strain; a helical one in the state that its screw carries
into itself (`section_stiffness`), loaded along the normal in space.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.loaded.outline_grid import COARSE, FINE, Fineness, outline_grid
from gearwear.loaded.steel import Material

if TYPE_CHECKING:
    from scipy.sparse import spmatrix
    from skfem import Basis, MeshQuad

BORE_SHARE = 0.35
"""Bore as a share of the root circle where the design states none: about what a keyed shaft needs."""
_PLACES = 9
"""Lengths of roll at which a tooth is loaded; between them a cubic spline, good to 0.1 %."""
_LEAST_HEIGHT = 0.03
"""Distance of the lowest and the highest place from the ends of the flank, as a share of its length of roll."""


@dataclass(frozen=True, slots=True)
class ToothCompliance:
    """Deflection along the transverse line of action per transverse load per face width, mm²/N; of the tooth, its normal one over cos β_b.

    Parameters
    ----------
    gear : Gear
    bore_radius : float
        mm; what is held.
    roll : (n,) float
        Lengths of roll of the load, mm, rising.
    tooth : (n,) float
        Of the loaded tooth itself, without what it shares with its neighbour.
    shared : float
        Of the next tooth while this one is loaded: torsion of the body, and the rim between them. It is taken as the same for all pairs
        in contact.
    """

    gear: Gear
    bore_radius: float
    roll: Floats
    tooth: Floats
    shared: float

    def at(self, roll: Floats) -> Floats:
        """`tooth` at lengths of roll, mm; beyond the ends what it is there."""
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(self.roll, self.tooth)
        return np.asarray(spline(np.clip(roll, self.roll[0], self.roll[-1])), dtype=np.float64)


@lru_cache(maxsize=32)  # a run of wear after the other asks for the same two gears
def tooth_compliance(
    gear: Gear, material: Material, bore_radius: float | None = None, fine: Fineness = FINE, coarse: Fineness = COARSE
) -> ToothCompliance:
    """Finite elements of the whole gear's section: nine-node quadrilaterals, held on the bore.

    Parameters
    ----------
    gear : Gear
        An external gear; its generated outline, undercut and fillet included.
    material : Material
    bore_radius : float or None
        mm; None: the design's, and where that states none `BORE_SHARE` of the root circle.
    fine, coarse : Fineness
        Elements of a loaded tooth and its neighbour, and of the others.

    Returns
    -------
    ToothCompliance

    Notes
    -----
    Twice as fine both ways moves the result by less than 0.3 % (a test holds it); straight edges of elements cut the fillet's arc by less
    than that. A tooth of a slice of the gear is stiffer than that in plane stress by up to 1 / (1 − ν²); which is nearer hangs on the face
    width, and the spread of the models holds it.
    """
    held = held_radius(gear, bore_radius)
    margin = _LEAST_HEIGHT * (gear.tip_roll - gear.form_roll)
    roll = np.linspace(max(gear.form_roll, margin) + margin, gear.tip_roll - margin, _PLACES)
    loaded, neighbour = influence(gear, material, held, roll, fine, coarse)
    shared = float(neighbour.mean())
    return ToothCompliance(gear, held, roll, np.diag(loaded) - shared, shared)


def held_radius(gear: Gear, bore_radius: float | None) -> float:
    """At which the gear is held, mm: as given; None: at the bore of its design, or the usual share of the root circle."""
    if bore_radius is not None:
        return bore_radius
    bore = 0.5 * gear.spec.bore_diameter
    return bore if bore > 0.0 else BORE_SHARE * gear.root_radius


def load_angle(gear: Gear, roll: Floats) -> Floats:
    """Between the line of action and the normal of the tooth's centre line, rad, where the flank is touched at lengths of roll, mm."""
    return gear.base_half_angle - roll / gear.base_radius


def influence(
    gear: Gear, material: Material, bore_radius: float, roll: Floats, fine: Fineness = FINE, coarse: Fineness = COARSE
) -> tuple[Floats, Floats]:
    """Deflections of the loaded tooth and of its neighbour for loads at some lengths of roll.

    Returns
    -------
    own, neighbour : (n, n) float
        mm²/N; row i is the deflection along the line of action at place i, column j the place of the load.
    """
    from scipy.interpolate import CubicSpline
    from scipy.sparse.linalg import splu
    from skfem import MeshQuad

    radii = np.hypot(gear.base_radius, roll)
    grid = outline_grid(gear, bore_radius, radii, fine, coarse)
    basis, stiffness = section_stiffness(gear, material, MeshQuad(grid.nodes.T.copy(), grid.elements.T.copy()))
    # Nodes between corners lie on chords: less than their sagitta above the bore is held.
    free = np.flatnonzero(np.hypot(*basis.doflocs) > bore_radius * (1.0 + 1e-3))
    solver = splu(
        stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )

    along, components = load_angle(gear, roll), len(basis.nodal_dofs)
    force = np.zeros((stiffness.shape[0], len(roll)))
    for column, (node, push) in enumerate(zip(grid.flank, _pushes(gear, along)[:, :components], strict=True)):
        force[basis.nodal_dofs[:, node], column] = push
    moved = np.zeros_like(force)
    moved[free] = solver.solve(force[free])
    # The normal from the flank meets the tooth's centre line in the section a little further along the screw, seen in the section of the load.
    turned = gear.base_helix_sine**2 * (roll / gear.base_radius + np.tan(along))
    along, psi = along - turned, gear.half_angle(radii) - turned
    centre = radii * (np.cos(psi) + np.sin(psi) * np.tan(along))
    direction = _pushes(gear, along)[:, :components]
    deflections = []
    for tooth, line in enumerate(grid.centre_lines):
        turn = tooth * gear.pitch_angle
        cos, sin = math.cos(turn), math.sin(turn)
        facing = np.column_stack([direction[:, :2] @ np.array([[cos, sin], [-sin, cos]]), direction[:, 2:]])
        height = np.hypot(*grid.nodes[line].T)
        there = CubicSpline(height, moved[basis.nodal_dofs[:, line]], axis=1)(np.clip(centre, height[0], height[-1]))
        deflections.append(np.einsum("id,dij->ij", facing, there))
    return deflections[0], deflections[1]


def _pushes(gear: Gear, along: Floats) -> Floats:
    """Forces (n, 3) into the left flank of a tooth on +x with a transverse part of 1: along the normal in space."""
    return np.column_stack([np.sin(along), -np.cos(along), np.full(len(along), math.tan(gear.base_helix_angle))])


def section_stiffness(gear: Gear, material: Material, section: MeshQuad) -> tuple[Basis, spmatrix]:
    """Stiffness per face width of a gear's transverse section: two displacements a node in plane strain, three under a screw.

    Notes
    -----
    A load that is the same at all heights, turned with the screw, moves the gear by ``U(x, z) = R(κz) u(R(−κz) x)``: the section says all, as
    ``∂U/∂z = κ (J u − x ∂u/∂y + y ∂u/∂x)`` with the quarter turn J. So strains are those in space, exactly: that the tooth leans, is thinner
    across than in its transverse section, and that the body is twisted and sheared along its axis. Nothing is taken from a virtual spur gear.
    """
    from scipy.sparse import coo_matrix
    from skfem import Basis, ElementQuad2, ElementVector
    from skfem.models.elasticity import lame_parameters

    first, shear = lame_parameters(material.elastic_modulus, material.poisson)
    components = 2 if gear.twist == 0.0 else 3
    basis = Basis(section, ElementVector(ElementQuad2(), components), intorder=4)
    # Twice the energy is the sum of squares of these, for each shape function and point: so its matrix is their products.
    roots = np.empty((len(basis.dx), basis.Nbfun, basis.dx.shape[1], 4 if components == 2 else 7))
    for number, (shape, *_) in enumerate(basis.basis):
        by_x, by_y = np.swapaxes(shape.grad, 0, 1)
        stretch, slant = [by_x[0], by_y[1]], [by_y[0] + by_x[1]]
        if components == 3:
            u, (x, y) = np.asarray(shape), np.asarray(basis.global_coordinates())
            by_z = gear.twist * (np.stack([-u[1], u[0], np.zeros_like(u[2])]) - x * by_y + y * by_x)
            stretch, slant = [*stretch, by_z[2]], [*slant, by_z[0] + by_x[2], by_z[1] + by_y[2]]
        terms = [
            math.sqrt(first) * sum(stretch),
            *(math.sqrt(2.0 * shear) * one for one in stretch),
            *(math.sqrt(shear) * one for one in slant),
        ]
        roots[:, number] = np.stack([term * np.sqrt(basis.dx) for term in terms], axis=-1)
    flat = roots.reshape(*roots.shape[:2], -1)
    values = flat @ flat.swapaxes(1, 2)
    dofs = basis.element_dofs.T
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    return basis, coo_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(basis.N, basis.N)).tocsr()
