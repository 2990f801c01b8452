"""What columns hold beside others, and what each of many candidates would gain in many fits at once.

A search asks the same of one problem thousands of times: by how much does each candidate lower the sum of squares beside these columns, or those? All
such fits of one size are solved together. A candidate of many columns, a freedom for every tooth, is brought to columns square to each other once; beside a
few others only these few are solved for (Woodbury 1950).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwear.arrays import Floats, Ints

RIDGE = 1e-9
"""Relative to the column's own sum: keeps exactly collinear columns solvable; they gain nothing by it."""
SPANNED = 1e-6
"""Share of a column's own square below which nothing of it is left beside others."""
MANY = 8
"""Columns from which on a candidate is one of many: a freedom for every tooth; numerical."""
NOTHING = -1
"""In place of a column where a fit has fewer of them than others that are solved with it, and of one that nobody sees."""


@dataclass(frozen=True, slots=True)
class Block:
    """Candidates of one number of columns.

    Parameters
    ----------
    at : (n,) int
        Which candidates.
    which : (n, size) int
        The columns of each that anybody sees, by their place among these: what nobody sees neither helps nor hinders.
    """

    at: Ints
    which: Ints


def blocks_of(place: Ints, candidates: Sequence[Ints]) -> tuple[Block, ...]:
    """Candidates in groups of one size, by the place (p + 1,) of each column among those that anybody sees."""
    seen = [at[at != NOTHING] for at in (place[columns] for columns in candidates)]
    sizes = np.array([len(columns) for columns in seen], dtype=np.int64)
    groups = []
    for size in np.unique(sizes[sizes > 0]):
        at = np.flatnonzero(sizes == size)
        groups.append(Block(at, np.array([seen[i] for i in at])))
    return tuple(groups)


@dataclass(frozen=True)
class Beside:
    """The sums of columns without what others span of them: a fit on them is the fit on both (Frisch and Waugh 1933, Lovell 1963).

    So what is in every fit is solved for once, and a search goes on with the few columns that it tries. Columns that nobody sees, those of teeth that are
    not among the cells, take no part in the sums: they get no amplitude.

    Parameters
    ----------
    place : (p + 1,) int
        Of each column among the q that anybody sees, or `NOTHING`, which the last one is.
    information : (q, q) float
    moment : (q,) float
    square : float
        Weighted sum of squares that the others leave.
    own : (q,) float
        Weighted squares of the whole columns; by these the ridge is measured.
    candidates : int
        How many are tried.
    blocks : tuple of Block
        These, `blocks_of` their columns.
    """

    place: Ints
    information: Floats
    moment: Floats
    square: float
    own: Floats
    candidates: int = 0
    blocks: tuple[Block, ...] = ()

    @cached_property
    def _known(self) -> dict[int, tuple[Floats, Floats]]:
        """What `_squared` has found."""
        return {}

    def _squared(self, at: int, which: Ints) -> tuple[Floats, Floats]:
        """Of candidate `at` of many columns: the sums of all columns with its own, (p, k), after these are made square to each other and of length 1,
        and their moment, (k,)."""
        if at not in self._known:
            length = np.sqrt(self.own[which])
            scaled = self.information[which[:, None], which] / (length[:, None] * length)
            way = _to_unit(scaled) / length[:, None]
            sums = np.zeros((len(self.own) + 1, way.shape[1]))  # the last row is `NOTHING`'s
            np.matmul(self.information[:, which], way, out=sums[:-1])
            self._known[at] = sums, self.moment[which] @ way
        return self._known[at]

    def _squared_together(self, places: tuple[int, ...], which: Ints) -> list[tuple[Ints, Floats, Floats]]:
        """`_squared` of several candidates (c,) with their columns (c, size): those of as many columns square to each other together, by where they are in
        `places`, (j,), (j, p, k) and (j, k)."""
        if places not in self._known_together:
            each = [self._squared(at, own) for at, own in zip(places, which, strict=True)]
            sizes = np.array([len(moment) for _, moment in each])
            groups = [np.flatnonzero(sizes == size) for size in np.unique(sizes)]
            self._known_together[places] = [
                (own, np.stack([each[i][0] for i in own]), np.stack([each[i][1] for i in own])) for own in groups
            ]
        return self._known_together[places]

    @cached_property
    def _known_together(self) -> dict[tuple[int, ...], list[tuple[Ints, Floats, Floats]]]:
        """What `_squared_together` has put together."""
        return {}

    @cached_property
    def _diagonal(self) -> Floats:
        """Square of each column beside the others, (q,)."""
        return np.diag(self.information)

    @cached_property
    def _of_each(self) -> tuple[Floats, Floats]:
        """Moment and own square of each column, and behind them 0, which is `NOTHING`'s."""
        return np.append(self.moment, 0.0), np.append(self.own, 0.0)

    def _across(self, at: Ints) -> Floats:
        """Sums of the columns at some places (…) with all, (…, q); 0 of `NOTHING`."""
        across, nothing = self.information.take(at, axis=0), at == NOTHING
        if nothing.any():
            across[nothing] = 0.0
        return across

    def solve(self, which: Ints) -> tuple[Floats, Floats]:
        """Amplitudes and inverse information of the fit on columns `which` beside the others."""
        scaled, root, moment = self._scaled(which)
        inverse = np.linalg.inv(scaled) / (root[:, None] * root)
        return inverse @ moment, inverse

    def fit(self, which: Ints) -> tuple[Floats, float]:
        """Amplitudes of the fit on columns `which`, and the weighted sum of squares that it leaves."""
        amplitudes, seen = np.zeros(len(which)), self.place[which] != NOTHING
        if not seen.any():
            return amplitudes, self.square
        scaled, root, moment = self._scaled(which[seen])
        amplitudes[seen] = np.linalg.solve(scaled, moment / root) / root
        return amplitudes, float(self.square - amplitudes[seen] @ moment)

    def _scaled(self, which: Ints) -> tuple[Floats, Floats, Floats]:
        """The information of columns `which` in the lengths of the whole columns, with the ridge; these lengths, and the moment."""
        at, (moments, squares) = self.place[which], self._of_each
        root, there = np.sqrt(squares[at]), at != NOTHING
        root[root == 0.0] = 1.0  # a column nobody sees gets no amplitude
        scaled = self.information[at[:, None], at] * (there[:, None] & there) / (root[:, None] * root)
        return scaled + RIDGE * np.eye(len(which)), root, moments[at]

    def beside(self, which: Ints) -> Beside:
        """The same beside columns `which` too."""
        which = which[self.place[which] != NOTHING]
        scaled, root, aim = self._scaled(which)
        across = self._across(self.place[which]) / root[:, None]
        # Of columns that the others span rounding may leave less than nothing, which has no factor of Cholesky's.
        spanned = np.linalg.solve(scaled, np.column_stack([across, aim / root]))
        moment = self.moment - across.T @ spanned[:, -1]
        square = float(self.square - (aim / root) @ spanned[:, -1])
        return replace(self, information=self.information - across.T @ spanned[:, :-1], moment=moment, square=square)

    def tried(self, bases: Ints) -> tuple[Floats, Floats]:
        """Of each of some fits on columns `bases` (n, k), some of them `NOTHING`, the weighted sum of squares that it leaves, (n,), and the fall of it
        when each of the candidates is added, (n, candidates)."""
        count, bases, (moments, own_squares) = len(bases), self.place[bases], self._of_each
        root = np.sqrt(own_squares[bases])
        root[root == 0.0] = 1.0  # a column nobody sees gets no amplitude
        across, aim, there = self._across(bases), moments[bases] / root, bases != NOTHING
        across /= root[..., None]
        scaled = self.information[bases[:, :, None], bases[:, None, :]] / root[..., None] / root[:, None, :]
        scaled *= there[:, :, None] & there[:, None, :]
        scaled += RIDGE * np.eye(bases.shape[1])
        inverse = np.linalg.inv(scaled)
        spanned, amplitudes = inverse @ across, (inverse @ aim[..., None])[..., 0]
        rest = self.moment - (amplitudes[:, None] @ across)[:, 0]
        left = self._diagonal - (spanned * across).sum(axis=1)
        good = left >= SPANNED * self.own  # a column that the base already spans has nothing left: no gain from rounding
        gains = np.zeros((count, self.candidates))
        for block in self.blocks:
            which = block.which
            fine, size = good[:, which].all(axis=2), which.shape[1]
            if size >= MANY:
                some = np.flatnonzero(fine.any(axis=0))
                if not len(some):
                    continue
                for among, sums, moment in self._squared_together(tuple(block.at[some].tolist()), which[some]):
                    place = some[among]
                    own = sums[:, bases] / root[..., None]
                    beyond = moment[:, None] - (amplitudes[:, None] @ own)[:, :, 0]
                    inner, mixed = scaled - own @ own.swapaxes(2, 3), own @ beyond[..., None]
                    inner += RIDGE * np.eye(bases.shape[1])
                    back = (mixed * np.linalg.solve(inner, mixed)).sum(axis=(2, 3))
                    gains[:, block.at[place]] = np.where(fine[:, place], ((beyond**2).sum(axis=2) + back).T, 0.0)
                continue
            value = np.zeros(fine.shape)
            if size == 1:
                np.divide(rest[:, which[:, 0]] ** 2, left[:, which[:, 0]] * (1.0 + RIDGE), out=value, where=fine)
            elif size == 2:
                one, other = which.T
                mixed = self.information[one, other] - (spanned[:, :, one] * across[:, :, other]).sum(axis=1)
                a, b = left[:, one] * (1.0 + RIDGE), left[:, other] * (1.0 + RIDGE)
                by = rest[:, one] ** 2 * b - 2.0 * rest[:, one] * rest[:, other] * mixed + rest[:, other] ** 2 * a
                np.divide(by, a * b - mixed**2, out=value, where=fine)
            else:
                part = self.information[which[:, :, None], which[:, None, :]] - np.einsum(
                    "nbms,nbmt->nmst", spanned[:, :, which], across[:, :, which]
                )
                part = part[fine] + RIDGE * left[:, which][fine][:, :, None] * np.eye(size)
                beyond = rest[:, which][fine]
                value[fine] = (beyond * np.linalg.solve(part, beyond[..., None])[..., 0]).sum(axis=1)
            gains[:, block.at] = value
        return self.square - (amplitudes * aim).sum(axis=1), gains


def _to_unit(information: Floats) -> Floats:
    """(k, q) mixtures of columns, of this information (k, k), that are square to each other and of length 1; none of what is spanned already."""
    try:
        root = np.linalg.cholesky(information + RIDGE * np.eye(len(information)))
        if np.diag(root).min() ** 2 > SPANNED:
            return np.asarray(np.linalg.inv(root).T, dtype=np.float64)
    except np.linalg.LinAlgError:
        pass
    value, vector = np.linalg.eigh(information)
    left = value > SPANNED
    return np.asarray(vector[:, left] / np.sqrt(value[left]), dtype=np.float64)
