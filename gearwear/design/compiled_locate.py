"""`surface.locate` by compiled loops: what they need of a gear, as numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.fillet_arc import FilletArc
from gearwear.design.modification import FORMS
from gearwear.design.rack import RackTip
from gearwear.design.root import RootCurve, fillet_table
from gearwear.design.shaper import ShaperTip
from gearwear.design.side import Side
from gearwear.design.twist import segments

if TYPE_CHECKING:
    from gearwear.design.gear import Gear
    from gearwear.design.kernel import Constants
    from gearwear.design.surface import Bands, SurfacePoints


def filler(gear: Gear, bands: Bands) -> Callable[[Floats, SurfacePoints], None]:
    """Something that locates points (n, 3) into the arrays of a `SurfacePoints`; parameters as `surface.locate`."""
    from gearwear.design.kernel import BLOCK, fill

    constants = constants_of(gear, bands)

    def located(points: Floats, out: SurfacePoints) -> None:
        n = len(points)
        if n < BLOCK:  # a whole block, and what was added taken off again
            more = type(out).room(BLOCK)
            located(np.concatenate([points, np.zeros((BLOCK - n, 3))]), more)
            for field in fields(more):
                getattr(out, field.name)[:] = getattr(more, field.name)[:n]
            return
        columns = (getattr(out, field.name) for field in fields(out))
        fill(np.ascontiguousarray(points), constants, *columns)

    return located


def measurer(gear: Gear, bands: Bands) -> Callable[[Floats, Floats], None]:
    """Something that puts the deviations of points (n, 3) into an array (n,); parameters as `surface.locate`."""
    from gearwear.design.kernel import BLOCK, measure

    constants = constants_of(gear, bands)

    def measured(points: Floats, out: Floats) -> None:
        n = len(points)
        if n < BLOCK:
            more = np.empty(BLOCK)
            measured(np.concatenate([points, np.zeros((BLOCK - n, 3))]), more)
            out[:] = more[:n]
            return
        measure(np.ascontiguousarray(points), constants, out)

    return measured


@lru_cache(maxsize=8)  # a scan's chunks come one after the other
def constants_of(gear: Gear, bands: Bands) -> Constants:
    """The numbers of a gear and its bands."""
    from gearwear.design.kernel import RACK, Constants

    low, high = segments(gear)[0], segments(gear)[-1]
    kind, root = _root_numbers(gear.root_curve)
    start_radius, start_scale, start = _start(gear, kind == RACK)
    limits = (bands.flank, bands.flank, bands.root, bands.tip, bands.end_low, bands.end_high, bands.bore, (0.0, 0.0))
    least, most = np.array(limits, dtype=np.float64).T.tolist()
    groove, sharp = gear.spec.gap > 0.0, gear.flank_end_radius == gear.tip_radius
    return Constants(
        teeth=gear.teeth,
        orientation=float(gear.orientation),
        face_width=float(gear.face_width),
        pitch_angle=gear.pitch_angle,
        base_radius=gear.base_radius,
        base_half_angle=gear.base_half_angle,
        cos_helix=gear.base_helix_cosine,
        sin_helix=float(np.sin(gear.base_helix_angle)),
        form_radius=float(gear.form_radius),
        root_radius=float(gear.root_radius),
        tip_radius=float(gear.tip_radius),
        flank_end_radius=gear.orientation * math.inf if sharp else float(gear.flank_end_radius),
        sharp=sharp,
        body_radius=float(gear.body_radius) if gear.body_radius > 0.0 else -gear.orientation * math.inf,
        root_half_angle=float(gear.root_half_angle),
        tip_half_angle=float(gear.tip_half_angle),
        twist=float(gear.twist),
        low_twist=float(low.twist),
        low_middle=float(low.middle),
        low_end=float(low.high) if groove else math.inf,
        high_twist=float(high.twist),
        high_middle=float(high.middle),
        high_start=float(high.low),
        upper_from=0.5 * float(gear.face_width) if groove else math.inf,
        near=float(bands.inner_face(gear)),
        margins=bands.end_margins(gear),
        kind=kind,
        root=root,
        fillet_end=float(gear.fillet_end),
        start_radius=start_radius,
        start_scale=start_scale,
        start=start,
        least=tuple(least),
        most=tuple(most),
        modified=gear.modified,
        form_roll=gear.form_roll,
        drawn=(drawn_numbers(gear, Side.LEFT), drawn_numbers(gear, Side.RIGHT)),
    )


def _start(gear: Gear, tangent: bool) -> tuple[float, float, tuple[float, ...]]:
    """Where a search for a foot begins: radius where the fillet begins, what makes the root of the distance from it 1 at its end, and the
    coefficients of φ, or its tangent, as a polynomial in that, of degree 8."""
    radius, phi = fillet_table(gear.root_curve, gear.fillet_end, gear.orientation)
    way = slice(None, None, gear.orientation)
    radius, phi = radius[way], phi[way]
    root = np.sqrt(np.maximum(gear.orientation * (radius - radius[0]), 0.0))
    fit = np.polynomial.Polynomial.fit(root / root[-1], np.tan(phi) if tangent else phi, 8, domain=[0.0, 1.0], window=[0.0, 1.0])
    return float(radius[0]), 1.0 / float(root[-1]), tuple(float(one) for one in fit.coef)


def _root_numbers(curve: RootCurve) -> tuple[int, tuple[float, float, float, float, float, float]]:
    """Kind of a root curve and its numbers."""
    from gearwear.design.kernel import ARC, RACK, SHAPER

    if isinstance(curve, RackTip):
        return RACK, (
            curve.reference_radius, curve.tip_radius, curve.centre_depth, curve.centre_offset, curve.stretch, curve.helix_cosine,
        )  # fmt: skip
    if isinstance(curve, ShaperTip):
        return SHAPER, (
            curve.centre_distance, curve.pitch_radius, curve.ratio, curve.centre_radius, curve.centre_angle, curve.tip_radius,
        )  # fmt: skip
    assert isinstance(curve, FilletArc)
    return ARC, (curve.centre_radius, curve.centre_angle, curve.radius, 0.0, 0.0, 0.0)


def drawn_numbers(gear: Gear, side: Side) -> tuple[float, ...]:
    """A side's modification as `kernel.offset` takes it apart; lengths of what there is none of are 1."""
    flank = gear.drawn(side)
    drawn, form, tip = flank.modification, flank.form_roll, flank.tip_roll
    tip_start, root_start = flank.tip_relief_start, flank.root_relief_start
    numbers = (
        form, tip, drawn.profile_slope, drawn.profile_crowning,
        tip_start, tip - tip_start if drawn.tip_relief > 0.0 else 1.0, drawn.tip_relief, FORMS[drawn.tip_relief_form],
        root_start, root_start - form if drawn.root_relief > 0.0 else 1.0, drawn.root_relief, FORMS[drawn.root_relief_form],
        gear.face_width, side * drawn.helix_slope, drawn.helix_crowning,
        drawn.end_relief_length or 1.0, drawn.end_relief, FORMS[drawn.end_relief_form],
    )  # fmt: skip
    return tuple(float(one) for one in numbers)
