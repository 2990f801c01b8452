"""How well the second loop tells how a pair ran: wear maps worn by another model of elastic teeth, misaligned by 0 to 60 µm, asked back.

``python -m benchmarks.running [CASES [SEED [helical|early]]]`` prints a line a case and what they come to. Compliance, coupling, load, amount of wear and mate are
drawn; the generator (`tests/synthetic/ran.py`) shares nothing with the fit. Noise and texture are those of twelve flanks of a scan; the scan itself is not in it. With `helical` pairs of 8 to 30°, either hand and either side (`tests/synthetic/ran_helical.py`);
with `early` mates whose tips come in by 0 to 30 µm early, a third of the pairs 30 µm askew as well.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import beta

from gearwear.running.found import SecondLoop
from gearwear.running.search import find_running
from tests.running import helical_maps as helical_pairs
from tests.running.maps import law_basis_and_alone, map_of, runs_on
from tests.synthetic.ran import RanWear
from tests.synthetic.ran_helical import HelicalRan

GAPS = (30.0, 0.0, 15.0, 60.0, -30.0, 0.0)
EARLY, GAPS_EARLY = (20.0, 0.0, 10.0, 30.0), (0.0, 0.0, 30.0)
"""µm: how far the mate's tips are ahead, and the gaps beside it."""


def draw(random: np.random.Generator, gap: float, early: float = 0.0) -> RanWear:
    """A pair that ran."""
    return RanWear(
        single_um=float(random.uniform(6.0, 25.0)),
        load=float(np.exp(random.uniform(math.log(60.0), math.log(300.0)))),
        mate_rate=float(random.choice([0.0, 0.0, 0.7, 1.0])),
        softness=float(random.uniform(0.85, 1.15)),
        coupling=float(random.uniform(0.9, 1.4)),
        factors=tuple(random.normal(1.0, 0.05, 12).tolist()),
        gap_um=gap,
        early_um=early,
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


def traced(number: int, seed: int, gap: float, helical: bool, early: float = 0.0) -> tuple[RanWear | HelicalRan, SecondLoop]:
    """A case, and how it is said to have run."""
    random = np.random.default_rng([seed, number])
    if helical:
        pair = draw_helical(random, gap)
        return pair, helical_pairs.traced(pair, seed * 1000 + number)
    wear = draw(random, gap, early)
    place = map_of(wear, seed * 1000 + number)
    return wear, find_running(place, *law_basis_and_alone(place, runs_on(place, wear.load, 1e-3 * wear.single_um)))


def share(hits: int, count: int) -> str:
    """With its exact 95 % interval."""
    if count == 0:
        return "0 of 0"
    low = 0.0 if hits == 0 else float(beta.ppf(0.025, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(0.975, hits + 1, count - hits))
    return f"{hits} of {count} ({100 * low:.0f} to {100 * high:.0f} %)"


@dataclass(frozen=True)
class Sizes:
    """Sizes of one effect that were put in, and what is said of them, µm."""

    name: str
    key: str
    put_in: list[float] = field(default_factory=list)
    value: list[float] = field(default_factory=list)
    std: list[float] = field(default_factory=list)
    kinds: list[str] = field(default_factory=list)

    def add(self, put_in: float, found: SecondLoop, kind: str) -> str:
        effect = found.effect(self.name)
        value, std = (0.0, 0.0) if effect is None else (effect.parameters[self.key].value, effect.parameters[self.key].std)
        self.put_in.append(put_in)
        self.value.append(float(value))  # type: ignore[arg-type]
        self.std.append(float(std))  # type: ignore[arg-type]
        self.kinds.append(kind)
        return f"{self.value[-1]:6.1f} ± {self.std[-1]:.1f}" if effect is not None else "none named"

    def tell(self) -> None:
        put_in, value, std, kinds = map(np.array, (self.put_in, self.value, self.std, self.kinds))
        print(
            f"{self.name}: named where there was none {share(int((std[put_in == 0.0] > 0.0).sum()), int((put_in == 0.0).sum()))}"
        )
        there = put_in != 0.0
        if not there.any():
            return
        for kind in ("", *sorted(set(kinds[there]))):
            on = there & (np.char.equal(kinds, kind) | (kind == ""))
            off, named = value[on] - put_in[on], std[on] > 0.0
            print(
                f"  {kind or 'all'}: named {share(int(named.sum()), len(off))}; within 10 µm {share(int((abs(off) <= 10.0).sum()), len(off))}, greatest error"
                f" {abs(off).max():.1f} µm, RMS {math.sqrt(np.mean(off**2)):.1f}; 95 % interval of those named holds the truth"
                f" {share(int((abs(off) <= 1.96 * std[on])[named].sum()), int(named.sum()))}"
            )


def main() -> None:
    """Run the cases and tell."""
    mode = sys.argv[-1] if sys.argv[-1] in ("helical", "early") else ""
    given = sys.argv[1 : len(sys.argv) - bool(mode)]
    cases, seed = (int(value) for value in (*given, *("48", "1")[len(given) :]))
    gaps, ahead = Sizes("misalignment", "gap_um"), Sizes("premature_tip_contact", "amount_um")
    other: list[str] = []
    began = time.process_time()
    for number in range(cases):
        gap, early = GAPS[number % len(GAPS)], 0.0
        if mode == "early":
            gap, early = GAPS_EARLY[number % len(GAPS_EARLY)], EARLY[number % len(EARLY)]
        wear, found = traced(number, seed, gap, mode == "helical", early)
        mate = f"{'soft' if wear.mate_rate else 'hard'} mate"
        told = gaps.add(gap, found, f"{abs(gap):.0f} µm, {mate}"), ahead.add(early, found, f"{early:.0f} µm, {mate}")
        put_in = {
            "elastic_sharing",
            *(["misalignment"] * (gap != 0.0)),
            *(["mate_wear"] * (wear.mate_rate > 0.0)),
            *(["premature_tip_contact"] * (early > 0.0)),
        }
        names = {one.name for one in found.effects}
        other += sorted(names - put_in)
        print(
            f"{number:3d} gap {gap:5.0f} early {early:2.0f} w {wear.load:3.0f} kwN {wear.single_um:4.1f} mate {wear.mate_rate:.1f} soft {wear.softness:.2f}"
            f" coupling {wear.coupling:.2f} | {' | '.join(told)} | {', '.join(sorted(names))}",
            flush=True,
        )
    gaps.tell()
    ahead.tell()
    print(f"names that were not put in: {', '.join(other) or 'none'}")
    print(f"{(time.process_time() - began) / cases:.1f} s of processor a case")


if __name__ == "__main__":
    main()
