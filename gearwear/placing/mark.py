"""Tooth 1 by a mark of the gear: a keyway, a punch mark, a notch, a hole. Where it stands, how sure that is, and which end it is on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.quantity import counted, with_std
from gearwear.design.scan_spec import DatumMark
from gearwear.design.twist import wrapped_angle
from gearwear.errors import InputError
from gearwear.placing.pose import Pose, about_z, flip

LEAST_POINTS = 8
"""Of a mark, lying together."""
OTHER_PLACES = 0.25
"""Share of the mark's points from which those at another place are a second mark."""
REACH = 0.6
"""Widths from its middle within which a point is the mark's: half, and some for what was stated."""
INSET = 0.1
"""Share of the face width, at either end, in which no keyway is looked for: edges and chamfers."""
KEYWAY_DEPTH = (0.1, 0.7)
"""Widths beyond the bore between which a keyway is looked for; keyways to DIN 6885 are 0.2 to 0.5 of their width deep."""
EDGES = (2.0, 98.0)
"""Percentiles of its points across that are its edges, a stray aside."""
SETTLED_ROUNDS = 4
"""Of its middle from its points, and its points from the middle."""
SECTORS, ALL_ROUND = 36, 0.5
"""Of a turn, and the share of them from which points lie all round."""
SURE = 0.95
"""Chance of the tooth that is taken, below which a mark tells none."""


@dataclass(frozen=True, slots=True)
class SeenMark:
    """The mark as the scan shows it.

    Parameters
    ----------
    off : float
        By how much it stands counter-clockwise of where the design has it, once the teeth are numbered by it, rad: half a pitch at most.
    std : float
        Of that, rad.
    points : int
        Of it.
    chance : float
        That no other tooth is nearer.
    end_told : bool
        Whether it also told which end is up: it would be elsewhere with the gear upside down.
    """

    off: float
    std: float
    points: int
    chance: float
    end_told: bool

    @property
    def sentence(self) -> str:
        """How tooth 1 was told."""
        stands = with_std(math.degrees(self.off), math.degrees(self.std), "°")
        end = "and tells which end is up" if self.end_told else "but does not tell which end is up"
        return f"tooth 1 is told by the mark: it stands {stands} off where the design has it ({100.0 * self.chance:.4g} % sure), {end}"


@dataclass(frozen=True, slots=True)
class MarkRing:
    """A ring about the axis that holds the mark and nothing else.

    Parameters
    ----------
    radius, z : (float, float)
        From where to where, mm.
    width : float
        Of the mark, mm.
    """

    radius: tuple[float, float]
    z: tuple[float, float]
    width: float

    @classmethod
    def of(cls, mark: DatumMark, gear: Gear, planar: bool) -> MarkRing:
        """Where the mark of a gear lies; a planar section has no heights."""
        radius, z = mark.radius, mark.z
        if radius is None:
            if gear.body_radius == 0.0:
                body = "bore_diameter" if gear.orientation > 0 else "rim_diameter"
                raise InputError(f"[datum] mark: radius_mm says where it lies, or {body} in the design that it is a keyway there")
            ends = sorted(gear.body_radius + gear.orientation * depth * mark.width for depth in KEYWAY_DEPTH)
            radius = (ends[0], ends[1])
        if planar:
            z = (-math.inf, math.inf)
        elif z is None:
            z = (INSET * gear.face_width, (1.0 - INSET) * gear.face_width)
        if mark.width > radius[1]:
            raise InputError(f"[datum] mark width_mm = {mark.width:g}: at most the radius, {radius[1]:g} mm, would be right")
        return cls(radius, z, mark.width)

    def words(self) -> str:
        """Where it is, for messages."""
        where = f"{self.radius[0]:.4g} … {self.radius[1]:.4g} mm off the axis"
        return where if math.isinf(self.z[0]) else f"{where}, z {self.z[0]:.4g} … {self.z[1]:.4g} mm"


@dataclass(frozen=True, slots=True)
class _Look:
    """What a ring holds: a direction with its standard deviation (rad) and the points that say it; or why it tells none."""

    points: int
    direction: float = math.nan
    std: float = math.nan
    why_not: str = ""


def number_by_mark(points: Floats, gear: Gear, mark: DatumMark, planar: bool = False) -> tuple[Pose, SeenMark]:
    """The motion that makes the tooth at the mark tooth 1, and how sure that is.

    Parameters
    ----------
    points : (n, 3) float
        The whole scan in the design frame, mm.
    gear : Gear
    mark : DatumMark
        Where it is looked for, and where on the design it stands.
    planar : bool
        Whether the scan is a planar section.

    Returns
    -------
    motion : Pose
        A symmetry of the gear.
    seen : SeenMark

    Raises
    ------
    InputError
        If no mark is there, points lie at several places, or two teeth are as near.

    Notes
    -----
    A gear looks alike on its other end, so the mark is looked for both ways up (not on double helical gears, whose hands tell their ends). Seen in
    one of them, it tells which end is up; seen in both, the gear stays as it lies.

    Its direction is the middle between its edges across, which the number of points on either wall does not move. What it was seen narrower than stated
    may be missing at either edge: evenly distributed, a standard deviation of ``(w − seen) / (2 √3)``.
    """
    ring = MarkRing.of(mark, gear, planar)
    told = gear.spec.gap > 0.0
    lays = [Pose.identity()] if planar or told else [Pose.identity(), flip(gear.face_width)]
    looks = [_look(lay.apply(points), ring) for lay in lays]
    most = max((look.points for look in looks if not look.why_not), default=0)
    seen = [not look.why_not and look.points >= OTHER_PLACES * most for look in looks]
    if not any(seen):
        raise InputError(f"[datum] mark: {max(looks, key=lambda look: look.points).why_not}; check radius_mm, z_mm and width_mm")
    lay = seen.index(True)
    look, pitch = looks[lay], gear.pitch_angle
    away = (look.direction - mark.angle) / pitch
    teeth = round(away)
    off = (away - teeth) * pitch
    chance = 0.5 * sum(math.erf((0.5 * pitch + way * off) / (math.sqrt(2.0) * look.std)) for way in (-1.0, 1.0))
    if chance < SURE:
        degrees = math.degrees(mark.angle + off)
        raise InputError(
            f"[datum] mark: it stands {abs(off) / pitch:.2f} ± {look.std / pitch:.2g} pitches off tooth 1, and the next tooth may be as near; "
            f"angle_deg = {degrees:.4g} would be right if that is where it stands, or more points of it"
        )
    motion = lays[lay].then(about_z(-teeth * pitch))
    return motion, SeenMark(off, look.std, look.points, chance, told or (len(lays) > 1 and sum(seen) == 1))


def _look(points: Floats, ring: MarkRing) -> _Look:
    """What lies in the ring, and in which direction."""
    radius = np.hypot(points[:, 0], points[:, 1])
    inside = (radius >= ring.radius[0]) & (radius <= ring.radius[1]) & (points[:, 2] >= ring.z[0]) & (points[:, 2] <= ring.z[1])
    radius, angle = radius[inside], np.arctan2(points[inside, 1], points[inside, 0])
    if len(angle) < LEAST_POINTS:
        return _Look(
            len(angle), why_not=f"none is seen: {counted(len(angle), 'point')} {ring.words()}, at least {LEAST_POINTS} are needed"
        )
    reach = REACH * ring.width
    window = 2.0 * reach / float(np.median(radius))
    middle = _densest(angle, window)
    for _ in range(SETTLED_ROUNDS):
        turned = wrapped_angle(angle - middle)
        across = radius * np.sin(turned)
        its = (np.abs(turned) < 0.5 * math.pi) & (np.abs(across) <= reach)
        low, high = np.percentile(across[its], EDGES) if its.any() else (0.0, 0.0)
        middle += 0.5 * (low + high) / float(np.median(radius))
    number, rest = int(its.sum()), angle[~its]
    if number < LEAST_POINTS:
        return _Look(number, why_not=f"none is seen, of {len(angle)} points {ring.words()} no more than {number} lie together")
    second = _within(rest, _densest(rest, window), window) if len(rest) else 0
    if second > OTHER_PLACES * number:
        sectors = len(np.unique(np.floor((angle + math.pi) / (2.0 * math.pi / SECTORS))))
        places = "all round" if sectors > ALL_ROUND * SECTORS else "at several places"
        return _Look(number, why_not=f"points lie {places}, {ring.words()}, where nothing but one mark should")
    extent = float(high - low)
    std = math.hypot(0.5 * extent / math.sqrt(number), max(ring.width - extent, 0.0) / (2.0 * math.sqrt(3.0)))
    return _Look(number, float(wrapped_angle(np.array(middle))), std / float(np.median(radius[its])))


def _densest(angle: Floats, window: float) -> float:
    """Mean of the angles in that window (rad) which holds the most of them."""
    ordered = np.sort(angle)
    twice = np.concatenate([ordered, ordered + 2.0 * math.pi])
    count = np.searchsorted(twice, ordered + window, side="right") - np.arange(len(ordered))
    first = int(np.argmax(count))
    return float(twice[first : first + int(count[first])].mean())


def _within(angle: Floats, middle: float, window: float) -> int:
    """How many angles lie in a window about a middle."""
    return int((np.abs(wrapped_angle(angle - middle)) <= 0.5 * window).sum())
