"""Every effect on helical gears: what really displaced points measure, to second order.

The displacements are those of the effects' own tests, in space and written without the effect; where one of them draws a spur gear, it is
drawn here anew. The gears have the numbers of the spur samples and helix angles of either hand.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import SurfacePoints, locate
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context
from gearwear.placing.pose import motion_columns
from tests.diagnose.sample import BORED, ODD, PINION, Sample, context
from tests.diagnose.test_root_form import along_fillet
from tests.synthetic import GearNumbers, Outline, Surface

ANGLES = {BORED: 15.0, ODD: -25.0, PINION: 35.0}
"""Degrees, of the numbers of each spur sample."""


@dataclass(frozen=True)
class Drawn:
    """What the displacements ask of an outline, from the transverse section."""

    gear: Gear
    numbers: GearNumbers

    def __getattr__(self, name: str):
        return getattr(self.gear, name)


def drawn(numbers: GearNumbers, **more: float) -> Gear:
    values = {
        "normal_pressure_angle": math.radians(numbers.pressure_angle_deg), "profile_shift": numbers.profile_shift,
        "addendum": numbers.addendum, "dedendum": numbers.dedendum, "rack_tip_radius": numbers.rack_tip_radius,
        "bore_diameter": numbers.bore_diameter, "helix_angle": math.radians(ANGLES[numbers]),
    }  # fmt: skip
    return Gear.from_spec(GearSpec("pinion", numbers.teeth, numbers.module, numbers.face_width, **{**values, **more}))


def _on_screw(gear: Gear, radius: np.ndarray, angle: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Points of the section at their own heights: turned by 2π z / lead about mid-face."""
    s = gear.spec
    lead = math.pi * s.teeth * s.normal_module / math.sin(s.helix_angle)
    angle = angle + 2.0 * math.pi * (z - 0.5 * s.face_width) / lead
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


@cache
def helical(numbers: GearNumbers) -> Sample:
    """Points away from all edges, with normals by differences along the section and along the screw."""
    gear = drawn(numbers)
    half = np.linspace(0.1, 0.85, 6)
    roll = gear.form_roll + np.linspace(0.12, 0.94, 12) * (gear.tip_roll - gear.form_roll)
    phi = np.linspace(0.15, 0.9, 9) * gear.fillet_end
    z = np.linspace(0.12, 0.88, 5) * gear.face_width
    parts = []

    def add(curve, values, surface, side, rolls) -> None:
        t, k, height = (a.ravel() for a in np.meshgrid(values, np.arange(gear.teeth), z, indexing="ij"))
        place = lambda u, at: _on_screw(gear, curve(u)[0], curve(u)[1] + k * gear.pitch_angle, at)  # noqa: E731
        along = place(t + 2e-5, height) - place(t - 2e-5, height)
        up = place(t, height + 2e-4) - place(t, height - 2e-4)
        normal = np.cross(along, up)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        position = place(t, height)
        if surface is Surface.TIP or surface is Surface.ROOT:
            out = np.sign((normal * position)[:, :2].sum(axis=1))
        else:  # away from the middle of the tooth
            turning = position[:, 0] * normal[:, 1] - position[:, 1] * normal[:, 0]
            out = side * np.sign(turning)
        owner = k if surface is not Surface.ROOT else (k + (side < 0)) % gear.teeth
        count = np.full(len(t), 1)
        L = np.repeat(rolls, len(z) * gear.teeth) if rolls is not None else np.full(len(t), np.nan)
        parts.append(
            (position, normal * out[:, None], count * int(surface), owner, count * side * (surface <= Surface.FILLET), L)
        )

    base, psi = gear.base_radius, gear.base_half_angle
    for side in (1, -1):
        add(lambda L, s=side: (np.hypot(base, L), s * (psi - L / base + np.arctan(L / base))), roll, Surface.FLANK, side, roll)
        add(
            lambda p, s=side: (gear.rack.polar(p)[0], s * (0.5 * gear.pitch_angle - gear.rack.polar(p)[1])),
            phi, Surface.FILLET, side, None,
        )  # fmt: skip
        add(lambda a, s=side: (gear.tip_radius + 0 * a, s * a), half * gear.tip_half_angle, Surface.TIP, side, None)
        if gear.root_half_angle > 0.01:
            add(
                lambda a, s=side: (gear.root_radius + 0 * a, s * (0.5 * gear.pitch_angle - a)),
                half * gear.root_half_angle, Surface.ROOT, side, None,
            )  # fmt: skip
    bore = 0.5 * numbers.bore_diameter
    around = np.linspace(-np.pi, np.pi, 48, endpoint=False) + 0.01
    for r in np.linspace(bore + 0.1 * numbers.module, gear.root_radius - 0.1 * numbers.module, 4):
        for height, up, surface in ((0.0, -1.0, Surface.END_LOW), (gear.face_width, 1.0, Surface.END_HIGH)):
            parts.append(_ring(r, around, height, [0.0, 0.0, up], surface))
    for height in z if bore else ():
        parts.append(_ring(bore, around, height, None, Surface.BORE))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return Sample(Drawn(gear, numbers), *columns, gear)  # type: ignore[arg-type]


def _ring(radius, angle, z, normal, surface):
    x, y, one = np.cos(angle), np.sin(angle), np.ones(len(angle))
    outward = np.column_stack([-x, -y, 0 * one]) if normal is None else np.outer(one, normal)
    position = np.column_stack([radius * x, radius * y, z * one])
    return position, outward, int(surface) * one.astype(int), 0 * one.astype(int), 0 * one.astype(int), np.nan * one


@cache
def feet(numbers: GearNumbers) -> SurfacePoints:
    return locate(helical(numbers).position, helical(numbers).gear)


def about(numbers: GearNumbers) -> Context:
    """As of the spur sample, for the helical gear; ratio and line of action are stated, and stay."""
    gear, one = helical(numbers).gear, helical(numbers)
    spur = context(numbers if numbers in (BORED, ODD) else BORED)
    edges = np.interp(np.linspace(0, 1, 4), [0, 1], [gear.root_radius, gear.form_radius])
    return replace(spur, gear=gear, surfaces=frozenset(one.surface.tolist()), fillet_edges=tuple(edges.tolist()))


def shifted(one: Sample, parameters, shape) -> np.ndarray:
    """The points of a gear cut with the rack further out, at the same roll lengths and rack angles; tips stay."""
    gear, numbers = one.gear, one.outline.numbers
    x = 1e-3 * parameters["shift_um"] / numbers.module
    other = drawn(numbers, profile_shift=numbers.profile_shift + x, addendum=numbers.addendum - x)
    moved, tooth = one.position.copy(), one.tooth * gear.pitch_angle
    flank, fillet, root = (one.surface == code for code in (Surface.FLANK, Surface.FILLET, Surface.ROOT))
    L, base = one.roll[flank], other.base_radius
    half = other.base_half_angle - L / base + np.arctan(L / base)
    moved[flank] = _on_screw(other, np.hypot(base, L), tooth[flank] + one.side[flank] * half, one.z[flank])
    radius, angle = other.rack.polar(gear.fillet_phi(one.radius[fillet]))
    moved[fillet] = _on_screw(other, radius, tooth[fillet] + one.side[fillet] * (0.5 * gear.pitch_angle - angle), one.z[fillet])
    moved[root, :2] *= other.root_radius / gear.root_radius
    return moved


def rounded(one: Sample, parameters, shape) -> np.ndarray:
    """Down along the normal by a parabola that ends half a width from tip corners, square to them, and from face edges."""
    gear, width = one.gear, parameters["width_mm"]
    corner = 1.0 - gear.tip_roll / gear.tip_radius
    arc = np.full(len(one), np.inf)
    arc[one.flank] = (gear.tip_roll**2 - one.roll[one.flank] ** 2) / (2 * gear.base_radius)
    tip = one.surface == Surface.TIP
    lead = math.pi * gear.teeth * gear.normal_module / math.sin(gear.helix_angle)
    turn = one.theta[tip] - 2 * np.pi * (one.z[tip] - 0.5 * gear.face_width) / lead
    within = np.abs(np.angle(np.exp(1j * gear.teeth * turn)) / gear.teeth)
    slant = math.cos(math.atan(2 * math.pi * gear.tip_radius / lead))
    arc[tip] = slant * gear.tip_radius * (gear.tip_half_angle - within)
    face = np.where(one.teeth, np.minimum(one.z, gear.face_width - one.z), np.inf)
    fall = np.maximum(np.clip(1 - 2 * arc / width, 0, 1) ** 2, np.clip(1 - 2 * face / width, 0, 1) ** 2 / np.sqrt(corner))
    return one.pushed(-1e-3 * parameters["amount_um"] * fall)


def ringed(one: Sample, parameters, shape) -> np.ndarray:
    """The fillets pushed out by levels in the middles of their rings, straight between and beyond them along the way out of the bottom lands; the lowest
    30 % of the flanks bent in."""
    every, edges = 1e-3 * np.array(parameters["level_um"]), np.array(about(one.outline.numbers).fillet_edges)
    level, gear = every[:-3], one.gear
    way = along_fillet(one.radius, edges, level)
    knots = np.linspace(gear.form_roll**2, (0.7 * gear.form_roll + 0.3 * gear.tip_roll) ** 2, 4)
    flank = np.interp(np.nan_to_num(one.roll) ** 2, knots, [*every[-3:], 0.0])
    on = np.where(one.surface == Surface.FILLET, way, np.where(one.surface == Surface.ROOT, level[-1], 0.0))
    return one.pushed(np.where(one.surface == Surface.FLANK, flank, on))


def sunk(one: Sample, parameters, shape) -> np.ndarray:
    """In along the normal by the curvature of each surface over a flank's at the reference circle: across its straight lines, which lean as the base helix
    does, a helicoid bends as the section's involute times the cosine of that."""
    gear = one.gear
    lead = math.pi * gear.teeth * gear.normal_module / abs(math.sin(gear.helix_angle))
    lean = math.cos(math.atan(2.0 * math.pi * gear.base_radius / lead))
    bent = np.zeros(len(one))
    bent[one.flank] = lean / one.roll[one.flank]
    on = np.isin(one.surface, (Surface.ROOT, Surface.TIP))
    bent[on] = 1.0 / one.radius[on]
    bent[one.surface == Surface.BORE] = -1.0 / one.radius[one.surface == Surface.BORE]
    reference = gear.reference_radius * math.sin(gear.transverse_pressure_angle)
    return one.pushed(-1e-3 * parameters["sag_um"] * bent * reference / lean)


ANEW = {"profile_shift": shifted, "edge_rounding": rounded, "root_form": ringed, "smoothing": sunk}
"""Displacements that the effects' own tests draw on a spur gear."""


def cases():
    for effect in catalogue():
        module = importlib.import_module(f"tests.diagnose.test_{effect.name}")
        for number, example in enumerate(module.EXAMPLES):
            yield pytest.param(effect, example, ANEW.get(effect.name, module.displace), id=f"{effect.name}-{number}")


def test_the_samples_lie_on_the_gears_with_their_normals():
    for numbers in ANGLES:
        one, foot = helical(numbers), feet(numbers)
        assert np.abs(foot.deviation).max() < 1e-12
        assert (foot.surface == one.surface).all()
        assert foot.normal == pytest.approx(one.normal, abs=1e-7)
        teeth = one.teeth & (one.surface != Surface.ROOT)
        assert np.array_equal(foot.tooth[teeth], one.tooth[teeth]) and np.array_equal(foot.side, one.side)


@pytest.mark.parametrize(("effect", "example", "displace"), list(cases()))
def test_basis_is_what_really_displaced_points_measure_to_second_order(effect, example, displace):
    one, foot = helical(example.gear), feet(example.gear)
    amplitudes, parameters = np.array(example.amplitudes), example
    if effect.name == "root_form" and len(amplitudes) < 6 + (Surface.ROOT in foot.surface):
        amplitudes = np.insert(amplitudes, 3, 0.03)
        parameters = replace(example, parameters={"level_um": tuple((1e3 * amplitudes).tolist())})
    basis = effect.basis(foot, about(example.gear), example.shape) @ amplitudes
    assert np.abs(basis).max() > 1e-3
    errors = []
    for factor in (1.0, 0.5):
        moved = locate(displace(one, parameters.scaled(factor), example.shape), one.gear)
        same = (moved.surface == foot.surface) & (moved.tooth == foot.tooth) & (moved.side == foot.side)
        assert same.mean() > 0.95
        errors.append(np.abs(moved.deviation - factor * basis)[same].max())
    assert errors[0] < 0.05 * np.abs(basis).max()
    assert errors[1] < 0.3 * errors[0] or errors[0] < 1e-8


def _column(name: str, points: SurfacePoints, given: Context, shape=()) -> np.ndarray:
    return next(effect for effect in catalogue() if effect.name == name).basis(points, given, shape)[:, 0]


def test_without_end_faces_a_scale_of_heights_is_a_helix_slope():
    """On every surface the screw carries along, to rounding, beside the pose: only end faces tell them apart."""
    for numbers in ANGLES:
        given, points = about(numbers), feet(numbers)
        sides = points.take(points.surface < Surface.END_LOW)
        pose = motion_columns(sides.position, sides.normal)
        slope, height = (_column(name, sides, given, shape) for name, shape in (("helix_slope", (1.0,)), ("height_scale", ())))
        left = [column - pose @ np.linalg.lstsq(pose, column, rcond=None)[0] for column in (slope, height)]
        cosine = left[0] @ left[1] / np.linalg.norm(left[0]) / np.linalg.norm(left[1])
        assert abs(cosine) == pytest.approx(1.0, abs=1e-10)
        gear = given.gear
        flank = sides.surface == Surface.FLANK
        # δ of the scale is −s sin β_b e z; of the slope s cos β_b f z / b.
        expected = -math.tan(gear.base_helix_angle) * gear.face_width * slope[flank]
        shift = (height[flank] - expected) * sides.side[flank]
        assert np.ptp(shift) < 1e-9


def test_height_scale_applies_without_faces_on_helical_gears_alone():
    effect = next(effect for effect in catalogue() if effect.name == "height_scale")
    teeth = frozenset({0, 1, 2, 3})
    assert effect.applies(replace(about(BORED), surfaces=teeth))
    assert not effect.applies(replace(context(BORED), surfaces=teeth))
    assert not effect.applies(replace(about(BORED), surfaces=teeth, planar=True))


def test_the_outlines_of_the_samples_are_not_the_spur_ones():
    for numbers, degrees in ANGLES.items():
        gear, spur = helical(numbers).gear, Outline.of(numbers)
        assert gear.reference_radius == pytest.approx(spur.reference_radius / math.cos(math.radians(degrees)))
