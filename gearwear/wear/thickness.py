"""Section thickness: the arc of every tooth at a radius, in every section across the face."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.card import Card, CardRow, few, measured
from gearwear.design.gear import Gear
from gearwear.design.quantity import NORMAL_95
from gearwear.design.twist import Segment, from_end, segments
from gearwear.wear.bend import LEAST_SPREAD, without_ridge
from gearwear.wear.by_surfaces import WIDER, SurfaceTeeth
from gearwear.wear.hollows import Hollows
from gearwear.wear.least import Least, below, least_of_curves, places
from gearwear.wear.section_ends import beyond_flanks, rounded_off
from gearwear.wear.section_sums import SectionSums
from gearwear.wear.tooth_summary import DriftSeam, MostLost, ThinnestTooth, ToothSummary, UnmeasuredTeeth, Wider
from gearwear.wear.windows import about_places, running_sum

LEAST_POINTS = 3
ENOUGH_POINTS = 12
"""Points a side and section should have, twice what a straight line through them needs; where the scan is thinner, neighbouring sections
are pooled until they do."""
MEAN_OF = 5
"""Sections over which a mean may be taken."""
NOISIER, CHANCE = 0.1, 4.0
"""Share, and standard deviations, by which points of sections must scatter more than those of all flanks and fillets to have a noise of their own; of
the variance."""
SLOPED = 2.0
"""Standard deviations, of their difference, that two means may differ by for having looked for the less of them."""
FEWEST_POINTS = 6
"""The same on a tooth that was seen less well than most."""


@dataclass(frozen=True, repr=False)  # no slots: what is asked for again and again is kept
class SectionThickness(Card):
    """Transverse thickness of all teeth in all sections, at one radius.

    Parameters
    ----------
    radius : float
        mm.
    z : (n_z,) float
        Heights of the sections, mm.
    nominal : float
        Arc as drawn at mid-face, mm.
    arc : (teeth, n_z) float
        Measured arc, mm; nan where a side was not seen.
    flank : (teeth, 2, n_z) float
        Deviation of each side there, along its normal, mm.
    count : (teeth, 2, n_z) float
        Points averaged.
    std : (teeth, n_z) float
        Standard deviation of `arc` by the noise, mm.
    noise : float
        Scatter of the points of sections, mm.
    as_made : (teeth, n_z) float
        Arc of the gear as it was made, mm: what a loss is measured from. The nominal one unless `against` says otherwise.
    pooled : int
        Neighbouring sections whose points each value is from; 1 unless the scan is thin.
    pooled_on : (teeth,) int or None
        The same on each tooth: more where it was seen less well than most; None: `pooled` on all.
    texture, texture_step : float
        Variance of the texture's part of an arc, mm², and its correlation from one section to the next.
    common_std : float
        Standard deviation that all arcs share: of pose and effects, mm.
    scatter : (teeth, 2, n_z) float or None
        Variance of the points of a section about the straight line through them, mm².
    turn : float
        Arc per deviation of a flank.
    hollows : Hollows or None
        What the pooled sections of worn teeth hide.
    surfaces : SurfaceTeeth or None
        Teeth with worn places by the surfaces of their flanks.
    made_std : (teeth,) float or None
        How well is known how thick each tooth was made, mm of arc: it is in what was lost, and not in what is left. None: no less well than all.
    drawn, made : (teeth, n_z) float or None
        Arc as it is drawn, and what effects of the maker add to it, mm: both are known between the places that are measured and up to the ends of the
        face, so that pooled sections are about both in their middle. None: the same in all sections.
    unmeasured : UnmeasuredTeeth or None
        The worn teeth of which few sections have enough points, by the surfaces of their flanks.
    otherwise : (float, float)
        How much thinner (≤ 0) and thicker (≥ 0) all teeth are, mm of arc, were effects that are taken for made or measured of the other kind, where the
        scan does not tell: a coat for thick teeth.
    pit_bottom : float
        Arc of the thinnest tooth with pits were the deepest ones of its flanks where thickness is measured, mm: points that are pooled over several sections do not
        tell that they are not.
    seam : DriftSeam or None
        What it is were pitch errors a drift of the scan; None where that is not open, or changes nothing.
    """

    radius: float
    z: Floats
    nominal: float
    arc: Floats
    flank: Floats
    count: Floats
    std: Floats
    noise: float
    as_made: Floats
    pooled: int = 1
    texture: float = 0.0
    texture_step: float = 0.0
    common_std: float = 0.0
    scatter: Floats | None = None
    turn: float = 1.0
    pooled_on: Ints | None = None
    hollows: Hollows | None = None
    surfaces: SurfaceTeeth | None = None
    made_std: Floats | None = None
    drawn: Floats | None = None
    made: Floats | None = None
    otherwise: tuple[float, float] = (0.0, 0.0)
    unmeasured: UnmeasuredTeeth | None = None
    pit_bottom: float = math.inf
    seam: DriftSeam | None = None

    def headline(self) -> str:
        teeth = [tooth for tooth in self.teeth() if tooth.seen]
        if not teeth:
            return f"no tooth was seen on both sides at radius {self.radius:.3f} mm"
        worst = max(teeth, key=lambda tooth: tooth.greatest_loss)
        lost = measured(worst.greatest_loss, worst.loss_std, "mm")
        return f"arc at radius {self.radius:.3f} mm, nominal {self.nominal:.4f} mm; most lost: {lost}, tooth {worst.tooth + 1}"

    def rows(self) -> list[CardRow]:
        return few(
            [
                (
                    f"tooth {tooth.tooth + 1}",
                    f"mean {tooth.mean:.4f}, least {tooth.least:.4f} at z {tooth.at_z:.1f}, lost {tooth.greatest_loss:z.4f} mm",
                )
                for tooth in self.teeth()
                if tooth.seen
            ],
            12,
        )

    def against(self, as_made: Floats) -> SectionThickness:
        """The same measurement with the loss counted from another arc, (teeth, n_z) mm."""
        return replace(self, as_made=as_made)

    @property
    def chord(self) -> Floats:
        """(teeth, n_z) chord 2 r sin(s / 2r), mm."""
        return np.asarray(2.0 * self.radius * np.sin(self.arc / (2.0 * self.radius)), dtype=np.float64)

    @property
    def lost(self) -> Floats:
        """(teeth, n_z) as-made − measured arc, mm."""
        return np.asarray(self.as_made - self.arc, dtype=np.float64)

    def known_to(self, texture: float, step: float, common_std: float) -> SectionThickness:
        """The same measurement with errors beside the noise of the points: see `texture`, `texture_step` and `common_std`."""
        return replace(self, texture=texture, texture_step=step, common_std=math.hypot(self.common_std, common_std))

    def made_with(self, made: Floats) -> SectionThickness:
        """The same measurement with what effects of the maker add, (teeth, n_z) mm: an arc over pooled sections is that in their middle, also where the
        window ends with the face."""
        mean = np.empty_like(made)
        for tooth, width in enumerate(self.widths.tolist()):
            mean[tooth] = running_sum(made[tooth], width) / running_sum(np.ones(made.shape[1]), width)
        return replace(self, arc=self.arc + (made - mean), made=made)

    @property
    def widths(self) -> Ints:
        """(teeth,) sections whose points are taken together."""
        return np.full(len(self.arc), self.pooled) if self.pooled_on is None else self.pooled_on

    def without(self, gone: Bools) -> SectionThickness:
        """The same measurement without the sections of teeth, (teeth, n_z), that are `gone`, and those that take points from these."""
        taken = ndimage.maximum_filter1d(gone, 2 * (self.pooled // 2) + 1, axis=1)
        return replace(self, arc=np.where(taken, np.nan, self.arc)) if gone.any() else self

    def _least(self, off: Floats, drawn: Floats | None = None, made: Floats | None = None) -> tuple[Least, Floats, Floats]:
        """The least of arcs less what they are counted `off`, (teeth, n_z) mm, on each tooth and of all, with what is unresolved and standard deviations; its
        height on each tooth, and what is `drawn` there, (teeth,) mm.

        How arcs vary as `drawn` and `made`, (teeth, n_z) mm, is known, and no matter of chance: the least of that counts between the places, too. Where
        surfaces tell of teeth as well, it is of both.
        """
        arc = self.arc - off
        # Sections that share no points, side by side; the rest of a row is empty.
        teeth, n = arc.shape
        widths = self.widths
        place = np.full((teeth, n), -1)
        for tooth, width in enumerate(widths):
            chosen = places(n, int(width))
            before = (n - len(chosen)) // 2  # in the middle of the row: neither end comes first
            place[tooth, before : before + len(chosen)] = chosen
        place = place[:, (place >= 0).any(axis=0)]
        index = np.arange(teeth)[:, None], np.maximum(place, 0)
        drawn, made = (np.zeros_like(arc) if one is None else one for one in (drawn, made))
        mean_drawn, mean_made, thinnest, drawn_there = about_places(place, widths, drawn, made)
        lost, section_std = np.where(place >= 0, arc[index] - drawn[index] - made[index], np.nan), self.std[index]
        curves = lost + thinnest
        known = np.zeros(teeth, dtype=np.bool_)
        if self.hollows is not None:
            of = self.hollows.teeth
            known[of] = True
            # Whether the few points of a section lie low and far across together is not known: the line through them leans by that.
            lying = (self.hollows.spread**2 / np.maximum(self.count[of], 1.0)).sum(axis=1)
            depth, depth_variance = (
                np.take_along_axis(values, index[1][of], axis=1) for values in (self.hollows.depth, self.hollows.std**2 + lying)
            )
            curves[of] = (lost + mean_drawn + mean_made)[of] - depth
            drawn_there[of] = mean_drawn[of]
            section_std[of] = np.sqrt(section_std[of] ** 2 + depth_variance)
        least = least_of_curves(curves, section_std, self.texture, self.texture_step**self.pooled, MEAN_OF // self.pooled)
        rows = np.arange(len(arc))
        hidden = self._unresolved[index][rows, least.at]
        about = hidden.copy()
        for tooth in np.flatnonzero(known).tolist():
            # Where the points of a hollow scatter more than its surface says, the surface has not followed it, and its bottom may lie deeper.
            near = abs(np.arange(n) - place[tooth, least.at[tooth]]) <= widths[tooth] // 2
            about[tooth], hidden[tooth] = self._unresolved[tooth, near].max(initial=0.0), 0.0
        wide, at = np.pad(lost, ((0, 0), (1, 1)), constant_values=np.nan), least.at + 1
        deeper = below(wide[rows, at - 1], wide[rows, at], wide[rows, at + 1], section_std[rows, least.at])
        # Between the means, and beyond the last of them, nobody knows but who has seen the hollow.
        deeper = np.where(known, 0.0, deeper + self._beyond(lost, place, least.at, widths))
        std = np.sqrt(least.std**2 + about**2 + (0.5 * deeper) ** 2 + self.common_std**2)
        deeper = deeper + hidden  # a hollow's bottom is one to two of its standard deviations below its mean
        curve = least.curve
        overall = math.hypot(least.overall_std, about[curve], 0.5 * (deeper[curve] - hidden[curve]), self.common_std)
        value = least.overall - float(deeper[curve])
        least = replace(least, value=least.value - deeper, std=std, overall=value, overall_std=overall)
        at_z, drawn_at = self.z[place[rows, least.at]], drawn_there[rows, least.at]
        return (least, at_z, drawn_at) if self.surfaces is None else self._with_surfaces(least, at_z, drawn_at, off, drawn, about)

    def _with_surfaces(
        self, least: Least, at_z: Floats, drawn_at: Floats, off: Floats, drawn: Floats, about: Floats
    ) -> tuple[Least, Floats, Floats]:
        """`_least` by the sections, with what surfaces tell of some teeth: the mean of both by how well each is known, and half of what they differ in its
        standard deviation, and what neither resolves, of the sections `about` theirs; of all teeth the least of these."""
        assert self.surfaces is not None
        of = self.surfaces.teeth
        value, std, at_z, drawn_at = least.value.copy(), least.std.copy(), at_z.copy(), drawn_at.copy()
        by_surface, its, at = self.surfaces.shifted(-off).least(self.common_std)
        by_sections = std[of] ** 2 - about[of] ** 2
        share, apart = by_sections / (by_sections + its**2), by_surface - value[of]
        value[of] += share * apart
        near = abs(np.arange(len(self.z)) - at[:, None]) <= self.widths[of, None] // 2
        hidden = np.where(near, self._unresolved[of], 0.0).max(axis=1)
        std[of] = np.sqrt(share * (WIDER * its) ** 2 + (0.5 * apart) ** 2 + hidden**2)
        at_z[of], drawn_at[of] = self.z[at], drawn[of, at]
        of_all = least_of_curves(value[:, None], std[:, None])  # of teeth worn alike the lowest is low by its luck
        of_all = replace(least, value=value, std=std, curve=of_all.curve, overall=of_all.overall, overall_std=of_all.overall_std)
        return of_all, at_z, drawn_at

    @cached_property
    def _unresolved(self) -> Floats:
        """What the points of a section scatter beyond noise and what is known of the surface, (teeth, n_z) mm: the bottom of a pit narrower than a section
        may lie deeper by as much."""
        if self.scatter is None:
            return np.zeros(self.arc.shape)
        known = np.zeros(self.scatter.shape)
        if self.hollows is not None:
            known[self.hollows.teeth] = (self.hollows.spread / self.turn) ** 2
        # More than 1 in 1,000 sections shows by noise alone (Wilson and Hilferty 1931).
        free = 2.0 / (9.0 * np.maximum(self.count - 2.0, 1.0))
        usual = known + self.noise**2 * (1.0 - free + 3.09 * np.sqrt(free)) ** 3
        beyond = np.where(self.scatter > usual, self.scatter - known - self.noise**2, 0.0)
        return np.asarray(np.nan_to_num(self.turn * np.sqrt(beyond.sum(axis=1))), dtype=np.float64)

    def _beyond(self, curves: Floats, place: Ints, at: Ints, widths: Ints) -> Floats:
        """How far the end of the face lies below a least that is next to it, (teeth,) mm: on along the straight line through the two means there, by
        as much as these differ beyond `SLOPED` standard deviations; the mean of pooled sections lies half their height off the end."""
        result = np.zeros(len(curves))
        for tooth, (column, width) in enumerate(zip(at, widths, strict=True)):
            seen = np.flatnonzero(np.isfinite(curves[tooth]))
            if len(seen) < 2 or column not in (seen[0], seen[-1]) or width == 1:
                continue
            inner = seen[1] if column == seen[0] else seen[-2]
            section = place[tooth, column]
            to_end = section if column == seen[0] else len(self.z) - 1 - section
            if abs(int(inner) - int(column)) != 1:
                continue
            known = math.hypot(self.std[tooth, section], self.std[tooth, place[tooth, inner]])
            rise = max(float(curves[tooth, inner] - curves[tooth, column]) - SLOPED * known, 0.0)
            result[tooth] = rise * min(to_end / width, 0.5)
        return result

    def teeth(self) -> tuple[ToothSummary, ...]:
        """A summary per tooth; least and loss without the bias of having looked for an extreme."""
        return self._teeth

    def thinnest(self) -> ThinnestTooth | None:
        """The least thickness of the gear; None where no tooth was seen on both sides."""
        return self._thinnest

    def most_lost(self) -> MostLost | None:
        """The greatest loss of the gear; None where no tooth was seen on both sides."""
        return self._greatest(self._made_std)

    def below_drawing(self) -> MostLost | None:
        """The same from what is drawn: what was lost, and what the teeth were made thinner by; None likewise."""
        drawn = self.as_made if self.drawn is None else self.drawn
        of = self if np.array_equal(drawn, self.as_made) else self.against(drawn)
        return of._greatest(np.zeros(len(self.arc)))

    def _greatest(self, made_std: Floats) -> MostLost | None:
        """The greatest loss, of teeth of which is known to (teeth,) mm how thick they were made; None where no tooth was seen on both sides."""
        if not np.isfinite(self.lost).any():
            return None
        least, at_z, _ = self._most_lost
        std = math.hypot(least.overall_std, made_std[least.curve])
        return MostLost(least.curve, -least.overall, std, float(at_z[least.curve]))

    @property
    def _made_std(self) -> Floats:
        return np.zeros(len(self.arc)) if self.made_std is None else self.made_std

    @cached_property
    def _most_lost(self) -> tuple[Least, Floats, Floats]:
        return self._least(self.as_made)

    @cached_property
    def _least_arc(self) -> tuple[Least, Floats, Floats]:
        return self._least(np.zeros_like(self.arc), self.drawn, self.made)

    @cached_property
    def _teeth(self) -> tuple[ToothSummary, ...]:
        least, at_z, _ = self._least_arc
        lost, _, _ = self._most_lost
        nan, result = math.nan, list[ToothSummary]()
        for tooth, arc in enumerate(self.arc):
            if not np.isfinite(least.value[tooth]):
                result.append(ToothSummary(tooth, self.nominal, mean=nan, least=nan, greatest_loss=nan, at_z=nan, std=nan))
                continue
            std, mean = float(np.median(self.std[tooth][np.isfinite(arc)])), float(np.nanmean(arc))
            # Places that are looked at side by side have another mean than all sections.
            thinnest = min(float(least.value[tooth]), mean)
            most_lost = max(-float(lost.value[tooth]), float(np.nanmean(self.as_made[tooth] - arc)))
            result.append(
                ToothSummary(
                    tooth=tooth,
                    nominal=self.nominal,
                    mean=mean,
                    least=thinnest,
                    greatest_loss=most_lost,
                    at_z=float(at_z[tooth]),
                    std=std,
                    least_std=float(least.std[tooth]),
                    loss_std=math.hypot(lost.std[tooth], self._made_std[tooth]),
                )
            )
        # One truth: where a tooth is thinnest by its surfaces, its own line says so.
        for other in () if self.unmeasured is None else self.unmeasured.teeth:
            if not result[other.tooth].least < other.value:
                own = result[other.tooth]
                result[other.tooth] = replace(own, least=other.value, least_std=other.std, at_z=other.at_z)
        return tuple(result)

    @cached_property
    def _thinnest(self) -> ThinnestTooth | None:
        if not np.isfinite(self.arc).any():
            return None
        least, at_z, drawn = self._least_arc
        value, std = least.overall, least.overall_std
        low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
        own, by = (low, high), dict[Wider, tuple[float, float]]()
        if self.pooled > 1:
            # Of few sections the bottom of one hollow can hardly be told from the least of many alike: it may be as deep as it was measured.
            at = np.unravel_index(int(np.nanargmin(self.arc)), self.arc.shape)
            by[Wider.HOLLOW] = float(self.arc[at] - self.std[at]), high
            by[Wider.PITS] = self.pit_bottom, high
        other = None if self.unmeasured is None else self.unmeasured.least
        if other is not None:
            by[Wider.FEW] = other.low, other.high
        if self.surfaces is not None:  # they may be right where sections hide a hollow
            by_surface, its, _ = self.surfaces.least(self.common_std)
            hidden = float((by_surface - NORMAL_95 * WIDER * its).min())
            by[Wider.HOLLOW] = min(hidden, by.get(Wider.HOLLOW, own)[0]), high
        low, high = min([low, *(one for one, _ in by.values())]), max([high, *(one for _, one in by.values())])
        by[Wider.EITHER] = own[0] + self.otherwise[0], own[1] + self.otherwise[1]
        low, high = low + self.otherwise[0], high + self.otherwise[1]
        if self.seam is not None:
            by[Wider.SEAM] = self.seam.low, self.seam.high
            low, high = min(low, self.seam.low), max(high, self.seam.high)
        most = max(by, key=lambda why: max(own[0] - by[why][0], by[why][1] - own[1]))
        wider = most if by[most][0] < own[0] or by[most][1] > own[1] else None
        if other is not None and other.value < value:
            return replace(other, low=low, high=high, wider=wider)
        nominal = self.nominal if self.drawn is None else float(drawn[least.curve])
        return ThinnestTooth(least.curve, value, std, low, high, float(at_z[least.curve]), nominal, wider)


def thickness_of(sums: SectionSums, noise: float) -> SectionThickness:
    """Measure the tooth thickness at a radius in every section.

    Parameters
    ----------
    sums : SectionSums
        Over the points of the located scan (corrected for measurement effects where they are known), in any number of chunks.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    SectionThickness

    Notes
    -----
    A side's deviation δ along the normal in space is a turn δ / (r_b cos β_b) at every radius, so the transverse arc is
    ``s = s_nominal + r / (r_b cos β_b) (δ_left + δ_right)`` exactly. δ is the mean of the points in the section's slab and
    within 0.1 modules of arc of the radius, less the ridge that all flanks of the side have there (`bend`), taken to the radius itself by the
    straight line through them. In a scan too thin for that the
    slabs of neighbouring sections are pooled (`pooled`): the loss is then a mean over that height.
    """
    band = sums.band
    gear, r, heights = band.gear, band.radius, band.heights
    shape = (gear.teeth, 2, len(heights))
    parts = _parts(gear, heights)
    moments = sums.moments.reshape(-1, *shape)
    if len(heights) > 1:
        number = moments[0].astype(np.int64)
        for rows, stretch in parts:
            ended = np.zeros(len(heights), dtype=bool)
            ended[rows] = beyond_flanks(number[:, :, rows], heights[rows], stretch)
            moments = np.where(ended, 0.0, moments)
    stretches = [rows for rows, _ in parts]
    pooled = _sections_to_pool(moments[0], stretches)
    starts = np.concatenate([rows.start + _starts(rows.stop - rows.start, pooled) for rows in stretches])
    straight, ridge_std = without_ridge(moments, starts, noise, band.half)
    flank, variance, count, scatter, on = _line_at(straight, band.half, stretches, pooled)
    noise = _own_noise(scatter, count, noise, pooled)
    for rows in stretches:
        flank[:, :, rows][:, :, rounded_off(flank[:, :, rows], gear.transverse_module, noise)] = np.nan
    flank[:, :, (from_end(gear, heights) < 0.0) & (gear.spec.gap > 0.0)] = np.nan  # a groove has no teeth
    generated = float(gear.thickness(r))
    nominal = generated + r / gear.base_radius * gear.drawn_excess(float(gear.roll_length(r)))
    turn = r / gear.normal_lever
    made = np.full((gear.teeth, len(heights)), generated)
    if gear.modified:
        made = made + r * (gear.half_angles(np.array([r]), heights).sum(axis=0)[:, 0] - 2.0 * float(gear.half_angle(r)))
    arc, std = made + turn * flank.sum(axis=1), turn * noise * np.sqrt(variance.sum(axis=1))
    common = turn * float(np.hypot(*ridge_std))
    return SectionThickness(
        radius=r,
        z=heights,
        nominal=nominal,
        arc=arc,
        flank=flank,
        count=count,
        std=std,
        noise=noise,
        as_made=made,
        pooled=pooled,
        common_std=common,
        scatter=scatter,
        turn=turn,
        pooled_on=on,
        drawn=made,
    )


def _parts(gear: Gear, heights: Floats) -> list[tuple[slice, Segment]]:
    """Sections that belong together, and the stretch of the face they lie on: all of them, or those of each half of a double helical gear."""
    parts = []
    for half in segments(gear) if gear.spec.gap > 0.0 else ():
        within = np.flatnonzero((heights >= half.low) & (heights <= half.high))
        if len(within):
            parts.append((slice(int(within[0]), int(within[-1]) + 1), half))
    return parts or [(slice(0, len(heights)), Segment(0.0, gear.face_width, gear.twist))]


def _starts(count: int, width: int) -> Ints:
    """First of each `width` of `count` sections, from both ends inwards: the same from either end. The one in the middle may be wider, or narrower."""
    half = count // width // 2
    lower = width * np.arange(half)
    return np.unique(np.concatenate([lower, [half * width], count - half * width + lower]).clip(0, count - 1)).astype(np.int64)


def _line_at(
    moments: Floats, half: float, stretches: Sequence[slice], pooled: int
) -> tuple[Floats, Floats, Floats, Floats, Ints]:
    """Value at x = 0 of the straight line through each section's points (their mean where x does not spread), its variance in that of one
    point, the number of points, their variance about the line, and over how many sections of a stretch they were pooled on each tooth;
    `pooled` on most."""
    sums = list(moments.copy())
    on = _on_each(sums[0], pooled, stretches)
    for values in sums:
        whole = values.copy()
        for width, rows in product(np.unique(on), stretches):
            teeth = np.flatnonzero(on == width)
            values[teeth, :, rows] = running_sum(whole[teeth, :, rows], int(width))
    n, sx, sy, sxx, sxy, syy = sums
    with np.errstate(invalid="ignore", divide="ignore"):
        mean_x, mean_y = sx / n, sy / n
        spread = sxx - n * mean_x**2
        sloped = (n >= 6) & (spread > n * (LEAST_SPREAD * half) ** 2)  # points of a regular grid may all lie at one radius
        slope = np.where(sloped, (sxy - n * mean_x * mean_y) / spread, 0.0)
        value = np.where(n >= LEAST_POINTS, mean_y - slope * mean_x, np.nan)
        variance = np.where(n >= LEAST_POINTS, 1.0 / n + np.where(sloped, mean_x**2 / spread, 0.0), np.nan)
        about = syy - n * mean_y**2 - slope * np.where(sloped, sxy - n * mean_x * mean_y, 0.0)
        scatter = np.where(n >= LEAST_POINTS, about / (n - np.where(sloped, 2.0, 1.0)), 0.0)
    return value, variance, n, scatter, on


def _own_noise(scatter: Floats, count: Floats, noise: float, pooled: int) -> float:
    """Noise of the points of sections, where it is more than that of all points, mm: scanners scatter more on steep flanks than on fillets.

    By the lower quartile of their variances (Wilson and Hilferty 1931): where few places scatter more it is wear.
    """
    enough = count >= FEWEST_POINTS
    if not enough.any():
        return noise
    free = 2.0 / (9.0 * (count[enough] - 2.0))
    own = float(np.quantile(scatter[enough] / (1.0 - free - 0.6745 * np.sqrt(free)) ** 3, 0.25))
    chance = 1.36 * math.sqrt(2.0 * pooled / float((count[enough] - 2.0).sum()))  # of a quartile
    return math.sqrt(own) if own > (1.0 + NOISIER + CHANCE * chance) * noise**2 else noise


def _sections_to_pool(count: Floats, stretches: Sequence[slice]) -> int:
    """Odd number of neighbouring sections that together hold `ENOUGH_POINTS` points on most flanks that were seen; at most a third of a stretch."""
    seen = count.sum(axis=2)
    if not (seen > 0).any():
        return 1
    total, most = _lengths(stretches)
    per_section = float(np.median(seen[seen > 0])) / total
    wanted = math.ceil(ENOUGH_POINTS / per_section)
    return int(min(wanted, max(most, 1))) | 1


def _lengths(stretches: Sequence[slice]) -> tuple[int, int]:
    """Sections in all stretches together, and a third of the shortest."""
    lengths = [rows.stop - rows.start for rows in stretches]
    return sum(lengths), min(lengths) // 3


def _on_each(count: Floats, pooled: int, stretches: Sequence[slice]) -> Ints:
    """(teeth,) the same for each tooth, by its thinner flank: wider than `pooled` where it has less than half of `FEWEST_POINTS` with that."""
    total, third = _lengths(stretches)
    per_section = (count.sum(axis=2) / total).min(axis=1)
    thin = (per_section > 0.0) & (per_section * pooled < 0.5 * FEWEST_POINTS)
    wanted = np.ceil(FEWEST_POINTS / np.where(thin, per_section, 1.0))
    most = max(third, 1)
    return np.where(thin, np.clip(wanted, pooled, max(most, pooled)), pooled).astype(np.int64) | 1
