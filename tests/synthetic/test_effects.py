"""Each effect's moved points against the first-order formulas of the reference (E), within its second order."""

import math

import numpy as np
import pytest

from tests.synthetic import (
    OUTSIDE,
    PARAMETERS,
    PINION,
    Effect,
    GearNumbers,
    Outline,
    Recipe,
    Rigid,
    Surface,
    make_scan,
    rotation_about,
)

OUTLINE = Outline.of(PINION)
RB = OUTLINE.base_radius


def moved(*effects, **other):
    """Where the points are, and where they were."""
    recipe = Recipe(slices=9, points_per_tooth=121, end_points=4000, noise_um=0.0, pose="none", effects=effects, **other)
    return make_scan(recipe, 1)


class Flank:
    """The scan's flank points with the reference's own quantities, µm and mm."""

    def __init__(self, scan):
        labels = scan.truth.labels
        on = labels.surface == Surface.FLANK
        x, y, self.z = scan.points[on].T
        self.tooth, self.side, self.roll = labels.tooth[on], labels.side[on], labels.roll[on]
        theta_k = self.tooth * OUTLINE.pitch_angle
        radius = np.hypot(x, y)
        tangent = np.sqrt(radius**2 - RB**2) / RB
        across = np.angle(np.exp(1j * (np.arctan2(y, x) - theta_k)))
        self.delta = 1e3 * RB * (self.side * across - (OUTLINE.base_half_angle - tangent + np.arctan(tangent)))
        self.radius = np.hypot(RB, self.roll)
        tangent = self.roll / RB
        self.tau = theta_k + self.side * (OUTLINE.base_half_angle - tangent)
        self.theta = self.tau + self.side * np.arctan(tangent)
        self.zeta = labels.z[on] / 15.0 - 0.5
        self.u = 2.0 * (self.roll - OUTLINE.form_roll) / (OUTLINE.tip_roll - OUTLINE.form_roll) - 1.0
        self.label = labels.deviation[on] * 1e3


def turned_by_one(roll):
    """What the normal of a left flank at a roll takes of a turn about the middle of the tooth where it leaves the root circle: lever × normal."""
    across = OUTLINE.base_half_angle - roll / RB
    x = RB * np.cos(across) - roll * np.sin(across) - OUTLINE.root_radius
    y = RB * np.sin(across) + roll * np.cos(across)
    return x * np.cos(across) + y * np.sin(across)


INDEX = tuple(float(x) for x in 30.0 * np.cos(np.arange(12) * 1.7) - 30.0 * np.mean(np.cos(np.arange(12) * 1.7)))
COS20 = math.cos(math.radians(20.0))
# effect -> what the contract or the reference says the flank's deviation is (µm), and its second order (µm)
FLANK = {
    "coating": ({"thickness_um": 18.0}, lambda f: 18.0 + 0 * f.u, 1e-6),
    "scale": ({"relative_ppm": 500.0}, lambda f: 0.5 * f.roll, 0.06),
    "scale_anisotropic": (
        {"difference_ppm": 400.0, "direction_deg": 0.0},
        lambda f: -f.side * RB * 0.2 * np.sin(2 * f.tau) - f.roll * 0.2 * np.cos(2 * f.tau),
        0.02,
    ),
    "height_scale": ({"relative_ppm": 1000.0}, lambda f: 0 * f.u, 1e-9),
    "axis_offset_radial": ({"offset_um": 20.0}, lambda f: 20.0 * f.roll / f.radius, 0.07),
    "axis_offset_lateral": ({"offset_um": 20.0}, lambda f: f.side * 20.0 * RB / f.radius, 1e-9),
    "turntable_angle": (
        {"order": 3, "amplitude_deg": 0.03, "phase_deg": 25.0},
        lambda f: f.side * RB * 1e3 * math.radians(0.03) * np.cos(3 * f.theta + math.radians(25.0)),
        1e-9,
    ),
    "scan_drift": (
        {"closure_deg": 0.05, "start_deg": 10.0},
        lambda f: f.side * RB * 1e3 * math.radians(0.05) * (np.mod(f.theta / (2 * math.pi) - 10 / 360, 1.0) - 0.5),
        1e-9,
    ),
    "eccentricity": (
        {"amplitude_um": 20.0, "direction_deg": 50.0},
        lambda f: f.side * 20.0 * np.sin(math.radians(50.0) - f.tau),
        0.08,
    ),
    "wobble": (
        {"amplitude_um": 20.0, "direction_deg": 50.0},
        lambda f: f.side * 20.0 * 2.0 * f.zeta * np.sin(math.radians(50.0) - f.tau),
        0.2,  # the moved point's z changes by amplitude · r / (b / 2)
    ),
    "tooth_thickness": ({"thickness_um": -60.0}, lambda f: -30.0 * COS20 + 0 * f.u, 1e-9),
    "profile_slope": (
        {"left_um": 12.0, "right_um": -7.0},
        lambda f: np.where(f.side > 0, 6.0, -3.5) * f.u,
        1e-9,
    ),
    "profile_crowning": ({"crowning_um": 9.0}, lambda f: -9.0 * f.u**2, 1e-9),
    "helix_crowning": ({"crowning_um": 9.0}, lambda f: -9.0 * (2 * f.zeta) ** 2, 1e-9),
    "tip_relief": (
        {"amount_um": 25.0, "start_mm": 20.0},
        lambda f: -25.0 * np.clip((f.roll - 20.0) / (OUTLINE.tip_roll - 20.0), 0, 1),
        1e-9,
    ),
    "root_relief": (
        {"amount_um": 25.0, "start_mm": 9.0},
        lambda f: -25.0 * np.clip((9.0 - f.roll) / (9.0 - OUTLINE.form_roll), 0, 1),
        1e-9,
    ),
    "helix_slope": ({"slope_um": 20.0}, lambda f: f.side * 20.0 * f.zeta, 1e-9),
    "taper": ({"taper_um": 20.0}, lambda f: 20.0 * f.zeta, 1e-9),
    "twist": ({"twist_um": 20.0}, lambda f: 10.0 * f.u * f.zeta, 1e-9),
    "pitch": ({"index_um": INDEX}, lambda f: f.side * np.array(INDEX)[f.tooth] * COS20, 1e-9),
    "thickness_variation": ({"thickness_um": INDEX}, lambda f: 0.5 * np.array(INDEX)[f.tooth] * COS20, 1e-9),
    "feed_marks": (
        {"amplitude_um": 4.0, "wavelength_mm": 3.0, "phase_deg": 30.0},
        lambda f: 4.0 * np.cos(2 * math.pi * f.z / 3.0 + math.radians(30.0)),
        1e-9,
    ),
    "wave_growing": (
        {"order": 5, "amplitude_um": 20.0, "phase_deg": 0.0},
        lambda f: 20.0 * (f.roll / OUTLINE.tip_roll) ** 2 * np.cos(5 * f.theta),
        1e-9,
    ),
    "helical_scratch": (
        {"tooth": 3, "depth_um": 30.0, "width_mm": 1.0, "roll_mm": 15.0, "rise_mm_per_mm": 0.5},
        lambda f: -30.0 * (f.tooth == 3) * np.exp(-0.5 * (f.roll - 15.0 - 7.5 * f.zeta) ** 2),
        1e-9,
    ),
    "stitch_step": (
        {"step_um": 15.0, "z_mm": 6.0},
        lambda f: 15.0 * (f.z > 6.0) * f.roll / f.radius,
        0.04,
    ),
    "flank_ripple": (
        {"amplitude_um": 5.0, "wavelength_mm": 3.0, "phase_deg": 90.0},
        lambda f: -5.0 * (f.side > 0) * np.sin(2 * math.pi * f.roll / 3.0),
        1e-9,
    ),
    "pitch_ridge": (
        {"height_um": 15.0, "width_mm": 1.2},
        lambda f: 15.0 * (f.side > 0) * np.exp(-((f.roll - OUTLINE.reference_roll) ** 2) / 2.88),
        1e-9,
    ),
    "bend": (
        {"tooth": 3, "tip_um": -40.0, "power": 2.0},
        lambda f: -40.0 * f.side * (f.tooth == 3) * ((f.roll - OUTLINE.form_roll) / (OUTLINE.tip_roll - OUTLINE.form_roll)) ** 2,
        1e-9,
    ),
    "bend_at_end": (
        {"tooth": 3, "tip_um": -40.0, "power": 1.0},
        lambda f: (
            -80.0
            * f.side
            * (f.tooth == 3)
            * (f.roll - OUTLINE.form_roll)
            / (OUTLINE.tip_roll - OUTLINE.form_roll)
            * f.z
            / OUTLINE.face_width
        ),
        1e-9,
    ),
    "hinge": (
        {"tooth": 3, "tip_um": 40.0},
        lambda f: 40.0 * f.side * (f.tooth == 3) * turned_by_one(f.roll) / turned_by_one(OUTLINE.tip_roll),
        1e-9,
    ),
}
RADIAL = {"coating": 18.0, "axis_offset_radial": 20.0, "scale": (500e-3 * OUTLINE.tip_radius, 500e-3 * OUTLINE.root_radius)}
PLACED = {"eccentricity", "wobble", "scale_anisotropic", "stitch_step"}
"""Tips and roots move too, each point differently: tested apart."""


def test_every_effect_has_a_formula_here():
    assert set(FLANK) == set(PARAMETERS)
    assert set(OUTSIDE) < set(PARAMETERS)


@pytest.mark.parametrize("name", FLANK)
def test_flank_moves_by_the_formula(name):
    parameters, formula, second_order = FLANK[name]
    flank = Flank(moved(Effect(name, parameters)))
    assert len(flank.delta) > 4000
    assert np.abs(flank.delta - formula(flank)).max() < second_order + 1e-7
    assert np.abs(formula(flank)).max() > 1.0 or name == "height_scale"


@pytest.mark.parametrize("name", FLANK)
def test_tips_and_roots_move_radially_by_their_own_rule_or_not_at_all(name):
    scan = moved(Effect(name, FLANK[name][0]))
    radius = np.hypot(*scan.points[:, :2].T)
    found = []
    for surface, circle in ((Surface.TIP, OUTLINE.tip_radius), (Surface.ROOT, OUTLINE.root_radius)):
        found.append(1e3 * (radius[scan.truth.labels.surface == surface] - circle))
    if name in PLACED:
        assert np.ptp(found[0]) > 1.0
        return
    told = RADIAL.get(name, 0.0)
    for rise, expected in zip(found, told if isinstance(told, tuple) else (told, told), strict=True):
        assert rise == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("name", ["tooth_thickness", "helix_slope", "taper", "pitch"])
def test_a_side_cut_turns_the_fillet_with_its_flank(name):
    still, scan = moved(), moved(Effect(name, FLANK[name][0]))
    labels = scan.truth.labels
    for side in (1, -1):
        for tooth in (0, 5):
            on = (labels.tooth == tooth) & (labels.side == side) & (labels.z == labels.z[0])
            turn = np.angle(np.exp(1j * (np.arctan2(*scan.points[on, 1::-1].T) - np.arctan2(*still.points[on, 1::-1].T))))
            flank = labels.surface[on] == Surface.FLANK
            fillet = labels.surface[on] == Surface.FILLET
            assert np.abs(turn[flank]).min() > 1e-5
            assert turn[fillet] == pytest.approx(turn[flank][0], abs=1e-12)


def test_ground_flanks_leave_their_fillets_where_they_are():
    effects = tuple(Effect(name, FLANK[name][0]) for name in ("tooth_thickness", "pitch", "helix_slope"))
    still, scan = moved(), moved(*effects, fillets_follow=False)
    surface = scan.truth.labels.surface
    shift = np.linalg.norm(scan.points - still.points, axis=1)
    assert shift[(surface == Surface.FILLET) | (surface == Surface.ROOT)].max() < 1e-12
    assert np.median(shift[surface == Surface.FLANK]) > 0.01


def test_end_faces_move_with_coating_height_scale_and_scale_only():
    for name, top, bottom in (
        ("coating", 18.0, -18.0),
        ("height_scale", 15.0, 0.0),
        ("scale", 7.5, 0.0),
        ("turntable_angle", 0.0, 0.0),
        ("profile_slope", 0.0, 0.0),
    ):
        scan = moved(Effect(name, FLANK[name][0]))
        z, surface = 1e3 * scan.points[:, 2], scan.truth.labels.surface
        assert z[surface == Surface.END_HIGH] == pytest.approx(15_000.0 + top, abs=1e-6)
        assert z[surface == Surface.END_LOW] == pytest.approx(bottom, abs=1e-6)


def test_anisotropy_is_the_part_longer_along_the_direction_of_the_scans_own_axes():
    pose = Rigid(rotation_about(np.array([0.0, 0.0, 0.3])), np.array([1.0, 2.0, 3.0]))
    direction = {"difference_ppm": 1000.0, "direction_deg": 70.0}
    still, scan = moved(), moved(Effect("scale_anisotropic", direction))
    scan = make_scan(Recipe(**{**_plain(), "effects": (Effect("scale_anisotropic", direction),), "pose": pose}), 1)
    still = make_scan(Recipe(**{**_plain(), "pose": pose}), 1)
    shift = scan.points - still.points
    along = np.array([math.cos(math.radians(70.0)), math.sin(math.radians(70.0)), 0.0])
    across = np.array([-along[1], along[0], 0.0])
    part = still.points - pose.translation
    assert shift @ along == pytest.approx(0.5e-3 * part @ along, abs=1e-12)
    assert shift @ across == pytest.approx(-0.5e-3 * part @ across, abs=1e-12)
    assert np.abs(shift[:, 2]).max() < 1e-12


def _plain():
    return {"slices": 9, "points_per_tooth": 121, "end_points": 4000, "noise_um": 0.0}


def test_drift_has_its_seam_where_the_scan_started():
    scan, still = moved(Effect("scan_drift", {"closure_deg": 0.1, "start_deg": 40.0})), moved()
    theta = np.mod(np.degrees(np.arctan2(*still.points[:, 1::-1].T)) - 40.0, 360.0)
    turn = np.degrees(np.angle(np.exp(1j * (np.arctan2(*scan.points[:, 1::-1].T) - np.arctan2(*still.points[:, 1::-1].T)))))
    assert turn == pytest.approx(0.1 * (theta / 360.0 - 0.5), abs=1e-10)


def test_the_datum_stays_when_the_teeth_are_eccentric_or_wobble():
    gear = GearNumbers(bore_diameter=25.0)
    for name, datum in (("eccentricity", (Surface.BORE,)), ("wobble", (Surface.END_LOW, Surface.END_HIGH))):
        effect = Effect(name, {"amplitude_um": 80.0, "direction_deg": 90.0})
        scan, still = moved(effect, gear=gear), moved(gear=gear)
        fixed = np.isin(scan.truth.labels.surface, datum)
        assert fixed.sum() >= 200
        assert np.array_equal(scan.points[fixed], still.points[fixed])
        assert np.linalg.norm(scan.points - still.points, axis=1)[~fixed].max() > 0.07
    bore = still.truth.labels.surface == Surface.BORE
    assert np.hypot(*still.points[bore, :2].T) == pytest.approx(12.5, abs=1e-12)


def test_the_order_of_declaring_does_not_matter():
    effects = [Effect(name, FLANK[name][0]) for name in FLANK]
    np.testing.assert_allclose(moved(*effects).points, moved(*effects[::-1]).points, rtol=0, atol=1e-13)


def test_label_deviation_is_what_the_machine_tool_left():
    flank = Flank(moved(*(Effect(n, FLANK[n][0]) for n in ("profile_slope", "pitch", "taper", "twist", "wave_growing"))))
    assert flank.label == pytest.approx(flank.delta, abs=1e-7)


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("coatings", {"thickness_um": 1.0}, "unknown effect 'coatings'"),
        ("coating", {"thickness_mm": 1.0}, r"coating takes \('thickness_um',\)"),
        ("scan_drift", {"closure_deg": 1.0}, "start_deg"),
    ],
)
def test_a_misspelt_effect_is_refused(name, parameters, message):
    with pytest.raises(ValueError, match=message):
        Effect(name, parameters)
