"""A gear as a design file: the TOML that `read_design` reads, each value with its unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from gearwear.design.files.values import MEASURED
from gearwear.design.modification import AMOUNTS, FlankModification
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.standards import diametral_pitch
from gearwear.errors import InputError

UNITS = {
    "module": "mm", "pressure_angle": "degrees", "helix_angle": "degrees, + right hand", "face_width": "mm", "profile_shift": "x module", "addendum": "x module",
    "dedendum": "x module", "rack_tip_radius": "x module", "thinning": "mm, arc at the reference circle", "bore_diameter": "mm",
    "tip_chamfer": "mm", "end_chamfer": "mm", "cutter_tip_radius": "x module", "fillet_radius": "mm", "rim_diameter": "mm",
    "tip_rounding": "mm", "end_rounding": "mm", "protuberance": "mm", "grinding_stock": "mm", "protuberance_angle": "degrees",
    "gap": "mm, groove between the halves",
}  # fmt: skip


def design_text(spec: GearSpec, header: Sequence[str] = (), remarks: Mapping[str, str] | None = None) -> str:
    """Write a specification as TOML.

    Parameters
    ----------
    spec : GearSpec
        The gear; its name ("pinion" or "gear") is the section's.
    header : sequence of str
        Lines of comment before it.
    remarks : mapping of str to str or None
        More comment behind the value of a key.

    Returns
    -------
    str

    Raises
    ------
    InputError
        If the legs of the tip chamfer differ: a design file has one.

    Examples
    --------
    >>> print(design_text(GearSpec("gear", 24, 6.35, 15.0), ["From a drawing."]), end="")
    # From a drawing.
    <BLANKLINE>
    [gear]
    teeth = 24
    diametral_pitch = 4                  # module 6.35 mm
    pressure_angle = 20                  # degrees
    face_width = 15                      # mm
    profile_shift = 0                    # x module
    addendum = 1                         # x module
    dedendum = 1.25                      # x module
    rack_tip_radius = 0.3                # x module
    thinning = 0                         # mm, arc at the reference circle
    """
    check_even_chamfer(spec, "a design file")
    values: dict[str, float | str] = {"internal": True} if spec.internal else {}
    values["teeth"] = spec.teeth
    pitch = diametral_pitch(spec.normal_module)
    units = dict(UNITS)
    if pitch is not None:
        values["diametral_pitch"] = pitch
        units["diametral_pitch"] = f"module {spec.normal_module:.6g} mm"
    else:
        values["module"] = spec.normal_module
    values["pressure_angle"] = round(math.degrees(spec.normal_pressure_angle), 9)
    if spec.helix_angle != 0.0:
        values["helix_angle"] = round(math.degrees(spec.helix_angle), 9)
        units["module"], units["thinning"] = "mm, normal", "mm, normal arc at the reference circle"
    values["face_width"] = spec.face_width
    for key in ("profile_shift", "addendum", "dedendum", *(() if spec.internal else ("rack_tip_radius",)), "thinning"):
        values[key] = getattr(spec, key)
    if spec.thinning_measured:
        values["thinning_from"] = MEASURED
        units["thinning_from"] = (
            "on a gear that may be worn; with that of the drawing, or of a tooth that never ran: leave this line out"
        )
    if spec.internal:
        units["profile_shift"] = "x module, by ISO: + is a thicker tooth"
    for key in ("cutter_teeth", "cutter_tip_radius", "fillet_radius"):
        if getattr(spec, key) is not None:
            values[key] = getattr(spec, key)
    for key in (
        "bore_diameter",
        "rim_diameter",
        "tip_chamfer",
        "tip_rounding",
        "end_chamfer",
        "end_rounding",
        "gap",
        "protuberance",
        "grinding_stock",
    ):
        if getattr(spec, key) > 0.0:
            values[key] = getattr(spec, key)
    if spec.protuberance_angle is not None:
        values["protuberance_angle"] = round(math.degrees(spec.protuberance_angle), 9)
    lines = [f"# {line}".rstrip() for line in header] + ([""] if header else []) + [f"[{spec.name}]"]
    for key, value in values.items():
        comment = "; ".join(part for part in (units.get(key, ""), (remarks or {}).get(key, "")) if part)
        lines.append(f"{f'{key} = {_shortest(value)}':<36} # {comment}" if comment else f"{key} = {_shortest(value)}")
    if spec.left == spec.right:
        return "\n".join(lines + _modification(spec.left)) + "\n"
    for side in Side:
        stated = _modification(spec.left if side is Side.LEFT else spec.right)
        lines += ["", f"[{spec.name}.{side}]", *stated] if stated else []
    return "\n".join(lines) + "\n"


def check_even_chamfer(spec: GearSpec, written: str) -> None:
    """Refuse a tip chamfer whose legs differ, for which there is no place in what is `written`.

    Raises
    ------
    InputError
    """
    if spec.tip_chamfer_on_land != spec.tip_chamfer:
        raise InputError(
            f"[{spec.name}] tip_chamfer_land = {spec.tip_chamfer_land:g} mm: {written} has one leg for a tip chamfer; that of tip_chamfer, "
            f"{spec.tip_chamfer:g} mm, or leaving it out would be right"
        )


def _modification(modification: FlankModification) -> list[str]:
    """Relief, crowning and slopes, a line each."""
    return [
        f'{key} = "{value}"' if isinstance(value, str) else f"{f'{key} = {_shortest(value)}':<36} # {_modification_unit(key)}"
        for key, value in modification.stated.items()
    ]


def _modification_unit(key: str) -> str:
    if key in AMOUNTS:
        return "mm, along the transverse base tangent"
    return {"start": "mm, diameter", "length": "mm, face" if key.startswith("end") else "mm, roll"}[key.rsplit("_", 1)[1]]


def _shortest(value: float | str) -> str:
    """The shortest text that reads back as the same number, as true, or as the same word."""
    if isinstance(value, str):
        return f'"{value}"'
    if value is True:
        return "true"
    text = f"{value:.12g}"
    return text if float(text) == value else repr(float(value))
