"""A pit that no section shows may lie where thickness is measured: how thin the tooth is then, by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.comparison.thick import _pit_bottom
from tests.report.fake import fake_results, fake_thickness

TURN = 1.07
"""Arc per depth."""
THICK = replace(fake_thickness({}), turn=TURN)
REGIONS = fake_results().wear.found.regions
"""Of teeth 2, 1 and 3, 1550, 200 and 120 µm deep."""


@pytest.mark.parametrize(("teeth", "depth"), [((), -math.inf), ((2,), 0.12), ((0, 2), 0.2), ((5,), 0.0)])
def test_the_deepest_pits_of_both_flanks_may_meet(teeth, depth):
    wear, pits = fake_results().wear.found, np.isin(np.arange(12), teeth)
    assert _pit_bottom(THICK, wear, pits) == pytest.approx(THICK.nominal - TURN * depth)
    both = replace(wear, regions=(*REGIONS, *(replace(region, side=region.side.opposite) for region in REGIONS)))
    assert _pit_bottom(THICK, both, pits) == pytest.approx(THICK.nominal - 2.0 * TURN * depth)


def test_sections_that_were_pooled_do_not_tell_that_none_lies_there():
    for pooled, low in ((5, 9.5), (1, THICK.thinnest().low)):
        thickness = replace(THICK, pooled=pooled, pit_bottom=9.5)
        assert thickness.thinnest().low == pytest.approx(low, abs=0.01)
        assert thickness.thinnest().value == pytest.approx(THICK.thinnest().value, abs=0.01)
