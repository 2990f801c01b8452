"""In the manner of PTB's test of evaluation software: whole gears with known deviations of every kind at once, asked back.

The points are written down from the involute's own equations in complex numbers; nothing here is shared with the evaluation but the numbers
of the gear. The expected values are closed forms, or plain polynomial fits of what was put in.
"""

from dataclasses import dataclass

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import locate
from gearwear.inspection import inspect

UM = 1e-3


@dataclass(frozen=True)
class Known:
    """What is put into a gear, mm; arrays are (teeth, 2), left first."""

    index: np.ndarray
    profile_slope: np.ndarray
    profile_crown: np.ndarray
    helix_slope: np.ndarray
    helix_crown: np.ndarray


def known(teeth: int, seed: int) -> Known:
    rng = np.random.default_rng(seed)
    index = np.repeat(rng.normal(0.0, 8 * UM, (teeth, 1)), 2, axis=1) + rng.normal(0.0, 2 * UM, (teeth, 2))
    return Known(index - index.mean(axis=0), *(rng.normal(0.0, 6 * UM, (teeth, 2)) for _ in range(4)))


def ranges(gear: Gear) -> tuple[float, float, float, float]:
    """L and z of the evaluation by the standard's rule, written down once more."""
    m, b = gear.spec.normal_module, gear.face_width
    start = gear.form_roll
    less = min(0.05 * b, m)
    return start, start + 0.95 * (gear.tip_roll - start), less, b - less


def cut(gear: Gear, put: Known, n_roll: int = 160, n_z: int = 40) -> np.ndarray:
    """Points of the gear (n, 3), in the middle of n_roll × n_z equal cells of every flank: both directions average apart."""
    shape = (gear.teeth, 2, n_roll, n_z)
    tooth, side, i, j = np.indices(shape)
    roll = gear.form_roll + (i + 0.5) / n_roll * (gear.tip_roll - gear.form_roll)
    z = (j + 0.5) / n_z * gear.face_width
    l0, l1, z0, z1 = ranges(gear)
    u, v = (roll - 0.5 * (l0 + l1)) / (l1 - l0), (z - 0.5 * (z0 + z1)) / (z1 - z0)
    hand = np.where(side == 0, 1.0, -1.0)  # left flanks look counter-clockwise
    pick = tooth, side
    alpha = gear.spec.normal_pressure_angle
    delta = hand * put.index[pick] * np.cos(alpha) + put.profile_slope[pick] * u - put.profile_crown[pick] * (2 * u) ** 2
    delta += hand * put.helix_slope[pick] * v - put.helix_crown[pick] * (2 * v) ** 2
    rb = 0.5 * gear.teeth * gear.spec.normal_module * np.cos(alpha)
    x = gear.spec.profile_shift
    half = (0.5 * np.pi + 2 * x * np.tan(alpha)) / gear.teeth + np.tan(alpha) - alpha  # of the tooth at the base circle
    turn = np.exp(1j * (2 * np.pi * tooth / gear.teeth + hand * (half - roll / rb)))
    point = turn * (rb + 1j * hand * (roll + delta))
    return np.stack([point.real, point.imag, z], axis=-1).reshape(-1, 3)


GEARS = [
    GearSpec("gear", 12, 6.35, 15.0, rack_tip_radius=0.25),
    GearSpec("gear", 25, 3.0, 30.0, profile_shift=0.3),
    GearSpec("gear", 40, 2.0, 20.0, np.radians(25.0), rack_tip_radius=0.2),
]
MORE_TEETH_ARE_LONG = [*GEARS[:2], pytest.param(GEARS[2], marks=pytest.mark.long)]


@pytest.fixture(params=MORE_TEETH_ARE_LONG, ids=lambda spec: f"z{spec.teeth}", scope="module")
def measured(request):
    gear = Gear.from_spec(request.param)
    put = known(gear.teeth, 7)
    return gear, put, inspect(locate(cut(gear, put), gear, workers=1), gear)


def test_slopes_and_crownings(measured):
    _, put, found = measured
    for name, slope, crown in (("profile", put.profile_slope, put.profile_crown), ("helix", put.helix_slope, put.helix_crown)):
        one = getattr(found, name)
        np.testing.assert_allclose(one.slope.value, slope, atol=0.1 * UM)
        np.testing.assert_allclose(one.crowning.value, crown, atol=0.1 * UM)


def parabola_form(crown):
    """max − min of a parabola about its least-squares line: its height."""
    return np.abs(crown)


def parabola_total(slope, crown):
    """max − min of slope · t − crown · (2 t)² over t from −½ to ½."""
    t = np.linspace(-0.5, 0.5, 2001)
    return np.ptp(slope[..., None] * t - crown[..., None] * (2 * t) ** 2, axis=-1)


def test_form_and_total_of_the_helix(measured):
    _, put, found = measured
    np.testing.assert_allclose(found.helix.form.value, parabola_form(put.helix_crown), atol=0.8 * UM)
    total = parabola_total(np.array([1.0, -1.0]) * put.helix_slope, put.helix_crown)
    np.testing.assert_allclose(found.helix.total.value, total, atol=0.8 * UM)


def profile_width(put, line):
    """Form (`line` 1, about the slope) or total (0) of every profile: beyond the evaluation range only what stands above counts, 5 % of the roll length
    further out."""
    t, out = np.linspace(-0.5, 0.5, 2001), np.linspace(0.5, 0.5 + 0.05 / 0.95, 200)
    slope, crown = (1.0 - line) * put.profile_slope[..., None], put.profile_crown[..., None]
    inside, beyond = (slope * at - crown * (2 * at) ** 2 for at in (t, out))
    return np.maximum(inside.max(-1), beyond.max(-1)) - inside.min(-1)


def test_form_and_total_of_the_profile_with_its_tip_zone(measured):
    _, put, found = measured
    for part, line in (("form", 1.0), ("total", 0.0)):
        np.testing.assert_allclose(getattr(found.profile, part).value, profile_width(put, line), atol=0.8 * UM)


def test_index_pitch_and_thickness(measured):
    gear, put, found = measured
    roll = found.pitch.roll
    l0, l1, _, _ = ranges(gear)
    hand = np.array([1.0, -1.0])
    alpha = gear.spec.normal_pressure_angle

    def at(place):
        """Mean deviation of every flank at a circle: over the helix range the crown is lower by a third of its height."""
        u = (place - 0.5 * (l0 + l1)) / (l1 - l0)
        return put.profile_slope * u - put.profile_crown * (2 * u) ** 2 - put.helix_crown / 3.0

    index = put.index + hand * at(roll) / np.cos(alpha)
    index -= index.mean(axis=0)
    np.testing.assert_allclose(found.pitch.index.value, index, atol=0.4 * UM)
    single = index - np.roll(index, 1, axis=0)
    np.testing.assert_allclose(found.pitch.single.value, single, atol=0.6 * UM)
    np.testing.assert_allclose(found.pitch.single_greatest.value, np.abs(single).max(axis=0), atol=0.6 * UM)
    np.testing.assert_allclose(found.pitch.cumulative.value, np.ptp(index, axis=0), atol=0.6 * UM)
    twice = np.abs(single - np.roll(single, 1, axis=0)).max(axis=0)
    np.testing.assert_allclose(found.pitch.adjacent.value, twice, atol=1.0 * UM)
    k = found.pitch.sector
    assert k == max(2, round(gear.teeth / 8))
    sectors = np.stack([np.roll(index, j, axis=0) for j in range(k + 1)])
    np.testing.assert_allclose(found.pitch.sector_greatest.value, np.ptp(sectors, axis=0).max(axis=0), atol=0.6 * UM)
    thinner = put.index[:, 0] - put.index[:, 1] + at(gear.reference_roll).sum(axis=1) / np.cos(alpha)
    m, x = gear.spec.normal_module, gear.spec.profile_shift
    nominal = m * (0.5 * np.pi + 2 * x * np.tan(alpha))
    np.testing.assert_allclose(found.dimensions.thickness.value, nominal + thinner, atol=0.8 * UM)


@pytest.mark.parametrize("spec", GEARS[:2], ids=lambda spec: f"z{spec.teeth}")
def test_eccentricity_flank_by_flank(spec):
    """A perfect gear beside its axis: every flank's slope and index, every ball, from the shift's own components."""
    gear, e, towards = Gear.from_spec(spec), 0.020, 0.7
    nothing = Known(*(np.zeros((gear.teeth, 2)) for _ in range(5)))
    points = cut(gear, nothing, n_z=8)
    points[:, :2] += e * np.array([np.cos(towards), np.sin(towards)])
    found = inspect(locate(points, gear, workers=1), gear)
    hand, rb = np.array([1.0, -1.0]), gear.base_radius
    tooth = np.arange(gear.teeth)[:, None]
    alpha = gear.spec.normal_pressure_angle
    half = (0.5 * np.pi + 2 * gear.spec.profile_shift * np.tan(alpha)) / gear.teeth + np.tan(alpha) - alpha

    def shift(roll):
        """The shift along the flanks' normals, (teeth, 2, n)."""
        turn = (2 * np.pi * tooth / gear.teeth + hand * half)[..., None] - hand[:, None] * np.atleast_1d(roll) / rb
        return hand[:, None] * e * np.sin(towards - turn)

    l0, l1, _, _ = ranges(gear)
    roll = np.linspace(l0, l1, 400)
    fit = np.polynomial.polynomial.polyfit(roll, shift(roll).reshape(-1, 400).T, 1)[1].reshape(gear.teeth, 2)
    np.testing.assert_allclose(found.profile.slope.value, fit * (l1 - l0), atol=0.1 * UM)
    assert np.abs(found.profile.slope.value).max() > 5 * UM
    index = hand * shift(found.pitch.roll)[..., 0] / np.cos(alpha)
    np.testing.assert_allclose(found.pitch.index.value, index - index.mean(axis=0), atol=0.1 * UM)
    ball = e * np.cos(towards - (np.arange(gear.teeth) + 0.5) * 2 * np.pi / gear.teeth)
    np.testing.assert_allclose(found.runout.radial.value, ball, atol=0.1 * UM)
    # span and pins are between flanks of the same gear: where it lies does not matter
    assert np.ptp(found.dimensions.span_lengths.value) < 0.1 * UM
    # two pins move with the gear as well; what is left is of second order, e² / r
    assert np.ptp(found.dimensions.pin_lengths.value) < 0.2 * UM
