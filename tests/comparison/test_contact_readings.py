"""What the scan leaves open of the contact: limits by hand, and gears of which it is known what they do in mesh."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import gearwear as gw
from gearwear.comparison.contact_readings import (
    ContactNumbers,
    ContactReading,
    OtherReadings,
    ReadGear,
    ReadOtherwise,
    contact_limits,
    numbers_with,
    other_readings,
    ways_to_read,
)
from gearwear.comparison.contributions import flank_levels, pattern_fields, put_back, side_fields
from gearwear.comparison.notes import contact_note
from gearwear.comparison.open_sizes import size_limits
from gearwear.comparison.results import Results
from gearwear.comparison.stations import compare
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, locate
from gearwear.diagnose.parameter import ParameterEstimate
from gearwear.diagnose.pattern import Pattern
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.spread import ContactSpread
from gearwear.report.records.comparison import document
from gearwear.report.words.contact import SHORT
from gearwear.report.words.numbers import between
from gearwear.report.words.verdict import key_figures
from gearwear.wear.smooth import smooth_surface
from tests.commands.doors import PAIR, scan_file
from tests.meshing.test_contact_of_scans import true_profiles
from tests.report.fake import fake_effect
from tests.synthetic import WHEEL, Effect, Patch, Recipe
from tests.synthetic.make_example import RECIPE

SPREAD = ContactSpread(0.001, 0.002, 0.002, 0.002)
TOLD = ContactNumbers(0.010, 0.050, 0.040, 1.30)
THIN = Effect("tooth_thickness", {"thickness_um": -60.0})
OWN = 1.96 * np.array([0.001, 0.002, 0.002, 0.0])


def off(te=0.0, greatest=0.0, least=0.0, ratio=0.0) -> ContactNumbers:
    return ContactNumbers(*(TOLD.values + np.array([te, greatest, least, ratio])).tolist())


class TestLimits:
    def test_nothing_is_open_where_nothing_else_was_read(self):
        assert contact_limits(TOLD, OtherReadings(), SPREAD) is None

    @pytest.mark.parametrize("way", [off(), off(te=0.0019), off(greatest=-0.0039)])
    def test_nor_what_is_within_its_own_interval(self, way):
        assert contact_limits(TOLD, OtherReadings(((ReadOtherwise.PATTERN, (way,)),)), SPREAD) is None
        assert contact_limits(TOLD, OtherReadings((), (ContactReading(way, 0.0, ()),)), SPREAD) is None

    def test_what_may_be_so_or_not_adds_up(self):
        """TE 10 µm that a pattern takes to 14 or 7 and an effect to 15: 7 to 19, and 1.96 µm on either hand."""
        ways = (
            (ReadOtherwise.PATTERN, (off(te=0.004), off(te=-0.003, ratio=-0.1))),
            (ReadOtherwise.EITHER, (off(te=0.005, greatest=0.02),)),
        )
        limits = contact_limits(TOLD, OtherReadings(ways), SPREAD)
        np.testing.assert_allclose(limits.low.values, TOLD.values + np.array([-0.003, 0.0, 0.0, -0.1]) - OWN, rtol=1e-12)
        np.testing.assert_allclose(limits.high.values, TOLD.values + np.array([0.009, 0.02, 0.0, 0.0]) + OWN, rtol=1e-12)
        assert limits.why == (ReadOtherwise.PATTERN, ReadOtherwise.EITHER)

    def test_of_readings_with_other_sides_one_is_true(self):
        """One lies 30 µm above and is itself open by 5 µm, the other 20 µm below: each with its own level, 3 µm, in place of nothing."""
        above = ContactReading(off(greatest=0.03), 0.003, ((ReadOtherwise.PATTERN, (off(greatest=0.035),)),))
        limits = contact_limits(TOLD, OtherReadings((), (above, ContactReading(off(greatest=-0.02), 0.003, ()))), SPREAD)
        own = 1.96 * np.hypot(0.002, 0.003)
        assert limits.high.backlash_greatest == pytest.approx(0.050 + 0.035 + own, rel=1e-12)
        assert limits.low.backlash_greatest == pytest.approx(0.050 - 0.02 - own, rel=1e-12)
        assert limits.why == (ReadOtherwise.SIDES,)

    def test_no_transmission_error_is_below_none(self):
        """But teeth may leave no room."""
        limits = contact_limits(TOLD, OtherReadings(((ReadOtherwise.EITHER, (off(te=-0.01, greatest=-0.2, least=-0.2),)),)), None)
        assert limits.low.transmission_error == 0.0 and limits.low.backlash_greatest == pytest.approx(-0.15)


def test_a_flank_lies_where_most_of_it_does():
    """One place of five is a burr, one was not seen; of another flank nothing was."""
    heights = np.full((1, 2, 1, 7), np.nan)
    heights[0, 0, 0] = [9.0, 9.0, 1.0, 1.0, 5.0, np.nan, 1.0]  # two columns of the fillet
    assert flank_levels(heights, 2).tolist() == [[1.0, 0.0]]


def sized(value: float, std: float, order: float | None = None):
    """A turntable's wave, or a coat."""
    if order is None:
        return fake_effect("coating", {"thickness_um": ParameterEstimate(value, std, "um")})
    parameters = {
        "order": ParameterEstimate(order, 0.0, "1"),
        "amplitude_deg": ParameterEstimate(value, std, "deg"),
        "phase_deg": ParameterEstimate(5.0, 1.0, "deg"),
    }
    return fake_effect("turntable_angle", parameters)


def read(told, *others) -> dict[str, tuple[float, float]]:
    return size_limits(SimpleNamespace(others=tuple(SimpleNamespace(effects=tuple(one)) for one in others)), told)


class TestSizes:
    def test_a_size_reaches_to_what_it_is_with_other_sides(self):
        """8.1 ± 0.4 µm, and 18.0 ± 0.2 were the other side worn."""
        assert read(sized(8.1, 0.4), [sized(18.0, 0.2)])["thickness_um"] == pytest.approx((8.1 - 0.784, 18.392))

    def test_one_that_is_as_large_with_any_sides_is_not_open(self):
        assert read(sized(8.1, 0.4), [sized(8.5, 0.4)]) == {} == read(sized(8.1, 0.4))

    def test_one_that_is_not_found_with_others_may_be_none(self):
        assert read(sized(8.1, 0.4), [])["thickness_um"] == pytest.approx((0.0, 8.1 + 0.784))

    def test_a_wave_of_another_order_is_another(self):
        """No place is told so: an angle has no lowest."""
        limits = read(sized(0.02, 0.001, 2.0), [sized(0.05, 0.001, 1.0), sized(0.03, 0.001, 2.0)])
        assert limits == {"amplitude_deg": pytest.approx((0.01804, 0.03196))}
        assert read(sized(0.02, 0.001, 2.0), [sized(0.05, 0.001, 1.0)])["amplitude_deg"][0] == 0.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scans")


@pytest.fixture(scope="module")
def thin(folder) -> Results:
    """A gear with teeth 60 µm thinner than drawn, unworn."""
    recipe = Recipe(gear=WHEEL, jitter=1.0, effects=(THIN,))
    return compare(gw.read_design(PAIR), scan_file(folder, "thin", recipe.of_size(20_000))[0], "gear", inspection=False)


@pytest.mark.long
def test_thin_teeth_or_even_wear_is_the_same_backlash(thin):
    """It is open which, of the volume; s less arc on the operating circle is s more play in either case (ISO 21771-1:2024: what the spaces exceed the teeth by),
    so there is nothing open of it."""
    low, high, _ = thin.volume_range
    assert high - low > 200.0 and thin.pair.limits is None
    std = thin.pair.greatest_backlash_std.circumferential
    for play in (thin.pair.least_backlash, thin.pair.greatest_backlash):
        assert abs(play.circumferential - 0.060) < 3.0 * std < 0.003
    assert "range_from" not in document(thin, [])["meshing"]["worn"]


@pytest.mark.long
def test_wear_takes_no_play_from_thin_teeth(folder):
    """A patch that ends near the end of the face left the teeth there as thick as drawn, 60 µm thicker than made: 30 µm of play at the least, and 28 of TE."""
    recipe = Recipe(gear=WHEEL, jitter=1.0, effects=(THIN,), wear=(Patch(1, 1, 400.0, (74.0, 79.4), (1.0, 12.0)),))
    pair = compare(gw.read_design(PAIR), scan_file(folder, "patch", recipe.of_size(20_000))[0], "gear", inspection=False).pair
    assert pair.least_backlash.circumferential > 0.060 - 3.0 * pair.least_backlash_std.circumferential


@pytest.mark.long
class TestWays:
    def test_a_form_without_a_name_is_put_on_as_it_was_found(self, thin):
        measured = with_patterns(thin.measured, True)
        ((what, field),) = ways_to_read(measured, thin.wear.found)
        everywhere, beside = pattern_fields(measured)
        assert what is ReadOtherwise.PATTERN and not beside.any()
        np.testing.assert_array_equal(field, everywhere)
        cells = measured.loop.patterns[0].field
        np.testing.assert_array_equal(field, np.nan_to_num(measured.cells.grid.sides(cells)))

    def test_one_beside_worn_flanks_may_be_on_them_either_way(self, thin):
        measured = with_patterns(thin.measured, False)
        measured = replace(measured, loop=replace(measured.loop, worn_sides=frozenset({Side.LEFT})))
        (_, own), (_, up), (what, down) = ways_to_read(measured, thin.wear.found)
        assert what is ReadOtherwise.CARRIED
        np.testing.assert_array_equal(up[:, 0], own[:, 1])
        np.testing.assert_array_equal(down, -up)
        assert not up[:, 1].any()

    def test_what_takes_each_other_back_is_open_as_far_as_it_is_the_scanners(self, thin):
        """What is told of the maker is on the gear already."""
        (made,) = thin.loop.effects
        back = replace(made, evidence=replace(made.evidence, taken_back=True))
        assert ways_to_read(with_form(thin.measured, back), thin.wear.found) == []
        coat = replace(sized(25.0, 1.0), amplitudes=np.array([0.025]), evidence=back.evidence)
        ((what, field),) = ways_to_read(with_form(thin.measured, coat), thin.wear.found)
        assert what is ReadOtherwise.TOGETHER
        np.testing.assert_allclose(field[..., thin.measured.cells.grid.fillet :], 0.025, rtol=1e-12)

    def test_where_the_loop_leaves_nothing_open_nothing_is(self, thin):
        assert ways_to_read(thin.measured, thin.wear.found) == []


def smooth(measured, wear, scatter=None):
    loop = measured.loop
    noise = measured.noise if scatter is None else scatter
    return smooth_surface(wear, measured.cells.grid, noise, None if loop is None else loop.covariance).depth


@pytest.mark.long
@pytest.mark.parametrize("unworn_seen", [False, True], ids=["by the design", "by a scan before wear"])
def test_read_as_it_is_told_the_contact_is_what_is_told(folder, unworn_seen):
    """What is put on the flanks besides is put on those that were run: with a scan before wear they are counted from that."""
    patch = (Patch(1, 1, 400.0, (74.0, 79.4), (2.0, 10.0)),)
    recipe = Recipe(gear=WHEEL, jitter=1.0, effects=(THIN,), wear=patch).of_size(20_000)
    files = scan_file(folder, f"told {unworn_seen}", recipe)[0]
    before = scan_file(folder, "unworn", replace(recipe, wear=()), 3)[0] if unworn_seen else ()
    results = compare(gw.read_design(PAIR), files, "gear", before=before, inspection=False)
    measured, wear, pair = results.measured, results.wear.found, results.pair
    scatter = float(np.hypot(measured.noise, measured.noise))
    told = ReadGear(measured, wear, smooth(measured, wear, scatter if unworn_seen else None), unworn_seen)
    again = numbers_with(results.design, measured, told.sides(), 0.0, wear.drive_side, pair.design.path)
    np.testing.assert_allclose(again.values, ContactNumbers.of(pair.contact, pair.design.path).values, atol=1e-12)


def with_form(measured, effect):
    return replace(measured, loop=replace(measured.loop, form=(effect,)))


def with_patterns(measured, of_all):
    grid = measured.cells.grid
    field = np.random.default_rng(2).normal(0.0, 0.005, grid.count)
    pattern = Pattern(0 if of_all else 1, "waves", 0.0, 0.0, 0.005, 0.015, 1e-9, field)
    return replace(measured, loop=replace(measured.loop, patterns=(pattern,)))


@pytest.mark.long
def test_wear_is_counted_from_where_flanks_were_made(thin):
    """A flank that its tooth has 30 µm higher stands so in mesh: what is taken for made is on the gear."""
    measured, wear = thin.measured, thin.wear.found
    levels = np.zeros((measured.gear.teeth, 2))
    levels[3, 1] = 0.030
    sheets = wear.side_maps
    raised = replace(sheets, deviation=sheets.deviation - measured.cells.grid.sides(measured.cells.grid.on_flanks(levels)))
    before, after = (side_fields(measured, put_back(measured), found).made for found in (wear, replace(wear, side_maps=raised)))
    np.testing.assert_allclose(after - before, measured.cells.grid.sides(measured.cells.grid.on_flanks(levels)), atol=1e-12)


@pytest.mark.long
def test_the_limits_hold_what_flanks_do_that_stand_lower_than_their_fillets():
    """The bundled example with all left flanks 20 µm lower than their own fillets: worn or made so. TE and coat were told as 0.0 ± 0.5 and 8.1 ± 0.4 µm, for 13
    and 18: the TE is that of the flanks as they are, all lower alike."""
    design, low = gw.read_design(gw.example()), 0.020
    gear = design.gears["pinion"]
    pose = json.loads(gw.example("truth.json").read_text())["poses"][0]
    (scan,) = gw.read_scan(gw.example("scan.ply.gz"))
    points = (scan.points - pose["t"]) @ np.array(pose["R"])
    at = locate(points, gear)
    turned = np.where((at.surface == FLANK) & (at.side == 1), -low / gear.base_radius, 0.0)
    x, y, z = points.T
    points = np.column_stack([np.cos(turned) * x - np.sin(turned) * y, np.sin(turned) * x + np.cos(turned) * y, z])
    results = compare(design, [gw.as_scan(points)], inspection=False)
    true = true_profiles(RECIPE, gear)
    true.half_angle[:, 0, :, true.radius >= gear.form_radius] -= low / gear.base_radius
    mate = design.gears["gear"]
    flat = nominal_profiles(mate, np.linspace(mate.root_radius, mate.tip_radius, 200), np.array([7.5]))
    met = mesh_contact(true, flat, design.centre_distance, positions_per_pitch=34)
    assert results.loop.others, "it is open which sides are worn"
    limits = results.pair.limits
    assert limits.why[0] is ReadOtherwise.SIDES
    assert limits.low.transmission_error < 1e-3 * met.peak_to_peak_um < limits.high.transmission_error
    assert limits.low.backlash_greatest < met.backlash_max.value < limits.high.backlash_greatest
    (coat,) = (effect for effect in results.effects if effect.name == "coating")
    low_, high = results.open_sizes(coat)["thickness_um"]
    assert low_ < 18.0 < high
    thinnest = results.wear.thinnest
    assert thinnest.low < 9.660 - low * gear.arc_per_depth < thinnest.high, "9.660 mm with the flanks where they were"
    worn = document(results, [])["meshing"]["worn"]
    assert worn["range_from"].startswith(str(ReadOtherwise.SIDES))
    assert worn["transmission_error_um_low"] <= worn["transmission_error_um"] <= worn["transmission_error_um_high"]


@pytest.mark.long
def test_thin_teeth_that_may_be_a_scanners_have_no_more_play_than_drawn(thin):
    """Thinner by s in the scan alone: the play is s less on the operating circles (ISO 21771-1:2024), which are the reference circles here."""
    (effect,) = (one for one in thin.loop.effects if one.name == "tooth_thickness")
    measured = replace(thin.measured, loop=replace(thin.loop, effects=(effect.or_one_of(["coating"]),)))
    wear, pair = thin.wear.found, thin.pair
    read = other_readings(thin.design, ReadGear(measured, wear, smooth(measured, wear)), (), pair.design.path)
    limits = contact_limits(ContactNumbers.of(pair.contact, pair.design.path), read, pair.spread)
    assert limits.why == (ReadOtherwise.EITHER,)
    opened = replace(pair, limits=limits)
    size = 1e-3 * effect.parameters["thickness_um"].value
    own = 1.96 * pair.greatest_backlash_std.circumferential
    assert opened.open_greatest == pytest.approx(
        (pair.greatest_backlash.circumferential + size - own, pair.greatest_backlash.circumferential + own), abs=1e-4
    )
    # And where the interval is told a volume's way: in its place, with what it likeliest is and why beside it.
    shown = {figure.name: figure for figure in key_figures(replace(thin, pair=opened))}["Backlash, greatest"]
    assert shown.value.replace("\u202f", " ") == between(opened.open_greatest, 3, "mm").replace("\u202f", " ")
    assert SHORT[ReadOtherwise.EITHER] in shown.note and contact_note(opened)[0].endswith(str(ReadOtherwise.EITHER))
    assert contact_note(pair) == ()
