"""What a laboratory looks at beside the graded deviations, as plain numbers: the key `laboratory` of an inspection."""

from __future__ import annotations

import math

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.inspection.areal import Areal
from gearwear.inspection.composite import Composite
from gearwear.inspection.laboratory import Laboratory
from gearwear.inspection.sections import LineTraces, Sections
from gearwear.inspection.waviness import Waviness
from gearwear.report.records.numbers import Json, estimate, lengths, per_flank, rolls, rounded


def laboratory_record(laboratory: Laboratory, gear: Gear) -> Json:
    """Deviations in µm as ``{"value", "expanded"}``, U with k = 2; places in mm; teeth from 1; null where not seen."""
    return {
        "spacing_mm": rounded(laboratory.spacing, 1, 4),
        "sections": _sections(laboratory.sections, gear),
        "areal": _areal(laboratory.areal),
        "waviness": _waviness(laboratory.waviness),
        "composite": None if laboratory.composite is None else _composite(laboratory.composite),
    }


def _sections(sections: Sections, gear: Gear) -> Json:
    def row(section: LineTraces) -> Json:
        evaluation, profile = section.evaluation, section.evaluation.along == "roll"
        at = section.at if profile else abs(section.at)
        circle = {} if profile else {"diameter_mm": rounded(2.0 * math.hypot(gear.base_radius, section.at), 1, 4)}
        parts = {f"{name}_um": getattr(evaluation, name) for name in ("slope", "form", "total", "crowning")}
        return {
            "place": section.place,
            "z_mm" if profile else "roll_mm": rounded(at, 1, 4),
            **circle,
            "half_width_mm": rounded(section.half_width, 1, 4),
            "flanks": per_flank(parts),
        }

    return {
        "profile": [row(section) for section in sections.profiles],
        "helix": [row(section) for section in sections.helices],
        "twist": per_flank({"from_profiles_um": sections.profile_twist, "from_helices_um": sections.helix_twist}),
    }


def _areal(areal: Areal) -> Json:
    flanks = per_flank({f"{name}_um": part for name, part in areal.flanks.named().items()})
    for row, (tooth, side) in zip(flanks, np.ndindex(*areal.lowest.value.shape), strict=True):
        for name, part, at in (("lowest", areal.lowest, areal.lowest_at), ("highest", areal.highest, areal.highest_at)):
            roll, z = at[tooth, side]
            local = estimate(part.at(tooth, side), 1e3, 2)
            row[f"{name}_um"] = None if local is None else local | {"roll_mm": rounded(abs(roll), 1, 3), "z_mm": rounded(z, 1, 3)}
    return {
        "range_roll_mm": rolls(areal.profile_range.ends),
        "range_z_mm": lengths(areal.helix_range.ends),
        "cell_mm": lengths(areal.cell_size),
        "mean_flank": {
            str(side): {f"{name}_um": estimate(part.at(side.index), 1e3, 2) for name, part in areal.mean.named().items()}
            for side in Side
        },
        "flanks": flanks,
    }


def _waviness(waviness: Waviness) -> Json:
    return {
        "orders": [int(waviness.orders[0]), int(waviness.orders[-1])],
        **{
            str(side): {
                "limit_um": rounded(float(waviness.limit[side.index]), 1e3, 3),
                "waves": [
                    {
                        "order": wave.order,
                        "ghost": waviness.is_ghost(wave),
                        "amplitude_um": {
                            "value": rounded(wave.amplitude, 1e3, 3),
                            "expanded": rounded(wave.expanded, 1e3, 3),
                        },
                        "phase_deg": rounded(math.degrees(wave.phase), 1, 1),
                    }
                    for wave in waviness.waves[side.index]
                ],
            }
            for side in Side
        },
    }


def _composite(composite: Composite) -> Json:
    return {
        "master_teeth": composite.master_teeth,
        "centre_distance_mm": rounded(composite.centre_distance, 1, 5),
        "single_flank": {
            str(side): {
                "total_um": estimate(composite.single_total.at(side.index), 1e3, 2),
                "tooth_to_tooth_um": estimate(composite.single_tooth.at(side.index), 1e3, 2),
            }
            for side in Side
        },
        "double_flank": {
            "total_um": estimate(composite.double_total, 1e3, 2),
            "tooth_to_tooth_um": estimate(composite.double_tooth, 1e3, 2),
        },
    }
