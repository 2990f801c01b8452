"""A made-up but possible result: what the report is given, without running anything that measures."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles
from gearwear.design.spec import GearSpec
from gearwear.design.surface import FILLET, ROOT, TIP, SurfacePoints
from gearwear.report.figures.arrays import MeshingCurves, ReportArrays

WORN = {(1, 0): 1550.0, (0, 0): 200.0, (2, 0): 120.0}
"""(0-based tooth, side) and greatest depth in µm."""


def fake_gear(teeth: int = 12, bore: float = 24.0) -> Gear:
    return Gear.from_spec(GearSpec("pinion", teeth, 6.35, 15.0, bore_diameter=bore))


def _worn_profiles(gear: Gear, roll: Floats, z: Floats, depth_um: Floats) -> ToothProfiles:
    """Half angles less r_b ψ = depth, at the radius that each worn point really has."""
    radius = np.hypot(np.linspace(0.0, gear.tip_roll, 60), gear.base_radius)
    radius = np.concatenate([np.linspace(gear.root_radius, radius[0], 12)[:-1], radius])
    own = np.sqrt(np.maximum(radius**2 - gear.base_radius**2, 0.0))
    depth = np.zeros((gear.teeth, 2, len(z), len(radius)))
    for index in np.ndindex(depth.shape[:3]):
        depth[index] = np.interp(own, roll - 1e-3 * depth_um[index], 1e-3 * depth_um[index])
    depth[..., radius < gear.form_radius] = 0.0
    return ToothProfiles(gear, radius, z, gear.half_angle(radius) - depth / gear.base_radius)


def _elsewhere(gear: Gear, rng: np.random.Generator, per_surface: int = 4000) -> SurfacePoints:
    """Points on fillets, tips and roots with a coat of 20 µm."""
    parts = []
    for surface in (FILLET, TIP, ROOT):
        n = per_surface
        tooth, side = rng.integers(0, gear.teeth, n), rng.choice([-1, 1], n)
        if surface == FILLET:
            radius = rng.uniform(gear.root_radius, gear.form_radius, n)
            angle = tooth * gear.pitch_angle + side * gear.half_angle(radius)
        elif surface == TIP:
            radius, side = np.full(n, gear.tip_radius), np.zeros(n)
            angle = tooth * gear.pitch_angle + rng.uniform(-1, 1, n) * gear.tip_half_angle
        else:
            radius, side = np.full(n, gear.root_radius), np.zeros(n)
            angle = (tooth + 0.5) * gear.pitch_angle + rng.uniform(-1, 1, n) * gear.root_half_angle
        position = np.stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0, gear.face_width, n)], axis=1)
        normal = position * [1.0, 1.0, 0.0] / radius[:, None]
        parts.append((np.full(n, surface), tooth, side, np.full(n, np.nan), position, normal, rng.normal(0.020, 0.003, n)))
    return SurfacePoints(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def fake_arrays(teeth: int = 12, columns: int = 44, rows: int = 30, planar: bool = False, worn: bool = True) -> ReportArrays:
    """Maps of a coated gear with worn left flanks, a table error and a hole in the scan."""
    rng = np.random.default_rng(4)
    gear = fake_gear(teeth)
    edges = np.sqrt(np.linspace(gear.form_roll**2, gear.tip_roll**2, columns + 1))
    roll = 0.5 * (edges[1:] + edges[:-1])
    z = np.array([7.5]) if planar else (np.arange(rows) + 0.5) * gear.face_width / rows
    shape = (teeth, 2, len(z), columns)
    wear = np.zeros(shape)
    if worn:
        u, v = np.meshgrid((roll - 14.0) / 12.0, (z - 7.0) / 9.0)
        bump = np.clip(1.0 - np.abs(u) ** 3, 0, 1) * np.clip(1.0 - v**4, 0, 1)
        for (tooth, side), depth in WORN.items():
            wear[tooth, side] = depth * bump
        wear[wear < 6.0] = 0.0
    tau = np.arange(teeth)[:, None, None, None] * gear.pitch_angle
    sign = np.array([1.0, -1.0])[None, :, None, None]
    made = 20.0 + sign * 14.0 * np.cos(3 * tau + 0.4) + 0.35 * (roll - roll.mean())
    noise = rng.normal(0.0, 2.9, shape)
    seen = np.ones(shape, dtype=bool)
    seen[4, 1, : max(1, len(z) // 3), 10:25] = False
    seen[7:9, 0, -4:, :6] = False
    blank = np.where(seen, 0.0, np.nan)
    on_wear = np.where(wear > 0.0, np.nan, 0.0)
    turn = np.linspace(0.0, 360.0, 361)
    loss = sum(
        depth * np.clip(1.0 - np.abs((turn - 360.0 * tooth / teeth + 180.0) % 360.0 - 180.0) / (200.0 / teeth), 0, 1)
        for (tooth, _), depth in (WORN.items() if worn else ())
    )
    curves = MeshingCurves(turn, 0.0 * turn - loss, np.full_like(turn, 228.6), 228.6 + loss / math.cos(math.radians(20.0)))
    share = np.where(wear > 0.0, 0.0, rng.uniform(0.8, 1.0, shape))
    share[:, 1] = np.nan
    return ReportArrays(
        gear, roll, z, made - wear + noise + blank, wear, _worn_profiles(gear, roll, z, wear),
        made + noise + blank + on_wear, noise + blank + on_wear,
        None if planar else _elsewhere(gear, rng), curves, share,
    )  # fmt: skip


def _value(value: float, std: float | None, unit: str) -> dict[str, Any]:
    return {"value": value, "std": std, "unit": unit}


def _effect(
    name: str, kind: str, parameters: dict[str, Any], rms: tuple[float, float], others: tuple[str, ...] = ()
) -> dict[str, Any]:
    return {
        "name": name, "kind": kind, "parameters": parameters, "alternatives": list(others),
        "rms_before_um": rms[0], "rms_after_um": rms[1], "heldout_rms_before_um": rms[0] * 1.01, "heldout_rms_after_um": rms[1] * 1.02,
        "evidence": {"statistic": 412.7, "effective_sample_size": 1893.0, "p_value": 3e-12},
    }  # fmt: skip


def _change(before: float, after: float, std: float, as_made: float | None, **causes: float) -> dict[str, Any]:
    return {
        "before": before, "after": after, "difference": {"value": after - before, "std": std}, "matters": abs(after - before) > std,
        "as_made": as_made, "causes": [{"name": name, "change": size} for name, size in causes.items()],
    }  # fmt: skip


def _regions() -> list[dict[str, Any]]:
    rows = []
    for (tooth, side), depth, volume in zip(WORN, WORN.values(), (82.25, 5.34, 3.21), strict=True):
        rows.append({
            "tooth": tooth + 1, "flank": ("left", "right")[side], "volume_mm3": _value(volume, 0.006 * volume, "mm3"),
            "max_depth_um": depth, "mean_depth_um": 0.5 * depth, "area_mm2": 96.4, "centroid_mm": [38.2, 12.1, 7.3], "patches": 1,
        })  # fmt: skip
    return rows


def fake_report() -> dict[str, Any]:
    """Every key of the contract, with a scan's file name that would hurt a page that does not escape it."""
    gear = fake_gear()
    row = {"left": "5.4", "centre_distance_mm": 114.3, "working_pressure_angle_deg": 20.0, "path_of_contact_mm": 23.516}
    play = {
        "circumferential_mm": 0.2286,
        "normal_mm": 0.2148,
        "radial_mm": 0.314,
        "angular_pinion_deg": 0.3438,
        "angular_gear_deg": 0.1719,
    }
    worse = {key: value * 7.2 for key, value in play.items()} | {f"{key}_min": value for key, value in play.items()}
    del row["left"]
    thickness = []
    for tooth in range(1, 13):
        loss = {2: 1.58, 1: 0.21, 3: 0.13}.get(tooth, 0.004)
        thickness.append({
            "tooth": tooth, "nominal_mm": 9.974557, "mean_mm": 9.974557 - 0.7 * loss, "min_mm": 9.974557 - loss,
            "loss_max_mm": loss, "at_z_mm": 6.9,
        })  # fmt: skip
    return {
        "schema": "gearwear.report/1",
        "design": {
            "part": "pinion", "file": "models/pair.toml", "teeth": 12, "module_mm": 6.35, "pressure_angle_deg": 20.0, "face_width_mm": 15.0,
            "reference_radius_mm": gear.reference_radius, "base_radius_mm": gear.base_radius, "tip_radius_mm": gear.tip_radius,
            "root_radius_mm": gear.root_radius, "form_radius_mm": gear.form_radius, "tooth_thickness_mm": gear.tooth_thickness,
            "undercut": True,
        },
        "scan": {
            "files": ["scan <b>&\"worn\"</b>.ply"], "points": 488_000, "used": 449_213, "rejected": 312, "other": 38_475, "kind": "cloud",
            "coverage": {"flank": 0.994, "fillet": 0.97, "root": 0.98, "tip": 1.0, "end_low": 0.99, "end_high": 1.0, "bore": 0.0},
        },
        "registration": {
            "rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "translation_mm": [0.2, 1.0, -0.2], "converged": True,
            "datum": ["right flank", "tip", "root"], "assumptions": ["right (coast) flanks are unworn"],
            "std": {"rotation_um": 0.05, "x_um": 0.08, "y_um": 0.08, "z_um": 0.1},
            "views": [],
        },
        "closed_loop": {
            "noise_um": 10.02,
            "before": {"rms_um": 26.31, "heldout_rms_um": 26.44},
            "after": {"rms_um": 10.12, "heldout_rms_um": 10.21},
            "effects": [
                _effect("coating", "measurement", {"thickness_um": _value(20.1, 0.2, "um")}, (26.31, 15.02)),
                _effect(
                    "turntable_angle", "measurement",
                    {"order": _value(3, None, ""), "amplitude_deg": _value(0.0213, 0.0004, "deg"), "phase_deg": _value(23.0, 1.2, "deg")},
                    (15.02, 10.48),
                ),
                _effect("scale", "measurement", {"relative_ppm": _value(352.0, 21.0, "ppm")}, (10.48, 10.12), ("axis_offset_radial",)),
            ],
            "unexplained": {"found": False, "rms_um": 0.4, "pattern": None},
            "changes": {
                "worn_volume_mm3": _change(83.1, 90.8, 0.8, 0.0, coating=8.2),
                "deepest_wear_um": _change(1531.2, 1550.0, 7.1, 0.0, coating=20.0),
                "tooth_thickness_mean_mm": _change(9.9921, 9.9495, 0.0005, 9.9746, coating=-0.0426),
                "backlash_greatest_mm": _change(1.6033, 1.6459, 0.0006, 0.2286, coating=0.0426),
                "transmission_error_um": _change(1562.1, 1549.2, 1.2, None, turntable_angle=-13.0),
            },
        },
        "wear": {
            "volume_mm3": _value(90.80, 0.51, "mm3"), "before_loop": {"volume_mm3": _value(83.1, 0.6, "mm3")}, "regions": _regions(),
            "laws": [{"name": "sliding_wear", "parameters": {"depth_um": _value(212.0, 9.0, "um")}, "rms_before_um": 61.2, "rms_after_um": 18.4}],
        },
        "thickness": thickness,
        "meshing": {
            "paper": {
                "thickness_loss_mm": 1.58, "backlash_mm": 1.3514, "centre_distance_change_mm": -1.856, "centre_distance_mm": 116.156,
                "pressure_angle_deg": 22.38, "pitch_radius_pinion_mm": 38.719, "pitch_radius_gear_mm": 77.437,
                "contact_length_design_mm": 28.3276, "contact_length_worn_mm": 23.12,
            },
            "design": {**row, "backlash": play, "contact_ratio": 1.2544, "transmission_error_um": 0.0},
            "worn": {**row, "backlash": worse, "contact_ratio": 1.11, "transmission_error_um": 1549.2},
        },
        "files": ["report.json", "report.html", "worn_volume.stl", "worn_volume.3mf", "worn_gear.stl"],
        "warnings": ["the mate's tip passes the pinion's interference point by 1.984 mm of roll"],
    }  # fmt: skip


def bare_report() -> dict[str, Any]:
    """The least there can be: no mate, no loop, no wear found, one planar section."""
    report = copy.deepcopy(fake_report())
    report["scan"] |= {"kind": "section", "coverage": {"flank": 0.93}}
    report["closed_loop"] = {"noise_um": 9.7, "before": {"rms_um": 31.0, "heldout_rms_um": None}, "effects": []}
    report["wear"] = {"area_mm2": {"value": 0.0, "std": 0.02}, "regions": [], "laws": []}
    report["meshing"] = None
    report["thickness"] = []
    report["warnings"] = []
    report["registration"] = {
        "rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "translation_mm": [0.0, 0.0, 0.0],
        "converged": True,
    }
    return report
