"""Helical, double helical and internal gears are named with hand and angle, and no spur gear is."""

import json
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.design import parse_design
from gearwear.errors import InputError
from gearwear.identify.candidates import find_candidates
from gearwear.identify.survey import Survey, survey
from gearwear.scan.reading import read_one
from tests.identify.twisted import Twisted, scan
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.helical import Helical
from tests.synthetic.helical import scan as helical_scan
from tests.synthetic.ring import Ring, ring_scan

KINDS = {
    "right hand": Twisted(helix=20.0),
    "left hand, few teeth": Twisted(teeth=12, helix=-15.0, shift=0.2),
    "narrow, little": Twisted(helix=2.5, width=6.0),
    "steep": Twisted(teeth=31, helix=-40.0),
    "herringbone": Twisted(helix=20.0, double=True, width=30.0),
    "groove, halves staggered": Twisted(helix=-30.0, double=True, width=30.0, groove=5.0, stagger=0.5),
    "ring": Twisted(teeth=48, internal=True),
    "ring without end faces": Twisted(teeth=60, internal=True, faces=False),
    "ring in its rim": Twisted(teeth=48, internal=True, rim=True),
    "helical ring": Twisted(teeth=72, internal=True, helix=-20.0, faces=False),
}


def is_as_made(seen: Survey, gear: Twisted) -> None:
    """Kind, count and tip circle; hands and angle within five of its own standard deviations and 0.01°."""
    assert (seen.teeth, seen.internal, seen.helical) == (gear.teeth, gear.internal, gear.helix != 0.0)
    # Points of a fifth of the sample on the tips, the axis some 0.1 mrad off.
    assert seen.tip_radius == pytest.approx(gear.tip, abs=0.04 if gear.groove else 0.01)
    if not gear.helix:
        return
    signs = sorted([1.0, -1.0] if gear.double else [1.0])
    found = sorted(half.base_helix_angle / math.radians(gear.base_helix) for half in seen.halves)
    std = max(half.base_helix_std for half in seen.halves) / math.radians(abs(gear.base_helix))
    np.testing.assert_allclose(found, signs, rtol=0, atol=5.0 * std + 0.01 / abs(gear.base_helix))


@cache
def seen_in(name: str) -> Survey:
    return survey(scan(KINDS[name]))


LONG = (
    "steep",
    "ring",
    "left hand, few teeth",
    "narrow, little",
    "groove, halves staggered",
    "ring in its rim",
    "ring without end faces",
)
"""Of which another kind shows the same in less time."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.long] * (name in LONG)) for name in KINDS])
def test_kind_hand_and_angle_are_those_put_in(name):
    is_as_made(seen_in(name), KINDS[name])


@pytest.mark.long
@pytest.mark.parametrize("gear", [Twisted(), Twisted(faces=False), Twisted(teeth=60, shift=0.4), Twisted(helix=0.8)])
def test_a_spur_gear_is_no_other_kind(gear):
    seen = survey(scan(gear))
    assert (seen.teeth, seen.helical, seen.internal) == (gear.teeth, False, False)


@pytest.mark.long
def test_the_uncertainty_of_the_angle_is_its_scatter_from_scan_to_scan():
    gear = Twisted(helix=15.0)
    found = [survey(scan(gear, 20_000, noise=0.02, seed=seed)).flank for seed in range(6)]
    miss = np.array([(one.base_helix_angle - math.radians(gear.base_helix)) / one.base_helix_std for one in found])
    # χ² of 6 values: 0.5 % quantile 0.68, 99.5 % quantile 18.5.
    assert 0.6 < float((miss**2).sum()) < 19.0


RINGS = {
    "spur, few teeth": Ring(teeth=30, module=4.0, shift=0.0, rim=72.0, fillet_radius=0.8),
    "left hand, thin teeth": Ring(teeth=72, module=1.0, helix=-25.0, shift=-0.2, rim=45.0, width=10.0, fillet_radius=0.3),
}


@pytest.mark.long
@pytest.mark.parametrize("name", RINGS)
def test_a_ring_is_proposed_as_drawn(name):
    gear = RINGS[name]
    found = find_candidates(ring_scan(gear, 25_000, seed=3).points).ranked[0]
    spec = found.gear.spec
    assert spec.internal and (spec.teeth, spec.normal_module) == (gear.teeth, gear.module)
    assert math.degrees(spec.helix_angle) == pytest.approx(gear.helix, abs=1e-6)
    assert math.degrees(spec.normal_pressure_angle) == pytest.approx(gear.pressure)
    assert (spec.profile_shift, spec.addendum, spec.dedendum) == pytest.approx((gear.shift, gear.addendum, gear.dedendum))
    assert (spec.face_width, spec.rim_diameter, spec.thinning) == pytest.approx((gear.width, 2.0 * gear.rim, 0.0))
    assert (found.gear.tip_radius, found.gear.root_radius) == pytest.approx((gear.tip, gear.root), abs=1e-9)
    assert not found.gear.root_stated  # a scan does not tell the cutter


@pytest.mark.long
def test_the_rest_of_a_ring_that_part_is_seen_of_is_still_a_ring():
    gear = Ring(teeth=60, module=2.0, helix=-12.0, shift=0.0, rim=70.0, fillet_radius=0.5)
    cloud = ring_scan(gear, 40_000, noise=0.02, seed=4)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    half = np.mod(np.arctan2(points[:, 1], points[:, 0]), 2.0 * math.pi) < math.pi
    seen = survey(cloud.points[half])
    assert (seen.teeth, seen.internal) == (60, True)
    assert (2.0 * seen.tip_radius, 2.0 * seen.root_radius) == pytest.approx((2.0 * gear.tip, 2.0 * gear.root), abs=0.03)
    assert seen.thickness == pytest.approx(2.0 * seen.flank.middle * ring_half(gear, seen.flank.middle), abs=0.02)
    assert any("of the 60 teeth were seen" in note for note in seen.notes)


def ring_half(gear: Ring, radius: float) -> float:
    """Half angle of a ring's tooth."""
    return float(gear.flank_half(np.array([math.sqrt(radius**2 - gear.base**2)]))[0])


@pytest.mark.long
@pytest.mark.parametrize(
    ("gear", "upside_down"),
    [
        (Double(Helical(teeth=30, module=2.0, helix=-25.0, width=12.0, shift=0.2), gap=4.0), False),
        (Double(Helical(teeth=45, module=1.5, helix=12.0, width=15.0, shift=0.0), gap=3.0), True),
    ],
    ids=["left below", "right above"],
)
def test_a_double_helical_gear_is_proposed_as_drawn(gear, upside_down):
    half = gear.lower
    found = find_candidates(double_scan(gear, 30_000, seed=5, upside_down=upside_down).points).ranked[0]
    spec = found.gear.spec
    assert (spec.teeth, spec.normal_module, spec.internal) == (half.teeth, half.module, False)
    # Which half is at z = 0 is how the scan lies; the hand of the halves goes with it.
    assert math.degrees(abs(spec.helix_angle)) == pytest.approx(abs(half.helix), abs=1e-6)
    assert (spec.profile_shift, spec.face_width, spec.thinning) == pytest.approx((half.shift, gear.width, 0.0))
    assert spec.gap == pytest.approx(gear.gap, abs=0.15)  # flanks alone show where a half ends: its inner face is hardly seen
    assert found.registration is not None and found.scatter < 1.2 * 0.006


@pytest.mark.parametrize("gear", [Helical(teeth=23, module=2.5, helix=-25.0, width=18.0, shift=0.2)], ids=["left"])
def test_a_helical_gear_is_proposed_with_its_hand_and_angle(gear):
    found = find_candidates(helical_scan(gear, 25_000, seed=8).points).ranked[0]
    spec = found.gear.spec
    assert (spec.teeth, spec.normal_module) == (gear.teeth, gear.module)
    assert math.degrees(spec.helix_angle) == pytest.approx(gear.helix, abs=1e-6)
    assert math.degrees(spec.normal_pressure_angle) == pytest.approx(20.0)
    assert (spec.profile_shift, spec.face_width, spec.rack_tip_radius) == pytest.approx((gear.shift, gear.width, gear.tip_radius))
    assert found.proposal.thinning == 0.0
    assert f"helix {abs(gear.helix):g}° {'right' if gear.helix > 0 else 'left'} hand" in found.proposal.name


def test_the_angle_in_words_allows_for_a_profile_slope():
    """8 µm over the flank look like another base circle, and tan β_b = twist · r_b goes with it, beyond what the teeth scatter by."""
    seen = seen_in("right hand")
    sloped = replace(seen.flank, base_radius=seen.flank.base_radius * (1.0 - 0.008 / seen.flank.roll))
    words = replace(seen, flank=sloped, halves=(sloped,)).what
    angle, doubt = map(float, re.findall(r"([\d.]+)°", words.split("(")[-1]))
    off = abs(angle - KINDS["right hand"].base_helix)
    assert 2.0 * math.degrees(sloped.base_helix_std) < off < doubt < 4.0 * off


def test_the_words_name_hand_and_angle():
    assert "an internal helical gear of 72 teeth" in seen_in("helical ring").what
    words = seen_in("herringbone").what
    assert "a double helical gear of 23 teeth" in words and "right hand" in words and "left hand" in words


ANGLES = (2.5, 25.0)


@pytest.mark.long
@pytest.mark.parametrize(
    "gear",
    [*(Twisted(helix=angle) for angle in ANGLES), Twisted(helix=5.0, double=True), Twisted(teeth=48, internal=True)],
    ids=[*(f"{angle}°" for angle in ANGLES), "double", "ring"],
)
def test_compare_refuses_them_and_says_what_they_are(gear, tmp_path):
    slope = math.cos(math.radians(gear.helix))
    design = {
        "teeth": gear.teeth, "module": gear.module / slope, "pressure_angle": math.degrees(gear.transverse), "face_width": gear.width,
        "addendum": 0.9 * slope, "dedendum": 1.25 * slope,
    }  # fmt: skip
    file = tmp_path / "scan.xyz"
    np.savetxt(file, scan(gear))
    with pytest.raises(InputError) as error:
        gw.compare(parse_design({"gear": design}), file)
    kind = "an internal gear" if gear.internal else "a double helical gear" if gear.double else "a helical gear"
    assert f"by itself the scan looks like {kind} of {gear.teeth} teeth" in str(error.value)


def test_every_second_tooth_counted_is_not_a_tooth():
    # 14 teeth whose third harmonic is as strong as their first were once taken for 42.
    assert survey(scan(Twisted(teeth=14, module=5.56, width=15.0), 60_000, noise=0.01)).teeth == 14


@pytest.mark.shared
@pytest.mark.parametrize(
    "name",
    [
        "open_l25_helix_slope",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("open_r15_coated", "open_ring_turntable")),
    ],
)
def test_practice_scans_of_other_gears(shared, name):
    truth = json.loads((shared / "scans" / "helical" / f"{name}.truth.json").read_text(encoding="utf-8"))
    gear, effects = truth["gear"], truth["effects"]
    found = read_one(shared / "scans" / "helical" / f"{name}.ply")
    seen = survey(found.points, found.normals)
    assert (seen.teeth, seen.internal) == (gear["teeth"], gear["internal"])
    beta = math.radians(gear["helix_angle_deg"])
    base = math.asin(math.sin(beta) * math.cos(math.radians(gear["normal_pressure_angle_deg"])))
    # A helix slope turns the flanks too, along the transverse base tangent: its amount is known, its sense is the maker's.
    slope = sum(one["slope_um"] for one in effects if one["name"] == "helix_slope") * 1e-3 / gear["face_width"]
    off = abs(math.tan(seen.flank.base_helix_angle) - math.tan(base))
    assert off == pytest.approx(slope, abs=1e-4)


@pytest.mark.shared
@pytest.mark.parametrize(
    "name",
    [
        *(
            pytest.param(f"scans/{name}.ply", marks=pytest.mark.long)
            for name in ("open_tooth_b", "open_views_3", "hard/c07_both_sides", "hard/b13_density")
        ),
        "scans/hard/c04_broken_corner.ply",
        "real/dental/kw_199.xyz",
    ],
)
def test_worn_broken_and_real_spur_gears_are_spur_gears(shared, name):
    found = read_one(shared / name)
    seen = survey(found.points, found.normals)
    assert (seen.helical, seen.internal) == (False, False)
    assert seen.teeth == {"open": 12, "c04_": 20, "c07_": 20, "b13_": 20, "kw_1": 13}[name.split("/")[-1][:4]]


@pytest.mark.shared
@pytest.mark.parametrize(
    ("name", "teeth", "base_radius", "every"),
    [
        *(pytest.param(name, 13, 1.71045, 1, marks=pytest.mark.long) for name in ("kw_015", "kw_002")),
        *(pytest.param(name, 19, 2.49971, 1, marks=pytest.mark.long) for name in ("z19_05", "z19_60")),
        ("z19_60", 19, 2.49971, 6),  # of some 30,000 points
    ],
)
def test_small_real_gears_are_proposed_as_drawn(shared, name, teeth, base_radius, every):
    read = read_one(shared / "real" / "dental" / f"{name}.xyz")
    found = find_candidates(read.points[::every])
    assert (found.survey.teeth, found.survey.helical, found.survey.internal) == (teeth, False, False)
    best = next(one for one in found.ranked[:2] if one.proposal.module.mm == 0.28)
    assert math.degrees(best.proposal.pressure_angle) == pytest.approx(20.0)
    assert best.proposal.profile_shift == pytest.approx(0.4, abs=2.0 * best.proposal.shift_std)
    assert best.gear.base_radius == pytest.approx(base_radius, rel=1e-3)
