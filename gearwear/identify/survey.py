"""What a scan shows of a gear that no design is known of: axis, teeth, tip and root, base circle, thickness, width, bore."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow
from gearwear.design.quantity import significant
from gearwear.errors import InputError
from gearwear.identify.free_involute import FreeInvolute
from gearwear.identify.inward import Teeth, points_inward
from gearwear.identify.lengths import FaceEnds, bore_diameter, face_ends, lands, rim_diameter
from gearwear.identify.plane import LEAST_SHARE, Plane, along_axis, count_flat, plane_of
from gearwear.identify.ring import TipCircle, count_teeth, tip_circle
from gearwear.placing.coarse import SAMPLE, Sample, axis_candidates, take_sample
from gearwear.placing.pose import Pose
from gearwear.placing.screw import LEAST_ANGLE, find_screw, fine_sample, hand_changes_at, normal_twist, twist_size

OUT_OF_ROUND = 0.002
"""Oval from which a stretch is taken out before the flanks are fitted, and said."""
LEAST_POINTS = 300
"""Below this nothing is looked for."""
USUAL_ANGLE = math.radians(20.0)
"""Normal pressure angle for which a helix angle is told: sin β = sin β_b / cos α_n (ISO 21771)."""
PROFILE_SLOPE = 0.008
"""mm; profile slope deviation of usual gears: over the roll that was seen it cannot be told from another base circle."""
ROUGH = 0.03
"""Scatter about the involute, in pitches, above which points are of something else."""
DOUBTFUL = 0.01
"""Scatter about the involute, in pitches, above which every axis is tried, with teeth turned as the normals there say."""
GAP = 0.1
"""Share of a side's flank points that may lie elsewhere where only every second, third … tooth of those counted is one."""
FEWEST_TEETH = 5
LITTLE_SHARE = 0.1
"""Share of the pattern that repeats below which teeth of two hands are tried: the screw of a disc's wide ends may hide theirs."""
STAGGER = 0.02
"""Pitches that the halves of a double helical gear may stand turned against each other before it is said."""


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
    gap : float
        Between the halves of a double helical gear, mm; 0 of any other.
    rim_diameter : float
        Outside of a ring, mm; 0 where none was seen.
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
    gap: float
    rim_diameter: float

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
        angle = abs(self.base_helix[0])
        # β_b = atan(twist · r_b): a profile slope of usual size looks like another base circle.
        std = math.hypot(self.base_helix[1], 0.5 * math.sin(2.0 * angle) * PROFILE_SLOPE / self.flank.roll)
        reference = math.asin(min(math.sin(angle) / math.cos(USUAL_ANGLE), 0.999))
        spread = 2.0 * std * math.cos(angle) / (math.cos(USUAL_ANGLE) * math.cos(reference))
        return (
            f"{' and '.join(hands)}, helix angle {_degrees(reference, spread)} at the reference circle of 20° normal pressure angle "
            f"({_degrees(angle, 2.0 * std)} at the base circle)"
        )

    def rows(self) -> list[CardRow]:
        rows = [
            ("base pitch", f"{self.base_pitch:.4f} mm"),
            (f"thickness at diameter {2 * self.flank.middle:.2f} mm", f"{self.thickness:.4f} mm"),
        ]
        if math.isfinite(self.face_width):
            rows.append(("face width", f"{self.face_width:.3f} mm"))
        for name, length in (("gap", self.gap), ("bore diameter", self.bore_diameter), ("rim diameter", self.rim_diameter)):
            if length:
                rows.append((name, f"{length:.3f} mm"))
        return rows + [("note", note) for note in self.notes]

    @property
    def oval(self) -> float:
        """Stretch of the scan along one direction, relative; taken out before the flanks were fitted."""
        return self.circle.oval

    @property
    def base_pitch(self) -> float:
        """2 π r_b / z, mm; of a double helical gear the mean of its halves."""
        return 2.0 * math.pi * float(np.mean([half.base_radius for half in self.halves])) / self.teeth

    @property
    def thickness(self) -> float:
        """Transverse arc of a tooth at the radius `flank.middle`, mm: of a ring the pitch less its space, of halves the mean."""
        radius = self.flank.middle
        arc = float(np.mean([half.thickness(radius) for half in self.halves]))
        return 2.0 * math.pi * radius / self.teeth - arc if self.internal else arc

    @property
    def base_helix(self) -> tuple[float, float]:
        """Base helix angle and its standard deviation, rad: + right hand; of a double helical gear that of the half at z = 0, from both."""
        angles = [half.base_helix_angle for half in self.halves]
        std = math.sqrt(sum(half.base_helix_std**2 for half in self.halves)) / len(self.halves)
        return math.copysign(float(np.mean(np.abs(angles))), angles[0]), std


def _degrees(angle: float, doubt: float) -> str:
    """An angle in degrees with its doubt, to the digit that the doubt leaves."""
    doubt = math.degrees(doubt)
    if not doubt > 0.0:
        return f"{math.degrees(angle):.1f}°"
    digits = min(3, max(0, 1 - math.floor(math.log10(doubt))))
    return f"{math.degrees(angle):.{digits}f}° ± {doubt:.{digits}f}°"


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
    wide = f", {significant(seen.face_width)} mm wide" if math.isfinite(seen.face_width) else ""
    return f"; by itself the scan looks like {seen.what}{wide}"


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
        If no gear is seen in it.
    """
    if len(points) < LEAST_POINTS:
        raise InputError(f"{len(points)} points are too few to find a gear in: at least {LEAST_POINTS} would be right")
    best = _best_plane(points, normals, planar)
    parts = [best] if planar else _parts(best)
    even = _Even.of(parts[0], planar)
    plane, flank = even.plane, even.flank
    flanks = [fit for fit in (flank, *(part.flank for part in parts[1:])) if fit is not None]
    if flank is None or len(flanks) < len(parts) or not all(_smooth(fit, plane) for fit in flanks):
        raise InputError(
            f"{plane.count.teeth} teeth were counted, but no involute passes through their flanks: a scan of an involute gear is needed"
        )
    notes = even.notes
    if flank.worn_side is not None:
        notes += (
            "the flanks of one side are much rougher than the other's: taken for worn, the shape is that of the better side",
        )
    radius, turns = even.polar(flank)
    seen = _teeth_seen(turns[radius > plane.root], plane.count.teeth)
    if seen < plane.count.teeth:
        notes += (f"{seen} of the {plane.count.teeth} teeth were seen: the tooth count rests on their pitch",)
    tip, root, scatter = lands(radius, turns - np.rint(turns), flank, plane)
    teeth = [
        Teeth(part.points, part.normals, fit, part.count.teeth, part.middle) for part, fit in zip(parts, flanks, strict=True)
    ]
    inward = not planar and points_inward(teeth, root, tip)
    face = _Face() if planar else _Face.of(parts, plane.root, teeth, 0.5 * (root + tip))
    phase = flank.phase + (math.pi / plane.count.teeth if inward else 0.0)  # what was fitted as a tooth is the space of a ring
    cos, sin = math.cos(-phase), math.sin(-phase)
    spin = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return Survey(
        pose=Pose(spin @ plane.turn, spin @ -np.array([*flank.centre, face.low])),
        teeth=plane.count.teeth,
        tip_radius=root if inward else tip,
        root_radius=tip if inward else root,
        flank=flank,
        face_width=face.width,
        faces=face.ends,
        bore_diameter=0.0 if planar or inward else bore_diameter(plane),
        circle=TipCircle(np.zeros(2), tip, even.oval, even.direction - phase),
        share=plane.count.share,
        notes=(*notes, *face.notes),
        halves=tuple(flanks),
        internal=inward,
        root_scatter=scatter,
        gap=face.gap,
        rim_diameter=rim_diameter(plane) if inward else 0.0,
    )


@dataclass(frozen=True, slots=True)
class _Even:
    """A gear seen along its axis, with the scan's own stretch taken out where it has one.

    Parameters
    ----------
    plane : Plane
    flat : (n, 2) float
        Tooth sides in the plane of rotation, mm.
    height : (n,) float or None
        Theirs, from the middle, mm; None of a planar section.
    flank : FreeInvolute or None
        The involute through them.
    oval, direction : float
        How much longer the scan was along a direction than across, and that, rad; 0 where nothing was taken out.
    notes : tuple of str
    """

    plane: Plane
    flat: Floats
    height: Floats | None
    flank: FreeInvolute | None
    oval: float = 0.0
    direction: float = 0.0
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, plane: Plane, planar: bool) -> _Even:
        """Tips that are nearly points may look oval; a scan that is stretched has better flanks without the stretch."""
        (flat, above), circle = plane.flat, plane.circle
        height = None if planar else above
        flank = plane.fit(flat, None) if planar else plane.flank
        seen = cls(plane, flat, height, flank)
        if circle.oval <= OUT_OF_ROUND or plane.twist:
            return seen
        straight = circle.rounded(flat)
        again = count_flat(straight, np.zeros(len(straight)), tip_circle(straight) or circle)
        if again is None:
            return seen
        rounded = replace(plane, circle=again[0], root=again[1], count=again[2])
        better = rounded.fit(straight, height)
        if better is None or not (flank is None or better.scatter < 0.8 * flank.scatter):
            return seen
        said = (
            f"the tips lie on an oval, {100 * circle.oval:.2f} % longer along {math.degrees(circle.direction) % 180:.0f}° than across: taken for the scan's own "
            "stretch and set aside"
        )
        return cls(rounded, straight, height, better, circle.oval, circle.direction, (said,))

    def polar(self, flank: FreeInvolute) -> tuple[Floats, Floats]:
        """Radius of every point about the flanks' centre, mm, and by how many pitches it stands off the first tooth."""
        radius, angle = replace(self.plane.circle, centre=flank.centre).polar(self.flat)
        turned = angle - flank.phase - (0.0 if self.height is None else flank.twist * self.height)
        return radius, turned * (self.plane.count.teeth / (2.0 * math.pi))


def _teeth_seen(turns: Floats, teeth: int) -> int:
    """How many teeth have points, of points that stand so many pitches off the first."""
    number = np.bincount(np.mod(np.rint(turns).astype(np.int64), teeth), minlength=teeth)
    return int((number > 0.2 * np.median(number[number > 0])).sum())


@dataclass(frozen=True, slots=True)
class _Face:
    """Width of the face, lower end and groove, mm; how many end faces were seen; what must be said. Of a planar section nothing is known."""

    width: float = math.nan
    low: float = 0.0
    gap: float = 0.0
    ends: int = 0
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, parts: Sequence[Plane], root: float, teeth: Sequence[Teeth], inside: float) -> _Face:
        """Of a gear or the halves of one, with the radius of the roots; the groove's bottom lies near them, so halves end where they do at `inside`, mm."""
        ends = face_ends(parts, root)
        seen, gap = ends.low_seen + ends.high_seen, 0.0
        notes: tuple[str, ...] = ()
        if seen < 2:
            notes = ("not both end faces were seen: the face width is the height of what was seen",)
        if len(parts) == 2:
            halves = face_ends(parts[:1], inside), face_ends(parts[1:], inside)
            gap = max(halves[1].low_edge - halves[0].high_edge, 0.0)
            notes += tuple(_staggered(teeth, halves))
        return cls(ends.width, ends.low, gap, seen, notes)


def _staggered(halves: Sequence[Teeth], ends: Sequence[FaceEnds]) -> list[str]:
    """A sentence where the teeth of two halves do not stand at one angle, each in the middle of its half."""
    angle = [
        half.flank.phase + half.flank.twist * (0.5 * (end.low + end.high) - half.middle)
        for half, end in zip(halves, ends, strict=True)
    ]
    pitches = (angle[1] - angle[0]) * halves[0].count / (2.0 * math.pi)
    pitches -= round(pitches)
    if abs(pitches) < STAGGER:
        return []
    return [
        f"the teeth of the upper half stand turned by {pitches:+z.3f} pitches against the lower's, each in the middle of its half: a design "
        "has them at one angle, and a comparison will show it as a shift in height"
    ]


def _parts(plane: Plane) -> list[Plane]:
    """A gear as it is, or the halves of a double helical one, the lower first, along the axis that both lie about."""
    halves = _halves(plane)
    for _ in range(3):
        leans = [half.flank.lean for half in halves if half.flank is not None]
        if len(leans) < 2:
            break
        lean = np.mean(leans, axis=0)
        axis = halves[0].turn.T @ np.array([*lean, 1.0])
        sample = Sample(plane.points @ plane.turn, plane.normals @ plane.turn)
        again = along_axis(sample, axis / np.linalg.norm(axis), halves[0].twist)
        straight = _halves(again[0]) if again else []
        if len(straight) < 2:
            break
        halves = straight
        if np.hypot(*lean) < 1e-5:
            break
    return halves or [plane]


def _halves(plane: Plane) -> list[Plane]:
    """The halves of a double helical gear without the groove, the lower first; none of any other."""
    about, normals, outer, inner = plane.toothing
    height = hand_changes_at(about, normals, outer, inner)
    if height is None:
        return []
    halves = []
    for upwards in (-1.0, 1.0):
        beyond = upwards * (plane.points[:, 2] - height) > 0.0
        twist = normal_twist(about[beyond], normals[beyond], outer, inner)
        half = plane_of(plane.turn, plane.points[beyond], plane.normals[beyond], twist)
        if not half or not twist:
            return []
        ends = face_ends(half, 0.5 * (half[0].root + half[0].circle.radius))
        toothed = upwards * plane.points[:, 2] >= upwards * (ends.low_edge if upwards > 0.0 else ends.high_edge)
        half = plane_of(plane.turn, plane.points[beyond & toothed], plane.normals[beyond & toothed], twist)
        if not half:
            return []
        halves.append(half[0])
    return halves if halves[0].count.teeth == halves[1].count.teeth else []


def _best_plane(points: Floats, normals: Floats | None, planar: bool) -> Plane:
    """The axis along which the scan repeats most, set straight by the flanks."""
    planes: list[Plane] = []
    if planar:
        pick = np.random.default_rng(0).choice(len(points), min(len(points), SAMPLE), replace=False)
        planes = plane_of(np.eye(3), points[pick], np.tile([1.0, 0.0, 0.0], (len(pick), 1)))
    else:
        sample = take_sample(points, normals)
        planes = _all_planes(sample)
        if normals is None and len(points) > SAMPLE:
            # The thinned scan is too coarse for the normals of small teeth; near neighbours are too noisy for those of large ones.
            fine = fine_sample(points)
            others = _all_planes(fine)
            if others and others[0].count.share > 1.2 * (planes[0].count.share if planes else 0.0):
                sample, planes = fine, others
    planes = sorted((plane for plane in planes if plane.count.share >= LEAST_SHARE), key=lambda plane: -plane.count.share)
    if not planes:
        raise InputError(
            "no gear is seen in the scan: nothing repeats round an axis; a gear is needed, with the tips of its teeth in the scan"
        )
    # What repeats most may be seen along a wrong axis: of a gear an involute passes through the flanks.
    best = next((plane for plane in planes if plane.flank is not None and _smooth(plane.flank, plane)), planes[0])
    # Part of a helical gear looks like a spur gear along a wrong axis.
    if not planar and _roughness(best) > DOUBTFUL:
        best = min((candidate for plane in planes for candidate in (plane, *_turned(sample, plane))), key=_roughness)
    best = _without_gaps(best)
    return best if planar else _straightened(sample, best)


def _roughness(plane: Plane) -> float:
    """Scatter about the involute, in pitches at the tips of the teeth counted."""
    flank = plane.flank
    return math.inf if flank is None else flank.scatter * plane.count.teeth / (2.0 * math.pi * plane.circle.radius)


def _turned(sample: Sample, plane: Plane) -> list[Plane]:
    """The plane with its teeth turned as the normals say, counted anew and as they were: part of a turn may show harmonics."""
    twist = normal_twist(*plane.toothing)
    counts = (None, plane.count.teeth)
    return [turned for count in counts for turned in along_axis(sample, plane.turn[2], twist, count) if turned.twist]


def _smooth(flank: FreeInvolute, plane: Plane) -> bool:
    """Whether the points lie on the involute as closely as on any gear."""
    limit = 0.5 * ROUGH if flank.twist else ROUGH  # a wrong twist or count passes through many points too
    return flank.scatter < limit * flank.middle * 2.0 * math.pi / plane.count.teeth


def _without_gaps(plane: Plane) -> Plane:
    """The plane with half, a third … of the teeth where flanks lie on only every second, third … of those counted."""
    flank, teeth = plane.flank, plane.count.teeth
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


def _all_planes(sample: Sample) -> list[Plane]:
    """Along every candidate axis, the one that repeats most first."""
    if len(sample.points) < LEAST_POINTS // 2:  # many in one place, the rest alone
        return []
    straight = [plane for axis in axis_candidates(sample) for plane in along_axis(sample, axis)]
    planes, screw = list(straight), find_screw(sample)
    if screw is not None:
        planes += along_axis(sample, screw.axis, screw.twist)
    if max((plane.count.share for plane in planes), default=0.0) < LITTLE_SHARE:
        planes += [twisted for plane in straight for twisted in _either_hand(sample, plane)]
    return sorted(planes, key=lambda plane: -plane.count.share)


def _either_hand(sample: Sample, plane: Plane) -> list[Plane]:
    """A plane with its teeth turned to the right and to the left, as much as normals say: of a double helical gear one half repeats."""
    twist = twist_size(*plane.toothing)
    return [turned for hand in (1.0, -1.0) for turned in along_axis(sample, plane.turn[2], hand * twist) if turned.twist]


def _straightened(sample: Sample, plane: Plane) -> Plane:
    """The plane square to the axis that the flanks lie about; normals alone leave it a few mrad off."""
    # A little twist hides in the pattern of a narrow gear, and normals of few points may show one that is not there.
    others = along_axis(sample, plane.turn[2], 0.0, plane.count.teeth) if plane.twist else _turned(sample, plane)
    plane = min([plane, *others], key=_roughness)
    for _ in range(3):
        count = plane.count
        flank = plane.flank
        if flank is None:
            return plane
        axis = plane.turn.T @ np.array([*flank.lean, 1.0])
        again = along_axis(sample, axis / np.linalg.norm(axis), flank.twist, count.teeth)
        if not again or not _roughness(again[0]) < 2.0 * _roughness(plane):
            return plane
        plane = again[0]
        if np.hypot(*flank.lean) < 1e-5:
            break
    if 0.0 < abs(plane.twist) * plane.circle.radius < math.tan(LEAST_ANGLE):  # a spur gear with much helix deviation
        return next(iter(along_axis(sample, plane.turn[2])), plane)
    return plane
