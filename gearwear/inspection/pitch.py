"""Pitch, index, runout and tooth thickness from the flanks' positions.

A flank's position is its mean deviation δ at a circle. As an arc at the reference circle, + counter-clockwise, it is
``s δ / cos α_t`` (s = +1 left, −1 right): the index deviation. Left and right flanks are kept apart. All angles are about the axis
of the design frame; where registration took that axis from the flanks, their common eccentricity is already out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.inspection.dimensions import Pins, at_spaces, pin_radii
from gearwear.inspection.estimate import Estimate, of_statistic, simulated
from gearwear.inspection.evaluation import CommonForm, Evaluation
from gearwear.inspection.filtering import end_gap, usual_gap
from gearwear.inspection.ranges import profile_ends, profile_place
from gearwear.inspection.tolerances import Edition, sector_teeth
from gearwear.inspection.traces import Traces
from gearwear.robust import scale_about

HELD = 30
"""Points that the line through a flank at a circle rests on at least, where the flank has them."""

CARRIED = 0.25
"""Share of the evaluation range that a flank's line is carried on beyond it."""

WINDOW_SHARE = 0.05
"""Flank position: points within this share of the usable roll length on either side of the circle."""


@dataclass(frozen=True, slots=True)
class PitchDeviations:
    """Pitch deviations, mm of arc at the reference circle; side 0 left, 1 right; nan where not seen.

    Parameters
    ----------
    roll : float
        L of the measuring circle, mm.
    sector : int
        Number of pitches k of the sector deviation.
    index : Estimate
        (teeth, 2) index deviation F of every flank, + counter-clockwise, mean 0 on each side.
    single : Estimate
        (teeth, 2) f_p: index of the tooth less that of the tooth before it (clockwise of it); entry 0 closes the circle. + is a pitch
        too long.
    single_greatest, cumulative, sector_greatest, adjacent : Estimate
        (2,) greatest |f_p|, F_p (range of the index), F_pk (2013: greatest range of the index within k pitches; 1995: greatest
        change of the index over k pitches), greatest difference of neighbouring single pitches. nan on a side with a flank missing:
        what is missing may be the worst.
    """

    roll: float
    sector: int
    index: Estimate
    single: Estimate
    single_greatest: Estimate
    cumulative: Estimate
    sector_greatest: Estimate
    adjacent: Estimate


@dataclass(frozen=True, slots=True)
class Runout:
    """Runout by a ball or pin in every space.

    Parameters
    ----------
    pins : Pins
        The ball.
    radial : Estimate
        (teeth,) radius of the ball centre less nominal in mm, in the space on the counter-clockwise side of each tooth.
    runout : Estimate
        F_r, max − min; nan where a space was not seen.
    eccentricity : Estimate
        (2,) x and y of the first harmonic that most spaces share, mm; F_r of it alone is twice its length.
    """

    pins: Pins
    radial: Estimate
    runout: Estimate
    eccentricity: Estimate


def flank_positions(
    traces: Traces,
    roll: float,
    window: float,
    shared: Floats | None = None,
    own: Floats | None = None,
    common: CommonForm | None = None,
) -> Estimate:
    """Mean deviation of every flank at a circle.

    Parameters
    ----------
    traces : Traces
        Profile traces.
    roll : float
        L of the circle, mm.
    window : float
        Bins up to this far away, mm, are used, by a line through them; where they hold fewer than `HELD` points, bins farther off too.
    shared : (teeth, 2, n, m) float or None
        Errors that the bins of all flanks have in common (`registered.shared_errors`), mm.
    own : (teeth, 2, n) float or None
        Errors that the bins of one flank have together (`additive.levelling_errors`), mm.
    common : CommonForm or None
        Form that the flanks of a side have in common: what is left of it is a line.

    Returns
    -------
    Estimate
        (teeth, 2) mm; nan where the bins end before the circle, by more than chance leaves free at an end (`filtering.end_gap`), or it lies
        in a hole wider than the scan's density explains (`filtering.usual_gap`).
    """
    value, standard = np.full((2, *traces.deviation.shape[:2]), np.nan)
    moved = None if shared is None else np.full((*value.shape, shared.shape[-1]), np.nan)
    for tooth, side in np.ndindex(*value.shape):
        x, count = traces.station[tooth, side] - roll, traces.count[tooth, side]
        seen = np.isfinite(x)
        if not seen.any():
            continue
        beyond = end_gap(float(count.sum()), float(np.ptp(x[seen])))
        below, above = x[seen & (x <= 0.0)].max(initial=-np.inf), x[seen & (x > 0.0)].min(initial=np.inf)
        if np.isfinite(above - below) and above - below > max(3.0 * window, usual_gap(x[seen], count[seen].astype(np.float64))):
            continue
        across = max(abs(v) for v in (below, above) if np.isfinite(v))
        reach = max(window, across, _holding(np.abs(x[seen]), count[seen]))
        use = np.abs(x) <= reach  # a gap is nan and stays out
        off, weight = x[use], count[use].astype(float)
        if len(off) < 2 or not off.min() <= beyond or not off.max() >= -beyond or not np.ptp(off) > 0.0:
            continue
        mean = weight @ off / weight.sum()
        spread = weight @ (off - mean) ** 2
        row = weight * (1.0 / weight.sum() - mean * (off - mean) / spread)
        value[tooth, side] = row @ traces.deviation[tooth, side, use]
        together = 0.0 if own is None else float(row @ own[tooth, side, use])
        if common is not None:
            usual, error = common.at(side, np.append(off + roll, roll))
            value[tooth, side] += usual[-1] - row @ usual[:-1]
            together = math.hypot(together, float(error[-1]))
        standard[tooth, side] = np.sqrt((row**2) @ traces.standard_error[tooth, side, use] ** 2 + together**2)
        if moved is not None and shared is not None:
            moved[tooth, side] = row @ shared[tooth, side, use]
    return Estimate.plain(value, standard, moved)


def line_positions(profile: Evaluation, roll: float, common: CommonForm | None, shared: Floats | None = None) -> Estimate:
    """Deviation of every flank at a circle from its mean line and the form common to its side, where the circle is hardly seen.

    Parameters
    ----------
    profile : Evaluation
        Profiles.
    roll : float
        L of the circle, mm; nothing is said on one farther off the evaluation range than `CARRIED` of its length.
    common : CommonForm or None
        Of the profiles.
    shared : (teeth, 2, m) float or None
        What the registration does at the circle, mm.

    Notes
    -----
    In the middle of an evenly sampled range a line is surer than its slope by sqrt(12), and the two errors are independent. What levelling
    adds to the profiles (`additive.levelling_errors`), their last causes behind those of the registration, moves all of a flank's line:
    of a scan that shows half of the face it is as much as the scatter.
    """
    where = profile.range
    t = (roll - where.middle) / where.length
    value = profile.line_at(np.array([roll]))[..., 0]
    slope = profile.slope.own * where.length / where.stated
    scatter = slope * math.sqrt(1.0 / 12.0 + t**2)
    if profile.line_shared is not None:
        own = profile.line_shared[..., 0 if shared is None else shared.shape[-1] :]
        scatter = np.hypot(scatter, np.linalg.norm(own[..., 0, :] + t * own[..., 1, :], axis=-1))
    if abs(t) > 0.5 + CARRIED:
        value = np.full_like(value, np.nan)
    for side in (0, 1):
        if common is not None:
            usual, error = common.at(side, np.array([roll]))
            value[:, side] += usual[0]
            scatter[:, side] = np.hypot(scatter[:, side], error[0])
    return Estimate.plain(value, scatter, shared)


def _holding(distance: Floats, count: Ints) -> float:
    """How far away the nearest bins reach that hold `HELD` points together, mm."""
    order = np.argsort(distance)
    return float(distance[order][min(int(np.searchsorted(np.cumsum(count[order]), HELD)), len(order) - 1)])


def measuring_roll(gear: Gear) -> float:
    """L of the circle where pitch is taken: one addendum of one module below the tip, d_M = d_a − 2 m_n (unconfirmed: docs/limits.md),
    but inside the middle 80 % of the involute."""
    radius = max(gear.tip_radius - gear.orientation * gear.spec.normal_module, gear.base_radius)
    roll = float(gear.roll_length(radius))
    form, tip = profile_ends(gear)
    reach = tip - form
    return abs(min(max(profile_place(gear, roll), form + 0.1 * reach), tip - 0.1 * reach))


def pitch_deviations(
    positions: Estimate,
    gear: Gear,
    roll: float,
    sector: int | None = None,
    edition: Edition = Edition.ISO_2013,
) -> PitchDeviations:
    """Pitch deviations from the flanks' positions.

    Parameters
    ----------
    positions : Estimate
        (teeth, 2) deviations δ at the measuring circle, mm.
    gear : Gear
        The nominal gear.
    roll : float
        L where they were taken, mm.
    sector : int or None
        k; None: `tolerances.sector_teeth`.
    edition : Edition
        Whose sector deviation.

    Notes
    -----
    ``F = s δ / cos α_t``: an involute offset by δ is the same involute turned by δ / r_b. f_p closes: its sum over a whole turn is 0.
    F_pk of 2013 is the greatest range of F among k + 1 neighbours (annex D.2), f_u the greatest |f_p − that before it| (annex G,
    Formula (G.1)); both as one independent implementation reads the standard. What 1995 calls F_pk is what a Klingelnberg P40 prints.
    """
    k = sector or sector_teeth(gear.teeth, edition)
    within = range(1, k + 1) if edition is Edition.ISO_2013 else (k,)
    arc = np.array(Side) / math.cos(gear.transverse_pressure_angle)
    index = positions.value * arc
    error = positions.own * abs(arc[0])
    common = None if positions.shared is None else positions.shared * arc[:, None]
    counts = np.maximum(np.isfinite(index).sum(axis=0), 1)
    index = index - np.nansum(index, axis=0) / counts
    if common is not None:
        common = common - np.nansum(common, axis=0) / counts[:, None]
    single = index - np.roll(index, 1, axis=0)
    greatest: dict[str, list[Estimate]] = {"single": [], "cumulative": [], "sector": [], "adjacent": []}
    for side in range(len(Side)):
        complete = bool(np.isfinite(index[:, side]).all())
        noise = simulated(index[:, side], error[:, side], None if common is None else common[:, side])
        for name, statistic in (
            ("single", lambda y: np.abs(_step(y, 1)).max(axis=-1)),
            ("cumulative", lambda y: np.ptp(y, axis=-1)),
            ("sector", lambda y: np.max([np.abs(_step(y, j)).max(axis=-1) for j in within], axis=0)),
            ("adjacent", lambda y: np.abs(_step(_step(y, 1), 1)).max(axis=-1)),
        ):
            greatest[name].append(of_statistic(statistic, index[:, side], noise) if complete else Estimate.empty(()))
    return PitchDeviations(
        roll,
        k,
        Estimate.plain(index, error, common),
        Estimate.plain(
            single, np.hypot(error, np.roll(error, 1, axis=0)), None if common is None else common - np.roll(common, 1, axis=0)
        ),
        *(_stack(greatest[name]) for name in ("single", "cumulative", "sector", "adjacent")),
    )


def runout(positions: Estimate, gear: Gear, pins: Pins) -> Runout:
    """Runout by the ball method.

    Parameters
    ----------
    positions : Estimate
        (teeth, 2) deviations δ where the ball touches, mm.
    gear : Gear
        The nominal gear.
    pins : Pins
        The ball (`dimensions.over_pins`).

    Notes
    -----
    The ball centre lies on the involutes offset by half its diameter, so the two flanks of space k (left of tooth k, right of tooth
    k + 1) give ``inv α = inv α_M + (δ_left + δ_right) / (2 r_b)`` and the radius r_b / cos α; for small deviations the change is
    ``(δ_left + δ_right) / (2 sin α_M)``, + outward. In a ring both signs change.
    """
    left, right = at_spaces(positions.value)
    error = np.hypot(*at_spaces(positions.own))
    radial = pin_radii(gear, pins, left + right) - pins.centre_radius
    outward = gear.orientation * 2.0 * math.sin(pins.centre_angle)  # a thicker tooth pushes it out of a gear, and into a ring
    common = None
    if positions.shared is not None:
        left, right = at_spaces(positions.shared)
        common = (left + right) / outward
    balls = Estimate.plain(radial, error / abs(outward), common)
    complete = bool(np.isfinite(radial).all())
    spread = (
        of_statistic(lambda y: np.ptp(y, axis=-1), radial, simulated(radial, balls.own, common))
        if complete
        else Estimate.empty(())
    )
    return Runout(pins, balls, spread, _first_harmonic(balls, gear.pitch_angle))


def tooth_thickness(positions: Estimate, gear: Gear) -> Estimate:
    """Tooth thickness of every tooth, (teeth,) mm of arc at the reference circle, from deviations at that circle.

    ``s = s_drawn + (δ_left + δ_right) / cos α_t``, exact for flanks that are offset as a whole; s_drawn holds the modifications at mid-face.
    """
    cos = math.cos(gear.transverse_pressure_angle)
    return Estimate.plain(
        gear.drawn_tooth_thickness + positions.value.sum(axis=1) / cos,
        np.hypot(positions.own[:, Side.LEFT.index], positions.own[:, Side.RIGHT.index]) / cos,
        None if positions.shared is None else positions.shared.sum(axis=1) / cos,
    )


def _step(y: Floats, k: int) -> Floats:
    """Change over k teeth round the closed circle, along the last axis."""
    return np.asarray(y - np.roll(y, k, axis=-1), dtype=np.float64)


def _stack(parts: list[Estimate]) -> Estimate:
    return Estimate(*(np.array([getattr(p, name) for p in parts]) for name in ("value", "standard", "noise")))


def _first_harmonic(balls: Estimate, pitch_angle: float) -> Estimate:
    """x and y of the first harmonic of the ball positions; spaces beside worn teeth do not count; nan with fewer than five left.

    Least absolute deviations by reweighting find the harmonic most spaces agree on; least squares over those within five robust
    standard deviations of it (at least their own uncertainty) give the result.
    """
    radial, standard = balls.value, balls.own
    seen = np.flatnonzero(np.isfinite(radial))
    if len(seen) < 5:
        return Estimate.empty((2,))
    angle = (seen + 0.5) * pitch_angle
    basis = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle)])
    y, weight = radial[seen], np.ones(len(seen))
    for _ in range(50):
        off = np.abs(y - basis @ np.linalg.lstsq(basis * weight[:, None], y * weight, rcond=None)[0])
        weight = 1.0 / np.sqrt(np.maximum(off, 1e-6))
    use = off <= 5.0 * np.maximum(scale_about(off), standard[seen]) + 1e-9
    if use.sum() < 5:
        return Estimate.empty((2,))
    solve = np.linalg.pinv(basis[use])[:2]
    common = None if balls.shared is None else solve @ balls.shared[seen][use]
    return Estimate.plain(solve @ y[use], np.sqrt(solve**2 @ standard[seen][use] ** 2), common)
