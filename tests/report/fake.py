"""Small real results, and possible ones made of them with numbers that are known: what the report is given."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np

import gearwear as gw
from gearwear.arrays import Floats
from gearwear.comparison.consequences import Change
from gearwear.comparison.contact_readings import ContactLimits, ContactNumbers, ReadOtherwise
from gearwear.comparison.results import Results
from gearwear.comparison.stations import compare
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.surface import FILLET, ROOT, TIP, SurfacePoints
from gearwear.diagnose.correlations import Correlation
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import ParameterEstimate
from gearwear.diagnose.found import FoundEffect
from gearwear.diagnose.judge import Evidence
from gearwear.report.figures.arrays import MeshingCurves, ReportArrays
from gearwear.wear.regions import WearRegion
from gearwear.wear.solid import Solids
from gearwear.wear.thickness import SectionThickness
from tests.synthetic import Effect, Patch, Recipe, make_scan

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
        gear=gear, roll_mm=roll, z_mm=z, deviation_um=made - wear + noise + blank, wear_depth_um=wear,
        effects_out_um=noise - wear + blank, worn=_worn_profiles(gear, roll, z, wear), residual_before_um=made + noise + blank + on_wear,
        residual_after_um=noise + blank + on_wear, elsewhere=None if planar else _elsewhere(gear, rng), meshing=curves, contact_share=share,
    )  # fmt: skip


@cache
def real_scan() -> Path:
    """A coated pinion with a patch on a left flank."""
    wear = (Patch(1, 1, 300.0, (37.0, 43.0), (3.0, 12.0)),)
    recipe = Recipe(pose="mild", noise_um=5.0, jitter=1.0, wear=wear, effects=(Effect("coating", {"thickness_um": 20.0}),))
    file = Path(mkdtemp()) / "scan.xyz"
    points = make_scan(recipe.of_size(30_000), 3).points
    np.savetxt(file, np.random.default_rng(1).permutation(points), fmt="%.6f")
    return file


@cache
def real_results() -> Results:
    """That scan compared with the example's pair, of which it is not said which gear it is: what several files look at, compared once."""
    return gw.compare(gw.read_design(gw.example()), real_scan())


@cache
def bare_results() -> Results:
    """The least there can be: one gear, one unworn planar section, no loop."""
    recipe = Recipe(slices=5, points_per_tooth=1500, end_points=0, ends="none", pose="none", noise_um=5.0)
    scan = make_scan(recipe, 4)
    section = scan.points[np.isclose(scan.truth.labels.z, np.median(scan.truth.labels.z))]
    file = Path(mkdtemp()) / "section.xyz"
    np.savetxt(file, section[:, :2], fmt="%.6f")
    return compare(Design({"pinion": fake_gear(bore=0.0)}), [file], loop=False, inspection=False)


def changed(whole: Any, path: str, value: Any) -> Any:
    """A frozen bundle with one field, named by its path, replaced."""
    name, _, rest = path.partition(".")
    return replace(whole, **{name: changed(getattr(whole, name), rest, value) if rest else value})


def open_contact() -> Results:
    """`fake_results` with 0.1 to 1.7 mm of backlash and 1 to 1600 µm of transmission error."""
    low, high = ContactNumbers(0.001, 0.1, 0.02, 1.1), ContactNumbers(1.6, 1.7, 1.6, 1.3)
    return changed(fake_results(), "pair.limits", ContactLimits(low, high, (ReadOtherwise.SIDES, ReadOtherwise.PATTERN)))


def fake_effect(
    name: str, parameters: dict[str, ParameterEstimate], rms: tuple[float, float] = (20.0, 15.0), others: tuple[str, ...] = ()
) -> FoundEffect:
    """An effect of the catalogue as the loop would have found it; RMS in µm."""
    effect = next(one for one in catalogue() if one.name == name)
    evidence = Evidence(412.7, (1.0, 1892.0), 1893.0, 3e-12, 1.0, 0.1, 0.99, 0.04, 0.01, 0.02, True)
    before, after = 1e-3 * rms[0], 1e-3 * rms[1]
    candidate = Candidate(effect, (), np.zeros(1, dtype=np.int64))
    return FoundEffect(
        candidate, np.ones(1), parameters, others, evidence, before, after, 1.01 * before, 1.02 * after, 0.01 * np.eye(1)
    )


def fake_thickness(loss: dict[int, float]) -> SectionThickness:
    """Twelve teeth in seven sections; `loss` by tooth (from 1) in mm, the others 4 µm."""
    gear, z = fake_gear(), np.linspace(0.0, 15.0, 7)
    made = np.full((12, 7), gear.tooth_thickness)
    arc = made - np.array([loss.get(tooth, 0.004) for tooth in range(1, 13)])[:, None]
    nothing = np.zeros((12, 2, 7))
    return SectionThickness(
        gear.reference_radius, z, gear.tooth_thickness, arc, nothing, nothing, np.full((12, 7), 0.0012), 0.01, made, pooled=5
    )  # fmt: skip


def fake_regions() -> tuple[WearRegion, ...]:
    return tuple(
        WearRegion(
            tooth, tuple(Side)[half], volume, 0.006 * volume, 1e-3 * depth, 5e-4 * depth, 96.4, np.array([38.2, 12.1, 7.3]), 1
        )
        for ((tooth, half), depth), volume in zip(WORN.items(), (82.25, 5.34, 3.21), strict=True)
    )


def solids_of(results: Results, volume: float) -> Solids:
    """The same bodies, larger or smaller: that hold so many mm³."""
    solids = results.wear.solids
    assert solids is not None
    scale = math.cbrt(volume / solids.volume)
    return replace(solids, bodies=tuple(replace(body, vertices=scale * body.vertices) for body in solids.bodies))


@cache
def fake_results() -> Results:
    """`real_results` with numbers that are known: three worn flanks, three effects, five changes; nothing to doubt but one warning."""
    real = real_results()
    assert real.loop is not None
    unsure = fake_effect(
        "scale", {"relative_ppm": ParameterEstimate(352.0, 21.0, "ppm")}, (10.48, 10.12), ("axis_offset_radial",)
    )
    table = {
        "order": ParameterEstimate(3.0, math.nan, "1"),
        "amplitude_deg": ParameterEstimate(0.0213, 0.0004, "deg"),
        "phase_deg": ParameterEstimate(23.0, 1.2, "deg"),
    }
    loop = replace(
        real.loop, noise=0.01002, rms_before=0.02631, rms_after=0.01012, held_out_before=0.02644, held_out_after=0.01021, patterns=(),
        effects=(
            fake_effect("coating", {"thickness_um": ParameterEstimate(20.1, 0.2, "um")}, (26.31, 15.02)),
            fake_effect("turntable_angle", table, (15.02, 10.48)),
            unsure,
        ),
        correlations=(Correlation(("coating", "scale"), ("thickness_um", "relative_ppm"), -0.42),),
    )  # fmt: skip
    file = replace(real.measured.scans[0], files=('scan <b>&"worn"</b>.ply',))
    wear = replace(
        real.wear,
        found=replace(real.wear.found, regions=fake_regions(), volume=90.80, volume_std=0.51),
        before_loop=replace(real.wear.before_loop, volume=83.1, volume_std=0.6),
        thickness=fake_thickness({2: 1.58, 1: 0.21, 3: 0.13}),
        solids=solids_of(real, 90.80),
    )
    changes = (
        Change("worn_volume_mm3", 83.1, 90.8, 0.0, 0.8, (("coating", 8.2),)),
        Change("deepest_wear_um", 1531.2, 1550.0, 0.0, 7.1, (("coating", 20.0),)),
        Change("tooth_thickness_mean_mm", 9.9921, 9.9495, 9.9746, 0.0005, (("coating", -0.0426),)),
        Change("backlash_greatest_mm", 1.6033, 1.6459, 0.2286, 0.0006, (("coating", 0.0426),)),
        Change("transmission_error_um", 1562.1, 1549.2, math.nan, 1.2, (("turntable_angle", -13.0),)),
    )
    measured = replace(real.measured, scans=(file,), loop=loop)
    notes = ("the mate's tip passes the pinion's interference point by 1.984 mm of roll",)
    return replace(real, measured=measured, wear=wear, changes=changes, notes=notes)
