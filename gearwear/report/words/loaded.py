"""A pair under load in words: for the page and the terminal."""

from __future__ import annotations

import math

from gearwear.design.quantity import MISSING, SPACE, number, sentence, significant, with_std
from gearwear.loaded.result import LoadedContact
from gearwear.loaded.study import LoadedSpread, LoadedStudy

HEAD = ("under load", "design", "as it is")
TEXT = (
    "Elastic teeth: finite elements of both gears' sections, coupled along the face, with Hertzian flattening; shafts, bearings, housing, dynamics"
    " and oil film are left out. ± holds the spread of the compliance models and, as it is, of the flanks."
)


def load_words(study: LoadedStudy) -> str:
    """The load, short: "57.3 N m, 106.7 N/mm"."""
    present = study.present
    text = f"{significant(1e-3 * present.total * present.driver.base_radius)}{SPACE}N{SPACE}m on the pinion, {significant(present.load_per_width)}{SPACE}N/mm"
    if present.misalignment:
        text += f", misaligned by {number(1e3 * present.misalignment, 0)}{SPACE}µm over the face"
    return text


def loaded_rows(study: LoadedStudy) -> list[tuple[str, str, str]]:
    """A row under `HEAD` for each quantity."""
    columns = [_values(study.design, study.design_spread), _values(study.present, study.spread)]
    return [(name, columns[0][name], columns[1][name]) for name in columns[0]]


def _values(contact: LoadedContact, spread: LoadedSpread) -> dict[str, str]:
    um, stiff = f"{SPACE}µm", contact.stiffness

    def known(quantity: str, value: float, unit: str, factor: float = 1.0) -> str:
        if not math.isfinite(value):
            return MISSING
        std = factor * spread.std(quantity)
        return with_std(factor * value, std if std > 0.0 else None, unit)

    return {
        "transmission error, peak to peak": known("transmission_error", contact.peak_to_peak, "µm", 1e3),
        "the same, rigid, at the same positions": f"{number(1e3 * contact.rigid_peak_to_peak, 1)}{um}",
        "first harmonic of the mesh": known("mesh_harmonic", float(contact.harmonics(1)[0]), "µm", 1e3),
        "mean lag by load": known("mean_lag", contact.mean_lag, "µm", 1e3),
        "mesh stiffness, mean": known("stiffness", float(stiff.mean()), "N/(mm µm)"),
        "mesh stiffness, least … greatest": f"{number(float(stiff.min()), 1)} … {number(float(stiff.max()), 1)}{SPACE}N/(mm µm)",
        "contact ratio under load": known("contact_ratio", contact.contact_ratio, ""),
        "greatest over mean load along the face": known("face_load_factor", contact.face_load_factor, ""),
        "greatest pressure, away from corners": known("pressure", contact.greatest_pressure, "MPa"),
    }


def loaded_lines(study: LoadedStudy) -> list[tuple[str, str]]:
    """Name and text of the few lines for the terminal."""
    present, spread, design = study.present, study.spread, study.design
    error = with_std(1e3 * present.peak_to_peak, 1e3 * spread.std("transmission_error") or None, "µm")
    stiff = with_std(float(present.stiffness.mean()), spread.std("stiffness") or None, "N/(mm µm)")
    lag = with_std(1e3 * present.mean_lag, 1e3 * spread.std("mean_lag") or None, "µm")
    said = [
        ("transmission error", f"{error}; rigid {number(1e3 * present.rigid_peak_to_peak, 1)}, design {number(1e3 * design.peak_to_peak, 1)} µm"),
        ("mean lag", f"{lag}; design {number(1e3 * design.mean_lag, 1)} µm"),
        ("mesh stiffness", f"{stiff}; design {number(float(design.stiffness.mean()), 1)}"),
        ("contact ratio", f"{number(present.contact_ratio, 3)} under load; design {number(design.contact_ratio, 3)}"),
    ]  # fmt: skip
    if math.isfinite(present.greatest_pressure):
        said.append(("pressure", f"{number(present.greatest_pressure, 0)} MPa at most, away from corners"))
    return said


def loaded_notes(study: LoadedStudy) -> str:
    """What is worth knowing, as sentences."""
    return " ".join(map(sentence, study.notes))
