"""Wear that runs: Archard's law with the loads of elastic teeth, and flanks that change as they wear.

In one position of the mesh a slice slides by ``|L1 − L2 / u| dφ`` under the load w per width, and loses ``k w`` times that in
cross-section, spread over the Hertzian contact as its pressure is. Flanks are updated while they wear; contact is worked out anew each time, so
that worn places unload themselves. The time that counts is k N, wear coefficient of the driver times its mesh cycles: k alone is never known.

On helical gears depths are along the normal in space. A slice dz of the flank carries the normal force w dz / cos β_b, w the transverse one per
width, and an element of its area is ds dz / cos β_b, s the arc of the profile; so ∫ depth ds is ``k w |L1 − L2 / u| dφ`` whatever the angle. Along the
transverse base tangent the depth is that over cos β_b, and a contact across the line is 1 / cos β_b as wide along the profile.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles
from gearwear.design.side import Side
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError
from gearwear.loaded.contact import loaded_contact
from gearwear.loaded.distribution import distribute
from gearwear.loaded.hertz import half_width
from gearwear.loaded.pair_compliance import PairCompliance, curvature_radius
from gearwear.loaded.result import LoadedContact
from gearwear.loaded.rigid_advance import RigidAdvance, rigid_advance
from gearwear.meshing.slices import FaceParts
from gearwear.threads import on_one_thread

POSITIONS = 120
"""Positions per pitch."""
CELLS = 120
"""Cells of equal arc from the form circle to the tip."""
STEP_TO_LAG = 0.3
"""Greatest depth between updates as a share of the mean lag: beyond about 1 load sharing would swing to and fro."""
GREATEST_STEP = 0.003
"""mm; the same in any case."""
LEAST_WIDTH_TO_STEP = 0.6
"""Half width of the contact over which wear is spread, at least, in steps from one position to the next."""
MOST_UPDATES = 2000
"""Updates after which a run is given up."""
_ROOT_KNOTS = 12


@dataclass(frozen=True, slots=True)
class WornPair:
    """A pair after some wear; all teeth of a gear alike.

    Parameters
    ----------
    time : float
        k N so far, mm²/N: in single contact the depth is ``time · w · |K|``.
    roll, mate_roll : (n,) float
        Lengths of roll of driver and driven gear, mm, rising.
    depth, mate_depth : (s, n) float
        Normal depth lost on the flanks that carry, mm, by slice of the common face; of a double helical gear those of the lower half first.
    contact : LoadedContact
        The pair as it is then, over one pitch.
    """

    time: float
    roll: Floats
    mate_roll: Floats
    depth: Floats
    mate_depth: Floats
    contact: LoadedContact


@on_one_thread
def run_wear(
    driver: Gear,
    driven: Gear,
    centre_distance: float,
    force: float,
    compliance: PairCompliance,
    times: Sequence[float],
    mate_rate: float = 0.0,
    side: Side = Side.LEFT,
    *,
    misalignment: float = 0.0,
    slices: int = 1,
    positions_per_pitch: int = POSITIONS,
    corners: bool = True,
) -> tuple[WornPair, ...]:
    """Wear a pair that was new, at constant load.

    Parameters
    ----------
    driver, driven : Gear
        As designed.
    centre_distance : float
        mm.
    force : float
        Transverse force on all pairs, N, above 0.
    compliance : PairCompliance
    times : sequence of float
        k N at which the pair is wanted, mm²/N, rising, from 0 on.
    mate_rate : float
        Wear coefficient of the driven gear over that of the driver; 0 is a hard mate.
    side : Side
        Flanks of the driver that carry.
    misalignment : float
        Gap over the common face width, mm, as in `loaded_contact`, but + opens towards the upper end on either side.
    slices, positions_per_pitch : int
    corners : bool
        As in `loaded_contact`.

    Returns
    -------
    tuple of WornPair
        One per time.

    Raises
    ------
    InputError
        If there is no force, times do not rise, or wear is so fast that the run does not end.

    Notes
    -----
    Explicit steps: loads of one update hold until the greatest depth has grown by `STEP_TO_LAG` of the mean lag, or by `GREATEST_STEP`.
    In single contact the depth is k w N |K| to 1 % (a test holds it). The sliding is that of the flanks as designed.
    """
    wanted = [float(time) for time in times]
    if not force > 0.0 or wanted != sorted(wanted) or (wanted and wanted[0] < 0.0) or not mate_rate >= 0.0:
        raise InputError("wear: a force above 0, times that rise from 0 on and a mate's rate of 0 or above are needed")
    face = FaceParts.of(driver, driven, slices)
    states = _states(
        _Flanks.of(driver, face.z), _Flanks.of(driven, face.mate_z), slices,
        centre_distance, force, compliance, mate_rate, side, misalignment, positions_per_pitch, corners, wanted,
    )  # fmt: skip
    return tuple(states)


@dataclass(frozen=True, slots=True)
class _Flanks:
    """Flanks of one gear, all alike: cells of equal arc, and the knots of its profiles."""

    gear: Gear
    z: Floats
    edges: Floats
    """(n + 1,) Arc from the base circle at the edges of the cells, mm: L² / (2 r_b)."""
    knots: Floats
    """(k,) radii of the profiles, mm."""
    made: Floats
    """(2, s, k) half angles as designed, rad."""

    @classmethod
    def of(cls, gear: Gear, z: Floats) -> _Flanks:
        refuse(gear, "wear that runs", Toothing.INTERNAL)
        ends = np.array([gear.form_roll, gear.tip_roll]) ** 2 / (2.0 * gear.base_radius)
        edges = np.linspace(ends[0], ends[1], CELLS + 1)
        radius = np.sqrt(gear.base_radius**2 + gear.base_radius * (edges[1:] + edges[:-1]))
        root = np.linspace(gear.root_radius, radius[0], _ROOT_KNOTS + 1)[:-1]
        knots = np.concatenate([root, radius, [gear.flank_end_radius]])
        return cls(gear, z, edges, knots, gear.half_angles(knots, z))

    @property
    def roll(self) -> Floats:
        """(n,) of the middle of the cells, mm."""
        return np.sqrt(2.0 * self.gear.base_radius * 0.5 * (self.edges[1:] + self.edges[:-1]))

    def profiles(self, depth: Floats, side: Side) -> ToothProfiles:
        """The gear with this depth (s, n) off the flanks of one side."""
        # The root goes with the lowest cell: a ledge left there would carry, and what it lost be taken off that cell without end.
        lost = np.concatenate([np.repeat(depth[:, :1], _ROOT_KNOTS, axis=1), depth, depth[:, -1:]], axis=1)
        psi = self.made.copy()
        psi[side.index] -= lost / self.gear.normal_lever
        return ToothProfiles(self.gear, self.knots, self.z, np.broadcast_to(psi, (self.gear.teeth, *psi.shape)))

    def spread(self, section: Floats, roll: Floats, contact: Floats, step: float) -> Floats:
        """Depth (s, n), mm, of cross-sections lost (p, m, s), mm², about lengths of roll, over contacts of a half width, mm.

        The pressure is an ellipse; it is integrated over the cells by its primitive.
        """
        middle = roll**2 / (2.0 * self.gear.base_radius)
        # From one position to the next the contact moves by `step` of roll, so by L / r_b of it along the arc.
        along = contact / self.gear.base_helix_cosine
        reach = np.maximum(along, LEAST_WIDTH_TO_STEP * np.maximum(roll, step) / self.gear.base_radius * step)
        middle = np.clip(middle, self.edges[0], self.edges[-1])
        way = np.clip((self.edges - middle[..., None]) / reach[..., None], -1.0, 1.0)
        under = 0.5 + (way * np.sqrt(1.0 - way * way) + np.arcsin(way)) / np.pi
        share = np.diff(under, axis=-1)
        share /= share.sum(axis=-1, keepdims=True)  # at the ends of the flank all of it comes off what is left of the contact
        whole = np.einsum("pms,pmsn->sn", section, share)
        return np.asarray(whole / np.diff(self.edges), dtype=np.float64)


def _states(
    flanks: _Flanks,
    mate_flanks: _Flanks,
    slices: int,
    centre_distance: float,
    force: float,
    compliance: PairCompliance,
    mate_rate: float,
    side: Side,
    misalignment: float,
    positions: int,
    corners: bool,
    wanted: Sequence[float],
) -> Iterator[WornPair]:
    """The pair at each of the times wanted."""
    ratio = mate_flanks.gear.teeth / flanks.gear.teeth
    depth, mate_depth = (np.zeros((len(side_flanks.z), CELLS)) for side_flanks in (flanks, mate_flanks))
    time, turn = 0.0, flanks.gear.pitch_angle / positions
    step_roll = flanks.gear.base_pitch / positions
    queue = list(wanted)
    for _ in range(MOST_UPDATES):
        contact = loaded_contact(
            flanks.profiles(depth, side), mate_flanks.profiles(mate_depth, side), centre_distance, force, compliance, side,
            misalignment=side * misalignment, positions_per_pitch=positions, slices=slices, cycle="pitch", corners=corners,
        )  # fmt: skip
        while queue and queue[0] <= time:
            yield WornPair(time, flanks.roll, mate_flanks.roll, depth, mate_depth, contact)
            queue.pop(0)
        if not queue:
            return
        section = contact.load * np.abs(contact.roll - contact.mate_roll / ratio) * turn
        width = contact.contact_half_width
        rate = flanks.spread(section, contact.roll, width, step_roll)
        mate = mate_rate / ratio * mate_flanks.spread(section, contact.mate_roll, width, step_roll)
        most = min(GREATEST_STEP, STEP_TO_LAG * contact.mean_lag)
        grown = min(most / max(float(rate.max()), float(mate.max())), queue[0] - time)
        depth, mate_depth, time = depth + grown * rate, mate_depth + grown * mate, time + grown
    raise InputError(f"wear: more than {MOST_UPDATES} updates of the flanks; fewer cycles or a greater load would be right")


@dataclass(frozen=True, slots=True)
class WearMember:
    """One of several runs of the same pair at the same load.

    Parameters
    ----------
    compliance : PairCompliance
        Of one gear material and the same flattening for all members.
    mate_rate : float
        As in `run_wear`.
    """

    compliance: PairCompliance
    mate_rate: float


@on_one_thread
def run_wear_ensemble(
    driver: Gear,
    driven: Gear,
    centre_distance: float,
    load_per_width: float,
    members: Sequence[WearMember],
    times: Floats,
    positions_per_pitch: int = POSITIONS,
    corners: bool = True,
) -> tuple[Floats, Floats]:
    """Several runs of an aligned pair side by side: what `run_wear` gives with one slice, at a small share of its cost.

    Parameters
    ----------
    driver, driven, centre_distance
        As for `run_wear`.
    load_per_width : float
        N/mm.
    members : sequence of WearMember
    times : (m,) float
        k N at which depths are wanted, mm²/N, rising from 0; linear between updates.
    positions_per_pitch, corners
        As for `run_wear`.

    Returns
    -------
    roll : (n,) float
        mm, on the driver.
    depth : (members, m, n) float
        Of the driver's flank, mm.

    Raises
    ------
    InputError
        If the gears are helical.
    """
    # Members stand side by side as slices of one face that know nothing of each other.
    for gear in (driver, driven):
        refuse(gear, "wear of slices that stand for runs", Toothing.HELICAL)
    count, side = len(members), Side.LEFT
    face = FaceParts.of(driver, driven, count)
    flanks, mate_flanks = _Flanks.of(driver, face.z), _Flanks.of(driven, face.mate_z)
    ratio = driven.teeth / driver.teeth
    turn, step_roll = driver.pitch_angle / positions_per_pitch, driver.base_pitch / positions_per_pitch
    rates = np.array([member.mate_rate for member in members])[:, None] / ratio
    depth, mate_depth, time = np.zeros((count, CELLS)), np.zeros((count, CELLS)), np.zeros(count)
    kept_time, kept_depth = [time], [depth]
    for _ in range(MOST_UPDATES):
        rigid = rigid_advance(
            flanks.profiles(depth, side), mate_flanks.profiles(mate_depth, side), centre_distance, side, positions_per_pitch, count, "pitch", 0, 0.0,
            corners=corners,
        )  # fmt: skip
        forces, lag = _forces(rigid, load_per_width, members)
        roll, mate = rigid.roll, rigid.mate_roll
        section = forces * np.abs(roll - mate / ratio) * turn
        reach = half_width(forces, curvature_radius(roll, mate, driver.base_helix_cosine), members[0].compliance.material)
        rate = flanks.spread(section, roll, reach, step_roll)
        mate_rate = rates * mate_flanks.spread(section, mate, reach, step_roll)
        most = np.minimum(GREATEST_STEP, STEP_TO_LAG * lag)
        fastest = np.maximum(rate.max(axis=1), mate_rate.max(axis=1))
        grown = np.minimum(most / fastest, times[-1] - time)
        depth, mate_depth, time = depth + grown[:, None] * rate, mate_depth + grown[:, None] * mate_rate, time + grown
        kept_time.append(time)
        kept_depth.append(depth)
        if (time >= times[-1]).all():
            break
    else:
        raise InputError(f"wear: more than {MOST_UPDATES} updates of the flanks; fewer cycles or a greater load would be right")
    moments, states = np.array(kept_time), np.array(kept_depth)
    depths = np.empty((count, len(times), CELLS))
    for member in range(count):
        place = np.clip(np.searchsorted(moments[:, member], times, side="right") - 1, 0, len(moments) - 2)
        span = np.maximum(moments[place + 1, member] - moments[place, member], 1e-300)
        part = np.clip((times - moments[place, member]) / span, 0.0, 1.0)[:, None]
        depths[member] = (1.0 - part) * states[place, member] + part * states[place + 1, member]
    return flanks.roll, depths


def _forces(rigid: RigidAdvance, load_per_width: float, members: Sequence[WearMember]) -> tuple[Floats, Floats]:
    """Load per width (p, m, e), N/mm, and mean lag (e,), mm, of members that stand side by side; each takes 1 mm."""
    positions, pairs, count = rigid.advance.shape
    width = np.ones(1)

    def by_member(values: Floats) -> Floats:
        return values.transpose(2, 0, 1).reshape(count * positions, pairs, 1)

    roll, mate, advance = by_member(rigid.roll), by_member(rigid.mate_roll), by_member(rigid.advance)
    matrix = np.concatenate([
        member.compliance.matrix((roll[at : at + positions], mate[at : at + positions]), width)
        for member, at in zip(members, range(0, count * positions, positions), strict=True)
    ])  # fmt: skip
    flattening = members[0].compliance.flattening((roll, mate), width, load_per_width)
    solved = distribute(advance[..., 0], matrix, load_per_width, flattening.of)
    lag = (advance[..., 0].max(axis=1) - solved.advance).reshape(count, positions).mean(axis=1)
    return solved.force.reshape(count, positions, pairs).transpose(1, 2, 0), lag
