"""The rigid advance of every slice of every pair, position by position: what the load then levels out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.involute import roll_length
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError
from gearwear.meshing.backlash import transverse_backlash
from gearwear.meshing.contact import check_contact
from gearwear.meshing.passes import Cycle, Passes, pitches
from gearwear.meshing.path import path_of_contact
from gearwear.meshing.slices import FaceParts

_PASSES_AT_A_TIME = 12
"""Pitches worked on at a time: what is known then fits in some tens of megabytes."""


@dataclass(frozen=True, slots=True)
class RigidAdvance:
    """By position p, pair m (a tooth of the driver near the line of centres) and slice s.

    Parameters
    ----------
    rotation : (p,) float
        Of the driver, rad.
    nominal : float
        Advance of the design, mm: zero of the transmission error.
    z, widths : (s,) float
        Middle, on the driver, and width of the slices, mm.
    half : (s,) int
        Half of a double helical gear that a slice belongs to.
    advance : (p, m, s) float
        mm on the transverse line of action; −inf where flanks are out of reach. Of double helical gears one floats along its axis, so that both
        halves are as far ahead.
    roll, mate_roll : (p, m, s) float
        Length of roll of the contact on driver and driven gear, mm; of the design where out of reach.
    tooth, mate : (p, m) int
        Teeth of driver and driven gear, 0-based.
    others : tuple of (p, m, s) float
        `advance` of flanks that differ little.
    """

    rotation: Floats
    nominal: float
    z: Floats
    widths: Floats
    half: Ints
    advance: Floats
    roll: Floats
    mate_roll: Floats
    tooth: Ints
    mate: Ints
    others: tuple[Floats, ...] = ()

    def nearest(self, reach: float) -> RigidAdvance:
        """The same with as many pairs, the foremost first, as come within `reach` (mm) of the foremost anywhere."""
        order, number = self._ranked(reach)
        if number == self.advance.shape[1]:
            return self
        kept = order[:, :number]

        def picked(values: Floats) -> Floats:
            return np.take_along_axis(values, kept[..., None], axis=1)

        return replace(
            self,
            advance=picked(self.advance),
            others=tuple(picked(variant) for variant in self.others),
            roll=picked(self.roll),
            mate_roll=picked(self.mate_roll),
            tooth=np.take_along_axis(self.tooth, kept, axis=1),
            mate=np.take_along_axis(self.mate, kept, axis=1),
        )

    def dropped(self, reach: float) -> Floats:
        """(p,) greatest advance of the pairs that `nearest` leaves out, mm."""
        order, number = self._ranked(reach)
        rest = np.take_along_axis(self.advance.max(axis=2), order[:, number:], axis=1)
        return np.asarray(rest.max(axis=1, initial=-np.inf), dtype=np.float64)

    def _ranked(self, reach: float) -> tuple[Ints, int]:
        """Pairs by their advance, the foremost first; and how many count at most."""
        foremost = self.advance.max(axis=2)
        order = np.argsort(-foremost, axis=1, kind="stable")
        return order, int((foremost >= foremost.max(axis=1, keepdims=True) - reach).sum(axis=1).max())


def rigid_advance(
    driver: ToothProfiles,
    driven: ToothProfiles,
    centre_distance: float,
    side: Side,
    positions_per_pitch: int,
    slices: int,
    cycle: Cycle,
    start_tooth: int,
    misalignment: float,
    variants: Sequence[tuple[ToothProfiles, ToothProfiles]] = (),
    corners: bool = True,
) -> RigidAdvance:
    """Rigid advance of both gears' flanks on slices of the common face width; see `loaded_contact` for what goes in.

    Without `corners` nothing touches off the path of contact: a pair begins and ends with it, as with tips well rounded or relieved.
    `variants` are drivers and driven gears that differ little from these, on the same radii: theirs is worked out to first order.

    Raises
    ------
    InputError
        As `mesh_contact`, and if a gear is internal.
    """
    n, gear, mate = positions_per_pitch, driver.gear, driven.gear
    for member in (gear, mate):
        refuse(member, "contact under load", Toothing.INTERNAL)
    check_contact(driver, driven, centre_distance)
    face = FaceParts.of(gear, mate, slices)

    def prepared(first: ToothProfiles, second: ToothProfiles) -> Passes:
        sliced = replace(first, z=face.z, half_angle=first.at_heights(face.z))
        mate_sliced = replace(second, z=face.mate_z, half_angle=second.at_heights(face.mate_z))
        return Passes.of(sliced, mate_sliced, centre_distance, side, n, start_tooth)

    run, others = prepared(driver, driven), [prepared(*pair) for pair in variants]
    passes = pitches(cycle, gear, mate)
    blocks = [_block(run, first, min(first + _PASSES_AT_A_TIME, passes), others) for first in range(0, passes, _PASSES_AT_A_TIME)]
    advance, roll, mate_roll, tooth, *shifts = (np.concatenate(part) for part in zip(*blocks, strict=True))
    if not np.isfinite(advance.max(axis=(1, 2))).all():
        raise InputError(
            f"centre distance {centre_distance:g} mm: in some positions no tooth reaches the mate; it must be smaller"
        )
    advance = advance - side * misalignment * face.place
    if not corners:
        advance = _on_path(run, advance, passes)
    varied = tuple(_afloat(advance + shift, face.half) for shift in shifts)
    advance = _afloat(advance, face.half)
    mate_tooth = run.mate(tooth) % mate.teeth
    nominal = -0.5 * transverse_backlash(gear, mate, centre_distance)
    rotation = np.arange(passes * n) / n * gear.pitch_angle
    return RigidAdvance(
        rotation=rotation,
        nominal=nominal,
        z=face.z,
        widths=face.widths,
        half=face.half,
        advance=advance,
        roll=roll,
        mate_roll=mate_roll,
        tooth=tooth % gear.teeth,
        mate=mate_tooth,
        others=varied,
    )


def _afloat(advance: Floats, half: Ints) -> Floats:
    """Advances (p, m, s) with one gear of a double helical pair where it comes to rest along its axis without load."""
    foremost = np.stack([advance[:, :, half == part].max(axis=(1, 2)) for part in np.unique(half)], axis=-1)
    apart = foremost - foremost.mean(axis=-1, keepdims=True)
    return np.asarray(advance - apart[:, None, half], dtype=np.float64)


def _on_path(run: Passes, advance: Floats, passes: int) -> Floats:
    """The advance without that of pairs off the path of contact of the design; as it is in positions where there is no other."""
    gear, mate = run.driver.gear, run.driven.gear
    path = path_of_contact(gear, mate, run.centre)
    angle = ((run.columns() + np.arange(run.n)[:, None] / run.n) * gear.pitch_angle)[..., None] + run.side * run.phase
    roll = run.roll_at(angle)
    off = np.tile((roll < path.start_pinion) | (roll > path.end_pinion), (passes, 1, 1))
    on_path = np.where(off, -np.inf, advance)
    reached = np.isfinite(on_path.max(axis=(1, 2), keepdims=True))
    return np.where(reached, on_path, advance)


def _block(run: Passes, first: int, stop: int, others: Sequence[Passes]) -> tuple[Floats | Ints, ...]:
    """Advance and lengths of roll (p, m, s), and teeth without end (p, m), of passes `first` to `stop`; what the advance of others is more."""
    block = run.block(first, stop)
    contact = run.contact(run.side, block)
    advance, radius, mate_radius = map(block.by_position, (contact.advance, contact.radius, contact.mate_radius))
    rolls = _roll(radius, run.driver.gear.base_radius), _roll(mate_radius, run.driven.gear.base_radius)
    shifts = run.shifts(others, run.side, block.tooth, contact)
    return advance, *rolls, block.near, *map(block.by_position, shifts)


def _roll(radius: Floats, base_radius: float) -> Floats:
    """Length of roll at radii, mm; 0 below the base circle and where there is no contact."""
    return roll_length(np.where(np.isfinite(radius), radius, base_radius), base_radius)
