"""The smooth form of every flank as a profile form, a helix form and a twist, by least squares on its points themselves.

A trace is the mean over a band. Where a scan is thin, the few points of one place of the trace lie anywhere across the band, and what the
flank does across would scatter along. `levelled` takes that out. What the fit leaves tells how much a point of a thin scan scatters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import legendre

from gearwear.arrays import Floats, Ints
from gearwear.inspection.traces import STRAY_SHARE, FlankSamples, Traces
from gearwear.robust import NORMAL_MAD, median_scale

DEGREES = ((60, 4, 3, True), (30, 2, 2, True), (12, 1, 1, False), (0, 0, 0, False))
"""Points from which a flank has a form of these degrees along L and along z, and a twist."""

CUT = 0.02
"""Singular values less than this share of the greatest say nothing: where half of a flank is missing its form is not carried on far."""

PARTLY = 1.5
"""Of the 2 that an area is wide: a flank seen over less has no form but a slope that way."""

STRAY = 5.0
"""Scaled MADs beyond which a point does not count in the fit."""

THIN = 600
"""Points of a flank, below which the scatter about its form counts for their noise: pieces of its traces hold too few to tell."""


@dataclass(frozen=True, slots=True)
class AdditiveForm:
    """Forms of all flanks over an area.

    Parameters
    ----------
    roll, z : (float, float)
        The area, L to L and z to z, mm.
    along_roll, along_z : (flanks, 5), (flanks, 4) float
        Legendre coefficients from −1 to 1 over the area, mm; the constants are 0.
    twist : (flanks,) float
        Of the product of both places, mm.
    level : (flanks,) float
        mm.
    scatter : (flanks,) float
        Robust standard deviation of a point about the form, mm; nan where there are too few.
    lever : (flanks, 2) float
        Standard deviations of the slopes along L and along z, for points that scatter by 1.
    """

    roll: tuple[float, float]
    z: tuple[float, float]
    along_roll: Floats
    along_z: Floats
    twist: Floats
    level: Floats
    scatter: Floats
    lever: Floats

    def at(self, flank: Ints, roll: Floats, z: Floats) -> Floats:
        """The form of these flanks at these places, (n,) mm; beyond the area as at its edge."""
        u, v = _place(roll, self.roll), _place(z, self.z)
        profile = (legendre.legvander(u, self.along_roll.shape[1] - 1) * self.along_roll[flank]).sum(axis=1)
        helix = (legendre.legvander(v, self.along_z.shape[1] - 1) * self.along_z[flank]).sum(axis=1)
        return np.asarray(self.level[flank] + profile + helix + self.twist[flank] * u * v)


def additive_form(samples: FlankSamples, roll: tuple[float, float], z: tuple[float, float]) -> AdditiveForm:
    """Fit every flank's form inside the area `roll` × `z`, mm."""
    flanks = 2 * samples.gear.teeth
    along_roll, along_z = np.zeros((flanks, DEGREES[0][1] + 1)), np.zeros((flanks, DEGREES[0][2] + 1))
    twist, level = np.zeros((2, flanks))
    lever = np.zeros((flanks, 2))
    scatter = np.full(flanks, np.nan)
    samples = samples.inside(roll, z)
    for flank, mine in enumerate(samples.by_flank()):
        if not len(mine):
            continue
        _, p, h, twisted = next(row for row in DEGREES if len(mine) >= row[0])
        u, v, y = _place(samples.roll[mine], roll), _place(samples.z[mine], z), samples.deviation[mine]
        reach = [float(np.ptp(np.quantile(place, (0.02, 0.98)))) for place in (u, v)]
        p, h = (degree if wide >= PARTLY else min(degree, 1) for degree, wide in zip((p, h), reach, strict=True))
        twisted = twisted and min(reach) >= PARTLY
        parts = [legendre.legvander(u, p), legendre.legvander(v, h)[:, 1:], (u * v)[:, None][:, : int(twisted)]]
        columns = np.hstack(parts)
        solution = _fit(columns, y, robust=len(mine) < THIN)
        misfit = np.abs(y - columns @ solution)
        near = misfit <= STRAY * NORMAL_MAD * np.median(misfit) + 1e-12
        if len(mine) < THIN or not near.all():  # least absolute deviations go through some points
            solution = _fit(columns[near], y[near], robust=False)
            misfit = np.abs(y - columns @ solution)
        freedom = len(mine) - columns.shape[1]
        level[flank] = solution[0]
        along_roll[flank, 1 : p + 1] = solution[1 : p + 1]
        along_z[flank, 1 : h + 1] = solution[p + 1 : p + 1 + h]
        twist[flank] = solution[-1] if twisted else 0.0
        covariance = np.linalg.pinv(columns[near], rcond=CUT)
        covariance = covariance @ covariance.T
        lever[flank] = [math.sqrt(covariance[k, k]) if degree else 0.0 for k, degree in ((1, p), (p + 1, h))]
        if freedom >= 5:
            # What is left is too small by what the form has taken; a MAD of few (Croux and Rousseeuw 1992).
            few = math.sqrt(len(mine) / freedom) * len(mine) / (len(mine) - 0.8)
            scatter[flank] = few * NORMAL_MAD * np.median(misfit)
    # A flank too thin to have a slope of its own has one like the others' all the same.
    for column, slopes in enumerate((along_roll[:, 1], along_z[:, 1])):
        sloped = lever[:, column] > 0.0
        if sloped.any() and np.isfinite(scatter).any():
            lever[~sloped, column] = median_scale(slopes[sloped])[1] / max(float(np.nanmedian(scatter)), 1e-9)
    return AdditiveForm(roll, z, along_roll, along_z, twist, level, scatter, lever)


def levelled(samples: FlankSamples, form: AdditiveForm, along: str, band: tuple[float, float]) -> FlankSamples:
    """The samples without what the form does across the traces.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    form : AdditiveForm
        Of them.
    along : str
        "roll" for profiles, "z" for helices.
    band : (float, float)
        What the trace is the mean over, z to z or L to L, mm: there what is taken off has the mean 0, all along the trace.
    """
    nodes, weights = legendre.leggauss(8)
    across = 0.5 * (band[0] + band[1]) + 0.5 * (band[1] - band[0]) * nodes
    n = len(samples)
    mean: Floats = np.zeros(n)
    for place, weight in zip(across, 0.5 * weights, strict=True):
        places = np.full(n, place)
        mean += weight * (
            form.at(samples.flank, samples.roll, places) if along == "roll" else form.at(samples.flank, places, samples.z)
        )
    return replace(samples, deviation=samples.deviation - form.at(samples.flank, samples.roll, samples.z) + mean)


def levelling_errors(form: AdditiveForm, traces: Traces, scatter: float) -> Floats:
    """What `levelled` adds to the errors of the bins, (teeth, 2, n) mm, all of a flank's together: where its points do not lie round the middle
    of the band, what is left of its slope across. `scatter` is the standard deviation of one point, mm, with what hangs together."""
    roll = traces.along == "roll"
    limits, lever = (form.z, form.lever[:, 1]) if roll else (form.roll, form.lever[:, 0])
    off = 2.0 * (0.5 * (traces.band[0] + traces.band[1]) - traces.across) / (limits[1] - limits[0])
    return np.asarray(np.nan_to_num(off) * scatter * lever.reshape(-1, 2)[..., None])


def is_thin(samples: FlankSamples) -> bool:
    """Fewer than `THIN` points on the usual flank."""
    return len(samples) > 0 and samples.per_flank < THIN


def thin_scatter(samples: FlankSamples, form: AdditiveForm) -> float | None:
    """Standard deviation of a point of a thin scan about its flank's form, the flanks' median, mm; None of a dense scan."""
    known = np.isfinite(form.scatter)
    if not known.any() or not is_thin(samples):
        return None
    return float(np.median(form.scatter[known]))


def without_strays(samples: FlankSamples, form: AdditiveForm, noise: float) -> FlankSamples:
    """The samples without single points far off their flank's form; where more than `STRAY_SHARE` of a flank is, it is the surface."""
    off = np.abs(samples.deviation - form.at(samples.flank, samples.roll, samples.z))
    scale = np.maximum(np.nan_to_num(form.scatter), noise)[samples.flank]
    inside = (samples.roll >= form.roll[0]) & (samples.roll <= form.roll[1]) & (samples.z >= form.z[0]) & (samples.z <= form.z[1])
    far = inside & (off > STRAY * scale)
    flanks = len(form.level)
    share = np.bincount(samples.flank[far], minlength=flanks) / np.maximum(
        np.bincount(samples.flank[inside], minlength=flanks), 1
    )
    return samples.take(~(far & (share <= STRAY_SHARE)[samples.flank]))


def clipped(samples: FlankSamples, form: AdditiveForm, noise: float) -> FlankSamples:
    """The samples no farther off their flank's form than a stray may be: a rounded edge is no texture."""
    smooth = form.at(samples.flank, samples.roll, samples.z)
    limit = STRAY * np.maximum(np.nan_to_num(form.scatter), noise)[samples.flank]
    return replace(samples, deviation=smooth + np.clip(samples.deviation - smooth, -limit, limit))


def _fit(columns: Floats, y: Floats, robust: bool) -> Floats:
    """Least squares, or least absolute deviations by reweighting."""
    weight: Floats = np.ones(len(y))
    solution = np.linalg.lstsq(columns, y, rcond=CUT)[0]
    for _ in range(8 if robust else 0):
        misfit = np.abs(y - columns @ solution)
        weight = 1.0 / np.sqrt(np.maximum(misfit, 0.1 * np.median(misfit) + 1e-12))
        solution = np.linalg.lstsq(columns * weight[:, None], y * weight, rcond=CUT)[0]
    return np.asarray(solution)


def _place(x: Floats, limits: tuple[float, float]) -> Floats:
    return np.clip(2.0 * (x - limits[0]) / (limits[1] - limits[0]) - 1.0, -1.0, 1.0)
