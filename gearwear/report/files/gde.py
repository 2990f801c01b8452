"""Inspection results as XML in the main parts of the Gear Data Exchange format: a draft, not a GDE file.

VDI/VDE 2610:2014 divides gear data into identification, geometry and inspection, and tells left from right flanks as seen from the datum
face: that much is published and followed here. The names of its elements are not known to this project; those used are its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from gearwear.inspection.inspection import Inspection
from gearwear.report.records.inspection import as_dict

NOTE = (
    " Structure approximated, not checked against the schema: the main parts are those of VDI/VDE 2610 (GDE), the names of the elements are not. "
    "A GDE reader will not take this file as it is. "
)
UNITS = {"mm": "mm", "um": "µm", "deg": "deg"}


def write_gde(path: Path, inspection: Inspection, part: str, files: Sequence[str]) -> None:
    """Write an inspection as XML.

    Parameters
    ----------
    path : Path
    inspection : Inspection
    part : str
        "pinion" or "gear".
    files : sequence of str
        The scan's files.
    """
    root = Element("gear_data_exchange_draft", {"structure": "approximated", "after": "VDI/VDE 2610", "generator": "gearwear"})
    root.append(ElementTree.Comment(NOTE))
    data = SubElement(root, "gear_data")
    identification = SubElement(data, "identification")
    SubElement(identification, "part").text = part
    for file in files:
        SubElement(identification, "source").text = Path(file).name
    _geometry(SubElement(data, "geometry"), inspection)
    measured = SubElement(data, "inspection")
    conditions = SubElement(measured, "conditions")
    SubElement(conditions, "datum_face").text = "upper end (z = face width), seen from +z: left is counter-clockwise of its tooth"
    record = as_dict(inspection)
    _add(conditions, "method", "optical scan, areal")
    for name in ("standard", "noise_um", "coverage_factor", "points"):
        _add(conditions, name, record[name])
    results = SubElement(measured, "results")
    for name in ("class", "required_class", "findings", "profile", "helix", "pitch", "runout", "dimensions"):
        _add(results, name, record[name])
    for note in inspection.notes:
        SubElement(measured, "note").text = note
    ElementTree.indent(root, " ")
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _geometry(parent: Element, inspection: Inspection) -> None:
    gear = inspection.gear
    spec = gear.spec
    values: dict[str, Any] = {
        "number_of_teeth": gear.teeth, "normal_module_mm": spec.normal_module, "helix_angle_deg": 0,
        "normal_pressure_angle_deg": math.degrees(spec.normal_pressure_angle), "profile_shift_coefficient": spec.profile_shift,
        "face_width_mm": gear.face_width, "tip_diameter_mm": 2.0 * gear.tip_radius, "root_diameter_mm": 2.0 * gear.root_radius,
        "form_diameter_mm": 2.0 * gear.form_radius, "base_diameter_mm": 2.0 * gear.base_radius,
        "tooth_thickness_mm": gear.tooth_thickness,
    }  # fmt: skip
    for name, value in values.items():
        _add(parent, name, round(value, 9))


def _add(parent: Element, name: str, value: Any) -> None:
    """An element for a value; a unit at the end of the name becomes its attribute, what was not seen is left out."""
    if value is None:
        return
    stem, _, unit = name.rpartition("_")
    known = unit in UNITS and stem
    element = SubElement(parent, stem if known else name, {"unit": UNITS[unit]} if known else {})
    if isinstance(value, Mapping):
        # A measured number: its uncertainty as an attribute.
        if "value" in value:
            element.text = str(value["value"])
            element.attrib |= {key: str(item) for key, item in value.items() if key != "value" and item is not None}
            return
        for key, item in value.items():
            _add(element, str(key), item)
    elif isinstance(value, list) and all(isinstance(item, int | float) for item in value):
        element.text = " ".join(str(item) for item in value)
    elif isinstance(value, list):
        parent.remove(element)
        for item in value:
            _add(parent, name.removesuffix("s"), item)
    else:
        element.text = str(value)
