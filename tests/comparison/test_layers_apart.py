"""What is missing on teeth on which two views of one file lie apart may be that: the volume is a range, and the verdict says so."""

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import MeasuredGear, register
from gearwear.comparison.open_volume import OpenVolume
from gearwear.design.pair import Design
from gearwear.wear.regions import Wear, find_wear
from tests.placing.placing import designed, true_pose
from tests.synthetic import Patch, Recipe, make_scan

ON_LAYERS, ALONE = 4, 10


def scan_of_two_views(apart: float) -> np.ndarray:
    """Every second point of a third of the gear moved as a view that does not fit, mm."""
    wear = tuple(Patch(tooth, 1, 200.0, (37.0, 43.0), (2.0, 11.0)) for tooth in (ON_LAYERS, ALONE))
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear).of_size(30_000), 3)
    points = true_pose(scan).apply(scan.points)
    angle = np.radians(30.0 * ON_LAYERS)
    toward = np.array([np.cos(angle), np.sin(angle), 0.0])
    there = points @ toward > 0.5 * np.hypot(points[:, 0], points[:, 1])
    moved = there & (np.arange(len(points)) % 2 == 0)
    across = np.array([-toward[1], toward[0], 0.0])
    return points + np.where(moved[:, None], apart * (toward + across), 0.0)


def worn(apart: float) -> tuple[MeasuredGear, Wear]:
    measured = find_effects(register(Design({"gear": designed()}), as_scan(scan_of_two_views(apart))), frozenset())
    return measured, find_wear(measured.as_made, measured.noise, measured.worn_sides, measured.loop)


def test_what_is_missing_where_views_lie_apart_may_be_that():
    measured, wear = worn(0.035)
    assert measured.layered[ON_LAYERS] and not measured.layered[ALONE]
    low, high, why = OpenVolume(measured, wear, ()).limits
    assert ALONE in {region.tooth for region in wear.regions}
    sure = sum(region.volume for region in wear.regions if not measured.layered[region.tooth])
    assert low <= sure * (1.0 + 1e-12) < wear.volume <= high
    assert "lie apart" in why
    assert any("do not lie on each other" in note for note in measured.doubts)


def test_views_that_fit_are_not_doubted():
    measured, wear = worn(0.0)
    assert not measured.layered.any()
    assert OpenVolume(measured, wear, ()).layered == 0.0


@pytest.mark.long
def test_all_that_is_named_of_a_perfect_gear_may_be_the_views():
    """A view of a third of the gear, its borders blended, out of place by 27 µm and nothing else: no effect stands without a view beside it."""
    scan = make_scan(Recipe(jitter=1.0, noise_um=4.0, pose="none").of_size(30_000), 3)
    points = true_pose(scan).apply(scan.points)
    middle = 2.1
    off = np.abs((np.arctan2(points[:, 1], points[:, 0]) - middle + np.pi) % (2.0 * np.pi) - np.pi)
    moved = np.random.default_rng(3).random(len(points)) < np.clip((1.2 - off) / 0.7, 0.0, 1.0)
    toward, across = np.array([np.cos(middle), np.sin(middle), 0.0]), np.array([-np.sin(middle), np.cos(middle), 0.0])
    shifted = points + np.where(moved[:, None], 0.012 * (across - 2.0 * toward), 0.0)
    measured = find_effects(register(Design({"gear": designed()}), as_scan(shifted)), frozenset())
    assert 0.004 < measured.context.views_apart < 0.0135  # at most half of what they are apart
    assert measured.loop is not None and measured.loop.effects
    assert all("view_registration" in {effect.name, *effect.alternatives} for effect in measured.loop.effects)
