"""How high a flank was made that is no datum itself, told by sound flanks left out in turn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FLANK, locate
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.wear.regions import find_wear
from tests.diagnose.plain import PLAIN
from tests.placing.placing import designed
from tests.synthetic import Effect, Patch, Recipe, SlidingWear, make_scan

GEAR = designed()
TOOTH, LEFT = 3, 1
HOLLOW = Patch(TOOTH, LEFT, 200.0, (36.5, 42.5), (1.0, 14.0))
"""Over most of a flank: no more is a datum."""


def closed(seed: int, *wear, spread_um: float = 10.0, effects_tried: tuple | None = PLAIN):
    """A ground gear of which every tooth has pitch and thickness of its own (µm), its fillets as drawn; cells, loop, and the worn volume put in, mm³."""
    random = np.random.default_rng(seed)
    own = [random.normal(0.0, spread_um, GEAR.teeth) for _ in range(2)]
    effects = (Effect("pitch", {"index_um": tuple(own[0])}), Effect("thickness_variation", {"thickness_um": tuple(own[1])}))
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=effects, fillets_follow=False)
    scan = make_scan(recipe.of_size(20_000), seed)
    located = locate(scan.points, GEAR)
    cells = bin_points(located, CellGrid.for_scan(GEAR, len(located)), clip=0.4)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), effects_tried, worn=frozenset())
    return cells, loop, own, scan.truth.volume_mm3


def each_tooth(loop):
    """Parameters of pitch and of thickness."""
    effects = {effect.name: effect.parameters.values() for effect in loop.effects}
    return effects["pitch"], effects["thickness_variation"]


def test_a_flank_that_no_cell_tells_may_stand_off_as_others_would():
    """Of a ground tooth with pitch P and thickness T the left flank stands at cos α (P + T/2), the right one at cos α (T/2 − P). From one alone, at l, the least
    amounts have the other at −0.6 l, which is off by cos α (0.8 T + 0.4 P) for a left one left out, and by cos α (0.8 T − 0.4 P) for a right one."""
    cells, loop, (pitch, thickness), _ = closed(3, HOLLOW)
    assert {effect.name for effect in loop.effects} == {"pitch", "thickness_variation"}
    found = loop.untold.fields
    own = (cells.points.surface == FLANK) & cells.seen & (cells.points.tooth == TOOTH) & (cells.points.side == LEFT)
    np.testing.assert_array_equal(found.any(axis=1), own)
    left, right = np.delete(0.8 * thickness + 0.4 * pitch, TOOTH), 0.8 * thickness - 0.4 * pitch
    # About the mean of a side, which as many flanks as are sound tell: of the one flank both are in doubt.
    free = len(left) + len(right) - 2
    scatter = math.sqrt(float(((left - left.mean()) ** 2).sum() + ((right - right.mean()) ** 2).sum()) / free)
    expected = 1e-3 * math.cos(math.radians(20.0)) * scatter * math.sqrt(1.0 + 1.0 / len(left))
    assert np.linalg.norm(found[own], axis=1) == pytest.approx(expected, rel=0.1)


@pytest.mark.long
def test_flanks_that_tell_their_own_level_have_no_doubt():
    _, loop, *_ = closed(1)
    assert loop.untold is None


@pytest.mark.long
def test_the_volume_of_a_hollow_flank_is_as_sure_as_is_said():
    """12 gears, refused where less than 9 lie within two standard deviations (one series in 500), or one is off by four; and of the stated ± most is that."""
    pulls = []
    for seed in range(12):
        cells, loop, _, true = closed(seed, HOLLOW, effects_tried=None)
        as_made = cells.with_deviation(loop.residual_after - loop.untold.raised)
        wear = find_wear(as_made, loop.noise, loop=loop)
        (region,) = (region for region in wear.regions if (region.tooth, region.side) == (TOOTH, LEFT))
        pulls.append((region.volume - true) / region.volume_std)
    assert sum(abs(pull) < 2.0 for pull in pulls) >= 9 and max(map(abs, pulls)) < 4.0


def test_its_tooth_has_the_amounts_that_the_rest_of_it_tells():
    """Not what the sum over all teeth leaves for it, −44 ± 0.6 µm of thickness for 10. The right flank, at cos α (T/2 − P), leaves P = T/2 open: by it the left
    one moves by cos α T, and that is as well known as sound flanks are off."""
    _, loop, own, _ = closed(1, HOLLOW)
    sound, doubts = np.arange(GEAR.teeth) != TOOTH, []
    for (known,), true in zip(each_tooth(loop), own, strict=True):
        off = true - np.array(known.value)
        assert abs(off[TOOTH] - off[sound].mean()) < 2.0 * known.std[TOOTH]
        assert np.abs(off[sound] - off[sound].mean()).max() < 5.0
        doubts.append(known.std[TOOTH])
    assert doubts[1] == pytest.approx(2.0 * doubts[0], rel=0.1) and doubts[1] == pytest.approx(
        1e3 * loop.untold.fields.max() / np.cos(np.deg2rad(20.0)), rel=0.02
    )


EVERY_THIRD = range(0, GEAR.teeth, 3)


def formed(seed: int, fillets_follow: bool):
    """A gear of pitch 6 µm and flanks all crowned by 6 µm, every third left one worn by 60 µm, of which the loop knows of pitch alone; cells, loop, index in
    µm, and the worn volume of each flank, mm³."""
    index = tuple(np.random.default_rng(seed).normal(0.0, 6.0, GEAR.teeth))
    effects = (Effect("pitch", {"index_um": index}), Effect("profile_crowning", {"crowning_um": 6.0}))
    wear = tuple(Patch(tooth, LEFT, 60.0, (36.5, 50.0), (-1.0, 16.0), 0.5) for tooth in EVERY_THIRD)
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=effects, fillets_follow=fillets_follow)
    scan = make_scan(recipe.of_size(20_000), seed)
    located = locate(scan.points, GEAR)
    cells = bin_points(located, CellGrid.for_scan(GEAR, len(located)), clip=0.4)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), effects=(PITCH,), worn=frozenset())
    return cells, loop, np.array(index), {flank.tooth: flank.volume_mm3 for flank in scan.truth.flanks}


def as_made(cells, loop):
    """Deviation of the gear as made, (m,) mm."""
    seen, patterns = cells.seen, sum(pattern.field for pattern in loop.patterns)
    own = np.zeros(len(seen))
    own[seen] = loop.deviation(cells.points.take(seen), frozenset(Kind))
    return own + cells.motion @ loop.motion + patterns + loop.untold.raised


def test_a_flank_that_is_no_datum_has_the_form_of_its_side():
    """With pitch alone, and fillets that tell nothing, left and right flank of a tooth add up to what form makes of them, the same on all teeth: of tooth k the
    left one was made as far out as the flanks of sound teeth add up to, less the right one."""
    cells, loop, _, _ = formed(2, fillets_follow=False)
    flank = (cells.points.surface == FLANK) & cells.seen
    height, made = np.zeros((2, GEAR.teeth, 2))
    for tooth, half in np.ndindex(GEAR.teeth, 2):
        on = flank & (cells.points.tooth == tooth) & (cells.points.side == 1 - 2 * half)
        height[tooth, half] = np.average((cells.points.deviation - cells.motion @ loop.motion)[on], weights=cells.count[on])
        made[tooth, half] = np.average((as_made(cells, loop) - cells.motion @ loop.motion)[on], weights=cells.count[on])
    sound = np.setdiff1d(np.arange(GEAR.teeth), EVERY_THIRD)
    expected = height[sound].sum(axis=1).mean() - height[EVERY_THIRD, 1]
    np.testing.assert_allclose(made[EVERY_THIRD, 0], expected, atol=4e-4)  # 6 µm of crowning move it by 4


@pytest.mark.parametrize(
    ("fillets_follow", "seeds"), [(False, [0]), *(pytest.param(one, range(3), marks=pytest.mark.long) for one in (True, False))]
)
def test_few_worn_flanks_beside_a_form_of_all(fillets_follow, seeds):
    """Their volume, together and each, within two and three standard deviations, and the index of their teeth as well known as is said."""
    for seed in seeds:
        cells, loop, index, true = formed(seed, fillets_follow)
        wear = find_wear(cells.with_deviation(cells.points.deviation - as_made(cells, loop)), loop.noise, loop=loop)
        assert {(region.tooth, region.side) for region in wear.regions} == {(tooth, LEFT) for tooth in EVERY_THIRD}
        assert abs(wear.volume - sum(true.values())) < 2.0 * wear.volume_std < 0.1 * wear.volume
        assert all(abs(region.volume - true[region.tooth]) < 3.0 * region.volume_std for region in wear.regions)
        (known,) = next(effect.parameters.values() for effect in loop.effects if effect.name == "pitch")
        off, worn = np.array(known.value) - index, np.isin(np.arange(GEAR.teeth), EVERY_THIRD)
        off -= off[~worn].mean()
        assert (np.abs(off[worn]) < 3.0 * np.array(known.std)[worn]).all() and abs(off[worn].mean()) < 1.0


def test_a_tooth_of_which_nothing_is_told_may_be_made_as_others_are():
    """Both its flanks hollow and its fillets as drawn: no amount is told, and each may be as large as those of the others are."""
    both = (HOLLOW, Patch(TOOTH, -LEFT, 200.0, (36.5, 42.5), (1.0, 14.0)))
    _, loop, *_ = closed(1, *both)
    sound = np.arange(GEAR.teeth) != TOOTH
    for (known,) in each_tooth(loop):
        scatter = float(np.sqrt(np.mean(np.array(known.value)[sound] ** 2)))
        assert known.value[TOOTH] == 0.0 and known.std[TOOTH] == pytest.approx(scatter, rel=0.02)


def test_a_flank_at_the_edge_of_what_was_seen_is_made_as_others_are():
    """All left flanks worn, and of the last tooth the left one seen near the tip alone: what it lacks there is its wear, and not a tooth thicker by what the
    amounts of all others do not add up to."""
    last, random = GEAR.teeth - 1, np.random.default_rng(5)
    index, thickness = random.normal(0.0, 6.0, GEAR.teeth), random.normal(0.0, 10.0, GEAR.teeth)
    thickness += 12.0 - thickness.mean()  # the sum of the others is far from 0
    effects = (Effect("pitch", {"index_um": tuple(index)}), Effect("thickness_variation", {"thickness_um": tuple(thickness)}))
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=(SlidingWear(50.0, LEFT),), effects=effects)
    scan = make_scan(recipe.of_size(20_000), 5)
    labels, radius = scan.truth.labels, np.hypot(*scan.points[:, :2].T)
    points = scan.points[(labels.tooth != last) | (labels.side != LEFT) | (radius > 42.0)]
    located = locate(points, GEAR)
    cells = bin_points(located, CellGrid.for_scan(GEAR, len(located)), clip=0.4)
    worn = frozenset({Side.LEFT})
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), PLAIN, worn=worn)
    for (known,), true in zip(each_tooth(loop), (index, thickness), strict=True):
        off = np.array(known.value) - true
        assert abs(off[last] - np.delete(off, last).mean()) < 2.0 * known.std[last] < 4.0 * true.std()
        assert np.delete(off, last).std() < 2.0
    wear = find_wear(cells.with_deviation(loop.residual_after - loop.untold.raised), loop.noise, worn, loop)
    volumes = {(flank.tooth, flank.side): flank.volume_mm3 for flank in scan.truth.flanks}
    (region,) = (region for region in wear.regions if region.tooth == last)
    assert abs(region.volume - volumes[last, LEFT]) < 2.0 * region.volume_std
