"""No sentence of a result contradicts another: what is said of the datum and what is found of wear."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.comparison.notes import in_accord, worn_notes
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.report.words.verdict import doubts, key_figures, verdict
from tests.report.fake import changed, real_results


def left_out(side: Side):
    """The small real result, worn on a left flank, with a side left out as datum."""
    measured = changed(real_results().measured, "placed.registration.datum.worn_side", side)
    return changed(measured, "placed.registration.unseen", ("another note",))


def test_a_side_that_is_worn_may_look_worn():
    measured = changed(left_out(Side.LEFT), "loop.worn_sides", frozenset({Side.LEFT}))
    (region,) = real_results().wear.regions
    regions = tuple(replace(region, tooth=tooth) for tooth in range(12))
    results = changed(real_results(), "wear.found.regions", regions)
    results = changed(results, "measured", in_accord(measured, results.wear.found))
    assert "All left flanks look worn" in " ".join(doubts(results))


def test_flanks_that_were_not_seen_are_not_said_to_look_worn():
    """Nine of 27 teeth were scanned: "all left flanks look worn" stood under "teeth 1 and 11 to 27 were not seen"."""
    measured = changed(left_out(Side.LEFT), "loop.worn_sides", frozenset({Side.LEFT}))
    (region,) = real_results().wear.regions
    wear = real_results().wear.found
    count = wear.side_maps.count.copy()
    count[4:] = 0.0
    wear = replace(
        wear, regions=tuple(replace(region, tooth=tooth) for tooth in range(4)), side_maps=replace(wear.side_maps, count=count),
        flanks=tuple(replace(flank, depth=flank.depth if flank.tooth < 4 else np.nan) for flank in wear.flanks),
    )  # fmt: skip
    results = changed(changed(real_results(), "wear.found", wear), "measured", in_accord(measured, wear))
    assert "All left flanks that were seen look worn" in " ".join(doubts(results))
    assert "from all 4 left flanks that were seen" in verdict(results).replace("\u202f", " ")
    assert key_figures(results)[0].note.startswith("from all 4 left flanks seen")


def test_a_side_of_which_some_flanks_are_sound_is_not_said_to_look_worn_on_all():
    """20 of 29 flanks were worn: "from 20 left flanks" and "all left flanks look worn" stood on one screen."""
    measured = changed(left_out(Side.LEFT), "loop.worn_sides", frozenset({Side.LEFT}))
    results = changed(real_results(), "measured", in_accord(measured, real_results().wear.found))
    said = " ".join(doubts(results))
    assert (
        "Wear stands out on 1 of 12 left flanks and none of them is used as datum; the right (coast) flanks are assumed unworn"
        in said
    )
    assert "All left" not in said


def test_a_side_of_which_one_flank_is_worn_is_not_said_to_look_worn_all_over():
    measured = changed(left_out(Side.LEFT), "loop.worn_sides", frozenset())
    results = changed(real_results(), "measured", in_accord(measured, real_results().wear.found))
    said = " ".join(doubts(results))
    assert "look worn" not in said and "wear stands out on 1 of them" in said


@pytest.mark.parametrize("side", Side)
def test_a_side_without_wear_is_not_said_to_look_worn(side):
    results = changed(real_results(), "wear.found.regions", ())
    results = changed(results, "measured", in_accord(left_out(side), results.wear.found))
    said = " ".join([verdict(results), *doubts(results)])
    assert "No wear was found" in said and "look worn" not in said
    assert f"the {side} flanks bend otherwise than the {side.opposite} ones and are not used as datum" in said.replace(
        "The", "the"
    )
    assert "Another note." in said


@pytest.mark.parametrize("throughout", [frozenset(), frozenset({Side.RIGHT})])
def test_flanks_with_wear_are_not_among_those_assumed_unworn(throughout):
    """The right side was left out as datum; of the left flanks, on which wear was found, "the left flanks are assumed unworn" was said."""
    (region,) = real_results().wear.regions
    assert region.side is Side.LEFT
    wear = replace(
        real_results().wear.found,
        regions=(region, replace(region, tooth=5), *([replace(region, side=Side.RIGHT)] * len(throughout))),
    )
    measured = in_accord(changed(left_out(Side.RIGHT), "loop.worn_sides", throughout), wear)
    said = " ".join(doubts(changed(changed(real_results(), "wear.found", wear), "measured", measured)))
    assert "all left flanks but 2 are assumed unworn" in said


def test_both_sides_worn_are_not_said_to_be_one():
    """Where both sides look worn it is said what that leaves open, and not that one of them may be."""
    measured = changed(real_results().measured, "placed.registration.datum.low", 0.008)
    measured = changed(measured, "loop.worn_sides", frozenset(Side))
    flank = measured.first.points.surface == FLANK
    after = measured.loop.residual_after - np.where(flank, 0.008, 0.0)
    measured = in_accord(changed(measured, "loop.residual_after", after), real_results().wear.found)
    assert not any("one side and a rotation" in note for note in measured.placed.registration.notes)
    assert any("thinner teeth" in note for note in worn_notes(measured, real_results().wear.found))


def test_no_side_left_out_no_word_of_it():
    measured = real_results().measured
    assert in_accord(measured, real_results().wear.found) is measured


@pytest.mark.parametrize("side", Side)
def test_the_other_side_is_not_assumed_unworn_where_both_look_worn(side):
    measured = changed(left_out(side), "loop.worn_sides", frozenset(Side))
    results = changed(real_results(), "measured", in_accord(measured, real_results().wear.found))
    assert "assumed unworn" not in " ".join(doubts(results))
    (note,) = [note for note in worn_notes(measured, results.wear.found) if "both sides" in note]
    assert "no wear stands out on the right ones" in note  # the small result is worn on a left flank


@pytest.mark.parametrize("low_um", [0.0, 8.0])
def test_flanks_are_said_to_be_low_where_what_was_found_leaves_them_so(low_um):
    """8 µm against fillets and tips beside all effects, or none once they are taken out."""
    measured = changed(real_results().measured, "placed.registration.datum.low", 0.008)
    measured = changed(measured, "placed.registration.unseen", ("another note",))
    flank = measured.first.points.surface == FLANK
    after = measured.loop.residual_after - np.where(flank, 1e-3 * low_um, 0.0)
    said = in_accord(changed(measured, "loop.residual_after", after), real_results().wear.found).placed.registration.notes
    assert ("another note" in said, len(said)) == (True, 2 if low_um else 1)
