"""Compliance of a gear's teeth by plane finite elements of the whole gear on its bore.

A tooth is loaded by a unit force per face width along the line of action. What counts is how far the point where that line meets the
tooth's centre line gives way along it: what lies between it and the surface belongs to the Hertzian contact (Weber & Banaschek 1953),
and the singularity under a line load is not in it. Plane strain; linear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.loaded.outline_grid import COARSE, FINE, Fineness, outline_grid
from gearwear.loaded.steel import Material

BORE_SHARE = 0.35
"""Bore as a share of the root circle where the design states none: about what a keyed shaft needs."""
_PLACES = 9
"""Lengths of roll at which a tooth is loaded; between them a cubic spline, good to 0.1 %."""
_LEAST_HEIGHT = 0.03
"""Distance of the lowest and the highest place from the ends of the flank, as a share of its length of roll."""


@dataclass(frozen=True, slots=True)
class ToothCompliance:
    """Deflection along the line of action per load per face width, mm²/N.

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


@lru_cache(maxsize=8)  # a run of wear after the other asks for the same two gears
def tooth_compliance(
    gear: Gear, material: Material, bore_radius: float | None = None, fine: Fineness = FINE, coarse: Fineness = COARSE
) -> ToothCompliance:
    """Plane finite elements of the whole gear: nine-node quadrilaterals, plane strain, held on the bore.

    Parameters
    ----------
    gear : Gear
        A spur gear; its generated outline, undercut and fillet included.
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
    from skfem import Basis, ElementQuad2, ElementVector, MeshQuad
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    radii = np.hypot(gear.base_radius, roll)
    grid = outline_grid(gear, bore_radius, radii, fine, coarse)
    basis = Basis(MeshQuad(grid.nodes.T.copy(), grid.elements.T.copy()), ElementVector(ElementQuad2()), intorder=4)
    stiffness = linear_elasticity(*lame_parameters(material.elastic_modulus, material.poisson)).assemble(basis)
    # Nodes between corners lie on chords: less than their sagitta above the bore is held.
    free = np.flatnonzero(np.hypot(*basis.doflocs) > bore_radius * (1.0 + 1e-3))
    solver = splu(
        stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )

    along = load_angle(gear, roll)
    direction = np.column_stack([np.sin(along), -np.cos(along)])
    psi = gear.half_angle(radii)
    # The line of action from the flank meets the tooth's centre line here.
    centre = radii * (np.cos(psi) + np.sin(psi) * np.tan(along))
    force = np.zeros((stiffness.shape[0], len(roll)))
    for column, (node, push) in enumerate(zip(grid.flank, direction, strict=True)):
        force[basis.nodal_dofs[:, node], column] = push
    moved = np.zeros_like(force)
    moved[free] = solver.solve(force[free])
    deflections = []
    for tooth, line in enumerate(grid.centre_lines):
        turn = tooth * gear.pitch_angle
        cos, sin = math.cos(turn), math.sin(turn)
        turned = direction @ np.array([[cos, sin], [-sin, cos]])
        height = np.hypot(*grid.nodes[line].T)
        there = CubicSpline(height, moved[basis.nodal_dofs[:, line]], axis=1)(np.clip(centre, height[0], height[-1]))
        deflections.append(np.einsum("id,dij->ij", turned, there))
    return deflections[0], deflections[1]
