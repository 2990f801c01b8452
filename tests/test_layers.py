import ast
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.layers import (
    FREE,
    MAY_IMPORT,
    SHIMS,
    arrows,
    by_position,
    circles,
    large_dataclasses,
    modules,
    nodes,
    parsed,
    violations,
)

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "gearwear"


@pytest.mark.parametrize(("module", "package", "source"), [pytest.param(*m, id=m[0]) for m in modules(PACKAGE)])
def test_module_keeps_the_rules(module, package, source):
    assert violations(source, module, package) == []


def test_a_large_dataclass_is_built_by_name():
    large = large_dataclasses(PACKAGE)
    assert [one for module, _, source in modules(PACKAGE) for one in by_position(source, module, large)] == []


def test_one_built_by_position_would_be_seen():
    assert by_position("Loop(1, 2, 3, 4, 5)", "gearwear.a", {"Loop"}) == ["gearwear.a: Loop"]
    assert by_position("Loop(*all)", "gearwear.a", {"Loop"}) == ["gearwear.a: Loop"]
    assert by_position("Loop(1, b=2, c=3)\nPose(1, 2, 3, 4, 5)", "gearwear.a", {"Loop"}) == []


def test_no_class_name_is_there_twice():
    trees = [parsed(source) for _, _, source in modules(PACKAGE)]
    names = Counter(node.name for tree in trees for node in nodes(tree) if isinstance(node, ast.ClassDef) and node.name[0] != "_")
    assert names.total() > 100
    assert [name for name, times in names.items() if times > 1] == []


def test_every_room_is_there_and_no_other():
    folders = {path.parent.name for path in PACKAGE.glob("*/__init__.py")} - {"example"}
    assert folders == set(MAY_IMPORT) - {"api"}
    assert {path.stem for path in PACKAGE.glob("*.py")} == {*FREE, *SHIMS, "api"}


def test_no_circle_of_imports():
    assert circles(arrows(PACKAGE)) == []


def test_a_circle_would_be_seen():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]


@pytest.mark.parametrize(
    ("module", "source", "what"),
    [
        ("gearwear.design.gear", "from gearwear.scan.types import Scan", "design imports gearwear.scan.types"),
        ("gearwear.scan.ply", "import gearwear.placing.pose", "scan imports gearwear.placing.pose"),
        ("gearwear.scan.ply", "from gearwear import placing", "scan imports gearwear.placing"),
        ("gearwear.placing.pose", "from ..wear import volume", "placing imports gearwear.wear"),
        ("gearwear.inspection.span", "from ..wear import volume", "inspection imports gearwear.wear"),
        ("gearwear.diagnose.loop", "def f():\n    from gearwear.wear.solid import cut", "diagnose imports gearwear.wear"),
        ("gearwear.meshing.exact", "from gearwear.placing.pose import Pose", "meshing imports gearwear.placing"),
        ("gearwear.brep.solid", "from gearwear.wear.solid import cut", "brep imports gearwear.wear"),
        ("gearwear.report.page", "from gearwear.brep.solid import solid", "report imports gearwear.brep"),
        ("gearwear.report.page", "from gearwear.meshing.path import sliding", "report computes nothing"),
        (
            "gearwear.report.page",
            "from gearwear.wear_law.archard import law_terms",
            "it takes types from wear_law, not law_terms",
        ),
        ("gearwear.report.page", "from gearwear.commands.compare import main", "report imports gearwear.commands.compare"),
        ("gearwear.wear.volume", "from gearwear import compare", "wear imports gearwear.compare"),
        ("gearwear.errors", "from gearwear.design import Gear", "errors imports gearwear.design"),
        ("gearwear.placing.pose", "if TYPE_CHECKING:\n    from gearwear.wear import Patch", "placing imports gearwear.wear"),
        ("gearwear.design.gear", "from scipy.optimize import brentq", "design imports scipy"),
        ("gearwear.wear.solid", "import trimesh", "wear imports trimesh, which belongs to report, scan"),
        ("gearwear.scan.triangles", "from manifold3d import Manifold", "scan imports manifold3d"),
        ("gearwear.commands.models", "import build123d as bd", "commands imports build123d, which belongs to brep"),
        ("gearwear.wear.thickness", "import matplotlib.pyplot as plt", "wear imports matplotlib"),
        ("gearwear.wear.regions", "from rich.progress import track", "wear imports rich"),
        ("gearwear.brep.solid", "import cadquery", "which belongs to nobody"),
        ("gearwear.placing.pose", "import importlib\nimportlib.import_module('trimesh')", "placing imports trimesh"),
        ("gearwear.placing.pose", "__import__('ezdxf.addons')", "placing imports ezdxf"),
        ("gearwear.design.gear", "from numpy import *", "imports * from numpy"),
        ("gearwear.wear.solid", "mesh = 1", "the name `mesh`"),
        ("gearwear.wear.solid", "def cut(mesh): ...", "the name `mesh`"),
        ("gearwear.wear.solid", "def mesh(): ...", "the name `mesh`"),
        ("gearwear.wear.solid", "self.mesh = 1", "the name `mesh`"),
        ("gearwear.wear.solid", "class Cut:\n    mesh: int", "the name `mesh`"),
        ("gearwear.wear.solid", "for meshes in []: ...", "the name `meshes`"),
        ("gearwear.wear.solid", "import numpy as mesh", "the name `mesh`"),
        ("gearwear.wear.solid", "x = 1\n" * 550, "550 lines"),
    ],
)
def test_the_checker_sees_each_violation(module, source, what):
    (line,) = violations(source, module)
    assert what in line
    assert line.startswith(f"{module}:")


@pytest.mark.parametrize(
    ("module", "package", "source"),
    [
        (
            "gearwear.placing.pose",
            False,
            "from gearwear.design.gear import Gear\nfrom gearwear.scan import Scan\nimport numpy as np",
        ),
        ("gearwear.placing.pose", False, "from . import robust\nfrom .robust import tukey\nfrom ..design import Gear"),
        ("gearwear.placing", True, "from .pose import Pose\nfrom ..design import Gear"),
        ("gearwear.commands.compare", False, "import rich\nfrom gearwear.report import page\nfrom gearwear import brep"),
        (
            "gearwear.commands.models",
            False,
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from build123d import Shape",
        ),
        ("gearwear.scan.ply", False, "def f(library):\n    return library.mesh.triangles"),
        ("gearwear.design.gear", False, "x = 1\n" * 549),
        ("gearwear.design.gear", False, "from gearwear.arrays import Floats\nfrom gearwear.errors import InputError"),
    ],
)
def test_the_checker_lets_the_rest_pass(module, package, source):
    assert violations(source, module, package) == []


HEAVY = ("scipy.optimize", "trimesh", "matplotlib", "build123d", "OCP", "cadquery", "manifold3d", "lxml", "networkx")
RUN = "import runpy, sys; sys.argv = ['gearwear', '--help']; runpy.run_module({module!r}, run_name='__main__', alter_sys=False)"


def loaded(code: str) -> list[str]:
    """Heavy packages in memory when a fresh interpreter has run `code`, which may end in ``sys.exit(0)``."""
    script = (
        f"import atexit, sys\natexit.register(lambda: sys.stderr.write(repr([m for m in {HEAVY!r} if m in sys.modules])))\n{code}"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr.startswith("["), done.stderr
    return [name.strip("'") for name in done.stderr.strip("[]").split(", ") if name]


def front_doors() -> list[str]:
    """What runs with ``python -m``."""
    alone = [f"gearwear.{path.stem}" for path in PACKAGE.glob("[!_]*.py") if '__name__ == "__main__"' in path.read_text("utf-8")]
    return sorted([*alone, *(".".join(path.relative_to(ROOT).parts[:-1]) for path in PACKAGE.rglob("__main__.py"))])


def test_the_package_costs_no_more_than_numpy():
    assert loaded("import gearwear, gearwear.design") == []


@pytest.mark.parametrize("module", front_doors())
def test_help_loads_nothing_heavy(module):
    assert loaded(RUN.format(module=module)) == []


def test_the_cost_test_sees_a_heavy_import():
    assert loaded("import scipy.optimize, sys; sys.exit(0)") == ["scipy.optimize"]
