"""A meshing study: what was meshed, and what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from gearwear.card import Card, Row
from gearwear.design.pair import Design
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.shafts import TakeUp
from gearwear.report.shafts import take_up_record, take_up_words
from gearwear.report.words import SPACE, listed, number, plural, sentence


@dataclass(frozen=True, slots=True)
class WornGear:
    """What of the pair is worn, for a meshing study.

    Parameters
    ----------
    part : str or None
        "pinion" or "gear"; None where both are as designed.
    source : str
        The file, or what was assumed, in words.
    loss : float
        Greatest loss of tooth thickness, mm of arc at the reference circle.
    tooth : int or None
        The tooth that has it, counted from 0; None where none has, or all that are worn have it.
    z : float or None
        Height at which it has it, mm; None likewise.
    """

    part: str | None
    source: str
    loss: float
    tooth: int | None = None
    z: float | None = None


@dataclass(frozen=True, slots=True, repr=False)
class PairStudy(Card):
    """A pair in mesh.

    Parameters
    ----------
    design : Design
    exact : ExactMeshing
        Involute relations of the gears as designed.
    worn : WornGear
    contact : ContactResult
        The flanks as they are in rigid contact, the pinion driving.
    drive_side : int
        Flank that carries: +1 left, −1 right.
    cycle : str
        "revolution" or "hunting".
    shafts : TakeUp or None
        What taking up the wear by moving the shafts would need; None without wear.
    notes : tuple of str
        What is worth knowing, each a sentence.
    """

    design: Design
    exact: ExactMeshing
    worn: WornGear
    contact: ContactResult
    drive_side: int
    cycle: str
    shafts: TakeUp | None
    notes: tuple[str, ...]

    def headline(self) -> str:
        return f"{pair_words(self)}; {self.worn.source}"

    def rows(self) -> list[Row]:
        path, contact = self.exact.path, self.contact
        low, high = contact.backlash_min.value, contact.backlash_max.value
        said = [
            ("design", f"contact ratio {path.contact_ratio:.4f}, normal backlash {number(self.exact.backlash.normal, 4)} mm"),
            (
                "worn" if self.worn.part else "in contact",
                f"transmission error {number(contact.peak_to_peak_um, 1)} µm peak to peak, normal backlash {number(low, 4)} … {number(high, 4)} mm",
            ),
        ]
        if self.shafts is not None:
            words = take_up_words(take_up_record(self.shafts)).replace(SPACE, " ")
            said += zip(("shafts", "", ""), words.replace(". ", ".\n").split("\n"), strict=False)
        return said + [("note", sentence(note)) for note in self.notes]

    def to_dict(self) -> dict[str, Any]:
        """What ``meshing.json`` holds."""
        from gearwear.report.pair_record import study_record

        return study_record(self)

    def write(self, folder: str | PathLike[str]) -> list[str]:
        """Write what ``gearwear meshing`` writes.

        Parameters
        ----------
        folder : path
            Made where it is missing; files of the same names are replaced.

        Returns
        -------
        list of str
            Names of the files.

        Raises
        ------
        InputError
            If the folder cannot be written to.
        """
        from gearwear.report.meshing import write_study
        from gearwear.report.writing import output_folder

        with output_folder(Path(folder)) as stage:
            return write_study(stage, self)


def pair_words(study: PairStudy) -> str:
    """The pair in one line: teeth, module, shifts, centre distance."""
    one, two = study.design.gears["pinion"], study.design.gears["gear"]
    shifts = (one.spec.profile_shift, two.spec.profile_shift)
    shifted = f", x = {shifts[0]:.4g} / {shifts[1]:.4g}" if any(shifts) else ""
    centre = f"{study.exact.centre_distance:.4f}".rstrip("0").rstrip(".")
    return f"z = {one.teeth} / {two.teeth}, m = {one.spec.normal_module:g} mm{shifted}, a = {centre} mm"


def teeth_words(teeth: Sequence[int], count: int) -> str:
    """Which teeth, 0-based, in few words.

    >>> teeth_words([0, 1, 2], 3), teeth_words([4], 12), teeth_words([0, 2], 12)
    ('all 3 teeth', 'tooth 5', 'teeth 1 and 3')
    """
    if len(teeth) == count:
        return f"all {plural(count, 'tooth', 'teeth')}"
    return ("tooth " if len(teeth) == 1 else "teeth ") + listed(str(tooth + 1) for tooth in teeth)
