import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.diagnose.effects.base import MADE, MEASURED
from gearwear.diagnose.effects.edge_rounding import EFFECT
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.placing.cells import CellGrid, bin_points, noise
from tests.diagnose.plain import PLAIN
from tests.diagnose.sample import ODD, Example, context, feet
from tests.placing.placing import designed
from tests.synthetic import Recipe, make_scan

EXAMPLES = [
    Example({"amount_um": 50.0, "width_mm": 4.0}, (0.05,), (4.0,)),
    Example({"amount_um": 40.0, "width_mm": 1.8}, (0.04,), (1.8,), gear=ODD),
]


def displace(sample, parameters, shape):
    """Down along the normal by a parabola that ends half a width from tip corners and face edges."""
    o, width = sample.outline, parameters["width_mm"]
    corner = 1.0 - o.tip_roll / o.tip_radius  # 1 − cos κ between flank and tip land
    within = np.angle(np.exp(1j * (sample.theta - sample.tooth * o.pitch_angle)))
    arc = np.where(sample.surface == 3, o.tip_radius * (o.tip_half_angle - np.abs(within)), np.inf)
    arc[sample.flank] = (o.tip_roll**2 - sample.roll[sample.flank] ** 2) / (2 * o.base_radius)
    face = np.where(sample.teeth, np.minimum(sample.z, o.face_width - sample.z), np.inf)
    tip_fall = np.clip(1 - 2 * arc / width, 0, 1) ** 2
    face_fall = np.clip(1 - 2 * face / width, 0, 1) ** 2 / np.sqrt(corner)  # sin 45° / sin(κ/2)
    return sample.pushed(-1e-3 * parameters["amount_um"] * np.maximum(tip_fall, face_fall))


def test_depth_at_an_edge_is_the_moving_average_of_a_wedge():
    """Averaged numerically: a right-angled edge under a spot of 0.4 mm reads w sin 45° / 4 low along the normal."""
    width, half = 0.4, np.pi / 4
    t = (np.arange(1000) - 499.5) / 1000 * width
    fall = np.mean(np.abs(t)) * np.tan(half) * np.cos(half)
    assert fall == pytest.approx(width * np.sin(half) / 4, rel=1e-6)
    about = context()
    deep = EFFECT.basis(feet(), about, (2.6,))  # the sample begins 0.76 mm from the edges
    face = np.isclose(feet().position[:, 2], 0.12 * 6.35) & (feet().surface == 2)
    ratio = -deep[face, 0] / (1 - 2 * 0.762 / 2.6) ** 2
    np.testing.assert_allclose(ratio, np.sin(half) / np.sin(0.5 * np.radians(90.0 - 36.346184)), rtol=1e-6)


@pytest.mark.parametrize("chamfer", [0.0, 0.3])
def test_beside_a_chamfer_edges_that_fall_off_are_as_they_were_cut(chamfer):
    """They are taken out either way, and no spot of the scanner's where the corner is a chamfer's, which may be longer than drawn."""
    gear = designed().recut(tip_chamfer=chamfer) if chamfer else designed()
    located = locate(make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none").of_size(40_000), 3).points, gear)
    cells = bin_points(located, CellGrid.for_scan(gear, len(located)), clip=0.3)
    about = make_context(cells, np.eye(3), False)
    falls = np.where(cells.seen, 0.06 * EFFECT.basis(cells.points, about, (1.8,))[:, 0], 0.0)
    low = cells.with_deviation(cells.points.deviation + falls)
    loop = close_loop(low, noise(low), about, (*PLAIN, EFFECT))
    assert [EFFECT.name in {one.name for one in told} for told in (loop.effects, loop.form)] == [not chamfer, bool(chamfer)]
    points = cells.points.take(cells.seen)
    deepest = [-float(loop.deviation(points, kinds).min()) for kinds in (MEASURED, MADE)]
    assert [depth > 0.02 for depth in deepest] == [not chamfer, bool(chamfer)]
