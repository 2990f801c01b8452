"""How often the 95 % band of a wear forecast holds the truth: wear simulated with elastic teeth of another compliance model, then forecast.

``python -m benchmarks.wear_forecast [CASES [SEED [apart|helical]]]`` prints a line per case and what they come to. The truth is run with compliances by
Weber and Banaschek on a half plane, scaled by 0.85 to 1.15, with mates hard and soft, loads of 60 to 300 N/mm, aligned and
misaligned; with `apart` by `tests/synthetic/ran.py`, which shares no contact, no steps and no compliance with the forecast, with `helical` by
`tests/synthetic/ran_helical.py`, as apart, on a pair of 17 and 31 teeth at 20°. The forecast has
plane finite elements and the load as stated. What is measured of it is the mean profile of 12 teeth that scatter
by 5 %, with noise and texture; scan and registration are not in it. No part of the fit is used to make a case.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import beta

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.loaded.formulas import beam_on_half_plane
from gearwear.loaded.pair_compliance import PairCompliance
from gearwear.loaded.steel import Material
from gearwear.loaded.wearing import run_wear
from gearwear.meshing.path import path_of_contact
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.forecast import forecast_wear
from gearwear.wear_law.running import forecast_by_running
from tests.running import helical_maps as helical_pairs
from tests.synthetic.ran import RanWear
from tests.synthetic.ran_helical import HelicalRan

FACE, CENTRE, RUN = 15.0, 114.3, 1e6
TIMES = (2.0, 3.0)
TEETH = 12
GAP_KNOWN_TO = 0.004
"""mm; standard deviation of the misalignment that the forecast is told."""
NOISE, TEXTURE, TEXTURE_LENGTH = 0.0010, 0.0005, 1.5
"""mm: of a place on one tooth, and what neighbouring places of all teeth share."""


@dataclass(frozen=True)
class Case:
    """What is put in."""

    load: float
    single: float
    """k w N after `RUN` cycles, mm."""
    mate_rate: float
    scale: float
    misalignment: float


def draw(random: np.random.Generator) -> Case:
    """A pair that has run."""
    return Case(
        load=float(np.exp(random.uniform(math.log(60.0), math.log(300.0)))),
        single=float(random.uniform(0.006, 0.025)),
        mate_rate=float(random.choice([0.0, 0.0, 0.7, 1.0])),
        scale=float(random.uniform(0.85, 1.15)),
        misalignment=1e-3 * float(random.choice([0.0, 0.0, 30.0, 60.0])),
    )


def true_depths(pinion: Gear, wheel: Gear, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Lengths of roll, and the mean depth over the face at once, twice and three times the cycles, mm."""
    steel = Material()
    roll = [np.linspace(one.form_roll + 0.5, one.tip_roll - 0.5, 9) for one in (pinion, wheel)]
    teeth = (beam_on_half_plane(pinion, steel, roll[0]), beam_on_half_plane(wheel, steel, roll[1]))
    elastic = PairCompliance(teeth, steel, 0.9 * pinion.transverse_module, case.scale)
    times = [case.single / case.load * n for n in (1.0, *TIMES)]
    states = run_wear(
        pinion, wheel, CENTRE, case.load * FACE, elastic, times, case.mate_rate,
        misalignment=case.misalignment, slices=1 if case.misalignment == 0.0 else 5, positions_per_pitch=90,
    )  # fmt: skip
    return states[0].roll, np.array([state.depth.mean(axis=0) for state in states])


def depths_of(wear: RanWear | HelicalRan) -> tuple[np.ndarray, np.ndarray]:
    """The same of a generator's pair."""
    tables = [replace(wear, single_um=times * wear.single_um).table for times in (1.0, *TIMES)]
    return tables[0][0], np.array([depth.mean(axis=1) for _, _, depth in tables])


def depths_apart(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """The same by the generator that shares nothing with the forecast."""
    wear = RanWear(
        single_um=1e3 * case.single, load=case.load, gap_um=1e3 * case.misalignment, mate_rate=case.mate_rate, softness=case.scale,
        bridged=True,
    )  # fmt: skip
    return depths_of(wear)


def depths_helical(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """The same of a helical pair."""
    wear = helical_pairs.ran(
        load=case.load,
        gap_um=1e3 * case.misalignment,
        mate_rate=case.mate_rate,
        softness=case.scale,
        single_um=1e3 * case.single,
        bridged=True,
    )
    return depths_of(wear)


def shown(case: Case, random: np.random.Generator) -> float:
    """The gap that the worn flanks show to the second loop, which knows it to some micrometres (`benchmarks.running`), mm."""
    gap = case.misalignment / (1.0 + case.mate_rate)
    return gap + GAP_KNOWN_TO * float(random.normal()) if gap > 0.0 else 0.0


def measured(roll: np.ndarray, depth: np.ndarray, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, depths of all teeth (TEETH, n) and covariance of their mean, mm."""
    places = np.sqrt(np.linspace(roll[0] ** 2 + 6.0, roll[-1] ** 2 - 2.0, 60))
    true = np.interp(places, roll, depth)
    alike = np.exp(-np.abs(places[:, None] - places) / TEXTURE_LENGTH)
    texture = TEXTURE**2 * alike
    shared = np.linalg.cholesky(texture + 1e-16 * np.eye(60)) @ random.normal(size=60)
    factors = random.normal(1.0, 0.05, (TEETH, 1))
    teeth = factors * true + shared + NOISE * random.normal(size=(TEETH, 60))
    return places, teeth, texture + NOISE**2 / TEETH * np.eye(60)


def interval_score(low: float, high: float, truth: float) -> float:
    """Gneiting & Raftery 2007 at 95 %: its width, and 40 times what it misses by."""
    return (high - low) + 40.0 * (max(low - truth, 0.0) + max(truth - high, 0.0))


def exact_interval(hits: int, count: int) -> tuple[float, float]:
    """Clopper and Pearson 1934, 95 %, per cent."""
    low = 0.0 if hits == 0 else float(beta.ppf(0.025, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(0.975, hits + 1, count - hits))
    return 100.0 * low, 100.0 * high


@dataclass(frozen=True)
class Outcome:
    """What was forecast of a case: value, low and high (3, 2) by each way to forecast, and the truth (2,), mm."""

    case: Case
    told: dict[str, np.ndarray]
    truth: np.ndarray

    @property
    def kind(self) -> str:
        return f"{'misaligned' if self.case.misalignment else 'aligned'}, {'soft' if self.case.mate_rate else 'hard'} mate"

    def holds(self, way: str) -> np.ndarray:
        _, low, high = self.told[way]
        return (low <= self.truth) & (self.truth <= high)

    def scores(self, way: str) -> np.ndarray:
        _, low, high = self.told[way]
        return np.array([interval_score(*one) for one in zip(low, high, self.truth, strict=True)])


def line(number: int, one: Outcome, now: float) -> str:
    """A case as it is printed."""
    case = one.case
    text = f"{number:3d} w {case.load:3.0f} kwN {1e3 * case.single:4.1f} mate {case.mate_rate:.1f} x{case.scale:.2f} f {1e3 * case.misalignment:2.0f} now {1e3 * now:5.1f}"
    for way in ("law", "run"):
        for (value, low, high), inside in zip(1e3 * one.told[way].T, one.holds(way), strict=True):
            text += f" | {way} {value:5.1f} ({low:5.1f} {high:5.1f}) {'' if inside else 'MISSED'}"
    return text + f" | truth {1e3 * one.truth[0]:5.1f} {1e3 * one.truth[1]:5.1f}"


def summary(outcomes: list[Outcome], way: str) -> str:
    """How often a way to forecast held the truth, its score, and how far its value was off."""
    holds, count = np.array([one.holds(way) for one in outcomes]).sum(axis=0), len(outcomes)
    score = 1e3 * np.mean([one.scores(way) for one in outcomes], axis=0)
    off = 100.0 * np.array([one.told[way][0] / one.truth - 1.0 for one in outcomes])
    parts = []
    for i, times in enumerate(TIMES):
        low, high = exact_interval(int(holds[i]), count)
        parts.append(
            f"at {times:g}x {holds[i]} of {count} ({low:.1f} to {high:.1f} %), interval score {score[i]:.1f} um, off {off[:, i].mean():+.1f} ± {off[:, i].std():.1f} %"
        )
    return "; ".join(parts)


def main() -> None:
    """Run the cases and tell."""
    kind_of_truth = sys.argv[-1] if sys.argv[-1] in ("apart", "helical") else ""
    given = sys.argv[1 : len(sys.argv) - bool(kind_of_truth)]
    cases, seed = (int(value) for value in (*given, *("100", "1")[len(given) :]))
    pinion, wheel = (Gear.from_spec(GearSpec(name, z, 6.35, FACE)) for name, z in (("pinion", 12), ("gear", 24)))
    if kind_of_truth == "helical":
        pinion, wheel = helical_pairs.gears(helical_pairs.ran())
    centre = pinion.reference_radius + wheel.reference_radius
    path = path_of_contact(pinion, wheel, centre)
    outcomes: list[Outcome] = []
    began = time.process_time()
    for number in range(cases):
        random = np.random.default_rng([seed, number])
        case = draw(random)
        if kind_of_truth == "helical":
            roll, depths = depths_helical(case)
        else:
            roll, depths = depths_apart(case) if kind_of_truth else true_depths(pinion, wheel, case)
        on = (roll >= path.start_pinion) & (roll <= path.end_pinion)
        fits = fit_wear_law(pinion, wheel, centre, *measured(roll, depths[0], random))
        asked = RUN * np.array(TIMES)
        found = {
            "law": forecast_wear(fits, RUN, asked).greatest_depth,
            "run": forecast_by_running(fits[0], RUN, asked, case.load, misalignment=shown(case, random)).greatest_depth,
        }
        told = {way: np.array([band.value, band.low, band.high]) for way, band in found.items()}
        told["run ± 30 %"] = told["run"][0] * np.array([[1.0], [0.7], [1.3]])
        outcomes.append(Outcome(case, told, depths[1:, on].max(axis=1)))
        print(line(number, outcomes[-1], float(depths[0, on].max())), flush=True)
    for way in outcomes[0].told:
        print(f"{way}: {summary(outcomes, way)}")
    for kind in sorted({one.kind for one in outcomes}):
        some = [one for one in outcomes if one.kind == kind]
        for way in ("run", "run ± 30 %"):
            print(f"{kind}, {way}: {summary(some, way)}")
    print(f"{(time.process_time() - began) / cases:.1f} s of processor a case")


if __name__ == "__main__":
    main()
