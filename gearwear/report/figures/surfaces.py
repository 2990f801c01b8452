"""Triangles to look at: the nominal gear, the worn gear and the lost metal, built from half angles.

They are for the eye only. Strips are kept apart at the edges of a tooth, so that edges stay sharp
when shaded, and are as fine as a budget of vertices allows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles, straight_weights
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, ROOT, TIP, SurfacePoints
from gearwear.design.twist import drawn_height, section_angle, segments, twisted
from gearwear.report.figures.arrays import ReportArrays

FLANK_VERTICES = 36000
"""Vertices on all flanks of the 3-D view: a page of 1.5 to 5 MB, and smooth on a laptop."""

TURN_PER_ROW = 0.03
"""Rad that helical teeth may turn from one row of the nominal gear to the next."""
FILLET_ROWS, LAND_ROWS, RINGS = 5, 4, 5


@dataclass(frozen=True, slots=True)
class SurfaceTriangles:
    """A piece of surface to draw.

    Parameters
    ----------
    name : str
        What a reader is told it is: "left flank", "tip", …
    vertices : (n, 3) float
        Design frame, mm.
    faces : (m, 3) int
        Counter-clockwise seen from outside.
    tooth : (n,) int
        1-based, as in the report.
    deviation_um : (n,) float or None
        nan where it was not seen.
    """

    name: str
    vertices: Floats
    faces: Ints
    tooth: Ints
    deviation_um: Floats | None = None


def gear_surfaces(arrays: ReportArrays, worn: bool, budget: int = FLANK_VERTICES) -> list[SurfaceTriangles]:
    """The gear in pieces: left and right flanks, fillets, tips, roots, ends.

    Parameters
    ----------
    arrays : ReportArrays
        The gear and its maps.
    worn : bool
        As it is now, with deviations; else the design, coarse.
    budget : int
        Vertices that the flanks may have in all.

    Returns
    -------
    list of SurfaceTriangles
    """
    gear = arrays.gear
    columns, rows = _fineness(arrays, budget) if worn else (16, 2 + int(abs(gear.twist) * gear.face_width / TURN_PER_ROW))
    halves = [_of_one_helix(arrays, worn, columns, z) for z in _heights(gear, rows)]
    if len(halves) == 1:
        return halves[0]
    low, high = segments(gear)
    neck = _wall(gear, "end face", gear.groove_radius, (low.high, high.low), flip=False)
    return [*map(_joined, zip(*halves, strict=True)), neck]


def _heights(gear: Gear, rows: int) -> list[Floats]:
    """Heights, mm, of about so many rows over the face, of each helix by itself."""
    parts = segments(gear)
    counts = [max(2, round(rows * (part.high - part.low) / gear.face_width)) for part in parts]
    return [np.linspace(part.low, part.high, count) for part, count in zip(parts, counts, strict=True)]


def _joined(pieces: Sequence[SurfaceTriangles]) -> SurfaceTriangles:
    """Pieces of one name as one."""
    start = np.cumsum([0, *(len(piece.vertices) for piece in pieces[:-1])])
    values = [piece.deviation_um for piece in pieces if piece.deviation_um is not None]
    return SurfaceTriangles(
        pieces[0].name,
        np.concatenate([piece.vertices for piece in pieces]),
        np.concatenate([piece.faces + first for piece, first in zip(pieces, start, strict=True)]),
        np.concatenate([piece.tooth for piece in pieces]),
        np.concatenate(values) if values else None,
    )


def _of_one_helix(arrays: ReportArrays, worn: bool, columns: int, z: Floats) -> list[SurfaceTriangles]:
    """The pieces of the gear, or of a half of it, from the lowest to the highest of the heights `z`, mm."""
    gear = arrays.gear
    # The trochoid leaves the root circle along a tangent: even steps of radius would cut its foot off.
    low = gear.root_radius + (gear.form_radius - gear.root_radius) * np.linspace(0.0, 1.0, FILLET_ROWS + 1) ** 2
    roll = np.linspace(gear.form_roll, gear.tip_roll, columns)
    high = np.hypot(roll, gear.base_radius)
    if gear.flank_end_radius < gear.tip_radius:
        high = np.append(high, gear.tip_radius)
    radius = np.concatenate([low[:-1], high])
    psi = _half_angles(arrays.worn, radius, z) if worn else np.broadcast_to(
        gear.half_angles(radius, z), (gear.teeth, 2, len(z), len(radius))
    )  # fmt: skip
    if gear.flank_end_radius < gear.tip_radius:
        psi = psi.copy()
        psi[..., -1] = np.minimum(psi[..., -1], gear.tip_half_angle)

    values = _flank_values(arrays, arrays.deviation_um, high, z) if worn else None
    centre = np.arange(gear.teeth)[:, None, None] * gear.pitch_angle
    split = len(low) - 1
    pieces = []
    for sign in Side:
        side, word = sign.index, f"{sign} flank"
        angle = centre + sign * psi[:, side]
        colour = None if values is None else values[:, side]
        pieces.append(_strips(word, radius[split:], angle[..., split:], z, colour, flip=side == 0))
        colours = _fillet_colours(arrays, sign, low, z) if worn else None
        pieces.append(_strips(word.replace("flank", "fillet"), low, angle[..., : split + 1], z, colours, flip=side == 0))
    share = np.linspace(0.0, 1.0, LAND_ROWS + 1)
    right, left = -psi[:, 1, :, -1:], psi[:, 0, :, -1:]
    top = centre + right + (left - right) * share
    start, end = psi[:, 0, :, :1], gear.pitch_angle - np.roll(psi[:, 1, :, :1], -1, axis=0)
    bottom = centre + start + (end - start) * share
    for name, r, angle, code in (("tip", gear.tip_radius, top, TIP), ("root", gear.root_radius, bottom, ROOT)):
        colours = _land_colours(arrays, code, angle, z) if worn else None
        pieces.append(_strips(name, np.full(LAND_ROWS + 1, r), angle, z, colours, flip=False))
    pieces.append(_ends(gear, radius, psi[:, :, [0, -1]], bottom[:, [0, -1]], (float(z[0]), float(z[-1]))))
    # Of a ring radii run inwards from root to tip: every face is seen from its other side.
    turn = slice(None, None, gear.orientation)
    return [replace(piece, vertices=twisted(gear, piece.vertices), faces=piece.faces[:, turn]) for piece in pieces]


def worn_volume(arrays: ReportArrays, budget: int = FLANK_VERTICES) -> SurfaceTriangles | None:
    """The lost metal as closed bodies between the nominal and the worn flank, None where there is no wear."""
    columns, rows = _fineness(arrays, budget)
    parts = [_worn_between(arrays, columns, z) for z in _heights(arrays.gear, rows)]
    seen = [part for part in parts if part is not None]
    return _joined(seen) if len(seen) > 1 else next(iter(seen), None)


def _worn_between(arrays: ReportArrays, columns: int, z: Floats) -> SurfaceTriangles | None:
    """The lost metal of one helix, between the first and the last of the heights `z`, mm."""
    gear = arrays.gear
    radius = np.hypot(np.linspace(gear.form_roll, gear.tip_roll, columns), gear.base_radius)
    depth = np.nan_to_num(_flank_values(arrays, arrays.wear_depth_um, radius, z))
    psi = _half_angles(arrays.worn, radius, z)
    nominal = np.broadcast_to(gear.half_angles(radius, z), psi.shape)
    vertices: list[Floats] = []
    faces: list[Ints] = []
    teeth: list[Ints] = []
    count = 0
    for tooth in range(gear.teeth):
        for sign in Side:
            side = sign.index
            worn = depth[tooth, side] > 0.0
            quads = worn[:-1, :-1] | worn[1:, :-1] | worn[:-1, 1:] | worn[1:, 1:]
            if not quads.any():
                continue
            for half in (nominal[tooth, side], np.where(worn, np.minimum(psi, nominal)[tooth, side], nominal[tooth, side])):
                angle = tooth * gear.pitch_angle + sign * half
                vertices.append(_positions(radius, angle, z))
            body = _shell(quads, flip=(side == 1) != gear.spec.internal)
            faces.append(body + count)
            count += 2 * psi[tooth, side].size
            teeth.append(np.full(2 * psi[tooth, side].size, tooth + 1))
    if not faces:
        return None
    every = twisted(gear, np.concatenate(vertices))
    return SurfaceTriangles("lost metal", *_used(every, np.concatenate(faces), np.concatenate(teeth)))


def section(arrays: ReportArrays, tooth: int, z_mm: float, count: int = 90) -> tuple[Floats, Floats]:
    """Outline of a tooth, nominal and worn, point by point, in mm; the tooth upright, left flank on the left.

    Parameters
    ----------
    arrays : ReportArrays
        The gear and its profiles.
    tooth : int
        1-based, as in the report.
    z_mm : float
        Height of the section.
    count : int
        Points on a side.

    Returns
    -------
    nominal, worn : (2 count, 2) float
    """
    gear = arrays.gear
    radius = gear.root_radius + (gear.tip_radius - gear.root_radius) * np.linspace(0.0, 1.0, count) ** 2
    worn = _half_angles(arrays.worn, radius, np.array([z_mm]))[tooth - 1, :, 0]
    both = np.stack([gear.half_angles(radius, np.array([z_mm]))[:, 0], worn])
    x = np.concatenate([-radius * np.sin(both[:, 0]), (radius * np.sin(both[:, 1]))[:, ::-1]], axis=1)
    y = np.concatenate([radius * np.cos(both[:, 0]), (radius * np.cos(both[:, 1]))[:, ::-1]], axis=1)
    return np.stack([x[0], y[0]], axis=1), np.stack([x[1], y[1]], axis=1)


def whole_outline(arrays: ReportArrays) -> tuple[Floats, Floats, Floats]:
    """Outline of the whole gear at the middle height: nominal and worn in mm, and the deviation in µm (nan off the flanks)."""
    gear = arrays.gear
    radius = np.concatenate([
        gear.root_radius + (gear.form_radius - gear.root_radius) * np.linspace(0.0, 1.0, 9)[:-1] ** 2,
        np.hypot(np.linspace(gear.form_roll, gear.tip_roll, 60), gear.base_radius),
    ])  # fmt: skip
    z = np.array([arrays.z_mm[middle_row(arrays)]])
    worn = _half_angles(arrays.worn, radius, z)[:, :, 0]
    deviation = _flank_values(arrays, arrays.deviation_um, radius, z)[:, :, 0]
    deviation[:, :, radius < gear.form_radius] = np.nan
    centre = np.arange(gear.teeth)[:, None] * gear.pitch_angle
    outlines = []
    for psi in (np.broadcast_to(gear.half_angles(radius, z)[:, 0], worn.shape), worn):
        angle = np.concatenate([centre - psi[:, 1], centre, (centre + psi[:, 0])[:, ::-1]], axis=1).ravel()
        around = np.tile(np.concatenate([radius, [gear.tip_radius], radius[::-1]]), gear.teeth)
        xy = np.stack([around * np.cos(angle), around * np.sin(angle)], axis=1)
        outlines.append(np.vstack([xy, xy[:1]]))
    colour = np.concatenate([deviation[:, 1], np.full((gear.teeth, 1), np.nan), deviation[:, 0, ::-1]], axis=1).ravel()
    return outlines[0], outlines[1], np.append(colour, colour[0])


def middle_row(arrays: ReportArrays) -> int:
    """Row of cells at mid-face, or in the middle of the lower half of a double helical gear."""
    if arrays.gear.spec.gap == 0.0:
        return len(arrays.z_mm) // 2
    return int(np.abs(arrays.z_mm - drawn_height(arrays.gear)).argmin())


def _fineness(arrays: ReportArrays, budget: int) -> tuple[int, int]:
    """Columns and rows of a flank: those of the maps, thinned alike to the budget."""
    columns, rows = len(arrays.roll_mm) + 1, max(len(arrays.z_mm) + 1, 2)
    thin = min(1.0, math.sqrt(budget / (2 * arrays.gear.teeth * columns * rows)))
    columns = max(8, int(columns * thin))
    return columns, max(2, min(int(rows * thin), budget // (2 * arrays.gear.teeth * columns)))


def _linear(new: Floats, old: Floats) -> Floats:
    """(len(old), len(new)) weights of linear interpolation, constant beyond the ends; `old` may fall."""
    if old[0] > old[-1]:
        return _linear(new, old[::-1])[::-1]
    return straight_weights(old, new.clip(old[0], old[-1])).T


def _half_angles(profiles: ToothProfiles, radius: Floats, z: Floats) -> Floats:
    """Worn half angles at other radii and heights, (teeth, 2, n_z, n_r); missing ones are nominal."""
    gear = profiles.gear
    less = np.nan_to_num(gear.half_angles(profiles.radius, profiles.z) - profiles.half_angle)
    less = _linear(z, profiles.z).T @ (less @ _linear(radius, profiles.radius))
    return np.asarray(gear.half_angles(radius, z) - less, dtype=np.float64)


def _flank_values(arrays: ReportArrays, values: Floats, radius: Floats, z: Floats) -> Floats:
    """Map values between the cells, (teeth, 2, n_z, n_r); nan where most of what is around was not seen."""
    roll = np.sqrt(np.maximum(radius**2 - arrays.gear.base_radius**2, 0.0))
    columns, rows = _linear(roll, arrays.roll_mm), _linear(z, arrays.z_mm).T
    seen = np.isfinite(values)
    weight = rows @ (seen.astype(np.float64) @ columns)
    total = rows @ (np.where(seen, values, 0.0) @ columns)
    return np.where(weight >= 0.5, total / np.maximum(weight, 0.5), np.nan)


def _fillet_colours(arrays: ReportArrays, sign: int, radius: Floats, z: Floats) -> Floats:
    points = arrays.elsewhere
    if points is None:
        return np.full((arrays.gear.teeth, len(z), len(radius)), np.nan)
    points = points.take((points.surface == FILLET) & (points.side == sign))
    way = arrays.gear.orientation
    column = np.asarray(np.searchsorted(way * 0.5 * (radius[1:] + radius[:-1]), way * np.hypot(*points.position[:, :2].T)))
    return _means(arrays.gear, points, column, len(radius), z)


def _land_colours(arrays: ReportArrays, surface: int, angle: Floats, z: Floats) -> Floats:
    """Means of deviation at the columns of the tip or root lands, whose nominal angles are (nearly) `angle`."""
    points, gear = arrays.elsewhere, arrays.gear
    if points is None:
        return np.full((gear.teeth, len(z), angle.shape[-1]), np.nan)
    points = points.take(points.surface == surface)
    middle = 0.5 if surface == ROOT else 0.0  # a root land belongs to the space that follows its tooth
    turn = section_angle(gear, *points.position.T) / gear.pitch_angle - middle
    tooth = np.rint(turn)
    half = gear.tip_half_angle if surface == TIP else gear.root_half_angle
    place = 0.5 + 0.5 * (turn - tooth) * gear.pitch_angle / half
    column = np.clip(np.rint(place * (angle.shape[-1] - 1)), 0, angle.shape[-1] - 1).astype(int)
    return _means(gear, points, column, angle.shape[-1], z, tooth.astype(int) % gear.teeth)


def _means(gear: Gear, points: SurfacePoints, column: Ints, columns: int, z: Floats, tooth: Ints | None = None) -> Floats:
    """Mean deviation in µm, (teeth, n_z, columns); nan where no point fell."""
    # Rows as tall as leaves some points in each, else a thin scan looks like a torn one.
    rows = int(np.clip(len(points) / (8 * gear.teeth * columns), 1, len(z)))
    height = gear.face_width / rows
    row = np.clip(points.position[:, 2] // height, 0, rows - 1).astype(int)
    cell = ((points.tooth if tooth is None else tooth) * rows + row) * columns + column
    size = gear.teeth * rows * columns
    count = np.bincount(cell, minlength=size)
    total = np.bincount(cell, 1e3 * points.deviation, size)
    means = np.where(count > 0, total / np.maximum(count, 1), np.nan).reshape(gear.teeth, rows, columns)
    return means[:, np.clip(z // height, 0, rows - 1).astype(int)]


def _positions(radius: Floats, angle: Floats, z: Floats) -> Floats:
    """(…, n_z, n_r) angles to (n, 3) points."""
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([x, y, np.broadcast_to(z[:, None], x.shape)], axis=-1).reshape(-1, 3)


def _grid(rows: int, columns: int, flip: bool) -> Ints:
    """Faces of one grid of vertices, row-major."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    a, b, c, d = corner, corner + 1, corner + columns + 1, corner + columns
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return faces[:, ::-1] if flip else faces


def _strips(name: str, radius: Floats, angle: Floats, z: Floats, deviation_um: Floats | None, flip: bool) -> SurfaceTriangles:
    """One grid per tooth; `angle` is (teeth, n_z, n)."""
    teeth, rows, columns = angle.shape
    of_tooth = _grid(rows, columns, flip)
    faces = (of_tooth + (np.arange(teeth) * rows * columns)[:, None, None]).reshape(-1, 3)
    tooth = np.repeat(np.arange(1, teeth + 1), rows * columns)
    colours = None if deviation_um is None else deviation_um.ravel()
    return SurfaceTriangles(name, _positions(radius, angle, z), faces, tooth, colours)


def _wall(gear: Gear, name: str, radius: float, z: tuple[float, float], flip: bool) -> SurfaceTriangles:
    """A cylinder about the axis, mm; seen from outside, or from inside where `flip`."""
    angle = np.linspace(0.0, 2.0 * math.pi, 8 * gear.teeth + 1)
    wall = _positions(np.full(len(angle), radius), np.broadcast_to(angle, (2, len(angle))), np.array(z))
    return SurfaceTriangles(name, wall, _grid(2, len(angle), flip), np.ones(len(wall), dtype=int))


def _ends(gear: Gear, radius: Floats, psi: Floats, bottom: Floats, ends: tuple[float, float]) -> SurfaceTriangles:
    """Both end faces: a ladder across every tooth, and rings from the root circle to the bore (or the axis), or to the groove; and the bore."""
    bore = gear.body_radius
    if gear.spec.internal:
        bore = bore or gear.rim_radius
    teeth, columns = gear.teeth, len(radius)
    centre = np.arange(teeth)[:, None] * gear.pitch_angle
    vertices: list[Floats] = []
    faces: list[Ints] = []
    tooth: list[Ints] = []
    count = 0
    for end, z in enumerate(ends):
        inner = gear.groove_radius if 0.0 < z < gear.face_width else max(bore, 1e-3 * gear.root_radius)
        sides = np.stack([centre + psi[:, 0, end], centre - psi[:, 1, end]], axis=1)  # (teeth, 2, columns)
        ladder = _positions(radius, sides.reshape(1, -1, columns).reshape(-1, columns), np.full(2 * teeth, z))
        of_tooth = _grid(2, columns, flip=end == 1)
        faces.append((of_tooth + (np.arange(teeth) * 2 * columns)[:, None, None]).reshape(-1, 3) + count)
        vertices.append(ladder)
        tooth.append(np.repeat(np.arange(1, teeth + 1), 2 * columns))
        count += len(ladder)
        # Under a tooth the ring's rim follows the chord on which the ladder stands.
        half = 0.5 * (psi[:, 1, end, :1] + psi[:, 0, end, :1])
        share = np.linspace(-1.0, 1.0, 5)[:-1]
        across = centre + 0.5 * (psi[:, 0, end, :1] - psi[:, 1, end, :1]) + half * share
        around = np.concatenate([across, bottom[:, end, :-1]], axis=1).ravel()
        around = np.append(around, around[0] + 2.0 * math.pi)
        rim = gear.root_radius * np.concatenate([np.cos(half) / np.cos(half * share), np.ones_like(bottom[:, end, :-1])], axis=1)
        rim = np.append(rim.ravel(), rim[0, 0])
        inward = rim + (inner - rim) * np.linspace(0.0, 1.0, RINGS)[:, None]
        ring = _positions(inward, np.broadcast_to(around, inward.shape), np.full(RINGS, z))
        faces.append(_grid(RINGS, len(around), flip=end == 0) + count)
        vertices.append(ring)
        owner = np.repeat(np.arange(1, teeth + 1), len(share) + bottom.shape[2] - 1)
        tooth.append(np.tile(np.append(owner, 1), RINGS))
        count += len(ring)
    if bore > 0.0:
        wall = _wall(gear, "bore", bore, (0.0, gear.face_width), flip=True)
        faces.append(wall.faces + count)
        vertices.append(wall.vertices)
        tooth.append(wall.tooth)
    return SurfaceTriangles("end face", np.concatenate(vertices), np.concatenate(faces), np.concatenate(tooth))


def _shell(quads: Bools, flip: bool) -> Ints:
    """Faces of a closed body over the chosen quads of a grid: outer sheet, inner sheet (vertices after it), walls."""
    rows, columns = quads.shape[0] + 1, quads.shape[1] + 1
    size = rows * columns
    row, column = np.nonzero(quads)
    a = row * columns + column
    b, c, d = a + 1, a + columns + 1, a + columns
    outer = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    walls = []
    padded = np.pad(quads, 1)
    middle = padded[1:-1, 1:-1]
    for first, second, beyond in (
        (a, b, padded[:-2, 1:-1]), (b, c, padded[1:-1, 2:]), (c, d, padded[2:, 1:-1]), (d, a, padded[1:-1, :-2]),
    ):  # fmt: skip
        edge = (~beyond)[middle]
        p, q = first[edge], second[edge]
        walls += [np.stack([q, p, p + size], 1), np.stack([q, p + size, q + size], 1)]
    faces = np.concatenate([outer, outer[:, ::-1] + size, *walls])
    return faces if flip else faces[:, ::-1]


def _used(vertices: Floats, faces: Ints, tooth: Ints) -> tuple[Floats, Ints, Ints]:
    """Only the vertices that a face uses."""
    used, index = np.unique(faces, return_inverse=True)
    return vertices[used], index.reshape(-1, 3), tooth[used]
