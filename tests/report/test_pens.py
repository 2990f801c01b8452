"""Many curves as one artist: what is drawn on a sheet is what matplotlib's own calls draw."""

import io

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from gearwear.report.charts.pens import Pens, _thinned
from gearwear.report.charts.sheet import sheet

LOOK = {"color": "#888888", "alpha": 0.2, "lw": 0}


@pytest.fixture
def outline():
    y = np.linspace(20.0, 90.0, 200)
    return y, 30.0 + np.sin(y), 40.0 + np.cos(y)


def written(figure):
    buffer = io.StringIO()
    FigureCanvasSVG(figure)
    with rc_context({"svg.hashsalt": "the same of both"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def test_areas_are_drawn_as_patches_are_and_nobody_asks_how_far_they_reach(outline):
    y, low, high = outline
    one, other = Figure(), Figure()
    page, pens = sheet(one, 210.0), Pens({"spread": LOOK}, {})
    pens.area("spread", y, low, high)
    pens.draw(page)
    closed = np.concatenate([np.column_stack([low, y]), np.column_stack([high, y])[::-1], [[low[0], y[0]]]])
    sheet(other, 210.0).add_patch(PathPatch(Path.make_compound_path(_thinned(closed)), **LOOK))
    assert not np.isfinite(page.dataLim.get_points()).any()
    assert written(one) == written(other)
