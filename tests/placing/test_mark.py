"""Tooth 1 by a mark: its direction and how sure it is, on points that nothing but a mark is made of."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design import parse_design
from gearwear.errors import InputError
from gearwear.placing.mark import SURE, number_by_mark
from tests.synthetic.marks import Keyway, Punch

TABLE = {"teeth": 24, "module": 3.0, "face_width": 20.0, "bore_diameter": 30.0}
PITCH = math.tau / 24


def designed(mark: dict, **gear):
    return parse_design({"gear": {**TABLE, **gear}, "datum": {"mark": mark}})


KEYED = designed({"width_mm": 6.0})
GEAR, MARK = KEYED.gears["gear"], KEYED.datum.mark
PUNCHED = designed({"width_mm": 3.0, "radius_mm": [21.0, 27.0], "z_mm": [18.0, 19.8]}).datum.mark


def hub(rng: np.random.Generator, strays: int = 0) -> np.ndarray:
    """Bore and end faces of the gear, and strays in and about it, mm."""
    turn, z = rng.uniform(-np.pi, np.pi, 4000), rng.uniform(0.0, 20.0, 4000)
    bore = np.column_stack([15.0 * np.cos(turn), 15.0 * np.sin(turn), z])
    turn, away = rng.uniform(-np.pi, np.pi, 8000), np.sqrt(rng.uniform(15.0**2, 34.0**2, 8000))
    faces = np.column_stack([away * np.cos(turn), away * np.sin(turn), np.where(rng.random(8000) < 0.5, 0.0, 20.0)])
    return np.concatenate([bore, faces, rng.uniform([-36, -36, -2], [36, 36, 22], (strays, 3))])


@pytest.mark.parametrize("teeth", [0, 7, 23])
@pytest.mark.parametrize("kind", [Keyway, Punch])
def test_a_mark_put_in_anywhere_is_found_where_it_is(kind, teeth):
    rng = np.random.default_rng(teeth)
    off = 0.1 * PITCH
    points = kind(teeth * PITCH + off).cut(hub(rng, 300), 20.0, 0.01, rng)
    motion, seen = number_by_mark(points, GEAR, MARK if kind is Keyway else PUNCHED)
    assert abs(seen.off - off) < 3.0 * seen.std < 0.5 * PITCH
    # The tooth at the mark goes to +x, whole teeth round, and stays in its plane.
    tooth = np.array([[math.cos(teeth * PITCH), math.sin(teeth * PITCH), 4.0]])
    np.testing.assert_allclose(motion.apply(tooth), [[1.0, 0.0, 4.0]], atol=1e-12)
    assert seen.chance > 0.99 and seen.end_told == (kind is Punch)


def test_a_mark_on_one_end_tells_which_is_up():
    rng = np.random.default_rng(1)
    points = Punch(5 * PITCH).cut(hub(rng), 20.0, 0.01, rng)
    over = points * [1.0, -1.0, -1.0] + [0.0, 0.0, 20.0]
    motion, seen = number_by_mark(over, GEAR, PUNCHED)
    assert seen.end_told
    # As it was before it was laid on its other end, but that the tooth at the mark is on +x now.
    there = math.tau * 5 / 24
    turn = np.array([[math.cos(there), math.sin(there), 0.0], [-math.sin(there), math.cos(there), 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(motion.apply(over), points @ turn.T, atol=1e-9)


def test_what_it_says_of_itself_is_how_far_off_it_is():
    """Keyways of which the scanner saw a part, at any place, with noise and strays: the truth lies within what is stated."""
    rng = np.random.default_rng(2)
    pulls, wrong, said, told = [], 0, 0.0, 0
    for _ in range(300):
        off, teeth = rng.uniform(-0.5, 0.5) * PITCH, int(rng.integers(24))
        hidden = rng.choice([0.0, rng.uniform(0.0, 0.7)])
        low = -0.5 + rng.choice([0.0, hidden, rng.uniform(0.0, hidden)])
        key = Keyway(teeth * PITCH + off, density=rng.choice([0.5, 3.0]), seen=(low, low + 1.0 - hidden))
        points = np.concatenate([key.points(20.0, rng), rng.uniform([-36, -36, -2], [36, 36, 22], (100, 3))])
        points += rng.normal(0.0, 0.02, points.shape)
        try:
            motion, seen = number_by_mark(points, GEAR, MARK)
        except InputError as refused:
            assert "the next tooth may be as near" in str(refused)
            continue
        turned = round(-math.atan2(motion.rotation[1, 0], motion.rotation[0, 0]) / PITCH) % 24
        pulls.append(((teeth - turned) * PITCH + off - seen.off + math.pi) % math.tau - math.pi)
        pulls[-1] /= seen.std
        wrong, said, told = wrong + (turned != teeth), said + 1.0 - seen.chance, told + 1
    assert told > 150
    assert np.mean(np.abs(pulls) < 2.0) > 0.9 and np.max(np.abs(pulls)) < 4.0
    assert wrong <= said + 3.0 * math.sqrt(said) and wrong <= (1.0 - SURE) * told


def test_a_mark_between_two_teeth_is_refused_until_the_design_says_so():
    rng = np.random.default_rng(3)
    points = Keyway(3.5 * PITCH).cut(hub(rng), 20.0, 0.01, rng)
    with pytest.raises(InputError, match=r"0\.\d+ ± 0\.\d+ pitches off .* angle_deg = -?7\.\d+ would be right"):
        number_by_mark(points, GEAR, MARK)
    motion, seen = number_by_mark(points, GEAR, replace(MARK, angle=0.5 * PITCH))
    assert abs(seen.off) < 3.0 * seen.std
    tooth = np.array([[math.cos(3 * PITCH), math.sin(3 * PITCH), 0.0]])
    np.testing.assert_allclose(motion.apply(tooth), [[1.0, 0.0, 0.0]], atol=1e-12)


def test_no_mark_several_and_a_ring_that_holds_the_bore_are_refused():
    rng = np.random.default_rng(4)
    with pytest.raises(InputError, match=r"none is seen: 0 points 15\.6 … 19\.2 mm off the axis, z 2 … 18 mm"):
        number_by_mark(hub(rng), GEAR, MARK)
    for strays, said in ((100, "of .* points .* no more than . lie together"), (1000, "points lie all round")):
        with pytest.raises(InputError, match=said):
            number_by_mark(hub(rng, strays), GEAR, MARK)
    two = Keyway(math.pi).cut(Keyway(0.3).cut(hub(rng), 20.0, 0.01, rng), 20.0, 0.01, rng)
    with pytest.raises(InputError, match="points lie at several places"):
        number_by_mark(two, GEAR, MARK)
    with pytest.raises(InputError, match="points lie all round"):
        number_by_mark(hub(rng), GEAR, replace(MARK, radius=(14.0, 17.0)))


def test_a_keyway_on_the_outside_of_a_ring_points_inwards():
    table = {"teeth": 40, "module": 3.0, "face_width": 20.0, "rim_diameter": 150.0, "internal": True}
    design = parse_design({"gear": table, "datum": {"mark": {"width_mm": 8.0}}})
    rng = np.random.default_rng(5)
    along, across = rng.uniform(72.0, 75.0, 500), rng.choice([-4.0, 4.0], 500)
    turn = 9 * math.tau / 40
    x, y = math.cos(turn) * along - math.sin(turn) * across, math.sin(turn) * along + math.cos(turn) * across
    points = np.column_stack([x, y, rng.uniform(0.0, 20.0, 500)])
    motion, seen = number_by_mark(points, design.gears["gear"], design.datum.mark)
    np.testing.assert_allclose(motion.apply(np.array([[math.cos(turn), math.sin(turn), 0.0]])), [[1.0, 0.0, 0.0]], atol=1e-12)
    assert abs(seen.off) < 3.0 * seen.std


@pytest.mark.parametrize(
    ("datum", "said"),
    [
        ({"mark": 3.0}, "a table, written"),
        ({"mark": {}}, "width_mm is missing"),
        ({"mark": {"width_mm": 6.0, "depth": 2.0}}, "depth is unknown"),
        ({"mark": {"width_mm": -6.0}}, "width_mm = -6 mm"),
        ({"mark": {"width_mm": 6.0, "radius_mm": [17.0, 16.0]}}, "from the lower end to the higher one"),
        ({"mark": {"width_mm": 6.0, "z_mm": 3.0}}, "two heights"),
        ({"mark": {"width_mm": 6.0}, "tooth_1_deg": 30.0}, "both given"),
    ],
)
def test_what_is_no_mark_is_refused_by_name(datum, said):
    with pytest.raises(InputError, match=said):
        parse_design({"gear": TABLE, "datum": datum})


def test_a_keyway_needs_a_bore_and_no_more_than_its_width():
    bare = parse_design({"gear": {**TABLE, "bore_diameter": 0.0}}).gears["gear"]
    with pytest.raises(InputError, match="bore_diameter"):
        number_by_mark(np.zeros((20, 3)), bare, MARK)
    with pytest.raises(InputError, match="at most the radius"):
        number_by_mark(np.zeros((20, 3)), GEAR, replace(MARK, width=50.0, radius=(16.0, 18.0)))
