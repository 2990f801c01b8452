"""What the closed loop found: the effects in order, with the error before and after each."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.card import Card, CardRow, few, measured
from gearwear.design.quantity import NORMAL_95, counted, pretty_unit
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.as_views import may_be_views
from gearwear.diagnose.bowed import bow_of_sound
from gearwear.diagnose.correlations import Correlation, EffectSize, correlations, sizes
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects import named_effects
from gearwear.diagnose.effects.base import MADE, MEASURED, Context, Kind
from gearwear.diagnose.effects.root_form import ROOT_FORM
from gearwear.diagnose.effects.scale import EFFECT, SCALE
from gearwear.diagnose.effects.view_registration import VIEW_REGISTRATION
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.judge import Evidence, alternatives
from gearwear.diagnose.jumps import jump_deviations
from gearwear.diagnose.made_height import MadeHeight, fillets_off, made_height
from gearwear.diagnose.parameter import ParameterEstimate, Role
from gearwear.diagnose.pattern import Pattern
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem
from gearwear.diagnose.smooth_form import as_smooth_form
from gearwear.diagnose.space_waves import SpaceWave
from gearwear.diagnose.taken_back import taken_back


@dataclass(frozen=True, slots=True, repr=False)
class FoundEffect(Card):
    """An effect that was added to the model.

    Parameters
    ----------
    candidate : Candidate
        Effect and shape.
    amplitudes : (p,) float
        Inner units.
    parameters : dict of str to ParameterEstimate
        As the contract names them.
    alternatives : tuple of str
        What the data cannot tell from it.
    evidence : Evidence
    rms_before, rms_after, held_out_before, held_out_after : float
        mm, over points outside the wear; each before is the last after.
    covariance : (p, p) float
        Of the amplitudes, everything fitted together; nan for one that no cell speaks of.
    """

    candidate: Candidate
    amplitudes: Floats
    parameters: dict[str, ParameterEstimate]
    alternatives: tuple[str, ...]
    evidence: Evidence
    rms_before: float
    rms_after: float
    held_out_before: float
    held_out_after: float
    covariance: Floats

    @property
    def name(self) -> str:
        return self.candidate.name

    @property
    def kind(self) -> Kind:
        return self.candidate.effect.kind

    def or_one_of(self, names: Collection[str]) -> FoundEffect:
        """The effect, with more names that it cannot be told from."""
        return replace(self, alternatives=tuple(sorted({*self.alternatives, *names})))

    @property
    def is_sized(self) -> bool:
        """Whether the 95 % interval of one of its sizes, or of one tooth's, leaves out nothing."""
        known = {one.name for one in self.candidate.effect.parameters if one.role is Role.SIZE}
        sizes = [one for name, one in self.parameters.items() if name in known]
        return any(bool((np.abs(one.value) > NORMAL_95 * np.asarray(one.std)).any()) for one in sizes)

    def lowers_by(self, flanks: SurfacePoints, context: Context) -> float:
        """By how much it lowers every one of some points on flanks, mm; 0 where it is not even there."""
        lost = -self.candidate.effect.basis(flanks, context, self.candidate.shape) @ self.amplitudes
        even = len(lost) > 0 and float(lost.var()) < rules().even_share * float(np.mean(lost**2))
        return max(float(lost.min()), 0.0) if even else 0.0

    def headline(self) -> str:
        return f"{self.name} ({self.kind.value}), RMS {1e3 * self.rms_before:.2f} → {1e3 * self.rms_after:.2f} µm"

    def rows(self) -> list[CardRow]:
        rows = []
        for parameter, one in self.parameters.items():
            name, unit = parameter.removesuffix(f"_{one.unit}"), pretty_unit(one.unit)
            if isinstance(one.value, tuple):
                known = [value for value in one.value if math.isfinite(value)]
                rows.append((name, f"{counted(len(known), 'value')}, {min(known):.3g} … {max(known):.3g} {unit}"))
            else:
                rows.append((name, measured(one.value, math.nan if isinstance(one.std, tuple) else one.std, unit)))
        rows.append(("p-value", f"{self.evidence.p_value:.1g}" if self.evidence.p_value > 0.0 else "below 1e-300"))
        return rows + ([("not told from", ", ".join(self.alternatives))] if self.alternatives else [])


@dataclass(frozen=True, slots=True)
class UntoldFlanks:
    """Flanks that tell nothing of their own level.

    Parameters
    ----------
    level, level_std : (teeth, 2) float
        By how much left and right flanks stand higher as made than the effects have it, mm: as the rest of their tooth has them, and no tooth's amount is what
        the sum of the others leaves for it; and how well that is known.
    raised : (m,) float
        The same of the cells of flanks.
    fields : (m, k) float
        How high each may stand besides, mm, even all over it: by what sound flanks, each left out in turn, scatter about the mean of their side off where
        the rest of their tooth has them; and all of a side alike, by how well that mean is known.
    """

    level: Floats
    level_std: Floats
    raised: Floats
    fields: Floats


@dataclass(frozen=True, slots=True, repr=False)
class Loop(Card):
    """The closed loop.

    Parameters
    ----------
    effects : tuple of FoundEffect
        In the order added.
    form : tuple of FoundEffect
        Levels that the drawing leaves open, the root as it is, and what is told and not named: no findings. The errors before are with them.
    motion : (6,) float
        Small motion (mm, rad) of the scan that goes with them: deviations of the motion and the effects add.
    rms_before, rms_after, held_out_before, held_out_after : float
        mm, over points outside the wear.
    noise : float
        Scatter of points inside cells, mm.
    residual_before, residual_after : (m,) float
        Cell means minus the model (pose only; all), mm.
    use : (m,) bool
        Cells outside wear and edges.
    covariance : CellCovariance
        Of what is left: patterns have none of their own.
    worn_sides : frozenset of Side
        Sides worn throughout, whose flanks were left out.
    context : Context
    tried : int
        Candidates tried.
    level_std : (float, float)
        Standard deviation of the mean of all left and of all right flanks under the model, mm: what pose and effects leave uncertain
        there, above all on a side that was not used.
    patterns : tuple of Pattern
        What no effect explains; taken out of `residual_after` without a name.
    hidden : (m, k) float or None
        What effects too small to be found may leave in each cell, mm: the columns' outer products add up to its covariance.
    made : MadeHeight or None
        How high sides may stand as they were made that do not show it. None where a scan of the gear unworn shows it.
    others : tuple of Loop
        The same scan explained with other sides worn throughout, as far as it does not exclude them.
    correlations : tuple of Correlation
        Between the sizes of different effects, the strongest first.
    worn_flanks : (teeth, 2) bool or None
        Single flanks that are worn all over, and were left out; None where none had to be.
    sides_sure : bool
        Whether it is beyond doubt which sides are worn throughout (`SideCosts.beyond_doubt`).
    sides_ruled_out : frozenset of frozenset of Side
        Sides that beyond doubt are not worn throughout together, with the others sound (`SideCosts.ruled_out`).
    untold : UntoldFlanks or None
        Flanks that are no datum where every tooth has amounts of its own; None where each is.
    together : (m,) float or None
        What effects that take each other back do to the deviation of each cell together, beside the pose, mm; None where none do.
    no_datum : frozenset of Side
        Sides that may be worn throughout as far as the scan tells, and without whose flanks nothing holds the gear: what these have in common may be as they
        were made, or lost (`no_datum`).
    """

    effects: tuple[FoundEffect, ...]
    form: tuple[FoundEffect, ...]
    motion: Floats
    rms_before: float
    rms_after: float
    held_out_before: float
    held_out_after: float
    noise: float
    residual_before: Floats
    residual_after: Floats
    use: Bools
    covariance: CellCovariance
    worn_sides: frozenset[Side]
    context: Context
    tried: int
    patterns: tuple[Pattern, ...]
    level_std: tuple[float, float] = (0.0, 0.0)
    hidden: Floats | None = None
    made: MadeHeight | None = None
    others: tuple[Loop, ...] = ()
    correlations: tuple[Correlation, ...] = ()
    worn_flanks: Bools | None = None
    sides_sure: bool = False
    sides_ruled_out: frozenset[frozenset[Side]] = frozenset()
    untold: UntoldFlanks | None = None
    together: Floats | None = None
    no_datum: frozenset[Side] = frozenset()

    @property
    def undecided(self) -> tuple[frozenset[Side], ...]:
        """What else may be worn throughout as far as the scan tells."""
        return tuple(other.worn_sides for other in self.others)

    @property
    def as_made_std(self) -> tuple[float, float]:
        """Standard deviation of how high the flanks of left and right stood as they were made, mm: of `level_std` and `made`."""
        made = MadeHeight() if self.made is None else self.made
        left, right = (math.hypot(self.level_std[side.index], made.of(side)) for side in Side)
        return left, right

    @property
    def scale(self) -> float:
        """By what ratio the scan was found to be too large; 0 where it was not."""
        (ppm,) = EFFECT.parameters
        return sum(1e-6 * float(np.max(effect.parameters[ppm.name].value)) for effect in self.effects if effect.name == SCALE)

    @property
    def left(self) -> Floats:
        """What neither effects nor patterns take out, mm, (m,)."""
        return np.asarray(self.residual_after - sum(pattern.field for pattern in self.patterns), dtype=np.float64)

    @property
    def form_of_all(self) -> Floats:
        """The form that all teeth have and no effect explains, mm, (m,)."""
        return form_of_all(self.patterns, len(self.residual_after))

    @property
    def without_a_name(self) -> Floats:
        """The form that all teeth have and no effect explains, or only effects that take each other back, mm, (m,)."""
        return self.form_of_all + (0.0 if self.together is None else self.together)

    def thinner_by(self, flanks: SurfacePoints) -> float:
        """By how much the effects of the maker lower every one of some points on flanks, mm: what an even loss would do as well."""
        return sum(effect.lowers_by(flanks, self.context) for effect in self.effects if effect.kind is Kind.MANUFACTURE)

    @property
    def in_space(self) -> tuple[SpaceWave, ...]:
        """The patterns that are waves in space."""
        return tuple(pattern.in_space for pattern in self.patterns if pattern.in_space is not None)

    @property
    def unexplained_rms(self) -> float:
        """RMS of the patterns together, mm; 0 without any."""
        return math.sqrt(sum(pattern.rms**2 for pattern in self.patterns))

    def deviation(self, points: SurfacePoints, kinds: frozenset[Kind]) -> Floats:
        """What the effects of some kinds do to the deviation of points, mm, (n,)."""
        return self._sum((effect for effect in (*self.effects, *self.form) if self.stands_as(effect) in kinds), points)

    def stands_as(self, effect: FoundEffect) -> Kind:
        """The effect's kind; FORM where its drawing says that what a scanner does may as well be how the part was made."""
        return Kind.FORM if effect.candidate.effect.as_made(self.context) else effect.kind

    @property
    def either(self) -> tuple[FoundEffect, ...]:
        """Effects of the maker that the scan cannot tell from one of the scanner or the mounting, and these from one of the maker."""
        known = named_effects()

        def others(effect: FoundEffect) -> set[Kind]:
            return {known[name].kind for name in effect.alternatives if name in known}

        return tuple(
            effect
            for effect in self.effects
            if (effect.kind in MADE and others(effect) & MEASURED) or (effect.kind in MEASURED and others(effect) & MADE)
        )

    def as_other(self, effect: FoundEffect, points: SurfacePoints) -> Floats:
        """By how much the gear would stand higher at points (n,) were one of `either` of the other kind, mm."""
        return self.of_effect(effect, points) * (1.0 if effect.kind in MEASURED else -1.0)

    def of_effect(self, effect: FoundEffect, points: SurfacePoints) -> Floats:
        """What one of the effects does to the deviation of points, mm, (n,)."""
        return self._sum([effect], points)

    def surely_made(self, points: SurfacePoints) -> Floats:
        """What the maker did to the deviation of points, mm, (n,), without what the scanner may have done as well."""
        known = named_effects()
        made = (effect for effect in (*self.effects, *self.form) if self.stands_as(effect) in MADE)
        sure = (e for e in made if all(known[name].kind is not Kind.MEASUREMENT for name in e.alternatives if name in known))
        return self._sum(sure, points)

    def _sum(self, effects: Iterable[FoundEffect], points: SurfacePoints) -> Floats:
        total = np.zeros(len(points))
        for effect in effects:
            total += effect.candidate.effect.basis(points, self.context, effect.candidate.shape) @ effect.amplitudes
        return total

    def headline(self) -> str:
        return (
            f"{counted(len(self.effects), 'effect')} of {self.tried} candidates, RMS {1e3 * self.rms_before:.2f} → {1e3 * self.rms_after:.2f} µm "
            f"(left out: {1e3 * self.held_out_before:.2f} → {1e3 * self.held_out_after:.2f} µm), noise {1e3 * self.noise:.2f} µm"
        )

    def rows(self) -> list[CardRow]:
        rows = [
            (effect.name, "; ".join(f"{name} {text}" for name, text in effect.rows()[: len(effect.parameters)]))
            for effect in self.effects
        ]
        return few(rows) + [("unexplained", pattern.describe(self.context.gear.face_width)) for pattern in self.patterns]


def account(
    fit: Fit, problem: Problem, model: Model, evidence: list[Evidence], fold: Ints, patterns: tuple[Pattern, ...], noise: float
) -> Loop:  # fmt: skip
    """Order the effects by gain, and follow the error from step to step.

    Parameters
    ----------
    fit, problem : Fit, Problem
        The final fit and its search problem.
    model : Model
        The accepted effects.
    evidence : list of Evidence
        One per effect.
    fold : (m,) int
        Folds for the left-out error.
    patterns : tuple of Pattern
        What is unexplained.
    noise : float
        Scatter of points, mm.
    """
    evidence, together = _with_taken_back(fit, problem, model, evidence)
    order = _by_gain(problem, model)
    order.sort(key=lambda i: not _unnamed(model[i], evidence[i], problem.context))  # what the drawing leaves open first
    model, evidence = tuple(model[i] for i in order), [evidence[i] for i in order]
    steps = [fit.errors(model[:n], fold) for n in range(len(model) + 1)]
    amplitudes, parts = _amplitudes(fit, problem, model), fit.parts(model)
    joint, places = fit.joint_uncertainty(model, amplitudes, problem.context, noise)
    spread = [joint[np.ix_(at, at)] for at in places]
    found, known = list[FoundEffect](), list[EffectSize]()
    for i, (candidate, part) in enumerate(zip(model, parts, strict=True)):
        ranges = candidate.effect.bracket(candidate.shape, problem.context)
        values = np.concatenate([candidate.effect.magnitudes(amplitudes[part]), candidate.shape[: len(ranges)]])
        form = (rules().form_error_with_shape if ranges else rules().form_error) * values
        spread_and_form = spread[i] + np.diag(form**2)
        jumps = jump_deviations(fit, model, i, problem.unit, problem.context)
        if jumps is not None:
            at = len(candidate.columns) + np.arange(len(jumps))
            spread_and_form[at] = spread_and_form[:, at] = 0.0
            spread_and_form[at, at] = jumps**2
        parameters = candidate.effect.estimates(amplitudes[part], spread_and_form, candidate.shape, problem.context)
        known += sizes(candidate, i, amplitudes[part], spread_and_form, places[i][: part.stop - part.start], problem.context)
        found.append(
            FoundEffect(
                candidate=candidate,
                amplitudes=amplitudes[part],
                parameters=parameters,
                alternatives=_or_views(
                    _explaining(fit, problem, model, i), fit, problem.context, candidate, amplitudes[part], evidence[i].size
                ),
                evidence=evidence[i],
                rms_before=steps[i][0],
                rms_after=steps[i + 1][0],
                held_out_before=steps[i][1],
                held_out_after=steps[i + 1][1],
                covariance=spread_and_form[: len(candidate.columns), : len(candidate.columns)],
            )
        )  # fmt: skip
    motion = np.zeros(6)
    motion[fit.dictionary.motion] = amplitudes[: len(fit.dictionary.pose)]
    levels = tuple(one for one, told in zip(found, evidence, strict=True) if _unnamed(one.candidate, told, problem.context))
    named = tuple(found[len(levels) :])
    told = problem.context.fillets_told and ROOT_FORM not in {candidate.name for candidate in model}
    # Without a sound side its teeth alone tell how well a gear was cut.
    one_sound = told and len(problem.context.worn) < len(Side)
    off = [
        fit.dictionary.take(one.candidate.columns) @ one.amplitudes
        for one in found
        if one.kind is Kind.MANUFACTURE
        and not (one_sound and one.candidate.effect.tooth_specific)  # fillets tell where a tooth stands
    ]
    made = MadeHeight()
    if worn := problem.context.open_sides:
        stand_off = fillets_off(fit, model, problem.context.worn) if told else 0.0
        besides = math.hypot(2.0 * bow_of_sound(fit, model, problem.context.worn), stand_off)
        from_one_end = any(face.side in worn for face in problem.context.faces)
        made = made_height(worn, fit, off, form_of_all(patterns, len(fit.target)), besides, from_one_end)
    hidden = fit.hidden(model, noise)
    start, end = steps[len(levels)], steps[-1]
    return Loop(
        effects=named,
        form=levels,
        motion=motion,
        rms_before=start[0],
        rms_after=end[0],
        held_out_before=start[1],
        held_out_after=end[1],
        noise=noise,
        residual_before=fit.residual(model[: len(levels)]),
        residual_after=fit.residual(model),
        use=fit.use,
        covariance=fit.covariance,
        worn_sides=problem.context.worn_sides,
        context=problem.context,
        tried=len(problem.dictionary.candidates),
        patterns=patterns,
        level_std=fit.level_std(model, hidden),
        hidden=hidden,
        made=made,
        others=(),
        correlations=correlations(known, joint),
        together=together,
    )


def _amplitudes(fit: Fit, problem: Problem, model: Model) -> Floats:
    """Of the pose and the effects of a model. A flank side nobody could use was made like the other; its own value is reported as not known."""
    which = problem.columns(model)
    amplitudes, _ = problem.gram.solve(which)
    for part in fit.parts(model):
        seen = np.diag(problem.gram.information[0])[which[part]] > 0.0
        if seen.any() and not seen.all():
            amplitudes[part] = np.where(seen, amplitudes[part], amplitudes[part][seen].mean())
    return amplitudes


def _unnamed(candidate: Candidate, evidence: Evidence, context: Context) -> bool:
    """Whether an effect is no finding: open by the drawing, faint, or taken back by others."""
    effect = candidate.effect
    return effect.kind is Kind.FORM or effect.as_made(context) or evidence.faint or evidence.taken_back


def _with_taken_back(fit: Fit, problem: Problem, model: Model, evidence: list[Evidence]) -> tuple[list[Evidence], Floats | None]:
    """The evidence, with the effects that others take back, and what these do together; amounts of each tooth, and levels that the drawing leaves open,
    take nothing back."""
    at = [i for i, one in enumerate(model) if not (one.effect.tooth_specific or one.effect.kind is Kind.FORM)]
    if len(at) < 2:
        return evidence, None
    fields = fit.fields(model, _amplitudes(fit, problem, model), at)
    back = taken_back(fields, fit.weight, fit.cells.points.surface)
    told = dict(zip(at, back.tolist(), strict=True))
    together = np.where(fit.cells.seen, fields[:, back].sum(axis=1), 0.0) if back.any() else None
    return [replace(one, taken_back=told.get(i, False)) for i, one in enumerate(evidence)], together


def _explaining(fit: Fit, problem: Problem, model: Model, index: int) -> tuple[str, ...]:
    """What else of the catalogue would explain what an effect does."""
    return tuple(sorted({*alternatives(problem, model, index), *as_smooth_form(fit, problem, model, index)}))


def _or_views(
    names: tuple[str, ...], fit: Fit, context: Context, candidate: Candidate, amplitudes: Floats, size: float
) -> tuple[str, ...]:
    """The alternatives of an effect, with a view out of place where views may lie apart in the scan and may have done the same."""
    if context.views_apart == 0.0 or candidate.name == VIEW_REGISTRATION or VIEW_REGISTRATION in names:
        return names
    field = fit.dictionary.take(candidate.columns) @ amplitudes
    by_views = may_be_views(fit.cells.points, field, fit.use, size, context.views_apart)
    return tuple(sorted((*names, VIEW_REGISTRATION))) if by_views else names


def form_of_all(patterns: tuple[Pattern, ...], cells: int) -> Floats:
    """What patterns have in common on all teeth, (cells,) mm."""
    forms = [pattern.field for pattern in patterns if pattern.of_all_teeth]
    return np.asarray(np.sum([np.zeros(cells), *forms], axis=0), dtype=np.float64)


def _by_gain(problem: Problem, model: Model) -> list[int]:
    """Order in which the effects lower the error most."""
    left: list[int] = list(range(len(model)))
    order: list[int] = []
    while left:
        base = problem.columns(tuple(model[i] for i in order))
        gains = problem.gram.gains(base, [model[i].columns for i in left])
        order.append(left.pop(int(np.argmax(gains))))
    return order
