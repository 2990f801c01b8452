"""Drawing data as a table, and REXS models: the same gear as the TOML that says the same."""

import math

import pytest

from gearwear.design import parse_design, read_design
from gearwear.design.files.rexs import parse_rexs
from gearwear.design.files.table import parse_table
from gearwear.design.files.writing import design_text
from gearwear.errors import InputError

TOML = {"gear": {"teeth": 24, "module": 6.35, "face_width": 15.0, "profile_shift": 0.2, "bore_diameter": 25.4}}


@pytest.mark.parametrize(
    "text",
    [
        "key,value,unit\nteeth,24,\nmodule,6.35,mm\nface_width,15,mm\nprofile_shift,0.2,\nbore_diameter,1,in\n",
        "z;24\nm;6,35;mm\nb;1,5;cm\nx;0,2;-\nbore;25,4;mm\n",
        "# from the drawing\n\nNumber of teeth\t24\t\nNormal module\t6.35\tmm\nFace width\t15\tmm\nx\t1.27\tmm\nbore diameter\t25400\tum\n",
        "gear.teeth, 24\ngear.diametral_pitch, 4, 1/in\ngear.face_width, 15\ngear.x, 0.2, modules\ngear.bore, 25.4\n",
        "gear.teeth,24,,\ngear.m,6.35,mm,\ngear.b,15,mm,\ngear.x,0.2,,\ngear.bore,25.4,mm,\n",
        'bore,1,"\nteeth,24,\nm,0.25,"\nb,15,mm\nx,0.2,\n',
        '"key","value","unit"\n"teeth","24",""\n"m", "0.25", """"\n"b","15","mm"\n"x","0.2"\n"bore","25.4","mm"\n',
        'teeth,24\n# hub, "rev B\nm,6.35,mm\nb,15,mm\n"# tip, root"\nx,0.2\nbore,25.4,mm\n',
    ],
)
def test_tables_say_what_the_toml_says(tmp_path, text):
    file = tmp_path / "drawing.csv"
    file.write_text(text, encoding="utf-8-sig")
    read = read_design(file).gears["gear"]
    wanted = parse_design(TOML).gears["gear"]
    for name in ("teeth", "reference_radius", "tip_radius", "root_radius", "tooth_thickness", "face_width"):
        assert getattr(read, name) == pytest.approx(getattr(wanted, name), rel=1e-12), name
    assert read.spec.bore_diameter == pytest.approx(25.4)


def test_a_pair():
    design = parse_design(
        parse_table(
            "pinion.z,12\npinion.m,3,mm\npinion.alpha,0.3490658503988659,rad\npinion.b,20,mm\npinion.x,0.6\npinion.da,44.84,mm\n"
            "gear.z,24\ngear.x,0.36\ngear.da,79.4\na,56.5,mm\npair.baseline,pre_wear_scan\n"
        )
    )
    assert design.centre_distance == 56.5
    assert design.gears["pinion"].tip_radius == pytest.approx(22.42)
    assert design.gears["gear"].spec.normal_pressure_angle == pytest.approx(0.3490658503988659, rel=1e-12)
    assert design.pair is not None
    assert design.pair.baseline == "pre_wear_scan"


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("teeth,24\nmodule,six,mm", r"line 2: module = six: must be a number"),
        ("teeth,24\nmodule,6.35,kg", r"line 2: module in kg: mm"),
        ("teeth,24\nmodule,nan,mm", r"line 2: .* finite"),
        ("teeth,24\nteeth,25", r"line 2: teeth is given twice"),
        ("teeth,24\nm,2\nx,0.2\nx,0.8,mm", r"line 4: profile_shift is given twice"),
        ("teeth,24\nm,2\nx,0.8,mm\nprofile_shift,0.2", r"line 4: profile_shift is given twice"),
        ("teeth", r"line 1: 1 columns; key, value, unit"),
        ('teeth,24\n# hub, "rev B\n\nmodule,six,mm', r"line 4: module = six: must be a number"),
        ("teeth,24,-,x", r"line 1: 4 columns"),
        ("teeth,24\nx,1.2,mm", r"line 2: profile_shift in mm needs the module"),
        ("wheel.teeth,24", r"line 1: wheel.teeth: pinion., gear., pair."),
        ("teeth,24.5\nmodule,2\nface_width,10", r"\[gear\] teeth = 24.5: must be a whole number"),
        ("teeth,24\nmodule,2\nface_width,10\ncolour,3", r"\[gear\] colour is unknown"),
        ("teeth,24\nP,8,1/in\nface_width,10", r"\[gear\] p is unknown"),
        ("teeth,24\nmodule,2\nface_width,10\ntip_relief,20,kg", "line 4: tip_relief in kg: mm"),
        ("teeth,24\nmodule,2\nface_width,10\ngap,1,kg", "line 4: gap in kg: mm"),
        ("teeth,24\nmodule,2\nface_width,10\nbeta,75,°", "helix_angle = 75 degrees"),
        ("teeth,24\nmodule,2\nface_width,10\ninternal,yes", "lies inside the base circle"),
        ("teeth,24\nmodule,2\nface_width,10\ninternal,maybe", "line 4: internal = maybe"),
        ("# x_mm,y_mm\n0.4107,-13.3190\n0.3895,-13.3211", "line 2: begins with a number: .* a scan stands behind the design"),
        ("", "at least one must be given"),
    ],
)
def test_wrong_tables_are_refused_with_the_line(tmp_path, text, what):
    file = tmp_path / "drawing.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=what) as caught:
        read_design(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


def test_modified_flanks_have_their_unit_in_a_table(tmp_path):
    table, text = tmp_path / "drawing.csv", tmp_path / "design.toml"
    rows = (
        "z,28",
        "Pd,10,1/in",
        "b,0.5,in",
        "OD,3.0,in",
        "tip_relief,18,um",
        "tip_relief_start,2.9,in",
        "tip_relief_form,parabolic",
        "helix_crowning,8,µm",
    )
    table.write_text("\n".join(rows))
    text.write_text(
        "[gear]\nteeth = 28\nmodule = 2.54\nface_width = 12.7\ntip_diameter = 76.2\ntip_relief = 0.018\ntip_relief_start = 73.66\n"
        'tip_relief_form = "parabolic"\nhelix_crowning = 0.008\n'
    )
    assert read_design(table).gears["gear"].spec == read_design(text).gears["gear"].spec


@pytest.mark.parametrize(
    ("diameter", "what"),
    [
        (
            "tip_diameter = 2.75",
            r"tip_diameter = 2.75 mm: cannot be that of this gear; 2.75 inches could: 69.85 mm$",
        ),
        ("root_diameter = 2.2", r"root_diameter = 2.2 mm: .* 2.2 inches could: 55.88 mm$"),
        (
            "tip_diameter = 169.85",
            r"tip_diameter = 169.85 mm: addendum = 16.7 modules: must lie from -2 to 4; check module and teeth too$",
        ),
    ],
)
def test_a_diameter_that_is_not_the_gears_is_refused_by_its_own_name(tmp_path, diameter, what):
    file = tmp_path / "design.toml"
    file.write_text(f"[gear]\nteeth = 20\ndiametral_pitch = 8\nface_width = 19.05\n{diameter}\n")
    with pytest.raises(InputError, match=what):
        read_design(file)


REXS = """<?xml version="1.0" encoding="UTF-8"?>
<model version="1.4" applicationId="test" applicationVersion="1" date="2024-01-01T00:00:00+00:00">
  <relations>
    <relation id="1" type="stage"><ref role="stage" id="10"/><ref role="gear_1" id="12"/><ref role="gear_2" id="11"/></relation>
    <relation id="2" type="flank"><ref role="gear" id="11"/><ref role="left" id="21"/><ref role="right" id="22"/></relation>
    <relation id="3" type="flank"><ref role="gear" id="12"/><ref role="left" id="23"/><ref role="right" id="24"/></relation>
    <relation id="4" type="manufacturing_step" order="1"><ref role="workpiece" id="21"/><ref role="tool" id="31"/></relation>
    <relation id="5" type="manufacturing_step" order="1"><ref role="workpiece" id="22"/><ref role="tool" id="31"/></relation>
  </relations>
  <components>
    <component id="10" type="cylindrical_stage" name="stage"><attribute id="center_distance" unit="mm">56.5</attribute></component>
    <component id="11" type="cylindrical_gear" name="small">
      <attribute id="number_of_teeth" unit="none">12</attribute><attribute id="normal_module" unit="mm">3</attribute>
      <attribute id="face_width" unit="mm">20</attribute><attribute id="tip_diameter" unit="mm">44.84</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">{helix}</attribute>
      <attribute id="support_vector" unit="mm"><array><c>0</c><c>0</c><c>0</c></array></attribute>
    </component>
    <component id="12" type="cylindrical_gear" name="large">
      <attribute id="number_of_teeth" unit="none">24</attribute><attribute id="normal_module" unit="mm">3</attribute>
      <attribute id="face_width" unit="mm">20</attribute><attribute id="tip_diameter" unit="mm">1</attribute>
      <attribute id="root_diameter" unit="mm">66.66</attribute>
    </component>
    <component id="21" type="cylindrical_gear_flank"><attribute id="normal_pressure_angle" unit="deg">20</attribute>
      <attribute id="addendum_modification_coefficient" unit="none">0.6</attribute></component>
    <component id="22" type="cylindrical_gear_flank"><attribute id="normal_pressure_angle" unit="°">20</attribute>
      <attribute id="addendum_modification_coefficient" unit="">{right}</attribute></component>
    <component id="23" type="cylindrical_gear_flank"><attribute id="normal_pressure_angle" unit="deg">20</attribute>
      <attribute id="addendum_modification_coefficient" unit="none">0.34</attribute></component>
    <component id="24" type="cylindrical_gear_flank"/>
    <component id="31" type="rack_shaped_tool"><attribute id="addendum_coefficient_reference_profile" unit="none">1.25</attribute>
      <attribute id="tip_radius_factor" unit="none">0.25</attribute></component>
  </components>
</model>
"""


def rexs(tmp_path, text, name="model.rexs"):
    file = tmp_path / name
    file.write_text(text, encoding="utf-8-sig")
    return file


def test_a_rexs_stage(tmp_path):
    for name in ("model.rexs", "model.xml"):
        design = read_design(rexs(tmp_path, REXS.format(helix="0", right="0.6"), name))
        pinion, gear = design.gears["pinion"], design.gears["gear"]
        assert (pinion.teeth, gear.teeth, design.centre_distance) == (12, 24, 56.5)
        assert (pinion.spec.profile_shift, gear.spec.profile_shift) == (0.6, 0.34)
        assert pinion.tip_radius == pytest.approx(22.42)
        assert gear.tip_radius == pytest.approx(3 * (12 + 1 + 0.34))  # a tip diameter of 1 mm is a placeholder
        assert gear.root_radius == pytest.approx(33.33)
        assert (pinion.spec.rack_tip_radius, pinion.spec.dedendum) == (0.25, 1.25)
        assert gear.spec.rack_tip_radius == 0.30


def test_a_helical_gear_from_a_table(tmp_path):
    file = tmp_path / "drawing.csv"
    text = (
        "pinion.z;17;-\npinion.mn;2,5;mm\npinion.beta;0,3490658503988659;rad\npinion.b;18;mm\npinion.hf*;3,125;mm\ngear.z;31;-\n"
    )
    file.write_text(text)
    design = read_design(file)
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    assert math.degrees(pinion.helix_angle) == pytest.approx(20.0)
    assert gear.helix_angle == pytest.approx(-pinion.helix_angle)
    assert (pinion.normal_module, pinion.spec.dedendum) == (2.5, pytest.approx(1.25))
    file.write_text(
        text.replace(
            "pinion.mn;2,5", f"pinion.mt;{2.5 / math.cos(math.radians(20.0))!r}".replace(".", ",").replace("pinion,", "pinion.")
        )
    )
    assert read_design(file).gears["pinion"].normal_module == pytest.approx(2.5, rel=1e-12)
    assert read_design(file).gears["pinion"].spec.dedendum == pytest.approx(1.25, rel=1e-12)


def test_a_helical_rexs_stage(tmp_path):
    """Small gear right hand 15°; the large one says nothing and has the other hand. Diameters are of the transverse section."""
    text = (
        REXS.format(helix="15", right="0.6")
        .replace('unit="mm">44.84', 'unit="mm">46.2')
        .replace('unit="mm">66.66', 'unit="mm">68.6')
    )
    design = read_design(rexs(tmp_path, text.replace('unit="mm">56.5', 'unit="mm">58.4')))
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    assert (math.degrees(pinion.helix_angle), math.degrees(gear.helix_angle)) == pytest.approx((15.0, -15.0))
    assert (pinion.tip_radius, gear.root_radius) == pytest.approx((23.1, 34.3))
    assert pinion.reference_radius == pytest.approx(0.5 * 12 * 3.0 / math.cos(math.radians(15.0)))


@pytest.mark.parametrize(("share", "taken"), [(0.49, False), (0.51, True)])
@pytest.mark.parametrize("name", ["tip_diameter", "root_diameter"])
def test_a_diameter_below_half_the_reference_diameter_is_a_placeholder(name, share, taken):
    """Reference diameter of the large gear: 24 · 3 mm. Above the half it is taken, however unlikely: the design's own checks then refuse it."""
    text = REXS.format(helix="0", right="0.6")
    given = {"tip_diameter": 'tip_diameter" unit="mm">1<', "root_diameter": 'root_diameter" unit="mm">66.66<'}[name]
    table = parse_rexs(text.replace(given, f'{name}" unit="mm">{share * 72.0}<').encode())["gear"]
    assert table.get(name) == (pytest.approx(share * 72.0) if taken else None)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (REXS.format(helix="0", right="0.5"), "differs between its flanks"),
        (REXS.format(helix="0", right="0.6").replace("cylindrical_gear\" name=\"small", "ring_gear\" name=\"small"), "ring gear"),
        (REXS.format(helix="0", right="0.6").replace('unit="mm">3<', 'unit="parsec">3<'), "normal_module = 3 parsec"),
        (REXS.format(helix="0", right="0.6").replace('unit="mm">3<', 'unit="mm">three<'), "normal_module = three: must be a number"),
        (REXS.format(helix="0", right="0.6").replace('role="gear_2" id="11"', 'role="gear_2" id="31"'), "two cylindrical gears"),
        ("<model version='1.4'><components/></model>", "no cylindrical gear"),
        ("<gear/>", "not a REXS model"),
        ("<model", "not XML"),
    ],
)  # fmt: skip
def test_what_rexs_models_cannot_be(tmp_path, text, what):
    with pytest.raises(InputError, match=what) as caught:
        read_design(rexs(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_several_stages_are_refused_by_name(tmp_path):
    text = REXS.format(helix="0", right="0.6").replace(
        "<relations>",
        '<relations><relation id="9" type="stage"><ref role="stage" id="10"/><ref role="gear_1" id="11"/><ref role="gear_2" id="12"/></relation>',
    )
    with pytest.raises(InputError, match=r"2 stages \(stage, stage\)"):
        read_design(rexs(tmp_path, text))


def test_a_ring_from_a_table(tmp_path):
    file = tmp_path / "ring.csv"
    file.write_text(
        "internal,yes\nz,60\nmn,2,mm\nbeta,-15,deg\nb,16,mm\nx,0.1\nda,121.2,mm\nz0,20\ncutter_tip_radius,0.2,mm\nrim diameter,5.6,in\n"
    )
    ring = read_design(file).gears["gear"]
    assert (ring.spec.internal, ring.spec.cutter_teeth, ring.spec.cutter_tip_radius) == (True, 20, pytest.approx(0.1))
    assert (2 * ring.tip_radius, 2 * ring.body_radius) == pytest.approx((121.2, 142.24))


def test_a_ring_written_as_a_design_file_reads_back(tmp_path):
    table = {"teeth": 60, "module": 2.0, "face_width": 16.0, "internal": True, "helix_angle": 15.0, "profile_shift": 0.1}
    for more in ({"cutter_teeth": 20, "cutter_tip_radius": 0.1, "rim_diameter": 150.0}, {"fillet_radius": 0.4}, {}):
        spec = parse_design({"gear": {**table, **more}}).gears["gear"].spec
        file = tmp_path / "ring.toml"
        file.write_text(design_text(spec))
        assert read_design(file).gears["gear"].spec == spec
