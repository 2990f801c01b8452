"""Spur pairs of unequal face width: mid-faces at one height, contact on the common face, what the overhang is makes no difference."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.worn_pair import beside_mate
from gearwear.design.modification import FlankModification
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.spec import GearSpec, PairSpec
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.linear import linear_contact
from gearwear.meshing.slices import FaceParts, common_face, facing_mate
from gearwear.placing.cells import CellGrid
from gearwear.report.write import contact_share

LOSS = 0.05
EXACT = 2e-7
"""mm; the lesser of two places of a flank that touch together may be found (`ToothPairs.contact`): 0.04 µm here."""
LOAD = gw.LoadSpec(load_per_width=150.0)
TEETH = {"pinion": 17, "gear": 18}
ROLES = ("pinion", "gear")
ONE_ROLE = [pytest.param("pinion", marks=pytest.mark.long), "gear"]
"""The other goes through the same lines, and `test_an_overhang_that_nothing_wore_does_not_carry` through both."""


@pytest.fixture(autouse=True)
def few_positions(monkeypatch):
    """All here is alike from position to position, or compared position by position."""
    monkeypatch.setattr("gearwear.meshing.study.POSITIONS", 3)


def pair(pinion: float, gear: float, beta: float = 0.0, drawn: dict[str, FlankModification] = {}) -> Design:  # noqa: B006
    """z 17 / 18, m 3, as wide as said, mm; helix angle in degrees; modifications by part."""
    gears = {}
    for part, width, hand in (("pinion", pinion, 1), ("gear", gear, -1)):
        flank = drawn.get(part, FlankModification())
        gears[part] = gw.Gear.from_spec(
            GearSpec(
                part, TEETH[part], 3.0, width, helix_angle=hand * math.radians(beta), bore_diameter=20.0, left=flank, right=flank
            )
        )
    return Design(gears, PairSpec(None))


def wide(part: str, by: float = 20.0, other: float = 14.0) -> Design:
    return pair(by, other) if part == "pinion" else pair(other, by)


def worn(gear: gw.Gear, z: np.ndarray, lost: np.ndarray) -> ToothProfiles:
    """As much off all left flanks, mm: per row, or of each tooth (teeth, rows)."""
    new = nominal_profiles(gear, np.linspace(gear.root_radius, gear.tip_radius, 60), z)
    half_angle = new.half_angle.copy()
    half_angle[:, 0] -= np.broadcast_to(lost, (gear.teeth, len(z)))[..., None] / gear.base_radius
    return replace(new, half_angle=half_angle)


def where_they_meet(gear: gw.Gear, rows: int = 21) -> ToothProfiles:
    """50 µm off the left flanks from z = 3 to 17 mm of a face of 20, nothing beside it."""
    z = np.linspace(0.0, 20.0, rows)
    between = np.concatenate([z[:1], 0.5 * (z[1:] + z[:-1]), z[-1:]])  # what a row of cells has of it is a mean
    share = np.clip(np.minimum(between[1:], 17.0) - np.maximum(between[:-1], 3.0), 0.0, None) / np.diff(between)
    return worn(gear, z, LOSS * share)


def as_scanned(design: Design, part: str) -> SimpleNamespace:
    """What of a comparison says which gear was scanned."""
    gear = design.gears[part]
    return SimpleNamespace(part=part, gear=gear, cells=SimpleNamespace(grid=CellGrid.for_scan(gear, 20_000, size=2.0)))


@pytest.mark.parametrize("rows", [21, 15])
@pytest.mark.parametrize("part", ROLES)
def test_an_overhang_that_nothing_wore_does_not_carry(part, rows):
    """Wherever the rows of a scan lie: one that is half on the overhang does not stand for the common face."""
    design = wide(part)
    flanks = where_they_meet(design.gears[part], rows)
    found = gw.study_meshing(design, flanks)
    assert found.contact.transmission_error == pytest.approx(-LOSS, abs=EXACT)
    assert found.least_backlash.normal == pytest.approx(LOSS, abs=EXACT)
    compared = mesh_contact(*beside_mate(design, as_scanned(design, part))(flanks), design.centre_distance, cycle="pitch")
    assert compared.transmission_error == pytest.approx(-LOSS, abs=EXACT)
    assert compared.backlash == pytest.approx(LOSS, abs=EXACT)


@pytest.mark.long
@pytest.mark.parametrize("part", ONE_ROLE)
def test_under_load_such_a_pair_carries_all_over_the_common_face(part):
    design = wide(part)
    flanks = gw.study_meshing(design, where_they_meet(design.gears[part])).flanks
    found = gw.study_load(design, flanks, LOAD, cycle="pitch").present
    by_slice = found.force.sum(axis=1) / found.widths
    np.testing.assert_allclose(by_slice, np.broadcast_to(by_slice[:, :1], by_slice.shape), rtol=1e-6)


def uneven(gear: gw.Gear, z: np.ndarray, seed: int) -> ToothProfiles:
    """Up to 50 µm off the left flanks, otherwise in each row, and on both sides of the common face of 14 mm nothing."""
    lost = LOSS * np.random.default_rng(seed).random((gear.teeth, len(z)))
    return worn(gear, z, np.where(np.abs(z - 0.5 * gear.face_width) < 7.0, lost, 0.0))


def cut(profiles: ToothProfiles, gear: gw.Gear) -> ToothProfiles:
    """The rows on the common face, on a gear as wide as that."""
    off = 0.5 * (profiles.gear.face_width - gear.face_width)
    inside = (profiles.z > off) & (profiles.z < off + gear.face_width)
    return replace(profiles, gear=gear, z=profiles.z[inside] - off, half_angle=profiles.half_angle[:, :, inside])


@pytest.mark.long
@pytest.mark.parametrize("part", ONE_ROLE)
def test_a_wide_gear_does_what_the_same_one_cut_to_the_common_face_does(part):
    whole, narrow = wide(part), pair(14.0, 14.0)
    flanks = uneven(whole.gears[part], np.arange(20) + 0.5, 7)
    there, here = flanks, cut(flanks, narrow.gears[part])
    one, other = gw.study_meshing(whole, there), gw.study_meshing(narrow, here)
    np.testing.assert_allclose(one.contact.transmission_error, other.contact.transmission_error, atol=EXACT)
    np.testing.assert_allclose(one.contact.backlash, other.contact.backlash, atol=EXACT)
    assert one.contact.peak_to_peak_um > 1.0
    np.testing.assert_allclose(one.heights - 3.0, other.heights, atol=EXACT)  # on the measured gear, whichever drives
    loads = [
        gw.study_load(design, study.flanks, LOAD, cycle="pitch").present for design, study in ((whole, one), (narrow, other))
    ]
    np.testing.assert_allclose(loads[0].transmission_error, loads[1].transmission_error, atol=EXACT)
    np.testing.assert_allclose(loads[0].z - 0.5 * loads[0].driver.face_width, loads[1].z - 7.0, atol=EXACT)


@pytest.mark.long
def test_both_measured_with_a_wide_pinion():
    whole, narrow = pair(20.0, 14.0), pair(14.0, 14.0)
    pinion, gear = (uneven(whole.gears[part], z, seed) for part, z, seed in (("pinion", np.arange(20) + 0.5, 3), ("gear", np.arange(28) / 2 + 0.25, 4)))  # fmt: skip
    one = gw.study_meshing(whole, (pinion, gear))
    other = gw.study_meshing(narrow, (cut(pinion, narrow.gears["pinion"]), gear))
    np.testing.assert_allclose(one.contact.transmission_error, other.contact.transmission_error, atol=EXACT)
    np.testing.assert_allclose(one.contact.backlash, other.contact.backlash, atol=EXACT)


def test_the_linear_model_aligns_mid_faces_too():
    design = pair(20.0, 14.0)
    flanks = (where_they_meet(design.gears["pinion"]), nominal_profiles(design.gears["gear"]))
    inside = facing_mate(flanks[0], design.gears["gear"])
    assert linear_contact(inside, flanks[1], design.centre_distance).transmission_error == pytest.approx(-LOSS, abs=EXACT)


@pytest.mark.long
@pytest.mark.parametrize(
    "widths",
    [pytest.param((20.0, 40.0), marks=pytest.mark.long), pytest.param((40.0, 20.0), marks=pytest.mark.long), (20.0, 14.0)],
)
def test_crowned_gears_touch_at_mid_face_as_helical_ones_of_hardly_any_helix_do(widths):
    """As drawn, crowned by 20 µm: no crowning is lost where both are thickest, at mid-face."""
    crowned = FlankModification(helix_crowning=0.02)
    for beta in (0.0, 0.001):
        found = gw.study_meshing(pair(*widths, beta, dict.fromkeys(ROLES, crowned)))
        assert found.contact.transmission_error == pytest.approx(0.0, abs=EXACT)
        assert found.contact.backlash == pytest.approx(0.0, abs=EXACT)


@pytest.mark.parametrize("part", ROLES)
def test_a_slope_rises_as_far_as_the_common_face_goes(part):
    """20 µm over 20 mm, seven tenths of it on 14 mm: at either end half of that stands proud, on both flanks."""
    found = gw.study_meshing(wide_sloped(part), loss=LOSS, part=part)
    assert found.contact.transmission_error == pytest.approx(0.007 - LOSS, abs=EXACT)
    assert found.contact.backlash == pytest.approx(LOSS - 0.014, abs=EXACT)


def wide_sloped(part: str) -> Design:
    widths = (20.0, 14.0) if part == "pinion" else (14.0, 20.0)
    return pair(*widths, drawn={part: FlankModification(helix_slope=0.02)})


@pytest.mark.long
@pytest.mark.parametrize("sloped", ONE_ROLE)
def test_what_one_gear_has_modified_shows_whichever_has_the_loss(sloped):
    """A slope of 20 µm takes 10 at one end of each flank: both flanks together leave 20 less of what a loss of 50 leaves."""
    design = pair(20.0, 20.0, drawn={sloped: FlankModification(helix_slope=0.02)})
    for part in ROLES:
        assert gw.study_meshing(design, loss=LOSS, part=part).contact.backlash == pytest.approx(LOSS - 0.02, abs=EXACT)
    other = next(part for part in ROLES if part != sloped)
    one_row = worn(design.gears[other], np.array([10.0]), np.array([LOSS]))
    assert gw.study_meshing(design, one_row).contact.backlash == pytest.approx(LOSS - 0.02, abs=EXACT)


def test_heights_are_those_of_the_measured_gear():
    """One row of the wider gear stands proud, at its z = 12 mm: 9 mm on the pinion."""
    design = pair(14.0, 20.0)
    z = np.arange(21.0)
    found = gw.study_meshing(design, worn(design.gears["gear"], z, np.where(z == 12.0, 0.0, LOSS)))
    assert set(found.heights.tolist()) == {12.0} and set(found.contact.z.tolist()) == {9.0}
    np.testing.assert_allclose(found.contact.driven_pattern.z - found.contact.driver_pattern.z, 3.0, atol=EXACT)
    assert found.contact.transmission_error == pytest.approx(0.0, abs=EXACT)


@pytest.mark.parametrize("part", ROLES)
def test_the_picture_of_the_contact_is_empty_on_the_overhang(part):
    design = wide(part, 28.0)
    contact = gw.study_meshing(design, where_they_meet(design.gears[part])).contact
    share = contact_share(SimpleNamespace(contact=contact, drive_side=gw.Side.LEFT), part)[:, 0]
    rows = share.shape[1]
    touched = share.max(axis=(0, 2)) > 0.0
    even = 28.0 * ((np.arange(rows) + 0.5) / rows - 0.5)
    assert not touched[np.abs(even) > 7.0].any()
    assert touched.any()


def test_parts_of_the_common_face_lie_about_both_middles():
    design = pair(20.0, 14.0)
    parts = FaceParts.of(*design.gears.values(), 7)
    np.testing.assert_allclose(parts.z, np.arange(7) * 2.0 + 4.0, atol=1e-12)
    np.testing.assert_allclose(parts.mate_z, np.arange(7) * 2.0 + 1.0, atol=1e-12)
    np.testing.assert_allclose(parts.place, -parts.place[::-1], atol=1e-12)
    assert common_face(*design.gears.values()) == [(-7.0, 7.0)]
