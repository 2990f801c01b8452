"""Exactly equal points, found by sorting one 64-bit hash per point."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints

FACTORS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
"""Odd 64-bit constants (golden ratio and xxHash primes)."""


def _hash(points: Floats) -> Ints:
    """One integer per point, (n,) uint64; equal for equal points. Must not depend on the sign of zero."""
    bits = np.ascontiguousarray(points + 0.0).view(np.uint64)  # + 0.0 turns −0.0 into 0.0
    mixed = bits[:, 0] * FACTORS[0]
    for axis in (1, 2):
        mixed ^= mixed >> np.uint64(32)
        mixed = (mixed + bits[:, axis]) * FACTORS[axis]
    return np.asarray(mixed ^ (mixed >> np.uint64(29)))


def first_of_each(points: Floats) -> tuple[Ints, Ints]:
    """Where each distinct point stands first, and which distinct point each one is.

    Parameters
    ----------
    points : (n, 3) float
        Finite.

    Returns
    -------
    first : (k,) int
        Increasing indices into `points`.
    label : (n,) int
        Index into `first` of each point's equal.

    Examples
    --------
    >>> first_of_each(np.array([[1.0, 0, 0], [2, 0, 0], [1, 0, 0]]))
    (array([0, 1]), array([0, 1, 0]))
    """
    n = len(points)
    hashes = _hash(points)
    ordered = np.sort(hashes)  # several times as fast as argsort, and mostly all that is needed
    if not (ordered[1:] == ordered[:-1]).any():
        return np.arange(n), np.arange(n)
    order = np.argsort(hashes, kind="stable")
    same = np.zeros(n, bool)  # as the one before; the points decide, the hash only brings them together
    same[1:] = (hashes[order[1:]] == hashes[order[:-1]]) & (points[order[1:]] == points[order[:-1]]).all(axis=1)
    leader = order[np.maximum.accumulate(np.where(same, 0, np.arange(n)))]
    standing = np.empty(n, np.intp)
    standing[order] = leader
    first = np.flatnonzero(standing == np.arange(n))
    number = np.empty(n, np.intp)
    number[first] = np.arange(len(first))
    return first, number[standing]
