"""Traces of a measuring machine on a ring: the surface they make, and that of a double helical gear refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.files.traces import read_traces
from gearwear.design.pair import Design
from gearwear.errors import InputError

RING = Gear.from_spec(
    GearSpec("gear", 42, 2.5, 14.0, addendum=0.8, helix_angle=math.radians(-20.0), internal=True, fillet_radius=0.5)
)


def rows(deviation, sides=("left", "right")):
    """Profiles at mid-face of all flanks, from the form circle to the tip, as the drawing counts them."""
    said = ["kind,tooth,flank,roll_mm,z_mm,deviation_um"]
    for tooth in range(42):
        for side in sides:
            for roll in np.linspace(RING.form_roll, RING.tip_roll, 25):
                said.append(f"profile,{tooth + 1},{side},{roll:.6f},7,{1e3 * deviation(tooth, side, roll):.6f}")
    return "\n".join(said)


def test_profiles_and_pitch_turn_the_flanks_of_a_ring(tmp_path):
    """δ along the base tangent turns the flank by δ / r_b; an index of a on tooth 6 turns both its flanks counter-clockwise by a cos α / r_b."""
    slope, arc = 0.02, 0.03

    def deviation(tooth, side, roll):
        return slope * ((RING.form_roll - roll) / (RING.form_roll - RING.tip_roll) - 0.5) * (side == "left")

    file = tmp_path / "traces.csv"
    pitch = [f"pitch,{k + 1},{side},,,{1e3 * arc * (k == 5):.6f}" for k in range(42) for side in ("left", "right")]
    file.write_text("\n".join([rows(deviation), *pitch]))
    part, profiles = read_traces(file, Design({"gear": RING}))
    assert part == "gear"
    on = profiles.radius <= RING.form_radius + 1e-9
    roll = np.sqrt(profiles.radius[on] ** 2 - RING.base_radius**2)
    off = (profiles.half_angle - RING.half_angles(profiles.radius, profiles.z))[..., on] * RING.base_radius
    at_reference = deviation(0, "left", RING.reference_roll)
    tangent = arc * math.cos(RING.transverse_pressure_angle)
    for tooth, level in ((5, tangent), (8, 0.0)):
        truth = np.array([deviation(tooth, "left", one) for one in roll]) - at_reference + level
        assert off[tooth, 0] == pytest.approx(np.broadcast_to(truth, off[tooth, 0].shape), abs=2e-6)
        assert off[tooth, 1] == pytest.approx(np.full_like(off[tooth, 1], -level), abs=2e-6)
    root = profiles.half_angle[0, 0, :, -1] - RING.half_angles(profiles.radius[-1:], profiles.z)[0, :, 0]
    assert np.abs(root).max() < 1e-12  # the bottom of the space stays


def test_a_double_helical_gear_is_refused_by_name(tmp_path):
    double = Gear.from_spec(GearSpec("gear", 42, 2.5, 24.0, helix_angle=0.4, gap=4.0))
    file = tmp_path / "traces.csv"
    file.write_text(rows(lambda tooth, side, roll: 0.0))
    with pytest.raises(InputError, match=r"gap = 4 mm: what is measured on a machine of double helical gears is out of scope"):
        read_traces(file, Design({"gear": double}))
