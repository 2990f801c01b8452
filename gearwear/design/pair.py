"""A design: one gear, or a pinion and a gear in mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.internal import InternalPair, Wheel
from gearwear.design.involute import inverse_involute, involute_function
from gearwear.design.limits import Limits
from gearwear.design.load import LoadSpec
from gearwear.design.quantity import apart, as_given, at_least, at_most, not_zero
from gearwear.design.report_details import ReportDetails
from gearwear.design.scan_spec import DatumSpec, ScannerSpec
from gearwear.design.spec import PairSpec
from gearwear.design.weighing import WeighingSpec
from gearwear.errors import InputError, check_kind

FILLET_KEYS = "cutter_teeth and cutter_tip_radius, or fillet_radius,"
"""What a drawing would say of a ring's root."""
CENTRE_ROUNDING = 0.5e-3 + 1e-9
"""mm; half the last digit of a centre distance written to 1 µm, and the computer's: by so much it may be on the wrong side of what the gears have room for."""
MAX_HELIX_DIFFERENCE = 1e-9
"""Largest sum of the two helix angles of a pair, rad: they are opposite."""


@dataclass(frozen=True, slots=True, repr=False)
class Design(Card):
    """What was drawn: a gear alone, or a pair.

    Parameters
    ----------
    gears : dict of str to Gear
        By part name: "pinion", "gear" or both.
    pair : PairSpec or None
        None where there is no mate.
    warnings : tuple of str
        What is legal but worth knowing, each with its numbers.
    source : str
        File the design was read from.
    scanner : ScannerSpec
        What is stated of the scanner; no part of the gear.
    datum : DatumSpec
        What is stated of how the gear lies in its scans.
    limits : Limits
        What wear is allowed; a fleet is judged by it.
    load : LoadSpec or None
        What the pair carries; None where nothing is stated.
    report : ReportDetails
        What its reports say of the part and of who measured it.
    weighing : WeighingSpec or None
        What the gear weighed before and after; None where nothing is stated.
    sha256 : str
        Of the file, in hexadecimal digits; empty where it was not read from one.
    """

    gears: dict[str, Gear]
    pair: PairSpec | None = None
    warnings: tuple[str, ...] = ()
    source: str = ""
    scanner: ScannerSpec = field(default_factory=ScannerSpec)
    limits: Limits = field(default_factory=Limits)
    load: LoadSpec | None = None
    report: ReportDetails = field(default_factory=ReportDetails)
    sha256: str = ""
    datum: DatumSpec = field(default_factory=DatumSpec)
    weighing: WeighingSpec | None = None

    def headline(self) -> str:
        source = [f"from {self.source}"] if self.source else []
        return ", ".join([f"{' and '.join(self.gears)}", *([f"a = {self.centre_distance:g} mm"] if self.pair else []), *source])

    def rows(self) -> list[CardRow]:
        return [
            *((name, gear.headline().removeprefix(f"{name}, ")) for name, gear in self.gears.items()),
            *(("note", text) for text in self.warnings),
        ]

    @property
    def centre_distance(self) -> float:
        """Working centre distance in mm; the standard one where none is given."""
        if self.pair is None:
            raise ValueError("a design of one gear has no centre distance")
        if self.pair.centre_distance is not None:
            return self.pair.centre_distance
        return abs(sum(gear.orientation * gear.reference_radius for gear in self.gears.values()))

    @property
    def scale_std(self) -> float:
        """Relative standard uncertainty of a scan's lengths: the instrument's scale, and α u(T) of the part."""
        return math.hypot(self.scanner.scale_std, self.datum.expansion * self.datum.temperature_std)

    def mate_of(self, part: str) -> Gear | None:
        """The other gear of the pair, or None."""
        return next((gear for name, gear in self.gears.items() if name != part), None)


def check_design(design: object) -> None:
    """Refuse what is no design: the stages of the API take what `read_design` returns."""
    check_kind(design, Design, "design", "what gw.read_design returns")


def opposite_hands(pinion: Gear, gear: Gear) -> bool:
    """Whether helix angles are opposite, as those of gears that mesh are; of a ring and its pinion: the same."""
    return abs(pinion.helix_angle + pinion.orientation * gear.orientation * gear.helix_angle) <= MAX_HELIX_DIFFERENCE


def same_base_pitch(pinion: Gear, gear: Gear) -> bool:
    """Whether teeth are equally far apart along the line of action, to rounding."""
    return abs(pinion.base_pitch - gear.base_pitch) <= 1e-9 * pinion.base_pitch


def check_pair(pinion: Gear, gear: Gear, pair: PairSpec) -> tuple[str, ...]:
    """Refuse a pair that cannot be mounted; return what is legal but worth knowing.

    Parameters
    ----------
    pinion, gear : Gear
        The two gears.
    pair : PairSpec
        How they are mounted.

    Returns
    -------
    tuple of str
        Warnings, each with its numbers.

    Raises
    ------
    InputError
        If the base pitches differ, the base circles meet, tips bottom out, teeth jam, the path of contact is
        empty, or a tip digs into the mate's root fillet.
    """
    _check_toothing(pinion, gear)
    orientation = gear.orientation
    standard = abs(pinion.reference_radius + orientation * gear.reference_radius)
    centre = standard if pair.centre_distance is None else pair.centre_distance
    play, line = _check_distance(pinion, gear, centre)
    start, end = path_ends(pinion, gear, line)
    if end <= start:
        raise InputError(
            f"[pair] centre_distance = {as_given(centre)} mm: the gears do not reach each other, the path of contact is empty"
        )
    warnings = []
    ratio = (end - start) / pinion.base_pitch + overlap_ratio(pinion, gear)
    if ratio < 1.0:
        warnings.append(f"contact ratio {ratio:.3f} is below 1: the drive is not continuous")
    if gear.spec.internal:
        warnings += inside_ring(pinion, gear, centre, play)
    for part, member, mate in (("pinion", pinion, gear), ("gear", gear, pinion)):
        warnings += _tip_in_root(part, member, mate, centre)
        warnings += _tip_off_involute(part, member, mate, line)
    return tuple(warnings)


def _check_toothing(pinion: Gear, gear: Gear) -> None:
    """Refuse teeth that do not go together at any centre distance."""
    p, g, orientation = pinion.spec, gear.spec, gear.orientation
    if p.internal:
        raise InputError("[pinion] internal = true: the ring of a pair is its [gear]; the two the other way round would be right")
    if g.internal and not p.teeth < g.teeth:
        raise InputError(f"[gear] teeth = {g.teeth}: a ring needs more teeth than the pinion inside it, {p.teeth}")
    if not opposite_hands(pinion, gear):
        shown = [f"{math.degrees(spec.helix_angle):g}°" for spec in (p, g)]
        same_hand = f" (both {p.hand} hand)" if p.hand == g.hand else ""
        right = "the same hand and angle inside a ring" if g.internal else "opposite hands of one angle"
        raise InputError(
            f"[gear] helix_angle = {shown[1]} does not mesh with the pinion's {shown[0]}{same_hand}: {right} would be right, {-orientation * math.degrees(p.helix_angle):g}°"
        )
    if (p.gap > 0.0) != (g.gap > 0.0):
        raise InputError(
            f"[gear] gap = {g.gap:g} mm does not mesh with the pinion's {p.gap:g} mm: a double helical gear runs with a double helical gear"
        )
    if not same_base_pitch(pinion, gear):
        pitches = apart(gear.base_pitch, pinion.base_pitch, digits=6)
        raise InputError(
            f"[gear] module {g.normal_module:g} mm and pressure angle {math.degrees(g.normal_pressure_angle):g}° do not mesh with the pinion's {p.normal_module:g} mm and {math.degrees(p.normal_pressure_angle):g}°: base pitches {' and '.join(pitches)} mm must be equal"
        )


def _check_distance(pinion: Gear, gear: Gear, centre: float) -> tuple[float, float]:
    """Refuse a centre distance (mm) at which base circles meet, tips bottom out or teeth jam; circumferential backlash there, and the distance of
    the two points where the line of action touches the base circles (of a ring below 0), mm."""
    internal, orientation = gear.spec.internal, gear.orientation
    bases = base_radius_sum(pinion, gear)
    if not centre > abs(bases):
        relation = "difference" if internal else "sum"
        raise InputError(
            f"[pair] centre_distance = {as_given(centre)} mm: must be above the {relation} of the base radii, {at_least(abs(bases))} mm"
        )
    for part, clearance in zip(("pinion", "gear"), tip_clearances(pinion, gear, centre), strict=True):
        if clearance < -CENTRE_ROUNDING:
            limit = centre - orientation * clearance
            bound = f"at most {at_most(limit)} mm is possible" if internal else f"at least {at_least(limit)} mm is needed"
            raise InputError(
                f"[pair] centre_distance = {as_given(centre)} mm: the {part}'s tip digs {not_zero(-clearance)} mm into its mate's root; {bound}"
            )
    working = math.acos(abs(bases) / centre)
    play = base_backlash(pinion, gear, working) / math.cos(working)
    tight = tight_involute(pinion, gear)
    without_play = abs(bases) / math.cos(inverse_involute(tight)) if tight >= 0.0 else math.inf
    # Of a ring whose teeth jam at every distance `tight` is negative; outside one no teeth jam then.
    if play < 0.0 and not abs(centre - without_play) <= CENTRE_ROUNDING:
        remedy = f"a {'smaller' if internal else 'larger'} centre distance"
        if math.isfinite(without_play):
            remedy += f" ({f'at most {at_most(without_play)}' if internal else f'at least {at_least(without_play)}'} mm)"
        raise InputError(
            f"[pair] centre_distance = {as_given(centre)} mm: the teeth jam, backlash would be {not_zero(play)} mm; {remedy}, less profile_shift or more thinning is needed"
        )
    return play, orientation * centre * math.sin(working)


def _tip_in_root(part: str, member: Gear, mate: Gear, centre: float) -> list[str]:
    """Refuse a mate whose tip digs into the root fillet of a gear; where that is assumed, a warning."""
    depth = tip_penetration(member, mate, centre)
    if not depth > 1e-6 * member.transverse_module:
        return []
    if member.root_stated:
        remedy = "or a smaller root fillet" if member.spec.internal else "or a smaller rack_tip_radius"
        raise InputError(
            f"[pair] interference: the mate's tip (radius {mate.tip_radius:.4f} mm) digs {not_zero(depth)} mm into the {part}'s root fillet; a smaller addendum of the mate, a deeper dedendum {remedy} of the {part} would clear it"
        )
    return [
        f"the mate's tip would dig {not_zero(depth)} mm into the {part}'s root fillet, as that is assumed; {FILLET_KEYS} would tell"
    ]


def _tip_off_involute(part: str, member: Gear, mate: Gear, line: float) -> list[str]:
    """A warning where the mate's tip touches a gear where it has no involute."""
    reached = reached_roll(member, mate, abs(line))
    past = -reached
    if past > 0.0:
        limit = math.hypot(mate.base_radius, line)
        undercut = "is undercut and " if member.undercut else ""
        bound = "down to" if mate.spec.internal else "up to"
        return [
            f"the mate's tip passes the {part}'s interference point by {not_zero(past, 3)} mm of roll (no interference {bound} tip radius {(at_least if mate.spec.internal else at_most)(limit, 3)} mm); the {part} {undercut}clears it, but the path of contact ends at its form circle"
        ]
    if member.orientation * (reached - member.form_roll) < -1e-9:
        return [
            f"the mate's tip reaches {'beyond' if member.spec.internal else 'below'} the {part}'s form circle (radius {member.form_radius:.4f} mm): contact there is not conjugate"
        ]
    return []


def base_radius_sum(pinion: Gear, gear: Gear) -> float:
    """r_b1 + r_b2, mm; with a ring, whose radii are negative by ISO 21771, minus the difference."""
    return pinion.orientation * pinion.base_radius + gear.orientation * gear.base_radius


def inside_ring(pinion: Gear, ring: Gear, centre_distance: float, play: float) -> tuple[str, ...]:
    """Refuse a pinion whose tips foul the ring's; say where backlash alone clears them, and where it cannot be put in radially.

    `play` is the arc (mm) on the working circles.
    """
    inside, around = (Wheel(member.teeth, member.tip_radius, member.base_radius) for member in (pinion, ring))
    pair = InternalPair(inside, around, centre_distance)
    said = []
    margin = pair.fouling_margin
    if margin < 0.0:
        free = play * math.cos(pair.working_angle) / ring.base_radius
        if margin + free < 0.0:
            raise InputError(
                f"[pair] interference: the pinion's tips foul the ring's where they leave each other, by {not_zero(-margin * ring.tip_radius)} mm of arc; "
                "smaller addenda or a greater difference of teeth would clear them"
            )
        said.append("the pinion's tips clear the ring's, where they leave each other, by the backlash alone")
    if pair.trimming_margin < 0.0:
        said.append("the pinion cannot be put into the ring radially: its tips would catch; assemble it along the axis")
    return tuple(said)


def overlap_ratio(pinion: Gear, gear: Gear) -> float:
    """ε_β = b tan β_b / p_bt of the common face width: pitches by which one end of a pair is ahead of the other; 0 for spur gears.

    Of double helical gears b is the width of a half: both halves touch at the same time.
    """
    width, gap = min(pinion.face_width, gear.face_width), max(pinion.spec.gap, gear.spec.gap)
    if gap > 0.0:
        width = 0.5 * (width - gap)
    return width * abs(math.tan(pinion.base_helix_angle)) / pinion.base_pitch


def base_backlash(pinion: Gear, gear: Gear, working: float) -> float:
    """j_bt in mm, along the transverse base tangent: p_bt less both base thicknesses, 2 Σr_b inv α_w more (ISO 21771, written at the base circles)."""
    return 2.0 * base_radius_sum(pinion, gear) * (involute_function(working) - tight_involute(pinion, gear))


def tight_involute(pinion: Gear, gear: Gear) -> float:
    """inv α_wt at which the backlash is zero; negative when the base circles meet before the teeth do."""
    return (pinion.base_thickness + gear.base_thickness - pinion.base_pitch) / (2.0 * base_radius_sum(pinion, gear))


def tip_clearances(pinion: Gear, gear: Gear, centre_distance: float) -> tuple[float, float]:
    """Tip clearance in mm: pinion tip to gear root, gear tip to pinion root; negative where the tip digs in."""
    orientation = pinion.orientation * gear.orientation  # radii and distance of a ring are negative, as in ISO 21771
    centre, tip, root = (orientation * length for length in (centre_distance, gear.tip_radius, gear.root_radius))
    return centre - pinion.tip_radius - root, centre - tip - pinion.root_radius


def path_ends(pinion: Gear, gear: Gear, line: float) -> tuple[float, float]:
    """Length of roll L_1, mm, at which the path of contact begins and ends on a line of action (mm, negative in a ring); no path where the end
    is not beyond the start. Where a ring stands first the rolls are its own."""
    orientation = pinion.orientation * gear.orientation
    tip, form = (line - orientation * roll for roll in (gear.tip_roll, gear.form_roll))  # the mate's, on the pinion
    if pinion.orientation > 0:
        return max(pinion.form_roll, tip), min(pinion.tip_roll, form)
    return max(pinion.tip_roll, form), min(pinion.form_roll, tip)


def reached_roll(member: Gear, mate: Gear, line: float) -> float:
    """Own length of roll that the mate's tip reaches, mm, on a line of action of this length; below 0 it passes the interference point."""
    return mate.orientation * (line - member.orientation * mate.tip_roll)


def tip_penetration(member: Gear, mate: Gear, centre_distance: float) -> float:
    """How deep the mate's tip corners dig into a gear's tooth while the drive flanks touch.

    Parameters
    ----------
    member, mate : Gear
        The gear whose tooth is dug into, and the one whose tip does it.
    centre_distance : float
        Working centre distance in mm, above the sum of the base radii, or with a ring above their difference.

    Returns
    -------
    float
        Greatest depth, mm of arc about the member's axis; 0 or a few 1e-15 where the tip clears.

    Notes
    -----
    Roll lengths of two touching flanks add up to the line of action, ``L1 + L2 = a sin α_w``, which ties the two
    rotations together. So the corner's path in the member's frame is known, and its polar angle is held against
    the generated tooth side. Above the form circle it only touches; what it can meet is the fillet.
    2001 positions: the depth is within 1e-6 of itself.
    """
    if member.spec.internal or mate.spec.internal:
        return _penetration_inside(member, mate, centre_distance)
    working = math.acos((member.base_radius + mate.base_radius) / centre_distance)
    deepest = 0.0
    corners = ((mate.flank_end_radius, float(mate.half_angle(mate.flank_end_radius))), (mate.tip_radius, mate.tip_half_angle))
    for radius, half_angle in corners:
        reach = (centre_distance**2 + radius**2 - member.tip_radius**2) / (2.0 * centre_distance * radius)
        if reach >= 1.0:
            continue  # the corner stays outside the own tip circle
        turn = math.acos(reach) * np.linspace(-1.0, 1.0, 2001)  # of the corner about the mate's axis, from the line of centres
        x, y = centre_distance - radius * np.cos(turn), radius * np.sin(turn)
        mate_roll = mate.base_radius * (working + mate.base_half_angle - (turn + half_angle))
        own_roll = centre_distance * math.sin(working) - mate_roll
        tooth = own_roll / member.base_radius - member.base_half_angle - working
        rho = np.hypot(x, y)
        depth = rho * (tooth + member.half_angle(np.clip(rho, member.root_radius, member.tip_radius)) - np.arctan2(y, x))
        deepest = max(deepest, float(depth.max()))
    return deepest


def _penetration_inside(member: Gear, mate: Gear, centre_distance: float) -> float:
    """`tip_penetration` with a ring: the ring at the origin, the pinion at (a, 0), the pinion's left flanks on the ring's right ones.

    There L2 − L1 = a sin α_w, and the common normal stands at −α_w to the line of centres on both: the tooth centre lines are at
    φ1 = L1 / r_b1 − α_w − ψ_b1 and φ2 = L2 / r_b2 − α_w + ψ_b2.
    """
    pinion, ring = (mate, member) if member.spec.internal else (member, mate)
    working = math.acos((ring.base_radius - pinion.base_radius) / centre_distance)
    line = centre_distance * math.sin(working)
    low, high = sorted((member.root_radius, member.tip_radius))
    deepest = 0.0
    corners = ((mate.flank_end_radius, float(mate.half_angle(mate.flank_end_radius))), (mate.tip_radius, mate.tip_half_angle))
    for radius, half_angle in corners:
        reach = -member.orientation * (member.tip_radius**2 - centre_distance**2 - radius**2) / (2.0 * centre_distance * radius)
        if reach >= 1.0:
            continue  # the corner stays outside the own tip circle
        turn = math.acos(max(reach, -1.0)) * np.linspace(-1.0, 1.0, 2001)  # of the corner about the mate's axis
        x, y = radius * np.cos(turn), radius * np.sin(turn)
        if member is ring:
            x = x + centre_distance
            roll = pinion.base_radius * (turn - half_angle + working + pinion.base_half_angle) + line
            tooth = roll / ring.base_radius - working + ring.base_half_angle
        else:
            x = x - centre_distance
            roll = ring.base_radius * (turn + half_angle + working - ring.base_half_angle) - line
            tooth = roll / pinion.base_radius - working - pinion.base_half_angle
        rho = np.hypot(x, y)
        half = member.half_angle(np.clip(rho, low, high))
        side = -member.orientation  # a ring's right flank, a pinion's left one
        depth = rho * (half + side * (np.arctan2(y, x) - tooth))
        deepest = max(deepest, float(depth.max()))
    return deepest
