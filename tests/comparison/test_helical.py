"""A helical scan from file to worn solid: effects named alone, volume within its deviation, arcs and normals apart by name."""

from __future__ import annotations

import math
from contextlib import nullcontext
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.pair import Design
from gearwear.inspection.inspection import inspect
from gearwear.report.records.comparison import document
from gearwear.wear.solid import gear_triangles, nominal_like
from tests.diagnose.plain import plain_effects
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch

GEAR = Helical(teeth=17, helix=-18.0, width=12.0)
PATCH = Patch(4, 1, 0.20, (4.0, 14.0), (0.5, 11.5))
SLOPE = 0.016
"""Helix slope, mm over the face, along the transverse base tangent; + is a flank screwed right-handed."""


@cache
def compared(plain: bool = True):
    added = lambda side, roll, z: side * SLOPE * (z / GEAR.width - 0.5)  # noqa: E731
    cloud = scan(GEAR, 40_000, noise=0.006, seed=5, wear=(PATCH,), added=added, coat=0.014)
    design = Design({"gear": designed(GEAR)})
    with plain_effects() if plain else nullcontext():
        measured = gw.find_effects(gw.register(design, gw.as_scan(cloud.points)))
    return measured, gw.find_wear(measured)


@pytest.mark.long
def test_what_was_put_in_is_named_alone_within_two_standard_deviations():
    measured, _ = compared(plain=False)
    found = {effect.name: effect for effect in measured.loop.effects}
    assert set(found) == {"coating", "helix_slope"}
    for name, parameter, truth in (("coating", "thickness_um", 14.0), ("helix_slope", "slope_um", 1e3 * SLOPE)):
        estimate = found[name].parameters[parameter]
        assert estimate.value == pytest.approx(truth, abs=2.0 * estimate.std), name
        assert found[name].alternatives == ()


@pytest.mark.long
def test_the_volume_is_that_of_the_patch():
    _, wear = compared()
    (region,) = wear.regions
    assert (region.tooth, region.side) == (4, 1)
    assert region.volume == pytest.approx(GEAR.volume(PATCH), abs=2.0 * region.volume_std)
    assert region.volume_std < 0.05 * region.volume
    assert region.max_depth == pytest.approx(PATCH.depth, abs=0.02)


def test_the_helix_slope_of_iso_1328_is_positive_where_the_angle_is_too_large():
    """Screwed to the right on a gear of left hand: too small an angle, so f_Hβ is negative; in the stated length of the range."""
    measured, _ = compared()
    raw = inspect(measured.flanks, measured.gear)
    over = raw.helix.range.stated / GEAR.width
    unworn = np.delete(raw.helix.slope.value, PATCH.tooth, axis=0)
    assert np.median(unworn) == pytest.approx(-1e3 * SLOPE * over / 1e3, abs=4e-4)
    # The coat is taken out, and arcs are transverse: of the unworn teeth, as designed.
    arc = np.delete(raw.dimensions.thickness.value, PATCH.tooth)
    assert np.median(arc) == pytest.approx(measured.gear.tooth_thickness, abs=2e-3)
    assert raw.dimensions.chord.thickness < measured.gear.normal_tooth_thickness


@pytest.mark.long
@pytest.mark.parametrize("faces", [True, False])
def test_a_scale_of_heights_is_named_where_end_faces_tell_it_from_a_helix_slope(faces):
    """Heights too large by e turn the flanks back: a helix slope of −tan β_b e b, to first order, and nothing else on them."""
    gear, relative = Helical(teeth=21, helix=33.0, width=25.0), 1.2e-3
    cloud = scan(gear, 30_000, noise=0.006, seed=2, faces=faces)
    stretched = (cloud.points - cloud.translation) @ cloud.rotation * [1.0, 1.0, 1.0 + relative]
    measured = gw.find_effects(gw.register(Design({"gear": designed(gear)}), gw.as_scan(stretched)))
    (found,) = measured.loop.effects
    if faces:
        assert (found.name, found.alternatives) == ("height_scale", ())
        estimate, truth = found.parameters["relative_ppm"], 1e6 * relative
    else:
        assert (found.name, found.alternatives) == ("helix_slope", ("height_scale",))
        base = math.sqrt(1.0 / gear.base_cos**2 - 1.0)  # tan β_b
        estimate, truth = found.parameters["slope_um"], -1e3 * base * relative * gear.width
    assert estimate.value == pytest.approx(truth, abs=2.0 * estimate.std + 0.005 * abs(truth))


@cache
def result():
    """From a file to the result."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        np.savetxt(folder / "scan.xyz", scan(GEAR, 40_000, noise=0.006, seed=6, wear=(PATCH,)).points, fmt="%.5f")
        (folder / "design.toml").write_text(
            f"[gear]\nteeth = {GEAR.teeth}\nnormal_module = {GEAR.module}\nhelix_angle = {GEAR.helix}\nface_width = {GEAR.width}\n"
            f"profile_shift = {GEAR.shift}\n"
        )
        return gw.compare(folder / "design.toml", folder / "scan.xyz", inspection=False)


@pytest.mark.long
def test_the_report_says_hand_angle_and_both_thicknesses():
    record = document(result())
    design = record["design"]
    assert (design["helix_angle_deg"], design["hand"]) == (pytest.approx(-18.0), "left")
    assert design["normal_module_mm"] == design["module_mm"] == pytest.approx(3.0)
    assert design["transverse_module_mm"] == pytest.approx(3.0 / GEAR.cos)
    for tooth in record["thickness"]:
        assert tooth["nominal_normal_mm"] == pytest.approx(GEAR.cos * tooth["nominal_mm"])
        assert tooth["loss_max_normal_mm"] == pytest.approx(GEAR.cos * tooth["loss_max_mm"])
    # Loss of arc: δ r / (r_b cos β_b); the deepest place lies near the reference circle.
    worst = max(record["thickness"], key=lambda tooth: tooth["loss_max_mm"])
    most = PATCH.depth / (math.cos(GEAR.transverse) * GEAR.base_cos)
    assert worst["tooth"] == PATCH.tooth + 1
    assert 0.85 * most < worst["loss_max_mm"] < most + 4.0 * worst["loss_max_std_mm"]


@pytest.mark.long
def test_the_solids_are_closed_twisted_and_hold_the_volume():
    found = result()
    worn, (lost,) = found.wear.solids.worn, found.wear.solids.bodies
    gear = found.gear
    whole = gear_triangles(nominal_like(found.wear.worn)).volume
    assert worn.volume + lost.volume == pytest.approx(whole, rel=1e-7)
    assert whole == pytest.approx(gear.section_area() * gear.face_width, rel=1e-3)  # chords of the fillets
    assert lost.volume == pytest.approx(found.wear.found.volume, rel=0.03)  # solids fill holes by means: docs/limits.md
    for body in (worn, lost):  # closed: every edge once each way
        a, b = body.faces, np.roll(body.faces, -1, axis=1)
        edges = set(zip(a.ravel().tolist(), b.ravel().tolist(), strict=True))
        assert len(edges) == body.faces.size and all((q, p) in edges for p, q in edges)
    # The lost metal lies on the design's own helicoid: turned back by its own height it is within the tooth's half angle.
    x, y, z = lost.vertices.T
    angle = np.arctan2(y, x) - GEAR.turn * (z - 0.5 * GEAR.width)
    off = np.abs(np.angle(np.exp(1j * (angle - PATCH.tooth * 2 * math.pi / GEAR.teeth))))
    assert off.max() < float(gear.half_angle(np.hypot(x, y).min())) + 1e-3
