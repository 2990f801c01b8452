from dataclasses import replace

import numpy as np

from gearwear.design.surface import FILLET, FLANK, ROOT
from gearwear.diagnose.effects.root_form import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, fillet_edges

LEVELS, LOWER_END = (12.0, -8.0, 25.0, 40.0), (-30.0, -22.0, -6.0)
EXAMPLES = [
    Example({"level_um": levels}, tuple(1e-3 * level for level in levels), gear=gear)
    for gear, levels in (
        (BORED, (*LEVELS, *LOWER_END)),
        (ODD, (*LEVELS[:3], *LOWER_END)),
    )  # fillets that meet leave no bottom land
]


def along_fillet(radius, edges, level):
    """Two straight lines through three levels in the middles of rings: each a level and a lean."""
    out, at = (np.sqrt(np.maximum(r - edges[0], 0.0)) for r in (edges, radius))
    one, two, three = 0.5 * (out[1:] + out[:-1])
    low = level[0] + (level[1] - level[0]) * (at - one) / (two - one)
    return np.where(at < two, low, level[1] + (level[2] - level[1]) * (at - two) / (three - two))


def displace(sample, parameters, shape):
    """The fillets pushed out by levels in the middles of their rings, straight between and beyond them along the way out of the bottom lands, and these
    by their own; the lowest 30 % of the flanks bent in."""
    gear, every = sample.gear, 1e-3 * np.array(parameters["level_um"])
    level, bent = every[:-3], every[-3:]
    pushed = np.where(
        sample.surface == FILLET,
        along_fillet(sample.radius, fillet_edges(gear), level),
        np.where(sample.surface == ROOT, level[-1], 0.0),
    )
    outline = sample.outline
    knots = np.linspace(outline.form_roll**2, (0.7 * outline.form_roll + 0.3 * outline.tip_roll) ** 2, 4)
    flank = np.interp(np.nan_to_num(sample.roll) ** 2, knots, [*bent, 0.0])
    return sample.pushed(np.where(sample.surface == FLANK, flank, pushed))


def test_every_root_point_has_one_level_and_no_other_point_off_the_flanks_has_any():
    points = feet()
    basis = EFFECT.basis(points, context(), ())
    off = points.surface != FLANK
    np.testing.assert_allclose(basis.sum(axis=1)[off], np.isin(points.surface, (FILLET, ROOT))[off], atol=1e-12)
    np.testing.assert_array_equal(basis[:, len(LEVELS) - 1], points.surface == ROOT)


def test_the_upper_flank_is_not_the_roots():
    points, gear = feet(), context().gear
    high = (points.surface == FLANK) & (points.roll > gear.form_roll + 0.3 * (gear.tip_roll - gear.form_roll))
    assert high.any()
    assert not EFFECT.basis(points, context(), ())[high].any()


def test_both_sides_and_all_teeth_share_it():
    """A turn by a tooth and a mirror leave it as it is: its field depends on the radius alone."""
    points = feet()
    field = EFFECT.basis(points, context(), ()) @ np.array(EXAMPLES[0].amplitudes)
    fillet = points.surface == FILLET
    radius = np.round(np.hypot(*points.position[fillet, :2].T), 9)
    for one in np.unique(radius):
        assert np.ptp(field[fillet][radius == one]) < 1e-9


def test_what_was_not_seen_has_no_column():
    whole = context()
    lands = replace(whole, surfaces=frozenset({ROOT}))
    assert EFFECT.basis(feet(), lands, ()).shape[1] == 1
    assert EFFECT.basis(feet(), replace(whole, surfaces=whole.surfaces - {ROOT}), ()).shape[1] == len(LEVELS) - 1 + len(LOWER_END)


def test_needs_the_columns_of_the_fillets():
    assert EFFECT.applies(context())
    assert not EFFECT.applies(replace(context(), fillet_edges=()))


def test_one_ring_alone_has_a_level():
    """What was seen of the fillets may be one ring of little height: a lean would be told by nothing."""
    about = context()
    one = replace(about, fillet_edges=about.fillet_edges[-2:])
    points = feet()
    np.testing.assert_array_equal(EFFECT.basis(points, one, ())[:, 0], points.surface == FILLET)
