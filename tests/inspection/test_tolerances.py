import math
from dataclasses import asdict, replace

import numpy as np
import pytest

from gearwear.errors import InputError
from gearwear.inspection.tolerances import (
    CLASSES,
    SYMBOLS,
    Edition,
    Size,
    least_class,
    round_micrometres,
    tolerances,
)

PINION, WHEEL = Size(76.2, 6.35, 15.0, 12), Size(152.4, 6.35, 15.0, 24)
NAMES_2013 = (
    "single_pitch", "cumulative_pitch", "profile_slope", "profile_form", "profile_total",
    "helix_slope", "helix_form", "helix_total", "runout", "adjacent_pitch",
)  # fmt: skip


@pytest.mark.parametrize(
    ("size", "iso_class", "printed"),
    [
        (PINION, 5, "7.6 21.4 6.6 8.5 10.8 5.8 6.4 8.6 19.3 10.8"),
        (PINION, 8, "21.5 60.5 18.7 24.0 30.4 16.4 18.0 24.3 54.5 30.5"),
        (PINION, 10, "43.1 121 37.4 48.0 60.9 32.8 35.9 48.6 108.9 60.9"),
        (WHEEL, 8, "21.8 66.6 18.9 24.0 30.6 16.9 18.7 25.2 59.9 30.8"),
    ],
)
def test_2013_tables_to_the_printed_digits(size, iso_class, printed):
    found = tolerances(size, iso_class, rounded=False)
    for name, text in zip(NAMES_2013, printed.split(), strict=True):
        digits = len(text.partition(".")[2])
        assert round(1e3 * getattr(found, name), digits) == float(text), name


def test_1995_table_to_the_printed_digits():
    found = tolerances(PINION, 8, Edition.ISO_1995, rounded=False)
    names = ("single_pitch", "cumulative_pitch", "profile_total", "profile_form", "profile_slope", "helix_total", "helix_slope")
    for name, value in zip(names, (20.9, 57.8, 32.7, 25.4, 20.7, 21.1, 15.0), strict=True):
        assert round(1e3 * getattr(found, name), 1) == value, name
    assert found.helix_form == found.helix_slope
    assert found.runout == pytest.approx(0.8 * found.cumulative_pitch)
    assert math.isnan(found.adjacent_pitch)


def test_1995_depends_on_the_range_only():
    same = [tolerances(Size(d, m, b, 12), 7, Edition.ISO_1995) for d, m, b in ((50.1, 6.01, 10.1), (125.0, 10.0, 20.0))]
    np.testing.assert_equal(asdict(same[0]), asdict(same[1]))
    assert tolerances(Size(125.1, 10.0, 20.0, 12), 7, Edition.ISO_1995) != same[0]


def test_sector_over_a_quarter_is_the_cumulative_tolerance():
    # Annex D is built so; an independent check of both formulas
    for size in (Size(76.2, 6.35, 15.0, 12), Size(400.0, 10.0, 80.0, 40)):
        found = tolerances(size, 6, sector=size.teeth // 4, rounded=False)
        assert found.sector_pitch == pytest.approx(found.cumulative_pitch, rel=1e-12)


@pytest.mark.parametrize("edition", list(Edition))
def test_two_classes_double_the_unrounded_tolerance(edition):
    for iso_class in list(CLASSES[edition])[:-2]:
        fine, coarse = (tolerances(PINION, c, edition, rounded=False) for c in (iso_class, iso_class + 2))
        for name in SYMBOLS:
            np.testing.assert_allclose(getattr(coarse, name), 2.0 * getattr(fine, name), rtol=1e-12)


@pytest.mark.parametrize(
    ("value", "rounded"),
    [
        (60.5, 61.0),
        (60.49, 60.0),
        (10.51, 11.0),
        (10.0, 10.0),
        (9.74, 9.5),
        (9.75, 10.0),
        (5.0, 5.0),
        (4.96, 5.0),
        (4.94, 4.9),
        (0.84, 0.8),
        *((round(0.1 * n + 0.05, 2), round(0.1 * (n + 1), 1)) for n in range(49)),
    ],
)
def test_rounding(value, rounded):
    """With each half below 5 µm, of which most are no binary numbers."""
    assert round_micrometres(value) == rounded


def test_a_tolerance_that_is_a_half_goes_up():
    """z = 25, m = 2: f_Hα of class 5 is 0.4 · 2 + 0.001 · 50 + 4 = 4.85 µm."""
    found = tolerances(Size(50.0, 2.0, 15.0, 25), 5)
    assert round(1e3 * found.profile_slope, 6) == 4.9


def test_rounded_tolerances_lie_on_the_grid():
    found = tolerances(PINION, 8)
    assert [round(1e3 * getattr(found, name), 6) for name in ("single_pitch", "profile_slope", "helix_slope")] == [
        22.0,
        19.0,
        16.0,
    ]


def test_class_is_the_least_not_exceeded():
    def limit(iso_class: int) -> float:
        return tolerances(PINION, iso_class).profile_slope

    classes = CLASSES[Edition.ISO_2013]
    for iso_class in classes:
        assert least_class(limit(iso_class), limit, classes) == iso_class
        assert least_class(-limit(iso_class), limit, classes) == iso_class
        above = least_class(limit(iso_class) + 1e-6, limit, classes)
        assert above == (iso_class + 1 if iso_class < 11 else None)


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (replace(PINION, teeth=4), "4 teeth"),
        (replace(PINION, reference_diameter=4.9), "reference diameter 4.9 mm"),
        (replace(PINION, normal_module=0.4), "module 0.4 mm"),
        (replace(PINION, face_width=3.0), "face width 3 mm"),
    ],
)
def test_refuses_what_the_standard_does_not_cover(size, words):
    with pytest.raises(InputError, match=words):
        tolerances(size, 8)


def test_refuses_a_class_that_does_not_exist():
    with pytest.raises(InputError, match="class 12 does not exist, it has 1 to 11"):
        tolerances(PINION, 12)
    assert tolerances(PINION, 12, Edition.ISO_1995).runout > 0.0
