"""A real ground pinion, seen thinly: every flank has its values, near those of the commercial evaluation of the same cloud."""

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from gearwear.comparison.closing import measure
from gearwear.design.files.toml import read_design

ROOT = Path(__file__).parents[2]
FOLDER = ROOT.parent / "shared" / "real" / "dental"


@pytest.mark.shared
@pytest.mark.skipif(not FOLDER.is_dir(), reason="the dental clouds are not here")
def test_a_real_pinion_beside_its_commercial_evaluation(monkeypatch):
    """One part: medians within the stated reach of an evaluation with other software; pitch and runout about its axis."""
    spec = importlib.util.spec_from_file_location("dental", ROOT / "benchmarks" / "dental.py")
    dental = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "dental", dental)  # its dataclasses look it up
    spec.loader.exec_module(dental)
    measured = measure(read_design(FOLDER / "z13.toml"), [FOLDER / "kw_001.xyz"], loop=False)
    assert min(dental.seen(dental.inspect(measured.flanks, measured.gear)).values()) == 1.0
    part = dental.compared(measured, "kw_001", json.loads((FOLDER / "kw_001.reany.json").read_text()))
    for key, limit in (("fHa", 0.8), ("ffa", 1.2), ("fHb", 0.5)):
        assert np.abs(np.nanmedian(part.ours[key] - part.theirs[key], axis=0)).max() < limit
    off = np.subtract(part.round_it["their axis"], part.round_it["theirs"])
    assert np.abs(off).max() < 1.5
