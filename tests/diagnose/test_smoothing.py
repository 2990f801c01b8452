from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects import named_effects
from gearwear.diagnose.effects.smoothing import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet, sample

EXAMPLES = [Example({"sag_um": 20.0}, (0.02,)), Example({"sag_um": 5.0}, (0.005,), gear=ODD)]


def displace(sample, parameters, shape):
    """Along the normal by the curvature of each surface, over that of a flank at the reference circle; fillets and ends stay."""
    o = sample.outline
    pitch = 0.5 * o.numbers.module * o.teeth * np.sin(np.radians(o.numbers.pressure_angle_deg))
    radius = np.full(len(sample), np.inf)
    radius[sample.flank] = sample.roll[sample.flank]
    round_ones = np.isin(sample.surface, (2, 3))  # roots and tips
    radius[round_ones] = sample.radius[round_ones]
    radius[sample.surface == 6] = -sample.radius[sample.surface == 6]  # the bore is hollow
    return sample.pushed(-1e-3 * parameters["sag_um"] * pitch / radius)


@pytest.mark.parametrize("roll", [6.0, 13.03, 24.0])
def test_a_flank_sinks_as_the_mean_over_a_disc_does(roll):
    """Averaged numerically, over an involute rolled off: a² / (8 L) below the point, to what the change of L within the disc makes of it."""
    radius, base = 0.4, sample().gear.base_radius
    rolls, heights = np.meshgrid(roll + np.linspace(-3.0, 3.0, 24001), np.linspace(-radius, radius, 81))
    angle = rolls / base
    x, y = base * (np.cos(angle) + angle * np.sin(angle)), base * (np.sin(angle) - angle * np.cos(angle))
    at = roll / base
    apart = x - base * (np.cos(at) + at * np.sin(at)), y - base * (np.sin(at) - at * np.cos(at))
    within = apart[0] ** 2 + apart[1] ** 2 + heights**2 < radius**2
    area = rolls[within]  # of a strip of roll: L dL / r_b
    below = -(apart[0] * np.sin(at) - apart[1] * np.cos(at))[within]  # along the base tangent, into the tooth
    sunk = abs(float((area * below).sum() / area.sum()))
    foot = flank_points(context().gear, np.zeros(1, int), np.ones(1, int), np.array([roll]), np.array([4.0]))
    reference = context().gear.reference_roll
    told = -(radius**2) / (8.0 * reference) * float(EFFECT.basis(foot, context(), ())[0, 0])
    assert told == pytest.approx(sunk, rel=0.02)


def test_it_is_sought_where_a_scan_was_smoothed_and_a_bias_of_the_beam_is_not():
    """Both sink flanks most at their roots, and of a scan that was smoothed it is known which of them did."""
    bias, about = named_effects()["incidence_bias"], context()
    assert not EFFECT.applies(about) and bias.applies(about)
    smoothed = replace(about, smoothed=True)
    assert EFFECT.applies(smoothed) and not bias.applies(smoothed)


def test_a_mean_over_more_than_edges_and_fillets_bear_is_none():
    """A radius of 0.3 modules sinks the paper's pinion by (0.3 · 6.35)² / (8 · 13.03) mm, 34.8 µm, and no export does more."""
    assert EFFECT.allowed(np.array([0.0347]), (), context())
    assert not EFFECT.allowed(np.array([0.0350]), (), context())
    assert not EFFECT.allowed(np.array([-0.001]), (), context())


def test_plane_ends_and_fillets_stay():
    points = feet()
    others = ~np.isin(points.surface, (0, 2, 3, 6))
    assert others.any() and (EFFECT.basis(points, context(), ())[others] == 0.0).all()
