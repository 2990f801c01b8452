"""The wear law and its forecast: for `report.json`, the page and the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwear.design.quantity import SPACE, listed, number, plural, sentence, significant
from gearwear.report.figures.arrays import Report
from gearwear.report.page.parts import paragraph, table
from gearwear.report.words.numbers import ask
from gearwear.wear_law.archard import TERMS
from gearwear.wear_law.forecast import FAR, Band

if TYPE_CHECKING:  # the words alone need none of the measuring rooms
    from gearwear.meshing.path import PathOfContact
    from gearwear.wear_law.fit import WearFit
    from gearwear.wear_law.study import WearStudy

Json = dict[str, Any]

HOLDS = "for the same load, speed, lubricant and alignment, and while the contact keeps its shape"
BAND = "95 % of the fit's own uncertainty, as if all of it pulled one way, over all load sharing models that fit alike"
PLACES = 121
"""Places at which the law is given from end to end of the path of contact."""
QUANTITIES = {
    "depth": ("greatest depth of the mean flank", "um", 1e3),
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
    record: Json = {"fitted": bool(study.fits), "flank": str(study.side)}
    if study.why_not:
        record["why_not"] = study.why_not
    if not study.fits:
        return record
    from gearwear.meshing.path import path_of_contact
    from gearwear.wear_law.fit import alike_fits

    best = study.fits[0]
    share, std = best.explained
    path = path_of_contact(best.gear, best.mate, best.centre_distance)
    record |= {
        "teeth": [tooth + 1 for tooth in study.teeth],
        "left_out": [tooth + 1 for tooth in study.left_out],
        "share_of_volume": study.volume_share,
        "terms": _terms(best),
        "explained_share": _estimate(share, std, "1"),
        "unexplained_share": _estimate(1.0 - share, std, "1"),
        "unexplained_rms_um": 1e3 * best.unexplained_depth,
        "explained_variation": best.explained_variation[0],
        "load_sharing": best.sharing.value,
        "load_sharing_alike": [fit.sharing.value for fit in alike_fits(study.fits)[1:]],
        "chi_square": best.chi_square,
        "degrees_of_freedom": best.degrees_of_freedom,
        "roll_mm": [float(best.roll[0]), float(best.roll[-1])],
        "single_contact_mm": list(path.single_contact_pinion),
        "profile": {
            "roll_mm": best.roll.tolist(),
            "depth_um": (1e3 * best.depth).tolist(),
            "std_um": (1e3 * best.std).tolist(),
            "law_um": (1e3 * best.fitted).tolist(),
        },
        "law_over_path": _over_path(best, path),
        "words": best.words,
    }
    if study.forecast is not None:
        record["forecast"] = _forecast_record(study, best)
    return record


def _terms(fit: WearFit) -> Json:
    std, limits, most = fit.covariance.diagonal() ** 0.5, fit.interval(), fit.basis.max(axis=0)
    return {
        name: {
            "coefficient_um": _estimate(1e3 * float(fit.coefficients[i]), 1e3 * float(std[i]), "um"),
            "interval_um": [1e3 * float(limit) for limit in limits[i]],
            "greatest_depth_um": _estimate(1e3 * float(most[i] * fit.coefficients[i]), 1e3 * float(most[i] * std[i]), "um"),
            "share_of_mean_depth": _estimate(*fit.parts[name], "1"),
        }
        for i, name in enumerate(TERMS)
    }


def _over_path(fit: WearFit, path: PathOfContact) -> Json:
    """The law from end to end of the path of contact, beyond the points it was fitted to."""
    from gearwear.wear_law.archard import law_terms

    edge = 1e-9 * path.length
    borders = [x + side * edge for x in path.single_contact_pinion for side in (-1.0, 1.0)]
    roll = np.unique([*np.linspace(path.start_pinion, path.end_pinion, PLACES), *borders, path.pitch_pinion])
    depth = law_terms(fit.gear, fit.mate, fit.centre_distance, roll, fit.sharing) @ fit.coefficients
    return {"roll_mm": roll.tolist(), "depth_um": (1e3 * depth).tolist()}


def _forecast_record(study: WearStudy, fit: WearFit) -> Json:
    forecast = study.forecast
    assert forecast is not None
    run = float(forecast.cycles[0])
    return {
        "cycles_run": run,
        "rate_mm_per_cycle": dict(zip(("value", "std"), fit.wear_coefficient(run, 1.0), strict=True)),
        "band": BAND,
        "holds": HOLDS,
        "at": [
            {
                "cycles": float(cycles),
                "far": bool(forecast.far[i]),
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
                "far": run + one.left.value > FAR * run,
                "value": one.left.value,
                "low": one.left.low,
                "high": one.left.high,
            }
            for one in study.left
        ],
    }


def _estimate(value: float, std: float, unit: str) -> Json:
    return {"value": value, "std": std, "unit": unit}


def _band(band: Band, i: int, factor: float = 1.0) -> Json:
    return {name: factor * float(getattr(band, name)[i]) for name in ("value", "low", "high")}


def ageing(report: Report) -> str:
    """The wear law and the forecast on the page; "" without a mate."""
    law = ask(report, "meshing", "wear_law")
    if law is None:
        return ""
    parts = [
        paragraph(law_words(law)),
        _picture(law),
        _forecast_table(law),
        *map(paragraph, left_words(law, ask(report, "wear", "regions") or ())),
    ]
    return "".join([*parts, *([paragraph(_far_words(law))] if _far_words(law) else [])])


def _picture(law: Report) -> str:
    if not law.get("profile"):
        return ""
    from matplotlib.figure import Figure

    from gearwear.report.figures.wear_law import greatest_depth, worn_profile
    from gearwear.report.page.parts import FULL, picture

    ahead = bool(law.get("forecast"))
    figure = Figure(figsize=(FULL if ahead else 0.62 * FULL, 2.7))
    left, *right = figure.subplots(1, 1 + ahead, squeeze=False)[0]
    figure.subplots_adjust(left=0.07, right=0.99, wspace=0.24)
    worn_profile(left, law)
    caption = "Left: " if ahead else ""
    caption += (
        "mean depth of the worn flanks along the profile, root to tip, with 95 % of its uncertainty, and the law fitted to it; below the"
        " first point, where contact starts, the depth is the law's. Sliding takes nothing at the pitch point and most at the root; between the"
        " dotted lines one pair carries alone."
    )
    if right:
        greatest_depth(right[0], law["forecast"])
        caption += " Right: the greatest depth of that mean flank against cycles, with the band of the forecast."
    return picture(figure, "wear-law", "Wear law" + (" and forecast" if ahead else ""), sentence(caption))


def law_words(law: Report) -> str:
    """What the mean worn profile is consistent with, or why that cannot be told."""
    if not law.get("fitted"):
        return f"No wear law was fitted: {sentence(str(law.get('why_not')))}"
    teeth, left_out = law["teeth"], law["left_out"]
    said = [f"wear law, fitted to the mean of {plural(len(teeth), str(law['flank']) + ' flank')}: {law['words']}"]
    if left_out:
        which = listed(map(str, left_out))
        one = len(left_out) == 1
        said.append(
            f"{'Tooth' if one else 'Teeth'} {which} lost much more or less than the others and {'is' if one else 'are'} not in it"
        )
    share = law.get("share_of_volume")
    if isinstance(share, float) and share < 0.995:
        said.append(
            f"The flanks in it lost {number(100 * share, 0)}{SPACE}% of the worn volume; of the rest the law says nothing"
        )
    if law.get("load_sharing_alike"):
        said.append(f"With load sharing {listed(map(str, law['load_sharing_alike']), 'or')} it fits as well")
    if law.get("why_not"):
        said.append(str(law["why_not"]))
    return " ".join(map(sentence, said))


def left_words(law: Report, regions: Sequence[Report] = ()) -> list[str]:
    """One sentence per limit: how many cycles are left, and which of the worn regions are past it."""
    said = []
    run = ask(law, "forecast", "cycles_run")
    for one in ask(law, "forecast", "cycles_left") or []:
        name, limit, soon = QUANTITIES[one["quantity"]][0], _limit(one), one["low"]
        if one["never"]:
            text = f"the {name} never reaches its limit of {limit} by this law"
            if soon is not None and math.isfinite(soon):
                text += f"; at the upper side of its band it does in {count(soon)} more cycles"
        elif one["value"] == 0.0:
            text = f"the limit of {limit} on the {name} is reached already"
        else:
            text = f"the {name} reaches its limit of {limit} in {count(one['value'])} more cycles ({_span(one)})"
            if one.get("far"):
                text += f", at {significant(1.0 + one['value'] / run, 2)} times the cycles run"
        past = _past(one, law, regions)
        if past:
            text += f"; {past} by itself"
        said.append(sentence(text))
    return said


def forecast_words(report: Report) -> str:
    """The forecast, short, for the terminal; "" where there is none."""
    law = ask(report, "meshing", "wear_law")
    depths, left = [], []
    for row in (ask(law, "forecast", "at") or [])[1:]:
        depth = row["greatest_depth_um"]
        band = f"{number(depth['low'], 0)} to {number(depth['high'], 0)}"
        depths.append(f"{number(depth['value'], 0)}{SPACE}µm ({band}) at {count(row['cycles'])} cycles")
    for one in ask(law, "forecast", "cycles_left") or []:
        limit = f"{one['quantity']} {_limit(one)}"
        if one["never"]:
            left.append(f"no end to {limit}")
        elif one["value"] == 0.0:
            left.append(f"none to {limit}")
        else:
            past = _past(one, law, ask(report, "wear", "regions") or ())
            left.append(f"{count(one['value'])} ({_span(one)}) to {limit}{', ' if past else ''}{past}")
    said = [*([f"forecast, mean flank at its deepest: {'; '.join(depths)}"] if depths else [])]
    said += [f"cycles left, mean flank: {'; '.join(left)}"] if left else []
    return " ".join(map(sentence, said))


def _past(one: Report, law: Report, regions: Sequence[Report]) -> str:
    """Which teeth are past a limit on depth that the mean flank has still to reach; "" for none."""
    if one["quantity"] != "depth" or one["value"] == 0.0:
        return ""
    deep = [r for r in regions if r["flank"] == law["flank"] and (r.get("max_depth_um") or 0.0) > one["limit_um"]]
    teeth = [str(tooth) for tooth in sorted(r["tooth"] for r in deep)]
    return (
        f"{'tooth' if len(teeth) == 1 else 'teeth'} {listed(teeth)} {'is' if len(teeth) == 1 else 'are'} past it" if teeth else ""
    )


def _limit(one: Report) -> str:
    unit = QUANTITIES[one["quantity"]][1]
    return f"{significant(one[f'limit_{unit}'])}{SPACE}{'µm' if unit == 'um' else unit}"


def _span(one: Report) -> str:
    """The band of the cycles left; null in a report that was read back is no end."""
    late = "no end" if one["high"] is None or math.isinf(one["high"]) else count(one["high"])
    return f"{count(one['low'])} to {late}"


def _far_words(law: Report) -> str:
    rows = [*(ask(law, "forecast", "at") or []), *(ask(law, "forecast", "cycles_left") or [])]
    if not any(row.get("far") and not row.get("never") for row in rows):
        return ""
    return (
        f"Beyond {number(FAR, 0)} times the cycles run a forecast is a guess: by then the flanks have lost as much again, and pressure and"
        " sliding are no longer those that the rate was found with."
    )


def _forecast_table(law: Report) -> str:
    rows = ask(law, "forecast", "at")
    if not rows:
        return ""
    head = ("cycles since new", "greatest depth, µm", "loss of thickness, mm", "growth of normal backlash, mm")
    keys = (("greatest_depth_um", 1), ("thickness_loss_mm", 4), ("backlash_increase_mm", 4))

    def span(item: Report, digits: int) -> str:
        return f"{number(item['value'], digits)} ({number(item['low'], digits)} … {number(item['high'], digits)})"

    caption = (
        f"Forecast for the mean flank with its 95{SPACE}% band, {HOLDS}; the first row is now."
        " The growth of backlash is the most it can be: corners and the highest places of the flanks, which carry first, are not in it."
    )
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
