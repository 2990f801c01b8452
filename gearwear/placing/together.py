"""What is taken out of views that lie, stand or show the gear otherwise than the others, and what is said of it.

Scale and offset of a view are taken out one by one, where it is off the median of all beyond doubt. Which view's place is wrong need not be known: where
one is off beyond doubt all are moved to where the overlaps want them, as far as the overlaps tell that better than the views' own fits to the design do
(`_moved`); the pose of the whole follows from the design afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.quantity import significant
from gearwear.design.surface import SurfacePoints
from gearwear.placing.accord import OFFSET, OWN, SCALE, STDS, Accords, ViewAccord
from gearwear.placing.pose import Pose, motion_columns, small_motion

NOISES, LEAST = 0.5, 0.2
"""Share of a point's scatter that the place of a view, and its scale or offset, must make besides for it to be called off."""
ROUGHER = 1.25
"""Scatter of a view's points, in a typical view's, above which it may be stitched of pieces; of good views it differs by 5 %."""
LEFT = 0.5
"""Standard deviations of what may be left of something that was taken out; numerical."""
SETTLING = 10
"""Numerical: rounds in which what registrations are worth is found."""


@dataclass(frozen=True, slots=True)
class Taken:
    """What was taken out of a view: it lies on the design as ``motion(pose(points / (1 + scale)))``, less the offset along the normals.

    Parameters
    ----------
    scale : float
        Relative.
    offset : float
        mm.
    motion : (6,) float
        What it was moved by, mm and rad.
    covariance : (8, 8) float
        Of motion, offset and scale as taken out; zero for those that were not.
    """

    scale: float = 0.0
    offset: float = 0.0
    motion: Floats = field(default_factory=lambda: np.zeros(OFFSET))
    covariance: Floats = field(default_factory=lambda: np.zeros((OWN, OWN)))

    @property
    def any(self) -> bool:
        """Whether it is anything."""
        return self.scale != 0.0 or self.offset != 0.0 or bool(self.motion.any())

    @property
    def back(self) -> Pose:
        """The motion as a pose."""
        return small_motion(self.motion)

    def off(self, located: SurfacePoints) -> Floats:
        """Places (n, 3) of located points without the offset, mm."""
        known = np.nan_to_num(located.deviation - self.offset)
        return np.asarray(located.position + located.normal * known[:, None], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Remedy:
    """What is to be taken out of views next.

    Parameters
    ----------
    taken : tuple of Taken
        Of each view.
    told : bool
        Whether the views tell which of them are wrong: more than half agree.
    """

    taken: tuple[Taken, ...]
    told: bool

    @property
    def any(self) -> bool:
        """Whether there is anything."""
        return any(one.any for one in self.taken)


def out_of_scale(accord: ViewAccord, noise: float) -> bool:
    """Whether a view's scale is off beyond doubt, in a scan whose points scatter by `noise` (mm)."""
    return accord.enough and abs(accord.scale) > STDS * accord.scale_std and accord.size > LEAST * noise


def stands_off(accord: ViewAccord, noise: float) -> bool:
    """Whether the surface of a view stands off that of the others beyond doubt."""
    return accord.enough and abs(accord.offset) > max(STDS * accord.offset_std, LEAST * noise)


def out_of_place(accord: ViewAccord, noise: float) -> bool:
    """Whether a view lies off the others beyond doubt."""
    return accord.enough and accord.place > max(STDS * accord.place_std, NOISES * noise)


def odd_ones_out(accords: Sequence[ViewAccord], noise: float) -> tuple[Bools, Bools]:
    """Views that overlap the others too little to be judged, and whose own fits to the design have another scale than theirs, (n,); another offset, (n,)."""
    alone = np.array([not accord.enough for accord in accords], dtype=np.bool_)
    reach = np.array([accord.reach for accord in accords])
    scale = np.array([(accord.own_scale, accord.own_scale_std) for accord in accords]).reshape(-1, 2)
    offset = np.array([(accord.own_offset, accord.own_offset_std) for accord in accords]).reshape(-1, 2)
    return alone & _unlike(scale, reach, noise), alone & _unlike(offset, np.ones(len(reach)), noise)


def _unlike(known: Floats, makes: Floats, noise: float) -> Bools:
    """(n,) which of some values, (n, 2) with their standard deviations, are unlike their median; `makes` is what a unit makes of points, mm."""
    value, std = known.T
    told = np.isfinite(std)
    if told.sum() < 2:
        return np.zeros(len(value), dtype=np.bool_)
    off = np.abs(value - np.median(value[told]))
    return np.asarray(told & (off > STDS * np.hypot(std, np.median(std[told]))) & (makes * off > NOISES * noise), dtype=np.bool_)


def remedy(accords: Accords, noise: float, spreads: Sequence[Floats], before: Sequence[Taken]) -> Remedy:
    """What the overlaps show beyond doubt: scales first, as they bend the views' own places; then offsets; then places.

    Parameters
    ----------
    accords : Accords
    noise : float
        Scatter of points, mm.
    spreads : sequence of (6, 6) float
        Covariance of each view's own pose, in the design frame.
    before : sequence of Taken
        What was taken out of each: of these what is left is, too, as a view far off shows its lands to the others only then.
    """
    views = accords.views
    enough = sum(one.enough for one in views)
    for wrong, at in ((out_of_scale, SCALE), (stands_off, OFFSET)):
        off = [wrong(one, noise) or _is_left(one, out, at) for one, out in zip(views, before, strict=True)]
        if any(off):
            taken = (_one(one, at) if is_off else Taken() for one, is_off in zip(views, off, strict=True))
            return Remedy(tuple(taken), 2 * sum(off) < enough)
    if any(out_of_place(one, noise) for one in views):
        return Remedy(_moved(accords, spreads), True)
    return Remedy(tuple(Taken() for _ in views), True)


def _is_left(accord: ViewAccord, before: Taken, at: int) -> bool:
    """Whether something is left of a scale or an offset that was taken out of a view."""
    if at == SCALE:
        return before.scale != 0.0 and abs(accord.scale) > LEFT * accord.scale_std
    return before.offset != 0.0 and abs(accord.offset) > LEFT * accord.offset_std


def _one(accord: ViewAccord, at: int) -> Taken:
    """Scale or offset of a view, with how well it is known."""
    covariance = np.zeros((OWN, OWN))
    covariance[at, at] = (accord.scale_std if at == SCALE else accord.offset_std) ** 2
    return Taken(scale=accord.scale, covariance=covariance) if at == SCALE else Taken(offset=accord.offset, covariance=covariance)


def _moved(accords: Accords, spreads: Sequence[Floats]) -> tuple[Taken, ...]:
    """Motions of all views by overlaps and registrations together.

    Notes
    -----
    Least squares of ``(x − x̂)ᵀ N (x − x̂) + xᵀ Λ x``: x̂ is what the overlaps say and N their information; Λ that of the views' own fits to the design, by
    which x is zero, of the motions alone. Those fits are worth less than they say where one of them is wrong: their covariances are raised until xᵀ Λ x is
    what chance makes. So a motion that the overlaps hardly see stays as the design has it.
    """
    prior = np.zeros_like(accords.information)
    for i, spread in enumerate(spreads):
        its = slice(OWN * i, OWN * i + OFFSET)
        prior[its, its] = np.linalg.pinv(spread, rcond=1e-9, hermitian=True)
    size = np.sqrt(np.maximum(np.diag(accords.information) + np.diag(prior), 1e-300))
    n, p = accords.information / np.outer(size, size), prior / np.outer(size, size)
    best, raised = accords.solution * size, 1.0
    inverse, x = np.zeros_like(n), best
    freedom = max(int(np.linalg.matrix_rank(prior, hermitian=True)) - OFFSET, 1)  # all may move together
    for _ in range(SETTLING):
        inverse = np.linalg.pinv(n + p / raised, rcond=1e-10, hermitian=True)
        x = inverse @ (n @ best)
        raised = max(float(x @ p @ x) / freedom, 1.0)
    x, covariance = x / size, inverse / np.outer(size, size)
    taken = []
    for i in range(len(spreads)):
        its = slice(OWN * i, OWN * i + OFFSET)
        own = np.zeros((OWN, OWN))
        own[:OFFSET, :OFFSET] = covariance[its, its]
        taken.append(Taken(motion=-x[its], covariance=own))
    return tuple(taken)


def summed(before: Taken, after: Taken) -> Taken:
    """Both together; what was taken out in steps is known as well as the last of them."""
    changed = np.diag(after.covariance) > 0.0
    covariance = np.where(np.outer(changed, changed), after.covariance, before.covariance)
    return Taken(
        (1.0 + before.scale) * (1.0 + after.scale) - 1.0, before.offset + after.offset, before.motion + after.motion, covariance
    )


def spread_columns(taken: Taken, points: SurfacePoints) -> Floats:
    """(n, k) what taking it out leaves uncertain at points, one standard deviation a column, mm."""
    value, vector = np.linalg.eigh(taken.covariance)
    kept = value > 1e-12 * max(float(value.max()), 1e-300)
    position, normal = np.nan_to_num(points.position), np.nan_to_num(points.normal)
    columns = np.column_stack([motion_columns(position, normal), np.ones(len(position)), (position * normal).sum(axis=1)])
    return np.asarray(columns @ (vector[:, kept] * np.sqrt(value[kept])), dtype=np.float64)


def said_of_views(
    accords: Sequence[ViewAccord], taken: Sequence[Taken], told: bool, noise: float, scatters: Sequence[float]
) -> list[str]:
    """What a reader must know of several views, each a sentence.

    Parameters
    ----------
    accords : sequence of ViewAccord
        As the views were found.
    taken : sequence of Taken
        What was taken out of each.
    told : bool
        Whether more than half of the views agree, so that the others are wrong.
    noise : float
        Scatter of points, mm.
    scatters : sequence of float
        That of each view alone.
    """
    worst, odd = max((accord.torn for accord in accords), default=0.0), odd_ones_out(accords, noise)
    rough, usual = scattered(scatters), float(np.median(scatters)) if len(scatters) else 0.0
    said = []
    for number, (accord, out) in enumerate(zip(accords, taken, strict=True), 1):
        said += _said_of(number, accord, out, told, noise)
        if _is_torn(accord, noise) and accord.torn > 0.5 * worst:  # what overlaps it is off as well, by less
            said.append(
                f"view {number} is badly stitched within itself: {significant(1e3 * accord.torn, 2)} µm (RMS) lie between it and the others that no place,"
                " offset or scale of it makes"
            )
        if rough[number - 1]:
            said.append(
                f"points of view {number} scatter by {significant(1e3 * scatters[number - 1], 2)} µm, those of a typical view by {significant(1e3 * usual, 2)}"
                " µm: it may be badly stitched within itself"
            )
        its = []
        if odd[0][number - 1]:
            way = "large" if accord.own_scale > 0.0 else "small"
            its.append(f"shows the gear {1e6 * abs(accord.own_scale):.0f} ± {1e6 * accord.own_scale_std:.0f} ppm too {way}")
        if odd[1][number - 1]:
            way = "above" if accord.own_offset > 0.0 else "below"
            its.append(
                f"puts its surface {1e3 * abs(accord.own_offset):.1f} ± {1e3 * accord.own_offset_std:.1f} µm {way} the design"
            )
        if its:
            said.append(
                f"view {number} overlaps the others too little to be judged by them, and its own fit to the design {' and '.join(its)}, unlike theirs:"
                " it may be wrong, and was left as it is"
            )
    if not told:
        said.append("which views are right the overlaps do not tell: a scale or an offset of all that is left may be theirs")
    return said


def _is_torn(accord: ViewAccord, noise: float) -> bool:
    """Whether something that noise does not make is left between a view and the others."""
    return accord.torn > NOISES * noise


def doubtful(accords: Sequence[ViewAccord], told: bool, noise: float, scatters: Sequence[float]) -> bool:
    """Whether something may be wrong with a view that could not be taken out of it: effects of all may be its own then."""
    torn = any(_is_torn(accord, noise) for accord in accords) or bool(scattered(scatters).any())
    return not told or torn or any(bool(odd.any()) for odd in odd_ones_out(accords, noise))


def scattered(scatters: Sequence[float]) -> Bools:
    """(n,) views whose points scatter so much more than a typical view's that they may be stitched of pieces that do not fit."""
    scatter = np.array(scatters, dtype=np.float64)
    return np.asarray(scatter > ROUGHER * np.median(scatter) if len(scatter) else np.zeros(0), dtype=np.bool_)


def _said_of(number: int, accord: ViewAccord, taken: Taken, told: bool, noise: float) -> list[str]:
    """What was taken out of view `number`."""
    said, others = [], "the others" if told else "the middle of all"
    if taken.scale != 0.0:
        much = f"{1e6 * abs(taken.scale):.0f} ± {1e6 * float(np.sqrt(taken.covariance[SCALE, SCALE])):.0f} ppm"
        way = "large" if taken.scale > 0.0 else "small"
        which = f"view {number} is out of scale: it" if told else f"view {number}"
        said.append(f"{which} shows the gear {much} too {way} against {others}; taken out")
    if taken.offset != 0.0:
        much = f"{1e3 * abs(taken.offset):.1f} ± {1e3 * float(np.sqrt(taken.covariance[OFFSET, OFFSET])):.1f} µm"
        way = "above" if taken.offset > 0.0 else "below"
        said.append(
            f"view {number} stands {much} {way} {others} on every surface, as by a coat or an exposure of its own; taken out"
        )
    if out_of_place(accord, noise):
        done = "; all views were moved to where the overlaps want them" if taken.motion.any() else ""
        off = significant(1e3 * accord.place, 2)
        said.append(f"view {number} is badly stitched: it lies {off} µm (RMS) off the others where they overlap{done}")
    return said
