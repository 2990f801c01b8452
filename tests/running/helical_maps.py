"""Wear maps of helical pairs worn by another model of elastic teeth, with errors of a known covariance: no scan, and no part of the fit."""

from __future__ import annotations

import math

import numpy as np

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
from tests.running.maps import seen_map
from tests.synthetic.helical import Helical
from tests.synthetic.ran_helical import HelicalRan

STRIPS, SLICES, TEETH, FINER = 12, 6, 12, 4
MODULE, WIDTH = 2.5, 18.0
LOAD, AMOUNT_UM = 120.0, 12.0


def ran(beta: float = 20.0, **more: float) -> HelicalRan:
    one, two = (Helical(teeth=z, module=MODULE, helix=way * beta, width=WIDTH, shift=0.0) for z, way in ((17, 1), (31, -1)))
    return HelicalRan(one, two, **{"single_um": AMOUNT_UM, "load": LOAD, **more})


def gears(wear: HelicalRan) -> tuple[Gear, Gear]:
    one, two = (
        Gear.from_spec(GearSpec(name, g.teeth, g.module, g.width, helix_angle=math.radians(g.helix)))
        for name, g in (("pinion", wear.gear), ("gear", wear.mate))
    )
    return one, two


def map_of(wear: HelicalRan, seed: int = 0) -> WearMap:
    one, two = gears(wear)
    path = path_of_contact(one, two, one.reference_radius + two.reference_radius)
    low, high = max(one.form_roll + 0.2, path.start_pinion), min(one.tip_roll - 0.1, path.end_pinion)
    roll, fine = (np.sqrt(np.linspace(low**2, high**2, n + 1)) for n in (STRIPS, FINER * STRIPS))
    z = (np.arange(FINER * SLICES) + 0.5) / (FINER * SLICES) * WIDTH
    true = wear.depth(np.array(wear.side), 0.5 * (fine[1:] + fine[:-1]), z[:, None])
    true = true.reshape(SLICES, FINER, STRIPS, FINER).mean(axis=(1, 3))
    each = np.random.default_rng(seed)
    factors = each.normal(1.0, 0.05, (TEETH, 1, 1))
    return seen_map(one, Side(wear.side), roll, factors * true, each)


def runs_on(place: WearMap, wear: HelicalRan) -> Runs:
    one, two = gears(wear)
    return Runs(
        place, two, one.reference_radius + two.reference_radius, wear.load, Material(), REACH * 1e-3 * wear.single_um / wear.load
    )


def traced(wear: HelicalRan, seed: int = 0) -> SecondLoop:
    place = map_of(wear, seed)
    runs = runs_on(place, wear)
    basis = law_basis(place, runs.mate, runs.centre_distance, LoadSharing.LINES)
    return find_running(place, basis, runs, np.zeros(len(place.mean), dtype=bool))
