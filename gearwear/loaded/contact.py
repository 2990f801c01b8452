"""Two gears in mesh under load, as they are: tooth by tooth, slice by slice, over whole revolutions.

The rigid advance of every slice of every pair is that of `gearwear.meshing`: worn flanks, tip corners and contact off the line of action are
in it as they are. Elastic teeth then share the load (`distribution`). Statics of the teeth and bodies alone: shafts, bearings, housing,
dynamics and oil film are left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.given import check_choice, check_number, check_whole
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.loaded.distribution import distribute
from gearwear.loaded.pair_compliance import COUPLING_MODULES, PairCompliance, coupling_length
from gearwear.loaded.result import LoadedContact
from gearwear.loaded.rigid_advance import RigidAdvance, rigid_advance
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import tooth_compliance
from gearwear.meshing.passes import CYCLES, Cycle
from gearwear.threads import on_one_thread

POSITIONS, SLICES = 34, 15
"""Positions per pitch; slices of the face width."""


@on_one_thread
def pair_compliance(
    driver: ToothProfiles, driven: ToothProfiles, material: Material | None = None, coupling_modules: float = COUPLING_MODULES
) -> PairCompliance:
    """The elastic side of a pair: finite elements of the sections of both gears on their bores, about a second each.

    Parameters
    ----------
    driver, driven : ToothProfiles
        Their gears as designed count: wear is small beside the thickness of a tooth.
    material : Material or None
        None: steel.
    coupling_modules : float
        Coupling length along the tooth in normal modules.
    """
    steel = Material() if material is None else material
    teeth = (tooth_compliance(driver.gear, steel), tooth_compliance(driven.gear, steel))
    return PairCompliance(teeth, steel, coupling_length(driver.gear, coupling_modules))


@on_one_thread
def loaded_contact(
    driver: ToothProfiles,
    driven: ToothProfiles,
    centre_distance: float,
    force: float,
    compliance: PairCompliance,
    drive_side: Side = Side.LEFT,
    *,
    misalignment: float = 0.0,
    positions_per_pitch: int = POSITIONS,
    slices: int = SLICES,
    cycle: Cycle = "revolution",
    start_tooth: int = 0,
    corners: bool = True,
) -> LoadedContact:
    """Turn two gears under load.

    Parameters
    ----------
    driver, driven : ToothProfiles
        The flanks of both gears, external, each in its own design frame, with mid-faces at one height.
    centre_distance : float
        mm; the housing.
    force : float
        Transverse force on all pairs together, N, along the line of action: torque of the driver over its base radius. 0 is the rigid answer.
    compliance : PairCompliance
        Of driver and driven gear, as `pair_compliance` gives it.
    drive_side : Side
        Flank of the driver that carries.
    misalignment : float
        Gap in the plane of action over the common face width, mm, along the transverse line of action; + opens towards the upper end on the driver's left flanks, and towards
        the lower one on its right flanks.
    positions_per_pitch, slices : int
        Positions while the driver turns by one tooth; slices of the common face width, of equal width, as many of each half where it has two.
    cycle : {"revolution", "driven", "hunting", "pitch"}
        As for `mesh_contact`; one pitch where all teeth are alike.
    start_tooth : int
        As in `mesh_contact`.
    corners : bool
        Whether flanks touch off the path of contact, at tip corners and below form circles; without, as with tips well rounded or relieved, a
        pair begins and ends with the path of the design.

    Returns
    -------
    LoadedContact

    Raises
    ------
    InputError
        If the force is negative, half angles are missing, a gear is internal, the gears do not mesh, positions, slices or teeth are no whole
        numbers, or the cycle is none.

    Examples
    --------
    >>> from gearwear.design import Gear, GearSpec
    >>> from gearwear.design.profiles import nominal_profiles
    >>> pinion, gear = (nominal_profiles(Gear.from_spec(GearSpec(n, z, 6.35, 15.0))) for n, z in (("pinion", 12), ("gear", 24)))
    >>> elastic = pair_compliance(pinion, gear)
    >>> result = loaded_contact(pinion, gear, 114.3, 1500.0, elastic, cycle="pitch", slices=1)
    >>> bool(8.0 < 1e3 * result.mean_lag < 9.5)
    True
    """
    (contact,), _ = loaded_variants(
        driver,
        driven,
        centre_distance,
        force,
        (compliance,),
        drive_side,
        misalignment=misalignment,
        positions_per_pitch=positions_per_pitch,
        slices=slices,
        cycle=cycle,
        start_tooth=start_tooth,
        corners=corners,
    )
    return contact


@on_one_thread
def loaded_variants(
    driver: ToothProfiles,
    driven: ToothProfiles,
    centre_distance: float,
    force: float,
    models: Sequence[PairCompliance],
    drive_side: Side = Side.LEFT,
    *,
    variants: Sequence[tuple[ToothProfiles, ToothProfiles]] = (),
    misalignment: float = 0.0,
    positions_per_pitch: int = POSITIONS,
    slices: int = SLICES,
    cycle: Cycle = "revolution",
    start_tooth: int = 0,
    corners: bool = True,
) -> tuple[tuple[LoadedContact, ...], tuple[LoadedContact, ...]]:
    """The same rigid contact under load with several compliance models, and with the first model for flanks that differ little.

    Parameters
    ----------
    driver, driven, centre_distance, force
        As for `loaded_contact`.
    models : sequence of PairCompliance
        At least one.
    drive_side : Side
        As for `loaded_contact`.
    variants : sequence of (ToothProfiles, ToothProfiles)
        Drivers and driven gears on the radii of these; their rigid advance is taken to first order in the difference.
    misalignment, positions_per_pitch, slices, cycle, start_tooth, corners
        As for `loaded_contact`.

    Returns
    -------
    by_model, by_variant : tuple of LoadedContact
        One per model, and one per variant.

    Raises
    ------
    InputError
        As `loaded_contact`.
    """
    side = Side.of(drive_side)
    for name, given, unit in (
        ("centre_distance", centre_distance, "mm"), ("force", force, "N"), ("misalignment", misalignment, "mm")
    ):  # fmt: skip
        check_number(name, given, unit)
    check_whole("positions_per_pitch", positions_per_pitch, 1)
    check_whole("slices", slices, 1)
    check_whole("start_tooth", start_tooth)
    check_choice("cycle", cycle, CYCLES)
    if not 0.0 <= force < np.inf:
        raise InputError(f"force = {force:g} N: must be 0 or above")
    rigid = rigid_advance(
        driver, driven, centre_distance, side, positions_per_pitch, slices, cycle, start_tooth, misalignment, variants, corners
    )
    reach = max(_reach(rigid, force, model) for model in models) + abs(misalignment)
    near = rigid.nearest(reach)
    dropped = rigid.dropped(reach)

    def solved(advance: Floats, whole: Floats, model: PairCompliance) -> LoadedContact:
        place, leads = near, advance
        level, loaded, slope, forces = _solved(place, leads, force, model)
        if (dropped > loaded.min(axis=0)).any():  # a pair that was left out would have carried: all of them, then
            place, leads = rigid, whole
            level, loaded, slope, forces = _solved(place, leads, force, model)
        return LoadedContact(
            driver=driver.gear,
            driven=driven.gear,
            material=model.material,
            drive_side=side,
            total=force,
            centre_distance=centre_distance,
            misalignment=misalignment,
            per_pitch=positions_per_pitch,
            rotation=rigid.rotation,
            rigid_transmission_error=level - rigid.nominal,
            transmission_error=loaded.mean(axis=0) - rigid.nominal,
            compliance=slope,
            z=rigid.z,
            widths=rigid.widths,
            driver_tooth=place.tooth,
            driven_tooth=place.mate,
            force=forces,
            roll=place.roll,
            mate_roll=place.mate_roll,
        )

    by_model = tuple(solved(near.advance, rigid.advance, model) for model in models)
    return by_model, tuple(solved(*pair, models[0]) for pair in zip(near.others, rigid.others, strict=True))


def _solved(
    near: RigidAdvance, advance: Floats, force: float, compliance: PairCompliance
) -> tuple[Floats, Floats, Floats, Floats]:
    """Rigid advance (p,), that under load of each half of the face (h, p), −dA/dF (p,) of their mean, and forces (p, m, s)."""
    forces, levels, slopes = np.empty_like(advance), [], []
    halves = np.unique(near.half)
    part = force / len(halves)  # a double helical gear that floats along its axis feels no force along it
    for half in halves:
        on = near.half == half
        ahead, roll, widths = advance[:, :, on], (near.roll[:, :, on], near.mate_roll[:, :, on]), near.widths[on]
        flattening = compliance.flattening(roll, widths, part / float(widths.sum()))
        solved = distribute(ahead.reshape(len(ahead), -1), compliance.matrix(roll, widths), part, flattening.of)
        forces[:, :, on] = solved.force.reshape(ahead.shape)
        levels.append(solved.advance)
        slopes.append(solved.compliance / len(halves))
    return advance.max(axis=(1, 2)), np.array(levels), np.mean(slopes, axis=0), forces


def _reach(rigid: RigidAdvance, force: float, compliance: PairCompliance) -> float:
    """How far below the foremost pair another may lie and still be touched, mm: twice what one pair alone would give way."""
    soft = sum(float(body.tooth.max()) + body.shared for body in compliance.teeth) + 20.0 / compliance.material.plane_modulus
    return 2.0 * compliance.scale * soft * force / float(rigid.widths.sum())
