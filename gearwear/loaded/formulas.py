"""Compliance of a tooth by published formulas: an alternative to the finite elements, for the spread of the models.

Bending, shear and axial compression of the tooth as a beam of its own outline, and the body under it as a half plane (Weber & Banaschek 1953,
written for plane strain) or as an elastic ring (Sainsot, Velex & Duverger, J. Mech. Des. 126 (2004) 748). A helical tooth is that beam in the
section square to it: cos β as wide, pressed by the normal force on its length dz / cos β, so that its compliance to transverse loads per face
width is cos β / cos² β_b times that of a spur tooth of that section.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.loaded.outline_grid import root_section
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import ToothCompliance, held_radius, load_angle

RING_COEFFICIENTS = {
    "L": (-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045),
    "M": (60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086),
    "P": (-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236),
    "Q": (-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904),
}
"""A … F of X* = A/θ² + B h² + C h/θ + D/θ + E h + F (Sainsot et al. 2004)."""
_STEPS = 400
"""Parts of the tooth's height over which is integrated."""


def beam_on_half_plane(gear: Gear, material: Material, roll: Floats, bore_radius: float | None = None) -> ToothCompliance:
    """Beam from the section of the 30° tangent, on a half plane; torsion of the body on its bore is what pairs share."""
    nu = material.poisson
    held = held_radius(gear, bore_radius)
    foot, width = _section(gear, root_section(gear))
    bending, reach, tangent, cosine = _beam(gear, material, roll, foot)
    ratio = reach / width
    body = (
        18.0 / math.pi * ratio**2
        + 2.0 * (1.0 - 2.0 * nu) / (1.0 - nu) * ratio
        + 4.8 / math.pi * (1.0 + (1.0 - nu) / 2.4 * tangent**2)
    )
    body *= cosine**2 / material.plane_modulus
    return ToothCompliance(gear, held, roll, _to_face_width(gear, bending + body), torsion(gear, material, held))


def beam_on_ring(gear: Gear, material: Material, roll: Floats, bore_radius: float | None = None) -> ToothCompliance:
    """Beam from the root circle, on an elastic ring, whose torsion is what pairs share.

    Fitted by its authors for bodies with 1.4 ≤ h ≤ 7 and teeth with θ ≤ 0.12.
    """
    held = held_radius(gear, bore_radius)
    foot, _ = _section(gear, 0.0)
    bending, _, tangent, cosine = _beam(gear, material, roll, foot)
    theta = math.cos(gear.helix_angle) * (0.5 * gear.pitch_angle - gear.root_half_angle)
    h = gear.root_radius / held
    names = {
        name: a / theta**2 + b * h**2 + c * h / theta + d / theta + e * h + f
        for name, (a, b, c, d, e, f) in RING_COEFFICIENTS.items()
    }
    along = load_angle(gear, roll)
    ratio = (gear.base_radius / np.cos(along) - gear.root_radius) / (2.0 * gear.root_radius * theta)
    body = names["L"] * ratio**2 + names["M"] * ratio + names["P"] * (1.0 + names["Q"] * tangent**2)
    body *= cosine**2 / material.plane_modulus
    shared = torsion(gear, material, held)
    return ToothCompliance(gear, held, roll, _to_face_width(gear, bending + body - shared), shared)


def torsion(gear: Gear, material: Material, bore_radius: float) -> float:
    """Of a disc held on its bore and turned at the root circle, at the base circle, mm²/N: r_b² / (4 π G) (1/R_i² − 1/r_f²).

    A helical gear is pushed along its axis too: ln(r_f / R_i) tan² β_b / (2 π G) more.
    """
    shear = 0.5 * material.elastic_modulus / (1.0 + material.poisson)
    turned = gear.base_radius**2 / (4.0 * math.pi * shear) * (1.0 / bore_radius**2 - 1.0 / gear.root_radius**2)
    return turned + math.log(gear.root_radius / bore_radius) * math.tan(gear.base_helix_angle) ** 2 / (2.0 * math.pi * shear)


def _to_face_width(gear: Gear, compliance: Floats) -> Floats:
    """Of transverse loads per face width, from that of loads square to the tooth per length of it; mm²/N."""
    return compliance * (math.cos(gear.helix_angle) / gear.base_helix_cosine**2)


def _section(gear: Gear, phi: float) -> tuple[float, float]:
    """Distance from the axis and width square to the tooth of its chord where the fillet has the rack-tip angle φ, mm."""
    radius, angle = gear.rack.polar(np.array([phi]))
    theta = 0.5 * gear.pitch_angle - float(angle[0])
    return float(radius[0]) * math.cos(theta), 2.0 * float(radius[0]) * math.sin(theta) * math.cos(gear.helix_angle)


def _beam(gear: Gear, material: Material, roll: Floats, foot: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Compliance by bending, shear and compression, mm²/N; lever above the foot, mm; tangent and cosine of the load's angle."""
    nu = material.poisson
    radius = np.linspace(gear.root_radius, gear.flank_end_radius, 4 * _STEPS)
    psi = gear.half_angle(radius)
    x, half = radius * np.cos(psi), radius * np.sin(psi) * math.cos(gear.helix_angle)
    along = load_angle(gear, roll)
    load = gear.base_radius / np.cos(along)  # where the line of action meets the centre line
    share = (np.arange(_STEPS) + 0.5) / _STEPS
    place = foot + (load - foot)[:, None] * share
    width = 2.0 * np.interp(place, x, half)
    step = (load - foot) / _STEPS
    if gear.twist != 0.0:  # the radial part of the force stays; that square to the tooth takes in the axial one
        along = np.arcsin(gear.base_helix_cosine * np.sin(along))
    tangent, cosine = np.tan(along), np.cos(along)
    bent = 12.0 * (1.0 - nu**2) * (((load[:, None] - place) ** 2 / width**3).sum(axis=1) * step)
    sheared = 2.4 * (1.0 + nu) * (1.0 + 0.294 * tangent**2) * ((1.0 / width).sum(axis=1) * step)
    return cosine**2 / material.elastic_modulus * (bent + sheared), load - foot, tangent, cosine
