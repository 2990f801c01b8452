"""What wear is allowed: the limits that a fleet is judged by."""

from __future__ import annotations

from dataclasses import dataclass, fields

from gearwear.design.quantity import as_given, at_most
from gearwear.errors import InputError

MOST = 1e9
"""mm or mm³; no wear comes near, and squares of what is larger have no number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Upper limits of wear; None where none is set.

    Parameters
    ----------
    wear_depth : float or None
        Greatest depth on any flank, mm along the normal.
    wear_volume : float or None
        Metal worn off the gear, mm³.
    thickness_loss : float or None
        Greatest loss of any tooth, mm of arc at the reference circle.
    backlash : float or None
        Greatest circumferential backlash over a revolution of the scanned gear, mm of arc, at the design's centre distance.

    Raises
    ------
    InputError
        If a limit is not a number above 0, or one that says nothing.
    """

    wear_depth: float | None = None
    wear_volume: float | None = None
    thickness_loss: float | None = None
    backlash: float | None = None

    def __post_init__(self) -> None:
        for key, value in self.by_quantity().items():
            if not 0.0 < value <= MOST:
                raise InputError(f"[limits] {key} = {value:g}: must be above 0 and at most {MOST:g}")

    def by_quantity(self) -> dict[str, float]:
        """The limits that are set, by the key of the design file, which is the quantity's name with its unit."""
        values = (getattr(self, field.name) for field in fields(self))
        return {key: value for key, value in zip(LIMIT_KEYS, values, strict=True) if value is not None}

    def check(self, pitch: float) -> None:
        """Refuse lengths that no gear of this pitch, mm, can reach: they are of another unit, and everything would keep them.

        Raises
        ------
        InputError
            If one is as large as the pitch.
        """
        for key, value in self.by_quantity().items():
            if key.endswith("_mm") and value >= pitch:
                raise InputError(
                    f"[limits] {key} = {as_given(value)}: more than the pitch of {at_most(pitch)} mm, and so none; of µm {1e-3 * value:g} would be right"
                )


LIMIT_KEYS = ("wear_depth_mm", "wear_volume_mm3", "thickness_loss_mm", "backlash_mm")
"""Keys of ``[limits]``, in the order of `Limits`."""
