"""Linear algebra on one thread: inside every verb, whatever the process had before, which it gets back."""

from __future__ import annotations

from contextlib import nullcontext
from importlib import import_module

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import gearwear as gw
from gearwear import threads
from gearwear.threads import on_one_thread
from tests.synthetic import Effect, Patch, Recipe, make_scan


def taken() -> set[int]:
    """Threads that the linear algebra of numpy and scipy may take."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.fixture
def two() -> object:
    with threadpool_limits(2, "blas") as limits:
        assert taken() == {2}
        yield limits


@on_one_thread
def inside() -> set[int]:
    return taken()


@on_one_thread
def nested() -> tuple[set[int], set[int]]:
    return inside(), taken()


@on_one_thread
def fails() -> None:
    raise ZeroDivisionError


def test_one_inside_and_what_was_before_outside(two):
    assert inside() == {1}
    assert nested() == ({1}, {1})
    with pytest.raises(ZeroDivisionError):
        fails()
    assert taken() == {2}


VERBS = (
    "comparison.measured_gear.register", "comparison.measured_gear.find_effects", "comparison.stations.compare",
    "wear.regions.find_wear", "inspection.inspection.inspect", "identify.candidates.find_candidates", "meshing.contact.mesh_contact",
    "meshing.study.study_meshing", "wear_law.fit.fit_wear_law", "wear_law.forecast.forecast_wear", "wear_law.forecast.cycles_left",
    "report.write.write_results",
)  # fmt: skip


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_that_works_on_matrices_is_limited(verb, monkeypatch):
    limited = []
    monkeypatch.setattr(threads, "threadpool_limits", lambda **limit: nullcontext(limited.append(limit)))
    module, _, name = verb.rpartition(".")
    with pytest.raises(TypeError):
        getattr(import_module(f"gearwear.{module}"), name)()  # called with nothing it comes as far as that
    assert limited == [{"limits": 1, "user_api": "blas"}]


def test_results_are_the_same_to_the_last_digit_with_one_and_two_threads():
    recipe = Recipe(
        pose="mild", noise_um=6.0, jitter=1.0, wear=(Patch(2, 1, 200.0, (37.0, 43.0), (3.0, 12.0)),),
        effects=(Effect("coating", {"thickness_um": 15.0}),),
    )  # fmt: skip
    points = make_scan(recipe.of_size(12_000), 3).points
    design = gw.read_design(gw.example())

    def numbers() -> tuple[bytes, ...]:
        measured = gw.find_effects(gw.register(design, gw.as_scan(points)))
        wear, inspection = gw.find_wear(measured), gw.inspect(measured)
        arrays = (
            measured.pose.rotation, measured.pose.translation, measured.as_made.points.deviation, measured.loop.motion,
            wear.volume, wear.volume_std, wear.depth, inspection.coverage,
        )  # fmt: skip
        return tuple(np.asarray(array).tobytes() for array in arrays)

    results = []
    for number in (1, 2):
        with threadpool_limits(number, "blas"):
            results.append(numbers())
    assert results[0] == results[1]
