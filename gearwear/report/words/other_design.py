"""Why a scan is rather of another gear than the design's, and which value of the drawing would be right."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gearwear.design.drawn_gauge import shift_of
from gearwear.design.gear import Gear
from gearwear.design.quantity import SPACE, listed, number, significant
from gearwear.diagnose.found import FoundEffect
from gearwear.errors import InputError
from gearwear.inspection.tolerances import Size, tolerances
from gearwear.placing.refusal import SeenRadii

RIM_OFF_MODULES, RIM_OFF_MM = {"tip": 0.08, "root": 0.12}, 0.05
"""Distance of tips and roots from the design's, in modules and mm together, at which the design's tip or root diameter is not the gear's."""
BASE_OFF = 0.01
"""Relative difference of the flanks' base circle from the design's, beyond what makers and scanners leave: neighbours among modules and pressure
angles in use differ by 1.6 % and more."""
MODULE_OFF, MODULE_ALIKE = 0.003, 0.4
"""Relative difference of base and tip circle from the design's, beside a scale that was found, from which on they are of another module; and by what share of the larger
both may differ, for wear leans flanks as well: tips alone, or flanks alone, are off by as much on gears as they are made."""
LEAST_RISE = 0.02
"""Rise over the flank, mm, that goes with it, at least: on small gears a base circle that is off by so little is a profile slope as ground."""
FAR_OFF, FAR_OFF_MODULES = 0.1, 0.02
"""RMS outside the wear, mm and modules, all that was found taken out, above both of which a scan is more likely of another gear."""
SHIFT_ALIKE = 0.05
"""Modules by which tips and roots may lie off each other's distance from the drawn ones for another profile shift."""
THICKER = 0.07
"""Modules by which teeth are thicker than drawn, and twice their tolerance, for another profile shift: wear takes off, and cutting for backlash does."""
COARSEST = 11
"""Class of ISO 1328-1:2013 beyond whose slopes flanks that are alike on both sides are rather of another angle than cut so badly."""


def wrong_design(gear: Gear, seen: SeenRadii, rms_left: float = 0.0, scale: float = 0.0, drawn: Gear | None = None) -> str | None:
    """Why a scan is more likely of another gear than the design's; None where nothing says so.

    Parameters
    ----------
    gear : Gear
        As designed.
    seen : SeenRadii
        What the scan shows of its size.
    rms_left : float
        RMS outside the wear with all that was found taken out, mm.
    scale : float
        By what ratio the scan was found to be too large.
    drawn : Gear or None
        As the drawing states it, where `gear` has the root that was seen.
    """
    other, flank = abs(seen.base / gear.base_radius - 1.0), abs(gear.tip_roll - gear.form_roll)
    if other > BASE_OFF and other * flank > LEAST_RISE:
        text = (
            f"the flanks are those of another gear or out of scale: their base circle is some {_diameter(seen.base)} in diameter"
        )
        return f"{text} and the design's {_diameter(gear.base_radius)}; check module and pressure angle"
    module = gear.spec.normal_module
    base, tip = _off(gear, seen, scale)
    far = min(abs(base), abs(tip)) > MODULE_OFF and abs(base) * flank > LEAST_RISE and abs(tip) * gear.tip_radius > RIM_OFF_MM
    if far and abs(base - tip) < MODULE_ALIKE * max(abs(base), abs(tip)):
        both = 0.5 * (base + tip)
        way = "larger" if both > 0.0 else "smaller"
        return (
            f"flanks and tips are both {100.0 * abs(both):.1f}{SPACE}% {way} than drawn, as those of module {number(module * (1.0 + both), 2)} would be; "
            "check the module"
        )
    stated = gear if drawn is None else drawn
    out = [seen.tip - stated.tip_radius, seen.root - stated.root_radius]
    if min(map(abs, out)) > RIM_OFF_MODULES["root"] * module + RIM_OFF_MM and abs(out[0] - out[1]) < SHIFT_ALIKE * module:
        shift = gear.spec.profile_shift + gear.orientation * 0.5 * sum(out) / module
        way = "further out" if sum(out) > 0.0 else "further in"
        return (
            f"tips and roots both lie {number(0.5 * abs(sum(out)), 2)}{SPACE}mm {way} than drawn, as those of a profile shift of {number(shift, 2)} would; "
            f"check profile_shift ({number(gear.spec.profile_shift, 2)} in the design)"
        )
    if seen.thicker > max(THICKER * module, 2.0 * (gear.tolerance.thickness or 0.0)):
        shift = shift_of(gear.spec, seen.thicker)
        return (
            f"the teeth are {number(seen.thicker, 2)}{SPACE}mm thicker than drawn, as those of a profile shift of {number(shift, 2)} would be; check profile_shift "
            f"({number(gear.spec.profile_shift, 2)} in the design) and thinning"
        )
    off = []
    for rim, radius, nominal in (("tip", seen.tip, gear.tip_radius), ("root", seen.root, gear.root_radius)):
        if abs(radius - nominal) > RIM_OFF_MODULES[rim] * module + RIM_OFF_MM:
            off.append(f"{rim}s lie at a diameter of {_diameter(radius)} and the design's at {_diameter(nominal)}")
    if off:
        return f"the {listed(off)}; check tip and root diameter"
    if rms_left > max(FAR_OFF, FAR_OFF_MODULES * module):
        text = f"outside the wear the scan is {_um(rms_left)}{SPACE}µm off the design (RMS)"
        return f"{text}, as that of another gear would be"
    return None


def other_angles(gear: Gear, seen: SeenRadii, effects: Sequence[FoundEffect], scale: float = 0.0) -> list[str]:
    """Which pressure angle or helix angle the flanks have, where that is further from the drawn one than slopes of any class allow, a clause each.

    Parameters
    ----------
    gear : Gear
        As designed.
    seen : SeenRadii
        What the scan shows of its size.
    effects : sequence of FoundEffect
        What maker and scanner added: a helix slope is told by these.
    scale : float
        By what ratio the scan was found to be too large.

    Notes
    -----
    With tips where they are drawn flanks of another base circle have another pressure angle, ``cos α_t' = r_b' / r`` and ``tan α_n = tan α_t cos β``. A helix slope f
    over the face is ``tan β' = tan β + f / (b cos β_b cos α_t)``, f along the normal in space.
    """
    try:
        most = tolerances(Size.of(gear), COARSEST)
    except InputError:  # larger or smaller than the standard's gears
        return []
    said, flank = [], abs(gear.tip_roll - gear.form_roll)
    base, tip = _off(gear, seen, scale)
    if abs(base) * flank > most.profile_slope and abs(tip) < 0.5 * abs(base) and seen.base < gear.reference_radius:
        transverse = math.acos(seen.base / gear.reference_radius)
        angle = math.atan(math.tan(transverse) * math.cos(gear.helix_angle))
        said.append(
            f"the flanks of both sides have a pressure angle of {_degrees(angle)} and not of {_degrees(gear.normal_pressure_angle)}: {_um(abs(base) * flank)}{SPACE}µm "
            "over the flank is more than the slope of any class; check pressure_angle"
        )
    slope = sum(float(effect.amplitudes[0]) for effect in effects if effect.name == "helix_slope")
    if abs(slope) / gear.base_helix_cosine > most.helix_slope:
        width = 0.5 * (gear.face_width - gear.spec.gap) if gear.spec.gap > 0.0 else gear.face_width
        lean = slope / (width * gear.base_helix_cosine * math.cos(gear.transverse_pressure_angle))
        angle = math.atan(math.tan(gear.helix_angle) + lean)
        said.append(
            f"the teeth lean by {_degrees(angle)} and not by {_degrees(gear.helix_angle)}: {_um(abs(slope))}{SPACE}µm over the face is more than the helix "
            "slope of any class; check helix_angle"
        )
    return said


def _off(gear: Gear, seen: SeenRadii, scale: float) -> tuple[float, float]:
    """Relative difference of the flanks' base circle and of the tip circle from the design's, beside the scan's `scale`."""
    return seen.base / gear.base_radius - 1.0 - scale, seen.tip / gear.tip_radius - 1.0 - scale


def _degrees(angle: float) -> str:
    return f"{number(math.degrees(angle), 2)}°"


def _diameter(radius: float) -> str:
    return f"{significant(2.0 * radius)}{SPACE}mm"


def _um(value: float) -> str:
    return significant(1e3 * value)
