"""The notebook: written by its script, valid by its own format, and every cell runs and shows what its text says."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import pytest

import gearwear as gw
from docs.make_notebook import CELLS, FILE, notebook
from tests.commands.doors import thinner_example

pytestmark = pytest.mark.long

ROOT = Path(__file__).resolve().parents[1]


def test_the_file_is_what_the_script_writes():
    assert FILE == ROOT / "docs" / "notebook.ipynb"
    assert FILE.read_text(encoding="utf-8") == notebook()


def test_it_has_the_form_of_a_notebook_and_no_outputs():
    document = json.loads(notebook())
    assert (document["nbformat"], document["nbformat_minor"]) == (4, 5)
    assert len(document["cells"]) == len(CELLS)
    assert len({cell["id"] for cell in document["cells"]}) == len(CELLS)
    assert {cell["cell_type"] for cell in document["cells"]} == {"markdown", "code"}
    for cell, source in zip(document["cells"], CELLS, strict=True):
        assert "".join(cell["source"]) == source
        if cell["cell_type"] == "code":
            assert (cell["outputs"], cell["execution_count"]) == ([], None)


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, str]:
    """Names after the last cell, and all that was printed or shown; with a fifth of the example's points."""
    import contextlib
    import io

    import matplotlib

    matplotlib.use("Agg")
    thinner, example = thinner_example(tmp_path_factory.mktemp("scan"), 5), gw.example
    names: dict = {}
    out = io.StringIO()
    with contextlib.redirect_stdout(out), pytest.MonkeyPatch.context() as patch:
        patch.setattr(gw, "example", lambda name="design.toml": thinner if name == "scan.ply.gz" else example(name))
        for cell in json.loads(notebook())["cells"]:
            if cell["cell_type"] == "code":
                run(("".join(cell["source"])), names)
    return names, out.getvalue()


def run(source: str, names: dict) -> None:
    """As a kernel does: the value of a last expression is shown."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    if last is not None:
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
        if value is not None:
            print(repr(value))  # noqa: T201


def test_the_effects_are_named_and_their_sizes_cover_the_truth(ran):
    names, _ = ran
    truth = {effect["name"]: effect["parameters"] for effect in names["truth"]["effects"]}
    found = {effect.name: effect.parameters for effect in names["measured"].loop.effects}
    assert set(found) == set(truth)
    for effect, parameters in truth.items():
        for name, value in parameters.items():
            estimate = found[effect][name]
            assert abs(estimate.value - value) <= 3.0 * estimate.std, (effect, name)


def test_the_wear_is_that_of_the_truth_and_was_not_before_the_loop(ran):
    names, said = ran
    truth, wear = names["truth"]["volume_mm3"], names["wear"]
    assert abs(wear.volume - truth) < 3.0 * wear.volume_std
    without = float(re.search(r"without the loop: ([\d.]+) mm³", said)[1])
    assert abs(without - truth) > 5.0 * wear.volume_std


def test_the_figures_are_drawn(ran):
    names, _ = ran
    for figure in (names["before"], names["after"]):
        axis, bar = figure.axes[:2]
        assert axis.images
        assert "µm" in (bar.get_ylabel() + bar.get_xlabel())
    import matplotlib.pyplot as plt

    plt.close("all")


def test_nothing_that_is_shown_is_a_dump(ran):
    said = ran[1]
    assert "array(" not in said
    assert max(map(len, said.splitlines())) < 220
    assert len(said.splitlines()) < 80
