"""Whether a relief has a knee: forms put in by closed formulas, on cells of a plain scan."""

import numpy as np
import pytest

from gearwear.design.surface import FLANK
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import build_dictionary
from gearwear.diagnose.effects.end_relief import EFFECT as END_RELIEF
from gearwear.diagnose.effects.profile_slope import EFFECT as SLOPE
from gearwear.diagnose.effects.root_relief import EFFECT as ROOT_RELIEF
from gearwear.diagnose.effects.tip_relief import EFFECT as TIP_RELIEF
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.loop import make_context
from gearwear.diagnose.smooth_form import as_smooth_form
from tests.diagnose.core.test_worn_sides import PINION, binned

NOISE = 0.002
"""Of a cell, mm."""


@pytest.fixture(scope="module")
def cells():
    return binned(())


def along(cells):
    """−1 at the form circle, 1 at the tip; 0 off the flanks."""
    roll, (low, high) = cells.points.roll, (PINION.form_roll, PINION.tip_roll)
    return np.where(cells.points.surface == FLANK, 2.0 * (np.nan_to_num(roll) - low) / (high - low) - 1.0, 0.0)


def told(cells, form, relief, *besides):
    """What the best of a relief's candidates may be instead, of flanks with a form (m,), mm, beside other effects."""
    context = make_context(cells, np.eye(3), False)
    dictionary = build_dictionary(cells, (relief, *besides), context)
    target = np.where(cells.seen, form + np.random.default_rng(2).normal(0.0, NOISE, len(form)), 0.0)
    fit = Fit(cells, target, dictionary, cells.seen, CellCovariance(cells.grid, np.full(len(form), NOISE**2), 0.0, 0.0, 0.0))
    problem, found = fit.problem(1.0, context), dictionary.candidates
    beside = tuple(next(one for one in found if one.name == other.name) for other in besides)
    reliefs = [one for one in found if one.name == relief.name]
    best = max(reliefs, key=lambda one: problem.gram.gains(problem.columns(beside), [one.columns])[0])
    return as_smooth_form(fit, problem, (*beside, best), len(beside))


@pytest.mark.parametrize(("relief", "knee"), [(TIP_RELIEF, 0.5), (ROOT_RELIEF, -0.5)], ids=["tip", "root"])
@pytest.mark.parametrize("besides", [(), (SLOPE,)], ids=["alone", "beside slopes"])
def test_a_knee_that_is_seen_is_no_smooth_form(cells, relief, knee, besides):
    u = along(cells)
    assert told(cells, -0.02 * np.maximum(np.sign(knee) * u - abs(knee), 0.0) / 0.5, relief, *besides) == ()


@pytest.mark.parametrize(("relief", "towards"), [(TIP_RELIEF, 1.0), (ROOT_RELIEF, -1.0)], ids=["tip", "root"])
def test_flanks_that_fall_off_evenly_may_be_crowned(cells, relief, towards):
    """A crowning on a slope, whichever end it begins at, has no third order: where the slope is explained it is a crowning alone."""
    u = towards * along(cells)
    assert told(cells, -0.004 * (u**2 + 2.0 * u), relief, SLOPE) == ("profile_crowning",)


def test_a_smooth_form_that_needs_a_slope_names_it(cells):
    """The relief falls off from where it begins to the tip; a crowning alone would have to rise to its middle first."""
    u = along(cells)
    assert told(cells, -0.004 * (u**2 + 2.0 * u), TIP_RELIEF) == ("profile_crowning", "profile_slope")
    assert told(cells, -0.004 * u**2, TIP_RELIEF) == ("profile_crowning",)


def test_a_knee_that_noise_hides_may_be_a_smooth_form(cells):
    """A fiftieth of the relief whose knee is seen: it fits no worse than a smooth form, and no better by what chance makes."""
    assert told(cells, -0.0004 * np.maximum(along(cells) - 0.5, 0.0) / 0.5, TIP_RELIEF, SLOPE) == ("profile_crowning",)


def test_only_reliefs_of_the_profile_are_asked(cells):
    assert told(cells, -0.004 * (along(cells) + 1.0) ** 2, END_RELIEF) == ()
