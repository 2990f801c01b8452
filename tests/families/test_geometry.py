"""The generator's own geometry against closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.families.gear import GearNumbers, flank_point
from benchmarks.families.rack import Tool, space_half_angle
from benchmarks.families.section import section

PINION = GearNumbers(12, 6.35, 15.0)
WHEEL = GearNumbers(24, 6.35, 15.0)


def test_a_flanks_normal_touches_the_base_circle():
    roll = np.linspace(3.0, PINION.tip_roll, 50)
    for tooth, side in ((0, 1), (5, -1)):
        k, s = np.full(50, float(tooth)), np.full(50, float(side))
        xy, normal = flank_point(PINION, k, s, roll, np.zeros(50))
        h = 1e-4
        tangent = (
            flank_point(PINION, k, s, roll + h, np.zeros(50))[0] - flank_point(PINION, k, s, roll - h, np.zeros(50))[0]
        ) / (2 * h)
        # central differences: h²/6 times a third derivative of about 1/rb² is 1e-12, rounding 2e-16 · 44 / h is 1e-10
        assert np.abs((tangent * normal).sum(axis=1)).max() < 1e-9
        foot = xy - roll[:, None] * normal
        assert np.hypot(*foot.T) == pytest.approx(np.full(50, PINION.base_radius), abs=1e-12)
        assert np.abs((foot * normal).sum(axis=1)).max() < 1e-12
        # the arc of an involute is L² / 2 rb
        assert np.hypot(*tangent.T) == pytest.approx(roll / PINION.base_radius, rel=1e-8)


def test_an_offset_point_lies_on_the_involute_turned_by_offset_over_base_radius():
    roll, off = np.array([9.0, 15.0]), np.array([0.3, -0.7])
    xy, _ = flank_point(PINION, np.zeros(2), np.ones(2), roll, off)
    expected = PINION.half_angle(roll + off) + off / PINION.base_radius
    assert np.arctan2(xy[:, 1], xy[:, 0]) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize(("gear", "k", "span"), [(PINION, 2, 29.186274), (WHEEL, 3, 48.999531)])
def test_published_span(gear, k, span):
    assert gear.base_radius * (2.0 * gear.base_half_angle + (k - 1) * gear.pitch_angle) == pytest.approx(span, abs=5e-7)


def test_arc_between_the_flanks_at_the_reference_circle():
    gear = GearNumbers(17, 3.0, 10.0, profile_shift=0.2, thinning=0.05)
    roll = np.full(2, gear.reference_roll)
    xy, _ = flank_point(gear, np.zeros(2), np.array([1.0, -1.0]), roll, np.zeros(2))
    angle = np.arctan2(xy[:, 1], xy[:, 0])
    assert np.hypot(*xy.T) == pytest.approx(np.full(2, gear.reference_radius), abs=1e-12)
    expected = 3.0 * (math.pi / 2 + 0.4 * math.tan(math.radians(20.0))) - 0.05
    assert gear.reference_radius * (angle[0] - angle[1]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_the_envelope_of_the_straight_flank_is_the_involute(shift):
    gear = GearNumbers(20, 4.0, 10.0, profile_shift=shift, thinning=0.06)
    radii = np.linspace(gear.reference_radius - 0.5 * gear.module, gear.tip_radius, 60)  # across the pitch circle
    angle = math.pi / gear.teeth - space_half_angle(gear, (Tool(),), radii)
    exact = gear.half_angle(np.sqrt(radii**2 - gear.base_radius**2))
    assert np.abs(angle - exact).max() * gear.tip_radius < 1e-9


@pytest.mark.parametrize(
    ("gear", "tip", "form"),
    [
        (PINION, 0.25, 35.93260), *(pytest.param(PINION, *one, marks=pytest.mark.long) for one in ((0.30, 35.91383), (0.38, 35.88608))),
        (WHEEL, 0.25, 71.84792), *(pytest.param(WHEEL, *one, marks=pytest.mark.long) for one in ((0.30, 71.90072), (0.38, 71.99591))),
    ],
)  # fmt: skip
def test_published_form_radii(gear, tip, form):
    # published to 1e-5 mm; a root that touches its flank (z = 24) parts from it as 0.1 … 0.3 Δr² / mm: by `SAME` after 3e-5 mm
    assert section(gear, (Tool(1.25, tip),)).form_radius == pytest.approx(form, abs=1.5e-5 if gear is PINION else 4e-5)


def test_published_angle_of_the_undercut_corner():
    (angle,) = space_half_angle(PINION, (Tool(1.25, 0.25),), np.array([35.932602]))
    assert angle == pytest.approx(0.11620200, abs=1e-7)


def test_published_waist():
    sec = section(PINION, (Tool(1.25, 0.25),))
    radius = np.linspace(32.0, 35.0, 3001)
    half = sec.half_angle(radius)
    width = 2.0 * radius * np.sin(half)
    assert width.min() == pytest.approx(9.59, abs=0.005)
    assert (radius * np.cos(half))[width.argmin()] == pytest.approx(33.33, abs=0.25) or radius[width.argmin()] == pytest.approx(
        33.33, abs=0.02
    )


def test_published_area_of_a_section():
    assert section(PINION, (Tool(1.25, 0.30),)).area() == pytest.approx(4408.899, abs=2e-3)


def test_full_fillet_leaves_no_flat_bottom_and_protuberance_cuts_under_the_flank():
    gear = GearNumbers(20, 4.0, 16.0)
    full = section(gear, (Tool(1.25, math.inf),))
    x, y = Tool(1.25, math.inf).outline(gear)
    assert x[y <= y.min() + 1e-12].max() < 1e-9
    assert full.root_angle[59] == pytest.approx(math.pi / 20, abs=1e-4)  # the bottom land ends in the middle of the space
    stock = 0.1
    plain = Tool(1.4, 0.38, stock=stock)
    below = space_half_angle(gear, (Tool(1.4, 0.38, stock=stock, protuberance=0.14),), np.array([36.6]))
    assert below > space_half_angle(gear, (plain,), np.array([36.6]))


def test_stock_is_the_distance_of_the_pregenerated_flank():
    gear = GearNumbers(20, 4.0, 16.0)
    radii = np.array([39.0, 41.0])
    thin, thick = (space_half_angle(gear, (Tool(1.3, 0.3, stock=q),), radii) for q in (0.0, 0.1))
    assert (thin - thick) * gear.base_radius == pytest.approx([0.1, 0.1], abs=1e-9)


def test_a_root_that_leaves_no_involute_is_refused():
    with pytest.raises(ValueError, match="no tool reaches"):
        section(GearNumbers(20, 4.0, 16.0), (Tool(1.25, 0.3, stock=0.1),))


def test_root_normals_point_into_the_space():
    sec = section(PINION, (Tool(1.25, 0.30),))
    length = np.linspace(0.02, 0.98, 40) * sec.root_length[-1]
    rho, angle, radial, around = sec.root_at(length)
    e, t = np.stack([np.cos(angle), np.sin(angle)]), np.stack([-np.sin(angle), np.cos(angle)])
    for step, inside in ((1e-3, False), (-1e-3, True)):
        moved = rho * e + step * (radial * e + around * t)
        limit = sec.half_angle(np.hypot(*moved))
        assert ((np.arctan2(moved[1], moved[0]) < limit) == inside).all()


@pytest.mark.parametrize(
    ("teeth", "shift", "thinning"),
    [
        (22, 0.2, 0.1), (79, 0.0, 0.08),
        *(pytest.param(*one, marks=pytest.mark.long) for one in ((27, 0.2, 0.1), (36, 0.2, 0.0), (40, 0.3, 0.0))),
    ],
)  # fmt: skip
def test_form_circle_is_where_the_end_of_the_racks_straight_flank_touches(teeth, shift, thinning):
    """Closed form where nothing is undercut: L = L_ref − h / sin α, h the depth of that end below the pitch line (Colbourne)."""
    gear = GearNumbers(teeth, 5.0, 10.0, profile_shift=shift, thinning=thinning)
    depth = (1.25 - 0.38 * (1.0 - math.sin(gear.alpha)) - shift) * 5.0
    expected = math.hypot(gear.base_radius, gear.reference_roll - depth / math.sin(gear.alpha))
    assert section(gear, (Tool(1.25, 0.38),)).form_radius == pytest.approx(expected, abs=4e-5)
