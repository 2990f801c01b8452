"""Both gears as measured: what one lost and what the other lost add up on the line of action."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.files.profiles import write_profiles
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.loaded.contact import POSITIONS
from gearwear.report.files.meshing import lines

LOSS = {"pinion": 0.03, "gear": 0.05}
Z = np.array([2.5, 7.5, 12.5])


@pytest.fixture(autouse=True)
def few_positions(monkeypatch: pytest.MonkeyPatch) -> None:
    """All here is alike from position to position, or compared position by position."""
    monkeypatch.setattr("gearwear.meshing.study.POSITIONS", 5)


@pytest.fixture(scope="module")
def pair() -> Design:
    return gw.read_design(gw.example())


def worn(pair: Design, part: str, loss: float, teeth: slice = slice(None), z: np.ndarray = Z) -> ToothProfiles:
    """A part with an even loss, mm, off its left flanks."""
    nominal = nominal_profiles(pair.gears[part], z=z)
    half_angle = nominal.half_angle.copy()
    half_angle[teeth, 0] -= loss / pair.gears[part].base_radius
    return replace(nominal, half_angle=half_angle)


def test_even_losses_of_both_gears_add_on_the_line_of_action(pair: Design):
    both = [worn(pair, part, loss) for part, loss in LOSS.items()]
    found = gw.study_meshing(pair, both)
    whole = sum(LOSS.values())
    assert found.contact.transmission_error_min.value == pytest.approx(-whole, abs=1e-9)
    assert found.contact.transmission_error_max.value == pytest.approx(-whole, abs=1e-9)
    assert found.greatest_backlash.normal - found.exact.backlash.normal == pytest.approx(whole, abs=1e-9)
    assert found.worn.part == "pinion" and found.worn_mate is not None and found.worn_mate.part == "gear"
    assert found.shafts is not None
    assert found.shafts.alike.thickness_loss == pytest.approx(found.worn.loss + found.worn_mate.loss, abs=1e-12)


def test_under_load_both_losses_shift_the_error_and_change_nothing_else(pair: Design):
    """An even loss turns a flank about its axis: with that of one position off the pinion, all comes one position later."""
    load, step = gw.LoadSpec(load_per_width=100.0), pair.gears["pinion"].base_pitch / POSITIONS
    both = gw.study_meshing(pair, [worn(pair, "pinion", step), worn(pair, "gear", LOSS["gear"])])
    found, new = (gw.study_load(pair, flanks, load, cycle="pitch").present for flanks in (both.flanks, None))
    assert found.transmission_error == pytest.approx(np.roll(new.transmission_error, 1) - step - LOSS["gear"], abs=1e-8)
    assert np.sort(found.load_share) == pytest.approx(np.sort(np.roll(new.load_share, 1, axis=0)), abs=1e-6)


def test_a_second_gear_that_is_as_designed_changes_nothing_and_the_order_does_not_matter(pair: Design):
    pinion, gear = worn(pair, "pinion", 0.04, slice(2, 4)), worn(pair, "gear", 0.0)
    alone, beside, turned = (gw.study_meshing(pair, one, cycle="driven") for one in (pinion, (pinion, gear), (gear, pinion)))
    for found in (beside, turned):
        assert found.contact.transmission_error == pytest.approx(alone.contact.transmission_error, abs=1e-9)
        assert found.drive_side is alone.drive_side


def test_the_gears_teeth_may_be_counted_from_any_of_them(pair: Design):
    """Numbers moved on by five, and told so: the same pair."""
    pinion, gear = worn(pair, "pinion", 0.03, slice(0, 1)), worn(pair, "gear", 0.05, slice(3, 5))
    renumbered = replace(gear, half_angle=np.roll(gear.half_angle, 5, axis=0))
    one, other = gw.study_meshing(pair, (pinion, gear)), gw.study_meshing(pair, (pinion, renumbered), mate_tooth=6)
    assert one.contact.transmission_error == pytest.approx(other.contact.transmission_error, abs=1e-12)
    apart = gw.study_meshing(pair, (pinion, renumbered))
    assert np.abs(apart.contact.transmission_error - one.contact.transmission_error).max() > 0.01
    loads = [
        gw.study_load(pair, found.flanks, gw.LoadSpec(load_per_width=100.0), cycle="pitch", start_tooth=found.mate_tooth)
        for found in (one, other)
    ]
    assert loads[0].present.transmission_error == pytest.approx(loads[1].present.transmission_error, abs=1e-9)


def test_what_two_scans_leave_open_is_said(pair: Design):
    both = (worn(pair, "pinion", 0.03), worn(pair, "gear", 0.05))
    said = " ".join(gw.study_meshing(pair, both).notes)
    assert "12 ways" in said and "other way up" not in said
    assert "12 ways" not in " ".join(gw.study_meshing(pair, both, mate_tooth=3).notes)
    flipped = replace(both[1], half_angle=both[1].half_angle[:, ::-1])
    assert "other way up" in " ".join(gw.study_meshing(pair, (both[0], flipped)).notes)


def test_contact_is_looked_for_in_the_finer_sections_of_the_two(pair: Design):
    """A dip of the gear between two coarse sections of the pinion carries less, and is not passed over."""
    fine = np.linspace(0.5, 14.5, 15)
    gear = worn(pair, "gear", 0.0, z=fine)
    half_angle = gear.half_angle.copy()
    half_angle[:, 0, :7] -= 0.05 / gear.gear.base_radius
    half_angle[:, 0, 8:] -= 0.05 / gear.gear.base_radius  # only the section at 7.5 mm stands proud
    pinion = worn(pair, "pinion", 0.03, z=np.array([1.0, 14.0]))
    found = gw.study_meshing(pair, (pinion, replace(gear, half_angle=half_angle)))
    assert found.contact.transmission_error_min.value == pytest.approx(-0.03, abs=1e-9)


@pytest.mark.parametrize("many", [2, 3])
def test_two_of_the_same_gear_are_refused(pair: Design, many: int):
    with pytest.raises(gw.InputError, match="is the pinion, and so is what was given before it"):
        gw.study_meshing(pair, [worn(pair, "pinion", 0.01 * i) for i in range(many)])


def test_a_tooth_that_the_gear_does_not_have_is_refused(pair: Design):
    with pytest.raises(gw.InputError, match="mate tooth 25: the gear has teeth from 1 to 24"):
        gw.study_meshing(pair, mate_tooth=25)


def test_files_of_both_and_what_is_told_of_them(pair: Design, tmp_path: Path):
    for part, loss in LOSS.items():
        write_profiles(tmp_path / f"{part}.npz", worn(pair, part, loss), part)
    study = gw.study_meshing(pair, [tmp_path / "pinion.npz", tmp_path / "gear.npz"], mate_tooth=2)
    told = gw.as_dict(study)
    assert (told["worn"]["part"], told["worn_mate"]["part"], told["worn_mate"]["mate_tooth"]) == ("pinion", "gear", 2)
    shown = [text for text, _ in lines(study)]
    assert any("pinion as measured" in text for text in shown) and any("gear as measured" in text for text in shown)
