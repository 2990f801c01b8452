"""Path of contact of a pair, external or with a ring, in the transverse section, with its limits, and the sliding along it.

Positions on the line of action are lengths of roll L, measured on each gear from its own base circle; on the
path ``L_1 + L_2 = a_w sin α_wt``, with a ring ``L_2 − L_1 = a_w sin α_wt``; a ring may stand first, where its own flank is looked at. Points in the order of contact when the pinion drives: A start of the path,
B lowest and D highest point of single contact, C pitch point, E end (ISO 21771:2007).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.pair import overlap_ratio, path_ends, reached_roll
from gearwear.design.quantity import as_given, at_least, at_most
from gearwear.errors import InputError
from gearwear.meshing.backlash import operating_pitch_radii, working_pressure_angle

PathLimit = Literal["mate's tip", "form circle"]
"""What ends the path: the mate has no more tooth, or the gear's own root has taken the involute away."""


@dataclass(frozen=True, slots=True)
class PathOfContact:
    """Where the involutes of a pair touch; lengths of roll in mm.

    Parameters
    ----------
    line : float
        a_w sin α_wt, from one base circle's point of tangency (interference point) to the other's; negative in a ring, where the contact
        lies beyond both.
    start_pinion, end_pinion : float
        L_1 at A and at E: the pinion's start (SAP) and end (EAP) of active profile; rising, so that a ring that stands first starts at its tip.
    start_gear, end_gear : float
        L_2 at E and at A: the gear's SAP, nearest its root, and EAP; of a ring the SAP is the larger one.
    pitch_pinion, pitch_gear : float
        L_1 and L_2 at the pitch point C.
    base_pitch : float
        p_bt in mm.
    limit_pinion, limit_gear : {"mate's tip", "form circle"}
        What sets each gear's SAP. "form circle": the mate reaches deeper, but there is no involute to meet.
    overlap_ratio : float
        ε_β = b tan β_b / p_bt of the common face width: pitches by which one end face is ahead of the other; 0 for spur gears.
    orientation : int
        −1 where one of both is a ring: L_2 rises with L_1 then; else +1.
    """

    line: float
    start_pinion: float
    end_pinion: float
    start_gear: float
    end_gear: float
    pitch_pinion: float
    pitch_gear: float
    base_pitch: float
    limit_pinion: PathLimit
    limit_gear: PathLimit
    overlap_ratio: float
    orientation: int

    @property
    def length(self) -> float:
        """g_α, from A to E, mm."""
        return self.end_pinion - self.start_pinion

    @property
    def approach(self) -> float:
        """g_f, from A to the pitch point (pinion driving), mm; negative where the path starts past it."""
        return self.pitch_pinion - self.start_pinion

    @property
    def recess(self) -> float:
        """g_a, from the pitch point to E (pinion driving), mm."""
        return self.end_pinion - self.pitch_pinion

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio ε_α = g_α / p_bt."""
        return self.length / self.base_pitch

    @property
    def total_contact_ratio(self) -> float:
        """ε_γ = ε_α + ε_β: pitches from where a pair first touches, at one end face, to where it last does, at the other."""
        return self.contact_ratio + self.overlap_ratio

    def ratio_words(self, digits: int = 4) -> str:
        """Contact ratio in words: one number for spur gears, the sum of two for helical ones."""
        if self.overlap_ratio == 0.0:
            return f"{self.contact_ratio:.{digits}f}"
        ratios = (self.contact_ratio, self.overlap_ratio, self.total_contact_ratio)
        return "{} + overlap {} = {}".format(*(f"{ratio:.{digits}f}" for ratio in ratios))

    @property
    def single_contact_pinion(self) -> tuple[float, float]:
        """L_1 at B and at D of a spur pair. Between them one pair carries alone if 1 ≤ ε_α < 2; see `alone_pinion` for every case."""
        return self.end_pinion - self.base_pitch, self.start_pinion + self.base_pitch

    def roll_gear(self, roll_pinion: ArrayLike) -> Floats:
        """L_2 where the pinion is touched at L_1, mm."""
        return np.abs(self.line - np.asarray(roll_pinion, dtype=np.float64))

    @property
    def alone_pinion(self) -> tuple[float, float] | None:
        """L_1 between which one pair carries alone: B to D, the whole path where ε_α ≤ 1, None from ε_α = 2 on.

        None for helical gears: where along the face a pair touches changes all the time, and whether it is alone is no matter of L_1.
        """
        low, high = self.single_contact_pinion
        return None if low >= high or self.overlap_ratio > 0.0 else (max(low, self.start_pinion), min(high, self.end_pinion))

    @property
    def alone_gear(self) -> tuple[float, float] | None:
        """The same in L_2, rising."""
        alone = self.alone_pinion
        if alone is None:
            return None
        low, high = sorted((abs(self.line - alone[1]), abs(self.line - alone[0])))
        return low, high

    @property
    def named_points(self) -> dict[str, float]:
        """The named points of the path by their roll on the pinion, mm, in the order of contact; those that are on it."""
        points = {"A": self.start_pinion, "E": self.end_pinion}
        if self.start_pinion < self.pitch_pinion < self.end_pinion:
            points["C"] = self.pitch_pinion
        if 1.0 < self.contact_ratio < 2.0 and self.overlap_ratio == 0.0:
            points["B"], points["D"] = self.single_contact_pinion
        return dict(sorted(points.items(), key=lambda point: point[1]))


def path_of_contact(pinion: Gear, gear: Gear, centre_distance: float) -> PathOfContact:
    """Path of contact, ended by tips **and** by form circles.

    Parameters
    ----------
    pinion, gear : Gear
        The pair; either of them may be a ring.
    centre_distance : float
        Working centre distance in mm.

    Returns
    -------
    PathOfContact

    Raises
    ------
    InputError
        If the base pitches differ, the base circles meet or the gears do not reach each other.

    Notes
    -----
    ``L_1(A) = max(L_form1, a_w sin α_wt − L_tip2)``, ``L_1(E) = min(L_tip1, a_w sin α_wt − L_form2)``. A hobbed root
    removes the involute below the form circle; a path that runs on to the interference point counts metal that is not
    there.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> path = path_of_contact(pinion, gear, 114.3)
    >>> round(path.length, 3), round(path.contact_ratio, 4), path.limit_pinion
    (23.516, 1.2544, 'form circle')
    """
    alpha, orientation = working_pressure_angle(pinion, gear, centre_distance), pinion.orientation * gear.orientation
    line = gear.orientation * centre_distance * math.sin(alpha)
    pitch_radius, mate_pitch_radius = operating_pitch_radii(pinion, gear, centre_distance)
    start, end = path_ends(pinion, gear, line)
    if end <= start:
        raise InputError(
            f"centre distance = {as_given(centre_distance)} mm: the gears do not reach each other, the path of contact is empty"
        )
    return PathOfContact(
        line=line,
        start_pinion=start,
        end_pinion=end,
        start_gear=abs(line - end),
        end_gear=abs(line - start),
        pitch_pinion=pitch_radius * math.sin(alpha),
        pitch_gear=mate_pitch_radius * math.sin(alpha),
        base_pitch=pinion.base_pitch,
        limit_pinion=_limit(pinion, gear, line),
        limit_gear=_limit(gear, pinion, line),
        overlap_ratio=overlap_ratio(pinion, gear),
        orientation=orientation,
    )


def _limit(gear: Gear, mate: Gear, line: float) -> PathLimit:
    reached = reached_roll(gear, mate, abs(line))
    return "form circle" if gear.orientation * (gear.form_roll - reached) > 0.0 else "mate's tip"


def radius_at_roll(gear: Gear, roll: ArrayLike) -> Floats:
    """Radius in mm of the flank point with length of roll `roll` (mm): ``hypot(r_b, L)``."""
    return np.asarray(np.hypot(gear.base_radius, np.asarray(roll, dtype=np.float64)), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Sliding:
    """Motion of two flanks over each other, per contact position.

    Parameters
    ----------
    roll_pinion, roll_gear : (n,) float
        L_1 and L_2 of the contact, mm.
    velocity : (n,) float
        Sliding velocity per angular velocity of the pinion, mm (mm/s at 1 rad/s): ``(1 + 1/u)(L_1 − L_1C)``, where one is a ring ``(1 − 1/u)(L_1 − L_1C)``;
        negative before the pitch point, where the mate slides towards the pinion's root.
    specific_pinion, specific_gear : (n,) float
        ``K_1 = 1 − L_2/(u L_1)``, ``K_2 = 1 − u L_1/L_2``, ring or not: sliding over a flank's own rolling velocity. −inf at
        its own base circle.
    equivalent_radius : (n,) float
        L_1 L_2/((L_1 + L_2) cos β_b), with a ring L_1 L_2/((L_2 − L_1) cos β_b), radius of the cylinder on a plane that touches alike, mm; square to the line of contact.
    """

    roll_pinion: Floats
    roll_gear: Floats
    velocity: Floats
    specific_pinion: Floats
    specific_gear: Floats
    equivalent_radius: Floats


def sliding(pinion: Gear, gear: Gear, centre_distance: float, roll_pinion: ArrayLike) -> Sliding:
    """Sliding where the pinion's flank is touched at given lengths of roll.

    Parameters
    ----------
    pinion, gear : Gear
        The pair; either of them may be a ring.
    centre_distance : float
        Working centre distance in mm.
    roll_pinion : (n,) float
        L_1 in mm, from 0 to a_w sin α_wt, in a ring from 0, of a ring from a_w sin α_wt.

    Returns
    -------
    Sliding

    Raises
    ------
    InputError
        If a length of roll lies outside the line of action.

    Notes
    -----
    From the speeds of the two flanks at the point of contact, along their common tangent in the transverse section: helical gears on
    parallel axes slide in no other direction.
    """
    line = gear.orientation * centre_distance * math.sin(working_pressure_angle(pinion, gear, centre_distance))
    orientation = pinion.orientation * gear.orientation
    roll = np.asarray(roll_pinion, dtype=np.float64)
    least, most = (0.0, line) if orientation > 0 else (max(line, 0.0), math.inf)
    if not ((roll >= least) & (roll <= most)).all():
        raise InputError(
            f"length of roll: must lie from {at_least(least) if least else 0} to {at_most(most) if math.isfinite(most) else most} mm, got {as_given(roll.min())} … {as_given(roll.max())}"
        )
    mate = line - roll  # where one of both is a ring negative, as the ratio of the teeth
    ratio = orientation * gear.teeth / pinion.teeth
    with np.errstate(divide="ignore"):
        specific_own, specific_mate = 1.0 - mate / (ratio * roll), 1.0 - ratio * roll / mate
    radius = np.abs(roll * mate / (line * pinion.base_helix_cosine))
    return Sliding(roll, np.abs(mate), roll - mate / ratio, specific_own, specific_mate, radius)
