"""Worn regions: none on unworn gears, and the volume of what was taken away."""

from functools import cache

import numpy as np
import pytest
from scipy import ndimage
from scipy.stats import binom, chi2

from gearwear.design.side import sides_of
from gearwear.placing.registration import register
from gearwear.wear.places import hollowed_sides
from gearwear.wear.regions import Wear, find_wear
from tests.placing.placing import binned, designed, refined
from tests.synthetic import Effect, GearNumbers, Hole, Patch, Recipe, SlidingWear, SyntheticScan, Texture, make_scan

GEAR = designed()
PLAIN = Recipe(jitter=1.0)


def wear_of(scan: SyntheticScan, gear=GEAR) -> Wear:
    """Found from the true pose on, so that teeth keep their numbers."""
    registration = refined(scan, gear)
    return find_wear(binned(scan.points, gear, registration), registration.noise, sides_of(registration.datum.worn_side))


@cache
def worn(points: int, seed: int, *wear, **recipe) -> tuple[SyntheticScan, Wear]:
    scan = make_scan(Recipe(jitter=1.0, wear=wear, **recipe).of_size(points), seed)
    return scan, wear_of(scan)


class TestUnworn:
    SCANS = 20

    @pytest.mark.long
    @pytest.mark.parametrize(
        "recipe",
        [
            Recipe(),
            Recipe(jitter=1.0, outliers=0.001, lost=0.02),
            Recipe(jitter=1.0, texture=Texture(6.0, 2.0)),
            Recipe(jitter=1.0, texture=Texture(8.0, 3.0, "exponential")),
        ],
        ids=["regular", "strays", "smooth texture", "rough texture"],
    )
    def test_no_region_on_95_scans_of_a_hundred(self, recipe):
        """Refused where so many regions would come up by chance on less than 1 series in 1,000, were the rate 5 %; at 35 % it is refused 9 times in 10."""
        alarms = sum(bool(wear_of(make_scan(recipe.of_size(10_000), 300 + seed)).regions) for seed in range(self.SCANS))
        assert alarms <= binom.ppf(0.999, self.SCANS, 0.05)

    def test_what_is_added_is_no_wear(self):
        """A coat and thicker teeth stand proud."""
        points = make_scan(Recipe(jitter=1.0, pose="none").of_size(20_000), 1)
        registration = refined(points, GEAR)
        cells = binned(points.points, GEAR, registration)
        proud = cells.with_deviation(cells.points.deviation + 0.02)
        assert find_wear(proud, registration.noise).regions == ()


LOW, HIGH = (37.0, 43.0), (2.0, 11.0)
PATCHES = {
    "raised cosine": Patch(3, 1, 400.0, LOW, HIGH),
    "flat, with edges of a millimetre": Patch(8, -1, 300.0, LOW, HIGH, 1.0),
    "over the end of the face": Patch(0, 1, 300.0, LOW, (-5.0, 5.0), 1.0),
    "over the tip": Patch(5, -1, 300.0, (40.0, 48.0), (3.0, 12.0), 1.5),
    "into the fillet": Patch(10, 1, 300.0, (34.0, 39.0), (3.0, 12.0), 1.0),
}


@pytest.fixture(scope="module")
def five() -> tuple[SyntheticScan, Wear]:
    """450,000 points, five teeth worn in five ways."""
    return worn(450_000, 1, *PATCHES.values(), outliers=0.0005, lost=0.02)


class TestVolume:
    def test_every_worn_flank_is_found_and_no_other(self, five):
        scan, wear = five
        assert {(r.tooth, r.side) for r in wear.regions} == {(f.tooth, f.side) for f in scan.truth.flanks}
        assert [r.volume for r in wear.regions] == sorted((r.volume for r in wear.regions), reverse=True)
        assert all(r.patches == 1 for r in wear.regions)

    @pytest.mark.parametrize("name", PATCHES)
    def test_volume_within_one_per_cent_and_three_standard_deviations(self, five, name):
        scan, wear = five
        patch = PATCHES[name]
        (truth,) = (f for f in scan.truth.flanks if (f.tooth, f.side) == (patch.tooth, patch.side))
        (found,) = (r for r in wear.regions if (r.tooth, r.side) == (patch.tooth, patch.side))
        assert found.volume == pytest.approx(truth.volume_mm3, rel=0.01)
        assert abs(found.volume - truth.volume_mm3) < 3.0 * found.volume_std
        assert found.volume_std < 0.01 * found.volume
        assert found.area * found.mean_depth == pytest.approx(found.volume, rel=0.05)  # the volume has its rim with it
        # The mean over a cell at a raised cosine's top is a little less deep; noise of cells of 15 points the other way.
        assert 0.96e-3 * truth.max_depth_um < found.max_depth < 1e-3 * truth.max_depth_um + 0.012

    def test_the_total_is_the_sum(self, five):
        scan, wear = five
        assert wear.volume == pytest.approx(sum(r.volume for r in wear.regions), rel=1e-12)
        assert wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.005)
        assert abs(wear.volume - scan.truth.volume_mm3) < 3.0 * wear.volume_std

    def test_the_centroid_is_where_the_metal_is_missing(self, five):
        """Of the raised cosine: at mid-height of its range, on the flank at mid-radius."""
        _, wear = five
        (found,) = (r for r in wear.regions if (r.tooth, r.side) == (3, 1))
        x, y, z = found.centroid
        assert z == pytest.approx(6.5, abs=0.05)
        assert np.hypot(x, y) == pytest.approx(40.0, abs=0.1)
        assert np.angle((x + 1j * y) / np.exp(0.5j * np.pi)) == pytest.approx(float(GEAR.half_angle(np.hypot(x, y))), abs=0.002)


def test_the_curvature_of_a_deep_loss_is_in_the_integral():
    """1.5 mm deep: the plain ∫ d dA is 2 % more than the metal, for the arc of an inward parallel is shorter (reference B1)."""
    patch = Patch(4, 1, 1500.0, LOW, HIGH)
    scan, wear = worn(60_000, 2, patch)
    (found,), (truth,) = wear.regions, scan.truth.flanks
    # Of the raised cosine, half of its ranges; dA = r dr / r_b dz, and the middle of the range is at r = 40.
    plain = 1.5 * 0.5 * (HIGH[1] - HIGH[0]) * 0.5 * (LOW[1] - LOW[0]) * 40.0 / GEAR.base_radius
    assert truth.volume_mm3 < 0.98 * plain
    assert found.volume == pytest.approx(truth.volume_mm3, rel=0.01)


class TestStandardDeviation:
    @pytest.mark.long
    def test_errors_are_within_what_is_stated_over_many_scans(self):
        """Three patches on each of 10 scans of 20,000 points: the sum of squares of the pulls, one-sided at 1 in 1,000."""
        patches = tuple(Patch(tooth, side, 150.0, (36.5, 43.0), (1.0, 14.0)) for tooth, side in ((0, 1), (5, -1), (9, 1)))
        pulls = []
        for seed in range(10):
            scan, wear = worn(20_000, 40 + seed, *patches)
            truth = {(f.tooth, f.side): f.volume_mm3 for f in scan.truth.flanks}
            assert {(r.tooth, r.side) for r in wear.regions} == set(truth)
            pulls += [(r.volume - truth[r.tooth, r.side]) / r.volume_std for r in wear.regions]
        assert (np.array(pulls) ** 2).sum() < chi2.ppf(0.999, len(pulls))
        # And no bias: their mean is zero within four of its standard deviations.
        assert abs(np.mean(pulls)) < 4.0 / np.sqrt(len(pulls))

    def test_texture_is_in_it(self):
        """6 µm of texture 2 mm long make a patch far less certain than the white noise alone."""
        patch = Patch(2, 1, 200.0, (36.5, 43.0), (1.0, 14.0))
        scan, plain = worn(30_000, 3, patch)
        other, textured = worn(30_000, 3, patch, texture=Texture(6.0, 2.0))
        assert textured.regions[0].volume_std > 1.5 * plain.regions[0].volume_std
        for made, found in ((scan, plain), (other, textured)):
            assert abs(found.regions[0].volume - made.truth.volume_mm3) < 3.0 * found.regions[0].volume_std


HOLES = {
    "over the deepest place": ("raised cosine", 40.0, 1.0, 0.03),
    "on a slope": ("raised cosine", 41.5, 1.0, 0.02),
    "in a flat": ("flat, with edges of a millimetre", 40.0, 1.5, 0.02),
}
"""Patch, foot radius and radius of the hole in mm, share of the volume that may be off."""


@pytest.mark.parametrize("name", HOLES)
def test_a_hole_in_the_scan_is_spanned_from_round_it(name):
    """What it may hide is in the standard deviation; the mean of its rim would be 4 % short over the deepest place."""
    what, radius, reach, share = HOLES[name]
    patch = PATCHES[what]
    scan, wear = worn(60_000, 5, patch, holes=(Hole(patch.tooth, patch.side, radius, 6.5, reach),))
    (found,) = wear.regions
    assert (~wear.side_maps.seen[patch.tooth, 0 if patch.side > 0 else 1, 4:-4, wear.side_maps.fillet : -1]).any()
    assert abs(found.volume - scan.truth.volume_mm3) < 3.0 * found.volume_std
    assert found.volume == pytest.approx(scan.truth.volume_mm3, rel=share)


def test_two_places_of_one_flank_are_one_region_of_two_pieces():
    wear = (Patch(6, 1, 250.0, (37.0, 43.0), (0.5, 5.5)), Patch(6, 1, 250.0, (37.0, 43.0), (9.5, 14.5)))
    scan, found = worn(60_000, 6, *wear)
    (region,) = found.regions
    assert region.patches == 2
    assert region.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)


@pytest.mark.long
def test_drive_flanks_worn_throughout_are_each_a_region():
    scan, found = worn(60_000, 7, SlidingWear(100.0, 1))
    assert {(r.tooth, r.side) for r in found.regions} == {(tooth, 1) for tooth in range(12)}
    assert found.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)


@pytest.mark.long
def test_wear_near_the_noise_is_not_seen_and_well_above_it_is():
    """A plateau of 5 × 7 mm: of a fifth of the limit it hides, of three times the limit it shows."""
    _, unworn = worn(30_000, 8)
    for share, regions in ((0.2, 0), (3.0, 1)):
        patch = Patch(7, -1, 1e3 * share * unworn.limit, (37.0, 43.0), (3.0, 12.0), 0.5)
        assert len(worn(30_000, 8, patch)[1].regions) == regions


@pytest.mark.parametrize(("depth", "regions"), [(0.0, 0), (150.0, 1), pytest.param(600.0, 1, marks=pytest.mark.long)])
def test_a_hollow_stands_out_of_flanks_that_stand_at_levels_of_their_own(depth, regions):
    """Index and thickness of each tooth scatter by 25 µm: as much over all of a flank as the hollow has volume."""
    random = np.random.default_rng(3)
    levels = [
        Effect(what, {name: tuple(random.normal(0.0, 25.0, 12))})
        for what, name in (("pitch", "index_um"), ("thickness_variation", "thickness_um"))
    ]
    patch = Patch(1, 1, depth, (36.1, 44.6), (-4.0, 10.0))
    recipe = Recipe(jitter=1.0, wear=(patch,) * regions, effects=tuple(levels), texture=Texture(2.0, 1.0))
    scan = make_scan(recipe.of_size(60_000), 3)
    found = wear_of(scan)
    assert {(r.tooth, r.side) for r in found.regions} == {(1, 1)} if regions else not found.regions
    assert abs(found.volume - scan.truth.volume_mm3) <= 3.0 * found.volume_std


def test_by_chance_no_flank_is_hollow():
    """Of 24,000 flanks of 12 teeth, at levels that scatter five times as much as their cells do, some 10⁻⁴; 12 would be half a per thousand."""
    random, hollow = np.random.default_rng(0), 0
    for _ in range(1_000):
        cells = ndimage.uniform_filter(random.normal(size=(12, 2, 12, 16)), (1, 1, 3, 3))
        hollow += int(hollowed_sides(cells + random.normal(0.0, 5.0, (12, 2, 1, 1))).sum())
    assert hollow < 12


def test_a_hollow_is_told_whatever_other_flanks_have():
    """One of thirty times the scatter of its cells, beside eight flanks that are deeper still, and one that nobody saw."""
    cells = ndimage.uniform_filter(np.random.default_rng(1).normal(size=(12, 2, 12, 16)), (1, 1, 3, 3))
    cells[:8, 0, 4:8, 4:8] -= 20.0
    cells[9, 1, 2:4, 2:4] -= 10.0
    cells[11, 1] = np.nan
    expected = np.zeros((12, 2), dtype=bool)
    expected[:8, 0] = expected[9, 1] = True
    np.testing.assert_array_equal(hollowed_sides(cells), expected)
    assert not hollowed_sides(cells[:2]).any()  # of four sides nothing is usual


@pytest.mark.long
@pytest.mark.parametrize(
    "numbers",
    [pytest.param(GearNumbers(24), marks=pytest.mark.long), GearNumbers(23, 2.0, 18.0, 25.0, 0.4, rack_tip_radius=0.2)],
    ids=["24 teeth", "shifted, 25°"],
)
def test_other_gears_registered_from_nothing(numbers):
    """From the cloud alone, whatever tooth it then is."""
    gear = designed(numbers)
    low, high = gear.form_radius + 0.25 * numbers.module, gear.tip_radius - 0.25 * numbers.module
    patch = Patch(5, 1, 60.0 * numbers.module, (low, high), (3.0, numbers.face_width - 3.0))
    scan = make_scan(Recipe(numbers, pose="any", jitter=1.0, noise_um=5.0, wear=(patch,)).of_size(60_000), 4)
    registration = register(scan.points, gear)
    wear = find_wear(binned(scan.points, gear, registration), registration.noise, sides_of(registration.datum.worn_side))
    (found,) = wear.regions
    assert found.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    assert abs(found.volume - scan.truth.volume_mm3) < 3.0 * found.volume_std
