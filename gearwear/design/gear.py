"""One gear with everything derived from its specification in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow
from gearwear.design.involute import inverse_involute, involute_at_roll, involute_function, roll_length
from gearwear.design.modification import DrawnFlank
from gearwear.design.quantity import apart, as_given, at_least, at_most, not_zero
from gearwear.design.rack import RackTip, rack_root
from gearwear.design.ring import SHIFT_BY_ISO, ring_root
from gearwear.design.root import RootCurve, ToothSection
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.tip_edge import TipArc
from gearwear.design.tolerance import GearTolerance
from gearwear.errors import InputError

OFF_END = 0.1
"""Modules off the end of the involute where thickness is measured, if the reference circle lies beyond it."""
UNKNOWN_RIM = 3.0
"""Modules beyond its roots up to which the body of a ring goes where no rim is stated."""


@dataclass(frozen=True, slots=True, repr=False)
class Gear(Card):
    """Exact transverse geometry of a spur or helical gear, external or a ring (ISO 21771:2007; root by rack, cutter or drawing).

    Build it with `Gear.from_spec`. Radii and lengths in mm, angles in rad. Roll lengths L are
    measured from the base circle. "Half angle" is the polar angle between a tooth's centre line and
    its flank. Of a ring the radii run from the root circle **inwards** to the tip circle; `orientation` ι is −1 for it, and each formula that
    knows the difference has that factor. The section at mid-face has a tooth centre on +x; `gearwear.design.twist` carries it along the face.
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
    root_curve: RootCurve
    fillet_end: float
    """The root curve's φ where it meets the flank, rad."""
    form_radius: float
    undercut: bool
    flank_end_radius: float
    """Where the involute ends at the top: the tip circle, or the start of the tip chamfer."""
    root_stated: bool = True
    """Whether the drawing says how the root is made; that of a ring without cutter or fillet is assumed, and no datum."""

    def headline(self) -> str:
        spec = self.spec
        module = f"module {spec.normal_module:g} mm"
        if spec.helix_angle != 0.0:
            module = f"normal {module}, {abs(math.degrees(spec.helix_angle)):g}° {spec.hand} hand"
            module += f", gap {spec.gap:g} mm" if spec.gap > 0.0 else ""
        ring = ", a ring" if spec.internal else ""
        return f"{spec.name}{ring}, {self.teeth} teeth, {module}, {self.face_width:g} mm wide"

    def rows(self) -> list[CardRow]:
        radii = {"tip": self.tip_radius, "reference": self.reference_radius, "form": self.form_radius, "root": self.root_radius}
        return [
            ("diameters", ", ".join(f"{name} {2.0 * radius:.3f}" for name, radius in radii.items()) + " mm"),
            ("tooth", f"{self.tooth_thickness:.4f} mm thick, {math.degrees(self.spec.normal_pressure_angle):g}°"),
        ]

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
            large, bore through the root, cutter that fouls a ring. The message gives the value and the limit.
        """
        name, m, alpha, orientation = spec.name, spec.normal_module, spec.normal_pressure_angle, spec.orientation
        cos_beta = math.cos(spec.helix_angle)
        transverse_module = m / cos_beta
        alpha_t = math.atan(math.tan(alpha) / cos_beta) if spec.helix_angle else alpha  # atan(tan α) loses the last digit
        r = 0.5 * transverse_module * spec.teeth
        rb = r * math.cos(alpha_t)
        ra = r + orientation * m * (spec.addendum + spec.profile_shift)
        rf = r - orientation * m * (spec.dedendum - spec.profile_shift)
        thickness = (0.5 * math.pi * m + 2.0 * spec.profile_shift * m * math.tan(alpha) - spec.thinning) / cos_beta
        psi_b = thickness / (2.0 * r) + orientation * involute_function(alpha_t)
        if min(rf, ra) <= 0.0 or orientation * (ra - rf) <= 0.0:
            where, (tip, bottom) = "inside" if spec.internal else "outside", apart(2 * ra, 2 * rf)
            raise InputError(
                f"[{name}] tip diameter {tip} mm and root diameter {bottom} mm: the tip must be {where} the root, and both above 0"
            )
        if ra <= rb:
            left = (
                f"a smaller addendum would leave an involute up to the tip ({SHIFT_BY_ISO})"
                if spec.internal
                else "no involute is left"
            )
            tip, base = apart(2 * ra, 2 * rb)
            raise InputError(f"[{name}] tip diameter {tip} mm lies inside the base circle {base} mm: {left}")

        flank_end = ra - orientation * spec.tip_chamfer
        if spec.tip_rounding > 0.0:
            flank_end = TipArc(spec.tip_rounding, ra, rb, psi_b, orientation).flank_end_radius
            if math.isnan(flank_end):
                raise InputError(
                    f"[{name}] tip_rounding = {spec.tip_rounding:g} mm: its centre lies within the base circle; a smaller one would be right"
                )
        section = ToothSection(r, rb, ra, rf, flank_end, alpha_t, psi_b)
        root = ring_root(spec, section) if spec.internal else rack_root(spec, section)
        if orientation * (flank_end - root.form_radius) <= 0.0:
            form, end = apart(2 * root.form_radius, 2 * flank_end)
            raise InputError(
                f"[{name}] form diameter {form} mm reaches the flank's end {end} mm: no involute is left; a smaller dedendum, more teeth or more profile shift would leave one"
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
            root_curve=root.curve,
            fillet_end=root.end,
            form_radius=root.form_radius,
            undercut=root.undercut,
            flank_end_radius=flank_end,
            root_stated=root.stated,
        )
        gear._check()
        return gear

    def recut(self, **changes: Any) -> Gear:
        """The gear with another tip edge or root than drawn, by fields of its specification: what is modified stays where it was drawn.

        Raises
        ------
        InputError
            As `from_spec`.
        """
        spec = replace(self.spec, **changes)
        if self.modified and spec.modified_between is None:
            spec = replace(spec, modified_between=(self.form_roll, self.tip_roll))
        return Gear.from_spec(spec)

    def _check(self) -> None:
        name, spec = self.spec.name, self.spec
        reference_half_angle = self.tooth_thickness / (2.0 * self.reference_radius)
        if not 0.0 < (reference_half_angle if spec.internal else self.base_half_angle) < math.pi:
            raise InputError(
                f"[{name}] tooth thickness {not_zero(self.tooth_thickness)} mm at the reference circle: no tooth is left; less thinning or more profile shift"
            )
        if spec.tip_rounding > 0.0 and self.tip_half_angle <= 0.0:
            raise InputError(f"[{name}] tip_rounding = {spec.tip_rounding:g} mm leaves no top land; a smaller one would be right")
        top_land = 2.0 * self.tip_radius * (float(self.half_angle(self.tip_radius)) if self.tip_arc else self.tip_half_angle)
        if top_land <= 0.0:
            meet = self.orientation * self.base_half_angle  # inv α where both flanks would meet
            pointed = (
                f" (the flanks meet at diameter {2 * self.base_radius / math.cos(inverse_involute(meet)):.4f})"
                if meet >= 0.0
                else ""
            )
            raise InputError(
                f"[{name}] the tooth is pointed: at tip diameter {2 * self.tip_radius:.4f} mm the top land is {not_zero(top_land)} mm{pointed}; a smaller addendum, profile_shift or tip_chamfer would leave a land"
            )
        if spec.tip_chamfer > 0.0 and self.tip_half_angle > float(self.half_angle(self.tip_radius)):
            lean = math.degrees(math.acos(self.base_radius / self.flank_end_radius))
            raise InputError(
                f"[{name}] tip_chamfer = {spec.tip_chamfer:g} mm: the flank leans {lean:.1f}° at the tip, more than the 45° of the chamfer, which would take nothing off; 0 would be right"
            )
        phi = np.linspace(0.0, self.fillet_end, 257)
        radius, angle = self.root_curve.polar(phi)
        if (self.orientation * np.diff(radius) <= 0.0).any():
            tool = "cutter_tip_radius" if spec.internal else f"rack_tip_radius = {spec.rack_tip_radius:g} modules"
            raise InputError(
                f"[{name}] {tool} with profile_shift {spec.profile_shift:g}: the generated root folds back on itself; a larger {'cutter' if spec.internal else 'rack'} tip radius or less shift would not"
            )
        if angle.max() >= 0.5 * self.pitch_angle or self.root_half_angle >= 0.5 * self.pitch_angle:
            raise InputError(
                f"[{name}] the {'cutter' if spec.internal else 'rack'} cuts the tooth off at its root (undercut past the centre line); more teeth or more profile_shift would leave one"
            )
        if spec.internal and spec.rim_diameter > 0.0 and not 0.5 * spec.rim_diameter > self.root_radius:
            raise InputError(
                f"[{name}] rim_diameter = {as_given(spec.rim_diameter)} mm: must be above the root diameter {at_least(2 * self.root_radius)} mm"
            )
        if not 0.5 * spec.bore_diameter < self.root_radius:
            raise InputError(
                f"[{name}] bore_diameter = {as_given(spec.bore_diameter)} mm: must be below the root diameter {at_most(2 * self.root_radius)} mm"
            )
        if not 2.0 * spec.end_edge < spec.face_width:
            key = "end_rounding" if spec.end_rounding > 0.0 else "end_chamfer"
            raise InputError(
                f"[{name}] {key} = {as_given(spec.end_edge)} mm: must be below half the face width {as_given(spec.face_width)} mm"
            )
        if self.modified:
            if spec.gap > 0.0:
                raise InputError(f"[{name}] gap = {spec.gap:g} mm: flanks of double helical gears cannot be modified yet")
            for side in Side:
                self.drawn(side).check(name if spec.left == spec.right else f"{name}.{side}")
            ends = np.array([0.0, 0.5, 1.0]) * spec.face_width
            land = self.tip_radius * self.half_angles(np.array([self.tip_radius]), ends).sum(
                axis=0
            ).min() - 2.0 * self.tip_radius * (float(self.half_angle(self.tip_radius)) - self.tip_half_angle)
            if land <= 0.0:
                raise InputError(f"[{name}] the modifications leave no top land; smaller amounts at the tip would leave one")

    @property
    def tolerance(self) -> GearTolerance:
        """How far the gear may lie off its drawing: what is stated, the usual where nothing is."""
        spec = self.spec
        dimensions = (2.0 * self.tip_radius, 2.0 * self.root_radius, spec.body_diameter, spec.face_width)
        return spec.tolerance.or_usual(*dimensions)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is worth knowing of the design, each a sentence: a root that is assumed."""
        if self.root_stated:
            return ()
        return (
            f"how the root of the {self.spec.name} is made is not stated: {self.root_curve.words(self.spec)} is assumed, and fillets and root "
            "are no datum; cutter_teeth and cutter_tip_radius, or fillet_radius (mm), would say it",
        )

    @property
    def rack(self) -> RackTip:
        """The generating rack of an external gear."""
        if not isinstance(self.root_curve, RackTip):
            raise TypeError(f"[{self.spec.name}] is a ring: no rack generates it")
        return self.root_curve

    @property
    def teeth(self) -> int:
        return self.spec.teeth

    @property
    def orientation(self) -> int:
        """ι: +1 of an external gear, −1 of a ring. Times a difference of radii it is + towards the tip."""
        return self.spec.orientation

    @property
    def body_radius(self) -> float:
        """Of the cylinder in which the body ends away from the teeth, mm: the bore, of a ring its outside; 0 where there is none."""
        return 0.5 * self.spec.body_diameter

    @property
    def rim_radius(self) -> float:
        """Where the body of a ring ends outside, mm: as stated, or `UNKNOWN_RIM` modules beyond the root circle."""
        return self.body_radius or self.root_radius + UNKNOWN_RIM * self.transverse_module

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
    def base_helix_sine(self) -> float:
        """sin β_b = sin β cos α_n, signed: how far a flank's normal leans along the axis."""
        return math.sin(self.base_helix_angle)

    @property
    def normal_lever(self) -> float:
        """r_b cos β_b, mm: lever arm of a flank's normal in space about the axis."""
        return self.base_radius * self.base_helix_cosine

    @property
    def thickness_radius(self) -> float:
        """Where the thickness of worn teeth is measured, mm: the reference circle; where that lies off the involute, as with much profile shift, near
        the end of it that is nearer."""
        low, high = sorted((self.form_radius, self.flank_end_radius))
        if low <= self.reference_radius <= high:
            return self.reference_radius
        inset = min(OFF_END * self.transverse_module, 0.5 * (high - low))
        return low + inset if self.reference_radius < low else high - inset

    @property
    def thickness_roll(self) -> float:
        """L at `thickness_radius`, mm."""
        return float(self.roll_length(self.thickness_radius))

    @property
    def arc_per_depth(self) -> float:
        """r / (r_b cos β_b): transverse arc at `thickness_radius` for each mm along a flank's normal in space."""
        return self.thickness_radius / self.normal_lever

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
    def base_thickness(self) -> float:
        """s_bt, mm: transverse arc of the tooth at the base circle."""
        return 2.0 * self.base_radius * self.base_half_angle

    @property
    def pitch_angle(self) -> float:
        """τ = 2π/z, rad."""
        return 2.0 * math.pi / self.spec.teeth

    @property
    def form_roll(self) -> float:
        """L at the form circle, mm; 0 where the root ends on the base circle."""
        return float(self.roll_length(self.form_radius))

    @property
    def tip_roll(self) -> float:
        """L where the involute ends at the top, mm."""
        return float(self.roll_length(self.flank_end_radius))

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
        if self.tip_arc is not None:
            return self.tip_arc.half_angle
        return float(self.half_angle(self.flank_end_radius)) - self.spec.tip_chamfer_on_land / self.tip_radius

    @property
    def tip_arc(self) -> TipArc | None:
        """The rounding of the tip; None where the tip is sharp or chamfered."""
        if self.spec.tip_rounding == 0.0:
            return None
        return TipArc(self.spec.tip_rounding, self.tip_radius, self.base_radius, self.base_half_angle, self.orientation)

    @property
    def root_half_angle(self) -> float:
        """Half angle, from the **space** centre line, of the bottom land, rad."""
        return self.root_curve.land_half_angle

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
        side = Side.of(side)
        modification, own = self.spec.left if side is Side.LEFT else self.spec.right, (self.form_roll, self.tip_roll)
        return DrawnFlank(modification, side, *(self.spec.modified_between or own), self.base_radius, self.face_width, own)

    def drawn_excess(self, roll: float) -> float:
        """How much thicker the modifications make the tooth at L = `roll` (mm) and mid-face, both flanks together, mm along the transverse
        base tangent."""
        return sum(float(self.drawn(side).offset(roll, 0.5 * self.face_width)) for side in Side)

    @property
    def drawn_tooth_thickness(self) -> float:
        """Transverse arc of the tooth at the reference circle as drawn, modifications at mid-face and all, mm."""
        return self.tooth_thickness + self.drawn_excess(self.reference_roll) / math.cos(self.transverse_pressure_angle)

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
        roll = self.roll_length(radius)
        return np.stack([generated + self.drawn(side).offset(roll, z[:, None]) / self.base_radius for side in Side])

    def half_angle(self, radius: ArrayLike) -> Floats:
        """Half angle ψ(r) = ψ_b − ι inv α of the whole tooth side as generated: involute, and the root curve beyond the form circle.

        Parameters
        ----------
        radius : (n,) float
            mm, between root and tip circle (the involute is continued beyond its end; beyond the root circle it stays as it is there).

        Returns
        -------
        (n,) float
            rad, from the tooth's centre line.
        """
        given = np.asarray(radius, dtype=np.float64)
        r, orientation = np.atleast_1d(given), self.orientation
        psi = self.base_half_angle - orientation * involute_at_roll(self.roll_length(r), self.base_radius)
        below = orientation * (r - self.form_radius) < 0.0
        if below.any():  # Newton steps only where there is fillet
            deepest = orientation * np.maximum(orientation * r[below], orientation * self.root_radius)
            psi[below] = 0.5 * self.pitch_angle - self.root_curve.polar(self.fillet_phi(deepest))[1]
        return np.asarray(psi.reshape(given.shape), dtype=np.float64)

    def roll_length(self, radius: ArrayLike) -> Floats:
        """L at radii in mm, 0 inside the base circle."""
        return roll_length(radius, self.base_radius)

    def fillet_phi(self, radius: Floats) -> Floats:
        """φ of the root curve at the given radius (mm, between root and form circle); `RackTip.at_radius` says how well."""
        return self.root_curve.at_radius(radius, self.fillet_end)

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
        """Exact area (mm²) of the transverse section at height `z` (mm; None: mid-face), bore taken out, of a ring up to its outside, end chamfers left out.

        Closed form on the involute; the root by its curve's `sector_area`; a tip chamfer by its triangle, a rounding by its arc; modifications by Gauss's
        rule between their knees, where it is exact: a parabola times L.
        """
        rb, psi, orientation = self.base_radius, self.base_half_angle, self.orientation
        if self.spec.internal and self.body_radius == 0.0:
            raise InputError(f"[{self.spec.name}] rim_diameter is missing: the ring's outside in mm; for its wear any will do")

        def under_involute(roll: float) -> float:  # ∫ ψ(r) r dr with r dr = L dL
            cubic, rest = roll**3 / (3 * rb), 0.5 * ((roll**2 + rb**2) * math.atan(roll / rb) - rb * roll)
            return psi * roll**2 / 2 - orientation * cubic + orientation * rest

        land = 0.5 * self.root_radius**2 * self.root_half_angle
        trochoid = self.root_curve.sector_area(self.fillet_end)
        form_angle = float(self.half_angle(self.form_radius))
        top_angle = float(self.half_angle(self.flank_end_radius))
        # Sector from the axis swept by the flank, between the half angles of its two ends: ½ ∫ r² dψ by parts.
        involute = under_involute(self.tip_roll) - under_involute(self.form_roll)
        involute += 0.5 * (self.form_radius**2 * form_angle - self.flank_end_radius**2 * top_angle)
        tip = 0.5 * self.tip_radius**2 * self.tip_half_angle
        chamfer = 0.5 * self.flank_end_radius * self.tip_radius * math.sin(top_angle - self.tip_half_angle)
        edge = self.tip_arc.sector_area if self.tip_arc is not None else chamfer
        half_tooth = land + trochoid + involute + tip + edge
        whole = orientation * (2.0 * self.teeth * half_tooth - math.pi * self.body_radius**2)
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
        return self.orientation * area / self.base_radius  # of a ring the rolls fall from the form circle to the tip
