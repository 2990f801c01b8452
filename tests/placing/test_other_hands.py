"""Scans of helical, double helical and internal gears given with a design of another hand or kind: refused by name."""

import numpy as np
import pytest

from gearwear.comparison.which_gear import placed_as
from gearwear.design import parse_design
from gearwear.errors import NotThisGear
from gearwear.placing.refusal import runs_otherwise
from gearwear.scan.types import Scan
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.helical import Helical
from tests.synthetic.helical import scan as helical_scan
from tests.synthetic.ring import Ring, ring_scan

ONE = Helical(teeth=23, module=2.5, helix=20.0, width=14.0, shift=0.1)
TWO = Double(Helical(teeth=17, helix=24.0, width=11.0), gap=5.0)
INTERNAL = Ring(teeth=60, module=2.0, helix=12.0, rim=70.0, shift=0.0)


def design(helix: float, width: float, gear, **more):
    given = {"teeth": gear.teeth, "module": gear.module, "profile_shift": gear.shift, "addendum": gear.addendum}
    return parse_design({"gear": {**given, "helix_angle": helix, "face_width": width, **more}})


MAKE = {Helical: helical_scan, Double: double_scan, Ring: ring_scan}
CASES = {
    "hands cross by more than a pitch": (ONE, design(-20.0, 14.0, ONE), "teeth of the scan are helical, right hand, and"),
    "a ring of the other hand": (
        INTERNAL,
        design(-12.0, 14.0, INTERNAL, internal=True),
        "teeth of the scan are helical, right hand, and",
    ),
    "double helical, one helix drawn": (TWO, design(24.0, TWO.width, TWO.lower), "double helical"),
    "one half": (
        TWO.lower,
        design(24.0, TWO.width, TWO.lower, gap=TWO.gap),
        "right hand over the whole face, as those of one half",
    ),
}


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.long] * ("ring" in name)) for name in CASES])
def test_it_is_refused_by_name(name):
    gear, drawn, words = CASES[name]
    points = MAKE[type(gear)](gear, 12_000, seed=1).points
    view = np.zeros(len(points), dtype=np.int64)
    scan = Scan(points, None, None, "cloud", ("scan.xyz",), {}, view)
    with pytest.raises(NotThisGear) as refused:
        placed_as(drawn, [scan], ["gear"])
    assert words in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("gear", "drawn"),
    [
        (ONE, design(20.0, 14.0, ONE)),
        (INTERNAL, design(12.0, 14.0, INTERNAL, internal=True)),
        (TWO, design(24.0, TWO.width, TWO.lower, gap=TWO.gap)),
    ],
    ids=["helical", "ring", "double helical"],
)
def test_normals_of_the_gear_that_was_drawn_say_nothing(gear, drawn):
    cloud = MAKE[type(gear)](gear, 30_000, noise=0.02, seed=2)
    placed = (cloud.points - cloud.translation) @ cloud.rotation
    assert runs_otherwise(placed, drawn.gears["gear"]) == ""
    placed[:, 2] = (
        drawn.gears["gear"].face_width - placed[:, 2]
    )  # a mirror image has the other hand; of two halves it is the same gear
    assert bool(runs_otherwise(placed, drawn.gears["gear"])) is not isinstance(gear, Double)
