"""Sections, surfaces, waves, K bands and rolling on rings: places run from root to tip as on any gear, and more metal brings a master closer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.inspection.areal import evaluate_areal
from gearwear.inspection.composite import evaluate_composite, master_teeth
from gearwear.inspection.evaluation import evaluate
from gearwear.inspection.inspection import inspect
from gearwear.inspection.k_band_file import class_k_bands, read_k_bands
from gearwear.inspection.ranges import helix_range, profile_ends, profile_range
from gearwear.inspection.sections import take_sections
from gearwear.inspection.settings import Settings
from gearwear.inspection.traces import FlankSamples, flank_samples, profile_traces
from gearwear.inspection.waviness import wave_spectrum
from gearwear.report.files.inspection_columns import flank_columns, trace_columns
from gearwear.report.records.inspection import as_dict
from tests.inspection.synthetic import flanks

UM, NOISE = 1e-3, 2e-3
SPUR, HELICAL = (
    Gear.from_spec(
        GearSpec("gear", 42, 2.5, 14.0, addendum=0.8, helix_angle=math.radians(angle), internal=True, fillet_radius=0.5)
    )
    for angle in (0.0, -20.0)
)
both = pytest.mark.parametrize("ring", [SPUR, HELICAL], ids=["spur", "helical"])


def scattered(ring: Gear, shape, count: int = 50_000) -> FlankSamples:
    """Points anywhere on the flanks with `shape(flank, place, z)` along the base tangent, mm, place = −L, and noise."""
    rng = np.random.default_rng(0)
    flank = rng.integers(0, 2 * ring.teeth, count)
    place, z = rng.uniform(*profile_ends(ring), count), rng.uniform(0.0, ring.face_width, count)
    return FlankSamples(ring, flank, place, z, shape(flank, place, z) + rng.normal(0.0, NOISE, count), NOISE, 0)


@pytest.mark.long
def test_sections_and_surfaces_are_those_put_in():
    """A twisted flank: each line has the slope of its place, whichever way lengths of roll run."""
    ring, profile, helix = HELICAL, profile_range(HELICAL), helix_range(HELICAL)

    def shape(flank, place, z):
        u, v = (2.0 * (x - r.middle) / r.length for x, r in ((place, profile), (z, helix)))
        return UM * (2.0 * u + np.where(flank % 2 == 0, 1.0, -1.0) * 2.5 * v - 3.0 * u**2 + 15.0 * u * v)

    samples = scattered(ring, shape)
    surface = evaluate_areal(samples, profile, helix, NOISE).flanks
    for name, truth in (("profile_slope", 4.0), ("helix_slope", -5.0), ("profile_crowning", 3.0), ("twist", 60.0)):
        part = surface.named()[name]
        assert (np.abs(part.value - UM * truth) <= 4.5 * part.standard).all(), name
    found = take_sections(samples, profile, helix, profile.middle, NOISE)
    for cut in found.profiles:
        truth = UM * (4.0 + 60.0 * (cut.at - helix.middle) / helix.length)
        assert (np.abs(cut.evaluation.slope.value - truth) <= 4.5 * cut.evaluation.slope.standard).all(), cut.place
    assert [abs(cut.at) for cut in found.helices] == sorted((abs(cut.at) for cut in found.helices), reverse=True)  # root to tip


@both
def test_a_wave_runs_on_from_tooth_to_tooth(ring):
    """Written over the angle at which a point of the ring is on the line of action: where its normal has one direction in space."""
    order, size = 97, 0.7 * UM

    def shape(flank, place, z):
        side = np.where(flank % 2 == 0, 1.0, -1.0)
        # The direction of the normal of a flank in its section, from that of tooth 1 at the base circle and mid-face.
        direction = ring.pitch_angle * (flank // 2) + ring.twist * (z - 0.5 * ring.face_width) - side * place / ring.base_radius
        return size * np.cos(order * direction)

    found = wave_spectrum(scattered(ring, shape), profile_range(ring), helix_range(ring), NOISE)
    for waves in found.waves:
        assert [wave.order for wave in waves] == [order]
        assert abs(waves[0].amplitude - size) <= 4.0 * waves[0].standard


def rolled(ring: Gear, deviation):
    points = flanks(ring, 60, 8)
    samples = flank_samples(points.with_deviation(deviation(points)), ring)
    profile, helix = profile_range(ring), helix_range(ring)
    traces = profile_traces(samples, (helix.start, helix.end), profile.cutoff / 8, 0.0)
    return evaluate_composite(ring, evaluate(traces, profile), evaluate_areal(samples, profile, helix, 0.0))


@pytest.mark.long
def test_eccentricity_alone_reads_twice_itself():
    """F_i″ = 2e and F_i′ = 2e / cos α; the master is closest where the ring is nearest to it: opposite to where it was moved."""
    e, towards = 30 * UM, np.array([math.cos(0.7), math.sin(0.7), 0.0])
    found = rolled(SPUR, lambda points: e * points.normal @ towards)
    assert float(found.double_total.value) == pytest.approx(2 * e, rel=4e-3)
    assert found.single_total.value == pytest.approx(2 * e / math.cos(math.radians(20.0)), rel=4e-3)
    # The master lies on +x: with the ring turned by φ the place it was moved towards lies at φ + 0.7, and there the master has more room.
    most = found.rotation[np.argmax(found.double)]
    assert math.cos(most + 0.7) > math.cos(math.pi / SPUR.teeth)


@pytest.mark.parametrize("sides", [1, 2])
def test_one_thick_tooth_brings_the_master_closer(sides):
    """inv α″ = inv α − Σδ / (2 (r_b2 − r_b1)): closed form, for δ on one or on both of its flanks."""
    d = 25 * UM
    found = rolled(SPUR, lambda points: np.where((points.tooth == 4) & (points.side >= (1 if sides == 1 else -1)), d, 0.0))
    assert found.master_teeth == master_teeth(SPUR) == 21
    base, alpha = 0.5 * SPUR.base_radius, math.radians(20.0)
    assert found.centre_distance == pytest.approx(0.5 * SPUR.reference_radius, rel=1e-12)
    lifted = alpha
    for _ in range(50):
        lifted += (math.tan(alpha) - alpha - sides * d / (2 * base) - math.tan(lifted) + lifted) / math.tan(lifted) ** 2
    jump = found.centre_distance - base / math.cos(lifted)
    assert float(found.double_total.value) == pytest.approx(jump, rel=1e-3)
    assert found.double.min() == pytest.approx(-jump, rel=1e-3)
    assert jump == pytest.approx(sides * d / (2 * math.sin(alpha)), rel=2e-2)


@pytest.mark.long
def test_flanks_of_a_helical_ring_that_all_stand_out_lead_by_as_much():
    """Evenly more metal on all flanks is no composite deviation at all, but a closer master."""
    found = rolled(HELICAL, lambda points: np.full(len(points), 10 * UM * HELICAL.base_helix_cosine))
    assert np.ptp(found.double) < 1e-9
    assert found.single == pytest.approx(10 * UM / math.cos(HELICAL.transverse_pressure_angle), rel=1e-6)


@pytest.mark.long
def test_an_inspection_has_all_of_it():
    ring = HELICAL
    points = flanks(ring, 40, 16)
    found = inspect(
        points.with_deviation(np.random.default_rng(1).normal(0.0, NOISE, len(points))), ring, Settings(laboratory=True)
    )
    assert found.laboratory is not None and found.laboratory.composite is not None
    record = as_dict(found)["laboratory"]
    helices = [row["roll_mm"] for row in record["sections"]["helix"]]
    assert ring.form_roll > helices[0] > helices[1] > helices[2] > ring.tip_roll
    first, last = record["areal"]["range_roll_mm"]
    assert ring.form_roll == pytest.approx(first, abs=1e-4) and ring.tip_roll < last < first
    assert all(row["lowest_um"]["roll_mm"] > 0.0 for row in record["areal"]["flanks"])
    assert trace_columns(found)["roll_mm"].min() > ring.tip_roll - 0.5
    assert "profile_middle_slope_um" in flank_columns(found)


DIAMETERS = {"diameter_mm": lambda roll, ring: 2.0 * math.hypot(ring.base_radius, roll), "roll_mm": lambda roll, ring: roll,
             "roll_angle_deg": lambda roll, ring: math.degrees(roll / ring.base_radius)}  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("key", DIAMETERS)
@pytest.mark.parametrize("from_tip", [False, True])
def test_k_bands_of_a_drawing_from_root_or_from_tip(tmp_path, key, from_tip):
    """Wider at the tip: a profile that drops by 15 µm there is inside, one that drops as much at the root is not."""
    rolls, lower = [HELICAL.form_roll - 0.2, HELICAL.tip_roll + 2.0, HELICAL.tip_roll + 0.2], [-4.0, -4.0, -20.0]
    order = slice(None, None, -1 if from_tip else 1)
    file = tmp_path / "k.toml"
    places = [round(DIAMETERS[key](roll, HELICAL), 6) for roll in rolls[order]]
    file.write_text(f"[profile]\n{key} = {places}\nlower_um = {lower[order]}\nupper_um = [4, 4, 4]\n")
    bands = read_k_bands(file, HELICAL)
    assert bands.profile[0].station == pytest.approx([-roll for roll in rolls], abs=1e-5)
    assert bands.profile[0].lower == pytest.approx([1e-3 * value for value in lower])
    points = flanks(HELICAL, 80, 12)
    low, high = HELICAL.tip_roll, HELICAL.form_roll
    drop = np.select(
        [points.tooth == 3, points.tooth == 5],
        [np.clip((low + 2.0 - points.roll) / 2.0, 0.0, 1.0), np.clip((points.roll - high + 2.0) / 2.0, 0.0, 1.0)],
    )
    found = inspect(points.with_deviation(-0.015 * drop), HELICAL, Settings(k_bands=bands, noise=1e-4))
    for side in Side:
        assert str(found.profile.k.verdict(3, side.index)) == "inside"
        assert str(found.profile.k.verdict(5, side.index)) == "outside"
    assert as_dict(found)["profile"]["k_bands"]["left"]["roll_mm"] == pytest.approx(rolls, abs=1e-4)


def test_k_bands_of_a_class_and_such_as_are_not_on_the_flank(tmp_path):
    band = class_k_bands(SPUR, 8).profile[0]
    assert band.station == pytest.approx((profile_range(SPUR).start, profile_range(SPUR).end))
    file = tmp_path / "k.toml"
    file.write_text("[profile]\nroll_mm = [5, 20]\nlower_um = [-4, -4]\nupper_um = [4, 4]\n")
    with pytest.raises(
        InputError, match=rf"roll_mm = 5 is not on the flank, which has {SPUR.form_roll:.3f} mm to {SPUR.tip_roll:.3f} mm"
    ):
        read_k_bands(file, SPUR)
