"""What a drawing takes off the flanks, or adds to them: relief, crowning, slopes (ISO 21771-1, ISO 1328-1).

All amounts are along the **transverse base tangent**, as drawings and inspection sheets have them, at the radius they are stated for.
A modified flank keeps its radii and is turned by δ₀ / r_b: at the radius of roll length L, in the slice z, it lies at the half angle ::

    ψ(L, z) = ψ_b − inv α + δ₀(L, z) / r_b,    δ₀ = p(L) + h(z)

The fillet is turned with the end of its flank, by δ₀ at the form circle: no step, and what varies along the face is one rotation of the
whole tooth side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gearwear.arrays import Floats
from gearwear.design.bounds import check_between
from gearwear.design.given import check_choice, check_number
from gearwear.design.quantity import as_given, at_least, at_most
from gearwear.design.side import Side
from gearwear.errors import InputError

MOST_AMOUNT = 1.0
"""Greatest amount of a modification, mm: the usual ones are hundredths."""
STEEPEST = 0.2
"""Greatest slope of δ₀ along the profile or the face: beyond it a flank is no modified involute, and normals are not the involute's."""
FORMS = {"linear": 1, "parabolic": 2}
"""Power of the way from a relief's start to its end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankModification:
    """Modifications of the flanks of one side, as drawn.

    Parameters
    ----------
    tip_relief, root_relief : float
        Missing at the flank's end (tip circle or start of the chamfer) and at the form circle, mm; not negative.
    tip_relief_start, root_relief_start : float or None
        Diameter where it begins, mm.
    tip_relief_length, root_relief_length : float or None
        Or how much roll length it takes, mm.
    tip_relief_form, root_relief_form : str
        "linear" or "parabolic" in the roll length.
    profile_crowning, helix_crowning : float
        + bulge in the middle: δ₀ = −c u², −c (2ζ)², nothing added in the middle, mm.
    profile_slope : float
        Rise from the form circle to the flank's end, + more metal at the tip: δ₀ = ½ f u, mm.
    helix_slope : float
        δ₀ = s f ζ, mm: a lean of the tooth, alike on left and right.
    end_relief, end_relief_length : float
        Missing at either end of the face, and over what length it comes, mm.
    end_relief_form : str
        "linear" or "parabolic" in the height.
    """

    tip_relief: float = 0.0
    tip_relief_start: float | None = None
    tip_relief_length: float | None = None
    tip_relief_form: str = "linear"
    root_relief: float = 0.0
    root_relief_start: float | None = None
    root_relief_length: float | None = None
    root_relief_form: str = "linear"
    profile_crowning: float = 0.0
    helix_crowning: float = 0.0
    profile_slope: float = 0.0
    helix_slope: float = 0.0
    end_relief: float = 0.0
    end_relief_length: float = 0.0
    end_relief_form: str = "linear"

    def __bool__(self) -> bool:
        """Whether anything is modified."""
        return any(getattr(self, name) != 0.0 for name in AMOUNTS)

    @property
    def stated(self) -> dict[str, float | str]:
        """What is said of it, by the keys of a design file; the form of a relief only where there is one."""
        values = {name: getattr(self, name) for name in KEYS}
        return {
            name: value
            for name, value in values.items()
            if value not in (0.0, None) and not (name in WORDS and values[name.removesuffix("_form")] == 0.0)
        }

    def check(self, section: str) -> None:
        """Refuse what is impossible by itself.

        Raises
        ------
        InputError
            Names the value and what would be right.
        """
        for name in AMOUNTS:
            least = 0.0 if name.endswith("relief") else -MOST_AMOUNT
            check_between(section, name, getattr(self, name), least, MOST_AMOUNT, "mm")
        for name in WORDS:
            check_choice(f"[{section}] {name}", getattr(self, name), FORMS)
        for name in (*LENGTHS, "tip_relief_start", "root_relief_start"):
            if getattr(self, name) is not None or name == "end_relief_length":
                check_number(f"[{section}] {name}", getattr(self, name), "mm")
        for end in ("tip", "root"):
            relief, start, length = (getattr(self, f"{end}_relief{part}") for part in ("", "_start", "_length"))
            if start is not None and length is not None:
                raise InputError(f"[{section}] {end}_relief_start and {end}_relief_length are both given: one of them")
            if relief > 0.0 and start is None and length is None:
                raise InputError(
                    f"[{section}] {end}_relief = {relief:g} mm without its extent: {end}_relief_start (diameter, mm) or "
                    f"{end}_relief_length (mm of roll) is needed"
                )
            if relief == 0.0 and (start is not None or length is not None):
                raise InputError(
                    f"[{section}] {end}_relief_{'start' if start is not None else 'length'} without {end}_relief: its amount is needed"
                )
        for name in LENGTHS:
            length = getattr(self, name)
            if length and not length >= LEAST_LENGTH:
                raise InputError(f"[{section}] {name} = {length:g} mm: must be at least {LEAST_LENGTH:g}")
        if (self.end_relief > 0.0) != (self.end_relief_length > 0.0):
            raise InputError(f"[{section}] end_relief and end_relief_length: both are needed, above 0 mm, or neither")


AMOUNTS = (
    "tip_relief", "root_relief", "profile_crowning", "helix_crowning", "profile_slope", "helix_slope", "end_relief",
)  # fmt: skip
"""Keys that are amounts, mm along the transverse base tangent."""
LENGTHS = ("tip_relief_length", "root_relief_length", "end_relief_length")
LEAST_LENGTH = 1e-3
"""mm; what is shorter is an edge."""
KEYS = tuple(field.name for field in fields(FlankModification))
"""Keys of a modification in a design file."""
WORDS = tuple(key for key in KEYS if key.endswith("_form"))
"""Those that are words, not numbers."""
AS_GENERATED = FlankModification()


@dataclass(frozen=True, slots=True)
class DrawnFlank:
    """The modification of one side of a given gear, in closed form.

    Parameters
    ----------
    modification : FlankModification
    side : Side
    form_roll, tip_roll : float
        Roll length at the form circle and at the flank's end, mm; on a ring the first is the greater.
    base_radius, face_width : float
        mm.
    own : (float, float) or None
        The first two of the gear as it is, where that is not as drawn; None: the same.
    """

    modification: FlankModification
    side: Side
    form_roll: float
    tip_roll: float
    base_radius: float
    face_width: float
    own: tuple[float, float] | None = None

    @property
    def _ends(self) -> tuple[float, float]:
        """Least and greatest roll length of the flank, mm."""
        return min(self.form_roll, self.tip_roll), max(self.form_roll, self.tip_roll)

    @property
    def _way(self) -> float:
        """Sign of the roll length's change from the form circle to the tip: −1 on a ring."""
        return math.copysign(1.0, self.tip_roll - self.form_roll)

    @property
    def tip_relief_start(self) -> float:
        """Roll length where the tip relief begins, mm."""
        drawn = self.modification
        if drawn.tip_relief_start is not None:
            return _roll_at(drawn.tip_relief_start, self.base_radius)
        return self.tip_roll - self._way * (drawn.tip_relief_length or 0.0)

    @property
    def root_relief_start(self) -> float:
        """Roll length where the root relief begins (and ends at the form circle), mm."""
        drawn = self.modification
        if drawn.root_relief_start is not None:
            return _roll_at(drawn.root_relief_start, self.base_radius)
        return self.form_roll + self._way * (drawn.root_relief_length or 0.0)

    def along_profile(self, roll: ArrayLike) -> Floats:
        """p(L): the part that varies along the profile, mm; beyond the form circle that of the form circle."""
        drawn = self.modification
        at = np.clip(np.asarray(roll, dtype=np.float64), *self._ends)
        u = 2.0 * (at - self.form_roll) / (self.tip_roll - self.form_roll) - 1.0
        offset = 0.5 * drawn.profile_slope * u - drawn.profile_crowning * u * u
        if drawn.tip_relief > 0.0:
            way = np.maximum((at - self.tip_relief_start) / (self.tip_roll - self.tip_relief_start), 0.0)
            offset -= drawn.tip_relief * way ** FORMS[drawn.tip_relief_form]
        if drawn.root_relief > 0.0:
            way = np.maximum((self.root_relief_start - at) / (self.root_relief_start - self.form_roll), 0.0)
            offset -= drawn.root_relief * way ** FORMS[drawn.root_relief_form]
        return np.asarray(offset, dtype=np.float64)

    def along_face(self, z: ArrayLike) -> Floats:
        """h(z): the part that varies along the face, mm; beyond the ends that of the ends."""
        drawn = self.modification
        at = np.clip(np.asarray(z, dtype=np.float64), 0.0, self.face_width)
        zeta = at / self.face_width - 0.5
        offset = self.side * drawn.helix_slope * zeta - drawn.helix_crowning * (2.0 * zeta) ** 2
        if drawn.end_relief > 0.0:
            inside = np.minimum(at, self.face_width - at)
            offset -= drawn.end_relief * np.maximum(1.0 - inside / drawn.end_relief_length, 0.0) ** FORMS[drawn.end_relief_form]
        return np.asarray(offset, dtype=np.float64)

    def offset(self, roll: ArrayLike, z: ArrayLike) -> Floats:
        """δ₀ = p(L) + h(z), mm along the transverse base tangent, + more metal; the arguments are broadcast."""
        return np.asarray(self.along_profile(roll) + self.along_face(z), dtype=np.float64)

    @property
    def profile_knees(self) -> tuple[float, ...]:
        """Roll lengths (mm, from the form circle to the tip) within the flank where p(L) has a knee."""
        return self._knees(*sorted(self.own or self._ends))

    def _knees(self, least: float, most: float) -> tuple[float, ...]:
        """The same between two roll lengths, mm."""
        drawn, knees = self.modification, list(self._ends)  # beyond them it goes on as it is there
        if drawn.root_relief > 0.0:
            knees.append(self.root_relief_start)
        if drawn.tip_relief > 0.0:
            knees.append(self.tip_relief_start)
        return tuple(sorted({knee for knee in knees if least < knee < most}, reverse=self._way < 0.0))

    @property
    def face_knees(self) -> tuple[float, ...]:
        """Heights (mm, rising) within the face where h(z) has a knee."""
        length, b = self.modification.end_relief_length, self.face_width
        return tuple(sorted({z for z in (length, b - length) if 0.0 < z < b})) if self.modification.end_relief > 0.0 else ()

    def check(self, section: str) -> None:
        """Refuse what does not fit on this gear's flank.

        Raises
        ------
        InputError
            Names the value and the limits.
        """
        drawn, (first, last) = self.modification, self._ends
        for end, start in (("tip", self.tip_relief_start), ("root", self.root_relief_start)):
            if getattr(drawn, f"{end}_relief") > 0.0 and not (
                first <= start <= last and abs(start - (self.tip_roll if end == "tip" else self.form_roll)) > 1e-6
            ):
                low, high = (2.0 * math.hypot(self.base_radius, roll) for roll in (first, last))
                key, value = (
                    (f"{end}_relief_start", getattr(drawn, f"{end}_relief_start"))
                    if getattr(drawn, f"{end}_relief_start") is not None
                    else (f"{end}_relief_length", getattr(drawn, f"{end}_relief_length"))
                )
                raise InputError(
                    f"[{section}] {key} = {as_given(value)} mm: the relief must begin on the flank, between the diameters {at_least(low)} and "
                    f"{at_most(high)} mm, at most {at_most(last - first)} mm of roll from its end"
                )
        if 2.0 * drawn.end_relief_length > self.face_width:
            raise InputError(
                f"[{section}] end_relief_length = {as_given(drawn.end_relief_length)} mm: must be at most half the face width {as_given(self.face_width)} mm"
            )
        steepest = max(
            _steepest(self.along_profile, self.form_roll, self.tip_roll, self._knees(*self._ends)),
            _steepest(self.along_face, 0.0, self.face_width, self.face_knees),
        )
        if steepest > STEEPEST:
            raise InputError(
                f"[{section}] the modifications of the {self.side} flank fall by {at_least(steepest, 3)} mm a mm: at most {STEEPEST:g} is a modified "
                "involute; a smaller amount or a longer relief would be right"
            )


def merged(shared: dict[str, Any], of_side: dict[str, Any]) -> FlankModification:
    """What holds for one side: the gear's keys, with those of the side in their place."""
    exclusive = {
        f"{end}_relief_{a}": f"{end}_relief_{b}" for end in ("tip", "root") for a, b in (("start", "length"), ("length", "start"))
    }
    kept = {key: value for key, value in shared.items() if exclusive.get(key) not in of_side}
    return replace(AS_GENERATED, **{**kept, **of_side})


def _roll_at(diameter: float, base_radius: float) -> float:
    square = (0.5 * diameter - base_radius) * (0.5 * diameter + base_radius)
    return math.sqrt(square) if square > 0.0 else -1.0


def _steepest(offset: Any, low: float, high: float, knees: tuple[float, ...]) -> float:
    """Greatest slope between knees: each piece is a parabola at most, steepest at an end, where its chord over a thousandth shows it."""
    ends = [low, *knees, high]
    slopes = []
    for start, end in pairwise(ends):
        step = 1e-3 * (end - start)
        for a in (start, end - step):
            slopes.append(abs(float(offset(a + step) - offset(a)) / step))
    return max(slopes)
