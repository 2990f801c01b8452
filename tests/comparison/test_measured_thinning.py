"""A thinning that was measured on the gear itself: teeth cut so, or worn evenly. The range of the volume holds either, and nothing else changes."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.comparison.open_volume import OpenVolume
from gearwear.design import Gear, GearSpec, read_design
from gearwear.design.twist import normal_loss
from gearwear.report.words.verdict import key_figures, verdict
from tests.commands.doors import run, scan_file, strict_json
from tests.report.fake import changed, fake_results
from tests.synthetic import AbrasiveWear, GearNumbers, Recipe

THIN = 0.12
"""mm of arc at the reference circle."""


def plain(text):
    return text.replace("\u202f", " ").replace("\u00a0", " ")


def taken_for_thin(results, measured=True):
    """The results with a design that has `THIN`, and says where it comes from."""
    gear = replace(results.gear, spec=replace(results.gear.spec, thinning=THIN, thinning_measured=measured))
    return changed(results, "measured.root", replace(results.measured.root, gear=gear))


@pytest.mark.parametrize("helix", [0.0, 25.0])
def test_it_is_what_lies_between_two_gears_of_which_one_was_cut_thin(helix):
    """Every transverse section loses T / (r cos β) of arc at all radii: T / (r cos β) (r_a² − r_f²) / 2 a tooth, a sum that knows of no normal."""
    gear = Gear.from_spec(GearSpec("gear", 20, 2.0, 10.0, helix_angle=math.radians(helix)))
    between = 0.5 * THIN / gear.reference_radius / math.cos(gear.helix_angle) * (gear.tip_radius**2 - gear.form_radius**2)
    # A flank's area along the helix: ∫ L dL / r_b / cos β_b over the width.
    roll = math.sqrt(gear.tip_radius**2 - gear.base_radius**2), math.sqrt(gear.form_radius**2 - gear.base_radius**2)
    area = 0.5 * (roll[0] ** 2 - roll[1] ** 2) / gear.base_radius / gear.base_helix_cosine * gear.face_width
    assert normal_loss(gear, THIN) * area == pytest.approx(between * gear.face_width, rel=1e-12)


def opened(spec, faces=(), before=False):
    """By hand: 10 ± 0.5 mm³ on flanks of 400 mm² a side, whose level is known to 1 and 2 µm."""
    grid = SimpleNamespace(toothed=np.ones(10, dtype=bool), gear=SimpleNamespace(teeth=20))
    loop = SimpleNamespace(level_std=(0.001, 0.002), thinner_by=lambda flanks: 0.0, without_a_name=np.zeros(1))
    measured = SimpleNamespace(
        cells=SimpleNamespace(grid=grid), gear=Gear.from_spec(spec), loop=None, layered=np.zeros(20, bool), worn_sides=frozenset(), faces=faces
    )  # fmt: skip
    found = SimpleNamespace(
        volume=10.0, volume_std=0.5, regions=(), hidden_pits=0.0, unseen=0.0, level_open=(0.0, 0.0), faint=0.0, unsure=0.0,
        side_maps=SimpleNamespace(flank_row=2.0),
    )  # fmt: skip
    return OpenVolume(measured, found, (), before), replace_loop(measured, loop), found


def replace_loop(measured, loop):
    return SimpleNamespace(**{**vars(measured), "loop": loop})


SPEC = GearSpec("gear", 20, 2.0, 10.0, thinning=THIN, thinning_measured=True)


def test_the_range_reaches_to_the_loss_that_would_have_made_them_so_thin():
    open_, with_loop, found = opened(SPEC)
    even = THIN * math.cos(math.radians(20.0)) * 400.0
    low, high, why = open_.limits
    assert (low, high) == (pytest.approx(10.0 - 1.96 * 0.5, abs=1e-4), pytest.approx(10.0 + 1.96 * 0.5 + even, abs=1e-4))
    assert "measured" in why
    # How high the flanks stand is known to so much; depths are those of teeth so thin.
    assert OpenVolume(with_loop, found, ()).measured_thinning == pytest.approx(even + 1.96 * 0.003 * 400.0, abs=1e-3)
    assert open_.evenly == (0.0, 0.0) and open_.of_such_teeth is None


@pytest.mark.parametrize(
    ("spec", "how"),
    [
        (replace(SPEC, thinning_measured=False), {}),
        (replace(SPEC, thinning=-THIN), {}),
        (SPEC, {"before": True}),
        (SPEC, {"faces": (object(),)}),
    ],
)
def test_it_is_not_open_where_the_drawing_or_the_gear_itself_tells(spec, how):
    open_, _, _ = opened(spec, **how)
    assert open_.measured_thinning == 0.0 and open_.limits is None


def test_what_stands_out_keeps_its_own_place_in_the_words():
    known, thin = fake_results(), taken_for_thin(fake_results())
    said = plain(verdict(thin))
    assert said.startswith("90.80 ± 0.51 mm³ of metal is gone") and "worn evenly to that, it would be up to" in said
    assert thin.volume_range[1] > known.wear.volume + THIN * 0.9 * thin.open_volume._side_area
    assert plain(key_figures(thin)[0].value) == "90.80 ± 0.51 mm³"
    assert key_figures(thin)[1] == key_figures(known)[1]  # the deepest place is that of teeth so thin
    drawn = taken_for_thin(fake_results(), measured=False)
    assert verdict(drawn) == verdict(known) and drawn.volume_range == known.volume_range


def test_a_gear_on_which_nothing_stands_out_is_not_called_worn():
    results = fake_results()
    unworn = replace(results.wear.found, regions=(), volume=0.0, volume_std=0.0)
    said = plain(verdict(taken_for_thin(changed(results, "wear.found", unworn))))
    assert said.startswith(
        "No wear stands out, but the scan does not decide whether the teeth were cut as thin as they were measured or are worn evenly"
    )
    assert "the loss may be 0 to " in said


GEAR = GearNumbers(20, 3.0, 12.0, bore_diameter=24.0)
DEPTH = 0.06
"""On both flanks: of thickness 2 d r / r_b."""


def proposed(folder, gear, wear=(), which=("proposed", "drawn")):
    """What is told of a scan with the design that its own scan proposes, and with the same from a drawing; and what it has lost."""
    (file,), scan = scan_file(folder, "scan", Recipe(gear=gear, wear=wear, noise_um=5.0, jitter=1.0, pose="any").of_size(30_000))
    design = folder / "proposed.toml"
    assert run("design", file, "--out", design).status == 0
    text = design.read_text()
    assert read_design(design).gears["gear"].spec.thinning == pytest.approx(2.0 * DEPTH / math.cos(math.radians(20.0)), abs=0.01)
    drawn = folder / "drawn.toml"
    drawn.write_text("".join(line for line in text.splitlines(keepends=True) if not line.startswith("thinning_from")))
    told = []
    for toml in (design, drawn)[: len(which)]:
        assert run("compare", toml, file, "--out", folder / toml.stem, "--no-page", "--quiet").status == 0
        told.append(strict_json(folder / toml.stem / "report.json"))
    return (*told, scan.truth.volume_mm3)


@pytest.mark.long
def test_teeth_worn_evenly_are_within_the_range_of_what_their_own_scan_proposes(tmp_path):
    measured, drawn, lost = proposed(tmp_path, GEAR, (AbrasiveWear(1e3 * DEPTH),))
    told = measured["wear"]["volume_mm3"]
    assert told["low"] <= lost <= told["high"] < 1.5 * lost
    assert measured["design"]["thinning_from"] == "measured" and "thinning" in measured["notes"][0]
    # All but the range, its reason and the note are as with a drawing of such teeth, under which so much cannot have gone.
    assert told["value"] == drawn["wear"]["volume_mm3"]["value"] and told["std"] == drawn["wear"]["volume_mm3"]["std"]
    assert drawn["wear"]["volume_mm3"].get("high", 0.0) < 0.5 * lost
    assert measured["thickness"] == drawn["thickness"] and measured["closed_loop"] == drawn["closed_loop"]


@pytest.mark.long
def test_teeth_cut_thin_are_within_it_too(tmp_path):
    thin = 2.0 * DEPTH / math.cos(math.radians(20.0))
    measured, lost = proposed(tmp_path, replace(GEAR, thinning=thin), which=("proposed",))
    told = measured["wear"]["volume_mm3"]
    assert lost == 0.0 and told["value"] == 0.0 and told["low"] == 0.0 and not measured["wear"]["regions"]
