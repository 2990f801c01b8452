import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.design.involute import inverse_involute, involute_at_roll, involute_function, roll_length

EPS = np.finfo(float).eps


@pytest.mark.parametrize("exponent", np.linspace(-12, 4, 33))
def test_inverse_of_the_involute_function_gives_the_value_back(exponent):
    value = 10.0**exponent
    tangent = math.tan(inverse_involute(value))
    # t − atan t = v; t carries ε t, and atan t is subtracted from it. Near π/2 the angle resolves tan only to ε tan².
    assert abs(tangent - math.atan(tangent) - value) <= 4 * EPS * tangent + EPS * tangent * tangent


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(st.floats(1e-4, 1.56))
def test_involute_function_of_the_inverse_gives_the_angle_back(angle):
    # d inv/dα = tan² α: an error of a few ε tan α in inv α is ε / tan α in α.
    assert abs(inverse_involute(involute_function(angle)) - angle) <= 8 * EPS / math.tan(angle) + 8 * EPS * angle


@pytest.mark.parametrize("value", [1e-12, 1e-10, 1e-8])
def test_small_values_follow_the_power_series(value):
    # inv α = α³/3 + 2α⁵/15 + …, reversed; the next term is below α⁴, the docstring's error is ε/α²
    w = math.cbrt(3.0 * value)
    series = w - 2.0 * w**3 / 15.0
    assert abs(inverse_involute(value) / series - 1.0) <= w**4 + 4 * EPS / w**2


def test_zero_has_the_angle_zero():
    assert inverse_involute(0.0) == 0.0


@pytest.mark.parametrize("value", [-1e-9, math.nan, math.inf, -math.inf])
def test_values_without_an_angle_are_refused(value):
    with pytest.raises(ValueError, match="has no angle"):
        inverse_involute(value)


@pytest.mark.parametrize(
    ("inv", "degrees"),
    [(0.03431726, 26.088833), (0.01524139, 20.144619), (0.01750417, 21.061735), (0.01766871, 21.125096)],
)
def test_published_working_pressure_angles(inv, degrees):
    """bolsover.com (m = 3, 12/24) and the KHK-style examples with z = 30/78, 22/118, 17/96; inv printed to 1e-8."""
    # 5e-9 of inv is 5e-9 / tan² α rad
    angle = inverse_involute(inv)
    assert abs(math.degrees(angle) - degrees) <= math.degrees(5e-9 / math.tan(angle) ** 2) + 5e-7


def test_roll_length_keeps_its_digits_at_the_base_circle():
    # (r_b + h)² − r_b² = h (2 r_b + h), exact in powers of two
    assert roll_length([1.0 + 2.0**-40], 1.0)[0] == math.sqrt(2.0**-40 * (2.0 + 2.0**-40))


def test_no_involute_inside_the_base_circle():
    assert roll_length([13.0, 4.9], 5.0).tolist() == [12.0, 0.0]


def test_roll_length_and_angle_are_two_names_of_one_point():
    angle = np.radians([5.0, 20.0, 40.0])
    expected = [involute_function(a) for a in angle]
    np.testing.assert_allclose(involute_at_roll(7.0 * np.tan(angle), 7.0), expected, rtol=0, atol=4 * EPS)
