"""Where the inner parallels of neighbouring edges meet: at a corner of the metal they cut each other short. numpy only.

At a tangent junction both end on the same normal, until one that is rounder than the depth folds back: the involute next to its base circle.
From then on they cross, as in undercut. At a re-entrant kink, as modifications leave some of a few mrad, the parallels are run on until
they meet; the exact parallel is an arc there, d θ² / 8 off (8e-6 mm at 8 mrad and 1 mm).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from gearwear.arrays import Floats
from gearwear.brep.outline import Arc, Edge, rotation
from gearwear.brep.paths import Path
from gearwear.errors import InputError

SMOOTH = 1e-9
"""Difference of unit normals up to which a junction is tangent."""
SAMPLES = 160
"""Of either parallel where a crossing is looked for; they crowd at the corner."""
SETTLED = 1e-11
"""mm; how well a crossing is met."""
ROUNDS = 40
TOO_NEAR = 1e-9
"""mm; a crossing nearer to where the parallels began to fold is told by the first terms of their series."""
LEAST_KINK, MOST_KINK = 1e-6, 0.3
"""Sine of the bend at a corner: below the one a missing crossing is none to be found, above the other the parallels are not run on."""
STEP = 1e-4
"""Of a parameter, for slopes."""


class Parallels:
    """Inner parallels of the outline of a tooth and the space after it.

    Parameters
    ----------
    edges : sequence of Edge
        As `outline.tooth_edges` gives them.
    teeth : int
        z.
    orientation : int
        ι.
    """

    def __init__(self, edges: tuple[Edge, ...], teeth: int, orientation: int) -> None:
        self.edges, self.orientation = edges, orientation
        self._turn = rotation(2.0 * math.pi / teeth)
        self.spans = lru_cache(maxsize=None)(self._spans)

    def radius(self, index: int, depth: float) -> float:
        """Of the parallel of an arc, mm."""
        shape = self.edges[index].shape
        assert isinstance(shape, Arc)
        return shape.radius - self.orientation * depth

    def _spans(self, depth: float) -> tuple[tuple[float, float], ...]:
        """Parameters between which each path runs at a depth (mm); nan for arcs.

        Raises
        ------
        InputError
            With the name of the edge that is used up.
        """
        count = len(self.edges)
        starts, ends = [math.nan] * count, [math.nan] * count
        for edge in self.edges:
            if edge.name == "rounding" and edge.path is not None and not _same_way(edge.path, np.array([0.0, 1.0]), depth):
                raise UsedUp(edge.name)
        for i in range(count):
            j = (i + 1) % count
            first, second = self.edges[i].path, self.edges[j].path
            if first is not None and second is not None:
                ends[i], starts[j] = _meeting(first, self._next(second) if j == 0 else second, depth, self.orientation)
            elif first is not None:
                ends[i] = 1.0 - _reach(first.reversed(), self.radius(j, depth), depth)
            elif second is not None:
                starts[j] = _reach(second, self.radius(i, depth), depth)
        for edge, start, end in zip(self.edges, starts, ends, strict=True):
            if edge.path is not None and (end <= start or not _same_way(edge.path, np.array([start, end]), depth)):
                raise UsedUp(edge.name)
        return tuple(zip(starts, ends, strict=True))

    def _next(self, path: Path) -> Path:
        """The same of the next tooth."""
        return Path(lambda share: path.points(share) @ self._turn, lambda share: path.normals(share) @ self._turn)

    def fold(self, depth: float) -> float:
        """Least depth below `depth` (mm) at which a tangent junction becomes a crossing; `depth` itself where none does."""
        for i in range(len(self.edges)):
            first, second = self.edges[i].path, self.edges[(i + 1) % len(self.edges)].path
            if first is None or second is None or i + 1 == len(self.edges) or not _smooth(first, second):
                continue
            depth = min(depth, _fold(first.reversed()), _fold(second))
        return depth


class UsedUp(InputError):
    """An edge that no inner parallel is left of; its name is the message."""


def _same_way(path: Path, ends: Floats, depth: float) -> bool:
    """Whether the parallel runs as the path does, and has not folded back."""
    return bool(np.diff(path.points(ends), axis=0)[0] @ np.diff(path.parallel(ends, depth), axis=0)[0] > 0.0)


def _smooth(first: Path, second: Path) -> bool:
    return bool(np.linalg.norm(first.normals(np.array([1.0])) - second.normals(np.array([0.0]))) < SMOOTH)


def _fold(path: Path) -> float:
    """Depth at which the parallel has no speed left where it starts: the radius of curvature there, where the path bends into the metal, mm."""
    around = np.array([-STEP, STEP])
    way, bend = np.diff(path.points(around), axis=0)[0], np.diff(path.normals(around), axis=0)[0]
    turn = float(bend @ bend)
    rate = float(way @ bend) / turn if turn > 0.0 else math.inf
    return rate if rate >= 0.0 else math.inf


def _speeds(path: Path, depth: float, at: float) -> float:
    """Speed of a parallel by the parameter, mm; negative where it is folded back."""
    around = np.array([at - STEP, at + STEP])
    normal = path.normals(np.array([at]))[0]
    way = np.diff(path.parallel(around, depth), axis=0)[0] / (2.0 * STEP)
    along = path.points(np.array([at, at + 0.5]))
    tangent = np.array([-normal[1], normal[0]])
    return float(way @ tangent) * math.copysign(1.0, float((along[1] - along[0]) @ tangent))


def _reach(path: Path, radius: float, depth: float) -> float:
    """Parameter, from 0, at which a path's parallel comes from a circle about the axis."""

    def beyond(share: Floats | float) -> Floats:
        return np.asarray(np.hypot(*path.parallel(np.atleast_1d(np.asarray(share, dtype=np.float64)), depth).T) - radius)

    if abs(beyond(0.0)[0]) < SETTLED + SMOOTH * depth:
        return 0.0
    share = np.linspace(0.0, 1.0, SAMPLES) ** 2
    values = beyond(share)
    changes = np.flatnonzero(values[1:] * values[:-1] <= 0.0)
    if len(changes) == 0:
        raise UsedUp("flank")
    low, high = share[changes[0]], share[changes[0] + 1]
    sign = math.copysign(1.0, values[changes[0]])
    at = 0.5 * (low + high)
    for _ in range(ROUNDS):  # Newton, held between the two
        miss = float(beyond(at)[0])
        if abs(miss) < SETTLED:
            break
        low, high = (at, high) if miss * sign > 0.0 else (low, at)
        slope = float(np.diff(beyond(np.array([at - STEP, at + STEP])))[0]) / (2.0 * STEP)
        new = at - miss / slope if slope != 0.0 else low
        at = new if low < new < high else 0.5 * (low + high)
    return float(at)


def _meeting(first: Path, second: Path, depth: float, orientation: int) -> tuple[float, float]:
    """Parameters at which the parallels of two neighbours meet: (1, 0) at a tangent junction."""
    if depth == 0.0:
        return 1.0, 0.0
    if _smooth(first, second):
        if _fold(second) < depth:
            return _after_fold(first, second, depth)
        if _fold(first.reversed()) < depth:
            last, start = _after_fold(second.reversed(), first.reversed(), depth)
            return 1.0 - start, 1.0 - last
        return 1.0, 0.0
    guess = _crossing(first, second, depth)
    if guess is None:
        first_normal, second_normal = first.normals(np.array([1.0]))[0], second.normals(np.array([0.0]))[0]
        bend = float(first_normal[0] * second_normal[1] - first_normal[1] * second_normal[0])
        if abs(bend) > MOST_KINK or (orientation * bend > 0.0 and abs(bend) > LEAST_KINK):
            raise UsedUp("flank")
        guess = 1.0, 0.0
    return _met(first, second, depth, guess)


def _after_fold(first: Path, second: Path, depth: float) -> tuple[float, float]:
    """Where the parallels cross beyond a tangent junction at which the second one is folded back.

    With the speed linear in the parameter, as of an involute, it turns at u₀ and the crossing lies at 3/2 u₀, whatever the first one's
    curvature: the cubic of the second one's height over the common tangent against the line of the first.
    """
    speed, later = (_speeds(second, depth, at) for at in (0.0, STEP))
    turn = -speed * STEP / (later - speed)
    end, around = np.array([1.0]), np.array([1.0 - STEP, 1.0 + STEP])
    way = np.diff(first.parallel(around, depth), axis=0)[0] / (2.0 * STEP)
    gap = second.parallel(np.array([1.5 * turn]), depth)[0] - first.parallel(end, depth)[0]
    guess = 1.0 + float(gap @ way) / float(way @ way), 1.5 * turn
    if float(np.linalg.norm(gap)) < TOO_NEAR:
        return guess
    for start in (guess, _crossing(first, second, depth)):
        if start is not None:
            met = _met(first, second, depth, start)
            if 1.1 * turn < met[1]:  # at 0 they touch
                return met
    raise UsedUp("flank")


def _met(first: Path, second: Path, depth: float, guess: tuple[float, float]) -> tuple[float, float]:
    """Newton's method on a crossing, as far as it gets nearer."""
    at, best, least = np.array(guess), guess, math.inf
    for _ in range(ROUNDS):
        here = np.array([at[0], at[0] - STEP, at[0] + STEP]), np.array([at[1], at[1] - STEP, at[1] + STEP])
        a, b = first.parallel(here[0], depth), second.parallel(here[1], depth)
        miss = a[0] - b[0]
        off = float(np.linalg.norm(miss))
        if off < least:
            best, least = (float(at[0]), float(at[1])), off
        elif least < SETTLED:
            break
        slopes = np.column_stack([a[2] - a[1], b[1] - b[2]]) / (2.0 * STEP)
        at = at - np.linalg.lstsq(slopes, miss, rcond=None)[0]
    if least > SETTLED:
        raise UsedUp("flank")
    return best


def _crossing(first: Path, second: Path, depth: float) -> tuple[float, float] | None:
    """Where the parallels cross, as sampled; the crossing farthest from the corner, for next to it they may touch."""
    share = np.linspace(0.0, 1.0, SAMPLES) ** 3
    a, b = first.parallel(1.0 - share, depth), second.parallel(share, depth)
    way_a, way_b = np.diff(a, axis=0), np.diff(b, axis=0)
    gap = b[None, :-1] - a[:-1, None]
    cross = way_a[:, None, 0] * way_b[None, :, 1] - way_a[:, None, 1] * way_b[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        along_a = (gap[..., 0] * way_b[None, :, 1] - gap[..., 1] * way_b[None, :, 0]) / cross
        along_b = (gap[..., 0] * way_a[:, None, 1] - gap[..., 1] * way_a[:, None, 0]) / cross
    hit = (along_a >= 0.0) & (along_a <= 1.0) & (along_b >= 0.0) & (along_b <= 1.0)
    if not hit.any():
        return None
    rows, columns = np.nonzero(hit)
    best = int(columns.argmax())
    i, j = int(rows[best]), int(columns[best])
    u = share[i] + along_a[i, j] * (share[i + 1] - share[i])
    v = share[j] + along_b[i, j] * (share[j + 1] - share[j])
    return float(1.0 - u), float(v)
