"""The result in words an engineer would use, hedged where it is doubtful."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from gearwear.comparison.results import PairResult, Results
from gearwear.comparison.weighed import WeighedLoss
from gearwear.design.gear import Gear
from gearwear.design.quantity import (
    SPACE,
    as_drawn,
    counted,
    listed,
    number,
    sentence,
    significant,
    teeth_words,
    with_std,
)
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.report.words.contact import reaches_beyond, why_open
from gearwear.report.words.effects import found_words
from gearwear.report.words.lost import (
    is_open,
    lost_from,
    lost_words,
    may_be_none,
    open_words,
    size_words,
    solid_words,
    where_lost,
    worn_so_thin,
)
from gearwear.report.words.numbers import between, effect_title, thickness_place, which_flanks
from gearwear.report.words.other_design import other_angles, wrong_design
from gearwear.scan.types import Scan
from gearwear.wear.breakage import MISSING_TOOTH
from gearwear.wear.regions import WearRegion
from gearwear.wear.tooth_summary import ThinnestTooth

LITTLE_SEEN, NOT_SEEN = 0.5, 0.05
"""Share of the flanks below which a result is doubtful; share of one side's below which that side was not seen."""
ABOVE_NOISE = 2.0
"""RMS of what is left, over the scan's own noise, above which that is not "nothing", pattern or not."""
LEAST_STD = 1e-4
"""mm; a standard deviation of contact below this is that of a gear on which nothing is worn: nothing."""
ALIKE = 0.9
"""Correlation of two effects' sizes from which on the scan gives little more than their sum or difference."""

LOPSIDED = 4.0
"""Standard deviations that the 95 % interval of the thinnest tooth reaches to one hand from which on it is told whole: the bottom of a hollow may lie deeper,
and no higher; what else may have made the teeth so goes one way."""
LEAST_NAME = 3
"""Letters of a file's name that are left of it at least."""


class KeyFigure(NamedTuple):
    """One of the figures that come first: its name, its value with the uncertainty, and what it refers to."""

    name: str
    value: str
    note: str


def verdict(results: Results) -> str:
    """What became of the gear, in one sentence or two."""
    text = _wear_found(results) if results.wear.regions else _no_wear(results)
    broken = broken_words(results)
    if broken:
        text = f"{broken}; {'besides, ' if results.wear.regions else ''}{text}"
    grave = grave_doubts(results)
    if not grave:
        return sentence(text)
    held = f"As it stands, {text}."
    if _wrong_design(results) is not None:
        held = "What is said of wear holds only if the design is right."
    return f"{sentence(f'doubtful, because {listed(grave)}')} {held}"


def broken_words(results: Results) -> str:
    """What is broken off, with its volume, which is not in the wear; "" where nothing is."""
    pieces = results.pieces
    if not pieces:
        return ""
    teeth = {kind: [piece.tooth + 1 for piece in pieces if piece.kind == kind] for kind in dict.fromkeys(p.kind for p in pieces)}
    said = []
    for kind, numbers in teeth.items():
        on = f"{'tooth' if len(set(numbers)) == 1 else 'teeth'} {listed(map(str, dict.fromkeys(numbers)))}"
        part = kind.split()[-1]  # corner or edge
        some = f"{'an' if part[0] in 'aeiou' else 'a'} {part}" if len(numbers) == 1 else f"{len(numbers)} {part}s"
        said.append(on if kind == MISSING_TOOTH else f"{some} of {on}")
    return f"{listed(said)} {'is' if len(pieces) == 1 else 'are'} broken off, {with_std(*results.broken_volume, 'mm³')}"


def _wear_found(results: Results) -> str:
    wear, worst = results.wear, results.wear.deepest
    assert worst is not None
    place, depth = which_flanks([worst]), deepest_range(results, worst) or _depth(worst.max_depth)
    where = which_flanks(wear.regions, wear.found)
    text = lost_from(results, where)
    if may_be_none(results):
        text = f"{where} may be worn: {lost_words(results)} is missing there, which may be none"
    if len(wear.regions) == 1:
        text += f", {depth} deep at its deepest" if " to " in depth.replace(SPACE, " ") else f", up to {depth} deep"
    else:
        text += f"; deepest, by {depth}, on {place}"
    tooth = wear.thinnest
    if tooth is not None and tooth.high < tooth.nominal:  # else it may as well be as designed
        loss = tooth.nominal - tooth.value
        which = "that tooth" if tooth.tooth == worst.tooth else f"tooth {tooth.tooth + 1}"
        text += (
            f"; {which} is {number(loss, 2 if loss >= 0.1 else 3)}{SPACE}mm ({significant(100.0 * loss / tooth.nominal, 2)}{SPACE}%)"
            f" thinner than designed {thickness_place(results.gear)}"
        )
    return "; ".join(filter(None, (text, open_words(results), worn_so_thin(results))))


def _no_wear(results: Results) -> str:
    otherwise = "nothing else" if results.pieces else "nothing"
    left, own = results.rms_left, noise(results)
    scatter = f"the scan's scatter of {significant(1e3 * own, 2)}{SPACE}µm"
    if left > ABOVE_NOISE * own > 0.0:  # a flank is judged by its neighbours, and they are as far off as this
        scatter = f"the {significant(1e3 * left, 2)}{SPACE}µm RMS by which the scan is off the design"
        scatter += " once what was found is taken out" if results.effects else ""
    text = f"no wear was found: {otherwise} on the flanks stands out of {scatter}"
    if is_open(results):
        return f"no wear stands out, but {open_words(results)}"
    limit = results.wear.found.would_have_shown
    if limit is None:
        return "; ".join(filter(None, (text, "the flanks are seen too thinly to say what would have shown", open_words(results))))
    extent = "" if results.planar else f" over {significant(limit.area, 2)}{SPACE}mm²"
    silent = sum(not flank.says for flank in results.wear.found.flanks)
    where = f"all but {counted(silent, 'flank')}, seen too thinly to say" if silent else "every flank"
    shown = f"wear of {significant(1e3 * limit.depth, 2)}{SPACE}µm{extent} would have shown on {where}"
    return "; ".join(filter(None, (text, shown, open_words(results))))


def depth_words(region: WearRegion, unit: str = "µm") -> str:
    """The deepest place of a worn flank, with its standard deviation where that is known."""
    if math.isfinite(region.max_depth_std) and region.max_depth_std > 0.0:
        return with_std(1e3 * region.max_depth, 1e3 * region.max_depth_std, unit)
    return SPACE.join(filter(None, (number(1e3 * region.max_depth, 0), unit)))


def deepest_range(results: Results, worst: WearRegion) -> str:
    """Between what the deepest place lies where more than its standard deviation is open, its own 95 % with it; "" where it is not."""
    limits = results.open_volume.depth_limits(worst)
    return "" if limits is None else between((1e3 * limits[0], 1e3 * limits[1]), 0, "µm")


def _depth(depth: float) -> str:
    return f"{number(depth, 2)}{SPACE}mm" if depth >= 1.0 else f"{number(1e3 * depth, 0)}{SPACE}µm"


def noise(results: Results) -> float:
    """The scan's own noise, mm."""
    return results.measured.placed.registration.noise if results.loop is None else results.loop.noise


def loop_words(results: Results) -> str:
    """What the closed loop found, named or not, and what it did to the error; a few sentences."""
    loop, effects = results.loop, results.effects
    if loop is None:
        return "No effect of measurement or manufacture was looked for: whatever differs from the design counts as it stands."
    said, beside = [], "besides wear " if results.wear.regions else ""
    if effects:
        said.append(f"{beside}the scan shows {listed(found_words(effect, results.open_sizes(effect)) for effect in effects)}")
        for others in dict.fromkeys(effect.alternatives for effect in effects if effect.alternatives):
            alike = listed((effect_title(effect.name) for effect in effects if effect.alternatives == others), "or")
            said.append(f"the data cannot tell {alike} from {listed(map(effect_title, others), 'or')}")
        said += alike_words(results)
        text = f"taking {'it' if len(effects) == 1 else 'them'} out brings the RMS outside wear from {_um(loop.rms_before)} to {_um(loop.rms_after)}{SPACE}µm"
        if math.isfinite(loop.held_out_before) and math.isfinite(loop.held_out_after):
            text += f" ({_um(loop.held_out_before)} to {_um(loop.held_out_after)}{SPACE}µm on data the fit never saw)"
        said.append(f"{text}; the scan's own noise is {_um(loop.noise)}{SPACE}µm")
    else:
        said.append(f"{beside}no {'known ' if loop.patterns else ''}effect of measurement or manufacture stands out")
    return " ".join(map(sentence, [*said, unexplained_words(loop, results.gear)]))


def alike_words(results: Results) -> list[str]:
    """Which effects of those named the scan can hardly tell apart, a clause each: forms that the drawing leaves open are not named."""
    named = {effect.name for effect in results.effects}
    return [
        f"the sizes of {effect_title(pair.effects[0])} and {effect_title(pair.effects[1])} are correlated by {number(pair.value, 2)}:"
        f" their {'difference' if pair.value > 0.0 else 'sum'} is known far better than either"
        for pair in (() if results.loop is None else results.loop.correlations)
        if abs(pair.value) > ALIKE and named.issuperset(pair.effects)
    ]


def unexplained_words(loop: Loop, gear: Gear, where: bool = True) -> str:
    """What no effect of the catalogue explains, and where it is."""
    if loop.patterns:
        text = f"unexplained: a pattern of {_um(loop.unexplained_rms)}{SPACE}µm RMS that no known effect describes"
        if loop.in_space:
            text += f", {'in part ' if len(loop.in_space) < len(loop.patterns) else ''}a wave that stands in space as fringes of a scanner do"
        return f"{text} ({pattern_words(loop, gear)})" if where else text
    if loop.rms_after > ABOVE_NOISE * loop.noise > 0.0:
        much = f"{_um(loop.rms_after)}{SPACE}µm RMS against the scan's own noise of {_um(loop.noise)}{SPACE}µm"
        return f"what is left, {much}, has no pattern that stands out"
    return "nothing significant is left unexplained"


def pattern_words(loop: Loop, gear: Gear) -> str:
    """The patterns without a name."""
    return "; ".join(pattern.describe(gear.face_width) for pattern in loop.patterns)


def doubts(results: Results) -> list[str]:
    """Everything a reader must know before trusting the numbers, as sentences; [] where all is well."""
    said = doubts_of_design(results)
    value, std = results.wear.volume, results.wear.volume_std
    if results.wear.regions and value > 0.0 and std > 0.3 * value:
        said.append(f"what is lost is known to ±{SPACE}{significant(100.0 * std / value, 2)}{SPACE}% only")
    if results.loop is not None and results.loop.patterns:
        said.append(unexplained_words(results.loop, results.gear))
    said += weighed_words(results.weighed) if results.weighed is not None and not results.weighed.agrees else []
    said += silent_words(results)
    said += [*results.notes, *results.measured.placed.registration.notes]
    said += weighed_words(results.weighed)
    said += solid_words(results)
    harmless = set(results.design.warnings)  # about the drawing, not about this result
    return [sentence(text) for text in dict.fromkeys(said) if text not in harmless]


def doubts_of_design(results: Results) -> list[str]:
    """What puts the whole result in question, and angles that are not the drawing's, a clause each."""
    angles = other_angles(results.gear, results.seen, results.effects, results.measured.scale)
    return [*(f"doubtful: {text}" for text in grave_doubts(results)), *angles]


def silent_words(results: Results) -> list[str]:
    """That too little of some flanks was seen to say whether they are worn: one sentence beside wear that was found elsewhere, else none (without
    any wear the verdict says so)."""
    told = {(region.tooth, region.side) for region in results.wear.regions}
    gone = {piece.tooth for piece in results.measured.broken if piece.side is None}
    flanks = [flank for flank in results.wear.found.flanks if flank.tooth not in gone]
    silent = [flank for flank in flanks if not flank.says and (flank.tooth, flank.side) not in told]
    if not told or not silent:
        return []
    be, they = ("is", "it is") if len(silent) == 1 else ("are", "they are")
    teeth, sides = teeth_words(flank.tooth + 1 for flank in silent), {flank.side for flank in silent}
    which = f"{len(silent)} {sides.pop()} flanks" if len(sides) == 1 < len(silent) else f"{len(silent)} of {len(flanks)} flanks"
    return [f"{which}, on {teeth}, {be} seen too thinly to say whether {they} worn"]


def weighed_words(weighed: WeighedLoss | None) -> list[str]:
    """What the scale says to the lost volume: one sentence, or none where nothing was weighed."""
    if weighed is None:
        return []
    if weighed.mass < 0.0:
        scale = f"by weighing the gear became heavier by {significant(-1e3 * weighed.mass)}{SPACE}mg"
    else:
        scale = f"by weighing {with_std(*weighed.weighed, 'mm³')} are gone ({significant(1e3 * weighed.mass)}{SPACE}mg)"
    if weighed.agrees:
        return [f"{scale}: this agrees with the scan"]
    times = significant(abs(weighed.difference) / weighed.difference_std)
    more = "more" if weighed.difference > 0.0 else "less"
    return [
        f"{scale}: {significant(abs(weighed.difference))}{SPACE}mm³ {more} than the scan says, {times} standard deviations; what was not scanned, dirt, "
        "or a density that is not the stated one would explain it"
    ]


def grave_doubts(results: Results) -> list[str]:
    """What puts the whole result in question."""
    placed, coverage = results.measured.placed, results.measured.coverage
    grave = [] if placed.registration.converged else ["the registration did not settle"]
    lost = [str(i + 1) for i, view in enumerate(placed.views) if not view.registration.converged]
    if lost:
        grave.append(f"{'view' if len(lost) == 1 else 'views'} {listed(lost)} could not be placed for certain")
    unseen = [side for side in Side if coverage[f"flank_{side}"] < NOT_SEEN]
    if coverage["flank"] < LITTLE_SEEN:
        which = f", of the {unseen[0]} ones next to nothing" if len(unseen) == 1 else ""
        grave.append(f"only {100 * coverage['flank']:.0f}{SPACE}% of the flanks was seen{which}")
    other = _wrong_design(results)
    return grave if other is None else [*grave, other]


def _wrong_design(results: Results) -> str | None:
    drawn = results.design.gears[results.part]
    return wrong_design(results.gear, results.seen, results.rms_left, results.measured.scale, drawn)


def _um(value: float) -> str:
    return significant(1e3 * value)


def key_figures(results: Results) -> list[KeyFigure]:
    """The figures that come first."""
    wear, loop, planar = results.wear, results.loop, results.planar
    size = size_words(results)
    flanks = where_lost(results)
    if results.pieces:
        flanks += "; without what is broken off"
    key = [
        KeyFigure("Section lost", size, "a planar section: area, not volume") if planar else KeyFigure("Metal lost", size, flanks)
    ]
    worst = wear.deepest
    if worst is not None:
        where = f"tooth {worst.tooth + 1}, {worst.side} flank{'' if planar else ', mean of 0.5 × 0.5 mm'}"
        key.append(KeyFigure("Deepest wear", deepest_range(results, worst) or depth_words(worst), where))
    tooth = wear.thinnest
    if tooth is not None:
        where = "" if planar else f" at z = {number(tooth.at_z, 1)}{SPACE}mm"
        why = f"; {tooth.wider}; {where.strip()}" if tooth.wider is not None and lopsided(tooth) else where
        across = "" if results.gear.twist == 0.0 else ", transverse arc"
        note = f"tooth {tooth.tooth + 1}{why.removesuffix('; ')}; design {number(tooth.nominal, 3)}{SPACE}mm, {thickness_place(results.gear)}{across}"
        key.append(KeyFigure("Thinnest tooth", thinnest_words(tooth), note))
    if results.pair is not None:
        key += _contact_figures(results)
    before, name = results.plain_rms if loop is None else loop.rms_before, "Error outside wear, RMS"
    own_noise = f"the scan's own noise is {_um(noise(results))}{SPACE}µm"
    if loop is None:
        key.append(KeyFigure(name, f"{_um(before)}{SPACE}µm", f"no effect was looked for; {own_noise}"))
    elif results.effects:
        value = f"{_um(before)} → {_um(loop.rms_after)}{SPACE}µm"
        key.append(KeyFigure(name, value, f"{counted(len(results.effects), 'effect')} taken out; {own_noise}"))
    else:
        key.append(KeyFigure(name, f"{_um(loop.rms_after)}{SPACE}µm", f"no effect is named; {own_noise}"))
    return key


def _contact_figures(results: Results) -> list[KeyFigure]:
    pair = results.pair
    assert pair is not None
    std, te_std = pair.greatest_backlash_std, 0.0 if pair.spread is None else 1e3 * pair.spread.transmission_error
    play_std = 0.0 if std is None else std.circumferential
    figures = [
        _contact_figure(
            pair, "Backlash, greatest", (pair.greatest_backlash.circumferential, play_std, 3, "mm", LEAST_STD), pair.open_greatest,
            f"design {number(pair.design.backlash.circumferential, 3)}{SPACE}mm, circumferential",
        ),
        _contact_figure(
            pair, "Transmission error", (pair.contact.peak_to_peak_um, te_std, 1, "µm", 1e3 * LEAST_STD), pair.open_error_um,
            "peak to peak over a revolution, unloaded",
        ),
    ]  # fmt: skip
    if pair.loaded is not None:
        present, loaded_std = pair.loaded.present, pair.loaded.spread.std("transmission_error")
        value = known(1e3 * present.peak_to_peak, 1e3 * loaded_std, 1, "µm", 1e3 * LEAST_STD)
        note = f"at {significant(present.load_per_width)}{SPACE}N/mm; design {number(1e3 * pair.loaded.design.peak_to_peak, 1)}{SPACE}µm"
        figures.append(KeyFigure("The same under load", value, note))
    return figures


def _contact_figure(
    pair: PairResult, name: str, told: tuple[float, float, int, str, float], limits: tuple[float, float] | None, note: str
) -> KeyFigure:
    """A number of the contact as `known` words it; within what it lies in its place where that is more."""
    value, std, digits, unit, _ = told
    shown = known(*told)
    if limits is None or not reaches_beyond(value, std, limits, digits):
        return KeyFigure(name, shown, note)
    if max(value - limits[0], limits[1] - value) > LOPSIDED * std:
        shown, beside = between(limits, digits, unit), f"likeliest {number(value, digits)}"
    else:
        beside = f"{between(limits, digits)} not excluded"
    return KeyFigure(name, shown, f"{beside}; {why_open(pair)}; {note}")


def thinnest_words(tooth: ThinnestTooth) -> str:
    """The least thickness, with its standard deviation; the 95 % interval in its place where that reaches much further."""
    if lopsided(tooth):
        return between((tooth.low, tooth.high), 3, "mm")
    return known(tooth.value, tooth.std, 3, "mm", 0.0)


def lopsided(tooth: ThinnestTooth) -> bool:
    """Whether the 95 % interval of the least thickness reaches so much further than its standard deviation says that it is told in its place."""
    return max(tooth.value - tooth.low, tooth.high - tooth.value) > LOPSIDED * tooth.std > 0.0


def known(value: float, std: float, digits: int, unit: str = "", least: float = LEAST_STD) -> str:
    """A value with its standard deviation, where that says something; else to a fixed number of digits."""
    if math.isfinite(value) and std > 0.0 and std >= least:
        return with_std(value, std, unit)
    return f"{number(value, digits)}{SPACE}{unit}" if unit else number(value, digits)


def subject(part: str, gear: Gear, scans: Sequence[Scan], room: int | None = None) -> str:
    """What was measured: the gear and the scan, on one line; where there is `room` for so many letters only, blanks go, then the
    unit of the module, and then the end of the file's name before its extension, but no number."""
    facts = [
        f"{'internal, ' if gear.spec.internal else ''}z = {gear.teeth}",
        f"m = {as_drawn(gear.spec.normal_module)}{SPACE}mm",
        f"α = {as_drawn(math.degrees(gear.spec.normal_pressure_angle))}°",
    ]
    if gear.twist != 0.0:
        facts.append(f"β = {as_drawn(abs(math.degrees(gear.helix_angle)))}° {gear.spec.hand}")
    files = [file for scan in scans for file in scan.files]
    points = sum(scan.read for scan in scans)
    name, more = Path(files[0]).name, f" and {len(files) - 1} more" if len(files) > 1 else ""
    before, after = f"{part}, {', '.join(facts)} · ", f"{more}, {number(points, 0)} points"
    for blank, short in ((" = ", "="), (f"{SPACE}mm", "")):  # modules are in mm
        if room is not None and len(before) + len(name) + len(after) > room:
            before = before.replace(blank, short)
    left = len(name) if room is None else max(room - len(before) - len(after), LEAST_NAME)
    return f"{before}{shortened(name, left)}{after}"


def shortened(name: str, room: int) -> str:
    """A file's name in so many letters: its beginning and its extension, without that where it would leave next to nothing of the beginning.

    >>> shortened("w2_left_flank.ply", 16), shortened("w2_left_flank.ply", 5), shortened("w2.ply", 16)
    ('w2_left_fla….ply', 'w2_l…', 'w2.ply')
    """
    if len(name) <= room:
        return name
    extension = Path(name).suffix
    begin = room - 1 - len(extension)
    return f"{name[:begin]}…{extension}" if begin >= LEAST_NAME else f"{name[: room - 1]}…"
