"""Rigid contact of one tooth of the driver with one tooth of the driven gear.

The driver's flank is a curve, the driven flank a half angle w(ρ) about its own axis. A point of the
driver at (ρ, β) about the driven axis, β counted from the line of centres in the driven gear's sense of
rotation, pushes the driven tooth's centre line to β + w(ρ) at least. The greatest value along the flank
is where they touch. Inside a ring, which turns as its pinion does, only the way from the axis to the point is another. No tangency is solved, so corners, ledges and pits need no special case.

Everything is measured as a difference from the design: half angles are the exact nominal ones plus a
difference that runs linearly between the given radii. A perfect pair is therefore exact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles
from gearwear.processors import threads

Index = NDArray[np.intp]
T = TypeVar("T")

SAMPLES = 320
"""Points of the driver's flank among which the contact is looked for before it is searched for."""

NODES = 1024
"""Nodes, even in ρ², of the driven flank's table for that look."""

HALVINGS = 14
"""Steps of the search; each halves the bracket of two samples."""

_CELLS = 16384
"""Array elements worked on at a time: small enough to stay in the cache."""

_NEEDLESS = 2000
"""Array elements that are as much work as one more call."""


@dataclass(frozen=True, slots=True)
class Flanks:
    """One flank per row, as a difference from the design.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    radius : (n_r,) float
        Knots in mm, rising; the last is the tip corner, of a ring the first. Beyond the other end the difference stays what it is there.
    excess : (rows, n_r) float
        ψ − ψ_nominal in rad; less than zero is worn.
    """

    gear: Gear
    radius: Floats
    excess: Floats

    def excess_at(self, row: Index, radius: Floats) -> Floats:
        """ψ − ψ_nominal, rad, at one radius (mm) per row number; linear between knots."""
        knot, part = place_among(self.radius, radius)
        flat, start = self.excess.ravel(), row * len(self.radius) + knot
        return np.asarray((1.0 - part) * flat[start] + part * flat[start + 1], dtype=np.float64)

    def half_angle(self, row: Index, radius: Floats) -> Floats:
        """ψ in rad at one radius (mm) per row number."""
        return self.gear.half_angle(radius) + self.excess_at(row, radius)

    def sampled(self, radius: Floats) -> Floats:
        """ψ in rad of every row on common radii: (rows, len(radius))."""
        knot, part = place_among(self.radius, radius)
        # `take` keeps rows contiguous in memory; a fancy index would not, and each look would copy the table.
        psi = self.excess.take(knot, axis=1) * (1.0 - part)
        psi += self.excess.take(knot + 1, axis=1) * part
        psi += self.gear.half_angle(radius)
        return psi


def place_among(knots: Floats, radius: Floats) -> tuple[Index, Floats]:
    """Number of the knot (n_r,) below each radius, and the way to the next, 0 to 1; the ends where it lies beyond them."""
    knot = np.searchsorted(knots[1:-1], radius, side="right")
    low = knots[knot]
    # `np.clip` takes several times as long on the few values of a search.
    return knot, np.minimum(np.maximum((radius - low) / (knots[knot + 1] - low), 0.0), 1.0)


def tip_corner(flanks: Flanks | ToothProfiles) -> float:
    """Radius of the tip corner, mm: the last that is given, of a ring the first."""
    return float(flanks.radius[-1 if flanks.gear.orientation > 0 else 0])


@dataclass(frozen=True, slots=True)
class PairContact:
    """Where each row's two flanks touch when the driver's tooth stands at each angle.

    Parameters
    ----------
    advance : (angles, rows) float
        mm on the line of action by which the driven gear must be ahead of the position in which a space of it
        is centred on a tooth of the driver: r_b2 (φ2 − φ1 z1/z2); −inf where the flanks are out of reach.
    radius : (angles, rows) float
        Contact radius on the driver, mm.
    mate_radius : (angles, rows) float
        Contact radius on the driven gear, mm.
    """

    advance: Floats
    radius: Floats
    mate_radius: Floats


@dataclass(frozen=True, slots=True)
class ToothPairs:
    """Pairs of flanks, driver row i against driven row i, with the tables that find their contact quickly.

    Build it with `ToothPairs.of`.
    """

    driver: Flanks
    driven: Flanks
    centre_distance: float
    radius: Floats
    """(n_s,) Samples of the driver's flank: even ones, all knots, and where the design has its corners; mm."""
    x: Floats
    y: Floats
    """(rows, n_s) The same as points, tooth centre line along x; mm."""
    span: tuple[Floats, Floats]
    """Least and greatest half angle at each sample, (k, n_s) rad, of each of k equal parts of the rows, which are looked at one after the other."""
    table: Floats
    """(rows, NODES) half angle of the driven flank, even in ρ² from `deepest` to the tip; rad."""
    deepest: float
    """ρ² as far from the tip as the driver can reach, mm²."""
    ahead: Floats
    """(g,) angle by which row i is ahead of the others, for i modulo g; rad. A helical gear has one for each slice."""

    @classmethod
    def of(
        cls, driver: Flanks, driven: Flanks, centre_distance: float, ahead: Floats | None = None, parts: int = 1
    ) -> ToothPairs:
        """Prepare the pairs; the same number of rows in both, centre distance in mm. Nothing is `ahead` where it is left out. Rows come in equal `parts`
        where their half angles are far apart."""
        gear, tip = driver.gear, float(driver.radius[-1])
        known = np.concatenate([driver.radius, [gear.form_radius, gear.base_radius]])
        even = np.linspace(gear.root_radius, tip, SAMPLES)
        radius = np.unique(np.concatenate([even, known[(known >= gear.root_radius) & (known <= tip)]]))
        psi = driver.sampled(radius)
        mate, orientation = driven.gear, driven.gear.orientation
        deepest = min(orientation * mate.root_radius, orientation * centre_distance - tip) ** 2
        table = driven.sampled(np.sqrt(np.linspace(deepest, tip_corner(driven) ** 2, NODES)))
        alike = psi.reshape(parts, -1, len(radius))
        span = (alike.min(axis=1), alike.max(axis=1))
        x, y = radius * np.cos(psi), radius * np.sin(psi)
        return cls(driver, driven, centre_distance, radius, x, y, span, table, deepest, np.zeros(1) if ahead is None else ahead)

    @property
    def centre(self) -> float:
        """Centre distance, mm, negative inside a ring."""
        return self.driven.gear.orientation * self.centre_distance

    @property
    def tip(self) -> float:
        """Radius of the driven tip corner, mm."""
        return tip_corner(self.driven)

    def contact(self, angles: Floats, wanted: tuple[Ints, Ints] | None = None) -> PairContact:
        """Where each pair touches when the driver's tooth stands at each angle.

        Parameters
        ----------
        angles : (n_a,) or (n_a, parts) float
            Angle in rad from the line of centres to the driver tooth's centre line, in the sense in which the
            flank faces, of all rows or of each part of them; `ahead` is added.
        wanted : ((n_a,) int, (n_a,) int) or None
            First row that is wanted at each angle, and the one behind the last, where rows are all of one part; the others are left out of reach.

        Returns
        -------
        PairContact

        Notes
        -----
        First a look at the samples of the driver's flank, on the table of the driven one; then a search with the exact
        functions: by halving round the best sample, and by the secant rule for the place where the driven tip
        corner lies on the driver's flank. Each value is a true one of the function to be maximised, so what is
        missed can only make the advance too small: by less than 1e-9 mm where the best sample is next to the true
        contact. Where two places of one flank are within h²/(8 R) of touching together (h the sample distance, R the
        relative radius of curvature; 0.1 µm for a module of 6 mm), the lesser may be found.
        """
        count, rows, groups, parts = len(angles), len(self.x), len(self.ahead), len(self.span[0])
        standing = np.broadcast_to(angles.reshape(count, -1, 1) + self.ahead, (count, parts, groups))
        best = np.full((count, rows), -1, np.intp)
        entry = np.full((count, rows), -1, np.intp)
        advance = np.full((count, rows), -np.inf)
        radius, mate_radius = np.full((2, count, rows), np.nan)

        first, behind = self._within_reach(standing)
        begin, end = (np.zeros(count, np.intp), np.full(count, rows)) if wanted is None else wanted

        def look(looks: list[_Look]) -> None:
            at, row = (np.concatenate(one) for one in zip(*(one.pairs() for one in looks), strict=True))
            part = row // (rows // parts)
            samples = slice(min(one.first for one in looks), max(one.behind for one in looks))
            angle = standing[at, part, row % groups, None]
            best[at, row], entry[at, row] = self._look(row, samples, np.cos(angle), np.sin(angle))

        def search(chunk: Index) -> None:
            row = chunk % rows
            angle = standing[chunk // rows, row // (rows // parts), row % groups]
            value, r, rho = self._halve(row, angle, best.ravel()[chunk])
            enters = np.flatnonzero(entry.ravel()[chunk] > 0)
            if len(enters):
                corner = self._tip_corner(row[enters], angle[enters], entry.ravel()[chunk[enters]])
                better = corner[0] > value[enters]
                into = enters[better]
                value[into], r[into], rho[into] = (part[better] for part in corner)
            mate = self.driven.gear
            centred = np.pi / mate.teeth + self.driver.gear.teeth / mate.teeth * angle
            advance.ravel()[chunk] = mate.base_radius * (value - centred)
            radius.ravel()[chunk], mate_radius.ravel()[chunk] = r, rho

        _parallel(look, _together(_looks(first, behind, begin, end, rows // parts)), at_once=rows * len(self.radius) >= _CELLS)
        reached = np.flatnonzero(best.ravel() >= 0)
        _parallel(search, [reached[i : i + _CELLS] for i in range(0, len(reached), _CELLS)])
        return PairContact(advance, radius, mate_radius)

    def _within_reach(self, angles: Floats) -> tuple[Index, Index]:
        """Number of the first sample that may be inside the driven tip circle, and of the one behind the last: (angles, parts); equal where there is none.

        The driver's tooth of row i stands at angle i modulo g of its part of `angles` (angles, parts, g), rad; between the least and the greatest of
        the g all is within reach.
        """
        # Below this cosine a point at radius r lies outside the driven tip circle, or inside that of a ring; less by what rounding can be.
        centre = self.centre  # signed
        least_cosine = (centre**2 + self.radius**2 - self.tip**2) / (2.0 * centre * self.radius) - 1e-14
        reach = np.where(least_cosine <= 1.0, np.arccos(np.minimum(np.maximum(least_cosine, 0.0), 1.0)), -np.inf)
        low, high = -reach - self.span[1], reach - self.span[0]
        least, most = angles.min(axis=2)[..., None], angles.max(axis=2)[..., None]
        first, behind = np.zeros((2, *angles.shape[:2]), np.intp)
        block = max(1, 4 * _CELLS // (angles.shape[1] * len(self.radius)))
        for at in range(0, len(angles), block):
            inside: Bools = (most[at : at + block] >= low) & (least[at : at + block] <= high)
            some = inside.any(axis=2)
            # One sample more at the low end, to see where the flank enters.
            first[at : at + block] = np.maximum(inside.argmax(axis=2) - 1, 0) * some
            behind[at : at + block] = (len(self.radius) - inside[..., ::-1].argmax(axis=2)) * some
        return first, behind

    def _look(self, rows: Index, samples: slice, cos: Floats, sin: Floats) -> tuple[Index, Index]:
        """Number of the best sample, and of the first one inside the driven tip circle, of some rows among some samples, (rows,); −1 is none.

        Cosine and sine (rows, 1) are those of the angles at which the driver's teeth stand.
        """
        start, centre = samples.start, self.centre
        per_node = (NODES - 1) / (self.tip**2 - self.deepest)
        x, y = self.x[:, samples][rows], self.y[:, samples][rows]
        across = cos * x  # in place from here on: most of the time was to fetch memory for what is thrown away
        across -= sin * y
        place = (2.0 * centre) * across
        np.subtract(centre**2 + self.radius[samples] ** 2, place, out=place)
        place -= self.deepest
        place *= per_node
        within = place <= NODES - 1
        whole = np.maximum(place, 0.0)
        np.floor(np.minimum(whole, NODES - 2, out=whole), out=whole)
        place -= whole
        node = whole.astype(np.intp)
        node += NODES * rows[:, None]
        flat = self.table.ravel()
        value = flat.take(node)
        node += 1
        slope = flat.take(node)
        slope -= value
        slope *= place
        value += slope
        turn = sin * x
        turn += cos * y
        across *= self.driven.gear.orientation
        turn /= np.subtract(self.centre_distance, across, out=across)
        value += np.arctan(turn, out=turn)
        np.copyto(value, -np.inf, where=~within)
        met, enters = within.any(axis=1), within.argmax(axis=1)
        return np.where(met, start + value.argmax(axis=1), -1), np.where(met & (start + enters > 0), start + enters, -1)

    def _push(self, row: Index, angle: Floats, radius: Floats) -> tuple[Floats, Floats]:
        """β + w(ρ) in rad and ρ in mm for driver points of the given radius; exact."""
        theta = angle + self.driver.half_angle(row, radius)
        orientation = self.driven.gear.orientation
        x, y = self.centre_distance - orientation * radius * np.cos(theta), radius * np.sin(theta)
        rho = np.hypot(x, y)
        within = orientation * np.minimum(orientation * rho, orientation * self.tip)
        value = np.arctan2(y, x) + self.driven.half_angle(row, within)
        return np.where(orientation * rho <= orientation * self.tip * (1.0 + orientation * 1e-13), value, -np.inf), rho

    def _halve(self, row: Index, angle: Floats, best: Index) -> tuple[Floats, Floats, Floats]:
        """Greatest push between the neighbours of the best sample: value (rad), r and ρ (mm)."""
        r = self.radius[best]
        low, high = self.radius[np.maximum(best - 1, 0)], self.radius[np.minimum(best + 1, len(self.radius) - 1)]
        value, rho = self._push(row, angle, r)
        for _ in range(HALVINGS):
            left, right = 0.5 * (low + r), 0.5 * (r + high)
            (below, above), (rho_below, rho_above) = self._push(row, angle, np.stack([left, right]))
            go_left, go_right = (below > value) & (below >= above), (above > value) & (above > below)
            low = np.where(go_left, low, np.where(go_right, r, left))
            high = np.where(go_left, r, np.where(go_right, high, right))
            r = np.where(go_left, left, np.where(go_right, right, r))
            value = np.maximum(value, np.maximum(below, above))
            rho = np.where(go_left, rho_below, np.where(go_right, rho_above, rho))
        return value, r, rho

    def _tip_corner(self, row: Index, angle: Floats, first: Index) -> tuple[Floats, Floats, Floats]:
        """Push where the driven tip corner lies on the driver's flank, between samples `first` − 1 and `first`."""

        def outside(radius: Floats) -> Floats:
            theta = angle + self.driver.half_angle(row, radius)
            return self.centre**2 + radius**2 - 2.0 * self.centre * radius * np.cos(theta) - self.tip**2

        before, now = self.radius[first - 1], self.radius[first]
        gap_before, gap = outside(before), outside(now)
        low, high = before, now
        for _ in range(4):  # ρ² is smooth between two samples: the secant rule ends at rounding
            slope = gap - gap_before
            new = np.clip(now - gap * (now - before) / np.where(slope == 0.0, np.inf, slope), low, high)
            before, gap_before = now, gap
            now, gap = new, outside(new)
        theta = angle + self.driver.half_angle(row, now)
        orientation = self.driven.gear.orientation
        beta = np.arctan2(now * np.sin(theta), self.centre_distance - orientation * now * np.cos(theta))
        rho = np.full_like(now, self.tip)
        return beta + self.driven.half_angle(row, rho), now, rho


@dataclass(frozen=True, slots=True)
class _Look:
    """Rows `row` to before `end` at angle number `at`, at samples from `first` to before `behind`."""

    at: int
    row: int
    end: int
    first: int
    behind: int

    def pairs(self) -> tuple[Index, Index]:
        """Number of the angle, and the row, of each row."""
        row = np.arange(self.row, self.end)
        return np.full(len(row), self.at), row


def _looks(first: Index, behind: Index, begin: Ints, end: Ints, size: int) -> Iterator[_Look]:
    """What is to be looked at, angle by angle and part by part, in pieces of at most `_CELLS`: parts of `size` rows, samples from `first` to before
    `behind` (angles, parts), rows from `begin` to before `end` (angles,)."""
    for at, part in np.argwhere(behind > first).tolist():
        start, stop = int(first[at, part]), int(behind[at, part])
        step, last = max(1, _CELLS // (stop - start)), min((part + 1) * size, int(end[at]))
        for row in range(max(part * size, int(begin[at])), last, step):
            yield _Look(at, row, min(row + step, last), start, stop)


def _together(looks: Iterable[_Look]) -> list[list[_Look]]:
    """Looks one after the other, joined as long as they are few and much alike: a call for each would take longer than what it does."""
    joined: list[list[_Look]] = []
    rows = first = behind = 0
    for look in looks:
        more, wide = look.end - look.row, look.behind - look.first
        low, high = min(first, look.first), max(behind, look.behind)
        needless = (high - low - (behind - first)) * rows + (high - low - wide) * more
        if joined and needless < _NEEDLESS and (rows + more) * (high - low) <= _CELLS:
            joined[-1].append(look)
            rows, first, behind = rows + more, low, high
        else:
            joined.append([look])
            rows, first, behind = more, look.first, look.behind
    return joined


def _parallel(work: Callable[[T], None], items: Sequence[T], at_once: bool = True) -> None:
    """`work` on every item, in threads where it pays: numpy releases the interpreter inside its loops, and small items have none."""
    count = threads()
    if count == 1 or len(items) < 4 or not at_once:
        for item in items:
            work(item)
        return
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(work, items))
