"""Scans made from nothing but the drawing: the truth for tests and studies, sharing no code with gearwear."""

from tests.synthetic.effects import BENT, OUTSIDE, PARAMETERS, Effect
from tests.synthetic.outline import PINION, WHEEL, GearNumbers, Outline, Surface
from tests.synthetic.pose import PoseError, Rigid, pose_error, rotation_about
from tests.synthetic.recipe import FlankTruth, Hole, Labels, Recipe, SyntheticScan, Truth, Views
from tests.synthetic.removal import AbrasiveWear, Patch, SlidingWear, removed_volume
from tests.synthetic.scan import make_scan
from tests.synthetic.texture import Texture

__all__ = [
    "BENT",
    "OUTSIDE",
    "PARAMETERS",
    "PINION",
    "WHEEL",
    "AbrasiveWear",
    "Effect",
    "FlankTruth",
    "GearNumbers",
    "Hole",
    "Labels",
    "Outline",
    "Patch",
    "PoseError",
    "Recipe",
    "Rigid",
    "SlidingWear",
    "Surface",
    "SyntheticScan",
    "Texture",
    "Truth",
    "Views",
    "make_scan",
    "pose_error",
    "removed_volume",
    "rotation_about",
]
