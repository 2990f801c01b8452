"""What a file holds, as its reader hands it on."""

from __future__ import annotations

from dataclasses import dataclass, field

from gearwear.arrays import Floats, Ints


@dataclass(frozen=True, slots=True)
class Contents:
    """What a reader found in a file, nothing cleaned, in the file's own unit.

    Parameters
    ----------
    points : (n, 3) float
        As stored.
    normals : (n, 3) float or None
        As stored.
    triangles : (m, 3) int or None
        Indices into `points`, all of them valid.
    rejected : dict of str to int
        Points the file itself marks as no good, left out here.
    units : str or None
        The unit, where the format states one.
    """

    points: Floats
    normals: Floats | None = None
    triangles: Ints | None = None
    rejected: dict[str, int] = field(default_factory=dict)
    units: str | None = None
