"""What the user says about a scan: the scanner, how the gear lay in it, and what is to be left out; plain, frozen, checked one value at a time.

Millimetres and radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gearwear.design.bounds import check_between
from gearwear.design.quantity import shown
from gearwear.errors import InputError


@dataclass(frozen=True, slots=True)
class ScannerSpec:
    """What is stated of the scanner.

    Parameters
    ----------
    axis_offset : float or None
        Distance of the table's axis from the gear's, mm.
    noise : float or None
        Scatter of a single point, one standard deviation, mm.
    scale_limit : float or None
        Largest relative error of its scale: what its calibration leaves.
    scale_std : float
        Relative standard uncertainty of its scale, for the uncertainties of an inspection.
    turntable : bool
        Whether the gear may have turned on a table before a beam.
    stitched : bool
        Whether a file may have been put together from views.
    """

    axis_offset: float | None = None
    noise: float | None = None
    scale_limit: float | None = None
    scale_std: float = 0.0
    turntable: bool = True
    stitched: bool = True

    def __post_init__(self) -> None:
        if self.axis_offset is not None:
            check_between("scanner", "axis_offset_mm", self.axis_offset, -1e4, 1e4, "mm")
        if self.noise is not None:
            check_between("scanner", "noise_um", 1e3 * self.noise, 1e-3, 1e4, "µm")
        if self.scale_limit is not None:
            check_between("scanner", "scale_ppm_max", 1e6 * self.scale_limit, 0.0, 1e5, "ppm")
        check_between("scanner", "scale_std_ppm", 1e6 * self.scale_std, 0.0, 1e5, "ppm")


REFERENCE_TEMPERATURE = 20.0
"""°C that lengths are referred to (ISO 1)."""

EXPANSION_PPM = {
    "steel": 11.5, "stainless_steel": 16.0, "cast_iron": 10.5, "aluminium": 23.0, "brass": 19.0, "bronze": 17.5, "titanium": 8.6,
    "pom": 110.0, "pa66": 80.0,
}  # fmt: skip
"""Thermal expansion by material, ppm/K: usual values of handbooks, good to a tenth for metals; plastics vary more."""

IGNORABLE = ("flank", "fillet", "root", "tip", "end_low", "end_high", "bore")
"""Surfaces that may be left out."""


AXES = ("teeth", "bore", "bands", "ends")
"""What pitch and runout may be inspected about."""


@dataclass(frozen=True, slots=True)
class DatumBand:
    """A part of a cylinder about the gear's axis: the seat of a bearing, a hub.

    Parameters
    ----------
    diameter : float
        mm.
    low, high : float
        Heights in the design's coordinates between which it lies, mm; z = 0 is the gear's lower end.
    """

    diameter: float
    low: float
    high: float

    def __post_init__(self) -> None:
        check_between("datum", "band diameter_mm", self.diameter, 0.01, 1e5, "mm")
        if not self.low < self.high:
            raise InputError(f"[datum] band z_mm = [{self.low:g}, {self.high:g}]: from the lower z to the higher one")


ARTEFACTS = ("sphere", "cylinder", "ring")
"""Kinds of artefact; a ring is measured inside."""


@dataclass(frozen=True, slots=True)
class Artefact:
    """A body of known size that was scanned with the gear.

    Parameters
    ----------
    kind : str
        One of `ARTEFACTS`.
    diameter : float
        As calibrated, mm.
    centre : (float, float, float)
        About where it lies in the scan's own coordinates, mm; of a cylinder or ring the middle of its axis.
    std : float
        Of the calibrated diameter, mm.
    """

    kind: str
    diameter: float
    centre: tuple[float, float, float]
    std: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in ARTEFACTS:
            raise InputError(f"[datum] artefact kind = {shown(self.kind)}: one of {', '.join(ARTEFACTS)} would be right")
        check_between("datum", "artefact diameter_mm", self.diameter, 0.1, 1e4, "mm")
        check_between("datum", "artefact std_um", 1e3 * self.std, 0.0, 1e3, "µm")
        for value in self.centre:
            check_between("datum", "artefact centre_mm", value, -1e6, 1e6, "mm")


@dataclass(frozen=True, slots=True)
class DatumMark:
    """A keyway, punch mark, notch or hole that tooth 1 is told by: the one thing that a ring about the axis holds.

    Parameters
    ----------
    width : float
        About how wide it is across, along the circumference, mm.
    radius : (float, float) or None
        From where to where it lies off the axis, mm; None: beyond the bore, into the metal, as a keyway does.
    z : (float, float) or None
        Heights in the design's coordinates between which it lies, mm; None: the face without a tenth at either end.
    angle : float
        Direction of its middle from that of tooth 1 at mid-face, counter-clockwise seen from +z, rad.
    """

    width: float
    radius: tuple[float, float] | None = None
    z: tuple[float, float] | None = None
    angle: float = 0.0

    def __post_init__(self) -> None:
        check_between("datum", "mark width_mm", self.width, 1e-3, 1e4, "mm")
        check_between("datum", "mark angle_deg", math.degrees(self.angle), -360.0, 360.0, "degrees")
        for name, ends in (("radius", self.radius), ("z", self.z)):
            if ends is not None and not ends[0] < ends[1]:
                raise InputError(f"[datum] mark {name}_mm = [{ends[0]:g}, {ends[1]:g}]: from the lower end to the higher one")
        if self.radius is not None:
            check_between("datum", "mark radius_mm", self.radius[0], 0.0, 1e5, "mm")


@dataclass(frozen=True, slots=True)
class DatumSpec:
    """What is stated of how the gear lies in its scans, of what is to be left out of them, and of its temperature.

    Parameters
    ----------
    tooth_1, before_tooth_1 : float or None
        Direction of tooth 1 in the scan and in that before wear, from the scan's own +x towards its +y, rad; None: not stated.
    ignore : tuple of str
        Surfaces whose points are left out (`IGNORABLE`).
    ignore_teeth : tuple of int
        0-based teeth that are left out.
    ignore_z : tuple of (float, float)
        Bands from z to z (mm) that are left out.
    axis : str
        What pitch and runout are inspected about: one of `AXES`.
    bands : tuple of DatumBand
        Cylinders about the axis that "bands" rests on.
    temperature : float or None
        Of the part while it was scanned, °C; None: 20.
    temperature_std : float
        Its standard uncertainty, K.
    expansion : float
        Thermal expansion, 1/K.
    artefacts : tuple of Artefact
        Of known size, scanned with the gear.
    calibration : tuple of str
        What they said; empty before they were looked at.
    mark : DatumMark or None
        What tooth 1 is told by, in place of `tooth_1`; in the scan before wear too, where `before_tooth_1` says nothing.
    """

    tooth_1: float | None = None
    before_tooth_1: float | None = None
    ignore: tuple[str, ...] = ()
    ignore_teeth: tuple[int, ...] = ()
    ignore_z: tuple[tuple[float, float], ...] = ()
    axis: str = "teeth"
    bands: tuple[DatumBand, ...] = ()
    temperature: float | None = None
    temperature_std: float = 0.0
    expansion: float = 1e-6 * EXPANSION_PPM["steel"]
    artefacts: tuple[Artefact, ...] = ()
    calibration: tuple[str, ...] = ()
    mark: DatumMark | None = None

    def __post_init__(self) -> None:
        for name in ("tooth_1", "before_tooth_1"):
            angle = getattr(self, name)
            if angle is not None:
                check_between("datum", f"{name}_deg", math.degrees(angle), -360.0, 360.0, "degrees")
        if self.mark is not None and self.tooth_1 is not None:
            raise InputError("[datum] tooth_1_deg and mark are both given: one of them")
        for surface in self.ignore:
            if surface not in IGNORABLE:
                raise InputError(f"[datum] ignore = {shown(surface)}: one of {', '.join(IGNORABLE)} would be right")
        if "flank" in self.ignore:
            raise InputError("[datum] ignore = 'flank': nothing would be left to measure; ignore_teeth leaves single teeth out")
        for low, high in self.ignore_z:
            if not low < high:
                raise InputError(f"[datum] ignore_z_mm = [{low:g}, {high:g}]: from the lower z to the higher one")
        if self.axis not in AXES:
            raise InputError(f"[datum] axis = {shown(self.axis)}: one of {', '.join(AXES)} would be right")
        if self.temperature is not None:
            check_between("datum", "temperature_C", self.temperature, -60.0, 200.0, "°C")
        check_between("datum", "temperature_std_K", self.temperature_std, 0.0, 50.0, "K")
        check_between("datum", "expansion_ppm_K", 1e6 * self.expansion, 0.0, 500.0, "ppm/K")

    @property
    def before(self) -> DatumSpec:
        """Of the scan before wear; no artefact stands in it."""
        mark = self.mark if self.before_tooth_1 is None else None
        return replace(self, tooth_1=self.before_tooth_1, before_tooth_1=None, mark=mark, artefacts=(), calibration=())

    @property
    def leaves_out(self) -> bool:
        """Anything at all."""
        return bool(self.ignore or self.ignore_teeth or self.ignore_z)

    @property
    def scale(self) -> float:
        """Length at 20 °C over length as scanned."""
        if self.temperature is None:
            return 1.0
        return 1.0 / (1.0 + self.expansion * (self.temperature - REFERENCE_TEMPERATURE))

    @property
    def words(self) -> tuple[str, ...]:
        """What was done for it, each a sentence."""
        said = list(self.calibration)
        if self.leaves_out:
            teeth = f"tooth {', '.join(str(tooth + 1) for tooth in self.ignore_teeth)}" if self.ignore_teeth else ""
            bands = ", ".join(f"z {low:g} … {high:g} mm" for low, high in self.ignore_z)
            said.append(f"left out as the design asks: {'; '.join(filter(None, [', '.join(self.ignore), teeth, bands]))}")
        if self.temperature is not None:
            said.append(
                f"lengths are referred from {self.temperature:g} °C to {REFERENCE_TEMPERATURE:g} °C with {1e6 * self.expansion:g} ppm/K: "
                f"{1e6 * (self.scale - 1.0):+z.0f} ppm".replace("-", "−")
            )
        return tuple(said)
