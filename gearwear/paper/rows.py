"""Every number of the paper, in the order of its argument."""

from __future__ import annotations

from gearwear.paper.dimensions import dimensions
from gearwear.paper.distances import distances
from gearwear.paper.explain import Row
from gearwear.paper.lengths import contact_lengths
from gearwear.paper.loss import thickness_loss
from gearwear.paper.scan import scan


def chapters() -> dict[str, tuple[Row, ...]]:
    """All rows by chapter; nothing is stored, every number is computed on the spot."""
    return {
        "The gears": dimensions(),
        "The loss of thickness": thickness_loss(),
        "Backlash and centre distance": distances(),
        "Contact lengths": contact_lengths(),
        "The scan": scan(),
    }


def rows() -> tuple[Row, ...]:
    """All rows in order.

    >>> worn = next(row for row in rows() if row.item.startswith("contact length after wear"))
    >>> [round(step.residual, 3) for step in worn.steps]
    [-0.007, 0.003, 0.0]
    """
    return tuple(row for chapter in chapters().values() for row in chapter)
