"""A chamfer that nobody drew, or another root, cuts metal off: what is modified of the flanks stays where it was drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from gearwear.design import Gear, GearSpec
from gearwear.design.modification import FlankModification
from gearwear.design.side import Side

MODIFIED = FlankModification(
    tip_relief=0.04, tip_relief_length=4.0, root_relief=0.02, root_relief_length=2.0, profile_slope=0.03, profile_crowning=0.01,
    helix_crowning=0.02,
)  # fmt: skip
OTHER = FlankModification(tip_relief=0.03, tip_relief_length=3.0, tip_relief_form="parabolic")
EXTERNAL = GearSpec("gear", 30, 3.0, 14.0, left=MODIFIED, right=OTHER)
RING = replace(EXTERNAL, teeth=42, internal=True, addendum=0.8, fillet_radius=0.5, rim_diameter=150.0)
CUTS = [
    (EXTERNAL, {"tip_chamfer": 0.45}), (RING, {"tip_chamfer": 0.3}), (EXTERNAL, {"rack_tip_radius": 0.2}), (EXTERNAL, {"dedendum": 1.4}),
]  # fmt: skip


@pytest.mark.parametrize(("spec", "cut"), CUTS)
def test_flanks_stay_where_they_are_drawn(spec: GearSpec, cut: dict[str, float]):
    drawn, z = Gear.from_spec(spec), np.array([0.0, 3.0, 7.0])
    recut = drawn.recut(**cut)
    low, high = (
        f(a, b) * spec.orientation for f, a, b in (
            (max, *(spec.orientation * one.form_radius for one in (drawn, recut))),
            (min, *(spec.orientation * one.flank_end_radius for one in (drawn, recut))),
        )
    )  # fmt: skip
    radius = np.sort(np.linspace(low, high, 50))
    assert recut.half_angles(radius, z) == pytest.approx(drawn.half_angles(radius, z), abs=1e-15)
    again = recut.recut(tip_chamfer=0.6)  # and stay when it is cut once more
    radius = radius[spec.orientation * radius <= spec.orientation * again.flank_end_radius]
    assert again.half_angles(radius, z) == pytest.approx(drawn.half_angles(radius, z), abs=1e-15)


@pytest.mark.parametrize(("spec", "cut"), CUTS)
def test_what_is_modified_adds_the_area_that_it_adds_to_the_flanks(spec: GearSpec, cut: dict[str, float]):
    """∫ δ₀ / r_b · r dr from root circle to tip circle on both sides, all teeth, against thousands of radii."""
    recut = Gear.from_spec(spec).recut(**cut)
    plain = replace(spec, **cut, left=FlankModification(), right=FlankModification())
    ends = sorted((recut.root_radius, recut.tip_radius))
    radius = np.linspace(*ends, 200_001)
    roll = np.clip(recut.roll_length(radius), *sorted((recut.form_roll, recut.tip_roll)))
    added = sum(recut.drawn(side).offset(roll, 3.0) for side in Side) / recut.base_radius
    more = recut.teeth * float(trapezoid(added * radius, radius))
    assert recut.section_area(3.0) - Gear.from_spec(plain).section_area(3.0) == pytest.approx(more, abs=1e-6)
