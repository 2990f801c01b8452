from dataclasses import replace

import numpy as np

from gearwear.design.surface import FILLET, ROOT
from gearwear.diagnose.effects.root_form import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, fillet_edges

LEVELS = (12.0, -8.0, 25.0, 40.0)
EXAMPLES = [
    Example({"level_um": LEVELS[:count]}, tuple(1e-3 * level for level in LEVELS[:count]), gear=gear)
    for gear, count in ((BORED, 4), (ODD, 3))  # fillets that meet leave no bottom land
]


def displace(sample, parameters, shape):
    """Each ring of the fillets and the bottom lands pushed out by its own level."""
    gear, level = sample.gear, 1e-3 * np.array(parameters["level_um"])
    inner = fillet_edges(gear)[1:-1]
    column = (sample.radius[:, None] >= inner).sum(axis=1)
    return sample.pushed(np.where(sample.surface == FILLET, level[column], np.where(sample.surface == ROOT, level[-1], 0.0)))


def test_every_root_point_has_one_level_and_no_other_point_has_any():
    points = feet()
    basis = EFFECT.basis(points, context(), ())
    np.testing.assert_array_equal(basis.sum(axis=1), np.isin(points.surface, (FILLET, ROOT)))
    np.testing.assert_array_equal(basis[:, -1], points.surface == ROOT)


def test_both_sides_and_all_teeth_share_it():
    """A turn by a tooth and a mirror leave it as it is: its field depends on the radius alone."""
    points = feet()
    field = EFFECT.basis(points, context(), ()) @ np.array(EXAMPLES[0].amplitudes)
    fillet = points.surface == FILLET
    radius = np.round(np.hypot(*points.position[fillet, :2].T), 9)
    for one in np.unique(radius):
        assert np.ptp(field[fillet][radius == one]) == 0.0


def test_what_was_not_seen_has_no_column():
    whole = context()
    lands = replace(whole, surfaces=frozenset({ROOT}))
    assert EFFECT.basis(feet(), lands, ()).shape[1] == 1
    assert EFFECT.basis(feet(), replace(whole, surfaces=whole.surfaces - {ROOT}), ()).shape[1] == len(LEVELS) - 1


def test_needs_the_columns_of_the_fillets():
    assert EFFECT.applies(context())
    assert not EFFECT.applies(replace(context(), fillet_edges=()))
