"""The section area against Green's theorem on the outline, and against another volume by thickness."""

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from tests.design.gears import SPREAD

EACH = pytest.mark.parametrize("gear", SPREAD.values(), ids=SPREAD.keys())
POINTS = 100001


def outline_area(gear: Gear) -> float:
    """½ ∮ (x dy − y dx) round half a tooth from its centre line to the space's, times 2 z; arcs exact, curves by chords.

    The involute is drawn from its string, the trochoid from the rack; nothing is shared with `Gear.section_area`.
    """
    rb = gear.base_radius
    roll = np.linspace(gear.form_roll, gear.tip_roll, POINTS)
    string = rb * np.exp(1j * (gear.base_half_angle - roll / rb)) * (1.0 + 1j * roll / rb)
    phi = np.linspace(0.0, gear.fillet_end, POINTS)
    radius, angle = gear.rack.polar(phi)
    fillet = radius * np.exp(1j * (0.5 * gear.pitch_angle - angle))
    tip_angle = np.angle(string[-1])
    chamfered = gear.spec.tip_chamfer > 0.0
    land_angle = tip_angle - gear.spec.tip_chamfer_on_land / gear.tip_radius if chamfered else tip_angle
    corner = gear.tip_radius * np.exp(1j * land_angle)
    curve = np.concatenate([[corner], string[::-1], fillet[::-1]])
    swept = 0.5 * np.sum((curve[:-1].conj() * curve[1:]).imag)
    arcs = 0.5 * gear.tip_radius**2 * land_angle
    arcs += 0.5 * gear.root_radius**2 * (0.5 * gear.pitch_angle - np.angle(fillet[0]))
    return 2.0 * gear.teeth * float(swept + arcs) - math.pi * (0.5 * gear.spec.bore_diameter) ** 2


@EACH
def test_section_area_by_greens_theorem(gear):
    # Chords of h on a curve of curvature κ miss h³ κ / 12 each: (1e-5)² of the curves' own share.
    assert gear.section_area() == pytest.approx(outline_area(gear), rel=1e-10)


@pytest.mark.parametrize("legs", [(0.8, None), (0.3, 0.2), (0.3, 0.5), (1.5, None)], ids=str)
def test_section_area_with_a_chamfer_of_two_legs(legs):
    """While a land is left: chamfers of 0.8 and 1.5 mm leave 0.71 and 0.02 mm of it, as the tooth is wider where they begin."""
    gear = Gear.from_spec(GearSpec("gear", 20, 2.0, 10.0, tip_chamfer=legs[0], tip_chamfer_land=legs[1]))
    assert gear.section_area() == pytest.approx(outline_area(gear), rel=1e-10)


@pytest.mark.parametrize("chamfer", [0.1, 0.4])
def test_section_area_with_a_tip_chamfer_and_a_bore(chamfer):
    spec = GearSpec("gear", 20, 2.0, 10.0, tip_chamfer=chamfer, bore_diameter=12.0)
    gear = Gear.from_spec(spec)
    assert gear.section_area() == pytest.approx(outline_area(gear), rel=1e-10)
    plain = Gear.from_spec(GearSpec("gear", 20, 2.0, 10.0)).section_area()
    # Each corner loses a triangle: c high, and c less the flank's own lean c tan α_a wide; to first order in c / r_a.
    cut = plain - gear.section_area() - math.pi * 36.0
    lean = math.tan(math.acos(gear.base_radius / gear.tip_radius))
    assert cut == pytest.approx(40 * 0.5 * chamfer**2 * (1.0 - lean), rel=2 * chamfer / gear.transverse_module)


@EACH
def test_thickness_integrates_to_the_teeth(gear):
    """∫ s(r) dr from root to tip, and the disc below: the same area once more, by the public thickness."""
    # r = r_f + h u² takes out the square root at the root circle; Simpson's rule on either side of the form circle
    total = math.pi * gear.root_radius**2
    for low, high in ((gear.root_radius, gear.form_radius), (gear.form_radius, gear.tip_radius)):
        u, weights = np.polynomial.legendre.leggauss(60)
        u = 0.5 * (u + 1.0)
        radius = low + (high - low) * u * u
        # the form circle itself belongs to the involute; the integrand's end there is open
        total += gear.teeth * float(np.dot(0.5 * weights * 2.0 * u * (high - low), gear.thickness(radius)))
    assert gear.section_area() == pytest.approx(total, rel=1e-7)


def test_sections_of_thinned_gears_differ_by_the_thinning():
    """A side cut t of the rack turns each flank by t/2r: the tooth loses t r ∫… at every radius, exactly on the involute part."""
    plain, thin = (Gear.from_spec(GearSpec("gear", 30, 2.0, 10.0, thinning=t)) for t in (0.0, 0.1))
    radius = np.linspace(plain.form_radius + 0.1, plain.tip_radius, 50)
    np.testing.assert_allclose(plain.thickness(radius) - thin.thickness(radius), 0.1 * radius / 30.0, rtol=1e-11)
    assert thin.root_radius == plain.root_radius


@pytest.mark.parametrize("depth", [0.01, 0.3, 1.5])
def test_volume_of_a_worn_layer(pinion, depth):
    """Metal between an involute and a worn flank with feathered edges, three ways: polygon, ∫ d/r_b r dr and its foot-point form."""
    rb = pinion.base_radius
    foot = np.linspace(8.0, 20.0, 200001)  # roll length of the feet, mm
    share = np.sin(math.pi * (foot - 8.0) / 12.0) ** 2
    d = depth * share
    flank = np.exp(1j * (pinion.base_half_angle - foot / rb)) * (rb + 1j * foot)
    worn = flank - 1j * d * np.exp(1j * (pinion.base_half_angle - foot / rb))
    ring = np.concatenate([flank, worn[::-1]])
    polygon = abs(0.5 * np.sum((ring.conj() * np.roll(ring, -1)).imag))

    radius = np.abs(worn)
    by_radius = np.trapezoid(d / rb * radius, radius)
    by_foot = np.trapezoid((d * foot - 0.5 * d**2) / rb, foot)
    plain = np.trapezoid(d * foot / rb, foot)
    # trapezoids and chords of 6e-5 mm: 1e-9 of the whole
    assert by_radius == pytest.approx(polygon, rel=1e-8)
    assert by_foot == pytest.approx(polygon, rel=1e-8)
    assert plain / polygon - 1.0 == pytest.approx(np.trapezoid(0.5 * d**2, foot) / np.trapezoid(d * foot, foot), rel=0.1)
