"""A dozen effects in place of the whole catalogue: the loop takes half as long with them, for tests that do not ask which of all it is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from gearwear.diagnose.effects import catalogue

PLAIN = tuple(
    effect
    for effect in catalogue()
    if effect.name
    in {
        "abrasive_wear", "coating", "face_level", "helix_slope", "pitch", "profile_crowning", "profile_slope", "root_form", "sliding_wear",
        "taper", "thickness_variation", "tooth_thickness",
    }
)  # fmt: skip
"""What flanks have of themselves and wear, a coat, and what the loop puts in by itself; none of a place that is searched."""
PLAIN_AND_ALL = pytest.mark.parametrize(
    "effects", [pytest.param(PLAIN, id="plain"), pytest.param(None, id="all", marks=pytest.mark.long)]
)
"""A test of the loop with either: quick, and against all that it could be."""


@contextmanager
def plain_effects(*more: str) -> Iterator[None]:
    """In the body a loop that is told no effects searches these, and `more` by name."""
    searched = tuple(effect for effect in catalogue() if effect.name in {*(one.name for one in PLAIN), *more})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gearwear.diagnose.loop.catalogue", lambda: searched)
        yield
