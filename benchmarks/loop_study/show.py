"""One scan of the study, truth beside found."""

from __future__ import annotations

from typing import Any

from benchmarks.loop_study.run import study
from benchmarks.loop_study.scenario import draw


def show(label: str, seed: int, points: int) -> None:
    """Print a scan's truth and what was made of it."""
    score = study(draw(label, seed, points))[0]
    if "refused" in score:
        print(f"refused: {score['refused']}")
        return
    print("scan     ", ", ".join(f"{k} {_short(v)}" for k, v in score["scan"].items()))
    for entry in [*score["true"], *([score["outside"]] if score["outside"] else [])]:
        print(f"true      {entry['name']}: {_values(entry['parameters'])}")
        limit = f"size is {1.0 / entry['limit']:.2f} of the limit" if entry["limit"] else ""
        print(
            f"          own part {entry['contribution_um']:.2f} µm, {entry['snr']:.1f} standard errors, {limit}; "
            f"{'detectable' if entry['detectable'] else 'not detectable'}; {entry.get('match', 'outside the catalogue')} {entry.get('found', '')}"
        )
        for name, e in entry.get("errors", {}).items():
            print(
                f"          {name}: true {e['true']:.4g}, error {e['error']:.3g}, std {e['std']:.3g}, pull {e['error'] / e['std']:.2f}"
            )
    for found in score["found"]:
        values = ", ".join(f"{k} {_short(v['value'])} ± {_short(v['std'])}" for k, v in found["parameters"].items())
        print(f"found     {found['name']}{' (FALSE)' if found['false'] else ''}: {values}")
        print(
            f"          own part {found['contribution_um']:.2f} µm, p {found['p']:.1e}, left-out gain {found['gain_in_errors']:.1f} errors, "
            f"effective number {found['n_eff']:.0f}; alternatives {', '.join(found['alternatives']) or 'none'}"
        )
    print("laws     ", ", ".join(score["laws_found"]) or "none")
    for pattern in score["patterns"] or ["none"]:
        print("pattern  ", pattern)
    for key in ("noise_um", "rms_um", "pose", "texture", "seconds"):
        print(f"{key:<10}{_values(score[key])}")
    wear = score["wear"]
    print(
        f"wear      true {wear['true']:.3f} mm³, after {wear['after']:.3f} ± {wear['std']:.3f}, before {wear['before']:.3f}; side {wear['worn_side']}"
    )
    for flank in wear["flanks"][:6]:
        print(f"          {_values(flank)}")
    for flank in wear["false_flanks"][:6]:
        print(f"          on an unworn flank: {_values(flank)}")


def _values(values: dict[str, Any]) -> str:
    return ", ".join(f"{k} {_short(v)}" for k, v in values.items())


def _short(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_short(v) for v in value) + "]"
    return str(value)
