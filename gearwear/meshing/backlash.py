"""Working pressure angle, backlash and centre distance of a pair, external or with a ring, exact at any distance.

All of it follows from one relation on the base circles. With s_bt the base thickness of a tooth, p_bt the base
pitch and α_wt the working pressure angle, all in the transverse section, the play along the line of action is ::

    j_bt = p_bt − s_bt1 − s_bt2 + 2 (r_b1 + r_b2) inv α_wt,   j_bn = j_bt cos β_b

(ISO 21771:2007; Colbourne, The Geometry of Involute Gears, 1987). It is closed form both ways, and profile
shift, thinning and wear enter through s_b alone. Negative backlash is how far the teeth would overlap. The base radius of a ring is negative, as
ISO 21771 has it, and so is its centre distance: what is given and returned here are amounts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from gearwear.design.gear import Gear
from gearwear.design.given import check_choice, check_number
from gearwear.design.involute import inverse_involute, involute_function
from gearwear.design.pair import base_backlash, base_radius_sum, opposite_hands, same_base_pitch, tight_involute
from gearwear.design.quantity import apart, as_given, at_least, at_most, not_zero
from gearwear.design.rack import bisect
from gearwear.errors import InputError

BacklashKind = Literal["reference", "operating", "normal"]
"""Where a backlash is measured: transverse arc on the reference or the operating circles, or normal to the flanks."""
NO_OVERLAP = 1e-7
"""mm; a backlash below 0 by less is that of the search for its least value, and of the computer's rounding."""


@dataclass(frozen=True, slots=True)
class Backlash:
    """Every kind of backlash of one pair at one centre distance; lengths in mm, angles in rad.

    Parameters
    ----------
    normal : float
        j_bn, normal to the flanks: what a feeler gauge measures. Of spur gears it lies along the line of action.
    transverse : float
        j_bt = j_bn / cos β_b, along the transverse line of action.
    circumferential : float
        j_wt, arc on the operating pitch circles.
    circumferential_reference : float
        j_bt / cos α_t, arc on the reference circles; what drawings and allowances give.
    radial : float
        j_r = j_wt / (2 tan α_wt) as ISO 21771 defines it: the first-order approach to contact on both flanks.
    radial_closing : float or None
        How far the shafts really close until the backlash is zero, with a ring how far they part; None where the base circles would meet first.
    angular_pinion, angular_gear : float
        Free turn of one gear with the other held.
    axial : float or None
        j_x = j_wt / tan β_w: free movement of one gear along its axis, with both kept from turning; None for spur gears.
    """

    normal: float
    transverse: float
    circumferential: float
    circumferential_reference: float
    radial: float
    radial_closing: float | None
    angular_pinion: float
    angular_gear: float
    axial: float | None


def working_pressure_angle(pinion: Gear, gear: Gear, centre_distance: float) -> float:
    """Working pressure angle α_wt: ``cos α_wt = (r_b1 + r_b2) / a_w`` (ISO 21771:2007), with a ring ``(r_b2 − r_b1) / a_w``.

    Parameters
    ----------
    pinion, gear : Gear
        The pair, in either order.
    centre_distance : float
        Working centre distance a_w in mm.

    Returns
    -------
    float
        rad.

    Raises
    ------
    InputError
        If the base pitches differ or the base circles meet.
    """
    check_number("centre_distance", centre_distance, "mm")
    bases = sum_of_base_radii(pinion, gear)
    if not abs(bases) < centre_distance < math.inf:
        relation = "sum" if bases > 0.0 else "difference"
        raise InputError(
            f"centre distance = {as_given(centre_distance)} mm: must be above the {relation} of the base radii, {at_least(abs(bases))} mm"
        )
    return math.acos(abs(bases) / centre_distance)


def operating_pitch_radii(pinion: Gear, gear: Gear, centre_distance: float) -> tuple[float, float]:
    """Operating pitch radii r_w1, r_w2 in mm: the centre distance shared out as the base radii are.

    They belong to the pair and its distance, not to either gear: wear does not change them.
    """
    working_pressure_angle(pinion, gear, centre_distance)
    share = pinion.orientation * pinion.base_radius / sum_of_base_radii(pinion, gear)
    return abs(share * centre_distance), abs((1.0 - share) * centre_distance)


def normal_backlash(pinion: Gear, gear: Gear, centre_distance: float) -> float:
    """Normal backlash j_bn in mm; negative where the teeth would overlap. Raises as `transverse_backlash`."""
    return pinion.base_helix_cosine * transverse_backlash(pinion, gear, centre_distance)


def transverse_backlash(pinion: Gear, gear: Gear, centre_distance: float) -> float:
    """Play j_bt in mm along the transverse line of action; negative where the teeth would overlap.

    Raises
    ------
    InputError
        If the gears do not mesh (`check_mesh`) or the base circles meet.
    """
    alpha = working_pressure_angle(pinion, gear, centre_distance)
    return base_backlash(pinion, gear, alpha)


def backlash(pinion: Gear, gear: Gear, centre_distance: float) -> Backlash:
    """All kinds of backlash of the pair.

    Parameters
    ----------
    pinion, gear : Gear
        The pair.
    centre_distance : float
        Working centre distance in mm.

    Returns
    -------
    Backlash

    Raises
    ------
    InputError
        If the base pitches differ or the base circles meet.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> round(backlash(pinion, gear, 114.4).circumferential, 6)
    0.073098
    """
    return backlash_from_normal(pinion, gear, centre_distance, normal_backlash(pinion, gear, centre_distance))


def backlash_from_normal(pinion: Gear, gear: Gear, centre_distance: float, normal: float) -> Backlash:
    """All kinds of backlash for a normal backlash (mm) known otherwise, such as that of measured flanks."""
    bases = sum_of_base_radii(pinion, gear)
    alpha = working_pressure_angle(pinion, gear, centre_distance)
    transverse = normal / pinion.base_helix_cosine
    circumferential = transverse / math.cos(alpha)
    tight = involute_function(alpha) - transverse / (2.0 * bases)
    pitch_radius, _ = operating_pitch_radii(pinion, gear, centre_distance)
    return Backlash(
        normal=normal,
        transverse=transverse,
        circumferential=circumferential,
        circumferential_reference=transverse / math.cos(pinion.transverse_pressure_angle),
        radial=circumferential / (2.0 * math.tan(alpha)),
        radial_closing=None
        if tight < 0.0
        else math.copysign(1.0, bases) * (centre_distance - abs(bases) / math.cos(inverse_involute(tight))),
        angular_pinion=transverse / pinion.base_radius,
        angular_gear=transverse / gear.base_radius,
        axial=circumferential / (pitch_radius * abs(pinion.twist)) if pinion.twist != 0.0 else None,
    )


def overlap_words(pinion: Gear, gear: Gear, centre_distance: float, normal: float) -> str:
    """What a normal backlash (mm) below 0 means, and the centre distance that would be right, as a clause; "" where there is room.

    >>> from gearwear.design import GearSpec
    >>> pinion, gear = (Gear.from_spec(GearSpec(part, z, 6.35, 15.0)) for part, z in (("pinion", 12), ("gear", 24)))
    >>> overlap_words(pinion, gear, 114.2, normal_backlash(pinion, gear, 114.2))
    'the teeth overlap by 0.0682 mm (normal backlash) at a centre distance of 114.2 mm, where rigid gears jam: at least 114.3000 mm would be right'
    """
    if normal >= -NO_OVERLAP:
        return ""
    closing = backlash_from_normal(pinion, gear, centre_distance, normal).radial_closing
    if closing is None:
        right = "thinner teeth would be"
    elif gear.spec.internal:
        right = f"at most {at_most(centre_distance + closing)} mm would be"
    else:
        right = f"at least {at_least(centre_distance - closing)} mm would be"
    return (
        f"the teeth overlap by {not_zero(-normal)} mm (normal backlash) at a centre distance of {as_given(centre_distance)} mm, where rigid gears"
        f" jam: {right} right"
    )


def zero_backlash_centre_distance(pinion: Gear, gear: Gear, thickness_loss: float = 0.0) -> float:
    """Centre distance in mm at which both flanks touch; see `centre_distance_for_backlash`.

    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 30, 16.0, 100.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 78, 16.0, 100.0, profile_shift=0.05))
    >>> round(zero_backlash_centre_distance(pinion, gear), 4)
    864.7972
    """
    return centre_distance_for_backlash(pinion, gear, 0.0, "normal", thickness_loss)


def centre_distance_for_backlash(
    pinion: Gear, gear: Gear, backlash: float, kind: BacklashKind = "reference", thickness_loss: float = 0.0
) -> float:
    """Centre distance at which the pair has a wanted backlash.

    Parameters
    ----------
    pinion, gear : Gear
        The pair.
    backlash : float
        Wanted backlash in mm, not negative.
    kind : {"reference", "operating", "normal"}
        Where it is measured.
    thickness_loss : float
        Thickness that both gears' teeth together have lost, mm of arc at the reference circle.

    Returns
    -------
    float
        mm. Exact; closed form but for "operating", which is found by bisection to machine precision.

    Raises
    ------
    InputError
        If the backlash is negative, or the teeth are so thin that the base circles would meet first.
    """
    check_choice("kind", kind, get_args(BacklashKind))
    if not 0.0 <= backlash < math.inf:
        raise InputError(f"backlash = {backlash:g} mm: must be 0 or more")
    bases = sum_of_base_radii(pinion, gear)
    cos_reference = math.cos(pinion.transverse_pressure_angle)
    tight = tight_involute(pinion, gear) - thickness_loss * cos_reference / (2.0 * bases)
    along_action = {"reference": cos_reference, "operating": 1.0, "normal": 1.0 / pinion.base_helix_cosine}[kind]
    value = tight + backlash * along_action / (2.0 * bases)
    if value < 0.0:
        raise InputError(
            f"backlash = {backlash:g} mm at a thickness loss of {thickness_loss:g} mm: no centre distance gives it, the base circles meet first (at {abs(bases):.4f} mm)"
        )
    alpha = inverse_involute(value)
    if kind == "operating":
        alpha = _operating_angle(alpha, tight, backlash, bases)
    return abs(bases) / math.cos(alpha)


def check_mesh(pinion: Gear, gear: Gear) -> None:
    """Refuse gears that no centre distance makes mesh: base pitches differ, or helix angles are not opposite (with a ring: not the same)."""
    if pinion.spec.internal and gear.spec.internal:
        raise InputError("two rings do not mesh; one of them inside the other would be an external gear")
    if not same_base_pitch(pinion, gear):
        pitches = apart(pinion.base_pitch, gear.base_pitch, digits=6)
        raise InputError(f"base pitches {' and '.join(pitches)} mm: gears that mesh have the same")
    if not opposite_hands(pinion, gear):
        angles = " and ".join(f"{math.degrees(member.helix_angle):g}°" for member in (pinion, gear))
        right = (
            "external gears that mesh have opposite ones, a right hand and a left hand"
            if pinion.orientation == gear.orientation
            else "a ring has that of its pinion"
        )
        raise InputError(f"helix angles {angles}: {right}")


def sum_of_base_radii(pinion: Gear, gear: Gear) -> float:
    """r_b1 + r_b2 in mm, that of a ring negative; refuses gears that do not mesh at any centre distance."""
    check_mesh(pinion, gear)
    return base_radius_sum(pinion, gear)


def _operating_angle(start: float, tight: float, backlash: float, bases: float) -> float:
    """α_wt at which ``2 Σr_b (inv α − tight) = j_wt cos α``: between the angle without backlash, or the base circles', and `start`, j_wt taken as
    normal, which lies beyond the root, with a ring before it."""

    def excess(alpha: float) -> float:
        return involute_function(alpha) - tight - backlash * math.cos(alpha) / (2.0 * bases)

    return bisect(excess, *sorted((start, inverse_involute(max(tight, 0.0)))))
