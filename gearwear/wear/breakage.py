"""What is broken off: fracture surfaces inside a tooth, the metal beyond them, and teeth that nobody saw.

A point well inside the nominal tooth that lies near the middle of its thickness, or on a hollow too deep for its width, is no worn flank: a
crack went through there. Points that hang together with it are the fracture surface. A place of the nominal tooth is gone where it
lies on the outer side of the nearest part of the fracture and nothing that is left is much nearer; the volume is the share of places all over the tooth.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.card import measured
from gearwear.design.gear import Gear
from gearwear.design.quantity import teeth_words
from gearwear.design.side import Side
from gearwear.design.surface import flank_points
from gearwear.design.twist import Segment, from_end, section_angle, twisted, wrapped_angle
from gearwear.placing.cells import CellGrid
from gearwear.placing.side_maps import rim
from gearwear.wear.inside_tooth import above_circle, depth_inside, half_angle_at, in_section, perhaps_inside

INSIDE = 0.03
"""Depth, in modules, below every nominal surface from which a point may lie on a fracture."""
CLEAR_OF_FACES = 0.1
"""Distance from tip, root and ends, in modules, within which a point says nothing of the middle of a tooth."""
MIDDLE = 0.25
"""Share of half the thickness within which a point is in the middle of the tooth."""
FEWEST = 8
"""Points of a fracture."""
STEEP = 0.3
"""Depth of a hollow, in its lesser extent, from which it is no wear."""
REACH = 3.0
"""Distance, in the typical one of neighbours, over which points of a fracture hang together."""
NEARER = 2.0
"""How much farther than the nearest point of what is left a fracture may be for its outer side to be gone."""
HOLLOW, FEW = 0.15, 30
"""Standard deviation of the volume of a small hollow in itself: its walls are steep, and of few points (10 simulated breakages, 4 of them chips); of a
corner that so many points show, of more of them less."""
FAR = 0.5
"""Modules from a fracture from which on it counts as plane."""
PLACES = 60_000
"""Places in a tooth that are asked whether they are gone."""
RINGS = 400
"""Rings of equal area over which the volume of a tooth is summed; numerical."""
SHARES = 1.0 / 1.2207440846057596 ** np.arange(1, 4)
"""Powers of the root of x⁴ = x + 1."""
NEIGHBOURS = 10
"""Points that say which way a fracture faces."""
MISSING_TOOTH, NOT_SEEN = "missing tooth", "not seen"
MISSING = 0.5
"""Share of a tooth above the form circle from which on the tooth is missing."""
UNSEEN = 0.05
"""Cells seen of a tooth's flanks, as a share of those of a tooth that is seen well, below which it was not seen."""
SEEN_WELL = 0.9
"""Quantile of the teeth that tells how much of one is seen where it is seen well: a scan may show a third of the gear."""
SPARSEST = 0.1
"""Density of a fracture's points in that of the tooth's: a scanner sees it at a slant, or partly."""
EITHER_SIDE = 0.05
"""Share of a fracture's points that lie in the middle of the tooth on either side of it; the few of a worn flank are its noise."""
DEEP, OTHERS = 0.95, 2.0
"""Quantile of the depths of a fracture; it must be so many times that of the same place on typical teeth."""
MOST_TEETH = 0.5
"""Share of the teeth above which what looks like fractures is another gear than the design."""


@dataclass(frozen=True, slots=True)
class Broken:
    """A piece that is gone, or a tooth that was not seen.

    Parameters
    ----------
    tooth : int
        0-based.
    kind : str
        "missing tooth", "broken corner", "chipped edge" or "not seen".
    side : Side or None
        The flank that lost more; None: both, the whole tooth.
    volume, std : float
        mm³; NaN where the tooth was not seen.
    points : (n, 3) float
        Of the fracture surface, in the design frame, mm.
    flank_gone : (2, rows, columns) bool
        Cells of the tooth's flanks, left first, that are not there any more or were not seen.
    """

    tooth: int
    kind: str
    side: Side | None
    volume: float
    std: float
    points: Floats
    flank_gone: Bools

    @property
    def sentence(self) -> str:
        """What is to be said of it."""
        number = self.tooth + 1
        if not self.seen:
            return f"tooth {number} was not seen"
        size = measured(self.volume, self.std, "mm³")
        if self.kind == MISSING_TOOTH:
            return f"tooth {number} is missing: {size} are broken off, and it carries nothing in contact"
        where = "" if self.side is None else f" on its {self.side} flank"
        return f"tooth {number} has a {self.kind}{where}: {size} are broken off, which is not in the wear"

    @property
    def seen(self) -> bool:
        """Whether a fracture was seen, not only no tooth."""
        return self.kind != NOT_SEEN

    @property
    def whole(self) -> bool:
        """Whether the tooth is missing, or was not seen at all."""
        return self.kind in (MISSING_TOOTH, NOT_SEEN)

    @property
    def flank(self) -> str:
        """ "left", "right" or "tooth"."""
        return "tooth" if self.side is None else str(self.side)


def broken_sentences(broken: Sequence[Broken]) -> tuple[str, ...]:
    """What is to be said of what is broken off, piece by piece, and of the teeth that were not seen, in one."""
    said = [piece.sentence for piece in broken if piece.seen]
    unseen = [piece.tooth + 1 for piece in broken if not piece.seen]
    if unseen:
        were, their, they = ("was", "its", "it counts") if len(unseen) == 1 else ("were", "their", "they count")
        said.append(f"{teeth_words(unseen)} {were} not seen: nothing is said of {their} wear, and in contact {they} as designed")
    return tuple(said)


def _depth_of_tooth(points: Floats, gear: Gear) -> tuple[Floats, Floats]:
    """Depth and place across of `depth_inside`; −1 mm below the flanks where the metal there is a guess."""
    _, depth, across = depth_inside(points, gear)
    if not gear.root_stated:
        depth = np.where(above_circle(gear, np.hypot(points[:, 0], points[:, 1]), gear.form_radius) > 0.0, depth, -1.0)
    return depth, across


def _foot(gear: Gear) -> float:
    """Radius at which a tooth begins to stand on its root, mm: just above the root circle, where its half angle is one."""
    return gear.root_radius * (1.0 + 1e-7 * gear.orientation)


def _from_middle(gear: Gear, tooth: int, points: Floats) -> Floats:
    """Angle of points, in their sections, from the middle of a tooth, rad."""
    return wrapped_angle(section_angle(gear, *points.T) - tooth * gear.pitch_angle)


def find_fractures(points: Floats, gear: Gear, planar: bool = False) -> list[tuple[int, Ints]]:
    """Fracture surfaces among measured points.

    Parameters
    ----------
    points : (n, 3) float
        The registered scan, in the design frame, mm.
    gear : Gear
    planar : bool
        A planar section shows none.

    Returns
    -------
    list of (int, (k,) int)
        Tooth and the indices of its fracture's points.
    """
    if planar:
        return []
    m = gear.transverse_module
    tooth, perhaps = perhaps_inside(points, gear, INSIDE * m)
    depth, across = _depth_of_tooth(points[perhaps], gear)
    inside = depth > INSIDE * m
    deep, depth, across = perhaps[inside], depth[inside], across[inside]
    result: list[tuple[int, Ints]] = []
    for k in np.unique(tooth[deep]):
        on_tooth = np.flatnonzero(tooth[deep] == k)
        if len(on_tooth) < FEWEST:
            continue
        for part in _together(points[deep[on_tooth]], gear):
            which = on_tooth[part]
            index = deep[which]
            if len(index) < FEWEST or not _is_fracture(points[index], depth[which], across[which], gear):
                continue
            if not _is_surface(points[index], points[tooth == k]):  # asked of few: it looks at the whole tooth
                continue
            if float(np.quantile(depth[which], DEEP)) > OTHERS * _usual_depth(index, points, tooth, gear):
                result.append((int(k), index))
    # What every tooth shows is another gear than the design, and no accident.
    return result if len({k for k, _ in result}) <= MOST_TEETH * gear.teeth else []


def _usual_depth(index: Ints, points: Floats, tooth: Ints, gear: Gear) -> float:
    """How deep typical teeth lie where these points of one do, mm: their edges may be rounded off as well. Where few points of each were seen, all
    together tell it; 0 where there are few of these too."""
    place = np.column_stack([points[:, 2], np.hypot(points[:, 0], points[:, 1])])
    low, high = place[index].min(axis=0), place[index].max(axis=0)
    there = np.flatnonzero(np.all((place >= low) & (place <= high), axis=1) & (tooth != tooth[index[0]]))
    depth, its = _depth_of_tooth(points[there], gear)[0], tooth[there]
    others = [float(np.quantile(depth[its == k], DEEP)) for k in np.unique(its) if (its == k).sum() >= FEWEST]
    if len(others) > 2:
        return max(float(np.median(others)), 0.0)
    return max(float(np.quantile(depth, DEEP)), 0.0) if len(depth) >= FEWEST else 0.0


def _together(points: Floats, gear: Gear) -> list[Ints]:
    """Groups of points that hang together."""
    tree = cKDTree(points)
    near = tree.query(points, k=min(4, len(points)))[0][:, -1]
    reach = max(REACH * float(np.median(near)), 0.05 * gear.transverse_module)
    pairs = tree.query_pairs(reach, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    _, label = connected_components(graph, directed=False)
    return [np.flatnonzero(label == group) for group in range(label.max() + 1)]


def _is_fracture(points: Floats, depth: Floats, across: Floats, gear: Gear) -> bool:
    """Whether points go through the middle of a tooth, or round a hollow too deep for its width."""
    m = gear.transverse_module
    # A root land that lies a little high is deep under the fillet that runs out into it.
    up = above_circle(gear, np.hypot(points[:, 0], points[:, 1]), gear.root_radius) > CLEAR_OF_FACES * m
    if up.sum() < FEWEST:
        return False
    points, depth, across = points[up], depth[up], across[up]
    radius = np.hypot(points[:, 0], points[:, 1])
    clear = depth > CLEAR_OF_FACES * m
    # Points in the middle on both sides of it: a flank worn past the middle lies on one.
    middle = clear & (np.abs(across) < MIDDLE)
    fewest = max(FEWEST // 2, EITHER_SIDE * len(points))
    if (middle & (across > 0.0)).sum() >= fewest and (middle & (across < 0.0)).sum() >= fewest:
        return True
    extent = min(float(np.ptp(points[:, 2])), float(np.ptp(radius)))
    sized = float(np.quantile(depth, DEEP))
    below_tip, from_face = -above_circle(gear, radius, gear.tip_radius), from_end(gear, points[:, 2])
    on_edge = min(float(below_tip.min()), float(from_face.min())) < (2.0 * INSIDE + CLEAR_OF_FACES) * m
    return bool(on_edge and sized > CLEAR_OF_FACES * 0.5 * m and sized > STEEP * extent)


def _is_surface(points: Floats, around: Floats) -> bool:
    """Whether points lie as dense as a surface does that was scanned with those `around`, and not as strays in the space of a tooth.

    The third neighbour of points at ρ to an area lies at ``√(3 / πρ)``; an even rectangle has an area of 12 of its two standard deviations.
    """
    near = cKDTree(around).query(around, k=min(4, len(around)))[0][:, -1]
    density = 3.0 / (math.pi * max(float(np.median(near)), 1e-9) ** 2)
    spread = np.sqrt(np.maximum(np.linalg.eigvalsh(np.cov(points.T)), 0.0))
    return len(points) > SPARSEST * density * 12.0 * float(spread[1] * spread[2])


def with_borders(points: Floats, fractures: list[tuple[int, Ints]], gear: Gear, noise: float) -> Bools:
    """(n,) points of fractures and those at their borders that lie below the nominal surface too: no measurement of wear."""
    result = _beside(points, tuple((tooth, points[index]) for tooth, index in fractures), gear, noise)
    for _, index in fractures:
        result[index] = True
    return result


def _beside(points: Floats, fractures: Sequence[tuple[int, Floats]], gear: Gear, noise: float) -> Bools:
    """(n,) points below the nominal surface next to one of the fractures, each a tooth and its points."""
    result = np.zeros(len(points), dtype=bool)
    if not fractures:
        return result
    tooth, depth, _ = depth_inside(points, gear)
    for k, surface in fractures:
        near = np.flatnonzero((tooth == k) & (depth > 6.0 * noise) & ~result)
        if len(near):
            away = cKDTree(surface).query(points[near])[0]
            result[near[away < CLEAR_OF_FACES * gear.transverse_module]] = True
    return result


@dataclass(frozen=True, slots=True)
class Borders:
    """Where the fractures of a scan are, as points of a sample of it show.

    Parameters
    ----------
    grid : CellGrid
    noise : float
        Scatter of points, mm.
    fractures : tuple of (int, (k, 3) float)
        Tooth and points of each fracture, design frame, mm.
    broken : tuple of Broken
        What is broken off.
    """

    grid: CellGrid
    noise: float
    fractures: tuple[tuple[int, Floats], ...]
    broken: tuple[Broken, ...]

    def hold(self, points: Floats) -> Bools:
        """(n,) points of fractures and of their borders, as `with_borders` has it: a fracture's own lie beside those of the sample; and of stumps."""
        return _beside(points, self.fractures, self.grid.gear, self.noise) | on_stumps(points, self.broken, self.grid)


def on_stumps(points: Floats, broken: tuple[Broken, ...], grid: CellGrid) -> Bools:
    """(n,) points from the root on of teeth that are missing: what is left of one is no datum, and neither thin nor worn."""
    result = np.zeros(len(points), dtype=bool)
    missing = [one for one in broken if one.kind == MISSING_TOOTH]
    if not missing:
        return result
    gear = grid.gear
    _, tooth, _ = in_section(points, gear)
    above = above_circle(gear, np.hypot(points[:, 0], points[:, 1]), gear.root_radius) > -CLEAR_OF_FACES * gear.transverse_module
    row: Ints = np.clip(np.searchsorted(grid.z_edges, points[:, 2]) - 1, 0, grid.rows - 1)
    for one in missing:  # of a double helical gear on one half
        rows: Bools = np.asarray(one.flank_gone.all(axis=(0, 2)))
        result |= above & (tooth == one.tooth) & rows[row]
    return result


def flanks_gone(broken: tuple[Broken, ...], grid: CellGrid) -> Bools:
    """Cells of the sides, (teeth, 2, rows, fillet and flank columns), that are broken off, with those beside them, which are so in part; of a missing
    tooth all, its fillets too."""
    flank: Bools = np.zeros((grid.gear.teeth, 2, grid.rows, grid.flank), dtype=np.bool_)
    fillet: Bools = np.zeros((grid.gear.teeth, 2, grid.rows, grid.fillet), dtype=np.bool_)
    for one in broken:
        flank[one.tooth] |= one.flank_gone
        if one.kind == MISSING_TOOTH:
            fillet[one.tooth] |= one.flank_gone.all(axis=2, keepdims=True)
    return np.concatenate([fillet, rim(flank)], axis=3)


def on_whole_teeth(points: Floats, gear: Gear, planar: bool = False) -> Bools:
    """(n,) points that are not on or next to a tooth with a fracture: they say what all teeth share."""
    fractures = find_fractures(points, gear, planar)
    if not fractures:
        return np.ones(len(points), dtype=bool)
    return np.asarray(~np.isin(in_section(points, gear)[1], [k for k, _ in fractures]))


class Fracture:
    """Which places of a tooth, on the stretch of the face that one screw has, are beyond a fracture surface."""

    def __init__(self, surface: Floats, intact: Floats, gear: Gear, tooth: int, stretch: Segment) -> None:
        theta = tooth * gear.pitch_angle
        self.tree = cKDTree(surface)
        near = self.tree.query(surface, k=min(NEIGHBOURS, len(surface)))[1]
        around = surface[near] - surface[near].mean(axis=1, keepdims=True)
        normal = np.linalg.svd(around)[2][:, -1]
        middle = surface[near].mean(axis=1)
        # Outwards: away from the foot of the tooth, and mostly along the radius.
        foot = np.array([gear.root_radius * math.cos(theta), gear.root_radius * math.sin(theta), 0.0])
        core = twisted(gear, foot + middle * [0.0, 0.0, 1.0])
        core[:, 2] = stretch.middle
        way = middle - core
        way[:, 2] *= 0.5
        self.normal = normal * np.where((normal * way).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
        self.middle = middle
        # A rough surface leans to all sides: far off its plane as a whole counts.
        whole = np.linalg.svd(surface - surface.mean(axis=0), full_matrices=False)[2][-1]
        self.whole = whole * (-1.0 if float((self.normal @ whole).sum()) < 0.0 else 1.0)
        self.far = FAR * gear.transverse_module
        self.intact = cKDTree(intact) if len(intact) else None

    def gone(self, places: Floats) -> Bools:
        """(n,) places of the nominal tooth that are not there any more."""
        away, at = self.tree.query(places)
        normal = np.where((away > self.far)[:, None], self.whole, self.normal[at])
        beyond = ((places - self.middle[at]) * normal).sum(axis=1) > 0.0
        if self.intact is None:
            return np.asarray(beyond)
        return np.asarray(beyond & (away <= NEARER * self.intact.query(places)[0]))


def measure_broken(
    points: Floats, cell: Ints, fractures: list[tuple[int, Ints]], border: Bools, grid: CellGrid, noise: float
) -> tuple[Broken, ...]:
    """What is broken off, and teeth that were not seen.

    Parameters
    ----------
    points : (n, 3) float
        The registered scan, in the design frame, mm.
    cell : (n,) int
        Cell of each point; −1: on no surface.
    fractures : list
        From `find_fractures`.
    border : (n,) bool
        From `with_borders`.
    grid : CellGrid
        Of the flanks.
    noise : float
        Scatter of points, mm.
    """
    gear = grid.gear
    result = []
    tooth = in_section(points, gear)[1] if fractures else np.zeros(0, dtype=np.int64)
    flanks = (2, grid.rows, grid.flank)
    for k, (rows, stretch) in product(sorted({number for number, _ in fractures}), grid.zones):
        surface = points[np.concatenate([index for number, index in fractures if number == k])]
        surface = surface[_on(gear, stretch, surface)]
        if len(surface) < FEWEST:
            continue
        places = _places(gear, k, stretch)
        fracture = Fracture(surface, points[(tooth == k) & ~border & _on(gear, stretch, points)], gear, k, stretch)
        gone = fracture.gone(places)
        if gone[above_circle(gear, np.hypot(places[:, 0], places[:, 1]), gear.form_radius) > 0.0].mean() > MISSING:
            fracture.intact = None  # nothing is left beside it
            gone = fracture.gone(places)
        close, box = _places_about(gear, k, stretch, places[gone])
        volume = box * float(fracture.gone(close).mean()) if len(close) else 0.0
        # The surface between its points: where it lies is known as a mean of them, its edge to half their distance.
        spacing = float(np.median(cKDTree(surface).query(surface, k=2)[0][:, 1]))
        area = len(surface) * 4.0 * spacing**2  # of points at random the nearest is half of 1 / sqrt(density) off
        # Of the places, each of a volume of its own, those that the fracture goes through count whole or not at all.
        own = box / max(len(close), 1)
        drawn = 0.5 * own * math.sqrt(area / own ** (2.0 / 3.0))
        edge = 0.5 * spacing * math.sqrt(max(area, 1e-12)) * INSIDE * gear.transverse_module * 4.0
        level = area * (noise + 0.25 * spacing) / math.sqrt(len(surface))
        std = math.sqrt(drawn**2 + edge**2 + level**2 + (0.01 * volume) ** 2)
        flank_gone = fracture.gone(_flank_places(grid, k)).reshape(flanks)
        named = _named(gear, k, stretch, places, gone, surface, volume, std, flank_gone)
        there = np.zeros(flanks, dtype=bool)
        there[:, rows] = named.flank_gone[:, rows]
        result.append(replace(named, flank_gone=there))
    broken = {broken.tooth for broken in result}
    nothing = np.zeros((0, 3))
    seen = np.zeros(grid.count)
    seen[cell[cell >= 0]] = 1.0
    flank = grid.flank_shape(seen).mean(axis=(1, 2, 3))  # by cells: density is uneven, and a fillet is no tooth
    usual = float(np.quantile(flank, SEEN_WELL))
    result += [
        Broken(int(k), NOT_SEEN, None, math.nan, math.nan, nothing, np.zeros(flanks, dtype=bool))
        for k in np.flatnonzero(flank < UNSEEN * usual)
        if int(k) not in broken
    ]
    return tuple(sorted(result, key=lambda broken: broken.tooth))


def _on(gear: Gear, stretch: Segment, points: Floats) -> Bools:
    """(n,) points of a stretch of the face: all of them, or those of a half."""
    middle = 0.5 * gear.face_width
    return np.full(len(points), True) if gear.spec.gap == 0.0 else (points[:, 2] > middle) == (stretch.middle > middle)


def _places(gear: Gear, tooth: int, stretch: Segment) -> Floats:
    """Places in a nominal tooth above the root circle on a stretch of the face, evenly per volume and alike on both flanks and from both ends."""
    above_root = _foot(gear)
    low, high = sorted((gear.root_radius, gear.tip_radius))
    square = np.linspace(low**2, high**2, RINGS + 1)
    half = half_angle_at(gear, np.sqrt(square), above_root)
    area = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(square) * (half[1:] + half[:-1]))])  # both halves: ∫ 2 ψ r dr
    # Multiples of three irrational numbers fill a cube evenly (Roberts 2018).
    up, across, along = (np.arange(PLACES // 2)[:, None] * SHARES % 1.0).T
    radius = np.sqrt(np.interp(up * area[-1], area, square))
    angle, z = across * half_angle_at(gear, radius, above_root), along * (stretch.high - stretch.low)
    radius, angle = np.tile(radius, 2), np.concatenate([angle, -angle]) + tooth * gear.pitch_angle
    z = np.concatenate([stretch.low + z, stretch.high - z])
    return twisted(gear, np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z]))


def _places_about(gear: Gear, tooth: int, stretch: Segment, some: Floats) -> tuple[Floats, float]:
    """Places as `_places` has them, but of the stretch of radii, angles and heights that some of these (n, 3) take up, and one of their distances
    more: a small corner holds too few of all; and the volume that they stand for, mm³."""
    if not len(some):
        return some, 0.0
    middle, foot = tooth * gear.pitch_angle, _foot(gear)
    at = np.column_stack([np.hypot(some[:, 0], some[:, 1]) ** 2, _from_middle(gear, tooth, some), some[:, 2]])
    ends = np.sort([gear.root_radius, gear.tip_radius])
    most = float(gear.half_angle(np.array([foot]))[0])
    least, greatest = np.array([ends[0] ** 2, -most, stretch.low]), np.array([ends[1] ** 2, most, stretch.high])
    apart = (greatest - least) * PLACES ** (-1.0 / 3.0)
    low, high = np.maximum(at.min(axis=0) - apart, least), np.minimum(at.max(axis=0) + apart, greatest)
    share = np.arange(1, PLACES // 2 + 1)[:, None] * SHARES % 1.0
    share = np.concatenate([share, np.abs(share - [0.0, 1.0, 1.0])])  # end for end the same
    square, within, z = (low + share * (high - low)).T
    radius = np.sqrt(square)
    inside = np.abs(within) < half_angle_at(gear, radius, foot)
    x, y = radius * np.cos(within + middle), radius * np.sin(within + middle)
    return twisted(gear, np.column_stack([x, y, z])[inside]), 0.5 * float(np.prod(high - low)) * float(inside.mean())


def _flank_places(grid: CellGrid, tooth: int) -> Floats:
    """Places just under the middles of a tooth's flank cells, left first, then row by row."""
    roll, z = grid.column_middles, grid.row_middles
    half, row, column = (a.ravel() for a in np.indices((2, grid.rows, grid.flank)))
    at = flank_points(grid.gear, np.full(len(half), tooth), np.array(Side)[half], roll[column], z[row])
    return np.asarray(at.position - INSIDE * grid.gear.transverse_module * at.normal, dtype=np.float64)


def without_broken(depth: Floats, broken: tuple[Broken, ...], grid: CellGrid) -> Floats:
    """Depths (…, teeth, 2, rows, columns) with the flanks of what is broken off drawn back to the middle of the tooth: nothing carries there."""
    result, gear = depth.copy(), grid.gear
    radius = np.hypot(gear.base_radius, grid.column_middles)
    middle = gear.normal_lever * gear.half_angle(radius)
    for piece in broken:
        flank = result[..., piece.tooth, :, :, grid.fillet :]
        flank[...] = np.where(piece.flank_gone, middle, flank)
    return result


def _named(
    gear: Gear,
    tooth: int,
    stretch: Segment,
    places: Floats,
    gone: Bools,
    surface: Floats,
    volume: float,
    std: float,
    flank: Bools,
) -> Broken:
    m = gear.transverse_module
    above = above_circle(gear, np.hypot(places[:, 0], places[:, 1]), gear.form_radius) > 0.0
    if gone[above].mean() > MISSING:
        return Broken(tooth, MISSING_TOOTH, None, volume, std, surface, np.ones_like(flank))  # a stump carries nothing
    to_ends = (float(surface[:, 2].min()) - stretch.low, stretch.high - float(surface[:, 2].max()))
    # The flank that lost more, where the other lost little.
    angle = _from_middle(gear, tooth, places)
    left, right = float((gone & (angle > 0.0)).sum()), float((gone & (angle < 0.0)).sum())
    side = None if min(left, right) > 0.25 * max(left, right) else (Side.LEFT if left > right else Side.RIGHT)
    # From end to end along one flank runs an edge.
    corner = min(to_ends) < 0.15 * m and (side is None or max(to_ends) > 0.15 * m)
    std = math.hypot(std, HOLLOW * volume * (min(math.sqrt(FEW / len(surface)), 1.0) if corner else 1.0))
    return Broken(tooth, "broken corner" if corner else "chipped edge", side, volume, std, surface, flank)
