"""Thickness that a drawing states by a span or over pins: against published dimensions, and against the gauges of the inspection asked back."""

import math

import numpy as np
import pytest

from gearwear.design import parse_design
from gearwear.design.drawn_gauge import DrawnGauge
from gearwear.design.standards import MM_PER_INCH
from gearwear.errors import InputError
from gearwear.inspection.dimensions import over_pins, span

EXTERNAL = {"teeth": 25, "module": 3, "face_width": 40.0, "profile_shift": 0.2}
GEARS = {
    "spur": EXTERNAL,
    "even": {**EXTERNAL, "teeth": 24, "profile_shift": 0.0},
    "helical": {**EXTERNAL, "helix_angle": 18.0},
    "left_hand": {**EXTERNAL, "teeth": 32, "pressure_angle": 14.5, "helix_angle": -25.0},
    "ring": {
        "teeth": 61,
        "module": 2,
        "face_width": 20,
        "internal": True,
        "rim_diameter": 150,
        "profile_shift": 0.1,
        "fillet_radius": 0.5,
    },
}


def built(table, **more):
    return parse_design({"gear": {**table, **more}}).gears["gear"]


@pytest.mark.parametrize("thinning", [-0.05, 0.0, 0.11])
class TestTheThinningComesBack:
    """The inspection's dimension of a gear of known thinning, given as the drawing's."""

    @pytest.mark.parametrize("name", GEARS)
    def test_from_over_pins(self, name, thinning):
        known = over_pins(built(GEARS[name], thinning=thinning))
        gear = built(GEARS[name], over_pins=known.length, pin_diameter=known.diameter)
        assert gear.spec.thinning == pytest.approx(thinning, abs=1e-11)
        assert over_pins(gear, known.diameter).length == pytest.approx(known.length, abs=1e-11)

    @pytest.mark.parametrize("name", sorted(GEARS.keys() - {"ring"}))
    def test_from_a_span(self, name, thinning):
        known = span(built(GEARS[name], thinning=thinning))
        gear = built(GEARS[name], span=known.length, span_teeth=known.teeth)
        assert gear.spec.thinning == pytest.approx(thinning, abs=1e-11)


class TestPublishedDimensions:
    def test_span_of_khk(self):
        """KHK's table of helical gears: m_n 3, β 25°, z 24, x 0.4 has W over 5 teeth of 42.0085 mm without thinning."""
        table = {"teeth": 24, "module": 3, "face_width": 60, "helix_angle": 25, "profile_shift": 0.4}
        assert abs(built(table, span=42.0085, span_teeth=5).spec.thinning) < 1e-4

    def test_over_pins_with_an_odd_number_of_teeth(self):
        """45 teeth of 8 DP with 0.2124 inches of pin 0.2160 measure 5.963727 inches where the arc at the reference circle is 0.2124 inches."""
        table = {"teeth": 45, "diametral_pitch": 8, "face_width": 25}
        gear = built(table, over_pins=5.963727 * MM_PER_INCH, pin_diameter=0.2160 * MM_PER_INCH)
        assert gear.tooth_thickness / MM_PER_INCH == pytest.approx(0.2124, abs=1e-6)


class TestLimits:
    def test_the_middle_is_the_design_and_half_of_them_the_tolerance(self):
        gear = built(EXTERNAL, span=[23.46, 23.42], span_teeth=3)
        assert span(gear, 3).length == pytest.approx(23.44, abs=1e-12)
        thinnest, thickest = (built(EXTERNAL, span=w, span_teeth=3).spec.thinning for w in (23.42, 23.46))
        assert gear.spec.tolerance.thickness == pytest.approx(0.5 * (thinnest - thickest), abs=1e-12)
        assert built(EXTERNAL, span=23.44, span_teeth=3).spec.tolerance.thickness is None

    def test_a_stated_tolerance_stays(self):
        assert built(EXTERNAL, span=[23.42, 23.46], span_teeth=3, tolerance={"thickness": 0.5}).spec.tolerance.thickness == 0.5

    @pytest.mark.parametrize(
        ("values", "kept"),
        [
            ([23.431, 23.449], "kept"),
            ([23.43, 23.455], "neither proven"),
            ([23.411, 23.45], "neither proven"),
            ([23.409, 23.45], "not kept"),
            ([23.43, 23.471], "not kept"),
            ([math.nan, 23.44], "kept"),
            ([math.nan], ""),
        ],
    )
    def test_decision_with_ten_microns_of_uncertainty(self, values, kept):
        gauge = DrawnGauge(low=23.42, high=23.46, teeth=3)
        assert gauge.kept(np.array(values), np.full(len(values), 0.01)) == kept

    def test_one_value_is_no_limit(self):
        assert DrawnGauge(low=23.44, high=23.44, teeth=3).kept(np.array([23.0]), np.array([0.01])) == ""


class TestAnotherShift:
    def test_a_shift_that_was_left_out_is_told(self):
        """W of a gear with x = 0.2 under a drawing without it: the note asks for 0.2."""
        length = span(built(EXTERNAL), 3).length
        (note,) = parse_design({"gear": {**EXTERNAL, "profile_shift": 0.0, "span": length, "span_teeth": 3}}).warnings
        assert "a profile shift of 0.200" in note

    def test_a_usual_thinning_is_not(self):
        length = span(built(EXTERNAL), 3).length
        assert not parse_design({"gear": {**EXTERNAL, "span": length - 0.1, "span_teeth": 3}}).warnings


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"span": 23.44}, "span without span_teeth"),
        ({"span_teeth": 3}, "span_teeth without span"),
        ({"over_pins": 80.0}, "over_pins without pin_diameter: mm"),
        ({"pin_diameter": 5.0}, "pin_diameter without over_pins"),
        ({"span": 23.44, "span_teeth": 3, "thinning": 0.1}, "span and thinning are both given"),
        ({"span": 23.44, "span_teeth": 3, "over_pins": 82.9, "pin_diameter": 5.25}, "span and over_pins are both given"),
        ({"span": 23.44, "span_teeth": 4}, r"span = 23\.44 mm over 4 teeth: cannot be that of this gear; 23\.44 mm over 3 teeth could"),
        ({"span": 0.9228, "span_teeth": 3}, r"in inches, 23\.4391 mm over 3 teeth could"),
        ({"span": 23.44, "span_teeth": 25}, "from 1 to 24 would be right"),
        ({"span": [1.0, 2.0, 3.0], "span_teeth": 3}, "a value or its two limits"),
        ({"span": -3.0, "span_teeth": 3}, "must be above 0"),
        ({"span": 23.44, "span_teeth": 3.0}, "must be a whole number"),
        ({"over_pins": 8.0, "pin_diameter": 5.25}, "no tooth has it"),
        ({"over_pins": 82.9, "pin_diameter": 0.0}, "must be above 0"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_with_what_would_be_right(more, message):
    with pytest.raises(InputError, match=message):
        built(EXTERNAL, **more)


def test_a_ring_has_no_span():
    with pytest.raises(InputError, match="over_pins, between pins, would be right"):
        built(GEARS["ring"], span=23.44, span_teeth=3)
