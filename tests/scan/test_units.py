"""A scan in the wrong unit is named; a part of a gear, and another gear, are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.scan import Scan, check_size
from gearwear.scan.units import UNITS, extents
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
    with pytest.raises(InputError, match=rf"worn\.ply: measures .* tip diameter 88\.9 mm.*--units {true} "):
        check_size(scan, pinion)


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
    with pytest.raises(InputError, match="--units in "):
        check_size(scan_of(stretched / 25.4), wide)


def test_extents_do_not_depend_on_pose_or_strays() -> None:
    whole = make_scan(Recipe(pose="none", noise_um=0.0).of_size(20_000), seed=3).points
    wild = np.vstack([whole, [[500.0, 0, 0], [0, 900.0, 3]]])
    np.testing.assert_allclose(extents(scan_of(wild))[[0, 2]], [88.9, 15.0], rtol=0.02)
