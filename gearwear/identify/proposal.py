"""Which standard gear has the measured dimensions: modules, pressure angles and tooth depths in use, best first.

Every dimension a workshop measures is linear in profile shift x, thinning A_s and tip shortening k once module and pressure angle are given
(and, on a scan, in the thickness c of a coat and the error e of the scale), so each combination is one small least-squares problem. What is
seldom seen must pay for itself: a candidate's cost is

    Σ (residual / σ)² + rarity of module, angle and depth + for each of x, A_s, k, c, e in use: (value / width)² + 2 ln (width / σ)

the last being the price of a free number (−2 ln of the evidence under a Gaussian prior, in closed form: the Occam factor).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from gearwear.design.involute import involute_function
from gearwear.design.quantity import shown
from gearwear.design.spec import FEWEST_TEETH, MOST_TEETH, GearSpec
from gearwear.design.standards import ANGLES, DEPTHS, RING_DEPTHS, Depth, Module, modules_near
from gearwear.errors import InputError
from gearwear.identify.gauges import SPUR, Gauge, Helix
from gearwear.identify.unknowns import (
    COAT,
    ROUND_GAIN,
    ROUND_SHIFTS,
    SCALE,
    SHIFT,
    SHIFT_WIDTH,
    SHORTENING,
    THINNING,
    Fitted,
    Row,
    fit,
    round_price,
    shift_std,
    solved,
    with_round_shift,
)

ANGLE_KINDS = frozenset({"span", "over_pins", "thickness", "base_pitch"})
"""What depends on the pressure angle."""
TIP_SPREAD, ROOT_SPREAD = 0.008, 0.02
"""How far real tip and root radii lie from their system, standard deviation in modules: tolerances, shortened tips, other tools."""
FREE_MODULE = 20.0
"""Rarity of a module that is in no series."""
ROUNDING = 1e-6
"""Of costs: by so much a least one may seem too high."""
OFF = 3.0
"""Own standard deviations of tip and root beyond which both are off, and within which they are so by the same amount."""
MODULE_RANGE = (1e-3, 1e3)
"""mm; what a design may have."""
ANGLE_RANGE = (5.0, 45.0)
"""Degrees; what a design may have."""


@dataclass(frozen=True, slots=True)
class Proposal:
    """A gear that could have the measured dimensions.

    Parameters
    ----------
    teeth : int
    module : Module
    pressure_angle : float
        rad.
    depth : Depth
        Addendum and dedendum, in modules.
    profile_shift : float
        In modules.
    thinning : float
        mm of normal arc at the reference circle.
    shortening : float
        Tip shortening k in modules.
    coat : float
        How far all surfaces of the scan lie above the design, mm: no part of the gear.
    scale : float
        What all lengths of the scan are too long by, relative: no part of the gear.
    residuals : tuple of float
        Measured − proposed for each gauge, mm.
    cost : float
        Smaller is better; a difference of 6 is strong, 10 very strong.
    shift_std : float
        Standard deviation of the profile shift by the dimensions alone, whether it is 0, round or free, in modules.
    helix_angle : float
        β at the reference circle, rad, + right hand; of a double helical gear that of the half at z = 0.
    internal : bool
        A ring.
    """

    teeth: int
    module: Module
    pressure_angle: float
    depth: Depth
    profile_shift: float
    thinning: float
    shortening: float
    coat: float
    scale: float
    residuals: tuple[float, ...]
    cost: float
    shift_std: float
    helix_angle: float = 0.0
    internal: bool = False

    @property
    def tip_diameter(self) -> float:
        """Of the depth system less the shortening, mm."""
        return self._diameter(self.depth.addendum + self.profile_shift - self.shortening)

    @property
    def root_diameter(self) -> float:
        """Of the depth system, mm."""
        return self._diameter(-self.depth.dedendum + self.profile_shift)

    def _diameter(self, height: float) -> float:
        """Of the circle at a height of the tooth above its reference circle, in modules."""
        return self.module.mm * (self.teeth / math.cos(self.helix_angle) + 2.0 * _orientation(self.internal) * height)

    @property
    def name(self) -> str:
        """Module, angle, shift and what is unusual, in one line."""
        parts = [f"{self.module.name}, {math.degrees(self.pressure_angle):g}°"]
        if self.helix_angle:
            parts.append(f"helix {math.degrees(abs(self.helix_angle)):g}° {'right' if self.helix_angle > 0.0 else 'left'} hand")
        if self.profile_shift:
            parts.append(f"shift {self.profile_shift:+z.3f}")
        if self.thinning:
            parts.append(f"thinning {self.thinning:+z.3f} mm")
        if self.shortening:
            parts.append(f"tip shortened by {self.shortening:.3f} modules")
        if self.coat:
            parts.append(f"under a coat of {self.coat:.3f} mm")
        if self.scale:
            parts.append(f"scanned {100 * abs(self.scale):.2f} % too {'large' if self.scale > 0.0 else 'small'}")
        if self.depth is not _depths(self.internal)[0]:
            parts.append(self.depth.name)
        return ", ".join(parts)


def check_known(module: float | None, pressure_angle: float | None) -> None:
    """Refuse a module (mm) or a pressure angle (rad), stated as known, that no gear has."""
    for name, value, (low, high), unit in (
        ("module", module, MODULE_RANGE, " mm"),
        ("pressure angle", None if pressure_angle is None else math.degrees(pressure_angle), ANGLE_RANGE, "°"),
    ):
        if value is not None and not low <= value <= high:  # refuses NaN too
            raise InputError(f"{name} {value:g}{unit}: from {low:g} to {high:g}{unit} would be right")


def propose(
    teeth: int,
    gauges: Sequence[Gauge],
    module: float | None = None,
    pressure_angle: float | None = None,
    scale_doubt: float | None = None,
    most: int = 6,
    helix: Helix = SPUR,
    internal: bool = False,
) -> tuple[Proposal, ...]:
    """Find the standard gears that have the measured dimensions.

    Parameters
    ----------
    teeth : int
        z.
    gauges : sequence of Gauge
        At least one that tells the size: a diameter, a span, a dimension over pins or a base pitch.
    module : float or None
        mm, where it is known; None: all standard ones that come near, and the one that fits best without a standard.
    pressure_angle : float or None
        rad, where it is known; None: those in use.
    scale_doubt : float or None
        Relative standard deviation of the scale of a scan, whose surfaces may also lie too high; 0: of a scan of known scale;
        None: not a scan.
    most : int
        How many to return.
    helix : Helix
        Of the teeth; modules, angles, shift and thinning are then those of the normal section.
    internal : bool
        A ring: its shift is that of ISO 21771, + for thicker teeth and a smaller tip circle.

    Returns
    -------
    tuple of Proposal
        Best first; a module and pressure angle appear once. Of a scan the best is followed by itself with the round profile shift next to its
        own, where the dimensions hardly tell the two apart, and with any shift where a round one leaves
        tip and root off by the same radial amount; that one comes first where it costs less, its price included.

    Raises
    ------
    InputError
        If no gear has these dimensions, module or pressure angle, or nothing tells the size.

    Examples
    --------
    >>> from gearwear.identify.gauges import Measured
    >>> best = propose(12, [Gauge("tip_diameter", Measured(88.9, 0.05)), Gauge("root_diameter", Measured(60.3, 0.05))])[0]
    >>> best.name
    'diametral pitch 4 (module 6.35), 20°'
    >>> [round(1e3 * residual) for residual in best.residuals]    # µm
    [0, -25]
    """
    if not (FEWEST_TEETH <= teeth <= MOST_TEETH and teeth == int(teeth)):
        raise InputError(f"teeth = {shown(teeth)}: must be a whole number from {FEWEST_TEETH} to {MOST_TEETH}")
    check_known(module, pressure_angle)
    for gauge in gauges:
        _check(gauge, teeth)
    sized = [g for g in gauges if g.kind != "thickness"]
    if module is None and not sized:
        raise InputError("nothing tells the size: a tip diameter, a span, a dimension over pins or a module is needed")
    angles = ((pressure_angle, 0.0),) if pressure_angle is not None else ANGLES if tells_angle(gauges) else ANGLES[:1]
    choices: list[tuple[int, ...]] = [(), (SHIFT,), (SHIFT, SHORTENING)]
    if tells_thickness(gauges):
        choices += [(*choice, THINNING) for choice in choices]
    if scale_doubt is not None:
        choices += [(*choice, COAT) for choice in choices]
    if scale_doubt:
        choices += [(*choice, SCALE) for choice in choices]
    likely = list[_Likely]()
    for angle, rarity in angles:
        beta = helix.at_reference(angle)
        if beta is None:
            continue
        wanted = (
            [Module(module, f"module {module:g}", 0.0)] if module is not None else _modules(teeth, gauges, angle, beta, internal)
        )
        for standard in wanted:
            for depth in _depths(internal):
                rows = [_row(teeth, gauge, standard.mm, angle, depth, beta, internal) for gauge in gauges]
                known = [row for row in rows if row is not None]
                if len(known) == len(rows):
                    # What all unknowns together leave is the least that any choice of them comes to.
                    least = solved(known, standard.mm, choices[-1], scale_doubt or 0.0).square
                    rare = standard.rarity + rarity + depth.rarity
                    likely.append(_Likely(least + rare, rare, standard, angle, beta, depth, known))
    proposals: dict[tuple[float, float], Proposal] = {}
    for least, rare, standard, angle, beta, depth, known in sorted(likely, key=lambda gear: gear.least):
        costs, key = sorted(proposal.cost for proposal in proposals.values()), (standard.mm, angle)
        if len(costs) >= most and least > costs[most - 1] + ROUNDING:
            break
        if key in proposals and least > proposals[key].cost + ROUNDING:
            continue
        for free in choices:
            fitted = fit(known, standard.mm, free, scale_doubt or 0.0)
            if fitted is None:
                continue
            values, residuals, cost = fitted
            if scale_doubt is not None and SHIFT in free:
                values, residuals, cost = with_round_shift(known, standard.mm, free, scale_doubt, fitted)
            cost += rare
            if key not in proposals or cost < proposals[key].cost:
                shift, thinning, shortening, coat, scale = values
                proposals[key] = Proposal(
                    teeth=teeth, module=standard, pressure_angle=angle, depth=depth, profile_shift=shift, thinning=thinning,
                    shortening=shortening, coat=coat, scale=scale, residuals=residuals, cost=cost,
                    shift_std=shift_std(known, standard.mm), helix_angle=beta, internal=internal,
                )  # fmt: skip
    if not proposals:
        raise InputError(f"no gear of {teeth} teeth has these dimensions: {_listed(gauges)}; check them and their unit (mm)")
    ranked = sorted(proposals.values(), key=lambda proposal: proposal.cost)[:most]
    if scale_doubt is None:
        return tuple(ranked)
    other = _other_shift(ranked[0], gauges, choices, scale_doubt)
    followed = [*([] if other is None else [other]), *ranked[1:]]
    two = _free_shift(ranked[0], gauges, choices, scale_doubt)
    return tuple(sorted((*two, *followed), key=lambda proposal: proposal.cost)) if two else (ranked[0], *followed)


def spec_of(proposal: Proposal, face_width: float, body_diameter: float = 0.0, name: str = "gear", gap: float = 0.0) -> GearSpec:
    """Specification of a proposed gear; the rack's tip radius is the usual 0.30 modules, or less where the rack has no room for it.

    Parameters
    ----------
    proposal : Proposal
    face_width : float
        mm.
    body_diameter : float
        Of the bore, of a ring that of its outside, mm; 0 where there is none.
    name : str
        "pinion" or "gear".
    gap : float
        Between the halves of a double helical gear, mm.
    """
    depth = proposal.depth
    if proposal.internal:
        return GearSpec(
            name, proposal.teeth, proposal.module.mm, face_width, normal_pressure_angle=proposal.pressure_angle,
            profile_shift=proposal.profile_shift, addendum=round(depth.addendum - proposal.shortening, 6), dedendum=depth.dedendum,
            thinning=proposal.thinning, thinning_measured=proposal.thinning > 0.0, helix_angle=proposal.helix_angle, internal=True,
            rim_diameter=body_diameter,
        )  # fmt: skip
    slope = (1.0 - math.sin(proposal.pressure_angle)) / math.cos(proposal.pressure_angle)
    half_space = 0.25 * math.pi + 0.5 * proposal.thinning / proposal.module.mm
    room = (half_space - depth.dedendum * math.tan(proposal.pressure_angle)) / slope
    return GearSpec(
        name,
        proposal.teeth,
        proposal.module.mm,
        face_width,
        normal_pressure_angle=proposal.pressure_angle,
        profile_shift=proposal.profile_shift,
        addendum=round(depth.addendum - proposal.shortening, 6),
        dedendum=depth.dedendum,
        rack_tip_radius=max(0.0, min(0.3, math.floor(100.0 * room) / 100.0)),
        thinning=proposal.thinning,
        thinning_measured=proposal.thinning > 0.0,
        bore_diameter=body_diameter,
        helix_angle=proposal.helix_angle,
        gap=gap,
    )


def tells_angle(gauges: Sequence[Gauge]) -> bool:
    """Whether any of the dimensions depends on the pressure angle; else 20° is assumed."""
    return any(gauge.kind in ANGLE_KINDS for gauge in gauges)


def tells_thickness(gauges: Sequence[Gauge]) -> bool:
    """Whether any of the dimensions depends on the tooth thickness; else none is thinned."""
    return any(gauge.kind in ANGLE_KINDS - {"base_pitch"} for gauge in gauges)


def _check(gauge: Gauge, teeth: int) -> None:
    value, std = gauge.length.value, gauge.length.std
    if not (0.0 < value < math.inf and 0.0 < std < math.inf):
        raise InputError(f"{gauge.name} = {value:g} mm (± {std:g}): must be above 0")
    if gauge.kind == "span" and not (
        1 <= gauge.at < teeth and gauge.at == int(gauge.at)
    ):  # in this order: inf and nan have no int
        raise InputError(f"span over {gauge.at:g} teeth: a whole number from 1 to {teeth - 1} would be right")
    if gauge.kind == "over_pins" and not 0.0 < gauge.at < value:
        raise InputError(
            f"pins of {gauge.at:g} mm with {value:g} mm over them: a pin above 0 mm and below {value:g} mm would be right"
        )


def _listed(gauges: Sequence[Gauge]) -> str:
    return ", ".join(f"{gauge.name} {gauge.length.value:g} mm" for gauge in gauges)


def _orientation(internal: bool) -> float:
    """ι: −1 of a ring."""
    return -1.0 if internal else 1.0


def _depths(internal: bool) -> tuple[Depth, ...]:
    return RING_DEPTHS if internal else DEPTHS


def _modules(teeth: int, gauges: Sequence[Gauge], angle: float, helix: float, internal: bool) -> list[Module]:
    """Standard modules within reach of any gauge, and the free ones that some gauges ask for."""
    guesses = [guess for gauge in gauges if (guess := _module_of(teeth, gauge, angle, helix, internal)) is not None]
    diameter = {gauge.kind: gauge.length.value for gauge in gauges}
    free = [
        guess
        for gauge in gauges
        if gauge.kind == "base_pitch" and (guess := _module_of(teeth, gauge, angle, helix, internal)) is not None
    ]
    if "tip_diameter" in diameter and "root_diameter" in diameter:
        height = 0.5 * _orientation(internal) * (diameter["tip_diameter"] - diameter["root_diameter"])
        if height > 0.0:
            guesses.append(height / (DEPTHS[0].addendum + DEPTHS[0].dedendum))
            free = free or guesses[-1:]
    low, high = MODULE_RANGE
    guesses = [guess for guess in guesses if low <= guess <= high]
    if not guesses:
        return []
    free = [guess for guess in free or guesses[:1] if low <= guess <= high]
    return [
        *modules_near(0.75 * min(guesses), 1.3 * max(guesses)),
        *(Module(g, f"module {g:.4g} (no standard)", FREE_MODULE) for g in free),
    ]


def _module_of(teeth: int, gauge: Gauge, angle: float, helix: float, internal: bool) -> float | None:
    """Normal module that a standard gear of this dimension would have, mm."""
    value, cos = gauge.length.value, math.cos(angle)
    size = teeth / math.cos(helix)  # reference diameter in modules
    if gauge.kind == "tip_diameter":
        return value / (size + 2.0 * _orientation(internal))
    if gauge.kind == "root_diameter":
        return value / (size - 2.5 * _orientation(internal))
    if gauge.kind == "base_pitch":
        return value * _base_cosine(angle, helix) / (math.pi * cos)
    if gauge.kind == "span":
        return value / (cos * (math.pi * (gauge.at - 0.5) + teeth * involute_function(_transverse(angle, helix))))
    if gauge.kind == "over_pins":
        return (value - 1.6 * gauge.at) / size if value > 1.6 * gauge.at else None
    return None


def _transverse(angle: float, helix: float) -> float:
    """Transverse pressure angle, rad."""
    return math.atan(math.tan(angle) / math.cos(helix)) if helix else angle


def _base_cosine(angle: float, helix: float) -> float:
    """cos β_b."""
    return math.cos(math.asin(math.sin(helix) * math.cos(angle)))


def _other_shift(
    best: Proposal, gauges: Sequence[Gauge], choices: Sequence[tuple[int, ...]], scale_doubt: float
) -> Proposal | None:
    """The best proposal of a scan with a profile shift a tenth of a module beside its own round one; None where the dimensions tell them apart."""
    if abs(10.0 * best.profile_shift - round(10.0 * best.profile_shift)) > 1e-6:
        return None
    m, angle, beta = best.module.mm, best.pressure_angle, best.helix_angle
    nearest, least = None, best.cost + ROUND_GAIN
    rarity = best.module.rarity + dict(ANGLES).get(angle, 0.0) + 2.0 * math.log(ROUND_SHIFTS)
    for depth in _depths(best.internal):
        rows = [row for gauge in gauges if (row := _row(best.teeth, gauge, m, angle, depth, beta, best.internal)) is not None]
        for free, step in itertools.product([unknowns for unknowns in choices if SHIFT not in unknowns], (-1, 1)):
            shift = round(10.0 * best.profile_shift + step) / 10.0
            held = fit(rows, m, free, scale_doubt, shift)
            cost = math.inf if held is None else held[2] + rarity + depth.rarity + (shift / SHIFT_WIDTH) ** 2
            if held is not None and cost < least:
                _, thinning, shortening, coat, scale = held[0]
                nearest, least = replace(
                    best, depth=depth, profile_shift=shift, thinning=thinning, shortening=shortening, coat=coat, scale=scale,
                    residuals=held[1], cost=max(cost, best.cost),
                ), cost  # fmt: skip
    return nearest


def _free_shift(
    best: Proposal, gauges: Sequence[Gauge], choices: Sequence[tuple[int, ...]], scale_doubt: float
) -> tuple[Proposal, ...]:
    """The best proposal of a scan, at what a round shift of its costs, and the best one with any shift; none unless tip and root are off alike.

    Both lie as far out, or in, beyond what they are known to on a scan of true scale: that another scale would do it too is no reason.
    """
    off = {
        gauge.kind: (residual + best.scale * gauge.length.value, gauge.length.own_std)
        for gauge, residual in zip(gauges, best.residuals, strict=True)
    }
    if not {"tip_diameter", "root_diameter"} <= off.keys():
        return ()
    (tip, tip_std), (root, root_std) = off["tip_diameter"], off["root_diameter"]
    far = tip * root > 0.0 and abs(tip) > OFF * tip_std and abs(root) > OFF * root_std
    if not far or abs(tip - root) > OFF * math.hypot(tip_std, root_std):
        return ()
    m, angle, beta = best.module.mm, best.pressure_angle, best.helix_angle
    rarity = best.module.rarity + dict(ANGLES).get(angle, 0.0)
    fits = list[tuple[float, Depth, Fitted]]()
    held = best.cost
    for depth in _depths(best.internal):
        rows = [row for gauge in gauges if (row := _row(best.teeth, gauge, m, angle, depth, beta, best.internal)) is not None]
        for free in choices:
            if SHIFT not in free and depth is best.depth:
                fitted = fit(rows, m, free, scale_doubt, best.profile_shift)
                price = round_price(best.profile_shift)
                if fitted is not None and fitted[0] == _unknowns(best) and (price or not best.profile_shift):
                    held = max(held, fitted[2] + rarity + depth.rarity + price)
            elif SHIFT in free and COAT not in free and SCALE not in free:  # either explains the same
                fitted = fit(rows, m, free, scale_doubt)
                if fitted is not None:
                    fits.append((fitted[2] + rarity + depth.rarity, depth, fitted))
    if not fits:
        return ()
    cost, depth, (values, residuals, _) = min(fits, key=lambda one: one[0])
    if values == _unknowns(best):
        return ()
    shift, thinning, shortening, coat, scale = values
    other = replace(
        best, depth=depth, profile_shift=shift, thinning=thinning, shortening=shortening, coat=coat, scale=scale,
        residuals=residuals, cost=cost,
    )  # fmt: skip
    return replace(best, cost=held), other


def _unknowns(proposal: Proposal) -> tuple[float, float, float, float, float]:
    return proposal.profile_shift, proposal.thinning, proposal.shortening, proposal.coat, proposal.scale


class _Likely(NamedTuple):
    """Module, pressure angle, helix angle and depth; the least that they may cost, and what of it is rarity."""

    least: float
    rare: float
    module: Module
    angle: float
    beta: float
    depth: Depth
    rows: list[Row]


def _row(teeth: int, gauge: Gauge, m: float, angle: float, depth: Depth, helix: float, internal: bool) -> Row | None:
    """Measured − proposed with all unknowns 0, in mm, the proposed one's slope with (x, A_s, k, c, e), and σ in mm; None: impossible.

    `m` and `angle` are of the normal section.
    """
    value, std = gauge.length.value, gauge.length.std
    cos, sin, tan, cos_helix = math.cos(angle), math.sin(angle), math.tan(angle), math.cos(helix)
    transverse, cos_base, size = _transverse(angle, helix), _base_cosine(angle, helix), teeth / cos_helix
    r, inv, ring = 0.5 * m * size, involute_function(transverse), _orientation(internal)
    if gauge.kind == "tip_diameter":
        return (
            value - m * (size + 2.0 * ring * depth.addendum),
            (2.0 * ring * m, 0.0, -2.0 * ring * m, 2.0 * ring, value),
            math.hypot(std, 2.0 * TIP_SPREAD * m),
        )
    if gauge.kind == "root_diameter":
        plain = m * (size - 2.0 * ring * depth.dedendum)
        return value - plain, (2.0 * ring * m, 0.0, 0.0, 2.0 * ring, value), math.hypot(std, 2.0 * ROOT_SPREAD * m)
    if gauge.kind == "base_pitch":
        return value - math.pi * m * cos / cos_base, (0.0, 0.0, 0.0, 0.0, value), std
    if gauge.kind == "span":
        plain = m * cos * (math.pi * (gauge.at - 0.5) + teeth * inv)
        return value - plain, (2.0 * m * sin, -cos, 0.0, 2.0, value), std
    # The rest measure an arc: turned into the normal thickness at the reference circle, which is s = π m / 2 + 2 x m tan α − A_s.
    rb = r * math.cos(transverse)
    if gauge.kind == "thickness":
        at = 0.5 * gauge.at
        if at <= rb:
            return None
        arc = r * (value / at + 2.0 * ring * (involute_function(math.acos(rb / at)) - inv))
        gain = at / r / cos_helix
    else:
        odd = math.cos(0.5 * math.pi / teeth) if teeth % 2 else 1.0
        centre = 0.5 * (value - gauge.at) / odd
        if centre <= rb:
            return None
        pin = math.acos(rb / centre)
        arc = 2.0 * r * (involute_function(pin) - 0.5 * gauge.at / (rb * cos_base) + math.pi / teeth - inv)
        gain = odd * math.cos(transverse) / math.sin(pin) / cos_helix  # dM / ds
    return gain * (arc * cos_helix - 0.5 * math.pi * m), (gain * 2.0 * m * tan, -gain, 0.0, gain * 2.0 / cos, value), std
