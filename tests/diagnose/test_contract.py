"""What every effect promises, checked on all of them; no effect is named here but in the contract's own table.

An effect's own test file gives `EXAMPLES` and `displace(sample, parameters, shape)`, which moves points in space as the effect's definition
says and is written without the effect; of the shape it uses the choices (a side, a surface) that are not parameters.
"""

from __future__ import annotations

import importlib
import re
from dataclasses import replace
from pathlib import Path
from string import Formatter

import numpy as np
import pytest

from gearwear.design import quantity
from gearwear.design.side import Side
from gearwear.design.surface import locate
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import CatalogueEffect, Effect, Kind
from gearwear.diagnose.parameter import FACTORS, Role, Spread
from gearwear.placing.pose import motion_columns
from tests.diagnose.sample import BORED, CLOSE, FIXED, ODD, context, feet, sample

CONTRACT = {
    "measurement": {
        "coating": "thickness_um",
        "scale": "relative_ppm",
        "scale_anisotropic": "difference_ppm direction_deg",
        "height_scale": "relative_ppm",
        "axis_offset_radial": "offset_um",
        "axis_offset_lateral": "offset_um",
        "turntable_angle": "order amplitude_deg phase_deg",
        "scan_drift": "closure_deg start_deg",
        "lens_distortion": None,
        "incidence_bias": None,
        "edge_rounding": None,
        "view_registration": None,
    },
    "mounting": {"eccentricity": "amplitude_um direction_deg", "wobble": "amplitude_um direction_deg"},
    "manufacture": {
        "tooth_thickness": "thickness_um",
        "profile_slope": "left_um right_um",
        "profile_crowning": "crowning_um",
        "helix_crowning": "crowning_um",
        "tip_relief": "amount_um start_mm",
        "root_relief": "amount_um start_mm",
        "helix_slope": "slope_um",
        "taper": "taper_um",
        "twist": "twist_um",
        "pitch": "index_um",
        "feed_marks": "amplitude_um wavelength_mm phase_deg",
    },
    "wear": {"abrasive_wear": "depth_um", "sliding_wear": "depth_um", "plastic_flow": None, "burr": None},
}
"""The names that others rely on, by kind; None where the parameters are the effect's own. Not edited for a new effect. Pitting is found
as wear regions."""
DOCS = Path(__file__).resolve().parents[2] / "docs" / "effects.md"

EFFECTS = catalogue()
BY_NAME = {effect.name: effect for effect in EFFECTS}


def module_of(effect: Effect) -> str:
    return type(effect).__module__.rsplit(".", 1)[-1]


def own_tests(effect: Effect):
    return importlib.import_module(f"tests.diagnose.test_{module_of(effect)}")


def cases():
    """Every effect with each of its examples; an effect without a test file has none, and fails by name below."""
    found = []
    for effect in EFFECTS:
        if (Path(__file__).parent / f"test_{module_of(effect)}.py").exists():
            for number, example in enumerate(own_tests(effect).EXAMPLES):
                found.append(pytest.param(effect, example, id=f"{effect.name}-{number}"))
    return found


every_effect = pytest.mark.parametrize("effect", EFFECTS, ids=lambda e: e.name)
every_gear = pytest.mark.parametrize("numbers", [BORED, ODD], ids=["bored", "odd"])
every_example = pytest.mark.parametrize(("effect", "example"), cases())


@every_effect
def test_has_a_test_file_with_examples_and_a_displacement(effect):
    path = Path(__file__).parent / f"test_{module_of(effect)}.py"
    assert path.exists(), f"{effect.name} has no tests/diagnose/{path.name}"
    module = own_tests(effect)
    assert module.EXAMPLES and callable(module.displace)
    assert "EFFECT" not in module.displace.__code__.co_names, "the displacement must not use the effect"


@every_effect
def test_declares_what_it_is(effect):
    assert isinstance(effect, Effect)
    assert effect.name == module_of(effect)
    assert isinstance(effect.kind, Kind)
    assert effect.source and effect.parameters
    assert re.fullmatch(r"[A-Z][^.]*(\d\.\d[^.]*)?\.", effect.tells_apart), "one sentence"
    assert effect.group in {"", *(f"G{i}" for i in range(1, 8))}
    assert effect.averaged in {"", "z", "roll"}
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names)
    assert any(parameter.role is Role.SIZE for parameter in effect.parameters)
    assert all(parameter.role is Role.PLACE for parameter in effect.parameters if parameter.period)


def fields_of(phrase: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(phrase) if name is not None}


@every_effect
def test_its_phrase_says_its_size_and_only_what_it_has(effect):
    said, first = fields_of(effect.phrase), effect.parameters[0]
    assert said <= {parameter.name for parameter in effect.parameters}
    assert said & {parameter.name for parameter in effect.parameters if parameter.role is Role.SIZE}
    if effect.phrase_below:
        assert first.signed and first.role is Role.SIZE
        assert fields_of(effect.phrase_below) == said and first.name in said
        assert effect.phrase_below != effect.phrase
    if effect.phrase_of_sides:
        assert said == {first.name} and fields_of(effect.phrase_of_sides) == {one.name for one in effect.parameters[1:]}


def test_units_are_those_that_are_written_and_stand_for_what_they_are():
    assert set(FACTORS) <= set(quantity.UNITS)
    inner = {"um": 1e-3, "mm": 1.0, "deg": np.radians(1.0), "ppm": 1e-6, "1": 1.0}
    for unit, factor in FACTORS.items():
        np.testing.assert_allclose(factor * inner[unit], 1.0, rtol=1e-15)


def test_the_contracts_names_kinds_and_parameters_are_kept():
    for kind, effects in CONTRACT.items():
        for name, parameters in effects.items():
            assert BY_NAME[name].kind == kind, name
            own = [one.name for one in BY_NAME[name].parameters]
            assert parameters is None or own[: len(parameters.split())] == parameters.split(), name  # more may follow


@every_gear
@every_effect
def test_basis_is_finite_and_its_columns_are_independent(effect, numbers):
    points, about = feet(numbers, CLOSE), context(numbers)
    for shape in effect.shapes(about):
        basis = effect.basis(points, about, shape)
        assert basis.dtype == np.float64
        assert basis.shape == (len(points), basis.shape[1])
        assert np.isfinite(basis).all()
        size = np.linalg.norm(basis, axis=0)
        assert (size > 0.0).all()
        assert np.linalg.svd(basis / size, compute_uv=False)[-1] > 1e-3


@every_gear
@every_effect
def test_basis_belongs_to_each_foot_alone(effect, numbers):
    points, about = feet(numbers, CLOSE), context(numbers)
    order = np.random.default_rng(1).permutation(len(points))
    mixed = points.take(order).with_deviation(np.full(len(points), np.nan))
    for shape in effect.shapes(about)[:4]:
        np.testing.assert_array_equal(effect.basis(mixed, about, shape), effect.basis(points, about, shape)[order])


@every_gear
@every_effect
def test_what_depends_on_the_sides_that_are_worn_says_so(effect, numbers):
    """The other columns are kept where a scan is looked at with other sides worn."""
    points, about, other = feet(numbers, CLOSE), context(numbers), False
    for worn in (frozenset({Side.LEFT}), frozenset({Side.RIGHT}), frozenset(Side)):
        without = replace(about, worn=worn)
        assert effect.applies(without) == effect.applies(about) and effect.shapes(without) == effect.shapes(about)
        bases = ([effect.basis(points, one, shape) for one in (about, without)] for shape in effect.shapes(about))
        other |= any(not np.array_equal(*pair) for pair in bases)
    assert other == effect.by_worn


@every_gear
@every_effect
def test_bracket_holds_the_shape_and_is_safe_to_its_ends(effect, numbers):
    points, about = feet(numbers, CLOSE), context(numbers)
    for shape in effect.shapes(about):
        ranges = effect.bracket(shape, about)
        assert len(ranges) <= len(shape)
        own = np.abs(effect.basis(points, about, shape)).max()
        for axis, (low, high) in enumerate(ranges):
            assert low < high and low <= shape[axis] <= high
            for value in (low, high):
                basis = effect.basis(points, about, (*shape[:axis], value, *shape[axis + 1 :]))
                assert np.isfinite(basis).all()
                assert 0.0 < np.abs(basis).max() < 3.0 * own


@every_example
def test_basis_is_what_really_displaced_points_measure_to_second_order(effect, example):
    numbers = example.gear
    one, about = sample(numbers), context(numbers)
    foot = feet(numbers)
    basis = effect.basis(foot, about, example.shape) @ np.array(example.amplitudes)
    assert np.abs(basis).max() > 1e-3, "an example must be large enough to be seen"
    errors = []
    for factor in (1.0, 0.5):
        moved = locate(own_tests(effect).displace(one, example.scaled(factor), example.shape), one.gear)
        same = (moved.surface == foot.surface) & (moved.tooth == foot.tooth) & (moved.side == foot.side)
        assert same.mean() > 0.95
        errors.append(np.abs(moved.deviation - factor * basis)[same].max())
    assert errors[0] < 0.05 * np.abs(basis).max()
    assert errors[1] < 0.3 * errors[0] or errors[0] < 1e-9


@every_example
def test_amplitudes_come_back_from_their_own_data_with_the_pose_free(effect, example):
    points, about = feet(example.gear, CLOSE), context(example.gear)
    basis = effect.basis(points, about, example.shape)
    pose = motion_columns(points.position, points.normal)
    motion = np.array([0.02, -0.03, 0.01, 1e-4, -2e-4, 3e-4])
    data = basis @ np.array(example.amplitudes) + pose @ motion
    found = np.linalg.lstsq(np.hstack([pose, basis]), data, rcond=None)[0]
    np.testing.assert_allclose(found[6:], example.amplitudes, rtol=1e-7, atol=1e-7 * np.abs(example.amplitudes).max())


@every_example
def test_estimates_are_the_contracts_parameters_and_units(effect, example):
    amplitudes = np.array(example.amplitudes)
    found = effect.estimates(amplitudes, np.diag(1e-4 * amplitudes**2 + 1e-14), example.shape, context(example.gear))
    names = tuple(one.name for one in effect.parameters)
    assert tuple(found) == tuple(example.parameters)
    assert tuple(found) == names or (effect.phrase_of_sides and tuple(found) == names[:1])
    for one, (name, estimate) in zip(effect.parameters, found.items(), strict=False):
        assert estimate.unit == (name.rsplit("_", 1)[-1] if "_" in name else "1")
        assert one.period is None or 0.0 <= estimate.value < one.period
        np.testing.assert_allclose(estimate.value, example.parameters[name], rtol=1e-9, atol=1e-9, err_msg=name)
        assert name in FIXED or (np.asarray(estimate.std) > 0.0).all()


@every_example
def test_standard_deviations_are_the_covariance_propagated(effect, example):
    about = context(example.gear)
    at = np.array([*example.amplitudes, *example.shape[: len(effect.bracket(example.shape, about))]])
    p = len(example.amplitudes)
    root = np.random.default_rng(2).normal(size=(len(at), len(at))) * (0.01 * np.abs(at) + 1e-9)[:, None]
    covariance = root @ root.T

    def values(x):
        shape = (*x[p:].tolist(), *example.shape[len(x) - p :])
        return effect.estimates(x[:p], covariance, shape, about)

    for one, (name, estimate) in zip(effect.parameters, values(at).items(), strict=False):
        if one.spread is not Spread.SMOOTH:
            continue
        slope = []
        for i in range(len(at)):
            step = np.zeros(len(at))
            step[i] = 1e-5 * (abs(at[i]) + 1e-6)
            up, down = (np.asarray(values(at + way * step)[name].value) for way in (1, -1))
            slope.append((up - down) / (2.0 * step[i]))
        spread = np.sqrt(np.einsum("i...,ij,j...->...", np.array(slope), covariance, np.array(slope)))
        np.testing.assert_allclose(estimate.std, spread, rtol=1e-4, err_msg=name)


@every_example
def test_allows_the_possible_and_refuses_the_impossible(effect, example):
    about, amplitudes = context(example.gear), np.array(example.amplitudes)
    assert effect.allowed(amplitudes, example.shape, about) is True
    assert effect.allowed(1000.0 * amplitudes, example.shape, about) is False
    assert effect.allowed(np.nan * amplitudes, example.shape, about) is False
    mirrored = effect.allowed(-amplitudes, example.shape, about)
    sizes = [one for one in effect.parameters if one.role is Role.SIZE]
    assert mirrored or not any(one.signed for one in sizes)
    for allowed in (amplitudes, -amplitudes)[: 1 + mirrored]:
        found = effect.estimates(allowed, np.eye(len(allowed)), example.shape, about)
        assert all(np.min(found[one.name].value) >= 0.0 for one in effect.parameters if not one.signed)


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.kind == Kind.WEAR], ids=lambda e: e.name)
def test_wear_is_on_the_flanks_of_one_side_and_what_the_search_tries_never_adds_material(effect):
    points, about = feet(BORED, CLOSE), context(BORED)
    sides, adds = set(), False
    for shape in effect.shapes(about):
        basis = effect.basis(points, about, shape)
        for column in basis.T:  # each side by an amount of its own
            worn = column != 0.0
            (side,) = set(points.side[worn].tolist())
            sides.add(side)
            assert set(points.surface[worn].tolist()) == {0}
        for amplitude in (0.05, -0.05):
            every = np.full(basis.shape[1], amplitude)
            adds |= effect.allowed(every, shape, about) and bool((basis @ every > 0.0).any())
    assert sides == {1, -1}
    assert effect.searched is not adds


def test_the_search_tries_everything_else():
    assert all(effect.searched for effect in EFFECTS if effect.kind != Kind.WEAR)


@pytest.mark.parametrize("planar", [False, True])
def test_an_effect_that_applies_moves_something_the_scan_has_seen(planar):
    points = feet(BORED, CLOSE)
    lone = points.take(points.surface == 0)
    about = context(BORED, planar=planar)
    flanks_only = type(about)(about.gear, frozenset({0}), about.scan_axes, planar, about.mate)
    for effect in EFFECTS:
        if effect.applies(flanks_only):
            assert any(effect.basis(lone, flanks_only, shape).any() for shape in effect.shapes(flanks_only)), effect.name


def rows(text: str) -> dict[str, tuple[str, str]]:
    """Rows of the document's tables by the name in their first cell, with the heading they stand under."""
    found, heading = {}, ""
    for line in text.splitlines():
        if line.startswith("## "):
            heading = line[3:].strip().lower()
        if match := re.match(r"\| `(\w+)` \|", line):
            found[match[1]] = (heading, line)
    return found


@every_effect
def test_has_its_row_in_the_docs(effect):
    heading, row = rows(DOCS.read_text(encoding="utf-8"))[effect.name]
    assert heading == effect.kind
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert len(cells) == 6 and all(cells)
    assert all(f"`{parameter.name}`" in cells[2] for parameter in effect.parameters)
    assert cells[4] == effect.tells_apart
    assert cells[5] == effect.source


def test_the_docs_name_no_effect_that_is_not_there():
    assert set(rows(DOCS.read_text(encoding="utf-8"))) == set(BY_NAME)


@every_example
def test_where_the_whole_displacement_is_known_it_is_the_true_one(effect, example):
    points = sample(example.gear)
    moved = effect.displacement(points.position, np.array(example.amplitudes), example.shape)
    if moved is None:
        assert type(effect).displacement is CatalogueEffect.displacement
        return
    true = own_tests(effect).displace(points, example.parameters, example.shape)
    np.testing.assert_allclose(points.position + moved, true, atol=1e-12, rtol=0.0)
