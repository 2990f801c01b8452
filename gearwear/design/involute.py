"""Closed forms of the involute (ISO 21771:2007; Colbourne 1987).

Everything here is in the transverse plane. Lengths in mm, angles in radians. The parameter of
choice is the length of roll L: the distance, along the normal, from the base circle to the
flank. It is regular where radius and pressure angle are not (at the base circle).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from gearwear.arrays import Floats


def involute_function(angle: float) -> float:
    """inv α = tan α − α.

    >>> round(involute_function(math.radians(20.0)), 6)
    0.014904
    """
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """Angle α in radians with inv α = `value`.

    Parameters
    ----------
    value : float
        inv α, not negative.

    Returns
    -------
    float
        α in [0, π/2). Its relative error is a few ε (2.2e-16) for inv α above 1; below, t − atan t cancels and
        the error grows to ε/α²: 1e-14 at 5°, 1e-8 at inv α = 1e-12.

    Raises
    ------
    ValueError
        If `value` is negative or not finite: no such angle exists.

    Notes
    -----
    Newton on L = tan α, ``f = t − atan t``, whose derivative ``t²/(1+t²)`` is rational; the
    starts ``(3 v)^(1/3)`` (from t − atan t < t³/3) and ``v`` both lie below the root. f is convex, so
    the first step passes the root and the rest come down to it, for every v.

    >>> round(math.degrees(inverse_involute(0.03431726)), 4)
    26.0888
    """
    if not (value >= 0.0 and math.isfinite(value)):
        raise ValueError(f"inv α = {value} has no angle: it must be finite and not negative")
    if value == 0.0:
        return 0.0
    t = max((3.0 * value) ** (1.0 / 3.0), value)
    for _ in range(60):
        step = (t - math.atan(t) - value) * (1.0 + t * t) / (t * t)
        t -= step
        if abs(step) <= 1e-16 * t:
            break
    return math.atan(t)


def roll_length(radius: ArrayLike, base_radius: float) -> Floats:
    """Length of roll from the base circle to points of an involute.

    Parameters
    ----------
    radius : (n,) float
        Distance of the points from the gear axis in mm.
    base_radius : float
        Base circle radius r_b in mm.

    Returns
    -------
    (n,) float
        Length of roll in mm, 0 on the base circle and inside it, where no involute exists.

    Notes
    -----
    ``L = sqrt(r² - r_b²)``, written as a product so that it keeps its digits near the base circle.

    Examples
    --------
    >>> roll_length([5.0, 13.0], base_radius=5.0)
    array([ 0., 12.])
    """
    r = np.asarray(radius, dtype=np.float64)
    result: Floats = np.sqrt(np.maximum((r - base_radius) * (r + base_radius), 0.0))
    return result


def involute_at_roll(roll: ArrayLike, base_radius: float) -> Floats:
    """inv α of the involute point with length of roll `roll` (mm): ``L/r_b − atan(L/r_b)``.

    >>> float(np.round(involute_at_roll(13.030967, 35.802289), 6))
    0.014904
    """
    xi = np.asarray(roll, dtype=np.float64) / base_radius
    result: Floats = xi - np.arctan(xi)
    return result
