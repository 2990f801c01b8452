"""The generating rack: the root it leaves, and where that root cuts the involute.

A rack with **protuberance** reaches s_pr = p_r − q further into the flank than the finished flank lies (q is the stock that grinding takes
off). Its tip arc is the same arc, moved: only where the root ends is found another way, as in undercut.

Coordinates are polar about the gear axis, the angle β measured from the **space** centre line
towards the tooth. The rack's tip is an arc of radius ρ about a centre that lies h_c inside the
reference circle and x_c from the rack tooth's centre line. Its natural parameter is the angle φ
between the common normal and the radius through the pitch point: 0 at the bottom of the root,
π/2 − α where the arc runs into the straight flank.

A hob is round in its **normal** section. In the transverse section of a helical gear its tip is then half an ellipse with the semi-axes
ρ (depth) and ρ / cos β; φ stays the angle in the normal section, and in the transverse one the normal stands at φ_t, tan φ_t = cos β tan φ.

Sources: Litvin & Fuentes 2004; Colbourne 1987, ch. 5. In the parameter X of the usual form,
``X = h_c tan φ``; φ stays regular when h_c → 0 or < 0 (large profile shift), X does not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.involute import involute_at_roll, roll_length
from gearwear.design.root import RootPart, ToothSection
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError

STEEPEST_TANGENT = 60.0
"""tan φ up to which a protuberant tip is followed: its arc then stands within 1° of upright, and its trochoid is far beyond any tip circle."""


@dataclass(frozen=True, slots=True)
class RackTip:
    """Tip arc of the generating rack, in mm, rolling on the reference circle.

    Parameters
    ----------
    reference_radius : float
        Radius r on which the rack rolls.
    tip_radius : float
        ρ, radius of the rack's tip arc; 0 is a sharp corner.
    centre_depth : float
        h_c, how far inside the reference circle the arc's centre lies (dedendum − ρ).
    centre_offset : float
        x_c, distance of the arc's centre from the rack tooth's centre line in the transverse section; not negative.
    helix_cosine : float
        cos β; 1 for a spur gear.
    """

    reference_radius: float
    tip_radius: float
    centre_depth: float
    centre_offset: float
    helix_cosine: float = 1.0

    @property
    def land_half_angle(self) -> float:
        """Half the bottom land, seen from the gear's axis, rad."""
        return self.centre_offset / self.reference_radius

    def contact(self, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """Radial and tangential coordinate (mm) of the generated point in the rack's frame, and the roll turn (rad)."""
        cos, sin = np.cos(phi), np.sin(phi)
        shift = self.helix_cosine * self.centre_depth * (sin / cos)
        radial = self.reference_radius - self.centre_depth - self.tip_radius * cos
        tangential = shift + self.helix_cosine * self.tip_radius * sin
        return radial, tangential, (shift - self.stretch * sin - self.centre_offset) / self.reference_radius

    @property
    def stretch(self) -> float:
        """ρ (1/cos β − cos β), mm: what the ellipse adds to the roll; 0 for a spur gear."""
        return self.tip_radius * (1.0 / self.helix_cosine - self.helix_cosine)

    def lever(self, phi: Floats) -> Floats:
        """r sin φ_t, mm: the moment of the transverse normal, at the angle φ_t to the line of centres, about the axis; it passes through the
        pitch point."""
        across = self.helix_cosine * np.tan(phi)
        return np.asarray(self.reference_radius * across / np.sqrt(1.0 + across * across), dtype=np.float64)

    def polar(self, phi: Floats) -> tuple[Floats, Floats]:
        """Radius (mm) and angle from the space centre (rad) of the trochoid at `phi`.

        >>> rack = RackTip(38.1, 1.5875, 6.35, 0.98669)
        >>> radius, _ = rack.polar(np.array([0.0]))
        >>> float(np.round(radius[0], 4))    # the root circle
        30.1625
        """
        radial, tangential, turn = self.contact(phi)
        return np.hypot(radial, tangential), np.arctan2(tangential, radial) - turn

    def at_radius(self, radius: Floats, limit: float) -> Floats:
        """φ in 0 … `limit` at which the trochoid has the given radius (mm).

        Newton on r²(φ) from a table in sqrt(r − r_f), where φ is almost linear. What is left is the rounding of r:
        ε r / (dr/dφ), about 1e-14 rad on most of the root and 1e-11 rad near its bottom, where r hardly changes with φ.
        """
        table, known, root = _table(self, limit)
        r = np.minimum(np.maximum(np.asarray(radius, dtype=np.float64), known[0]), known[-1])
        phi = np.interp(np.sqrt(r - known[0]), root, table)
        depth, tip = self.centre_depth, self.tip_radius
        wide_depth, wide_tip = self.helix_cosine * depth, self.helix_cosine * tip
        for _ in range(6):
            cos, sin = cosine_sine(phi)
            radial, tangential = (
                self.reference_radius - depth - tip * cos,
                wide_depth * (sin / cos) + wide_tip * sin,
            )  # `contact`
            slope = radial * tip * sin + tangential * (wide_depth / (cos * cos) + wide_tip * cos)
            miss = 0.5 * (radial * radial + tangential * tangential - r * r)
            new = np.minimum(np.maximum(phi - miss / np.maximum(slope, 1e-12), 0.0), limit)
            moved = float(np.abs(new - phi).max(initial=0.0))
            phi = new
            if moved < 1e-10:  # quadratic: the next step would be rounding
                break
        return np.asarray(phi, dtype=np.float64)

    def normal_angle(self, radius: Floats, angle: Floats, start: Floats, limit: float) -> Floats:
        """φ of the trochoid's normal that passes through given points.

        Parameters
        ----------
        radius, angle : (n,) float
            Polar coordinates of the points, angle from the space centre, mm and rad.
        start : (n,) float
            First guess of φ.
        limit : float
            Greatest φ of the generated root; the result is kept within 0 … limit.

        Returns
        -------
        (n,) float
            φ; for points within half a tip radius of the trochoid the Newton iteration ends
            below 1e-12 rad (tested), because the normals of a generated curve are known exactly:
            they pass through the pitch point.
        """
        # In tan φ, which alone the roll turn of a spur gear depends on.
        most, c = math.tan(limit), self.helix_cosine
        tangent = np.clip(np.tan(start), 0.0, most)
        for _ in range(8):
            turn, rate = self._turn(tangent)
            cos, sin = cosine_sine(angle + turn)
            radial, tangential = radius * cos, radius * sin
            inward = self.reference_radius - radial
            across = tangent if c == 1.0 else c * tangent
            slope = rate * (radial - tangential * across) - c * inward
            step = (tangential - inward * across) / np.where(np.abs(slope) > 1e-9, slope, -1e-9)
            new = np.clip(tangent - np.clip(step, -0.5, 0.5), 0.0, most)
            moved = float(np.abs(new - tangent).max(initial=0.0))
            tangent = new
            if moved < 1e-7:  # quadratic: the next step would be below 1e-13
                break
        phi: Floats = np.arctan(tangent)
        return phi

    def deviation(self, radius: Floats, angle: Floats, phi: Floats) -> Floats:
        """Normal distance (mm) of points from the trochoid along the normal at `phi`, + towards the space."""
        return self.plumb_line(radius, angle, phi)[0]

    def plumb_line(self, radius: Floats, angle: Floats, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """Normal distance (mm) as `deviation`, and the normal's components along the point's own radius and across it.

        The second component is + away from the space's centre line on the side where `angle` is positive. All in the transverse section.
        """
        cos, sin = cosine_sine(phi)
        cos_turn, sin_turn = cosine_sine(angle + self._turn(sin / cos)[0])
        inward = self.reference_radius - radius * cos_turn
        tip: float | Floats = self.tip_radius
        if self.helix_cosine != 1.0:  # on to the transverse normal
            across = self.helix_cosine * sin / cos
            normal_cos, cos = cos, 1.0 / np.sqrt(1.0 + across * across)
            sin, tip = across * cos, self.tip_radius * normal_cos / cos
        distance: Floats = self.centre_depth / cos + tip - (inward * cos + radius * sin_turn * sin)
        return distance, cos * cos_turn - sin * sin_turn, sin * cos_turn + cos * sin_turn

    def _turn(self, tangent: Floats) -> tuple[Floats, float | Floats]:
        """Roll turn (rad) at the tangent of φ, and its derivative by that tangent."""
        rate = self.helix_cosine * self.centre_depth / self.reference_radius
        turn: Floats = (self.helix_cosine * self.centre_depth * tangent - self.centre_offset) / self.reference_radius
        if self.stretch == 0.0:
            return turn, rate
        cos = 1.0 / np.sqrt(1.0 + tangent * tangent)
        stretch = self.stretch / self.reference_radius
        return turn - stretch * tangent * cos, rate - stretch * cos**3

    def sector_area(self, limit: float) -> float:
        """Area (mm²) swept from the axis by the trochoid from φ = 0 to `limit`: ½ ∫ r² dβ.

        Gauss-Legendre with 64 nodes; the integrand is analytic, the error below 1e-12 relative (tested
        against 128 nodes).
        """
        nodes, weights = np.polynomial.legendre.leggauss(64)
        phi = 0.5 * limit * (nodes + 1.0)
        radial, tangential, _ = self.contact(phi)
        cos, sin = np.cos(phi), np.sin(phi)
        rate = self.helix_cosine * self.centre_depth / (cos * cos)
        d_radial = self.tip_radius * sin
        d_tangential = rate + self.helix_cosine * self.tip_radius * cos
        turning = rate - self.stretch * cos
        swept = radial * d_tangential - tangential * d_radial - (radial**2 + tangential**2) * turning / self.reference_radius
        return float(0.25 * limit * np.dot(weights, swept))

    def words(self, spec: GearSpec) -> str:
        """What makes it, with its sizes."""
        beyond = f" and a protuberance of {spec.protuberance:g} mm" if spec.protuberance > 0.0 else ""
        return f"a rack with a tip radius of {spec.rack_tip_radius:g} modules{beyond}"


@lru_cache(maxsize=64)  # asked thousands of times in a contact
def _table(rack: RackTip, limit: float) -> tuple[Floats, Floats, Floats]:
    """φ in even steps, r there and sqrt(r − r_f), mm, read-only: where `RackTip.at_radius` begins."""
    phi = np.linspace(0.0, limit, 129)
    radius = rack.polar(phi)[0]
    root = np.sqrt(np.maximum(radius - radius[0], 0.0))
    for column in (phi, radius, root):
        column.setflags(write=False)
    return phi, radius, root


def cosine_sine(angle: Floats) -> tuple[Floats, Floats]:
    """Cosine and sine of angles within ±π by the tangent of the half, which numpy computes several times as fast as one of them."""
    tangent = np.tan(0.5 * angle)
    square = tangent * tangent
    scale = 1.0 / (1.0 + square)
    return (1.0 - square) * scale, 2.0 * tangent * scale


def bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of `function` in [low, high] by bisection to the last bit; the ends must differ in sign."""
    below = function(low) < 0.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if (function(middle) < 0.0) == below:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def undercut_angle(rack: RackTip, pressure_angle: float, base_radius: float, base_half_angle: float, pitch_angle: float) -> float:
    """φ at which the trochoid cuts the involute of an undercut tooth.

    Parameters
    ----------
    rack : RackTip
        The generating rack's tip.
    pressure_angle : float
        Normal pressure angle α_n in rad, where the arc ends.
    base_radius, base_half_angle : float
        r_b in mm and the tooth's half angle ψ_b at the base circle in rad.
    pitch_angle : float
        2π/z in rad.

    Returns
    -------
    float
        φ_u in rad, to machine precision.

    Notes
    -----
    Sought is the zero of (tooth half angle of the trochoid) − (that of the involute). It is negative
    where the trochoid leaves the base circle and 2 inv α > 0 at the arc's end, which lies on the involute's
    other branch; so the bracket is certain.
    """
    end = math.pi / 2 - pressure_angle

    def radius_excess(phi: float) -> float:
        return float(rack.polar(np.array(phi))[0]) - base_radius

    def gap(phi: float) -> float:
        radius, angle = (float(v) for v in rack.polar(np.array(phi)))
        xi = math.sqrt(max(radius * radius - base_radius * base_radius, 0.0)) / base_radius
        return (0.5 * pitch_angle - angle) - (base_half_angle - (xi - math.atan(xi)))

    start = bisect(radius_excess, 0.0, end)
    return bisect(gap, start, end)


def protuberance_angle(rack: RackTip, flank: ToothSection, pressure_angle: float, pitch_angle: float) -> float:
    """φ at which the trochoid of a protuberant tip comes out of the finished flank: the form circle.

    Parameters
    ----------
    rack : RackTip
        The tip, its centre moved by the protuberance.
    flank : ToothSection
        The finished flank: r_b and ψ_b count.
    pressure_angle : float
        α_n in rad.
    pitch_angle : float
        2π/z in rad.

    Returns
    -------
    float
        φ in rad, to machine precision; nan where the trochoid never lies inside the flank.

    Notes
    -----
    (tooth half angle of the trochoid) − (that of the involute) is −s_pr / (r_b cos β_b) at φ = π/2 − α, where the tip's tangent is parallel to
    the flank, if that point lies beyond the base circle, and rises without limit with the roll; sought is its last zero. The tip is
    taken to be round up to there: a tool is, whose protuberance leans by less than π/2 − φ.
    """
    base, centre = flank.base_radius, 0.5 * pitch_angle

    def gap(phi: Floats) -> Floats:
        radius, angle = rack.polar(phi)
        involute = involute_at_roll(roll_length(radius, base), base)
        return np.asarray((centre - angle) - (flank.base_half_angle - involute), dtype=np.float64)

    tangent = np.linspace(0.0, STEEPEST_TANGENT, 4000)
    phi = np.union1d(np.arctan(tangent), [0.5 * math.pi - pressure_angle])
    phi = phi[rack.polar(phi)[0] >= base]
    inside = np.flatnonzero(gap(phi) < 0.0)
    if not len(inside) or inside[-1] + 1 == len(phi):
        return math.nan
    last = inside[-1]
    return bisect(lambda at: float(gap(np.array(at))), float(phi[last]), float(phi[last + 1]))


def rack_root(spec: GearSpec, section: ToothSection) -> RootPart:
    """Root of an external gear.

    Parameters
    ----------
    spec : GearSpec
    section : Section
        What is derived before the root.

    Returns
    -------
    RootPart

    Raises
    ------
    InputError
        If the rack's tip radius is too large for its tooth, or its protuberance leaves no flank or no notch.
    """
    m, alpha, alpha_t = spec.normal_module, spec.normal_pressure_angle, section.pressure_angle
    r, cos_beta = section.reference_radius, math.cos(spec.helix_angle)
    rho = spec.rack_tip_radius * m
    depth = (spec.dedendum - spec.profile_shift) * m - rho
    straight = spec.dedendum * m - rho
    notch = spec.protuberance - spec.grinding_stock
    wider = notch / math.cos(alpha)  # ISO 6336-3:2019, auxiliary value E: s_pr / cos α
    offset = 0.25 * math.pi * m - straight * math.tan(alpha) - rho / math.cos(alpha) + 0.5 * spec.thinning + wider
    if offset < 0.0:
        slope = (1.0 - math.sin(alpha)) / math.cos(alpha)
        most = (0.25 * math.pi * m + 0.5 * spec.thinning + wider - spec.dedendum * m * math.tan(alpha)) / (slope * m)
        raise InputError(
            f"[{spec.name}] rack_tip_radius = {spec.rack_tip_radius:g} modules: too large for dedendum {spec.dedendum:g} and {math.degrees(alpha):g}°, at most {math.floor(most * 1e4) / 1e4:g}"
        )
    rack = RackTip(r, rho, depth, offset / cos_beta, cos_beta)

    if notch > 0.0:
        return _protuberant(spec, section, rack)
    # Distance, along the normal, from the pitch-line tangent point to where the rack's straight flank ends.
    form_roll = r * math.sin(alpha_t) - (depth + rho * math.sin(alpha)) / math.sin(alpha_t)
    if form_roll < 0.0:
        end = undercut_angle(rack, alpha, section.base_radius, section.base_half_angle, 2.0 * math.pi / spec.teeth)
        return RootPart(rack, end, float(rack.polar(np.array(end))[0]), undercut=True)
    return RootPart(rack, 0.5 * math.pi - alpha, math.hypot(section.base_radius, form_roll))


def _protuberant(spec: GearSpec, section: ToothSection, rack: RackTip) -> RootPart:
    """The root that a protuberance leaves, up to the form circle, where the ground flank meets it."""
    said = f"[{spec.name}] protuberance = {spec.protuberance:g} mm:"
    if rack.centre_depth <= 0.0:
        raise InputError(
            f"{said} the centre of the rack's tip arc lies outside the pitch line; less profile_shift or a smaller rack_tip_radius would be right"
        )
    end = protuberance_angle(rack, section, spec.normal_pressure_angle, 2.0 * math.pi / spec.teeth)
    if math.isnan(end):
        raise InputError(f"{said} its trochoid never crosses the flank; a smaller protuberance would")
    if spec.protuberance_angle is not None and end > 0.5 * math.pi - spec.protuberance_angle:
        steepest = math.degrees(0.5 * math.pi - end)
        raise InputError(
            f"[{spec.name}] protuberance_angle = {math.degrees(spec.protuberance_angle):g} degrees: the round tip must reach the flank, which "
            f"it does below {math.floor(steepest * 1e3) / 1e3:g} degrees; the straight part of a protuberance is not computed yet"
        )
    return RootPart(rack, end, float(rack.polar(np.array(end))[0]), undercut=True)
