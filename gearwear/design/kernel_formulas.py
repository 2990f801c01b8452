"""What the loops of `kernel` do for a single point: angles, and the feet and plumb lines of the three root curves.

arctan, sine and cosine are written out, so that loops over them become vector instructions: polynomials, good to three and two units in the last
place. Those of sine and cosine are Cephes' (S. L. Moshier, *Methods and Programs for Mathematical Functions*, 1989).

numba's cache of a loop looks at the file that it is in: who changes this one saves `kernel` too.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.compiled import formula


@formula
def arctan(u):
    """Of what is at most tan π/8: u + u³ p(u²), p of degree 9, minimax, 1.5e-16 of the result."""
    s = u * u
    p = 0.022748017702317835
    p = p * s - 0.04483151242103193
    p = p * s + 0.05736276504302438
    p = p * s - 0.0664960461708926
    p = p * s + 0.07691054298962206
    p = p * s - 0.09090852509603119
    p = p * s + 0.11111109635062964
    p = p * s - 0.14285714266073962
    p = p * s + 0.19999999999898274
    p = p * s - 0.3333333333333325
    return u + u * (s * p)


@formula
def reduced(y, x):
    """Fraction whose arctan is that of y / x, of what is not negative, but for what `unreduced` adds: numerator and denominator, 0 and 1 of 0 / 0."""
    large, small = max(x, y), min(x, y)
    far = small > 0.41421356237309503 * large  # tan π/8
    return (small - large if far else small), max(small + large if far else large, 1e-90), far


@formula
def unreduced(angle, far, steep):
    """arctan of the whole from that of the reduced fraction."""
    angle += 0.7853981633974483 if far else 0.0
    return 1.5707963267948966 - angle if steep else angle


@formula
def in_quadrant(angle, y, x):
    """Polar angle from that of the absolute values."""
    return math.copysign(angle if x >= 0.0 else 3.141592653589793 - angle, y)


@formula
def atan2(y, x):
    """Polar angle; 0 at the origin."""
    ax, ay = abs(x), abs(y)
    above, below, far = reduced(ay, ax)
    return in_quadrant(unreduced(arctan(above / below), far, ay > ax), y, x)


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
    """One step of Halley's to tan φ of the normal through a point, F(tan φ) = 0: `RackTip.normal_angle`, which has F and F'."""
    reference, depth, offset, stretch, c = root[0], root[2], root[3], root[4], root[5]
    roll, stretch = c * depth / reference, stretch / reference
    cos = 1.0 / math.sqrt(1.0 + tangent * tangent) if stretch != 0.0 else 1.0  # of a spur gear it is not needed
    cubed = cos * cos * cos
    cos_turn, sin_turn = cosine_sine(angle - offset / reference + tangent * (roll - stretch * cos))
    rate, bend = roll - stretch * cubed, 3.0 * stretch * tangent * (cubed * cos * cos)
    radial, tangential = radius * cos_turn, radius * sin_turn
    inward, across = reference - radial, c * tangent
    lever = radial - tangential * across
    miss = tangential - inward * across
    slope = rate * lever - c * inward
    curve = bend * lever - rate * (rate * (tangential + across * radial) + 2.0 * c * tangential)
    square = slope * slope
    step = miss * slope / max(min(max(square - 0.5 * miss * curve, 0.5 * square), 2.0 * square), 1e-18)
    return min(max(tangent - min(max(step, -0.5), 0.5), 0.0), most)


@formula
def rack_plumb_line(root, radius, angle, tangent):
    """Distance, the normal along the point's radius and across it, and its lever: `RackTip.plumb_line` and `lever`."""
    reference, tip, depth, offset, stretch, c = root[0], root[1], root[2], root[3], root[4], root[5]
    across = c * tangent
    secant = math.sqrt(1.0 + across * across)
    cos = 1.0 / secant
    sin = across * cos
    normal_cos = 1.0 / math.sqrt(1.0 + tangent * tangent) if c != 1.0 else cos
    turn = tangent * (c * depth / reference - stretch / reference * normal_cos) - offset / reference
    cos_turn, sin_turn = cosine_sine(angle + turn)
    inward = reference - radius * cos_turn
    distance = depth * secant + (tip * (normal_cos * secant) if c != 1.0 else tip) - (inward * cos + radius * sin_turn * sin)
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
