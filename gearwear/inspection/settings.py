"""What an inspector may choose."""

from __future__ import annotations

from dataclasses import dataclass

from gearwear.arrays import Floats
from gearwear.inspection.k_band import KBands
from gearwear.inspection.tolerances import Edition

DATUM_WORDS = {
    "bore": "bore", "bands": "stated diameter bands", "ends": "end faces, through the middle of the teeth",
}  # fmt: skip
"""What an axis other than the teeth's rests on."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What an inspector may choose.

    Parameters
    ----------
    edition : Edition
        Standard for ranges and tolerances.
    required_class : int or None
        Class the drawing asks for; None: find it.
    noise : float or None
        Standard deviation of one scanned point, mm; None: from the scatter in the traces' bins.
    sample_factor : float or None
        Points per independent point (≥ 1), where the scan's errors are correlated: all uncertainties grow by its square root. None:
        found from the scan (`correlation.points_per_independent`).
    control_roll : float or None
        L of the profile control circle, mm; None: the form circle, or where the scan begins on most flanks.
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
        Of the registration (tx, ty, tz in mm; wx, wy, wz in rad); None: the pose is taken as known.
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
    scale_std : float
        Relative standard uncertainty of the scan's scale: instrument and temperature.
    stylus_radius : float or None
        Of a ball by which profiles and helices are closed, mm; None: as the scan shows them.
    axis : str
        What the points and `pose_covariance` are about: "teeth", as registered, or a datum of `DATUM_WORDS`. Only the notes depend on it.
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
    scale_std: float = 0.0
    stylus_radius: float | None = None
    span_teeth: int | None = None
    pin_diameter: float | None = None
    sector: int | None = None
    k_bands: KBands | None = None
    laboratory: bool = False
    axis: str = "teeth"
