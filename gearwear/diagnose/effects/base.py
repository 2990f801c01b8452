"""What an effect is: a file with one class that says how the deviations change.

``deviation = basis(points, shape) @ amplitudes``. What is linear is an amplitude, in mm or rad inside; what is not (an
order, a wavelength, a start) is a shape value, and the effect offers a grid of them. Every sign and unit of the reported parameters
is fixed by the contract and stands in the effect's docstring and in docs/effects.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, SurfacePoints
from gearwear.design.twist import helix_coordinate
from gearwear.diagnose.active_face import ActiveFace
from gearwear.diagnose.bent_teeth import Bent
from gearwear.diagnose.parameter import Parameter, Role
from gearwear.diagnose.parameter import ParameterEstimate as ParameterEstimate

Shape = tuple[float, ...]
"""Values of an effect's nonlinear parameters; () where it has none. Continuous values first, then choices (a side, a surface)."""

SCALE_LIMIT = 0.005
"""Relative error of length of an instrument that is in order, where none is stated: hand-held scanners reach some parts in a thousand."""

LEAST_ROLL = 0.02
"""Modules of roll length below which sliding is not followed: it grows without bound towards the base circle."""


class Kind(StrEnum):
    """Where an effect comes from. FORM is what a drawing has a tolerance for, or leaves open: the level of tips, ends and bore, the root
    as it is; it belongs to the gear as made and is no finding. Only WEAR counts as worn volume."""

    MEASUREMENT = "measurement"
    MOUNTING = "mounting"
    MANUFACTURE = "manufacture"
    FORM = "form"
    WEAR = "wear"


MEASURED = frozenset({Kind.MEASUREMENT, Kind.MOUNTING})
"""What the scanner did, and how the gear lay on it."""
MADE = frozenset({Kind.MANUFACTURE, Kind.FORM})
"""How the gear was made."""


@dataclass(frozen=True, slots=True)
class Context:
    """What an effect may need to know besides the points.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    surfaces : frozenset of int
        Surface codes the scan has seen.
    scan_axes : (3, 3) float
        The scan's own axes in the design frame, as columns.
    planar : bool
        True for a planar section.
    mate : (float, float) or None
        Gear ratio u = z2 / z1 and length C sin α' of the line of action (mm), where the design has a mate. Where one of both is a ring, u is
        below 0, and where the mate is, the length too: L1 + L2 = C sin α' then is L2 − L1, and on the ring L1 − L2.
    row_height : float
        Height of the cells the scan is averaged over, mm; 0 where single points are looked at.
    scale_limit : float
        Largest relative error of the scanner's scale.
    turntable : bool
        Whether the gear may have turned on a table before a beam that looks along its radius.
    stitched : bool
        Whether the scan may have been put together from views.
    tip_shift : float
        How far the tips lie from the drawn ones, along the radius, mm; not above 0.
    fillet_edges : (k + 1,) float
        Radii, mm, that divide a fillet into the columns of the cells; empty where there are none.
    fillets_told : bool
        Whether the fillets are the design's, or near enough that a level for each column of cells tells how they stand.
    worn : frozenset of Side
        Sides worn throughout, whose flanks are left out: what they were made like only the other side's tell, and no fillet.
    faces : tuple of ActiveFace
        Sides worn where their mate ran, whose flanks beside it are as made and are not left out.
    absent : frozenset of int
        Teeth that are missing or were not seen: what each tooth has of its own is not known of these.
    bent : tuple of Bent
        Teeth that an overload has bent.
    views_apart : float
        How far views that may have been put together in the scan, and do not quite lie on each other, lie from their mean, mm; 0 where none do.
    smoothed : bool
        Whether neighbouring points share their errors, as those of a scan that was smoothed do.
    pitch : float or None
        Without a mate: length of roll of the pitch point, mm, as what a side has lost shows it; None: at the reference circle.
    """

    gear: Gear
    surfaces: frozenset[int]
    scan_axes: Floats
    planar: bool = False
    mate: tuple[float, float] | None = None
    row_height: float = 0.0
    scale_limit: float = SCALE_LIMIT
    turntable: bool = True
    stitched: bool = True
    fillet_edges: tuple[float, ...] = ()
    tip_shift: float = 0.0
    fillets_told: bool = True
    worn: frozenset[Side] = frozenset()
    faces: tuple[ActiveFace, ...] = ()
    absent: frozenset[int] = frozenset()
    bent: tuple[Bent, ...] = ()
    views_apart: float = 0.0
    smoothed: bool = False
    pitch: float | None = None

    @property
    def worn_sides(self) -> frozenset[Side]:
        """Sides worn throughout, with and without flanks beside where the mate ran."""
        return self.worn | self.ran

    @property
    def ran(self) -> frozenset[Side]:
        """Sides that show where their mate ran."""
        return frozenset(face.side for face in self.faces)

    @property
    def open_sides(self) -> frozenset[Side]:
        """Those of which flanks do not stand as made at both ends of the face: how they were made in between no flank of theirs tells."""
        return self.worn | {face.side for face in self.faces if not face.at_both_ends(self.gear)}

    @property
    def pitch_roll(self) -> float:
        """Length of roll of the pitch point, mm: at the reference circle where there is no mate and no loss shows another."""
        if self.mate is None:
            return self.gear.reference_roll if self.pitch is None else self.pitch
        ratio, line = self.mate
        return line / (1.0 + ratio)

    def with_pitch(self, roll: float | None) -> Context:
        """With the pitch point at a roll, mm, of a gear without a mate."""
        return replace(self, pitch=roll)

    def sliding(self, roll: Floats) -> Floats:
        """Specific sliding K1 = 1 − L2 / (u L1) at rolls L (mm).

        As L1 + L2 is constant and both are u-fold at the pitch point, K1 = (1 + 1 / u) (1 − L_pitch / L1): without a mate it is known but
        for a factor, taken as 1, the pitch point being at the reference circle, or where the loss of a side shows it.
        """
        roll = np.maximum(roll, LEAST_ROLL * self.gear.transverse_module)
        if self.mate is None:
            return np.asarray(1.0 - self.pitch_roll / roll)
        ratio, line = self.mate
        return np.asarray(1.0 - (line - roll) / (ratio * roll))


@runtime_checkable
class Effect(Protocol):
    """What the search asks of an effect."""

    name: ClassVar[str]
    kind: ClassVar[Kind]
    source: ClassVar[str]
    tells_apart: ClassVar[str]
    """One sentence: which further measurement would tell the effect from what looks like it."""
    parameters: ClassVar[tuple[Parameter, ...]]
    """The reported parameters, as in the contract."""
    phrase: ClassVar[str]
    """What the effect is in a sentence, as an engineer would say it, with {parameter} where a number goes."""
    phrase_below: ClassVar[str]
    """The same where the first parameter is below 0, whose magnitude is then said; "" where the words do not depend on the sign."""
    phrase_of_sides: ClassVar[str]
    """The same where left and right flanks have an amplitude of their own, for which all parameters but the first stand; "" where they never have, or
    always. The first parameter is told either way."""
    group: ClassVar[str]
    """Identifiability group on flanks alone (reference: G1 … G7), "" where it has none."""
    tooth_specific: ClassVar[bool]
    """True where a left-out tooth cannot be predicted; it is then judged on left-out blocks along z."""
    usual: ClassVar[bool]
    """True for what is put on on purpose: it is named first among effects that cannot be told apart. Of the others the maker's is: what may
    be the part's own is left in the part."""
    searched: ClassVar[bool]
    """False where only a fit that asks for the effect by name may use it."""
    averaged: ClassVar[str]
    """"z" or "roll" where the deviation may wave or bend within a few cells that way: its basis is then averaged over them."""
    like_coast_wear: ClassVar[bool]
    """True where light wear of the other side of a gear that is worn on one may look like it, and few gears are cut so."""
    by_worn: ClassVar[bool]
    """True where its basis is another with other sides worn throughout (`Context.worn`); whether it applies and its shapes depend on that in none."""

    def applies(self, context: Context) -> bool:
        """Whether this scan could show it at all."""
        ...

    def shapes(self, context: Context) -> list[Shape]:
        """Grid of shape values to try; ``[()]`` for a linear effect."""
        ...

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        """For each continuous shape value in turn, the range in which to refine it."""
        ...

    def other_forms(self, shape: Shape, context: Context) -> list[Shape]:
        """Shapes of the grid that are of another form than this one: between two of the grid another form may look better than the right one does."""
        ...

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        """(n, p) deviation in mm per unit of each amplitude."""
        ...

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        """(n, 3) by how much true points of the part are carried off, mm; None where only the normal part is known (`basis`)."""
        ...

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        """Whether sign and size are physically possible."""
        ...

    def like_even_wear(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        """Whether an even loss, of some teeth or of a part of the face, may look like it."""
        ...

    def tolerance(self, context: Context) -> float | None:
        """Largest amplitude that the drawing allows, inner units; None where it has no say."""
        ...

    def as_made(self, context: Context) -> bool:
        """Whether what it shows may as well be how the part was made, within what its drawing says: it is taken out then, and not named."""
        ...

    def magnitudes(self, amplitudes: Floats) -> Floats:
        """Of each amplitude, of which a share may be an error of the effect's form; inner units."""
        ...

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        """Amplitudes and shape as the contract's parameters.

        `covariance` is of the amplitudes, (p, p), or of the amplitudes and the continuous shape values, (p + q, p + q); with the
        former the standard deviation of a shape value is nan.
        """
        ...


@dataclass(frozen=True)
class CatalogueEffect:
    """What most effects share: no shape, and parameters that are the amplitudes and then the shape values, in the inner units.

    Subclasses set the class variables, write `basis`, and replace what is different.
    """

    phrase_below: ClassVar[str] = ""
    phrase_of_sides: ClassVar[str] = ""
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    usual: ClassVar[bool] = False
    searched: ClassVar[bool] = True
    averaged: ClassVar[str] = ""
    like_coast_wear: ClassVar[bool] = False
    by_worn: ClassVar[bool] = False
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5
    """Bounds of every amplitude, inner units; 0.5 mm is beyond any deviation that leaves a gear a gear."""

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [()]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return []

    def other_forms(self, shape: Shape, context: Context) -> list[Shape]:
        return []

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        return None

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(np.all((amplitudes >= self.lower) & (amplitudes <= self.upper)))

    def like_even_wear(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return False

    def tolerance(self, context: Context) -> float | None:
        return None

    def as_made(self, context: Context) -> bool:
        return False

    def magnitudes(self, amplitudes: Floats) -> Floats:
        return amplitudes

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        values = [*amplitudes.tolist(), *shape]
        spread = deviations(covariance, len(values))
        return {one.name: one.estimate(value, std) for one, value, std in zip(self.parameters, values, spread, strict=False)}


@dataclass(frozen=True)
class ReliefEffect(CatalogueEffect):
    """Metal taken off towards an edge: one amplitude, its amount; the first shape value says where it begins, and one after `straight` of them is the
    exponent of its form. The parameters are amount, place and exponent."""

    straight: ClassVar[int] = 1
    """Shape values of a straight relief."""
    lower: ClassVar[float] = 0.0

    def exponent(self, shape: Shape) -> float:
        """1 of a straight relief, 2 of a parabola."""
        return shape[self.straight] if len(shape) > self.straight else 1.0

    def other_forms(self, shape: Shape, context: Context) -> list[Shape]:
        return [one for one in self.shapes(context) if self.exponent(one) != self.exponent(shape)]

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        return super().estimates(amplitudes, covariance, (shape[0], self.exponent(shape)), context)


@dataclass(frozen=True)
class WaveEffect(CatalogueEffect):
    """A wave or a direction: two amplitudes (a cos φ, −a sin φ), so that ``a cos(x + φ)`` is the pair on (cos x, sin x).

    Of the parameters the SIZE is a, the one with a period the angle; the others are the shape values in turn.
    """

    most: ClassVar[float] = 0.5
    """Bound of the size, inner unit."""
    turns: ClassVar[float] = 1.0
    """Reported angle per phase φ: −1 for the direction of a vector (a cos ψ, a sin ψ), −½ for an axis."""

    def largest(self, context: Context) -> float:
        """Bound of the size on this gear, inner unit."""
        return self.most

    def direction(self, phase: float, context: Context) -> float:
        """The angle that is reported, rad, for a phase φ."""
        return self.turns * phase

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < self.largest(context)

    def magnitudes(self, amplitudes: Floats) -> Floats:
        # The same in all directions: where the wave begins is no matter of the part.
        return np.full(2, math.hypot(*amplitudes) / math.sqrt(2.0))

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        shapes = iter(zip(shape, deviations(covariance, 2 + len(shape))[2:], strict=True))
        found = {}
        for one in self.parameters:
            if one.role is Role.SIZE:
                value, std = size, size_std
            elif one.period is not None:
                value, std = self.direction(phase, context), abs(self.turns) * phase_std
            else:
                value, std = next(shapes)
            found[one.name] = one.estimate(value, std)
        return found


def deviations(covariance: Floats, count: int) -> list[float]:
    """Standard deviations from a covariance, nan up to `count`."""
    known = np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()
    return [*known[:count], *[math.nan] * (count - len(known))]


def polar_estimate(amplitudes: Floats, covariance: Floats) -> tuple[float, float, float, float]:
    """Size, its std, phase and its std (rad) of a pair (a cos φ, −a sin φ), so that ``a cos(x + φ) = pair · (cos x, sin x)``."""
    a, b = float(amplitudes[0]), float(amplitudes[1])
    own = covariance[:2, :2]
    size = math.hypot(a, b)
    along = np.array([a, b]) / max(size, 1e-300)
    across = np.array([-along[1], along[0]])
    var_size, var_across = float(along @ own @ along), float(across @ own @ across)
    return size, math.sqrt(max(var_size, 0.0)), math.atan2(-b, a), math.sqrt(max(var_across, 0.0)) / max(size, 1e-300)


def radial(points: SurfacePoints) -> Floats:
    """n · e_r, (n,): deviation per mm of radial displacement."""
    x, y = points.position[:, 0], points.position[:, 1]
    return np.asarray((x * points.normal[:, 0] + y * points.normal[:, 1]) / np.maximum(np.hypot(x, y), 1e-9))


def turning(points: SurfacePoints) -> Floats:
    """(r × n)_z in mm, (n,): deviation per rad of rotation about the axis; s r_b cos β_b on flanks."""
    return np.asarray(points.position[:, 0] * points.normal[:, 1] - points.position[:, 1] * points.normal[:, 0])


def turned(position: Floats, angle: Floats) -> Floats:
    """Displacement of positions (n, 3) that turn about the axis by `angle` rad, (n,)."""
    x, y, c, s = position[:, 0], position[:, 1], np.cos(angle) - 1.0, np.sin(angle)
    return np.column_stack([c * x - s * y, s * x + c * y, np.zeros(len(x))])


def polar_angle(points: SurfacePoints) -> Floats:
    """θ of the foot points, rad."""
    return np.asarray(np.arctan2(points.position[:, 1], points.position[:, 0]))


def length_bracket(length: float) -> list[tuple[float, float]]:
    """Where a length, mm, of the shapes tried is refined: from 0.6 to 1.6 of it."""
    return [(0.6 * length, 1.6 * length)]


LOWEST_START = 0.2
"""Share of the involute, from the form circle on, in which no relief begins: one of the root is the tool's corner there, one of the tip a slope."""


def roll_bracket(roll: float, gear: Gear) -> list[tuple[float, float]]:
    """Where the roll length at which a relief begins is refined: a tenth of the involute either way, and where one begins at all."""
    length = gear.tip_roll - gear.form_roll  # below 0 on a ring
    step = 0.1 * abs(length)
    low, high = sorted((gear.form_roll + LOWEST_START * length, gear.tip_roll - 0.05 * length))
    return [(max(roll - step, low), min(roll + step, high))]


def of_transverse(values: Floats, gear: Gear) -> Floats:
    """Deviations along the normal in space of what is stated along the transverse base tangent, as ISO 1328 states profile and helix."""
    return np.asarray(gear.base_helix_cosine * values, dtype=np.float64)


def from_form_on(roll: Floats, gear: Gear) -> Floats:
    """Roll lengths (mm) not before the form circle: what lies towards the root, and what is nan, is taken there."""
    orientation, form = gear.orientation, gear.form_roll
    known = np.where(np.isfinite(roll), roll, form)
    return np.asarray(orientation * np.maximum(orientation * known, orientation * form))


def on_flank(points: SurfacePoints) -> Bools:
    """Mask of flank points."""
    return np.asarray(points.surface == FLANK)


def on_sides(points: SurfacePoints, values: Floats, side: float) -> Floats:
    """Values on the flanks of one side as a column, (n, 1); of both sides, for side 0, as a column each, left first."""
    sides = [side] if side else [1.0, -1.0]
    return np.column_stack([np.where(on_flank(points) & (points.side == one), values, 0.0) for one in sides])


def on_side(points: SurfacePoints) -> Bools:
    """Mask of flank and fillet points."""
    return np.asarray((points.surface == FLANK) | (points.surface == FILLET))


def side_cut(points: SurfacePoints, gear: Gear, fillets: float) -> Floats:
    """Deviation per mm of flank deviation where the side turns about the axis, + on left flanks, (n,).

    ±cos β_b on flanks, so that the flank deviation is along the transverse base tangent as ISO 1328 has it; on fillets what the same turn
    does there times `fillets`: 1 where the tool that cut the flank cut the fillet too, 0 where the flank alone was finished.
    """
    turn = turning(points) / gear.base_radius
    return np.where(on_flank(points), turn, np.where(on_side(points), fillets * turn, 0.0))


def profile_coordinate(points: SurfacePoints, gear: Gear) -> Floats:
    """u: −1 at the form circle, +1 at the tip, linear in L; 0 off the flanks."""
    middle, half = 0.5 * (gear.tip_roll + gear.form_roll), 0.5 * (gear.tip_roll - gear.form_roll)
    return np.where(on_flank(points), (np.nan_to_num(points.roll) - middle) / half, 0.0)


def helix_place(points: SurfacePoints, gear: Gear) -> Floats:
    """ζ along a flank's own helix: that of `face_coordinate`; on each half of a double helical gear from its own middle, in its own width."""
    return helix_coordinate(gear, points.position[:, 2])


def face_coordinate(points: SurfacePoints, gear: Gear) -> Floats:
    """ζ = z / b − ½."""
    return np.asarray(points.position[:, 2] / gear.face_width - 0.5)
