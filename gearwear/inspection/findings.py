"""The worst of every deviation on either side, graded; and where the scan fell short."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.inspection.composite import Composite
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.evaluation import Evaluation
from gearwear.inspection.grading import Finding, Grade, Verdict, grade, graded
from gearwear.inspection.pitch import PitchDeviations, Runout
from gearwear.inspection.radial import GRADES, TOOTH_TO_TOOTH, TOTAL, check_radial, radial_tolerance
from gearwear.inspection.tolerances import Edition, Size


@dataclass(frozen=True, slots=True)
class Judge:
    """What findings are graded by: `size`, `edition`, `required` class or None, and `sector` as in `grading.grade`; `graded` is False
    where the standard does not cover the gear."""

    size: Size
    edition: Edition
    required: int | None
    sector: int
    graded: bool

    def finding(self, quantity: str, side: Side | None, tooth: int | None, estimate: Estimate, seen: int) -> Finding:
        """One deviation with its grade."""
        value, expanded = float(estimate.value), float(estimate.expanded)
        if self.graded:
            mark = grade(quantity, value, expanded, self.size, self.edition, self.required, self.sector)
        else:
            mark = Grade(None, None, None, np.nan, Verdict.NO_TOLERANCE if np.isfinite(value) else Verdict.NOT_SEEN)
        return Finding(quantity, side, tooth, value, expanded, float(estimate.noise), seen, mark)


def worst_findings(
    judge: Judge, profile: Evaluation, helix: Evaluation, pitch: PitchDeviations, balls: Runout | None
) -> tuple[Finding, ...]:
    """The worst flank of each profile and helix deviation, the pitch deviations of each side, and runout."""
    out = []
    for name, evaluation in (("profile", profile), ("helix", helix)):
        for part in ("slope", "form", "total"):
            estimate: Estimate = getattr(evaluation, part)
            for side in Side:
                worst, seen = _worst(estimate.value[:, side.index])
                out.append(judge.finding(f"{name}_{part}", side, worst, estimate.at(worst or 0, side.index), seen))
    for quantity, whole in (
        ("single_pitch", pitch.single_greatest),
        ("adjacent_pitch", pitch.adjacent),
        ("sector_pitch", pitch.sector_greatest),
        ("cumulative_pitch", pitch.cumulative),
    ):
        for side in Side:
            greatest, tooth = whole.at(side.index), None
            if quantity == "single_pitch" and np.isfinite(greatest.value):  # it has a place and a sign
                tooth, _ = _worst(pitch.single.value[:, side.index])
                greatest = Estimate(
                    math.copysign(1.0, pitch.single.value[tooth, side.index]) * greatest.value, greatest.standard, greatest.noise
                )
            out.append(judge.finding(quantity, side, tooth, greatest, int(np.isfinite(pitch.index.value[:, side.index]).sum())))
    if balls is not None:
        out.append(judge.finding("runout", None, None, balls.runout, int(np.isfinite(balls.radial.value).sum())))
    return tuple(out)


def radial_findings(size: Size, composite: Composite | None) -> tuple[Finding, ...]:
    """F_i″ and f_i″, graded by ISO 1328-2:1997: by value, since a class of ISO 1328-1 that a drawing asks for says nothing of them."""
    if composite is None:
        return ()
    out = []
    for quantity, estimate in ((TOTAL, composite.double_total), (TOOTH_TO_TOOTH, composite.double_tooth)):
        value, expanded = float(estimate.value), float(estimate.expanded)
        try:
            check_radial(size)
        except InputError:
            mark = Grade(None, None, None, np.nan, Verdict.NO_TOLERANCE)
        else:
            mark = graded(value, expanded, partial(radial_tolerance, quantity, size), GRADES)
        out.append(Finding(quantity, None, None, value, expanded, float(estimate.noise), 2 * size.teeth, mark))
    return tuple(out)


class Note(NamedTuple):
    """What a reader must know; `foremost` where numbers are read wrongly without it."""

    text: str
    foremost: bool


def limit_notes(coverage: Floats, least: float, profile: Evaluation, helix: Evaluation, section: bool) -> list[Note]:
    """Where the scan fell short of the standard, and which flanks have no result; `least` is the coverage a flank needs."""
    notes = list[Note]()
    covered = coverage >= least
    missing = [(f"less than {100 * least:.0f} % of the flank was seen", ~covered)]
    for name, evaluation in (("profile", profile),) if section else (("profile", profile), ("helix", helix)):
        if evaluation.cutoff > 1.01 * evaluation.range.cutoff:
            thin = (
                f"The scan is too thin for the standard's filter: in places the cut-off of the {name} is {evaluation.cutoff:.2f} mm in place of "
                f"{evaluation.range.cutoff:.2f} mm, and shorter waves are missing from its form deviation."
            )
            notes.append(Note(thin, foremost=True))
        evaluated = np.isfinite(evaluation.slope.value)
        if evaluated.any() and evaluation.share[evaluated].min() < 0.95:
            seen = (
                f"Of the {name} evaluation range as little as {100 * evaluation.share[evaluated].min():.0f} % was seen with enough points; the "
                "deviations are those of what was seen."
            )
            notes.append(Note(seen, foremost=False))
        missing.append((f"too large a gap in the {name} evaluation range", covered & ~evaluated))
    for why, flanks in missing:
        names = [f"{tooth + 1} {tuple(Side)[side]}" for tooth, side in zip(*np.nonzero(flanks), strict=True)]
        if names:
            notes.append(Note(f"Not seen ({why}): tooth {', '.join(names)}.", foremost=True))
    return notes


def _worst(values: Floats) -> tuple[int | None, int]:
    """Which is greatest in amount, None where nothing was seen; how many were seen."""
    size = np.abs(values)
    seen = int(np.isfinite(size).sum())
    return (int(np.nanargmax(size)) if seen else None), seen
