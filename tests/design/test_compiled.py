"""The contract of the compiled `locate`: what NumPy gives, to 1e-12 mm, for points anywhere round gears of every kind."""

from __future__ import annotations

import math
import multiprocessing
import os
import subprocess
import sys
import warnings
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from gearwear import compiled
from gearwear.design import Gear, GearSpec
from gearwear.design.modification import FlankModification
from gearwear.design.surface import BORE, FILLET, FLANK, OTHER, SURFACE_NAMES, Bands, SurfacePoints, deviations, locate
from tests.design.gears import SPREAD
from tests.design.test_ring import GEARS as RINGS

pytest.importorskip("numba")

POINTS = 6000
EXACT = 1e-12
"""mm, as promised; rounding of lengths of 300 mm is 6e-14."""


def gear(teeth: int, module: float, degrees: float = 0.0, **more: Any) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, module, 8.0 * module, helix_angle=math.radians(degrees), **more))


def drawn(degrees: float = 0.0, **amounts: float | str) -> Gear:
    """Modified on the left; on the right half as much helix slope."""
    left = FlankModification(**amounts)
    right = replace(left, helix_slope=0.5 * left.helix_slope)
    return gear(23, 3.0, degrees, left=left, right=right)


HELICAL = {
    "right 15": gear(25, 2.0, 15.0, bore_diameter=20.0),
    "left 35": gear(31, 3.0, -35.0, profile_shift=0.2, tip_chamfer=0.3),
    "left 20, undercut": gear(9, 4.0, -20.0, tip_rounding=0.3),
    "eighty teeth": gear(80, 1.5, 8.0, end_chamfer=0.5),
    "edges seen": gear(25, 2.0, -15.0, ends_seen=((0.3, 0.8), (0.9, 0.0))),
    "double": gear(40, 2.0, 25.0, gap=4.0, bore_diameter=30.0),
    "protuberance": gear(33, 2.5, 12.0, protuberance=0.06, rack_tip_radius=0.3),
}
MODIFIED = {
    "linear tip relief": drawn(tip_relief=0.03, tip_relief_length=2.0),
    "everything, helical": drawn(
        18.0, tip_relief=0.02, tip_relief_length=1.5, tip_relief_form="parabolic", root_relief=0.01, root_relief_length=1.0,
        profile_crowning=0.004, helix_crowning=0.01, profile_slope=-0.005, helix_slope=0.012, end_relief=0.015, end_relief_length=3.0,
    ),
    "ring, crowned on the left": Gear.from_spec(
        replace(RINGS["spur"].spec, left=FlankModification(helix_crowning=0.02, profile_slope=0.01))
    ),
}  # fmt: skip
EVERY = SPREAD | HELICAL | MODIFIED | {f"ring, {name}": ring for name, ring in RINGS.items()}
every_gear = pytest.mark.parametrize("gear", EVERY.values(), ids=EVERY.keys())


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch):
    """`locate` by NumPy, and compiled."""

    def located(points: np.ndarray, gear: Gear, bands: Bands | None = None) -> tuple[SurfacePoints, SurfacePoints]:
        results = []
        for least in (sys.maxsize, 0):
            monkeypatch.setattr(compiled, "LEAST", least)
            results.append(locate(points, gear, bands, workers=1))
        return results[0], results[1]

    return located


def anywhere(gear: Gear, seed: int = 3) -> np.ndarray:
    """Points in and round a gear, half of them near its teeth."""
    rng = np.random.default_rng(seed)
    inner, outer = sorted((gear.root_radius, gear.tip_radius))
    depth = outer - inner
    radius = np.concatenate([
        rng.uniform(0.0, outer + 3.0 * depth, POINTS // 2), rng.uniform(inner - 0.1 * depth, outer + 0.1 * depth, POINTS - POINTS // 2)
    ])  # fmt: skip
    angle, z = rng.uniform(-math.pi, math.pi, POINTS), rng.uniform(-0.2, 1.2, POINTS) * gear.face_width
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


def assert_same(reference: SurfacePoints, fast: SurfacePoints) -> None:
    for name in ("surface", "tooth", "side"):
        np.testing.assert_array_equal(getattr(fast, name), getattr(reference, name), err_msg=name)
    for field in fields(SurfacePoints):
        assert getattr(fast, field.name).dtype == getattr(reference, field.name).dtype
    known = reference.surface != OTHER
    for name in ("deviation", "roll", "position"):
        np.testing.assert_allclose(
            getattr(fast, name)[known], getattr(reference, name)[known], rtol=0.0, atol=EXACT, equal_nan=True, err_msg=name
        )
    np.testing.assert_allclose(fast.normal[known], reference.normal[known], rtol=0.0, atol=EXACT)
    assert np.isnan(fast.deviation[~known]).all()


@every_gear
@pytest.mark.long
def test_same_surface_tooth_side_foot_and_deviation(gear, both):
    reference, fast = both(anywhere(gear), gear)
    seen = {SURFACE_NAMES[code] for code in np.unique(reference.surface)}
    assert seen >= {"flank", "fillet", "tip", "root", "end_low", "end_high", "other"} - (
        {"root"} if gear.root_half_angle == 0.0 else set()
    )
    assert_same(reference, fast)


def test_the_bands_decide_alike(both):
    gear = HELICAL["double"]
    unseen = replace(Bands.wide(gear), end_low=(math.inf, math.inf), tip=(-0.01, 0.03), flank=(-0.1, 0.02))
    reference, fast = both(anywhere(gear), gear, unseen)
    assert 0.1 < np.mean(reference.surface == OTHER) < 1.0
    assert_same(reference, fast)


def test_points_off_every_surface_are_no_exception(both):
    """On the axis, far away, and none at all."""
    gear = HELICAL["right 15"]
    odd = np.array([[0.0, 0.0, 3.0], [0.0, 0.0, 0.0], [1e9, -1e9, 4.0], [1.0, 2.0, -1e9], [1e-300, 0.0, 5.0]])
    reference, fast = both(odd, gear)
    assert_same(reference, fast)
    assert (fast.surface == OTHER).all()
    assert len(both(np.empty((0, 3)), gear)[1]) == 0


@pytest.mark.parametrize("least", [0, math.inf])
def test_what_is_not_a_number_belongs_to_nothing(monkeypatch, least):
    """And its neighbours are not touched by it; without numba it was on tooth −2147483648."""
    monkeypatch.setattr(compiled, "LEAST", least)
    gear = HELICAL["right 15"]
    points = anywhere(gear)
    lost = points.copy()
    lost[::7, 1] = np.nan
    whole, found = locate(points, gear), locate(lost, gear)
    assert (found.surface[::7] == OTHER).all() and np.isnan(found.deviation[::7]).all()
    assert ((found.tooth >= 0) & (found.tooth < gear.teeth)).all()
    rest = np.arange(len(points)) % 7 != 0
    np.testing.assert_array_equal(found.surface[rest], whole.surface[rest])
    np.testing.assert_allclose(found.deviation[rest], whole.deviation[rest], rtol=0.0, atol=EXACT)


def test_a_known_distance_from_a_known_surface():
    """Not against NumPy: what is put beside the bore by hand is found there."""
    gear = HELICAL["right 15"]
    rng = np.random.default_rng(1)
    angle, z, off = rng.uniform(-3.0, 3.0, 500), rng.uniform(2.0, 14.0, 500), rng.uniform(-0.1, 0.1, 500)
    in_bore = np.column_stack([(10.0 - off) * np.cos(angle), (10.0 - off) * np.sin(angle), z])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "LEAST", 0)
        found = locate(in_bore, gear)
    assert (found.surface == BORE).all()
    np.testing.assert_allclose(found.deviation, off, rtol=0.0, atol=1e-14 * 20.0)


def test_order_and_blocks_do_not_matter(both):
    from gearwear.design.kernel import BLOCK

    gear, points = MODIFIED["everything, helical"], anywhere(MODIFIED["everything, helical"])[: 3 * BLOCK + 17]
    whole = both(points, gear)[1]
    order = np.random.default_rng(0).permutation(len(points))
    mixed = locate(points[order], gear)
    np.testing.assert_array_equal(mixed.surface, whole.surface[order])
    known = mixed.surface != OTHER
    np.testing.assert_allclose(mixed.deviation[known], whole.deviation[order][known], rtol=0.0, atol=EXACT)


@pytest.mark.parametrize("count", [5, 256, 300, 6000])
def test_deviations_alone_are_those_of_locate(count, both):
    """Of fewer than a block, of one, of some and a rest; compiled both ways the loops are the same."""
    gear = HELICAL["double"]
    points = anywhere(gear)[:count]
    reference, fast = both(points, gear)
    np.testing.assert_array_equal(deviations(points, gear), fast.deviation)
    np.testing.assert_allclose(fast.deviation, reference.deviation, rtol=0.0, atol=EXACT, equal_nan=True)


def test_codes_are_the_surfaces_own():
    from gearwear.design import kernel, surface

    for name in ("FLANK", "FILLET", "ROOT", "TIP", "END_LOW", "END_HIGH", "BORE", "OTHER"):
        assert getattr(kernel, name) == getattr(surface, name)
    assert (kernel.ROUNDS, kernel.SETTLED) == (surface.MOST_ROUNDS, surface.SETTLED)
    assert (FLANK, FILLET) == (0, 1)  # the loops ask for `<= FILLET`


def test_arctan_and_sine_to_units_in_the_last_place():
    from gearwear.design.kernel_formulas import atan2, cosine_sine

    rng = np.random.default_rng(5)
    for y, x in [
        *rng.normal(size=(300, 2)),
        *(rng.normal(size=(300, 2)) * 10.0 ** rng.integers(-9, 9, (300, 2))),
        (0.0, 0.0),
        (0.0, -1.0),
        (1.0, 1.0),
    ]:
        assert abs(atan2(y, x) - math.atan2(y, x)) <= 3.0 * math.ulp(math.atan2(y, x))
    for angle in [*rng.uniform(-300.0, 300.0, 500), 0.0, math.pi, -0.5 * math.pi]:
        cos, sin = cosine_sine(angle)
        assert abs(cos - math.cos(angle)) < 3e-16 and abs(sin - math.sin(angle)) < 3e-16


def test_small_calls_and_the_switch_stay_with_numpy(monkeypatch):
    assert not compiled.pays(compiled.LEAST - 1) and compiled.pays(compiled.LEAST)
    monkeypatch.setenv(compiled.SWITCH, "0")
    assert not compiled.available() and not compiled.pays(10**9)


def test_numba_is_loaded_only_where_it_is_used():
    code = (
        "import sys\nimport numpy as np\nfrom gearwear import compiled\nfrom gearwear.design import Gear, GearSpec\n"
        "from gearwear.design.surface import locate\ngear = Gear.from_spec(GearSpec('gear', 20, 2.0, 10.0))\n"
        "locate(np.ones((10, 3)), gear)\nassert 'numba' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ)


def test_the_whole_decides_for_its_parts(monkeypatch):
    """A streamed scan goes one way, whatever its last chunk holds."""
    assert not compiled.pays(1)
    with compiled.parts_of(compiled.LEAST):
        assert compiled.pays(1)
        with compiled.parts_of(10):
            assert not compiled.pays(1)
        assert [len(part) for part in compiled.parts(np.zeros((compiled.PART + 5, 3)))] == [compiled.PART, 5]
    assert [len(part) for part in compiled.parts(np.zeros((compiled.PART + 5, 3)))] == [compiled.PART + 5]


def test_a_forked_process_goes_on_with_it(both):
    """As `gearwear.processors` forks: no thread and no lock of numba's is left behind."""
    gear = HELICAL["right 15"]
    points = anywhere(gear)
    expected = both(points, gear)[1]
    fork = multiprocessing.get_context("fork")
    ours, theirs = fork.Pipe(duplex=False)
    child = fork.Process(target=lambda: theirs.send(locate(points, gear, workers=1).deviation))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads, from Python 3.12 on
        child.start()
    assert ours.poll(60.0)
    np.testing.assert_array_equal(ours.recv(), expected.deviation)
    child.join()


def test_without_a_folder_to_write_to_it_is_compiled_all_the_same():
    """numba keeps no cache for a function that is in no file, and says so by the same error as where it may not write."""
    names: dict[str, Any] = {}
    exec("def twice(x):\n    return 2.0 * x\n", names)
    assert compiled.kernel(names["twice"])(3.0) == 6.0


def test_an_array_of_another_layout_is_taken(both):
    gear = SPREAD["paper_pinion_030"]
    points = anywhere(gear)
    expected = both(points, gear)[1]
    by_columns = np.asfortranarray(points)
    np.testing.assert_array_equal(locate(by_columns, gear).deviation, expected.deviation)


def test_without_numba_there_is_no_difference_to_numpy():
    """As where the extra is not installed: every module is imported, and a large call is numpy's."""
    code = (
        "import sys\nsys.modules['numba'] = None\nimport numpy as np\nimport gearwear.design.kernel, gearwear.placing.kernel\n"
        "from gearwear import compiled\nfrom gearwear.design import Gear, GearSpec\nfrom gearwear.design.surface import locate\n"
        "compiled.LEAST = 0\nassert not compiled.available()\n"
        "located = locate(np.array([[19.0, 0.0, 5.0]]), Gear.from_spec(GearSpec('gear', 20, 2.0, 10.0)))\nassert len(located) == 1\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ)
