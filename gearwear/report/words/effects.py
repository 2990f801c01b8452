"""Effects of the catalogue as an engineer would say them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from gearwear.design.quantity import listed
from gearwear.diagnose.effects.base import Estimate
from gearwear.diagnose.found import FoundEffect
from gearwear.report.words.numbers import effect_title, named, quantity
from gearwear.wear_law.teeth import FittedLaw

SIGNED: dict[str, tuple[str, str, str]] = {
    "scale": ("relative_ppm", "a scan that is {} too large", "a scan that is {} too small"),
    "height_scale": ("relative_ppm", "heights that read {} too large", "heights that read {} too small"),
    "axis_offset_radial": (
        "offset_um",
        "a laser zero {} off along the line of sight (every radius reads too large)",
        "a laser zero {} off along the line of sight (every radius reads too small)",
    ),
    "profile_shift": ("shift_um", "a profile shift {} above the drawn one", "a profile shift {} below the drawn one"),
    "tip_diameter": ("diameter_um", "a tip diameter {} too large", "a tip diameter {} too small"),
    "tooth_thickness": ("thickness_um", "teeth cut {} too thick", "teeth cut {} too thin"),
    "profile_crowning": ("crowning_um", "profiles crowned by {}", "profiles hollow by {}"),
    "helix_crowning": ("crowning_um", "flanks crowned lengthwise by {}", "flanks hollow lengthwise by {}"),
}
"""Effects that are named after the sign of a parameter: the parameter, the words for +, the words for −."""

PLAIN: dict[str, str] = {
    "coating": "a coat {thickness_um} thick on every surface",
    "scale_anisotropic": "a scan that is {difference_ppm} longer along {direction_deg} than across it",
    "axis_offset_lateral": "a laser line that passes the table's axis by {offset_um}",
    "turntable_angle": "a turntable whose angle is off by {amplitude_deg}, {order} times a revolution",
    "scan_drift": "a drift during the scan that leaves a step of {closure_deg} at {start_deg}",
    "lens_distortion": "lens distortion that bows the scan by {bow_um}",
    "incidence_bias": "a range bias of {bias_um} that grows with the angle of incidence",
    "edge_rounding": "edges rounded by the laser spot ({amount_um} over {width_mm})",
    "occlusion": "roots that read {height_um} too high, as light caught in the space makes them",
    "view_registration": "a view {shift_x_um} in x and {shift_y_um} in y out of place",
    "eccentricity": "a gear mounted {amplitude_um} off its axis towards {direction_deg}",
    "wobble": "a gear that wobbles by {amplitude_um} towards {direction_deg}",
    "profile_slope": "a profile slope of {left_um} on left and {right_um} on right flanks",
    "tip_relief": "tip relief of {amount_um} from a roll length of {start_mm}",
    "root_relief": "root relief of {amount_um} below a roll length of {start_mm}",
    "helix_slope": "a helix slope of {slope_um}",
    "taper": "teeth that taper by {taper_um} along the face",
    "twist": "flanks twisted by {twist_um}",
    "pitch": "pitch errors, tooth by tooth, of {index_um}",
    "feed_marks": "feed marks of {amplitude_um}, {wavelength_mm} apart along the face",
    "abrasive_wear": "even wear of {depth_um}",
    "sliding_wear": "wear that grows with sliding, {depth_um} at the form circle",
    "plastic_flow": "metal pushed along the flank by {height_um}",
    "burr": "a burr {height_um} high",
}
"""The others; each {parameter} is replaced by its number."""


def found_words(effect: FoundEffect) -> str:
    """What an effect that was found is, with its numbers."""
    return effect_words(effect.name, effect.parameters)


def fitted_words(law: FittedLaw) -> str:
    """What a wear law on the flanks of one side is, with its number."""
    return effect_words(law.name, {"depth_um": Estimate(1e3 * law.depth, 1e3 * law.std, "um")})


def effect_words(name: str, parameters: Mapping[str, Estimate]) -> str:
    """What an effect is, with its numbers, as an engineer would say it.

    Parameters
    ----------
    name : str
        One that is not in the catalogue is named as it is.
    parameters : mapping of str to Estimate

    Returns
    -------
    str

    Examples
    --------
    >>> effect_words("scale", {"relative_ppm": Estimate(-120.0, 5.2, "ppm")})
    'a scan that is 120.0\\u202f±\\u202f5.2\\u202fppm too small'
    """
    if name in SIGNED:
        key, more, less = SIGNED[name]
        one = parameters.get(key)
        if one is not None and not isinstance(one.value, tuple):
            return (more if one.value >= 0.0 else less).format(quantity(replace(one, value=abs(one.value))))
    if name in PLAIN:
        return PLAIN[name].format(**{key: quantity(one) for key, one in parameters.items()})
    return effect_title(name) + (f" ({listed(named(parameters))})" if parameters else "")
