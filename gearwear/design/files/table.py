"""A table of drawing data (CSV: key, value, unit) as the tables of a design file."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from typing import Any

from gearwear.design.files.sections import PAIR_KEYS
from gearwear.design.files.values import RATIOS
from gearwear.design.modification import KEYS as MODIFICATION_KEYS
from gearwear.design.modification import WORDS
from gearwear.design.spec import check_module
from gearwear.design.standards import MM_PER_INCH
from gearwear.errors import InputError

ALIASES = {
    "z": "teeth", "number_of_teeth": "teeth", "m": "module", "mn": "module", "mt": "transverse_module", "dp": "diametral_pitch", "alpha": "pressure_angle",
    "α": "pressure_angle", "normal_pressure_angle": "pressure_angle", "beta": "helix_angle", "β": "helix_angle", "b": "face_width",
    "facewidth": "face_width", "x": "profile_shift", "profile_shift_coefficient": "profile_shift", "da": "tip_diameter",
    "outside_diameter": "tip_diameter", "df": "root_diameter", "bore": "bore_diameter", "ha*": "addendum", "hf*": "dedendum",
    "z0": "cutter_teeth", "p_d": "diametral_pitch", "pd": "diametral_pitch", "pnd": "diametral_pitch", "normal_diametral_pitch": "diametral_pitch", "od": "tip_diameter",
    "outer_diameter": "tip_diameter", "rho_f*": "rack_tip_radius", "hob_tip_radius": "rack_tip_radius", "pr": "protuberance", "q": "grinding_stock", "a": "centre_distance", "center_distance": "centre_distance",
    "wk": "span", "w_k": "span", "k": "span_teeth", "base_tangent_length": "span", "mdk": "over_pins", "mdr": "over_pins", "dm": "pin_diameter",
}  # fmt: skip
"""What drawings call the keys of a design file."""
MM = {
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
    "um": 1e-3,
    "µm": 1e-3,
    "μm": 1e-3,
    "in": MM_PER_INCH,
    "inch": MM_PER_INCH,
    '"': MM_PER_INCH,
}
DEGREES = {"deg": 1.0, "°": 1.0, "degree": 1.0, "degrees": 1.0, "rad": math.degrees(1.0)}
PLAIN = ("", "-", "–", "1", "none")
PER_INCH = ("1/in", "1/inch", "in^-1", *PLAIN)
MODULES = ("modules", "module", "× module", "x module", "*m", *PLAIN)
LENGTHS = (
    "module", "face_width", "thinning", "bore_diameter", "tip_chamfer", "end_chamfer", "tip_diameter", "root_diameter", "centre_distance",
    "backlash_allowance", "normal_module", "transverse_module", "rim_diameter", "fillet_radius", "protuberance",
    "grinding_stock", "tip_rounding", "end_rounding", "gap", "span", "over_pins", "pin_diameter", *(key for key in MODIFICATION_KEYS if key not in WORDS),
)  # fmt: skip
ANGLES = ("pressure_angle", "helix_angle", "protuberance_angle")
COUNTS = ("teeth", "cutter_teeth", "span_teeth")
PARTS = ("pinion", "gear", "pair")
_REMARK = re.compile(r'\s*"?\s*#')
"""How a line that is skipped begins; a spreadsheet puts quotes round one with a separator in it."""


def parse_table(text: str) -> dict[str, Any]:
    """Turn a table of drawing data into the tables of a design file.

    Parameters
    ----------
    text : str
        Rows ``key, value, unit``; the separator is a comma, semicolon or tabulator, and with the latter two the decimal sign may be a
        comma. Lines that are empty or begin with # are skipped, and a first row without a number that names the columns. Quotes round a cell do
        not count, and one alone as the unit is the sign of inches. A key is one
        of the design file or a usual drawing symbol (`ALIASES`), with ``pinion.``, ``gear.`` or ``pair.`` before it where there are
        two gears; without, it belongs to ``[gear]``.

    Returns
    -------
    dict
        As `gearwear.design.files.toml.parse_design` takes it.

    Raises
    ------
    InputError
        If a row is not understood; the message has its line number.

    Examples
    --------
    >>> parse_table("key,value,unit\\nz,24,-\\nmodule,6.35,mm\\nface width,0.59,in")
    {'gear': {'teeth': 24, 'module': 6.35, 'face_width': 14.986}}
    """
    lines = text.splitlines()
    separator = _separator(lines)
    design: dict[str, Any] = {}
    in_mm: list[tuple[int, str, str, float]] = []
    given: set[tuple[str, str]] = set()
    for number, row in _rows(lines, separator):
        cells = [_unquoted(cell.strip()) for cell in row]
        if not any(cells):
            continue
        if len(cells) < 2 or any(cells[3:]):
            raise InputError(f"line {number}: {len(cells)} columns; key, value, unit would be right")
        key, value, unit = cells[0], cells[1], (cells[2] if len(cells) > 2 else "")
        if not design and not in_mm and value.lower() in ("value", "wert"):
            continue
        if _is_number(key):
            raise InputError(
                f"line {number}: begins with a number: a design as a table has key, value, unit; a scan stands behind the design"
            )
        section, name = _key(key, number)
        if (section, name) in given:
            raise InputError(f"line {number}: {name} is given twice")
        given.add((section, name))
        if name in RATIOS and unit.lower() not in MODULES:
            in_mm.append((number, section, name, _length(value, unit, name, separator, number)))
            continue
        table = design.setdefault(section, {})
        table[name] = _value(name, value, unit, separator, number)
    for number, section, name, length in in_mm:
        module = _module(design.get(section, {}))
        if module is None:
            raise InputError(
                f"line {number}: {name} in mm needs the module of the same gear; as a multiple of it, the unit is left empty"
            )
        check_module(section, module)
        design.setdefault(section, {})[name] = length / module
    return design


def _rows(lines: list[str], separator: str) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row; quotes stay, as one alone is the sign of inches."""
    rows = ("" if _REMARK.match(line) else line for line in lines)
    reader = csv.reader(rows, delimiter=separator, quoting=csv.QUOTE_NONE)
    try:
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:
        raise InputError(f"line {reader.line_num}: is no row of a table ({error}); key, value, unit would be right") from None


def _unquoted(cell: str) -> str:
    """A cell without the quotes round it; within them two stand for one.

    >>> [_unquoted(cell) for cell in ('"face width"', 4 * '"', '"', "mm")]
    ['face width', '"', '"', 'mm']
    """
    return cell[1:-1].replace('""', '"') if len(cell) > 1 and cell[0] == cell[-1] == '"' else cell


def _separator(lines: list[str]) -> str:
    body = [line for line in lines if line.strip() and not _REMARK.match(line)]
    return max(";\t,", key=lambda sign: (sum(sign in line for line in body), sign == ";"))


def _key(text: str, line: int) -> tuple[str, str]:
    """Section and key of the design file."""
    name = re.sub(r"[\s-]+", "_", text.strip().lower())
    section, dot, rest = name.partition(".")
    if dot and section in PARTS:
        name = rest
    elif dot:
        raise InputError(
            f"line {line}: {text}: {', '.join(part + '.' for part in PARTS)} or nothing would be right before the key"
        )
    else:
        section = ""
    name = ALIASES.get(name, name)
    return section or ("pair" if name in PAIR_KEYS else "gear"), name


def _value(name: str, value: str, unit: str, separator: str, line: int) -> int | float | str | bool:
    if name in ("baseline", "thinning_from") or name in WORDS:
        return value
    if name == "internal":
        if value.lower() not in ("true", "false", "yes", "no", "0", "1"):
            raise InputError(f"line {line}: internal = {value}: yes or no would be right")
        return value.lower() in ("true", "yes", "1")
    if name in LENGTHS:
        return _length(value, unit, name, separator, line)
    number = _number(value, name, separator, line)
    known: dict[str, float] = dict.fromkeys(PLAIN, 1.0)
    if name not in (*COUNTS, *ANGLES, "diametral_pitch", *RATIOS):
        return number  # of no key that is known: the design says so, whatever its unit
    if name in ANGLES:
        known = {**DEGREES, "": 1.0}
    elif name == "diametral_pitch":
        known = dict.fromkeys(PER_INCH, 1.0)
    elif name in RATIOS:
        known = dict.fromkeys(MODULES, 1.0)
    if unit.lower() not in known:
        raise InputError(f"line {line}: {name} in {unit}: {', '.join(symbol or 'no unit' for symbol in known)} would be right")
    if name in COUNTS and number == int(number):
        return int(number)
    return round(number * known[unit.lower()], 12)


def _length(value: str, unit: str, name: str, separator: str, line: int) -> float:
    # mm where no unit is said, as on any drawing.
    if unit and unit.lower() not in MM:
        raise InputError(f"line {line}: {name} in {unit}: {', '.join(MM)} would be right")
    return round(_number(value, name, separator, line) * MM.get(unit.lower(), 1.0), 12)


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def _number(value: str, name: str, separator: str, line: int) -> float:
    text = value.replace(",", ".") if separator != "," else value
    try:
        number = float(text)
    except ValueError:
        raise InputError(f"line {line}: {name} = {value[:40]}: must be a number") from None
    if not math.isfinite(number):
        raise InputError(f"line {line}: {name} = {value[:40]}: must be a finite number")
    return number


def _module(table: dict[str, Any]) -> float | None:
    """Normal module of a gear's rows, mm."""
    for name in ("module", "normal_module"):
        if name in table:
            return float(table[name])
    if "transverse_module" in table:
        return float(table["transverse_module"]) * math.cos(math.radians(float(table.get("helix_angle", 0.0))))
    return MM_PER_INCH / table["diametral_pitch"] if table.get("diametral_pitch", 0.0) > 0.0 else None
