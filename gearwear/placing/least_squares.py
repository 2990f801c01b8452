"""Weighted least squares of motions: directions that are not seen, and errors that belong together."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints


def solved(columns: Floats, target: Floats, weight: Floats) -> Floats:
    """Weighted least squares by the normal equations; directions the data do not see get no motion."""
    return inverse(columns.T @ (columns * weight[:, None])) @ (columns.T @ (weight * target))


def inverse(information: Floats) -> Floats:
    """Inverse on the directions that are seen, zero on the others."""
    scale = np.sqrt(np.maximum(np.diag(information), 0.0))  # of a robust fit of what does not fit it may be negative
    scale[scale == 0.0] = 1.0
    value, vector = np.linalg.eigh(information / np.outer(scale, scale))
    keep = value > 1e-7
    return np.asarray((vector[:, keep] / value[keep]) @ vector[:, keep].T / np.outer(scale, scale))


def clustered(columns: Floats, influence: Floats, slope: Floats, cluster: Ints) -> Floats:
    """Covariance of a robust fit whose residuals belong together in clusters.

    Parameters
    ----------
    columns : (n, p) float
        Of the fit.
    influence, slope : (n,) float
        ψ(r) and its derivative, times the base weight.
    cluster : (n,) int
        Any label.

    Returns
    -------
    (p, p) float

    Notes
    -----
    Sandwich of an M-estimator (Huber & Ronchetti 2009, 6.3): the bread is made of ψ′, not of the weights ψ / r, which are larger and
    would make the standard deviations a sixth too small. Each cluster's score is what leaving it out would change (jackknife over
    clusters), so that few clusters are no excuse; at most tenfold, where one cluster alone sees a motion.
    """
    _, label = np.unique(cluster, return_inverse=True)
    p = columns.shape[1]
    score: Floats = np.column_stack([np.bincount(label, column * influence) for column in columns.T]).astype(np.float64)
    information = np.empty((len(score), p, p))
    for i in range(p):
        for j in range(i + 1):
            information[:, i, j] = information[:, j, i] = np.bincount(label, columns[:, i] * columns[:, j] * slope)
    whole = information.sum(axis=0)
    value, vector = np.linalg.eigh(inverse(whole))
    root = (vector * np.sqrt(np.maximum(value, 0.0))) @ vector.T  # of the bread
    share, direction = np.linalg.eigh(root @ information @ root)  # of what is known, by cluster
    unshared = np.maximum(1.0 - share, 0.1)
    moved = np.einsum("gij,gj->gi", direction / unshared[:, None, :], np.einsum("gij,gi->gj", direction, score @ root)) @ root
    moved[:, np.diag(whole) == 0.0] = 0.0  # not seen: no rounding in its place
    return np.asarray(moved.T @ moved)
