"""What a scan is once it has been read, whatever file it came from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from gearwear.arrays import Floats, Ints
from gearwear.design.card import Card, CardRow
from gearwear.scan.pieces import Chunks

ScanKind = Literal["cloud", "triangles", "section"]
"""Loose points, a triangulated surface, or one planar section."""


@dataclass(frozen=True, slots=True, repr=False)
class Scan(Card):
    """Cleaned points of one scan, in its own axes.

    Parameters
    ----------
    points : (n, 3) float
        mm. The vertices of a triangulated surface; a section has z = 0.
    normals : (n, 3) float or None
        Unit normals as the file gives them, else of the triangles (mean weighted by area); they point
        to the side that the file calls outside. A row of zeros where there is none; None if there is none at all.
    triangles : (m, 3) int or None
        Indices into `points`; None for loose points.
    kind : "cloud", "triangles" or "section"
        What the points are.
    files : tuple of str
        Where they come from.
    rejected : dict of str to int
        Points taken out, by reason: "non_finite" (or beyond 1e9 mm), "duplicate" (exact), "outlier"
        (alone in space), "unreferenced" (in no triangle), "invalid" (marked so in the file).
    view : (n,) int8
        0-based view each point belongs to.
    units : str
        Unit the file was read in.
    sha256 : tuple of str
        Of each of `files`, in hexadecimal digits; empty for points that came from none.
    chunks : Chunks or None
        Of a streamed scan all its points; `points` is a sample of them then. None: `points` are all.
    """

    points: Floats
    normals: Floats | None
    triangles: Ints | None
    kind: ScanKind
    files: tuple[str, ...]
    rejected: dict[str, int]
    view: Ints
    units: str = "mm"
    sha256: tuple[str, ...] = ()
    chunks: Chunks | None = None

    def __len__(self) -> int:
        return len(self.points) if self.chunks is None else len(self.chunks)

    @property
    def planar(self) -> bool:
        """Whether it is a planar section."""
        return self.kind == "section"

    @property
    def read(self) -> int:
        """Points read: those that are there and those taken out."""
        return len(self) + sum(self.rejected.values())

    def headline(self) -> str:
        what = {"cloud": "points", "triangles": "vertices of triangles", "section": "points of a planar section"}[self.kind]
        return f"{len(self):,} {what} from {', '.join(Path(file).name for file in self.files)}"

    def rows(self) -> list[CardRow]:
        return [(f"left out: {reason}", f"{count:,}") for reason, count in self.rejected.items() if count]
