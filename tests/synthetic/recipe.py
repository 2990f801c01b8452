"""What a synthetic scan is made of, and what is known about it afterwards."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np

from tests.synthetic.effects import Effect
from tests.synthetic.outline import PINION, Bools, Floats, GearNumbers, Ints, Outline, Surface
from tests.synthetic.pose import Rigid
from tests.synthetic.removal import Wear
from tests.synthetic.texture import Texture


@dataclass(frozen=True, slots=True)
class Hole:
    """A place without points: a ball of `radius_mm` round a point of a flank."""

    tooth: int
    side: int
    r_mm: float
    z_mm: float
    radius_mm: float


@dataclass(frozen=True, slots=True)
class Views:
    """Several views round the gear, each in a frame of its own, each seeing a sector and only the upper end face.

    `overlap` is how much wider than its share of the revolution a sector is: 0.2 is 20 % wider. `poses` empty: drawn like the practice scans'.
    """

    count: int = 4
    overlap: float = 0.7
    poses: tuple[Rigid, ...] = ()


@dataclass(frozen=True, slots=True)
class Recipe:
    """Everything about one scan but the seed.

    Parameters
    ----------
    gear : GearNumbers
    slices, points_per_tooth : int
        Planes across the face width, points a tooth in each.
    end_points : int
        On both end faces together.
    ends : str
        Which end faces are seen.
    end_inner_radius : float or None
        mm; None: the bore, or 0.45 of the root radius.
    jitter : float
        Share of the spacing by which each slice is shifted along the outline and each point along z, at random; 0 is
        the regular grid of the practice scans.
    noise_um : float
        Standard deviation of each coordinate, white.
    texture : Texture or None
    texture_seed : int or None
        The same number gives the same texture in another scan of the same part (before and after).
    outliers, lost : float
        Share of points thrown about by some tenths of a mm; share missing at random.
    holes : tuple of Hole
    wear : tuple of Wear
    effects : tuple of Effect
    fillets_follow : bool
        Whether the fillets turn with flanks that manufacture turned (hobbed), or stay (ground flanks).
    pose : str or Rigid
        "none", "mild" (tooth 1 stays tooth 1) or "any" orientation, or given.
    views : Views or None
    """

    gear: GearNumbers = PINION
    slices: int = 75
    points_per_tooth: int = 505
    end_points: int = 40_000
    ends: Literal["both", "upper", "none"] = "both"
    end_inner_radius: float | None = None
    jitter: float = 0.0
    noise_um: float = 10.0
    texture: Texture | None = None
    texture_seed: int | None = None
    outliers: float = 0.0
    lost: float = 0.0
    holes: tuple[Hole, ...] = ()
    wear: tuple[Wear, ...] = ()
    effects: tuple[Effect, ...] = ()
    fillets_follow: bool = True
    pose: Literal["none", "mild", "any"] | Rigid = "mild"
    views: Views | None = None

    def of_size(self, points: int) -> Recipe:
        """The same with about this many points, end faces with their usual 8 %, spacing in the usual proportion."""
        scale = math.sqrt(points / (75 * 505 * self.gear.teeth + 40_000 * self.gear.teeth / 12))
        slices = max(round(75 * scale), 5)
        ends = round(0.081 * points)
        return replace(self, slices=slices, points_per_tooth=round((points - ends) / (slices * self.gear.teeth)), end_points=ends)


@dataclass(frozen=True, slots=True)
class Labels:
    """Where each point of the scan belongs, (n,) each, in the scan's order."""

    surface: Ints
    """`Surface`; a worn point keeps its flank's."""
    tooth: Ints
    """0-based."""
    side: Ints
    """+1 left, −1 right of its tooth; 0 on end faces and bore."""
    roll: Floats
    """Foot's roll length L on flanks, mm; nan elsewhere."""
    z: Floats
    """Foot's height, mm."""
    depth: Floats
    """Wear depth along the as-made normal, mm."""
    deviation: Floats
    """Of the as-made worn flank from the design, along the flank's normal, mm (manufacture − wear; no texture, coating,
    scanner or noise); nan off the flanks."""
    outlier: Bools

    def take(self, which: Bools | Ints) -> Labels:
        return Labels(*(getattr(self, name)[which] for name in self.__dataclass_fields__))


@dataclass(frozen=True, slots=True)
class FlankTruth:
    """What one worn flank lost, by all wears together."""

    tooth: int
    side: int
    volume_mm3: float
    max_depth_um: float
    thickness_loss_mm: float
    """Greatest loss of arc at the reference circle."""


@dataclass(frozen=True, slots=True)
class Truth:
    """Everything that was put in; `poses` map design to scan, one per view."""

    recipe: Recipe
    seed: int
    poses: tuple[Rigid, ...]
    flanks: tuple[FlankTruth, ...]
    wear_volumes_mm3: tuple[float, ...]
    """Of each entry of `recipe.wear` alone, over all its flanks."""
    labels: Labels
    outline: Outline

    @property
    def volume_mm3(self) -> float:
        """All metal removed."""
        return sum(flank.volume_mm3 for flank in self.flanks)

    @property
    def pose(self) -> Rigid:
        return self.poses[0]

    @property
    def effects(self) -> Mapping[str, Effect]:
        return {effect.name: effect for effect in self.recipe.effects}

    def as_dict(self) -> dict[str, Any]:
        """For a truth file; keys as in the practice scans, effect names and units as in the contract."""
        recipe = self.recipe
        return {
            "gear": asdict(recipe.gear),
            "seed": self.seed,
            "points": len(self.labels.surface),
            "slices": recipe.slices,
            "points_per_tooth": recipe.points_per_tooth,
            "end_points": recipe.end_points,
            "jitter": recipe.jitter,
            "noise_mm": 1e-3 * recipe.noise_um,
            "texture": None if recipe.texture is None else asdict(recipe.texture),
            "outliers": recipe.outliers,
            "lost": recipe.lost,
            "holes": [asdict(hole) for hole in recipe.holes],
            "fillets_follow": recipe.fillets_follow,
            "effects": [{"name": e.name, "parameters": dict(e.parameters)} for e in recipe.effects],
            "wear": [
                {"shape": type(one).__name__, **asdict(one), "volume_alone_mm3": volume}
                for one, volume in zip(recipe.wear, self.wear_volumes_mm3, strict=True)
            ],
            "flanks": [asdict(flank) for flank in self.flanks],
            "volume_mm3": self.volume_mm3,
            "poses": [{"R": p.rotation.tolist(), "t": p.translation.tolist()} for p in self.poses],
            "counts": {kind.name.lower(): int(np.sum(self.labels.surface == kind)) for kind in Surface},
        }


@dataclass(frozen=True, slots=True)
class SyntheticScan:
    """A scan and its truth."""

    points: Floats
    """(n, 3) mm in the scan's own frame; all views one after the other, each in its own."""
    truth: Truth
    views: tuple[Floats, ...]
    """The same points view by view; one entry if the scan is not split."""
