"""A cylindrical gear or stage of a REXS file (FVA, rexs.info; XML, versions 1.0 to 2.0) as the tables of a design file.

Read are: teeth, normal module, helix angle, face width, tip and root diameter and bore of the gear; pressure angle and profile shift of
its flanks, their tip chamfer and modifications (`rexs_flanks`); addendum, tip radius and protuberance of the rack that cuts them, and the
stock it leaves; end chamfers; the stage's centre distance. Not read: tolerances of tooth thickness.
"""

from __future__ import annotations

import math
from typing import Any
from xml.etree import ElementTree

from gearwear.design.files.rexs_flanks import Model, flank_keys, tool_keys
from gearwear.design.ring import SHIFT_BY_ISO
from gearwear.errors import InputError

TIP_RADIUS_FACTORS = ("tip_corner_radius_factor_reference_profile", "tip_radius_factor")
"""Names of the rack's tip radius in modules: of version 2.0, and of those before."""
LEAST_TIP = 0.5
"""A tip diameter below this share of the reference diameter is a placeholder and is not taken."""


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
    gears = [ident for ident, kind in model.kinds.items() if kind in ("cylindrical_gear", "ring_gear")]
    stages = [
        ids for kind, ids in model.relations if kind == "stage" and model.kinds.get(ids.get("stage", "")) == "cylindrical_stage"
    ]
    if len(stages) > 1 or (not stages and len(gears) > 1):
        listed = ", ".join(model.names[ident] for ident in (gears if not stages else [ids["stage"] for ids in stages]))
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


def _model(root: ElementTree.Element) -> Model:
    kinds, names = {}, {}
    attributes: dict[str, dict[str, tuple[str, str]]] = {}
    for component in root.iterfind("{*}components/{*}component"):
        ident = component.get("id", "")
        kinds[ident], names[ident] = component.get("type", ""), component.get("name", component.get("type", ""))
        attributes[ident] = {
            attribute.get("id", ""): ((attribute.text or "").strip(), attribute.get("unit", ""))
            for attribute in component.iterfind("{*}attribute")
        }
    relations = [
        (relation.get("type", ""), {ref.get("role", ""): ref.get("id", "") for ref in relation.iterfind("{*}ref")})
        for relation in root.iterfind("{*}relations/{*}relation")
    ]
    return Model(kinds, names, attributes, relations)


def _member(model: Model, ident: str) -> dict[str, Any]:
    """The table of a gear or ring. A ring's number of teeth is positive (schema: above 0); of the sign of its profile shift the schema says nothing."""
    table = _gear(model, ident)
    if model.kinds[ident] == "ring_gear":
        if table.get("profile_shift", 0.0) != 0.0:
            raise InputError(
                f"component {ident} ({model.names[ident]}) is a ring gear with profile shift {table['profile_shift']:g}: REXS does not say its sign, "
                f"and programs differ; a design file with internal = true would be right ({SHIFT_BY_ISO})"
            )
        table["internal"] = True
        table.pop("rack_tip_radius", None)
    return table


def _gear(model: Model, ident: str) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for key, name in (
        ("module", "normal_module"), ("helix_angle", "helix_angle_reference_diameter"), ("face_width", "face_width"),
        ("tip_diameter", "tip_diameter"), ("root_diameter", "root_diameter"), ("bore_diameter", "inner_diameter"),
        ("end_chamfer", "chamfer_at_tooth_end"),
    ):  # fmt: skip
        value = model.number(ident, name)
        if value is not None:
            table[key] = value
    teeth = model.number(ident, "number_of_teeth")
    if teeth is not None:
        table["teeth"] = int(teeth) if teeth == int(teeth) else teeth
    for diameter in ("tip_diameter", "root_diameter"):
        if table.get(diameter, math.inf) < LEAST_TIP * table.get("module", 0.0) * (teeth or 0.0):
            del table[diameter]
    pairs = [(side, ids[side]) for ids in model.partners("flank", "gear", ident) for side in ("left", "right") if side in ids]
    flanks = [flank for _, flank in pairs]
    for key, name in (
        ("pressure_angle", "normal_pressure_angle"), ("profile_shift", "addendum_modification_coefficient"),
        ("tip_chamfer", "tooth_tip_chamfer"),
    ):  # fmt: skip
        values = {value for flank in flanks if (value := model.number(flank, name)) is not None}
        if len(values) > 1:
            raise InputError(
                f"{model.said(ident)}: {name} differs between its flanks ({sorted(values)}): one for both would be right"
            )
        if values:
            table[key] = values.pop()
    drawn = {side: flank_keys(model, flank, table.get("tip_diameter")) for side, flank in pairs}
    if len(drawn) == 2 and drawn["left"] == drawn["right"]:
        table |= drawn["left"]
    else:
        table |= {side: keys for side, keys in drawn.items() if keys}
    steps = [ids for flank in flanks for ids in model.partners("manufacturing_step", "workpiece", flank)]
    tools = {ids.get("tool", "") for ids in steps}
    racks = [tool for tool in tools if model.kinds.get(tool) == "rack_shaped_tool"]
    if len(racks) == 1:
        dedendum = model.number(racks[0], "addendum_coefficient_reference_profile")
        if dedendum is not None and "root_diameter" not in table:
            table["dedendum"] = dedendum
        for name in TIP_RADIUS_FACTORS:
            tip = model.number(racks[0], name)
            if tip is not None:
                table["rack_tip_radius"] = tip
        settings = [*flanks, *(ids.get("manufacturing_settings", "") for ids in steps)]  # 1.0 had the stock on the flank
        table |= tool_keys(model, racks, settings, table.get("module", 0.0))
    return table
