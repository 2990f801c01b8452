"""How a pair may have run, and the wear that comes of it: runs of elastic teeth, each made once and kept."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.errors import InputError
from gearwear.loaded.pair_compliance import COUPLING_MODULES, PairCompliance, coupling_length
from gearwear.loaded.steel import Material
from gearwear.loaded.tooth_compliance import tooth_compliance
from gearwear.loaded.wearing import run_wear
from gearwear.meshing.path import path_of_contact
from gearwear.meshing.slices import SAME_HEIGHT, FaceParts, common_width, uneven_across_face
from gearwear.running.wear_map import WearMap

POSITIONS = 32
"""Positions a pitch of a run."""
MOMENTS = 9
"""Amounts of wear at which a run is kept; linear between."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """How a pair ran.

    Parameters
    ----------
    misalignment : float
        Gap in the plane of action over the face, mm; + opens towards z = b on the worn flanks.
    mate_rate : float
        Wear coefficient of the mate over that of the gear; 0 is a hard mate.
    mate_relief : float
        Relief at the tip of the mate, mm, from the end of single contact on.
    mate_ahead : float
        How far a tip of the mate is ahead of the pair that carries already, mm: by so much its base pitch is the greater.
    softness : float
        Factor on the compliance of teeth and bodies: of the model, or of the load.
    coupling_modules : float
        Length along the face over which slices hold together, in modules.
    corners : bool
        Whether tip corners touch, as sharp ones do; without, a pair begins and ends with the path of contact.
    stated : float
        What of `misalignment` the design states, mm; a mate that wears takes no more of it.
    """

    misalignment: float = 0.0
    mate_rate: float = 0.0
    mate_relief: float = 0.0
    mate_ahead: float = 0.0
    softness: float = 1.0
    coupling_modules: float = COUPLING_MODULES
    corners: bool = True
    stated: float = 0.0


@dataclass(frozen=True, slots=True)
class Runs:
    """The runs of one pair on the places of a map.

    Parameters
    ----------
    map : WearMap
        Says which gear, and where depths are wanted.
    mate : Gear
    centre_distance : float
        mm.
    load_per_width : float
        N/mm.
    material : Material
    longest : float
        k N up to which is run, mm²/N.
    stated : float
        Gap that the design states, mm; + opens towards z = b on the worn flanks.
    kept : dict of Conditions, nothing stated, to (MOMENTS, slices, n) float
        Depth on all places of the map by the runs that were made, mm: `of` adds to it. A copy with other depths on the map may share it, one
        with another pair must not.
    """

    map: WearMap
    mate: Gear
    centre_distance: float
    load_per_width: float
    material: Material
    longest: float
    stated: float = 0.0
    kept: dict[Conditions, Floats] = field(default_factory=dict, repr=False, compare=False)

    @property
    def amounts(self) -> Floats:
        """(MOMENTS,) k N at which a run is kept, mm²/N."""
        return np.linspace(0.0, self.longest, MOMENTS)

    @property
    def _uneven(self) -> bool:
        """Whether flanks carry unevenly across the face though nothing is askew."""
        return uneven_across_face(self.map.gear, self.mate)

    @property
    def usual(self) -> Conditions:
        """As the design states it."""
        return Conditions(misalignment=self.stated, stated=self.stated)

    def of(self, conditions: Conditions) -> Floats:
        """(MOMENTS, m) depth at the places of the map, mm."""
        conditions = replace(conditions, stated=0.0)  # a pair runs alike whether its gap was stated or not
        if conditions not in self.kept:
            depth = self._run(conditions)
            over = over_common_face(self.map, self.mate, depth.shape[1])
            self.kept[conditions] = over @ depth
            # A gap that opens the other way wears spur flanks the other way up; a helix, or one that is drawn, has no such mirror.
            if not self._uneven:
                mirrored = replace(conditions, misalignment=-conditions.misalignment)
                self.kept[mirrored] = over @ depth[:, ::-1]
        return self.kept[conditions][:, self.map.seen]

    def _run(self, conditions: Conditions) -> Floats:
        """(MOMENTS, slices of the common face, n) depth, mm."""
        gear, width = self.map.gear, common_width(self.map.gear, self.mate)
        elastic = PairCompliance(
            (tooth_compliance(gear, self.material), tooth_compliance(self.mate, self.material)),
            self.material,
            coupling_length(gear, conditions.coupling_modules),
            conditions.softness,
        )
        # Alike across the face, one slice tells it all.
        slices = self.map.slices if self._uneven or conditions.misalignment != 0.0 else 1
        states = run_wear(
            gear, self._made(conditions), self.centre_distance, self.load_per_width * width, elastic,
            self.amounts.tolist(), conditions.mate_rate, self.map.side,
            misalignment=conditions.misalignment, slices=slices, positions_per_pitch=POSITIONS,
            corners=conditions.corners,
        )  # fmt: skip
        return np.array([state.depth for state in states]) @ self._shares(states[0].roll).T

    def _shares(self, roll: Floats) -> Floats:
        """(n, cells) what each cell of a run, of equal arc about `roll`, is of each strip of the map."""
        arc = roll**2
        step = arc[1] - arc[0]
        edges = np.concatenate([arc - 0.5 * step, arc[-1:] + 0.5 * step])
        strips = self.map.roll_edges**2
        common = np.minimum(edges[1:], strips[1:, None]) - np.maximum(edges[:-1], strips[:-1, None])
        share = np.maximum(common, 0.0)
        return np.asarray(share / share.sum(axis=1, keepdims=True), dtype=np.float64)

    def _made(self, conditions: Conditions) -> Gear:
        """The mate as it was made."""
        relief, ahead = conditions.mate_relief, conditions.mate_ahead
        if relief == ahead == 0.0:
            return self.mate
        length = relief_length(self.mate, self.map.gear, self.centre_distance) if relief > 0.0 else 0.0

        def changed(side: FlankModification) -> FlankModification:
            if relief > 0.0:
                side = replace(side, tip_relief=relief, tip_relief_length=length)
            # A slope over the whole flank that is `ahead` over a base pitch.
            pitches = (self.mate.tip_roll - self.mate.form_roll) / self.mate.base_pitch
            return replace(side, profile_slope=side.profile_slope + ahead * pitches)

        spec = self.mate.spec
        return Gear.from_spec(replace(spec, left=changed(spec.left), right=changed(spec.right)))


def over_common_face(place: WearMap, mate: Gear, slices: int) -> Floats:
    """(map's slices, slices) what each of so many equal slices of the common face is of each slice of a map; the rest of that meets no mate."""
    width, count = place.gear.face_width, place.slices
    face = FaceParts.of(place.gear, mate, slices)
    low, high = face.z - 0.5 * face.widths, face.z + 0.5 * face.widths
    edges = np.linspace(0.0, width, count + 1)
    share = (np.minimum(high, edges[1:, None]) - np.maximum(low, edges[:-1, None])) * (count / width)
    return np.asarray(np.where(share > 1.0 - SAME_HEIGHT, 1.0, np.where(share < SAME_HEIGHT, 0.0, share)), dtype=np.float64)


def relief_length(mate: Gear, gear: Gear, centre_distance: float) -> float:
    """Length of roll from the highest point of single contact of the mate to its tip, mm: that of a long relief.

    Raises
    ------
    InputError
        If there is no single contact.
    """
    alone = path_of_contact(mate, gear, centre_distance).alone_pinion
    if alone is None or not mate.tip_roll - alone[1] > 0.0:
        raise InputError("the pair has no single contact below the tip of the mate: where a relief would begin is not known")
    return mate.tip_roll - alone[1]
