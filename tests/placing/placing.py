"""What the tests of registration, cells and wear share: the gear of a recipe, and how far off a pose is."""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import locate
from gearwear.placing.cells import CellGrid, Cells, bin_points
from gearwear.placing.pose import Pose, about_z, flip
from gearwear.placing.registration import Registration, refine, stray_limit
from tests.synthetic import PINION, GearNumbers, Rigid, SyntheticScan


def designed(numbers: GearNumbers = PINION) -> Gear:
    """The design of a synthetic gear."""
    n = numbers
    spec = GearSpec(
        "pinion", n.teeth, n.module, n.face_width, math.radians(n.pressure_angle_deg), n.profile_shift, n.addendum, n.dedendum,
        n.rack_tip_radius, n.thinning, bore_diameter=n.bore_diameter,
    )  # fmt: skip
    return Gear.from_spec(spec)


def true_pose(scan: SyntheticScan) -> Pose:
    """From the scan to the design, as it was put in."""
    back = scan.truth.pose.inverse()
    return Pose(back.rotation, back.translation)


def motion_off(pose: Pose, true: Rigid, gear: Gear) -> Floats:
    """What is left of (tx, ty, tz in mm; wx, wy, wz in rad), in the frame found, once whole teeth and upside down are set aside."""
    both = Pose(true.rotation, true.translation).then(pose)
    if both.rotation[2, 2] < 0.0:
        both = flip(gear.face_width).then(both)
    teeth = round(math.atan2(both.rotation[1, 0], both.rotation[0, 0]) / gear.pitch_angle)
    r = about_z(-teeth * gear.pitch_angle).then(both).rotation
    turn = 0.5 * np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    return np.concatenate([both.translation, turn])


def refined(scan: SyntheticScan, gear: Gear) -> Registration:
    """The registration from the true pose on: what the coarse search adds is its own test's affair."""
    return refine(scan.points, gear, true_pose(scan))[0]


def binned(points: Floats, gear: Gear, registration: Registration) -> Cells:
    """A registered scan in cells."""
    located = locate(registration.pose.apply(points), gear, registration.bands)
    return bin_points(located, CellGrid.for_scan(gear, len(located)), clip=stray_limit(located))
