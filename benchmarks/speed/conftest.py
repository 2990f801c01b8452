"""The scans and shapes, made once; the table of what was measured, printed at the end."""

from __future__ import annotations

import compileall
import os
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the commands do; before numpy is imported

import numpy as np
import pytest

from benchmarks.speed import shapes, workload
from benchmarks.speed.table import Table
from gearwear.design.files.toml import read_design
from gearwear.design.gear import Gear
from tests.synthetic import Rigid, SyntheticScan, rotation_about

TABLE = pytest.StashKey[Table]()
LOAD = pytest.StashKey[float]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--rounds", type=int, default=5, help="how often each side of a comparison is measured, in turn")


def pytest_configure(config: pytest.Config) -> None:
    config.stash[TABLE] = Table([])
    config.stash[LOAD] = os.getloadavg()[0]
    # As pip does with what it installs, the peers' packages too; where no bytecode is to be written, every start would compile anew.
    compileall.compile_dir(workload.DESIGN.parents[1], quiet=1)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.stash[TABLE].rows:
        packages = ("numpy", "scipy", "manifold3d", "open3d")
        terminalreporter.section("measured")
        terminalreporter.write_line(config.stash[TABLE].markdown())
        python = ".".join(map(str, sys.version_info[:3]))
        terminalreporter.write_line("")
        terminalreporter.write_line(
            f"{os.cpu_count()} processors{_model()}, load {config.stash[LOAD]:.1f} at the start, Python {python}, "
            + ", ".join(f"{name} {_version(name)}" for name in packages)
            + _commit()
        )


def _model() -> str:
    """The processor's name, where Linux tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    return next((f" ({line.partition(':')[2].strip()})" for line in lines if line.startswith("model name")), "")


def _commit() -> str:
    """The commit that was measured, "" outside a clone."""
    done = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True, cwd=workload.DESIGN.parent, check=False
    )
    return f", commit {done.stdout.strip()}" if done.returncode == 0 else ""


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


@pytest.fixture(scope="session")
def rounds(pytestconfig: pytest.Config) -> int:
    return int(pytestconfig.getoption("--rounds"))


@pytest.fixture(scope="session")
def table(pytestconfig: pytest.Config) -> Table:
    return pytestconfig.stash[TABLE]


@pytest.fixture(scope="session")
def gear() -> Gear:
    return read_design(workload.DESIGN).gears["pinion"]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("speed")


@pytest.fixture(scope="session")
def used() -> SyntheticScan:
    return workload.used_pinion()


@pytest.fixture(scope="session")
def used_file(folder: Path, used: SyntheticScan) -> Path:
    return workload.write_ply(folder / "used.ply", used.points)


@pytest.fixture(scope="session")
def coated_file(folder: Path) -> Path:
    return workload.write_ply(folder / "coated.ply", workload.coated_pinion().points)


@pytest.fixture(scope="session")
def placed(used: SyntheticScan) -> np.ndarray:
    """The points of the used pinion in the design frame, by the true pose."""
    return used.truth.pose.inverse().apply(used.points)


@pytest.fixture(scope="session")
def shapes_file(folder: Path, used: SyntheticScan) -> Iterator[Path]:
    """All that the chain of peers is given: shapes and starts."""
    outline, rng = used.truth.outline, np.random.default_rng(0)
    points, normals = shapes.target(outline, len(used.points), rng)
    fine = shapes.nominal(outline)
    coarse, worn = shapes.worn(used.truth.recipe, outline, rng)
    file = folder / "shapes.npz"
    np.savez(
        file, target=points, normals=normals, vertices=fine.vertices, faces=fine.faces,
        coarse_vertices=coarse.vertices, coarse_faces=coarse.faces, worn_vertices=worn.vertices, worn_faces=worn.faces,
        by_hand=_start(used, 0.5, 1.0), near=_start(used, 0.05, 0.0),
    )  # fmt: skip
    yield file


def _start(scan: SyntheticScan, shift_mm: float, tilt_deg: float) -> np.ndarray:
    """A pose off the true one: turned at the base circle and shifted by so much, tilted by so much."""
    turn = shift_mm / scan.truth.outline.base_radius
    off = Rigid(rotation_about(np.array([np.radians(tilt_deg), 0.0, turn])), shift_mm * np.array([1.0, -1.0, 1.0]) / np.sqrt(3.0))
    pose = off.after(scan.truth.pose.inverse())
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose.rotation, pose.translation
    return matrix
