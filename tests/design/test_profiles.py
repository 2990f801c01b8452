from dataclasses import replace

import numpy as np
import pytest

from gearwear.api import example
from gearwear.design.files.profiles import read_profiles, write_profiles
from gearwear.design.files.toml import read_design
from gearwear.design.profiles import SectionLoss, ToothProfiles, nominal_profiles
from gearwear.design.side import Side
from gearwear.design.surface import flank_points
from gearwear.errors import InputError
from gearwear.meshing.study import study_meshing


@pytest.fixture(scope="module")
def nominal(pinion):
    return nominal_profiles(pinion, np.linspace(pinion.form_radius, pinion.tip_radius, 41), np.array([0.0, 7.5, 15.0]))


def test_the_design_has_lost_nothing(nominal, pinion):
    assert nominal.half_angle.shape == (12, 2, 3, 41)
    assert (nominal.loss == 0.0).all()
    at = float(nominal.radius[20])
    np.testing.assert_allclose(nominal.thickness(at), float(pinion.thickness(at)), rtol=1e-14)


def test_loss_is_the_depth_along_the_normal(nominal, pinion):
    """An inward parallel of an involute is the same involute turned: take the polar angle of really displaced points."""
    depth = 0.3
    worn = nominal.half_angle.copy()
    for side in Side:
        roll = np.sqrt(nominal.radius**2 - pinion.base_radius**2) + depth  # foot of the worn point at each radius
        p = flank_points(pinion, np.full(41, 5), np.full(41, side), roll, np.zeros(41))
        moved = p.position[:, :2] - depth * p.normal[:, :2]
        np.testing.assert_allclose(np.hypot(*moved.T), nominal.radius, rtol=1e-13)
        angle = np.arctan2(moved[:, 1], moved[:, 0]) - 5 * pinion.pitch_angle
        worn[5, side.index, 1] = side * np.angle(np.exp(1j * angle))
    profiles = ToothProfiles(pinion, nominal.radius, nominal.z, worn)
    np.testing.assert_allclose(profiles.loss[5, :, 1], depth, rtol=0, atol=1e-12)
    assert np.count_nonzero(profiles.loss) == 2 * 41
    # thickness loss of both sides: 2 r d / r_b
    at = float(nominal.radius[30])
    lost = float(pinion.thickness(at)) - profiles.thickness(at)[5, 1]
    assert lost == pytest.approx(2 * at * depth / pinion.base_radius, rel=1e-12)


def test_a_gear_that_was_compared_by_itself_is_known_among_a_pair(tmp_path, pinion):
    """By itself it was called "gear"; of the pair it is the pinion, by its teeth and circles."""
    design = read_design(example())
    radius = np.linspace(pinion.root_radius, pinion.tip_radius, 9)
    half = np.broadcast_to(pinion.half_angle(radius), (12, 2, 2, 9))
    for told in ("pinion", "gear"):
        np.savez(tmp_path / "worn_profiles.npz", radius=radius, z=[0.0, 15.0], half_angle=half, part=np.array(told))
        assert read_profiles(tmp_path, design)[0] == "pinion"
    np.savez(tmp_path / "worn_profiles.npz", radius=radius, z=[0.0, 15.0], half_angle=half[:-1], part=np.array("gear"))
    with pytest.raises(InputError, match="is of a gear with 11 teeth"):
        read_profiles(tmp_path, design)


def test_a_thickness_that_was_measured_goes_with_the_profiles(tmp_path, pinion):
    """And a file of an older version, which has none, is read as before."""
    design, file = read_design(example()), tmp_path / "worn_profiles.npz"
    new = nominal_profiles(pinion)
    for lost in (SectionLoss(0.3, 4, 2.5), SectionLoss(-0.01, 0, 15.0), None):
        write_profiles(file, replace(new, lost=lost), "pinion")
        assert read_profiles(file, design)[1].lost == lost
        worn = study_meshing(design, wear=file).worn
        assert (worn.loss, worn.tooth, worn.z) == ((0.3, 4, 2.5) if lost is not None and lost.value > 0.0 else (0.0, None, None))


@pytest.mark.parametrize(
    "lost", [[0.3, 4.0], [np.nan, 4.0, 2.5], [0.3, 4.5, 2.5], [0.3, 12.0, 2.5], [0.3, 4.0, np.inf], [90.0, 4.0, 2.5]]
)
def test_a_thickness_that_is_none_is_refused(tmp_path, pinion, lost):
    new, file = nominal_profiles(pinion), tmp_path / "worn_profiles.npz"
    np.savez(file, radius=new.radius, z=new.z, half_angle=new.half_angle, part=np.array("pinion"), lost=np.array(lost))
    with pytest.raises(InputError, match="lost must be"):
        read_profiles(file, read_design(example()))
