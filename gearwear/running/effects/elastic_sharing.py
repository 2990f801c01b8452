"""Elastic load sharing: teeth give way, so that pairs share the load as their stiffness and their wear say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.running.conditions import Conditions
from gearwear.running.effects.base import RunEffect


@dataclass(frozen=True)
class ElasticSharing(RunEffect):
    """What the closed-form law lacks: its load sharing is assumed, and does not change with wear.

    Notes
    -----
    Elastic teeth in contact (`gearwear.loaded`), flanks updated while they wear: double contact unloads itself once wear reaches about half of
    the elastic lag, and the mate's tip corner digs below the path. All other effects of a run are with it.
    """

    name: ClassVar[str] = "elastic_sharing"
    phrase: ClassVar[str] = "teeth shared the load as elastic teeth do, and ever less of it where they had worn"
    tells_apart: ClassVar[str] = "The load it ran at, or a scan at another number of cycles."

    def applied(self, conditions: Conditions, size: float) -> Conditions:
        return conditions


EFFECT = ElasticSharing()
