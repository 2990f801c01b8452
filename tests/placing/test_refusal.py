"""Whether what lies on the design is of this gear: distances, slopes and shares from just inside and just outside each limit."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import FLANK, OTHER, TIP, flank_points, locate
from gearwear.errors import InputError, NotThisGear
from gearwear.placing import refusal
from gearwear.placing.refusal import base_radius, check_gear, flanks_off, runs_otherwise, thicker_by
from tests.placing.placing import designed
from tests.synthetic import GearNumbers

GEAR = designed()
M = GEAR.transverse_module


def located(points: int = 24_000, slope: float = 0.0, off: float = 0.0, uneven: float = 0.0, lands: float = 0.05):
    """Points all over the flanks: deviations that rise with the roll, that are `off` on all, and go up and down by `uneven` from tooth to
    tooth, modules; a share of the points is of tips."""
    random = np.random.default_rng(2)
    tooth, side = random.integers(0, 12, points), random.choice([1, -1], points)
    roll, z = random.uniform(GEAR.form_roll, GEAR.tip_roll, points), random.uniform(0.0, 15.0, points)
    deviation = slope * (roll - roll.mean()) + M * (off + uneven * (-1.0) ** tooth)
    surface = np.where(np.arange(points) < lands * points, TIP, FLANK).astype(np.int8)
    return replace(flank_points(GEAR, tooth, side, roll, z), surface=surface).with_deviation(deviation)


def placed(points, fitting: float):
    registration = SimpleNamespace(fitting=fitting, observed=np.zeros(6, dtype=bool))
    return SimpleNamespace(located=points, registration=registration, measured=points.position)


@pytest.mark.parametrize(
    ("points", "fitting", "refused"),
    [
        # base circle 2.5 % off, unless 80 % of the points lie on the design all the same
        ({"slope": 0.024}, 0.7, False), ({"slope": 0.026}, 0.7, True), ({"slope": -0.026}, 0.7, True),
        ({"slope": 0.026}, 0.79, True), ({"slope": 0.026}, 0.81, False),
        # teeth up and down by 0.05 modules, as a robust standard deviation
        ({"uneven": 0.048 / 1.4826}, 0.7, False), ({"uneven": 0.052 / 1.4826}, 0.7, True),
        # flanks 0.03 modules off, if less than half of the points fit, or less than 2 % are of lands
        ({"off": 0.029}, 0.4, False), ({"off": 0.031}, 0.4, True), ({"off": 0.031}, 0.51, False), ({"off": 0.031}, 0.49, True),
        ({"off": 0.031, "lands": 0.021}, 0.7, False), ({"off": 0.031, "lands": 0.019}, 0.7, True),
        # without lands 0.08 modules are too far whatever fits, with them 0.25
        ({"off": 0.079, "lands": 0.0}, 0.9, False), ({"off": 0.081, "lands": 0.0}, 0.9, True),
        ({"off": 0.24}, 0.9, False), ({"off": 0.26}, 0.9, True),
    ],
)  # fmt: skip
def test_limits_of_what_may_be_this_gear(points, fitting, refused):
    scan = placed(located(**points), fitting)
    if not refused:
        check_gear(scan, GEAR)
        return
    with pytest.raises(NotThisGear, match="the scan is not of this gear"):
        check_gear(scan, GEAR)


@pytest.mark.parametrize(("number", "refused"), [(99, True), (100, False)])
def test_fewer_than_a_hundred_points_on_flanks_say_nothing(number, refused):
    points = located(2_000, lands=0.0)
    few = replace(points, surface=np.where(np.arange(len(points)) < number, FLANK, OTHER).astype(np.int8))
    scan = placed(few, 0.9)
    if refused:
        with pytest.raises(InputError, match="99 of 2,000 points lie on flanks"):
            check_gear(scan, GEAR)
    else:
        check_gear(scan, GEAR)


@pytest.mark.parametrize("slope", [-0.03, 0.001, 0.02])
def test_flanks_of_another_base_circle_run_off_by_its_relative_difference(slope):
    """dδ/dL = Δ / r_b."""
    assert base_radius(located(slope=slope, lands=0.0), GEAR) == pytest.approx(GEAR.base_radius * (1.0 + slope), rel=1e-9)


@pytest.mark.parametrize(("teeth", "level"), [(8, 0.0), (8, 0.3), (40, 0.3)])
def test_flanks_of_a_few_neighbouring_teeth_lie_as_far_off_as_they_do(teeth, level):
    """Pitch errors of 10 µm on a fifth of a gear: two waves round the gear and a level, which cancel there, once lay 0.2 mm off it."""
    gear = designed(GearNumbers(teeth=40, module=2.0))
    random = np.random.default_rng(5)
    number = 4000
    tooth, side = random.integers(0, teeth, number), random.choice([1, -1], number)
    points = flank_points(gear, tooth, side, random.uniform(8.0, 18.0, number), random.uniform(0.0, 10.0, number))
    pitch = 0.01 * random.normal(size=teeth)
    off = flanks_off(points.with_deviation(level + pitch[tooth] * side + 0.004 * random.normal(size=number)))
    assert off.distance == pytest.approx(level, abs=0.012)


@pytest.mark.parametrize(
    ("lower", "upper", "said"),
    [(3.0, -2.0, "double helical"), (1.5, -0.5, ""), (3.0, 3.0, "helical, right hand"), (0.5, -0.5, "")],
    ids=str,
)
def test_how_teeth_run_is_told_by_both_halves_together(monkeypatch, lower, upper, said):
    """Twists of the lower and upper half of a scan on a spur design, in the least that is called helical: a half alone may be off by its scatter."""
    steep = np.tan(np.deg2rad(refusal.HELICAL)) / GEAR.tip_radius
    twists = iter([lower * steep, upper * steep])
    monkeypatch.setattr(refusal, "normal_twist", lambda *_: next(twists))
    words = runs_otherwise(located(2_000).position, GEAR)
    assert said in words and bool(said) is bool(words)


@pytest.mark.parametrize("helix", [0.0, 22.0])
@pytest.mark.parametrize("thinning", [-0.2, 0.1])
def test_how_much_thicker_teeth_are_comes_back(helix, thinning):
    """Points of a gear cut so much thicker, on the design without: also where the gear is turned a little, and nothing where one side was not seen."""
    spec = GearSpec("gear", 25, 3.0, 20.0, helix_angle=math.radians(helix))
    design, cut = Gear.from_spec(spec), Gear.from_spec(replace(spec, thinning=thinning))
    random = np.random.default_rng(2)
    tooth, side = random.integers(0, 25, 20_000), random.choice([1, -1], 20_000)
    roll, z = random.uniform(design.form_roll + 1.0, design.tip_roll - 1.0, 20_000), random.uniform(1.0, 19.0, 20_000)
    points = flank_points(cut, tooth, side, roll, z).position
    turn = 1e-4
    points = points @ np.array([[math.cos(turn), math.sin(turn), 0.0], [-math.sin(turn), math.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    located = locate(points, design, workers=1)
    assert thicker_by(located, design) == pytest.approx(-thinning, abs=2e-4)
    assert math.isnan(thicker_by(located.take(located.side == 1), design))
