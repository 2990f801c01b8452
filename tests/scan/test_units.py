"""A scan in the wrong unit is named; a part of a gear, and another gear, are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.scan import Scan, check_size
from gearwear.scan.units import UNITS, extents, other_unit
from tests.synthetic import Recipe, Views, make_scan


def scan_of(points: np.ndarray, units: str = "mm", kind: str = "cloud") -> Scan:
    return Scan(points, None, None, kind, ("worn.ply",), {}, np.zeros(len(points), np.int8), units)  # type: ignore[arg-type]


WHOLE = make_scan(Recipe(pose="any", outliers=0.0005).of_size(20_000), seed=3).points
NO_ENDS = make_scan(Recipe(pose="any", ends="none").of_size(20_000), seed=4).points
VIEW = make_scan(Recipe(pose="mild", views=Views(4)).of_size(40_000), seed=5).views[1]
FLAT = make_scan(Recipe(pose="none").of_size(20_000), seed=6).points
SECTION = FLAT[np.abs(FLAT[:, 2] - 7.5) < 0.5] * [1.0, 1.0, 0.0]
TOOTH = FLAT[(FLAT[:, 0] > 33.0) & (np.abs(FLAT[:, 1]) < 9.0)]
PATCH = TOOTH[(TOOTH[:, 1] > 0) & (TOOTH[:, 2] > 5.0) & (TOOTH[:, 2] < 10.0)]

PARTS = {"whole": WHOLE, "no end faces": NO_ENDS, "one view": VIEW, "section": SECTION}


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("said", ["mm", "cm", "m", "um", "in"])
@pytest.mark.parametrize("true", ["mm", "cm", "m", "um", "in"])
def test_the_right_unit_is_named_and_no_other(pinion: Gear, part: str, said: str, true: str) -> None:
    kind = "section" if part == "section" else "cloud"
    scan = scan_of(PARTS[part] * UNITS[said] / UNITS[true], said, kind)
    if said == true:
        check_size(scan, pinion)
        return
    with pytest.raises(InputError, match=rf"worn\.ply: measures .* tip diameter 88\.9 mm.*units = {true} "):
        check_size(scan, pinion)


def test_a_unit_by_its_other_name_is_the_same(pinion: Gear) -> None:
    check_size(scan_of(WHOLE, "inch"), pinion)


@pytest.mark.parametrize("piece", ["half", "tooth", "patch of a flank", "half a section"])
def test_a_part_of_the_gear_is_not_refused(pinion: Gear, piece: str) -> None:
    points = {"half": WHOLE[WHOLE[:, 0] > np.median(WHOLE[:, 0])], "tooth": TOOTH, "patch of a flank": PATCH}
    points["half a section"] = SECTION[SECTION[:, 0] > 0]
    kind = "section" if "section" in piece else "cloud"
    assert len(points[piece]) > 30
    check_size(scan_of(points[piece], kind=kind), pinion)


@pytest.mark.parametrize("scale", [0.3, 0.5, 2.0, 3.0, 5.0])
def test_another_gear_is_left_to_others(pinion: Gear, scale: float) -> None:
    check_size(scan_of(WHOLE * scale), pinion)


def test_a_wide_pinion_is_judged_by_its_length(pinion: Gear) -> None:
    wide = Gear.from_spec(replace(pinion.spec, face_width=200.0))
    stretched = FLAT * [1.0, 1.0, 200.0 / 15.0]
    check_size(scan_of(stretched), wide)
    with pytest.raises(InputError, match="units = in "):
        check_size(scan_of(stretched / 25.4), wide)


def test_extents_do_not_depend_on_pose_or_strays() -> None:
    whole = make_scan(Recipe(pose="none", noise_um=0.0).of_size(20_000), seed=3).points
    wild = np.vstack([whole, [[500.0, 0, 0], [0, 900.0, 3]]])
    np.testing.assert_allclose(extents(scan_of(wild))[[0, 2]], [88.9, 15.0], rtol=0.02)


GEAR_SIZE = np.array([88.9, 88.9, 15.0])
"""Tip diameter twice and face width of the fixture, mm."""


@pytest.mark.parametrize(
    ("said", "kind", "share", "named"),
    [
        # a table with the gear on it may be of any size up to six gears, whatever another unit would make of it
        ("in", "cloud", (1.9, 1.9, 0.4), ""), ("in", "cloud", (3.0, 0.1, 0.1), ""), ("in", "cloud", (5.9, 0.1, 0.1), ""),
        # impossible for any part of the gear: more than that, and another unit brings it to 0.2 … 1.2
        ("in", "cloud", (6.1, 0.1, 0.1), "mm"), ("in", "cloud", (30.4, 0.1, 0.1), "mm"), ("cm", "cloud", (6.1, 0.1, 0.1), "mm"),
        # or less than a hundredth
        ("mm", "cloud", (0.0098, 0.0098, 0.0001), "in"), ("mm", "cloud", (0.0102, 0.0102, 0.0001), ""),
        # of several units the one that comes nearest to the gear
        ("m", "cloud", (40.0, 1.0, 1.0), "in"),
        # possible for a part, but in another unit the whole gear or a view of it
        ("mm", "cloud", (0.74 / 25.4,) * 3, ""), ("mm", "cloud", (0.76 / 25.4,) * 3, "in"),
        ("mm", "cloud", (1.09 / 25.4,) * 3, "in"), ("mm", "cloud", (1.11 / 25.4,) * 3, ""),
        ("mm", "cloud", (0.8 / 25.4, 0.1 / 25.4, 0.8 / 25.4), "in"), ("mm", "cloud", (0.8 / 25.4, 0.8 / 25.4, 0.74 / 25.4), ""),
        ("mm", "section", (0.89 / 25.4, 0.89 / 25.4, 0.0), ""), ("mm", "section", (0.91 / 25.4, 0.91 / 25.4, 0.0), "in"),
        ("mm", "section", (0.91 / 25.4, 0.89 / 25.4, 0.0), ""),
    ],
)  # fmt: skip
def test_the_limits_are_those_that_are_told(pinion: Gear, monkeypatch, said, kind, share, named) -> None:
    """The sizes of the docstring, from just inside and just outside; and the message tells the share of the gear in the unit it names."""
    monkeypatch.setattr("gearwear.scan.units.extents", lambda scan: GEAR_SIZE * share)
    scan = scan_of(WHOLE, said, kind)
    if not named:
        check_size(scan, pinion)
        return
    would = share[0] * UNITS[named] / UNITS[said]
    with pytest.raises(InputError, match=rf"units = {named} it would be {would:.2f} of the gear"):
        check_size(scan, pinion)


@pytest.mark.parametrize("true", ["cm", "m", "in"])
def test_a_piece_of_the_gear_in_another_unit_is_refused_with_that_unit(pinion: Gear, true: str) -> None:
    """A tooth or two are as small as any part: no size refuses them, and what then refuses them says the unit."""
    piece = FLAT[np.abs(np.arctan2(FLAT[:, 1], FLAT[:, 0])) < 0.5]
    assert other_unit(scan_of(piece), pinion) == ""
    assert f"units = {true} " in other_unit(scan_of(piece / UNITS[true]), pinion)
