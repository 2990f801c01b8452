"""The wear law on traces of a gear measuring machine: for those who have no scanner."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
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
PLACES = 60
"""Along the flank."""
ALIKE = 1e-9
"""mm within which two flanks are one: flanks that were not measured are the mean of their side."""


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
        The flanks that carry.

    Returns
    -------
    WearStudy
        Without a fit where it was not possible; `why_not` says so.

    Notes
    -----
    Depths are means over the heights, at the foot L = √(r² − r_b²) + depth. Their level is left free, by a shared error of `LEVEL_STD`: a
    uniform loss cannot be told from the zero of the machine, the sliding part can, as it vanishes at the pitch point. Their other errors are
    the scatter between measured teeth, divided by the root of their number.
    """
    gear = profiles.gear
    low = gear.form_roll + FORM_MARGIN_MODULES * gear.transverse_module
    high = gear.tip_roll - TIP_MARGIN_MODULES * gear.transverse_module
    lost = np.nanmean(profiles.loss[:, side.index], axis=1)
    reach = np.sqrt(np.maximum((profiles.radius - gear.base_radius) * (profiles.radius + gear.base_radius), 0.0))
    roll = np.linspace(low, high, PLACES)
    flanks = _distinct(np.array([np.interp(roll, reach + one, one) for one in lost]))
    teeth = tuple(range(len(flanks)))
    spread = flanks - flanks.mean(axis=1, keepdims=True)
    pooled = float(spread.std(axis=0, ddof=1).mean()) if len(flanks) >= FEWEST else LEAST_STD
    own = max(pooled / np.sqrt(len(flanks)), LEAST_STD)
    errors = own**2 * np.eye(PLACES) + LEVEL_STD**2
    try:
        fits = fit_wear_law(gear, mate, centre_distance, roll, flanks.mean(axis=0), errors)
    except InputError as error:
        return WearStudy(side=side, teeth=teeth, left_out=(), fits=(), why_not=str(error))
    return WearStudy(side=side, teeth=teeth, left_out=(), fits=fits, why_not="")


def _distinct(flanks: Floats) -> Floats:
    """The flanks that were measured: those that were not are given the mean of their side, one like the other but for the level."""
    form = flanks - flanks.mean(axis=1, keepdims=True)
    apart = np.abs(form[:, None] - form[None]).max(axis=2)
    alone = (apart < ALIKE).sum(axis=1) == 1
    kept: Floats = flanks[alone] if alone.any() else flanks[:1]
    return kept
