"""Ground gears of dental drives: `inspect` beside the commercial evaluation of the same clouds.

``python benchmarks/dental.py [FOLDER] [--loop | --design]``; FOLDER is ``../shared/real/dental``, whose README tells what is in it. Without it nothing is done. The
evaluation's ranges, section, circles and slope length are set as a user would set them (the options of `gearwear inspect`); its tooth numbers and
sides, and the axis its pitch and runout hang on, are carried over here. Errors of single flanks are 1.4826 MAD: the evaluation has gross errors.
`--design` asks instead what `gearwear design` makes of every cloud: which place module, angle and shift of the drawing have in its ranking.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearwear.comparison.closing import measure
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.files.toml import read_design
from gearwear.identify.candidates import find_candidates
from gearwear.inspection import Inspection, Settings, inspect
from gearwear.scan.reading import read_one

HERE = Path(__file__).resolve().parent
FOLDER = HERE.parent / ".." / "shared" / "real" / "dental"
ROLL, SLOPE_LENGTH = (0.60, 1.33), 0.787
FACE, SECTION, HALF, MIDDLE, HELIX = -36.985, 0.40, 0.12, 0.32, 0.28
"""y of the file where the lower face of all the pinions lies, and from there the profile's section and the middle of the helix, ± half, mm."""
DIAMETER, STRIP, ARC = 3.86, 0.10, 1.13
AXIS_SHARE = 0.28
OUT = 3.0
GOALS = "parts fHa 0.8, ffa 1.2, fHb 0.5, r 0.98; single flanks fHa 1.5, fHb 1.0; Fp, Fr 1.5 about their axis; thickness 1.0"
KEYS = {"fHa": ("profile", "slope"), "ffa": ("profile", "form"), "fHb": ("helix", "slope")}


@dataclass(frozen=True, slots=True)
class Part:
    """One part: what this program and the other found, µm; arrays (teeth, 2), li first, in the other's numbers."""

    name: str
    ours: dict[str, np.ndarray]
    theirs: dict[str, np.ndarray]
    expanded: dict[str, np.ndarray]
    turned: int
    round_it: dict[str, tuple[float, float, float]]


def settings_as(measured: MeasuredGear) -> Settings:
    """The other program's conventions."""
    pose, gear = measured.pose, measured.gear
    section, middle = (
        float((pose.rotation @ np.array([0.0, FACE + above, 0.0]) + pose.translation)[2]) for above in (SECTION, MIDDLE)
    )
    circle = float(np.sqrt((0.5 * DIAMETER) ** 2 - gear.base_radius**2))
    return Settings(
        noise=measured.noise,
        pose_covariance=measured.placed.registration.covariance,
        control_roll=ROLL[0],
        profile_end=ROLL[1],
        slope_length=SLOPE_LENGTH,
        profile_band=(section - HALF, section + HALF),
        helix_between=(middle - HELIX, middle + HELIX),
        helix_band=(circle - STRIP, circle + STRIP),
        pitch_roll=circle,
        pitch_band=(middle - HELIX, middle + HELIX),
    )


def on_flank_axis(measured: MeasuredGear, settings: Settings) -> tuple[Inspection, Inspection]:
    """Inspected about the flanks' own axis, and about the other program's."""
    points, gear = measured.flanks, measured.gear

    def about(axis: np.ndarray) -> Inspection:
        return inspect(points.with_deviation(points.deviation - points.normal[:, :2] @ axis), gear, settings)

    flank = np.zeros(2)
    for _ in range(2):
        found = about(flank)
        assert found.runout is not None
        flank = flank + found.runout.eccentricity.value
    pose = measured.pose
    y = float(np.median(np.concatenate([scan.points for scan in measured.scans])[:, 1]))
    origin = (pose.rotation @ np.array([0.0, y, 0.0]) + pose.translation)[:2]
    return about(flank), about(flank + AXIS_SHARE * (origin - flank))


def in_their_order(values: np.ndarray, up: bool) -> np.ndarray:
    """(teeth, 2) left, right to li, re, teeth counted their way (from any start)."""
    return values[:, ::-1] if up else values[::-1]


def compared(measured: MeasuredGear, name: str, record: dict[str, list[float] | float]) -> Part:
    """One part beside its record; the start of the tooth numbers is the one that suits slopes and forms together best."""
    own, other = on_flank_axis(measured, settings_as(measured))
    up = measured.pose.rotation[2, 1] > 0.0
    theirs = {key: np.column_stack([record[f"{key} li"], record[f"{key} re"]]) for key in KEYS}
    ours, expanded = {}, {}
    for key, (kind, part) in KEYS.items():
        estimate = getattr(getattr(own, kind), part)
        ours[key], expanded[key] = (in_their_order(1e3 * v, up) for v in (estimate.value, estimate.expanded))
    ours["fHb"] = -ours["fHb"]  # theirs: li + towards +y of the file, re opposite, which is a left-hand screw

    def cost(start: int) -> float:
        off = [np.roll(ours[key], start, axis=0) - theirs[key] for key in KEYS]
        return float(sum(np.nanmedian(np.abs(one - np.nanmedian(one, axis=0))) for one in off))

    start = min(range(len(theirs["fHa"])), key=cost)
    ours, expanded = ({key: np.roll(v, start, axis=0) for key, v in values.items()} for values in (ours, expanded))

    def round_it(found: Inspection) -> tuple[float, float, float]:
        assert found.runout is not None
        return (
            ARC * 1e3 * float(np.nanmean(found.pitch.single_greatest.value)),
            ARC * 1e3 * float(np.nanmean(found.pitch.cumulative.value)),
            1e3 * float(found.runout.runout.value),
        )

    both = tuple(0.5 * (float(record[f"{key} li"]) + float(record[f"{key} re"])) for key in ("fp max", "Fp"))
    return Part(
        name, ours, theirs, expanded, start,
        {"own axis": round_it(own), "their axis": round_it(other), "theirs": (*both, float(record["Fr"]))},
    )  # fmt: skip


def robust(values: np.ndarray) -> float:
    return 1.4826 * float(np.nanmedian(np.abs(values - np.nanmedian(values))))


def flank_means(part: Part, key: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means of a part's flanks, ours and theirs, and the standard error of theirs: (2,) each, µm.

    Of flanks that both have, without those whose difference or value stands `OUT` robust standard deviations off: the evaluation has gross errors.
    """
    ours, theirs, error = np.full((3, 2), np.nan)
    for c in (0, 1):
        a, b = part.ours[key][:, c], part.theirs[key][:, c]
        near = np.isfinite(a)
        for values in (a - b, b):
            near &= np.abs(values - np.nanmedian(values)) <= OUT * robust(values)
        ours[c], theirs[c] = a[near].mean(), b[near].mean()
        error[c] = b[near].std(ddof=1) / np.sqrt(near.sum())
    return ours, theirs, error


def agree(parts: list[Part], key: str) -> dict[str, np.ndarray]:
    """How one quantity agrees over all parts, (2,) each, `off` (parts, 2), µm.

    The greatest correlation that `theirs` can have with the truth is the root of the share of its variance over parts which is not its own scatter from
    flank to flank.
    """
    ours, theirs, error = (np.array(rows) for rows in zip(*(flank_means(part, key) for part in parts), strict=True))
    off = ours - theirs
    noise, whole = (error**2).mean(axis=0), theirs.var(axis=0, ddof=1)
    single = [
        np.concatenate([p.ours[key][:, c] - p.theirs[key][:, c] - o[c] for p, o in zip(parts, off, strict=True)]) for c in (0, 1)
    ]
    return {
        "off": off,
        "RMS": np.sqrt((off**2).mean(axis=0)),
        "bias": off.mean(axis=0),
        "r": np.array([np.corrcoef(ours[:, c], theirs[:, c])[0, 1] for c in (0, 1)]),
        "allowed": np.sqrt(np.maximum(1.0 - noise / whole, 0.0)),
        "single": np.array([robust(values) for values in single]),
    }


def seen(found: Inspection) -> dict[str, float]:
    """Share of flanks, teeth or sides with a value, by quantity."""
    parts = {
        "fHa": found.profile.slope, "ffa": found.profile.form, "fHb": found.helix.slope, "fp": found.pitch.single_greatest,
        "Fp": found.pitch.cumulative, "thickness": found.dimensions.thickness,
    }  # fmt: skip
    share = {key: float(np.isfinite(part.value).mean()) for key, part in parts.items()}
    return share | {"Fr": 0.0 if found.runout is None else float(np.isfinite(found.runout.runout.value))}


def thickness_halves(measured: MeasuredGear, settings: Settings) -> float:
    """Difference of the mean tooth thickness between the two halves of a cloud's points, µm."""
    half = np.random.default_rng(0).random(len(measured.flanks)) < 0.5
    first, second = (
        inspect(measured.flanks.take(mine), measured.gear, settings).dimensions.thickness.value for mine in (half, ~half)
    )
    return 1e3 * float(np.nanmean(first) - np.nanmean(second))


def proposed(folder: Path) -> None:
    """Place of the drawing's module, angle and shift among the gears that each cloud could be of, and the base pitch of the first."""
    among = 0
    for file in sorted(folder.glob("*.xyz")):
        design = read_design(folder / ("z13.toml" if file.name.startswith("kw") else "z19.toml"))
        spec = next(iter(design.gears.values())).spec
        drawn = (spec.normal_module, round(spec.normal_pressure_angle, 6), spec.profile_shift)
        ranked = [one.proposal for one in find_candidates(read_one(file).points).ranked]
        seen = [(one.module.mm, round(one.pressure_angle, 6), round(one.profile_shift, 3)) for one in ranked]
        place = seen.index(drawn) + 1 if drawn in seen else 0
        among += place in (1, 2)
        pitch = ranked[0].module.mm * np.cos(ranked[0].pressure_angle) / (drawn[0] * np.cos(drawn[1])) - 1.0
        print(
            f"  {file.stem}: place {place or '-'}; first {ranked[0].name} (base pitch {100 * pitch:+.2f} %), shift ± {ranked[0].shift_std:.3f}"
        )
    print(f"  among the first two: {among}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument("--loop", action="store_true", help="with the closed loop")
    parser.add_argument("--design", action="store_true", help="what `design` proposes")
    arguments = parser.parse_args()
    if not arguments.folder.is_dir():
        print(f"{arguments.folder} is not there: nothing to compare with")
        return
    if arguments.design:
        proposed(arguments.folder)
        return
    parts, halves, shares = [], [], {}
    for file in sorted(arguments.folder.glob("*.xyz")):
        design = read_design(arguments.folder / ("z13.toml" if file.name.startswith("kw") else "z19.toml"))
        measured = measure(design, [file], loop=arguments.loop)
        noise = Settings(noise=measured.noise, pose_covariance=measured.placed.registration.covariance)
        shares[file.stem] = seen(inspect(measured.flanks, measured.gear, noise))
        record = file.with_name(f"{file.stem}.reany.json")
        if record.exists():
            parts.append(compared(measured, file.stem, json.loads(record.read_text())))
            halves.append(thickness_halves(measured, settings_as(measured)))
    print("share with a value, with the defaults (least of all parts / mean)")
    for key in next(iter(shares.values())):
        values = [share[key] for share in shares.values()]
        print(f"  {key:<10}{100 * min(values):6.0f} {100 * np.mean(values):6.1f} %")
    print(
        "\nthis program less the other, µm, li and re: RMS of part means, correlation of them over parts and what the other's own"
    )
    print(f"scatter allows it to be, single flanks about their part's mean; (goals: {GOALS})")
    for key in KEYS:
        agreement = agree(parts, key)
        cells = "  ".join(
            f"{name} " + ", ".join(f"{value:{width}}" for value in agreement[name])
            for name, width in (("RMS", ".2f"), ("bias", ".2f"), ("r", ".3f"), ("allowed", ".3f"), ("single", ".2f"))
        )
        print(f"  {key}: {cells}  U {np.median([np.nanmedian(part.expanded[key]) for part in parts]):.2f}")
        for part, off in zip(parts, agreement["off"], strict=True):
            print(f"    {part.name} {off[0]:6.2f} {off[1]:6.2f}")
    print("\nfp, Fp, Fr: theirs, about the flanks' axis, about theirs")
    for part in parts:
        print(
            f"  {part.name} "
            + "   ".join("/".join(f"{v:5.2f}" for v in part.round_it[key]) for key in ("theirs", "own axis", "their axis"))
        )
    off = np.array([np.subtract(part.round_it["their axis"], part.round_it["theirs"]) for part in parts])
    print(
        f"  about their axis less theirs: median {np.nanmedian(off, axis=0).round(2)}, RMS {np.sqrt(np.nanmean(off**2, axis=0)).round(2)}, robust {[round(robust(c), 2) for c in off.T]}"
    )
    print(f"\nmean thickness, halves of a cloud: RMS {np.sqrt(np.nanmean(np.square(halves)) / 4.0):.2f} µm for the whole cloud")


if __name__ == "__main__":
    main()
