"""Whether a scan that lies on the design is of this gear."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK, ROOT, TIP, SurfacePoints, locate
from gearwear.design.twist import drawn_height, helix_words, normal_loss, segments, untwisted
from gearwear.errors import InputError, NotThisGear
from gearwear.placing.screw import fine_sample, normal_twist
from gearwear.placing.tooth_count import other_count
from gearwear.placing.views import PlacedScan
from gearwear.robust import median_scale, some_of

LEAST_FLANK = 100
"""Points on flanks below which nothing can be said of a gear."""
SUFFICIENT_SHARE_ON_DESIGN, LEAST_SHARE_ON_DESIGN = 0.8, 0.5
"""Share of points on the design from which on the scan is of it, however distorted or worn; and below which it is not, if the rest is off too."""
DOUBTFUL_DISTANCE_MODULES, MAX_TOOTH_SPREAD_MODULES = 0.03, 0.05
"""Of both sides' flanks, in modules: distance from the design above which it may be of another gear; spread of the teeth at which it is."""
MAX_DISTANCE_WITHOUT_LANDS_MODULES, MAX_DISTANCE_MODULES = 0.08, 0.25
"""Of both sides' flanks, in modules: distance from the design at which a scan without its rims is of another gear; and any scan."""
MAX_BASE_DIFFERENCE = 0.025
"""Relative difference of the base circle from the design's at which a scan that does not lie on the design is of another gear."""
LEAST_LANDS = 0.02
"""Share of points on tips and bottom lands below which the scan's rims lie elsewhere than the design's."""
SAMPLE = 60_000
"""Points of a scan that are enough to see where its ends and rims lie."""
ANOTHER_ANGLE = 0.3
"""Share of the twist by which normals of a thin scan may miss it."""
HELICAL = 2.0
"""Helix angle at the tip circle, degrees, from which on teeth are helical: 35 µm per mm of width."""
INNER = 0.4
"""Share of flank and face, from the middle, that says what base circle the flanks are of."""
LAND_OFF = 0.15
"""How far out both lands must lie, in modules."""
SAME_WIDTH, OTHER_WIDTH = 0.02, 0.12
"""Relative difference of the face width from the design's up to which it is the design's; and from which on it is another gear's."""
LEAST_RIM = 60
"""Points from which on tips or roots have a radius."""
LEAST_FACE_POINTS = 40
"""Points inside the metal of teeth, at one height, that make an end face."""
WAVES = 2
"""Waves round the gear that a distorted scan may show: one is an eccentric datum, two a plane scaled along one direction."""
FEWEST_TEETH = 4 * WAVES
"""Teeth below which that many waves would pass through anything."""


@dataclass(frozen=True, slots=True)
class FlanksOff:
    """How far flanks lie off the design on the better side, which wear of the drive side does not reach, slow waves round the gear apart.

    Parameters
    ----------
    distance : float
        Median distance of the points, mm.
    spread : float
        Standard deviation from tooth to tooth, mm, robust: another tooth count drifts through the design's.
    """

    distance: float
    spread: float


def doubtful_distance(gear: Gear) -> float:
    """Distance of both sides' flanks from the design from which on the scan may be of another gear, mm: more than teeth may be too thick or thin."""
    thickness = gear.tolerance.thickness
    assert thickness is not None  # the usual one where none is stated
    return max(DOUBTFUL_DISTANCE_MODULES * gear.transverse_module, 0.5 * thickness)


def flanks_off(points: SurfacePoints) -> FlanksOff:
    """Distance and spread of the flanks; nothing on a side counts as zero."""
    sides = [points.take((points.surface == FLANK) & (points.side == side)) for side in (1, -1)]
    measured = [_one_side(on_side) for on_side in sides if len(on_side)]
    return FlanksOff(
        min((flanks.distance for flanks in measured), default=0.0), min((flanks.spread for flanks in measured), default=0.0)
    )


def _one_side(points: SurfacePoints) -> FlanksOff:
    teeth, index = np.unique(points.tooth, return_inverse=True)
    medians = np.array([np.median(points.deviation[index == tooth]) for tooth in range(len(teeth))])
    angles = np.arctan2(points.position[:, 1], points.position[:, 0])
    round_gear = np.array([np.angle(np.exp(1j * angles[index == tooth]).mean()) for tooth in range(len(teeth))])
    slow = _slow_waves(round_gear, medians)
    spread = median_scale(medians - slow)[1] if len(teeth) > 2 else 0.0
    return FlanksOff(float(np.median(np.abs(points.deviation - slow[index]))), float(spread))


def _slow_waves(angle: Floats, medians: Floats) -> Floats:
    """The waves of low order in one value a tooth, without their mean over the teeth that were seen: on a part of the gear they and a level cancel."""
    if len(medians) < FEWEST_TEETH:
        return np.zeros(len(medians))
    orders = np.arange(1, WAVES + 1)
    waves = np.column_stack([np.cos(angle[:, None] * orders), np.sin(angle[:, None] * orders)])
    fitted = np.linalg.lstsq(np.column_stack([np.ones(len(angle)), waves]), medians, rcond=None)[0]
    slow = waves @ fitted[1:]
    return np.asarray(slow - slow.mean())


def check_gear(placed: PlacedScan, gear: Gear) -> float:
    """Refuse what lies on the design without being of this gear.

    Returns
    -------
    float
        Face width, mm: the design's, or the one that was seen where it is off by less than another gear's would be.

    Raises
    ------
    InputError
        If next to no points lie on flanks, or if the points, the flanks and the rims do not go together with the design.
    """
    points = placed.located
    flank = points.surface == FLANK
    flanks = int(flank.sum())
    if flanks < LEAST_FLANK:
        raise InputError(f"{flanks} of {len(points):,} points lie on flanks of the design: at least {LEAST_FLANK} would be right")
    fitting, off, m = placed.registration.fitting, flanks_off(points), gear.transverse_module
    lands = float(np.isin(points.surface, (TIP, ROOT)).mean())
    planar = not placed.registration.observed[3:5].any()  # no tilt can be seen in it
    if counted := other_count(untwisted(gear, _some(placed.measured, gear))[:, :2], gear):
        reason = f"{counted} teeth are counted in it, and the design has {gear.teeth}"
        raise NotThisGear(placed.measured, planar, f"{_not_this(reason)}; gearwear design SCAN proposes a design")
    one_sided = min(int((flank & (points.side == side)).sum()) for side in (1, -1)) < 0.02 * flanks
    one_sided &= 2 * len(np.unique(points.tooth[flank])) > gear.teeth
    if one_sided and off.distance > MAX_DISTANCE_MODULES * m:
        raise InputError(
            "flanks of one side only are in the scan, and do not say where the gear lies: tips, roots and the other flanks are needed"
        )
    apart = lands < LEAST_LANDS and off.distance > MAX_DISTANCE_WITHOUT_LANDS_MODULES * m
    doubtful = off.spread > MAX_TOOTH_SPREAD_MODULES * m or (
        off.distance > doubtful_distance(gear) and (lands < LEAST_LANDS or fitting < LEAST_SHARE_ON_DESIGN)
    )
    doubtful |= abs(base_radius(points, gear) / gear.base_radius - 1.0) > MAX_BASE_DIFFERENCE
    if off.distance > MAX_DISTANCE_MODULES * m or apart or (doubtful and fitting < SUFFICIENT_SHARE_ON_DESIGN):
        if not planar and (otherwise := runs_otherwise(placed.measured, gear)):
            raise NotThisGear(placed.measured, False, _not_this(otherwise))
        far = max(off.distance, off.spread)
        beside = f", and the flanks on both sides lie up to some {far:.1f} mm off it" if far >= 0.05 else ""
        raise NotThisGear(
            placed.measured,
            planar,
            f"the scan is not of this gear: {100 * fitting:.0f} % of its points lie on the design of {gear.teeth} teeth{helix_words(gear)} and tip diameter "
            f"{2 * gear.tip_radius:.2f} mm{beside}; "
            f"check the design, part and units; gearwear design SCAN proposes a design",
        )
    if not planar:
        _check_kind(placed, gear, fitting)
        return width_seen(placed.measured, gear)
    return gear.face_width


def _check_kind(placed: PlacedScan, gear: Gear, fitting: float) -> None:
    """Refuse teeth of another helix angle or hand, double helical and internal ones: their middle may well lie on the design."""
    if (gear.spec.gap > 0.0 or fitting < SUFFICIENT_SHARE_ON_DESIGN) and (otherwise := runs_otherwise(placed.measured, gear)):
        raise NotThisGear(placed.measured, False, _not_this(otherwise))
    z = placed.located.position[:, 2] - 0.5 * gear.face_width
    whole, *halves = (_twist(placed.located.take(within), gear) for within in (z == z, z < 0.0, z > 0.0))
    steep = math.tan(math.radians(HELICAL)) / gear.tip_radius
    both = [abs(half) for half in halves]
    double = min(both) > steep and halves[0] * halves[1] < 0.0
    if gear.spec.gap > 0.0:
        double = False
        if max(both) > steep or _half_off(placed, gear):
            reason = f"its teeth run otherwise along the face than those of the design, {_helix(gear)}"
            raise NotThisGear(placed.measured, False, _not_this(reason))
    if abs(whole) > steep and not double and fitting < SUFFICIENT_SHARE_ON_DESIGN:  # too few to say how they do run
        lie = f"{100 * fitting:.0f} % of its points lie on the design of {gear.teeth} teeth{helix_words(gear)}"
        reason = f"{lie}, and its teeth run otherwise along the face"
    elif abs(whole) > steep or double:
        seen = "double helical" if double else _seen_helix(gear, whole)
        reason = f"the teeth of the scan are {seen}, and the design is {_helix(gear)}"
    elif fitting < SUFFICIENT_SHARE_ON_DESIGN and _lies_outward(placed.measured, gear):
        reason = f"the lands of the scan lie further {'in' if gear.spec.internal else 'out'} than the design's, on tip diameter {2 * gear.tip_radius:.2f} mm, and its flanks do not"
    elif _metal_between(placed.measured, gear):
        other = (
            "an external gear, and the design is of a ring"
            if gear.spec.internal
            else "a ring, and the design is of an external gear"
        )
        reason = f"the end faces of the scan lie between the teeth of the design: that is {other}"
    else:
        return
    raise NotThisGear(placed.measured, False, _not_this(reason))


def runs_otherwise(points: Floats, gear: Gear) -> str:
    """How the teeth of a scan run, in words, where by their normals they run otherwise than the design's; else "".

    Teeth of another hand cross those of the design, which then have too few of their points to say it by deviations.
    """
    sample, outer, inner = fine_sample(points), *sorted((gear.tip_radius, gear.root_radius), reverse=True)
    height = sample.points[:, 2] - 0.5 * gear.face_width
    seen, drawn = [], []
    for end, half in zip((-1.0, 1.0), (segments(gear)[0], segments(gear)[-1]), strict=True):
        within = end * height > 0.5 * gear.spec.gap
        seen.append(normal_twist(sample.points[within], sample.normals[within], outer, inner))
        drawn.append(half.twist)
    if not all(seen):  # too few points on flanks
        return ""
    steep = math.tan(math.radians(HELICAL)) / gear.tip_radius
    off = [abs(twist - design) > max(steep, ANOTHER_ANGLE * abs(design)) for twist, design in zip(seen, drawn, strict=True)]
    if not any(off):
        return ""
    hands = [math.copysign(1.0, twist) for twist in seen]
    if min(abs(twist) for twist in seen) > steep and hands[0] != hands[1]:
        kind = "double helical"
    elif gear.spec.gap > 0.0 and off.count(True) == 1:
        hand = "right" if hands[0] > 0.0 else "left"
        return f"its teeth are {hand} hand over the whole face, as those of one half are, and the design is double helical, {_helix(gear)}"
    else:
        more = float(np.mean(seen)) - gear.twist
        if gear.spec.gap == 0.0 and abs(more) <= max(steep, ANOTHER_ANGLE * abs(gear.twist)):
            return ""  # normals of few points scatter: one half is off, and both together are as drawn
        kind = _seen_helix(gear, more)
    return f"the teeth of the scan are {kind}, and the design is {_helix(gear)}"


def _half_off(placed: PlacedScan, gear: Gear) -> bool:
    """Whether on a half of a double helical design the flanks of both sides lie off it: there the scan has another hand."""
    z = placed.located.position[:, 2]
    halves = [flanks_off(placed.located.take((z > half.low) & (z < half.high))) for half in segments(gear)]
    return max(half.distance for half in halves) > MAX_DISTANCE_WITHOUT_LANDS_MODULES * gear.transverse_module


def _not_this(reason: str) -> str:
    return f"the scan is not of this gear: {reason}; check the design, part and units"


def _seen_helix(gear: Gear, more: float) -> str:
    """Teeth that turn by `more` rad/mm than the design's, in words. By how much says what finds the angle from the scan alone
    (`gearwear.identify`): here points far off the design were left out, or normals of few points are meaned, and another number would stand beside that."""
    angle = math.degrees(math.atan(gear.reference_radius * (gear.twist + more)))
    if abs(angle) < HELICAL:
        return "spur"
    drawn = math.degrees(gear.helix_angle)
    other = f", of a {'larger' if abs(angle) > abs(drawn) else 'smaller'} helix angle" if angle * drawn > 0.0 else ""
    return f"helical, {'right' if angle > 0.0 else 'left'} hand{other}"


def _helix(gear: Gear) -> str:
    """Kind of the design in words."""
    return "of a spur gear" if gear.twist == 0.0 else f"{gear.spec.hand} hand, helix_angle = {math.degrees(gear.helix_angle):g}"


def _twist(points: SurfacePoints, gear: Gear) -> float:
    """How much more than the design's the flanks turn with the height, rad/mm, + right hand; 0 where too little was seen.

    Of each side the median over its flanks of the slope along z, of both the mean: crowned and tapered teeth and a tilted axis cancel.
    The helix deviations of gears are a hundred times less than another helix angle shows.
    """
    flanks = points.take(points.surface == FLANK)
    flank = flanks.tooth.astype(np.int64) + gear.teeth * (flanks.side > 0)
    z, d = flanks.position[:, 2] - 0.5 * gear.face_width, flanks.side * flanks.deviation
    n, sz, sd, szz, szd = (np.bincount(flank, w, minlength=2 * gear.teeth) for w in (np.ones(len(flanks)), z, d, z * z, z * d))
    spread = n * szz - sz * sz
    enough = (n >= 20.0) & (spread > (0.05 * n * gear.face_width) ** 2)
    slope = np.where(enough, n * szd - sz * sd, 0.0) / np.where(enough, spread, 1.0) / gear.normal_lever
    sides = [slope[part][enough[part]] for part in (slice(gear.teeth), slice(gear.teeth, None))]
    if min(len(side) for side in sides) < 0.5 * gear.teeth:
        return 0.0
    return float(np.mean([np.median(side) for side in sides]))


def _some(points: Floats, gear: Gear) -> Floats:
    """Some of the points, of many, whatever their order."""
    radius, from_middle = np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2] - 0.5 * gear.face_width)
    return points[some_of(radius / gear.transverse_module, from_middle / gear.transverse_module, SAMPLE)]


def _metal_between(points: Floats, gear: Gear) -> bool:
    """Whether at both ends points lie between the design's teeth, and none in them: the end faces of a ring."""
    sample = untwisted(gear, _some(points, gear))
    radius, height = np.hypot(sample[:, 0], sample[:, 1]), sample[:, 2]
    way, off = gear.orientation, 0.1 * abs(gear.tip_radius - gear.root_radius)
    ring = way * (radius - gear.form_radius) > 0.0
    ring &= (way * (radius - gear.root_radius) > off) & (way * (radius - gear.tip_radius) < -off)
    sample, radius, height = sample[ring], radius[ring], height[ring]
    if not len(sample):
        return False
    outside = _off_middle(sample, radius, gear) - radius * gear.half_angle(radius)
    low, high = np.quantile(height, [0.01, 0.99])
    ends = [np.abs(height - end) < 0.05 * (high - low) for end in (low, high)]
    tooth, space = ([int((end & part).sum()) for end in ends] for part in (outside < -off, outside > off))
    return min(space) >= LEAST_RIM and sum(space) > 3 * sum(tooth)


def _lies_outward(points: Floats, gear: Gear) -> bool:
    """Whether both lands lie further out than the design's by more than any tolerance: as those of a ring, whose spaces its teeth would fill."""
    seen = rims(points, gear)
    least = min(gear.orientation * off for off in (seen.tip_radius - gear.tip_radius, seen.root_radius - gear.root_radius))
    return least > LAND_OFF * gear.transverse_module


def base_radius(points: SurfacePoints, gear: Gear) -> float:
    """Radius of the base circle that located flanks are of, mm; nan where too little of them was seen.

    Notes
    -----
    An involute of a base circle r_b + Δ leaves that of r_b by a straight line in roll length: dδ/dL = ι Δ / r_b · cos β_b to first order. Of each
    side the median over its teeth, of both sides the one nearer to the design: wear slopes the flanks that carried. The outer tenths of flank
    and face are left out: edges are rounded.
    """
    slopes = []
    share, height = (
        (points.own_roll(gear) - gear.form_roll) / (gear.tip_roll - gear.form_roll),
        points.own_height / gear.face_width,
    )
    inner = (np.abs(share - 0.5) < INNER) & ((np.abs(height - 0.5) < INNER) | ~(np.ptp(height[np.isfinite(height)]) > INNER))
    if inner.sum() >= LEAST_FLANK:
        points = points.take(inner)
    for side in (1, -1):
        flanks = points.take((points.surface == FLANK) & (points.side == side))
        n, roll, off, square, product = (
            np.bincount(flanks.tooth, w, minlength=gear.teeth)
            for w in (np.ones(len(flanks)), flanks.roll, flanks.deviation, flanks.roll**2, flanks.roll * flanks.deviation)
        )
        enough = (n >= 20.0) & (n > 0.2 * len(flanks) / gear.teeth)
        if enough.any():
            slopes.append(float(np.median((n * product - roll * off)[enough] / (n * square - roll**2)[enough])))
    return gear.base_radius * (1.0 + gear.orientation * min(slopes, key=abs, default=np.nan) / gear.base_helix_cosine)


@dataclass(frozen=True, slots=True)
class Rims:
    """Where the tip and bottom lands of a scan lie.

    Parameters
    ----------
    tip_radius, root_radius : float
        Median distance of their points from the axis, mm; nan where too few were seen.
    """

    tip_radius: float
    root_radius: float


def rims(points: Floats, gear: Gear) -> Rims:
    """The radii of the lands of a scan in the design frame, (n, 3) mm, whatever the design says.

    Notes
    -----
    Away from the ends there is nothing on a tooth's centre line but its tip, and nothing on a space's but its root.
    """
    sample = untwisted(gear, _some(points, gear))
    share = sample[:, 2] / gear.face_width
    sample = sample[(share > 0.05) & (share < 0.95)]
    radius, m = np.hypot(sample[:, 0], sample[:, 1]), gear.transverse_module
    turns = np.arctan2(sample[:, 1], sample[:, 0]) / gear.pitch_angle
    off = np.abs(turns - np.rint(turns))
    land = float(gear.half_angle(np.array([gear.tip_radius]))[0]) / gear.pitch_angle
    way = gear.orientation
    tip = radius[(off < 0.5 * land) & (way * (radius - gear.reference_radius) > 0.0) & (way * (radius - gear.tip_radius) < m)]
    root = radius[(off > 0.47) & (np.abs(radius - gear.root_radius) < 0.5 * m)]
    return Rims(*(float(np.median(radii)) if len(radii) >= LEAST_RIM else np.nan for radii in (tip, root)))


@dataclass(frozen=True, slots=True)
class SeenRadii:
    """What a scan itself shows of the gear's size, to hold against the design, mm; nan where too little was seen.

    Parameters
    ----------
    base : float
        Radius of the base circle that the flanks are of.
    tip, root : float
        Where the tip and bottom lands lie.
    thicker : float
        By how much the teeth are thicker than the design's, normal arc at the reference circle.
    """

    base: float
    tip: float
    root: float
    thicker: float = math.nan


def seen_radii(placed: PlacedScan, gear: Gear) -> SeenRadii:
    """Base, tip and root radius by the scan."""
    lands = rims(placed.measured, gear)
    return SeenRadii(base_radius(placed.located, gear), lands.tip_radius, lands.root_radius, thicker_by(placed.located, gear))


def thicker_by(points: SurfacePoints, gear: Gear) -> float:
    """By how much teeth are thicker than the design's, mm of normal arc at the reference circle; nan where a side was hardly seen.

    The median of each side's points counts, both together: the pose may give one side what it takes off the other.
    """
    off = [points.deviation[(points.surface == FLANK) & (points.side == side)] for side in (1, -1)]
    if min(map(len, off)) < LEAST_FLANK:
        return math.nan
    return float(sum(np.median(side) for side in off)) / normal_loss(gear, 1.0)


def width_seen(points: Floats, gear: Gear) -> float:
    """The face width of a scan, mm, where it is not the design's but near it; refused where it is neither. `points` in the design frame, mm."""
    sample = untwisted(gear, _some(points, gear))
    radius, height = np.hypot(sample[:, 0], sample[:, 1]), sample[:, 2]
    b, m = gear.face_width, gear.transverse_module
    flat = sample.copy()
    flat[:, 2] = drawn_height(gear)
    on = locate(flat, gear)
    flank = (on.surface == FLANK) & (np.abs(on.deviation) < 0.1 * m)
    if flank.sum() < LEAST_FLANK:
        return b
    # A groove is no gap of the scan's.
    gap, upper = gear.spec.gap, height > 0.5 * b
    low, high = _reach(np.where(upper, height - gap, height)[flank] if gap > 0.0 else height[flank], b - gap)
    high += gap
    # Inside the metal of a tooth, away from its sides, there is nothing but an end face.
    off, way = _off_middle(sample, radius, gear), gear.orientation
    tooth = (way * (radius - gear.form_radius) > 0.0) & (way * (radius - gear.tip_radius) < -0.1 * m)
    half = np.zeros(len(sample))
    half[tooth] = radius[tooth] * gear.half_angle(radius[tooth])
    inside = height[tooth & (off < half - 0.2 * m)]
    ends = [_face(inside, end, b) for end in (low, high)]
    seen = [end if face is None else face for end, face in zip((low, high), ends, strict=True)]
    width, both = seen[1] - seen[0], None not in ends
    excess = width - b if both else max(width - b, 0.0)
    if abs(excess) > OTHER_WIDTH * b + 0.1 * m:
        raise InputError(
            f"the teeth of the scan are {'' if both else 'at least '}{width:.4g} mm wide, and the design's face_width is {b:g} mm; check it"
        )
    return b if abs(excess) <= SAME_WIDTH * b + 0.02 * m else round(width, 3)


def _off_middle(untwisted: Floats, radius: Floats, gear: Gear) -> Floats:
    """(n,) arcs from the middle of the tooth at that place, mm."""
    pitch, angle = gear.pitch_angle, np.arctan2(untwisted[:, 1], untwisted[:, 0])
    return np.asarray(np.abs(np.mod(angle + 0.5 * pitch, pitch) - 0.5 * pitch) * radius)


def _reach(height: Floats, width: float) -> tuple[float, float]:
    """Heights between which the flanks go on without a gap."""
    step = width / 8.0
    index = np.floor(height / step).astype(np.int64)
    index -= index.min()
    count = np.bincount(index)
    middle = int(np.sort(index)[len(index) // 2])  # one that holds points: those of a CAD model stand at the ends alone
    gaps = np.flatnonzero(count < 0.3 * np.median(count[count > 0]))
    first, last = gaps[gaps < middle].max(initial=-1), gaps[gaps > middle].min(initial=len(count))
    low, high = np.quantile(height[(index > first) & (index < last)], [0.002, 0.998])
    return float(low), float(high)


def _face(height: Floats, end: float, width: float) -> float | None:
    """Height of the end face near `end`; None where there is none."""
    near = height[np.abs(height - end) < 0.1 * width]
    centre, scale = median_scale(near)
    return centre if len(near) >= LEAST_FACE_POINTS and scale < 0.02 * width else None
