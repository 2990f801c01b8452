"""Whether a scan is of the design: a distorted one is, another gear is refused or at least doubted."""

import math
import re
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.measured_gear import register
from gearwear.design import parse_design
from gearwear.errors import InputError
from gearwear.placing.registration import CellFit, _known
from tests.placing.placing import designed, true_pose
from tests.synthetic import PINION, GearNumbers, Recipe, make_scan

FINE, MIDDLE = GearNumbers(54, 0.5, 5.0), GearNumbers(31, 0.8, 5.0)
STRETCH = 0.016
"""What flatbed scanners really show."""


@cache
def outline(numbers: GearNumbers, stretch: float = 0.0, degrees: float = 90.0, noise_um: float = 4.0) -> np.ndarray:
    """A planar section in a frame of its own, then longer along a direction."""
    scan = make_scan(Recipe(numbers, pose="mild", noise_um=noise_um, ends="none", jitter=1.0).of_size(8_000), 1)
    points = true_pose(scan).apply(scan.points)[:, :2]
    turn = np.array([[math.cos(0.05), -math.sin(0.05)], [math.sin(0.05), math.cos(0.05)]])
    points = points @ turn.T + [3.0, -7.0]
    along = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
    return points + stretch * np.outer(points @ along, along)


def laid_on(points: np.ndarray, teeth: int, module: float, pressure_angle: float = 20.0) -> tuple[str, ...]:
    """The doubts of a scan on this design.

    Raises
    ------
    InputError
        If it is refused.
    """
    gear = {"teeth": teeth, "module": module, "pressure_angle": pressure_angle, "face_width": 5.0, "rack_tip_radius": 0.2}
    return register(parse_design({"gear": gear}), as_scan(points)).notes


@pytest.mark.long
@pytest.mark.parametrize(
    ("numbers", "degrees"),
    [
        (PINION, 20.0),
        pytest.param(PINION, 90.0, marks=pytest.mark.long),
        pytest.param(MIDDLE, 20.0, marks=pytest.mark.long),
        pytest.param(MIDDLE, 90.0, marks=pytest.mark.long),
        pytest.param(FINE, 20.0, marks=pytest.mark.long),
        pytest.param(FINE, 90.0, marks=pytest.mark.long),
    ],
    ids=lambda of: of if isinstance(of, float) else of.teeth,
)
def test_a_section_stretched_along_one_direction_is_still_of_its_gear(numbers, degrees):
    laid_on(outline(numbers, STRETCH, degrees), numbers.teeth, numbers.module)


@pytest.mark.parametrize("numbers", [PINION, pytest.param(MIDDLE, marks=pytest.mark.long)], ids=["12", "31"])
def test_an_undistorted_section_is_not_doubted(numbers):
    assert not any("check that" in note for note in laid_on(outline(numbers), numbers.teeth, numbers.module))


OTHER = {
    "a tooth more": (1, 1.0, 20.0),
    "a tooth less": (-1, 1.0, 20.0),
    "module 5 % larger": (0, 1.05, 20.0),
    "module 5 % smaller": (0, 0.95, 20.0),
    "25 degrees": (0, 1.0, 25.0),
}


def design_of(numbers: GearNumbers, name: str) -> tuple[int, float, float]:
    more, factor, angle = OTHER[name]
    return numbers.teeth + more, numbers.module * factor, angle


@pytest.mark.parametrize("name", OTHER)
@pytest.mark.parametrize("numbers", [PINION, pytest.param(MIDDLE, marks=pytest.mark.long)], ids=["12", "31"])
def test_a_stretched_section_of_another_gear_is_refused_or_doubted(numbers, name):
    try:
        notes = laid_on(outline(numbers, STRETCH), *design_of(numbers, name))
    except InputError as refusal:
        assert re.search(r"does not fit the design|is not of this gear", str(refusal))
    else:
        assert any("check that the scan is of this gear" in note or "points lie on the design" in note for note in notes)


@pytest.mark.parametrize("name", [name for name in OTHER if "degrees" not in name])
@pytest.mark.parametrize("numbers", [PINION, pytest.param(MIDDLE, marks=pytest.mark.long)], ids=["12", "31"])
def test_another_gear_in_an_undistorted_section_is_refused(numbers, name):
    with pytest.raises(InputError, match=r"does not fit the design|is not of this gear"):
        laid_on(outline(numbers), *design_of(numbers, name))


@pytest.mark.parametrize("numbers", [PINION, pytest.param(MIDDLE, marks=pytest.mark.long)], ids=["12", "31"])
def test_another_pressure_angle_is_doubted(numbers):
    notes = laid_on(outline(numbers), *design_of(numbers, "25 degrees"))
    assert any("check that the scan is of this gear" in note for note in notes)


@pytest.mark.parametrize("step", [10.0, 2.6e12, math.nan])
def test_a_pose_that_moves_by_more_than_a_module_at_last_is_none(step):
    fit = CellFit(np.zeros(6), np.zeros((6, 6)), 0.0, step)
    cells = SimpleNamespace(grid=SimpleNamespace(gear=designed()))
    with pytest.raises(InputError, match="do not hold the gear"):
        _known(None, cells, None, np.ones(6, dtype=bool), fit, None, 1.0)


@pytest.mark.parametrize("above", [44.43, 44.435, 44.44, 44.445])
def test_next_to_no_flanks_are_too_few(above):
    """A ring of tips alone lies on the design without showing its teeth; few cells, and a turn that nothing holds, by where it begins."""
    scan = make_scan(Recipe(pose="none", noise_um=4.0, ends="none", jitter=1.0).of_size(8_000), 1)
    radius = np.hypot(*scan.points[:, :2].T)
    with pytest.raises(InputError):
        laid_on(scan.points[radius > above][:, :2], 12, 6.35)
