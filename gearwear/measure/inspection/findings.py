"""The worst of every deviation on either side, graded."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.profiles import LEFT, RIGHT
from gearwear.measure.inspection.estimate import Estimate
from gearwear.measure.inspection.evaluation import Evaluation
from gearwear.measure.inspection.grading import Finding, Grade, Verdict, grade
from gearwear.measure.inspection.pitch import Pitch, Runout
from gearwear.measure.inspection.tolerances import Edition, Size


@dataclass(frozen=True, slots=True)
class Judge:
    """What findings are graded by: `size`, `edition`, `required` class or None, and `sector` as in `grading.grade`; `graded` is False
    where the standard does not cover the gear."""

    size: Size
    edition: Edition
    required: int | None
    sector: int
    graded: bool

    def finding(self, quantity: str, side: int | None, tooth: int | None, one: Estimate, seen: int) -> Finding:
        """One deviation with its grade."""
        value, expanded = float(one.value), float(one.expanded)
        if self.graded:
            mark = grade(quantity, value, expanded, self.size, self.edition, self.required, self.sector)
        else:
            mark = Grade(None, None, None, np.nan, Verdict.NO_TOLERANCE if np.isfinite(value) else Verdict.NOT_SEEN)
        return Finding(quantity, side, tooth, value, expanded, float(one.noise), seen, mark)


def worst_findings(
    judge: Judge, profile: Evaluation, helix: Evaluation, pitch: Pitch, balls: Runout | None
) -> tuple[Finding, ...]:
    """The worst flank of each profile and helix deviation, the pitch deviations of each side, and runout."""
    out = []
    for name, evaluation in (("profile", profile), ("helix", helix)):
        for part in ("slope", "form", "total"):
            estimate: Estimate = getattr(evaluation, part)
            for side in (LEFT, RIGHT):
                worst, seen = _worst(estimate.value[:, side])
                out.append(judge.finding(f"{name}_{part}", side, worst, estimate.at(worst or 0, side), seen))
    for quantity, whole in (
        ("single_pitch", pitch.single_greatest),
        ("adjacent_pitch", pitch.adjacent),
        ("sector_pitch", pitch.sector_greatest),
        ("cumulative_pitch", pitch.cumulative),
    ):
        for side in (LEFT, RIGHT):
            one, tooth = whole.at(side), None
            if quantity == "single_pitch" and np.isfinite(one.value):  # it has a place and a sign
                tooth, _ = _worst(pitch.single.value[:, side])
                one = Estimate(math.copysign(1.0, pitch.single.value[tooth, side]) * one.value, one.standard, one.noise)
            out.append(judge.finding(quantity, side, tooth, one, int(np.isfinite(pitch.index.value[:, side]).sum())))
    if balls is not None:
        out.append(judge.finding("runout", None, None, balls.runout, int(np.isfinite(balls.radial.value).sum())))
    return tuple(out)


def _worst(values: Floats) -> tuple[int | None, int]:
    """Which is greatest in amount, None where nothing was seen; how many were seen."""
    size = np.abs(values)
    seen = int(np.isfinite(size).sum())
    return (int(np.nanargmax(size)) if seen else None), seen
