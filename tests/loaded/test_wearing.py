"""Wear that runs, against Archard's law in single contact, conservation, and the runs of another program."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.profiles import ToothProfiles
from gearwear.errors import InputError
from gearwear.loaded import wearing
from gearwear.loaded.pair_compliance import PairCompliance
from gearwear.loaded.wearing import WearMember, WornPair, run_wear, run_wear_ensemble
from gearwear.meshing.path import path_of_contact
from gearwear.wear_law.archard import specific_sliding

C, FACE = 114.3, 15.0
RATE = 2e-8
"""k w, mm per cycle."""


def run(
    pinion: ToothProfiles, wheel: ToothProfiles, elastic: PairCompliance, w: float, cycles: list[float], **more
) -> tuple[WornPair, ...]:
    return run_wear(pinion.gear, wheel.gear, C, w * FACE, elastic, [RATE / w * n for n in cycles], **more)


@pytest.fixture(scope="module")
def aligned(pinion, wheel, elastic) -> tuple[WornPair, ...]:
    """At 100 N/mm, after 0.2, 0.5, 1 and 2 million cycles; the wheel is hard."""
    return run(pinion, wheel, elastic, 100.0, [2e5, 5e5, 1e6, 2e6])


def test_in_single_contact_it_is_archards_law(pinion, wheel, elastic):
    """h = k w N |K| to 1 %, where one pair carries alone, away from the pitch point, where K is 0 and the contact's width smears it."""
    (found,) = run(pinion, wheel, elastic, 200.0, [2e4], positions_per_pitch=240)
    law = RATE * 2e4 * specific_sliding(pinion.gear, wheel.gear, C, found.roll)
    alone = (
        (found.roll > 9.0)
        & (found.roll < 16.0)
        & (np.abs(found.roll - path_of_contact(pinion.gear, wheel.gear, C).pitch_pinion) > 0.6)
    )
    assert alone.sum() > 20
    np.testing.assert_allclose(found.depth[0, alone], law[alone], rtol=0.01)


def test_without_corners_it_is_archards_law_right_up_to_the_ends_of_single_contact(pinion, wheel, elastic):
    """A corner that meets the next tooth early takes part of the load there."""
    low, _ = path_of_contact(pinion.gear, wheel.gear, C).single_contact_pinion
    sharp, blunt = (run(pinion, wheel, elastic, 100.0, [1e4], positions_per_pitch=96, corners=c)[0] for c in (True, False))
    near = (blunt.roll > low + 0.6) & (blunt.roll < low + 1.2)
    assert near.sum() >= 2
    law = RATE * 1e4 * specific_sliding(pinion.gear, wheel.gear, C, blunt.roll)
    np.testing.assert_allclose(blunt.depth[0, near], law[near], rtol=0.03)
    assert (sharp.depth[0, near] < 0.97 * law[near]).any()


def test_at_light_load_a_contact_narrower_than_a_step_still_leaves_a_smooth_flank(pinion, wheel, elastic):
    """At 2 N/mm the contact is 0.015 mm to either side and moves on by 0.1 mm of flank: the depth is Archard's cell by cell all the same."""
    (found,) = run(pinion, wheel, elastic, 2.0, [2e3], positions_per_pitch=60)
    alone = (found.roll > 9.0) & (found.roll < 12.5)
    law = RATE * 2e3 * specific_sliding(pinion.gear, wheel.gear, C, found.roll)
    np.testing.assert_allclose(found.depth[0, alone], law[alone], rtol=0.1)


def test_at_light_load_flanks_are_updated_before_the_load_sharing_swings(pinion, wheel, elastic, monkeypatch):
    """At 10 N/mm the lag is about a micrometre, and a step of three would let pairs take the whole load in turns."""
    (usual,) = run(pinion, wheel, elastic, 10.0, [3e5], positions_per_pitch=40)
    monkeypatch.setattr(wearing, "STEP_TO_LAG", 0.1)
    (fine,) = run(pinion, wheel, elastic, 10.0, [3e5], positions_per_pitch=40)
    low = usual.roll < 7.0
    assert np.abs(usual.depth - fine.depth)[0, low].max() < 0.1 * fine.depth[0, low].mean()


@pytest.mark.parametrize(("w", "dedendum"), [(100.0, (13.6, 23.8)), pytest.param(200.0, (16.4, 27.9), marks=pytest.mark.long)])
def test_worn_flanks_unload_themselves_as_by_another_program(pinion, wheel, elastic, aligned, w, dedendum):
    """Mean depth from L = 3.3 to 7.2 mm at 1 and 2 million cycles; it shifts leads to first order
    and lets wear beyond the form circle go, so that some per cent are between them."""
    runs = aligned[2:] if w == 100.0 else run(pinion, wheel, elastic, w, [1e6, 2e6])
    for found, wanted in zip(runs, dedendum, strict=True):
        low = (found.roll > 3.3) & (found.roll < 7.2)
        assert 1e3 * np.average(found.depth[0, low], weights=1.0 / found.roll[low]) == pytest.approx(wanted, rel=0.1)


def test_growth_slows_where_pairs_share_and_not_where_one_carries(aligned):
    _, one, two, three = aligned
    low, alone = one.roll < 7.0, (one.roll > 14.0) & (one.roll < 16.0)
    first, second, fourth = (found.depth[0, low].mean() for found in (one, two, three))
    assert second - first < 0.7 * first and fourth - second < 0.7 * 2.0 * first
    assert three.depth[0, alone].mean() == pytest.approx(4.0 * one.depth[0, alone].mean(), rel=0.03)


def test_both_flanks_lose_the_same_section_where_they_are_as_soft(pinion, wheel, elastic, aligned):
    """Per cycle of the pinion a tooth of the wheel, which meshes half as often, loses half as much."""
    (found,) = run(pinion, wheel, elastic, 150.0, [3e5], mate_rate=1.0)
    lost = [
        float((depth[0] * np.gradient(roll**2 / (2.0 * body.gear.base_radius))).sum())
        for depth, roll, body in ((found.depth, found.roll, pinion), (found.mate_depth, found.mate_roll, wheel))
    ]
    assert lost[0] == pytest.approx(2.0 * lost[1], rel=0.02)
    assert not aligned[-1].mate_depth.any()


def test_a_misaligned_pair_wears_where_it_carries(pinion, wheel, elastic, aligned):
    (found,) = run(pinion, wheel, elastic, 100.0, [2e5], misalignment=0.03, slices=5, positions_per_pitch=40)
    depth = found.depth.mean(axis=1)
    assert (np.diff(depth) <= 0.0).all() and depth[0] > 2.0 * depth[-1]
    # In all it is what an aligned pair loses: the force is the same.
    assert depth.mean() == pytest.approx(aligned[0].depth.mean(), rel=0.06)


@pytest.mark.long
def test_smaller_steps_change_little(pinion, wheel, elastic, aligned, monkeypatch):
    found = aligned[2]
    monkeypatch.setattr(wearing, "STEP_TO_LAG", 0.1)
    (finer,) = run(pinion, wheel, elastic, 100.0, [1e6])
    assert np.abs(found.depth - finer.depth).mean() < 0.03 * finer.depth.mean()


def test_nothing_is_lost_in_no_time(pinion, wheel, elastic):
    (found,) = run(pinion, wheel, elastic, 100.0, [0.0])
    assert found.time == 0.0 and not found.depth.any()


def test_bad_input_is_named(pinion, wheel, elastic):
    with pytest.raises(InputError, match="a force above 0, times that rise"):
        run_wear(pinion.gear, wheel.gear, C, 0.0, elastic, [1e-12])
    with pytest.raises(InputError, match="a force above 0, times that rise"):
        run_wear(pinion.gear, wheel.gear, C, 1.0, elastic, [2e-12, 1e-12])


def test_runs_side_by_side_are_those_run_alone(pinion, wheel, elastic):
    """Members differ by compliance and mate, and know nothing of each other."""
    members = [WearMember(elastic, 0.0), WearMember(replace(elastic, scale=1.3), 1.0)]
    times = np.array([0.0, 1e5 * RATE / 100.0])
    roll, depth = run_wear_ensemble(pinion.gear, wheel.gear, C, 100.0, members, times, 40)
    for member, found in zip(members, depth, strict=True):
        (alone,) = run(pinion, wheel, member.compliance, 100.0, [1e5], mate_rate=member.mate_rate, positions_per_pitch=40)
        np.testing.assert_allclose(found[1], alone.depth[0], atol=1e-9)
        np.testing.assert_allclose(roll, alone.roll)
        assert not found[0].any()
