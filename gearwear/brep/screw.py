"""A section carried along a screw: B-spline surfaces whose poles are products.

In the plane taken as complex numbers a screw of twist κ turns the point p(u) of the transverse section to
``p(u) e^{iκ(z − b/2)}``: separable in u and z. So the surface through a curve of the section has the products of
that curve's poles with the poles of ``e^{iκ(z − b/2)}``, and is as exact as those two plane curves are. numpy only.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Floats
from gearwear.brep.curves import ROUNDING, Spline, interpolate
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.twist import Segment, segments

TURN_TOLERANCE = 2e-11
"""mm at the outermost circle; with the flank's own 1e-10 it stays far below the 1e-9 that is guaranteed."""

STANDING = Spline(1, np.array([0.0, 0.0, 1.0, 1.0]), np.array([[1.0, 0.0], [1.0, 0.0]]), 0.0)
"""The turning of a spur gear: none."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """Motion of the transverse section from one end face to the other; mm and rad.

    Parameters
    ----------
    twist : float
        κ, turn per length, rad/mm, + right hand.
    low, high : float
        Heights z of the two ends, mm.
    middle : float
        Height at which the section is as drawn, mm.
    turning : Spline
        ``e^{iκ(z − middle)}`` as a plane curve on [0, 1], which is z from `low` to `high`.
    bow : (float, float, float)
        Turn beside the screw's at `low`, half-way and at `high`, a parabola in z: what a drawing modifies along the face, rad.
    """

    twist: float
    low: float
    high: float
    middle: float
    turning: Spline
    bow: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @classmethod
    def of(
        cls,
        segment: Segment,
        radius: float,
        ends: tuple[float, float] | None = None,
        bow: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> Sweep:
        """The screw of a segment of the face, or of its part between two `ends` (mm), so that points at `radius` (mm) are right within 2e-11 mm."""
        low, high = ends or (segment.low, segment.high)
        twist, middle = segment.twist, segment.middle

        if twist == 0.0 and not any(bow):
            return cls(0.0, low, high, middle, STANDING)

        def turning(share: Floats) -> Floats:
            angle = twist * (low + (high - low) * share - middle) + _parabola(bow, share)
            return np.column_stack([np.cos(angle), np.sin(angle)])

        return cls(twist, low, high, middle, interpolate(turning, max(TURN_TOLERANCE / radius, ROUNDING)), bow)

    def angle(self, z: float) -> float:
        """Turn of the section at height z (mm), rad."""
        return self.twist * (z - self.middle) + float(_parabola(self.bow, np.array((z - self.low) / (self.high - self.low))))

    @property
    def heights(self) -> Floats:
        """(m,) z of the poles of `turning`, mm: the Greville abscissae, at which z is linear in the parameter without error."""
        knots, degree = self.turning.knots, self.turning.degree
        share = np.array([knots[i + 1 : i + 1 + degree].mean() for i in range(len(self.turning.poles))])
        return np.asarray(self.low + (self.high - self.low) * share, dtype=np.float64)

    def helix(self, point: Floats) -> Floats:
        """(m, 3) poles of the helix through a point (2,) of the section, mm."""
        poles: Floats = self.surface(point[None, :])[0]
        return poles

    def surface(self, poles: Floats) -> Floats:
        """(n, m, 3) poles of the surface through a plane curve with poles (n, 2), mm."""
        section, turning = (values[:, 0] + 1j * values[:, 1] for values in (poles, self.turning.poles))
        turned = np.multiply.outer(section, turning)
        return np.stack([turned.real, turned.imag, np.broadcast_to(self.heights, turned.shape)], axis=-1)


def _parabola(values: tuple[float, float, float], share: Floats) -> Floats:
    """The parabola with these values at 0, ½ and 1."""
    low, middle, high = values
    return np.asarray(low + (high - low) * share + (4.0 * middle - 2.0 * (low + high)) * share * (1.0 - share), dtype=np.float64)


def screws(gear: Gear) -> tuple[dict[Side, Sweep], ...]:
    """The motion of either tooth side from end to end, in pieces between the knees of what is modified along the face.

    Notes
    -----
    What varies along the face turns the whole side by h(z) / r_b beside the screw (`gearwear.design.modification`). The outline is that
    of mid-face. Chamfers and roundings of the ends are left out at both.
    """
    outermost, less = max(gear.tip_radius, gear.root_radius), gear.spec.end_edge
    bottom, top = segments(gear)[0].low + less, segments(gear)[-1].high - less
    if not gear.modified_along_face:
        ends = [(max(segment.low, bottom), min(segment.high, top)) for segment in segments(gear)]
        return tuple(
            dict.fromkeys(Side, Sweep.of(segment, outermost, piece)) for segment, piece in zip(segments(gear), ends, strict=True)
        )
    (segment,) = segments(gear)
    knees = {knee for side in Side for knee in gear.drawn(side).face_knees if bottom < knee < top}
    return tuple(
        {side: Sweep.of(segment, outermost, piece, _bow(gear, side, piece)) for side in Side}
        for piece in pairwise(sorted({bottom, top, *knees}))
    )


def side_turn(gear: Gear, segment: Segment, side: Side, z: Floats) -> Floats:
    """Turn (rad) of a tooth side at heights `z` (mm) of a segment against the section as drawn: the screw's, and what is modified along the face."""
    turn = segment.twist * (z - segment.middle)
    if gear.modified_along_face:
        face = gear.drawn(side).along_face
        turn = turn + side * (face(z) - face(0.5 * gear.face_width)) / gear.base_radius
    return np.asarray(turn, dtype=np.float64)


def _bow(gear: Gear, side: Side, piece: tuple[float, float]) -> tuple[float, float, float]:
    """Turn (rad) of a side against mid-face by what is modified along the face, at the ends of a piece and half-way."""
    low, high = piece
    still = Segment(0.0, gear.face_width, 0.0)
    turns = side_turn(gear, still, side, np.array([low, 0.5 * (low + high), high]))
    return float(turns[0]), float(turns[1]), float(turns[2])
