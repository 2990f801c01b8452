"""The wear law and its forecast: for `report.json`, the page and the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gearwear.meshing.wear_forecast import Band
from gearwear.meshing.wear_law import TERMS
from gearwear.report.arrays import Report
from gearwear.report.parts import paragraph, table
from gearwear.report.words import SPACE, ask, listed, number, plural, sentence, significant

if TYPE_CHECKING:  # the words alone need none of the measuring rooms
    from gearwear.report.results import WearStudy

Json = dict[str, Any]

FLANK_NAME = {1: "left", -1: "right"}
TOLD_APART = 4.0
"""Difference of χ² below which load sharing models cannot be told apart."""
HOLDS = "for the same load, speed, lubricant and alignment, and while the contact keeps its shape"
QUANTITIES = {
    "depth": ("greatest depth", "um", 1e3),
    "thickness": ("loss of tooth thickness", "mm", 1.0),
    "backlash": ("growth of normal backlash", "mm", 1.0),
}
"""Quantities that may have a limit: in words, unit of the report, units per mm."""


def wear_law_record(study: WearStudy) -> Json:
    """`meshing` → `wear_law` of the report.

    Parameters
    ----------
    study : WearStudy
        What was fitted.

    Returns
    -------
    dict
        ``fitted``, and either ``why_not`` or the fit; ``forecast`` where one was asked for and possible.
    """
    record: Json = {"fitted": bool(study.fits), "flank": FLANK_NAME[study.side]}
    if study.why_not:
        record["why_not"] = study.why_not
    if not study.fits:
        return record
    best = study.fits[0]
    depth = best.basis.max(axis=0) * best.coefficients
    std = best.basis.max(axis=0) * best.covariance.diagonal() ** 0.5
    record |= {
        "teeth": [tooth + 1 for tooth in study.teeth],
        "left_out": [tooth + 1 for tooth in study.left_out],
        "terms": {
            name: {
                "coefficient_um": _estimate(1e3 * float(best.coefficients[i]), 1e3 * float(best.covariance[i, i]) ** 0.5, "um"),
                "greatest_depth_um": _estimate(1e3 * float(depth[i]), 1e3 * float(std[i]), "um"),
                "share_of_mean_depth": _estimate(*best.parts[name], "1"),
            }
            for i, name in enumerate(TERMS)
        },
        "unexplained_share": _estimate(*best.parts["unexplained"], "1"),
        "explained_variation": best.explained,
        "load_sharing": best.sharing.value,
        "load_sharing_alike": [fit.sharing.value for fit in study.fits[1:] if fit.chi_square - best.chi_square < TOLD_APART],
        "chi_square": best.chi_square,
        "degrees_of_freedom": best.degrees_of_freedom,
        "roll_mm": [float(best.roll[0]), float(best.roll[-1])],
        "words": best.words,
    }
    if study.forecast is not None:
        forecast = study.forecast
        record["forecast"] = {
            "cycles_run": float(forecast.cycles[0]),
            "band": "95 % of the fit's own uncertainty, as if all of it pulled one way",
            "holds": HOLDS,
            "at": [
                {
                    "cycles": float(cycles),
                    "greatest_depth_um": _band(forecast.greatest_depth, i, 1e3),
                    "thickness_loss_mm": _band(forecast.thickness_loss, i),
                    "backlash_increase_mm": _band(forecast.backlash_increase, i),
                }
                for i, cycles in enumerate(forecast.cycles)
            ],
            "cycles_left": [
                {
                    "quantity": one.quantity,
                    f"limit_{QUANTITIES[one.quantity][1]}": QUANTITIES[one.quantity][2] * one.limit,
                    "never": math.isinf(one.left.value),
                    "value": one.left.value,
                    "low": one.left.low,
                    "high": one.left.high,
                }
                for one in study.left
            ],
        }
    return record


def _estimate(value: float, std: float, unit: str) -> Json:
    return {"value": value, "std": std, "unit": unit}


def _band(band: Band, i: int, factor: float = 1.0) -> Json:
    return {name: factor * float(getattr(band, name)[i]) for name in ("value", "low", "high")}


def ageing(report: Report) -> str:
    """The wear law and the forecast on the page; "" without a mate."""
    law = ask(report, "meshing", "wear_law")
    return "" if law is None else "".join([paragraph(law_words(law)), _forecast_table(law), *map(paragraph, left_words(law))])


def law_words(law: Report) -> str:
    """What the mean worn profile is consistent with, or why that cannot be told."""
    if not law.get("fitted"):
        return f"No wear law was fitted: {sentence(str(law.get('why_not')))}"
    teeth, left_out = law["teeth"], law["left_out"]
    text = f"wear law, fitted to the mean of {plural(len(teeth), str(law['flank']) + ' flank')}: {law['words']}"
    if left_out:
        which = listed(map(str, left_out))
        one = len(left_out) == 1
        text += f". {'Tooth' if one else 'Teeth'} {which} lost much more or less than the others and {'is' if one else 'are'} not in it"
    text = sentence(text)
    return f"{text} {sentence(str(law['why_not']))}" if law.get("why_not") else text


def left_words(law: Report) -> list[str]:
    """One sentence per limit: how many cycles are left."""
    said = []
    for one in ask(law, "forecast", "cycles_left") or []:
        name, unit, _ = QUANTITIES[one["quantity"]]
        limit = f"{significant(one[f'limit_{unit}'])}{SPACE}{'µm' if unit == 'um' else unit}"
        if one["never"]:
            text = f"the {name} never reaches its limit of {limit} by this law"
        elif one["value"] == 0.0:
            text = f"the limit of {limit} on the {name} is reached already"
        else:
            late = "no end" if one["high"] is None or math.isinf(one["high"]) else count(one["high"])
            text = f"the {name} reaches its limit of {limit} in {count(one['value'])} more cycles ({count(one['low'])} to {late})"
        said.append(sentence(text))
    return said


def forecast_words(report: Report) -> str:
    """The forecast, short; "" where there is none."""
    law = ask(report, "meshing", "wear_law")
    said = []
    for row in (ask(law, "forecast", "at") or [])[1:]:
        depth = row["greatest_depth_um"]
        band = f"{number(depth['low'], 0)} to {number(depth['high'], 0)}"
        said.append(f"at {count(row['cycles'])} cycles the flanks would be {number(depth['value'], 0)}{SPACE}µm ({band}) deep")
    return " ".join([*map(sentence, said), *(left_words(law) if law else [])])


def _forecast_table(law: Report) -> str:
    rows = ask(law, "forecast", "at")
    if not rows:
        return ""
    head = ("cycles since new", "greatest depth, µm", "loss of thickness, mm", "growth of normal backlash, mm")
    keys = (("greatest_depth_um", 1), ("thickness_loss_mm", 4), ("backlash_increase_mm", 4))

    def span(item: Report, digits: int) -> str:
        return f"{number(item['value'], digits)} ({number(item['low'], digits)} … {number(item['high'], digits)})"

    caption = f"Forecast with its 95{SPACE}% band, {HOLDS}; the first row is now"
    return table(
        head, [(count(row["cycles"]), *(span(row[key], digits) for key, digits in keys)) for row in rows], caption=caption
    )


def count(cycles: float) -> str:
    """A number of cycles, to three digits.

    >>> count(2.0e6), count(125300.0), count(80.0)
    ('2.00 million', '125 thousand', '80')
    """
    for size, name in ((1e9, " billion"), (1e6, " million"), (1e3, " thousand")):
        if cycles >= size:
            return significant(cycles / size) + name
    return f"{cycles:.0f}"
