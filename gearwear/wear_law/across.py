"""How evenly flanks are worn across the face: the depth along the tooth, and how far it leans or bows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.wear.uncertainty import noise_covariance

LEAST_ROWS = 4
"""Rows of cells across the face from which on the depth is said along it."""
LEAST_UNEVENNESS = 0.05
"""Lean or bow as a share of the mean depth below which wear counts as even."""
SURE_STDS = 3.0
"""Standard deviations from which on a lean or a bow is said; where they come from the scatter of few teeth, as many as are as seldom by Student's t."""


@dataclass(frozen=True, slots=True)
class AcrossFace:
    """Mean depth of flanks worn alike, row by row across the face.

    Parameters
    ----------
    z : (n,) float
        Height of the rows, mm.
    depth, std : (n,) float
        Mean over the flank's height and over the teeth, and its standard deviation, mm.
    lean, lean_std : float
        Rise of the depth over the whole face width, mm; + is deeper at the upper end.
    bow, bow_std : float
        How much deeper the two ends are than the middle, mm.
    lean_freedom, bow_freedom : float
        Degrees of freedom of these standard deviations; inf where they do not come from the scatter of the teeth.
    """

    z: Floats
    depth: Floats
    std: Floats
    lean: float
    lean_std: float
    bow: float
    bow_std: float
    lean_freedom: float = math.inf
    bow_freedom: float = math.inf

    @property
    def mean(self) -> float:
        """Mean depth, mm."""
        return float(self.depth.mean())

    @property
    def leans(self) -> bool:
        """Whether the lean is beyond chance and worth a word."""
        return self._stands_out(self.lean, self.lean_std, self.lean_freedom)

    @property
    def bows(self) -> bool:
        """Whether the bow is."""
        return self._stands_out(self.bow, self.bow_std, self.bow_freedom)

    @property
    def uneven(self) -> bool:
        """Whether wear is uneven across the face."""
        return self.leans or self.bows

    def _stands_out(self, value: float, std: float, freedom: float) -> bool:
        from scipy.special import ndtr, stdtrit

        sure = SURE_STDS if math.isinf(freedom) else float(stdtrit(freedom, ndtr(SURE_STDS)))
        return abs(value) > sure * std and abs(value) > LEAST_UNEVENNESS * abs(self.mean)


def wear_across_face(cells: Cells, half: int, teeth: Ints, loop: Loop | None, noise: float) -> AcrossFace | None:
    """Depth of some flanks across the face, each row the mean over the flank's height; of a double helical gear across both halves.

    Parameters
    ----------
    cells : Cells
        Deviation from the as-made gear.
    half : int
        0 left, 1 right.
    teeth : (k,) int
        0-based, at least two.
    loop : Loop or None
        Where the as-made gear comes from.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    AcrossFace or None
        None where there are fewer than `LEAST_ROWS` rows, or a row was seen on less than half of the flanks.

    Notes
    -----
    Least squares by the Legendre polynomials 1, P1 and P2 over the face, tooth by tooth. A standard deviation is that of the mean of the
    teeth by their scatter, or by noise, texture, pose and effects, whichever is greater.
    """
    grid, count, rows = cells.grid, len(teeth), cells.grid.toothed
    seen = np.stack([grid.flank_shape(cells.seen.astype(np.float64))[tooth, half, rows] for tooth in teeth])
    if rows.sum() < LEAST_ROWS or count < 2 or not (seen.mean(axis=(0, 2)) >= 0.5).all():
        return None
    lost = -np.stack([grid.flank_shape(np.where(cells.seen, cells.points.deviation, 0.0))[tooth, half, rows] for tooth in teeth])
    # A cell that was not seen is taken as the mean of its place on the other teeth, so that the flank's shape does not lean the rows.
    number = seen.sum(axis=0)
    usual = (seen * lost).sum(axis=0) / np.maximum(number, 1.0)
    column = (seen * lost).sum(axis=(0, 1)) / np.maximum(seen.sum(axis=(0, 1)), 1.0)
    usual = np.where(number > 0.0, usual, column)
    depth = np.where(seen > 0.0, lost, usual).mean(axis=2)
    z = grid.row_middles[rows]
    place = z / grid.gear.face_width - 0.5
    basis = np.column_stack([np.ones_like(place), place, 6.0 * place**2 - 0.5])
    solve = np.linalg.pinv(basis)
    each = depth @ solve.T
    # The rows, the lean and the bow as sums over cells, for what all neighbouring cells share.
    row = np.zeros((len(z), *grid.side_shape))
    for i, at in enumerate(np.flatnonzero(rows)):
        row[i, teeth, half, at, grid.fillet :] = 1.0 / (count * grid.flank)
    covariance = noise_covariance(cells, noise, loop, row)
    mean, std, freedom = mean_of_teeth(each, np.einsum("ij,jk,ik->i", solve, covariance, solve))
    return AcrossFace(
        z=z,
        depth=depth.mean(axis=0),
        std=np.sqrt(np.maximum(np.diag(covariance), depth.var(axis=0, ddof=1) / count)),
        lean=float(mean[1]),
        lean_std=float(std[1]),
        bow=1.5 * float(mean[2]),
        bow_std=1.5 * float(std[2]),
        lean_freedom=float(freedom[1]),
        bow_freedom=float(freedom[2]),
    )


def mean_of_teeth(each: Floats, errors: Floats) -> tuple[Floats, Floats, Floats]:
    """Means of what teeth have, (k, n), their standard deviations and the degrees of freedom of these: by the scatter of the teeth, or by a variance
    of the means known otherwise, (n,), whichever is greater."""
    scatter = each.var(axis=0, ddof=1) / len(each)
    return each.mean(axis=0), np.sqrt(np.maximum(errors, scatter)), np.where(scatter > errors, len(each) - 1.0, np.inf)


def across_words(across: AcrossFace) -> str:
    """That the wear is uneven across the face, with the amount; "" where it is even.

    >>> across_words(AcrossFace(np.arange(3.0), np.full(3, 0.02), np.full(3, 1e-3), 0.012, 0.001, 0.0, 0.001))
    'the wear is uneven across the face: 12.0 ± 1.0 µm deeper at the upper end (z = 2.0 mm) than at the other, of 20.0 µm on average; a shaft misaligned in mesh does that, and so does a helix slope of either gear as made'
    """
    if not across.uneven:
        return ""
    said = []
    if across.leans:
        upper = across.lean > 0.0
        end, height = ("upper", across.z[-1]) if upper else ("lower", across.z[0])
        said.append(
            f"{_amount(across.lean, across.lean_std)} deeper at the {end} end (z = {height:.1f} mm) than at the other,"
            f" of {1e3 * across.mean:z.1f} µm on average"
        )
    if across.bows:
        where = "at both ends than in the middle" if across.bow > 0.0 else "in the middle than at both ends"
        said.append(f"{_amount(across.bow, across.bow_std)} deeper {where}")
    text = f"the wear is uneven across the face: {', and '.join(said)}"
    if across.leans:
        text += "; a shaft misaligned in mesh does that, and so does a helix slope of either gear as made"
    return text


def _amount(value: float, std: float) -> str:
    digits = min(max(1 - math.floor(math.log10(max(1e3 * std, 1e-3))), 0), 1)
    return f"{1e3 * abs(value):.{digits}f} ± {1e3 * std:.{digits}f} µm"
