"""The scan of the same gear before it was worn: what changed since, and on which sides throughout."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import MeasuredGear, laid, register
from gearwear.comparison.same_teeth import SameTeeth, same_teeth
from gearwear.design.pair import Design
from gearwear.design.side import Side
from gearwear.design.surface import BORE, FLANK, ROOT, TIP
from gearwear.diagnose.effects.bent_tooth import BENT_TOOTH
from gearwear.diagnose.no_datum import leaves_a_datum
from gearwear.diagnose.rules import rules
from gearwear.errors import InputError
from gearwear.placing.cells import Cells
from gearwear.placing.least_squares import solved
from gearwear.placing.pose import motion_columns
from gearwear.robust import huber_weight, median_scale, scale_about, tukey_weight
from gearwear.scan.reading import check_different, read_scan
from gearwear.scan.types import Scan
from gearwear.wear.regions import Wear, find_wear

ROUNDS = 8
"""Of a robust fit, until its weights stay; numerical."""
MOST_ROUNDS = 3
"""Of the loop, until the sides that changed are those it left out; numerical."""


def unworn_gear(
    stated: Design, after: MeasuredGear, files: Sequence[str | Path | Scan], units: str, loop: bool, stream: bool | None = None
) -> tuple[MeasuredGear, SameTeeth]:
    """The same gear before wear, in the same cells, its teeth numbered as those of the scan; and how these were told. The scan has no
    artefact: of its scale is known what was stated of the scanner, not what the worn gear's artefact told."""
    numbered = stated.datum.before_tooth_1 is not None
    design = replace(after.design, datum=stated.datum.before, scanner=stated.scanner)
    scans = read_scan(files, units, stream)
    check_different(after.scans, scans, "a scan of the gear before it ran would be right")
    unworn = register(design, scans, after.part, grid=after.cells.grid)
    if unworn.planar != after.planar:
        raise InputError(f"{unworn.scans[0].files[0]}: one of the scans before and after wear is a planar section; both or none")
    same = SameTeeth(0, False, 1.0, stated=True) if numbered else same_teeth(after, unworn)
    if not same.as_it_lay:
        unworn = laid(unworn, same.motion(unworn.gear))
    return (find_effects(unworn) if loop else unworn), same


def what_changed(after: MeasuredGear, unworn: MeasuredGear) -> Cells:
    """What changed from before to after. What both scans share is design, manufacture and scanner; each scan's own measurement
    effects are taken out first, as is what bent a tooth, and then what of the difference a motion, a coat and a scale explain. Where the unworn gear was not
    seen, the effects found in the worn one stand in for it."""
    corrected, before = after.corrected, unworn.corrected.points.deviation
    changed = corrected.points.deviation - before - _bent(after) + _bent(unworn)
    changed -= _measured_otherwise(corrected, changed, after, unworn)
    return corrected.with_deviation(np.where(np.isfinite(before), changed, after.as_made.points.deviation))


def _bent(measured: MeasuredGear) -> Floats:
    """What teeth that an overload bent do to the deviation of each cell, (m,) mm: metal that was moved and not lost."""
    cells, loop, result = measured.cells, measured.loop, np.zeros(len(measured.cells.count))
    if loop is not None:
        points = cells.points.take(cells.seen)
        bent = (loop.of_effect(effect, points) for effect in loop.effects if effect.name == BENT_TOOTH)
        result[cells.seen] = sum(bent, np.zeros(len(points)))
    return result


def _measured_otherwise(cells: Cells, changed: Floats, after: MeasuredGear, unworn: MeasuredGear) -> Floats:
    """What of the difference (m,), mm, is how the worn gear was measured and placed: a coat and a scale, as what is no flank has them, and then a motion.

    Each scan was placed by what it shows, and an unworn gear by the flanks of both sides: how these were cut against one another turned it by what it turns no gear of
    which one side is worn; and a coat that one scan alone takes for thick teeth is none of these beside the other. In the difference nothing is left of how the gear was made.
    Flanks of sides worn throughout tell nothing. Of others Huber's weights hold what wore back, and let no side go: an even loss of both is a turn to neither.
    """
    on = cells.points
    both, flank = np.isfinite(changed), on.surface == FLANK
    variance = after.noise**2 / np.maximum(cells.count, 1.0) + unworn.noise**2 / np.maximum(unworn.cells.count, 1.0)
    motion = motion_columns(on.position, on.normal)
    found = np.zeros(len(changed))
    # On flanks a coat is thicker teeth, and a loss of both sides a thinner coat.
    if np.isin(on.surface[both], (TIP, ROOT, BORE)).any():
        columns = np.column_stack([motion, np.ones(len(changed)), (on.position * on.normal).sum(axis=1)])
        found += _robust(columns, changed, variance, both & ~flank)
    worn = [int(side) for side in after.worn_sides | unworn.worn_sides]
    return found + _robust(motion, changed - found, variance, both & ~(flank & np.isin(on.side, worn)))


def _robust(columns: Floats, target: Floats, variance: Floats, tells: Bools) -> Floats:
    """What some columns (m, p) explain of a target (m,) by the cells that tell, everywhere; fitted with Huber's weights, and from there one
    step with Tukey's, in which what lies far off has no say."""
    amounts = np.zeros(columns.shape[1])
    for weight in (*[huber_weight] * ROUNDS, tukey_weight):
        left = (target[tells] - columns[tells] @ amounts) / np.sqrt(variance[tells])
        amounts = solved(columns[tells], target[tells], weight(left, scale_about(left)) / variance[tells])
    return np.asarray(columns @ amounts)


def told_by_both(after: MeasuredGear, unworn: MeasuredGear) -> tuple[MeasuredGear, frozenset[Side]]:
    """The worn gear with the sides worn throughout that both scans tell, and these: what one scan alone suggests of made and worn does not count.

    A side that was no datum, or was one wrongly, moves the pose and with it the other side: the loop is closed until they stay.
    """
    sides = sides_that_changed(after, unworn)
    for _ in range(MOST_ROUNDS):
        if after.loop is None or sides == after.worn_sides:
            break
        if not leaves_a_datum(
            after.first, after.context, sides
        ):  # where it stands they tell themselves, and what they lost both scans
            return replace(after, loop=replace(after.loop, made=None, no_datum=frozenset())), sides
        after = find_effects(after, sides)
        sides = sides_that_changed(after, unworn)
    if after.loop is None:
        return after, sides
    return replace(after, loop=replace(after.loop, made=None)), after.worn_sides  # how it was made was seen


def sides_that_changed(after: MeasuredGear, unworn: MeasuredGear) -> frozenset[Side]:
    """Sides that lost metal throughout: whose flanks lie lower than before by more than chance, all but a few of them.

    Nothing that was made so is in a difference, so that any loss is wear, an even one too. What pose and effects of both scans leave open of the level
    of a side is known (`Loop.level_std`), and flanks that differ tell how well their middle is known. A side that the worn scan alone calls worn is
    taken for sound only where the difference lies nearer to nothing than to the loss that scan tells.
    """
    noise = float(np.hypot(after.noise, unworn.noise))
    grid = after.cells.grid
    change, alone = (grid.flank_shape(cells.points.deviation) for cells in (what_changed(after, unworn), after.as_made))
    sides = set()
    for side in Side:
        lost = [-float(np.nanmean(tooth)) for tooth in change[:, side.index] if np.isfinite(tooth).any()]
        if not lost:
            continue
        middle, scatter = median_scale(np.array(lost))
        std = math.hypot(1.25 * scatter / math.sqrt(len(lost)), after.level_std[side.index], unworn.level_std[side.index])
        least = max(rules().errors * std, rules().least_share * noise)
        if side in after.worn_sides:
            least = min(least, max(-0.5 * float(np.nanmean(alone[:, side.index])), rules().least_share * noise))
        few = sum(depth <= 0.0 for depth in lost) <= rules().blank_flanks * len(lost)
        if few and middle > least:
            sides.add(side)
    return frozenset(sides)


def grown_since(after: MeasuredGear, unworn: MeasuredGear, changed: Cells, scatter: float) -> Wear:
    """Where the later scan has more metal than that of the gear before wear, as if it were worn there the other way round.

    Parameters
    ----------
    after, unworn : MeasuredGear
        Of the worn gear, and of the same before.
    changed : Cells
        `what_changed` from one to the other.
    scatter : float
        Of that, mm.
    """
    sides = sides_that_changed(unworn, after)
    return find_wear(
        changed.with_deviation(-changed.points.deviation), scatter, sides, after.loop, limits=False, gone=after.gone | unworn.gone
    )
