"""Whether flanks of the gear's class may be cut with the form of a loss, and what wear on some sides comes to beside that.

A loss that all teeth have alike, and of a form that lies within the tolerance of the class, was as likely cut as worn. Forms are told off a slope and a lead,
on the cells that a fit may use; the cost of a loss is the fit's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.design.tolerance import profile_form_tolerance
from gearwear.diagnose.pitch_point import as_slid
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells


@dataclass(frozen=True, slots=True)
class SideLoss:
    """What flanks may have lost, (m,) mm, the mean of all teeth; the cost with it; and whether teeth have lost more and less of it."""

    cost: float
    loss: Floats
    uneven: bool


@dataclass(frozen=True, slots=True)
class WornCost:
    """The least cost of wear on some sides, and how uncommon flanks made with the form of what they lost are, where both sides have lost it."""

    cost: float
    uncommon: float = 0.0


@dataclass(frozen=True, slots=True)
class FlankForms:
    """Forms on the flanks of a scan.

    Parameters
    ----------
    cells : Cells
    rows : (n,) int
        Those of them that a fit may use.
    pitch_roll : float
        Roll at the pitch point, mm.
    """

    cells: Cells
    rows: Ints
    pitch_roll: float

    def forms_apart(self, profile: Floats) -> float:
        """By how much, in cost, forms (m,) of left and right that differ so are less common than forms alike: of each 95 % keep the tolerance of the gear's
        class, and what they have in common is its design's."""
        grid = self.cells.grid
        apart = self._by_column(profile, Side.LEFT) - self._by_column(profile, Side.RIGHT)
        seen = np.isfinite(apart)
        line = np.column_stack([np.ones(grid.flank), 0.5 * (grid.roll_edges[:-1] + grid.roll_edges[1:])])[seen]
        form = np.ptp(apart[seen] - line @ np.linalg.lstsq(line, apart[seen])[0]) if seen.any() else 0.0
        tolerance = profile_form_tolerance(grid.gear.normal_module, grid.gear.tolerance.flank_class)
        return (NORMAL_95 * float(form) / tolerance) ** 2 / len(Side)  # the variance of a difference is that of both

    def or_as_cut(self, lost: SideLoss, side: Side, cost: float, unworn: float) -> float:
        """What a loss costs: no less than `unworn` where all teeth have it alike, and flanks of the gear's class may be cut with it, or no load leaves it."""
        as_cut = self._within(lost, side, self.cells.grid.gear.tolerance.flank_class) or not self._as_slid(lost.loss, side)
        return max(cost, unworn) if as_cut and not lost.uneven else cost

    def _within(self, lost: SideLoss, side: Side, flank_class: int | None) -> bool:
        """Whether flanks of a class may be cut with the form of a loss."""
        return self._in_tolerance(lost, side, flank_class) <= 1.0

    def _in_tolerance(self, lost: SideLoss, side: Side, flank_class: int | None) -> float:
        """The form of a loss in the form tolerance of a class."""
        return self._form(lost.loss, side) / profile_form_tolerance(self.cells.grid.gear.normal_module, flank_class)

    def uncommon(self, lost: SideLoss) -> float:
        """By how much, in cost, a form that both sides lost is less common among flanks of the gear's class than none: 95 % of them keep the tolerance."""
        flank_class = self.cells.grid.gear.tolerance.flank_class
        return (NORMAL_95 * min(self._in_tolerance(lost, side, flank_class) for side in Side)) ** 2

    def least_worn(
        self, worn: frozenset[Side], losses: list[SideLoss], of_no_shape: list[SideLoss], unworn: float
    ) -> WornCost | None:
        """Of the best model beside wear on some sides, of whatever shape wear may have; None where it has none of these.

        A loss of no shape that wear has by itself, which all teeth have alike, costs no less than `unworn` where flanks of the gear's class may be cut
        with it, or where no load leaves it; and no loss of one side of a form that ground flanks have, where all are by chance alone cheaper.
        """
        if len(worn) > 1:
            both = min(losses, key=lambda lost: lost.cost, default=None)
            return None if both is None else WornCost(both.cost, self.uncommon(both))
        (side,) = worn
        costs = [self.or_as_cut(lost, side, lost.cost, unworn) for lost in of_no_shape]
        chance = all(lost.cost > unworn - rules().close for lost in (*losses, *of_no_shape))
        for lost in losses:
            # By chance alone cheaper than a form that ground flanks have.
            made = chance and not lost.uneven and self._within(lost, side, rules().ground_class)
            costs.append(max(lost.cost, unworn) if made else lost.cost)
        return least_of(costs)

    def _on_flanks(self, side: Side) -> Ints:
        """The cells that a fit may use on the flanks of a side."""
        points = self.cells.points
        rows: Ints = self.rows[((points.surface == FLANK) & (points.side == int(side)))[self.rows]]
        return rows

    def _form(self, loss: Floats, side: Side) -> float:
        """How far a loss (m,) on the flanks of a side lies off a slope and a lead, peak to peak, mm."""
        points = self.cells.points
        rows = self._on_flanks(side)
        roll, height = points.roll[rows], points.position[rows, 2]
        plane = np.column_stack([np.ones(len(rows)), roll, height, roll * height])
        return float(np.ptp(loss[rows] - plane @ np.linalg.lstsq(plane, loss[rows])[0]))

    def _as_slid(self, loss: Floats, side: Side) -> bool:
        """`as_slid` of a loss (m,) on the flanks of a side."""
        grid, lost = self.cells.grid, -self._by_column(loss, side)
        seen, edges = np.isfinite(lost), grid.roll_edges
        way = 0.5 * (edges[:-1] + edges[1:])[seen] - self.pitch_roll
        return as_slid(lost[seen], way, profile_form_tolerance(grid.gear.normal_module, rules().ground_class))

    def _by_column(self, values: Floats, side: Side) -> Floats:
        """(columns,) means of values (m,) on the flanks of a side; nan where no cell may be used."""
        grid, rows = self.cells.grid, self._on_flanks(side)
        column = grid.flank_column(self.cells.points.roll[rows])
        number = np.bincount(column, minlength=grid.flank)
        means = np.bincount(column, values[rows], grid.flank) / np.maximum(number, 1)
        return np.where(number > 0, means, np.nan)


def least_of(costs: list[float]) -> WornCost | None:
    """The least of some costs; None of none."""
    return WornCost(min(costs)) if costs else None
