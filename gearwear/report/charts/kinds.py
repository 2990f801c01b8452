"""Which charts an inspection has, and the sheets that each goes on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from gearwear.inspection.inspection import Inspection
from gearwear.report.charts.areal import areal_chart
from gearwear.report.charts.pitch import pitch_chart
from gearwear.report.charts.traces import helix_chart, profile_chart, rows_of, section_chart

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class InspectionChart:
    """A kind of chart of an inspection.

    Parameters
    ----------
    inspection : Inspection
    draw : callable
        Draws on a figure, given it and the inspection; of one that is `in_rows` some teeth alone, given them too.
    in_rows : bool
        Whether many teeth go on several sheets of paper.
    """

    inspection: Inspection
    draw: Callable[..., Figure]
    in_rows: bool = False

    def whole(self) -> Figure:
        """All teeth on one sheet."""
        from matplotlib.figure import Figure

        return self.draw(Figure(), self.inspection)

    @property
    def several(self) -> bool:
        """Whether it takes more than one sheet of paper."""
        return self.in_rows and len(self._rows) > 1

    def pages(self) -> Iterator[Figure]:
        """A row of teeth on each, all at one magnification, drawn when it is asked for."""
        from matplotlib.figure import Figure

        return (self.draw(Figure(), self.inspection, row) for row in self._rows)

    @property
    def _rows(self) -> list[list[int]]:
        return rows_of(range(self.inspection.gear.teeth))


def charts_of(inspection: Inspection) -> dict[str, InspectionChart]:
    """Profile, helix and pitch, and where lines and surfaces were asked for and seen, those; a planar section has no helices."""
    draws: dict[str, Callable[..., Figure]] = {"profile": profile_chart}
    if np.isfinite(inspection.helix.slope.value).any():
        draws["helix"] = helix_chart
    examined = inspection.laboratory
    if examined is not None:
        for kind, cuts in (("profile", examined.sections.profiles), ("helix", examined.sections.helices)):
            if np.isfinite(cuts[1].evaluation.slope.value).any():
                draws[f"{kind}_middle"] = partial(section_chart, section=cuts[1])
    charts = {kind: InspectionChart(inspection, draw, in_rows=True) for kind, draw in draws.items()}
    if examined is not None and np.isfinite(examined.areal.flanks.twist.value).any():
        charts["surfaces"] = InspectionChart(inspection, partial(areal_chart, examined=examined))
    return charts | {"pitch": InspectionChart(inspection, pitch_chart)}
