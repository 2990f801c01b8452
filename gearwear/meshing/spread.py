"""How far what two measured gears do in contact is known: the same contact with flanks as they may as well be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.meshing.contact_result import ContactResult, ContactVariant


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


def contact_spread(contact: ContactResult, variants: Sequence[ContactVariant], level: float) -> ContactSpread:
    """What the scatter of the flanks makes uncertain.

    Parameters
    ----------
    contact : ContactResult
        Of the flanks as they are estimated.
    variants : sequence of ContactVariant
        Of flanks drawn from what they may be.
    level : float
        Standard deviation of how far the drive and the coast flanks may be off together, mm: they move the backlash and not its changes.

    Returns
    -------
    ContactSpread

    Notes
    -----
    Contact is where two gears stand out most. What scatters stands out more than its mean, so variants do not only scatter about the
    estimate, they lie to one side of it; that shift is taken as uncertain as well.
    """
    numbers = np.array([_numbers(one) for one in variants]).reshape(-1, 4)
    if not len(numbers):
        return ContactSpread(0.0, level, level, level)
    off = np.hypot(numbers.std(axis=0, ddof=min(1, len(numbers) - 1)), numbers.mean(axis=0) - _numbers(contact.itself))
    te, *backlash = (float(one) for one in off)
    greatest, least, mean = (math.hypot(one, level) for one in backlash)
    return ContactSpread(te, greatest, least, mean)


def _numbers(one: ContactVariant) -> list[float]:
    backlash = one.backlash
    return [float(np.ptp(one.transmission_error)), float(backlash.max()), float(backlash.min()), float(backlash.mean())]
