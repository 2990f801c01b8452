"""Archard's law of one mesh cycle, from the load's share and the specific sliding."""

from __future__ import annotations

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.wear_law.archard import LoadSharing, load_share, specific_sliding


def wear_per_cycle(
    gear: Gear,
    mate: Gear,
    centre_distance: float,
    roll: Floats,
    wear_coefficient: float,
    unit_load: float,
    sharing: LoadSharing = LoadSharing.NONE,
) -> Floats:
    """Depth lost per mesh cycle of `gear`: k w |K|, mm; k in mm²/N (1 m²/N is 1e6 mm²/N), w on all pairs per face width, N/mm."""
    share = load_share(gear, mate, centre_distance, roll, sharing)
    return wear_coefficient * unit_load * share * specific_sliding(gear, mate, centre_distance, roll)
