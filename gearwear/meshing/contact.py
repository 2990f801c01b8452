"""Two gears as they are, in rigid contact: tooth by tooth, slice by slice, over whole revolutions.

Serves design and worn gears alike: both come as `ToothProfiles`, either may be nominal, either may drive.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.given import check_choice, check_number, check_several, check_whole, check_within
from gearwear.design.pair import CENTRE_ROUNDING
from gearwear.design.profiles import ToothProfiles, profiles_of_pair
from gearwear.design.quantity import as_given, at_least, at_most, shown
from gearwear.design.side import Side
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError, check_kind
from gearwear.meshing.backlash import check_mesh, overlap_words, transverse_backlash
from gearwear.meshing.contact_result import ContactPattern, ContactResult, ContactVariant, Extreme
from gearwear.meshing.passes import CYCLES, Cycle, Passes, Positions, pitches
from gearwear.meshing.slices import Slices
from gearwear.processors import each
from gearwear.threads import on_one_thread

PAIRS = "pairs (driver, driven) of profiles"
_LEAST_RISE = 1e-7
"""mm; where the neighbours of an extreme differ less from it, there is nothing to search for."""

_PARTS_PER_POSITION = 16
"""Parts of the step between positions in which pairs are counted."""

_HALVINGS = 16
"""Steps of the search for an extreme: 1/65536 of the distance between positions."""

_MAX_CLIMBS = 2
"""Cusps between positions that are looked at, at most, where they may be higher than the highest found."""


@on_one_thread
def mesh_contact(
    driver: ToothProfiles,
    driven: ToothProfiles,
    centre_distance: float,
    drive_side: Side = Side.LEFT,
    positions_per_pitch: int = 17,
    cycle: Cycle = "revolution",
    start_tooth: int = 0,
    tolerances: tuple[float, ...] = (0.001, 0.010),
    variants: Sequence[tuple[ToothProfiles, ToothProfiles]] = (),
) -> ContactResult:
    """Turn two gears in rigid contact.

    Parameters
    ----------
    driver, driven : ToothProfiles
        The flanks of both gears, each in its own design frame, with mid-faces at one height; the driven one may be a ring. They touch on the face
        that both have, in the slices of `Slices`: of spur gears the driver's. A gear with one slice is taken as the same at all heights, else
        it is interpolated linearly and goes on beyond its rows as it is there.
        The last radius (of a ring the first) is the tip corner; a tip chamfer beyond it touches nothing.
    centre_distance : float
        mm; the housing.
    drive_side : Side
        Flank of the driver that carries: left (it turns counter-clockwise seen from +z) or right. Left
        flanks touch left flanks, but a ring's right ones.
    positions_per_pitch : int
        Positions while the driver turns by one tooth; 17 are 204 per revolution of 12 teeth.
    cycle : {"revolution", "driven", "hunting", "pitch"}
        One revolution of the driver or of the driven gear, or until the same teeth meet again: lcm(z1, z2) pitches. Of a gear beside a
        mate whose teeth are all alike, one revolution of its own is all there is to see.
    start_tooth : int
        Tooth of the driven gear that the driver's tooth 0 touches with its left flank; with its right flank
        it touches the next, counter-clockwise, of a ring the one before.
    tolerances : tuple of float
        mm; distances from contact at which pairs are counted. The pattern is taken at the largest.
    variants : sequence of (ToothProfiles, ToothProfiles)
        Drivers and driven gears that differ little from these, on the same radii and heights: what they would do is worked out
        beside, to first order in the difference, at a small share of the cost. Within 1 % of the difference on flanks worn by up
        to 0.1 mm, 3 % at 0.3 mm, where tip corners carry off the line of action.

    Returns
    -------
    ContactResult
        At a centre distance at which the teeth overlap its backlash is negative, and `ContactResult.doubt` says so.

    Raises
    ------
    InputError
        If half angles are missing, radii or heights do not rise, base pitches or helix angles do not match, tips dig into roots, or no
        tooth reaches the mate; if a variant has other radii or heights; if positions or teeth are no whole numbers, or the cycle is none.

    Notes
    -----
    For each pair of teeth and each slice ``g = max over the flank of (β + w(ρ))`` (see `tooth_pair`); both bodies
    are rigid, so ``φ2 = max over pairs and slices``, on the coast side the least. ``TE = r_b2 (φ2 − φ1 z1/z2 − const)``,
    ``j_bn = r_b2 (φ2,coast − φ2,drive) cos β_b``. The constant is that of the nominal involutes at this centre distance
    (ISO 21771:2007): ``r_b1 (ψ_b1 − inv α') + r_b2 (ψ_b2 − inv α') − p_b / 2``, so a perfect pair has zero error.
    In the slice at ζ from mid-face the driver is at φ1 + κ1 ζ, and the driven gear by κ1 ζ z1/z2 further on: ``φ2 = max over slices of
    φ2,slice(φ1 + κ1 ζ) − κ1 ζ z1/z2``, exact, as the motion is a plane one.

    The contact ratio is a mean over all teeth. Between positions each pair's advance is taken as linear, so the ends of the
    angle intervals are known to a fraction of a position; at 17 per pitch the ratio is good to 0.02, at 200 to 0.002.

    Examples
    --------
    >>> from gearwear.design import Gear, GearSpec
    >>> from gearwear.design.profiles import nominal_profiles
    >>> pinion, gear = (Gear.from_spec(GearSpec(name, z, 6.35, 15.0)) for name, z in (("pinion", 12), ("gear", 24)))
    >>> def design(g): return nominal_profiles(g, np.linspace(g.root_radius, g.tip_radius, 60), np.array([7.5]))
    >>> worn = design(pinion)
    >>> worn.half_angle[:, 0] -= 0.1 / pinion.base_radius           # 0.1 mm off all left flanks
    >>> result = mesh_contact(worn, design(gear), 114.3)
    >>> [round(float(um), 3) + 0.0 for um in (result.transmission_error_um.min(), result.peak_to_peak_um)]
    [-100.0, 0.0]
    """
    _check_turning(centre_distance, positions_per_pitch, start_tooth, cycle, tolerances)
    check_contact(driver, driven, centre_distance)
    _check_variants(driver, driven, variants)
    drive_side = Side.of(drive_side)
    gear, mate, n = driver.gear, driven.gear, positions_per_pitch
    passes = pitches(cycle, gear, mate)
    slices = Slices.of(driver, driven)
    run = Passes.of(*slices.cut(driver, driven), centre_distance, drive_side, n, start_tooth)
    others = [_instead(run, slices, (driver, driven), pair) for pair in variants]
    got, patterns, advance = _turned(run, others, passes, max(tolerances))
    passing = run.tooth(np.arange(passes), 0)

    nominal, lean = -0.5 * transverse_backlash(gear, mate, centre_distance), gear.base_helix_cosine
    asked = [(got.ahead, -1, False), (got.ahead + got.behind, 1, True), (got.ahead + got.behind, -1, True), (got.ahead, 1, False)]
    least, tightest, loosest, most = _extremes(run, asked)
    peak, peak_rotation = _at(run, others, (least, most, tightest, loosest))
    return ContactResult(
        rotation=np.arange(passes * n) / n * gear.pitch_angle,
        transmission_error=got.ahead - nominal,
        transmission_error_min=least._replace(value=least.value - nominal),
        transmission_error_max=most._replace(value=most.value - nominal),
        backlash=-lean * (got.ahead + got.behind),
        backlash_min=tightest._replace(value=-lean * tightest.value),
        backlash_max=loosest._replace(value=-lean * loosest.value),
        driver_tooth=got.carrying % gear.teeth,
        driven_tooth=run.mate(got.carrying) % mate.teeth,
        z=got.z,
        driver_radius=got.radius,
        driven_radius=got.mate_radius,
        pair_driver_tooth=got.tooth % gear.teeth,
        pair_driven_tooth=run.mate(got.tooth) % mate.teeth,
        pair_gap=got.gap,
        contact_ratio=tuple((t, _contact_ratio(advance, n, t)) for t in tolerances),
        driver_pattern=patterns[0].passed(passing),
        driven_pattern=patterns[1].passed(run.mate(passing)),
        driver=gear,
        driven=mate,
        peak_rotation=peak_rotation,
        peak_transmission_error=peak.ahead - nominal,
        peak_backlash=-lean * (peak.ahead + peak.behind),
        variants=tuple(
            ContactVariant(
                np.concatenate([part.ahead_of[:, v] - nominal for part in (got, peak)]),
                -lean * np.concatenate([part.ahead_of[:, v] + part.behind_of[:, v] for part in (got, peak)]),
            )
            for v in range(len(others))
        ),
        doubt=overlap_words(gear, mate, centre_distance, -lean * tightest.value),
    )


def _check_turning(
    centre_distance: float, positions_per_pitch: int, start_tooth: int, cycle: Cycle, tolerances: tuple[float, ...]
) -> None:
    """Refuse what is no number, whole number, cycle or list of tolerances."""
    check_number("centre_distance", centre_distance, "mm")
    check_whole("positions_per_pitch", positions_per_pitch, 1)
    check_whole("start_tooth", start_tooth)
    check_choice("cycle", cycle, CYCLES)
    if not isinstance(tolerances, Sequence) or not tolerances:
        raise InputError(f"tolerances {shown(tolerances)}: a sequence of one or more would be right")
    for tolerance in tolerances:
        check_within("tolerances", tolerance, 0.0, math.inf, "numbers from 0 up, in mm,")


def _check_variants(
    driver: ToothProfiles, driven: ToothProfiles, variants: Sequence[tuple[ToothProfiles, ToothProfiles]]
) -> None:
    for pair in check_several("variants", variants, PAIRS):
        for base, other in zip((driver, driven), profiles_of_pair("variants", pair, PAIRS), strict=True):
            if not (np.array_equal(base.radius, other.radius) and np.array_equal(base.z, other.z)):
                raise InputError("a variant has other radii or heights than the gear itself: the same would be right")


def _instead(
    run: Passes, slices: Slices, base: tuple[ToothProfiles, ToothProfiles], pair: tuple[ToothProfiles, ToothProfiles]
) -> Passes:
    """A variant in place of the pair itself; a gear that they share is the one object, which tells that nothing differs."""
    driver, driven = slices.cut(*pair)
    same, same_mate = (other is own for other, own in zip(pair, base, strict=True))
    return replace(run, driver=run.driver if same else driver, driven=run.driven if same_mate else driven)


def _turned(
    run: Passes, others: Sequence[Passes], passes: int, tolerance: float
) -> tuple[Positions, list[ContactPattern], Floats]:
    """A cycle in blocks that fit in memory: its positions, the patterns of both gears at `tolerance`, mm, and the advance of each pair (positions,
    columns), mm, with the position that ends the last interval of the contact ratio."""
    patterns = [ContactPattern.empty(member.gear, member.z, run.n) for member in (run.driver, run.driven)]
    size = run.passes_at_a_time()
    blocks: list[Positions] = []
    for first in range(0, passes, size):
        block, touching = run.positions(run.block(first, min(first + size, passes)), tolerance, others)
        blocks.append(block)
        patterns = [whole.touched(*part) for whole, part in zip(patterns, touching, strict=True)]
    got = Positions.joined(blocks)
    closing, _ = run.positions(run.places(np.array([passes], dtype=np.float64)), 0.0)
    return got, patterns, np.concatenate([got.ahead[:, None] - got.gap, closing.ahead[:, None] - closing.gap])


def _at(run: Passes, others: Sequence[Passes], extremes: Sequence[Extreme]) -> tuple[Positions, Floats]:
    """What happens at the extremes, in the order of rotation; and the rotation, rad."""
    rotation = np.unique([extreme.rotation for extreme in extremes])
    places, size = rotation / run.driver.gear.pitch_angle, run.searches_at_a_time()
    blocks = [run.positions(run.places(places[i : i + size]), 0.0, others)[0] for i in range(0, len(places), size)]
    return Positions.joined(blocks), rotation


def _extremes(run: Passes, asked: Sequence[tuple[Floats, int, bool]]) -> list[Extreme]:
    """Least (sign −1) or greatest (+1) values between positions, mm, and the rotations, rad.

    Extremes are cusps, where one pair hands over to the next; so they are searched for, by halving the two steps round a place. Looked at are
    the greatest sample and the cusps that may be higher, the highest first. Asked are values, their sign, and whether they are the advance
    (False) or the sum of advance and lag (True). The searches go side by side: one by one they would be many calls for few numbers.
    """
    highest = [(float((sign * values).max()), float((sign * values).argmax())) for values, sign, _ in asked]
    places = [_places(sign * values) for values, sign, _ in asked]
    size = run.searches_at_a_time()
    for number in range(1 + _MAX_CLIMBS):
        open_ = [i for i, p in enumerate(places) if number < len(p) and p[number][0] > highest[i][0] + _LEAST_RISE]
        climbs = [(places[i][number][1], *asked[i][1:]) for i in open_]
        found = each([partial(_climb, run, climbs[i : i + size]) for i in range(0, len(climbs), size)])
        for i, reached in zip(open_, chain.from_iterable(found), strict=True):
            if reached[0] > highest[i][0]:
                highest[i] = reached
    pitch = run.driver.gear.pitch_angle
    return [Extreme(sign * best, where / run.n * pitch) for (best, where), (_, sign, _) in zip(highest, asked, strict=True)]


def _places(values: Floats) -> list[tuple[float, float]]:
    """Where the highest value is looked for: how high it may be there, and the place, in positions."""
    high, start = _cusps(values)
    places = [(float(high[i]), float(start[i])) for i in np.argsort(-high)[:_MAX_CLIMBS]]
    at = int(values.argmax())
    if np.abs(values[[at - 1, (at + 1) % len(values)]] - values[at]).max() > _LEAST_RISE:
        places.insert(0, (np.inf, float(at)))
    return places


def _cusps(values: Floats) -> tuple[Floats, Floats]:
    """Where the lines from both sides meet between each position and the next, and at which place; −inf where they do not rise to it."""
    before, after, beyond = (np.roll(values, way) for way in (1, -1, -2))
    up, down = values - before, after - beyond
    rises = (up > 0.0) & (down > 0.0)
    share = np.clip((after + down - values) / np.where(rises, up + down, 1.0), 0.0, 1.0)
    return np.where(rises, values + up * share, -np.inf), np.arange(len(values)) + share


def _climb(run: Passes, climbs: Sequence[tuple[float, int, bool]]) -> list[tuple[float, float]]:
    """Highest values (times the sign) about places, and where; places in positions from the start of the cycle."""
    start, sign = (np.array([climb[i] for climb in climbs]) for i in range(2))
    passing = start.astype(np.int64) // run.n
    sides = [(run.side, run.side.opposite) if both else (run.side,) for _, _, both in climbs]
    of = np.repeat(np.arange(len(climbs)), [len(one) for one in sides])
    advances = run.advances_near(passing[of], [side for one in sides for side in one])
    first = np.flatnonzero(np.diff(of, prepend=-1))

    def values(at: Floats) -> Floats:
        return sign * np.add.reduceat(advances(at[:, of]), first, axis=1)

    place, step = start / run.n - passing, 0.5 / run.n
    best = values(place[None])[0]
    for _ in range(_HALVINGS):
        tried = place + step * np.array([[-1.0], [1.0]])
        heights = values(tried)
        highest = heights.argmax(axis=0)[None]
        height, there = (np.take_along_axis(one, highest, axis=0)[0] for one in (heights, tried))
        place, best = np.where(height > best, there, place), np.maximum(height, best)
        step *= 0.5
    return list(zip(best.tolist(), ((passing + place) * run.n).tolist(), strict=True))


def _contact_ratio(advance: Floats, n: int, tolerance: float) -> float:
    """Mean number of pairs within `tolerance` of contact; (n + 1, m) advances, linear between positions for each pair.

    A pair keeps its column while a pass lasts and moves up by one when the next begins. Leads, not gaps, are
    interpolated: at a hand-over one pair leaves where the other arrives, and there is always one in contact.
    """
    before = advance[:-1]
    after = advance[1:].copy()
    moved = np.arange(1, len(advance)) % n == 0
    after[moved, :-1], after[moved, -1] = after[moved, 1:], -np.inf
    counted = 0
    for part in (np.arange(_PARTS_PER_POSITION) + 0.5) / _PARTS_PER_POSITION:
        between = (1.0 - part) * before + part * after
        counted += int((between >= between.max(axis=1, keepdims=True) - tolerance).sum())
    return counted / (_PARTS_PER_POSITION * len(before))


def check_contact(driver: ToothProfiles, driven: ToothProfiles, centre: float) -> None:
    """Refuse flanks that are not known everywhere, and gears that do not mesh at this centre distance, mm: tips must not meet roots."""
    for part, profiles in (("driver", driver), ("driven gear", driven)):
        check_kind(profiles, ToothProfiles, part, "what gw.nominal_profiles returns")
        missing = int((~np.isfinite(profiles.half_angle)).sum())
        if missing:
            raise InputError(
                f"{part}: {missing} half angles are not finite; every flank must be known, or filled in, before contact"
            )
        for name, values, least in (("radius", profiles.radius, 2), ("z", profiles.z, 1)):
            if len(values) < least or not (np.diff(values) > 0.0).all():
                raise InputError(f"{part}: {name} must rise strictly and have at least {least} value(s)")
    gear, mate = driver.gear, driven.gear
    if not math.isfinite(centre):
        raise InputError(f"centre distance {centre:g} mm: a finite one would be right")
    refuse(gear, "contact with the ring as the driver, instead of its pinion,", Toothing.INTERNAL)
    check_mesh(gear, mate)
    if mate.spec.internal:
        bases = mate.base_radius - gear.base_radius
        most = float(min(mate.root_radius - driver.radius[-1], driven.radius[0] - gear.root_radius))
        if not bases < centre <= most + CENTRE_ROUNDING:
            raise InputError(
                f"centre distance {as_given(centre)} mm: inside this ring it must lie between {at_least(bases)} and {at_most(most)} mm"
            )
        return
    roots = float(max(driver.radius[-1] + mate.root_radius, driven.radius[-1] + gear.root_radius))
    bases = gear.base_radius + mate.base_radius
    if not (centre > roots - CENTRE_ROUNDING and centre > bases):
        raise InputError(
            f"centre distance {as_given(centre)} mm: tips meet roots; it must be above {at_least(max(roots, bases))} mm"
        )
