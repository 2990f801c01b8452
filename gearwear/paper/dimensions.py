"""The gears as the paper gives them."""

from __future__ import annotations

import math

from gearwear.paper.explain import Row, changed, cut, explain, rounded
from gearwear.paper.inputs import MODULE, PAPER


def dimensions() -> tuple[Row, ...]:
    return (
        explain(
            "pinion tip diameter",
            "mm",
            "89",
            lambda p: p.module * (p.teeth[0] + 2),
            [rounded(0)],
            right=MODULE * 14,
            why="Rounded. Half of it, 44.5, comes back in the contact lengths.",
        ),
        explain(
            "pinion base diameter",
            "mm",
            "71.60",
            lambda p: 2 * p.base_radii[0],
            [cut(2)],
            right=2 * PAPER.base_radii[0],
            why="Rounded; it does no harm.",
        ),
        explain(
            "gear base diameter",
            "mm",
            "143.2",
            lambda p: 2 * p.base_radii[1],
            [cut(1)],
            right=2 * PAPER.base_radii[1],
            why="Rounded; it does no harm.",
        ),
        explain(
            "pinion root diameter",
            "mm",
            "60.325",
            lambda p: p.module * (p.teeth[0] - 2.5),
            right=MODULE * 9.5,
            why="Exact: the dedendum is 1.25 modules.",
        ),
        explain(
            "gear root diameter",
            "mm",
            "136.525",
            lambda p: p.module * (p.teeth[1] - 2.5),
            right=MODULE * 21.5,
            why="Exact: the dedendum is 1.25 modules.",
        ),
        explain(
            "circular pitch",
            "mm",
            "19.949",
            lambda p: p.pi * p.module,
            [changed("π in place of the 3.14 that stands in the formula", pi=math.pi), cut(3)],
            right=math.pi * MODULE,
            why="The formula is printed with 3.14; the value was made with π.",
        ),
    )
