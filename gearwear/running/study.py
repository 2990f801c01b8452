"""The second loop on a finished wear study: what is needed for it, and why not where it cannot be asked."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.twist import Toothing, refuse
from gearwear.diagnose.found import Loop
from gearwear.errors import InputError
from gearwear.loaded.steel import Material
from gearwear.meshing.path import path_of_contact
from gearwear.placing.cells import Cells
from gearwear.running.conditions import Runs, over_common_face
from gearwear.running.found import SecondLoop
from gearwear.running.other_side import on_the_other_side
from gearwear.running.search import find_running
from gearwear.running.wear_map import WearMap, wear_map
from gearwear.wear_law.archard import LoadSharing, law_over
from gearwear.wear_law.study import WearStudy

REACH = 1.5
"""Amount of wear up to which is run, as a multiple of what single contact says."""
DEEPEST = 0.15
"""mm of mean depth beyond which no run is made: the sliding of unworn flanks no longer holds."""


def trace_running(
    study: WearStudy,
    cells: Cells,
    mate: Gear,
    centre_distance: float,
    load_per_width: float,
    material: Material,
    loop: Loop | None,
    noise: float,
    other: WearStudy | None = None,
    misalignment: float = 0.0,
) -> SecondLoop | str:
    """Trace the wear of one side to how the pair ran.

    Parameters
    ----------
    study : WearStudy
        The wear law on that side.
    cells : Cells
        Deviation from the as-made gear.
    mate : Gear
    centre_distance : float
        mm.
    load_per_width : float
        Transverse force on all pairs per face width, N/mm.
    material : Material
    loop : Loop or None
        Where the as-made gear comes from.
    noise : float
        Scatter of points, mm.
    other : WearStudy or None
        The wear law on the other side; None where that is not worn.
    misalignment : float
        That the design states, mm; + opens towards z = b on the pinion's left flanks, and on left flanks of the gear.

    Returns
    -------
    SecondLoop or str
        What was found, or why it was not looked for.
    """
    fit, gear = study.best, cells.grid.gear
    if fit is None:
        return study.why_not or "the wear law was not fitted"
    if not load_per_width > 0.0:
        return "the load is 0: no wear comes of it"
    path = path_of_contact(gear, mate, centre_distance)
    try:
        for body in (gear, mate):
            refuse(body, "wear that runs", Toothing.INTERNAL, Toothing.DOUBLE_HELICAL)
        amount = fit.amount
        if not amount > 0.0:
            return "no sliding wear is seen that a run could begin with"
        place = wear_map(cells, study.side, np.array(study.teeth), path, loop, noise)
        if float(place.mean.max()) > DEEPEST:
            return f"wear is {1e3 * float(place.mean.max()):.0f} µm deep: beyond {1e3 * DEEPEST:.0f} µm the sliding of unworn flanks no longer holds"
        runs = Runs(
            place, mate, centre_distance, load_per_width, material, REACH * amount / load_per_width, study.side * misalignment
        )
        low, high = path.alone_pinion or (math.inf, math.inf)
        alone = (place.roll > low) & (place.roll < high)
        traced = find_running(place, law_basis(place, mate, centre_distance, fit.sharing), runs, alone)
    except InputError as error:
        return str(error)
    return replace(traced, effects=(*traced.effects, *on_the_other_side(fit, None if other is None else other.best)))


def law_basis(place: WearMap, mate: Gear, centre_distance: float, sharing: LoadSharing) -> Floats:
    """The terms of the law at the places of a map, each the mean over its strip, (m, 3); nothing where there is no mate."""
    edges = np.column_stack([place.roll_edges[:-1], place.roll_edges[1:]])
    strips = law_over(place.gear, mate, centre_distance, edges, sharing)
    met = over_common_face(place, mate, 1)
    return np.asarray((met[..., None] * strips)[place.seen], dtype=np.float64)
