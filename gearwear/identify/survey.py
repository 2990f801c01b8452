"""What a scan shows of a gear that no design is known of: axis, teeth, tip and root, base circle, thickness, width, bore."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.card import Card, CardRow
from gearwear.errors import InputError
from gearwear.identify.free_involute import FreeInvolute, fit_involute
from gearwear.identify.inward import Teeth, points_inward
from gearwear.identify.ring import TipCircle, ToothCount, count_teeth, innermost, tip_circle
from gearwear.placing.coarse import SAMPLE, Sample, axis_candidates, frame, take_sample
from gearwear.placing.pose import Pose
from gearwear.placing.robust import median_scale
from gearwear.placing.screw import LEAST_ANGLE, find_screw, fine_sample, hand_changes_at, normal_twist

OUT_OF_ROUND = 0.002
"""Oval from which a stretch is taken out before the flanks are fitted, and said."""
LEAST_POINTS = 300
"""Below this nothing is looked for."""
USUAL_ANGLE = math.radians(20.0)
"""Normal pressure angle for which a helix angle is told: sin β = sin β_b / cos α_n (ISO 21771)."""
ROUGH = 0.03
"""Scatter about the involute, in pitches, above which points are of something else."""
GAP = 0.1
"""Share of a side's flank points that may lie elsewhere where only every second, third … tooth of those counted is one."""
FEWEST_TEETH = 5
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
    halves : tuple of FreeInvolute
        `flank`; of a double helical gear its lower and upper half.
    internal : bool
        Whether the teeth point inwards: then `flank` is that of the spaces, and the tip radius the smaller one.
    root_scatter : float
        Robust standard deviation of the points on bottom lands, mm; nan where none was seen: the root lies deeper.
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
    halves: tuple[FreeInvolute, ...]
    internal: bool
    root_scatter: float

    def headline(self) -> str:
        return f"{self.what}, root diameter {2 * self.root_radius:.3f} mm"

    @property
    def helical(self) -> bool:
        """Whether the teeth run round the axis."""
        return any(half.twist for half in self.halves)

    @property
    def what(self) -> str:
        """Kind, tooth count and tip diameter; of helical teeth hand and helix angle."""
        size = f"{self.teeth} teeth, tip diameter {2 * self.tip_radius:.2f} mm"
        if not self.helical and not self.internal:
            return size
        kind = " ".join(
            word for word, so in (("internal", self.internal), ("double", len(self.halves) == 2), ("helical", self.helical)) if so
        )
        return f"{'an' if self.internal else 'a'} {kind} gear of {size}" + (f", {self._helix()}" if self.helical else "")

    def _helix(self) -> str:
        """Hands and angle."""
        hands = ["right hand" if half.twist > 0.0 else "left hand" for half in self.halves]
        angle = float(np.mean([abs(half.base_helix_angle) for half in self.halves]))
        std = math.sqrt(sum(half.base_helix_std**2 for half in self.halves)) / len(self.halves)
        reference = math.asin(min(math.sin(angle) / math.cos(USUAL_ANGLE), 0.999))
        spread = 2.0 * std * math.cos(angle) / (math.cos(USUAL_ANGLE) * math.cos(reference))
        return (
            f"{' and '.join(hands)}, helix angle {_degrees(reference, spread)} at the reference circle of 20° normal pressure angle "
            f"({_degrees(angle, 2.0 * std)} at the base circle)"
        )

    def rows(self) -> list[CardRow]:
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


def _degrees(angle: float, doubt: float) -> str:
    """An angle in degrees with its doubt, to the digit that the doubt leaves."""
    doubt = math.degrees(doubt)
    if not doubt > 0.0:
        return f"{math.degrees(angle):.1f}°"
    digits = min(3, max(0, 1 - math.floor(math.log10(doubt))))
    return f"{math.degrees(angle):.{digits}f}° ± {doubt:.{digits}f}°"


@dataclass(frozen=True, slots=True)
class _Plane:
    """A scan seen along a candidate axis; teeth that turn with the height by `twist`, rad/mm."""

    turn: Floats
    points: Floats
    normals: Floats
    sides: Bools
    faces: Bools
    circle: TipCircle
    root: float
    count: ToothCount
    twist: float = 0.0

    @property
    def flat(self) -> tuple[Floats, Floats]:
        """Tooth sides in the plane of rotation, (n, 2) mm, and their heights (n,) from the middle, mm."""
        return self.points[self.sides, :2], self.points[self.sides, 2] - self.middle

    @property
    def middle(self) -> float:
        """Height from which the twist is counted, mm."""
        return float(np.median(self.points[self.sides, 2]))


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
    return f"; by itself the scan looks like {seen.what}"


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
    parts = [plane] if planar else _parts(plane)
    plane = parts[0]
    flat, circle = plane.points[plane.sides, :2], plane.circle
    height = None if planar else plane.points[plane.sides, 2] - plane.middle
    notes = []
    oval, direction = 0.0, 0.0
    flank = _fit(flat, height, plane)
    if circle.oval > OUT_OF_ROUND and not plane.twist:
        # Tips that are nearly points may look oval; a scan that is stretched has better flanks without the stretch.
        straight = circle.rounded(flat)
        again = _count(straight, np.zeros(len(straight)), tip_circle(straight) or circle)
        if again is not None:
            rounded = replace(plane, circle=again[0], root=again[1], count=again[2])
            better = _fit(straight, height, rounded)
            if better is not None and (flank is None or better.scatter < 0.8 * flank.scatter):
                oval, direction = circle.oval, circle.direction
                flat, plane, flank = straight, rounded, better
                notes.append(
                    f"the tips lie on an oval, {100 * oval:.2f} % longer along {math.degrees(direction) % 180:.0f}° than across: taken for the scan's own "
                    "stretch and set aside"
                )
    flanks = [own for own in (flank, *(_fit(*one.flat, one) for one in parts[1:])) if own is not None]
    if flank is None or len(flanks) < len(parts) or not all(_smooth(own, plane) for own in flanks):
        raise InputError(
            f"{plane.count.teeth} teeth were counted, but no involute passes through their flanks: a scan of an external spur gear is needed"
        )
    if flank.worn_side is not None:
        notes.append(
            "the flanks of one side are much rougher than the other's: taken for worn, the shape is that of the better side"
        )
    radius, angle = replace(plane.circle, centre=flank.centre).polar(flat)
    turned = angle - flank.phase - (0.0 if height is None else flank.twist * height)
    turns = turned * (plane.count.teeth / (2.0 * math.pi))
    toothed = radius > plane.root
    number = np.bincount(np.mod(np.rint(turns[toothed]).astype(np.int64), plane.count.teeth), minlength=plane.count.teeth)
    seen = int((number > 0.2 * np.median(number[number > 0])).sum())
    tip, root, scatter = _lands(radius, turns - np.rint(turns), flank, plane)
    if seen < plane.count.teeth:
        notes.append(f"{seen} of the {plane.count.teeth} teeth were seen: the tooth count rests on their pitch")
    width, faces, low = math.nan, 0, 0.0
    if not planar:
        width, faces, low = _width(parts)
        if faces < 2:
            notes.append("not both end faces were seen: the face width is the height of what was seen")
    bore = 0.0 if planar else _bore(plane)
    cos, sin = math.cos(-flank.phase), math.sin(-flank.phase)
    spin = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    pose = Pose(spin @ plane.turn, spin @ -np.array([*flank.centre, low]))
    teeth = [Teeth(one.points, one.normals, own, one.count.teeth, one.middle) for one, own in zip(parts, flanks, strict=True)]
    inward = not planar and points_inward(teeth, root, tip)
    return Survey(
        pose, plane.count.teeth, *((root, tip) if inward else (tip, root)), flank, width, faces, bore,
        TipCircle(np.zeros(2), tip, oval, direction - flank.phase), plane.count.share, tuple(notes), tuple(flanks), inward, scatter,
    )  # fmt: skip


def _parts(plane: _Plane) -> list[_Plane]:
    """A gear as it is, or the halves of a double helical one, the lower first."""
    about = plane.points - np.array([*plane.circle.centre, 0.0])
    height = hand_changes_at(about, plane.normals, plane.circle.radius, plane.root)
    if height is None:
        return [plane]
    found = []
    for own in (plane.points[:, 2] < height, plane.points[:, 2] > height):
        twist = normal_twist(about[own], plane.normals[own], plane.circle.radius, plane.root)
        half = _plane(plane.turn, plane.points[own], plane.normals[own], twist)
        if not half or not twist:
            return [plane]
        found.append(half[0])
    return found if found[0].count.teeth == found[1].count.teeth else [plane]


def _fit(flat: Floats, height: Floats | None, plane: _Plane) -> FreeInvolute | None:
    """The involute through the flanks seen in a plane."""
    count = plane.count
    twist = plane.twist or None
    return fit_involute(flat, height, plane.circle.centre, count.teeth, count.phase, plane.root, plane.circle.radius, twist)


def _best_plane(points: Floats, normals: Floats | None, planar: bool) -> _Plane:
    """The axis along which the scan repeats most, set straight by the flanks."""
    found: list[_Plane] = []
    if planar:
        pick = np.random.default_rng(0).choice(len(points), min(len(points), SAMPLE), replace=False)
        found = _plane(np.eye(3), points[pick], np.tile([1.0, 0.0, 0.0], (len(pick), 1)))
    else:
        sample = take_sample(points, normals)
        found = _all_planes(sample)
        if normals is None and len(points) > SAMPLE:
            # The thinned scan is too coarse for the normals of small teeth; near neighbours are too noisy for those of large ones.
            fine = fine_sample(points)
            others = _all_planes(fine)
            if others and others[0].count.share > 1.2 * (found[0].count.share if found else 0.0):
                sample, found = fine, others
    found = sorted((plane for plane in found if plane.count.share >= LEAST_SHARE), key=lambda plane: -plane.count.share)
    if not found:
        raise InputError(
            "no gear is seen in the scan: nothing repeats round an axis; an external spur gear is needed, with the tips of its teeth in the scan"
        )
    # What repeats most may be seen along a wrong axis: of a gear an involute passes through the flanks.
    fits = (_fit(*plane.flat, plane) for plane in found)
    best = next(
        (plane for plane, flank in zip(found, fits, strict=True) if flank is not None and _smooth(flank, plane)), found[0]
    )
    best = _without_gaps(best)
    return best if planar else _straightened(sample, best)


def _roughness(plane: _Plane) -> float:
    """Scatter about the involute, mm."""
    flank = _fit(*plane.flat, plane)
    return math.inf if flank is None else flank.scatter


def _smooth(flank: FreeInvolute, plane: _Plane) -> bool:
    """Whether the points lie on the involute as closely as on any gear."""
    limit = 0.5 * ROUGH if flank.twist else ROUGH  # a wrong twist or count passes through many points too
    return flank.scatter < limit * flank.middle * 2.0 * math.pi / plane.count.teeth


def _without_gaps(plane: _Plane) -> _Plane:
    """The plane with half, a third … of the teeth where flanks lie on only every second, third … of those counted."""
    flank, teeth = _fit(*plane.flat, plane), plane.count.teeth
    if flank is None:
        return plane
    flat, height = plane.flat
    radius, angle = replace(plane.circle, centre=flank.centre).polar(flat)
    turns = (angle - flank.phase - flank.twist * height) * (teeth / (2.0 * math.pi))
    number = np.rint(turns).astype(np.int64)
    pressure = np.arccos(np.minimum(flank.base_radius / np.maximum(radius, 1e-300), 1.0))
    half = (flank.base_half_angle - np.tan(pressure) + pressure) * (teeth / (2.0 * math.pi))
    on = (np.abs(radius - flank.middle) < 0.25 * (plane.circle.radius - plane.root)) & (
        np.abs(np.abs(turns - number) - half) < 0.1
    )
    right = (turns < number)[on]
    for times in (5, 4, 3, 2):
        if teeth % times or teeth // times < FEWEST_TEETH:
            continue
        place = number[on] % times
        held = [np.bincount(place[side], minlength=times) for side in (right, ~right)]
        if all(side.max() > (1.0 - GAP) * side.sum() for side in held):
            turn = plane.twist * height
            again = count_teeth(*plane.circle.polar(flat), plane.root, plane.circle.radius, turn, teeth // times)
            return plane if again is None else replace(plane, count=again)
    return plane


def _all_planes(sample: Sample) -> list[_Plane]:
    """Along every candidate axis, the one that repeats most first."""
    if len(sample.points) < LEAST_POINTS // 2:  # many in one place, the rest alone
        return []
    found = [plane for axis in axis_candidates(sample) for plane in _along(sample, axis)]
    screw = find_screw(sample)
    if screw is not None:
        found += _along(sample, screw.axis, screw.twist)
    return sorted(found, key=lambda plane: -plane.count.share)


def _straightened(sample: Sample, plane: _Plane) -> _Plane:
    """The plane square to the axis that the flanks lie about; normals alone leave it a few mrad off."""
    if not plane.twist:  # little of it hides in the pattern of a narrow gear
        about = plane.points - np.array([*plane.circle.centre, 0.0])
        turning = normal_twist(about, plane.normals, plane.circle.radius, plane.root)
        twisted = [one for one in _along(sample, plane.turn[2], turning) if one.twist]
        plane = min([plane, *twisted], key=_roughness)
    for _ in range(3):
        count = plane.count
        flank = _fit(*plane.flat, plane)
        if flank is None:
            return plane
        axis = plane.turn.T @ np.array([*flank.lean, 1.0])
        again = _along(sample, axis / np.linalg.norm(axis), flank.twist)
        if not again or again[0].count.teeth != count.teeth:
            return plane
        plane = again[0]
        if np.hypot(*flank.lean) < 1e-5:
            break
    if 0.0 < abs(plane.twist) * plane.circle.radius < math.tan(LEAST_ANGLE):  # a spur gear with much helix deviation
        return next(iter(_along(sample, plane.turn[2])), plane)
    return plane


def _along(sample: Sample, axis: Floats, twist: float = 0.0) -> list[_Plane]:
    turn = frame(axis)
    return _plane(turn, sample.points @ turn.T, sample.normals @ turn.T, twist)


def _plane(turn: Floats, points: Floats, normals: Floats, twist: float = 0.0) -> list[_Plane]:
    """The points along an axis, in none or one plane; a twist that is none of a helical gear is left out."""
    cosine = np.abs(normals[:, 2])
    sides = cosine < 0.25
    if sides.sum() < 200:
        return []
    circle = tip_circle(points[sides, :2])
    if circle is None:
        return []
    slope = abs(twist) * circle.radius
    if slope < 0.5 * math.tan(LEAST_ANGLE):
        twist = 0.0
    else:
        sides = cosine < max(0.25, min(0.85, math.sin(math.atan(slope)) + 0.15))
        circle = tip_circle(points[sides, :2])
        if circle is None:
            return []
    height = points[sides, 2]
    counted = _count(points[sides, :2], twist * (height - float(np.median(height))), circle)
    return [] if counted is None else [_Plane(turn, points, normals, sides, cosine > 0.9, *counted, twist)]


def _count(flat: Floats, turn: Floats, circle: TipCircle) -> tuple[TipCircle, float, ToothCount] | None:
    """Circle, where the teeth end inwards, and their number, of points (n, 2) after each is turned back by `turn`, rad.

    Where a rim lies round the teeth of a ring it is the outermost circle; what is inside of the first empty ring is tried too.
    """
    found = _count_within(flat, turn, circle)
    if found is not None and found[2].share >= LEAST_SHARE:
        return found
    inner = innermost(circle.polar(flat)[0], circle.radius)
    within = circle.polar(flat)[0] < 0.999 * inner
    if within.sum() >= 200:
        smaller = tip_circle(flat[within])
        within_teeth = None if smaller is None else _count_within(flat[within], turn[within], smaller)
        if within_teeth is not None and (found is None or within_teeth[2].share > found[2].share):
            return within_teeth
    return found


def _count_within(flat: Floats, turn: Floats, circle: TipCircle) -> tuple[TipCircle, float, ToothCount] | None:
    radius, angle = circle.polar(flat)
    inner = innermost(radius, circle.radius)
    own = radius[(radius >= inner) & (radius < 1.02 * circle.radius)]
    if len(own) < 200:
        return None
    root = float(np.quantile(own, 0.003))
    if not 0.2 * circle.radius < root < 0.995 * circle.radius:
        return None
    count = count_teeth(radius, angle, root, circle.radius, turn)
    return None if count is None else (circle, root, count)


def _lands(radius: Floats, turns: Floats, flank: FreeInvolute, plane: _Plane) -> tuple[float, float, float]:
    """Radii of the tip and bottom lands, and the bottom's robust scatter, mm, from the points near the middle of teeth and spaces.

    `turns` are pitches from the tooth's middle; where no bottom was seen its radius is where the flanks end, and its scatter nan.
    """
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
    return (tip, *median_scale(own)) if len(own) >= 20 else (tip, root, math.nan)


def _width(parts: list[_Plane]) -> tuple[float, int, float]:
    """Face width (mm), end faces seen, height of the lower end; of one part or two halves."""
    plane = parts[0]
    points, sides, faces = (np.concatenate([getattr(part, name) for part in parts]) for name in ("points", "sides", "faces"))
    height = points[:, 2]
    radius, _ = plane.circle.polar(points[:, :2])
    toothed = (radius > plane.root) & (radius < 1.01 * plane.circle.radius)
    shown = height[toothed & sides]
    if not len(shown):
        raise InputError("the teeth that were counted show no side, only end faces: a scan of the flanks is needed")
    low, high = np.quantile(shown, [0.002, 0.998])
    ends = []
    for end in (low, high):
        at = (radius < 1.01 * plane.circle.radius) & faces & (np.abs(height - end) < 0.05 * (high - low))
        # A face holds many points at one height; a chamfer or a few normals gone wrong do not.
        ends.append(median_scale(height[at])[0] if at.sum() >= 40 else None)
    seen = sum(end is not None for end in ends)
    lower, upper = (float(value if end is None else end) for end, value in zip(ends, (low, high), strict=True))
    return upper - lower, seen, lower


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
