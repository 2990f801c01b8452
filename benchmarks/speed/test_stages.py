"""Each stage by itself, warm, in one process: pytest-benchmark's own table; the goals that need no peer."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.speed import stages, workload
from gearwear.comparison.closing import measure
from gearwear.design.files.toml import read_design
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.side import Side
from gearwear.design.surface import locate
from gearwear.meshing.contact import mesh_contact
from tests.synthetic import SyntheticScan
from tests.synthetic.removal import wear_depth

pytest.importorskip("pytest_benchmark")


@pytest.fixture(scope="module")
def read(used_file):
    return stages.read(str(used_file))


@pytest.fixture(scope="module")
def registered(read, gear):
    return stages.registered(read, gear)


@pytest.fixture(scope="module")
def cells(registered, gear):
    return stages.cells_of(registered, gear)


@pytest.fixture
def run(benchmark, rounds):
    """Measure a call a few times after one to warm up."""
    return lambda call: benchmark.pedantic(call, rounds=rounds, warmup_rounds=1)


@pytest.fixture
def goal(benchmark, table):
    """Put what was measured into the table, and hold it to its goal."""

    def check(what: str, most: float) -> None:
        median = float(benchmark.stats.stats.median)
        table.add(what, f"{median:.2f} s", f"{most:g} s", median < most)
        assert median < most

    return check


def test_reading(run, used_file):
    assert len(run(lambda: stages.read(str(used_file))).points) > 480_000


def test_registration_and_deviation(run, read, gear):
    assert run(lambda: stages.registered(read, gear)).registration.converged


def test_deviation(run, placed, gear):
    assert np.isfinite(run(lambda: locate(placed, gear)).deviation).mean() > 0.99


def test_wear(run, registered, cells):
    assert run(lambda: stages.wear_of(registered, cells)).regions


def test_worn_solid(run, registered, cells):
    wear = stages.wear_of(registered, cells)
    assert run(lambda: stages.worn_solid(wear, cells, registered.registration.noise))[1]


def test_closed_loop(run, goal, coated_file):
    """Less than reading and registration together, or under 5 s, whichever is larger: so 5 s is enough."""
    from gearwear.diagnose.loop import close_loop

    first = measure(read_design(workload.DESIGN), [coated_file], loop=False)
    found = run(lambda: close_loop(first.first, first.noise, first.context))
    assert {effect.name for effect in found.effects} == {"coating", "turntable_angle"}
    goal("closed loop", 5.0)


def test_contact(run, goal, used):
    """12 teeth × 75 slices × 204 positions."""
    pair = read_design(workload.DESIGN)
    mate = pair.gears["gear"]
    other = nominal_profiles(mate, np.linspace(mate.root_radius, mate.tip_radius, 200), np.array([0.5 * mate.face_width]))
    worn = worn_pinion(used, 75)
    assert run(lambda: mesh_contact(worn, other, pair.centre_distance)).peak_to_peak_um > 1.0
    goal("contact, 12 teeth × 75 slices × 204 positions", 5.0)


def worn_pinion(scan: SyntheticScan, slices: int) -> ToothProfiles:
    """The true profiles of the used pinion, the foot taken at the point's own radius."""
    gear, outline = read_design(workload.DESIGN).gears["pinion"], scan.truth.outline
    profiles = nominal_profiles(
        gear, np.linspace(gear.root_radius, gear.tip_radius, 120), np.linspace(0.0, gear.face_width, slices)
    )
    flank = profiles.radius > gear.form_radius
    roll = np.sqrt(profiles.radius[flank] ** 2 - gear.base_radius**2)
    for tooth in range(gear.teeth):
        depth = wear_depth(scan.truth.recipe.wear, outline, np.array(tooth), np.array(1), roll[None, :], profiles.z[:, None])
        profiles.half_angle[tooth, Side.LEFT.index][:, flank] -= depth / gear.base_radius
    return profiles
