"""A double helical scan from points to worn solid: which way up it lies is told by its hands, effects are named alone, wear lies on its half."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.pair import Design
from gearwear.errors import InputError
from gearwear.fleet.quantities import quantities
from gearwear.placing.cells import CellGrid
from gearwear.wear.profiles import ProfileNodes, worn_profiles
from gearwear.wear.solid import gear_triangles, nominal_like, worn_bodies
from tests.synthetic.double_helical import Double, WornHalf, double_scan
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_double_helical import designed
from tests.synthetic.tooth import Patch

GEAR = Double()
WEAR = (WornHalf(True, Patch(4, 1, 0.25, (4.0, 15.0), (0.5, 10.5))), WornHalf(False, Patch(9, 1, 0.18, (4.0, 15.0), (1.0, 10.5))))
COAT = 0.014


@cache
def compared(upside_down: bool):
    cloud = double_scan(GEAR, 60_000, seed=5, wear=WEAR, coat=COAT, upside_down=upside_down)
    measured = gw.find_effects(gw.register(Design({"gear": designed(GEAR)}), gw.as_scan(cloud.points)))
    return measured, gw.find_wear(measured), cloud


@pytest.mark.parametrize("upside_down", [False, True])
@pytest.mark.long
def test_coat_and_volumes_come_out_however_it_lies(upside_down):
    measured, wear, _ = compared(upside_down)
    (found,) = measured.loop.effects
    assert (found.name, found.alternatives) == ("coating", ())
    estimate = found.parameters["thickness_um"]
    assert estimate.value == pytest.approx(1e3 * COAT, abs=2.0 * estimate.std)
    assert measured.placed.registration.observed.all()
    truth = sorted((GEAR.lower.volume(one.patch) for one in WEAR), reverse=True)
    assert [region.volume for region in wear.regions] == [
        pytest.approx(one, abs=2.0 * region.volume_std) for one, region in zip(truth, wear.regions, strict=True)
    ]
    assert wear.volume == pytest.approx(sum(truth), rel=0.02)
    upper, lower = wear.regions
    assert upper.centroid[2] > GEAR.width - GEAR.lower.width and lower.centroid[2] < GEAR.lower.width


@pytest.mark.long
def test_the_pose_is_known_in_all_six_ways_without_end_faces():
    cloud = double_scan(GEAR, 20_000, seed=3, faces=False)
    registration = gw.register(Design({"gear": designed(GEAR)}), gw.as_scan(cloud.points)).placed.registration
    assert registration.observed.all()
    assert not any("end face" in note for note in registration.notes)
    rotation = registration.pose.rotation @ cloud.rotation
    moved = registration.pose.rotation @ cloud.translation + registration.pose.translation
    std = np.sqrt(np.diag(registration.covariance))
    assert abs(moved[2]) < 3.0 * std[2]
    turn = math.remainder(math.atan2(rotation[1, 0], rotation[0, 0]), 2.0 * math.pi / GEAR.lower.teeth)
    assert abs(turn) < 3.0 * std[5]


@pytest.mark.long
def test_hands_in_the_other_order_are_the_same_gear_and_one_helix_is_refused_by_name():
    mirrored = Double(lower=GEAR.upper)
    cloud = double_scan(mirrored, 20_000, seed=3)
    # Turned end over end its hands change places.
    assert gw.register(Design({"gear": designed(GEAR)}), gw.as_scan(cloud.points)).placed.registration.fitting > 0.85
    single = scan(Helical(teeth=17, helix=24.0, width=GEAR.width), 20_000, seed=3)
    with pytest.raises(InputError, match=r"not of this gear|does not fit the design"):
        gw.register(Design({"gear": designed(GEAR)}), gw.as_scan(single.points))


def test_solids_have_a_groove_and_hold_what_was_taken_off():
    gear = designed(GEAR)
    grid = CellGrid.for_scan(gear, 60_000)
    assert grid.toothed.sum() == grid.rows - grid.groove_rows and grid.groove_rows > 0
    assert np.diff(grid.z_edges).sum() == pytest.approx(gear.face_width)
    depth = np.zeros((gear.teeth, 2, grid.rows, grid.fillet + grid.flank))
    (_, _), (high, _) = grid.zones
    depth[3, 0, high, grid.fillet :] = 0.1
    worn = worn_profiles(ProfileNodes.of(grid), depth)
    whole, left = gear_triangles(nominal_like(worn)), gear_triangles(worn)
    assert whole.volume == pytest.approx(gear.volume, rel=3e-3)  # chords of the fillets and of the groove
    (body,) = worn_bodies(whole, left)
    assert left.volume + body.volume == pytest.approx(whole.volume, rel=1e-7)
    assert body.vertices[:, 2].min() == pytest.approx(GEAR.width - GEAR.lower.width)
    # A layer of 0.1 mm along the normal turns the flank by 0.1 / (r_b cos β_b): ½ (r_a² − r_f²) of that over the half; and its ledge.
    turn = 0.1 / (gear.base_radius * gear.base_helix_cosine)
    assert body.volume == pytest.approx(0.5 * turn * (gear.tip_radius**2 - gear.form_radius**2) * GEAR.lower.width, rel=5e-3)
    for surface in (whole, left):  # closed: every edge once each way
        a, b = surface.faces, np.roll(surface.faces, -1, axis=1)
        edges = set(zip(a.ravel().tolist(), b.ravel().tolist(), strict=True))
        assert len(edges) == surface.faces.size and all((q, p) in edges for p, q in edges)


@pytest.mark.long
def test_a_comparison_inspects_both_halves(tmp_path):
    cloud = double_scan(GEAR, 40_000, seed=5, wear=WEAR[:1], coat=COAT)
    points = tmp_path / "double.xyz"
    np.savetxt(points, cloud.points)
    results = gw.compare(Design({"gear": designed(GEAR)}), points)
    assert results.inspection is None
    assert [one.gear.spec.hand for one in results.halves] == ["right", "left"]
    # The worn flank, tooth 5 left, is in the upper half alone.
    total = [np.nan_to_num(one.profile.total.value) for one in results.halves]
    assert total[1][4, 0] > 0.1 > 2.0 * total[0].max()
    for one in results.halves:
        # The coat is taken out. In thin scans teeth have an error in common, that of their mean form: the middle is as sure as one of them.
        thickness = one.dimensions.thickness
        expanded = float(np.nanmedian(thickness.expanded))
        assert np.nanmedian(thickness.value) == pytest.approx(one.gear.tooth_thickness, abs=expanded) and expanded < 0.007
    record = gw.as_dict(results)
    assert set(record["inspection_halves"]) == {"lower", "upper"} and record["inspection"] is None
    assert {"lower_half_profile_slope_um", "upper_half_tooth_thickness_mm"} <= {row.name for row in quantities(record)}
