"""Closed triangles of a gear from its tooth profiles, and the boolean that leaves the worn volume. Only importer of manifold3d."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.twist import segments, turn_at
from gearwear.errors import InputError

TIP_STEPS = 9
ROOT_STEPS = 2
"""Straight steps across half a tip land and half a bottom land; the same on both solids, so they cancel."""
SLIVER_VOLUME = 1e-4
"""mm³; less is rounding."""
FEWEST_IN_STRIPS = 4
"""Points of an outline side by side from which on strips between them are fewer triangles."""
FILM_THICKNESS, MAX_LAYERS = 1e-4, 20
"""mm taken off where missing metal would touch itself, 25 times what single precision resolves; how often that is looked for."""


@dataclass(frozen=True, slots=True)
class Triangles:
    """A triangulated surface.

    Parameters
    ----------
    vertices : (n, 3) float
        mm.
    faces : (m, 3) int
        Counter-clockwise seen from outside.
    """

    vertices: Floats
    faces: Ints

    @property
    def volume(self) -> float:
        """Enclosed volume in mm³ by the divergence theorem; about the first vertex, to keep digits."""
        corner = self.vertices[self.faces] - self.vertices[0]
        return float(np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6.0)

    @property
    def area(self) -> float:
        """mm²."""
        return 0.5 * float(np.linalg.norm(self.normals, axis=1).sum())

    @property
    def normals(self) -> Floats:
        """(m, 3) of the faces, twice their area long, mm²."""
        corner = self.vertices[self.faces]
        return np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])


@dataclass(frozen=True, slots=True)
class Solids:
    """The worn gear and what is missing from it, as closed triangles.

    Parameters
    ----------
    worn : Triangles
        The worn gear (bore left out).
    bodies : tuple of Triangles
        The worn volume: closed bodies, largest first.
    """

    worn: Triangles
    bodies: tuple[Triangles, ...]

    @property
    def volume(self) -> float:
        """Sum over the bodies, mm³."""
        return sum(body.volume for body in self.bodies)


@dataclass(frozen=True, slots=True)
class PlainBoolean:
    """Nominal minus the user's own watertight triangles, with no decision on what is wear.

    Parameters
    ----------
    removed : float
        mm³, one-sided: scan noise adds to it.
    signed : float
        Difference of the two volumes, mm³, free of that bias.
    pieces : int
        Closed pieces.
    """

    removed: float
    signed: float
    pieces: int


def gear_triangles(profiles: ToothProfiles) -> Triangles:
    """Watertight triangles of a gear.

    Parameters
    ----------
    profiles : ToothProfiles
        Radii must run between root circle and tip; heights from end to end.

    Returns
    -------
    Triangles
        Side walls between the slices, and the two ends. A bore is left out: it is the same on worn and nominal gear. A ring has its rim.
    """
    outline = outlines(profiles)
    slices, around = outline.shape[:2]
    vertices = _stacked(outline, profiles.z)
    groove = _below_groove(profiles)
    walls = _walls(around, np.delete(np.arange(slices - 1), groove))
    cap = _cap(profiles, around)
    top_shift = (slices - 1) * around
    centre = len(vertices)
    if profiles.gear.spec.internal:
        return _with_rim(profiles, Triangles(vertices, walls), cap, outline)
    hub = np.array([[0.0, 0.0, profiles.z[0]], [0.0, 0.0, profiles.z[-1]]])
    low = np.where(cap < 0, centre, cap)[:, ::-1]
    high = np.where(cap < 0, centre + 1, cap + top_shift)
    if not len(groove):
        return Triangles(np.vstack([vertices, hub]), np.vstack([walls, low, high]).astype(np.int64))
    neck = _neck(profiles, cap, outline, int(groove[0]), centre + 2)
    faces = np.vstack([walls, low, high, neck.faces])
    return Triangles(np.vstack([vertices, hub, neck.vertices]), faces.astype(np.int64))


def _stacked(outline: Floats, z: Floats) -> Floats:
    """Outlines (slices, points, 2) at their heights, (slices · points, 3)."""
    heights = np.broadcast_to(z[:, None, None], (*outline.shape[:2], 1))
    return np.concatenate([outline, heights], axis=2).reshape(-1, 3)


def _walls(around: int, slices: Ints) -> Ints:
    """Triangles between outlines of so many points: those of `slices` and of the next, (n, 3)."""
    ring = np.arange(around)
    base = (slices * around)[:, None]
    lower, lower_next = base + ring, base + np.roll(ring, -1)
    return np.stack([
        np.stack([lower, lower_next, lower_next + around], axis=-1),
        np.stack([lower, lower_next + around, lower + around], axis=-1),
    ]).reshape(-1, 3)  # fmt: skip


def _below_groove(profiles: ToothProfiles) -> Ints:
    """Number of the last slice below the groove of a double helical gear, (1,); (0,) of another gear."""
    if profiles.gear.spec.gap == 0.0:
        return np.zeros(0, dtype=np.int64)
    low, _ = segments(profiles.gear)
    return np.flatnonzero(profiles.z <= low.high + 1e-9 * profiles.gear.face_width)[-1:]


def _neck(profiles: ToothProfiles, cap: Ints, outline: Floats, below: int, start: int) -> Triangles:
    """What joins the halves of a double helical gear: the faces that end them at the groove, and its cylinder.

    `cap` as from `_cap`; the cylinder's vertices are numbered from `start`, the others are those of the slice `below` and of the next.
    """
    around = outline.shape[1]
    at_hub = cap[:, 0] < 0
    p, q = cap[at_hub, 1], cap[at_hub, 2]  # round the root circle
    count = len(p)
    circle = [profiles.gear.groove_radius * _unit(outline[slice_, p]) for slice_ in (below, below + 1)]
    vertices = np.vstack([np.column_stack([xy, np.full(count, profiles.z[below + i])]) for i, xy in enumerate(circle)])
    c, c_next = np.arange(count), np.roll(np.arange(count), -1)
    faces = []
    for i in (0, 1):
        corner, first = (below + i) * around, start + i * count
        ring = np.vstack(
            [np.column_stack([first + c, p + corner, q + corner]), np.column_stack([first + c, q + corner, first + c_next])]
        )
        face = np.vstack([cap[~at_hub] + corner, ring])
        faces.append(face if i == 0 else face[:, ::-1])
    lower, upper = start, start + count
    faces.append(np.column_stack([lower + c, lower + c_next, upper + c_next]))
    faces.append(np.column_stack([lower + c, upper + c_next, upper + c]))
    return Triangles(vertices, np.vstack(faces))


def _with_rim(profiles: ToothProfiles, inside: Triangles, cap: Ints, outline: Floats) -> Triangles:
    """A ring: the walls of its teeth, looked at from the axis, both ends as far as the rim, and the rim.

    The rim is where `Gear.rim_radius` has it.
    """
    gear, around, first = profiles.gear, outline.shape[1], len(inside.vertices)
    at_hub = cap[:, 0] < 0
    p, q = cap[at_hub, 1], cap[at_hub, 2]  # round the root circle
    rim = gear.rim_radius
    circle = [np.column_stack([rim * _unit(outline[i, p]), np.full(len(p), profiles.z[i])]) for i in (0, -1)]
    c, c_next = np.arange(len(p)) + first, np.roll(np.arange(len(p)), -1) + first
    top, lift = (len(outline) - 1) * around, len(p)
    faces = [inside.faces[:, ::-1]]
    for shift, rise in ((0, 0), (top, lift)):
        ring = np.vstack(
            [np.column_stack([p + shift, c + rise, c_next + rise]), np.column_stack([p + shift, c_next + rise, q + shift])]
        )
        teeth = cap[~at_hub][:, ::-1] + shift  # from the root inwards
        face = np.vstack([teeth, ring])
        faces.append(face if rise else face[:, ::-1])
    faces += [np.column_stack([c, c_next, c_next + lift]), np.column_stack([c, c_next + lift, c + lift])]
    return Triangles(np.vstack([inside.vertices, *circle]), np.vstack(faces).astype(np.int64))


def _unit(xy: Floats) -> Floats:
    return np.asarray(xy / np.linalg.norm(xy, axis=1, keepdims=True))


def outlines(profiles: ToothProfiles) -> Floats:
    """Outline of the whole gear in every slice, with its tip and bottom lands, (slices, points, 2) mm.

    Counter-clockwise from the root of tooth 0's right side, the same points in each slice; closed, with its first point once.
    """
    gear, upwards = profiles.gear, slice(None, None, profiles.gear.orientation)
    psi = np.moveaxis(profiles.half_angle[..., upwards], 2, 0)  # slices, teeth, side, radius from root to tip
    slices, teeth, _, nodes = psi.shape
    centre = np.arange(teeth)[:, None] * gear.pitch_angle + turn_at(gear, profiles.z)[:, None, None]
    # Counter-clockwise through a tooth: up its right side, over the tip, down its left side, along the root land.
    right = centre - psi[:, :, 1, :]
    left = centre + psi[:, :, 0, ::-1]
    share = np.linspace(0.0, 1.0, 2 * TIP_STEPS + 1)[1:-1]
    # The land keeps its points; a worn corner pushes those that it passes, a film apart.
    film = FILM_THICKNESS / gear.tip_radius * np.arange(1, 2 * TIP_STEPS)
    r = profiles.radius[upwards]
    land = centre + float(gear.half_angle(r[-1])) * (2.0 * share - 1.0)
    tip = np.clip(land, right[..., -1:] + film, left[..., :1] - film[::-1])
    next_root = np.roll(right[..., :1], -1, axis=1) + np.where(np.arange(teeth) == teeth - 1, 2 * np.pi, 0.0)[:, None]
    share = np.linspace(0.0, 1.0, 2 * ROOT_STEPS + 1)[1:-1]
    land = left[..., -1:] + (next_root - left[..., -1:]) * share
    angle = np.concatenate([right, tip, left, land], axis=-1)
    radius = np.concatenate([r, np.full(2 * TIP_STEPS - 1, r[-1]), r[::-1], np.full(2 * ROOT_STEPS - 1, r[0])])
    if gear.flank_end_radius != gear.tip_radius:
        radius[nodes : nodes + 2 * TIP_STEPS - 1] = gear.tip_radius
    xy = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    return np.asarray(xy.reshape(slices, -1, 2), dtype=np.float64)


def on_outline(profiles: ToothProfiles, values: Floats) -> Floats:
    """Values at the nodes of profiles, (teeth, 2, slices, nodes), at the vertices of `gear_triangles`, (n,).

    Along the tip land they go over from one side's to the other's, along the bottom land likewise; on the hub they are 0.
    """
    values = values[..., :: profiles.gear.orientation]
    right, left = np.moveaxis(values[:, 1], 1, 0), np.moveaxis(values[:, 0], 1, 0)[..., ::-1]
    after = np.roll(right[..., :1], -1, axis=1)
    tip = right[..., -1:] + (left[..., :1] - right[..., -1:]) * np.linspace(0.0, 1.0, 2 * TIP_STEPS + 1)[1:-1]
    land = left[..., -1:] + (after - left[..., -1:]) * np.linspace(0.0, 1.0, 2 * ROOT_STEPS + 1)[1:-1]
    around = np.concatenate([right, tip, left, land], axis=-1)
    round_body = 2 * int((_cap(profiles, around.shape[1] * around.shape[2])[:, 0] < 0).sum())
    if profiles.gear.spec.internal:
        return np.concatenate([around.ravel(), np.zeros(round_body)])
    return np.concatenate([around.ravel(), np.zeros(2 + (round_body if len(_below_groove(profiles)) else 0))])


def _cap(profiles: ToothProfiles, around: int) -> Ints:
    """Triangles of an end face as indices into one outline (−1 is the hub), counter-clockwise from +z.

    A tooth is a ladder between equal radii of its two sides (any wear leaves it one), the body a fan from the hub over the root
    circle: both stay free of overlaps whatever was worn off.
    """
    nodes, tip = len(profiles.radius), 2 * TIP_STEPS - 1
    per = around // profiles.gear.teeth
    root = np.array([0, *range(2 * nodes + tip - 1, per), per])  # right root, left root, land, next tooth's right root
    hub = np.column_stack([np.full(len(root) - 1, -1), root[:-1], root[1:]])
    tooth = np.vstack([_tooth_cap(nodes), hub])
    teeth = np.arange(profiles.gear.teeth)[:, None, None] * per
    every = np.where(tooth < 0, -1, np.mod(tooth + teeth, around))
    return np.asarray(every.reshape(-1, 3), dtype=np.int64)


def _tooth_cap(nodes: int) -> Ints:
    """Triangles of the end of a tooth above its root circle as indices into its outline, counter-clockwise from +z."""
    tip, k = 2 * TIP_STEPS - 1, np.arange(nodes - 1)
    right, right_up = k, k + 1
    left = 2 * nodes + tip - 1 - k
    left_up = left - 1
    ladder = np.vstack([np.column_stack([right, right_up, left_up]), np.column_stack([right, left_up, left])])
    top = np.arange(nodes - 1, nodes + tip + 1)  # right tip corner … left tip corner
    fan = np.column_stack([np.full(len(top) - 2, top[-1]), top[:-2], top[1:-1]])
    return np.vstack([ladder, fan])


def _turned(xy: Floats, angle: float) -> Floats:
    """Points (…, 2) turned about the axis, counter-clockwise (rad)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(xy @ np.array([[cos, sin], [-sin, cos]]))


def nominal_like(profiles: ToothProfiles) -> ToothProfiles:
    """The nominal gear on the same nodes."""
    return nominal_profiles(profiles.gear, profiles.radius, profiles.z)


def tooth_triangles(profiles: ToothProfiles, tooth: int, straight: Sequence[slice] = ()) -> Triangles:
    """Watertight triangles of one external tooth, cut off straight from root to root; between the points of its outline in each of `straight`, which
    are the same in all slices, in strips from end to end."""
    outline = tooth_outlines(profiles, tooth)
    slices, around = outline.shape[:2]
    cap = _tooth_cap(len(profiles.radius))
    walls = _walls(around, np.arange(slices - 1))
    column, strips = walls[:, 0] % around, []
    kept = np.ones(len(walls), dtype=np.bool_)
    for run in straight:
        kept &= (column < run.start) | (column > run.stop - 2)
        strips.append(_strips(around, slices, run.start, run.stop - run.start))
    faces = np.vstack([walls[kept], *strips, cap[:, ::-1], cap + (slices - 1) * around])
    used, corner = np.unique(faces, return_inverse=True)
    return Triangles(_stacked(outline, profiles.z)[used], corner.reshape(-1, 3).astype(np.int64))


def tooth_outlines(profiles: ToothProfiles, tooth: int) -> Floats:
    """Outline of one tooth in every slice from its right root over the tip to its left root, (slices, points, 2) mm."""
    one = replace(profiles, half_angle=profiles.half_angle[tooth : tooth + 1])
    return _turned(outlines(one)[:, : 2 * len(profiles.radius) + 2 * TIP_STEPS - 1], tooth * profiles.gear.pitch_angle)


def _runs(points: Bools) -> list[slice]:
    """Runs of `points` (n,) that are long enough for strips."""
    edges = np.flatnonzero(np.diff(points.astype(np.int8), prepend=0, append=0)).reshape(-1, 2)
    return [slice(first, stop) for first, stop in edges.tolist() if stop - first >= FEWEST_IN_STRIPS]


def _strips(around: int, slices: int, first: int, nodes: int) -> Ints:
    """Triangles between the first outline of so many points and the last along `nodes` of them from `first` on, (n, 3); the first and the last node
    have all slices, as what lies beside them."""
    end = (slices - 1) * around
    along = np.arange(slices)[:, None] * around
    low, inner = first + along[:, 0], first + 1
    outer, high = first + nodes - 2, first + nodes - 1 + along[:, 0]
    k = np.arange(inner, outer)
    return np.vstack([
        np.column_stack([low[:-1], np.full(slices - 1, inner), low[1:]]), [[inner, inner + end, low[-1]]],
        np.column_stack([k, k + 1, k + 1 + end]), np.column_stack([k, k + 1 + end, k + end]),
        np.column_stack([np.full(slices - 1, outer), high[:-1], high[1:]]), [[outer, high[-1], outer + end]],
    ])  # fmt: skip


def worn_volume(worn: ToothProfiles, seen: tuple[float, float] = (0.0, 0.0)) -> list[Triangles]:
    """Nominal minus worn gear; as `worn_bodies`, tooth by tooth where what is missing hangs together over no bottom land: a tooth's triangles take a
    small part of the room of a gear's, and of a spur tooth a few strips do where it has lost nothing, or lost something, from end to end."""
    nominal = nominal_like(worn)
    apart = not worn.gear.spec.internal and worn.gear.spec.gap == 0.0
    if not apart or (worn.half_angle[..., 0] != nominal.half_angle[..., 0]).any():
        return worn_bodies(gear_triangles(nominal), gear_triangles(worn), seen)
    bodies = list[Triangles]()
    for tooth in np.flatnonzero((worn.half_angle != nominal.half_angle).any(axis=(1, 2, 3))).tolist():
        same, passed = _from_end_to_end(nominal, worn, tooth)
        as_new, now = (tooth_triangles(profiles, tooth, same) for profiles in (nominal, worn))
        bodies += worn_bodies(tooth_triangles(nominal, tooth, same + passed), _not_touching(as_new, now), seen)
    return sorted(bodies, key=lambda body: -body.volume)


def _from_end_to_end(nominal: ToothProfiles, worn: ToothProfiles, tooth: int) -> tuple[list[slice], list[slice]]:
    """Runs of points of a tooth's outline that are the same in all slices as new: those that lost nothing in any, and those that lost something in all."""
    as_new, now = (tooth_outlines(profiles, tooth) for profiles in (nominal, worn))
    straight, off = (as_new == as_new[:1]).all(axis=(0, 2)), np.abs(now - as_new).max(axis=2)
    return _runs(straight & (off == 0.0).all(axis=0)), _runs(straight & (off >= FILM_THICKNESS).all(axis=0))


def worn_bodies(nominal: Triangles, worn: Triangles, seen: tuple[float, float] = (0.0, 0.0)) -> list[Triangles]:
    """Nominal minus worn: one closed body per connected piece of missing metal, largest first.

    Parameters
    ----------
    nominal, worn : Triangles
        Closed; where nothing is worn they must share their vertices, else rounding leaves slivers.
    seen : (float, float)
        Depth in mm and volume in mm³ from which on wear is seen: a piece by itself that has neither is noise beside the wear, and is left out.
        So are pieces below `SLIVER_VOLUME`, and those thinner than `FILM_THICKNESS` on average, which are left between the chords of the two tip lands.

    Raises
    ------
    InputError
        If a surface is not closed or not finite; manifold3d's own word is in the message.
    """
    if np.array_equal(nominal.faces, worn.faces) and np.array_equal(nominal.vertices, worn.vertices):
        return []  # as new: the boolean would take up to a second to find nothing
    worn = _not_touching(nominal, worn)
    difference = _manifold(nominal, "the nominal gear") - _manifold(worn, "the worn gear")
    _check(difference, "nominal − worn")

    def counts(volume: float, depth: float) -> bool:
        return volume > SLIVER_VOLUME and depth > FILM_THICKNESS and (depth > seen[0] or volume > seen[1])

    pieces = [(body.volume, 2.0 * body.volume / body.area, body) for body in _pieces(_triangles(difference))]
    return [_in_single(body) for volume, depth, body in sorted(pieces, key=lambda piece: -piece[0]) if counts(volume, depth)]


def _not_touching(nominal: Triangles, worn: Triangles) -> Triangles:
    """`worn` with a film taken off along edges where the missing metal would touch itself.

    An unworn edge between worn neighbours has missing metal on both sides and none on it: a closed surface, but once a file has put its
    corners together again four triangles meet there, and readers call it open. Both must share their triangles, else nothing is done.
    """
    faces, count = worn.faces, len(worn.vertices)
    if nominal.faces.shape != faces.shape or not (nominal.faces == faces).all():
        return worn
    start, end, opposite = faces.ravel(), np.roll(faces, -1, axis=1).ravel(), np.roll(faces, -2, axis=1).ravel()
    pair = np.argsort(np.minimum(start, end) * count + np.maximum(start, end), kind="stable").reshape(-1, 2)
    a, b, (c, d) = start[pair[:, 0]], end[pair[:, 0]], opposite[pair].T
    # Less than half a film would be nothing in a file's single precision.
    moved_by = np.abs(worn.vertices - nominal.vertices).max(axis=1, keepdims=True)
    vertices, outward = np.where(moved_by < 0.5 * FILM_THICKNESS, nominal.vertices, worn.vertices), _outward(nominal)
    for _ in range(MAX_LAYERS):
        moved = (vertices != nominal.vertices).any(axis=1)
        pinched = ~moved[a] & ~moved[b] & moved[c] & moved[d]
        if not pinched.any():
            break
        low = np.union1d(a[pinched], b[pinched])
        vertices[low] -= FILM_THICKNESS * outward[low]
    return Triangles(vertices, faces)


def _in_single(body: Triangles) -> Triangles:
    """A body whose vertices stay apart in single precision: in a file the others fall together, and what is left of triangles between them is open."""
    _, first, corner = np.unique(body.vertices.astype(np.float32), axis=0, return_index=True, return_inverse=True)
    if len(first) == len(body.vertices):
        return body
    faces = corner.reshape(-1)[body.faces]
    whole = (faces != np.roll(faces, -1, axis=1)).all(axis=1)
    return Triangles(body.vertices[first], faces[whole])


def _outward(surface: Triangles) -> Floats:
    """(n, 3) unit normals at the vertices, square to the axis: a film must not leave the end faces."""
    normal = surface.normals
    total = np.column_stack([
        np.bincount(surface.faces.ravel(), np.repeat(normal[:, axis], 3), minlength=len(surface.vertices)) for axis in range(2)
    ])  # fmt: skip
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.column_stack([total / np.where(length > 0.0, length, 1.0), np.zeros(len(total))])


def signed_difference(nominal: Triangles, user: Triangles) -> tuple[float, float, int]:
    """The plain boolean with somebody's own watertight triangles.

    Returns
    -------
    removed : float
        Volume of nominal − user in mm³. One-sided: scan noise adds to it wherever the user's surface dips below the
        nominal one, typically many times the wear.
    signed : float
        Volume (nominal) − volume (user), mm³: free of that bias.
    pieces : int
        Closed pieces of the removed volume.
    """
    whole = _manifold(nominal, "the nominal gear")
    scanned = _manifold(user, "the scan's triangles")
    removed = whole - scanned
    _check(removed, "nominal − scan")
    return float(removed.volume()), float(whole.volume() - scanned.volume()), len(_pieces(_triangles(removed)))


def _pieces(surface: Triangles) -> list[Triangles]:
    """Its connected pieces. manifold3d's own `decompose` goes through the whole once a piece: minutes where scan noise makes thousands."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    faces = surface.faces
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    graph = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(len(surface.vertices),) * 2)
    _, label = connected_components(graph, directed=False)
    of_face = label[faces[:, 0]]
    order = np.argsort(of_face, kind="stable")
    pieces = []
    for part in np.split(faces[order], np.flatnonzero(np.diff(of_face[order])) + 1):
        used, corner = np.unique(part, return_inverse=True)
        pieces.append(Triangles(surface.vertices[used], corner.reshape(-1, 3)))
    return pieces if len(faces) else []


def _manifold(triangles: Triangles, name: str) -> Any:
    from manifold3d import Manifold, Mesh64

    # trimesh.boolean would go through float32 here and lose the third digit of a 5 µm layer.
    solid = Manifold(Mesh64(np.ascontiguousarray(triangles.vertices), np.ascontiguousarray(triangles.faces, dtype=np.uint64)))
    _check(solid, name)
    return solid


def _check(solid: Any, name: str) -> None:
    """manifold3d raises nothing: its status must be asked."""
    status = str(solid.status()).rsplit(".", maxsplit=1)[-1]
    if status != "NoError":
        raise InputError(f"{name} is not a closed solid: manifold3d says {status}; watertight triangles without holes are needed")


def _triangles(solid: Any) -> Triangles:
    surface = solid.to_mesh64()
    return Triangles(np.asarray(surface.vert_properties, dtype=np.float64)[:, :3], np.asarray(surface.tri_verts, dtype=np.int64))
