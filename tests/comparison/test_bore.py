"""Pitch and runout about the axis of the bore: an eccentricity put in is asked back, as the runout it makes."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear import api, as_scan
from gearwear.comparison.bore import bore_axis, flanks_about_bore
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design.files.toml import parse_design
from gearwear.design.pair import Design
from gearwear.errors import InputError
from gearwear.inspection import Settings, inspect
from gearwear.scan.reading import read_scan
from tests.commands.doors import scan_file
from tests.synthetic import Effect, Recipe
from tests.synthetic.ring import Ring, ring_scan
from tests.synthetic.test_ring import designed

E, TOWARDS = 60.0, 40.0
GEAR = {"teeth": 12, "module": 6.35, "face_width": 15.0, "rack_tip_radius": 0.3}


def design(**more):
    return parse_design({"pinion": {**GEAR, **more}, "datum": {"axis": "bore"}}, "test")


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    plain = Recipe(jitter=1.0, noise_um=5.0)
    off = Effect("eccentricity", {"amplitude_um": E, "direction_deg": TOWARDS})
    recipe = replace(plain, gear=replace(plain.gear, bore_diameter=30.0), effects=(off,)).of_size(40_000)
    files, _ = scan_file(tmp_path_factory.mktemp("bore"), "off", recipe, 4)
    return read_scan(files)


def eccentricity(measured, points, covariance):
    found = inspect(points, measured.gear, Settings(noise=measured.noise, pose_covariance=covariance, axis="bore"))
    return found, found.runout.eccentricity


@pytest.mark.long
@pytest.mark.parametrize("loop", [False, True], ids=["registered", "with the loop"])
def test_an_eccentricity_is_runout_about_the_bore_and_none_about_the_teeth(scan, loop):
    """First harmonic of the balls: e itself, towards where it was put; F_r = 2e, less what 12 balls miss of it."""
    measured = register(design(bore_diameter=30.0), scan)
    measured = find_effects(measured) if loop else measured
    found, harmonic = eccentricity(measured, *flanks_about_bore(measured, bore_axis(measured)))
    truth = 1e-3 * E * np.array([np.cos(np.radians(TOWARDS)), np.sin(np.radians(TOWARDS))])
    assert (np.abs(harmonic.value - truth) <= 4.0 * harmonic.standard + 3e-4).all()  # 0.3 µm of second order
    runout = 1e3 * float(found.runout.runout.value)
    assert 2 * E * np.cos(np.pi / 12) - 4.0 < runout < 2 * E + 4.0
    if loop:
        about_teeth = inspect(measured.flanks, measured.gear, Settings(noise=measured.noise))
        assert 1e3 * float(about_teeth.runout.runout.value) < 10.0
        # What the design states, gw.inspect does.
        assert api.inspect(measured).runout.runout.value == pytest.approx(found.runout.runout.value)


def test_a_bore_that_is_not_there_is_no_axis(scan):
    with pytest.raises(InputError, match="needs bore_diameter"):
        bore_axis(register(design(), scan))


@pytest.mark.long
def test_of_a_ring_it_is_the_outside():
    """The outside of a ring lies off its teeth by e: about its axis the balls run out by as much the other way, about the teeth's not."""
    ring, e = Ring(), np.array([0.05, -0.02])
    cloud = ring_scan(ring, 30_000, seed=4, noise=0.004)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    outside = (np.hypot(points[:, 0], points[:, 1]) > ring.rim - 0.05) & (np.abs(points[:, 2] - 7.0) < 6.9)
    points[outside, :2] += e
    measured = register(Design({"gear": designed(ring)}), as_scan(points @ cloud.rotation.T + cloud.translation))
    axis = bore_axis(measured)
    turned = measured.pose.rotation @ cloud.rotation  # by whole pitches: any tooth may be tooth 1
    assert axis.motion[:2] == pytest.approx(turned[:2, :2] @ e, abs=2e-3)
    found, harmonic = eccentricity(measured, *flanks_about_bore(measured, axis))
    assert (np.abs(harmonic.value + turned[:2, :2] @ e) <= 4.0 * harmonic.standard + 3e-4).all()
    assert "about the axis of the outside" in " ".join(found.notes)
    with pytest.raises(InputError, match="an axis from the outside needs rim_diameter"):
        bore_axis(register(Design({"gear": designed(replace(ring, rim=0.0))}), as_scan(cloud.points)))
