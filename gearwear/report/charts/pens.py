"""Many curves of one look as one artist: hundreds of artists take longer than what they draw."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwear.arrays import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.path import Path

FINEST = 0.15
"""mm of paper; how closely the outline of a pale area is drawn: half a pixel of the page. Lines are thinned by matplotlib, to a ninth of a point."""


class Pens:
    """Areas, and curves over them, collected by their looks and drawn in the order in which these are given.

    Parameters
    ----------
    areas : mapping of str to dict
        How each kind is filled, as `PathPatch` takes it.
    lines : mapping of str to dict
        How each kind is drawn, as `Axes.plot` takes it.
    """

    def __init__(self, areas: Mapping[str, Mapping[str, Any]], lines: Mapping[str, Mapping[str, Any]]) -> None:
        self.areas, self.lines = areas, lines
        self._areas: defaultdict[str, list[Floats]] = defaultdict(list)
        self._curves: defaultdict[str, list[Floats]] = defaultdict(list)

    def line(self, kind: str, x: Floats, y: Floats) -> None:
        """A curve, mm of paper; with gaps where it is nan."""
        if np.isfinite(x + y).any():
            self._curves[kind] += [np.column_stack([x, y]), np.full((1, 2), np.nan)]

    def area(self, kind: str, y: Floats, low: Floats, high: Floats) -> None:
        """What lies from `low` to `high` at the heights `y`, mm of paper; with gaps where one of them is nan."""
        seen = np.isfinite(low + high)
        for start, stop in np.flatnonzero(np.diff(seen, prepend=False, append=False)).reshape(-1, 2):
            there, back = (np.column_stack([edge, y])[start:stop] for edge in (low, high))
            self._areas[kind].append(np.concatenate([there, back[::-1], there[:1]]))

    def draw(self, page: Axes) -> None:
        """Put all on a sheet."""
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path

        for kind, look in self.areas.items():
            if outlines := self._areas.get(kind):
                # As `add_patch`, which asks curve by curve how far they reach: a sheet has its own limits.
                page.add_artist(PathPatch(Path.make_compound_path(*map(_thinned, outlines)), **look))
        for kind, look in self.lines.items():
            if curves := self._curves.get(kind):
                page.plot(*np.concatenate(curves).T, **look)


def _thinned(outline: Floats) -> Path:
    """A closed outline, mm of paper, by fewer corners."""
    from matplotlib.path import Path

    whole = Path(outline)
    whole.simplify_threshold = FINEST
    return Path(np.asarray(whole.cleaned(simplify=True).vertices)[:-1], closed=True)
