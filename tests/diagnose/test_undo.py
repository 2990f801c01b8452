"""Strong effects taken back in space: the part's own points come back, and what is left is no effect of its own."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from benchmarks.loop_study.run import study
from benchmarks.loop_study.scenario import Scenario
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.undo import undone
from gearwear.placing.pose import small_motion
from tests.diagnose.sample import ODD, sample
from tests.synthetic import Effect, Recipe

BY_NAME = {effect.name: effect for effect in catalogue()}


@dataclass(frozen=True)
class Named:
    candidate: Candidate
    amplitudes: np.ndarray


@dataclass(frozen=True)
class Told:
    """What `undone` asks of a loop."""

    motion: np.ndarray
    effects: tuple[Named, ...]


def told(motion, *effects):
    none = np.zeros(0, dtype=int)
    return Told(motion, tuple(Named(Candidate(BY_NAME[name], shape, none), np.array(size)) for name, shape, size in effects))


def test_points_carried_off_by_a_scale_a_shear_and_a_motion_come_back():
    true = sample(ODD).position
    stretch = np.diag([1.0 + 0.008, 1.0 - 0.008, 1.0]) + 0.012 * np.eye(3)
    motion = np.array([0.3, -0.2, 0.1, 0.002, -0.001, 0.004])
    back = small_motion(-motion)
    scanned = (true @ stretch.T - back.translation) @ back.rotation
    loop = told(motion, ("scale", (), [0.012]), ("scale_anisotropic", (), [0.016, 0.0]), ("coating", (), [0.05]))
    # the coat is not taken back: it is along the normal, and exact as it is
    np.testing.assert_allclose(undone(scanned, loop), true, atol=1e-6)


def test_a_wrong_line_of_sight_is_taken_back_on_its_own_circles():
    true = sample(ODD).position
    radius, angle = np.hypot(true[:, 0], true[:, 1]), np.arctan2(true[:, 1], true[:, 0])
    angle = angle + 0.3 / radius
    scanned = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), true[:, 2]])
    np.testing.assert_allclose(undone(scanned, told(np.zeros(6), ("axis_offset_lateral", (), [0.3]))), true, atol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("effects", "names"),
    [
        ((Effect("scale", {"relative_ppm": 4000.0}),), ["scale"]),
        (
            (Effect("axis_offset_lateral", {"offset_um": -200.0}), Effect("axis_offset_radial", {"offset_um": 80.0})),
            ["axis_offset_radial", "axis_offset_lateral"],
        ),
    ],
    ids=["scale", "offsets"],
)
def test_a_hundred_times_the_limit_leaves_no_second_order_piece(effects, names):
    """80 µm of a scale is 1.3 µm of a bent line on fillets to first order, which passed for root relief."""
    recipe = replace(Recipe(noise_um=6.0, jitter=1.0, pose="any", effects=effects).of_size(20_000))
    one = study(Scenario("test", recipe, 5, mate=False))[0]
    assert [found["name"] for found in one["found"]] == names
    assert one["patterns"] == []
    assert one["rms_um"]["after"] < 1.05 * one["rms_um"]["put_in"]  # what the study asks for (docs/study.md)
    for true in one["true"]:
        for error in true["errors"].values():
            assert abs(error["error"]) < 4.0 * error["std"]
