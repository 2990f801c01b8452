"""A meshing study: what was meshed, and what came of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.given import check_number
from gearwear.design.pair import Design, check_design
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.quantity import SPACE, not_zero, number, sentence
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.backlash import Backlash, backlash_from_normal, overlap_words, zero_backlash_centre_distance
from gearwear.meshing.clearance import bottoming_centre_distance, interference_free_centre_distance
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing, exact_meshing
from gearwear.meshing.passes import Cycle
from gearwear.meshing.path import PathLimit, Sliding, radius_at_roll, sliding
from gearwear.meshing.recommended import RecommendedBacklash, recommended_backlash
from gearwear.meshing.shafts import TakeUp, take_up, take_up_words
from gearwear.meshing.slices import beside, facing_mate, heights_beside
from gearwear.meshing.worn_gear import Measured, WornGear, as_measured, each_measured, in_same_slices, is_tooth, uniform_loss
from gearwear.threads import on_one_thread

POSITIONS, PLACES = 34, 400
"""Positions per pitch, as in compare; places on the path of contact."""
ONE_SIDED = 0.5
"""Difference between the mean losses of a gear's two sides, as a share of the greatest of both gears, from which on it says which way the pair ran."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CentreDistances:
    """Centre distances at which something happens to the gears as designed, mm.

    Parameters
    ----------
    zero_backlash : float or None
        The backlash is gone; None for teeth so thin that the base circles meet first.
    bottoming : float
        A tip meets the root of its mate.
    interference_free : float
        From here on, with a ring up to here, neither tip passes its mate's interference point; one may still reach below a form circle.
    """

    zero_backlash: float | None
    bottoming: float
    interference_free: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ActiveProfile:
    """Where a flank is in contact.

    Parameters
    ----------
    start, end : (float, float)
        Length of roll and radius, mm.
    alone : ((float, float), (float, float)) or None
        The same of the ends of the stretch on which one pair carries alone; None where there is none.
    start_set_by : PathLimit
        What bounds it below.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    alone: tuple[tuple[float, float], tuple[float, float]] | None
    start_set_by: PathLimit


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingRow:
    """Sliding in one place of the path.

    Parameters
    ----------
    point : str
        Its name; a number where it has none.
    motion : Sliding
        Of length 1.
    radius_pinion, radius_gear : float
        mm.
    """

    point: str
    motion: Sliding
    radius_pinion: float
    radius_gear: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PairStudy(Card):
    """A pair in mesh.

    Parameters
    ----------
    design : Design
    exact : ExactMeshing
        Involute relations of the gears as designed.
    worn : WornGear
        With both gears measured the one that was given first.
    worn_mate : WornGear or None
        The other one, where both were measured.
    mate_tooth : int
        Tooth of the gear that the pinion's tooth 0 touches with its left flank, 0-based.
    contact : ContactResult
        The flanks as they are in rigid contact, the pinion driving.
    drive_side : Side
        Flank that carries.
    cycle : str
        "revolution", "driven" or "hunting".
    shafts : TakeUp or None
        What taking up the wear by moving the shafts would need; None without wear, and with a ring.
    notes : tuple of str
        What is worth knowing, each a sentence.
    flanks : (ToothProfiles, ToothProfiles)
        Of pinion and gear, as they were meshed.
    measured : tuple of ToothProfiles
        As they were read, in the order given; empty where none were.
    """

    design: Design
    exact: ExactMeshing
    worn: WornGear
    worn_mate: WornGear | None
    mate_tooth: int
    contact: ContactResult
    drive_side: Side
    cycle: Cycle
    shafts: TakeUp | None
    notes: tuple[str, ...]
    flanks: tuple[ToothProfiles, ToothProfiles]
    measured: tuple[ToothProfiles, ...] = ()

    @property
    def flank_words(self) -> str:
        """What the flanks in contact are."""
        return self.worn.source if self.worn_mate is None else f"{self.worn.source}; {self.worn_mate.source}"

    @property
    def pinion(self) -> Gear:
        """As designed."""
        return self.design.gears["pinion"]

    @property
    def gear(self) -> Gear:
        """As designed."""
        return self.design.gears["gear"]

    @property
    def heights(self) -> Floats:
        """(n,) heights at which the contact carries, mm, on the gear with worn flanks, of two the one that was given first; else on the pinion."""
        z = self.contact.z
        return beside(z, self.pinion, self.gear) if self.worn.part == "gear" else z

    @property
    def recommended(self) -> RecommendedBacklash:
        """Backlash that standards and handbooks recommend for the pair."""
        return recommended_backlash(self.pinion, self.exact.centre_distance)

    @property
    def centre_distances(self) -> CentreDistances:
        """Where the design would be without backlash, bottoms, and is free of interference."""
        try:
            zero = zero_backlash_centre_distance(self.pinion, self.gear)
        except InputError:  # the base circles meet first
            zero = None
        return CentreDistances(
            zero_backlash=zero,
            bottoming=bottoming_centre_distance(self.pinion, self.gear),
            interference_free=interference_free_centre_distance(self.pinion, self.gear),
        )

    @property
    def active_profiles(self) -> dict[str, ActiveProfile]:
        """By part."""
        path = self.exact.path
        return {
            "pinion": _active(self.pinion, path.start_pinion, path.end_pinion, path.alone_pinion, path.limit_pinion),
            "gear": _active(self.gear, path.start_gear, path.end_gear, path.alone_gear, path.limit_gear),
        }

    @property
    def greatest_backlash(self) -> Backlash:
        """Of the flanks in contact, over the cycle."""
        return self._backlash(self.contact.backlash_max.value)

    @property
    def least_backlash(self) -> Backlash:
        """Of the flanks in contact, over the cycle."""
        return self._backlash(self.contact.backlash_min.value)

    def _backlash(self, normal: float) -> Backlash:
        return backlash_from_normal(self.pinion, self.gear, self.exact.centre_distance, normal)

    @property
    def sliding(self) -> Sliding:
        """Sliding of the design all along the path of contact."""
        return self.sliding_at(np.linspace(self.exact.path.start_pinion, self.exact.path.end_pinion, PLACES))

    def sliding_at(self, rolls: Floats) -> Sliding:
        """Sliding of the design where the pinion is touched at some lengths of roll, mm."""
        return sliding(self.pinion, self.gear, self.exact.centre_distance, rolls)

    def sliding_rows(self, rolls: dict[str, float]) -> list[SlidingRow]:
        """The same by the names of the places."""
        rows = []
        for name, roll in rolls.items():
            motion = self.sliding_at(np.array([roll]))
            radii = radius_at_roll(self.pinion, motion.roll_pinion), radius_at_roll(self.gear, motion.roll_gear)
            rows.append(SlidingRow(point=name, motion=motion, radius_pinion=float(radii[0][0]), radius_gear=float(radii[1][0])))
        return rows

    def headline(self) -> str:
        return f"{pair_words(self)}; {self.flank_words}"

    def rows(self) -> list[CardRow]:
        path, contact = self.exact.path, self.contact
        low, high = contact.backlash_min.value, contact.backlash_max.value
        said = [
            ("design", f"contact ratio {path.ratio_words()}, normal backlash {number(self.exact.backlash.normal, 4)} mm"),
            (
                "worn" if self.worn.part else "in contact",
                f"transmission error {number(contact.peak_to_peak_um, 1)} µm peak to peak, normal backlash {number(low, 4)} … {number(high, 4)} mm",
            ),
        ]
        if self.shafts is not None:
            words = take_up_words(self.shafts).replace(SPACE, " ")
            said += zip(("shafts", "", ""), words.replace(". ", ".\n").split("\n"), strict=False)
        return said + [("note", sentence(note)) for note in self.notes]


def _active(gear: Gear, start: float, end: float, alone: tuple[float, float] | None, limit: PathLimit) -> ActiveProfile:
    def place(roll: float) -> tuple[float, float]:
        return roll, float(radius_at_roll(gear, [roll])[0])

    return ActiveProfile(
        start=place(start),
        end=place(end),
        alone=None if alone is None else (place(alone[0]), place(alone[1])),
        start_set_by=limit,
    )


def pair_words(study: PairStudy) -> str:
    """The pair in one line: teeth, module, shifts, centre distance."""
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    shifts = (pinion.spec.profile_shift, gear.spec.profile_shift)
    shifted = f", x = {shifts[0]:.4g} / {shifts[1]:.4g}" if any(shifts) else ""
    centre = f"{study.exact.centre_distance:.4f}".rstrip("0").rstrip(".")
    helix = abs(math.degrees(pinion.helix_angle))
    module = f"{pinion.spec.normal_module:g} mm"
    module = f"m = {module}" if helix == 0.0 else f"m_n = {module}, β = {helix:.6g}°"
    inside = " (a ring)" if gear.spec.internal else ""
    return f"z = {pinion.teeth} / {gear.teeth}{inside}, {module}{shifted}, a = {centre} mm"


@on_one_thread
def study_meshing(
    design: Design,
    wear: Measured | Sequence[Measured] | None = None,
    *,
    loss: float | None = None,
    teeth: int | Sequence[int] | None = None,
    part: str | None = None,
    centre_distance: float | None = None,
    drive: Side | str | None = None,
    cycle: Cycle | None = None,
    mate_tooth: int | None = None,
) -> PairStudy:
    """A pair in mesh: the exact relations as designed, the flanks as they are in rigid contact, and what moving the shafts would do.

    Parameters
    ----------
    design : Design
        A pair.
    wear : path or ToothProfiles, a sequence of both gears', or None
        One gear as it is, or each of them: the folder that `compare` wrote to, its ``worn_profiles.npz``, measured traces as CSV
        (`gearwear.design.files.traces`), or profiles of either gear. Both have z = 0 at the same end; mid-faces are at one height.
    loss : float or None
        In place of `wear`, a uniform loss, mm along the normal, on flanks that carry.
    teeth : int, sequence of int or None
        Teeth with the loss, **counted from 1**; None: all.
    part : {"pinion", "gear"} or None
        Which one has the loss; None: the pinion.
    centre_distance : float or None
        mm, in place of the design's.
    drive : Side, {"left", "right"} or None
        Flanks that carry, the pinion driving; None: the more worn ones, else left.
    cycle : {"revolution", "driven", "hunting"} or None
        One revolution of the pinion or of the gear, or until the same teeth meet again; None: one of the gear whose flanks are worn, of the
        one with more teeth where both are, else of the pinion.
    mate_tooth : int or None
        Tooth of the gear, **counted from 1**, that meets tooth 1 of the pinion with its left flank; None: tooth 1. It matters where both
        gears are measured.

    Returns
    -------
    PairStudy

    Raises
    ------
    InputError
        If the design has one gear only, the gears do not mesh at this distance, the loss is more than a tooth has, what is given is no number
        or no gear, or what is asked for contradicts itself.

    Examples
    --------
    >>> import gearwear as gw
    >>> study = gw.study_meshing(gw.read_design(gw.example("design.toml")), loss=0.1, centre_distance=114.5)
    >>> study
    PairStudy: z = 12 / 24, m = 6.35 mm, a = 114.5 mm; 0.1 mm off the left flank of all 12 teeth of the pinion
      design  contact ratio 1.2544, normal backlash 0.1377 mm
      worn    transmission error 0.0 µm peak to peak, normal backlash 0.2377 … 0.2377 mm
      shafts  The wear is taken up with the shafts 0.145 mm closer, at 114.355 mm.
      note    The gear's tip passes the pinion's interference point by 1.403 mm of roll; its undercut root clears it.
    """
    check_design(design)
    if design.pair is None:
        raise InputError(f"{design.source or 'the design'}: has one gear; meshing needs [pinion] and [gear]")
    for name, value, allowed in (
        ("part", part, ("pinion", "gear")), ("cycle", cycle, ("revolution", "driven", "hunting"))
    ):  # fmt: skip
        if value is not None and value not in allowed:
            raise InputError(f"{name} {value!r}: {' or '.join(allowed)} would be right")
    side = Side.LEFT if drive is None else Side.of(drive)
    measured = each_measured(wear)
    if measured and loss is not None:
        raise InputError("wear and loss are both given: one of them")
    if loss is None and (teeth is not None or part is not None):
        raise InputError(f"{'part' if teeth is None else 'teeth'} says what has the loss, which is not given")
    centre = design.centre_distance if centre_distance is None else centre_distance
    check_number("centre_distance", centre, "mm")
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    if mate_tooth is not None and not is_tooth(mate_tooth, gear):
        raise InputError(f"mate tooth {mate_tooth}: the gear has teeth from 1 to {gear.teeth}, and one of them would be right")
    exact = exact_meshing(pinion, gear, centre)
    flanks = dict(zip(("pinion", "gear"), flanks_as_drawn(pinion, gear), strict=True))
    read = as_measured(design, measured)
    worn = [(own, facing_mate(profiles, pinion if own.part == "gear" else gear)) for own, profiles in read]
    notes = list(_notes(design, exact))
    if loss is not None:
        chosen = part or "pinion"
        worn = [uniform_loss(flanks[chosen], chosen, loss, teeth, facing(design.gears[chosen], side))]
    flanks.update({str(worn_gear.part): profiles for worn_gear, profiles in worn})
    parts = [worn_gear.part for worn_gear, _ in worn]
    if parts == ["gear"]:  # the slices are those of the pinion, which drives
        flanks["pinion"] = nominal_profiles(pinion, flanks["pinion"].radius, heights_beside(pinion, flanks["gear"].z, gear))
    elif len(parts) == 2 or len(flanks["pinion"].z) == 1:
        flanks["pinion"] = in_same_slices(flanks["pinion"], flanks["gear"])
    if len(parts) == 2:
        notes += _notes_of_both(design, [profiles for _, profiles in worn], mate_tooth)
    if worn and drive is None:
        lost = np.sum([_loss_by_pinion_side(profiles) for _, profiles in worn], axis=0)
        side = Side.LEFT if lost[0] >= lost[1] else Side.RIGHT
    longer = gear.teeth > pinion.teeth if len(parts) == 2 else parts == ["gear"]
    cycle = cycle or ("driven" if longer else "revolution")
    first = 0 if mate_tooth is None else mate_tooth - 1
    contact = mesh_contact(flanks["pinion"], flanks["gear"], centre, side, POSITIONS, cycle, first)
    if contact.doubt and f"as designed {contact.doubt}" not in notes:
        notes.insert(0, f"as they are {contact.doubt}")
    play = contact.backlash_min.value, contact.backlash_max.value
    gone = sum(worn_gear.loss for worn_gear, _ in worn)
    shafts = take_up(pinion, gear, centre, play, gone) if gone > 0.0 and not gear.spec.internal else None
    return PairStudy(
        design=design,
        exact=exact,
        worn=worn[0][0] if worn else WornGear(None, "both gears as designed", 0.0),
        worn_mate=worn[1][0] if len(worn) == 2 else None,
        mate_tooth=first,
        contact=contact,
        drive_side=side,
        cycle=cycle,
        shafts=shafts,
        notes=tuple(notes),
        flanks=(flanks["pinion"], flanks["gear"]),
        measured=tuple(profiles for _, profiles in read),
    )


def _loss_by_pinion_side(profiles: ToothProfiles) -> Floats:
    """(2,) mean loss of a gear on the flanks that face the pinion's left ones and its right ones, mm."""
    lost = profiles.loss.mean(axis=(0, 2, 3))
    return np.array([lost[facing(profiles.gear, side).index] for side in (Side.LEFT, Side.RIGHT)])


def _notes_of_both(design: Design, measured: Sequence[ToothProfiles], mate_tooth: int | None) -> list[str]:
    """What two measured gears leave open: which teeth meet, and whether both were scanned the same way up."""
    notes = []
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    ways = math.gcd(pinion.teeth, gear.teeth)
    if mate_tooth is None and ways > 1:
        notes.append(
            f"tooth 1 of the pinion is taken to meet tooth 1 of the gear; these gears can be put together in {ways} ways, and which one it was"
            " is told by a mate tooth that is stated"
        )
    each = [_loss_by_pinion_side(profiles) for profiles in measured]
    clear = ONE_SIDED * max(float(lost.max()) for lost in each)
    worse = {Side.LEFT if lost[0] >= lost[1] else Side.RIGHT for lost in each if abs(float(lost[0] - lost[1])) > clear}
    if len(worse) == 2:
        notes.append(
            "the flanks that are worn more do not face each other: if the pair ran one way, one of the two gears was scanned the other way up"
        )
    return notes


def facing(gear: Gear, side: Side) -> Side:
    """Flank of a gear that carries where the pinion's flank `side` does, and the other way round: the same, of a ring the other."""
    return side.opposite if gear.spec.internal else side


def flanks_as_drawn(pinion: Gear, gear: Gear) -> tuple[ToothProfiles, ToothProfiles]:
    """Both gears as designed, in sections that show what either has modified along its face; the slices are those of the pinion."""
    driven = nominal_profiles(gear)
    return nominal_profiles(pinion, z=heights_beside(pinion, driven.z, gear)), driven


def transmission_error_as_drawn(pinion: Gear, gear: Gear, centre_distance: float, drive_side: Side) -> float:
    """Transmission error of the pair as designed, mm peak to peak in rigid contact: none but what the drawing modifies."""
    if not (pinion.modified or gear.modified):
        return 0.0
    contact = mesh_contact(
        *flanks_as_drawn(pinion, gear), centre_distance, drive_side, POSITIONS, "pitch"
    )  # teeth are drawn alike
    return contact.transmission_error_max.value - contact.transmission_error_min.value


def _notes(design: Design, exact: ExactMeshing) -> tuple[str, ...]:
    """What a reader must know of the design at this centre distance."""
    tight = overlap_words(design.gears["pinion"], design.gears["gear"], exact.centre_distance, exact.backlash.normal)
    notes = [f"as designed {tight}"] if tight else []
    notes += [note for gear in design.gears.values() for note in gear.notes]
    if exact.path.total_contact_ratio < 1.0:
        notes.append(f"as designed the contact ratio is {exact.path.total_contact_ratio:.3f}: the drive is not continuous")
    for part, other, tip in (("pinion", "gear", exact.interference_pinion), ("gear", "pinion", exact.interference_gear)):
        if tip.penetration > 0.0:
            notes.append(f"the {other}'s tip digs {not_zero(tip.penetration)} mm into the {part}'s fillet: interference wear")
        elif tip.overrun > 0.0:
            root = "undercut root" if design.gears[part].undercut else "root"
            notes.append(
                f"the {other}'s tip passes the {part}'s interference point by {not_zero(tip.overrun, 3)} mm of roll; its {root} clears it"
            )
        elif tip.below_form > 1e-9:
            notes.append(
                f"the {other}'s tip reaches {not_zero(tip.below_form, 3)} mm of roll below the {part}'s form circle: no involute is there"
            )
    return tuple(notes)
