"""What the reader must know of a comparison beside its numbers: sides that look worn, edges, the scanner, a forecast that there is none of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.comparison.open_volume import even_loss, level_open, thinning_open
from gearwear.comparison.placed_notes import THINNED, alone
from gearwear.comparison.results import PairResult
from gearwear.comparison.same_teeth import SameTeeth
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.quantity import NORMAL_95, counted, listed, number, significant
from gearwear.design.scan_spec import ScannerSpec
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, TIP
from gearwear.diagnose.effects import named_effects
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from gearwear.diagnose.found import Loop
from gearwear.diagnose.no_datum import BESIDE
from gearwear.loaded.study import load_left_out
from gearwear.placing.datum import LOW, Datum, bends_otherwise, taken_for_unworn
from gearwear.wear.regions import UNIT, Wear
from gearwear.wear.tooth_summary import DriftSeam
from gearwear.wear_law.study import Ahead

HALVES = "double helical: taper, twist and feed marks are not looked for; the halves are inspected one by one"
SECTION_WEIGHED = "[weighing] is left out: the gear was weighed, but a planar section has no volume"
"""Said of a weighed gear of which only a section was scanned."""
ELSEWHERE = 0.2
"""Share of tips, fillets or roots that must be seen for a coat to show on them."""
BY_CHANCE = 1e-3
"""Chance below which one wave of pitch errors is more than that."""
GROWN = 3.0
"""Standard deviations by which more metal came than went between two scans for them to be the wrong way round."""
UNLIKE = 2.0
"""Factor between the noise found and the noise stated of the scanner from which it is said."""


def notes_of(
    design: Design,
    measured: MeasuredGear,
    remarks: tuple[str, ...],
    wear: Wear,
    before: SameTeeth | None,
    pair: PairResult | None,
    ahead: Ahead | None,
    seam: DriftSeam | None = None,
    grown: Wear | None = None,
) -> tuple[str, ...]:
    """All notes of a comparison, each a sentence.

    Parameters
    ----------
    design : Design
        As stated.
    measured : MeasuredGear
    remarks : tuple of str
        `MeasuredGear.remarks`.
    wear : Wear
    before : SameTeeth or None
        How the teeth of the scan before wear were told; None without one.
    pair : PairResult or None
    ahead : Ahead or None
        What was to be forecast.
    seam : DriftSeam or None
        The tooth that is told too thin or too thick were pitch errors a drift of the scan.
    grown : Wear or None
        Where the scan has more metal than that before wear (`grown_since`); None without one.
    """
    gear, unworn = measured.gear, before is not None
    return (
        *_other_way_round(wear, grown),
        *measured.doubts,  # what changes the meaning of numbers first: a terminal shows the first few
        *like_a_table(measured.loop, design.scanner),
        *off_the_drawing(measured.loop),
        *take_each_other_back(measured.loop),
        *((THINNED.format(thinning=gear.spec.thinning),) if thinning_open(measured, unworn) else ()),
        *worn_notes(measured, wear, unworn),
        *contact_note(pair),
        *((seam_note(seam),) if seam is not None and (seam.of_thinnest or _worn(wear, seam.tooth)) else ()),
        *(() if before is None or before.sure else (before.sentence("the gear in the scan before wear"),)),
        *edge_notes(wear),
        *scanner_notes(design.scanner, measured.placed.registration.noise),
        *scanner_unstated(measured),
        *((SECTION_WEIGHED,) if design.weighing is not None and measured.planar else ()),
        *load_left_out(design),
        *_no_forecast(pair, ahead),
        *_off_reference(gear),
        *dict.fromkeys((*remarks, *design.warnings)),  # an assumed root is said by both
        *((HALVES,) if gear.spec.gap > 0.0 else ()),
        *(() if pair is not None else (alone(measured.context),)),
    )


def in_accord(measured: MeasuredGear, wear: Wear, before: bool = False) -> MeasuredGear:
    """The scan with its notes as the wear bears them out: a side that was left out as datum for its shape is said to look worn where
    it is worn throughout, and not where no wear stands out on it, nor is it open what thin teeth are where the scan `before` wear tells, or
    where what the loop found leaves none."""
    datum, loop = measured.placed.registration.datum, measured.loop
    both = loop is not None and len(loop.worn_sides) == 2  # `worn_notes` says what that leaves open
    if datum.low and (before or both or (loop is not None and (measured.faces or not _still_low(measured, loop)))):
        return _with_datum(measured, replace(datum, low=0.0))
    side = datum.worn_side
    # The other side is no datum either then: `worn_notes` says so.
    said = measured.faces or both
    if side is None:
        return measured
    told = {region.tooth for region in wear.regions if region.side is side}
    others = len({region.tooth for region in wear.regions if region.side is not side})
    worn, spared = len(told), sum(flank.side is side and flank.says and flank.tooth not in told for flank in wear.flanks)
    if worn and (loop is None or side in loop.worn_sides):
        scanned = "" if wear.flanks_seen(side) == measured.gear.teeth else " that were seen"
        looks = (
            f"wear stands out on {worn} of {worn + spared} {side} flanks and none of them is"
            if spared
            else f"all {side} flanks{scanned} look worn and are not"
        )
        borne_out = f"{looks} used as datum; {taken_for_unworn(side.opposite, others)}"
    else:
        borne_out = bends_otherwise(side, f"wear stands out on {worn} of them" if worn else "no wear stands out on them", others)
    return _with_datum(measured, replace(datum, borne_out="" if said else borne_out))


def contact_note(pair: PairResult | None) -> tuple[str, ...]:
    """What leaves the contact open, a sentence; none where nothing does."""
    if pair is None or pair.limits is None:
        return ()
    return (
        f"backlash, transmission error and contact ratio have limits beyond their ±, by what the scan leaves open: {'; '.join(pair.limits.why)}",
    )


def proud_notes(proud: tuple[float, float], coverage: Mapping[str, float]) -> list[str]:
    """That worn flanks stand by `proud`, left and right, mm, above the design somewhere, and why: a coat shows on what else was seen, if that was."""
    coated = "" if any(coverage.get(name, 0.0) > ELSEWHERE for name in ("tip", "fillet", "root")) else " or wear a coat"
    return [
        f"the worn {side} flanks stand {1e3 * height:.0f} µm proud of the design where they are highest: the teeth were cut thicker than drawn{coated},"
        " and what is lost is counted from there"
        for side, height in zip(Side, proud, strict=True)
        if height > 0.0
    ]


def _worn(wear: Wear, tooth: int) -> bool:
    return any(region.tooth == tooth for region in wear.regions)


def seam_note(seam: DriftSeam) -> str:
    """That a tooth may be told wrong for where the scan began."""
    told, lost = ("thinner", "less") if seam.thicker > 0.0 else ("thicker", "more")
    return (
        f"tooth {seam.tooth + 1} is told {significant(1e3 * abs(seam.thicker), 2)} µm {told} than it is if the pitch errors, which step there, are a drift of"
        f" the scan: its flanks are then from the beginning and the end of the turn, and it has lost {lost}"
    )


def _with_datum(measured: MeasuredGear, datum: Datum) -> MeasuredGear:
    registration = replace(measured.placed.registration, datum=datum)
    return replace(measured, placed=replace(measured.placed, registration=registration))


def _still_low(measured: MeasuredGear, loop: Loop) -> bool:
    """Whether flanks lie low against fillets and tips beside what the loop found, or that says itself that they are thin."""
    surface = measured.first.points.surface
    flank, *others = (loop.residual_after[loop.use & (surface == code)] for code in (FLANK, FILLET, TIP))
    known = [float(np.median(other)) for other in others if len(other)]
    if not known or not len(flank) or loop.thinner_by(measured.first.points.take(loop.use & (surface == FLANK))) > 0.0:
        return True
    return float(np.median(flank)) - min(known) < -LOW


def worn_notes(measured: MeasuredGear, wear: Wear, before: bool = False) -> tuple[str, ...]:
    """What the reader must know where a side is worn throughout, or may be; a scan `before` wear tells what was made so."""
    loop = measured.loop
    if loop is None:
        return ()
    notes = _where_the_mate_ran(measured)
    if len(level_open(measured)) == 2:
        plain = [
            side for side in sorted(loop.worn_sides, reverse=True) if not any(region.side is side for region in wear.regions)
        ]
        seen = f", though no wear stands out on the {' and '.join(map(str, plain))} ones" if plain else ""
        notes.append(
            f"the flanks of both sides look worn{seen}, and are not used as datum: where the teeth stand rests on tips, roots and fillets"
            + ("" if before else ", and an even loss of both sides could as well be thinner teeth")
        )
    notes += or_worn(loop.undecided)
    if loop.no_datum and not before:
        which = " and ".join(str(side) for side in sorted(loop.no_datum, reverse=True))
        notes.append(
            f"without the {which} flanks nothing holds the gear: what all of them have in common, whatever it is named, may be how they were made or what they"
            f" lost; scan {BESIDE} with them"
        )
    notes += [
        f"a burr of {significant(burr.volume, 2)} ± {significant(burr.std, 1)} mm³ stands on the tips of the {burr.side} flanks: it is not taken off what they lost"
        for burr in wear.burrs
    ]
    notes += [
        f"a ridge of {significant(1e3 * ridge.height, 2)} ± {significant(1e3 * ridge.std, 1)} µm stands at the pitch line of the worn {ridge.side} flanks: metal that was moved there by plastic flow; it is not"
        " taken off what they lost"
        for ridge in wear.ridges
    ]
    notes += proud_notes(wear.proud, measured.coverage)
    if wear.unseen > wear.volume_std:
        notes.append(
            "no worn flank was seen whole: what is missing where nothing was seen is not in the volume, and would be up to"
            f" {significant(wear.unseen, 2)} {UNIT[wear.planar]} were it as deep there as anywhere else"
        )
    if wear.hidden_pits > 0.0:
        notes.append(
            f"on other flanks there may be pits or grooves as well, too few there to be told from strays: up to {significant(wear.hidden_pits, 2)} mm³"
        )
    open_ = even_loss(measured, wear)
    if open_ and not before:
        notes.append(
            f"the tolerance of the tooth thickness leaves an even loss of whole flanks open: {significant(open_, 2)} {UNIT[wear.planar]} less or more;"
            " what has the shape of sliding does not hang on it"
        )
    return tuple(notes)


def or_worn(undecided: Sequence[frozenset[Side]]) -> list[str]:
    """What else may be worn throughout than is told, in one sentence, and that what is may have been made so."""
    sides = ["the flanks of both sides" if len(one) == len(Side) else f"the {next(iter(one))} flanks" for one in undecided if one]
    notes = [f"{' or '.join(sides)} may be worn throughout, or all made so: the scan cannot tell"] if sides else []
    return notes + [
        "what the worn flanks have in common may be how they were made: the scan cannot tell" for one in undecided if not one
    ]


def _where_the_mate_ran(measured: MeasuredGear) -> list[str]:
    """What flanks beside where their mate ran tell, a sentence for each stretch."""
    faces, width, notes = measured.faces, measured.gear.face_width, list[str]()
    for low, high in dict.fromkeys((round(face.low, 1), round(face.high, 1)) for face in faces):
        sides = [str(face.side) for face in faces if (round(face.low, 1), round(face.high, 1)) == (low, high)]
        ends = " and ".join(end for end, there in (("below", low > 0.0), ("above", high < round(width, 1))) if there)
        notes.append(
            f"the {' and '.join(sides)} flanks are worn from z = {low:.1f} to {high:.1f} mm, where the mate ran: {ends} they stand as they were made, and tell how"
            " high they were cut"
        )
    return notes


def edge_notes(wear: Wear) -> tuple[str, ...]:
    """What is missing at the ends of flanks alone, and is not counted."""
    if not wear.edges:
        return ()
    return (
        f"{counted(wear.edges, 'flank')} with metal missing at an end of the face alone, {significant(1e3 * wear.edge_depth, 2)} µm at most: rounded or nicked"
        " edges, not counted as wear",
    )


def off_the_drawing(loop: Loop | None) -> tuple[str, ...]:
    """Dimensions that were fitted as they are and lie farther off the drawing than it allows: the design has a wrong number, or the blank had."""
    said = list[str]()
    if loop is None:
        return ()
    for effect in loop.form:
        allowed, (size, *others) = effect.candidate.effect.tolerance(loop.context), effect.parameters.values()
        if allowed is None or others or not isinstance(size.value, float) or not isinstance(size.std, float):
            continue
        if 1e-3 * (abs(size.value) - NORMAL_95 * size.std) > allowed:
            name, way = effect.name.replace("_", " "), "more" if size.value > 0.0 else "less"
            off = number(1e-3 * abs(size.value))
            said.append(
                f"the {name} is {off} mm {way} than the drawing's, whose tolerance is ± {number(allowed)} mm: taken as seen"
            )
    return tuple(said)


def take_each_other_back(loop: Loop | None) -> tuple[str, ...]:
    """Effects that fit together and are no finding, because of each the others take back most."""
    back = [effect.name.replace("_", " ") for effect in loop.form if effect.evidence.taken_back] if loop is not None else []
    if not back:
        return ()
    return (
        f"{listed(sorted(set(back)))} fit best together, but of each the others take back most: no finding, what they leave is a form that flanks have,"
        " or wear that all of them share",
    )


def scanner_notes(stated: ScannerSpec, noise: float) -> tuple[str, ...]:
    """What the reader must know where something was stated of the scanner; `noise` is the scan's own, mm."""
    none = [
        *(() if stated.turntable else ("no table turned the gear",)), *(() if stated.stitched else ("no file was put together from views",)),
    ]  # fmt: skip
    notes = [f"as the design says, {' and '.join(none)}: what these may do wrong was not looked for"] if none else []
    if stated.axis_offset is not None:
        notes.append(
            f"[scanner] axis_offset_mm = {stated.axis_offset:g} is not used: the effects of the table take its axis to be the gear's"
        )
    if stated.noise is not None and not 1.0 / UNLIKE < noise / stated.noise < UNLIKE:
        scatter = f"points scatter by {significant(1e3 * noise, 2)} µm, the scanner by {significant(1e3 * stated.noise, 2)} µm as stated"
        less = "the scan was smoothed or thinned, and neighbouring points share their errors"
        more = "look for glare, focus and strays"
        notes.append(f"{scatter}: {less if noise < stated.noise else more}")
    return tuple(notes)


def scanner_unstated(measured: MeasuredGear) -> tuple[str, ...]:
    """With which line of the design effects would be told from each other that may be the maker's or the scanner's; none where none would."""
    loop, context = measured.loop, measured.context
    if loop is None:
        return ()
    known = named_effects()
    names = {name for effect in loop.either for name in (effect.name, *effect.alternatives)} & known.keys()

    def tells(stated: Context) -> bool:
        return any(known[name].applies(context) and not known[name].applies(stated) for name in names)

    lines = []
    if tells(replace(context, turntable=False)):
        lines.append("turntable = false, where no table turned the gear before a beam")
    if len(measured.scans) == 1 and tells(replace(context, stitched=False)):
        lines.append("stitched = false, where the file was not put together from views")
    if not lines:
        return ()
    return (f"of what maker and scanner may both have done the design can tell: [scanner] {' and '.join(lines)}",)


def like_a_table(loop: Loop | None, stated: ScannerSpec) -> tuple[str, ...]:
    """That pitch errors go round the gear as a table's error does, of which the design says that there was none."""
    if loop is None or stated.turntable:
        return ()
    pitch = [effect.parameters[PITCH.parameters[0].name].value for effect in loop.effects if effect.name == PITCH.name]
    orders = [wave_order(np.asarray(index)) for index in pitch]
    return tuple(
        f"pitch errors are {counted(order, 'wave')} round the gear, as a table leaves, and the design says that none turned it"
        for order in orders
        if order is not None
    )


def wave_order(index: Floats) -> int | None:
    """How many times round the gear the index of teeth (teeth,) waves, if one wave takes more of it than of chance alone any would; None if none does.

    By Fisher's g (1929), the largest share of the periodogram: of m orders it is above g with a chance of at most m (1 − g)^(m − 1). Once round is a gear cut
    off its centre, and not asked. Teeth that are not known are nan.
    """
    known = np.isfinite(index)
    if not known.any():
        return None
    power = np.abs(np.fft.rfft(np.where(known, index - index[known].mean(), 0.0)))[2 : (len(index) + 1) // 2] ** 2
    if not power.any():
        return None
    share = float(power.max() / power.sum())
    return int(power.argmax()) + 2 if len(power) * (1.0 - share) ** (len(power) - 1) < BY_CHANCE else None


def _off_reference(gear: Gear) -> tuple[str, ...]:
    """Where thickness is measured, if not at the reference circle."""
    if gear.thickness_radius == gear.reference_radius:
        return ()
    return (
        f"the reference circle, ⌀ {2.0 * gear.reference_radius:.4g} mm, lies off the involute: tooth thickness is that at ⌀ {2.0 * gear.thickness_radius:.4g} mm",
    )


def _no_forecast(pair: PairResult | None, ahead: Ahead | None) -> tuple[str, ...]:
    """Why there is no forecast, where one was asked for."""
    if ahead is None:
        return ()
    if pair is None or pair.law is None:
        return ("no forecast: the wear law needs a mate, and the design has one gear",)
    return () if pair.law.forecast is not None else (f"no forecast: {pair.law.why_not.removeprefix('no forecast: ')}",)


def _other_way_round(wear: Wear, grown: Wear | None) -> tuple[str, ...]:
    """That the gear has more metal than before its wear, where that is more than it has lost."""
    if grown is None or grown.volume - wear.volume <= GROWN * math.hypot(grown.volume_std, wear.volume_std):
        return ()
    flanks = counted(len(grown.regions), "flank")
    return (
        f"the scan of --before has some {significant(grown.volume, 2)} mm³ less metal than the later one, on {flanks}: are they the wrong way round?",
    )
