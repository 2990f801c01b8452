"""A ring's scan from points to worn solid: spur and helical, effects named alone, and gears of the other kind refused."""

from __future__ import annotations

import math
from contextlib import nullcontext
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.stations import compare
from gearwear.design import Gear, GearSpec
from gearwear.design.modification import FlankModification
from gearwear.design.pair import Design
from gearwear.errors import InputError
from gearwear.placing.cells import CellGrid
from gearwear.wear.profiles import ProfileNodes, worn_profiles
from gearwear.wear.solid import gear_triangles, nominal_like, worn_bodies
from tests.diagnose.plain import plain_effects
from tests.synthetic.helical import Helical, scan
from tests.synthetic.ring import Ring, ring_scan
from tests.synthetic.test_ring import designed
from tests.synthetic.tooth import Patch
from tests.wear.sections import section_thickness

SPUR, HELICAL = Ring(), Ring(helix=-20.0)
WEAR = Patch(4, 1, 0.25, (17.6, 22.4), (1.0, 13.0))


def register(ring: Ring, cloud, fillet: bool = True):
    return gw.register(Design({"gear": designed(ring, fillet)}), gw.as_scan(cloud.points))


@cache
def compared(ring: Ring, coat: float):
    patch = replace(WEAR, roll=(ring.touch[0] - 13.5, ring.touch[0] - 0.7))
    cloud = ring_scan(ring, 60_000, seed=5, wear=(patch,), coat=coat)
    with plain_effects() if ring is HELICAL else nullcontext():  # of one all effects are searched
        measured = gw.find_effects(register(ring, cloud))
    return measured, gw.find_wear(measured), patch


@pytest.mark.parametrize(("ring", "coat"), [pytest.param(SPUR, 0.0, marks=pytest.mark.long), (HELICAL, 0.014)])
def test_volume_and_effect_come_out(ring, coat):
    measured, wear, patch = compared(ring, coat)
    assert [effect.name for effect in measured.loop.effects] == ["coating"] * (coat > 0.0)
    for effect in measured.loop.effects:
        estimate = effect.parameters["thickness_um"]
        assert estimate.value == pytest.approx(1e3 * coat, abs=2.0 * estimate.std)
        assert effect.alternatives == ()
    (region,) = wear.regions
    assert (region.tooth, region.side) == (patch.tooth, patch.side)
    assert region.volume == pytest.approx(ring.volume(patch), abs=2.0 * region.volume_std)
    assert region.volume == pytest.approx(ring.volume(patch), rel=0.02)
    assert region.max_depth == pytest.approx(patch.depth, abs=0.02)


@pytest.mark.parametrize("ring", [pytest.param(SPUR, marks=pytest.mark.long), HELICAL])
def test_teeth_are_as_thick_as_drawn_but_for_the_wear(ring):
    measured, _, patch = compared(ring, 0.0 if ring is SPUR else 0.014)
    found = section_thickness(measured.flanks, measured.gear, measured.noise)
    sound = np.delete(found.arc, patch.tooth, axis=0)
    assert np.nanmedian(sound) == pytest.approx(measured.gear.tooth_thickness, abs=1e-3)
    # Over the face, as sections are pooled where points are few; which leaves the outermost out.
    inner = (found.z > 2.0) & (found.z < ring.width - 2.0)
    lost = float(np.nanmean(measured.gear.tooth_thickness - found.arc[patch.tooth, inner]))
    reference = math.sqrt(ring.reference**2 - ring.base**2)
    depth = patch.at(np.full(inner.sum(), reference), found.z[inner]).mean()
    assert lost == pytest.approx(depth * ring.reference / (ring.base * ring.base_cos), rel=0.05)


def test_a_root_that_nobody_stated_is_no_datum_and_is_said():
    measured = register(SPUR, ring_scan(SPUR, 30_000, seed=2), fillet=False)
    assert measured.root.free
    assert not {"fillets", "roots"} & set(measured.placed.registration.datum.surfaces)
    assert "cutter_teeth" in measured.root.words()


@pytest.mark.long
def test_wear_is_found_whatever_is_assumed_of_the_root():
    """A side is not taken for worn throughout by the places next to a root that nobody stated."""
    ring = Ring(teeth=48, module=1.5, width=10.0, helix=-20.0, shift=0.0, addendum=0.75, fillet_radius=0.3, rim=47.0)
    patch = Patch(3, 1, 0.08, (10.5, 14.5), (2.0, 8.0))
    measured = gw.find_effects(register(ring, ring_scan(ring, 60_000, noise=0.005, seed=2, wear=(patch,)), fillet=False))
    (region,) = gw.find_wear(measured).regions
    assert not measured.worn_sides
    assert (region.tooth, region.side) == (patch.tooth, patch.side)
    assert region.volume == pytest.approx(ring.volume(patch), abs=3.0 * region.volume_std)


@pytest.mark.long
def test_radii_that_read_too_large_are_named_on_a_ring():
    """Tips lie further out, so deeper; flanks nearer together: the pattern of a scanner's radial offset, of the other sign as on a gear."""
    measured = gw.find_effects(register(SPUR, ring_scan(SPUR, 30_000, seed=7, radial=0.03)))
    (effect,) = measured.loop.effects
    assert "axis_offset_radial" in (effect.name, *effect.alternatives)
    if effect.name == "axis_offset_radial":
        estimate = next(iter(effect.parameters.values()))
        assert estimate.value == pytest.approx(30.0, abs=3.0 * estimate.std)


def test_a_gear_is_refused_on_a_ring_and_a_ring_on_a_gear():
    ring = designed(SPUR)
    external = Gear.from_spec(GearSpec("gear", 42, 2.5, 14.0, profile_shift=-0.1))
    with pytest.raises(InputError, match=r"not of this gear|does not fit the design"):
        gw.register(Design({"gear": external}), gw.as_scan(ring_scan(SPUR, 20_000, seed=2).points))
    gear = scan(Helical(teeth=42, module=2.5, helix=0.0, width=14.0, shift=-0.1), 20_000, seed=2)
    with pytest.raises(InputError, match=r"not of this gear|does not fit the design"):
        gw.register(Design({"gear": ring}), gw.as_scan(gear.points))


@pytest.mark.long
@pytest.mark.parametrize("ring", [SPUR, HELICAL])
def test_solids_are_closed_as_far_as_the_rim_and_hold_what_was_taken_off(ring):
    gear = designed(ring)
    grid = CellGrid.for_scan(gear, 30_000)
    depth = np.zeros((gear.teeth, 2, grid.rows, grid.fillet + grid.flank))
    depth[3, 0, :, grid.fillet :] = 0.1
    worn = worn_profiles(ProfileNodes.of(grid), depth)
    whole, left = gear_triangles(nominal_like(worn)), gear_triangles(worn)
    assert whole.volume == pytest.approx(gear.volume, rel=0.02)  # chords of roots and rim
    (body,) = worn_bodies(whole, left)
    assert left.volume + body.volume == pytest.approx(whole.volume, rel=1e-7)
    turn = 0.1 / (gear.base_radius * gear.base_helix_cosine)
    assert body.volume == pytest.approx(0.5 * turn * (gear.form_radius**2 - gear.tip_radius**2) * ring.width, rel=5e-3)
    for surface in (whole, left):  # closed: every edge once each way
        a, b = surface.faces, np.roll(surface.faces, -1, axis=1)
        edges = set(zip(a.ravel().tolist(), b.ravel().tolist(), strict=True))
        assert len(edges) == surface.faces.size and all((q, p) in edges for p, q in edges)


@pytest.mark.long
def test_what_the_drawing_takes_off_a_ring_s_flanks_is_no_effect():
    """Crowned flanks with a relieved tip: nothing is named on the modified design, on the plain one what was taken off."""
    crowning, relief, length = 0.015, 0.03, 3.0
    low = math.sqrt(SPUR.tip**2 - SPUR.base**2)

    def off(side, roll, z):
        zeta = z / SPUR.width - 0.5
        return -relief * np.maximum(1.0 - (roll - low) / length, 0.0) - crowning * 4.0 * zeta**2

    cloud = ring_scan(SPUR, 30_000, seed=3, added=off)
    plain = designed(SPUR)
    drawn = FlankModification(tip_relief=relief, tip_relief_length=length, helix_crowning=crowning)
    measured = {
        name: gw.find_effects(gw.register(Design({"gear": gear}), gw.as_scan(cloud.points)))
        for name, gear in (("drawn", Gear.from_spec(replace(plain.spec, left=drawn, right=drawn))), ("plain", plain))
    }
    assert [effect.name for effect in measured["drawn"].loop.effects] == []
    found = {effect.name: effect for effect in measured["plain"].loop.effects}
    assert {"tip_relief", "helix_crowning"} <= set(found)
    bulge = found["helix_crowning"].parameters["crowning_um"]
    assert abs(bulge.value - 1e3 * crowning) < 3.0 * bulge.std + 0.02 * 1e3 * crowning


def test_a_ring_without_its_outside_is_refused_before_its_scan_is_read(tmp_path):
    drawn = Design({"gear": Gear.from_spec(replace(designed(SPUR).spec, rim_diameter=0.0))}, source="ring.toml")
    with pytest.raises(InputError, match=r"ring.toml: \[gear\] rim_diameter is missing: the ring's outside in mm"):
        compare(drawn, [tmp_path / "no such scan.ply"])
