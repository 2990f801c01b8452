"""The worn solid: closed, of the volume that was integrated, and what comes back from its files."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from manifold3d import Error, Manifold, Mesh64

from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side, sides_of
from gearwear.errors import InputError
from gearwear.report.files.solids import write_3mf, write_stl
from gearwear.wear.profiles import ProfileNodes, without_added_metal, worn_profiles
from gearwear.wear.regions import Wear, find_wear
from gearwear.wear.smooth import smooth_surface
from gearwear.wear.solid import (
    ROOT_STEPS,
    TIP_STEPS,
    Triangles,
    gear_triangles,
    nominal_like,
    outlines,
    signed_difference,
    tooth_outlines,
    tooth_triangles,
    worn_bodies,
    worn_volume,
)  # fmt: skip
from tests.placing.placing import binned, designed, refined
from tests.synthetic import AbrasiveWear, Patch, Recipe, SyntheticScan, make_scan

GEAR = designed()
WEAR = {
    "inside": Patch(3, 1, 400.0, (37.0, 43.0), (2.0, 11.0)),
    "to the end of the face": Patch(0, -1, 300.0, (37.0, 43.0), (-5.0, 5.0), 1.5),
    "to the tip": Patch(6, 1, 300.0, (40.0, 48.0), (3.0, 12.0), 1.5),
    "the whole flank, fillet's edge and tip": AbrasiveWear(250.0, -1, (8,)),
    "deep": Patch(10, 1, 1500.0, (37.5, 48.0), (-9.0, 24.0), 2.0),
}


class Solid:
    """The way from a scan to its solids."""

    def __init__(self) -> None:
        self.scan: SyntheticScan = make_scan(Recipe(jitter=1.0, wear=tuple(WEAR.values())).of_size(60_000), 1)
        registration = refined(self.scan, GEAR)
        cells = binned(self.scan.points, GEAR, registration)
        self.wear: Wear = find_wear(cells, registration.noise, sides_of(registration.datum.worn_side))
        surface = smooth_surface(self.wear, cells.grid, registration.noise)
        profiles = worn_profiles(ProfileNodes.of(cells.grid), without_added_metal(surface.depth, self.wear.side_maps.area))
        self.profiles = profiles
        self.worn = gear_triangles(profiles)
        self.nominal = gear_triangles(nominal_like(profiles))
        self.bodies = worn_bodies(self.nominal, self.worn, self.wear.least_seen)


@pytest.fixture(scope="module")
def solid() -> Solid:
    return Solid()


def as_manifold(triangles: Triangles) -> Manifold:
    return Manifold(Mesh64(triangles.vertices, triangles.faces.astype(np.uint64)))


def assert_closed(triangles: Triangles) -> None:
    """Every edge runs once each way, and no triangle has a corner twice."""
    start, end = triangles.faces.ravel(), np.roll(triangles.faces, -1, axis=1).ravel()
    count = len(triangles.vertices)
    there, back = np.sort(start * count + end), np.sort(end * count + start)
    assert (start != end).all()
    assert len(np.unique(there)) == len(there)
    np.testing.assert_array_equal(there, back)


def test_gear_and_bodies_are_closed_oriented_and_solid(solid):
    for triangles in (solid.nominal, solid.worn, *solid.bodies):
        assert_closed(triangles)
        assert triangles.volume > 0.0
        assert as_manifold(triangles).status() == Error.NoError


def test_a_body_for_each_worn_flank_of_the_volume_integrated(solid):
    """By the boolean within 1 % of the integral, each and all together."""
    assert {(r.tooth, r.side) for r in solid.wear.regions} == {(f.tooth, f.side) for f in solid.scan.truth.flanks}
    assert len(solid.bodies) == len(solid.wear.regions)
    assert sum(body.volume for body in solid.bodies) == pytest.approx(solid.wear.volume, rel=0.01)
    for region, body in zip(solid.wear.regions, solid.bodies, strict=True):
        assert body.volume == pytest.approx(region.volume, rel=0.01)
        middle = np.angle(np.mean(body.vertices[:, 0]) + 1j * np.mean(body.vertices[:, 1]))
        assert round(middle / GEAR.pitch_angle) % 12 == region.tooth


def centre_of(body: Triangles) -> np.ndarray:
    """Of its volume, (3,) mm: of tetrahedra from one vertex."""
    corner = body.vertices[body.faces] - body.vertices[0]
    volume = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2]))
    return body.vertices[0] + volume @ corner.sum(axis=1) / 4.0 / volume.sum()


def test_tooth_by_tooth_it_is_the_boolean_of_the_whole_gears(solid):
    """The same bodies: volumes, areas and centres."""
    by_tooth = worn_volume(solid.profiles, solid.wear.least_seen)
    assert len(by_tooth) == len(solid.bodies)
    for one, whole in zip(by_tooth, solid.bodies, strict=True):
        assert_closed(one)
        assert one.volume == pytest.approx(whole.volume, rel=1e-9)
        assert one.area == pytest.approx(whole.area, rel=1e-9)
        np.testing.assert_allclose(centre_of(one), centre_of(whole), atol=1e-9)
        np.testing.assert_allclose(np.sort(one.vertices.max(axis=0)), np.sort(whole.vertices.max(axis=0)), atol=1e-9)


def test_a_tooth_and_what_is_below_it_are_the_gear(solid):
    """Teeth cut off straight, and the body that is left: a prism of which only corners at the roots are known."""
    teeth = [tooth_triangles(solid.profiles, tooth) for tooth in range(12)]
    outline = outlines(solid.profiles)[0].reshape(12, -1, 2)
    nodes = len(solid.profiles.radius)
    corners = np.concatenate([outline[:, :1], outline[:, 2 * nodes + 2 * TIP_STEPS - 2 :]], axis=1).reshape(-1, 2)
    x, y = corners.T
    below = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))) * GEAR.face_width
    assert sum(tooth.volume for tooth in teeth) + below == pytest.approx(solid.worn.volume, rel=1e-9)
    for tooth in teeth:
        assert_closed(tooth)


@pytest.mark.parametrize("side", Side)
def test_a_spur_flank_that_lost_nothing_is_as_well_strips_from_end_to_end(solid, side):
    """A ruled surface, whose rulings they are: the same solid of fewer triangles."""
    profiles = nominal_like(solid.profiles)
    points, nodes = tooth_outlines(profiles, 5).shape[1], len(profiles.radius)
    flank = slice(0, nodes) if side is Side.RIGHT else slice(points - nodes, points)
    whole, strips = tooth_triangles(profiles, 5), tooth_triangles(profiles, 5, [flank])
    assert_closed(strips)
    assert strips.volume == pytest.approx(whole.volume, rel=1e-12)
    assert strips.area == pytest.approx(whole.area, rel=1e-9)
    assert len(strips.faces) < 0.7 * len(whole.faces)


def test_of_what_is_gone_from_end_to_end_the_nominal_side_is_strips(solid):
    """A flank lost evenly but for its lowest and highest nodes: what is missing has a drawn side of strips, and the volume of the profiles."""
    lost, new = 0.01, nominal_like(solid.profiles)
    half_angle = new.half_angle.copy()
    half_angle[4, 0, :, 6:-6] -= lost
    worn = replace(solid.profiles, half_angle=half_angle)
    (body,) = worn_volume(worn)
    assert_closed(body)
    (whole,) = worn_bodies(tooth_triangles(new, 4), tooth_triangles(worn, 4))
    assert body.volume == pytest.approx(whole.volume, rel=1e-9)
    assert body.area == pytest.approx(whole.area, rel=1e-9)
    assert len(body.faces) < 0.6 * len(whole.faces)


def test_what_is_missing_down_to_a_bottom_land_is_taken_from_the_whole_gear(solid):
    """Two flanks worn down to the land between them: cut off from root to root, their teeth would not end where they did."""
    half_angle = solid.profiles.half_angle.copy()
    half_angle[...] = nominal_like(solid.profiles).half_angle
    half_angle[4, 0] -= 0.01
    half_angle[5, 1] -= 0.01
    worn = replace(solid.profiles, half_angle=half_angle)
    lost = sum(body.volume for body in worn_volume(worn))
    assert lost == pytest.approx(gear_triangles(nominal_like(worn)).volume - gear_triangles(worn).volume, rel=1e-3)


def test_the_bodies_are_what_was_taken_away(solid):
    truth = sorted((flank.volume_mm3 for flank in solid.scan.truth.flanks), reverse=True)
    np.testing.assert_allclose([body.volume for body in solid.bodies], truth, rtol=0.02)


def test_nothing_is_lost_and_nothing_is_counted_twice(solid):
    """(A − B) + (A ∩ B) = A, and the worn gear lies inside the nominal one but for the chords of worn teeth's tip lands."""
    nominal, worn = as_manifold(solid.nominal), as_manifold(solid.worn)
    gone, more = (nominal - worn).volume(), (worn - nominal).volume()
    assert gone + (nominal ^ worn).volume() == pytest.approx(nominal.volume(), rel=1e-12)
    assert more < len(WEAR) * GEAR.face_width * _chord(GEAR.tip_radius, 2.0 * GEAR.tip_half_angle, 2 * TIP_STEPS)
    assert solid.nominal.volume - solid.worn.volume == pytest.approx(gone - more, rel=1e-9)


def test_a_gear_as_new_has_lost_no_body(solid):
    """Of other triangles than the nominal ones, but in the same places."""
    again = Triangles(solid.nominal.vertices.copy(), solid.nominal.faces.copy())
    assert worn_bodies(solid.nominal, again) == []


def test_the_nominal_triangles_hold_the_exact_section(solid):
    """But for chords: half a millimetre long, 8 µm off a fillet of 4 mm radius at the middle."""
    exact = GEAR.section_area() * GEAR.face_width
    assert solid.nominal.volume == pytest.approx(exact, rel=1e-3)
    radius = (
        GEAR.root_radius + (GEAR.tip_radius - GEAR.root_radius) * np.linspace(0.0, 1.0, 1500) ** 2
    )  # the fillet leaves the root circle flat
    fine = nominal_profiles(GEAR, radius, np.array([0.0, GEAR.face_width]))
    tip = _chord(GEAR.tip_radius, 2.0 * GEAR.tip_half_angle, 2 * TIP_STEPS)
    root = _chord(GEAR.root_radius, 2.0 * GEAR.root_half_angle, 2 * ROOT_STEPS)
    assert gear_triangles(fine).volume + 12 * GEAR.face_width * (tip + root) == pytest.approx(exact, rel=1e-6)


def _chord(radius: float, angle: float, steps: int) -> float:
    """Area between an arc and its equal chords, mm²."""
    return 0.5 * radius**2 * (angle - steps * np.sin(angle / steps))


@pytest.mark.parametrize("suffix", [".stl", pytest.param(".3mf", marks=pytest.mark.long)])
def test_another_reader_finds_the_same_volume(solid, suffix, tmp_path):
    for name, bodies in (("worn_gear", [solid.worn]), ("worn_volume", solid.bodies)):
        path = tmp_path / f"{name}{suffix}"
        if suffix == ".stl":
            write_stl(path, bodies, name)
        else:
            write_3mf(path, bodies, [f"{name} {i}" for i in range(len(bodies))])
        read = trimesh.load(path, force="mesh")
        assert read.is_watertight
        assert read.is_winding_consistent
        volume = sum(body.volume for body in bodies)
        # Single precision: 4e-6 mm at each vertex, over a surface of some 500 mm² for 300 mm³ taken away.
        assert read.volume == pytest.approx(volume, rel=1e-5)


@pytest.mark.long
def test_a_users_own_noisy_solid_adds_its_noise_to_what_is_removed_and_not_to_the_difference(solid):
    """White noise of 20 µm on every vertex of the tooth surfaces: where it digs in it is taken for missing, where it stands out for nothing."""
    rng = np.random.default_rng(1)
    off = rng.normal(0.0, 0.010, solid.worn.vertices.shape)
    off[-2:] = 0.0  # the middles of the end faces carry a tenth of the gear's surface each
    noisy = Triangles(solid.worn.vertices + off, solid.worn.faces)
    removed, signed, pieces = signed_difference(solid.nominal, noisy)
    lost = solid.nominal.volume - solid.worn.volume
    assert pieces > 100
    assert removed - lost > 10.0
    assert abs(signed - lost) < 0.1 * (removed - lost)


def test_what_is_not_closed_is_refused_by_name(solid):
    open_one = Triangles(solid.worn.vertices, solid.worn.faces[1:])
    with pytest.raises(InputError, match=r"the scan's triangles is not a closed solid: manifold3d says NotManifold"):
        signed_difference(solid.nominal, open_one)
    broken = Triangles(np.where(np.arange(len(solid.worn.vertices))[:, None] == 5, np.nan, solid.worn.vertices), solid.worn.faces)
    with pytest.raises(InputError, match="NonFiniteVertex"):
        worn_bodies(solid.nominal, broken)
