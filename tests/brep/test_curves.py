"""Splines against the curves they stand for: degree, bound, and the gears that ask for more."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.brep.curves import DEGREE, FILLET_TOLERANCE, FLANK_TOLERANCE, Spline, drawn, interpolate
from gearwear.brep.paths import fillet_path, flank_paths, has_bottom_land
from gearwear.design import Gear, GearSpec
from gearwear.design.involute import roll_length
from gearwear.design.side import Side
from gearwear.errors import InputError

SHARE = np.linspace(0.0, 1.0, 1001)


def flank_curves(gear: Gear) -> tuple[Spline, ...]:
    """The left flank, drawn to 1e-10 mm."""
    return tuple(drawn(gear, path, FLANK_TOLERANCE) for path in flank_paths(gear, Side.LEFT))


def fillet_curve(gear: Gear) -> Spline:
    """The left root, drawn to 1e-10 mm."""
    return drawn(gear, fillet_path(gear, Side.LEFT), FILLET_TOLERANCE)


def rack_gear(teeth: int, degrees: float, tip: float, shift: float = 0.0) -> Gear:
    """Dedendum 1.25; `tip` is a share of the largest rack tip radius."""
    alpha = math.radians(degrees)
    full = (math.pi / 4 - 1.25 * math.tan(alpha)) * math.cos(alpha) / (1.0 - math.sin(alpha))
    return Gear.from_spec(
        GearSpec("gear", teeth, 6.35, 15.0, alpha, profile_shift=shift, rack_tip_radius=tip * full * (1.0 - 1e-15))
    )


def test_one_span_of_degree_nine_holds_the_flanks_of_the_paper(pinion, wheel):
    for gear in (pinion, wheel):
        flank = flank_curves(gear)[0]
        assert flank.degree == DEGREE
        assert len(flank.poles) == DEGREE + 1
        assert flank.error < 1e-10


def test_a_flank_from_near_the_base_circle_outward_gets_more_points():
    long = Gear.from_spec(GearSpec("gear", 6, 50.0, 15.0, rack_tip_radius=0.2, profile_shift=0.3))
    flank = flank_curves(long)[0]
    assert len(flank.poles) > DEGREE + 1
    assert flank.error < 1e-10


def test_the_flank_satisfies_the_equation_of_the_involute(pinion):
    # r_b (psi_b - psi(r)) = L - r_b atan(L / r_b): the polar equation, with neither roll angle nor nodes in it.
    points = flank_curves(pinion)[0].points(SHARE)
    radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
    roll = roll_length(np.maximum(radius, pinion.base_radius), pinion.base_radius)
    miss = (
        pinion.base_radius * (angle - pinion.base_half_angle) + roll - pinion.base_radius * np.arctan(roll / pinion.base_radius)
    )
    assert np.abs(miss).max() < 1e-11


@pytest.mark.parametrize("tip", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("degrees", [14.5, 20.0, 30.0])
@pytest.mark.parametrize(("teeth", "shift"), [(9, 0.2), (12, 0.0), (24, 0.0), (200, 0.0), (200, 1.0)])
def test_every_root_is_met_within_the_bound(teeth, degrees, tip, shift):
    gear = rack_gear(teeth, degrees, tip, shift)
    fillet = fillet_curve(gear)
    points = fillet.points(SHARE)
    radius, angle = np.hypot(*points.T), 0.5 * gear.pitch_angle - np.arctan2(points[:, 1], points[:, 0])
    phi = gear.rack.normal_angle(radius, angle, np.linspace(0.0, gear.fillet_end, len(points)), gear.fillet_end)
    assert np.abs(gear.rack.deviation(radius, angle, phi)).max() < 1e-9


def test_without_a_bottom_land_the_root_starts_on_the_spaces_centre_line():
    gear = rack_gear(24, 20.0, 1.0)
    assert not has_bottom_land(gear)
    foot = fillet_curve(gear).poles[0]
    assert np.arctan2(foot[1], foot[0]) == pytest.approx(0.5 * gear.pitch_angle, abs=1e-15)
    assert np.hypot(*foot) == pytest.approx(gear.root_radius, abs=1e-11)


def test_flank_and_fillet_meet(pinion, wheel):
    for gear in (pinion, wheel):
        np.testing.assert_allclose(fillet_curve(gear).poles[-1], flank_curves(gear)[0].poles[0], rtol=0, atol=5e-14)


def test_a_curve_that_cannot_be_met_is_refused():
    def corner(share):
        return np.column_stack([share, np.abs(share - 0.31)])

    with pytest.raises(InputError, match=r"cannot be drawn to 1e-10 mm; the best reached is 0\.00"):
        interpolate(corner, 1e-10)


def test_a_reversed_curve_runs_the_other_way(pinion):
    flank = flank_curves(pinion)[0]
    np.testing.assert_allclose(flank.reversed().points(1.0 - SHARE), flank.points(SHARE), rtol=0, atol=1e-13)
