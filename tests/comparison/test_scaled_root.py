"""A scan that is out of scale as a whole: its root is the gear's all the same, and the scale is named, whatever a calibrated scanner may be off by."""

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from gearwear.api import as_scan
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FLANK, TIP, SurfacePoints
from gearwear.placing.proportion import ALIKE, LEAST_POINTS, common_ratio
from tests.diagnose.plain import plain_effects
from tests.placing.placing import designed
from tests.synthetic import PINION, Effect, Recipe, make_scan

AS_CUT = PINION.rack_tip_radius
OUT_OF_LIMITS = "more than a calibrated scanner may be off by"


@pytest.mark.long
@pytest.mark.parametrize(
    ("ppm", "drawn"),
    [
        pytest.param(4500.0, AS_CUT, id="plain"),
        pytest.param(4500.0, AS_CUT, marks=pytest.mark.long),
        pytest.param(-8000.0, AS_CUT, marks=pytest.mark.long),
        pytest.param(4500.0, AS_CUT - 0.1, marks=pytest.mark.long),
        pytest.param(
            3000.0, AS_CUT, marks=pytest.mark.long
        ),  # of twelve like it the one that came out as a coat, a slope and two levels
        pytest.param(12000.0, AS_CUT, marks=pytest.mark.long),
    ],
)
def test_a_scale_bends_no_root_and_keeps_its_name(ppm, drawn, request):
    gear = Gear.from_spec(replace(designed().spec, rack_tip_radius=drawn))
    recipe = Recipe(noise_um=6.0, jitter=1.0, pose="any", effects=(Effect("scale", {"relative_ppm": ppm}),)).of_size(20_000)
    with plain_effects("scale", "scale_anisotropic", "tip_diameter") if "plain" in request.node.callspec.id else nullcontext():
        measured = find_effects(register(Design({"gear": gear}), as_scan(make_scan(recipe, 13).points)), frozenset())

    assert measured.root.rack_tip_radius == pytest.approx(AS_CUT, abs=0.004)  # 0.32 and 0.28 where the scale is taken for its own
    assert measured.root.fits_design == (drawn == AS_CUT)
    assert [effect.name for effect in measured.loop.effects] == ["scale"]
    assert measured.loop.effects[0].amplitudes[0] == pytest.approx(1e-6 * ppm, abs=6e-6)
    assert measured.noise == pytest.approx(6e-3, rel=0.1)  # what goes up and down in a cell with the scale is none
    assert any(OUT_OF_LIMITS in doubt for doubt in measured.doubts) == (abs(ppm) > 5000.0)


def surfaces(**deviation):
    """Points of each surface, moved along the normal by a function of (position · normal)."""
    gear, n = designed(), LEAST_POINTS + 1
    b, codes = gear.face_width, {"tip": TIP, "low": END_LOW, "high": END_HIGH, "bore": BORE, "flank": FLANK}
    normals = {"tip": [1, 0, 0], "low": [0, 0, -1], "high": [0, 0, 1], "bore": [-1, 0, 0], "flank": [0, 1, 0]}
    along = {"tip": gear.tip_radius, "low": 0.5 * b, "high": 0.5 * b, "bore": -8.0, "flank": np.linspace(5.0, 20.0, n)}
    parts = []
    for name, of in deviation.items():
        way = np.broadcast_to(along[name], n)
        normal = np.tile(np.array(normals[name], dtype=float), (n, 1))
        position = normal * way[:, None] + [0.0, 0.0, 0.5 * b]
        parts.append((position, normal, of(way), np.full(n, codes[name])))
    position, normal, moved, surface = (np.concatenate(of) for of in zip(*parts, strict=True))
    zeros = np.zeros(len(position))
    return SurfacePoints(surface, zeros.astype(int), zeros.astype(int), zeros, position, normal, moved), gear


def by(ratio, added=0.0):
    return lambda way: ratio * way + added


def test_all_surfaces_in_one_proportion_are_a_scale():
    thick = 0.03  # of the teeth: no slope
    located, gear = surfaces(flank=by(0.008, thick), tip=by(0.008), low=by(0.008, 0.01), high=by(0.008, -0.01))
    assert common_ratio(located, gear) == pytest.approx(0.008)
    located, gear = surfaces(flank=by(-0.003), tip=by(-0.003), bore=by(-0.003))
    assert common_ratio(located, gear) == pytest.approx(-0.003)


@pytest.mark.parametrize(
    "deviation",
    [
        {"flank": by(0.008), "tip": by(0.008), "low": by(0.0), "high": by(0.0)},  # cut with a larger module
        {"flank": by(0.008), "tip": by(0.008)},  # nor is its width seen
        {"flank": by(0.008), "tip": by(0.008), "high": by(0.008)},  # one end: where it stands is the pose's
        {"flank": by(0.008), "tip": by(0.0), "low": by(0.008), "high": by(0.008)},
        {"tip": by(0.008), "low": by(0.008), "high": by(0.008)},
        {"flank": by(0.0, 0.02), "tip": by(0.0, 0.02), "low": by(0.0, 0.02), "high": by(0.0, 0.02)},  # a coat
        {"flank": by(0.004), "tip": by(0.004 * (1.0 + 1.2 * ALIKE)), "low": by(0.004), "high": by(0.004)},
    ],
)
def test_one_surface_that_is_not_makes_it_none(deviation):
    assert common_ratio(*surfaces(**deviation)) is None
