"""The wear laws of the catalogue, sliding and uniform loss, on the flanks of each side: with a mate or without."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.abrasive_wear import AbrasiveWear
from gearwear.diagnose.effects.base import LEAST_ROLL, Context
from gearwear.diagnose.effects.sliding_wear import SlidingWear
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import CellGrid, Cells
from gearwear.wear.regions import Wear
from gearwear.wear_law.archard import load_share, specific_sliding
from gearwear.wear_law.fit import WearFit
from gearwear.wear_law.non_negative import fitted
from gearwear.wear_law.study import LEAST_EXPLAINED, WearStudy, tooth_profiles
from gearwear.wear_law.teeth import LEAST_TEETH, FittedLaw, alike_teeth

LEAST_PLACES = 8
"""Places along the profile from which on a law is fitted."""
LEAST_DEPTH_STDS = 2.0
"""Least amplitude that is reported, in its own standard deviations."""
NODES = 16
"""Places in a column over which a law is averaged."""

Law = Callable[[Floats], Floats]
"""Depth in mm at lengths of roll in mm."""


def fit_laws(
    wear: Wear,
    points: SurfacePoints,
    cells: Cells,
    context: Context,
    loop: Loop | None,
    noise: float,
    study: WearStudy | None = None,
) -> tuple[FittedLaw, ...]:
    """Fit d = A |K(L)| / |K(L_form)| + B, A and B not negative, to the flanks of each side that are worn alike on several teeth.

    Parameters
    ----------
    wear : Wear
        The wear found.
    points : SurfacePoints
        Flank points; `deviation` is from the as-made gear.
    cells : Cells
        The cells the wear was found on.
    context : Context
        With a mate K is the specific sliding, else it is linear in L from the reference circle.
    loop : Loop or None
        Where the as-made gear comes from.
    noise : float
        Scatter of points, mm.
    study : WearStudy or None
        The wear law with a mate: on its side A and B are those of its fit.

    Returns
    -------
    tuple of FittedLaw
        A law is reported where it is more than 2 standard deviations deep and both together explain more than half of the mean square
        depth of the worn cells, their noise taken off; a patch on one tooth follows none.
    """
    laws: list[FittedLaw] = []
    for side in Side:
        half = side.index
        teeth = alike_teeth(wear, half)
        if len(teeth) < LEAST_TEETH:
            continue
        if study is not None and study.side == side and study.fits:
            amounts, stds, law = _of_study(study.fits[0])
        else:
            roll, width, depth, errors = tooth_profiles(points, cells, half, teeth, loop, noise)
            if len(roll) < LEAST_PLACES:
                continue
            amounts, stds, law = _fit(context, roll, width, depth, errors)
        mask = (wear.mask & wear.side_maps.seen)[:, half, :, -cells.grid.flank :]
        mask = mask & np.isin(np.arange(len(mask)), teeth)[:, None, None]
        lost, count = (
            (-wear.side_maps.deviation)[:, half, :, -cells.grid.flank :],
            wear.side_maps.count[:, half, :, -cells.grid.flank :],
        )
        rest = lost - _over_columns(law, cells.grid, lost, mask)
        before, after = float(np.mean(lost[mask] ** 2)), float(np.mean(rest[mask] ** 2))
        white = float(np.mean(noise**2 / count[mask]))
        if after - white > (1.0 - LEAST_EXPLAINED) * (before - white):
            continue
        for name, amount, std in zip((SlidingWear.name, AbrasiveWear.name), amounts, stds, strict=True):
            if amount > LEAST_DEPTH_STDS * std:
                laws.append(FittedLaw(name, side, float(amount), float(std), math.sqrt(before), math.sqrt(after)))
    return tuple(laws)


def _fit(context: Context, roll: Floats, width: Floats, depth: Floats, errors: Floats) -> tuple[Floats, Floats, Law]:
    """Both laws on the profiles of the teeth: amplitudes, their standard deviations, and the depth they give."""
    form = float(context.sliding(np.array([context.gear.form_roll]))[0])

    def sliding(at: Floats) -> Floats:
        return np.abs(context.sliding(at) / form)

    edges = roll[:, None] + np.array([-0.5, 0.5]) * width[:, None]
    places = np.sqrt(edges[:, :1] ** 2 + np.diff(edges**2, axis=1) * (np.arange(NODES) + 0.5) / NODES)
    basis = np.column_stack([sliding(places.ravel()).reshape(places.shape).mean(axis=1), np.ones(len(roll)), np.zeros(len(roll))])
    fit = fitted(basis, depth, errors)
    a, b, _ = fit.coefficients
    return fit.coefficients[:2], np.sqrt(np.diag(fit.covariance))[:2], lambda at: a * sliding(at) + b


def _of_study(fit: WearFit) -> tuple[Floats, Floats, Law]:
    """The same of the wear law with a mate; at the form circle load is shared as in the contact that comes nearest to it."""
    path = fit.path
    edge = 1e-9 * path.length
    ends = path.start_pinion + edge, path.end_pinion - edge
    nearest = np.array([ends[0 if fit.gear.orientation > 0 else 1]])
    form = np.array([max(fit.gear.form_roll, LEAST_ROLL * fit.gear.transverse_module)])
    share = load_share(fit.gear, fit.mate, fit.centre_distance, nearest, fit.sharing)
    at_form = float((share * specific_sliding(fit.gear, fit.mate, fit.centre_distance, form))[0])
    std = fit.coefficient_stds

    def law(at: Floats) -> Floats:
        on = np.clip(at, *ends)
        return np.asarray(fit.terms(on) @ fit.coefficients, dtype=np.float64)

    scale = np.array([at_form, 1.0])
    return scale * fit.coefficients[:2], scale * std[:2], law


def _over_columns(law: Law, grid: CellGrid, lost: Floats, mask: Bools) -> Floats:
    """Depth by a law as the cells of each column show it, (columns,).

    Near the form circle K doubles within a column: it is averaged over the column, which is of equal weight in L² at the points' own radius.
    A point of the worn flank stands for the foot above it, nearer to the tip by the depth in the section.
    """
    rolls = grid.rolls(2 * NODES)[1::2].reshape(grid.flank, NODES)
    number = mask.sum(axis=(0, 1))
    mean = np.where(mask, lost, 0.0).sum(axis=(0, 1)) / np.maximum(number, 1)
    at = rolls + grid.gear.orientation * grid.gear.base_helix_cosine * np.maximum(mean, 0.0)[:, None]
    return np.asarray(law(at.ravel()).reshape(rolls.shape).mean(axis=1), dtype=np.float64)
