"""Non-negative least squares for the mean of several profiles, with the covariance of its coefficients."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gearwear.arrays import Bools, Floats

LEAST_STD = 1e-9
"""mm; least standard deviation of a profile that came without one."""


def profile_covariance(roll: Floats, errors: Floats | None, correlation_length: float) -> Floats:
    """Covariance of the depth from its standard deviation, or unit variance where there is none; a covariance stays."""
    if errors is not None and errors.ndim == 2:
        return errors
    likeness = np.eye(len(roll))
    if correlation_length > 0.0:
        likeness = np.exp(-np.abs(roll[:, None] - roll) / correlation_length)
    return likeness if errors is None else errors[:, None] * likeness * errors


def error_size(bases: list[Floats], depth: Floats, covariance: Floats) -> float:
    """Variance of the mean depth, mm²: from what the best model leaves; with several teeth from what each leaves of a fit of its own
    beside the mean."""
    teeth = len(depth)
    if teeth == 1:
        fits = [fitted(basis, depth, covariance) for basis in bases]
        return max(min(fit.chi_square / fit.degrees_of_freedom for fit in fits), LEAST_STD * LEAST_STD)
    white = np.linalg.inv(np.linalg.cholesky(covariance))
    basis, apart = white @ bases[0][:, _told_apart(bases[0])], white @ (depth - depth.mean(axis=0)).T
    left = apart - basis @ np.linalg.lstsq(basis, apart, rcond=None)[0]
    scatter = float((left**2).sum()) / ((teeth - 1) * (basis.shape[0] - basis.shape[1]))
    return max(float(scatter / teeth), LEAST_STD * LEAST_STD)


class Fitted(NamedTuple):
    """What `gearwear.wear_law.fit.WearFit` says of a fit, under the same names."""

    coefficients: Floats
    covariance: Floats
    freedom: Floats
    estimator: Floats
    chi_square: float
    degrees_of_freedom: int


def fitted(basis: Floats, depth: Floats, errors: Floats) -> Fitted:
    """Fit the mean of `depth` (teeth, n), whose errors have this covariance, by the columns of `basis` (n, 3)."""
    from scipy.optimize import nnls

    apart = _told_apart(basis)
    white = np.linalg.inv(np.linalg.cholesky(errors))
    columns, mean = white @ basis[:, apart], white @ depth.mean(axis=0)
    amounts, norm = nnls(columns, mean)
    free, teeth = len(mean) - int(apart.sum()), len(depth)
    covariance = np.linalg.inv(columns.T @ columns)
    single = covariance @ columns.T @ white @ depth.T  # without bounds, tooth by tooth
    covariance = covariance * max(1.0, norm**2 / free)
    freedom = np.full(len(covariance), np.inf)
    if teeth > 1:
        covariance, freedom = _greater(covariance, np.atleast_2d(np.cov(single)) / teeth, teeth - 1)
    active = columns[:, amounts > 0.0]
    estimator = np.zeros((len(apart), len(mean)))
    estimator[np.flatnonzero(apart)[amounts > 0.0]] = np.linalg.lstsq(active, white, rcond=None)[0]
    terms = len(apart)
    coefficients, all_covariance, all_freedom = np.zeros(terms), np.zeros((terms, terms)), np.full(terms, np.inf)
    coefficients[apart], all_freedom[apart] = amounts, freedom
    all_covariance[np.ix_(apart, apart)] = covariance
    return Fitted(coefficients, all_covariance, all_freedom, estimator, float(norm) ** 2, free)


def _greater(known: Floats, scattered: Floats, freedom: int) -> tuple[Floats, Floats]:
    """The greater of two covariances, direction by direction, and the degrees of freedom of its variances (Satterthwaite 1946), when
    the second has so few: where that is the greater, all of it is from the scatter, not only what the first lacks."""
    root = np.linalg.cholesky(known)
    inward = np.linalg.inv(root)
    value, vector = np.linalg.eigh(inward @ scattered @ inward.T)
    axes = root @ vector
    whole = (axes * np.maximum(value, 1.0)) @ axes.T
    share = axes**2 @ np.where(value > 1.0, value, 0.0) / np.diag(whole)
    return whole, freedom / np.maximum(share, 1e-9) ** 2


def _told_apart(basis: Floats) -> Bools:
    """Which terms to fit: those that vary along the profile, and of those that do not the uniform one."""
    apart = np.array([float(np.ptp(column)) > 0.0 for column in basis.T])
    apart[1] = True
    return apart
