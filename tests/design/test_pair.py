import math
import re

import numpy as np
import pytest

from gearwear.design import Design, Gear, GearSpec, PairSpec
from gearwear.design.involute import inverse_involute, involute_function
from gearwear.design.pair import check_pair, tip_penetration
from gearwear.errors import InputError


def _gear(teeth: int, name: str = "gear", **modules: float) -> Gear:
    return Gear.from_spec(GearSpec(name, teeth, 6.35, 15.0, **modules))


def test_the_papers_pair_is_legal_and_its_overrun_is_told(pinion, wheel):
    """Gear tip past N1 by 41.0766 − 39.0929 = 1.984; without interference up to √(r_b² + (C sin α)²) = 81.581."""
    (warning,) = check_pair(pinion, wheel, PairSpec())
    assert "the pinion's interference point by 1.984 mm" in warning
    assert "up to tip radius 81.581 mm" in warning
    assert "is undercut and clears it" in warning


def test_no_warning_where_the_centre_distance_is_free_of_interference(pinion, wheel):
    """√((r_b1 + r_b2)² + L_tip²) = 114.9936; there the tip still reaches below the undercut pinion's form circle."""
    short, free = (check_pair(pinion, wheel, PairSpec(c)) for c in (114.9935, 114.9937))
    assert "interference point" in short[0]
    assert [w for w in free if "interference point" in w] == []
    assert "form circle (radius 35.9326 mm)" in free[0]


def test_bottoming(wheel):
    """44.45 + 68.2625 = 30.1625 + 82.55 = 112.7125; thinned so far that the teeth do not jam first."""
    pinion = _gear(12, "pinion", rack_tip_radius=0.25, thinning=1.2)
    with pytest.raises(InputError, match=r"tip digs 0\.1125 mm into its mate's root; at least 112\.7125 mm"):
        check_pair(pinion, wheel, PairSpec(112.6))
    with pytest.raises(InputError, match="root fillet"):  # no longer the root circle: the fillet is in the way there
        check_pair(pinion, wheel, PairSpec(112.7126))


@pytest.mark.parametrize("loss", [0.0, 0.2, 0.6])
def test_teeth_jam_below_the_distance_of_zero_backlash(loss):
    """inv α0 = inv α − loss / 2C, C0 = C cos α / cos α0."""
    pinion, gear = _gear(18, "pinion", thinning=0.5 * loss), _gear(30, thinning=0.5 * loss)
    centre, alpha = 24 * 6.35, math.radians(20.0)
    zero = centre * math.cos(alpha) / math.cos(inverse_involute(involute_function(alpha) - loss / (2 * centre)))
    check_pair(pinion, gear, PairSpec(zero + 1e-6))
    with pytest.raises(InputError, match=r"the teeth jam, backlash would be -0\.00"):
        check_pair(pinion, gear, PairSpec(zero - 1e-3))


def test_jam_of_a_pair_written_with_unequal_pressure_angles():
    """The same gear said with 25° instead of 20° (same base circle, base thickness and circles) jams at the same distance."""
    pinion, gear = _gear(18, "pinion", thinning=0.3), _gear(30, thinning=0.3)
    alpha = math.radians(25.0)
    module = 6.35 * math.cos(math.radians(20.0)) / math.cos(alpha)
    thickness = 30 * module * (gear.base_half_angle - involute_function(alpha))
    shift = (thickness - 0.5 * math.pi * module) / (2 * module * math.tan(alpha))
    addendum = (gear.tip_radius / module) - 15 - shift
    dedendum = 15 + shift - gear.root_radius / module
    same = Gear.from_spec(
        GearSpec("gear", 30, module, 15.0, alpha, profile_shift=shift, addendum=addendum, dedendum=dedendum, rack_tip_radius=0.1)
    )
    assert same.base_half_angle == pytest.approx(gear.base_half_angle, rel=1e-13)
    centre, twenty = 24 * 6.35, math.radians(20.0)
    zero = centre * math.cos(twenty) / math.cos(inverse_involute(involute_function(twenty) - 0.6 / (2 * centre)))
    for mate in (gear, same):
        check_pair(pinion, mate, PairSpec(zero + 1e-6))
        with pytest.raises(InputError, match="jam"):
            check_pair(pinion, mate, PairSpec(zero - 1e-3))


@pytest.mark.parametrize(
    ("gear", "centre", "message"),
    [
        (
            Gear.from_spec(GearSpec("gear", 24, 6.0, 15.0)),
            114.3,
            r"module 6 mm and pressure angle 20° do not mesh with the pinion's 6\.35 mm",
        ),
        (_gear(24), 107.4, r"centre_distance = 107\.4 mm: must be above the sum of the base radii, 107\.4069 mm"),
        (_gear(24), 130.0, r"the gears do not reach each other"),
    ],
)
def test_pairs_that_cannot_mesh(pinion, gear, centre, message):
    with pytest.raises(InputError, match=message):
        check_pair(pinion, gear, PairSpec(centre))


def test_contact_ratio_below_one_is_told():
    pinion, gear = _gear(24, "pinion", addendum=0.5), _gear(24, addendum=0.5)
    path = 2 * (gear.tip_roll - gear.reference_roll)
    (warning,) = check_pair(pinion, gear, PairSpec())
    assert f"contact ratio {path / gear.base_pitch:.3f} is below 1" in warning


def contact_advance(own: Gear, mate: Gear, centre: float) -> float:
    """How far (mm at the base circle) the tooth sides of `own` push `mate` ahead of where the involutes would have it.

    Every point of the whole tooth side is held against the mate's polar profile, at 40 phases over a pitch.
    """
    working = math.acos((own.base_radius + mate.base_radius) / centre)
    line = centre * math.sin(working)
    radius = np.linspace(own.root_radius, own.tip_radius, 1001)
    half = own.half_angle(radius)
    worst = -math.inf
    for phase in np.linspace(0.0, own.pitch_angle, 40, endpoint=False):
        pushed = []
        for k in (-2, -1, 0, 1, 2):
            point = radius * np.exp(1j * (phase + k * own.pitch_angle + half))
            rho, angle = np.abs(centre - point), np.arctan2(point.imag, centre - point.real)
            near = (rho <= mate.tip_radius) & (rho >= mate.root_radius)
            if near.any():
                pushed.append((angle[near] + mate.half_angle(rho[near])).max() - k * mate.pitch_angle)
        own_roll = (phase + own.base_half_angle + working) * own.base_radius
        conjugate = working + mate.base_half_angle - (line - own_roll) / mate.base_radius
        worst = max(worst, (max(pushed) - conjugate) * mate.base_radius)
    return worst


PAIRS = [
    # teeth, teeth, degrees, shift of both (sum 0), mate's addendum, rack tip radius, centre distance over standard, clears
    (12, 24, 20.0, 0.0, 1.0, 0.25, 0.0, True),
    (12, 24, 20.0, 0.0, 1.0, 0.38, 0.0, True),
    (17, 24, 20.0, 0.0, 1.2223, 0.38, 0.0, False),
    (17, 24, 20.0, 0.0, 1.2223, 0.38, 0.1, True),
    (10, 40, 20.0, 0.0, 1.2471, 0.30, 0.0, False),
    (17, 100, 14.5, 0.172, 1.2472, 0.30, 0.0, False),
    (17, 100, 14.5, 0.172, 1.0, 0.30, 0.0, True),
    (40, 40, 20.0, 0.0, 1.24, 0.38, 0.0, False),
    (24, 100, 25.0, 0.0, 1.1, 0.10, 0.0, True),
]


@pytest.mark.parametrize(("teeth", "mate_teeth", "degrees", "shift", "addendum", "rho", "apart", "clears"), PAIRS)
def test_a_tip_in_the_fillet_is_found_by_contact_of_whole_profiles(
    teeth, mate_teeth, degrees, shift, addendum, rho, apart, clears
):
    alpha = math.radians(degrees)
    own = Gear.from_spec(GearSpec("pinion", teeth, 1.0, 5.0, alpha, profile_shift=shift, rack_tip_radius=rho))
    mate = Gear.from_spec(
        GearSpec("gear", mate_teeth, 1.0, 5.0, alpha, profile_shift=-shift, addendum=addendum, rack_tip_radius=rho)
    )
    centre = own.reference_radius + mate.reference_radius + apart
    advance, depth = contact_advance(own, mate, centre), tip_penetration(own, mate, centre)
    if clears:
        assert advance < 1e-9
        assert depth < 1e-9
        check_pair(own, mate, PairSpec(centre))
    else:
        # arc about one axis against advance along the other's base circle: not the same number, but of one size
        assert 0.5 * advance < depth < 1.5 * advance
        with pytest.raises(InputError, match=rf"digs {re.escape(f'{depth:.4f}')} mm into the pinion's root fillet"):
            check_pair(own, mate, PairSpec(centre))


def test_a_tip_chamfer_lets_a_long_addendum_pass():
    own = _gear(17, "pinion", rack_tip_radius=0.38)
    sharp, chamfered = _gear(24, addendum=1.2223), _gear(24, addendum=1.2223, tip_chamfer=1.0)
    centre = own.reference_radius + sharp.reference_radius
    assert tip_penetration(own, sharp, centre) > 0.1
    assert tip_penetration(own, chamfered, centre) < 1e-9


def test_design_knows_mates_and_the_centre_distance(pinion, wheel):
    pair = Design({"pinion": pinion, "gear": wheel}, PairSpec())
    assert pair.centre_distance == pytest.approx(114.3, rel=1e-15)
    assert Design({"pinion": pinion, "gear": wheel}, PairSpec(115.0)).centre_distance == 115.0
    assert pair.mate_of("pinion") is wheel
    assert pair.mate_of("gear") is pinion
    alone = Design({"gear": wheel})
    assert alone.mate_of("gear") is None
    with pytest.raises(ValueError, match="no centre distance"):
        _ = alone.centre_distance
