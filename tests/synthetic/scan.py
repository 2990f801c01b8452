"""Make a scan: manufacture, wear, texture, coating, mounting, scanner, pose, noise, in this order.

1. The nominal outline is sampled slice by slice, the end faces at random over their area.
2. Manufacture turns and shifts the tooth sides (`effects`): the as-made gear.
3. Wear takes metal away along the inward normal of the as-made flank (`removal`); points of tips, fillets and
   end faces that were on it vanish, and the worn flank reaches on to where it meets them.
4. Texture moves points along the normal of the surface they are now on; so does a coating.
5. Mounting moves all but the datum; the scanner's errors move every point, about the gear's axis.
6. Points are lost; the pose (per view) is applied; white noise and outliers are added.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.synthetic.effects import Feet, as_made, mount, scanned
from tests.synthetic.outline import Bools, Floats, Outline, Surface
from tests.synthetic.part import PartPoints, flanks_with_wear, part_points
from tests.synthetic.pose import IDENTITY, Rigid, any_pose, mild_pose, view_pose
from tests.synthetic.recipe import FlankTruth, Labels, Recipe, SyntheticScan, Truth
from tests.synthetic.removal import depth_below, removed_volume, wear_depth
from tests.synthetic.texture import sample_texture


def make_scan(recipe: Recipe, seed: int) -> SyntheticScan:
    """One scan with its truth; the same recipe and seed give the same points.

    Parameters
    ----------
    recipe : Recipe
    seed : int

    Returns
    -------
    SyntheticScan
    """
    rng = np.random.default_rng(seed)
    outline = Outline.of(recipe.gear)
    part = part_points(recipe, outline, rng)
    part = _kept(part, recipe, outline, rng)
    position = part.position
    if recipe.texture is not None:
        position = position + _texture(recipe, outline, part, rng)[:, None] * part.normal
    for effect in recipe.effects:
        if effect.name == "coating":
            position = position + 1e-3 * effect["thickness_um"] * part.normal
    position = mount(recipe.effects, outline, position, part.labels.surface)

    poses = _poses(recipe, outline, rng)
    views, labels = [], []
    for number, pose in enumerate(poses):
        seen = _seen(recipe, position, part.labels, number)
        own = part.labels.take(seen)
        points = scanned(recipe.effects, position[seen], poses[0])
        points = pose.apply(points) + 1e-3 * recipe.noise_um * rng.standard_normal(points.shape)
        wild = rng.random(len(points)) < recipe.outliers
        points[wild] += rng.laplace(0.0, 0.4, (int(wild.sum()), 3))
        views.append(points)
        labels.append(replace(own, outlier=wild))
    joined = Labels(*(np.concatenate([getattr(x, n) for x in labels]) for n in Labels.__dataclass_fields__))
    flanks, volumes = _worn_flanks(recipe, outline)
    truth = Truth(recipe, seed, poses, flanks, volumes, joined, outline)
    return SyntheticScan(np.concatenate(views), truth, tuple(views))


def _kept(part: PartPoints, recipe: Recipe, outline: Outline, rng: np.random.Generator) -> PartPoints:
    """Without lost points and holes."""
    keep = np.ones(len(part.position), np.bool_)
    if recipe.lost > 0.0:
        keep &= rng.random(len(keep)) >= recipe.lost
    for hole in recipe.holes:
        roll = np.sqrt(np.array([hole.r_mm**2 - outline.base_radius**2]))
        x, y = outline.flank(roll)[0][0]
        angle = hole.tooth * outline.pitch_angle + hole.side * np.arctan2(y, x)
        centre = np.array([hole.r_mm * np.cos(angle), hole.r_mm * np.sin(angle), hole.z_mm])
        keep &= ((part.position - centre) ** 2).sum(axis=1) > hole.radius_mm**2
    return part if keep.all() else part.take(keep)


def _texture(recipe: Recipe, outline: Outline, part: PartPoints, rng: np.random.Generator) -> Floats:
    assert recipe.texture is not None
    rng = rng if recipe.texture_seed is None else np.random.default_rng(recipe.texture_seed)
    out = np.zeros(len(part.position))
    surface = part.labels.surface
    reach = 2.0 * outline.tip_radius + 1.0
    for kinds, period, width, up in (
        ((Surface.FLANK, Surface.FILLET, Surface.ROOT, Surface.TIP), outline.length * outline.teeth, outline.face_width, 0.0),
        ((Surface.END_LOW,), reach, reach, 0.5 * reach),
        ((Surface.END_HIGH,), reach, reach, 0.5 * reach),
        ((Surface.BORE,), np.pi * recipe.gear.bore_diameter, outline.face_width, 0.0),
    ):
        on = np.isin(surface, kinds)
        if on.any():
            out[on] = sample_texture(recipe.texture, period, width, part.along[on], part.across[on] + up, rng)
    return out


def _poses(recipe: Recipe, outline: Outline, rng: np.random.Generator) -> tuple[Rigid, ...]:
    named = {"none": lambda: IDENTITY, "mild": lambda: mild_pose(outline, rng), "any": lambda: any_pose(rng)}
    pose = named[recipe.pose]() if isinstance(recipe.pose, str) else recipe.pose
    if recipe.views is None:
        return (pose,)
    own = recipe.views.poses or tuple(view_pose(rng) for _ in range(recipe.views.count))
    return tuple(one.after(pose) for one in own)


def _seen(recipe: Recipe, position: Floats, labels: Labels, number: int) -> Bools:
    if recipe.views is None:
        return np.ones(len(position), np.bool_)
    count = recipe.views.count
    towards = 2.0 * np.pi * number / count
    away = np.abs(np.angle(np.exp(1j * (np.arctan2(position[:, 1], position[:, 0]) - towards))))
    return (away <= np.pi / count * (1.0 + recipe.views.overlap)) & (labels.surface != Surface.END_LOW)


def _worn_flanks(recipe: Recipe, outline: Outline) -> tuple[tuple[FlankTruth, ...], tuple[float, ...]]:
    flanks = []
    alone = [0.0] * len(recipe.wear)
    roll = np.linspace(outline.form_roll, outline.tip_roll, 201)[:, None]
    z = np.linspace(0.0, outline.face_width, 121)
    for tooth, side in flanks_with_wear(recipe, outline):

        def shift(at: Floats, height: Floats, tooth: int = tooth, side: int = side) -> Floats:
            return as_made(recipe.effects, outline, Feet(np.array(tooth), np.array(side), at, height))[1]

        volume = removed_volume(recipe.wear, outline, tooth, side, shift)
        for i, one in enumerate(recipe.wear):
            alone[i] += volume if len(recipe.wear) == 1 else removed_volume((one,), outline, tooth, side, shift)
        deepest = wear_depth(recipe.wear, outline, np.array(tooth), np.array(side), roll, z[None, :]).max()
        at_reference = np.full(len(z), outline.reference_roll)
        loss = depth_below(recipe.wear, outline, tooth, side, at_reference, z).max()
        loss *= outline.reference_radius / outline.base_radius
        flanks.append(FlankTruth(tooth, side, volume, 1e3 * float(deepest), float(loss)))
    return tuple(flanks), tuple(alone)
