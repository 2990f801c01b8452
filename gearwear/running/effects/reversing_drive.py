"""A drive that reverses: the flanks of the other side slide under load too."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter
from gearwear.running.effects.base import OtherSideEffect


@dataclass(frozen=True)
class ReversingDrive(OtherSideEffect):
    """Sliding wear on the other side too; the share is k w N there over that of the side that wore more, both of single contact.

    Notes
    -----
    An even loss of the other side is no sliding: thinner teeth, abrasive wear or a coat that came off have it as well.
    """

    name: ClassVar[str] = "reversing_drive"
    phrase: ClassVar[str] = "the drive reversed: the other flanks wore by sliding too, {share} times as much"
    alternatives: ClassVar[tuple[str, ...]] = ("gear_turned_round",)
    tells_apart: ClassVar[str] = (
        "Whether the gear was ever taken off and put back the other way round, or the drive runs both ways."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("share", signed=False),)


EFFECT = ReversingDrive()
