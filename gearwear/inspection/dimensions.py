"""Dimensions a workshop checks a gear by: span, over pins, chordal thickness, constant chord.

The nominal ones are closed forms of the gear as drawn: with profile shift and thinning (ISO 21771:2007; formulas of the
reference geometry, base tangent ``W_k = (k − 1) p_b + s_b``), and with the flanks' modifications where the gauge touches at
mid-face. The measured ones add the flanks' deviations from that. On helical gears plates and balls touch normal to the flanks in space, so that the transverse
lengths of the spur formulas are multiplied or divided by cos β_b.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.drawn_gauge import DrawnGauge
from gearwear.design.gear import Gear
from gearwear.design.involute import inverse_involute, involute_function
from gearwear.design.quantity import as_given, at_least, at_most, outside
from gearwear.design.side import Side
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError
from gearwear.inspection.estimate import Estimate

STANDARD_PIN = 1.728
"""Usual pin for external gears, × normal module: the 1.728 series of Van Keuren (ashokagears.net/gear-size.html)."""

PLATE_HOLD = 3.0
"""mm of face width that the plates of a span need beyond W sin β_b to stand on helical flanks (Elements of Metric Gear Technology, from memory)."""

TOUCHING_STEPS = 5
"""In which the place where a pin touches a modified flank is found; with usual reliefs each leaves a fiftieth of what was off."""

LEAST_PLATE_SHARE = 0.05
"""Share of the face width, on either side of where a plate of a span touches helical flanks, that is looked at at least."""


@dataclass(frozen=True, slots=True)
class Span:
    """Base tangent length over k teeth.

    Parameters
    ----------
    teeth : int
        k.
    length : float
        W_k as drawn, mm.
    roll, radius : float
        L and r where the plates touch (evenly on both sides), mm.
    rise : float
        W sin β_b, mm: how much higher the plate on the right flank touches than the one on the left flank, each half of it from
        mid-face; negative on a left hand, 0 for spur gears.
    """

    teeth: int
    length: float
    roll: float
    radius: float
    rise: float = 0.0


@dataclass(frozen=True, slots=True)
class Pins:
    """Dimension over two pins or balls.

    Parameters
    ----------
    diameter : float
        D of the pin, mm.
    length : float
        M over both pins, of a ring between them, mm; with an odd number of teeth the pins lie in the spaces nearest to opposite. On helical gears over balls,
        both at one height.
    centre_angle, centre_radius : float
        α_M in rad and radius of the pin centre in mm.
    roll, radius : float
        L and r where a pin touches, mm.
    """

    diameter: float
    length: float
    centre_angle: float
    centre_radius: float
    roll: float
    radius: float

    @property
    def over_cylinders(self) -> float:
        """M in mm over two cylinders that lie in the spaces of a helical gear: between plates they settle opposite each other, also with an
        odd number of teeth. Of a spur gear with an even number it is `length`; with an odd one there is no such measure."""
        return 2.0 * self.centre_radius + self.diameter


@dataclass(frozen=True, slots=True)
class Chord:
    """A tooth caliper's setting: chordal `thickness`, and `height` of that chord below the tip, mm."""

    thickness: float
    height: float


@dataclass(frozen=True, slots=True)
class Dimensions:
    """Tooth thickness and the workshop's dimensions: nominal and measured, mm.

    `thickness` (teeth,) is arc at the reference circle, `chord_thickness` and `constant_chord_thickness` (teeth,) follow from it; `span_lengths` (teeth,) start on each tooth; `pin_lengths` are round the gear. A
    gauge that does not fit the gear is None and its lengths are empty.
    """

    thickness: Estimate
    span: Span | None
    span_lengths: Estimate
    pins: Pins | None
    pin_lengths: Estimate
    chord: Chord
    chord_thickness: Estimate
    constant_chord: Chord
    constant_chord_thickness: Estimate

    def drawn(self, gear: Gear) -> tuple[DrawnGauge, str] | None:
        """What the drawing states, and whether its limits are kept; None where it states no limits, or another number of teeth or pin was measured."""
        gauge = gear.spec.gauge
        if gauge is None:
            return None
        if gauge.pin_diameter is None:
            alike, measured = self.span is not None and self.span.teeth == gauge.teeth, self.span_lengths
        else:
            alike, measured = self.pins is not None and self.pins.diameter == gauge.pin_diameter, self.pin_lengths
        kept = gauge.kept(measured.value, measured.expanded) if alike else ""
        return (gauge, kept) if kept else None


def span(gear: Gear, teeth: int | None = None) -> Span:
    """Span over k teeth.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    teeth : int or None
        k; None: of those whose plates touch the involute and stand on the face the one that does so nearest to the shifted reference circle r + x m.

    Raises
    ------
    InputError
        If the gear is a ring, the plates would touch outside the involute, k leaves no space between the plates, or the face of a helical gear is too narrow:
        b < W sin β_b + 3 mm.

    Notes
    -----
    ``W_k = m_n cos α_n (π (k − ½) + z inv α_t) + 2 x m_n sin α_n − E_sn cos α_n`` with thinning E_sn, here as
    ``((k − 1) p_bt + 2 r_b ψ_b) cos β_b``. The plates are square to the flanks, whose normals lean by β_b: they touch at L = W cos β_b / 2
    and at ± W sin β_b / 2 from mid-face; what the flanks are modified by there, times cos β_b, is added.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> round(span(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))).length, 6)
    29.186274
    """
    refuse(gear, "a span", Toothing.INTERNAL)
    base_thickness, cosine = gear.base_thickness, gear.base_helix_cosine

    def touching(k: int) -> float:
        return 0.5 * ((k - 1) * gear.base_pitch + base_thickness) * cosine**2

    def needs(k: int) -> float:
        """Face width, mm."""
        return 2.0 * touching(k) * abs(math.tan(gear.base_helix_angle)) + PLATE_HOLD if gear.twist != 0.0 else 0.0

    fits = [k for k in range(1, gear.teeth) if gear.form_roll <= touching(k) <= gear.tip_roll]
    if teeth is None:
        wanted = _shifted_reference_roll(gear)
        stand = [k for k in fits if needs(k) <= gear.face_width] or fits[:1] or range(1, gear.teeth)
        teeth = min(stand, key=lambda k: abs(touching(k) - wanted))
    roll = touching(teeth)
    if teeth not in fits:
        right = f"{fits[0]} to {fits[-1]} teeth can be spanned" if fits else "no number of teeth can be spanned"
        raise InputError(
            f"[{gear.spec.name}] span over {teeth} teeth touches at a roll length of {outside(roll, gear.form_roll, gear.tip_roll, 5)} mm, the involute has {at_least(gear.form_roll)} to {at_most(gear.tip_roll)} mm: {right}"
        )
    if needs(teeth) > gear.face_width:
        raise InputError(
            f"[{gear.spec.name}] span over {teeth} teeth cannot be measured: on helical teeth its plates need a face width of {at_least(needs(teeth), 2)} mm, there are {as_given(gear.face_width)} mm; the dimension over balls can"
        )
    length = 2.0 * roll / cosine
    rise = length * gear.base_helix_sine
    drawn = sum(float(gear.drawn(side).offset(roll, height)) for side, height in _plate_heights(gear, rise).items())
    return Span(teeth, length + cosine * drawn, roll, math.hypot(gear.base_radius, roll), rise)


def _plate_heights(gear: Gear, rise: float) -> dict[Side, float]:
    """z at which the plates of a span touch, mm."""
    return {side: 0.5 * gear.face_width - side * 0.5 * rise for side in Side}


def plate_bands(gear: Gear, gauge: Span, face: tuple[float, float]) -> dict[Side, tuple[float, float]]:
    """Heights from and to (mm) round those at which the plates of a span touch, as much of the face as lies evenly about them."""
    bands = {}
    for side, z in _plate_heights(gear, gauge.rise).items():
        reach = max(min(z - face[0], face[1] - z), LEAST_PLATE_SHARE * gear.face_width)
        bands[side] = (z - reach, z + reach)
    return bands


def over_pins(gear: Gear, diameter: float | None = None) -> Pins:
    """Dimension over pins or balls.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    diameter : float or None
        Of the pin, mm. None: 1.728 m if it touches the involute and stands out of the teeth, else the pin that touches at the
        shifted reference circle.

    Raises
    ------
    InputError
        If the pin touches outside the involute, rests on the root, or stays below the tips.

    Notes
    -----
    ``inv α_M = D / (2 r_b cos β_b) + ψ_b − π / z``; ``M = 2 r_b / cos α_M + D``, for odd z the first term times cos(90° / z). A ball
    touches at ``L = r_b tan α_M − (D / 2) cos β_b``. Of a ring the measure is that **between** them: inv α_M and D change sign in all three.
    Modified flanks make ψ_b greater by ``δ₀ / (2 r_b)`` of both.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> round(over_pins(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))).length, 6)
    91.17177
    """
    if diameter is None:
        usual = STANDARD_PIN * gear.spec.normal_module
        pins = _pins(gear, usual)
        if pins is None or _pin_fault(gear, pins):
            pins = _pins(gear, _pin_at(gear, _shifted_reference_roll(gear)))
    else:
        pins = _pins(gear, diameter)
    if pins is None:
        fault = "does not go into the space: a smaller" if gear.spec.internal else "falls through to the root: a larger"
        raise InputError(f"[{gear.spec.name}] a pin of {diameter or 0.0:g} mm {fault} one touches the flanks")
    fault = _pin_fault(gear, pins)
    if fault:
        right = _pin_at(gear, _shifted_reference_roll(gear))
        raise InputError(
            f"[{gear.spec.name}] a pin of {pins.diameter:.4f} mm {fault}; {right:.4f} mm would touch at the reference circle"
        )
    return _on_drawn(gear, pins)


def pins_touching(gear: Gear, roll: float) -> Pins | None:
    """Pins that touch the involute at L = `roll` mm; None where such a pin does not stand out of the teeth."""
    pins = _pins(gear, _pin_at(gear, roll))
    return None if pins is None or _pin_fault(gear, pins) else _on_drawn(gear, pins)


def chordal(gear: Gear) -> Chord:
    """Chordal thickness and height at the reference circle: ``2 r sin(s / 2r)`` and ``r_a − r cos(s / 2r)``, s as drawn.

    Of helical teeth in the normal section, with the normal arc and ``r_v = r / cos² β`` of the virtual gear of z / cos³ β teeth (SDP/SI,
    Elements of Metric Gear Technology, table 10-3).

    >>> from gearwear.design import GearSpec
    >>> c = chordal(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0)))
    >>> round(c.thickness, 6), round(c.height, 6)
    (9.946096, 6.675951)
    """
    r = _normal_radius(gear)
    half = _normal_thickness(gear) / (2.0 * r)
    height = gear.tip_radius + (r - gear.reference_radius) - r * math.cos(half)
    return Chord(2.0 * r * math.sin(half), gear.orientation * height)


def _normal_thickness(gear: Gear) -> float:
    """Normal arc of the tooth as drawn at the reference circle, mm."""
    return gear.drawn_tooth_thickness * math.cos(gear.spec.helix_angle)


def _normal_radius(gear: Gear) -> float:
    """Reference radius of the virtual gear in the normal section, mm."""
    return gear.reference_radius / math.cos(gear.helix_angle) ** 2


def constant_chord(gear: Gear) -> Chord:
    """Constant chord ``s cos² α`` (where a rack touches) and its height ``r_a − r − ½ s cos α sin α``; free of the number of teeth.
    Of helical teeth all of it in the normal section.

    >>> from gearwear.design import GearSpec
    >>> c = constant_chord(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0)))
    >>> round(c.thickness, 6), round(c.height, 6)
    (8.807755, 4.74712)
    """
    if gear.spec.internal:
        return Chord(math.nan, math.nan)  # no rack touches a ring
    alpha = gear.normal_pressure_angle
    chord = _normal_thickness(gear) * math.cos(alpha) ** 2
    return Chord(chord, gear.tip_radius - gear.reference_radius - 0.5 * chord * math.tan(alpha))


def measured_span(positions: Estimate, gear: Gear, gauge: Span) -> Estimate:
    """Span over k teeth at every place round the gear, (teeth,) mm; entry i starts on tooth i and goes counter-clockwise.

    Parameters
    ----------
    positions : Estimate
        (teeth, 2) deviations δ from the flanks as drawn, along the transverse base tangent, at the gauge's contact roll length and heights, mm.
    gear : Gear
        The nominal gear.
    gauge : Span
        Nominal span.

    Notes
    -----
    ``W = W_k + (δ_right(i) + δ_left(i + k − 1)) cos β_b``: the plates touch along the normal. How the scan was
    registered does not change what lies between flanks of the same gear: only the flanks' own errors count, here and over pins.
    """
    cosine = gear.base_helix_cosine
    right, left = positions.value[:, Side.RIGHT.index], np.roll(positions.value[:, Side.LEFT.index], 1 - gauge.teeth)
    return Estimate.plain(
        gauge.length + cosine * right + cosine * left,
        cosine * np.hypot(positions.own[:, Side.RIGHT.index], np.roll(positions.own[:, Side.LEFT.index], 1 - gauge.teeth)),
    )


def measured_chordal(thickness: Estimate, gear: Gear) -> Estimate:
    """Chordal thickness of every tooth at the reference circle, (teeth,) mm, from its transverse arc thickness (teeth,)."""
    r, normal = _normal_radius(gear), math.cos(gear.helix_angle)
    half = normal * thickness.value / (2.0 * r)
    return Estimate.plain(2.0 * r * np.sin(half), np.cos(half) * normal * thickness.standard)


def measured_constant_chord(thickness: Estimate, gear: Gear) -> Estimate:
    """Constant chord of every tooth, (teeth,) mm, from its transverse arc thickness: ``s_n cos² α_n``."""
    share = math.cos(gear.helix_angle) * math.cos(gear.normal_pressure_angle) ** 2 * (math.nan if gear.spec.internal else 1.0)
    return Estimate.plain(share * thickness.value, share * thickness.standard)


def measured_over_pins(positions: Estimate, gear: Gear, pins: Pins) -> Estimate:
    """Dimension over pins at every place round the gear, mm: (z/2,) for even z, (z,) for odd z.

    Entry i has one pin in the space on the counter-clockwise side of tooth i, the other z // 2 spaces further.

    Parameters
    ----------
    positions : Estimate
        (teeth, 2) deviations δ from the flanks as drawn, along the transverse base tangent at the pins' contact roll length, mm.
    gear : Gear
        The nominal gear.
    pins : Pins
        Nominal dimension.

    Notes
    -----
    Every pin centre from its own two flanks as in `pitch.runout`, turned by ``(δ_left − δ_right) / (2 r_b)``; M is the
    distance of the centres and D.
    """
    z, rb = gear.teeth, gear.base_radius
    left, right = at_spaces(positions.value)
    radius = pin_radii(gear, pins, left + right)
    turn = (left - right) / (2.0 * rb)
    across = np.hypot(*at_spaces(positions.own)) / (2.0 * math.sin(pins.centre_angle))
    first = np.arange(z // 2 if z % 2 == 0 else z)
    second = (first + z // 2) % z
    angle = (z // 2) * gear.pitch_angle + turn[second] - turn[first]
    a, b = radius[first], radius[second]
    distance = np.sqrt(a * a + b * b - 2.0 * a * b * np.cos(angle))
    share = math.sin(0.5 * (z // 2) * gear.pitch_angle)  # cos(90°/z) for odd z
    return Estimate.plain(distance + gear.orientation * pins.diameter, share * np.hypot(across[first], across[second]))


def pin_growth(gear: Gear, pins: Pins) -> float:
    """By how much the dimension over pins grows, mm, for a gear that is larger by a share of 1, to first order; its pins stay as they are."""
    across = (
        pins.length - gear.orientation * pins.diameter
    ) / pins.centre_radius  # 2, with an odd number of teeth 2 cos(90° / z)
    return across * abs(pins.roll) / math.sin(pins.centre_angle)


def at_spaces(values: Floats) -> tuple[Floats, Floats]:
    """Values (teeth, 2, …) of the two flanks of each space: left of the tooth before it, right of the tooth behind it."""
    return values[:, Side.LEFT.index], np.roll(values[:, Side.RIGHT.index], -1, axis=0)


def pin_radii(gear: Gear, pins: Pins, thicker: Floats) -> Floats:
    """(z,) radius of the centre of a pin in each space, mm: ``inv α = inv α_M + δ / (2 r_b)``; δ is how much thicker its two flanks are, mm,
    nan where one was not seen."""
    involute = involute_function(pins.centre_angle) + gear.orientation * thicker / (2.0 * gear.base_radius)
    seen, radius = np.isfinite(involute), np.full(gear.teeth, np.nan)
    radius[seen] = [gear.base_radius / math.cos(inverse_involute(max(0.0, value))) for value in involute[seen]]
    return radius


def _shifted_reference_roll(gear: Gear) -> float:
    """L at r + x m, of a ring r − x m, kept inside the involute's middle 80 %, mm."""
    shift = gear.orientation * gear.spec.profile_shift * gear.spec.normal_module
    radius = max(gear.reference_radius + shift, gear.base_radius)
    roll = float(gear.roll_length(radius))
    reach = gear.tip_roll - gear.form_roll
    low, high = sorted((gear.form_roll + 0.1 * reach, gear.tip_roll - 0.1 * reach))
    return min(max(roll, low), high)


def _pin_at(gear: Gear, roll: float) -> float:
    """Diameter of the pin that touches at L = `roll`: its centre is on the space's middle, ``(D/2) cos β_b = r_b tan α_M − L``; that in the
    equation of `over_pins` leaves ``α_M + tan² β_b tan α_M = L / (r_b cos² β_b) − ψ_b + π/z``, closed form where β_b = 0. Newton comes down
    on the root from above: the left side is convex, and at the start not below the right one. Of a ring D, ψ_b and π/z change sign."""
    cosine, slope, orientation = gear.base_helix_cosine, math.tan(gear.base_helix_angle) ** 2, gear.orientation
    right = roll / (gear.base_radius * cosine**2) - orientation * gear.base_half_angle + orientation * math.pi / gear.teeth
    angle = right / (1.0 + slope)
    for _ in range(20):
        step = (angle + slope * math.tan(angle) - right) / (1.0 + slope / math.cos(angle) ** 2)
        angle -= step
        if abs(step) <= 1e-16 * abs(angle):
            break
    return orientation * 2.0 * (gear.base_radius * math.tan(angle) - roll) / cosine


def _pins(gear: Gear, diameter: float) -> Pins | None:
    """The numbers of a pin of any size; None where its centre would lie inside the base circle."""
    rb, z, orientation = gear.base_radius, gear.teeth, gear.orientation
    involute = orientation * (diameter / (2.0 * rb * gear.base_helix_cosine) + gear.base_half_angle - math.pi / z)
    if not (diameter > 0.0 and involute >= 0.0):
        return None
    return _pins_at(gear, diameter, inverse_involute(involute), 0.0)


def _pins_at(gear: Gear, diameter: float, angle: float, excess: float) -> Pins:
    """The numbers of a pin whose centre is at α_M = `angle`, between flanks that stand out by `excess` (mm) where it touches."""
    rb, orientation = gear.base_radius, gear.orientation
    centre = rb / math.cos(angle)
    odd = math.cos(0.5 * math.pi / gear.teeth) if gear.teeth % 2 else 1.0
    roll = rb * math.tan(angle) - orientation * (0.5 * diameter * gear.base_helix_cosine + excess)
    return Pins(diameter, 2.0 * centre * odd + orientation * diameter, angle, centre, roll, math.hypot(rb, roll))


def _on_drawn(gear: Gear, pins: Pins) -> Pins:
    """Pins as they lie between modified flanks: where they touch depends on what the flanks are modified by there, to a step or two."""
    touching = pins
    for _ in range(TOUCHING_STEPS if gear.modified else 0):
        excess, orientation = gear.drawn_excess(touching.roll), gear.orientation
        involute = involute_function(pins.centre_angle) + orientation * excess / (2.0 * gear.base_radius)
        touching = _pins_at(gear, pins.diameter, inverse_involute(max(0.0, involute)), 0.5 * excess)
    return touching


def _pin_fault(gear: Gear, pins: Pins) -> str:
    """What is wrong with a pin, or nothing."""
    orientation, half = gear.orientation, 0.5 * pins.diameter
    if not orientation * gear.form_roll <= orientation * pins.roll <= orientation * gear.tip_roll:
        low, high = sorted((gear.form_roll, gear.tip_roll))
        return f"touches at a roll length of {outside(pins.roll, low, high, 5)} mm, the involute has {at_least(low)} to {at_most(high)} mm"
    if orientation * (pins.centre_radius - gear.root_radius) <= half:
        return f"rests on the root circle (diameter {2 * gear.root_radius:.4f} mm)"
    if orientation * (pins.centre_radius - gear.tip_radius) <= -half:
        return f"does not stand out of the tip circle (diameter {2 * gear.tip_radius:.4f} mm)"
    return ""
