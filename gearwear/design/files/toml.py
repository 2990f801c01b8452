"""A design file (TOML, a table of drawing data, REXS) to a `Design`; every refusal names the file and the value."""

from __future__ import annotations

import codecs
import hashlib
import math
import re
import tomllib
from collections.abc import Callable
from dataclasses import fields, replace
from os import PathLike
from pathlib import Path
from typing import Any

from gearwear.design.drawn_gauge import DrawnGauge, shift_instead
from gearwear.design.files.rexs import parse_rexs
from gearwear.design.files.sections import (
    parse_datum,
    parse_limits,
    parse_load,
    parse_pair,
    parse_report,
    parse_scanner,
    parse_weighing,
)
from gearwear.design.files.table import parse_table
from gearwear.design.files.values import (
    MEASURED,
    RATIOS,
    THINNING_FROM,
    check_keys,
    exclusive,
    finite_number,
    number_or,
    quoted_word,
    shown_key,
    unknown,
)
from gearwear.design.gear import Gear
from gearwear.design.limits import Limits
from gearwear.design.modification import KEYS as MODIFICATION_KEYS
from gearwear.design.modification import WORDS, FlankModification, merged
from gearwear.design.pair import Design, check_pair
from gearwear.design.quantity import as_given, outside, shown
from gearwear.design.spec import ADDENDUM, DEDENDUM, GearSpec, check_module, check_teeth
from gearwear.design.standards import MM_PER_INCH
from gearwear.design.tolerance import GearTolerance
from gearwear.errors import InputError, check_kind, readable

MODULES = ("module", "normal_module", "transverse_module", "diametral_pitch")
SHARED = (*MODULES, "pressure_angle", "face_width", "gap")
GAUGES = {"span": "span_teeth", "over_pins": "pin_diameter"}
"""By which a drawing states the thickness of teeth, each with what it is taken over."""
LENGTHS = (
    "face_width",
    "thinning",
    "bore_diameter",
    "tip_chamfer",
    "end_chamfer",
    "tip_rounding",
    "end_rounding",
    "gap",
    "rim_diameter",
    "fillet_radius",
    "protuberance",
    "grinding_stock",
)
GEAR_KEYS = (
    "teeth",
    *MODULES,
    "pressure_angle",
    "helix_angle",
    "protuberance_angle",
    "tip_diameter",
    "root_diameter",
    *LENGTHS,
    *RATIOS,
    "thinning_from",
    *GAUGES,
    *GAUGES.values(),
    "internal",
    "cutter_teeth",
    *MODIFICATION_KEYS,
    "tolerance",
    "left",
    "right",
)
TOLERANCE_KEYS = tuple(field.name for field in fields(GearTolerance))
MOST_BYTES = 1_000_000
"""Bytes of a file that describes a gear."""
LONG_KEY = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){50}""",
)
"""A key of more than 50 parts: tomllib takes the square of their number in time and memory, and a design has two."""


def read_design(path: str | Path) -> Design:
    """Read a design from a file.

    Parameters
    ----------
    path : path
        TOML as in ``docs/design.md``: ``[pinion]``, ``[gear]`` or both, and ``[pair]``. A name that ends in ``.csv`` is a table of
        drawing data (`gearwear.design.files.table`), in ``.rexs`` or ``.xml`` a REXS model (`gearwear.design.files.rexs`).

    Returns
    -------
    Design

    Raises
    ------
    InputError
        If the file cannot be read, is not of its format, holds an unknown key, or describes a gear or pair that
        cannot exist.
    """
    check_kind(path, str | PathLike, "design", "the path of a file")
    file = Path(path)
    data = read_small(file, "a design in TOML")
    try:
        design = parse_design(LOADERS.get(file.suffix.lower(), parse_toml)(data), source=readable(file))
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    details = design.report
    if details.logo:  # stands beside the design, wherever the command runs
        details = replace(details, logo=str(file.parent / details.logo))
    return replace(design, report=details, sha256=hashlib.sha256(data).hexdigest())


def read_limits(path: Path) -> Limits:
    """The limits of a design file, without the gears; none where there are none or the file is of another format or wrong."""
    if path.suffix.lower() in LOADERS:
        return Limits()
    try:
        limits = parse_toml(read_small(path, "a design in TOML")).get("limits", {})
        return parse_limits(limits) if isinstance(limits, dict) else Limits()
    except InputError:  # said where the design is read
        return Limits()


def read_small(file: Path, needed: str, most: int = MOST_BYTES, usual: str = ", which has some hundred") -> bytes:
    """The bytes of a file that describes something.

    Parameters
    ----------
    file : Path
    needed : str
        What it should be, for the message.
    most : int
        Bytes it may have; no more are read.
    usual : str
        What the message adds about how many it should have.

    Raises
    ------
    InputError
        If it cannot be read or is too large.
    """
    try:
        if file.is_dir():
            raise InputError(f"{file}: is a folder; {needed} is needed")
        with file.open("rb") as stream:
            data = stream.read(most + 1)
    except InputError:  # a ValueError too
        raise
    except FileNotFoundError:
        raise InputError(f"{file}: no such file; {needed} is needed") from None
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}; {needed} is needed") from None
    except ValueError as error:  # a name with a null byte is none
        raise InputError(f"{file}: cannot be read: {error}; {needed} is needed") from None
    if len(data) > most:
        raise InputError(f"{file}: is larger than {most:,} bytes; {needed} is needed{usual}")
    return data


def _text(data: bytes, format_: str) -> str:
    # Some shells write what they redirect as UTF-16.
    wide = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        return data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"is not text in UTF-8; a design in {format_} is needed") from None


def parse_toml(data: bytes) -> dict[str, Any]:
    """The tables of a TOML file; InputError if it is none."""
    text = _text(data, "TOML")
    long = LONG_KEY.search(text)
    if long is not None:
        line = text.count("\n", 0, long.start()) + 1
        raise InputError(f"line {line} has a key of more than 50 parts, {shown(long[0])}; key = value would be right")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # tomllib.TOMLDecodeError; a number or a nesting beyond Python's limits
        raise InputError(f"is not TOML: {' '.join(str(error).split())}{_slip(text, str(error))}") from None


def _slip(text: str, error: str) -> str:
    """The line that is no TOML, and what would be right where that is plain."""
    place = re.search(r"at line (\d+)", error)
    if place is None:
        return ""
    line = text.splitlines()[int(place[1]) - 1].strip()
    if re.search(r"=\s*[-+]?\d+,\d", line):
        return f": {shown(line)}: a point is needed as decimal sign"
    if re.search(r"=\s*\d+([-./])\d+\1\d+", line):
        return f": {shown(line)}: is no date; year-month-day such as 2026-11-22, or text in quotes, would be right"
    if re.search(r"=\s*[-+]?[\d.]+\s*[^\d\s.#]", line):
        return f": {shown(line)}: a number stands alone, without a unit; lengths are in mm, angles in degrees"
    return f": {shown(line)}"


def _table(data: bytes) -> dict[str, Any]:
    return parse_table(_text(data, "CSV"))


LOADERS: dict[str, Callable[[bytes], dict[str, Any]]] = {".csv": _table, ".rexs": parse_rexs, ".xml": parse_rexs}
"""What turns a file's bytes into the tables of a design, by the end of its name; all others are TOML."""


def parse_design(data: dict[str, Any], source: str = "") -> Design:
    """Build a `Design` from the parsed tables of a design file; see `read_design`."""
    known = ("pair", "pinion", "gear", "scanner", "datum", "load", "limits", "report", "weighing")
    for section, table in data.items():
        if section in GEAR_KEYS and not isinstance(table, dict):
            raise InputError(f"{section} = {shown(table)} stands in no section: it needs a line [gear] or [pinion] above it")
        if section not in known:
            raise InputError(unknown(f"[{shown_key(section)}]", section, known))
        if not isinstance(table, dict):
            raise InputError(f"{section} = {shown(table)}: must be a table, written [{section}]")
    scanner, limits = parse_scanner(data.get("scanner", {})), parse_limits(data.get("limits", {}))
    datum = parse_datum(data.get("datum", {}))
    report = parse_report(data.get("report", {}))
    weighing = parse_weighing(data["weighing"]) if "weighing" in data else None
    parts: list[str] = [part for part in ("pinion", "gear") if part in data]
    if not parts:
        raise InputError("neither [pinion] nor [gear]: at least one must be given")
    # A gear alone shares with itself: nothing.
    tables = {part: _with_shared(data[part], other, data[other]) for part, other in zip(parts, parts[::-1], strict=True)}
    gears = {part: Gear.from_spec(_gear_spec(part, tables[part])) for part in parts}
    limits.check(min(gear.pitch_angle * gear.reference_radius for gear in gears.values()))
    notes = tuple(note for gear in gears.values() for note in (shift_instead(gear.spec), *gear.notes) if note)
    if len(parts) == 1:
        for section in ("pair", "load"):
            if section in data:
                raise InputError(f"[{section}] needs both [pinion] and [gear]; only [{parts[0]}] is there")
        return Design(
            gears=gears, warnings=notes, source=source, scanner=scanner, datum=datum, limits=limits, report=report, weighing=weighing,
        )  # fmt: skip
    pair = parse_pair(data.get("pair", {}))
    load = parse_load(data["load"]) if "load" in data else None
    return Design(
        gears=gears, pair=pair, warnings=notes + check_pair(gears["pinion"], gears["gear"], pair), source=source, scanner=scanner, datum=datum,
        limits=limits, load=load, report=report, weighing=weighing,
    )  # fmt: skip


def _with_shared(table: dict[str, Any], other: str, mate: dict[str, Any]) -> dict[str, Any]:
    """`table` with what a pair must share taken from its mate, of the section `other`, where it is left out; the helix angle with the other hand,
    inside a ring the same."""
    shared = {key: mate[key] for key in SHARED if key in mate and key not in table}
    if any(key in table for key in MODULES):
        shared = {key: value for key, value in shared.items() if key not in MODULES}
    if "helix_angle" in mate and "helix_angle" not in table:
        same = bool(table.get("internal")) != bool(mate.get("internal"))
        shared["helix_angle"] = finite_number(other, mate, "helix_angle") * (1.0 if same else -1.0)
    return {**table, **shared}


def _gear_spec(part: str, table: dict[str, Any]) -> GearSpec:
    check_keys(f"[{part}]", table, GEAR_KEYS)
    internal = table.get("internal", False)
    if not isinstance(internal, bool):
        raise InputError(f"[{part}] internal = {shown(internal)}: true for a ring or false would be right")
    if internal and "rack_tip_radius" in table:
        raise InputError(
            f"[{part}] rack_tip_radius: no rack cuts a ring; cutter_teeth and cutter_tip_radius or fillet_radius would be right"
        )
    if "teeth" not in table:
        raise InputError(f"[{part}] teeth is missing: a whole number")
    teeth = table["teeth"]
    if isinstance(teeth, bool) or not isinstance(teeth, int):
        raise InputError(f"[{part}] teeth = {shown(teeth)}: must be a whole number")
    if teeth < 0:
        raise InputError(f"[{part}] teeth = {shown(teeth)}: must be above 0; a ring is written with internal = true")
    check_teeth(part, teeth)
    helix = math.radians(number_or(part, table, "helix_angle", 0.0))
    module = _normal_module(part, table, helix)
    check_module(part, module)
    if "face_width" not in table:
        raise InputError(f"[{part}] face_width is missing: mm")
    values = {key: finite_number(part, table, key) for key in LENGTHS + RATIOS if key in table}
    shift, orientation = values.get("profile_shift", 0.0), -1 if internal else 1
    reference = 0.5 * teeth / math.cos(helix)
    if "tip_diameter" in table:
        exclusive(part, table, "tip_diameter", "addendum")
        values["addendum"] = _rim(
            part, table, "tip_diameter", module, lambda radius: orientation * (radius - reference) - shift, ADDENDUM
        )
    if "root_diameter" in table:
        exclusive(part, table, "root_diameter", "dedendum")
        values["dedendum"] = _rim(
            part, table, "root_diameter", module, lambda radius: orientation * reference + shift - orientation * radius, DEDENDUM
        )
    spec = GearSpec(
        name=part,
        teeth=teeth,
        normal_module=module,
        normal_pressure_angle=math.radians(number_or(part, table, "pressure_angle", 20.0)),
        helix_angle=helix,
        tolerance=_tolerance(part, table.get("tolerance", {})),
        left=_modification(part, table, "left"),
        right=_modification(part, table, "right"),
        internal=internal,
        cutter_teeth=_cutter_teeth(part, table),
        protuberance_angle=math.radians(finite_number(part, table, "protuberance_angle"))
        if "protuberance_angle" in table
        else None,
        modified_between=None,
        ends_seen=None,
        thinning_measured=_measured_thinning(part, table),
        gauge=_gauge(part, table),
        **values,
    )
    if spec.gauge is None:
        return spec
    thinning, half = spec.gauge.thinning(spec)
    if half > 0.0 and spec.tolerance.thickness is None:
        spec = replace(spec, tolerance=replace(spec.tolerance, thickness=half))
    return replace(spec, thinning=thinning)


def _gauge(part: str, table: dict[str, Any]) -> DrawnGauge | None:
    """Span or dimension over pins, one value or its two limits, in place of the thinning."""
    for (key, over), other in zip(GAUGES.items(), reversed(GAUGES), strict=True):
        if key not in table:
            if over in table:
                raise InputError(f"[{part}] {over} without {key}: mm, a value or its two limits [low, high]")
            continue
        exclusive(part, table, key, other)
        exclusive(part, table, key, "thinning")
        if over not in table:
            what = "the teeth it is taken over" if key == "span" else "mm"
            raise InputError(f"[{part}] {key} without {over}: {what}")
        given = table[key] if isinstance(table[key], list) else [table[key]]
        if len(given) not in (1, 2):
            raise InputError(f"[{part}] {key} = {shown(given)}: a value or its two limits [low, high] would be right")
        low, *high = sorted(finite_number(part, {key: value}, key) for value in given)
        if low <= 0.0:
            raise InputError(f"[{part}] {key} = {as_given(low)} mm: must be above 0")
        return DrawnGauge(low=low, high=high[0] if high else low, **_over(part, table, over))
    return None


def _over(part: str, table: dict[str, Any], key: str) -> dict[str, Any]:
    """Over how many teeth or which pins a gauge is taken."""
    if key == "span_teeth":
        teeth = table[key]
        if isinstance(teeth, bool) or not isinstance(teeth, int) or teeth < 1:
            raise InputError(f"[{part}] {key} = {shown(teeth)}: must be a whole number above 0")
        if table.get("internal"):
            raise InputError(f"[{part}] span: no plates reach into a ring; over_pins, between pins, would be right")
        return {"teeth": teeth}
    diameter = finite_number(part, table, key)
    if diameter <= 0.0:
        raise InputError(f"[{part}] {key} = {as_given(diameter)} mm: must be above 0")
    return {"pin_diameter": diameter}


def _measured_thinning(part: str, table: dict[str, Any]) -> bool:
    """Whether the thinning was measured on a gear, and not drawn."""
    origin = quoted_word(part, table, "thinning_from") if "thinning_from" in table else "drawing"
    if origin not in THINNING_FROM:
        raise InputError(f"[{part}] thinning_from = {shown(origin)}: must be {' or '.join(THINNING_FROM)}")
    return origin == MEASURED


def _cutter_teeth(part: str, table: dict[str, Any]) -> int | None:
    teeth = table.get("cutter_teeth")
    if teeth is not None and (isinstance(teeth, bool) or not isinstance(teeth, int)):
        raise InputError(f"[{part}] cutter_teeth = {shown(teeth)}: must be a whole number")
    return teeth


def _modification(part: str, table: dict[str, Any], side: str) -> FlankModification:
    """Relief, crowning and slopes of one side: the gear's keys, with those of ``[gear.left]`` or ``[gear.right]`` in their place."""
    of_side = table.get(side, {})
    if not isinstance(of_side, dict):
        raise InputError(f"[{part}] {side} = {shown(of_side)}: must be a table, written [{part}.{side}]")
    check_keys(f"[{part}.{side}]", of_side, MODIFICATION_KEYS)
    shared, alone = (
        {
            key: quoted_word(section, keys, key) if key in WORDS else finite_number(section, keys, key)
            for key in MODIFICATION_KEYS
            if key in keys
        }
        for section, keys in ((part, table), (f"{part}.{side}", of_side))
    )
    modification = merged(shared, alone)
    modification.check(f"{part}.{side}" if alone else part)
    return modification


def _rim(
    part: str, table: dict[str, Any], key: str, module: float, ratio: Callable[[float], float], legal: tuple[float, float]
) -> float:
    """Addendum or dedendum, in modules, of a diameter that is given; where it is not legal the diameter is refused, as one in inches is.

    Parameters
    ----------
    part : str
        The gear's table, for what is said.
    table : dict
        What stands in it.
    key : str
        Of the diameter, mm.
    module : float
        Normal module, mm.
    ratio : function
        Addendum or dedendum of a radius, both in modules.
    legal : (float, float)
        Between what it must lie.

    Returns
    -------
    float

    Raises
    ------
    InputError
        If the diameter is no number, or the ratio lies outside `legal`.
    """
    diameter, (low, high) = finite_number(part, table, key), legal
    value, of_inches = (ratio(0.5 * length / module) for length in (diameter, MM_PER_INCH * diameter))
    if low <= value <= high:
        return value
    if low <= of_inches <= high:
        raise InputError(
            f"[{part}] {key} = {diameter:g} mm: cannot be that of this gear; {diameter:g} inches could: {MM_PER_INCH * diameter:.6g} mm"
        )
    name = "addendum" if key.startswith("tip") else "dedendum"
    raise InputError(
        f"[{part}] {key} = {as_given(diameter)} mm: {name} = {outside(value, low, high)} modules: must lie from {low:g} to {high:g}; check module and teeth too"
    )


def _normal_module(part: str, table: dict[str, Any], helix: float) -> float:
    """m_n in mm, whichever way it is given; `module` and `diametral_pitch` are those of the tool."""
    stated = [key for key in MODULES if key in table]
    if len(stated) > 1:
        raise InputError(f"[{part}] {' and '.join(stated)} are {'both' if len(stated) == 2 else 'all'} given: one of them")
    if not stated:
        raise InputError(f"[{part}] module is missing: mm, or diametral_pitch")
    value = finite_number(part, table, stated[0])
    if stated[0] == "transverse_module":
        return value * math.cos(helix)
    if stated[0] != "diametral_pitch":
        return value
    if not 0.0 < value < math.inf:
        raise InputError(f"[{part}] diametral_pitch = {value:g}: must be above 0")
    return MM_PER_INCH / value


def _tolerance(part: str, table: object) -> GearTolerance:
    """``[gear.tolerance]``: each ± about the drawing's value."""
    if not isinstance(table, dict):
        raise InputError(f"[{part}] tolerance = {shown(table)}: must be a table, written [{part}.tolerance]")
    check_keys(f"[{part}.tolerance]", table, TOLERANCE_KEYS)
    told = {key: finite_number(f"{part}.tolerance", table, key) for key in table}
    told.pop("flank_class", None)
    return GearTolerance(**told, flank_class=table.get("flank_class"))
