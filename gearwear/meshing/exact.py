"""The exact involute relations of a pair in one result; what it is made of is in `backlash`, `path`, `clearance` and `shafts`.

Every function takes the two gears and a centre distance; profile shift, thinning and any distance are in.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.pair import tip_clearances
from gearwear.design.quantity import not_zero
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import check_kind
from gearwear.meshing.backlash import (
    Backlash,
    backlash,
    operating_pitch_radii,
    working_pressure_angle,
)
from gearwear.meshing.clearance import Interference, interference
from gearwear.meshing.path import PathOfContact, path_of_contact


@dataclass(frozen=True, slots=True, repr=False)
class ExactMeshing(Card):
    """A pair of ideal gears at one centre distance; mm and rad.

    Parameters
    ----------
    centre_distance, working_pressure_angle : float
        a_w and α_wt.
    pitch_radius_pinion, pitch_radius_gear : float
        Operating pitch radii r_w1, r_w2.
    backlash : Backlash
    path : PathOfContact
    tip_clearance_pinion, tip_clearance_gear : float
        Between this gear's tip and its mate's root circle.
    interference_pinion, interference_gear : Interference
        Of the mate's tip with this gear's root.
    """

    centre_distance: float
    working_pressure_angle: float
    pitch_radius_pinion: float
    pitch_radius_gear: float
    backlash: Backlash
    path: PathOfContact
    tip_clearance_pinion: float
    tip_clearance_gear: float
    interference_pinion: Interference
    interference_gear: Interference

    def headline(self) -> str:
        return f"a = {self.centre_distance:.4f} mm, contact ratio {self.path.ratio_words()}"

    def rows(self) -> list[CardRow]:
        play, path = self.backlash, self.path
        angles = (math.degrees(play.angular_pinion), math.degrees(play.angular_gear))
        ends = f"SAP {path.start_pinion:z.4f}, EAP {path.end_pinion:z.4f} mm"
        if path.alone_pinion is not None:
            ends += ", one pair alone {:.4f} … {:.4f} mm".format(*path.alone_pinion)
        elif path.overlap_ratio == 0.0:
            ends += ", no pair ever alone"
        across = (
            f"normal {play.normal:z.4f}, circumferential {play.circumferential:z.4f}, radial {play.radial:z.4f}"
            + ("" if play.axial is None else f", axial {play.axial:z.4f}")
            + " mm"
        )
        rows = [
            ("working pressure angle", f"{math.degrees(self.working_pressure_angle):.4f}°"),
            ("operating pitch radii", f"{self.pitch_radius_pinion:.4f} and {self.pitch_radius_gear:.4f} mm"),
            ("backlash", across),
            ("angular backlash", f"pinion {angles[0]:z.4f}°, gear {angles[1]:z.4f}°"),
            ("path of contact", f"{path.length:.4f} mm: approach {path.approach:z.4f}, recess {path.recess:z.4f}"),
            ("roll length, pinion", ends),
            ("roll length, gear", f"SAP {path.start_gear:z.4f}, EAP {path.end_gear:z.4f} mm"),
            ("tip clearance", f"pinion {self.tip_clearance_pinion:z.4f}, gear {self.tip_clearance_gear:z.4f} mm"),
        ]
        for part, other, tip in (("pinion", "gear", self.interference_pinion), ("gear", "pinion", self.interference_gear)):
            if tip.penetration > 0.0:
                rows.append(("interference", f"the {other}'s tip digs {not_zero(tip.penetration)} mm into the {part}'s fillet"))
            elif tip.overrun > 0.0:
                rows.append(
                    ("overrun", f"of the {other}'s tip past the {part}'s interference point {not_zero(tip.overrun)} mm, clear")
                )
        return rows


def exact_meshing(pinion: Gear, gear: Gear, centre_distance: float) -> ExactMeshing:
    """Everything the involutes say about a pair.

    Parameters
    ----------
    pinion, gear : Gear
        The pair.
    centre_distance : float
        Working centre distance in mm.

    Returns
    -------
    ExactMeshing

    Raises
    ------
    InputError
        If the base pitches differ, the base circles meet, the gears do not reach each other, or the first is a ring.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.25))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> meshing = exact_meshing(pinion, gear, 116.722)
    >>> round(meshing.backlash.normal, 6), round(meshing.path.length, 3)
    (1.780441, 21.728)
    >>> meshing
    ExactMeshing: a = 116.7220 mm, contact ratio 1.1591
      working pressure angle  23.0456°
      operating pitch radii   38.9073 and 77.8147 mm
      backlash                normal 1.7804, circumferential 1.9349, radial 2.2741 mm
      angular backlash        pinion 2.8493°, gear 1.4247°
      path of contact         21.7281 mm: approach 10.6150, recess 11.1131
      roll length, pinion     SAP 4.6157, EAP 26.3439 mm, one pair alone 7.5978 … 23.3618 mm
      roll length, gear       SAP 19.3485, EAP 41.0766 mm
      tip clearance           pinion 4.0095, gear 4.0095 mm
    """
    for name, one in (("pinion", pinion), ("gear", gear)):
        check_kind(one, Gear, name, "one of design.gears")
    refuse(pinion, "meshing with the ring first, instead of its pinion,", Toothing.INTERNAL)
    pitch_pinion, pitch_gear = operating_pitch_radii(pinion, gear, centre_distance)
    clearance_pinion, clearance_gear = tip_clearances(pinion, gear, centre_distance)
    return ExactMeshing(
        centre_distance=centre_distance,
        working_pressure_angle=working_pressure_angle(pinion, gear, centre_distance),
        pitch_radius_pinion=pitch_pinion,
        pitch_radius_gear=pitch_gear,
        backlash=backlash(pinion, gear, centre_distance),
        path=path_of_contact(pinion, gear, centre_distance),
        tip_clearance_pinion=clearance_pinion,
        tip_clearance_gear=clearance_gear,
        interference_pinion=interference(pinion, gear, centre_distance),
        interference_gear=interference(gear, pinion, centre_distance),
    )
