"""The curves of a tooth side as B-splines, with an error bound that is measured, not hoped for.

What the B-rep kernel can hold exactly (circles, lines) it holds exactly. Involute and trochoid it cannot; they are
interpolated here in the parameter in which each is analytic, at the nodes where interpolation is nearly as good
as the best polynomial. numpy and scipy only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.errors import InputError

DEGREE = 9
"""Ten points make one span: a Bézier curve."""

FLANK_TOLERANCE = 1e-10
FILLET_TOLERANCE = 1e-10
"""mm; the tests ask for 1e-9 on flanks and 1e-8 on roots, the rest is for the kernel and the file."""

ROUNDING = 4e-15
"""Error, as a share of the radius, that no number of points can take away."""

SHORTEST = 2e-6
"""mm; a shorter bottom land is left out and the trochoid runs on to the space's centre line instead.

The two are tangent there, so that the difference is of second order: 2e-12 mm over the root's radius in mm."""


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
            raise InputError(f"a tooth curve cannot be drawn to {tolerance:.1e} mm; the best reached is {error:.1e} mm")
        count += 2 if count < 30 else 10


def flank_curves(gear: Gear, side: Side = Side.LEFT) -> tuple[Spline, ...]:
    """Flank of the tooth on +x as drawn, from the form circle to its end, piece by piece between knees; exact to 1e-10 mm.

    Parameters
    ----------
    gear : Gear
    side : Side
        The right one is given mirrored, on the left.

    Returns
    -------
    tuple of Spline
        One where nothing is modified; modifications along the face are those of mid-face.

    Notes
    -----
    The parameter is the roll angle ξ = L / r_b, in which the involute ``x + iy = r_b (1 − iξ) e^{iξ}`` (turned, of a ring mirrored) is
    an entire function; radius or arc length would put a square-root singularity at the base circle. A modified flank is turned by δ₀ / r_b at
    each ξ, a polynomial between knees.
    """
    rb, flank, orientation = gear.base_radius, gear.drawn(side), gear.orientation
    ends = [roll / rb for roll in (gear.form_roll, *flank.profile_knees, gear.tip_roll)]

    def piece(start: float, end: float) -> Spline:
        def involute(share: Floats) -> Floats:
            xi = start + (end - start) * share
            tau = gear.base_half_angle - orientation * xi
            if gear.modified:
                tau = tau + flank.offset(rb * xi, 0.5 * gear.face_width) / rb
            cos, sin = np.cos(tau), np.sin(tau)
            return np.column_stack([rb * (cos - orientation * xi * sin), rb * (sin + orientation * xi * cos)])

        return interpolate(involute, max(FLANK_TOLERANCE, ROUNDING * gear.tip_radius))

    return tuple(piece(start, end) for start, end in pairwise(ends))


def fillet_curve(gear: Gear, side: Side = Side.LEFT) -> Spline:
    """Root fillet of the tooth on +x, from the bottom land to the form circle, as rack, cutter or drawing leave it, to 1e-10 mm.

    The right one (`side`) is given mirrored, on the left. Where the flank is modified the fillet is turned with its end.

    Notes
    -----
    The parameter is w with ``sinh w = tan φ``, so that the roll of the rack is h_c sinh w and all of
    `RackTip.contact` is hyperbolic functions of w; it takes half the points that φ itself does.
    """
    root, to_tooth = gear.root_curve, 0.5 * gear.pitch_angle + drawn_turn(gear, side, gear.form_roll)
    start = 0.0 if has_bottom_land(gear) else _centre_angle(gear)
    first, last = np.arcsinh(np.tan([start, gear.fillet_end]))

    def trochoid(share: Floats) -> Floats:
        phi = np.arctan(np.sinh(first + (last - first) * share))
        radius, angle = root.polar(phi)
        return np.column_stack([radius * np.cos(to_tooth - angle), radius * np.sin(to_tooth - angle)])

    return interpolate(trochoid, max(FILLET_TOLERANCE, ROUNDING * gear.tip_radius))


def rounding_curve(gear: Gear, side: Side = Side.LEFT) -> Spline | None:
    """Tip rounding of the tooth on +x from the flank's end to the land, to 1e-10 mm; None where there is none.

    The right one (`side`) is given mirrored, on the left. Where the flank is modified the arc is turned with its end.
    """
    arc = gear.tip_arc
    if arc is None:
        return None
    turn = drawn_turn(gear, side, gear.tip_roll)
    cos, sin = np.cos(turn), np.sin(turn)
    turned = np.array([[cos, sin], [-sin, cos]])
    return interpolate(lambda share: arc.points(share) @ turned, max(FLANK_TOLERANCE, ROUNDING * gear.tip_radius))


def drawn_turn(gear: Gear, side: Side, roll: float) -> float:
    """δ₀ / r_b at a length of roll (mm) and mid-face: by how much the drawing turns a flank there, rad."""
    return float(gear.drawn(side).offset(roll, 0.5 * gear.face_width)) / gear.base_radius if gear.modified else 0.0


def arc_spline(radius: float, first: float, sweep: float) -> Spline:
    """Arc about the axis from the angle `first` counter-clockwise over `sweep` (rad), where no circle will do; within 1e-10 mm."""

    def arc(share: Floats) -> Floats:
        angle = first + sweep * share
        return radius * np.column_stack([np.cos(angle), np.sin(angle)])

    return interpolate(arc, max(FLANK_TOLERANCE, ROUNDING * radius))


def has_bottom_land(gear: Gear) -> bool:
    """Whether half the bottom land is long enough to be an edge."""
    return gear.root_half_angle * gear.root_radius > SHORTEST


def _centre_angle(gear: Gear) -> float:
    """φ, just below 0, at which the trochoid meets the space's centre line."""
    phi = 0.0
    for _ in range(3):
        angle, above, below = (float(gear.root_curve.polar(np.array(at))[1]) for at in (phi, phi + 1e-6, phi - 1e-6))
        slope = (above - below) / 2e-6
        phi -= angle / slope
    return phi
