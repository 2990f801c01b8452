"""Composite deviations: the gear rolled with a perfect master, with one flank in contact and with both (tight mesh).

Nothing is rolled. A perfect involute touches the measured flanks on the line of action, and what stands out most along the line of contact carries.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.involute import inverse_involute
from gearwear.design.side import Side
from gearwear.inspection.areal import Areal
from gearwear.inspection.estimate import LUCK, Estimate, first_end, with_sign_of
from gearwear.inspection.evaluation import Evaluation
from gearwear.inspection.registered import motion_errors

MASTER_TEETH = 30
"""Of the master gear; it is not shifted. In first order nothing depends on it. That of a ring has half of its teeth at most, and they fill its spaces."""

POSITIONS = 32
"""Per pitch."""

NODES = 80
"""Of a flank along L."""

NOT_ADDITIVE = 2.0
"""Squares of what the cells leave, in squares of their uncertainty, from which a flank is not the sum of a profile and a helix form: worn in part, pitted."""

LEAST_ERROR = 1e-3
"""mm; what the mean of a cell is unsure by at least, so that flanks without noise are not found odd for their rounding."""

REPEATS = 64
"""Repetitions with simulated noise behind U."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Composite:
    """What rolling with a master gear would read.

    Parameters
    ----------
    master_teeth : int
        Of the master.
    centre_distance : float
        Tight centre distance of the nominal gear, without modifications of its flanks, with the master, mm.
    rotation : (n,) float
        Of the gear, rad.
    single : (2, n) float
        Advance of the master at the fixed centre distance against that gear, mm of arc at the reference circle; left flanks first.
    double : (n,) float
        Tight centre distance less `centre_distance`, mm.
    single_total, single_tooth : Estimate
        F_i′ and f_i′ of either side, (2,) mm: range over a revolution, and the greatest range within a pitch.
    double_total, double_tooth : Estimate
        F_i″ and f_i″, mm.
    """

    master_teeth: int
    centre_distance: float
    rotation: Floats
    single: Floats
    double: Floats
    single_total: Estimate
    single_tooth: Estimate
    double_total: Estimate
    double_tooth: Estimate


def evaluate_composite(gear: Gear, profile: Evaluation, areal: Areal, covariance: Floats | None = None) -> Composite | None:
    """Roll the measured flanks with a master gear.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    profile : Evaluation
        Traces, means over the face; every flank must be known.
    areal : Areal
        How the flanks vary across the face.
    covariance : (6, 6) float or None
        Of the registration; None: the pose is taken as known.

    Returns
    -------
    Composite or None
        None where a flank was not seen, or the involute is shorter than a base pitch.

    Notes
    -----
    The flank is taken as ``δ(L, z) = δ₀(L, z) + profile(L) + h(z) + ¼ S u v``, δ₀ what the drawing modifies, h what the cells of a height leave over the profile on the mean, S the twist: what many
    points say together; the greatest of single cells would be their noise. A flank that is no such sum (`NOT_ADDITIVE`), worn in part or pitted, is taken as its
    cells, each smoothed with its neighbours (1 2 1 both ways). A burr narrower than a cell is missed. The master reaches from the start of the profile
    evaluation to the tip, over the helix evaluation range.

    With the gear turned by φ and the master on +x at the working pressure angle α″, left flank k touches at
    ``L = r_b (ψ_b + α″ + φ + 2π k / z + κ (z − b/2))``, right flank k at ``L = r_b (ψ_b + α″ − φ − 2π k / z − κ (z − b/2))``. The greatest δ over all k and z,
    e_L(φ) and e_R(φ), is by how much that side leads along the line of action: single flank ``e / cos α_t`` at the reference circle. With both
    flanks in contact the base thickness has grown by e_L + e_R, so ``inv α″ = inv α_t + (s_1 + s_2 − p_t) / (2 (r_1 + r_2)) + (e_L + e_R) / (2 (r_b1 + r_b2))``
    and ``a″ = (r_b1 + r_b2) / cos α″`` (ISO 21771:2007, tight mesh without backlash). In a ring the master's radii are negative, so that more metal
    brings it closer, and places −L (`ranges.profile_place`) stand for L, with −α″ for α″. Where on the flank contact is, is taken at the nominal α″; contact
    off the line of action, of tip corners and where a flank leans (it gains ``(dδ/dL · r_b / L)² ρ / 2``), is left out. F_i′, f_i′: ISO 1328-1:1995; F_i″, f_i″: ISO 1328-2:1997.
    """
    if not (np.isfinite(profile.line[..., 0]).all() and np.isfinite(areal.flanks.twist.value).all()):
        return None
    reach = (profile.range.start, profile.range.outer)
    if reach[1] - reach[0] < gear.base_pitch:
        return None
    roll, z = np.linspace(*reach, NODES), areal.z
    flanks, across_std = _flanks(profile, areal, roll)
    # The master touches involutes: it feels what the drawing modifies, too.
    flanks += np.stack([gear.drawn(side).offset(gear.orientation * roll, z[:, None]) for side in Side])
    noise = (_profile_noise(profile, roll, flanks), _for_flanks(np.random.default_rng(1), across_std, flanks))
    columns, motions = None, np.random.default_rng(2).standard_normal((REPEATS, 6 if covariance is None else len(covariance)))
    if covariance is not None:
        along, across = (np.broadcast_to(place, flanks.shape) for place in (roll, z[:, None]))
        columns = with_sign_of(flanks, motion_errors(gear, along, across, covariance))

    def repeated(number: int) -> Floats:
        """The flanks with the errors added once more."""
        with_errors = flanks + noise[0][number][:, :, None] + noise[1][number][..., None]
        return np.asarray(with_errors if columns is None else with_errors + columns @ motions[number])

    nominal = _tight(gear, np.zeros(1))
    angle = math.acos(min(1.0, (1.0 + _ratio(gear)) * gear.base_radius / float(nominal[0])))
    first = gear.base_radius * (gear.base_half_angle + gear.orientation * angle)

    def leads(surface: Floats) -> Floats:
        return np.stack([_lead(surface[:, side.index], gear, roll, z, first, side) for side in Side])

    lead = np.stack([leads(flanks), *(leads(repeated(number)) for number in range(REPEATS))])
    if not np.isfinite(lead).all():
        return None
    double = _tight(gear, lead.sum(axis=1)) - nominal
    single = lead / math.cos(gear.transverse_pressure_angle)
    return Composite(
        master_teeth=master_teeth(gear),
        centre_distance=float(nominal[0]),
        rotation=np.arange(gear.teeth * POSITIONS) / POSITIONS * gear.pitch_angle,
        single=single[0],
        double=double[0],
        single_total=_estimate(np.ptp(single, axis=-1)),
        single_tooth=_estimate(_within_pitch(single)),
        double_total=_estimate(np.ptp(double, axis=-1)),
        double_tooth=_estimate(_within_pitch(double)),
    )


def master_teeth(gear: Gear) -> int:
    """Of the master that a gear is rolled with."""
    return MASTER_TEETH if gear.orientation > 0 else min(MASTER_TEETH, gear.teeth // 2)


def _ratio(gear: Gear) -> float:
    """The master's radii over the gear's; negative in a ring."""
    return gear.orientation * master_teeth(gear) / gear.teeth


def _tight(gear: Gear, thicker: Floats) -> Floats:
    """Tight centre distance with the master where the gear's base thickness is more by `thicker`, mm."""
    ratio = _ratio(gear)
    alpha, pitch = gear.transverse_pressure_angle, 2.0 * math.pi * gear.reference_radius / gear.teeth
    # The master's thickness is half of the pitch; in a ring that of a space, as with few teeth between the two nothing else may fit.
    excess = gear.tooth_thickness - 0.5 * pitch if ratio > 0.0 else 0.0
    involute = math.tan(alpha) - alpha + excess / (2.0 * (1.0 + ratio) * gear.reference_radius)
    base = (1.0 + ratio) * gear.base_radius
    values = involute + gear.orientation * np.asarray(thicker) / (2.0 * base)
    # A smooth function over a narrow range: Newton from the middle, all at once.
    angle = np.full(values.shape, inverse_involute(float(np.median(values))))
    for _ in range(6):
        angle = angle - (np.tan(angle) - angle - values) / np.tan(angle) ** 2
    return np.asarray(base / np.cos(angle))


def _along(evaluation: Evaluation, where: Floats, standard: bool = False) -> Floats:
    """Filtered traces, or their standard uncertainty, at `where`, (teeth, 2, n) mm; where a trace is not known, as where it begins or ends."""
    values = evaluation.standard if standard else evaluation.filtered
    read = np.empty((*values.shape[:2], len(where)))
    for flank in np.ndindex(*values.shape[:2]):
        known = np.isfinite(values[flank])
        read[flank] = np.interp(where, evaluation.station[known], values[flank][known])
    return read


def _flanks(profile: Evaluation, areal: Areal, roll: Floats) -> tuple[Floats, Floats]:
    """The flanks for contact, (teeth, 2, n_z, n) mm, and the standard uncertainty of what they do across the face, (teeth, 2, n_z) mm."""
    u, v = areal.profile_range.from_middle(roll), areal.helix_range.from_middle(areal.z)
    flanks = np.empty((*areal.cells.shape[:3], len(roll)))
    standard = np.empty(areal.cells.shape[:3])
    along = _along(profile, roll)
    for flank in np.ndindex(*areal.cells.shape[:2]):
        twist, error = 0.25 * float(areal.flanks.twist.value[flank]), areal.cell_standard[flank]
        centre = areal.profile_range.from_middle(areal.roll)
        off = areal.cells[flank] - np.interp(areal.roll, roll, along[flank]) - twist * centre * v[:, None]
        seen = np.isfinite(off)
        count = np.maximum(seen.sum(axis=1), 1)
        across = np.where(seen, off, 0.0).sum(axis=1) / count
        standard[flank] = np.sqrt(np.where(seen, error**2, 0.0).sum(axis=1)) / count
        flanks[flank] = along[flank] + across[:, None] + twist * u * v[:, None]
        if ((off - across[:, None])[seen] ** 2).mean() > NOT_ADDITIVE * max(float((error[seen] ** 2).mean()), LEAST_ERROR**2):
            smooth = _with_neighbours(areal.cells[flank])
            flanks[flank] = np.stack([np.interp(roll, areal.roll, row) for row in smooth])
    return flanks, standard


def _with_neighbours(cells: Floats) -> Floats:
    """Means of each cell and its neighbours, weights 1 2 1 both ways; cells without points are filled by them."""
    weight = np.pad(np.where(np.isfinite(cells), 1.0, 0.0), 1)
    values = np.pad(np.nan_to_num(cells), 1)
    for axis in (0, 1):
        values, weight = (np.roll(part, 1, axis) + 2.0 * part + np.roll(part, -1, axis) for part in (values, weight))
    inside = (slice(1, -1), slice(1, -1))
    return np.asarray(values[inside] / np.maximum(weight[inside], 1e-9))


def _for_flanks(random: np.random.Generator, standard: Floats, flanks: Floats) -> Floats:
    """(REPEATS, teeth, 2, n) simulated errors of `standard` (teeth, 2, n). They hang on the flanks (teeth, 2, n_z, …): which tooth is the first does not
    matter, and where the n lie along z not which end is up either."""
    ways = [first_end(flank) for flank in flanks.reshape(-1, *flanks.shape[2:])]
    rank = np.argsort(np.argsort((flanks**2).mean(axis=(2, 3)), axis=None))
    drawn = random.standard_normal((REPEATS, rank.size, standard.shape[2]))[:, rank]
    if standard.shape[2] == flanks.shape[2]:
        drawn = np.stack([drawn[:, i, ::way] for i, way in enumerate(ways)], axis=1)
    return np.asarray(drawn.reshape(REPEATS, *standard.shape) * standard, dtype=np.float64)


def _profile_noise(evaluation: Evaluation, where: Floats, flanks: Floats) -> Floats:
    """Simulated errors of the filtered traces at `where`, (REPEATS, teeth, 2, n) mm: independent half a cut-off apart, straight between."""
    knots = np.arange(where[0], where[-1] + 0.5 * evaluation.cutoff, 0.5 * evaluation.cutoff)
    standard = _along(evaluation, knots, standard=True)
    drawn = _for_flanks(np.random.default_rng(0), standard, flanks)
    place = np.clip((where - knots[0]) / (knots[1] - knots[0]), 0.0, len(knots) - 1.0)
    low = np.minimum(place.astype(np.int64), len(knots) - 2)
    return np.asarray(drawn[..., low] + (place - low) * (drawn[..., low + 1] - drawn[..., low]))


def _lead(flanks: Floats, gear: Gear, roll: Floats, z: Floats, first: float, side: Side) -> Floats:
    """By how much one side leads in each position of a revolution, mm; −inf where nothing is in contact. `flanks` (teeth, rows, nodes)."""
    step = gear.base_pitch / POSITIONS
    lean = side * gear.base_radius * gear.twist * (z - 0.5 * gear.face_width)
    low = math.floor((roll[0] - first - lean.max()) / step)
    place = np.arange(low, math.ceil((roll[-1] - first - lean.min()) / step) + 1)
    most = np.full((gear.teeth, len(place)), -np.inf)
    for row, shift in enumerate(lean):
        at = (first + place * step + shift - roll[0]) / (roll[1] - roll[0])
        touching = (at >= 0.0) & (at <= len(roll) - 1.0)
        node = np.minimum(at[touching].astype(np.int64), len(roll) - 2)
        share = at[touching] - node
        lifted = flanks[:, row, node] * (1.0 - share) + flanks[:, row, node + 1] * share
        most[:, touching] = np.maximum(most[:, touching], lifted)
    lead = np.full(gear.teeth * POSITIONS, -np.inf)
    for tooth in range(gear.teeth):
        # At position i tooth k is at place s (i + k POSITIONS), or once round from there.
        np.maximum.at(lead, (side * place - tooth * POSITIONS) % len(lead), most[tooth])
    return lead


def _within_pitch(values: Floats) -> Floats:
    """Greatest range within one pitch, over a closed revolution, along the last axis."""
    round_ = np.concatenate([values, values[..., :POSITIONS]], axis=-1)
    windows = np.lib.stride_tricks.sliding_window_view(round_, POSITIONS + 1, axis=-1)
    return np.asarray(np.ptp(windows, axis=-1).max(axis=-1))


def _estimate(values: Floats) -> Estimate:
    """The first of `values` (1 + repeats, …) as measured, the others with the errors added once more; noise as in `estimate.of_statistic`."""
    again = values[1:]
    most = (1.0 + math.sqrt(2.0)) * np.maximum(again.mean(axis=0) - values[0], 0.0) + LUCK * again.std(axis=0)
    return Estimate(values[0], again.std(axis=0), np.minimum(values[0], most))
