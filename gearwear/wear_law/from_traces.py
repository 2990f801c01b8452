"""The wear law on traces of a gear measuring machine: for those who have no scanner."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.wear_law.fit import fit_wear_law
from gearwear.wear_law.study import FORM_MARGIN_MODULES, TIP_MARGIN_MODULES, WearStudy

LEVEL_STD = 0.05
"""mm; by how much the level of traces may be off: a machine sets them to a zero of its own."""
LEAST_STD = 2e-4
"""mm; what the mean of traces is taken to be unsure by at least: a machine's own repeatability."""
FEWEST = 3
"""Flanks from which their scatter is taken."""
FEW_NOTE = (
    f"it is from fewer than {FEWEST} flanks, whose scatter cannot be told: its errors are those of the machine's repeatability alone,"
    f" {1e3 * LEAST_STD:g} µm, and too small where flanks are unlike"
)
PLACES = 60
"""Along the flank."""


def study_traces(profiles: ToothProfiles, mate: Gear, centre_distance: float, side: Side) -> WearStudy:
    """Fit the wear law to the mean profile of measured traces.

    Parameters
    ----------
    profiles : ToothProfiles
        As `gearwear.design.files.traces.read_traces` gives them.
    mate : Gear
    centre_distance : float
        mm.
    side : Side
        The flanks of this gear that carry.

    Returns
    -------
    WearStudy
        Without a fit where it was not possible; `why_not` says so.

    Notes
    -----
    Depths are means over the heights, at the foot L = √(r² − r_b²) + ι cos β_b · depth (ι: −1 on a ring), of the flanks measured. Their level is left free, by a shared error of `LEVEL_STD`: a
    uniform loss cannot be told from the zero of the machine, the sliding part can, as it vanishes at the pitch point. Their other errors are
    the scatter between measured teeth, divided by the root of their number; and where teeth wear unlike, the coefficients scatter with them.
    """
    gear = profiles.gear
    orientation = gear.orientation
    measured = np.ones(gear.teeth, np.bool_) if profiles.measured is None else profiles.measured[:, side.index]
    teeth = tuple(int(tooth) for tooth in np.flatnonzero(measured))
    if not teeth:
        why = f"no profile of the {side} flanks was measured"
        return WearStudy(side=side, teeth=(), left_out=(), fits=(), why_not=why)
    near_form = gear.form_roll + orientation * FORM_MARGIN_MODULES * gear.transverse_module
    near_tip = gear.tip_roll - orientation * TIP_MARGIN_MODULES * gear.transverse_module
    lost = np.nanmean(profiles.loss[measured, side.index], axis=1)
    reach = gear.roll_length(profiles.radius)
    lowest, highest = sorted((near_form, near_tip))
    roll = np.linspace(lowest, highest, PLACES)
    carried = orientation * gear.base_helix_cosine
    flanks = np.array([np.interp(roll, reach + carried * depth, depth) for depth in lost])
    spread = flanks - flanks.mean(axis=1, keepdims=True)
    many = len(flanks) >= FEWEST
    pooled = math.sqrt(float(spread.var(axis=0, ddof=1).mean())) if many else LEAST_STD
    std = max(pooled / math.sqrt(len(flanks)), LEAST_STD)
    errors = std**2 * np.eye(PLACES) + LEVEL_STD**2
    try:
        fits = fit_wear_law(gear, mate, centre_distance, roll, flanks if many else flanks.mean(axis=0), errors)
    except InputError as error:
        return WearStudy(side=side, teeth=teeth, left_out=(), fits=(), why_not=str(error))
    return WearStudy(
        side=side,
        teeth=teeth,
        left_out=(),
        fits=tuple(replace(fit, level_free=True) for fit in fits),
        why_not="",
        note="" if len(teeth) >= FEWEST else FEW_NOTE,
        volume_share=math.nan,
    )
