"""What the peers compare with: the nominal gear as triangles and as points with normals, a worn gear as noisy triangles.

All of it is made outside the clock, from the exact outline that the scan was made from: the chain of peers gets it for nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tests.synthetic import Recipe, Surface
from tests.synthetic.outline import Floats, Ints, Outline
from tests.synthetic.removal import wear_depth

FINE = 140
"""Points round half a tooth: the nominal triangles are then within 0.9 µm of the gear."""
COARSE, SLICES = 29, 75
"""Points round half a tooth, and slices, of the worn gear: 108 000 triangles."""


@dataclass(frozen=True, slots=True)
class Ring:
    """The outline of the whole gear, counter-clockwise, with its corners."""

    position: Floats  # (n, 2) mm
    normal: Floats  # (n, 2)
    surface: Ints  # (n,)
    tooth: Ints  # (n,)
    side: Ints  # (n,)
    roll: Floats  # (n,) mm, nan off the flanks


@dataclass(frozen=True, slots=True)
class Shape:
    """A closed surface."""

    vertices: Floats  # (n, 3) mm
    faces: Ints  # (m, 3) counter-clockwise from outside


def ring(outline: Outline, half: int) -> Ring:
    """Points of the outline, about `half` to half a tooth."""
    ends = np.concatenate([[0.0], np.cumsum(outline.arcs)])
    counts = [max(2, round(half * arc / ends[-1])) for arc in outline.arcs]
    parts = [low + np.arange(n) * (high - low) / n for low, high, n in zip(ends[:-1], ends[1:], counts, strict=True)]
    up = np.concatenate(parts)[1:]
    section = outline.at(np.concatenate([-up[::-1], [0.0], up, [ends[-1] * (1.0 - 1e-15)]]))
    angle = np.arange(outline.teeth) * outline.pitch_angle
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]

    def turned(v: Floats) -> Floats:
        return np.stack([cos * v[:, 0] - sin * v[:, 1], sin * v[:, 0] + cos * v[:, 1]], axis=-1).reshape(-1, 2)

    tiled = [np.tile(values, outline.teeth) for values in (section.surface, section.side, section.roll)]
    tooth = np.repeat(np.arange(outline.teeth), len(section.roll))
    return Ring(turned(section.position), turned(section.normal), tiled[0], tooth, tiled[1], tiled[2])


def between(rings: Sequence[Floats], z: Floats) -> Shape:
    """Walls between outlines of equally many points, and both ends."""
    from manifold3d import triangulate

    n, top = len(rings[0]), (len(rings) - 1) * len(rings[0])
    vertices = np.concatenate([np.column_stack([one, np.full(n, height)]) for one, height in zip(rings, z, strict=True)])
    around, base = np.arange(n), (np.arange(len(rings) - 1) * n)[:, None]
    here, after = base + around, base + np.roll(around, -1)
    walls = [np.stack([here, after, after + n], axis=-1), np.stack([here, after + n, here + n], axis=-1)]
    low, high = np.asarray(triangulate([rings[0]])), np.asarray(triangulate([rings[-1]])) + top
    return Shape(vertices, np.vstack([np.concatenate(walls).reshape(-1, 3), low[:, ::-1], high]))


def nominal(outline: Outline) -> Shape:
    """The nominal gear, finely."""
    position = ring(outline, FINE).position
    return between([position, position], np.array([0.0, outline.face_width]))


def chord_error(outline: Outline) -> float:
    """How far the middles of the edges of `nominal` lie from the gear, mm."""
    from scipy.spatial import cKDTree

    edges, exact = ring(outline, FINE).position, ring(outline, 20 * FINE)
    middle = 0.5 * (edges + np.roll(edges, -1, axis=0))
    near = cKDTree(exact.position).query(middle)[1]
    return float(np.abs(((middle - exact.position[near]) * exact.normal[near]).sum(axis=1)).max())


def target(outline: Outline, points: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Points of the nominal gear as dense as a scan of so many points, with exact normals; (n, 3) each."""
    ends = round(0.04 * points)
    slices = round(np.sqrt((points - 2 * ends) * outline.face_width / (outline.length * outline.teeth)) * 0.6)
    sides = ring(outline, round((points - 2 * ends) / (slices * outline.teeth * 2)))
    z = (np.arange(slices) + 0.5) / slices * outline.face_width
    n = len(sides.position)
    walls = np.column_stack([np.tile(sides.position, (slices, 1)), np.repeat(z, n)])
    normals = np.column_stack([np.tile(sides.normal, (slices, 1)), np.zeros(slices * n)])
    r = np.sqrt(rng.uniform((0.45 * outline.root_radius) ** 2, outline.root_radius**2, 2 * ends))
    angle, upper = rng.uniform(0.0, 2.0 * np.pi, 2 * ends), np.arange(2 * ends) % 2
    faces = np.column_stack([r * np.cos(angle), r * np.sin(angle), upper * outline.face_width])
    up = np.column_stack([np.zeros((2 * ends, 2)), 2.0 * upper - 1.0])
    return np.vstack([walls, faces]), np.vstack([normals, up])


def worn(recipe: Recipe, outline: Outline, rng: np.random.Generator) -> tuple[Shape, Shape]:
    """The nominal gear, and the worn one with the scan's noise left in, as triangles between the same slices.

    A mesh of the scan as good as can be: every vertex lies where a point was measured, none is missing, and they know where they belong.
    """
    around = ring(outline, COARSE)
    z = np.linspace(0.0, outline.face_width, SLICES)
    flank = np.flatnonzero(around.surface == Surface.FLANK)
    rings = []
    for height in z:
        move = 1e-3 * recipe.noise_um * rng.standard_normal(len(around.position))
        at = np.full(len(flank), height)
        move[flank] -= wear_depth(recipe.wear, outline, around.tooth[flank], around.side[flank], around.roll[flank], at)
        rings.append(around.position + move[:, None] * around.normal)
    return between([around.position] * SLICES, z), between(rings, z)
