"""A pair under load on page and terminal: the numbers said are those found."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

import gearwear as gw
from gearwear.design.load import LoadSpec
from gearwear.loaded.study import LoadedStudy, study_load
from gearwear.report import figures
from gearwear.report.files.meshing import lines
from gearwear.report.records.loaded import loaded_record
from gearwear.report.words.loaded import load_words, loaded_lines, loaded_rows
from gearwear.report.words.verdict import key_figures
from tests.report.fake import changed, real_results


@pytest.fixture(scope="module")
def study() -> LoadedStudy:
    load = LoadSpec(load_per_width=100.0, speed_rpm=600.0, misalignment=0.02)
    return study_load(gw.read_design(gw.example()), load=load)


def test_the_record_adds_up(study):
    record = loaded_record(study)
    assert record["torque_Nm"] == pytest.approx(1e-3 * 1500.0 * study.present.driver.base_radius)
    assert record["mesh_frequency_Hz"] == 120.0
    error = record["transmission_error_um"]
    assert error["value"] == pytest.approx(np.ptp(record["course"]["transmission_error_um"]))
    assert error["std"] == pytest.approx(np.hypot(error["std_models"], error["std_flanks"]))
    load = np.array(record["load_map"]["load_N_mm"])
    assert load.shape == (len(record["load_map"]["roll_edges_pinion_mm"]) - 1, len(record["load_map"]["z_mm"]))
    assert load[:, 0].max() > 1.5 * load[:, -1].max()  # the wedge opens towards the upper end


def test_words_name_load_and_misalignment(study):
    assert load_words(study).replace("\u202f", " ") == "53.7 N m on the pinion, 100 N/mm, misaligned by 20 µm over the face"
    rows = loaded_rows(study)
    assert all(len(row) == 3 for row in rows) and rows[1][0] == "the same, rigid, at the same positions"
    shown = lines(gw.study_meshing(gw.read_design(gw.example())), study)
    assert len(shown) <= 30 and all(len(text) <= 80 for text, _ in shown)
    assert [name for name, _ in loaded_lines(study)][:2] == ["transmission error", "mean lag"]


def test_the_key_figures_name_it(study):
    names = [figure.name for figure in key_figures(changed(real_results(), "pair.loaded", study))]
    assert names.index("The same under load") == names.index("Transmission error") + 1
    assert "The same under load" not in [figure.name for figure in key_figures(real_results())]


def test_figures_draw_what_was_found(study):
    above, beside, below = Figure().subplots(1, 3)
    lines_ = {line.get_label(): line for line in figures.loaded_transmission_error(above, study).lines}
    np.testing.assert_allclose(lines_["loaded"].get_ydata(), 1e3 * study.present.transmission_error)
    assert len(figures.mesh_spectrum(beside, study).patches) == 15
    assert figures.load_map(below, study) is below
