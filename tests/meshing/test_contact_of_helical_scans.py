"""What a scanned helical gear does in contact, against the gear itself, worn by code that shares nothing with the package."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.comparison.stations import compare
from gearwear.design import Design, Gear, GearSpec, PairSpec
from gearwear.design.load import LoadSpec
from gearwear.design.pair import check_pair
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.loaded.contact import loaded_contact, pair_compliance
from gearwear.meshing.contact import mesh_contact
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch

PINION = Helical(teeth=13, helix=20.0, width=14.0)
WORN = [0, 1, 2, 5, 6, 7, 8]
DEPTH = 0.08


def patches() -> tuple[Patch, ...]:
    """Hollow flanks: deepest in the middle of the profile, half as deep at the ends of the face."""
    return tuple(Patch(tooth, 1, DEPTH, (1.0, 17.0), (-7.0, 21.0)) for tooth in WORN)


def true_profiles(gear: Gear) -> ToothProfiles:
    """Depth d at the foot (L, z) is seen at the own roll L − d cos β_b and the own height z + s d sin β_b, and turns the flank by d / (r_b cos β_b)."""
    radius = np.linspace(gear.root_radius, gear.flank_end_radius, 200)
    z = np.linspace(0.0, PINION.width, 21)
    own, height = np.broadcast_arrays(np.sqrt(np.maximum(radius**2 - PINION.base**2, 0.0)), z[:, None])
    lean = math.sqrt(1.0 - PINION.base_cos**2)
    depth = np.zeros_like(own)
    for _ in range(20):
        depth = patches()[0].at(own + PINION.base_cos * depth, height - lean * depth)
    half_angle = np.broadcast_to(gear.half_angle(radius), (gear.teeth, 2, len(z), len(radius))).copy()
    half_angle[WORN, 0] -= np.where(radius >= gear.form_radius, depth, 0.0) / (PINION.base * PINION.base_cos)
    return ToothProfiles(gear, radius, z, half_angle)


@pytest.mark.long
def test_transmission_error_and_backlash_are_those_of_the_gear_itself(tmp_path):
    pinion = designed(PINION)
    mate = Gear.from_spec(GearSpec("gear", 22, 3.0, 14.0, helix_angle=-math.radians(20.0), profile_shift=-0.1))
    pair = PairSpec(0.5 * 3.0 * 35 / math.cos(math.radians(20.0)) + 0.1)
    load = LoadSpec(load_per_width=100.0)
    design = Design({"pinion": pinion, "gear": mate}, pair, check_pair(pinion, mate, pair), load=load)
    points = scan(PINION, 30_000, noise=0.006, seed=3, wear=patches()).points
    np.savetxt(tmp_path / "scan.xyz", points, fmt="%.5f")
    study = compare(design, [tmp_path / "scan.xyz"], part="pinion", inspection=False).pair
    flat = nominal_profiles(mate, np.linspace(mate.root_radius, mate.tip_radius, 200))
    worn = true_profiles(pinion)
    true = mesh_contact(worn, flat, design.centre_distance, positions_per_pitch=34)
    found, spread = study.contact, study.spread
    # Besides their own scatter, as of spur gears: cells do not show how sharp the hollow's rim is, some 3 % of the greatest lag.
    shape = 0.03 * -true.transmission_error_min.value
    assert true.peak_to_peak_um > 20.0
    assert abs(1e-3 * (found.peak_to_peak_um - true.peak_to_peak_um)) < 3.0 * spread.transmission_error + shape
    assert spread.transmission_error < 0.15e-3 * true.peak_to_peak_um
    assert abs(found.backlash_max.value - true.backlash_max.value) < 3.0 * spread.backlash_greatest + shape
    assert abs(found.backlash.mean() - true.backlash.mean()) < 3.0 * spread.backlash_mean + shape
    # And under load, which closes a part of the hollow.
    loaded = study.loaded
    wanted = loaded_contact(worn, flat, design.centre_distance, 100.0 * PINION.width, pair_compliance(worn, flat))
    assert abs(loaded.present.peak_to_peak - wanted.peak_to_peak) < 3.0 * loaded.spread.flanks["transmission_error"] + shape
    assert abs(loaded.present.mean_lag - wanted.mean_lag) < 3.0 * loaded.spread.flanks["mean_lag"] + shape
    assert loaded.present.peak_to_peak > 2.0 * loaded.design.peak_to_peak
    assert study.running == "no sliding wear is seen that a run could begin with"
