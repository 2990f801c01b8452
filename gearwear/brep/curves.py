"""The curves of a tooth side as B-splines, with an error bound that is measured, not hoped for.

What the B-rep kernel can hold exactly (circles, lines) it holds exactly. Involute and trochoid it cannot; they are
interpolated here in the parameter in which each is analytic, at the nodes where interpolation is nearly as good
as the best polynomial. numpy and scipy only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from gearwear.arrays import Floats
from gearwear.brep.paths import Path
from gearwear.design.gear import Gear
from gearwear.errors import InputError

DEGREE = 9
"""Ten points make one span: a Bézier curve."""

FLANK_TOLERANCE = 1e-10
FILLET_TOLERANCE = 1e-10
"""mm; the tests ask for 1e-9 on flanks and 1e-8 on roots, the rest is for the kernel and the file."""

ROUNDING = 4e-15
"""Error, as a share of the radius, that no number of points can take away."""

MOST_POINTS = 120
"""Points of a curve at which to give up."""


@dataclass(frozen=True, slots=True)
class Spline:
    """A planar B-spline curve on the parameter interval [0, 1].

    Parameters
    ----------
    degree : int
        Polynomial degree.
    knots : (n + degree + 1,) float
        Knots with their repetitions.
    poles : (n, 2) float
        Control points, mm.
    error : float
        Greatest distance found between the curve and the one it stands for, mm.
    """

    degree: int
    knots: Floats
    poles: Floats
    error: float

    def points(self, parameter: Floats) -> Floats:
        """(n, 2) points in mm at parameters in [0, 1]."""
        return np.asarray(BSpline(self.knots, self.poles, self.degree)(parameter), dtype=np.float64)

    def reversed(self) -> Spline:
        """The same curve, run the other way."""
        return Spline(self.degree, (1.0 - self.knots)[::-1].copy(), self.poles[::-1].copy(), self.error)

    def mirrored(self) -> Spline:
        """The curve mirrored at the x axis."""
        return Spline(self.degree, self.knots, self.poles * np.array([1.0, -1.0]), self.error)


def interpolate(curve: Callable[[Floats], Floats], tolerance: float) -> Spline:
    """Interpolate a planar curve by a B-spline of degree 9, with as many points as the tolerance asks for.

    Parameters
    ----------
    curve : callable
        (n,) parameters in [0, 1] to (n, 2) points in mm; should be analytic.
    tolerance : float
        Greatest distance in mm.

    Returns
    -------
    Spline

    Raises
    ------
    InputError
        If the tolerance cannot be met.

    Notes
    -----
    Points at the Chebyshev-Lobatto nodes (Trefethen 2013, *Approximation Theory and Approximation Practice*);
    knots "not a knot", so that ten points give one span. The error is the greatest
    difference at equal parameters in nine places between neighbouring nodes, which the distance cannot exceed.
    """
    count = DEGREE + 1
    while True:
        nodes = 0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1)))
        inside = nodes[:-1, None] + np.diff(nodes)[:, None] * np.arange(1, 10) / 10.0
        check = inside.ravel()
        fitted = make_interp_spline(nodes, curve(nodes), k=DEGREE)
        error = float(np.linalg.norm(fitted(check) - curve(check), axis=1).max())
        if error <= tolerance:
            return Spline(DEGREE, np.asarray(fitted.t), np.asarray(fitted.c), error)
        if count >= MOST_POINTS:
            raise InputError(f"a tooth curve cannot be drawn to {tolerance:.3g} mm; the best reached is {error:.3g} mm")
        count += 2 if count < 30 else 10


def drawn(gear: Gear, path: Path, tolerance: float) -> Spline:
    """A path as a spline; `tolerance` in mm."""
    return interpolate(path.points, max(tolerance, ROUNDING * gear.tip_radius))


def arc_spline(radius: float, first: float, sweep: float) -> Spline:
    """Arc about the axis from the angle `first` counter-clockwise over `sweep` (rad), where no circle will do; within 1e-10 mm."""

    def arc(share: Floats) -> Floats:
        angle = first + sweep * share
        return radius * np.column_stack([np.cos(angle), np.sin(angle)])

    return interpolate(arc, max(FLANK_TOLERANCE, ROUNDING * radius))
