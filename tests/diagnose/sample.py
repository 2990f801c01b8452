"""Points of a gear that the tests move in space, and what is put in. Geometry from the synthetic generator, not from the package."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.surface import SurfacePoints, locate
from gearwear.diagnose.active_face import ActiveFace
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context, Shape
from gearwear.diagnose.parameter import Role
from tests.synthetic import PINION, GearNumbers, Outline, Surface

BORED = GearNumbers(bore_diameter=25.0)
"""The paper's pinion, undercut, with a bore."""
ODD = GearNumbers(teeth=17, module=3.0, face_width=10.0, pressure_angle_deg=25.0, profile_shift=0.2, bore_diameter=20.0)
"""A gear of other numbers everywhere: no undercut, odd teeth, 25°, shifted."""
MATE = {BORED: (24, 114.3), PINION: (24, 114.3), ODD: (31, 73.5)}
"""Teeth of the mate, centre distance in mm."""
CLEAR = 0.12
"""Modules kept away from edges, where a moved point changes its surface, and from the form circle."""
CLOSE = 0.0005
"""The same for points that stay where they are."""
FIXED = {one.name for effect in catalogue() for one in effect.parameters if one.role is Role.PLACE}
"""Parameters that say where or how fine, not how much: with all others halved the deviation is halved, which is tested."""

FILLET_COLUMNS = 3

Value = float | tuple[float, ...]


@dataclass(frozen=True)
class Example:
    """One effect of one size: what the contract calls it, and the same as amplitudes (mm, rad, ratio) and shape."""

    parameters: dict[str, Value]
    amplitudes: tuple[float, ...]
    shape: Shape = ()
    gear: GearNumbers = BORED

    def scaled(self, factor: float) -> dict[str, Value]:
        """The parameters with all sizes multiplied."""
        return {
            name: value if name in FIXED else tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value
            for name, value in self.parameters.items()
        }


@dataclass(frozen=True)
class Sample:
    """Points on all surfaces of a nominal gear, away from its edges."""

    outline: Outline
    position: Floats
    normal: Floats
    surface: Ints
    tooth: Ints
    side: Ints
    roll: Floats
    gear: Gear = field(repr=False)

    def __len__(self) -> int:
        return len(self.surface)

    @property
    def flank(self) -> Bools:
        return self.surface == Surface.FLANK

    @property
    def sides(self) -> Bools:
        """Flanks and fillets."""
        return self.surface <= Surface.FILLET

    @property
    def teeth(self) -> Bools:
        return self.surface <= Surface.TIP

    @property
    def radius(self) -> Floats:
        return np.hypot(self.position[:, 0], self.position[:, 1])

    @property
    def theta(self) -> Floats:
        return np.arctan2(self.position[:, 1], self.position[:, 0])

    @property
    def z(self) -> Floats:
        return self.position[:, 2]

    @property
    def zeta(self) -> Floats:
        return self.z / self.outline.face_width - 0.5

    @property
    def u(self) -> Floats:
        """−1 at the form circle, +1 at the tip, 0 off the flanks."""
        o = self.outline
        return np.where(self.flank, 2.0 * (np.nan_to_num(self.roll) - o.form_roll) / (o.tip_roll - o.form_roll) - 1.0, 0.0)

    def pushed(self, distance: Floats | float) -> Floats:
        """Moved along the normals, mm."""
        return self.position + np.broadcast_to(distance, len(self))[:, None] * self.normal

    def along_base(self, distance: Floats | float) -> Floats:
        """Moved along the transverse base tangent, mm, as ISO 1328 states profile and helix: on a spur gear along the normals."""
        flat = self.normal * [1.0, 1.0, 0.0]
        away = np.linalg.norm(flat, axis=1, keepdims=True)
        return self.position + np.broadcast_to(distance, len(self))[:, None] * np.where(
            away > 0.0, flat / np.maximum(away, 1e-12), 0.0
        )

    def grown(self, by: Floats | float) -> Floats:
        """Moved away from the axis, mm."""
        shift = np.broadcast_to(by, len(self)) / self.radius
        return self.position * np.column_stack([1.0 + shift, 1.0 + shift, np.ones(len(self))])

    def turned(self, angle: Floats | float) -> Floats:
        """Turned about the axis, rad, + counter-clockwise."""
        cos, sin = np.cos(angle), np.sin(angle)
        x, y, z = self.position.T
        return np.column_stack([x * cos - y * sin, x * sin + y * cos, z])

    def cut(self, turn: Floats | float, fillets: float) -> Floats:
        """Tooth sides turned about the axis, rad: flanks all of it, fillets a share."""
        return self.turned(np.where(self.flank, turn, np.where(self.sides, fillets * turn, 0.0)))


@cache
def sample(numbers: GearNumbers = BORED, clear: float = CLEAR) -> Sample:
    """Points of a gear: 61 a tooth in 5 slices, both end faces, the bore; `clear` modules away from edges."""
    outline = Outline.of(numbers)
    margin = clear * numbers.module
    half_tip, flank, *_ = outline.arcs
    edges = np.array([half_tip, half_tip + flank])[:, None] + 0.01 * numbers.module * np.array([-1.0, 1.0])
    section = outline.at(np.concatenate([outline.equal_arcs(61), edges.ravel(), -edges.ravel()]))
    count = len(section.surface)
    z = np.linspace(margin, outline.face_width - margin, 5)
    radius = np.hypot(*section.position.T)
    keep = (np.abs(radius - outline.form_radius) > margin) & (np.abs(radius - outline.tip_radius) > margin)
    within = np.abs(np.arctan2(section.position[:, 1], section.position[:, 0]))
    keep |= (section.surface == Surface.TIP) & (within < (1.0 - 2.5 * clear) * outline.tip_half_angle)
    keep |= section.surface == Surface.ROOT
    parts = []
    for tooth in range(outline.teeth):
        cos, sin = np.cos(tooth * outline.pitch_angle), np.sin(tooth * outline.pitch_angle)
        turn = np.array([[cos, sin], [-sin, cos]])
        for height in z:
            position = np.column_stack([section.position @ turn, np.full(count, height)])
            normal = np.column_stack([section.normal @ turn, np.zeros(count)])
            side = np.where(section.surface <= Surface.FILLET, section.side, 0)
            parts.append((position, normal, section.surface, np.full(count, tooth), side, section.roll))
    parts = [tuple(column[keep] for column in part) for part in parts]
    parts += [
        _ring(outline, r, height, up) for height, up in ((0.0, -1.0), (outline.face_width, 1.0)) for r in _rings(outline, margin)
    ]
    bore = 0.5 * numbers.bore_diameter
    if bore:
        parts += [_ring(outline, bore, height, 0.0) for height in z]
    spec = GearSpec(
        "pinion", numbers.teeth, numbers.module, numbers.face_width, np.radians(numbers.pressure_angle_deg), numbers.profile_shift,
        numbers.addendum, numbers.dedendum, numbers.rack_tip_radius, numbers.thinning, numbers.bore_diameter,
    )  # fmt: skip
    return Sample(outline, *(np.concatenate(column) for column in zip(*parts, strict=True)), Gear.from_spec(spec))


@cache
def feet(numbers: GearNumbers = BORED, clear: float = CLEAR) -> SurfacePoints:
    """The sample's points as the package locates them."""
    one = sample(numbers, clear)
    return locate(one.position, one.gear)


def _rings(outline: Outline, margin: float) -> Floats:
    return np.linspace(0.5 * outline.numbers.bore_diameter + margin, outline.root_radius - margin, 4)


def _ring(outline: Outline, radius: float, z: float, up: float) -> tuple[Floats, ...]:
    """48 points of an end face (up = ±1) or of the bore (0)."""
    angle = np.linspace(-np.pi, np.pi, 48, endpoint=False) + 0.01
    x, y = np.cos(angle), np.sin(angle)
    zero = np.zeros(48)
    normal = np.column_stack([-x, -y, zero]) if up == 0.0 else np.column_stack([zero, zero, zero + up])
    surface = {0.0: Surface.BORE, -1.0: Surface.END_LOW, 1.0: Surface.END_HIGH}[up]
    tooth = np.mod(np.rint(angle / outline.pitch_angle).astype(int), outline.teeth)
    position = np.column_stack([radius * x, radius * y, zero + z])
    return position, normal, np.full(48, surface), tooth, np.zeros(48, int), np.full(48, np.nan)


def fillet_edges(gear: Gear) -> Floats:
    """Radii that divide a fillet into `FILLET_COLUMNS` equal arcs, along a fine polygon."""
    radius, angle = gear.rack.polar(np.linspace(0.0, gear.fillet_end, 2000))
    way = np.append(0.0, np.cumsum(np.hypot(np.diff(radius), radius[1:] * np.diff(angle))))
    return np.interp(np.linspace(0.0, way[-1], FILLET_COLUMNS + 1), way, radius)


def context(numbers: GearNumbers = BORED, axes: Floats | None = None, planar: bool = False) -> Context:
    """What a scan of all surfaces would tell an effect."""
    gear = sample(numbers).gear
    teeth, centre = MATE[numbers]
    mate_base = gear.base_radius * teeth / gear.teeth
    line = float(np.sqrt(centre**2 - (gear.base_radius + mate_base) ** 2))
    edges = tuple(fillet_edges(gear).tolist())
    about = Context(
        gear, frozenset(sample(numbers).surface.tolist()), np.eye(3) if axes is None else axes, planar, (teeth / gear.teeth, line)
    )
    width = gear.face_width
    ran = (ActiveFace(Side.LEFT, 0.2 * width, 0.7 * width), ActiveFace(Side.RIGHT, 0.0, 0.8 * width))
    return replace(about, fillet_edges=edges, faces=ran)
