"""The truth in the words of the report: a spur gear may come back some teeth further, or with its ends swapped."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from tests.synthetic import Effect, Outline, PoseError
from tests.synthetic.effects import Value, anisotropy_direction
from tests.synthetic.pose import Rigid


@dataclass(frozen=True, slots=True)
class Placement:
    """How the found frame lies to the true one: θ found = ± θ true + teeth · pitch angle.

    Parameters
    ----------
    teeth : int
        Pitches turned.
    flipped : bool
        Whether the ends are swapped, and with them left and right.
    """

    teeth: int
    flipped: bool

    @classmethod
    def of(cls, error: PoseError) -> Placement:
        return cls(error.teeth, error.flipped)

    def flank(self, tooth: int, side: int, teeth: int) -> tuple[int, int]:
        """Tooth (0-based) and side as found."""
        return ((-tooth if self.flipped else tooth) + self.teeth) % teeth, -side if self.flipped else side


def as_found(effect: Effect, placement: Placement, outline: Outline, pose: Rigid, axes: Floats) -> Mapping[str, Value]:
    """The parameters a perfect fit would report.

    Parameters
    ----------
    effect : Effect
        As put in, in the true design frame.
    placement : Placement
        Of the registration found.
    outline : Outline
        The gear.
    pose : Rigid
        True pose (the anisotropic scale lives in the scan's own axes).
    axes : (3, 3) float
        The registration's rotation: columns are the scan's own axes in the found frame.
    """
    p, flip = dict(effect.parameters), placement.flipped
    shift = math.degrees(placement.teeth * outline.pitch_angle)
    match effect.name:
        case "axis_offset_lateral" | "taper" | "twist":
            return {name: -float(value) for name, value in p.items()} if flip else p  # type: ignore[arg-type]
        case "profile_slope" if flip:
            return {"left_um": p["right_um"], "right_um": p["left_um"]}
        case "pitch" | "thickness_variation":
            ((name, amounts),) = p.items()
            given = np.asarray(amounts)
            found = np.zeros_like(given)
            for tooth, value in enumerate(given):
                found[placement.flank(tooth, 1, len(given))[0]] = -value if flip and effect.name == "pitch" else value
            return {name: tuple(found.tolist())}
        case "turntable_angle":
            turned = effect["order"] * shift
            phase = 180.0 - turned - effect["phase_deg"] if flip else effect["phase_deg"] - turned
            return p | {"phase_deg": phase % 360.0}
        case "scan_drift":
            return p | {"start_deg": (shift - effect["start_deg"] if flip else shift + effect["start_deg"]) % 360.0}
        case "feed_marks" if flip:
            return p | {"phase_deg": (-360.0 * outline.face_width / effect["wavelength_mm"] - effect["phase_deg"]) % 360.0}
        case "scale_anisotropic":
            direction = anisotropy_direction(effect, pose)
            direction = (-direction if flip else direction) + placement.teeth * outline.pitch_angle
            own = axes.T @ np.array([math.cos(direction), math.sin(direction), 0.0])
            return p | {"direction_deg": math.degrees(math.atan2(own[1], own[0])) % 180.0}
        case _:
            return p


def turn_error(name: str, found: float, true: float) -> float:
    """Found minus true; angles the shortest way round (a direction without an arrow repeats after 180°)."""
    period = {"phase_deg": 360.0, "start_deg": 360.0, "direction_deg": 180.0}.get(name)
    error = found - true
    return error if period is None else (error + 0.5 * period) % period - 0.5 * period
