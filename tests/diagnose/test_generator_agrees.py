"""The catalogue against the synthetic generator, which shares no code with it and knows the contract's names: what is put in comes back."""

import math

import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.diagnose.effects import catalogue
from tests.diagnose.sample import BORED, context
from tests.synthetic import BENT, OUTSIDE, PARAMETERS, Effect, Recipe, make_scan

INDEX = 30.0 * np.cos(1.7 * np.arange(12))
PUT_IN = {
    # name: parameters, shape with its choices
    "coating": ({"thickness_um": 18.0}, ()),
    "scale": ({"relative_ppm": 500.0}, ()),
    "scale_anisotropic": ({"difference_ppm": 400.0, "direction_deg": 120.0}, ()),
    "height_scale": ({"relative_ppm": 1000.0}, ()),
    "axis_offset_radial": ({"offset_um": 20.0}, ()),
    "axis_offset_lateral": ({"offset_um": -20.0}, ()),
    "turntable_angle": ({"order": 3, "amplitude_deg": 0.03, "phase_deg": 25.0}, (3.0,)),
    "scan_drift": ({"closure_deg": 0.05, "start_deg": 10.0}, (math.radians(10.0),)),
    "eccentricity": ({"amplitude_um": 20.0, "direction_deg": 50.0}, ()),
    "wobble": ({"amplitude_um": 20.0, "direction_deg": 250.0}, (1.0,)),
    "tooth_thickness": ({"thickness_um": -60.0}, (1.0,)),
    "profile_slope": ({"left_um": 12.0, "right_um": -7.0}, (0.0,)),
    "profile_crowning": ({"crowning_um": 9.0}, ()),
    "helix_crowning": ({"crowning_um": 9.0}, (1.0,)),
    "tip_relief": ({"amount_um": 25.0, "start_mm": 20.0}, (20.0,)),
    "root_relief": ({"amount_um": 25.0, "start_mm": 9.0}, (9.0,)),
    "helix_slope": ({"slope_um": 20.0}, (1.0,)),
    "taper": ({"taper_um": -20.0}, (1.0,)),
    "twist": ({"twist_um": 20.0}, ()),
    "pitch": ({"index_um": tuple((INDEX - INDEX.mean()).tolist())}, (1.0,)),
    "thickness_variation": ({"thickness_um": tuple((INDEX - INDEX.mean()).tolist())}, (1.0,)),
    "feed_marks": ({"amplitude_um": 4.0, "wavelength_mm": 3.0, "phase_deg": 30.0}, (3.0, 1.0)),
}


def test_all_effects_of_the_generator_are_here():
    assert set(PUT_IN) == set(PARAMETERS) - set(OUTSIDE) - set(BENT)


@pytest.mark.parametrize("name", PUT_IN)
def test_what_the_generator_puts_in_comes_back(name):
    """Every surface at once, no noise: parameters to 1 %, and less than 2 % of the deviation left."""
    parameters, shape = PUT_IN[name]
    recipe = Recipe(
        gear=BORED,
        slices=7,
        points_per_tooth=101,
        end_points=2000,
        noise_um=0.0,
        pose="none",
        effects=(Effect(name, parameters),),
    )
    scan = make_scan(recipe, 1)
    about = context()
    located = locate(scan.points, about.gear)
    points = located.take(located.surface == scan.truth.labels.surface)
    assert len(points) > 0.97 * len(located)
    effect = next(e for e in catalogue() if e.name == name)
    basis = effect.basis(points, about, shape)
    amplitudes = np.linalg.lstsq(basis, points.deviation, rcond=None)[0]
    left = points.deviation - basis @ amplitudes
    assert np.sqrt(np.mean(left**2)) < 0.02 * np.sqrt(np.mean(points.deviation**2))
    found = effect.estimates(amplitudes, np.eye(len(amplitudes)) * 1e-12, shape, about)
    for parameter, value in parameters.items():
        size = np.abs(value).max()
        np.testing.assert_allclose(found[parameter].value, value, atol=0.01 * size, err_msg=parameter)
