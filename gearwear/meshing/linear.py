"""Contact of slightly deviating flanks: the classical linear model, an independent check of `contact`.

Contact is taken to stay on the line of action and between the ends of the nominal path; deviations of both flanks
add up there. Right where deviations are small against the path (µm, gentle slopes); it knows no corner contact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.profiles import ToothProfiles
from gearwear.design.quantity import at_most
from gearwear.design.side import Side
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError
from gearwear.meshing.backlash import transverse_backlash
from gearwear.meshing.passes import Cycle, Passes, pitches
from gearwear.meshing.path import path_of_contact, radius_at_roll
from gearwear.meshing.slices import Slices
from gearwear.meshing.tooth_pair import Flanks


@dataclass(frozen=True, slots=True)
class LinearResult:
    """One cycle; see `ContactResult` for signs and units.

    Parameters
    ----------
    rotation : (n,) float
        rad.
    transmission_error : (n,) float
        mm on the line of action, − is lag.
    backlash : (n,) float
        Normal backlash, mm.
    """

    rotation: Floats
    transmission_error: Floats
    backlash: Floats


def linear_contact(
    driver: ToothProfiles,
    driven: ToothProfiles,
    centre_distance: float,
    drive_side: Side = Side.LEFT,
    positions_per_pitch: int = 17,
    start_tooth: int = 0,
    cycle: Cycle = "revolution",
) -> LinearResult:
    """Transmission error and backlash by adding deviations on the line of action.

    Parameters
    ----------
    driver, driven, centre_distance, drive_side, positions_per_pitch, start_tooth, cycle
        As for `contact.mesh_contact`.

    Returns
    -------
    LinearResult

    Raises
    ------
    InputError
        If the contact ratio is below 1: the model has no contact between two pairs.

    Notes
    -----
    ``e = max over pairs in contact of δ_1(L_1) + δ_2(a_w sin α_wt − L_1)``, ``TE = e_drive``,
    ``j_bt = j_bt,nominal − e_drive − e_coast``, ``j_bn = j_bt cos β_b`` (first order of the exact contact in the deviations, which the tests
    compare it with). The tooth whose centre line is the angle a past the line of centres is touched at
    ``L_1 = r_b1 (a + ψ_b1 + α_wt)``, in a slice of a helical gear by r_b1 κ_1 ζ further on: contact lines lie at β_b.
    """
    gear, mate, side = driver.gear, driven.gear, Side.of(drive_side)
    refuse(gear, "the linear contact with the ring as the driver, instead of its pinion,", Toothing.INTERNAL)
    path = path_of_contact(gear, mate, centre_distance)
    cut = Slices.of(driver, driven).cut(driver, driven)
    refuse(gear, "the linear contact", Toothing.DOUBLE_HELICAL)
    run = Passes.of(*cut, centre_distance, side, positions_per_pitch, start_tooth)
    passes = pitches(cycle, gear, mate)
    passing = np.repeat(np.arange(passes), positions_per_pitch)
    place = np.tile(np.arange(positions_per_pitch) / positions_per_pitch, passes)
    slices = len(run.phase)

    def composite(flank: Side) -> Floats:
        greatest = np.full(len(passing), -np.inf)
        for column in run.columns():
            angle = ((flank * side) * (column + place) * gear.pitch_angle)[:, None] + flank * run.phase
            roll = run.roll_at(angle)
            inside = (roll >= path.start_pinion) & (roll <= path.end_pinion)
            touches = np.flatnonzero(inside.any(axis=1))
            if not len(touches):
                continue
            driving, mating = run.flanks(flank, run.tooth(passing[touches], column))
            deviation = np.zeros((len(touches), slices))
            for touching, along in ((driving, roll[touches]), (mating, path.roll_gear(roll[touches]))):
                deviation += _deviation(touching, along)
            deviation[~inside[touches]] = -np.inf
            greatest[touches] = np.maximum(greatest[touches], deviation.max(axis=1))
        if not np.isfinite(greatest).all():
            raise InputError(f"contact ratio {at_most(path.contact_ratio, 3)}: the linear model needs at least 1")
        return greatest

    drive, coast = composite(side), composite(side.opposite)
    play = transverse_backlash(gear, mate, centre_distance)
    return LinearResult((passing + place) * gear.pitch_angle, drive, gear.base_helix_cosine * (play - drive - coast))


def _deviation(flanks: Flanks, roll: Floats) -> Floats:
    """δ_t = r_b (ψ − ψ_nominal) where the rows, (teeth, slices) of them, are touched at `roll` (of that shape), mm."""
    radius = radius_at_roll(flanks.gear, roll).ravel()
    excess = flanks.excess_at(np.arange(len(radius)), radius)
    return (flanks.gear.base_radius * excess).reshape(roll.shape)
