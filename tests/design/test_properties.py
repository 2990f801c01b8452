"""Whatever is said about a gear, it is built whole or refused in one line."""

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from gearwear.design import Design, Gear, GearSpec, parse_design, read_design
from gearwear.design.files.sections import PAIR_KEYS
from gearwear.design.files.toml import GEAR_KEYS
from gearwear.design.surface import OTHER, flank_points, locate
from gearwear.errors import InputError

any_float = st.floats(allow_nan=True, allow_infinity=True)


def near(usual: list[float], low: float, high: float) -> st.SearchStrategy[float]:
    """Usual values, the legal range with its ends, and anything at all."""
    return st.one_of(st.sampled_from([*usual, low, high]), st.floats(low, high), st.floats(low, high), any_float)


specs = st.fixed_dictionaries(
    {
        "teeth": st.one_of(st.sampled_from([5, 6, 8, 12, 17, 18, 24, 100, 10000]), st.integers(5, 60), st.integers(-3, 20000)),
        "normal_module": near([0.05, 1.0, 6.35, 1000.0], 0.2, 20.0),
        "face_width": near([5.0, 1e5], 1.0, 100.0),
        "normal_pressure_angle": near([math.radians(a) for a in (14.5, 20.0, 25.0, 30.0)], math.radians(5.0), math.radians(45.0)),
        "profile_shift": near([0.0, 0.3], -1.0, 1.5),
        "addendum": near([1.0], 0.0, 1.4),
        "dedendum": near([1.25, 1.0], 0.0, 1.6),
        "rack_tip_radius": near([0.0, 0.25, 0.3, 0.38], 0.0, 0.6),
        "thinning": near([0.0], -0.1, 0.2),
        "bore_diameter": near([0.0], 0.0, 30.0),
        "tip_chamfer": near([0.0], 0.0, 0.3),
        "end_chamfer": near([0.0], 0.0, 3.0),
    }
)


def check_one_line(error: InputError) -> None:
    message = str(error)
    assert message.isprintable(), message
    assert 10 < len(message) < 500


def check_whole(gear: Gear) -> None:
    """Everything finite, in order, continuous, and at home on itself."""
    assert 0.0 < gear.root_radius <= gear.form_radius < gear.flank_end_radius <= gear.tip_radius < math.inf
    assert gear.form_radius >= gear.base_radius * (1.0 - 1e-12)
    assert 0.0 <= gear.form_roll < gear.tip_roll < math.inf
    assert gear.tip_half_angle > 0.0
    assert 0.0 <= gear.root_half_angle < 0.5 * gear.pitch_angle
    radius = np.linspace(gear.root_radius, gear.tip_radius, 101)
    half = gear.half_angle(radius)
    assert (half > 0.0).all()
    assert (half <= 0.5 * gear.pitch_angle).all()
    just_below = float(gear.half_angle(np.nextafter(gear.form_radius, 0.0)))
    assert abs(just_below - float(gear.half_angle(gear.form_radius))) < 1e-6
    ring = math.pi * (gear.tip_radius**2 - (0.5 * gear.spec.bore_diameter) ** 2)
    disc = math.pi * (gear.root_radius**2 - (0.5 * gear.spec.bore_diameter) ** 2)
    assert disc < gear.section_area() < ring

    roll = np.linspace(gear.form_roll, gear.tip_roll, 9)
    flank = flank_points(gear, np.arange(9) % gear.teeth, np.array([1, -1, 1] * 3), roll, np.full(9, 0.5 * gear.face_width))
    found = locate(flank.position, gear, workers=1)
    known = found.surface != OTHER
    assert np.isfinite(found.position).all()
    assert (np.abs(found.deviation[known]) < 1e-9 * gear.tip_radius).all()


@settings(max_examples=250, deadline=None, derandomize=True, database=None)
@given(specs)
@example(
    {"teeth": 10, "normal_module": 1.0, "face_width": 5.0, "normal_pressure_angle": math.radians(30.0), "rack_tip_radius": 0.0}
)
def test_any_gear_is_whole_or_refused(values):
    try:
        gear = Gear.from_spec(GearSpec("gear", **values))
    except InputError as error:
        check_one_line(error)
    else:
        check_whole(gear)


scalars = st.one_of(
    st.integers(-5, 50),
    any_float,
    st.floats(0.01, 20.0),
    st.booleans(),
    st.text(max_size=5),
    st.sampled_from([10**400, -(10**400), 1 << 20000, "zero_backlash", "1\n2", 0, -0.0, 1e-310, 1e308]),
    st.dates(),
    st.times(),
)
values = st.one_of(scalars, scalars, st.lists(scalars, max_size=2), st.dictionaries(st.text(max_size=3), scalars, max_size=2))
gear_tables = st.builds(
    lambda base, change: {**base, **change},
    st.sampled_from(
        [
            {},
            {"teeth": 20, "module": 2.0, "face_width": 10.0},
            {"teeth": 12, "diametral_pitch": 4, "face_width": 15, "profile_shift": 0.3},
            {"teeth": 24},
        ]
    ),
    st.dictionaries(st.one_of(st.sampled_from(GEAR_KEYS), st.text(max_size=4)), values, max_size=3),
)
pair_tables = st.dictionaries(st.one_of(st.sampled_from(PAIR_KEYS), st.text(max_size=4)), values, max_size=3)
scanner_tables = st.dictionaries(st.one_of(st.just("axis_offset_mm"), st.text(max_size=4)), values, max_size=2)
files = st.one_of(
    st.fixed_dictionaries({"gear": gear_tables}),
    st.fixed_dictionaries(
        {"gear": gear_tables, "pinion": gear_tables}, optional={"pair": pair_tables, "scanner": scanner_tables}
    ),
    st.dictionaries(st.one_of(st.sampled_from(["gear", "pinion", "pair", "scanner"]), st.text(max_size=4)), values, max_size=4),
)


@pytest.mark.long
@settings(max_examples=200, deadline=None, derandomize=True, database=None)
@given(files)
def test_any_table_is_a_design_or_refused(data):
    try:
        design = parse_design(data)
    except InputError as error:
        check_one_line(error)
    else:
        assert isinstance(design, Design)
        for gear in design.gears.values():
            check_whole(gear)
        assert all(warning.isprintable() for warning in design.warnings)


DESIGN = b'[pair]\ncentre_distance = 114.3\nbaseline = "zero_backlash"\n[pinion]\nteeth = 12\nmodule = 6.35\nface_width = 15\n[gear]\nteeth = 24\n'


def check_file(content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "design.toml"
        path.write_bytes(content)
        try:
            assert isinstance(read_design(path), Design)
        except InputError as error:
            assert str(error).startswith(f"{path}: ")
            assert str(error).isprintable(), str(error)


@settings(max_examples=150, deadline=None, derandomize=True, database=None)
@given(st.binary(max_size=200))
def test_any_bytes_are_a_design_or_refused(content):
    check_file(content)


@settings(max_examples=250, deadline=None, derandomize=True, database=None)
@given(
    st.integers(0, len(DESIGN)),
    st.integers(0, 8),
    st.one_of(st.binary(max_size=6), st.sampled_from([b"\n", b"[", b"e9", b"-", b"=", b'"', b"."])),
)
def test_a_damaged_design_is_a_design_or_refused(at, gone, put):
    check_file(DESIGN[:at] + put + DESIGN[at + gone :])
