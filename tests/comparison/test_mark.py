"""Tooth 1 by a keyway or a punch mark of a scanned gear: a known turn put in and asked back, and nothing else changed by it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.before import unworn_gear
from gearwear.comparison.closing import measure
from gearwear.comparison.measured_gear import register
from gearwear.comparison.stations import compare
from gearwear.design import parse_design
from gearwear.errors import InputError
from tests.scan.writers import ply
from tests.synthetic import PINION, Patch, Recipe, Rigid, make_scan, rotation_about
from tests.synthetic.marks import Keyway, Punch

GEAR = {"teeth": 12, "module": 6.35, "face_width": 15.0, "rack_tip_radius": 0.3, "bore_diameter": 30.0}
PITCH = math.tau / 12
KEYED = {"mark": {"width_mm": 6.0}}
PUNCHED = {"mark": {"width_mm": 3.0, "radius_mm": [21.0, 27.0], "z_mm": [13.2, 14.8]}}
WORN = (Patch(5, 1, 200.0, (37.0, 44.0), (3.0, 12.0)),)
RECIPE = replace(Recipe(replace(PINION, bore_diameter=30.0), noise_um=6.0, jitter=1.0), pose="none", outliers=0.002).of_size(
    25_000
)


def designed(datum: dict | None = None):
    return parse_design({"gear": GEAR} | ({} if datum is None else {"datum": datum}))


def laid(turn: float, over: bool) -> Rigid:
    """The gear turned on the table, upside down or not."""
    upside = np.diag([1.0, -1.0, -1.0]) if over else np.eye(3)
    return Rigid(rotation_about(np.array([0.0, 0.0, turn])) @ upside, np.array([3.0, -2.0, 15.0 if over else 0.5]))


def marked(mark, pose: Rigid, seed: int = 1, wear=WORN) -> np.ndarray:
    """A worn gear with a mark, as it lies on the table, mm; `WORN` is on tooth 6, counted from 1."""
    points = make_scan(replace(RECIPE, wear=wear), seed).points
    return pose.apply(mark.cut(points, 15.0, 0.006, np.random.default_rng(seed)))


def worn_flanks(measured) -> list[list[int]]:
    """0-based teeth and sides that are low."""
    low = measured.first.grid.flank_shape(measured.first.points.deviation) < -0.1
    return np.argwhere(low.any(axis=(2, 3))).tolist()


@pytest.mark.parametrize(
    ("tooth", "turn"), [pytest.param(0, 0.3, marks=pytest.mark.long), pytest.param(4, 2.2, marks=pytest.mark.long), (9, -1.0)]
)
def test_the_tooth_at_the_keyway_is_tooth_1_however_the_gear_lies(tooth, turn):
    measured = register(designed(KEYED), as_scan(marked(Keyway(tooth * PITCH + 0.05), laid(turn, False))))
    assert worn_flanks(measured) == [[(5 - tooth) % 12, 0]]
    assert abs(measured.mark.off - 0.05) < 3.0 * measured.mark.std
    assert measured.mark.sentence in measured.notes and "does not tell which end is up" in measured.mark.sentence


@pytest.mark.long
@pytest.mark.parametrize("over", [False, True])
def test_a_punch_mark_gives_the_same_numbers_upside_down(over):
    """Upside down a keyway leaves left and right to how the gear lay; a mark on one end does not."""
    punched = register(designed(PUNCHED), as_scan(marked(Punch(2 * PITCH), laid(0.7, over))))
    assert worn_flanks(punched) == [[3, 0]] and punched.mark.end_told
    keyed = register(designed(KEYED), as_scan(marked(Keyway(2 * PITCH), laid(0.7, over))))
    assert worn_flanks(keyed) == [[9, 1] if over else [3, 0]] and not keyed.mark.end_told


@pytest.mark.long
def test_only_the_numbers_change(tmp_path):
    file = tmp_path / "scan.ply"
    file.write_bytes(ply(marked(Keyway(4 * PITCH), laid(0.1, False)), kind="f8"))
    plain, keyed = (compare(designed(datum), [file], inspection=False) for datum in (None, KEYED))
    assert [region.tooth for region in plain.wear.regions] == [5] and [region.tooth for region in keyed.wear.regions] == [1]
    # Of the pose no more is left to chance than the last step of its fit, a millionth of a module.
    assert keyed.wear.volume == pytest.approx(plain.wear.volume, rel=1e-5)
    assert keyed.wear.volume_std == pytest.approx(plain.wear.volume_std, rel=1e-3)
    assert [effect.name for effect in keyed.effects] == [effect.name for effect in plain.effects]


def test_a_scan_without_the_mark_is_refused_with_its_name(tmp_path):
    file = tmp_path / "unmarked.ply"
    file.write_bytes(ply(make_scan(RECIPE, 3).points, kind="f8"))
    with pytest.raises(InputError, match=r"unmarked\.ply: \[datum\] mark: none is seen"):
        measure(designed(KEYED), [file], loop=False)


@pytest.mark.long
@pytest.mark.parametrize(
    ("mark", "datum", "over", "flipped"),
    [
        (Keyway(2 * PITCH), KEYED, False, None),  # the keyway tells the tooth, nothing the end
        (Keyway(2.2 * PITCH), KEYED, True, True),  # a fifth of a pitch off: on the other side of its tooth, upside down
        (Punch(2 * PITCH), PUNCHED, True, False),  # numbered alike by itself
    ],
)
def test_the_scan_before_wear_is_numbered_by_the_same_mark(tmp_path, mark, datum, over, flipped):
    """Nothing but the mark tells the teeth: the gear is perfect, and no flank of it differs from another."""
    file = tmp_path / "new.ply"
    file.write_bytes(ply(marked(mark, laid(2.6, over), 2, ()), kind="f8"))
    design = designed(datum)
    after = register(design, as_scan(marked(mark, laid(-0.4, False))))
    unworn, same = unworn_gear(design, after, [file], "mm", loop=False)
    assert same.sure == (flipped is not None) and same.told_by[0] == "the mark"
    # The mark itself is in one place of the design in both.
    where = [
        gear.pose.apply(laid(turn, up).apply(_point_of(mark))) for gear, turn, up in ((after, -0.4, False), (unworn, 2.6, over))
    ]
    if flipped is not None:
        assert same.flipped == flipped
        np.testing.assert_allclose(*where, atol=0.03)
    else:
        assert same.probability == pytest.approx(0.5, abs=0.3)  # its place off the middle, and patterns of noise
    stated = designed({**datum, "before_tooth_1_deg": 10.0})
    assert unworn_gear(stated, after, [file], "mm", loop=False)[1].stated


def _point_of(mark) -> np.ndarray:
    """A point on its middle, on the gear itself."""
    away = mark.radius if isinstance(mark, Punch) else 17.0
    return np.array([[away * math.cos(mark.angle), away * math.sin(mark.angle), 15.0]])
