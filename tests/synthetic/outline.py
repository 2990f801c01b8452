"""The exact transverse outline of a generated spur gear, by a route of its own.

The involute by its parametric form (reference B1), the root by the classical formulas of the rack's
rounded tip in the parameter X, the offset of the tip-arc centre from the pitch point (reference B2),
the undercut junction by bisection. Nothing here comes from `gearwear`.

Tooth frame: the tooth's centre line is +x, the left flank (side +1) at positive angles. Lengths in mm,
angles in rad. The arc coordinate runs along the outline of one pitch, 0 in the middle of the tip land,
positive on the left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

TABLE = 20_001
"""Nodes along the fillet: its arc length is then right to 1e-9 of itself."""


class Surface(IntEnum):
    """What a point lies on."""

    FLANK = 0
    FILLET = 1
    ROOT = 2
    TIP = 3
    END_LOW = 4
    END_HIGH = 5
    BORE = 6


@dataclass(frozen=True, slots=True)
class GearNumbers:
    """The gear in words of a drawing: lengths in mm, the rest in modules; `thinning` is an arc at the reference circle."""

    teeth: int = 12
    module: float = 6.35
    face_width: float = 15.0
    pressure_angle_deg: float = 20.0
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    rack_tip_radius: float = 0.30
    thinning: float = 0.0
    bore_diameter: float = 0.0


PINION = GearNumbers()
"""The paper's pinion."""
WHEEL = GearNumbers(teeth=24)
"""Its mate."""


@dataclass(frozen=True, slots=True)
class Section:
    """Points of the outline in the tooth frame."""

    position: Floats  # (n, 2)
    normal: Floats  # (n, 2) outward
    surface: Ints  # (n,)
    side: Ints  # (n,) +1 left, -1 right of the tooth, on every surface
    roll: Floats  # (n,) L on flanks, nan elsewhere


@dataclass(frozen=True, slots=True)
class Outline:
    """Everything fixed about the outline; build it with `Outline.of`."""

    numbers: GearNumbers
    reference_radius: float
    base_radius: float
    tip_radius: float
    root_radius: float
    base_half_angle: float
    tip_half_angle: float
    root_half_angle: float
    """From the space's centre line."""
    form_radius: float
    form_roll: float
    tip_roll: float
    undercut: bool
    rack_depth: float
    """h_c: how far the tip-arc centre lies below the pitch line."""
    rack_offset: float
    """x_c: the tip-arc centre from the rack tooth's centre line."""
    rack_radius: float
    fillet_offset: Floats
    """X at the table's nodes, from the bottom land up to the form circle."""
    fillet_radius: Floats
    fillet_arc: Floats
    """Arc length from the bottom land to the nodes."""

    @classmethod
    def of(cls, numbers: GearNumbers) -> Outline:
        """Solve the outline.

        Raises
        ------
        ValueError
            If the rack's tip-arc centre is not below the pitch line, or no tooth is left: not covered here.
        """
        m, alpha = numbers.module, math.radians(numbers.pressure_angle_deg)
        r = 0.5 * m * numbers.teeth
        rb = r * math.cos(alpha)
        ra = r + m * (numbers.addendum + numbers.profile_shift)
        rf = r - m * (numbers.dedendum - numbers.profile_shift)
        rho = numbers.rack_tip_radius * m
        straight = numbers.dedendum * m - rho
        depth = straight - numbers.profile_shift * m
        offset = 0.25 * math.pi * m - straight * math.tan(alpha) - rho / math.cos(alpha) + 0.5 * numbers.thinning
        if depth <= 0.0 or offset < 0.0:
            raise ValueError("this generator needs the tip-arc centre of the rack below the pitch line and inside its tooth")
        thickness = 0.5 * math.pi * m + 2.0 * numbers.profile_shift * m * math.tan(alpha) - numbers.thinning
        psi_b = thickness / (2.0 * r) + math.tan(alpha) - alpha
        tip_roll = math.sqrt(ra * ra - rb * rb)
        tip_half = psi_b - float(_involute(np.array(tip_roll), rb))
        if tip_half <= 0.0:
            raise ValueError("the tooth is pointed")

        tangency = depth / math.tan(alpha)
        form_roll = r * math.sin(alpha) - (depth + rho * math.sin(alpha)) / math.sin(alpha)
        undercut = form_roll < 0.0
        top = tangency
        if undercut:
            top = _junction(r, rb, depth, offset, rho, psi_b, math.pi / numbers.teeth, tangency)
            form = float(_trochoid(np.array(top), r, depth, offset, rho)[0])
            form_roll = math.sqrt(form * form - rb * rb)
        else:
            form = math.hypot(rb, form_roll)

        nodes = np.linspace(0.0, top, TABLE)
        radius, angle = _trochoid(nodes, r, depth, offset, rho)
        step = np.hypot(np.diff(radius * np.cos(angle)), np.diff(radius * np.sin(angle)))
        arc = np.concatenate([[0.0], np.cumsum(step)])
        return cls(
            numbers, r, rb, ra, rf, psi_b, tip_half, offset / r, form, form_roll, tip_roll, undercut,
            depth, offset, rho, nodes, radius, arc,
        )  # fmt: skip

    @property
    def teeth(self) -> int:
        return self.numbers.teeth

    @property
    def face_width(self) -> float:
        return self.numbers.face_width

    @property
    def pitch_angle(self) -> float:
        return 2.0 * math.pi / self.numbers.teeth

    @property
    def reference_roll(self) -> float:
        """L at the reference circle, where sliding is nil in a pair at its standard centre distance."""
        return math.sqrt(self.reference_radius**2 - self.base_radius**2)

    @property
    def arcs(self) -> tuple[float, float, float, float]:
        """Lengths of half a tip land, a flank, a fillet and half a bottom land."""
        return (
            self.tip_radius * self.tip_half_angle,
            (self.tip_roll**2 - self.form_roll**2) / (2.0 * self.base_radius),
            float(self.fillet_arc[-1]),
            self.root_radius * self.root_half_angle,
        )

    @property
    def length(self) -> float:
        """Length of the outline over one pitch."""
        return 2.0 * sum(self.arcs)

    def equal_arcs(self, count: int = 505) -> Floats:
        """Arc coordinates of `count` points at equal spacing over one pitch."""
        return (np.arange(count) + 0.5) / count * self.length - 0.5 * self.length

    def at(self, arc: Floats) -> Section:
        """Points of the outline at arc coordinates within ± half its length.

        Parameters
        ----------
        arc : (n,) float
        """
        side = np.where(arc < 0.0, -1, 1)
        half_tip, flank, fillet, _ = self.arcs
        along = np.abs(arc) - half_tip
        position, normal = np.empty((len(arc), 2)), np.empty((len(arc), 2))
        surface = np.full(len(arc), Surface.ROOT, np.int8)
        roll = np.full(len(arc), np.nan)

        on = along < 0.0
        surface[on] = Surface.TIP
        angle = np.abs(arc[on]) / self.tip_radius
        normal[on] = np.column_stack([np.cos(angle), np.sin(angle)])
        position[on] = self.tip_radius * normal[on]

        on = (along >= 0.0) & (along < flank)
        surface[on] = Surface.FLANK
        roll[on] = np.sqrt(self.tip_roll**2 - 2.0 * self.base_radius * along[on])
        position[on], normal[on] = self.flank(roll[on])

        on = (along >= flank) & (along < flank + fillet)
        surface[on] = Surface.FILLET
        x = np.interp(fillet - (along[on] - flank), self.fillet_arc, self.fillet_offset)
        position[on], normal[on] = self.fillet(x)

        on = surface == Surface.ROOT
        angle = 0.5 * self.pitch_angle - (0.5 * self.length - np.abs(arc[on])) / self.root_radius
        normal[on] = np.column_stack([np.cos(angle), np.sin(angle)])
        position[on] = self.root_radius * normal[on]

        position[:, 1] *= side
        normal[:, 1] *= side
        return Section(position, normal, surface, side, roll)

    def flank(self, roll: Floats) -> tuple[Floats, Floats]:
        """Position and normal, (n, 2) each, of the left flank, or its continuation, in the tooth frame."""
        tau = self.base_half_angle - roll / self.base_radius
        cos, sin = np.cos(tau), np.sin(tau)
        normal = np.column_stack([-sin, cos])
        return self.base_radius * np.column_stack([cos, sin]) + roll[:, None] * normal, normal

    def fillet(self, x: Floats) -> tuple[Floats, Floats]:
        """Position and normal, (n, 2) each, of the left fillet at tip-arc offsets X; the normal meets the pitch point."""
        radius, angle = _trochoid(x, self.reference_radius, self.rack_depth, self.rack_offset, self.rack_radius)
        at = 0.5 * self.pitch_angle - angle
        position = radius[:, None] * np.column_stack([np.cos(at), np.sin(at)])
        # pitch point at angle -(X - x_c)/r from the space's centre line; in its frame the normal is (h_c, -X)
        turn = 0.5 * self.pitch_angle + (x - self.rack_offset) / self.reference_radius + np.arctan2(x, self.rack_depth)
        return position, np.column_stack([np.cos(turn), np.sin(turn)])

    def fillet_half_angle(self, radius: Floats) -> Floats:
        """Half angle of the fillet, from the tooth's centre line, at radii from root to form circle."""
        x = np.interp(radius, self.fillet_radius, self.fillet_offset)
        angle = _trochoid(x, self.reference_radius, self.rack_depth, self.rack_offset, self.rack_radius)[1]
        return 0.5 * self.pitch_angle - angle

    def half_angle(self, radius: Floats) -> Floats:
        """Half angle of the tooth at any radius up to the tip; half the pitch inside the root circle."""
        roll = np.sqrt(np.maximum(radius**2 - self.base_radius**2, 0.0))
        psi = self.base_half_angle - _involute(roll, self.base_radius)
        psi = np.where(radius < self.form_radius, self.fillet_half_angle(radius), psi)
        return np.where(radius < self.root_radius, 0.5 * self.pitch_angle, psi)

    def undercut_depth(self, roll: Floats) -> Floats:
        """How deep, along the involute's normal, the fillet lies under the involute at a point's own roll length (≥ 0)."""
        radius = np.hypot(self.base_radius, roll)
        involute = self.base_half_angle - _involute(roll, self.base_radius)
        below = (roll < self.form_roll) & self.undercut
        return np.where(below, self.base_radius * (involute - self.fillet_half_angle(radius)), 0.0)


def involute_angle(roll: Floats, base_radius: float) -> Floats:
    """inv α = tan α − α with tan α = L / r_b."""
    return _involute(roll, base_radius)


def _involute(roll: Floats, base_radius: float) -> Floats:
    tangent = roll / base_radius
    return np.asarray(tangent - np.arctan(tangent))


def _trochoid(x: Floats, r: float, depth: float, offset: float, rho: float) -> tuple[Floats, Floats]:
    """Radius, and angle from the space's centre line, of the root cut by the rack's tip arc (reference B2)."""
    stretch = 1.0 + rho / np.hypot(x, depth)
    inward, along = r - depth * stretch, x * stretch
    return np.hypot(inward, along), np.arctan2(along, inward) - (x - offset) / r


def _junction(r: float, rb: float, depth: float, offset: float, rho: float, psi_b: float, half_pitch: float, top: float) -> float:
    """X where the trochoid first crosses the involute, counted from the bottom: 60 bisections."""

    def gap(x: Floats) -> Floats:
        radius, angle = _trochoid(x, r, depth, offset, rho)
        roll = np.sqrt(np.maximum(radius**2 - rb**2, 0.0))
        return np.where(radius > rb, (psi_b - _involute(roll, rb)) - (half_pitch - angle), 1.0)

    x = np.linspace(0.0, top, 4001)
    crossed = np.flatnonzero(gap(x) < 0.0)
    if len(crossed) == 0:
        raise ValueError("the root does not meet the involute")
    low, high = float(x[crossed[0] - 1]), float(x[crossed[0]])
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(gap(np.array(middle))) > 0.0 else (low, middle)
    return high
