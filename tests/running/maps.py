"""Wear maps from simulated running, with errors of a known covariance: no scan, and no part of the fit."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.loaded.steel import Material
from gearwear.meshing.path import path_of_contact
from gearwear.running.conditions import Runs
from gearwear.running.found import SecondLoop
from gearwear.running.search import find_running
from gearwear.running.study import REACH, law_basis
from gearwear.running.wear_map import WearMap
from gearwear.wear_law.archard import LoadSharing
from tests.synthetic.outline import PINION, Outline
from tests.synthetic.ran import RanWear

PAIR = tuple(Gear.from_spec(GearSpec(name, teeth, 6.35, 15.0)) for name, teeth in (("pinion", 12), ("gear", 24)))
CENTRE = 114.3
STRIPS, SLICES, FINER = 12, 5, 4
TEETH = np.arange(12)
LOAD, SINGLE_UM = 150.0, 12.0
NOISE, TEXTURE = 0.0010, 0.0006
"""mm of a place on one tooth: by itself, and shared with its neighbours."""


def edges() -> Floats:
    """Lengths of roll that part the strips, mm."""
    pinion, mate = PAIR
    path = path_of_contact(pinion, mate, CENTRE)
    low, high = max(pinion.form_roll + 0.4, path.start_pinion), min(pinion.tip_roll - 0.13, path.end_pinion)
    return np.sqrt(np.linspace(low**2, high**2, STRIPS + 1))


def map_of(wear: RanWear, seed: int = 0) -> WearMap:
    """The map of a pinion's left flanks that ran so."""
    random, roll = np.random.default_rng(seed), edges()
    fine = np.sqrt(np.linspace(roll[0] ** 2, roll[-1] ** 2, FINER * STRIPS + 1))
    height = (np.arange(FINER * SLICES) + 0.5) / (FINER * SLICES) * 15.0
    one = np.ones((len(TEETH), 1, 1), dtype=int)
    true = wear.depth(Outline.of(PINION), TEETH[:, None, None] * one, one, 0.5 * (fine[1:] + fine[:-1]), height[:, None])
    true = true.reshape(len(TEETH), SLICES, FINER, STRIPS, FINER).mean(axis=(2, 4))
    return seen_map(PAIR[0], Side.LEFT, roll, true, random)


def seen_map(gear: Gear, side: Side, roll: Floats, true: Floats, random: np.random.Generator) -> WearMap:
    """A map of true depths (teeth, slices, strips), mm, with errors of what a scan of such flanks has."""
    count, slices, strips = true.shape
    middle = np.sqrt(0.5 * (roll[1:] ** 2 + roll[:-1] ** 2))
    places, rows = np.tile(middle, slices), np.repeat(np.arange(slices) * gear.face_width / slices, strips)
    texture = TEXTURE**2 * np.exp(-np.abs(places[:, None] - places) / 1.5 - np.abs(rows[:, None] - rows) / 2.0)
    root = np.linalg.cholesky(texture + 1e-16 * np.eye(len(places)))
    error = np.array([root @ random.normal(size=len(places)) + NOISE * random.normal(size=len(places)) for _ in range(count)])
    return WearMap(
        gear=gear,
        side=side,
        teeth=np.arange(count),
        roll_edges=roll,
        slices=slices,
        depth=true + error.reshape(true.shape),
        seen=np.ones((slices, strips), dtype=bool),
        errors=(texture + NOISE**2 * np.eye(len(places))) / count,
    )


def runs_on(place: WearMap, load: float, single: float) -> Runs:
    """Runs under a load, N/mm, up to somewhat more than a loss by single contact, mm."""
    return Runs(place, PAIR[1], CENTRE, load, Material(), REACH * single / load)


@cache
def shared_runs() -> Runs:
    """Runs under `LOAD` that all tests share: each is made once."""
    return runs_on(map_of(RanWear(single_um=SINGLE_UM, load=LOAD)), LOAD, 1e-3 * SINGLE_UM)


def traced(wear: RanWear, seed: int = 0) -> SecondLoop:
    """How a pair that ran so, under `LOAD` and up to `SINGLE_UM`, is said to have run."""
    return on_map(map_of(wear, seed))


def on_map(place: WearMap) -> SecondLoop:
    """The search on a map."""
    return find_running(place, *law_basis_and_alone(place, replace(shared_runs(), map=place)))


def law_basis_and_alone(place: WearMap, runs: Runs) -> tuple[Floats, Runs, Bools]:
    """What the search takes beside the map: the law there, the runs, and where one pair carries alone."""
    low, high = path_of_contact(*PAIR, CENTRE).single_contact_pinion
    return law_basis(place, PAIR[1], CENTRE, LoadSharing.NONE), runs, (place.roll > low) & (place.roll < high)
