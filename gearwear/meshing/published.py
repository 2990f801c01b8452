"""The published calculation, as printed: wear to backlash, to a centre distance, to contact lengths.

Kumar, Jain and Pathak, ICPME'2014, pp. 57-61, doi 10.15242/IAE.IAE1214203. It is kept as the authors print it, signs
included, because reports have to be comparable with theirs. What is first order or wrong in it is said function by
function; `exact` has the right relations, and ``python -m gearwear.paper`` sets the two side by side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.gear import Gear
from gearwear.design.spec import Baseline
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError
from gearwear.meshing.backlash import operating_pitch_radii, working_pressure_angle


@dataclass(frozen=True, slots=True)
class PublishedMeshing:
    """The published calculation's numbers; mm and rad.

    Parameters
    ----------
    thickness_loss : float
        B′, the tooth thickness lost.
    backlash_allowance : float
        What the design allows.
    baseline : Baseline
        What B′ was measured from.
    backlash : float
        B, what is put into the formula for the centre distance.
    centre_distance_change : float
        Δc, negative where the calculation moves the shafts apart.
    centre_distance : float
        c′ = c − Δc.
    pressure_angle : float
        θ′ at c′.
    pitch_radius_pinion, pitch_radius_gear : float
        Operating pitch radii at c′.
    contact_length_design, contact_length_worn : float
        l at c and l′ at c′.
    """

    thickness_loss: float
    backlash_allowance: float
    baseline: Baseline
    backlash: float
    centre_distance_change: float
    centre_distance: float
    pressure_angle: float
    pitch_radius_pinion: float
    pitch_radius_gear: float
    contact_length_design: float
    contact_length_worn: float


def backlash_from_loss(thickness_loss: float, allowance: float, baseline: Baseline) -> float:
    """B in mm from the loss B′ (mm) and the design's allowance (mm).

    ``zero_backlash``: ``B = B′ − allowance``, as printed. A loss measured from a drawing without backlash has the
    allowance in it, and what is over is wear. ``with_allowance`` and ``pre_wear_scan``: ``B = B′ + allowance``. Such a loss
    is wear alone, and the play in service has the allowance besides. (The paper subtracts although it measured from a
    scan before wear.)

    >>> round(backlash_from_loss(1.992, 0.2286, Baseline.ZERO_BACKLASH), 4)
    1.7634
    >>> round(backlash_from_loss(1.992, 0.2286, Baseline.PRE_WEAR_SCAN), 4)
    2.2206
    """
    return thickness_loss - allowance if baseline is Baseline.ZERO_BACKLASH else thickness_loss + allowance


def centre_distance_change(
    circular_pitch: float, thickness_pinion: float, thickness_gear: float, backlash: float, pressure_angle: float
) -> float:
    """Δc = (p − t1 − t2 − B) / (2 tan θ), the paper's eq. 7, in mm; its new centre distance is c − Δc.

    First order: the teeth are taken for straight racks (8.9 % too little backlash at the paper's own distance). With
    t1 = t2 = p/2, as the paper has it, this is where **unworn** gears would have the backlash B, hence the minus sign: it
    describes the play, and would not take it up.

    >>> round(centre_distance_change(19.949113, 9.9745565, 9.9745565, 1.7634, math.radians(20.0)), 3)
    -2.422
    """
    return (circular_pitch - thickness_pinion - thickness_gear - backlash) / (2.0 * math.tan(pressure_angle))


def contact_length(
    tip_radius_pinion: float,
    tip_radius_gear: float,
    base_radius_pinion: float,
    base_radius_gear: float,
    centre_distance: float,
    pressure_angle: float,
) -> float:
    """l = sqrt(R_a² − R_b²) + sqrt(r_a² − r_b²) − c sin θ, mm: the path of contact if both flanks reached their base circles.

    It ignores undercut and interference, so it can be longer than the flanks are; `path_of_contact` does not.
    """
    pinion = math.sqrt(tip_radius_pinion**2 - base_radius_pinion**2)
    gear = math.sqrt(tip_radius_gear**2 - base_radius_gear**2)
    return pinion + gear - centre_distance * math.sin(pressure_angle)


def published_meshing(
    pinion: Gear,
    gear: Gear,
    centre_distance: float,
    thickness_loss: float,
    allowance: float = 0.0,
    baseline: Baseline = Baseline.ZERO_BACKLASH,
) -> PublishedMeshing:
    """The published calculation for any external pair.

    It was written for spur gears. Of a helical pair it is carried out in the transverse section: every length and angle is the
    transverse one, B′ a transverse arc.

    Parameters
    ----------
    pinion, gear : Gear
        The pair as designed.
    centre_distance : float
        Design centre distance c in mm. The angle θ of the first-order formula is the working pressure angle there, 20° for
        the paper's pair.
    thickness_loss : float
        B′ in mm: the largest loss of thickness of any tooth, arc at the reference circle; negative is thicker.
    allowance : float
        Backlash the design allows, mm, arc at the reference circle.
    baseline : Baseline
        What B′ was measured from; see `backlash_from_loss`.

    Returns
    -------
    PublishedMeshing

    Raises
    ------
    InputError
        If the loss is not finite, the base pitches differ, the base circles meet, or one is a ring.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> paper = published_meshing(pinion, gear, 114.3, thickness_loss=1.992, allowance=0.2286)
    >>> round(paper.backlash, 4), round(paper.centre_distance, 3), round(math.degrees(paper.pressure_angle), 2)
    (1.7634, 116.722, 23.05)
    """
    for member in (pinion, gear):
        refuse(member, "the published calculation", Toothing.INTERNAL)
    if not math.isfinite(thickness_loss):
        raise InputError(f"thickness loss = {thickness_loss:g} mm: must be a finite number")
    theta = working_pressure_angle(pinion, gear, centre_distance)
    backlash = backlash_from_loss(thickness_loss, allowance, baseline)
    pitch = pinion.pitch_angle * operating_pitch_radii(pinion, gear, centre_distance)[0]
    change = centre_distance_change(pitch, 0.5 * pitch, 0.5 * pitch, backlash, theta)
    worn = centre_distance - change
    worn_theta = working_pressure_angle(pinion, gear, worn)
    pitch_pinion, pitch_gear = operating_pitch_radii(pinion, gear, worn)
    radii = (pinion.tip_radius, gear.tip_radius, pinion.base_radius, gear.base_radius)
    return PublishedMeshing(
        thickness_loss=thickness_loss,
        backlash_allowance=allowance,
        baseline=baseline,
        backlash=backlash,
        centre_distance_change=change,
        centre_distance=worn,
        pressure_angle=worn_theta,
        pitch_radius_pinion=pitch_pinion,
        pitch_radius_gear=pitch_gear,
        contact_length_design=contact_length(*radii, centre_distance, theta),
        contact_length_worn=contact_length(*radii, worn, worn_theta),
    )
