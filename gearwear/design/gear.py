"""One gear with everything derived from its specification in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from gearwear.arrays import Floats
from gearwear.design.involute import inverse_involute, involute_at_roll, involute_function
from gearwear.design.modification import DrawnFlank
from gearwear.design.rack import RackTip, cosine_sine, undercut_angle
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.tolerance import GearTolerance
from gearwear.errors import InputError


@dataclass(frozen=True, slots=True)
class Gear:
    """Exact transverse geometry of an external spur or helical gear (ISO 21771:2007; root by the rack).

    Build it with `Gear.from_spec`. Radii and lengths in mm, angles in rad. Roll lengths L are
    measured from the base circle. "Half angle" is the polar angle between a tooth's centre line and
    its flank. The section at mid-face has a tooth centre on +x; `gearwear.design.twist` carries it along the face.
    """

    spec: GearSpec
    transverse_module: float
    transverse_pressure_angle: float
    reference_radius: float
    base_radius: float
    tip_radius: float
    root_radius: float
    tooth_thickness: float
    """Transverse arc at the reference circle, mm."""
    base_half_angle: float
    """ψ_b: half angle of the involute where it leaves the base circle, rad."""
    rack: RackTip
    fillet_end: float
    """Rack-tip angle φ (in the normal section) where the root meets the flank, rad."""
    form_radius: float
    undercut: bool
    flank_end_radius: float
    """Where the involute ends at the top: the tip circle, or the start of the tip chamfer."""

    @classmethod
    def from_spec(cls, spec: GearSpec) -> Gear:
        """Derive the geometry.

        Parameters
        ----------
        spec : GearSpec
            What the user said.

        Returns
        -------
        Gear

        Raises
        ------
        InputError
            If no such gear can be cut: pointed tooth, form radius past the tip, rack tip radius too
            large, bore through the root. The message gives the value and the limit.
        """
        name, m, alpha = spec.name, spec.normal_module, spec.normal_pressure_angle
        cos_beta = math.cos(spec.helix_angle)
        transverse_module = m / cos_beta
        alpha_t = math.atan(math.tan(alpha) / cos_beta) if spec.helix_angle else alpha  # atan(tan α) loses the last digit
        r = 0.5 * transverse_module * spec.teeth
        rb = r * math.cos(alpha_t)
        ra = r + m * (spec.addendum + spec.profile_shift)
        rf = r - m * (spec.dedendum - spec.profile_shift)
        thickness = (0.5 * math.pi * m + 2.0 * spec.profile_shift * m * math.tan(alpha) - spec.thinning) / cos_beta
        psi_b = thickness / (2.0 * r) + involute_function(alpha_t)
        pitch_angle = 2.0 * math.pi / spec.teeth
        if rf <= 0.0 or ra <= rf:
            raise InputError(
                f"[{name}] tip diameter {2 * ra:.4f} mm and root diameter {2 * rf:.4f} mm: the tip must be outside the root, and the root above 0"
            )
        if ra <= rb:
            raise InputError(
                f"[{name}] tip diameter {2 * ra:.4f} mm lies inside the base circle {2 * rb:.4f} mm: no involute is left"
            )

        rho = spec.rack_tip_radius * m
        depth = (spec.dedendum - spec.profile_shift) * m - rho
        straight = spec.dedendum * m - rho
        offset = 0.25 * math.pi * m - straight * math.tan(alpha) - rho / math.cos(alpha) + 0.5 * spec.thinning
        if offset < 0.0:
            slope = (1.0 - math.sin(alpha)) / math.cos(alpha)
            most = (0.25 * math.pi * m + 0.5 * spec.thinning - spec.dedendum * m * math.tan(alpha)) / (slope * m)
            raise InputError(
                f"[{name}] rack_tip_radius = {spec.rack_tip_radius:g} modules: too large for dedendum {spec.dedendum:g} and {math.degrees(alpha):g}°, at most {math.floor(most * 1e4) / 1e4:g}"
            )
        rack = RackTip(r, rho, depth, offset / cos_beta, cos_beta)

        # Distance, along the normal, from the pitch-line tangent point to where the rack's straight flank ends.
        form_roll = r * math.sin(alpha_t) - (depth + rho * math.sin(alpha)) / math.sin(alpha_t)
        undercut = form_roll < 0.0
        if undercut:
            fillet_end = undercut_angle(rack, alpha, rb, psi_b, pitch_angle)
            form = float(rack.polar(np.array(fillet_end))[0])
        else:
            fillet_end = 0.5 * math.pi - alpha
            form = math.hypot(rb, form_roll)
        flank_end = ra - spec.tip_chamfer
        if form >= flank_end:
            raise InputError(
                f"[{name}] form diameter {2 * form:.4f} mm reaches the flank's end {2 * flank_end:.4f} mm: no involute is left; a smaller dedendum, more teeth or more profile shift would leave one"
            )
        gear = cls(
            spec=spec,
            transverse_module=transverse_module,
            transverse_pressure_angle=alpha_t,
            reference_radius=r,
            base_radius=rb,
            tip_radius=ra,
            root_radius=rf,
            tooth_thickness=thickness,
            base_half_angle=psi_b,
            rack=rack,
            fillet_end=fillet_end,
            form_radius=form,
            undercut=undercut,
            flank_end_radius=flank_end,
        )
        gear._check(pitch_angle)
        return gear

    def _check(self, pitch_angle: float) -> None:
        name, spec = self.spec.name, self.spec
        if not 0.0 < self.base_half_angle < math.pi:
            raise InputError(
                f"[{name}] tooth thickness {self.tooth_thickness:.4f} mm at the reference circle: no tooth is left; less thinning or more profile shift"
            )
        top_land = 2.0 * float(self.half_angle(self.tip_radius)) * self.tip_radius - 2.0 * spec.tip_chamfer
        if top_land <= 0.0:
            pointed = self.base_radius / math.cos(inverse_involute(self.base_half_angle))
            raise InputError(
                f"[{name}] the tooth is pointed: at tip diameter {2 * self.tip_radius:.4f} mm the top land is {top_land:.4f} mm (the flanks meet at diameter {2 * pointed:.4f}); a smaller addendum, profile_shift or tip_chamfer would leave a land"
            )
        if spec.tip_chamfer > 0.0 and self.tip_half_angle > float(self.half_angle(self.tip_radius)):
            lean = math.degrees(math.acos(self.base_radius / self.flank_end_radius))
            raise InputError(
                f"[{name}] tip_chamfer = {spec.tip_chamfer:g} mm: the flank leans {lean:.1f}° at the tip, more than the 45° of the chamfer, which would take nothing off; 0 would be right"
            )
        phi = np.linspace(0.0, self.fillet_end, 257)
        radius, angle = self.rack.polar(phi)
        if (np.diff(radius) <= 0.0).any():
            raise InputError(
                f"[{name}] rack_tip_radius = {spec.rack_tip_radius:g} modules with profile_shift {spec.profile_shift:g}: the generated root folds back on itself; a larger rack tip radius or less shift would not"
            )
        if angle.max() >= 0.5 * pitch_angle or self.rack.centre_offset >= 0.5 * pitch_angle * self.reference_radius:
            raise InputError(
                f"[{name}] the rack cuts the tooth off at its root (undercut past the centre line); more teeth or more profile_shift would leave one"
            )
        if not 0.5 * spec.bore_diameter < self.root_radius:
            raise InputError(
                f"[{name}] bore_diameter = {spec.bore_diameter:g} mm: must be below the root diameter {2 * self.root_radius:.4f} mm"
            )
        if not 2.0 * spec.end_chamfer < spec.face_width:
            raise InputError(
                f"[{name}] end_chamfer = {spec.end_chamfer:g} mm: must be below half the face width {spec.face_width:g} mm"
            )
        if self.modified:
            if spec.gap > 0.0:
                raise InputError(f"[{name}] gap = {spec.gap:g} mm: flanks of double helical gears cannot be modified yet")
            for side in Side:
                self.drawn(side).check(name if spec.left == spec.right else f"{name}.{side}")
            ends = np.array([0.0, 0.5, 1.0]) * spec.face_width
            land = (
                self.tip_radius * self.half_angles(np.array([self.tip_radius]), ends).sum(axis=0).min() - 2.0 * spec.tip_chamfer
            )
            if land <= 0.0:
                raise InputError(f"[{name}] the modifications leave no top land; smaller amounts at the tip would leave one")

    @property
    def tolerance(self) -> GearTolerance:
        """How far the gear may lie off its drawing: what is stated, the usual where nothing is."""
        spec = self.spec
        dimensions = (2.0 * self.tip_radius, 2.0 * self.root_radius, spec.bore_diameter, spec.face_width)
        return spec.tolerance.or_usual(*dimensions)

    @property
    def teeth(self) -> int:
        return self.spec.teeth

    @property
    def face_width(self) -> float:
        return self.spec.face_width

    @property
    def normal_module(self) -> float:
        """m_n, mm."""
        return self.spec.normal_module

    @property
    def normal_pressure_angle(self) -> float:
        """α_n, rad."""
        return self.spec.normal_pressure_angle

    @property
    def helix_angle(self) -> float:
        """β at the reference circle, rad, + right hand."""
        return self.spec.helix_angle

    @property
    def base_helix_angle(self) -> float:
        """β_b, rad: sin β_b = sin β cos α_n."""
        return math.asin(math.sin(self.spec.helix_angle) * math.cos(self.spec.normal_pressure_angle))

    @property
    def base_helix_cosine(self) -> float:
        """cos β_b: a distance along the normal in space, divided by it, lies along the transverse base tangent."""
        return math.cos(self.base_helix_angle)

    @property
    def arc_per_depth(self) -> float:
        """r / (r_b cos β_b): transverse arc at the reference circle for each mm along a flank's normal in space."""
        return self.reference_radius / (self.base_radius * self.base_helix_cosine)

    @property
    def twist(self) -> float:
        """κ = tan β / r, rad/mm: how far the section turns with the height, + right hand."""
        return math.tan(self.spec.helix_angle) / self.reference_radius

    @property
    def groove_radius(self) -> float:
        """Radius of the groove between the halves of a double helical gear, mm: half a normal module below the root circle, for the tool to
        run out, or half of what the bore leaves there."""
        wall = self.root_radius - 0.5 * self.spec.bore_diameter
        return self.root_radius - 0.5 * min(self.spec.normal_module, wall)

    @property
    def normal_tooth_thickness(self) -> float:
        """Normal arc s_n = s_t cos β at the reference circle, mm."""
        return self.tooth_thickness * math.cos(self.spec.helix_angle)

    @property
    def pitch_angle(self) -> float:
        """τ = 2π/z, rad."""
        return 2.0 * math.pi / self.spec.teeth

    @property
    def form_roll(self) -> float:
        """L at the form circle, mm; 0 where the root ends on the base circle."""
        excess = self.form_radius - self.base_radius  # there, rounding may leave it a hair below 0
        return math.sqrt(max(excess, 0.0) * (self.form_radius + self.base_radius))

    @property
    def tip_roll(self) -> float:
        """L where the involute ends at the top, mm."""
        return math.sqrt((self.flank_end_radius - self.base_radius) * (self.flank_end_radius + self.base_radius))

    @property
    def reference_roll(self) -> float:
        """L at the reference circle, mm."""
        return self.reference_radius * math.sin(self.transverse_pressure_angle)

    @property
    def base_pitch(self) -> float:
        """p_bt, mm."""
        return self.pitch_angle * self.base_radius

    @property
    def tip_half_angle(self) -> float:
        """Half angle of the top land, rad."""
        return float(self.half_angle(self.flank_end_radius)) - self.spec.tip_chamfer / self.tip_radius

    @property
    def root_half_angle(self) -> float:
        """Half angle, from the **space** centre line, of the bottom land, rad."""
        return self.rack.centre_offset / self.reference_radius

    @property
    def modified(self) -> bool:
        """Whether the drawing modifies the flanks: relief, crowning, slopes."""
        return bool(self.spec.left) or bool(self.spec.right)

    @property
    def modified_along_face(self) -> bool:
        """Whether a modification varies along the face, so that sections differ."""
        return any(
            m.helix_crowning != 0.0 or m.helix_slope != 0.0 or m.end_relief != 0.0 for m in (self.spec.left, self.spec.right)
        )

    def drawn(self, side: Side) -> DrawnFlank:
        """The modification of the flanks of one side, along the transverse base tangent."""
        modification = self.spec.left if side is Side.LEFT else self.spec.right
        return DrawnFlank(modification, side, self.form_roll, self.tip_roll, self.base_radius, self.face_width)

    def half_angles(self, radius: Floats, z: Floats) -> Floats:
        """Half angles of both sides as drawn, modifications and all.

        Parameters
        ----------
        radius : (n_r,) float
            mm, as for `half_angle`.
        z : (n_z,) float
            Heights of the sections, mm.

        Returns
        -------
        (2, n_z, n_r) float
            rad from the tooth's centre line at the section's own height; left first (`Side.index`).

        Notes
        -----
        ``ψ(r, z) = ψ(r) + δ₀(L(r), z) / r_b``; the fillet is turned with the end of its flank.
        """
        generated = self.half_angle(radius)
        if not self.modified:
            return np.broadcast_to(generated, (2, len(z), len(radius))).copy()
        roll = np.sqrt(np.maximum((radius - self.base_radius) * (radius + self.base_radius), 0.0))
        return np.stack([generated + self.drawn(side).offset(roll, z[:, None]) / self.base_radius for side in Side])

    def half_angle(self, radius: ArrayLike) -> Floats:
        """Half angle ψ(r) of the whole tooth side as generated: trochoid below the form circle, involute above.

        Parameters
        ----------
        radius : (n,) float
            mm, from the root circle to the tip circle (the involute is continued beyond its end).

        Returns
        -------
        (n,) float
            rad, from the tooth's centre line.
        """
        r = np.asarray(radius, dtype=np.float64)
        roll = np.sqrt(np.maximum((r - self.base_radius) * (r + self.base_radius), 0.0))
        psi = self.base_half_angle - involute_at_roll(roll, self.base_radius)
        below = r < self.form_radius
        if below.any():
            _, angle = self.rack.polar(self.fillet_phi(np.where(below, r, self.form_radius)))
            psi = np.where(below, 0.5 * self.pitch_angle - angle, psi)
        return np.asarray(psi, dtype=np.float64)

    def fillet_phi(self, radius: Floats) -> Floats:
        """Rack-tip angle φ at which the trochoid has the given radius (mm, root to form circle).

        Newton on r²(φ) from a table in sqrt(r − r_f), where φ is almost linear. What is left is the rounding of r:
        ε r / (dr/dφ), about 1e-14 rad on most of the root and 1e-11 rad near its bottom, where r hardly changes with φ.
        """
        table = np.linspace(0.0, self.fillet_end, 129)
        known = self.rack.polar(table)[0]
        r = np.clip(np.asarray(radius, dtype=np.float64), known[0], known[-1])
        phi = np.interp(np.sqrt(r - known[0]), np.sqrt(np.maximum(known - known[0], 0.0)), table)
        depth, tip = self.rack.centre_depth, self.rack.tip_radius
        wide_depth, wide_tip = self.rack.helix_cosine * depth, self.rack.helix_cosine * tip
        for _ in range(6):
            cos, sin = cosine_sine(phi)
            radial, tangential = (
                self.reference_radius - depth - tip * cos,
                wide_depth * (sin / cos) + wide_tip * sin,
            )  # `RackTip.contact`
            slope = radial * tip * sin + tangential * (wide_depth / (cos * cos) + wide_tip * cos)
            miss = 0.5 * (radial * radial + tangential * tangential - r * r)
            new = np.clip(phi - miss / np.maximum(slope, 1e-12), 0.0, self.fillet_end)
            moved = float(np.abs(new - phi).max(initial=0.0))
            phi = new
            if moved < 1e-10:  # quadratic: the next step would be rounding
                break
        return np.asarray(phi, dtype=np.float64)

    def thickness(self, radius: ArrayLike) -> Floats:
        """Transverse tooth thickness 2 r ψ(r), mm of arc at `radius` (mm).

        >>> from gearwear.design.spec import GearSpec
        >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
        >>> float(np.round(pinion.thickness(38.1), 6))
        9.974557
        """
        r = np.asarray(radius, dtype=np.float64)
        return 2.0 * r * self.half_angle(r)

    def section_area(self, z: float | None = None) -> float:
        """Exact area (mm²) of the transverse section at height `z` (mm; None: mid-face), bore taken out, end chamfers left out.

        Closed form on the involute; the trochoid by `RackTip.sector_area`; a tip chamfer by its triangle; modifications by Gauss's
        rule between their knees, where it is exact: a parabola times L.
        """
        rb, psi = self.base_radius, self.base_half_angle

        def under_involute(roll: float) -> float:  # ∫ ψ(r) r dr with r dr = L dL
            return psi * roll**2 / 2 - roll**3 / (3 * rb) + 0.5 * ((roll**2 + rb**2) * math.atan(roll / rb) - rb * roll)

        land = 0.5 * self.root_radius**2 * self.root_half_angle
        trochoid = self.rack.sector_area(self.fillet_end)
        form_angle = float(self.half_angle(self.form_radius))
        top_angle = float(self.half_angle(self.flank_end_radius))
        # Sector from the axis swept by the flank, between the half angles of its two ends: ½ ∫ r² dψ by parts.
        involute = under_involute(self.tip_roll) - under_involute(self.form_roll)
        involute += 0.5 * (self.form_radius**2 * form_angle - self.flank_end_radius**2 * top_angle)
        tip = 0.5 * self.tip_radius**2 * self.tip_half_angle
        chamfer = 0.5 * self.flank_end_radius * self.tip_radius * math.sin(top_angle - self.tip_half_angle)
        half_tooth = land + trochoid + involute + tip + chamfer
        whole = 2.0 * self.teeth * half_tooth - math.pi * (0.5 * self.spec.bore_diameter) ** 2
        return whole + (self.teeth * self._drawn_area(0.5 * self.face_width if z is None else z) if self.modified else 0.0)

    @property
    def volume(self) -> float:
        """Exact volume, mm³, end chamfers left out: a screw keeps the area of a section, and δ₀ is a parabola at most between its knees."""
        gap = self.spec.gap
        if not self.modified:
            groove = math.pi * gap * (self.groove_radius**2 - 0.25 * self.spec.bore_diameter**2) if gap > 0.0 else 0.0
            return self.section_area() * (self.face_width - gap) + groove
        knees = sorted({knee for side in Side for knee in self.drawn(side).face_knees})
        nodes, weights = np.polynomial.legendre.leggauss(2)
        return sum(
            0.5 * (high - low) * float(weight) * self.section_area(0.5 * (low + high) + 0.5 * (high - low) * float(node))
            for low, high in pairwise([0.0, *knees, self.face_width])
            for node, weight in zip(nodes, weights, strict=True)
        )

    def _drawn_area(self, z: float) -> float:
        """What the modifications add to a tooth's section at height `z`, mm²: ∫ δ₀ / r_b · r dr on both sides, with r dr = L dL."""
        nodes, weights = np.polynomial.legendre.leggauss(3)
        area = 0.0
        for side in Side:
            flank = self.drawn(side)
            ends = np.array([self.form_roll, *flank.profile_knees, self.tip_roll])
            half = 0.5 * np.diff(ends)[:, None]
            roll = ends[:-1, None] + half * (1.0 + nodes)
            area += float((half * weights * flank.offset(roll, z) * roll).sum())
            below = 0.5 * (self.form_radius**2 - self.root_radius**2)
            top = 0.5 * (self.tip_radius**2 - self.flank_end_radius**2)
            area += float(flank.offset(self.form_roll, z)) * below + float(flank.offset(self.tip_roll, z)) * top
        return area / self.base_radius
