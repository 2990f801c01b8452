"""The table of what was measured."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of what, measured, goal and whether it was reached."""

    rows: list[tuple[str, str, str, str]]

    def add(self, what: str, measured: str, goal: str = "", reached: bool | None = None) -> None:
        self.rows.append((what, measured, goal, "" if reached is None else "yes" if reached else "**no**"))

    def markdown(self) -> str:
        lines = ["| what | measured | goal | reached |", "|---|---|---|---|"]
        return "\n".join(lines + [f"| {' | '.join(row)} |" for row in self.rows])
