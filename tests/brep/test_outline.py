"""The outline closes, and the oracle of its parallels is right."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.brep.curves import Spline
from gearwear.brep.outline import Arc, rotation, tooth_edges
from gearwear.design import Gear, GearSpec
from gearwear.design.surface import Bands, locate
from gearwear.errors import InputError
from tests.brep.parallels import inset


def outline_samples(gear: Gear) -> np.ndarray:
    """(n, 3) points of the outline of one tooth at mid width."""
    rows = []
    for edge in tooth_edges(gear):
        if isinstance(edge.shape, Spline):
            rows.append(edge.shape.points(np.linspace(0.0, 1.0, 40)))
        elif isinstance(edge.shape, Arc):
            rows.append(edge.start[None, :])
    flat = np.concatenate(rows)
    return np.column_stack([flat, np.full(len(flat), 0.5 * gear.face_width)])


@pytest.mark.parametrize("extra", [{}, {"tip_chamfer": 0.8}, {"rack_tip_radius": 0.0}])
def test_each_edge_starts_where_the_last_one_ended(pinion, extra):
    gear = Gear.from_spec(replace(pinion.spec, **extra))
    edges = tooth_edges(gear)
    following = [edge.start for edge in edges[1:]] + [edges[0].start @ rotation(gear.pitch_angle)]
    for edge, end in zip(edges, following, strict=True):
        if isinstance(edge.shape, Spline):
            np.testing.assert_allclose(edge.shape.poles[[0, -1]], [edge.start, end], rtol=0, atol=1e-13)
        elif isinstance(edge.shape, Arc):
            np.testing.assert_allclose(np.hypot(*np.array([edge.start, end]).T), edge.shape.radius, rtol=0, atol=1e-13)


@pytest.mark.parametrize("depth", [0.05, 0.6])
@pytest.mark.parametrize("teeth", [12, 17, 18, 24, 60])
def test_an_inset_outline_lies_at_its_depth_everywhere(teeth, depth):
    gear = Gear.from_spec(GearSpec("gear", teeth, 6.35, 15.0))
    found = locate(outline_samples(inset(gear, depth)), gear, replace_bands(gear, depth))
    np.testing.assert_allclose(found.deviation, -depth, rtol=0, atol=1e-9)


def replace_bands(gear, depth):
    near = (-2.0 * depth, 2.0 * depth)
    return replace(Bands.wide(gear), tip=near, root=near)


def test_an_edge_too_short_for_a_solid_is_refused():
    pointed = GearSpec("pinion", 12, 6.35, 15.0)
    limit = Gear.from_spec(pointed)
    low, high = 1.0, 1.5  # the addendum at which the tooth is pointed, from below, by bisection on what is refused
    for _ in range(60):
        middle = 0.5 * (low + high)
        try:
            limit = Gear.from_spec(replace(pointed, addendum=middle))
            low = middle
        except InputError:
            high = middle
    assert limit.tip_half_angle * limit.tip_radius < 1e-6
    with pytest.raises(InputError, match=r"\[pinion\] the tip would be an edge of .* too short for a solid model"):
        tooth_edges(limit)


def test_the_tip_chamfer_is_a_straight_line_to_the_tip_circle():
    gear = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, tip_chamfer=0.8))
    edges = {edge.name: edge for edge in tooth_edges(gear)}  # the last of each name: the left side's
    assert np.hypot(*edges["chamfer"].start) == pytest.approx(gear.tip_radius, abs=1e-13)
    end = [edge for edge in tooth_edges(gear) if edge.name == "flank"][1].start
    assert np.hypot(*end) == pytest.approx(gear.tip_radius - 0.8, abs=1e-12)
    assert math.atan2(edges["chamfer"].start[1], edges["chamfer"].start[0]) == pytest.approx(gear.tip_half_angle, abs=1e-15)
