"""The outline against closed forms, published numbers of the reference, and the rolling rack itself."""

import math

import numpy as np
import pytest

from tests.synthetic import PINION, WHEEL, GearNumbers, Outline, Surface

GEARS = [
    PINION,
    WHEEL,
    GearNumbers(rack_tip_radius=0.25, thinning=0.2),
    GearNumbers(teeth=30, module=2.0, profile_shift=0.4, rack_tip_radius=0.38),
]


def shoelace(points):
    x, y = points.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


@pytest.mark.parametrize(
    ("teeth", "tip_radius", "form"),
    [
        (12, 0.25, 35.93260),
        (12, 0.30, 35.91383),
        (12, 0.38, 35.88608),
        (24, 0.25, 71.84792),
        (24, 0.30, 71.90072),
        (24, 0.38, 71.99591),
    ],
)
def test_form_radius_is_the_references(teeth, tip_radius, form):
    outline = Outline.of(GearNumbers(teeth=teeth, rack_tip_radius=tip_radius))
    assert outline.form_radius == pytest.approx(form, abs=5e-6)
    assert outline.undercut == (teeth == 12)


def test_form_radius_of_the_quarter_module_rack():
    assert Outline.of(GearNumbers(rack_tip_radius=0.25)).form_radius == pytest.approx(35.932602, abs=5e-7)


def test_section_area_is_the_references():
    outline = Outline.of(PINION)
    tooth = outline.at(outline.equal_arcs(40_001)).position
    turned = []
    for k in range(12):
        c, s = math.cos(k * outline.pitch_angle), math.sin(k * outline.pitch_angle)
        turned.append(tooth @ np.array([[c, s], [-s, c]]))
    assert shoelace(np.concatenate(turned)) == pytest.approx(4408.899, abs=5e-4)


def test_span_over_two_teeth_is_the_references():
    outline = Outline.of(PINION)
    section = outline.at(outline.equal_arcs(40_001))
    flank = section.surface == Surface.FLANK
    half = 0.5 * outline.pitch_angle
    jaw = np.array([-math.sin(half), math.cos(half)])
    turn = np.array([[math.cos(2 * half), -math.sin(2 * half)], [math.sin(2 * half), math.cos(2 * half)]])
    upper = (section.position[flank & (section.side > 0)] @ turn.T @ jaw).max()
    lower = (section.position[flank & (section.side < 0)] @ jaw).min()
    assert upper - lower == pytest.approx(29.186274, abs=2e-6)


@pytest.mark.parametrize("numbers", GEARS)
def test_points_lie_at_equal_arcs_and_the_length_is_the_perimeter(numbers):
    outline = Outline.of(numbers)
    p = outline.at(outline.equal_arcs(20_001)).position
    chord = np.hypot(*np.diff(p, axis=0).T)
    step = outline.length / 20_001
    # each of four corners (tip edges, undercut) can be cut by half a step at most
    assert chord.sum() + step == pytest.approx(outline.length, abs=2.0 * step)
    corners = np.abs(chord / step - 1.0) > 1e-4
    assert corners.sum() <= 4


@pytest.mark.parametrize("numbers", GEARS)
def test_normals_are_unit_outward_and_across_the_outline(numbers):
    outline = Outline.of(numbers)
    arc = outline.equal_arcs(997)
    eps = 1e-5
    here, ahead, behind = (outline.at(a) for a in (arc, arc + eps, arc - eps))
    tangent = (ahead.position - behind.position) / (2.0 * eps)
    smooth = (ahead.surface == here.surface) & (behind.surface == here.surface)
    assert smooth.mean() > 0.98
    assert np.hypot(*here.normal.T) == pytest.approx(1.0, abs=1e-14)
    # X is read linearly between the table's nodes: (step / length)² of curvature
    assert np.abs((tangent * here.normal).sum(axis=1))[smooth].max() < 1e-5
    cross = here.normal[:, 0] * tangent[:, 1] - here.normal[:, 1] * tangent[:, 0]
    assert (cross[smooth] > 0.99).all()  # counter-clockwise with the metal on the left


@pytest.mark.parametrize("numbers", GEARS)
def test_the_rolling_rack_tip_touches_every_fillet_point_and_cuts_none(numbers):
    outline = Outline.of(numbers)
    x = outline.fillet_offset[:: len(outline.fillet_offset) // 23]
    points, _ = outline.fillet(x)
    r, m, alpha = outline.reference_radius, numbers.module, math.radians(numbers.pressure_angle_deg)
    rho = numbers.rack_tip_radius * m
    # the rack's tip-arc centre as drawn on ISO 53's rack: from the pitch line and from its tooth's middle
    height = (numbers.dedendum - numbers.profile_shift) * m - rho
    from_middle = (
        0.25 * math.pi * m - (numbers.dedendum * m - rho) * math.tan(alpha) - rho / math.cos(alpha) + 0.5 * numbers.thinning
    )
    roll = np.linspace(-0.9, 0.9, 40_001)
    angle = math.pi / numbers.teeth + roll  # of the pitch point, from the tooth's centre line
    along = -from_middle - r * roll  # of the centre from the pitch point, when the rack has rolled
    centre = np.column_stack(
        [
            (r - height) * np.cos(angle) - along * np.sin(angle),
            (r - height) * np.sin(angle) + along * np.cos(angle),
        ]
    )
    nearest = np.array([np.hypot(*(centre - p).T).min() for p in points])
    assert nearest == pytest.approx(rho, abs=2e-6)


def test_thinning_turns_the_whole_side_towards_the_middle():
    thick, thin = Outline.of(PINION), Outline.of(GearNumbers(thinning=0.3))
    radius = np.array([31.0, 33.0, 35.0, 38.1, 42.0])
    assert thick.half_angle(radius) - thin.half_angle(radius) == pytest.approx(0.15 / 38.1, rel=1e-6)
    assert thick.root_radius == thin.root_radius
