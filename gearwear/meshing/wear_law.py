"""Archard's wear law along a flank, fitted to a measured profile.

A point of the flank is watched while the mate's contact passes over it (single point observation: Andersson; Flodin
& Andersson, Wear 1997 and 2000). In one cycle it loses k · p̄ · s, with the mean pressure p̄ and the distance s slid
over it; the Hertzian width cancels, and what is left is exactly ::

    depth per cycle = k · w · |K|

with the load per face width w (N/mm) and the specific sliding K of that flank. The coefficient k of lubricated steel
gears spans four decades and scatters by half in one rig, so there is no default: nothing is predicted from it, it is
only fitted. A fit says what a profile is consistent with, not what made it.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from statistics import NormalDist

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.meshing.path import path_of_contact, sliding

TERMS = ("sliding", "uniform", "step")
"""Terms of the law, in the order of the coefficients."""

_LEAST_POINTS = 8
_MILD = 0.010
"""mm; depth above which contact leaves the line of action of the unworn flanks, on which K is reckoned."""


class LoadSharing(StrEnum):
    """Share of the load that a pair carries while two pairs are in contact."""

    NONE = "none"
    """1: as if each pair carried all."""
    HALVES = "halves"
    """1/2; in single contact 1."""
    THIRDS = "thirds"
    """From 1/3 at the ends of the path to 2/3 at the border of single contact; there 1."""


def load_share(gear: Gear, mate: Gear, centre_distance: float, roll: Floats, sharing: LoadSharing) -> Floats:
    """Share of the load on the flank of `gear` at each length of roll.

    Parameters
    ----------
    gear, mate : Gear
        The pair; `gear` is the one whose flank is looked at.
    centre_distance : float
        mm.
    roll : (n,) float
        Length of roll on `gear`, mm.
    sharing : LoadSharing
        The model; rigid teeth have none of their own.

    Returns
    -------
    (n,) float
        From 0 (outside the path of contact) to 1; shares of the pairs in contact add up to 1, but for NONE.

    Raises
    ------
    InputError
        If the contact ratio is 2 or more: these models know one and two pairs.
    """
    path = path_of_contact(gear, mate, centre_distance)
    if path.contact_ratio >= 2.0:
        raise InputError(f"contact ratio {path.contact_ratio:.3f}: load sharing is modelled below 2 only")
    start, end, pitch = path.start_pinion, path.end_pinion, path.base_pitch
    touched = (roll >= start) & (roll <= end)
    if sharing is LoadSharing.NONE:
        return touched.astype(np.float64)
    # Way into double contact, 0 at the border of single contact and 1 at the end of the path.
    double = max(end - start - pitch, 0.0)
    into = np.maximum(start + double - roll, roll - (end - double)) / max(double, 1e-300)
    shared = 0.5 if sharing is LoadSharing.HALVES else (2.0 - into) / 3.0
    return np.where(touched, np.where(into > 0.0, shared, 1.0), 0.0)


def wear_per_cycle(
    gear: Gear,
    mate: Gear,
    centre_distance: float,
    roll: Floats,
    wear_coefficient: float,
    unit_load: float,
    sharing: LoadSharing = LoadSharing.NONE,
) -> Floats:
    """Depth lost per mesh cycle of `gear`: k w |K|, mm.

    Parameters
    ----------
    gear, mate, centre_distance, roll, sharing
        As for `load_share`.
    wear_coefficient : float
        k in mm²/N (1 m²/N is 1e6 mm²/N).
    unit_load : float
        Tooth force on all pairs per face width, N/mm.

    Returns
    -------
    (n,) float

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> [round(float(d), 10) for d in wear_per_cycle(pinion, gear, 114.3, np.array([5.0, 10.0, 16.0]), 1e-10, 100.0)]
    [2.41e-08, 4.5e-09, 2.8e-09]
    """
    share = load_share(gear, mate, centre_distance, roll, sharing)
    return wear_coefficient * unit_load * share * _sliding(gear, mate, centre_distance, roll)


@dataclass(frozen=True, slots=True)
class WearFit:
    """``depth(L) = A · share(L) · |K(L)| + B + C · [single contact]``, all of A, B, C at least 0.

    Parameters
    ----------
    gear, mate : Gear
        The worn gear and the other.
    centre_distance : float
        mm.
    sharing : LoadSharing
        The load sharing of the first term.
    roll, depth, std : (n,) float
        What was fitted, within the path of contact: length of roll, mean depth and its standard deviation, mm.
    basis : (n, 3) float
        The terms at coefficient 1, in the order of `TERMS`.
    coefficients : (3,) float
        A, B, C in mm. A is k w times the cycles run.
    covariance : (3, 3) float
        mm², of the fit without bounds, times χ² per degree of freedom where that is above 1. So near a bound it is
        too large rather than too small. 0 for a term that cannot be told from another on this path.
    chi_square : float
    degrees_of_freedom : int
    """

    gear: Gear
    mate: Gear
    centre_distance: float
    sharing: LoadSharing
    roll: Floats
    depth: Floats
    std: Floats
    basis: Floats
    coefficients: Floats
    covariance: Floats
    chi_square: float
    degrees_of_freedom: int

    @property
    def fitted(self) -> Floats:
        """Depth by the law, mm, (n,)."""
        return np.asarray(self.basis @ self.coefficients, dtype=np.float64)

    @property
    def fitted_std(self) -> Floats:
        """Standard deviation of `fitted`, mm, (n,)."""
        return np.asarray(np.sqrt(np.einsum("ij,jk,ik->i", self.basis, self.covariance, self.basis)), dtype=np.float64)

    def interval(self, confidence: float = 0.95) -> Floats:
        """(3, 2) lower and upper limits of the coefficients, mm, not below 0."""
        reach = NormalDist().inv_cdf(0.5 + 0.5 * confidence) * np.sqrt(np.diag(self.covariance))
        limits = self.coefficients[:, None] + reach[:, None] * np.array([-1.0, 1.0])
        return np.asarray(np.maximum(limits, 0.0), dtype=np.float64)

    @property
    def parts(self) -> dict[str, tuple[float, float]]:
        """What part of the mean measured depth each term makes up, with its standard deviation; and what is left."""
        weight = np.gradient(self.roll)
        mean = float(weight @ self.depth)
        share = weight @ self.basis / mean
        std = share * np.sqrt(np.diag(self.covariance))
        found = {name: (float(s * c), float(d)) for name, s, c, d in zip(TERMS, share, self.coefficients, std, strict=True)}
        rest = 1.0 - sum(value for value, _ in found.values())
        return found | {"unexplained": (rest, float(np.sqrt(share @ self.covariance @ share)))}

    @property
    def explained(self) -> float:
        """Part of the variation of the measured depth along the flank that the law explains (R², weighted)."""
        weight = self.std**-2
        about = self.depth - weight @ self.depth / weight.sum()
        return 1.0 - float(weight @ (self.depth - self.fitted) ** 2 / (weight @ about**2))

    def wear_coefficient(self, cycles_run: float, unit_load: float) -> tuple[float, float]:
        """k = A / (w N) and its standard deviation, mm²/N, for the cycles run and the load in N/mm."""
        per = 1.0 / (cycles_run * unit_load)
        return float(self.coefficients[0]) * per, float(np.sqrt(self.covariance[0, 0])) * per

    @property
    def words(self) -> str:
        """One line for a report. It names what the profile is consistent with, never a mechanism."""
        parts = {name: f"{value:.0%} ± {std:.0%}" for name, (value, std) in self.parts.items()}
        text = (
            f"of the mean depth {parts['sliding']} is consistent with sliding wear after Archard (load sharing: {self.sharing}), "
            f"{parts['uniform']} with a uniform loss, {parts['step']} with more loss where one pair carries alone; "
            f"unexplained {parts['unexplained']}"
        )
        deepest = float(self.depth.max())
        if deepest > _MILD:
            text += f"; deepest {1e3 * deepest:.0f} µm: the law is for mild wear, with the sliding of the unworn flanks"
        return text


def fit_wear_law(
    gear: Gear,
    mate: Gear,
    centre_distance: float,
    roll: Floats,
    depth: Floats,
    std: Floats,
    sharing: LoadSharing | None = None,
    correlation_length: float = 0.0,
) -> tuple[WearFit, ...]:
    """Fit the law to the mean depth of worn flanks.

    Parameters
    ----------
    gear, mate : Gear
        The worn gear and the one it runs with.
    centre_distance : float
        mm.
    roll : (n,) float
        Length of roll on `gear`, mm, rising.
    depth, std : (n,) float
        Mean depth (+ is missing) and its standard deviation, mm. Points outside the path of contact and points that
        are nan are left out.
    sharing : LoadSharing or None
        The load sharing; None tries all.
    correlation_length : float
        mm of roll over which errors of `depth` are alike (they decay as exp(−ΔL/ℓ)); 0 is independent. Take it from the
        scan: texture makes an interval far too narrow when it is left out.

    Returns
    -------
    tuple of WearFit
        The best first, by χ². Sharing models whose χ² differ by less than about 4 cannot be told apart.

    Raises
    ------
    InputError
        If too few points lie on the path of contact, if a standard deviation is not positive, or for a contact
        ratio of 2 or more.

    Notes
    -----
    Non-negative least squares (Lawson & Hanson 1974) on data made independent by the Cholesky factor of their
    covariance.
    """
    from scipy.optimize import nnls

    roll, depth, std = (np.asarray(values, dtype=np.float64) for values in (roll, depth, std))
    path = path_of_contact(gear, mate, centre_distance)
    use = np.isfinite(depth) & np.isfinite(std) & (roll >= path.start_pinion) & (roll <= path.end_pinion) & (roll > 0.0)
    if use.sum() < _LEAST_POINTS:
        raise InputError(
            f"wear law: {int(use.sum())} points on the path of contact, L = {path.start_pinion:.3f} … {path.end_pinion:.3f} mm; at least {_LEAST_POINTS} are needed"
        )
    roll, depth, std = roll[use], depth[use], std[use]
    if not (std > 0.0).all() or not (np.diff(roll) > 0.0).all():
        raise InputError("wear law: standard deviations must be above 0 mm and lengths of roll must rise")
    low, high = path.single_contact_pinion
    single = (roll > low) & (roll < high)
    likeness = np.eye(len(roll))
    if correlation_length > 0.0:
        likeness = np.exp(-np.abs(roll[:, None] - roll) / correlation_length)
    factor = std[:, None] * np.linalg.cholesky(likeness)
    fits = []
    for model in LoadSharing if sharing is None else (sharing,):
        share = load_share(gear, mate, centre_distance, roll, model)
        basis = np.column_stack([share * _sliding(gear, mate, centre_distance, roll), np.ones_like(roll), single])
        told = _told_apart(single)
        white = np.linalg.solve(factor, np.column_stack([basis[:, told], depth]))
        amounts, norm = nnls(white[:, :-1], white[:, -1])
        free = len(roll) - int(told.sum())
        coefficients, covariance = np.zeros(3), np.zeros((3, 3))
        coefficients[told] = amounts
        spread = np.linalg.inv(white[:, :-1].T @ white[:, :-1]) * max(1.0, norm**2 / free)
        covariance[np.ix_(told, told)] = spread
        fits.append(WearFit(gear, mate, centre_distance, model, roll, depth, std, basis, coefficients, covariance, norm**2, free))
    return tuple(sorted(fits, key=lambda fit: fit.chi_square))


def _told_apart(single: Bools) -> Bools:
    """Which terms to fit: the step only where points lie both in single and in double contact."""
    return np.array([True, True, bool(single.any() and not single.all())])


def _sliding(gear: Gear, mate: Gear, centre_distance: float, roll: Floats) -> Floats:
    """|K| of `gear`'s flank."""
    return np.abs(sliding(gear, mate, centre_distance, roll).specific_pinion)
