"""The values of a PLY file after its header: rows of single numbers and of lists.

Rows whose lists are as long as the first row's are read at once; others one after the other.
"""

from __future__ import annotations

import struct
from array import array
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.parsing import check_count, parse_numbers, short_by

Numbers = Ints | Floats

WANTED = ("x", "y", "z", "nx", "ny", "nz", "vertex_indices", "vertex_index")
"""Properties whose values are kept; of all others only the length counts."""


@dataclass(frozen=True, slots=True)
class Property:
    """One property; `count` is the type of a list's length, "" for a single number."""

    name: str
    type: str
    count: str = ""

    @property
    def wanted(self) -> bool:
        return self.name.lower() in WANTED


@dataclass(frozen=True, slots=True)
class Element:
    """One element: its name, how many rows it has, and the properties of each."""

    name: str
    count: int
    properties: tuple[Property, ...]

    def index(self, *names: str) -> int | None:
        """Place of the first property with one of the names."""
        return next((i for i, p in enumerate(self.properties) if p.name.lower() in names), None)


@dataclass(frozen=True, slots=True)
class PlyTable:
    """The values of one element that are wanted, by place of the property: single numbers, and (flat, start, length) of lists."""

    columns: dict[int | None, Numbers]
    lists: dict[int | None, tuple[Numbers, Ints, Ints]]


def read_binary(data: bytes, start: int, elements: list[Element], order: str) -> dict[str, PlyTable]:
    """Values from byte `start` on, in byte order `order` ("<" or ">")."""
    tables = {}
    for element in elements:
        least = sum(np.dtype(p.count or p.type).itemsize for p in element.properties)
        check_count(f"{element.name} rows", element.count, least, len(data) - start)
        check_memory(points=element.count if element.name == "vertex" else 0)
        rows = _regular_rows(data, start, element, order)
        if rows is not None:
            tables[element.name] = _regular_table(rows, element)
            start += rows.nbytes
        else:
            tables[element.name], start = _walk(data, start, element, order)
    check_left_over(len(data) - start, "bytes")
    return tables


def check_left_over(amount: int, unit: str) -> None:
    """Refuse a file that goes on after all that its header promises."""
    if amount > 3:  # a line end after the last value is common
        raise _left_over(amount, unit)


def _left_over(amount: int, unit: str) -> InputError:
    return InputError(
        f"{amount:,} {unit} follow after all that the PLY header promises: a header with the true counts would be right"
    )


def _regular_rows(data: bytes, start: int, element: Element, order: str) -> np.ndarray | None:
    """All rows as one array, or None where lists differ in length."""
    kinds: list[tuple[str, str, int]] = []
    at = start
    for i, p in enumerate(element.properties):
        length = 1
        if p.count:
            head = np.dtype(order + p.count)
            if at + head.itemsize > len(data):
                return None
            length = int(np.frombuffer(data, head, 1, at)[0])
            kinds.append((f"n{i}", order + p.count, 1))
            at += head.itemsize
        at += max(length, 0) * np.dtype(p.type).itemsize
        if at > len(data) or length < 0:
            return None
        kinds.append((f"v{i}", order + p.type, length))
    row = np.dtype([(name, kind, (length,)) for name, kind, length in kinds])
    if element.count * row.itemsize > len(data) - start:
        return None
    rows = np.frombuffer(data, row, element.count, start) if row.itemsize else np.empty(0, row)
    if all((rows[name] == rows[name][:1]).all() for name, _, _ in kinds if name.startswith("n")):
        return rows
    return None


def _regular_table(rows: np.ndarray, element: Element) -> PlyTable:
    columns: dict[int | None, Numbers] = {}
    lists: dict[int | None, tuple[Numbers, Ints, Ints]] = {}
    for i, p in enumerate(element.properties):
        if not p.wanted:
            continue
        values = rows[f"v{i}"]
        if p.count:
            length = np.full(len(rows), values.shape[1])
            lists[i] = np.ascontiguousarray(values).reshape(-1), np.arange(len(rows)) * values.shape[1], length
        else:
            columns[i] = values[:, 0]
    return PlyTable(columns, lists)


def _walk(data: bytes, start: int, element: Element, order: str) -> tuple[PlyTable, int]:
    """Rows whose lists differ in length, one after the other; also the byte after the last."""
    heads = [
        (struct.Struct(order + np.dtype(p.count or p.type).char.replace("l", "q").replace("L", "Q")), p)
        for p in element.properties
    ]
    steps = [(head, bool(p.count), np.dtype(p.type).itemsize, p.wanted) for head, p in heads]
    wanted = sum(p.wanted for p in element.properties)
    check_memory(other=32 * element.count * wanted)
    arrays = [(array("q"), array("d")) for _ in steps]
    for row in range(element.count):
        for (head, is_list, size, keep), (places, values) in zip(steps, arrays, strict=True):
            if start + head.size > len(data):
                raise short_by(f"{element.name} rows", element.count, row)
            (value,) = head.unpack_from(data, start)
            start += head.size
            if keep:
                places.append(start)
                values.append(value)
            start += max(value, 0) * size if is_list else 0
    if start > len(data):
        raise short_by(f"{element.name} rows", element.count, element.count - 1)
    columns: dict[int | None, Numbers] = {}
    lists: dict[int | None, tuple[Numbers, Ints, Ints]] = {}
    for i, p in enumerate(element.properties):
        if not p.wanted:
            continue
        where, value_of_row = (np.frombuffer(flat, flat.typecode) for flat in arrays[i])
        if not p.count:
            columns[i] = value_of_row
            continue
        kind, length = np.dtype(order + p.type), np.maximum(value_of_row, 0).astype(np.int64)
        check_memory(other=(24 + kind.itemsize * 8) * int(length.sum()))
        first = np.cumsum(length) - length
        byte = np.repeat(where - first * kind.itemsize, length) + np.arange(length.sum()) * kind.itemsize
        octets = np.frombuffer(data, np.uint8)[byte[:, None] + np.arange(kind.itemsize)]
        lists[i] = np.ascontiguousarray(octets).reshape(-1).view(kind), first, length
    return PlyTable(columns, lists), start


def read_ascii(text: bytes, elements: list[Element]) -> dict[str, PlyTable]:
    """Values as a stream of numbers, whatever the lines."""
    for element in elements:
        check_count(f"{element.name} rows", element.count, 2 * len(element.properties), len(text) + 1)
        check_memory(points=element.count if element.name == "vertex" else 0, other=6 * len(text))
    try:
        numbers = parse_numbers(text)
    except ValueError:
        raise InputError("something after the PLY header is no number: numbers and nothing else would be right") from None
    tables, start = {}, 0
    for element in elements:
        tables[element.name], start = _ascii_table(numbers, start, element)
    if start < len(numbers):
        raise _left_over(len(numbers) - start, "numbers")
    return tables


def _ascii_table(numbers: Floats, start: int, element: Element) -> tuple[PlyTable, int]:
    """One element from number `start` on, and the number after its last."""
    heads, width = _first_row(numbers, start, element)
    stop = start + element.count * width
    regular = stop <= len(numbers)
    if regular:
        rows = numbers[start:stop].reshape(element.count, width)
        regular = all((rows[:, h] == rows[:1, h]).all() for h, p in zip(heads, element.properties, strict=True) if p.count)
    where: Ints
    if regular:
        where = (start + np.arange(element.count) * width)[:, None] + np.array(heads, np.int64)
    elif any(p.count for p in element.properties):
        where, stop = _walk_ascii(numbers, start, element)
    else:
        raise short_by(f"{element.name} rows", element.count, (len(numbers) - start) // width)
    columns: dict[int | None, Numbers] = {}
    lists: dict[int | None, tuple[Numbers, Ints, Ints]] = {}
    whole: Ints | None = None
    for i, p in enumerate(element.properties):
        if not p.wanted:
            continue
        if p.count:
            if whole is None:
                whole = np.where(np.abs(numbers) < 2.0**53, numbers, -1.0).astype(np.int64)
            lists[i] = whole, where[:, i] + 1, np.maximum(whole[where[:, i]], 0)
        else:
            columns[i] = numbers[where[:, i]]
    return PlyTable(columns, lists), stop


def _first_row(numbers: Floats, start: int, element: Element) -> tuple[list[int], int]:
    """Where in the first row each property begins, and how many numbers the row has."""
    heads, at = [], start
    for p in element.properties:
        heads.append(at - start)
        at += 1
        if p.count and at <= len(numbers) and 0.0 < numbers[at - 1] < len(numbers):
            at += int(numbers[at - 1])
    return heads, at - start


def _walk_ascii(numbers: Floats, start: int, element: Element) -> tuple[Ints, int]:
    check_memory(other=8 * element.count * len(element.properties) + 56 * len(numbers))
    where = np.empty((element.count, len(element.properties)), np.int64)
    whole = np.clip(np.nan_to_num(numbers), 0.0, len(numbers)).astype(np.int64).tolist()
    for row in range(element.count):
        for i, p in enumerate(element.properties):
            if start >= len(whole):
                raise short_by(f"{element.name} rows", element.count, row)
            where[row, i] = start
            start += 1 + (whole[start] if p.count else 0)
    if start > len(whole):
        raise short_by(f"{element.name} rows", element.count, element.count - 1)
    return where, start
