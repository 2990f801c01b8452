"""Ring gears of REXS models. The numbers of the stage are those of the FVA's published planetary stage (fva-net/rexs-api-java, version 1.1):
22 and 61 teeth, module 4, 50 mm wide, no profile shift, centre distance 78 mm = (61 − 22) · 4 / 2."""

from __future__ import annotations

import pytest

from gearwear.design.files.rexs import parse_rexs
from gearwear.design.files.toml import parse_design
from gearwear.errors import InputError

STAGE = """<model version="1.1" applicationId="test">
  <relations>
    <relation id="1" type="stage"><ref role="gear_2" id="58"/><ref role="stage" id="220"/><ref role="gear_1" id="247"/></relation>
    <relation id="2" type="flank"><ref role="gear" id="58"/><ref role="left" id="1"/><ref role="right" id="2"/></relation>
  </relations>
  <components>
    <component id="220" type="cylindrical_stage" name="stage"><attribute id="center_distance" unit="mm">78.0</attribute></component>
    <component id="247" type="cylindrical_gear" name="planet">
      <attribute id="number_of_teeth" unit="none">22</attribute><attribute id="normal_module" unit="mm">4.0</attribute>
      <attribute id="helix_angle_reference_diameter" unit="°">-0.0</attribute><attribute id="face_width" unit="mm">50.0</attribute>
      <attribute id="tip_diameter" unit="mm">95.2</attribute>
    </component>
    <component id="58" type="ring_gear" name="ring">
      <attribute id="number_of_teeth" unit="none">61</attribute><attribute id="normal_module" unit="mm">4.0</attribute>
      <attribute id="helix_angle_reference_diameter" unit="°">0.0</attribute><attribute id="face_width" unit="mm">50.0</attribute>
      <attribute id="tip_diameter" unit="mm">238.0</attribute>
    </component>
    <component id="1" type="cylindrical_gear_flank"><attribute id="addendum_modification_coefficient" unit="none">{shift}</attribute></component>
    <component id="2" type="cylindrical_gear_flank"><attribute id="addendum_modification_coefficient" unit="none">{shift}</attribute></component>
  </components>
</model>"""


def test_a_stage_with_a_ring_is_a_pair_with_its_pinion_inside():
    design = parse_design(parse_rexs(STAGE.format(shift="0.0").encode()))
    pinion, ring = design.gears["pinion"], design.gears["gear"]
    assert (pinion.teeth, ring.teeth, ring.spec.internal, pinion.spec.internal) == (22, 61, True, False)
    assert design.centre_distance == 78.0 == pytest.approx(ring.reference_radius - pinion.reference_radius)
    assert ring.tip_radius == pytest.approx(119.0)  # inside the reference circle, 122 mm
    assert ring.spec.addendum == pytest.approx(0.75)
    assert not ring.root_stated and design.warnings


def test_a_ring_alone_is_read_too():
    text = STAGE.format(shift="0.0").replace('type="stage"', 'type="assembly"')
    table = parse_rexs(text.replace('<component id="247" type="cylindrical_gear"', '<component id="247" type="shaft"').encode())
    assert table["gear"]["internal"] is True and "pinion" not in table


def test_a_shift_whose_sign_nobody_states_is_refused_by_name():
    with pytest.raises(
        InputError, match=r"component 58 \(ring\) is a ring gear with profile shift 0.2: REXS does not say its sign"
    ):
        parse_rexs(STAGE.format(shift="0.2").encode())


def test_two_rings_do_not_mesh():
    text = STAGE.format(shift="0.0").replace(
        '<component id="247" type="cylindrical_gear"', '<component id="247" type="ring_gear"'
    )
    with pytest.raises(InputError, match="the ring of a pair is its"):
        parse_design(parse_rexs(text.replace("95.2", "84.0").encode()))
