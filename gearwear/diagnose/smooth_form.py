"""Whether a relief of the profile may be no more than a smooth form: what a tool or a form grinding wheel leaves on all flanks, crowned and skew.

A relief begins at a knee. Where profiles that bend evenly fit as well, the scan shows that the flanks fall off, and not that they were relieved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, of_transverse, on_flank, profile_coordinate
from gearwear.diagnose.effects.profile_crowning import EFFECT as CROWNING
from gearwear.diagnose.effects.profile_slope import EFFECT as SLOPE
from gearwear.diagnose.effects.root_relief import RootRelief
from gearwear.diagnose.effects.tip_relief import TipRelief
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem
from gearwear.diagnose.shapes import Shaped, Trials


@dataclass(frozen=True)
class SmoothForm(CatalogueEffect):
    """δ = c₂ u² + c₃ u³ along the profile, the same on both flanks of every tooth: what slopes and a crowning leave of a form without a knee.

    Notes
    -----
    Two numbers, as a relief's amount and start. It has no name and is not searched: it only stands in a relief's place.
    """

    name: ClassVar[str] = "smooth_form"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "second order analysis: ISO 1328-1:2013, annex B, and one order more"
    tells_apart: ClassVar[str] = "Measure the profile on a gear tester: a relief begins at a knee."
    averaged: ClassVar[str] = "roll"
    phrase: ClassVar[str] = "a smooth form of the profiles"

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        u = np.where(on_flank(points), profile_coordinate(points, context.gear), 0.0)
        return of_transverse(np.column_stack([u**2, u**3]), context.gear)


def as_smooth_form(fit: Fit, problem: Problem, model: Model, index: int) -> tuple[str, ...]:
    """Names of effects that a relief of the profile may be instead, as part of a smooth form: none where its knee is seen.

    Beside the rest of the model and slopes of the profile, which a knee and a bend turn differently, the relief gains no more than `close` of
    cost over `SmoothForm`. The slopes are named too where a smooth form needs them and the model has none.
    """
    own, rest = model[index], (*model[:index], *model[index + 1 :])
    if not isinstance(own.effect, (TipRelief, RootRelief)):
        return ()
    trials = Trials.of(problem, fit.cells, fit.target, fit.use, fit.covariance)
    shaped: Shaped = tuple((one.effect, one.shape) for one in rest)
    of_flanks = (SLOPE, (0.0,))  # a wheel leaves the fillets alone, as a relief does
    with_slopes = shaped if of_flanks in shaped else (*shaped, of_flanks)

    def knee_gains(beside: Shaped) -> float:
        gain = trials.gain(beside)
        return (gain(own.effect, own.shape) - gain(SmoothForm(), ())) / problem.unit

    if not knee_gains(with_slopes) < rules().close:
        return ()
    sloped = any(one.name == SLOPE.name for one in rest) or knee_gains(shaped) < rules().close
    return (CROWNING.name,) if sloped else (CROWNING.name, SLOPE.name)
