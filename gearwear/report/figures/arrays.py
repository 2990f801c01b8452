"""What the figures draw that is too large for `report.json`: the maps, the worn gear, the meshing curves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles
from gearwear.design.surface import SurfacePoints
from gearwear.inspection.inspection import Inspection
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing


@dataclass(frozen=True, slots=True)
class MeshingCurves:
    """Transmission error and backlash over one revolution of the scanned gear.

    Parameters
    ----------
    rotation_deg : (n,) float
        Position in mesh, rising from 0.
    transmission_error_um : (n,) float
        Worn gear, on the line of action.
    backlash_design_um, backlash_worn_um : (n,) float
        Circumferential, at the working pitch circle; of the design the same in every position.
    """

    rotation_deg: Floats
    transmission_error_um: Floats
    backlash_design_um: Floats
    backlash_worn_um: Floats


def meshing_curves(contact: ContactResult, design: ExactMeshing) -> MeshingCurves:
    """The curves of gears in rigid contact, beside the backlash of the design."""
    rotation, error, backlash = contact.curves
    normal = math.cos(design.working_pressure_angle) * contact.driver.base_helix_cosine
    at_rest = np.full(len(rotation), 1e3 * design.backlash.circumferential)
    return MeshingCurves(np.degrees(rotation), 1e3 * error, at_rest, 1e3 * backlash / normal)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportArrays:
    """Arrays behind the figures. Flank maps are (teeth, 2, n_z, n_L): side 0 is left, 1 right; nan was not seen.

    Parameters
    ----------
    gear : Gear
        The design of the scanned gear.
    roll_mm : (n_L,) float
        Roll length at the cell centres, rising; cells need not be even.
    z_mm : (n_z,) float
        Height at the cell centres, rising; one for a planar section.
    deviation_um : (teeth, 2, n_z, n_L) float
        As measured, after registration; + is too much material.
    wear_depth_um : (teeth, 2, n_z, n_L) float
        Significant wear, + is missing; 0 elsewhere.
    effects_out_um : (teeth, 2, n_z, n_L) float or None
        The deviation with all that was found of scanner and maker taken out; None where nothing was.
    worn : ToothProfiles
        The gear as it is now: sections and the 3-D view are drawn from it.
    residual_before_um, residual_after_um : (teeth, 2, n_z, n_L) float or None
        Closed loop: what the model does not explain, on the same cells (nan on wear).
    elsewhere : SurfacePoints or None
        Points of fillets, roots and tips, corrected like `deviation_um`: colours of the 3-D view outside the flanks.
    elsewhere_effects_out : SurfacePoints or None
        The same with deviations like `effects_out_um`.
    meshing : MeshingCurves or None
        None without a mate.
    contact_share : (teeth, 2, m_z, m) float or None
        Contact pattern, root to tip: 1 where the cell is touched at every passing, 0 where never; nan on flanks that do not
        carry. Its cells need not be those of the maps.
    inspection : Inspection or None
        Evaluated traces, for the charts.
    halves : tuple of Inspection
        The same of the lower and the upper half of a double helical gear.
    """

    gear: Gear
    roll_mm: Floats
    z_mm: Floats
    deviation_um: Floats
    wear_depth_um: Floats
    worn: ToothProfiles
    residual_before_um: Floats | None = None
    residual_after_um: Floats | None = None
    effects_out_um: Floats | None = None
    elsewhere: SurfacePoints | None = None
    elsewhere_effects_out: SurfacePoints | None = None
    meshing: MeshingCurves | None = None
    contact_share: Floats | None = None
    inspection: Inspection | None = None
    halves: tuple[Inspection, ...] = ()

    @property
    def planar(self) -> bool:
        """Whether this is one transverse section: no volume, no 3-D view."""
        return len(self.z_mm) == 1

    @property
    def wear_shown_um(self) -> Floats:
        """(teeth, 2, n_z, n_L) −depth of wear, 0 where none is; nan where nothing was seen."""
        return np.where(np.isfinite(self.deviation_um) | (self.wear_depth_um > 0.0), -self.wear_depth_um, np.nan)
