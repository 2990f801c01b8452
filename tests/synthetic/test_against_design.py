"""Two ways to the same gear that share no code: the generator's points located by `gearwear.design`."""

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import Bands, locate
from tests.synthetic import PINION, WHEEL, Effect, GearNumbers, Patch, Recipe, SlidingWear, Surface, make_scan

GEARS = [
    PINION,
    WHEEL,
    GearNumbers(teeth=17, module=3.0, profile_shift=0.3, rack_tip_radius=0.38, thinning=0.15, bore_diameter=16.0),
]


def designed(numbers: GearNumbers) -> Gear:
    return Gear.from_spec(
        GearSpec(
            "gear",
            numbers.teeth,
            numbers.module,
            numbers.face_width,
            math.radians(numbers.pressure_angle_deg),
            numbers.profile_shift,
            numbers.addendum,
            numbers.dedendum,
            numbers.rack_tip_radius,
            numbers.thinning,
            numbers.bore_diameter,
        )
    )


@pytest.mark.parametrize("numbers", GEARS)
def test_unworn_points_lie_on_the_design_with_its_normals(numbers):
    scan = make_scan(Recipe(numbers, slices=6, points_per_tooth=301, end_points=3000, noise_um=0.0, pose="none"), 1)
    coated = make_scan(
        Recipe(
            numbers, slices=6, points_per_tooth=301, end_points=3000, noise_um=0.0, pose="none",
            effects=(Effect("coating", {"thickness_um": 20.0}),),
        ),
        1,
    )  # fmt: skip
    gear = designed(numbers)
    found = locate(scan.points, gear)
    assert np.abs(found.deviation).max() < 1e-9
    # and the coat comes back as 20 µm: the normals agree; corners belong to either surface
    over = locate(coated.points, gear)
    assert np.mean(np.abs(over.deviation - 0.020) < 1e-8) > 0.98
    labels = scan.truth.labels
    edge = np.abs(np.nan_to_num(labels.roll, nan=10.0) - gear.tip_roll) < 1e-6
    assert np.mean(found.surface == labels.surface) > 0.995
    flank = (labels.surface == Surface.FLANK) & (found.surface == Surface.FLANK) & ~edge
    assert found.roll[flank] == pytest.approx(labels.roll[flank], abs=1e-9)
    assert np.array_equal(found.tooth[flank], labels.tooth[flank])
    assert np.array_equal(found.side[flank], labels.side[flank])


def test_worn_and_misshapen_flanks_are_found_with_their_true_deviation():
    recipe = Recipe(
        slices=15,
        points_per_tooth=301,
        ends="none",
        noise_um=0.0,
        pose="none",
        wear=(SlidingWear(80.0), Patch(4, 1, 1500.0, (36.3, 44.3), (1.0, 14.0))),
        effects=(
            Effect("tooth_thickness", {"thickness_um": -50.0}),
            Effect("profile_slope", {"left_um": 20.0, "right_um": -10.0}),
            Effect("helix_slope", {"slope_um": 25.0}),
        ),
    )
    scan, gear = make_scan(recipe, 1), designed(PINION)
    labels = scan.truth.labels
    found = locate(scan.points, gear, Bands.wide(gear))
    flank = (labels.surface == Surface.FLANK) & (found.surface == Surface.FLANK)
    assert flank.sum() > 0.97 * (labels.surface == Surface.FLANK).sum()
    assert found.deviation[flank] == pytest.approx(labels.deviation[flank], abs=1e-9)
    # a turned flank's normals turn with it: the foot stays where the turn alone would put it
    turn = (labels.deviation - (-labels.depth))[flank]
    assert np.abs(found.roll[flank] - labels.roll[flank]).max() <= np.abs(turn).max() + 1e-9
