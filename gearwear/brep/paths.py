"""The curves of a tooth side in closed form: points, and the normals along which their parallels lie. numpy only."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side

SHORTEST = 2e-6
"""mm; a shorter bottom land is left out and the trochoid runs on to the space's centre line instead.

The two are tangent there, so that the difference is of second order: 2e-12 mm over the root's radius in mm."""

FARTHEST = 20.0
"""Of w along a fillet: tan φ is 2e8 there, and no search for a crossing needs more."""

MIRROR = np.array([1.0, -1.0])


@dataclass(frozen=True, slots=True)
class Path:
    """An analytic curve of the transverse outline, on [0, 1] and a little beyond.

    Parameters
    ----------
    points : callable
        (n,) parameters to (n, 2) points, mm.
    normals : callable
        (n,) parameters to (n, 2) unit normals out of the metal.
    """

    points: Callable[[Floats], Floats]
    normals: Callable[[Floats], Floats]

    def parallel(self, share: Floats, depth: Floats | float) -> Floats:
        """(n, 2) points of the inner parallels at `depth` (mm), each on the normal at its parameter."""
        return np.asarray(self.points(share) - np.reshape(depth, (-1, 1)) * self.normals(share))

    def reversed(self) -> Path:
        """The same curve, run the other way."""
        return Path(lambda share: self.points(1.0 - share), lambda share: self.normals(1.0 - share))

    def mirrored(self) -> Path:
        """The curve mirrored at the x axis."""
        return Path(lambda share: self.points(share) * MIRROR, lambda share: self.normals(share) * MIRROR)


def straight_path(first: Floats, last: Floats, orientation: int) -> Path:
    """The line between two points of an outline that runs counter-clockwise, with the metal on its left; of a ring (ι = −1) on its right."""
    way = last - first
    normal = orientation * np.array([way[1], -way[0]]) / np.linalg.norm(way)
    return Path(lambda share: first + np.outer(share, way), lambda share: np.broadcast_to(normal, (len(share), 2)))


def flank_paths(gear: Gear, side: Side) -> tuple[Path, ...]:
    """Flank of the tooth on +x as drawn, from the form circle to its end, piece by piece between knees; the right one is given mirrored.

    Notes
    -----
    The parameter is the roll angle ξ = L / r_b, in which the involute ``x + iy = r_b (1 + iιξ) e^{iτ}``, τ = ψ_b − ιξ, is an entire function;
    radius or arc length would put a square-root singularity at the base circle. A modified flank is turned by δ₀ / r_b at each ξ, a
    polynomial between knees; its tangent is then ``e^{iτ} (ξ + δ₀′ (i − ιξ))``, δ₀′ = dδ₀/dL. Modifications along the face are those
    of mid-face.
    """
    rb, flank, orientation = gear.base_radius, gear.drawn(side), gear.orientation
    knees = [gear.form_roll, *flank.profile_knees, gear.tip_roll]

    def piece(first: float, last: float) -> Path:
        # On a piece δ₀ is a parabola in L: three places say it beyond both ends too, where a neighbour's would be another one.
        values = (
            flank.offset(np.array([first, 0.5 * (first + last), last]), 0.5 * gear.face_width) if gear.modified else np.zeros(3)
        )
        slope, bend = values[2] - values[0], 2.0 * (values[0] + values[2]) - 4.0 * values[1]

        def turned(share: Floats) -> tuple[Floats, Floats]:
            xi = (first + (last - first) * share) / rb
            offset = values[0] + slope * share - bend * share * (1.0 - share)
            return xi, gear.base_half_angle - orientation * xi + offset / rb

        def points(share: Floats) -> Floats:
            xi, tau = turned(share)
            cos, sin = np.cos(tau), np.sin(tau)
            return np.column_stack([rb * (cos - orientation * xi * sin), rb * (sin + orientation * xi * cos)])

        def normals(share: Floats) -> Floats:
            xi, tau = turned(share)
            cos, sin = np.cos(tau), np.sin(tau)
            if slope == 0.0 and bend == 0.0:
                return np.column_stack([-sin, cos])
            rate = (slope + bend * (2.0 * share - 1.0)) / (last - first)
            along, across = xi * (1.0 - orientation * rate), rate
            normal = np.column_stack([-across * cos - along * sin, along * cos - across * sin])
            return np.asarray(normal / np.hypot(along, across)[:, None])

        return Path(points, normals)

    return tuple(piece(first, last) for first, last in pairwise(knees))


def fillet_path(gear: Gear, side: Side) -> Path:
    """Root fillet of the tooth on +x from the bottom land to the form circle; the right one is given mirrored.

    Where the flank is modified the fillet is turned with its end.

    Notes
    -----
    The parameter is w with ``sinh w = tan φ``, so that the roll of the rack is h_c sinh w and all of
    `RackTip.contact` is hyperbolic functions of w; it takes half the points that φ itself does.
    """
    root, to_tooth = gear.root_curve, 0.5 * gear.pitch_angle + drawn_turn(gear, side, gear.form_roll)
    start = 0.0 if has_bottom_land(gear) else _centre_angle(gear)
    first, last = np.arcsinh(np.tan([start, gear.fillet_end]))

    def polar(share: Floats) -> tuple[Floats, Floats, Floats]:
        phi = np.arctan(np.sinh(np.clip(first + (last - first) * share, -FARTHEST, FARTHEST)))
        return phi, *root.polar(phi)

    def points(share: Floats) -> Floats:
        _, radius, angle = polar(share)
        return np.column_stack([radius * np.cos(to_tooth - angle), radius * np.sin(to_tooth - angle)])

    def normals(share: Floats) -> Floats:
        phi, radius, angle = polar(share)
        _, along, across = root.plumb_line(radius, angle, phi)
        cos, sin = np.cos(to_tooth - angle), np.sin(to_tooth - angle)
        return np.column_stack([along * cos - across * sin, along * sin + across * cos])

    return Path(points, normals)


def rounding_path(gear: Gear, side: Side) -> Path | None:
    """Tip rounding of the tooth on +x from the flank's end to the land; None where there is none; the right one is given mirrored.

    Where the flank is modified the arc is turned with its end.
    """
    arc = gear.tip_arc
    if arc is None:
        return None
    turn = drawn_turn(gear, side, gear.tip_roll)
    cos, sin = np.cos(turn), np.sin(turn)
    turned = np.array([[cos, sin], [-sin, cos]])
    return Path(lambda share: arc.points(share) @ turned, lambda share: arc.normals(share) @ turned)


def drawn_turn(gear: Gear, side: Side, roll: float) -> float:
    """δ₀ / r_b at a length of roll (mm) and mid-face: by how much the drawing turns a flank there, rad."""
    return float(gear.drawn(side).offset(roll, 0.5 * gear.face_width)) / gear.base_radius if gear.modified else 0.0


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
