"""Rigid contact against other ways to say the same: overlapping polygons, brute force, the linear model."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import CrossSection, FillRule

from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.linear import linear_contact
from gearwear.meshing.path import path_of_contact
from tests.meshing.worn import design, roll_of, rough, sliding_like, wear

C = 114.3


def outline(profiles, points=2000):
    """The whole transverse section as a polygon, (n, 2) mm: half angles linear in deviation between the radii."""
    gear = profiles.gear
    radius = np.unique(np.append(profiles.radius, np.linspace(profiles.radius[0], profiles.radius[-1], points)))
    excess = profiles.half_angle[:, :, 0] - gear.half_angle(profiles.radius)
    nominal, parts = gear.half_angle(radius), []
    for k in range(gear.teeth):
        left, right = (nominal + np.interp(radius, profiles.radius, excess[k, s]) for s in (0, 1))
        land = np.linspace(-right[-1], left[-1], 60)[1:-1]
        angle = k * gear.pitch_angle + np.concatenate([-right, land, left[::-1]])
        r = np.concatenate([radius, np.full(58, radius[-1]), radius[::-1]])
        parts.append(r[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.vstack(parts)


def turned(polygon, angle, shift=0.0):
    cos, sin = np.cos(angle), np.sin(angle)
    return CrossSection([polygon @ np.array([[cos, sin], [-sin, cos]]) + [shift, 0.0]], FillRule.Positive)


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(
            lambda pinion, wheel: (rough(design(pinion), 11, 0.05), rough(design(wheel), 12, 0.05)), marks=pytest.mark.long
        ),
        lambda pinion, wheel: (wear(design(pinion), 1.872, [0]), design(wheel)),
        pytest.param(
            lambda pinion, wheel: (wear(design(pinion), sliding_like, [0, 1]), wear(design(wheel), 0.3, [0, 23])),
            marks=pytest.mark.long,
        ),
    ],
    ids=["rough", "one tooth worn away", "both worn"],
)
def test_sections_touch_and_do_not_overlap(pinion, wheel, make):
    """Turned to where they touch the two polygons do not overlap; 2 µm further, either way, they do."""
    own, mate = make(pinion, wheel)
    result = mesh_contact(own, mate, C, positions_per_pitch=3)
    one, two = outline(own), outline(mate)
    for at in (1, 34):
        turn = result.rotation[at]
        ahead = turn * 12 / 24 + result.transmission_error[at] / wheel.base_radius
        behind = ahead + result.backlash[at] / wheel.base_radius

        def overlap(lead, turn=turn):
            # Driven tooth 0 stands half a pitch past the line of centres, which points back from the driven axis.
            return (turned(one, turn) ^ turned(two, np.pi - np.pi / 24 - lead, C)).area()

        far = 0.002 / wheel.base_radius
        assert overlap(ahead - far) > 0.0
        assert overlap(behind + far) > 0.0
        if result.backlash[at] > 0.001:
            # Polygons of 2000 radii cut or add at most h²/(8 R) = 2e-6 mm over less than 1 mm of contact.
            assert overlap(ahead) < 3e-6
            assert overlap(behind) < 3e-6


@pytest.mark.long
def test_a_dense_look_finds_nothing_more(pinion, wheel):
    """The search between samples against a hundred thousand samples, on flanks as rough as a scan."""
    own, mate = rough(design(pinion), 21), rough(design(wheel), 22)
    result = mesh_contact(own, mate, C, positions_per_pitch=2)
    radius = np.linspace(pinion.root_radius, pinion.tip_radius, 100_001)
    excess = [p.half_angle[:, 0, 0] - p.gear.half_angle(p.radius) for p in (own, mate)]
    nominal = pinion.half_angle(radius)
    for at in range(0, 24, 5):
        lead = []
        for k in range(-at // 2 - 2, -at // 2 + 4):
            angle = result.rotation[at] + k * pinion.pitch_angle
            theta = angle + nominal + np.interp(radius, own.radius, excess[0][k % 12])
            x, y = C - radius * np.cos(theta), radius * np.sin(theta)
            rho = np.hypot(x, y)
            inside = (rho <= wheel.tip_radius) & (x > 0.0)
            if inside.any():
                w = wheel.half_angle(rho[inside]) + np.interp(rho[inside], mate.radius, excess[1][-k % 24])
                centre = np.arctan2(y, x)[inside] + w
                lead.append(wheel.base_radius * (centre.max() - np.pi / 24 - angle / 2))
        found = result.transmission_error[at]  # no backlash at this distance: lead and error are one
        # The dense look misses h²/(8 R) < 1e-8 mm where it is smooth, 1e-5 mm where corners touch (slope × h).
        assert max(lead) - found < 1e-8
        assert found - max(lead) < 1e-4


@pytest.mark.long
def test_result_does_not_depend_on_the_radii(pinion, wheel):
    """Wear linear in the radius is the same on any radii, and fine ones find what coarse ones find."""
    results = []
    for radii in (15, 40, 300):
        own = design(pinion, radii)
        ramp = 0.2 * (own.radius - pinion.root_radius) / (pinion.tip_radius - pinion.root_radius)
        results.append(mesh_contact(wear(own, ramp, range(0, 12, 2)), design(wheel, radii), C, positions_per_pitch=5))
    for other in results[1:]:
        np.testing.assert_allclose(other.transmission_error, results[0].transmission_error, atol=1e-8)
        np.testing.assert_allclose(other.backlash, results[0].backlash, atol=1e-8)


def bulged(gear, start, end, size, random):
    """Bulged in the middle of the path by another amount on every flank and slice, relieved at its ends."""
    own = design(gear, 400, slices=3)
    u = np.clip((roll_of(own) - start) / (end - start), 0.0, 1.0)
    amplitude = size * random.uniform(0.3, 1.0, (gear.teeth, 2, 3, 1))
    shape = amplitude * np.sin(np.pi * u) ** 2 - size * (2.0 * u - 1.0) ** 8
    return replace(own, half_angle=own.half_angle + shape / gear.base_radius)


@pytest.mark.long
@pytest.mark.parametrize("side", [Side.LEFT, pytest.param(Side.RIGHT, marks=pytest.mark.long)])
def test_small_gentle_deviations_agree_with_the_linear_model(pinion, wheel, side):
    """Contact moves by R δ' along the flank, which adds R δ'²/2: the models part with the square of the size."""
    path, apart = path_of_contact(pinion, wheel, C), []
    for size in (0.0005, 0.001, 0.002):
        random = np.random.default_rng(3)
        own = bulged(pinion, path.start_pinion, path.end_pinion, size, random)
        mate = bulged(wheel, path.start_gear, path.end_gear, size, random)
        exact, linear = (solve(own, mate, C, side, positions_per_pitch=3) for solve in (mesh_contact, linear_contact))
        more = exact.transmission_error - linear.transmission_error
        assert more.min() > -1e-7  # what is added is never less than nothing
        np.testing.assert_allclose(linear.backlash - exact.backlash, more, atol=2.0 * more.max())
        assert more.max() < 0.01 * np.ptp(linear.transmission_error)
        apart.append(more.max())
    assert apart[1] / apart[0] == pytest.approx(4.0, rel=0.05)
    assert apart[2] / apart[1] == pytest.approx(4.0, rel=0.05)


def test_linear_model_of_uniform_wear_is_exact(pinion, wheel):
    result = linear_contact(wear(design(pinion), 0.1, range(12)), design(wheel), 115.0)
    np.testing.assert_allclose(result.transmission_error, -0.1, atol=1e-12)
    perfect = linear_contact(design(pinion), design(wheel), 115.0)
    np.testing.assert_allclose(result.backlash - perfect.backlash, 0.1, atol=1e-12)


def test_linear_model_needs_a_pair_at_every_phase(pinion, wheel):
    with pytest.raises(InputError, match=r"contact ratio 0\.\d+: the linear model needs at least 1"):
        linear_contact(design(pinion), design(wheel), 118.5)


@pytest.mark.long
def test_slices_are_independent_of_each_other(pinion, wheel):
    """The rigid pair leads by the greatest lead of its slices taken alone."""
    own, mate = rough(design(pinion, slices=3), 31), rough(design(wheel, slices=3), 32)
    together = mesh_contact(own, mate, C, positions_per_pitch=2)
    alone = []
    for i in range(3):
        one, two = (nominal_profiles(p.gear, p.radius, p.z[i : i + 1]) for p in (own, mate))
        one, two = (replace(n, half_angle=p.half_angle[:, :, i : i + 1]) for n, p in ((one, own), (two, mate)))
        alone.append(mesh_contact(one, two, C, positions_per_pitch=2).transmission_error)
    np.testing.assert_allclose(together.transmission_error, np.max(alone, axis=0), atol=1e-12)
