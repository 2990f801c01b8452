"""What the 3-D view and its still picture colour the gear by: wear, deviation with the effects taken out, deviation as measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gearwear.arrays import Floats
from gearwear.report.figures.arrays import ReportArrays
from gearwear.report.figures.colours import ColourScale, colour_scale
from gearwear.report.figures.surfaces import SurfaceTriangles, gear_surfaces

Key = Literal["wear", "effects_out", "measured"]


@dataclass(frozen=True, slots=True)
class ColouredGear:
    """The worn gear's surfaces with one kind of values on them.

    Parameters
    ----------
    key : {"wear", "effects_out", "measured"}
        Values are deviations in µm, + too much; those of "wear" are −depth.
    label, title, words : str
        On its button, over its colour bar, and what is to be seen.
    scale : ColourScale
    pieces : sequence of SurfaceTriangles
    """

    key: Key
    label: str
    title: str
    words: str
    scale: ColourScale
    pieces: Sequence[SurfaceTriangles]

    @property
    def high(self) -> float:
        """Where the colour bar ends on the scale, of which it begins at −1: nothing is too much on a map of wear."""
        return 0.0 if self.key == "wear" else 1.0

    @property
    def ticks(self) -> list[tuple[float, str]]:
        """Places on the scale and their labels; a depth has no sign."""
        places = self.scale.fraction(np.array(self.scale.ticks_um)).tolist()
        both = list(zip(places, self.scale.tick_labels, strict=True))
        return [(at, text.lstrip("−")) for at, text in both if at <= 0.0] if self.key == "wear" else both


def coloured_gears(arrays: ReportArrays, measured: ColourScale, worn: bool) -> list[ColouredGear]:
    """What the gear can be coloured by, the first first: wear where there is any, deviation without the effects where there are any.

    Parameters
    ----------
    arrays : ReportArrays
    measured : ColourScale
        Of the deviation as measured.
    worn : bool
        Whether wear stands out.
    """
    views = []
    if worn:
        depth = arrays.wear_shown_um
        lost = depth[depth < 0.0]
        scale = colour_scale(lost if lost.size else None)
        words = (
            "Wear alone: missing metal that stands out of the scan's scatter, with the effects of scanner and maker taken out."
        )
        views.append(_coloured(arrays, "wear", "Wear", "wear depth, µm", words, scale, depth, bare=True))
    if arrays.effects_out_um is not None:
        words = "Deviation with the effects of scanner and maker taken out: blue is missing metal, red too much."
        scale = colour_scale(arrays.effects_out_um)
        out = replace(arrays, elsewhere=arrays.elsewhere_effects_out)
        views.append(_coloured(out, "effects_out", "Effects out", "deviation, µm", words, scale, arrays.effects_out_um))
    words = "Deviation from the design as measured: blue is missing metal, red too much."
    views.append(_coloured(arrays, "measured", "As measured", "deviation, µm", words, measured, arrays.deviation_um))
    return views


def _coloured(
    arrays: ReportArrays, key: Key, label: str, title: str, words: str, scale: ColourScale, values: Floats, bare: bool = False
) -> ColouredGear:
    """The gear with these values on its flanks; `bare`: nothing on its other surfaces."""
    given = replace(arrays, deviation_um=values, elsewhere=None if bare else arrays.elsewhere)
    pieces = gear_surfaces(given, worn=True)
    if bare:
        pieces = [piece if "flank" in piece.name else replace(piece, deviation_um=None) for piece in pieces]
    grey = f"Grey: ends{', fillets, tips and roots' if bare else ''}, or not seen."
    scale_words = scale.depth_words if key == "wear" else scale.words
    return ColouredGear(key, label, title, f"{words} {grey} {scale_words}", scale, pieces)
