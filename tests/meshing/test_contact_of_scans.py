"""What a scanned gear does in contact, against the gear itself: made and worn by code that shares nothing with the package."""

from __future__ import annotations

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.stations import compare
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.meshing.contact import mesh_contact
from tests.synthetic import AbrasiveWear, Patch, Recipe, SlidingWear, Texture, make_scan
from tests.synthetic.make_example import RECIPE, ply_bytes
from tests.synthetic.outline import Outline, involute_angle
from tests.synthetic.removal import depth_below

pytestmark = pytest.mark.long

SIDES = ((0, 1), (1, -1))


def true_profiles(recipe: Recipe, gear: gw.Gear) -> ToothProfiles:
    """The worn part itself: the involute moved by the depth at its own radius, and the fillet where that lies outside of it."""
    outline = Outline.of(recipe.gear)
    strip = np.linspace(outline.base_radius - 1e-4, outline.form_radius, 40)
    radius = np.unique(np.concatenate([np.linspace(gear.root_radius, gear.flank_end_radius, 180), strip]))
    along_face = any(isinstance(wear, Patch) for wear in recipe.wear)  # else all sections are alike
    z = np.linspace(0.0, outline.face_width, 25) if along_face else np.array([0.5 * outline.face_width])
    own = np.sqrt(np.maximum(radius**2 - outline.base_radius**2, 0.0))
    involute = outline.base_half_angle - involute_angle(own, outline.base_radius)
    half_angle = np.empty((outline.teeth, 2, len(z), len(radius)))
    for tooth in range(outline.teeth):
        for half, side in SIDES:
            depth = depth_below(recipe.wear, outline, tooth, side, np.broadcast_to(own, (len(z), len(own))), z[:, None])
            nominal = outline.half_angle(radius)
            moved = np.where((depth > 0.0) & (radius >= outline.base_radius), involute - depth / outline.base_radius, np.inf)
            half_angle[tooth, half] = np.minimum(nominal, moved)
    return ToothProfiles(gear, radius, z, half_angle)


CASES = {
    "as the specific sliding": Recipe(
        wear=(SlidingWear(75.0, 1, (), "archard"),), noise_um=10.0, jitter=1.0, texture=Texture(2.0, 1.0)
    ).of_size(25_000),
    "one tooth evenly": Recipe(wear=(AbrasiveWear(50.0, 1, (3,)),), noise_um=10.0, jitter=1.0, texture=Texture(2.0, 1.0)).of_size(
        25_000
    ),
    "the bundled example": RECIPE.of_size(25_000),
}


@pytest.mark.parametrize("case", CASES)
def test_transmission_error_and_backlash_are_those_of_the_gear_itself(case, tmp_path):
    """Of the gear, not of the noise: cells whose noise of 5 µm was left in would touch at their highest, and nearly nothing seem lost."""
    recipe = CASES[case]
    (tmp_path / "scan.ply").write_bytes(ply_bytes(make_scan(recipe, 20140814).points))
    design = gw.read_design(gw.example())
    study = compare(design, [tmp_path / "scan.ply"], inspection=False).pair
    mate = design.gears["gear"]
    flat = nominal_profiles(mate, np.linspace(mate.root_radius, mate.tip_radius, 200), np.array([7.5]))
    true = mesh_contact(true_profiles(recipe, design.gears["pinion"]), flat, design.centre_distance, positions_per_pitch=34)
    found, spread = study.contact, study.spread
    # Besides their own scatter: cells of 0.5 mm do not show how sharp the pitch line is, some 3 % of the greatest lag.
    shape = 0.03 * -true.transmission_error_min.value
    error = 1e-3 * (found.peak_to_peak_um - true.peak_to_peak_um)
    assert abs(error) < 3.0 * spread.transmission_error + shape
    assert abs(found.backlash_max.value - true.backlash_max.value) < 3.0 * spread.backlash_greatest + shape
    assert abs(found.backlash.mean() - true.backlash.mean()) < 3.0 * spread.backlash_mean + shape
    # And the scatter stated is of use.
    assert spread.transmission_error < 0.15e-3 * true.peak_to_peak_um
    along = found.transmission_error - np.interp(found.rotation, true.rotation, true.transmission_error)
    assert np.sqrt(np.mean(along**2)) < 0.15e-3 * true.peak_to_peak_um + 0.001
