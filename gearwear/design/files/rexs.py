"""A cylindrical gear or stage of a REXS file (FVA, rexs.info; XML, versions 1.0 to 2.0) as the tables of a design file.

Read are: teeth, normal module, helix angle, face width, tip and root diameter and bore of the gear; pressure angle and profile shift of
its flanks; addendum and tip radius of the rack that cuts them; the stage's centre distance. Not read: modifications, tolerances of tooth
thickness, chamfers, machining allowances.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from gearwear.design.ring import SHIFT_BY_ISO
from gearwear.errors import InputError

UNITS = {
    "mm": 1.0, "m": 1000.0, "mum": 1e-3, "deg": 1.0, "°": 1.0, "rad": math.degrees(1.0), "none": 1.0, "": 1.0,
}  # fmt: skip
LEAST_TIP = 0.5
"""A tip diameter below this share of the reference diameter is a placeholder and is not taken."""


@dataclass(frozen=True, slots=True)
class _Model:
    """Components by their id with their attributes, and the relations by type: the ids by role."""

    kinds: dict[str, str]
    names: dict[str, str]
    attributes: dict[str, dict[str, tuple[str, str]]]
    relations: list[tuple[str, dict[str, str]]]

    def number(self, component: str, name: str) -> float | None:
        """A scalar in mm or degrees; None where it is not there."""
        if name not in self.attributes.get(component, {}):
            return None
        text, unit = self.attributes[component][name]
        what = f"component {component} ({self.names[component]}): {name} = {text[:40]}"
        if unit not in UNITS:
            raise InputError(f"{what} {unit}: one of {', '.join(one for one in UNITS if one)} would be right")
        try:
            value = float(text) * UNITS[unit]
        except ValueError:
            raise InputError(f"{what}: must be a number") from None
        if not math.isfinite(value):
            raise InputError(f"{what}: must be a finite number")
        return value

    def partners(self, relation: str, role: str, component: str) -> list[dict[str, str]]:
        """Ids by role of the relations of a type in which a component has a role."""
        return [ids for kind, ids in self.relations if kind == relation and ids.get(role) == component]


def parse_rexs(data: bytes) -> dict[str, Any]:
    """Turn a REXS model into the tables of a design file.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    dict
        As `gearwear.design.files.toml.parse_design` takes it: a pair where the model has one cylindrical stage, a gear where it has one
        cylindrical gear and no stage.

    Raises
    ------
    InputError
        If it is no REXS model, or has more than one stage, a ring gear with profile shift, two rings or different flanks.
    """
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, LookupError, ValueError) as error:  # the latter two: an encoding that is unknown or not read
        raise InputError(f"is not XML ({error}): a REXS model in UTF-8 would be right") from None
    if root.tag.rpartition("}")[2] != "model" or root.get("version") is None:
        raise InputError(f"is not a REXS model: its root is <{root.tag[:40]}>, <model version=…> would be right")
    model = _model(root)
    gears = [one for one, kind in model.kinds.items() if kind in ("cylindrical_gear", "ring_gear")]
    stages = [
        ids for kind, ids in model.relations if kind == "stage" and model.kinds.get(ids.get("stage", "")) == "cylindrical_stage"
    ]
    if len(stages) > 1 or (not stages and len(gears) > 1):
        listed = ", ".join(model.names[one] for one in (gears if not stages else [ids["stage"] for ids in stages]))
        raise InputError(
            f"{len(stages) or len(gears)} {'stages' if stages else 'gears'} ({listed}): a model of one stage or one gear would be right"
        )
    if not gears:
        raise InputError("has no cylindrical gear")
    if not stages:
        return {"gear": _member(model, gears[0])}
    pair = stages[0]
    if not all(pair.get(role) in gears for role in ("gear_1", "gear_2")):
        raise InputError("its stage does not name two cylindrical gears")
    tables = sorted((_member(model, pair[role]) for role in ("gear_1", "gear_2")), key=lambda table: table.get("teeth", 0))
    design: dict[str, Any] = {"pinion": tables[0], "gear": tables[1], "pair": {}}
    centre = model.number(pair["stage"], "center_distance")
    if centre is not None:
        design["pair"]["centre_distance"] = centre
    return design


def _model(root: ElementTree.Element) -> _Model:
    kinds, names = {}, {}
    attributes: dict[str, dict[str, tuple[str, str]]] = {}
    for component in root.iterfind("{*}components/{*}component"):
        one = component.get("id", "")
        kinds[one], names[one] = component.get("type", ""), component.get("name", component.get("type", ""))
        attributes[one] = {
            attribute.get("id", ""): ((attribute.text or "").strip(), attribute.get("unit", ""))
            for attribute in component.iterfind("{*}attribute")
        }
    relations = [
        (relation.get("type", ""), {ref.get("role", ""): ref.get("id", "") for ref in relation.iterfind("{*}ref")})
        for relation in root.iterfind("{*}relations/{*}relation")
    ]
    return _Model(kinds, names, attributes, relations)


def _member(model: _Model, one: str) -> dict[str, Any]:
    """The table of a gear or ring. A ring's number of teeth is positive (schema: above 0); of the sign of its profile shift the schema says nothing."""
    table = _gear(model, one)
    if model.kinds[one] == "ring_gear":
        if table.get("profile_shift", 0.0) != 0.0:
            raise InputError(
                f"component {one} ({model.names[one]}) is a ring gear with profile shift {table['profile_shift']:g}: REXS does not say its sign, "
                f"and programs differ; a design file with internal = true would be right ({SHIFT_BY_ISO})"
            )
        table["internal"] = True
        table.pop("rack_tip_radius", None)
    return table


def _gear(model: _Model, one: str) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for key, name in (
        ("module", "normal_module"), ("helix_angle", "helix_angle_reference_diameter"), ("face_width", "face_width"),
        ("tip_diameter", "tip_diameter"), ("root_diameter", "root_diameter"), ("bore_diameter", "inner_diameter"),
    ):  # fmt: skip
        value = model.number(one, name)
        if value is not None:
            table[key] = value
    teeth = model.number(one, "number_of_teeth")
    if teeth is not None:
        table["teeth"] = int(teeth) if teeth == int(teeth) else teeth
    for diameter in ("tip_diameter", "root_diameter"):
        if table.get(diameter, math.inf) < LEAST_TIP * table.get("module", 0.0) * (teeth or 0.0):
            del table[diameter]
    flanks = [ids[side] for ids in model.partners("flank", "gear", one) for side in ("left", "right") if side in ids]
    for key, name in (("pressure_angle", "normal_pressure_angle"), ("profile_shift", "addendum_modification_coefficient")):
        values = {value for flank in flanks if (value := model.number(flank, name)) is not None}
        if len(values) > 1:
            raise InputError(
                f"component {one} ({model.names[one]}): {name} differs between its flanks ({sorted(values)}): one for both would be right"
            )
        if values:
            table[key] = values.pop()
    tools = {ids.get("tool", "") for flank in flanks for ids in model.partners("manufacturing_step", "workpiece", flank)}
    racks = [tool for tool in tools if model.kinds.get(tool) == "rack_shaped_tool"]
    if len(racks) == 1:
        dedendum = model.number(racks[0], "addendum_coefficient_reference_profile")
        if dedendum is not None and "root_diameter" not in table:
            table["dedendum"] = dedendum
        tip = model.number(racks[0], "tip_radius_factor")
        if tip is not None:
            table["rack_tip_radius"] = tip
    return table
