"""Scans as the design's ``[datum]`` asks for them: at 20 °C, without what is to be left out, and numbered from tooth 1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.scan_spec import DatumSpec
from gearwear.design.surface import SURFACE_NAMES, locate
from gearwear.errors import InputError
from gearwear.placing.mark import SeenMark, number_by_mark
from gearwear.placing.pose import Pose, tooth_at
from gearwear.placing.views import PlacedScan
from gearwear.scan.types import Scan

WHOLE = ("end_low", "end_high", "bore", "other")
"""Surfaces that belong to no tooth."""

LEAST_TEETH = 3
"""That must be left."""


def at_20_degrees(scans: tuple[Scan, ...], datum: DatumSpec) -> tuple[Scan, ...]:
    """The scans with their lengths referred to 20 °C; as they are where no temperature is stated.

    A part of one material that is warm throughout is larger by one factor: ``l(20 °C) = l / (1 + α (T − 20 °C))``.
    """
    if datum.scale == 1.0:
        return scans
    chunks = [None if scan.chunks is None else scan.chunks.scaled(datum.scale) for scan in scans]
    return tuple(replace(scan, points=datum.scale * scan.points, chunks=part) for scan, part in zip(scans, chunks, strict=True))


def check_streamed(scans: Sequence[Scan], datum: DatumSpec) -> None:
    """Refuse what is not offered for a streamed scan."""
    if scans[0].chunks is None:
        return
    asked = ["artefact"] * bool(datum.artefacts) + ["ignore, ignore_teeth and ignore_z_mm"] * datum.leaves_out
    if asked:
        raise InputError(
            f"{scans[0].files[0]}: [datum] {asked[0]} is not offered for a streamed scan: leaving it out, or a scan of fewer points, would be right"
        )


def tooth_1_of(datum: DatumSpec, scans: Sequence[Scan], placed: PlacedScan, gear: Gear) -> tuple[Pose | None, SeenMark | None]:
    """The motion that makes the stated tooth tooth 1, and the mark that told it; None where nothing is stated.

    Raises
    ------
    InputError
        If a stated mark is not seen, or tells no tooth.
    """
    if datum.tooth_1 is not None:
        return tooth_at(placed.registration.pose, gear, datum.tooth_1), None
    if datum.mark is None:
        return None, None
    try:
        return number_by_mark(placed.measured, gear, datum.mark, scans[0].planar)
    except InputError as error:
        raise InputError(": ".join([*scans[0].files[:1], str(error)])) from None


def without_ignored(scans: Sequence[Scan], placed: PlacedScan, gear: Gear, datum: DatumSpec) -> tuple[Scan, ...]:
    """The scans without the points on surfaces, teeth and heights that are to be left out.

    Parameters
    ----------
    scans : sequence of Scan
        Views of one gear.
    placed : PlacedScan
        How they lie on the design.
    gear : Gear
        The design.
    datum : DatumSpec
        What is left out.

    Raises
    ------
    InputError
        If a tooth is named that the gear does not have, or next to nothing is left.
    """
    beyond = [tooth + 1 for tooth in datum.ignore_teeth if tooth >= gear.teeth]
    if beyond:
        raise InputError(f"[datum] ignore_teeth = {beyond[0]}: teeth from 1 to {gear.teeth} would be right")
    if gear.teeth - len(set(datum.ignore_teeth)) < LEAST_TEETH:
        raise InputError(f"[datum] ignore_teeth leaves less than {LEAST_TEETH} teeth")
    onto = [view.apply for view in placed.views] or [placed.registration.pose.apply]
    left = tuple(kept(scan, ~_ignored(apply(scan.points), gear, datum)) for scan, apply in zip(scans, onto, strict=True))
    if min(len(scan) for scan in left) < 0.05 * min(len(scan) for scan in scans):
        raise InputError(
            "[datum] ignore, ignore_teeth and ignore_z_mm leave less than a twentieth of a scan: too little to measure"
        )
    return left


def _ignored(points: Floats, gear: Gear, datum: DatumSpec) -> Bools:
    located = locate(points, gear)
    names = np.array(SURFACE_NAMES)[located.surface]
    mask: Bools = np.isin(names, datum.ignore) | (np.isin(located.tooth, datum.ignore_teeth) & ~np.isin(names, WHOLE))
    for low, high in datum.ignore_z:
        mask |= (points[:, 2] >= low) & (points[:, 2] <= high)
    return mask


def kept(scan: Scan, keep: Bools, reason: str = "ignored") -> Scan:
    """The points marked in `keep` (n,), and the triangles that have all their corners; the others are counted under a reason."""
    triangles = scan.triangles
    if triangles is not None:
        number = np.cumsum(keep) - 1
        triangles = number[triangles[keep[triangles].all(axis=1)]]
    return replace(
        scan, points=scan.points[keep], normals=None if scan.normals is None else scan.normals[keep], triangles=triangles,
        view=scan.view[keep], rejected=scan.rejected | {reason: int((~keep).sum())},
    )  # fmt: skip
