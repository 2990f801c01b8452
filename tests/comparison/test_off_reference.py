"""Gears of so much profile shift that the reference circle lies off the involute: thickness is measured where there is a flank."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.pair import Design
from gearwear.design.quantity import SPACE
from gearwear.report.words.verdict import key_figures
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch

BEYOND_TIP, BELOW_FORM = Helical(teeth=30, helix=0.0, shift=-1.05), Helical(teeth=40, helix=12.0, shift=1.2)


@pytest.mark.long
@pytest.mark.parametrize("numbers", [BEYOND_TIP, BELOW_FORM])
def test_a_gear_whose_reference_circle_has_no_flank_is_compared(numbers: Helical, tmp_path: Path, blank_figures: None):
    gear = designed(numbers)
    assert not gear.form_radius < gear.reference_radius < gear.flank_end_radius
    patch = Patch(3, 1, 0.1, (gear.form_roll + 0.2, gear.tip_roll - 0.2), (1.0, 13.0))
    np.savetxt(tmp_path / "scan.xyz", scan(numbers, 40_000, noise=0.005, seed=2, wear=(patch,)).points)
    results = gw.compare(Design({"gear": gear}), tmp_path / "scan.xyz")
    thickness = results.wear.thickness
    r = thickness.radius
    assert gear.form_radius < r < gear.flank_end_radius
    roll = np.sqrt(np.array([r**2 - numbers.base**2]))
    arc = 2.0 * r * float(numbers.flank_half(roll)[0])
    assert np.nanmedian(thickness.arc) == pytest.approx(arc, abs=0.002)
    lost = r / (numbers.base * numbers.base_cos) * float(patch.at(roll, np.array([7.0]))[0])
    assert results.wear.thickness.most_lost().value == pytest.approx(lost, abs=0.01)
    record = gw.write(results, tmp_path / "out")
    assert any("lies off the involute" in note for note in record["notes"])
    (said,) = (figure.note for figure in key_figures(results) if figure.name == "Thinnest tooth")
    assert f"at ⌀{SPACE}{2.0 * r:.2f}{SPACE}mm" in said
