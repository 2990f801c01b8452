"""Root form: fillets, bottom lands and the lower end of the flanks as they are, alike on all teeth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FILLET, FLANK, ROOT, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, from_form_on
from gearwear.diagnose.effects.free_levels import FreeLevels
from gearwear.diagnose.parameter import Parameter

ROOT_FORM = "root_form"
"""The effect that leaves the root free."""
LOWER_END = 0.3
"""Share of the flank's length of roll, from the form circle on, that may be the root's: a protuberance reaches so far."""
KNOTS = 3
"""Places between the form circle and there at which the lower end has a deviation of its own, straight between them."""


@dataclass(frozen=True)
class RootForm(FreeLevels):
    """δ = a level of its own in the middle of every column of the fillets that was seen, straight between them, both sides alike, and on bottom lands:
    + is metal left standing; on the lower end of the flanks a deviation of any shape that ends where the involute surely begins.

    Notes
    -----
    Drawings seldom tell how a root was cut. What is the same in all spaces is the tool's and no evidence; what differs from tooth to tooth,
    along z or between left and right still is. Where the involute begins is the tool's as well: protuberance undercuts the flank, stock is left
    below what was ground.
    """

    name: ClassVar[str] = ROOT_FORM
    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "free profile that the spaces share; none is assumed"
    tells_apart: ClassVar[str] = "State the tool: its tip radius, protuberance and the grinding stock."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("level_um"),)
    phrase: ClassVar[str] = "roots of a form of their own, {level_um} off the drawn one"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return bool(context.fillet_edges) and bool(context.surfaces & {FILLET, ROOT})

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        parts = []
        if FILLET in context.surfaces:
            parts.append(np.where((points.surface == FILLET)[:, None], _fillet(points, context), 0.0))
        if ROOT in context.surfaces:
            parts.append(np.asarray(points.surface == ROOT, dtype=np.float64)[:, None])
        if FLANK in context.surfaces:
            parts.append(_lower_end(points, context))
        return np.hstack(parts)


def _fillet(points: SurfacePoints, context: Context) -> Floats:
    """(n, k) weight of the level in the middle of each column: straight between the middles, and on beyond the outer ones."""
    way, edges = context.gear.orientation, np.asarray(context.fillet_edges)  # from the root to the flank
    # A fillet runs into the bottom land: along it, the radius grows with the square of the way.
    root = context.gear.root_radius
    ends, at = (
        np.sqrt(np.maximum(way * (r - root), 0.0)) for r in (edges, np.hypot(points.position[:, 0], points.position[:, 1]))
    )
    middles = 0.5 * (ends[:-1] + ends[1:])
    if len(middles) == 1:
        return np.ones((len(at), 1))
    left = np.clip(np.searchsorted(middles, at, side="right") - 1, 0, len(middles) - 2)
    share = (at - middles[left]) / (middles[left + 1] - middles[left])
    weights = np.zeros((len(at), len(middles)))
    rows = np.arange(len(at))
    weights[rows, left], weights[rows, left + 1] = 1.0 - share, share
    return weights


def _lower_end(points: SurfacePoints, context: Context) -> Floats:
    """(n, KNOTS) deviation of the lower end of the flanks for one at each knot: knots by equal arcs, none at the upper end."""
    gear = context.gear
    reach = gear.form_roll + LOWER_END * (gear.tip_roll - gear.form_roll)
    knots = np.linspace(gear.form_roll**2, reach**2, KNOTS + 1)
    way, square = gear.orientation, from_form_on(points.roll, gear) ** 2
    values = np.column_stack([np.interp(way * square, way * knots, row) for row in np.eye(KNOTS + 1)[:-1]])
    return np.where((points.surface == FLANK)[:, None], values, 0.0)


EFFECT = RootForm()
