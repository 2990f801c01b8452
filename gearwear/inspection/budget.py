"""An uncertainty budget after the GUM: what each quoted U is made of, type A and type B.

The causes that all flanks share stand in columns of `Estimate.shared`: the six motions of the registration (`registered.motion_errors`)
and, behind them, the relative scale, in which the instrument's calibration and the part's temperature are (type B). What a coat adds alike
everywhere changes no slope, form or pitch; of thickness and dimensions it is a deviation, not an uncertainty.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.inspection.dimensions import Dimensions, pin_growth
from gearwear.inspection.estimate import Estimate

MOTIONS = 6
"""Causes of the registration, tx, ty, tz, wx, wy, wz."""


@dataclass(frozen=True, slots=True)
class BudgetLine:
    """One quantity's standard uncertainties, mm: root mean squares over the flanks seen.

    Parameters
    ----------
    quantity : str
    own : float
        Type A: scatter of the points of the flank itself.
    registration : float
        Type A: how well the axis is known.
    scale : float
        Type B: instrument and temperature.
    noise : float
        What noise may have added to a range, at most.
    expanded : float
        U, k = 2.
    """

    quantity: str
    own: float
    registration: float
    scale: float
    noise: float
    expanded: float


def with_scale(covariance: Floats | None, scale_std: float) -> Floats | None:
    """The registration's covariance (6, 6) with the relative scale as a seventh cause, (7, 7); None where neither is known."""
    if scale_std == 0.0:
        return covariance
    joined = np.zeros((MOTIONS + 1, MOTIONS + 1))
    if covariance is not None:
        joined[:MOTIONS, :MOTIONS] = covariance[:MOTIONS, :MOTIONS]  # settings of an inspection have the scale in them
    joined[MOTIONS, MOTIONS] = scale_std**2
    return joined


def scaled_dimensions(dimensions: Dimensions, gear: Gear, scale_std: float) -> Dimensions:
    """Dimensions whose uncertainty holds that of the scale.

    Parameters
    ----------
    dimensions : Dimensions
    gear : Gear
        The nominal gear.
    scale_std : float
        Relative.

    Notes
    -----
    All of them follow the flanks, which a scale moves by s L along the transverse base tangent; gauges keep their size. A span touches at its
    two ends and changes by s W. Pins of diameter D touch at ``L = r_b tan α_M ∓ (D / 2) cos β_b``, are pushed out by ``s L / sin α_M`` each, and
    change the dimension by twice that, with an odd number of teeth times cos(90° / z): s M would be right if they grew too. The thickness has
    it from its flanks: ``2 s r tan α_t``.
    """
    if scale_std == 0.0:
        return dimensions

    def wider(estimate: Estimate, by: Floats | float) -> Estimate:
        return replace(estimate, standard=np.hypot(estimate.standard, scale_std * by))

    spans, over = dimensions.span_lengths, dimensions.pin_lengths
    scaled = replace(dimensions, span_lengths=wider(spans, np.abs(spans.value)))
    return scaled if dimensions.pins is None else replace(scaled, pin_lengths=wider(over, pin_growth(gear, dimensions.pins)))


def budget_line(quantity: str, estimate: Estimate, causes: int) -> BudgetLine:
    """The line of a quantity that every flank, or every tooth, has; `causes` of its shared errors are motions and scale."""
    shared = estimate.shared if estimate.shared is not None else np.zeros((*estimate.value.shape, 0))
    shared = shared[..., :causes]
    seen = np.isfinite(estimate.value)

    def typical(values: Floats) -> float:
        known = values[seen & np.isfinite(values)]
        return math.sqrt(float(np.mean(known**2))) if len(known) else math.nan

    return BudgetLine(
        quantity,
        typical(np.sqrt(np.maximum(estimate.standard**2 - (shared**2).sum(axis=-1), 0.0))),
        typical(np.sqrt((shared[..., :MOTIONS] ** 2).sum(axis=-1))),
        typical(np.sqrt((shared[..., MOTIONS : MOTIONS + 1] ** 2).sum(axis=-1))),
        typical(np.abs(estimate.noise)),
        typical(estimate.expanded),
    )
