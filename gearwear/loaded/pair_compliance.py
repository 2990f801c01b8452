"""Compliance of all places where a pair may touch, from that of the teeth of both gears.

Along the face a tooth is cut into thin slices that are coupled: bent alone, a slice drags its neighbours. The coupling is one length,
fitted to three-dimensional finite elements of one tooth sector; a load that is even along the face is not changed by it.

Forces and displacements are transverse: the force on a slice is its share of torque over base radius, F_t = F_n cos β_b, and the displacement
that does its work is δ_n / cos β_b. Contact lines lie at β_b over the face, so the normal load per length of them is F_t / dz.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.loaded.hertz import contact_compliance
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import ToothCompliance, load_angle

COUPLING_MODULES = 1.2
"""Length over which slices are coupled, in modules; 1.0 to 1.4 fits the finite elements about as well."""
LEAST_CURVATURE_RADIUS = 0.3
"""mm; relative radius of curvature at a tip corner, which has none of its own. Pressures there are no results."""
_LEAST_LOAD_SHARE = 1e-4
"""Share of the mean load per width below which flattening is that of this load: it grows as the logarithm, without end."""


@dataclass(frozen=True, slots=True)
class PairCompliance:
    """The elastic side of two gears.

    Parameters
    ----------
    teeth : (ToothCompliance, ToothCompliance)
        Of the driver and of the driven gear.
    material : Material
    coupling : float
        Coupling length along the face, mm; 0 is independent slices.
    scale : float
        Factor on all but the Hertzian flattening: 1, but for the spread of models.
    shared : bool
        Whether pairs share what the bodies give way.
    hertz : bool
        Whether flanks flatten.
    """

    teeth: tuple[ToothCompliance, ToothCompliance]
    material: Material
    coupling: float
    scale: float = 1.0
    shared: bool = True
    hertz: bool = True

    def matrix(self, roll: tuple[Floats, Floats], widths: Floats) -> Floats:
        """Compliance without flattening, mm/N.

        Parameters
        ----------
        roll : ((p, m, s) float, the same)
            Length of roll of each place on driver and driven gear, mm: positions, pairs, slices.
        widths : (s,) float
            Widths of the slices, mm.

        Returns
        -------
        (p, m s, m s) float
        """
        positions, pairs, slices = roll[0].shape
        root = np.sqrt(self.scale * (self.teeth[0].at(roll[0]) + self.teeth[1].at(roll[1])))
        shared = self.scale * sum(body.shared for body in self.teeth) / widths.sum() if self.shared else 0.0
        whole = np.full((positions, pairs, slices, pairs, slices), shared)
        couple = coupling_matrix(widths, self.coupling)
        for pair in range(pairs):
            whole[:, pair, :, pair] += root[:, pair, :, None] * couple * root[:, pair, None, :]
        return whole.reshape(positions, pairs * slices, pairs * slices)

    def flattening(self, roll: tuple[Floats, Floats], widths: Floats, mean_load: float) -> Flattening:
        """What flanks flatten at places (p, m, s) that lie at these lengths of roll, mm, on slices of these widths (s,), mm."""
        positions = len(roll[0])
        depth, mate_depth = (centre_depth(body.gear, length) for body, length in zip(self.teeth, roll, strict=True))
        lean = self.teeth[0].gear.base_helix_cosine
        return Flattening(
            radius=curvature_radius(*roll, lean).reshape(positions, -1),
            depths=(depth.reshape(positions, -1), mate_depth.reshape(positions, -1)),
            widths=np.broadcast_to(widths, roll[0].shape).reshape(positions, -1),
            lean=lean,
            least_load=_LEAST_LOAD_SHARE * mean_load,
            material=self.material,
            there=self.hertz,
        )


@dataclass(frozen=True, slots=True)
class Flattening:
    """Hertzian flattening of places (p, n) with known geometry.

    Parameters
    ----------
    radius : (p, n) float
        Relative radius of curvature across the contact lines, mm.
    depths : ((p, n) float, the same)
        To the centre lines of both teeth along the normal, mm.
    widths : (p, n) float
        mm.
    lean : float
        cos β_b: flattening along the normal, divided by it, lies along the transverse line of action.
    least_load : float
        N/mm; below it flattening is that of this load.
    material : Material
    there : bool
        Whether flanks flatten.
    """

    radius: Floats
    depths: tuple[Floats, Floats]
    widths: Floats
    lean: float
    least_load: float
    material: Material
    there: bool

    def of(self, force: Floats, which: Bools) -> tuple[Floats, Floats]:
        """Secant and tangent compliance, mm/N, under forces (k, n), N, at the k positions `which` (p,)."""
        if not self.there:
            return np.zeros_like(force), np.zeros_like(force)
        widths = self.widths[which]
        load = np.maximum(force / widths, self.least_load)
        depths = self.depths[0][which], self.depths[1][which]
        secant, tangent = contact_compliance(load, self.radius[which], depths, self.material)
        return secant / (self.lean * widths), tangent / (self.lean * widths)


def curvature_radius(roll: Floats, mate_roll: Floats, base_helix_cosine: float) -> Floats:
    """Relative radius of curvature across the contact lines, L1 L2 / (L1 + L2) / cos β_b, mm, not below `LEAST_CURVATURE_RADIUS`."""
    both = np.maximum(roll + mate_roll, 1e-9)
    return np.asarray(np.maximum(roll * mate_roll / both / base_helix_cosine, LEAST_CURVATURE_RADIUS), np.float64)


def coupling_length(gear: Gear, modules: float) -> float:
    """Length along the axis, mm, over which slices are coupled: so many normal modules along the tooth, which lies at β to the axis."""
    return modules * gear.normal_module * math.cos(gear.helix_angle)


def centre_depth(gear: Gear, roll: Floats) -> Floats:
    """From the flank to the tooth's centre line along the normal, mm: cos β_b of the way along the transverse line of action."""
    along = load_angle(gear, roll)
    radius = np.hypot(gear.base_radius, roll)
    # Thin tips: the centre line is met a little beyond the tooth's end.
    return np.asarray(
        gear.base_helix_cosine
        * np.maximum(radius * np.sin(gear.half_angle(radius)) / np.cos(along), 0.01 * gear.transverse_module),
        np.float64,
    )


def coupling_matrix(widths: Floats, length: float) -> Floats:
    """(diag(dz) + ℓ² G)⁻¹ with the difference matrix G of a free-ended beam on the slices, 1/mm; 1ᵀ-even loads are not changed."""
    stiffness = np.diag(widths)
    if length > 0.0 and len(widths) > 1:
        apart = length**2 / (0.5 * (widths[1:] + widths[:-1]))
        stiffness[np.arange(len(apart)), np.arange(len(apart))] += apart
        stiffness[np.arange(1, len(apart) + 1), np.arange(1, len(apart) + 1)] += apart
        stiffness[np.arange(len(apart)), np.arange(1, len(apart) + 1)] -= apart
        stiffness[np.arange(1, len(apart) + 1), np.arange(len(apart))] -= apart
    return np.asarray(np.linalg.inv(stiffness), dtype=np.float64)
