"""What trend and gauge say of a fleet, beside its truth. Reads tables; imports nothing of gearwear."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

Table = list[dict[str, str]]
QUANTITIES = ("wear_volume_mm3", "wear_area_mm2", "wear_depth_mm", "thickness_loss_mm")


def table(path: Path) -> Table:
    """A CSV file."""
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def check_fleet(folder: Path, store: Path) -> None:
    """Print agreement of values, rates, times to a limit and verdicts with the truth, and of repeats with the stated ±."""
    true = table(folder / "truth.csv")
    found = table(store / "trend" / "trend.csv")
    points = table(store / "trend" / "inspections.csv")
    for quantity in (name for name in QUANTITIES if name in true[0]):
        print(quantity)
        _values(quantity, true, points)
        _rates(quantity, true, [row for row in found if row["quantity"] == quantity])
    gauge = store / "gauge" / "gauge.csv"
    if gauge.exists():
        _gauge(table(gauge))


def _share(hits: Sequence[bool]) -> str:
    return f"{100.0 * sum(hits) / len(hits):.0f} % of {len(hits)}" if hits else "none"


def _rms(values: Sequence[float]) -> float:
    return math.sqrt(sum(value * value for value in values) / len(values)) if values else math.nan


def _median(values: Sequence[float]) -> float:
    return sorted(values)[len(values) // 2] if values else math.nan


def _values(quantity: str, true: Table, points: Table) -> None:
    """Numbers at inspections: of those found, and of those where nothing was found but might be."""
    known = {(row["gear_id"], row["inspected"]): float(row[quantity]) for row in true}
    errors, pulls, relative, hidden = [], [], [], []
    for row in points:
        if row["quantity"] != quantity:
            continue
        value = known[row["gear_id"], row["inspected"][:10]]
        if row["std"]:
            errors.append(float(row["value"]) - value)
            pulls.append(errors[-1] / float(row["std"]))
            relative.append(errors[-1] / value)
        elif row["high"]:
            hidden.append(value <= float(row["high"]))
    print(
        f"  inspections {len(errors)}: mean error {sum(errors) / len(errors):.3g}, RMS {_rms(errors):.3g}, median {100 * _median(relative):.1f} %"
    )
    print(f"  error / stated ±: RMS {_rms(pulls):.2f}, within 2: {_share([abs(pull) <= 2 for pull in pulls])}")
    if hidden:
        print(f"  nothing found: {_share(hidden)} have no more than what might be there")


def _rates(quantity: str, true: Table, found: Table) -> None:
    """Rates, times to a limit and verdicts; truth is proportional to cycles."""
    per_cycle = {row["gear_id"]: float(row[quantity]) / float(row["cycles_run"]) for row in true}
    last = {row["gear_id"]: float(row[quantity]) for row in true}
    pulls, within, relative, held, ahead, verdicts = [], [], [], [], [], dict[tuple[str, str], int]()
    for row in found:
        gear = row["gear_id"]
        if row["rate"] and row["from_new"] != "True":
            within.append(float(row["rate_low"]) <= per_cycle[gear] <= float(row["rate_high"]))
            if float(row["rate_std"]) > 0.0:
                pulls.append((float(row["rate"]) - per_cycle[gear]) / float(row["rate_std"]))
            relative.append(float(row["rate"]) / per_cycle[gear] - 1.0)
        if not row["limit"]:
            continue
        limit = float(row["limit"])
        truth = "beyond" if last[gear] > limit else "within"
        verdicts[truth, row["conformity"]] = verdicts.get((truth, row["conformity"]), 0) + 1
        if row["per"] == "cycle" and row["from_new"] != "True" and last[gear] < limit:
            left = (limit - last[gear]) / per_cycle[gear]
            low = float(row["left_low"] or "inf")
            high = float(row["left_high"] or "inf")
            held.append(low <= left <= high)
            if row["left"]:
                ahead.append(float(row["left"]) / left - 1.0)
    if pulls:
        print(
            f"  rates {len(pulls)}: median {100 * _median(relative):.1f} % off; error / ±: RMS {_rms(pulls):.2f}, within 2: {_share([abs(p) <= 2 for p in pulls])};"
            f" in the 95 % interval {_share(within)}"
        )
    if held:
        print(f"  cycles to the limit: in the 95 % interval {_share(held)}; median {100 * _median(ahead):.1f} % off")
    for (truth, said), number in sorted(verdicts.items()):
        print(f"  truly {truth} the limit, said {said}: {number}")


def _gauge(rows: Table) -> None:
    for row in rows:
        if row["repeats_over_stated"]:
            name = " ".join(filter(None, (row["quantity"], row["flank"])))
            spread = f"{float(row['repeats_over_stated']):.2f} ({float(row['repeats_over_stated_low']):.2f} to {float(row['repeats_over_stated_high']):.2f})"
            print(
                f"gauge {name}: repeats over stated {spread}, {row['accord']}; GRR {100 * float(row['gauge_share'] or 'nan'):.0f} %, ndc {row['categories']}"
            )
