"""The families: each draws its scans from its own seed. A letter, what it is, and a function from a generator to a case."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.families import draws, effects
from benchmarks.families.case import Case
from benchmarks.families.draws import Rng, log_uniform
from benchmarks.families.fields import EndRelief, Even, Field, Index, Polynomial, Relief, Ripple, RoundWave, Within
from benchmarks.families.instrument import AlongAxis, Between, Coat, OneSide, Outer, RoundGear, Sector, Turntable, Unseen
from benchmarks.families.part import Part
from benchmarks.families.rack import Tool
from benchmarks.families.scanner import ViewError

POINTS = 40_000
STEPS = {0: "by chance", 2: "every second", 3: "every third", 4: "every fourth", 6: "every sixth"}
MATES = 1.0 / 6.0
"""Share of the scans with sliding wear whose design has a mate: contact takes most of the time then."""

AS_CUT = (
    "pitch", "thickness_variation", "tooth_thickness", "profile_shift", "profile_slope", "profile_crowning", "helix_slope", "helix_crowning", "taper",
    "twist", "eccentricity", "axis_offset_lateral",
)  # fmt: skip
"""What may be named of a gear that is cut in a class."""
RELIEFS = ("tip_relief", "root_relief", "end_relief")


@dataclass(frozen=True)
class Family:
    """A kind of hard case.

    Parameters
    ----------
    title : str
    draw : callable
        Of a random generator and the number of points: the keys of a `Case` but family, number and seed.
    """

    title: str
    draw: Callable[[Rng, int], dict[str, Any]]


def case(family: str, number: int, seed: int, points: int = POINTS) -> Case:
    """A scan of a family by its number; it depends on nothing else.

    Parameters
    ----------
    family : str
        A letter of `FAMILIES`.
    number : int
    seed : int
        Of the study.
    points : int
        Of the scan, about.
    """
    rng = np.random.default_rng([seed, ord(family), number])
    keys = FAMILIES[family].draw(rng, points)
    return Case(family=family, number=number, seed=int(rng.integers(2**31)), **({"mate": 0} | keys))


def _plain(rng: Rng, mate: bool = False) -> tuple[Any, tuple[Tool, ...], Any]:
    g, tools = draws.gear(rng, mate), (draws.plain_tool(rng),)
    return g, tools, draws.frame(g, tools)


def _also(scanner: Any) -> tuple[str, ...]:
    """An edge that the spot rounds may be named."""
    return ("edge_rounding",) if scanner.edge > 0.0 else ()


def _root(rng: Rng, points: int) -> dict[str, Any]:
    drawn = draws.gear(rng)
    g = replace(
        drawn,
        face_width=round(drawn.face_width + float(rng.uniform(-0.15, 0.15)), 3),
        tip_change=-float(rng.uniform(0.0, 0.2)) * (drawn.tip_radius / 50.0) ** (1.0 / 3.0),
    )
    what = str(rng.choice(["0.25", "0.30", "0.38", "full fillet", "ground", "protuberance"]))
    deep = float(rng.choice([1.25, 1.25, 1.27, 1.30]))
    match what:
        case "full fillet":
            tools: tuple[Tool, ...] = (Tool(deep, math.inf),)
        case "ground":
            stock = float(rng.uniform(0.02, 0.04)) * g.module
            tools = (Tool(1.35, 0.30, stock=stock), Tool(float(rng.uniform(1.0, 1.1)), 0.10))
        case "protuberance":
            stock = float(rng.uniform(0.02, 0.04)) * g.module
            tools = (Tool(1.40, 0.38, stock=stock, protuberance=stock * float(rng.uniform(1.1, 1.6))), Tool(1.10, 0.10))
        case _:
            tools = (Tool(deep, float(what)),)
    f = draws.frame(g, tools)
    design = draws.design_of(drawn, None)
    for key in ("dedendum", "addendum"):
        if rng.random() < 0.5:
            del design[key]
    if rng.random() < 0.5:
        design["rack_tip_radius"] = float(rng.choice([0.25, 0.30, 0.38]))
    wear: tuple[Field, ...] = draws.patches(rng, f)
    if rng.random() < 0.35:
        wear = (*wear[:1], draws.sliding(rng, f, int(rng.choice([-1, 1])), log_uniform(rng, 0.008, 0.03) * g.module, False))
    scanner = draws.scanner(rng, g, points)
    return {
        "what": what, "part": Part(g, tools, (), wear), "design": design, "scanner": scanner,
        "may_name": ("tip_diameter", *_also(scanner)),
    }  # fmt: skip


def _profiles(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    design = draws.design_of(g, tools[0])
    size, span = log_uniform(rng, 0.006, 0.03), f.tip - f.form
    what = str(
        rng.choice(
            ["parabolic relief", "end relief", "two harmonics", "encoder", "pressure angle 20.5", "base pitch", "profile ripple"]
        )
    )
    made: tuple[Field, ...] = ()
    shifts: tuple[Any, ...] = ()
    near: tuple[str, ...] = ()
    may: tuple[str, ...] = ()
    outside = what
    phases = rng.uniform(0.0, 2.0 * math.pi, 2)
    match what:
        case "parabolic relief":
            made, near = (Relief(2.0 * size, f.form + float(rng.uniform(0.4, 0.7)) * span, 2.0),), ("tip_relief",)
        case "end relief":
            made = (EndRelief(1.5 * size, float(rng.uniform(0.1, 0.3)) * f.width),)
            near = ("end_relief", "helix_crowning")
        case "two harmonics":
            low, high = float(rng.uniform(2.2, 4.8)), float(rng.uniform(5.2, 9.8))
            made = (RoundWave(0.7 * size, low, float(phases[0])), RoundWave(0.5 * size, high, float(phases[1])))
            near = ("turntable_angle", "pitch", "scan_drift")
        case "encoder":
            shifts, near = (Turntable(60.0, 0.5 * size / g.base_radius, float(phases[0])),), ("turntable_angle",)
        case "pressure angle 20.5":
            g = replace(g, pressure_angle=20.5)
            may, outside = ("profile_slope", "tooth_thickness"), ""
        case "base pitch":
            g = replace(g, pressure_angle=20.0 + float(rng.choice([-1.0, 1.0]) * rng.uniform(0.04, 0.15)))
            may, outside = ("profile_slope", "tooth_thickness"), ""
        case _:
            waves = (float(rng.uniform(1.3, 1.8)), float(rng.uniform(2.2, 3.8)))
            made = (Ripple((0.5 * size, 0.3 * size), waves, (float(phases[0]), float(phases[1]))),)
            near = ("profile_crowning",)
    f = draws.frame(g, tools)
    scanner = draws.scanner(rng, g, points, shifts=shifts)
    part = Part(g, tools, made, draws.patches(rng, f))
    return {
        "what": what, "part": part, "design": design, "scanner": scanner, "near": near, "outside": outside,
        "may_name": (*may, *_also(scanner)),
    }  # fmt: skip


def _density(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    ratio, towards = float(rng.choice([4.0, 10.0, 30.0])), float(rng.uniform(-math.pi, math.pi))
    how = str(rng.choice(["round the gear", "round the gear, at once", "along the axis"]))
    weight = AlongAxis(ratio, bool(rng.random() < 0.5)) if how == "along the axis" else RoundGear(ratio, towards, "once" in how)
    scanner = draws.scanner(rng, g, points, weights=(weight,))
    part = Part(g, tools, (), draws.patches(rng, f, 2, 3))
    return {
        "what": f"{ratio:.0f} times {how}", "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner,
        "may_name": _also(scanner),
    }  # fmt: skip


def _partial(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    what = str(rng.choice(["a third of the teeth", "one side", "tops", "without ends"]))
    limits: dict[str, Any] = {}
    weight: Any
    match what:
        case "a third of the teeth":
            first, number = int(rng.integers(g.teeth)), max(g.teeth // 3, 5)
            weight, limits = Sector(first, number), {"teeth": [(first + i) % g.teeth for i in range(1, number - 1)]}
        case "one side":
            side = int(rng.choice([-1, 1]))
            weight, limits = OneSide(side), {"sides": [side]}
        case "tops":
            radius = g.reference_radius - 0.1 * g.module
            share = (g.roll(radius) - f.form) / (f.tip - f.form)
            weight, limits = Outer(radius), {"roll": (share, 1.1)}
        case _:
            weight, limits = Between(0.06 * g.face_width, 0.94 * g.face_width), {"z": (0.08, 0.92)}
    scanner = draws.scanner(rng, g, points, weights=(weight,))
    part = Part(g, tools, (), draws.patches(rng, f, **limits))
    return {"what": what, "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner, "may_name": _also(scanner)}


def _views(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    what = str(rng.choice(["a view out of scale", "badly stitched", "fringes"]))
    more: dict[str, Any] = {}
    may: tuple[str, ...] = ("view_registration",)
    base = draws.scanner(rng, g, points)
    sector = base.views.sector(int(rng.integers(4)), 4)
    outside = what
    match what:
        case "a view out of scale":
            errors = (ViewError(sector, scale=float(rng.choice([-1.0, 1.0])) * log_uniform(rng, 4e-4, 3e-3)),)
            more = {"files": int(rng.choice([1, 4]))}
        case "badly stitched":
            turn, shift = rng.normal(0.0, 2e-4, 3), rng.normal(0.0, 0.006, 3) * g.module
            errors = (ViewError(sector, tuple(turn.tolist()), tuple(shift.tolist())),)
        case _:
            errors = (
                ViewError((), amplitude=log_uniform(rng, 0.002, 0.008), wavelength=float(rng.uniform(0.5, 3.0)) * g.module,
                          across=float(rng.uniform(0.0, math.pi)), phase=float(rng.uniform(0.0, 6.0))),
            )  # fmt: skip
            may = ()
    scanner = replace(base, view_errors=errors, **more)
    part = Part(g, tools, (), draws.patches(rng, f))
    return {
        "what": what, "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner, "outside": outside,
        "may_name": (*may, *_also(scanner)),
    }  # fmt: skip


def _breakage(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    what = str(rng.choice(["missing tooth", "broken corner", "chipped edge", "unseen tooth"]))
    tooth = int(rng.integers(g.teeth))
    part = Part(g, tools, (), draws.patches(rng, f, teeth=[k for k in range(g.teeth) if k != tooth]))
    more: dict[str, Any] = {}
    unseen: tuple[int, ...] = ()
    if what == "unseen tooth":
        more, unseen = {"weights": (Unseen(tooth),)}, (tooth,)
    else:
        part = replace(part, cuts=(draws.cut(rng, part, tooth, what),))
    scanner = draws.scanner(rng, g, points, **more)
    return {
        "what": what, "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner, "unseen": unseen,
        "may_name": _also(scanner),
    }  # fmt: skip


def _both(rng: Rng, points: int) -> dict[str, Any]:
    mate = bool(rng.random() < MATES)
    g, tools, f = _plain(rng, mate)
    alike = bool(rng.random() < 0.5)
    depth = log_uniform(rng, 0.008, 0.03) * g.module
    sides = (depth, depth * float(rng.uniform(0.4, 1.0)))
    first = int(rng.choice([-1, 1]))
    wear = tuple(draws.sliding(rng, f, s, d, alike) for s, d in zip((first, -first), sides, strict=True))
    scanner = draws.scanner(rng, g, points)
    return {
        "what": "teeth alike" if alike else "each tooth otherwise", "part": Part(g, tools, (), wear),
        "design": draws.design_of(g, tools[0]), "mate": 2 * g.teeth if mate else 0, "scanner": scanner, "may_name": _also(scanner),
    }  # fmt: skip


def _sizes(rng: Rng, points: int) -> dict[str, Any]:
    teeth, module = round(log_uniform(rng, 7.6, 80.4)), round(log_uniform(rng, 0.5, 10.0), 2)
    shift = 0.5 if teeth < 12 else float(rng.choice([0.0, 0.2]))
    g = replace(draws.gear(rng), teeth=teeth, module=module, profile_shift=shift, thinning=0.0,
                face_width=round(module * float(rng.uniform(2.5, 5.0)), 2))  # fmt: skip
    tools = (draws.plain_tool(rng),)
    f = draws.frame(g, tools)
    scanner = draws.scanner(rng, g, int(points * min(max(teeth / 25.0, 1.0), 1.5)))
    part = Part(g, tools, (), draws.patches(rng, f, least=0.012))
    what = f"z {'8 to 15' if teeth < 16 else '16 to 30' if teeth <= 30 else '31 to 80'}"
    return {"what": what, "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner, "may_name": _also(scanner)}


def _null(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    worn = bool(rng.random() < 0.5)
    scanner = draws.scanner(rng, g, points)
    part = Part(g, tools, (), draws.patches(rng, f) if worn else ())
    return {
        "what": "patches of wear" if worn else "unworn", "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner,
        "may_name": _also(scanner),
    }  # fmt: skip


def _catalogue(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    cell = 3.0 * math.sqrt(12.0 * 2.8 * g.module * g.teeth * g.face_width / points)
    names = [str(n) for n in rng.choice(effects.NAMES, int(rng.integers(1, 3)), replace=False)]
    drawn = [effects.draw(name, log_uniform(rng, 0.004, 0.04), g, f, cell, rng) for name in names]
    made = tuple(d[0] for d in drawn if d[0] is not None)
    shifts = tuple(d[1] for d in drawn if d[1] is not None)
    scanner = draws.scanner(rng, g, points, shifts=shifts)
    part = Part(g, tools, made, draws.patches(rng, f, 0, 2))
    return {
        "what": f"{len(names)} effect{'s' if len(names) > 1 else ''}", "part": part, "design": draws.design_of(g, tools[0]),
        "scanner": scanner, "declared": tuple(d[2] for d in drawn), "may_name": _also(scanner),
    }  # fmt: skip


def _local(rng: Rng, points: int) -> dict[str, Any]:
    what = str(rng.choice(["pits", "burr beside sliding wear", "scoring"]))
    mate = what == "burr beside sliding wear" and bool(rng.random() < MATES)
    g, tools, f = _plain(rng, mate)
    made: tuple[Field, ...] = ()
    side = int(rng.choice([-1, 1]))
    match what:
        case "pits":
            wear: tuple[Field, ...] = (draws.pits(rng, f),)
        case "scoring":
            wear = (draws.scores(rng, f),)
        case _:
            wear = (draws.sliding(rng, f, side, log_uniform(rng, 0.008, 0.03) * g.module, False),)
            made = (draws.burr(rng, f, side),)
    scanner = draws.scanner(rng, g, points)
    return {
        "what": what, "part": Part(g, tools, made, wear), "design": draws.design_of(g, tools[0]), "scanner": scanner, "fine": True,
        "mate": 2 * g.teeth if mate else 0, "may_name": ("burr", *_also(scanner)) if made else _also(scanner),
    }  # fmt: skip


def _side(rng: Rng, points: int) -> dict[str, Any]:
    mate = bool(rng.random() < MATES)
    g, tools, f = _plain(rng, mate)
    even = float(rng.choice([0.0, 0.0, 0.3]))
    alike = bool(rng.random() < 0.4)
    side = int(rng.choice([-1, 1]))
    wear: tuple[Field, ...] = (draws.sliding(rng, f, side, log_uniform(rng, 0.004, 0.03) * g.module, alike, even),)
    if rng.random() < 0.4:
        wear = (*wear, *draws.patches(rng, f, 1, 2, sides=[side]))
    scanner = draws.scanner(rng, g, points)
    return {
        "what": "with an even loss" if even else "sliding only", "part": Part(g, tools, (), wear),
        "design": draws.design_of(g, tools[0]), "mate": 2 * g.teeth if mate else 0, "scanner": scanner, "may_name": _also(scanner),
    }  # fmt: skip


def _processed(rng: Rng, points: int) -> dict[str, Any]:
    g, tools, f = _plain(rng)
    what = str(rng.choice(["smoothed", "smoothed, thinned by voxels", "thinned by voxels", "thinned where flat"]))
    smoothing = int(rng.choice([6, 10, 16])) if "smoothed" in what else 0
    thinning = {"smoothed": "random", "thinned where flat": "curvature"}.get(what, "voxel")
    scanner = draws.scanner(rng, g, 3 * points, smoothing=smoothing, thinning=thinning, left=points)
    part = Part(g, tools, (), draws.patches(rng, f))
    return {
        "what": what, "part": part, "design": draws.design_of(g, tools[0]), "scanner": scanner,
        "may_name": ("edge_rounding",) if smoothing else _also(scanner),
        # a mean over neighbours fills hollows and takes from what bulges: edges, fillets, and flanks near their root
        "near": ("occlusion", "profile_crowning", "root_relief") if smoothing else (),
    }  # fmt: skip


def _as_drawn(rng: Rng, points: int) -> dict[str, Any]:
    """Relief, crowning and slopes that the drawing tells: nothing of them is to be named, and wear is what is missing from them."""
    g, tools, f = _plain(rng)
    design, span = draws.design_of(g, tools[0]), f.tip - f.form
    made: list[Field] = []
    names = sorted(
        str(n)
        for n in rng.choice(["tip_relief", "root_relief", "profile_crowning", "helix_crowning", "end_relief"], 2, replace=False)
    )
    for name in names:
        amount = round(log_uniform(rng, 0.01, 0.05), 4)
        design[name] = amount
        match name:
            case "tip_relief" | "root_relief":
                root, power = name == "root_relief", float(rng.choice([1.0, 2.0]))
                length = round(float(rng.uniform(0.25, 0.5)) * span, 3)
                made.append(Relief(amount, f.form + length if root else f.tip - length, power, root))
                design |= {f"{name}_length": length, f"{name}_form": "linear" if power == 1.0 else "parabolic"}
            case "profile_crowning":
                made.append(Polynomial(-amount, 2))
            case "helix_crowning":
                made.append(Polynomial(-4.0 * amount, 0, 2))
            case _:
                length = round(float(rng.uniform(0.1, 0.3)) * f.width, 3)
                made.append(EndRelief(amount, length))
                design |= {"end_relief_length": length, "end_relief_form": "parabolic"}
    wear: tuple[Field, ...] = draws.patches(rng, f)
    if rng.random() < 0.35:
        wear = (*wear[:1], draws.sliding(rng, f, int(rng.choice([-1, 1])), log_uniform(rng, 0.008, 0.03) * g.module, False))
    scanner = draws.scanner(rng, g, points)
    return {
        "what": " and ".join(names), "part": Part(g, tools, tuple(made), wear), "design": design, "scanner": scanner, "may_name": _also(scanner),
    }  # fmt: skip


def _as_cut(rng: Rng, points: int) -> dict[str, Any]:
    """Errors of class 6 to 10 that the drawing does not tell: right to name are those that are there, and none need be."""
    return _cut_and_worn(rng, points, 6, draws.as_cut)


def _each_flank(rng: Rng, points: int) -> dict[str, Any]:
    """The same of class 5 to 9, with every flank cut as itself besides."""
    return _cut_and_worn(rng, points, 5, draws.each_flank)


def _cut_and_worn(rng: Rng, points: int, best: int, cut: Callable[[Rng, draws.Frame, int], tuple[Field, ...]]) -> dict[str, Any]:
    """A gear of one of five classes, the `best` first; unworn, or worn in patches, on one side or both."""
    g, tools, f = _plain(rng)
    quality = int(rng.integers(best, best + 5))
    what = str(rng.choice(["unworn", "patches", "one side", "both sides"]))
    side, depth = int(rng.choice([-1, 1])), log_uniform(rng, 0.006, 0.03) * g.module
    match what:
        case "unworn":
            wear: tuple[Field, ...] = ()
        case "patches":
            wear = draws.patches(rng, f, least=0.012)
        case "one side":
            wear = (draws.sliding(rng, f, side, depth, False),)
        case _:
            wear = tuple(draws.sliding(rng, f, s, d, False) for s, d in ((side, depth), (-side, 0.6 * depth)))
    design = draws.design_of(g, tools[0])
    if rng.random() < 0.5:
        del design["rack_tip_radius"]
    scanner = draws.scanner(rng, g, points)
    return {
        "what": what, "part": Part(g, tools, cut(rng, f, quality), wear), "design": design, "scanner": scanner,
        "may_name": (*AS_CUT, *_also(scanner)), "near": RELIEFS, "outside": f"form errors of class {quality}",
    }  # fmt: skip


def _some_flanks(rng: Rng, points: int) -> dict[str, Any]:
    g = replace(draws.gear(rng), teeth=int(rng.choice([18, 20, 22, 24, 25, 36])))
    tools = (draws.plain_tool(rng),)
    f, z = draws.frame(g, tools), g.teeth
    step = int(rng.choice([2, 3, 4, 6, 0, 0]))
    if step:
        which = np.arange(int(rng.integers(step)), z - z % step, step)
    else:
        which = rng.permutation(z)[: max(2, round(float(rng.uniform(0.2, 0.5)) * z))]
    factors = np.zeros(z)
    factors[which] = rng.uniform(0.6, 1.4, len(which)) if rng.random() < 0.4 else 1.0
    side, depth, even = int(rng.choice([-1, 1])), log_uniform(rng, 0.015, 0.09), bool(rng.random() < 0.5)
    lost = tuple(factors.tolist())
    wear = Even(side, depth, lost) if even else replace(draws.sliding(rng, f, side, depth, True), factors=lost)
    beside = str(rng.choice(["nothing", "a coat", "the table", "index errors", "runout", "a coat and the table"]))
    made: tuple[Field, ...] = ()
    shifts: tuple[Any, ...] = ()
    declared: list[dict[str, Any]] = []
    may: tuple[str, ...] = ()
    if "coat" in beside:
        thick = float(rng.uniform(0.006, 0.02))
        shifts = (*shifts, Coat(thick))
        declared.append({"name": "coating", "parameters": {"thickness_um": 1e3 * thick}})
    if "table" in beside:
        angle, order = math.radians(float(rng.uniform(0.005, 0.02))), int(rng.integers(1, 9))
        shifts = (*shifts, Turntable(order, angle, float(rng.uniform(0.0, 2.0 * math.pi))))
        declared.append({"name": "turntable_angle", "parameters": {"order": order, "amplitude_deg": math.degrees(angle)}})
    if beside == "index errors":
        arcs = effects.index(z, float(rng.uniform(0.003, 0.008)), rng)
        made = (Index(arcs),)
        declared.append({"name": "pitch", "parameters": {"index_um": [1e3 * arc for arc in arcs]}})
    if beside == "runout":
        made = (RoundWave(float(rng.uniform(0.003, 0.015)), 1.0, float(rng.uniform(0.0, 2.0 * math.pi))),)
        may = ("pitch", "eccentricity", "turntable_angle", "axis_offset_lateral")
    scanner = draws.scanner(rng, g, points, shifts=shifts)
    return {
        "what": f"{len(which)} of {z}, {STEPS[step]}, {'even' if even else 'sliding'}, beside {beside}",
        "part": Part(g, tools, made, (wear,)), "design": draws.design_of(g, tools[0]), "scanner": scanner,
        "declared": tuple(declared), "may_name": (*may, *_also(scanner)),
    }  # fmt: skip


def _files(rng: Rng, points: int) -> dict[str, Any]:
    """Three to six files, each of the views of one sector, and one fault in one of them."""
    g, tools, f = _plain(rng)
    files, worn = int(rng.choice([3, 4, 5, 6])), str(rng.choice(["unworn", "patches", "a side"], p=[0.3, 0.4, 0.3]))
    fault = str(rng.choice(["scale", "offset", "moved", "half moved", "none"], p=[0.4, 0.25, 0.1, 0.05, 0.2]))
    which, sign = int(rng.integers(files)), float(rng.choice([-1.0, 1.0]))
    base = draws.scanner(rng, g, points)
    views = replace(base.views, azimuths=4 * files)
    sector = views.sector(which, files)
    match fault:
        case "scale":
            errors: tuple[ViewError, ...] = (ViewError(sector, scale=sign * log_uniform(rng, 5e-4, 3e-3)),)
        case "offset":
            errors = (ViewError(sector, offset=sign * float(rng.uniform(0.005, 0.02))),)
        case "moved" | "half moved":
            way, axis = (v / np.linalg.norm(v) for v in rng.standard_normal((2, 3)))
            shift, turn = float(rng.uniform(0.01, 0.06)) * way, math.radians(float(rng.uniform(0.02, 0.1))) * axis
            half = sector if fault == "moved" else views.sector(2 * which, 2 * files)
            errors = (ViewError(half, tuple(turn.tolist()), tuple(shift.tolist())),)
        case _:
            errors = ()
    wear: tuple[Field, ...] = ()
    if worn == "patches":
        wear = draws.patches(rng, f)
    elif worn == "a side":
        wear = (draws.sliding(rng, f, int(rng.choice([-1, 1])), log_uniform(rng, 0.006, 0.03) * g.module, False),)
    scanner = replace(base, views=views, files=files, view_errors=errors)
    wrong = fault in ("scale", "offset", "half moved")
    return {
        "what": fault, "part": Part(g, tools, (), wear), "design": draws.design_of(g, tools[0]), "scanner": scanner,
        "outside": "half moved" if fault == "half moved" else "", "may_name": (*(("view_registration",) if wrong else ()), *_also(scanner)),
    }  # fmt: skip


def _narrow_mate(rng: Rng, points: int) -> dict[str, Any]:
    """Worn by a mate that is narrower than the face: flanks as cut beside it at one end or both; exact, or cut in class 5 to 8."""
    g, tools, f = _plain(rng)
    quality = int(rng.choice([0, 5, 6, 7, 8]))
    low, high = (float(rng.uniform(0.08, 0.25)) * f.width * (rng.random() < 0.85) for _ in range(2))
    if low == high == 0.0:
        high = 0.2 * f.width
    edge = log_uniform(rng, 0.05, 0.5)
    depth, even, alike = log_uniform(rng, 0.010, 0.08), bool(rng.random() < 0.4), bool(rng.random() < 0.5)
    first, both = int(rng.choice([-1, 1])), bool(rng.random() < 0.5)
    wear = []
    for side, deep in ((first, depth), (-first, depth * float(rng.uniform(0.4, 1.0))))[: 1 + both]:
        loss = draws.sliding(rng, f, side, deep, alike)
        own = Even(side, deep, loss.factors) if even else loss
        wear.append(Within(own, low if low > 0.0 else -edge, f.width - high if high > 0.0 else f.width + edge, edge))
    made = draws.as_cut(rng, f, quality) if quality else ()
    scanner = draws.scanner(rng, g, points)
    return {
        "what": f"{'both sides' if both else 'one side'}, ledges at {'both ends' if low > 0.0 < high else 'one end'}, {'even' if even else 'sliding'}",
        "part": Part(g, tools, tuple(made), tuple(wear)), "design": draws.design_of(g, tools[0]), "scanner": scanner,
        "may_name": (*(AS_CUT if quality else ()), *_also(scanner)), "near": RELIEFS,
        "outside": f"form errors of class {quality}" if quality else "",
    }  # fmt: skip


FAMILIES: Mapping[str, Family] = {
    "a": Family("unknown root", _root),
    "b": Family("modified profiles", _profiles),
    "c": Family("uneven density", _density),
    "d": Family("partial coverage", _partial),
    "e": Family("bad views", _views),
    "f": Family("breakage", _breakage),
    "g": Family("both sides worn", _both),
    "h": Family("other sizes", _sizes),
    "i": Family("null", _null),
    "j": Family("effects of the catalogue", _catalogue),
    "k": Family("pits, burrs, scoring", _local),
    "l": Family("a whole side worn", _side),
    "m": Family("smoothed or thinned", _processed),
    "n": Family("modified as drawn", _as_drawn),
    "o": Family("class 6 to 10 as cut", _as_cut),
    "p": Family("some flanks worn all over", _some_flanks),
    "q": Family("several files, one of them wrong", _files),
    "r": Family("class 5 to 9, every flank cut as itself", _each_flank),
    "s": Family("a mate narrower than the face", _narrow_mate),
}
