"""How well the second loop tells how a pair ran: wear maps worn by another model of elastic teeth, misaligned by 0 to 60 µm, asked back.

``python -m benchmarks.running [CASES [SEED [helical]]]`` prints a line a case and what they come to. Compliance, coupling, load, amount of wear and mate are
drawn; the generator (`tests/synthetic/ran.py`) shares nothing with the fit. Noise and texture are those of twelve flanks of a scan; the scan itself is not in it. With `helical` pairs of 8 to 30°, either hand and either side (`tests/synthetic/ran_helical.py`).
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np
from scipy.stats import beta

from gearwear.running.found import SecondLoop
from gearwear.running.search import find_running
from tests.running import helical_maps as helical_pairs
from tests.running.maps import law_basis_and_alone, map_of, runs_on
from tests.synthetic.ran import RanWear
from tests.synthetic.ran_helical import HelicalRan

GAPS = (30.0, 0.0, 15.0, 60.0, -30.0, 0.0)


def draw(random: np.random.Generator, gap: float) -> RanWear:
    """A pair that ran."""
    return RanWear(
        single_um=float(random.uniform(6.0, 25.0)),
        load=float(np.exp(random.uniform(math.log(60.0), math.log(300.0)))),
        mate_rate=float(random.choice([0.0, 0.0, 0.7, 1.0])),
        softness=float(random.uniform(0.85, 1.15)),
        coupling=float(random.uniform(0.9, 1.4)),
        factors=tuple(random.normal(1.0, 0.05, 12).tolist()),
        gap_um=gap,
        bridged=True,
    )


def draw_helical(random: np.random.Generator, gap: float) -> HelicalRan:
    """A helical pair that ran."""
    return helical_pairs.ran(
        float(random.choice([-1.0, 1.0]) * random.uniform(8.0, 30.0)),
        side=int(random.choice([-1, 1])),
        single_um=float(random.uniform(6.0, 25.0)),
        load=float(np.exp(random.uniform(math.log(60.0), math.log(300.0)))),
        mate_rate=float(random.choice([0.0, 0.0, 0.7, 1.0])),
        softness=float(random.uniform(0.85, 1.15)),
        coupling=float(random.uniform(0.9, 1.4)),
        gap_um=gap,
        bridged=True,
    )


def traced(number: int, seed: int, gap: float, helical: bool) -> tuple[RanWear | HelicalRan, SecondLoop]:
    """A case, and how it is said to have run."""
    random = np.random.default_rng([seed, number])
    if helical:
        pair = draw_helical(random, gap)
        return pair, helical_pairs.traced(pair, seed * 1000 + number)
    wear = draw(random, gap)
    place = map_of(wear, seed * 1000 + number)
    return wear, find_running(place, *law_basis_and_alone(place, runs_on(place, wear.load, 1e-3 * wear.single_um)))


def share(hits: int, count: int) -> str:
    """With its exact 95 % interval."""
    low = 0.0 if hits == 0 else float(beta.ppf(0.025, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(0.975, hits + 1, count - hits))
    return f"{hits} of {count} ({100 * low:.0f} to {100 * high:.0f} %)"


def main() -> None:
    """Run the cases and tell."""
    helical = sys.argv[-1] == "helical"
    given = sys.argv[1 : len(sys.argv) - helical]
    cases, seed = (int(value) for value in (*given, *("48", "1")[len(given) :]))
    askew: list[tuple[float, float, float]] = []
    aligned: list[set[str]] = []
    other: list[str] = []
    began = time.process_time()
    for number in range(cases):
        gap = GAPS[number % len(GAPS)]
        wear, found = traced(number, seed, gap, helical)
        names = {one.name for one in found.effects}
        size = found.effect("misalignment")
        told = "none named"
        if size is not None:
            value = size.parameters["gap_um"]
            told = f"{value.value:6.1f} ± {value.std:.1f}"
        if gap == 0.0:
            aligned.append(names)
        elif size is not None:
            askew.append((gap, float(value.value), float(value.std)))  # type: ignore[arg-type]
        else:
            askew.append((gap, 0.0, 0.0))
        false = names - {"misalignment", "elastic_sharing"} - ({"mate_wear"} if wear.mate_rate > 0.0 else set())
        other += sorted(false)
        print(
            f"{number:3d} gap {gap:5.0f} w {wear.load:3.0f} kwN {wear.single_um:4.1f} mate {wear.mate_rate:.1f} soft {wear.softness:.2f}"
            f" coupling {wear.coupling:.2f} | {told} | {', '.join(sorted(names))}",
            flush=True,
        )
    off = [abs(value - gap) for gap, value, _ in askew]
    held = sum(abs(value - gap) <= 1.96 * std for gap, value, std in askew)
    print(
        f"misaligned: within 10 µm {share(sum(o <= 10.0 for o in off), len(off))}; greatest error {max(off):.1f} µm, RMS {math.sqrt(np.mean(np.square(off))):.1f}"
    )
    print(f"95 % interval holds the truth: {share(held, len(askew))}")
    print(f"aligned: misalignment named {share(sum('misalignment' in names for names in aligned), len(aligned))}")
    print(f"other names that were not put in: {', '.join(other) or 'none'}")
    print(f"{(time.process_time() - began) / cases:.1f} s of processor a case")


if __name__ == "__main__":
    main()
