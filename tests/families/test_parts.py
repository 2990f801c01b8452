"""Points, volumes and thickness of parts against integrals made another way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.families import draws
from benchmarks.families.fields import Frame, Hollow, Pits, Polynomial, Sliding
from benchmarks.families.gear import GearNumbers
from benchmarks.families.part import Part
from benchmarks.families.rack import Tool
from benchmarks.families.sampling import BROKEN, FLANK, TIP, sample
from benchmarks.families.truth import broken_volume, deepest_mean, flank_volume, thickness, truth

GEAR = GearNumbers(18, 4.0, 12.0, bore=30.0)
TOOLS = (Tool(1.25, 0.30),)
PLAIN = Part(GEAR, TOOLS)
WORN = Part(
    GEAR, TOOLS, (Polynomial(0.01), Polynomial(0.015, 1)),
    (Hollow(2, 1, 0.4, 17.0, 6.0, 6.0, 8.0), Sliding(-1, 0.05, tuple([1.0] * 18))),
)  # fmt: skip


def test_volume_of_the_gear_from_its_surface():
    """Gauss: V = ⅓ ∮ x·n dA, each point standing for the same area; Monte Carlo, so within 4 standard errors."""
    number = 400_000
    points = sample(PLAIN, number, np.random.default_rng(1), ends=1.0)
    sec = PLAIN.section
    top = GEAR.tip_roll + 0.02 * GEAR.module
    areas = [
        2 * 18 * sec.root_length[-1] * 12.0, 18 * 12.0 * (top**2 - sec.form_roll**2) / GEAR.base_radius,
        2 * 18 * 12.0 * GEAR.tip_radius * (float(GEAR.half_angle(GEAR.tip_roll)) + 0.02),
        2 * math.pi * (GEAR.tip_radius**2 - 15.0**2), math.pi * 30.0 * 12.0,
    ]  # fmt: skip
    each = sum(areas) / number
    terms = (points.xyz * points.normal).sum(axis=1) / 3.0
    volume, error = terms.sum() * each, each * math.sqrt((terms**2).sum())
    exact = (sec.area() - math.pi * 15.0**2) * 12.0
    assert error < 0.01 * exact
    assert abs(volume - exact) < 4.0 * error


def test_share_of_points_on_flanks_is_their_share_of_the_area():
    points = sample(PLAIN, 200_000, np.random.default_rng(2))
    flank = 18 * 12.0 * (GEAR.tip_roll**2 - PLAIN.frame.form**2) / GEAR.base_radius
    tip = 2 * 18 * 12.0 * GEAR.tip_radius * float(GEAR.half_angle(GEAR.tip_roll))
    on = points.kind == FLANK
    both = on | (points.kind == TIP)
    share, number = flank / (flank + tip), int(both.sum())
    assert abs(on.sum() - share * number) < 4.0 * math.sqrt(number * share * (1.0 - share))


@pytest.mark.parametrize("kind", ["missing tooth", "broken corner", "chipped edge"])
def test_metal_lies_behind_every_point_and_none_before(kind):
    rng = np.random.default_rng(3)
    part = Part(GEAR, TOOLS, WORN.made, WORN.wear, (draws.cut(rng, WORN, 7, kind),))
    points = sample(part, 60_000, rng)
    assert (points.kind == BROKEN).sum() > 5
    rho = np.hypot(points.xyz[:, 0], points.xyz[:, 1])
    near_root = np.abs(rho - part.section.root_radius[0]) < 0.05
    sharp = (points.edge < 0.05) | near_root | (rho < 16.0)
    well = points.take(~sharp)
    step = 0.004
    before, behind = part.solid(well.xyz + step * well.normal), part.solid(well.xyz - step * well.normal)
    exact = well.kind == BROKEN  # the others away from the edges that the break has made
    for cut in part.cuts:
        exact |= np.abs(cut.beyond(well.xyz)) > 0.05
    inner = np.ones(len(well), dtype=bool)  # fracture points away from the tooth's own surface
    tooth, angle, r = part.angle_in_tooth(well.xyz)
    of = well.kind == BROKEN
    inner[of] = r[of] * (part.half_angle(tooth[of], np.sign(angle[of]), r[of], well.xyz[of, 2]) - np.abs(angle[of])) > 0.05
    inner[of] &= (GEAR.tip_radius - r[of] > 0.05) & (np.minimum(well.xyz[of, 2], 12.0 - well.xyz[of, 2]) > 0.05)
    assert (of & inner).sum() > 5
    assert not before[exact & inner].any()
    assert behind[exact & inner].all()


def polar_loss(part: Part, made: Part, tooth: int, side: int, number: int = 500) -> float:
    """What is missing between two parts on a flank: the angle between their surfaces over radius and height."""
    low, high = part.section.form_radius, part.gear.tip_radius
    rho = low + (np.arange(number) + 0.5) / number * (high - low)
    z = (np.arange(200) + 0.5) / 200 * part.gear.face_width
    r, h = (a.ravel() for a in np.meshgrid(rho, z))
    k, s = np.full(len(r), float(tooth)), np.full(len(r), float(side))
    gone = (made.half_angle(k, s, r, h) - part.half_angle(k, s, r, h)) * r
    return float(gone.mean() * (high - low) * part.gear.face_width)


def test_worn_volume_is_what_is_missing_between_the_surfaces():
    unworn = Part(GEAR, TOOLS, WORN.made)
    for tooth, side in ((2, 1), (2, -1)):
        volume, _ = flank_volume(WORN, tooth, side, 0.01)
        assert volume == pytest.approx(polar_loss(WORN, unworn, tooth, side), rel=1e-3)
    assert flank_volume(WORN, 3, 1)[0] == 0.0


def test_worn_volume_by_counting_cells():
    """The same by brute force: cells that are metal in the one part and not in the other."""
    unworn = Part(GEAR, TOOLS, WORN.made)
    rng = np.random.default_rng(4)
    low, high = WORN.section.form_radius, GEAR.tip_radius
    number = 400_000
    rho = np.sqrt(rng.uniform(low**2, high**2, number))
    theta = 2 * GEAR.pitch_angle + rng.uniform(0.0, 0.1, number)
    xyz = np.column_stack([rho * np.cos(theta), rho * np.sin(theta), rng.uniform(0.0, 12.0, number)])
    gone = unworn.solid(xyz) & ~WORN.solid(xyz)
    box = 0.5 * 0.1 * (high**2 - low**2) * 12.0
    share = gone.mean()
    assert abs(flank_volume(WORN, 2, 1, 0.01)[0] - share * box) < 4.0 * box * math.sqrt(share * (1 - share) / number)


def test_an_even_loss_has_the_closed_form_of_parallels():
    depth = 0.3

    class Even:
        def __call__(self, f, tooth, side, roll, z):
            return np.where((tooth == 0) & (side == 1), -depth, 0.0)

    part = Part(GEAR, TOOLS, (), (Even(),))
    f, rb = part.frame, GEAR.base_radius
    exact = ((f.tip**2 - f.form**2) / 2 * depth - (f.tip - f.form) * depth**2 / 2) / rb
    # Feet beyond the tip: ∫ from L_tip to L_tip + d of the depths beyond L − L_tip
    exact += (f.tip * depth**2 / 2 + depth**3 * (1 / 2 - 1 / 3 - 1 / 6) + depth**3 / 6 - depth**3 / 6) / rb
    assert flank_volume(part, 0, 1, 0.002)[0] == pytest.approx(exact * 12.0, rel=2e-4)


def test_a_pits_volume_is_that_of_its_bowl():
    """∫ depth (1 − q²)^0.75 over a small disc is depth π R² / 1.75; the flank bends by R/L."""
    radius, depth = 0.25, 0.1
    part = Part(GEAR, TOOLS, (), (Pits(((1.0, 1.0, 14.0, 6.0, radius, depth),)),))
    volume, deepest = flank_volume(part, 1, 1, 0.004)
    assert volume == pytest.approx(depth * math.pi * radius**2 / 1.75, rel=0.01)
    assert deepest == pytest.approx(depth, rel=0.01)


def test_thickness_is_the_angle_between_the_flanks():
    number = 120
    got = thickness(WORN, number)
    z = (np.arange(number) + 0.5) / number * 12.0
    r = GEAR.reference_radius
    for tooth in (0, 2):
        k = np.full(number, float(tooth))
        arc = sum(r * WORN.half_angle(k, np.full(number, s), np.full(number, r), z) for s in (1.0, -1.0))
        assert got["mean"][tooth] == pytest.approx(arc.mean(), abs=1e-9)
        assert got["least"][tooth] == pytest.approx(arc.min(), abs=1e-9)
    # normal deviation δ of both flanks is 2 δ / cos α of arc; u at the reference circle is the same on all
    made = 2.0 * float(WORN.as_made(np.zeros(1), np.ones(1), np.array([WORN.frame.reference]), np.zeros(1))[0])
    assert got["made"][0] - GEAR.thickness == pytest.approx(made / math.cos(GEAR.alpha), rel=2e-3)


@pytest.mark.long
def test_broken_volume_by_counting():
    rng = np.random.default_rng(5)
    for kind in ("missing tooth", "broken corner", "chipped edge"):
        cut = draws.cut(rng, PLAIN, 4, kind)
        part = Part(GEAR, TOOLS, (), (), (cut,))
        number, half = 300_000, 0.5 * GEAR.pitch_angle
        low = PLAIN.section.root_radius[0]
        rho = np.sqrt(rng.uniform(low**2, GEAR.tip_radius**2, number))
        theta = 4 * GEAR.pitch_angle + rng.uniform(-half, half, number)
        xyz = np.column_stack([rho * np.cos(theta), rho * np.sin(theta), rng.uniform(0.0, 12.0, number)])
        share = (PLAIN.solid(xyz) & ~part.solid(xyz)).mean()
        box = half * (GEAR.tip_radius**2 - low**2) * 12.0
        error = box * math.sqrt(share * (1 - share) / number)
        # and the grid's own error: half a cell over the piece's surface, in both directions: some per mille
        assert abs(broken_volume(part, cut) - share * box) < 4.0 * error + 3e-3 * share * box


def test_truth_keeps_wear_and_breakage_apart():
    rng = np.random.default_rng(6)
    part = Part(GEAR, TOOLS, (), WORN.wear[:1], (draws.cut(rng, WORN, 7, "missing tooth"),))
    t = truth(part)
    assert [(f["tooth"], f["side"]) for f in t.flanks] == [(2, 1)]
    assert [p["tooth"] for p in t.broken] == [7]
    assert np.isnan(t.thickness["mean"][7])
    assert np.isfinite(np.delete(t.thickness["mean"], 7)).all()


def test_sliding_wear_is_nought_on_the_pitch_line_and_greatest_where_contact_starts():
    f = Frame.of(GEAR, PLAIN.section.form_roll)
    slide = Sliding(1, 0.1, tuple([1.0] * 18))
    roll = np.array([f.form, slide.start(f), f.reference, f.tip])
    loss = slide(f, np.zeros(4), np.ones(4), roll, np.zeros(4))
    assert loss[0] == 0.0
    assert loss[1] == pytest.approx(-0.1)
    assert loss[2] == pytest.approx(0.0, abs=1e-15)
    # published: K₁ = 1 − L₂/(u L₁) = 0.758 at L₁ = 26.343853 of the 12-tooth pinion with u = 2, −4.89 at 3.06
    pinion = Frame(12, 6.35, 2.0, 13.030967, 26.343853, 15.0, math.cos(math.radians(20.0)))
    assert slide._slide(pinion, np.array([26.343853, 3.06])) == pytest.approx([0.758, 4.89], abs=6e-3)


class Leaning:
    """A loss that grows along the face, 10 µm a millimetre."""

    def __call__(self, frame, tooth, side, roll, z):
        return np.where((tooth == 2) & (side == 1), -0.01 * z, 0.0) + 0.0 * roll


def test_the_deepest_mean_of_a_leaning_loss_lies_half_a_window_from_the_end():
    part = Part(GEAR, TOOLS, (), (Leaning(),), ())
    step = GEAR.face_width / int(GEAR.face_width / 0.05)
    assert deepest_mean(part, 2, 1) == pytest.approx(0.01 * (GEAR.face_width - 5.0 * step), rel=1e-12)
    assert deepest_mean(part, 3, 1) == 0.0
