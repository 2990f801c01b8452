"""What an inspector may choose."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.given import check_choice, check_whole, check_within, two_numbers
from gearwear.design.quantity import shown
from gearwear.design.scan_spec import AXES
from gearwear.errors import InputError, check_kind
from gearwear.inspection.k_band import KBands
from gearwear.inspection.tolerances import Edition

DATUM_WORDS = {
    "bore": "bore", "bands": "stated diameter bands", "ends": "end faces, through the middle of the teeth",
}  # fmt: skip
"""What an axis other than the teeth's rests on."""
LONGEST = 1e5
"""mm; no length of an inspection is greater: the widest face of a design."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What an inspector may choose. What `gw.inspect` fills in from the measured gear where it is left out, it says below.

    Parameters
    ----------
    edition : Edition
        Standard for ranges and tolerances.
    required_class : int or None
        Class the drawing asks for; None: find it.
    noise : float or None
        Standard deviation of one scanned point, mm; None: from the scatter in the traces' bins. `gw.inspect`: that of the scan.
    sample_factor : float or None
        Points per independent point (≥ 1), where the scan's errors are correlated: all uncertainties grow by its square root. None:
        found from the scan (`correlation.points_per_independent`).
    control_roll : float or None
        L of the profile control circle, mm; None: the form circle, or where the scan begins on most flanks. On a ring L falls from root to tip.
    profile_end : float or None
        L where the profile evaluation ends, mm; None: by the edition.
    slope_length : float or None
        Length that the profile slope is stated over, mm; None: the evaluation range.
    helix_between : (float, float) or None
        Evaluation range of the helix, z to z, mm; None: by the standard.
    profile_cutoff, helix_cutoff : float or None
        Cut-off wavelengths, mm; None: by the standard.
    profile_band : (float, float) or None
        z to z averaged in profile traces, mm; None: the helix evaluation range.
    helix_band : (float, float) or None
        L to L averaged in helix traces, mm; None: the profile evaluation range.
    pitch_roll : float or None
        L of the circle where pitch is measured, mm; None: `pitch.measuring_roll`.
    pitch_band : (float, float) or None
        z to z averaged for pitch, runout and dimensions, mm; None: the helix evaluation range.
    pose_covariance : (6, 6) float or None
        Of the registration (tx, ty, tz in mm; wx, wy, wz in rad); None: the pose is taken as known. `gw.inspect`: that of the
        registration and its datum; zeros say there that the pose is known.
    span_teeth : int or None
        k of the span; None: chosen.
    pin_diameter : float or None
        mm; None: chosen.
    sector : int or None
        Pitches of the sector deviation; None: about z / 8 (`tolerances.sector_teeth`).
    k_bands : KBands or None
        Limits of the drawing's own that profiles and helices must run between.
    laboratory : bool
        Whether to examine what is not graded too: traces along lines, surfaces, waves, rolling with a master. It takes three times as long.
    scale_std : float or None
        Relative standard uncertainty of the scan's scale: instrument and temperature; None: 0. `gw.inspect`: that of the design.
    stylus_radius : float or None
        Of a ball by which profiles and helices are closed, mm; None: as the scan shows them.
    axis : str or None
        What the points and `pose_covariance` are about: "teeth", as registered, or a datum of `DATUM_WORDS`; None: the teeth. Only the notes
        depend on it. `gw.inspect` puts the points about it; None there: the axis that the design's ``[datum]`` states.

    Raises
    ------
    InputError
        If a value alone is impossible. What suits no gear, the inspection refuses.
    """

    edition: Edition = Edition.ISO_2013
    required_class: int | None = None
    noise: float | None = None
    sample_factor: float | None = None
    control_roll: float | None = None
    profile_end: float | None = None
    slope_length: float | None = None
    helix_between: tuple[float, float] | None = None
    profile_cutoff: float | None = None
    helix_cutoff: float | None = None
    profile_band: tuple[float, float] | None = None
    helix_band: tuple[float, float] | None = None
    pitch_roll: float | None = None
    pitch_band: tuple[float, float] | None = None
    pose_covariance: Floats | None = None
    scale_std: float | None = None
    stylus_radius: float | None = None
    span_teeth: int | None = None
    pin_diameter: float | None = None
    sector: int | None = None
    k_bands: KBands | None = None
    laboratory: bool = False
    axis: str | None = None

    def __post_init__(self) -> None:
        check_choice("edition", self.edition, Edition)
        object.__setattr__(self, "edition", Edition(self.edition))  # the same word as a plain string is none
        if self.axis is not None:
            check_choice("axis", self.axis, AXES)
        for name, least in (("required_class", 0), ("span_teeth", 1), ("sector", 1)):
            if getattr(self, name) is not None:
                check_whole(name, getattr(self, name), least)
        _check_number("sample_factor", self.sample_factor, 1.0, math.inf, "a number from 1 up")
        _check_number("scale_std", self.scale_std, 0.0, 1.0, "a number from 0 to 1")
        _check_number("noise", self.noise, 0.0, LONGEST, f"0 to {LONGEST:g} mm")
        for name in ("control_roll", "profile_end", "pitch_roll"):
            _check_number(name, getattr(self, name), 0.0, LONGEST, f"a length of roll from 0 to {LONGEST:g} mm")
        for name in ("slope_length", "profile_cutoff", "helix_cutoff", "stylus_radius", "pin_diameter"):
            _check_number(name, getattr(self, name), math.ulp(0.0), LONGEST, f"a length above 0 and at most {LONGEST:g} mm")
        for name in ("helix_between", "profile_band", "pitch_band", "helix_band"):
            _check_stretch(name, getattr(self, name))
        if self.control_roll is not None and self.control_roll == self.profile_end:
            raise InputError(f"control_roll and profile_end are both {self.profile_end:g} mm: two ends of a range would be right")
        _check_covariance(self.pose_covariance)
        check_kind(self.k_bands, KBands | None, "k_bands", "a KBands, or None,")
        check_kind(self.laboratory, bool | np.bool_, "laboratory", "True or False")


def _check_number(name: str, value: float | None, low: float, high: float, right: str) -> None:
    if value is not None:
        check_within(name, value, low, high, right)


def _check_stretch(name: str, value: tuple[float, float] | None) -> None:
    """Two finite lengths, the smaller one first; of `helix_band` in either order, since on a ring L falls from root to tip."""
    if value is None:
        return
    right = "two lengths in mm, such as (1.5, 12.0),"
    first, last = two_numbers(name, value, right)
    if not (max(abs(first), abs(last)) <= LONGEST and first != last):
        raise InputError(f"{name} = {shown(value)}: {right} would be right")
    if first > last and name != "helix_band":
        raise InputError(f"{name} = {first:g} to {last:g} mm: from the lower z to the higher one would be right")


def _check_covariance(value: Floats | None) -> None:
    """A covariance of six motions; with the scale as a seventh cause inside an inspection (`budget.with_scale`)."""
    if value is None:
        return
    given = np.asarray(value)
    if given.shape not in ((6, 6), (7, 7)) or given.dtype.kind not in "fiu" or not np.isfinite(given).all():
        raise InputError(f"pose_covariance of shape {given.shape}: (6, 6) finite numbers would be right")
    if not (np.diag(given) >= 0.0).all():
        raise InputError("pose_covariance has negative variances on its diagonal: 0 or more would be right")
