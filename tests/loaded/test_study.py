"""A pair under the load of its design file: what goes in by name, and what stands beside what."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.files.toml import parse_design
from gearwear.design.load import LoadSpec
from gearwear.design.pair import Design
from gearwear.design.profiles import nominal_profiles
from gearwear.errors import InputError
from gearwear.loaded.contact import loaded_contact, loaded_variants, pair_compliance
from gearwear.loaded.formulas import beam_on_ring
from gearwear.loaded.pair_compliance import PairCompliance
from gearwear.loaded.steel import Material
from gearwear.loaded.study import LoadedStudy, compliance_models, study_load
from gearwear.loaded.tooth_compliance import tooth_compliance

LOAD = {"torque_Nm": 53.7, "speed_rpm": 500.0, "misalignment_um": 20.0}
GEARS = {"pinion": {"teeth": 12, "module": 6.35, "face_width": 15.0}, "gear": {"teeth": 24}}


@pytest.fixture(scope="module")
def design() -> Design:
    return parse_design({**GEARS, "load": LOAD})


@pytest.fixture(scope="module")
def study(design) -> LoadedStudy:
    return study_load(design)


def test_the_load_of_the_design_file_is_the_load(design, study):
    rb = design.gears["pinion"].base_radius
    assert study.present.total == pytest.approx(53.7e3 / rb)
    assert study.present.misalignment == pytest.approx(0.020)
    assert study.mesh_frequency == pytest.approx(100.0)
    assert LoadSpec(load_per_width=53.7e3 / rb / 15.0).force(rb, 15.0) == pytest.approx(study.present.total)


def test_the_design_is_aligned_and_what_is_there_is_not(study):
    assert study.design.misalignment == 0.0 and study.design.face_load_factor == pytest.approx(1.0)
    assert study.present.face_load_factor > 1.5
    assert study.present.mean_lag > study.design.mean_lag  # a wedge is softer


def test_half_the_modulus_is_twice_the_load(pinion, wheel, elastic):
    """Everything is linear in F / E, but the logarithm of Hertz, which knows F / E alone too."""
    soft = pair_compliance(pinion, wheel, Material(103e3))
    half, twice = (
        loaded_contact(pinion, wheel, 114.3, 15.0 * w, one, slices=1, cycle="pitch")
        for w, one in ((100.0, soft), (200.0, elastic))
    )
    np.testing.assert_allclose(half.lag, twice.lag, rtol=1e-7)


def test_the_spread_of_the_models_holds_formulas_and_other_finite_elements(design):
    """Mean lag of the published pair: 8.89 by other finite elements, 8.70 µm by formulas on the same bores."""
    bores = {"pinion": {**GEARS["pinion"], "bore_diameter": 24.0}, "gear": {"teeth": 24, "bore_diameter": 40.0}}
    found = study_load(parse_design(bores), load=LoadSpec(load_per_width=100.0))
    for other in (8.89e-3, 8.70e-3):
        assert abs(found.design.mean_lag - other) < 2.0 * found.design_spread.std("mean_lag")
    assert found.design_spread.std("mean_lag") < 0.06 * found.design.mean_lag
    assert not any(found.spread.flanks.values())


def test_flanks_that_may_be_otherwise_widen_it(design):
    pinion, gear = (nominal_profiles(design.gears[name]) for name in ("pinion", "gear"))
    random = np.random.default_rng(5)
    drawn = []
    for _ in range(6):
        psi = pinion.half_angle.copy()
        psi[:, 0] -= random.normal(0.0, 0.004, (12, 1, 1)) / pinion.gear.base_radius
        drawn.append((replace(pinion, half_angle=psi), gear))
    found = study_load(design, (pinion, gear), LoadSpec(load_per_width=100.0), drawn=drawn)
    assert 0.001 < found.spread.flanks["transmission_error"] < 0.02
    assert found.spread.std("transmission_error") > found.spread.models["transmission_error"]


def test_variants_to_first_order_are_those_run_by_themselves(pinion, wheel, elastic):
    other = replace(pinion, half_angle=pinion.half_angle - 0.003 / pinion.gear.base_radius)
    _, (found,) = loaded_variants(pinion, wheel, 114.3, 1500.0, (elastic,), variants=[(other, wheel)], slices=1, cycle="pitch")
    alone = loaded_contact(other, wheel, 114.3, 1500.0, elastic, slices=1, cycle="pitch")
    assert np.abs(found.transmission_error - alone.transmission_error).max() < 0.01 * 0.003


def test_what_is_not_stated_is_said(design, study):
    assert sum("no bore_diameter is stated" in note for note in study.notes) == 2
    assert any("tip corners carry up to " in note for note in study.notes)


def test_what_cannot_be_done_is_named(design):
    single = parse_design({"gear": {"teeth": 24, "module": 2.0, "face_width": 10.0}})
    with pytest.raises(InputError, match=r"has one gear; load needs \[pinion\] and \[gear\]"):
        study_load(single, load=LoadSpec(torque=1.0))
    with pytest.raises(InputError, match=r"no load is stated; a table \[load\] with torque_Nm is needed"):
        study_load(parse_design(GEARS))
    with pytest.raises(InputError, match="both given"):
        LoadSpec(torque=1.0, load_per_width=1.0)
    for needed in ("misalignment", "elastic_modulus", "poisson"):
        with pytest.raises(InputError, match=f"{needed} = None: a number"):
            LoadSpec(torque=1.0, **{needed: None})


def test_it_is_offered_by_the_package(design, elastic):
    assert gw.study_load is study_load and gw.LoadSpec is LoadSpec
    formulas = tuple(beam_on_ring(one.gear, elastic.material, one.roll) for one in elastic.teeth)
    assert PairCompliance((formulas[0], formulas[1]), elastic.material, 0.0).scale == 1.0


def test_the_models_are_the_elements_in_strain_and_stress_both_couplings_that_fit_and_formulas():
    """Plane stress is softer by 1 / (1 − ν²); the coupling is 1.2 modules, and 1.0 to 1.4 fit as well."""
    pair = gw.read_design(gw.example())
    steel = Material(206_000.0, 0.25)
    teeth = tuple(tooth_compliance(gear, steel) for gear in pair.gears.values())
    models = compliance_models((teeth[0], teeth[1]), steel)
    assert [model.scale for model in models] == pytest.approx([1.0, 1.0 / (1.0 - 0.0625), 1.0, 1.0, 1.0])
    assert [model.coupling / 6.35 for model in models] == pytest.approx([1.2, 1.2, 1.0, 1.4, 1.2])
    assert [model.teeth[0] is teeth[0] for model in models] == [True, True, True, True, False]
