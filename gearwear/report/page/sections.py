"""The sections of the page. Whatever is missing is said to be missing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearwear.comparison.results import PairResult, Results
from gearwear.design.gear import Gear
from gearwear.design.modification import AMOUNTS
from gearwear.design.pair import Design
from gearwear.design.quantity import MISSING, SPACE, listed, number, sentence, significant, with_std
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.inspection.estimate import COVERAGE_FACTOR
from gearwear.inspection.grading import Finding
from gearwear.inspection.halves import Half
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.radial import STANDARD as RADIAL_STANDARD
from gearwear.inspection.tolerances import FOOTNOTE
from gearwear.loaded.study import LoadedStudy
from gearwear.meshing.shafts import take_up_words
from gearwear.report.charts.sheet import plain
from gearwear.report.figures.arrays import ReportArrays
from gearwear.report.figures.colours import ColourScale
from gearwear.report.page import pictures
from gearwear.report.page.blocks import Block, Columns, Facts, Heading, Items, Paragraph, Section, Table, blocks
from gearwear.report.records.comparison import made_by
from gearwear.report.words.consequences import HEAD, TEXT, change_rows, said_changes
from gearwear.report.words.contact import contact_rows
from gearwear.report.words.effects import fitted_words, found_words
from gearwear.report.words.loaded import HEAD as HEAD_LOADED
from gearwear.report.words.loaded import TEXT as TEXT_LOADED
from gearwear.report.words.loaded import load_words, loaded_notes, loaded_rows
from gearwear.report.words.lost import lost_from, open_words
from gearwear.report.words.numbers import effect_title, row, thickness_place, which_flanks
from gearwear.report.words.running import CAPTION as CAPTION_RUNNING
from gearwear.report.words.running import HEAD as HEAD_RUNNING
from gearwear.report.words.running import running_rows, running_words, why_not_words
from gearwear.report.words.verdict import depth_words, doubts, known, loop_words, noise
from gearwear.report.words.wear_law import FORECAST_HEAD, far_words, forecast_caption, forecast_rows, law_words, left_words
from gearwear.scan.types import Scan
from gearwear.wear.regions import UNIT, WearRegion
from gearwear.wear_law.study import WearStudy

SURFACES = {
    "flank": "flanks", "flank_left": "left flanks", "flank_right": "right flanks", "fillet": "fillets", "tip": "tips", "root": "roots",
    "end_low": "lower end, z = 0", "end_high": "upper end",
}  # fmt: skip
"""Surfaces as the page calls them."""
KINDS = {"cloud": "point cloud", "triangles": "triangles", "section": "planar section"}


def wear(results: Results, arrays: ReportArrays, scale: ColourScale) -> Section:
    """Wear by tooth and flank: the map, the regions, the laws, sections of the worst teeth."""
    laws = [
        (fitted_words(law), f"{law.side}", significant(1e3 * law.rms_before), significant(1e3 * law.rms_after))
        for law in results.wear.laws
    ]
    head = ("law of wear", "flanks", "RMS on worn regions before, µm", "after, µm")
    return Section("wear", "Wear", "Wear by tooth and flank", blocks(
        Paragraph(_wear_words(results)),
        pictures.wear_map(arrays),
        pictures.deviation_map(arrays, scale),
        _regions(results.wear.regions, results.planar),
        Table(head, laws, words=2) if laws else None,
        pictures.worst_sections(results.wear.regions, arrays),
    ))  # fmt: skip


def _wear_words(results: Results) -> str:
    worn, before, boolean = results.wear.found, results.wear.before_loop, results.wear.boolean
    unit = UNIT[results.planar]
    text = ["no region of wear stands out of the scatter of this scan"]
    if worn.regions:
        which = which_flanks(worn.regions, worn)
        text = [f"in all {lost_from(results, which)}", *filter(None, [open_words(results)])]
        if results.effects:
            without = with_std(before.volume, before.volume_std, unit)
            text.append(f"without taking the effects of scan and manufacture out first it would have been {without}")
    if worn.limit > 0.0 and len(results.measured.worn_sides) < len(Side):  # where all flanks are worn, none shows what scatter is
        alone = f"a patch of wear on one flank is seen from a mean depth of about {significant(1e3 * worn.limit, 2)}{SPACE}µm on"
        text.append(f"{alone}, what all flanks of a side have lost from less" if results.measured.worn_sides else alone)
    against = "the unworn gear's scan" if results.before_files else "design and manufacture effects"
    text.append(f"it is measured against {against}")
    if boolean is not None:
        text.append(
            f"the plain boolean with the scan's own triangles takes {number(boolean.removed)}{SPACE}mm³ off in {boolean.pieces} pieces, one-sided"
            f" and with the scan's noise; the difference of the two volumes, free of that bias, is {number(boolean.signed)}{SPACE}mm³"
        )
    if results.planar:
        text.append("a planar section gives areas; volumes would need a scan of the whole face width")
    return " ".join(map(sentence, text))


def _regions(regions: Sequence[WearRegion], planar: bool) -> Table | None:
    if not regions:
        return None
    head = ["tooth", "flank", "area, mm²" if planar else "volume, mm³", "deepest 0.5 × 0.5 mm, µm", "mean depth, µm"]
    head += ([] if planar else ["worn area, mm²"]) + ["centroid x, y, z, mm", "pieces"]
    rows = [
        (
            str(region.tooth + 1), str(region.side), with_std(region.volume, region.volume_std), depth_words(region, ""),
            number(1e3 * region.mean_depth, 0), *([] if planar else [number(region.area, 1)]), row(region.centroid.tolist(), 1), str(region.patches),
        )
        for region in regions
    ]  # fmt: skip
    return Table(head, rows, words=2)


def loop(results: Results, arrays: ReportArrays) -> Section:
    """The closed loop: what was found besides wear, and that the error really fell."""
    lead, closed, effects = Paragraph(loop_words(results), lead=True), results.loop, results.effects
    before = results.plain_rms if closed is None else closed.rms_before
    known = Paragraph(sentence(
        f"the RMS of the residual outside wear is {significant(1e3 * before)}{SPACE}µm and the scan's own noise is"
        f" {significant(1e3 * noise(results))}{SPACE}µm"
    ))  # fmt: skip
    body: list[Block] = [lead, known]
    if closed is not None:
        changes = said_changes(results)
        body = blocks(
            lead,
            [pictures.waterfall(closed, effects), *_effects(results, closed)] if effects else known,
            _patterns(closed),
            [Heading("What leaving them in would have cost"), Paragraph(TEXT), Table(HEAD, change_rows(changes), words=2)]
            if changes else None,
            pictures.residual_maps(arrays),
        )  # fmt: skip
    return Section("loop", "Closed loop", "Closed loop: what else is in the scan", body)


def _effects(results: Results, closed: Loop) -> list[Block]:
    effects = results.effects

    def span(first: float, last: float) -> str:
        return f"{significant(1e3 * first)} → {significant(1e3 * last)}" if math.isfinite(last) else MISSING

    rows = []
    for effect in effects:
        p = effect.evidence.p_value
        evidence = f"F = {significant(effect.evidence.statistic)}, n_eff = {number(effect.evidence.effective_number, 0)}"
        rows.append((
            sentence(found_words(effect, results.open_sizes(effect))).rstrip("."), effect.kind.value, listed(map(effect_title, effect.alternatives), "or") or MISSING,
            f"{evidence}, {'p < 1e−300' if p == 0.0 else f'p = {significant(p, 2)}'}",
            span(effect.rms_before, effect.rms_after), span(effect.held_out_before, effect.held_out_after),
        ))  # fmt: skip
    telling = [
        f"{effect_title(effect.name)}: {effect.candidate.effect.tells_apart}"
        for effect in effects
        if effect.alternatives and effect.candidate.effect.tells_apart
    ]
    together = [
        (*(f"{effect_title(name)}, {_parameter(key)}" for name, key in zip(effect.effects, effect.parameters, strict=True)), number(effect.value, 2))
        for effect in closed.correlations
    ]  # fmt: skip
    caption = "Correlations of their sizes: near ±1, what one is said to be too large the other makes up for"
    return blocks(
        Table(("effect", "kind", "cannot be told from", "evidence", "RMS, µm", "held out, µm"), rows, words=4),
        Paragraph("What would tell what the data cannot:") if telling else None,
        Items(list(map(sentence, telling))) if telling else None,
        Table(("effect", "and", "correlation"), together, words=2, caption=caption) if together else None,
    )


def _parameter(key: str) -> str:
    return key.rpartition("_")[0].replace("_", " ")


def _patterns(closed: Loop) -> list[Block]:
    if not closed.patterns:
        return []
    rows = [
        (
            "in space" if pattern.order is None else str(pattern.order), pattern.sides, significant(pattern.waves_z), significant(pattern.waves_profile), significant(1e3 * pattern.rms),
            significant(1e3 * pattern.peak), significant(pattern.p_value, 2),
        )
        for pattern in closed.patterns
    ]  # fmt: skip
    head = ("order round the gear", "flanks", "waves across the face", "waves along the profile", "RMS, µm", "peak, µm", "p")
    treated = "They are taken out as an empirical pattern, without a name, before wear is measured."
    return [Table(head, rows, words=2, caption="Unexplained patterns"), Paragraph(treated)]


def thickness(results: Results) -> Section:
    """Tooth thickness left."""
    title, link, measured = "Tooth thickness", "Thickness", results.wear.thickness
    teeth, worn = measured.teeth(), bool(results.wear.regions)
    tooth = results.wear.lost_most
    if tooth is None:
        none = "No tooth thickness could be measured: no tooth was seen on both flanks."
        return Section("thickness", link, title, [Paragraph(none)])
    which, least = f"Tooth {tooth.tooth + 1}", known(tooth.least, tooth.least_std, 3)
    lost = (
        f"{which} lost most, {known(tooth.greatest_loss, tooth.loss_std, 3)} mm"
        if worn
        else f"{which} is the furthest below the gear as made"
    )
    place = thickness_place(results.gear)
    text = (
        f"{lost}; taken by itself it is {least} mm thick where it is thinnest, designed is {number(tooth.nominal, 3)} mm. The thinnest tooth at the top"
        " of the page may differ a little: of many noisy values the least is too small by chance, and that is allowed for there. Thickness is the arc"
        f" {place}, without what the scanner added; a loss is against the gear as made."
    )
    head = ("tooth", "design, mm", "mean, mm", "least, mm", "greatest loss, mm", "± of one section, mm", "least at z, mm")
    rows = [
        (
            str(t.tooth + 1), number(t.nominal, 3), number(t.mean, 3), known(t.least, t.least_std, 3),
            known(t.greatest_loss, t.loss_std, 3), number(t.std, 3), number(t.at_z, 1),
        )
        for t in teeth
    ]  # fmt: skip
    return Section("thickness", link, title, [Paragraph(text), pictures.thickness(measured, place), Table(head, rows)])


def meshing(results: Results, arrays: ReportArrays) -> Section:
    """Meshing, design against worn."""
    link, title, pair = "Meshing", "Meshing: design against worn", results.pair
    if pair is None:
        alone = "The design names one gear and no mate: backlash, transmission error and contact need a pair."
        return Section("meshing", link, title, [Paragraph(alone)])
    housing = "The housing holds the shafts at the design's centre distance. Ranges run over one revolution; ± and the change are those of the greatest."
    return Section("meshing", link, title, blocks(
        Paragraph(housing),
        Table(("", "design", "worn", "change"), contact_rows(pair)),
        None if pair.limits is None else Paragraph(f"In brackets: within what a number (of backlash the greatest) lies by what the scan leaves open: {'; '.join(pair.limits.why)}."),
        None if pair.shafts is None else Paragraph(take_up_words(pair.shafts)),
        None if pair.loaded is None else _loaded(pair.loaded),
        None if pair.law is None else _wear_law(pair.law, results.wear.regions),
        _running(pair),
        Paragraph("No curves over the revolution were computed for this scan.") if arrays.meshing is None
        else pictures.meshing_curves(arrays.meshing),
        None if arrays.contact_share is None or arrays.planar else pictures.contact_pattern(arrays.contact_share),
    ))  # fmt: skip


def _loaded(study: LoadedStudy) -> list[Block]:
    return blocks(
        Paragraph(f"Under load: {load_words(study)}. {TEXT_LOADED} {loaded_notes(study)}"),
        Table(HEAD_LOADED, loaded_rows(study)),
        *pictures.loaded_pair(study),
    )


def _wear_law(law: WearStudy, regions: Sequence[WearRegion]) -> list[Block]:
    rows = forecast_rows(law)
    return blocks(
        Paragraph(law_words(law)),
        None if law.best is None else pictures.wear_law(law),
        None if law.across is None or not law.across.uneven else pictures.across_face(law.across),
        Table(FORECAST_HEAD, rows, caption=forecast_caption(law)) if rows else None,
        map(Paragraph, left_words(law, regions)),
        Paragraph(far_words(law)),
    )


def _running(pair: PairResult) -> list[Block]:
    running = pair.second_loop
    if running is None:
        return blocks(Paragraph(why_not_words(pair)))
    return blocks(
        Paragraph(running_words(running)),
        Table(HEAD_RUNNING, running_rows(running), caption=CAPTION_RUNNING),
        pictures.how_it_ran(running),
    )


def paper(results: Results) -> Section | None:
    """The published calculation, from this scan's greatest thickness loss."""
    published = None if results.pair is None else results.pair.published
    if published is None:
        return None
    text = (
        "After Kumar, Jain and Pathak (ICPME 2014), for comparison with the paper alone: the loss of thickness is turned into a centre distance"
        " at which unworn gears would have the same play. None of it is measured and none is the result of this scan, whose backlash and path of"
        f" contact are those under Meshing: in a housing the shafts do not move. The loss counts from this baseline: {effect_title(published.baseline.value)}."
    )
    rows = (
        ("B′, loss of thickness, mm", published.thickness_loss),
        ("B, backlash put into the formula, mm", published.backlash),
        ("Δc = c − c′, as printed, mm", published.centre_distance_change),
        ("c′, centre distance, mm", published.centre_distance),
        ("θ′, pressure angle, °", math.degrees(published.pressure_angle)),
        ("r₁′, pitch radius of the pinion, mm", published.pitch_radius_pinion),
        ("r₂′, pitch radius of the gear, mm", published.pitch_radius_gear),
        ("l, length of contact by the paper's formula, design, mm", published.contact_length_design),
        ("l′, the same at c′, mm", published.contact_length_worn),
    )
    table = Table(("by the paper's formulas", "value"), [(label, number(value, 4)) for label, value in rows])
    return Section("paper", "Published calculation", "The published calculation, not measured", [Paragraph(text), table])


def inspection(arrays: ReportArrays) -> Section | None:
    """The worst of every deviation with its class, and the charts."""
    if arrays.inspection is not None:
        return inspected(arrays.inspection)
    if arrays.halves:
        parts = (
            [Heading(f"The {half} half"), *_inspected(inspected_half, half)]
            for half, inspected_half in zip(Half, arrays.halves, strict=True)
        )
        return Section("inspection", "Inspection charts", "Inspection charts", blocks(*parts))
    charts = [] if arrays.planar else [pictures.gear_charts(arrays, "deviation", arrays.deviation_um)]
    return Section("inspection", "Inspection charts", "Inspection charts", charts) if charts else None


def inspected(result: Inspection) -> Section:
    """The same of an inspection alone."""
    return Section("inspection", "Inspection charts", "Inspection charts", _inspected(result))


def _inspected(result: Inspection, half: str = "") -> list[Block]:
    graded = f", class {result.iso_class} in all" if result.iso_class is not None else ""
    graded += f"; U is the expanded uncertainty, k = {significant(COVERAGE_FACTOR, 1)}"
    text = f"{result.settings.edition}{graded}; the tolerance is {_whose(result)}"
    notes = " ".join(map(sentence, [*(note for note in result.notes if note != FOOTNOTE), FOOTNOTE]))
    return blocks(
        Paragraph(sentence(text)),
        _findings(result.findings),
        *_rolled(result),
        pictures.inspection_charts(result, half),
        Paragraph(notes),
    )


def _whose(result: Inspection) -> str:
    """Of which class the tolerances in the table are."""
    if result.settings.required_class is not None:
        return f"that of class {result.settings.required_class}, which is required"
    return "that of the class by value, of the coarsest where there is none"


def _rolled(result: Inspection) -> list[Block]:
    """F_i″ and f_i″, which have a standard and classes of their own."""
    if not result.radial or result.laboratory is None or result.laboratory.composite is None:
        return []
    master = f"{RADIAL_STANDARD}: both flanks in contact with a perfect master gear of {result.laboratory.composite.master_teeth} teeth"
    return blocks(
        Paragraph(sentence(f"{master}; classes of a system of their own, which say nothing of those above")),
        _findings(result.radial),
    )


def _findings(findings: Sequence[Finding]) -> Table | None:
    rows = [
        (
            plain(finding.symbol), effect_title(finding.quantity), str(finding.side or ""), "" if finding.tooth is None else str(finding.tooth + 1),
            finding.statement or str(finding.grade.verdict), *(number(1e3 * v, 1) for v in (finding.value, finding.expanded, finding.grade.tolerance)),
            MISSING if finding.grade.iso_class is None else str(finding.grade.iso_class),
        )
        for finding in findings
    ]  # fmt: skip
    head = ("", "deviation", "flank", "tooth", "judgement", "µm", "U, µm", "tolerance, µm", "class by value")
    return Table(head, rows, words=5) if rows else None


def registration(results: Results) -> Section:
    """How the scan was laid on the design, and what is assumed."""
    placed, pose = results.measured.placed, results.measured.pose
    fit, side = placed.registration, placed.registration.datum.worn_side
    std = np.where(fit.observed, np.sqrt(np.diag(fit.covariance)), np.nan)
    pairs = [
        ("settled", _yes(fit.converged)),
        ("rests on (datum)", listed(fit.datum.surfaces)),
        ("not used as datum", "" if side is None else f"{side} flanks"),
        ("assumed", " ".join(map(sentence, fit.notes))),
        ("offset of all surfaces", with_std(1e3 * fit.offset, None, "µm") if fit.offset else ""),
        ("translation x, y, z, mm", row(pose.translation.tolist(), 5)),
        ("± standard deviation, µm", row((1e3 * std[:3]).tolist(), 2)),
        ("rotation, row by row", "; ".join(row(line, 8) for line in pose.rotation.tolist())),
        ("± about x, y, z, °", row(np.degrees(std[3:]).tolist(), 6)),
        ("± about z, at the base circle", with_std(1e3 * float(std[5]) * results.gear.base_radius, None, "µm")),
    ]
    views = [
        (
            str(i + 1), _yes(view.registration.converged), number(view.points, 0), number(view.kept, 0), significant(1e3 * view.offset, 2),
            significant(1e3 * view.mismatch, 2), significant(1e3 * view.accord.place, 2),
            with_std(1e3 * view.accord.offset, 1e3 * view.accord.offset_std or None, "µm"),
            with_std(1e6 * view.accord.scale, 1e6 * view.accord.scale_std or None, "ppm"), significant(1e3 * view.accord.residual, 2),
            significant(1e3 * view.left, 2) if view.taken.any else "", row(view.registration.pose.translation.tolist(), 4),
        )
        for i, view in enumerate(placed.views)
    ]  # fmt: skip
    head = (
        "view",
        "settled",
        "points",
        "kept",
        "offset, µm",
        "mismatch with its neighbours, µm",
        "of that: place, µm",
        "level",
        "scale",
        "rest, µm",
        "left once it was taken out, µm",
        "translation, mm",
    )
    return Section("registration", "Registration", "Registration: how the scan was laid on the design", blocks(
        Paragraph("design = rotation · scan + translation, found without a starting guess."),
        Facts(pairs),
        Table(head, views, words=2) if len(views) > 1 else None,
    ))  # fmt: skip


def _yes(value: bool) -> str:
    return "yes" if value else "no"


def scan(results: Results, command: str = "") -> Section:
    """The scan and the design it was held against."""
    measured, gear, spec = results.measured, results.gear, results.gear.spec
    facts = [
        ("files", ", ".join(file for part in measured.scans for file in part.files)),
        ("before wear", ", ".join(results.before_files)),
        ("its teeth", "" if results.same_teeth is None else results.same_teeth.sentence("the gear there")),
        ("kind", KINDS[measured.scans[0].kind]),
        ("points", number(measured.points, 0)),
        ("used", number(measured.used, 0)),
        (
            "rejected",
            ", ".join(f"{effect_title(reason)} {number(count, 0)}" for reason, count in measured.rejected.items()) or "none",
        ),
        ("other, left out", number(measured.other, 0)),
    ]
    seen = [(SURFACES.get(name, effect_title(name)), number(100.0 * share, 1)) for name, share in measured.coverage.items()]
    drawn = [
        ("teeth", number(gear.teeth, 0)),
        ("module, mm", number(spec.normal_module, 4)),
        ("pressure angle, °", number(math.degrees(spec.normal_pressure_angle), 3)),
        *_helix(gear),
        ("profile shift, modules", number(spec.profile_shift, 4)),
        ("face width, mm", number(gear.face_width, 3)),
        ("reference radius, mm", number(gear.reference_radius, 4)),
        ("base radius, mm", number(gear.base_radius, 4)),
        ("tip radius, mm", number(gear.tip_radius, 4)),
        ("root radius, mm", number(gear.root_radius, 4)),
        ("form radius, mm", number(gear.form_radius, 4)),
        (f"{'tooth' if gear.twist == 0.0 else 'transverse tooth'} thickness, mm of arc", number(gear.tooth_thickness, 4)),
        ("undercut", _yes(gear.undercut)),
        *_modified(gear),
    ]
    columns = (
        (Heading("Scan"), Facts(facts)), (Heading("Seen of each surface"), Table(("surface", "seen, %"), seen)), (Heading("Design"), Facts(drawn)),
    )  # fmt: skip
    return Section(
        "scan",
        "Scan and design",
        "Scan and design",
        blocks(
            Columns(columns),
            made_of(results.design, measured.scans, [*zip(results.before_files, results.before_sha256, strict=False)], command),
        ),
    )


def made_of(design: Design, scans: Sequence[Scan], before: Sequence[tuple[str, str]], command: str) -> list[Block]:
    """Of which files, by which program and command: enough to make it again."""
    files = [pair for part in scans for pair in zip(part.files, part.sha256, strict=False)]
    pairs = [(f"SHA-256 of {name}", digest) for name, digest in [(design.source, design.sha256), *files, *before]]
    return [Heading("Made from"), Facts([*pairs, ("program", made_by()), ("command", command)])]


def _modified(gear: Gear) -> list[tuple[str, str]]:
    """What the drawing modifies, in µm along the transverse base tangent; a row a side, one where both are alike."""
    if not gear.modified:
        return []

    def words(side: Side) -> str:
        stated = gear.drawn(side).modification.stated
        amounts = [
            f"{effect_title(key)} {number(1e3 * value, 1)}"
            for key, value in stated.items()
            if key in AMOUNTS and not isinstance(value, str)
        ]
        return ", ".join(amounts) or "none"

    left, right = words(Side.LEFT), words(Side.RIGHT)
    if gear.spec.left == gear.spec.right:
        return [("modified as drawn, µm", left)]
    return [("left flanks modified as drawn, µm", left), ("right flanks, µm", right)]


def _helix(gear: Gear) -> list[tuple[str, str]]:
    """What a helical gear's drawing says beside a spur gear's; module and pressure angle above are the normal ones."""
    if gear.twist == 0.0:
        return []
    return [
        ("helix angle, °", f"{number(abs(math.degrees(gear.helix_angle)), 3)} {gear.spec.hand} hand"),
        ("transverse module, mm", number(gear.transverse_module, 4)),
        ("transverse pressure angle, °", number(math.degrees(gear.transverse_pressure_angle), 3)),
        ("normal tooth thickness, mm of arc", number(gear.normal_tooth_thickness, 4)),
    ]


def closing(results: Results) -> Section:
    """Doubts and notes."""
    said = list(dict.fromkeys([*doubts(results), *map(sentence, results.design.warnings)]))
    title = "Warnings and doubts"
    return Section("doubts", title, title, [Items(said) if said else Paragraph("None.")])


def written(files: Sequence[str]) -> Section:
    """The files beside the page."""
    return Section("files", "Files", "Files written", [Items(files) if files else Paragraph("None.")])
