"""A tip rounded by an arc: tangent to flank and tip circle, by constructions that share nothing with the closed form."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwear.brep.outline import tooth_edges
from gearwear.brep.solid import gear_solid
from gearwear.design import Gear, GearSpec
from gearwear.design.files.toml import parse_design, parse_toml
from gearwear.design.files.writing import design_text
from gearwear.design.modification import FlankModification
from gearwear.design.surface import FLANK, OTHER, TIP, locate
from gearwear.errors import InputError
from gearwear.inspection.ranges import helix_range


def _spec(teeth: int = 25, **values) -> GearSpec:
    return GearSpec("gear", teeth, 3.0, 20.0, **{"tip_rounding": 0.4, **values})


SPREAD = {
    "spur": _spec(),
    "few teeth": _spec(11, profile_shift=0.2),
    "helical": _spec(helix_angle=math.radians(20.0)),
    "ring": _spec(60, internal=True, rim_diameter=210.0),
}
EACH = pytest.mark.parametrize("spec", SPREAD.values(), ids=SPREAD.keys())


def _flank(gear: Gear, roll: float) -> tuple[np.ndarray, np.ndarray]:
    """Point and outward normal of the left flank of the tooth on +x, by the involute's own definition (a taut string)."""
    tau = gear.base_half_angle - gear.orientation * roll / gear.base_radius
    normal = np.array([-math.sin(tau), math.cos(tau)])
    return gear.base_radius * np.array([math.cos(tau), math.sin(tau)]) + gear.orientation * roll * normal, normal


@EACH
def test_the_arc_is_tangent_to_flank_and_tip_circle(spec):
    """The circle of radius ρ that is rolled up the flank until it touches the tip circle from within."""
    gear = Gear.from_spec(spec)

    def gap(roll: float) -> float:
        point, normal = _flank(gear, roll)
        return gear.orientation * (gear.tip_radius - float(np.hypot(*(point - spec.tip_rounding * normal)))) - spec.tip_rounding

    sharp = math.sqrt(gear.tip_radius**2 - gear.base_radius**2)
    touching = brentq(gap, *sorted((sharp, sharp - gear.orientation * 3.0)), xtol=1e-14)
    point, normal = _flank(gear, touching)
    centre = point - spec.tip_rounding * normal
    assert gear.tip_roll == pytest.approx(touching, abs=1e-11)
    assert gear.tip_half_angle == pytest.approx(math.atan2(centre[1], centre[0]), abs=1e-12)
    arc = gear.tip_arc
    assert arc is not None
    places = arc.points(np.linspace(0.0, 1.0, 11))
    np.testing.assert_allclose(places[0], point, atol=1e-11)
    np.testing.assert_allclose(np.hypot(*(places - centre).T), spec.tip_rounding, atol=1e-11)
    assert np.hypot(*places[-1]) == pytest.approx(gear.tip_radius, abs=1e-12)


@EACH
def test_area_by_the_polygon(spec):
    gear = Gear.from_spec(spec)
    sharp = Gear.from_spec(GearSpec(**{**{name: getattr(spec, name) for name in spec.__slots__}, "tip_rounding": 0.0}))
    rolls = np.linspace(gear.tip_roll, sharp.tip_roll, 4001)
    flank = np.array([_flank(gear, float(roll))[0] for roll in rolls])
    land_angles = np.linspace(float(sharp.tip_half_angle), gear.tip_half_angle, 4001)
    land = gear.tip_radius * np.column_stack([np.cos(land_angles), np.sin(land_angles)])
    assert gear.tip_arc is not None
    outline = np.concatenate([flank, land[1:], gear.tip_arc.points(np.linspace(1.0, 0.0, 4001))[1:]])
    x, y = outline.T
    corner = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    assert sharp.section_area() - gear.section_area() == pytest.approx(2.0 * gear.teeth * corner, rel=1e-5)


@pytest.mark.parametrize("name", ["spur", pytest.param("helical", marks=pytest.mark.long)])
def test_the_solid_has_the_rounding(name):
    gear = Gear.from_spec(SPREAD[name])
    solid = gear_solid(gear)
    assert solid.is_valid
    assert solid.volume == pytest.approx(gear.volume, rel=1e-9)
    assert [edge.name for edge in tooth_edges(gear)].count("rounding") == 2


@pytest.mark.long
def test_with_tip_relief_and_with_end_chamfers():
    relieved = FlankModification(tip_relief=0.02, tip_relief_length=2.0)
    for gear in (Gear.from_spec(_spec(left=relieved, right=relieved)), Gear.from_spec(_spec(end_chamfer=0.2))):
        assert gear_solid(gear).is_valid


def test_points_on_the_rounding_are_no_flank():
    gear = Gear.from_spec(SPREAD["spur"])
    assert gear.tip_arc is not None
    arc = gear.tip_arc.points(np.linspace(0.05, 0.95, 9))
    assert (locate(np.column_stack([arc, np.full(9, 10.0)]), gear).surface == OTHER).all()
    land = np.array([[gear.tip_radius, 0.0, 10.0]])
    assert locate(land, gear).surface[0] == TIP


def test_rounded_ends_are_no_flank_and_no_part_of_the_helix():
    gear, plain = (Gear.from_spec(_spec(end_rounding=size)) for size in (1.5, 0.0))
    z = np.array([0.7, 1.4, 10.0, 18.7, 19.5])
    point = np.column_stack([np.tile(_flank(gear, gear.reference_roll)[0], (5, 1)), z])
    assert (locate(point, plain).surface == FLANK).all()
    assert list(locate(point, gear).surface == FLANK) == [False, False, True, False, False]
    assert helix_range(gear).start == pytest.approx(1.5 + min(0.05 * 17.0, 3.0))
    with pytest.raises(InputError, match=r"leaves no rounding on the end face; below 0\.3999 mm it would"):
        gear_solid(gear)


def test_it_reads_back_what_it_wrote():
    assert parse_design(parse_toml(design_text(SPREAD["spur"]).encode())).gears["gear"].spec == SPREAD["spur"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"tip_rounding": -0.1}, "tip_rounding = -0.1 mm"),
        ({"tip_chamfer": 0.2}, "tip_chamfer and tip_rounding are both given"),
        ({"end_chamfer": 0.2, "end_rounding": 0.2}, "end_chamfer and end_rounding are both given"),
        ({"end_rounding": 10.0}, "end_rounding = 10 mm: must be below half the face width"),
        ({"tip_rounding": 2.0}, "tip_rounding = 2 mm leaves no top land"),
        ({"tip_rounding": 30.0}, "its centre lies within the base circle"),
    ],
)
def test_impossible_roundings_are_refused(values, message):
    with pytest.raises(InputError, match=re.escape(message)):
        Gear.from_spec(_spec(**values))
