import numpy as np

from gearwear.diagnose.effects.feed_marks import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet


def example(amplitude, wavelength, phase, follow, gear=BORED):
    a, f = 1e-3 * amplitude, np.radians(phase)
    parameters = {"amplitude_um": amplitude, "wavelength_mm": wavelength, "phase_deg": phase}
    return Example(parameters, (a * np.cos(f), -a * np.sin(f)), (wavelength, follow), gear)


EXAMPLES = [example(4.0, 5.3, 30.0, 1.0), example(6.0, 3.7, 200.0, 0.3, ODD)]


def displace(sample, parameters, shape):
    wave = np.cos(2 * np.pi * sample.z / parameters["wavelength_mm"] + np.radians(parameters["phase_deg"]))
    return sample.cut(sample.side * 1e-3 * parameters["amplitude_um"] * wave / sample.outline.base_radius, fillets=shape[1])


def test_fillets_follow_by_the_share():
    points = feet()
    none, half, all_ = (EFFECT.basis(points, context(), (4.0, share)) for share in (0.0, 0.5, 1.0))
    fillet = points.surface == 1
    assert not none[~(points.surface == 0)].any()
    np.testing.assert_allclose(half[fillet], 0.5 * all_[fillet], atol=1e-15)
    assert np.abs(all_[fillet]).max() > 0.5


def test_wavelengths_of_the_grid_leave_no_gap():
    """Neighbours differ by half a wave over the face, so every wavelength is within a quarter of one of the grid's."""
    waves = 15.0 / np.array([shape[0] for shape in EFFECT.shapes(context())])
    np.testing.assert_allclose(np.diff(waves), 0.5)
    assert waves[0] == 1.5
    assert 0.5 > 15.0 / (0.2 * 6.35) - waves[-1] > 0.0
