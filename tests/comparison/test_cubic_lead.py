"""A helix angle that varies along the face: no effect of the catalogue is odd and cubic in z, so none may be named, and the pattern is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design import parse_design
from gearwear.design.pair import Design
from tests.synthetic import PINION, Recipe, make_scan
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed

AMOUNT = 0.015
"""Greatest deviation along the transverse base tangent, mm: at the ends."""


def cubic(z, width):
    """Legendre's third: without any part of a helix slope."""
    u = 2.0 * z / width - 1.0
    return AMOUNT * 0.5 * (5.0 * u**3 - 3.0 * u)


def spur():
    """Every section of a spur gear turned by its own angle."""
    design = parse_design({"gear": {"teeth": 12, "module": 6.35, "face_width": 15.0}})
    points = make_scan(replace(Recipe(PINION, noise_um=6.0), pose="none").of_size(30_000), 3).points
    turn = cubic(points[:, 2], 15.0) / design.gears["gear"].base_radius
    cos, sin = np.cos(turn), np.sin(turn)
    x, y, z = points.T
    return design, np.column_stack([cos * x - sin * y, sin * x + cos * y, z])


def helical(angle):
    gear = Helical(teeth=17, helix=angle, width=12.0)
    cloud = scan(gear, 30_000, noise=0.006, seed=5, added=lambda side, roll, z: side * cubic(z, gear.width))
    return Design({"gear": designed(gear)}), cloud.points


@pytest.mark.long
@pytest.mark.parametrize("made", [spur, lambda: helical(-18.0), lambda: helical(25.0)], ids=["spur", "left", "right"])
def test_it_is_told_as_what_it_is_and_not_named(made):
    design, points = made()
    measured = gw.find_effects(gw.register(design, gw.as_scan(points)), frozenset())
    loop = measured.loop
    assert loop is not None and not loop.effects and not loop.worn_sides
    (pattern,) = loop.patterns
    assert (pattern.order, pattern.sides) == (0, "opposite")
    assert pattern.waves_z == pytest.approx(1.5, abs=0.1)  # up, down, up and down: three half waves
    flank = measured.cells.grid.flank_shape(pattern.field)
    middle = (np.arange(flank.shape[2]) + 0.5) / flank.shape[2] * measured.gear.face_width
    told = 0.5 * (flank[:, 0] - flank[:, 1]).mean(axis=(0, 2))
    truth = cubic(middle, measured.gear.face_width) * measured.gear.base_helix_cosine
    # Odd in z and opposite on the sides: the same whichever end is up.
    assert np.corrcoef(told, truth)[0, 1] > 0.98
    assert float(told @ truth / (truth @ truth)) == pytest.approx(1.0, abs=0.2)
    assert not gw.find_wear(measured).regions
