"""What a scan can show of an effect, from the truth alone: the limit below which not finding it is no fault.

The field of the effect is measured on the generator's own displaced points, without noise. What the pose, the levels that the
drawing's tolerances leave open and the other effects of the scan could take up is projected out. The rest is set against the true noise and texture, with
their true correlation: an effect counts as detectable where

* a test that knew everything but its amplitude, at the family-wise level the loop uses, would find it with 95 % power, and
* what is left of it is at least the least contribution the loop names (a share of the point noise), and stays so two
  standard errors lower.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize, stats
from scipy.spatial import cKDTree

from benchmarks.loop_study.fitting import Fitted
from benchmarks.loop_study.scenario import Scenario
from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.surface import BORE, END_HIGH, END_LOW, ROOT, TIP, locate
from gearwear.diagnose.rules import RULES
from gearwear.placing.cells import Cells, bin_points
from gearwear.placing.pose import Pose, least_turn
from tests.synthetic import Effect, Surface, SyntheticScan, Texture, make_scan

POWER = 0.95
ERRORS = 2.0


@dataclass(frozen=True, slots=True)
class Visibility:
    """How much of an effect a scan shows.

    Parameters
    ----------
    contribution : float
        Root mean square of its own part, mm.
    snr : float
        That part over its own standard error: square root of the expected χ².
    power : float
        Chance that a test that knew everything else would find it.
    detectable : bool
    limit : float
        Factor on its size at which it would be at the limit.
    """

    contribution: float
    snr: float
    power: float
    detectable: bool
    limit: float


def visibility(fields: list[Floats], which: int, pose: Floats, weight: Floats, cover: Cover, rule: Rule) -> Visibility:
    """Visibility of one field among the others.

    Parameters
    ----------
    fields : list of (m,) float
        Deviations of every effect of the scan, mm; 0 off the cells in use.
    which : int
        Index of the effect asked for.
    pose : (m, 6) float
        Columns of a small motion.
    weight : (m,) float
        Of the cells; 0 where not in use.
    cover : Cover
        True covariance of the cells.
    rule : Rule
        Level and least contribution.
    """
    others = np.column_stack([pose, *(f for i, f in enumerate(fields) if i != which)])
    root = np.sqrt(weight)
    q, r = np.linalg.qr(others * root[:, None])
    sound = np.abs(np.diag(r)) > 1e-9 * np.abs(np.diag(r)).max()
    own = fields[which] * root
    own = own - q[:, sound] @ (q[:, sound].T @ own)
    square = float(own @ own)
    if square < 1e-6 * float((fields[which] * root) @ (fields[which] * root)):
        return Visibility(0.0, 0.0, 0.0, False, math.inf)
    scaled = own * root
    snr = square / math.sqrt(cover.variance(scaled))
    contribution = math.sqrt(square / float(weight.sum()))
    return rule.judge(contribution, snr)


@dataclass(frozen=True, slots=True)
class Rule:
    """Significance for one effect, freedoms it has, and the least contribution in mm."""

    level: float
    freedoms: int
    least: float

    def power(self, snr: float) -> float:
        critical = stats.chi2.isf(self.level, self.freedoms)
        return float(stats.ncx2.sf(critical, self.freedoms, max(snr, 1e-9) ** 2))

    def judge(self, contribution: float, snr: float) -> Visibility:
        """Whether what is left of an effect can be found; both measures grow with its size."""
        need = optimize.brentq(lambda x: self.power(x) - POWER, 0.1, 100.0)
        # contribution · f − ERRORS · contribution / snr ≥ least
        limit = max(need / snr, self.least / contribution + ERRORS / snr)
        return Visibility(contribution, snr, self.power(snr), limit <= 1.0, limit)


@dataclass(frozen=True, slots=True)
class Cover:
    """True covariance of cell means: white noise, and a texture that hangs together within a land or a side.

    Parameters
    ----------
    white : (m,) float
        Variance of a cell's mean from its points, mm².
    blocks : tuple of ((k,) int, (k, k) float)
        Cells of one land, and their covariance from the texture, mm².
    """

    white: Floats
    blocks: tuple[tuple[Ints, Floats], ...]

    def variance(self, weights: Floats) -> float:
        """Of the sum of weights times cell means."""
        total = float((weights**2 * self.white).sum())
        for cells, covariance in self.blocks:
            part = weights[cells]
            total += float(part @ covariance @ part)
        return total


def true_cover(cells: Cells, noise_um: float, texture: Texture | None) -> Cover:
    """Covariance of the cells from what was put in; the texture averaged over cells of the grid's size."""
    noise = 1e-3 * noise_um
    count = np.maximum(cells.count, 1.0)
    if texture is None:
        return Cover(noise**2 / count, ())
    sd, h = 1e-3 * texture.sd_um, cells.grid.size
    own = float(_averaged(texture, np.zeros(1), h)[0])
    p = cells.points
    land = (p.surface.astype(np.int64) * cells.grid.gear.teeth + p.tooth) * 3 + p.side
    blocks = []
    seen = np.flatnonzero(cells.seen)
    order = seen[np.argsort(land[seen], kind="stable")]
    for part in np.split(order, np.flatnonzero(np.diff(land[order])) + 1):
        position = p.position[part]
        distance = np.linalg.norm(position[:, None] - position[None, :], axis=2)
        blocks.append((part, sd**2 * _averaged(texture, distance, h)))
    return Cover((noise**2 + sd**2 * (1.0 - own)) / count, tuple(blocks))


def _averaged(texture: Texture, distance: Floats, h: float) -> Floats:
    """Correlation of means over two square cells of edge h whose centres are this far apart.

    The distance of two random points of two cells has the variance h² / 6 more along each axis; exact for a Gaussian of that
    variance. For the exponential, the mean distance within a square, 0.5214 h, is added in quadrature.
    """
    if texture.kind == "gauss":
        wide = texture.length_mm**2 + h**2 / 3.0
        return np.asarray(texture.length_mm**2 / wide * np.exp(-(distance**2) / wide))
    return np.asarray(np.exp(-np.hypot(distance, 0.5214 * h) / texture.length_mm))


def effect_field(effect: Effect, scenario: Scenario, scan: SyntheticScan, fitted: Fitted, gear: Gear) -> Floats:
    """Deviation of every cell from one effect alone, (m,) mm: the generator's points with nothing else on them."""
    recipe = replace(
        scenario.recipe, effects=(effect,), noise_um=0.0, texture=None, outliers=0.0, lost=0.0, holes=(), wear=(), pose=scan.truth.pose,
    )  # fmt: skip
    alone = make_scan(recipe, scenario.seed)
    # The true pose, on the same tooth as the fitted one: a strong effect's pose is off, which is no part of another's field.
    true = scan.truth.pose.inverse()
    back = Pose(true.rotation, true.translation)
    located = locate(least_turn(back, gear, fitted.placed.registration.pose).apply(alone.points), gear)
    # Points that an effect carries over an edge belong to another surface: far from their cell's centre, and no part of the field.
    binned = bin_points(located, fitted.first.grid, clip=0.05 * gear.transverse_module)
    return np.nan_to_num(binned.points.deviation)


def in_sight(scan: SyntheticScan, fitted: Fitted) -> Bools:
    """Cells whose points really come from that kind of surface, none of them worn, (m,)."""
    placed, cells = fitted.placed, fitted.first
    cell = cells.grid.index(placed.located)
    on = cell >= 0
    # Points were taken out on the way here: each is known by its place.
    which = cKDTree(placed.registration.pose.apply(scan.points)).query(placed.measured[on])[1]
    depth, surface = scan.truth.labels.depth[which], scan.truth.labels.surface[which]
    count = np.bincount(cell[on], minlength=cells.grid.count)
    worn = np.bincount(cell[on], depth > 1e-4, minlength=cells.grid.count) > 0
    # an edge's noise carries flank points past the end of the gear: no end face was seen there
    end = np.bincount(cell[on], (surface == Surface.END_LOW) | (surface == Surface.END_HIGH), cells.grid.count)
    is_end = (cells.points.surface == END_LOW) | (cells.points.surface == END_HIGH)
    return np.asarray(cells.seen & ~worn & (cells.count >= 2) & ((end > 0.5 * count) == is_end))


def open_levels(cells: Cells, use: Bools, field: Floats, gear: Gear) -> Floats:
    """(m, k) columns of the surfaces on which a common level is no evidence, as the drawing's tolerance holds what all effects together, `field`
    (m,) mm, do to it."""
    told = gear.tolerance
    limits = {
        TIP: 0.5 * told.tip_diameter, ROOT: 0.5 * told.root_diameter, BORE: 0.5 * told.bore_diameter, END_HIGH: told.face_width
    }  # fmt: skip
    levels = [np.zeros((len(use), 0))]
    for surface, limit in limits.items():
        at = use & (cells.points.surface == surface)
        if at.any() and abs(float(field[at].mean())) <= limit:
            levels.append(at[:, None].astype(np.float64))
    return np.hstack(levels)


def visibilities(scenario: Scenario, scan: SyntheticScan, fitted: Fitted, gear: Gear) -> dict[str, Visibility]:
    """Visibility of every effect of the scan, by name."""
    recipe, cells = scenario.recipe, fitted.first
    use = in_sight(scan, fitted)
    cover = true_cover(cells, recipe.noise_um, recipe.texture)
    spread = 0.0 if recipe.texture is None else (1e-3 * recipe.texture.sd_um) ** 2
    weight = np.where(use, 1.0 / (cover.white + spread), 0.0)
    pose = np.where(use[:, None], cells.motion, 0.0)
    fields = [np.where(use, effect_field(e, scenario, scan, fitted, gear), 0.0) for e in recipe.effects]
    pose = np.hstack([pose, open_levels(cells, use, np.sum([np.zeros(len(use)), *fields], axis=0), gear)])
    result = {}
    noise = 1e-3 * recipe.noise_um
    for i, effect in enumerate(recipe.effects):
        if effect is scenario.outside:
            # nothing is known of it beforehand: it may be anywhere in the spectrum of the tooth sides
            rule = Rule(RULES.significance / float(cells.grid.count), 1, RULES.least_share * noise)
        else:
            rule = Rule(RULES.significance_of_names / fitted.loop.tried, freedoms(effect, gear), RULES.least_share * noise)
        result[effect.name] = visibility(fields, i, pose, weight, cover, rule)
    return result


def freedoms(effect: Effect, gear: Gear) -> int:
    """Amplitudes and shape values of an effect."""
    of_teeth = dict.fromkeys(("pitch", "thickness_variation"), gear.teeth - 1)
    own = of_teeth | {"profile_slope": 2, "scale_anisotropic": 2, "turntable_angle": 3, "feed_marks": 3}
    return own.get(effect.name, 2 if "start_mm" in effect.parameters or "start_deg" in effect.parameters else 1)
