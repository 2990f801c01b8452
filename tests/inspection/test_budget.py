"""The budget: type B terms against closed forms, and the parts against the whole."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec, parse_design
from gearwear.design.surface import locate
from gearwear.inspection import Settings, inspect
from gearwear.inspection.budget import with_scale
from gearwear.inspection.ranges import profile_range
from tests.inspection.synthetic import displaced, flanks

S = 100e-6
GEAR = Gear.from_spec(GearSpec("gear", 20, 3.0, 20.0))


@pytest.fixture(scope="module")
def found():
    points = flanks(GEAR, 60, 12)
    rng = np.random.default_rng(5)
    points = displaced(points, rng.normal(0.0, 0.004, len(points)), GEAR)
    pose = np.diag([1e-6, 1e-6, 1e-6, 1e-10, 1e-10, 1e-10])
    return {scale: inspect(points, GEAR, Settings(noise=0.004, pose_covariance=pose, scale_std=scale)) for scale in (0.0, S)}


def _line(inspection, quantity):
    return next(line for line in inspection.budget if line.quantity == quantity)


def test_a_scale_is_a_profile_slope_of_s_times_the_range(found):
    """A flank at L moves by s L along its normal: f_Hα = s L_α; a helix, a pitch and an index do not move."""
    length = profile_range(GEAR).length
    assert _line(found[S], "profile slope").scale == pytest.approx(S * length, rel=1e-3)
    assert _line(found[S], "helix slope").scale < 5e-5  # the mean L of a bin varies by chance
    assert _line(found[S], "single pitch").scale < 1e-9
    thickness = 2.0 * S * GEAR.reference_radius * math.tan(GEAR.transverse_pressure_angle)
    assert _line(found[S], "tooth thickness").scale == pytest.approx(thickness, rel=5e-3)


def test_the_gear_scaled_itself_shows_what_the_budget_says():
    """The same by moving every point of the gear: a scan that is 100 ppm too large."""
    points = flanks(GEAR, 60, 12)
    middle = np.array([0.0, 0.0, 0.5 * GEAR.face_width])
    grown = locate((points.position - middle) * (1.0 + S) + middle, GEAR, workers=1)
    slope = inspect(grown, GEAR, Settings(noise=1e-6)).profile.slope.value
    assert np.nanmean(slope) == pytest.approx(S * profile_range(GEAR).length, rel=5e-3)


def test_helical_flanks_have_a_helix_slope_by_scale():
    gear = Gear.from_spec(GearSpec("gear", 20, 3.0, 20.0, helix_angle=math.radians(20.0)))
    points = flanks(gear, 60, 12)
    line = _line(inspect(points, gear, Settings(noise=0.004, scale_std=S)), "helix slope")
    evaluated = 20.0 - 2.0 * min(0.05 * 20.0, 3.0)
    assert line.scale == pytest.approx(S * evaluated * math.tan(gear.base_helix_angle), rel=5e-3)


def test_the_parts_are_the_whole(found):
    for quantity in ("profile slope", "helix slope", "single pitch", "tooth thickness"):
        line = _line(found[S], quantity)
        whole = 2.0 * math.sqrt(line.own**2 + line.registration**2 + line.scale**2)
        assert line.expanded == pytest.approx(whole, rel=1e-9)


@pytest.mark.long
def test_a_scale_makes_totals_unsure_as_type_b_and_forms_not():
    """On a flank whose slope is large already, a scale moves the total by s L_α as it does the slope; the form about its line it does not."""
    points, scale = flanks(GEAR, 60, 12), 1e-3
    for lean, share in ((0.2, 1.0), (0.0, math.sqrt(1.0 - 2.0 / math.pi))):  # |x| of a normal x where there is no slope
        off = lean * (points.own_roll(GEAR) - GEAR.reference_roll) / profile_range(GEAR).length
        noisy = displaced(points, off + np.random.default_rng(5).normal(0.0, 0.001, len(points)), GEAR)
        found = inspect(noisy, GEAR, Settings(noise=0.001, scale_std=scale))
        total, form = (_line(found, f"profile {part}") for part in ("total", "form"))
        assert total.scale == pytest.approx(
            share * scale * profile_range(GEAR).length, rel=0.2
        )  # the whole is known from 128 draws
        assert total.own < 0.5 * total.scale
        assert form.scale < 0.02 * total.scale


def test_spans_grow_with_the_scale(found):
    plain, scaled = (found[s].dimensions.span_lengths for s in (0.0, S))
    np.testing.assert_allclose(np.sqrt(scaled.standard**2 - plain.standard**2), S * plain.value, rtol=1e-6)


@pytest.mark.parametrize(
    "spec",
    [
        pytest.param(GearSpec("gear", 20, 3.0, 20.0), marks=pytest.mark.long),
        GearSpec("gear", 13, 3.0, 20.0, profile_shift=0.3),
        pytest.param(GearSpec("gear", 21, 3.0, 20.0, helix_angle=math.radians(20.0)), marks=pytest.mark.long),
        pytest.param(GearSpec("gear", 40, 2.0, 20.0, internal=True), marks=pytest.mark.long),
    ],
    ids=["even", "odd", "helical", "ring"],
)
def test_dimensions_are_as_unsure_as_those_of_the_gear_scaled_itself_change(spec):
    """Every point moved: a scan that is 100 ppm too large; flanks are followed to first order, to 1e-3 of it."""
    gear = Gear.from_spec(spec)
    points, middle = flanks(gear, 40, 8), np.array([0.0, 0.0, 0.5 * gear.face_width])
    grown = locate((points.position - middle) * (1.0 + S) + middle, gear, workers=1)
    told, moved = (inspect(scan, gear, Settings(noise=1e-6, scale_std=s)).dimensions for scan, s in ((points, S), (grown, 0.0)))
    for name in ("pin_lengths", "thickness", *([] if spec.internal else ["span_lengths"])):
        before, after = (getattr(one, name) for one in (told, moved))  # the scatter of points adds some 1e-4 of it
        assert np.mean(before.standard) == pytest.approx(abs(np.mean(after.value - before.value)), rel=5e-3)


def test_without_a_scale_nothing_changes(found):
    covariance = np.eye(6)
    assert with_scale(covariance, 0.0) is covariance and with_scale(None, 0.0) is None
    for line in found[0.0].budget:
        assert line.scale == 0.0
    np.testing.assert_array_equal(found[0.0].profile.slope.value, found[S].profile.slope.value)


def test_instrument_and_temperature_add_in_squares():
    design = parse_design({
        "gear": {"teeth": 20, "module": 3.0, "face_width": 20.0}, "scanner": {"scale_std_ppm": 30.0},
        "datum": {"temperature_C": 23.0, "temperature_std_K": 2.0, "expansion_ppm_K": 20.0},
    })  # fmt: skip
    assert design.scale_std == pytest.approx(50e-6)


@pytest.mark.parametrize("scale", [None, S])
@pytest.mark.parametrize("pose", [None, np.diag([1e-6, 1e-6, 1e-6, 1e-10, 1e-10, 1e-10])], ids=["pose known", "pose unsure"])
def test_the_notes_say_the_registration_is_in_u_where_the_budget_has_it(scale, pose):
    found = inspect(flanks(GEAR, 60, 12), GEAR, Settings(noise=0.004, pose_covariance=pose, scale_std=scale))
    said = any("and the registration." in note for note in found.notes)
    assert said == (_line(found, "index").registration > 0.0) == (pose is not None)
