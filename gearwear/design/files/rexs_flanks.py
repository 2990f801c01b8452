"""A REXS model, and what it says of a flank beyond the involute: modifications, tip chamfer, protuberance of the tool, stock.

The structure is that of the official schema, REXS 1.4 to 1.7 (FVA, github.com/fva-net/rexs-api-java, ``rexs_schema_1.7.xml``): a relation
``reference`` leads from a ``cylindrical_gear_flank`` to each of its modifications, a ``manufacturing_step`` to tool and settings. What the
schema leaves open is refused where it counts: the signs of ``profile_slope`` and ``helix_slope``, and amounts stated elsewhere than at tip
circle and form circle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from gearwear.errors import InputError

UNITS = {
    "mm": 1.0, "m": 1000.0, "mum": 1e-3, "deg": 1.0, "°": 1.0, "rad": math.degrees(1.0), "none": 1.0, "": 1.0,
}  # fmt: skip
RELIEFS = {"tip_relief": "tip", "root_relief": "root"}
ENDS = {"end_relief_datum_face": "datum_face", "end_relief_non_datum_face": "non_datum_face"}
CROWNINGS = {
    "profile_crowning": ("profile_crowning_at_root", "profile_crowning_at_tip", "profile_highest_point"),
    "helix_crowning": ("helix_crowning_amount_datum_face", "helix_crowning_amount_non_datum_face", "helix_highest_point"),
}
"""The two amounts of a crowning, and the place where a model may put its highest point."""
SLOPES = ("profile_slope", "helix_slope")
DEVIATIONS = ("profile_deviation", "helix_deviation")
"""How a flank was found to be: no part of its design."""
SAME = 1e-6
"""mm within which two statements are one."""


@dataclass(frozen=True, slots=True)
class Model:
    """A REXS model: components by their id with their attributes, and the relations by type: the ids by role."""

    kinds: dict[str, str]
    names: dict[str, str]
    attributes: dict[str, dict[str, tuple[str, str]]]
    relations: list[tuple[str, dict[str, str]]]

    def number(self, component: str, name: str) -> float | None:
        """A scalar in mm or degrees; None where it is not there."""
        if name not in self.attributes.get(component, {}):
            return None
        text, unit = self.attributes[component][name]
        where = f"{self.said(component)}: {name} = {text[:40]}"
        if unit not in UNITS:
            raise InputError(f"{where} {unit}: one of {', '.join(known for known in UNITS if known)} would be right")
        try:
            value = float(text) * UNITS[unit]
        except ValueError:
            raise InputError(f"{where}: must be a number") from None
        if not math.isfinite(value):
            raise InputError(f"{where}: must be a finite number")
        return value

    def said(self, component: str) -> str:
        """Component and name, for a message."""
        return f"component {component} ({self.names.get(component, 'not there')})"

    def word(self, component: str, name: str) -> str:
        """A word; "" where it is not there."""
        return self.attributes.get(component, {}).get(name, ("", ""))[0]

    def partners(self, relation: str, role: str, component: str) -> list[dict[str, str]]:
        """Ids by role of the relations of a type in which a component has a role."""
        return [ids for kind, ids in self.relations if kind == relation and ids.get(role) == component]


def flank_keys(model: Model, flank: str, tip_diameter: float | None) -> dict[str, Any]:
    """Modifications of one flank by the keys of a design file.

    Parameters
    ----------
    model : Model
    flank : str
        Id of the ``cylindrical_gear_flank``.
    tip_diameter : float or None
        Of the gear, mm, at which amounts of tip relief may be stated.

    Raises
    ------
    InputError
        If a modification is of a shape that a design file has not, or open in its sign.
    """
    keys: dict[str, Any] = {}
    ends: dict[str, tuple[float, float, str]] = {}
    referenced = [ids.get("referenced", "") for ids in model.partners("reference", "origin", flank)]
    kinds = [model.kinds.get(ident, "") for ident in referenced]
    for ident, kind in zip(referenced, kinds, strict=True):
        if kinds.count(kind) > 1:
            raise InputError(f"{model.said(ident)}: its flank has {kinds.count(kind)} of the kind {kind}; one would be right")
        if kind in RELIEFS:
            keys |= _relief(model, ident, RELIEFS[kind], tip_diameter)
        elif kind in ENDS:
            ends[kind] = _end_relief(model, ident, ENDS[kind])
        elif kind in CROWNINGS:
            keys |= _crowning(model, ident, kind)
        elif kind in SLOPES:
            if model.number(ident, kind):
                raise InputError(
                    f"{model.said(ident)}: REXS does not say the sign of a {kind.replace('_', ' ')}; {kind} in a design file would"
                )
        elif kind not in DEVIATIONS:
            raise InputError(f"{model.said(ident)}: a {kind or 'missing component'} is no modification that is read")
    return keys | _both_ends(model, flank, ends)


def _relief(model: Model, ident: str, end: str, tip_diameter: float | None) -> dict[str, Any]:
    name = f"{end}_relief"
    depth = model.number(ident, f"{name}_depth")
    if not depth:
        return {}
    _no_transition(model, ident)
    start, length = (model.number(ident, f"{name}_datum_{extent}") for extent in ("diameter", "length"))
    stated = model.number(ident, f"{name}_evaluation_reference")
    at_end = stated is None or (end == "tip" and tip_diameter is not None and abs(stated - tip_diameter) < SAME)
    stated_length = model.number(ident, f"{name}_evaluation_reference_length")
    if not at_end or (stated_length is not None and (length is None or abs(stated_length - length) > SAME)):
        where = "the tip circle" if end == "tip" else "the form circle"
        raise InputError(f"{model.said(ident)}: its amount is stated elsewhere than at {where}; there it would be right")
    keys: dict[str, Any] = {name: depth, f"{name}_form": _shape(model, ident, "shape_of_relief", "linear")}
    if start is not None:
        keys[f"{name}_start"] = start
    elif length is not None:
        keys[f"{name}_length"] = length
    return keys


def _end_relief(model: Model, ident: str, face: str) -> tuple[float, float, str]:
    _no_transition(model, ident)
    depth, length = (model.number(ident, f"end_relief_{size}_{face}") or 0.0 for size in ("depth", "length"))
    if model.number(ident, f"end_relief_evaluation_reference_{face}") is not None:
        raise InputError(
            f"{model.said(ident)}: its amount is stated at a coordinate of its own; at the end of the face would be right"
        )
    return depth, length, _shape(model, ident, "shape_of_relief", "linear")


def _both_ends(model: Model, flank: str, ends: dict[str, tuple[float, float, str]]) -> dict[str, Any]:
    """End relief, which a design file has alike at both ends."""
    values = [ends.get(kind, (0.0, 0.0, "")) for kind in ENDS]
    if not any(depth for depth, _, _ in values):
        return {}
    if values[0] != values[1]:
        raise InputError(f"{model.said(flank)}: end relief differs between the ends of the face; alike at both would be right")
    depth, length, shape = values[0]
    return {"end_relief": depth, "end_relief_length": length, "end_relief_form": shape}


def _crowning(model: Model, ident: str, kind: str) -> dict[str, Any]:
    first, second, highest = CROWNINGS[kind]
    amounts = [model.number(ident, name) or 0.0 for name in (first, second)]
    if not any(amounts):
        return {}
    if amounts[0] != amounts[1] or model.number(ident, highest) is not None:
        raise InputError(
            f"{model.said(ident)}: it is not highest in the middle; one amount for both ends and no {highest} would be right"
        )
    _word_of(model, ident, f"shape_of_{kind}", ("parabolic", "circular"), "parabolic")  # so flat a circle is the parabola
    return {kind: amounts[0]}


def _no_transition(model: Model, ident: str) -> None:
    if model.word(ident, "specify_tangential_transition").lower() == "true":
        raise InputError(f"{model.said(ident)}: a tangential transition is not read; false would be right")


def _shape(model: Model, ident: str, name: str, usual: str) -> str:
    return _word_of(model, ident, name, ("linear", "parabolic"), usual)


def _word_of(model: Model, ident: str, name: str, known: tuple[str, ...], usual: str) -> str:
    word = model.word(ident, name) or usual
    if word not in known:
        raise InputError(f"{model.said(ident)}: {name} = {word[:40]}: {' or '.join(known)} would be right")
    return word


def tool_keys(model: Model, tools: list[str], settings: list[str], module: float) -> dict[str, Any]:
    """Protuberance of the hob and the stock that grinding takes, mm and degrees; nothing where the tool has no protuberance.

    Parameters
    ----------
    model : Model
    tools : list of str
        The one rack-shaped tool.
    settings : list of str
        Ids of the manufacturing settings, which hold the stock.
    module : float
        Normal module, mm.
    """
    protuberance = model.number(tools[0], "protuberance_amount")
    factor = model.number(tools[0], "protuberance_amount_factor")
    if protuberance is None and factor is not None:
        protuberance = factor * module
    if not protuberance:
        return {}
    keys = {"protuberance": protuberance}
    stock = max((model.number(ident, "machining_allowance") or 0.0 for ident in settings), default=0.0)
    if stock > 0.0:
        keys["grinding_stock"] = stock
    angle = model.number(tools[0], "protuberance_angle")
    if angle is not None:
        keys["protuberance_angle"] = angle
    return keys
