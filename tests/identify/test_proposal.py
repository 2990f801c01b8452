"""Standard gears from measured dimensions: published gears found again from the numbers that are printed for them."""

import math
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.design import Gear, GearSpec, parse_design
from gearwear.design.files.writing import design_text
from gearwear.design.standards import DIAMETRAL_PITCHES, FIRST_SERIES, SECOND_SERIES, modules_near
from gearwear.errors import InputError
from gearwear.identify.candidates import find_candidates
from gearwear.identify.gauges import Gauge, Helix, Measured
from gearwear.identify.proposal import propose, spec_of
from gearwear.inspection.dimensions import over_pins, span


def gauge(kind, value, at=0.0, std=0.02):
    return Gauge(kind, Measured(value, std), at)


def best(teeth, *gauges, **known):
    return propose(teeth, gauges, **known)[0]


def test_the_papers_pinion_from_its_rounded_diameters():
    found = best(12, gauge("tip_diameter", 89.0, std=0.1), gauge("root_diameter", 60.325, std=0.1))
    assert (found.module.mm, math.degrees(found.pressure_angle)) == pytest.approx((6.35, 20.0))
    assert (found.profile_shift, found.thinning) == (0.0, 0.0)
    assert found.residuals == pytest.approx((0.1, 0.0), abs=1e-9)  # the rounding, which the paper's own table names


def test_a_span_tells_the_module_and_what_remains_is_the_printed_rounding():
    # machinecalcs.com: m = 2, z = 20, k = 3: W = 15.321
    found = best(20, gauge("span", 15.321, 3))
    assert (found.module.mm, math.degrees(found.pressure_angle)) == pytest.approx((2.0, 20.0))
    assert abs(found.residuals[0]) <= 0.0005


def test_two_spans_a_tooth_apart_tell_the_pressure_angle():
    cos = math.cos(math.radians(14.5))
    inv = math.tan(math.radians(14.5)) - math.radians(14.5)
    spans = [2.0 * cos * (math.pi * (k - 0.5) + 30 * inv) for k in (3, 4)]  # ISO 21771 with x = 0
    found = best(30, gauge("span", spans[0], 3, 0.005), gauge("span", spans[1], 4, 0.005))
    assert math.degrees(found.pressure_angle) == pytest.approx(14.5)
    assert found.module.mm == 2.0


def test_a_published_span_of_a_helical_gear():
    """KHK, Technical Reference, span measurement, normal system: m_n 3, α 20°, β 25°, z 24, x 0.4, k 5: W = 42.0085; its tips 6.5 + d."""
    tip = 3.0 * (24 / math.cos(math.radians(25.0)) + 2.8)
    for hand in (1.0, -1.0):
        helix = Helix(hand * math.radians(25.0))
        found = best(
            24,
            gauge("span", 42.0085, 5, 0.005),
            gauge("tip_diameter", tip, std=0.01),
            pressure_angle=math.radians(20),
            helix=helix,
        )
        assert (found.module.mm, found.profile_shift) == (3.0, pytest.approx(0.4, abs=0.002))
        assert spec_of(found, 10.0).helix_angle == helix.angle
        assert found.tip_diameter == pytest.approx(tip, abs=0.02)


@pytest.mark.parametrize("degrees", [-33.0, 12.0, 20.0])
def test_every_dimension_of_a_helical_gear_leads_back_to_it(degrees):
    gear = Gear.from_spec(GearSpec("gear", 27, 2.0, 15.0, profile_shift=0.3, helix_angle=math.radians(degrees)))
    r = gear.reference_radius
    gauges = [
        gauge("tip_diameter", 2 * gear.tip_radius), gauge("root_diameter", 2 * gear.root_radius), gauge("base_pitch", gear.base_pitch, std=1e-3),
        gauge("thickness", gear.tooth_thickness, 2 * r), gauge("span", span(gear).length, span(gear).teeth),
        gauge("over_pins", over_pins(gear, 3.5).length, 3.5),
    ]  # fmt: skip
    known = Helix(gear.base_helix_angle, math.radians(0.01), at_base=True)
    for one in gauges:
        found = best(27, one, module=2.0, pressure_angle=math.radians(20.0), helix=known)
        if one.kind not in ("base_pitch",):  # which depends on no shift
            assert max(map(abs, found.residuals)) < 5e-3, one.kind
    found = best(27, *gauges, helix=known)
    assert (found.module.mm, found.profile_shift, found.thinning) == (2.0, pytest.approx(0.3), 0.0)
    assert math.degrees(found.helix_angle) == pytest.approx(degrees)
    assert max(map(abs, found.residuals)) < 1e-6


def test_a_helix_angle_is_taken_as_drawn_where_the_scan_leaves_room():
    at_base = math.asin(math.sin(math.radians(14.98)) * math.cos(math.radians(20.0)))
    for std, degrees in ((0.02, 15.0), (0.001, 14.98)):
        helix = Helix(at_base, math.radians(std), at_base=True)
        assert math.degrees(helix.at_reference(math.radians(20.0))) == pytest.approx(degrees, abs=1e-9)
    assert Helix(math.radians(59.0), 0.0, at_base=True).at_reference(math.radians(20.0)) is None


def test_over_pins_of_the_papers_pinion():
    # reference value of over-pin dimension: M = 91.171770 with a pin of 1.728 m
    found = best(12, gauge("tip_diameter", 88.9), gauge("over_pins", 91.17177, 1.728 * 6.35))
    assert found.module.mm == pytest.approx(6.35)
    assert found.residuals == pytest.approx((0.0, 0.0), abs=1e-5)


@pytest.mark.parametrize(("teeth", "tip", "root", "shift"), [(12, 44.84, 32.10, 0.6), (24, 79.40, 66.66, 0.36)])
def test_a_published_shifted_gear_with_shortened_tips(teeth, tip, root, shift):
    # bolsover.com: m = 3, z = 12/24, x = 0.6/0.36; the tips are shortened by 0.1267 modules. A span tells it from its neighbours.
    m, alpha, k = 3.0, math.radians(20.0), 2 if teeth == 12 else 3
    inv = math.tan(alpha) - alpha
    length = m * math.cos(alpha) * (math.pi * (k - 0.5) + teeth * inv) + 2.0 * shift * m * math.sin(alpha)
    found = best(teeth, gauge("tip_diameter", tip), gauge("root_diameter", root), gauge("span", length, k))
    assert (found.module.mm, math.degrees(found.pressure_angle)) == pytest.approx((3.0, 20.0))
    assert found.profile_shift == pytest.approx(shift, abs=0.01)
    assert found.shortening == pytest.approx(0.126667, abs=0.02)


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(
    teeth=st.integers(14, 150),
    module=st.sampled_from([m for m in FIRST_SERIES if 0.5 <= m <= 25.0]),
    thinning=st.sampled_from([0.0, 0.05]),
)
def test_dimensions_of_any_standard_gear_lead_back_to_it(teeth, module, thinning):
    gear = Gear.from_spec(GearSpec("gear", teeth, module, 10.0, thinning=thinning * module))
    plates, pins = span(gear), over_pins(gear)
    fine = 1e-4 * module
    gauges = [
        gauge("tip_diameter", 2 * gear.tip_radius, std=fine), gauge("root_diameter", 2 * gear.root_radius, std=fine),
        gauge("span", plates.length, plates.teeth, fine), gauge("over_pins", pins.length, pins.diameter, fine),
        gauge("thickness", gear.tooth_thickness, 2 * gear.reference_radius, fine),
        gauge("base_pitch", gear.base_pitch, std=fine),
    ]  # fmt: skip
    found = best(teeth, *gauges)
    assert found.module.mm == module
    assert math.degrees(found.pressure_angle) == pytest.approx(20.0)
    assert found.profile_shift == pytest.approx(0.0, abs=2e-3)
    assert found.thinning == pytest.approx(thinning * module, abs=max(2e-3 * module, 1e-3))
    # The shift is rounded to 0.001 modules and thinning to 1 µm, as on a drawing: that is all that may remain.
    assert np.abs(found.residuals).max() < 4e-3 * module + 2e-3


def test_what_is_left_adds_up_to_what_was_measured():
    gauges = [gauge("tip_diameter", 88.95), gauge("root_diameter", 60.2), gauge("span", 29.1, 2)]
    for proposal in propose(12, gauges):
        gear = Gear.from_spec(spec_of(proposal, 10.0))
        own = (2 * gear.tip_radius, 2 * gear.root_radius, span(gear, 2).length)
        measured = [one.length.value for one in gauges]
        np.testing.assert_allclose(np.add(own, proposal.residuals), measured, rtol=0, atol=1e-9)


def test_a_coat_and_a_scale_are_told_apart_from_the_gear():
    gear = Gear.from_spec(GearSpec("gear", 24, 4.0, 20.0))
    coat, r = 0.03, gear.reference_radius
    measured = {
        "tip_diameter": 2 * (gear.tip_radius + coat), "root_diameter": 2 * (gear.root_radius + coat),
        "thickness": gear.tooth_thickness + 2 * coat * r / gear.base_radius, "base_pitch": gear.base_pitch,
    }  # fmt: skip
    found = best(24, *(gauge(k, v, 2 * r, 0.002) for k, v in measured.items()), scale_doubt=0.002)
    assert (found.module.mm, found.profile_shift, found.thinning) == (4.0, 0.0, 0.0)
    assert found.coat == pytest.approx(coat, abs=0.002)
    larger = {k: 1.003 * v for k, v in measured.items()}
    found = best(24, *(gauge(k, v, 1.003 * 2 * r, 0.002) for k, v in larger.items()), scale_doubt=0.002)
    assert (found.module.mm, found.profile_shift) == (4.0, 0.0)
    assert found.scale == pytest.approx(0.003, abs=2e-4)


@pytest.mark.parametrize(("shift", "told"), [(0.46, False), (0.54, False), (0.40, True)])
def test_a_shift_between_two_round_ones_is_offered_as_both(shift, told):
    """Tip, thickness and base pitch of 13 teeth by ISO 21771; how well a small gear is scanned leaves the tenths of its shift open, or does not."""
    gear = Gear.from_spec(GearSpec("gear", 13, 0.28, 1.0, profile_shift=shift, addendum=1.0, rack_tip_radius=0.25))
    radius, inv = 2.02, lambda cos: math.tan(math.acos(cos)) - math.acos(cos)
    half = 0.5 * gear.tooth_thickness / gear.reference_radius + inv(math.cos(math.radians(20.0)))
    thickness = 2.0 * radius * (half - inv(gear.base_radius / radius))
    std = 0.001 if told else 0.02
    found = propose(
        13,
        [
            gauge("tip_diameter", 2.0 * gear.tip_radius, std=std),
            gauge("thickness", thickness, 2.0 * radius, std),
            gauge("base_pitch", 2.0 * math.pi * gear.base_radius / 13, std=0.002),
        ],
        scale_doubt=0.001,
    )
    standard = [one.profile_shift for one in found if (one.module.mm, round(math.degrees(one.pressure_angle), 9)) == (0.28, 20.0)]
    assert (found[0].module.mm, found[0].pressure_angle) == pytest.approx((0.28, math.radians(20.0)))
    assert sorted(standard) == pytest.approx([0.4] if told else [0.5, 0.6] if shift > 0.5 else [0.4, 0.5])
    assert [one.cost for one in found] == sorted(one.cost for one in found)
    if not told:
        assert found[1].profile_shift in standard


@pytest.mark.long
def test_what_is_left_out_early_is_not_among_the_best():
    """Asked for all there are, every one is worked out; the first of them are those that are worked out where few are asked for."""
    gear = Gear.from_spec(GearSpec("gear", 23, 2.0, 18.0, math.radians(25.0), profile_shift=0.37))
    gauges = [
        gauge("tip_diameter", 2.0 * gear.tip_radius + 0.03, std=0.02), gauge("root_diameter", 2.0 * gear.root_radius - 0.02, std=0.05),
        gauge("thickness", gear.tooth_thickness - 0.02, 2.0 * gear.reference_radius, 0.02), gauge("base_pitch", gear.base_pitch, std=0.003),
    ]  # fmt: skip
    for scale_doubt in (None, 0.001):
        every, few = (propose(23, gauges, scale_doubt=scale_doubt, most=most) for most in (1000, 4))
        assert len(every) > 20 and few[:4] == every[:4]


def test_a_module_in_no_series_is_offered_last_of_the_likely():
    found = propose(
        20,
        [
            gauge("tip_diameter", 22 * 2.113),
            gauge("root_diameter", 17.5 * 2.113),
            gauge("base_pitch", math.pi * 2.113 * math.cos(math.radians(20)), std=1e-4),
        ],
    )
    assert any("no standard" in proposal.name and proposal.module.mm == pytest.approx(2.113, rel=1e-4) for proposal in found)


def test_the_series_hold_what_the_standards_are_known_for():
    assert {1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0} <= set(FIRST_SERIES)
    assert {2.25, 2.75, 3.5, 4.5, 5.5, 7.0, 9.0} <= set(SECOND_SERIES)
    assert not set(FIRST_SERIES) & set(SECOND_SERIES)
    assert 25.4 / 6.35 in DIAMETRAL_PITCHES
    everything = modules_near(0.1, 50.0)
    assert [one.mm for one in everything] == sorted(one.mm for one in everything)


@pytest.mark.parametrize(
    ("teeth", "gauges", "what"),
    [
        (12, [], "nothing tells the size"),
        (3, [gauge("tip_diameter", 50.0)], "from 5 to 600"),
        (12, [gauge("tip_diameter", -1.0)], "tip diameter = -1 mm"),
        (12, [gauge("tip_diameter", 50.0), gauge("root_diameter", 49.9)], ""),
        (12, [gauge("span", 20.0, 12)], "from 1 to 11"),
        (12, [gauge("span", 20.0, 1.5)], "a whole number"),
        (12, [gauge("span", 20.0, math.inf)], "span over inf teeth: a whole number from 1 to 11 would be right"),
        (12, [gauge("span", 20.0, math.nan)], "span over nan teeth: a whole number from 1 to 11 would be right"),
        (
            12,
            [gauge("over_pins", 20.0, 25.0)],
            "pins of 25 mm with 20 mm over them: a pin above 0 mm and below 20 mm would be right",
        ),
        (12, [gauge("over_pins", 170.0, 0.0)], "pins of 0 mm .* a pin above 0 mm"),
        (12, [gauge("over_pins", 170.0, math.nan)], "pins of nan mm .* a pin above 0 mm"),
    ],
)
def test_what_makes_no_sense_is_refused_or_costs_dearly(teeth, gauges, what):
    if what:
        with pytest.raises(InputError, match=what):
            propose(teeth, gauges)
    else:
        assert best(teeth, *gauges).cost > 30.0


@pytest.mark.parametrize(
    ("known", "what"),
    [
        ({"module": 0.0}, "module 0 mm: from 0.001 to 1000 mm would be right"),
        ({"module": math.nan}, "module nan mm"),
        ({"module": 2e3}, "module 2000 mm"),
        ({"pressure_angle": 20.0}, "pressure angle 1145.92°: from 5 to 45° would be right"),
        ({"pressure_angle": math.nan}, "pressure angle nan°"),
    ],
)
def test_a_module_or_an_angle_that_no_gear_has_is_refused(known, what):
    with pytest.raises(InputError, match=what):
        propose(12, [gauge("tip_diameter", 88.9)], **known)
    with pytest.raises(InputError, match=what):
        find_candidates(np.zeros((3, 3)), **known)  # before the scan is looked at


def test_the_design_that_is_written_is_the_one_that_is_read():
    for spec in (
        GearSpec("pinion", 12, 6.35, 15.0), GearSpec("gear", 31, 0.8, 5.0, math.radians(14.5), 0.213, 0.93, 1.4, 0.2, -0.031, 4.0, 0.05, 0.1),
        GearSpec("gear", 40, 25.4 / 24, 12.7, math.radians(17.5)), GearSpec("gear", 40, 1.0 / 3.0, 12.7),
    ):  # fmt: skip
        (gear,) = parse_design(tomllib.loads(design_text(spec, ["a", ""], {"teeth": "counted"}))).gears.values()
        assert gear.spec.name == spec.name
        for name in GearSpec.__dataclass_fields__:
            if name in ("left", "right") or getattr(spec, name) is None:
                assert getattr(gear.spec, name) == getattr(spec, name)
            elif name not in ("name", "tolerance"):
                assert getattr(gear.spec, name) == pytest.approx(getattr(spec, name), rel=1e-12), name


def test_a_quarter_is_a_round_shift_too():
    """x = 0.25 of an inch gear, by its tip, thickness and base pitch."""
    gear = Gear.from_spec(GearSpec("gear", 25, 25.4 / 8.0, 19.0, profile_shift=0.25, addendum=1.0, rack_tip_radius=0.3))
    found = best(
        25,
        gauge("tip_diameter", 2.0 * gear.tip_radius + 0.01, std=0.02),
        gauge("thickness", gear.tooth_thickness - 0.01, 2.0 * gear.reference_radius, 0.02),
        gauge("base_pitch", 2.0 * math.pi * gear.base_radius / 25, std=0.002),
        scale_doubt=0.001,
    )
    assert found.profile_shift == 0.25


@pytest.mark.parametrize("out", [0.12, -0.12])
def test_tip_and_root_off_alike_bring_the_gear_of_another_shift(out):
    """Both 3 % of a module further out than by a shift of 0.4; either alone is another matter."""
    gear = Gear.from_spec(GearSpec("gear", 23, 4.0, 25.0, profile_shift=0.4))

    def shifts(tip, root, own=0.02):
        scale = 0.001  # as an unknown scanner leaves diameters
        sized = (("tip_diameter", 2.0 * gear.tip_radius + tip), ("root_diameter", 2.0 * gear.root_radius + root))
        found = propose(
            23,
            [
                *(Gauge(kind, Measured(value, math.hypot(scale * value, own), scale)) for kind, value in sized),
                gauge("base_pitch", gear.base_pitch, std=0.03),
            ],
            scale_doubt=0.002,
        )
        return [
            (one.profile_shift, one.cost) for one in found if (one.module.mm, one.pressure_angle) == (4.0, math.radians(20.0))
        ]

    both = shifts(2.0 * out, 2.0 * out)
    assert 0.4 in [shift for shift, _ in both]
    # dr = m dx; a prior of 0.4 draws the shift by less than 0.01 towards 0.
    assert any(shift == pytest.approx(0.4 + out / 4.0, abs=0.01) for shift, _ in both)
    assert [cost for _, cost in both] == sorted(cost for _, cost in both)
    for other in (shifts(2.0 * out, 0.0), shifts(2.0 * out, 2.0 * out, own=0.1)):
        assert not any(shift == pytest.approx(0.4 + out / 4.0, abs=0.01) for shift, _ in other)
