"""How many teeth a scan has, by how often its pattern repeats: of outlines whose number is known, laid on designs of another."""

import math
import re
from functools import cache

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.which_gear import placed_as
from gearwear.design import parse_design
from gearwear.errors import NotThisGear
from gearwear.placing.tooth_count import other_count
from tests.placing.placing import designed, true_pose
from tests.synthetic import GearNumbers, Recipe, make_scan

TEETH = 21


def numbers(teeth: int) -> GearNumbers:
    return GearNumbers(teeth, 2.0, 10.0)


@cache
def scan(teeth: int, points: int = 12_000) -> np.ndarray:
    """Points of a gear in the design frame, (n, 3) mm."""
    made = make_scan(
        Recipe(numbers(teeth), pose="mild", noise_um=5.0, ends="both", end_points=2_000, jitter=1.0).of_size(points), 1
    )
    return true_pose(made).apply(made.points)


def aside_by(modules: float) -> np.ndarray:
    return np.array([2.0 * modules, 0.0, 0.0])


def counted(points: np.ndarray, teeth: int) -> int | None:
    return other_count(points[:, :2], designed(numbers(teeth)))


@pytest.mark.parametrize("teeth", [9, TEETH, 60])
@pytest.mark.parametrize("more", [-1, 1])
def test_a_tooth_more_or_less_is_told_about_the_designs_axis_or_beside_it(teeth, more):
    """A scan rolled off its axis by e meshes with the design's teeth where e / m is about half a tooth."""
    for aside in (0.0, 0.5, 1.0):
        assert counted(scan(teeth) + aside_by(aside), teeth - more) == teeth


@pytest.mark.parametrize("share", [0.35, 0.55, 0.75, 1.0])
@pytest.mark.parametrize("aside", [0.0, 0.2])
def test_no_part_of_its_own_gear_is_another(share, aside):
    """Of an arc of φ, z ± 1 repeats sin(φ / 2) / (φ / 2) times as strongly as z: less, whatever φ is."""
    points = scan(TEETH)
    angle = np.arctan2(points[:, 1], points[:, 0])
    assert counted(points[np.abs(angle) < share * math.pi] + aside_by(aside), TEETH) is None


def test_missing_and_broken_teeth_are_none_of_another_gear():
    points = scan(TEETH)
    tooth = np.rint(np.arctan2(points[:, 1], points[:, 0]) * TEETH / (2.0 * math.pi))
    high = np.hypot(*points[:, :2].T) > designed(numbers(TEETH)).reference_radius
    assert counted(points[~(np.isin(tooth, [0, 1, 5]) & high)], TEETH) is None


@pytest.mark.parametrize("fewer", [1, pytest.param(-1, marks=pytest.mark.long)])
def test_a_design_of_one_tooth_more_or_less_is_refused(fewer):
    gear = {"teeth": TEETH - fewer, "module": 2.0, "face_width": 10.0, "rack_tip_radius": 0.3}
    with pytest.raises(NotThisGear) as refusal:
        placed_as(parse_design({"gear": gear}), [as_scan(scan(TEETH, 24_000))], ["gear"])
    assert re.search("21 teeth are counted in it, and the design has 20" if fewer > 0 else "not of this gear", str(refusal.value))
