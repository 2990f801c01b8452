"""What the user says about a gear and a pair: plain, frozen, checked one value at a time.

Derived geometry is in `gear`; whether the values fit together is decided there.
Millimetres and radians. Normal and transverse quantities have names of their own; for a spur gear
they are equal.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass, field
from enum import StrEnum
from numbers import Integral

import numpy as np

from gearwear.design.bounds import check_between
from gearwear.design.drawn_gauge import DrawnGauge
from gearwear.design.given import check_choice, check_number, check_several, two_numbers
from gearwear.design.modification import AS_GENERATED, FlankModification
from gearwear.design.quantity import shown
from gearwear.design.tolerance import GearTolerance
from gearwear.errors import InputError, check_kind

MOST_COMPUTED = 10_000
"""Teeth of a gear that is computed with and not built: as good as a rack."""
FEWEST_TEETH, MOST_TEETH = 5, 600
"""Tooth counts that can be built: time and size of everything made of a gear grow with them (600 teeth as STEP: 17 s, 14 MB)."""


ADDENDUM, DEDENDUM = (-2.0, 4.0), (0.0, 5.0)
"""Between what they must lie, modules."""

MOST_HELIX_DEGREES = 60.0
"""Largest helix angle: beyond it are worms."""


RING_KEYS = ("cutter_teeth", "cutter_tip_radius", "fillet_radius", "rim_diameter")
"""What only a ring has."""


class Baseline(StrEnum):
    """What the loss of thickness is measured from; decides how the published calculation counts the allowance."""

    ZERO_BACKLASH = "zero_backlash"
    WITH_ALLOWANCE = "with_allowance"
    PRE_WEAR_SCAN = "pre_wear_scan"


@dataclass(frozen=True, slots=True)
class GearSpec:
    """One spur or helical gear and the rack that generates it, or one ring.

    Parameters
    ----------
    name : str
        "pinion" or "gear"; used in messages.
    teeth : int
        Number of teeth z, `FEWEST_TEETH` to `MOST_COMPUTED`; a design file has `MOST_TEETH` at most.
    normal_module : float
        m_n in mm.
    face_width : float
        b in mm.
    normal_pressure_angle : float
        α_n in rad.
    profile_shift, addendum, dedendum, rack_tip_radius : float
        x, h_a*, h_f*, ρ_f* in normal modules. x by ISO 21771: + makes the tooth thicker, that of a ring too, whose tip circle it makes smaller.
    thinning : float
        Reduction of the tooth's normal arc thickness at the reference circle, mm, by a side cut of the rack
        (the root circle stays).
    thinning_measured : bool
        True where that was measured on a gear that may be worn, by a scan or by gauges: an even loss of all its flanks is in it.
    bore_diameter, tip_chamfer, end_chamfer : float
        mm; 0 is none. Chamfers are 45°, both legs of this length.
    tip_chamfer_land : float or None
        Leg of the tip chamfer along the tip circle, mm; None: as long as the other.
    tip_rounding : float
        In place of a tip chamfer: radius of an arc tangent to flank and tip circle in the transverse section, mm; 0 is none.
    end_rounding : float
        In place of end chamfers: radius to which the edges of the outline are rounded at both ends, mm; 0 is none.
    helix_angle : float
        β at the reference circle in rad, + right hand: the teeth turn counter-clockwise with rising z; 0 is a spur gear. Of a double helical
        gear that of the half at z = 0.
    gap : float
        Width of the groove between the halves of a double helical gear, in the middle of the face, mm; 0 is a gear of one helix.
    tolerance : GearTolerance
        How far the gear may lie off these values.
    left, right : FlankModification
        Relief, crowning and slopes of the flanks of either side, as drawn.
    modified_between : (float, float) or None
        Roll lengths of the ends, form circle and tip, of the flanks that these were drawn for, mm, where tip edge or root are not the drawn ones
        (`Gear.recut`); None: the flanks' own.
    internal : bool
        A ring: teeth inwards.
    cutter_teeth : int or None
        z0 of the pinion-type cutter of a ring; None where it is not stated.
    cutter_tip_radius : float or None
        ρ0 of that cutter in normal modules, in its transverse section.
    fillet_radius : float or None
        Instead of a cutter: root fillet of a ring as an arc in the transverse section, mm.
    rim_diameter : float
        Outside of a ring, mm; 0 where it is not stated.
    protuberance : float
        p_r, how far the rack's tip reaches beyond its own straight flank, along its normal, mm; 0 is none.
    grinding_stock : float
        q, what grinding takes off a flank along its normal, mm; less than the protuberance. What the rack leaves in the root stays.
    protuberance_angle : float or None
        α_pr of the protuberance's own straight part, rad; None: not stated, the tip is round up to the flank.
    gauge : DrawnGauge or None
        Span or dimension over pins by which the drawing states the thickness, and from which `thinning` was worked out; None where it does not.
    ends_seen : ((float, float), (float, float)) or None
        How far a scan shows edges to reach from the low and from the high end, mm, on left and on right flanks; None: as they are drawn.

    Raises
    ------
    InputError
        If a value alone is impossible.
    """

    name: str
    teeth: int
    normal_module: float
    face_width: float
    normal_pressure_angle: float = math.radians(20.0)
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    rack_tip_radius: float = 0.30
    thinning: float = 0.0
    bore_diameter: float = 0.0
    tip_chamfer: float = 0.0
    end_chamfer: float = 0.0
    helix_angle: float = 0.0
    gap: float = 0.0
    tolerance: GearTolerance = field(default_factory=GearTolerance)
    left: FlankModification = AS_GENERATED
    right: FlankModification = AS_GENERATED
    internal: bool = False
    cutter_teeth: int | None = None
    cutter_tip_radius: float | None = None
    fillet_radius: float | None = None
    rim_diameter: float = 0.0
    tip_rounding: float = 0.0
    end_rounding: float = 0.0
    protuberance: float = 0.0
    grinding_stock: float = 0.0
    protuberance_angle: float | None = None
    tip_chamfer_land: float | None = None
    modified_between: tuple[float, float] | None = None
    thinning_measured: bool = False
    ends_seen: tuple[tuple[float, float], tuple[float, float]] | None = None
    gauge: DrawnGauge | None = None

    def __post_init__(self) -> None:
        check_kind(self.name, str, "name", '"pinion" or "gear"')
        try:
            teeth = 0 if isinstance(self.teeth, bool) else operator.index(self.teeth)  # integers of numpy too
        except TypeError:
            teeth = 0
        if not FEWEST_TEETH <= teeth <= MOST_COMPUTED:
            raise InputError(
                f"[{self.name}] teeth = {shown(self.teeth)}: must be a whole number from {FEWEST_TEETH} to {MOST_COMPUTED}"
            )
        object.__setattr__(self, "teeth", teeth)
        self._check_kinds()
        check_module(self.name, self.normal_module)
        check_between(self.name, "face_width", self.face_width, 1e-3, 1e5, "mm")
        check_between(self.name, "pressure_angle", math.degrees(self.normal_pressure_angle), 5.0, 45.0, "degrees")
        check_between(self.name, "profile_shift", self.profile_shift, -2.0, 3.0, "modules")
        check_between(self.name, "addendum", self.addendum, *ADDENDUM, "modules")
        check_between(self.name, "dedendum", self.dedendum, *DEDENDUM, "modules")
        check_between(self.name, "rack_tip_radius", self.rack_tip_radius, 0.0, 2.0, "modules")
        check_between(self.name, "thinning", self.thinning, -self.normal_module, self.normal_module, "mm")
        check_between(
            self.name, "helix_angle", math.degrees(self.helix_angle), -MOST_HELIX_DEGREES, MOST_HELIX_DEGREES, "degrees"
        )
        for label in ("bore_diameter", "tip_chamfer", "end_chamfer", "gap", "rim_diameter", "tip_rounding", "end_rounding"):
            check_between(self.name, label, getattr(self, label), 0.0, 1e5, "mm")
        if self.tip_chamfer_land is not None:
            check_between(self.name, "tip_chamfer_land", self.tip_chamfer_land, 0.0, 1e5, "mm")
            if self.tip_chamfer_land > 0.0 and self.tip_chamfer == 0.0:
                raise InputError(
                    f"[{self.name}] tip_chamfer_land without tip_chamfer: its leg along the tooth's height (mm) is needed"
                )
        for side in ("left", "right"):
            getattr(self, side).check(self.name)
        self._check_protuberance()
        for edge in ("tip", "end"):
            if getattr(self, f"{edge}_chamfer") > 0.0 and getattr(self, f"{edge}_rounding") > 0.0:
                raise InputError(f"[{self.name}] {edge}_chamfer and {edge}_rounding are both given: one of them")
        if self.gap > 0.0 and self.helix_angle == 0.0:
            raise InputError(
                f"[{self.name}] gap = {self.gap:g} mm: a double helical gear has a helix_angle; without a gap it may be 0"
            )
        if not self.gap < self.face_width:
            raise InputError(f"[{self.name}] gap = {self.gap:g} mm: must be below the face width, {self.face_width:g} mm")
        self._check_ring()

    def _check_kinds(self) -> None:
        """What is compared with no limit, or in other units than it has here."""
        for label in ("normal_pressure_angle", "helix_angle"):
            check_number(f"[{self.name}] {label}", getattr(self, label), "rad")
        for label, unit in (("protuberance_angle", "rad"), *((key, "") for key in RING_KEYS)):
            if getattr(self, label) is not None:
                check_number(f"[{self.name}] {label}", getattr(self, label), unit)
        for label, kind, right in (
            ("internal", bool | np.bool_, "True or False"),
            ("thinning_measured", bool | np.bool_, "True or False"),
            ("tolerance", GearTolerance, "a GearTolerance"),
            ("left", FlankModification, "a FlankModification"),
            ("right", FlankModification, "a FlankModification"),
            ("gauge", DrawnGauge | None, "a DrawnGauge or None"),
        ):
            check_kind(getattr(self, label), kind, f"[{self.name}] {label}", right)
        if self.modified_between is not None:
            two_numbers(f"[{self.name}] modified_between", self.modified_between, "two lengths in mm")
        if self.ends_seen is not None:
            for pair in check_several(f"[{self.name}] ends_seen", self.ends_seen, "two pairs of lengths in mm"):
                two_numbers(f"[{self.name}] ends_seen", pair, "two lengths in mm")

    def _check_protuberance(self) -> None:
        """The tool of a root that the finished flank cuts."""
        for label in ("protuberance", "grinding_stock"):
            check_between(self.name, label, getattr(self, label), 0.0, 0.5 * self.normal_module, "mm")
        if self.grinding_stock > 0.0 and not self.grinding_stock < self.protuberance:
            raise InputError(
                f"[{self.name}] grinding_stock = {self.grinding_stock:g} mm: must be below the protuberance, {self.protuberance:g} mm; a root "
                "ground with the flank is the grinding rack's own: its dedendum and rack_tip_radius"
            )
        if self.protuberance_angle is not None:
            if self.protuberance == 0.0:
                raise InputError(f"[{self.name}] protuberance_angle without protuberance: its amount (mm) is needed")
            steepest = math.degrees(self.normal_pressure_angle)
            check_between(self.name, "protuberance_angle", math.degrees(self.protuberance_angle), 0.0, steepest, "degrees")

    def _check_ring(self) -> None:
        """What only a ring has, and what it has not."""
        if not self.internal:
            for label in RING_KEYS:
                if getattr(self, label):
                    raise InputError(
                        f"[{self.name}] {label} belongs to a ring; internal = true would be right, or to leave it out"
                    )
            return
        if self.protuberance > 0.0:
            raise InputError(f"[{self.name}] protuberance = {self.protuberance:g} mm: no rack cuts a ring; 0 would be right")
        if self.bore_diameter > 0.0:
            raise InputError(f"[{self.name}] bore_diameter = {self.bore_diameter:g} mm: a ring has a rim_diameter instead")
        if self.gap > 0.0:
            raise InputError(
                f"[{self.name}] gap = {self.gap:g} mm: double helical rings are out of scope for now; 0 would be right"
            )
        if self.fillet_radius is not None:
            check_between(self.name, "fillet_radius", self.fillet_radius, 1e-3, 1e3, "mm")
            if self.cutter_teeth is not None or self.cutter_tip_radius is not None:
                raise InputError(f"[{self.name}] fillet_radius and a cutter are both given: one of them")
        if self.cutter_teeth is not None and not (isinstance(self.cutter_teeth, Integral) and self.cutter_teeth >= FEWEST_TEETH):
            raise InputError(
                f"[{self.name}] cutter_teeth = {shown(self.cutter_teeth)}: must be a whole number from {FEWEST_TEETH}"
            )
        if self.cutter_tip_radius is not None:
            check_between(self.name, "cutter_tip_radius", self.cutter_tip_radius, 0.0, 2.0, "modules")
            if self.cutter_teeth is None:
                raise InputError(
                    f"[{self.name}] cutter_tip_radius without cutter_teeth: both say how the ring is made, or neither"
                )

    @property
    def orientation(self) -> int:
        """ι: +1 of an external gear, −1 of a ring, whose radii run the other way from root to tip."""
        return -1 if self.internal else 1

    @property
    def tip_chamfer_on_land(self) -> float:
        """Leg of the tip chamfer along the tip circle, mm."""
        return self.tip_chamfer if self.tip_chamfer_land is None else self.tip_chamfer_land

    @property
    def body_diameter(self) -> float:
        """Of the cylinder in which the body ends away from the teeth, mm: the bore, of a ring its outside; 0 where there is none."""
        return self.rim_diameter if self.internal else self.bore_diameter

    @property
    def end_edge(self) -> float:
        """How far chamfers or roundings of the ends reach from them at most, mm."""
        return max(map(max, self.end_edges))

    @property
    def end_edges(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """How far they reach from the low and from the high end, mm, on left and on right flanks and what is next to these."""
        drawn = max(self.end_chamfer, self.end_rounding)
        return ((drawn, drawn), (drawn, drawn)) if self.ends_seen is None else self.ends_seen

    @property
    def hand(self) -> str:
        """Which way the teeth turn: "right" (helix angle above 0), "left" or "spur"; of a double helical gear both, from z = 0."""
        if self.helix_angle == 0.0:
            return "spur"
        if self.gap > 0.0:
            return "right and left" if self.helix_angle > 0.0 else "left and right"
        return "right" if self.helix_angle > 0.0 else "left"


@dataclass(frozen=True, slots=True)
class PairSpec:
    """How pinion and gear are mounted.

    Parameters
    ----------
    centre_distance : float or None
        Working centre distance in mm; None is the standard one, m_t (z1 + z2) / 2.
    backlash_allowance : float
        Backlash the design allows, mm of arc at the reference circle.
    baseline : Baseline
        What the loss is measured from.
    """

    centre_distance: float | None = None
    backlash_allowance: float = 0.0
    baseline: Baseline = Baseline.ZERO_BACKLASH

    def __post_init__(self) -> None:
        if self.centre_distance is not None:
            check_between("pair", "centre_distance", self.centre_distance, 1e-3, 1e8, "mm")
        check_choice("[pair] baseline", self.baseline, Baseline)
        object.__setattr__(self, "baseline", Baseline(self.baseline))  # the same word as a plain string is none
        check_between("pair", "backlash_allowance", self.backlash_allowance, 0.0, 1e3, "mm")


def check_teeth(section: str, teeth: int) -> None:
    """Refuse a tooth count that cannot be built."""
    if not (isinstance(teeth, int) and FEWEST_TEETH <= teeth <= MOST_TEETH):
        raise InputError(f"[{section}] teeth = {shown(teeth)}: must be a whole number from {FEWEST_TEETH} to {MOST_TEETH}")


def check_module(section: str, module: float) -> None:
    """Refuse a module (mm) that no gear has; below the range squares of lengths would lose their digits."""
    check_between(section, "module", module, 1e-3, 1e3, "mm")
