"""A pair under its load: as designed and as it is, beside rigid contact, and how far that can be relied on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow, measured
from gearwear.design.given import check_choice, check_number, check_several, check_whole
from gearwear.design.load import LoadSpec
from gearwear.design.pair import Design, check_design
from gearwear.design.profiles import ToothProfiles, nominal_profiles, profiles_of_pair
from gearwear.design.side import Side
from gearwear.errors import InputError, check_kind
from gearwear.loaded.contact import SLICES, loaded_contact, loaded_variants
from gearwear.loaded.formulas import beam_on_ring
from gearwear.loaded.pair_compliance import COUPLING_MODULES, PairCompliance, coupling_length
from gearwear.loaded.result import LoadedContact
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import ToothCompliance, tooth_compliance
from gearwear.meshing.backlash import normal_backlash, overlap_words
from gearwear.meshing.passes import CYCLES, Cycle
from gearwear.meshing.slices import common_width, uneven_across_face
from gearwear.threads import on_one_thread

PAIR = "profiles (pinion, gear)"
COUPLINGS = (1.0, 1.4)
"""Coupling lengths in modules that fit three-dimensional finite elements about as well as `COUPLING_MODULES`."""
MOST_DRAWS = 8
"""Flanks as they may as well be that are run under load."""
QUANTITIES = (
    "transmission_error",
    "mean_lag",
    "mesh_harmonic",
    "stiffness",
    "contact_ratio",
    "pressure",
    "face_load_factor",
)
"""What of a contact has a standard deviation, in the order of `numbers`."""


@dataclass(frozen=True, slots=True)
class LoadedSpread:
    """Standard deviations by quantity (`QUANTITIES`), in its own unit: mm, mm, mm, N/(mm µm), 1, MPa, 1.

    Parameters
    ----------
    models : dict of str to float
        By the compliance: finite elements or formulas, plane strain or plane stress, the coupling along the face; of helical gears also by the
        width of the slices, within which contact lines end.
    flanks : dict of str to float
        By how well the flanks are known; 0 for those of a design.
    """

    models: dict[str, float]
    flanks: dict[str, float]

    def std(self, quantity: str) -> float:
        """Both together."""
        return float(np.hypot(self.models[quantity], self.flanks[quantity]))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LoadedStudy(Card):
    """A pair under load.

    Parameters
    ----------
    load : LoadSpec
    teeth : (ToothCompliance, ToothCompliance)
        Of pinion and gear.
    design : LoadedContact
        One pitch of the pair as designed and aligned.
    present : LoadedContact
        A cycle with the flanks as they are, misaligned as stated.
    design_spread, spread : LoadedSpread
    notes : tuple of str
        What is worth knowing, each a sentence.
    """

    load: LoadSpec
    teeth: tuple[ToothCompliance, ToothCompliance]
    design: LoadedContact
    present: LoadedContact
    design_spread: LoadedSpread
    spread: LoadedSpread
    notes: tuple[str, ...]

    @property
    def mesh_frequency(self) -> float | None:
        """Hz; None where no speed is stated."""
        speed = self.load.speed_rpm
        return None if speed is None else speed / 60.0 * self.present.driver.teeth

    def headline(self) -> str:
        return self.present.headline()

    def rows(self) -> list[CardRow]:
        present, spread = self.present, self.spread
        return [
            ("transmission error", f"{measured(1e3 * present.peak_to_peak, 1e3 * spread.std('transmission_error'), 'µm')} peak to peak; rigid {1e3 * present.rigid_peak_to_peak:.1f} µm, design {1e3 * self.design.peak_to_peak:.1f} µm"),
            ("mean lag", measured(1e3 * present.mean_lag, 1e3 * spread.std("mean_lag"), "µm")),
            ("mesh stiffness", measured(float(present.stiffness.mean()), spread.std("stiffness"), "N/(mm µm)")),
            *(("note", note) for note in self.notes),
        ]  # fmt: skip


def numbers(contact: LoadedContact) -> Floats:
    """The quantities of a contact, in the order of `QUANTITIES`."""
    return np.array([
        contact.peak_to_peak, contact.mean_lag, float(contact.harmonics(1)[0]), float(contact.stiffness.mean()), contact.contact_ratio,
        contact.greatest_pressure, contact.face_load_factor,
    ])  # fmt: skip


def compliance_models(teeth: tuple[ToothCompliance, ToothCompliance], material: Material) -> tuple[PairCompliance, ...]:
    """The model that counts, and others that are about as well founded: what they differ by is how far compliance is known.

    The finite elements in plane strain with a coupling of `COUPLING_MODULES`; the same in plane stress, softer by 1 / (1 − ν²); with the
    least and the greatest coupling that fit; and published formulas in place of finite elements.
    """
    pinion = teeth[0].gear
    best = PairCompliance(teeth, material, coupling_length(pinion, COUPLING_MODULES))
    formulas = tuple(beam_on_ring(body.gear, material, body.roll, body.bore_radius) for body in teeth)
    return (
        best,
        replace(best, scale=1.0 / (1.0 - material.poisson**2)),
        *(replace(best, coupling=coupling_length(pinion, length)) for length in COUPLINGS),
        replace(best, teeth=(formulas[0], formulas[1])),
    )


def not_modelled(design: Design) -> str:
    """Why a design's gears cannot be put under load, as a clause; "" where they can."""
    return "load on internal gears is not modelled" if any(gear.spec.internal for gear in design.gears.values()) else ""


def load_left_out(design: Design) -> tuple[str, ...]:
    """The note on a [load] of gears that cannot be put under it, a sentence; empty where there is nothing to say."""
    why = not_modelled(design) if design.load is not None else ""
    return (f"{why}: [load] is left out, the contact is rigid",) if why else ()


@on_one_thread
def study_load(
    design: Design,
    flanks: tuple[ToothProfiles, ToothProfiles] | None = None,
    load: LoadSpec | None = None,
    drive_side: Side = Side.LEFT,
    *,
    centre_distance: float | None = None,
    drawn: Sequence[tuple[ToothProfiles, ToothProfiles]] = (),
    cycle: Cycle = "revolution",
    start_tooth: int = 0,
) -> LoadedStudy:
    """A pair under load: transmission error, mesh stiffness, load sharing and pressure, as designed and as it is.

    Parameters
    ----------
    design : Design
        A pair of external gears.
    flanks : (ToothProfiles, ToothProfiles) or None
        Of pinion and gear as they are; None: as designed.
    load : LoadSpec or None
        None: that of the design.
    drive_side : Side
        Flanks that carry, the pinion driving.
    centre_distance : float or None
        mm, in place of the design's.
    drawn : sequence of (ToothProfiles, ToothProfiles)
        Flanks as they may as well be, on the same radii; the first `MOST_DRAWS` count.
    cycle : {"revolution", "driven", "hunting", "pitch"}
    start_tooth : int
        As for `mesh_contact`.

    Returns
    -------
    LoadedStudy

    Raises
    ------
    InputError
        If the design has one gear or gears that are not modelled, no load is stated, the gears do not mesh, or side, cycle or tooth are none.

    Examples
    --------
    >>> import gearwear as gw
    >>> design = gw.read_design(gw.example("design.toml"))
    >>> study = study_load(design, load=LoadSpec(load_per_width=100.0))
    >>> bool(study.present.stiffness.mean() > 10.0)
    True
    """
    check_design(design)
    check_kind(load, LoadSpec | None, "load", "a gw.LoadSpec, or None for that of the design,")
    if flanks is not None:
        flanks = profiles_of_pair("flanks", flanks, PAIR)
    drawn = [profiles_of_pair("drawn", pair, PAIR) for pair in check_several("drawn", drawn, PAIR)]
    check_whole("start_tooth", start_tooth)
    check_choice("cycle", cycle, CYCLES)
    drive_side = Side.of(drive_side)
    if design.pair is None:
        raise InputError(f"{design.source or 'the design'}: has one gear; load needs [pinion] and [gear]")
    stated = design.load if load is None else load
    if stated is None:
        raise InputError(f"{design.source or 'the design'}: no load is stated; a table [load] with torque_Nm is needed")
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    centre = design.centre_distance if centre_distance is None else centre_distance
    check_number("centre_distance", centre, "mm")
    if why := not_modelled(design):
        raise InputError(
            f"{design.source or 'the design'}: {why}; external gears, or the rigid contact alone (study_meshing), would be right"
        )
    force = stated.force(pinion.base_radius, common_width(pinion, gear))
    material = Material(stated.elastic_modulus, stated.poisson)
    teeth = (tooth_compliance(pinion, material), tooth_compliance(gear, material))
    models = compliance_models(teeth, material)
    nominal = (nominal_profiles(pinion), nominal_profiles(gear))
    (designed, *other_designs), _ = loaded_variants(
        *nominal, centre, force, models, drive_side, slices=SLICES if uneven_across_face(pinion, gear) else 1, cycle="pitch"
    )
    (present, *others), by_flanks = loaded_variants(
        *(nominal if flanks is None else flanks), centre, force, models, drive_side,
        variants=drawn[:MOST_DRAWS], misalignment=stated.misalignment, cycle=cycle, start_tooth=start_tooth,
    )  # fmt: skip
    sliced: tuple[LoadedContact, ...] = ()
    if pinion.twist != 0.0:
        sliced = (loaded_contact(*nominal, centre, force, models[0], drive_side, slices=2 * SLICES, cycle="pitch"),)
    by_slices = _off(designed, sliced)
    return LoadedStudy(
        load=stated,
        teeth=teeth,
        design=designed,
        present=present,
        design_spread=LoadedSpread(_both(_off(designed, other_designs), by_slices), _off(designed, ())),
        spread=LoadedSpread(_both(_off(present, others), by_slices), _off(present, by_flanks)),
        notes=_notes(teeth, present, centre),
    )


def _off(present: LoadedContact, others: Sequence[LoadedContact]) -> dict[str, float]:
    """Root mean square of how far others lie from what counts: what scatters stands out of it, so its mean is off too."""
    if not others:
        return dict.fromkeys(QUANTITIES, 0.0)
    apart = np.nan_to_num(np.array([numbers(contact) for contact in others]) - numbers(present), posinf=0.0, neginf=0.0)
    return dict(zip(QUANTITIES, np.sqrt((apart**2).mean(axis=0)).tolist(), strict=True))


def _both(one: dict[str, float], other: dict[str, float]) -> dict[str, float]:
    return {quantity: math.hypot(one[quantity], other[quantity]) for quantity in QUANTITIES}


def _notes(teeth: tuple[ToothCompliance, ToothCompliance], present: LoadedContact, centre: float) -> tuple[str, ...]:
    gears = teeth[0].gear, teeth[1].gear
    tight = overlap_words(*gears, centre, normal_backlash(*gears, centre))
    notes = [f"as designed {tight}"] if tight else []
    for body in teeth:
        if body.gear.spec.bore_diameter == 0.0:
            notes.append(
                f"no bore_diameter is stated of the {body.gear.spec.name}: it is taken to be held on one of {2.0 * body.bore_radius:.1f} mm"
            )
    if present.edge_load > 0.0:
        notes.append(
            f"tip corners carry up to {100.0 * present.edge_load:.0f} % of the force: pressures there are not known, and none is told"
        )
    return tuple(notes)
