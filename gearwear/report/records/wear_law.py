"""The wear law and its forecast as plain numbers: `meshing` → `wear_law` of `report.json`."""

from __future__ import annotations

from gearwear.report.records.numbers import Json, value_std, value_std_unit
from gearwear.report.words.wear_law import BAND, HOLDS, RUN_BAND
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.archard import TERMS
from gearwear.wear_law.fit import WearFit
from gearwear.wear_law.forecast import Band, WearForecast
from gearwear.wear_law.study import WearStudy

UNITS = {"depth": ("um", 1e3), "thickness": ("mm", 1.0), "backlash": ("mm", 1.0)}
"""Unit of each quantity that may have a limit, and how many of it a mm is."""


def wear_law_record(study: WearStudy) -> Json:
    """``fitted``, and either ``why_not`` or the fit; ``forecast`` where one was asked for and possible."""
    record: Json = {"fitted": bool(study.fits), "flank": str(study.side)}
    if study.why_not:
        record["why_not"] = study.why_not
    if study.note:
        record["note"] = study.note
    if study.across is not None:
        record["across_face"] = _across(study.across)
    best, path = study.best, study.path
    if best is None or path is None:
        return record
    (share, std), (roll, depth) = best.explained, study.over_path
    record |= {
        "teeth": [tooth + 1 for tooth in study.teeth],
        "left_out": [tooth + 1 for tooth in study.left_out],
        "share_of_volume": study.volume_share,
        "terms": _terms(best),
        "explained_share": value_std_unit(share, std, "1"),
        "unexplained_share": value_std_unit(1.0 - share, std, "1"),
        "unexplained_rms_um": 1e3 * best.unexplained_depth,
        "explained_variation": best.explained_variation[0],
        "single_contact": {
            "coefficient_um": value_std_unit(1e3 * best.single_contact.sliding, 1e3 * best.single_contact.sliding_std, "um"),
            "uniform_um": value_std_unit(1e3 * best.single_contact.uniform, 1e3 * best.single_contact.uniform_std, "um"),
        },
        "load_sharing": best.sharing.value,
        "load_sharing_alike": list(study.sharing_alike),
        "chi_square": best.chi_square,
        "degrees_of_freedom": best.degrees_of_freedom,
        "roll_mm": [float(best.roll[0]), float(best.roll[-1])],
        "single_contact_mm": list(path.single_contact_pinion) if path.overlap_ratio == 0.0 else [],
        "profile": {
            "roll_mm": best.roll.tolist(),
            "depth_um": (1e3 * best.depth).tolist(),
            "std_um": (1e3 * best.std).tolist(),
            "law_um": (1e3 * best.fitted).tolist(),
        },
        "law_over_path": {"roll_mm": roll.tolist(), "depth_um": (1e3 * depth).tolist()},
        "words": best.words,
    }
    if study.forecast is not None:
        record["forecast"] = _forecast(study, study.forecast, best)
    return record


def _across(across: AcrossFace) -> Json:
    """Of ``across_face``: + lean is deeper at the upper end, + bow deeper at the ends."""
    return {
        "uneven": across.uneven,
        "lean_um": value_std_unit(1e3 * across.lean, 1e3 * across.lean_std, "um"),
        "bow_um": value_std_unit(1e3 * across.bow, 1e3 * across.bow_std, "um"),
        "z_mm": across.z.tolist(),
        "depth_um": (1e3 * across.depth).tolist(),
        "std_um": (1e3 * across.std).tolist(),
    }


def _terms(fit: WearFit) -> Json:
    std, limits, most = fit.covariance.diagonal() ** 0.5, fit.interval(), fit.basis.max(axis=0)
    return {
        name: {
            "coefficient_um": value_std_unit(1e3 * float(fit.coefficients[i]), 1e3 * float(std[i]), "um"),
            "interval_um": [1e3 * float(limit) for limit in limits[i]],
            "greatest_depth_um": value_std_unit(1e3 * float(most[i] * fit.coefficients[i]), 1e3 * float(most[i] * std[i]), "um"),
            **({} if fit.level_free else {"share_of_mean_depth": value_std_unit(*fit.parts[name], "1")}),
        }
        for i, name in enumerate(TERMS)
    }


def _forecast(study: WearStudy, forecast: WearForecast, fit: WearFit) -> Json:
    run = float(forecast.cycles[0])
    left = []
    for limit in study.left:
        unit, per_mm = UNITS[limit.quantity]
        left.append({
            "quantity": limit.quantity, f"limit_{unit}": per_mm * limit.limit, "never": limit.never, "far": limit.far(run),
            "value": limit.left.value, "low": limit.left.low, "high": limit.left.high,
        })  # fmt: skip
    return {
        "cycles_run": run,
        "rate_mm_per_cycle": value_std(*fit.wear_coefficient(run, 1.0)),
        "by": "running" if forecast.by_running else "law",
        "band": RUN_BAND if forecast.by_running else BAND,
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
        "cycles_left": left,
    }


def _band(band: Band, i: int, factor: float = 1.0) -> Json:
    return {name: factor * float(getattr(band, name)[i]) for name in ("value", "low", "high")}
