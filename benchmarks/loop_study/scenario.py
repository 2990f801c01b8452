"""What a scan of the study is made of: everything drawn from the study's seed and the scan's own number."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tests.synthetic import (
    OUTSIDE,
    PINION,
    Effect,
    GearNumbers,
    Hole,
    Outline,
    Patch,
    Recipe,
    SlidingWear,
    Texture,
)

SMALLEST, LARGEST = 0.3, 60.0
"""Size of an effect in µm on the flanks: log-uniform between these. The scans show a few tenths of a µm at best."""
NULL = "n"
"""Prefix of the number of a null scan."""
OUTSIDE_SHARE = 1.0 / 6.0
ALONE = 0.5
"""Share of the scans with an effect outside the catalogue that have no other."""
NAMES = (
    "coating", "scale", "scale_anisotropic", "height_scale", "axis_offset_radial", "axis_offset_lateral", "turntable_angle", "scan_drift",
    "tooth_thickness", "profile_slope", "profile_crowning", "helix_crowning", "tip_relief", "root_relief", "helix_slope", "taper", "twist",
    "pitch", "feed_marks",
)  # fmt: skip
"""Measurement and manufacture of the contract's table: what can be named without a datum."""


@dataclass(frozen=True, slots=True)
class Scenario:
    """One scan to be made.

    Parameters
    ----------
    label : str
        "37", or "n37" for a null scan.
    recipe : Recipe
        Of the generator.
    seed : int
        Of the generator.
    mate : bool
        Whether the fit knows a mate (wheel twice as large), as it must for Archard's sliding.
    """

    label: str
    recipe: Recipe
    seed: int
    mate: bool

    @property
    def declared(self) -> tuple[Effect, ...]:
        """Effects of the catalogue."""
        return tuple(e for e in self.recipe.effects if e.name not in OUTSIDE)

    @property
    def outside(self) -> Effect | None:
        """The effect outside the catalogue, if any."""
        return next((e for e in self.recipe.effects if e.name in OUTSIDE), None)


def draw(label: str, seed: int, points: int) -> Scenario:
    """The scan of a number; it depends on nothing but its arguments.

    Parameters
    ----------
    label : str
        "0", "1" …; "n0", "n1" … for null scans.
    seed : int
        Of the study.
    points : int
        Of each scan, about.
    """
    null = label.startswith(NULL)
    rng = np.random.default_rng([seed, int(null), int(label.removeprefix(NULL))])
    numbers = _gear(rng)
    outline = Outline.of(numbers)
    ends = str(rng.choice(["both", "upper", "none"], p=[0.6, 0.2, 0.2]))
    wear, mate = _wear(rng, outline)
    texture = None if rng.random() < 0.15 else _texture(rng)
    effects: tuple[Effect, ...] = ()
    if not null:
        outside = (_outside(rng, outline),) if rng.random() < OUTSIDE_SHARE else ()
        count = int(rng.integers(1, 4))
        if outside:
            count = 0 if rng.random() < ALONE else 1
        shown = {"height_scale": ends == "both", "feed_marks": outline.face_width > 4.5 * cell(outline, points)}
        possible = [name for name in NAMES if shown.get(name, True)]
        names = rng.choice(possible, count, replace=False)
        effects = (*(effect(str(name), size(rng), outline, points, rng) for name in names), *outside)
    recipe = Recipe(
        gear=numbers,
        ends=ends,  # type: ignore[arg-type]
        jitter=float(rng.choice([0.0, 1.0])),
        noise_um=float(rng.uniform(5.0, 15.0)),
        texture=texture,
        outliers=float(rng.choice([0.0, 0.0005, 0.003])),
        lost=float(rng.uniform(0.0, 0.1)),
        holes=tuple(_hole(rng, outline) for _ in range(rng.integers(0, 4))),
        wear=wear,
        effects=effects,
        fillets_follow=bool(rng.random() < 0.5),
        pose=str(rng.choice(["mild", "any"])),  # type: ignore[arg-type]
    ).of_size(points)
    return Scenario(label, recipe, int(rng.integers(2**31)), mate)


def size(rng: np.random.Generator) -> float:
    """Size of an effect, µm, log-uniform."""
    return float(np.exp(rng.uniform(math.log(SMALLEST), math.log(LARGEST))))


def effect(name: str, amount: float, outline: Outline, points: int, rng: np.random.Generator) -> Effect:
    """An effect of the contract's table that moves flanks by about `amount` µm; signs, phases and places at random.

    Parameters
    ----------
    name : str
    amount : float
        µm.
    outline : Outline
    points : int
        Of the scan: waves are no shorter than three cells of it.
    rng : numpy.random.Generator
    """
    sign = float(rng.choice([-1.0, 1.0]))
    turn = float(rng.uniform(0.0, 360.0))
    form, tip, z = outline.form_roll, outline.tip_roll, outline.teeth
    per_degree = 1e3 * outline.base_radius * math.radians(1.0)
    match name:
        case "coating":
            own = {"thickness_um": amount}
        case "scale":
            own = {"relative_ppm": sign * 1e3 * amount / outline.reference_roll}
        case "scale_anisotropic":
            own = {"difference_ppm": 2e3 * amount / outline.reference_radius, "direction_deg": 0.5 * turn}
        case "height_scale":
            own = {"relative_ppm": sign * 1e3 * amount / outline.face_width}
        case "axis_offset_radial":
            own = {"offset_um": sign * 2.0 * amount}
        case "axis_offset_lateral":
            own = {"offset_um": sign * min(8.0 * amount, 400.0)}
        case "turntable_angle":
            own = {"order": float(rng.integers(1, 9)), "amplitude_deg": amount / per_degree, "phase_deg": turn}
        case "scan_drift":
            own = {"closure_deg": sign * 2.0 * amount / per_degree, "start_deg": turn}
        case "tooth_thickness":
            own = {"thickness_um": sign * 2.0 * amount}
        case "profile_slope":
            other = 1.0 if rng.random() < 0.3 else float(rng.uniform(-1.0, 1.0))
            both = [sign * 2.0 * amount, sign * 2.0 * amount * other]
            rng.shuffle(both)
            own = {"left_um": both[0], "right_um": both[1]}
        case "profile_crowning" | "helix_crowning":
            own = {"crowning_um": sign * 1.5 * amount}
        case "tip_relief":
            own = {"amount_um": 2.0 * amount, "start_mm": form + float(rng.uniform(0.45, 0.85)) * (tip - form)}
        case "root_relief":
            own = {"amount_um": 2.0 * amount, "start_mm": form + float(rng.uniform(0.25, 0.55)) * (tip - form)}
        case "helix_slope":
            own = {"slope_um": sign * 2.0 * amount}
        case "taper":
            own = {"taper_um": sign * 2.0 * amount}
        case "twist":
            own = {"twist_um": sign * 4.0 * amount}
        case "pitch":
            return Effect("pitch", {"index_um": _index(rng, z, amount)})
        case "feed_marks":
            shortest, longest = 3.0 * cell(outline, points), outline.face_width / 1.5
            length = float(np.exp(rng.uniform(math.log(shortest), math.log(longest))))
            own = {"amplitude_um": amount, "wavelength_mm": length, "phase_deg": turn}
        case _:
            raise ValueError(f"no such effect in the study: {name!r}")
    return Effect(name, own)


def cell(outline: Outline, points: int) -> float:
    """Edge (mm) of the cells a scan of so many points is averaged over: twelve points in each."""
    return math.sqrt(12.0 * outline.length * outline.teeth * outline.face_width / points)


def _index(rng: np.random.Generator, teeth: int, amount: float) -> tuple[float, ...]:
    """Index deviations of root mean square `amount`: a walk that closes, or each tooth by itself."""
    step = rng.standard_normal(teeth)
    if rng.random() < 0.5:
        step = np.cumsum(step - step.mean())
    step = step - step.mean()
    values = (amount * step / step.std()).tolist()
    values[-1] = -sum(values[:-1])
    return tuple(values)


def _outside(rng: np.random.Generator, outline: Outline) -> Effect:
    amount = float(np.exp(rng.uniform(math.log(2.0), math.log(40.0))))
    turn = float(rng.uniform(0.0, 360.0))
    name = str(rng.choice(["wave_growing", "flank_ripple", "stitch_step", "helical_scratch"], p=[0.35, 0.3, 0.25, 0.1]))
    middle = 0.5 * (outline.form_roll + outline.tip_roll)
    match name:
        case "wave_growing":
            own = {"order": float(rng.integers(3, 8)), "amplitude_um": 1.5 * amount, "phase_deg": turn}
        case "flank_ripple":
            span = outline.tip_roll - outline.form_roll
            own = {"amplitude_um": amount, "wavelength_mm": span / float(rng.uniform(1.5, 3.0)), "phase_deg": turn}
        case "stitch_step":
            own = {
                "step_um": float(rng.choice([-1.0, 1.0])) * 3.0 * amount,
                "z_mm": outline.face_width * float(rng.uniform(0.25, 0.75)),
            }
        case _:
            own = {
                "tooth": float(rng.integers(outline.teeth)), "depth_um": 5.0 * amount, "width_mm": 0.12 * outline.numbers.module,
                "roll_mm": middle, "rise_mm_per_mm": float(rng.uniform(-0.5, 0.5)),
            }  # fmt: skip
    return Effect(name, own)


def _gear(rng: np.random.Generator) -> GearNumbers:
    """Three scans in five are of the paper's pinion."""
    bore = rng.random() < 0.25
    if rng.random() < 0.6:
        return GearNumbers(bore_diameter=30.0) if bore else PINION
    teeth, module = int(rng.integers(18, 31)), float(rng.choice([2.5, 3.0, 4.0, 5.0, 6.35]))
    return GearNumbers(
        teeth=teeth,
        module=module,
        face_width=round(module * float(rng.uniform(2.2, 5.0)), 1),
        profile_shift=float(rng.choice([0.0, 0.2])),
        rack_tip_radius=float(rng.choice([0.25, 0.30, 0.38])),
        thinning=float(rng.choice([0.0, 0.02])) * module,
        bore_diameter=round(0.35 * teeth * module, 1) if bore else 0.0,
    )


def _texture(rng: np.random.Generator) -> Texture:
    kind = "gauss" if rng.random() < 0.7 else "exponential"
    return Texture(float(rng.uniform(0.5, 8.0)), float(np.exp(rng.uniform(math.log(0.5), math.log(3.0)))), kind)  # type: ignore[arg-type]


def _wear(rng: np.random.Generator, outline: Outline) -> tuple[tuple[Patch | SlidingWear, ...], bool]:
    """Patches on no to three flanks; on one scan in six all flanks of one side besides. And whether Archard's law is in it."""
    number = int(rng.integers(0, 4))
    flanks = rng.choice(2 * outline.teeth, number, replace=False)
    wear: list[Patch | SlidingWear] = [_patch(rng, outline, int(flank) // 2, 1 - 2 * (int(flank) % 2)) for flank in flanks]
    archard = bool(rng.random() < 0.5)
    if rng.random() < 1.0 / 6.0:
        deepest = 0.02 * outline.numbers.module
        depth = float(np.exp(rng.uniform(math.log(0.1 * deepest), math.log(deepest))))
        factors = tuple(rng.uniform(0.8, 1.2, outline.teeth).tolist())
        wear.append(SlidingWear(1e3 * depth, int(rng.choice([-1, 1])), factors, "archard" if archard else "linear"))
        return tuple(wear), archard
    return tuple(wear), False


def _patch(rng: np.random.Generator, outline: Outline, tooth: int, side: int) -> Patch:
    deepest = 60.0 * outline.numbers.module  # µm: 0.06 modules
    height, b = outline.tip_radius - outline.form_radius, outline.face_width
    r, z = outline.form_radius + height * float(rng.uniform(0.1, 0.9)), b * float(rng.uniform(0.0, 1.0))
    half_r, half_z = height * float(rng.uniform(0.15, 0.6)), b * float(rng.uniform(0.12, 0.6))
    edge = None if rng.random() < 0.6 else float(rng.uniform(0.1, 0.25)) * outline.numbers.module * 0.5
    depth = float(np.exp(rng.uniform(math.log(0.08 * deepest), math.log(deepest))))
    return Patch(tooth, side, depth, (r - half_r, r + half_r), (z - half_z, z + half_z), edge)


def _hole(rng: np.random.Generator, outline: Outline) -> Hole:
    r = float(rng.uniform(max(outline.form_radius, outline.base_radius + 0.01), outline.tip_radius))
    return Hole(
        int(rng.integers(outline.teeth)), int(rng.choice([-1, 1])), r, float(rng.uniform(0.0, outline.face_width)),
        outline.numbers.module * float(rng.uniform(0.1, 0.4)),
    )  # fmt: skip
