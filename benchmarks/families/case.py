"""One scan to be made and what may be said of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from benchmarks.families.fields import described
from benchmarks.families.part import Part
from benchmarks.families.scanner import Scanner
from benchmarks.families.truth import truth

SCHEMA = "gearwear.families/1"


@dataclass(frozen=True, eq=False)
class Case:
    """A scan of a family.

    Parameters
    ----------
    family, number : str, int
    what : str
        Its kind within the family, in plain words.
    part : Part
        The gear as it is.
    design : dict
        What the user gives: the keys of a design file's `[gear]`.
    mate : int
        Teeth of the mate in the design, 0: none.
    scanner : Scanner
    seed : int
    declared : tuple of dict
        Effects of the contract that are in it: name and parameters as a perfect report would give them, ends and tooth 1 as made.
    may_name : tuple of str
        Names that are right as well, but need not be found.
    near : tuple of str
        Names of effects close to what is in it, but not of its shape: neither right nor false.
    outside : str
        What is in it that no effect of the contract describes; "": nothing.
    fine : bool
        Whether wear is small enough to need a fine grid.
    """

    family: str
    number: int
    what: str
    part: Part
    design: dict[str, Any]
    mate: int
    scanner: Scanner
    seed: int
    declared: tuple[dict[str, Any], ...] = ()
    may_name: tuple[str, ...] = ()
    near: tuple[str, ...] = ()
    outside: str = ""
    fine: bool = False
    unseen: tuple[int, ...] = field(default_factory=tuple)

    @property
    def label(self) -> str:
        return f"{self.family}{self.number}"

    def toml(self) -> str:
        """The design file."""
        name = "pinion" if self.mate else "gear"
        lines = [f"[{name}]", *(f"{key} = {value!r}" for key, value in self.design.items())]
        if self.mate:
            lines += ["", "[gear]", f"teeth = {self.mate}"]
        return "\n".join(lines) + "\n"

    def record(self) -> dict[str, Any]:
        """What is true, as plain data; poses and points are the scan's."""
        t, gear, scanner = truth(self.part, self.fine), self.part.gear, self.scanner
        arcs = {name: [round(float(v), 7) if v == v else None for v in values] for name, values in t.thickness.items()}
        return {
            "schema": SCHEMA,
            "label": self.label,
            "family": self.family,
            "what": self.what,
            "design": self.design,
            "mate_teeth": self.mate,
            "gear": {
                "teeth": gear.teeth, "module": gear.module, "pressure_angle": gear.pressure_angle, "face_width": gear.face_width,
                "profile_shift": gear.profile_shift, "thinning": gear.thinning, "tip_radius_mm": gear.tip_radius,
                "root_radius_mm": float(self.part.section.root_radius[0]), "form_radius_mm": self.part.section.form_radius,
                "thickness_mm": gear.thickness, "bore_diameter": gear.bore, "tools": [vars(tool) for tool in self.part.tools],
            },
            "made": [described(one) for one in self.part.made],
            "wear": t.flanks,
            "wear_fields": [described(one) for one in self.part.wear],
            "volume_mm3": t.volume,
            "broken": t.broken,
            "broken_volume_mm3": t.broken_volume,
            "unseen_teeth": list(self.unseen),
            "thickness": arcs,
            "declared": list(self.declared),
            "may_name": list(self.may_name),
            "near": list(self.near),
            "outside": self.outside,
            "noise_mm": scanner.noise,
            "texture_mm": 0.0 if scanner.texture is None else scanner.texture.rms,
            "edge_mm": scanner.edge,
            "seed": self.seed,
        }  # fmt: skip
