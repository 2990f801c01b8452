"""The tables of a design file beside its gears, each read by a function of its name.

All raise `InputError` where a key is unknown or missing, or a value is impossible; the line begins with the table's name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from datetime import date, datetime, time
from typing import Any

from gearwear.design.files.values import check_keys, exclusive, finite_number, number_or, quoted_word, unknown, yes_or_no
from gearwear.design.limits import LIMIT_KEYS, Limits
from gearwear.design.load import LoadSpec
from gearwear.design.quantity import shown
from gearwear.design.report_details import ReportDetails
from gearwear.design.scan_spec import EXPANSION_PPM, Artefact, DatumBand, DatumMark, DatumSpec, ScannerSpec
from gearwear.design.spec import Baseline, PairSpec
from gearwear.design.weighing import DENSITY, DENSITY_STD, WeighingSpec
from gearwear.errors import InputError

PAIR_KEYS = ("centre_distance", "backlash_allowance", "baseline")
SCANNER_NUMBERS = ("axis_offset_mm", "noise_um", "scale_ppm_max", "scale_std_ppm")
SCANNER_ANSWERS = ("turntable", "stitched")
SCANNER_KEYS = (*SCANNER_NUMBERS, *SCANNER_ANSWERS)
DATUM_KEYS = (
    "tooth_1_deg", "before_tooth_1_deg", "ignore", "ignore_teeth", "ignore_z_mm", "axis", "temperature_C", "temperature_std_K", "material", "expansion_ppm_K",
    "artefact",
    "band",
    "mark",
)  # fmt: skip
LOAD_KEYS = ("torque_Nm", "load_per_width_N_mm", "speed_rpm", "elastic_modulus_MPa", "poisson", "misalignment_um")
ARTEFACT_KEYS = ("kind", "diameter_mm", "centre_mm", "std_um")
BAND_KEYS = ("diameter_mm", "z_mm")
MARK_KEYS = ("width_mm", "radius_mm", "z_mm", "angle_deg")
REPORT_KEYS = tuple(field.name for field in fields(ReportDetails))
WEIGHING_KEYS = ("before_g", "after_g", "std_g", "material", "density_g_cm3", "density_std_percent")
MOST_TABLES = 20
"""Artefacts, and bands, of one design."""
FARTHEST_MM = 1e6
"""No height of a gear lies so far off; an integer of TOML may be larger than any float."""


def _of_material(section: str, table: dict[str, Any], known: Mapping[str, float]) -> float:
    """What is known of the material that a section names."""
    material = quoted_word(section, table, "material")
    if material not in known:
        raise InputError(unknown(f"[{section}] material = {shown(material)}", material, tuple(known)))
    return known[material]


def parse_pair(table: dict[str, Any]) -> PairSpec:
    """``[pair]``."""
    check_keys("[pair]", table, PAIR_KEYS)
    baseline = table.get("baseline", Baseline.ZERO_BACKLASH.value)
    if baseline not in [b.value for b in Baseline]:
        raise InputError(f"[pair] baseline = {shown(baseline)}: must be one of {', '.join(b.value for b in Baseline)}")
    centre = number_or("pair", table, "centre_distance", None)
    return PairSpec(centre, number_or("pair", table, "backlash_allowance", 0.0), Baseline(baseline))


def parse_scanner(table: dict[str, Any]) -> ScannerSpec:
    """``[scanner]``: µm and ppm here, mm and shares inside."""
    check_keys("[scanner]", table, SCANNER_KEYS)
    offset, noise, scale, scale_std = (number_or("scanner", table, key, None) for key in SCANNER_NUMBERS)
    turntable, stitched = (yes_or_no("scanner", table, key, True) for key in SCANNER_ANSWERS)
    return ScannerSpec(
        offset, None if noise is None else 1e-3 * noise, None if scale is None else 1e-6 * scale, 1e-6 * (scale_std or 0.0),
        turntable, stitched,
    )  # fmt: skip


def parse_datum(table: dict[str, Any]) -> DatumSpec:
    """``[datum]``: degrees here, rad inside."""
    check_keys("[datum]", table, DATUM_KEYS)
    exclusive("datum", table, "material", "expansion_ppm_K")
    tooth_1, before_tooth_1 = (
        math.radians(finite_number("datum", table, key)) if key in table else None
        for key in ("tooth_1_deg", "before_tooth_1_deg")
    )
    expansion = number_or("datum", table, "expansion_ppm_K", EXPANSION_PPM["steel"])
    if "material" in table:
        expansion = _of_material("datum", table, EXPANSION_PPM)
    if ("material" in table or "expansion_ppm_K" in table) and "temperature_C" not in table:
        raise InputError("[datum] a material or an expansion needs temperature_C, that of the part while it was scanned")
    return DatumSpec(
        tooth_1=tooth_1,
        before_tooth_1=before_tooth_1,
        ignore=_list_of(table, "ignore", lambda name: isinstance(name, str), 'surfaces, such as ["tip", "end_low"]'),
        ignore_teeth=tuple(
            tooth - 1
            for tooth in _list_of(
                table, "ignore_teeth", lambda tooth: type(tooth) is int and tooth > 0, "teeth counted from 1, such as [3, 7]"
            )
        ),
        ignore_z=tuple(
            (float(low), float(high))
            for low, high in _list_of(table, "ignore_z_mm", _is_band, "bands from z to z, such as [[0.0, 1.5], [13.5, 15.0]]")
        ),
        axis=quoted_word("datum", table, "axis") if "axis" in table else "teeth",
        temperature=number_or("datum", table, "temperature_C", None),
        temperature_std=number_or("datum", table, "temperature_std_K", 0.0),
        expansion=1e-6 * expansion,
        bands=tuple(_band(band) for band in _tables("band", table)),
        artefacts=tuple(_artefact(artefact) for artefact in _tables("artefact", table)),
        mark=_mark(table["mark"]) if "mark" in table else None,
    )


def _list_of(table: dict[str, Any], key: str, fits: Callable[[Any], bool], right: str) -> tuple[Any, ...]:
    """A list of ``[datum]``, empty where it is left out."""
    values = table.get(key, [])
    if not isinstance(values, list) or not all(map(fits, values)):
        raise InputError(f"[datum] {key} = {shown(values)}: a list of {right} would be right")
    return tuple(values)


def _is_band(ends: Any) -> bool:
    return isinstance(ends, list) and len(ends) == 2 and all(type(end) in (int, float) and abs(end) < FARTHEST_MM for end in ends)


def parse_limits(table: dict[str, Any]) -> Limits:
    """``[limits]``: what wear is allowed."""
    check_keys("[limits]", table, LIMIT_KEYS)
    depth, volume, loss, backlash = (number_or("limits", table, key, None) for key in LIMIT_KEYS)
    return Limits(wear_depth=depth, wear_volume=volume, thickness_loss=loss, backlash=backlash)


def parse_load(table: dict[str, Any]) -> LoadSpec:
    """``[load]``: N m and µm here, N mm and mm inside."""
    check_keys("[load]", table, LOAD_KEYS)
    values = {key: finite_number("load", table, key) for key in table}
    names = {
        "load_per_width_N_mm": ("load_per_width", 1.0), "torque_Nm": ("torque", 1e3), "speed_rpm": ("speed_rpm", 1.0),
        "elastic_modulus_MPa": ("elastic_modulus", 1.0), "poisson": ("poisson", 1.0), "misalignment_um": ("misalignment", 1e-3),
    }  # fmt: skip
    return LoadSpec(**{names[key][0]: names[key][1] * value for key, value in values.items()})


def _band(table: dict[str, Any]) -> DatumBand:
    """``[[datum.band]]``."""
    check_keys("[datum] band", table, BAND_KEYS, needed=BAND_KEYS)
    return DatumBand(
        finite_number("datum", table, "diameter_mm"), *_ends("band z_mm", table["z_mm"], "heights, such as [-20.0, -5.0]")
    )


def _ends(key: str, ends: Any, right: str) -> tuple[float, float]:
    """Two numbers of ``[datum]``, from where to where."""
    if not isinstance(ends, list) or len(ends) != 2:
        raise InputError(f"[datum] {key} = {shown(ends)}: two {right}, would be right")
    low, high = (finite_number("datum", {key: value}, key) for value in ends)
    return low, high


def _mark(table: Any) -> DatumMark:
    """``[datum.mark]``: degrees here, rad inside."""
    if not isinstance(table, dict):
        raise InputError(f"[datum] mark = {shown(table)}: a table, written [datum.mark], would be right")
    check_keys("[datum] mark", table, MARK_KEYS, needed=MARK_KEYS[:1])
    right = {"radius_mm": "radii, such as [12.5, 14.0]", "z_mm": "heights, such as [14.0, 14.8]"}
    ends = {key: _ends(f"mark {key}", table[key], words) for key, words in right.items() if key in table}
    width, angle = (
        number_or("datum", {f"mark {key}": table[key]} if key in table else {}, f"mark {key}", 0.0)
        for key in ("width_mm", "angle_deg")
    )
    return DatumMark(width, ends.get("radius_mm"), ends.get("z_mm"), math.radians(angle))


def _tables(key: str, datum: dict[str, Any]) -> list[dict[str, Any]]:
    """The tables ``[[datum.KEY]]``; none where they are left out."""
    tables = datum.get(key, [])
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables) or len(tables) > MOST_TABLES:
        raise InputError(f"[datum] {key} = {shown(tables)}: up to {MOST_TABLES} tables, written [[datum.{key}]], would be right")
    return tables


def _artefact(table: dict[str, Any]) -> Artefact:
    """``[[datum.artefact]]``: µm here, mm inside."""
    check_keys("[datum] artefact", table, ARTEFACT_KEYS, needed=ARTEFACT_KEYS[:3])
    centre = table["centre_mm"]
    if not isinstance(centre, list) or len(centre) != 3:
        raise InputError(
            f"[datum] artefact centre_mm = {shown(centre)}: three numbers, such as [80.0, 0.0, 12.0], would be right"
        )
    x, y, z = (finite_number("datum", {"artefact centre_mm": value}, "artefact centre_mm") for value in centre)
    std = 1e-3 * number_or("datum", table, "std_um", 0.0)
    return Artefact(quoted_word("datum", table, "kind"), finite_number("datum", table, "diameter_mm"), (x, y, z), std)


def parse_report(table: dict[str, Any]) -> ReportDetails:
    """``[report]``: what its reports say of the part and of who measured it."""
    check_keys("[report]", table, REPORT_KEYS)
    return ReportDetails(**{key: _text(key, value) for key, value in table.items()})


def _text(key: str, value: object) -> str:
    if isinstance(value, date | datetime | time):
        return value.isoformat()
    if isinstance(value, int) and not isinstance(value, bool):
        return shown(value)
    if not isinstance(value, str):
        raise InputError(f'[report] {key} = {shown(value)}: must be text, as {key} = "…"')
    return value.strip()


def parse_weighing(table: dict[str, Any]) -> WeighingSpec:
    """``[weighing]``."""
    check_keys("[weighing]", table, WEIGHING_KEYS)
    for key in ("before_g", "after_g", "std_g"):
        if key not in table:
            raise InputError(f"[weighing] {key} is missing: g")
    if ("material" in table) == ("density_g_cm3" in table):
        how_many = "both given" if "material" in table else "both missing"
        raise InputError(f"[weighing] material and density_g_cm3 are {how_many}: one of them")
    if "material" in table:
        density = _of_material("weighing", table, DENSITY)
    else:
        density = finite_number("weighing", table, "density_g_cm3")
    before, after, std = (finite_number("weighing", table, key) for key in ("before_g", "after_g", "std_g"))
    share = finite_number("weighing", table, "density_std_percent") / 100.0 if "density_std_percent" in table else DENSITY_STD
    return WeighingSpec(before, after, std, density, share)
