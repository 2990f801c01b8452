"""What the scanner seems to have done and may as well be the part's own: it stays measured, and keeps no name that the scan cannot tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from gearwear.arrays import Bools
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.effects.edge_rounding import EDGE_ROUNDING
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.flank_columns import any_profile, on_each_side
from gearwear.diagnose.judge import alike, replacements
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem, exchange


def left_in_the_part(problem: Problem, model: Model, form: bool) -> Model:
    """The model with the maker's effect in place of a scanner's that cannot be told from it: what may be the part's own stays measured.

    With `form`, and of what scanners seldom do, what explains nearly as much cannot be told from it either: a coat is no more likely than a thick tooth then.
    """
    for index, candidate in enumerate(model):
        effect = candidate.effect
        if effect.kind is not Kind.MEASUREMENT or (effect.usual and not form) or candidate.name in problem.always:
            continue
        rest = model[:index] + model[index + 1 :]
        others = list(replacements(problem, model, index))
        if form or not effect.usual:
            others += [(other, (*rest, other)) for other in alike(problem, model, index)]
        for other, replaced in others:
            if other.effect.kind is Kind.MANUFACTURE:
                return left_in_the_part(problem, replaced, form)
    return model


def of_the_form(fit: Fit, problem: Problem, model: Model, form: bool = True) -> tuple[Model, Mapping[str, frozenset[str]]]:
    """The model without what the scanner seems to have done and a form of all teeth may be as well; and of the effects that came in instead, by
    name, what they cannot be told from.

    Where flanks have a form that no effect explains, `form`, any profile may be theirs. What explains less than half as much beside a free profile of each
    side, and levels of the other surfaces, is not told from it. What the maker does stands in its place, or the form that is left has no name.
    Without `form` what scanners do often is not asked about.
    """

    def by_scanner(candidate: Candidate) -> bool:
        """Whether the scanner may not have done it at all: edges every scan rounds."""
        known = candidate.effect
        return known.kind is Kind.MEASUREMENT and candidate.name != EDGE_ROUNDING and (form or not known.usual)

    if not any(map(by_scanner, model)):
        return model, {}
    cells = fit.cells
    wide = fit.dictionary.with_columns(on_each_side(cells, any_profile(cells)))
    gram = replace(fit, dictionary=wide).problem(problem.unit, problem.context).gram
    profiles = np.arange(fit.dictionary.count, wide.count)

    def told(candidates: Sequence[Candidate], rest: Model) -> Bools:
        """Which candidates explain, beside others, something that is no profile."""
        beside = problem.columns(problem.with_offsets(rest))
        columns = [c.columns for c in candidates]
        alone, left = (np.asarray(gram.gains(which, columns)) for which in (beside, np.concatenate([beside, profiles])))
        return np.asarray(left >= rules().stands_in * alone, dtype=np.bool_)

    taken_out = {c.name for i, c in enumerate(model) if by_scanner(c) and not told([c], model[:i] + model[i + 1 :])[0]}
    if not taken_out:
        return model, {}
    rest, every = tuple(c for c in model if c.name not in taken_out), problem.dictionary.candidates
    running = tuple(c for c, is_told in zip(every, told(every, rest), strict=True) if is_told or not by_scanner(c))
    made = exchange(replace(problem, dictionary=replace(problem.dictionary, candidates=running)), rest)
    before = {c.name for c in model}
    return made, {c.name: frozenset(taken_out) for c in made if c.name not in before and c.effect.kind is not Kind.FORM}


def or_of_the_form(fit: Fit, problem: Problem, model: Model) -> Mapping[str, frozenset[str]]:
    """What of the maker's may be there in place of what the scanner seems to have done, where flanks of a side are left out as worn, by name of that.

    Of the other side alone what turns both sides' flanks against each other looks as a form does that it was cut with.
    """
    made, instead = of_the_form(fit, problem, model, form=False)
    return {name: frozenset(instead) for name in {c.name for c in model} - {c.name for c in made}}
