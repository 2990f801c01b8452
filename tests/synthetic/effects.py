"""Effects, by really moving what they move. Names, units and signs of the contract's table; some outside it.

Manufacture gives each as-made tooth side a `turn` about the gear axis and a normal `shift`:

* what does not depend on L (thickness, pitch, helix slope, helix crowning, taper, feed marks) turns the whole
  side with its fillet, as a side cut of a hob does; the flank then moves by δ along its normal, the fillet by
  what a turn about the axis gives there, which fades out to the bottom land. With `Recipe.fillets_follow` off (ground
  flanks) the fillets stay;
* what depends on L (slope, crowning, reliefs, twist) shifts the flank along its normal, and the fillet not at all.

The tip land and the bottom land stay on their circles and end where the sides put their edges.
Scanner effects act about the gear's own axis and before the pose, in the order of `SCANNER`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from tests.synthetic.outline import Floats, Ints, Outline, Surface
from tests.synthetic.pose import Rigid, rotation_about

Value = float | tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Effect:
    """One declared effect: `Effect("coating", {"thickness_um": 18.0})`.

    Raises
    ------
    ValueError
        If the name is unknown, or the parameters are not exactly the effect's own.
    """

    name: str
    parameters: Mapping[str, Value] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.name not in PARAMETERS:
            raise ValueError(f"unknown effect {self.name!r}; known: {', '.join(sorted(PARAMETERS))}")
        if set(self.parameters) != set(PARAMETERS[self.name]):
            raise ValueError(f"{self.name} takes {PARAMETERS[self.name]}, got {tuple(self.parameters)}")
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))

    def __getitem__(self, parameter: str) -> float:
        value = self.parameters[parameter]
        assert isinstance(value, (int, float)), parameter
        return float(value)

    def __reduce__(self) -> tuple[type[Effect], tuple[str, dict[str, Value]]]:
        return Effect, (self.name, dict(self.parameters))


PARAMETERS: dict[str, tuple[str, ...]] = {
    # measurement
    "coating": ("thickness_um",),
    "scale": ("relative_ppm",),
    "scale_anisotropic": ("difference_ppm", "direction_deg"),
    "height_scale": ("relative_ppm",),
    "axis_offset_radial": ("offset_um",),
    "axis_offset_lateral": ("offset_um",),
    "turntable_angle": ("order", "amplitude_deg", "phase_deg"),
    "scan_drift": ("closure_deg", "start_deg"),
    # mounting: all but the datum moves, which is the bore for eccentricity and the end faces for wobble
    "eccentricity": ("amplitude_um", "direction_deg"),
    "wobble": ("amplitude_um", "direction_deg"),
    # manufacture
    "tooth_thickness": ("thickness_um",),
    "profile_slope": ("left_um", "right_um"),
    "profile_crowning": ("crowning_um",),
    "helix_crowning": ("crowning_um",),
    "tip_relief": ("amount_um", "start_mm"),
    "root_relief": ("amount_um", "start_mm"),
    "helix_slope": ("slope_um",),
    "taper": ("taper_um",),
    "twist": ("twist_um",),
    "pitch": ("index_um",),
    "thickness_variation": ("thickness_um",),
    "feed_marks": ("amplitude_um", "wavelength_mm", "phase_deg"),
    # outside the catalogue
    "wave_growing": ("order", "amplitude_um", "phase_deg"),
    "helical_scratch": ("tooth", "depth_um", "width_mm", "roll_mm", "rise_mm_per_mm"),
    "stitch_step": ("step_um", "z_mm"),
    "flank_ripple": ("amplitude_um", "wavelength_mm", "phase_deg"),
    "pitch_ridge": ("height_um", "width_mm"),
    "bend": ("tooth", "tip_um", "power"),
    "bend_at_end": ("tooth", "tip_um", "power"),
    "hinge": ("tooth", "tip_um"),
}
OUTSIDE = ("wave_growing", "helical_scratch", "stitch_step", "flank_ripple", "pitch_ridge")
"""Names no catalogue has.

wave_growing: δ = a (L / L_tip)² cos(n θ_P + φ), θ_P the point's polar angle; both sides.
helical_scratch: a groove across both flanks of a tooth (0-based), δ = −d exp(−½ (x / w)²), x = L − roll − rise (z − b/2).
stitch_step: every radius above z grows by the step.
flank_ripple: δ = a cos(2π L / λ + φ) on all left flanks.
pitch_ridge: δ = h exp(−½ ((L − L_ref) / w)²) on all left flanks, metal that plastic flow moved to the pitch line.
"""
BENT = ("bend", "bend_at_end", "hinge")
"""One tooth (0-based) that an overload bent, + counter-clockwise, both flanks of it alike; of the catalogue's `bent_tooth` examples.

bend: δ = s d v^p, v from 0 at the form circle to 1 at the tip.
bend_at_end: twice that at the upper end, and evenly down to nothing at the lower.
hinge: the tooth turns about the point of its middle line on the root circle, by as much as moves its flanks by d at the tip.
"""


@dataclass(frozen=True, slots=True)
class Feet:
    """Where on the design the points are: tooth (0-based), side ±1, roll L, height z; (n,) each or broadcastable."""

    tooth: Ints
    side: Ints
    roll: Floats
    z: Floats


def as_made(effects: Sequence[Effect], outline: Outline, feet: Feet) -> tuple[Floats, Floats]:
    """Turn about the axis (rad) and normal shift (mm) of the as-made flank, (n,) each, from the manufacture effects."""
    turn: Floats = np.zeros(np.broadcast_shapes(*(np.shape(x) for x in (feet.tooth, feet.side, feet.roll, feet.z))))
    shift = turn.copy()
    for effect in effects:
        if effect.name in TURNS:
            turn = turn + TURNS[effect.name](effect, outline, feet)
        elif effect.name in SHIFTS:
            shift = shift + 1e-3 * SHIFTS[effect.name](effect, outline, feet)
    return turn, shift


def _side_cut(delta_um: Callable[[Effect, Outline, Feet], Floats]) -> Callable[[Effect, Outline, Feet], Floats]:
    """The turn that moves the flank by δ: s δ / r_b."""
    return lambda e, o, f: f.side * 1e-3 * delta_um(e, o, f) / o.base_radius


def _pitch(e: Effect, o: Outline, f: Feet) -> Floats:
    index = np.asarray(e.parameters["index_um"], dtype=np.float64)
    return np.asarray(1e-3 * index[f.tooth] / o.reference_radius)


def _own_thickness(e: Effect, o: Outline, f: Feet) -> Floats:
    thicker = np.asarray(e.parameters["thickness_um"], dtype=np.float64)
    return np.asarray(f.side * 0.5e-3 * thicker[f.tooth] / o.reference_radius)


def _zeta(o: Outline, f: Feet) -> Floats:
    return f.z / o.face_width - 0.5


def _u(o: Outline, f: Feet) -> Floats:
    return 2.0 * (f.roll - o.form_roll) / (o.tip_roll - o.form_roll) - 1.0


def _wave(length: Floats, e: Effect) -> Floats:
    return e["amplitude_um"] * np.cos(2.0 * np.pi * length / e["wavelength_mm"] + math.radians(e["phase_deg"]))


def _slope(e: Effect, o: Outline, f: Feet) -> Floats:
    return np.where(f.side > 0, e["left_um"], e["right_um"]) * 0.5 * _u(o, f)


def _growing(e: Effect, o: Outline, f: Feet) -> Floats:
    tangent = f.roll / o.base_radius
    theta = f.tooth * o.pitch_angle + f.side * (o.base_half_angle - tangent + np.arctan(tangent))
    return e["amplitude_um"] * (f.roll / o.tip_roll) ** 2 * np.cos(e["order"] * theta + math.radians(e["phase_deg"]))


def _scratch(e: Effect, o: Outline, f: Feet) -> Floats:
    across = f.roll - e["roll_mm"] - e["rise_mm_per_mm"] * (f.z - 0.5 * o.face_width)
    return -e["depth_um"] * (f.tooth == e["tooth"]) * np.exp(-0.5 * (across / e["width_mm"]) ** 2)


def _bend(e: Effect, o: Outline, f: Feet) -> Floats:
    up = np.clip(0.5 * (1.0 + _u(o, f)), 0.0, None)
    return f.side * e["tip_um"] * np.where(f.tooth == e["tooth"], up ** e["power"], 0.0)


def _bend_at_end(e: Effect, o: Outline, f: Feet) -> Floats:
    return _bend(e, o, f) * (1.0 + 2.0 * _zeta(o, f))


def _hinge(e: Effect, o: Outline, f: Feet) -> Floats:
    """Lever of the normal about the hinge: r_b − r_f cos φ, φ where the normal's foot lies on the base circle."""

    def lever(roll: Floats | float) -> Floats:
        return np.asarray(o.base_radius - o.root_radius * np.cos(o.base_half_angle - np.asarray(roll) / o.base_radius))

    return f.side * e["tip_um"] * np.where(f.tooth == e["tooth"], lever(f.roll) / lever(o.tip_roll), 0.0)


TURNS: dict[str, Callable[[Effect, Outline, Feet], Floats]] = {
    "tooth_thickness": lambda e, o, f: f.side * 0.5e-3 * e["thickness_um"] / o.reference_radius,
    "pitch": _pitch,
    "thickness_variation": _own_thickness,
    "helix_slope": _side_cut(lambda e, o, f: f.side * e["slope_um"] * _zeta(o, f)),
    "taper": _side_cut(lambda e, o, f: e["taper_um"] * _zeta(o, f)),
    "helix_crowning": _side_cut(lambda e, o, f: -e["crowning_um"] * (2.0 * _zeta(o, f)) ** 2),
    "feed_marks": _side_cut(lambda e, o, f: _wave(f.z, e)),
}
SHIFTS: dict[str, Callable[[Effect, Outline, Feet], Floats]] = {
    "profile_slope": _slope,
    "profile_crowning": lambda e, o, f: -e["crowning_um"] * _u(o, f) ** 2,
    "tip_relief": lambda e, o, f: -e["amount_um"] * np.maximum(f.roll - e["start_mm"], 0.0) / (o.tip_roll - e["start_mm"]),
    "root_relief": lambda e, o, f: -e["amount_um"] * np.maximum(e["start_mm"] - f.roll, 0.0) / (e["start_mm"] - o.form_roll),
    "twist": lambda e, o, f: 0.5 * e["twist_um"] * _u(o, f) * _zeta(o, f),
    "wave_growing": _growing,
    "helical_scratch": _scratch,
    "flank_ripple": lambda e, o, f: (f.side > 0) * _wave(f.roll, e),
    "bend": _bend,
    "bend_at_end": _bend_at_end,
    "hinge": _hinge,
    "pitch_ridge": lambda e, o, f: (
        (f.side > 0) * e["height_um"] * np.exp(-0.5 * ((f.roll - o.reference_roll) / e["width_mm"]) ** 2)
    ),
}


def mount(effects: Sequence[Effect], outline: Outline, points: Floats, surface: Ints) -> Floats:
    """Move all but the datum. Wobble swings by `amplitude_um` at the upper end towards `direction_deg`, back at the lower."""
    bore = (surface == Surface.BORE)[:, None]
    ends = ((surface == Surface.END_LOW) | (surface == Surface.END_HIGH))[:, None]
    centre = np.array([0.0, 0.0, 0.5 * outline.face_width])
    for effect in sorted(effects, key=lambda e: e.name):
        if effect.name not in ("eccentricity", "wobble"):
            continue
        direction = math.radians(effect["direction_deg"])
        along = np.array([math.cos(direction), math.sin(direction), 0.0])
        size = 1e-3 * effect["amplitude_um"]
        if effect.name == "eccentricity":
            points = np.where(bore, points, points + size * along)
        else:
            axis = math.atan(size / centre[2]) * np.array([-along[1], along[0], 0.0])
            leaning = Rigid(rotation_about(axis), np.zeros(3)).apply(points - centre) + centre
            points = np.where(ends, points, leaning)
    return points


def scanned(effects: Sequence[Effect], points: Floats, pose: Rigid) -> Floats:
    """What the scanner makes of the points, (n, 3), still in the design frame; in the order of `SCANNER`."""
    for name, move in SCANNER.items():
        for effect in effects:
            if effect.name == name:
                points = move(effect, points, pose)
    return points


def _turned(points: Floats, angle: Floats) -> Floats:
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = points.T
    return np.column_stack([x * cos - y * sin, x * sin + y * cos, z])


def _theta(points: Floats) -> Floats:
    return np.asarray(np.arctan2(points[:, 1], points[:, 0]))


def _radius(points: Floats) -> Floats:
    return np.asarray(np.hypot(points[:, 0], points[:, 1]))


def _grown(points: Floats, by: Floats | float) -> Floats:
    factor = 1.0 + by / _radius(points)
    return points * np.column_stack([factor, factor, np.ones_like(factor)])


def _offset_radial(e: Effect, points: Floats, pose: Rigid) -> Floats:
    return _grown(points, 1e-3 * e["offset_um"])


def _offset_lateral(e: Effect, points: Floats, pose: Rigid) -> Floats:
    return _turned(points, 1e-3 * e["offset_um"] / _radius(points))


def _table(e: Effect, points: Floats, pose: Rigid) -> Floats:
    wave = np.cos(e["order"] * _theta(points) + math.radians(e["phase_deg"]))
    return _turned(points, math.radians(e["amplitude_deg"]) * wave)


def _drift(e: Effect, points: Floats, pose: Rigid) -> Floats:
    share = np.mod(_theta(points) - math.radians(e["start_deg"]), 2.0 * math.pi) / (2.0 * math.pi)
    return _turned(points, math.radians(e["closure_deg"]) * (share - 0.5))


def _stitch(e: Effect, points: Floats, pose: Rigid) -> Floats:
    return _grown(points, 1e-3 * e["step_um"] * (points[:, 2] > e["z_mm"]))


def _anisotropic(e: Effect, points: Floats, pose: Rigid) -> Floats:
    along = anisotropy_direction(e, pose)
    half = 0.5e-6 * e["difference_ppm"]
    x, y = points[:, 0], points[:, 1]
    c, s = math.cos(along), math.sin(along)
    u, v = (c * x + s * y) * (1.0 + half), (c * y - s * x) * (1.0 - half)
    return np.column_stack([c * u - s * v, s * u + c * v, points[:, 2]])


def anisotropy_direction(e: Effect, pose: Rigid) -> float:
    """The direction, given in the scan's own axes, as an angle in the design's plane of rotation, rad."""
    angle = math.radians(e["direction_deg"])
    seen = pose.rotation.T @ np.array([math.cos(angle), math.sin(angle), 0.0])
    return math.atan2(seen[1], seen[0])


SCANNER: dict[str, Callable[[Effect, Floats, Rigid], Floats]] = {
    "axis_offset_radial": _offset_radial,
    "axis_offset_lateral": _offset_lateral,
    "turntable_angle": _table,
    "scan_drift": _drift,
    "stitch_step": _stitch,
    "height_scale": lambda e, p, pose: p * np.array([1.0, 1.0, 1.0 + 1e-6 * e["relative_ppm"]]),
    "scale_anisotropic": _anisotropic,
    "scale": lambda e, p, pose: p * (1.0 + 1e-6 * e["relative_ppm"]),
}
"""What the scanner does, first to last: rays from a zero off the axis, angles of the table, merging, calibration."""
