import numpy as np
import pytest

from gearwear.diagnose.effects.profile_shift import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet
from tests.synthetic import Outline

EXAMPLES = [Example({"shift_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, 40.0), (ODD, -25.0))]


def displace(sample, parameters, shape):
    """The points of a gear cut with the rack further out, at the same roll lengths and rack positions; tips are turned before and stay."""
    base, module = sample.outline, sample.outline.numbers.module
    x = 1e-3 * parameters["shift_um"] / module
    old = base.numbers
    shifted = {"profile_shift": old.profile_shift + x, "addendum": old.addendum - x}
    other = Outline.of(type(old)(**{**{n: getattr(old, n) for n in old.__dataclass_fields__}, **shifted}))
    moved = sample.position.copy()
    angle = sample.tooth * base.pitch_angle
    tooth = np.column_stack([np.cos(angle), np.sin(angle)])
    across = np.column_stack([-tooth[:, 1], tooth[:, 0]])
    for mask, points in (
        (sample.flank, other.flank(sample.roll[sample.flank])[0]),
        (sample.surface == 1, _fillet(sample, other)),
    ):
        local = points * np.column_stack([np.ones(mask.sum()), sample.side[mask]])
        moved[mask, :2] = local[:, :1] * tooth[mask] + local[:, 1:] * across[mask]
    root = sample.surface == 2
    moved[root, :2] *= other.root_radius / base.root_radius
    return moved


def _fillet(sample, other):
    """Fillet points of the other gear at the same angle of the rack's tip arc."""
    base = sample.outline
    x = np.interp(sample.radius[sample.surface == 1], base.fillet_radius, base.fillet_offset)
    return other.fillet(x * other.rack_depth / base.rack_depth)[0]


def test_root_moves_by_the_shift_and_flanks_by_its_sine():
    points = feet()
    basis = EFFECT.basis(points, context(), ())[:, 0]
    np.testing.assert_allclose(basis[points.surface == 2], 1.0, rtol=1e-12)
    np.testing.assert_allclose(basis[points.surface == 0], np.sin(np.radians(20.0)), rtol=1e-12)
    assert basis[points.surface == 1].max() <= 1.0 and not basis[points.surface >= 3].any()


def test_fillet_runs_into_the_flank_where_the_gear_is_not_undercut():
    points = feet(ODD)
    gear = context(ODD).gear
    fillet = points.surface == 1
    radius = np.hypot(*points.position[fillet, :2].T)
    top = EFFECT.basis(points, context(ODD), ())[fillet, 0][np.argmax(radius)]
    phi = gear.fillet_phi(np.array([gear.form_radius]))[0]
    assert np.cos(phi) == pytest.approx(np.sin(np.radians(25.0)), abs=1e-9)
    assert np.cos(phi) < top < 1.0
