"""What a design says of its scanner: where no table turned the gear, and no views were put together, nothing of theirs explains a scan."""

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.contact_readings import ReadOtherwise
from gearwear.comparison.notes import wave_order
from gearwear.comparison.stations import compare
from gearwear.design.scan_spec import ScannerSpec
from gearwear.diagnose.effects import named_effects
from tests.commands.doors import PAIR, scan_file
from tests.synthetic import Effect, Recipe

OF_TABLE = {"turntable_angle", "scan_drift", "axis_offset_radial", "axis_offset_lateral", "incidence_bias", "lens_distortion"}
"""What errs with the table, or with a beam that looks along its radius."""
NEITHER = ScannerSpec(turntable=False, stitched=False)
WAVE = 15.0 * np.sin(2.0 * np.pi * 2.0 * np.arange(12) / 12.0 + 0.4) + 4.0 * np.sin(np.arange(12) ** 2)
"""µm: pitch errors of teeth, most of it twice a revolution, as a table may err too."""


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """A gear cut with pitch errors, with nothing stated and with neither table nor views."""
    recipe = Recipe(jitter=1.0, noise_um=6.0, effects=(Effect("pitch", {"index_um": tuple(WAVE)}),)).of_size(40_000)
    files, _ = scan_file(tmp_path_factory.mktemp("stated"), "pitch", recipe, 5)
    design = gw.read_design(PAIR)
    return [compare(replace(design, scanner=scanner), files, inspection=False) for scanner in (ScannerSpec(), NEITHER)]


def test_what_a_table_may_have_done_is_open_until_it_is_said_that_there_was_none(told):
    unsaid, said = told
    assert any(OF_TABLE & {effect.name, *effect.alternatives} for effect in unsaid.effects)
    assert any("[scanner] turntable = false" in note for note in unsaid.notes)
    assert "pitch" in {effect.name for effect in said.effects}
    assert not any((OF_TABLE | {"view_registration"}) & {effect.name, *effect.alternatives} for effect in said.effects)
    assert not any("[scanner]" in note for note in said.notes)
    assert "as the design says, no table turned the gear and no file was put together from views" in " ".join(said.notes)
    assert "as the design says" not in " ".join(unsaid.notes)


def test_pitch_errors_that_cannot_be_the_tables_leave_nothing_of_the_contact_open(told):
    """What the flanks have is in mesh, whole: the wave that was cut, to a tooth or two in contact."""
    unsaid, said = (results.pair for results in told)
    assert unsaid.limits is not None and ReadOtherwise.EITHER in unsaid.limits.why
    assert said.limits is None or ReadOtherwise.EITHER not in said.limits.why
    assert said.contact.peak_to_peak_um == pytest.approx(float(np.ptp(WAVE)), rel=0.25)


def test_pitch_errors_that_wave_as_a_table_errs_are_said_to_where_there_is_none(told):
    unsaid, said = told
    assert any("2 waves round the gear" in note for note in said.notes)
    assert not any("waves round the gear" in note for note in unsaid.notes)


@pytest.mark.parametrize("teeth", [12, 13, 40])
def test_a_wave_is_told_from_chance_and_from_a_gear_cut_off_its_centre(teeth):
    """Of 2000 gears with white pitch errors at most some 2 wave, and an eccentric one does not; one of twice the scatter of the rest does, one tooth unknown."""
    random, angle = np.random.default_rng(3), 2.0 * np.pi * np.arange(teeth) / teeth
    assert sum(wave_order(random.normal(size=teeth)) is not None for _ in range(2000)) <= 8
    assert wave_order(20.0 * np.cos(angle) + random.normal(size=teeth)) is None
    wave = 20.0 * np.cos(3.0 * angle + 0.5) + random.normal(size=teeth)
    assert wave_order(wave) == 3
    if teeth > 20:
        wave[4] = np.nan
        assert wave_order(wave) == 3
    assert wave_order(np.full(teeth, np.nan)) is None and wave_order(np.zeros(teeth)) is None


@pytest.mark.parametrize(
    ("stated", "gone"), [({"turntable": False}, OF_TABLE), ({"stitched": False}, {"view_registration"}), ({}, set())]
)
def test_each_line_leaves_out_what_hangs_on_it_and_nothing_else(told, stated, gone):
    context = told[0].measured.context
    out = {
        name
        for name, effect in named_effects().items()
        if effect.applies(context) and not effect.applies(replace(context, **stated))
    }
    assert out == gone
