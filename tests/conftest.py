"""Fixtures every room's tests share."""

from __future__ import annotations

import os
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the commands do, before numpy: sums in one order, the same bytes

import pytest
from hypothesis import settings

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec

settings.register_profile("alike", derandomize=True)  # the same examples in every run: what passes here passes there
settings.load_profile("alike")

SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture(scope="session")
def pinion() -> Gear:
    """The paper's pinion: z = 12, module 6.35, 20°, face 15, rack tip radius 0.25 m (the reference's)."""
    return Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.25))


@pytest.fixture(scope="session")
def wheel() -> Gear:
    """Its mate: z = 24."""
    return Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0, rack_tip_radius=0.25))


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with practice scans, or a skip."""
    if not (SHARED / "scans").is_dir():
        pytest.skip("the practice scans are not beside this checkout")
    return SHARED
