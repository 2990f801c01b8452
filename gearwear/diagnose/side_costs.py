"""What it costs that sides are worn throughout: which hypothesis is chosen, and which others the scan does not exclude."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.diagnose.fit import Model
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem

NO_SIDE: frozenset[Side] = frozenset()


@dataclass(frozen=True, slots=True)
class SideCosts:
    """What it costs that no side, the left, the right or both are worn throughout.

    Parameters
    ----------
    by_sides : dict of frozenset of Side to float
        A hypothesis that is not tenable is left out.
    alike : float
        Of no wear, where whatever the flanks were made with is the same on both sides.
    uncommon : float
        By how much a form such as both sides may have lost is less common among flanks of the gear's class than none.
    pitch : dict of frozenset of Side to float
        Roll of the pitch point, mm, of hypotheses that are cheapest with one off the reference circle.
    bends : frozenset of Side
        The side that bends so much more than the other that it was no datum.
    """

    by_sides: Mapping[frozenset[Side], float]
    alike: float = math.inf
    uncommon: float = 0.0
    pitch: Mapping[frozenset[Side], float] = field(default_factory=dict)
    bends: frozenset[Side] = NO_SIDE

    @property
    def chosen(self) -> frozenset[Side]:
        """The cheapest hypothesis. A form that both sides share was made more often than both were worn to it: they are worn only where that
        beats it by more than chance."""
        cheapest = min(self.by_sides, key=lambda worn: self.by_sides[worn])
        as_likely = self.alike < self.by_sides[cheapest] + rules().close
        return NO_SIDE if len(cheapest) == len(Side) and as_likely else cheapest

    def beside(self, ran: frozenset[Side]) -> SideCosts:
        """Of the other sides alone, where flanks of some show where their mate ran."""
        if not ran:
            return self
        return replace(self, by_sides={worn: cost for worn, cost in self.by_sides.items() if not worn & ran})

    def without(self, sides: Collection[frozenset[Side]]) -> SideCosts:
        """Without some hypotheses, of which worn on no side is none."""
        return replace(self, by_sides={worn: cost for worn, cost in self.by_sides.items() if worn not in sides})

    def _held_against(self, sides: frozenset[Side]) -> float:
        """What a hypothesis that is not chosen is held against: the cost of the one that is. Where no side is, but for forms of left and right apart, these are
        no evidence against wear of the side that bends more than the other: they explain whatever it lost better, having any shape. That is held against
        what sides cut alike cost."""
        chosen = self.by_sides[self.chosen]
        by_forms_apart = self.chosen == NO_SIDE and sides == self.bends
        return max(chosen, self.alike) if by_forms_apart and math.isfinite(self.alike) else chosen

    @property
    def ruled_out(self) -> frozenset[frozenset[Side]]:
        """Hypotheses that cost so much more than the chosen one that more cells would say the same."""

        def limit(sides: frozenset[Side]) -> float:
            least = self._held_against(sides)
            return least + max(rules().close, rules().beyond_doubt * least)

        return frozenset(worn for worn, cost in self.by_sides.items() if cost > limit(worn))

    @property
    def beyond_doubt(self) -> bool:
        """Whether every other hypothesis than the chosen one is ruled out."""
        return self.ruled_out == self.by_sides.keys() - {self.chosen}

    @property
    def not_excluded(self) -> tuple[frozenset[Side], ...]:
        """What else the scan does not exclude: hypotheses that cost no more than chance beyond the chosen one.

        Both sides made with what both may have lost alike is no better told by how well it fits than their class makes such a form uncommon.
        """
        taken, both = self.chosen, frozenset(Side)
        more = self.uncommon if taken == NO_SIDE else 0.0

        def above(worn: frozenset[Side], cost: float) -> float:
            return cost - (more if worn == both else 0.0) - self._held_against(worn)

        return tuple(worn for worn, cost in self.by_sides.items() if worn != taken and above(worn, cost) < rules().close)


def by_reliefs(model: Model, problem: Problem) -> float:
    """How uncommon, in cost, a model's tip and root relief are as they were cut: beyond all measure where they leave hardly anything of the flanks between them, as a
    mate that slides does; else 0."""
    return math.inf if reliefs_meet(model, problem.context.gear) else 0.0


def reliefs_meet(model: Model, gear: Gear) -> bool:
    """Whether a model's tip and root relief leave hardly anything of the flanks between them."""
    tip, root = ([one.shape[0] for one in model if one.name == f"{end}_relief"] for end in ("tip", "root"))
    least = rules().least_between * abs(gear.tip_roll - gear.form_roll)
    return bool(tip and root) and gear.orientation * (tip[0] - root[0]) < least
