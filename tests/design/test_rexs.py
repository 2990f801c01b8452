"""REXS models: what is written is read back, by names and relations that the official schema has."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from gearwear.commands.models import main
from gearwear.design import Design, Gear, GearSpec, PairSpec, read_design
from gearwear.design.files.rexs import parse_rexs
from gearwear.design.files.rexs_writing import rexs_text
from gearwear.design.files.toml import parse_design
from gearwear.design.files.writing import design_text
from gearwear.design.modification import FlankModification
from gearwear.errors import InputError

DRAWN = FlankModification(
    tip_relief=0.02, tip_relief_length=2.5, root_relief=0.01, root_relief_start=73.9, root_relief_form="parabolic", profile_crowning=0.004,
    helix_crowning=0.01, end_relief=0.015, end_relief_length=2.0, end_relief_form="parabolic",
)  # fmt: skip
RELIEVED = FlankModification(tip_relief=0.02, tip_relief_length=2.5)
SPEC = GearSpec(
    "gear", 25, 3.0, 20.0, profile_shift=0.25, dedendum=1.4, protuberance=0.15, grinding_stock=0.1, protuberance_angle=math.radians(8.0),
    bore_diameter=30.0, tip_chamfer=0.2, left=DRAWN, right=replace(DRAWN, tip_relief=0.03),
)  # fmt: skip

# Of rexs_schema_1.4.xml (FVA, Apache 2.0): attributes of each component, with their units, and what a relation joins.
ATTRIBUTES = {
    "cylindrical_stage": {"center_distance": "mm"},
    "cylindrical_gear": {
        "number_of_teeth": "none", "normal_module": "mm", "helix_angle_reference_diameter": "deg", "face_width": "mm",
        "tip_diameter": "mm", "root_diameter": "mm", "inner_diameter": "mm", "chamfer_at_tooth_end": "mm",
    },
    "cylindrical_gear_flank": {
        "normal_pressure_angle": "deg", "addendum_modification_coefficient": "none", "tooth_tip_chamfer": "mm",
    },
    "rack_shaped_tool": {
        "normal_module": "mm", "normal_pressure_angle": "deg", "addendum_coefficient_reference_profile": "none",
        "tip_radius_factor": "none", "protuberance_amount": "mm", "protuberance_angle": "deg",
    },
    "cylindrical_gear_manufacturing_settings": {"machining_allowance": "mm"},
    "tip_relief": {"tip_relief_depth": "mm", "tip_relief_datum_length": "mm", "tip_relief_datum_diameter": "mm", "shape_of_relief": "none"},
    "root_relief": {
        "root_relief_depth": "mm", "root_relief_datum_length": "mm", "root_relief_datum_diameter": "mm", "shape_of_relief": "none",
    },
    "profile_crowning": {"profile_crowning_at_root": "mm", "profile_crowning_at_tip": "mm"},
    "helix_crowning": {"helix_crowning_amount_datum_face": "mm", "helix_crowning_amount_non_datum_face": "mm"},
    "end_relief_datum_face": {"end_relief_depth_datum_face": "mm", "end_relief_length_datum_face": "mm", "shape_of_relief": "none"},
    "end_relief_non_datum_face": {
        "end_relief_depth_non_datum_face": "mm", "end_relief_length_non_datum_face": "mm", "shape_of_relief": "none",
    },
}  # fmt: skip
JOINED = {
    "stage": {"stage": {"cylindrical_stage"}, "gear_1": {"cylindrical_gear"}, "gear_2": {"cylindrical_gear"}},
    "flank": {"gear": {"cylindrical_gear"}, "left": {"cylindrical_gear_flank"}, "right": {"cylindrical_gear_flank"}},
    "manufacturing_step": {
        "workpiece": {"cylindrical_gear_flank"}, "tool": {"rack_shaped_tool"},
        "manufacturing_settings": {"cylindrical_gear_manufacturing_settings"},
    },
    "reference": {
        "origin": {"cylindrical_gear_flank"},
        "referenced": {
            "tip_relief", "root_relief", "profile_crowning", "helix_crowning", "end_relief_datum_face", "end_relief_non_datum_face",
        },
    },
}  # fmt: skip


def _design(spec: GearSpec = SPEC) -> Design:
    return Design({"gear": Gear.from_spec(spec)}, None)


def _pair() -> Design:
    pinion = GearSpec(
        "pinion", 17, 2.5, 18.0, profile_shift=0.3, helix_angle=math.radians(15.0), left=DRAWN_PINION, right=DRAWN_PINION
    )
    gear = GearSpec("gear", 40, 2.5, 18.0, helix_angle=math.radians(-15.0), end_chamfer=0.5)
    return Design({"pinion": Gear.from_spec(pinion), "gear": Gear.from_spec(gear)}, pair=PairSpec(centre_distance=74.6))


DRAWN_PINION = FlankModification(tip_relief=0.015, tip_relief_length=2.0, helix_crowning=0.008)


@pytest.mark.parametrize("design", [_design(), _pair()], ids=["gear", "pair"])
def test_what_is_written_is_read_back(design):
    back = parse_design(parse_rexs(rexs_text(design).encode()))
    for part, gear in design.gears.items():
        read = back.gears[part].spec
        assert (read.left, read.right) == (gear.spec.left, gear.spec.right)
        for key in (
            "teeth", "normal_module", "face_width", "normal_pressure_angle", "profile_shift", "addendum", "dedendum", "rack_tip_radius",
            "bore_diameter", "tip_chamfer", "end_chamfer", "helix_angle", "protuberance", "grinding_stock",
        ):  # fmt: skip
            assert getattr(read, key) == pytest.approx(getattr(gear.spec, key), rel=1e-12, abs=1e-12), key
        assert back.gears[part].form_radius == pytest.approx(gear.form_radius, rel=1e-12)
    if design.pair is not None:
        assert back.centre_distance == design.centre_distance


@pytest.mark.parametrize("design", [_design(), _pair()], ids=["gear", "pair"])
def test_names_units_and_relations_are_those_of_the_schema(design):
    model = ElementTree.fromstring(rexs_text(design))
    assert (model.tag, model.get("version")) == ("model", "1.4")
    kinds = {}
    for component in model.iterfind("components/component"):
        kind = kinds[component.get("id")] = component.get("type")
        for attribute in component:
            assert ATTRIBUTES[kind][attribute.get("id")] == attribute.get("unit")
    for relation in model.iterfind("relations/relation"):
        for ref in relation:
            assert kinds[ref.get("id")] in JOINED[relation.get("type")][ref.get("role")]
        assert (relation.get("order") is not None) == (relation.get("type") == "manufacturing_step")
        assert len(relation) == len(JOINED[relation.get("type")])


def _with(kind: str, attributes: str) -> bytes:
    """The gear's model with one modification of the left flank in place of its tip relief."""
    text = rexs_text(_design(replace(SPEC, left=replace(RELIEVED, profile_crowning=0.004))))
    component = re.search(r'<component id="(\d+)" type="tip_relief".*?</component>', text, re.DOTALL)
    assert component is not None
    return text.replace(component[0], f'<component id="{component[1]}" type="{kind}" name="x">{attributes}</component>').encode()


def _mm(name: str, value: float) -> str:
    return f'<attribute id="{name}" unit="mm">{value}</attribute>'


TIP = 2.0 * 3.0 * (12.5 + 1.25)


@pytest.mark.parametrize(
    ("kind", "attributes", "keys"),
    [
        ("tip_relief", '<attribute id="tip_relief_depth" unit="mum">20</attribute>' + _mm("tip_relief_datum_diameter", 80.0),
         {"tip_relief": 0.02, "tip_relief_start": 80.0, "tip_relief_form": "linear"}),
        ("tip_relief", _mm("tip_relief_depth", 0.02) + _mm("tip_relief_datum_length", 2.0) + _mm("tip_relief_evaluation_reference", TIP),
         {"tip_relief": 0.02, "tip_relief_length": 2.0}),
        ("tip_relief", _mm("tip_relief_depth", 0.0), {}),
        ("helix_slope", _mm("helix_slope", 0.0), {}),
        ("profile_deviation", _mm("profile_slope_deviation", 0.01), {}),
    ],
)  # fmt: skip
def test_other_ways_to_say_it(kind, attributes, keys):
    left = parse_rexs(_with(kind, attributes))["gear"]["left"]
    assert {key: left[key] for key in keys} == keys
    assert ("tip_relief" in left) == ("tip_relief" in keys)


@pytest.mark.parametrize(
    ("kind", "attributes", "message"),
    [
        ("helix_slope", _mm("helix_slope", 0.01), "REXS does not say the sign of a helix slope"),
        ("topographical_modification", "", "a topographical_modification is no modification that is read"),
        ("tip_relief", _mm("tip_relief_depth", 0.02) + _mm("tip_relief_evaluation_reference", 80.0), "elsewhere than at the tip circle"),
        ("tip_relief", _mm("tip_relief_depth", 0.02) + '<attribute id="shape_of_relief" unit="none">logarithmic</attribute>',
         "shape_of_relief = logarithmic: linear or parabolic would be right"),
        ("tip_relief", _mm("tip_relief_depth", 0.02) + '<attribute id="specify_tangential_transition" unit="none">true</attribute>',
         "a tangential transition is not read"),
        ("helix_crowning", _mm("helix_crowning_amount_datum_face", 0.02), "not highest in the middle"),
        ("profile_crowning", _mm("profile_crowning_at_root", 0.02), "its flank has 2 of the kind profile_crowning"),
        ("end_relief_datum_face", _mm("end_relief_depth_datum_face", 0.03) + _mm("end_relief_length_datum_face", 2.0),
         "end relief differs between the ends"),
    ],
)  # fmt: skip
def test_what_a_design_file_has_not_is_refused_by_name(kind, attributes, message):
    with pytest.raises(InputError, match=re.escape(message)) as refused:
        parse_rexs(_with(kind, attributes))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (replace(SPEC, thinning=0.05), "thinning = 0.05"),
        (replace(SPEC, left=FlankModification(helix_slope=0.01)), "helix_slope = 0.01 mm: REXS does not say its sign"),
        (GearSpec("gear", 60, 2.0, 20.0, internal=True), "external gears only; leave it out"),
    ],
)
def test_what_rexs_has_no_place_for_is_refused(spec, message):
    with pytest.raises(InputError, match=re.escape(message)):
        rexs_text(_design(spec))


def test_version_2_has_another_name_for_the_tip_radius():
    text = rexs_text(_design()).replace("tip_radius_factor", "tip_corner_radius_factor_reference_profile")
    assert parse_rexs(text.encode())["gear"]["rack_tip_radius"] == pytest.approx(0.3)


def test_models_write_it(tmp_path, capsys):
    design = tmp_path / "design.toml"
    design.write_text("[gear]\nteeth = 12\nmodule = 2\nface_width = 5\n")
    assert main([str(design), "--rexs", "--out", str(tmp_path / "out")]) == 0
    assert "design.rexs" in capsys.readouterr().out
    assert read_design(tmp_path / "out" / "design.rexs").gears["gear"].spec == read_design(design).gears["gear"].spec


def test_a_tip_chamfer_of_unequal_legs_is_not_written_as_one_of_equal_legs():
    spec = GearSpec("gear", 24, 3.0, 20.0, tip_chamfer=0.4, tip_chamfer_land=0.3)
    for write in (design_text, lambda spec: rexs_text(_design(spec))):
        with pytest.raises(InputError, match=r"tip_chamfer_land = 0.3 mm: .* has one leg"):
            write(spec)
        assert "0.4" in write(replace(spec, tip_chamfer_land=0.4))
    with pytest.raises(InputError, match="tip_chamfer_land without tip_chamfer"):
        replace(spec, tip_chamfer=0.0)
