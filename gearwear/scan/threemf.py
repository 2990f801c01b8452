"""Triangles from 3MF (3MF Consortium, core specification 1.3): a ZIP archive with models in XML.

Objects hold triangles or place other objects that stand before them; the build places objects. Of extensions only the
production extension's references to models in other parts of the archive are followed.
"""

from __future__ import annotations

import zipfile
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from xml.parsers import expat

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import MOST_UNPACKED
from gearwear.scan.placed import Surface, assemble, check_placed

UNITS = {"micron": "um", "millimeter": "mm", "centimeter": "cm", "meter": "m", "inch": "in", "foot": "ft"}
Key = tuple[str, str]
"""An object: the part of the archive that holds it, and its number there."""


def read_3mf(data: bytes) -> Contents:
    """Read all that a 3MF builds, in the unit that it states.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    Contents

    Raises
    ------
    InputError
        If it is no 3MF, unpacks to an absurd size, or places an object that is not there.
    """
    if not zipfile.is_zipfile(BytesIO(data)):
        raise InputError("is not a 3MF (a zip archive), or is cut off: a complete 3MF file would be right")
    with zipfile.ZipFile(BytesIO(data)) as archive:
        unpacked = sum(entry.file_size for entry in archive.infolist())
        if unpacked > MOST_UNPACKED * len(data):
            raise InputError(
                f"the 3MF archive would unpack to {unpacked:,} bytes: no scan is as repetitive; a real 3MF file would be right"
            )
        check_memory(other=2 * unpacked)
        if archive.testzip() is not None:
            raise InputError("the 3MF archive is damaged (a checksum is wrong): a complete file would be right")
        parts = sorted(name for name in archive.namelist() if name.lower().endswith(".model"))
        if not parts:
            raise InputError("the 3MF archive holds no model: a complete 3MF file would be right")
        root = min(parts, key=lambda name: (name.lower() != "3d/3dmodel.model", len(name)))
        reader = _Reader()
        for part in [*(name for name in parts if name != root), root]:
            reader.read(part, archive.read(part))
    return assemble(reader.built(), UNITS.get(reader.unit))


@dataclass(slots=True)
class _Object:
    """Triangles, and other objects with their places; `placings` counts all that it places, itself included."""

    points: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    parts: list[tuple[Key, Floats]] = field(default_factory=list)
    placings: int = 1
    surface: Surface | None = None


class _Reader:
    """Reads models one after the other, the root last."""

    def __init__(self) -> None:
        self.objects: dict[Key, _Object] = {}
        self.build: list[tuple[Key, Floats]] = []
        self.unit = "millimeter"
        self._part = ""
        self._open: tuple[Key, _Object] | None = None

    def read(self, part: str, text: bytes) -> None:
        """Take in one model."""
        self._part, self._open, self.build, self.unit = part, None, [], "millimeter"
        parser = expat.ParserCreate()
        parser.StartElementHandler, parser.EndElementHandler = self._start, self._end
        parser.StartDoctypeDeclHandler = _no_doctype
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
            raise InputError(f"{part} in the 3MF archive is not XML: {error}") from None

    def _start(self, tag: str, has: dict[str, str]) -> None:
        name = tag.rpartition(":")[2]
        if name == "vertex" and self._open is not None:
            self._open[1].points.extend((float(has["x"]), float(has["y"]), float(has["z"])))
        elif name == "triangle" and self._open is not None:
            self._open[1].corners.extend((int(has["v1"]), int(has["v2"]), int(has["v3"])))
        elif name == "object":
            self._open = (self._part, has["id"]), _Object()
        elif name == "component" and self._open is not None:
            self._place(self._open[1].parts, has)
        elif name == "item":
            self._place(self.build, has)
        elif name == "model":
            self.unit = has.get("unit", self.unit)

    def _end(self, tag: str) -> None:
        if tag.rpartition(":")[2] != "object" or self._open is None:
            return
        (key, item), self._open = self._open, None
        item.placings += sum(self.objects[part].placings for part, _ in item.parts)
        points, corners = item.points, item.corners
        item.surface = Surface(len(points) // 3, len(corners) // 3, lambda: (np.array(points).reshape(-1, 3), _whole(corners)))
        self.objects[key] = item

    def _place(self, into: list[tuple[Key, Floats]], has: dict[str, str]) -> None:
        path = next((value for name, value in has.items() if name.rpartition(":")[2] == "path"), self._part)
        key = (path.lstrip("/"), has["objectid"])
        if key not in self.objects:
            raise InputError(
                f"the 3MF places object {key[1][:20]} and none stands before it: a model whose objects are there would be right"
            )
        into.append((key, _matrix(has.get("transform"))))

    def built(self) -> Iterator[tuple[Surface, Floats]]:
        """Every surface that the build places, with where."""
        check_placed(sum(self.objects[key].placings for key, _ in self.build))
        stack = self.build[::-1]
        while stack:
            key, place = stack.pop()
            item = self.objects[key]
            if item.surface is not None and item.surface.points:
                yield item.surface, place
            stack += [(part, place @ inner) for part, inner in item.parts]


def _no_doctype(*_: object) -> None:
    raise InputError("a model in the 3MF archive has a document type, which 3MF forbids: one without would be right")


def _whole(corners: array[int]) -> Ints:
    return np.array(corners, np.int64).reshape(-1, 3)


def _matrix(text: str | None) -> Floats:
    """A transformation, (4, 4) for columns: 3MF writes it for rows, three numbers each, the shift last."""
    place = np.eye(4)
    if text is not None:
        rows = np.array([float(word) for word in text.split()]).reshape(4, 3)
        place[:3, :] = rows.T
    return place
