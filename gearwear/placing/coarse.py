"""The first pose, without any starting guess: axis, centre, phase, height.

Each step uses what a gear must have: normals square to the axis or along it, tips on one circle, teeth at equal
angles, faces a face width apart. Several candidates are carried along; the caller's robust fit decides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.twist import drawn_height, has_screw, turn_at
from gearwear.placing.pose import Pose, along_screw

SAMPLE = 20000
MAX_FLANK_COSINE = 0.12
"""|n · axis| below this: a tooth surface (7°)."""
MAX_SIDE_COSINE = 0.25
"""Above this, and above the lean of helical flanks, no normal is of a tooth side for the pattern of teeth."""
LEAST_FACE_COSINE = 0.97
"""Above this: an end face."""
_AT_ONCE = 16
"""Centres that are looked at together: what is worked out of them stays in the cache."""


@dataclass(frozen=True, slots=True)
class Sample:
    """A thinned scan with a unit normal (sign unknown) at every point."""

    points: Floats
    normals: Floats


def take_sample(points: Floats, normals: Floats | None) -> Sample:
    """Thin a scan and give every point a normal from its neighbours; strays are left out.

    Parameters
    ----------
    points : (n, 3) float
        The scan, mm.
    normals : (n, 3) float or None
        Normals of the file, if it has any.
    """
    rng = np.random.default_rng(0)
    pick = rng.choice(len(points), SAMPLE, replace=False) if len(points) > SAMPLE else np.arange(len(points))
    sample = points[pick]
    return among_neighbours(sample, sample, min(11, len(sample)), None if normals is None else normals[pick])


def among_neighbours(picked: Floats, points: Floats, number: int, normals: Floats | None = None) -> Sample:
    """`picked` of the points but for strays, with their own normals or those of the plane through so many neighbours (themselves among them)."""
    from scipy.spatial import cKDTree

    distance, near = cKDTree(points).query(picked, k=number)
    kept = distance[:, -1] < 6.0 * np.median(distance[:, -1])
    if normals is not None:
        return Sample(picked[kept], normals[kept])
    around = points[near[kept]]
    around = around - around.mean(axis=1, keepdims=True)
    return Sample(picked[kept], np.linalg.eigh(np.einsum("nki,nkj->nij", around, around))[1][:, :, 0])


def axis_candidates(sample: Sample) -> list[Floats]:
    """Three directions the gear's axis may have, best first: most normals square to it or along it."""
    rng = np.random.default_rng(0)
    normals = sample.normals
    pairs = rng.integers(0, len(normals), (400, 2))
    crossed = np.cross(normals[pairs[:, 0]], normals[pairs[:, 1]])
    length = np.linalg.norm(crossed, axis=1)
    centred = sample.points - sample.points.mean(axis=0)
    guesses = np.vstack(
        [
            crossed[length > 0.3] / length[length > 0.3, None],
            np.linalg.eigh(normals.T @ normals)[1].T,
            np.linalg.eigh(centred.T @ centred)[1].T,
        ]
    )
    tested = normals[rng.choice(len(normals), min(3000, len(normals)), replace=False)]
    cosine = np.abs(tested @ guesses.T)
    score = ((cosine < MAX_FLANK_COSINE) | (cosine > LEAST_FACE_COSINE)).mean(axis=0)
    axes: list[Floats] = []
    for index in np.argsort(-score):
        if all(abs(float(guesses[index] @ other)) < math.cos(math.radians(10.0)) for other in axes):
            axes.append(_polish_axis(guesses[index], normals))
        if len(axes) == 3:
            break
    return axes


def axis_of_inertia(sample: Sample) -> Floats:
    """The direction about which the points of a whole gear lie alike, whatever their normals say: those of points in lines are of the lines."""
    centred = sample.points - sample.points.mean(axis=0)
    moment, directions = np.linalg.eigh(centred.T @ centred)
    return np.asarray(directions[:, 0 if moment[1] - moment[0] > moment[2] - moment[1] else 2])


def _polish_axis(axis: Floats, normals: Floats) -> Floats:
    """Least squares on the normals that agree with `axis`."""
    for limit in (MAX_FLANK_COSINE, 0.08, 0.05):
        cosine = normals @ axis
        flank, face = normals[np.abs(cosine) < limit], normals[np.abs(cosine) > LEAST_FACE_COSINE]
        if len(flank) < 10:
            break
        axis = np.asarray(np.linalg.eigh(flank.T @ flank - 0.2 * face.T @ face)[1][:, 0])
    return axis


def coarse_poses(sample: Sample, gear: Gear, axes: Sequence[Floats]) -> list[Pose]:
    """Candidate poses for a gear in space, best matched first; never empty.

    Parameters
    ----------
    sample : Sample
        The thinned scan.
    gear : Gear
        The nominal gear.
    axes : sequence of (3,) float
        Directions its axis may have.
    """
    scored: list[tuple[float, Pose]] = []
    steepest = MAX_SIDE_COSINE + abs(gear.base_helix_sine)
    for axis, turn in _upright(axes, gear):
        turned = sample.points @ turn.T
        cosine = np.abs(sample.normals @ axis)
        sides = cosine < steepest if (cosine < steepest).sum() >= 50 else np.ones(len(turned), dtype=bool)
        middle = float(np.median(turned[:, 2]))
        if gear.spec.gap > 0.0:
            middle = 0.5 * float(np.quantile(turned[:, 2], [0.01, 0.99]).sum())  # the groove may hold few points or many
            turns = turn_at(gear, turned[:, 2] - middle + 0.5 * gear.face_width)
        else:
            turns = gear.twist * (turned[:, 2] - middle)
        for score, centre, phase in _planar(turned[:, :2], sides, gear, turns):
            low = _height(turned - np.append(centre, 0.0), cosine > 0.9, gear)
            if has_screw(gear):
                phase += gear.twist * (low + 0.5 * gear.face_width - middle)
            cos, sin = math.cos(-phase), math.sin(-phase)
            spin = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            scored.append((score, Pose(spin @ turn, spin @ -np.array([centre[0], centre[1], low]))))
    scored.sort(key=lambda item: -item[0])
    return [pose for _, pose in scored]


def _upright(axes: Sequence[Floats], gear: Gear) -> list[tuple[Floats, Floats]]:
    """Each axis with the rotation that sets it upright; of a double helical gear, whose hands tell its ends apart, also upside down."""
    ways = [(axis, frame(axis)) for axis in axes]
    return ways if gear.spec.gap == 0.0 else ways + [(axis, np.diag([1.0, -1.0, -1.0]) @ turn) for axis, turn in ways]


def coarse_planar_poses(points: Floats, gear: Gear) -> list[Pose]:
    """Candidate poses of a planar section, best first; it is laid at mid-face, away from the ends."""
    middle = np.array([0.0, 0.0, drawn_height(gear)])
    everything = np.ones(len(points), dtype=bool)
    poses = []
    for _, centre, phase in sorted(_planar(points[:, :2], everything, gear, np.zeros(len(points))), key=lambda item: -item[0]):
        cos, sin = math.cos(-phase), math.sin(-phase)
        spin = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        poses.append(Pose(spin, spin @ -np.array([centre[0], centre[1], 0.0]) + middle))
    return poses


def frame(axis: Floats) -> Floats:
    """Rotation whose third row is `axis`, the other two as near the scan's own x and y as can be."""
    if axis[2] < 0.0:
        axis = -axis
    base = np.eye(3)[int(np.argmin(np.abs(axis[:2])))]
    first = base - (base @ axis) * axis
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    return np.vstack([first, second, axis])


def _height(points: Floats, face: Bools, gear: Gear) -> float:
    """Height of the lower end: from the faces that were seen, else centred on what was seen.

    Of points about the axis those between root and tip circle: a hub, a shaft and a table reach further than the teeth.
    """
    radius, height, face_width = np.hypot(points[:, 0], points[:, 1]), points[:, 2], gear.face_width
    inner, outer = gear.root_radius, gear.tip_radius + 0.2 * gear.transverse_module
    if gear.spec.internal:
        inner, outer = gear.tip_radius - 0.2 * gear.transverse_module, gear.root_radius
    toothed = (radius > inner) & (radius < outer)
    if toothed.sum() >= 50:
        height, face = height[toothed], face[toothed]
    low, high = np.quantile(height, [0.002, 0.998])
    near = 0.1 * face_width
    at_low = face & (height < low + near)
    at_high = face & (height > high - near)
    enough = max(10.0, 0.01 * len(height))
    if at_low.sum() >= enough and (at_low.sum() >= at_high.sum() or high - low < 0.9 * face_width):
        return float(np.median(height[at_low]))
    if at_high.sum() >= enough:
        return float(np.median(height[at_high])) - face_width
    return 0.5 * float(low + high) - 0.5 * face_width


def snap_height(sample: Sample, pose: Pose, gear: Gear) -> Pose:
    """`pose` with its height set by the end faces that were seen: a fit cannot find a face it does not start near."""
    low = _height(pose.apply(sample.points), np.abs(pose.turn(sample.normals)[:, 2]) > 0.9, gear)
    return along_screw(pose, gear, -low)


def _planar(points: Floats, sides: Bools, gear: Gear, turns: Floats) -> list[tuple[float, Floats, float]]:
    """Candidates (score, centre, phase) in the plane of rotation; `turns` is how far each point's own section is turned."""
    inner, outer = sorted((gear.root_radius, gear.tip_radius))
    table_r = np.linspace(inner, outer, 200)
    table_w = np.cos(gear.teeth * gear.half_angle(table_r))
    flank = points[sides]
    candidates = []
    for centre in _centres(flank, gear):
        offset = flank - centre
        r, angle = np.hypot(offset[:, 0], offset[:, 1]), np.arctan2(offset[:, 1], offset[:, 0]) - turns[sides]
        slack = 0.2 * gear.transverse_module
        inside = (r > inner - slack) & (r < outer + slack)
        weight = np.interp(r, table_r, table_w) * inside
        # Matched filter: on its own flank cos z(θ − φ) = cos zψ(r), so this sum is greatest at the right centre and phase.
        moment = np.sum(weight * np.exp(1j * gear.teeth * angle))
        # Of a shaft's points seen from a centre beside it the sum is great too, but they lie in few pitches.
        there = np.bincount((angle[inside] * gear.teeth / (2.0 * math.pi)).astype(np.int64) % gear.teeth, minlength=gear.teeth)
        round_gear = float((there > 0.25 * there.mean()).mean())
        score = abs(moment) / max(float((weight * weight).sum()), 1e-12) * inside.mean() * round_gear
        candidates.append((float(score), centre, float(np.angle(moment)) / gear.teeth))
    candidates.sort(key=lambda item: -item[0])
    return candidates[:3]


def _centres(points: Floats, gear: Gear) -> list[Floats]:
    """Candidate centres: a free circle through the hull, and circles of the tip radius through two hull points."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = points[ConvexHull(points).vertices]
        free = _circle_centre(hull)
        if gear.spec.internal:  # tips are innermost: inverted about a point within them they are outermost
            about = points - free
            inverted = about / np.maximum((about**2).sum(axis=1, keepdims=True), 1e-12)
            hull = points[ConvexHull(inverted).vertices]
            free = _circle_centre(hull)
    except QhullError:
        return [points.mean(axis=0)]

    rng = np.random.default_rng(0)
    pairs = hull[rng.integers(0, len(hull), (300, 2))]
    chord = pairs[:, 1] - pairs[:, 0]
    length = np.hypot(chord[:, 0], chord[:, 1])
    usable = (length > 0.3 * gear.tip_radius) & (length < 1.98 * gear.tip_radius)
    chord, length, middle = chord[usable], length[usable], pairs[usable].mean(axis=1)
    lift = np.sqrt(gear.tip_radius**2 - (0.5 * length) ** 2) / np.maximum(length, 1e-12)
    across = np.column_stack([-chord[:, 1], chord[:, 0]]) * lift[:, None]
    centres = np.vstack([middle + across, middle - across])
    tested = points[rng.choice(len(points), min(1500, len(points)), replace=False)]
    slack = 0.08 * gear.transverse_module
    inner, outer = sorted((gear.root_radius, gear.tip_radius))
    within, at_tip = np.zeros((2, len(centres)))
    for start in range(0, len(centres), _AT_ONCE):
        x, y = (tested[:, axis] - centres[start : start + _AT_ONCE, axis, None] for axis in (0, 1))
        x *= x
        y *= y
        x += y
        radius = np.sqrt(x, out=x)  # five times the pace of hypot
        within[start : start + _AT_ONCE] = ((radius > inner - slack) & (radius < outer + slack)).mean(axis=1)
        radius -= gear.tip_radius
        at_tip[start : start + _AT_ONCE] = (np.abs(radius, out=radius) < slack).mean(axis=1)
    best = np.argsort(-(within + at_tip))[:3] if len(centres) else np.empty(0, dtype=int)
    return [free, *(centres[i] for i in best)]


def _circle_centre(points: Floats) -> Floats:
    """Centre of the circle through points (n, 2), in algebraic least squares."""
    centred = points - points.mean(axis=0)
    design = np.column_stack([2.0 * centred, np.ones(len(points))])
    solution = np.linalg.lstsq(design, (centred**2).sum(axis=1), rcond=None)[0]
    return np.asarray(solution[:2] + points.mean(axis=0))
