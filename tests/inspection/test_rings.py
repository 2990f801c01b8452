"""Deviations of ISO 1328-1 on internal gears: signs towards the tip, which lies at the smaller roll, and lengths as on the drawing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import flank_points
from gearwear.errors import InputError
from gearwear.inspection.inspection import Settings, inspect
from gearwear.inspection.ranges import profile_ends, profile_range
from gearwear.report.files.inspection_columns import trace_columns
from gearwear.report.records.inspection import as_dict

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
    assert record["dimensions"]["span"] is None and record["dimensions"]["over_pins"] is None
    assert any("neither span nor pins" in note for note in found.notes)


def test_bands_are_given_in_lengths_of_roll_too():
    low, high = RING.tip_roll + 2.0, RING.form_roll - 2.0
    found = inspected(helix_band=(low, high), control_roll=RING.form_roll - 1.0)
    assert sorted(map(abs, found.helix.band)) == [pytest.approx(low), pytest.approx(high)]
    assert found.profile.range.start == pytest.approx(-RING.form_roll + 1.0)
    assert found.helix.slope.value == pytest.approx(-HELIX * found.helix.range.stated / 14.0, abs=3e-5)
    with pytest.raises((InputError, ValueError)):
        inspected(control_roll=RING.tip_roll - 1.0)
