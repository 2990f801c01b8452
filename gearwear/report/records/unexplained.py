"""What is left unexplained, as the report's keys."""

from __future__ import annotations

from gearwear.comparison.results import Results
from gearwear.diagnose.found import Loop
from gearwear.diagnose.space_waves import SpaceWave
from gearwear.report.records.numbers import Json
from gearwear.report.words.verdict import pattern_words


def unexplained_record(loop: Loop, results: Results) -> Json:
    """``closed_loop.unexplained``: what no effect explains, in words and in numbers."""
    if not loop.patterns:
        return {"found": False, "rms_um": 0.0, "pattern": None}
    return {
        "found": True,
        "rms_um": 1e3 * loop.unexplained_rms,
        "pattern": pattern_words(loop, results.gear),
        "patterns": [
            {
                "order": p.order, "sides": p.sides, "waves_across_face": p.waves_z, "waves_along_profile": p.waves_profile,
                "rms_um": 1e3 * p.rms, "peak_um": 1e3 * p.peak, "p_value": p.p_value, **_in_space(p.in_space),
            }
            for p in loop.patterns
        ],
        "treatment": "taken out as an empirical pattern, without a name, before wear is measured",
    }  # fmt: skip


def _in_space(wave: SpaceWave | None) -> Json:
    if wave is None:
        return {}
    return {
        "wave_mm": wave.wavelength,
        "direction": wave.direction.tolist(),
        "displacement_um": 1e3 * wave.amplitude,
    }
