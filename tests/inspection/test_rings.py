"""Deviations of ISO 1328-1 on internal gears: signs towards the tip, which lies at the smaller roll, and lengths as on the drawing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import flank_points
from gearwear.errors import InputError
from gearwear.inspection.dimensions import measured_over_pins, over_pins
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.inspection import inspect
from gearwear.inspection.pitch import runout
from gearwear.inspection.ranges import profile_ends, profile_range
from gearwear.inspection.settings import Settings
from gearwear.report.files.inspection_columns import trace_columns
from gearwear.report.records.inspection import as_dict
from tests.inspection.synthetic import flanks

RING = Gear.from_spec(
    GearSpec(
        "gear", 42, 2.5, 14.0, profile_shift=0.1, addendum=0.8, helix_angle=math.radians(-20.0), internal=True, fillet_radius=0.5
    )
)
PROFILE, HELIX, PITCH = 0.02, 0.015, 0.03
"""mm along the transverse base tangent: over the profile from form circle to tip, over the face, and on one tooth."""


def inspected(**settings):
    tooth, side, roll, z = (
        a.ravel()
        for a in np.meshgrid(np.arange(42), [1, -1], np.linspace(RING.form_roll, RING.tip_roll, 60), np.linspace(0.02, 13.98, 70))
    )
    points = flank_points(RING, tooth.astype(int), side.astype(int), roll, z)
    to_tip = (roll - RING.form_roll) / (RING.tip_roll - RING.form_roll) - 0.5
    transverse = PROFILE * to_tip + side * HELIX * (z / 14.0 - 0.5) + np.where(tooth == 5, PITCH, 0.0)
    return inspect(points.with_deviation(RING.base_helix_cosine * transverse), RING, Settings(noise=0.001, **settings))


@pytest.mark.long
def test_slopes_rise_towards_the_tip_and_with_the_angle():
    found = inspected()
    form, tip = profile_ends(RING)
    assert form < tip < 0.0
    where = profile_range(RING)
    assert where.length == pytest.approx(0.95 * (RING.form_roll - RING.tip_roll))
    assert found.profile.slope.value == pytest.approx(PROFILE * 0.95, abs=3e-5)
    # Screwed to the right on a ring of left hand: its angle is too small.
    assert found.helix.slope.value == pytest.approx(-HELIX * found.helix.range.stated / 14.0, abs=3e-5)
    assert np.abs(found.profile.form.value).max() < 1e-4


@pytest.mark.long
def test_pitch_and_thickness_of_the_tooth_that_is_too_thick():
    """Its left flank lies further on, its right one further back, by δ / cos α_t of arc; r / r_b on the reference circle."""
    found = inspected()
    arc = PITCH / math.cos(RING.transverse_pressure_angle)
    left, right = found.pitch.single.value[5]
    assert (left, right) == (pytest.approx(arc, abs=1e-4), pytest.approx(-arc, abs=1e-4))
    more = found.dimensions.thickness.value - found.dimensions.thickness.value[20]
    assert more[5] == pytest.approx(2.0 * arc, abs=1e-4)
    assert np.abs(np.delete(more, 5)).max() < 1e-4
    tip, root = RING.tip_radius, RING.form_radius
    assert tip < math.hypot(RING.base_radius, found.pitch.roll) < root


def test_what_is_written_has_lengths_of_roll_as_on_the_drawing():
    found = inspected()
    record = as_dict(found)
    first, last = record["profile"]["range_roll_mm"]
    assert first == pytest.approx(RING.form_roll, abs=1e-4)
    assert last == pytest.approx(RING.form_roll - 0.95 * (RING.form_roll - RING.tip_roll), abs=1e-4)
    columns = trace_columns(found)
    assert columns["roll_mm"].min() > RING.tip_roll - 0.5 and columns["roll_mm"].max() < RING.form_roll + 0.5
    assert record["dimensions"]["span"] is None
    assert any("no span fits" in note for note in found.notes)


def test_bands_are_given_in_lengths_of_roll_too():
    low, high = RING.tip_roll + 2.0, RING.form_roll - 2.0
    found = inspected(helix_band=(low, high), control_roll=RING.form_roll - 1.0)
    assert sorted(map(abs, found.helix.band)) == [pytest.approx(low), pytest.approx(high)]
    assert found.profile.range.start == pytest.approx(-RING.form_roll + 1.0)
    assert found.helix.slope.value == pytest.approx(-HELIX * found.helix.range.stated / 14.0, abs=3e-5)
    with pytest.raises((InputError, ValueError)):
        inspected(control_roll=RING.tip_roll - 1.0)


@pytest.mark.parametrize("angle", [0.0, -20.0])
def test_between_balls_is_that_of_the_ring_with_thinner_teeth(angle):
    """Flanks lower by half the thinning along the base tangent are those of the thinner ring: M, and where each ball lies, in closed form."""
    thinning, balls = 0.06, 4.5
    spec = replace(RING.spec, helix_angle=math.radians(angle))
    ring, thin = (Gear.from_spec(replace(spec, thinning=one)) for one in (0.0, thinning))
    arc = thinning / math.cos(spec.helix_angle)
    lower = Estimate.plain(np.full((42, 2), -0.5 * arc * math.cos(ring.transverse_pressure_angle)), np.full((42, 2), 1e-4))
    pins, other = over_pins(ring, balls), over_pins(thin, balls)
    measured = measured_over_pins(lower, ring, pins)
    assert measured.value == pytest.approx(other.length, abs=1e-9)
    found = runout(lower, ring, pins)
    assert found.radial.value == pytest.approx(other.centre_radius - pins.centre_radius, abs=1e-9)
    assert other.centre_radius > pins.centre_radius  # the ball goes deeper into the wider space


@pytest.mark.long
def test_a_tooth_too_thick_lifts_the_balls_beside_it():
    found = inspected()
    assert found.runout is not None
    heights = found.runout.radial.value - np.median(found.runout.radial.value)
    assert sorted(np.argsort(np.abs(heights))[-2:]) == [4, 5]  # the spaces on either side of tooth 6
    assert (heights[[4, 5]] < -0.01).all()  # inwards
    assert found.dimensions.pins is not None
    assert np.isfinite(found.dimensions.pin_lengths.value).all()


@pytest.mark.long
@pytest.mark.parametrize(("axis", "words"), [("bore", "outside"), ("bands", "stated diameter bands"), ("ends", "end faces")])
def test_the_axis_of_a_ring_is_named(axis, words):
    ring = Gear.from_spec(GearSpec("gear", 50, 3.0, 20.0, internal=True))
    notes = inspect(flanks(ring, 40, 8), ring, Settings(noise=1e-4, axis=axis)).notes
    assert any(note.startswith(f"Pitch, index and runout are about the axis of the {words}") for note in notes)
