"""Chamfered and rounded ends: bands of B-spline faces between the body and the end face, for every toothing.

At the inset d the section at its height is the inner parallel of the outline there, in the transverse plane: at the distance h from the end
face d = c − h on a chamfer c, and d = ρ (1 − cos θ), h = ρ (1 − sin θ) on a rounding ρ. The faces interpolate a grid of exact points,
share of the edge × height, and meet their neighbours at equal parameters. numpy only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline

from gearwear.arrays import Floats
from gearwear.brep.curves import DEGREE
from gearwear.brep.outline import SHORTEST_EDGE, Edge
from gearwear.brep.parallel import Parallels, UsedUp
from gearwear.brep.paths import drawn_turn, flank_paths
from gearwear.brep.screw import side_turn
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.quantity import as_given, at_most
from gearwear.design.side import Side
from gearwear.design.twist import Segment, segments
from gearwear.errors import InputError

END_TOLERANCE = 2e-8
"""mm; of a face of an end against the exact one, below the kernel's own 1e-7."""
UPWARDS = (4, 5, 6, 8, 10, 13, 17)
"""Points from the body to the end face; a band that needs more is halved."""
ALONG = (4, 6, 8, 10, 13, 17, 22, 28, 36)
"""Points along an edge."""
HALVINGS = 8
CHECKS = np.array([0.0, 0.21, 0.5, 0.83, 1.0])
"""Shares of an edge at which the points upwards are judged."""
MOST_BEND = 0.02
"""rad; a flank that is modified at its form circle by more is bent there as no end can follow, if it cannot be drawn."""
LIMIT_ROUNDS = 40
"""Bisections to the size that would have fitted."""


@dataclass(frozen=True, slots=True)
class Basis:
    """B-splines on [0, 1] through Chebyshev-Lobatto nodes, of the degree 9 or, of fewer than ten nodes, one polynomial."""

    nodes: Floats
    degree: int
    knots: Floats

    @classmethod
    def through(cls, count: int) -> Basis:
        nodes = 0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1)))
        degree = min(DEGREE, count - 1)
        return cls(nodes, degree, np.asarray(make_interp_spline(nodes, nodes, k=degree).t))

    def poles(self, values: Floats, axis: int = 0) -> Floats:
        """Poles of the interpolant of values at the nodes, which run along `axis`."""
        moved = np.moveaxis(values, axis, 0)
        poles = make_interp_spline(self.nodes, moved, k=self.degree, t=self.knots).c
        return np.moveaxis(np.asarray(poles, dtype=np.float64), 0, axis)

    @property
    def between(self) -> Floats:
        """Half-way between the nodes."""
        return np.asarray(0.5 * (1.0 - np.cos(np.pi * (np.arange(len(self.nodes) - 1) + 0.5) / (len(self.nodes) - 1))))

    def missed(self, values: Callable[[Floats], Floats]) -> Floats:
        """The interpolant less what it stands for, values (n, …, 3) in mm, half-way between its nodes."""
        fitted = BSpline(self.knots, self.poles(values(self.nodes)), self.degree)(self.between)
        return np.asarray(fitted - values(self.between))


@dataclass(frozen=True, slots=True)
class Ring:
    """A circular edge about the axis: radius and height in mm, from the angle `first` over `sweep`, rad."""

    radius: float
    height: float
    first: float
    sweep: float


@dataclass(frozen=True, slots=True)
class Patch:
    """One face: poles (n, m, 3) in mm, along its edge and upwards; of one that lies on a tip or bottom land the circles at its ends."""

    along: Basis
    poles: Floats
    rings: tuple[Ring, Ring] | None


@dataclass(frozen=True, slots=True)
class EndBand:
    """The faces from one height to another of a tooth and the space after it, edge by edge; those of the other teeth are these, turned."""

    low: float
    high: float
    upwards: Basis
    patches: tuple[Patch, ...]


def end_bands(gear: Gear, edges: tuple[Edge, ...]) -> tuple[list[EndBand], list[EndBand]]:
    """The bands at the low and at the high end, each from below upwards; none where the ends are sharp.

    Raises
    ------
    InputError
        If the chamfer or rounding leaves nothing of an edge on the end face, or reaches the bore, the rim or the groove.
    """
    spec, size = gear.spec, gear.spec.end_edge
    if size == 0.0:
        return [], []
    key = "end_rounding" if spec.end_rounding > 0.0 else "end_chamfer"
    where = f"[{spec.name}] {key} = {as_given(size)} mm:"
    wall = gear.orientation * (gear.root_radius - gear.body_radius)
    if size >= wall and gear.body_radius > 0.0:
        raise InputError(f"{where} reaches the {'rim' if spec.internal else 'bore'}; below {at_most(wall)} mm it would not")
    low, high = segments(gear)[0], segments(gear)[-1]
    if size >= low.high - low.low:
        raise InputError(f"{where} reaches the groove; below {at_most(low.high - low.low)} mm it would not")
    parallels = Parallels(edges, gear.teeth, gear.orientation)
    ends = [_End(gear, parallels, low, upper=False), _End(gear, parallels, high, upper=True)]
    bands = []
    for end in ends:
        try:
            end.check(size)
            bands.append(end.bands())
        except (UsedUp, _NotDrawn) as edge:
            bend = max(_bend_at_form(gear, side) for side in Side)
            if bend > MOST_BEND and (isinstance(edge, _NotDrawn) or str(edge) == "flank"):
                raise InputError(
                    f"{where} cannot be drawn where the flank as modified leaves its fillet, next to the base circle, with a bend"
                    f" of {math.degrees(bend):.2g}°; sharp ends, or nothing modified at the form circle, would be right"
                ) from None
            if isinstance(edge, _NotDrawn):
                raise InputError(f"{where} its faces cannot be drawn; a smaller one would be right") from None
            raise InputError(f"{where} leaves no {edge} on the end face; below {at_most(end.limit(size))} mm it would") from None
    return bands[0][::-1], bands[1]


def _bend_at_form(gear: Gear, side: Side) -> float:
    """By how much what is drawn bends a flank at the form circle, rad: a slope δ′ of the deviation over its length of roll by about δ′ r_b / L."""
    plain = Gear.from_spec(replace(gear.spec, left=FlankModification(), right=FlankModification()))
    normals = [flank_paths(one, side)[0].normals(np.array([0.0]))[0] for one in (gear, plain)]
    turned = drawn_turn(gear, side, gear.form_roll)
    now, as_plain = (math.atan2(y, x) for x, y in normals)
    return abs(math.remainder(now - as_plain - turned, 2.0 * math.pi))


class _NotDrawn(Exception):
    """A face needs too many points."""


class _End:
    """One end of the face."""

    def __init__(self, gear: Gear, parallels: Parallels, segment: Segment, upper: bool) -> None:
        self.gear, self.parallels, self.segment, self.upper = gear, parallels, segment, upper
        self.edges = parallels.edges
        self.size, self.rounded = gear.spec.end_edge, gear.spec.end_rounding > 0.0

    def check(self, depth: float) -> None:
        """Raise `UsedUp` where nothing is left of an edge at a depth (mm), on the end face."""
        z = np.array([self.segment.high if self.upper else self.segment.low])
        for i, edge in enumerate(self.edges):
            first, last = self._points(i, np.array([0.0, 1.0]), np.array([depth]), z)[:, 0]
            if np.linalg.norm(last - first) < SHORTEST_EDGE or (edge.path is None and self._arc(i, depth, z[0])[1] > math.pi):
                raise UsedUp(edge.name)

    def limit(self, depth: float) -> float:
        """Depth, mm, up to which nothing is used up."""
        low, high = 0.0, depth
        for _ in range(LIMIT_ROUNDS):
            middle = 0.5 * (low + high)
            try:
                self.check(middle)
                low = middle
            except UsedUp:
                high = middle
        return low

    def bands(self) -> list[EndBand]:
        """From the body to the end face."""
        gear, size = self.gear, self.size
        end = self.segment.high if self.upper else self.segment.low
        knees = {abs(end - knee) for side in {edge.side for edge in self.edges} for knee in gear.drawn(side).face_knees}
        breaks = [self._place(height=knee) for knee in knees if 0.0 < knee < size]
        fold = self.parallels.fold(size)
        breaks += [self._place(depth=fold)] if SHORTEST_EDGE < fold < size else []
        return [
            band
            for first, last in pairwise([0.0, *sorted(breaks), 0.5 * math.pi if self.rounded else size])
            for band in self._between(first, last, HALVINGS)
        ]

    def _place(self, depth: float | None = None, height: float = 0.0) -> float:
        """Where on the profile a depth lies, or a height above the end face, mm: the depth of a chamfer, θ of a rounding."""
        if self.rounded:
            return math.acos(1.0 - depth / self.size) if depth is not None else math.asin(1.0 - height / self.size)
        return depth if depth is not None else self.size - height

    def _profile(self, place: Floats) -> tuple[Floats, Floats]:
        """Depth and z, mm, at places of the profile."""
        if self.rounded:
            depth, height = self.size * (1.0 - np.cos(place)), self.size * (1.0 - np.sin(place))
        else:
            depth, height = place, self.size - place
        return depth, (self.segment.high - height if self.upper else self.segment.low + height)

    def _between(self, first: float, last: float, halvings: int) -> list[EndBand]:
        """The bands from one place of the profile to another: one, or more where one would need too many points."""

        def levels(share: Floats) -> tuple[Floats, Floats]:
            way = share if self.upper else 1.0 - share
            return self._profile(np.where(way == 1.0, last, first + (last - first) * way))

        for count in UPWARDS:
            upwards = Basis.through(count)
            if all(self._off(upwards, levels, i) < 0.5 * END_TOLERANCE for i in range(len(self.edges))):
                return [self._band(upwards, *levels(upwards.nodes))]
        if halvings == 0:
            raise _NotDrawn
        middle = 0.5 * (first + last)
        return [*self._between(first, middle, halvings - 1), *self._between(middle, last, halvings - 1)]

    def _off(self, upwards: Basis, levels: Callable[[Floats], tuple[Floats, Floats]], index: int) -> float:
        """How far a face is from the exact one between its rows of points, mm.

        At its two corners any way; elsewhere across the face and upwards, for where along the edge a point lies is no matter, and next to a
        fold of the parallel it is not known as well.
        """
        missed = upwards.missed(lambda share: self._points(index, CHECKS, *levels(share)).swapaxes(0, 1))
        corners = np.linalg.norm(missed[:, [0, -1]], axis=-1)
        away = self._normals(index, CHECKS, *levels(upwards.between)).swapaxes(0, 1)
        across = np.hypot((missed * away).sum(axis=-1), missed[..., 2])
        return float(max(corners.max(), across.max()))

    def _band(self, upwards: Basis, depth: Floats, z: Floats) -> EndBand:
        """The band through exact points at depths and heights (m,), mm."""
        patches = []
        for i, edge in enumerate(self.edges):

            def exact(along: Floats, i: int = i) -> Floats:
                return self._points(i, along, depth, z)

            along = next(
                (
                    basis
                    for basis in map(Basis.through, ALONG)
                    if np.linalg.norm(basis.missed(exact), axis=-1).max() < 0.5 * END_TOLERANCE
                ),
                None,
            )
            if along is None:
                raise _NotDrawn
            poles = upwards.poles(along.poles(exact(along.nodes)), axis=1)
            poles[:, [0, -1], 2] = z[[0, -1]]
            rings = None
            if edge.path is None:
                low, high = (Ring(self.parallels.radius(i, depth[k]), z[k], *self._arc(i, depth[k], z[k])) for k in (0, -1))
                rings = low, high
            patches.append(Patch(along, poles, rings))
        return EndBand(float(z[0]), float(z[-1]), upwards, tuple(patches))

    def _points(self, index: int, along: Floats, depth: Floats, z: Floats) -> Floats:
        """Exact points (n, m, 3) of a face at shares of its edge (n,), and depths and heights (m,), mm."""
        path = self.edges[index].path
        if path is None:
            radius = np.array([self.parallels.radius(index, value) for value in depth])
            plane = radius * self._directions(index, along, depth, z)
        else:
            share = self._shares(index, along, depth)
            plane = self._turned(index, path.parallel(share.ravel(), np.broadcast_to(depth, share.shape).ravel()), z)
        return np.stack([plane.real, plane.imag, np.broadcast_to(z, plane.shape)], axis=-1)

    def _normals(self, index: int, along: Floats, depth: Floats, z: Floats) -> Floats:
        """Unit normals (n, m, 3) of the section's parallels there, of either sense."""
        path = self.edges[index].path
        if path is None:
            plane = self._directions(index, along, depth, z)
        else:
            plane = self._turned(index, path.normals(self._shares(index, along, depth).ravel()), z)
        return np.stack([plane.real, plane.imag, np.zeros(plane.shape)], axis=-1)

    def _shares(self, index: int, along: Floats, depth: Floats) -> Floats:
        """(n, m) parameters of a path."""
        spans = np.array([self.parallels.spans(float(value))[index] for value in depth])
        return np.asarray(spans[:, 0] + np.multiply.outer(along, spans[:, 1] - spans[:, 0]))

    def _turned(self, index: int, flat: Floats, z: Floats) -> NDArray[np.complex128]:
        """(n, m) vectors of the section as drawn, turned as it is at heights (m,)."""
        turn = side_turn(self.gear, self.segment, self.edges[index].side, z)
        return np.asarray((flat[:, 0] + 1j * flat[:, 1]).reshape(-1, len(z)) * np.exp(1j * turn))

    def _directions(self, index: int, along: Floats, depth: Floats, z: Floats) -> NDArray[np.complex128]:
        """(n, m) directions from the axis to an arc."""
        arcs = np.array([self._arc(index, deep, height) for deep, height in zip(depth, z, strict=True)])
        return np.asarray(np.exp(1j * (arcs[:, 0] + np.multiply.outer(along, arcs[:, 1]))))

    def _arc(self, index: int, depth: float, z: float) -> tuple[float, float]:
        """Angle (rad) at which an arc starts, and how far it goes: from the edge before it to the edge after it."""
        after = (index + 1) % len(self.edges)
        x, y, _ = self._points(index - 1, np.array([1.0]), np.array([depth]), np.array([z]))[0, 0]
        first = math.atan2(y, x)
        x, y, _ = self._points(after, np.array([0.0]), np.array([depth]), np.array([z]))[0, 0]
        last = math.atan2(y, x) + (self.gear.pitch_angle if after == 0 else 0.0)
        if index == 0:
            first -= self.gear.pitch_angle
        return first, (last - first) % (2.0 * math.pi)
