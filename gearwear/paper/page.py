"""The rows as a page, and the words round them."""

from __future__ import annotations

import math

from gearwear.meshing.backlash import backlash, normal_backlash, working_pressure_angle
from gearwear.paper.explain import Row
from gearwear.paper.inputs import PAPER, gears
from gearwear.paper.rows import chapters, rows

SOURCE = "Kumar, Jain and Pathak, ICPME'2014, pp. 57-61, doi 10.15242/IAE.IAE1214203"
CHANGES = (0.1, 0.5, 1.0, 2.0, 2.4225, 3.0)
"""Changes of the centre distance in the table of first order against exact, mm."""


def as_markdown() -> str:
    """The page ``docs/paper.md``."""
    lines = [
        "# The paper, number by number",
        "",
        f"{SOURCE}: wear of a 12-tooth pinion (module 6.35, 20°, mate of 24 teeth) from two laser scans.",
        "",
        *_in_short(),
        "",
        "![Points A and B on the tooth in both readings, and the line of action with what the formula counts](pictures/paper.png)",
        "",
        "*Left and middle*: A and B as printed, on the tooth of the pinion. The chord between them runs up the flank as well as across it; the loss is the "
        "turn from the one involute to the other. *Right*: what the formula takes for the path of contact begins beyond the interference point T₁, where the "
        "pinion has no involute, and below the form circle the rack has taken away what there was.",
        "",
        "## All numbers",
        "",
        "*Recomputed* is the paper's own formula with its own inputs at full precision, *residual* is recomputed − printed. Then causes are "
        "put into the calculation one after the other, each with the residual that is left. *Right* is what a physically right "
        "calculation gives; – where that is no single number. This page is written by `python -m gearwear.paper --markdown`; "
        "`--json` gives the same with all digits. Statements marked [not read again] were not read again in their source.",
        "",
        "| number | printed | recomputed | residual | after the last step | right |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for row in rows():
        name = f"{row.item}, {row.unit}" if row.unit else row.item
        values = (
            row.as_printed,
            shown(row, row.recomputed),
            shown_residual(row, row.residual),
            shown_residual(row, row.left),
            right(row),
        )
        lines.append(f"| {name} | {' | '.join(value or '–' for value in values)} |")
    for title, chapter in chapters().items():
        lines += ["", f"## {title}"]
        for row in chapter:
            lines += ["", f"**{row.item[0].upper()}{row.item[1:]}** – printed {row.as_printed}{_unit(row)}. {row.why}", ""]
            lines += _steps(row)
            lines += _cases(row)
        if title == "Backlash and centre distance":
            lines += ["", *_first_order()]
    lines += ["", *_no_numbers()]
    while not lines[-1]:
        lines.pop()
    return "\n".join(lines).replace("\n\n\n", "\n\n") + "\n"


def _in_short() -> list[str]:
    """What the rows come to; every number out of them."""
    by = {row.item: row for row in rows()}
    length, worn = by["contact length as designed l"], by["contact length after wear l′"]
    chord, play = by["thickness loss B′, the chord from A to B"], by["backlash B"]
    apart, close = (
        by[f"centre distance change Δc, {which}"] for which in ("as the play of unworn gears", "if it is to take the wear up")
    )
    at, angle = by["backlash of unworn gears at that c′"], by["pressure angle after wear θ′"]
    low, high = sorted(case.value for case in chord.cases[:2])
    spread = chord.uncertainty
    assert spread is not None and play.right is not None and close.right is not None and at.right is not None
    before, after = (abs(length.residual), abs(worn.residual)), (abs(length.steps[0].residual), abs(worn.steps[1].residual))
    return [
        f"- **The numbers are found again.** All but the pitch radii of A and B and the counts of points, to the last printed digit. The two contact "
        f"lengths were {before[0]:.2f} and {before[1]:.2f} mm off and are {after[0]:.3f} and {after[1]:.3f} mm off with their causes in: both tip radii rounded up "
        "to 0.1 mm, θ′ cut off to 23.04°.",
        f"- **The loss of thickness** is no {chord.as_printed} mm. A and B lie near mid-addendum and at different radii. On the pitch circle it is {low:.2f} or "
        f"{high:.2f} mm, by which flank is worn, and the rounding of the coordinates alone leaves ± {0.5 * (spread.high - spread.low):.2f} mm. Metal can only go: "
        f"it is {low:.2f} mm if A was taken before wear and B after.",
        f"- **The allowance is taken off where it comes on top**: a loss between two scans is wear alone, and the play is {play.right:.2f}, not {play.printed:.2f} mm.",
        f"- **First order is too little**: at the paper's c′ unworn gears have {at.right:.3f} mm of backlash, the formula says {at.printed:.4f}.",
        f"- **The sign.** Δc = {apart.as_printed.replace('-', '−')} mm moves the shafts apart, to where unworn gears would have the play of the worn ones: a way of stating the play. To take it "
        f"up they would have to close by {close.right:.2f} mm, and cannot: tips bottom after {close.cases[2].value:.4f} mm, and teeth less worn jam at once. In a housing "
        f"nothing moves: 114.3 mm, {angle.cases[-1].value:g}°, and the pitch circles stay.",
        f"- **The contact length** counts involute that undercut has taken away: {length.right:.1f} mm, not {length.as_printed}; and the reduction by wear is not "
        f"{by['reduction of the contact length'].as_printed} % but {by['reduction of the contact length'].right:.1f} % at c′, and none in a housing.",
        "- **One worn tooth** cannot show all its loss: its neighbours carry. With measured flanks in contact the play of this pinion ends at 1.33 mm "
        "([meshing](meshing.md)).",
    ]


def _first_order() -> list[str]:
    """The reference's table: first order against exact."""
    pinion, gear = gears()
    C, alpha = PAPER.centre_distance, PAPER.pressure_angle
    lines = [
        "### First order against exact",
        "",
        "The paper's eq. 7 and its fig. 5 take the teeth for racks: B = 2 Δc tan 20°. Exact, with α′ from cos α′ = (r_b1 + r_b2) / c′,",
        "",
        "```",
        "j_wt = c′/c · [p − s1 − s2 + 2 c (inv α′ − inv α)]     on the operating circles",
        "j_bn = j_wt cos α′                                     on the normal",
        "```",
        "",
        "For these gears, without thinning:",
        "",
        "| Δc, mm | α′, ° | j_wt, mm | j_bn, mm | 2 Δc tan 20°, mm | error |",
        "|--:|--:|--:|--:|--:|--:|",
    ]
    for change in CHANGES:
        exact, linear = backlash(pinion, gear, C + change), 2.0 * change * math.tan(alpha)
        angle = math.degrees(working_pressure_angle(pinion, gear, C + change))
        error = 100.0 * (linear / exact.circumferential - 1.0)
        lines.append(
            f"| {change:g} | {angle:.4f} | {exact.circumferential:.6f} | {normal_backlash(pinion, gear, C + change):.6f} | {linear:.6f} | −{-error:.1f} % |"
        )
    lines += [
        "",
        "Say on which circle a backlash is given: at this distance the reference circles have 1.9 % less of it than the operating ones.",
    ]
    return lines


def _no_numbers() -> list[str]:
    """What is to be said of the paper besides its numbers."""
    least_shift = 1.0 - PAPER.teeth[0] * math.sin(PAPER.pressure_angle) ** 2 / 2.0
    return [
        "## What is not a number",
        "",
        "- Both points presume that the two scans lie in the same axes. The paper names three errors of the scanner (voltage, placing of the gear, speed of the table) and "
        "the size of none; the scan was sprayed. What such errors do, and how they are told from wear, is on [the loop](loop.md).",
        "- Only the pinion was scanned, and its mate wears, too, if at half as many cycles per tooth: the play found is a lower bound.",
        "- Wear was read on three teeth at one height. It is a property of each tooth and section, and backlash a function of the position in mesh.",
        "- The pitch circle is no property that wear changes. What is called the new pitch circle is the operating circle at another centre distance.",
        "- The contact length is the path of contact in the transverse plane, not a length along the face.",
        "- A pinion drawn as an involute down to the base circle with a radial root would collide with this gear, by 12 µm; the hobbed one does not. By the "
        f"usual formula, 1 − z sin² α / 2, it would need a profile shift of {least_shift:.4f} modules to be free of undercut.",
        "- A loss of power is claimed and not calculated.",
        "- That the chord is 1.992 mm and the gear's tip overruns the pinion's interference point by 1.984 mm is chance.",
    ]


def _steps(row: Row) -> list[str]:
    if not (row.steps or row.alternatives):
        return []
    lines = ["| effect | residual |", "|---|--:|", f"| the bare formula | {shown_residual(row, row.residual)} |"]
    lines += [f"| + {step.effect} | {shown_residual(row, step.residual)} |" for step in row.steps]
    lines += [f"| *tried alone: {step.effect}* | *{shown_residual(row, step.residual)}* |" for step in row.alternatives]
    return [*lines, ""]


def _cases(row: Row) -> list[str]:
    if not row.cases:
        return []
    first = [] if row.right is None else [f"| as above | {right(row)} |"]
    return [
        f"| right, where | {row.unit} |",
        "|---|--:|",
        *first,
        *(f"| {case.where} | {shown(row, case.value)} |" for case in row.cases),
    ]


def _unit(row: Row) -> str:
    return "" if not row.unit else row.unit if row.unit == "°" else f" {row.unit}"


def _decimals(row: Row) -> int:
    """Four for lengths and angles, two where the paper counts."""
    return 4 if row.unit in ("mm", "°") else 2


def shown(row: Row, value: float) -> str:
    """A number of the row as the table and the page show it."""
    return f"{value:.{_decimals(row)}f}".removesuffix(".00")


def shown_residual(row: Row, value: float) -> str:
    """A residual of the row, with its sign."""
    text = f"{value:+.{_decimals(row)}f}"
    return "0" if float(text) == 0.0 else text.removesuffix(".00")


def right(row: Row) -> str:
    """What is right, or nothing."""
    return "" if row.right is None else shown(row, row.right)
