"""How high a flank was made that is no datum itself, told by sound flanks left out in turn."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import FLANK, locate
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.wear.regions import find_wear
from tests.placing.placing import designed
from tests.synthetic import Effect, Patch, Recipe, make_scan

GEAR = designed()
TOOTH, LEFT = 3, 1
HOLLOW = Patch(TOOTH, LEFT, 200.0, (36.5, 42.5), (1.0, 14.0))
"""Over most of a flank: no more is a datum."""


def closed(seed: int, *wear, spread_um: float = 10.0):
    """A ground gear of which every tooth has pitch and thickness of its own (µm), its fillets as drawn; cells, loop, and the worn volume put in, mm³."""
    random = np.random.default_rng(seed)
    own = [random.normal(0.0, spread_um, GEAR.teeth) for _ in range(2)]
    effects = (Effect("pitch", {"index_um": tuple(own[0])}), Effect("thickness_variation", {"thickness_um": tuple(own[1])}))
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=effects, fillets_follow=False)
    scan = make_scan(recipe.of_size(20_000), seed)
    located = locate(scan.points, GEAR)
    cells = bin_points(located, CellGrid.for_scan(GEAR, len(located)), clip=0.4)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), worn=frozenset())
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
    assert found.shape[1] == 1
    np.testing.assert_array_equal(found[:, 0] > 0.0, own)
    off = np.concatenate([0.8 * thickness + 0.4 * pitch, 0.8 * thickness - 0.4 * pitch])
    sound = np.arange(len(off)) != TOOTH
    expected = 1e-3 * np.cos(np.deg2rad(20.0)) * float(np.sqrt(np.mean(off[sound] ** 2)))
    assert found.max() == pytest.approx(expected, rel=0.1)


@pytest.mark.long
def test_flanks_that_tell_their_own_level_have_no_doubt():
    _, loop, *_ = closed(1)
    assert loop.untold is None


@pytest.mark.long
def test_the_volume_of_a_hollow_flank_is_as_sure_as_is_said():
    """12 gears, refused where less than 9 lie within two standard deviations (one series in 500), or one is off by four; and of the stated ± most is that."""
    pulls = []
    for seed in range(12):
        cells, loop, _, true = closed(seed, HOLLOW)
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


def test_a_tooth_of_which_nothing_is_told_may_be_made_as_others_are():
    """Both its flanks hollow and its fillets as drawn: no amount is told, and each may be as large as those of the others are."""
    both = (HOLLOW, Patch(TOOTH, -LEFT, 200.0, (36.5, 42.5), (1.0, 14.0)))
    _, loop, *_ = closed(1, *both)
    sound = np.arange(GEAR.teeth) != TOOTH
    for (known,) in each_tooth(loop):
        scatter = float(np.sqrt(np.mean(np.array(known.value)[sound] ** 2)))
        assert known.value[TOOTH] == 0.0 and known.std[TOOTH] == pytest.approx(scatter, rel=0.02)
