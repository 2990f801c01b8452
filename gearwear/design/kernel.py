"""`surface.locate`, compiled: the same formulas for a block of points at a time.

Everything that holds for each point alike is a loop without branches, which the compiler turns into vector instructions; what only some points
need, the foot on a fillet, is done for these together. Columns of a block lie in one array at known distances and loops have a known length: so
the compiler needs no proof at run time that they do not overlap, and nothing is left over that goes point by point.

Imported by `compiled_locate` alone: it needs numba.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gearwear.compiled import formula, kernel, step
from gearwear.design.kernel_formulas import (
    arc_foot,
    arc_plumb_line,
    arctan,
    in_quadrant,
    rack_foot,
    rack_plumb_line,
    reduced,
    shaper_foot,
    shaper_plumb_line,
    unreduced,
)  # fmt: skip

Array = Any
"""A numpy array, of whatever layout: numba looks at what it is given."""
BLOCK = 256
"""Points worked on at a time: the columns between the steps stay in the nearest caches. Loops are over whole blocks, of a known length."""
LANES = 16
"""Fillet points are worked on in multiples of so many, the last one repeated: what is left over from whole vectors goes one by one."""
STEPS = 8
"""Most steps to a foot on a fillet, as `RackTip.normal_angle`; Halley's need two or three."""
STEPS_OF_SHAPER = 12
"""As `shaper.STEPS`."""
SETTLED_TANGENT, SETTLED_ANGLE = 1e-5, 1e-8
"""Steps end at this change of tan φ, of φ: the next one would be below 1e-13. Halley's error goes with the third power, Newton's with the second."""
ROUNDS, SETTLED = 12, 1e-13
"""As `surface.MOST_ROUNDS` and `SETTLED`."""
RACK, SHAPER, ARC = range(3)
"""Kinds of root curves; their unknown is tan φ, φ and φ."""
FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE, OTHER = range(8)


class Constants(NamedTuple):
    """What the loops need of a gear and its bands: mm, rad; arrays are read only.

    The names are those of `Gear`, `Bands`, `twist.Segment` and `RootCurve`; `low` and `high` the two halves of a double helical gear, twice the
    same of any other. `root` are the numbers of the root curve in the order of its fields, of a rack with its stretch before cos β.
    `least` and `most` are by surface code, of the deviation. `drawn` are the two sides' modifications, see `offset`.
    """

    teeth: int
    orientation: float
    face_width: float
    pitch_angle: float
    base_radius: float
    base_half_angle: float
    cos_helix: float
    sin_helix: float
    form_radius: float
    root_radius: float
    tip_radius: float
    flank_end_radius: float
    sharp: bool
    body_radius: float
    root_half_angle: float
    tip_half_angle: float
    twist: float
    low_twist: float
    low_middle: float
    low_end: float
    high_twist: float
    high_middle: float
    high_start: float
    upper_from: float
    near: float
    margins: tuple[tuple[float, float], tuple[float, float]]
    kind: int
    root: tuple[float, float, float, float, float, float]
    fillet_end: float
    start_radius: float
    start_scale: float
    start: tuple[float, ...]
    least: tuple[float, ...]
    most: tuple[float, ...]
    modified: bool
    form_roll: float
    drawn: tuple[tuple[float, ...], tuple[float, ...]]


(
    X, Y, Z, RADIUS, INVERSE, REACH, NUMBER, OFF, OWN, DEVIATION, ALONG, ACROSS, UP, NX, NY, NZ, CODE,
    R, ANGLE, FOOT, DISTANCE, IN, BY, LEVER, HEIGHT
) = range(0, 25 * BLOCK, BLOCK)  # fmt: skip
"""Where the columns of a block begin: it is one array, so that the compiler knows how far they lie apart. mm, rad.

The point; polar coordinates in the mid-face section: radius, its inverse, the length of roll there, the number of the nearest tooth (not yet
modulo their count) and how far off its centre the point lies, and as much, unsigned, but for what is modified; the deviation along the normal, which
has components along the radius, across it, away from the tooth's centre, and up; the normal in space; the surface. Then, of the points on fillets
alone, one behind the other: radius, angle from the space's centre, unknown of the root curve, and of the plumb line its length, components along
and across, lever and height.
"""
COLUMNS = 29
"""Of a block: four are left for what is done with located points."""


@step
def empty_block():
    """Room for a block, and for the numbers of its points on fillets."""
    return np.empty(COLUMNS * BLOCK), np.empty(BLOCK, np.uint64)


@formula
def start_at(c, radius):
    """The unknown of the root curve at a radius, about: a polynomial in the root of the distance from where it begins."""
    s = min(math.sqrt(max(c.orientation * (radius - c.start_radius), 0.0)) * c.start_scale, 1.0)
    p = c.start
    return (((((((p[8] * s + p[7]) * s + p[6]) * s + p[5]) * s + p[4]) * s + p[3]) * s + p[2]) * s + p[1]) * s + p[0]


@step
def feet(c, b, n):
    """Move the unknown of the root curve to the normals through n points; in place."""
    root = c.root
    if c.kind == ARC:
        for k in range(n):
            b[FOOT + k] = arc_foot(root, c.fillet_end, b[R + k], b[ANGLE + k])
        return
    most = math.tan(c.fillet_end) if c.kind == RACK else c.fillet_end
    for _ in range(STEPS if c.kind == RACK else STEPS_OF_SHAPER):
        moving = 0
        if c.kind == RACK:
            for k in range(n):
                new = rack_foot(root, most, b[R + k], b[ANGLE + k], b[FOOT + k])
                moving += 1 if abs(new - b[FOOT + k]) >= SETTLED_TANGENT else 0
                b[FOOT + k] = new
        else:
            for k in range(n):
                new = shaper_foot(root, most, b[R + k], b[ANGLE + k], b[FOOT + k])
                moving += 1 if abs(new - b[FOOT + k]) >= SETTLED_ANGLE else 0
                b[FOOT + k] = new
        if moving == 0:
            return


@step
def plumb_lines(c, b, n):
    """Distance, normal along and across the point's radius, and lever, at the feet of n points."""
    root = c.root
    if c.kind == RACK:
        for k in range(n):
            line = rack_plumb_line(root, b[R + k], b[ANGLE + k], b[FOOT + k])
            b[DISTANCE + k], b[IN + k], b[BY + k], b[LEVER + k] = line
    elif c.kind == SHAPER:
        for k in range(n):
            line = shaper_plumb_line(root, b[R + k], b[ANGLE + k], b[FOOT + k])
            b[DISTANCE + k], b[IN + k], b[BY + k], b[LEVER + k] = line
    else:
        for k in range(n):
            line = arc_plumb_line(root, b[R + k], b[ANGLE + k], b[FOOT + k])
            b[DISTANCE + k], b[IN + k], b[BY + k], b[LEVER + k] = line


@step
def turned(c, b, n):
    """Turn n points to the sections that the feet of their plumb lines in space lie in, and keep by how much: `surface._lifted`."""
    for k in range(n):
        tangent = c.twist * b[LEVER + k]
        b[HEIGHT + k] = c.twist * tangent / (1.0 + tangent * tangent) * b[DISTANCE + k]
        b[ANGLE + k] += b[HEIGHT + k]


@step
def lifted(c, b, n):
    """From plumb lines in the sections of the feet to those in space; in place."""
    for k in range(n):
        tangent = c.twist * b[LEVER + k]
        cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
        b[DISTANCE + k] = (b[DISTANCE + k] + b[LEVER + k] * b[HEIGHT + k]) * cosine
        b[IN + k], b[BY + k], b[HEIGHT + k] = b[IN + k] * cosine, b[BY + k] * cosine, -tangent * cosine


@formula
def relief(way, amount, power):
    """What a relief takes off, `way` from its start: linear or parabolic."""
    way = max(way, 0.0)
    return amount * (way if power == 1.0 else way * way)


@formula
def offset(drawn, roll, z):
    """δ₀ of a modified flank: `DrawnFlank.offset`, of the numbers that `compiled_locate.drawn_numbers` gives."""
    form, tip, slope, crowning, tip_start, tip_length, tip_relief, tip_power = drawn[:8]
    root_start, root_length, root_relief, root_power, width, lean, bulge, end_length, end_relief, end_power = drawn[8:]
    at = min(max(roll, min(form, tip)), max(form, tip))
    u = 2.0 * (at - form) / (tip - form) - 1.0
    profile = 0.5 * slope * u - crowning * u * u
    profile -= relief((at - tip_start) / tip_length, tip_relief, tip_power)
    profile -= relief((root_start - at) / root_length, root_relief, root_power)
    height = min(max(z, 0.0), width)
    zeta = height / width - 0.5
    face = lean * zeta - bulge * (4.0 * zeta * zeta)
    return profile + (face - relief(1.0 - min(height, width - height) / end_length, end_relief, end_power))


@step
def as_drawn(c, b):
    """Take the modification at the foot off the deviation and, at the form circle, off `own`: `surface._drawn_offset`; in place."""
    shift = np.zeros(BLOCK)
    left, right = c.drawn
    for _ in range(ROUNDS):
        moving = 0
        for i in range(BLOCK):
            deviation, side = b[DEVIATION + i] - c.cos_helix * shift[i], math.copysign(1.0, b[OFF + i])
            roll = b[REACH + i] - c.orientation * c.cos_helix * deviation
            height = b[Z + i] + side * c.sin_helix * deviation
            new = offset(left, roll, height) if side > 0.0 else offset(right, roll, height)
            moving += 1 if abs(new - shift[i]) >= SETTLED else 0
            shift[i] = new
        if moving == 0:
            break
    for i in range(BLOCK):
        b[DEVIATION + i] -= c.cos_helix * shift[i]
        drawn = offset(left, c.form_roll, b[Z + i]) if b[OFF + i] > 0.0 else offset(right, c.form_roll, b[Z + i])
        b[OWN + i] -= drawn / c.base_radius


@step
def in_section(c, b):
    """Polar coordinates in the mid-face section, tooth and side, and the distance from the generated involute helicoid (`surface.locate`).

    The quotients that both angles and the radius need are taken by one division.
    """
    per_pitch, square_base = 1.0 / c.pitch_angle, c.base_radius * c.base_radius
    for i in range(BLOCK):
        x, y, z = b[X + i], b[Y + i], b[Z + i]
        square = x * x + y * y
        radius = math.sqrt(square)
        reach = math.sqrt(max(square - square_base, 0.0))
        ax, ay = abs(x), abs(y)
        above, below, far = reduced(ay, ax)
        above_roll, below_roll, far_roll = reduced(reach, c.base_radius)
        sure = max(radius, 1e-90)
        one = 1.0 / (below * below_roll * sure)
        angle = unreduced(arctan(above * (below_roll * sure * one)), far, ay > ax)
        pressure = unreduced(arctan(above_roll * (below * sure * one)), far_roll, reach > c.base_radius)
        upper = z > c.upper_from
        turn = c.high_twist * (z - c.high_middle) if upper else c.low_twist * (z - c.low_middle)
        angle = in_quadrant(angle, y, x) - turn
        number = np.rint(angle * per_pitch)
        off = angle - number * c.pitch_angle
        own = abs(off)
        involute = c.orientation * (reach - c.base_radius * pressure)
        b[RADIUS + i], b[INVERSE + i], b[REACH + i] = radius, below * below_roll * one, reach
        b[NUMBER + i], b[OFF + i], b[OWN + i] = number, off, own
        b[DEVIATION + i] = (involute + c.base_radius * (own - c.base_half_angle)) * c.cos_helix


@step
def by_radius(c, b):
    """Flank, fillet or root land of every point, as if there were no other surface; into `code`."""
    for i in range(BLOCK):
        outer = c.orientation * (b[RADIUS + i] - c.form_radius) >= 0.0
        land = 0.5 * c.pitch_angle - b[OWN + i] <= c.root_half_angle
        below = (c.orientation * (b[RADIUS + i] - c.root_radius) >= c.least[ROOT]) & (not land)
        b[CODE + i] = FLANK if outer else (FILLET if below else ROOT)


@step
def on_fillets(c, b, which):
    """Deviation and normal of the points on fillets, worked on together; their numbers in the block, and how many they are."""
    count = 0
    for i in range(BLOCK):
        which[count] = i
        count += 1 if b[CODE + i] == FILLET else 0
    if count == 0:
        return count
    last = which[count - 1]
    padded = (count + LANES - 1) // LANES * LANES
    for k in range(count, padded):
        which[k] = last
    for k in range(padded):
        b[R + k], b[ANGLE + k], b[HEIGHT + k] = b[RADIUS + which[k]], 0.5 * c.pitch_angle - b[OWN + which[k]], 0.0
    for k in range(padded):
        b[FOOT + k] = start_at(c, b[R + k])
    for section in range(1 if c.twist == 0.0 else 2):
        if section == 1:
            turned(c, b, padded)
        feet(c, b, padded)
        plumb_lines(c, b, padded)
    if c.twist != 0.0:
        lifted(c, b, padded)
    for k in range(padded):
        i = which[k]
        b[DEVIATION + i], b[ALONG + i], b[ACROSS + i], b[UP + i] = b[DISTANCE + k], b[IN + k], b[BY + k], b[HEIGHT + k]
    return count


@step
def on_others(c, b):
    """The surface with the greatest signed distance of all that a point may belong to, by the rules of `surface._locate_chunk`.

    A surface that the bands exclude is not silently another one: such points are OTHER, without a deviation.
    """
    w, orientation = c.face_width, c.orientation
    sharp = c.sharp
    for i in range(BLOCK):
        was, radius, z = b[CODE + i], b[RADIUS + i], b[Z + i]
        outer, at_root = was == FLANK, was == ROOT
        root, tip = orientation * (radius - c.root_radius), orientation * (radius - c.tip_radius)
        outline = root if at_root else b[DEVIATION + i]
        beyond = outer & (orientation * (radius - c.flank_end_radius) > 0.0)
        highest = (tip >= outline) & (tip >= c.least[TIP])
        drawn = (abs(tip) <= c.most[TIP]) & (abs(b[OFF + i]) <= c.tip_half_angle)
        at_tip = outer & (highest if sharp else drawn)
        bore = orientation * (c.body_radius - radius)
        at_bore = bore > root
        outline = bore if at_bore else (tip if at_tip else outline)
        at_low = (-z >= outline) & (-z >= c.least[END_LOW])
        at_high = (z - w >= outline) & (z - w >= c.least[END_HIGH])
        is_ = BORE if at_bore else (TIP if at_tip else (OTHER if beyond else was))
        is_ = END_HIGH if at_high else (END_LOW if at_low else is_)
        inside = min(z - c.low_end, c.high_start - z)  # of the groove of a double helical gear
        in_groove = ((inside > 0.0) | ((inside >= outline) & (inside >= c.near))) & (is_ != BORE)
        left = b[OFF + i] > 0.0
        low, high = c.margins[0][0] if left else c.margins[0][1], c.margins[1][0] if left else c.margins[1][1]
        of_outline = (is_ != END_LOW) & (is_ != END_HIGH) & (is_ != BORE)
        at_edge = ((of_outline | (outline > -low)) & (z < low)) | ((of_outline | (outline > -high)) & (z > w - high))
        d = z - w if at_high else (-z if at_low else outline)
        low = c.least[BORE] if at_bore else (c.least[TIP] if at_tip else (c.least[ROOT] if at_root else c.least[FLANK]))
        high = c.most[BORE] if at_bore else (c.most[TIP] if at_tip else (c.most[ROOT] if at_root else c.most[FLANK]))
        low = c.least[END_HIGH] if at_high else (c.least[END_LOW] if at_low else low)
        high = c.most[END_HIGH] if at_high else (c.most[END_LOW] if at_low else high)
        known = (d >= low) & (d <= high) & (is_ != OTHER) & (not (in_groove | at_edge))
        b[CODE + i] = is_ if known else OTHER
        b[DEVIATION + i] = d if known else math.nan


@step
def normals_of(c, b):
    """Outward normals in space, by surface; those of OTHER say nothing."""
    orientation = c.orientation
    for i in range(BLOCK):
        code, z = b[CODE + i], b[Z + i]
        at_fillet, at_bore = code == FILLET, code == BORE
        at_end, at_round = (code == END_LOW) | (code == END_HIGH), (code == ROOT) | (code == TIP) | at_bore
        side, inverse = math.copysign(1.0, b[OFF + i]), b[INVERSE + i]
        ex, ey = b[X + i] * inverse, b[Y + i] * inverse
        hand = -1.0 if z > c.upper_from else 1.0
        along = b[ALONG + i] if at_fillet else orientation * b[REACH + i] * inverse * c.cos_helix
        across = b[ACROSS + i] if at_fillet else c.base_radius * inverse * c.cos_helix
        up = b[UP + i] if at_fillet else -c.sin_helix
        along = (-orientation if at_bore else orientation) if at_round else along
        along, across = 0.0 if at_end else along, 0.0 if at_end | at_round else across * side
        up = (1.0 if code == END_HIGH else -1.0) if at_end else (0.0 if at_round else up * side * hand)
        b[NX + i], b[NY + i], b[NZ + i] = along * ex - across * ey, along * ey + across * ex, up


@step
def place(c, b, which):
    """Locate the points of a block; gives how many of them lie on fillets."""
    in_section(c, b)
    if c.modified:
        as_drawn(c, b)
    by_radius(c, b)
    fillets = on_fillets(c, b, which)
    on_others(c, b)
    return fillets


@kernel
def fill(points, c, surfaces, teeth, sides, rolls, positions, normals, deviations):
    """Locate points (n, 3), `BLOCK` of them or more, on the design; into the last seven arrays, the fields of `SurfacePoints`."""
    b, which = empty_block()
    for start in range(0, len(points), BLOCK):
        first = min(start, len(points) - BLOCK)  # the last block takes some of those before once more
        part = slice(first, first + BLOCK)
        read(points[part], b)
        place(c, b, which)
        normals_of(c, b)
        store(c, b, surfaces[part], teeth[part], sides[part], rolls[part], positions[part], normals[part], deviations[part])


@kernel
def measure(points, c, deviations):
    """Deviations alone of points (n, 3), `BLOCK` of them or more, into the last array."""
    b, which = empty_block()
    for start in range(0, len(points), BLOCK):
        first = min(start, len(points) - BLOCK)
        read(points[first : first + BLOCK], b)
        place(c, b, which)
        deviations[first : first + BLOCK] = b[DEVIATION : DEVIATION + BLOCK]


@step
def read(points, b):
    """Points (`BLOCK`, 3) into a block."""
    flat = points.reshape(-1)
    for i in range(BLOCK):
        b[X + i], b[Y + i], b[Z + i] = flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]


@step
def store(c, b, surfaces, teeth, sides, rolls, positions, normals, deviations):
    """A whole block, into the result. Every array by a loop of its own: so they become vector loops."""
    per_turn, count = 1.0 / c.teeth, float(c.teeth)
    feet, upright = positions.reshape(-1), normals.reshape(-1)
    for i in range(BLOCK):
        surfaces[i] = b[CODE + i]
    for i in range(BLOCK):
        number = b[NUMBER + i]
        tooth = number - count * np.floor((number + 0.5) * per_turn)
        teeth[i] = np.int32(tooth if tooth == tooth else 0.0)
    for i in range(BLOCK):
        sides[i] = np.int8(math.copysign(1.0, b[OFF + i]) if b[CODE + i] <= FILLET else 0.0)
    for i in range(BLOCK):
        rolls[i] = b[REACH + i] - c.orientation * c.cos_helix * b[DEVIATION + i] if b[CODE + i] == FLANK else math.nan
    for i in range(BLOCK):
        deviations[i] = b[DEVIATION + i]
    for i in range(BLOCK):
        upright[3 * i], upright[3 * i + 1], upright[3 * i + 2] = b[NX + i], b[NY + i], b[NZ + i]
    for i in range(BLOCK):
        d = b[DEVIATION + i] if b[CODE + i] != OTHER else 0.0
        feet[3 * i], feet[3 * i + 1], feet[3 * i + 2] = (
            b[X + i] - d * b[NX + i],
            b[Y + i] - d * b[NY + i],
            b[Z + i] - d * b[NZ + i],
        )
