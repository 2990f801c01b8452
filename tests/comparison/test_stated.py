"""What ``[datum]`` asks for: lengths at 20 °C, and surfaces, teeth and heights left out."""

import numpy as np
import pytest

from gearwear.comparison.measured_gear import register
from gearwear.design.files.toml import parse_design
from gearwear.design.surface import FLANK, TIP
from gearwear.errors import InputError
from gearwear.scan.reading import read_scan
from tests.commands.doors import scan_file
from tests.synthetic import Recipe

GEAR = {"teeth": 12, "module": 6.35, "face_width": 15.0}


def design(**datum):
    return parse_design({"pinion": GEAR, "gear": {"teeth": 24}, **({"datum": datum} if datum else {})}, "test")


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    files, _ = scan_file(tmp_path_factory.mktemp("stated"), "plain", Recipe(jitter=1.0, noise_um=3.0).of_size(20_000), 3)
    return read_scan(files)[0]


def test_a_warm_part_is_measured_as_at_20_degrees(scan):
    """Every coordinate times 1 + α ΔT put in; the same deviations come back, but for rounding."""
    from dataclasses import replace

    warm = replace(scan, points=scan.points * (1.0 + 23e-6 * 35.0))
    cold, stated = register(design(), scan), register(design(temperature_C=55.0, material="aluminium"), warm)
    np.testing.assert_allclose(stated.located.deviation, cold.located.deviation, atol=1e-7)
    assert any("55 °C to 20 °C with 23 ppm/K: −804 ppm" in note for note in stated.notes)
    # Left uncorrected the flanks' middles would lie 35 · 23e-6 · r off at the tip: 36 µm.
    raw = register(design(), warm)
    tip = raw.located.surface == TIP
    assert np.median(raw.located.deviation[tip]) - np.median(cold.located.deviation[cold.located.surface == TIP]) > 0.02


def test_what_is_left_out_is_gone_and_counted(scan):
    whole = register(design(), scan)
    less = register(design(ignore=["tip"], ignore_teeth=[3], ignore_z_mm=[[0.0, 2.0]]), scan)
    located = less.located
    assert not (located.surface == TIP).any()
    assert not ((located.tooth == 2) & (located.surface == FLANK)).any()
    assert located.measured[located.surface == FLANK][:, 2].min() > 1.9
    assert less.rejected["ignored"] == len(scan) - len(less.scans[0])
    assert not less.broken  # the tooth that is left out is not missing
    assert "left out as the design asks: tip; tooth 3; z 0 … 2 mm" in less.notes
    # The pose rests on fewer points, within what they scatter: a few µm of 3 µm noise.
    motion = less.pose.then(whole.pose.inverse())
    assert np.abs(motion.translation[:2]).max() < 0.01


@pytest.mark.parametrize(
    ("datum", "said"),
    [
        ({"ignore": ["hub"]}, "ignore = 'hub': one of"),
        ({"ignore": "tip"}, "a list of surfaces"),
        ({"ignore": ["flank"]}, "nothing would be left"),
        ({"ignore_teeth": [0]}, "teeth counted from 1"),
        ({"ignore_z_mm": [0.0, 1.0]}, "bands from z to z"),
        ({"ignore_z_mm": [[3.0, 1.0]]}, "from the lower z"),
        ({"ignore_z_mm": [[0.0, 10**400]]}, "bands from z to z"),
        ({"temperature_C": 900.0}, "temperature_C"),
        ({"material": "steel"}, "needs temperature_C"),
        ({"temperature_C": 25.0, "material": "stele"}, "steel"),
        ({"temperature_C": 25.0, "material": "steel", "expansion_ppm_K": 12.0}, "material"),
    ],
)
def test_what_cannot_be_asked_for_is_refused(datum, said):
    with pytest.raises(InputError, match=said):
        design(**datum)


def test_a_tooth_that_is_not_there_cannot_be_left_out(scan):
    with pytest.raises(InputError, match="teeth from 1 to 12"):
        register(design(ignore_teeth=[13]), scan)
