"""Surfaces that a file places, once or many times: what comes out is counted before any of it is made."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.triangles import check_indices

MOST_PLACED = 10_000
"""Times that a file may place something; a scan of one part places it once."""


@dataclass(frozen=True, slots=True)
class Surface:
    """Points of a file and triangles on them, not read yet.

    Parameters
    ----------
    points, triangles : int
        How many there are; triangles at most.
    read : callable
        Gives them: (n, 3) float and (m, 3) int.
    """

    points: int
    triangles: int
    read: Callable[[], tuple[Floats, Ints]]


def assemble(placed: Iterable[tuple[Surface, Floats]], units: str | None = None) -> Contents:
    """All surfaces, each where it is placed.

    Parameters
    ----------
    placed : iterable of (Surface, (4, 4) float)
        A surface and the transformation that acts on its points as columns; a mirror image has its triangles turned round.
    units : str or None
        The unit, where the format states one.

    Returns
    -------
    Contents
        Without triangles if there is none.

    Raises
    ------
    InputError
        If all of it needs more memory than is allowed, or a triangle uses a vertex that is not there.
    """
    placed = list(_counted(placed))
    known: dict[int, tuple[Floats, Ints]] = {}
    points: list[Floats] = [np.empty((0, 3))]
    triangles: list[Ints] = [np.empty((0, 3), np.int64)]
    count = 0
    for surface, place in placed:
        if id(surface) not in known:
            vertices, faces = surface.read()
            known[id(surface)] = vertices, check_indices(faces, len(vertices))
        vertices, faces = known[id(surface)]
        if not np.array_equal(place, np.eye(4)):
            vertices = vertices @ place[:3, :3].T + place[:3, 3]
            if np.linalg.det(place[:3, :3]) < 0.0:  # a mirror image turns its triangles inside out
                faces = faces[:, ::-1]
        points.append(vertices)
        triangles.append(faces + count)
        count += len(vertices)
    every = np.concatenate(triangles)
    return Contents(np.concatenate(points), triangles=every if len(every) else None, units=units)


def _counted(placed: Iterable[tuple[Surface, Floats]]) -> Iterable[tuple[Surface, Floats]]:
    """The same, refused as soon as it becomes too much."""
    points = triangles = 0
    for number, (surface, place) in enumerate(placed, start=1):
        points, triangles = points + surface.points, triangles + surface.triangles
        check_memory(points, triangles)
        check_placed(number)
        yield surface, place


def check_placed(number: int) -> None:
    """Refuse a file that places more than any scan does."""
    if number > MOST_PLACED:
        raise InputError(
            f"places its surfaces more than {MOST_PLACED:,} times: the scan of one part, placed once, would be right"
        )
