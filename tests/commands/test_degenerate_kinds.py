"""The ends of what can be, once more for rings, helical and double helical gears: a result with finite numbers, or one line."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.commands.doors import run, strict_json
from tests.commands.test_bad_input import refused
from tests.scan.writers import ply
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.helical import Helical, scan
from tests.synthetic.ring import Ring, ring_scan

POINTS = 8_000


def drawn(gear: Helical | Ring, width: float, more: str) -> str:
    return (
        f"[gear]\nteeth = {gear.teeth}\nnormal_module = {gear.module}\nhelix_angle = {gear.helix}\nface_width = {width}\n"
        f"pressure_angle = {gear.pressure}\nprofile_shift = {gear.shift}\naddendum = {gear.addendum}\ndedendum = {gear.dedendum}\n{more}"
    )


def rack(gear: Helical) -> str:
    return f"rack_tip_radius = {gear.tip_radius}\n"


HELICAL, DOUBLE, RING = Helical(), Double(), Ring()
KINDS: dict[str, tuple[str, Callable[[], Any]]] = {
    "helical": (drawn(HELICAL, HELICAL.width, rack(HELICAL)), lambda: scan(HELICAL, POINTS)),
    "double helical": (
        drawn(DOUBLE.lower, DOUBLE.width, f"gap = {DOUBLE.gap}\n{rack(DOUBLE.lower)}"),
        lambda: double_scan(DOUBLE, POINTS),
    ),
    "ring": (
        drawn(RING, RING.width, f"internal = true\nfillet_radius = {RING.fillet_radius}\nrim_diameter = {2.0 * RING.rim}\n"),
        lambda: ring_scan(RING, 2 * POINTS),
    ),
}


@cache
def good(kind: str) -> np.ndarray:
    return np.asarray(KINDS[kind][1]().points)


@pytest.fixture(params=list(KINDS))
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """Compare with a design, without page and loop; the report, or what was said. The same twice is done once."""
    reports: dict[tuple[str, bytes], Any] = {}

    def compare(design: str, points: np.ndarray, data: bytes | None = None) -> Any:
        data = ply(points, kind="f8") if data is None else data
        if (design, data) in reports:
            return reports[design, data]
        folder = tmp_path_factory.mktemp("kinds")
        (folder / "a.ply").write_bytes(data)
        (folder / "design.toml").write_text(design)
        said = run(
            "compare", folder / "design.toml", folder / "a.ply", "--out", folder / "out", "--quiet", "--no-page", "--no-loop"
        )
        if said.status == 0:
            assert said.err == ""
            reports[design, data] = strict_json(folder / "out" / "report.json")
            return reports[design, data]
        refused(said)
        assert not (folder / "out").exists()
        return said.err

    return compare


CLOUDS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "all equal": lambda points: np.ones((5000, 3)),
    "one point a million times": lambda points: np.repeat(points[:1], 1_000_000, axis=0),
    "collinear": lambda points: np.outer(np.linspace(0.0, 80.0, 4000), [1.0, 1.0, 0.3]),
    "coplanar": lambda points: (
        np.random.default_rng(1).uniform(-44.0, 44.0, (4000, 2)) @ np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.2]])
    ),
}


@pytest.mark.parametrize("name", CLOUDS)
def test_what_is_no_gear_is_refused(compared, kind, name):
    assert isinstance(compared(KINDS[kind][0], CLOUDS[name](good(kind))), str)


@pytest.mark.long
def test_repetitions_strays_and_normals_that_are_none_change_nothing(compared, kind):
    """A point a thousand times is one point, and points as far as 10⁹ mm are none of the gear's."""
    from plyfile import PlyData, PlyElement

    points = good(kind)
    more = np.concatenate([np.repeat(points[:1], 1000, axis=0), points[1:], [[9e8, 0.0, 0.0], [-9e8, 0.0, 1.0]]])
    rows = np.zeros(len(more), [(axis, "f8") for axis in ("x", "y", "z", "nx", "ny", "nz")])
    for i, axis in enumerate("xyz"):
        rows[axis], rows[f"n{axis}"] = more[:, i], np.nan
    out = io.BytesIO()
    PlyData([PlyElement.describe(rows, "vertex")]).write(out)
    plain, spoilt = compared(KINDS[kind][0], points), compared(KINDS[kind][0], points, data=out.getvalue())
    assert plain["registration"]["converged"] and plain["design"]["teeth"] > 0
    assert spoilt["closed_loop"]["noise_um"] == plain["closed_loop"]["noise_um"]
    assert spoilt["wear"]["volume_mm3"] == plain["wear"]["volume_mm3"]


@pytest.mark.long
def test_single_precision_a_kilometre_off_is_known_less_well(compared, kind):
    """Steps of 0.06 mm between the numbers along x."""
    near, coarse = good(kind), (good(kind) + np.array([1e6, 0.0, 0.0])).astype(np.float32).astype(np.float64)
    near, far = compared(KINDS[kind][0], near), compared(KINDS[kind][0], coarse)
    assert far["closed_loop"]["noise_um"] > near["closed_loop"]["noise_um"]
    for key in ("translation_std_um", "rotation_std_at_base_circle_um"):
        known = np.array([near["registration"][key], far["registration"][key]], dtype=float)
        assert np.all(known[1] > known[0]), key


@pytest.mark.long
@pytest.mark.parametrize(("kind", "module"), [("helical", 40.0), ("double helical", 0.1), ("ring", 0.1)])
def test_of_any_size_it_is_the_same_gear(compared, kind, module):
    """All lengths in proportion, the noise too."""
    factor = module / {"helical": HELICAL, "double helical": DOUBLE.lower, "ring": RING}[kind].module
    lengths = ("normal_module", "face_width", "gap", "fillet_radius", "rim_diameter")
    lines = [line.split(" = ") for line in KINDS[kind][0].splitlines() if " = " in line]
    design = "[gear]\n" + "".join(f"{key} = {float(value) * factor if key in lengths else value}\n" for key, value in lines)
    plain, told = compared(KINDS[kind][0], good(kind)), compared(design, good(kind) * factor)
    assert told["closed_loop"]["noise_um"] == pytest.approx(factor * plain["closed_loop"]["noise_um"], rel=0.02)
    assert told["registration"]["converged"]


def few() -> tuple[str, np.ndarray]:
    gear = Helical(teeth=5, module=6.0, shift=0.5, addendum=0.8, width=20.0)
    return drawn(gear, gear.width, rack(gear)), scan(gear, POINTS).points


def many() -> tuple[str, np.ndarray]:
    ring = replace(RING, teeth=200, module=1.0, width=10.0, fillet_radius=0.2, rim=110.0)
    more = f"internal = true\nfillet_radius = {ring.fillet_radius}\nrim_diameter = {2.0 * ring.rim}\n"
    return drawn(ring, ring.width, more), ring_scan(ring, 2 * POINTS, noise=0.002).points


def lies_on_the_design(told: Any, teeth: int) -> None:
    """Registered, nothing worn, and the tip circle to half the noise of a point: five standard deviations of the mean of a hundred."""
    assert not isinstance(told, str), told
    drawn, placed = told["design"], told["registration"]
    assert (drawn["teeth"], placed["converged"], told["wear"]["volume_mm3"]["value"]) == (teeth, True, 0)
    assert placed["fitting_share"] > 0.99
    assert placed["tip_radius_mm"] == pytest.approx(drawn["tip_radius_mm"], abs=0.5e-3 * told["closed_loop"]["noise_um"])


@pytest.mark.parametrize(("made", "teeth"), [(few, 5), pytest.param(many, 200, marks=pytest.mark.long)])
def test_few_and_many_teeth(compared, made, teeth):
    lies_on_the_design(compared(*made()), teeth)
