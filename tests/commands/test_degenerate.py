"""Clouds and gears at the ends of what can be, through the whole of compare: a result with finite numbers, or one line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.commands.doors import run, strict_json
from tests.commands.test_bad_input import refused
from tests.commands.test_degenerate_kinds import lies_on_the_design
from tests.scan.writers import ply, stl
from tests.synthetic import PINION, GearNumbers, Recipe, make_scan

pytestmark = pytest.mark.long

RNG = np.random.default_rng(11)


def scan_of(gear: GearNumbers = PINION, points: int = 12_000) -> np.ndarray:
    return make_scan(Recipe(gear=gear).of_size(points), 1).points


GOOD = scan_of()


def design_of(gear: GearNumbers) -> str:
    return (
        f"[gear]\nteeth = {gear.teeth}\nmodule = {gear.module}\nface_width = {gear.face_width}\nprofile_shift = {gear.profile_shift}\n"
        f"addendum = {gear.addendum}\nrack_tip_radius = {gear.rack_tip_radius}\n"
    )


def comparison(
    folder: Path, points: np.ndarray, gear: GearNumbers = PINION, data: bytes | None = None, name: str = "a.ply", *more: str
) -> Any:
    """Compare a scan, the page left out; the report, or what was said."""
    (folder / name).write_bytes(ply(points, kind="f8") if data is None else data)
    (folder / "design.toml").write_text(design_of(gear))
    said = run("compare", folder / "design.toml", folder / name, "--out", folder / "out", "--quiet", "--no-page", *more)
    if said.status == 0:
        assert said.err == ""
        return strict_json(folder / "out" / "report.json")
    refused(said, name)
    assert not (folder / "out").exists()
    return said.err


@pytest.fixture
def compared(tmp_path):
    return partial(comparison, tmp_path)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """The report of the good scan, which the others are held against."""
    return comparison(tmp_path_factory.mktemp("plain"), GOOD)


CLOUDS: dict[str, Callable[[], np.ndarray]] = {
    "all equal": lambda: np.ones((5000, 3)),
    "one point a million times": lambda: np.repeat(GOOD[:1], 1_000_000, axis=0),
    "collinear": lambda: np.outer(np.linspace(0.0, 80.0, 4000), [1.0, 1.0, 0.3]),
    "coplanar": lambda: RNG.uniform(-44.0, 44.0, (4000, 2)) @ np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.2]]),
    "two planes": lambda: np.column_stack([RNG.uniform(-44.0, 44.0, (4000, 2)), 15.0 * RNG.integers(0, 2, 4000)]),
    "a circle": lambda: 44.0 * np.column_stack([f(np.linspace(0.0, 6.28, 3000)) for f in (np.cos, np.sin, np.zeros_like)]),
    "one tooth": lambda: GOOD[np.abs(np.arctan2(GOOD[:, 1], GOOD[:, 0])) < 0.25],
}


@pytest.mark.parametrize("name", CLOUDS)
def test_what_is_no_gear_is_refused(compared, name):
    assert isinstance(compared(CLOUDS[name]()), str)


def test_a_gear_pressed_flat_is_doubtful_or_refused(compared):
    told = compared((GOOD * [1.0, 1.0, 0.0]) @ np.linalg.qr(RNG.normal(size=(3, 3)))[0])
    assert isinstance(told, str) or not told["registration"]["converged"] or told["warnings"]


def test_repetitions_and_strays_change_nothing(compared, plain):
    """A point a million times is one point, and points as far as 10⁹ mm are none of the gear's."""
    spoilt = compared(np.concatenate([np.repeat(GOOD[:1], 1_000_000, axis=0), GOOD[1:], [[9e8, 0.0, 0.0], [-9e8, 0.0, 1.0]]]))
    assert spoilt["closed_loop"]["noise_um"] == plain["closed_loop"]["noise_um"]
    assert spoilt["wear"]["volume_mm3"] == plain["wear"]["volume_mm3"]


def test_normals_that_are_none(compared, plain):
    """As if there were none."""
    import io

    from plyfile import PlyData, PlyElement

    rows = np.zeros(len(GOOD), [(axis, "f8") for axis in ("x", "y", "z", "nx", "ny", "nz")])
    for i, axis in enumerate("xyz"):
        rows[axis], rows[f"n{axis}"] = GOOD[:, i], np.nan
    out = io.BytesIO()
    PlyData([PlyElement.describe(rows, "vertex")]).write(out)
    told = compared(GOOD, data=out.getvalue())
    assert told["closed_loop"]["noise_um"] == plain["closed_loop"]["noise_um"]


@pytest.mark.parametrize("factor", [0.1 / 6.35, 40.0 / 6.35], ids=["module 0.1", "module 40"])
def test_a_gear_of_any_size_is_the_same_gear(compared, plain, factor):
    """All lengths in proportion, the noise too: what is found is in proportion."""
    gear = replace(PINION, module=PINION.module * factor, face_width=PINION.face_width * factor)
    told = compared(GOOD * factor, gear)
    assert told["closed_loop"]["noise_um"] == pytest.approx(factor * plain["closed_loop"]["noise_um"], rel=0.02)
    assert told["registration"]["converged"]


@pytest.mark.parametrize(
    "gear",
    [
        replace(PINION, teeth=5, module=8.0, profile_shift=0.6, addendum=0.8),
        replace(PINION, teeth=200, module=1.0, face_width=10.0),
    ],
    ids=["5 teeth", "200 teeth"],
)
def test_few_and_many_teeth(compared, tmp_path, gear):
    points = scan_of(gear, 20_000 if gear.teeth > 100 else 12_000)
    told = compared(points, gear, None, "a.ply", "--no-loop")
    lies_on_the_design(told, gear.teeth)
    # Five standard deviations of the slope of a thousand points on 6 mm of roll, 5 · √12 · 10 µm / (√1000 · 6 mm).
    assert told["registration"]["flank_base_radius_mm"] == pytest.approx(told["design"]["base_radius_mm"], rel=9e-4)


def test_single_precision_a_kilometre_off_is_known_less_well(compared, plain):
    """Steps of 0.06 mm between the numbers: no uncertainty becomes smaller."""
    far = compared((GOOD + np.array([1e6, 0.0, 0.0])).astype(np.float32).astype(np.float64))
    assert far["closed_loop"]["noise_um"] > plain["closed_loop"]["noise_um"]
    assert far["thickness"][0]["mean_mm"] == pytest.approx(plain["thickness"][0]["mean_mm"], abs=0.02)


def test_double_precision_a_hundred_kilometres_off_is_the_same(compared, plain):
    far = compared(GOOD + np.array([1e8, 0.0, 0.0]))
    assert far["closed_loop"]["noise_um"] == pytest.approx(plain["closed_loop"]["noise_um"], rel=1e-3)


@pytest.mark.parametrize("rings", [2, 3])
def test_triangles_of_a_cad_model(compared, tmp_path, rings):
    """Corners stand at the end faces alone, or in one section beside them: there is nothing between to measure by."""
    from gearwear.design import Gear, GearSpec

    gear = Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0))
    radius = np.linspace(gear.root_radius, gear.tip_radius, 20)
    psi = gear.half_angle(radius)
    centre = 2.0 * np.pi * np.arange(12)[:, None] / 12
    angle = np.concatenate([centre - psi, centre + psi[::-1]], axis=1).ravel()
    at = np.tile(np.concatenate([radius, radius[::-1]]), 12)
    ring = np.column_stack([at * np.cos(angle), at * np.sin(angle)])
    points = np.concatenate([np.column_stack([ring, np.full(len(ring), z)]) for z in np.linspace(0.0, 15.0, rings)])
    a = np.arange(len(ring))
    b = np.roll(a, -1)
    walls = [np.stack([a + k, b + k, a + k + len(ring)], 1) for k in range(0, len(ring) * (rings - 1), len(ring))]
    walls += [np.stack([b + k, b + k + len(ring), a + k + len(ring)], 1) for k in range(0, len(ring) * (rings - 1), len(ring))]
    data = stl(points, np.concatenate(walls))
    compared(GOOD, data=data, name="cad.stl")
    (tmp_path / "other.stl").write_bytes(data)
    said = run("design", tmp_path / "other.stl")
    assert said.status == 0 or (said.status == 2 and said.err.count("\n") == 1)


def turned(points: np.ndarray, degrees: float = 97.0) -> np.ndarray:
    """By more than three pitches, upside down, tipped over and carried off."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    tip = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    tip[0] *= np.sign(np.linalg.det(tip))
    over = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
    return points @ (tip @ over).T + [5.0, 6.0, 7.0]


AGAIN: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "as it is": lambda points: points,
    "shuffled": RNG.permutation,
    "to 10 µm": lambda points: np.round(points / 0.01) * 0.01,
    "to 50 µm": lambda points: np.round(points / 0.05) * 0.05,
    "a kilometre off": lambda points: (points + np.array([1e6, 0.0, 0.0])).astype(np.float32).astype(np.float64),
}
"""The bundled example in other words."""


@pytest.fixture(scope="module")
def registered(tmp_path_factory):
    """Noise, and standard deviations of rotation and worn volume, of the bundled example in other words, without the loop; each is registered once."""
    from gearwear.comparison.measured_gear import register
    from gearwear.comparison.stations import without_loop
    from gearwear.design import read_design
    from gearwear.scan import read_one, read_scan
    from tests.commands.doors import EXAMPLE

    file, points = tmp_path_factory.mktemp("coarse") / "a.ply", read_one(EXAMPLE / "scan.ply.gz").points

    @cache
    def stds_of(every: int, name: str) -> tuple[float, float, float]:
        file.write_bytes(ply(AGAIN[name](points[::every]), kind="f8"))
        measured = register(read_design(EXAMPLE / "design.toml"), read_scan([file]))
        return measured.noise, measured.placed.registration.rotation_std, without_loop(measured).volume_std

    return stds_of


def test_the_order_of_the_points_changes_nothing(registered):
    """It is lost where points are sorted into cells: before the loop."""
    assert registered(8, "shuffled") == pytest.approx(registered(8, "as it is"), rel=1e-5)


@pytest.mark.parametrize(("name", "step"), [("to 10 µm", 10.0), ("to 50 µm", 50.0), ("a kilometre off", 62.5)])
def test_the_noise_grows_by_that_of_rounding(registered, name, step):
    """By the variance step² / 12 along each axis that is rounded: x alone a kilometre off."""
    share = 0.5 if name == "a kilometre off" else 1.0  # mean square of a flank's normal along x
    fine, coarse = (1e3 * registered(8, one)[0] for one in ("as it is", name))
    assert coarse**2 == pytest.approx(fine**2 + share * step**2 / 12.0, rel=0.1)


@pytest.mark.parametrize("name", ["to 10 µm", "to 50 µm", "a kilometre off"])
@pytest.mark.parametrize("every", [8, 16])
def test_a_scan_too_coarse_to_show_the_wear_of_a_side_knows_no_more(registered, every, name):
    """The left flanks are worn throughout. Once the noise hides that, they count as datum, and ± of pose and volume would be those of a gear without."""
    (_, fine_turn, fine), (_, coarse_turn, coarse) = registered(every, "as it is"), registered(every, name)
    assert coarse_turn > 0.95 * fine_turn
    assert coarse > 0.97 * fine
