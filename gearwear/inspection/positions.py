"""Where the flanks stand at any circle: what pitch, runout, thickness, span and pins are read from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.dimensions import Span, plate_bands
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.evaluation import CommonForm, Evaluation
from gearwear.inspection.pitch import WINDOW_SHARE, flank_positions, line_positions
from gearwear.inspection.prepared import PreparedScan
from gearwear.inspection.ranges import profile_ends
from gearwear.inspection.registered import motion_errors
from gearwear.inspection.traces import Traces


@dataclass(frozen=True, slots=True)
class FlankPositions:
    """Deviations of all flanks at one circle, from their traces over the pitch band.

    Parameters
    ----------
    scan : PreparedScan
    traces : Traces
        Profiles over the pitch band.
    profile : Evaluation
        Its mean lines stand in where a thin scan hardly saw a circle.
    common : CommonForm or None
        Form common to a side's flanks; None of a dense scan.
    shared : (teeth, 2, n, m) float or None
        Errors of the traces' bins that the registration adds, each of its m causes by itself, mm; None where the pose is taken as known.
    own : (teeth, 2, n) float or None
        What levelling a thin scan adds to them, a flank's together, mm; None of a dense scan.
    """

    scan: PreparedScan
    traces: Traces
    profile: Evaluation
    common: CommonForm | None
    shared: Floats | None
    own: Floats | None

    @classmethod
    def of(cls, scan: PreparedScan, traces: Traces, profile: Evaluation, common: CommonForm | None) -> FlankPositions:
        """With the errors of the traces."""
        return cls(scan, traces, profile, common, scan.shared_errors(traces), scan.own_errors(traces))

    @property
    def window(self) -> float:
        """Reach of the mean at a circle along the profile, mm."""
        form_place, tip_place = profile_ends(self.scan.gear)
        return WINDOW_SHARE * (tip_place - form_place)

    def at(self, place: float) -> tuple[Estimate, int]:
        """At a place along the profile, (teeth, 2) mm, and of how many flanks by their mean lines, carried on."""
        read = flank_positions(self.traces, place, self.window, self.shared, self.own, self.common)
        if self.scan.form is None or seen_flanks(read) == read.value.size:
            return read, 0
        moved = read.shared if self.shared is None else self._moved(place)
        lines = line_positions(self.profile, place, self.common, moved)
        carried = np.isnan(read.value) & np.isfinite(lines.value)
        return read.where(~carried, lines), int(carried.sum())

    def at_plates(self, gauge: Span) -> Estimate:
        """Where the plates of a span touch: on helical teeth, left and right flanks at heights of their own."""
        if gauge.rise == 0.0 or self.scan.samples.is_section:
            return self.at(gauge.roll)[0]
        sides = {}
        for side, band in plate_bands(self.scan.gear, gauge, self.scan.face).items():
            traces = self.scan.profiles(band)
            shared, own_errors = self.scan.shared_errors(traces), self.scan.own_errors(traces)
            sides[side] = flank_positions(traces, gauge.roll, self.window, shared, own_errors, self.common)
        is_left = np.broadcast_to(np.arange(2) == Side.LEFT.index, (self.scan.gear.teeth, 2))
        return sides[Side.LEFT].where(is_left, sides[Side.RIGHT])

    def _moved(self, place: float) -> Floats:
        """What the registration's uncertainty does to the flanks at a place, mid-face, (teeth, 2, m) mm."""
        gear, covariance = self.scan.gear, self.scan.settings.pose_covariance
        assert covariance is not None
        middle = np.full((gear.teeth, 2), 0.5 * (self.scan.face[0] + self.scan.face[1]))
        return motion_errors(gear, np.full_like(middle, place), middle, covariance)


def seen_flanks(positions: Estimate) -> int:
    """Flanks with a position."""
    return int(np.isfinite(positions.value).sum())
