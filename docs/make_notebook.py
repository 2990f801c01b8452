"""Write ``docs/notebook.ipynb`` from the cells below, without outputs: ``python docs/make_notebook.py``.

tests/test_notebook.py runs the cells and holds the file to what this script writes.
"""

from __future__ import annotations

import json
from pathlib import Path

FILE = Path(__file__).with_name("notebook.ipynb")

CELLS = (
    """# From a scan to a named effect

A used pinion was scanned. What differs from the design is a mixture: metal that is gone, a coat of spray, and whatever the scanner and the
maker added. This notebook takes the mixture apart, step by step, on the example that comes with gearwear. The example is simulated, so the
truth is known and stands beside it.""",
    """import json

import matplotlib.pyplot as plt
import numpy as np

import gearwear as gw

design = gw.read_design(gw.example("design.toml"))
(scan,) = gw.read_scan(gw.example("scan.ply.gz"))
scan""",
    """## Where does it lie?

No starting guess is needed. The flanks that look worn are left out of the fit; the note says which, and what is assumed.""",
    """measured = gw.register(design, scan)
measured.placed.registration""",
    """The deviation of every point from the exact flank, averaged over cells of half a millimetre. Blue is missing metal, red is too much. One
picture per flank, root to the left, tip to the right.""",
    """from gearwear.report.figures.colours import colour_scale


def flank_maps(measured, cells, title):
    deviation = 1e3 * measured.cells.grid.flank_shape(cells.points.deviation)
    scale = colour_scale(np.clip(deviation, -60.0, 60.0))
    figure, (axis, bar) = plt.subplots(1, 2, figsize=(11, 3), width_ratios=[60, 1])
    gw.figures.flank_map(axis, deviation, scale)
    gw.figures.colour_bar(bar, scale)
    axis.set_title(title)
    return figure


before = flank_maps(measured, measured.cells, "as measured")""",
    """The right flanks, which carry no load, are red all over and in waves. That is not wear. What is it?

## What else is in the scan?

The closed loop tries every effect of its catalogue, keeps those that explain the scan beyond chance, on teeth left out of the fit as well,
and says what cannot be told apart.""",
    """measured = gw.find_effects(measured)
measured.loop""",
    """for effect in measured.loop.effects:
    print(effect, end="\\n\\n")""",
    """Named are the coat and an error of the turntable, each with its size. The truth of the example:""",
    """truth = json.loads(gw.example("truth.json").read_text(encoding="utf-8"))
truth["effects"]""",
    """found = {effect.name: effect.parameters for effect in measured.loop.effects}
for effect in truth["effects"]:
    for name, value in effect["parameters"].items():
        estimate = found[effect["name"]][name]
        print(f"{effect['name']:<16} {name:<14} put in {value:8.3f}   found {estimate.value:8.3f} ± {estimate.std:.3f}")""",
    """## What is left is wear

With both taken out, the right flanks are on the design within the scatter of the scan.""",
    """after = flank_maps(measured, measured.corrected, "what the scanner added is taken out")""",
    """wear = gw.find_wear(measured)
wear""",
    """print(f"removed in truth: {truth['volume_mm3']:.2f} mm³; found: {wear.volume:.2f} ± {wear.volume_std:.2f} mm³")
print(f"taken for wear without the loop: {gw.find_wear(gw.register(design, scan)).volume:.2f} mm³")""",
    """## Further

`gw.compare(design, scan_file)` does all of this and the rest – thickness, solids, meshing, inspection – in one go, and `gw.write` puts it into
a folder as the command `gearwear compare` does. Without a design, `gw.propose_design(scan)` finds one.""",
)


def notebook() -> str:
    """The file's text; cells that begin with a heading or a capital letter and hold no code are text."""
    cells = []
    for number, source in enumerate(CELLS):
        lines = source.splitlines(keepends=True)
        cell = {"cell_type": "markdown", "id": f"cell-{number}", "metadata": {}, "source": lines}
        if _is_code(source):
            cell |= {"cell_type": "code", "execution_count": None, "outputs": []}
        cells.append(cell)
    document = {
        "cells": cells,
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _is_code(source: str) -> bool:
    try:
        compile(source, "cell", "exec")
    except SyntaxError:
        return False
    return not source.startswith("#")


if __name__ == "__main__":
    FILE.write_text(notebook(), encoding="utf-8")
