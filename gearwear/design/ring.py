"""The root of a ring: by a stated cutter, by a stated fillet, or by a cutter assumed; and the conditions under which it can be cut."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.fillet_arc import FilletArc
from gearwear.design.internal import InternalPair, Wheel
from gearwear.design.involute import inverse_involute, involute_at_roll, involute_function, roll_length
from gearwear.design.quantity import apart, as_given, at_most
from gearwear.design.rack import bisect
from gearwear.design.root import RootPart, ToothSection
from gearwear.design.shaper import ShaperTip
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError

ASSUMED_TEETH = 25
"""Most teeth of the cutter that is assumed where none is stated; fewer where so many cannot cut the ring."""
FEWEST_ASSUMED = 8
"""Cutters of fewer teeth are not assumed."""
ASSUMED_TIP = 0.2
"""Tip radius of a cutter in modules where it is not stated; less where the cutter's tooth is too narrow for it."""
FULLEST = 0.8
"""An assumed radius takes at most this of what there is room for: a bottom land is left."""
SHIFT_BY_ISO = (
    "profile_shift is ISO's: + makes a ring's teeth thicker and its tip circle smaller; KHK and others have the other sign"
)
"""Said where a ring cannot be made, and the sign may be why."""


def ring_root(spec: GearSpec, section: ToothSection) -> RootPart:
    """Root of a ring.

    Parameters
    ----------
    spec : GearSpec
    section : ToothSection
        What is derived before the root.

    Returns
    -------
    RootPart
        Not `stated` where the drawing gives neither fillet nor cutter with its tip radius: then by a cutter of at most `ASSUMED_TEETH`,
        or, where no such cutter cuts this ring (it may be broached), by an arc.

    Raises
    ------
    InputError
        If the stated cutter or fillet cannot be, or no root at all fits the space.
    """
    if spec.fillet_radius is not None:
        return _arc(spec, section, spec.fillet_radius)
    if spec.cutter_teeth is not None:
        shaper = _Shaper.of(spec, section, spec.cutter_teeth)
        shaper.check(spec, section)
        return shaper.root(section, stated=spec.cutter_tip_radius is not None)
    for teeth in range(min(ASSUMED_TEETH, spec.teeth - 1), FEWEST_ASSUMED - 1, -1):
        try:
            shaper = _Shaper.of(spec, section, teeth)
            shaper.check(spec, section)
        except InputError:
            continue
        if shaper.pair(section, spec.teeth).trimming_margin >= 0.0:
            return shaper.root(section, stated=False)
    return _assumed_arc(spec, section)


@dataclass(frozen=True, slots=True)
class _Shaper:
    """A cutter without profile shift, its tip on the ring's root circle; its tooth is thicker by what the ring's is thinned."""

    teeth: int
    base_radius: float
    tip_radius: float
    centre_distance: float
    working_angle: float
    base_half_angle: float
    rounding: float
    """ρ0, mm."""
    centre_roll: float
    """L of the arc's centre, mm."""

    @classmethod
    def of(cls, spec: GearSpec, section: ToothSection, teeth: int) -> _Shaper:
        where = f"[{spec.name}] cutter_teeth = {teeth}"
        if not teeth < spec.teeth:
            raise InputError(f"{where}: must be below the ring's {spec.teeth}")
        alpha, module, ratio = section.pressure_angle, spec.normal_module, teeth / spec.teeth
        involute = involute_function(alpha)
        working = involute - 2.0 * spec.profile_shift * math.tan(spec.normal_pressure_angle) / (spec.teeth - teeth)
        if working <= 0.0:
            raise InputError(
                f"{where} with profile_shift = {spec.profile_shift:g}: no working angle is left; fewer cutter teeth would leave one ({SHIFT_BY_ISO})"
            )
        working = inverse_involute(working)
        centre = section.reference_radius * (1.0 - ratio) * math.cos(alpha) / math.cos(working)
        base, tip = section.base_radius * ratio, section.root_radius - centre
        arc = (0.5 * math.pi * module + spec.thinning) / math.cos(spec.helix_angle)
        half = arc / (2.0 * section.reference_radius * ratio) + involute

        def centre_angle(rounding: float) -> float:
            return half - rounding / base - float(involute_at_roll(roll_length(tip - rounding, base), base))

        if tip <= base or centre_angle(0.0) <= 0.0:
            raise InputError(
                f"{where}: its teeth would be pointed, or end within their base circle; another number would be right"
            )
        most = bisect(centre_angle, 0.0, tip - base) if centre_angle(tip - base) < 0.0 else tip - base
        stated = spec.cutter_tip_radius
        rounding = min(ASSUMED_TIP * module, FULLEST * most) if stated is None else stated * module
        if rounding > most:
            shown = math.floor(most / module * 1e4) / 1e4
            raise InputError(
                f"[{spec.name}] cutter_tip_radius = {stated:g} modules: too large for a cutter of {teeth} teeth, at most {shown:g}"
            )
        return cls(
            teeth=teeth,
            base_radius=base,
            tip_radius=tip,
            centre_distance=centre,
            working_angle=working,
            base_half_angle=half,
            rounding=rounding,
            centre_roll=float(roll_length(tip - rounding, base)),
        )

    @property
    def line(self) -> float:
        """a0 sin α_w0, mm: by how much the rolls of ring and cutter differ where they touch."""
        return self.centre_distance * math.sin(self.working_angle)

    def pair(self, section: ToothSection, teeth: int) -> InternalPair:
        ring = Wheel(teeth, section.flank_end_radius, section.base_radius)
        return InternalPair(Wheel(self.teeth, self.tip_radius, self.base_radius), ring, self.centre_distance)

    def check(self, spec: GearSpec, section: ToothSection) -> None:
        """Refuse a cutter that does not leave this ring."""
        where, pair = f"[{spec.name}] cutter_teeth = {self.teeth}:", self.pair(section, spec.teeth)
        if pair.involute_margin < 0.0:
            within, end = apart(2 * math.hypot(section.base_radius, self.line), 2 * section.flank_end_radius)
            raise InputError(
                f"{where} cuts away the ring's tips within diameter {within} mm (they end at "
                f"{end}); more cutter teeth or a smaller addendum would be right ({SHIFT_BY_ISO})"
            )
        if pair.fouling_margin < 0.0:
            raise InputError(
                f"{where} the cutter's tips foul the ring's where they leave each other; fewer cutter teeth would be right"
            )
        if self.centre_roll <= self.base_radius * math.tan(self.working_angle):
            raise InputError(
                f"{where} a tip rounded by {self.rounding:.4g} mm does not reach past the pitch circle; a smaller cutter_tip_radius or a "
                "larger dedendum would be right"
            )

    def root(self, section: ToothSection, stated: bool) -> RootPart:
        roll = self.centre_roll / self.base_radius
        angle = self.base_half_angle - self.rounding / self.base_radius - (roll - math.atan(roll))
        ratio = self.base_radius / section.base_radius
        curve = ShaperTip(
            centre_distance=self.centre_distance,
            pitch_radius=self.centre_distance / (1.0 - ratio),
            ratio=ratio,
            centre_radius=self.tip_radius - self.rounding,
            centre_angle=max(angle, 0.0),
            tip_radius=self.rounding,
        )
        form_roll = self.centre_roll + self.rounding + self.line
        return RootPart(curve, math.atan(roll) - self.working_angle, math.hypot(section.base_radius, form_roll), stated=stated)


def _arc(spec: GearSpec, section: ToothSection, radius: float) -> RootPart:
    """A stated fillet."""
    most = _largest_arc(spec, section)
    if radius > most:
        raise InputError(
            f"[{spec.name}] fillet_radius = {as_given(radius)} mm: too large for the space at root diameter {2 * section.root_radius:.4f} mm, at most "
            f"{at_most(most)} mm"
        )
    return _by_arc(spec, section, radius, stated=True)


def _assumed_arc(spec: GearSpec, section: ToothSection) -> RootPart:
    most = _largest_arc(spec, section)
    if most <= 0.0:
        raise InputError(
            f"[{spec.name}] no space is left at root diameter {2 * section.root_radius:.4f} mm; a smaller dedendum or thinner teeth would leave one "
            f"({SHIFT_BY_ISO})"
        )
    return _by_arc(spec, section, min(ASSUMED_TIP * spec.normal_module, FULLEST * most), stated=False)


def _by_arc(spec: GearSpec, section: ToothSection, radius: float, stated: bool) -> RootPart:
    """The centre lies one radius inside the root circle, and one from the flank, whose parallel is the same involute, turned."""
    base, centre = section.base_radius, section.root_radius - radius
    curve = FilletArc(centre, max(_arc_centre_angle(spec, section, radius), 0.0), radius)
    return RootPart(curve, math.asin(base / centre), math.hypot(base, float(roll_length(centre, base)) + radius), stated=stated)


def _arc_centre_angle(spec: GearSpec, section: ToothSection, radius: float) -> float:
    """Of the fillet's centre from the space's centre line, rad."""
    base = section.base_radius
    parallel = involute_at_roll(roll_length(section.root_radius - radius, base), base) + radius / base
    return math.pi / spec.teeth - section.base_half_angle - float(parallel)


def _largest_arc(spec: GearSpec, section: ToothSection) -> float:
    """Radius at which both fillets of a space meet on its centre line, mm; 0 where there is no space."""

    def angle(radius: float) -> float:
        return _arc_centre_angle(spec, section, radius)

    deepest = section.root_radius - section.base_radius
    if angle(0.0) <= 0.0:
        return 0.0
    return bisect(angle, 0.0, deepest) if angle(deepest) < 0.0 else deepest
