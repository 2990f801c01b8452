"""Double helical solids: both halves against the rack that cuts them, the groove, and a pair in mesh."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from build123d import GeomType, Solid, import_step

from gearwear.brep.outline import rotation
from gearwear.brep.pair import gear_pair, mesh_turn
from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Design, Gear, GearSpec, PairSpec
from gearwear.design.pair import check_pair
from gearwear.errors import InputError
from tests.brep.measuring import face_points, tooth_faces
from tests.brep.rack_in_space import cut_depth
from tests.brep.test_pair import clearance

SPEC = GearSpec("gear", 13, 2.0, 26.0, helix_angle=math.radians(30.0), profile_shift=0.2, bore_diameter=8.0, gap=4.0)


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> tuple[Gear, Solid]:
    gear = Gear.from_spec(SPEC)
    path = tmp_path_factory.mktemp("step") / "gear.step"
    write_step(gear_solid(gear), path)
    return gear, import_step(path)


def halves(points, spec):
    """Points of either half in a frame of its own, with the specification of a gear that is that half."""
    width = 0.5 * (spec.face_width - spec.gap)
    for low, sign in ((0.0, 1.0), (width + spec.gap, -1.0)):
        mine = points[(points[:, 2] > low) & (points[:, 2] < low + width)]
        yield mine - [0.0, 0.0, low], replace(spec, face_width=width, gap=0.0, helix_angle=sign * spec.helix_angle)


def test_either_half_is_what_its_own_rack_leaves(made):
    _, solid = made
    points = np.concatenate([face_points(face, 9) for face in tooth_faces(solid)[::5]])
    seen = 0
    for own, spec in halves(points, SPEC):
        assert np.abs(cut_depth(spec, own)).max() < 1e-9
        seen += len(own)
        assert len(own) > 200
    assert seen == len(points)


@pytest.mark.long
def test_a_valid_solid_of_the_exact_volume(made):
    gear, solid = made
    assert solid.is_valid
    assert len(solid.solids()) == 1
    bore = math.pi * 4.0**2
    groove = (math.pi * gear.groove_radius**2 - bore) * 4.0
    assert gear.groove_radius == pytest.approx(gear.root_radius - 1.0)
    assert solid.volume == pytest.approx(gear.section_area() * 22.0 + groove, rel=1e-10)
    planes = sorted(face.center().Z for face in solid.faces().filter_by(GeomType.PLANE))
    assert planes == pytest.approx([0.0, 11.0, 15.0, 26.0], abs=1e-9)


def lean(spec: GearSpec) -> float:
    """κ of the half at z = 0, rad/mm."""
    return math.tan(spec.helix_angle) * 2.0 * math.cos(spec.helix_angle) / (spec.normal_module * spec.teeth)


def middle(spec: GearSpec) -> float:
    """Of a half, from mid-face, mm."""
    return 0.25 * (spec.face_width + spec.gap)


@pytest.mark.long
def test_a_double_helical_pair_meshes_in_space():
    """Halves of different width: the pinion's end at other heights than its mate's, and still every tooth has its space."""
    spec = replace(SPEC, name="pinion", thinning=0.04, bore_diameter=0.0)
    mate = replace(spec, name="gear", teeth=19, helix_angle=-spec.helix_angle, profile_shift=-0.2, face_width=22.0, gap=6.0)
    gears = {"pinion": Gear.from_spec(spec), "gear": Gear.from_spec(mate)}
    design = Design(gears, PairSpec(), check_pair(gears["pinion"], gears["gear"], PairSpec()))
    placed = {child.label: child for child in gear_pair(design).children}
    # Where the pinion's halves have a tooth on +x, the gear must have a space: there it is turned against the middles of its own.
    frames = {
        "pinion": (0.0, 0.0),
        "gear": (design.centre_distance, mesh_turn(gears["gear"]) + lean(mate) * (middle(spec) - middle(mate))),
    }
    least = np.inf
    for label, other in (("pinion", "gear"), ("gear", "pinion")):
        faces = [
            face for face in tooth_faces(placed[label]) if abs(face.center().X - frames[label][0]) > 0.6 * abs(face.center().Y)
        ]
        points = np.concatenate([face_points(face, 100) for face in faces]) - [frames[other][0], 0.0, 13.0]
        points[:, :2] = points[:, :2] @ rotation(-frames[other][1])
        drawn = gears[other].spec
        # The half at z = 0 turns by κ with z, the other one the other way: both by −κ with the distance from the gap.
        angle = np.arctan2(points[:, 1], points[:, 0]) + lean(drawn) * (np.abs(points[:, 2]) - middle(drawn))
        radius = np.hypot(points[:, 0], points[:, 1])
        flat = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
        least = min(least, clearance(flat, gears[other], gears[other].half_angle))
    # Each thinned by 0.04 mm of normal arc: j_bt = 2 · 0.04 cos α_n / cos β_b, shared by both sides.
    play = 0.04 * math.cos(math.radians(20.0)) / gears["pinion"].base_helix_cosine
    assert 0.0 <= least - play + 1e-9 < 3e-4


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"gap": 30.0}, "gap = 30 mm: must be below the face width"),
        ({"helix_angle": 0.0}, "gap = 4 mm: a double helical gear has"),
    ],
)
def test_an_impossible_gap_is_refused(changed, words):
    with pytest.raises(InputError, match=words):
        Gear.from_spec(replace(SPEC, **changed))


def test_a_double_helical_gear_does_not_mesh_with_one_of_one_helix():
    gear, pinion = Gear.from_spec(SPEC), Gear.from_spec(replace(SPEC, name="pinion", helix_angle=-SPEC.helix_angle, gap=0.0))
    with pytest.raises(InputError, match="a double helical gear runs with"):
        check_pair(pinion, gear, PairSpec())
