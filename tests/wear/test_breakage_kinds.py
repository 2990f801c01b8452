"""Breakage of helical gears, halves of double helical ones and rings: the volume of a known cut."""

import numpy as np
import pytest

from gearwear.design import parse_design
from gearwear.design.surface import locate
from gearwear.placing.cells import CellGrid
from gearwear.wear.breakage import find_fractures, measure_broken, with_borders
from tests.synthetic.broken import Break
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.helical import Helical, scan
from tests.synthetic.ring import Ring, ring_scan

NOISE = 0.006
ONE = Helical(teeth=23, module=3.0, helix=-20.0, width=14.0)
TWO = Double(Helical(teeth=19, module=3.0, helix=24.0, width=12.0), gap=5.0)
SPUR_RING = Ring(teeth=42, module=2.5, shift=0.1, rim=65.0)
HELICAL_RING = Ring(teeth=36, module=3.0, helix=15.0, shift=0.0, rim=70.0)


def tooth_of(gear, upper=False):
    """The gear of one helix a tooth is of, where it begins, and its hand against the design's."""
    if isinstance(gear, Double):
        return gear.lower, (gear.lower.width + gear.gap if upper else 0.0), (-1.0 if upper else 1.0)
    return gear, 0.0, 1.0


def broken_off(gear, kind: str, upper: bool = False) -> Break:
    """A corner at the upper end of the face, or nearly the whole tooth."""
    half, low, hand = tooth_of(gear, upper)
    way = -1.0 if isinstance(half, Ring) else 1.0
    probe = Break(half, np.zeros(3), np.zeros(3), low, hand)
    root, tip = sorted(probe.ends, reverse=way < 0.0)
    middle, turn = low + 0.5 * half.width, hand * half.turn
    if kind == "missing tooth":
        radius, z, normal = root + 0.12 * (tip - root), middle, np.array([way, 0.05, 0.01])
    else:
        radius, z, normal = tip - 0.7 * (tip - root), low + half.width, np.array([way / 3.5, 0.02, 1.0 / 5.0])
    angle = turn * (z - middle)
    cos, sin = np.cos(angle), np.sin(angle)
    normal = np.array([cos * normal[0] - sin * normal[1], sin * normal[0] + cos * normal[1], normal[2]])
    return Break(half, np.array([radius * cos, radius * sin, z]), normal / np.linalg.norm(normal), low, hand)


def drawn(gear):
    half, ring = tooth_of(gear)[0], isinstance(gear, Ring)
    given = {
        "teeth": half.teeth, "module": half.module, "helix_angle": half.helix, "profile_shift": half.shift, "addendum": half.addendum,
        "face_width": gear.width,
    }  # fmt: skip
    given |= {"internal": True, "rim_diameter": 2.0 * gear.rim, "fillet_radius": gear.fillet_radius} if ring else {}
    given |= {"gap": gear.gap} if isinstance(gear, Double) else {}
    return parse_design({"gear": given}).gears["gear"]


MAKE = {Helical: scan, Double: double_scan, Ring: ring_scan}


def measured(gear, cuts):
    cloud = MAKE[type(gear)](gear, 60_000, noise=NOISE, seed=3)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    for cut in cuts:
        points = cut.of(points, NOISE)
    design = drawn(gear)
    grid = CellGrid.for_scan(design, len(points))
    fractures = find_fractures(points, design)
    border = with_borders(points, fractures, design, NOISE)
    return grid, measure_broken(points, grid.index(locate(points, design)), fractures, border, grid, NOISE)


@pytest.mark.parametrize(
    ("gear", "kind"),
    [
        (ONE, "missing tooth"),
        pytest.param(ONE, "broken corner", marks=pytest.mark.long),
        pytest.param(SPUR_RING, "missing tooth", marks=pytest.mark.long),
        pytest.param(SPUR_RING, "broken corner", marks=pytest.mark.long),
        pytest.param(HELICAL_RING, "missing tooth", marks=pytest.mark.long),
        pytest.param(HELICAL_RING, "broken corner", marks=pytest.mark.long),
    ],
)
def test_a_cut_is_named_with_its_volume(gear, kind):
    cut = broken_off(gear, kind)
    _, (broken,) = measured(gear, [cut])
    assert (broken.tooth, broken.kind) == (0, kind)
    assert abs(broken.volume - cut.volume) < 3.0 * broken.std
    assert broken.std < 0.06 * broken.volume


@pytest.mark.parametrize("kind", [pytest.param("missing tooth", marks=pytest.mark.long), "broken corner"])
def test_the_other_half_of_a_tooth_stands(kind):
    cut = broken_off(TWO, kind, upper=True)
    grid, (broken,) = measured(TWO, [cut])
    assert (broken.tooth, broken.kind) == (0, kind)
    assert abs(broken.volume - cut.volume) < 3.0 * broken.std
    assert broken.std < 0.06 * broken.volume
    (lower, _), (upper, _) = grid.zones
    assert not broken.flank_gone[:, lower].any() and broken.flank_gone[:, upper].any()


@pytest.mark.parametrize(
    "gear",
    [ONE, TWO, pytest.param(SPUR_RING, marks=pytest.mark.long), HELICAL_RING],
    ids=["helical", "double", "ring", "helical ring"],
)
def test_nothing_is_broken_off_a_whole_gear(gear):
    assert measured(gear, [])[1] == ()
