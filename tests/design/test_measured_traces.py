"""Traces of a measuring machine as a gear: what surface they make, what they do in contact, what is refused."""

import math

import numpy as np
import pytest

from gearwear.design.files.toml import parse_design
from gearwear.design.files.traces import MeasuredTrace, flank_surface, read_traces
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.meshing.study import study_meshing


@pytest.fixture(scope="module")
def design():
    return parse_design({"pinion": {"teeth": 12, "module": 6.35, "face_width": 15.0}, "gear": {"teeth": 24}}, "test")


def written(tmp_path, *rows, header="part,kind,tooth,flank,roll_mm,z_mm,deviation_um"):
    path = tmp_path / "traces.csv"
    path.write_text("\n".join([header, *rows]), encoding="utf-8")
    return path


def profile(deviation, tooth=1, flank="left", z="", rolls=(0.5, 12.0, 26.5)):
    return [f"pinion,profile,{tooth},{flank},{roll},{z},{deviation(roll):.9f}" for roll in rolls]


@pytest.mark.long
def test_a_uniform_loss_lags_by_itself_in_contact(tmp_path, design):
    """All left flanks 100 µm down: the transmission error of rigid contact is −100 µm, exactly and everywhere."""
    rows = [row for tooth in range(1, 13) for row in profile(lambda roll: -100.0, tooth)]
    study = study_meshing(design, written(tmp_path, *rows), drive="left")
    error = study.contact.transmission_error_um
    np.testing.assert_allclose(error, -100.0, atol=1e-3)


def test_flanks_that_were_not_measured_are_as_the_mean(tmp_path, design):
    rows = [*profile(lambda roll: -10.0, 1), *profile(lambda roll: -30.0, 5)]
    part, worn = read_traces(written(tmp_path, *rows), design)
    assert part == "pinion"
    flank = worn.radius >= worn.gear.form_radius
    loss = 1e3 * worn.loss[:, :, 0][..., flank]
    np.testing.assert_allclose(loss[0, 0], 10.0, atol=1e-6)
    np.testing.assert_allclose(loss[4, 0], 30.0, atol=1e-6)
    np.testing.assert_allclose(loss[7, 0], 20.0, atol=1e-6)
    np.testing.assert_allclose(loss[:, 1], 0.0, atol=1e-9)  # no right flank was measured
    np.testing.assert_allclose(worn.loss[..., 0], 0.0, atol=1e-12)  # the root circle stays


def test_pitch_sets_a_flank_to_its_index(tmp_path, design):
    """An index of +12 µm of arc is 12 cos α along the base tangent: more metal on a left flank, less on a right one."""
    rows = [
        *profile(lambda roll: 55.0),
        *profile(lambda roll: 55.0, flank="right"),
        "pinion,pitch,1,left,,,12",
        "pinion,pitch,1,right,,,12",
    ]
    _, worn = read_traces(written(tmp_path, *rows), design)
    flank = worn.radius >= worn.gear.form_radius
    shift = 12.0 * math.cos(math.radians(20.0))
    np.testing.assert_allclose(-1e3 * worn.loss[0, 0][:, flank], shift, atol=1e-6)
    np.testing.assert_allclose(-1e3 * worn.loss[0, 1][:, flank], -shift, atol=1e-6)


def test_a_place_that_was_measured_twice_counts_as_the_mean(tmp_path, design):
    """A sweep up and one down that differ by a hysteresis of 20 µm, and a pitch taken on both: what lies between."""
    pitch = ["pinion,pitch,1,left,,,22", "pinion,pitch,1,left,,,2"]
    both = [*profile(lambda roll: 10.0), *profile(lambda roll: -10.0)]
    _, worn = read_traces(written(tmp_path, *both), design)
    _, turned = read_traces(written(tmp_path, *both, *pitch), design)
    flank = worn.radius >= worn.gear.form_radius
    np.testing.assert_allclose(worn.loss[0, 0][:, flank], 0.0, atol=1e-9)
    np.testing.assert_allclose(1e3 * turned.loss[0, 0][:, flank], -12.0 * math.cos(math.radians(20.0)), atol=1e-6)


def test_the_surface_holds_all_its_traces_and_a_bilinear_one_everywhere():
    """Whatever zero each trace was set to: a twisted plane is found from two profiles and one helix."""
    rolls, heights = np.linspace(0.0, 20.0, 41), np.linspace(0.0, 15.0, 31)

    def truth(roll, z):
        return 0.001 * roll - 0.002 * z + 0.0003 * roll * z

    profiles = [MeasuredTrace(z, rolls, truth(rolls, z) + zero) for z, zero in ((7.5, 0.0), (2.0, 0.5), (13.0, -0.3))]
    helices = [MeasuredTrace(10.0, heights, truth(10.0, heights) + 0.7)]
    surface = flank_surface(profiles, helices, 7.5)
    roll, z = np.meshgrid(rolls, heights)
    np.testing.assert_allclose(surface(rolls, heights), truth(roll, z), atol=1e-12)


@pytest.mark.parametrize(("hollow", "stated"), [(0.0, True), (0.0, False), (40.0, True)])
def test_noise_that_is_stated_does_not_carry(tmp_path, design, hollow, stated):
    """Lines of noise of 4 µm on flanks that are as designed, U = 8 µm stated: what is left is a hundredth of its square, by the scatter of 1 − u² / d².
    Without U the rows are as they stand; a hollow of ten times the noise stays."""
    random, rolls = np.random.default_rng(6), np.linspace(0.5, 26.5, 200)
    shape = -hollow * np.sin(np.pi * (rolls - 0.5) / 26.0) ** 2
    rows = [
        f"pinion,profile,{tooth},left,{roll:.6f},,{value:.6f}{',8' if stated else ','}"
        for tooth in range(1, 13)
        for roll, value in zip(rolls, shape + random.normal(0.0, 4.0, len(rolls)), strict=True)
    ]
    header = "part,kind,tooth,flank,roll_mm,z_mm,deviation_um,U_um"
    _, worn = read_traces(written(tmp_path, *rows, header=header), design)
    flank = worn.radius >= worn.gear.form_radius
    reach = np.sqrt(worn.radius[flank] ** 2 - worn.gear.base_radius**2)
    loss = 1e3 * worn.loss[:, 0, 0][:, flank]
    error = loss - np.interp(reach, rolls, -shape)
    if hollow == 0.0 and stated:
        assert (error**2).mean() < 0.2 * 4.0**2
    else:
        assert 0.5 * 4.0**2 < (error**2).mean() < 1.5 * 4.0**2


def test_a_hollow_that_the_mean_of_a_flank_knows_is_not_taken_for_noise(tmp_path, design):
    """Three lines of 4 µm of noise of a flank with a hollow of 12 µm, and their exact mean: its shape stays, and no more noise than the share of the
    lines that is their own."""
    random, rolls = np.random.default_rng(8), np.linspace(0.5, 26.5, 200)
    shape = -12.0 * np.sin(np.pi * (rolls - 0.5) / 26.0) ** 2
    rows = []
    for place, z, noise in (("low", "3", 4.0), ("middle", "7.5", 4.0), ("high", "12", 4.0), ("mean", "7.5", 0.0)):
        values = shape + random.normal(0.0, noise, len(rolls)) if noise else shape
        rows += [
            f"pinion,profile,{place},1,left,{roll:.6f},{z},{value:.6f},{2.0 * noise + 0.2:.1f}"
            for roll, value in zip(rolls, values, strict=True)
        ]
    header = "part,kind,place,tooth,flank,roll_mm,z_mm,deviation_um,U_um"
    _, worn = read_traces(written(tmp_path, *rows, header=header), design)
    flank = worn.radius >= worn.gear.form_radius
    reach = np.sqrt(worn.radius[flank] ** 2 - worn.gear.base_radius**2)
    loss = 1e3 * worn.loss[0, 0][:, flank].mean(axis=0)
    middle, ends = np.abs(reach - 13.5) < 2.0, (reach < 2.5) | (reach > 24.5)
    true = np.interp(reach, rolls, -shape)
    assert loss[middle].mean() - loss[ends].mean() == pytest.approx(true[middle].mean() - true[ends].mean(), abs=1.2)


@pytest.mark.parametrize("stated", ["", "8"])
def test_a_trace_of_one_point_is_refused(tmp_path, design, stated):
    path = written(
        tmp_path, f"pinion,profile,1,left,12.0,,1.0,{stated}", header="part,kind,tooth,flank,roll_mm,z_mm,deviation_um,U_um"
    )
    with pytest.raises(InputError, match="1 points: 3 at least"):
        read_traces(path, design)


def test_semicolons_decimal_commas_and_diameters(tmp_path, design):
    gear = design.gears["pinion"]
    diameters = [2 * math.hypot(roll, gear.base_radius) for roll in (0.5, 12.0, 26.5)]
    rows = [f"pinion;profile;1;left;{d:.6f};-1,5".replace(".", ",") for d in diameters]
    _, worn = read_traces(written(tmp_path, "# a remark", *rows, header="part;kind;tooth;flank;diameter_mm;deviation_um"), design)
    np.testing.assert_allclose(1e3 * worn.loss[0, 0, 0, -1], 1.5, atol=1e-6)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (["pinion,profile,13,left,5,,1"], r"traces.csv:2: tooth 13: 1 to 12 would be right"),
        (["pinion,profile,1,top,5,,1"], "flank 'top': left or right"),
        (["pinion,lead,1,left,5,,1"], "kind 'lead': profile or helix or pitch"),
        (["pinion,profile,1,left,99,,1"], "on the involute"),
        (["pinion,profile,1,left,5,,x"], "deviation_um 'x': a number"),
        (["pinion,profile,1,left,5,,9000"], "deviation_um 9000: µm"),
        (["pinion,helix,1,left,5,,1"], "z_mm '': a number"),
        (["pinion,profile,1,left,5,,1"], "has 1 points: 3 at least"),
        (["pinion,pitch,1,left,5,,1"], "holds no profile"),
        (["wheel,profile,1,left,5,,1"], "part is wheel"),
        ([",profile,1,left,5,,1"], "does not say of which gear"),
    ],
)
def test_what_is_not_understood_is_refused_with_its_line(tmp_path, design, rows, said):
    with pytest.raises(InputError, match=said):
        read_traces(written(tmp_path, *rows), design)


def test_a_row_longer_than_the_header_is_refused(tmp_path, design):
    """Decimal commas between commas: read by place, 12,5 and -1,5 would be a roll of 12 mm and a deviation of 5 µm."""
    path = written(tmp_path, "# a remark", *profile(lambda roll: 0.0), "pinion,profile,2,left,12,5,,-1,5")
    with pytest.raises(InputError, match=r"traces.csv: line 6 has 9 cells and line 1 names 7 columns"):
        read_traces(path, design)
    short = written(tmp_path, *profile(lambda roll: -2.0), header="part,kind,tooth,flank,roll_mm,z_mm,deviation_um,place,remark")
    assert read_traces(short, design)[0] == "pinion"  # what is missing at the end is left out


@pytest.mark.long
def test_traces_that_inspect_writes_are_read(tmp_path, design):
    """Written by the inspection of flanks 30 µm down, with 10 µm of helix slope: the same gear comes back."""
    from gearwear.inspection import Settings, inspect
    from gearwear.report.files.inspection import write_columns
    from gearwear.report.files.inspection_columns import trace_columns
    from tests.inspection.synthetic import flanks

    gear: Gear = design.gears["pinion"]
    points = flanks(gear, 60, 30)
    put = np.where(points.side > 0, -0.030 + 0.010 * (points.position[:, 2] / 15.0 - 0.5), 0.0)
    found = inspect(points.with_deviation(put), gear, Settings(laboratory=True, noise=1e-3))
    write_columns(tmp_path / "traces.csv", trace_columns(found))
    part, worn = read_traces(tmp_path / "traces.csv", design)
    assert part == "pinion"
    inside = (worn.radius > gear.form_radius + 0.3) & (worn.radius < gear.tip_radius - 0.3)
    rows = (worn.z > 1.0) & (worn.z < 14.0)
    truth = 30.0 - 10.0 * (worn.z[rows, None] / 15.0 - 0.5)
    # Traces move towards their mean as far as the stated U allows: half a micrometre at the most.
    np.testing.assert_allclose(
        1e3 * worn.loss[:, 0][:, rows][:, :, inside], np.broadcast_to(truth, (12, rows.sum(), inside.sum())), atol=0.6
    )


def test_a_file_without_end_is_refused_by_its_size(tmp_path, design, monkeypatch):
    monkeypatch.setattr("gearwear.design.files.traces.MOST_BYTES", 200)
    with pytest.raises(InputError, match="is larger than 200 bytes"):
        read_traces(written(tmp_path, *profile(lambda roll: 0.0), *profile(lambda roll: 0.0, 2)), design)


def test_a_field_longer_than_csv_reads_and_a_folder_are_refused(tmp_path, design):
    with pytest.raises(InputError, match=r"traces.csv:2: is no row of a table"):
        read_traces(written(tmp_path, f"pinion,profile,1,left,{'5' * 200_000},,1"), design)
    with pytest.raises(InputError, match="is a folder"):
        read_traces(tmp_path, design)


def test_traces_without_number_are_refused(tmp_path, design, monkeypatch):
    monkeypatch.setattr("gearwear.design.files.traces.MOST_TRACES", 3)
    rows = [row for z in range(1, 5) for row in profile(lambda roll: 0.0, z=z)]
    with pytest.raises(InputError, match="left flank of tooth 1 has more than 3 traces of kind profile"):
        read_traces(written(tmp_path, *rows), design)
