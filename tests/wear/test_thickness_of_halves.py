"""Thickness of a double helical gear: each half by itself, its ends at the groove as those of the face."""

from dataclasses import replace

import numpy as np

from gearwear.design import parse_design
from gearwear.design.surface import FLANK, locate
from gearwear.design.twist import from_end
from tests.synthetic.double_helical import Double, WornHalf, double_scan
from tests.synthetic.helical import Helical, Patch
from tests.wear.sections import section_thickness

NOISE = 0.006
DRAWN = Double(Helical(teeth=17, helix=24.0, width=11.0), gap=1.0)
LOWER = DRAWN.lower
DESIGN = parse_design(
    {
        "gear": {
            "teeth": LOWER.teeth, "module": LOWER.module, "helix_angle": LOWER.helix, "profile_shift": LOWER.shift,
            "face_width": DRAWN.width, "gap": DRAWN.gap,
        }
    }
).gears["gear"]  # fmt: skip


def located(count: int, wear=()):
    cloud = double_scan(DRAWN, count, noise=NOISE, seed=6, wear=wear)
    return locate((cloud.points - cloud.translation) @ cloud.rotation, DESIGN)


def test_what_is_worn_at_the_groove_does_not_reach_across_it():
    """0.3 mm off tooth 4 of the lower half, deepest where the groove begins, in a scan so thin that sections are pooled over more than the gap."""
    reference = np.sqrt(LOWER.reference**2 - LOWER.base**2)
    patch = Patch(4, 1, 0.3, (reference - 5.0, reference + 5.0), (LOWER.width - 6.0, LOWER.width + 6.0))
    found = section_thickness(located(30_000, (WornHalf(False, patch),)), DESIGN, NOISE)
    assert found.pooled * (found.z[1] - found.z[0]) > 2.0 * DRAWN.gap
    loss = found.nominal - found.arc[4]
    lower, upper = found.z < LOWER.width, found.z > LOWER.width + DRAWN.gap
    assert np.nanmax(loss[lower]) > 0.1
    near = upper & (found.z < LOWER.width + DRAWN.gap + 3.0)
    assert np.isfinite(loss[near]).any()
    assert np.nanmax(np.abs(loss[near]) / found.std[4, near]) < 4.5
    assert np.isnan(loss[~lower & ~upper]).all()


def test_rounded_ends_at_the_groove_are_left_out_as_those_of_the_face_are():
    points = located(90_000)
    off = from_end(DESIGN, points.position[:, 2])
    fall = np.where((points.surface == FLANK) & (off < 1.0), 0.3 * (1.0 - off), 0.0)
    found = section_thickness(replace(points, deviation=points.deviation - fall), DESIGN, NOISE)
    seen = np.isfinite(found.arc).mean(axis=0) > 0.5
    ends = from_end(DESIGN, found.z)
    assert not seen[(ends >= 0.0) & (ends < 0.25)].any()
    assert seen[ends > 2.0].all()
    # At the groove as at the ends of the face: as many sections on either side of a half's middle.
    for low, high in ((0.0, LOWER.width), (LOWER.width + DRAWN.gap, DRAWN.width)):
        half = seen[(found.z >= low) & (found.z <= high)]
        assert abs(int(half[: len(half) // 2].sum()) - int(half[len(half) // 2 :].sum())) <= 1
