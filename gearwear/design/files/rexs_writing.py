"""A gear or a pair as a REXS model (XML), which other gear programs read and `rexs.parse_rexs` reads back.

Names, units and the way components hang together are those of the official schema of REXS 1.4, which 1.7 still has (FVA,
github.com/fva-net/rexs-api-java). Tip and root are written as diameters, the tool with the addendum that reaches this root.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from xml.etree import ElementTree

from gearwear.design.files.writing import check_even_chamfer
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.pair import Design
from gearwear.design.side import Side
from gearwear.errors import InputError

VERSION = "1.4"
DATE = "1970-01-01T00:00:00+00:00"
"""A model must have one; the day it was written would make two runs differ."""
Attribute = tuple[str, str, float | int | str]
"""Name, unit and value."""
FACES = ("datum_face", "non_datum_face")


@dataclass(frozen=True, slots=True)
class _Writer:
    """The model as it grows."""

    relations: ElementTree.Element = field(default_factory=lambda: ElementTree.Element("relations"))
    components: ElementTree.Element = field(default_factory=lambda: ElementTree.Element("components"))

    def component(self, kind: str, name: str, *attributes: Attribute) -> str:
        """Add a component; (attribute, unit, value) each. Returns its id."""
        number = str(len(self.components) + 1)
        component = ElementTree.SubElement(self.components, "component", id=number, type=kind, name=name)
        for attribute, unit, value in attributes:
            text = value if isinstance(value, str) else repr(value)
            ElementTree.SubElement(component, "attribute", id=attribute, unit=unit).text = text
        return number

    def relation(self, kind: str, **roles: str) -> None:
        """Add a relation; role = id. Of steps of manufacturing there is one, the first."""
        number = str(len(self.relations) + 1)
        relation = ElementTree.SubElement(self.relations, "relation", id=number, type=kind)
        if kind == "manufacturing_step":
            relation.set("order", "1")
        for role, component in roles.items():
            ElementTree.SubElement(relation, "ref", role=role, id=component)


def rexs_text(design: Design) -> str:
    """Write a design as a REXS model.

    Parameters
    ----------
    design : Design
        One gear or a pair.

    Returns
    -------
    str
        XML in UTF-8.

    Raises
    ------
    InputError
        For what has no place there: rings, double helical gears, thinned teeth, tip chamfers of unequal legs, slopes (REXS does not say
        their sign).
    """
    writer = _Writer()
    gears = {part: _gear(writer, gear) for part, gear in design.gears.items()}
    if design.pair is not None:
        stage = writer.component("cylindrical_stage", "stage", ("center_distance", "mm", float(design.centre_distance)))
        writer.relation("stage", stage=stage, gear_1=gears["pinion"], gear_2=gears["gear"])
    model = ElementTree.Element("model", version=VERSION, applicationId="gearwear", applicationVersion="1", date=DATE)
    model.extend([writer.relations, writer.components])
    ElementTree.indent(model)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(model, encoding="unicode") + "\n"


def _gear(writer: _Writer, gear: Gear) -> str:
    """The gear with flanks, tool and modifications; its id."""
    spec = gear.spec
    check_even_chamfer(spec, "a REXS model")
    for key, value in (
        ("internal", spec.internal),
        ("gap", spec.gap),
        ("thinning", spec.thinning),
        ("tip_rounding", spec.tip_rounding),
        ("end_rounding", spec.end_rounding),
    ):
        if value and key == "internal":
            raise InputError(f"[{spec.name}] internal: a REXS model is written for external gears only; leave it out")
        if value:
            raise InputError(
                f"[{spec.name}] {key} = {value}: a REXS model has no place for it here; leaving it out would be right"
            )
    attributes: list[Attribute] = [
        ("number_of_teeth", "none", spec.teeth),
        ("normal_module", "mm", spec.normal_module),
        ("helix_angle_reference_diameter", "deg", math.degrees(spec.helix_angle)),
        ("face_width", "mm", spec.face_width),
        ("tip_diameter", "mm", 2.0 * gear.tip_radius),
        ("root_diameter", "mm", 2.0 * gear.root_radius),
    ]
    attributes += [("inner_diameter", "mm", spec.bore_diameter)] if spec.bore_diameter > 0.0 else []
    attributes += [("chamfer_at_tooth_end", "mm", spec.end_chamfer)] if spec.end_chamfer > 0.0 else []
    component = writer.component("cylindrical_gear", spec.name, *attributes)
    angle: Attribute = ("normal_pressure_angle", "deg", math.degrees(spec.normal_pressure_angle))
    tool = writer.component(
        "rack_shaped_tool",
        f"tool of {spec.name}",
        ("normal_module", "mm", spec.normal_module),
        angle,
        ("addendum_coefficient_reference_profile", "none", spec.dedendum),
        ("tip_radius_factor", "none", spec.rack_tip_radius),
        *((("protuberance_amount", "mm", spec.protuberance),) if spec.protuberance > 0.0 else ()),
        *(() if spec.protuberance_angle is None else (("protuberance_angle", "deg", math.degrees(spec.protuberance_angle)),)),
    )
    settings = writer.component(
        "cylindrical_gear_manufacturing_settings", f"cutting of {spec.name}", ("machining_allowance", "mm", spec.grinding_stock)
    )
    flanks = {}
    for side in Side:
        flank = writer.component(
            "cylindrical_gear_flank",
            f"{side} flank of {spec.name}",
            angle,
            ("addendum_modification_coefficient", "none", spec.profile_shift),
            *((("tooth_tip_chamfer", "mm", spec.tip_chamfer),) if spec.tip_chamfer > 0.0 else ()),
        )
        writer.relation("manufacturing_step", workpiece=flank, tool=tool, manufacturing_settings=settings)
        _modifications(writer, gear, flank, spec.left if side is Side.LEFT else spec.right)
        flanks[str(side)] = flank
    writer.relation("flank", gear=component, **flanks)
    return component


def _modifications(writer: _Writer, gear: Gear, flank: str, drawn: FlankModification) -> None:
    for slope in ("profile_slope", "helix_slope"):
        if getattr(drawn, slope) != 0.0:
            raise InputError(
                f"[{gear.spec.name}] {slope} = {getattr(drawn, slope):g} mm: REXS does not say its sign; 0 would be right"
            )
    parts: list[tuple[str, list[Attribute]]] = []
    for end in ("tip", "root"):
        name = f"{end}_relief"
        if getattr(drawn, name) > 0.0:
            start, length = getattr(drawn, f"{name}_start"), getattr(drawn, f"{name}_length")
            where: Attribute = ("datum_diameter", "mm", start) if start is not None else ("datum_length", "mm", length)
            depth: Attribute = (f"{name}_depth", "mm", getattr(drawn, name))
            shape: Attribute = ("shape_of_relief", "none", getattr(drawn, f"{name}_form"))
            parts.append((name, [depth, (f"{name}_{where[0]}", *where[1:]), shape]))
    amount: tuple[str, float]
    if drawn.profile_crowning != 0.0:
        amount = ("mm", drawn.profile_crowning)
        parts.append(("profile_crowning", [(f"profile_crowning_at_{end}", *amount) for end in ("root", "tip")]))
    if drawn.helix_crowning != 0.0:
        amount = ("mm", drawn.helix_crowning)
        parts.append(("helix_crowning", [(f"helix_crowning_amount_{face}", *amount) for face in FACES]))
    if drawn.end_relief > 0.0:
        for face in FACES:
            at_face: list[Attribute] = [
                (f"end_relief_depth_{face}", "mm", drawn.end_relief),
                (f"end_relief_length_{face}", "mm", drawn.end_relief_length),
                ("shape_of_relief", "none", drawn.end_relief_form),
            ]
            parts.append((f"end_relief_{face}", at_face))
    for kind, attributes in parts:
        writer.relation("reference", origin=flank, referenced=writer.component(kind, kind.replace("_", " "), *attributes))
