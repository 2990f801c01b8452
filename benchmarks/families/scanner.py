"""From a part to the points of a file: density, views, texture, noise, strays, smoothing, thinning, effects of the instrument, pose."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from benchmarks.families.gear import Array, Ints
from benchmarks.families.part import Part
from benchmarks.families.sampling import BORE, BROKEN, END, FLANK, ROOT, TIP, Points, sample
from benchmarks.families.texture import Texture
from benchmarks.families.views import Views, seen

Weight = Callable[[Part, Points], Array]
"""Share of points kept, 0 … 1."""
Shift = Callable[[Part, Array, Array], Array]
"""Where the instrument puts points (n, 3) with normals (n, 3): new points, design frame."""


@dataclass(frozen=True, eq=False)
class Hole:
    """A ball without points, as glare leaves it."""

    centre: tuple[float, float, float]
    radius: float


@dataclass(frozen=True, eq=False)
class ViewError:
    """What is wrong with some views (none named: with all): a small turn (rad) and shift (mm) about the gear's middle, a scale, fringes, an offset.

    An offset (mm) lies on every surface, along its normal, as a coat of its own or another exposure. Fringes are a wave of `amplitude` (mm) along the
    line of sight, `wavelength` mm across it in the direction `across`.
    """

    views: tuple[int, ...]
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    scale: float = 0.0
    amplitude: float = 0.0
    wavelength: float = 1.0
    across: float = 0.0
    phase: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class Scanner:
    """How a part is scanned.

    Parameters
    ----------
    points : int
        In the file, about.
    noise : float
        Of a point seen straight on, mm, along the line of sight; oblique ones scatter up to three times as much.
    texture : Texture or None
    views : Views
    weights : tuple of Weight
        Density and coverage.
    shifts : tuple of Shift
        Effects of the instrument, in the order they act.
    view_errors : tuple of ViewError
    edge : float
        Width of the spot: edges are rounded within half of it, mm.
    strays : float
        Share of points that belong to nothing.
    holes : tuple of Hole
    smoothing : int
        Neighbours each point is averaged over, 0: none.
    thinning : str
        "", "random", "voxel" or "curvature" (fewer points where it is flat).
    left : int
        Points that thinning leaves, about.
    ends : float
        Density on the end faces; 0: not seen.
    files : int
        Into how many files of neighbouring views the points go.
    pose : str
        "any" or "mild".
    """

    points: int = 45_000
    noise: float = 0.006
    texture: Texture | None = None
    views: Views = field(default_factory=Views)
    weights: tuple[Weight, ...] = ()
    shifts: tuple[Shift, ...] = ()
    view_errors: tuple[ViewError, ...] = ()
    edge: float = 0.0
    strays: float = 0.0
    holes: tuple[Hole, ...] = ()
    smoothing: int = 0
    thinning: str = ""
    left: int = 0
    ends: float = 0.35
    files: int = 1
    pose: str = "any"


@dataclass(frozen=True, eq=False)
class Scan:
    """What came out.

    Parameters
    ----------
    files : tuple of (n, 3) float
        Points of each file, in its own frame.
    poses : tuple of (rotation (3, 3), translation (3))
        file = R · design + t, of each.
    surface : (n,) int
        Kind of each point of the files in turn; −1 a stray.
    spread : float
        Standard deviation of noise and texture put in, normal to the surface, on flanks, mm.
    """

    files: tuple[Array, ...]
    poses: tuple[tuple[Array, Array], ...]
    surface: Ints
    spread: float


def scan(part: Part, scanner: Scanner, seed: int) -> Scan:
    """Scan a part; the same seed gives the same points."""
    rng = np.random.default_rng([seed, 1])
    points, view, cosine = _collect(part, scanner, rng)
    ways = scanner.views.directions()
    flank = points.kind == FLANK
    normal, xyz = points.normal, points.xyz.copy()
    height = np.zeros(len(points))
    if scanner.texture is not None:
        height += scanner.texture.at(points.xyz, seed)
    if scanner.edge > 0.0:
        height -= np.clip(0.5 * scanner.edge - points.edge, 0.0, None) ** 2 / (2.0 * scanner.edge)
    xyz += height[:, None] * normal
    for shift in scanner.shifts:
        xyz = shift(part, xyz, normal)
    along = scanner.noise * np.minimum(1.0 / cosine, 3.0) * rng.standard_normal(len(points))
    across = 0.3 * scanner.noise * rng.standard_normal((len(points), 3))
    error = along[:, None] * ways[view] + across
    xyz += error
    spread = float(np.std((error * normal).sum(axis=1)[flank] + height[flank])) if flank.any() else math.nan
    for wrong in scanner.view_errors:
        xyz = _misplace(part, xyz, normal, view, ways, wrong)
    if scanner.smoothing:
        xyz = _smoothed(xyz, normal, scanner.smoothing)
    kind, file = points.kind.copy(), view * scanner.files // len(ways) if scanner.files > 1 else np.zeros(len(view), dtype=int)
    if scanner.files > 1:  # views are counted elevation by elevation; files are sectors
        file = (view % scanner.views.azimuths) * scanner.files // scanner.views.azimuths
    keep = _thinned(part, points, xyz, scanner.thinning, scanner.left, rng)
    xyz, kind, file = xyz[keep], kind[keep], file[keep]
    count = int(scanner.strays * len(xyz))
    stray = rng.choice(len(xyz), count, replace=False)
    far = part.gear.module * np.exp(rng.uniform(math.log(0.02), math.log(1.0), count))
    way = rng.standard_normal((count, 3))
    xyz[stray] += way / np.linalg.norm(way, axis=1)[:, None] * far[:, None]
    kind[stray] = -1
    order = rng.permutation(len(xyz))
    xyz, kind, file = xyz[order], kind[order], file[order]
    parts, poses, kinds = [], [], []
    base = _pose(scanner.pose, part, rng)
    for i in range(scanner.files):
        rotation, translation = base
        if i:
            small = Rotation.from_rotvec(rng.uniform(-0.02, 0.02, 3)).as_matrix()
            rotation, translation = small @ rotation, small @ translation + rng.uniform(-0.5, 0.5, 3)
        parts.append((xyz[file == i] @ rotation.T + translation).astype(np.float32).astype(np.float64))
        poses.append((rotation, translation))
        kinds.append(kind[file == i])
    return Scan(tuple(parts), tuple(poses), np.concatenate(kinds), spread)


def _collect(part: Part, scanner: Scanner, rng: np.random.Generator) -> tuple[Points, Ints, Array]:
    """Points that are seen, until there are enough."""
    got: list[Points] = []
    views: list[Ints] = []
    cosines: list[Array] = []
    total, batch = 0, 2 * scanner.points
    for _ in range(12):
        points = sample(part, batch, rng, scanner.ends)
        share = np.ones(len(points))
        for weight in scanner.weights:
            share = share * weight(part, points)
        for hole in scanner.holes:
            share = share * (np.linalg.norm(points.xyz - np.array(hole.centre), axis=1) > hole.radius)
        points = points.take(rng.random(len(points)) < share)
        kept, view, cosine = seen(part, points, scanner.views, rng)
        got.append(points.take(kept))
        views.append(view)
        cosines.append(cosine)
        total += len(kept)
        if total >= scanner.points:
            break
        batch = int(min(1.3 * batch * (scanner.points - total) / max(len(kept), 1) + 1000, 400_000))
    points, view, cosine = Points.join(got), np.concatenate(views), np.concatenate(cosines)
    chosen = rng.permutation(len(points))[: scanner.points]
    return points.take(chosen), view[chosen], cosine[chosen]


def _misplace(part: Part, xyz: Array, normal: Array, view: Ints, ways: Array, wrong: ViewError) -> Array:
    """Some views off their place."""
    here = np.isin(view, wrong.views) if wrong.views else np.ones(len(xyz), dtype=bool)
    middle = np.array([0.0, 0.0, 0.5 * part.gear.face_width])
    moved = (
        Rotation.from_rotvec(wrong.turn).apply(xyz[here] + wrong.offset * normal[here] - middle) * (1.0 + wrong.scale)
        + middle
        + np.array(wrong.shift)
    )
    if wrong.amplitude:
        sight = ways[view[here]]
        fixed = np.array([math.cos(wrong.across), math.sin(wrong.across), 0.4])
        stripe = np.sin(2.0 * math.pi * (moved @ fixed) / (wrong.wavelength * np.linalg.norm(fixed)) + wrong.phase)
        moved = moved + wrong.amplitude * stripe[:, None] * sight
    result = xyz.copy()
    result[here] = moved
    return result


def _smoothed(xyz: Array, normal: Array, number: int) -> Array:
    """Each point moved along its normal to the mean of its neighbours: errors are shared, edges go round."""
    near = cKDTree(xyz).query(xyz, number)[1]
    facing = (normal[near] * normal[:, None, :]).sum(axis=2) > -0.2  # not across a thin wall
    offset = ((xyz[near] - xyz[:, None, :]) * normal[:, None, :]).sum(axis=2)
    moved: Array = xyz + ((offset * facing).sum(axis=1) / facing.sum(axis=1))[:, None] * normal
    return moved


def _thinned(part: Part, points: Points, xyz: Array, how: str, left: int, rng: np.random.Generator) -> Ints:
    """Indices of the points that are left."""
    if how == "random":
        return np.sort(rng.permutation(len(xyz))[:left])
    if how == "voxel":
        low, high = 1e-3 * part.gear.module, part.gear.module  # edge of the voxels: halved until the number fits
        for _ in range(12):
            edge = math.sqrt(low * high)
            kept = np.unique(np.floor(xyz / edge).astype(np.int64), axis=0, return_index=True)[1].astype(np.int64)
            low, high = (edge, high) if len(kept) > left else (low, edge)
        return kept
    if how == "curvature":
        bent = np.isin(points.kind, (ROOT, BROKEN)) | (points.edge < 0.15 * part.gear.module)
        worth = np.where(bent, 4.0, np.where(np.isin(points.kind, (END, BORE, TIP)), 1.0, 1.6))
        return np.sort(rng.choice(np.arange(len(xyz)), left, replace=False, p=worth / worth.sum()))
    return np.arange(len(xyz))


def _pose(kind: str, part: Part, rng: np.random.Generator) -> tuple[Array, Array]:
    if kind == "mild":
        rotation = Rotation.from_rotvec(rng.uniform(-0.05, 0.05, 3)).as_matrix()
    else:
        rotation = Rotation.from_quat(rng.standard_normal(4)).as_matrix()
    return rotation, rng.uniform(-1.0, 1.0, 3) * part.gear.tip_radius
