"""What the families share: gears, wear, textures and scanners at random."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from benchmarks.families.breakage import Cut, roughness
from benchmarks.families.fields import (
    Burr,
    EachFlank,
    EndRelief,
    Field,
    Frame,
    Hollow,
    Index,
    Pits,
    Polynomial,
    Ripple,
    RoundWave,
    Scores,
    Sliding,
)
from benchmarks.families.gear import GearNumbers
from benchmarks.families.part import Part
from benchmarks.families.rack import Tool
from benchmarks.families.scanner import Hole, Scanner
from benchmarks.families.section import section
from benchmarks.families.texture import Texture
from benchmarks.families.views import Views

Rng = np.random.Generator


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """Between two positive numbers, alike on a logarithmic scale."""
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def gear(rng: Rng, mate: bool = False) -> GearNumbers:
    """A gear of common size; one that must run with its mate at the standard distance is unshifted."""
    module = float(rng.choice([2.0, 2.5, 3.0, 4.0, 5.0]))
    return GearNumbers(
        teeth=int(rng.integers(20 if mate else 16, 29)),
        module=module,
        face_width=round(module * float(rng.uniform(2.5, 5.0)), 1),
        profile_shift=0.0 if mate else float(rng.choice([0.0, 0.2])),
        thinning=round(float(rng.choice([0.0, 0.02])) * module, 3),
    )


def design_of(g: GearNumbers, tool: Tool | None) -> dict[str, Any]:
    """The true design as the keys of a file, as a drawing would give it."""
    keys: dict[str, Any] = {
        "teeth": g.teeth, "module": g.module, "pressure_angle": g.pressure_angle, "face_width": g.face_width,
        "profile_shift": g.profile_shift, "addendum": g.addendum, "dedendum": g.dedendum, "thinning": g.thinning,
    }  # fmt: skip
    if tool is not None:
        keys["rack_tip_radius"] = tool.tip_radius
    if g.bore:
        keys["bore_diameter"] = g.bore
    return keys


def plain_tool(rng: Rng) -> Tool:
    """A hob with a round tip."""
    return Tool(1.25, float(rng.choice([0.25, 0.30, 0.38])))


def frame(g: GearNumbers, tools: tuple[Tool, ...]) -> Frame:
    """Of a gear that these tools cut."""
    return Frame.of(g, section(g, tools).form_roll)


def patches(rng: Rng, f: Frame, low: int = 1, high: int = 3, least: float = 0.008, **where: Any) -> tuple[Hollow, ...]:
    """Smooth patches on different flanks, 0.008 to 0.05 modules deep.

    Parameters
    ----------
    rng : numpy.random.Generator
    f : Frame
    low, high : int
        How many.
    least : float
        Least depth, modules.
    where : teeth, sides, roll, z
        Sequences to choose from; ranges (as shares) for the whole patch.
    """
    teeth, sides = list(where.get("teeth", range(f.teeth))), list(where.get("sides", (1, -1)))
    flanks = [(k, s) for k in teeth for s in sides]
    chosen = rng.permutation(len(flanks))[: int(rng.integers(low, high + 1))]
    r0, r1 = where.get("roll", (0.05, 1.1))
    z0, z1 = where.get("z", (-0.2, 1.2))
    result = []
    for i in chosen:
        k, s = flanks[int(i)]
        half_roll, half_z = 0.5 * (r1 - r0) * float(rng.uniform(0.45, 0.95)), 0.5 * (z1 - z0) * float(rng.uniform(0.35, 0.9))
        at, up = float(rng.uniform(r0 + half_roll, r1 - half_roll)), float(rng.uniform(z0 + half_z, z1 - half_z))
        span = f.tip - f.form
        depth = log_uniform(rng, least, 0.05) * f.module
        result.append(Hollow(k, s, depth, f.form + at * span, up * f.width, half_roll * span, half_z * f.width))
    return tuple(result)


def sliding(rng: Rng, f: Frame, side: int, depth: float, alike: bool, even: float = 0.0) -> Sliding:
    """Loss with the sliding on a whole side."""
    factors = np.ones(f.teeth) if alike else rng.uniform(0.6, 1.4, f.teeth)
    return Sliding(side, depth, tuple(factors.tolist()), 2.0, even)


def as_cut(rng: Rng, f: Frame, quality: int) -> tuple[Field, ...]:
    """What a gear of a class of ISO 1328-1:2013 shows: each side cut in a pass of its own, so with slopes, crownings and a form of its own, as far as
    the tolerances of the class go; teeth off their places, once round the gear besides; all teeth thinner or thicker alike."""
    grade, d = 1e-3 * math.sqrt(2.0) ** (quality - 5), f.module * f.teeth
    slope, form = (0.4 * f.module + 0.001 * d + 4.0) * grade, (0.55 * f.module + 5.0) * grade
    helix = (0.05 * math.sqrt(d) + 0.35 * math.sqrt(f.width) + 4.0) * grade
    pitch = (0.001 * d + 0.4 * f.module + 5.0) * grade
    fields: list[Field] = []
    for side in (-1, 1):
        rise, bow, lean, along = (float(v) for v in rng.uniform(-0.5, 0.5, 4))
        waves, phases = rng.uniform(1.0, 3.0, 2), rng.uniform(0.0, 2.0 * math.pi, 2)
        sizes = rng.uniform(0.05, 0.4, 2) * form
        fields += [
            Polynomial(rise * slope, 1, 0, side), Polynomial(-bow * form, 2, 0, side), Polynomial(2.0 * lean * helix, 0, 1, side),
            Polynomial(-4.0 * along * helix, 0, 2, side),
            Ripple((float(sizes[0]), float(sizes[1])), (float(waves[0]), float(waves[1])), (float(phases[0]), float(phases[1])), side),
        ]  # fmt: skip
    thickness = float(rng.uniform(-0.030, 0.030))
    arcs = 0.5 * pitch * rng.standard_normal(f.teeth)
    return (
        *fields,
        Polynomial(0.5 * thickness * f.cos),
        Index(tuple((arcs - arcs.mean()).tolist())),
        RoundWave(float(rng.uniform(0.3, 1.0)) * pitch, 1.0, float(rng.uniform(0.0, 2.0 * math.pi))),
    )


def each_flank(rng: Rng, f: Frame, quality: int) -> tuple[Field, ...]:
    """What `as_cut` draws, and every flank besides as itself: left and right pitch go their own ways, slopes and leads differ from flank to flank; on half of
    the gears the ends are relieved."""
    grade, d = 1e-3 * math.sqrt(2.0) ** (quality - 5), f.module * f.teeth
    pitch, slope, helix = 0.4 * f.module + 0.001 * d + 5.0, 0.4 * f.module + 4.0, 0.35 * math.sqrt(f.width) + 4.0

    def drawn(size: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        left, right = (size * grade * rng.standard_normal((2, f.teeth))).tolist()
        return tuple(left), tuple(right)

    flanks = EachFlank(drawn(0.35 * pitch), drawn(0.2 * slope), drawn(0.2 * helix))
    ends = (EndRelief(float(rng.uniform(0.008, 0.02)), float(rng.uniform(0.06, 0.15)) * f.width),) if rng.random() < 0.5 else ()
    return (*as_cut(rng, f, quality), flanks, *ends)


def texture(rng: Rng, scale: float = 1.0) -> Texture | None:
    """None in one scan of seven; else two scales of 0.3 to 3 µm."""
    if rng.random() < 1.0 / 7.0:
        return None
    lengths = (log_uniform(rng, 0.25, 1.0) * scale, log_uniform(rng, 1.0, 4.0) * scale)
    return Texture(tuple(float(rng.uniform(0.0003, 0.003)) * min(scale, 1.5) for _ in lengths), lengths)


def scanner(rng: Rng, g: GearNumbers, points: int, **more: Any) -> Scanner:
    """A good scanner fit for the size of the gear; `more` replaces what it draws."""
    scale = min(max(g.module / 3.0, 0.25), 2.0)
    holes = tuple(_hole(rng, g) for _ in range(int(rng.integers(0, 3))))
    drawn: dict[str, Any] = {
        "points": points,
        "noise": float(rng.uniform(0.003, 0.008)) * scale,
        "texture": texture(rng, scale),
        "views": Views(int(rng.integers(12, 19)), (-40.0, 0.0, 40.0), turn=float(rng.uniform(0.0, 30.0))),
        "edge": float(rng.choice([0.0, 0.02, 0.04])) * g.module,
        "strays": float(rng.choice([0.0, 0.0005, 0.002])),
        "holes": holes,
        "pose": str(rng.choice(["any", "mild"])),
    }
    return Scanner(**(drawn | more))


def _hole(rng: Rng, g: GearNumbers) -> Hole:
    rho, theta = float(rng.uniform(g.root_radius, g.tip_radius)), float(rng.uniform(0.0, 2.0 * math.pi))
    centre = (rho * math.cos(theta), rho * math.sin(theta), float(rng.uniform(0.0, g.face_width)))
    return Hole(centre, g.module * float(rng.uniform(0.1, 0.35)))


# What runs off: pits, grooves, burrs, pieces ------------------------------------------------------------------------


def pits(rng: Rng, f: Frame) -> Pits:
    """Clusters of small pits just below the pitch line of three to six flanks."""
    rows = []
    for flank in rng.permutation(2 * f.teeth)[: int(rng.integers(3, 7))]:
        side = 1.0 if flank % 2 else -1.0
        middle = float(rng.uniform(0.2, 0.8)) * f.width
        for _ in range(int(rng.integers(8, 30))):
            radius = log_uniform(rng, 0.03, 0.11) * f.module
            roll = float(np.clip(f.reference - abs(rng.normal(0.25, 0.25)) * f.module, f.form + 2.5 * radius, f.tip - radius))
            z = float(np.clip(rng.normal(middle, 0.15 * f.width), radius, f.width - radius))
            rows.append((float(flank // 2), side, roll, z, radius, radius * float(rng.uniform(0.2, 0.5))))
    return Pits(tuple(rows))


def scores(rng: Rng, f: Frame) -> Scores:
    """Grooves up and down the profile on all flanks of a side, or on some."""
    side = float(rng.choice([-1.0, 1.0]))
    rows = []
    for tooth in rng.permutation(f.teeth)[: int(rng.integers(2, f.teeth + 1))]:
        for _ in range(int(rng.integers(3, 12))):
            width = log_uniform(rng, 0.06, 0.25) * f.module
            z = float(rng.uniform(width, f.width - width))
            rows.append((float(tooth), side, z, width, log_uniform(rng, 0.006, 0.03) * f.module))
    return Scores(tuple(rows))


def burr(rng: Rng, f: Frame, side: int) -> Burr:
    """Beside the tip of a worn side."""
    return Burr(
        side, log_uniform(rng, 0.008, 0.03) * f.module, float(rng.uniform(0.08, 0.15)) * f.module, float(rng.uniform(0, 6))
    )


def cut(rng: Rng, part: Part, tooth: int, kind: str) -> Cut:
    """A piece broken off a tooth.

    Parameters
    ----------
    rng : numpy.random.Generator
    part : Part
        Unbroken.
    tooth : int
    kind : str
        "missing tooth", "broken corner" or "chipped edge".
    """
    g, m = part.gear, part.gear.module
    theta = tooth * g.pitch_angle
    out, beside = np.array([math.cos(theta), math.sin(theta), 0.0]), np.array([-math.sin(theta), math.cos(theta), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    low = rng.random() < 0.5
    end = 0.0 if low else g.face_width
    rough = roughness(0.02 * m, 0.6 * m, rng)
    if kind == "missing tooth":
        height = float(part.section.root_radius[0]) + m * float(rng.uniform(0.35, 0.7))
        normal = out + rng.uniform(-0.25, 0.25) * beside + rng.uniform(-0.06, 0.06) * up
        middle = height * out + 0.5 * g.face_width * up
        return Cut(tooth, kind, middle, normal / np.linalg.norm(normal), 0.0, roughness(0.04 * m, m, rng))
    if kind == "broken corner":
        into = m * float(rng.uniform(0.8, 1.9))
        along = min(m * float(rng.uniform(0.8, 2.0)), 0.6 * g.face_width)
        # through a point `into` below the tip on the end face and one `along` the tip
        normal = out / into + (-up if low else up) / along + rng.uniform(-0.2, 0.2) / into * beside
        point = (g.tip_radius - into) * out + end * up
        return Cut(tooth, kind, point, normal / np.linalg.norm(normal), 0.0, rough)
    radius = m * float(rng.uniform(0.2, 0.45))
    side = float(rng.choice([-1.0, 1.0]))
    half = float(part.gear.half_angle(g.tip_roll))
    edge = g.tip_radius * np.array([math.cos(theta + side * half), math.sin(theta + side * half), 0.0])
    z = float(rng.uniform(radius, g.face_width - radius))
    return Cut(tooth, kind, edge + 0.3 * radius * out + z * up, out, radius, roughness(0.01 * m, 0.3 * m, rng))
