"""What a registration and an inspection show of themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from gearwear.card import Card, Row
from gearwear.design.profiles import LEFT, RIGHT

if TYPE_CHECKING:
    from gearwear.measure.inspection.inspection import Inspection
    from gearwear.measure.registration import Registration


class RegistrationCard(Card):
    """Of a `Registration`."""

    __slots__ = ()

    def headline(self) -> str:
        own = cast("Registration", self)
        settled = "settled" if own.converged else "did not settle"
        return f"{settled}, {100 * own.fitting:.1f} % of the points on the design, noise {1e3 * own.noise:.2f} µm"

    def rows(self) -> list[Row]:
        own = cast("Registration", self)
        std = 1e3 * np.sqrt(np.diag(own.covariance))
        place = [
            f"{axis} {value:.3f} mm " + (f"± {error:.2g} µm" if seen else "(not seen)")
            for axis, value, error, seen in zip("xyz", own.pose.translation, std[:3], own.observed[:3], strict=True)
        ]
        return [
            ("translation", ", ".join(place)),
            ("rotation about the axis", f"± {np.degrees(own.rotation_std):.2g}°"),
            ("rests on", ", ".join(own.datum.surfaces)),
            ("stands proud by", f"{1e3 * own.offset:.1f} µm"),
            *(("note", note) for note in own.notes),
        ]


class InspectionCard(Card):
    """Of an `Inspection`."""

    __slots__ = ()

    def headline(self) -> str:
        own = cast("Inspection", self)
        graded = "no class as a whole" if own.iso_class is None else f"class {own.iso_class}"
        return f"{own.settings.edition}, {graded}, {own.points:,} points on flanks, noise {1e3 * own.noise:.2f} µm"

    def rows(self) -> list[Row]:
        own = cast("Inspection", self)
        found: dict[str, list[str]] = {}
        for one in own.findings:
            side = {LEFT: "left ", RIGHT: "right ", None: ""}[one.side]
            value = f"{1e3 * one.value:.1f} µm, U {1e3 * one.expanded:.1f}: " if np.isfinite(one.value) else ""
            found.setdefault(one.symbol, []).append(f"{side}{value}{one.statement}")
        return [(symbol, "; ".join(said)) for symbol, said in found.items()]
