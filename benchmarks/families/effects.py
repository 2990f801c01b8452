"""Effects of the contract's table, drawn by name: fields of manufacture or motions of the instrument, and the parameters to be reported."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from benchmarks.families.fields import FeedMarks, Field, Frame, Index, Polynomial, Relief
from benchmarks.families.gear import GearNumbers
from benchmarks.families.instrument import Coat, Drift, RadialOffset, Stretch, Turntable
from benchmarks.families.scanner import Shift

NAMES = (
    "coating", "scale", "scale_anisotropic", "height_scale", "axis_offset_radial", "turntable_angle", "scan_drift", "tooth_thickness",
    "profile_slope", "profile_crowning", "helix_crowning", "tip_relief", "root_relief", "helix_slope", "taper", "twist", "pitch",
    "feed_marks",
)  # fmt: skip
Drawn = tuple[Field | None, Shift | None, dict[str, Any]]


def draw(name: str, amount: float, gear: GearNumbers, f: Frame, cell: float, rng: np.random.Generator) -> Drawn:
    """An effect that moves flanks by about `amount` mm.

    Parameters
    ----------
    name : str
    amount : float
        mm.
    gear : GearNumbers
    f : Frame
    cell : float
        Shortest length a wave may have, mm.
    rng : numpy.random.Generator

    Returns
    -------
    field of manufacture or None, motion of the instrument or None, {"name", "parameters"}
    """
    sign, um = float(rng.choice([-1.0, 1.0])), 1e3
    turn = float(rng.uniform(0.0, 2.0 * math.pi))
    made: Field | None = None
    told: dict[str, Any]
    shift: Shift | None = None
    match name:
        case "coating":
            shift, told = Coat(amount), {"thickness_um": um * amount}
        case "scale":
            e = sign * amount / f.reference
            shift, told = Stretch(e, e), {"relative_ppm": 1e6 * e}
        case "scale_anisotropic":
            e = 2.0 * amount / gear.reference_radius
            shift, told = Stretch(more=e, direction=turn), {"difference_ppm": 1e6 * e}
        case "height_scale":
            e = 2.0 * sign * amount / gear.face_width
            shift, told = Stretch(axial=e), {"relative_ppm": 1e6 * e}
        case "axis_offset_radial":
            shift, told = RadialOffset(2.0 * sign * amount), {"offset_um": 2.0 * um * sign * amount}
        case "turntable_angle":
            order, a = int(rng.integers(1, 9)), amount / gear.base_radius
            shift, told = Turntable(order, a, turn), {"order": order, "amplitude_deg": math.degrees(a)}
        case "scan_drift":
            a = 2.0 * sign * amount / gear.base_radius
            shift, told = Drift(a, turn), {"closure_deg": math.degrees(a)}
        case "tooth_thickness":
            s = 2.0 * sign * amount / f.cos
            made, told = Polynomial(0.5 * s * f.cos), {"thickness_um": um * s}
        case "profile_slope":
            s = 2.0 * sign * amount
            made, told = Polynomial(0.5 * s, 1), {"left_um": um * s, "right_um": um * s}
        case "profile_crowning":
            c = 1.5 * sign * amount
            made, told = Polynomial(-c, 2), {"crowning_um": um * c}
        case "helix_crowning":
            c = 1.5 * sign * amount
            made, told = Polynomial(-4.0 * c, 0, 2), {"crowning_um": um * c}
        case "tip_relief":
            start = f.form + float(rng.uniform(0.45, 0.8)) * (f.tip - f.form)
            made, told = Relief(2.0 * amount, start), {"amount_um": 2.0 * um * amount, "start_mm": start}
        case "root_relief":
            start = f.form + float(rng.uniform(0.25, 0.5)) * (f.tip - f.form)
            made, told = Relief(2.0 * amount, start, root=True), {"amount_um": 2.0 * um * amount, "start_mm": start}
        case "helix_slope":
            s = 2.0 * sign * amount
            made, told = Polynomial(s, 0, 1, odd=True), {"slope_um": um * s}
        case "taper":
            s = 2.0 * sign * amount
            made, told = Polynomial(s, 0, 1), {"taper_um": um * s}
        case "twist":
            s = 4.0 * sign * amount
            made, told = Polynomial(0.5 * s, 1, 1), {"twist_um": um * s}
        case "pitch":
            arcs = index(gear.teeth, amount / f.cos, rng)
            made, told = Index(arcs), {"index_um": [um * a for a in arcs]}
        case "feed_marks":
            length = float(np.exp(rng.uniform(math.log(cell), math.log(max(gear.face_width / 1.5, 1.01 * cell)))))
            made, told = FeedMarks(amount, length, turn), {"amplitude_um": um * amount, "wavelength_mm": length}
        case _:
            raise ValueError(f"no such effect: {name!r}")
    return made, shift, {"name": name, "parameters": told}


def index(teeth: int, rms: float, rng: np.random.Generator) -> tuple[float, ...]:
    """Index errors of mean 0: a closed walk, or each tooth by itself."""
    step = rng.standard_normal(teeth)
    if rng.random() < 0.5:
        step = np.cumsum(step - step.mean())
    step = step - step.mean()
    return tuple((rms * step / step.std()).tolist())
