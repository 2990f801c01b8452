"""Compliance of a tooth against finite elements of another mesh and element, published formulas, and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.loaded import tooth_compliance as room
from gearwear.loaded.formulas import beam_on_half_plane, beam_on_ring, torsion
from gearwear.loaded.outline_grid import Fineness, outline_grid
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import ToothCompliance, influence, tooth_compliance

STEEL = Material()
FINITE_ELEMENTS = {
    (12, 12.0): {36.39: 6.66, 39.98: 9.07, 43.28: 13.66},
    (24, 20.0): {72.47: 5.81, 76.88: 7.99, 81.04: 12.55},
    (40, 60.0): {122.3: 3.23, 131.7: 9.89},
}
"""E q of the whole gear by a program that shares nothing with this one (Q9, plane strain, bore held), by teeth, bore radius and radius."""
NEIGHBOUR = {12: 2.17, 24: 3.59, 40: 1.73}


def gear(teeth: int, **more: float) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, 6.35, 15.0, **more))


def rolls(body: Gear, radii: list[float]) -> np.ndarray:
    return np.sqrt(np.square(radii) - body.base_radius**2)


def whole(found: ToothCompliance, roll: np.ndarray) -> np.ndarray:
    return STEEL.elastic_modulus * (found.at(roll) + found.shared)


@pytest.fixture(scope="module")
def found() -> dict[int, ToothCompliance]:
    return {teeth: tooth_compliance(gear(teeth), STEEL, bore) for teeth, bore in FINITE_ELEMENTS}


@pytest.mark.parametrize(("teeth", "bore"), FINITE_ELEMENTS)
def test_it_is_that_of_other_finite_elements(found, teeth, bore):
    table = FINITE_ELEMENTS[teeth, bore]
    np.testing.assert_allclose(whole(found[teeth], rolls(gear(teeth), list(table))), list(table.values()), rtol=0.01)
    assert STEEL.elastic_modulus * found[teeth].shared == pytest.approx(NEIGHBOUR[teeth], rel=0.02)


def triangles(body: Gear, bore: float, roll: np.ndarray, fine: Fineness) -> np.ndarray:
    """The same deflection by six-node triangles on a finer grid, with a dense look at the centre line."""
    from scipy.sparse.linalg import spsolve
    from skfem import Basis, ElementTriP2, ElementVector, MeshQuad
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    radius = np.hypot(body.base_radius, roll)
    grid = outline_grid(body, bore, radius, fine, Fineness(2, 3, 2, 3, fine.body), neighbours=0)
    basis = Basis(MeshQuad(grid.nodes.T.copy(), grid.elements.T.copy()).to_meshtri(), ElementVector(ElementTriP2()))
    stiffness = linear_elasticity(*lame_parameters(STEEL.elastic_modulus, STEEL.poisson)).assemble(basis)
    free = np.flatnonzero(np.hypot(*basis.doflocs) > bore * 1.001)
    answer = []
    for length, node in zip(roll, grid.flank, strict=True):
        tilt = body.base_half_angle - length / body.base_radius
        push = np.array([math.sin(tilt), -math.cos(tilt)])
        force = np.zeros(stiffness.shape[0])
        force[basis.nodal_dofs[:, node]] = push
        moved = np.zeros_like(force)
        moved[free] = spsolve(stiffness[free][:, free].tocsc(), force[free])
        line = grid.centre_lines[0]
        # The force's line is tangent to the base circle, so it meets the centre line at r_b / cos τ.
        at = body.base_radius / math.cos(tilt)
        there = [np.interp(at, grid.nodes[line, 0], moved[dofs]) for dofs in basis.nodal_dofs[:, line]]
        answer.append(float(push @ there))
    return STEEL.elastic_modulus * np.array(answer)


@pytest.mark.long
@pytest.mark.parametrize(
    ("bore", "change"),
    [
        pytest.param(24.0, {}, marks=pytest.mark.long),
        (12.0, {"rack_tip_radius": 0.05, "dedendum": 1.4}),
        pytest.param(12.0, {"profile_shift": 0.5, "dedendum": 1.0}, marks=pytest.mark.long),
    ],
)
def test_roots_and_bores_count_as_by_triangles(bore, change):
    body = gear(15, **change)
    roll = np.linspace(body.form_roll + 2.0, body.tip_roll - 1.0, 3)
    found = tooth_compliance(body, STEEL, bore)
    np.testing.assert_allclose(whole(found, roll), triangles(body, bore, roll, Fineness(4, 13, 14, 17, 12)), rtol=0.01)


@pytest.mark.long
def test_another_root_or_bore_gives_another_compliance():
    """What a formula in z and x alone could not say: both gears have 15 teeth without shift."""
    plain, sharp = gear(15), gear(15, rack_tip_radius=0.05, dedendum=1.4)
    roll = np.linspace(sharp.form_roll + 2.0, plain.tip_roll - 1.0, 3)
    assert (whole(tooth_compliance(sharp, STEEL, 12.0), roll) > 1.04 * whole(tooth_compliance(plain, STEEL, 12.0), roll)).all()
    assert tooth_compliance(plain, STEEL, 8.0).shared > 1.5 * tooth_compliance(plain, STEEL, 24.0).shared


@pytest.mark.parametrize("teeth", [12, 24, 40])
def test_published_formulas_come_within_seven_per_cent(found, teeth):
    """Bending by Weber & Banaschek on the ring of Sainsot, Velex & Duverger, at five radii; another theory altogether."""
    body, bore = gear(teeth), next(bore for z, bore in FINITE_ELEMENTS if z == teeth)
    roll = np.linspace(body.form_roll + 1.0, body.tip_roll - 1.0, 5)
    ring = beam_on_ring(body, STEEL, roll, bore)
    np.testing.assert_allclose(whole(found[teeth], roll), STEEL.elastic_modulus * (ring.tooth + ring.shared), rtol=0.07)


def test_the_formulas_are_those_published():
    """Their own numbers by the other program: half plane without torsion, ring with it."""
    for teeth, bore, radii, half_plane, ring in (
        (12, 12.0, [36.39, 39.98, 43.28], [5.14, 7.51, 12.24], [6.94, 9.10, 13.50]),
        (24, 20.0, [72.47, 76.88, 81.04], [2.61, 4.87, 9.76], [5.75, 7.88, 12.49]),
    ):
        body = gear(teeth)
        roll = rolls(body, radii)
        np.testing.assert_allclose(
            STEEL.elastic_modulus * beam_on_half_plane(body, STEEL, roll, bore).tooth, half_plane, rtol=0.005
        )
        found = beam_on_ring(body, STEEL, roll, bore)
        np.testing.assert_allclose(STEEL.elastic_modulus * (found.tooth + found.shared), ring, rtol=0.005)
    assert STEEL.elastic_modulus * torsion(gear(12), STEEL, 12.0) == pytest.approx(1.55, abs=0.005)


def test_finer_elements_change_little():
    body = gear(12)
    coarse, fine = (
        tooth_compliance(body, STEEL, 12.0),
        tooth_compliance(body, STEEL, 12.0, Fineness(5, 16, 16, 22, 15), Fineness(1, 3, 2, 3, 15)),
    )
    np.testing.assert_allclose(coarse.tooth, fine.tooth, rtol=0.003)
    assert coarse.shared == pytest.approx(fine.shared, rel=0.003)


@pytest.mark.long
def test_what_teeth_share_is_the_torsion_of_the_body_and_a_little_more():
    """The rim between the teeth gives way too; the smaller the bore, the more the torsion of the disc, a closed form, is all of it."""
    body, more = gear(20), []
    for bore in (40.0, 20.0, 10.0):
        twist = torsion(body, STEEL, bore)
        more.append(tooth_compliance(body, STEEL, bore).shared / twist - 1.0)
    assert more == sorted(more, reverse=True) and 0.0 < more[-1] < 0.25


@pytest.mark.long
def test_it_goes_as_one_over_the_modulus_and_not_with_the_size():
    body, twice = gear(20), Gear.from_spec(GearSpec("gear", 20, 12.7, 30.0))
    found = tooth_compliance(body, STEEL, 20.0)
    soft = tooth_compliance(body, replace(STEEL, elastic_modulus=103_000.0), 20.0)
    large = tooth_compliance(twice, STEEL, 40.0)
    np.testing.assert_allclose(soft.tooth, 2.0 * found.tooth, rtol=1e-8)
    np.testing.assert_allclose(large.tooth, found.tooth, rtol=1e-6)
    np.testing.assert_allclose(large.roll, 2.0 * found.roll, rtol=1e-12)


def test_a_helical_tooth_is_that_of_its_virtual_spur_gear():
    """By plane strain square to the tooth, exact for a straight one: cos β / cos² β_b of the compliance of z / (cos² β_b cos β) teeth.

    F_t is cos β_b of the normal force, δ_t is δ_n / cos β_b, and the tooth is dz / cos β long. 40 teeth at 25° are like 52.4.
    """
    helical, spur = gear(40, helix_angle=math.radians(25.0)), gear(52)
    lean, heights, fine = helical.base_helix_cosine, np.array([-0.6, 0.0, 0.7]), Fineness(2, 6, 6, 10, 6)
    assert 40.0 / (lean**2 * math.cos(helical.helix_angle)) == pytest.approx(52.4, abs=0.05)
    teeth = []
    for body in (helical, spur):
        at = rolls(body, list(body.reference_radius + 6.35 * heights))
        loaded, neighbour = influence(body, STEEL, body.root_radius - 12.7, at, fine, Fineness(1, 2, 2, 2, 6))
        teeth.append(np.diag(loaded - neighbour))
    np.testing.assert_allclose(teeth[0], teeth[1] * math.cos(helical.helix_angle) / lean**2, rtol=0.008)


def test_the_smallest_helix_is_hardly_one():
    straight, leaning = (tooth_compliance(gear(20, helix_angle=angle), STEEL, 20.0) for angle in (0.0, 1e-5))
    np.testing.assert_allclose(leaning.tooth, straight.tooth, rtol=1e-8)
    assert leaning.shared == pytest.approx(straight.shared, rel=1e-8)


@pytest.mark.long
def test_a_helical_body_is_twisted_and_pushed_along_its_axis():
    """Both closed forms, of a disc and of a tube sheared along its axis; the smaller the bore, the more they are all of it."""
    body, more = gear(20, helix_angle=math.radians(-35.0)), []
    for bore in (20.0, 5.0):
        more.append(tooth_compliance(body, STEEL, bore).shared / torsion(body, STEEL, bore) - 1.0)
    assert more == sorted(more, reverse=True) and 0.0 < more[-1] < 0.02
    lean = math.tan(body.base_helix_angle)
    turned = body.base_radius**2 * (1.0 / 25.0 - 1.0 / body.root_radius**2) + 2.0 * lean**2 * math.log(body.root_radius / 5.0)
    shear = STEEL.elastic_modulus / 2.6
    assert torsion(body, STEEL, 5.0) == pytest.approx(turned / (4.0 * math.pi * shear), rel=1e-12)


@pytest.mark.parametrize("degrees", [pytest.param(15.0, marks=pytest.mark.long), 25.0])
def test_published_formulas_square_to_a_helical_tooth_of_24_teeth_come_within_four_per_cent(degrees):
    body = gear(24, helix_angle=math.radians(degrees))
    elements = tooth_compliance(body, STEEL, 20.0)
    roll = np.linspace(body.form_roll + 1.0, body.tip_roll - 1.0, 5)
    ring = beam_on_ring(body, STEEL, roll, 20.0)
    np.testing.assert_allclose(whole(elements, roll), STEEL.elastic_modulus * (ring.tooth + ring.shared), rtol=0.04)


def test_the_neighbour_gives_way_by_about_the_same_wherever_both_are_touched():
    body = gear(24)
    _, neighbour = influence(body, STEEL, 20.0, np.linspace(body.form_roll + 3.0, body.tip_roll - 2.0, 4))
    assert np.ptp(neighbour) < 0.1 * neighbour.mean()


def test_a_gear_without_a_bore_is_held_on_a_stated_share_of_its_root():
    body = gear(12)
    assert tooth_compliance(body, STEEL).bore_radius == pytest.approx(room.BORE_SHARE * body.root_radius)
    assert tooth_compliance(gear(12, bore_diameter=24.0), STEEL).bore_radius == 12.0
