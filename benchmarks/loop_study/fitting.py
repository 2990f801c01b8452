"""One scan through the same functions as `gearwear compare`, from points to wear."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

from gearwear.api import as_scan
from gearwear.arrays import Floats
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import MeasuredGear, register
from gearwear.comparison.open_volume import OpenVolume
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec, PairSpec
from gearwear.diagnose.loop import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.views import PlacedScan
from gearwear.wear.regions import Wear, find_wear
from tests.synthetic import GearNumbers


@dataclass(frozen=True, slots=True)
class Fitted:
    """What the package made of a scan.

    Parameters
    ----------
    placed : PlacedScan
        Registration and located points; in the order of the scan.
    first : Cells
        The scan binned, before the loop.
    loop : Loop
        Effects, errors, unexplained patterns.
    wear, wear_before : Wear
        After the loop; what it would have been without.
    limits : (float, float)
        Between what the report says the worn volume lies (95 %), mm³: of `wear` by itself, and with what is left open of it.
    worn_sides : frozenset of Side
        Side found worn throughout, +1 left, −1 right; 0 for none.
    registration_seconds, loop_seconds : float
        Wall time.
    """

    placed: PlacedScan
    first: Cells
    loop: Loop
    wear: Wear
    wear_before: Wear
    limits: tuple[float, float]
    worn_sides: frozenset[Side]
    registration_seconds: float
    loop_seconds: float


def designed(numbers: GearNumbers) -> Gear:
    """The drawing the fit is given."""
    n = numbers
    angle = math.radians(n.pressure_angle_deg)
    return Gear.from_spec(
        GearSpec(
            "gear", n.teeth, n.module, n.face_width, angle, n.profile_shift, n.addendum, n.dedendum, n.rack_tip_radius, n.thinning,
            n.bore_diameter,
        )
    )  # fmt: skip


def fit(points: Floats, gear: Gear, mate: bool) -> Fitted:
    """Register, bin, close the loop, find the wear.

    Parameters
    ----------
    points : (n, 3) float
        The scan, mm. Nothing else is known of it.
    gear : Gear
        The drawing.
    mate : bool
        Whether the design has a mate of twice the teeth.

    Raises
    ------
    InputError
        If registration refuses the scan.
    """
    begun = time.perf_counter()
    first = registered(points, gear, mate)
    between = time.perf_counter()
    measured = find_effects(first)
    loop_seconds = time.perf_counter() - between
    wear = find_wear(measured.as_made, first.noise, measured.worn_sides, measured.loop)
    before = find_wear(measured.first, first.noise, measured.worn_sides)
    assert measured.loop is not None
    others = [find_wear(other.as_made, first.noise, other.worn_sides, other.loop, limits=False) for other in measured.undecided]
    known = OpenVolume(measured, wear, tuple((other.volume, other.volume_std) for other in others)).limits
    low, high = known[:2] if known is not None else (wear.volume, wear.volume)
    limits = min(low, wear.volume - NORMAL_95 * wear.volume_std), max(high, wear.volume + NORMAL_95 * wear.volume_std)
    return Fitted(
        measured.placed, measured.first, measured.loop, wear, before, limits, measured.worn_sides, between - begun, loop_seconds
    )


def registered(points: Floats, gear: Gear, mate: bool = False) -> MeasuredGear:
    """A scan on its drawing, binned, before the loop; arguments as those of `fit`."""
    return register(_drawn(gear, mate), as_scan(points), "pinion")


def _drawn(gear: Gear, mate: bool) -> Design:
    """The gear alone, or with a mate of twice its teeth at the centre distance of the reference circles."""
    gears = {"pinion": gear}
    if not mate:
        return Design(gears)
    gears["gear"] = Gear.from_spec(replace(gear.spec, name="gear", teeth=2 * gear.spec.teeth, bore_diameter=0.0))
    return Design(gears, PairSpec(3.0 * gear.reference_radius))
