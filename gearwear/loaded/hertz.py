"""Hertzian line contact of two teeth: flattening and pressure."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.loaded.steel import Material


def half_width(load: Floats, radius: Floats, material: Material) -> Floats:
    """Half width a of the contact, mm, for a load per width (N/mm) and a relative radius of curvature (mm): a² = 4 w R / (π E*).

    >>> float(half_width(np.array(100.0), np.array(10.0), Material()).round(5))
    0.10606
    """
    return np.asarray(np.sqrt(4.0 * load * radius / (np.pi * material.contact_modulus)), dtype=np.float64)


def greatest_pressure(load: Floats, radius: Floats, material: Material) -> Floats:
    """p_max in MPa: sqrt(w E* / (π R)) (Hertz 1881; Johnson, Contact Mechanics, 1985, eq. 4.45)."""
    return np.asarray(np.sqrt(load * material.contact_modulus / (np.pi * radius)), dtype=np.float64)


def contact_compliance(load: Floats, radius: Floats, depths: tuple[Floats, Floats], material: Material) -> tuple[Floats, Floats]:
    """Approach of the tooth centre lines by flattening, per load per width, and its derivative; mm²/N.

    Parameters
    ----------
    load : (...) float
        w, N/mm, above 0.
    radius : (...) float
        R, relative radius of curvature, mm.
    depths : (float, float)
        h1, h2: from the contact to the centre lines along the line of action, mm.
    material : Material

    Returns
    -------
    secant, tangent : (...) float
        q w is the approach; the tangent is its derivative by w.

    Notes
    -----
    ``q = 2 (1 − ν²) / (π E) [ln(4 h1 h2 / a²) − ν / (1 − ν)]`` (Weber & Banaschek 1953, both bodies alike). Kept above 0, for
    loads so great that a would come near the teeth's own thickness.
    """
    factor = 2.0 / (np.pi * material.plane_modulus)
    squared = half_width(load, radius, material) ** 2
    nu = material.poisson
    secant = factor * np.maximum(np.log(4.0 * depths[0] * depths[1] / squared) - nu / (1.0 - nu), 1e-3)
    return secant, np.maximum(secant - factor, 1e-3 * factor)
