"""How a force distributes over elastic bodies that touch in many places: the contact problem itself.

Places i with forces F_i, a rigid advance l_i of each, and a symmetric positive definite compliance C. All give way together ::

    F_i ≥ 0,   s_i = A + (C F)_i − l_i ≥ 0,   F_i s_i = 0,   Σ F_i = F

with the advance A under load. The solution is unique (Conry & Seireg 1971). Many positions are solved at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.errors import InputError

MOST_ROUNDS = 200
"""Rounds after which a position counts as not solved; 10 to 20 are usual."""
_SINGLE_FROM = 40
"""Round from which on one place at a time changes between touching and free: slower, and without cycles."""
_FORCE_TOLERANCE = 1e-10
"""Share of the force to which the forces settle."""
_GAP_TOLERANCE = 1e-12
"""mm; a gap below it is none."""


class Distribution(NamedTuple):
    """Forces (p, n), N; the advance under load (p,), mm; its derivative by the force, −dA/dF (p,), mm/N."""

    force: Floats
    advance: Floats
    compliance: Floats


Local = Callable[[Floats, Bools], tuple[Floats, Floats]]
"""From forces (k, n) and the positions they are of, (p,) bool: secant and tangent compliance of each place by itself, mm/N."""


def distribute(advance: Floats, compliance: Floats, total: float, local: Local) -> Distribution:
    """Solve the contact problem for many positions.

    Parameters
    ----------
    advance : (p, n) float
        Rigid advance of each place, mm; −inf where there is none.
    compliance : (p, n, n) float
        Symmetric, of all but what each place adds by itself, mm/N.
    total : float
        F in N; 0 gives the rigid answer.
    local : callable
        What each place adds by itself, depending on its force (`Local`).

    Returns
    -------
    Distribution

    Raises
    ------
    InputError
        If a position did not settle.

    Notes
    -----
    Each round solves for the places that touch; then those that pull let go, and those that would overlap touch (a semi-smooth Newton
    method), with the local compliance as a secant of the round before. From round `_SINGLE_FROM` on only the worst place changes.
    """
    count, places = advance.shape
    highest = advance.max(axis=1)
    if total <= 0.0:
        return Distribution(np.zeros_like(advance), highest, np.zeros(count))
    reachable = np.isfinite(advance)
    lead = np.where(reachable, advance - highest[:, None], 0.0)  # small numbers: forces are differences of them over compliances
    force = np.where(advance >= highest[:, None], total, 0.0)
    force /= force.sum(axis=1, keepdims=True) / total
    touching = reachable & (advance >= highest[:, None] - _start_depth(compliance, total)[:, None])
    level_of, slope = np.zeros(count), np.zeros(count)
    left = np.ones(count, dtype=np.bool_)
    diagonal = np.arange(places)
    for turn in range(MOST_ROUNDS):
        on, here = touching[left], compliance[left]
        secant, tangent = local(force[left], left)
        matrix = here.copy()
        matrix[:, diagonal, diagonal] += secant
        new, level, _ = _balanced(matrix, on, lead[left], total)
        # Without what a place adds by itself: where nothing touches there is no force that it could be of.
        gap = level[:, None] + np.einsum("pij,pj->pi", here, new) - lead[left]
        pulls = on & (new < 0.0)
        overlaps = ~on & reachable[left] & (gap < -_GAP_TOLERANCE)
        wrong = pulls | overlaps
        if turn >= _SINGLE_FROM:
            badness = np.where(pulls, -new / total, 0.0) + np.where(
                overlaps, -gap / (np.abs(gap).max(axis=1, keepdims=True) + 1e-300), 0.0
            )
            wrong &= badness >= badness.max(axis=1, keepdims=True)
        moved = np.abs(new - force[left]).max(axis=1)
        settled = ~wrong.any(axis=1) & (moved <= _FORCE_TOLERANCE * total)
        force[left], level_of[left] = np.maximum(new, 0.0), level
        touching[left] = on ^ wrong
        if settled.any():
            matrix = here[settled].copy()
            matrix[:, diagonal, diagonal] += tangent[settled]
            which = np.flatnonzero(left)[settled]
            slope[which] = _balanced(matrix, on[settled], lead[which], total)[2]
            left[which] = False
        if not left.any():
            return Distribution(force, highest + level_of, slope)
    raise InputError(f"loaded contact: {int(left.sum())} of {count} positions did not settle in {MOST_ROUNDS} rounds")


def _balanced(matrix: Floats, on: Bools, lead: Floats, total: float) -> tuple[Floats, Floats, Floats]:
    """Forces where places touch, 0 elsewhere; the advance; and 1 / (1ᵀ C⁻¹ 1), how far it gives way per force."""
    both = on[:, :, None] & on[:, None, :]
    places = np.arange(on.shape[1])
    system = np.where(both, matrix, 0.0)
    system[:, places, places] = np.where(on, system[:, places, places], 1.0)
    sides = np.stack([np.where(on, lead, 0.0), on.astype(np.float64)], axis=-1)
    solved = np.linalg.solve(system, sides)
    shape, even = solved[..., 0], solved[..., 1]
    softness = 1.0 / even.sum(axis=1)
    level = (shape.sum(axis=1) - total) * softness
    return shape - level[:, None] * even, level, softness


def _start_depth(compliance: Floats, total: float) -> Floats:
    """How far below the highest place others may touch, mm: the deflection if that place carried all."""
    return np.asarray(total * compliance.diagonal(axis1=1, axis2=2).max(axis=1) / compliance.shape[1], dtype=np.float64)
