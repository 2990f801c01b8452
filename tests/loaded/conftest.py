"""The published pair with the bores of the reference, its flanks as designed, and its compliance: worked out once."""

from __future__ import annotations

import pytest

from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.spec import GearSpec
from gearwear.loaded.contact import pair_compliance
from gearwear.loaded.pair_compliance import PairCompliance


@pytest.fixture(scope="session")
def pinion() -> ToothProfiles:
    return nominal_profiles(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, bore_diameter=24.0)))


@pytest.fixture(scope="session")
def wheel() -> ToothProfiles:
    return nominal_profiles(Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0, bore_diameter=40.0)))


@pytest.fixture(scope="session")
def elastic(pinion: ToothProfiles, wheel: ToothProfiles) -> PairCompliance:
    return pair_compliance(pinion, wheel)
