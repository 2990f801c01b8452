"""What a scan shows of a gear that no design is known of: axis, teeth, tip and root, base circle, thickness, width, bore."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.card import Card, Row
from gearwear.errors import InputError
from gearwear.identify.free_involute import FreeInvolute, fit_involute
from gearwear.identify.ring import TipCircle, ToothCount, count_teeth, innermost, tip_circle
from gearwear.placing.coarse import SAMPLE, Sample, axis_candidates, frame, take_sample
from gearwear.placing.pose import Pose
from gearwear.placing.robust import median_scale

OUT_OF_ROUND = 0.002
"""Oval from which a stretch is taken out before the flanks are fitted, and said."""
LEAST_POINTS = 300
"""Below this nothing is looked for."""
LEAST_SHARE = 0.04
"""Share of the pattern that must repeat for teeth to be counted."""


@dataclass(frozen=True, slots=True, repr=False)
class Survey(Card):
    """A gear as its scan shows it, with no design behind it.

    Parameters
    ----------
    pose : Pose
        Axis on z, lower end at z = 0, a tooth on +x: gear = rotation · scan + translation.
    teeth : int
    tip_radius, root_radius : float
        mm.
    flank : FreeInvolute
        Base circle and thickness; its centre and phase are in the plane of rotation before `pose`.
    face_width : float
        mm; nan for a planar section.
    faces : int
        How many end faces were seen: 0, 1 or 2. Below 2 the face width is the height of what was seen.
    bore_diameter : float
        mm; 0 where none was seen.
    circle : TipCircle
        In the frame of `pose`: centre, radius and oval of the tips; the oval is 0 where it was too small to be taken out.
    share : float
        Share of the angular pattern that repeats from tooth to tooth.
    notes : tuple of str
        What a reader must know, each a sentence.
    """

    pose: Pose
    teeth: int
    tip_radius: float
    root_radius: float
    flank: FreeInvolute
    face_width: float
    faces: int
    bore_diameter: float
    circle: TipCircle
    share: float
    notes: tuple[str, ...]

    def headline(self) -> str:
        return f"{self.teeth} teeth, tip diameter {2 * self.tip_radius:.3f} mm, root diameter {2 * self.root_radius:.3f} mm"

    def rows(self) -> list[Row]:
        rows = [
            ("base pitch", f"{self.base_pitch:.4f} mm"),
            (f"thickness at diameter {2 * self.flank.middle:.2f} mm", f"{self.flank.thickness(self.flank.middle):.4f} mm"),
        ]
        if math.isfinite(self.face_width):
            rows.append(("face width", f"{self.face_width:.3f} mm"))
        if self.bore_diameter:
            rows.append(("bore diameter", f"{self.bore_diameter:.3f} mm"))
        return rows + [("note", note) for note in self.notes]

    @property
    def oval(self) -> float:
        """Stretch of the scan along one direction, relative; taken out before the flanks were fitted."""
        return self.circle.oval

    @property
    def base_pitch(self) -> float:
        """2 π r_b / z, mm."""
        return 2.0 * math.pi * self.flank.base_radius / self.teeth


@dataclass(frozen=True, slots=True)
class _Plane:
    """A scan seen along a candidate axis."""

    turn: Floats
    points: Floats
    sides: Bools
    faces: Bools
    circle: TipCircle
    root: float
    count: ToothCount


def seems(points: Floats, planar: bool) -> str:
    """What a scan that fits no design looks like by itself, for the line that refuses it; "" where no gear is seen in it.

    Parameters
    ----------
    points : (n, 3) float
        The scan, mm.
    planar : bool
        True for a planar section.
    """
    try:
        seen = survey(points, planar=planar)
    except InputError:
        return ""
    return f"; by itself the scan looks like {seen.teeth} teeth and tip diameter {2.0 * seen.tip_radius:.2f} mm"


def survey(points: Floats, normals: Floats | None = None, planar: bool = False) -> Survey:
    """Find a gear in a scan without a design.

    Parameters
    ----------
    points : (n, 3) float
        The scan in its own frame, mm. A planar section lies in x and y.
    normals : (n, 3) float or None
        Of the file, if any.
    planar : bool
        True for a planar section.

    Returns
    -------
    Survey

    Raises
    ------
    InputError
        If no external spur gear is seen in it.
    """
    if len(points) < LEAST_POINTS:
        raise InputError(f"{len(points)} points are too few to find a gear in: at least {LEAST_POINTS} would be right")
    plane = _best_plane(points, normals, planar)
    flat, circle = plane.points[plane.sides, :2], plane.circle
    height = None if planar else plane.points[plane.sides, 2] - float(np.median(plane.points[plane.sides, 2]))
    notes = []
    oval, direction = 0.0, 0.0
    flank = _fit(flat, height, plane)
    if circle.oval > OUT_OF_ROUND:
        # Tips that are nearly points may look oval; a scan that is stretched has better flanks without the stretch.
        straight = circle.rounded(flat)
        again = _count(straight, tip_circle(straight) or circle)
        if again is not None:
            rounded = _Plane(plane.turn, plane.points, plane.sides, plane.faces, *again)
            better = _fit(straight, height, rounded)
            if better is not None and (flank is None or better.scatter < 0.8 * flank.scatter):
                oval, direction = circle.oval, circle.direction
                flat, plane, flank = straight, rounded, better
                notes.append(
                    f"the tips lie on an oval, {100 * oval:.2f} % longer along {math.degrees(direction) % 180:.0f}° than across: taken for the scan's own "
                    "stretch and set aside"
                )
    if flank is None:
        raise InputError(
            f"{plane.count.teeth} teeth were counted, but no involute passes through their flanks: a scan of an external spur gear is needed"
        )
    if flank.worn_side is not None:
        notes.append(
            "the flanks of one side are much rougher than the other's: taken for worn, the shape is that of the better side"
        )
    radius, angle = replace(plane.circle, centre=flank.centre).polar(flat)
    turns = (angle - flank.phase) * (plane.count.teeth / (2.0 * math.pi))
    toothed = radius > plane.root
    number = np.bincount(np.mod(np.rint(turns[toothed]).astype(np.int64), plane.count.teeth), minlength=plane.count.teeth)
    seen = int((number > 0.2 * np.median(number[number > 0])).sum())
    tip, root = _lands(radius, turns - np.rint(turns), flank, plane)
    if seen < plane.count.teeth:
        notes.append(f"{seen} of the {plane.count.teeth} teeth were seen: the tooth count rests on their pitch")
    width, faces, low = math.nan, 0, 0.0
    if not planar:
        width, faces, low = _width(plane)
        if faces < 2:
            notes.append("not both end faces were seen: the face width is the height of what was seen")
    bore = 0.0 if planar else _bore(plane)
    cos, sin = math.cos(-flank.phase), math.sin(-flank.phase)
    spin = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    pose = Pose(spin @ plane.turn, spin @ -np.array([*flank.centre, low]))
    return Survey(
        pose, plane.count.teeth, tip, root, flank, width, faces, bore,
        TipCircle(np.zeros(2), tip, oval, direction - flank.phase), plane.count.share, tuple(notes),
    )  # fmt: skip


def _fit(flat: Floats, height: Floats | None, plane: _Plane) -> FreeInvolute | None:
    """The involute through the flanks seen in a plane."""
    count = plane.count
    return fit_involute(flat, height, plane.circle.centre, count.teeth, count.phase, plane.root, plane.circle.radius)


def _best_plane(points: Floats, normals: Floats | None, planar: bool) -> _Plane:
    """The axis along which the scan repeats most, set straight by the flanks."""
    found: list[_Plane] = []
    if planar:
        pick = np.random.default_rng(0).choice(len(points), min(len(points), SAMPLE), replace=False)
        every = np.ones(len(pick), dtype=bool)
        found = _plane(np.eye(3), points[pick], every, ~every)
    else:
        sample = take_sample(points, normals)
        found = _all_planes(sample)
        if normals is None and len(points) > SAMPLE:
            # The thinned scan is too coarse for the normals of small teeth; near neighbours are too noisy for those of large ones.
            fine = _fine_sample(points)
            others = _all_planes(fine)
            if others and others[0].count.share > 1.2 * (found[0].count.share if found else 0.0):
                sample, found = fine, others
    found = [plane for plane in found if plane.count.share >= LEAST_SHARE]
    if not found:
        raise InputError(
            "no gear is seen in the scan: nothing repeats round an axis; an external spur gear is needed, with the tips of its teeth in the scan"
        )
    best = max(found, key=lambda plane: plane.count.share)
    return best if planar else _straightened(sample, best)


def _all_planes(sample: Sample) -> list[_Plane]:
    """Along every candidate axis, the one that repeats most first."""
    if len(sample.points) < LEAST_POINTS // 2:  # many in one place, the rest alone
        return []
    found = [plane for axis in axis_candidates(sample) for plane in _along(sample, axis)]
    return sorted(found, key=lambda plane: -plane.count.share)


def _fine_sample(points: Floats) -> Sample:
    """As `take_sample`, with the normals from the nearest neighbours in the scan itself (at most 300,000 points)."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(0)
    points = points[rng.choice(len(points), min(len(points), 300_000), replace=False)]
    picked = points[:SAMPLE]
    distance, near = cKDTree(points).query(picked, k=13)
    kept = distance[:, -1] < 6.0 * np.median(distance[:, -1])
    around = points[near[kept]]
    around = around - around.mean(axis=1, keepdims=True)
    return Sample(picked[kept], np.linalg.eigh(np.einsum("nki,nkj->nij", around, around))[1][:, :, 0])


def _straightened(sample: Sample, plane: _Plane) -> _Plane:
    """The plane square to the axis that the flanks lie about; normals alone leave it a few mrad off."""
    for _ in range(3):
        sides = plane.points[plane.sides]
        height = sides[:, 2] - float(np.median(sides[:, 2]))
        count = plane.count
        flank = _fit(sides[:, :2], height, plane)
        if flank is None:
            return plane
        axis = plane.turn.T @ np.array([*flank.lean, 1.0])
        again = _along(sample, axis / np.linalg.norm(axis))
        if not again or again[0].count.teeth != count.teeth:
            return plane
        plane = again[0]
        if np.hypot(*flank.lean) < 1e-5:
            break
    return plane


def _along(sample: Sample, axis: Floats) -> list[_Plane]:
    turn = frame(axis)
    cosine = np.abs(sample.normals @ axis)
    sides = cosine < 0.25
    if sides.sum() < 200:
        return []
    return _plane(turn, sample.points @ turn.T, sides, cosine > 0.9)


def _plane(turn: Floats, points: Floats, sides: Bools, faces: Bools) -> list[_Plane]:
    flat = points[sides, :2]
    circle = tip_circle(flat)
    if circle is None:
        return []
    counted = _count(flat, circle)
    return [] if counted is None else [_Plane(turn, points, sides, faces, *counted)]


def _count(flat: Floats, circle: TipCircle) -> tuple[TipCircle, float, ToothCount] | None:
    """Circle, where the teeth end inwards, and their number."""
    radius, angle = circle.polar(flat)
    inner = innermost(radius, circle.radius)
    own = radius[(radius >= inner) & (radius < 1.02 * circle.radius)]
    if len(own) < 200:
        return None
    root = float(np.quantile(own, 0.003))
    if not 0.2 * circle.radius < root < 0.995 * circle.radius:
        return None
    count = count_teeth(radius, angle, root, circle.radius)
    return None if count is None else (circle, root, count)


def _lands(radius: Floats, turns: Floats, flank: FreeInvolute, plane: _Plane) -> tuple[float, float]:
    """Radii of the tip and bottom lands, mm, from the points near the middle of teeth and spaces; `turns` are pitches from the tooth's middle."""
    tip, root, teeth = plane.circle.radius, plane.root, plane.count.teeth
    for _ in range(3):
        # Half of the land is surely land; of pointed teeth a little more than nothing.
        half = 0.25 * flank.thickness(tip) / tip * teeth / (2.0 * math.pi)
        own = radius[(np.abs(turns) < max(half, 0.01)) & (radius > 0.5 * (root + tip)) & (radius < 1.05 * tip)]
        if len(own) < 20:
            break
        tip = float(np.median(own))
    reach = 0.15 * (tip - root)
    own = radius[(np.abs(turns) > 0.47) & (radius > root - reach) & (radius < root + reach)]
    return tip, float(np.median(own)) if len(own) >= 20 else root


def _width(plane: _Plane) -> tuple[float, int, float]:
    """Face width (mm), end faces seen, height of the lower end."""
    height = plane.points[:, 2]
    radius, _ = plane.circle.polar(plane.points[:, :2])
    toothed = (radius > plane.root) & (radius < 1.01 * plane.circle.radius)
    sides = height[toothed & plane.sides]
    if not len(sides):
        raise InputError("the teeth that were counted show no side, only end faces: a scan of the flanks is needed")
    low, high = np.quantile(sides, [0.002, 0.998])
    ends = []
    for end in (low, high):
        at = (radius < 1.01 * plane.circle.radius) & plane.faces & (np.abs(height - end) < 0.05 * (high - low))
        # A face holds many points at one height; a chamfer or a few normals gone wrong do not.
        ends.append(median_scale(height[at])[0] if at.sum() >= 40 else None)
    faces = sum(end is not None for end in ends)
    lower, upper = (float(value if end is None else end) for end, value in zip(ends, (low, high), strict=True))
    return upper - lower, faces, lower


def _bore(plane: _Plane) -> float:
    """Diameter of the innermost cylinder about the axis that nothing lies inside of, mm; 0 where there is none."""
    radius, angle = plane.circle.polar(plane.points[:, :2])
    inner = plane.sides & (radius < 0.97 * plane.root)
    if inner.sum() < 60:
        return 0.0
    least = float(np.quantile(radius[inner], 0.02))
    wall = inner & (np.abs(radius - least) < 0.03 * least)
    sectors = np.unique(np.floor(angle[wall] * (18.0 / math.pi))).size
    if sectors < 24 or (radius < 0.9 * least).sum() > 0.05 * wall.sum():
        return 0.0
    return 2.0 * float(np.median(radius[wall]))
