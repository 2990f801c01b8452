"""Linear algebra on one thread: inside every verb, whatever the process had before, which it gets back."""

from __future__ import annotations

from contextlib import nullcontext
from importlib import import_module
from types import SimpleNamespace

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import gearwear as gw
from gearwear import threads
from gearwear.threads import on_one_thread
from tests.commands.doors import ALONE
from tests.synthetic import Effect, Recipe, make_scan


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
    "comparison.measured_gear.register", "comparison.closing.find_effects", "comparison.stations.compare",
    "wear.regions.find_wear", "inspection.inspection.inspect", "identify.candidates.find_candidates", "meshing.contact.mesh_contact",
    "meshing.study.study_meshing", "wear_law.fit.fit_wear_law", "wear_law.forecast.forecast_wear", "wear_law.forecast.cycles_left",
    "report.write.write_results", "loaded.study.study_load", "loaded.contact.loaded_contact", "loaded.contact.loaded_variants",
    "loaded.wearing.run_wear", "loaded.wearing.run_wear_ensemble", "wear_law.running.run_histories", "running.search.find_running",
)  # fmt: skip


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_that_works_on_matrices_is_limited(verb, monkeypatch):
    limited = []
    libraries = SimpleNamespace(limit=lambda **limit: nullcontext(limited.append(limit)))
    monkeypatch.setattr(threads, "_libraries", lambda with_scipy: libraries)
    module, _, name = verb.rpartition(".")
    with pytest.raises(TypeError):
        getattr(import_module(f"gearwear.{module}"), name)()  # called with nothing it comes as far as that
    assert limited == [{"limits": 1, "user_api": "blas"}]


def test_results_are_the_same_to_the_last_digit_with_one_and_two_threads():
    """A loop and the volume of wear, whole, with matrices long enough for two threads to share; which sides are worn is told, not looked for."""
    recipe = Recipe(pose="none", noise_um=6.0, jitter=1.0, effects=(Effect("coating", {"thickness_um": 15.0}),))
    placed = gw.register(ALONE, gw.as_scan(make_scan(recipe.of_size(30_000), 3).points))
    results = []
    for number in (1, 2):
        with threadpool_limits(number, "blas"):
            measured = gw.find_effects(placed, worn=frozenset())
            wear = gw.find_wear(measured)
            estimates = [estimate for effect in measured.loop.effects for estimate in effect.parameters.values()]
            numbers = [number for estimate in estimates for number in (estimate.value, estimate.std)]
            results.append((wear.volume, wear.volume_std, *numbers, measured.as_made.points.deviation.tobytes()))
    assert results[0] == results[1]
