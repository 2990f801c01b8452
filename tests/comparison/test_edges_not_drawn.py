"""Chamfered tips and ends that the drawing does not have: no wear, no effect, and no loss between two scans of one gear."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from gearwear.comparison.stations import compare
from gearwear.design import Gear, read_design
from gearwear.design.modification import FlankModification
from gearwear.design.pair import Design
from gearwear.design.side import Side
from tests.diagnose.plain import plain_effects
from tests.synthetic import GearNumbers, Recipe, SlidingWear, Texture, make_scan
from tests.synthetic.edges import bevelled, bevelled_ends, height_of
from tests.synthetic.helical import Helical, scan
from tests.synthetic.outline import Outline
from tests.synthetic.test_helical import designed

NUMBERS = GearNumbers(20, 3.0, 20.0, 20.0, 0.1)
FLANK, LAND = 0.5, 0.4
SLID = SlidingWear(60.0, 1)
DESIGN = "[gear]\nteeth = 20\nmodule = 3.0\nface_width = 20.0\nprofile_shift = 0.1\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("edges")
    (folder / "design.toml").write_text(DESIGN)
    return folder


def written(folder, name: str, seed: int, *wear: SlidingWear):
    """A scan in the design's frame with all of its tips chamfered, as text; and what wear took from flanks below the bevels, mm³."""
    recipe = Recipe(gear=NUMBERS, jitter=1.0, noise_um=6.0, texture=Texture(2.0, 1.0), wear=wear, pose="none").of_size(40_000)
    scan = make_scan(recipe, seed)
    file = folder / f"{name}.xyz"
    file.write_text("\n".join(f"{x:.4f} {y:.4f} {z:.4f}" for x, y, z in bevelled(scan.points, NUMBERS, FLANK, LAND)))
    return file, scan


@pytest.fixture(scope="module")
def unworn(folder):
    return written(folder, "unworn", 1)[0]


@pytest.mark.parametrize("effects", [plain_effects, pytest.param(nullcontext, marks=pytest.mark.long)], ids=["plain", "all"])
def test_it_is_found_and_no_wear_nor_any_effect(folder, unworn, effects):
    with effects():
        results = compare(read_design(folder / "design.toml"), [unworn], inspection=False)
    assert results.wear.regions == () and results.effects == ()
    edge = results.measured.tip_edge
    assert edge.height == pytest.approx(height_of(NUMBERS, FLANK), abs=0.1)
    assert edge.words() in results.measured.notes


def ends_bevelled(folder, size: float, *wear: SlidingWear):
    """A scan with the ends of all of its teeth bevelled by `size`, mm."""
    recipe = Recipe(gear=NUMBERS, jitter=1.0, noise_um=6.0, texture=Texture(2.0, 1.0), wear=wear, pose="none").of_size(40_000)
    scan = make_scan(recipe, 7)
    square = np.full((2, 2), size)
    np.savetxt(folder / "ends.xyz", bevelled_ends(scan.points, NUMBERS, square, square), fmt="%.4f")
    return folder / "ends.xyz", scan


@pytest.mark.long
def test_bevelled_ends_are_no_wear_and_no_effect_and_take_nothing_off_the_thinnest(folder):
    file, _ = ends_bevelled(folder, 0.5)
    results = compare(read_design(folder / "design.toml"), [file], inspection=False)
    assert results.wear.regions == () and results.effects == ()
    edge = results.measured.end_edge
    assert np.array(edge.reach) == pytest.approx(np.full((2, 2), 0.5), abs=0.12)
    assert edge.words() in results.measured.notes
    thinnest = results.wear.thickness.thinnest()
    drawn = results.measured.gear.tooth_thickness
    assert thinnest is not None and thinnest.low <= drawn + 0.001 and thinnest.high >= drawn - 0.02


@pytest.mark.long
def test_wear_of_a_side_is_that_between_bevelled_ends(folder):
    file, scan = ends_bevelled(folder, 0.5, SLID)
    results = compare(read_design(folder / "design.toml"), [file], inspection=False)
    assert {region.side for region in results.wear.regions} == {Side.LEFT}
    assert not any(effect.name in ("end_relief", "helix_crowning", "taper") for effect in results.effects)
    # Even along the face: of the strips on the bevels all of it lies past the flank, or in the bevel's own metal.
    most, least = scan.truth.volume_mm3, scan.truth.volume_mm3 * (1.0 - 2.0 * 0.5 / 20.0)
    std = results.wear.found.volume_std
    assert least - 2.0 * std < results.wear.volume < most + 2.0 * std and std < 0.1 * most


@pytest.mark.long
@pytest.mark.parametrize("before", [False, True])
def test_wear_of_a_side_is_that_below_the_bevels(folder, unworn, before):
    """What the law takes off the flank up to where the bevel begins, by ∫ d L / r_b dL, 0.83 of all; what it takes off the bevels is not in the volume."""
    file, scan = written(folder, f"slid {before}", 2, SLID)
    results = compare(read_design(folder / "design.toml"), [file], before=[unworn] if before else (), inspection=False)
    assert {region.side for region in results.wear.regions} == {Side.LEFT}
    outline = Outline.of(NUMBERS)
    roll = np.linspace(outline.form_roll, outline.tip_roll, 20_001)
    taken = (
        SLID.depth(outline, np.zeros(len(roll), dtype=int), np.ones(len(roll), dtype=int), roll, np.full(len(roll), 10.0)) * roll
    )
    below = np.hypot(roll, outline.base_radius) < outline.tip_radius - height_of(NUMBERS, FLANK)
    expected = scan.truth.volume_mm3 * float(taken[below].sum() / taken.sum())
    assert abs(results.wear.volume - expected) < 2.0 * results.wear.found.volume_std < 0.1 * expected


@pytest.mark.long
def test_between_two_scans_nothing_is_lost(folder, unworn):
    again, _ = written(folder, "again", 3)
    results = compare(read_design(folder / "design.toml"), [again], before=[unworn], inspection=False)
    assert results.wear.regions == ()


@pytest.mark.long
def test_what_the_drawing_modifies_ends_where_it_is_drawn_and_not_at_the_bevel(tmp_path):
    """Crowned up to the sharp tip, as it was cut before the tips were bevelled: no other profile than drawn, and no slope."""
    numbers = Helical(teeth=20, module=3.0, helix=0.0, width=20.0, shift=0.1)
    crowned = FlankModification(profile_crowning=0.03)
    gear = Gear.from_spec(replace(designed(numbers).spec, left=crowned, right=crowned))
    cloud = scan(numbers, 60_000, noise=0.004, seed=5, added=lambda side, roll, z: gear.drawn(Side.LEFT).along_profile(roll))
    points = (cloud.points - cloud.translation) @ cloud.rotation
    np.savetxt(tmp_path / "scan.xyz", bevelled(points, NUMBERS, FLANK, LAND))
    results = compare(Design({"gear": gear}), [tmp_path / "scan.xyz"], inspection=False)
    assert results.measured.tip_edge.height > 0.3
    assert results.wear.regions == () and results.effects == ()
    cells = results.measured.cells
    profile = np.nanmean(cells.grid.flank_shape(cells.points.deviation), axis=(0, 1, 2))
    assert np.ptp(profile) < 0.0015
