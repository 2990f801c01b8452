"""How much is lost, in words: the value with its standard deviation, and what else it may be where more than that is open."""

from __future__ import annotations

from gearwear.comparison.open_volume import Open
from gearwear.comparison.results import Results
from gearwear.design.quantity import NORMAL_95, SPACE, significant, with_std
from gearwear.report.words.numbers import which_flanks
from gearwear.wear.regions import UNIT

WIDE = 4.0
"""Times its own 95 % interval from which on the range of a volume is told in the value's place: that would be read as how well it is known."""
MADE_OR_WORN = "whether flanks are worn throughout or were made so"
CUT_OR_WORN = "whether the teeth were cut thinner than drawn or are worn evenly"
MEASURED_OR_WORN = "whether the teeth were cut as thin as they were measured or are worn evenly to that"
QUESTIONS = {
    Open.SIDES: (MADE_OR_WORN, "worn or made so"),
    Open.FORM: (MADE_OR_WORN, "worn or made so"),
    Open.BARE: (MADE_OR_WORN, "worn or made so"),
    Open.THIN: (CUT_OR_WORN, "cut thinner or worn evenly"),
    Open.EVEN: (CUT_OR_WORN, "cut thinner or worn evenly"),
    Open.TOLERANCE: (
        "whether the teeth were cut thinner within their tolerance or are worn evenly",
        "cut thinner within the tolerance or worn evenly",
    ),
    Open.VIEWS: ("how much of that is views that lie apart", "views that lie apart"),
    Open.UNSURE: ("how much the flanks that look worn have lost", "loss of flanks that look worn"),
    Open.RIDGE: ("how high the worn flanks stood as they were made", "cut thicker or a ridge"),
    Open.SEAM: ("whether pitch errors that step in a worn tooth are a drift of the scan", "pitch errors or a drift of the scan"),
    Open.UNSEEN: ("how much is missing where no worn flank was seen", "worn flanks not seen whole"),
    Open.PITS: ("how many pits or grooves other flanks have", "pits on other flanks"),
}
"""What the scan does not decide, and the same beside a number, without a comma, at which a terminal may cut it; of wear too faint to be found more is known."""


def lost_words(results: Results) -> str:
    """How much of what is gone."""
    return f"{size_words(results)} {'of the section' if results.planar else 'of metal'}"


def lost_from(results: Results, which: str) -> str:
    """How much is gone from which flanks; where the rest of it may lie on others, that these are what stands out."""
    if _beyond(results):
        return f"{lost_words(results)} is gone; what stands out {'are' if len(results.wear.regions) > 1 else 'is'} {which}"
    return f"{lost_words(results)} is gone from {which}"


def size_words(results: Results) -> str:
    """The volume with its standard deviation; between what it lies, where that is much more than its own 95 %."""
    return _limits(results) if _wide(results) else _with_own_std(results)


def is_open(results: Results) -> bool:
    """Whether the scan leaves open if what was found, or not found, is wear."""
    return bool(_question(results))


def open_words(results: Results) -> str:
    """What the scan does not decide of the volume, and what it may be as well; where that leads, what it likeliest is. "" where nothing is open."""
    question = _question(results)
    if not question:
        return _too_faint(results)
    told = f"the loss may be {_limits(results)}"
    if results.wear.regions and _wide(results):
        told = f"{_told_as(results)[0]} is {_with_own_std(results)}"
    return f"the scan does not decide {question}: {told}"


def worn_so_thin(results: Results) -> str:
    """What the volume may come to where the teeth are as thin as the design has them from a gear that was measured; "" where a drawing says how thin."""
    up_to = _up_to(results)
    return (
        f"were the teeth not cut as thin as they were measured but worn evenly to that, it would be up to {up_to}"
        if up_to
        else ""
    )


def where_lost(results: Results) -> str:
    """From which flanks, what else the volume may be, and why."""
    open_, regions, widest = is_open(results), results.wear.regions, results.open_volume.widest
    why = f"; {QUESTIONS[widest][1]}" if widest is not None and widest in QUESTIONS else ""
    if not regions:
        beside = f"not excluded{why}" if open_ else ""
        return "; ".join(filter(None, (beside, "no region stands out", _too_faint(results))))
    # Room is short beside a number: the words before that of the only flank would leave none for it.
    only = f"tooth {regions[0].tooth + 1}, {regions[0].side} flank"
    where = only if len(regions) == 1 else f"from {which_flanks(regions, results.wear.found, 'seen')}"
    beside = _too_faint(results)
    if _beyond(results):
        where, beside = f"{_with_own_std(results)} stands out", why.removeprefix("; ")
    elif open_:
        beside = f"{_limits(results)} are not excluded{why}"
        if _wide(results):
            beside = f"{_told_as(results)[1]} {_with_own_std(results)}{why}"
    worn_thin = f"up to {up_to} if worn evenly to the measured thinning" if (up_to := _up_to(results)) else ""
    return "; ".join(filter(None, (where, beside, worn_thin)))


def may_be_none(results: Results) -> bool:
    """Whether nothing at all may be gone where flanks look worn: by the volume's own 95 %, or by its limits where the deepest place's say so too."""
    wear, limits = results.wear, _range(results)
    if wear.volume < NORMAL_95 * wear.volume_std:
        return True
    depth = None if wear.deepest is None else results.open_volume.depth_limits(wear.deepest)
    return is_open(results) and limits is not None and limits[0] <= 0.0 and depth is not None and depth[0] <= 0.0


def solid_words(results: Results) -> list[str]:
    """That the solid holds another volume than is stated: one sentence where that is beyond the stated one's own 95 %, else none."""
    solids, wear = results.wear.solids, results.wear
    if solids is None or not wear.regions or not abs(solids.volume - wear.volume) > NORMAL_95 * wear.volume_std:
        return []
    unit, other = UNIT[results.planar], solids.volume - wear.volume
    return [
        f"the solid, worn_volume.stl, holds {significant(solids.volume, 4)}{SPACE}{unit}, {significant(abs(other), 2)}{SPACE}{unit}"
        f" {'more' if other > 0.0 else 'less'} than the {_with_own_std(results)} of the scan: a smooth surface is drawn through the cells;"
        " quote the latter"
    ]


def _question(results: Results) -> str:
    """What the scan does not decide, where that leaves more open than the volume's own 95 %; "" else."""
    widest = results.open_volume.widest
    if widest is not None and widest in QUESTIONS:
        return QUESTIONS[widest][0]
    return MEASURED_OR_WORN if not results.wear.regions and results.open_volume.measured_thinning > 0.0 else ""


def _told_as(results: Results) -> tuple[str, str]:
    """What the value is, where it is open: of what was seen, or of flanks that stand out by themselves, or the likeliest of all; in a sentence, and beside
    a number."""
    widest = results.open_volume.widest
    if widest is Open.UNSEEN:
        return "where it was seen it", "where seen"
    if widest in (Open.SIDES, Open.FORM, Open.BARE) and not results.measured.worn_sides:
        return "on flanks that stand out it", "on flanks that stand out"
    return "the likeliest", "likeliest"


def _up_to(results: Results) -> str:
    limits = results.volume_range
    return "" if limits is None or results.open_volume.measured_thinning == 0.0 else _volume(limits[1], results)


def _volume(value: float, results: Results) -> str:
    return f"{significant(value, 2)}{SPACE}{UNIT[results.planar]}"


def _too_faint(results: Results) -> str:
    """What the volume may come to with wear that does not stand out; "" where that is within what is known of it."""
    if results.open_volume.widest is not Open.FAINT:
        return ""
    limits = results.open_volume.of_such_teeth
    assert limits is not None
    # Told since it lies beyond the volume's own 95 %: to as many digits as show that.
    own = results.wear.volume + NORMAL_95 * results.wear.volume_std
    digits = next((d for d in (2, 3) if float(f"{limits[1]:.{d}g}") > own), 4)
    return (
        f"with wear too shallow to be found the loss may be up to {significant(limits[1], digits)}{SPACE}{UNIT[results.planar]}"
    )


def _limits(results: Results) -> str:
    """Between what the volume lies where more than its standard deviation leaves it open; its own 95 % is in it at either end. Of flanks that look worn no
    nought is told: their deepest place has limits of its own."""
    limits = _range(results)
    assert limits is not None
    low = "up to" if results.wear.regions and limits[0] <= 0.0 else f"{significant(limits[0], 2)} to"
    return f"{low} {_volume(limits[1], results)}"


def _range(results: Results) -> tuple[float, float, str] | None:
    """The limits of the volume; beside wear that stands out those of teeth as thin as the design has them, which leave it its own place in the words."""
    return results.open_volume.of_such_teeth if results.wear.regions else results.volume_range


def _with_own_std(results: Results) -> str:
    return with_std(results.wear.volume, results.wear.volume_std, UNIT[results.planar])


def _beyond(results: Results) -> bool:
    """Whether the volume's range is told in its place, and what is open of it may lie on other flanks than those that stand out."""
    widest, throughout = results.open_volume.widest, bool(results.measured.worn_sides)
    return _wide(results) and (
        widest in (Open.THIN, Open.UNSURE, Open.PITS) or (widest in (Open.SIDES, Open.FORM, Open.BARE) and not throughout)
    )


def _wide(results: Results) -> bool:
    """Whether what is open of the volume is so much more than its standard deviation that this would be read as how well it is known."""
    limits = _range(results)
    return limits is not None and is_open(results) and limits[1] - limits[0] > 2.0 * WIDE * NORMAL_95 * results.wear.volume_std
