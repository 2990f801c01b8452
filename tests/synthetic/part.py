"""The part before it is scanned: points of the as-made, worn gear, with normals and labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.synthetic.effects import Feet, as_made
from tests.synthetic.outline import Bools, Floats, Ints, Outline, Surface, involute_angle
from tests.synthetic.recipe import Labels, Recipe
from tests.synthetic.removal import depth_below, is_removed, wear_depth


@dataclass(frozen=True, slots=True)
class PartPoints:
    """Surface points in the design frame."""

    position: Floats  # (n, 3)
    normal: Floats  # (n, 3)
    labels: Labels
    along: Floats  # (n,) arc round the whole gear, x on end faces
    across: Floats  # (n,) z, y on end faces

    def take(self, which: Bools) -> PartPoints:
        return PartPoints(
            self.position[which], self.normal[which], self.labels.take(which), self.along[which], self.across[which]
        )


def part_points(recipe: Recipe, outline: Outline, rng: np.random.Generator) -> PartPoints:
    """Sides of all teeth slice by slice, then end faces and bore."""
    return _joined([_sides(recipe, outline, rng), *_ends(recipe, outline, rng), *_bore(recipe, outline, rng)])


def flanks_with_wear(recipe: Recipe, outline: Outline) -> list[tuple[int, int]]:
    """Flanks with any depth, by a look at a coarse grid."""
    roll = np.linspace(outline.form_roll, outline.tip_roll, 60)[:, None]
    z = np.linspace(0.0, outline.face_width, 61)[None, :]
    return [
        (tooth, side)
        for tooth in range(outline.teeth)
        for side in (1, -1)
        if recipe.wear and wear_depth(recipe.wear, outline, np.array(tooth), np.array(side), roll, z).max() > 0.0
    ]


def _sides(recipe: Recipe, outline: Outline, rng: np.random.Generator) -> PartPoints:
    """Flanks, fillets, tips and bottom lands of all teeth, as made and worn."""
    teeth, slices, rows = outline.teeth, recipe.slices, recipe.points_per_tooth
    regular = recipe.jitter == 0.0
    arc, shift = outline.equal_arcs(rows), np.zeros(slices)
    if not regular:
        shift = recipe.jitter * outline.length / rows * (rng.random(slices) - 0.5)
        arc = (arc[None, :] + shift[:, None]).ravel()
    section = outline.at(arc)

    def tiled(local: NDArray[Any]) -> NDArray[Any]:
        """One tooth's slice (with jitter: all its slices) repeated to the order slice, tooth, point."""
        per_slice = local.reshape((1 if regular else slices, 1, rows, *local.shape[1:]))
        return np.broadcast_to(per_slice, (slices, teeth, rows, *local.shape[1:])).reshape(-1, *local.shape[1:])

    z = np.broadcast_to(((np.arange(slices) + 0.5) / slices)[:, None, None], (slices, teeth, rows)).ravel()
    z = (z + recipe.jitter / slices * (rng.random(len(z)) - 0.5 if recipe.jitter else 0.0)) * outline.face_width
    tooth = np.broadcast_to(np.arange(teeth)[None, :, None], (slices, teeth, rows)).ravel()
    worn = _Profile(
        tiled(section.position), tiled(section.normal), tiled(section.surface), tiled(section.side), tiled(section.roll),
        tooth, z, tiled(arc),
    )  # fmt: skip
    return _made_and_worn(recipe, outline, worn, _beyond(recipe, outline, shift))


@dataclass(frozen=True, slots=True)
class _Profile:
    """Nominal points of tooth sides, in their tooth's frame."""

    position: Floats  # (n, 2)
    normal: Floats  # (n, 2)
    surface: Ints
    side: Ints
    roll: Floats
    tooth: Ints
    z: Floats
    arc: Floats


def _beyond(recipe: Recipe, outline: Outline, shift: Floats) -> _Profile | None:
    """Feet past the ends of worn flanks, on the involute's continuation, where wear of some depth is under them.

    `shift`, (slices,) mm: of each slice's points along the outline, as elsewhere on the flanks; else no point, or one in every slice,
    would lie on a strip narrower than the step.
    """
    step = outline.length / recipe.points_per_tooth
    z = (np.arange(recipe.slices) + 0.5) / recipe.slices * outline.face_width
    parts = []
    for tooth, side in flanks_with_wear(recipe, outline):
        depth = float(depth_below(recipe.wear, outline, tooth, side, np.full(len(z), outline.tip_roll), z).max())
        top = np.arange(1, 1 + int(((outline.tip_roll + depth) ** 2 - outline.tip_roll**2) / (2 * outline.base_radius * step)))
        square = outline.tip_roll**2 + 2.0 * outline.base_radius * (step * (top - 0.5)[:, None] + shift)
        if outline.undercut:
            down = np.arange(1 + int(outline.form_roll**2 / (2.0 * outline.base_radius * step))) + 0.5
            low = outline.form_roll**2 - 2.0 * outline.base_radius * (step * down[:, None] + shift)
            square = np.concatenate([square, low])
        real = square > 0.0
        if real.any():
            grid_roll, grid_z = np.sqrt(square[real]), np.broadcast_to(z, square.shape)[real]
            position, normal = outline.flank(grid_roll)
            mirror = np.array([1.0, side])
            half_tip, *_ = outline.arcs
            arc = side * (half_tip + (outline.tip_roll**2 - grid_roll**2) / (2.0 * outline.base_radius))
            same = np.ones(len(grid_roll), np.int64)
            parts.append(
                _Profile(position * mirror, normal * mirror, Surface.FLANK * same, side * same, grid_roll, tooth * same, grid_z, arc)
            )  # fmt: skip
    if not parts:
        return None
    return _Profile(*(np.concatenate([getattr(p, n) for p in parts]) for n in _Profile.__dataclass_fields__))


def _made_and_worn(recipe: Recipe, outline: Outline, grid: _Profile, beyond: _Profile | None) -> PartPoints:
    extra = np.zeros(len(grid.z), np.bool_)
    if beyond is not None:
        grid = _Profile(*(np.concatenate([getattr(grid, n), getattr(beyond, n)]) for n in _Profile.__dataclass_fields__))
        extra = np.arange(len(grid.z)) >= len(extra)
    on_flank = grid.surface == Surface.FLANK
    turn, shift = np.zeros(len(grid.z)), np.zeros(len(grid.z))
    depth = np.zeros(len(grid.z))
    t, s, roll, z = grid.tooth[on_flank], grid.side[on_flank], grid.roll[on_flank], grid.z[on_flank]
    turn[on_flank], shift[on_flank] = as_made(recipe.effects, outline, Feet(t, s, roll, z))
    depth[on_flank] = wear_depth(recipe.wear, outline, t, s, roll, z)
    turn[~on_flank] = _turn_off_flank(recipe, outline, grid, ~on_flank)

    normal = grid.normal.copy()
    worn = depth > 0.0
    tilt = _worn_tilt(recipe, outline, grid, worn, depth)
    position = grid.position + (shift - depth)[:, None] * normal
    own = grid.roll + shift - depth
    keep = np.ones(len(grid.z), np.bool_)
    keep[on_flank] = (own[on_flank] <= outline.tip_roll + 1e-9) & (own[on_flank] >= 0.0)
    inside = (depth - shift)[on_flank] >= outline.undercut_depth(np.maximum(own[on_flank], 0.0))
    keep[on_flank] &= ~extra[on_flank] | inside
    if outline.undercut:  # a worn point must not lie outside the fillet
        keep[on_flank] &= inside | (own[on_flank] >= outline.form_roll) | ~worn[on_flank]
    keep[extra] &= worn[extra]
    _check_other_side(outline, position[worn], grid.side[worn])
    keep &= ~_lost_with_wear(recipe, outline, grid.position, grid.side, grid.tooth, grid.z, on_flank)

    angle = grid.tooth * outline.pitch_angle + turn
    cos, sin = np.cos(angle), np.sin(angle)
    n3 = np.column_stack([normal, np.zeros(len(normal))])
    n3[worn] = tilt
    turned = [np.column_stack([v[:, 0] * cos - v[:, 1] * sin, v[:, 0] * sin + v[:, 1] * cos]) for v in (position, n3)]
    deviation = np.where(on_flank, shift - depth + outline.base_radius * grid.side * turn, np.nan)
    labels = Labels(grid.surface, grid.tooth, grid.side, grid.roll, grid.z, depth, deviation, np.zeros(len(grid.z), np.bool_))
    along = grid.tooth * outline.length + grid.arc + 0.5 * outline.length
    points = PartPoints(np.column_stack([turned[0], grid.z]), np.column_stack([turned[1], n3[:, 2]]), labels, along, grid.z)
    return points.take(keep)


def _turn_off_flank(recipe: Recipe, outline: Outline, grid: _Profile, which: Bools) -> Floats:
    """Turn of fillets (with their flank), tip lands (between their edges) and bottom lands (fading to the space's middle)."""
    tooth, side, z = grid.tooth[which], grid.side[which], grid.z[which]
    surface, arc = grid.surface[which], np.abs(grid.arc[which])
    at_edge = np.full(len(z), outline.form_roll)
    turn, _ = as_made(recipe.effects, outline, Feet(tooth, side, at_edge, z))
    half_tip, *_, root = outline.arcs
    land = surface == Surface.ROOT
    turn = np.where(land, turn * (0.5 * outline.length - arc) / root, turn) * recipe.fillets_follow
    tip = surface == Surface.TIP
    edges = []
    for s in (-1, 1):
        feet = Feet(tooth[tip], np.full(int(tip.sum()), s), np.full(int(tip.sum()), outline.tip_roll), z[tip])
        edge_turn, edge_shift = as_made(recipe.effects, outline, feet)
        edges.append(edge_turn + s * edge_shift / outline.base_radius)
    share = side[tip] * arc[tip] / half_tip
    turn[tip] = 0.5 * (1.0 - share) * edges[0] + 0.5 * (1.0 + share) * edges[1]
    return turn


def _worn_tilt(recipe: Recipe, outline: Outline, grid: _Profile, worn: Bools, depth: Floats) -> Floats:
    """Normals of the worn surface in the tooth frame, (k, 3): n + d_L r_b / (L − d) T + d_z z."""
    t, s, roll, z = grid.tooth[worn], grid.side[worn], grid.roll[worn], grid.z[worn]
    eps = 1e-4
    along = wear_depth(recipe.wear, outline, t, s, roll + eps, z) - wear_depth(recipe.wear, outline, t, s, roll - eps, z)
    up = wear_depth(recipe.wear, outline, t, s, roll, z + eps) - wear_depth(recipe.wear, outline, t, s, roll, z - eps)
    # beside a sharp step the difference is not a slope
    along, up = (np.where(np.abs(x) < 2.0 * eps * 2.0, x, 0.0) / (2.0 * eps) for x in (along, up))
    n = grid.normal[worn]
    tangent = s[:, None] * np.column_stack([n[:, 1], -n[:, 0]])
    slope = along * outline.base_radius / np.maximum(roll - depth[worn], 1.0)
    tilted = np.column_stack([n + slope[:, None] * tangent, up])
    return np.asarray(tilted / np.linalg.norm(tilted, axis=1, keepdims=True))


def _lost_with_wear(
    recipe: Recipe, outline: Outline, position: Floats, side: Ints, tooth: Ints, z: Floats, on_flank: Bools
) -> Bools:
    """Points off the flanks that stood on metal worn away; position in the tooth frame."""
    gone = np.zeros(len(z), np.bool_)
    if recipe.wear:
        radius = np.hypot(position[:, 0], position[:, 1])
        maybe = np.flatnonzero(~on_flank & (radius >= outline.base_radius))
        own = np.sqrt(np.maximum(radius[maybe] ** 2 - outline.base_radius**2, 0.0))
        half = side[maybe] * np.arctan2(position[maybe, 1], position[maybe, 0])
        h = outline.base_radius * (outline.base_half_angle - involute_angle(own, outline.base_radius) - half)
        for s in (1, -1):  # a deep patch may reach past the middle of the tip land
            h_s = np.where(side[maybe] == s, h, h + 2.0 * outline.base_radius * half)
            gone[maybe] |= is_removed(recipe.wear, outline, tooth[maybe], np.array(s), own, h_s, z[maybe])
    return gone


def _check_other_side(outline: Outline, position: Floats, side: Ints) -> None:
    half = side * np.arctan2(position[:, 1], position[:, 0])
    if (half <= -outline.half_angle(np.minimum(np.hypot(position[:, 0], position[:, 1]), outline.tip_radius))).any():
        raise ValueError("the wear goes through the tooth")


def _ends(recipe: Recipe, outline: Outline, rng: np.random.Generator) -> list[PartPoints]:
    """End faces: points at random over their area, less what wear has taken."""
    faces = {"both": (0, 1), "upper": (1,), "none": ()}[recipe.ends]
    inner = recipe.end_inner_radius
    if inner is None:
        inner = 0.5 * recipe.gear.bore_diameter or 0.45 * outline.root_radius
    parts = []
    for upper in faces:
        wanted = recipe.end_points // len(faces)
        found = np.empty((0, 2))
        while len(found) < wanted:
            n = 2 * (wanted - len(found)) + 100
            radius = np.sqrt(rng.uniform(inner**2, outline.tip_radius**2, n))
            angle = rng.uniform(-np.pi, np.pi, n)
            local = angle - np.rint(angle / outline.pitch_angle) * outline.pitch_angle
            inside = np.abs(local) <= outline.half_angle(radius)
            found = np.concatenate([found, np.column_stack([radius, angle])[inside]])
        radius, angle = found[:wanted].T
        number = np.rint(angle / outline.pitch_angle).astype(np.int64)
        local = angle - number * outline.pitch_angle
        z = np.full(wanted, upper * outline.face_width)
        tooth = np.mod(number, outline.teeth)
        xy = radius[:, None] * np.column_stack([np.cos(local), np.sin(local)])
        side = np.where(local < 0.0, -1, 1)
        keep = ~_lost_with_wear(recipe, outline, xy, side, tooth, z, np.zeros(wanted, np.bool_))
        position = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])
        normal = np.tile([0.0, 0.0, 2.0 * upper - 1.0], (wanted, 1))
        surface = np.full(wanted, Surface.END_HIGH if upper else Surface.END_LOW)
        parts.append(_plain(position, normal, surface, tooth, position[:, 0], position[:, 1]).take(keep))
    return parts


def _bore(recipe: Recipe, outline: Outline, rng: np.random.Generator) -> list[PartPoints]:
    radius = 0.5 * recipe.gear.bore_diameter
    if radius == 0.0:
        return []
    count = max(round(0.05 * recipe.slices * recipe.points_per_tooth * outline.teeth), 200)
    angle = rng.uniform(-np.pi, np.pi, count)
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    position = np.column_stack([radius * around, rng.uniform(0.0, outline.face_width, count)])
    normal = np.column_stack([-around, np.zeros(count)])
    tooth = np.mod(np.rint(angle / outline.pitch_angle).astype(np.int64), outline.teeth)
    return [_plain(position, normal, np.full(count, Surface.BORE), tooth, radius * angle, position[:, 2])]


def _plain(position: Floats, normal: Floats, surface: Ints, tooth: Ints, along: Floats, across: Floats) -> PartPoints:
    n = len(position)
    nan, zero = np.full(n, np.nan), np.zeros(n)
    labels = Labels(surface, tooth, np.zeros(n, np.int64), nan, position[:, 2], zero, nan, np.zeros(n, np.bool_))
    return PartPoints(position, normal, labels, along, across)


def _joined(parts: Sequence[PartPoints]) -> PartPoints:
    labels = Labels(*(np.concatenate([getattr(p.labels, n) for p in parts]) for n in Labels.__dataclass_fields__))
    return PartPoints(
        np.concatenate([p.position for p in parts]),
        np.concatenate([p.normal for p in parts]),
        labels,
        np.concatenate([p.along for p in parts]),
        np.concatenate([p.across for p in parts]),
    )
