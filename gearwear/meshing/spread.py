"""How far what two measured gears do in contact is known: the same contact with flanks as they may as well be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.meshing.contact_result import ContactVariant


@dataclass(frozen=True, slots=True)
class ContactSpread:
    """Standard deviations of a contact's numbers.

    Parameters
    ----------
    transmission_error : float
        Of its peak to peak, mm on the line of action.
    backlash_greatest, backlash_least, backlash_mean : float
        Normal, mm.
    """

    transmission_error: float
    backlash_greatest: float
    backlash_least: float
    backlash_mean: float


def contact_spread(drawn: Sequence[ContactVariant], again: Sequence[ContactVariant], level: float) -> ContactSpread:
    """What the scatter of the flanks makes uncertain.

    Parameters
    ----------
    drawn : sequence of ContactVariant
        Of flanks drawn from what they may be.
    again : sequence of ContactVariant
        Of each of these with as much scatter once more.
    level : float
        Standard deviation of how far the drive and the coast flanks may be off together, mm: they move the backlash and not its changes.

    Returns
    -------
    ContactSpread

    Notes
    -----
    Contact is where two gears stand out most. What scatters stands out more than its mean, so numbers of flanks that scatter do not only scatter,
    they are off to one side. By how much depends on whether two places of the estimate happen to stand out alike; a coarser scan can so look
    the better known one. So it is not asked what scatter does to the estimate, but what it does, root mean square, to flanks that may as
    well be: as the estimate came from the true ones.
    """
    before, after = (np.array([_numbers(variant) for variant in variants]).reshape(-1, 4) for variants in (drawn, again))
    if not len(before):
        return ContactSpread(0.0, level, level, level)
    te, *backlash = (float(difference) for difference in np.sqrt(((after - before) ** 2).mean(axis=0)))
    greatest, least, mean = (math.hypot(part, level) for part in backlash)
    return ContactSpread(te, greatest, least, mean)


def _numbers(variant: ContactVariant) -> list[float]:
    backlash = variant.backlash
    return [float(np.ptp(variant.transmission_error)), float(backlash.max()), float(backlash.min()), float(backlash.mean())]
