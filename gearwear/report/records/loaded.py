"""A pair under load as plain numbers: `meshing` → `loaded` of `report.json`, and `loaded` of `meshing.json`."""

from __future__ import annotations

import numpy as np

from gearwear.loaded.result import LoadedContact
from gearwear.loaded.study import LoadedSpread, LoadedStudy
from gearwear.report.records.numbers import Json, value_std_unit

HOLDS = (
    "Hertzian line contact of smooth flanks, without oil film, friction and heat; not at tip corners and below the form circle, where no"
    " pressure is told, nor at the ends of the face and of contact lines"
)
LEAVES_OUT = "shafts, bearings, housing, dynamics, oil film and heat; sections of teeth, coupled along the face by one length, whose ends are like the rest"


def loaded_record(study: LoadedStudy) -> Json:
    """What the pair does under load as it is, with the design under the same load beside it."""
    present, load = study.present, study.load
    flanks = present.load_map()
    roll, share = present.share_along()
    return {
        "force_N": present.total,
        "torque_Nm": 1e-3 * present.total * present.driver.base_radius,
        "load_per_width_N_mm": present.load_per_width,
        "speed_rpm": load.speed_rpm,
        "mesh_frequency_Hz": study.mesh_frequency,
        "elastic_modulus_MPa": load.elastic_modulus,
        "poisson": load.poisson,
        "misalignment_um": 1e3 * present.misalignment,
        "held_on_diameter_mm": {
            name: 2.0 * tooth.bore_radius for name, tooth in zip(("pinion", "gear"), study.teeth, strict=True)
        },
        "drive_flank": str(present.drive_side),
        **_contact(present, study.spread),
        "design": _contact(study.design, study.design_spread),
        "load_share": {"roll_pinion_mm": roll.tolist(), "share": share.tolist()},
        "load_map": {
            "roll_edges_pinion_mm": flanks.roll_edges.tolist(),
            "z_mm": flanks.z.tolist(),
            "load_N_mm": flanks.values.mean(axis=0).tolist(),
        },
        "course": {
            "rotation_deg": np.degrees(present.rotation).tolist(),
            "transmission_error_um": (1e3 * present.transmission_error).tolist(),
            "rigid_transmission_error_um": (1e3 * present.rigid_transmission_error).tolist(),
            "mesh_stiffness_N_mm_um": present.stiffness.tolist(),
        },
        "holds": HOLDS,
        "leaves_out": LEAVES_OUT,
        "notes": list(study.notes),
    }


def _contact(contact: LoadedContact, spread: LoadedSpread) -> Json:
    stiffness = contact.stiffness

    def known(quantity: str, value: float, unit: str, factor: float = 1.0) -> Json:
        return {
            **value_std_unit(factor * value, factor * spread.std(quantity), unit),
            "std_models": factor * spread.models[quantity],
            "std_flanks": factor * spread.flanks[quantity],
        }

    return {
        "transmission_error_um": known("transmission_error", contact.peak_to_peak, "um", 1e3),
        "rigid_transmission_error_um": 1e3 * contact.rigid_peak_to_peak,
        "mean_lag_um": known("mean_lag", contact.mean_lag, "um", 1e3),
        "mesh_harmonic_um": known("mesh_harmonic", float(contact.harmonics(1)[0]), "um", 1e3),
        "mesh_harmonics_um": (1e3 * contact.harmonics()).tolist(),
        "rigid_mesh_harmonics_um": (1e3 * contact.harmonics(rigid=True)).tolist(),
        "mesh_stiffness": {
            "mean": known("stiffness", float(stiffness.mean()), "N/(mm um)"),
            "least": float(stiffness.min()),
            "greatest": float(stiffness.max()),
        },
        "contact_ratio": known("contact_ratio", contact.contact_ratio, "1"),
        "face_load_factor": known("face_load_factor", contact.face_load_factor, "1"),
        "pressure": {
            "greatest_MPa": known("pressure", contact.greatest_pressure, "MPa"),
            "edge_share_of_load": contact.edge_load,
        },
    }
