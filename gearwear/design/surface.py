"""Where a point belongs on the nominal gear: surface, tooth, side, foot point, normal, deviation.

The one type that crosses the rooms, `SurfacePoints`, and its two makers: `locate` (from measured
points; the exact plumb line, no triangles, no search) and `flank_points` (from surface parameters).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from functools import partial

import numpy as np

from gearwear import compiled
from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.given import check_whole, real_array
from gearwear.design.root import fillet_table
from gearwear.design.side import Side
from gearwear.design.twist import hand_at, normal_lean, section_angle, segments, turn_at
from gearwear.errors import InputError, check_kind
from gearwear.processors import threads

FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE, OTHER = range(8)
"""Surface codes; BORE is the outside of a ring too; OTHER is what is not measured (chamfer, rounding, keyway, hub, web, stray)."""

SURFACE_NAMES = ("flank", "fillet", "root", "tip", "end_low", "end_high", "bore", "other")

MOST_ROUNDS, SETTLED = 12, 1e-13
"""Rounds to the foot on a modified flank, and the change (mm) at which they end."""

CHUNK = 32768
"""Points worked on at a time: the temporaries stay in the processor's cache and memory stays bounded."""
WORTH_THREADS = 3
"""Chunks from which on threads share them: to start some takes as long as a chunk or two."""


@dataclass(frozen=True, slots=True)
class SurfacePoints:
    """n points located on the design.

    Parameters
    ----------
    surface : (n,) int8
        Code of the surface.
    tooth : (n,) int32
        0-based, counter-clockwise from the design's +x.
    side : (n,) int8
        +1 left (counter-clockwise) flank or fillet, −1 right, 0 on other surfaces.
    roll : (n,) float
        Length of roll L of the foot point in mm on flanks, nan elsewhere.
    position : (n, 3) float
        Foot point of the plumb line in space, design frame, mm: on helical teeth not at the point's own height.
    normal : (n, 3) float
        Outward unit normal at the foot point, in space.
    deviation : (n,) float
        mm along the normal in space, + is too much material; nan where surface is OTHER. Along the transverse base tangent, as ISO 1328
        has it, a flank's is 1/cos β_b of it.
    """

    surface: Ints
    tooth: Ints
    side: Ints
    roll: Floats
    position: Floats
    normal: Floats
    deviation: Floats

    def __len__(self) -> int:
        return len(self.deviation)

    @classmethod
    def room(cls, n: int) -> SurfacePoints:
        """For n points that are still to be filled in."""
        return cls(
            np.empty(n, np.int8),
            np.empty(n, np.int32),
            np.empty(n, np.int8),
            np.empty(n),
            np.empty((n, 3)),
            np.empty((n, 3)),
            np.empty(n),
        )

    def take(self, which: Bools | Ints | slice) -> SurfacePoints:
        """The points picked by a mask or by indices; of a slice, views into these."""
        if isinstance(which, slice):
            return SurfacePoints(*(getattr(self, f.name)[which] for f in fields(self)))
        # `take` is several times as fast as an index in brackets.
        at = np.flatnonzero(which) if which.dtype == np.bool_ else which
        return SurfacePoints(*(getattr(self, f.name).take(at, axis=0) for f in fields(self)))

    def own_roll(self, gear: Gear) -> Floats:
        """Length of roll (mm) at the points' own radius, not at their feet; (n,), nan off the flanks."""
        return np.asarray(self.roll + gear.orientation * gear.base_helix_cosine * self.deviation, dtype=np.float64)

    @property
    def own_height(self) -> Floats:
        """Height z (mm) of the points themselves, not of their feet; (n,), nan where surface is OTHER."""
        return np.asarray(self.position[:, 2] + self.normal[:, 2] * self.deviation, dtype=np.float64)

    @property
    def measured(self) -> Floats:
        """The points themselves, (n, 3) mm: where they lie, not their feet."""
        return np.asarray(self.position + self.normal * np.nan_to_num(self.deviation)[:, None], dtype=np.float64)

    def with_deviation(self, deviation: Floats) -> SurfacePoints:
        """The same feet with other deviations."""
        return replace(self, deviation=deviation)

    def off_surface(self, which: Ints) -> SurfacePoints:
        """The same with some of them, by index, on no surface: as `locate` leaves these, where they lie."""
        surface, side = self.surface.copy(), self.side.copy()
        roll, deviation, position = self.roll.copy(), self.deviation.copy(), self.position.copy()
        position[which] = self.take(which).measured
        surface[which], side[which], roll[which], deviation[which] = OTHER, 0, np.nan, np.nan
        return replace(self, surface=surface, side=side, roll=roll, position=position, deviation=deviation)


@dataclass(frozen=True, slots=True)
class Bands:
    """How far, in mm, a point may lie from a surface and still belong to it: (missing, extra).

    A worn flank ends below the tip land and beside the end faces; these bands keep its points on the
    flank. Registration narrows them to what the scan's own scatter asks for.

    Parameters
    ----------
    tip, root, end_low, end_high, bore : (float, float)
        Least and greatest deviation.
    flank : (float, float)
        Least and greatest deviation for flanks and fillets; beyond it a point is OTHER.
    """

    tip: tuple[float, float]
    root: tuple[float, float]
    end_low: tuple[float, float]
    end_high: tuple[float, float]
    bore: tuple[float, float]
    flank: tuple[float, float]

    @classmethod
    def wide(cls, gear: Gear) -> Bands:
        """Bands before anything is known of the scan: ±0.2 transverse modules; flanks −0.6 of the thickness … +0.3 modules."""
        m = gear.transverse_module
        near = (-0.2 * m, 0.2 * m)
        return cls(near, near, near, near, near, (-0.6 * gear.tooth_thickness, 0.3 * m))

    def inner_face(self, gear: Gear) -> float:
        """Least deviation (mm) from the faces that end the halves of a double helical gear in the groove: that from the lower end, where it was seen."""
        return self.end_low[0] if np.isfinite(self.end_low[0]) else Bands.wide(gear).end_low[0]

    def end_margins(self, gear: Gear) -> tuple[tuple[float, float], tuple[float, float]]:
        """So near to the low and to the high end a point lies on an edge of it, mm, on left and on right flanks; −∞ where there is none.

        The ends of a gear may lie off those drawn, and its edges with them; edges that were seen are where they are.
        """
        off = 0.0 if gear.spec.ends_seen is not None else min(self.end_high[1], Bands.wide(gear).end_high[1])
        (a, b), (c, d) = gear.spec.end_edges
        a, b, c, d = (edge + off if edge > 0.0 else -math.inf for edge in (a, b, c, d))
        return (a, b), (c, d)


def locate(points: Floats, gear: Gear, bands: Bands | None = None, workers: int | None = None) -> SurfacePoints:
    """Locate measured points on the design and measure each one's normal deviation.

    Parameters
    ----------
    points : (n, 3) float
        In the design frame, mm; what is not finite is on no surface (OTHER).
    gear : Gear
        The nominal gear.
    bands : Bands or None
        Which surface a point may belong to; None: `Bands.wide`.
    workers : int or None
        Threads; None: one per processor.

    Returns
    -------
    SurfacePoints

    Raises
    ------
    InputError
        If these are no points in space, or no gear.

    Notes
    -----
    On the flank a point at radius r has the closed form (ISO 21771; normals of an involute are tangents of the
    base circle) ::

        δ = r_b (|θ − κ(z − b/2) − θ_k| − ψ_b + ι inv α_r) cos β_b,   L = sqrt(r² − r_b²) − ι δ cos β_b

    which is the exact plumb line in space whatever the size of δ: a helicoid moved along its normals is the same helicoid, turned (it is the
    tangent developable of its base helix, β_b inclined to the axis). On the root fillet the normal passes through
    the pitch point of generation; its angle is found by Newton's method to rounding error (`RootCurve.normal_angle`). A helical fillet's
    plumb line leaves the point's own section; one more round in the foot's leaves 1e-9 mm at 0.03 mm off, 5e-6 at 0.3 (tested to 35°). Tip,
    root land, bore and ends are circles and planes. On a double helical gear the half that a point lies on says the hand; what lies in the
    groove is OTHER. The metal is the intersection of its bounding surfaces, so a point
    belongs to the one with the greatest signed distance, within `bands`. Below and above the form circle the tooth
    side is split by the point's own radius.
    """
    check_kind(gear, Gear, "gear", "one of design.gears")
    check_kind(bands, Bands | None, "bands", "Bands, or None,")
    if workers is not None:
        check_whole("workers", workers, 1)
    points = real_array("points", points)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"points of shape {points.shape}: (n, 3), mm in the design's frame, would be right")
    n = len(points)
    out = SurfacePoints.room(n)
    limits = bands or Bands.wide(gear)
    if compiled.pays(n):
        from gearwear.design.compiled_locate import filler

        fill = filler(gear, limits)
    else:
        fill = partial(_locate_chunk, gear, limits, fillet_table(gear.root_curve, gear.fillet_end, gear.orientation))
    _by_chunks(n, lambda part: fill(points[part], out.take(part)), workers)
    return out


def deviations(points: Floats, gear: Gear, bands: Bands | None = None, workers: int | None = None) -> Floats:
    """Deviation of each point alone, (n,) mm, nan where it is on no surface; parameters as `locate`.

    What else `locate` says of a point is nine times as much to write, and compiled that takes longer than the deviation itself.
    """
    points = np.asarray(points, dtype=np.float64)
    n = len(points)
    if not compiled.pays(n):
        return locate(points, gear, bands, workers).deviation
    from gearwear.design.compiled_locate import measurer

    out, measure = np.empty(n), measurer(gear, bands or Bands.wide(gear))
    _by_chunks(n, lambda part: measure(points[part], out[part]), workers)
    return out


def _by_chunks(n: int, work: Callable[[slice], None], workers: int | None) -> None:
    """Do the work for n points, chunk by chunk."""
    chunks = [slice(start, min(start + CHUNK, n)) for start in range(0, n, CHUNK)]
    count = workers or threads()
    if count == 1 or len(chunks) < WORTH_THREADS:
        for chunk in chunks:
            work(chunk)
    else:  # numpy releases the interpreter inside its loops
        with ThreadPoolExecutor(count) as pool:
            list(pool.map(work, chunks))


@dataclass(frozen=True, slots=True, kw_only=True)
class _InSection:
    """Points in their own sections: the direction away from the axis, L at their own radius (mm), the tooth next to them, and side and angle (rad)
    from its centre line; whether they lie towards the tip from the form circle."""

    radius: Floats
    ex: Floats
    ey: Floats
    reach: Floats
    index: Floats
    side: Floats
    within: Floats
    outer: Bools

    @classmethod
    def of(cls, gear: Gear, x: Floats, y: Floats, z: Floats) -> _InSection:
        rb = gear.base_radius
        square = x * x + y * y
        radius = np.sqrt(square)
        angle = section_angle(gear, x, y, z)
        index = np.rint(angle / gear.pitch_angle)
        within = angle - index * gear.pitch_angle
        inverse = 1.0 / np.maximum(radius, 1e-300)
        return cls(
            radius=radius,
            ex=x * inverse,
            ey=y * inverse,
            reach=np.sqrt(np.maximum(square - rb * rb, 0.0)),
            index=index,
            side=np.copysign(1.0, within),
            within=np.abs(within),
            outer=gear.orientation * (radius - gear.form_radius) >= 0.0,
        )


@dataclass(frozen=True, slots=True)
class _Outermost:
    """The surface that each point lies farthest outside of, as far as surfaces were looked at; the distance (mm), and the normal there."""

    surface: Ints
    deviation: Floats
    nx: Floats
    ny: Floats
    nz: Floats

    def put(self, at: Bools, code: int, deviation: Floats, nx: Floats | float, ny: Floats | float, nz: float) -> None:
        """Another surface at some of the points."""
        self.surface[at] = code
        for own, its in ((self.deviation, deviation), (self.nx, nx), (self.ny, ny), (self.nz, nz)):
            np.copyto(own, its, where=at)


def _locate_chunk(gear: Gear, bands: Bands, table: tuple[Floats, Floats], points: Floats, out: SurfacePoints) -> None:
    """Fill `out` (views into the result) for one chunk of points."""
    x, y, z = np.ascontiguousarray(points.T)
    seen = _InSection.of(gear, x, y, z)
    found = _outline(gear, bands, table, seen, z)
    _end_there(gear, bands, seen.side, z, found)
    surface, deviation = found.surface, found.deviation
    least = np.array(
        [bands.flank[0]] * 2 + [bands.root[0], bands.tip[0], bands.end_low[0], bands.end_high[0], bands.bore[0], 0.0]
    )
    most = np.array([bands.flank[1]] * 2 + [bands.root[1], bands.tip[1], bands.end_low[1], bands.end_high[1], bands.bore[1], 0.0])
    # A surface the bands exclude is not silently another one: such points are OTHER.
    surface[~((deviation >= least.take(surface)) & (deviation <= most.take(surface)))] = OTHER

    out.surface[:] = surface
    index = np.nan_to_num(seen.index)  # what is no number is on no surface, and on no tooth of another gear either
    out.tooth[:] = index - gear.teeth * np.floor(index / gear.teeth)
    out.side[:] = np.where((surface == FLANK) | (surface == FILLET), seen.side, 0.0)
    out.roll[:] = np.where(surface == FLANK, seen.reach - gear.orientation * gear.base_helix_cosine * deviation, np.nan)
    known = surface != OTHER
    safe = np.where(known, deviation, 0.0)
    for axis, (value, component) in enumerate(((x, found.nx), (y, found.ny), (z, found.nz))):
        out.normal[:, axis] = component
        out.position[:, axis] = value - safe * component
    out.deviation[:] = np.where(known, deviation, np.nan)


def _outline(gear: Gear, bands: Bands, table: tuple[Floats, Floats], seen: _InSection, z: Floats) -> _Outermost:
    """Of tooth sides, root, tip and bore."""
    radius, outer, orientation = seen.radius, seen.outer, gear.orientation
    found, at_root = _tooth_sides(gear, bands, table, seen, z)
    outwards_x, outwards_y = orientation * seen.ex, orientation * seen.ey
    root = orientation * (radius - gear.root_radius)
    found.put(at_root, ROOT, root, outwards_x, outwards_y, 0.0)
    tip = orientation * (radius - gear.tip_radius)
    at_tip = outer & (tip >= found.deviation) & (tip >= bands.tip[0])
    if gear.flank_end_radius != gear.tip_radius:  # a chamfer or a rounding lies between
        found.surface[outer & (orientation * (radius - gear.flank_end_radius) > 0.0)] = OTHER
        at_tip = outer & (np.abs(tip) <= bands.tip[1]) & (seen.within <= gear.tip_half_angle)
    found.put(at_tip, TIP, tip, outwards_x, outwards_y, 0.0)
    if gear.body_radius > 0.0:
        bore = orientation * (gear.body_radius - radius)
        found.put(bore > root, BORE, bore, -outwards_x, -outwards_y, 0.0)
    return found


def _tooth_sides(gear: Gear, bands: Bands, table: tuple[Floats, Floats], seen: _InSection, z: Floats) -> tuple[_Outermost, Bools]:
    """Flanks and fillets, and the points below the form circle that lie on no fillet but on the root."""
    rb, cos_helix, sin_helix = gear.base_radius, gear.base_helix_cosine, gear.base_helix_sine
    reach, side, within, outer, orientation = seen.reach, seen.side, seen.within, seen.outer, gear.orientation
    flank = (orientation * (reach - rb * np.arctan(reach / rb)) + rb * (within - gear.base_half_angle)) * cos_helix
    fillet_within = within
    if gear.modified:
        flank = flank - cos_helix * _drawn_offset(gear, side, reach, z, flank)
        fillet_within = within - _offset_on(gear, side, gear.form_roll, z) / rb
    inverse = 1.0 / np.maximum(seen.radius, 1e-300)
    radial = orientation * reach * (inverse * cos_helix)
    around = side * rb * (inverse * cos_helix)
    nz = side * -sin_helix
    if gear.spec.gap > 0.0:
        nz = nz * hand_at(gear, z)
    nx, ny = radial * seen.ex - around * seen.ey, radial * seen.ey + around * seen.ex
    found = _Outermost(np.where(outer, np.int8(FLANK), np.int8(FILLET)), np.where(outer, flank, 0.0), nx, ny, nz)

    from_space = 0.5 * gear.pitch_angle - fillet_within
    land = ~outer & (from_space <= gear.root_half_angle)
    below = ~outer & ~land & (orientation * (seen.radius - gear.root_radius) >= bands.root[0])
    at = np.flatnonzero(below)
    if len(at):
        distance, along, across, up = _plumb_lines(gear, table, seen.radius[at], from_space[at])
        across *= side[at]
        found.deviation[at] = distance
        nx[at], ny[at] = seen.ex[at] * along - seen.ey[at] * across, seen.ey[at] * along + seen.ex[at] * across
        if gear.twist != 0.0:
            nz[at] = up * (side * hand_at(gear, z))[at]
    return found, ~outer & ~below


def _end_there(gear: Gear, bands: Bands, side: Floats, z: Floats, found: _Outermost) -> None:
    """The ends of the face, and what lies in the groove of a double helical gear or on an edge of the ends."""
    b, outline = gear.face_width, found.deviation.copy()
    for code, gap, limit, up in ((END_LOW, -z, bands.end_low, -1.0), (END_HIGH, z - b, bands.end_high, 1.0)):
        at_end = (gap >= outline) & (gap >= limit[0])
        if at_end.any():
            found.put(at_end, code, gap, 0.0, 0.0, up)
    surface = found.surface
    if gear.spec.gap > 0.0:
        surface[_in_groove(gear, z, outline, bands) & (surface != BORE)] = OTHER
    if gear.spec.end_edge > 0.0:
        # Deep points of the outline too: of all that lie there these alone would be left, strays for the most part.
        of_outline = ~np.isin(surface, (END_LOW, END_HIGH, BORE))
        low, high = (np.where(side > 0.0, *end) for end in bands.end_margins(gear))
        surface[(of_outline | (outline > -low)) & (z < low)] = OTHER
        surface[(of_outline | (outline > -high)) & (z > b - high)] = OTHER


def _in_groove(gear: Gear, z: Floats, outline: Floats, bands: Bands) -> Bools:
    """Points between the halves of a double helical gear, and on the faces that end them there: those are no datum and nothing is said of them."""
    low, high = segments(gear)
    beyond = np.minimum(z - low.high, high.low - z)  # of the inner faces, + in the groove
    return np.asarray((beyond > 0.0) | ((beyond >= outline) & (beyond >= bands.inner_face(gear))))


def _offset_on(gear: Gear, side: Floats, roll: Floats | float, z: Floats) -> Floats:
    """δ₀, mm, on the flank of each point's side at roll lengths and heights."""
    left, right = (gear.drawn(which).offset(roll, z) for which in (Side.LEFT, Side.RIGHT))
    return np.where(side > 0.0, left, right)


def _drawn_offset(gear: Gear, side: Floats, reach: Floats, z: Floats, flank: Floats) -> Floats:
    """δ₀, mm, at the feet of points on the modified flank, from their distance `flank` (mm, along the normal) to the generated one.

    Locally a modified flank is the generated one, turned: the foot lies at L = reach − ι δ cos β_b, z + s δ sin β_b with δ = flank − δ₀ cos β_b.
    Rounds of that settle by the slope of δ₀, some hundredths, each.
    """
    cos_helix, sin_helix = gear.base_helix_cosine, gear.base_helix_sine
    result = np.zeros_like(flank)
    for which in Side:
        drawn, at = gear.drawn(which), np.flatnonzero(side == which)
        roll, height, offset = reach[at], z[at], np.zeros(len(at))
        for _ in range(MOST_ROUNDS):
            deviation = flank[at] - cos_helix * offset
            new = drawn.offset(roll - gear.orientation * cos_helix * deviation, height + which * sin_helix * deviation)
            moved = float(np.abs(new - offset).max(initial=0.0))
            offset = new
            if moved < SETTLED:
                break
        result[at] = offset
    return result


def _plumb_lines(gear: Gear, table: tuple[Floats, Floats], radius: Floats, beta: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Distance of points to the fillet, and its normal there along the point's radius, across it, and up; on the left of a space."""
    root = gear.root_curve
    phi = root.normal_angle(radius, beta, np.interp(radius, *table), gear.fillet_end)
    distance, along, across = root.plumb_line(radius, beta, phi)
    if gear.twist != 0.0:
        return _lifted(gear, radius, beta, phi, distance)
    return distance, along, across, np.zeros_like(distance)


def _lifted(gear: Gear, radius: Floats, beta: Floats, phi: Floats, distance: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """From the plumb line in the point's own section to that in space: distance, the normal along the point's radius, across it, and up.

    The foot lies higher or lower by δ sin γ, so in the section of the foot the point stands turned by κ δ sin γ. To first order in that
    turn the distance in the section falls by the lever of the normal for each radian, which gives δ = (δ_t + lever · turn) cos γ.
    """
    root = gear.root_curve
    lever = root.lever(phi)
    cosine, sine = normal_lean(gear, lever)
    turn = gear.twist * sine * cosine * distance
    phi = root.normal_angle(radius, beta + turn, phi, gear.fillet_end)
    distance, along, across = root.plumb_line(radius, beta + turn, phi)
    lever = root.lever(phi)
    cosine, sine = normal_lean(gear, lever)
    return (distance + lever * turn) * cosine, along * cosine, across * cosine, -sine


def flank_points(gear: Gear, tooth: Ints, side: Ints, roll: Floats, z: Floats) -> SurfacePoints:
    """Points of the nominal flank from their parameters; deviation 0.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    tooth, side : (n,) int
        0-based tooth, +1 left or −1 right.
    roll, z : (n,) float
        Length of roll and height, mm.

    Returns
    -------
    SurfacePoints

    Notes
    -----
    ``P = r_b (cos τ, sin τ) + s ι L (−sin τ, cos τ)``, ``n = (s cos β_b (−sin τ, cos τ), −s sin β_b)``,
    ``τ = θ_k + κ(z − b/2) + s (ψ_b − ι L / r_b)`` (reference geometry of ISO 21771). A modified flank at L is the involute's point at
    L − ι δ₀, moved by δ₀ along its base tangent; the normal is the involute's, off by the slope of δ₀.
    """
    s = np.asarray(side, dtype=np.float64)
    generated = roll
    if gear.modified:
        generated = roll - gear.orientation * _offset_on(gear, s, roll, z)
    tau = np.asarray(tooth) * gear.pitch_angle + s * (gear.base_half_angle - gear.orientation * generated / gear.base_radius)
    if gear.twist != 0.0:
        tau = tau + turn_at(gear, z)
    cos, sin = np.cos(tau), np.sin(tau)
    zero = np.zeros_like(cos)
    normal = np.column_stack([-s * sin, s * cos, zero])
    position = np.column_stack([gear.base_radius * cos, gear.base_radius * sin, z + zero])
    position[:, :2] += gear.orientation * roll[:, None] * normal[:, :2]
    normal[:, :2] *= gear.base_helix_cosine
    normal[:, 2] = -s * gear.base_helix_sine * hand_at(gear, z)
    n = len(tau)
    return SurfacePoints(
        np.full(n, FLANK, np.int8),
        np.asarray(tooth, np.int32),
        np.asarray(side, np.int8),
        np.asarray(roll, np.float64),
        position,
        normal,
        np.zeros(n),
    )
