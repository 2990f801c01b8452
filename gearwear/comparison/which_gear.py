"""Which gear of a design was scanned, and how the scan lies on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearwear.comparison.laying import laid_on, unstated_root
from gearwear.design.gear import Gear
from gearwear.design.pair import Design, check_design
from gearwear.design.quantity import shown
from gearwear.errors import InputError, NotThisGear
from gearwear.placing.refusal import check_gear
from gearwear.placing.views import PlacedScan
from gearwear.scan.types import Scan
from gearwear.scan.units import READ_WITH, check_size, extents, other_unit, outer_diameter


def check_part(design: Design, part: str | None) -> None:
    """Refuse a part that the design has not, and what is no design."""
    check_design(design)
    if part is not None and not (isinstance(part, str) and part in design.gears):
        raise InputError(
            f"part = {part if isinstance(part, str) else shown(part)}: the design has only {', '.join(design.gears)}"
        )


def by_size(design: Design, scans: Sequence[Scan]) -> list[str]:
    """The parts of a design, the one whose tip circle comes nearest to the scan's longest side first."""
    reach = max(float(extents(scan)[0]) for scan in scans)
    return sorted(design.gears, key=lambda name: abs(np.log(max(reach, 1e-300) / outer_diameter(design.gears[name]))))


def placed_as(design: Design, scans: Sequence[Scan], parts: Sequence[str]) -> tuple[str, Gear, PlacedScan]:
    """The first of these parts that the scans fit, its gear as wide as they are, and how they lie on it; else what kept them from the first."""
    refused = []
    for name in parts:
        gear = design.gears[name]
        try:
            for scan in scans:
                check_size(scan, gear)
            placed = laid_on(gear, scans, unstated_root(gear))
            width = check_gear(placed, gear)
            if width == gear.face_width:
                return name, gear, placed
            gear = Gear.from_spec(replace(gear.spec, face_width=width))
            return name, gear, laid_on(gear, scans, unstated_root(gear))
        except InputError as error:
            refused.append(error)
    files, reason = ", ".join(file for scan in scans for file in scan.files), str(refused[0])
    where = "" if reason.startswith(files) else f"{files}: "
    line = f"{where}{reason}" + (f"; nor does it fit the {parts[1]}" if len(parts) > 1 else "")
    line += "" if READ_WITH in reason else other_unit(scans[0], design.gears[parts[0]])
    if isinstance(refused[0], NotThisGear):  # with its points, so that the command can say what they look like
        raise NotThisGear(refused[0].points, refused[0].planar, line)
    raise InputError(line)
