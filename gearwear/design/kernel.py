"""`surface.locate`, compiled: the same formulas, in the same order, for a block of points at a time.

Everything that holds for each point alike is a loop without branches, which the compiler turns into vector instructions; what only some points
need, the foot on a fillet, is done for these together. arctan, sine and cosine are written out for the same reason: rational and polynomial
approximations of Cephes (S. L. Moshier, *Methods and Programs for Mathematical Functions*, 1989), good to two units in the last place.

Imported by `compiled_locate` alone: it needs numba.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gearwear.compiled import formula, kernel, step

Array = Any
"""A numpy array, of whatever layout: numba looks at what it is given."""
BLOCK = 512
"""Points worked on at a time: the columns between the steps stay in the nearest cache."""
STEPS = 8
"""Most Newton steps to a foot on a fillet, as `RackTip.normal_angle`."""
STEPS_OF_SHAPER = 12
"""As `shaper.STEPS`."""
SETTLED_TANGENT, SETTLED_ANGLE = 1e-7, 1e-8
"""Newton ends at this change of tan φ, of φ: the next step would be below 1e-13."""
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
    groove: bool
    near: float
    edge: float
    margin: float
    kind: int
    root: tuple[float, float, float, float, float, float]
    fillet_end: float
    start_radius: Array
    start: Array
    least: Array
    most: Array
    modified: bool
    form_roll: float
    drawn: tuple[tuple[float, ...], tuple[float, ...]]


@formula
def atan2(y, x):
    """Polar angle; 0 at the origin."""
    ax, ay = abs(x), abs(y)
    large = max(ax, ay, 1e-300)
    t = min(ax, ay) / large
    far = t > 0.41421356237309503  # tan π/8
    u = (t - 1.0) / (t + 1.0) if far else t
    s = u * u
    p = -8.750608600031904122785e-1
    p = p * s - 1.615753718733365076637e1
    p = p * s - 7.500855792314704667340e1
    p = p * s - 1.228866684490136173410e2
    p = p * s - 6.485021904942025371773e1
    q = s + 2.485846490142306297962e1
    q = q * s + 1.650270098316988542046e2
    q = q * s + 4.328810604912902668951e2
    q = q * s + 4.853903996359136964868e2
    q = q * s + 1.945506571482613964425e2
    angle = u * (s * (p / q)) + u + (0.7853981633974483 if far else 0.0)
    angle = angle if ax >= ay else 1.5707963267948966 - angle
    angle = angle if x >= 0.0 else 3.141592653589793 - angle
    return math.copysign(angle, y)


@formula
def cosine_sine(angle):
    """Cosine and sine of angles below some hundred radians."""
    turns = np.rint(angle * 0.6366197723675814)  # quarters
    r = ((angle - turns * 1.57079625129699707031) - turns * 7.54978941586159635336e-8) - turns * 5.39030285815811905290e-15
    s = r * r
    sine = 1.58962301576546568060e-10
    sine = sine * s - 2.50507477628578072866e-8
    sine = sine * s + 2.75573136213857245213e-6
    sine = sine * s - 1.98412698295895385996e-4
    sine = sine * s + 8.33333333332211858878e-3
    sine = sine * s - 1.66666666666666307295e-1
    sine = r + r * (s * sine)
    cosine = -1.13585365213876817300e-11
    cosine = cosine * s + 2.08757008419747316778e-9
    cosine = cosine * s - 2.75573141792967388112e-7
    cosine = cosine * s + 2.48015872888517045348e-5
    cosine = cosine * s - 1.38888888888730564116e-3
    cosine = cosine * s + 4.16666666666665929218e-2
    cosine = 1.0 - 0.5 * s + s * s * cosine
    quarter = turns - 4.0 * np.floor(0.25 * turns)
    odd = (quarter == 1.0) | (quarter == 3.0)
    c, s = (sine, cosine) if odd else (cosine, sine)
    c = -c if (quarter == 1.0) | (quarter == 2.0) else c
    s = -s if quarter >= 2.0 else s
    return c, s


@formula
def rack_foot(root, most, radius, angle, tangent):
    """One Newton step to tan φ of the normal through a point: `RackTip.normal_angle`."""
    reference, depth, offset, stretch, c = root[0], root[2], root[3], root[4], root[5]
    cos = 1.0 / math.sqrt(1.0 + tangent * tangent)
    turn = (c * depth * tangent - offset) / reference - stretch / reference * tangent * cos
    rate = c * depth / reference - stretch / reference * (cos * cos * cos)
    cos, sin = cosine_sine(angle + turn)
    radial, tangential = radius * cos, radius * sin
    inward = reference - radial
    across = c * tangent
    slope = rate * (radial - tangential * across) - c * inward
    step = (tangential - inward * across) / (slope if abs(slope) > 1e-9 else -1e-9)
    return min(max(tangent - min(max(step, -0.5), 0.5), 0.0), most)


@formula
def rack_plumb_line(root, radius, angle, tangent):
    """Distance, the normal along the point's radius and across it, and its lever: `RackTip.plumb_line` and `lever`."""
    reference, tip, depth, offset, stretch, c = root[0], root[1], root[2], root[3], root[4], root[5]
    normal_cos = 1.0 / math.sqrt(1.0 + tangent * tangent)
    turn = (c * depth * tangent - offset) / reference - stretch / reference * tangent * normal_cos
    cos_turn, sin_turn = cosine_sine(angle + turn)
    inward = reference - radius * cos_turn
    across = c * tangent
    cos = 1.0 / math.sqrt(1.0 + across * across)
    sin = across * cos
    distance = depth / cos + tip * (normal_cos / cos) - (inward * cos + radius * sin_turn * sin)
    return distance, cos * cos_turn - sin * sin_turn, sin * cos_turn + cos * sin_turn, reference * sin


@formula
def shaper_foot(root, most, radius, angle, phi):
    """One Newton step to φ of the normal through a point: `ShaperTip.normal_angle`."""
    pitch_radius, ratio, centre_radius = root[1], root[2], root[3]
    cos, sin = cosine_sine(phi)
    x, y = root[0] - pitch_radius + centre_radius * cos, centre_radius * sin
    dx, dy = -centre_radius * sin, centre_radius * cos
    cos, sin = cosine_sine(angle + (phi - root[4]) * ratio)
    along, across = radius * cos, radius * sin
    from_pitch = along - pitch_radius
    slope = from_pitch * dy - across * dx - ratio * (across * y + along * x)
    step = (from_pitch * y - across * x) / (slope if abs(slope) > 1e-9 else 1e-9)
    return min(max(phi - min(max(step, -0.3), 0.3), 0.0), most)


@formula
def shaper_plumb_line(root, radius, angle, phi):
    """As `rack_plumb_line`: `ShaperTip.plumb_line` and `lever`."""
    pitch_radius = root[1]
    cos, sin = cosine_sine(phi)
    x, y = root[0] - pitch_radius + root[3] * cos, root[3] * sin
    distance = math.sqrt(x * x + y * y)
    cos, sin = cosine_sine(angle + (phi - root[4]) * root[2])
    ux, uy = x / distance, y / distance
    reach = (radius * cos - pitch_radius) * ux + radius * sin * uy
    return distance + root[5] - reach, -(ux * cos + uy * sin), uy * cos - ux * sin, pitch_radius * y / distance


@formula
def arc_foot(root, most, radius, angle):
    """φ of the radius through a point: `FilletArc.normal_angle`."""
    cos, sin = cosine_sine(angle - root[1])
    return min(max(atan2(radius * sin, radius * cos - root[0]), 0.0), most)


@formula
def arc_plumb_line(root, radius, angle, phi):
    """As `rack_plumb_line`: `FilletArc.plumb_line` and `lever`."""
    at = angle - root[1]
    cos, sin = cosine_sine(phi - at)
    cos_phi, sin_phi = cosine_sine(phi)
    return root[2] - (radius * cos - root[0] * cos_phi), -cos, sin, root[0] * sin_phi


@formula
def start_at(radius, table, values):
    """Linear interpolation in a table of 65 rows over rising radii, constant beyond it."""
    low = 0
    for half in (32, 16, 8, 4, 2, 1):
        low += half if radius >= table[low + half] else 0
    low = min(low, 63)
    share = (radius - table[low]) / (table[low + 1] - table[low])
    return values[low] + min(max(share, 0.0), 1.0) * (values[low + 1] - values[low])


@step
def feet(c, radius, angle, at):
    """Move `at`, the unknown of the root curve, to the normals through points; in place."""
    root = c.root
    if c.kind == ARC:
        for i in range(len(radius)):
            at[i] = arc_foot(root, c.fillet_end, radius[i], angle[i])
        return
    most = math.tan(c.fillet_end) if c.kind == RACK else c.fillet_end
    for _ in range(STEPS if c.kind == RACK else STEPS_OF_SHAPER):
        moving = 0
        if c.kind == RACK:
            for i in range(len(radius)):
                new = rack_foot(root, most, radius[i], angle[i], at[i])
                moving += 1 if abs(new - at[i]) >= SETTLED_TANGENT else 0
                at[i] = new
        else:
            for i in range(len(radius)):
                new = shaper_foot(root, most, radius[i], angle[i], at[i])
                moving += 1 if abs(new - at[i]) >= SETTLED_ANGLE else 0
                at[i] = new
        if moving == 0:
            return


@step
def plumb_lines(c, radius, angle, at, distance, along, across, lever):
    """Distance, normal along and across the point's radius, and lever, at the feet of points; into the last four arrays."""
    root = c.root
    if c.kind == RACK:
        for i in range(len(radius)):
            distance[i], along[i], across[i], lever[i] = rack_plumb_line(root, radius[i], angle[i], at[i])
    elif c.kind == SHAPER:
        for i in range(len(radius)):
            distance[i], along[i], across[i], lever[i] = shaper_plumb_line(root, radius[i], angle[i], at[i])
    else:
        for i in range(len(radius)):
            distance[i], along[i], across[i], lever[i] = arc_plumb_line(root, radius[i], angle[i], at[i])


@step
def lifted(c, radius, angle, at, distance, along, across, lever, up):
    """From plumb lines in the points' own sections to those in space: `surface._lifted`; in place, and the normals' heights into `up`."""
    for i in range(len(radius)):
        tangent = c.twist * lever[i]
        cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
        up[i] = c.twist * (tangent * cosine) * cosine * distance[i]  # turn
        angle[i] += up[i]
    feet(c, radius, angle, at)
    plumb_lines(c, radius, angle, at, distance, along, across, lever)
    for i in range(len(radius)):
        tangent = c.twist * lever[i]
        cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
        distance[i] = (distance[i] + lever[i] * up[i]) * cosine
        along[i], across[i], up[i] = along[i] * cosine, across[i] * cosine, -tangent * cosine


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
def as_drawn(c, z, side, reach, flank, within):
    """Take the modification at the foot off `flank` and, at the form circle, off `within`: `surface._drawn_offset`; in place."""
    shift = np.zeros(len(z))
    left, right = c.drawn
    for _ in range(ROUNDS):
        moving = 0
        for i in range(len(z)):
            deviation = flank[i] - c.cos_helix * shift[i]
            roll = reach[i] - c.orientation * c.cos_helix * deviation
            height = z[i] + side[i] * c.sin_helix * deviation
            new = offset(left, roll, height) if side[i] > 0.0 else offset(right, roll, height)
            moving += 1 if abs(new - shift[i]) >= SETTLED else 0
            shift[i] = new
        if moving == 0:
            break
    for i in range(len(z)):
        flank[i] -= c.cos_helix * shift[i]
        within[i] -= (offset(left, c.form_roll, z[i]) if side[i] > 0.0 else offset(right, c.form_roll, z[i])) / c.base_radius


@step
def in_section(c, x, y, z, radius, inverse, reach, number, side, within):
    """Polar coordinates in the mid-face section, and the tooth and side that they belong to; into the last six arrays."""
    for i in range(len(x)):
        square = x[i] * x[i] + y[i] * y[i]
        radius[i] = math.sqrt(square)
        inverse[i] = 1.0 / max(radius[i], 1e-300)
        reach[i] = math.sqrt(max(square - c.base_radius * c.base_radius, 0.0))
        upper = z[i] > 0.5 * c.face_width
        turn = c.high_twist * (z[i] - c.high_middle) if upper else c.low_twist * (z[i] - c.low_middle)
        angle = atan2(y[i], x[i]) - turn
        number[i] = np.rint(angle / c.pitch_angle)
        off = angle - number[i] * c.pitch_angle
        side[i] = math.copysign(1.0, off)
        within[i] = abs(off)


@step
def on_flanks(c, reach, within, flank):
    """Distance from the generated involute helicoid, in closed form (`surface.locate`), into `flank`."""
    for i in range(len(reach)):
        involute = reach[i] - c.base_radius * atan2(reach[i], c.base_radius)
        flank[i] = (c.orientation * involute + c.base_radius * (within[i] - c.base_half_angle)) * c.cos_helix


@step
def flank_normals(c, x, y, z, inverse, reach, side, nx, ny, nz):
    """Outward normals of the flanks, into the last three arrays."""
    for i in range(len(x)):
        scale = inverse[i] * c.cos_helix
        radial, across = c.orientation * reach[i] * scale, side[i] * c.base_radius * scale
        ex, ey = x[i] * inverse[i], y[i] * inverse[i]
        nx[i], ny[i] = radial * ex - across * ey, radial * ey + across * ex
        nz[i] = side[i] * -c.sin_helix * (-1.0 if c.groove & (z[i] > 0.5 * c.face_width) else 1.0)


@step
def by_radius(c, radius, within, code):
    """Flank, fillet or root land of every point, as if there were no other surface; into `code`."""
    for i in range(len(radius)):
        outer = c.orientation * (radius[i] - c.form_radius) >= 0.0
        land = 0.5 * c.pitch_angle - within[i] <= c.root_half_angle
        below = (c.orientation * (radius[i] - c.root_radius) >= c.least[ROOT]) & (not land)
        code[i] = FLANK if outer else (FILLET if below else ROOT)


@step
def on_fillets(c, x, y, z, radius, inverse, side, within, code, deviation, nx, ny, nz):
    """Deviation and normal of the points on fillets, worked on together; into the last four arrays."""
    which, count = np.empty(len(x), np.int64), 0
    for i in range(len(x)):
        which[count] = i
        count += code[i] == FILLET
    if count == 0:
        return
    work = np.empty((8, count))
    r, angle, at, distance, along, across, lever, up = work[0], work[1], work[2], work[3], work[4], work[5], work[6], work[7]
    up[:] = 0.0
    for k in range(count):
        r[k], angle[k] = radius[which[k]], 0.5 * c.pitch_angle - within[which[k]]
        at[k] = start_at(r[k], c.start_radius, c.start)
    feet(c, r, angle, at)
    plumb_lines(c, r, angle, at, distance, along, across, lever)
    if c.twist != 0.0:
        lifted(c, r, angle, at, distance, along, across, lever, up)
    for k in range(count):
        i = which[k]
        hand = -1.0 if c.groove and z[i] > 0.5 * c.face_width else 1.0
        ex, ey = x[i] * inverse[i], y[i] * inverse[i]
        deviation[i], turned = distance[k], across[k] * side[i]
        nx[i], ny[i], nz[i] = ex * along[k] - ey * turned, ey * along[k] + ex * turned, side[i] * hand * up[k]


@step
def on_others(c, x, y, z, radius, inverse, within, code, deviation, nx, ny, nz):
    """The surface with the greatest signed distance of all that a point may belong to, by the rules of `surface._locate_chunk`; in place."""
    b, orientation = c.face_width, c.orientation
    sharp = c.flank_end_radius == c.tip_radius
    for i in range(len(x)):
        was = code[i]
        outer, at_root = was == FLANK, was == ROOT
        root, tip = orientation * (radius[i] - c.root_radius), orientation * (radius[i] - c.tip_radius)
        outline = root if at_root else deviation[i]
        beyond = outer & (not sharp) & (orientation * (radius[i] - c.flank_end_radius) > 0.0)
        highest = (tip >= outline) & (tip >= c.least[TIP])
        drawn = (abs(tip) <= c.most[TIP]) & (within[i] <= c.tip_half_angle)
        at_tip = outer & (highest if sharp else drawn)
        bore = orientation * (c.body_radius - radius[i])
        at_bore = (c.body_radius > 0.0) & (bore > root)
        outline = bore if at_bore else (tip if at_tip else outline)
        at_low = (-z[i] >= outline) & (-z[i] >= c.least[END_LOW])
        at_high = (z[i] - b >= outline) & (z[i] - b >= c.least[END_HIGH])
        at_end, at_round = at_low | at_high, at_root | at_tip | at_bore
        is_ = BORE if at_bore else (TIP if at_tip else (OTHER if beyond else was))
        is_ = END_HIGH if at_high else (END_LOW if at_low else is_)
        inside = min(z[i] - c.low_end, c.high_start - z[i])  # of the groove of a double helical gear
        in_groove = c.groove & ((inside > 0.0) | ((inside >= outline) & (inside >= c.near))) & (is_ != BORE)
        at_edge = (c.edge > 0.0) & (outline > -c.margin) & ((z[i] < c.margin) | (z[i] > b - c.margin))
        code[i] = OTHER if in_groove | at_edge else is_
        deviation[i] = z[i] - b if at_high else (-z[i] if at_low else outline)
        outward = (-orientation if at_bore else orientation) * inverse[i]
        nx[i] = 0.0 if at_end else (outward * x[i] if at_round else nx[i])
        ny[i] = 0.0 if at_end else (outward * y[i] if at_round else ny[i])
        nz[i] = (1.0 if at_high else -1.0) if at_end else (0.0 if at_round else nz[i])


@kernel
def fill(points, c, surfaces, teeth, sides, rolls, positions, normals, deviations):
    """Locate points (n, 3) on the design; into the last seven arrays, the fields of `SurfacePoints`."""
    columns, all_codes = np.empty((13, BLOCK)), np.empty(BLOCK, np.int64)
    for first in range(0, len(points), BLOCK):
        n = min(BLOCK, len(points) - first)
        part = slice(first, first + n)
        block = points[part]
        x, y, z, radius, inverse = columns[0][:n], columns[1][:n], columns[2][:n], columns[3][:n], columns[4][:n]
        reach, number, side, within, own = columns[5][:n], columns[6][:n], columns[7][:n], columns[8][:n], columns[8][:n]
        deviation, nx, ny, nz, code = columns[9][:n], columns[10][:n], columns[11][:n], columns[12][:n], all_codes[:n]
        for i in range(n):
            x[i], y[i], z[i] = block[i, 0], block[i, 1], block[i, 2]
        in_section(c, x, y, z, radius, inverse, reach, number, side, within)
        on_flanks(c, reach, within, deviation)
        if c.modified:
            own = within.copy()
            as_drawn(c, z, side, reach, deviation, own)
        flank_normals(c, x, y, z, inverse, reach, side, nx, ny, nz)
        by_radius(c, radius, own, code)
        on_fillets(c, x, y, z, radius, inverse, side, own, code, deviation, nx, ny, nz)
        on_others(c, x, y, z, radius, inverse, within, code, deviation, nx, ny, nz)
        store(c, x, y, z, reach, number, side, code, deviation, nx, ny, nz,
              surfaces[part], teeth[part], sides[part], rolls[part], positions[part], normals[part], deviations[part])  # fmt: skip


@step
def store(
    c, x, y, z, reach, number, side, code, deviation, nx, ny, nz, surfaces, teeth, sides, rolls, positions, normals, deviations
):
    """What is known of a block, into the result; a surface that the bands exclude is not silently another one: such points are OTHER."""
    for i in range(len(x)):
        d = deviation[i]
        known = (d >= c.least[code[i]]) & (d <= c.most[code[i]]) & (code[i] != OTHER)
        code[i] = code[i] if known else OTHER
        rolls[i] = reach[i] - c.orientation * c.cos_helix * d if code[i] == FLANK else math.nan
        deviations[i] = d if known else math.nan
        deviation[i] = d if known else 0.0
    for i in range(len(x)):
        tooth = number[i] - c.teeth * math.floor(number[i] / c.teeth)
        teeth[i] = np.int32(tooth if tooth == tooth else 0.0)
        surfaces[i] = code[i]
        sides[i] = np.int8(side[i] if code[i] <= FILLET else 0.0)
    for i in range(len(x)):
        d = deviation[i]
        normals[i, 0], normals[i, 1], normals[i, 2] = nx[i], ny[i], nz[i]
        positions[i, 0], positions[i, 1], positions[i, 2] = x[i] - d * nx[i], y[i] - d * ny[i], z[i] - d * nz[i]
