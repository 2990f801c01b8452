"""The ring generator against the design room: two routes to one surface."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import FLANK, OTHER, locate
from tests.synthetic.ring import Ring, ring_scan

RINGS = (Ring(), Ring(helix=-20.0), Ring(teeth=60, module=2.0, helix=12.0, shift=-0.2, rim=70.0))


def designed(ring: Ring, fillet: bool = True) -> Gear:
    return Gear.from_spec(
        GearSpec(
            "gear", ring.teeth, ring.module, ring.width, math.radians(ring.pressure), ring.shift, ring.addendum, ring.dedendum,
            helix_angle=math.radians(ring.helix), internal=True, fillet_radius=ring.fillet_radius if fillet else None,
            rim_diameter=2.0 * ring.rim,
        )
    )  # fmt: skip


@pytest.mark.parametrize("ring", RINGS)
@pytest.mark.parametrize("coat", [0.0, 0.02])
def test_every_point_lies_on_the_design(ring, coat):
    cloud = ring_scan(ring, 6000, noise=0.0, coat=coat)
    found = locate((cloud.points - cloud.translation) @ cloud.rotation, designed(ring))
    known = found.surface != OTHER
    assert known.mean() > 0.97  # at edges a coat stands beside the surfaces
    # Steps of the search for where the fillet touches; a coat on the fillet there is told from the flank's by the point's own radius.
    assert found.deviation[known] == pytest.approx(coat, abs=2e-5 if coat == 0.0 else 2e-4)
    assert np.median(np.abs(found.deviation[found.surface == FLANK] - coat)) < 1e-12


def test_volume_of_a_patch_is_that_of_the_sections_it_widens():
    """Of a spur ring, by the areas between the angles of both skins: dA = r dr Δψ at equal radius, with Δψ = d / r_b."""
    from tests.synthetic.tooth import Patch

    ring = Ring()
    patch = Patch(0, 1, 0.4, (19.0, 22.0), (2.0, 12.0))
    roll, z = np.linspace(*patch.roll, 4001), np.linspace(*patch.z, 201)
    depth = patch.at(roll[:, None], z)
    own = roll[:, None] + depth  # a point taken off a ring's flank lies further out: at a greater roll, on the same normal
    area = np.trapezoid((depth / ring.base * own)[1:] * 1.0, own[1:], axis=0)
    assert ring.volume(patch) == pytest.approx(np.trapezoid(area, z), rel=1e-4)
