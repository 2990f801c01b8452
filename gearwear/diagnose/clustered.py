"""Least squares over cells of teeth that each scatter by themselves."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints


def fit_by_teeth(design: Floats, weight: Floats, values: Floats, tooth: Ints) -> tuple[Floats, Floats] | None:
    """Sizes of some columns that fit values best, and their covariance by what the teeth scatter about that.

    Parameters
    ----------
    design : (n, p) float
    weight, values : (n,) float
    tooth : (n,) int

    Returns
    -------
    (p,) float, (p, p) float
        None of no more teeth than columns: they do not tell how far the sizes are chance.

    Notes
    -----
    The covariance is that of clustered observations (Liang and Zeger 1986), with the factor n / (n − 1) of n teeth.
    """
    teeth, which = np.unique(tooth, return_inverse=True)
    if len(teeth) <= design.shape[1]:
        return None
    inverse = np.linalg.pinv(design.T @ (weight[:, None] * design), rcond=1e-9, hermitian=True)
    sizes = inverse @ (design.T @ (weight * values))
    scores = np.zeros((len(teeth), design.shape[1]))
    np.add.at(scores, which, design * (weight * (values - design @ sizes))[:, None])
    return sizes, inverse @ scores.T @ scores @ inverse * len(teeth) / (len(teeth) - 1)
