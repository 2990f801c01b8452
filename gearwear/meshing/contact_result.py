"""What two gears in rigid contact do: the result of `contact.mesh_contact`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.involute import roll_length
from gearwear.design.quantity import sentence
from gearwear.meshing.path import PathOfContact

CELLS = 24
"""Cells of the contact pattern from the base circle to the tip, where the positions are close enough."""


@dataclass(frozen=True, slots=True)
class ContactPattern:
    """Where on its flanks a gear was touched.

    Parameters
    ----------
    roll_edges : (n + 1,) float
        Edges of the cells in length of roll, mm; contact below the base circle counts in the first cell.
    z : (n_z,) float
        Heights of the slices on this gear, mm.
    count : (teeth, n_z, n) int
        In how many positions the point of least gap of a tooth and slice lay in the cell and was within tolerance.
    passes : (teeth,) int
        How often each tooth went through the mesh.
    per_pass : int
        Positions in which a perfect contact lies in one cell while its tooth goes through the mesh once.
    base_radius : float
        mm.
    """

    roll_edges: Floats
    z: Floats
    count: Ints
    passes: Ints
    per_pass: int
    base_radius: float

    @classmethod
    def empty(cls, gear: Gear, z: Floats, positions_per_pitch: int) -> ContactPattern:
        """No contact yet, in `CELLS` cells or as many as the step from position to position can resolve."""
        step = gear.base_pitch / positions_per_pitch
        longest = max(gear.tip_roll, gear.form_roll)
        per_pass = max(1, math.ceil(longest / CELLS / step))
        edges = np.asarray(per_pass * step * np.arange(math.ceil(longest / (per_pass * step)) + 1), dtype=np.float64)
        count = np.zeros((gear.teeth, len(z), len(edges) - 1), np.int64)
        return cls(edges, z, count, np.zeros(gear.teeth, np.int64), per_pass, gear.base_radius)

    def touched(self, tooth: Ints, height: Ints, radius: Floats) -> ContactPattern:
        """The same with more points: tooth (any whole number), number of the slice, radius in mm."""
        teeth, slices, cells = self.count.shape
        roll = roll_length(radius, self.base_radius)
        cell = np.clip(np.searchsorted(self.roll_edges, roll, side="right") - 1, 0, cells - 1)
        flat = (tooth % teeth * slices + height) * cells + cell
        return replace(self, count=self.count + np.bincount(flat, minlength=self.count.size).reshape(self.count.shape))

    def passed(self, tooth: Ints) -> ContactPattern:
        """The same, with the teeth (any whole numbers) that went through the mesh."""
        return replace(self, passes=self.passes + np.bincount(tooth % len(self.passes), minlength=len(self.passes)))

    @property
    def share(self) -> Floats:
        """(teeth, n_z, n): 1 where the cell is touched at every passing, 0 where never (or never in mesh)."""
        full = self.per_pass * np.maximum(self.passes, 1)
        return np.asarray(np.minimum(self.count / full[:, None, None], 1.0), dtype=np.float64)


class Extreme(NamedTuple):
    """A least or greatest value in mm, and the rotation of the driver in rad at which it occurs."""

    value: float
    rotation: float


@dataclass(frozen=True, slots=True)
class ContactVariant:
    """The same pair with slightly other flanks, to first order in the difference.

    Parameters
    ----------
    transmission_error, backlash : (n + k,) float
        As in `ContactResult`, in the n positions of the pair itself and then in the k of its extremes, mm.
    """

    transmission_error: Floats
    backlash: Floats

    @property
    def peak_to_peak_um(self) -> float:
        """Greatest less least transmission error of the positions, µm; compare it with that of `ContactResult.itself`."""
        return 1e3 * float(np.ptp(self.transmission_error))


@dataclass(frozen=True, slots=True, repr=False)
class ContactResult(Card):
    """What a pair of gears does when it runs, in n positions of the driver.

    Lengths in mm along the transverse line of action (on spur gears the normal to the flanks), angles in rad, teeth counted from 0.
    Parameters with m columns have one for each tooth of the driver near the mesh.

    Parameters
    ----------
    rotation : (n,) float
        Of the driver, in the sense of drive, from the position in which its tooth 0 is on the line of centres.
    transmission_error : (n,) float
        r_b2 (φ2 − φ1 z1/z2) less its value for the nominal involutes; − is lag (missing material).
    backlash : (n,) float
        Normal backlash j_bn (on helical gears cos β_b times the play on the transverse line of action) with the housing fixed; negative where both flanks together leave no room.
    transmission_error_min, transmission_error_max, backlash_min, backlash_max : Extreme
        Searched for between the positions: they are cusps, which samples miss.
    driver_tooth, driven_tooth : (n,) int
        The pair that carries.
    z, driver_radius, driven_radius : (n,) float
        Where it carries: height on the driver, and radius on either gear.
    pair_driver_tooth, pair_driven_tooth : (n, m) int
        Pairs near the mesh.
    pair_gap : (n, m) float
        Distance of each from contact, 0 for the pair that carries, inf out of reach.
    contact_ratio : tuple of (float, float)
        (tolerance in mm, effective contact ratio): mean angle over which a pair is within the tolerance of
        contact, in pitches.
    driver_pattern, driven_pattern : ContactPattern
        At the largest of the tolerances.
    driver, driven : Gear
        The designs.
    peak_rotation, peak_transmission_error, peak_backlash : (k,) float
        Rotation of the driver at the extremes, rising, and both there.
    variants : tuple of ContactVariant
        Those asked for.
    doubt : str
        That the teeth overlap somewhere, where no rigid gears turn, and the centre distance that would be right, a clause; "" where they have room.
    """

    rotation: Floats
    transmission_error: Floats
    transmission_error_min: Extreme
    transmission_error_max: Extreme
    backlash: Floats
    backlash_min: Extreme
    backlash_max: Extreme
    driver_tooth: Ints
    driven_tooth: Ints
    z: Floats
    driver_radius: Floats
    driven_radius: Floats
    pair_driver_tooth: Ints
    pair_driven_tooth: Ints
    pair_gap: Floats
    contact_ratio: tuple[tuple[float, float], ...]
    driver_pattern: ContactPattern
    driven_pattern: ContactPattern
    driver: Gear
    driven: Gear
    peak_rotation: Floats
    peak_transmission_error: Floats
    peak_backlash: Floats
    variants: tuple[ContactVariant, ...] = ()
    doubt: str = ""

    def headline(self) -> str:
        return f"{self.driver.teeth} : {self.driven.teeth} teeth, transmission error {self.peak_to_peak_um:.2f} µm peak to peak"

    def rows(self) -> list[CardRow]:
        low, high = self.backlash_min, self.backlash_max
        ratios = ", ".join(f"{ratio:.3f} within {1e3 * tolerance:g} µm" for tolerance, ratio in self.contact_ratio)
        lag = self.transmission_error_min
        return [
            ("normal backlash", f"{low.value:z.4f} … {high.value:z.4f} mm, greatest at {math.degrees(high.rotation):.1f}°"),
            ("greatest lag", f"{-1e3 * lag.value:z.2f} µm on the line of action, at {math.degrees(lag.rotation):.1f}°"),
            ("contact ratio", ratios),
            ("positions", f"{len(self.rotation):,} of the driver"),
            *([("doubt", sentence(self.doubt))] if self.doubt else []),
        ]

    @property
    def transmission_error_um(self) -> Floats:
        """Transmission error in µm along the transverse line of action, (n,)."""
        return 1e3 * self.transmission_error

    @property
    def peak_to_peak_um(self) -> float:
        """Greatest less least transmission error over the whole cycle, µm."""
        return 1e3 * (self.transmission_error_max.value - self.transmission_error_min.value)

    @property
    def itself(self) -> ContactVariant:
        """The pair as it is, in the positions of its variants."""
        return ContactVariant(
            np.concatenate([self.transmission_error, self.peak_transmission_error]),
            np.concatenate([self.backlash, self.peak_backlash]),
        )

    @property
    def curves(self) -> tuple[Floats, Floats, Floats]:
        """Rotation (rad, rising), transmission error and backlash (mm) in all positions and at the extremes between them, for a picture."""
        rotation = np.concatenate([self.rotation, self.peak_rotation])
        order = np.argsort(rotation, kind="stable")
        return rotation[order], self.itself.transmission_error[order], self.itself.backlash[order]

    def contact_ratio_on(self, path: PathOfContact) -> float:
        """Contact ratio of the flanks as they are: mean number of pairs within the first tolerance of contact, at most the design's.

        Beyond the ends of the path even perfect flanks part slowly: a tolerance of 1 µm alone counts 1.31 pairs where the path is
        1.254 pitches long.
        """
        return min(path.total_contact_ratio, self.contact_ratio[0][1])

    @property
    def angular_backlash_driver(self) -> Floats:
        """Play of the driver with the driven gear held, rad, (n,): j_bn / (r_b1 cos β_b)."""
        return self.backlash / self.driver.normal_lever
